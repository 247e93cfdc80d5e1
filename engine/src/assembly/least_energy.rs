//! Assembly of a solid axle with five links, one more than rigid links allow.
//!
//! Five lengths and the heights of both wheel centres are seven conditions on the six unknowns of the axle's pose q.
//! Parts with deviations therefore fit together only if the links stretch. Link i has the distance l_i between its ends,
//! the length L_i without force, the softness c_i (inverse stiffness) and the tension t_i. The wheel centres have
//! heights z_k, and vertical forces f_k act there:
//! ```text
//! l_i(q) - L_i = c_i t_i,   z_k(q) = h_k                                                       (1)
//! sum t_i dl_i/dq + sum f_k dz_k/dq = 0                                                        (2)
//! ```
//!
//! The solution is the pose with the least energy of the links, sum c_i t_i^2/2, while a jig holds both heights. Link
//! number 5 has no constraint in the mechanism. The rows of J are the gradients of the first four distances and of both
//! heights. Equation (2) then leaves one free number t_5, and
//!
//! ```text
//! t_i = s_i t_5,   J's = -dl_5/dq,   s_5 = 1                                                   (3)
//! t_5 = sum s_i (l_i - L_i)/sum c_i s_i^2                                                      (4)
//! q <- q - J^-1 (l_i - L_i - c_i t_i, z_k - h_k)                                               (5)
//! ```
//!
//! Because of equation (3), the sum of s_i l_i has no first derivative with respect to q at constant heights. Correction (5) sets
//! the heights to first order. So an error of q then changes t_5 in equation (4) only by the square of that error. Each correction
//! (5) multiplies the error by about c_i t_i/l_i: one thousandth for usual parts. The program finds s for derivative numbers by the
//! corrections
//!
//! ```text
//! s <- s - J0'^-1 (J's + dl_5/dq)                                                              (6)
//! ```
//!
//! with J0, the matrix J of the assembled parts. The corrections (5) and (6) converge together, as fast as (5) alone for
//! plain numbers.

use super::assembler::{Assembler, Linearised};
use super::parts::{Member, Parts};
use crate::axle::Axle;
use crate::compliance::{AxialStiffness, AxleCompliance, AxleParameter, LinkMember, Parameter};
use crate::linear::lu::{Matrix6, Vector6};
use crate::mechanism::{DesignFault, Pose, Twist};
use crate::model::{Mechanism, PointId, Side, Suspension};
use crate::number::{Each, Real, Vector3, array_of};

/// Number of links of the axle.
const LINKS: usize = 5;
/// Index of the fifth link, which has no constraint in the mechanism.
const EXTRA: usize = LINKS - 1;
/// Largest number of corrections of the axle's pose by equation (5) of this file.
const MOST_ROUNDS: usize = 40;
/// Twice the largest move of the axle in the first correction, relative to the axle's size.
const FARTHEST: f64 = 0.2;

/// Tensions of the five links of an assembled axle: first the links with constraints, in their order, then the link
/// without constraint. `None` for a mechanism without an extra link.
pub type Tensions<T = f64> = Option<[T; LINKS]>;

/// Left-hand minus right-hand sides of equation (1) of this file in a pose, without the terms c_i t_i. Also their gradients with
/// respect to the pose.
struct Rows<T> {
    /// Differences l_i - L_i.
    stretches: [T; LINKS],
    /// Differences z_k - h_k.
    heights: [T; 2],
    by_links: [Vector6<T>; LINKS],
    by_heights: [Vector6<T>; 2],
}

impl<T: Real> Rows<T> {
    /// Matrix J of equation (3) of this file: the gradients of the first four distances and of both heights with respect to the
    /// pose.
    fn jacobian(&self) -> Matrix6<T> {
        array_of(|k| match k {
            0..EXTRA => self.by_links[k],
            _ => self.by_heights[k - EXTRA],
        })
    }

    /// Returns the tensions by equations (3) and (4) of this file. `shares` holds the six numbers s, one for each row of J.
    fn tensions(&self, shares: &Vector6<T>, softness: &[f64; LINKS]) -> [T; LINKS] {
        let one = self.stretches[0].one();
        let shares: [T; LINKS] = array_of(|i| if i == EXTRA { one } else { shares[i] });
        let (mut misfit, mut sum) = (one.zero(), one.zero());
        for i in 0..LINKS {
            misfit = misfit + shares[i] * self.stretches[i];
            sum = sum + (shares[i] * shares[i]).scaled(softness[i]);
        }
        let tension = misfit / sum;
        shares.each(|share| share * tension)
    }

    /// Returns the correction of the axle's pose by equation (5) of this file.
    fn correction(
        &self,
        tensions: &[T; LINKS],
        softness: &[f64; LINKS],
        inverse: &Matrix6<f64>,
    ) -> Vector6<T> {
        let residuals: Vector6<T> = array_of(|k| match k {
            0..EXTRA => self.stretches[k] - tensions[k].scaled(softness[k]),
            _ => self.heights[k - EXTRA],
        });
        array_of(|row| {
            let terms = (0..6).map(|k| residuals[k].scaled(-inverse[row][k]));
            terms.fold(residuals[0].zero(), |sum, term| sum + term)
        })
    }

    /// Ratios s of the links' tensions to the fifth tension: equation (3) of this file, after one correction by equation (6).
    fn shares(&self, before: &Vector6<T>, inverse: &Matrix6<f64>) -> Vector6<T> {
        let rows = self.jacobian();
        let left: Vector6<T> = array_of(|j| {
            let terms = (0..6).map(|k| rows[k][j] * before[k]);
            terms.fold(self.by_links[EXTRA][j], |sum, term| sum + term)
        });
        array_of(|k| {
            let terms = (0..6).map(|j| left[j].scaled(inverse[j][k]));
            terms.fold(before[k], |rest, term| rest - term)
        })
    }
}

/// The pose after a correction.
fn moved<T: Real>(pose: &Pose<T>, correction: Vector6<T>) -> Pose<T> {
    let twist = Twist::from_array(correction);
    pose.moved(twist.shift, twist.turn.scaled(0.5))
}

impl Assembler {
    /// Makes the assembler of an axle. `side` selects the wheel whose mechanism is assembled. On an elastic axle on
    /// five links, deviations of the parts stretch the links according to the stiffness of each link.
    pub fn of_axle(axle: &Axle, side: Side) -> Result<Self, DesignFault> {
        let suspension = axle.suspension(side);
        let mut assembler = Assembler::new(suspension)?;
        if let Some(elastic) = &axle.elastic
            && suspension.mechanism.has_extra_links()
        {
            assembler.drawn_mut().softness = softness(&elastic.parts, suspension, side);
        }
        Ok(assembler)
    }

    /// Softnesses of the links: length by which a unit tension stretches the link. All 1 if the parts have no
    /// softnesses.
    fn softness<T>(&self, parts: &Parts<T>) -> [f64; LINKS] {
        let mechanism = &self.suspension().mechanism;
        let mut softness = [1.0; LINKS];
        if !parts.softness.is_empty() {
            let links = Member::links(mechanism).map(|(link, _)| link.place(mechanism));
            for (own, place) in softness.iter_mut().zip(links) {
                *own = parts.softness[place];
            }
        }
        softness
    }

    fn rows<T: Real>(&self, parts: &Parts<T>, height: T, pose: &Pose<T>) -> Rows<T> {
        let mechanism = &self.suspension().mechanism;
        let at = self.configuration(parts, pose);
        let zero = height.zero();
        let wrench = |along: Vector3<T>, place: Vector3<T>| {
            let [a, b, c] = (place - pose.origin).cross(along).to_array();
            [along.x, along.y, along.z, a, b, c]
        };
        let mut rows = Rows {
            stretches: [zero; LINKS],
            heights: [zero; 2],
            by_links: [[zero; 6]; LINKS],
            by_heights: [[zero; 6]; 2],
        };
        for (k, (link, [inner, outer])) in Member::links(mechanism).take(LINKS).enumerate() {
            let place = at.carried(outer);
            let line = place - parts.points[inner.0];
            let length = line.norm();
            rows.stretches[k] = length - parts.lengths[link.place(mechanism)];
            rows.by_links[k] = wrench(line.map(|c| c / length), place);
        }
        let rigid = mechanism.rigid_axle.as_ref();
        let far = rigid.map_or(mechanism.wheel_centre, |rigid| rigid.far_centre);
        let up = Vector3::new(zero, zero, zero.one());
        for (k, centre) in [mechanism.wheel_centre, far].into_iter().enumerate() {
            let place = at.carried(centre);
            rows.heights[k] = place.z - parts.drawn[centre.0].z - height;
            rows.by_heights[k] = wrench(up, place);
        }
        rows
    }

    /// Finds the pose of least energy by corrections from a known pose, with equation (5) of this file.
    pub(super) fn relax(
        &self,
        parts: &Parts<f64>,
        height: f64,
        from: &Linearised,
    ) -> Option<Linearised> {
        let softness = self.softness(parts);
        let mut pose = from.pose;
        let mut before = FARTHEST * self.size();
        for round in 0..MOST_ROUNDS {
            let rows = self.rows(parts, height, &pose);
            let mut at = Linearised::of(pose, rows.jacobian(), self.size())?;
            let shares = rows.shares(&[0.0; 6], &at.inverse);
            let tensions = rows.tensions(&shares, &softness);
            let correction = rows.correction(&tensions, &softness, &at.inverse);
            let [x, y, z, a, b, c] = correction;
            let turn = Vector3::new(a, b, c).norm() * self.size();
            let size = Vector3::new(x, y, z).norm().max(turn);
            let ahead = size * (size / before).min(1.0);
            if ahead < self.rounding() && size <= before {
                // The next correction would be smaller than rounding errors. The inverse Jacobian of the previous pose
                // is accurate enough.
                at.pose = moved(&pose, correction);
                at.rounds = round + 1;
                return Some(at);
            }
            // The test is written so that it also rejects NaN.
            let contracts = 2.0 * size < before;
            if !contracts {
                return None;
            }
            (pose, before) = (moved(&pose, correction), size);
        }
        None
    }

    /// Returns the pose of assembled parts in another number type, with the tensions of the links. `at` holds the values of the
    /// pose.
    pub(super) fn relaxed_series<T: Real>(
        &self,
        parts: &Parts<T>,
        height: T,
        at: &Linearised,
        orders: usize,
    ) -> (Pose<T>, [T; LINKS]) {
        let softness = self.softness(parts);
        let mut pose = at.pose.map(|c| height.constant(c));
        let mut shares = [height.zero(); 6];
        let mut rounds = 0..orders + at.rounds;
        loop {
            let rows = self.rows(parts, height, &pose);
            shares = rows.shares(&shares, &at.inverse);
            let tensions = rows.tensions(&shares, &softness);
            if rounds.next().is_none() {
                return (pose, tensions);
            }
            let correction = rows.correction(&tensions, &softness, &at.inverse);
            pose = moved(&pose, correction);
        }
    }

    /// Returns the tensions of the links of assembled parts. `None` for a mechanism without an extra link.
    pub(crate) fn tensions(&self, parts: &Parts<f64>, height: f64, at: &Linearised) -> Tensions {
        let is_relaxed = self.suspension().mechanism.has_extra_links();
        is_relaxed.then(|| self.relaxed_series(parts, height, at, 0).1)
    }
}

/// Returns the links among the elastic parts of an axle, in the mechanism as seen from the wheel of one side. For each
/// link, returns its tension as an input of the axle, its two ends, and its stiffness.
fn links(
    parts: &AxleCompliance,
    mechanism: &Mechanism,
    view: Side,
) -> Vec<(AxleParameter, [PointId; 2], AxialStiffness)> {
    let mut found = Vec::new();
    for (side, wheel) in Side::ALL.into_iter().zip(&parts.wheels) {
        for (number, part) in wheel.links.iter().enumerate() {
            let LinkMember::Rod { inner, outer } = part.member else {
                continue;
            };
            let seen = |id: PointId| match &mechanism.rigid_axle {
                Some(rigid) if side != view => rigid.partner(id),
                _ => id,
            };
            let parameter = AxleParameter {
                parameter: Parameter::LinkPreload(number),
                side: Some(side),
            };
            found.push((parameter, [inner, outer].each(seen), part.stiffness));
        }
    }
    found
}

/// Returns the softnesses of all members of an axle as seen from the wheel of one side, in the order of
/// [`Parts::lengths`]. 0 for rigid members.
fn softness(parts: &AxleCompliance, suspension: &Suspension, view: Side) -> Vec<f64> {
    let mechanism = &suspension.mechanism;
    let design = &suspension.design;
    let mut softness = vec![0.0; Parts::of_drawing(mechanism, design).lengths.len()];
    for (_, ends, stiffness) in links(parts, mechanism, view) {
        let link = Member::links(mechanism).find(|(_, own)| *own == ends);
        let Some((link, [inner, outer])) = link else {
            continue;
        };
        softness[link.place(mechanism)] = match stiffness {
            AxialStiffness::Rate(rate) => 1.0 / rate,
            AxialStiffness::PerStrain(force) => (design[outer.0] - design[inner.0]).norm() / force,
        };
    }
    softness
}

/// Tension of an elastic link on an axle whose parts do not fit without force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TensionInput {
    /// The constant tension as an input of the elastic axle.
    pub(crate) parameter: AxleParameter,
    /// Index of the link among [`Tensions`], as seen from the left wheel.
    pub(crate) link: usize,
    /// Index of the link in [`Parts::lengths`], as seen from the left and from the right wheel.
    pub(crate) places: [usize; 2],
    /// Constant tension of the nominal link.
    pub(crate) nominal: f64,
}

/// Returns the tensions of the elastic links of an axle as inputs. Empty if the axle has no extra link.
pub(crate) fn tension_inputs(axle: &Axle) -> Vec<TensionInput> {
    let mechanism = &axle.left.mechanism;
    let Some(elastic) = axle
        .elastic
        .as_ref()
        .filter(|_| mechanism.has_extra_links())
    else {
        return Vec::new();
    };
    let views = Side::ALL.map(|view| links(&elastic.parts, mechanism, view));
    let [left, right] = &views;
    let inputs = left.iter().zip(right);
    let input = |((parameter, ends, _), (_, seen, _)): (&(AxleParameter, _, _), &(_, _, _))| {
        let found = |ends: &[PointId; 2]| {
            let mut links = Member::links(mechanism).enumerate();
            let (number, (link, _)) = links.find(|(_, (_, own))| own == ends)?;
            Some((number, link.place(mechanism)))
        };
        let ((link, place), (_, other)) = (found(ends)?, found(seen)?);
        let AxleParameter {
            parameter: of,
            side,
        } = *parameter;
        let wheel = &elastic.parts.wheels[side.unwrap_or(Side::Left) as usize];
        let Parameter::LinkPreload(number) = of else {
            return None;
        };
        Some(TensionInput {
            parameter: *parameter,
            link,
            places: [place, other],
            nominal: wheel.links[number].preload,
        })
    };
    inputs.filter_map(input).collect()
}

impl Axle {
    /// Adds the tensions of an assembled axle to the constant tensions of its elastic links.
    pub fn add_tensions(&mut self, tensions: &Tensions) {
        let Some(tensions) = tensions else {
            return;
        };
        let inputs = tension_inputs(self);
        if let Some(elastic) = &mut self.elastic {
            for own in inputs {
                let tension = own.nominal + tensions[own.link];
                elastic.parts.set_rate(own.parameter, tension);
            }
        }
    }
}

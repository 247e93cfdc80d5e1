//! Certificates of an axle's pose: rigorous bounds for the poses of both wheels and for the conditions at the ground.
//!
//! On a plane ground, the program certifies one additional number u. If the roll angle is given, u is half the difference s
//! of the travels. If both travels are given, u is the roll angle. The exact value of u is the root of f = h_l - h_r, the
//! difference in height of the contact points. The program computes two enclosures, i.e. intervals that certainly contain a
//! number: f at the computed u, and f' over [u - d, u + d]. Then
//!
//! ```text
//! f' > 0 and |f(u)| <= d f'   =>   one and only one root in [u - d, u + d], and |root - u| <= |f(u)|/f'
//! ```
//!
//! In roll, f' = n.C_l' + n.C_r', on poses enclosed over the intervals of travel ([`Certifier::over_travels`]). n is the
//! normal of the ground. C_l' and C_r' are the velocities of the carriers' points at the contact points, each with respect
//! to its wheel's travel. The derivative of f with respect to the roll angle is the track. The sine and cosine of the roll
//! angle, the hardpoints and the wheel radius are enclosed, too. So the certificate applies to the exact axle whose numbers
//! are the given doubles.

use super::solver::{AxlePose, Placement};
use super::{Axle, Ground};
use crate::analyse::{Certifier, Inclusion};
use crate::curves::Prover;
use crate::mechanism::{Configuration, Failure, NoPose};
use crate::model::{Mechanism, Side};
use crate::number::{Each, Interval, Jet, Real, Vector3};

/// Certified bounds on an axle's pose. Lengths are in the study's unit, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxleProof {
    /// Bound on the position error of any point of the left and of the right wheel carrier.
    pub position_errors: [f64; 2],
    /// Bound on the error of both travels. If the travels are given, it is 0, or the rounding error of the mean travel of a
    /// rigid axle.
    pub travel_error: f64,
    /// Bound on the error of the roll angle, in radians. It is 0 if the roll angle is given.
    pub roll_error: f64,
    /// Lower bound on the distance to any other pose. In any other pose, at least one of these numbers differs by this
    /// length: a coordinate of a carrier's origin, an entry of a rotation matrix, the roll angle. The last two are
    /// multiplied by the mechanism's size.
    pub uniqueness: f64,
}

/// Certifies poses of one axle.
pub struct AxleCertifier<'a> {
    wheels: [Wheel<'a>; 2],
    radius: f64,
    /// True if one body carries both wheels. Then the difference of the travels drives the axle, and the mean travel takes the
    /// place of the rack displacement.
    is_rigid: bool,
}

/// One wheel of the axle, in the kernel's frame of the wheel's side.
struct Wheel<'a> {
    prover: Prover<'a>,
    mechanism: &'a Mechanism,
    design: Vec<Vector3<Jet<Interval, 2>>>,
    /// Bound on the rise of the wheel centre, if each coordinate of the pose changes by at most 1.
    rise: f64,
}

/// Largest number of times that the interval around a computed number is reduced to a quarter. After that, the certificate
/// fails.
const MOST_QUARTERINGS: usize = 24;
/// Factor on the width of this interval after a failed attempt. It changes the number of attempts, not the validity of the
/// result.
const NARROWER: f64 = 0.25;
/// Half-width of the widest interval in which the roll angle is certified, in radians.
const WIDEST_ROLL: f64 = 0.1;

/// A certified root.
struct Root {
    /// Bound on the distance between the root and the computed number.
    off: f64,
    /// Half-width of the interval around the computed number that certainly contains no other root.
    alone: f64,
}

impl Root {
    /// Certifies that `function` has a root near `at`, inside the half-width `widest`. `function` returns intervals that
    /// enclose its value and its derivative over an interval. `None` if the root cannot be certified.
    fn near(
        at: f64,
        widest: f64,
        function: impl Fn(Interval) -> Option<Jet<Interval, 2>>,
    ) -> Option<Root> {
        let value = function(Interval::point(at))?[0];
        let off_by = |reach: f64| {
            let slope = function(around(at, reach))?[1];
            let off = (value / slope).magnitude();
            (slope.low > 0.0 && off <= reach).then_some(off)
        };
        let mut alone = widest;
        for _ in 0..MOST_QUARTERINGS {
            if let Some(off) = off_by(alone) {
                // The root is certainly within the distance `off` of the computed number. Over this shorter interval, the
                // derivative of the function has narrower bounds.
                let off = off_by(off).unwrap_or(off);
                return Some(Root { off, alone });
            }
            alone *= NARROWER;
        }
        None
    }
}

fn around(value: f64, by: f64) -> Interval {
    Interval::point(value) + Interval::bounds(-by, by)
}

impl<'a> Wheel<'a> {
    fn new(axle: &'a Axle, side: Side) -> Self {
        let suspension = axle.suspension(side);
        let mechanism = &suspension.mechanism;
        let [centre, origin] = [mechanism.wheel_centre, mechanism.origin].each(|id| id.0);
        let lever = suspension.design[centre] - suspension.design[origin];
        let prover = Prover::new(suspension);
        let scale = prover.certifier.scale();
        let rise = |lever: Vector3<f64>| {
            let [x, y, z] = lever.to_array().each(f64::abs);
            1.0 + (x + y + z) / scale
        };
        // For a rigid axle, the travel that drives it is half the sum or half the difference of the rises of the wheel
        // centres. So the larger bound of the two wheel centres also holds for this travel.
        let far = mechanism
            .rigid_axle
            .as_ref()
            .map_or(centre, |rigid| rigid.far_centre.0);
        let far_lever = suspension.design[far] - suspension.design[origin];
        let rise = rise(lever).max(rise(far_lever));
        let exact = |p: &Vector3<f64>| p.map(|c| Jet::constant(Interval::point(c)));
        Wheel {
            prover,
            mechanism,
            design: suspension.design.iter().map(exact).collect(),
            // The factor 1 + 8 epsilon covers a few rounding errors of positive numbers.
            rise: rise * (1.0 + 8.0 * f64::EPSILON),
        }
    }

    /// Returns an enclosure of the contact point's height above the origin, over all enclosed poses.
    fn height(
        &self,
        inclusion: &Inclusion,
        ground: Ground<Jet<Interval, 2>>,
        radius: f64,
    ) -> Jet<Interval, 2> {
        let at = Configuration {
            mechanism: self.mechanism,
            design: &self.design,
            pose: inclusion.pose,
            rack: Jet::constant(Interval::point(0.0)),
            steering: None,
        };
        let contact =
            at.point(self.mechanism.wheel_centre) + ground.contact_lever(at.spin_axis(), radius);
        ground.normal().dot(contact)
    }
}

impl<'a> AxleCertifier<'a> {
    /// Prepares the certification of this axle's poses.
    pub fn new(axle: &'a Axle) -> Self {
        AxleCertifier {
            wheels: Side::ALL.map(|side| Wheel::new(axle, side)),
            radius: axle.setup.wheel_radius.unwrap_or(f64::NAN),
            is_rigid: axle.is_rigid(),
        }
    }

    /// Returns the certifier for the poses of one wheel.
    pub fn wheel(&self, side: Side) -> &Certifier<'a> {
        &self.wheels[side as usize].prover.certifier
    }

    /// Certifies a pose that was found for a placement.
    ///
    /// # Errors
    /// [`NoPose::Wheel`] if the pose of a wheel cannot be certified. [`NoPose::Unproven`] if the poses of both wheels
    /// can be certified, but not the travels or the roll angle at which the wheels touch the ground, and for a placement at
    /// a load.
    pub fn prove(&self, placement: &Placement, placed: &AxlePose) -> Result<AxleProof, NoPose> {
        let over = |side: Side, travel: Interval, rack: f64| {
            let pose = &placed.poses()[side as usize];
            let found = self.wheel(side).over_travels(pose, travel, rack);
            found.map_err(|reason| NoPose::Wheel {
                side,
                travel: placed.travels[side as usize],
                failure: Failure::Uncertified(reason),
            })
        };
        let over = |[left, right]: [Interval; 2]| {
            // In its own frame, the right wheel's rack moves in the opposite direction.
            let rack = placement.rack();
            let coordinates = if self.is_rigid {
                let half = (left - right).scaled(0.5);
                [(half, placement.mean()), (-half, placement.mean())]
            } else {
                [(left, rack), (right, -rack)]
            };
            let [(left, one), (right, two)] = coordinates;
            Ok([over(Side::Left, left, one)?, over(Side::Right, right, two)?])
        };
        match *placement {
            // The program cannot compute enclosures of loads.
            Placement::AtLoad { .. } => Err(NoPose::Unproven),
            Placement::Roll { heave, roll, .. } => {
                self.in_roll([heave, roll], placed.travels, over)
            }
            Placement::Travels {
                travels, on_plane, ..
            } => {
                let wheels = over(travels.each(Interval::point))?;
                let roll = on_plane.then_some(placed.roll);
                let proof = self.at_travels(&wheels, roll)?;
                // The bound on the travel error of a rigid axle is the rounding error of the mean of both travels.
                let rounding = if self.is_rigid {
                    f64::EPSILON * (travels[0].abs() + travels[1].abs())
                } else {
                    0.0
                };
                Ok(AxleProof {
                    travel_error: rounding,
                    ..proof
                })
            }
        }
    }

    /// Enclosures of the heights of both contact points.
    fn heights(
        &self,
        wheels: &[Inclusion; 2],
        ground: Ground<Jet<Interval, 2>>,
    ) -> [Jet<Interval, 2>; 2] {
        let [left, right] = &self.wheels;
        [
            left.height(&wheels[0], ground, self.radius),
            right.height(&wheels[1], ground.mirrored(), self.radius),
        ]
    }

    /// Certifies a pose with given heave and roll angle. `over` returns enclosures of the poses of both wheels over
    /// intervals of the travels.
    fn in_roll(
        &self,
        [heave, roll]: [f64; 2],
        travels: [f64; 2],
        over: impl Fn([Interval; 2]) -> Result<[Inclusion; 2], NoPose>,
    ) -> Result<AxleProof, NoPose> {
        let (sine, cosine) = Interval::point(roll).sin_cos();
        let ground = Ground { sine, cosine }.map(Jet::constant);
        let half = 0.5 * (travels[0] - travels[1]);
        let written = travels.each(Interval::point);
        // The intervals include the travels that the solver found. At these travels, the poses are certified to be on the
        // solution branch of the design position.
        let travels = |half: Interval| {
            let heave = Interval::point(heave);
            let [left, right] = written;
            [(heave + half).hull(left), (heave - half).hull(right)]
        };
        let here = over(travels(Interval::point(half)))?;
        let root = Root::near(half, 0.25 * nearest_other(&here), |half| {
            let wheels = over(travels(half)).ok()?;
            let [left, right] = self.heights(&wheels, ground);
            // The right wheel moves in the opposite direction.
            Some(Jet([left[0] - right[0], left[1] + right[1]]))
        });
        let root = root.ok_or(NoPose::Unproven)?;
        let found = travels(around(half, root.off));
        let wheels = over(found)?;
        let errors = [0, 1].each(|wheel| (found[wheel] - written[wheel]).magnitude());
        // Any other pose close to the poses of both wheels would have travels in the interval around the root. But this
        // interval contains only one root.
        let nearest = nearest_other(&over(travels(around(half, root.alone)))?);
        let reach = |wheel: usize| {
            let error = wheels[wheel].certificate.error;
            (root.alone - root.off) / self.wheels[wheel].rise - error
        };
        Ok(AxleProof {
            position_errors: self.position_errors(&wheels),
            travel_error: errors[0].max(errors[1]),
            roll_error: 0.0,
            // The factor 1 - 1e-12 covers a few rounding errors.
            uniqueness: nearest.min(reach(0).min(reach(1)) * (1.0 - 1e-12)).max(0.0),
        })
    }

    /// Certifies a pose with given travels. Without a roll angle, the wheels are on level pads. With a roll angle, they
    /// are on a plane.
    fn at_travels(&self, wheels: &[Inclusion; 2], roll: Option<f64>) -> Result<AxleProof, NoPose> {
        let nearest = nearest_other(wheels);
        let proof = AxleProof {
            position_errors: self.position_errors(wheels),
            travel_error: 0.0,
            roll_error: 0.0,
            uniqueness: nearest,
        };
        let Some(roll) = roll else {
            return Ok(proof);
        };
        // The poses do not change with the roll angle.
        let held = wheels.each(|wheel| Inclusion {
            pose: wheel.pose.map(|c| Jet::constant(c[0])),
            ..wheel
        });
        let root = Root::near(roll, WIDEST_ROLL, |roll| {
            let (sine, cosine) = roll.sin_cos();
            let ground = Ground {
                sine: Jet([sine, cosine]),
                cosine: Jet([cosine, -sine]),
            };
            let [left, right] = self.heights(&held, ground);
            Some(left - right)
        });
        let root = root.ok_or(NoPose::Unproven)?;
        let [left, right] = wheels.each(|wheel| wheel.certificate.scale);
        let away = ((root.alone - root.off) * left.min(right)).next_down();
        Ok(AxleProof {
            roll_error: root.off,
            uniqueness: nearest.min(away).max(0.0),
            ..proof
        })
    }

    fn position_errors(&self, wheels: &[Inclusion; 2]) -> [f64; 2] {
        [0, 1].each(|wheel| {
            let prover = &self.wheels[wheel].prover;
            prover.position_error(&wheels[wheel].certificate)
        })
    }
}

/// Distance from the poses of both wheels within which neither wheel has another pose.
fn nearest_other(wheels: &[Inclusion; 2]) -> f64 {
    let [left, right] = wheels.each(|wheel| wheel.certificate.uniqueness);
    left.min(right)
}

//! Parts between the body and the wheel carrier that move in their own right, eliminated from the equations.
//!
//! Each part has inner unknowns y beside the displacement x of what holds it outside (the joint of an arm, or the whole
//! carrier). With the derivatives f, m of the energy by x and y,
//!
//! ```text
//! dy = -(m_y^-1 m + m_y^-1 m_x dx)                                                                (1)
//! f_x - f_y m_y^-1 m_x,   f - f_y m_y^-1 m                                                        (2)
//! ```
//!
//! is the full Newton step: there is no inner loop. A force F that acts on a body at the lever r = R (P - O), with the
//! tangent K by the point, gives the body
//!
//! ```text
//! force F, moment r x F;   tangents K, -K r^, r^ K, -r^ K r^ + F^ r^                              (3)
//! ```
//!
//! F^ r^ takes the force before inner unknowns are eliminated.

use super::algebra::{Placed, cross_matrix};
use super::bushing::{Bushing, BushingForce, BushingState};
use super::point::{PointForce, Seat};
use crate::linear::lu::Lu;
use crate::number::{Matrix3, Scalar, Vector3};

/// Sum of forces and moments on the carrier about its reference point, and their tangent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sum<T> {
    pub(super) force: [T; 6],
    pub(super) tangent: [[T; 6]; 6],
}

impl<T: Scalar> Sum<T> {
    pub(super) fn zero(like: T) -> Self {
        Sum {
            force: [like.zero(); 6],
            tangent: [[like.zero(); 6]; 6],
        }
    }

    #[inline(always)]
    fn add_block(&mut self, row: usize, column: usize, block: &Matrix3<T>) {
        for (j, column_of) in block.columns.iter().enumerate() {
            for (i, entry) in column_of.to_array().into_iter().enumerate() {
                let at = &mut self.tangent[row + i][column + j];
                *at = *at + entry;
            }
        }
    }

    #[inline(always)]
    pub(super) fn add_force(&mut self, force: Vector3<T>, moment: Vector3<T>) {
        let sum = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
        for (total, part) in self.force.iter_mut().zip(sum) {
            *total = *total + part;
        }
    }

    /// Adds a torque and its tangent by small turns.
    #[inline(always)]
    pub(super) fn add_moment(&mut self, moment: Vector3<T>, by_turn: &Matrix3<T>) {
        self.add_force(moment.zero(), moment);
        self.add_block(3, 3, by_turn);
    }

    /// Equation (3).
    #[inline(always)]
    pub(super) fn add_point(&mut self, lever: Vector3<T>, point: &PointForce<T>) {
        self.add_force(point.condensed, lever.cross(point.condensed));
        let left = point.stiffness.crossed_by(lever);
        let across = cross_matrix(lever);
        self.add_block(0, 0, &point.stiffness);
        self.add_block(0, 3, &point.stiffness.times(&across).negated());
        self.add_block(3, 0, &left);
        let turn = left.times(&across).negated();
        self.add_block(3, 3, &turn.plus(&across.crossed_by(point.force)));
    }

    /// Tangents of a force at a point that stays where it is while the carrier moves away under it, as of the mount
    /// of a strut.
    #[inline(always)]
    pub(super) fn add_blocks(&mut self, blocks: [[&Matrix3<T>; 2]; 2]) {
        for (i, row) in blocks.into_iter().enumerate() {
            for (j, block) in row.into_iter().enumerate() {
                self.add_block(3 * i, 3 * j, block);
            }
        }
    }
}

/// Conditions under which parts are evaluated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conditions<T> {
    pub(super) carrier: Placed<T>,
    pub(super) rack: T,
    /// True for the forces at the design load: elements have their slope and no force, springs their force and no
    /// slope, torsion is left out.
    pub(super) balance_only: bool,
}

impl<T: Scalar> Conditions<T> {
    /// Displacement of a point of body or rack.
    #[inline(always)]
    pub(super) fn ground(&self, on_rack: bool) -> Vector3<T> {
        let zero = self.rack.zero();
        let along = if on_rack { self.rack } else { zero };
        Vector3::new(zero, along, zero)
    }

    #[inline(always)]
    fn force(
        &self,
        bushing: &Bushing<T>,
        e: Vector3<T>,
        turn: &Matrix3<T>,
        body: Option<&Matrix3<T>>,
    ) -> BushingForce<T> {
        if self.balance_only {
            bushing.slack()
        } else {
            bushing.force(e, turn, body)
        }
    }
}

/// State of the inner unknowns of a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct LimbState<T> {
    /// The part's own position. Its shift is used by links with a bushing at either end.
    pub(super) placed: Placed<T>,
    /// Components of the force in a ball joint at the body.
    pub(super) pivot: [T; 2],
    /// Slide of a strut, or tan(theta/2) of a rocker.
    pub(super) slide: T,
}

impl<T: Scalar> LimbState<T> {
    pub(super) fn design(like: T) -> Self {
        LimbState {
            placed: Placed::design(like),
            pivot: [like.zero(); 2],
            slide: like.zero(),
        }
    }

    pub(super) fn map<U>(&self, f: impl Fn(T) -> U + Copy) -> LimbState<U> {
        LimbState {
            placed: self.placed.map(f),
            pivot: self.pivot.map(f),
            slide: f(self.slide),
        }
    }
}

/// How inner unknowns follow: dy = -(rest + by dx). Equation (1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Followers<T> {
    pub(super) count: usize,
    by: [[T; 6]; 6],
    rest: [T; 6],
    /// Lever of the point whose displacement is x; `None` where x is the carrier's shift and turn.
    joint: Option<Vector3<T>>,
    /// The rocker's turn, from the displacement of the seat at this lever from the joint.
    slide: Option<(Vector3<T>, Vector3<T>, T)>,
}

/// A change of the inner unknowns of a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct LimbStep<T> {
    pub(super) inner: [T; 6],
    pub(super) slide: T,
}

impl<T: Scalar> Followers<T> {
    pub(super) fn none(like: T) -> Self {
        Followers {
            count: 0,
            by: [[like.zero(); 6]; 6],
            rest: [like.zero(); 6],
            joint: None,
            slide: None,
        }
    }

    /// One inner unknown, the slide of a strut.
    pub(super) fn of_one(like: T) -> Self {
        Followers {
            count: 1,
            ..Followers::none(like)
        }
    }

    pub(super) fn by_first(&mut self, column: usize, by: T) {
        self.by[0][column] = by;
    }

    pub(super) fn set_rest(&mut self, rest: T) {
        self.rest[0] = rest;
    }

    /// A rocker behind a seat: its lever from the joint, how it follows the seat, and what is left.
    pub(super) fn of_joint(joint: Vector3<T>, slide: Option<(T, Vector3<T>, T)>) -> Self {
        let slide = slide.map(|(zero, by, rest)| (Vector3::new(zero, zero, zero), by, rest));
        Followers {
            joint: Some(joint),
            slide,
            ..Followers::none(joint.x)
        }
    }

    /// The same behind a seat on the carrier.
    pub(super) fn of_carrier(like: T, slide: Option<(Vector3<T>, Vector3<T>, T)>) -> Self {
        Followers {
            slide,
            ..Followers::none(like)
        }
    }

    /// The step of the inner unknowns after a step of the carrier. `is_rate`: the rate along a motion in balance,
    /// which has no rest.
    #[inline(always)]
    pub(super) fn step(&self, carrier: &[T; 6], is_rate: bool) -> LimbStep<T> {
        let [x, y, z, a, b, c] = *carrier;
        let mut outer = [x, y, z, a, b, c];
        let mut dimensions = 6;
        let mut joint = Vector3::new(x, y, z);
        if let Some(lever) = self.joint {
            joint = joint + Vector3::new(a, b, c).cross(lever);
            outer[..3].copy_from_slice(&joint.to_array());
            dimensions = 3;
        }
        let mut inner = [x.zero(); 6];
        for (k, inner) in inner.iter_mut().enumerate().take(self.count) {
            let mut sum = if is_rate { x.zero() } else { self.rest[k] };
            for (by, outer) in self.by[k].iter().zip(&outer).take(dimensions) {
                sum = sum + *by * *outer;
            }
            *inner = -sum;
        }
        let slide = self.slide.map_or(x.zero(), |(lever, by, rest)| {
            let turn = match self.count {
                0 => Vector3::new(a, b, c),
                _ => Vector3::new(inner[0], inner[1], inner[2]),
            };
            let at = joint + turn.cross(lever);
            let rest = if is_rate { x.zero() } else { rest };
            -(rest + by.dot(at))
        });
        LimbStep { inner, slide }
    }
}

/// One evaluation of a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evaluated<T> {
    pub(super) followers: Followers<T>,
    /// Forces on the inner unknowns, and the moment about a rocker's axis: what is out of balance.
    pub(super) inner: [T; 7],
    /// False if the inner unknowns move away by themselves.
    pub(super) is_stable: bool,
    /// Least by largest pivot of the inner equations: 0 if nothing holds a motion. Turns are compared with shifts at the
    /// part's length.
    pub(super) least_pivot: f64,
}

/// Solved inner equations: m_y^-1 m, m_y^-1 m_x, and the least by the largest pivot.
struct Eliminated<T, const N: usize, const C: usize> {
    rest: [T; N],
    by: [[T; C]; N],
    least_pivot: f64,
}

/// Solves the inner equations. `units` are lengths by which pivots are divided twice. `None` if a direction has no
/// stiffness.
#[inline(always)]
fn eliminated<T: Scalar, const N: usize, const C: usize>(
    own: [[T; N]; N],
    force: [T; N],
    by: &[[T; C]; N],
    units: [f64; N],
) -> Option<Eliminated<T, N, C>> {
    let factors = Lu::of(own, 1.0)?;
    let rest = factors.solve(force);
    let mut followers = *by;
    for k in 0..C {
        let column: [T; N] = std::array::from_fn(|i| by[i][k]);
        for (row, value) in followers.iter_mut().zip(factors.solve(column)) {
            row[k] = value;
        }
    }
    let (mut least, mut largest) = (f64::INFINITY, 0.0);
    for (pivot, unit) in factors.pivots().into_iter().zip(units) {
        let size = pivot.value().abs() / (unit * unit);
        least = if size < least { size } else { least };
        largest = if size > largest { size } else { largest };
    }
    Some(Eliminated {
        rest,
        by: followers,
        least_pivot: least / largest,
    })
}

/// Returns true if the symmetric part of a matrix is positive definite: all pivots of LDL' are above this share of the
/// largest.
#[inline(always)]
pub(super) fn is_positive<T: Scalar, const N: usize>(
    matrix: &[[T; N]; N],
    least_share: f64,
) -> bool {
    let mut a: [[f64; N]; N] = std::array::from_fn(|i| {
        std::array::from_fn(|j| 0.5 * (matrix[i][j].value() + matrix[j][i].value()))
    });
    let mut largest = 0.0;
    for k in 0..N {
        if a[k][k].is_nan() || a[k][k] <= least_share * largest {
            return false;
        }
        largest = if a[k][k] > largest { a[k][k] } else { largest };
        for i in k + 1..N {
            let factor = a[i][k] / a[k][k];
            for j in k + 1..N {
                a[i][j] -= factor * a[k][j];
            }
        }
    }
    true
}

/// An end of an arm or a link at body or rack.
#[derive(Clone, Debug)]
pub(super) struct End<T> {
    /// From the part's reference point, in the design position.
    pub(super) lever: Vector3<T>,
    pub(super) on_rack: bool,
    /// The bushing; `None` for a ball joint.
    pub(super) bushing: Option<Bushing<T>>,
    /// Two directions normal to the lever, for the force in a ball joint.
    pub(super) normals: [Vector3<T>; 2],
}

/// An arm, or a link with a ball joint at the carrier. Its reference point is that joint; 3 turns are inner unknowns.
/// The distance between a ball joint at the body and the outer joint is a rigid rod of the carrier's.
#[derive(Clone, Debug)]
pub(super) struct Swinging<T> {
    /// The outer joint, from the carrier's reference point.
    pub(super) joint: Vector3<T>,
    pub(super) ends: Vec<End<T>>,
    /// The spring's seat on the arm with its lever from the outer joint.
    pub(super) seat: Option<(Vector3<T>, Seat<T>)>,
    /// A direction about which nothing but torsion holds the part: a link's line. Scaled, see [`Bushing::slack`].
    pub(super) spin: Option<Vector3<T>>,
}

impl<T: Scalar> Swinging<T> {
    /// Displacement of an end against what holds it.
    pub(super) fn deflection(
        &self,
        end: &End<T>,
        at: &Conditions<T>,
        state: &LimbState<T>,
    ) -> Vector3<T> {
        let joint = at.carrier.displacement(self.joint);
        joint + state.placed.turn.apply(end.lever) - at.ground(end.on_rack)
    }

    /// State of a bushing at an end.
    pub(super) fn bushing_state(
        &self,
        end: &End<T>,
        bushing: &Bushing<T>,
        at: &Conditions<T>,
        state: &LimbState<T>,
    ) -> BushingState<T> {
        bushing.state(self.deflection(end, at, state), &state.placed.turn)
    }

    /// Displacement of the spring's seat.
    pub(super) fn seat_displacement(
        &self,
        lever: Vector3<T>,
        at: &Conditions<T>,
        state: &LimbState<T>,
    ) -> Vector3<T> {
        at.carrier.displacement(self.joint) + state.placed.turn.apply(lever)
    }

    #[inline(always)]
    pub(super) fn evaluate(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
    ) -> Option<Evaluated<T>> {
        let like = at.rack;
        let own = state.placed;
        let mut all = PointForce::none(like);
        let nothing = all.stiffness;
        let (mut moment, mut by_joint, mut by_turn) = (all.force, nothing, nothing);
        let mut joint_by_turn = nothing;
        let mut add = |lever: Vector3<T>, point: &PointForce<T>| {
            all.force = all.force + point.force;
            all.condensed = all.condensed + point.condensed;
            all.stiffness = all.stiffness.plus(&point.stiffness);
            let across = cross_matrix(lever);
            let left = point.stiffness.crossed_by(lever);
            joint_by_turn = joint_by_turn.plus(&point.stiffness.times(&across).negated());
            moment = moment + lever.cross(point.condensed);
            by_joint = by_joint.plus(&left);
            by_turn = by_turn.plus(&left.times(&across).negated());
            by_turn = by_turn.plus(&across.crossed_by(point.force));
        };
        let mut torque = nothing.columns[0];
        let mut torque_by_turn = nothing;
        let mut pivot = None;
        for end in &self.ends {
            let lever = own.lever(end.lever);
            match &end.bushing {
                Some(bushing) => {
                    let e = self.deflection(end, at, state);
                    let force = at.force(bushing, e, &own.turn, None);
                    add(lever, &PointForce::of(force.force, force.by_shift));
                    torque = torque + force.moment;
                    torque_by_turn = torque_by_turn.plus(&force.by_turn);
                }
                None => {
                    let [a, b] = end.normals;
                    let force = a * state.pivot[0] + b * state.pivot[1];
                    add(lever, &PointForce::of(force, nothing));
                    pivot = Some((end, lever));
                }
            }
        }
        let mut slide = None;
        let mut seat_moment = like.zero();
        let mut is_stable = true;
        if let Some((lever, seat)) = &self.seat {
            let moved = self.seat_displacement(*lever, at, state);
            let force = seat.force(moved, state.slide, held[6], at.balance_only);
            let now = own.lever(*lever);
            add(now, &force.point.leverless_if(at.balance_only));
            slide = force.slide.map(|slide| (now, slide.by, slide.rest));
            seat_moment = force.moment;
            is_stable = force.is_stable;
        }
        moment = moment + torque;
        by_turn = by_turn.plus(&torque_by_turn);
        if at.balance_only
            && let Some(spin) = self.spin
        {
            by_turn.add_product(spin, spin, like.one());
        }
        let lever = at.carrier.lever(self.joint);
        let mut followers = Followers::none(like);
        followers.joint = Some(lever);
        followers.slide = slide;
        let m = (moment - Vector3::new(held[0], held[1], held[2])).to_array();
        let (f_w, m_u, m_w) = (joint_by_turn, by_joint, by_turn);
        let mut inner = [like.zero(); 7];
        inner[6] = seat_moment;
        inner[..3].copy_from_slice(&m);
        let least_pivot;
        match pivot {
            None => {
                let rows: [[T; 3]; 3] = entries(&m_w);
                is_stable &= is_positive(&rows, 0.0);
                let found = eliminated(rows, m, &entries::<T, 3, 3>(&m_u), [1.0; 3])?;
                let Eliminated { rest, by, .. } = found;
                least_pivot = found.least_pivot;
                let mut turn = nothing;
                for k in 0..3 {
                    turn.columns[k] = Vector3::new(by[0][k], by[1][k], by[2][k]);
                    followers.by[k][..3].copy_from_slice(&by[k]);
                    followers.rest[k] = rest[k];
                }
                followers.count = 3;
                all.stiffness = all.stiffness.plus(&f_w.times(&turn).negated());
                all.condensed = all.condensed - f_w.apply(Vector3::from(rest));
            }
            Some((end, end_lever)) => {
                let miss = self.deflection(end, at, state);
                let along = end_lever.normalised();
                let about = along.dot(m_w.apply(along)).value();
                is_stable &= about > 0.0;
                let diagonal = (0..3).map(|k| m_w.entry(k, k).value().abs());
                least_pivot = about.abs() / diagonal.fold(0.0, f64::max);
                let mut rows = [[like.zero(); 5]; 5];
                let mut by_joint = [[like.zero(); 3]; 5];
                let mut force = [like.zero(); 5];
                let mut by_inner = [[like.zero(); 5]; 3];
                for i in 0..3 {
                    force[i] = m[i];
                    for j in 0..3 {
                        rows[i][j] = m_w.entry(i, j);
                        by_joint[i][j] = m_u.entry(i, j);
                        by_inner[i][j] = f_w.entry(i, j);
                    }
                }
                for (k, normal) in end.normals.into_iter().enumerate() {
                    let turning = end_lever.cross(normal).to_array();
                    let normal_of = normal.to_array();
                    force[3 + k] = normal.dot(miss);
                    inner[3 + k] = force[3 + k];
                    force[3 + k] = force[3 + k] - held[3 + k];
                    for i in 0..3 {
                        rows[3 + k][i] = turning[i];
                        rows[i][3 + k] = turning[i];
                        by_joint[3 + k][i] = normal_of[i];
                        by_inner[i][3 + k] = normal_of[i];
                    }
                }
                let Eliminated { rest, by, .. } = eliminated(rows, force, &by_joint, [1.0; 5])?;
                for i in 0..5 {
                    followers.by[i][..3].copy_from_slice(&by[i]);
                    followers.rest[i] = rest[i];
                }
                followers.count = 5;
                let mut change = nothing;
                let mut less = [like.zero(); 3];
                for i in 0..3 {
                    for (k, by_inner) in by_inner[i].into_iter().enumerate() {
                        less[i] = less[i] + by_inner * rest[k];
                    }
                }
                for j in 0..3 {
                    let mut column = [like.zero(); 3];
                    for i in 0..3 {
                        for (k, by_inner) in by_inner[i].into_iter().enumerate() {
                            column[i] = column[i] - by_inner * by[k][j];
                        }
                    }
                    change.columns[j] = Vector3::from(column);
                }
                all.stiffness = all.stiffness.plus(&change);
                all.condensed = all.condensed - Vector3::from(less);
            }
        }
        sum.add_point(lever, &all);
        Some(Evaluated {
            followers,
            inner,
            is_stable,
            least_pivot,
        })
    }
}

/// The entries of a matrix, by rows.
#[inline(always)]
fn entries<T: Scalar, const N: usize, const C: usize>(matrix: &Matrix3<T>) -> [[T; C]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix.entry(i, j)))
}

/// A link with a bushing at the carrier. Its reference point is its inner end.
#[derive(Clone, Debug)]
pub(super) struct Floating<T> {
    /// From inner to outer end.
    pub(super) along: Vector3<T>,
    pub(super) on_rack: bool,
    /// The bushing at the inner end; `None` for a ball joint.
    pub(super) inner: Option<Bushing<T>>,
    /// The bushing at the carrier.
    pub(super) outer: Bushing<T>,
    /// The outer end, from the carrier's reference point.
    pub(super) joint: Vector3<T>,
    /// As [`Swinging::spin`].
    pub(super) spin: Vector3<T>,
}

impl<T: Scalar> Floating<T> {
    /// The link's position, with the shift of its inner end.
    fn placed(&self, at: &Conditions<T>, state: &LimbState<T>) -> Placed<T> {
        let shift = match self.inner {
            Some(_) => state.placed.shift,
            None => at.ground(self.on_rack),
        };
        Placed {
            shift,
            turn: state.placed.turn,
        }
    }

    /// e of the outer bushing in the carrier's axes, and R_i' R_j - I.
    fn at_carrier(&self, at: &Conditions<T>, own: &Placed<T>) -> (Vector3<T>, Matrix3<T>) {
        let e = own.displacement(self.along) - at.carrier.displacement(self.joint);
        let back = at.carrier.turn.transposed();
        let turn = back.plus(&own.turn).plus(&back.times(&own.turn));
        (e, turn)
    }

    /// States of the bushings, the inner one first.
    pub(super) fn bushing_states(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
    ) -> [Option<BushingState<T>>; 2] {
        let own = self.placed(at, state);
        let inner = self
            .inner
            .as_ref()
            .map(|bushing| bushing.state(own.shift - at.ground(self.on_rack), &own.turn));
        let (e, turn) = self.at_carrier(at, &own);
        let in_carrier = at.carrier.rotation().apply_transposed(e);
        [inner, Some(self.outer.state(in_carrier, &turn))]
    }

    #[inline(always)]
    pub(super) fn evaluate(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
    ) -> Option<Evaluated<T>> {
        let like = at.rack;
        let own = self.placed(at, state);
        let (e, turn) = self.at_carrier(at, &own);
        let rotation = at.carrier.rotation();
        let outer = at.force(&self.outer, e, &turn, Some(&rotation));
        // Tangents by the displacement of the outer point p, by the carrier's shift u and turn q, by the link's turn w.
        let arm = own.lever(self.along);
        let lever = at.carrier.lever(self.joint) + e;
        let (f, k, n) = (outer.force, outer.by_shift, outer.by_turn);
        let f_q = cross_matrix(f).negated().plus(&k.times_cross(lever));
        let m_q = cross_matrix(outer.moment).negated().plus(&n.negated());
        // The link: force f at p and torque; its unknowns v (shift) and w.
        let k_arm = k.times_cross(arm).negated();
        let mut own_rows = [[Matrix3::null(like); 2]; 2];
        own_rows[0] = [k, k_arm];
        let ww = k_arm
            .crossed_by(arm)
            .plus(&cross_matrix(arm).crossed_by(f))
            .plus(&n);
        own_rows[1] = [k.crossed_by(arm), ww];
        let mut forces = [f, arm.cross(f) + outer.moment];
        let by_carrier = [
            [k.negated(), f_q],
            [k.crossed_by(arm).negated(), f_q.crossed_by(arm).plus(&m_q)],
        ];
        if let Some(bushing) = &self.inner {
            let e = own.shift - at.ground(self.on_rack);
            let inner = at.force(bushing, e, &own.turn, None);
            forces[0] = forces[0] + inner.force;
            forces[1] = forces[1] + inner.moment;
            own_rows[0][0] = own_rows[0][0].plus(&inner.by_shift);
            own_rows[1][1] = own_rows[1][1].plus(&inner.by_turn);
        }
        if at.balance_only {
            own_rows[1][1].add_product(self.spin, self.spin, like.one());
        }
        // The carrier: -f at p and -torque.
        let carrier_by_link = [
            [k.negated(), k_arm.negated()],
            [
                cross_matrix(f).plus(&k.crossed_by(lever).negated()),
                cross_matrix(f)
                    .times_cross(arm)
                    .negated()
                    .plus(&k_arm.crossed_by(lever).negated())
                    .plus(&n.negated()),
            ],
        ];
        let carrier_own = [
            [k, f_q.negated()],
            [
                cross_matrix(f).negated().plus(&k.crossed_by(lever)),
                f_q.crossed_by(lever).negated().plus(&m_q.negated()),
            ],
        ];
        sum.add_force(-f, -(lever.cross(f) + outer.moment));
        let [[a, b], [c, d]] = &carrier_own;
        sum.add_blocks([[a, b], [c, d]]);
        let blocks = LinkBlocks {
            own: own_rows,
            forces,
            by_carrier,
            carrier_by_link,
            length: self.along.norm().value(),
        };
        match self.inner {
            Some(_) => blocks.eliminate::<6>(0, held, sum),
            None => blocks.eliminate::<3>(3, held, sum),
        }
    }
}

/// Blocks of a link's equations by its own shift and turn and by the carrier's.
struct LinkBlocks<T> {
    own: [[Matrix3<T>; 2]; 2],
    forces: [Vector3<T>; 2],
    by_carrier: [[Matrix3<T>; 2]; 2],
    carrier_by_link: [[Matrix3<T>; 2]; 2],
    /// Length of the link.
    length: f64,
}

impl<T: Scalar> LinkBlocks<T> {
    /// Eliminates the unknowns from number `first` on, `N` of them.
    #[inline(always)]
    fn eliminate<const N: usize>(
        &self,
        first: usize,
        held: &[T; 7],
        sum: &mut Sum<T>,
    ) -> Option<Evaluated<T>> {
        let like = self.forces[0].x;
        let entry = |blocks: &[[Matrix3<T>; 2]; 2], i: usize, j: usize| {
            blocks[i / 3][j / 3].entry(i % 3, j % 3)
        };
        let own: [[T; N]; N] = std::array::from_fn(|i| {
            std::array::from_fn(|j| entry(&self.own, first + i, first + j))
        });
        let by: [[T; 6]; N] =
            std::array::from_fn(|i| std::array::from_fn(|j| entry(&self.by_carrier, first + i, j)));
        let mut inner = [like.zero(); 7];
        let force: [T; N] = std::array::from_fn(|i| {
            let k = first + i;
            self.forces[k / 3].to_array()[k % 3] - held[i]
        });
        inner[..N].copy_from_slice(&force);
        let units = std::array::from_fn(|k| if first + k < 3 { 1.0 } else { self.length });
        let found = eliminated(own, force, &by, units)?;
        let Eliminated { rest, by, .. } = found;
        for i in 0..6 {
            for k in 0..N {
                let factor = entry(&self.carrier_by_link, i, first + k);
                sum.force[i] = sum.force[i] - factor * rest[k];
                for (total, by) in sum.tangent[i].iter_mut().zip(by[k]) {
                    *total = *total - factor * by;
                }
            }
        }
        let mut followers = Followers::none(like);
        followers.count = N;
        followers.by[..N].copy_from_slice(&by);
        followers.rest[..N].copy_from_slice(&rest);
        Some(Evaluated {
            followers,
            inner,
            is_stable: is_positive(&own, 0.0),
            least_pivot: found.least_pivot,
        })
    }
}

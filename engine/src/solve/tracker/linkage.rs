//! Six unknowns: the pose of the knuckle, solved from the closure equations.
//!
//! The unknowns are the displacement of the knuckle's origin, and its rotation from the design position as tan(angle/2)
//! times the axis. At a prediction, a step of Newton's method on five constraints and the travel
//!
//! ```text
//! J (v, w) = -F        x + v,  r + h + h x r + r (r.h),  h = w/2
//! ```
//!
//! leaves an error of second order. The residuals at the result show if that is accurate enough. If so, one more step with J
//! removes the remaining residuals, because they would disturb rates near a fold.
//!
//! J, its moments divided by the size of the mechanism, is split into four blocks of three by three,
//!
//! ```text
//! J = | A  B |        S = D - C A^-1 B,   det J = det A det S
//!     | C  D |
//! ```
//!
//! in an order of rows and columns that a factorisation with complete pivoting finds for the base design. Then only two
//! determinants must not vanish. A lane is rejected if one of them is less than a fourth of the base design's. It is also
//! rejected if one changes by more than half, or doubles, from one place to the next. The determinants of a lane are those
//! of the step with which it settled.
//!
//! An instantaneous steering axis is that of the screw J t = -F_r (module `steering`). Along the motion t' follows from J t'
//! = -(F_r' + J' t).

#![allow(
    clippy::needless_range_loop,
    reason = "the closures of iterators may be left as calls, compiled for no lanes"
)]

#[cfg(test)]
mod guards;

use super::pair::{Corrected, Linear as Motion, Wheel, WheelOnKnuckle};
use super::route::RouteStep;
use super::track::{PlaceEquations, kept, predicted};
use super::{
    Acceptance, AdjointConstants, InKnuckle, KnuckleVector, LaneAdjoint, LanePose, LaneRates,
    Rejection, Visit, within_half,
};
use crate::derive::Gradient;
use crate::derive::sensitivity::HardpointGradient;
use crate::derive::steering::screw_axis;
use crate::mechanism::RowSet;
use crate::mechanism::{Closure, Driver};
use crate::mechanism::{Configuration, Pose, Twist, Wrench};
use crate::model::{Drive, Mechanism};
use crate::number::Jet;
use crate::number::Real;
use crate::number::{Matrix3, Vector3, outlined};
use crate::number::{Outlined, SimdReal};
use std::array::from_fn;
use std::cell::{Cell, Ref, RefCell};

/// Number of unknowns of a pose: three for the displacement of the knuckle's origin, three for its rotation (a Rodrigues
/// vector).
pub(crate) const UNKNOWNS: usize = 6;
/// Smallest determinant of a block, as a share of the base design's.
const LEAST: f64 = 0.25;
/// Smallest pivot of the base design.
const LEAST_PIVOT: f64 = 1e-3;
/// Largest correction of a prediction, in sizes.
const LARGEST_CORRECTION: f64 = 0.02;
/// Largest rotation of the knuckle in one step, as the tangent of half the angle. Together with the limits of the
/// determinants this keeps Newton's method on its branch. `tests/it/lanes.rs` compares every lane with the continuation.
const LONGEST: f64 = 0.1;
/// Smallest square of the knuckle's rotation per size of rack displacement. The steering axis is the axis of this rotation.
const LEAST_STEERING: f64 = 0.25;
/// Smallest squared sine of the angle between the steering axis and the horizontal. The inclinations of a nearly horizontal
/// axis are not accurate.
const LEAST_UPRIGHT: f64 = 0.04;
/// Largest square of the knuckle's rotation per size of travel.
const FASTEST_TURN: f64 = 100.0;
/// Largest number of corrections for a lane to settle.
const MOST_ROUNDS: usize = 5;

/// Equations of a mechanism without a closed form.
#[derive(Clone, Debug)]
pub(crate) struct ByLinkage {
    order: Order,
    size: f64,
    /// Determinants of A and S in the base design.
    determinants: [f64; 2],
    /// Derivatives of the unknowns by travel and by the rack, in the base design.
    by_travel: [f64; UNKNOWNS],
    by_rack: [f64; UNKNOWNS],
}

/// An order of rows and columns.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Order {
    rows: [usize; 6],
    columns: [usize; 6],
    /// Position of each row in this order.
    places: [usize; 6],
}

/// The constants of a design in each lane.
#[derive(Clone)]
pub(crate) struct LinkageDesign<'d, B> {
    mechanism: &'d Mechanism,
    design: &'d [Vector3<B>],
    closure: Closure<B>,
}

impl<'d, B: Real> LinkageDesign<'d, B> {
    #[inline(always)]
    pub(crate) fn new(mechanism: &'d Mechanism, design: &'d [Vector3<B>]) -> Self {
        LinkageDesign {
            mechanism,
            design,
            closure: Closure::new(mechanism, design),
        }
    }

    /// Configuration of the mechanism with these unknowns.
    #[inline(always)]
    fn configuration(&self, [x, y, z, a, b, c]: [B; UNKNOWNS], rack: B) -> Configuration<'d, B> {
        let shift = Vector3::new(x, y, z);
        Configuration {
            mechanism: self.mechanism,
            design: self.design,
            pose: Pose {
                origin: self.design[self.mechanism.origin.0] + shift,
                rotation: Matrix3::by_rodrigues(Vector3::new(a, b, c)),
            },
            rack,
            steering: None,
        }
    }
}

/// Blocks of a Jacobian. They are filled in place, because moving them would take a quarter of the time.
struct Blocks<B> {
    order: Order,
    inverse_size: B,
    /// Rows of A above rows of C.
    left: [Vector3<B>; 6],
    /// Rows of B above rows of D.
    right: [Vector3<B>; 6],
    inverse_a: Inverse<B>,
    /// Rows of A^-1 B.
    w: [Vector3<B>; 3],
    inverse_s: Inverse<B>,
}

/// Inverse of a matrix of three rows, and the determinant of the matrix.
#[derive(Clone, Copy)]
struct Inverse<B> {
    matrix: Matrix3<B>,
    determinant: B,
}

impl<B: Real> Inverse<B> {
    #[inline(always)]
    fn of([a, b, c]: [Vector3<B>; 3]) -> Self {
        let across = b.cross(c);
        let determinant = a.dot(across);
        let inverse = determinant.one() / determinant;
        Inverse {
            matrix: Matrix3 {
                columns: [across * inverse, c.cross(a) * inverse, a.cross(b) * inverse],
            },
            determinant,
        }
    }
}

/// Three entries of a row, in an order of columns.
#[inline(always)]
fn three<B: Copy>(row: &[B; 6], columns: &[usize; 6], first: usize) -> Vector3<B> {
    Vector3::new(
        row[columns[first]],
        row[columns[first + 1]],
        row[columns[first + 2]],
    )
}

/// Sum x a + y b + z c.
#[inline(always)]
fn combined<B: Real>([a, b, c]: [Vector3<B>; 3], x: B, y: B, z: B) -> Vector3<B> {
    (a * x).plus_scaled(b, y).plus_scaled(c, z)
}

impl<B: Real> Blocks<B> {
    /// Blocks of zeros. They must be filled before use.
    #[inline(always)]
    fn unformed(order: Order, inverse_size: B) -> Self {
        let zero = inverse_size.zero();
        let null = Vector3::new(zero, zero, zero);
        let unformed = Inverse {
            matrix: Matrix3 { columns: [null; 3] },
            determinant: zero,
        };
        Blocks {
            order,
            inverse_size,
            left: [null; 6],
            right: [null; 6],
            inverse_a: unformed,
            w: [null; 3],
            inverse_s: unformed,
        }
    }

    /// Converts the square of a rotation per size to the square of a rotation per length.
    #[inline(always)]
    fn per_size(&self, square: f64) -> B {
        self.inverse_size * self.inverse_size * self.inverse_size.constant(square)
    }

    /// Stores a row of the Jacobian.
    #[inline(always)]
    fn put(&mut self, number: usize, wrench: &Wrench<B>) {
        let Wrench { force, moment, .. } = *wrench;
        let m = moment * self.inverse_size;
        let row = [force.x, force.y, force.z, m.x, m.y, m.z];
        let place = self.order.places[number];
        self.left[place] = three(&row, &self.order.columns, 0);
        self.right[place] = three(&row, &self.order.columns, 3);
    }

    /// Computes inverses and determinants after all rows are stored.
    #[inline(always)]
    fn eliminate(&mut self) {
        let [a0, a1, a2, ..] = self.left;
        self.inverse_a = Inverse::of([a0, a1, a2]);
        let [p, q, r] = self.inverse_a.matrix.columns;
        let [b0, b1, b2, d0, d1, d2] = self.right;
        let b = [b0, b1, b2];
        let w = [
            combined(b, p.x, q.x, r.x),
            combined(b, p.y, q.y, r.y),
            combined(b, p.z, q.z, r.z),
        ];
        let [c0, c1, c2] = self.c();
        self.inverse_s = Inverse::of([
            d0 - combined(w, c0.x, c0.y, c0.z),
            d1 - combined(w, c1.x, c1.y, c1.z),
            d2 - combined(w, c2.x, c2.y, c2.z),
        ]);
        self.w = w;
    }

    /// Rows of C.
    #[inline(always)]
    fn c(&self) -> [Vector3<B>; 3] {
        let [.., c0, c1, c2] = self.left;
        [c0, c1, c2]
    }

    /// Solves J (v, w) = f for the twist (v, w).
    #[inline(always)]
    fn solve(&self, f: [B; 6]) -> Twist<B> {
        outlined!(
            [B: Real] f[0]; blocks: &'p Blocks<B> = self, f: [B; 6] = f => Twist<B> { blocks.solve_inline(f) }
        )
    }

    #[inline(always)]
    fn solve_inline(&self, f: [B; 6]) -> Twist<B> {
        let (above, below) = (
            three(&f, &self.order.rows, 0),
            three(&f, &self.order.rows, 3),
        );
        let upper = self.inverse_a.matrix.apply(above);
        let [c0, c1, c2] = self.c();
        let lower = self.inverse_s.matrix.apply(Vector3::new(
            below.x - c0.dot(upper),
            below.y - c1.dot(upper),
            below.z - c2.dot(upper),
        ));
        let upper = upper
            - Vector3::new(
                self.w[0].dot(lower),
                self.w[1].dot(lower),
                self.w[2].dot(lower),
            );
        let solution = [upper.x, upper.y, upper.z, lower.x, lower.y, lower.z];
        let mut twist = solution;
        for k in 0..6 {
            twist[self.order.columns[k]] = solution[k];
        }
        let Twist { shift, turn } = Twist::from_array(twist);
        Twist {
            shift,
            turn: turn * self.inverse_size,
        }
    }

    /// Solves J^T m = wrench for the multipliers m.
    #[inline(always)]
    fn solve_transposed(&self, wrench: &Wrench<B>) -> [B; 6] {
        let (force, moment) = (wrench.force, wrench.moment * self.inverse_size);
        let w = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
        let (above, below) = (
            three(&w, &self.order.columns, 0),
            three(&w, &self.order.columns, 3),
        );
        let lower = self
            .inverse_s
            .matrix
            .apply_transposed(below - combined(self.w, above.x, above.y, above.z));
        let upper = self
            .inverse_a
            .matrix
            .apply_transposed(above - combined(self.c(), lower.x, lower.y, lower.z));
        let solution = [upper.x, upper.y, upper.z, lower.x, lower.y, lower.z];
        let mut multipliers = solution;
        for k in 0..6 {
            multipliers[self.order.rows[k]] = solution[k];
        }
        multipliers
    }

    #[inline(always)]
    fn determinants(&self) -> [B; 2] {
        [self.inverse_a.determinant, self.inverse_s.determinant]
    }
}

/// The first derivatives of a vector of series.
#[inline(always)]
fn slope<B: Real>(vector: Vector3<Jet<B, 2>>) -> Vector3<B> {
    Vector3::new(vector.x[1], vector.y[1], vector.z[1])
}

/// The unknowns after a small twist of the knuckle.
#[inline(always)]
fn moved<B: Real>(unknowns: [B; UNKNOWNS], twist: &Twist<B>) -> [B; UNKNOWNS] {
    let [x, y, z, a, b, c] = unknowns;
    let turned = Vector3::new(a, b, c);
    let half = turned.x.constant(0.5);
    let h = twist.turn * half;
    let r = (turned + h + h.cross(turned)).plus_scaled(turned, turned.dot(h));
    let v = twist.shift;
    [x + v.x, y + v.y, z + v.z, r.x, r.y, r.z]
}

/// A pose of a linkage.
pub(crate) struct LinkagePose<'p, 'd, B> {
    linkage: &'p LinkageDesign<'d, B>,
    at: Configuration<'d, B>,
    travel: B,
    /// Storage for the equations linearised about the pose. `is_linear` is true once they are computed.
    linear: &'p RefCell<Linear<B>>,
    is_linear: Cell<bool>,
}

/// Closure equations linearised about a configuration.
struct Linear<B> {
    residuals: [B; 6],
    /// Derivatives by the displacement of the rack.
    by_rack: [B; 6],
    blocks: Blocks<B>,
}

/// Work piece that computes [`Linear`].
struct Linearising<'p, 'd, B> {
    linkage: &'p LinkageDesign<'d, B>,
    at: &'p Configuration<'d, B>,
    travel: B,
    linear: &'p mut Linear<B>,
}

impl<B: SimdReal> Outlined for Linearising<'_, '_, B> {
    type Output = ();

    #[inline(always)]
    fn work(self) {
        let driver = Driver::Travel(self.travel);
        let linear = self.linear;
        for number in 0..6 {
            let (residual, wrench) = self.linkage.closure.row(number, self.at, driver);
            linear.residuals[number] = residual;
            linear.by_rack[number] = wrench.rack;
            linear.blocks.put(number, &wrench);
        }
        linear.blocks.eliminate();
    }
}

impl<B: SimdReal> Linear<B> {
    /// Equations of zeros. They must be computed before use.
    #[inline(always)]
    fn unformed(method: &ByLinkage, like: B) -> Self {
        let zero = like.zero();
        Linear {
            residuals: [zero; 6],
            by_rack: [zero; 6],
            blocks: Blocks::unformed(method.order, like.constant(1.0 / method.size)),
        }
    }

    /// The twist of the knuckle per unit of rack displacement.
    #[inline(always)]
    fn steering(&self) -> Twist<B> {
        -self.blocks.solve(self.by_rack)
    }
}

impl<B: SimdReal> LinkagePose<'_, '_, B> {
    /// Equations linearised about the pose, computed at the first request.
    #[inline(always)]
    fn linear(&self) -> Ref<'_, Linear<B>> {
        if !self.is_linear.replace(true) {
            self.travel.outlined(Linearising {
                linkage: self.linkage,
                at: &self.at,
                travel: self.travel,
                linear: &mut self.linear.borrow_mut(),
            });
        }
        self.linear.borrow()
    }
}

impl<B: SimdReal> LanePose<B> for LinkagePose<'_, '_, B> {
    #[inline(always)]
    fn vector(&self, vector: &KnuckleVector<B>) -> Vector3<B> {
        match vector.0 {
            InKnuckle::Designed(vector) => self.at.pose.rotation.apply(vector),
            InKnuckle::Carried(_) => unreachable!("a vector of a linkage"),
        }
    }

    #[inline(always)]
    fn origin(&self) -> Vector3<B> {
        self.at.pose.origin
    }

    #[inline(always)]
    fn steering_axis(&self) -> (Vector3<B>, Vector3<B>, B::Mask) {
        let linear = self.linear();
        let steering = linear.steering();
        let (point, direction) = screw_axis(self.at.pose.origin, &steering);
        let (turn, square) = (steering.turn, steering.turn.norm_squared());
        let is_known = linear.blocks.per_size(LEAST_STEERING).less(square)
            & (square * turn.z.constant(LEAST_UPRIGHT)).less(turn.z * turn.z);
        (point, direction, is_known)
    }

    #[inline(always)]
    fn rates(&self) -> LaneRates<B> {
        let mut by_travel = [self.travel.zero(); 6];
        by_travel[5] = self.travel.one();
        let twist = self.linear().blocks.solve(by_travel);
        LaneRates {
            origin: twist.shift,
            turn: twist.turn,
            steering_axis: twist.turn.zero(),
        }
    }

    #[inline(always)]
    fn by_rack(&self, _: &LaneRates<B>) -> Twist<B> {
        self.linear().steering()
    }

    #[inline(always)]
    fn velocity_is_reliable(&self, rates: &LaneRates<B>) -> B::Mask {
        let fastest = self.linear().blocks.per_size(FASTEST_TURN);
        rates.turn.norm_squared().less(fastest)
    }

    #[inline(always)]
    fn steering_axis_rates(&self, rates: &LaneRates<B>) -> (Vector3<B>, Vector3<B>) {
        let linear = self.linear();
        let by_rack = linear.steering();
        let motion = Twist {
            shift: rates.origin,
            turn: rates.turn,
        };
        let slopes = self.linkage.closure.wrench_rates(&self.at, &motion);
        let mut right = [self.travel.zero(); 6];
        for k in 0..6 {
            let Wrench {
                force,
                moment,
                rack,
            } = slopes[k];
            right[k] = -(rack + force.dot(by_rack.shift) + moment.dot(by_rack.turn));
        }
        let rate = linear.blocks.solve(right);
        let moving = Twist {
            shift: by_rack.shift.with_rate(rate.shift),
            turn: by_rack.turn.with_rate(rate.turn),
        };
        let (point, direction) = screw_axis(self.at.pose.origin.with_rate(rates.origin), &moving);
        (slope(point), slope(direction))
    }

    #[inline(always)]
    fn configuration(&self, _: B) -> Configuration<'_, B> {
        self.at
    }

    #[inline(always)]
    fn adjoint<'p>(
        &'p self,
        _: &'p AdjointConstants<B>,
        at: &'p Configuration<'p, B>,
        _: &LaneRates<B>,
    ) -> impl LaneAdjoint<B> + 'p {
        LinkageAdjoint {
            closure: &self.linkage.closure,
            at,
            travel: self.travel,
            linear: self.linear(),
        }
    }
}

/// Computes gradients from the closure equations in a pose.
struct LinkageAdjoint<'p, B> {
    closure: &'p Closure<B>,
    at: &'p Configuration<'p, B>,
    travel: B,
    linear: Ref<'p, Linear<B>>,
}

impl<B: SimdReal> LaneAdjoint<B> for LinkageAdjoint<'_, B> {
    #[inline(always)]
    fn subtract(&self, wrench: &Wrench<B>, gradient: &mut (impl Gradient<B> + ?Sized)) {
        let mut multipliers = self.linear.blocks.solve_transposed(wrench);
        for multiplier in &mut multipliers {
            *multiplier = -*multiplier;
        }
        let driver = Driver::Travel(self.travel);
        let mut sink = HardpointGradient(gradient);
        self.closure
            .differential_inlined(RowSet::ALL, self.at, driver, &multipliers, &mut sink);
    }
}

/// Work piece that computes the equations along the travel.
struct FormingSeries<'p, B> {
    closure: &'p Closure<Jet<B, 2>>,
    at: &'p Configuration<'p, Jet<B, 2>>,
    blocks: &'p mut Blocks<Jet<B, 2>>,
}

impl<B: SimdReal> Outlined for FormingSeries<'_, B> {
    type Output = ();

    #[inline(always)]
    fn work(self) {
        // The rows do not depend on the value of the travel.
        let driver = Driver::Travel(self.at.rack.zero());
        for number in 0..6 {
            let (_, wrench) = self.closure.row(number, self.at, driver);
            self.blocks.put(number, &wrench);
        }
        self.blocks.eliminate();
    }
}

/// Computes gradients as series along the travel, from the closure equations as series.
pub(crate) struct SeriesAdjoint<'p, B> {
    closure: &'p Closure<Jet<B, 2>>,
    at: &'p Configuration<'p, Jet<B, 2>>,
    blocks: Blocks<Jet<B, 2>>,
}

/// Work piece that subtracts the closure equations' part of a derivative by the pose from a gradient.
struct SubtractingSeries<'p, B> {
    adjoint: &'p SeriesAdjoint<'p, B>,
    wrench: &'p Wrench<Jet<B, 2>>,
    gradient: &'p mut [Vector3<Jet<B, 2>>],
}

impl<B: SimdReal> Outlined for SubtractingSeries<'_, B> {
    type Output = ();

    #[inline(always)]
    fn work(self) {
        let SeriesAdjoint {
            closure,
            at,
            blocks,
        } = self.adjoint;
        let mut multipliers = blocks.solve_transposed(self.wrench);
        for multiplier in &mut multipliers {
            *multiplier = -*multiplier;
        }
        let driver = Driver::Travel(at.rack.zero());
        let mut sink = HardpointGradient(self.gradient);
        closure.differential_inlined(RowSet::ALL, at, driver, &multipliers, &mut sink);
    }
}

impl<B: SimdReal> SeriesAdjoint<'_, B> {
    /// The same as [`LaneAdjoint::subtract`], for series along the travel.
    #[inline(always)]
    pub(crate) fn subtract(&self, wrench: &Wrench<Jet<B, 2>>, gradient: &mut [Vector3<Jet<B, 2>>]) {
        self.at.rack.0[0].outlined(SubtractingSeries {
            adjoint: self,
            wrench,
            gradient,
        });
    }
}

impl ByLinkage {
    /// Adjoint at a configuration along the travel.
    #[inline(always)]
    pub(crate) fn series_adjoint<'p, B: SimdReal>(
        &self,
        closure: &'p Closure<Jet<B, 2>>,
        at: &'p Configuration<'p, Jet<B, 2>>,
    ) -> SeriesAdjoint<'p, B> {
        let like = at.rack.0[0];
        let mut blocks = Blocks::unformed(self.order, at.rack.constant(1.0 / self.size));
        like.outlined(FormingSeries {
            closure,
            at,
            blocks: &mut blocks,
        });
        SeriesAdjoint {
            closure,
            at,
            blocks,
        }
    }

    /// Prepares to solve designs of a mechanism driven by its travel. `None` if another quantity drives, or if designs
    /// near `base` cannot be tracked.
    pub(crate) fn of(
        mechanism: &Mechanism,
        base: &[Vector3<f64>],
        drive: Drive,
        size: f64,
    ) -> Option<ByLinkage> {
        (drive == Drive::Travel).then_some(())?;
        let linkage = LinkageDesign::new(mechanism, base);
        let at = linkage.configuration([0.0; UNKNOWNS], 0.0);
        let wrenches = linkage.closure.wrenches(&at, Driver::Travel(0.0));
        let mut blocks = Blocks::unformed(Order::of(&wrenches, size)?, 1.0 / size);
        for (number, wrench) in wrenches.iter().enumerate() {
            blocks.put(number, wrench);
        }
        blocks.eliminate();
        let slope = |twist: Twist<f64>| moved([0.0; UNKNOWNS], &twist);
        Some(ByLinkage {
            order: blocks.order,
            size,
            determinants: blocks.determinants(),
            by_travel: slope(blocks.solve([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])),
            by_rack: slope(blocks.solve(wrenches.map(|row| -row.rack))),
        })
    }

    /// Passes the poses with these unknowns to a visitor.
    #[inline(always)]
    pub(crate) fn visit_stations_in_lanes<B: SimdReal>(
        &self,
        linkage: &LinkageDesign<'_, B>,
        unknowns: [B; UNKNOWNS],
        travel: B,
        rack: B,
        visit: impl FnOnce(&LinkagePose<'_, '_, B>),
    ) {
        let room = RefCell::new(Linear::unformed(self, travel));
        visit(&LinkagePose {
            linkage,
            at: linkage.configuration(unknowns, rack),
            travel,
            linear: &room,
            is_linear: Cell::new(false),
        });
    }

    /// Equations of a single wheel, for a design of this tracker.
    #[inline(always)]
    pub(super) fn corner<'w, 'd, B: SimdReal, V: Visit<B>>(
        &'w self,
        linkage: &'w LinkageDesign<'d, B>,
        tolerance: f64,
        visitor: &'w mut V,
    ) -> LinkageCorner<'w, 'd, B, V> {
        let steps = NewtonSteps::of(self, linkage, tolerance);
        LinkageCorner {
            is_near: steps.determinants[0].everywhere(),
            steps,
            visitor,
        }
    }

    /// Equations of one wheel of a pair, for a design of this tracker.
    #[inline(always)]
    pub(super) fn wheel<'w, 'd, B: SimdReal>(
        &'w self,
        linkage: &'w LinkageDesign<'d, B>,
        on_knuckle: WheelOnKnuckle<B>,
        tolerance: f64,
    ) -> LinkageWheel<'w, 'd, B> {
        let steps = NewtonSteps::of(self, linkage, tolerance);
        let zero = steps.determinants[0];
        let null = Vector3::new(zero, zero, zero);
        let rest = Twist {
            shift: null,
            turn: null,
        };
        LinkageWheel {
            steps,
            on_knuckle,
            rest,
            by_travel: rest,
        }
    }
}

/// Newton steps in the six unknowns.
struct NewtonSteps<'w, 'd, B> {
    method: &'w ByLinkage,
    linkage: &'w LinkageDesign<'d, B>,
    tolerance: f64,
    /// Equations linearised about the latest unknowns.
    linear: RefCell<Linear<B>>,
    /// Determinants of A and S in the linearisation with which each lane converged.
    determinants: [B; 2],
}

impl<'w, 'd, B: SimdReal> NewtonSteps<'w, 'd, B> {
    #[inline(always)]
    fn of(method: &'w ByLinkage, linkage: &'w LinkageDesign<'d, B>, tolerance: f64) -> Self {
        let zero = linkage.design[0].x.zero();
        NewtonSteps {
            method,
            linkage,
            tolerance,
            linear: RefCell::new(Linear::unformed(method, zero)),
            determinants: [zero; 2],
        }
    }

    /// Linearises the equations about unknowns. Determinants of settled lanes do not change. Returns the configuration there
    /// and the Newton step.
    #[inline(always)]
    fn linearise(
        &mut self,
        unknowns: &[B; UNKNOWNS],
        [rack, travel]: [B; 2],
        settled: B::Mask,
    ) -> (Configuration<'d, B>, Twist<B>) {
        let at = self.linkage.configuration(*unknowns, rack);
        let linear = self.linear.get_mut();
        travel.outlined(Linearising {
            linkage: self.linkage,
            at: &at,
            travel,
            linear,
        });
        let [a, s] = linear.blocks.determinants();
        let [known_a, known_s] = self.determinants;
        self.determinants = [
            B::select(settled, known_a, a),
            B::select(settled, known_s, s),
        ];
        let step = -linear.blocks.solve(linear.residuals);
        (at, step)
    }

    /// Lanes in which a step is within the permitted error of a prediction.
    #[inline(always)]
    fn is_near(&self, step: &Twist<B>) -> B::Mask {
        let like = step.shift.x;
        let largest = like.constant(LARGEST_CORRECTION);
        let inverse_size = like.constant(1.0 / self.method.size);
        is_less(step.shift * inverse_size, largest) & is_less(step.turn, largest)
    }

    /// Checks the unknowns after a step. Returns the configuration, the lanes whose residuals are rounding, and the unknowns
    /// after one more correction with the present Jacobian, which rates need.
    #[inline(always)]
    fn check_residual(
        &mut self,
        unknowns: &[B; UNKNOWNS],
        [rack, travel]: [B; 2],
    ) -> (Configuration<'d, B>, B::Mask, [B; UNKNOWNS]) {
        let at = self.linkage.configuration(*unknowns, rack);
        let driver = Driver::Travel(travel);
        let missed = self.linkage.closure.residuals_inlined(&at, driver);
        let [a, b, c, d, e, g] = missed;
        let tolerance = travel.constant(self.tolerance);
        let is_settled =
            is_less(Vector3::new(a, b, c), tolerance) & is_less(Vector3::new(d, e, g), tolerance);
        let rest = -self.linear.get_mut().blocks.solve(missed);
        (at, is_settled, moved(*unknowns, &rest))
    }

    /// Accepts lanes that are well conditioned and on their branch.
    #[inline(always)]
    fn guard(
        &self,
        &[_, _, _, x, y, z]: &[B; UNKNOWNS],
        before: &Option<BranchGuard<B>>,
        accepted: &mut Acceptance<B>,
    ) -> BranchGuard<B> {
        let guard = BranchGuard {
            turned: Vector3::new(x, y, z),
            determinants: self.determinants,
        };
        guard.check(&self.method.determinants, accepted);
        if let Some(before) = before {
            guard.check_step(before, accepted);
        }
        guard
    }

    #[inline(always)]
    fn pose(&self, unknowns: &[B; UNKNOWNS], [rack, travel]: [B; 2]) -> LinkagePose<'_, 'd, B> {
        LinkagePose {
            linkage: self.linkage,
            at: self.linkage.configuration(*unknowns, rack),
            travel,
            linear: &self.linear,
            is_linear: Cell::new(false),
        }
    }
}

/// Equations of a single wheel.
pub(super) struct LinkageCorner<'w, 'd, B: SimdReal, V> {
    steps: NewtonSteps<'w, 'd, B>,
    visitor: &'w mut V,
    /// Lanes in which the prediction of this place was within its permitted error.
    is_near: B::Mask,
}

/// Rack displacement and travel at a place.
#[inline(always)]
fn at_place<B: Real>(place: &RouteStep, like: B) -> [B; 2] {
    [like.constant(place.rack), like.constant(place.value)]
}

impl<B: SimdReal, V: Visit<B>> PlaceEquations<B, UNKNOWNS> for LinkageCorner<'_, '_, B, V> {
    const MOST_ROUNDS: usize = MOST_ROUNDS;
    type Guard = BranchGuard<B>;

    #[inline(always)]
    fn predict(&mut self, place: &RouteStep, history: &[B]) -> [B; UNKNOWNS] {
        let ByLinkage {
            by_travel, by_rack, ..
        } = self.steps.method;
        let mut along = [0.0; UNKNOWNS];
        for k in 0..UNKNOWNS {
            along[k] = by_travel[k] * place.along_slope + by_rack[k] * place.along_rack;
        }
        predicted(place, history, along)
    }

    #[inline(always)]
    fn correct(
        &mut self,
        place: &RouteStep,
        unknowns: &mut [B; UNKNOWNS],
        settled: B::Mask,
        round: usize,
    ) -> B::Mask {
        let motion = at_place(place, unknowns[0]);
        let (_, step) = self.steps.linearise(unknowns, motion, settled);
        if round == 1 {
            self.is_near = self.steps.is_near(&step);
        }
        let next = moved(*unknowns, &step);
        let (_, is_settled, rest) = self.steps.check_residual(&next, motion);
        *unknowns = kept(settled, *unknowns, kept(is_settled, rest, next));
        is_settled
    }

    #[inline(always)]
    fn check(
        &mut self,
        _: &RouteStep,
        unknowns: &[B; UNKNOWNS],
        before: &Option<BranchGuard<B>>,
        accepted: &mut Acceptance<B>,
    ) -> BranchGuard<B> {
        accepted.require(self.is_near, Rejection::ChangedTooMuch);
        self.steps.guard(unknowns, before, accepted)
    }

    #[inline(always)]
    fn visit(
        &mut self,
        place: &RouteStep,
        station: usize,
        unknowns: &[B; UNKNOWNS],
        accepted: Acceptance<B>,
    ) {
        let pose = self.steps.pose(unknowns, at_place(place, unknowns[0]));
        self.visitor.pose(station, &pose, accepted);
    }
}

/// Equations of one wheel of a pair.
pub(super) struct LinkageWheel<'w, 'd, B> {
    steps: NewtonSteps<'w, 'd, B>,
    on_knuckle: WheelOnKnuckle<B>,
    /// Results of the last linearisation: the remaining step to the required travel, and the derivative of the pose by
    /// travel.
    rest: Twist<B>,
    by_travel: Twist<B>,
}

impl<B: SimdReal> LinkageWheel<'_, '_, B> {
    /// Wheel centre relative to the origin of the knuckle, and the spin axis.
    #[inline(always)]
    fn carried(&self, rotation: &Matrix3<B>) -> (Vector3<B>, Vector3<B>) {
        let WheelOnKnuckle { centre, axis } = &self.on_knuckle;
        let (InKnuckle::Designed(centre), InKnuckle::Designed(axis)) = (&centre.0.0, &axis.0)
        else {
            unreachable!("a wheel of a linkage")
        };
        (rotation.apply(*centre), rotation.apply(*axis))
    }
}

impl<B: SimdReal> Wheel<B, UNKNOWNS> for LinkageWheel<'_, '_, B> {
    type Guard = BranchGuard<B>;

    #[inline(always)]
    fn slopes(&self) -> [[f64; UNKNOWNS]; 2] {
        [self.steps.method.by_travel, self.steps.method.by_rack]
    }

    #[inline(always)]
    fn linear(
        &mut self,
        unknowns: &[B; UNKNOWNS],
        rack: B,
        travel: B,
        settled: B::Mask,
    ) -> Motion<B> {
        let (at, rest) = self.steps.linearise(unknowns, [rack, travel], settled);
        let mut driven = [travel.zero(); 6];
        driven[5] = travel.one();
        let by_travel = self.steps.linear.get_mut().blocks.solve(driven);
        let (lever, axis) = self.carried(&at.pose.rotation);
        (self.rest, self.by_travel) = (rest, by_travel);
        Motion {
            centre: at.pose.origin + lever,
            axis,
            rest: [rest.shift + rest.turn.cross(lever), rest.turn],
            rate: [
                by_travel.shift + by_travel.turn.cross(lever),
                by_travel.turn,
            ],
            is_near: self.steps.is_near(&rest),
        }
    }

    #[inline(always)]
    fn moved(&self, unknowns: &[B; UNKNOWNS], further: B) -> [B; UNKNOWNS] {
        let twist = Twist {
            shift: self.rest.shift.plus_scaled(self.by_travel.shift, further),
            turn: self.rest.turn.plus_scaled(self.by_travel.turn, further),
        };
        moved(*unknowns, &twist)
    }

    #[inline(always)]
    fn corrected(
        &mut self,
        unknowns: &[B; UNKNOWNS],
        rack: B,
        travel: B,
    ) -> Corrected<B, UNKNOWNS> {
        let (at, is_settled, unknowns) = self.steps.check_residual(unknowns, [rack, travel]);
        let (lever, axis) = self.carried(&at.pose.rotation);
        Corrected {
            is_settled,
            unknowns,
            centre: at.pose.origin + lever,
            axis,
        }
    }

    #[inline(always)]
    fn check(
        &self,
        unknowns: &[B; UNKNOWNS],
        before: &Option<BranchGuard<B>>,
        _: Option<B>,
        accepted: &mut Acceptance<B>,
    ) -> BranchGuard<B> {
        self.steps.guard(unknowns, before, accepted)
    }

    #[inline(always)]
    fn pose<'p>(&'p self, unknowns: &[B; UNKNOWNS], rack: B, travel: B) -> impl LanePose<B> + 'p {
        self.steps.pose(unknowns, [rack, travel])
    }
}

impl Order {
    /// Order from complete pivoting, with moments divided by the size. `None` if the matrix is singular in double precision.
    fn of(wrenches: &[Wrench<f64>; 6], size: f64) -> Option<Order> {
        let mut a = wrenches.map(|row| {
            let mut row = row.to_row();
            row[3..].iter_mut().for_each(|moment| *moment /= size);
            row
        });
        let mut order = Order {
            rows: from_fn(|i| i),
            columns: from_fn(|i| i),
            places: from_fn(|i| i),
        };
        for k in 0..6 {
            let entries = (k..6).flat_map(|i| (k..6).map(move |j| (i, j)));
            let (i, j) = entries.max_by(|p, q| a[p.0][p.1].abs().total_cmp(&a[q.0][q.1].abs()))?;
            a.swap(k, i);
            order.rows.swap(k, i);
            a.iter_mut().for_each(|row| row.swap(k, j));
            order.columns.swap(k, j);
            // With this form of the test, NaN is refused.
            (a[k][k].abs() > LEAST_PIVOT).then_some(())?;
            let pivot_row = a[k];
            for row in &mut a[k + 1..] {
                let factor = row[k] / pivot_row[k];
                for (entry, above) in row.iter_mut().zip(pivot_row).skip(k) {
                    *entry -= factor * above;
                }
            }
        }
        for (place, row) in order.rows.into_iter().enumerate() {
            order.places[row] = place;
        }
        Some(order)
    }
}

/// Numbers whose change along the path is guarded.
#[derive(Clone, Copy)]
pub(super) struct BranchGuard<B> {
    /// Rotation of the knuckle, as tan(angle/2) times the axis.
    turned: Vector3<B>,
    determinants: [B; 2],
}

impl<B: SimdReal> BranchGuard<B> {
    /// Accepts lanes in which the Jacobian is about as well conditioned as in the base design. Rejects NaN.
    #[inline(always)]
    fn check(&self, base: &[f64; 2], accepted: &mut Acceptance<B>) {
        let [a, s] = self.determinants;
        let is_conditioned = a.constant(LEAST * base[0].abs()).less(a.abs())
            & s.constant(LEAST * base[1].abs()).less(s.abs());
        accepted.require(is_conditioned, Rejection::IllConditioned);
    }

    /// Accepts lanes in which no determinant could have vanished since the previous place and the knuckle has not rotated
    /// far. A determinant could have vanished if it changed too much.
    #[inline(always)]
    fn check_step(&self, before: &Self, accepted: &mut Acceptance<B>) {
        let [a, s] = self.determinants;
        let is_steady =
            within_half(a, before.determinants[0]) & within_half(s, before.determinants[1]);
        accepted.require(is_steady, Rejection::ChangedTooMuch);
        let is_short = is_less(self.turned - before.turned, a.constant(LONGEST));
        accepted.require(is_short, Rejection::TurnedFar);
    }
}

/// Lanes in which the absolute value of every component is below a bound.
#[inline(always)]
fn is_less<B: SimdReal>(vector: Vector3<B>, bound: B) -> B::Mask {
    vector.x.abs().less(bound) & vector.y.abs().less(bound) & vector.z.abs().less(bound)
}

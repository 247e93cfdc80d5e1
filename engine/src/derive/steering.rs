//! The instantaneous steering axis: the screw axis of the knuckle when the rack moves and the drive does not.
//!
//! Let F(x, r) = 0 be the closure equations for the pose x at rack displacement r, with the Jacobian J with respect to x.
//! Let t = x_r be the twist of the knuckle per unit of rack displacement: velocity v of its origin o and angular velocity
//! w. Then
//!
//! ```text
//! J t = -F_r,   axis: point o + (w x v)/w.w, direction w
//! ```
//!
//! *Gradients.* An output y(t, x, p) has, with J^T l = y_t,
//!
//! ```text
//! dy = y_x dx + y_p dp - l . d(J t + F_r),   t constant in d()
//! ```
//!
//! J t + F_r is the derivative of F along the motion x + e t, r + e. So the last term is the coefficient of e in the
//! differential of l . F, computed with series in e. This gives a wrench with force f + e f' and moment m + e m'. A
//! rotation d(rotation) of the pose rotates the moved pose by d(rotation) + e w x d(rotation). The coefficient of e is
//! therefore f' . d(origin) + (m' + m x w) . d(rotation). The code adds it to y_x and then uses the adjoint of
//! `sensitivity.rs`. With series in the drive, all results are series.

use crate::linear::lu::{Lu6, Vector6};
use crate::mechanism::RowSet;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Closure, Driver};
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::{Mechanism, PointId};
use crate::number::{Each, Jet, Real, Vector3, outlined};

/// A series in the drive with its first derivative along the steering motion.
type Along<const N: usize> = Jet<Jet<f64, N>, 2>;

/// A design and its closure equations as Taylor series along the steering motion.
#[derive(Clone, Debug)]
pub(crate) struct Steered<const N: usize> {
    design: Vec<Vector3<Along<N>>>,
    closure: Closure<Along<N>>,
}

impl<const N: usize> Steered<N> {
    pub(crate) fn new(mechanism: &Mechanism, design: &[Vector3<Jet<f64, N>>]) -> Self {
        let design: Vec<_> = design.iter().map(|p| p.map(Jet::constant)).collect();
        let closure = Closure::new(mechanism, &design);
        Steered { design, closure }
    }

    /// Replaces the design with another design of the same mechanism, without allocation.
    pub(crate) fn prepare(&mut self, mechanism: &Mechanism, design: &[Vector3<Jet<f64, N>>]) {
        for (design_series, point) in self.design.iter_mut().zip(design) {
            *design_series = point.map(Jet::constant);
        }
        self.closure.prepare(mechanism, &self.design);
    }

    /// Subtracts the last term of this module's formula for dy, l . d(J t + F_r). The function subtracts it from a wrench
    /// on the knuckle and from a gradient with respect to the hardpoints.
    #[inline(never)]
    pub(crate) fn subtract(
        &self,
        at: &Configuration<'_, Jet<f64, N>>,
        twist: &Twist<Jet<f64, N>>,
        driver: Driver<Jet<f64, N>>,
        multipliers: &Vector6<Jet<f64, N>>,
        wrench: &mut Wrench<Jet<f64, N>>,
        gradient: &mut [Vector3<Jet<f64, N>>],
    ) {
        let one = at.rack.one();
        let along = |v: Vector3<Jet<f64, N>>| v.map(|c| Jet([c.zero(), c]));
        let moved = Configuration {
            mechanism: at.mechanism,
            design: &self.design,
            pose: at
                .pose
                .map(Jet::constant)
                .moved(along(twist.shift), along(twist.turn.scaled(0.5))),
            rack: Jet([at.rack, one]),
            steering: None,
        };
        let mut slope = Slope {
            wrench: Wrench::zero(moved.rack),
            gradient,
        };
        self.closure.differential(
            RowSet::ALL,
            &moved,
            driver.map(Jet::constant),
            &multipliers.each(|l| Jet::constant(-l)),
            &mut slope,
        );
        let Wrench { force, moment, .. } = slope.wrench;
        let (value, rate) = (moment.map(|c| c[0]), moment.map(|c| c[1]));
        wrench.wrench(force.map(|c| c[1]), rate + value.cross(twist.turn));
    }
}

/// Sums two quantities: a wrench along the steering motion, and the derivative along the steering motion of a gradient with
/// respect to the hardpoints.
struct Slope<'a, const N: usize> {
    wrench: Wrench<Along<N>>,
    gradient: &'a mut [Vector3<Jet<f64, N>>],
}

impl<const N: usize> Sink<Along<N>> for Slope<'_, N> {
    #[inline]
    fn wrench(&mut self, force: Vector3<Along<N>>, moment: Vector3<Along<N>>) {
        self.wrench.wrench(force, moment);
    }
    #[inline]
    fn hardpoint(&mut self, id: PointId, gradient: Vector3<Along<N>>) {
        self.gradient[id.0] = self.gradient[id.0] + gradient.map(|c| c[1]);
    }
}

/// Twist of the knuckle per unit of rack displacement, with the drive fixed. `lu` has the factors of the constant part of
/// the closure equations' Jacobian.
pub(crate) fn twist_by_rack<const N: usize>(
    at: &Configuration<'_, Jet<f64, N>>,
    closure: &Closure<Jet<f64, N>>,
    driver: Driver<Jet<f64, N>>,
    lu: &Lu6<f64>,
) -> Twist<Jet<f64, N>> {
    let wrenches = closure.wrenches(at, driver);
    let by_rack = wrenches.each(|wrench| -wrench.rack);
    Twist::from_array(lu.solve_series(&wrenches.each(Wrench::to_row), &by_rack))
}

/// Point of a twist's screw axis, and the upward vector along this axis. `origin` is the point to which the twist's
/// velocity refers.
#[inline(always)]
pub(crate) fn screw_axis<T: Real>(
    origin: Vector3<T>,
    twist: &Twist<T>,
) -> (Vector3<T>, Vector3<T>) {
    let Twist { shift, turn } = *twist;
    let point = origin + turn.cross(shift) * (turn.x.one() / turn.norm_squared());
    let upward = turn * turn.z.sign();
    (point, upward)
}

/// Derivative of `by_point . point + by_direction . direction` of the screw axis with respect to the twist. With the
/// point p relative to the origin, the angular velocity w (`turn`) and the velocity v (`shift`), p w.w = w x v.
#[inline(always)]
pub(crate) fn screw_axis_gradient<T: Real>(
    twist: &Twist<T>,
    by_point: Vector3<T>,
    by_direction: Vector3<T>,
) -> Twist<T> {
    outlined!(
        [T: Real] by_point.x;
        twist: Twist<T> = *twist, by_point: Vector3<T> = by_point, by_direction: Vector3<T> = by_direction => Twist<T> {
            let Twist { shift, turn } = twist;
            let inverse = turn.x.one() / turn.norm_squared();
            let along = by_point.dot(turn.cross(shift)) * inverse;
            let by_turn = shift.cross(by_point) - turn * (along + along);
            Twist {
                shift: by_point.cross(turn) * inverse,
                turn: by_turn * inverse + by_direction * turn.z.sign(),
            }
        }
    )
}

//! Derivatives with respect to the hardpoints, with the adjoint of the closure equations.
//!
//! With the closure equations F(x, p) = 0 for the pose x of the design p, an output y(x, p) has
//!
//! ```text
//! dy/dp = y_p - mu . F_p,   J^T mu = y_x
//! ```
//!
//! J is the Jacobian of F with respect to x. Indices x and p denote derivatives. y_x is a wrench on the knuckle, and mu are
//! the forces with which the six constraints balance this wrench. So one output costs one back-substitution for any number
//! of hardpoints. The design changes with the hardpoint: lengths and the shape of the knuckle are computed again, while the
//! drive value stays constant.
//!
//! With power series in the drive, the same code gives d/ds(dy/dp). This equals d/dp(dy/ds), the sensitivity of rates and
//! curvatures.

use super::steering::{Steered, screw_axis, screw_axis_gradient};
use crate::linear::lu::{Lu6, Matrix6};
use crate::mechanism::RowSet;
use crate::mechanism::WorkCounter;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Closure, Driver};
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::RockerId;
use crate::model::{Mechanism, PointId, SpinAxis, SteeringAxis};
use crate::number::Jet;
use crate::number::Real;
use crate::number::{Each, Vector3};

/// Collects the derivatives of an output with respect to the hardpoints.
pub trait Gradient<T> {
    /// Adds a derivative with respect to a hardpoint.
    fn add(&mut self, id: PointId, by: Vector3<T>);
}

impl<T: Real> Gradient<T> for [Vector3<T>] {
    #[inline(always)]
    fn add(&mut self, id: PointId, by: Vector3<T>) {
        self[id.0] = self[id.0] + by;
    }
}

/// Sums the gradient of an output with respect to the hardpoints, and the wrench of the same output (its derivative with
/// respect to the pose).
struct Adjoint<'a, T, G: ?Sized> {
    wrench: Wrench<T>,
    gradient: &'a mut G,
}

impl<T: Real, G: Gradient<T> + ?Sized> Sink<T> for Adjoint<'_, T, G> {
    #[inline(always)]
    fn wrench(&mut self, force: Vector3<T>, moment: Vector3<T>) {
        self.wrench.wrench(force, moment);
    }
    #[inline(always)]
    fn hardpoint(&mut self, id: PointId, gradient: Vector3<T>) {
        self.gradient.add(id, gradient);
    }
}

/// Sums a gradient with respect to the hardpoints, and ignores wrenches.
pub(crate) struct HardpointGradient<'a, G: ?Sized>(pub &'a mut G);

impl<T: Real, G: Gradient<T> + ?Sized> Sink<T> for HardpointGradient<'_, G> {
    #[inline(always)]
    fn wrench(&mut self, _: Vector3<T>, _: Vector3<T>) {}
    #[inline(always)]
    fn hardpoint(&mut self, id: PointId, gradient: Vector3<T>) {
        self.0.add(id, gradient);
    }
}

/// A configuration prepared for adjoints, with the Jacobian of the closure equations along the motion and the factors of
/// the Jacobian's constant part.
pub struct Linearised<'a, const N: usize> {
    /// Configuration as a power series along the motion.
    pub at: Configuration<'a, Jet<f64, N>>,
    closure: &'a Closure<Jet<f64, N>>,
    rows: RowSet,
    steered: Option<&'a Steered<N>>,
    driver: Driver<Jet<f64, N>>,
    jacobian: Matrix6<Jet<f64, N>>,
    lu: Lu6<f64>,
    work: &'a WorkCounter,
}

impl<'a, const N: usize> Linearised<'a, N> {
    pub(crate) fn new(
        at: Configuration<'a, Jet<f64, N>>,
        closure: &'a Closure<Jet<f64, N>>,
        rows: RowSet,
        steered: Option<&'a Steered<N>>,
        driver: Driver<Jet<f64, N>>,
        lu: Lu6<f64>,
        work: &'a WorkCounter,
    ) -> Self {
        Linearised {
            jacobian: closure.jacobian(&at, driver),
            at,
            closure,
            rows,
            steered,
            driver,
            lu,
            work,
        }
    }

    /// Closure equations as power series along the motion.
    pub(crate) fn closure(&self) -> &'a Closure<Jet<f64, N>> {
        self.closure
    }

    /// Counter of the solver's steps.
    pub(crate) fn work(&self) -> &'a WorkCounter {
        self.work
    }

    /// Factors of the constant part of the closure equations' Jacobian.
    pub(crate) fn factors(&self) -> &Lu6<f64> {
        &self.lu
    }

    /// Adds the gradient of an output with respect to the hardpoints to `gradient`. It is complete only for the points of
    /// [`DesignSeries::with_sensitivities_to`](super::DesignSeries::with_sensitivities_to). The function calls `seed` once.
    /// `seed` gives the derivatives of the output with respect to the configuration, through the methods of
    /// [`Seeds`].
    #[inline]
    pub fn gradient(
        &self,
        gradient: &mut [Vector3<Jet<f64, N>>],
        seed: impl FnOnce(&mut Seeds<'_, '_, Jet<f64, N>>),
    ) {
        let mut seeds = Seeds::new(&self.at, gradient);
        seed(&mut seeds);
        let by_twist = seeds.by_twist;
        let Adjoint {
            mut wrench,
            gradient,
        } = seeds.adjoint;
        if let (Some(by_twist), Some(twist), Some(steered)) =
            (by_twist, &self.at.steering, self.steered)
        {
            self.work.note(|w| w.right_hand_sides += N as u64);
            let multipliers = self
                .lu
                .solve_transposed_series(&self.jacobian, &by_twist.into_array());
            steered.subtract(
                &self.at,
                twist,
                self.driver,
                &multipliers,
                &mut wrench,
                gradient,
            );
        }
        let wrench = wrench.to_row();
        self.work.note(|w| {
            w.right_hand_sides += N as u64;
            w.gradient_rows += self.rows.count(self.driver);
        });
        let multipliers = self.lu.solve_transposed_series(&self.jacobian, &wrench);
        self.closure.differential(
            self.rows,
            &self.at,
            self.driver,
            &multipliers.each(|m| -m),
            &mut HardpointGradient(gradient),
        );
    }
}

/// Dependence of an output on the configuration. Each call of a method adds the derivative with respect to one input.
pub struct Seeds<'s, 'a, T, G: ?Sized = [Vector3<T>]> {
    at: &'s Configuration<'a, T>,
    adjoint: Adjoint<'s, T, G>,
    /// Derivative of the output with respect to the twist of the steering motion (the knuckle's velocity per unit of rack
    /// displacement). `None` if the output does not depend on it.
    by_twist: Option<Twist<T>>,
}

impl<'s, 'a, T: Real, G: Gradient<T> + ?Sized> Seeds<'s, 'a, T, G> {
    /// Starts an output of a configuration. `gradient` collects its derivatives with respect to hardpoints at fixed pose.
    #[inline(always)]
    pub fn new(at: &'s Configuration<'a, T>, gradient: &'s mut G) -> Self {
        Seeds::continuing(at, Wrench::zero(at.rack), gradient)
    }

    /// Starts another output and adds its derivatives to earlier derivatives. `wrench` is the earlier derivative with
    /// respect to the pose.
    #[inline(always)]
    pub fn continuing(
        at: &'s Configuration<'a, T>,
        wrench: Wrench<T>,
        gradient: &'s mut G,
    ) -> Self {
        Seeds {
            at,
            adjoint: Adjoint { wrench, gradient },
            by_twist: None,
        }
    }

    /// Derivative of the output with respect to the pose.
    #[inline(always)]
    pub fn wrench(&self) -> Wrench<T> {
        self.adjoint.wrench
    }

    /// Adds the derivatives with respect to the point and the direction of the steering axis from
    /// [`Configuration::steering_axis`].
    #[inline(always)]
    pub fn steering_axis(&mut self, by_point: Vector3<T>, by_direction: Vector3<T>) {
        match (self.at.mechanism.steering_axis, &self.at.steering) {
            (Some(SteeringAxis::Through { lower, upper }), _) => {
                self.point(upper, by_direction);
                self.point(lower, by_point - by_direction);
            }
            (Some(SteeringAxis::Instantaneous), Some(twist)) => {
                let more = screw_axis_gradient(twist, by_point, by_direction);
                self.by_twist = Some(match self.by_twist {
                    None => more,
                    Some(seed) => Twist {
                        shift: seed.shift + more.shift,
                        turn: seed.turn + more.turn,
                    },
                });
                self.adjoint.wrench(by_point, by_point.zero());
            }
            _ => {}
        }
    }

    /// Adds the derivative with respect to the present position of a point.
    #[inline(always)]
    pub fn point(&mut self, id: PointId, gradient: Vector3<T>) {
        self.at.push_point(id, gradient, &mut self.adjoint);
    }

    /// Adds the derivative with respect to the angle of a rocker.
    #[inline(always)]
    pub fn rocker_angle(&mut self, id: RockerId, gradient: T) {
        self.at.push_rocker_angle(id, gradient, &mut self.adjoint);
    }

    /// Adds the derivative with respect to a hardpoint at fixed pose.
    #[inline(always)]
    pub fn hardpoint(&mut self, id: PointId, gradient: Vector3<T>) {
        self.adjoint.hardpoint(id, gradient);
    }

    /// Adds the derivative with respect to the rotation of the mechanism's knuckle. For a steered axle, this is the
    /// rotation of the axle.
    #[inline(always)]
    pub fn turn(&mut self, moment: Vector3<T>) {
        self.adjoint.wrench(moment.zero(), moment);
    }

    /// Adds the derivative with respect to the rotation of the body that carries the wheel.
    #[inline(always)]
    pub fn carrier_turn(&mut self, moment: Vector3<T>) {
        self.at.push_carrier_turn(moment, &mut self.adjoint);
    }

    /// Adds the derivative with respect to the unit spin axis a = R a0. The design axis a0 is along (wheel centre - inner
    /// point).
    #[inline(always)]
    pub fn spin_axis(&mut self, gradient: Vector3<T>) {
        let designed = DesignedSpinAxis::of(self.at.mechanism, self.at.design);
        if self.at.steered_knuckle().is_some() {
            let rotation = self.at.carrier_rotation();
            let now = rotation.apply(designed.direction);
            self.carrier_turn(now.cross(gradient));
            return self.by_designed_spin_axis(&designed, rotation.apply_transposed(gradient));
        }
        let now = self.at.pose.rotation.apply(designed.direction);
        self.moved_spin_axis(&designed, now, gradient);
    }

    /// Adds the derivative with respect to the unit spin axis. `designed` is the axis in the design position, `now` the
    /// axis in the pose.
    #[inline(always)]
    pub fn moved_spin_axis(
        &mut self,
        designed: &DesignedSpinAxis<T>,
        now: Vector3<T>,
        gradient: Vector3<T>,
    ) {
        self.turn(now.cross(gradient));
        let in_knuckle = self.at.pose.rotation.apply_transposed(gradient);
        self.by_designed_spin_axis(designed, in_knuckle);
    }

    /// Adds the derivative with respect to the unit spin axis in the design position.
    #[inline(always)]
    pub fn designed_spin_axis(&mut self, gradient: Vector3<T>) {
        let designed = DesignedSpinAxis::of(self.at.mechanism, self.at.design);
        self.by_designed_spin_axis(&designed, gradient);
    }

    #[inline(always)]
    fn by_designed_spin_axis(&mut self, designed: &DesignedSpinAxis<T>, gradient: Vector3<T>) {
        if let SpinAxis::From(inner) = self.at.mechanism.spin_axis {
            let axis = designed.direction;
            let by_base = (gradient - axis * axis.dot(gradient)) * designed.inverse_length;
            self.hardpoint(self.at.mechanism.wheel_centre, by_base);
            self.hardpoint(inner, -by_base);
        }
    }
}

/// Spin axis in the design position.
#[derive(Clone, Copy, Debug)]
pub struct DesignedSpinAxis<T> {
    /// Unit vector, positive outboard.
    pub direction: Vector3<T>,
    /// Inverse of the distance between the wheel centre and the point that gives the direction. 0 if static angles give the
    /// direction.
    pub inverse_length: T,
}

impl<T: Real> DesignedSpinAxis<T> {
    /// Spin axis of a design.
    #[inline(always)]
    pub fn of(mechanism: &Mechanism, design: &[Vector3<T>]) -> Self {
        let centre = design[mechanism.wheel_centre.0];
        match mechanism.spin_axis {
            SpinAxis::From(inner) => {
                let base = centre - design[inner.0];
                let inverse_length = base.x.one() / base.norm();
                DesignedSpinAxis {
                    direction: base * inverse_length,
                    inverse_length,
                }
            }
            SpinAxis::Along(direction) => DesignedSpinAxis {
                direction: centre.constant(direction),
                inverse_length: centre.x.zero(),
            },
        }
    }
}

impl<T: Real> Configuration<'_, T> {
    /// Returns a point of the steering axis, and an upward vector of any length along it. `None` if the wheel is not
    /// steered, or if no requested quantity needs the axis.
    #[inline(always)]
    pub fn steering_axis(&self) -> Option<(Vector3<T>, Vector3<T>)> {
        match self.mechanism.steering_axis? {
            SteeringAxis::Through { lower, upper } => {
                let point = self.point(lower);
                Some((point, self.point(upper) - point))
            }
            SteeringAxis::Instantaneous => {
                let twist = self.steering.as_ref()?;
                Some(screw_axis(self.pose.origin, twist))
            }
        }
    }

    /// Unit vector along the spin axis in the design position, positive outboard.
    #[inline(always)]
    pub fn designed_spin_axis(&self) -> Vector3<T> {
        DesignedSpinAxis::of(self.mechanism, self.design).direction
    }

    /// Unit vector along the spin axis, positive outboard.
    #[inline(always)]
    pub fn spin_axis(&self) -> Vector3<T> {
        self.carrier_rotation().apply(self.designed_spin_axis())
    }
}

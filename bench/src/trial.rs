//! Equations without checks for any number type, tolerance and start, to measure their cost.
//!
//! The program itself uses [`Solver`](hardpoint_engine::solve::Solver), which also checks its steps. This module runs the
//! formulas of the closed form and of the closure equations without checks. So a benchmark can change one thing at a time.

use hardpoint_engine::bench_hooks::{ClosedForm, Closure, Driver, Lu6, Roles};
use hardpoint_engine::mechanism::{Configuration, Pose};
use hardpoint_engine::model::{Mechanism, PointId};
use hardpoint_engine::number::Dual;
use hardpoint_engine::number::Jet;
use hardpoint_engine::number::Scalar;
use hardpoint_engine::number::{Matrix3, Vector3};

/// Equations of the pose at a wheel travel. Newton's method solves them.
pub(crate) trait Equations<T> {
    /// Type of the unknown.
    type Unknown: Copy;
    /// Value of the unknown in the design position.
    fn design(&self) -> Self::Unknown;
    /// Makes one Newton step. Returns the next unknown, and the error of the equations (a length) at the unknown `at`.
    fn step(&self, at: &Self::Unknown, travel: T) -> (Self::Unknown, f64);
    /// Weighted sum of earlier solutions.
    fn predicted(&self, earlier: &[Self::Unknown], weights: &[f64]) -> Self::Unknown;
    /// Pose that belongs to an unknown.
    fn pose(&self, at: &Self::Unknown) -> Pose<T>;
}

/// Largest number of Newton iterations per solution.
const MOST_ITERATIONS: usize = 20;

/// Solves until the error of the equations is at most `tolerance` (a length), or no longer decreases. Returns the solution and
/// the number of iterations.
#[inline]
pub(crate) fn solve<T: Scalar, E: Equations<T>>(
    equations: &E,
    start: E::Unknown,
    travel: T,
    tolerance: f64,
) -> (E::Unknown, usize) {
    let (mut at, mut last) = (start, f64::INFINITY);
    for iteration in 1..=MOST_ITERATIONS {
        let (next, missed) = equations.step(&at, travel);
        // This form of the condition ends the iteration if the error is NaN.
        let shrinks = missed < last;
        if missed <= tolerance || !shrinks {
            return (at, iteration);
        }
        (at, last) = (next, missed);
    }
    (at, MOST_ITERATIONS)
}

/// The closed form: one equation for the tangent of half the arm's angle.
pub(crate) struct OneEquation<T> {
    form: ClosedForm<T>,
    series: ClosedForm<Jet<T, 2>>,
    rack: T,
}

impl<T: Scalar> OneEquation<T> {
    /// Makes the equation of a design with the rack at `rack`. `None` if the mechanism has no closed form.
    pub(crate) fn new(mechanism: &Mechanism, design: &[Vector3<T>], rack: T) -> Option<Self> {
        let form = ClosedForm::new(&Roles::of(mechanism)?, design);
        Some(OneEquation {
            form,
            series: form.map(Jet::constant),
            rack,
        })
    }
}

impl<T: Scalar> Equations<T> for OneEquation<T> {
    type Unknown = T;

    fn design(&self) -> T {
        self.rack.zero()
    }

    #[inline]
    fn step(&self, tangent: &T, travel: T) -> (T, f64) {
        let rack = Jet::constant(self.rack);
        let state = self.series.at_half_tangent(Jet::variable(*tangent), rack);
        let rise = self.series.travel(&state);
        let missed = travel - rise[0];
        (*tangent + missed / rise[1], missed.value().abs())
    }

    #[inline]
    fn predicted(&self, earlier: &[T], weights: &[f64]) -> T {
        let zero = self.rack.zero();
        let terms = earlier.iter().zip(weights);
        terms.fold(zero, |sum, (t, w)| sum + t.scaled(*w))
    }

    #[inline]
    fn pose(&self, tangent: &T) -> Pose<T> {
        self.form
            .pose(&self.form.at_half_tangent(*tangent, self.rack))
    }
}

/// The six closure equations for the pose itself.
pub(crate) struct SixEquations<'m, T> {
    mechanism: &'m Mechanism,
    design: Vec<Vector3<T>>,
    closure: Closure<T>,
    rack: T,
}

impl<'m, T: Scalar> SixEquations<'m, T> {
    pub(crate) fn new(mechanism: &'m Mechanism, design: &[Vector3<T>], rack: T) -> Self {
        SixEquations {
            mechanism,
            design: design.to_vec(),
            closure: Closure::new(mechanism, design),
            rack,
        }
    }

    /// Returns the mechanism in a pose: the design positions of all points, and the pose of the wheel carrier.
    #[inline]
    pub(crate) fn configuration(&self, pose: Pose<T>) -> Configuration<'_, T> {
        Configuration::new(self.mechanism, &self.design, pose, self.rack)
    }
}

impl<T: Scalar> Equations<T> for SixEquations<'_, T> {
    type Unknown = Pose<T>;

    fn design(&self) -> Pose<T> {
        Pose {
            origin: self.design[self.mechanism.origin.0],
            rotation: Matrix3::identity(self.rack),
        }
    }

    #[inline]
    fn step(&self, pose: &Pose<T>, travel: T) -> (Pose<T>, f64) {
        let at = self.configuration(*pose);
        let driver = Driver::Travel(travel);
        let residuals = self.closure.residuals(&at, driver);
        let missed = residuals
            .iter()
            .fold(0.0, |m: f64, r| m.max(r.value().abs()));
        let Some(lu) = Lu6::new(self.closure.jacobian(&at, driver), 1.0) else {
            return (*pose, f64::NAN);
        };
        let [x, y, z, a, b, c] = lu.solve(residuals).map(|v| -v);
        let rodrigues = Vector3::new(a, b, c).map(|v| v.scaled(0.5));
        let mut next = pose.moved(Vector3::new(x, y, z), rodrigues);
        next.rotation = next.rotation.orthonormalised();
        (next, missed)
    }

    fn predicted(&self, earlier: &[Pose<T>], weights: &[f64]) -> Pose<T> {
        let zero = self.rack.zero();
        let mut sum = earlier[0].map(|_| zero);
        for (pose, weight) in earlier.iter().zip(weights) {
            sum.origin = sum.origin + pose.origin.map(|c| c.scaled(*weight));
            for (column, term) in sum.rotation.columns.iter_mut().zip(pose.rotation.columns) {
                *column = *column + term.map(|c| c.scaled(*weight));
            }
        }
        for _ in 0..3 {
            sum.rotation = sum.rotation.orthonormalised();
        }
        sum
    }

    #[inline]
    fn pose(&self, pose: &Pose<T>) -> Pose<T> {
        *pose
    }
}

/// Sensitivities by forward differentiation. The coordinates of one hardpoint are the variables, one hardpoint after another.
pub(crate) struct Forward<'m, T> {
    plain: SixEquations<'m, T>,
    by_point: Vec<(PointId, SixEquations<'m, Dual<T, 3>>)>,
}

impl<'m, T: Scalar> Forward<'m, T> {
    pub(crate) fn new(
        mechanism: &'m Mechanism,
        design: &[Vector3<T>],
        rack: T,
        points: &[PointId],
    ) -> Self {
        let seeded = |id: &PointId| {
            let mut seeded: Vec<_> = design.iter().map(|p| p.map(Dual::constant)).collect();
            seeded[id.0] = Dual::inputs(design[id.0]);
            let rack = Dual::constant(rack);
            (*id, SixEquations::new(mechanism, &seeded, rack))
        };
        Forward {
            plain: SixEquations::new(mechanism, design, rack),
            by_point: points.iter().map(seeded).collect(),
        }
    }

    /// Calls `receive` for each hardpoint. The configuration at a solved pose is given as a function of the hardpoint's coordinates
    /// p. Let F be the closure equations, F_p their derivatives with respect to p, and J their Jacobian. The derivative x_p of the
    /// pose follows from J x_p = -F_p. One factorisation of J serves all hardpoints.
    #[inline]
    pub(crate) fn each(
        &self,
        pose: &Pose<T>,
        travel: T,
        mut receive: impl FnMut(PointId, &Configuration<'_, Dual<T, 3>>),
    ) {
        let at = self.plain.configuration(*pose);
        let jacobian = self.plain.closure.jacobian(&at, Driver::Travel(travel));
        let Some(lu) = Lu6::new(jacobian, 1.0) else {
            return;
        };
        let design_series = pose.map(Dual::constant);
        for (id, equations) in &self.by_point {
            let driver = Driver::Travel(Dual::constant(travel));
            let at = equations.configuration(design_series);
            let residuals = equations.closure.residuals(&at, driver);
            let columns = [0, 1, 2].map(|k| lu.solve(residuals.map(|r| -r.partials[k])));
            let zero = travel.zero();
            let twist = |i: usize, scale: f64| Dual {
                value: zero,
                partials: columns.map(|c| c[i].scaled(scale)),
            };
            let shift = Vector3::new(twist(0, 1.0), twist(1, 1.0), twist(2, 1.0));
            let rodrigues = Vector3::new(twist(3, 0.5), twist(4, 0.5), twist(5, 0.5));
            receive(
                *id,
                &equations.configuration(design_series.moved(shift, rodrigues)),
            );
        }
    }
}

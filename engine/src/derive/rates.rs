//! Derivatives of the pose along the motion, of any order.
//!
//! F(x, s) = 0 are the closure equations, x is the pose and s the parameter of the motion. The code solves F(x(s), s) = 0
//! in truncated power series in e, the increment of s. If the coefficients of x below e^k are right, the lowest nonzero
//! coefficient of the residual is F_k, the coefficient of e^k. The correction J0 dx_k = -F_k removes it. J0 is the Jacobian
//! of F with respect to the pose, the same for all orders. So each order costs one residual and one back-substitution. The
//! code needs no formula for velocities or accelerations.

use crate::linear::lu::Lu6;
use crate::mechanism::{Closure, Driver};
use crate::mechanism::{Configuration, Pose};
use crate::model::Mechanism;
use crate::number::Jet;
use crate::number::{Each, Vector3};

/// Pose as a power series in e, from the pose itself and the factors of the closure equations' Jacobian. `driver` and
/// `rack` are series that describe the motion. For derivatives with respect to the drive coordinate, the series `driver` is
/// the drive value plus e.
pub(crate) fn pose_series<const N: usize>(
    mechanism: &Mechanism,
    design: &[Vector3<Jet<f64, N>>],
    closure: &Closure<Jet<f64, N>>,
    lu: &Lu6<f64>,
    pose: &Pose<f64>,
    driver: Driver<Jet<f64, N>>,
    rack: Jet<f64, N>,
) -> Pose<Jet<f64, N>> {
    let mut series = pose.map(Jet::constant);
    for k in 1..N {
        let at = Configuration::new(mechanism, design, series, rack);
        let residuals = closure.residuals(&at, driver);
        let correction = lu.solve(residuals.each(|r| -r[k]));
        let term = |value: f64| {
            let mut coefficients = [0.0; N];
            coefficients[k] = value;
            Jet(coefficients)
        };
        let [x, y, z, a, b, c] = correction;
        series = series.moved(
            Vector3::new(x, y, z).map(term),
            Vector3::new(a, b, c).map(|v| term(0.5 * v)),
        );
    }
    series
}

/// Angular velocity w of the knuckle along the series, with R' R^T = (w x). w is half the sum of R e_i x R' e_i. The highest
/// coefficient of the result is unknown; do not use it.
pub(crate) fn angular_velocity<const N: usize>(pose: &Pose<Jet<f64, N>>) -> Vector3<Jet<f64, N>> {
    let [a, b, c] = pose
        .rotation
        .columns
        .each(|column| column.cross(column.map(Jet::differentiated)));
    (a + b + c) * Jet::constant(0.5)
}

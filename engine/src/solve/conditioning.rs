//! Loss of digits in a pose, computed in double precision.
//!
//! With lengths relative to the mechanism's size, the Jacobian J of the closure equations has entries of about one. Its condition
//! number is k = |J| |J^-1| (maximum norm). Residuals are accurate to a few rounding units e, so that
//!
//! ```text
//! |error of the pose|                ~ k e
//! |relative error of J^-1|           ~ k |dJ| ~ k (k e)
//! ```
//!
//! since J changes with the pose. Rates and sensitivities are products with J^-1, so their relative error is of the
//! order of k^2 e. By the theorem of Eckart and Young, 1/|J^-1| is the distance of J from the nearest singular matrix.
//! Multiplied by the size of the mechanism, this distance is a length. The mechanism has no singularity closer than
//! this length.

use super::path::Solver;
use crate::derive::Linearised;
use crate::derive::{DesignSeries, MotionPoint};
use crate::linear::lu::Lu6;
use crate::mechanism::Configuration;
use crate::mechanism::Failure;
use crate::mechanism::Pose;
use crate::number::{Each, Jet};

/// Conditioning of one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditioning {
    /// Condition number of the closure equations' Jacobian, with lengths relative to the mechanism's size. Infinite at a
    /// singular pose.
    pub number: f64,
    /// Distance to singularity, as a length.
    pub distance: f64,
}

impl Conditioning {
    const SINGULAR: Conditioning = Conditioning {
        number: f64::INFINITY,
        distance: 0.0,
    };

    /// Largest condition number that may be an estimate. Larger numbers are computed from the Jacobian, so a report of lost
    /// digits is never based on an estimate.
    pub const ESTIMATED: f64 = 1e3;

    /// Number of reliable decimal digits of rates and sensitivities, at most 15.
    pub fn digits(&self) -> f64 {
        rate_digits(self.number)
    }

    /// Returns true if rates and sensitivities have fewer than six correct digits.
    pub fn is_poor(&self) -> bool {
        self.digits() < LEAST_DIGITS
    }

    /// Conditioning from the LU factors of the closure equations' Jacobian. The computation takes about as much work as the
    /// factorisation.
    pub(crate) fn of(lu: &Lu6<f64>, size: f64) -> Self {
        // Largest row sum of the Jacobian. Displacements and residuals are relative to the mechanism's size; rotations are
        // in radians.
        let norm = lu.matrix().iter().fold(0.0_f64, |norm, row| {
            norm.max(magnitude(&row[..3]) + magnitude(&row[3..]) / size)
        });
        let inverse = lu.inverse();
        let [shifts, turns] = [&inverse[..3], &inverse[3..]].each(|rows| {
            let sums = rows.iter().map(|row| magnitude(row));
            sums.fold(0.0, f64::max)
        });
        let inverse_norm = shifts.max(turns * size);
        let number = norm * inverse_norm;
        if !number.is_finite() {
            return Conditioning::SINGULAR;
        }
        Conditioning {
            number,
            distance: size / inverse_norm,
        }
    }
}

/// Sum of the absolute values of a row.
pub(super) fn magnitude(row: &[f64]) -> f64 {
    row.iter().map(|c| c.abs()).sum()
}

/// Number of reliable decimal digits of rates and sensitivities for equations with this condition number, at most 15.
pub fn rate_digits(number: f64) -> f64 {
    (-(number * number * f64::EPSILON).log10()).clamp(0.0, 15.0)
}

/// Smallest number of reliable digits. Rates and sensitivities with fewer digits are flagged.
pub const LEAST_DIGITS: f64 = 6.0;

impl Solver<'_> {
    /// Conditioning of a pose found by this solver.
    pub fn conditioning(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> Conditioning {
        let lu = self.factorise(pose, point);
        lu.map_or(Conditioning::SINGULAR, |lu| {
            Conditioning::of(&lu, self.size())
        })
    }

    /// Taylor series of the configuration as in [`Solver::configuration_series`], with the condition number of its
    /// Jacobian. If the Jacobian's factors are needed anyway, the number is computed from these factors. If the closed
    /// form gave the pose far from any singularity ([`Conditioning::ESTIMATED`]), the number is an estimate. The
    /// estimate takes almost no time and is correct within a factor of ten.
    pub fn conditioned_series<'a, const N: usize>(
        &'a self,
        design_series: &'a DesignSeries<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Result<(Configuration<'a, Jet<f64, N>>, Conditioning), Failure> {
        let is_simple = !design_series.is_steered();
        if let Some((series, number)) = is_simple
            .then(|| self.closed_form_series(pose, motion))
            .flatten()
        {
            let configuration = design_series.at(self.mechanism(), series, motion.rack);
            // The condition is written so that NaN leads to a new computation.
            let condition = if number < Conditioning::ESTIMATED {
                Conditioning {
                    number,
                    distance: self.size() / number,
                }
            } else {
                self.conditioning(pose, &motion.value_point())
            };
            return Ok((configuration, condition));
        }
        let (configuration, factors) =
            self.factorised_series(design_series, pose, motion, false)?;
        let condition = match factors {
            Some(lu) => Conditioning::of(&lu, self.size()),
            None => self.conditioning(pose, &motion.value_point()),
        };
        Ok((configuration, condition))
    }
}

impl<const N: usize> Linearised<'_, N> {
    /// Conditioning of a pose. `size` is the size of the mechanism (see [`Solver::size`]).
    pub fn conditioning(&self, size: f64) -> Conditioning {
        Conditioning::of(self.factors(), size)
    }
}

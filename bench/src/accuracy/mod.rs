//! Work and precision: computing time against correct digits.
//!
//! Each method is measured by its time and by its true error. The reference value has twice the precision: the six
//! closure equations, solved in pairs of doubles (see [`DoubleDouble`](crate::DoubleDouble)) with about thirty
//! digits.

mod curve;
mod derivatives;
mod poses;
mod subject;

pub(super) use poses::unchecked_and_checked;
pub use subject::Subject;

use super::{Clock, Timing, Unmeasurable};
use hardpoint_engine::study::WheelStudy;

/// Time and error of one method with one setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Family of the method.
    pub family: Family,
    /// Name of the method.
    pub method: String,
    /// Value of the setting that is varied.
    pub setting: String,
    /// Time per pose.
    pub time: Timing,
    /// Largest true error, in the unit of the method's family ([`Family::unit`]). NaN if the method gave no number.
    pub error: f64,
    /// Evaluations of the equations per pose. `None` for methods without iteration.
    pub evaluations: Option<f64>,
}

/// Families of methods that are compared with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Poses by formulation, arithmetic and tolerance. Error in degrees of camber.
    Pose,
    /// Starting points of Newton's method. Error in degrees of camber.
    Start,
    /// Curves interpolated between few exact poses. Error in degrees of camber.
    Curve,
    /// Derivatives of four characteristics with respect to every hardpoint coordinate. Error relative to the largest
    /// derivative.
    Derivative,
    /// Forward against adjoint sensitivities. Error relative to the largest derivative.
    Sensitivity,
}

impl Family {
    /// Name of the family in tables.
    pub fn name(self) -> &'static str {
        ["pose", "start", "curve", "derivative", "sensitivity"][self as usize]
    }

    /// Unit of the errors.
    pub fn unit(self) -> &'static str {
        match self {
            Family::Pose | Family::Start | Family::Curve => "deg",
            Family::Derivative | Family::Sensitivity => "relative",
        }
    }
}

/// Larger of two errors. If one of them is NaN, the result is NaN, so a failed computation is not hidden. The engine's
/// `number::larger` is private and works in SIMD lanes without a test for NaN. It therefore returns NaN also for two infinities.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// All measurements of one study.
#[derive(Clone, Debug, PartialEq)]
pub struct Accuracy {
    /// Measurement of each method with each setting.
    pub measurements: Vec<Measurement>,
}

impl Accuracy {
    /// Measures all methods on a study.
    pub fn measure(study: &WheelStudy, clock: &Clock) -> Result<Self, Unmeasurable> {
        let subject = Subject::of(study)?;
        let mut measurements = poses::measure(&subject, clock)?;
        measurements.extend(curve::measure(&subject, clock)?);
        measurements.extend(derivatives::measure(&subject, clock)?);
        Ok(Accuracy { measurements })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_not_a_number_is_not_lost() {
        let of = |errors: [f64; 3]| errors.into_iter().fold(0.0, worse);
        assert_eq!(of([1.0, 3.0, 2.0]), 3.0);
        assert!(of([1.0, f64::NAN, 2.0]).is_nan());
        assert!(of([f64::NAN, 1.0, 2.0]).is_nan());
        assert!(of([1.0, 2.0, f64::NAN]).is_nan());
    }
}

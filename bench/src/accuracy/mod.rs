//! Work and precision: the cost of a digit.
//!
//! Every way to a number is measured by its time and by its true error, against the same number in
//! twice the precision: the six closure equations solved in pairs of doubles (see
//! [`DoubleDouble`](crate::DoubleDouble)), about thirty digits.

mod curve;
mod derivatives;
mod poses;
mod subject;

pub(super) use poses::unchecked_and_checked;
pub use subject::Subject;

use super::{Clock, Timing, Unmeasurable};
use hardpoint_engine::study::WheelStudy;

/// One way to a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Kind of choices that are compared.
    pub family: Family,
    /// The method.
    pub method: String,
    /// The setting that is varied.
    pub setting: String,
    /// Time per pose.
    pub time: Timing,
    /// The largest true error, in the unit of the family.
    pub error: f64,
    /// Evaluations of the equations per pose, where they are iterated.
    pub evaluations: Option<f64>,
}

/// Kinds of choices that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Poses by formulation, arithmetic and tolerance; error in degrees of camber.
    Pose,
    /// Start of Newton's method; error in degrees of camber.
    Start,
    /// Curves through few exact poses; error in degrees of camber.
    Curve,
    /// Derivatives of four characteristics by every hardpoint coordinate; error in parts of the largest.
    Derivative,
    /// Forward against adjoint sensitivities; error likewise.
    Sensitivity,
}

impl Family {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        ["pose", "start", "curve", "derivative", "sensitivity"][self as usize]
    }

    /// The unit of its errors.
    pub fn unit(self) -> &'static str {
        match self {
            Family::Pose | Family::Start | Family::Curve => "deg",
            Family::Derivative | Family::Sensitivity => "relative",
        }
    }
}

/// Everything measured on one study.
#[derive(Clone, Debug, PartialEq)]
pub struct Accuracy {
    /// One for each way.
    pub measurements: Vec<Measurement>,
}

impl Accuracy {
    /// Measures.
    pub fn measure(study: &WheelStudy, clock: &Clock) -> Result<Self, Unmeasurable> {
        let subject = Subject::of(study)?;
        let mut measurements = poses::measure(&subject, clock)?;
        measurements.extend(curve::measure(&subject, clock)?);
        measurements.extend(derivatives::measure(&subject, clock)?);
        Ok(Accuracy { measurements })
    }
}

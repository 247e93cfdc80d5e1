//! Derivatives of a pose with respect to the drive coordinate (power series), the rack and every hardpoint coordinate.
//!
//! [`DesignSeries`] expands a pose into power series along the motion. [`Linearised`] has the adjoint of the closure
//! equations. With it, the gradient of any output costs one back-substitution.

mod motion;
pub(crate) mod rates;
pub(crate) mod sensitivity;
pub(crate) mod steering;

pub(crate) use motion::Factorised;
pub use motion::{DesignSeries, MotionPoint};
pub(crate) use rates::pose_series;
pub use sensitivity::{DesignedSpinAxis, Gradient, Linearised, Seeds};

//! Derivatives of a pose: by the drive (power series), by the rack, and by every hardpoint coordinate.
//!
//! [`DesignSeries`] turns a pose into power series along the motion. [`Linearised`] gives the adjoint, with which the
//! gradient of any output costs one back-substitution.

mod motion;
pub(crate) mod rates;
pub(crate) mod sensitivity;
pub(crate) mod steering;

pub(crate) use motion::Factorised;
pub use motion::{DesignSeries, MotionPoint};
pub(crate) use rates::pose_series;
pub use sensitivity::{DesignedSpinAxis, Gradient, Linearised, Seeds};

//! Exact suspension kinematics with analytic derivatives, and the tuning of hardpoints.
pub mod characteristics;
pub mod kinematics;
pub mod model;
pub mod number;
pub mod study;

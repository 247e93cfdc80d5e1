//! Exact suspension kinematics with analytic derivatives, and the tuning of hardpoints.
pub mod characteristics;
pub mod curves;
pub mod kinematics;
pub mod model;
pub mod number;
pub mod optimise;
pub mod plan;
pub mod study;

//! Solving for the pose, its rates and its sensitivities.

pub mod point_coordinates;

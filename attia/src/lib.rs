//! The MacPherson strut in point coordinates: the formulation of H. A. Attia, *Numerical Kinematic Analysis of the Standard
//! Macpherson Motor-Vehicle Suspension System*, KSME International Journal 17 (2003), corrected. This crate uses the paper's
//! equation numbers.
//!
//! The unknowns are the coordinates of five points. All other positions follow from them. The points have the numbers of the
//! paper:
//!
//! | number | hardpoint | |
//! |---|---|---|
//! | 1, 2 | `lower_arm_front`, `lower_arm_rear` | fixed |
//! | 3 | `tie_rod_inner` | moved by the rack, along y |
//! | 4 | `strut_top` | fixed |
//! | 5 | `lower_ball_joint` | unknown |
//! | 6, 7 | two knuckle points on the strut axis (see [`StrutPoints`]) | unknown |
//! | 8 | `tie_rod_outer` | unknown |
//! | 9 | a point of the strut's rod, on its axis | unknown |
//! | 10 | `wheel_centre` | follows from 5, 6, 7 and 8 |
//!
//! There are fifteen equations: ten distances (1)-(10), four conditions that keep 4, 6, 7 and 9 on one line (11)-(14), and one
//! for the drive (15). Newton's method solves them from the previous pose. Velocities and accelerations take one LU factorisation
//! with partial pivoting.
//!
//! # Differences from the printed paper
//! - Equation (14) has `z9 - z7` where `z9 - z6` is printed, and (15) has `z5 - z1` where `z6 - z1` is printed.
//! - Equation (15) is one of three drives ([`Drive`]). As printed, it cannot distinguish the two sides of the arm.
//! - The paper requires point 4 on the line 6-7. If the line through `strut_lower` and `strut_upper` of a study misses
//!   `strut_top`, the strut's axis is the parallel through `strut_top`. Then 6, 7 and 9 are points of that axis. The study's own
//!   points move with the knuckle ([`KnucklePoint`]).
//! - The wheel centre is an affine combination of four knuckle points. The paper intersects three spheres, which has two
//!   solutions.
//! - Angular velocity and acceleration come from all four knuckle points ([`AngularMotion`]). Equation (25) is 0/0 if the vector
//!   lies in the plane 6-7-8.
//!
//! # Choice of the solution
//! The equations have up to 32 real solutions at one position of the arm, because five choices have two sides each:
//!
//! - the knuckle or its mirror image;
//! - the rod in its direction or reversed;
//! - point 4 on either side of the foot of point 5 on the strut's axis;
//! - the tie-rod end on either side of the plane 3-4-5;
//! - with (15) as printed, the arm on either side.
//!
//! The crate returns a pose only if it continues the pose from which the search started. [`PointCoordinates::track`] explains
//! how.
//!
//! # Singular positions
//! The answer is a [`Refusal`] where the solution branch ends. The answer is also a refusal where the equations lose rank, even
//! if the suspension itself is not singular there ([`Singular`]).
//!
//! # Use in studies
//! [`register`] makes `formulation = "point_coordinates"` available to the engine. The program `hardpoint` and the Python
//! module call this function.
//!
//! # Frame and units
//! x forward, y left (outboard), z up; a left wheel. Any unit of length works, because every equation is a squared length and
//! every tolerance is relative.

#![warn(clippy::allow_attributes_without_reason, unreachable_pub)]

mod branch;
mod drive;
mod equations;
mod formulation;
mod knuckle;
mod motion;
mod refusal;
mod stations;
mod strut;
mod tracking;

pub use drive::Drive;
pub use formulation::register;
pub use hardpoint_engine::characteristics::{attia_camber, attia_kingpin};
pub use hardpoint_engine::curves::PaperTheta;
pub use knuckle::{AngularMotion, KnucklePoint};
pub use motion::{Motion, Rates};
pub use refusal::{Refusal, Singular};
pub use strut::{Strut, StrutPoints};
pub use tracking::{PointCoordinates, Pose, Station, solve_travel};

use hardpoint_engine::number::Vector3;

/// The unknown points 5, 6, 7, 8 and 9, in this order. The same type holds their velocities or accelerations.
pub type Moving = [Vector3<f64>; 5];

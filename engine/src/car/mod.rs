//! The whole car in quasi-static equilibrium.
//!
//! The body is rigid. It carries two axles, the sprung mass with its centre of gravity G, and the aerodynamic forces. The
//! ground is a plane. Each wheel carrier has a point mass m_b at its wheel centre W. All masses share one acceleration,
//! which is given in the axes of the ground. The only compliance is a vertical spring of the tyre.
//!
//! ## Ground
//!
//! The body stays fixed in its axes (x forward, y left, z up); the ground tilts. Order of the angles: yaw, pitch, roll
//! (ISO 8855). A wheel has the wheel centre W, the unit vector a along its spin axis, and the contact point C. With roll
//! phi (right wheel in jounce), pitch theta (nose down), S = sin theta and c = cos theta
//!
//! ```text
//! n = (-S, c sin phi, c cos phi)   up      e = (0, cos phi, -sin phi)   left      i = e x n   forward          (1)
//! C = W - R_l u                            u = (n - (n.a) a)/s                    s = |n - (n.a) a|            (2)
//! ```
//!
//! The ground is the plane n.X = gamma, and R_l is the loaded radius.
//!
//! ## Unknowns and equations
//!
//! x = (phi, theta, gamma; z_1..z_4; N_1..N_4; A_f, A_r, B) with the travels z, the wheel loads N and the tyre force
//! factors A (front, rear) and B. A wheel's tyre carries N n + S lambda + X t. The longitudinal force X acts along the unit
//! vector t, and the lateral force S along lambda, with
//!
//! ```text
//! S = A f,   X = B p g                                                                                          (3)
//! ```
//!
//! f and g are the wheel's shares of the axle's side force and longitudinal force. p is the axle's share of braking or
//! drive. k is the rate of a tyre spring, and R is the wheel's radius at the load N0. With R_u = R + N0/k and alpha =
//! ax i + ay e + (g + az) n,
//!
//! ```text
//! rigid tyre       n.W - gamma - R s = 0                                                                        (4)
//! tyre spring      N - k (R_u - R_l)/s = 0,      R_l = (n.W - gamma)/s                                          (5)
//! lifted wheel     N = 0                                                                                        (6)
//! each travel      N n.C' + S lambda.C' + X t.B' - m_b alpha.W' - U_z = 0                                       (7)
//! whole car        sum F.i = sum F.e = sum F.n = 0,   sum M.x = sum M.e = sum M.n = 0                           (8)
//! ```
//!
//! A prime is the derivative with respect to the wheel's own travel, with the body fixed. C' is the velocity of the
//! carrier's point at C. If the carrier carries the reaction to the torque, B' is C'. Otherwise B' is the velocity of a
//! point that does not rotate with the carrier about the spin axis. U is the energy of springs, stops and bar. Moments
//! are about the origin, and M.x is the work per roll angle.
//!
//! If equation (7) is divided by n.C', each wheel load is the exact sum of four components:
//!
//! ```text
//! N = U_z/(n.C')  -  S lambda.C'/(n.C')  -  X t.B'/(n.C')  +  m_b alpha.W'/(n.C')                               (9)
//!     elastic        geometric              longitudinal      unsprung
//! ```
//!
//! ## Derivatives
//!
//! With G = 0 the equations and p a parameter or a hardpoint,
//!
//! ```text
//! x_p = -G_x^-1 G_p,      dy/dp = y_p + y_x x_p                                                                (10)
//! ```
//!
//! The equations are written once over any number type. One Newton step with numbers that carry gradients adds the gradient
//! of the unknowns. A further step with Taylor series adds derivatives along a direction.

mod accepted;
mod answers;
mod case;
mod catalogue;
mod corner;
mod drawn;
mod equations;
mod formulas;
mod gradients;
mod limits;
mod members;
mod moves;
mod objective;
mod parameters;
mod rates;
mod rig;
mod road;
mod second;
mod solver;
mod stability;
mod tangent;
mod templates;
mod tune;

pub use answers::{CarFault, CarRequest, CaseResult, FailedCases};
pub use case::{
    Case, LateralShares, Longitudinal, LongitudinalShares, NoEquilibrium, Setting, TyreAxes,
};
pub use catalogue::{
    AxleEnd, AxleResult, CarInfo, CarNeed, CarQuantity, WheelPlace, WheelResult, WholeResult,
};
pub use drawn::CarDrawing;
pub use equations::{Balance, UNKNOWNS, WheelState};
pub use gradients::CarGradient;
pub use limits::{Lift, RayLimits};
pub use members::{CarMember, WheelMembers};
pub use moves::{CarVariable, Moves, PointMove, body_key, moved, rate_key};
pub use parameters::{AxleParameter, BodyParameter, Parameter, Parameters};
pub use rates::Solved;
pub use rig::RigOutcome;
pub(crate) use second::ExpandedState;
pub use solver::{CarSolver, Equilibrium, RowResult, RowState};
pub use templates::{CarTemplate, TEMPLATES};
pub use tune::{CarConstraint, CarGoals, CarRun, CarTarget, CarTuning, RigGoals, tune};

use crate::axle::Axle;
use crate::model::{LengthUnit, MassUnit, TorquePath};
use crate::number::Vector3;

/// Standard acceleration of free fall, m/s2.
pub const GRAVITY: f64 = 9.80665;

/// Names of the axles in keys, columns and messages.
pub const AXLE_NAMES: [&str; 2] = ["front", "rear"];

/// A car: two axles and a body. Vectors are in the axes of the front axle's left wheel (x forward, y left, z up).
#[derive(Clone, Debug, PartialEq)]
pub struct Car {
    /// Axles of the car: [front, rear].
    pub axles: [Axle; 2],
    /// Position of the rear axle's origin, in the axes of the front axle.
    pub rear_offset: Vector3<f64>,
    /// Masses that `mass` and `cg` include.
    pub masses: Masses,
    /// Mass in kg: of the whole car, or the sprung mass, according to `masses`.
    pub mass: f64,
    /// Unit in which studies and results give masses.
    pub mass_unit: MassUnit,
    /// Centre of gravity of `mass` in the design position.
    pub cg: Vector3<f64>,
    /// Fraction of the braking force on the front axle.
    pub brake_share_front: Option<f64>,
    /// Fraction of the drive force on the front axle.
    pub drive_share_front: Option<f64>,
    /// Yaw inertia of the car, kg m2.
    pub yaw_inertia: Option<f64>,
    /// Pitch inertia of the sprung mass, kg m2.
    pub pitch_inertia: Option<f64>,
    /// Points of the body whose heights above the ground are the ride heights: [front, rear].
    pub ride_height_points: [Option<Vector3<f64>>; 2],
    /// Vertical springs of the tyres: [front, rear]. `None` means rigid tyres.
    pub tyres: Option<[Tyre; 2]>,
    /// Aerodynamic forces.
    pub air: Option<Air>,
    /// Length unit of all lengths.
    pub length_unit: LengthUnit,
}

/// Masses that a given mass includes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masses {
    /// The whole car, including the wheels.
    Whole,
    /// The sprung mass only.
    Sprung,
}

/// Vertical spring of a tyre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tyre {
    /// Force per vertical deflection.
    pub rate: f64,
    /// Load at which the wheel has the given radius. `None` means half the axle's static load in the design position.
    pub load: Option<f64>,
}

/// Aerodynamic forces at points of the body. Downforce acts down along the normal of the ground (-n). Drag acts
/// rearward along the ground (-i).
#[derive(Clone, Debug, PartialEq)]
pub struct Air {
    /// Density of the air, kg/m3.
    pub density: f64,
    /// Downforce near the front and the rear axle: [front, rear].
    pub downforce: [Option<AirForce>; 2],
    /// Drag of the car.
    pub drag: Option<AirForce>,
}

/// An aerodynamic force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirForce {
    /// Point of the body at which the force acts.
    pub point: Vector3<f64>,
    /// Coefficient times area, m2, as a quadratic polynomial of the ride heights hf and hr, in the car's length unit. The
    /// numbers are the factors of 1, hf, hr, hf^2, hf hr and hr^2.
    pub area: [f64; 6],
}

impl Car {
    /// Returns true if the wheel carrier carries the reaction to the torque of an axle's brakes or drive.
    pub fn carrier_takes_torque(&self, axle: usize, longitudinal: Longitudinal) -> bool {
        let vehicle = &self.axles[axle].left.vehicle;
        let path = match longitudinal {
            Longitudinal::Brake => vehicle.brakes,
            Longitudinal::Drive => vehicle.drive_torque,
        };
        path != Some(TorquePath::Shafts)
    }

    /// Describes why a design position cannot be solved.
    pub fn describe_fault(&self, (axle, side, fault): &CarFault) -> String {
        let end = AXLE_NAMES[*axle];
        let reason = self.axles[*axle].describe_fault((*side, fault.clone()));
        format!("{end} axle: {reason}")
    }

    /// Number of length units of the study per metre.
    pub fn per_metre(&self) -> f64 {
        self.length_unit.per_metre()
    }
}

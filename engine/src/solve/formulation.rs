//! Formulations: equations of a mechanism in unknowns other than the pose of the knuckle. A separate crate implements a
//! formulation, and the program registers it.

use crate::mechanism::{DesignFault, Failure, Pose, Work};
use crate::model::Suspension;
use crate::number::Jet;
use std::sync::OnceLock;

/// Coordinate that drives the mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Height of the wheel centre above its design position.
    Travel,
    /// Angle of the first control arm from its design position, positive upwards.
    ArmAngle,
    /// Angle theta of Attia's paper (see [`crate::curves::PaperTheta`]).
    PaperTheta,
}

/// A motion to solve: every drive value at every rack displacement.
#[derive(Clone, Copy, Debug)]
pub struct FormulationMotion<'a> {
    /// Coordinate that drives the mechanism.
    pub drive: Drive,
    /// Drive values, in length units or radians.
    pub values: &'a [f64],
    /// Displacements of the rack, towards the kernel's +y.
    pub racks: &'a [f64],
    /// Number of Taylor coefficients along the drive to compute, 1 to 3.
    pub coefficients: usize,
}

/// A solved pose.
#[derive(Clone, Copy, Debug)]
pub struct FormulationPose {
    /// Pose of the knuckle as a Taylor series along the drive. Coefficients that are not requested may be 0.
    pub pose: Pose<Jet<f64, 3>>,
    /// Displacement of the rack, towards the kernel's +y.
    pub rack: f64,
    /// Condition number of the equations.
    pub condition: f64,
    /// Value of the drive coordinate minus its value in the design position, with the sign that the equations use.
    pub drive: f64,
}

/// Event that the solver reports while it visits the stations of a motion.
#[derive(Clone, Copy, Debug)]
pub enum FormulationVisit {
    /// The design position with the rack displaced. The solver visits it, if it exists, before the stations of this rack
    /// displacement.
    Start {
        /// Pose of the knuckle.
        pose: Pose<Jet<f64, 3>>,
        /// Displacement of the rack, towards the kernel's +y.
        rack: f64,
    },
    /// A station of the motion.
    Station {
        /// Index of the displacement of the rack.
        rack: usize,
        /// Index of the drive value.
        number: usize,
        /// The pose, or the reason why the station has no pose.
        found: Result<FormulationPose, Failure>,
    },
}

/// Equations that give the poses of a topology in unknowns other than the pose of the knuckle.
pub trait Formulation: Sync {
    /// Visits the stations of a motion. At each displacement of the rack, the visit starts at the design position and
    /// continues outward. Returns the counts of the solver's steps, such as Newton iterations.
    ///
    /// # Errors
    /// Returns an error if the equations cannot describe the design.
    fn poses(
        &self,
        suspension: &Suspension,
        motion: &FormulationMotion<'_>,
        visit: &mut dyn FnMut(FormulationVisit),
    ) -> Result<Work, DesignFault>;
}

/// Formulation `point_coordinates`, if the program has registered it.
static POINT_COORDINATES: OnceLock<&'static dyn Formulation> = OnceLock::new();

/// Registers the formulation `point_coordinates` for all studies of the process. Later calls have no effect.
pub fn register_formulation(formulation: &'static dyn Formulation) {
    POINT_COORDINATES.get_or_init(|| formulation);
}

/// Formulation `point_coordinates`.
///
/// # Errors
/// Returns an error if the program has not registered this formulation.
pub(crate) fn point_coordinates() -> Result<&'static dyn Formulation, DesignFault> {
    let registered = POINT_COORDINATES.get().copied();
    registered.ok_or(DesignFault::NoFormulation("point_coordinates"))
}

//! Inputs of an axle's formulas other than the hardpoints: steering, springs, masses.

use super::rocker_springs::RockerSprings;
use super::spring::SpringLaw;
use crate::characteristics::Constants;
use crate::model::AxlePosition;

/// Further inputs of the study. Lengths are in the study's unit, forces in newtons, angles in radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setup {
    /// Loaded radius of the wheels.
    pub wheel_radius: Option<f64>,
    /// Distance between front and rear axle.
    pub wheelbase: Option<f64>,
    /// Position of this axle, front or rear; `None` counts as front.
    pub position: Option<AxlePosition>,
    /// Rack displacement per turn (2 pi) of the steering wheel to the left. It is positive towards the kernel's +y.
    pub c_factor: Option<f64>,
    /// Springs of the left and right wheel.
    pub springs: Option<[SpringLaw; 2]>,
    /// Springs between the rockers of both wheels.
    pub rocker_springs: RockerSprings,
    /// Anti-roll bar rate: torque per angle between its two levers.
    pub bar_rate: Option<f64>,
    /// Tyre rate: force per deflection. `None` means a rigid tyre.
    pub tyre_rate: Option<f64>,
    /// Tyre load at which the wheel has the given radius. Only the calculation of a whole car uses it.
    pub tyre_load: Option<f64>,
    /// Sprung mass on the axle, kg.
    pub sprung_mass: Option<f64>,
    /// Unsprung mass of the axle, kg.
    pub unsprung_mass: Option<f64>,
    /// Constants that are inputs of wheel characteristics.
    pub constants: Constants,
    /// Length units per metre.
    pub per_metre: f64,
}

impl Setup {
    /// Returns true if springs carry the body.
    pub fn is_sprung(&self) -> bool {
        self.springs.is_some() || self.rocker_springs.carry()
    }

    /// Sign of the forward direction in a turn: -1 for a rear axle, which counts as the front axle of a car driven backwards.
    pub(super) fn forward(&self) -> f64 {
        match self.position {
            Some(AxlePosition::Rear) => -1.0,
            Some(AxlePosition::Front) | None => 1.0,
        }
    }
}

//! The vehicle of a study: one wheel or an axle, each with its motion and outputs.

use super::{
    AxleStudy, ComplianceStudy, ElasticFigure, Formulation, Motion, Outputs, Study, elastic_targets,
};
use crate::compliance::{AxleParameter, Parameter};
use crate::model::{Side, Suspension};
use std::sync::LazyLock;

/// Vehicle part that a study describes.
#[derive(Clone, Debug, PartialEq)]
pub enum Vehicle {
    /// One wheel.
    Wheel(Box<WheelStudy>),
    /// Both wheels of an axle.
    Axle(Box<AxleStudy>),
}

/// One wheel, its motion and outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct WheelStudy {
    /// The suspension.
    pub suspension: Suspension,
    /// The motion.
    pub motion: Motion,
    /// Formulation that finds the poses.
    pub formulation: Formulation,
    /// Outputs of the study.
    pub outputs: Outputs,
    /// The elastic parts and their tests, if there are any.
    pub compliance: Option<ComplianceStudy>,
}

impl WheelStudy {
    /// The figures of the tests on its elastic parts; none without such parts.
    pub fn figures(&self) -> Vec<ElasticFigure> {
        let elastic = self.compliance.iter();
        elastic
            .flat_map(|own| elastic_targets::figures(own, &self.suspension))
            .collect()
    }

    /// The design position of a suspension, without outputs.
    pub fn of(suspension: Suspension) -> Self {
        WheelStudy {
            suspension,
            motion: Motion::still(),
            formulation: Formulation::KnucklePose,
            outputs: Outputs::of(Vec::new()),
            compliance: None,
        }
    }
}

/// The design position alone.
static STILL: LazyLock<Motion> = LazyLock::new(Motion::still);

impl Vehicle {
    /// The suspension of the wheel; of an axle that of its left wheel. The variables of a study move its hardpoints.
    pub fn wheel(&self) -> &Suspension {
        match self {
            Vehicle::Wheel(own) => &own.suspension,
            Vehicle::Axle(both) => &both.axle.left,
        }
    }

    /// The same as [`Vehicle::wheel`], to be changed.
    pub fn wheel_mut(&mut self) -> &mut Suspension {
        match self {
            Vehicle::Wheel(own) => &mut own.suspension,
            Vehicle::Axle(both) => &mut both.axle.left,
        }
    }

    /// The motion of the wheel by itself, where targets and constraints without a motion of their own hold. An axle moves
    /// both wheels, so that of its left wheel by itself this is the design position alone.
    pub fn motion(&self) -> &Motion {
        match self {
            Vehicle::Wheel(own) => &own.motion,
            Vehicle::Axle(_) => &STILL,
        }
    }

    /// Sets the rate of an elastic part, if the vehicle has it.
    pub fn set_rate(&mut self, of: AxleParameter, value: f64) {
        match self {
            Vehicle::Wheel(own) => {
                if let Some(elastic) = &mut own.compliance {
                    elastic.parts.set_rate(of.parameter, value);
                }
            }
            Vehicle::Axle(both) => {
                if let Some(elastic) = &mut both.axle.elastic {
                    elastic.parts.set_rate(of, value);
                }
                // The set-up of the axle has the spring and the bar, too.
                let setup = &mut both.axle.setup;
                match of.parameter {
                    Parameter::BarRate => setup.bar_rate = Some(value),
                    Parameter::SpringRate => {
                        let laws = Side::ALL
                            .into_iter()
                            .zip(setup.springs.iter_mut().flatten());
                        let own = laws.filter(|(side, _)| of.side.is_none_or(|own| own == *side));
                        own.for_each(|(_, law)| law.set_rate(value));
                    }
                    _ => {}
                }
            }
        }
    }

    /// The axle, if it is one.
    pub fn axle(&self) -> Option<&AxleStudy> {
        match self {
            Vehicle::Axle(both) => Some(both),
            Vehicle::Wheel(_) => None,
        }
    }

    /// The axle, to be changed, if it is one.
    pub fn axle_mut(&mut self) -> Option<&mut AxleStudy> {
        match self {
            Vehicle::Axle(both) => Some(both),
            Vehicle::Wheel(_) => None,
        }
    }

    /// The wheel with its motion, if it is one wheel.
    pub fn one_wheel(&self) -> Option<&WheelStudy> {
        match self {
            Vehicle::Wheel(own) => Some(own),
            Vehicle::Axle(_) => None,
        }
    }

    /// The wheel with its motion, to be changed, if it is one wheel.
    pub fn one_wheel_mut(&mut self) -> Option<&mut WheelStudy> {
        match self {
            Vehicle::Wheel(own) => Some(own),
            Vehicle::Axle(_) => None,
        }
    }
}

impl Study {
    /// The suspension of the wheel; of an axle that of its left wheel. The variables move its hardpoints.
    pub fn wheel(&self) -> &Suspension {
        self.vehicle.wheel()
    }

    /// The same as [`Study::wheel`], to be changed.
    pub fn wheel_mut(&mut self) -> &mut Suspension {
        self.vehicle.wheel_mut()
    }

    /// The suspension of the wheel; of an axle that of its left wheel.
    pub fn into_wheel(self) -> Suspension {
        match self.vehicle {
            Vehicle::Wheel(own) => own.suspension,
            Vehicle::Axle(both) => both.axle.left,
        }
    }

    /// Names of the further motions that have curves: those of one wheel, or those of an axle. Motions of an axle's left
    /// wheel by itself serve constraints only.
    pub fn motion_names(&self) -> Vec<&str> {
        match &self.vehicle {
            Vehicle::Wheel(_) => self.motions.iter().map(|(name, _)| name.as_str()).collect(),
            Vehicle::Axle(both) => both.motions.iter().map(|(name, _)| name.as_str()).collect(),
        }
    }

    /// The study with one of [`Study::motion_names`] in place of its own motion; `None` for another name.
    pub fn in_motion(&self, name: &str) -> Option<Study> {
        let mut study = self.clone();
        match &mut study.vehicle {
            Vehicle::Wheel(own) => {
                let (_, motion) = self.motions.iter().find(|(known, _)| known == name)?;
                own.motion.clone_from(motion);
            }
            Vehicle::Axle(both) => {
                let (_, motion) = both.motions.iter().find(|(known, _)| known == name)?;
                both.plan.motion = motion.clone();
            }
        }
        Some(study)
    }

    /// The motion of the wheel by itself ([`Vehicle::motion`]).
    pub fn motion(&self) -> &Motion {
        self.vehicle.motion()
    }

    /// The elastic parts of one wheel and their tests, if the study has them.
    pub fn compliance(&self) -> Option<&ComplianceStudy> {
        self.one_wheel()?.compliance.as_ref()
    }

    /// Returns true if the study has elastic parts, of a wheel or of an axle.
    pub fn is_elastic(&self) -> bool {
        let of_axle = self.axle().is_some_and(|both| both.axle.elastic.is_some());
        of_axle || self.compliance().is_some()
    }

    /// The axle, if the study is of one.
    pub fn axle(&self) -> Option<&AxleStudy> {
        self.vehicle.axle()
    }

    /// The axle, to be changed, if the study is of one.
    pub fn axle_mut(&mut self) -> Option<&mut AxleStudy> {
        self.vehicle.axle_mut()
    }

    /// The wheel with its motion, if the study is of one wheel.
    pub fn one_wheel(&self) -> Option<&WheelStudy> {
        self.vehicle.one_wheel()
    }

    /// The wheel with its motion, to be changed, if the study is of one wheel.
    pub fn one_wheel_mut(&mut self) -> Option<&mut WheelStudy> {
        self.vehicle.one_wheel_mut()
    }
}

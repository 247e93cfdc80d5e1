//! Vehicle of a study: one wheel or an axle, each with its motion and outputs.

use super::{
    AxleStudy, ComplianceStudy, ElasticFigure, Formulation, Motion, Outputs, Study, elastic_targets,
};
use crate::assembly::Assembler;
use crate::compliance::{AxleParameter, Parameter};
use crate::mechanism::DesignFault;
use crate::model::{Side, Suspension};
use crate::number::Vector3;
use std::sync::LazyLock;

/// Part of the vehicle that a study describes.
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
    /// Suspension of the wheel.
    pub suspension: Suspension,
    /// Motion of the wheel.
    pub motion: Motion,
    /// Formulation that finds the poses.
    pub formulation: Formulation,
    /// Outputs of the study.
    pub outputs: Outputs,
    /// Elastic parts and their tests, if there are any.
    pub compliance: Option<ComplianceStudy>,
}

impl WheelStudy {
    /// Test results of the elastic parts. Empty without such parts.
    pub fn figures(&self) -> Vec<ElasticFigure> {
        let elastic = self.compliance.iter();
        elastic
            .flat_map(|own| elastic_targets::figures(own, &self.suspension))
            .collect()
    }

    /// Study of a suspension in its design position, without outputs.
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

/// Motion that consists only of the design position.
static STILL: LazyLock<Motion> = LazyLock::new(Motion::still);

impl Vehicle {
    /// Suspension of the wheel, or of an axle's left wheel. The variables of a study move the hardpoints of this
    /// suspension.
    pub fn wheel(&self) -> &Suspension {
        match self {
            Vehicle::Wheel(own) => &own.suspension,
            Vehicle::Axle(both) => &both.axle.left,
        }
    }

    /// Mutable reference to [`Vehicle::wheel`].
    pub fn wheel_mut(&mut self) -> &mut Suspension {
        match self {
            Vehicle::Wheel(own) => &mut own.suspension,
            Vehicle::Axle(both) => &mut both.axle.left,
        }
    }

    /// Motion of a single wheel. Targets and constraints that name no motion use it. For an axle it consists only of the
    /// design position, because a motion of an axle moves both wheels.
    pub fn motion(&self) -> &Motion {
        match self {
            Vehicle::Wheel(own) => &own.motion,
            Vehicle::Axle(_) => &STILL,
        }
    }

    /// Returns true if the vehicle has elastic parts.
    pub fn is_elastic(&self) -> bool {
        match self {
            Vehicle::Wheel(own) => own.compliance.is_some(),
            Vehicle::Axle(both) => both.axle.elastic.is_some(),
        }
    }

    /// Sets the rate of an elastic part, if the vehicle has this part. The set-up of an axle gets the rate of an anti-roll bar in
    /// any case.
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
                // The axle's set-up also contains the spring and the bar, so their rates change there, too.
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

    /// Replaces the design. A right wheel with independent hardpoints moves by the same displacements as the left wheel.
    pub(crate) fn set_design(&mut self, mut design: Vec<Vector3<f64>>) {
        if let Vehicle::Axle(both) = self {
            let axle = &mut both.axle;
            axle.complete(&mut design);
            let own = axle.right_design(&design).map(Iterator::collect);
            if let (Some(right), Some(own)) = (&mut axle.right, own) {
                right.design = own;
            }
        }
        self.wheel_mut().design = design;
    }

    /// Returns the vehicle in the form in which builds are assembled. The spin axis of each wheel runs through a point of
    /// its carrier ([`Assembler::suspension`]). The right wheel of an axle has independent hardpoints.
    ///
    /// # Errors
    ///
    /// Returns an error if the design of a wheel cannot move.
    pub fn assembled(&self) -> Result<Vehicle, DesignFault> {
        let of = |wheel: &Suspension| Ok(Assembler::new(wheel)?.suspension().clone());
        let mut assembled = self.clone();
        match &mut assembled {
            Vehicle::Wheel(own) => own.suspension = of(&own.suspension)?,
            Vehicle::Axle(both) => {
                let axle = &mut both.axle;
                axle.right = Some(of(axle.suspension(Side::Right))?);
                axle.left = of(&axle.left)?;
            }
        }
        Ok(assembled)
    }

    /// Axle. `None` if the vehicle is one wheel.
    pub fn axle(&self) -> Option<&AxleStudy> {
        match self {
            Vehicle::Axle(both) => Some(both),
            Vehicle::Wheel(_) => None,
        }
    }

    /// Mutable axle. `None` if the vehicle is one wheel.
    pub fn axle_mut(&mut self) -> Option<&mut AxleStudy> {
        match self {
            Vehicle::Axle(both) => Some(both),
            Vehicle::Wheel(_) => None,
        }
    }

    /// Wheel with its motion. `None` if the vehicle is an axle.
    pub fn one_wheel(&self) -> Option<&WheelStudy> {
        match self {
            Vehicle::Wheel(own) => Some(own),
            Vehicle::Axle(_) => None,
        }
    }

    /// Mutable wheel with its motion. `None` if the vehicle is an axle.
    pub fn one_wheel_mut(&mut self) -> Option<&mut WheelStudy> {
        match self {
            Vehicle::Wheel(own) => Some(own),
            Vehicle::Axle(_) => None,
        }
    }
}

impl Study {
    /// Suspension of the wheel, or of an axle's left wheel. The variables move its hardpoints.
    pub fn wheel(&self) -> &Suspension {
        self.vehicle.wheel()
    }

    /// Mutable reference to [`Study::wheel`].
    pub fn wheel_mut(&mut self) -> &mut Suspension {
        self.vehicle.wheel_mut()
    }

    /// Suspension of the wheel, or of an axle's left wheel.
    pub fn into_wheel(self) -> Suspension {
        match self.vehicle {
            Vehicle::Wheel(own) => own.suspension,
            Vehicle::Axle(both) => both.axle.left,
        }
    }

    /// Names of the further motions with curves: motions of one wheel, or of an axle. Motions of only an axle's left wheel
    /// are left out, because only constraints use them.
    pub fn motion_names(&self) -> Vec<&str> {
        match &self.vehicle {
            Vehicle::Wheel(_) => self.motions.iter().map(|(name, _)| name.as_str()).collect(),
            Vehicle::Axle(both) => both.motions.iter().map(|(name, _)| name.as_str()).collect(),
        }
    }

    /// Returns the study with the motion of this name in place of its own motion. `None` if [`Study::motion_names`] does not
    /// contain the name.
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

    /// Motion of a single wheel ([`Vehicle::motion`]).
    pub fn motion(&self) -> &Motion {
        self.vehicle.motion()
    }

    /// Elastic parts of one wheel and their tests, if the study has them.
    pub fn compliance(&self) -> Option<&ComplianceStudy> {
        self.one_wheel()?.compliance.as_ref()
    }

    /// Returns true if the study has elastic parts, of a wheel or of an axle.
    pub fn is_elastic(&self) -> bool {
        self.vehicle.is_elastic()
    }

    /// Axle. `None` if the study describes one wheel.
    pub fn axle(&self) -> Option<&AxleStudy> {
        self.vehicle.axle()
    }

    /// Mutable axle. `None` if the study describes one wheel.
    pub fn axle_mut(&mut self) -> Option<&mut AxleStudy> {
        self.vehicle.axle_mut()
    }

    /// Wheel with its motion. `None` if the study describes an axle.
    pub fn one_wheel(&self) -> Option<&WheelStudy> {
        self.vehicle.one_wheel()
    }

    /// Mutable wheel with its motion. `None` if the study describes an axle.
    pub fn one_wheel_mut(&mut self) -> Option<&mut WheelStudy> {
        self.vehicle.one_wheel_mut()
    }
}

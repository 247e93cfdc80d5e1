//! Variables of a [`DesignFunction`](super::DesignFunction).

use crate::model::Suspension;
use crate::number::Each;
use crate::study::{Designs, Study, SweepVariable, Variable, nearest};
use thiserror::Error;

/// Reason why a study cannot be converted to a function.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FunctionError {
    /// The study uses the equations of Attia's paper, which do not give every output for every design.
    #[error(
        "DesignFunction does not support formulation = \"point_coordinates\" or drive = \"paper_theta\""
    )]
    Formulation,
    /// The study has elastic parts. Their equilibrium does not depend on the positions of hardpoints alone.
    #[error("DesignFunction is for rigid mechanisms only; the study has [compliance]")]
    Elastic,
    /// The study has no output that is a function of position.
    #[error(
        "the study requests no output of a DesignFunction; expected characteristics or points of a wheel, or quantities of an \
         axle, in [outputs]"
    )]
    NoOutputs,
    /// The design itself cannot be solved.
    #[error("{0}")]
    Design(String),
    /// No variable has this name.
    #[error(
        "there is no variable {0:?}; expected a hardpoint with its movement, as in \
         tie_rod_inner_dz for an offset or tie_rod_inner_z for a coordinate{1}"
    )]
    UnknownVariable(String, String),
}

/// A design variable of a function.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignVariable {
    /// Unique name: `tie_rod_inner_dz`, `lower_arm_front+lower_arm_rear_dz`, `tie_rod_inner_z` for a coordinate,
    /// `lower_arm_front+lower_arm_rear_turn_x` for a rotation.
    pub name: String,
    /// Points that the variable moves, and its range: an offset from the design, or a coordinate if it is absolute, in the
    /// study's length unit and axes. Degrees for a rotation.
    pub(super) moved: Variable,
    /// True if the variable's value is the coordinate itself, false if it is an offset.
    pub(super) absolute: bool,
}

impl DesignVariable {
    /// Variables of a study: the variables of `[optimise]`, else the variables of `[sweep]`, else every coordinate of every
    /// point that does not follow from other points. A sweep over a file of designs has no variables of its own.
    pub fn of(study: &Study) -> Vec<Self> {
        if let Some(optimise) = &study.optimise {
            return optimise.variables.iter().map(Self::tuned).collect();
        }
        Self::of_sweep(study).unwrap_or_else(|| Self::every_coordinate(study.wheel()))
    }

    /// Variables of `[sweep]`. `None` if the study has no sweep, or if a file of designs gives its variables.
    fn of_sweep(study: &Study) -> Option<Vec<Self>> {
        let variables = match &study.sweep.as_ref()?.designs {
            Designs::Sampled(sampled) => &sampled.variables,
            Designs::Given(table) => &table.variables,
            Designs::File(_) => return None,
        };
        Some(variables.iter().map(Self::swept).collect())
    }

    /// Finds the variable with this name: a variable of `[optimise]` or `[sweep]`, or the offset or coordinate of any point
    /// along an axis. Points that follow from other points have no variables.
    ///
    /// # Errors
    /// [`FunctionError::UnknownVariable`] if no variable has this name. The error suggests the closest name.
    pub fn named(name: &str, study: &Study) -> Result<Self, FunctionError> {
        let mut known = Self::of(study);
        known.extend(Self::of_sweep(study).into_iter().flatten());
        let offsets = Self::every_coordinate(study.wheel());
        let coordinates: Vec<Self> = offsets
            .iter()
            .map(|v| v.as_coordinate(study.wheel()))
            .collect();
        known.extend(offsets.into_iter().chain(coordinates));
        let meant = nearest(name, known.iter().map(|v| v.name.as_str()));
        let meant = meant.map_or(String::new(), |near| format!("; did you mean {near}?"));
        let found = known.iter().find(|v| v.name == name).cloned();
        found.ok_or_else(|| FunctionError::UnknownVariable(name.to_owned(), meant))
    }

    fn tuned(variable: &Variable) -> Self {
        DesignVariable {
            name: variable.label(),
            moved: variable.clone(),
            absolute: false,
        }
    }

    fn swept(variable: &SweepVariable) -> Self {
        DesignVariable {
            name: variable.name.clone(),
            moved: Variable {
                name: variable.name.clone(),
                moves: variable.moves.clone(),
                turn: None,
                rate: None,
                range: variable.range,
                cost: 1.0,
            },
            absolute: variable.absolute,
        }
    }

    /// Offsets of every coordinate of every point, in a range of +-10 mm. Points that follow from other points are left out.
    fn every_coordinate(suspension: &Suspension) -> Vec<Self> {
        let far = 0.01 * suspension.length_unit.per_metre();
        let all = Variable::every_coordinate(suspension, [-far, far]);
        let follows = |v: &&Variable| v.points().any(|id| suspension.mechanism.is_far(id));
        let own = all.iter().filter(|v| !follows(v));
        own.map(Self::tuned).collect()
    }

    /// Replaces the offset of a coordinate by the coordinate itself. A variable that moves more than one coordinate remains
    /// an offset.
    fn as_coordinate(&self, suspension: &Suspension) -> Self {
        let [m] = self.moved.moves[..] else {
            return self.clone();
        };
        let at = suspension.design[m.point.0][m.axis];
        let at = at * suspension.frame.sign(m.axis) + 0.0;
        let mut moved = self.moved.clone();
        moved.range = moved.range.each(|offset| at + offset);
        DesignVariable {
            name: format!("{}_{}", self.moved.name, m.axis.name()),
            moved,
            absolute: true,
        }
    }

    /// Lowest and highest value of the variable, in the study's axes and length unit, or in degrees for a rotation.
    pub fn range(&self) -> [f64; 2] {
        self.moved.range
    }

    /// Returns an offset that moves the design like this variable, and the variable's value at the design. `None` for a
    /// coordinate that several points share, because such a coordinate has no single value at the design.
    pub fn as_offset(&self, suspension: &Suspension) -> Option<(Variable, f64)> {
        if !self.absolute {
            return Some((self.moved.clone(), 0.0));
        }
        let [m] = self.moved.moves[..] else {
            return None;
        };
        Some((self.moved.clone(), m.value_at(suspension)))
    }

    /// Converts the variable to a column of a table of designs. `None` for a rotation and for a stiffness (rate) of an
    /// elastic part, because neither can be a column.
    pub fn swept_as(&self) -> Option<SweepVariable> {
        let is_of_points = self.moved.turn.is_none() && self.moved.rate.is_none();
        is_of_points.then(|| SweepVariable {
            name: self.name.clone(),
            moves: self.moved.moves.clone(),
            rate: None,
            absolute: self.absolute,
            range: self.moved.range,
            steps: None,
        })
    }
}

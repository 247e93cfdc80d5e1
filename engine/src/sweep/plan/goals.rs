//! Goals of a sweep that its stations do not give: targets in other motions, loads, lengths, and all constraints.
//!
//! Each design is assessed after its stations, as a tuning assesses a design: at the stations of each target and each
//! constraint, and at extremes between them.

use super::{DesignFault, Failing, OutputColumn, Sweep};
use crate::number::Vector3;
use crate::optimise::{DesignAssessor, TargetLayout};
use crate::study::{Optimise, Rate, Study, Target, Variable};
use crate::sweep::margins::{distinguish, margin_columns};

/// Goals of a sweep, with the stations at which a design is assessed.
#[derive(Clone, Debug)]
pub(super) struct Goals {
    layout: TargetLayout,
    /// Variables that are rates of elastic parts.
    rates: Vec<Variable>,
    /// Number of targets.
    targets: usize,
    /// Margin columns of the constraints.
    pub columns: Vec<OutputColumn>,
}

impl Goals {
    /// Plans the assessment of these targets and of the study's constraints. `None` if there are none.
    pub(super) fn of<'r>(
        study: &Study,
        sweep: &Sweep,
        targets: Vec<Target>,
        rates: impl Iterator<Item = &'r Rate>,
    ) -> Option<Self> {
        let optimise = study.optimise.as_ref()?;
        let constraints = if sweep.constraints {
            optimise.constraints.clone()
        } else {
            Vec::new()
        };
        if targets.is_empty() && constraints.is_empty() {
            return None;
        }
        let mut columns = margin_columns(&constraints, "");
        distinguish(&mut columns);
        let goals = Optimise {
            targets,
            constraints,
            ..optimise.nominal()
        };
        Some(Goals {
            layout: TargetLayout::of(&goals, &study.vehicle),
            rates: rates.map(|rate| rate_variable(*rate)).collect(),
            targets: goals.targets.len(),
            columns,
        })
    }

    /// Makes the assessor of the designs. Each thread has one.
    pub(super) fn assessor<'a>(
        &'a self,
        study: &'a Study,
    ) -> Result<GoalAssessor<'a>, DesignFault> {
        let assessor = DesignAssessor::new(&study.vehicle, &self.rates, &self.layout)?;
        Ok(GoalAssessor {
            goals: self,
            assessor,
            offsets: Vec::new(),
            values: GoalValues::default(),
        })
    }
}

/// Assessor of the designs of one thread.
pub(super) struct GoalAssessor<'a> {
    goals: &'a Goals,
    assessor: DesignAssessor<'a>,
    offsets: Vec<f64>,
    values: GoalValues,
}

impl GoalAssessor<'_> {
    /// Assesses a design, given by its points and by the rates that the sweep varies. Without values for all goals, returns
    /// the reason, and the values are NaN.
    pub(super) fn assess(
        &mut self,
        design: Option<&[Vector3<f64>]>,
        rates: &[f64],
    ) -> (&GoalValues, Option<Failing>) {
        let GoalAssessor {
            goals,
            assessor,
            offsets,
            values,
        } = self;
        values.rms.clear();
        values.margins.clear();
        let Some(design) = design else {
            values.fill(goals);
            return (values, None);
        };
        offsets.clear();
        let variables = goals.rates.iter().zip(rates);
        offsets.extend(variables.filter_map(|(own, rate)| Some(own.rate.as_ref()?.offset(*rate))));
        match assessor.assess(design, offsets) {
            Ok((deviations, margins)) => {
                values.rms.extend(deviations.iter().map(|own| own.rms));
                values.margins.extend(margins.iter().map(|own| own.room));
                (values, None)
            }
            Err(_) => {
                values.fill(goals);
                (values, Some(Failing::of_goals()))
            }
        }
    }
}

/// Values of the goals in one design. NaN if the design cannot be assessed.
#[derive(Debug, Default)]
pub(super) struct GoalValues {
    /// Root mean square deviation from each target, in multiples of the tolerance.
    pub rms: Vec<f64>,
    /// Margin of each constraint, in the constraint's unit.
    pub margins: Vec<f64>,
}

impl GoalValues {
    /// Sets all values to NaN.
    fn fill(&mut self, goals: &Goals) {
        self.rms.resize(goals.targets, f64::NAN);
        self.margins.resize(goals.columns.len(), f64::NAN);
    }
}

/// Variable of a tuning that changes this rate.
fn rate_variable(rate: Rate) -> Variable {
    Variable {
        name: String::new(),
        moves: Vec::new(),
        turn: None,
        rate: Some(rate),
        range: [f64::NEG_INFINITY, f64::INFINITY],
        cost: 1.0,
    }
}

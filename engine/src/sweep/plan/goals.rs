//! Goals of a sweep whose stations are not stations of the sweep: targets in other motions or at other rack displacements,
//! targets of quantities without a curve (for example loads and lengths), and all constraints.
//!
//! For each design, the worker first solves the stations of the sweep. Then it assesses the design as a tuning does: at the
//! stations of each target and each constraint, and at extremes between them. The goals of each motion are assessed
//! separately. So a design that does not reach a station of one motion keeps the values of the other motions.

use super::{DesignFault, Failing, OutputColumn, Sweep};
use crate::model::Mechanism;
use crate::number::Vector3;
use crate::optimise::{DesignAssessor, TargetLayout};
use crate::study::{Constraint, Optimise, Rate, Site, Study, Target, Variable};
use crate::sweep::margins::{distinguish, margin_columns};

/// Targets and constraints (goals) of a sweep, with the stations at which a design is assessed.
#[derive(Clone, Debug)]
pub(super) struct Goals {
    groups: Vec<Group>,
    /// Variables that are rates of elastic parts.
    rates: Vec<Variable>,
    /// Number of targets to assess.
    targets: usize,
    /// Margin columns of the constraints.
    pub columns: Vec<OutputColumn>,
}

/// Stations of a goal.
#[derive(Clone, Debug, PartialEq)]
enum Place {
    /// Design position.
    Design,
    /// Study's own motion.
    Own,
    /// Motion with this name.
    Named(String),
}

impl Place {
    fn of(site: &Site) -> Self {
        match &site.motion {
            Some((name, _)) => Place::Named(name.clone()),
            None => Place::Own,
        }
    }

    fn of_constraint(constraint: &Constraint, mechanism: &Mechanism) -> Self {
        let is_fixed = constraint
            .parts
            .iter()
            .all(|own| own.of.is_fixed(mechanism));
        let site = constraint.site.as_ref().filter(|_| !is_fixed);
        site.map_or(Place::Design, Place::of)
    }

    fn name(&self) -> &str {
        match self {
            Place::Design => "the design position",
            Place::Own => "[motion]",
            Place::Named(name) => name,
        }
    }
}

/// Targets and constraints at the same stations.
#[derive(Clone, Debug)]
struct Group {
    place: Place,
    layout: TargetLayout,
    /// Indices of the targets at these stations.
    targets: Vec<usize>,
    /// Indices of the constraints at these stations.
    constraints: Vec<usize>,
}

impl Goals {
    /// Plans the assessment of these targets and of the study's constraints. `None` if there are none.
    pub(super) fn of<'r>(
        study: &Study,
        sweep: &Sweep,
        targets: &[Target],
        rates: impl Iterator<Item = &'r Rate>,
    ) -> Option<Self> {
        let optimise = study.optimise.as_ref()?;
        let constraints = if sweep.constraints {
            &optimise.constraints[..]
        } else {
            &[]
        };
        let mechanism = &study.wheel().mechanism;
        let of_targets: Vec<Place> = targets.iter().map(|own| Place::of(&own.site)).collect();
        let of_constraints = constraints.iter();
        let of_constraints: Vec<Place> = of_constraints
            .map(|own| Place::of_constraint(own, mechanism))
            .collect();
        let mut places: Vec<Place> = Vec::new();
        for place in of_targets.iter().chain(&of_constraints) {
            if !places.contains(place) {
                places.push(place.clone());
            }
        }
        let group = |place: Place| {
            let at = |of: &[Place]| (0..of.len()).filter(|k| of[*k] == place).collect();
            let (own, limits): (Vec<usize>, Vec<usize>) = (at(&of_targets), at(&of_constraints));
            let goals = Optimise {
                targets: own.iter().map(|k| targets[*k].clone()).collect(),
                constraints: limits.iter().map(|k| constraints[*k].clone()).collect(),
                ..optimise.nominal()
            };
            Group {
                layout: TargetLayout::of(&goals, &study.vehicle),
                place,
                targets: own,
                constraints: limits,
            }
        };
        let mut columns = margin_columns(constraints, "");
        distinguish(&mut columns);
        (!places.is_empty()).then(|| Goals {
            groups: places.into_iter().map(group).collect(),
            rates: rates.map(|rate| rate_variable(*rate)).collect(),
            targets: targets.len(),
            columns,
        })
    }

    /// Makes the assessor of the designs. Each CPU thread has one assessor.
    pub(super) fn assessor<'a>(
        &'a self,
        study: &'a Study,
    ) -> Result<GoalAssessor<'a>, DesignFault> {
        let assessor = |group: &'a Group| {
            let assessor = DesignAssessor::new(&study.vehicle, &self.rates, &group.layout);
            assessor.map(|assessor| (group, assessor))
        };
        let groups: Result<_, _> = self.groups.iter().map(assessor).collect();
        Ok(GoalAssessor {
            goals: self,
            groups: groups?,
            offsets: Vec::new(),
            values: GoalValues::default(),
        })
    }
}

/// Assessor of the designs that one CPU thread solves.
pub(super) struct GoalAssessor<'a> {
    goals: &'a Goals,
    groups: Vec<(&'a Group, DesignAssessor<'a>)>,
    offsets: Vec<f64>,
    values: GoalValues,
}

impl GoalAssessor<'_> {
    /// Assesses a design, given by its points and by the rates that the sweep varies. All values are NaN if `design` is
    /// `None`. If the design does not reach all stations of a motion, the values of this motion are NaN, and the function
    /// returns the reason.
    pub(super) fn assess(
        &mut self,
        design: Option<&[Vector3<f64>]>,
        rates: &[f64],
    ) -> (&GoalValues, Option<Failing>) {
        let GoalAssessor {
            goals,
            groups,
            offsets,
            values,
        } = self;
        values.rms.clear();
        values.rms.resize(goals.targets, f64::NAN);
        values.margins.clear();
        values.margins.resize(goals.columns.len(), f64::NAN);
        let Some(design) = design else {
            return (values, None);
        };
        offsets.clear();
        let variables = goals.rates.iter().zip(rates);
        offsets.extend(variables.filter_map(|(own, rate)| Some(own.rate.as_ref()?.offset(*rate))));
        let mut failing = None;
        for (group, assessor) in groups {
            match assessor.assess(design, offsets) {
                Ok((deviations, margins)) => {
                    for (target, found) in group.targets.iter().zip(deviations) {
                        values.rms[*target] = found.rms;
                    }
                    for (constraint, found) in group.constraints.iter().zip(margins) {
                        values.margins[*constraint] = found.margin;
                    }
                }
                Err(_) if failing.is_none() => {
                    failing = Some(Failing::of_goals(group.place.name()));
                }
                Err(_) => {}
            }
        }
        (values, failing)
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

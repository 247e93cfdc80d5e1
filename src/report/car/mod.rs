//! Results of a car: files, tables, and the studies after a tuning.

mod comparison;
mod differing;
mod files;
mod limits;
mod record;
mod sensitivities;
mod studies;
mod tables;
mod tolerance;
mod tuning;
mod verdict;

pub use comparison::CarComparison;
pub use limits::{CarLimits, car_limits, lift_limits_table};
pub(super) use record::FORM as CAR_FORM;
pub use record::{
    CarCase, CarConstraintRecord, CarFact, CarMap, CarRecord, CarStateRecord, CarTargetRecord,
    CarTuningRecord, CarVariableRecord,
};
pub use studies::{car_with_axles, optimised_car, settings_of_car};
pub use tolerance::{CarToleranceSummary, car_study_bands_missed};
pub use tuning::{
    car_constraint_names, car_constraints_table, car_targets_json, car_targets_table,
    car_variables_table,
};
pub use verdict::CarVerdict;

use crate::car::{
    CarQuantity, CarSolver, Case, Equilibrium, NoEquilibrium, Solved, WheelPlace, WheelResult,
};
use crate::model::MassUnit;
use crate::report::{as_written, to_digits};
use crate::study::CarStudy;

/// State of a load case, or the reason why there is none.
pub enum CarState<'s> {
    /// The case has an equilibrium.
    Solved {
        /// Equilibrium of the case.
        found: Box<Equilibrium>,
        /// Equilibrium with its derivatives.
        solved: Box<Solved<'s, f64>>,
    },
    /// The case has no equilibrium.
    Failed(NoEquilibrium),
}

/// States of all load cases of a study.
pub struct CarResults<'s> {
    study: &'s CarStudy,
    /// States of the car in the order of the load cases.
    pub states: Vec<CarState<'s>>,
    /// Forces in the members for each case, in newtons. The list of a case is empty if they are unknown or not requested.
    members: Vec<Vec<f64>>,
}

/// Makes the state of a load case from its equilibrium `found`, with the derivatives.
fn state<'s>(
    solver: &mut CarSolver<'s>,
    case: &Case,
    found: Result<Equilibrium, NoEquilibrium>,
) -> CarState<'s> {
    let solved = found.and_then(|found| {
        let solved = Box::new(solver.solved(case, &found)?);
        let found = Box::new(found);
        Ok(CarState::Solved { found, solved })
    });
    solved.unwrap_or_else(CarState::Failed)
}

/// Names of lifted wheels, separated by spaces. Empty if no wheel is lifted.
fn lifted_wheels(lifted: &[bool; 4]) -> String {
    let names = WheelPlace::ALL.into_iter().filter(|place| lifted[place.0]);
    names.map(WheelPlace::name).collect::<Vec<_>>().join(" ")
}

impl<'s> CarResults<'s> {
    /// Solves the first `count` load cases, and the forces in their members if the study requests them.
    pub fn solve(study: &'s CarStudy, solver: &mut CarSolver<'s>, count: usize) -> Self {
        let cases = study.cases.iter().take(count);
        let mut members = Vec::new();
        let states = cases.map(|case| {
            let found = solver.solve(case);
            let state = state(solver, case, found);
            let forces = match &state {
                CarState::Solved { found, .. } if study.member_loads => {
                    solver.members(case, found).ok()
                }
                _ => None,
            };
            let forces = forces.into_iter().flatten();
            members.push(forces.flat_map(|wheel| wheel.forces).collect());
            state
        });
        CarResults {
            study,
            states: states.collect(),
            members,
        }
    }

    /// Remarks on the static position, lifted wheels, friction demands and masses without a unit. Further remarks name values that
    /// differ between the study of an axle and the study of the car.
    pub fn remarks(&self) -> Vec<String> {
        let study = self.study;
        let mut remarks = Vec::new();
        let limit = 0.01 * study.car.per_metre();
        if let Some(CarState::Solved { solved, .. }) = self.states.first() {
            let travels = &solved.now.unknowns[3..7];
            let far = travels.iter().fold(0.0_f64, |far, z| far.max(z.abs()));
            if far > limit {
                let (far, unit) = (as_written(to_digits(far, 3)), self.unit());
                remarks.push(format!(
                    "warning: the static position is {far} {unit} of travel from the design position: the spring forces do not \
                     fit the masses"
                ));
            }
        }
        remarks.extend(self.warnings());
        remarks.extend(mass_doubt(study));
        remarks.extend(self.differing_values());
        remarks
    }

    /// The study of the car.
    pub fn study(&self) -> &'s CarStudy {
        self.study
    }

    /// Symbol of the study's length unit.
    fn unit(&self) -> &'static str {
        self.study.car.length_unit.symbol()
    }

    /// Load cases that were not solved, with reasons.
    pub fn failures(&self) -> Vec<String> {
        let cases = self.study.cases.iter().zip(&self.states);
        cases
            .filter_map(|(case, state)| match state {
                CarState::Failed(why) => {
                    let reason = why.describe(&self.study.car);
                    Some(format!("case {}: {}: {reason}", case.name, why.status()))
                }
                CarState::Solved { .. } => None,
            })
            .collect()
    }

    /// True if every load case is solved.
    pub fn is_complete(&self) -> bool {
        self.failures().is_empty()
    }

    /// Warnings about solved load cases: lifted wheels, and friction demands above 2.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for (case, state) in self.study.cases.iter().zip(&self.states) {
            let CarState::Solved { found, solved } = state else {
                continue;
            };
            for place in WheelPlace::ALL {
                if found.lifted[place.0] {
                    warnings.push(format!(
                        "warning: case {}: {} lifts",
                        case.name,
                        place.words()
                    ));
                    continue;
                }
                let demand = CarQuantity::Wheel(place, WheelResult::FrictionDemand);
                let demand = demand.evaluate(solved);
                if demand > 2.0 {
                    warnings.push(format!(
                        "warning: case {}: {} needs a friction coefficient of {demand:.1}; no tyre reaches this value",
                        case.name,
                        place.words()
                    ));
                }
            }
        }
        warnings
    }
}

/// Warning about masses of the car without a unit, if an axle has masses in pounds.
fn mass_doubt(study: &CarStudy) -> Option<String> {
    let written: toml::Table = study.text.parse().ok()?;
    if written.get("car")?.get("mass_unit").is_some() {
        return None;
    }
    let [_, axles @ ..] = study.units();
    let mut named = crate::car::AXLE_NAMES.iter().zip(axles);
    let (end, units) = named.find(|(_, units)| units.mass != MassUnit::default())?;
    let (own, other) = (MassUnit::default().symbol(), units.mass.symbol());
    Some(format!(
        "please check: [car] has no mass_unit, so its masses are in {own}, but the {end} study has mass_unit = \"{other}\". Give \
         mass_unit in [car]"
    ))
}

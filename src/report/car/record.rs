//! `report.json` of a car: data for its page.

use super::{CarResults, CarState, lifted_wheels};
use crate::SideEffect;
use crate::car::{
    AxleEnd, AxleResult, CarQuantity, CarSolver, Case, Equilibrium, WheelPlace, WheelResult,
    WholeResult,
};
use crate::report::scene::Scene;
use crate::report::tuning_summary::{ConstraintStatus, StartSummary};
use crate::report::{misfit_in_words, split_unit};
use serde::{Deserialize, Serialize};

/// Version of the record's format. The program reads no records of other versions.
pub(in crate::report) const FORM: u32 = 1;

/// Data for the page of a car.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarRecord {
    /// Equal to `FORM`.
    pub form: u32,
    /// Version of the program.
    pub version: String,
    /// Command that made the run.
    pub command: String,
    /// Always `car`. This value distinguishes the record from records of suspensions.
    pub kind: String,
    /// Name of the study.
    pub study: String,
    /// Unit of all lengths.
    pub length_unit: String,
    /// Unit of all forces.
    #[serde(default = "newtons")]
    pub force_unit: String,
    /// True if the car has tyre springs.
    pub elastic_tyres: bool,
    /// Warnings and notes.
    pub remarks: Vec<String>,
    /// Key values in the static position.
    pub facts: Vec<CarFact>,
    /// Load cases, the static one first.
    pub cases: Vec<CarCase>,
    /// States over ax and ay (g-g map).
    pub map: Option<CarMap>,
    /// Targets of a tuning, with values before and after.
    pub targets: Vec<CarTargetRecord>,
    /// Misfit and variables of a tuning.
    #[serde(default)]
    pub tuning: Option<CarTuningRecord>,
    /// Changes by a tuning that no target requests.
    #[serde(default)]
    pub side_effects: Vec<SideEffect>,
    /// Fixed parts of the drawing of the front axle and of the rear axle.
    pub scenes: [Scene; 2],
    /// Names of the files of the run.
    pub files: Vec<String>,
}

/// Unit of forces for records of older versions, which do not state it.
fn newtons() -> String {
    "N".to_owned()
}

/// A key value of the car.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarFact {
    /// Name of the key value.
    pub name: String,
    /// Key value as a printed number, in `unit`.
    pub value: f64,
    /// Unit of the key value.
    pub unit: String,
}

/// A load case with its state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarCase {
    /// Name of the case.
    pub name: String,
    /// Forward acceleration, g.
    pub ax: f64,
    /// Acceleration to the left, g.
    pub ay: f64,
    /// Reason why the load case has no state. `None` if it has one.
    pub reason: Option<String>,
    /// State of the car, if there is one.
    pub state: Option<CarStateRecord>,
}

/// State of the car, as printed numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarStateRecord {
    /// Roll and pitch, degrees.
    pub attitude: [f64; 2],
    /// Loads of the wheels in the unit of forces: front left, front right, rear left, rear right.
    pub loads: [f64; 4],
    /// Camber of each wheel relative to the road, degrees.
    pub camber: [f64; 4],
    /// True for each lifted wheel.
    pub lifted: [bool; 4],
    /// Lateral load transfer of each axle in the unit of forces: elastic, geometric, longitudinal and unsprung part.
    pub transfer: [[f64; 4]; 2],
    /// Share of the front axle in the lateral load transfer, percent. `None` without lateral acceleration.
    pub front_share: Option<f64>,
    /// Height of the roll axis above the ground at each axle.
    pub roll_axis: [Option<f64>; 2],
    /// Height of the kinematic roll centre of each axle above the ground.
    pub roll_centre: [Option<f64>; 2],
    /// Points of both axles above the ground: forward, left, up.
    pub points: [Vec<[f64; 3]>; 2],
    /// Lowest point of each wheel.
    pub contacts: [[f64; 3]; 4],
    /// Wheel centres.
    pub centres: [[f64; 3]; 4],
    /// Centre of gravity of the sprung mass.
    pub sprung_cg: [f64; 3],
}

/// States of the car over forward acceleration ax and lateral acceleration ay. The lists have one entry per state; ay varies
/// fastest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarMap {
    /// Forward accelerations, g.
    pub ax: Vec<f64>,
    /// Accelerations to the left, g.
    pub ay: Vec<f64>,
    /// Largest friction demand among the wheels in each state. `None` without an equilibrium.
    pub friction: Vec<Option<f64>>,
    /// Number of lifted wheels in each state. 0 without an equilibrium.
    pub lifted: Vec<usize>,
}

/// A target with its values before and after the tuning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarTargetRecord {
    /// Name of the result, with unit.
    pub output: String,
    /// Name of the load case.
    pub case: String,
    /// Lowest and highest target value. `None` without a limit.
    pub wanted: [Option<f64>; 2],
    /// Tolerance of the target, in the unit of `output`.
    pub tolerance: f64,
    /// Values of the result before and after the tuning.
    pub values: [Option<f64>; 2],
    /// Deviation after the tuning, as a multiple of the tolerance. For a target of a single axle: largest deviation.
    pub deviation: Option<f64>,
    /// For a target of a single axle: lowest and highest value of its curve or band. `wanted` and `values` are then root mean
    /// square deviations from this curve or band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<[Option<f64>; 2]>,
}

/// Misfit and variables of a tuning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarTuningRecord {
    /// Misfit before and after, as a multiple of the tolerances. `None` if the car cannot be compared.
    pub misfits: [Option<f64>; 2],
    /// Reason why the search ended.
    pub ended: String,
    /// Variables with their values.
    pub variables: Vec<CarVariableRecord>,
    /// Constraints with their margins.
    #[serde(default)]
    pub constraints: Vec<CarConstraintRecord>,
    /// Starts (points at which the search begins), each with its result.
    #[serde(default)]
    pub starts: Vec<StartSummary>,
    /// Index of the start whose result the tuning keeps.
    #[serde(default)]
    pub best_start: Option<usize>,
}

/// A variable of a tuning: offset of hardpoints, or a value of the car.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarVariableRecord {
    /// Name of the variable.
    pub name: String,
    /// Value before the tuning; 0 for an offset. `None` if the car has no such value.
    pub before: Option<f64>,
    /// Value after the tuning.
    pub after: f64,
    /// Lowest and highest allowed value of the variable.
    pub range: [f64; 2],
    /// `lower` or `upper`, if the variable ended at that end of its range.
    #[serde(default)]
    pub at_bound: Option<String>,
}

impl CarTuningRecord {
    /// Misfits before and after in words: `3.10 -> 0.40`. Without a misfit before: only the misfit after.
    pub fn misfits_in_words(&self) -> String {
        let [before, after] = self.misfits.map(|misfit| misfit.map(misfit_in_words));
        let after = after.unwrap_or_else(|| "unknown".to_owned());
        before.map_or_else(|| after.clone(), |before| format!("{before} -> {after}"))
    }
}

/// A constraint of a tuning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarConstraintRecord {
    /// Name of the constraint.
    pub name: String,
    /// Load case, or `front axle alone` or `rear axle alone`.
    pub place: String,
    /// Lowest and highest allowed value. `None` without a limit, and for constraints with several different limits.
    pub limits: [Option<f64>; 2],
    /// Unit of limits and margins.
    pub unit: String,
    /// Margins to the nearer limit before and after the tuning. Negative if the constraint is violated.
    pub margins: [Option<f64>; 2],
    /// True for a constraint of an axle alone. Then `name` includes the limits.
    #[serde(default)]
    pub is_of_axle: bool,
    /// Status of the constraint after the tuning. `None` in some records of older versions.
    #[serde(default)]
    pub status: Option<ConstraintStatus>,
    /// Decrease of the misfit if the limit moves outward by one unit. The misfit is a multiple of the tolerances.
    #[serde(default)]
    pub price: Option<f64>,
    /// True if the decrease in `price` is not determined, because binding limits depend on each other.
    #[serde(default)]
    pub price_not_determined: bool,
}

impl<'s> CarResults<'s> {
    /// Makes the record of a car's run from its results.
    pub fn record(
        &self,
        command: &str,
        solver: &mut CarSolver<'s>,
        map: Option<CarMap>,
        remarks: &[String],
    ) -> CarRecord {
        let study = self.study;
        let cases = study.cases.iter().zip(&self.states);
        let cases = cases.map(|(case, state)| {
            let (reason, state) = match state {
                CarState::Failed(why) => (Some(why.describe(&study.car)), None),
                CarState::Solved { found, .. } => {
                    (None, self.state_record(case, found, state, solver))
                }
            };
            CarCase {
                name: case.name.clone(),
                ax: case.ax,
                ay: case.ay,
                reason,
                state,
            }
        });
        CarRecord {
            form: FORM,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: command.to_owned(),
            kind: "car".to_owned(),
            study: study.name.clone(),
            length_unit: self.unit().to_owned(),
            force_unit: study.car.length_unit.force_symbol().to_owned(),
            elastic_tyres: study.car.tyres.is_some(),
            remarks: remarks.to_vec(),
            facts: self.facts(),
            cases: cases.collect(),
            map,
            targets: Vec::new(),
            tuning: None,
            side_effects: Vec::new(),
            scenes: study.car.axles.each_ref().map(Scene::of_axle),
            files: Vec::new(),
        }
    }

    /// Key values in the static position. Empty if it has no equilibrium.
    fn facts(&self) -> Vec<CarFact> {
        let (Some(CarState::Solved { solved, .. }), Some(case)) =
            (self.states.first(), self.study.cases.first())
        else {
            return Vec::new();
        };
        let shown = [
            WholeResult::RollGradient,
            WholeResult::LocalDistribution,
            WholeResult::PitchGradient,
            WholeResult::WeightFront,
            WholeResult::CrossWeight,
            WholeResult::RollUndersteer,
        ];
        let length = self.study.car.length_unit;
        let fact = |result: WholeResult| {
            let quantity = CarQuantity::Whole(result);
            Some(CarFact {
                name: quantity.name(),
                value: quantity.printed(solved, case)?,
                unit: quantity.info().unit.suffix(length),
            })
        };
        shown.into_iter().filter_map(fact).collect()
    }

    /// Record of a solved state. `None` if the mechanism cannot be drawn.
    fn state_record(
        &self,
        case: &Case,
        found: &Equilibrium,
        state: &CarState<'_>,
        solver: &mut CarSolver<'s>,
    ) -> Option<CarStateRecord> {
        let CarState::Solved { solved, .. } = state else {
            return None;
        };
        let value = |quantity: CarQuantity| quantity.printed(solved, case);
        let plain = |quantity| value(quantity).unwrap_or(0.0);
        let wheels = |result| WheelPlace::ALL.map(|place| plain(CarQuantity::Wheel(place, result)));
        let parts = [
            AxleResult::Elastic,
            AxleResult::Geometric,
            AxleResult::Longitudinal,
            AxleResult::Unsprung,
        ];
        let axles = |result| AxleEnd::ALL.map(|end| value(CarQuantity::Axle(end, result)));
        let drawing = solver.drawing(case, found).ok()?;
        Some(CarStateRecord {
            attitude: [WholeResult::Roll, WholeResult::Pitch]
                .map(|result| plain(CarQuantity::Whole(result))),
            loads: wheels(WheelResult::Load),
            camber: wheels(WheelResult::CamberToRoad),
            lifted: found.lifted,
            transfer: AxleEnd::ALL.map(|end| parts.map(|part| plain(CarQuantity::Axle(end, part)))),
            front_share: value(CarQuantity::Whole(WholeResult::Distribution)),
            roll_axis: axles(AxleResult::RollAxisHeight),
            roll_centre: axles(AxleResult::RollCentreHeight),
            points: drawing.points,
            contacts: drawing.contacts,
            centres: drawing.centres,
            sprung_cg: drawing.sprung_cg,
        })
    }
}

impl CarMap {
    /// Makes a g-g map without states over these forward accelerations `ax` and lateral accelerations `ay`.
    pub(super) fn of(ax: &[f64], ay: &[f64]) -> Self {
        CarMap {
            ax: ax.to_vec(),
            ay: ay.to_vec(),
            friction: Vec::with_capacity(ax.len() * ay.len()),
            lifted: Vec::with_capacity(ax.len() * ay.len()),
        }
    }

    /// Adds the rows of another g-g map with the same values of ay.
    pub(super) fn append(&mut self, other: CarMap) {
        self.ax.extend(other.ax);
        self.friction.extend(other.friction);
        self.lifted.extend(other.lifted);
    }

    /// Adds the next state of the g-g map.
    pub(super) fn push(&mut self, state: &CarState<'_>, case: &Case) {
        let (friction, lifted) = match state {
            CarState::Failed(_) => (None, 0),
            CarState::Solved { found, solved } => {
                let demand = |place| {
                    let quantity = CarQuantity::Wheel(place, WheelResult::FrictionDemand);
                    quantity.printed(solved, case)
                };
                let demands = WheelPlace::ALL.into_iter().filter_map(demand);
                let lifted = found.lifted.iter().filter(|lifted| **lifted);
                (Some(demands.fold(0.0, f64::max)), lifted.count())
            }
        };
        self.friction.push(friction);
        self.lifted.push(lifted);
    }
}

impl CarStateRecord {
    /// Names of lifted wheels, separated by spaces.
    pub fn lifted_in_words(&self) -> String {
        lifted_wheels(&self.lifted)
    }
}

impl CarTargetRecord {
    /// Name of the target: its result with the load case, or with the axle for a target of a single axle.
    pub fn full_name(&self) -> String {
        match self.curve {
            Some(_) => format!("{}, {}", self.output, self.case),
            None => format!("{} in {}", self.output, self.case),
        }
    }

    /// Size of the deviation from the target in words, as a multiple of the tolerance. `None` if the target is met, or if its value
    /// is unknown.
    pub fn missed_by(&self) -> Option<String> {
        let deviation = self.deviation.filter(|_| !self.is_met())?.abs();
        let up_to = self.curve.map_or("", |_| "up to ");
        Some(format!("{up_to}{} tolerances", misfit_in_words(deviation)))
    }

    /// True if the deviation is within the tolerance.
    pub fn is_met(&self) -> bool {
        self.deviation
            .is_some_and(|deviation| deviation.abs() <= 1.0)
    }

    /// Unit at the end of the result's name. Empty for a plain number.
    pub fn unit(&self) -> &str {
        split_unit(&self.output).1
    }
}

#[cfg(test)]
mod tests {
    use super::CarTargetRecord;

    /// The unit of a rate is the whole unit, not its last part.
    #[test]
    fn units_come_from_the_end_of_names() {
        for (output, unit) in [
            ("roll_deg", "deg"),
            ("roll_gradient_deg_per_g", "deg_per_g"),
            ("bump_steer_rms_deviation_deg_per_mm", "deg_per_mm"),
            ("axle_ride_rate_front_N_per_mm", "N_per_mm"),
            ("front_left_friction_demand", ""),
        ] {
            let target = CarTargetRecord {
                output: output.to_owned(),
                case: String::new(),
                wanted: [None; 2],
                tolerance: 1.0,
                values: [None; 2],
                deviation: None,
                curve: None,
            };
            assert_eq!(target.unit(), unit);
        }
    }
}

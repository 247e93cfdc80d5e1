//! Side effects of a tuned car: results of its load cases, and curves of each axle alone.
//!
//! All load cases together are treated as the stations of one motion, with accelerations, speed and steering as coordinates.
//! So, by equation (2) of the module [`side_effects`](super), a change that a target requests in one load case is subtracted
//! from the change in the other cases. An axle that the tuning has changed is also compared over the motions of its own
//! study.

use super::comparison::{RequestedChanges, compare};
use super::observed::{Grid, Observed, Series, Station};
use super::{SideEffect, by_severity, over_all_motions};
use crate::car::{AxleEnd, CarQuantity, CarSolver, Case, WholeResult};
use crate::model::Side;
use crate::number::Each;
use crate::study::{AxleStudy, CarOptimise, CarStudy, Study, Vehicle};

/// Names of the results that are compared in addition to the results of the study.
const COMPARED: [&str; 11] = [
    "roll",
    "pitch",
    "ride_height",
    "camber_to_road",
    "toe",
    "lateral_load_transfer_distribution",
    "roll_gradient",
    "force_roll_centre_height",
    "anti_dive_by_force",
    "anti_squat_by_force",
    "roll_understeer",
];

/// Compares a car before and after a tuning, in its load cases and in the motions of the axles that changed. The order is
/// the same as in [`side_effects`](super::side_effects). Outputs of a single axle name the axle (`camber, front axle`). The list is
/// empty without `[optimise]`, or if `[optimise]` has `side_effects = false`.
///
/// # Errors
/// Returns the reason, in words, if the design before or after the tuning cannot be solved at all. A load case without an
/// equilibrium is not an error: its results count as lost.
pub fn side_effects_of_car(before: &CarStudy, after: &CarStudy) -> Result<Vec<SideEffect>, String> {
    let asked = before.optimise.as_ref();
    let Some(optimise) = asked.filter(|optimise| optimise.side_effects) else {
        return Ok(Vec::new());
    };
    let compared = quantities(before);
    let [from, to] = [before, after].map(|study| observe(study, &compared, optimise));
    let mut found = compare(&from?, &to?, &RequestedChanges::default());
    for end in AxleEnd::ALL {
        let axles = [before, after].each(|study| &study.car.axles[end as usize]);
        if axles[0] == axles[1] {
            continue;
        }
        let own = [before, after].map(|study| axle_by_itself(study, end, optimise));
        let effects = over_all_motions(&own[0], &own[1]);
        let of_axle = |fault| {
            let fault = (end as usize, Side::Left, fault);
            before.car.describe_fault(&fault)
        };
        found.extend(effects.map_err(of_axle)?.into_iter().map(|effect| {
            let output = match effect.output.split_once(", ") {
                Some((output, motion)) => format!("{output}, {} axle, {motion}", end.name()),
                None => format!("{}, {} axle", effect.output, end.name()),
            };
            SideEffect { output, ..effect }
        }));
    }
    by_severity(&mut found);
    Ok(found)
}

/// Compared results: the results of the study, and the customary results that the car has.
fn quantities(study: &CarStudy) -> Vec<CarQuantity> {
    let mut found = study.quantities.clone();
    for quantity in COMPARED.into_iter().flat_map(CarQuantity::named) {
        if quantity.is_met_by(&study.car) && !found.contains(&quantity) {
            found.push(quantity);
        }
    }
    found
}

/// Returns the result whose slope over the accelerations is the given result. If a target requests a change of the slope,
/// this result also changes.
fn integral_of(slope: CarQuantity) -> Option<CarQuantity> {
    (slope == CarQuantity::Whole(WholeResult::RollGradient))
        .then_some(CarQuantity::Whole(WholeResult::Roll))
}

/// Values of a car in its load cases.
fn observe(
    study: &CarStudy,
    quantities: &[CarQuantity],
    optimise: &CarOptimise,
) -> Result<Observed, String> {
    let solver = CarSolver::new(&study.car);
    let mut solver = solver.map_err(|fault| study.car.describe_fault(&fault))?;
    let mut solve = |case: &Case| {
        let found = solver.solve(case).ok()?;
        solver.solved(case, &found).ok()
    };
    let solved: Vec<_> = study.cases.iter().map(&mut solve).collect();
    let stations = stations(&study.cases);
    let length = study.car.length_unit;
    let series = quantities.iter().map(|quantity| {
        let info = quantity.info();
        let (name, wheel) = match quantity {
            CarQuantity::Wheel(place, _) => (info.name.to_owned(), Some(place.name())),
            CarQuantity::Axle(..) | CarQuantity::Whole(_) => (quantity.name(), None),
        };
        let targets = optimise.targets.iter().map(|own| (own.quantity, own.case));
        let limits = optimise.constraints.iter();
        let wanted = targets.chain(limits.map(|own| (own.quantity, own.case)));
        let counts = |of: CarQuantity| of == *quantity || integral_of(of) == Some(*quantity);
        let values = study.cases.iter().zip(&solved);
        Series {
            wheel,
            wanted: wanted
                .filter_map(|(of, case)| counts(of).then_some(case))
                .collect(),
            values: values
                .map(|(case, solved)| quantity.printed(solved.as_ref()?, case))
                .collect(),
            ..Series::new(&name, info.unit, length, &stations)
        }
    });
    Ok(Observed {
        motion: None,
        series: series.collect(),
        stations,
    })
}

/// The load cases as stations.
fn stations(cases: &[Case]) -> Vec<Station> {
    let place = |case: &Case| vec![case.ay, case.ax, case.az, case.speed, case.racks[0]];
    let places: Vec<Vec<f64>> = cases.iter().map(place).collect();
    let grid = Grid::of(&places);
    let stations = cases.iter().zip(&places);
    let station = |(case, place): (&Case, &Vec<f64>)| Station {
        position: grid.shares(place),
        place: Vec::new(),
        case: Some(case.name.clone()),
        is_straight: case.racks == [0.0; 2],
    };
    stations.map(station).collect()
}

/// Study of one axle, with the axle's design in the car. It has the car's targets and constraints that concern only this axle.
fn axle_by_itself(study: &CarStudy, end: AxleEnd, optimise: &CarOptimise) -> Study {
    let end = end as usize;
    let own = &study.axles[end];
    let vehicle = match &own.vehicle {
        Vehicle::Axle(both) => Vehicle::Axle(Box::new(AxleStudy {
            axle: study.car.axles[end].clone(),
            ..AxleStudy::clone(both)
        })),
        Vehicle::Wheel(_) => unreachable!("each axle of a car has a study of an axle"),
    };
    Study {
        vehicle,
        optimise: Some(optimise.of_axle(end)),
        ..own.clone()
    }
}

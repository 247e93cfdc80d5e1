//! Answers a dragged point of a car: solves all load cases.

use super::misfit::{assessed_rigs, by_coordinates, misfit};
use super::{OpenedCar, solver};
use crate::car::{AXLE_NAMES, CarDrawing, CarQuantity, CarSolver};
use crate::number::Vector3;
use crate::report::{CarResults, CarState, FailureRange, plausibility, readable_unit};
use crate::studio::beside::beside;
use crate::studio::message::{
    ColumnValues, Drawn, InfluenceAnswer, InfluenceColumn, InfluenceRequest, SidePlacement,
    SolveRequest, SolvedAnswer,
};
use crate::studio::turns::Stop;
use crate::study::CarStudy;
use std::time::Instant;

/// Results of a car with these names. A name can denote several results, such as a result of all four wheels. Returns an error
/// if the car does not have one of them.
fn quantities(study: &CarStudy, names: &[String]) -> Result<Vec<CarQuantity>, String> {
    let mut found: Vec<CarQuantity> = Vec::new();
    for name in names {
        let named = CarQuantity::named(name).into_iter();
        let own: Vec<CarQuantity> = named.filter(|q| q.is_met_by(&study.car)).collect();
        if own.is_empty() {
            return Err(format!("this study has no {name}"));
        }
        let new: Vec<CarQuantity> = own.into_iter().filter(|q| !found.contains(q)).collect();
        found.extend(new);
    }
    Ok(found)
}

/// Answers with the results of all load cases, after a point was dragged. An error names the fault of the design or the request.
pub(super) fn solved(
    opened: &OpenedCar,
    request: &SolveRequest,
    stop: &Stop,
) -> Result<SolvedAnswer, String> {
    let start = Instant::now();
    let study = opened.moved(&request.of.design)?;
    let shown = shown_case(&study, &request.at)?;
    let quantities = quantities(&study, &request.characteristics)?;
    let mut solver = solver(&study)?;
    let all = study.cases.len();
    let rigs = || (assessed_rigs(opened, &study), doubts(&study));
    let ((rigs, doubts), results) =
        beside(stop, rigs, || CarResults::solve(&study, &mut solver, all))?;
    let columns = quantities
        .iter()
        .map(|quantity| column(*quantity, &results));
    let columns = columns.collect();
    let [left, right] = drawn(&study, shown, &mut solver, &results.states[shown]);
    let is_moved = (0..2).any(|end| {
        let [own, was] = [&study, &opened.study].map(|study| &study.axles[end].wheel().design);
        own != was
    });
    let was = if is_moved {
        as_opened(opened, shown)
    } else {
        None
    };
    let failures = results.states.iter().enumerate();
    let failures = failures.filter_map(|(case, state)| match state {
        CarState::Solved { .. } => None,
        CarState::Failed(why) => Some(FailureRange {
            first: case,
            last: case,
            status: why.status().to_owned(),
            reason: why.describe(&study.car),
            place: format!("case {}", study.cases[case].name),
        }),
    });
    let status = |state: &CarState<'_>| match state {
        CarState::Solved { .. } => "ok",
        CarState::Failed(why) => why.status(),
    };
    Ok(SolvedAnswer {
        columns,
        drive: (0..study.cases.len())
            .map(|case| Some(case as f64))
            .collect(),
        groups: vec![0; study.cases.len()],
        group_places: vec![vec![0.0]],
        shown: 0,
        rack: 0.0,
        has_rows: false,
        is_partial: false,
        status: results.states.iter().map(status).collect(),
        failures: failures.collect(),
        frame: left,
        right,
        opened: was,
        misfit: misfit(&study, &mut solver, &results, rigs),
        remarks: [results.remarks(), doubts?].concat(),
        milliseconds: start.elapsed().as_secs_f64() * 1e3,
    })
}

/// Warnings about the points of each axle.
fn doubts(study: &CarStudy) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    for (end, axle) in AXLE_NAMES.iter().zip(&study.axles) {
        let wheel = axle.wheel();
        let own = plausibility(wheel).map_err(|fault| fault.describe(&wheel.mechanism))?;
        found.extend(own.into_iter().map(|doubt| format!("{end} axle: {doubt}")));
    }
    Ok(found)
}

/// Index of the load case that the drawing shows: the position of the only slider. Returns an error if there is no such case.
fn shown_case(study: &CarStudy, at: &[f64]) -> Result<usize, String> {
    let found = match at {
        &[place] if place >= 0.0 => Some(place as usize),
        _ => None,
    };
    let found = found.filter(|case| *case < study.cases.len());
    found.ok_or_else(|| format!("expected the number of one of {} cases", study.cases.len()))
}

/// Column of a result for the page, with one value for each load case. `None` in a case without equilibrium.
fn column(quantity: CarQuantity, results: &CarResults<'_>) -> ColumnValues {
    let length = results.study().car.length_unit;
    let cases = results.study().cases.iter().zip(&results.states);
    ColumnValues {
        column: quantity.column(length),
        title: quantity.name().replace('_', " "),
        unit: readable_unit(&quantity.info().unit.suffix(length)),
        positive: Some(quantity.info().positive.to_owned()),
        values: cases
            .map(|(case, state)| match state {
                CarState::Solved { solved, .. } => {
                    quantity.printed(solved, case).map(|value| value + 0.0)
                }
                CarState::Failed(_) => None,
            })
            .collect(),
    }
}

/// Drawings of the left and right side of a car in a load case. Without an equilibrium, the first one has the reason, and the
/// second one is `None`.
fn drawn<'s>(
    study: &CarStudy,
    shown: usize,
    solver: &mut CarSolver<'s>,
    state: &CarState<'s>,
) -> [Option<Drawn>; 2] {
    let case = &study.cases[shown];
    let drawing = match state {
        CarState::Solved { found, .. } => solver.drawing(case, found),
        CarState::Failed(why) => Err(why.clone()),
    };
    match drawing {
        Ok(drawing) => {
            let sides = [0, 1].map(|side| placement(study, &drawing, side));
            sides.map(|own| {
                Some(Drawn::Side {
                    pose: Ok(Box::new(own)),
                })
            })
        }
        Err(why) => {
            let reason = why.describe(&study.car);
            let pose = Err(format!("case {}: {reason}", case.name));
            [Some(Drawn::Side { pose }), None]
        }
    }
}

/// Drawing of the left side of the car in a load case, with the design of the opened texts. `None` if there is no equilibrium.
fn as_opened(opened: &OpenedCar, shown: usize) -> Option<Drawn> {
    let study = &opened.study;
    let drawn = opened.drawn[shown].get_or_init(|| {
        let mut solver = solver(study).ok()?;
        let case = &study.cases[shown];
        let found = solver.solve(case).ok()?;
        let drawing = solver.drawing(case, &found).ok()?;
        Some(placement(study, &drawing, 0))
    });
    let pose = Ok(Box::new(drawn.clone()?));
    Some(Drawn::Side { pose })
}

/// One side (0 left, 1 right) of the drawing of a car, in the axes of the front study.
fn placement(study: &CarStudy, drawing: &CarDrawing, side: usize) -> SidePlacement {
    let frame = study.frame();
    let turned = |v: [f64; 3]| frame.vector(Vector3::from(v)).to_array().map(|c| c + 0.0);
    let points = drawing.points.iter().flat_map(|own| {
        let half = own.len() / 2;
        own[side * half..][..half]
            .iter()
            .map(|point| turned(*point))
    });
    let wheels = |places: &[[f64; 3]; 4]| [0, 1].map(|axle| turned(places[2 * axle + side]));
    // Both the rows and the columns of this matrix refer to the axes of the study.
    let signs = turned([1.0; 3]);
    SidePlacement {
        points: points.collect(),
        spin_axes: wheels(&drawing.spin_axes),
        contacts: wheels(&drawing.contacts),
        sprung_cg: turned(drawing.sprung_cg),
        axes: std::array::from_fn(|row| turned(drawing.axes[row]).map(|c| signs[row] * c)),
    }
}

/// Derivatives of every requested result with respect to one coordinate of a point, for each load case. Unit: unit of the result
/// per length unit.
pub(super) fn influence(
    opened: &OpenedCar,
    request: &InfluenceRequest,
) -> Result<InfluenceAnswer, String> {
    let study = opened.moved(&request.of.design)?;
    if request.axis > 2 {
        return Err("expected an axis 0, 1 or 2".to_owned());
    }
    if request.point >= request.of.design.len() {
        return Err("there is no such point".to_owned());
    }
    let quantities = quantities(&study, &request.characteristics)?;
    let length = study.car.length_unit;
    let mut solver = solver(&study)?;
    let mut columns: Vec<InfluenceColumn> = quantities
        .iter()
        .map(|quantity| InfluenceColumn {
            column: quantity.column(length),
            slopes: vec![None; study.cases.len()],
        })
        .collect();
    for (number, case) in study.cases.iter().enumerate() {
        let defined = |k: &usize| quantities[*k].undefined_in(case).is_none();
        let own: Vec<usize> = (0..quantities.len()).filter(defined).collect();
        let asked: Vec<CarQuantity> = own.iter().map(|k| quantities[*k]).collect();
        let found = solver.solve(case);
        let Ok(gradients) = found.and_then(|found| solver.gradients(case, &found, &asked)) else {
            continue;
        };
        for (k, gradient) in own.into_iter().zip(&gradients) {
            let factor = quantities[k].info().unit.printed_factor(length);
            let slope = factor * by_coordinates(&study, gradient)[request.point][request.axis];
            columns[k].slopes[number] = slope.is_finite().then_some(slope);
        }
    }
    Ok(InfluenceAnswer { columns })
}

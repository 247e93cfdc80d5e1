//! An axle on the live page: its sliders, its curves, and the positions of its wheels.
//!
//! The page moves points of the left wheel. If the right wheel has its own hardpoints, these move as mirror images of the left
//! points, as with a variable of a tuning.

use super::answer::{MOST_STATIONS, columns, stations_left_out};
use super::beside::beside;
use super::groups::{Groups, nearest};
use super::message::{
    CharacteristicOverview, InfluenceAnswer, InfluenceColumn, InfluenceRequest, Slider,
    SolveRequest, SolvedAnswer,
};
use super::overview::rack_slider;
use super::study_file::Opened;
use super::turns::Stop;
use crate::ask::with_unit;
use crate::axle::{
    Axle, AxleMotion, AxlePlan, Combine, Coordinate, Placement, Quantity, WheelMotion, axle_curves,
    axle_sides, not_in_equilibrium,
};
use crate::curves::Frame;
use crate::mechanism::DesignFault;
use crate::model::{Axis, LengthUnit, PointId};
use crate::report::{FailureRange, axle_plausibility, plausibility};
use crate::study::{AxleStudy, Study};
use std::collections::HashSet;
use std::time::Instant;

/// Coordinates of an axle's motion, such as heave, roll and rack. A coordinate for which the motion has no values stays at 0.
fn coordinates(motion: &AxleMotion) -> Vec<Coordinate> {
    let mut found = match motion.wheels {
        WheelMotion::Heave(_) => vec![Coordinate::Heave],
        WheelMotion::Roll { .. } => vec![Coordinate::Roll, Coordinate::Heave],
        WheelMotion::Travels { .. } => vec![Coordinate::TravelLeft, Coordinate::TravelRight],
    };
    found.push(Coordinate::Rack);
    found
}

/// Coordinate for the horizontal axis of curves: the first coordinate that changes over the motion.
fn main(motion: &AxleMotion) -> Coordinate {
    let all = coordinates(motion);
    let main = match motion.moving()[0] {
        Coordinate::SteeringWheel => Coordinate::Rack,
        other => other,
    };
    *all.iter().find(|c| **c == main).unwrap_or(&all[0])
}

/// Values of a coordinate over a motion, in printed units and in the order of the motion, each value only once.
fn values(motion: &AxleMotion, coordinate: Coordinate, axle: &Axle) -> Vec<f64> {
    let mut motion = motion.clone();
    let values = motion.along(coordinate).into_iter().flatten();
    let values = values.map(|value| printed(coordinate, *value, axle));
    // Several stations of a motion may have the same value.
    let mut known = HashSet::new();
    values
        .filter(|value| known.insert(value.to_bits()))
        .collect()
}

fn printed(coordinate: Coordinate, value: f64, axle: &Axle) -> f64 {
    coordinate.written(value, axle) + 0.0
}

/// Index of the slider of a coordinate, if the motion has one.
pub(super) fn slider_of(motion: &AxleMotion, coordinate: Coordinate) -> Option<usize> {
    coordinates(motion).iter().position(|c| *c == coordinate)
}

/// Sliders for all coordinates of an axle's motion, and the index of one slider. The coordinate of this slider is initially on the
/// horizontal axis of the curves.
pub(super) fn sliders(both: &AxleStudy) -> (Vec<Slider>, usize) {
    let (motion, axle) = (&both.plan.motion, &both.axle);
    let left = &axle.left;
    let all = coordinates(motion);
    let length = left.length_unit;
    let far = 0.05 * length.per_metre();
    let slider = |coordinate: &Coordinate| {
        let values = values(motion, *coordinate, axle);
        let mut slider = match coordinate {
            Coordinate::Rack => return rack_slider(left, 0.0, &values),
            Coordinate::Roll => Slider::over("roll", "roll", "°", 0.0, &values),
            other => {
                let name = match other {
                    Coordinate::Heave => "heave",
                    Coordinate::TravelLeft => "left travel",
                    _ => "right travel",
                };
                Slider::over(other.key(), name, length.symbol(), 0.0, &values)
            }
        };
        // A coordinate that the study keeps constant also gets a slider, so that the user can try it.
        if values.len() < 2 {
            let is_roll = *coordinate == Coordinate::Roll;
            let reach = if is_roll { 3.0 } else { far };
            (slider.low, slider.high) = (slider.low.min(-reach), slider.high.max(reach));
        }
        slider
    };
    let number = slider_of(motion, main(motion)).unwrap_or(0);
    (all.iter().map(slider).collect(), number)
}

/// Name of a quantity's column in the curves, with its unit at the end.
pub(super) fn column(quantity: Quantity, length: LengthUnit) -> String {
    with_unit(quantity.name(), &quantity.info().unit.suffix(length))
}

/// Quantities that the study of an axle can request. A name that denotes quantities of both wheels has one entry.
pub(super) fn catalogue(study: &Study, both: &AxleStudy) -> Vec<CharacteristicOverview> {
    let axle = &both.axle;
    let targets = study.optimise.as_ref().map_or(&[][..], |o| &o.targets);
    let asked = both.plan_with(targets).quantities;
    let overview = |name: String| {
        let quantities = axle.quantities(&name);
        let first = *quantities.first()?;
        Some(CharacteristicOverview {
            name,
            unit: first.info().unit.suffix(axle.left.length_unit),
            positive: first.info().positive,
            asked: quantities.iter().any(|q| asked.contains(q)),
            available: axle.has(first),
        })
    };
    axle.quantity_names()
        .into_iter()
        .filter_map(overview)
        .collect()
}

/// Plan that computes the quantities with these names, with the rack held at `curves_rack` (study axes and unit) if it is given.
/// Also returns the number of stations of the motion. The plan has at most [`MOST_STATIONS`] of these stations, unless the
/// motion runs over time.
fn plan_of(
    plan: &AxlePlan,
    axle: &Axle,
    names: &[String],
    curves_rack: Option<f64>,
) -> Result<(AxlePlan, usize), String> {
    let mut plan = asking_for(plan, axle, names)?;
    if let Some(rack) = curves_rack {
        hold_rack(&mut plan.motion, rack * axle.left.frame.sign(Axis::Y));
    }
    let all = plan.motion.stations();
    plan.motion = plan.motion.thinned(MOST_STATIONS);
    Ok((plan, all))
}

/// Plan that computes the quantities with these names. Returns an error if the study does not have one of them.
fn asking_for(plan: &AxlePlan, axle: &Axle, names: &[String]) -> Result<AxlePlan, String> {
    let mut quantities: Vec<Quantity> = Vec::new();
    for name in names {
        let named = axle.quantities(name);
        if named.is_empty() || !named.iter().all(|q| axle.has(*q)) {
            return Err(format!("this study has no {name}"));
        }
        let new = named.into_iter().filter(|q| !quantities.contains(q));
        quantities.extend(new.collect::<Vec<_>>());
    }
    let has_derivative = |q: &Quantity| {
        axle.elastic.is_none() || not_in_equilibrium(*q, axle.kind(), true).is_none()
    };
    // The page may request any quantity. Some quantities have no second derivatives, and some have no derivatives at all in
    // equilibrium.
    let derivatives = if quantities.iter().all(has_derivative) {
        plan.derivatives.min(1)
    } else {
        0
    };
    Ok(AxlePlan {
        quantities,
        derivatives,
        ..plan.quantities_alone()
    })
}

/// Holds the rack of a motion at a displacement in the internal frame (x forward, y left, z up). In a motion that is given as a
/// table, every row gets this displacement.
fn hold_rack(motion: &mut AxleMotion, rack: f64) {
    let racks = if motion.has_rows() {
        motion.stations()
    } else {
        1
    };
    motion.racks = vec![rack; racks];
    motion.steering_wheel = None;
}

/// Values of all slider coordinates in printed units, at each station of a motion.
fn places(motion: &AxleMotion, axle: &Axle) -> Vec<Vec<f64>> {
    let all = coordinates(motion);
    let place = |placement: &Placement| {
        let values = all.iter();
        values
            .map(|c| printed(*c, placement.along(*c), axle))
            .collect()
    };
    motion.placements().iter().map(place).collect()
}

/// Answers with the curves of an axle, after a point was dragged. An error names the fault of the design or the request.
pub(super) fn solved(
    opened: &Opened,
    study: &Study,
    AxleStudy { axle, plan, .. }: &AxleStudy,
    (request, stop): (&SolveRequest, &Stop),
) -> Result<SolvedAnswer, String> {
    let start = Instant::now();
    let left = &axle.left;
    let (mut plan, stations) = plan_of(plan, axle, &request.characteristics, request.curves_rack)?;
    let all = coordinates(&plan.motion);
    if request.at.len() != all.len() || request.over >= all.len() {
        return Err(format!(
            "expected a value for each of {} sliders, and the number of one of them",
            all.len()
        ));
    }
    let whole = plan.motion.clone();
    if request.shown_only {
        plan.motion = shown_alone(&whole, (request.over, &request.at), axle);
    }
    let fault = |fault: DesignFault| fault.describe(&left.mechanism);
    let misfit = || super::misfit::misfit(opened, study).map_err(fault);
    let curves = || axle_curves(axle, &plan).map_err(|fault| axle.describe_fault(fault));
    let (misfit, found) = beside(stop, misfit, curves)?;
    let (misfit, found) = (misfit?, found?);
    let over = request.over;
    let drive = places(&plan.motion, axle).into_iter();
    let drive: Vec<Option<f64>> = drive.map(|place| Some(place[over])).collect();
    let is_partial = drive.len() < whole.stations();
    let groups = grouped(&whole, axle, request);
    let groups = if is_partial {
        groups.with_shown_only(drive.len())
    } else {
        groups
    };
    let mut lines = plausibility(left).map_err(fault)?;
    lines.extend(axle_plausibility(axle, &plan, &found, false));
    lines.extend(stations_left_out(whole.stations(), stations));
    let frames = |axle: &Axle| {
        let found = frames(axle, &plan.motion, &request.at);
        found.map_or([None, None], |sides| sides.map(|side| Some(side.into())))
    };
    let [left_frame, right_frame] = frames(axle);
    let opened_axle = || {
        &opened
            .study
            .axle()
            .expect("the study describes an axle")
            .axle
    };
    Ok(SolvedAnswer {
        columns: columns(&found.curves),
        drive,
        rack: groups
            .shown_place()
            .map_or(0.0, |place| place[all.len() - 1]),
        groups: groups.of_stations,
        group_places: groups.places,
        shown: groups.shown,
        has_rows: whole.has_rows(),
        is_partial,
        status: (found.curves.stations.iter())
            .map(|s| s.status.word())
            .collect(),
        failures: FailureRange::all(&found.curves, left),
        frame: left_frame,
        right: right_frame,
        opened: if left.design == opened.study.wheel().design {
            None
        } else {
            frames(opened_axle())[0].take()
        },
        misfit,
        remarks: lines,
        milliseconds: start.elapsed().as_secs_f64() * 1e3,
    })
}

/// Groups of the stations of a motion that form one curve each. If the motion is given as a table of rows, all its stations form
/// one group.
fn grouped(motion: &AxleMotion, axle: &Axle, request: &SolveRequest) -> Groups {
    let places = places(motion, axle);
    if motion.has_rows() {
        Groups::one(&places)
    } else {
        Groups::of(&places, request.over, &request.at)
    }
}

/// Stations of a motion that the page shows as one curve. Only the coordinate with the index `over` moves. The other
/// coordinates have the values nearest to the slider positions `at`. A motion over time, and a motion given as a table of rows,
/// keep all stations.
fn shown_alone(motion: &AxleMotion, (over, at): (usize, &[f64]), axle: &Axle) -> AxleMotion {
    let mut shown = motion.clone();
    if motion.time.is_some() || motion.has_rows() {
        return shown;
    }
    for (number, coordinate) in coordinates(motion).into_iter().enumerate() {
        let Some(k) = nearest(&values(motion, coordinate, axle), at[number]) else {
            continue;
        };
        if number == over {
            continue;
        }
        if coordinate == Coordinate::Rack
            && let Some(angles) = &mut shown.steering_wheel
        {
            *angles = vec![angles[k]];
        }
        if let Some(own) = shown.along(coordinate) {
            *own = vec![own[k]];
        }
    }
    shown
}

/// Poses of both wheels at the slider positions `at` (printed units), or the reason why there is no pose. `None` if the axle cannot
/// be solved.
fn frames(axle: &Axle, motion: &AxleMotion, at: &[f64]) -> Option<[Frame; 2]> {
    let mut here = motion.clone();
    here.steering_wheel = None;
    here.combine = Combine::All;
    for (coordinate, value) in coordinates(motion).into_iter().zip(at) {
        *here.along(coordinate)? = vec![coordinate.in_kernel(*value, axle)];
    }
    let frame = |pose| Frame {
        drive: at[0],
        rack: at[at.len() - 1],
        pose,
    };
    let found = axle_sides(axle, here.placements().first()?).ok()?;
    Some(match found {
        Ok(sides) => sides.map(|side| frame(Ok(side))),
        Err(why) => {
            let words = why.describe(axle.left.length_unit, axle.left.frame);
            [frame(Err(words.clone())), frame(Err(words))]
        }
    })
}

/// Derivatives of each column of the curves with respect to one coordinate of a point, at each station. Unit: unit of the column
/// per length unit. The point moves on both wheels as mirror images.
pub(super) fn influence(
    AxleStudy { axle, plan, .. }: &AxleStudy,
    request: &InfluenceRequest,
    point: PointId,
    axis: Axis,
) -> Result<InfluenceAnswer, String> {
    let (mut plan, _) = plan_of(plan, axle, &request.characteristics, request.curves_rack)?;
    plan.sensitivities = vec![point];
    let found = axle_curves(axle, &plan).map_err(|fault| axle.describe_fault(fault))?;
    let found = found.curves;
    let stations = found.stations.len();
    let columns = found.columns.iter().map(|column| InfluenceColumn {
        column: column.name.clone(),
        slopes: vec![None; stations],
    });
    let mut columns: Vec<InfluenceColumn> = columns.collect();
    for s in found.sensitivities.iter().filter(|s| s.axis == axis) {
        columns[s.column].slopes[s.station] = s.value.is_finite().then_some(s.value);
    }
    Ok(InfluenceAnswer { columns })
}

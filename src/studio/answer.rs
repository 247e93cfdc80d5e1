//! Answer to a dragged point: the solved design.

use super::beside::beside;
use super::groups::{Groups, nearest};
use super::message::{ColumnValues, Coordinates, Designed, Drawn, SolveRequest, SolvedAnswer};
use super::misfit;
use super::study_file::Opened;
use super::turns::Stop;
use crate::characteristics::Characteristic;
use crate::compliance::not_of_equilibrium;
use crate::curves::{Curves, Frame, wheel_curves, wheel_frames};
use crate::exchange::{self, Outgoing, csv as csv_of_rows, point_rows};
use crate::plan::Plan;
use crate::report::{FailureRange, OutputRecord, plausibility, remarks};
use crate::solve::StationOrder;
use crate::solved::Solved;
use crate::study::{Drive, Study, Vehicle, WheelStudy};
use std::borrow::Cow;
use std::time::Instant;

/// Copy of the study that requests the characteristics and rig test results (figures) in `names`, but no certificates. Certificates
/// take too long while a point is dragged. Returns an error if the study cannot compute one of the names.
pub(super) fn asking_for(own: &WheelStudy, names: &[String]) -> Result<WheelStudy, String> {
    let mut asked = own.clone();
    asked.outputs.certify = false;
    asked.outputs.characteristics.clear();
    asked.outputs.figures.clear();
    let figures = own.figures();
    for name in names {
        if let Some(figure) = figures.iter().find(|figure| figure.name == *name) {
            asked.outputs.figures.push(figure.clone());
            continue;
        }
        let characteristic = Characteristic::named(name)
            .filter(|c| {
                let needs = c.info().needs;
                let is_there = own.compliance.is_none() || not_of_equilibrium(*c).is_none();
                is_there && needs.iter().all(|need| need.met_by(&own.suspension))
            })
            .ok_or_else(|| format!("this study has no {name}"))?;
        if !asked.outputs.characteristics.contains(&characteristic) {
            asked.outputs.characteristics.push(characteristic);
        }
    }
    Ok(asked)
}

/// Largest number of stations that are solved for the page. A motion over time is not limited.
pub(super) const MOST_STATIONS: usize = 2000;

/// Solves the design after a point was dragged. An error names the fault of the design or the request.
pub(super) fn solved(
    opened: &Opened,
    request: &SolveRequest,
    stop: &Stop,
) -> Result<SolvedAnswer, String> {
    let moved = opened.moved(&request.of.design)?;
    let shown = in_motion(&moved, request.motion.as_deref())?;
    match &shown.vehicle {
        Vehicle::Axle(both) => super::axle::solved(opened, &moved, both, (request, stop)),
        Vehicle::Wheel(own) => solved_wheel(opened, &moved, own, (request, stop)),
    }
}

/// Copy of the study in which the motion of this name replaces the study's own motion. Without a name, the study stays
/// unchanged.
pub(super) fn in_motion<'s>(
    study: &'s Study,
    name: Option<&str>,
) -> Result<Cow<'s, Study>, String> {
    let Some(name) = name else {
        return Ok(Cow::Borrowed(study));
    };
    let moved = study.in_motion(name);
    let moved = moved.ok_or_else(|| format!("this study has no motion {name}"))?;
    Ok(Cow::Owned(moved))
}

/// Answers with the curves of one wheel over the motion of `own`. Targets without a named motion use the motion of `study`.
fn solved_wheel(
    opened: &Opened,
    study: &Study,
    own: &WheelStudy,
    (request, stop): (&SolveRequest, &Stop),
) -> Result<SolvedAnswer, String> {
    let start = Instant::now();
    let &[drive, rack] = request.at.as_slice() else {
        return Err("expected a value for each of two sliders".to_owned());
    };
    if request.over > 1 {
        return Err("expected the number of one of two sliders".to_owned());
    }
    let asked = asking_for(own, &request.characteristics)?;
    let (suspension, mechanism) = (&own.suspension, &own.suspension.mechanism);
    let mut plan = Plan::of(&asked);
    if let Some(rack) = request.curves_rack {
        plan.racks = vec![rack];
    }
    // If the page needs only the curve of the shown rack displacement, `left_out` keeps all rack displacements of the motion.
    // The plan then has only the rack displacement nearest to the slider position `rack`.
    let needs_shown = request.shown_only && request.over == 0 && plan.time.is_none();
    let left_out = (needs_shown && plan.racks.len() > 1).then(|| plan.racks.clone());
    if let Some(racks) = &left_out {
        plan.racks = nearest(racks, rack).map(|k| racks[k]).into_iter().collect();
    }
    let all = plan.stations();
    let plan = thinned(plan);
    let fault = |fault: crate::mechanism::DesignFault| fault.describe(mechanism);
    let misfit = || misfit::misfit(opened, study).map_err(fault);
    let (misfit, found) = beside(stop, misfit, || wheel_curves(own, &plan).map_err(fault))?;
    let (misfit, found) = (misfit?, found?);
    let place = at_sliders(&plan, [drive, rack]);
    let frame = |own: &WheelStudy| -> Option<Frame> { wheel_frames(own, &place).ok()?.pop() };
    let mut lines = plausibility(suspension).map_err(fault)?;
    lines.extend(remarks(&found, suspension.length_unit));
    lines.extend(stations_left_out(plan.stations(), all));
    let (groups, drive) = grouped(&found, &plan, request);
    let groups = match &left_out {
        Some(racks) => Groups::by_rack(racks, 0, 1, rack).with_shown_only(drive.len()),
        None => groups,
    };
    Ok(SolvedAnswer {
        columns: columns(&found),
        drive,
        rack: groups.shown_place().map_or(rack, |place| place[1]),
        groups: groups.of_stations,
        group_places: groups.places,
        shown: groups.shown,
        has_rows: false,
        is_partial: left_out.is_some(),
        status: found.stations.iter().map(|s| s.status.word()).collect(),
        failures: FailureRange::all(&found, suspension),
        frame: frame(own).map(Drawn::from),
        right: None,
        opened: if suspension.design == opened.study.wheel().design {
            None
        } else {
            (opened.study.vehicle.one_wheel())
                .and_then(frame)
                .map(Drawn::from)
        },
        misfit,
        remarks: lines,
        milliseconds: start.elapsed().as_secs_f64() * 1e3,
    })
}

/// Plan that solves only one pose: at the slider positions of the drive (in printed units) and of the rack.
fn at_sliders(plan: &Plan, [drive, rack]: [f64; 2]) -> Plan {
    Plan {
        station_order: StationOrder::through(&[in_kernel(plan.drive, drive)]),
        racks: vec![rack],
        loads: Vec::new(),
        sensitivities: Vec::new(),
        time: None,
        ..plan.clone()
    }
}

/// Plan with at most [`MOST_STATIONS`] stations. A motion over time keeps all stations, because each station has its own time.
pub(super) fn thinned(plan: Plan) -> Plan {
    if plan.stations() > MOST_STATIONS && plan.time.is_none() {
        plan.thinned(MOST_STATIONS, 9)
    } else {
        plan
    }
}

/// Remark that the page shows only `shown` of the `all` stations of a motion. `None` if it shows all.
pub(super) fn stations_left_out(shown: usize, all: usize) -> Option<String> {
    (shown < all).then(|| {
        format!(
            "{shown} of {all} stations are shown, evenly chosen and without loads; `hardpoint \
             solve` computes all"
        )
    })
}

/// Groups of stations that form one curve each, and the value of each station on the horizontal axis: drive or rack
/// displacement. The drive value is `None` without a pose.
fn grouped(found: &Curves, plan: &Plan, request: &SolveRequest) -> (Groups, Vec<Option<f64>>) {
    let along = plan.station_order.values().len().max(1);
    let stations = found.stations.len();
    let drives = found.along(plan.drive.key());
    if request.over == 0 || plan.time.is_some() {
        let groups = Groups::by_rack(&plan.racks, stations, along, request.at[1]);
        return (groups, drives.collect());
    }
    let rack_of = |station: usize| plan.racks[station / along];
    // A station without a pose has no drive value, so it is put into a group that the page does not show.
    let place =
        |(station, drive): (usize, Option<f64>)| vec![drive.unwrap_or(f64::NAN), rack_of(station)];
    let places: Vec<Vec<f64>> = drives.enumerate().map(place).collect();
    let racks = (0..stations).map(|station| Some(rack_of(station)));
    (Groups::of(&places, 1, &request.at), racks.collect())
}

/// CSV of the curves of a design over the named motion `motion`, or without a name over the study's own motion. The format
/// equals `curves.csv` of `hardpoint solve`.
pub(super) fn csv(
    opened: &Opened,
    design: &Coordinates,
    motion: Option<&str>,
) -> Result<Vec<u8>, String> {
    let study = opened.moved(design)?;
    Ok(Solved::of(&*in_motion(&study, motion)?)?.csv())
}

/// Hardpoints of a design as a CSV table, in the unit and axes of the study.
pub(super) fn points(opened: &Opened, of: &Designed) -> Result<Vec<u8>, String> {
    let study = opened.moved(&of.design)?;
    Ok(csv_of_rows(&point_rows(&Outgoing::of(&study, None, None))))
}

/// DXF drawing of the hardpoints and centre lines of a design, for CAD.
pub(super) fn drawing(opened: &Opened, of: &Designed) -> Result<Vec<u8>, String> {
    let study = opened.moved(&of.design)?;
    Ok(exchange::drawing(&Outgoing::of(&study, None, None)))
}

pub(super) fn columns(found: &Curves) -> Vec<ColumnValues> {
    let columns = found.columns.iter().enumerate();
    let column = |(number, column): (usize, &crate::curves::Column)| {
        let values = found.stations.iter().map(|s| s.value(number));
        ColumnValues::of(OutputRecord::of(column), values)
    };
    columns.map(column).collect()
}

/// Converts a printed drive value (degrees for an angle) to the internal unit (radians for an angle).
fn in_kernel(drive: Drive, printed: f64) -> f64 {
    if drive.is_angle() {
        printed.to_radians()
    } else {
        printed
    }
}

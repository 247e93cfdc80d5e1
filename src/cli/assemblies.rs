//! `hardpoint assemblies`

use super::exit::{Exit, Stop};
use super::output::design_fault;
use super::printer::Printer;
use super::terminal::eprint;
use super::{AssembliesArguments, TableFormat};
use crate::analyse::{Assembly, AssemblyMode, Undecided};
use crate::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::Pose;
use crate::model::Drive;
use crate::plan::Plan;
use crate::report::{Cell, Table, as_written, brief, counted, figure};
use crate::solve::{Solver, StationOrder};
use crate::study::Study;
use std::ops::ControlFlow;

const ANGLES: [Characteristic; 4] = [
    Characteristic::Camber,
    Characteristic::Toe,
    Characteristic::KingpinInclination,
    Characteristic::Caster,
];

/// Width (rad) from which an undecided range of the arm's angle means that the search gave up. Ranges that intervals
/// cannot decide are far narrower.
const GIVEN_UP: f64 = 1e-6;
/// Number of undecided places that are printed one by one.
const MOST_UNDECIDED: usize = 3;

pub(super) fn run(arguments: &AssembliesArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    let why = "each wheel is assembled independently, and both are almost alike";
    super::axle::refuse(&study, path, "assemblies", why)?;
    for (option, value) in [("--travel", arguments.travel), ("--rack", arguments.rack)] {
        if !value.is_finite() {
            return Err(Stop::wrong_input(format!(
                "{option} {value}: expected a finite length"
            )));
        }
    }
    let suspension = &study.suspension;
    let fault = |fault| design_fault(&study, path, &fault);
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design).map_err(fault)?;
    let rack = arguments.rack * Plan::of(&study).rack_sign;
    // The assembly that is connected to the design position. A singular design is refused before the search.
    let mut connected = None;
    let station_order = StationOrder::through(&[arguments.travel]);
    let visited = solver.for_each_pose(Drive::Travel, &station_order, rack, |_, _, pose| {
        connected = pose.ok().copied();
        ControlFlow::Continue(())
    });
    visited.map_err(fault)?;
    let Some(all) = solver.assemblies(arguments.travel, rack) else {
        let topology = suspension.mechanism.topology.name;
        let reason = format!("there is no method that finds all assemblies of a {topology}");
        return Err(Stop::in_file(path, reason));
    };
    let is_connected = |assembly: &Assembly| {
        connected.is_some_and(|pose| same(&pose, &assembly.pose, solver.size()))
    };

    let unit = suspension.length_unit.symbol();
    let has_steering_axis = suspension.mechanism.steering_axis.is_some();
    let angles = ANGLES
        .iter()
        .filter(|c| has_steering_axis || !c.info().reads_steering_axis());
    let angles: Vec<Characteristic> = angles.copied().collect();
    let has_arm = !suspension.mechanism.arms.is_empty();
    let mut header = vec![if has_arm { "arm_angle_deg" } else { "turn_deg" }.to_owned()];
    header.extend(all.traits.iter().map(|t| t.name().to_owned()));
    header.extend(["x", "y", "z"].map(|axis| format!("wheel_centre_{axis}_{unit}")));
    header.extend(angles.iter().map(|c| c.column(suspension.length_unit)));
    header.push("connected".to_owned());
    let mut table = Table::with_columns(header);
    let design_series = DesignSeries::<1>::new(&suspension.mechanism, &suspension.design);
    let point = MotionPoint {
        drive: Drive::Travel,
        value: arguments.travel,
        rack,
    };
    for assembly in &all.found {
        let place = assembly.arm_angle.unwrap_or_else(|| assembly.turn());
        let mut row = vec![Cell::figure(place.to_degrees(), "deg")];
        let branch = all.traits.iter().zip(&assembly.branch);
        let word = |(of, as_designed): (&AssemblyMode, &Option<bool>)| {
            Cell::from(as_designed.map(|is| of.word(is)))
        };
        row.extend(branch.map(word));
        let centre = suspension.frame.vector(assembly.wheel_centre);
        row.extend(centre.to_array().map(|v| Cell::figure(v, unit)));
        let configuration =
            solver.configuration_series(&design_series, &assembly.pose, &point.along_drive::<1>());
        row.extend(angles.iter().map(|c| {
            let value = configuration.as_ref().map(|configuration| {
                let view = WheelReading::of(configuration, Constants::default());
                let value = view.value(configuration, Quantity::Characteristic(*c))[0];
                value * c.info().unit.printed_factor(suspension.length_unit)
            });
            let value = value.ok().filter(|v| v.is_finite());
            Cell::from(value.map(|v| Cell::figure(v, "deg")))
        }));
        row.push(is_connected(assembly).into());
        table.push_row(row);
    }
    let mut out = Printer::new(arguments.study.format);
    if !all.found.is_empty() || arguments.study.format != TableFormat::Text {
        out.table("assemblies", table)?;
    }
    let unproved = all.found.iter().filter(|a| a.certificate.is_none()).count();
    let proof = match unproved {
        0 => String::new(),
        n => format!("; {n} not proved: another assembly is too close, or the same"),
    };
    match all.found.len() {
        0 => out.failure(&format!(
            "at travel {} {unit}, rack {} {unit} the design's lengths cannot be assembled\n",
            as_written(arguments.travel),
            as_written(arguments.rack)
        ))?,
        1 => out.say(&format!("\n1 assembly of the design's lengths{proof}\n"))?,
        n => out.say(&format!(
            "\n{n} assemblies of the design's lengths{proof}\n"
        ))?,
    }
    out.finish()?;
    for place in all.undecided.iter().take(MOST_UNDECIDED) {
        let degrees = |angle: f64| figure(angle.to_degrees(), "deg");
        let unknown = match place {
            Undecided::ArmAngle(low, high) if high - low > GIVEN_UP => format!(
                "are more between arm angles {} and {} deg; the search was given up there, as the design has \
                 assemblies too close together or without number",
                degrees(*low),
                degrees(*high)
            ),
            Undecided::ArmAngle(low, high) => format!(
                "is one more between arm angles {} and {} deg",
                degrees(*low),
                degrees(*high)
            ),
            Undecided::Pose(pose) => {
                let lever = suspension.design[suspension.mechanism.wheel_centre.0]
                    - suspension.design[suspension.mechanism.origin.0];
                let centre = pose.origin + pose.rotation.apply(lever);
                let [x, y, z] = suspension
                    .frame
                    .vector(centre)
                    .to_array()
                    .map(|v| figure(v, unit));
                format!("is one more with the wheel centre next to {x}, {y}, {z} {unit}")
            }
            Undecided::Rotations(share) => format!(
                "are more; {} % of all rotations of the wheel carrier were not searched, as the design has \
                 assemblies too close together or without number",
                brief(share * 100.0)
            ),
        };
        eprint(&format!(
            "undecided: it is not known whether there {unknown}\n"
        ));
    }
    if let Some(more) = all.undecided.len().checked_sub(MOST_UNDECIDED + 1) {
        eprint(&format!("undecided: {}\n", counted(more + 1, "more place")));
    }
    Ok(Exit::of(all.undecided.is_empty() && !all.found.is_empty()))
}

/// Whether two poses are one: assemblies differ by far more than this, and rounding by far less.
fn same(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> bool {
    let columns = a.rotation.columns.iter().zip(b.rotation.columns);
    let turned = columns.map(|(p, q)| (*p - q).norm()).fold(0.0, f64::max);
    (a.origin - b.origin).norm() / size + turned < 1e-7
}

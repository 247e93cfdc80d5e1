//! `hardpoint assemblies`

use super::AssembliesArguments;
use super::exit::{Exit, Stop};
use super::output::design_fault;
use crate::characteristics::{Characteristic, Constants, Quantity, View};
use crate::kinematics::{Assembly, Lifted, March, MotionPoint, Pose, Solver};
use crate::model::Drive;
use crate::plan::Plan;
use crate::report::{Format, Table, shortest};
use crate::study::Study;
use std::io::Write;
use std::ops::ControlFlow;

const ANGLES: [Characteristic; 4] = [
    Characteristic::Camber,
    Characteristic::Toe,
    Characteristic::KingpinInclination,
    Characteristic::Caster,
];

pub(super) fn run(arguments: &AssembliesArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    let suspension = &study.suspension;
    let fault = |fault| design_fault(&study, path, &fault);
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design).map_err(fault)?;
    let rack = arguments.rack * Plan::of(&study).rack_sign;
    let Some(all) = solver.assemblies(arguments.travel, rack) else {
        return Err(Stop::wrong_input(format!(
            "{}: assemblies are found for macpherson only; the topology is {}",
            path.display(),
            suspension.mechanism.topology.name
        )));
    };
    // The one that is connected to the design position.
    let mut connected = None;
    let march = March::through(&[arguments.travel]);
    let visited = solver.march(Drive::Travel, &march, rack, |_, _, pose| {
        connected = pose.ok().copied();
        ControlFlow::Continue(())
    });
    visited.map_err(fault)?;
    let is_connected = |assembly: &Assembly| {
        connected.is_some_and(|pose| same(&pose, &assembly.pose, solver.size()))
    };

    let unit = suspension.length_unit.symbol();
    let columns: Vec<String> = ANGLES
        .iter()
        .map(|c| c.column(suspension.length_unit))
        .collect();
    let at = |axis: &str| format!("wheel_centre_{axis}_{unit}");
    let mut table = Table::new([
        "arm_angle_deg",
        "strut",
        "tie_rod",
        &at("x"),
        &at("y"),
        &at("z"),
        &columns[0],
        &columns[1],
        &columns[2],
        &columns[3],
        "connected",
    ]);
    let lifted = Lifted::<1>::new(&suspension.mechanism, &suspension.design);
    let point = MotionPoint {
        drive: Drive::Travel,
        value: arguments.travel,
        rack,
    };
    for assembly in &all.found {
        let [x, y, z] = suspension.frame.vector(assembly.wheel_centre).to_array();
        let angles = solver
            .posture_series(&lifted, &assembly.pose, &point.along_drive::<1>())
            .map(|posture| {
                let view = View::of(&posture, Constants::default());
                ANGLES.map(|c| {
                    let value = view.value(&posture, Quantity::Characteristic(c))[0];
                    shortest(value * c.info().unit.printed_factor())
                })
            })
            .unwrap_or_default();
        let [camber, toe, kingpin, caster] = angles;
        let word = |is: bool, yes: &str, no: &str| if is { yes.to_owned() } else { no.to_owned() };
        table.push([
            shortest(assembly.arm_angle.to_degrees()),
            word(assembly.strut_inverted, "inverted", "upright"),
            word(assembly.tie_rod_across, "across", "as designed"),
            shortest(x),
            shortest(y),
            shortest(z),
            camber,
            toe,
            kingpin,
            caster,
            word(is_connected(assembly), "yes", "no"),
        ]);
    }
    let mut out = std::io::stdout().lock();
    let format = arguments.study.format.into();
    write!(out, "{}", table.render(format))?;
    if format == Format::Text {
        writeln!(
            out,
            "\n{} assemblies of the design's lengths",
            all.found.len()
        )?;
    }
    for (low, high) in &all.undecided {
        eprintln!(
            "undecided: whether there is one more between arm angles {} and {} deg",
            shortest(low.to_degrees()),
            shortest(high.to_degrees())
        );
    }
    Ok(match all.undecided.is_empty() {
        true => Exit::Done,
        false => Exit::Incomplete,
    })
}

/// Whether two poses are one: assemblies differ by far more than this, and rounding by far less.
fn same(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> bool {
    let columns = a.rotation.columns.iter().zip(b.rotation.columns);
    let turned = columns.map(|(p, q)| (*p - q).norm()).fold(0.0, f64::max);
    (a.origin - b.origin).norm() / size + turned < 1e-7
}

//! All assemblies of a design's lengths, as a table.

use crate::analyse::{Assembly, AssemblyMode, Undecided};
use crate::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::{DesignFault, Pose};
use crate::model::{Drive, Suspension};
use crate::plan::Plan;
use crate::report::{Cell, Table, brief, figure};
use crate::solve::{Solver, StationOrder};
use crate::study::Study;
use std::ops::ControlFlow;

const ANGLES: [Characteristic; 4] = [
    Characteristic::Camber,
    Characteristic::Toe,
    Characteristic::KingpinInclination,
    Characteristic::Caster,
];

/// Ranges of the arm's angle as wide as this (rad) are left by a search that was given up; what intervals cannot
/// decide is far narrower.
const GIVEN_UP: f64 = 1e-6;
/// The assemblies that were found.
pub struct Assembled {
    /// A row for each.
    pub table: Table,
    /// Number of assemblies.
    pub found: usize,
    /// Number of those that are not proved.
    pub unproved: usize,
    /// Places where the search could not decide, in words.
    pub undecided: Vec<String>,
}

/// Finds the assemblies of a wheel at a travel and a rack displacement, in the study's unit and axes.
///
/// # Errors
/// The reason in words.
pub fn assemblies(study: &Study, travel: f64, rack_displacement: f64) -> Result<Assembled, String> {
    let suspension = &study.suspension;
    let fault = |fault: DesignFault| fault.describe(&suspension.mechanism);
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design).map_err(fault)?;
    let rack = rack_displacement * Plan::of(study).rack_sign;
    // The one that is connected to the design position; a design that is singular is refused before the search.
    let mut connected = None;
    let station_order = StationOrder::through(&[travel]);
    let visited = solver.for_each_pose(Drive::Travel, &station_order, rack, |_, _, pose| {
        connected = pose.ok().copied();
        ControlFlow::Continue(())
    });
    visited.map_err(fault)?;
    let Some(all) = solver.assemblies(travel, rack) else {
        let topology = suspension.mechanism.topology.name;
        return Err(format!(
            "there is no method that finds all assemblies of a {topology}"
        ));
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
        value: travel,
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
    Ok(Assembled {
        table,
        found: all.found.len(),
        unproved: all.found.iter().filter(|a| a.certificate.is_none()).count(),
        undecided: (all
            .undecided
            .iter()
            .map(|place| undecided(suspension, place)))
        .collect(),
    })
}

/// Describes a place where the search could not decide.
fn undecided(suspension: &Suspension, place: &Undecided) -> String {
    let unit = suspension.length_unit.symbol();
    let degrees = |angle: f64| figure(angle.to_degrees(), "deg");
    match place {
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
    }
}

/// Whether two poses are one: assemblies differ by far more than this, and rounding by far less.
fn same(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> bool {
    let columns = a.rotation.columns.iter().zip(b.rotation.columns);
    let turned = columns.map(|(p, q)| (*p - q).norm()).fold(0.0, f64::max);
    (a.origin - b.origin).norm() / size + turned < 1e-7
}

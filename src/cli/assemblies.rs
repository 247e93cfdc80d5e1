//! `hardpoint assemblies`

use super::exit::{Exit, Stop};
use super::printer::Printer;
use super::terminal::eprint;
use super::{AssembliesArguments, TableFormat};
use crate::analyse::{Assemblies, Assembly, AssemblyMode, Undecided};
use crate::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::{DesignFault, Pose};
use crate::model::{Axis, Drive, Side, Suspension};
use crate::number::Vector3;
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

/// Ranges of the arm's angle as wide as this (rad) are left by a search that was given up; what intervals cannot
/// decide is far narrower.
const GIVEN_UP: f64 = 1e-6;
/// Undecided places that are said one by one.
const MOST_UNDECIDED: usize = 3;

pub(super) fn run(arguments: &AssembliesArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    for (option, value) in [("--travel", arguments.travel), ("--rack", arguments.rack)] {
        if !value.is_finite() {
            return Err(Stop::wrong_input(format!(
                "{option} {value}: expected a finite length"
            )));
        }
    }
    let wheels = wheels(&study, arguments.rack);
    let mut found = Vec::new();
    for wheel in &wheels {
        let assembled = Assembled::of(wheel, arguments.travel);
        let assembled = assembled.map_err(|fault| {
            let reason = fault.describe(&wheel.suspension.mechanism);
            Stop::in_file(path, wheel.about(&reason))
        })?;
        let Some(assembled) = assembled else {
            let topology = wheel.suspension.mechanism.topology.name;
            let reason = format!("there is no method that finds all assemblies of a {topology}");
            return Err(Stop::in_file(path, reason));
        };
        found.push(assembled);
    }
    let table = table(&found);
    let mut out = Printer::new(arguments.study.format);
    if !table.is_empty() || arguments.study.format != TableFormat::Text {
        out.table("assemblies", table)?;
    }
    for assembled in &found {
        say_number(&out, assembled, arguments)?;
    }
    if let (Some(_), [_]) = (&study.axle, &wheels[..]) {
        out.remark(
            "The right wheel is the mirror image: its assemblies are those of the left wheel.\n",
        )?;
    }
    out.finish()?;
    for assembled in &found {
        say_undecided(assembled);
    }
    let is_known = |a: &Assembled| a.all.undecided.is_empty() && !a.all.found.is_empty();
    Ok(Exit::of(found.iter().all(is_known)))
}

/// A wheel whose assemblies are listed.
struct Wheel<'s> {
    /// Which wheel of an axle; `None` in a study of one wheel.
    side: Option<Side>,
    suspension: &'s Suspension,
    /// Signs that lead from the kernel's frame to the study's axes.
    signs: [f64; 3],
    /// Displacement of the rack in the kernel's frame.
    rack: f64,
}

impl Wheel<'_> {
    /// Says of which wheel of an axle a sentence is.
    fn about(&self, sentence: &str) -> String {
        match self.side {
            Some(side) => format!("{} wheel: {sentence}", side.name()),
            None => sentence.to_owned(),
        }
    }
}

/// The wheels to assemble. A mirror image has the same assemblies as the left wheel while the rack is in the middle;
/// a rack that is displaced moves towards one wheel and away from the other.
fn wheels(study: &Study, rack: f64) -> Vec<Wheel<'_>> {
    let Some(both) = &study.axle else {
        let suspension = &study.suspension;
        let signs = Axis::ALL.map(|axis| suspension.frame.sign(axis));
        let rack = rack * signs[Axis::Y as usize];
        return vec![Wheel {
            side: None,
            suspension,
            signs,
            rack,
        }];
    };
    let axle = &both.axle;
    let mut sides = Side::ALL.to_vec();
    sides.retain(|side| *side == Side::Left || axle.right.is_some() || rack != 0.0);
    let wheel = |side: Side| {
        let signs = Axis::ALL.map(|axis| axle.frame(side).sign(axis));
        Wheel {
            side: Some(side),
            suspension: axle.suspension(side),
            signs,
            rack: rack * signs[Axis::Y as usize],
        }
    };
    sides.into_iter().map(wheel).collect()
}

/// All assemblies of a wheel.
struct Assembled<'w> {
    wheel: &'w Wheel<'w>,
    solver: Solver<'w>,
    travel: f64,
    all: Assemblies,
    /// The pose that is connected to the design position.
    connected: Option<Pose<f64>>,
}

impl<'w> Assembled<'w> {
    /// Finds the assemblies; `None` if there is no method for the topology.
    fn of(wheel: &'w Wheel<'w>, travel: f64) -> Result<Option<Self>, DesignFault> {
        let suspension = wheel.suspension;
        let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
        // A design that is singular is refused before the search.
        let mut connected = None;
        let station_order = StationOrder::through(&[travel]);
        solver.for_each_pose(Drive::Travel, &station_order, wheel.rack, |_, _, pose| {
            connected = pose.ok().copied();
            ControlFlow::Continue(())
        })?;
        let all = solver.assemblies(travel, wheel.rack);
        Ok(all.map(|all| Assembled {
            wheel,
            solver,
            travel,
            all,
            connected,
        }))
    }

    /// Cells of an assembly, without the side.
    fn row(&self, assembly: &Assembly, series: &DesignSeries<1>) -> Vec<Cell> {
        let (solver, suspension) = (&self.solver, self.wheel.suspension);
        let place = assembly.arm_angle.unwrap_or_else(|| assembly.turn());
        let mut row = vec![Cell::figure(place.to_degrees(), "deg")];
        let branch = self.all.traits.iter().zip(&assembly.branch);
        let word = |(of, as_designed): (&AssemblyMode, &Option<bool>)| {
            Cell::from(as_designed.map(|is| of.word(is)))
        };
        row.extend(branch.map(word));
        let unit = suspension.length_unit.symbol();
        let centre = self.in_study(assembly.wheel_centre);
        row.extend(centre.map(|v| Cell::figure(v, unit)));
        let point = MotionPoint {
            drive: Drive::Travel,
            value: self.travel,
            rack: self.wheel.rack,
        };
        let configuration =
            solver.configuration_series(series, &assembly.pose, &point.along_drive::<1>());
        row.extend(angles(suspension).iter().map(|c| {
            let value = configuration.as_ref().map(|configuration| {
                let view = WheelReading::of(configuration, Constants::default());
                let value = view.value(configuration, Quantity::Characteristic(*c))[0];
                value * c.info().unit.printed_factor(suspension.length_unit)
            });
            let value = value.ok().filter(|v| v.is_finite());
            Cell::from(value.map(|v| Cell::figure(v, "deg")))
        }));
        let size = solver.size();
        let connected = self.connected.as_ref();
        row.push(
            connected
                .is_some_and(|pose| same(pose, &assembly.pose, size))
                .into(),
        );
        row
    }

    /// A place in the study's axes.
    fn in_study(&self, place: Vector3<f64>) -> [f64; 3] {
        let place = place.to_array();
        [0, 1, 2].map(|axis| self.wheel.signs[axis] * place[axis])
    }
}

/// The angles that an assembly is told by.
fn angles(suspension: &Suspension) -> Vec<Characteristic> {
    let has_steering_axis = suspension.mechanism.steering_axis.is_some();
    let mut angles = ANGLES.to_vec();
    angles.retain(|c| has_steering_axis || !c.info().reads_steering_axis());
    angles
}

/// A row for each assembly; of an axle with its side.
fn table(found: &[Assembled]) -> Table {
    let first = &found[0];
    let suspension = first.wheel.suspension;
    let unit = suspension.length_unit.symbol();
    let has_arm = !suspension.mechanism.arms.is_empty();
    let mut header = Vec::new();
    header.extend(first.wheel.side.map(|_| "side".to_owned()));
    header.push(if has_arm { "arm_angle_deg" } else { "turn_deg" }.to_owned());
    header.extend(first.all.traits.iter().map(|t| t.name().to_owned()));
    header.extend(["x", "y", "z"].map(|axis| format!("wheel_centre_{axis}_{unit}")));
    let angles = angles(suspension);
    header.extend(angles.iter().map(|c| c.column(suspension.length_unit)));
    header.push("connected".to_owned());
    let mut table = Table::with_columns(header);
    for assembled in found {
        let suspension = assembled.wheel.suspension;
        let series = DesignSeries::<1>::new(&suspension.mechanism, &suspension.design);
        for assembly in &assembled.all.found {
            let side = assembled.wheel.side.map(|side| Cell::from(side.name()));
            let row = assembled.row(assembly, &series);
            table.push_row(side.into_iter().chain(row));
        }
    }
    table
}

/// Says how many assemblies a wheel has.
fn say_number(
    out: &Printer,
    assembled: &Assembled,
    arguments: &AssembliesArguments,
) -> Result<(), Stop> {
    let all = &assembled.all;
    let unproved = all.found.iter().filter(|a| a.certificate.is_none()).count();
    let proof = match unproved {
        0 => String::new(),
        n => format!("; {n} not proved: another is too close, if not the same"),
    };
    let wheel = assembled.wheel;
    match all.found.len() {
        0 => {
            let unit = wheel.suspension.length_unit.symbol();
            let none = format!(
                "at travel {} {unit}, rack {} {unit} the design's lengths have no assembly",
                as_written(arguments.travel),
                as_written(arguments.rack)
            );
            out.failure(&format!("{}\n", wheel.about(&none)))
        }
        n => {
            let number = match n {
                1 => "1 assembly".to_owned(),
                n => format!("{n} assemblies"),
            };
            let number = format!("{number} of the design's lengths{proof}");
            out.say(&format!("\n{}\n", wheel.about(&number)))
        }
    }
}

/// Says where the search decided nothing.
fn say_undecided(assembled: &Assembled) {
    let (wheel, undecided) = (assembled.wheel, &assembled.all.undecided);
    let suspension = wheel.suspension;
    let unit = suspension.length_unit.symbol();
    for place in undecided.iter().take(MOST_UNDECIDED) {
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
                let [x, y, z] = assembled.in_study(centre).map(|v| figure(v, unit));
                format!("is one more with the wheel centre next to {x}, {y}, {z} {unit}")
            }
            Undecided::Rotations(share) => format!(
                "are more; {} % of all rotations of the wheel carrier were not searched, as the design has \
                 assemblies too close together or without number",
                brief(share * 100.0)
            ),
        };
        let unknown = wheel.about(&format!("undecided: whether there {unknown}"));
        eprint(&format!("{unknown}\n"));
    }
    if let Some(more) = undecided.len().checked_sub(MOST_UNDECIDED + 1) {
        let more = format!("undecided: {}", counted(more + 1, "more place"));
        eprint(&format!("{}\n", wheel.about(&more)));
    }
}

/// Whether two poses are one: assemblies differ by far more than this, and rounding by far less.
fn same(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> bool {
    let columns = a.rotation.columns.iter().zip(b.rotation.columns);
    let turned = columns.map(|(p, q)| (*p - q).norm()).fold(0.0, f64::max);
    (a.origin - b.origin).norm() / size + turned < 1e-7
}

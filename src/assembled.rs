//! All positions in which a design can be assembled ("assemblies"), as a table for one wheel or for both wheels of an axle.

use crate::analyse::{Assemblies, Assembly, AssemblyMode, Undecided};
use crate::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::Pose;
use crate::model::{Axis, Drive, Side, Suspension};
use crate::number::Vector3;
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

/// Width (rad) that distinguishes two kinds of undecided ranges of the arm angle. In a wider range, the program stopped the
/// search. In a narrower range, interval arithmetic could not decide whether there is an assembly.
const GIVEN_UP: f64 = 1e-6;

/// Assemblies that the search found.
pub struct Assembled {
    /// One row per assembly. For an axle the first column is `side`.
    pub table: Table,
    /// Wheels that were searched: one wheel, or both wheels of an axle that is not mirrored or whose rack is displaced.
    pub wheels: Vec<WheelAssemblies>,
}

/// Assemblies of one wheel.
pub struct WheelAssemblies {
    /// Left or right wheel of an axle. `None` in a study of one wheel.
    pub side: Option<Side>,
    /// Number of assemblies.
    pub found: usize,
    /// Number of assemblies without a certificate (proof that exactly one assembly exists near the computed one).
    pub unproved: usize,
    /// Descriptions of the search ranges in which it is not known whether an assembly exists.
    pub undecided: Vec<String>,
}

impl WheelAssemblies {
    /// Writes the name of the wheel before a sentence, if the study has an axle.
    pub fn about(&self, sentence: &str) -> String {
        about(self.side, sentence)
    }
}

impl Assembled {
    /// Descriptions of the search ranges of all wheels in which it is not known whether an assembly exists. For an axle, each
    /// description names the wheel.
    pub fn undecided(&self) -> Vec<String> {
        let wheels = self.wheels.iter();
        let places =
            wheels.flat_map(|wheel| wheel.undecided.iter().map(|place| wheel.about(place)));
        places.collect()
    }

    /// True if each wheel has an assembly and no range is undecided.
    pub fn is_complete(&self) -> bool {
        let mut wheels = self.wheels.iter();
        wheels.all(|wheel| wheel.found > 0 && wheel.undecided.is_empty())
    }
}

/// Finds the assemblies of each wheel at a travel and a rack displacement, in the study's unit and axes. If the axle is mirrored
/// and the rack is in the middle, both wheels have the same assemblies. Then the right wheel is left out.
///
/// # Errors
/// Returns the reason in words if the mechanism carries both wheels, or if a wheel cannot be searched.
pub fn assemblies(study: &Study, travel: f64, rack_displacement: f64) -> Result<Assembled, String> {
    if study.wheel().mechanism.rigid_axle.is_some() {
        return Err(
            "assemblies are not available for an axle whose mechanism carries both wheels"
                .to_owned(),
        );
    }
    let wheels = wheels(study, rack_displacement);
    let searches: Result<Vec<Search>, String> = wheels
        .iter()
        .map(|wheel| Search::of(wheel, travel).map_err(|reason| about(wheel.side, &reason)))
        .collect();
    let searches = searches?;
    let wheels = searches.iter().map(|search| WheelAssemblies {
        side: search.wheel.side,
        found: search.all.found.len(),
        unproved: (search.all.found.iter())
            .filter(|assembly| assembly.certificate.is_none())
            .count(),
        undecided: (search.all.undecided.iter())
            .map(|place| undecided(search.wheel, place))
            .collect(),
    });
    Ok(Assembled {
        table: table(&searches),
        wheels: wheels.collect(),
    })
}

fn about(side: Option<Side>, sentence: &str) -> String {
    match side {
        Some(side) => side.about(&sentence),
        None => sentence.to_owned(),
    }
}

/// A wheel whose assemblies the program searches.
struct Wheel<'s> {
    side: Option<Side>,
    suspension: &'s Suspension,
    /// Signs of x, y and z that convert coordinates from the internal frame (x forward, y left, z up) to the study's axes.
    signs: [f64; 3],
    /// Rack displacement along +y of the internal frame.
    rack: f64,
}

impl Wheel<'_> {
    /// Converts a position from the internal frame to the study's axes.
    fn in_study(&self, place: Vector3<f64>) -> [f64; 3] {
        let place = place.to_array();
        [0, 1, 2].map(|axis| self.signs[axis] * place[axis])
    }
}

/// Returns the wheels whose assemblies differ: one wheel, or both wheels of an axle. A displaced rack moves towards one wheel and
/// away from the other, so even mirrored wheels differ.
fn wheels(study: &Study, rack: f64) -> Vec<Wheel<'_>> {
    let Some(both) = study.axle() else {
        let suspension = study.wheel();
        let signs = Axis::ALL.map(|axis| suspension.frame.sign(axis));
        return vec![Wheel {
            side: None,
            suspension,
            signs,
            rack: rack * signs[Axis::Y as usize],
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

/// Search for the assemblies of one wheel.
struct Search<'w> {
    wheel: &'w Wheel<'w>,
    solver: Solver<'w>,
    travel: f64,
    all: Assemblies,
    /// Pose at the travel and rack displacement of the search that the wheel reaches from the design position by a continuous
    /// motion. `None` if it reaches none.
    connected: Option<Pose<f64>>,
}

impl<'w> Search<'w> {
    fn of(wheel: &'w Wheel<'w>, travel: f64) -> Result<Self, String> {
        let mechanism = &wheel.suspension.mechanism;
        let solver = Solver::new(mechanism, &wheel.suspension.design);
        let mut solver = solver.map_err(|fault| fault.describe(mechanism))?;
        // A singular design is refused before the search starts.
        let mut connected = None;
        let station_order = StationOrder::through(&[travel]);
        let visited =
            solver.for_each_pose(Drive::Travel, &station_order, wheel.rack, |_, _, pose| {
                connected = pose.ok().copied();
                ControlFlow::Continue(())
            });
        visited.map_err(|fault| fault.describe(mechanism))?;
        let all = solver.assemblies(travel, wheel.rack).ok_or_else(|| {
            let topology = mechanism.topology.name;
            format!(
                "assemblies are not available for {topology}, because no method finds all of them"
            )
        })?;
        Ok(Search {
            wheel,
            solver,
            travel,
            all,
            connected,
        })
    }

    /// Cells of the table row of one assembly, without the column `side`.
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
        let centre = self.wheel.in_study(assembly.wheel_centre);
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
        let connected = self.connected.as_ref();
        let is_connected = connected.is_some_and(|pose| same(pose, &assembly.pose, solver.size()));
        row.push(is_connected.into());
        row
    }
}

/// Wheel angles that are columns in the table of assemblies. A wheel without steering axis has fewer angles.
fn angles(suspension: &Suspension) -> Vec<Characteristic> {
    let has_steering_axis = suspension.mechanism.steering_axis.is_some();
    let mut angles = ANGLES.to_vec();
    angles.retain(|c| has_steering_axis || !c.info().reads_steering_axis());
    angles
}

fn table(searches: &[Search]) -> Table {
    let first = &searches[0];
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
    for search in searches {
        let suspension = search.wheel.suspension;
        let series = DesignSeries::<1>::new(&suspension.mechanism, &suspension.design);
        for assembly in &search.all.found {
            let side = search.wheel.side.map(|side| Cell::from(side.name()));
            let row = search.row(assembly, &series);
            table.push_row(side.into_iter().chain(row));
        }
    }
    table
}

/// Describes a search range in which it is not known whether an assembly exists.
fn undecided(wheel: &Wheel, place: &Undecided) -> String {
    let suspension = wheel.suspension;
    let unit = suspension.length_unit.symbol();
    let degrees = |angle: f64| figure(angle.to_degrees(), "deg");
    match place {
        Undecided::ArmAngle(low, high) if high - low > GIVEN_UP => format!(
            "there may be more assemblies between arm angles {} and {} deg. The search stopped there: \
             assemblies are too close together, or infinite in number",
            degrees(*low),
            degrees(*high)
        ),
        Undecided::ArmAngle(low, high) => format!(
            "there may be one more assembly between arm angles {} and {} deg",
            degrees(*low),
            degrees(*high)
        ),
        Undecided::Pose(pose) => {
            let lever = suspension.design[suspension.mechanism.wheel_centre.0]
                - suspension.design[suspension.mechanism.origin.0];
            let centre = pose.origin + pose.rotation.apply(lever);
            let [x, y, z] = wheel.in_study(centre).map(|v| figure(v, unit));
            format!(
                "there may be one more assembly with the wheel centre next to {x}, {y}, {z} {unit}"
            )
        }
        Undecided::Rotations(share) => format!(
            "there may be more assemblies: {} % of all rotations of the wheel carrier were not \
             searched. Assemblies are too close together, or infinite in number",
            brief(share * 100.0)
        ),
    }
}

/// True if two poses are equal within 1e-7, relative to the size `size` of the mechanism. Rounding errors are far smaller than the
/// tolerance. Different assemblies usually differ by far more.
fn same(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> bool {
    let columns = a.rotation.columns.iter().zip(b.rotation.columns);
    let turned = columns.map(|(p, q)| (*p - q).norm()).fold(0.0, f64::max);
    (a.origin - b.origin).norm() / size + turned < 1e-7
}

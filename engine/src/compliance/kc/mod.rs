//! Tests of a kinematics and compliance rig, on one wheel or on both wheels of an axle (`axle.rs`).
//!
//! At a station (travel, rack), the wheel is in equilibrium without horizontal loads, and its height is fixed. A test
//! starts from this equilibrium and changes a load, the travel or the rack. Its results are derivatives with respect to
//! this change. The window of a test is the range of its load. The results also contain secants (mean slopes) over this
//! window. The levels of a test are equilibria at equally spaced loads in the window. The results of a wheel are given
//! for a left wheel in ISO 8855 axes. Only results along the rack, and the compliance matrix, are in the study's axes.

mod axle;
mod ends;
mod figures;
mod gradients;
mod names;
mod test;

pub(crate) use axle::{AxleFigure, Conditions, Here};
pub use axle::{AxleKcRun, AxleVehicle, FigureGradients};
pub use gradients::{KcGradient, KcValue};
pub use names::{
    figure_and_keys, figure_names, figures_by, follows_y_axis, is_figure_of_axles,
    is_steer_to_left, loads_of_figure, sign_of_figure,
};
pub use test::{KcTest, TestLoad, TestMode, TestPlace};

use super::definition::Compliance;
use super::fault::{ElasticFault, NoEquilibrium};
use super::loads::WheelLoads;
use super::reading::WheelFigures;
use super::wheel::{BushingReading, ElasticWheel, Equilibrium, HeldQuantity, SpringReading};
use crate::ask::Unit;
use crate::model::{Axis, Frame, Side, SteeringAxis, Suspension};
use crate::number::{Each, Scalar, Vector3, array_of};
use figures::{Read, Sheet};
use gradients::Station;

/// Test result.
#[derive(Clone, Debug, PartialEq)]
pub struct KcFigure {
    /// Name of the result.
    pub quantity: &'static str,
    /// Unit of `value` and of `secant`.
    pub unit: Unit,
    /// Derivative with respect to the test's load or motion at the station; `None` if it does not exist.
    pub value: Option<f64>,
    /// Secant (mean slope) over the window. `None` without levels, or if an end of the window has no equilibrium.
    pub secant: Option<f64>,
    /// Wheel or axle to which the result belongs.
    pub of: KcSubject,
}

/// Wheel or axle to which a result belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KcSubject {
    /// Single wheel of a study.
    OneWheel,
    /// One wheel of an axle.
    Wheel(Side),
    /// Whole axle.
    Axle,
}

/// Equilibrium under one value of a test load.
#[derive(Clone, Debug, PartialEq)]
pub struct KcState {
    /// State of the wheel; for an axle, of the left and the right wheel.
    pub wheels: Vec<KcWheelState>,
    /// Values of the whole axle; `None` in a study with one wheel.
    pub axle: Option<KcAxleState>,
}

/// Values of an axle in an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KcAxleState {
    /// Mean steer of both wheels, positive to the left.
    pub mean_steer: f64,
    /// Force that holds the rack, positive along the study's +y.
    pub rack_force: f64,
    /// Torque of the anti-roll bar; `None` if it does not act.
    pub bar_torque: Option<f64>,
}

/// State of one wheel in an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct KcWheelState {
    /// Angles and positions of the wheel.
    pub figures: WheelFigures,
    /// Vertical force at the contact point.
    pub wheel_load: f64,
    /// State of the spring, if it has a law.
    pub spring: Option<SpringReading>,
    /// States of the bushings, in the order of the definition; for an axle, then of the subframe's mounts.
    pub bushings: Vec<BushingReading>,
    /// Tensions of the links, in the order of the definition. `None` for the rod of a rocker whose spring has no law.
    pub tensions: Vec<Option<f64>>,
}

/// Level of a test: one of the loads of the test, with its equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct KcLevel {
    /// Number of the level: 0 without load, negative for negative loads.
    pub level: i64,
    /// Load at this level.
    pub load: f64,
    /// Equilibrium, or the reason why there is none.
    pub state: Result<KcState, NoEquilibrium>,
}

/// Results of a test at a station.
#[derive(Clone, Debug, PartialEq)]
pub struct KcOutcome {
    /// The test.
    pub test: KcTest,
    /// Point where the load acts.
    pub place: TestPlace,
    /// Results of the test.
    pub figures: Vec<KcFigure>,
    /// Levels, from the lowest load to the highest; empty if the test has no levels.
    pub levels: Vec<KcLevel>,
}

/// Results of all tests at a station.
#[derive(Clone, Debug, PartialEq)]
pub struct KcStation {
    /// Wheel travel; for an axle, of the left wheel.
    pub travel: f64,
    /// Travel of the right wheel; `None` in a study with one wheel.
    pub right_travel: Option<f64>,
    /// Rack displacement along the study's +y.
    pub rack: f64,
    /// Results of the tests, or the reason why there is no equilibrium.
    pub outcomes: Result<Vec<KcOutcome>, NoEquilibrium>,
    /// Tests of the station with the points where their loads act. The list also exists if the station has no
    /// equilibrium.
    pub tests: Vec<(KcTest, TestPlace)>,
    /// Compliance matrix of the wheel centre, in the study's axes. `None` if the wheel load cannot be held, or if the
    /// station (for an axle, the first test) has no equilibrium. Rows are displacements along x, y, z, then rotations.
    /// Columns are forces, then moments. For an axle, the left wheel comes first. Anti-roll bar and steering are as in
    /// the first test.
    pub matrix: Option<Vec<Vec<f64>>>,
    /// Lateral distance between the wheel centres of an axle. `None` for a single wheel, or if the first test has no
    /// equilibrium.
    pub centre_distance: Option<f64>,
}

/// Tests of a study with one wheel.
#[derive(Clone, Debug)]
pub struct KcRun<'a> {
    suspension: &'a Suspension,
    design: Vec<Vector3<f64>>,
    compliance: Compliance,
    wheel: ElasticWheel,
    tyre_rate: Option<f64>,
}

impl<'a> KcRun<'a> {
    /// Prepares the tests of a suspension.
    pub fn new(
        suspension: &'a Suspension,
        compliance: &Compliance,
        tyre_rate: Option<f64>,
    ) -> Result<Self, ElasticFault> {
        KcRun::of(suspension, &suspension.design, compliance, tyre_rate)
    }

    /// Prepares the tests, like `new`. The hardpoints of the suspension are at `design`.
    pub fn of(
        suspension: &'a Suspension,
        design: &[Vector3<f64>],
        compliance: &Compliance,
        tyre_rate: Option<f64>,
    ) -> Result<Self, ElasticFault> {
        Ok(KcRun {
            suspension,
            wheel: ElasticWheel::of(suspension, design, compliance)?,
            design: design.to_vec(),
            compliance: compliance.clone(),
            tyre_rate,
        })
    }

    fn sheet(&self, at: &Equilibrium) -> Sheet<'_> {
        Sheet {
            suspension: self.suspension,
            is_rigid: self.compliance.is_rigid(),
            has_axis: self.wheel.figures(at).steering.is_some(),
            tyre_rate: self.tyre_rate,
            side: self.suspension.frame.meaning().1,
        }
    }

    /// Elastic wheel under test.
    pub fn wheel(&self) -> &ElasticWheel {
        &self.wheel
    }

    /// Runs the tests at all stations that have tests, in the order of the stations.
    pub fn run(&self, travels: &[f64], racks: &[f64], tests: &[KcTest]) -> Vec<KcStation> {
        let stations = travels
            .iter()
            .flat_map(|travel| racks.iter().map(move |rack| (*travel, *rack)));
        let stations: Vec<(f64, f64)> = stations.collect();
        let distance = |(travel, rack): &(f64, f64)| travel.abs() + rack.abs();
        let mut found = Vec::new();
        for ((travel, rack), here) in at_stations(&stations, distance, tests) {
            found.push(self.station(travel, rack, &here));
        }
        found
    }

    fn station(&self, travel: f64, rack: f64, tests: &[KcTest]) -> KcStation {
        let along = self.suspension.frame.sign(Axis::Y);
        let at = self.wheel.at(travel, along * rack);
        let mut station = at
            .as_ref()
            .ok()
            .map(|at| Station::new(&self.wheel, self.sheet(at), *at));
        let vehicle = &self.suspension.vehicle;
        KcStation {
            travel,
            right_travel: None,
            centre_distance: None,
            rack,
            tests: tests
                .iter()
                .map(|test| (*test, test.unit_load(vehicle).1))
                .collect(),
            matrix: station.as_mut().and_then(|station| self.matrix(station)),
            outcomes: at.map(|_| {
                let stations = station.iter_mut();
                stations
                    .flat_map(|station| tests.iter().map(|test| self.outcome(station, test)))
                    .collect()
            }),
        }
    }

    fn outcome(&self, station: &mut Station<'_, f64>, test: &KcTest) -> KcOutcome {
        let (load, place) = test.unit_load(&self.suspension.vehicle);
        let levels = if test.has_levels() {
            self.levels(&station.at, test, &load)
        } else {
            Vec::new()
        };
        let values = station.figures(test);
        let secants = station.secants(test, secant(&levels, 0));
        let figures = values.into_iter().zip(secants);
        let figures = figures.map(|(value, secant)| KcFigure {
            quantity: value.quantity,
            unit: value.unit,
            value: value.value.filter(|value| value.is_finite()),
            secant: secant
                .value
                .filter(|value| value.is_finite() && !levels.is_empty()),
            of: KcSubject::OneWheel,
        });
        KcOutcome {
            test: *test,
            place,
            figures: figures.collect(),
            levels,
        }
    }

    /// Finds the equilibria from the lowest load to the highest. The search for each equilibrium starts from the
    /// neighbouring equilibrium with the smaller magnitude of the load.
    fn levels(&self, at: &Equilibrium, test: &KcTest, load: &WheelLoads) -> Vec<KcLevel> {
        let next = |from: &Equilibrium, force: f64| {
            let loads = end_loads(load, force);
            self.wheel.loaded_about(at, from, &loads, test.held)
        };
        levels(at, test, next, |level, load, at| {
            self.level(level, load, at)
        })
    }

    fn level(&self, level: i64, load: f64, at: &Result<Equilibrium, NoEquilibrium>) -> KcLevel {
        let state = at.as_ref().map_err(Clone::clone).map(|at| KcState {
            wheels: vec![KcWheelState {
                figures: self.wheel.figures(at),
                wheel_load: self.wheel.wheel_load(at),
                spring: self.wheel.spring(at),
                bushings: self.wheel.bushings(at),
                tensions: self.wheel.tensions(at),
            }],
            axle: None,
        });
        KcLevel { level, load, state }
    }

    /// Compliance matrix of the wheel centre, in the study's axes.
    fn matrix(&self, station: &mut Station<'_, f64>) -> Option<Vec<Vec<f64>>> {
        let signs = twist_signs(self.suspension.frame);
        let tangent = station.tangent(HeldQuantity::WheelLoad)?;
        let mut matrix = vec![vec![0.0; 6]; 6];
        for column in 0..6 {
            let load = unit_at_centre(column);
            let [shift, turn] = self.wheel.twist_along(tangent, &load)?;
            let twist = shift.to_array().into_iter().chain(turn.to_array());
            for (row, value) in twist.enumerate() {
                let value = value * signs[row] * signs[column];
                matrix[row][column] = value.is_finite().then_some(value)?;
            }
        }
        Some(matrix)
    }
}

/// Returns the stations that have tests, each with its tests.
fn at_stations<S: Copy>(
    stations: &[S],
    distance: impl Fn(&S) -> f64,
    tests: &[KcTest],
) -> Vec<(S, Vec<KcTest>)> {
    let nearest = stations
        .iter()
        .enumerate()
        .min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)))
        .map_or(0, |(k, _)| k);
    let here = |k: usize| {
        let here = |test: &&KcTest| test.at_all_stations || k == nearest;
        tests.iter().filter(here).copied().collect::<Vec<_>>()
    };
    let all = stations.iter().enumerate().map(|(k, s)| (*s, here(k)));
    all.filter(|(_, tests)| !tests.is_empty()).collect()
}

/// Signs that convert shifts and rotations from the kernel's frame to the study's axes.
fn twist_signs(frame: Frame) -> [f64; 6] {
    array_of(|k| {
        let axis = Axis::ALL[k % 3];
        if k < 3 {
            frame.sign(axis)
        } else {
            frame.turn_sign(axis)
        }
    })
}

/// Returns a unit force or a unit moment at the wheel centre.
fn unit_at_centre(component: usize) -> WheelLoads {
    let mut unit = Vector3::new(0.0, 0.0, 0.0);
    unit[Axis::ALL[component % 3]] = 1.0;
    let mut load = WheelLoads::none(0.0);
    if component < 3 {
        load.centre = unit;
    } else {
        load.moment = unit;
    }
    load
}

/// Returns the results of a study's test, with their units.
pub fn quantities(
    suspension: &Suspension,
    compliance: &Compliance,
    tyre_rate: Option<f64>,
    test: &KcTest,
) -> Vec<(&'static str, Unit)> {
    let steering = suspension.mechanism.steering_axis;
    let sheet = Sheet {
        suspension,
        is_rigid: compliance.is_rigid(),
        has_axis: matches!(steering, Some(SteeringAxis::Through { .. })),
        tyre_rate,
        side: suspension.frame.meaning().1,
    };
    let read = Read {
        by: None,
        wheel_rate: None,
        rack_force: compliance.spring.as_ref().map(|_| 0.0),
    };
    let figures = sheet.figures::<f64>(test, &read).into_iter();
    figures
        .map(|figure| (figure.quantity, figure.unit))
        .collect()
}

/// Finds the levels of a test, from the lowest load to the highest. `next` finds the equilibrium under a load, starting
/// from a neighbouring equilibrium.
fn levels<E: Copy>(
    at: &E,
    test: &KcTest,
    next: impl Fn(&E, f64) -> Result<E, NoEquilibrium>,
    read: impl Fn(i64, f64, &Result<E, NoEquilibrium>) -> KcLevel,
) -> Vec<KcLevel> {
    let count = test.levels as i64;
    let level_load = |level: i64| test.window * level as f64 / count as f64;
    let mut sides = [Vec::new(), Vec::new()];
    for (sign, side) in [-1, 1].into_iter().zip(&mut sides) {
        let mut before = Ok(*at);
        // Number of levels that the search reached. If a level failed, this number includes the fraction of its load that
        // the search reached.
        let mut reached = 0.0;
        for step in 1..=count {
            let level = sign * step;
            before = match before {
                Ok(from) => {
                    let found = next(&from, level_load(level));
                    reached += found.as_ref().map_or_else(|why| why.share, |_| 1.0);
                    found
                }
                failed => failed,
            };
            if let Err(why) = &mut before {
                why.share = reached / step as f64;
            }
            side.push(read(level, level_load(level), &before));
        }
    }
    let [mut low, high] = sides;
    low.reverse();
    low.push(read(0, 0.0, &Ok(*at)));
    low.extend(high);
    low
}

/// Returns the loads at a level of a test: a unit load times `factor`, with the trail of the unit load.
fn end_loads(unit: &WheelLoads, factor: f64) -> WheelLoads {
    let mut loads = WheelLoads::none(0.0).plus(unit, factor);
    loads.trail = unit.trail;
    loads
}

/// Returns the secant (mean slope) between the lowest and the highest level of a test, for one wheel. `None` if one of
/// these levels has no equilibrium.
fn secant(levels: &[KcLevel], wheel: usize) -> Option<WheelFigures> {
    let (low, high) = (levels.first()?, levels.last()?);
    let (a, b) = (low.state.as_ref().ok()?, high.state.as_ref().ok()?);
    let with_load = |state: &KcWheelState| WheelFigures {
        vertical: state.wheel_load,
        ..state.figures
    };
    let inverse = 1.0 / (high.load - low.load);
    let [a, b] = [a, b].each(|state| with_load(&state.wheels[wheel]));
    Some(quotient(&a, &b, inverse))
}

/// Returns the secant (mean slope) over a test's window, from the wheel's states at its negative and its positive end.
fn window_secant<T: Scalar>(
    test: &KcTest,
    low: &WheelFigures<T>,
    high: &WheelFigures<T>,
) -> WheelFigures<T> {
    quotient(low, high, low.toe.constant(1.0 / (2.0 * test.window)))
}

/// Difference of two states (second minus first), multiplied by a factor.
fn quotient<T: Scalar>(a: &WheelFigures<T>, b: &WheelFigures<T>, factor: T) -> WheelFigures<T> {
    let of = |a: T, b: T| (b - a) * factor;
    let steering = match (a.steering, b.steering) {
        (Some(a), Some(b)) => Some([0, 1].each(|k| of(a[k], b[k]))),
        _ => None,
    };
    WheelFigures {
        toe: of(a.toe, b.toe),
        camber: of(a.camber, b.camber),
        steering,
        spin: of(a.spin, b.spin),
        centre: (b.centre - a.centre) * factor,
        contact: (b.contact - a.contact) * factor,
        vertical: of(a.vertical, b.vertical),
    }
}

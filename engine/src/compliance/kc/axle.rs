//! Rig tests of both wheels of an axle.
//!
//! Results of a wheel are per unit of the load on that wheel, with the same signs as in a study with one wheel. Results
//! of the axle are per unit of a force to the vehicle's left, or of a moment to the right, at each wheel. Results of a
//! roll test are per roll angle. Steer is positive to the left. With track t, wheel loads F and contact points C (indices
//! l for left and r for right), roll angle and roll moment are
//!
//! ```text
//! phi = atan2(C_r.z - C_l.z, t),   M = t (F_r - F_l)/2                                            (1)
//! ```

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

mod ends;
mod figures;
mod gradients;
mod links;

pub use gradients::FigureGradients;

use super::figures::Sheet;
use super::test::{KcTest, TestLoad};
use super::{
    KcAxleState, KcFigure, KcLevel, KcOutcome, KcState, KcStation, KcSubject, KcWheelState,
    at_stations, end_loads, levels, secant, twist_signs, unit_at_centre, window_secant,
};
use crate::ask::Unit;
use crate::compliance::{
    AxleChange, AxleCompliance, AxleEquilibrium, AxleFault, AxleTangent, ElasticAxle, HeldQuantity,
    NoEquilibrium, WheelFigures, WheelLoads,
};
use crate::model::{Axis, Side, Suspension};
use crate::number::{Each, Scalar, Valued, Vector3};

/// Suspensions and data of the axle under test.
#[derive(Clone, Copy, Debug)]
pub struct AxleVehicle<'a> {
    /// Left and right wheel, each in the kernel's frame of a left wheel.
    pub suspensions: [&'a Suspension; 2],
    /// Rate of the tyre: force per length.
    pub tyre_rate: Option<f64>,
}

/// Tests of an axle.
#[derive(Clone, Debug)]
pub struct AxleKcRun<'a> {
    vehicle: AxleVehicle<'a>,
    designs: [Vec<Vector3<f64>>; 2],
    parts: AxleCompliance,
    axle: ElasticAxle,
}

/// Conditions of a test. The first field is true if the anti-roll bar is connected. The second field is true if the
/// rack is locked.
pub(crate) type Conditions = (bool, bool);

/// Equilibrium at a station, under the conditions of a test, with its tangents.
pub(crate) struct Here<T: Valued = f64> {
    pub(crate) axle: ElasticAxle<T>,
    pub(crate) at: AxleEquilibrium<T>,
    tangents: [Option<Option<AxleTangent<T>>>; 2],
    /// Solid axle without springs and anti-roll bar, and its equilibrium at the same travels. Only its links hold this
    /// axle.
    links: Option<(ElasticAxle<T>, AxleEquilibrium<T>)>,
}

/// Test result, in numbers that can carry derivatives.
#[derive(Clone, Copy)]
pub(crate) struct AxleFigure<T> {
    pub(crate) quantity: &'static str,
    pub(crate) unit: Unit,
    pub(crate) value: Option<T>,
    pub(crate) secant: Option<T>,
    pub(crate) of: KcSubject,
}

impl<T: Scalar> Here<T> {
    fn of(axle: ElasticAxle<T>, at: AxleEquilibrium<T>) -> Self {
        Here {
            axle,
            at,
            tangents: [None, None],
            links: None,
        }
    }

    /// Returns two flags: true if the tangent with held wheel heights, or with held wheel loads, has been computed.
    fn known_tangents(&self) -> [bool; 2] {
        self.tangents.each_ref().map(Option::is_some)
    }

    /// Returns the axle and its tangent, with the wheel heights or the wheel loads held. `None` if the tangent is
    /// singular.
    pub(crate) fn moving(
        &mut self,
        held: HeldQuantity,
    ) -> Option<(&ElasticAxle<T>, &AxleTangent<T>)> {
        let (axle, at) = (&self.axle, &self.at);
        let known = &mut self.tangents[usize::from(held == HeldQuantity::WheelLoad)];
        let tangent = known
            .get_or_insert_with(|| axle.tangent(at, held))
            .as_ref()?;
        Some((axle, tangent))
    }

    /// Returns the derivatives of the angles and positions of both wheels with respect to the input `change`.
    fn by(&mut self, held: HeldQuantity, change: &AxleChange<T>) -> Option<[WheelFigures<T>; 2]> {
        let (axle, tangent) = self.moving(held)?;
        Some(axle.figures_along(tangent, change))
    }

    /// Converts loads to the number type of the station.
    fn loads(&self, loads: &[WheelLoads; 2]) -> AxleChange<T> {
        let like = self.axle.travel(&self.at, Side::Left);
        AxleChange::Loads(loads.each(|load| load.map(|c| like.constant(c))))
    }
}

/// Returns the derivatives of roll angle and roll moment for opposite travels, by equation (1) of this module.
fn roll<T: Scalar>(
    (axle, at): (&ElasticAxle<T>, &AxleEquilibrium<T>),
    by: &[WheelFigures<T>; 2],
) -> [T; 2] {
    let figures = Side::ALL.each(|side| axle.figures(at, side));
    let loads = Side::ALL.each(|side| axle.wheel_load(at, side));
    let track = figures[0].contact.y + figures[1].contact.y;
    let track_by = by[0].contact.y + by[1].contact.y;
    let height = figures[1].contact.z - figures[0].contact.z;
    let height_by = by[1].contact.z - by[0].contact.z;
    let square = track * track + height * height;
    let angle = (height_by * track - height * track_by) / square;
    let (load, load_by) = (loads[1] - loads[0], by[1].vertical - by[0].vertical);
    let moment = track_by * load + track * load_by;
    [angle, moment.scaled(0.5)]
}

impl<'a> AxleKcRun<'a> {
    /// Prepares the tests of an axle.
    pub fn new(vehicle: AxleVehicle<'a>, parts: &AxleCompliance) -> Result<Self, AxleFault> {
        let designs = vehicle.suspensions.each(|wheel| &wheel.design[..]);
        AxleKcRun::of(vehicle, designs, parts)
    }

    /// Prepares the tests, like `new`. The hardpoints of the left and the right wheel are at `designs`.
    pub fn of(
        vehicle: AxleVehicle<'a>,
        designs: [&[Vector3<f64>]; 2],
        parts: &AxleCompliance,
    ) -> Result<Self, AxleFault> {
        Ok(AxleKcRun {
            vehicle,
            axle: ElasticAxle::of(vehicle.suspensions, designs, parts)?,
            designs: designs.map(<[Vector3<f64>]>::to_vec),
            parts: parts.clone(),
        })
    }

    /// Hardpoints of the left and of the right wheel.
    fn designs(&self) -> [&[Vector3<f64>]; 2] {
        [&self.designs[0], &self.designs[1]]
    }

    /// Returns the vertical forces at the contact points that balance elastic parts and springs in the design position.
    /// `None` if the parts are not relaxed at the design load.
    pub fn design_loads(&self) -> Option<[f64; 2]> {
        self.axle.design_loads()
    }

    /// Finds the equilibrium at the design height, with the anti-roll bar connected.
    pub fn at_design(&self) -> Result<KcState, NoEquilibrium> {
        let at = self.axle.at([0.0; 2], 0.0)?;
        Ok(self.state(&self.axle, &at))
    }

    /// Returns the elastic parts of the axle under the conditions of a test.
    fn parts_of(&self, (has_bar, locks_rack): Conditions) -> AxleCompliance {
        let mut parts = self.parts.clone();
        if !has_bar {
            parts.bar_rate = None;
        }
        if locks_rack {
            (parts.rack_rate, parts.column) = (None, None);
        }
        parts
    }

    /// Returns the elastic model of the axle, with its bar connected and its rack not locked.
    pub(crate) fn axle(&self) -> &ElasticAxle {
        &self.axle
    }

    /// Makes the axle under the conditions of a test: with or without anti-roll bar, with the rack locked or not.
    fn variant(&self, conditions: Conditions) -> Result<ElasticAxle, AxleFault> {
        let (has_bar, locks_rack) = conditions;
        let keeps_bar = has_bar || self.parts.bar_rate.is_none();
        let keeps_rack = !locks_rack || !self.parts.steering_yields();
        if keeps_bar && keeps_rack {
            Ok(self.axle.clone())
        } else {
            let parts = self.parts_of(conditions);
            ElasticAxle::of(self.vehicle.suspensions, self.designs(), &parts)
        }
    }

    /// Runs the tests at all stations that have tests. A station contains the travels of the left and the right wheel,
    /// and the rack displacement along the study's +y.
    pub fn run(&self, stations: &[([f64; 2], f64)], tests: &[KcTest]) -> Vec<KcStation> {
        let distance =
            |([left, right], rack): &([f64; 2], f64)| left.abs() + right.abs() + rack.abs();
        let mut found = Vec::new();
        for ((travels, rack), here) in at_stations(stations, distance, tests) {
            found.push(self.station(travels, rack, &here));
        }
        found
    }

    /// Sign that converts a displacement along the study's +y to the kernel's +y.
    pub(super) fn along(&self) -> f64 {
        self.vehicle.suspensions[0].frame.sign(Axis::Y)
    }

    /// Finds the equilibrium of a station under the conditions of a test. `tests` are all tests that start from this
    /// equilibrium. The rack displacement is along the kernel's +y.
    pub(crate) fn here<'t>(
        &self,
        conditions: Conditions,
        travels: [f64; 2],
        rack: f64,
        tests: impl IntoIterator<Item = &'t KcTest>,
    ) -> Result<Here, NoEquilibrium> {
        let axle = self.variant(conditions);
        let axle = axle.map_err(|fault| NoEquilibrium::without_model(fault.describe()))?;
        let at = axle.at(travels, rack)?;
        // Only the roll test needs the axle without springs and anti-roll bar.
        let rolls = tests.into_iter().any(|test| test.load == TestLoad::Roll);
        let alone = rolls.then(|| axle.on_its_links()).flatten();
        let links = alone.and_then(|links| {
            let at = links.at(travels, rack).ok()?;
            Some((links, at))
        });
        Ok(Here {
            links,
            ..Here::of(axle, at)
        })
    }

    fn station(&self, travels: [f64; 2], rack: f64, tests: &[KcTest]) -> KcStation {
        let mut known: Vec<(Conditions, Result<Here, NoEquilibrium>)> = Vec::new();
        let mut outcomes = Ok(Vec::new());
        let (mut matrix, mut centre_distance) = (None, None);
        for (number, test) in tests.iter().enumerate() {
            let conditions = test.conditions();
            if !known.iter().any(|(of, _)| *of == conditions) {
                let own = tests.iter().filter(|test| test.conditions() == conditions);
                let rack = self.along() * rack;
                known.push((conditions, self.here(conditions, travels, rack, own)));
            }
            let Some((_, here)) = known.iter_mut().find(|(of, _)| *of == conditions) else {
                continue;
            };
            match (here, &mut outcomes) {
                (Ok(here), Ok(outcomes)) => {
                    if number == 0 {
                        matrix = self.matrix(here);
                        let centre = |side| here.axle.figures(&here.at, side).centre.y;
                        centre_distance = Some(centre(Side::Left) + centre(Side::Right));
                    }
                    outcomes.push(self.outcome(here, test));
                }
                (Err(why), outcomes) => *outcomes = Err(why.clone()),
                (Ok(_), Err(_)) => {}
            }
        }
        let vehicle = &self.vehicle.suspensions[0].vehicle;
        KcStation {
            travel: travels[0],
            right_travel: Some(travels[1]),
            rack,
            outcomes,
            tests: tests
                .iter()
                .map(|test| (*test, test.unit_load(vehicle).1))
                .collect(),
            matrix,
            centre_distance,
        }
    }

    /// Collects the data for the results of a wheel. Both wheels use the axes of the left wheel's study, because both
    /// wheels share the rack.
    fn sheet(&self, side: Side, has_axis: bool) -> Sheet<'_> {
        Sheet {
            suspension: self.vehicle.suspensions[0],
            side,
            is_rigid: self.parts.is_rigid(),
            has_axis,
            tyre_rate: self.vehicle.tyre_rate,
        }
    }

    fn outcome(&self, here: &mut Here, test: &KcTest) -> KcOutcome {
        let (load, place) = test.unit_load(&self.vehicle.suspensions[0].vehicle);
        let factors = test.factors();
        let loads = |force: f64| factors.each(|factor| end_loads(&load, force * factor));
        let levels = if test.has_levels() {
            let (axle, at) = (&here.axle, &here.at);
            let next = |from: &AxleEquilibrium, force: f64| {
                axle.loaded_about(at, from, &loads(force), test.held)
            };
            let read = |level, load, at: &Result<AxleEquilibrium, NoEquilibrium>| KcLevel {
                level,
                load,
                state: at.clone().map(|at| self.state(axle, &at)),
            };
            levels(at, test, next, read)
        } else {
            Vec::new()
        };
        let secants = if levels.is_empty() {
            None
        } else {
            secant(&levels, 0)
                .zip(secant(&levels, 1))
                .map(|(l, r)| [l, r])
        };
        let figures = self.figures(here, test, secants);
        let figures = figures.into_iter().map(|figure| KcFigure {
            quantity: figure.quantity,
            unit: figure.unit,
            value: figure.value,
            secant: figure.secant,
            of: figure.of,
        });
        KcOutcome {
            test: *test,
            place,
            figures: figures.collect(),
            levels,
        }
    }

    /// Returns the names of the results of a test, with their units and the wheel or axle. The results of the wheels come
    /// first.
    pub fn quantities(&self, test: &KcTest) -> Vec<(&'static str, Unit, KcSubject)> {
        let mut here = Here::of(self.axle.clone(), self.axle.unsolved());
        let figures = self.figures(&mut here, test, None).into_iter();
        figures.map(|f| (f.quantity, f.unit, f.of)).collect()
    }

    /// Returns the secants (mean slopes) of both wheels over the window of a test. `None` if there is no equilibrium at
    /// an end of the window.
    pub(crate) fn window_secants(&self, here: &Here, test: &KcTest) -> Option<[WheelFigures; 2]> {
        let (low, high) = (self.end(here, test, -1.0)?, self.end(here, test, 1.0)?);
        Some(Side::ALL.each(|side| {
            let figures = |at: &AxleEquilibrium| here.axle.figures_with_load(at, side);
            window_secant(test, &figures(&low), &figures(&high))
        }))
    }

    /// Finds the equilibrium at the negative or the positive end of a test's window.
    fn end(&self, here: &Here, test: &KcTest, sign: f64) -> Option<AxleEquilibrium> {
        let (load, _) = test.unit_load(&self.vehicle.suspensions[0].vehicle);
        let force = sign * test.window;
        let factors = test.factors();
        let loads = factors.each(|factor| end_loads(&load, force * factor));
        let (axle, at) = (&here.axle, &here.at);
        axle.loaded_about(at, at, &loads, test.held).ok()
    }

    fn state(&self, axle: &ElasticAxle, at: &AxleEquilibrium) -> KcState {
        let wheel = |side: Side| KcWheelState {
            figures: axle.figures(at, side),
            wheel_load: axle.wheel_load(at, side),
            spring: axle.spring(at, side),
            bushings: axle.bushings(at, side),
            tensions: axle.tensions(at, side),
        };
        let wheels: Vec<KcWheelState> = Side::ALL.into_iter().map(wheel).collect();
        let along = self.along();
        KcState {
            axle: Some(KcAxleState {
                mean_steer: 0.5 * (wheels[1].figures.toe - wheels[0].figures.toe),
                rack_force: along * axle.rack_force(at),
                bar_torque: axle.bar_torque(at),
            }),
            wheels,
        }
    }

    /// Compliance matrix of both wheel centres, in the study's axes.
    fn matrix(&self, here: &mut Here) -> Option<Vec<Vec<f64>>> {
        let frame = self.vehicle.suspensions[0].frame;
        let signs = [twist_signs(frame), twist_signs(frame.of_other_side())];
        let (axle, tangent) = here.moving(HeldQuantity::WheelLoad)?;
        let mut matrix = vec![vec![0.0; 12]; 12];
        for column in 0..12 {
            let (side, component) = (column / 6, column % 6);
            let mut loads = [WheelLoads::none(0.0); 2];
            loads[side] = unit_at_centre(component);
            let twists = axle.twists_along(tangent, &loads);
            let rows = twists
                .iter()
                .flatten()
                .flat_map(|v: &Vector3<f64>| v.to_array());
            for (row, value) in rows.enumerate() {
                let sign = signs[row / 6][row % 6] * signs[side][component];
                matrix[row][column] = Some(value * sign).filter(|value| value.is_finite())?;
            }
        }
        Some(matrix)
    }
}

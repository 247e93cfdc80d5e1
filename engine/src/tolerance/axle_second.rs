//! Second-order result for an axle, exact.
//!
//! Along a direction of the parts, both built designs, their poses and the readings are series in one number, as for one
//! wheel (module `expansion`). In addition, the ground condition f = h_l - h_r = 0 holds order by order. If the roll angle
//! is given, the travels z +- s(e) follow; if both travels are given, the roll angle follows:
//!
//! ```text
//! s_k = -f_k/(n.C_l' + n.C_r')        phi_k = -f_k/track
//! ```
//!
//! with f_k the coefficient that remains after the lower orders. Quantities that contain velocities are left out.
//!
//! In a solid axle, C_b' is the velocity by the wheel's own share of the difference of travels, and the mean travel is held. In a
//! steered solid axle, the steering gear also moves the drag link's end in the series.
//!
//! Positions at a load have no second-order result.

use super::Problem;
use super::expansion::combined;
use crate::assembly::{Built, Rest, SetUpError};
use crate::axle::{
    AxleSolver, AxleState, Carriers, Hold, Parts, Placement, Quantity, Reading, Snapshot, displace,
};
use crate::derive::pose_series;
use crate::evaluate::AxleStations;
use crate::linear::lu::Lu6;
use crate::mechanism::{Closure, Configuration, Driver, Ground, Pose};
use crate::model::{Side, SteeringAxis};
use crate::number::{Jet, Vector3};
use crate::study::Source;
use std::borrow::Cow;

type Series = Jet<f64, 3>;

/// Largest number of series of poses of both wheels: seconds of work.
const MOST_SERIES: usize = 300_000;

/// Second-order terms of the mean and of the variance, by cell.
pub(super) fn second(
    problem: &Problem,
    stations: &AxleStations,
) -> Result<Vec<[f64; 2]>, SetUpError> {
    let mechanism = &stations.axle.left.mechanism;
    let is_readable = |quantity: &Quantity| {
        let by_screw = mechanism.steering_axis == Some(SteeringAxis::Instantaneous)
            && matches!(quantity, Quantity::Corner(_, c) if c.info().reads_steering_axis());
        quantity.rate_order() == 0 && !by_screw
    };
    let readable: Vec<bool> = stations.quantities.iter().map(is_readable).collect();
    let count = problem.tolerance.sources();
    let work = count.saturating_mul(count + 1) / 2 * stations.placements.len();
    let positions = if work <= MOST_SERIES && readable.contains(&true) {
        Some(DrawnPositions::of(problem, stations)?)
    } else {
        None
    };
    let second_derivatives =
        positions.map(|positions| move |along: &[&Source]| positions.second_derivatives(along));
    Ok(combined(problem, &readable, second_derivatives))
}

/// Poses of the nominal axle.
struct DrawnPositions<'p> {
    problem: &'p Problem<'p>,
    stations: &'p AxleStations<'p>,
    built: Vec<Built>,
    parts: Parts,
    positions: Vec<Option<DrawnPosition>>,
}

/// A wheel of a design as series.
struct WheelSeries<'d> {
    design: Cow<'d, [Vector3<Series>]>,
    closure: Closure<Series>,
    /// Parts of drive and rack that come from the rotation of the knuckles.
    lifts: [Series; 2],
}

/// A pose of the nominal axle, with data for its series.
struct DrawnPosition {
    /// Drive and rack of each wheel, in its own frame.
    coordinates: [(f64, f64); 2],
    roll: f64,
    /// Displacement of the rack or of the steering gear.
    rack: f64,
    hold: Hold,
    /// Slopes n.C_l' + n.C_r' and track, for the ground condition.
    slopes: [f64; 2],
    wheels: [(Pose<f64>, Lu6<f64>); 2],
    /// True for each quantity that has a value here.
    has_value: Vec<bool>,
}

impl<'p> DrawnPositions<'p> {
    fn of(problem: &'p Problem, stations: &'p AxleStations) -> Result<Self, SetUpError> {
        let axle = &stations.axle;
        let mut built = Vec::new();
        for wheel_assembler in &problem.wheel_assemblers {
            let assembler = &wheel_assembler.assembler;
            built.push(assembler.build(assembler.drawn(), Rest::Height(0.0))?);
        }
        // First derivatives of both wheels are needed for the slopes of the ground condition.
        let solver = AxleSolver::<2>::new(axle, &stations.quantities, false);
        let mut solver = solver.map_err(|(_, fault)| SetUpError::Fault(fault))?;
        let placed = solver.place_all(&stations.placements);
        let position = |(placement, placed): (&Placement, Result<crate::axle::AxlePose, _>)| {
            // The mean travel at a load changes with forces, whose second derivatives are not computed.
            let placed = placed
                .ok()
                .filter(|_| !matches!(placement, Placement::AtLoad { .. }))?;
            let read = solver.read(&placed).ok()?;
            let [left_factors, right_factors] = solver.factorised(&placed)?;
            let [left_pose, right_pose] = *placed.poses();
            let [left, right] = read.state.wheels().map(|wheel| wheel.rise());
            let has_value = |quantity: &Quantity| read.value(*quantity).is_ok();
            Some(DrawnPosition {
                coordinates: solver.coordinates(placed.travels, placed.rack),
                roll: placed.roll,
                rack: placed.rack,
                hold: placed.hold,
                slopes: [left + right, read.state.track()],
                wheels: [(left_pose, left_factors), (right_pose, right_factors)],
                has_value: stations.quantities.iter().map(has_value).collect(),
            })
        };
        let placements = stations.placements.iter();
        let positions = placements.zip(placed).map(position).collect();
        let slots: Vec<_> = stations
            .quantities
            .iter()
            .flat_map(|q| q.info().reads)
            .copied()
            .collect();
        Ok(DrawnPositions {
            problem,
            stations,
            built,
            parts: Parts::of(&slots, Carriers::of(axle)),
            positions,
        })
    }

    /// Second derivative along the sum of some sources' directions, each scaled by its standard deviation. One entry for
    /// each cell.
    fn second_derivatives(&self, along: &[&Source]) -> Vec<f64> {
        let wheel_assemblers = self.problem.wheel_assemblers.iter().zip(&self.built);
        let designs: Vec<Vec<Vector3<Series>>> = wheel_assemblers
            .map(|(wheel_assembler, built)| wheel_assembler.series(built, along))
            .collect();
        let wheels = self.wheels(&designs);
        let mut second_derivatives = vec![f64::NAN; self.problem.cells()];
        for (station, position) in self.positions.iter().enumerate() {
            let Some(position) = position else {
                continue;
            };
            let steered = self.steered(&wheels, position.rack);
            let state = self.on_ground(position, &steered);
            for (output, quantity) in self.stations.quantities.iter().enumerate() {
                if position.has_value[output] && quantity.rate_order() == 0 {
                    let value = quantity.evaluate(&state).derivative(2);
                    second_derivatives[self.problem.cell(output, station)] = value;
                }
            }
        }
        second_derivatives
    }

    /// Both wheels of designs, with the steering gear at rest.
    fn wheels<'d>(&self, designs: &'d [Vec<Vector3<Series>>]) -> [WheelSeries<'d>; 2] {
        Side::ALL.map(|side| {
            let design = &designs[side as usize][..];
            WheelSeries {
                design: Cow::Borrowed(design),
                closure: Closure::new(&self.stations.axle.suspension(side).mechanism, design),
                lifts: [Jet([0.0; 3]); 2],
            }
        })
    }

    /// Both wheels with the steering gear of a steered axle at this displacement.
    fn steered<'d>(
        &self,
        wheels: &'d [WheelSeries<'_>; 2],
        displacement: f64,
    ) -> [WheelSeries<'d>; 2] {
        Side::ALL.map(|side| {
            let mechanism = &self.stations.axle.suspension(side).mechanism;
            let WheelSeries {
                design,
                closure,
                lifts,
            } = &wheels[side as usize];
            if mechanism.axle_steering().is_none() {
                return WheelSeries {
                    design: Cow::Borrowed(design),
                    closure: closure.clone(),
                    lifts: *lifts,
                };
            }
            let mut design = design.to_vec();
            let gear = Jet::constant(displacement);
            let lifts = displace(mechanism, &mut design, gear);
            let closure = Closure::new(mechanism, &design);
            WheelSeries {
                design: Cow::Owned(design),
                closure,
                lifts,
            }
        })
    }

    /// State of the axle as series in which the ground condition holds to every order.
    fn on_ground(
        &self,
        position: &DrawnPosition,
        wheels: &[WheelSeries<'_>; 2],
    ) -> AxleState<'_, Series> {
        let zero = Jet([0.0; 3]);
        let (mut apart, mut turn) = (zero, zero);
        let mut state = self.state(position, wheels, apart, turn);
        let [rise, track] = position.slopes;
        for order in 1..3 {
            let left_over = state.mismatch()[order];
            match position.hold {
                Hold::TravelsOnPads => return state,
                Hold::MeanTravel => apart.0[order] = -left_over / rise,
                Hold::TravelsOnPlane => turn.0[order] = -left_over / track,
            }
            state = self.state(position, wheels, apart, turn);
        }
        state
    }

    /// State of the axle with the travels changed by +-`apart` and the ground rotated by `turn`.
    fn state(
        &self,
        position: &DrawnPosition,
        wheels: &[WheelSeries<'_>; 2],
        apart: Series,
        turn: Series,
    ) -> AxleState<'_, Series> {
        let axle = &self.stations.axle;
        let reading = |side: Side| {
            let number = side as usize;
            let sign = side.sign();
            let mechanism = &axle.suspension(side).mechanism;
            let (pose, factors) = &position.wheels[number];
            let (travel, rack) = position.coordinates[number];
            let WheelSeries {
                design,
                closure,
                lifts: [drive_lift, rack_lift],
            } = &wheels[number];
            let rack = Jet::constant(rack) - *rack_lift;
            let travel = Jet::constant(travel) + apart * Jet::constant(sign);
            let driver = Driver::Travel(travel - *drive_lift);
            let pose = pose_series(mechanism, design, closure, factors, pose, driver, rack);
            let at = Configuration::new(mechanism, design, pose, rack);
            Reading::without_rates(&Snapshot::of(&at, &self.parts))
        };
        let (sine, cosine) = position.roll.sin_cos();
        let [sine, cosine] = [sine, cosine].map(Series::constant);
        // Cosine to second order.
        let upright = Series::constant(1.0) - turn * turn * Series::constant(0.5);
        AxleState {
            readings: [reading(Side::Left), reading(Side::Right)],
            ground: Ground {
                sine: sine * upright + cosine * turn,
                cosine: cosine * upright - sine * turn,
            },
            roll: Series::constant(position.roll) + turn,
            hold: position.hold,
            carriers: Carriers::of(axle),
            setup: &axle.setup,
        }
    }
}

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

use super::Problem;
use super::expansion::combined;
use crate::assembly::{Built, Rest, SetUpError};
use crate::axle::{AxleSolver, AxleState, Carriers, Hold, Parts, Quantity, Reading, Snapshot};
use crate::derive::{MotionPoint, pose_series};
use crate::evaluate::AxleStations;
use crate::linear::lu::Lu6;
use crate::mechanism::{Closure, Configuration, Driver, Ground, Pose};
use crate::model::{Drive, Side, SteeringAxis};
use crate::number::{Jet, Vector3};
use crate::solve::Solver;
use crate::study::Source;

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
    let positions = match work <= MOST_SERIES && readable.contains(&true) {
        true => Some(DrawnPositions::of(problem, stations)?),
        false => None,
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

/// A pose of the nominal axle, with data for its series.
struct DrawnPosition {
    travels: [f64; 2],
    roll: f64,
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
        let mut solvers = Vec::new();
        for (side, wheel_assembler) in Side::ALL.into_iter().zip(&problem.wheel_assemblers) {
            let assembler = &wheel_assembler.assembler;
            built.push(assembler.build(assembler.drawn(), Rest::Height(0.0))?);
            let suspension = axle.suspension(side);
            let solver = Solver::new(&suspension.mechanism, &suspension.design);
            solvers.push(solver.map_err(SetUpError::Fault)?);
        }
        // First derivatives of both wheels are needed for the slopes of the ground condition.
        let solver = AxleSolver::<2>::new(axle, &stations.quantities, false);
        let mut solver = solver.map_err(|(_, fault)| SetUpError::Fault(fault))?;
        let placed = solver.place_all(&stations.placements);
        let position = |placed: Result<crate::axle::AxlePose, _>| {
            let placed = placed.ok()?;
            let read = solver.read(&placed).ok()?;
            let wheel = |side: Side| {
                let point = MotionPoint {
                    drive: Drive::Travel,
                    value: placed.travels[side as usize],
                    rack: placed.rack * side.sign(),
                };
                let pose = placed.poses()[side as usize];
                Some((pose, solvers[side as usize].factorise(&pose, &point)?))
            };
            let [left, right] = read.state.wheels().map(|wheel| wheel.rise());
            let has_value = |quantity: &Quantity| read.value(*quantity).is_ok();
            Some(DrawnPosition {
                travels: placed.travels,
                roll: placed.roll,
                rack: placed.rack,
                hold: placed.hold,
                slopes: [left + right, read.state.track()],
                wheels: [wheel(Side::Left)?, wheel(Side::Right)?],
                has_value: stations.quantities.iter().map(has_value).collect(),
            })
        };
        let positions = placed.into_iter().map(position).collect();
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
            parts: Parts::of(&slots, Carriers::Independent),
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
        let closures: Vec<Closure<Series>> = Side::ALL
            .into_iter()
            .zip(&designs)
            .map(|(side, design)| {
                Closure::new(&self.stations.axle.suspension(side).mechanism, design)
            })
            .collect();
        let mut second_derivatives = vec![f64::NAN; self.problem.cells()];
        for (station, position) in self.positions.iter().enumerate() {
            let Some(position) = position else {
                continue;
            };
            let state = self.on_ground(position, &designs, &closures);
            for (output, quantity) in self.stations.quantities.iter().enumerate() {
                if position.has_value[output] && quantity.rate_order() == 0 {
                    let value = quantity.evaluate(&state).derivative(2);
                    second_derivatives[self.problem.cell(output, station)] = value;
                }
            }
        }
        second_derivatives
    }

    /// State of the axle as series in which the ground condition holds to every order.
    fn on_ground(
        &self,
        position: &DrawnPosition,
        designs: &[Vec<Vector3<Series>>],
        closures: &[Closure<Series>],
    ) -> AxleState<'_, Series> {
        let zero = Jet([0.0; 3]);
        let (mut apart, mut turn) = (zero, zero);
        let mut state = self.state(position, designs, closures, apart, turn);
        let [rise, track] = position.slopes;
        for order in 1..3 {
            let left_over = state.mismatch()[order];
            match position.hold {
                Hold::TravelsOnPads => return state,
                Hold::MeanTravel => apart.0[order] = -left_over / rise,
                Hold::TravelsOnPlane => turn.0[order] = -left_over / track,
            }
            state = self.state(position, designs, closures, apart, turn);
        }
        state
    }

    /// State of the axle with the travels changed by +-`apart` and the ground rotated by `turn`.
    fn state(
        &self,
        position: &DrawnPosition,
        designs: &[Vec<Vector3<Series>>],
        closures: &[Closure<Series>],
        apart: Series,
        turn: Series,
    ) -> AxleState<'_, Series> {
        let axle = &self.stations.axle;
        let reading = |side: Side| {
            let number = side as usize;
            let sign = side.sign();
            let mechanism = &axle.suspension(side).mechanism;
            let (pose, factors) = &position.wheels[number];
            let rack = Jet::constant(position.rack * sign);
            let travel = Jet::constant(position.travels[number]) + apart * Jet::constant(sign);
            let (design, closure) = (&designs[number], &closures[number]);
            let driver = Driver::Travel(travel);
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
            carriers: Carriers::Independent,
            setup: &axle.setup,
        }
    }
}

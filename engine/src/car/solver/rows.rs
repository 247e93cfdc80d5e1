//! Solver for several rows of a map of cases at the same time. In a row, each case starts from its neighbour.
//!
//! The first state of a row is solved alone. Then the row gets a SIMD lane ([`super::lanes`]). The start of a state is
//! extrapolated from the last states of its row by a polynomial. The first inverse tangent of a state is the inverse
//! tangent after the previous state of its row. So the results of a row depend on other rows only by rounding errors: all
//! rows share the curves of the wheels. A row leaves its lane, and the solver solves its next case alone, if
//!
//! - a wheel has no curve, or a step is not finite or too long,
//! - the iteration does not converge,
//! - the set of wheels in contact would change,
//! - the body or a wheel would move too far from the last state,
//! - the settings, the racks or the yaw acceleration of the case differ from the cases in the other lanes.
//!
//! For every [`VERIFIED`]-th state of a row, and for its last state in a lane, the solver computes the exact tangent.
//! This state must meet condition (2) of [`super::super::stability`]. Otherwise all states since the last state with a
//! tangent are solved again, alone.

use super::super::equations::{Held, LOADS, TRAVELS, UNKNOWNS, masses, static_loads};
use super::super::parameters::Parameters;
use super::super::tangent::{Factors, tangent};
use super::super::{Case, GRAVITY, NoEquilibrium};
use super::lanes::{Lanes, OF_CASE, Shared, Step};
use super::newton::ROUNDING;
use super::{CarSolver, Equilibrium, LONGEST_TRAVEL, LONGEST_TURN};
use crate::axle::{CURVE_LANES, CurveLanes, CurveWheel};
use crate::number::{Vector3, Width, array_of};

/// Number of states from one exact tangent to the next exact tangent.
const VERIFIED: usize = 8;
/// Largest number of steps of the unknowns for one state.
const MOST_STEPS: usize = 10;
/// Largest step of the unknowns, relative to their typical sizes.
const LONGEST: f64 = 0.1;
/// Only rounding error remains if steps no longer become shorter, and one of them was below this limit.
const STILL: f64 = 1e-12;
/// Number of earlier states of a row from which the initial unknowns of the next state are extrapolated.
const POINTS: usize = 3;

/// A state of a row.
#[derive(Clone, Debug)]
pub struct RowState {
    /// Equilibrium. A state from a SIMD lane may differ from the result of [`CarSolver::solve`] by rounding errors.
    pub found: Equilibrium,
    /// Components of each wheel load: elastic, geometric, longitudinal, unsprung.
    pub parts: [[f64; 4]; 4],
    /// True if the state was solved in a SIMD lane.
    pub is_from_lane: bool,
}

/// Result for one case in a row: its state, or the reason why it has no equilibrium.
pub type RowResult = Result<RowState, NoEquilibrium>;

/// A state from a SIMD lane that is not confirmed by a tangent yet: its unknowns, and the components of the wheel
/// loads.
type Pending = ([f64; UNKNOWNS], [[f64; 4]; 4]);

/// A row of cases while the solver works on it.
struct Row<'c> {
    cases: &'c [Case],
    /// Index of the next case.
    next: usize,
    /// Last state with a tangent.
    at: Option<Equilibrium>,
    /// States after the last state with a tangent, in order. They are not confirmed yet.
    pending: Vec<Pending>,
    /// Unknowns of the last states, starting with the latest.
    points: [[f64; UNKNOWNS]; POINTS],
    /// Number of states in `points`.
    known: usize,
    is_in_lane: bool,
}

/// Inputs that all rows of a block share. The solver solves the rows of a block at the same time.
struct Block<'c> {
    case: &'c Case,
    parameters: Parameters<f64>,
    sprung: (f64, Vector3<f64>),
    static_loads: [f64; 2],
    lanes: Box<Lanes>,
}

impl<'c> Row<'c> {
    fn of(cases: &'c [Case]) -> Self {
        Row {
            cases,
            next: 0,
            at: None,
            pending: Vec::with_capacity(VERIFIED),
            points: [[0.0; UNKNOWNS]; POINTS],
            known: 0,
            is_in_lane: false,
        }
    }

    fn case(&self) -> Option<&'c Case> {
        self.cases.get(self.next)
    }

    /// Records the unknowns of the latest state.
    fn record(&mut self, x: [f64; UNKNOWNS]) {
        self.points.rotate_right(1);
        self.points[0] = x;
        self.known = (self.known + 1).min(POINTS);
    }

    /// Returns the start of the next state, extrapolated by the polynomial through the last states.
    fn start(&self) -> [f64; UNKNOWNS] {
        let [a, b, c] = &self.points;
        array_of(|k| match self.known {
            1 => a[k],
            2 => 2.0 * a[k] - b[k],
            _ => 3.0 * (a[k] - b[k]) + c[k],
        })
    }
}

/// Returns true if only rounding error remains after a step. Convergence becomes faster from step to step. So the next
/// step is at most ten times the square of this step, divided by the shortest step before it.
fn is_last(step: f64, shortest: f64) -> bool {
    let next = 10.0 * step / shortest * step;
    let is_still = step >= shortest && shortest <= STILL;
    step <= ROUNDING || (shortest.is_finite() && next <= ROUNDING) || is_still
}

/// Returns true if the same lanes can solve both cases.
fn fits(case: &Case, other: &Case) -> bool {
    case.setting == other.setting
        && case.racks == other.racks
        && case.yaw_acceleration == other.yaw_acceleration
}

impl Block<'_> {
    /// Puts a row of cases into a SIMD lane: copies the inverse tangent of the row's latest state into the lane. `factors` are
    /// the LU factors of this tangent.
    fn enter(&mut self, lane: usize, factors: &Factors) {
        for (rows, row) in self.lanes.inverse.iter_mut().zip(factors.inverse()) {
            for (numbers, number) in rows.iter_mut().zip(row) {
                numbers[lane] = number;
            }
        }
    }

    /// Puts the next case of a row into the lane of this row.
    fn begin(&mut self, lane: usize, case: &Case, start: [f64; UNKNOWNS]) {
        let lanes = &mut *self.lanes;
        for (numbers, number) in lanes.x.iter_mut().zip(start) {
            numbers[lane] = number;
        }
        let of_case = [case.ax, case.ay, case.az, case.speed];
        debug_assert_eq!(of_case.len(), OF_CASE.len());
        for (numbers, number) in lanes.of_case.iter_mut().zip(of_case) {
            numbers[lane] = number;
        }
        lanes.active[lane] = 1.0;
    }

    /// Returns the unknowns in a lane.
    fn unknowns(&self, lane: usize) -> [f64; UNKNOWNS] {
        array_of(|k| self.lanes.x[k][lane])
    }
}

impl<'a> CarSolver<'a> {
    /// Finds the states of several rows of cases at the same time. For each state, the function calls `take` with the
    /// index of the row, the index of the case in the row, and the state. The cases of a row come in their order.
    pub fn solve_rows(
        &mut self,
        rows: &[&[Case]],
        take: &mut dyn FnMut(&mut Self, [usize; 2], RowResult),
    ) {
        let mut first = 0;
        for block in Self::blocks_of(rows) {
            self.solve_block(block, &mut |solver, [row, case], state| {
                take(solver, [first + row, case], state);
            });
            first += block.len();
        }
    }

    /// Splits rows into blocks. [`CarSolver::solve_rows`] solves the rows of a block at the same time. The results of a
    /// row depend on other rows only by rounding errors.
    pub fn blocks_of<'r, 'c>(rows: &'r [&'c [Case]]) -> impl Iterator<Item = &'r [&'c [Case]]> {
        let alike = |a: &&[Case], b: &&[Case]| match (a.first(), b.first()) {
            (Some(a), Some(b)) => fits(a, b),
            _ => false,
        };
        let alike = rows.chunk_by(alike);
        alike.flat_map(|rows| rows.chunks(CURVE_LANES))
    }

    fn solve_block(
        &mut self,
        rows: &[&[Case]],
        take: &mut dyn FnMut(&mut Self, [usize; 2], RowResult),
    ) {
        let mut rows: Vec<Row<'_>> = rows.iter().map(|cases| Row::of(cases)).collect();
        let mut block: Option<Block<'_>> = None;
        let most = rows.iter().map(|row| row.cases.len()).max().unwrap_or(0);
        for column in 0..most {
            if let Some(block) = &mut block {
                self.in_lanes(block, &mut rows);
            }
            for (number, row) in rows.iter_mut().enumerate() {
                // The SIMD lanes solve one case of each row that is in a lane. A row outside the lanes has not solved its case with
                // the index `column` yet. So this case is solved alone.
                if row.next <= column && row.case().is_some() {
                    self.confirm(&mut block, (number, row), take);
                    self.alone(&mut block, (number, row), take);
                } else if row.pending.len() == VERIFIED {
                    self.confirm(&mut block, (number, row), take);
                }
            }
        }
        for (number, row) in rows.iter_mut().enumerate() {
            self.confirm(&mut block, (number, row), take);
        }
    }

    /// Solves the next case of every row that has a lane. If a case stays unsolved, its row leaves the lane.
    fn in_lanes(&mut self, block: &mut Block<'_>, rows: &mut [Row<'_>]) {
        block.lanes.active = [0.0; CURVE_LANES];
        let mut smallest = [f64::INFINITY; CURVE_LANES];
        let mut is_open = [false; CURVE_LANES];
        for (lane, row) in rows.iter_mut().enumerate() {
            let Some(case) = row.case() else { continue };
            row.is_in_lane &= fits(block.case, case);
            if row.is_in_lane {
                block.begin(lane, case, row.start());
                is_open[lane] = true;
            }
        }
        for number in 0..MOST_STEPS {
            for (lane, row) in rows.iter_mut().enumerate() {
                if is_open[lane] && self.read_lane(block, lane).is_none() {
                    (is_open[lane], row.is_in_lane) = (false, false);
                    block.lanes.active[lane] = 0.0;
                }
            }
            if !is_open.contains(&true) {
                return;
            }
            let step = Step {
                shared: Shared {
                    held: Held {
                        car: self.car,
                        case: block.case,
                        lifted: [false; 4],
                    },
                    parameters: &block.parameters,
                    sprung: block.sprung,
                    static_loads: block.static_loads,
                },
                is_first: number == 0,
                lanes: &mut block.lanes,
            };
            let is_solved = Width::run_in_avx2(step).is_ok();
            for (lane, row) in rows.iter_mut().enumerate() {
                if !is_open[lane] {
                    continue;
                }
                let longest = block.lanes.longest[lane];
                let is_end = is_last(longest, smallest[lane]);
                let fails = !is_solved || longest.is_nan() || longest > LONGEST;
                if fails || is_end {
                    is_open[lane] = false;
                    block.lanes.active[lane] = 0.0;
                    row.is_in_lane = !fails && self.keeps_contact(row, &block.unknowns(lane));
                    if row.is_in_lane {
                        let x = block.unknowns(lane);
                        let parts = block.lanes.parts;
                        let parts = array_of(|wheel| array_of(|k| parts[wheel][k][lane]));
                        row.pending.push((x, parts));
                        row.record(x);
                        row.next += 1;
                    }
                }
                smallest[lane] = smallest[lane].min(longest);
            }
        }
        for (lane, row) in rows.iter_mut().enumerate() {
            row.is_in_lane &= !is_open[lane];
        }
    }

    /// Computes the wheels of a lane from their curves. `None` if a wheel has no curve there.
    fn read_lane(&mut self, block: &mut Block<'_>, lane: usize) -> Option<()> {
        let curves = self.curves.as_mut()?;
        let mut wheel = CurveWheel::unknown();
        for (number, curve) in curves.iter_mut().enumerate() {
            let axle = number / 2;
            let at = [
                block.lanes.x[TRAVELS + number][lane],
                block.case.racks[axle],
            ];
            curve.at(&mut self.axles[axle], at, &mut wheel)?;
            block.lanes.wheels[number].set(lane, &wheel);
        }
        Some(())
    }

    /// Returns true if all wheels stay on the ground in a new state, and body and wheels move little from the last
    /// state.
    fn keeps_contact(&self, row: &Row<'_>, x: &[f64; UNKNOWNS]) -> bool {
        let before = &row.points[0];
        let travel = LONGEST_TRAVEL * self.car.per_metre();
        let limits = [
            LONGEST_TURN,
            LONGEST_TURN,
            travel,
            travel,
            travel,
            travel,
            travel,
        ];
        let is_near = |k: usize| (x[k] - before[k]).abs() <= limits[k];
        x[LOADS..LOADS + 4].iter().all(|load| *load >= 0.0) && (0..LOADS).all(is_near)
    }

    /// Checks the states of a row that were solved in its lane, with the tangent in the last state. If this state is
    /// not stable or has no tangent, all these states are solved again, alone.
    fn confirm<'c>(
        &mut self,
        block: &mut Option<Block<'c>>,
        (number, row): (usize, &mut Row<'c>),
        take: &mut dyn FnMut(&mut Self, [usize; 2], RowResult),
    ) {
        let Some((last, _)) = row.pending.last() else {
            return;
        };
        let count = row.pending.len();
        let first = row.next - count;
        let confirmed = self.with_tangent(&row.cases[row.next - 1], *last);
        let follows = |found: &Equilibrium| {
            let mut before = row.at.iter();
            found.is_stiff() || before.any(|before| found.follows(before, self.car))
        };
        if let Some(last) = confirmed.filter(follows) {
            for k in 0..count {
                let (unknowns, parts) = row.pending[k];
                let found = if k + 1 == count {
                    last.clone()
                } else {
                    Equilibrium {
                        unknowns,
                        lifted: last.lifted,
                        evaluations: 1,
                        racks: last.racks,
                        placed: None,
                        factors: None,
                    }
                };
                let state = RowState {
                    found,
                    parts,
                    is_from_lane: true,
                };
                take(self, [number, first + k], Ok(state));
            }
            row.pending.clear();
            if let (Some(block), Some(factors)) = (block, &last.factors) {
                block.enter(number, factors);
            }
            row.at = Some(last);
            return;
        }
        row.pending.clear();
        row.next = first;
        row.known = 0;
        for _ in 0..count {
            self.alone(block, (number, row), take);
        }
    }

    /// Solves the next case of a row alone. If all wheels are on the ground, the row then gets a lane.
    fn alone<'c>(
        &mut self,
        block: &mut Option<Block<'c>>,
        (number, row): (usize, &mut Row<'c>),
        take: &mut dyn FnMut(&mut Self, [usize; 2], RowResult),
    ) {
        let cases: &'c [Case] = row.cases;
        let case = &cases[row.next];
        let found = match &row.at {
            Some(before) => self.solve_from(case, before),
            None => self.solve(case),
        };
        row.is_in_lane = false;
        let place = [number, row.next];
        row.next += 1;
        let found = found.and_then(|found| {
            let balance = self.balance(case, &found)?;
            let parts = array_of(|wheel| balance.wheels[wheel].parts);
            Ok(RowState {
                found,
                parts,
                is_from_lane: false,
            })
        });
        match &found {
            Ok(RowState { found, .. }) => {
                row.record(found.unknowns);
                row.at = Some(found.clone());
                if block.is_none() {
                    *block = self.block(case, found);
                }
                if let (Some(block), Some(factors)) = (block, &found.factors)
                    && fits(block.case, case)
                    && found.lifted == [false; 4]
                {
                    block.enter(number, factors);
                    row.is_in_lane = true;
                }
            }
            Err(_) => row.known = 0,
        }
        take(self, place, found);
    }

    /// Returns the state of a case with these unknowns and all wheels on the ground, with its tangent. `None` if a
    /// wheel has no curve there, or if the tangent is singular.
    fn with_tangent(&mut self, case: &Case, x: [f64; UNKNOWNS]) -> Option<Equilibrium> {
        let travels = array_of(|k| x[TRAVELS + k]);
        let near = self.near(travels, case.racks)?;
        let held = Held {
            car: self.car,
            case,
            lifted: [false; 4],
        };
        let (_, tangent) = tangent(&near.base(held), &Parameters::of(self.car, case), &x);
        self.spare = Some(near);
        Some(Equilibrium {
            unknowns: x,
            lifted: [false; 4],
            evaluations: 1,
            racks: case.racks,
            placed: None,
            factors: Some(Box::new(Factors::of(&tangent)?)),
        })
    }

    /// Returns the inputs of a block whose cases have the settings of this case. `None` if the wheels have no curves,
    /// or if the processor has no AVX2.
    fn block<'c>(&mut self, case: &'c Case, found: &Equilibrium) -> Option<Block<'c>> {
        if !Width::Avx2.is_available() {
            return None;
        }
        let near = self.near(found.travels(), found.racks)?;
        let parameters = Parameters::of(self.car, case);
        let base = near.base(self.held(case, found));
        let corners = array_of(|number: usize| {
            let travels = [number, number ^ 1].map(|wheel| near.travels[wheel]);
            base.corner(&parameters, number, travels, |c: f64| c)
        });
        let masses = masses(self.car, &parameters, &corners);
        let static_loads = static_loads(self.car, &parameters, &corners, &masses);
        let wheels = near.wheels.each_ref().map(CurveLanes::filled);
        let weight = masses.whole.0 * GRAVITY;
        let scales = array_of(|k| match k {
            0 | 1 => [1.0; CURVE_LANES],
            2..LOADS => [1.0 / self.car.per_metre(); CURVE_LANES],
            _ => [1.0 / weight; CURVE_LANES],
        });
        let block = Block {
            case,
            parameters,
            sprung: masses.sprung,
            static_loads,
            lanes: Box::new(Lanes {
                x: array_of(|k| [found.unknowns[k]; CURVE_LANES]),
                step: [[0.0; CURVE_LANES]; UNKNOWNS],
                inverse: [[[0.0; CURVE_LANES]; UNKNOWNS]; UNKNOWNS],
                scales,
                longest: [0.0; CURVE_LANES],
                parts: [[[0.0; CURVE_LANES]; 4]; 4],
                active: [0.0; CURVE_LANES],
                of_case: [[0.0; CURVE_LANES]; 4],
                wheels,
            }),
        };
        self.spare = Some(near);
        Some(block)
    }
}

//! Equilibria of several wheels at once. Each SIMD lane contains the values of one wheel.
//!
//! Each lane solves the equations of one wheel (`system.rs`) with the convergence check of `solve.rs`. A lane that has
//! converged keeps its state while other lanes continue. So the results of a lane do not depend on the content or the
//! number of the other lanes, to the last bit. In lanes, a product and a following sum are rounded only once. So the
//! results differ from the results of the solver for one wheel by rounding errors.
//!
//! Lanes first try the whole change of travel, rack or loads in one step. If this step fails for a travel and the design
//! position is an equilibrium, they try two, four and eight equal steps. If a lane needs even smaller steps, or its
//! equilibrium is not stable, the lane has no result. The solver for one wheel then solves this wheel from the beginning.

#![expect(
    clippy::needless_range_loop,
    reason = "lanes are named by their numbers"
)]

use super::algebra::Placed;
use super::loads::WheelLoads;
use super::solve::{Bounds, Judge, Solution, Verdict, is_definite_on};
use super::system::{Equations, Hold, MOST_JOINTS, MOST_LIMBS, State, System, Task};
use super::wheel::{ElasticWheel, Equilibrium, HeldQuantity, level_task};
use crate::linear::square::MOST;
use crate::number::{MOST_LANES, SimdReal, Vector3, outlined};
use crate::threads::checkpoint;
use std::cell::{Cell, RefCell};

/// Numbers of equal steps from the design position to a travel. If one number of steps fails, the solver tries the
/// next. These numbers are powers of two, so that the last step ends exactly at the travel.
const PARTS: [usize; 3] = [2, 4, 8];

/// Memory that collects the values of several wheels before they are loaded into SIMD lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct LaneMemory {
    /// Stored values. Each array has one quantity of the wheels, with its value in every SIMD lane. The quantities are
    /// in the order in which the conversion of a wheel visits them.
    numbers: RefCell<Vec<[f64; MOST_LANES]>>,
    /// Index of the next quantity.
    next: Cell<usize>,
}

impl LaneMemory {
    fn begin(&self) {
        self.next.set(0);
    }

    /// Moves to the next quantity and returns its index. The memory grows if necessary.
    fn advance(&self) -> usize {
        let number = self.next.get();
        self.next.set(number + 1);
        let mut numbers = self.numbers.borrow_mut();
        if numbers.len() <= number {
            numbers.resize(number + 1, [0.0; MOST_LANES]);
        }
        number
    }

    /// Writes the value of the next quantity in one lane.
    fn put(&self, lane: usize, value: f64) -> f64 {
        let number = self.advance();
        self.numbers.borrow_mut()[number][lane] = value;
        value
    }

    /// Reads the values of the next quantity in all lanes.
    fn load<B: SimdReal>(&self, like: B) -> B {
        let number = self.advance();
        like.load(&self.numbers.borrow()[number])
    }
}

/// Elastic wheels in SIMD lanes. All wheels have the same kinds of parts, but different values.
pub(crate) struct WheelsInLanes<B> {
    system: System<B>,
    start: State<B>,
    bounds: Bounds,
    /// Number of wheels. The remaining lanes contain copies of the last wheel.
    count: usize,
    /// True if the design position of every wheel is an equilibrium. Otherwise external forces hold a design position at first,
    /// and the solver for one wheel reduces these forces step by step.
    starts_in_balance: bool,
}

/// Equilibria of several wheels, one in each SIMD lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EquilibriaInLanes<B> {
    state: State<B>,
    task: Task<B>,
    /// Number of Newton steps in each lane; `None` for a lane without a result.
    steps: [Option<usize>; MOST_LANES],
    /// Number of parts with their own degrees of freedom.
    limbs: usize,
}

impl ElasticWheel {
    /// Returns true if the parts of this wheel can be solved in SIMD lanes.
    pub(crate) fn fits_lanes(&self) -> bool {
        self.built.system.fits_lanes()
    }
}

impl<B: SimdReal> WheelsInLanes<B> {
    /// Puts wheels into lanes. There must be at least one wheel, and not more wheels than lanes.
    pub(crate) fn of<'w>(
        like: B,
        memory: &LaneMemory,
        wheels: impl ExactSizeIterator<Item = &'w ElasticWheel>,
    ) -> Option<Self> {
        let count = wheels.len();
        let (mut last, mut starts_in_balance) = (None, true);
        for (lane, wheel) in wheels.enumerate() {
            // The lanes after the last wheel contain copies of it.
            let end = if lane + 1 == count {
                B::LANES
            } else {
                lane + 1
            };
            for lane in lane..end {
                memory.begin();
                wheel.built.system.map(|c| memory.put(lane, c));
                wheel.start.map(|c| memory.put(lane, c));
            }
            starts_in_balance &= wheel.starts_in_balance();
            last = Some(wheel);
        }
        let wheel = last?;
        memory.begin();
        Some(WheelsInLanes {
            system: wheel.built.system.map(|_| memory.load(like)),
            start: wheel.start.map(|_| memory.load(like)),
            bounds: wheel.bounds,
            count,
            starts_in_balance,
        })
    }

    fn all(&self) -> [bool; MOST_LANES] {
        let mut all = [false; MOST_LANES];
        all[..self.count].fill(true);
        all
    }

    /// Finds the equilibria with the wheel centres at a height, without horizontal loads, like [`ElasticWheel::at`].
    #[inline(always)]
    pub(crate) fn at(&self, travel: f64, rack: f64) -> EquilibriaInLanes<B> {
        let like = self.start.vertical;
        let task = |share: f64| {
            let (travel, rack) = (travel * share, rack * share);
            level_task(like.constant(travel), like.constant(rack))
        };
        let all = self.all();
        let mut found = self.solved(&self.start, &task(1.0), all);
        if !self.starts_in_balance {
            return found;
        }
        for parts in PARTS {
            let mut open = all;
            for lane in 0..MOST_LANES {
                open[lane] &= found.steps[lane].is_none();
            }
            if !open.contains(&true) {
                break;
            }
            found.take(&self.in_parts(task, parts, open));
        }
        found
    }

    /// Finds the equilibria after a change of travel and rack in `parts` equal steps. `task` returns the inputs of the
    /// equilibria after a fraction of the change.
    #[inline(always)]
    fn in_parts(
        &self,
        task: impl Fn(f64) -> Task<B>,
        parts: usize,
        mut open: [bool; MOST_LANES],
    ) -> EquilibriaInLanes<B> {
        let step = 1.0 / parts as f64;
        let mut reached = self.solved(&self.start, &task(step), open);
        for part in 2..=parts {
            let before = reached.steps;
            for lane in 0..MOST_LANES {
                open[lane] = before[lane].is_some();
            }
            let state = reached.state;
            reached = self.solved(&state, &task(part as f64 * step), open);
            for (steps, before) in reached.steps.iter_mut().zip(before) {
                *steps = steps.zip(before).map(|(last, first)| first + last);
            }
        }
        reached
    }

    /// Finds the equilibria under loads that act in addition to the loads of a station, in one step. The search starts from
    /// neighbouring equilibria, like [`ElasticWheel::loaded_about`].
    #[inline(always)]
    pub(crate) fn loaded_about(
        &self,
        station: &EquilibriaInLanes<B>,
        from: &EquilibriaInLanes<B>,
        loads: &WheelLoads<B>,
        held: HeldQuantity,
    ) -> EquilibriaInLanes<B> {
        outlined!(
            [B: SimdReal] station.task.rack;
            wheels: &'p WheelsInLanes<B> = self, station: &'p EquilibriaInLanes<B> = station,
            from: &'p EquilibriaInLanes<B> = from, loads: &'p WheelLoads<B> = loads,
            held: HeldQuantity = held => EquilibriaInLanes<B> {
                let system = &wheels.system;
                let (_, mut task) = system.held_as(&station.state, &station.task, held);
                let (state, _) = system.held_as(&from.state, &from.task, held);
                task.loads = task.loads.plus(loads, task.rack.one());
                let mut open = wheels.all();
                for lane in 0..MOST_LANES {
                    open[lane] &= station.steps[lane].is_some() && from.steps[lane].is_some();
                }
                wheels.solved(&state, &task, open)
            }
        )
    }

    /// Runs Newton's method in the lanes for which `open` is true.
    #[inline(always)]
    fn solved(
        &self,
        start: &State<B>,
        task: &Task<B>,
        open: [bool; MOST_LANES],
    ) -> EquilibriaInLanes<B> {
        outlined!(
            [B: SimdReal] task.rack;
            wheels: &'p WheelsInLanes<B> = self, start: &'p State<B> = start, task: &'p Task<B> = task,
            open: [bool; MOST_LANES] = open => EquilibriaInLanes<B> {
                wheels.newton(start, task, open)
            }
        )
    }

    #[inline(always)]
    fn newton(
        &self,
        start: &State<B>,
        task: &Task<B>,
        mut open: [bool; MOST_LANES],
    ) -> EquilibriaInLanes<B> {
        let mut found = EquilibriaInLanes {
            state: *start,
            task: *task,
            steps: [None; MOST_LANES],
            limbs: self.system.limbs.len(),
        };
        let mut judges = [Judge::new(self.bounds); MOST_LANES];
        let mut equations = Equations::empty(task.rack, self.system.joints.len(), None);
        while open.contains(&true) {
            checkpoint();
            let step = self
                .system
                .newton_step(&found.state, task, None, &mut equations);
            let Ok(step) = step else {
                break;
            };
            let next = self.system.stepped(&found.state, &step);
            let [shift, turn] = self.system.size_of(&step);
            let mut sizes = [[0.0; MOST_LANES]; 2];
            shift.store(&mut sizes[0]);
            turn.store(&mut sizes[1]);
            let mut moves = [0.0; MOST_LANES];
            let mut settled = [false; MOST_LANES];
            for lane in 0..B::LANES {
                if open[lane] {
                    let verdict = judges[lane].judge([sizes[0][lane], sizes[1][lane]]);
                    settled[lane] = verdict == Ok(Verdict::Settled);
                    open[lane] = verdict == Ok(Verdict::GoesOn);
                    moves[lane] = if verdict.is_ok() { 1.0 } else { 0.0 };
                }
            }
            let moving = shift.zero().less(shift.load(&moves));
            found.state = State::choose(moving, &next, &found.state);
            if settled.contains(&true) {
                let is_stable = stable_lanes(&equations, self.bounds, &settled);
                for lane in 0..B::LANES {
                    if is_stable[lane] {
                        found.steps[lane] = Some(judges[lane].steps());
                    }
                }
            }
        }
        found
    }
}

/// Selects the converged lanes whose equilibrium is stable, by the check of `solve.rs`.
#[inline(always)]
fn stable_lanes<B: SimdReal>(
    equations: &Equations<B>,
    bounds: Bounds,
    settled: &[bool; MOST_LANES],
) -> [bool; MOST_LANES] {
    let mut entries = [[[0.0; MOST_LANES]; 6]; MOST];
    for row in 0..equations.size {
        for column in 0..6 {
            equations.matrix[row][column].store(&mut entries[row][column]);
        }
    }
    let mut is_stable = [false; MOST_LANES];
    for lane in 0..B::LANES {
        if settled[lane] && B::lane(equations.is_stable, lane) {
            is_stable[lane] = is_stable_lane(&entries[..equations.size], bounds, lane);
        }
    }
    is_stable
}

/// Returns true if the equilibrium in a lane is stable, given the equations of this lane.
fn is_stable_lane(entries: &[[[f64; MOST_LANES]; 6]], bounds: Bounds, lane: usize) -> bool {
    let mut rows = [[0.0; 6]; MOST];
    for (row, entries) in rows.iter_mut().zip(entries) {
        for (entry, lanes) in row.iter_mut().zip(entries) {
            *entry = lanes[lane];
        }
    }
    let [a, b, c, d, e, f, ..] = rows;
    is_definite_on(
        &[a, b, c, d, e, f],
        &mut rows[6..entries.len()],
        bounds,
        0.0,
    )
}

impl<B: SimdReal> EquilibriaInLanes<B> {
    /// Copies each equilibrium that exists in `others` to the same lane of `self`.
    #[inline(always)]
    fn take(&mut self, others: &Self) {
        let mut is_taken = [0.0; MOST_LANES];
        for lane in 0..MOST_LANES {
            if others.steps[lane].is_some() {
                is_taken[lane] = 1.0;
                self.steps[lane] = others.steps[lane];
            }
        }
        let zero = self.state.vertical.zero();
        let taken = zero.less(zero.load(&is_taken));
        self.state = State::choose(taken, &others.state, &self.state);
    }

    /// Writes the equilibria of the wheels to `to`, in the order of the lanes. An entry is `None` if the wheel has no
    /// result.
    #[inline(always)]
    pub(crate) fn write(&self, to: &mut [Option<Equilibrium>]) {
        let numbers = outlined!(
            [B: SimdReal] self.task.rack;
            own: &'p EquilibriaInLanes<B> = self => [[f64; MOST_LANES]; NUMBERS] {
                let mut numbers = [[0.0; MOST_LANES]; NUMBERS];
                let (mut state, mut task) = (own.state, own.task);
                let mut next = 0;
                visit(&mut state, &mut task, own.limbs, |c| {
                    c.store(&mut numbers[next]);
                    next += 1;
                });
                numbers
            }
        );
        for (lane, to) in to.iter_mut().enumerate() {
            *to = self.steps[lane].map(|steps| in_lane(&numbers, lane, self, steps));
        }
    }
}

/// Returns the equilibrium in a lane. Its values are read in the order of [`visit`].
fn in_lane<B>(
    numbers: &[[f64; MOST_LANES]; NUMBERS],
    lane: usize,
    of: &EquilibriaInLanes<B>,
    steps: usize,
) -> Equilibrium {
    let mut state = State::design(0.0);
    let mut task = level_task(0.0, 0.0);
    if let Hold::Load = of.task.hold {
        task.hold = Hold::Load;
    }
    let mut next = 0;
    visit(&mut state, &mut task, of.limbs, |c| {
        *c = numbers[next][lane];
        next += 1;
    });
    Equilibrium {
        solution: Solution { state, task, steps },
    }
}

/// Largest number of values that [`visit`] can visit.
const NUMBERS: usize = 12 + 15 * MOST_LIMBS + MOST_JOINTS + 1 + 11 + 2;

/// Calls `f` for every value that is stored in an equilibrium. `limbs` is the number of parts with their own degrees of
/// freedom.
#[inline(always)]
fn visit<T>(state: &mut State<T>, task: &mut Task<T>, limbs: usize, mut f: impl FnMut(&mut T)) {
    visit_placed(&mut state.carrier, &mut f);
    for limb in &mut state.limbs[..limbs] {
        visit_placed(&mut limb.placed, &mut f);
        f(&mut limb.pivot[0]);
        f(&mut limb.pivot[1]);
        f(&mut limb.slide);
    }
    for k in 0..MOST_JOINTS {
        f(&mut state.joints[k]);
    }
    f(&mut state.vertical);
    f(&mut task.rack);
    if let Hold::Height(travel) = &mut task.hold {
        f(travel);
    }
    let loads = &mut task.loads;
    for v in [&mut loads.contact, &mut loads.centre, &mut loads.moment] {
        visit_vector(v, &mut f);
    }
    f(&mut loads.side);
    f(&mut loads.trail);
}

#[inline(always)]
fn visit_placed<T>(placed: &mut Placed<T>, f: &mut impl FnMut(&mut T)) {
    visit_vector(&mut placed.shift, f);
    for k in 0..3 {
        visit_vector(&mut placed.turn.columns[k], f);
    }
}

#[inline(always)]
fn visit_vector<T>(v: &mut Vector3<T>, f: &mut impl FnMut(&mut T)) {
    f(&mut v.x);
    f(&mut v.y);
    f(&mut v.z);
}

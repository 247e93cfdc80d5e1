//! Finds rods that reach a toggle along the motion: the dead centre at which a rod cannot turn its rocker.

use super::{Solver, StationOrder};
use crate::mechanism::{Configuration, DesignFault, Pose, RodReach, is_effective};
use crate::model::{Drive, Mechanism, RockerId, Rod};
use crate::number::{Each, Jet, Matrix3, Real, Vector3};
use crate::sorting::sort_by_key;
use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;

/// Number of parts into which an interval of the drive is divided if a rod may have reached a toggle in it. `DEPTH` is the
/// largest number of successive divisions: first of the interval between two stations, then of its undecided parts.
const PARTS: usize = 16;
const DEPTH: usize = 3;

/// Checks rockers for toggles from station to station, outward from the design position. A rocker cannot move beyond a toggle. If
/// a rod might have reached a toggle between two stations and returned, poses between them are checked, down to 1/4096 of the
/// interval.
#[derive(Clone, Debug, Default)]
pub struct Toggles {
    watched: Vec<RockerId>,
    /// Drive and rack displacement during the visit. `None` if poses between the stations cannot be computed.
    way: Cell<Option<(Drive, f64)>>,
    /// Rockers at or beyond a toggle at the start of the visit.
    at_start: Cell<RockerSet>,
    /// Positions of all watched rods at the start of the visit.
    rods_at_start: RefCell<Vec<RodReach<f64>>>,
    past: Cell<PreviousStation>,
    rods: RefCell<Vec<RodReach<f64>>>,
}

/// A set of rockers, with one bit for each index.
type RockerSet = u32;

/// Rockers at or beyond a toggle, and the positions of all watched rods.
type Seen = (RockerSet, Vec<RodReach<f64>>);

/// Previous station of the visit.
#[derive(Clone, Copy, Debug, Default)]
struct PreviousStation {
    value: f64,
    stuck: RockerSet,
}

impl Toggles {
    /// Makes a check for these rockers of a mechanism, and for the rockers that move them.
    pub fn of(mechanism: &Mechanism, rockers: impl IntoIterator<Item = RockerId>) -> Self {
        Toggles::watching(mechanism, &rockers.into_iter().collect::<Vec<_>>())
    }

    fn watching(mechanism: &Mechanism, rockers: &[RockerId]) -> Self {
        let mut watched: Vec<RockerId> = Vec::new();
        for rocker in rockers.iter().copied() {
            let before = mechanism.rockers_moving(mechanism.rocker(rocker).outer);
            watched.extend(before.chain([rocker]));
        }
        sort_by_key(&mut watched, |id| id.0);
        watched.dedup();
        Toggles {
            watched,
            ..Toggles::default()
        }
    }

    /// Makes a check for these rockers in addition to the rockers of this check.
    pub fn and(&self, mechanism: &Mechanism, rockers: impl IntoIterator<Item = RockerId>) -> Self {
        Toggles::of(mechanism, self.watched.iter().copied().chain(rockers))
    }

    /// Prepares a visit of the solver's design that begins at drive 0 with the rack displaced by `rack`. An error says why
    /// the design cannot be solved.
    pub fn begin(&self, solver: &mut Solver, drive: Drive, rack: f64) -> Result<(), DesignFault> {
        if self.watched.is_empty() {
            return Ok(());
        }
        // Without a first pose no rocker can be checked.
        let Ok((pose, point)) = solver.placed(drive, rack)? else {
            self.begin_with(0, Vec::new());
            return Ok(());
        };
        let (stuck, rods) = self.seen(&solver.configuration(&pose, point.rack), 0, |c| c);
        let (pose, point) = solver.design_place(drive);
        let (_, designed) = self.seen(&solver.configuration(&pose, point.rack), 0, |c| c);
        let stuck = if self.keep_leverage(&designed, &rods, stuck) {
            stuck
        } else {
            let mut solver = solver.clone();
            let mut between = |part: f64, before: RockerSet| {
                let placed = solver.placed(drive, part * rack).ok()?.ok();
                placed.map(|(pose, point)| {
                    self.seen(&solver.configuration(&pose, point.rack), before, |c| c)
                })
            };
            self.between(&mut between, [0.0, 1.0], [&designed, &rods], stuck, DEPTH)
        };
        self.begin_with(stuck, rods);
        self.way.set(Some((drive, rack)));
        Ok(())
    }

    /// Returns the rod of the first checked rocker that reaches a toggle while the design changes. The mechanism stays in its
    /// design pose. `design` returns the design at a fraction of the change, from 0 to 1.
    pub(crate) fn on_way(
        &self,
        mechanism: &Mechanism,
        design: impl Fn(f64) -> Vec<Vector3<f64>>,
    ) -> Option<Rod> {
        let look = |part: f64, before: RockerSet| {
            let design = design(part);
            let pose = Pose {
                origin: design[mechanism.origin.0],
                rotation: Matrix3::identity(1.0),
            };
            let at = Configuration::new(mechanism, &design, pose, 0.0);
            self.seen(&at, before, |c| c)
        };
        let (before, designed) = look(0.0, 0);
        let (stuck, rods) = look(1.0, before);
        let stuck = if self.keep_leverage(&designed, &rods, stuck) {
            stuck
        } else {
            let mut look = |part: f64, before: RockerSet| Some(look(part, before));
            self.between(&mut look, [0.0, 1.0], [&designed, &rods], stuck, DEPTH)
        };
        let mut watched = self.watched.iter();
        let first = watched.find(|id| stuck & 1 << id.0 != 0);
        first.map(|id| mechanism.rocker(*id).rod)
    }

    /// Prepares another visit with the same start as the previous visit.
    pub fn begin_again(&self) {
        let (way, rods) = (self.way.get(), self.rods_at_start.borrow().clone());
        self.begin_with(self.at_start.get(), rods);
        self.way.set(way);
    }

    /// Prepares a visit that begins in this pose. Poses between its stations are not checked.
    pub fn begin_at<const N: usize>(&self, at: &Configuration<Jet<f64, N>>) {
        let (stuck, rods) = self.seen(at, 0, |c| c[0]);
        self.begin_with(stuck, rods);
    }

    fn begin_with(&self, stuck: RockerSet, rods: Vec<RodReach<f64>>) {
        self.way.set(None);
        self.at_start.set(stuck);
        self.past.set(PreviousStation { value: 0.0, stuck });
        self.rods.borrow_mut().clone_from(&rods);
        self.rods_at_start.replace(rods);
    }

    /// Checks the next station of the visit. `value` is the change of the drive from the start, and `solver` the solver that visits
    /// the stations. Finds the first checked rocker that has reached a toggle at this station, or on the way to it.
    /// Returns the kind of this rocker's rod. `None` if there is no such rocker.
    pub fn note<const N: usize>(
        &self,
        solver: Option<&Solver>,
        at: &Configuration<Jet<f64, N>>,
        value: f64,
    ) -> Option<Rod> {
        if self.watched.is_empty() {
            return None;
        }
        let past = self.past.get();
        // If this test is false, the station is on the other side of the start of the visit.
        let goes_on = value.abs() >= past.value.abs() && value * past.value >= 0.0;
        let (from, before) = if goes_on {
            (past.value, past.stuck)
        } else {
            let at_start = self.rods_at_start.borrow();
            self.rods.borrow_mut().clone_from(&at_start);
            (0.0, self.at_start.get())
        };
        let (mut stuck, rods) = self.seen(at, before, |c| c[0]);
        if let (Some((drive, rack)), Some(solver)) = (self.way.get(), solver)
            && !self.keep_leverage(&self.rods.borrow(), &rods, stuck)
        {
            let mut solver = solver.clone();
            let mut between = |part: f64, before: RockerSet| {
                let mut found = None;
                let order = StationOrder::through(&[from + part * (value - from)]);
                let visited = solver.for_each_pose(drive, &order, rack, |solver, _, pose| {
                    let configuration = pose.map(|pose| solver.configuration(pose, rack));
                    found = configuration.ok().map(|at| self.seen(&at, before, |c| c));
                    ControlFlow::Continue(())
                });
                visited.ok().and(found)
            };
            let ends = [&self.rods.borrow()[..], &rods];
            stuck = self.between(&mut between, [0.0, 1.0], ends, stuck, DEPTH);
        }
        self.rods.replace(rods);
        self.past.set(PreviousStation { value, stuck });
        let first = self.watched.iter().find(|id| self.holds(**id));
        first.map(|id| at.mechanism.rocker(*id).rod)
    }

    /// Returns true if the rods of all rockers outside `stuck` certainly keep their leverage between two points.
    fn keep_leverage(
        &self,
        from: &[RodReach<f64>],
        to: &[RodReach<f64>],
        stuck: RockerSet,
    ) -> bool {
        let ends = from.iter().zip(to);
        let mut all = self.watched.iter().zip(ends);
        all.all(|(id, (from, to))| stuck & 1 << id.0 != 0 || from.keeps_leverage_to(to))
    }

    /// Adds to `stuck` the rockers that reach a toggle between two points of the motion. `ends` are the rods at both
    /// points. `look` examines the pose at a value between them. Its second argument is the set of rockers that are already
    /// at or beyond a toggle.
    fn between(
        &self,
        look: &mut dyn FnMut(f64, RockerSet) -> Option<Seen>,
        [from, to]: [f64; 2],
        ends: [&[RodReach<f64>]; 2],
        stuck: RockerSet,
        depth: usize,
    ) -> RockerSet {
        let mut stuck = stuck;
        let (mut here, mut rods) = (from, ends[0].to_vec());
        for part in 1..=PARTS {
            let next = from + (to - from) * part as f64 / PARTS as f64;
            let (seen, reached) = if part == PARTS {
                (stuck, ends[1].to_vec())
            } else {
                // Points without a pose are omitted.
                match look(next, stuck) {
                    Some(found) => found,
                    None => continue,
                }
            };
            stuck = seen;
            if depth > 1 && !self.keep_leverage(&rods, &reached, stuck) {
                stuck = self.between(look, [here, next], [&rods, &reached], stuck, depth - 1);
            }
            (here, rods) = (next, reached);
        }
        stuck
    }

    /// Returns true if a rocker had reached a toggle at the station of the last call of [`Toggles::note`], or before it.
    pub fn holds(&self, rocker: RockerId) -> bool {
        self.past.get().stuck & 1 << rocker.0 != 0
    }

    /// Checked rockers that had reached a toggle at the station of the last call of [`Toggles::note`], or before it.
    pub fn held(&self) -> Vec<RockerId> {
        let watched = self.watched.iter().copied();
        watched.filter(|id| self.holds(*id)).collect()
    }

    /// Returns the rockers at or beyond a toggle in a pose, and the positions of all watched rods. The rockers are the ones
    /// in `before`, the ones whose rod has no leverage, and the ones that such a rocker moves. `now` converts a number to
    /// its value at this pose.
    fn seen<T: Real>(
        &self,
        at: &Configuration<T>,
        before: RockerSet,
        now: impl Fn(T) -> f64,
    ) -> Seen {
        let mechanism = at.mechanism;
        let (mut stuck, mut rods) = (before, Vec::with_capacity(self.watched.len()));
        for rocker in &self.watched {
            let mut turned_by = mechanism.rockers_moving(mechanism.rocker(*rocker).outer);
            let is_carried = turned_by.any(|id| stuck & 1 << id.0 != 0);
            let rod = mechanism.rocker(*rocker);
            let ends = at.ends(rod).each(|end| end.map(&now));
            if is_carried || !is_effective(ends) {
                stuck |= 1 << rocker.0;
            }
            let frame = at.rod_frame(rod).each(|direction| direction.map(&now));
            rods.push(RodReach::of(ends, frame));
        }
        (stuck, rods)
    }
}

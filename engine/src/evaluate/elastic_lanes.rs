//! Wheels with elastic parts in SIMD lanes, with one design in each lane.
//!
//! Each design becomes a separate elastic wheel. The equilibria of all designs are solved side by side, at the stations and at
//! the ends of the tests' load windows. If no equilibrium is found in a lane, the design of this lane is solved alone
//! afterwards.

use super::elastic::{ElasticDesigns, ElasticQuantities};
use super::evaluator::{LaneWork, SolvesInLanes};
use super::{Block, Stations};
use crate::compliance::{
    EquilibriaInLanes, Equilibrium, KcRun, KcTest, KcValue, LaneMemory, WheelLoads, WheelsInLanes,
};
use crate::number::{Each, SimdReal, SimdTask, Width};

/// Solver of as many elastic wheels at a time as the processor has lanes.
pub(super) struct ElasticLanes<'a> {
    width: Width,
    designs: ElasticDesigns<'a>,
    memory: LaneMemory,
}

impl<'a> ElasticLanes<'a> {
    pub(super) fn new(of: &'a ElasticQuantities, stations: &'a Stations, width: Width) -> Self {
        ElasticLanes {
            width,
            designs: ElasticDesigns::new(of, stations),
            memory: LaneMemory::default(),
        }
    }
}

impl SolvesInLanes for ElasticLanes<'_> {
    fn evaluate(&mut self, work: LaneWork<'_>) {
        self.width
            .run_in_avx2_lanes(ElasticTask { solver: self, work });
    }
}

struct ElasticTask<'s, 'a> {
    solver: &'s mut ElasticLanes<'a>,
    work: LaneWork<'s>,
}

impl SimdTask for ElasticTask<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let ElasticTask { solver, work } = self;
        let count = work.designs.count();
        let mut first = 0;
        while first < count && !work.interrupt.is_raised() {
            let end = (first + B::LANES).min(count);
            let mut group = Group::<B> {
                like,
                solver: &mut *solver,
                runs: Vec::new(),
                block: &mut *work.block,
            };
            for number in first..end {
                match group.solver.designs.run(work.designs.get(number)) {
                    Ok(run) => group.runs.push(Member {
                        number,
                        run,
                        is_solved: true,
                    }),
                    Err(_) => work.fallback.push(number),
                }
            }
            group.solve();
            let unsolved = group.runs.iter().filter(|member| !member.is_solved);
            work.fallback.extend(unsolved.map(|member| member.number));
            first = end;
        }
        work.fallback.sort_unstable();
    }
}

/// Design that a lane solves.
struct Member<'a> {
    /// Index of the design in the block.
    number: usize,
    run: KcRun<'a>,
    /// True while the solver has found every equilibrium of this design so far.
    is_solved: bool,
}

/// Designs that are solved side by side.
struct Group<'s, 'a, B> {
    like: B,
    solver: &'s mut ElasticLanes<'a>,
    runs: Vec<Member<'a>>,
    block: &'s mut Block,
}

impl<B: SimdReal> Group<'_, '_, B> {
    /// Solves all stations and writes the values to the block.
    fn solve(&mut self) {
        let wheels = self.runs.iter().map(|member| member.run.wheel());
        let Some(wheels) = WheelsInLanes::of(self.like, &self.solver.memory, wheels) else {
            return;
        };
        let stations = self.solver.designs.stations();
        for station in 0..stations.count() {
            let [travel, rack] = self.solver.designs.place(station);
            self.solver.designs.want(station);
            let equilibria = wheels.at(travel, rack);
            let found = self.written(&equilibria);
            let ends = self.window_ends(&wheels, &equilibria);
            for (lane, at) in found.iter().enumerate() {
                let Some(at) = at else {
                    self.runs[lane].is_solved = false;
                    continue;
                };
                let Member { number, run, .. } = &self.runs[lane];
                let known = |test: &KcTest, end: usize| {
                    let own = ends.iter().find(|own| own.test == *test)?;
                    own.found[end][lane]
                };
                let values = run.values_at(at, self.solver.designs.wanted(), known);
                let designs = &self.solver.designs;
                designs.put(&values, *number, station, self.block);
            }
        }
    }

    fn written(&self, equilibria: &EquilibriaInLanes<B>) -> Vec<Option<Equilibrium>> {
        let mut found = vec![None; self.runs.len()];
        equilibria.write(&mut found);
        found
    }

    /// Finds the equilibria at both ends of the load window of a test. The function includes every test whose secants (mean
    /// slopes over the window) are requested at this station.
    fn window_ends(&self, wheels: &WheelsInLanes<B>, at: &EquilibriaInLanes<B>) -> Vec<TestEnds> {
        let mut ends: Vec<TestEnds> = Vec::new();
        let Some(member) = self.runs.first() else {
            return ends;
        };
        for value in self.solver.designs.wanted() {
            let KcValue::Figure {
                test,
                is_secant: true,
                ..
            } = value
            else {
                continue;
            };
            if ends.iter().any(|own| own.test == *test) {
                continue;
            }
            let loads = member.run.window_loads(test);
            let found = loads.each(|loads: WheelLoads| {
                let loads = loads.map(|c| self.like.constant(c));
                wheels.loaded_about(at, at, &loads, test.held)
            });
            ends.push(TestEnds {
                test: *test,
                found: [self.written(&found[0]), self.written(&found[1])],
            });
        }
        ends
    }
}

/// Equilibria at both ends of a test's load window, one for each design of a group.
struct TestEnds {
    test: KcTest,
    found: [Vec<Option<Equilibrium>>; 2],
}

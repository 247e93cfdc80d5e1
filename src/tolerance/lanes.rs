//! Builds in SIMD lanes: from their numbers to their built designs.

use super::Problem;
use crate::number::{SimdReal, SimdTask, Vector3, Width};
use crate::sweep::{BLOCK, scatter};

/// Puts together as many builds at a time as the processor has lanes.
pub(super) struct LaneBuilder<'a> {
    problem: &'a Problem<'a>,
    width: Width,
    /// `[source][build]`
    pub(super) draws: Vec<f64>,
    /// The built designs of the block, a build's points after another's.
    pub(super) designs: Vec<Vector3<f64>>,
    /// Which of them are right; the others are left to be put together one by one.
    pub(super) right: [bool; BLOCK],
}

impl<'a> LaneBuilder<'a> {
    pub(super) fn new(problem: &'a Problem<'a>, width: Width) -> Self {
        let points = problem.assembler.suspension().design.len();
        LaneBuilder {
            problem,
            width,
            draws: vec![0.0; problem.tolerance.sources() * BLOCK],
            designs: vec![Vector3::default(); BLOCK * points],
            right: [false; BLOCK],
        }
    }

    /// Puts together the first `count` builds of those that have been drawn.
    pub(super) fn assemble(&mut self, count: usize) {
        self.width.run(Assembling {
            builder: self,
            count,
        });
    }
}

struct Assembling<'s, 'a> {
    builder: &'s mut LaneBuilder<'a>,
    count: usize,
}

impl SimdTask for Assembling<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let LaneBuilder {
            problem,
            draws,
            designs,
            right,
            ..
        } = self.builder;
        let assembler = &problem.assembler;
        let mechanism = &assembler.suspension().mechanism;
        let shape = Vector3::new(like, like, like);
        let drawn = assembler.drawn().in_lanes(like);
        let points = drawn.points.len();
        let mut parts = drawn.clone();
        let mut group = vec![shape; points];
        let mut carrier = Vec::with_capacity(points);
        let mut first = 0;
        while first < self.count {
            let sources = problem.tolerance.scatter.iter().flat_map(|c| &c.sources);
            let changes = sources.map(|source| &source.changes[..]);
            parts.scatter(mechanism, &drawn, changes, (draws, first, BLOCK));
            let alignment = problem.alignment.as_ref();
            let built =
                assembler.assemble_in_lanes(alignment, &mut parts, &mut carrier, &mut group);
            let lanes = (self.count - first).min(B::LANES);
            for lane in 0..lanes {
                right[first + lane] = B::lane(built.right, lane);
            }
            scatter(&group, first, lanes, designs);
            first += lanes;
        }
    }
}

//! Assembly of builds in SIMD lanes (several builds at once), from random numbers to built designs.

use super::wheel_assembler::WheelAssembler;
use crate::evaluate::{BLOCK, scatter};
use crate::number::{SimdReal, SimdTask, Vector3, Width};
use crate::study::Tolerance;

/// Assembles as many builds at a time as the processor has lanes.
pub(super) struct LaneBuilder<'a> {
    tolerance: &'a Tolerance,
    wheel_assembler: &'a WheelAssembler,
    width: Width,
    /// Points of the built designs of the block, build after build.
    pub(super) designs: Vec<Vector3<f64>>,
    /// True for each accepted build. All other builds are assembled one by one.
    pub(super) accepted: [bool; BLOCK],
}

impl<'a> LaneBuilder<'a> {
    pub(super) fn new(
        tolerance: &'a Tolerance,
        wheel_assembler: &'a WheelAssembler,
        width: Width,
    ) -> Self {
        let points = wheel_assembler.assembler.suspension().design.len();
        LaneBuilder {
            tolerance,
            wheel_assembler,
            width,
            designs: vec![Vector3::default(); BLOCK * points],
            accepted: [false; BLOCK],
        }
    }

    /// Assembles the first `count` builds from their random numbers, `[tolerance source][build]`.
    pub(super) fn assemble(&mut self, draws: &[f64], count: usize) {
        self.width.run_in_avx2_lanes(Assembling {
            builder: self,
            draws,
            count,
        });
    }
}

struct Assembling<'s, 'a> {
    builder: &'s mut LaneBuilder<'a>,
    draws: &'s [f64],
    count: usize,
}

impl SimdTask for Assembling<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let LaneBuilder {
            tolerance,
            wheel_assembler,
            designs,
            accepted,
            ..
        } = self.builder;
        let assembler = &wheel_assembler.assembler;
        let mechanism = &assembler.suspension().mechanism;
        let shape = Vector3::new(like, like, like);
        let drawn = assembler.drawn().in_lanes(like);
        let points = drawn.points.len();
        let mut parts = drawn.clone();
        let mut group = vec![shape; points];
        let mut carrier = Vec::with_capacity(points);
        let mut first = 0;
        while first < self.count {
            let sources = tolerance.each_source();
            let changes = sources.map(|source| wheel_assembler.changes(source));
            parts.scatter(mechanism, &drawn, changes, (self.draws, first, BLOCK));
            let alignment = wheel_assembler.alignment.as_ref();
            let built =
                assembler.assemble_in_lanes(alignment, &mut parts, &mut carrier, &mut group);
            let lanes = (self.count - first).min(B::LANES);
            for lane in 0..lanes {
                accepted[first + lane] = B::lane(built.accepted, lane);
            }
            scatter(&group, first, lanes, designs);
            first += lanes;
        }
    }
}

//! Builds of a robust tuning in SIMD lanes (several builds at once, one per lane): designs of the builds, with the
//! derivatives with respect to the variables.
//!
//! The parts of the nominal design have the same derivatives with respect to a variable in every build. These derivatives are
//! computed once, and every group of builds uses them. Builds that do not converge in lanes are assembled one by one.

use super::builds::BuiltWheel;
use super::moves::PointRate;
use crate::assembly::Parts;
use crate::number::{Jet, MOST_LANES, SimdReal, SimdTask, Vector3, Width};

/// Computes the built designs of a nominal design, several builds at once. Each build has its own random deviations of the parts.
pub(super) struct LaneBuilds {
    width: Width,
    at_once: usize,
    points: usize,
    /// Random numbers of the builds, `[tolerance source][build]`.
    draws: Vec<f64>,
    /// Length of the row of one tolerance source in `draws`: the number of builds, rounded up to whole SIMD vectors.
    stride: usize,
    /// The built designs, one after another.
    designs: Vec<Vector3<f64>>,
    /// Derivatives of the designs with respect to the variables, `[group][variable][point][axis][lane]`. A group has one build in
    /// each SIMD lane.
    point_rates: Vec<f64>,
    variables: usize,
    accepted: Vec<bool>,
}

impl LaneBuilds {
    /// Allocates memory for builds with these random numbers, `[build][tolerance source]`. The designs have `points` points
    /// and `variables` variables.
    pub(super) fn new(draws: &[Vec<f64>], points: usize, variables: usize, width: Width) -> Self {
        let at_once = width.lanes();
        let stride = draws.len().next_multiple_of(MOST_LANES);
        let sources = draws.first().map_or(0, Vec::len);
        let mut by_source = vec![0.0; sources * stride];
        for (build, draws) in draws.iter().enumerate() {
            for (source, draw) in draws.iter().enumerate() {
                by_source[source * stride + build] = *draw;
            }
        }
        let groups = draws.len().div_ceil(at_once);
        LaneBuilds {
            width,
            at_once,
            points,
            draws: by_source,
            stride,
            designs: vec![Vector3::default(); draws.len() * points],
            point_rates: vec![0.0; groups * variables * points * 3 * at_once],
            variables,
            accepted: vec![false; draws.len()],
        }
    }

    /// Index ranges of the builds that are assembled together.
    pub(super) fn groups(&self) -> impl Iterator<Item = std::ops::Range<usize>> + use<> {
        let (count, at_once) = (self.accepted.len(), self.at_once);
        let firsts = (0..count).step_by(at_once);
        firsts.map(move |first| first..count.min(first + at_once))
    }

    /// Designs of the builds in a group, one after another.
    pub(super) fn designs(&self, group: &std::ops::Range<usize>) -> &[Vector3<f64>] {
        &self.designs[group.start * self.points..group.end * self.points]
    }

    /// Rates of every coordinate of a group's designs with respect to each variable, `[variable][point][axis][lane]`.
    pub(super) fn point_rates(&self, group: &std::ops::Range<usize>) -> &[f64] {
        let length = self.variables * self.points * 3 * self.at_once;
        &self.point_rates[group.start / self.at_once * length..][..length]
    }

    /// Returns true if the solution of a build in SIMD lanes converged. The caller assembles each other build singly.
    pub(super) fn is_accepted(&self, build: usize) -> bool {
        self.accepted[build]
    }

    /// Marks a build for separate assembly, outside the SIMD lanes.
    pub(super) fn reject(&mut self, build: usize) {
        self.accepted[build] = false;
    }

    /// Assembles the builds of a wheel's nominal design. `drawn` contains the rates at which the variables move the nominal
    /// design.
    pub(super) fn assemble(&mut self, wheel: &BuiltWheel<'_>, drawn: &[PointRate]) {
        let (mechanism, parts) = (wheel.mechanism(), wheel.assembler().drawn());
        let along: Vec<Parts<Jet<f64, 2>>> = (0..self.variables)
            .map(|column| {
                let constant = |p: &Vector3<f64>| p.map(Jet::constant);
                let mut moved: Vec<_> = parts.drawn.iter().map(constant).collect();
                for rate in drawn.iter().filter(|rate| rate.column == column) {
                    let point = &mut moved[rate.point];
                    point.x.0[1] += rate.by.x;
                    point.y.0[1] += rate.by.y;
                    point.z.0[1] += rate.by.z;
                }
                Parts::of_drawing(mechanism, &moved)
            })
            .collect();
        self.width.run(Assembling {
            lanes: self,
            wheel,
            along: &along,
        });
    }
}

struct Assembling<'s, 'b> {
    lanes: &'s mut LaneBuilds,
    wheel: &'s BuiltWheel<'b>,
    /// Parts of the nominal design with their derivatives with respect to each variable.
    along: &'s [Parts<Jet<f64, 2>>],
}

impl SimdTask for Assembling<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let Assembling {
            lanes,
            wheel,
            along,
        } = self;
        let assembler = wheel.assembler();
        let mechanism = wheel.mechanism();
        let alignment = wheel.alignment();
        let points = lanes.points;
        let shape = Vector3::new(like, like, like);
        let drawn = assembler.drawn().in_lanes(like);
        let mut parts = drawn.clone();
        let mut built = vec![shape; points];
        let mut carrier = Vec::with_capacity(points);
        let zero = Jet([like.zero(); 2]);
        let nothing = Vector3::new(zero, zero, zero);
        let mut series = Parts {
            points: vec![nothing; points],
            lengths: vec![zero; parts.lengths.len()],
            softness: Vec::new(),
            drawn: vec![nothing; points],
        };
        let mut moving = vec![nothing; points];
        let mut series_carrier = Vec::with_capacity(points);
        let mut first = 0;
        let mut place = 0;
        while first < lanes.accepted.len() {
            let changes = wheel.changes();
            let numbers = (&lanes.draws[..], first, lanes.stride);
            parts.scatter(mechanism, &drawn, changes, numbers);
            let group =
                assembler.assemble_in_lanes(alignment, &mut parts, &mut carrier, &mut built);
            let mut accepted = group.accepted;
            for by in along {
                for (number, point) in series.points.iter_mut().enumerate() {
                    *point = with_rate(parts.points[number], by.points[number]);
                }
                for (number, point) in series.drawn.iter_mut().enumerate() {
                    *point = with_rate(parts.drawn[number], by.drawn[number]);
                }
                for (number, length) in by.lengths.iter().enumerate() {
                    series.lengths[number] =
                        Jet([parts.lengths[number], like.constant(length.0[1])]);
                }
                let settled = assembler.series_in_lanes(
                    alignment,
                    &group,
                    &mut series,
                    &mut series_carrier,
                    &mut moving,
                );
                accepted = accepted & settled;
                for point in &moving {
                    for rate in [point.x.0[1], point.y.0[1], point.z.0[1]] {
                        rate.store(&mut lanes.point_rates[place..]);
                        place += B::LANES;
                    }
                }
            }
            let count = (lanes.accepted.len() - first).min(B::LANES);
            crate::evaluate::scatter(&built, first, count, &mut lanes.designs);
            for lane in 0..count {
                lanes.accepted[first + lane] = B::lane(accepted, lane);
            }
            first += count;
        }
    }
}

/// Makes a first-order series for each SIMD lane. Its value is the lane's own part of `value`. Its derivative is the derivative
/// of `series`, the same in all lanes.
#[inline(always)]
fn with_rate<B: SimdReal>(value: Vector3<B>, series: Vector3<Jet<f64, 2>>) -> Vector3<Jet<B, 2>> {
    let rate = Vector3::new(series.x.0[1], series.y.0[1], series.z.0[1]);
    value.with_rate(value.constant(rate))
}

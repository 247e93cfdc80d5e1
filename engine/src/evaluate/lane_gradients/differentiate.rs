//! Derivatives of quantities in the poses of a group of stations.

use super::results::{Found, Jacobians};
use super::{AngleTarget, Task};
use crate::characteristics::{ByDirections, LaneInputs, LaneReader, LaneWheels};
use crate::derive::{Gradient, Seeds};
use crate::mechanism::{Configuration, Wrench};
use crate::model::PointId;
use crate::number::{Jet, Outlined, SimdReal, Vector3};
use crate::solve::{
    AdjointConstants, AdjointPose, AlongTravel, LaneAdjoint, LaneRates, SeriesDesign,
};
use std::ops::Range;

/// Derivatives with respect to the hardpoints, `[point][axis][lane]`.
struct Row<'r>(&'r mut [f64]);

impl<B: SimdReal> Gradient<B> for Row<'_> {
    #[inline(always)]
    fn add(&mut self, id: PointId, by: Vector3<B>) {
        let first = id.0 * 3 * B::LANES;
        let (x, rest) = self.0[first..first + 3 * B::LANES].split_at_mut(B::LANES);
        let (y, z) = rest.split_at_mut(B::LANES);
        (by.x.load(x) + by.x).store(x);
        (by.y.load(y) + by.y).store(y);
        (by.z.load(z) + by.z).store(z);
    }
}

/// Fills a row of derivatives with zeros, with SIMD instructions.
#[inline(always)]
fn clear<B: SimdReal>(zero: B, row: &mut [f64]) {
    for place in row.chunks_exact_mut(B::LANES) {
        zero.store(place);
    }
}

/// Computes derivatives along directions from derivatives with respect to the hardpoints. It processes a few directions at a
/// time, because in a single sum each addition would wait for the previous one.
#[inline(always)]
fn chain<B: SimdReal>(like: B, gradient: &[f64], along: &[f64], slopes: &mut [f64]) {
    const TOGETHER: usize = 3;
    let (length, directions) = (gradient.len(), slopes.len() / B::LANES);
    let mut first = 0;
    while first < directions {
        let together = TOGETHER.min(directions - first);
        let mut sums = [like.zero(); TOGETHER];
        let mut place = 0;
        while place < length {
            let by = like.load(&gradient[place..]);
            let mut k = 0;
            while k < TOGETHER {
                // If no direction is left, the code computes the last direction again, and does not use the result.
                let direction = first + k.min(together - 1);
                let rate = like.load(&along[direction * length + place..]);
                sums[k] = sums[k].plus_product(by, rate);
                k += 1;
            }
            place += B::LANES;
        }
        for (k, sum) in sums[..together].iter().enumerate() {
            sum.store(&mut slopes[(first + k) * B::LANES..]);
        }
        first += together;
    }
}

/// Differentiates the angles in the poses of a group of stations.
pub(in crate::evaluate) struct Differentiating<'r, 't, B: SimdReal> {
    pub(super) reader: &'r LaneReader<'r>,
    pub(super) wheels: &'r LaneWheels<B>,
    pub(super) members: &'r AdjointConstants<B>,
    /// Designs as Taylor series along the travel, if a quantity contains velocities. The field `series_gradient` is
    /// memory for one gradient of such a quantity.
    pub(super) series: Option<&'r (&'r AlongTravel, SeriesDesign<B>)>,
    pub(super) series_gradient: Vec<Vector3<Jet<B, 2>>>,
    pub(super) inputs: &'r mut LaneInputs<B>,
    pub(super) rack: B,
    /// SIMD lanes whose poses the pose tracker has accepted so far.
    pub(super) accepted: B::Mask,
    /// Number of stations at all rack displacements.
    pub(super) count: usize,
    /// Index of the first station at this rack displacement, or of the first group of stations in lanes.
    pub(super) first: usize,
    pub(super) task: Task<'t>,
    /// Weighted sum of squared deviations of the poses visited so far.
    pub(super) sum: B,
    pub(super) found: &'r mut Found,
}

impl<B: SimdReal> Differentiating<'_, '_, B> {
    /// Factor of an angle's derivatives: 1, or the derivative of the sum of squared deviations with respect to the angle.
    /// In the second case, the function also adds the angle's weighted squared deviation to the sum.
    #[inline(always)]
    fn weight(&mut self, angle: usize, station: usize) -> B {
        let one = self.rack.one();
        let Task::Deviations(wanted) = self.task else {
            return one;
        };
        let AngleTarget { value, weight } = wanted[angle * self.count + station];
        let missed = one.load(&self.found.angles[angle * B::LANES..]) - one.constant(value);
        let weighted = missed * one.constant(weight);
        self.sum = self.sum.plus_product(weighted, missed);
        weighted + weighted
    }
}

impl<B: SimdReal> Differentiating<'_, '_, B> {
    #[inline(always)]
    pub(in crate::evaluate) fn differentiate(&mut self, station: usize, at: &impl AdjointPose<B>) {
        let rack = self.rack;
        rack.outlined(AtPose {
            station: self.first + station,
            differentiating: self,
            at,
        });
    }
}

/// Differentiates the quantities in one pose, as a separate function. It serves poses of one design side by side, and poses of
/// many designs.
struct AtPose<'v, 'r, 't, B: SimdReal, P> {
    differentiating: &'v mut Differentiating<'r, 't, B>,
    station: usize,
    at: &'v P,
}

impl<B: SimdReal, P: AdjointPose<B>> Outlined for AtPose<'_, '_, '_, B, P> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        self.differentiating
            .differentiate_inline(self.station, self.at);
    }
}

impl<B: SimdReal> Differentiating<'_, '_, B> {
    #[inline(always)]
    fn differentiate_inline(&mut self, station: usize, at: &impl AdjointPose<B>) {
        let reads_rates = self.reader.reads_rates();
        let accepted = self
            .reader
            .read(self.wheels, at, self.rack, reads_rates, self.inputs);
        let angles = self.reader.quantities().len();
        let rates = at.rates();
        self.accepted = self.accepted & accepted & at.velocity_is_reliable(&rates);
        let configuration = at.configuration(self.rack);
        let adjoint = at.adjoint(self.members, &configuration, &rates);
        self.reader
            .values(self.inputs, &mut self.found.angles, B::LANES);
        let is_sum = matches!(self.task, Task::Deviations(_));
        let length = self.found.points * 3 * B::LANES;
        let mut angle = 0;
        while angle < angles {
            let (first, end) = if is_sum {
                (angle, angles)
            } else {
                (angle, angle + 1)
            };
            if !is_sum {
                clear(
                    self.rack.zero(),
                    &mut self.found.jacobian[angle * length..][..length],
                );
            }
            let mut is_posed = false;
            for number in first..end {
                if self.reader.is_of_rates(number) {
                    let weight = self.weight(number, station);
                    weight.outlined(AddingGradientOfRates {
                        differentiating: self,
                        number,
                        weight,
                        configuration: &configuration,
                        rates: &rates,
                    });
                } else {
                    is_posed = true;
                }
            }
            if is_posed {
                self.add_gradients(first..end, station, &configuration, &adjoint);
            }
            if let Task::Slopes { along, .. } = self.task {
                let Found {
                    jacobian,
                    slopes,
                    directions,
                    ..
                } = &mut *self.found;
                let row = &jacobian[first * length..][..length];
                let room = *directions * B::LANES;
                chain(self.rack, row, along, &mut slopes[first * room..][..room]);
            }
            angle = end;
        }
        let found = &*self.found;
        match &mut self.task {
            Task::Jacobians(visit) | Task::Slopes { visit, .. } => {
                visit(&Jacobians { station, found });
            }
            Task::Deviations(_) => {}
        }
    }

    /// Multiplies the gradient of each quantity in the range by the quantity's weight. Adds the product to the row of
    /// derivatives of the first quantity. Skips quantities that contain velocities.
    #[inline(always)]
    fn add_gradients(
        &mut self,
        numbers: Range<usize>,
        station: usize,
        configuration: &Configuration<'_, B>,
        adjoint: &impl LaneAdjoint<B>,
    ) {
        let is_sum = matches!(self.task, Task::Deviations(_));
        let (reader, first) = (self.reader, numbers.start);
        let mut by = ByDirections::default();
        let mut wrench = Wrench::zero(self.rack);
        for number in numbers {
            if reader.is_of_rates(number) {
                continue;
            }
            let weight = self.weight(number, station);
            if reader.add_by_directions(number, weight, self.inputs, &mut by) {
                continue;
            }
            let row = &mut Row(self.found.row(is_sum, first));
            let mut seeds = Seeds::continuing(configuration, wrench, row);
            reader.differentiate(number, weight, self.inputs, configuration, &mut seeds);
            wrench = seeds.wrench();
        }
        let row = &mut Row(self.found.row(is_sum, first));
        let mut seeds = Seeds::continuing(configuration, wrench, row);
        by.seed(self.wheels, self.inputs, &mut seeds);
        let wrench = seeds.wrench();
        adjoint.subtract(&wrench, row);
    }
}

/// Adds the gradient of a quantity that contains velocities, times a weight, to the quantity's row of derivatives. This is a
/// separate function, because its many Taylor series would otherwise use stack in every pose.
struct AddingGradientOfRates<'v, 'r, 't, 'c, B: SimdReal> {
    differentiating: &'v mut Differentiating<'r, 't, B>,
    number: usize,
    weight: B,
    configuration: &'v Configuration<'c, B>,
    rates: &'v LaneRates<B>,
}

impl<B: SimdReal> Outlined for AddingGradientOfRates<'_, '_, '_, '_, B> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let AddingGradientOfRates { number, weight, .. } = self;
        let Differentiating {
            reader,
            series,
            series_gradient,
            inputs,
            task,
            found,
            ..
        } = self.differentiating;
        let Some((along, design)) = *series else {
            return;
        };
        let at = design.along(self.configuration, self.rates);
        let adjoint = along.adjoint(design, &at);
        let gradient = &mut series_gradient[..];
        let zero = Jet([weight.zero(); 2]);
        gradient.fill(Vector3::new(zero, zero, zero));
        let mut seeds = Seeds::new(&at, gradient);
        reader.differentiate_rates(number, weight, inputs, &at, &mut seeds);
        let wrench = seeds.wrench();
        adjoint.subtract(&wrench, gradient);
        let is_sum = matches!(task, Task::Deviations(_));
        let mut row = Row(found.row(is_sum, number));
        for (point, by) in series_gradient.iter().enumerate() {
            let slope = Vector3::new(by.x.0[1], by.y.0[1], by.z.0[1]);
            row.add(PointId(point), slope);
        }
    }
}

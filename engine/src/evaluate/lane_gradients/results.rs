//! Results of an evaluation in lanes: Jacobians and sums of deviations.

use super::super::aligned::Aligned;
use crate::model::PointId;
use crate::number::Vector3;

/// Results of an evaluation, one value per lane.
#[derive(Clone)]
pub(super) struct Found {
    /// Indices of the stations of a single design, one list for each group that the lanes hold together.
    pub(super) groups: Vec<Vec<usize>>,
    /// Number of SIMD lanes.
    pub(super) lanes: usize,
    pub(super) points: usize,
    /// Angles of a pose, `[angle][lane]`.
    pub(super) angles: Aligned,
    /// Derivatives of the angles, `[angle][point][axis][lane]`.
    pub(super) jacobian: Aligned,
    /// Derivatives of the angles along directions, `[angle][direction][lane]`. `directions` is the number of directions.
    pub(super) slopes: Vec<f64>,
    pub(super) directions: usize,
    /// Weighted sum of squared deviations, `[lane]`.
    pub(super) sum: Aligned,
    /// Derivatives of the weighted sum of squared deviations, `[point][axis][lane]`.
    pub(super) gradient: Aligned,
}

impl Found {
    /// Memory for the derivatives of this angle. If `is_sum` is true: memory for the derivatives of the weighted sum of
    /// squared deviations.
    #[inline(always)]
    pub(super) fn row(&mut self, is_sum: bool, angle: usize) -> &mut [f64] {
        let length = self.points * 3 * self.lanes;
        if is_sum {
            &mut self.gradient
        } else {
            &mut self.jacobian[angle * length..][..length]
        }
    }

    #[inline(always)]
    fn number(&self, of: &[f64], row: usize, design: usize) -> f64 {
        assert!(design < self.lanes, "no such design");
        of[row * self.lanes + design]
    }

    #[inline(always)]
    fn vector(&self, of: &[f64], first: usize, point: PointId, design: usize) -> Vector3<f64> {
        let first = (first * self.points + point.0) * 3;
        let component = |axis: usize| self.number(of, first + axis, design);
        Vector3::new(component(0), component(1), component(2))
    }
}

/// Angles of several designs at a station, and their derivatives with respect to hardpoints and along directions. Indices of
/// designs and angles follow the order in which the caller gave them.
pub struct Jacobians<'f> {
    pub(super) station: usize,
    pub(super) found: &'f Found,
}

impl Jacobians<'_> {
    /// Index of the station that the designs share, as `Stations::number` returns it. If the lanes hold stations of a single
    /// design: index of the group of stations.
    pub fn station(&self) -> usize {
        self.station
    }

    /// Stations of a single design, one per lane, if the lanes hold stations instead of designs.
    pub fn side_by_side(&self) -> &[usize] {
        &self.found.groups[self.station]
    }

    /// Value of an angle in radians, or of another quantity in length units.
    #[inline(always)]
    pub fn value(&self, design: usize, angle: usize) -> f64 {
        self.found.number(&self.found.angles, angle, design)
    }

    /// Gradient of an angle with respect to a hardpoint, per length unit.
    #[inline(always)]
    pub fn gradient(&self, design: usize, angle: usize, point: PointId) -> Vector3<f64> {
        self.found
            .vector(&self.found.jacobian, angle, point, design)
    }

    /// Derivative of an angle along a direction, if directions were requested.
    #[inline(always)]
    pub fn slope(&self, design: usize, angle: usize, direction: usize) -> f64 {
        let row = angle * self.found.directions + direction;
        self.found.number(&self.found.slopes, row, design)
    }
}

/// Sums of weighted squared deviations, one for each design.
pub struct Deviations<'f> {
    pub(super) found: &'f Found,
}

impl Deviations<'_> {
    /// Sum of weighted squared deviations of a design, in squared radians times weights.
    #[inline(always)]
    pub fn sum(&self, design: usize) -> f64 {
        self.found.number(&self.found.sum, 0, design)
    }

    /// Gradient of the sum with respect to a hardpoint, per length unit.
    #[inline(always)]
    pub fn gradient(&self, design: usize, point: PointId) -> Vector3<f64> {
        self.found.vector(&self.found.gradient, 0, point, design)
    }
}

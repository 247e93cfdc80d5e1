//! Constraints of designs that are solved in SIMD lanes (several poses at once, one per lane).
//!
//! The solver in lanes computes positions of points as coordinates, and the spin axis as angles. It also computes the rates
//! of these values with respect to the variables. At each station, the chain rule combines these rates with the derivatives
//! of a formula.

use super::carried_triangle::CarriedTriangle;
use crate::characteristics::{Characteristic, Input, Measure, Quantity, Stud, Vectors};
use crate::evaluate::{Jacobians, index_or_push};
use crate::model::{Axis, Body, PointId, Suspension};
use crate::number::Vector3;

/// A measure, expressed by quantities that are computed in SIMD lanes (several poses at once).
#[derive(Clone)]
pub(super) enum LanePart {
    /// Value of a quantity, given by its index among the quantities that are read.
    Quantity(usize),
    /// Measure with a formula, and the sources of the vectors in the formula.
    Formula(Measure, Vec<Source>),
}

/// Source of a vector in a formula: quantities computed in SIMD lanes, given by their indices, or the points of the design.
#[derive(Clone, Copy)]
pub(super) enum Source {
    /// Coordinates of a point.
    Point([usize; 3]),
    /// Coordinates of two points of the wheel carrier. The vector goes from the first to the second.
    Between([[usize; 3]; 2]),
    /// Direction of the spin axis, from camber and toe.
    SpinAxis([usize; 2]),
    /// A direction of the design position that rotates with the wheel carrier. Three points of the carrier give the
    /// rotation. The first field contains the indices of the quantities that are the coordinates of these points. The
    /// second field contains the points.
    Carried([[usize; 3]; 3], [PointId; 3], Stud),
    /// Position of a point in the design position.
    Designed(PointId),
    /// Direction of a joint's stud in the design position.
    DesignedStud(Stud),
}

impl LanePart {
    /// Expresses a measure by quantities that are available in SIMD lanes. Appends the needed quantities to `quantities`.
    /// `None` if the measure is not available in lanes.
    pub(super) fn of(
        measure: &Measure,
        suspension: &Suspension,
        quantities: &mut Vec<Quantity>,
    ) -> Option<Self> {
        match measure {
            Measure::Quantity(quantity) => {
                return Some(LanePart::Quantity(index_or_push(quantities, *quantity)));
            }
            Measure::Carried(_) | Measure::Elastic(_) | Measure::OfAxle(_) => return None,
            _ => {}
        }
        let (inputs, count) = measure.inputs(&suspension.mechanism);
        let sources = inputs[..count].iter();
        let sources = sources.map(|input| Source::of(*input, suspension, quantities));
        Some(LanePart::Formula(
            measure.clone(),
            sources.collect::<Option<_>>()?,
        ))
    }

    /// Returns the value at the station that a lane holds, and writes its derivatives with respect to the variables into
    /// `slopes`.
    pub(super) fn read(
        &self,
        found: &Jacobians<'_>,
        lane: usize,
        design: &Moving<'_>,
        slopes: &mut [f64],
    ) -> f64 {
        let (measure, sources) = match self {
            LanePart::Quantity(quantity) => {
                for (column, slope) in slopes.iter_mut().enumerate() {
                    *slope = found.slope(lane, *quantity, column);
                }
                return found.value(lane, *quantity);
            }
            LanePart::Formula(measure, sources) => (measure, sources),
        };
        let mut vectors: Vectors<f64> = Default::default();
        for (vector, source) in vectors.iter_mut().zip(sources) {
            *vector = source.value(found, lane, design);
        }
        slopes.fill(0.0);
        for (k, source) in sources.iter().enumerate() {
            let by = measure.by_vector(k, &vectors);
            source.add_slopes(by, found, lane, design, slopes);
        }
        measure.formula(&vectors)
    }
}

/// A design, and the rates of its coordinates with respect to each variable, `[variable][point][axis]`.
pub(super) struct Moving<'d> {
    pub design: &'d [Vector3<f64>],
    pub along: &'d [f64],
}

impl Moving<'_> {
    fn at(&self, PointId(point): PointId) -> Vector3<f64> {
        self.design[point]
    }

    /// Direction of a joint's stud in the design position.
    fn stud(&self, stud: Stud) -> Vector3<f64> {
        match stud {
            Stud::Between(from, to) => self.at(to) - self.at(from),
            Stud::Along(direction) => direction,
        }
    }

    /// Derivative of a stud's direction (in the design position) with respect to the variable with index `column`.
    fn stud_along(&self, column: usize, stud: Stud) -> Vector3<f64> {
        match stud {
            Stud::Between(from, to) => self.along(column, to) - self.along(column, from),
            Stud::Along(_) => Vector3::default(),
        }
    }

    /// Triangle of three points of the wheel carrier, with the indices of their coordinates in a lane.
    fn triangle(
        &self,
        corners: [PointId; 3],
        numbers: [[usize; 3]; 3],
        (found, lane): (&Jacobians<'_>, usize),
    ) -> CarriedTriangle {
        let now = numbers.map(|point| point_in(found, lane, point));
        CarriedTriangle::new(corners.map(|id| self.at(id)), now)
    }

    fn along(&self, column: usize, PointId(point): PointId) -> Vector3<f64> {
        let first = 3 * (column * self.design.len() + point);
        Vector3::new(
            self.along[first],
            self.along[first + 1],
            self.along[first + 2],
        )
    }
}

/// Position of a point, read through the indices of its coordinates in a lane.
fn point_in(found: &Jacobians<'_>, lane: usize, numbers: [usize; 3]) -> Vector3<f64> {
    Vector3::from(numbers.map(|number| found.value(lane, number)))
}

impl Source {
    /// Source of a vector that a formula needs. `None` if the vector is a stud on a carrier whose points all lie on one
    /// line. Such points do not give the rotation of the carrier.
    fn of(input: Input, suspension: &Suspension, quantities: &mut Vec<Quantity>) -> Option<Self> {
        let is_carried = |id: PointId| suspension.mechanism.body(id) == Body::Knuckle;
        let mut point =
            |id| Axis::ALL.map(|axis| index_or_push(quantities, Quantity::Coordinate(id, axis)));
        Some(match input {
            Input::Now(id) => Source::Point(point(id)),
            Input::StudNow(Stud::Between(from, to)) if is_carried(from) && is_carried(to) => {
                Source::Between([from, to].map(point))
            }
            Input::StudNow(stud) => {
                let corners = CarriedTriangle::corners(suspension)?;
                Source::Carried(corners.map(point), corners, stud)
            }
            Input::SpinAxis => {
                let angles = [Characteristic::Camber, Characteristic::Toe];
                let angles = angles.map(Quantity::Characteristic);
                Source::SpinAxis(angles.map(|angle| index_or_push(quantities, angle)))
            }
            Input::Designed(id) => Source::Designed(id),
            Input::StudDesigned(stud) => Source::DesignedStud(stud),
        })
    }

    fn value(&self, found: &Jacobians<'_>, lane: usize, moving: &Moving<'_>) -> Vector3<f64> {
        let point = |numbers| point_in(found, lane, numbers);
        match *self {
            Source::Point(numbers) => point(numbers),
            Source::Between([from, to]) => point(to) - point(from),
            Source::SpinAxis(numbers) => {
                // camber = -asin(a_z), toe = atan2(a_x, a_y).
                let [camber, toe] = numbers.map(|n| found.value(lane, n).sin_cos());
                Vector3::new(camber.1 * toe.0, camber.1 * toe.1, -camber.0)
            }
            Source::Carried(numbers, corners, stud) => {
                let triangle = moving.triangle(corners, numbers, (found, lane));
                triangle.turned(moving.stud(stud))
            }
            Source::Designed(id) => moving.at(id),
            Source::DesignedStud(stud) => moving.stud(stud),
        }
    }

    /// Adds the contribution of this vector to `slopes`: the derivative `by` with respect to the vector, times the rates of
    /// the vector with respect to the variables.
    fn add_slopes(
        &self,
        by: Vector3<f64>,
        found: &Jacobians<'_>,
        lane: usize,
        moving: &Moving<'_>,
        slopes: &mut [f64],
    ) {
        // Adds the derivatives of quantities that were computed in lanes. Each derivative is multiplied by its weight.
        let mut add = |numbers: &[usize], weights: [f64; 3]| {
            for (number, weight) in numbers.iter().zip(weights) {
                for (column, slope) in slopes.iter_mut().enumerate() {
                    *slope += weight * found.slope(lane, *number, column);
                }
            }
        };
        match *self {
            Source::Point(numbers) => add(&numbers, by.to_array()),
            Source::Between([from, to]) => {
                add(&to, by.to_array());
                add(&from, (-by).to_array());
            }
            Source::SpinAxis(numbers) => {
                let [camber, toe] = numbers.map(|n| found.value(lane, n).sin_cos());
                let by_camber = -camber.0 * (by.x * toe.0 + by.y * toe.1) - camber.1 * by.z;
                let by_toe = camber.1 * (by.x * toe.1 - by.y * toe.0);
                add(&numbers, [by_camber, by_toe, 0.0]);
            }
            Source::Carried(numbers, corners, stud) => {
                let triangle = moving.triangle(corners, numbers, (found, lane));
                let forces = triangle.by_corners(triangle.turned(moving.stud(stud)), by);
                for (numbers, force) in numbers.iter().zip(forces) {
                    add(numbers, force.to_array());
                }
                let designed = forces.map(|force| -triangle.turned_back(force));
                let by_stud = triangle.turned_back(by);
                for (column, slope) in slopes.iter_mut().enumerate() {
                    *slope += by_stud.dot(moving.stud_along(column, stud));
                    for (corner, by) in corners.into_iter().zip(designed) {
                        *slope += by.dot(moving.along(column, corner));
                    }
                }
            }
            Source::Designed(id) => {
                for (column, slope) in slopes.iter_mut().enumerate() {
                    *slope += by.dot(moving.along(column, id));
                }
            }
            Source::DesignedStud(stud) => {
                for (column, slope) in slopes.iter_mut().enumerate() {
                    *slope += by.dot(moving.stud_along(column, stud));
                }
            }
        }
    }
}

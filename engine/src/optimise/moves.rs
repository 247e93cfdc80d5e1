//! Moves of the design with the variables, and their derivatives.
//!
//! Points that rotate as one body move to c + R(w) (p - c). Here c is the centroid of these points in the design, and w is
//! the rotation vector. The displacements of a point by several bodies and by all other moves add up. Each is measured from
//! the unmoved design. With the angle a = |w|, R is Cayley's rotation of the Rodrigues vector w tan(a/2)/a. The factor
//! tan(a/2)/a is a power series in w.w. For rotations up to 18 degrees the series is accurate to double precision. With 15
//! degrees about each axis, the relative error of the angle is 3e-14.

use crate::model::{Axis, Frame, PointId, Suspension};
use crate::number::{Dual, Matrix3, Real, Vector3};
use crate::study::{Study, Turn, Variable, Vehicle};
use nalgebra::DVector;

/// Coefficients of tan(x)/x - 1 in powers of x^2, from x^2 on (M. Abramowitz, I. A. Stegun, Handbook of mathematical
/// functions, 4.3.67).
const TANGENT: [f64; 7] = [
    1.0 / 3.0,
    2.0 / 15.0,
    17.0 / 315.0,
    62.0 / 2835.0,
    1382.0 / 155_925.0,
    21_844.0 / 6_081_075.0,
    929_569.0 / 638_512_875.0,
];

/// Rotation matrix of a rotation vector in radians.
fn rotation<T: Real>(w: Vector3<T>) -> Matrix3<T> {
    let square = w.norm_squared().scaled(0.25);
    let sum = TANGENT
        .iter()
        .rev()
        .fold(square.zero(), |sum, c| (sum + square.constant(*c)) * square);
    let factor = (square.one() + sum).scaled(0.5);
    Matrix3::by_rodrigues(w * factor)
}

/// Unit vector of a study's axis, in the kernel's frame (x forward, y left, z up).
fn along(frame: &Frame, axis: Axis) -> Vector3<f64> {
    let mut unit = Vector3::default();
    unit[axis] = frame.sign(axis);
    unit
}

/// Returns true if both rotations are of the same body: they have the same points, in any order.
fn are_of_one_body(a: &Turn, b: &Turn) -> bool {
    a.points.len() == b.points.len() && a.points.iter().all(|point| b.points.contains(point))
}

/// Total rotation of the body of `of`: a rotation vector in radians, in the kernel's frame (x forward, y left, z up).
fn rotation_vector(
    frame: &Frame,
    variables: &[Variable],
    x: &DVector<f64>,
    of: &Turn,
) -> Vector3<f64> {
    let mut w = [0.0; 3];
    for (variable, offset) in variables.iter().zip(x) {
        if let Some(turn) = &variable.turn
            && are_of_one_body(turn, of)
        {
            w[turn.axis as usize] += frame.turn_sign(turn.axis) * offset.to_radians();
        }
    }
    w.into()
}

fn centroid(design: &[Vector3<f64>], points: &[PointId]) -> Vector3<f64> {
    let sum = points
        .iter()
        .fold(Vector3::new(0.0, 0.0, 0.0), |sum, p| sum + design[p.0]);
    sum * (1.0 / points.len() as f64)
}

/// Writes the design, moved by the offsets `x` of the variables, into `moved`. Offsets are in the study's axes and degrees,
/// designs in the kernel's frame (x forward, y left, z up).
pub fn moved_design(
    design: &[Vector3<f64>],
    frame: &Frame,
    variables: &[Variable],
    x: &DVector<f64>,
    moved: &mut [Vector3<f64>],
) {
    moved.copy_from_slice(design);
    for (number, variable) in variables.iter().enumerate() {
        let Some(turn) = &variable.turn else { continue };
        let w = rotation_vector(frame, variables, x, turn);
        // The first rotation of a body stands for all of its rotations.
        let mut earlier = variables[..number].iter().filter_map(|v| v.turn.as_ref());
        let is_repeated = earlier.any(|own| are_of_one_body(own, turn));
        if is_repeated || w.norm_squared() == 0.0 {
            continue;
        }
        let (rotation, centre) = (rotation(w), centroid(design, &turn.points));
        for point in &turn.points {
            let by_others = moved[point.0] - design[point.0];
            moved[point.0] = centre + rotation.apply(design[point.0] - centre) + by_others;
        }
    }
    for (variable, offset) in variables.iter().zip(x) {
        for m in &variable.moves {
            m.apply(frame, *offset, false, moved);
        }
    }
}

impl Study {
    /// Returns the study with the variables of its tuning moved by `offsets`. A right wheel with different hardpoints moves
    /// by the same offsets. If one body carries both wheels, its right half moves as the mirror image of its left half. A
    /// tuned rate scatters about its new value.
    pub fn moved(&self, offsets: &[f64]) -> Study {
        let Some(optimise) = &self.optimise else {
            return self.clone();
        };
        let x = DVector::from_column_slice(offsets);
        let mut moved = Study {
            vehicle: self.vehicle.moved(&optimise.variables, &x),
            ..self.clone()
        };
        let of_builds = moved
            .optimise
            .iter_mut()
            .filter_map(|own| own.scatter.as_mut());
        let of_tolerance = moved.tolerance.iter_mut().flat_map(|own| &mut own.scatter);
        let scatter = of_builds
            .flat_map(|own| &mut own.contributors)
            .chain(of_tolerance);
        let sources = scatter.flat_map(|contributor| &mut contributor.sources);
        for scattered in sources.filter_map(|source| source.rate.as_mut()) {
            for (variable, offset) in optimise.variables.iter().zip(&x) {
                if let Some(rate) = &variable.rate
                    && rate.parameter == scattered.parameter
                {
                    scattered.design += rate.at(*offset)[0] - rate.design;
                }
            }
        }
        moved
    }
}

impl Vehicle {
    /// Returns the vehicle with these variables moved by `x`, as in [`Study::moved`].
    pub(super) fn moved(&self, variables: &[Variable], x: &DVector<f64>) -> Vehicle {
        let frame = &self.wheel().frame;
        let by_variables = |wheel: &Suspension| {
            let mut design = wheel.design.clone();
            moved_design(&wheel.design, frame, variables, x, &mut design);
            design
        };
        let mut moved = self.clone();
        moved.set_design(by_variables(self.wheel()));
        let own = self.axle().and_then(|both| both.axle.own_right());
        let right = moved.axle_mut().and_then(|both| both.axle.right.as_mut());
        if let (Some(own), Some(right)) = (own, right) {
            right.design = by_variables(own);
        }
        for (variable, offset) in variables.iter().zip(x) {
            if let Some(rate) = &variable.rate {
                moved.set_rate(rate.parameter.into(), rate.at(*offset)[0]);
            }
        }
        moved
    }
}

/// Rate at which a variable moves a point.
#[derive(Clone, Copy, Debug)]
pub struct PointRate {
    /// Index of the variable.
    pub column: usize,
    /// Index of the point.
    pub point: usize,
    /// Derivative of the point's position with respect to the variable.
    pub by: Vector3<f64>,
}

/// Rates at which the variables move the points at `x`, in the order of the point indices.
pub fn point_rates(
    design: &[Vector3<f64>],
    frame: &Frame,
    variables: &[Variable],
    x: &DVector<f64>,
    into: &mut Vec<PointRate>,
) {
    into.clear();
    for (column, variable) in variables.iter().enumerate() {
        for m in &variable.moves {
            let (point, by) = (m.point.0, along(frame, m.axis) * m.factor);
            into.push(PointRate { column, point, by });
        }
        let Some(turn) = &variable.turn else { continue };
        let seeded = Dual::inputs(rotation_vector(frame, variables, x, turn));
        let (rotation, centre) = (rotation(seeded), centroid(design, &turn.points));
        let per_degree = frame.turn_sign(turn.axis) * 1.0_f64.to_radians();
        for point in &turn.points {
            let lever = (design[point.0] - centre).map(Dual::constant);
            let image = rotation.apply(lever);
            let by = image.map(|c| c.partials[turn.axis as usize] * per_degree);
            let point = point.0;
            into.push(PointRate { column, point, by });
        }
    }
    sort_by_point(into);
}

/// Sorts rates by their points. Rates of a point keep their order.
pub(super) fn sort_by_point(rates: &mut [PointRate]) {
    rates.sort_by_key(|rate| rate.point);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{FrameConvention, Side};

    const DESIGN: [[f64; 3]; 3] = [
        [3.0, 600.0, 120.0],
        [-8.0, 550.0, 340.0],
        [60.0, 560.0, 150.0],
    ];

    fn turns() -> Vec<Variable> {
        turns_of(&[0, 1, 2])
    }

    fn turns_of(points: &[usize]) -> Vec<Variable> {
        let turn = |axis| Variable {
            name: "body".to_owned(),
            moves: Vec::new(),
            turn: Some(Turn {
                points: points.iter().copied().map(PointId).collect(),
                axis,
            }),
            rate: None,
            range: [-10.0, 10.0],
            cost: 1.0,
        };
        Axis::ALL.map(turn).to_vec()
    }

    /// A rotation preserves distances and the centroid. A rotation about one axis turns by the given angle.
    #[test]
    fn a_body_is_turned_about_its_centroid() {
        let frame = Frame::new(FrameConvention::Iso8855, Side::Left);
        let design = DESIGN.map(Vector3::from);
        let mut moved = design;
        let x = DVector::from_column_slice(&[3.0, -7.0, 15.0]);
        moved_design(&design, &frame, &turns(), &x, &mut moved);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (before, after) = ((design[i] - design[j]).norm(), (moved[i] - moved[j]).norm());
            assert!((before - after).abs() < 1e-12 * before);
        }
        let sum = |p: [Vector3<f64>; 3]| p[0] + p[1] + p[2];
        assert!((sum(moved) - sum(design)).norm() < 1e-11);

        let x = DVector::from_column_slice(&[0.0, 0.0, 15.0]);
        moved_design(&design, &frame, &turns(), &x, &mut moved);
        let edge = |p: [Vector3<f64>; 3]| p[2] - p[0];
        let (a, b) = (edge(design), edge(moved));
        let angle = (a.x * b.y - a.y * b.x).atan2(a.x * b.x + a.y * b.y);
        assert!((angle - 15.0_f64.to_radians()).abs() < 1e-15);
    }

    /// Compares the sum of a point's rates with finite differences of fourth order.
    fn assert_rates_are_derivatives(variables: &[Variable], x: &[f64]) {
        let frame = Frame::new(FrameConvention::SaeJ670, Side::Right);
        let design = DESIGN.map(Vector3::from);
        let x = DVector::from_column_slice(x);
        let mut found = Vec::new();
        point_rates(&design, &frame, variables, &x, &mut found);
        for (column, point) in (0..x.len()).flat_map(|c| (0..design.len()).map(move |p| (c, p))) {
            let own = found
                .iter()
                .filter(|r| (r.column, r.point) == (column, point));
            let by = own.fold(Vector3::default(), |sum: Vector3<f64>, rate| sum + rate.by);
            let at = |step: f64| {
                let (mut x, mut moved) = (x.clone(), design);
                x[column] += step;
                moved_design(&design, &frame, variables, &x, &mut moved);
                moved[point]
            };
            let h = 0.02;
            let near = (at(h) - at(-h)) * (8.0 / (12.0 * h));
            let slope = near - (at(2.0 * h) - at(-2.0 * h)) * (1.0 / (12.0 * h));
            assert!(
                (slope - by).norm() < 1e-9,
                "{column} {point}: {slope:?} {by:?}"
            );
        }
    }

    #[test]
    fn ways_are_the_derivatives_of_the_moves() {
        assert_rates_are_derivatives(&turns(), &[4.0, -2.0, 1.0]);
    }

    /// Two bodies share a point. Its displacement is the sum of the displacements by each body alone, and the rates are the
    /// derivatives of this sum, also where the second body does not rotate. The order of a body's points has no effect.
    #[test]
    fn movements_of_overlapping_bodies_add_up() {
        let frame = Frame::new(FrameConvention::Iso8855, Side::Left);
        let design = DESIGN.map(Vector3::from);
        let variables = [turns(), turns_of(&[1, 2]), turns_of(&[2, 0, 1])].concat();
        let displacements = |x: &[f64]| {
            let mut moved = design;
            let x = DVector::from_column_slice(x);
            moved_design(&design, &frame, &variables, &x, &mut moved);
            [0, 1, 2].map(|point| moved[point] - design[point])
        };
        let first = displacements(&[4.0, -2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let second = displacements(&[0.0, 0.0, 0.0, 3.0, 0.0, 5.0, 0.0, 0.0, 0.0]);
        let both = displacements(&[4.0, -2.0, 1.0, 3.0, 0.0, 5.0, 0.0, 0.0, 0.0]);
        let halves = displacements(&[2.0, -1.0, 0.5, 3.0, 0.0, 5.0, 2.0, -1.0, 0.5]);
        for point in 0..3 {
            let sum = first[point] + second[point];
            assert!((both[point] - sum).norm() < 1e-12 * sum.norm());
            assert!((halves[point] - sum).norm() < 1e-12 * sum.norm());
        }
        assert!(second[1].norm() > 1.0 && second[0].norm() == 0.0);
        for second in [[0.0; 3], [3.0, -6.0, 5.0]] {
            let x = [&[4.0, -2.0, 1.0][..], &second[..], &[0.5, 0.0, -1.0][..]].concat();
            assert_rates_are_derivatives(&variables, &x);
        }
    }
}

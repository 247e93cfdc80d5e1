//! Position of a point on an arm.
//!
//! An arm is hinged about the line through its front and rear bushing, along the unit vector e. With r the component of
//! `outer - front` normal to e in the design position and r' in the present pose, its rotation is
//!
//! ```text
//! cos = r.r'/r.r,   sin = e.(r x r')/r.r
//! ```
//!
//! Let L be the lever of a point: the component of `point - front` normal to e. The point moves by L (cos - 1) + e x L sin.

use crate::number::{Real, Vector3};

/// Inputs for the position of a point of an arm. In the design position: the front, rear and outer joint, and the point
/// itself. In the present pose: the outer joint.
pub(super) type Inputs<T> = [Vector3<T>; 5];

/// Rotation of the arm about its axis, with the intermediate results that its derivatives need.
struct ArmTurn<T> {
    axis: Vector3<T>,
    /// Inverse length 1/|rear - front|.
    inverse_length: T,
    /// Levers r and r' of the outer joint, and lever L of the point (symbols of this module).
    levers: [Vector3<T>; 3],
    /// Number 1/r.r, with the lever r of the outer joint in the design position.
    inverse: T,
    cosine: T,
    sine: T,
}

impl<T: Real> ArmTurn<T> {
    #[inline(always)]
    fn of([front, rear, outer, point, outer_now]: Inputs<T>) -> Self {
        let along = rear - front;
        let inverse_length = along.x.one() / along.norm();
        let axis = along * inverse_length;
        let radius = (outer - front).across(axis);
        let radius_now = (outer_now - front).across(axis);
        let inverse = axis.x.one() / radius.norm_squared();
        ArmTurn {
            axis,
            inverse_length,
            levers: [radius, radius_now, (point - front).across(axis)],
            inverse,
            cosine: radius.dot(radius_now) * inverse,
            sine: axis.dot(radius.cross(radius_now)) * inverse,
        }
    }
}

/// Present position of a point of an arm.
#[inline(always)]
pub(super) fn arm_point<T: Real>(inputs: Inputs<T>) -> Vector3<T> {
    let ArmTurn {
        axis,
        levers: [_, _, lever],
        cosine,
        sine,
        ..
    } = ArmTurn::of(inputs);
    inputs[3] - lever + lever * cosine + axis.cross(lever) * sine
}

/// Derivatives of `gradient . arm_point(inputs)` with respect to each input: the formulas of this module, differentiated in
/// reverse order.
#[inline(always)]
pub(super) fn arm_point_gradient<T: Real>(inputs: Inputs<T>, gradient: Vector3<T>) -> Inputs<T> {
    let ArmTurn {
        axis,
        inverse_length,
        levers: [radius, radius_now, lever],
        inverse,
        cosine,
        sine,
    } = ArmTurn::of(inputs);
    let by_cosine = gradient.dot(lever) * inverse;
    let by_sine = gradient.dot(axis.cross(lever)) * inverse;
    let by_square = by_cosine * cosine + by_sine * sine;
    let by_levers = [
        radius_now * by_cosine + radius_now.cross(axis) * by_sine
            - radius * (by_square + by_square),
        radius * by_cosine + axis.cross(radius) * by_sine,
        gradient * cosine + gradient.cross(axis) * sine - gradient,
    ];
    let mut by_axis = lever.cross(gradient) * sine + radius.cross(radius_now) * by_sine;
    let [front, _, outer, point, outer_now] = inputs;
    // Each of the levers r, r' and L depends on a point, the front bushing and the axis.
    let points = [outer, outer_now, point];
    let mut by_points = by_levers;
    for k in 0..3 {
        let (from_front, by) = (points[k] - front, by_levers[k]);
        by_axis = by_axis - by * axis.dot(from_front) - from_front * axis.dot(by);
        by_points[k] = by.across(axis);
    }
    let [by_outer, by_outer_now, by_lever] = by_points;
    let by_rear = by_axis.across(axis) * inverse_length;
    [
        -(by_outer + by_outer_now + by_lever + by_rear),
        by_rear,
        by_outer,
        gradient + by_lever,
        by_outer_now,
    ]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::number::{Dual, Jet};

    /// One backward pass gives the same gradient as dual numbers, even if the outer joint has left its circle. Along a
    /// motion, the pass also gives the same rate of the gradient as dual numbers.
    #[test]
    fn the_gradient_is_that_of_dual_numbers() {
        let at = |x: f64, y: f64, z: f64| {
            let series = |c: f64, k: f64| Jet::<f64, 2>([c, 0.3 * k - 0.1 * c]);
            Vector3::new(series(x, y), series(y, z), series(z, x))
        };
        let inputs = [
            at(0.2, 0.4, 0.21),
            at(-0.15, 0.42, 0.19),
            at(0.01, 0.7, 0.2),
            at(0.03, 0.6, 0.25),
            at(0.013, 0.69, 0.26),
        ];
        let gradient = at(0.7, -0.4, 1.1);
        let found = arm_point_gradient(inputs, gradient);
        assert_gradient(inputs, found, 1e-13, |inputs| {
            arm_point(inputs).dot(gradient.map(Dual::constant))
        });
    }

    /// Asserts that the derivatives of an output with respect to some points, and their rates, equal the results of dual
    /// numbers.
    pub(in crate::mechanism) fn assert_gradient<const K: usize>(
        inputs: [Vector3<Jet<f64, 2>>; K],
        found: [Vector3<Jet<f64, 2>>; K],
        tolerance: f64,
        output: impl Fn([Vector3<Dual<Jet<f64, 2>, 3>>; K]) -> Dual<Jet<f64, 2>, 3>,
    ) {
        for (k, found) in found.into_iter().enumerate() {
            let mut seeded = inputs.map(|p| p.map(Dual::constant));
            seeded[k] = Dual::inputs(inputs[k]);
            let expected = output(seeded).partials;
            for (found, expected) in found.to_array().into_iter().zip(expected) {
                for order in 0..2 {
                    let (found, expected) = (found[order], expected[order]);
                    assert!(
                        (found - expected).abs() < tolerance,
                        "{k}: {found} {expected}"
                    );
                }
            }
        }
    }
}

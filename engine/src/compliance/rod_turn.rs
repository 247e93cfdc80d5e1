//! Rotation of a rocker or lever by a rigid rod, with exact derivatives.
//!
//! The rod has its outer end at p and its inner end at q(theta) on the rocker. Its length is constant, so with r = q - p,
//! the derivatives a = dq/dtheta and b = d2q/dtheta2, s = r.a, and the transposes a' and g' of vectors,
//!
//! ```text
//! g = dtheta/dp = r/s,   d2theta/dp2 = -(I - a g' - g a' + (a.a + r.b) g g')/s                     (1)
//! ```
//!
//! A length or an angle y(theta) with the derivatives y' and y'' has the derivatives
//!
//! ```text
//! dy/dp = y' g,   d2y/dp2 = y' d2theta/dp2 + y'' g g'                                             (2)
//! ```

use crate::mechanism::Turn;
use crate::model::Rod;
use crate::number::{Each, Matrix3, Valued, Vector3};

/// Rotation of a rocker or lever by a rigid rod. It includes the derivatives with respect to the position of the rod's
/// outer end, by equation (1) of this module.
pub(super) struct RodTurn<T> {
    turn: Turn<T>,
    first: Vector3<T>,
    axis: Vector3<T>,
    /// Derivative of the angle with respect to the position of the rod's outer end.
    pub(super) by: Vector3<T>,
    /// Second derivative of the angle with respect to the position of the rod's outer end.
    pub(super) second: Matrix3<T>,
}

impl<T: Valued> RodTurn<T> {
    /// Computes the rotation about an axis through two points, while the rod's outer end moves from `outer` to `now`.
    #[inline(always)]
    pub(super) fn of(
        [first, second]: [Vector3<T>; 2],
        inner: Vector3<T>,
        outer: Vector3<T>,
        now: Vector3<T>,
    ) -> Self {
        let turn = Turn::of([first, second, inner, outer, now]);
        let nothing = Matrix3::null(now.x);
        let mut found = RodTurn {
            turn,
            first,
            axis: (second - first).normalised(),
            by: nothing.columns[0],
            second: nothing,
        };
        // The derivatives of `end` are with respect to the angle about the axis. The results use the sign of
        // [`RodTurn::angle`], which is positive if the rod pushes.
        let [end, along, bend] = found.moved_about(inner);
        let rod = end - now;
        let inverse = now.x.one() / rod.dot(along);
        let by = rod * inverse;
        let curvature = along.norm_squared() + rod.dot(bend);
        let sense = found.turn.sense(Rod::DropLink);
        let factor = -(inverse * sense);
        found.second.add_identity(factor);
        found.second.add_product(along, by, -factor);
        found.second.add_product(by, along, -factor);
        found.second.add_product(by, by, curvature * factor);
        found.by = by * sense;
        found
    }

    /// Angle of the rotation, positive in the direction in which the rod pushes.
    #[inline(always)]
    pub(super) fn angle(&self) -> T {
        self.turn.angle(Rod::DropLink)
    }

    /// Returns the present position of a point, with its first and second derivative with respect to the angle about
    /// the axis.
    #[inline(always)]
    fn moved_about(&self, point: Vector3<T>) -> [Vector3<T>; 3] {
        let now = self.turn.moved(point);
        let lever = (now - self.first).across(self.axis);
        [now, self.axis.cross(lever), -lever]
    }

    /// Returns the present position of a point, with its first and second derivative with respect to
    /// [`RodTurn::angle`].
    #[inline(always)]
    pub(super) fn moved(&self, point: Vector3<T>) -> [Vector3<T>; 3] {
        let [now, along, bend] = self.moved_about(point);
        [now, along * self.turn.sense(Rod::DropLink), bend]
    }

    /// Returns the first and second derivative of a value with respect to the rod's outer end, by equation (2) of this
    /// module. `first` and `second` are the derivatives of the value with respect to the angle.
    #[inline(always)]
    pub(super) fn chained(&self, first: T, second: T) -> (Vector3<T>, Matrix3<T>) {
        let columns = self.second.columns.each(|column| column * first);
        let mut twice = Matrix3 { columns };
        twice.add_product(self.by, self.by, second);
        (self.by * first, twice)
    }
}

#[cfg(test)]
mod tests {
    use super::super::algebra::second_order;
    use super::*;
    use crate::number::Dual;

    /// Nested derivative numbers lead to the same first and second derivatives as equations (1) and (2) of this module.
    /// The test compares the derivatives of the angle, and of the distance between a point on the rocker and a fixed
    /// point.
    #[test]
    fn derivatives_agree_with_nested_numbers() {
        let mut seed = 0.3_f64;
        let mut next = || {
            seed = (seed * 1013.7 + 0.41).fract();
            40.0 * (seed - 0.5)
        };
        let mut point = |x: f64, y: f64, z: f64| Vector3::new(x + next(), y + next(), z + next());
        for _ in 0..20 {
            let axis = [point(0.0, 300.0, 400.0), point(200.0, 310.0, 410.0)];
            let (inner, outer) = (point(90.0, 420.0, 390.0), point(80.0, 430.0, 150.0));
            let (spring, fixed) = (point(100.0, 330.0, 520.0), point(100.0, 20.0, 530.0));
            let moved = point(0.0, 0.0, 0.0);
            let turn = RodTurn::of(axis, inner, outer, outer + moved);
            let constant = |v: Vector3<f64>| v.map(|c| Dual::constant(Dual::constant(c)));
            let nested = |to: Vector3<Dual<Dual<f64, 3>, 3>>| {
                let [first, second] = axis.map(constant);
                let ends = [
                    first,
                    second,
                    constant(inner),
                    constant(outer),
                    constant(outer) + to,
                ];
                Turn::of(ends)
            };
            let of_angle = second_order(moved.to_array(), |to| {
                nested(Vector3::from(to)).angle(Rod::DropLink)
            });
            let of_length = second_order(moved.to_array(), |to| {
                (nested(Vector3::from(to)).moved(constant(spring)) - constant(fixed)).norm()
            });
            let [end, along, bend] = turn.moved(spring);
            let line = end - fixed;
            let (length, slope) = (line.norm(), line.dot(along) / line.norm());
            let second = (along.norm_squared() - slope * slope + line.dot(bend)) / length;
            let by_length = turn.chained(slope, second);
            let close = |found: f64, expected: f64, size: f64| {
                assert!(
                    (found - expected).abs() < 1e-11 * size,
                    "{found} {expected}"
                );
            };
            close(turn.angle(), of_angle.0, 1.0);
            close(length, of_length.0, length);
            let expected = [
                (of_angle, (turn.by, turn.second), 1.0 / length),
                (of_length, by_length, 1.0),
            ];
            for ((_, first, second), (by, matrix), size) in expected {
                for (i, (by, row)) in by.to_array().into_iter().zip(second).enumerate() {
                    close(by, first[i], size);
                    for (j, expected) in row.into_iter().enumerate() {
                        close(matrix.entry(i, j), expected, size / 100.0);
                    }
                }
            }
        }
    }
}

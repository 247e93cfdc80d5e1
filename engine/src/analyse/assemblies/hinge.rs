//! All assemblies of an arm on a hinge: at most two.
//!
//! The wheel centre moves on a circle, at the height c + A cos th + B sin th. With H = A^2 + B^2 and the required
//! height C above c,
//!
//! ```text
//! th = atan2(B, A) +- acos(C/sqrt H)                                              (1)
//! ```
//!
//! There are two assemblies if C^2 < H, and none if C^2 > H. If interval arithmetic cannot decide between these two
//! cases, the arm is at the end of its range. Then Newton's method decides.

use super::{Search, Undecided};
use crate::mechanism::Pose;
use crate::number::Matrix3;
use crate::number::Real;
use crate::number::{Each, Interval};
use crate::solve::closed_form::Circle;

impl Search<'_> {
    /// Finds the assemblies of a mechanism whose only constraint is a hinge.
    pub(crate) fn by_hinge(&mut self) {
        let mechanism = self.solver.mechanism();
        let arm = mechanism.arms[0];
        let height = |z: f64| Interval::point(z) + Interval::point(self.point.value);
        let wanted = height(self.solver.design()[mechanism.wheel_centre.0].z);
        let exact = Circle::of(arm, &self.exact);
        let above = wanted - exact.centre.z;
        let reach = exact.radius.z.squared() + exact.turned.z.squared();
        let left = reach - above.squared();
        if left.high < 0.0 {
            return;
        }
        let circle = Circle::of(arm, self.solver.design());
        let [a, b] = [circle.radius.z, circle.turned.z];
        let top = b.atan2(a);
        let from_top = (above.middle() / a.hypot(b)).clamp(-1.0, 1.0).acos();
        let found =
            [top - from_top, top + from_top].map(|angle| self.assembly(&turned(&circle, angle)));
        let missed = found.iter().filter(|a| a.is_none()).count();
        for assembly in found.into_iter().flatten() {
            self.add(assembly);
        }
        // At the end of the arm's range, the two assemblies coincide. One missed assembly is then no loss.
        if missed == 2 || (missed == 1 && left.low > 0.0) {
            let ends = (top - from_top, top + from_top);
            self.all.undecided.push(Undecided::ArmAngle(ends.0, ends.1));
        }
    }
}

/// Returns the pose after a rotation of the arm by an angle.
fn turned(circle: &Circle<f64>, angle: f64) -> Pose<f64> {
    let (sine, cosine) = angle.sin_cos();
    let axis = circle.radius.cross(circle.turned).normalised();
    let column = |e| axis * axis.dot(e) * (1.0 - cosine) + e * cosine + axis.cross(e) * sine;
    Pose {
        origin: circle.at(cosine, sine),
        rotation: Matrix3 {
            columns: Matrix3::identity(0.0).columns.each(column),
        },
    }
}

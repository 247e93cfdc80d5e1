//! Enclosures of all poses over an interval of the wheel travel, with their derivatives with respect to the travel.
//!
//! The module `certificate` states the theorem of Newton and Kantorovich and its radii r- and r+. If F(x, z) is enclosed over
//! an interval of travels z, the theorem holds for all these travels at once. There is exactly one x(z) within r+ of the given
//! pose, and it lies within r-. On the ball of radius r-, Z = |1 - A J| < 1, so J is regular and x(z) is differentiable. From J
//! x' = -F_z follows
//!
//! ```text
//! x' = v + (1 - A J) x',   v = -A F_z     =>     |x' - v| <= Z |v|/(1 - Z)        (1)
//! ```

use super::theorem::{defect, image, inverse, radii};
use super::{Certificate, Certifier, middles};
use crate::derive::MotionPoint;
use crate::mechanism::{Pose, Unproven};
use crate::model::Drive;
use crate::number::{Each, Interval, Jet, Matrix3, Vector3, array_of};

/// Enclosure of the poses at all travels of an interval.
#[derive(Clone, Copy, Debug)]
pub struct Inclusion {
    /// Bound on the difference between the given pose and the exact pose at any travel of the interval.
    pub certificate: Certificate,
    /// Enclosure of every exact pose, and of the derivative of the pose with respect to the travel.
    pub pose: Pose<Jet<Interval, 2>>,
}

impl Certifier<'_> {
    /// Encloses the poses near a given pose at every travel of an interval, with the rack exactly at `rack`.
    ///
    /// # Errors
    /// Returns the reason why the certificate failed. A shorter interval may succeed.
    pub fn over_travels(
        &self,
        pose: &Pose<f64>,
        travel: Interval,
        rack: f64,
    ) -> Result<Inclusion, Unproven> {
        let equations = self.equations(Drive::Travel);
        let point = MotionPoint {
            drive: Drive::Travel,
            value: travel,
            rack: Interval::point(rack),
        };
        let at = equations.displacement_over(pose, &point);
        let (f, jacobian) = equations.linearised(&at);
        let inverse = inverse(&middles(&jacobian))?;
        let bends = &equations.pose_bends;
        let radii = radii(&inverse, &jacobian, bends, image(&inverse, &f))?;
        let certificate = self.certificate(&radii);

        let mut ball = at;
        for number in &mut ball[..super::N] {
            *number = around(*number, radii.error);
        }
        let (jacobian, by_travel) = equations.jacobian(&ball);
        let one = Interval::point(1.0);
        let defect = Interval::point(defect(&inverse, &jacobian));
        let left = one - defect;
        // `left.low` is never NaN, because interval bounds are never NaN.
        if left.low <= 0.0 {
            return Err(Unproven::TooClose);
        }
        let rate: [Interval; super::N] = array_of(|i| {
            let terms = inverse[i].iter().zip(&by_travel);
            terms.fold(Interval::point(0.0), |sum, (a, b)| sum - b.times(*a))
        });
        let largest = rate
            .iter()
            .fold(0.0, |most: f64, v| most.max(v.magnitude()));
        let off = (defect * Interval::point(largest) / left).high;
        let rate = rate.each(|v| around(v, off));

        // The origin can deviate by the error, and the entries of the rotation matrix by the error divided by the
        // scale.
        let turn = (Interval::point(certificate.error) / Interval::point(self.scale)).high;
        let place = |j: usize, value: f64, error: f64| match j {
            0..3 => Jet([around(Interval::point(value), error), rate[j]]),
            _ => Jet([
                around(Interval::point(value), error),
                rate[j].times(1.0 / self.scale),
            ]),
        };
        let vector = |first: usize, v: Vector3<f64>, error: f64| {
            Vector3::new(
                place(first, v.x, error),
                place(first + 1, v.y, error),
                place(first + 2, v.z, error),
            )
        };
        let [a, b, c] = pose.rotation.columns;
        Ok(Inclusion {
            certificate,
            pose: Pose {
                origin: vector(0, pose.origin, certificate.error),
                rotation: Matrix3 {
                    columns: [vector(3, a, turn), vector(6, b, turn), vector(9, c, turn)],
                },
            },
        })
    }
}

/// Returns an interval that is widened by `by` on both sides.
fn around(interval: Interval, by: f64) -> Interval {
    interval + Interval::bounds(-by, by)
}

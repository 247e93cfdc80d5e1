//! The drive of the seed paper, its equation (15), read as a drive by arm angle.
//!
//! ```text
//! z5 - z1 = d51 cos(theta)
//! ```
//!
//! 1 is the first named point of the arm's axis (`lower_arm_front`), 5 the arm's outer joint, d51 their
//! distance and theta the inclination of the line 1-5 from the vertical. On the arm's circle, with psi
//! the arm's angle from its highest position,
//!
//! ```text
//! z5 = zc + rho cos(psi)   so that   cos(psi) = (z1 - zc + d51 cos(theta))/rho
//! ```
//!
//! zc the height of the circle's centre and rho its vertical half-extent. The arm angle is psi less its
//! design value. The equation knows the cosine alone, so psi stays in the half-turn it has in the
//! design position: where theta passes a multiple of pi the arm does not pass its highest or lowest
//! position (its dead centre) but turns back. At the dead centre itself no finite speed of the arm
//! belongs to one of theta, and where 1 is not beside 5, so that d51 > rho, there is no position at
//! all about it.

use super::path::DesignFault;
use crate::model::Mechanism;
use crate::number::{Jet, Real, Vector3};

/// The arm angle that belongs to the paper's theta.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperTheta {
    /// (z1 - zc)/rho
    offset: f64,
    /// d51/rho
    share: f64,
    /// psi in the design position, in (-pi, pi]; the arm angle adds to it.
    design: f64,
}

/// Squared sine of psi below which fewer than half of the digits are left of an arm angle.
const DEAD_CENTRE: f64 = f64::EPSILON;

impl PaperTheta {
    /// The drive of a design, which must not be at the dead centre of its first arm.
    pub fn of(mechanism: &Mechanism, design: &[Vector3<f64>]) -> Result<Self, DesignFault> {
        let arm = mechanism.arms[0];
        let [front, rear, outer] = [arm.front, arm.rear, arm.outer].map(|id| design[id.0]);
        // Positive raises the outer joint, as the drive by arm angle has it.
        let axis = (front - rear).normalised();
        let axis = if axis.cross(outer - rear).z >= 0.0 {
            axis
        } else {
            -axis
        };
        let centre = front + axis * axis.dot(outer - front);
        let radius = outer - centre;
        let (up, ahead) = (radius.z, axis.cross(radius).z);
        let rho = up.hypot(ahead);
        let drive = PaperTheta {
            offset: (front.z - centre.z) / rho,
            share: (outer - front).norm() / rho,
            design: (-ahead).atan2(up),
        };
        // Written so that NaN, from an arm without a radius or on a vertical axis, is refused.
        if ahead * ahead > DEAD_CENTRE * rho * rho {
            Ok(drive)
        } else {
            Err(DesignFault::DeadCentre { outer: arm.outer })
        }
    }

    /// Theta in the design position, in (0, pi).
    pub fn design_value(&self) -> f64 {
        ((self.design.cos() - self.offset) / self.share).acos()
    }

    /// The arm angle as a series in whatever theta is one in; `None` at a dead centre and beyond.
    pub fn arm_angle<const N: usize>(&self, theta: Jet<f64, N>) -> Option<Jet<f64, N>> {
        let (_, cosine) = theta.sin_cos();
        let cosine = cosine * Jet::constant(self.share) + Jet::constant(self.offset);
        let squared_sine = cosine.one() - cosine.squared();
        if squared_sine[0] > DEAD_CENTRE {
            let sine = squared_sine.sqrt() * Jet::constant(self.design.signum());
            Some(sine.atan2(cosine) - Jet::constant(self.design))
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Topology;

    fn sample() -> PaperTheta {
        let topology = Topology::named("macpherson").unwrap();
        let names: Vec<_> = topology.hardpoints.iter().map(|h| h.name).collect();
        let mechanism = (topology.build)(topology, &names);
        let mut design = vec![Vector3::new(0.0, 0.0, 0.0); names.len()];
        let arm = mechanism.arms[0];
        design[arm.front.0] = Vector3::new(0.0, 0.0, 0.0);
        design[arm.rear.0] = Vector3::new(-1.0, 0.0, 0.0);
        design[arm.outer.0] = Vector3::new(0.0, 3.0, 4.0);
        PaperTheta::of(&mechanism, &design).unwrap()
    }

    /// With 1 beside 5 on a level axis theta is psi: the arm falls as theta grows, and rises again
    /// beyond pi.
    #[test]
    fn the_arm_turns_back_at_pi() {
        let drive = sample();
        assert!((drive.design_value() - 0.75_f64.atan()).abs() < 4.0 * f64::EPSILON);
        for (theta, slope) in [
            (1.0, -1.0),
            (3.0, -1.0),
            (4.0, 1.0),
            (6.0, 1.0),
            (7.0, -1.0),
        ] {
            let angle = drive.arm_angle(Jet::<f64, 3>::variable(theta)).unwrap();
            let folded = theta.cos().acos();
            let rounding = 16.0 * f64::EPSILON / theta.sin().powi(4);
            assert!((angle[0] - (0.75_f64.atan() - folded)).abs() < rounding);
            assert!((angle[1] - slope).abs() < rounding, "{angle:?}");
            assert!(angle[2].abs() < rounding, "{angle:?}");
        }
        for k in 0..4 {
            let theta = f64::from(k) * std::f64::consts::PI;
            assert_eq!(drive.arm_angle(Jet::<f64, 1>::variable(theta)), None);
        }
    }
}

//! Certificates of poses: rigorous error bounds by the theorem of Newton and Kantorovich for the quadratic closure
//! equations.
//!
//! A pose has twelve numbers x: the position of the origin, and nine entries of the rotation R. The five constraints, the drive
//! and the six conditions R^T R = 1 are quadratic in x ([`quadratic`]). With A an approximate inverse of the Jacobian J at x,
//! in the maximum norm,
//!
//! ```text
//! Y = |A F(x)|,   Z0 = |1 - A J(x)|,   Z2 = |A H|,   H the constant second derivative
//!
//! Z0 < 1 and 2 Z2 Y <= (1 - Z0)^2   =>   one and only one solution within r+, and it is within r-,
//! r- = 2 Y / (1 - Z0 + sqrt d),  r+ = (1 - Z0 + sqrt d) / Z2,  d = (1 - Z0)^2 - 2 Z2 Y
//! ```
//!
//! Since |A F + (A J - 1) e + A H(e,e)/2| <= Y + Z0 r + Z2 r^2/2 for |e| <= r, the ball of radius r is mapped into itself if
//! this radii polynomial is at most r. F, J and H are evaluated on [`Interval`]s, beginning with the hardpoints. So link
//! lengths, strut normals and all other derived numbers are also enclosed. In spite of all rounding errors, the certificate
//! applies to the exact mechanism whose hardpoints are the given doubles. Lengths are divided by the scale, a power of two near
//! the mechanism's size.
//!
//! *A step between two poses.* On the straight line x(t) between two poses, 0 <= t <= 1, the equations are F = a + b t + c t^2
//! (with c enclosed over the line if the drive is an angle), so
//!
//! ```text
//! |A F(x(t))| <= |A a| + |A (b + c)| + |A c|/4          as t (1 - t) <= 1/4
//! ```
//!
//! With J enclosed over the line, the same inequality shows that for every t there is one and only one solution within r+ of
//! the line. So both poses lie on one branch. A chain of such steps from the design position certifies a whole curve.
//!
//! *An interval of the travel.* If the drive in F is an interval, the inequality holds for every travel in it. At each
//! travel there is an exact pose within r- of the given pose ([`Inclusion`]).

mod branch;
#[cfg(test)]
mod constants;
mod inclusion;
mod quadratic;
mod theorem;

use crate::derive::MotionPoint;
use crate::mechanism::Pose;
use crate::mechanism::Unproven;
use crate::model::{Drive, Mechanism};
use crate::number::Real;
use crate::number::Vector3;
use crate::number::{Each, Interval, array_of};
pub use inclusion::Inclusion;
use quadratic::{Quadratic, middles};
use std::cell::OnceCell;
use theorem::{Radii, image, inverse, radii};

const N: usize = 12;
type Square = [[f64; N]; N];

/// Certificate of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// Bound on the difference between the exact pose and the computed pose. Coordinates of the knuckle's origin differ
    /// by at most this length. Entries of the rotation matrix differ by at most this length divided by the scale.
    pub error: f64,
    /// Distance within which there is no other solution, measured in the same way as the error.
    pub uniqueness: f64,
    /// Length by which entries of the rotation matrix are multiplied: a power of two near the mechanism's size.
    pub scale: f64,
}

impl Certificate {
    /// Returns a bound on the distance between the exact and the computed position of a knuckle point at `distance`
    /// from the knuckle's origin. The bound does not include the rounding of the computed position itself.
    pub fn point_error(&self, distance: f64) -> f64 {
        // e is the error, dr the error of the origin, dR the error of the rotation, and b the point relative to the origin.
        // |dr| <= sqrt 3 e, |dR b| <= |dR|_F |b| <= 3 (e/scale) |b|.
        1.7321 * self.error + 3.0 * self.error / self.scale * distance
    }
}

/// Certifies the poses of one design.
pub struct Certifier<'m> {
    mechanism: &'m Mechanism,
    design: Vec<Vector3<f64>>,
    scale: f64,
    /// Equations for each kind of drive. They are made when they are first needed.
    equations: [OnceCell<Quadratic>; 2],
}

impl<'m> Certifier<'m> {
    /// Prepares the certification of poses of this design.
    pub fn new(mechanism: &'m Mechanism, design: &[Vector3<f64>]) -> Self {
        Certifier {
            mechanism,
            design: design.to_vec(),
            scale: mechanism.size(design).log2().round().exp2(),
            equations: [OnceCell::new(), OnceCell::new()],
        }
    }

    /// Length by which entries of the rotation matrix are multiplied.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    fn equations(&self, drive: Drive) -> &Quadratic {
        self.equations[drive as usize]
            .get_or_init(|| Quadratic::new(self.mechanism, &self.design, self.scale, drive))
    }

    /// Certifies a pose, with the drive and the rack exactly at `point`.
    ///
    /// # Errors
    /// Returns the reason why the certificate failed.
    pub fn pose(
        &self,
        pose: &Pose<f64>,
        point: &MotionPoint<f64>,
    ) -> Result<Certificate, Unproven> {
        let equations = self.equations(point.drive);
        let (f, jacobian) = equations.linearised(&equations.displacement(pose, point));
        let inverse = inverse(&middles(&jacobian))?;
        let bends = &equations.pose_bends;
        let radii = radii(&inverse, &jacobian, bends, image(&inverse, &f))?;
        Ok(self.certificate(&radii))
    }

    fn certificate(&self, radii: &Radii) -> Certificate {
        Certificate {
            error: (radii.error * self.scale).next_up(),
            uniqueness: (radii.uniqueness * self.scale).next_down(),
            scale: self.scale,
        }
    }

    /// Certifies that two poses lie on one solution branch: near every point of the straight line between them, there
    /// is exactly one solution. Both poses must already be certified. `errors` contains their error bounds.
    ///
    /// # Errors
    /// Returns the reason why the certificate failed. A shorter step may succeed.
    fn line(
        &self,
        (from, start): (&Pose<f64>, &MotionPoint<f64>),
        (to, end): (&Pose<f64>, &MotionPoint<f64>),
        errors: [f64; 2],
    ) -> Result<(), Unproven> {
        let equations = self.equations(start.drive);
        let [a, b] = [(from, start), (to, end)].each(|(p, at)| equations.displacement(p, at));
        let ([constant, slope, bend], jacobian) = equations.on_line([&a, &b], [start, end]);
        let inverse = inverse(&middles(&jacobian))?;
        let ends = array_of(|i| slope[i] + bend[i]);
        let bound = [
            Interval::point(image(&inverse, &constant)),
            Interval::point(image(&inverse, &ends)),
            Interval::point(image(&inverse, &bend)).scaled(0.25),
        ];
        let bound = bound[0] + bound[1] + bound[2];
        let radii = radii(&inverse, &jacobian, &equations.pose_bends, bound.high)?;
        // The certified solutions at both ends must be the same as the solutions near the line.
        let within = (radii.uniqueness * self.scale).next_down();
        if errors.into_iter().all(|error| error <= within) {
            Ok(())
        } else {
            Err(Unproven::TooClose)
        }
    }
}

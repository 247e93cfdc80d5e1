//! Points and angular motion of the knuckle, from the points 5 to 8.

use super::Moving;
use super::motion::Motion;
use hardpoint_engine::nalgebra::Matrix3;
use hardpoint_engine::number::{Matrix3 as Axes, Vector3};

/// A point fixed in the knuckle, as an affine combination of the points 5, 6, 7 and 8.
///
/// The combination is linear, so the same weights give its position, velocity and acceleration from
/// those of the four points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnucklePoint([f64; 4]);

impl KnucklePoint {
    /// Point 5.
    pub(crate) const BALL_JOINT: KnucklePoint = KnucklePoint([1.0, 0.0, 0.0, 0.0]);

    /// The point that is at `point` when the knuckle's points are at `moving`. `None` where 5, 6, 7
    /// and 8 are in one plane, out of which no combination of them leads.
    pub(crate) fn new(point: Vector3<f64>, moving: &Moving) -> Option<Self> {
        let [_, w6, w7, w8] = vector_shares(point - moving[0], moving)?;
        Some(KnucklePoint([1.0 - (w6 + w7 + w8), w6, w7, w8]))
    }

    /// The weights of the points 5, 6, 7 and 8; their sum is one.
    pub fn shares(&self) -> [f64; 4] {
        self.0
    }

    /// Position, velocity or acceleration, from those of the unknown points.
    pub fn of(&self, moving: &Moving) -> Vector3<f64> {
        combined(self.0, moving)
    }
}

/// Weights of 5, 6, 7 and 8 that combine to this vector of the knuckle; their sum is zero.
fn vector_shares(vector: Vector3<f64>, moving: &Moving) -> Option<[f64; 4]> {
    let [p5, p6, p7, p8, _] = *moving;
    let edges = [p6 - p5, p7 - p5, p8 - p5].map(columns);
    let rest = Matrix3::from_columns(&edges).lu().solve(&columns(vector))?;
    Some([-rest.sum(), rest.x, rest.y, rest.z])
}

fn combined([w5, w6, w7, w8]: [f64; 4], moving: &Moving) -> Vector3<f64> {
    let [p5, p6, p7, p8, _] = *moving;
    p5 * w5 + p6 * w6 + p7 * w7 + p8 * w8
}

/// The images of the three unit vectors under the knuckle's rotation, as linear combinations of the
/// points 5, 6, 7 and 8. Like [`KnucklePoint`] they serve for rates as well: the same weights give the
/// derivatives of the rotation from those of the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KnuckleRotation([[f64; 4]; 3]);

impl KnuckleRotation {
    /// From the position in which the rotation is the identity; `None` where 5, 6, 7 and 8 are in one
    /// plane.
    pub(crate) fn new(design: &Moving) -> Option<Self> {
        let [x, y, z] = Axes::identity(0.0).columns;
        let shares = |v| vector_shares(v, design);
        Some(KnuckleRotation([shares(x)?, shares(y)?, shares(z)?]))
    }

    /// The rotation, or a derivative of it, by columns.
    pub(crate) fn of(&self, moving: &Moving) -> [Vector3<f64>; 3] {
        self.0.map(|shares| combined(shares, moving))
    }
}

/// Angular velocity and acceleration of the knuckle (and of the strut's rod, which turns with it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularMotion {
    /// Angular velocity, rad per unit of time (or of the drive's value).
    pub velocity: Vector3<f64>,
    /// Angular acceleration.
    pub acceleration: Vector3<f64>,
}

impl AngularMotion {
    /// From all four knuckle points, by least squares.
    ///
    /// With r and v relative to the points' mean, the omega that minimises the sum of
    /// |v - omega x r|^2 solves `I omega = sum of r x v`, where `I = sum of |r|^2 - r r'` is the inertia
    /// of four unit masses: regular unless the points are on one line. The same holds for alpha with
    /// a - omega x (omega x r) for v. Equation (25) takes a quotient instead that is 0/0 for an omega in
    /// the plane of 6, 7 and 8.
    pub(crate) fn of(moving: &Moving, motion: &Motion) -> Option<Self> {
        let [r, v, a] = [moving, &motion.velocity, &motion.acceleration].map(about_mean);
        let mut inertia = Matrix3::zeros();
        for r in r.map(columns) {
            inertia += Matrix3::from_diagonal_element(r.norm_squared()) - r * r.transpose();
        }
        let lu = inertia.lu();
        let solve = |moment: Vector3<f64>| {
            let turn = lu.solve(&columns(moment))?;
            Some(Vector3::new(turn.x, turn.y, turn.z))
        };
        let zero = Vector3::new(0.0, 0.0, 0.0);
        let moment = |f: [Vector3<f64>; 4]| {
            let pairs = r.iter().zip(f);
            pairs.fold(zero, |sum, (r, f)| sum + r.cross(f))
        };
        let omega = solve(moment(v))?;
        let tangential = std::array::from_fn(|i| a[i] - omega.cross(omega.cross(r[i])));
        Some(AngularMotion {
            velocity: omega,
            acceleration: solve(moment(tangential))?,
        })
    }
}

/// Points 5 to 8 (or their rates) less their mean.
fn about_mean(moving: &Moving) -> [Vector3<f64>; 4] {
    let [p5, p6, p7, p8, _] = *moving;
    let mean = (p5 + p6 + p7 + p8) * 0.25;
    [p5, p6, p7, p8].map(|p| p - mean)
}

fn columns(v: Vector3<f64>) -> hardpoint_engine::nalgebra::Vector3<f64> {
    hardpoint_engine::nalgebra::Vector3::from(v.to_array())
}

//! Points and angular motion of the knuckle, computed from points 5 to 8.

use super::Moving;
use super::motion::Motion;
use hardpoint_engine::nalgebra::Matrix3;
use hardpoint_engine::number::{Matrix3 as Axes, Vector3};

/// A point fixed in the knuckle, as an affine combination of points 5, 6, 7 and 8.
///
/// The combination is linear. So the same weights combine the positions, velocities or accelerations of the four points to the
/// position, velocity or acceleration of this point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnucklePoint([f64; 4]);

impl KnucklePoint {
    /// Point 5, the ball joint.
    pub(crate) const BALL_JOINT: KnucklePoint = KnucklePoint([1.0, 0.0, 0.0, 0.0]);

    /// Returns the knuckle point that is at `point` when the points of the knuckle are at `moving`. `None` if points 5 to 8 lie
    /// in one plane, because their combinations cannot leave that plane.
    pub(crate) fn new(point: Vector3<f64>, moving: &Moving) -> Option<Self> {
        let [_, w6, w7, w8] = vector_shares(point - moving[0], moving)?;
        Some(KnucklePoint([1.0 - (w6 + w7 + w8), w6, w7, w8]))
    }

    /// Weights of points 5, 6, 7 and 8. Their sum is one.
    pub fn shares(&self) -> [f64; 4] {
        self.0
    }

    /// Position, velocity or acceleration of the point. `moving` holds the same quantity of points 5 to 9.
    pub fn of(&self, moving: &Moving) -> Vector3<f64> {
        combined(self.0, moving)
    }
}

/// Weights of points 5, 6, 7 and 8 that combine to this vector of the knuckle. Their sum is zero.
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

/// Images of the three unit vectors under the knuckle's rotation, as linear combinations of points 5, 6, 7 and 8. The same weights
/// also combine velocities and accelerations of the points to the derivatives of the rotation, as for [`KnucklePoint`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KnuckleRotation([[f64; 4]; 3]);

impl KnuckleRotation {
    /// Makes the rotation that is the identity in the position `design`. `None` if points 5 to 8 lie in one plane.
    pub(crate) fn new(design: &Moving) -> Option<Self> {
        let [x, y, z] = Axes::identity(0.0).columns;
        let shares = |v| vector_shares(v, design);
        Some(KnuckleRotation([shares(x)?, shares(y)?, shares(z)?]))
    }

    /// Columns of the rotation or of one of its derivatives.
    pub(crate) fn of(&self, moving: &Moving) -> [Vector3<f64>; 3] {
        self.0.map(|shares| combined(shares, moving))
    }
}

/// Angular velocity and acceleration of the knuckle, and of the strut's rod, which turns with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularMotion {
    /// Angular velocity, rad per unit of time (or of the drive's value).
    pub velocity: Vector3<f64>,
    /// Angular acceleration, rad per squared unit of time (or of the drive's value).
    pub acceleration: Vector3<f64>,
}

impl AngularMotion {
    /// Fits angular velocity and acceleration to all four knuckle points by least squares.
    ///
    /// Let r and v be the position and velocity of a point relative to the mean of the four points. The omega that minimises the
    /// sum of |v - omega x r|^2 solves `I omega = sum of r x v`. Here `I = sum of |r|^2 - r r'` is the inertia of four unit masses.
    /// It is regular unless the points are on one line. The same equation gives the angular acceleration alpha, with a - omega x
    /// (omega x r) in place of v. a is the acceleration of the point relative to the mean. Equation (25) of Attia's paper uses a
    /// quotient that is 0/0 for an omega in the plane of 6, 7 and 8.
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

/// Points 5 to 8 (or their rates), minus the mean of the four.
fn about_mean(moving: &Moving) -> [Vector3<f64>; 4] {
    let [p5, p6, p7, p8, _] = *moving;
    let mean = (p5 + p6 + p7 + p8) * 0.25;
    [p5, p6, p7, p8].map(|p| p - mean)
}

fn columns(v: Vector3<f64>) -> hardpoint_engine::nalgebra::Vector3<f64> {
    hardpoint_engine::nalgebra::Vector3::from(v.to_array())
}

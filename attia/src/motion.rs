//! Velocities and accelerations, equations (18) to (24) of Attia's paper.

use super::Moving;
use super::equations::{Column, DRIVE, quadratic, rack_column};
use super::tracking::{PointCoordinates, Pose, moving_of};
use super::{AngularMotion, Refusal};

/// Rates of the drive and the rack with respect to time or another parameter.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Rates {
    /// First derivative of the drive's value.
    pub drive: f64,
    /// Second derivative of the drive's value.
    pub drive_acceleration: f64,
    /// First derivative of the rack's displacement.
    pub rack: f64,
    /// Second derivative of the rack's displacement.
    pub rack_acceleration: f64,
}

impl Rates {
    /// Unit rate of the drive with the rack fixed. Velocities are then derivatives with respect to the drive's value.
    pub const BY_DRIVE: Rates = Rates {
        drive: 1.0,
        drive_acceleration: 0.0,
        rack: 0.0,
        rack_acceleration: 0.0,
    };
    /// Unit rate of the rack with the drive fixed. Velocities are then derivatives with respect to the rack's displacement.
    pub const BY_RACK: Rates = Rates {
        drive: 0.0,
        drive_acceleration: 0.0,
        rack: 1.0,
        rack_acceleration: 0.0,
    };
}

/// First and second derivatives of the points 5, 6, 7, 8 and 9.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// First derivatives of the points, as [`Rates`] define them.
    pub velocity: Moving,
    /// Second derivatives of the points, as [`Rates`] define them.
    pub acceleration: Moving,
}

impl PointCoordinates {
    /// Velocities and accelerations at a solved pose.
    ///
    /// C(q, t) = 0 are the fifteen equations, with the coordinates q of points 5 to 9 and the time t. Subscripts denote partial
    /// derivatives, and J = C_q is the Jacobian. One factorisation of J gives the velocities v and the accelerations a:
    ///
    /// - J v = -C_t
    /// - J a = -(dJ/dt) v - C_qt v - C_tt
    pub fn motion(&self, pose: &Pose, rates: Rates) -> Result<Motion, Refusal> {
        let (station, points) = (pose.station(), pose.moving());
        let fixed = self.fixed.with_rack(station.rack);
        self.work.note(|w| {
            w.factorisations += 1;
            w.right_hand_sides += 2;
        });
        let lu = self
            .factorised(self.jacobian(pose))
            .ok_or_else(|| Refusal::Singular(self.diagnosis(pose)))?;
        let solve = |right: Column| moving_of(&Column::from(lu.solve(right.into())));

        let slope = self.driving.rate(station.value, points);
        let mut right = rack_column(&fixed, points, rates.rack);
        right[DRIVE] = slope * rates.drive;
        let velocity = solve(right);

        let mut right =
            rack_column(&fixed, points, rates.rack_acceleration) - quadratic(rates.rack, &velocity);
        right[DRIVE] = slope * rates.drive_acceleration
            + self
                .driving
                .curvature(station.value, rates.drive, &velocity);
        let acceleration = solve(right);
        Ok(Motion {
            velocity,
            acceleration,
        })
    }

    /// Angular velocity and acceleration of the knuckle during a motion.
    pub fn angular_motion(&self, pose: &Pose, motion: &Motion) -> AngularMotion {
        AngularMotion::of(pose.moving(), motion).expect("the knuckle's points are not on one line")
    }
}

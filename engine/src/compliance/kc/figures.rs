//! Results of a test, computed from derivatives or secants with respect to the load or motion of the test. The results
//! are in program units. The formulas work with any number type, so they also compute derivatives with respect to the
//! design.

use super::test::{KcTest, TestLoad};
use crate::ask::Unit;
use crate::compliance::{HeldQuantity, WheelFigures};
use crate::model::{Axis, Side, Suspension};
use crate::number::Scalar;

/// Smallest displacement per force, in mm/kN, for which a stiffness is computed.
const LEAST_COMPLIANCE: f64 = 1e-9;

/// Test result with its name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Figure<T> {
    pub(super) quantity: &'static str,
    pub(super) unit: Unit,
    pub(super) value: Option<T>,
}

/// Data from which the test results are computed, in addition to the state of the wheel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheet<'a> {
    pub(super) suspension: &'a Suspension,
    /// True if no part except springs and anti-roll bar is elastic.
    pub(super) is_rigid: bool,
    /// True if the wheel has a steering axis.
    pub(super) has_axis: bool,
    /// Rate of the tyre, force per length.
    pub(super) tyre_rate: Option<f64>,
    /// Side of the wheel.
    pub(super) side: Side,
}

/// Values of a state from which test results are computed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Read<T> {
    /// Derivatives or secants with respect to the load or motion of the test: per newton, per newton times the length
    /// unit, per length, or per radian (roll test).
    pub(super) by: Option<WheelFigures<T>>,
    /// Wheel rate at the contact point, for the ride rate of a heave test: force per length.
    pub(super) wheel_rate: Option<T>,
    /// Force that holds the rack, along the kernel's +y. Only the steering test of a single wheel uses it. That test has
    /// `None` without a spring, because nothing then loads the rack.
    pub(super) rack_force: Option<T>,
}

/// Names of the results for the four angles. Without a steering axis, caster is omitted.
type AngleNames = [&'static str; 4];

const LATERAL: AngleNames = [
    "toe_by_lateral_force",
    "camber_by_lateral_force",
    "caster_by_lateral_force",
    "spin_by_lateral_force",
];
const BRAKING: AngleNames = [
    "toe_by_braking",
    "camber_by_braking",
    "caster_by_braking",
    "spin_by_braking",
];
const TRACTION: AngleNames = [
    "toe_by_traction",
    "camber_by_traction",
    "caster_by_traction",
    "spin_by_traction",
];

impl Sheet<'_> {
    /// Computes the results of a test from the values of a state.
    pub(super) fn figures<T: Scalar>(&self, test: &KcTest, read: &Read<T>) -> Vec<Figure<T>> {
        match test.load {
            TestLoad::Heave => self.by_heave(read),
            TestLoad::Roll => self.by_roll(read),
            TestLoad::Steering => self.by_steering(read),
            TestLoad::Lateral => self.by_lateral(test, read),
            TestLoad::Braking | TestLoad::Traction => self.by_longitudinal(test, read),
            TestLoad::Aligning => {
                let toe = read.by.map(|by| by.toe);
                let camber = read.by.map(|by| by.camber);
                vec![
                    figure("toe_by_aligning_moment", Unit::AnglePerTorque, toe),
                    figure("camber_by_aligning_moment", Unit::AnglePerTorque, camber),
                ]
            }
            TestLoad::Vertical => {
                let rate = self.stiffness(read.by.map(|by| by.contact.z));
                let mut found = vec![figure("compliant_wheel_rate", Unit::Stiffness, rate)];
                if self.tyre_rate.is_some() {
                    let rate = self.ride_rate(rate);
                    found.push(figure("compliant_ride_rate", Unit::Stiffness, rate));
                }
                found
            }
        }
    }

    fn by_heave<T: Scalar>(&self, read: &Read<T>) -> Vec<Figure<T>> {
        let by = read.by;
        let mut found = vec![
            figure("toe_by_heave", Unit::AnglePerLength, by.map(|by| by.toe)),
            figure(
                "camber_by_heave",
                Unit::AnglePerLength,
                by.map(|by| by.camber),
            ),
        ];
        if self.has_axis {
            let caster = by.and_then(|by| by.steering).map(|[caster, _]| caster);
            found.push(figure("caster_by_heave", Unit::AnglePerLength, caster));
        }
        let (track, wheelbase) = (by.map(|by| by.contact.y), by.map(|by| by.contact.x));
        found.push(figure("half_track_by_heave", Unit::Ratio, track));
        found.push(figure("wheelbase_by_heave", Unit::Ratio, wheelbase));
        if self.tyre_rate.is_some() {
            let rate = self.ride_rate(read.wheel_rate);
            found.push(figure("compliant_ride_rate", Unit::Stiffness, rate));
        }
        found
    }

    /// Computes the results that are derivatives with respect to the roll angle. `read` already contains the derivatives
    /// with respect to this angle.
    fn by_roll<T: Scalar>(&self, read: &Read<T>) -> Vec<Figure<T>> {
        let to_left = self.left_sign();
        let steer = read.by.map(|by| by.toe.scaled(to_left));
        vec![
            figure("steer_by_roll", Unit::AnglePerAngle, steer),
            figure(
                "camber_by_roll",
                Unit::AnglePerAngle,
                read.by.map(|by| by.camber),
            ),
        ]
    }

    /// Returns the factor that converts toe to steer to the left. Toe-in turns a left wheel to the right, so the factor
    /// of a left wheel is -1.
    pub(super) fn left_sign(&self) -> f64 {
        match self.side {
            Side::Left => -1.0,
            Side::Right => 1.0,
        }
    }

    fn by_steering<T: Scalar>(&self, read: &Read<T>) -> Vec<Figure<T>> {
        let along = self.suspension.frame.sign(Axis::Y);
        let to_left = self.left_sign();
        let toe = read.by.map(|by| by.toe.scaled(to_left * along));
        let mut found = vec![figure("steer_by_rack", Unit::AnglePerLength, toe)];
        if self.has_axis {
            let caster = read.by.and_then(|by| by.steering);
            let caster = caster.map(|[caster, _]| caster.scaled(along));
            found.push(figure("caster_by_rack", Unit::AnglePerLength, caster));
        }
        // Without a spring, nothing loads the rack.
        if let Some(force) = read.rack_force {
            found.push(figure("rack_force", Unit::Force, Some(force.scaled(along))));
        }
        found
    }

    fn by_lateral<T: Scalar>(&self, test: &KcTest, read: &Read<T>) -> Vec<Figure<T>> {
        let inboard = read.by.map(|by| -by.centre.y);
        let contact = read.by.map(|by| -by.contact.y);
        let mut found = Vec::new();
        if !self.is_rigid {
            found.extend(self.angles(LATERAL, read));
            found.extend([
                figure(
                    "wheel_centre_by_lateral_force",
                    Unit::LengthPerForce,
                    inboard,
                ),
                figure("contact_by_lateral_force", Unit::LengthPerForce, contact),
                figure(
                    "lateral_stiffness_wheel_centre",
                    Unit::Stiffness,
                    self.stiffness(inboard),
                ),
                figure(
                    "lateral_stiffness_contact",
                    Unit::Stiffness,
                    self.stiffness(contact),
                ),
            ]);
        }
        if test.held == HeldQuantity::WheelHeight {
            let jacking = read.by.map(|by| by.vertical);
            found.push(figure("jacking_by_lateral_force", Unit::Ratio, jacking));
        }
        found
    }

    fn by_longitudinal<T: Scalar>(&self, test: &KcTest, read: &Read<T>) -> Vec<Figure<T>> {
        let rearward = read.by.map(|by| -by.centre.x);
        let is_braking = test.load == TestLoad::Braking;
        let (angles, recession, along) = if is_braking {
            (BRAKING, "recession_by_braking", rearward)
        } else {
            (
                TRACTION,
                "recession_by_traction",
                read.by.map(|by| by.centre.x),
            )
        };
        let mut found = Vec::new();
        if !self.is_rigid {
            found.extend(self.angles(angles, read));
            found.push(figure(recession, Unit::LengthPerForce, rearward));
            let stiffness = self.stiffness(along);
            let name = "longitudinal_stiffness_wheel_centre";
            found.push(figure(name, Unit::Stiffness, stiffness));
        }
        if is_braking && test.held == HeldQuantity::WheelHeight {
            let jacking = read.by.map(|by| by.vertical);
            found.push(figure("jacking_by_braking", Unit::Ratio, jacking));
        }
        found
    }

    fn angles<T: Scalar>(&self, names: AngleNames, read: &Read<T>) -> Vec<Figure<T>> {
        let by = read.by;
        let caster = by.and_then(|by| by.steering).map(|[caster, _]| caster);
        let values = [
            by.map(|by| by.toe),
            by.map(|by| by.camber),
            caster,
            by.map(|by| by.spin),
        ];
        let all = names.into_iter().zip(values).enumerate();
        all.filter(|(k, _)| self.has_axis || *k != 2)
            .map(|(_, (name, value))| figure(name, Unit::AnglePerForce, value))
            .collect()
    }

    /// Returns the stiffness (force per length) from the displacement per force. `None` if the displacement is below
    /// [`LEAST_COMPLIANCE`].
    pub(super) fn stiffness<T: Scalar>(&self, displacement: Option<T>) -> Option<T> {
        let millimetre = self.suspension.length_unit.per_metre() / 1000.0;
        let least = LEAST_COMPLIANCE / 1000.0 * millimetre;
        let moving = displacement.filter(|d| d.value().abs() > least);
        moving.map(|d| d.one() / d)
    }

    /// Returns the ride rate: wheel rate and tyre rate in series.
    fn ride_rate<T: Scalar>(&self, rate: Option<T>) -> Option<T> {
        let rate = rate?;
        let tyre = rate.constant(self.tyre_rate?);
        Some(rate * tyre / (rate + tyre))
    }
}

fn figure<T>(quantity: &'static str, unit: Unit, value: Option<T>) -> Figure<T> {
    Figure {
        quantity,
        unit,
        value,
    }
}

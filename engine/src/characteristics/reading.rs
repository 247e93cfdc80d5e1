//! Values of the slots of formulas in a pose.
//!
//! The code is written once for all number types and all kinds of poses. [`PoseReader`] gives the parts of a pose, and
//! [`Inputs::read`] assembles the inputs of formulas from these parts. A configuration gives parts in any number type. If
//! the parts are series, they contain the velocities. Poses of several designs in lanes have a separate, cheaper reader. A
//! slot that is not read remains NaN, so a formula that reads an undeclared slot has no value.

use super::{Constants, DesignWheel, Inputs, Slot, Slots, Wheel};
use crate::derive::DesignedSpinAxis;
use crate::mechanism::Configuration;
use crate::model::{Mechanism, PointId, RockerId};
use crate::number::{Jet, Real, Vector3};

/// A part of a pose, with its derivative with respect to the drive coordinate if known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moving<V> {
    pub(super) now: V,
    pub(super) rate: Option<V>,
}

impl<V> Moving<V> {
    #[inline(always)]
    pub(super) fn without_rate(now: V) -> Self {
        Moving { now, rate: None }
    }

    /// Stores value and derivative. If the derivative is unknown, `rate` does not change.
    #[inline(always)]
    pub(super) fn put(self, now: &mut V, rate: &mut V) {
        *now = self.now;
        if let Some(known) = self.rate {
            *rate = known;
        }
    }
}

impl<T: Real> Moving<Vector3<T>> {
    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        Moving {
            now: self.now - other.now,
            rate: match (self.rate, other.rate) {
                (Some(one), Some(other)) => Some(one - other),
                _ => None,
            },
        }
    }

    #[inline(always)]
    fn norm(self) -> Moving<T> {
        let mut length = Moving::without_rate(self.now.norm());
        if let Some(rate) = self.rate {
            length.rate = Some(self.now.dot(rate) / length.now);
        }
        length
    }
}

/// A pose from which parts can be read.
pub(super) trait PoseReader<T: Real> {
    /// Unit vector along the spin axis, positive outboard.
    fn spin_axis(&mut self) -> Moving<Vector3<T>>;
    /// Present position of a point.
    fn point(&mut self, id: PointId) -> Moving<Vector3<T>>;
    /// A point of the steering axis and an upward vector along it. `None` if there is no steering axis, or if it is not
    /// known.
    fn steering_axis(&mut self) -> Option<[Moving<Vector3<T>>; 2]>;
    /// Angle of a rocker from its design position.
    fn rocker_angle(&mut self, id: RockerId) -> Moving<T>;
}

impl<T: Real> Inputs<Jet<T, 2>> {
    /// Inputs in the present pose. The rates are the derivatives of `now` along the series.
    pub(crate) fn with_rates(&self) -> Inputs<T> {
        Inputs {
            rate: self.now.map(|c| c[1]),
            ..self.map(|c| c[0])
        }
    }
}

impl<T: Real> Inputs<T> {
    /// Inputs before any part is read: every number is `nothing`, which is NaN.
    #[inline(always)]
    pub(super) fn unknown(nothing: T, constants: Constants) -> Self {
        let wheel = Wheel::filled(nothing);
        Inputs {
            now: wheel,
            rate: wheel,
            turn: wheel.centre,
            design: DesignWheel::filled(nothing),
            constants,
        }
    }

    /// Reads the inputs for these slots from a pose, with their derivatives if the pose knows them.
    #[inline(always)]
    pub(super) fn read(
        &mut self,
        pose: &mut impl PoseReader<T>,
        mechanism: &Mechanism,
        slots: Slots,
    ) {
        let Inputs { now, rate, .. } = self;
        if slots.contain_either(Slot::SpinAxis, Slot::SpinAxisRate) {
            pose.spin_axis()
                .put(&mut now.spin_axis, &mut rate.spin_axis);
        }
        if slots.contain_either(Slot::Centre, Slot::CentreRate) {
            pose.point(mechanism.wheel_centre)
                .put(&mut now.centre, &mut rate.centre);
        }
        if slots.contain_steering_axis()
            && let Some([point, along]) = pose.steering_axis()
        {
            point.put(&mut now.steering_point, &mut rate.steering_point);
            along.put(&mut now.steering_direction, &mut rate.steering_direction);
        }
        let of_length = slots.contain_either(Slot::SpringLength, Slot::SpringLengthRate);
        if (of_length || slots.contains(Slot::Spring))
            && let Some(spring) = mechanism.spring
        {
            let upper = pose.point(spring.upper);
            let along = upper.minus(pose.point(spring.lower));
            if slots.contains(Slot::Spring) {
                along.put(&mut now.spring, &mut rate.spring);
            }
            if of_length {
                let length = along.norm();
                length.put(&mut now.spring_length, &mut rate.spring_length);
            }
        }
        if slots.contains(Slot::RockerAngle)
            && let Some(rocker) = mechanism.spring_rocker()
        {
            let angle = pose.rocker_angle(rocker);
            angle.put(&mut now.rocker_angle, &mut rate.rocker_angle);
        }
        if slots.contain_either(Slot::BarAngle, Slot::BarAngleRate)
            && let Some(bar) = mechanism.anti_roll_bar()
        {
            let angle = pose.rocker_angle(bar);
            angle.put(&mut now.bar_angle, &mut rate.bar_angle);
        }
        if slots.contains(Slot::StrutUpper)
            && let Some(upper) = mechanism.strut_upper()
        {
            let point = pose.point(upper);
            point.put(&mut now.strut_upper, &mut rate.strut_upper);
        }
        if slots.contains(Slot::HeaveSpring)
            && let Some(end) = mechanism.heave_spring()
        {
            let point = pose.point(end);
            point.put(&mut now.heave_spring, &mut rate.heave_spring);
        }
    }

    /// Reads the slots that depend only on the design.
    #[inline(always)]
    pub(super) fn read_design(
        &mut self,
        mechanism: &Mechanism,
        design: &[Vector3<T>],
        slots: Slots,
    ) {
        if slots.contains(Slot::DesignSpinAxis) {
            self.design.spin_axis = DesignedSpinAxis::of(mechanism, design).direction;
        }
        if slots.contains(Slot::DesignCentre) {
            self.design.centre = design[mechanism.wheel_centre.0];
        }
        if slots.contains(Slot::DesignSpringLength)
            && let Some(spring) = mechanism.spring
        {
            let along = design[spring.upper.0] - design[spring.lower.0];
            self.design.spring_length = along.norm();
        }
        if slots.contains(Slot::DesignHeaveSpring)
            && let Some(end) = mechanism.heave_spring()
        {
            self.design.heave_spring = design[end.0];
        }
    }

    /// Reads these slots from a configuration without its rates. The rates and all other slots are NaN.
    #[inline]
    pub fn without_rates(at: &Configuration<T>, constants: Constants, slots: Slots) -> Self {
        let nothing = at.rack.constant(f64::NAN);
        Inputs::of_configuration(at, nothing, constants, slots)
    }

    /// Reads like [`Inputs::without_rates`], but fills other numbers with `nothing` instead of NaN.
    #[inline(always)]
    pub(super) fn of_configuration(
        at: &Configuration<T>,
        nothing: T,
        constants: Constants,
        slots: Slots,
    ) -> Self {
        let mut inputs = Inputs::unknown(nothing, constants);
        inputs.read_design(at.mechanism, at.design, slots);
        inputs.read(&mut { at }, at.mechanism, slots);
        inputs
    }
}

impl<T: Real> PoseReader<T> for &Configuration<'_, T> {
    #[inline(always)]
    fn spin_axis(&mut self) -> Moving<Vector3<T>> {
        Moving::without_rate(Configuration::spin_axis(self))
    }

    #[inline(always)]
    fn point(&mut self, id: PointId) -> Moving<Vector3<T>> {
        Moving::without_rate(Configuration::point(self, id))
    }

    #[inline(always)]
    fn steering_axis(&mut self) -> Option<[Moving<Vector3<T>>; 2]> {
        let (point, along) = Configuration::steering_axis(self)?;
        Some([Moving::without_rate(point), Moving::without_rate(along)])
    }

    #[inline(always)]
    fn rocker_angle(&mut self, id: RockerId) -> Moving<T> {
        Moving::without_rate(Configuration::rocker_angle(self, id))
    }
}

/// A pose without numbers that records which parts are requested.
#[derive(Clone, Debug, Default)]
pub(super) struct ReadSet {
    pub(super) points: Vec<PointId>,
    rocker_angles: Vec<RockerId>,
    pub(super) steering_axis: bool,
}

impl ReadSet {
    /// Parts of a pose that are needed for the inputs (slots) in this set.
    pub(super) fn by(mechanism: &Mechanism, slots: Slots) -> Self {
        let mut asked = ReadSet::default();
        Inputs::unknown(f64::NAN, Constants::default()).read(&mut asked, mechanism, slots);
        asked
    }

    /// Rockers that directly move the requested parts.
    pub(super) fn rockers(&self, mechanism: &Mechanism) -> impl Iterator<Item = RockerId> {
        let points = self.points.iter();
        points
            .filter_map(|point| mechanism.rockers_moving(*point).next())
            .chain(self.rocker_angles.iter().copied())
    }
}

impl PoseReader<f64> for ReadSet {
    fn spin_axis(&mut self) -> Moving<Vector3<f64>> {
        Moving::without_rate(Vector3::new(f64::NAN, f64::NAN, f64::NAN))
    }

    fn point(&mut self, id: PointId) -> Moving<Vector3<f64>> {
        self.points.push(id);
        self.spin_axis()
    }

    fn steering_axis(&mut self) -> Option<[Moving<Vector3<f64>>; 2]> {
        self.steering_axis = true;
        None
    }

    fn rocker_angle(&mut self, id: RockerId) -> Moving<f64> {
        self.rocker_angles.push(id);
        Moving::without_rate(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::characteristics::WheelReading;
    use crate::derive::DesignSeries;
    use crate::mechanism::Pose;
    use crate::number::{Dual, Jet, Matrix3};
    use crate::study::Study;
    use std::cell::Cell;
    use std::path::Path;

    /// The test reads each slot alone from three suspensions. In at least one of them, the slot's input must have a
    /// value.
    #[test]
    fn every_slot_is_read_to_where_it_is_kept() {
        let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../studies");
        let mut seen = Slots::default();
        for name in [
            "double_wishbone_pushrod.toml",
            "double_wishbone_monoshock.toml",
            "attia.toml",
        ] {
            let study = Study::read(&studies.join(name), &[]);
            let suspension = study.expect("a study of the repository").into_wheel();
            let (mechanism, design) = (&suspension.mechanism, &suspension.design);
            let series = DesignSeries::<2>::new(mechanism, design);
            let pose = Pose {
                origin: design[mechanism.origin.0],
                rotation: Matrix3::identity(0.0),
            };
            let at = series.at(mechanism, pose.map(Jet::constant), Jet::constant(0.0));
            for slot in Slot::ALL {
                let slots = Slots::default().with(&[*slot]);
                let reading = WheelReading::reading(&at, Constants::default(), slots);
                let mut seeded = reading.inputs().map(Dual::<_, 3>::constant);
                slot.seed(&mut seeded, Jet::constant(1.0));
                let is_read = Cell::new(true);
                seeded.map(|number| {
                    let is_there = number.partials.iter().any(|by| by[0] != 0.0);
                    is_read.set(is_read.get() && (!is_there || number.value[0].is_finite()));
                });
                if is_read.get() {
                    seen = seen.with(&[*slot]);
                }
            }
        }
        for slot in Slot::ALL {
            assert!(seen.contains(*slot), "{slot:?}");
        }
    }
}

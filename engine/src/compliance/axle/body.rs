//! Body that carries both wheels (solid axle): pose, motion, and the axle without its springs.

use super::derivatives::{AxleChange, AxleTangent};
use super::{AxleEquilibrium, ElasticAxle};
use crate::compliance::algebra::Placed;
use crate::compliance::system::{Limb, State};
use crate::model::{Side, mirrored};
use crate::number::{Each, Jet, Matrix3, Scalar, Vector3};

/// Pose of a solid axle, in the axes of the left wheel.
#[derive(Clone, Copy, Debug)]
pub struct AxlePlace<T> {
    /// Displacement of the point midway between the wheel centres, from the design position.
    pub middle: Vector3<T>,
    /// Direction of the axle's x axis, which is forward in the design position.
    pub forward: Vector3<T>,
    /// Direction of the axle's y axis, which is to the left in the design position.
    pub line: Vector3<T>,
}

impl<T: Scalar> AxlePlace<T> {
    /// Computes the pose of the solid axle. For each side, the arguments are the position of the axle and the vector to
    /// the wheel centre, in the axes of this side.
    fn of([left, right]: [(&Placed<T>, Vector3<T>); 2]) -> Self {
        let shift = |(placed, lever): (&Placed<T>, Vector3<T>)| placed.displacement(lever);
        let sum = shift(left) + mirrored(shift(right));
        let like = sum.x;
        let (zero, one) = (like.zero(), like.one());
        AxlePlace {
            middle: sum.scaled(0.5),
            forward: left.0.lever(Vector3::new(one, zero, zero)),
            line: left.0.lever(Vector3::new(zero, one, zero)),
        }
    }

    /// Returns the pose of the axle relative to another reference position. `home` is the rotation from that reference
    /// position to the design position.
    pub(crate) fn counted_from(&self, home: &Matrix3<f64>) -> Self {
        let axes = [self.forward, self.line, self.forward.cross(self.line)];
        let turned = |column: Vector3<f64>| {
            let parts = axes.into_iter().zip(column.to_array());
            let parts = parts.map(|(axis, share)| axis.scaled(share));
            parts.fold(axes[0].zero(), |sum, part| sum + part)
        };
        let [forward, line, _] = home.columns;
        AxlePlace {
            middle: self.middle,
            forward: turned(forward),
            line: turned(line),
        }
    }
}

impl<T: Scalar> ElasticAxle<T> {
    /// Returns true if one body carries both wheels.
    pub fn is_joined(&self) -> bool {
        self.shared.is_joined
    }

    /// Returns the pose of a body that carries both wheels; `None` for independently suspended wheels.
    pub fn place(&self, at: &AxleEquilibrium<T>) -> Option<AxlePlace<T>> {
        let side = |side: usize| {
            let centre = self.wheels[side].built.system.wheel.centre;
            (&at.state.wheels[side].carrier, centre)
        };
        self.is_joined().then(|| AxlePlace::of([side(0), side(1)]))
    }

    /// Returns the pose of the solid axle, with its first derivatives with respect to an input.
    pub(crate) fn place_along(
        &self,
        tangent: &AxleTangent<T>,
        change: &AxleChange<T>,
    ) -> Option<AxlePlace<Jet<T, 2>>> {
        let rate = self.rate(tangent, change);
        let moving = [0, 1].each(|side: usize| {
            let state: State<Jet<T, 2>> =
                self.wheels[side].moving(&tangent.state.wheels[side], &rate.wheels[side]);
            let centre = self.wheels[side].built.system.wheel.centre;
            (state.carrier, centre.map(Jet::constant))
        });
        let [left, right] = &moving;
        self.is_joined()
            .then(|| AxlePlace::of([(&left.0, left.1), (&right.0, right.1)]))
    }

    /// Returns the height of the roll centre above the point midway between the contact points, and its distance to the
    /// left of that point. The wheels have equal and opposite travels. Let v be the velocity of the axle at that point,
    /// and w the angular velocity of the axle. In front view, the centre of this motion is v.y/w.x above the point and
    /// -v.z/w.x to its left. `None` for independently suspended wheels.
    pub fn roll_centre(&self, at: &AxleEquilibrium<T>, tangent: &AxleTangent<T>) -> Option<[T; 2]> {
        if !self.is_joined() {
            return None;
        }
        let one = self.like().one();
        let rate = self.rate(tangent, &AxleChange::Travels([one, -one]));
        let [x, y, z, a, b, c] = rate.wheels[0].carrier;
        let turn = Vector3::new(a, b, c);
        let contact = |side: Side| self.figures(at, side).contact;
        let middle = contact(Side::Left) + mirrored(contact(Side::Right));
        let reference = self.wheels[0].built.reference + at.state.wheels[0].carrier.shift;
        let lever = middle.scaled(0.5) - reference;
        let velocity = Vector3::new(x, y, z) + turn.cross(lever);
        Some([velocity.y / turn.x, -(velocity.z / turn.x)])
    }

    /// Returns this axle without springs and anti-roll bar, so that only its links hold it. Its equilibrium releases the
    /// forces that the links have at the design load. `None` for independently suspended wheels.
    pub fn on_its_links(&self) -> Option<Self> {
        if !self.is_joined() {
            return None;
        }
        let mut axle = self.clone();
        axle.bar_rate = None;
        axle.shared.has_bar = false;
        for wheel in &mut axle.wheels {
            let system = &mut wheel.built.system;
            system.bar = None;
            // The spring is the last part in the list.
            if let Some(Limb::CarrierSeat(_)) = system.limbs.last() {
                system.limbs.pop();
                system.holders.limbs.pop();
                wheel.built.names.pop();
            }
            // Without the spring, the design position is not an equilibrium.
            wheel.has_offset = true;
        }
        Some(axle)
    }

    /// Adds derivatives to an equilibrium of [`ElasticAxle::on_its_links`]. Its wheel travels and rack displacement equal
    /// the values in the equilibrium `held`.
    pub(in crate::compliance) fn carried_on_links(
        &self,
        at: &AxleEquilibrium,
        held: &AxleEquilibrium<T>,
    ) -> Option<AxleEquilibrium<T>> {
        self.carried(&at.state, &held.task)
    }
}

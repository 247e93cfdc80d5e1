//! Tensions of drag link and tie rod under a load.
//!
//! The knuckles of a steered axle are rockers. A force on a knuckle is equivalent to a wrench on the axle. The tension
//! of the knuckle's rod changes this wrench (see `mechanism/rocker.rs`). Let e be the kingpin's direction, f a point of
//! the kingpin, F the forces at points x, and M the couples on the knuckle. With u the unit vector along the rod from
//! its end n on the knuckle, the tension is
//!
//! ```text
//! k = -e.(sum (x - f) x F + sum M)/(e.(n - f) x u)                                              (1)
//! ```
//!
//! First, the tension of the tie rod is computed from the balance of the right knuckle. Then the tension of the drag
//! link is computed from the balance of the left knuckle, on which the tie rod also acts.

use super::loads::{Balance, Balanced, Load};
use crate::model::{RockerId, Rod};
use crate::number::{Each, Vector3};

impl<T: Balanced> Balance<'_, T> {
    /// Computes the tensions of drag link and tie rod of a steered axle. The load is on the near wheel, whose mechanism
    /// this is. `near` and `far` are the forces of the supports at this wheel and at the opposite wheel.
    pub(super) fn steering(&self, load: &Load<T>, near: T, far: T) -> Option<[T; 2]> {
        let at = &self.at;
        let rigid = at.mechanism.rigid_axle.as_ref()?;
        let steering = rigid.steering.as_ref()?;
        let zero = at.rack.zero();
        let up = |support: T| {
            if self.is_at_wheel {
                Vector3::new(zero, zero, support)
            } else {
                Vector3::new(zero, zero, zero)
            }
        };
        let (centre, far_centre) = (at.mechanism.wheel_centre, rigid.far_centre);
        let (force, moment) = (
            load.point.constant(load.force),
            load.point.constant(load.moment),
        );
        let tension = |knuckle: RockerId| {
            if knuckle == steering.near_knuckle {
                at.rod_tension(knuckle, load.point, force)
                    + at.rod_tension_by_couple(knuckle, moment)
                    + at.rod_tension(knuckle, at.point(centre), up(near))
            } else {
                at.rod_tension(knuckle, at.point(far_centre), up(far))
            }
        };
        let knuckles = [steering.near_knuckle, steering.far_knuckle];
        let is_pulled = |id: &RockerId| at.mechanism.rocker(*id).rod == Rod::DragLink;
        let first = knuckles.into_iter().find(is_pulled)?;
        let second = knuckles.into_iter().find(|id| *id != first)?;
        let tie_rod = tension(second);
        let rod = at.mechanism.rocker(second);
        let [own, other] = [rod.outer, rod.inner].each(|id| at.point(id));
        let pull = (other - own).normalised() * tie_rod;
        Some([tension(first) + at.rod_tension(first, own, pull), tie_rod])
    }
}

//! Tension in the rod of a rocker, from the moments about the rocker's axis.

use super::pose::Configuration;
use super::rocker::Turn;
use crate::model::RockerId;
use crate::number::{Each, Scalar, Vector3};

impl<T: Scalar> Configuration<'_, T> {
    /// Tension in the rod of a rocker for a force at a point of the rocker.
    pub(crate) fn rod_tension(&self, id: RockerId, at: Vector3<T>, force: Vector3<T>) -> T {
        let rocker = self.mechanism.rocker(id);
        let first = self.out_of_base(rocker, self.designed(rocker.first));
        self.rod_tension_by_couple(id, (at - first).cross(force))
    }

    /// Tension in the rod of a rocker for a couple on the rocker.
    pub(crate) fn rod_tension_by_couple(&self, id: RockerId, couple: Vector3<T>) -> T {
        let rocker = self.mechanism.rocker(id);
        let ends = [rocker.first, rocker.second].each(|id| self.designed(id));
        let [first, second] = ends.each(|end| self.out_of_base(rocker, end));
        let axis = second - first;
        let [inner, outer] = [rocker.inner, rocker.outer].each(|id| self.point(id));
        let pull = (outer - inner).normalised();
        -axis.dot(couple) / axis.dot((inner - first).cross(pull))
    }

    /// Tension in the rod of a rocker for a moment on the rocker. The rocker's axis is fixed in the body. The moment is
    /// positive in the direction of the rocker's positive angle.
    pub(crate) fn rod_tension_by_moment(&self, id: RockerId, moment: T) -> T {
        let rocker = self.mechanism.rocker(id);
        let [first, second] = [rocker.first, rocker.second].each(|id| self.designed(id));
        let axis = (second - first).normalised();
        let [inner, outer] = [rocker.inner, rocker.outer].each(|id| self.point(id));
        let pull = (outer - inner).normalised();
        let sense = Turn::of(self.ends(rocker)).sense(rocker.rod);
        -(moment * sense) / axis.dot((inner - first).cross(pull))
    }
}

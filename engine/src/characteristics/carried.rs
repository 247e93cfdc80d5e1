//! Forces in links, joints and the spring under a load on the wheel, for targets and constraints.

use super::{Slot, WheelReading};
use crate::analyse::{Balance, Carried, Load, LoadPoint, Support};
use crate::model::{Mechanism, RockerId};
use crate::number::{Jet, Vector3};

/// Force in a member under a load, in the kernel's frame (x forward, y left, z up, for a left wheel).
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedForce {
    /// Point at which the load acts.
    pub at: LoadPoint,
    /// Force of the load.
    pub force: Vector3<f64>,
    /// Moment of the load, in units of force times length.
    pub moment: Vector3<f64>,
    /// Support that balances the load: the spring, or a vertical force at the wheel centre.
    pub support: Support,
    /// Reaction whose value is the force, such as the tension of a rod.
    pub what: Carried,
}

impl CarriedForce {
    /// Inputs (slots) that determine the point where a load acts.
    pub(crate) const READS: &'static [Slot] = &[Slot::SpinAxis, Slot::Centre];

    /// Rocker that transmits the spring force, if the spring is the support.
    pub(super) fn rocker(&self, mechanism: &Mechanism) -> Option<RockerId> {
        self.support.rocker(mechanism)
    }

    /// Value of the reaction as a series along the motion. The value follows from the balance of forces under this load
    /// and with this support. `view` must have read spin axis and wheel centre.
    pub fn value<const N: usize>(
        &self,
        view: &WheelReading<N>,
        balance: &Balance<'_, Jet<f64, N>>,
    ) -> Option<Jet<f64, N>> {
        let carried = balance.under(&Load {
            point: balance.place(self.at, view.contact_point()),
            force: self.force,
            moment: self.moment,
        });
        balance.force(&carried, self.what)
    }
}

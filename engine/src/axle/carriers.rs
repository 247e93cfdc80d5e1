//! Bodies that carry the wheels of an axle.

use super::Axle;
use crate::model::AxleTravel;

/// Bodies that carry the wheels of an axle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carriers {
    /// Each wheel has its own carrier. The carrier moves with the travel of this wheel and with the rack.
    Independent,
    /// One body carries both wheels. The position of a wheel is a function of two travels of the axle: the mean travel, and
    /// half the difference of the travels. One of these travels drives the axle. The other is held: it stays constant, and
    /// takes the place of the rack displacement.
    Rigid(AxleTravel),
    /// One body carries both wheels, and each wheel is on a knuckle that turns in this body. The [`AxleTravel`] is the held
    /// travel.
    Steered(AxleTravel),
}

impl Carriers {
    /// Returns the carriers of an axle.
    pub(crate) fn of(axle: &Axle) -> Self {
        match &axle.left.mechanism.rigid_axle {
            Some(rigid) if rigid.steering.is_some() => Carriers::Steered(rigid.held),
            Some(rigid) => Carriers::Rigid(rigid.held),
            None => Carriers::Independent,
        }
    }

    /// Returns true if one body carries both wheels.
    #[inline(always)]
    pub fn is_rigid(self) -> bool {
        self != Carriers::Independent
    }

    /// Returns the held travel of a rigid axle: the travel that stays constant while the other travel drives the axle. `None` for
    /// independent wheels.
    #[inline(always)]
    pub(crate) fn held(self) -> Option<AxleTravel> {
        match self {
            Carriers::Independent => None,
            Carriers::Rigid(held) | Carriers::Steered(held) => Some(held),
        }
    }

    /// Powers of the driving travel and the held travel in a Taylor coefficient of a wheel. This coefficient is the first
    /// derivative with respect to half the difference of travels: this wheel rises, and the other falls at the same rate. Only for
    /// a rigid axle.
    #[inline(always)]
    pub(crate) fn by_difference(self) -> [usize; 2] {
        match self.held() {
            Some(AxleTravel::Difference) => [0, 1],
            _ => [1, 0],
        }
    }

    /// Powers of the driving travel and the held travel in a Taylor coefficient of a wheel. This coefficient is the first
    /// derivative with respect to the mean travel. Only for a rigid axle.
    #[inline(always)]
    pub(crate) fn by_mean(self) -> [usize; 2] {
        let [travel, rack] = self.by_difference();
        [rack, travel]
    }
}

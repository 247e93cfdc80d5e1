//! `[setup]` and `[tolerance]`, resolved: adjustments, tolerance sources and bands.

use super::*;
use crate::assembly::{Member, Static};
use crate::model::{ClosedForm, Mechanism};

/// Set-up: adjustments and target values.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Adjustments. The list is not empty.
    pub adjust: Vec<Adjustment>,
    /// Target values in the static position.
    pub want: Vec<Want>,
    /// Target change of the ride height, in study units. Positive if the car becomes higher. The wheel travel of the new static
    /// position has the same magnitude and the opposite sign.
    pub ride_height_change: Option<f64>,
}

/// An adjustable dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjustment {
    /// Name of the adjustment: `tie_rod`, `upper_ball_joint y`.
    pub name: String,
    /// Dimension that changes, and its change per unit of the adjustment. The change is in the kernel's frame (left wheel,
    /// x forward, y left, z up).
    pub change: (BuildParameter, f64),
    /// Half of an axle that has the dimension, if the axle is set up as a whole. `None` if both wheels are adjusted alike,
    /// or if the part exists only once.
    pub side: Option<Side>,
    /// For a solid axle: the same change, as a dimension in the mechanism of the other wheel. `None` if that mechanism does
    /// not have the part.
    pub seen_from_other: Option<(BuildParameter, f64)>,
    /// Steps in which the adjustment can be set.
    pub increment: Increment,
}

impl Adjustment {
    /// Returns true if the adjustment acts on the wheel of this side. Always true for a single wheel.
    pub(crate) fn is_of(&self, side: Option<Side>) -> bool {
        self.side.is_none() || side.is_none() || self.side == side
    }

    /// Returns true if the adjustment lifts the car, because it changes a part between spring and arm. The spring keeps its
    /// length, so the adjustment changes the ride height.
    pub(crate) fn lifts(&self, mechanism: &Mechanism) -> bool {
        let Some(spring) = mechanism.spring else {
            return false;
        };
        match self.change.0 {
            BuildParameter::Length(Member::Rod(rocker)) => {
                Some(rocker) == mechanism.spring_rocker()
            }
            BuildParameter::Length(Member::Link(_) | Member::Extra(_)) => false,
            BuildParameter::Coordinate(point, _) => {
                let is_strut = matches!(mechanism.closed_form, Some(ClosedForm::Strut));
                !is_strut && (point == spring.upper || point == spring.lower)
            }
        }
    }

    /// Returns the change as a dimension in the mechanism of one wheel of a solid axle. Empty if this mechanism does not have
    /// the part.
    pub fn seen_from(&self, wheel: Side) -> Vec<(BuildParameter, f64)> {
        if self.side.unwrap_or(Side::Left) == wheel {
            vec![self.change]
        } else {
            self.seen_from_other.into_iter().collect()
        }
    }
}

/// Steps in which an adjustment can be set, in study units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Increment {
    /// A thread, set continuously or in fractions of a turn.
    Thread {
        /// Change of length per turn, for both threads of the rod together.
        per_turn: f64,
    },
    /// A whole number of shims.
    Shims {
        /// Thickness of the thinnest shim.
        step: f64,
    },
    /// Any amount, for example with a slotted plate.
    Free,
}

/// Target value of a quantity in the static position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Want {
    /// Quantity whose static value has a target.
    pub of: Static,
    /// Target value in the printed unit, as written in the study.
    pub value: f64,
}

/// Tolerances of built vehicles, and the limits that these vehicles must satisfy.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Number of builds (vehicles with random deviations within the tolerances).
    pub builds: u64,
    /// Seed of the random builds.
    pub seed: u32,
    /// True if toe and camber are set again after assembly.
    pub aligned: bool,
    /// Scattering parts and rates, at least one.
    pub scatter: Vec<Contributor>,
    /// Limits that the built vehicles must satisfy.
    pub bands: Vec<Band>,
}

/// A scattering part: a point, a length, a jig or a rate. For an axle it can include the counterpart at the other wheel.
#[derive(Clone, Debug, PartialEq)]
pub struct Contributor {
    /// Name of the scattering part.
    pub name: String,
    /// Independent random numbers of the part.
    pub sources: Vec<Source>,
}

/// A tolerance source: a random number that is independent of all others.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Name of the tolerance source.
    pub name: String,
    /// Dimensions that the random number changes, each with its change per unit of the number. The changes are in the
    /// kernel's frame (left wheel, x forward, y left, z up).
    pub changes: Vec<(BuildParameter, f64)>,
    /// Rate of an elastic part, if the source changes a rate instead of coordinates.
    pub rate: Option<Rate>,
    /// Distribution of the random number.
    pub law: Law,
    /// Wheel of an axle that has the dimensions of the source, in the axes of a left wheel (mirrored for a right wheel).
    /// `None` for a part that both wheels share. The dimensions then belong to the left wheel.
    pub side: Option<Side>,
    /// Dimensions of the source, as they are in the mechanism of a solid axle's other wheel. Empty for other vehicles.
    pub seen_from_other: Vec<(BuildParameter, f64)>,
}

impl Source {
    /// Makes a tolerance source that changes these dimensions of one wheel.
    pub(super) fn of_parts(name: String, changes: Vec<(BuildParameter, f64)>, law: Law) -> Self {
        Source {
            name,
            changes,
            rate: None,
            law,
            side: None,
            seen_from_other: Vec::new(),
        }
    }

    /// Dimensions of a wheel that the source changes, each with its change per unit of the random number. The argument is
    /// `None` for the only wheel of a study. Empty if the source belongs only to the other wheel.
    pub(crate) fn changes_in(&self, wheel: Option<Side>) -> &[(BuildParameter, f64)] {
        let own = self.side.or(wheel.and(Some(Side::Left)));
        if own == wheel {
            &self.changes
        } else {
            &self.seen_from_other
        }
    }
}

/// Distribution of a random number: the deviation of a dimension or a rate from its nominal value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Normal distribution about 0.
    Normal {
        /// Standard deviation of the random number.
        sigma: f64,
    },
    /// Uniform distribution between two ends.
    Uniform {
        /// Lowest value of the random number.
        low: f64,
        /// Highest value of the random number.
        high: f64,
    },
}

/// Lower and upper limit of a quantity of built vehicles, in radians or length units.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Quantity with limits: a characteristic, or a quantity of an axle. Without a side, the quantities of both wheels must
    /// satisfy the limits.
    pub of: TargetQuantity,
    /// Drive value at which the limits apply, or a value of the coordinate that [`Band::site`] varies. `None` for all
    /// stations.
    pub at: Option<f64>,
    /// For an axle: the coordinate of the motion to which `at` refers, and the values of the other coordinates. `None` means
    /// that the limits apply to the whole motion.
    pub site: Option<AxleSite>,
    /// Lower and upper limit of the quantity, in radians or length units. A missing limit is infinite.
    pub between: [f64; 2],
}

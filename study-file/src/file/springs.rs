//! Springs, stops, bars and tyres.

use crate::value::Number;
use serde::Deserialize;
use toml::Spanned;

/// `[spring]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Stiffness of the spring, as force per length.
    pub rate: Option<Number>,
    /// Force of the spring in the design position.
    pub force: Option<Number>,
    /// Pairs of length and force of the spring.
    pub force_curve: Option<Spanned<Vec<Spanned<Vec<Number>>>>>,
}

/// `[bump_stop]` and `[rebound_stop]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BumpStop {
    /// Travel along the spring from the design position to the contact of the stop: shortening for a bump stop, lengthening for a
    /// rebound stop.
    pub gap: Number,
    /// Pairs of stop compression and force.
    pub force_curve: Spanned<Vec<Spanned<Vec<Number>>>>,
}

/// `[tyre]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tyre {
    /// Vertical stiffness of the tyre, as force per length.
    pub rate: Number,
    /// Wheel load at which the tyre has `[wheel] radius`, for a car.
    pub load: Option<Number>,
}

/// `[heave_spring]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeaveSpring {
    /// Stiffness of the heave spring, as force per length.
    pub rate: Number,
    /// Force of the heave spring in the design position.
    pub force: Number,
}

/// `[heave_bar]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeaveBar {
    /// Stiffness of the heave bar: torque per radian of the sum of both rocker angles.
    pub rate: Number,
    /// Torque of the heave bar in the design position, positive if jounce increases it.
    pub torque: Number,
}

/// `[anti_roll_bar]` and `[t_bar]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rate {
    /// Stiffness of the bar, as torque per radian.
    pub rate: Number,
}

/// `[twist_beam]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TwistBeam {
    /// Torque per radian of twist between the two arms.
    pub torsional_rate: Number,
}

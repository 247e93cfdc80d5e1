//! `[setup]` and `[tolerance]`.

use crate::value::{MemberName, Number, Numbers, Text, Whole};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// `[setup]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// Adjustments with which the set-up reaches its target values.
    pub adjust: Spanned<Vec<Spanned<Adjustment>>>,
    /// Target values in the static position by name, in the unit of the quantity.
    pub want: Option<BTreeMap<Text, Number>>,
    /// Target change of the ride height, positive if the car becomes higher. An alternative is `travel`.
    pub ride_height_change: Option<Number>,
    /// Wheel travel of the new static position. Alternative to `ride_height_change`, with the opposite sign.
    pub travel: Option<Number>,
}

/// An element of `adjust` of `[setup]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adjustment {
    /// Member with an adjustable length. An alternative is `shim`.
    pub length: Option<Spanned<MemberName>>,
    /// Hardpoint that is moved by shims. An alternative to `length`.
    pub shim: Option<Text>,
    /// Direction in which shims move the hardpoint.
    pub axis: Option<Text>,
    /// Change of the length per turn. For a turnbuckle, the sum of both threads.
    pub per_turn: Option<Number>,
    /// Thickness of the thinnest shim.
    pub step: Option<Number>,
    /// For an axle that is set up as a whole, the side whose part is adjusted. Without this key, the parts of both sides are
    /// adjusted independently.
    pub side: Option<Text>,
}

/// `[tolerance]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    /// Number of builds.
    pub builds: Option<Whole>,
    /// Seed of the random builds.
    pub seed: Option<Whole>,
    /// True if toe and camber are set again after assembly.
    pub aligned: Option<Spanned<bool>>,
    /// Dimensions that scatter.
    pub scatter: Spanned<Vec<Spanned<Scatter>>>,
    /// Limits of characteristics that define the yield.
    pub bands: Option<Vec<Spanned<Band>>>,
}

/// An element of `scatter` of `[tolerance]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Name of a hardpoint that scatters.
    pub hardpoint: Option<Text>,
    /// Names of several hardpoints that scatter independently.
    pub hardpoints: Option<Spanned<Vec<Text>>>,
    /// Name of a member whose length scatters.
    pub length: Option<Spanned<MemberName>>,
    /// Names of hardpoints on one jig. They scatter together as a rigid body.
    pub jig: Option<Spanned<Vec<Text>>>,
    /// Name of a bushing whose stiffness scatters.
    pub bushing: Option<Text>,
    /// Axis of the bushing's stiffness: `x`, `y`, `z`, `tx`, `ty` or `tz`.
    pub stiffness: Option<Text>,
    /// Name of a link with axial stiffness.
    pub link: Option<Text>,
    /// Name of a part with one rate: `spring`, `anti_roll_bar`, `rack` or `column`.
    pub rate: Option<Text>,
    /// True if the scatter of a rate is given in fractions of the rate.
    pub relative: Option<Spanned<bool>>,
    /// For an axle, the wheel whose parts scatter. If omitted, the parts of both wheels scatter.
    pub side: Option<Text>,
    /// The one coordinate that scatters. If omitted, all three coordinates scatter.
    pub axis: Option<Text>,
    /// Standard deviation of a deviation with a normal distribution.
    pub sigma: Option<Number>,
    /// Ends `[lowest, highest]` of a deviation with a uniform distribution.
    pub limits: Option<Spanned<Vec<Number>>>,
    /// Standard deviation of each component of the jig's displacement.
    pub shift: Option<Number>,
    /// Standard deviation of each component of the jig's rotation, degrees.
    pub turn: Option<Number>,
}

/// An element of `bands` of `[tolerance]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Name of the characteristic that the band limits.
    pub characteristic: Text,
    /// Drive value at which the band applies. The default is the whole motion.
    pub at: Option<Number>,
    /// Name of the motion in which the band applies. The default is `[motion]`.
    pub motion: Option<Text>,
    /// For an axle, the coordinate of the motion to which `at` refers.
    pub over: Option<Text>,
    /// For an axle, the wheel to which the band applies.
    pub side: Option<Text>,
    /// For an axle: one or several roll angles at which the band applies.
    pub roll: Option<Spanned<Numbers>>,
    /// For an axle: one or several values of heave at which the band applies.
    pub heave: Option<Spanned<Numbers>>,
    /// For an axle: one or several travels of the left wheel at which the band applies.
    pub travel_left: Option<Spanned<Numbers>>,
    /// For an axle: one or several travels of the right wheel at which the band applies.
    pub travel_right: Option<Spanned<Numbers>>,
    /// For an axle: one or several angles of the steering wheel at which the band applies.
    pub steering_wheel_angle: Option<Spanned<Numbers>>,
    /// One or several rack displacements at which the band applies.
    pub rack: Option<Spanned<Numbers>>,
    /// Lowest and highest permitted value of the characteristic.
    pub between: Option<Spanned<Vec<Number>>>,
    /// Lowest permitted value of the characteristic, if there is no highest value.
    pub at_least: Option<Number>,
    /// Highest permitted value of the characteristic, if there is no lowest value.
    pub at_most: Option<Number>,
}

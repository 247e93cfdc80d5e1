//! `[motion]` and `[solver]`.

use crate::value::{Number, Text, Values, Whole};
use serde::Deserialize;
use serde::de::IgnoredAny;
use toml::Spanned;

/// `[motion]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// `travel`, `arm_angle` or `paper_theta`. For an axle with `time`, the key of the coordinate that depends on time.
    pub drive: Option<Text>,
    /// Heights of the wheel centre above its design position.
    pub travel: Option<Spanned<Values>>,
    /// Angles of the first arm from its design position, in `angle_unit`.
    pub arm_angle: Option<Spanned<Values>>,
    /// Values of the angle theta of Attia's paper, in `angle_unit`.
    pub theta: Option<Spanned<Values>>,
    /// Unit of `arm_angle` and `theta`: `deg` or `rad`.
    pub angle_unit: Option<Text>,
    /// Displacements of the rack along the study's +y.
    pub rack: Option<Spanned<Values>>,
    /// Mean travels of an axle's wheel centres.
    pub heave: Option<Spanned<Values>>,
    /// Roll angles of the body, degrees; positive with the right wheel in jounce.
    pub roll: Option<Spanned<Values>>,
    /// Travels of the left wheel.
    pub travel_left: Option<Spanned<Values>>,
    /// Travels of the right wheel.
    pub travel_right: Option<Spanned<Values>>,
    /// Angles of the steering wheel, degrees; positive to the left.
    pub steering_wheel_angle: Option<Spanned<Values>>,
    /// For an axle, ground under the wheels: a common `plane`, or a level pad under each wheel (`pads`).
    pub ground: Option<Text>,
    /// For an axle, quantity that stays constant in roll: `mean_travel`, or the sum of both wheel loads (`wheel_load`).
    pub hold: Option<Text>,
    /// For an axle, stations of the motion. `all`: all combinations of the listed values. `rows`: station n has the n-th value of
    /// each list.
    pub combine: Option<Text>,
    /// Drive as a function of time.
    pub time: Option<Spanned<Time>>,
}

/// `time` of `[motion]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Coefficients of the drive as a polynomial of time, lowest power first.
    pub polynomial: Spanned<Vec<Number>>,
    /// First time, seconds.
    pub from: Number,
    /// Last time, seconds.
    pub to: Number,
    /// Number of time values, both ends included.
    pub steps: Whole,
}

/// `[solver]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Equations to solve: `knuckle_pose` (pose of the wheel carrier) or `point_coordinates` (the equations of Attia's paper).
    pub formulation: Option<Text>,
    /// Obsolete tolerance of poses; refused with an explanation.
    pub accuracy: Option<Spanned<IgnoredAny>>,
}

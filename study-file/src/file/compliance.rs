//! `[compliance]`, `[bushings]`, `[links]` and `[subframe]`.

use super::Coordinates;
use crate::value::{Number, Text, Whole};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// `[compliance]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compliance {
    /// `free`: bushings and links have no force in the design position. `at_design_load`: the design position is the equilibrium
    /// with the spring force.
    pub relaxed: Option<Text>,
    /// Tests of `hardpoint kc`.
    pub tests: Option<Spanned<Vec<Spanned<ComplianceTest>>>>,
    /// For an axle, state of the anti-roll bar in the tests: `connected` or `disconnected`.
    pub anti_roll_bar: Option<Text>,
}

/// An element of `tests` of `[compliance]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComplianceTest {
    /// Name of the test load or of the test motion.
    pub load: Text,
    /// Distance of the side force behind the contact point.
    pub trail: Option<Number>,
    /// Quantity that stays constant while the load changes: `wheel_height` or `wheel_load`.
    pub hold: Option<Text>,
    /// Largest value of the load: a force, or a moment for `aligning`. The load varies from `-window` to `window`.
    pub window: Option<Number>,
    /// Number of load values.
    pub levels: Option<Whole>,
    /// Stations of the test: `all` stations of the motion, or only the one `nearest` to travel 0 and rack 0.
    pub stations: Option<Text>,
    /// For an axle, wheels and directions of the load: `parallel` (both wheels, same direction), `opposed` (both wheels, opposite
    /// directions) or `single` (one wheel).
    pub mode: Option<Text>,
    /// For an axle, part that is held: the steering wheel (`locked_wheel`) or the rack (`locked_rack`).
    pub steering: Option<Text>,
    /// For an axle, state of the anti-roll bar in this test: `connected` or `disconnected`.
    pub anti_roll_bar: Option<Text>,
}

/// Pairs of deflection and force, or of angle and torque.
pub type BushingCurve = Option<Spanned<Vec<Spanned<Vec<Number>>>>>;

/// `[bushings.NAME]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bushing {
    /// Stiffness along the three axes of the bushing, then torque per radian about them. Six numbers are valid.
    pub stiffness: Option<Spanned<Vec<Number>>>,
    /// Coefficient of the cubed deflection in the force or torque, for each axis. Six numbers are valid.
    pub cubic: Option<Spanned<Vec<Number>>>,
    /// Force along x against deflection.
    pub fx: BushingCurve,
    /// Force along y against deflection.
    pub fy: BushingCurve,
    /// Force along z against deflection.
    pub fz: BushingCurve,
    /// Torque about x against angle (rad).
    pub tx: BushingCurve,
    /// Torque about y against angle (rad).
    pub ty: BushingCurve,
    /// Torque about z against angle (rad).
    pub tz: BushingCurve,
    /// Direction of the bushing's x axis in the design position.
    pub x_axis: Option<Coordinates>,
    /// Direction that defines the bushing's z axis, which is its component normal to the x axis.
    pub z_axis: Option<Coordinates>,
    /// Constant forces and torques of the bushing. Six numbers are valid.
    pub preload: Option<Spanned<Vec<Number>>>,
    /// Factors of the bushing's force and torque laws. Six numbers are valid.
    pub scale: Option<Spanned<Vec<Number>>>,
    /// Path of a bushing property file with the force and torque laws.
    pub file: Option<Text>,
}

/// `[subframe]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Subframe {
    /// Hardpoints on the subframe.
    pub carries: Spanned<Vec<Text>>,
    /// Positions of the left mounts of the subframe, by name.
    pub mounts: BTreeMap<Text, Coordinates>,
}

/// `[links.NAME]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkStiffness {
    /// Axial stiffness, as force per length. An alternative is `modulus` with `area`.
    pub axial_stiffness: Option<Number>,
    /// Young's modulus, as force per area. It needs `area`.
    pub modulus: Option<Number>,
    /// Area of the link's cross-section.
    pub area: Option<Number>,
    /// Constant tension of the link, in addition to the tension from the stiffness.
    pub preload: Option<Number>,
}

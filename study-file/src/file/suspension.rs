//! `[suspension]` and `[wheel]`.

use super::Coordinates;
use crate::value::{Number, Text};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// `[suspension]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suspension {
    /// Name of the topology.
    pub topology: Text,
    /// Side of the car on which the wheel of the study is: `left` or `right`.
    pub side: Option<Text>,
    /// Unit of all lengths in the file and in the results: `mm`, `m` or `in`.
    pub length_unit: Option<Text>,
    /// Unit of all forces in the file and in the results: `N` or `lbf`.
    pub force_unit: Option<Text>,
    /// Unit of the masses in `[vehicle]`: `kg` or `lb`.
    pub mass_unit: Option<Text>,
    /// Name of the axis convention.
    pub frame: Option<Text>,
    /// `[suspension.hardpoints]`
    pub hardpoints: Spanned<BTreeMap<Text, Coordinates>>,
    /// Links of a solid axle that exist only once and have their actual y coordinate.
    pub single: Option<Spanned<Vec<Text>>>,
    /// `[suspension.bodies]`: bodies on which ends of springs and rods are mounted.
    #[serde(default)]
    pub bodies: BTreeMap<Text, Text>,
    /// `[suspension.studs]`: directions of the studs in ball joints.
    #[serde(default)]
    pub studs: BTreeMap<Text, Coordinates>,
    /// `[suspension.extra_points]`
    #[serde(default)]
    pub extra_points: BTreeMap<Text, ExtraPoint>,
}

/// A point that is not a hardpoint.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExtraPoint {
    /// Body with which the point moves.
    pub body: Text,
    /// Design position of the point.
    pub position: Coordinates,
}

/// `[wheel]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wheel {
    /// Loaded radius of the wheel.
    pub radius: Option<Number>,
    /// Width of the tyre.
    pub tyre_width: Option<Number>,
    /// Diameter of the rim edge at which toe is measured as a length.
    pub rim_diameter: Option<Number>,
    /// Camber in the design position, degrees.
    pub static_camber: Option<Number>,
    /// Toe in the design position, degrees; positive for toe-in.
    pub static_toe: Option<Number>,
}

//! `[outputs]`.

use super::Coordinates;
use crate::value::{MemberName, Selection, Text};
use serde::Deserialize;
use toml::Spanned;

/// `[outputs]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outputs {
    /// Names of the characteristics that are reported.
    #[serde(default)]
    pub characteristics: Vec<Text>,
    /// Names of the points whose coordinates are reported.
    #[serde(default)]
    pub points: Vec<Text>,
    /// Members, or pairs of points, whose lengths are reported.
    #[serde(default)]
    pub lengths: Vec<Spanned<MemberName>>,
    /// Members, or pairs of points, whose change of length since the design position is reported.
    #[serde(default)]
    pub plunges: Vec<Spanned<MemberName>>,
    /// Joints whose angles are reported.
    #[serde(default)]
    pub articulations: Vec<Text>,
    /// Pairs of members whose distance is reported.
    #[serde(default)]
    pub clearances: Vec<Spanned<Vec<Text>>>,
    /// True if the angular velocity and acceleration of the knuckle are reported.
    pub knuckle: Option<Spanned<bool>>,
    /// Highest derivative that is reported, with respect to the drive or to time: `position` (none), `velocity` or
    /// `acceleration`.
    pub order: Option<Text>,
    /// Hardpoints for which sensitivities of the outputs are computed.
    pub sensitivities: Option<Selection>,
    /// True if the error of each pose must be bounded by a certificate.
    pub certify: Option<Spanned<bool>>,
    /// Loads on the wheel for which forces in links and joints are reported.
    pub loads: Option<Spanned<Vec<Load>>>,
}

/// An element of `loads` of `[outputs]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// First part of the names of the load's columns.
    pub name: Text,
    /// Point at which the force acts: `contact_point` or `wheel_centre`.
    pub at: Text,
    /// For an axle, the loaded wheel. The default is both wheels.
    pub side: Option<Text>,
    /// With elastic parts, the quantity that stays fixed: `wheel_load` or `wheel_height`.
    pub hold: Option<Text>,
    /// Force in the study's axes. Three components are valid.
    pub force: Option<Coordinates>,
    /// Moment about the study's axes. Three components are valid.
    pub moment: Option<Coordinates>,
}

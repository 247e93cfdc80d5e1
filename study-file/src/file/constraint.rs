//! Constraints of `[optimise]`.

use super::Coordinates;
use crate::value::{MemberName, Number, Numbers, Text};
use serde::Deserialize;
use toml::Spanned;

/// An element of `constraints` of `[optimise]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constraint {
    /// In the study of a car, the load case of the constraint.
    pub case: Option<Text>,
    /// In the study of a car, the axle to which the constraint applies.
    pub axle: Option<Text>,
    /// Name of the constraint.
    pub name: Option<Text>,
    /// Length of a member, or distance between two points.
    pub length: Option<Spanned<MemberName>>,
    /// Name of the point that must stay inside or outside a region.
    pub point: Option<Text>,
    /// Two members that must stay apart. With `inside`, any number of members that must stay inside the rim.
    pub members: Option<Spanned<Vec<Text>>>,
    /// Name of a joint whose angle is limited.
    pub articulation: Option<Text>,
    /// Member, or pair of points, whose change of length since the design position is limited.
    pub plunge: Option<Spanned<MemberName>>,
    /// Name of the characteristic that is limited.
    pub characteristic: Option<Text>,
    /// Name of the force under a load that is limited.
    pub load: Option<Text>,
    /// Points that must lie in one plane.
    pub coplanar: Option<Spanned<Vec<Text>>>,
    /// Points that must lie on one line.
    pub line: Option<Spanned<Vec<Text>>>,
    /// Lower and upper limit of the constrained quantity.
    pub between: Option<Spanned<Vec<Number>>>,
    /// Lower limit of the constrained quantity.
    pub at_least: Option<Number>,
    /// Upper limit of the constrained quantity.
    pub at_most: Option<Number>,
    /// True if the length must keep its design value.
    pub kept: Option<Spanned<bool>>,
    /// Region in which a point must stay.
    pub inside: Option<Spanned<Region>>,
    /// Region that a point must not enter.
    pub outside: Option<Spanned<Region>>,
    /// Smallest permitted distance: between two members, or from a point or a member to the boundary of the region.
    pub clearance: Option<Number>,
    /// Radii of the members.
    pub radii: Option<Spanned<Vec<Number>>>,
    /// `design` if the constraint applies to the design position only.
    pub at: Option<Text>,
    /// One or several rack displacements at which the constraint applies.
    pub rack: Option<Spanned<Numbers>>,
    /// Name of the motion in which the constraint applies.
    pub motion: Option<Text>,
    /// For an axle, the only wheel to which the constraint applies.
    pub side: Option<Text>,
}

/// A region. It has one of these shapes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Box with two opposite corners.
    #[serde(rename = "box")]
    pub corners: Option<Spanned<Vec<Coordinates>>>,
    /// Half-space on the side to which a normal points.
    pub half_space: Option<HalfSpace>,
    /// Sphere.
    pub sphere: Option<Sphere>,
    /// Cylinder with closed ends.
    pub cylinder: Option<Cylinder>,
    /// Radius of the inner space of the rim, about the spin axis.
    pub rim: Option<Number>,
    /// Start of the rim's space, as distance outboard of the wheel centre.
    pub from: Option<Number>,
    /// End of the rim's space, as distance outboard of the wheel centre.
    pub to: Option<Number>,
}

/// `half_space`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfSpace {
    /// Point on the boundary plane.
    pub point: Coordinates,
    /// Normal of the plane. It points into the region.
    pub normal: Coordinates,
}

/// `sphere`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Centre of the sphere.
    pub centre: Coordinates,
    /// Radius of the sphere.
    pub radius: Number,
}

/// `cylinder`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// First end of the axis.
    pub from: Coordinates,
    /// Second end of the axis.
    pub to: Coordinates,
    /// Radius of the cylinder.
    pub radius: Number,
}

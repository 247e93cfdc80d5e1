//! `[vehicle]`, `[axle]` and `[steering]`.

use super::Coordinates;
use super::compliance::LinkStiffness;
use super::springs::Spring;
use crate::value::{Number, RightWheel, Text};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// `[vehicle]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vehicle {
    /// Distance between the axles.
    pub wheelbase: Option<Number>,
    /// Distance between the wheels of the axle.
    pub track: Option<Number>,
    /// Height of the centre of gravity above the ground.
    pub cg_height: Option<Number>,
    /// Share of the braking force at the front axle.
    pub brake_share_front: Option<Number>,
    /// Share of the drive force at the front axle.
    pub drive_share_front: Option<Number>,
    /// Position of this axle: `front` or `rear`.
    pub position: Option<Text>,
    /// Part that takes the brake torque: the wheel carrier (`outboard`) or a shaft (`inboard`).
    pub brakes: Option<Text>,
    /// Part that takes the drive torque: the `shafts` or the wheel `carrier`.
    pub drive_torque: Option<Text>,
    /// Mass that the axle carries, in `mass_unit`.
    pub sprung_mass: Option<Number>,
    /// Mass of the axle itself, in `mass_unit`.
    pub unsprung_mass: Option<Number>,
}

/// `[axle]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axle {
    /// `"mirrored"`, or the differences from the mirror image. The default is the mirror image.
    pub right: Option<Spanned<RightWheel>>,
}

/// `[axle.right]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnRight {
    /// Hardpoints that are not the mirror images of the left ones, with their actual coordinates in the study's axes.
    #[serde(default)]
    pub hardpoints: BTreeMap<Text, Coordinates>,
    /// Bodies on which ends of springs and rods are mounted, if they differ from the bodies at the left wheel.
    #[serde(default)]
    pub bodies: BTreeMap<Text, Text>,
    /// Camber and toe of the right wheel.
    pub wheel: Option<Spanned<OwnAngles>>,
    /// Spring of the right wheel.
    pub spring: Option<Spanned<Spring>>,
    /// Bushings whose rates differ from the rates at the left wheel.
    #[serde(default)]
    pub bushings: BTreeMap<Text, Spanned<OwnBushing>>,
    /// Links whose stiffness differs from the stiffness at the left wheel.
    #[serde(default)]
    pub links: BTreeMap<Text, Spanned<LinkStiffness>>,
}

/// `[axle.right.bushings.NAME]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnBushing {
    /// Stiffness along and about the axes of the bushing. Six numbers are valid.
    pub stiffness: Option<Spanned<Vec<Number>>>,
    /// Factors of the force and torque laws. Six numbers are valid.
    pub scale: Option<Spanned<Vec<Number>>>,
}

/// `[axle.right.wheel]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnAngles {
    /// Camber of the right wheel in the design position, degrees.
    pub static_camber: Option<Number>,
    /// Toe of the right wheel in the design position, degrees; positive for toe-in.
    pub static_toe: Option<Number>,
}

/// `[steering]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Steering {
    /// Rack displacement along the study's +y per full turn of the steering wheel to the left.
    pub c_factor: Option<Number>,
    /// Stiffness between commanded and actual rack position, as force per length.
    pub rack_stiffness: Option<Number>,
    /// Stiffness of the steering column: torque per radian at the pinion. This key requires `c_factor`.
    pub column_stiffness: Option<Number>,
    /// Direction in which the steering gear moves the drag link of a solid axle.
    pub direction: Option<Coordinates>,
}

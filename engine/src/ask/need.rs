//! Inputs and suspension parts that each quantity requires.

use crate::model::{AxlePosition, Suspension};

/// Input or part that a quantity requires in addition to the hardpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Need {
    /// `[wheel] radius`.
    WheelRadius,
    /// `[wheel] rim_diameter`.
    RimDiameter,
    /// `[vehicle] wheelbase`.
    Wheelbase,
    /// `[vehicle] cg_height`.
    CgHeight,
    /// A braked front axle: `position`, `brakes` and `brake_share_front` in `[vehicle]`.
    FrontBraking,
    /// A driven rear axle: `position`, `drive_torque` and `drive_share_front` in `[vehicle]`.
    RearDrive,
    /// A braked rear axle or a driven front axle.
    RearBrakingOrFrontDrive,
    /// A spring or strut in the topology.
    Spring,
    /// A rocker with its pushrod or pullrod.
    Rocker,
    /// An anti-roll bar with its drop link.
    AntiRollBar,
    /// A steering axis in the topology: the wheel steers, or a link prevents it from steering.
    SteeringAxis,
    /// `strut_upper` in `[suspension.hardpoints]`.
    StrutUpper,
    /// `[steering] c_factor`.
    CFactor,
    /// `[spring]`, and a spring or strut in the topology.
    SpringForce,
    /// A spring that carries load: `[spring]`, `[heave_spring]` or `[heave_bar]`.
    Springs,
    /// `[heave_spring]`, and the hardpoint `heave_spring`.
    HeaveSpring,
    /// `[t_bar] rate`, and a rocker.
    TBar,
    /// `[heave_bar]`, and a rocker.
    HeaveBar,
    /// `[anti_roll_bar] rate`, and a bar with its drop link in the topology.
    BarRate,
    /// `[twist_beam] torsional_rate`.
    TorsionalRate,
    /// `[tyre] rate`.
    TyreRate,
    /// `[vehicle] sprung_mass`.
    SprungMass,
    /// `[vehicle] unsprung_mass`.
    UnsprungMass,
}

impl Need {
    /// Returns true if the suspension of one wheel meets the need. Needs of axles are never met here; see
    /// [`Axle::meets`](crate::axle::Axle::meets).
    pub fn met_by(self, suspension: &Suspension) -> bool {
        let (mechanism, vehicle) = (&suspension.mechanism, &suspension.vehicle);
        let is_at = |axle: AxlePosition| vehicle.position == Some(axle);
        let has_share = |of_front: Option<f64>| {
            of_front.is_some_and(|share| {
                if is_at(AxlePosition::Front) {
                    share > 0.0
                } else {
                    share < 1.0
                }
            })
        };
        let is_braked = vehicle.brakes.is_some() && has_share(vehicle.brake_share_front);
        let is_driven = vehicle.drive_torque.is_some() && has_share(vehicle.drive_share_front);
        match self {
            Need::WheelRadius => suspension.wheel_radius.is_some(),
            Need::RimDiameter => suspension.rim_diameter.is_some(),
            Need::Wheelbase => vehicle.wheelbase.is_some(),
            Need::CgHeight => vehicle.cg_height.is_some(),
            Need::FrontBraking => is_at(AxlePosition::Front) && is_braked,
            Need::RearDrive => is_at(AxlePosition::Rear) && is_driven,
            Need::RearBrakingOrFrontDrive => {
                (is_at(AxlePosition::Rear) && is_braked)
                    || (is_at(AxlePosition::Front) && is_driven)
            }
            Need::Spring => mechanism.spring.is_some(),
            Need::Rocker => mechanism.spring_rocker().is_some(),
            Need::AntiRollBar => mechanism.anti_roll_bar().is_some(),
            Need::SteeringAxis => mechanism.steering_axis.is_some(),
            Need::StrutUpper => mechanism.strut_upper().is_some(),
            Need::CFactor
            | Need::SpringForce
            | Need::Springs
            | Need::HeaveSpring
            | Need::TBar
            | Need::HeaveBar
            | Need::BarRate
            | Need::TorsionalRate
            | Need::TyreRate
            | Need::SprungMass
            | Need::UnsprungMass => false,
        }
    }

    /// Description of the input or part, for messages of the library.
    pub fn words(self) -> &'static str {
        match self {
            Need::WheelRadius => "the radius of the wheel",
            Need::RimDiameter => "the diameter of the rim",
            Need::Wheelbase => "the wheelbase of the vehicle",
            Need::CgHeight => "the height of the vehicle's centre of gravity",
            Need::FrontBraking => "a braked front axle with its share of the braking",
            Need::RearDrive => "a driven rear axle with its share of the drive",
            Need::RearBrakingOrFrontDrive => "a braked rear axle or a driven front axle",
            Need::Spring => "a spring or strut",
            Need::Rocker => "a rocker with its pushrod or pullrod",
            Need::AntiRollBar => "an anti-roll bar with its drop link",
            Need::SteeringAxis => "a steering axis",
            Need::StrutUpper => "the hardpoint strut_upper",
            Need::CFactor => "the rack's displacement per turn of the steering wheel",
            Need::SpringForce => "the force and rate of the spring",
            Need::Springs => "a spring, heave spring or heave bar with its force",
            Need::HeaveSpring => "a heave spring with its force",
            Need::TBar => "a T-bar with its rate",
            Need::HeaveBar => "a heave bar with its torque",
            Need::BarRate => "the rate of the anti-roll bar",
            Need::TorsionalRate => "the torsional rate of the twist beam",
            Need::TyreRate => "the rate of the tyre",
            Need::SprungMass => "the sprung mass of the axle",
            Need::UnsprungMass => "the unsprung mass of the axle",
        }
    }

    /// Key or part of a study that meets the need. `None` if the need has several keys that belong together, and for a
    /// steering axis, which depends on the topology.
    pub fn key(self) -> Option<&'static str> {
        Some(match self {
            Need::WheelRadius => "radius in [wheel]",
            Need::RimDiameter => "rim_diameter in [wheel]",
            Need::Wheelbase => "wheelbase in [vehicle]",
            Need::CgHeight => "cg_height in [vehicle]",
            Need::StrutUpper => "strut_upper in [suspension.hardpoints]",
            Need::CFactor => "c_factor in [steering]",
            Need::SpringForce => "[spring]",
            Need::Springs => "[spring], [heave_spring] or [heave_bar]",
            Need::HeaveSpring => "[heave_spring]",
            Need::TBar => "[t_bar]",
            Need::HeaveBar => "[heave_bar]",
            Need::BarRate => "[anti_roll_bar]",
            Need::TorsionalRate => "[twist_beam]",
            Need::TyreRate => "[tyre]",
            Need::SprungMass => "sprung_mass in [vehicle]",
            Need::UnsprungMass => "unsprung_mass in [vehicle]",
            Need::Spring | Need::Rocker | Need::AntiRollBar => self.words(),
            Need::FrontBraking
            | Need::RearDrive
            | Need::RearBrakingOrFrontDrive
            | Need::SteeringAxis => return None,
        })
    }
}

//! Load cases, and reasons why one has no equilibrium.

use super::catalogue::WheelPlace;
use crate::mechanism::NoPose;
use std::fmt;

/// A load case. Accelerations are in units of g, in the axes of the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Name.
    pub name: String,
    /// Acceleration forward.
    pub ax: f64,
    /// Acceleration to the left, as in a left turn.
    pub ay: f64,
    /// Acceleration upward, as in a dip.
    pub az: f64,
    /// Speed for the forces of the air, m/s.
    pub speed: f64,
    /// Yaw acceleration to the left, rad/s2.
    pub yaw_acceleration: f64,
    /// Displacements of the racks towards the left wheels, front and rear.
    pub racks: [f64; 2],
    /// Settings of the case.
    pub setting: Setting,
}

/// Choices of a load case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// True if tyres act as springs, provided that the car has tyre springs.
    pub elastic_tyres: bool,
    /// Source of longitudinal forces.
    pub longitudinal: Longitudinal,
    /// Shares of the wheels in the lateral force of their axle.
    pub lateral_shares: LateralShares,
    /// Shares of the wheels in the longitudinal force of their axle.
    pub longitudinal_shares: LongitudinalShares,
    /// Axes of the tyre forces.
    pub tyre_axes: TyreAxes,
}

/// Source of longitudinal forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Longitudinal {
    /// The brakes.
    Brake,
    /// The drive.
    Drive,
}

/// Shares of the wheels in the lateral force of their axle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LateralShares {
    /// In proportion to the wheel loads.
    ByLoad,
    /// Half each.
    Equal,
    /// The left wheel's shares, front and rear.
    Left([f64; 2]),
}

/// Shares of the wheels in the longitudinal force of their axle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LongitudinalShares {
    /// In proportion to the wheel loads.
    ByLoad,
    /// Half each.
    Equal,
}

/// Axes of the tyre forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TyreAxes {
    /// Along and across the heading of each wheel.
    Wheel,
    /// Along and across the vehicle.
    Road,
}

impl Case {
    /// The car at rest, with the racks in the middle.
    pub fn at_rest(name: &str) -> Self {
        Case {
            name: name.to_owned(),
            ax: 0.0,
            ay: 0.0,
            az: 0.0,
            speed: 0.0,
            yaw_acceleration: 0.0,
            racks: [0.0; 2],
            setting: Setting {
                elastic_tyres: true,
                longitudinal: Longitudinal::Drive,
                lateral_shares: LateralShares::ByLoad,
                longitudinal_shares: LongitudinalShares::Equal,
                tyre_axes: TyreAxes::Wheel,
            },
        }
    }
}

/// Reason why a case has no equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub enum NoEquilibrium {
    /// A wheel has no pose on the way.
    NoPose {
        /// The axle; 0 is the front one.
        axle: usize,
        /// Reason.
        failure: NoPose,
    },
    /// Newton's method does not converge.
    NotFound,
    /// The equations are singular.
    Singular,
    /// No set of wheels in contact fits.
    NoContactSet {
        /// A wheel that neither stands nor lifts.
        wheel: WheelPlace,
        /// True if an axle shares its force equally, which may be the cause.
        equal_shares: bool,
    },
    /// All wheels have lifted.
    AllLifted,
    /// Both wheels of an axle have lifted, and it carries a force.
    AxleLifted {
        /// The axle; 0 is the front one.
        axle: usize,
    },
    /// The state was found, but the body would leave it by itself.
    Tips,
    /// Nothing carries the body.
    Unsupported,
}

impl NoEquilibrium {
    /// The status in results.
    pub fn status(&self) -> &'static str {
        match self {
            NoEquilibrium::NoPose { failure, .. } => crate::curves::Status::Failed(*failure).word(),
            NoEquilibrium::Singular => "singular",
            NoEquilibrium::Tips => "unstable",
            NoEquilibrium::Unsupported => "unsupported",
            _ => "no_equilibrium",
        }
    }
}

impl fmt::Display for NoEquilibrium {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let end = |axle: usize| ["front", "rear"][axle];
        match self {
            NoEquilibrium::NoPose { axle, failure } => write!(f, "{} axle, {failure}", end(*axle)),
            NoEquilibrium::NotFound => f.write_str("no equilibrium was found"),
            NoEquilibrium::Singular => {
                f.write_str("the equations of equilibrium are singular: a wheel's travel does not change its height, or nothing takes a force")
            }
            NoEquilibrium::NoContactSet { wheel, equal_shares } => {
                write!(f, "no set of wheels in contact fits: {} pulls on the ground where it stands, and is below the ground where it is lifted", wheel.words())?;
                match equal_shares {
                    true => f.write_str("; a wheel without load cannot take an equal share of a force, use shares \"by_load\""),
                    false => Ok(()),
                }
            }
            NoEquilibrium::AllLifted => f.write_str("all wheels lift: no weight presses them to the ground"),
            NoEquilibrium::AxleLifted { axle } => write!(f, "both wheels of the {} axle lift, and it should carry a force", end(*axle)),
            NoEquilibrium::Tips => f.write_str("the car tips: beyond this state its weight turns it further than springs turn it back"),
            NoEquilibrium::Unsupported => f.write_str("nothing carries the body: the axles have no springs"),
        }
    }
}

//! Load cases, and reasons why a case has no equilibrium.

use super::catalogue::WheelPlace;
use super::{AXLE_NAMES, Car};
use crate::mechanism::NoPose;

/// A load case. Accelerations are in units of g, in the axes of the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Name of the case.
    pub name: String,
    /// Longitudinal acceleration, positive forward.
    pub ax: f64,
    /// Lateral acceleration, positive to the left, as in a left turn.
    pub ay: f64,
    /// Vertical acceleration, positive upward, as in a dip.
    pub az: f64,
    /// Speed in m/s, for aerodynamic forces.
    pub speed: f64,
    /// Yaw acceleration in rad/s2, positive to the left.
    pub yaw_acceleration: f64,
    /// Displacements of the racks towards the left wheels, in length units: [front, rear].
    pub racks: [f64; 2],
    /// Settings of the case: tyres, source of the longitudinal forces, and distribution of the forces.
    pub setting: Setting,
}

/// Settings of a load case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// True if tyres act as springs. This setting has no effect if the car has no tyre springs.
    pub elastic_tyres: bool,
    /// Source of the longitudinal forces: brakes or drive.
    pub longitudinal: Longitudinal,
    /// Distribution of an axle's lateral force between its wheels.
    pub lateral_shares: LateralShares,
    /// Distribution of an axle's longitudinal force between its wheels.
    pub longitudinal_shares: LongitudinalShares,
    /// Axes of the tyre forces.
    pub tyre_axes: TyreAxes,
}

impl Setting {
    /// Returns the change to the case's keys that makes every axle distribute its forces in proportion to the wheel
    /// loads. `None` if every axle already does so.
    pub(super) fn towards_shares_by_load(&self) -> Option<&'static str> {
        use LongitudinalShares::{ByLoad, Equal};
        match (self.lateral_shares, self.longitudinal_shares) {
            (LateralShares::ByLoad, ByLoad) => None,
            (LateralShares::ByLoad, Equal) => Some("set longitudinal_shares = \"by_load\""),
            (LateralShares::Equal, ByLoad) => Some("set lateral_shares = \"by_load\""),
            (LateralShares::Equal, Equal) => {
                Some("set lateral_shares and longitudinal_shares to \"by_load\"")
            }
            (LateralShares::Left(_), ByLoad) => Some("remove lateral_share_left"),
            (LateralShares::Left(_), Equal) => {
                Some("remove lateral_share_left and set longitudinal_shares = \"by_load\"")
            }
        }
    }
}

/// Source of the longitudinal forces of the tyres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Longitudinal {
    /// The brakes. The longitudinal forces then follow the distribution of the braking force.
    Brake,
    /// The drive (engine or motors). The longitudinal forces then follow the distribution of the drive force.
    Drive,
}

/// Distribution of an axle's lateral force between its wheels, while both are on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LateralShares {
    /// In proportion to the wheel loads.
    ByLoad,
    /// Half of the lateral force on each wheel.
    Equal,
    /// Fractions of the force that the left wheels carry: [front, rear].
    Left([f64; 2]),
}

/// Distribution of an axle's longitudinal force between its wheels, while both are on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LongitudinalShares {
    /// In proportion to the wheel loads.
    ByLoad,
    /// Half of the longitudinal force on each wheel.
    Equal,
}

/// Axes of the tyre forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TyreAxes {
    /// Along and across the heading of each wheel.
    Wheel,
    /// Along and across the direction in which the vehicle points, parallel to the ground.
    Road,
}

impl Case {
    /// Returns the case of the car at rest, with the racks centred.
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

impl Case {
    /// Returns a copy of this case in which every axle distributes its forces in proportion to the wheel loads.
    pub(super) fn with_shares_by_load(&self) -> Case {
        let mut case = self.clone();
        case.setting.lateral_shares = LateralShares::ByLoad;
        case.setting.longitudinal_shares = LongitudinalShares::ByLoad;
        case
    }
}

/// Reason why a case has no equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub enum NoEquilibrium {
    /// A wheel has no pose in one of the states that the solver tried.
    NoPose {
        /// Axle: 0 front, 1 rear.
        axle: usize,
        /// Reason why the wheel has no pose.
        failure: NoPose,
    },
    /// Newton's method does not converge, or the search reaches its largest number of steps.
    NotFound,
    /// The equations of equilibrium are singular.
    Singular,
    /// No set of wheels in contact satisfies the equations.
    NoContactSet {
        /// Wheel for which neither contact nor lift satisfies the equations.
        wheel: WheelPlace,
        /// Change of the case's keys that removes the failure. `None` if every axle already distributes its forces in
        /// proportion to the wheel loads.
        remedy: Option<&'static str>,
    },
    /// All wheels have lifted, or az is -1 g or less.
    AllLifted,
    /// Both wheels of an axle have lifted. The equations then do not determine the force of this axle.
    AxleLifted {
        /// Axle: 0 front, 1 rear.
        axle: usize,
    },
    /// The car rolls or pitches over: beyond this state, the moment of its weight exceeds the moment of the springs.
    Tips,
    /// The car tips over: when these wheels have lifted, the other wheels cannot hold the body.
    TipsOver {
        /// True for each wheel that has lifted or lifts now: front left, front right, rear left, rear right.
        lifted: [bool; 4],
    },
    /// The body sinks: beyond this state, the spring forces at the wheels grow more slowly than the load.
    Sinks,
    /// An axle has no springs that carry the body.
    Unsupported,
}

impl NoEquilibrium {
    /// Returns the word for the `status` column.
    pub fn status(&self) -> &'static str {
        match self {
            NoEquilibrium::NoPose { failure, .. } => crate::curves::Status::Failed(*failure).word(),
            NoEquilibrium::Singular => "singular",
            NoEquilibrium::Tips | NoEquilibrium::TipsOver { .. } | NoEquilibrium::Sinks => {
                "unstable"
            }
            NoEquilibrium::Unsupported => "unsupported",
            _ => "no_equilibrium",
        }
    }
}

impl NoEquilibrium {
    /// Describes the reason in words. Lengths are in the car's unit, racks in the axes of the axle's study.
    pub fn describe(&self, car: &Car) -> String {
        let end = |axle: usize| AXLE_NAMES[axle];
        match self {
            NoEquilibrium::NoPose { axle, failure } => {
                let wheel = &car.axles[*axle].left;
                let reason = failure.describe(wheel.length_unit, wheel.frame);
                format!("{} axle, {reason}", end(*axle))
            }
            NoEquilibrium::NotFound => "no equilibrium was found".to_owned(),
            NoEquilibrium::Singular => "the equations of equilibrium are singular: a wheel's \
                                        travel does not change its height, or no part carries a \
                                        force"
                .to_owned(),
            NoEquilibrium::NoContactSet { wheel, remedy } => {
                let reason = format!(
                    "no set of wheels on the ground is possible: with contact, {} would pull on the \
                     ground; lifted, this wheel would be below the ground",
                    wheel.words()
                );
                match remedy {
                    Some(remedy) => format!(
                        "{reason}; a wheel without load cannot carry its share of a force: {remedy}"
                    ),
                    None => reason,
                }
            }
            NoEquilibrium::AllLifted => {
                "all wheels lift: no weight presses them to the ground".to_owned()
            }
            NoEquilibrium::AxleLifted { axle } => format!(
                "both wheels of the {} axle lift, but the axle has to carry a force",
                end(*axle)
            ),
            NoEquilibrium::Tips => {
                "the car tips: beyond this state the moment of its weight grows faster than the \
                 moment of its springs"
                    .to_owned()
            }
            NoEquilibrium::TipsOver { lifted } => {
                let wheels = WheelPlace::ALL.into_iter().filter(|place| lifted[place.0]);
                let words: Vec<_> = wheels.map(WheelPlace::words).collect();
                let verb = if words.len() == 1 { "lifts" } else { "lift" };
                format!(
                    "the car tips over: {} {verb}, and the other wheels cannot hold the body",
                    words.join(" and ")
                )
            }
            NoEquilibrium::Sinks => {
                "the body sinks: beyond this state the springs' forces at the wheels grow less than the load"
                    .to_owned()
            }
            NoEquilibrium::Unsupported => {
                "nothing carries the body: the axles have no springs".to_owned()
            }
        }
    }
}

//! The study of a car as written: its sections and keys. Unknown ones are refused.

use crate::file::{self, Coordinates};
use crate::value::{MemberName, Number, OneOrMore, Text, Whole};
use serde::Deserialize;
use toml::Spanned;

/// The whole file of a car.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CarFile {
    /// `[car]`
    pub car: Spanned<Car>,
    /// `[[cases]]`
    #[serde(default)]
    pub cases: Vec<Spanned<Case>>,
    /// `[gg_map]`
    pub gg_map: Option<Spanned<GgMap>>,
    /// `[outputs]`
    #[serde(default)]
    pub outputs: Outputs,
    /// `[sweep]`
    pub sweep: Option<Spanned<Sweep>>,
    /// `[optimise]`
    pub optimise: Option<Optimise>,
    /// `[tolerance]`
    pub tolerance: Option<Spanned<Tolerance>>,
}

/// `[car]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Car {
    /// Path of the front axle's study.
    pub front: Text,
    /// Path of the rear axle's study.
    pub rear: Text,
    /// Distance of the mean wheel centres,
    pub wheelbase: Option<Number>,
    /// or place of the rear study's origin.
    pub rear_offset: Option<Coordinates>,
    /// Unit of masses.
    pub mass_unit: Option<Text>,
    /// Mass of the whole car,
    pub mass: Option<Number>,
    /// with its centre of gravity;
    pub cg: Option<Coordinates>,
    /// or the sprung mass,
    pub sprung_mass: Option<Number>,
    /// with its centre of gravity.
    pub sprung_cg: Option<Coordinates>,
    /// Front share of braking.
    pub brake_share_front: Option<Number>,
    /// Front share of drive.
    pub drive_share_front: Option<Number>,
    /// Yaw inertia, kg m2.
    pub yaw_inertia: Option<Number>,
    /// Pitch inertia, kg m2.
    pub pitch_inertia: Option<Number>,
    /// Point of the body for the front ride height.
    pub ride_height_point_front: Option<Coordinates>,
    /// Point of the body for the rear ride height.
    pub ride_height_point_rear: Option<Coordinates>,
    /// `elastic` or `rigid`.
    pub tyres: Option<Text>,
    /// `[car.aero]`
    pub aero: Option<Spanned<Aero>>,
}

/// `[car.aero]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aero {
    /// Density of the air, kg/m3.
    pub density: Option<Number>,
    /// Downforce near the front axle.
    pub front: Option<Spanned<Downforce>>,
    /// Downforce near the rear axle.
    pub rear: Option<Spanned<Downforce>>,
    /// Drag.
    pub drag: Option<Spanned<Drag>>,
}

/// `front` and `rear` of `[car.aero]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Downforce {
    /// Point of the body where it acts.
    pub point: Coordinates,
    /// Coefficient times area: factors of 1, hf, hr, hf2, hf hr, hr2.
    pub downforce: Spanned<Vec<Number>>,
}

/// `drag` of `[car.aero]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// Point of the body where it acts.
    pub point: Coordinates,
    /// Coefficient times area, m2.
    pub drag_area: Number,
}

/// An element of `cases`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Its name.
    pub name: Text,
    /// Acceleration forward, g.
    pub ax: Option<Number>,
    /// Acceleration to the left, g.
    pub ay: Option<Number>,
    /// Acceleration upward, g.
    pub az: Option<Number>,
    /// Speed, m/s.
    pub speed: Option<Number>,
    /// Yaw acceleration to the left, rad/s2.
    pub yaw_acceleration: Option<Number>,
    /// Displacement of the front rack along +y,
    pub rack: Option<Number>,
    /// or angle of the steering wheel, degrees.
    pub steering_wheel_angle: Option<Number>,
    /// Displacement of the rear rack along +y.
    pub rack_rear: Option<Number>,
    /// `brake` or `drive`.
    pub longitudinal: Option<Text>,
    /// `by_load` or `equal`.
    pub lateral_shares: Option<Text>,
    /// The left wheels' shares of their axles' lateral forces.
    pub lateral_share_left: Option<Spanned<Vec<Number>>>,
    /// `by_load` or `equal`.
    pub longitudinal_shares: Option<Text>,
    /// `wheel` or `road`.
    pub tyre_axes: Option<Text>,
    /// `elastic` or `rigid`.
    pub tyres: Option<Text>,
}

/// `[gg_map]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GgMap {
    /// Accelerations forward, g.
    pub ax: Spanned<Steps>,
    /// Accelerations to the left, g.
    pub ay: Spanned<Steps>,
    /// Acceleration upward, g.
    pub az: Option<Number>,
    /// Speed, m/s.
    pub speed: Option<Number>,
    /// Displacement of the front rack along +y.
    pub rack: Option<Number>,
    /// `by_load` or `equal`.
    pub lateral_shares: Option<Text>,
    /// `by_load` or `equal`.
    pub longitudinal_shares: Option<Text>,
}

/// A range of values.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Steps {
    /// First value.
    pub from: Number,
    /// Last value.
    pub to: Number,
    /// Number of values.
    pub steps: Whole,
}

/// `[outputs]` of a car.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outputs {
    /// Names of results.
    pub characteristics: Option<Spanned<Vec<Text>>>,
    /// True if derivatives by parameters and hardpoints are written.
    pub sensitivities: Option<Spanned<bool>>,
    /// True if forces in links, rods and joints are written.
    pub member_loads: Option<Spanned<bool>>,
}

/// `[sweep]` of a car.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Method of sampling.
    pub method: Option<Text>,
    /// Number of samples.
    pub samples: Option<Whole>,
    /// Seed of the samples.
    pub seed: Option<Whole>,
    /// Variables of the sweep.
    pub variables: Spanned<Vec<Spanned<SweepVariable>>>,
    /// `csv` or `parquet`.
    pub format: Option<Text>,
}

/// Defines a kind of variable: the keys that name a part of the car and its range, and further keys.
macro_rules! variable {
    ($(#[$about:meta])* $name:ident { $($further:tt)* }) => {
        $(#[$about])*
        #[derive(Debug, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            /// `front`, `rear`, or both in a list.
            pub axle: Option<Spanned<OneOrMore>>,
            /// Name of the axle's hardpoint,
            pub hardpoint: Option<Text>,
            /// or names of several that move together,
            pub hardpoints: Option<Spanned<Vec<Text>>>,
            /// with the displacement of each per unit of the variable,
            pub factors: Option<Spanned<Vec<Number>>>,
            /// and `x`, `y` or `z`,
            pub axis: Option<Text>,
            /// or any direction;
            pub direction: Option<Coordinates>,
            /// or a rate of the axle;
            pub rate: Option<Text>,
            /// or a figure of the car.
            pub car: Option<Text>,
            /// Lowest and highest offset of a hardpoint, else lowest and highest value.
            pub range: Option<Spanned<Vec<Number>>>,
            /// Largest change, percent of the study's value.
            pub percent: Option<Number>,
            $($further)*
        }
    };
}

variable! {
    /// An element of `variables` of `[optimise]`.
    Variable {}
}

variable! {
    /// An element of `variables` of `[sweep]`.
    SweepVariable {
        /// Number of values in a grid.
        pub steps: Option<Whole>,
        /// Name of the variable's column.
        pub name: Option<Text>,
    }
}

/// `[tolerance]` of a car.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    /// Number of builds.
    pub builds: Option<Whole>,
    /// Seed of the random numbers.
    pub seed: Option<Whole>,
    /// Dimensions that scatter.
    pub scatter: Spanned<Vec<Spanned<Scatter>>>,
    /// Limits for the yield.
    pub bands: Option<Vec<Spanned<Band>>>,
}

/// An element of `scatter`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// `front` or `rear`.
    pub axle: Option<Text>,
    /// A hardpoint of the axle,
    pub hardpoint: Option<Text>,
    /// or several, each on its own,
    pub hardpoints: Option<Spanned<Vec<Text>>>,
    /// or a member,
    pub length: Option<Spanned<MemberName>>,
    /// or hardpoints that are moved together,
    pub jig: Option<Spanned<Vec<Text>>>,
    /// or a rate of the axle,
    pub rate: Option<Text>,
    /// or a figure of the car.
    pub car: Option<Text>,
    /// The only wheel whose parts scatter.
    pub side: Option<Text>,
    /// The only coordinate that scatters.
    pub axis: Option<Text>,
    /// Standard deviation of a normal scatter.
    pub sigma: Option<Number>,
    /// Standard deviation of a rate or a figure, percent of its value.
    pub percent: Option<Number>,
    /// Ends of a uniform scatter.
    pub limits: Option<Spanned<Vec<Number>>>,
    /// Standard deviation of each component of a jig's shift.
    pub shift: Option<Number>,
    /// Standard deviation of each component of a jig's turn, degrees.
    pub turn: Option<Number>,
}

impl Scatter {
    /// The entry as the study of the axle would have it.
    pub fn of_axle(&self) -> file::Scatter {
        let own = self.clone();
        file::Scatter {
            hardpoint: own.hardpoint,
            hardpoints: own.hardpoints,
            length: own.length,
            jig: own.jig,
            bushing: None,
            stiffness: None,
            link: None,
            relative: None,
            side: own.side,
            axis: own.axis,
            sigma: own.sigma,
            limits: own.limits,
            shift: own.shift,
            turn: own.turn,
        }
    }
}

/// An element of `bands`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Name of the result.
    pub characteristic: Text,
    /// Name of the case.
    pub case: Text,
    /// Lowest and highest value,
    pub between: Option<Spanned<Vec<Number>>>,
    /// or the lowest alone,
    pub at_least: Option<Number>,
    /// or the highest alone.
    pub at_most: Option<Number>,
}

/// `[optimise]` of a car.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Optimise {
    /// Cap on iterations.
    pub max_iterations: Option<Whole>,
    /// Number of starts.
    pub starts: Option<Whole>,
    /// Seed of the starts.
    pub seed: Option<Whole>,
    /// True if changes that no target asks for are reported.
    pub side_effects: Option<Spanned<bool>>,
    /// Design variables.
    pub variables: Spanned<Vec<Spanned<Variable>>>,
    /// Targets of cases, and of axles by themselves.
    pub targets: Spanned<Vec<Spanned<file::Target>>>,
    /// Constraints of cases, and of axles by themselves.
    #[serde(default)]
    pub constraints: Vec<Spanned<file::Constraint>>,
}

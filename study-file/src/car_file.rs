//! The study of a car as written in the file: its sections and keys. Unknown keys are refused.

use crate::file::{self, Coordinates};
use crate::value::{MemberName, Number, OneOrMore, Text, Whole};
use serde::Deserialize;
use toml::Spanned;

/// Complete study file of a car.
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
    /// Distance between the mean wheel centres of both axles. An alternative is `rear_offset`.
    pub wheelbase: Option<Number>,
    /// Position of the rear study's origin, in the axes of the front study. An alternative to `wheelbase`.
    pub rear_offset: Option<Coordinates>,
    /// Unit of masses: `kg` or `lb`.
    pub mass_unit: Option<Text>,
    /// Mass of the whole car. An alternative is `sprung_mass`.
    pub mass: Option<Number>,
    /// Centre of gravity of the whole car.
    pub cg: Option<Coordinates>,
    /// Sprung mass. An alternative to `mass`.
    pub sprung_mass: Option<Number>,
    /// Centre of gravity of the sprung mass.
    pub sprung_cg: Option<Coordinates>,
    /// Share of the braking force at the front axle.
    pub brake_share_front: Option<Number>,
    /// Share of the drive force at the front axle.
    pub drive_share_front: Option<Number>,
    /// Yaw inertia, kg m2.
    pub yaw_inertia: Option<Number>,
    /// Pitch inertia, kg m2.
    pub pitch_inertia: Option<Number>,
    /// Point of the body at which the front ride height is measured.
    pub ride_height_point_front: Option<Coordinates>,
    /// Point of the body at which the rear ride height is measured.
    pub ride_height_point_rear: Option<Coordinates>,
    /// Vertical stiffness of the tyres: `elastic` (tyres with springs) or `rigid`.
    pub tyres: Option<Text>,
    /// `[car.aero]`
    pub aero: Option<Spanned<Aero>>,
}

/// `[car.aero]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aero {
    /// Air density, kg/m3.
    pub density: Option<Number>,
    /// Downforce near the front axle.
    pub front: Option<Spanned<Downforce>>,
    /// Downforce near the rear axle.
    pub rear: Option<Spanned<Downforce>>,
    /// Aerodynamic drag on the car.
    pub drag: Option<Spanned<Drag>>,
}

/// `front` and `rear` of `[car.aero]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Downforce {
    /// Point of the body on which this downforce acts.
    pub point: Coordinates,
    /// Downforce coefficient times area (m2), as a polynomial in the ride heights hf (front) and hr (rear), in the length unit:
    /// one number for each of the terms 1, hf, hr, hf2, hf hr, hr2.
    pub downforce: Spanned<Vec<Number>>,
}

/// `drag` of `[car.aero]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// Point of the body on which the drag acts.
    pub point: Coordinates,
    /// Drag coefficient times area, m2.
    pub drag_area: Number,
}

/// An element of `cases`: a load case of the car.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Name of the load case.
    pub name: Text,
    /// Forward acceleration, g.
    pub ax: Option<Number>,
    /// Acceleration to the left, g.
    pub ay: Option<Number>,
    /// Upward acceleration, g.
    pub az: Option<Number>,
    /// Speed, m/s.
    pub speed: Option<Number>,
    /// Yaw acceleration to the left, rad/s2.
    pub yaw_acceleration: Option<Number>,
    /// Displacement of the front rack along +y. An alternative is `steering_wheel_angle`.
    pub rack: Option<Number>,
    /// Angle of the steering wheel, degrees. An alternative to `rack`.
    pub steering_wheel_angle: Option<Number>,
    /// Displacement of the rear rack along +y.
    pub rack_rear: Option<Number>,
    /// Kind of the longitudinal force: `brake` or `drive`.
    pub longitudinal: Option<Text>,
    /// Shares of both wheels in their axle's lateral force: `by_load` (in proportion to the wheel loads) or `equal`.
    pub lateral_shares: Option<Text>,
    /// Shares `[front, rear]` of the left wheels in the lateral forces of their axles. An alternative to `lateral_shares`.
    pub lateral_share_left: Option<Spanned<Vec<Number>>>,
    /// Shares of both wheels in their axle's longitudinal force: `by_load` (in proportion to the wheel loads) or `equal`.
    pub longitudinal_shares: Option<Text>,
    /// Axes of the tyre forces: the axes of the `wheel`, which turn with a steered wheel, or the axes of the `road`.
    pub tyre_axes: Option<Text>,
    /// Vertical stiffness of the tyres: `elastic` (tyres with springs) or `rigid`.
    pub tyres: Option<Text>,
}

/// `[gg_map]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GgMap {
    /// Forward accelerations, g.
    pub ax: Spanned<Steps>,
    /// Accelerations to the left, g.
    pub ay: Spanned<Steps>,
    /// Upward acceleration, g.
    pub az: Option<Number>,
    /// Speed, m/s.
    pub speed: Option<Number>,
    /// Displacement of the front rack along +y.
    pub rack: Option<Number>,
    /// Shares of both wheels in their axle's lateral force: `by_load` (in proportion to the wheel loads) or `equal`.
    pub lateral_shares: Option<Text>,
    /// Shares of both wheels in their axle's longitudinal force: `by_load` (in proportion to the wheel loads) or `equal`.
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
    /// Names of the results that are written.
    pub characteristics: Option<Spanned<Vec<Text>>>,
    /// True if derivatives with respect to parameters and hardpoints are written.
    pub sensitivities: Option<Spanned<bool>>,
    /// True if forces in links, rods, joints and springs are written.
    pub member_loads: Option<Spanned<bool>>,
}

/// `[sweep]` of a car.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Method by which the ranges of the variables are sampled.
    pub method: Option<Text>,
    /// Number of sampled designs.
    pub samples: Option<Whole>,
    /// Seed of the random samples.
    pub seed: Option<Whole>,
    /// Variables of the sweep.
    pub variables: Spanned<Vec<Spanned<SweepVariable>>>,
    /// File format of the results: `csv` or `parquet`.
    pub format: Option<Text>,
    /// False if the results leave out the margins of the constraints.
    pub constraints: Option<bool>,
}

/// Macro that defines a kind of variable: the keys that name a part of the car, the keys of its range, and further keys.
macro_rules! variable {
    ($(#[$about:meta])* $name:ident { $($further:tt)* }) => {
        $(#[$about])*
        #[derive(Debug, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            /// Axle of the part: `front`, `rear`, or both in a list.
            pub axle: Option<Spanned<OneOrMore>>,
            /// Name of the hardpoint that moves.
            pub hardpoint: Option<Text>,
            /// Names of several hardpoints that move together.
            pub hardpoints: Option<Spanned<Vec<Text>>>,
            /// Displacement of each hardpoint per unit of the variable.
            pub factors: Option<Spanned<Vec<Number>>>,
            /// Direction of the move: `x`, `y` or `z`.
            pub axis: Option<Text>,
            /// Direction of the move as a vector. An alternative to `axis`.
            pub direction: Option<Coordinates>,
            /// Name of the rate (stiffness) of the axle that varies.
            pub rate: Option<Text>,
            /// Name of the value of the car that varies, such as its mass.
            pub car: Option<Text>,
            /// Lowest and highest offset of a hardpoint. For a rate or a value of the car: lowest and highest value.
            pub range: Option<Spanned<Vec<Number>>>,
            /// Largest change of a rate or a value of the car in both directions, in percent of the study's value. An
            /// alternative to `range`.
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
        /// Number of values of the variable in a grid.
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
    /// Hardpoints, lengths, rates and values of the car that scatter.
    pub scatter: Spanned<Vec<Spanned<Scatter>>>,
    /// Limits of results that define the yield.
    pub bands: Option<Vec<Spanned<Band>>>,
}

/// An element of `scatter` of `[tolerance]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Axle whose parts scatter: `front` or `rear`.
    pub axle: Option<Text>,
    /// Name of a hardpoint of the axle that scatters.
    pub hardpoint: Option<Text>,
    /// Names of several hardpoints that scatter independently.
    pub hardpoints: Option<Spanned<Vec<Text>>>,
    /// Name of a member whose length scatters.
    pub length: Option<Spanned<MemberName>>,
    /// Names of hardpoints on one jig. They scatter together as a rigid body.
    pub jig: Option<Spanned<Vec<Text>>>,
    /// Name of the rate (stiffness) of the axle that scatters.
    pub rate: Option<Text>,
    /// Name of the value of the car that scatters, such as its mass.
    pub car: Option<Text>,
    /// Side of the wheel whose parts scatter. If omitted, the parts of both wheels scatter.
    pub side: Option<Text>,
    /// The one coordinate that scatters. If omitted, all three coordinates scatter.
    pub axis: Option<Text>,
    /// Standard deviation of a deviation with a normal distribution.
    pub sigma: Option<Number>,
    /// Standard deviation of a rate or a value of the car, in percent of the study's value. An alternative to `sigma`.
    pub percent: Option<Number>,
    /// Ends `[lowest, highest]` of a deviation with a uniform distribution.
    pub limits: Option<Spanned<Vec<Number>>>,
    /// Standard deviation of each component of the jig's displacement.
    pub shift: Option<Number>,
    /// Standard deviation of each component of the jig's rotation, degrees.
    pub turn: Option<Number>,
}

impl Scatter {
    /// Converts the entry to the form of an axle's study, without `rate`, `car` and `percent`.
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
            rate: None,
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

/// An element of `bands` of `[tolerance]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Name of the result that the band limits.
    pub characteristic: Text,
    /// Name of the load case in which the band applies.
    pub case: Text,
    /// Lowest and highest permitted value of the result.
    pub between: Option<Spanned<Vec<Number>>>,
    /// Lowest permitted value of the result, if there is no highest value.
    pub at_least: Option<Number>,
    /// Highest permitted value of the result, if there is no lowest value.
    pub at_most: Option<Number>,
}

/// `[optimise]` of a car.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Optimise {
    /// Largest number of iterations of one start of the tuning.
    pub max_iterations: Option<Whole>,
    /// Number of designs from which the tuning starts.
    pub starts: Option<Whole>,
    /// Seed of the random designs from which the tuning starts.
    pub seed: Option<Whole>,
    /// True if changes that no target requests are reported.
    pub side_effects: Option<Spanned<bool>>,
    /// Design variables.
    pub variables: Spanned<Vec<Spanned<Variable>>>,
    /// Targets of load cases, and of single axles.
    pub targets: Spanned<Vec<Spanned<file::Target>>>,
    /// Constraints of load cases, and of single axles.
    #[serde(default)]
    pub constraints: Vec<Spanned<file::Constraint>>,
}

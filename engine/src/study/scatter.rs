//! `[setup]` and `[tolerance]`, resolved: adjustments, contributors and bands.

use super::*;

/// A set-up.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Adjustments, at least one.
    pub adjust: Vec<Adjustment>,
    /// Wanted static values.
    pub want: Vec<Want>,
    /// Wanted change of the ride height, in study units: positive where the car becomes higher. The wheel travel of the
    /// new resting position is its negative.
    pub ride_height_change: Option<f64>,
}

/// Something that can be adjusted.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjustment {
    /// Name: `tie_rod`, `upper_ball_joint y`.
    pub name: String,
    /// The dimension, and its change in the kernel's frame per unit of the adjustment.
    pub change: (BuildParameter, f64),
    /// Sizes in which it comes.
    pub increment: Increment,
}

/// Sizes in which an adjustment comes, in study units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Increment {
    /// A thread: continuous, made in parts of a turn.
    Thread {
        /// Change of length by one turn, of both threads together.
        per_turn: f64,
    },
    /// Whole shims.
    Shims {
        /// Thickness of the thinnest shim.
        step: f64,
    },
    /// Any amount, as of a slotted plate.
    Free,
}

/// A wanted static value, in radians or length units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Want {
    /// The characteristic.
    pub characteristic: Characteristic,
    /// The value.
    pub value: f64,
}

/// Scatter of builds, and the bands that they must keep.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Number of builds.
    pub builds: u64,
    /// Seed of the random builds.
    pub seed: u32,
    /// True if toe and camber are set again after assembly.
    pub aligned: bool,
    /// Dimensions that scatter; at least one.
    pub scatter: Vec<Contributor>,
    /// Bands that builds must keep.
    pub bands: Vec<Band>,
}

/// Something that scatters: a point, a length or a jig.
#[derive(Clone, Debug, PartialEq)]
pub struct Contributor {
    /// Name.
    pub name: String,
    /// Independent parts.
    pub sources: Vec<Source>,
}

/// A number that scatters on its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Name.
    pub name: String,
    /// Dimensions that it changes, each with its change per unit, in the kernel's frame.
    pub changes: Vec<(BuildParameter, f64)>,
    /// Rate of an elastic part, if the variable changes a rate instead of coordinates.
    pub rate: Option<Rate>,
    /// Distribution of the scatter.
    pub law: Law,
    /// For an axle: the wheel whose dimensions these are, in the kernel's frame of its side.
    pub side: Option<Side>,
}

/// Distribution of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Normal distribution about 0.
    Normal {
        /// Standard deviation.
        sigma: f64,
    },
    /// Evenly between two ends.
    Uniform {
        /// The lowest value.
        low: f64,
        /// The highest value.
        high: f64,
    },
}

/// A band that a quantity of builds is to keep to, in radians or length units.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Quantity that must keep the band: a characteristic, or a quantity of an axle (of both wheels if no side is
    /// named).
    pub of: TargetQuantity,
    /// Drive value, or value of the number that [`Band::site`] is over, at which the band holds; `None` for all
    /// stations.
    pub at: Option<f64>,
    /// For an axle: the number of the motion that `at` is a value of, and the values of the others. Without it the
    /// band holds everywhere in the motion.
    pub site: Option<AxleSite>,
    /// Lowest and highest value; infinite without a limit.
    pub between: [f64; 2],
}

//! `[sweep]` and `[optimise]`.

use super::Coordinates;
use super::constraint::Constraint;
use crate::value::{LimitText, MemberName, Number, Numbers, Text, Whole};
use serde::Deserialize;
use toml::Spanned;

/// `[sweep]`
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
    pub variables: Option<Spanned<Vec<Spanned<SweepVariable>>>>,
    /// Path of a CSV file with the designs. An alternative to `variables`.
    pub designs: Option<Text>,
    /// True if the curves of every design are kept.
    pub curves: Option<bool>,
    /// File format of the results: `csv` or `parquet`.
    pub format: Option<Text>,
    /// False if the results leave out the margins of the constraints.
    pub constraints: Option<bool>,
}

/// An element of `variables` of `[sweep]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepVariable {
    /// Name of the hardpoint that moves.
    pub hardpoint: Option<Text>,
    /// Names of several hardpoints that move together.
    pub hardpoints: Option<Spanned<Vec<Text>>>,
    /// Displacement of each hardpoint per unit of the variable.
    pub factors: Option<Spanned<Vec<Number>>>,
    /// Name of a bushing whose stiffness varies.
    pub bushing: Option<Text>,
    /// Axis of the bushing's stiffness: `x`, `y`, `z`, `tx`, `ty` or `tz`.
    pub stiffness: Option<Text>,
    /// Name of a link with axial stiffness.
    pub link: Option<Text>,
    /// Name of a part with one rate: `spring`, `anti_roll_bar`, `rack` or `column`.
    pub rate: Option<Text>,
    /// True if the values of a rate are factors of the study's rate.
    pub relative: Option<Spanned<bool>>,
    /// Axis of the move: `x`, `y` or `z`.
    pub axis: Option<Text>,
    /// Lowest and highest value of the variable. Two numbers are valid.
    pub range: Spanned<Vec<Number>>,
    /// Number of values of the variable in a grid.
    pub steps: Option<Whole>,
    /// True if the values are coordinates instead of offsets.
    pub absolute: Option<Spanned<bool>>,
    /// Name of the variable's column.
    pub name: Option<Text>,
}

/// `[optimise]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Optimise {
    /// Name of the tuning method.
    pub method: Option<Text>,
    /// Number of designs from which the tuning starts.
    pub starts: Option<Whole>,
    /// Seed of the random designs from which the tuning starts.
    pub seed: Option<Whole>,
    /// Largest number of iterations of one start.
    pub max_iterations: Option<Whole>,
    /// Largest misfit that is good enough. Among the designs with at most this misfit, the tuning chooses the design with the
    /// smallest change.
    pub good_enough: Option<Number>,
    /// True if the targets are measured points, with which the tuning compares the design.
    pub fit: Option<Spanned<bool>>,
    /// Number of builds of `[tolerance]` over which the misfit is averaged.
    pub scatter: Option<Whole>,
    /// Objective of a robust tuning: `misfit` (of the builds), or `yield` (share of builds within the bands).
    pub robust: Option<Text>,
    /// Names of the targets whose trade-off is traced.
    pub front: Option<Spanned<Vec<Text>>>,
    /// False if the results leave out the changes that no target requests.
    pub side_effects: Option<Spanned<bool>>,
    /// Design variables that the tuning changes.
    pub variables: Spanned<Vec<Spanned<Variable>>>,
    /// Targets of the tuning.
    pub targets: Spanned<Vec<Spanned<Target>>>,
    /// Constraints of the tuning.
    #[serde(default)]
    pub constraints: Vec<Spanned<Constraint>>,
}

/// An element of `variables` of `[optimise]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variable {
    /// Name of the hardpoint that moves.
    pub hardpoint: Option<Text>,
    /// Names of several hardpoints that move together.
    pub hardpoints: Option<Spanned<Vec<Text>>>,
    /// Names of several hardpoints that move as one rigid body.
    pub rigid: Option<Spanned<Vec<Text>>>,
    /// Name of a bushing whose stiffness varies.
    pub bushing: Option<Text>,
    /// Axis of the bushing's stiffness: `x`, `y`, `z`, `tx`, `ty` or `tz`.
    pub stiffness: Option<Text>,
    /// Name of a link with axial stiffness.
    pub link: Option<Text>,
    /// Name of a part with one rate: `spring`, `anti_roll_bar`, `rack` or `column`.
    pub rate: Option<Text>,
    /// True if the range of a rate is in factors of the study's rate.
    pub relative: Option<Spanned<bool>>,
    /// Displacement of each hardpoint per unit of the variable.
    pub factors: Option<Spanned<Vec<Number>>>,
    /// Direction of the move: `x`, `y` or `z`.
    pub axis: Option<Text>,
    /// Direction of the move as a vector. An alternative to `axis`.
    pub direction: Option<Coordinates>,
    /// Lowest and highest offset; for a rate, the lowest and highest rate or factor. Two numbers are valid.
    pub range: Option<Spanned<Vec<Number>>>,
    /// Largest shift of a body along each axis, in both directions.
    pub shift: Option<Number>,
    /// Largest turn of a body about each axis, in both directions, in degrees.
    pub turn: Option<Number>,
    /// Cost of a move across the range, relative to other variables.
    pub cost: Option<Number>,
}

/// An element of `targets` of `[optimise]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// In the study of a car, the load case of the target.
    pub case: Option<Text>,
    /// In the study of a car, the axle to which the target applies, over the axle's own motion.
    pub axle: Option<Text>,
    /// Name of the target's characteristic.
    pub characteristic: Option<Text>,
    /// Name of the point whose coordinate is the target.
    pub point: Option<Text>,
    /// Coordinate of the point that is the target: `x`, `y` or `z`.
    pub axis: Option<Text>,
    /// Name or ends of a member whose length is the target.
    pub length: Option<Spanned<MemberName>>,
    /// Name of the force under a load that is the target.
    pub load: Option<Text>,
    /// Name of a result of a `kc` test.
    pub figure: Option<Text>,
    /// Curve: pairs of drive value and target value.
    pub points: Option<Spanned<Vec<Spanned<Vec<Number>>>>>,
    /// Path of a CSV file with the target curve.
    pub file: Option<Text>,
    /// Column of `file` that contains the values.
    pub column: Option<Text>,
    /// Drive value of a target that applies at a single station.
    pub at: Option<Number>,
    /// Target value at the single drive value.
    pub value: Option<Number>,
    /// Lower and upper limit of the target quantity.
    pub between: Option<Spanned<Vec<LimitText>>>,
    /// Lower limit of the target quantity.
    pub at_least: Option<Spanned<LimitText>>,
    /// Upper limit of the target quantity.
    pub at_most: Option<Spanned<LimitText>>,
    /// For an axle, the coordinate of the motion over which the curve runs.
    pub over: Option<Text>,
    /// For an axle, the wheel to which the target applies.
    pub side: Option<Text>,
    /// For an axle: one or several roll angles at which the target applies.
    pub roll: Option<Spanned<Numbers>>,
    /// For an axle: one or several values of heave at which the target applies.
    pub heave: Option<Spanned<Numbers>>,
    /// For an axle: one or several travels of the left wheel at which the target applies.
    pub travel_left: Option<Spanned<Numbers>>,
    /// For an axle: one or several travels of the right wheel at which the target applies.
    pub travel_right: Option<Spanned<Numbers>>,
    /// For an axle: one or several angles of the steering wheel at which the target applies.
    pub steering_wheel_angle: Option<Spanned<Numbers>>,
    /// One or several rack displacements at which the target applies.
    pub rack: Option<Spanned<Numbers>>,
    /// Name of the motion in which the target applies.
    pub motion: Option<Text>,
    /// Acceptable deviation, in the unit of the quantity.
    pub tolerance: Number,
    /// Weight relative to the other targets.
    pub weight: Option<Number>,
    /// Interpolation of the target curve between its points: `linear` or `monotone_cubic`.
    pub interpolation: Option<Text>,
}

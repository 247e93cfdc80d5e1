//! `[optimise]`, resolved: variables, goals and settings of a tuning.

use super::*;
use crate::number::Each;

/// A coordinate that moves with a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Hardpoint that moves.
    pub point: PointId,
    /// Coordinate that changes, in the study's axes.
    pub axis: Axis,
    /// Displacement of the point along the axis per unit of the variable.
    pub factor: f64,
}

impl Move {
    /// Applies a value of the variable to a coordinate of `design`, which has the axes of a left wheel (x forward, y left,
    /// z up). With `absolute`, the coordinate becomes `factor` times the value. Otherwise it changes by `factor` times the
    /// value.
    pub fn apply(&self, frame: &Frame, value: f64, absolute: bool, design: &mut [Vector3<f64>]) {
        let coordinate = &mut design[self.point.0][self.axis];
        let along = frame.sign(self.axis) * self.factor * value;
        if absolute {
            *coordinate = along
        } else {
            *coordinate += along
        }
    }

    /// Value of an absolute variable at which the coordinate is the coordinate of the study's design, in study units.
    pub fn value_at(&self, suspension: &Suspension) -> f64 {
        let coordinate = suspension.design[self.point.0][self.axis];
        // The sum removes the sign of a zero.
        coordinate * suspension.frame.sign(self.axis) / self.factor + 0.0
    }
}

/// An optimisation (tuning) of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimise {
    /// Number of starts. The first start is the design itself, and further starts are points of a low-discrepancy sequence.
    pub starts: usize,
    /// Seed of the low-discrepancy sequence.
    pub seed: u32,
    /// Largest number of iterations of one start.
    pub max_iterations: u64,
    /// Design variables.
    pub variables: Vec<Variable>,
    /// Target values and curves.
    pub targets: Vec<Target>,
    /// Limits that the design must satisfy.
    pub constraints: Vec<Constraint>,
    /// Misfit below which designs count as equally good. Among these designs, the tuning chooses the one with the smallest
    /// change. With 0, the tuning searches for the smallest misfit.
    pub good_enough: f64,
    /// True if the targets are measurements, so that standard errors are meaningful.
    pub fit: bool,
    /// Two or three goals whose trade-off is computed. Empty if no trade-off is requested.
    pub front: Vec<FrontGoal>,
    /// Built vehicles (builds) of a robust tuning. The tuning improves their mean squared misfit, or the share of builds
    /// within all bands. `None` for a tuning of the nominal design.
    pub scatter: Option<Scatter>,
    /// True if the results report changes in quantities without a target.
    pub side_effects: bool,
}

/// Fixed sample of built vehicles (builds), with the tolerances of `[tolerance]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// Number of builds in the sample.
    pub builds: usize,
    /// Seed of the random builds.
    pub seed: u32,
    /// Scattering parts and rates.
    pub contributors: Vec<Contributor>,
    /// Adjustments that set toe and camber again after assembly. `None` if builds are not adjusted.
    pub adjust: Option<Vec<Adjustment>>,
    /// Objective of the tuning.
    pub aim: RobustAim,
}

impl Scatter {
    /// True if the tuning minimises the mean squared misfit of the builds. False if it maximises the share of builds within the
    /// bands.
    pub fn lowers_misfit(&self) -> bool {
        self.aim == RobustAim::Misfit
    }
}

/// Objective of a robust tuning.
#[derive(Clone, Debug, PartialEq)]
pub enum RobustAim {
    /// Mean squared misfit of the builds.
    Misfit,
    /// Share of builds that satisfy these limits.
    Yield(Vec<Band>),
}

/// Goal of a trade-off curve (Pareto front). It consists of all targets with one name.
#[derive(Clone, Debug, PartialEq)]
pub struct FrontGoal {
    /// Name of the targets.
    pub name: String,
    /// Indices of the targets.
    pub targets: Vec<usize>,
}

impl Optimise {
    /// Returns the same tuning without builds. That tuning improves only the nominal design.
    pub fn nominal(&self) -> Self {
        Optimise {
            scatter: None,
            ..self.clone()
        }
    }

    /// Targets that rank the designs of a sweep: all targets. None in a fit, because the targets are then measurements.
    pub fn ranking_targets(&self) -> &[Target] {
        if self.fit { &[] } else { &self.targets }
    }
}

/// Design variable: a coordinate, several coordinates together, a displacement of points along a direction, a rotation, or a
/// rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Names of the hardpoints, for example `lower_arm_front+lower_arm_rear`. For a rate: the elastic part, for example
    /// `bushing:lower_arm_rear`.
    pub name: String,
    /// Coordinates that the variable moves: one axis, or all axes of a direction. Empty for a rotation or a rate.
    pub moves: Vec<Move>,
    /// Rotated points. The variable is then one of the three components of a rotation vector in degrees.
    pub turn: Option<Turn>,
    /// Rate of an elastic part that the variable changes instead of coordinates.
    pub rate: Option<Rate>,
    /// Lowest and highest offset of the variable from the design, in the study's axes and length unit. Degrees for a
    /// rotation. For a rate, see [`Rate::at`].
    pub range: [f64; 2],
    /// Cost of a change across the full range, relative to the other variables. The size of a design change includes this
    /// cost in the search for the smallest change.
    pub cost: f64,
}

impl Variable {
    /// Name of the variable, which includes its move: `tie_rod_inner_dz`, `lower_arm_front+lower_arm_rear_turn_x`. It is unique
    /// if no variable is a rigid body.
    pub fn label(&self) -> String {
        if let Some(rate) = &self.rate {
            return match (rate.axis_name(), rate.parameter) {
                (Some(axis), _) => format!("{}_{axis}", self.name),
                (None, Parameter::Link(_)) => self.name.clone(),
                (None, _) => format!("{}_{}", self.name, rate.kind()),
            };
        }
        match (&self.turn, self.axis()) {
            (Some(turn), _) => format!("{}_turn_{}", self.name, turn.axis.name()),
            (None, Some(axis)) => format!("{}_d{}", self.name, axis.name()),
            (None, None) => format!("{}_along", self.name),
        }
    }

    /// Axis of the move. `None` if the move is not along a single axis, or for a rotation or a rate. Also `None` if the
    /// coordinates of all points fall as the offset rises.
    pub fn axis(&self) -> Option<Axis> {
        let first = self.moves.first()?.axis;
        let is_along = self.moves.iter().all(|m| m.axis == first);
        let is_against = self.moves.iter().all(|m| m.factor < 0.0);
        (is_along && !is_against).then_some(first)
    }

    /// Returns the kind of move: `z`, `along` a direction, `turn about z`, `stiffness x` of a bushing.
    pub fn way(&self) -> String {
        if let Some(rate) = &self.rate {
            return match rate.axis_name() {
                Some(axis) => format!("stiffness {axis}"),
                None if rate.is_per_strain => "modulus times area".to_owned(),
                None if matches!(rate.parameter, Parameter::Link(_)) => {
                    "axial stiffness".to_owned()
                }
                None => rate.kind().to_owned(),
            };
        }
        match (&self.turn, self.axis()) {
            (Some(turn), _) => format!("turn about {}", turn.axis.name()),
            (None, Some(axis)) => axis.name().to_owned(),
            (None, None) => "along".to_owned(),
        }
    }

    /// Points that the variable moves.
    pub fn points(&self) -> impl Iterator<Item = PointId> {
        let turned = self
            .turn
            .iter()
            .flat_map(|turn| turn.points.iter().copied());
        self.moves.iter().map(|m| m.point).chain(turned)
    }

    /// Makes a variable for every coordinate of every point of a suspension, point by point, each with this range.
    pub fn every_coordinate(suspension: &Suspension, range: [f64; 2]) -> Vec<Variable> {
        let mechanism = &suspension.mechanism;
        let points = (0..mechanism.points.len()).map(PointId);
        let coordinate = |(point, axis)| Variable {
            name: mechanism.name(point).to_owned(),
            moves: vec![Move {
                point,
                axis,
                factor: 1.0,
            }],
            turn: None,
            rate: None,
            range,
            cost: 1.0,
        };
        points
            .flat_map(|point| Axis::ALL.each(|axis| (point, axis)))
            .map(coordinate)
            .collect()
    }
}

/// Rate of an elastic part as a design variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Rate of a bushing along or about an axis, of a link, spring or anti-roll bar, or of rack and column.
    pub parameter: Parameter,
    /// Value of the rate in the study.
    pub design: f64,
    /// True if the variable is the logarithm of a factor, false if it is a change of the rate.
    pub is_relative: bool,
    /// True for a link with `modulus` and `area`. Its rate is their product, a force per strain.
    pub is_per_strain: bool,
}

/// Names of the axes along and about which a bushing has rates.
pub const RATE_AXES: [&str; 6] = ["x", "y", "z", "tx", "ty", "tz"];

impl Rate {
    /// The rate and its derivative with respect to the variable, at the value `x` of the variable.
    pub fn at(&self, x: f64) -> [f64; 2] {
        if self.is_relative {
            [self.design * x.exp(); 2]
        } else {
            [self.design + x, 1.0]
        }
    }

    /// Rate for a value of a sweep. The value is a rate, or a factor.
    pub fn of_value(&self, value: f64) -> f64 {
        if self.is_relative {
            self.design * value
        } else {
            value
        }
    }

    /// Rate after a change, and its derivative with respect to the change. If the rate is relative, the change is a fraction
    /// of the rate.
    pub fn scattered(&self, change: f64) -> [f64; 2] {
        if self.is_relative {
            [self.design * (1.0 + change), self.design]
        } else {
            [self.design + change, 1.0]
        }
    }

    /// Value of a variable of a tuning ([`Rate::at`]) that gives this rate.
    pub fn offset(&self, rate: f64) -> f64 {
        if self.is_relative {
            (rate / self.design).ln()
        } else {
            rate - self.design
        }
    }

    /// Unit of the values of [`Rate::of_value`]: `factor`, or the unit of the rate.
    pub fn value_unit(&self, length: LengthUnit) -> String {
        let u = length.symbol();
        match (self.is_relative, self.parameter) {
            (true, _) => "factor".to_owned(),
            (false, _) if self.is_per_strain => "N".to_owned(),
            (false, Parameter::Stiffness(_, 3..) | Parameter::BarRate | Parameter::ColumnRate) => {
                format!("N_{u}_per_rad")
            }
            (false, _) => format!("N_per_{u}"),
        }
    }

    /// Value for [`Rate::of_value`] that gives the rate of the study.
    pub fn own_value(&self) -> f64 {
        if self.is_relative { 1.0 } else { self.design }
    }

    /// Name of the kind of rate: `rate` of springs and bars, else `stiffness`.
    pub fn kind(&self) -> &'static str {
        match self.parameter {
            Parameter::SpringRate | Parameter::BarRate => "rate",
            _ => "stiffness",
        }
    }

    /// Name of the axis, for the rate of a bushing.
    pub fn axis_name(&self) -> Option<&'static str> {
        match self.parameter {
            Parameter::Stiffness(_, axis) => RATE_AXES.get(axis).copied(),
            _ => None,
        }
    }
}

/// Points that rotate as one body about their centroid, before all other moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// Points that rotate.
    pub points: Vec<PointId>,
    /// Component of the rotation vector, in the study's axes.
    pub axis: Axis,
}

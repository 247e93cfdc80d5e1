//! `[optimise]`, resolved: variables, goals and choices of a tuning.

use super::*;

/// A coordinate that moves with a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// The hardpoint.
    pub point: PointId,
    /// The coordinate, in the study's axes.
    pub axis: Axis,
    /// Displacement per unit of the variable.
    pub factor: f64,
}

impl Move {
    /// Moves the coordinate of a design, which is in the kernel's frame, by a value of the variable: to `factor` times
    /// the value with `absolute`, else that far from where it is.
    pub fn apply(&self, frame: &Frame, value: f64, absolute: bool, design: &mut [Vector3<f64>]) {
        let coordinate = &mut design[self.point.0][self.axis];
        let along = frame.sign(self.axis) * self.factor * value;
        match absolute {
            true => *coordinate = along,
            false => *coordinate += along,
        }
    }
}

/// An optimisation.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimise {
    /// Number of starts: the design itself, then points of a low-discrepancy sequence.
    pub starts: usize,
    /// Seed of that sequence.
    pub seed: u32,
    /// Cap on the iterations of one start.
    pub max_iterations: u64,
    /// Quantities that may change.
    pub variables: Vec<Variable>,
    /// Wanted values and curves.
    pub targets: Vec<Target>,
    /// Limits that the design must keep.
    pub constraints: Vec<Constraint>,
    /// Misfit below which designs count as equally good, so that the one that moves least is taken; 0 for the least
    /// misfit.
    pub good_enough: f64,
    /// True if the targets are measurements, so that standard errors mean something.
    pub fit: bool,
    /// Two or three goals to trade on the front, or none.
    pub front: Vec<FrontGoal>,
    /// The builds whose mean squared misfit is lowered; `None` to lower the misfit of the nominal design.
    pub scatter: Option<Scatter>,
    /// True if changes that no target asks for are reported beside the tuned design.
    pub side_effects: bool,
}

/// Builds that scatter as `[tolerance]` says: a fixed sample of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// Number of builds.
    pub builds: usize,
    /// Seed of the random builds.
    pub seed: u32,
    /// Dimensions that scatter.
    pub contributors: Vec<Contributor>,
    /// Adjustments that set toe and camber again after assembly; `None` without them.
    pub adjust: Option<Vec<Adjustment>>,
    /// Objective that the tuning improves.
    pub aim: RobustAim,
}

impl Scatter {
    /// True if the tuning lowers the mean squared misfit of the builds.
    pub fn lowers_misfit(&self) -> bool {
        self.aim == RobustAim::Misfit
    }
}

/// Objective of a robust tuning.
#[derive(Clone, Debug, PartialEq)]
pub enum RobustAim {
    /// The mean squared misfit of the builds.
    Misfit,
    /// The share of builds that keep these bands.
    Yield(Vec<Band>),
}

/// A goal that is traded on a front: all targets of one name.
#[derive(Clone, Debug, PartialEq)]
pub struct FrontGoal {
    /// The name.
    pub name: String,
    /// Numbers of the targets.
    pub targets: Vec<usize>,
}

impl Optimise {
    /// The targets that designs of a sweep are compared with: all of them, or none if there is one that a sweep cannot
    /// compare with. It can with targets of an axle, and with targets on a characteristic in the study's own motion;
    /// never with measurements.
    pub fn swept_targets(&self) -> &[Target] {
        let is_swept = |target: &Target| target.site.axle.is_some() || target.is_in_motion();
        match self.targets.iter().all(is_swept) && !self.fit {
            true => &self.targets,
            false => &[],
        }
    }
}

/// A design variable: a coordinate, several together, or the direction of a group of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// The names of the hardpoints, as in `lower_arm_front+lower_arm_rear`.
    pub name: String,
    /// Coordinates that the variable moves: one axis, or all axes of a direction. A turn has none.
    pub moves: Vec<Move>,
    /// The points it turns; the variable then is one of the three components of a rotation vector in degrees.
    pub turn: Option<Turn>,
    /// The rate of an elastic part that it is instead.
    pub rate: Option<Rate>,
    /// Lowest and highest offset from the design, in the study's axes; degrees of a turn.
    pub range: [f64; 2],
    /// Cost of a move across the range, relative to the other variables. The search for the design that moves least
    /// uses it.
    pub cost: f64,
}

impl Variable {
    /// A name that no other variable has, with its move: `tie_rod_inner_dz`, `lower_arm_front+lower_arm_rear_turn_x`.
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

    /// The axis that it moves along, if it is one.
    pub fn axis(&self) -> Option<Axis> {
        let first = self.moves.first()?.axis;
        self.moves.iter().all(|m| m.axis == first).then_some(first)
    }

    /// Returns the kind of move: `z`, `along` a direction, `turn about z`.
    pub fn way(&self) -> String {
        if let Some(rate) = &self.rate {
            return match rate.axis_name() {
                Some(axis) => format!("stiffness {axis}"),
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

    /// The points it moves.
    pub fn points(&self) -> impl Iterator<Item = PointId> {
        let turned = self
            .turn
            .iter()
            .flat_map(|turn| turn.points.iter().copied());
        self.moves.iter().map(|m| m.point).chain(turned)
    }

    /// Every coordinate of every point of a suspension, point by point, each over this range.
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
            .flat_map(|point| Axis::ALL.map(|axis| (point, axis)))
            .map(coordinate)
            .collect()
    }
}

/// The rate of an elastic part as a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// The rate: of a bushing along or about an axis, of a link, spring or anti-roll bar, or of rack and column.
    pub parameter: Parameter,
    /// Value in the study.
    pub design: f64,
    /// True if the variable is the logarithm of a factor, false if it is added.
    pub is_relative: bool,
}

/// Names of the axes along and about which a bushing has rates.
pub const RATE_AXES: [&str; 6] = ["x", "y", "z", "tx", "ty", "tz"];

impl Rate {
    /// The rate and its derivative with the variable at `x`.
    pub fn at(&self, x: f64) -> [f64; 2] {
        match self.is_relative {
            true => [self.design * x.exp(); 2],
            false => [self.design + x, 1.0],
        }
    }

    /// The rate at a value of a sweep or a scatter, which is a rate or a factor.
    pub fn of_value(&self, value: f64) -> f64 {
        match self.is_relative {
            true => self.design * value,
            false => value,
        }
    }

    /// The rate with a change, which is a part of the rate if it is relative; and its derivative by the change.
    pub fn scattered(&self, change: f64) -> [f64; 2] {
        match self.is_relative {
            true => [self.design * (1.0 + change), self.design],
            false => [self.design + change, 1.0],
        }
    }

    /// Unit of the values of [`Rate::of_value`]: `factor`, or that of the rate.
    pub fn value_unit(&self, length: LengthUnit) -> String {
        let u = length.symbol();
        match (self.is_relative, self.parameter) {
            (true, _) => "factor".to_owned(),
            (false, Parameter::Stiffness(_, 3..) | Parameter::BarRate | Parameter::ColumnRate) => {
                format!("N_{u}_per_rad")
            }
            (false, _) => format!("N_per_{u}"),
        }
    }

    /// The value of [`Rate::of_value`] that gives the study's own rate.
    pub fn own_value(&self) -> f64 {
        match self.is_relative {
            true => 1.0,
            false => self.design,
        }
    }

    /// Name of the kind of rate: `rate` of springs and bars, else `stiffness`.
    pub fn kind(&self) -> &'static str {
        match self.parameter {
            Parameter::SpringRate | Parameter::BarRate => "rate",
            _ => "stiffness",
        }
    }

    /// Name of the axis, of a bushing.
    pub fn axis_name(&self) -> Option<&'static str> {
        match self.parameter {
            Parameter::Stiffness(_, axis) => RATE_AXES.get(axis).copied(),
            _ => None,
        }
    }
}

/// Points that are turned as one body about their centroid, before anything else moves them.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// The points.
    pub points: Vec<PointId>,
    /// The component of the rotation vector, in the study's axes.
    pub axis: Axis,
}

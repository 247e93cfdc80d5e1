//! Studies: the meaning of the file as written (`hardpoint-study-file`).
//!
//! [`Study`] is resolved: names have become ids, lengths and angles are in the kernel's frame and
//! units (see the fields), defaults are filled in, and nothing is left to interpret.
//!
//! Reading goes from the text to the file as written, each value with its place, and from there to the [`Study`].
//! Only this module turns degrees into radians, and the study's axes into the kernel's. Every mistake becomes a
//! [`StudyError`] with file, line, key, value and the expected value.

mod axle;
mod axle_forces;
mod axle_targets;
mod car;
mod compliance;
mod constraints;
mod curve_file;
mod designs_file;
mod edit;
mod elastic_targets;
mod geometry;
mod loads;
mod members;
mod motion;
mod moves;
mod optimise;
mod outputs;
mod place;
mod resolve;
mod right_wheel;
mod rocker_springs;
mod samples;
mod schema;
mod setup;
mod sheet_file;
mod solid_axle;
mod solver;
mod subject;
mod suspension;
mod sweep;
mod targets;
mod tolerance;
mod twist_beam;
mod value_edit;
mod vehicle;

pub use crate::analyse::LoadPoint;
pub use crate::solve::Drive;
pub use axle::AxleStudy;
pub use axle_targets::AxleSite;
pub use car::{
    CarBand, CarContributor, CarOptimise, CarStudy, CarSweep, CarTolerance, GgMap, TunedCar, edited,
};
pub use compliance::{AxleComplianceStudy, ComplianceStudy, NamedBushing, NamedParts};
pub use designs_file::DesignTable;
pub use hardpoint_study_file::bushing_file;
pub use hardpoint_study_file::error::{Source as FileText, StudyError, StudyErrors};
pub use hardpoint_study_file::names::nearest;
pub use hardpoint_study_file::source::{
    LONGEST_TABLE, LONGEST_TEXT, read_bytes, read_regular_text, read_text,
};
use hardpoint_study_file::{error, file, names, overrides, parse, source, value};
pub(crate) use optimise::{GOOD_ENOUGH, MAX_ITERATIONS};
pub use samples::{AxleSample, Sample};
pub use schema::schema;
pub use sweep::MOST_DESIGNS;
pub(crate) use sweep::MOST_EXCHANGED;
pub use value_edit::{PathStep, ValueEdit, edited_text};
pub use vehicle::{Vehicle, WheelStudy};

use crate::ask::{Unit, with_unit};
use crate::assembly::BuildParameter;
use crate::characteristics::{Characteristic, Measure, Quantity};
use crate::compliance::{KcValue, Parameter};
use crate::model::{Axis, Frame, LengthUnit, PointId, Side, Suspension};
use crate::number::Vector3;

/// The most stations of one motion, and of an axle's: results of all of them are held in memory.
pub(crate) const MOST_STATIONS: usize = 100_000;

/// A number in the range that a study allows, or the expected range.
pub fn checked_number(number: f64) -> Result<f64, String> {
    value::Number::checked(number)
}

/// A study, resolved and validated.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Name, from the file's name.
    pub name: String,
    /// The text the study was read from, with `--set` applied and target curves from files written
    /// out. Results that are studies themselves are edits of it, so that comments survive and no other
    /// file is needed.
    pub text: String,
    /// The files it names: target curves and designs.
    pub inputs: Vec<std::path::PathBuf>,
    /// The vehicle that the study describes, with its motion and outputs.
    pub vehicle: Vehicle,
    /// Further motions of a wheel by name, in the order of the names; of an axle's left wheel.
    pub motions: Vec<(String, Motion)>,
    /// The optimisation, if the study has one.
    pub optimise: Option<Optimise>,
    /// The sweep, if the study has one.
    pub sweep: Option<Sweep>,
    /// The set-up, if the study has one.
    pub setup: Option<Setup>,
    /// The tolerances, if the study has them.
    pub tolerance: Option<Tolerance>,
}

/// The equations whose solution is a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Formulation {
    /// Six closure equations in the pose of the knuckle, or their closed form: of every topology, with
    /// every output.
    KnucklePose,
    /// The seed paper's fifteen equations in the coordinates of five points: of the MacPherson strut, up to second
    /// derivatives. The crate `hardpoint-attia` has them.
    PointCoordinates,
}

/// The motion: every combination of a drive value and a rack displacement.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The coordinate that drives the motion.
    pub drive: Drive,
    /// Drive values, in length units or radians, in the order they are reported.
    pub values: Vec<f64>,
    /// Rack displacements along the study's +y.
    pub rack: Vec<f64>,
    /// True if the study gives the rack a range, so that results have a column for it.
    pub rack_moves: bool,
    /// The drive as a function of time. `values` are then its values at `times`.
    pub time: Option<TimeLaw>,
}

/// The drive as a polynomial of time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeLaw {
    /// Coefficients, lowest power first, in length units or radians.
    pub polynomial: Vec<f64>,
    /// Seconds.
    pub times: Vec<f64>,
}

/// The highest derivative by the drive (or by time) that is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Values.
    Position,
    /// First derivatives as well.
    Velocity,
    /// First and second derivatives as well.
    Acceleration,
}

/// Outputs of a study. A study without `[outputs]` asks for the angles of wheel and steering axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Outputs {
    /// Characteristics, in the order asked.
    pub characteristics: Vec<Characteristic>,
    /// Points whose positions are reported.
    pub points: Vec<PointId>,
    /// True if results contain the knuckle's angular velocity and acceleration (from velocity order up).
    pub knuckle: bool,
    /// Highest derivative.
    pub order: Order,
    /// Hardpoints for which sensitivities are reported; empty for none.
    pub sensitivities: Vec<PointId>,
    /// True if each pose is to be proved.
    pub certify: bool,
    /// Loads for which the forces in links and joints are reported.
    pub loads: Vec<Load>,
    /// Figures of tests on elastic parts, in the order asked.
    pub figures: Vec<ElasticFigure>,
}

/// A figure of a test on elastic parts, as studies name it.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticFigure {
    /// Name, without the unit.
    pub name: String,
    /// The value.
    pub value: KcValue,
    /// Kind of number.
    pub unit: Unit,
}

impl ElasticFigure {
    /// The name of its column.
    pub fn column(&self, length: LengthUnit) -> String {
        with_unit(self.name.clone(), &self.unit.suffix(length))
    }
}

impl Outputs {
    /// Values of these characteristics, and nothing else.
    pub fn of(characteristics: Vec<Characteristic>) -> Self {
        Outputs {
            characteristics,
            points: Vec::new(),
            knuckle: false,
            order: Order::Position,
            sensitivities: Vec::new(),
            certify: false,
            loads: Vec::new(),
            figures: Vec::new(),
        }
    }
}

/// A load on the wheel, the same in every pose. In the kernel's axes, which do not turn with the wheel.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Beginning of the names of its columns.
    pub name: String,
    /// Point at which the force acts.
    pub at: LoadPoint,
    /// Force, in newtons.
    pub force: Vector3<f64>,
    /// Moment, in newtons times the study's length unit.
    pub moment: Vector3<f64>,
}

impl Load {
    /// The load in the kernel's axes of the other side, which are the mirror image.
    pub(crate) fn on_other_side(self) -> Load {
        let (force, moment) = (self.force, self.moment);
        Load {
            force: Vector3::new(force.x, -force.y, force.z),
            moment: Vector3::new(-moment.x, moment.y, -moment.z),
            ..self
        }
    }
}

/// A sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Source of the designs.
    pub designs: Designs,
    /// True if the curves of every design are kept.
    pub curves: bool,
    /// The file format of the results.
    pub format: FileFormat,
}

/// Source of the designs of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub enum Designs {
    /// Variables over their ranges.
    Sampled(Sampled),
    /// The rows of a CSV file, which [`DesignTable::read`] reads.
    File(std::path::PathBuf),
    /// Rows that a program gives.
    Given(DesignTable),
}

/// Designs sampled from ranges.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// Method that chooses the samples.
    pub method: Sampling,
    /// Number of samples; in a grid, number of its points.
    pub samples: u64,
    /// Seed.
    pub seed: u32,
    /// The variables.
    pub variables: Vec<SweepVariable>,
}

/// Sampling method of designs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// Every combination of evenly spaced values, the last variable running fastest.
    Grid,
    /// Every variable has as many equal strata as there are samples, and a sample in each.
    LatinHypercube,
    /// A low-discrepancy sequence.
    Sobol,
    /// Independent uniform numbers.
    Random,
    /// Pairs of samples with the variables exchanged one by one, from which first-order and total
    /// Sobol indices follow (A. Saltelli et al., Variance based sensitivity analysis of model output,
    /// Computer Physics Communications 181, 2010): `samples` times the number of variables and two.
    Saltelli,
}

/// The file format of a sweep's results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// Comma-separated values.
    Csv,
    /// Apache Parquet.
    Parquet,
}

/// A number that moves one or several coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepVariable {
    /// Name, without unit: `tie_rod_inner_dz` for an offset, `tie_rod_inner_z` for a coordinate.
    pub name: String,
    /// Coordinates that it moves.
    pub moves: Vec<Move>,
    /// The rate of an elastic part that it sets instead. Its values are rates, or factors of the rate.
    pub rate: Option<Rate>,
    /// True if its values are coordinates, false if they are offsets from the design.
    pub absolute: bool,
    /// Lowest and highest value, in the study's axes.
    pub range: [f64; 2],
    /// Number of values in a grid.
    pub steps: Option<u64>,
}

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
    /// The coordinates it moves, along one axis or those of a direction; none for a turn.
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
            return match rate.axis_name() {
                Some(axis) => format!("{}_{axis}", self.name),
                None => self.name.clone(),
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
                None => "axial stiffness".to_owned(),
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
    /// The rate: of a bushing along or about an axis, or of a link.
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
            (false, Parameter::Stiffness(_, 3..)) => format!("N_{u}_per_rad"),
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

/// Quantity of a target, with its name and unit in the study.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetQuantity {
    /// The quantities, in the kernel's frame.
    pub kind: TargetKind,
    /// Name with the unit, as in a column heading.
    pub column: String,
    /// Kind of quantity, from which its unit follows.
    pub unit: Unit,
    /// The study's unit of length.
    pub length: LengthUnit,
    /// -1 where the study's axis points the other way than the kernel's.
    pub sign: f64,
}

/// Kind of quantity of a target.
#[derive(Clone, Debug, PartialEq)]
pub enum TargetKind {
    /// A measure of one wheel.
    Wheel(Measure),
    /// A quantity of an axle, or the same quantity of either wheel.
    Axle(Vec<crate::axle::Quantity>),
    /// A value of one wheel with elastic parts.
    Elastic(KcValue),
}

impl TargetQuantity {
    /// A characteristic.
    pub fn characteristic(characteristic: Characteristic, length: LengthUnit) -> Self {
        TargetQuantity {
            kind: TargetKind::Wheel(Measure::Quantity(Quantity::Characteristic(characteristic))),
            column: characteristic.column(length),
            unit: characteristic.info().unit,
            length,
            sign: 1.0,
        }
    }

    /// Factor from a value in the kernel's frame, in radians, length units and newtons, to a printed one.
    pub fn factor(&self) -> f64 {
        self.unit.printed_factor(self.length) * self.sign
    }

    /// Converts a printed value into one in the kernel's frame.
    pub fn from_printed(&self, printed: f64) -> f64 {
        self.unit.from_printed(printed, self.length) * self.sign
    }

    /// The measure, if it is of one wheel.
    pub fn of_wheel(&self) -> Option<&Measure> {
        match &self.kind {
            TargetKind::Wheel(measure) => Some(measure),
            TargetKind::Axle(_) | TargetKind::Elastic(_) => None,
        }
    }

    /// The characteristic of one wheel, if it is one.
    pub fn as_characteristic(&self) -> Option<Characteristic> {
        match &self.kind {
            TargetKind::Wheel(Measure::Quantity(Quantity::Characteristic(c)))
            | TargetKind::Elastic(KcValue::Wheel(c)) => Some(*c),
            _ => None,
        }
    }

    /// Returns true if it is a figure of a test on elastic parts, of a wheel or an axle.
    pub fn is_figure(&self) -> bool {
        match &self.kind {
            TargetKind::Elastic(KcValue::Figure { .. }) => true,
            TargetKind::Axle(quantities) => {
                use crate::axle::Quantity as OfAxle;
                quantities.iter().all(|q| matches!(q, OfAxle::Figure(_)))
            }
            TargetKind::Wheel(_) | TargetKind::Elastic(_) => false,
        }
    }

    /// The figure of a test on elastic parts, if it is one.
    pub fn as_figure(&self) -> Option<ElasticFigure> {
        let TargetKind::Elastic(value @ KcValue::Figure { .. }) = self.kind else {
            return None;
        };
        let unit = self.unit.suffix(self.length);
        let name = self.column.strip_suffix(&format!("_{unit}"));
        Some(ElasticFigure {
            name: name.unwrap_or(&self.column).to_owned(),
            value,
            unit: self.unit,
        })
    }
}

/// Place of a target or a constraint: its motion, and the positions of the rack.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Site {
    /// Name of a motion; the study's `[motion]` without it.
    pub motion: Option<(String, Motion)>,
    /// Rack displacements along the study's +y. If empty, the rack is at the motion's displacement, or straight ahead
    /// if the motion moves it.
    pub racks: Vec<f64>,
    /// For an axle: the number of the motion that it is over, and where the others are held.
    pub axle: Option<AxleSite>,
}

/// A wanted curve, value or band. Values in the kernel's frame, in radians or length units (for gains:
/// radians per length unit).
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// The quantity that the target is about.
    pub of: TargetQuantity,
    /// Wanted value, curve or band of that quantity.
    pub wanted: Wanted,
    /// Acceptable deviation, in the unit of the values.
    pub tolerance: f64,
    /// Weight against the other targets.
    pub weight: f64,
    /// Place where the target applies.
    pub site: Site,
    /// Further drive values at which it is compared, beside those of the motion.
    pub stations: Vec<f64>,
}

impl Target {
    /// Name of the target: the characteristic's, or the column's without its unit.
    pub fn name(&self, length: LengthUnit) -> String {
        match self.of.as_characteristic() {
            Some(characteristic) => characteristic.info().name.to_owned(),
            None => {
                let unit = format!("_{}", self.of.unit.suffix(length));
                let name = self.of.column.strip_suffix(&unit);
                name.unwrap_or(&self.of.column).to_owned()
            }
        }
    }

    /// The drive values of a motion, and those added for this target.
    pub fn stations_in(&self, motion: &Motion) -> Vec<f64> {
        self.stations_among(&motion.values)
    }

    /// The given values, and those added for this target.
    pub fn stations_among(&self, values: &[f64]) -> Vec<f64> {
        let added = self.stations.iter().filter(|v| !values.contains(v));
        values.iter().chain(added).copied().collect()
    }

    /// A drive value (for an axle, a value of the number that the target is over) as it is printed. `drive` is the
    /// drive of the study's own motion.
    pub fn printed_at(&self, drive: Drive, at: f64) -> f64 {
        match (&self.site.axle, &self.site.motion) {
            (Some(_), _) => at,
            (None, Some((_, motion))) => motion.drive.printed(at),
            (None, None) => drive.printed(at),
        }
    }

    /// Unit of [`Target::printed_at`].
    pub fn unit_at(&self, drive: Drive, length: LengthUnit) -> &'static str {
        match (&self.site.axle, &self.site.motion) {
            (Some(site), _) => site.over.unit(length),
            (None, Some((_, motion))) => motion.drive.unit(length),
            (None, None) => drive.unit(length),
        }
    }

    /// Returns true if it is about a characteristic in the study's own motion. Sweeps compare only such targets.
    pub fn is_in_motion(&self) -> bool {
        let of = &self.of;
        let is_curve = of.as_characteristic().is_some() || of.as_figure().is_some();
        self.site == Site::default() && is_curve
    }

    /// Returns true if a picture can show the target as a line: a value or curve of a characteristic in the study's
    /// own motion.
    pub fn is_plain(&self) -> bool {
        !matches!(self.wanted, Wanted::Band { .. }) && self.is_in_motion()
    }
}

/// Wanted value, curve or band of a target.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// A curve over the drive, compared at the stations of the motion between its ends.
    Curve {
        /// Drive value (as in [`Motion::values`]) and wanted value, by rising drive value.
        points: Vec<[f64; 2]>,
        /// Interpolation between its points.
        interpolation: Interpolation,
    },
    /// A single value at one drive value.
    At {
        /// Drive value.
        drive: f64,
        /// Wanted value.
        value: f64,
    },
    /// Measured points, each compared where it was measured: drive value and value.
    Points(Vec<[f64; 2]>),
    /// Anything between two limits.
    Band {
        /// The one drive value where it is wanted; `None` for the stations of the motion.
        at: Option<f64>,
        /// Lower limit; `None` for no limit.
        lower: Option<Limit>,
        /// Upper limit; `None` for no limit.
        upper: Option<Limit>,
    },
}

/// The limit of a band.
#[derive(Clone, Debug, PartialEq)]
pub enum Limit {
    /// The same everywhere.
    Value(f64),
    /// A curve over the drive, which limits between its ends.
    Curve {
        /// Drive value and limit, by rising drive value.
        points: Vec<[f64; 2]>,
        /// Interpolation between its points.
        interpolation: Interpolation,
    },
}

/// Limits that a design must keep.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Description in words.
    pub name: String,
    /// Measures that must all be within limits.
    pub parts: Vec<Limited>,
    /// Place where it must hold; `None` for the design position alone.
    pub site: Option<Site>,
}

/// A measure that must be within limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Limited {
    /// The measure that must be within the limits.
    pub of: Measure,
    /// Lower limit; `None` for no limit.
    pub lower: Option<f64>,
    /// Upper limit; `None` for no limit. Equal to `lower`, it makes an equality.
    pub upper: Option<f64>,
    /// Change of the measure that counts as 1 in the rows of a tuning: a visible one, such as a millimetre or a degree.
    pub scale: f64,
    /// The same change in `unit`.
    pub visible: f64,
    /// Unit of the limits as the study writes them, which margins and prices have too. "1" for a plain number.
    pub unit: String,
}

impl Limited {
    /// Margin between the measure and one of its limits in `unit`, from the value of the limit's row:
    /// (measure - limit)/scale, with the opposite sign for a lower limit. Negative if the limit is violated.
    pub(crate) fn margin(&self, row: f64) -> f64 {
        match (self.of.is_versine(), self.upper) {
            (true, Some(limit)) => {
                let angle = |versine: f64| 2.0 * (0.5 * versine).clamp(0.0, 1.0).sqrt().asin();
                (angle(limit) - angle(limit + row * self.scale)).to_degrees()
            }
            _ => -row * self.visible,
        }
    }
}

/// Interpolation of a curve between its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight lines.
    Linear,
    /// The smooth piecewise cubic that overshoots nowhere (F. N. Fritsch, R. E. Carlson, Monotone
    /// piecewise cubic interpolation, SIAM J. Numer. Anal. 17, 1980).
    MonotoneCubic,
}

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

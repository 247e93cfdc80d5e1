//! Studies: the meaning of a study file. The crate `hardpoint-study-file` reads the file as written.
//!
//! A [`Study`] is resolved: ids replace names, lengths and angles are in the kernel's frame and units (see the fields), and
//! defaults are filled in. So other modules need not interpret it further.
//!
//! Reading has two steps. The first one converts the text to the file as written, in which each value has a position. The
//! second one converts the file to the [`Study`]. This module converts degrees to radians, and the study's axes to the
//! kernel's axes, except in fields that say so. Every mistake becomes a [`StudyError`]. It names the file, and if possible
//! line, key, value and the expected value.

mod axle;
mod axle_forces;
mod axle_targets;
mod car;
mod compliance;
mod constraints;
mod convert;
mod curve_file;
mod designs_file;
mod drive_rounding;
mod edit;
mod elastic_targets;
mod geometry;
mod loads;
mod members;
mod motion;
mod moves;
mod named_motions;
mod optimise;
mod output_measures;
mod outputs;
mod place;
mod resolve;
mod right_wheel;
mod rocker_springs;
mod samples;
mod scatter;
mod schema;
mod setup;
mod sheet_file;
mod solid_axle;
mod solver;
mod subject;
mod suspension;
mod sweep;
mod target;
mod targets;
mod tolerance;
mod tuning;
mod twist_beam;
mod untested;
mod value_edit;
mod vehicle;

pub use crate::analyse::LoadPoint;
pub use crate::solve::Drive;
pub use axle::AxleStudy;
pub use axle_targets::AxleSite;
pub use car::{
    CarBand, CarContributor, CarOptimise, CarStudy, CarSweep, CarTolerance, GgMap, TunedCar, edited,
};
pub use compliance::{AxleComplianceStudy, ComplianceStudy, NamedBushing, NamedLink, NamedParts};
pub use constraints::named_joints;
pub use convert::{UnitChoice, Units};
pub use designs_file::DesignTable;
pub use drive_rounding::DriveRounding;
pub use hardpoint_study_file::bushing_file;
pub use hardpoint_study_file::error::{Source as FileText, StudyError, StudyErrors};
pub use hardpoint_study_file::names::nearest;
pub use hardpoint_study_file::source::{
    LONGEST_TABLE, LONGEST_TEXT, read_bytes, read_input_bytes, read_regular_text, read_text,
};
use hardpoint_study_file::{error, file, names, overrides, parse, source, value};
pub(crate) use optimise::{GOOD_ENOUGH, MAX_ITERATIONS};
pub use samples::{AxleSample, Sample};
pub use scatter::{Adjustment, Band, Contributor, Increment, Law, Setup, Source, Tolerance, Want};
pub use schema::{keys, schema};
pub use subject::named_members;
pub use sweep::MOST_DESIGNS;
pub(crate) use sweep::MOST_EXCHANGED;
pub use target::{
    Constraint, Interpolation, Limit, Limited, Site, Target, TargetKind, TargetQuantity, Wanted,
};
pub use tuning::{FrontGoal, Move, Optimise, RATE_AXES, Rate, RobustAim, Scatter, Turn, Variable};
pub use value_edit::{PathStep, ValueEdit, edited_text};
pub use vehicle::{Vehicle, WheelStudy};

use crate::ask::{Unit, with_unit};
use crate::assembly::BuildParameter;
use crate::characteristics::{Characteristic, Measure, Quantity};
use crate::compliance::{HeldQuantity, KcValue, Parameter};
use crate::model::{Axis, Frame, LengthUnit, PointId, Side, Suspension};
use crate::number::Vector3;

/// Largest number of stations in a motion of a wheel or an axle. The results of all stations are kept in memory.
pub(crate) const MOST_STATIONS: usize = 100_000;

/// Returns a number if it lies in the range that studies allow. The error names that range.
pub fn checked_number(number: f64) -> Result<f64, String> {
    value::Number::checked(number)
}

/// A resolved and validated study.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Name of the study, derived from the name of its file.
    pub name: String,
    /// Text of the study, with the changes of `--set`, and with the targets and bushings of other files written into it. A
    /// result that is a study is an edited copy of this text. So the result keeps the comments. It needs no other file except
    /// a file of designs.
    pub text: String,
    /// Directory of the files that the study names.
    pub directory: std::path::PathBuf,
    /// Other files that the study names: targets, designs and bushings.
    pub inputs: Vec<std::path::PathBuf>,
    /// Vehicle that the study describes, with its motion and outputs.
    pub vehicle: Vehicle,
    /// Further motions of a wheel, in the order of their names. For an axle they are motions of its left wheel.
    pub motions: Vec<(String, Motion)>,
    /// Optimisation, if the study has one.
    pub optimise: Option<Optimise>,
    /// Sweep, if the study has one.
    pub sweep: Option<Sweep>,
    /// Set-up, if the study has one.
    pub setup: Option<Setup>,
    /// Tolerances, if the study has them.
    pub tolerance: Option<Tolerance>,
}

/// Equations that determine a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Formulation {
    /// Six closure equations in the pose of the knuckle, or their closed form. They work for every topology and give every
    /// output.
    KnucklePose,
    /// The fifteen equations of Attia's paper in the coordinates of five points, in the crate `hardpoint-attia`. They work
    /// only for the MacPherson strut, and give only first and second derivatives.
    PointCoordinates,
}

/// Motion: all combinations of drive values and rack displacements.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Coordinate that drives the motion.
    pub drive: Drive,
    /// Drive values, in length units or radians, in the order of the results.
    pub values: Vec<f64>,
    /// Rack displacements along the study's +y.
    pub rack: Vec<f64>,
    /// True if the study gives the rack a range, so that results have a column for it.
    pub rack_moves: bool,
    /// Drive as a function of time. If given, `values` are the drive values at `times`.
    pub time: Option<TimeLaw>,
}

/// Drive as a polynomial of time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeLaw {
    /// Coefficients, lowest power first, in length units or radians.
    pub polynomial: Vec<f64>,
    /// Times of the stations, in seconds.
    pub times: Vec<f64>,
}

/// Highest derivative with respect to the drive (or to time) in the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Values of the outputs, without derivatives.
    Position,
    /// Values and first derivatives of the outputs.
    Velocity,
    /// Values, first and second derivatives of the outputs.
    Acceleration,
}

/// Outputs of a study. Without `[outputs]` they are the angles of wheel and steering axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Outputs {
    /// Characteristics, in the order of the study.
    pub characteristics: Vec<Characteristic>,
    /// Points whose positions are in the results.
    pub points: Vec<PointId>,
    /// Geometric measures, in the order of the study.
    pub measures: Vec<OutputMeasure>,
    /// True if results contain the knuckle's angular velocity and acceleration. They need [`Order::Velocity`] or higher.
    pub knuckle: bool,
    /// Highest derivative of the outputs with respect to the drive or to time.
    pub order: Order,
    /// Hardpoints whose sensitivities are in the results. May be empty.
    pub sensitivities: Vec<PointId>,
    /// True if each pose must be certified.
    pub certify: bool,
    /// Loads for which results contain the forces in links and joints.
    pub loads: Vec<Load>,
    /// Test results of elastic parts, in the order of the study.
    pub figures: Vec<ElasticFigure>,
}

/// Geometric measure of a pose, under the name that its columns have.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputMeasure {
    /// Name without the unit, for example `drive_shaft_plunge`.
    pub name: String,
    /// Measure of the pose that the columns contain.
    pub of: Measure,
}

/// Test result of elastic parts, with its name in studies.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticFigure {
    /// Name of the test result, without the unit.
    pub name: String,
    /// Value in equilibrium that gives the result.
    pub value: KcValue,
    /// Unit of the result.
    pub unit: Unit,
}

impl ElasticFigure {
    /// Name of the result's column.
    pub fn column(&self, length: LengthUnit) -> String {
        with_unit(self.name.clone(), &self.unit.suffix(length))
    }
}

impl Outputs {
    /// Makes outputs that contain only the values of these characteristics.
    pub fn of(characteristics: Vec<Characteristic>) -> Self {
        Outputs {
            characteristics,
            points: Vec::new(),
            measures: Vec::new(),
            knuckle: false,
            order: Order::Position,
            sensitivities: Vec::new(),
            certify: false,
            loads: Vec::new(),
            figures: Vec::new(),
        }
    }
}

/// Load on the wheel, the same in every pose. Its components are along the axes of a left wheel: x forward, y left, z up.
/// These axes are fixed in the body; they do not rotate with the wheel.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Prefix of the names of the load's columns.
    pub name: String,
    /// Point at which the force acts.
    pub at: LoadPoint,
    /// Quantity that stays constant in an equilibrium of elastic parts. `None` for a rigid mechanism.
    pub held: Option<HeldQuantity>,
    /// Force in N.
    pub force: Vector3<f64>,
    /// Moment in N times the study's length unit.
    pub moment: Vector3<f64>,
}

impl Load {
    /// Returns the load in the axes of the wheel on the other side, which are the mirror image.
    pub(crate) fn on_other_side(self) -> Load {
        let (force, moment) = (self.force, self.moment);
        Load {
            force: Vector3::new(force.x, -force.y, force.z),
            moment: Vector3::new(-moment.x, moment.y, -moment.z),
            ..self
        }
    }
}

/// A sweep: the designs to compute, and the results to store.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Source of the designs.
    pub designs: Designs,
    /// True if results contain the curves of every design.
    pub curves: bool,
    /// File format of the results.
    pub format: FileFormat,
    /// True if results contain the margins of the constraints of `[optimise]`.
    pub constraints: bool,
}

/// Source of the designs of a sweep: ranges of variables, a file, or rows from the caller.
#[derive(Clone, Debug, PartialEq)]
pub enum Designs {
    /// Samples of variables over their ranges.
    Sampled(Sampled),
    /// Rows of a CSV file. [`DesignTable::read`] reads them.
    File(std::path::PathBuf),
    /// Rows that the caller gives.
    Given(DesignTable),
}

/// Designs sampled from ranges.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// Method that chooses the values of the variables.
    pub method: Sampling,
    /// Number of samples. For a grid, number of its points.
    pub samples: u64,
    /// Seed of the samples.
    pub seed: u32,
    /// Variables and their ranges.
    pub variables: Vec<SweepVariable>,
}

/// Sampling method of designs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// All combinations of evenly spaced values. The last variable changes fastest.
    Grid,
    /// Latin hypercube: each variable has as many equal strata as samples, with one sample in each stratum.
    LatinHypercube,
    /// A low-discrepancy sequence.
    Sobol,
    /// Independent, uniformly distributed numbers.
    Random,
    /// Pairs of samples, and further samples. Each further sample equals one sample of a pair, except for one variable:
    /// this variable has the value of the other sample. These samples give first-order and total Sobol indices (A. Saltelli
    /// et al., Variance based sensitivity analysis of model output, Computer Physics Communications 181, 2010). The number
    /// of designs is `samples` times (number of variables + 2).
    Saltelli,
}

/// File format of a sweep's results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// Comma-separated values.
    Csv,
    /// Apache Parquet.
    Parquet,
}

impl FileFormat {
    /// All formats.
    pub const ALL: [FileFormat; 2] = [FileFormat::Csv, FileFormat::Parquet];

    /// Name in studies and in `sweep.json`. It is also the extension of result files.
    pub fn name(self) -> &'static str {
        match self {
            FileFormat::Csv => "csv",
            FileFormat::Parquet => "parquet",
        }
    }
}

/// Variable of a sweep: a number that moves one or several coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepVariable {
    /// Name, without unit: `tie_rod_inner_dz` for an offset, `tie_rod_inner_z` for a coordinate.
    pub name: String,
    /// Coordinates that the variable moves.
    pub moves: Vec<Move>,
    /// Rate of an elastic part that the variable sets instead of coordinates. Its values are then rates, or factors of the
    /// rate.
    pub rate: Option<Rate>,
    /// True if the values are coordinates, false if they are offsets from the design.
    pub absolute: bool,
    /// Lowest and highest value of the variable, in the study's axes and length unit. For a rate: lowest and highest rate
    /// or factor.
    pub range: [f64; 2],
    /// Number of values of the variable in a grid. `None` if the study gives no steps.
    pub steps: Option<u64>,
}

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
pub use scatter::{Adjustment, Band, Contributor, Increment, Law, Setup, Source, Tolerance, Want};
pub use schema::schema;
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

//! Messages between page and server, as JSON. Designs are coordinates in the study's axes, in the order of the points. Numbers
//! are written so that they read back exactly.

mod request;

use crate::SideEffect;
use crate::curves::Frame;
use crate::report::{
    Cell, ConstraintMargin, FailureRange, OutputRecord, Scene, Table, YieldRecord, counted,
    further_in_words, shown_side_effects, side_effects_table,
};
use crate::study::ValueEdit;
use serde::Serialize;

pub(super) use request::{
    CurvesRequest, Designed, EditRequest, InfluenceRequest, JobRequest, SaveRequest, SolveRequest,
    StartRequest, TuneRequest,
};

/// Coordinates of all points, in the study's axes.
pub(super) type Coordinates = Vec<[f64; 3]>;

/// Data of the study that do not change while points move.
#[derive(Serialize)]
pub(super) struct Overview {
    pub name: String,
    pub file: String,
    /// Names of all files that saving may write: the study, then the two axle studies of a car.
    pub files: Vec<String>,
    /// Path of the study file. With it, a browser distinguishes the stored data of different studies.
    pub place: String,
    pub digest: String,
    /// SHA-256 of the study file's text as the server read it, without unsaved changes.
    pub base: String,
    /// Sections of the study text with its unsaved edits, for the forms of the page. For a car: sections of its three texts, and
    /// the units of their numbers.
    pub written: serde_json::Value,
    pub topology: String,
    pub unit: String,
    /// Sign of each axis of the study relative to the internal frame (x forward, y left, z up).
    pub axes: [f64; 3],
    pub points: Vec<PointOverview>,
    pub members: Vec<MemberOverview>,
    pub joints: Vec<JointOverview>,
    pub design: Coordinates,
    pub scene: WholeScene,
    /// All characteristics that the page can show.
    pub characteristics: Vec<CharacteristicOverview>,
    pub is_axle: bool,
    /// True if stations are load cases.
    pub is_car: bool,
    /// One slider for each coordinate of the motion.
    pub sliders: Vec<Slider>,
    /// Index of the slider whose coordinate is initially on the horizontal axis of the curves.
    pub main: usize,
    /// Named motions with their sliders.
    pub motions: Vec<MotionOverview>,
    pub targets: Vec<TargetOverview>,
    pub variables: Vec<VariableOverview>,
    /// True if the study has a section `[optimise]`.
    pub tunes: bool,
    /// Number of builds (parts with random deviations) whose misfit a tuning lowers. `None` if the tuning lowers the misfit of the
    /// nominal design.
    pub builds: Option<usize>,
    pub has_constraints: bool,
    /// Number of starts (searches from different designs) of a tuning.
    pub starts: usize,
}

/// A named motion with its sliders.
#[derive(Serialize)]
pub(super) struct MotionOverview {
    pub name: String,
    /// One slider for each coordinate of the motion.
    pub sliders: Vec<Slider>,
    /// Index of the slider whose coordinate is initially on the horizontal axis of the curves.
    pub main: usize,
}

/// A coordinate of the motion that the user can set.
#[derive(Serialize)]
pub(super) struct Slider {
    pub key: &'static str,
    pub name: &'static str,
    pub unit: &'static str,
    pub low: f64,
    pub high: f64,
    /// Value of the slider in the design position, in the slider's unit.
    pub home: f64,
    /// Values of the slider's coordinate over the motion, in the slider's unit.
    pub values: Vec<f64>,
    /// Names of the values, if the slider selects from a list. The value of the slider is then the index in this list.
    pub names: Vec<String>,
}

/// Points and lines for the drawing of the left side of the vehicle, with its wheels.
#[derive(Serialize)]
pub(super) struct WholeScene {
    #[serde(flatten)]
    pub scene: Scene,
    pub wheels: Vec<WheelDrawn>,
}

#[derive(Serialize)]
pub(super) struct WheelDrawn {
    /// Index of the point at the centre of the wheel.
    pub centre: usize,
    pub radius: f64,
}

/// Text of a file as it was opened (`before`), and with the edits that the user made on the page (`after`).
#[derive(Serialize)]
pub(super) struct TextChange {
    pub file: String,
    pub before: String,
    pub after: String,
}

#[derive(Serialize)]
pub(super) struct PointOverview {
    pub name: String,
    pub about: String,
    /// Axle of a car to which the point belongs, and the point's name in the study of this axle. `None` without a car.
    pub axle: Option<[String; 2]>,
    /// Displacement from the point's coordinates to its position in a drawing of the whole vehicle.
    pub shift: [f64; 3],
    /// True for a point of a solid axle's right half, which follows the left half. The user cannot edit such a point.
    pub follows: bool,
}

/// A member that constraints can name: a rod, a leg of an arm, a strut, a spring or a drive shaft.
#[derive(Serialize)]
pub(super) struct MemberOverview {
    pub name: String,
    /// Axle of a car to which the member belongs.
    pub axle: Option<String>,
    /// Indices of the points at the ends of the member.
    pub ends: [usize; 2],
}

/// A joint with a limit on its angle in constraints.
#[derive(Serialize)]
pub(super) struct JointOverview {
    pub name: String,
    /// Axle of a car to which the joint belongs.
    pub axle: Option<String>,
    /// Index of the joint's point.
    pub point: usize,
}

#[derive(Serialize)]
pub(super) struct CharacteristicOverview {
    pub name: String,
    pub unit: String,
    pub positive: &'static str,
    /// True if the study requests the characteristic, directly or by a target.
    pub asked: bool,
    /// True if the study has all inputs of the characteristic.
    pub available: bool,
}

/// A target for the charts of the page.
#[derive(Serialize)]
pub(super) struct TargetOverview {
    pub column: String,
    /// Columns of the curves that the target limits.
    pub columns: Vec<String>,
    pub tolerance: f64,
    /// Points of the target: value on the horizontal axis, lowest and highest target value there. `None` without such a limit.
    pub points: Vec<(f64, Option<f64>, Option<f64>)>,
    /// Name of the target's motion. `None` for the study's own motion.
    pub motion: Option<String>,
    /// Index of the slider of this motion to which the points refer. `None` if the points do not refer to a slider.
    pub over: Option<usize>,
    /// Rack displacements to which the target applies. Empty if it applies at every rack displacement.
    pub racks: Vec<f64>,
    pub is_band: bool,
}

#[derive(Serialize)]
pub(super) struct VariableOverview {
    pub name: String,
    /// Moved coordinates: index of the point, axis (0 to 2), and displacement of the coordinate per unit of the variable.
    pub moves: Vec<(usize, usize, f64)>,
    /// True if the variable rotates points about an axis, so that they do not move on straight lines.
    pub is_turn: bool,
    pub range: [f64; 2],
}

/// Answer for a solved design.
#[derive(Serialize)]
pub(super) struct SolvedAnswer {
    pub columns: Vec<ColumnValues>,
    /// Horizontal-axis value of each station. `None` if the station has no pose and its value is therefore not known.
    pub drive: Vec<Option<f64>>,
    /// Index of the group (curve) of each station. Stations of one group differ only in the horizontal-axis value.
    pub groups: Vec<usize>,
    /// Values of all sliders at the first station of each group. NaN (null in JSON) for a value that is not known, or for the drive
    /// of a wheel if it is on the horizontal axis.
    pub group_places: Vec<Vec<f64>>,
    /// Index of the group nearest to the slider positions.
    pub shown: usize,
    /// Rack displacement at the first station of the shown group. 0 for a car.
    pub rack: f64,
    /// True if the motion is given as a table of rows. Then curves connect the stations in the order of the rows.
    pub has_rows: bool,
    /// True if stations of other groups are left out. Failures and remarks then refer to the shown group only.
    pub is_partial: bool,
    pub status: Vec<&'static str>,
    pub failures: Vec<FailureRange>,
    /// Mechanism at the slider positions: the wheel, the left wheel of an axle, or the left side of a car. It has the pose, or the
    /// reason why there is no pose. `None` if the wheels cannot be solved at all.
    pub frame: Option<Drawn>,
    /// Right wheel of an axle, or right side of a car, at the slider positions. `None` for a single wheel.
    pub right: Option<Drawn>,
    /// The same as `frame`, with the points of the opened text. `None` if these points are the same or have no equilibrium.
    pub opened: Option<Drawn>,
    pub misfit: Option<Misfit>,
    pub remarks: Vec<String>,
    /// Computing time of this answer on the server, in milliseconds.
    pub milliseconds: f64,
}

/// Position of a mechanism in the drawing.
#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum Drawn {
    /// Drawing of one wheel.
    Wheel(Box<Frame>),
    /// Drawing of one side of a car, or the reason why it cannot be drawn.
    Side {
        pose: Result<Box<SidePlacement>, String>,
    },
}

impl From<Frame> for Drawn {
    fn from(frame: Frame) -> Self {
        Drawn::Wheel(Box::new(frame))
    }
}

/// One side of a car over the ground, in the axes of the front study.
#[derive(Clone, Serialize)]
pub(super) struct SidePlacement {
    /// Positions of the front axle's points, then of the rear axle's points.
    pub points: Vec<[f64; 3]>,
    pub spin_axes: [[f64; 3]; 2],
    pub contacts: [[f64; 3]; 2],
    /// Centre of gravity of the sprung mass.
    pub sprung_cg: [f64; 3],
    /// Unit vectors of the drawing's x, y and z axis in the axes of the car's body. Each row is one axis.
    pub axes: [[f64; 3]; 3],
}

#[derive(Serialize)]
pub(super) struct ColumnValues {
    pub column: String,
    pub title: String,
    pub unit: String,
    pub positive: Option<String>,
    pub values: Vec<Option<f64>>,
}

impl ColumnValues {
    pub(super) fn of(record: OutputRecord, values: impl Iterator<Item = Option<f64>>) -> Self {
        ColumnValues {
            column: record.column,
            title: record.title,
            unit: record.unit,
            positive: record.positive,
            values: values.collect(),
        }
    }
}

/// Misfit of a design as a multiple of the tolerances, with its derivatives with respect to every coordinate. If the misfit
/// cannot be computed, all lists are empty.
#[derive(Serialize)]
pub(super) struct Misfit {
    pub value: Option<f64>,
    /// Reason why the misfit cannot be computed. `None` if it can.
    pub reason: Option<String>,
    pub gradient: Coordinates,
    pub targets: Vec<TargetMisfit>,
    pub constraints: Vec<ConstraintMargin>,
}

/// Deviation from one target, as a multiple of its tolerance.
#[derive(Serialize)]
pub(super) struct TargetMisfit {
    pub column: String,
    /// Root mean square of the deviation over the stations of the target.
    pub rms: f64,
    /// Largest deviation of the curve from the target, with its sign.
    pub worst: f64,
    /// Value of the drive or axle coordinate at the largest deviation. `None` for a result of a load case.
    pub worst_at: Option<f64>,
    /// Unit of `worst_at`, or name of the load case.
    pub worst_at_unit: String,
    /// Derivatives of `rms` with respect to every coordinate.
    pub gradient: Coordinates,
}

/// Influence of one hardpoint coordinate on each column of the curves: derivatives at each station.
#[derive(Serialize)]
pub(super) struct InfluenceAnswer {
    pub columns: Vec<InfluenceColumn>,
}

#[derive(Serialize)]
pub(super) struct InfluenceColumn {
    pub column: String,
    pub slopes: Vec<Option<f64>>,
}

/// Answer with the moves of the points that leave the targets unchanged, to first order.
#[derive(Serialize)]
pub(super) struct DirectionsAnswer {
    pub directions: Vec<FreeDirection>,
}

impl DirectionsAnswer {
    /// Makes an answer without directions.
    pub(super) fn none() -> Self {
        DirectionsAnswer {
            directions: Vec::new(),
        }
    }
}

/// Combination of variables that leaves the targets unchanged, to first order.
#[derive(Serialize)]
pub(super) struct FreeDirection {
    /// Variables and their amounts for the full `change`, in words.
    pub name: String,
    /// Displacement of each point, in the study's axes and unit.
    pub change: Coordinates,
    /// Ends of the slider that applies the direction, as multiples of `change`. Between them, all variables stay within their
    /// ranges.
    pub free: [f64; 2],
}

/// Limits of the mechanism, or lift limits of a car, as a table.
#[derive(Serialize)]
pub(super) struct LimitsAnswer {
    pub title: &'static str,
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
    /// Sentences below the table.
    pub notes: Vec<String>,
}

impl LimitsAnswer {
    /// Selects some columns of a table, in the table's order.
    pub(super) fn of(
        title: &'static str,
        table: &Table,
        is_shown: impl Fn(&str) -> bool,
        notes: Vec<String>,
    ) -> Self {
        let header = table.header();
        let shown: Vec<usize> = (0..header.len()).filter(|k| is_shown(header[*k])).collect();
        let row = |cells: Vec<&Cell>| {
            let texts = shown.iter().map(|k| cells[*k].text().to_owned());
            texts.collect()
        };
        LimitsAnswer {
            title,
            header: shown.iter().map(|k| header[*k].to_owned()).collect(),
            rows: table.rows().map(row).collect(),
            notes,
        }
    }
}

/// State of a tuning. `error` and `proposal` are `None` until the tuning is done.
#[derive(Serialize)]
pub(super) struct JobState {
    pub job: u64,
    pub iterations: u64,
    /// Number of starts (searches from different designs) that have begun.
    pub starts: usize,
    /// Smallest misfit that the tuning has reached so far.
    pub misfit: Option<f64>,
    pub done: bool,
    pub error: Option<String>,
    pub proposal: Option<Proposal>,
}

#[derive(Clone, Serialize)]
pub(super) struct Proposal {
    pub design: Coordinates,
    /// Changes of the text that set the tuned rates of elastic parts, or the tuned values of a car.
    pub edits: Vec<ValueEdit>,
    /// Present value that each edit replaces, so that the page can apply a part of the change.
    pub origins: Vec<serde_json::Value>,
    /// Changed rates of elastic parts and changed values of a car, in words: name, present value, tuned value.
    pub rates: Vec<[String; 3]>,
    pub headline: String,
    pub side_effects: SideEffectRows,
    /// Yields of a robust tuning whose study has bands.
    pub yields: Option<YieldRows>,
    pub remarks: Vec<String>,
    pub interrupted: bool,
}

/// Yields before and after a robust tuning: a sentence and a table of the bands.
#[derive(Clone, Serialize)]
pub(super) struct YieldRows {
    pub headline: String,
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl From<&YieldRecord> for YieldRows {
    fn from(yields: &YieldRecord) -> Self {
        let table = yields.table();
        let row = |cells: Vec<&Cell>| cells.iter().map(|cell| cell.text().to_owned()).collect();
        YieldRows {
            headline: yields.headline(),
            header: table.header().into_iter().map(str::to_owned).collect(),
            rows: table.rows().map(row).collect(),
        }
    }
}

/// Table of the changes of outputs through a tuning that no target requests (side effects).
#[derive(Clone, Serialize)]
pub(super) struct SideEffectRows {
    pub header: Vec<String>,
    pub rows: Vec<SideEffectRow>,
    /// Outputs that are not in the table, in words.
    pub rest: Vec<String>,
}

#[derive(Clone, Serialize)]
pub(super) struct SideEffectRow {
    pub cells: Vec<String>,
    pub is_flagged: bool,
}

impl SideEffectRows {
    pub(super) fn of(effects: &[SideEffect]) -> Self {
        let (shown, more) = shown_side_effects(effects);
        let table = side_effects_table(&shown);
        let rows = table
            .rows()
            .zip(&shown)
            .map(|(cells, effect)| SideEffectRow {
                cells: cells.iter().map(|cell| cell.text().to_owned()).collect(),
                is_flagged: effect.flagged,
            });
        let more = (more > 0).then(|| counted(more, "further change"));
        SideEffectRows {
            header: table.header().into_iter().map(str::to_owned).collect(),
            rows: rows.collect(),
            rest: more.into_iter().chain(further_in_words(effects)).collect(),
        }
    }
}

/// Answer to a save, and to the choice of a new study.
#[derive(Serialize)]
pub(super) struct Saved {
    /// Names of the files whose texts have changed. Empty if no text has changed.
    pub file: String,
    /// SHA-256 of the study text that the page shows. A save under another name does not change it.
    pub digest: String,
}

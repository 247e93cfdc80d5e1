//! `report.json`: data for the page that no other file of the run has.

use super::accuracy::remarks;
use super::bands::limits_of;
use super::chart::in_words;
use super::choices::FrontRecord;
use super::failures::FailureRange;
use super::places::Places;
use super::scene::Scene;
use crate::curves::{Column, Curves, Frame, Influence, Placement};
use crate::plan::Plan;
use crate::study::{Band, Drive, Study, Target, Wanted};
use serde::{Deserialize, Serialize};

/// Version of the file's format. The program reads no files of other versions.
pub(super) const FORM: u32 = 2;

/// Data that the page needs in addition to the other files of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Equal to `FORM`.
    pub form: u32,
    /// Name of the command, such as `solve` or `optimise`.
    pub command: String,
    /// Version of the program.
    pub version: String,
    /// Name of the study.
    pub study: String,
    /// Name of the topology.
    pub topology: String,
    /// Unit of every length.
    pub length_unit: String,
    /// Curves over the study's own motion, with the poses of the drawing.
    #[serde(flatten)]
    pub motion: MotionRecord,
    /// Curves over the named motions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motions: Vec<NamedMotionRecord>,
    /// Regions of the constraints, for the drawing.
    #[serde(default)]
    pub places: Places,
    /// Data of the drawing that are the same in every pose: names of the points, lines between them, and the wheel radius.
    pub scene: Scene,
    /// Influence of each hardpoint coordinate on the curves of the last design.
    pub influences: Vec<Influence>,
    /// Pareto front: alternatives to the tuned design.
    #[serde(default)]
    pub front: Option<FrontRecord>,
}

/// Curves over one motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionRecord {
    /// Column of the drive value (the coordinate that moves the wheel: travel or an angle). For an axle: column of the first
    /// coordinate that moves.
    pub drive: String,
    /// Other columns that can be on the horizontal axis. For a wheel: travel if an angle drives the motion, and time. For an axle:
    /// the other coordinates that change.
    pub abscissae: Vec<String>,
    /// Column of the rack displacement, if the rack moves.
    pub rack: Option<String>,
    /// For an axle: columns of the other coordinates that move.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<String>,
    /// Descriptions of the columns of the curves.
    pub outputs: Vec<OutputRecord>,
    /// Targets of the tuning on this motion.
    pub targets: Vec<TargetRecord>,
    /// Target bands (lower and upper limits of outputs) on this motion.
    #[serde(default)]
    pub bands: Vec<BandCurve>,
    /// Designs of the run, the tuned one last.
    pub designs: Vec<DesignRecord>,
}

/// Curves over a motion of `[motions.NAME]`. The designs in this record have no poses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedMotionRecord {
    /// Name of the motion.
    pub name: String,
    /// Curves over the motion.
    #[serde(flatten)]
    pub motion: MotionRecord,
}

/// A column of the curves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputRecord {
    /// Name in the CSV files.
    pub column: String,
    /// Readable title: `camber`, `camber, 1st derivative`.
    pub title: String,
    /// Readable unit: `°/mm`. Empty for a dimensionless number.
    pub unit: String,
    /// Meaning of a positive value.
    pub positive: Option<String>,
}

/// A target at its stations, sorted by drive value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetRecord {
    /// Column of the target.
    pub column: String,
    /// Tolerance of the target in the column's unit.
    pub tolerance: f64,
    /// Points of the target: drive value (travel or angle of the station) and target value, in the units of the CSV files.
    pub points: Vec<[f64; 2]>,
    /// For an axle: column that replaces the drive value in `points`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over: Option<String>,
    /// For an axle: columns of other coordinates that move, but that have one value at the stations of the target, with this value.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<(String, f64)>,
}

/// A target band (lower and upper limit of an output) at its stations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandCurve {
    /// Column of the output that the band limits.
    pub column: String,
    /// Drive value, lower limit and upper limit, in the units of the CSV files, sorted by drive value. `None` without a limit.
    pub limits: Vec<(f64, Option<f64>, Option<f64>)>,
    /// Tolerance of the band in the column's unit.
    #[serde(default)]
    pub tolerance: f64,
}

/// One design of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DesignRecord {
    /// Label of the design, such as `design`, `before` or `after`.
    pub label: String,
    /// Name of the file with its curves.
    pub curves: String,
    /// Number of stations of the design's curves.
    pub stations: usize,
    /// Remarks on the accuracy of the curves.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// Ranges of stations without a pose, with their reasons.
    pub failures: Vec<FailureRange>,
    /// Poses at some stations. Empty if they equal the poses of the last design.
    pub frames: Vec<Frame>,
}

impl DesignRecord {
    /// Pose nearest to the design position. `None` if no pose is solved.
    pub(super) fn nearest_pose(&self) -> Option<&Placement> {
        let size = |frame: &Frame| frame.drive.abs() + frame.rack.abs();
        let frames = self.frames.iter();
        let solved = frames.filter_map(|frame| Some((size(frame), frame.pose.as_ref().ok()?)));
        let nearest = solved.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, pose)| pose)
    }
}

/// A design to be recorded.
pub struct DrawnDesign<'a> {
    /// Name of the design.
    pub label: &'a str,
    /// Name of the file with its curves.
    pub file: &'a str,
    /// Curves of the design.
    pub curves: &'a Curves,
    /// Poses along the motion of the design. Empty if they equal the poses of the last design.
    pub frames: Vec<Frame>,
}

impl Record {
    /// Makes the record of a run from its designs, and from the influence of each coordinate on the last design. The record has no
    /// named motions and no Pareto front.
    pub fn with(
        command: &str,
        study: &Study,
        plan: &Plan,
        designs: Vec<DrawnDesign<'_>>,
        influences: Vec<Influence>,
    ) -> Self {
        let length = study.wheel().length_unit;
        Record {
            form: FORM,
            command: command.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: study.name.clone(),
            topology: study.wheel().mechanism.topology.name.to_owned(),
            length_unit: length.symbol().to_owned(),
            motion: MotionRecord::of_wheel(study, None, plan, designs),
            motions: Vec::new(),
            places: Places::of(study),
            scene: Scene::of(study.wheel()),
            influences,
            front: None,
        }
    }
}

impl Record {
    /// Curves over the study's own motion, then over each named motion.
    pub fn all_motions(&self) -> impl Iterator<Item = &MotionRecord> {
        let named = self.motions.iter().map(|named| &named.motion);
        std::iter::once(&self.motion).chain(named)
    }
}

impl MotionRecord {
    /// Records the curves of a wheel over a motion. `name` is the name of the motion; `None` for `[motion]`. The motion of `study`
    /// must be this motion.
    pub fn of_wheel(
        study: &Study,
        name: Option<&str>,
        plan: &Plan,
        designs: Vec<DrawnDesign<'_>>,
    ) -> Self {
        let length = study.wheel().length_unit;
        let unit = length.symbol();
        let mut abscissae = Vec::new();
        abscissae.extend((plan.drive.is_angle()).then(|| Drive::Travel.column(length)));
        abscissae.extend(plan.time.is_some().then(|| "time_s".to_owned()));
        let outputs = designs.last().map_or_else(Vec::new, |last| {
            last.curves.columns.iter().map(OutputRecord::of).collect()
        });
        let record = |design: DrawnDesign<'_>| DesignRecord {
            label: design.label.to_owned(),
            curves: design.file.to_owned(),
            stations: design.curves.stations.len(),
            remarks: remarks(design.curves, length),
            failures: FailureRange::all(design.curves, study.wheel()),
            frames: design.frames,
        };
        MotionRecord {
            drive: plan.drive.column(length),
            abscissae,
            rack: plan.rack_moves.then(|| format!("rack_{unit}")),
            further: Vec::new(),
            outputs,
            targets: targets(study, name),
            bands: bands(study, name),
            designs: designs.into_iter().map(record).collect(),
        }
    }
}

/// Target values and target curves of the motion with this name, for charts. Bands and targets with a rack displacement of their
/// own are left out.
fn targets(study: &Study, name: Option<&str>) -> Vec<TargetRecord> {
    let targets = study.optimise.iter().flat_map(|o| &o.targets);
    let record = |target: &Target| {
        let drive = study.motion().drive;
        TargetRecord::of(target, &target.stations_in(study.motion()), |at| {
            drive.printed(at)
        })
    };
    let plain = targets.filter(|t| t.is_plain() && t.site.is_whole_motion(name));
    plain.map(record).collect()
}

impl BandCurve {
    /// Curve of a tolerance band (allowed range of an output). `drives` has the printed drive values (travels or angles) of the
    /// motion, in any order. A band without its own drive value extends from the smallest to the largest of them.
    pub fn of_tolerance(band: &Band, drives: &[f64]) -> Self {
        let [low, high] = limits_of(band);
        let drives = || drives.iter().copied();
        let ends = [
            drives().min_by(f64::total_cmp),
            drives().max_by(f64::total_cmp),
        ];
        let places: Vec<f64> = match band.at {
            Some(at) => vec![at],
            None => ends.into_iter().flatten().collect(),
        };
        BandCurve {
            column: band.of.column.clone(),
            limits: places.into_iter().map(|at| (at, low, high)).collect(),
            tolerance: 0.0,
        }
    }
}

impl TargetRecord {
    /// Record of a target at these stations (drive values in radians or length units). `printed` converts a drive value to the
    /// printed value.
    pub(super) fn of(target: &Target, stations: &[f64], printed: impl Fn(f64) -> f64) -> Self {
        let factor = target.of.factor();
        let points = target.wanted.at_stations(stations).into_iter();
        let points = points.map(|(at, value)| [printed(at), value * factor]);
        let mut points: Vec<[f64; 2]> = points.collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        TargetRecord {
            column: target.of.column.clone(),
            tolerance: target.tolerance * factor.abs(),
            points,
            over: None,
            held: Vec::new(),
        }
    }

    /// Coordinates in `held` with their values, in words: `heave 0 mm`. `None` if `held` is empty.
    pub(super) fn held_in_words(&self) -> Option<String> {
        let held = self.held.iter();
        let words: Vec<String> = held.map(|(column, at)| in_words(column, *at)).collect();
        (!words.is_empty()).then(|| words.join(", "))
    }
}

/// Target bands of the motion with this name, for charts. Bands with a rack displacement of their own are left out.
fn bands(study: &Study, name: Option<&str>) -> Vec<BandCurve> {
    let targets = study.optimise.iter().flat_map(|o| &o.targets);
    let bands = targets.filter(|target| {
        matches!(target.wanted, Wanted::Band { .. }) && target.site.is_whole_motion(name)
    });
    let record = |target: &Target| BandCurve {
        column: target.of.column.clone(),
        limits: wanted_between(
            target,
            &target.stations_in(study.motion()),
            study.motion().drive,
        ),
        tolerance: target.tolerance * target.of.factor().abs(),
    };
    bands.map(record).collect()
}

/// Printed limits of a target at stations: drive value, lower limit and upper limit, sorted by drive value. `None` without a
/// limit.
pub(crate) fn wanted_between(
    target: &Target,
    stations: &[f64],
    drive: Drive,
) -> Vec<(f64, Option<f64>, Option<f64>)> {
    let factor = target.of.factor();
    let printed = |limit: f64| limit.is_finite().then_some(limit * factor);
    let samples = target.wanted.samples(stations).into_iter();
    let limits = samples.map(|sample| {
        // If the axis of the study has the opposite direction, the lower and the upper limit are exchanged.
        let [low, high] = if factor < 0.0 {
            [sample.high, sample.low]
        } else {
            [sample.low, sample.high]
        };
        (drive.printed(sample.drive), printed(low), printed(high))
    });
    let mut limits: Vec<_> = limits.collect();
    limits.sort_by(|a, b| a.0.total_cmp(&b.0));
    limits
}

impl OutputRecord {
    /// Describes a column of curves.
    pub fn of(column: &Column) -> Self {
        let name = column.output.replace('_', " ");
        OutputRecord {
            column: column.name.clone(),
            title: match (column.by, column.order) {
                (_, 0) => name,
                (Some(by), 1) => format!("{name} by {by}"),
                (Some(by), _) => format!("{name} by {by}, 2nd derivative"),
                (None, 1) => format!("{name}, 1st derivative"),
                (None, _) => format!("{name}, 2nd derivative"),
            },
            unit: readable_unit(&column.unit),
            positive: column.positive.map(str::to_owned),
        }
    }
}

/// Readable form of a unit of columns: `deg_per_mm2` -> `°/mm²`.
pub(crate) fn readable_unit(unit: &str) -> String {
    let unit = match unit.strip_prefix("per_") {
        Some(below) => format!("1/{below}"),
        None => unit.replace("_per_", "/"),
    };
    match unit.as_str() {
        "percent" => "%".to_owned(),
        _ => {
            let unit = unit.replace('2', "²").replace('3', "³");
            unit.replace("deg", "°").replace('_', " ")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_readable() {
        for (unit, readable) in [
            ("deg", "°"),
            ("deg_per_mm2", "°/mm²"),
            ("deg_per_in3", "°/in³"),
            ("percent", "%"),
            ("per_mm", "1/mm"),
            ("mm_per_s2", "mm/s²"),
            ("N_mm_per_rad", "N mm/rad"),
            ("lbf_in_per_rad", "lbf in/rad"),
            ("deg_per_100_N_m", "°/100 N m"),
            ("", ""),
        ] {
            assert_eq!(readable_unit(unit), readable);
        }
    }
}

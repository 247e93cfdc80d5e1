//! `report.json` of an axle: data for its page that no other file of the run has.

use super::accuracy::remarks;
use super::failures::FailureRange;
use super::places::Places;
use super::record::{DesignRecord, FORM, MotionRecord, OutputRecord, Record, TargetRecord};
use super::scene::Scene;
use crate::axle::{Axle, AxleMotion, AxlePlan, Coordinate, Placement, axle_frames};
use crate::curves::thinned::evenly;
use crate::curves::{Curves, Frame};
use crate::mechanism::{DesignFault, NoPose};
use crate::model::Side;
use crate::study::{Study, Target};

/// Largest number of stations in the drawing, along the first and along the second coordinate of the motion.
const MOST_FRAMES: [usize; 2] = [41, 9];

/// A design to be recorded: its label, the name of the file with its curves, its axle, and its curves.
pub type SolvedAxle<'a> = (&'a str, &'a str, &'a Axle, &'a Curves);

impl Record {
    /// Makes the record of a run of an axle. An error names the wheel whose design position cannot be solved.
    pub fn of_axle(
        command: &str,
        study: &Study,
        plan: &AxlePlan,
        designs: &[SolvedAxle<'_>],
    ) -> Result<Self, (Side, DesignFault)> {
        let (_, _, axle, _) = designs.last().expect("a run has a design");
        let frames: Vec<_> = designs
            .iter()
            .map(|(.., axle, _)| frames(axle, &plan.motion, &plan.motion.moving()))
            .collect::<Result<_, _>>()?;
        Ok(Record {
            form: FORM,
            command: command.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: study.name.clone(),
            topology: match axle.left.mechanism.topology.name {
                // The name of a solid axle already contains the word "axle".
                name if name.ends_with("axle") => name.to_owned(),
                name => format!("{name}_axle"),
            },
            length_unit: axle.left.length_unit.symbol().to_owned(),
            motion: MotionRecord::of_axle(study, None, plan, designs, frames),
            motions: Vec::new(),
            scene: Scene::of_axle(axle),
            influences: Vec::new(),
            front: None,
            places: Places::default(),
        })
    }
}

impl MotionRecord {
    /// Records the curves of an axle over a motion. `name` is the name of the motion that `plan` has. `frames` has a list of poses
    /// for each design. If there are fewer lists than designs, the remaining designs are recorded without poses.
    pub fn of_axle(
        study: &Study,
        name: Option<&str>,
        plan: &AxlePlan,
        designs: &[SolvedAxle<'_>],
        frames: Vec<Vec<Frame>>,
    ) -> Self {
        let (_, _, axle, curves) = designs.last().expect("a run has a design");
        let length = axle.left.length_unit;
        let moving = plan.motion.moving();
        let column = |coordinate: &Coordinate| coordinate.column(length);
        let further: Vec<String> = moving[1..].iter().map(column).collect();
        // Every coordinate that changes can be on the horizontal axis, also for a motion that is given as a table of rows.
        let abscissae = plan.motion.all_moving();
        let abscissae = abscissae.iter().filter(|c| **c != moving[0]).map(column);
        let frames = frames.into_iter().chain(std::iter::repeat_with(Vec::new));
        let record = |((label, file, axle, curves), frames): (&SolvedAxle<'_>, _)| DesignRecord {
            label: (*label).to_owned(),
            curves: (*file).to_owned(),
            stations: curves.stations.len(),
            remarks: remarks(curves, length),
            failures: FailureRange::all(curves, &axle.left),
            frames,
        };
        let targets = study.optimise.iter().flat_map(|o| &o.targets);
        MotionRecord {
            drive: column(&moving[0]),
            abscissae: abscissae.collect(),
            rack: None,
            further,
            outputs: curves.columns.iter().map(OutputRecord::of).collect(),
            targets: targets
                .filter_map(|t| target(t, name, &plan.motion, axle))
                .collect(),
            bands: Vec::new(),
            designs: designs.iter().zip(frames).map(record).collect(),
        }
    }
}

/// Frames (poses for the drawing) over the first coordinate that moves, for some values of the second coordinate. All other
/// coordinates have their value nearest to zero.
fn frames(
    axle: &Axle,
    motion: &AxleMotion,
    moving: &[Coordinate],
) -> Result<Vec<Frame>, (Side, DesignFault)> {
    let mut motion = motion.clone();
    motion.steering_wheel = None;
    if motion.has_rows() {
        return frames_of_rows(axle, &motion, moving[0]);
    }
    for (number, coordinate) in moving.iter().enumerate() {
        let values = motion.along(*coordinate).expect("it moves");
        *values = match MOST_FRAMES.get(number) {
            Some(most) => evenly(values, *most),
            None => {
                let nearest = values.iter().copied();
                let nearest = nearest.min_by(|a, b| a.abs().total_cmp(&b.abs()));
                nearest.into_iter().collect()
            }
        };
    }
    let mut list = |coordinate: Coordinate| motion.along(coordinate).cloned().unwrap_or_default();
    let drives = list(moving[0]);
    let seconds = moving.get(1).map_or(vec![0.0], |second| list(*second));
    let mut frames = Vec::new();
    for second in seconds {
        for drive in &drives {
            let mut one = motion.clone();
            *one.along(moving[0]).expect("it moves") = vec![*drive];
            if let Some(coordinate) = moving.get(1) {
                *one.along(*coordinate).expect("it moves") = vec![second];
            }
            frames.push((one, *drive, second));
        }
    }
    let placements: Vec<_> = frames.iter().flat_map(|f| f.0.placements()).collect();
    let places = frames.iter().map(|(_, drive, second)| {
        let second = moving.get(1).map_or(0.0, |c| c.written(*second, axle));
        [moving[0].written(*drive, axle), second]
    });
    drawn(axle, &placements, places)
}

/// Frames for a motion that is given as a table of rows: for some of the rows, evenly spaced.
fn frames_of_rows(
    axle: &Axle,
    motion: &AxleMotion,
    over: Coordinate,
) -> Result<Vec<Frame>, (Side, DesignFault)> {
    let all: Vec<f64> = (0..motion.stations()).map(|row| row as f64).collect();
    let rows = evenly(&all, MOST_FRAMES[0]).into_iter();
    let rows: Vec<AxleMotion> = rows.map(|row| motion.row(row as usize)).collect();
    let placements: Vec<_> = rows.iter().flat_map(AxleMotion::placements).collect();
    let places = placements
        .iter()
        .map(|at| [over.written(at.along(over), axle), 0.0]);
    drawn(axle, &placements, places)
}

/// Frames (poses for the drawing) of the axle at `placements`. `places` contains the values of the first and the second moving
/// coordinate for each frame.
fn drawn(
    axle: &Axle,
    placements: &[Placement],
    places: impl Iterator<Item = [f64; 2]>,
) -> Result<Vec<Frame>, (Side, DesignFault)> {
    let drawn = axle_frames(axle, placements)?;
    let frame = |([drive, rack], drawn): ([f64; 2], _)| Frame {
        drive,
        rack,
        pose: Result::map_err(drawn, |reason: NoPose| {
            reason.describe(axle.left.length_unit, axle.left.frame)
        }),
    };
    Ok(places.zip(drawn).map(frame).collect())
}

/// Target as a value or a curve in the chart of its column. `None` for a band, for a target on another motion than `name`, and for
/// a target that gives values of other coordinates.
fn target(
    target: &Target,
    name: Option<&str>,
    motion: &AxleMotion,
    axle: &Axle,
) -> Option<TargetRecord> {
    let site = target
        .site
        .axle
        .as_ref()
        .filter(|site| site.is_whole_motion(name))?;
    let record = TargetRecord::of(target, &target.stations_among(&site.values), |at| at);
    let length = axle.left.length_unit;
    let held = site.held_in(motion, axle).into_iter();
    (!record.points.is_empty()).then(|| TargetRecord {
        over: Some(site.over.column(length)),
        held: held.map(|(c, value)| (c.column(length), value)).collect(),
        ..record
    })
}

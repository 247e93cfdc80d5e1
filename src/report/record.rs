//! `report.json`: what the report needs beyond the other files of a run.

use super::accuracy::remarks;
use super::failures::FailureRange;
use super::influence::{Influence, influences};
use super::scene::Scene;
use crate::curves::{Column, Curves, Frame, frames};
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::plan::Plan;
use crate::solve::StationOrder;
use crate::study::{Drive, Study};
use serde::{Deserialize, Serialize};

/// The form of the file. A reader takes no other.
pub const FORM: u32 = 2;

/// The most frames of the drawing, and stations of the sensitivities: a page must stay small and a run
/// of a million stations must not be run twice.
const MOST_FRAMES: usize = 400;

/// What the report needs beyond the other files of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// `FORM`.
    pub form: u32,
    /// `solve` or `optimise`.
    pub command: String,
    /// Version of the program.
    pub version: String,
    /// Name of the study.
    pub study: String,
    /// Name of the topology.
    pub topology: String,
    /// Unit of every length.
    pub length_unit: String,
    /// Column of the drive value.
    pub drive: String,
    /// Other columns a curve can be drawn over.
    pub abscissae: Vec<String>,
    /// Column of the rack displacement, where it moves.
    pub rack: Option<String>,
    /// Of an axle: columns of what moves beside the drive value.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<String>,
    /// What the columns of the curves are.
    pub outputs: Vec<OutputRecord>,
    /// What was wanted.
    pub targets: Vec<TargetRecord>,
    /// The designs, the tuned one last.
    pub designs: Vec<DesignRecord>,
    /// The drawing.
    pub scene: Scene,
    /// Of the last design.
    pub influences: Vec<Influence>,
}

/// A column of the curves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputRecord {
    /// Its name in the CSV files.
    pub column: String,
    /// For reading: `camber`, `camber, 1st derivative`.
    pub title: String,
    /// For reading: `deg/mm`; empty for a plain number.
    pub unit: String,
    /// When it is positive.
    pub positive: Option<String>,
}

/// A target, at the stations where it is compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetRecord {
    /// The column it is about.
    pub column: String,
    /// In the column's unit.
    pub tolerance: f64,
    /// Drive values and wanted values, in the units of the CSV files.
    pub points: Vec<[f64; 2]>,
    /// Of an axle: the column that it is over in place of the drive value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over: Option<String>,
}

/// One design of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DesignRecord {
    /// `design`, `before` or `after`.
    pub label: String,
    /// The file with its curves.
    pub curves: String,
    /// Number of stations.
    pub stations: usize,
    /// What has to be said of the accuracy.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// The stations that failed.
    pub failures: Vec<FailureRange>,
    /// Some of the stations, drawn.
    pub frames: Vec<Frame>,
}

/// A design to be recorded: label, file with its curves, the suspension and the curves themselves.
pub type Solved<'a> = (&'a str, &'a str, &'a Suspension, &'a Curves);

impl Record {
    /// The record of a run. The last of the designs is the one sensitivities are taken of.
    pub fn of(
        command: &str,
        study: &Study,
        plan: &Plan,
        designs: &[Solved<'_>],
    ) -> Result<Self, DesignFault> {
        let influences = match designs.last() {
            Some((_, _, suspension, _)) => influences(suspension, &plan.thinned(MOST_FRAMES, 9))?,
            None => Vec::new(),
        };
        Ok(Record {
            influences,
            ..Record::drawing(command, study, plan, designs)?
        })
    }

    /// The same without sensitivities.
    pub fn drawing(
        command: &str,
        study: &Study,
        plan: &Plan,
        designs: &[Solved<'_>],
    ) -> Result<Self, DesignFault> {
        let length = study.suspension.length_unit;
        let unit = length.symbol();
        let (travel, arm) = (format!("travel_{unit}"), "arm_angle_deg".to_owned());
        let (drive, mut abscissae) = match plan.drive {
            Drive::Travel => (travel, Vec::new()),
            Drive::ArmAngle => (arm, vec![travel]),
            Drive::PaperTheta => ("theta_deg".to_owned(), vec![travel]),
        };
        abscissae.extend(plan.time.is_some().then(|| "time_s".to_owned()));
        let few = plan.thinned(MOST_FRAMES, 9);
        let record = |(label, file, suspension, curves): &Solved<'_>| {
            Ok(DesignRecord {
                label: (*label).to_owned(),
                curves: (*file).to_owned(),
                stations: curves.stations.len(),
                remarks: remarks(study, curves),
                failures: FailureRange::all(curves, plan.drive, length),
                frames: frames(suspension, &few)?,
            })
        };
        let outputs = designs.last().map_or_else(Vec::new, |(_, _, _, curves)| {
            curves.columns.iter().map(OutputRecord::of).collect()
        });
        Ok(Record {
            form: FORM,
            command: command.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: study.name.clone(),
            topology: study.suspension.mechanism.topology.name.to_owned(),
            length_unit: unit.to_owned(),
            drive,
            abscissae,
            rack: plan.rack_moves.then(|| format!("rack_{unit}")),
            further: Vec::new(),
            outputs,
            targets: targets(study),
            designs: designs.iter().map(record).collect::<Result<_, _>>()?,
            scene: Scene::of(&study.suspension),
            influences: Vec::new(),
        })
    }
}

impl Plan {
    /// The plan with so many stations at most, at so many displacements of the rack, and no loads.
    pub(crate) fn thinned(&self, most: usize, most_racks: usize) -> Plan {
        let racks = evenly(&self.racks, most_racks);
        let values = evenly(self.station_order.values(), most / racks.len());
        Plan {
            station_order: StationOrder::through(&values),
            racks,
            loads: Vec::new(),
            ..self.clone()
        }
    }
}

/// At most so many of the values, evenly chosen, the first and the last among them.
pub(super) fn evenly(values: &[f64], most: usize) -> Vec<f64> {
    match values.len() {
        few if few <= most => values.to_vec(),
        many => (0..most)
            .map(|i| values[i * (many - 1) / (most - 1)])
            .collect(),
    }
}

/// The targets that can be drawn beside the curves: values and curves in the study's own motion.
fn targets(study: &Study) -> Vec<TargetRecord> {
    let targets = study.optimise.iter().flat_map(|o| &o.targets);
    targets
        .filter(|target| target.is_plain())
        .map(|target| {
            let factor = target.of.factor();
            let printed =
                |(drive, value): (f64, f64)| [study.motion.drive.printed(drive), value * factor];
            let mut points: Vec<[f64; 2]> = target
                .wanted
                .at_stations(&target.stations_in(&study.motion))
                .into_iter()
                .map(printed)
                .collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            TargetRecord {
                column: target.of.column.clone(),
                tolerance: target.tolerance * factor.abs(),
                points,
                over: None,
            }
        })
        .collect()
}

impl OutputRecord {
    /// Of a column of the curves.
    pub fn of(column: &Column) -> Self {
        let name = column.output.replace('_', " ");
        OutputRecord {
            column: column.name.clone(),
            title: match column.order {
                0 => name,
                1 => format!("{name}, 1st derivative"),
                _ => format!("{name}, 2nd derivative"),
            },
            unit: readable_unit(&column.unit),
            positive: column.positive.map(str::to_owned),
        }
    }
}

/// `deg_per_mm2` -> `deg/mm²`.
pub(super) fn readable_unit(unit: &str) -> String {
    let unit = unit.replace("N_m", "N m");
    let unit = match unit.strip_prefix("per_") {
        Some(below) => format!("1/{below}"),
        None => unit.replace("_per_", "/"),
    };
    match unit.as_str() {
        "percent" => "%".to_owned(),
        _ => unit.replace('2', "²").replace("deg", "°"),
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
            ("percent", "%"),
            ("per_mm", "1/mm"),
            ("mm_per_s2", "mm/s²"),
            ("", ""),
        ] {
            assert_eq!(readable_unit(unit), readable);
        }
    }

    #[test]
    fn thinning_keeps_the_ends() {
        let values: Vec<f64> = (0..1000).map(f64::from).collect();
        let few = evenly(&values, 41);
        assert_eq!((few.len(), few[0], few[40]), (41, 0.0, 999.0));
        assert_eq!(evenly(&values, 1000), values);
    }
}

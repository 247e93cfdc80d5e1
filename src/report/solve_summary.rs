//! Summary of a solve.

use super::accuracy::{CertificateSummary, ConditionSummary};
use super::completeness::Completeness;
use super::figure::figure;
use super::ranges::Range;
use super::station_label::StationLabel;
use super::table::{Cell, Column, Table};
use crate::curves::{Curves, Station, Status};
use crate::mechanism::Work;
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// `summary.json` of a solve.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SolveSummary {
    command: String,
    version: String,
    study: String,
    topology: String,
    stations: usize,
    /// Stations by status, and empty cells by reason.
    #[serde(default)]
    completeness: Completeness,
    failed: Vec<FailedStation>,
    outputs: Vec<Range>,
    /// Accuracy, if at least one pose exists.
    #[serde(default)]
    condition: Option<ConditionSummary>,
    /// Certificate, if the study requests one.
    #[serde(default)]
    certificate: Option<CertificateSummary>,
    /// Counts of the work.
    #[serde(default)]
    work: Work,
    /// Reasons for which the tracker left stations to the continuation.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    left_to_continuation: Vec<Left>,
}

/// Stations that the tracker left to the continuation for one reason.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Left {
    reason: String,
    stations: usize,
}

/// A station without a pose.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct FailedStation {
    #[serde(flatten)]
    place: StationLabel,
    status: String,
    reason: String,
}

impl SolveSummary {
    /// The summary of some curves.
    pub fn of(study: &Study, curves: &Curves) -> Self {
        let drive = study.motion.drive;
        let failed = curves.stations.iter().filter_map(|s| match s.status {
            Status::Ok | Status::IllConditioned | Status::Unsupported | Status::Toggle(_) => None,
            Status::Failed(failure) => Some(FailedStation {
                place: StationLabel::of(s, drive),
                status: s.status.word().to_owned(),
                reason: failure.describe(study.suspension.length_unit, study.suspension.frame),
            }),
        });
        let is_design =
            |s: &&Station| s.angle.or(s.travel) == Some(0.0) && s.rack == 0.0 && s.time.is_none();
        let design = curves.stations.iter().find(is_design);
        let outputs = curves.columns.iter().enumerate().map(|(k, column)| {
            let values = curves.stations.iter().filter_map(|s| s.values[k]);
            let at_design = design.and_then(|s| s.values[k]);
            Range::of([&column.name, &column.unit], at_design, values)
        });
        SolveSummary {
            command: "solve".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: study.name.clone(),
            topology: study.suspension.mechanism.topology.name.to_owned(),
            stations: curves.stations.len(),
            completeness: Completeness::of(curves),
            failed: failed.collect(),
            outputs: outputs.collect(),
            condition: ConditionSummary::of(curves, drive),
            certificate: CertificateSummary::of(study, curves),
            work: curves.work,
            left_to_continuation: (curves.left_to_continuation.iter())
                .map(|(reason, stations)| Left {
                    reason: reason.describe().to_owned(),
                    stations: *stations,
                })
                .collect(),
        }
    }

    /// The range of every output.
    pub fn table(&self) -> Table {
        Range::table(&self.outputs)
    }

    /// Values at the first station, for curves of the design position only.
    pub fn design_table(design: &Curves) -> Table {
        let unit = Column::for_programs("unit");
        let columns = ["output", "at design"].map(Column::from);
        let mut table = Table::with_columns(columns.into_iter().chain([unit]));
        let values = design.stations.iter().take(1).flat_map(|s| &s.values);
        for (column, value) in design.columns.iter().zip(values) {
            let value = Cell::by(*value, |v| figure(v, &column.unit));
            let name = Cell::from(column.name.as_str());
            table.push([name, value, column.unit.as_str().into()]);
        }
        table
    }

    /// For programs: the stations without a pose.
    pub fn failures_table(&self) -> Table {
        let places = ["travel", "arm angle deg", "theta deg", "rack"];
        let mut table = Table::with_columns(places.into_iter().chain(["status", "reason"]));
        for failed in &self.failed {
            let mut row: Vec<Cell> = failed.place.cells().into();
            row.extend([failed.status.as_str().into(), failed.reason.as_str().into()]);
            table.push_row(row);
        }
        table
    }

    /// Number of stations of each status, for programs.
    pub fn stations_table(&self) -> Table {
        self.completeness.table()
    }

    /// The outcome in a line.
    pub fn headline(&self) -> String {
        let stations = self.completeness.headline().unwrap_or_else(|| {
            let solved = self.stations - self.failed.len();
            format!("{solved} of {} stations solved", self.stations)
        });
        format!("{}: {}, {stations}", self.study, self.topology)
    }
}

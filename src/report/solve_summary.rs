//! Summary of a solve.

use super::accuracy::{CertificateSummary, ConditionSummary};
use super::completeness::Completeness;
use super::figure::figure;
use super::ranges::Range;
use super::station_label::{StationLabel, place_in_words};
use super::table::{Cell, Column, Table};
use crate::axle::Axle;
use crate::curves::{Curves, Station, Status};
use crate::mechanism::Work;
use crate::model::{PointId, Side};
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// Content of `summary.json` of a solve.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SolveSummary {
    command: String,
    version: String,
    study: String,
    topology: String,
    /// For an axle: the parts of the right wheel that are not mirror images of the left wheel's parts. "mirrored" if there are
    /// none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    axle: Option<String>,
    stations: usize,
    /// Number of stations with a pose.
    #[serde(default)]
    solved: usize,
    /// Stations by status, and empty cells by reason.
    #[serde(default)]
    completeness: Completeness,
    /// Stations without a pose.
    failed: Vec<FailedStation>,
    /// Range of each column of the curves.
    outputs: Vec<Range>,
    /// Conditioning of the poses along the motion, if at least one pose exists.
    #[serde(default)]
    condition: Option<ConditionSummary>,
    /// Summary of the certificates of the poses, if the study requests certificates.
    #[serde(default)]
    certificate: Option<CertificateSummary>,
    /// Counts of the solver's effort, such as Newton iterations. `None` for an axle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    work: Option<Work>,
    /// Reasons why stations were solved by the solver for difficult stations (continuation) instead of the usual solver
    /// (tracker).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    left_to_continuation: Vec<Left>,
}

/// Number of stations that the solver for difficult stations (continuation) solved instead of the usual solver (tracker), with
/// the reason.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Left {
    reason: String,
    stations: usize,
}

/// A station without a pose.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct FailedStation {
    #[serde(default)]
    station: usize,
    /// Position of the station on the motion, in words.
    #[serde(default)]
    at: String,
    /// Coordinates of the station, for a study of one wheel.
    #[serde(flatten)]
    place: Option<StationLabel>,
    status: String,
    reason: String,
}

impl SolveSummary {
    /// Summarises the curves of a solve. `design` has the curves of the design position alone. Without `design`, the values in the
    /// design position come from the station there, if the motion has one.
    pub fn of(study: &Study, curves: &Curves, design: Option<&Curves>) -> Self {
        let wheel = study.wheel();
        let stations = curves.stations.iter().enumerate();
        let failed = stations.filter_map(|(number, s)| match s.status {
            Status::Failed(reason) => Some(FailedStation {
                station: number,
                at: place_in_words(curves, number),
                place: Some(StationLabel::of(curves, number)).filter(StationLabel::is_of_corner),
                status: s.status.word().to_owned(),
                reason: reason.describe(wheel.length_unit, wheel.frame),
            }),
            _ => None,
        });
        // The design position has no time derivatives, so columns are found by their names.
        let at_design = |column: usize| match design {
            Some(design) => {
                let name = &curves.columns[column].name;
                let found = design.columns.iter().position(|c| c.name == *name)?;
                design.stations.first()?.value(found)
            }
            None => {
                let station = curves.stations.iter().find(|s| is_design(curves, s));
                station?.value(column)
            }
        };
        SolveSummary {
            command: "solve".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: study.name.clone(),
            topology: wheel.mechanism.topology.name.to_owned(),
            axle: study.axle().map(|both| right_wheel(&both.axle)),
            stations: curves.stations.len(),
            solved: curves.stations.len() - curves.failed(),
            completeness: Completeness::of(curves),
            failed: failed.collect(),
            outputs: ranges(curves, at_design),
            condition: ConditionSummary::of(curves),
            certificate: CertificateSummary::of(curves),
            work: study.axle().is_none().then_some(curves.work),
            left_to_continuation: (curves.left_to_continuation.iter())
                .map(|(reason, stations)| Left {
                    reason: reason.describe().to_owned(),
                    stations: *stations,
                })
                .collect(),
        }
    }

    /// Table with the range of every output.
    pub fn table(&self) -> Table {
        Range::table(&self.outputs)
    }

    /// Table with the range of every output over a named motion. `curves` has the curves over this motion.
    pub fn table_of_motion(&self, curves: &Curves) -> Table {
        Range::table(&self.ranges_of_motion(curves))
    }

    /// Machine-readable table with the ranges over all named motions.
    pub fn motions_table<'c>(&self, motions: impl Iterator<Item = (&'c str, &'c Curves)>) -> Table {
        let ranges = motions.map(|(name, curves)| (name, self.ranges_of_motion(curves)));
        Range::table_of_motions(&ranges.collect::<Vec<_>>())
    }

    fn ranges_of_motion(&self, curves: &Curves) -> Vec<Range> {
        // A motion need not contain the design position. The values in the design position are the same in all motions.
        ranges(curves, |column| {
            let name = &curves.columns[column].name;
            self.outputs.iter().find_map(|own| own.at_design_of(name))
        })
    }

    /// Table of the values at the design position. `design` has only this station.
    pub fn design_table(design: &Curves) -> Table {
        let unit = Column::for_programs("unit");
        let columns = ["output", "at design"].map(Column::from);
        let mut table = Table::with_columns(columns.into_iter().chain([unit]));
        let values = design.stations.iter().take(1).flat_map(|s| &s.values);
        for (column, value) in design.columns.iter().zip(values) {
            let value = Cell::by(value.ok(), |v| figure(v, &column.unit));
            let name = Cell::from(column.name.as_str());
            table.push([name, value, column.unit.as_str().into()]);
        }
        table
    }

    /// Machine-readable table of the stations without a pose.
    pub fn failures_table(&self) -> Table {
        let mut columns = vec!["station", "at"];
        if self.axle.is_none() {
            columns.extend(["travel", "arm angle deg", "theta deg", "rack"]);
        }
        let mut table = Table::with_columns(columns.into_iter().chain(["status", "reason"]));
        for failed in &self.failed {
            let mut row = vec![Cell::from(failed.station), failed.at.as_str().into()];
            if self.axle.is_none() {
                let place = failed.place.as_ref().and_then(StationLabel::cells);
                row.extend(place.unwrap_or_else(|| [None::<f64>; 4].map(Cell::from)));
            }
            row.extend([failed.status.as_str().into(), failed.reason.as_str().into()]);
            table.push_row(row);
        }
        table
    }

    /// Machine-readable table with the number of stations for each status.
    pub fn stations_table(&self) -> Table {
        self.completeness.table()
    }

    /// Result of the solve in one line.
    pub fn headline(&self) -> String {
        let stations = self.completeness.headline().unwrap_or_else(|| {
            let solved = self.stations.saturating_sub(self.failed.len());
            format!("{solved} of {} stations solved", self.stations)
        });
        match &self.axle {
            // The topology name of a solid axle already contains the word "axle".
            Some(axle) if self.topology.ends_with("axle") => {
                format!("{}: {}, {axle}; {stations}", self.study, self.topology)
            }
            Some(axle) => format!("{}: {} axle, {axle}; {stations}", self.study, self.topology),
            None => format!("{}: {}, {stations}", self.study, self.topology),
        }
    }
}

/// Range of each column of curves. `at_design` returns the value of a column in the design position.
fn ranges(curves: &Curves, at_design: impl Fn(usize) -> Option<f64>) -> Vec<Range> {
    let ranges = curves.columns.iter().enumerate().map(|(k, column)| {
        let values = curves.stations.iter().filter_map(move |s| s.value(k));
        Range::of([&column.name, &column.unit], at_design(k), values)
    });
    ranges.collect()
}

/// True if all given coordinates are 0 at a station. False for a motion over time.
fn is_design(curves: &Curves, station: &Station) -> bool {
    let all = || curves.motion.iter().zip(&station.at);
    let is_zero = all().all(|(column, value)| !column.is_given || *value == Some(0.0));
    is_zero && all().all(|(column, _)| column.key != "time")
}

/// Parts in which the right wheel is not the mirror image of the left wheel, in words: `own hardpoints and spring on the right`.
/// `mirrored` if there are none.
fn right_wheel(axle: &Axle) -> String {
    let (left, right) = (&axle.left, axle.suspension(Side::Right));
    let springs = axle.setup.springs.as_ref();
    // A point that exists only once, such as an end of a Panhard rod, belongs to neither wheel.
    let mut points = left.design.iter().zip(&right.design).enumerate();
    let moved = points
        .any(|(id, (left, right))| left != right && !axle.left.mechanism.is_single(PointId(id)));
    let own = [
        ("hardpoints", moved),
        (
            "wheel",
            left.mechanism.spin_axis != right.mechanism.spin_axis,
        ),
        (
            "bodies",
            left.mechanism.from_other_wheel().points != right.mechanism.points,
        ),
        ("spring", springs.is_some_and(|[left, right]| left != right)),
    ];
    let own: Vec<_> = own
        .iter()
        .filter(|(_, own)| *own)
        .map(|(of, _)| *of)
        .collect();
    match own.as_slice() {
        [] => "mirrored".to_owned(),
        [one] => format!("own {one} on the right"),
        [most @ .., last] => format!("own {} and {last} on the right", most.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::SolveSummary;
    use serde_json::{from_value, json};

    /// A failed station without coordinates, as in an edited summary, has empty cells.
    #[test]
    fn a_failed_station_without_coordinates_has_empty_cells() {
        let failed = json!({ "at": "travel 5 mm", "status": "unreachable", "reason": "too far" });
        let summary: SolveSummary = from_value(json!({
            "command": "solve", "version": "", "study": "", "topology": "macpherson", "stations": 1,
            "failed": [failed], "outputs": []
        }))
        .unwrap();
        let csv = summary.failures_table().csv(None);
        assert!(
            csv.ends_with("\n0,travel 5 mm,,,,,unreachable,too far\n"),
            "{csv}"
        );
    }
}

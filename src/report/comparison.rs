//! Curves and points of several designs side by side, in the unit and axes of the first design.

mod kc;
mod moved;
mod points;
#[cfg(test)]
mod tests;

use super::column::{ColumnAxes, ColumnConversion, split_unit};
use super::common_motion::{CommonMotion, TIME};
use super::curve_table::CurveTable;
use super::files::csv_of_rows;
use super::record::{Record, readable_unit};
use super::table::{Cell, Column, Table};
use super::{counted, optional, resolution};
use crate::model::{FrameConvention, LengthUnit};
pub use kc::{ComparedKc, KcComparison};
use moved::{Moved, PartialPoints, moved, partial_points};
pub use points::{ComparedPoints, NamedPoints};
use serde::Serialize;

/// A design in a comparison.
#[derive(Clone, Debug)]
pub struct Compared {
    /// Label, unique for each design.
    pub label: String,
    /// Topology, if it is known.
    pub topology: Option<String>,
    /// Curves. Lengths are in `unit`.
    pub curves: CurveTable,
    /// Unit of the lengths in `curves` and `points`.
    pub unit: LengthUnit,
    /// Axes of the curves. `None` if they are not known, because the run has no stored study.
    pub axes: Option<FrameConvention>,
    /// Hardpoints, in `unit`.
    pub points: Option<ComparedPoints>,
    /// Mechanism along the motion, if the design comes from a study.
    pub mechanism: Option<Box<Record>>,
}

/// Comparison of several designs.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Labels of the designs.
    pub labels: Vec<String>,
    /// Topologies of the designs, each once.
    #[serde(skip)]
    pub topologies: Vec<String>,
    /// Columns of the motion, which together identify a station.
    pub motion: Vec<StationColumn>,
    /// Stations that all designs have, each with a value for every column of the motion.
    pub stations: Vec<Vec<f64>>,
    /// Curves that all designs have.
    pub outputs: Vec<ComparedOutput>,
    /// Stations of each design, with a value for every column of the motion.
    own_stations: Vec<Vec<Vec<f64>>>,
    /// All outputs at the stations of each design, including outputs that some designs do not have.
    own_outputs: Vec<OwnOutput>,
    /// Columns that some designs do not have, with the labels of the designs that have them.
    #[serde(skip)]
    pub partial: Vec<(String, Vec<String>)>,
    #[serde(skip)]
    unit: LengthUnit,
    #[serde(skip)]
    moved: Vec<Moved>,
    #[serde(skip)]
    partial_points: Vec<PartialPoints>,
    /// Mechanisms of all designs in one drawing, if they have the same points, axes and motion.
    #[serde(skip)]
    pub(super) mechanisms: Option<Record>,
}

/// A column of the motion.
#[derive(Clone, Debug, Serialize)]
pub struct StationColumn {
    /// Name of the column, in the first design's unit.
    pub column: String,
    /// True if the column has several values at the common stations.
    pub moves: bool,
}

/// An output that all designs have.
#[derive(Clone, Debug, Serialize)]
pub struct ComparedOutput {
    /// Name of the column, in the first design's unit.
    pub column: String,
    /// Readable name of the output.
    pub title: String,
    /// Readable unit of the output.
    pub unit: String,
    /// Values of each design at each station that all designs have. `None` if a value is missing.
    pub values: Vec<Vec<Option<f64>>>,
}

/// An output that some of the designs have.
#[derive(Clone, Debug, Serialize)]
struct OwnOutput {
    column: String,
    title: String,
    unit: String,
    /// Values of each design at its own stations. `None` instead of a list if the design does not have the column.
    values: Vec<Option<Vec<Option<f64>>>>,
}

/// Names of the topologies of the designs in their order, each once.
fn topologies(designs: &[Compared]) -> Vec<String> {
    let mut topologies: Vec<String> = Vec::new();
    for topology in designs.iter().filter_map(|design| design.topology.as_ref()) {
        if !topologies.contains(topology) {
            topologies.push(topology.clone());
        }
    }
    topologies
}

impl Comparison {
    /// Compares at least two designs.
    ///
    /// # Errors
    ///
    /// If the designs have no common station or no common column, or if different coordinates give their motions. Also if an axle
    /// is compared with a wheel, or if unknown axes determine the sign of a value.
    pub fn of(designs: &[Compared]) -> Result<Self, String> {
        let all: Vec<&Compared> = designs.iter().collect();
        let labels: Vec<&str> = designs.iter().map(|d| d.label.as_str()).collect();
        let (tables, motion) = side_by_side(&all)?;
        let rows = motion.common_rows(&tables);
        if rows.is_empty() {
            return Err(format!(
                "the results have no common value of {}: run their studies over the same motion",
                motion.columns.join(", ")
            ));
        }
        let mut outputs = Vec::new();
        let mut own_outputs = Vec::new();
        let mut partial: Vec<(String, Vec<String>)> = Vec::new();
        let mut names: Vec<&String> = Vec::new();
        for name in tables.iter().flat_map(|table| &table.header) {
            if motion.is_input(name) || names.contains(&name) {
                continue;
            }
            names.push(name);
            let (title, of) = split_unit(name);
            let (title, of) = (title.replace('_', " "), readable_unit(of));
            let own = tables.iter().map(|t| t.column(name).map(<[_]>::to_vec));
            own_outputs.push(OwnOutput {
                column: name.clone(),
                title: title.clone(),
                unit: of.clone(),
                values: own.collect(),
            });
            let having = tables.iter().zip(&labels);
            let having = having.filter(|(table, _)| table.column(name).is_some());
            let having: Vec<String> = having.map(|(_, label)| (*label).to_owned()).collect();
            if having.len() < designs.len() {
                partial.push((name.clone(), having));
                continue;
            }
            let values = tables.iter().enumerate().map(|(design, table)| {
                let column = table.column(name).expect("all designs have the column");
                rows.iter().map(|rows| column[rows[design]]).collect()
            });
            outputs.push(ComparedOutput {
                column: name.clone(),
                title,
                unit: of,
                values: values.collect(),
            });
        }
        if outputs.is_empty() {
            return Err("they have no common output".to_owned());
        }
        let own_stations: Vec<_> = tables.iter().map(|table| motion.places(table)).collect();
        let stations = rows.iter().map(|rows| own_stations[0][rows[0]].clone());
        let stations: Vec<_> = stations.collect();
        Ok(Comparison {
            labels: designs.iter().map(|design| design.label.clone()).collect(),
            topologies: topologies(designs),
            motion: motion.described(&stations),
            stations,
            outputs,
            own_stations,
            own_outputs,
            partial,
            unit: designs[0].unit,
            moved: moved(designs),
            partial_points: partial_points(designs),
            mechanisms: mechanisms(designs),
        })
    }

    /// True if the second design has every station of the first one.
    pub fn has_all_stations(first: &Compared, second: &Compared) -> bool {
        side_by_side(&[first, second])
            .is_ok_and(|(tables, motion)| motion.common_rows(&tables).len() == first.curves.rows())
    }

    /// Note on the stations that only some of the designs have. `None` if all designs have the same stations.
    pub fn missing_stations(&self) -> Option<String> {
        let common = self.stations.len();
        let all = self.labels.iter().zip(&self.own_stations);
        let others: Vec<String> = all
            .filter(|(_, own)| own.len() != common)
            .map(|(label, own)| format!("{label} has {}", own.len()))
            .collect();
        let common = counted(common, "common station");
        (!others.is_empty()).then(|| {
            format!(
                "Minima, maxima and differences cover only {common} ({}). For all stations, run the designs over \
                 the same motion.",
                others.join(", ")
            )
        })
    }

    /// Note on the stations at which some designs lack values, by the statuses of the stations. `None` if every station has all
    /// its defined values.
    pub fn unsolved_stations(&self, designs: &[Compared]) -> Option<String> {
        let lacking = designs.iter().filter_map(|design| {
            let (rows, lacking) = (design.curves.rows(), design.curves.incomplete_rows());
            (lacking > 0).then(|| format!("{} {lacking} of {rows}", design.label))
        });
        let lacking: Vec<String> = lacking.collect();
        (!lacking.is_empty()).then(|| {
            format!(
                "Stations without all values: {}. Minima, maxima and differences cover the other stations.",
                lacking.join(", ")
            )
        })
    }

    /// Indices of the moving columns of the motion, at least one. The first one is the horizontal axis of curves.
    fn moving(&self) -> Vec<usize> {
        let mut moving: Vec<usize> = (0..self.motion.len()).collect();
        moving.retain(|k| self.motion[*k].moves);
        if moving.is_empty() {
            moving.push(0);
        }
        moving
    }

    /// Names of the moving columns of the motion, at least one.
    pub(super) fn moving_columns(&self) -> Vec<String> {
        let moves = |k: &usize| {
            let mut all = self.own_stations.iter();
            all.any(|stations| stations.iter().any(|at| at[*k] != stations[0][*k]))
        };
        let mut moving: Vec<usize> = (0..self.motion.len()).filter(moves).collect();
        // Columns that vary at the common stations come first.
        moving.sort_by_key(|k| !self.motion[*k].moves);
        if moving.is_empty() {
            moving.push(0);
        }
        moving
            .into_iter()
            .map(|k| self.motion[k].column.clone())
            .collect()
    }

    /// Title, column and readable unit of every output, including outputs that some designs do not have.
    pub(super) fn compared_columns(&self) -> impl Iterator<Item = (&str, &str, &str)> {
        let outputs = self.own_outputs.iter();
        outputs.map(|o| (o.title.as_str(), o.column.as_str(), o.unit.as_str()))
    }

    /// Tables of all designs at their own stations, then tables of their differences from the first design at the common
    /// stations.
    pub(super) fn tables(&self) -> Vec<CurveTable> {
        let motion = |stations: &[Vec<f64>]| -> (Vec<String>, Vec<Vec<Option<f64>>>) {
            let column = |k: usize| {
                stations
                    .iter()
                    .map(move |at| Some(at[k]).filter(|v| v.is_finite()))
            };
            let names = self.motion.iter().map(|m| m.column.clone());
            (
                names.collect(),
                (0..self.motion.len())
                    .map(|k| column(k).collect())
                    .collect(),
            )
        };
        let table = |(mut header, mut columns): (Vec<String>, Vec<_>),
                     outputs: Vec<(String, _)>| {
            for (name, values) in outputs {
                header.push(name);
                columns.push(values);
            }
            CurveTable {
                header,
                columns,
                status: Vec::new(),
            }
        };
        let own = (0..self.labels.len()).map(|design| {
            let outputs = self.own_outputs.iter();
            let outputs =
                outputs.filter_map(|o| Some((o.column.clone(), o.values[design].clone()?)));
            table(motion(&self.own_stations[design]), outputs.collect())
        });
        let differences = (0..self.labels.len()).map(|design| {
            let outputs = self.outputs.iter().map(|o| {
                let pairs = o.values[design].iter().zip(&o.values[0]);
                let values = pairs.map(|(value, first)| Some((*value)? - (*first)?));
                (o.column.clone(), values.collect::<Vec<_>>())
            });
            table(motion(&self.stations), outputs.collect())
        });
        own.chain(differences).collect()
    }

    /// Table with one row for each output and design: value in the design position, minimum, maximum, and largest difference
    /// from the first design.
    pub fn table(&self) -> Table {
        let moving = self.moving();
        let header = [
            "output",
            "of",
            "at design",
            "min",
            "max",
            "largest difference",
        ];
        // The columns that vary are enough to give the position.
        let mut places = moving
            .iter()
            .map(|k| format!("at {}", self.motion[*k].column));
        let first = places.next().map(|title| Column::named(title, "at"));
        let header = header.into_iter().map(Column::from).chain(first);
        let mut table = Table::with_columns(header.chain(places.map(Column::from)));
        // A motion over time has no design position.
        let mut columns = self.own_outputs.iter().map(|output| &output.column);
        let is_over_time =
            self.motion.iter().any(|m| m.column == TIME) || columns.any(|c| c == TIME);
        let is_design = |at: &Vec<f64>| !is_over_time && at.iter().all(|v| *v == 0.0);
        let design_row = self.stations.iter().position(is_design);
        for output in &self.outputs {
            for (design, values) in output.values.iter().enumerate() {
                let known = || values.iter().flatten().copied();
                let least = known().reduce(f64::min);
                let most = known().reduce(f64::max);
                let at_design = design_row.and_then(|row| values[row]);
                let (_, unit) = split_unit(&output.column);
                let figure = |value: Option<f64>| value.map(|value| Cell::figure(value, unit));
                let largest = self.largest_difference(output, design);
                let place = largest.filter(|(difference, _)| difference.abs() >= resolution(unit));
                let head = [
                    match design {
                        0 => Cell::from(output.column.as_str()),
                        _ => Cell::repeated(&output.column),
                    },
                    Cell::from(self.labels[design].as_str()),
                    figure(at_design).into(),
                    figure(least).into(),
                    figure(most).into(),
                    figure(largest.map(|(difference, _)| difference)).into(),
                ];
                let places = moving.iter().map(|k| {
                    let at = place.map(|(_, row)| Cell::from(self.stations[row][*k]));
                    Cell::from(at)
                });
                table.push_row(head.into_iter().chain(places));
            }
        }
        table.keyed(2)
    }

    /// Largest difference from the first design, and its row.
    fn largest_difference(&self, output: &ComparedOutput, design: usize) -> Option<(f64, usize)> {
        if design == 0 {
            return None;
        }
        let pairs = output.values[0]
            .iter()
            .zip(&output.values[design])
            .enumerate();
        let differences = pairs.filter_map(|(row, (a, b))| Some(((*b)? - (*a)?, row)));
        differences.reduce(|most, next| {
            if next.0.abs() > most.0.abs() {
                next
            } else {
                most
            }
        })
    }

    /// Content of `comparison.csv`: one row per station. Each output has a column for each design, and a column for each
    /// difference from the first design.
    pub fn csv(&self) -> Vec<u8> {
        let motion = self.motion.iter();
        let mut header: Vec<String> = motion.map(|m| m.column.clone()).collect();
        for output in &self.outputs {
            for label in &self.labels {
                header.push(format!("{} [{label}]", output.column));
            }
            for label in &self.labels[1..] {
                header.push(format!("{} [{label} - {}]", output.column, self.labels[0]));
            }
        }
        let stations = self.stations.iter().enumerate();
        let rows = stations.map(|(row, at)| {
            let mut record: Vec<String> = at.iter().map(|v| super::shortest(*v)).collect();
            for output in &self.outputs {
                let value = |design: usize| output.values[design][row];
                let designs = 0..self.labels.len();
                record.extend(designs.clone().map(|design| optional(value(design))));
                let difference = |design: usize| Some(value(design)? - value(0)?);
                record.extend(designs.skip(1).map(|design| optional(difference(design))));
            }
            record
        });
        csv_of_rows([header].into_iter().chain(rows))
    }
}

/// Curves of all designs in the unit and axes of the first one, and the columns of their motion.
fn side_by_side(designs: &[&Compared]) -> Result<(Vec<CurveTable>, CommonMotion), String> {
    let first = designs[0];
    let tables: Result<Vec<CurveTable>, String> = designs
        .iter()
        .map(|design| like_first(design, first))
        .collect();
    let tables = tables?;
    let labels: Vec<&str> = designs.iter().map(|d| d.label.as_str()).collect();
    let motion = CommonMotion::of(&tables, &labels, first.unit)?;
    Ok((tables, motion))
}

/// Curves of the design `design`, converted to the unit and axes of the design `first`.
fn like_first(design: &Compared, first: &Compared) -> Result<CurveTable, String> {
    let mut table = design.curves.clone();
    let depends_on_axes = |(name, values): (&String, &Vec<Option<f64>>)| {
        let is_zero = values.iter().flatten().all(|value| *value == 0.0);
        (!is_zero && ColumnAxes::of(split_unit(name).0).matter()).then(|| name.clone())
    };
    let mut columns = table.header.iter().zip(&table.columns);
    let axes = match design.axes {
        Some(own) => [own, first.axes.unwrap_or(own)],
        None => match columns.find_map(depends_on_axes) {
            Some(column) => return Err(unknown_axes(&design.label, &column)),
            None => [FrameConvention::Iso8855; 2],
        },
    };
    let conversion = ColumnConversion {
        from: design.unit,
        to: first.unit,
        axes,
    };
    for (name, values) in table.header.iter_mut().zip(&mut table.columns) {
        let column = conversion.column(name);
        for value in values.iter_mut().flatten() {
            *value = column.value(*value);
        }
        *name = column.name_in(&first.curves.header);
    }
    Ok(table)
}

/// Error message for a run whose axes are not known, although the sign of a column depends on them.
fn unknown_axes(label: &str, name: &str) -> String {
    format!(
        "{label}: the sign of {name} depends on the axes, but the run has no study.toml that states \
         them; run its study again"
    )
}

/// Record with the drawings of all designs. `None` unless all designs have the same points, unit, axes and motion.
fn mechanisms(designs: &[Compared]) -> Option<Record> {
    let records: Option<Vec<&Record>> = designs.iter().map(|d| d.mechanism.as_deref()).collect();
    let records = records?;
    let (first, others) = records.split_first()?;
    let places = |record: &Record| -> Vec<[f64; 2]> {
        let frames = record.motion.designs.iter().flat_map(|d| &d.frames);
        frames.map(|frame| [frame.drive, frame.rack]).collect()
    };
    let is_like_first = |record: &&&Record| {
        record.scene.points == first.scene.points
            && record.scene.signs == first.scene.signs
            && record.length_unit == first.length_unit
            && record.motion.drive == first.motion.drive
            && places(record) == places(first)
    };
    if others.iter().filter(is_like_first).count() < others.len() {
        return None;
    }
    let designs = records
        .iter()
        .flat_map(|record| record.motion.designs.iter().cloned());
    let mut record = (*first).clone();
    (record.influences, record.front) = (Vec::new(), None);
    record.motion.designs = designs.collect();
    Some(record)
}

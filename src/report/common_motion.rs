//! Finds the stations that several tables of curves have in common.

use super::comparison::StationColumn;
use super::curve_table::CurveTable;
use crate::model::LengthUnit;

/// Largest difference between equal stations, relative to the largest absolute value in the first table's column.
const SAME: f64 = 1e-9;

/// Name of the column with the time.
pub(super) const TIME: &str = "time_s";

/// Columns of angles that can drive a wheel.
const ANGLES: [&str; 2] = ["arm_angle_deg", "theta_deg"];

/// Name of the column that identifies the stations of a wheel, together with the rack. It is the time, the angle that drives the
/// wheel, or the travel.
fn drive(table: &CurveTable) -> &str {
    let mut given = [TIME].iter().chain(&ANGLES);
    let given = given.find(|name| table.column(name).is_some()).copied();
    given.unwrap_or_else(|| table.header.first().map_or("", String::as_str))
}

/// Returns true if all tables are of axles, and false if all are of wheels. Only tables of axles have the column `travel_left`.
fn are_of_axles(tables: &[CurveTable], labels: &[&str], travel_left: &str) -> Result<bool, String> {
    let is_of_axle = |table: &CurveTable| table.column(travel_left).is_some();
    let is_axle = is_of_axle(&tables[0]);
    let Some(other) = tables.iter().position(|t| is_of_axle(t) != is_axle) else {
        return Ok(is_axle);
    };
    let (axle, wheel) = if is_axle {
        (labels[0], labels[other])
    } else {
        (labels[other], labels[0])
    };
    Err(format!(
        "{axle} has curves of both wheels of an axle, {wheel} of one wheel: compare axles with axles, or \
         remove [axle]"
    ))
}

/// Name of the column that identifies the stations in the tables of all wheels. An error if the tables of two wheels have different
/// columns of this kind.
fn common_drive<'t>(tables: &'t [CurveTable], labels: &[&str]) -> Result<&'t str, String> {
    let own = drive(&tables[0]);
    match tables.iter().position(|table| drive(table) != own) {
        None => Ok(own),
        Some(other) => Err(format!(
            "the curves of {} are over {own}, those of {} over {}: run them over the same motion",
            labels[0],
            labels[other],
            drive(&tables[other])
        )),
    }
}

/// Columns of the motion that several tables share. Together they give the position of a station.
pub(super) struct CommonMotion {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Names of the columns that identify a station: `columns`, and the time of axles.
    matched: Vec<String>,
    /// Names of further columns that describe the motion, such as the wheel travels if heave is given. They are not compared as
    /// outputs.
    repeated: Vec<String>,
}

impl CommonMotion {
    /// Finds the columns of the motion from the headers of tables in one unit. The curves of a wheel are over time, an angle or
    /// the travel, and over the rack. The curves of an axle are over roll and heave, or over both travels; and over the steering
    /// wheel or the rack. All columns that follow from these are outputs.
    ///
    /// # Errors
    ///
    /// If curves of a wheel are compared with curves of an axle, or if different columns give two motions.
    pub(super) fn of(
        tables: &[CurveTable],
        labels: &[&str],
        unit: LengthUnit,
    ) -> Result<CommonMotion, String> {
        let in_unit = |name: &str| format!("{name}_{}", unit.symbol());
        let has = |table: &CurveTable, name: &str| table.column(name).is_some();
        let left = in_unit("travel_left");
        let is_axle = are_of_axles(tables, labels, &left)?;
        let rack = in_unit("rack");
        let any = |name: &str| tables.iter().any(|table| has(table, name));
        let heave = in_unit("heave");
        let mut required = Vec::new();
        let mut columns = Vec::new();
        let mut repeated = Vec::new();
        if !is_axle {
            required.push(common_drive(tables, labels)?.to_owned());
            let names = ["travel", "arm_angle", "theta", "rack", "roll", "heave"];
            repeated.extend(names.map(in_unit));
            repeated.extend(names.map(|name| format!("{name}_deg")));
            repeated.push(TIME.to_owned());
            // If an angle drives the wheel, the travel is a result.
            if ANGLES.iter().any(|angle| has(&tables[0], angle)) {
                repeated.retain(|name| *name != in_unit("travel"));
            }
        } else if has(&tables[0], &heave) {
            columns.extend(any("roll_deg").then(|| "roll_deg".to_owned()));
            required.push(heave);
            if columns.is_empty() {
                repeated.extend([left, in_unit("travel_right")]);
            }
        } else {
            required.extend([left, in_unit("travel_right")]);
            // If heave is a coordinate of the motion, the wheel travels are outputs.
            if let Some(other) = tables.iter().position(|t| has(t, &heave)) {
                return Err(format!(
                    "the motion of {} is given by {heave}, that of {} by {}: run them over the same motion",
                    labels[other],
                    labels[0],
                    required.join(" and ")
                ));
            }
        }
        for name in &required {
            if let Some(other) = tables.iter().position(|table| !has(table, name)) {
                let label = labels[other];
                return Err(format!(
                    "{label} has no column {name}: run them over the same motion"
                ));
            }
        }
        columns.append(&mut required);
        let angle = "steering_wheel_angle_deg";
        let by_angle = |table: &CurveTable| has(table, angle) || !has(table, &rack);
        if is_axle && any(angle) && tables.iter().all(by_angle) {
            columns.push(angle.to_owned());
        } else if any(&rack) {
            columns.push(rack);
        }
        let mut matched = columns.clone();
        // An axle may pass a position twice, in opposite directions. The time tells these stations apart.
        if is_axle && tables.iter().all(|table| has(table, TIME)) {
            matched.push(TIME.to_owned());
        }
        Ok(CommonMotion {
            columns,
            matched,
            repeated,
        })
    }

    /// True if a column gives the position of a station. Then it is not an output.
    pub(super) fn is_input(&self, column: &str) -> bool {
        let mut inputs = self.columns.iter().chain(&self.repeated);
        inputs.any(|name| name == column)
    }

    /// Station of each row, as a value for each column of the motion. A coordinate that a motion does not have is 0: no roll, or
    /// the rack in the middle. An empty cell is NaN, so its row equals no station.
    pub(super) fn places(&self, table: &CurveTable) -> Vec<Vec<f64>> {
        places(table, &self.columns)
    }

    /// Rows of the stations that all tables have, in the order of the first table. For each station, the result has one row index
    /// per table.
    pub(super) fn common_rows(&self, tables: &[CurveTable]) -> Vec<Vec<usize>> {
        let places: Vec<_> = tables.iter().map(|t| places(t, &self.matched)).collect();
        let size = |k: usize| {
            let values = places[0].iter().map(|at| at[k].abs());
            values.fold(0.0, f64::max)
        };
        let sizes: Vec<f64> = (0..self.matched.len()).map(size).collect();
        let is_same = |a: &[f64], b: &[f64]| {
            let mut pairs = a.iter().zip(b).zip(&sizes);
            pairs.all(|((a, b), size)| (a - b).abs() <= SAME * size)
        };
        let find = |design: usize, row: usize| {
            let (own, at) = (&places[design], &places[0][row]);
            // Tables of the same motion have the same rows, so the row with this index is tried first.
            match own.get(row) {
                Some(place) if is_same(at, place) => Some(row),
                _ => own.iter().position(|place| is_same(at, place)),
            }
        };
        let rows = 0..tables[0].rows();
        let rows = rows.map(|row| -> Option<Vec<usize>> {
            let designs = 0..tables.len();
            designs.map(|design| find(design, row)).collect()
        });
        rows.flatten().collect()
    }

    /// Columns of the motion in the form for the page.
    pub(super) fn described(&self, stations: &[Vec<f64>]) -> Vec<StationColumn> {
        let columns = self.columns.iter().enumerate();
        let described = columns.map(|(k, column)| StationColumn {
            column: column.clone(),
            moves: stations.iter().any(|at| at[k] != stations[0][k]),
        });
        described.collect()
    }
}

/// Values of the columns with these names, row by row. The value is 0 if the table lacks the column, and NaN for an empty cell.
fn places(table: &CurveTable, names: &[String]) -> Vec<Vec<f64>> {
    let columns: Vec<_> = names.iter().map(|name| table.column(name)).collect();
    let value = |row: usize, column: &Option<&[Option<f64>]>| match column {
        Some(column) => column[row].unwrap_or(f64::NAN),
        None => 0.0,
    };
    let place = |row| columns.iter().map(|column| value(row, column)).collect();
    (0..table.rows()).map(place).collect()
}

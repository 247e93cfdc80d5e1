//! Designs in CSV files.
//!
//! The first line names the columns. A column `tie_rod_inner_z` has coordinates, and a column `tie_rod_inner_dz` has offsets
//! from the design. Coordinates and offsets are in the study's axes and unit. A name may end with the unit
//! (`tie_rod_inner_z_mm`). A column `design` is not read, because designs are numbered by their rows, starting with 0.
//!
//! A file can also be a result of a sweep, such as `pareto.csv`. Its last column is `status`. Its columns with results are not
//! read. If a variable of the sweep moves several hardpoints, `sweep.json` in the file's directory names these hardpoints.

use super::curve_file::at_record;
use super::error::{Source, StudyError, StudyErrors};
use super::names::nearest;
use super::outputs::hardpoints;
use super::source::{LONGEST_TABLE, read_text};
use super::sweep::column_stem;
use super::value::Number;
use super::{Move, Study, SweepVariable};
use crate::model::{Axis, Suspension};
use serde::Deserialize;
use std::path::Path;
use std::sync::Arc;

/// Designs from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignTable {
    /// Variables of the columns. The range of each variable is the range of its values.
    pub variables: Vec<SweepVariable>,
    /// Values of the variables: one row for each design, with one number for each variable.
    values: Vec<f64>,
    /// SHA-256 digest of the file and of the moves that are not in it. Without a file: digest of the moves and the values.
    pub digest: [u8; 32],
    /// True if the file has a column `design` with numbers other than 0, 1, 2 and so on.
    pub has_other_numbers: bool,
    /// Number of columns with results of a sweep, which are not read.
    pub results: usize,
}

impl DesignTable {
    /// Reads designs of a suspension.
    pub fn read(path: &Path, suspension: &Suspension) -> Result<Self, StudyErrors> {
        let name = path.display().to_string();
        let text = read_text(path, LONGEST_TABLE)
            .map_err(|reason| StudyError::of_file(&name, format!("cannot be read: {reason}")))?;
        Self::from_text(&name, text, &own_variables(path), suspension)
    }

    /// Reads the designs of a study's sweep. If the file cannot be read, the error points to the place in the study that
    /// names the file.
    pub(crate) fn of_study(path: &Path, study: &Study) -> Result<Self, StudyErrors> {
        let name = path.display().to_string();
        let text = read_text(path, LONGEST_TABLE).map_err(|reason| {
            let place = match study.line_of(&["sweep", "designs"]) {
                Some(line) => format!("{}, line {line}: sweep.designs", study.name),
                None => format!("{}: sweep.designs", study.name),
            };
            let message =
                format!("cannot read {name}: {reason} (the path is relative to the study file)");
            StudyError::of_file(place, message)
        })?;
        Self::from_text(&name, text, &own_variables(path), study.wheel())
    }

    /// Reads the designs from a file's text. `own` has the variables of the sweep in the file's directory, if there is one.
    fn from_text(
        name: &str,
        text: String,
        own: &[OwnVariable],
        suspension: &Suspension,
    ) -> Result<Self, StudyErrors> {
        let mut hash = hmac_sha256::Hash::new();
        hash.update(text.as_bytes());
        let name = name.to_owned();
        let source = Arc::new(Source { name, text });
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(source.text.as_bytes());
        let mut records = reader.into_records();
        let text_error = |e: csv::Error| StudyError::of_file(&source.name, e.to_string());
        let header = match records.next() {
            None => return Err(StudyError::of_file(&source.name, "the file is empty").into()),
            Some(header) => header.map_err(text_error)?,
        };
        let at = |record: &_, message: String| at_record(&source, record, message);
        let columns = columns(&header, own, suspension);
        let (mut variables, places) = columns.map_err(|message| at(&header, message))?;
        for variable in variables.iter().filter(|own| own.moves.len() > 1) {
            hash.update(format!("{:?}", variable.moves));
        }
        let mut values = Vec::new();
        let numbers = header.iter().position(|column| column == "design");
        let results = header.len() - variables.len() - usize::from(numbers.is_some());
        let mut has_other_numbers = false;
        for (row, record) in records.enumerate() {
            let record = record.map_err(text_error)?;
            if record.len() != header.len() {
                let message = format!("expected {} values, found {}", header.len(), record.len());
                return Err(at(&record, message));
            }
            has_other_numbers |= numbers.is_some_and(|place| record[place] != *row.to_string());
            for (variable, place) in variables.iter_mut().zip(&places) {
                let cell = &record[*place];
                let value = Number::parsed(cell).map_err(|wanted| {
                    let column = &header[*place];
                    at(
                        &record,
                        format!("expected {wanted} as {column}, found {cell:?}"),
                    )
                })?;
                let [low, high] = &mut variable.range;
                (*low, *high) = (low.min(value), high.max(value));
                values.push(value);
            }
        }
        if values.is_empty() {
            let message = "the file has no designs: expected a row for each design";
            return Err(StudyError::of_file(&source.name, message).into());
        }
        Ok(DesignTable {
            variables,
            values,
            digest: hash.finalize(),
            has_other_numbers,
            results,
        })
    }

    /// Makes a table of designs from rows of values, with one number for each variable. The range of each variable becomes
    /// the range of its values.
    ///
    /// # Errors
    /// Returns the reason, in words, if the values do not form a table of designs.
    pub fn of(mut variables: Vec<SweepVariable>, values: Vec<f64>) -> Result<Self, String> {
        if variables.is_empty() {
            return Err("expected at least one variable, found none".to_owned());
        }
        for (place, variable) in variables.iter().enumerate() {
            if let Some(other) = variables[..place]
                .iter()
                .find(|own| own.changes_same(variable))
            {
                let what = match variable.rate {
                    Some(_) => "rate",
                    None => "coordinate",
                };
                let names = [&variable.name, &other.name];
                return Err(format!(
                    "{} and {} give the same {what}",
                    names[0], names[1]
                ));
            }
        }
        let width = variables.len();
        if values.is_empty() || !values.len().is_multiple_of(width) {
            let found = values.len();
            return Err(format!(
                "expected rows of {width} values, found {found} values"
            ));
        }
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            let (row, name) = (place / width, &variables[place % width].name);
            let value = values[place];
            return Err(format!(
                "row {row} has {value} for {name}; expected a finite number"
            ));
        }
        for (k, variable) in variables.iter_mut().enumerate() {
            let column = || values.iter().skip(k).step_by(width).copied();
            variable.range = [
                column().fold(f64::INFINITY, f64::min),
                column().fold(f64::NEG_INFINITY, f64::max),
            ];
        }
        let mut hash = hmac_sha256::Hash::new();
        for variable in &variables {
            hash.update(format!("{:?} {:?}", variable.moves, variable.absolute));
            if let Some(rate) = &variable.rate {
                hash.update(format!(" {rate:?}"));
            }
        }
        for value in &values {
            hash.update(value.to_le_bytes());
        }
        Ok(DesignTable {
            variables,
            values,
            digest: hash.finalize(),
            has_other_numbers: false,
            results: 0,
        })
    }

    /// Number of designs.
    pub fn designs(&self) -> u64 {
        (self.values.len() / self.variables.len()) as u64
    }

    /// Values of a design, one for each variable.
    pub fn row(&self, design: u64) -> &[f64] {
        let width = self.variables.len();
        &self.values[design as usize * width..][..width]
    }
}

/// Returns true for the name of a column with results of a sweep, for example `camber_min_deg`.
fn is_result(column: &str) -> bool {
    let is_kind = |word: &str| ["min", "max", "design", "gain"].contains(&word);
    let is_of_row = ["misfit", "reason", "status"].contains(&column);
    is_of_row
        || ["rms_", "margin_", "failed_"]
            .iter()
            .any(|start| column.starts_with(start))
        || column.split('_').skip(1).any(is_kind)
}

/// Variable of the sweep that wrote the file, from `sweep.json`.
#[derive(Deserialize)]
struct OwnVariable {
    /// Name of the variable's column.
    column: String,
    /// Coordinates that the variable moves. Empty for a rate.
    moves: Vec<OwnMove>,
}

/// Coordinate that a variable of the sweep moves.
#[derive(Deserialize)]
struct OwnMove {
    hardpoint: String,
    axis: String,
    factor: f64,
}

/// Reads the variables of the sweep from `sweep.json` in the directory of a file. Empty if there is no such sweep.
fn own_variables(file: &Path) -> Vec<OwnVariable> {
    #[derive(Deserialize)]
    struct OwnSweep {
        variables: Vec<OwnVariable>,
    }
    let text = read_text(&file.with_file_name("sweep.json"), LONGEST_TABLE).ok();
    let sweep = text.and_then(|text| serde_json::from_str::<OwnSweep>(&text).ok());
    sweep.map_or_else(Vec::new, |sweep| sweep.variables)
}

impl OwnVariable {
    /// Variable with offsets of several hardpoints. `stem` is its column without unit, and `unit` is the study's length unit.
    /// A name alone does not tell offsets from coordinates, so a variable of one hardpoint is an error.
    fn offsets(
        &self,
        stem: &str,
        unit: &str,
        suspension: &Suspension,
    ) -> Result<SweepVariable, String> {
        let column = &self.column;
        let moves = match &self.moves[..] {
            [] => {
                return Err(format!(
                    "{column} has rates of an elastic part; a file of designs can only move hardpoints"
                ));
            }
            [
                OwnMove {
                    hardpoint, axis, ..
                },
            ] => {
                return Err(format!(
                    "{column} has the name that its sweep gave to a variable; expected {hardpoint}_d{axis}_{unit} for \
                     offsets, or {hardpoint}_{axis}_{unit} for coordinates"
                ));
            }
            moves => moves.iter(),
        };
        let moves = moves.map(|own| {
            let point = hardpoints(suspension).find(|(name, _)| *name == own.hardpoint);
            let axis = Axis::ALL.into_iter().find(|axis| axis.name() == own.axis);
            let (Some((_, point)), Some(axis)) = (point, axis) else {
                return Err(format!(
                    "{column} moves {}.{}, which this study does not have",
                    own.hardpoint, own.axis
                ));
            };
            Ok(Move {
                point,
                axis,
                factor: own.factor,
            })
        });
        Ok(SweepVariable {
            name: stem.to_owned(),
            moves: moves.collect::<Result<_, _>>()?,
            rate: None,
            absolute: false,
            range: [f64::INFINITY, f64::NEG_INFINITY],
            steps: None,
        })
    }
}

/// Variables of the file's columns, and the index of the column of each variable. `own` has the variables of the sweep in
/// the file's directory, if there is one.
fn columns(
    header: &csv::StringRecord,
    own: &[OwnVariable],
    suspension: &Suspension,
) -> Result<(Vec<SweepVariable>, Vec<usize>), String> {
    let mut variables: Vec<SweepVariable> = Vec::new();
    let mut places = Vec::new();
    let is_of_sweep = header.iter().next_back() == Some("status");
    let own = if is_of_sweep { own } else { &[] };
    let is_own = |column: &str| own.iter().any(|own| own.column == column);
    let is_result = |column: &str| is_of_sweep && is_result(column) && !is_own(column);
    let is_read = |column: &str| column != "design" && !is_result(column);
    for (place, column) in header.iter().enumerate().filter(|(_, c)| is_read(c)) {
        let variable = variable(column, own, suspension)?;
        if let Some(other) = variables.iter().find(|own| own.changes_same(&variable)) {
            return Err(if other.name == variable.name {
                format!("the column {column} occurs twice")
            } else {
                format!("{column} and {} give the same coordinate", other.name)
            });
        }
        variables.push(variable);
        places.push(place);
    }
    if variables.is_empty() {
        return Err("expected columns like tie_rod_inner_z, found none".to_owned());
    }
    Ok((variables, places))
}

/// Variable of a column, by the column's name. `own` has the variables of the sweep that wrote the file, if there is one.
fn variable(
    column: &str,
    own: &[OwnVariable],
    suspension: &Suspension,
) -> Result<SweepVariable, String> {
    let unit = suspension.length_unit.symbol();
    let stem = column.strip_suffix(&format!("_{unit}")).unwrap_or(column);
    let mut known = Vec::new();
    for (point, id) in hardpoints(suspension) {
        for axis in Axis::ALL {
            for absolute in [true, false] {
                let name = column_stem(point, axis, absolute);
                if name == stem {
                    return Ok(SweepVariable {
                        name,
                        moves: vec![Move {
                            point: id,
                            axis,
                            factor: 1.0,
                        }],
                        rate: None,
                        absolute,
                        range: [f64::INFINITY, f64::NEG_INFINITY],
                        steps: None,
                    });
                }
                known.push(name);
            }
        }
    }
    let is_in_unit = stem != column;
    let mut own = own.iter().filter(|own| own.column == column);
    if let Some(own) = own.next().filter(|own| is_in_unit || own.moves.is_empty()) {
        return own.offsets(stem, unit, suspension);
    }
    let meant = match nearest(stem, known.iter().map(String::as_str)) {
        Some(near) => format!("; did you mean {near}?"),
        None => String::new(),
    };
    Err(format!(
        "unknown column {column:?}; expected hardpoint and axis, like tie_rod_inner_z for coordinates \
         or tie_rod_inner_dz for offsets, in {unit}{meant}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    fn table(text: &str) -> Result<DesignTable, String> {
        table_of_sweep(text, &[])
    }

    fn table_of_sweep(text: &str, own: &[OwnVariable]) -> Result<DesignTable, String> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../studies/macpherson_solve.toml");
        let study = Study::read(&path, &[]).unwrap();
        let read = DesignTable::from_text("designs.csv", text.to_owned(), own, study.wheel());
        read.map_err(|e| e.to_string())
    }

    #[test]
    fn coordinates_and_offsets_are_told_apart_by_their_columns() {
        let text =
            "design, tie_rod_inner_z, strut_top_dy_mm\n7, 240, -1.5\n\n# better\n8, 241, 2\n";
        let table = table(text).unwrap();
        let absolute: Vec<bool> = table.variables.iter().map(|v| v.absolute).collect();
        assert_eq!(absolute, [true, false]);
        assert_eq!(table.variables[1].range, [-1.5, 2.0]);
        assert_eq!((table.designs(), table.row(1)), (2, &[241.0, 2.0][..]));
        assert!(table.has_other_numbers);
    }

    /// Results of a sweep can be designs of another sweep. A column with an unknown name remains an error.
    #[test]
    fn results_of_a_sweep_are_designs() {
        let text = "design,tie_rod_inner_dz_mm,camber_min_deg,bump_steer_gain_deg_per_mm2,rms_toe,misfit,\
                    margin_length_tie_rod_kept_mm,failed_stations,failed_at_mm,reason,status\n\
                    7,2.5,-1,0,1,1,0,0,,,ok\n";
        let table = table(text).unwrap();
        assert_eq!((table.row(0), table.results), (&[2.5][..], 9));
        let unknown = text.replace("tie_rod_inner_dz_mm", "rack_height_mm");
        assert!(
            self::table(&unknown)
                .unwrap_err()
                .contains("rack_height_mm")
        );
        let without_status = "tie_rod_inner_dz_mm,misfit\n1,2\n";
        assert!(self::table(without_status).unwrap_err().contains("misfit"));
    }

    /// A variable of the sweep that moves several hardpoints keeps its name and its moves. A name of one hardpoint is an
    /// error, because it does not tell offsets from coordinates.
    #[test]
    fn variables_of_several_hardpoints_come_from_the_sweep() {
        let own = |points: &str| -> Vec<OwnVariable> {
            let text = format!("[{{\"column\":\"arm_height_mm\",\"low\":0,\"moves\":[{points}]}}]");
            serde_json::from_str(&text).unwrap()
        };
        let point = |name: &str, factor: f64| {
            format!("{{\"hardpoint\":\"{name}\",\"axis\":\"z\",\"factor\":{factor}}}")
        };
        let [front, rear] = [point("lower_arm_front", 1.0), point("lower_arm_rear", -0.5)];
        let text = "design,arm_height_mm,misfit,reason,status\n3,2.5,1,,ok\n";
        let table = table_of_sweep(text, &own(&format!("{front},{rear}"))).unwrap();
        let [variable] = &table.variables[..] else {
            panic!("one variable")
        };
        let factors: Vec<f64> = variable.moves.iter().map(|m| m.factor).collect();
        assert_eq!(
            (variable.name.as_str(), &factors[..]),
            ("arm_height", &[1.0, -0.5][..])
        );
        assert!(!variable.absolute && table.row(0) == [2.5]);
        let other = table_of_sweep(text, &own(&format!("{rear},{front}"))).unwrap();
        assert_ne!(table.digest, other.digest);

        for (points, phrase) in [
            (front, "expected lower_arm_front_dz_mm for offsets"),
            (format!("{rear},{}", point("none", 1.0)), "none.z"),
            (String::new(), "rates of an elastic part"),
        ] {
            let said = table_of_sweep(text, &own(&points)).unwrap_err();
            assert!(said.contains(phrase), "{said}");
        }
        assert!(self::table(text).unwrap_err().contains("unknown column"));
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        for (text, phrases) in [
            ("", vec!["empty"]),
            (
                "tie_rod_iner_z\n1\n",
                vec!["tie_rod_iner_z", "did you mean tie_rod_inner_z?"],
            ),
            ("tie_rod_inner_z_m\n1\n", vec!["in mm"]),
            ("tie_rod_inner_z\n", vec!["a row for each"]),
            (
                "tie_rod_inner_z\n240\nnan\n",
                vec![":3:", "tie_rod_inner_z", "nan"],
            ),
            (
                "tie_rod_inner_z,strut_top_x\n240\n",
                vec![":2:", "expected 2 values, found 1"],
            ),
            (
                "tie_rod_inner_z,tie_rod_inner_dz\n1,1\n",
                vec!["the same coordinate"],
            ),
            ("design\n1\n", vec!["columns like"]),
        ] {
            let said = table(text).unwrap_err();
            for phrase in phrases {
                assert!(said.contains(phrase), "{text:?} lacks {phrase:?}: {said}");
            }
        }
    }
}

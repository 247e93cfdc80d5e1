//! Target curves in CSV files.

mod loops;

use super::error::{Problems, Source, StudyError, StudyErrors};
use super::source::{LONGEST_TEXT, read_text};
use super::value::{Number, Text};
use crate::evaluate::index_or_push;
use crate::model::LengthUnit;
use crate::number::Each;
use loops::function;
use std::path::Path;
use std::sync::Arc;

/// Columns to read from a file.
pub(super) struct WantedColumns<'a> {
    /// Name of the column of drive values.
    pub drive: &'a str,
    /// Name of the column of target values.
    pub value: &'a str,
    /// Unit of lengths in the study. It is part of the names of columns.
    pub length_unit: LengthUnit,
    /// Rack displacements of the target. If the file has a column of rack displacements, only rows with one of these
    /// displacements are used.
    pub racks: &'a [f64],
    /// True if the measured points are used unchanged. Otherwise they are sorted, and the passes of a hysteresis loop are
    /// averaged.
    pub as_measured: bool,
    /// Returns the reason why a measured point at a drive value cannot be compared. `None` if the point can be compared.
    pub refuse_measured: &'a dyn Fn(f64) -> Option<String>,
}

impl WantedColumns<'_> {
    /// Names of the expected columns, for messages.
    fn expected(&self) -> String {
        format!("expected the columns {},{}", self.drive, self.value)
    }
}

/// Finds a column by its name. Refuses a file in which several columns have this name.
pub(super) fn only_column(header: &csv::StringRecord, name: &str) -> Result<Option<usize>, String> {
    let mut places = (0..header.len()).filter(|place| &header[*place] == name);
    let first = places.next();
    match places.next() {
        None => Ok(first),
        Some(_) => Err(format!(
            "several columns have the name {name}: expected one"
        )),
    }
}

/// Refuses columns of positions in another unit than the unit of the study. `stems` are the names of the columns without the
/// unit.
pub(super) fn refuse_other_units(
    header: &csv::StringRecord,
    stems: &[&str],
    unit: LengthUnit,
) -> Result<(), String> {
    let own = unit.symbol();
    for stem in stems {
        let has = |symbol: &str| header.iter().any(|name| name == format!("{stem}_{symbol}"));
        let mut others = LengthUnit::ALL.each(LengthUnit::symbol).into_iter();
        if let (false, Some(other)) = (has(own), others.find(|other| has(other))) {
            return Err(format!(
                "the study is in {own}: expected the column {stem}_{own}, found {stem}_{other}"
            ));
        }
    }
    Ok(())
}

/// Reads a curve from a file with one column of drive values and one of target values. The path is relative to the study's
/// directory. Commas, semicolons or tabs separate columns. Other columns are ignored, and rows without a value are left out.
/// If the file has a column of rack displacements, it has a curve for each displacement. The target must then have a single
/// displacement.
pub(super) fn read(
    path: &Text,
    directory: &Path,
    wanted: &WantedColumns<'_>,
    problems: &mut Problems,
) -> Option<Vec<[f64; 2]>> {
    let full = directory.join(path.get_ref());
    let text = match read_text(&full, LONGEST_TEXT) {
        Ok(text) => text,
        Err(reason) => {
            unreadable(path, directory, &reason, problems);
            return None;
        }
    };
    let source = Arc::new(Source {
        name: full.display().to_string(),
        text,
    });
    match curve(&source, wanted) {
        Ok(curve) => Some(curve),
        Err(errors) => {
            problems.append(errors);
            None
        }
    }
}

/// Reports a file that cannot be read.
pub(super) fn unreadable(path: &Text, directory: &Path, reason: &str, problems: &mut Problems) {
    let full = directory.join(path.get_ref());
    let message = format!("cannot read {}: {reason}", full.display());
    let error = problems.add(path.span(), message);
    error.help("the path is relative to the study file");
}

/// Columns of a curve in a file.
struct Columns {
    /// Index of the column of drive values.
    drive: usize,
    /// Index of the column of target values.
    value: usize,
    /// Index of the column of rack displacements. `None` if the file has no such column.
    rack: Option<usize>,
    /// Name of the column of rack displacements.
    rack_name: String,
}

impl Columns {
    /// Finds the columns by the names in the first row.
    fn of(header: &csv::StringRecord, wanted: &WantedColumns<'_>) -> Result<Self, String> {
        let drive = only_column(header, wanted.drive)?;
        let value = only_column(header, wanted.value)?;
        let (Some(drive), Some(value)) = (drive, value) else {
            let found = header.iter().collect::<Vec<_>>().join(",");
            return Err(format!("{}, found {found}", wanted.expected()));
        };
        refuse_other_units(header, &["rack"], wanted.length_unit)?;
        let rack_name = format!("rack_{}", wanted.length_unit.symbol());
        Ok(Columns {
            drive,
            value,
            rack: only_column(header, &rack_name)?,
            rack_name,
        })
    }

    /// Reads the point in a row. `None` if the row has no value, or if the target does not have the rack displacement of
    /// the row. Adds such a displacement to `other_racks`.
    fn point(
        &self,
        row: &csv::StringRecord,
        wanted: &WantedColumns<'_>,
        other_racks: &mut Vec<f64>,
    ) -> Result<Option<[f64; 2]>, String> {
        let last = self.drive.max(self.value);
        if row.len() <= last {
            let many = if last == 1 { "two" } else { "more" };
            return Err(format!("expected {many} values, found {}", row.len()));
        }
        if let Some(rack) = self.rack
            && let Some(rack) = number(row, rack, &self.rack_name)?
        {
            if wanted.racks.len() > 1 {
                return Err(format!(
                    "this row is for {} = {rack}, but the target has the racks {}: expected one target for each rack",
                    self.rack_name,
                    in_words(wanted.racks)
                ));
            }
            if !wanted.racks.contains(&rack) {
                index_or_push(other_racks, rack);
                return Ok(None);
            }
        }
        let drive = number(row, self.drive, wanted.drive)?;
        let Some(value) = number(row, self.value, wanted.value)? else {
            return Ok(None);
        };
        let Some(drive) = drive else {
            let (column, value_column) = (wanted.drive, wanted.value);
            return Err(format!(
                "{column} is empty, but {value_column} is {value}: expected a number as {column}"
            ));
        };
        if let (true, Some(reason)) = (wanted.as_measured, (wanted.refuse_measured)(drive)) {
            return Err(reason);
        }
        Ok(Some([drive, value]))
    }
}

/// Reads a number from a row. `None` if the row has no text in this column.
fn number(row: &csv::StringRecord, place: usize, column: &str) -> Result<Option<f64>, String> {
    let text = row.get(place).unwrap_or("");
    if text.is_empty() {
        return Ok(None);
    }
    let parsed = Number::parsed(text).map(Some);
    parsed.map_err(|wanted| format!("expected {wanted} as {column}, found {text:?}"))
}

/// Reads the curve from the text of a file.
fn curve(source: &Arc<Source>, wanted: &WantedColumns<'_>) -> Result<Vec<[f64; 2]>, StudyErrors> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(delimiter(&source.text))
        .trim(csv::Trim::All)
        .from_reader(source.text.as_bytes());
    let of_file = |message: String| StudyError::of_file(&source.name, message);
    let mut records = reader.records();
    let header = records.next().transpose();
    let Some(header) = header.map_err(|e| of_file(e.to_string()))? else {
        let message = format!("the file is empty; {}", wanted.expected());
        return Err(of_file(message).into());
    };
    let columns = Columns::of(&header, wanted);
    let columns = columns.map_err(|message| at_record(source, &header, message))?;
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut other_racks: Vec<f64> = Vec::new();
    for record in records {
        let row = record.map_err(|e| of_file(e.to_string()))?;
        let point = columns.point(&row, wanted, &mut other_racks);
        points.extend(point.map_err(|message| at_record(source, &row, message))?);
    }
    let curve = if wanted.as_measured {
        points
    } else {
        function(points)
    };
    if curve.len() < 2 {
        let found = curve.len();
        let message = match other_racks.as_slice() {
            [] => format!("a curve has at least two points, found {found}"),
            others => format!(
                "a curve has at least two points, found {found} at {} = {}; other rows are at {}",
                columns.rack_name,
                in_words(wanted.racks),
                in_words(others)
            ),
        };
        return Err(of_file(message).into());
    }
    Ok(curve)
}

/// Numbers in a list for a message.
fn in_words(numbers: &[f64]) -> String {
    let texts: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    texts.join(", ")
}

/// Character that separates columns. It is the first of tab, semicolon and comma that the first line contains.
pub(super) fn delimiter(text: &str) -> u8 {
    let header = text.trim_start().lines().next().unwrap_or("");
    let found = ['\t', ';'].into_iter().find(|c| header.contains(*c));
    found.map_or(b',', |c| c as u8)
}

/// Makes an error that points to a record of the file. The record begins at its recorded position, or after blank lines at
/// this position.
pub(super) fn at_record(
    source: &Arc<Source>,
    record: &csv::StringRecord,
    message: String,
) -> StudyErrors {
    let start = record.position().map_or(0, |p| p.byte() as usize);
    let rest = source.text.get(start..).unwrap_or("");
    let blank = rest.len() - rest.trim_start().len();
    let span = start + blank..source.text.len();
    StudyError::new(source.clone(), Some(span), message).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, as_measured: bool) -> Vec<[f64; 2]> {
        read_at(&[0.0], text, as_measured).unwrap()
    }

    fn read_at(racks: &[f64], text: &str, as_measured: bool) -> Result<Vec<[f64; 2]>, String> {
        let source = Arc::new(Source {
            name: "curve.csv".to_owned(),
            text: text.to_owned(),
        });
        let wanted = WantedColumns {
            drive: "travel_mm",
            value: "camber_deg",
            length_unit: LengthUnit::Millimetre,
            racks,
            as_measured,
            refuse_measured: &|drive| (drive > 99.0).then(|| format!("{drive} is too far")),
        };
        curve(&source, &wanted).map_err(|errors| errors.to_string())
    }

    #[test]
    fn columns_are_found_whatever_parts_them() {
        let wanted = [[-1.0, 0.5], [2.0, -0.25]];
        for text in [
            "travel_mm,camber_deg\n-1,0.5\n2,-0.25\n",
            "camber_deg;travel_mm\n0.5;-1\n-0.25;2\n",
            "travel_mm\track_mm\tcamber_deg\n2\t0\t-0.25\n2\t5\t9\n-1\t0\t0.5\n",
            "travel_mm,toe_deg,camber_deg,status\n-1,3,0.5,ok\n1,3,,unreachable\n2,3,-0.25,ok\n",
        ] {
            assert_eq!(read(text, false), wanted, "{text}");
        }
    }

    #[test]
    fn a_loop_is_averaged_unless_both_branches_are_wanted() {
        let text = "travel_mm,camber_deg\n-10,1\n0,0\n10,-1\n5,-0.3\n-5,0.7\n-10,1.2\n";
        let averaged = read(text, false);
        assert_eq!(averaged.first(), Some(&[-10.0, 1.1]));
        let at_zero = averaged.iter().find(|p| p[0] == 0.0).unwrap()[1];
        assert!((at_zero - 0.1).abs() < 1e-15, "{at_zero}");
        assert!(averaged.windows(2).all(|p| p[0][0] < p[1][0]));
        assert_eq!(read(text, true).len(), 6);
    }

    /// A measured loop may start anywhere, for example at static. Its curve is the mean of the rising and the falling branch.
    #[test]
    fn a_loop_is_averaged_wherever_it_starts() {
        let middle = |x: f64| 0.25 - 0.02 * x + 1e-4 * x * x;
        // Drive values of a loop that starts at static, moves to 50, then to -50, and back.
        let up = (0..10).map(|k| (f64::from(5 * k), 1.0));
        let down = (-9..=10).rev().map(|k| (f64::from(5 * k), -1.0));
        let back = (-10..=0).map(|k| (f64::from(5 * k), 1.0));
        let all: Vec<(f64, f64)> = up.chain(down).chain(back).collect();
        for start in 0..all.len() - 1 {
            // The last point of the loop is its first point.
            let (before, after) = (&all[..=start], &all[start..all.len() - 1]);
            let mut text = "travel_mm,camber_deg\n".to_owned();
            for (x, branch) in after.iter().chain(before) {
                // Both branches meet at the ends of the loop.
                let hysteresis = 0.3 * (1.0 - (x / 50.0).powi(2));
                text += &format!("{x},{}\n", middle(*x) + branch * hysteresis);
            }
            let found = read(&text, false);
            assert_eq!(found.len(), 21, "{start}");
            for (k, [x, value]) in found.into_iter().enumerate() {
                assert_eq!(x, 5.0 * k as f64 - 50.0);
                let error = (value - middle(x)).abs();
                assert!(error < 1e-14, "{start}: {value} at {x}");
            }
        }
    }

    /// Two halves that are each measured from static outwards are no loop. No value is interpolated over the jump between them.
    #[test]
    fn halves_from_static_are_sorted() {
        let value = |x: i32| x * x;
        let row = |x: i32| format!("{x},{}\n", value(x));
        for halves in [
            (0..=60).chain((-40..0).rev()).collect::<Vec<i32>>(),
            (0..=60).chain(-40..0).collect(),
            (-40..=0).chain((1..=60).rev()).collect(),
        ] {
            let rows = halves.iter().map(|x| row(*x)).collect::<String>();
            let found = read(&format!("travel_mm,camber_deg\n{rows}"), false);
            assert_eq!(found.len(), 101);
            for [x, found] in found {
                assert_eq!(found, f64::from(value(x as i32)), "{x}");
            }
        }
    }

    #[test]
    fn points_out_of_order_are_sorted_and_repeated_ones_averaged() {
        let text = "travel_mm,camber_deg\n3,1\n1,2\n2,3\n1,4\n5,0\n4,0\n7,0\n6,0\n9,0\n8,0\n10,0\n0,0\n11,0\n";
        let found = read(text, false);
        assert_eq!(
            &found[..4],
            [[0.0, 0.0], [1.0, 3.0], [2.0, 3.0], [3.0, 1.0]]
        );
    }

    /// Rows with different rack displacements belong to different curves. A target uses only rows with its own
    /// displacement, and never a mean over displacements.
    #[test]
    fn each_rack_has_its_own_rows() {
        let text = "travel_mm,rack_mm,camber_deg\n-1,0,1\n1,0,2\n-1,10,5\n1,10,6\n";
        assert_eq!(
            read_at(&[10.0], text, false).unwrap(),
            [[-1.0, 5.0], [1.0, 6.0]]
        );
        for as_measured in [false, true] {
            let error = read_at(&[0.0, 10.0], text, as_measured).unwrap_err();
            assert!(error.contains("curve.csv:2"), "{error}");
            assert!(error.contains("one target for each rack"), "{error}");
        }
        let error = read_at(&[5.0], text, false).unwrap_err();
        assert!(error.contains("found 0 at rack_mm = 5"), "{error}");
        assert!(error.contains("other rows are at 0, 10"), "{error}");
        // Without a column of rack displacements in the file, the curve applies to every displacement.
        let text = "travel_mm,rack_mm,camber_deg\n-1,,1\n1,,2\n";
        assert_eq!(read_at(&[0.0, 10.0], text, false).unwrap().len(), 2);
    }

    #[test]
    fn rows_and_columns_that_may_mean_two_things_are_refused() {
        for (text, line, reason) in [
            (
                "travel_mm,rack_in,camber_deg\n-1,0,1\n1,0,2\n",
                1,
                "expected the column rack_mm, found rack_in",
            ),
            (
                "travel_mm,camber_deg,camber_deg\n-1,1,2\n1,1,2\n",
                1,
                "several columns have the name camber_deg",
            ),
            (
                "travel_mm,camber_deg\n-1,1\n,7\n1,2\n",
                3,
                "travel_mm is empty, but camber_deg is 7",
            ),
            (
                "travel_mm,camber_deg\n-1,1\n1,2\n100,3\n",
                4,
                "100 is too far",
            ),
        ] {
            let error = read_at(&[0.0], text, true).unwrap_err();
            assert!(error.contains(reason), "{error}");
            assert!(error.contains(&format!("curve.csv:{line}")), "{error}");
        }
        // Rows without a value are left out, and other columns may have the same name.
        let text = "note,travel_mm,note,camber_deg\na,-1,b,1\n,,,\nc,0,,\n,1,,2\n";
        assert_eq!(read(text, true), [[-1.0, 1.0], [1.0, 2.0]]);
    }
}

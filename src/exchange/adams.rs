//! Subsystem files of Adams/Car: text in blocks ("TeimOrbit" format).
//!
//! ```text
//! [UNITS]
//!  LENGTH  =  'mm'
//! [HARDPOINT]
//! {hardpoint_name   symmetry       x_value   y_value   z_value}
//!  'lca_front   '  'left/right'    67.0      -400.0     180.0
//! [PARAMETER]
//! {parameter_name   symmetry       type      value}
//!  'camber_angle'  'left/right'   'real'     -0.5
//! ```
//!
//! A block begins with its name in brackets, in upper or lower case. `$` and `!` begin comments. Braces name the columns. Texts
//! are in single quotes and may be padded with blanks. A row for both sides (`left/right`) has the coordinates of the left
//! hardpoint; the right hardpoint is the mirror image. x points rearward, y to the right and z up. As in studies, camber is
//! positive if the top of the wheel leans outward. Toe is positive if the front of the wheel turns inward.

use super::adams_blocks::{assignment, block, heading, length_unit, name_of_unit};
use super::decimals::LARGEST;
use crate::model::LengthUnit;
use crate::report::shortest;
use std::ops::Range;

/// Side of the car to which a row applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Symmetry {
    /// Both sides: the left one, and its mirror image on the right.
    Both,
    /// Left side only.
    Left,
    /// Right side only.
    Right,
    /// No side: a point on the car's centre plane.
    Single,
}

impl Symmetry {
    const NAMES: [(Symmetry, &str); 4] = [
        (Symmetry::Both, "left/right"),
        (Symmetry::Left, "left"),
        (Symmetry::Right, "right"),
        (Symmetry::Single, "single"),
    ];

    fn named(name: &str) -> Option<Self> {
        let mut names = Symmetry::NAMES.iter();
        let found = names.find(|(_, known)| name.eq_ignore_ascii_case(known));
        found.map(|(symmetry, _)| *symmetry)
    }
}

/// A named row of a subsystem.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row<T> {
    /// Name in the row, without quotes and padding.
    pub name: String,
    /// Side to which the row applies.
    pub symmetry: Symmetry,
    /// Content of the row after the name and the symmetry.
    pub content: T,
    /// Number of the row's line in the file, counted from 1.
    pub line: usize,
}

/// A hardpoint. Its content is the position in the file's unit: x rearward, y right, z up.
pub(super) type SubsystemPoint = Row<[f64; 3]>;

/// A parameter of the type `real`. Its content is the value in the file's unit.
pub(super) type SubsystemParameter = Row<f64>;

impl<T> Row<T> {
    /// Row with the same name, symmetry and line, but with another content.
    fn with<C>(self, content: C) -> Row<C> {
        Row {
            name: self.name,
            symmetry: self.symmetry,
            content,
            line: self.line,
        }
    }
}

impl SubsystemParameter {
    /// Value of an angle in degrees. `in_degrees` is true if the file has angles in degrees, false if it has radians.
    pub(super) fn angle(&self, in_degrees: bool) -> f64 {
        if in_degrees {
            self.content
        } else {
            self.content.to_degrees()
        }
    }
}

/// Geometry from a subsystem file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Subsystem {
    /// Unit of the lengths in the file, if the file gives one.
    pub length: Option<LengthUnit>,
    /// True if angles are in degrees, or if the file gives no unit of angles.
    pub degrees: bool,
    /// Name of the subsystem's template, if the file gives one.
    pub template: Option<String>,
    /// Hardpoints of the file.
    pub points: Vec<SubsystemPoint>,
    /// Parameters of the type `real`. Parameters of other types are skipped, and also rows that cannot be read.
    pub parameters: Vec<SubsystemParameter>,
}

/// True if a text is a subsystem file: it has a block of hardpoints.
pub(super) fn is_subsystem(text: &str) -> bool {
    text.lines()
        .any(|line| block(line) == Some("HARDPOINT".to_owned()))
}

/// Converts bytes to text, one character per byte (ISO 8859-1). The files state no encoding.
pub(super) fn text_of(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| char::from(*byte)).collect()
}

/// Converts a text from [`text_of`] back to bytes. Characters outside of ISO 8859-1 become `?`.
pub(super) fn bytes_of(text: &str) -> Vec<u8> {
    text.chars()
        .map(|c| u8::try_from(c).unwrap_or(b'?'))
        .collect()
}

/// Lines of a text with their line breaks. Before each line, the pair has the name of the block that contains the line. This name
/// is empty for headings. It is also empty after a line that starts with a parenthesis, because other columns follow there.
pub(super) fn in_blocks(text: &str) -> impl Iterator<Item = (String, &str)> {
    let mut within = String::new();
    text.split_inclusive('\n').map(move |line| {
        if let Some(name) = block(line) {
            within = name;
            return (String::new(), line);
        }
        // A line that starts with a parenthesis begins a part of the block with other columns.
        if line.trim_start().starts_with('(') {
            within.clear();
        }
        (within.clone(), line)
    })
}

/// Reads a subsystem.
///
/// # Errors
/// A unit is not known, or a row of a hardpoint is not a name, a symmetry and three numbers. The message has the line number.
pub(super) fn read(text: &str) -> Result<Subsystem, String> {
    let mut subsystem = Subsystem {
        length: None,
        degrees: true,
        template: None,
        points: Vec::new(),
        parameters: Vec::new(),
    };
    for ((within, line), number) in in_blocks(text).zip(1..) {
        if line.trim_start().starts_with(['$', '!', '{', '#']) || line.trim().is_empty() {
            continue;
        }
        let at = |reason: String| format!("line {number}: {reason}");
        match within.as_str() {
            "UNITS" => units(line, &mut subsystem).map_err(at)?,
            "SUBSYSTEM_HEADER" => {
                let found = assignment(line).filter(|(key, _)| key == "TEMPLATE_NAME");
                if let Some((_, template)) = found {
                    subsystem.template = Some(template);
                }
            }
            "HARDPOINT" => {
                let row = row(line, number).map_err(at)?;
                let [x, y, z] = row.content.as_slice() else {
                    let found = row.content.len();
                    let reason = format!(
                        "expected name, symmetry and three coordinates, found {found} values \
                         after the symmetry"
                    );
                    return Err(at(reason));
                };
                let coordinate = |field: &Field| field.number().map_err(at);
                let position = [coordinate(x)?, coordinate(y)?, coordinate(z)?];
                subsystem.points.push(row.with(position));
                if subsystem.points.len() > 10_000 {
                    return Err("more than 10000 hardpoints: this is not a suspension".to_owned());
                }
            }
            "PARAMETER" => {
                // The studies need only camber and toe, which have the type `real`. So other parameters are not read.
                if let Ok(row) = row(line, number)
                    && let [kind, value] = row.content.as_slice()
                    && kind.text == "real"
                    && let Ok(value) = value.number()
                {
                    subsystem.parameters.push(row.with(value));
                }
            }
            _ => (),
        }
    }
    Ok(subsystem)
}

fn units(line: &str, subsystem: &mut Subsystem) -> Result<(), String> {
    let Some((key, value)) = assignment(line) else {
        return Ok(());
    };
    match key.as_str() {
        "LENGTH" => {
            let unit = length_unit(&value).ok_or_else(|| {
                format!("the unit of length is {value:?}; expected 'mm', 'meter' or 'inch'")
            })?;
            subsystem.length = Some(unit);
        }
        "ANGLE" => {
            subsystem.degrees = match value.to_ascii_lowercase().as_str() {
                "deg" | "degree" | "degrees" => true,
                "rad" | "radian" | "radians" => false,
                _ => {
                    return Err(format!(
                        "the unit of angles is {value:?}; expected 'deg' or 'rad'"
                    ));
                }
            };
        }
        _ => (),
    }
    Ok(())
}

/// A value of a row, without quotes and padding.
struct Field<'a> {
    text: &'a str,
    /// Byte range of the value in its line, including quotes.
    place: Range<usize>,
}

impl Field<'_> {
    fn number(&self) -> Result<f64, String> {
        // Old files have Fortran's exponent letter D.
        let text = self.text.replace(['D', 'd'], "e");
        let number = text.parse::<f64>().ok().filter(|n| n.abs() <= LARGEST);
        number.ok_or_else(|| format!("expected a number, found {:?}", self.text))
    }
}

/// Reads a row of the hardpoints or of the parameters. Its content is the list of the fields after the symmetry.
fn row(line: &str, number: usize) -> Result<Row<Vec<Field<'_>>>, String> {
    let mut fields = fields(line).into_iter();
    let (Some(name), Some(symmetry)) = (fields.next(), fields.next()) else {
        return Err("expected name and symmetry in single quotes".to_owned());
    };
    let symmetry = Symmetry::named(symmetry.text).ok_or_else(|| {
        format!(
            "the symmetry is {:?}; expected 'left/right', 'left', 'right' or 'single'",
            symmetry.text
        )
    })?;
    Ok(Row {
        name: name.text.to_owned(),
        symmetry,
        content: fields.collect(),
        line: number,
    })
}

/// Splits a line into its values: words, and quoted texts without padding. It ends before a comment.
fn fields(line: &str) -> Vec<Field<'_>> {
    let mut fields = Vec::new();
    let mut at = 0;
    while let Some(blank) = line[at..].find(|c: char| !c.is_whitespace()) {
        let start = at + blank;
        let rest = &line[start..];
        let length = match rest.strip_prefix('\'') {
            Some(quoted) => quoted.find('\'').map_or(rest.len(), |end| end + 2),
            None => rest.find(char::is_whitespace).unwrap_or(rest.len()),
        };
        let text = rest[..length].trim_matches('\'').trim();
        // A comment may follow the values of a row.
        if rest.starts_with(['$', '!']) {
            break;
        }
        at = start + length;
        let place = start..start + rest[..length].trim_end().len();
        fields.push(Field { text, place });
    }
    fields
}

/// A file with replaced coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rewritten {
    /// Text of the file with the new coordinates. Everything else is unchanged.
    pub text: String,
    /// Number of rows whose coordinates were replaced.
    pub rows: usize,
}

/// Replaces the coordinates of a subsystem. `position` returns the new coordinates for a name and a symmetry, in the
/// file's unit and axes. If it returns `None`, the row stays unchanged.
pub(super) fn rewritten(
    text: &str,
    position: impl Fn(&str, Symmetry) -> Option<[f64; 3]>,
) -> Rewritten {
    let mut written = String::with_capacity(text.len());
    let mut rows = 0;
    for (within, line) in in_blocks(text) {
        let row = row(line, 0).ok().filter(|_| within == "HARDPOINT");
        let known = row.as_ref();
        let new = known.and_then(|row| position(&row.name, row.symmetry));
        let fields = row.map_or(Vec::new(), |row| row.content);
        let (Some(new), [first, .., last]) = (new, fields.as_slice()) else {
            written += line;
            continue;
        };
        rows += 1;
        written += line[..first.place.start].trim_end();
        for number in new {
            written += &format!("  {:>14}", shortest(number));
        }
        written += &line[last.place.end..];
    }
    Rewritten {
        text: written,
        rows,
    }
}

/// Makes the text of a new subsystem file. `length` is the unit of the hardpoints, which have x rearward, y right and z up. Angles
/// in the parameters are in degrees. The file contains only the geometry.
pub(super) fn written(
    length: LengthUnit,
    points: &[(String, Symmetry, [f64; 3])],
    parameters: &[(String, Symmetry, f64)],
) -> String {
    let unit = name_of_unit(length);
    let mut text = heading("MDI_HEADER");
    text += " FILE_TYPE     =  'sub'\n FILE_VERSION  =  7.0\n FILE_FORMAT   =  'ASCII'\n";
    text += &heading("UNITS");
    text += &format!(
        " LENGTH  =  '{unit}'\n FORCE   =  'newton'\n ANGLE   =  'deg'\n MASS    =  'kg'\n TIME    =  'sec'\n"
    );
    text += &heading("HARDPOINT");
    text += "{hardpoint_name                  symmetry         x_value         y_value         z_value}\n";
    for (name, symmetry, [x, y, z]) in points {
        let (_, symmetry) = Symmetry::NAMES[*symmetry as usize];
        let [x, y, z] = [x, y, z].map(|number| shortest(*number));
        text += &format!(" '{name:<28}'  '{symmetry:<10}'  {x:>14}  {y:>14}  {z:>14}\n");
    }
    if !parameters.is_empty() {
        text += &heading("PARAMETER");
        text += "{parameter_name                  symmetry       type       value}\n";
    }
    for (name, symmetry, value) in parameters {
        let (_, symmetry) = Symmetry::NAMES[*symmetry as usize];
        let value = shortest(*value);
        text += &format!(" '{name:<28}'  '{symmetry:<10}'   'real'     {value}\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "\
$---------------------------------UNITS
[UNITS]
 LENGTH = 'inch'
 ANGLE = 'deg'
$---------------------------------HARDPOINT
[hardpoint]
{hardpoint_name  symmetry  x_value  y_value  z_value}
 'lca_front       '  'left/right'   1.5  -16.0   7.25
 'lca_rear'  'right'  1.1D+1   16.25   7.5   $ as measured
 'rack_centre '  'single    '  18.0  0.0  13.0
[PARAMETER]
{parameter_name  symmetry  type  value}
 'camber_angle  '  'left/right'  'real'  -0.5
 'kinematic_flag'  'single'  'integer'  0
(COMMENTS)
 'a note'
";

    #[test]
    fn the_blocks_are_read() {
        let read = read(FILE).unwrap();
        assert_eq!(read.length, Some(LengthUnit::Inch));
        let point = |i: usize| {
            let row = &read.points[i];
            (row.name.as_str(), row.symmetry, row.content)
        };
        assert_eq!(point(0), ("lca_front", Symmetry::Both, [1.5, -16.0, 7.25]));
        assert_eq!(point(1), ("lca_rear", Symmetry::Right, [11.0, 16.25, 7.5]));
        assert_eq!(point(2).1, Symmetry::Single);
        assert_eq!(read.parameters.len(), 1);
        let camber = &read.parameters[0];
        assert_eq!(
            (camber.name.as_str(), camber.content),
            ("camber_angle", -0.5)
        );
        assert!(is_subsystem(FILE) && !is_subsystem("name,x,y,z\n"));
    }

    #[test]
    fn a_row_that_is_wrong_is_named() {
        for (from, to, expected) in [
            ("-16.0", "six", "8: expected a number, found \"six\""),
            (
                "7.25",
                "",
                "8: expected name, symmetry and three coordinates",
            ),
            ("'right'", "'starboard'", "9: the symmetry is \"starboard\""),
            (
                "'inch'",
                "'furlong'",
                "3: the unit of length is \"furlong\"",
            ),
            ("-16.0", "NaN", "8: expected a number"),
            ("-16.0", "-1.0D13", "8: expected a number"),
        ] {
            let error = read(&FILE.replacen(from, to, 1)).unwrap_err();
            assert!(error.starts_with(&format!("line {expected}")), "{error}");
        }
    }

    #[test]
    fn rewriting_changes_coordinates_and_nothing_else() {
        let text = FILE.replace('\n', "\r\n");
        let same = rewritten(&text, |_, _| None);
        assert_eq!((same.text.as_str(), same.rows), (text.as_str(), 0));
        let changed = rewritten(&text, |name, _| {
            (name == "lca_rear").then_some([0.1, 1.0 / 3.0, -7e-9])
        });
        assert_eq!(changed.rows, 1);
        assert!(changed.text.contains("$ as measured\r\n"));
        let back = read(&changed.text).unwrap();
        assert_eq!(back.points[1].content, [0.1, 1.0 / 3.0, -7e-9]);
        let others =
            |subsystem: &Subsystem| (subsystem.points[0].clone(), subsystem.points[2].clone());
        assert_eq!(others(&back), others(&read(&text).unwrap()));
    }

    /// A name without quotes and coordinates in quotes are valid, so their rows are replaced, too.
    #[test]
    fn quotes_do_not_decide_on_a_row() {
        let text = FILE
            .replace("'lca_rear'  'right'", "lca_rear right")
            .replace("7.5 ", "'7.5' ");
        let place = [1.0, 2.0, 3.0];
        let changed = rewritten(&text, |name, _| (name == "lca_rear").then_some(place));
        assert_eq!(changed.rows, 1);
        assert_eq!(read(&changed.text).unwrap().points[1].content, place);
        assert!(changed.text.contains("  3.0   $ as measured\n"));
    }

    #[test]
    fn a_written_file_reads_back() {
        let points = vec![(
            "lca_front".to_owned(),
            Symmetry::Both,
            [0.1, -1.0 / 3.0, 195.0],
        )];
        let parameters = vec![("toe_angle".to_owned(), Symmetry::Both, 0.1)];
        for unit in [LengthUnit::Millimetre, LengthUnit::Metre, LengthUnit::Inch] {
            let back = read(&written(unit, &points, &parameters)).unwrap();
            assert_eq!(back.length, Some(unit));
            assert_eq!(back.points[0].content, points[0].2);
            assert_eq!(back.parameters[0].content, 0.1);
        }
    }
}

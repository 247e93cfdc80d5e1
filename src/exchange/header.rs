//! Headers of tables. They show which columns hold names, coordinates, wheels, axes and bodies. They also show the directions of
//! the coordinates, as in "Y (right +)", "X, fwd" and "lateral".

use super::axes::{Coordinate, Declared, Way};
use super::cell::{Cell, Sheet};
use super::decimals::{is_number, plain_number};
use super::names::{cut, marks_of};
use super::table::Marks;
use super::unit::FileUnit;

/// Columns of x, y and z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triple {
    pub columns: [u32; 3],
    /// Wheel and axle that the headers of these three columns name.
    pub marks: Marks,
}

/// Meanings of a table's columns.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    pub name: u32,
    pub triples: Vec<Triple>,
    /// Columns that name the wheel or the axle.
    pub marks: Vec<u32>,
    pub body: Option<u32>,
    pub frame: Option<u32>,
    /// Column with the unit of each row.
    pub unit: Option<u32>,
}

/// A header, with the unit and the axes that it states.
pub(super) struct Header {
    pub columns: Columns,
    pub unit: Option<FileUnit>,
    pub declared: Declared,
    /// Warning about signs in the headers of coordinates that are not used.
    pub doubt: Option<String>,
}

/// Meaning of one coordinate column, from its own header.
struct Coordinates {
    /// Index of the letter in the header: 0 for x, 1 for y, 2 for z. `None` if the header has only words.
    letter: Option<usize>,
    marks: Marks,
    unit: Option<FileUnit>,
    direction: Coordinate,
    /// True if the header has a minus or the word "negative" that is not used as a sign.
    has_unused_sign: bool,
}

/// Text of a cell. `None` for a number and for a cell without a usable value.
pub(super) fn text(cell: &Cell) -> Option<&str> {
    match cell {
        Cell::Text(text) => Some(text),
        _ => None,
    }
}

/// Reads a row as a header. `above` is the number of the row above it. `None` if the row is not a header.
///
/// # Errors
/// The columns have different units or contradicting axes, two sets of x, y and z belong to the same wheel, or no column has names.
pub(super) fn header(
    sheet: &Sheet,
    row: u32,
    above: Option<u32>,
) -> Result<Option<Header>, String> {
    let mut found: Vec<(u32, Coordinates)> = Vec::new();
    for (column, cell) in sheet.row(row) {
        if let Some(header) = text(cell).and_then(coordinate_header) {
            found.push((column, header));
        }
    }
    // A header without letters x, y and z must name all three axes in words.
    if found.iter().any(|(_, header)| header.letter.is_some()) {
        found.retain(|(_, header)| header.letter.is_some());
    }
    let mut triples = Vec::new();
    let mut unit = None;
    let mut declared = Declared::default();
    for three in found.chunks(3) {
        let Some((columns, stated)) = coordinates(three) else {
            return Ok(None);
        };
        for (_, header) in three {
            if header.unit.is_some() && unit.is_some() && header.unit != unit {
                return Err(format!(
                    "{}: the columns are in different units",
                    sheet.row_place(row)
                ));
            }
            unit = unit.or(header.unit);
        }
        declared = declared.and(stated, &sheet.row_place(row))?;
        // A title across three columns is in the first cell or in all three cells. A cell such as "y right" names a
        // direction of an axis, not a wheel.
        let [x, y, z] = columns;
        let title = above.and_then(|above| sheet.cell(above, x.min(y).min(z)));
        let title = title.and_then(text).map(cut).unwrap_or_default();
        let names_axis = title
            .iter()
            .any(|word| matches!(word.as_str(), "x" | "y" | "z"));
        let titled = title.iter().map(|word| marks_of(word));
        let titled = titled
            .filter(|_| !names_axis)
            .fold(Marks::default(), Marks::or);
        triples.push(Triple {
            columns,
            marks: marks_of_all(three).or(titled),
        });
    }
    if triples.is_empty() {
        return Ok(None);
    }
    let is_repeated = |(place, triple): (usize, &Triple)| {
        let mut before = triples[..place].iter();
        before.any(|other| other.marks == triple.marks)
    };
    if triples.iter().enumerate().any(is_repeated) {
        return Err(format!(
            "{}: there are {} sets of x, y and z; expected one, or one for each wheel, named left and right or FL, FR, RL and RR",
            sheet.row_place(row),
            triples.len()
        ));
    }
    let columns = columns(sheet, row, above, triples)?;
    Ok(Some(Header {
        columns,
        unit,
        declared,
        doubt: unused_signs(sheet, row, &found),
    }))
}

/// Warning about the signs in the headers of coordinates that are not used. `None` if there are no such signs.
fn unused_signs(sheet: &Sheet, row: u32, found: &[(u32, Coordinates)]) -> Option<String> {
    let signed = found.iter().filter(|(_, header)| header.has_unused_sign);
    let texts = signed.filter_map(|(column, _)| text(sheet.cell(row, *column)?));
    let texts: Vec<String> = texts.map(|text| format!("{text:?}")).collect();
    (!texts.is_empty()).then(|| {
        format!(
            "please check: {}: the minus in {} is not used, because it may be a sign or a dash. If the axes are wrong, give them with --axes",
            sheet.row_place(row),
            texts.join(", ")
        )
    })
}

/// Wheel and axle that all three headers name. A side in only one of the headers is the direction of its coordinate,
/// not a wheel.
fn marks_of_all(three: &[(u32, Coordinates)]) -> Marks {
    let first = three.first().map(|(_, header)| header.marks);
    let first = first.unwrap_or_default();
    if three.iter().all(|(_, header)| header.marks == first) {
        first
    } else {
        Marks::default()
    }
}

/// Columns of x, y and z, and the axes that their headers state. `None` if the headers are not x, y and z. Also `None` if a header
/// has no letter and the three headers do not name all three axes in words.
fn coordinates(three: &[(u32, Coordinates)]) -> Option<([u32; 3], Declared)> {
    let mut columns = [None; 3];
    let mut declared = Declared::default();
    let names_side = marks_of_all(three).side.is_some();
    for (place, (column, header)) in three.iter().enumerate() {
        let letter = header.letter.unwrap_or(place);
        columns[letter] = Some(*column);
        declared.0[letter] = match header.direction {
            Coordinate::Grows(Way::Left | Way::Right) if names_side => Coordinate::Unknown,
            direction => direction,
        };
    }
    if three.iter().any(|(_, header)| header.letter.is_none()) {
        let mut axes: Vec<usize> = declared
            .0
            .iter()
            .filter_map(|direction| match direction {
                Coordinate::Unknown => None,
                Coordinate::Along(axis) => Some(*axis),
                Coordinate::Grows(way) => Some(way.axis()),
            })
            .collect();
        axes.sort_unstable();
        if axes != [0, 1, 2] {
            return None;
        }
    }
    let [Some(x), Some(y), Some(z)] = columns else {
        return None;
    };
    Some(([x, y, z], declared))
}

/// Finds the columns of names, wheels, bodies, axes and units.
fn columns(
    sheet: &Sheet,
    row: u32,
    above: Option<u32>,
    triples: Vec<Triple>,
) -> Result<Columns, String> {
    let is_coordinate = |column: u32| triples.iter().any(|t| t.columns.contains(&column));
    let named = |row: u32, names: &str| -> Vec<u32> {
        let cells = sheet.row(row).filter(|(column, _)| !is_coordinate(*column));
        cells
            .filter_map(|(column, cell)| {
                let words = cut(text(cell)?);
                let named = words
                    .iter()
                    .any(|word| names.split(' ').any(|name| name == word));
                named.then_some(column)
            })
            .collect()
    };
    let marks = named(row, "side symmetry corner axle");
    let body = named(row, "body").first().copied();
    let frame = named(row, "frame").first().copied();
    let unit = named(row, "unit units").first().copied();
    let free = |column: u32| {
        !is_coordinate(column)
            && !marks.contains(&column)
            && ![body, frame, unit].contains(&Some(column))
    };
    let names = "name names point points hardpoint hardpoints location joint";
    // Some files put "Point Name" one row above x, y and z.
    let name = [Some(row), above]
        .into_iter()
        .flatten()
        .flat_map(|row| named(row, names))
        .find(|column| free(*column))
        .or_else(|| name_column(sheet, row, free));
    let Some(name) = name else {
        return Err(format!(
            "{}: there are columns x, y and z, but no column with names",
            sheet.row_place(row)
        ));
    };
    Ok(Columns {
        name,
        triples,
        marks,
        body,
        frame,
        unit,
    })
}

/// Column with the largest number of names below a header. `free` is true for columns without another meaning. Numbers do not count
/// as names. Of several such columns, the first one.
fn name_column(sheet: &Sheet, row: u32, free: impl Fn(u32) -> bool) -> Option<u32> {
    let below = sheet.cells.range((row + 1, 0)..);
    let mut counts: Vec<(u32, usize)> = Vec::new();
    for ((_, column), cell) in below {
        let is_name =
            free(*column) && text(cell).is_some_and(|text| plain_number(text, false).is_err());
        if is_name {
            match counts.iter_mut().find(|(known, _)| known == column) {
                Some((_, count)) => *count += 1,
                None => counts.push((*column, 1)),
            }
        }
    }
    let most = counts.iter().map(|(_, count)| *count).max()?;
    let fullest = counts.into_iter().filter(|(_, count)| *count == most);
    fullest.map(|(column, _)| column).min()
}

/// Words that may accompany the axis in the header of a coordinate.
const BESIDE_AXES: &str = "value coord coordinate coordinates pos position loc location axis direction positive points is";

/// Reads the header of a coordinate, such as `x`, `X [mm]`, `y_value`, `z left (in)`, `Y (right +)` or `lateral`.
fn coordinate_header(text: &str) -> Option<Coordinates> {
    let mut letter = None;
    let (mut marks, mut unit) = (Marks::default(), None);
    let mut direction = Coordinate::Unknown;
    let mut is_flipped = false;
    for word in cut(text) {
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == word);
        if let (Some(axis), None) = (axis, letter) {
            letter = Some(axis);
        } else if let Some(found) = FileUnit::named(&word) {
            unit = Some(found);
        } else if let Some(way) = Way::of(&word) {
            direction = direction.and(Coordinate::Grows(way))?;
            marks = marks.or(marks_of(&word));
        } else if let Some(axis) = along(&word) {
            direction = direction.and(Coordinate::Along(axis))?;
        } else if !marks_of(&word).is_empty() {
            marks = marks_of(&word);
        } else if ["negative", "neg", "minus"].contains(&word.as_str()) {
            is_flipped = true;
        } else if !BESIDE_AXES.split(' ').any(|known| known == word) {
            return None;
        }
    }
    // A sign as in "(right -)" has at most one word character beside it. Between two word characters, the minus is a hyphen.
    let chars: Vec<char> = text.chars().collect();
    let is_minus = |k: usize| {
        let beside = |k: Option<usize>| {
            k.and_then(|k| chars.get(k))
                .is_some_and(|c| c.is_alphanumeric())
        };
        "-\u{2212}".contains(chars[k]) && !(beside(k.checked_sub(1)) && beside(Some(k + 1)))
    };
    let has_minus = (0..chars.len()).any(is_minus) && !text.contains('+');
    // In "x - mm" the minus has a blank on both sides, so it is a dash. In "-x" and "(-forward)" it may be a sign.
    let is_sign = |k: usize| is_minus(k) && chars.get(k + 1).is_some_and(|c| c.is_alphanumeric());
    let has_sign = (0..chars.len()).any(is_sign) && !text.contains('+');
    let has_unused_sign = match direction {
        Coordinate::Grows(_) => has_minus,
        _ => has_sign || is_flipped,
    };
    let direction = match direction {
        // A minus in the header of a coordinate may be a sign or a dash, so only the axis is used.
        Coordinate::Grows(way) if has_minus => Coordinate::Along(way.axis()),
        Coordinate::Grows(way) if is_flipped => Coordinate::Grows(way.opposite()),
        direction => direction,
    };
    (letter.is_some() || direction != Coordinate::Unknown).then_some(Coordinates {
        letter,
        marks,
        unit,
        direction,
        has_unused_sign,
    })
}

/// Axis that a word names without a sign: 0 along the car, 1 across it, 2 vertical. "Outboard" has no sign, because the wheel is
/// not known.
fn along(word: &str) -> Option<usize> {
    match word {
        "longitudinal" | "long" | "lengthwise" => Some(0),
        "lateral" | "lat" | "transverse" | "crosswise" | "outboard" | "outward" => Some(1),
        "vertical" | "vert" | "height" => Some(2),
        _ => None,
    }
}

/// Returns the words beside x, y and z in a row of titles, such as "um" in `x [um]`. `None` if one of the letters is missing, or if
/// there are no such words. For a row that is not a valid header, at least one of these words is not known.
pub(super) fn unknown_beside_axes(sheet: &Sheet, row: u32) -> Option<String> {
    let beside = |axis: &str| {
        let mut cells = sheet.row(row).filter_map(|(_, cell)| text(cell));
        cells.find_map(|cell| match cut(cell).as_slice() {
            [first, rest @ ..] if first == axis => Some(rest.join(" ")),
            _ => None,
        })
    };
    let mut words = vec![beside("x")?, beside("y")?, beside("z")?];
    words.dedup();
    let words = words.join(", ");
    (!words.is_empty()).then_some(words)
}

/// True for the number of a row: a whole number that is not negative.
fn is_index(cell: &Cell) -> bool {
    match cell {
        Cell::Number(number) => *number >= 0.0 && number.fract() == 0.0,
        Cell::Text(text) => !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit()),
        Cell::Unusable(_) => false,
    }
}

/// Columns of a table without a header, whose rows have a name followed by three numbers. The number of the row may be in front of
/// the name.
pub(super) fn without_header(sheet: &Sheet, rows: &[u32]) -> Option<Columns> {
    let fits = |row: u32| {
        let cells: Vec<(u32, &Cell)> = sheet.row(row).take(6).collect();
        let cells = match cells.as_slice() {
            [(_, number), rest @ ..] if rest.len() == 4 && is_index(number) => rest,
            cells => cells,
        };
        let [(name, Cell::Text(text)), (x, _), (y, _), (z, _)] = cells else {
            return None;
        };
        let has_numbers = cells[1..].iter().all(|(_, cell)| is_number(cell));
        let is_name = plain_number(text, true).is_err();
        (has_numbers && is_name && [*x, *y, *z] == [name + 1, name + 2, name + 3]).then_some(*name)
    };
    let mut fitting = rows.iter().filter_map(|row| fits(*row));
    let name = fitting.next()?;
    (fitting.next()? == name).then(|| Columns {
        name,
        triples: vec![Triple {
            columns: [name + 1, name + 2, name + 3],
            marks: Marks::default(),
        }],
        marks: Vec::new(),
        body: None,
        frame: None,
        unit: None,
    })
}

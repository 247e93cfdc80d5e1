//! Points in a table: which columns hold names and coordinates, and of which wheel.

use super::cell::{Cell, Sheet};
use super::names::{Words, cut, side_of};
use crate::model::{FrameConvention, LengthUnit, Side};

/// A named point of a file, in the file's axes and unit.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPoint {
    /// Its name, as it stands there.
    pub name: String,
    /// The wheel it belongs to, where the file says so.
    pub side: Option<Side>,
    /// Whether it stands for the left wheel, and mirrored for the right one.
    pub mirrored: bool,
    /// Its coordinates, or what is wrong with them.
    pub position: Result<[f64; 3], String>,
    /// The body it sits on, where the file says so.
    pub body: Option<String>,
    /// Its place in the file.
    pub place: String,
}

/// The points in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointTable {
    /// The points, in the order of the file.
    pub points: Vec<NamedPoint>,
    /// Single numbers with a name, and where they stand.
    pub figures: Vec<(String, f64, String)>,
    /// The unit of length, where the file says so.
    pub unit: Option<LengthUnit>,
    /// The axes, where the file says so.
    pub frame: Option<FrameConvention>,
    /// How it was read, for the user.
    pub notes: Vec<String>,
}

/// Three columns of coordinates.
#[derive(Clone, Copy, Debug)]
struct Triple {
    columns: [u32; 3],
    side: Option<Side>,
}

/// The roles of a table's columns.
#[derive(Clone, Debug)]
struct Columns {
    name: u32,
    triples: Vec<Triple>,
    side: Option<u32>,
    body: Option<u32>,
    frame: Option<u32>,
}

/// A coordinate's column, by its header.
struct Header {
    axis: usize,
    side: Option<Side>,
    unit: Option<LengthUnit>,
}

/// The unit a word names.
pub fn unit_of(word: &str) -> Option<LengthUnit> {
    match word.to_ascii_lowercase().as_str() {
        "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => {
            Some(LengthUnit::Millimetre)
        }
        "m" | "metre" | "metres" | "meter" | "meters" => Some(LengthUnit::Metre),
        "in" | "inch" | "inches" => Some(LengthUnit::Inch),
        _ => None,
    }
}

/// Reads the points of a table; `None` where it has none.
pub(super) fn read(sheet: &Sheet) -> Result<Option<PointTable>, String> {
    let rows = sheet.rows();
    let mut table = PointTable::default();
    let mut columns: Option<Columns> = None;
    let mut headers = 0;
    for (place, row) in rows.iter().enumerate() {
        let above = place.checked_sub(1).map(|place| rows[place]);
        if let Some((found, unit)) = header(sheet, *row, above)? {
            if unit.is_some() && table.unit.is_some() && unit != table.unit {
                return Err(format!(
                    "{}: the unit is another than in the table above",
                    sheet.row_place(*row)
                ));
            }
            table.unit = table.unit.or(unit);
            headers += 1;
            columns = Some(found);
        }
    }
    if headers == 0 {
        columns = without_header(sheet, &rows);
        if columns.is_some() {
            let note = "no header names the columns: they are taken as name, x, y, z".to_owned();
            table.notes.push(note);
        }
    }
    let Some(first) = columns else {
        return Ok(None);
    };
    let decimals = Decimals::of(sheet, &first)?;
    // Each header holds for the rows below it.
    let mut columns = (headers == 0).then_some(first);
    let mut section = None;
    for (place, row) in rows.iter().enumerate() {
        let above = place.checked_sub(1).map(|place| rows[place]);
        if let Some((found, _)) = header(sheet, *row, above)? {
            columns = Some(found);
            continue;
        }
        match &columns {
            Some(columns) => points(sheet, *row, columns, decimals, &mut section, &mut table)?,
            None => given_above(sheet, *row, &mut table),
        }
    }
    if table.points.iter().all(|point| point.position.is_err()) {
        return Ok(None);
    }
    Ok(Some(table))
}

/// Lines above the header: `unit, mm`.
fn given_above(sheet: &Sheet, row: u32, table: &mut PointTable) {
    let texts: Vec<&str> = sheet.row(row).filter_map(|(_, cell)| text(cell)).collect();
    if let [key, value, ..] = texts.as_slice() {
        let key = cut(key);
        if key.iter().any(|word| word == "unit" || word == "units") {
            table.unit = table
                .unit
                .or(unit_of(value.trim_matches(['[', ']', '(', ')'])));
        }
    }
}

fn text(cell: &Cell) -> Option<&str> {
    match cell {
        Cell::Text(text) => Some(text),
        _ => None,
    }
}

/// The columns that a row names, if it is a header, and their unit.
fn header(
    sheet: &Sheet,
    row: u32,
    above: Option<u32>,
) -> Result<Option<(Columns, Option<LengthUnit>)>, String> {
    let mut found: Vec<(u32, Header)> = Vec::new();
    for (column, cell) in sheet.row(row) {
        if let Some(header) = text(cell).and_then(coordinate_header) {
            found.push((column, header));
        }
    }
    let mut triples = Vec::new();
    let mut unit = None;
    for three in found.chunks(3) {
        let mut columns = [None; 3];
        for (column, header) in three {
            columns[header.axis] = Some(*column);
            if header.unit.is_some() && unit.is_some() && header.unit != unit {
                return Err(format!(
                    "{}: the columns are in different units",
                    sheet.row_place(row)
                ));
            }
            unit = unit.or(header.unit);
        }
        let [Some(x), Some(y), Some(z)] = columns else {
            return Ok(None);
        };
        // A title across the three columns stands above the first, or on all of them.
        let title = above.and_then(|above| sheet.cell(above, x.min(y).min(z)));
        let title = title.and_then(text).map(cut).unwrap_or_default();
        let titled = title.iter().find_map(|word| side_of(word));
        triples.push(Triple {
            columns: [x, y, z],
            side: three.iter().find_map(|(_, header)| header.side).or(titled),
        });
    }
    if triples.is_empty() {
        return Ok(None);
    }
    if triples.len() > 2 || (triples.len() == 2 && triples[0].side == triples[1].side) {
        return Err(format!(
            "{}: there are {} sets of x, y and z; expected one, or one named left and one named right",
            sheet.row_place(row),
            triples.len()
        ));
    }
    let is_coordinate = |column: u32| found.iter().any(|(known, _)| *known == column);
    let named = |names: &str| {
        let mut cells = sheet.row(row).filter(|(column, _)| !is_coordinate(*column));
        cells.find_map(|(column, cell)| {
            let words = cut(text(cell)?);
            let named = words
                .iter()
                .any(|word| names.split(' ').any(|name| name == word));
            named.then_some(column)
        })
    };
    let side = named("side symmetry");
    let body = named("body");
    let frame = named("frame");
    let others = [side, body, frame];
    let free = |column: u32| !is_coordinate(column) && !others.contains(&Some(column));
    let names = "name names point points hardpoint hardpoints location joint";
    let name = named(names)
        .filter(|column| free(*column))
        .or_else(|| name_column(sheet, row, free));
    let Some(name) = name else {
        return Err(format!(
            "{}: x, y and z are there, but no column with names",
            sheet.row_place(row)
        ));
    };
    let columns = Columns {
        name,
        triples,
        side,
        body,
        frame,
    };
    Ok(Some((columns, unit)))
}

/// The first column with texts below a header.
fn name_column(sheet: &Sheet, row: u32, free: impl Fn(u32) -> bool) -> Option<u32> {
    let below = sheet.cells.range((row + 1, 0)..);
    let named = below.filter(|((_, column), cell)| {
        free(*column) && text(cell).is_some_and(|text| plain_number(text, false).is_err())
    });
    named.map(|((_, column), _)| *column).min()
}

/// Words that may stand beside the axis in the header of a coordinate.
const BESIDE_AXES: &str = "value coord coordinate coordinates pos position loc location axis";

/// `x`, `X [mm]`, `y_value`, `z left (in)`.
fn coordinate_header(text: &str) -> Option<Header> {
    let mut header = None;
    let (mut side, mut unit) = (None, None);
    for word in cut(text) {
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == word);
        if let (Some(axis), None) = (axis, header) {
            header = Some(axis);
        } else if let Some(found) = unit_of(&word) {
            unit = Some(found);
        } else if let Some(found) = side_of(&word) {
            side = Some(found);
        } else if !BESIDE_AXES.split(' ').any(|known| known == word) {
            return None;
        }
    }
    header.map(|axis| Header { axis, side, unit })
}

/// Rows of a name and three numbers behind it.
fn without_header(sheet: &Sheet, rows: &[u32]) -> Option<Columns> {
    let fits = |row: u32| {
        let cells: Vec<(u32, &Cell)> = sheet.row(row).collect();
        let [(name, Cell::Text(text)), (x, _), (y, _), (z, _)] = cells.as_slice() else {
            return None;
        };
        let numbers = cells[1..].iter().all(|(_, cell)| match cell {
            Cell::Number(_) => true,
            Cell::Text(text) => plain_number(text, true).is_ok(),
            Cell::Unusable(_) => false,
        });
        let is_name = plain_number(text, true).is_err();
        (numbers && is_name && [*x, *y, *z] == [name + 1, name + 2, name + 3]).then_some(*name)
    };
    let mut fitting = rows.iter().filter_map(|row| fits(*row));
    let name = fitting.next()?;
    (fitting.next()? == name).then(|| Columns {
        name,
        triples: vec![Triple {
            columns: [name + 1, name + 2, name + 3],
            side: None,
        }],
        side: None,
        body: None,
        frame: None,
    })
}

/// The points of a row.
fn points(
    sheet: &Sheet,
    row: u32,
    columns: &Columns,
    decimals: Decimals,
    section: &mut Option<Side>,
    table: &mut PointTable,
) -> Result<(), String> {
    let Some(name) = sheet.cell(row, columns.name).and_then(text) else {
        return Ok(());
    };
    let cell = |column: Option<u32>| sheet.cell(row, column?).and_then(text);
    if let Some(frame) = cell(columns.frame)
        && let Some(known) = FrameConvention::ALL.into_iter().find(|c| c.name() == frame)
    {
        if table.frame.is_some_and(|other| other != known) {
            return Err(format!(
                "{}: the frame changes within the table",
                sheet.row_place(row)
            ));
        }
        table.frame = Some(known);
    }
    let triples = columns.triples.iter();
    let triples = triples.map(|triple| triple.columns.map(|column| sheet.cell(row, column)));
    let numbers: Vec<[Option<&Cell>; 3]> = triples.collect();
    let filled = numbers.iter().flatten().flatten().count();
    if filled == 0 {
        // A title: "Left".
        let words = cut(name);
        if let Some(side) = words.iter().find_map(|word| side_of(word)) {
            *section = Some(side);
        }
        return Ok(());
    }
    if let (1, Some(_)) = (filled, Words::of(name).figure()) {
        let only = numbers.iter().flatten().flatten().next();
        let place = sheet.row_place(row);
        let value = decimals.number(only.expect("one is filled"));
        let value = value.map_err(|reason| format!("{place}: {reason}"))?;
        table.figures.push((name.to_owned(), value, place));
        return Ok(());
    }
    let said = cell(columns.side).map(|text| cut(text).join(" "));
    let (written, both) = match said.as_deref() {
        Some("left right" | "both" | "symmetric" | "l r") => (None, true),
        Some(word) => (side_of(word), false),
        None => (None, false),
    };
    for (triple, cells) in columns.triples.iter().zip(&numbers) {
        if cells.iter().all(Option::is_none) {
            continue;
        }
        let side = triple.side.or(written);
        let side = side.or(Words::of(name).side).or(*section);
        table.points.push(NamedPoint {
            name: name.to_owned(),
            side: side.filter(|_| !both),
            mirrored: both,
            position: position(sheet, row, triple, cells, decimals),
            body: cell(columns.body).map(str::to_owned),
            place: sheet.row_place(row),
        });
    }
    Ok(())
}

fn position(
    sheet: &Sheet,
    row: u32,
    triple: &Triple,
    cells: &[Option<&Cell>],
    decimals: Decimals,
) -> Result<[f64; 3], String> {
    let mut position = [0.0; 3];
    for ((coordinate, cell), column) in position.iter_mut().zip(cells).zip(triple.columns) {
        let at = |reason: &str| format!("{}: {reason}", sheet.place(row, column));
        let cell = cell.ok_or_else(|| at("the cell is empty"))?;
        *coordinate = decimals.number(cell).map_err(|reason| at(&reason))?;
    }
    Ok(position)
}

/// How a table writes decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Decimals {
    comma: bool,
}

impl Decimals {
    /// As the coordinates of a table are written. Where 1,250 may be as well a thousand as one and a
    /// quarter, the table is refused.
    fn of(sheet: &Sheet, columns: &Columns) -> Result<Self, String> {
        let places = || columns.triples.iter().flat_map(|triple| triple.columns);
        let texts = || {
            sheet.cells.iter().filter_map(|((row, column), cell)| {
                let text = text(cell).filter(|_| places().any(|known| known == *column))?;
                let is_number = text
                    .chars()
                    .all(|c| c.is_ascii_digit() || "+-.,eE\u{2212}".contains(c));
                (is_number && text.contains(|c: char| c.is_ascii_digit()))
                    .then_some((*row, *column, text))
            })
        };
        let Some((row, column, first)) = texts().find(|(_, _, text)| text.contains(',')) else {
            return Ok(Decimals { comma: false });
        };
        let place = sheet.place(row, column);
        if let Some((row, column, other)) = texts().find(|(_, _, text)| text.contains('.')) {
            return Err(format!(
                "{place} holds {first:?}, {} holds {other:?}: commas and points are mixed, so what either \
                 means is not certain",
                sheet.place(row, column)
            ));
        }
        let thousand = |text: &str| {
            let (whole, rest) = text
                .trim_start_matches(['+', '-', '\u{2212}'])
                .split_once(',')?;
            let could_be =
                (1..=3).contains(&whole.len()) && !whole.starts_with('0') && rest.len() == 3;
            Some(could_be)
        };
        let all = texts()
            .filter_map(|(_, _, text)| thousand(text))
            .all(|could| could);
        let some_without = texts().any(|(_, _, text)| !text.contains(',') && text != "0");
        let numbers = sheet.cells.iter().any(|((_, column), cell)| {
            matches!(cell, Cell::Number(_)) && places().any(|known| known == *column)
        });
        if all && (some_without || numbers) {
            return Err(format!(
                "{place} holds {first:?}, which may be a decimal or a thousand; write it with a point, or \
                 without the comma"
            ));
        }
        Ok(Decimals { comma: true })
    }

    fn number(self, cell: &Cell) -> Result<f64, String> {
        match cell {
            Cell::Number(number) => Ok(*number),
            Cell::Text(text) => plain_number(text, self.comma),
            Cell::Unusable(what) => Err(format!("expected a number, found {what}")),
        }
    }
}

/// A number as text.
fn plain_number(text: &str, comma: bool) -> Result<f64, String> {
    let plain = text.replace('\u{2212}', "-");
    let plain = if comma {
        plain.replacen(',', ".", 1)
    } else {
        plain
    };
    // The names of no numbers are read by the standard library, too.
    let is_number = plain.contains(|c: char| c.is_ascii_digit());
    let number = plain
        .parse::<f64>()
        .ok()
        .filter(|n| is_number && n.abs() <= 1e12);
    number.ok_or_else(|| format!("expected a number, found {text:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::delimited;

    fn table(text: &str) -> PointTable {
        read(&delimited::read(text).unwrap()).unwrap().unwrap()
    }

    fn refusal(text: &str) -> String {
        read(&delimited::read(text).unwrap()).unwrap_err()
    }

    fn position(table: &PointTable, number: usize) -> [f64; 3] {
        table.points[number].position.clone().unwrap()
    }

    #[test]
    fn columns_stand_in_any_order() {
        let read = table("remark,Z [in],X [in],Y [in],Point\nok,3,1,2.5,lca_front\n");
        assert_eq!(position(&read, 0), [1.0, 2.5, 3.0]);
        assert_eq!(
            (read.points[0].name.as_str(), read.unit),
            ("lca_front", Some(LengthUnit::Inch))
        );
    }

    #[test]
    fn a_table_may_have_no_header() {
        let read = table("a,1,2,3\nb,4,5,6\n");
        assert_eq!((position(&read, 1), read.notes.len()), ([4.0, 5.0, 6.0], 1));
    }

    #[test]
    fn sides_stand_in_names_columns_titles_and_headers() {
        let by_name = table("name,x,y,z\nlbj_l,1,2,3\nlbj_r,1,-2,3\n");
        let by_column = table("name,side,x,y,z\nlbj,left,1,2,3\nlbj,R,1,-2,3\n");
        let by_title = table("name,x,y,z\nLeft wheel\nlbj,1,2,3\nRight wheel\nlbj,1,-2,3\n");
        let by_header = table(",Left,,,Right,,\nname,x,y,z,x,y,z\nlbj,1,2,3,1,-2,3\n");
        for read in [by_name, by_column, by_title, by_header] {
            let sides: Vec<_> = read.points.iter().map(|point| point.side).collect();
            assert_eq!(sides, [Some(Side::Left), Some(Side::Right)], "{read:?}");
            assert_eq!(position(&read, 1), [1.0, -2.0, 3.0]);
        }
    }

    #[test]
    fn decimal_commas_are_read_where_they_are_certain() {
        let read = table("name;x;y;z\na;120,5;360,25;-0,5\n");
        assert_eq!(position(&read, 0), [120.5, 360.25, -0.5]);
        // All with three digits: the table is written so.
        assert_eq!(
            position(&table("n;x;y;z\na;1,250;0,500;0,000\n"), 0),
            [1.25, 0.5, 0.0]
        );
        assert!(refusal("name;x;y;z\na;120,5;360.25;1\n").contains("commas and points are mixed"));
        assert!(refusal("name;x;y;z\na;1,250;360;1\n").contains("may be a decimal or a thousand"));
    }

    #[test]
    fn what_is_no_number_is_named_with_its_place() {
        let read = table("name,x,y,z\na,1,2,3\nb,1,,3\nc,1,inf,3\nd,1,2 mm,3\n");
        let fault = |n: usize| read.points[n].position.clone().unwrap_err();
        assert_eq!(fault(1), "line 3, column 3: the cell is empty");
        assert_eq!(
            fault(2),
            "line 4, column 3: expected a number, found \"inf\""
        );
        assert!(fault(3).contains("found \"2 mm\""));
    }

    #[test]
    fn figures_stand_among_points() {
        let read = table("name,x,y,z\na,1,2,3\nwheel radius,300,,\nstatic_camber,-0.5,,\n");
        let figures: Vec<f64> = read.figures.iter().map(|(_, value, _)| *value).collect();
        assert_eq!((figures, read.points.len()), (vec![300.0, -0.5], 1));
    }

    #[test]
    fn contradictions_are_refused() {
        assert!(refusal("name,x [mm],y [in],z\na,1,2,3\n").contains("different units"));
        assert!(refusal("name,x,y,z,x,y,z\na,1,2,3,4,5,6\n").contains("2 sets of x, y and z"));
    }
}

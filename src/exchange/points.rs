//! Rows of a table: named points, values, and titles that give the wheel or axle of the rows below them.

mod names_beside;
mod surplus;
mod unit_line;
mod values;

use super::angle_unit::{is_unit, of_line};
use super::axes::Declared;
use super::cell::{Cell, Sheet};
use super::decimals::{Decimals, plain_number};
use super::figure_names::{FigureKind, figure};
use super::header::{self, Columns, Triple, header, text};
use super::names::{KNOWN_MARKS, cut, marks_of_entry, marks_of_title, side_of};
use super::table::{Figure, Marks, NamedPoint, PointTable, StatedMarks};
use super::unit::{FileUnit, KNOWN_UNITS};
use crate::report::unit_in_words;
use unit_line::{unit_above, unit_below, unit_row, unknown_above, without_brackets};
use values::has_digit;

/// Reads the points of a table. `None` if it has no points.
pub(super) fn read(sheet: &Sheet) -> Result<Option<PointTable>, String> {
    let rows = sheet.rows();
    let mut table = PointTable::default();
    // Each header applies to the rows below it.
    let mut headers: Vec<(u32, Columns)> = Vec::new();
    for (number, row) in rows.iter().enumerate() {
        let above = number.checked_sub(1).map(|above| rows[above]);
        if let Some(found) = header(sheet, *row, above)? {
            let place = sheet.row_place(*row);
            if let Some(unit) = found.unit {
                table.state_unit(unit, &place)?;
            }
            table.declare(found.declared, &place)?;
            names_beside::refuse(sheet, *row, &found.columns)?;
            if let Some(doubt) = found.doubt {
                table.notes.doubt(doubt);
            }
            headers.push((*row, found.columns));
        }
    }
    let has_header = !headers.is_empty();
    if !has_header {
        if let Some(columns) = header::without_header(sheet, &rows) {
            let note = "no header names the columns: they are read as name, x, y, z".to_owned();
            table.notes.push(note);
            headers.push((0, columns));
        }
        let unknown = |row: &u32| {
            let words = header::unknown_beside_axes(sheet, *row)?;
            Some((*row, words))
        };
        if let Some((row, words)) = rows.iter().find_map(unknown) {
            let place = sheet.row_place(row);
            table.unknown_unit = Some(format!(
                "{place}: the header of x, y and z has the words {words:?}, which are not known"
            ));
        }
    }
    let Some((_, first)) = headers.first() else {
        return Ok(None);
    };
    let decimals = Decimals::of(sheet, &headers)?;
    table.unit = agreed(table.unit, decimals.unit)?;
    let mut reader = Rows {
        sheet,
        decimals,
        columns: (!has_header).then(|| first.clone()),
        last_title: None,
        section: Marks::default(),
        nameless: Vec::new(),
        table,
    };
    let mut next = headers.iter().filter(|_| has_header).peekable();
    for row in &rows {
        let Some((_, columns)) = next.next_if(|(header, _)| header == row) else {
            reader.row(*row)?;
            continue;
        };
        reader.last_title = sheet.row(*row).map(|(column, _)| column).max();
        reader.columns = Some(columns.clone());
        // If a table has several sets of coordinates, a title above belongs to the columns of one set, not to the
        // rows below.
        if columns.triples.len() > 1 {
            reader.section = Marks::default();
        }
    }
    reader.list_nameless();
    let table = reader.table;
    if table.points.iter().all(|point| point.position.is_err()) {
        return Ok(None);
    }
    Ok(Some(table))
}

/// Returns the unit of length from the header, or else from the cells of the coordinates. Refuses two different units.
fn agreed(header: Option<FileUnit>, cells: Option<FileUnit>) -> Result<Option<FileUnit>, String> {
    match (header, cells) {
        (Some(stated), Some(own)) if stated != own => Err(format!(
            "the coordinates are marked as {}, but the header states {}",
            unit_in_words(own.symbol),
            unit_in_words(stated.symbol)
        )),
        _ => Ok(header.or(cells)),
    }
}

/// Reader of a table's rows, in their order.
struct Rows<'a> {
    sheet: &'a Sheet,
    decimals: Decimals,
    columns: Option<Columns>,
    /// Index of the last column with a title.
    last_title: Option<u32>,
    /// Wheel and axle that the last title row names. They apply to the rows below it.
    section: Marks,
    /// Indices of the rows with coordinates but without a name.
    nameless: Vec<u32>,
    table: PointTable,
}

impl Rows<'_> {
    fn row(&mut self, row: u32) -> Result<(), String> {
        let sheet = self.sheet;
        let texts: Vec<&str> = sheet.row(row).filter_map(|(_, cell)| text(cell)).collect();
        let has_number = sheet
            .row(row)
            .any(|(_, cell)| self.decimals.is_number(cell));
        let Some(columns) = self.columns.clone() else {
            if !self.value_beside(row, |name| figure(name).is_some()) {
                self.value_missing(row);
            }
            return self.title(row, &texts, true);
        };
        let triples = columns.triples.iter();
        let numbers: Vec<[Option<&Cell>; 3]> = triples
            .map(|triple| triple.columns.map(|column| sheet.cell(row, column)))
            .collect();
        let filled = numbers.iter().flatten().flatten().count();
        if let Some(words) = unit_row(&numbers) {
            return words.into_iter().try_for_each(|word| self.unit(row, word));
        }
        if !has_number && self.line(row, &texts)? {
            return Ok(());
        }
        let own_name = sheet.cell(row, columns.name);
        let decimals = self.decimals;
        let is_number = |cell: &Cell| decimals.is_number(cell);
        if (filled == 0 || own_name.is_some_and(is_number))
            && self.value_beside(row, |name| marks_of_title(name).is_none())
        {
            return Ok(());
        }
        let own_name = own_name.and_then(text);
        // Files write values of the wheel in the first column, even if another column has the names of points.
        let first = texts.first().copied().filter(|text| figure(text).is_some());
        let Some(name) = own_name.or(first.filter(|_| has_number)) else {
            if !has_number {
                return self.title(row, &texts, false);
            }
            let is_point =
                |cells: &[Option<&Cell>; 3]| cells.iter().all(|c| c.is_some_and(is_number));
            if numbers.iter().any(is_point) {
                self.nameless.push(row);
            }
            return Ok(());
        };
        let is_line = !has_number && figure(name).is_none() && of_line(&texts).is_some();
        if filled == 0 || is_line {
            return self.title(row, &texts, false);
        }
        if !has_number
            && cut(name)
                .iter()
                .any(|word| word == "name" || word == "names")
        {
            // This row is a heading, such as "Point Name | Left | | | | Right".
            return Ok(());
        }
        if !has_number && self.attachment(&texts) {
            return Ok(());
        }
        self.named_row(row, name, &columns, &numbers)
    }

    /// Reads a line about the whole table, in a row without numbers. Returns false for other rows.
    fn line(&mut self, row: u32, texts: &[&str]) -> Result<bool, String> {
        // The lines above the first point of a table without a header state units and axes, as above a header.
        let is_above = self.last_title.is_none() && self.table.points.is_empty();
        if let Some(unit) = unit_below(texts) {
            let place = self.sheet.row_place(row);
            self.table.state_unit(unit, &place)?;
        } else if is_above && texts.len() < 4 {
            self.value_missing(row);
        } else {
            return Ok(false);
        }
        self.title(row, texts, is_above)?;
        Ok(true)
    }

    /// Adds the points or the values of a row with a name.
    fn named_row(
        &mut self,
        row: u32,
        name: &str,
        columns: &Columns,
        numbers: &[[Option<&Cell>; 3]],
    ) -> Result<(), String> {
        self.check_decimals(row)?;
        self.frame(row, columns)?;
        let stated = self.marks(row, columns)?;
        let decimals = self.decimals;
        let is_number = |cell: &Cell| decimals.is_number(cell);
        let alone = |cells: &[Option<&Cell>; 3]| {
            cells.iter().flatten().count() <= 1
                && (cells[0].is_some() || cells.iter().all(Option::is_none))
        };
        let count = |cells: &[Option<&Cell>; 3]| {
            let cells = cells.iter().flatten();
            cells.filter(|cell| is_number(cell)).count()
        };
        let most = numbers.iter().map(count).max().unwrap_or(0);
        let is_figure = figure(name).is_some_and(|(kind, ..)| kind != FigureKind::ContactPoint);
        let has_unit = |cells: &[Option<&Cell>; 3]| {
            let is_first = cells[0].is_none_or(is_number);
            let unit = cells[1..].iter().flatten().next();
            is_first && unit.is_none_or(|cell| text(cell).is_some_and(is_unit))
        };
        let is_value = is_figure || numbers.iter().all(has_unit);
        if numbers.iter().all(alone) || (is_value && most == 1) {
            return self.figures(row, name, columns, numbers, stated.marks);
        }
        if is_figure && most == 2 {
            let place = self.sheet.row_place(row);
            let line = format!("{name} ({place}): the row has two numbers; expected one");
            self.table.left_out.push(line);
            return Ok(());
        }
        self.points(row, name, columns, numbers, stated)
    }

    /// Adds the points of a row, one for each set of x, y and z columns with numbers. `stated` has the wheel and the axle from the
    /// cells of the row.
    fn points(
        &mut self,
        row: u32,
        name: &str,
        columns: &Columns,
        numbers: &[[Option<&Cell>; 3]],
        stated: StatedMarks,
    ) -> Result<(), String> {
        let sheet = self.sheet;
        let unit = columns.unit.and_then(|column| sheet.cell(row, column));
        if let Some(word) = unit.and_then(text) {
            self.unit(row, word)?;
        }
        for (triple, cells) in columns.triples.iter().zip(numbers) {
            if cells.iter().all(Option::is_none) {
                continue;
            }
            let marks = triple.marks.or(stated.marks);
            let mut marks = marks.or(self.of_section(name));
            if stated.mirrored {
                marks.side = None;
            }
            let body = columns.body.and_then(|column| sheet.cell(row, column));
            self.table.points.push(NamedPoint {
                name: name.to_owned(),
                read_as: name.to_owned(),
                marks,
                mirrored: stated.mirrored,
                has_number: cells.iter().copied().flatten().any(has_digit),
                position: self.position(row, triple, cells),
                body: body.and_then(text).map(str::to_owned),
                place: sheet.row_place(row),
            });
        }
        Ok(())
    }

    /// Lists rows with coordinates but without a name.
    fn list_nameless(&mut self) {
        if let [first, others @ ..] = &self.nameless[..] {
            let more = match others.len() {
                0 => String::new(),
                count => format!(" and {count} more"),
            };
            let place = self.sheet.row_place(*first);
            self.table
                .left_out
                .push(format!("{place}{more}: coordinates without a name"));
        }
    }

    /// Wheel and axle of the section (the rows below a title) to which the row with this name belongs. The wheel is left out if the
    /// name states a side.
    fn of_section(&self, name: &str) -> Marks {
        let words = cut(name);
        let ends = [words.first(), words.last()];
        let says_side = words.len() > 1
            && ends
                .into_iter()
                .flatten()
                .any(|word| word != "r" && side_of(word).is_some());
        Marks {
            side: self.section.side.filter(|_| !says_side),
            axle: self.section.axle,
        }
    }

    /// Reads a row without numbers: a title, a line with the unit of angles or, above the points, a line with the unit or the axes.
    fn title(&mut self, row: u32, texts: &[&str], is_above: bool) -> Result<(), String> {
        let marks = texts.iter().filter_map(|text| marks_of_title(text));
        let marks = marks.fold(Marks::default(), Marks::or);
        if !marks.is_empty() {
            // The title of an axle starts a new section.
            self.section = match marks.axle {
                Some(_) => marks,
                None => marks.or(self.section),
            };
        }
        if texts.iter().all(|text| figure(text).is_none()) {
            self.table.angle_unit = of_line(texts).or(self.table.angle_unit);
        }
        if !is_above {
            return Ok(());
        }
        let place = self.sheet.row_place(row);
        for line in texts {
            self.table.declare(Declared::in_text(line), &place)?;
        }
        if self.table.unit.is_none() {
            self.table.unit = unit_above(texts);
        }
        if let (None, Some(unknown)) = (&self.table.unknown_unit, unknown_above(texts)) {
            self.table.unknown_unit = Some(format!("{place}: the unit is {unknown:?}"));
        }
        Ok(())
    }

    /// Reads the unit of a cell: in a row of units below the header, or in a column of units.
    fn unit(&mut self, row: u32, word: &str) -> Result<(), String> {
        let place = self.sheet.row_place(row);
        let found = FileUnit::named(without_brackets(word))
            .ok_or_else(|| format!("{place}: the unit is {word:?}; expected {KNOWN_UNITS}"))?;
        self.table.state_unit(found, &place)
    }

    /// Reads a row that names the part on which the point of another row is mounted, as in OptimumKinematics.
    fn attachment(&mut self, texts: &[&str]) -> bool {
        let mut mounted = texts.iter().filter(|text| text.starts_with("NSMA_"));
        let (Some(point), Some(part)) = (mounted.next(), texts.last()) else {
            return false;
        };
        for known in &mut self.table.points {
            if known.name == **point && part != point {
                known.body = Some((*part).to_owned());
            }
        }
        true
    }

    /// Reads the axes in a cell of a frame column.
    fn frame(&mut self, row: u32, columns: &Columns) -> Result<(), String> {
        let Some(column) = columns.frame else {
            return Ok(());
        };
        let Some(cell) = self.sheet.cell(row, column) else {
            return Ok(());
        };
        let place = self.sheet.place(row, column);
        let Some(declared) = text(cell).and_then(Declared::named) else {
            return Err(format!(
                "{place}: the frame is {}; expected iso8855, sae_j670 or x_rear",
                shown(cell)
            ));
        };
        if self.table.declared.and(declared, &place).is_err() {
            return Err(format!("{place}: the frame changes within the table"));
        }
        self.table.declared = declared;
        Ok(())
    }

    /// Wheel and axle in the cells of a row.
    fn marks(&self, row: u32, columns: &Columns) -> Result<StatedMarks, String> {
        let mut stated = StatedMarks::default();
        for column in &columns.marks {
            let Some(cell) = self.sheet.cell(row, *column) else {
                continue;
            };
            let found = text(cell).and_then(marks_of_entry).ok_or_else(|| {
                format!(
                    "{}: the wheel or axle is {}; expected {KNOWN_MARKS}",
                    self.sheet.place(row, *column),
                    shown(cell)
                )
            })?;
            stated.add(found);
        }
        Ok(stated)
    }

    fn position(
        &self,
        row: u32,
        triple: &Triple,
        cells: &[Option<&Cell>],
    ) -> Result<[f64; 3], String> {
        let mut position = [0.0; 3];
        for ((coordinate, cell), column) in position.iter_mut().zip(cells).zip(triple.columns) {
            let at = |reason: &str| format!("{}: {reason}", self.sheet.place(row, column));
            let cell = cell.ok_or_else(|| at("the cell is empty"))?;
            *coordinate = self.decimals.number(cell).map_err(|reason| at(&reason))?;
        }
        Ok(position)
    }
}

/// Text of a cell for messages.
fn shown(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => format!("{text:?}"),
        Cell::Number(number) => number.to_string(),
        Cell::Unusable(what) => what.clone(),
    }
}

#[cfg(test)]
mod tests;

//! Values of the wheel among the rows of a table, for example its radius or its camber.

use super::super::decimals::unit_in;
use super::unit_line::without_brackets;
use super::{Cell, Columns, Figure, FigureKind, Marks, Rows, figure, is_unit, plain_number, text};

impl Rows<'_> {
    /// Adds the value of a row without coordinates, if its first cell is a name and its second cell is the only number, as in
    /// `Loaded radius, 310, mm`. Returns false for any other row, and for a name that `is_of_value` rejects.
    pub(super) fn value_beside(&mut self, row: u32, is_of_value: impl Fn(&str) -> bool) -> bool {
        let sheet = self.sheet;
        let mut cells = sheet.row(row).map(|(_, cell)| cell);
        let (Some(Cell::Text(name)), Some(cell)) = (cells.next(), cells.next()) else {
            return false;
        };
        let is_name = plain_number(name, true).is_err() && is_of_value(name);
        let (Ok(value), true) = (self.decimals.number(cell), is_name) else {
            return false;
        };
        let rest: Vec<&Cell> = cells.collect();
        if rest.iter().any(|cell| self.decimals.is_number(cell)) {
            return false;
        }
        let texts = rest.into_iter().filter_map(text);
        let place = sheet.row_place(row);
        let (units, words): (Vec<&str>, Vec<&str>) = texts.partition(|text| is_unit(text));
        let own = unit_in(cell).map(|unit| unit.symbol);
        self.table.figures.push(Figure {
            name: name.clone(),
            read_as: with_units(name, own.into_iter().chain(units)),
            value,
            marks: self.of_section(name),
            remark: words.join(" "),
            place,
        });
        true
    }

    /// Lists a value of the wheel whose row has a digit but not exactly one number, such as `Loaded radius, about 310`.
    pub(super) fn value_missing(&mut self, row: u32) {
        let mut cells = self.sheet.row(row).map(|(_, cell)| cell);
        let name = cells.next().and_then(text);
        let is_value =
            |name: &&str| figure(name).is_some_and(|(kind, ..)| kind != FigureKind::ContactPoint);
        let Some(name) = name.filter(is_value) else {
            return;
        };
        if cells.any(has_digit) {
            let place = self.sheet.row_place(row);
            let line = format!("{name} ({place}): expected one number in a cell of its own");
            self.table.left_out.push(line);
        }
    }

    /// Adds the values of a row, one for each set of x, y and z columns.
    pub(super) fn figures(
        &mut self,
        row: u32,
        name: &str,
        columns: &Columns,
        numbers: &[[Option<&Cell>; 3]],
        marks: Marks,
    ) -> Result<(), String> {
        let place = self.sheet.row_place(row);
        let used = |column: u32| {
            column == columns.name
                || columns.marks.contains(&column)
                || columns.triples.iter().any(|t| t.columns.contains(&column))
        };
        let remarks = self.sheet.row(row).filter(|(column, _)| !used(*column));
        let remark: Vec<&str> = remarks.filter_map(|(_, cell)| text(cell)).collect();
        let section = self.of_section(name);
        for (triple, cells) in columns.triples.iter().zip(numbers) {
            let is_number = |cell: &&Cell| self.decimals.is_number(cell);
            let filled = || cells.iter().flatten().copied();
            let Some(cell) = filled().find(is_number).or(filled().next()) else {
                continue;
            };
            let value = match self.decimals.number(cell) {
                Ok(value) => value,
                // A text such as "Tyre: 205/55 R16" is not a value that the importer uses.
                Err(_) if figure(name).is_none() => continue,
                Err(reason) => return Err(format!("{place}: {reason}")),
            };
            // If only one group of columns has cells in this row, the value applies to both wheels. So the wheel in the
            // title of this group is ignored. A wheel that the row or its section states remains valid.
            let is_alone = numbers
                .iter()
                .filter(|cells| cells.iter().any(Option::is_some))
                .count()
                == 1;
            // A unit in its own cell counts as if it were written after the name.
            let beside = filled().filter(|cell| !is_number(cell)).filter_map(text);
            let beside: Vec<&str> = beside.collect();
            let own = beside.iter().copied().filter(|text| is_unit(text));
            let after = remark.iter().copied();
            let after = after.filter(|text| is_unit(text) && without_brackets(text) != "in");
            let in_cell = unit_in(cell).map(|unit| unit.symbol).into_iter();
            let read_as = with_units(name, in_cell.chain(own).chain(after));
            let words = beside.iter().copied().filter(|text| !is_unit(text));
            let remark: Vec<&str> = words.chain(remark.iter().copied()).collect();
            let of_columns = if is_alone {
                Marks::default()
            } else {
                triple.marks
            };
            let marks = of_columns.or(marks).or(section);
            self.table.figures.push(Figure {
                name: name.to_owned(),
                read_as,
                value,
                marks,
                remark: remark.join(" "),
                place: place.clone(),
            });
        }
        Ok(())
    }
}

/// True if a cell is a number or a text with a digit, such as "about 205".
pub(super) fn has_digit(cell: &Cell) -> bool {
    match cell {
        Cell::Number(_) => true,
        Cell::Text(text) => text.contains(|c: char| c.is_ascii_digit()),
        Cell::Unusable(_) => false,
    }
}

/// Name of a value, with its units after it as in `toe [deg]`.
fn with_units<'t>(name: &str, units: impl IntoIterator<Item = &'t str>) -> String {
    let units = units.into_iter().map(without_brackets);
    units.fold(name.to_owned(), |name, unit| format!("{name} [{unit}]"))
}

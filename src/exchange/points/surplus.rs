//! Rows with more numbers than the table has column titles.

use super::Rows;

impl Rows<'_> {
    /// Refuses a row that has more numbers than the table has column titles, if a comma in it is probably not a separator. The
    /// comma may be the decimal sign, or may group the digits of a number.
    pub(super) fn check_decimals(&self, row: u32) -> Result<(), String> {
        let Some(last) = self.last_title else {
            return Ok(());
        };
        let cells = self.sheet.row(row);
        let numbers = cells.filter_map(|(column, cell)| {
            let number = self.decimals.number(cell).ok()?;
            Some((column, number))
        });
        let numbers: Vec<(u32, f64)> = numbers.collect();
        let surplus = numbers.iter().filter(|(column, _)| *column > last).count();
        // If commas separate the cells, "1,130.5" is read as two numbers: 1 and 130.5.
        let mut pairs = numbers.windows(2).map(|pair| [pair[0].1, pair[1].1]);
        let groups = |[left, right]: [f64; 2]| {
            left != 0.0 && left.fract() == 0.0 && left.abs() < 1e3 && (0.0..1e3).contains(&right)
        };
        if surplus == 1 && pairs.any(groups) && !self.is_usual_beyond(last) {
            return Err(format!(
                "{}: one number has no column title. If a comma groups the digits of a number (1,130), remove it",
                self.sheet.row_place(row)
            ));
        }
        if surplus < 2 || numbers.iter().any(|(_, number)| number.fract() != 0.0) {
            return Ok(());
        }
        Err(format!(
            "{}: {surplus} numbers have no column title. If the decimal sign is a comma, separate \
             the cells by semicolons",
            self.sheet.row_place(row)
        ))
    }

    /// True if most of the first rows with numbers also have a number beyond the last title. Then the sheet has a column without a
    /// title.
    fn is_usual_beyond(&self, last: u32) -> bool {
        const EXAMINED: usize = 100;
        let (mut rows, mut beyond) = (0, 0);
        let next = |from: u32| {
            let mut cells = self.sheet.cells.range((from, 0)..);
            cells.next().map(|((row, _), _)| *row)
        };
        let first = std::iter::successors(next(0), |row| next(row.checked_add(1)?));
        for row in first.take(EXAMINED) {
            let columns = self.sheet.row(row);
            let columns = columns.filter(|(_, cell)| self.decimals.is_number(cell));
            let columns: Vec<u32> = columns.map(|(column, _)| column).collect();
            rows += usize::from(columns.len() > 2);
            beyond += usize::from(columns.iter().any(|column| *column > last));
        }
        2 * beyond > rows
    }
}

//! Layout of a table for people: widths of columns, and lines.

use super::super::text::{broken, widest};
use super::cell::Cell;

/// Layout of a column.
pub(super) struct Layout {
    /// True if the cells of the column are aligned to the right.
    to_the_right: bool,
    /// True if some cell of the column has several words.
    pub(super) prose: bool,
    /// Width of the column without line breaks, in characters.
    pub(super) natural: usize,
    /// Smallest width of the column, in characters. Numbers and short names are never broken; names longer than half of the line
    /// may be broken.
    pub(super) least: usize,
}

/// Smallest width of a column with texts, in characters.
const LEAST: usize = 14;

impl Layout {
    pub(super) fn of<'a>(
        header: &str,
        cells: impl Iterator<Item = &'a Cell> + Clone,
        first: bool,
        width: usize,
    ) -> Self {
        let shown = cells.clone().map(|cell| cell.text().chars().count());
        let longest = shown.max().unwrap_or(0);
        let natural = longest.max(header.chars().count());
        let prose = cells.clone().any(|cell| cell.text().contains(' '));
        let mut cells = cells.filter(|cell| !cell.text().is_empty());
        let numbers = cells.all(Cell::is_number);
        let whole = |name: &str| {
            if name.contains(' ') {
                widest(name)
            } else {
                name.chars().count()
            }
        };
        let fits = |length: usize| 2 * length + 4 <= width;
        let words = cells.clone().flat_map(|cell| cell.text().split(' '));
        let longest_word = words.map(|word| word.chars().count()).max().unwrap_or(0);
        Layout {
            to_the_right: numbers && !first,
            prose,
            natural,
            least: match (numbers, prose) {
                (true, _) if fits(whole(header)) => longest.max(whole(header)).min(natural),
                (true, _) => longest.max(widest(header)).min(natural),
                (false, false) if fits(natural) => natural,
                (false, true) if fits(longest_word) => natural.min(LEAST.max(longest_word)),
                (false, _) => natural.min(LEAST),
            },
        }
    }
}

/// Splits columns into groups that fit side by side. Each group begins with the first `keys` columns, or with the first column
/// alone if the space is too small.
pub(super) fn pieces(widths: &[usize], width: usize, keys: usize) -> Vec<Vec<usize>> {
    let taken = |keys: usize| widths[..keys].iter().map(|w| w + 2).sum::<usize>();
    let widest = widths.iter().skip(keys).max().unwrap_or(&0);
    let keys = if taken(keys) + widest + 2 <= width {
        keys
    } else {
        1
    };
    let mut pieces = vec![Vec::new()];
    let mut room = 0;
    for (k, own) in widths.iter().enumerate() {
        let piece = pieces.last_mut().expect("the list has an element");
        if room + own + 2 > width && piece.len() > keys {
            pieces.push((0..keys).chain([k]).collect());
            room = taken(keys) + own + 2;
        } else {
            piece.push(k);
            room += own + 2;
        }
    }
    pieces
}

/// Writes a row with as many lines as its cells need.
pub(super) fn line<'a>(
    text: &mut String,
    cells: impl Iterator<Item = (&'a str, usize, &'a Layout)>,
) {
    let cells: Vec<_> = cells
        .map(|(cell, width, l)| (broken(cell, width), width, l))
        .collect();
    let height = cells
        .iter()
        .map(|(lines, ..)| lines.len())
        .max()
        .unwrap_or(0);
    for number in 0..height.max(1) {
        let mut out = String::new();
        for (lines, width, layout) in &cells {
            let cell = lines.get(number).map_or("", String::as_str);
            let padding = " ".repeat(width.saturating_sub(cell.chars().count()));
            out.push_str("  ");
            if layout.to_the_right {
                out.extend([&padding, cell])
            } else {
                out.extend([cell, &padding])
            }
        }
        text.push_str(out.trim_end());
        text.push('\n');
    }
}

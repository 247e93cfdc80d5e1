//! Tables in a page.

use super::charts::attribute;
use super::escape::html;
use crate::report::table::{Cell, Table};
use crate::report::with_minus_signs;

/// Table as HTML. Each row gets the CSS class that `class` returns for it.
pub(super) fn table(table: &Table, class: impl Fn(usize) -> Option<&'static str>) -> String {
    written(table, class, "table")
}

/// Table for many columns or long texts. On a narrow page each row is a block, with the names of the columns.
pub(super) fn stacked(table: &Table) -> String {
    written(table, |_| None, "table stacked")
}

fn written(table: &Table, class: impl Fn(usize) -> Option<&'static str>, kind: &str) -> String {
    let header = table.header();
    let names = |k: usize| match kind {
        "table" => None,
        _ => header.get(k).copied(),
    };
    let heads: String = header.iter().map(|title| head(title)).collect();
    let body: String = table
        .rows()
        .enumerate()
        .map(|(number, cells)| {
            if table.is_heading(number) {
                return heading(&cells);
            }
            let class = class(number).map_or_else(String::new, |c| format!(" class=\"{c}\""));
            let cells = cells.into_iter().enumerate();
            let cells: String = cells.map(|(k, own)| cell(own, names(k))).collect();
            format!("<tr{class}>{cells}</tr>")
        })
        .collect();
    format!(
        r#"<div class="{kind}" tabindex="0" role="group"><table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table></div>"#
    )
}

/// HTML of a row that is a heading for the rows below it. The first cell has its title.
fn heading(cells: &[&Cell]) -> String {
    format!(
        "<tr class=\"group\"><th scope=\"rowgroup\" colspan=\"{}\">{}</th></tr>",
        cells.len(),
        breakable(cells.first().map_or("", |title| title.text()))
    )
}

impl Table {
    /// The table as HTML.
    pub(super) fn html(&self) -> String {
        table(self, |_| None)
    }
}

fn head(title: &str) -> String {
    format!(r#"<th scope="col">{}</th>"#, breakable(title))
}

/// HTML of a cell. On a narrow page, the name of the column is beside the value.
fn cell(cell: &Cell, column: Option<&str>) -> String {
    let column = column.map_or_else(String::new, |name| attribute("data-head", name));
    let class = if cell.is_number() {
        " class=\"number\""
    } else {
        ""
    };
    format!(
        "<td{class}{column}>{}</td>",
        breakable(&with_minus_signs(cell.text()))
    )
}

/// Text as HTML. A line may break after an underscore.
pub(super) fn breakable(cell: &str) -> String {
    html(cell).replace('_', "_<wbr>")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of values may have only its first cell filled. It is not a heading.
    #[test]
    fn only_marked_rows_are_headings() {
        let mut table = Table::new(["quantity", "value", "unit"]);
        table.push_heading("lateral force");
        table.push(["toe", "", ""]);
        let html = table.html();
        assert_eq!(html.matches("class=\"group\"").count(), 1, "{html}");
        assert!(html.contains("colspan=\"3\">lateral force</th>"), "{html}");
        assert!(html.contains("<td>toe</td><td></td><td></td>"), "{html}");
    }
}

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
            if let Some(title) = group(&cells) {
                return title;
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

/// HTML of a heading for the rows below it. A row with at least three cells is a heading if only its first cell has a text. `None`
/// for any other row.
fn group(cells: &[&Cell]) -> Option<String> {
    let [title, others @ ..] = cells else {
        return None;
    };
    let is_group = others.len() > 1
        && !title.text().is_empty()
        && others.iter().all(|cell| cell.text().is_empty());
    is_group.then(|| {
        format!(
            "<tr class=\"group\"><th scope=\"rowgroup\" colspan=\"{}\">{}</th></tr>",
            cells.len(),
            breakable(title.text())
        )
    })
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

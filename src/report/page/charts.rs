//! Charts of a page. Each one is an SVG in a figure, with data for the crosshair.

use super::escape::html;
use crate::report::chart::{Chart, Layout};
use crate::report::curve_table::CurveTable;

/// Charts of a page, and the tables with their data.
#[derive(Default)]
pub(super) struct Charts {
    /// Tables with the numbers of all charts.
    pub tables: Vec<CurveTable>,
    /// Layouts of the charts, in the order of their figures on the page.
    pub layouts: Vec<Layout>,
}

impl Charts {
    /// Adds a chart to the page. Returns its figure as HTML, with these attributes and these remarks.
    pub(super) fn figure(&mut self, chart: Chart, attributes: &str, remarks: &str) -> String {
        let layout = chart.layout(&self.tables);
        let number = self.layouts.len();
        let figure = format!(
            "<figure class=\"chart\" data-chart=\"{number}\"{attributes}>{}<output class=\"readout\" aria-live=\"off\"></output>{remarks}</figure>\n",
            layout.element()
        );
        self.layouts.push(layout);
        figure
    }
}

/// HTML text of an attribute with its name and value.
pub(super) fn attribute(name: &str, value: &str) -> String {
    format!(" {name}=\"{}\"", html(value))
}

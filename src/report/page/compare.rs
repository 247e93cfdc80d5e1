//! The page of a comparison.

use super::Page;
use super::escape::html;
use crate::report::comparison::Comparison;

/// The page's own script.
const GLUE: &str = concat!(
    "'use strict';\n(() => {\n",
    include_str!("display.js"),
    include_str!("theme.js"),
    include_str!("compare.js"),
    "})();\n"
);

/// The page of several designs over each other. `topologies` are theirs, each once.
pub fn comparison_page(comparison: &Comparison, topologies: &[String], files: &[String]) -> String {
    let partial: String = comparison
        .partial
        .iter()
        .map(|(column, labels)| format!("<li>{}: {}</li>", html(column), html(&labels.join(", "))))
        .collect();
    let partial = match partial.is_empty() {
        true => partial,
        false => format!(
            "<p>Outputs that not all designs have, with those that do:</p><ul>{partial}</ul>"
        ),
    };
    let moved = comparison.moved_table();
    let moved = match moved.is_empty() {
        true => "<p>No point of the same name is somewhere else.</p>".to_owned(),
        false => moved.html(),
    };
    let main = format!(
        include_str!("compare.html"),
        figures = comparison.table().html(),
        partial = partial,
        moved = moved,
    );
    let page = Page {
        study: &comparison.labels.join(" · "),
        about: format!(
            "{}, compare · hardpoint {}",
            topologies.join(", ").replace('_', " "),
            env!("CARGO_PKG_VERSION")
        ),
        facts: vec![
            ("Designs", comparison.labels.len().to_string()),
            ("Common stations", comparison.stations.len().to_string()),
        ],
        remarks: String::new(),
        sections: vec![
            ("curves", "Curves"),
            ("figures", "Figures"),
            ("hardpoints", "Hardpoints"),
        ],
        controls: include_str!("compare_controls.html"),
        main,
        files,
        data: comparison,
        glue: GLUE,
    };
    page.html()
}

//! The page of a comparison.

use super::charts::{Charts, attribute};
use super::escape::html;
use super::{Page, STAGE};
use crate::report::chart::{
    Chart, Family, Layout, Line, Quantity, Source, families, hue, in_words, told_apart,
};
use crate::report::comparison::Comparison;
use crate::report::curve_table::CurveTable;
use crate::report::record::Record;
use serde::Serialize;

/// Parts of the page's own script.
const SCRIPTS: [&str; 5] = [
    include_str!("base.js"),
    include_str!("chart.js"),
    include_str!("mechanism.js"),
    include_str!("theme.js"),
    include_str!("compare.js"),
];

/// Data that the page's script reads.
#[derive(Serialize)]
struct Data<'a> {
    record: Option<&'a Record>,
    curves: &'a [CurveTable],
    charts: &'a [Layout],
}

/// Values that a chart shows: the curves of the designs, or their differences from the first design.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Curves,
    Differences,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Kind::Curves => "curves",
            Kind::Differences => "differences",
        }
    }
}

/// Charts of each output over each moving column: curves, and differences from the first design.
fn figures(comparison: &Comparison, moving: &[String], charts: &mut Charts) -> String {
    let designs = comparison.labels.len();
    charts.tables = comparison.tables();
    let mut figures = String::new();
    let names: Vec<&str> = comparison.labels.iter().map(String::as_str).collect();
    let short = told_apart(&names);
    for (title, column, unit) in comparison.compared_columns() {
        for over in moving {
            for kind in [Kind::Curves, Kind::Differences] {
                let first = if kind == Kind::Curves { 0 } else { designs };
                let tables = first..first + designs;
                let mut lines = Vec::new();
                for (design, table) in tables
                    .enumerate()
                    .skip((kind == Kind::Differences) as usize)
                {
                    let apart: Vec<&String> = moving.iter().filter(|m| *m != over).collect();
                    let label = [names[design], &short[design]];
                    let found = lines_of_design(&charts.tables[table], &apart, label, design);
                    let source = |rows| Source {
                        table,
                        x: over.clone(),
                        y: column.to_owned(),
                        rows,
                    };
                    let found = found
                        .into_iter()
                        .filter(|_| charts.tables[table].column(column).is_some());
                    lines.extend(found.map(|(line, rows)| Line {
                        source: source(rows),
                        ..line
                    }));
                }
                if lines.is_empty() {
                    continue;
                }
                let name = match kind {
                    Kind::Curves => title.to_owned(),
                    Kind::Differences => format!("difference of {title}"),
                };
                let chart = Chart {
                    key: format!("{column}_{}", kind.name()),
                    x: Quantity::of_column(over),
                    y: Quantity::new(column, &name, unit),
                    lines,
                    ..Chart::default()
                };
                let mut attributes =
                    attribute("data-over", over) + &attribute("data-kind", kind.name());
                if kind == Kind::Differences || *over != moving[0] {
                    attributes += " hidden";
                }
                let missing: Vec<&str> = (comparison.partial.iter())
                    .filter(|(name, _)| name == column)
                    .flat_map(|(_, having)| {
                        comparison.labels.iter().filter(|l| !having.contains(l))
                    })
                    .map(String::as_str)
                    .collect();
                let remark = if missing.is_empty() {
                    String::new()
                } else {
                    format!("<small>not of {}</small>", html(&missing.join(", ")))
                };
                figures += &charts.figure(chart, &attributes, &remark);
            }
        }
    }
    figures
}

/// Curves of a design, each with its rows of `table`. There is one curve for each value of the second moving coordinate. The caller
/// sets the columns of the axes later. `label` and `short` are the full and the short name of the design.
fn lines_of_design(
    table: &CurveTable,
    apart: &[&String],
    [label, short]: [&str; 2],
    design: usize,
) -> Vec<(Line, Vec<usize>)> {
    let (families, _) = families(apart, table);
    let several = families.len() > 1;
    let line = |family: Family| {
        let told = match (several, apart.first()) {
            (true, Some(name)) => format!("{label}, {}", in_words(name, family.place)),
            _ => label.to_owned(),
        };
        let stroke = if family.is_present { "strong" } else { "faint" };
        let line = Line {
            label: family.is_present.then(|| short.to_owned()),
            told,
            class: format!("{} {stroke}", hue(design)),
            is_main: family.is_present,
            in_strip: family.is_present,
            has_dots: false,
            source: Source::default(),
        };
        (line, family.rows)
    };
    families.into_iter().map(line).collect()
}

/// Legend: colours of the designs, with their full names.
fn key(labels: &[String]) -> String {
    let item = |(design, label): (usize, &String)| {
        format!("<li><i class=\"{}\"></i>{}</li>", hue(design), html(label))
    };
    labels.iter().enumerate().map(item).collect()
}

/// Control that selects the horizontal axis of the charts.
fn controls(moving: &[String]) -> String {
    let option = |column: &String| {
        let title = Quantity::of_column(column).title();
        format!(
            "<option value=\"{}\">{}</option>",
            html(column),
            html(&title)
        )
    };
    let hidden = if moving.len() < 2 { " hidden" } else { "" };
    format!(
        include_str!("compare_controls.html"),
        options = moving.iter().map(option).collect::<String>(),
        hidden = hidden
    )
}

/// Page that compares several designs.
pub fn comparison_page(comparison: &Comparison, files: &[String]) -> String {
    let partial: String = comparison
        .partial
        .iter()
        .map(|(column, labels)| format!("<li>{}: {}</li>", html(column), html(&labels.join(", "))))
        .collect();
    let partial = if partial.is_empty() {
        partial
    } else {
        format!(
            "<p>Outputs that only some designs have, each with its designs:</p><ul>{partial}</ul>"
        )
    };
    let moved = comparison.moved_table();
    let mut moved = if moved.is_empty() {
        "<p>Points of the same name have the same position.</p>".to_owned()
    } else {
        moved.html()
    };
    for points in comparison.partial_points() {
        moved += &format!("<p>{}</p>", html(&points));
    }
    let moving = comparison.moving_columns();
    let mut charts = Charts::default();
    let figures_of_outputs = figures(comparison, &moving, &mut charts);
    let stage = comparison.mechanisms.as_ref().map_or("", |_| STAGE);
    let mut sections = vec![("curves", "Curves")];
    sections.extend((!stage.is_empty()).then_some(("mechanism", "Mechanism")));
    sections.extend([("figures", "Key values"), ("hardpoints", "Hardpoints")]);
    let main = format!(
        include_str!("compare.html"),
        key = key(&comparison.labels),
        charts = figures_of_outputs,
        stage = stage,
        figures = comparison.table().html(),
        partial = partial,
        moved = moved,
    );
    let page = Page {
        study: &comparison.labels.join(" · "),
        about: format!(
            "{}, compare · hardpoint {}",
            comparison.topologies.join(", ").replace('_', " "),
            env!("CARGO_PKG_VERSION")
        ),
        facts: vec![
            ("Designs", comparison.labels.len().to_string()),
            ("Common stations", comparison.stations.len().to_string()),
        ],
        remarks: String::new(),
        sections,
        controls: &controls(&moving),
        main,
        files,
        data: Data {
            record: comparison.mechanisms.as_ref(),
            curves: &charts.tables,
            charts: &charts.layouts,
        },
        scripts: &SCRIPTS,
    };
    page.html()
}

//! The page of a sweep.

mod columns;

use super::charts::Charts;
use super::escape::{html, prose};
use super::table::stacked;
use super::{Page, STAGE};
use crate::report::chart::{Charted, Layout, chart_groups, charts_over};
use crate::report::curve_table::CurveTable;
use crate::report::figure::brief;
use crate::report::record::Record;
use crate::report::sweep::{OutputSummary, ShownDesigns, SweepRun};
use crate::report::table::{Cell, Table};
use crate::sweep::SweepRecord;
use columns::{Column, columns};
use serde::Serialize;

/// Parts of the page's own script.
const SCRIPTS: [&str; 10] = [
    include_str!("base.js"),
    include_str!("chart.js"),
    include_str!("mechanism.js"),
    include_str!("theme.js"),
    include_str!("measures.js"),
    include_str!("designs.js"),
    include_str!("histogram.js"),
    include_str!("parallel.js"),
    include_str!("effects.js"),
    include_str!("start_sweep.js"),
];

/// Largest number of rows of a table.
const MOST_ROWS: usize = 50;

/// The data that the page's script reads.
#[derive(Serialize)]
struct Data<'a> {
    columns: Vec<Column<'a>>,
    shown: &'a ShownDesigns,
    /// Words before the position of a failure: a drive value, or the number of a load case.
    failed_at: &'static str,
    best: Vec<u64>,
    front: &'a [u64],
    /// Columns that the plots show first.
    first: First,
    effects: &'a [OutputSummary],
    /// Indices of the outputs that no variable changes.
    unmoved: Vec<usize>,
    /// Designs whose curves and mechanism the page shows. The first one is the nominal design, which has no number.
    drawn: Vec<Option<u64>>,
    record: Option<&'a Record>,
    curves: &'a [CurveTable],
    /// Charts of the designs in `drawn`.
    charts: &'a [Layout],
}

/// Columns that the plots show first.
#[derive(Serialize)]
struct First {
    /// Number of variables. Their columns come first.
    variables: usize,
    /// Index of the column of the misfit. `None` without targets.
    misfit: Option<usize>,
    /// Indices of the columns of the deviations from targets.
    deviations: Vec<usize>,
}

/// Page of a sweep.
pub fn sweep_page(run: &SweepRun) -> String {
    let (record, summary) = (&run.record, &run.summary);
    let after_variables = |k: usize| record.variables.len() + k;
    let mut charts = Charts {
        tables: run
            .drawn
            .as_ref()
            .map_or_else(Vec::new, |d| d.curves.clone()),
        layouts: Vec::new(),
    };
    let figures = run
        .drawn
        .as_ref()
        .map_or_else(String::new, |drawn| figures(&drawn.record, &mut charts));
    let data = Data {
        columns: columns(run),
        shown: &run.shown,
        failed_at: if record.is_of_car() {
            "first in case"
        } else {
            "nearest at"
        },
        best: summary.best.iter().map(|d| d.design).collect(),
        front: &run.choice.front,
        first: First {
            variables: record.variables.len(),
            misfit: record.misfit().map(after_variables),
            deviations: record
                .deviations()
                .into_iter()
                .map(after_variables)
                .collect(),
        },
        effects: &summary.outputs,
        unmoved: unmoved(&summary.outputs),
        drawn: run
            .drawn
            .as_ref()
            .map_or_else(Vec::new, |d| d.designs.clone()),
        record: run.drawn.as_ref().map(|d| &d.record),
        curves: &charts.tables,
        charts: &charts.layouts,
    };
    let mut sections = vec![("designs", "Designs"), ("design", "One design")];
    sections.extend((!summary.best.is_empty()).then_some(("best", "Best")));
    sections.push(("effects", "Effects"));
    let page = Page {
        study: &record.study,
        about: about(record),
        facts: facts(run),
        remarks: remarks(run),
        sections,
        controls: "",
        main: format!(
            include_str!("sweep.html"),
            choice = choice(run),
            stage = STAGE,
            figures = figures,
            not_drawn = not_drawn(run),
            best = best(run),
            effects = effects(record),
            outputs = stacked(&summary.outputs_table()),
        ),
        files: &run.files,
        data,
        scripts: &SCRIPTS,
    };
    page.html()
}

/// Charts of the designs in this record. The script shows the nominal design and the selected one.
fn figures(record: &Record, charts: &mut Charts) -> String {
    let mut figures = String::new();
    for group in chart_groups(&record.motion.outputs) {
        let over = record.motion.natural_abscissa(group.column());
        let mut chart = charts_over(Charted::of(record, &[]), &charts.tables, &group, over);
        chart.notes.clear();
        for line in &mut chart.lines {
            line.label = None;
            let is_given = line.source.table == 0;
            line.is_main = line.in_strip && !is_given;
            let colour = if is_given { "given" } else { "chosen strong" };
            line.class = format!("{colour} of-{}", line.source.table);
        }
        figures += &charts.figure(chart, " data-by-design", "");
    }
    figures
}

/// Advice on how to get curves of a design, if the page does not contain them.
fn not_drawn(run: &SweepRun) -> &'static str {
    match &run.drawn {
        Some(_) => {
            "Curves and mechanism are shown for the best designs and some designs of the Pareto \
             front. Without targets, they are shown for designs at the ends of the ranges. \
             <code>hardpoint solve --report</code> draws them for the study of any design."
        }
        None if run.record.is_of_car() => {
            "Load cases have no curves; <code>hardpoint sweep --design N</code> prints the changes of design N, and \
             <code>hardpoint solve --report</code> draws a car."
        }
        None if run.record.is_of_axle() => {
            "The page of a sweep of an axle has no curves; <code>hardpoint solve --report</code> draws them \
             for the study of any design."
        }
        None => {
            "Joined sweeps have no curves here; <code>hardpoint solve --report</code> draws them \
             for the study of any design."
        }
    }
}

/// Indices of the outputs that no variable changes.
fn unmoved(outputs: &[OutputSummary]) -> Vec<usize> {
    let numbered = outputs.iter().enumerate();
    numbered
        .filter(|(_, o)| o.is_unmoved())
        .map(|(k, _)| k)
        .collect()
}

fn about(record: &SweepRecord) -> String {
    let seed = record.seed.map(|seed| format!(", seed {seed}"));
    let stations = if record.is_of_car() {
        "load cases"
    } else {
        "stations"
    };
    format!(
        "{}, sweep by {}{}, {} {stations} · hardpoint {}",
        record.topology.replace('_', " "),
        record.method.replace('_', " "),
        seed.unwrap_or_default(),
        record.stations,
        record.version
    )
}

/// Key values at the top of the page.
fn facts(run: &SweepRun) -> Vec<(&'static str, String)> {
    let summary = &run.summary;
    let class = if summary.solved == summary.done {
        ""
    } else {
        " class=\"bad\""
    };
    let mut facts = Vec::new();
    if let Some(best) = summary.best.first() {
        let misfit = run.record.misfit();
        let given = misfit.and_then(|m| run.record.outputs[m].at_design);
        let given = given.map(|m| format!("{} <span class=\"to\">→</span> ", brief(m)));
        let misfit = format!(
            "{}<strong>{}</strong> <small>tolerances, design {}</small>",
            given.unwrap_or_default(),
            brief(best.misfit),
            best.design
        );
        facts.push(("Misfit, as given and best", misfit));
    }
    if let Some(count) = summary.on_front() {
        let front = format!(
            "{count} <small>designs, {} targets</small>",
            run.record.deviations().len()
        );
        facts.push(("On the Pareto front", front));
    }
    let solved = format!(
        "<span{class}>{}</span> of {} <small>designs</small>",
        summary.solved, summary.done
    );
    facts.push(("Solved", solved));
    facts
}

/// Failures by reason, and the missing part of an interrupted sweep.
fn remarks(run: &SweepRun) -> String {
    let summary = &run.summary;
    let mut remarks = String::new();
    if summary.done < summary.designs {
        remarks += &format!(
            "<p class=\"notice\">Interrupted after {} of {} designs: <code>hardpoint sweep</code> with \
             <code>--resume</code> continues. Everything below refers to the finished designs.</p>",
            summary.done, summary.designs
        );
    }
    if !summary.failures.is_empty() {
        let (table, left_out) = summary.failures_table().first(MOST_ROWS);
        let more = match left_out {
            0 => String::new(),
            more => format!("<p>And {more} more reasons, in <code>summary.json</code>.</p>"),
        };
        let nearest = if run.record.is_of_car() {
            "the number of the first case without equilibrium, 0 for the static case"
        } else {
            "the drive value nearest to the design position at which a station failed"
        };
        remarks += &format!(
            "<div class=\"failures\"><h2>Not solved everywhere</h2><p>Number of designs for each reason, with {nearest}. The \
             plots leave out values that could not be computed.</p>{}{more}</div>",
            table.html()
        );
    }
    for note in summary.notes() {
        remarks += &format!("<p class=\"note\">{}</p>", prose(note));
    }
    remarks
}

/// Describes which designs of the sweep the page shows.
fn choice(run: &SweepRun) -> String {
    let (summary, shown) = (&run.summary, run.shown.design.len());
    let file = match run.files.first() {
        Some(file) => format!("<code>{}</code>", html(file)),
        None => "the frame".to_owned(),
    };
    if run.choice.every == 1 {
        return format!("All {shown} designs are shown, with the values of {file}.");
    }
    let front = match summary.on_front() {
        None => String::new(),
        Some(all) if all == run.choice.front.len() => format!("the {all} of the Pareto front, "),
        Some(all) => format!(
            "{} of the {all} of the Pareto front (evenly chosen), ",
            run.choice.front.len()
        ),
    };
    let best = match summary.best.len() {
        0 => String::new(),
        best => format!("the {best} best, "),
    };
    let failures = if summary.failures.is_empty() {
        ""
    } else {
        "examples of every failure listed above, "
    };
    let chosen = format!("{best}{front}{failures}");
    let and = if chosen.is_empty() { "" } else { "and " };
    format!(
        "<strong>{shown} of {} designs are shown:</strong> {chosen}{and}the designs whose numbers are multiples of {}. \
         {file} has all designs. The tables count all of them.",
        summary.done, run.choice.every
    )
}

/// Best designs and Pareto front, with the options that print their studies. Empty if no design has a misfit.
fn best(run: &SweepRun) -> String {
    let summary = &run.summary;
    if summary.best.is_empty() {
        return String::new();
    }
    let front = if run.choice.front.is_empty() {
        String::new()
    } else {
        let (table, left_out) = front_table(run).first(MOST_ROWS);
        let more = match left_out {
            0 => String::new(),
            _ => "<p class=\"note\"><code>pareto.csv</code> has all of them.</p>".to_owned(),
        };
        format!(
            "<h3>Pareto front</h3><p class=\"note\">No design is better in one target without being \
             worse in another. Deviations are multiples of the tolerance.</p>{}{more}",
            table.html()
        )
    };
    format!(
        "<section id=\"best\" aria-labelledby=\"best-title\"><h2 id=\"best-title\">Best designs</h2>\
         <p class=\"note\">Sorted by misfit. Misfit and deviations are multiples of the tolerance. \
         <code>hardpoint sweep STUDY --design NUMBER</code> prints a design as a study.</p>{}{front}</section>",
        best_table(run).html()
    )
}

fn header(record: &SweepRecord) -> Vec<String> {
    let outputs = record
        .deviations()
        .into_iter()
        .map(|k| &record.outputs[k].column);
    let variables = record.variables.iter().map(|v| &v.column);
    let columns = ["design", "misfit"].map(str::to_owned).into_iter();
    let columns = columns.chain(outputs.chain(variables).cloned());
    columns.chain(["as a study".to_owned()]).collect()
}

fn command(design: u64) -> String {
    format!("--design {design}")
}

fn best_table(run: &SweepRun) -> Table {
    let mut table = Table::with_columns(header(&run.record));
    for best in &run.summary.best {
        let values = [best.misfit].into_iter().chain(best.rms.iter().copied());
        let mut row = vec![Cell::from(best.design)];
        row.extend(values.chain(best.variables.iter().copied()).map(Cell::from));
        row.push(command(best.design).into());
        table.push_row(row);
    }
    table
}

/// Table of the designs of the Pareto front, sorted by deviation from the first target.
fn front_table(run: &SweepRun) -> Table {
    let record = &run.record;
    let mut table = Table::with_columns(header(record));
    let variables = record.variables.len();
    let outputs = record.misfit().into_iter().chain(record.deviations());
    let order: Vec<usize> = outputs.map(|k| variables + k).chain(0..variables).collect();
    let value = |row: usize, column: usize| run.shown.columns[column][row];
    let first = record.deviations().first().map_or(0, |k| variables + k);
    let mut rows: Vec<usize> = run
        .choice
        .front
        .iter()
        .filter_map(|d| run.shown.row(*d))
        .collect();
    let key = |row: usize| value(row, first).unwrap_or(f64::INFINITY);
    rows.sort_by(|a, b| key(*a).total_cmp(&key(*b)));
    for row in rows {
        let mut cells = vec![Cell::from(run.shown.design[row])];
        let values = order.iter().map(|column| value(row, *column));
        cells.extend(values.map(Cell::from));
        cells.push(command(run.shown.design[row]).into());
        table.push_row(cells);
    }
    table
}

/// Explanation of the sensitivity indices.
fn effects(record: &SweepRecord) -> String {
    let change = "Change over the range: change of the output from the lower to the upper end of \
                  a variable's range. It comes from a linear fit (least squares) to all designs that \
                  have every output";
    let share = match record.method.as_str() {
        "file" => {
            " Designs from a file need not be independent, so there are no shares of the variance."
        }
        "saltelli" => {
            " Share of the variance: first-order Sobol index, the fraction of the output's variance that \
             disappears on average if the variable is fixed. Total index: the fraction that remains on average \
             if all other variables are fixed."
        }
        _ => {
            " Share of the variance: first-order Sobol index, the fraction of the output's variance that \
             disappears on average if the variable is fixed."
        }
    };
    format!("{change}.{share} Outputs that no variable changes are omitted.")
}

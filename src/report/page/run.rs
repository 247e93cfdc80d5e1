//! Page of a solve, an optimisation or a tolerance analysis.

use super::charts::Charts;
use super::escape::{html, prose};
use super::motions::{controls, figures, of_motions};
use super::opening::opening;
use super::tuning_charts::{front_charts, history_chart};
use super::tuning_sections::{tolerance_sections, tuning_sections};
use super::{Page, STAGE};
use crate::report::chart::{Charted, Layout, Line, Source, families, moving_beside};
use crate::report::curve_table::CurveTable;
use crate::report::failures::FailureRange;
use crate::report::figure::brief;
use crate::report::record::{DesignRecord, OutputRecord, Record};
use crate::report::run::{Run, Summary};
use crate::report::table::Table;
use crate::report::{FrontPoint, TuningSummary, YieldRecord};
use serde::Serialize;

/// Parts of the page's own script.
const SCRIPTS: [&str; 9] = [
    include_str!("base.js"),
    include_str!("chart.js"),
    include_str!("mechanism.js"),
    include_str!("turn.js"),
    include_str!("measures.js"),
    include_str!("tuning.js"),
    include_str!("front.js"),
    include_str!("theme.js"),
    include_str!("start.js"),
];

/// Largest number of curve values in a page. If a run has more values, the page shows evenly spaced stations, and a remark states
/// this.
const MOST_NUMBERS: usize = 25_000;

/// Data that the page's script reads.
#[derive(Serialize)]
struct Data<'a> {
    record: &'a Record,
    /// Tables of the charts. The curves of the designs come first.
    curves: &'a [CurveTable],
    charts: &'a [Layout],
    /// Index of the point of the Pareto front that is the tuned design. `None` if no point is this design.
    kept_point: Option<usize>,
    /// Targets missed by more than their tolerance: column, and largest deviation with its position.
    missed: Vec<(&'a str, String)>,
}

/// A design of the live page, for the first section of the report page.
pub struct PageDesign {
    /// Misfit as a multiple of the tolerances. `None` without targets, or if the design has no misfit.
    pub misfit: Option<f64>,
    /// Verdict on the targets and the constraints. `None` without targets.
    pub verdict: Option<String>,
    /// Deviations from the targets, as multiples of the tolerance. `None` without targets.
    pub targets: Option<Table>,
    /// Margins of constraints; a negative margin is a violation. `None` without constraints.
    pub constraints: Option<Table>,
    /// Coordinates of the hardpoints.
    pub hardpoints: Table,
}

impl PageDesign {
    /// Misfit for the head of the page. `None` without a misfit.
    pub(super) fn fact(&self) -> Option<(&'static str, String)> {
        let misfit = brief(self.misfit?);
        Some((
            "Misfit",
            format!("{} <small>tolerances</small>", html(&misfit)),
        ))
    }

    pub(super) fn section(&self) -> String {
        let verdict = self.verdict.as_ref().map_or_else(String::new, |verdict| {
            format!("<p class=\"verdict\">{}</p>", prose(verdict))
        });
        let targets = self.targets.as_ref().map_or_else(String::new, |targets| {
            format!(
                "<div><h3>Deviations from targets, as multiples of the tolerance</h3>{}</div>",
                targets.html()
            )
        });
        let constraints = self.constraints.as_ref();
        let constraints = constraints.map_or_else(String::new, |constraints| {
            format!(
                "<div><h3>Margins of constraints</h3>{}</div>",
                constraints.html()
            )
        });
        format!(
            "<section id=\"answer\" aria-labelledby=\"answer-title\"><h2 id=\"answer-title\">Design</h2>{verdict}\
             <div class=\"answer tables\">{targets}{constraints}<div><h3>Hardpoints</h3>{}</div></div></section>\n",
            self.hardpoints.html()
        )
    }
}

/// HTML of the page of a run.
pub fn page(run: &Run) -> String {
    with_design(run, None)
}

/// Report page of a design of the live page. The page begins with the misfit and the hardpoints of the design.
pub fn page_of_design(run: &Run, design: &PageDesign) -> String {
    with_design(run, Some(design))
}

fn with_design(run: &Run, design: Option<&PageDesign>) -> String {
    let (mut curves, curves_note) = drawn(run);
    let front = run.record.front.as_ref().map_or(&[][..], |f| &f.points);
    let first_of_front = curves.len();
    curves.extend(front_curves(front));
    let mut charts = Charts {
        tables: curves,
        layouts: Vec::new(),
    };
    let record = &run.record;
    let misses = tuning_of(run).map_or_else(Vec::new, missed);
    let figures = figures(
        Charted::of(record, &run.curves),
        &misses,
        &mut charts,
        |tables, group, over| front_lines(record, tables, first_of_front, group, over),
    );
    let motions = of_motions(run, &misses, &mut charts);
    let answer = match design {
        Some(design) => design.section(),
        None => tuning_of(run).map_or_else(String::new, |tuning| opening(tuning, record)),
    };
    let mut facts = facts(run);
    let mut sections = sections(run);
    if let Some(design) = design {
        facts.splice(0..0, design.fact());
        sections.insert(0, ("answer", "Design"));
    }
    let (tuning, ranges) = of_summary(run, &mut charts);
    let main = format!(
        include_str!("run.html"),
        answer = answer,
        curves_note = curves_note,
        figures = figures,
        motions = motions,
        stage = STAGE,
        ranges = ranges,
        tuning = tuning,
    );
    let data = Data {
        record: &run.record,
        curves: &charts.tables,
        charts: &charts.layouts,
        kept_point: tuning_of(run)
            .zip(run.record.front.as_ref())
            .and_then(|(tuning, front)| tuning.kept_point(front)),
        missed: tuning_of(run).map_or_else(Vec::new, missed),
    };
    let page = Page {
        study: &run.record.study,
        about: format!(
            "{}, {} · hardpoint {}",
            run.record.topology.replace('_', " "),
            run.record.command,
            run.record.version
        ),
        facts,
        remarks: interruption(run) + &failures(run) + &remarks(run),
        sections,
        controls: &controls(&run.record.motion, "curve-plots"),
        main,
        files: &run.files,
        data,
        scripts: &SCRIPTS,
    };
    page.html()
}

/// Sections with the results of the command. The first text is for a tuning, the second text for all other commands. The other text
/// is empty.
fn of_summary(run: &Run, charts: &mut Charts) -> (String, String) {
    let record = &run.record;
    match &run.summary {
        Summary::Optimise(tuning) => {
            let front = record.front.as_ref().map_or_else(String::new, |front| {
                let kept = tuning.kept_point(front);
                format!(
                    include_str!("front.html"),
                    charts = front_charts(front, kept, charts)
                )
            });
            let history = run.history.as_ref().map(|h| h.thinned(MOST_NUMBERS / 9));
            let history = history.map_or_else(String::new, |history| {
                history_chart(history, tuning.kept_start(), charts)
            });
            let sections = front + &tuning_sections(tuning, history, charts);
            (sections, String::new())
        }
        Summary::Tolerance(tolerance) => (String::new(), tolerance_sections(tolerance, record)),
        solve => {
            let ranges = solve.tables().map(|[ranges, ..]| ranges.html());
            (String::new(), ranges.unwrap_or_default())
        }
    }
}

fn tuning_of(run: &Run) -> Option<&TuningSummary> {
    match &run.summary {
        Summary::Optimise(tuning) => Some(tuning),
        _ => None,
    }
}

/// Curves of the points of a Pareto front. Empty if they would make the page too large.
fn front_curves(points: &[FrontPoint]) -> Vec<CurveTable> {
    let curves = points.iter().filter_map(|point| point.curves.as_ref());
    let numbers = |table: &CurveTable| table.rows() * table.header.len();
    if curves.clone().map(numbers).sum::<usize>() > MOST_NUMBERS {
        Vec::new()
    } else {
        curves.cloned().collect()
    }
}

/// Lines of the points of a Pareto front in the chart of a group of outputs over a column. `first` is the index of the first table
/// with curves of these points. The script shows one point at a time.
fn front_lines(
    record: &Record,
    tables: &[CurveTable],
    first: usize,
    group: &[&OutputRecord],
    over: &str,
) -> Vec<Line> {
    let points = record.front.as_ref().map_or(&[][..], |f| &f.points);
    let solved = points
        .iter()
        .enumerate()
        .filter(|(_, p)| p.curves.is_some());
    let mut lines = Vec::new();
    for ((point, _), table) in solved.zip(first..tables.len()) {
        let (families, _) = families(&moving_beside(&record.motion, over), &tables[table]);
        let present = families.into_iter().find(|family| family.is_present);
        let rows = present.map_or_else(Vec::new, |family| family.rows);
        lines.extend(group.iter().map(|output| Line {
            label: None,
            told: format!("point {}", point + 1),
            class: format!("hue5 strong front-point of-{point}"),
            is_main: false,
            in_strip: false,
            has_dots: false,
            source: Source {
                table,
                x: over.to_owned(),
                y: output.column.clone(),
                rows: rows.clone(),
            },
        }));
    }
    lines
}

/// Curves on the page, and a remark if some stations are left out.
fn drawn(run: &Run) -> (Vec<CurveTable>, String) {
    let widths = run.curves.iter().map(|table| table.header.len());
    let most = (MOST_NUMBERS / widths.sum::<usize>().max(1)).max(2);
    let all = run.curves.iter().map(CurveTable::rows).max().unwrap_or(0);
    let note = if all > most {
        format!(
            r#"<p class="notice">{most} of {all} stations are shown, evenly chosen; the files have all stations.</p>"#
        )
    } else {
        String::new()
    };
    (run.curves.iter().map(|t| t.thinned(most)).collect(), note)
}

/// Key values at the top of the page.
fn facts(run: &Run) -> Vec<(&'static str, String)> {
    let mut facts = Vec::new();
    if let Summary::Optimise(tuning) = &run.summary {
        let [before, after] = tuning.misfits();
        let known = |m: Option<String>| html(m.as_deref().unwrap_or("unknown"));
        let misfit = format!(
            "{} <span class=\"to\">→</span> <strong>{}</strong> <small>tolerances{}</small>",
            known(before),
            known(after),
            tuning.over_builds(", root mean square of")
        );
        facts.push(("Misfit", misfit));
        let [active, all] = tuning.at_bounds();
        let bounds = format!("{active} of {all} <small>variables</small>");
        facts.push(("At a bound", bounds));
        let (missed, targets) = (tuning.missed().len(), tuning.targets());
        let class = if missed == 0 { "" } else { " class=\"bad\"" };
        let met = targets - missed;
        let in_all = tuning.over_builds(" in all");
        let met = format!("<span{class}>{met}</span> of {targets} <small>targets{in_all}</small>");
        facts.push(("Within tolerance", met));
        if !tuning.side_effects.is_empty() {
            let flagged = tuning.side_effects.iter().filter(|e| e.flagged).count();
            let class = if flagged == 0 { "" } else { " class=\"bad\"" };
            let all = tuning.side_effects.len();
            let text = format!("<span{class}>{flagged}</span> of {all} <small>outputs</small>");
            facts.push(("Side effects", text));
        }
        if let Some([before, after]) = tuning.yields.as_ref().map(YieldRecord::percentages) {
            let text = format!(
                "{} <span class=\"to\">→</span> <strong>{}</strong>",
                html(&before),
                html(&after)
            );
            facts.push(("Yield", text));
        }
    }
    if let Summary::Tolerance(tolerance) = &run.summary {
        let builds = tolerance.builds;
        let rejected = match tolerance.rejected {
            0 => String::new(),
            n => format!(" <small class=\"bad\">{n} rejected</small>"),
        };
        facts.push(("Builds", format!("{builds}{rejected}")));
        if let Some(kept) = tolerance.kept_in_words() {
            facts.push(("In all bands", html(&kept)));
        }
    }
    if let Some(design) = run.record.motion.designs.last() {
        let failed: usize = design.failures.iter().map(FailureRange::stations).sum();
        let all = design.stations;
        let solved = all.saturating_sub(failed);
        let class = if failed == 0 { "" } else { " class=\"bad\"" };
        let solved = format!("<span{class}>{solved}</span> of {all} <small>stations</small>");
        facts.push(("Solved", solved));
    }
    facts
}

/// Designs over every motion, each with its label. If the motion has a name, the label contains it.
fn labelled(run: &Run) -> impl Iterator<Item = (String, &DesignRecord)> {
    let own = run.record.motion.designs.iter();
    let own = own.map(|design| (design.label.clone(), design));
    let named = run.record.motions.iter().flat_map(|named| {
        let designs = named.motion.designs.iter();
        designs.map(|design| (format!("motion {}, {}", named.name, design.label), design))
    });
    own.chain(named)
}

/// Section with all ranges of failed stations and their reasons.
fn failures(run: &Run) -> String {
    let mut items = String::new();
    for (label, design) in labelled(run) {
        for stretch in &design.failures {
            items += &format!(
                "<li><b>{}</b>, {}</li>",
                html(&label),
                prose(&stretch.to_string())
            );
        }
    }
    if items.is_empty() {
        items
    } else {
        format!(
            r#"<div class="failures"><h2>Not solved</h2><p>These stations have no values; the curves have gaps there.</p><ul>{items}</ul></div>"#
        )
    }
}

/// Remark about a run that a signal ended early.
fn interruption(run: &Run) -> String {
    if run.interrupted { r#"<p class="notice">Interrupted: these are the results that were finished. Run the study again for all of them.</p>"# } else { "" }
    .to_owned()
}

/// Remarks on the accuracy of every design.
fn remarks(run: &Run) -> String {
    let is_only = labelled(run).count() == 1;
    let of_design = |(label, design): (String, &DesignRecord)| {
        let of = if is_only {
            String::new()
        } else {
            format!("<b>{}</b>: ", html(&label))
        };
        let line = |remark: &String| format!("<p>{of}{}</p>", prose(remark));
        design.remarks.iter().map(line).collect::<String>()
    };
    labelled(run).map(of_design).collect()
}

/// Identifiers and names of the sections that the page links to.
fn sections(run: &Run) -> Vec<(&'static str, &'static str)> {
    let tuned = matches!(run.summary, Summary::Optimise(_));
    let all = [
        ("answer", "Result", tuned),
        ("curves", "Curves", true),
        ("mechanism", "Mechanism", true),
        ("turn", "Steering geometry", has_turn(run)),
        ("front", "Pareto front", run.record.front.is_some()),
        ("hardpoints", "Hardpoints", tuned),
        ("convergence", "Convergence", tuned),
        (
            "sensitivities",
            "Sensitivities",
            !run.record.influences.is_empty(),
        ),
    ];
    let shown = all.into_iter().filter(|(_, _, shown)| *shown);
    shown.map(|(id, name, _)| (id, name)).collect()
}

/// True if the page can show the car in a turn, seen from above.
fn has_turn(run: &Run) -> bool {
    let frames = run.record.motion.designs.iter().flat_map(|d| &d.frames);
    let mut poses = frames.filter_map(|frame| frame.pose.as_ref().ok());
    poses.any(|pose| pose.turn.as_ref().is_some_and(|turn| turn.centre.is_some()))
}

/// Missed targets: column, and size and position of the deviation.
pub(super) fn missed(tuning: &TuningSummary) -> Vec<(&str, String)> {
    let missed = tuning.missed().into_iter();
    missed.map(|(_, column, by)| (column, by)).collect()
}

pub(super) fn missed_in_words(missed: &[(&str, String)]) -> String {
    let item = |(column, by): &(&str, String)| format!("{}, by up to {}", html(column), prose(by));
    let items: Vec<String> = missed.iter().map(item).collect();
    if items.is_empty() {
        String::new()
    } else {
        format!(r#"<p class="unmet">Missed: {}.</p>"#, items.join("; "))
    }
}

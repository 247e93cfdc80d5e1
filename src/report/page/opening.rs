//! Opening screen of a tuned design: the result before the details.

use super::escape::{html, prose};
use super::table::table;
use crate::SideEffect;
use crate::curves::Placement;
use crate::report::record::{DesignRecord, Record};
use crate::report::scene::Sight;
use crate::report::{Scene, TuningSummary, counted, side_effects_table, visible_side_effects};
use std::fmt::Write;

/// Largest number of side effects on the opening screen.
pub(super) const MOST_EFFECTS: usize = 6;

/// Opening screen: verdict, moved points and bounds next to a picture, targets, side effects and margins.
pub(super) fn opening(tuning: &TuningSummary, record: &Record) -> String {
    let unmet: Vec<usize> = tuning.missed().iter().map(|(row, ..)| *row).collect();
    let targets = table(&tuning.targets_table(), |row| {
        unmet.contains(&row).then_some("unmet")
    });
    let unit = &record.length_unit;
    let moved = tuning.moved_points(unit);
    let together = if moved.rows().any(|row| row[0].text().contains('+')) {
        "<p class=\"note\">If points move together, the numbers describe the first one.</p>"
    } else {
        ""
    };
    let (title, moved) = if moved.rows().next().is_some() {
        (format!("Moved points [{unit}]"), moved.html())
    } else {
        // No point moved. Either the variables are rates, or the tuning changed nothing.
        ("Variables".to_owned(), tuning.variables_table().html())
    };
    let picture = pictures(record);
    format!(
        r#"<section id="answer" aria-labelledby="answer-title">
  <h2 id="answer-title">Result</h2>
  <p class="verdict">{verdict}</p>
  <div class="answer">
    <div><h3>{title}</h3>{moved}{together}{bounds}</div>
    {picture}
  </div>
  <div class="answer tables">
    <div><h3>Targets</h3>{targets}<p class="note">{deviations}</p></div>
    <div><h3>Side effects</h3>{effects}{margins}</div>
  </div>
</section>
"#,
        verdict = html(&verdict(tuning)),
        bounds = bounds(tuning),
        deviations = prose(&tuning.deviations_in_words()),
        effects = effects(&tuning.side_effects),
        margins = margins(tuning),
    )
}

/// Verdict on the tuning in short sentences.
fn verdict(tuning: &TuningSummary) -> String {
    let (all, missed) = (tuning.targets(), tuning.missed().len());
    let flagged = tuning.side_effects.iter().filter(|e| e.flagged).count();
    let violated = tuning.violated().len();
    let mut words = match missed {
        0 if all == 1 => format!(
            "The target is within its tolerance{}.",
            tuning.over_builds(" in all")
        ),
        0 => format!(
            "All {all} targets are within their tolerance{}.",
            tuning.over_builds(" in all")
        ),
        1 if all == 1 => format!(
            "The target is outside its tolerance{}.",
            tuning.over_builds(" in at least one of")
        ),
        1 => format!(
            "1 of {all} targets is outside its tolerance{}.",
            tuning.over_builds(" in at least one of")
        ),
        n => format!(
            "{n} of {all} targets are outside their tolerance{}.",
            tuning.over_builds(" in at least one of")
        ),
    };
    match violated {
        0 => {}
        1 => words += " 1 constraint is violated.",
        n => _ = write!(words, " {n} constraints are violated."),
    }
    match flagged {
        0 => {}
        1 => words += " 1 output without a target changes by more than its tolerance.",
        n => {
            _ = write!(
                words,
                " {n} outputs without a target change by more than their tolerance."
            )
        }
    }
    words
}

fn bounds(tuning: &TuningSummary) -> String {
    let [active, all] = tuning.at_bounds();
    let class = if active == 0 { "note" } else { "unmet" };
    let words = match active {
        0 => format!("None of {all} variables is at a bound."),
        1 if all == 1 => "The variable is at a bound of its range.".to_owned(),
        1 => format!("1 of {all} variables is at a bound of its range."),
        n => format!("{n} of {all} variables are at a bound of their range."),
    };
    format!("<p class=\"{class}\">{words}</p>")
}

fn effects(effects: &[SideEffect]) -> String {
    if effects.is_empty() {
        return "<p class=\"note\">Every output of the study has a target.</p>".to_owned();
    }
    let mut shown = visible_side_effects(effects);
    if shown.is_empty() {
        return "<p class=\"note\">No output without a target changes noticeably.</p>".to_owned();
    }
    let more = effects.len() - shown.len().min(MOST_EFFECTS);
    shown.truncate(MOST_EFFECTS);
    let flagged = |row: usize| shown[row].flagged.then_some("unmet");
    let rows = table(&side_effects_table(&shown), flagged);
    match more {
        0 => rows,
        n => {
            let words = counted(n, "further output");
            let are = if n == 1 { "is" } else { "are" };
            format!("{rows}<p class=\"note\">{words} {are} listed below.</p>")
        }
    }
}

fn margins(tuning: &TuningSummary) -> String {
    let violated = tuning.violated();
    tuning.constraints_table().map_or_else(String::new, |of| {
        let mark = |row| violated.contains(&row).then_some("unmet");
        format!("<h3>Constraints and margins</h3>{}", table(&of, mark))
    })
}

/// Pictures of the first and the last design of a run, from the front and from the side. The first design is dashed; the last
/// design has colours.
fn pictures(record: &Record) -> String {
    let [Some(first), Some(last)] = [record.motion.designs.first(), record.motion.designs.last()]
        .map(|design| design.and_then(DesignRecord::nearest_pose))
    else {
        return String::new();
    };
    let views = [("Front", Sight::Front), ("Side", Sight::Side)];
    let figures = views.map(|(name, sight)| {
        format!(
            "<figure><figcaption>{name}</figcaption>{}</figure>",
            picture(&record.scene, [first, last], sight)
        )
    });
    format!(
        r#"<div><h3>Before (dashed) and after</h3><div class="views">{}</div></div>"#,
        figures.concat()
    )
}

const WIDTH: f64 = 300.0;
const HEIGHT: f64 = 220.0;
const EDGE: f64 = 14.0;

/// Picture of two designs in one view. It shows the rims of the last design, and marks the moved points.
fn picture(scene: &Scene, designs: [&Placement; 2], sight: Sight) -> String {
    let axes = scene.axes(sight);
    let flat = |p: &[f64; 3]| axes.map(|(axis, sign)| sign * p[axis]);
    let all = designs.iter().flat_map(|d| &d.points).map(flat);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let radius = scene.wheel_radius.unwrap_or(0.0);
    let wide = if sight == Sight::Side { radius } else { 0.0 };
    let centres = [Some(scene.wheel_centre), scene.right_wheel_centre];
    let centres = centres.into_iter().flatten();
    let centres = centres.map(|centre| flat(&designs[1].points[centre]));
    let centres: Vec<[f64; 2]> = centres.collect();
    // Two opposite corners of the rectangle around a rim.
    let corners = |[x, y]: [f64; 2]| [-1.0, 1.0].map(|by| [x + by * wide, y + by * radius]);
    for p in all.chain(centres.iter().copied().flat_map(corners)) {
        for k in 0..2 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let span = |k: usize| (high[k] - low[k]).max(1e-9);
    let scale = ((WIDTH - 2.0 * EDGE) / span(0)).min((HEIGHT - 2.0 * EDGE) / span(1));
    let at = |p: [f64; 2]| {
        let x = WIDTH / 2.0 + scale * (p[0] - (low[0] + high[0]) / 2.0);
        let y = HEIGHT / 2.0 - scale * (p[1] - (low[1] + high[1]) / 2.0);
        format!("{x:.1} {y:.1}")
    };
    let mut shapes = String::new();
    for centre in centres.into_iter().filter(|_| radius > 0.0) {
        if wide > 0.0 {
            let place = at(centre);
            let (x, y) = place.split_once(' ').unwrap_or_default();
            let r = scale * radius;
            _ = write!(
                shapes,
                r#"<circle class="rim" cx="{x}" cy="{y}" r="{r:.1}"/>"#
            );
        } else {
            let [a, b] = corners(centre).map(&at);
            _ = write!(shapes, r#"<path class="rim" d="M{a}L{b}"/>"#);
        }
    }
    for (design, class) in designs.into_iter().zip(["before", "after"]) {
        for line in scene.bodies.iter().flat_map(|body| &body.lines) {
            let places: Vec<String> = line.iter().map(|i| at(flat(&design.points[*i]))).collect();
            _ = write!(
                shapes,
                r#"<path class="{class}" d="M{}"/>"#,
                places.join("L")
            );
        }
    }
    for (k, name) in scene.points.iter().enumerate() {
        let [from, to] = designs.map(|design| design.points[k]);
        if from != to {
            let place = at(flat(&to));
            let (x, y) = place.split_once(' ').unwrap_or_default();
            _ = write!(
                shapes,
                r#"<circle class="moved" cx="{x}" cy="{y}" r="4"><title>{}</title></circle>"#,
                html(name)
            );
        }
    }
    format!(
        r#"<svg class="pose" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="Mechanism before and after">{shapes}</svg>"#
    )
}

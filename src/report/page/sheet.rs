//! Pages without scripts: the steps of a set-up, and the limits of a mechanism.

use super::escape::{html, prose};
use super::policy::policy;
use super::strips::{Strip, strips};
use super::table::{breakable, stacked};
use crate::report::{Cell, SetUpSummary, Table, brief};

/// A section of a page: title, note and content.
pub(super) struct Section {
    pub title: String,
    pub note: String,
    /// Content as HTML: tables, charts, remarks.
    pub table: String,
}

/// Page of a set-up: adjustments as steps, values after each step, and target values with their errors.
pub fn set_up_page(wheels: &[SetUpSummary]) -> String {
    let study = wheels.first().map_or("", |summary| &summary.study);
    let met = wheels.iter().all(|summary| summary.met);
    let mut sections = Vec::new();
    for summary in wheels {
        let of = summary
            .side
            .map_or_else(String::new, |side| format!(", {}", side.wheels()));
        let titled = |title: &str, note: &str, table: String| Section {
            title: format!("{title}{of}"),
            note: note.to_owned(),
            table,
        };
        let note = "Do the steps in this order. Amounts are rounded to values that a mechanic can \
                    set.";
        let effects = format!(
            "<p class=\"note\">Effect of each step, with the rounded amount. The effects add up.</p><div class=\"causes\">{}</div>",
            summary.effects_of_steps().html()
        );
        let steps = summary.instructions().html() + &effects;
        sections.push(titled("Steps", note, steps));
        let results = summary.results();
        if !results.is_empty() {
            let note = "Allowed error: the effect of half a shim step and of 1/32 turn of each \
                        thread. Band: target value with its allowed error. Grey dot: before. \
                        Blue dot: after the rounded steps.";
            let missed: String = summary
                .not_met()
                .filter_map(|s| Some((s, s.wanted?, s.set_rounded?)))
                .map(|(s, wanted, set)| {
                    let line = format!("{}: {} instead of {}", s.column, brief(set), brief(wanted));
                    format!("<p class=\"unmet\">Not met: {}.</p>", prose(&line))
                })
                .collect();
            let drawn = strips(&wanted_strips(summary), "target values before and after");
            sections.push(titled(
                "Target values",
                note,
                drawn + &results.html() + &missed,
            ));
        }
        let after: String = summary
            .values_after_steps()
            .iter()
            .map(Table::html)
            .collect();
        let note = "Computed amounts, before rounding.";
        sections.push(titled("Static values after each step", note, after));
        let effects = summary.effects_for_readers().html();
        let note = "Change of each static value by one unit of an adjustment, at the design.";
        let note = format!("{note} {}", summary.effects_note().unwrap_or_default());
        sections.push(titled(
            "Effect of each adjustment",
            note.trim_end(),
            effects,
        ));
    }
    let verdict = if met {
        "Every target value is reached."
    } else {
        "Not every target value is reached."
    };
    sheet(study, "set-up", verdict, &sections)
}

/// One strip for each static value (such as camber or toe) that has a target.
fn wanted_strips(summary: &SetUpSummary) -> Vec<Strip> {
    let wanted = summary.statics.iter().filter_map(|s| Some((s, s.wanted?)));
    wanted
        .map(|(s, wanted)| {
            let goal = if s.kept { "kept at" } else { "wanted" };
            // An angle that is kept at 0 has a rounding error.
            let figure = brief(if wanted.abs() < 1e-9 { 0.0 } else { wanted });
            let dots = [("former", s.nominal), ("main", s.set_rounded)].into_iter();
            Strip {
                title: format!("{}, {goal} {figure}", s.column),
                range: None,
                band: Some([wanted - s.allowed_rounded, wanted + s.allowed_rounded]),
                dots: dots
                    .filter_map(|(class, value)| Some((class, value?)))
                    .collect(),
            }
        })
        .collect()
}

/// Data for the page of a mechanism's limits.
pub struct LimitsSheet<'a> {
    /// Name of the study.
    pub study: &'a str,
    /// Table of the limits: quantities with lower limit, upper limit and their causes.
    pub limits: &'a Table,
    /// Ranges of the study's motion. The names are the same as in the table of limits.
    pub motion: &'a [(String, [f64; 2])],
    /// Remarks on the limits.
    pub notes: &'a [String],
    /// Stations without a pose.
    pub failures: &'a [String],
}

/// Page of a mechanism's limits: ranges of travel and rack, with the cause of each end.
pub fn limits_page(of: &LimitsSheet<'_>) -> String {
    let notes: String = of
        .notes
        .iter()
        .map(|n| format!("<p>{}</p>", prose(n)))
        .collect();
    let failed = |line: &String| format!("<p class=\"unmet\">{}</p>", prose(line));
    let failures: String = of.failures.iter().map(failed).collect();
    let drawn = strips(&limit_strips(of), "ranges of the quantities");
    // The motion of an axle has several quantities, so the page shows no band of the motion.
    let band = if of.motion.is_empty() {
        ""
    } else {
        " Shaded band: motion of the study."
    };
    let section = Section {
        title: "Ranges and their causes".to_owned(),
        note: format!(
            "Each row is a quantity that moves while the others are held at the values in the row. \
             Line: range of the mechanism.{band} Grey dot: design position."
        ),
        table: format!(
            "{drawn}<div class=\"causes\">{}</div>{notes}{failures}",
            stacked(of.limits)
        ),
    };
    let verdict = if of.failures.is_empty() {
        "The whole motion of the study can be solved."
    } else {
        "Part of the motion of the study cannot be solved."
    };
    sheet(of.study, "limits", verdict, &[section])
}

/// One strip for each row of the limits that has both limits. The dot at 0 is the design position.
fn limit_strips(of: &LimitsSheet<'_>) -> Vec<Strip> {
    let rows = of.limits.rows();
    rows.filter_map(|cells| {
        let [quantity, at, lower, _, upper, _] = <[&Cell; 6]>::try_from(cells).ok()?;
        let range = [lower.number()?, upper.number()?];
        let mut motion = of.motion.iter();
        let moved = motion.find(|(name, _)| name == quantity.text());
        let held = match at.text() {
            "" => String::new(),
            at => format!(", {at}"),
        };
        Some(Strip {
            title: format!("{}{held}", quantity.text()),
            range: Some(range),
            band: moved.map(|(_, ends)| *ends),
            dots: vec![("former", 0.0)],
        })
    })
    .collect()
}

/// Page without a script. `kind` names the command or result. The texts are plain, except the tables of the sections.
pub(super) fn sheet(study: &str, kind: &str, verdict: &str, sections: &[Section]) -> String {
    let section = |s: &Section| {
        format!(
            "<section><h2>{}</h2><p class=\"note\">{}</p>{}</section>\n",
            prose(&s.title),
            prose(&s.note),
            s.table
        )
    };
    let style = super::style();
    format!(
        include_str!("sheet.html"),
        policy = html(&policy(&[], &style)),
        study = html(study),
        heading = breakable(study),
        style = style,
        kind = kind,
        version = env!("CARGO_PKG_VERSION"),
        verdict = prose(verdict),
        main = sections.iter().map(section).collect::<String>(),
    )
}

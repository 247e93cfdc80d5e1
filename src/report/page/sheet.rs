//! Pages of tables alone, without scripts: a set-up as steps, and the limits of a mechanism.

use super::escape::html;
use super::policy::policy;
use super::table::table;
use crate::report::{SetUpSummary, Table, brief};

/// A section of a page: its title, a note and its table.
struct Section {
    title: String,
    note: String,
    table: String,
}

/// The page of a set-up: adjustments as steps, values after each step, and wanted values with their errors.
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
        let note = "Do the steps in this order. Amounts are rounded to what a mechanic can set.";
        sections.push(titled("Steps", note, summary.instructions().html()));
        let results = summary.results();
        if !results.is_empty() {
            let note = "Allowed error: half a step of the shims, half a sixteenth of a turn of the threads.";
            let missed: String = summary
                .not_met()
                .filter_map(|s| Some((s, s.wanted?, s.set_rounded?)))
                .map(|(s, wanted, set)| {
                    let line = format!("{}: {} instead of {}", s.column, brief(set), brief(wanted));
                    format!("<p class=\"unmet\">Not met: {}.</p>", html(&line))
                })
                .collect();
            sections.push(titled("Wanted values", note, results.html() + &missed));
        }
        let after: String = summary
            .values_after_steps()
            .iter()
            .map(Table::html)
            .collect();
        let note = "Computed amounts, before rounding.";
        sections.push(titled("Static values after each step", note, after));
        let effects = summary.effects_for_readers().html();
        let note = "Change of each static value by one unit of an adjustment, about the design.";
        sections.push(titled("Effect of each adjustment", note, effects));
    }
    let verdict = match met {
        true => "Every wanted value is met.",
        false => "Not every wanted value is met.",
    };
    sheet(study, "set-up", verdict, &sections)
}

/// The page of a mechanism's limits: ranges of travel and rack with the cause of each end.
pub fn limits_page(study: &str, limits: &Table, notes: &[String], failures: &[String]) -> String {
    let notes: String = notes
        .iter()
        .map(|n| format!("<p>{}</p>", html(n)))
        .collect();
    let failed = |line: &String| format!("<p class=\"unmet\">{}</p>", html(line));
    let failures: String = failures.iter().map(failed).collect();
    let section = Section {
        title: "Ranges and their causes".to_owned(),
        note: "Each row is a quantity that moves while the others stay where the row says."
            .to_owned(),
        table: table(limits, |_| None) + &notes + &failures,
    };
    let verdict = match failures.is_empty() {
        true => "The whole motion of the study can be solved.",
        false => "Part of the motion of the study cannot be solved.",
    };
    sheet(study, "limits", verdict, &[section])
}

fn sheet(study: &str, kind: &str, verdict: &str, sections: &[Section]) -> String {
    let section = |s: &Section| {
        format!(
            "<section><h2>{}</h2><p class=\"note\">{}</p>{}</section>\n",
            html(&s.title),
            html(&s.note),
            s.table
        )
    };
    let style = super::style();
    format!(
        include_str!("sheet.html"),
        policy = html(&policy(&[], &style)),
        study = html(study),
        style = style,
        kind = kind,
        version = env!("CARGO_PKG_VERSION"),
        verdict = html(verdict),
        main = sections.iter().map(section).collect::<String>(),
    )
}

//! Sections of the page about a tuning and a tolerance analysis.

use super::charts::Charts;
use super::escape::{html, prose};
use super::opening::MOST_EFFECTS;
use super::run::{missed, missed_in_words};
use super::scatter::{contributors, distributions};
use super::table::table;
use super::tuning_charts::prices_chart;
use crate::SideEffect;
use crate::report::record::Record;
use crate::report::{
    HOLDING_NOTE, ToleranceSummary, TuningSummary, VALUES_NOTE, further_in_words, holding_table,
    side_effects_in_words, side_effects_table, visible_side_effects,
};

/// Sections of an optimisation: targets, side effects, variables, constraints and convergence history.
pub(super) fn tuning_sections(
    tuning: &TuningSummary,
    history: String,
    charts: &mut Charts,
) -> String {
    let unseen: String = tuning
        .unseen()
        .iter()
        .map(|u| format!("<li>{}</li>", html(u)))
        .collect();
    let unseen = if unseen.is_empty() {
        unseen
    } else {
        format!(
            "<p>Made together, the moves in each line {}:</p><ul>{unseen}</ul>",
            tuning.unseen_guarantee()
        )
    };
    let unmet: Vec<usize> = tuning.missed().iter().map(|(row, ..)| *row).collect();
    format!(
        include_str!("tuning.html"),
        deviations = prose(&tuning.deviations_in_words()),
        targets = table(&tuning.targets_table(), |row| unmet
            .contains(&row)
            .then_some("unmet")),
        missed = missed_in_words(&missed(tuning)) + &holding(tuning),
        variables = tuning.variables_table().html(),
        constraints = constraints(tuning),
        unseen = unseen,
        starts = tuning.starts_table().html(),
        history = history,
        prices = prices_section(tuning, charts),
        side_effects = side_effects(&tuning.side_effects),
        yields = tuning.yields.as_ref().map_or_else(String::new, |yields| {
            format!(
                "<p class=\"note\">{}</p>{}",
                prose(&yields.headline()),
                yields.table().html()
            )
        }),
    )
}

/// Table of the bounds that keep missed targets from their goals. Empty without such bounds.
fn holding(tuning: &TuningSummary) -> String {
    let records = tuning.holding.as_deref().unwrap_or_default();
    if records.is_empty() {
        return String::new();
    }
    let note =
        format!("Bounds of variables that keep missed targets from their goals: {HOLDING_NOTE}.");
    format!(
        "<p class=\"note\">{}</p>{}",
        prose(&note),
        holding_table(records).html()
    )
}

/// Section about changes that no target requests. The table has the visible changes; the other outputs follow in words.
fn side_effects(effects: &[SideEffect]) -> String {
    let Some(words) = side_effects_in_words(effects) else {
        return String::new();
    };
    let shown = visible_side_effects(effects);
    let flagged = |row: usize| shown[row].flagged.then_some("unmet");
    let rows = match shown.len() {
        0 => String::new(),
        _ => table(&side_effects_table(&shown), flagged),
    };
    let further = further_in_words(effects);
    let further = further.iter().map(|line| format!("<p>{}</p>", prose(line)));
    // If there are few side effects, the opening screen shows all of them. The printed page then leaves out this table.
    let again = if shown.len() <= MOST_EFFECTS {
        " class=\"again\""
    } else {
        ""
    };
    format!(
        r#"<div{again}><p class="note">Side effects: changes that no target asks for; {}.</p>{rows}</div>{}"#,
        prose(&words),
        further.collect::<String>()
    )
}

/// Section about the constraints, with remarks on constraints and targets.
fn constraints(tuning: &TuningSummary) -> String {
    let violated = tuning.violated();
    let mark = |row| violated.contains(&row).then_some("unmet");
    let mut shown = tuning.constraints_table().map_or_else(String::new, |of| {
        let about = "Constraints with the margin to each limit. Price: decrease of the misfit (a multiple of the tolerance) if the limit moves outward by one unit.";
        format!(r#"<p class="note">{about}</p>{}"#, table(&of, mark))
    });
    for remark in tuning.remarks() {
        shown += &format!("<p>{}</p>", prose(&remark));
    }
    shown
}

/// Section about the misfit against the size of the change.
fn prices_section(tuning: &TuningSummary, charts: &mut Charts) -> String {
    tuning.prices_table().map_or_else(String::new, |table| {
        let chart = prices_chart(&tuning.prices, charts);
        format!(
            include_str!("prices.html"),
            chart = chart,
            table = table.html()
        )
    })
}

/// Pictures and tables of a tolerance analysis: distributions, contributors, values, bands and failures.
pub(super) fn tolerance_sections(tolerance: &ToleranceSummary, record: &Record) -> String {
    let mut sections = distributions(tolerance, &record.motion.drive) + &contributors(tolerance);
    sections += &tolerance.values_table(&record.length_unit).html();
    sections += &format!("<p class=\"note\">{VALUES_NOTE}</p>");
    if !tolerance.bands.is_empty() {
        sections += &tolerance.bands_table().html();
        for line in &tolerance.nominal_outside {
            sections += &format!("<p>{}</p>", prose(line));
        }
        sections += "<p>Predicted yield by tolerance</p>";
        sections += &tolerance.ranking_table().html();
    }
    for line in tolerance.failures() {
        sections += &format!("<p>{}</p>", prose(&line));
    }
    sections
}

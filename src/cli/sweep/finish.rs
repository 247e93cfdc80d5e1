//! End of a sweep or of a shard: summary, studies of selected designs and the page.

use super::*;
use crate::report::Table;

/// Prints which parts of the sweep one shard has computed, and how many parts of the whole unfinished sweep are complete.
pub(super) fn finish_shard(
    output: &Output,
    record: &SweepRecord,
    [shard, shards]: [u64; 2],
    parts: Range<u64>,
    missing: &[u64],
) -> Result<Exit, Stop> {
    let own = missing.iter().filter(|part| parts.contains(part)).count() as u64;
    let count = parts.end - parts.start;
    let what = match count {
        0 => ", nothing to compute".to_owned(),
        1 => format!(", part {}", parts.start),
        _ => format!(", parts {} to {}", parts.start, parts.end - 1),
    };
    output.say(&format!(
        "{}: shard {shard}/{shards}{what}; {} of the sweep's {} are complete\n",
        record.study,
        record.parts() - missing.len() as u64,
        match record.parts() {
            1 => "one part".to_owned(),
            parts => format!("{parts} parts"),
        },
    ))?;
    if count == 0 {
        return Ok(Exit::Done);
    }
    let names = SweepDirectory::part_files(record);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    output.print_files(&names)?;
    Ok(Exit::of(own == 0))
}

/// Writes and prints the summary of a sweep, or of its finished parts. Also writes the page if `with_page` is true.
pub(in crate::cli) fn finish(
    output: &Output,
    record: &SweepRecord,
    statistics: &SweepStatistics,
    with_page: bool,
) -> Result<Exit, Stop> {
    let summary = SweepSummary::of(record, statistics);
    if let Some(directory) = output.directory() {
        let written = SweepDirectory::write_summary(directory, record, statistics);
        written.map_err(Stop::unwritten)?;
    }
    let mut files = match statistics.designs {
        0 => Vec::new(),
        _ => SweepDirectory::part_files(record),
    };
    files.extend(summary.on_front().map(|_| "pareto.csv".to_owned()));
    files.extend(["summary.json", "sweep.json"].map(str::to_owned));
    let drawn = output
        .directory()
        .map(|d| d.path().join("shown_designs.json"));
    if drawn.is_some_and(|drawn| drawn.is_file()) {
        files.push("shown_designs.json".to_owned());
    }
    if let Some(directory) = output
        .directory()
        .filter(|_| with_page && statistics.designs > 0)
    {
        show_sweep(directory)?;
        files.push("report.html".to_owned());
    }
    if summary.is_done() {
        output.finish()?
    } else {
        output.leave_unfinished()?
    }

    output.say(&format!("{}: {}\n", record.study, summary.headline()))?;
    if statistics.designs > 0 {
        output.text_only("\n")?;
    }
    let failures = summary.failures_table();
    if !(output.is_text() && failures.is_empty()) {
        output.table("not_solved", &failures)?;
        output.text_only("\n")?;
    }
    say_results(output, record, &summary)?;
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    output.print_files(&files)?;
    Ok(Exit::of(summary.is_complete()))
}

/// Prints the best designs, then the main effects, then the ranges of the outputs.
fn say_results(output: &Output, record: &SweepRecord, summary: &SweepSummary) -> Result<(), Stop> {
    let say = |heading: &str, table: &Table| {
        if table.is_empty() {
            return Ok(());
        }
        let table = table.text(terminal::width());
        output.text_only(&format!("{heading}:\n\n{table}\n"))
    };
    let best = summary.best_table();
    say(
        "Best designs by misfit (in multiples of the tolerance)",
        &best,
    )?;
    if let Some(count) = summary.on_front().filter(|_| summary.has_designs()) {
        output.say(&format!(
            "On the Pareto front of {} targets: {}\n\n",
            record.targets.len(),
            counted(count, "design")
        ))?;
    }
    say(
        summary.main_effects_heading(),
        &summary.main_effects_table(),
    )?;
    let ranges = summary.ranges_table();
    if summary.has_designs() || !output.is_text() {
        output.text_only("Ranges of the outputs:\n\n")?;
        output.table("outputs", &ranges)?;
    }
    output.table_for_programs("effects", || summary.effects_table());
    output.table_for_programs("best", || best);
    output.say_remarks(summary.of_which())?;
    output.say_remarks(summary.notes())
}

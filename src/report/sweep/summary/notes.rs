//! Notes on the results of a sweep.

use crate::axle::Quantity;
use crate::characteristics::Characteristic;
use crate::report::text::counted;
use crate::sweep::{KEPT, Kind, OutputColumn, SweepRecord, SweepStatistics};

/// Notes about the comparison with targets and constraints, about outputs without a value in some solved designs, and about the
/// designs used for main effects.
pub(super) fn notes(record: &SweepRecord, statistics: &SweepStatistics) -> Vec<String> {
    let mut notes = Vec::new();
    if record.is_fit {
        let words = "warning: the sweep does not compare its designs with the targets, because they are measurements: fit = true";
        notes.push(words.to_owned());
    }
    notes.extend(unchecked(record, statistics));
    notes.extend(violated(record, statistics));
    notes.extend(fixed_values(record));
    notes.extend(unranked(record, statistics));
    for (output, present) in record.outputs.iter().zip(&statistics.solved_values) {
        let lacking = statistics.solved - present;
        if lacking == 0 {
            continue;
        }
        let reason = undefined_where(record, output).unwrap_or("it is not a finite number there");
        let column = &output.column;
        notes.push(if lacking == statistics.solved {
            format!("warning: {column} has no value in any solved design: {reason}")
        } else {
            format!(
                "{} {} {column}: {reason}",
                counted(lacking, "solved design"),
                if lacking == 1 { "lacks" } else { "lack" }
            )
        });
    }
    // In each of Saltelli's groups, only the first two designs are independent.
    let (count, designs) = (statistics.moments.count, statistics.designs);
    let drawn = record.group().map_or(designs, |group| {
        designs / group * 2 + (designs % group).min(2)
    });
    if drawn < designs {
        notes.push(format!(
            "Means, standard deviations and changes refer to the {count} designs that were \
             sampled independently; the other {} are used for the shares of the variance.",
            designs - drawn
        ));
    }
    if count == 0 && statistics.solved > 0 {
        let lacking = record.outputs.iter().zip(&statistics.ranges);
        let lacking = lacking.filter(|(_, range)| range.is_none());
        let mut names: Vec<&str> = lacking.map(|(o, _)| o.output.as_str()).collect();
        names.dedup();
        let without = if names.is_empty() {
            String::new()
        } else {
            format!("; leave out {} to get them", names.join(", "))
        };
        notes.push(format!(
            "Main effects are not known: they need designs that have a value for every output, and no design \
             has all values{without}."
        ));
    }
    if count > 0 && count < drawn && record.method != "file" {
        notes.push(format!(
            "Percentages refer to the {count} of {drawn} designs that have every output. In these designs the variables \
             are correlated, so percentages may sum up to more than 100."
        ));
    }
    notes
}

/// Warning about constraints that the sweep does not check. The best designs may violate them. `None` without best designs.
fn unchecked(record: &SweepRecord, statistics: &SweepStatistics) -> Option<String> {
    let constraints = &record.unchecked_constraints;
    (!constraints.is_empty() && !statistics.best.is_empty()).then(|| {
        format!(
            "warning: the sweep does not check the constraints of [optimise], so the best designs may violate them: {}. \
             Remove constraints = false to check them",
            constraints.join("; ")
        )
    })
}

/// Sentence about designs that violate constraints. `None` without such designs.
fn violated(record: &SweepRecord, statistics: &SweepStatistics) -> Option<String> {
    let counts = record.outputs.iter().zip(&statistics.violating);
    let counts = counts.filter(|(_, count)| **count > 0);
    let list: Vec<String> = counts
        .map(|(output, count)| format!("{} ({count})", output.output))
        .collect();
    let (designs, violators) = (statistics.solved, statistics.violators);
    let ranked = match record.misfit() {
        None => "",
        Some(_) if violators == designs => ", so no design is ranked",
        Some(_) => " and are not ranked",
    };
    (violators > 0).then(|| {
        format!(
            "{violators} of {} violate a constraint{ranked}: {}.",
            counted(designs, "solved design"),
            list.join("; ")
        )
    })
}

/// Sentence about constraints that fix a value. No sample of a sweep satisfies such a constraint. `None` without such constraints.
fn fixed_values(record: &SweepRecord) -> Option<String> {
    let fixes = |output: &&OutputColumn| output.kind == Kind::Margin && output.least.is_none();
    let fixed: Vec<&str> = record
        .outputs
        .iter()
        .filter(fixes)
        .map(|output| output.output.as_str())
        .collect();
    (!fixed.is_empty() && record.misfit().is_some()).then(|| {
        format!(
            "Designs are ranked without the constraints that fix a value, because samples do not satisfy them: {}.",
            fixed.join("; ")
        )
    })
}

/// Sentence about designs with a smaller misfit than the best design. They are not ranked, because they are not solved at every
/// station. `None` without such designs.
fn unranked(record: &SweepRecord, statistics: &SweepStatistics) -> Option<String> {
    let everywhere = if record.is_of_car() {
        "in every load case"
    } else {
        "at every station"
    };
    let first = record.misfit().zip(statistics.best.first());
    let Some((misfit, best)) = first else {
        let has_misfits = !statistics.unranked.is_empty();
        return has_misfits.then(|| {
            format!("No design is ranked by its misfit, because none is solved {everywhere}.")
        });
    };
    let is_smaller = |other: &&f64| **other < best.outputs[misfit];
    let count = statistics.unranked.iter().filter(is_smaller).count();
    let (are, they) = if count == 1 {
        ("is", "it is")
    } else {
        ("are", "they are")
    };
    let number = match count {
        0 => return None,
        // The statistics store at most [`KEPT`] of these misfits.
        KEPT => format!("At least {KEPT} designs"),
        _ => counted(count as u64, "design"),
    };
    Some(format!(
        "{number} with a smaller misfit than design {} {are} not ranked, because {they} not solved {everywhere}.",
        best.design
    ))
}

/// Reason why an output may have no value. `None` for a car, and for outputs without a known reason.
fn undefined_where(record: &SweepRecord, output: &OutputColumn) -> Option<&'static str> {
    if record.is_of_car() {
        return None;
    }
    if record.is_of_axle() {
        let names = Quantity::names().into_iter();
        let mut all =
            names.flat_map(|name| Quantity::named(name).into_iter().map(move |q| (name, q)));
        let found = all.find(|(name, q)| *name == output.output || q.name() == output.output);
        return found.map(|(_, quantity)| quantity.undefined_where());
    }
    let named = |c: &&Characteristic| output.column.starts_with(c.info().name);
    let longest = Characteristic::ALL.iter().filter(named);
    let longest = longest.max_by_key(|c| c.info().name.len());
    longest.map(|c| c.undefined_where())
}

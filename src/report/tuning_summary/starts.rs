//! Starts of a tuning (points at which the search begins) and their results, for the tuning of a study or a car.

use super::misfit_in_words;
use crate::optimise::{Fit, Multistart, Start, Termination};
use crate::report::table::{Cell, Column, Table};
use serde::{Deserialize, Serialize};

/// Largest number of starts that are listed one by one.
const FEW_STARTS: usize = 8;

/// Words before the reason why a start was not begun.
const NOT_BEGUN: &str = "not begun: ";

/// A start of a tuning (point at which the search begins) and its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StartSummary {
    /// Number of the start in the tuning, from 0.
    pub(super) start: usize,
    /// Values of the variables at the start point.
    offsets: Vec<f64>,
    /// Reason why the search ended, or why its start failed.
    pub(super) ended: String,
    /// Number of iterations. `None` if the search did not begin.
    iterations: Option<u64>,
    /// Number of evaluations of the targets.
    evaluations: Option<u64>,
    /// Misfit at the end of the search, as a multiple of the tolerances.
    misfit: Option<f64>,
    /// Residual of the optimality conditions (KKT) at the result of this start, defined as in the summary of the tuning.
    #[serde(default)]
    kkt_residual: Option<f64>,
}

impl StartSummary {
    /// Summaries of all starts.
    pub fn all(of: &Multistart) -> Vec<Self> {
        let starts = of.starts.iter().enumerate();
        starts
            .map(|(number, start)| StartSummary::of(number, start))
            .collect()
    }

    fn of(number: usize, start: &Start) -> Self {
        let outcome = start.outcome.as_ref();
        let ended = match outcome {
            Ok(fit) => fit.ended(),
            Err(infeasible) => format!("{NOT_BEGUN}{infeasible}"),
        };
        let fit = outcome.ok();
        StartSummary {
            start: number,
            offsets: start.x.iter().map(|v| v + 0.0).collect(),
            ended,
            iterations: fit.map(|fit| fit.history.last().map_or(0, |i| i.iteration)),
            evaluations: fit.map(Fit::evaluations),
            misfit: fit.map(Fit::misfit),
            kkt_residual: fit.and_then(|fit| fit.residual),
        }
    }

    /// Returns true for a start that was interrupted, or that was not begun before the interruption.
    pub(super) fn is_interrupted(&self) -> bool {
        let word = Termination::Interrupted.to_string();
        self.ended.strip_prefix(NOT_BEGUN).unwrap_or(&self.ended) == word
    }
}

/// Short summary of the starts. `best` is the start whose result the tuning keeps, with the misfit `least`. `None` if there are at
/// most 8 starts.
pub fn starts_in_words(starts: &[StartSummary], best: Option<usize>, least: f64) -> Option<String> {
    let all = starts.len();
    if all <= FEW_STARTS {
        return None;
    }
    let ended = starts.iter().filter(|s| !s.is_interrupted());
    let ended: Vec<f64> = ended.filter_map(|s| s.misfit).collect();
    let near = ended.iter().filter(|m| **m <= 1.01 * least + 1e-6).count();
    let worst = ended.iter().copied().fold(least, f64::max);
    let kept = best.map_or_else(String::new, |k| format!(" (start {k} is kept)"));
    let mut text = format!(
        "{all} starts: {near} ended within 1 % of the smallest misfit{kept}; largest misfit: {}",
        misfit_in_words(worst)
    );
    // Each start belongs to at most one of these three kinds.
    for (is_interrupted, has_begun, words) in [
        (false, false, "could not be started"),
        (true, true, "interrupted"),
        (true, false, "not begun before the interruption"),
    ] {
        let of_kind = |s: &&StartSummary| {
            (s.is_interrupted(), s.misfit.is_some()) == (is_interrupted, has_begun)
        };
        match starts.iter().filter(of_kind).count() {
            0 => {}
            some => text += &format!("; {some} {words}"),
        }
    }
    Some(text)
}

/// Table of the starts. `best` is the start whose result the tuning keeps.
pub fn starts_table(starts: &[StartSummary], best: Option<usize>) -> Table {
    let columns = [
        Column::for_readers("start"),
        Column::for_programs("start"),
        Column::for_programs("kept"),
    ];
    let more = ["misfit", "iterations", "ended"].map(Column::from);
    let mut table = Table::with_columns(columns.into_iter().chain(more));
    for s in starts {
        let kept = best == Some(s.start);
        let name = if kept {
            format!("{} (kept)", s.start)
        } else {
            s.start.to_string()
        };
        table.push([
            Cell::from(name),
            s.start.into(),
            kept.into(),
            Cell::by(s.misfit, misfit_in_words),
            s.iterations.into(),
            s.ended.as_str().into(),
        ]);
    }
    table
}

//! Summary of a sweep.

mod notes;

use crate::report::figure::{brief, resolution};
use crate::report::table::{Cell, Column, Table};
use crate::report::text::counted;
use crate::sweep::csv::{append_candidate, rows_header};
use crate::sweep::{Candidate, Effects, FailureCount, SweepRecord, SweepStatistics};
use notes::notes;
use serde::{Deserialize, Serialize};

/// Content of `summary.json` of a sweep.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SweepSummary {
    command: String,
    version: String,
    study: String,
    topology: String,
    /// Method of sampling, as in [`SweepRecord::method`].
    pub(in crate::report) method: String,
    /// Number of requested designs.
    pub(in crate::report) designs: u64,
    /// Number of evaluated designs. It is smaller if the sweep was interrupted.
    pub(in crate::report) done: u64,
    /// Number of designs that were solved at every station.
    pub(in crate::report) solved: u64,
    /// Number of solved designs that violate a constraint.
    #[serde(default)]
    violating: u64,
    /// Number of designs that were solved one by one, because they could not be solved in SIMD lanes.
    #[serde(default)]
    one_by_one: u64,
    /// Number of designs used for mean, standard deviation, r2 and change. They are solved at every station and have a value of
    /// every output. With Saltelli's method, they come only from the two independent samples.
    statistics_designs: u64,
    /// Designs that were not solved everywhere, by status and reason.
    pub(in crate::report) failures: Vec<FailureCount>,
    /// Columns of the variables in the rows of the sweep.
    variables: Vec<String>,
    pub(in crate::report) outputs: Vec<OutputSummary>,
    /// Best designs, sorted by misfit. All are solved at every station and satisfy the constraints that the sweep checks.
    pub(in crate::report) best: Vec<DesignSummary>,
    /// Remarks on the outputs, one per line.
    #[serde(default)]
    pub(in crate::report) notes: Vec<String>,
    /// Numbers of the designs on the Pareto front, if there are several targets. Their rows are in `pareto.csv`.
    pub(in crate::report) pareto: Option<Vec<u64>>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::report) struct OutputSummary {
    column: String,
    /// Unit of the output. Empty for a dimensionless number.
    #[serde(default)]
    unit: String,
    /// Value of the output for the study's own design, if it exists.
    at_design: Option<f64>,
    /// Number of designs with a value of the output. Designs that are not solved everywhere may have one, too.
    count: u64,
    /// Smallest value of the output.
    min: Option<f64>,
    /// Number of the design with the smallest value of the output.
    min_design: Option<u64>,
    /// Largest value of the output.
    max: Option<f64>,
    /// Number of the design with the largest value of the output.
    max_design: Option<u64>,
    /// Mean of the output over the designs that `statistics_designs` counts. `None` without such designs.
    mean: Option<f64>,
    standard_deviation: Option<f64>,
    /// Fraction of the output's variance that a linear least-squares fit explains. `None` for an output that no design changes.
    r2: Option<f64>,
    effects: Vec<EffectSummary>,
}

/// Effect of a variable on an output, see [`crate::sweep::Effects`].
#[derive(Clone, Debug, Serialize, Deserialize)]
struct EffectSummary {
    variable: String,
    /// Change of the output from the lower to the upper end of the variable's range.
    change: Option<f64>,
    /// First-order Sobol index: fraction of the output's variance that the variable causes alone.
    share: Option<f64>,
    /// Total Sobol index: fraction of the output's variance that the variable causes, with its interactions. Only for Saltelli's
    /// method.
    total: Option<f64>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::report) struct DesignSummary {
    /// Number of the design.
    pub(in crate::report) design: u64,
    pub(in crate::report) misfit: f64,
    /// RMS deviation from each target, as a multiple of its tolerance.
    pub(in crate::report) rms: Vec<f64>,
    /// Values of the variables in this design.
    pub(in crate::report) variables: Vec<f64>,
}

impl SweepSummary {
    /// Summarises a sweep or some of its parts.
    pub fn of(record: &SweepRecord, statistics: &SweepStatistics) -> Self {
        let effects = Effects::all(record, statistics);
        let (misfit, deviations) = (record.misfit(), record.deviations());
        let best = statistics.best.iter().map(|c: &Candidate| DesignSummary {
            design: c.design,
            misfit: misfit.map_or(f64::NAN, |m| c.outputs[m]),
            rms: deviations.iter().map(|k| c.outputs[*k]).collect(),
            variables: c.variables.clone(),
        });
        let several = deviations.len() > 1;
        SweepSummary {
            command: "sweep".to_owned(),
            version: record.version.clone(),
            study: record.study.clone(),
            topology: record.topology.clone(),
            method: record.method.clone(),
            designs: record.designs,
            done: statistics.designs,
            solved: statistics.solved,
            violating: statistics.violators,
            one_by_one: statistics.one_by_one,
            statistics_designs: statistics.moments.count,
            failures: statistics.failures.clone(),
            variables: record.variables.iter().map(|v| v.column.clone()).collect(),
            outputs: (0..record.outputs.len())
                .map(|k| output(record, statistics, effects.as_ref().map(|e| &e[k]), k))
                .collect(),
            best: best.collect(),
            notes: notes(record, statistics),
            pareto: several.then(|| statistics.front.sorted().iter().map(|c| c.design).collect()),
        }
    }

    /// Result of the sweep in a sentence.
    pub fn headline(&self) -> String {
        let mut failed = match self.done - self.solved {
            0 => "all solved".to_owned(),
            failed => format!("{failed} not solved everywhere"),
        };
        if self.violating > 0 {
            failed += &format!(", {} outside the constraints", self.violating);
        }
        match self.done {
            done if done == self.designs => format!("{}, {failed}", counted(done, "design")),
            0 => format!(
                "none of {} done yet; --resume continues",
                counted(self.designs, "design")
            ),
            _ => format!(
                "{} of {}, {failed}; --resume continues",
                self.done,
                counted(self.designs, "design")
            ),
        }
    }

    /// True if every design was evaluated.
    pub fn is_done(&self) -> bool {
        self.done == self.designs
    }

    /// True if at least one design was evaluated.
    pub fn has_designs(&self) -> bool {
        self.done > 0
    }

    /// Remarks on the outputs, one per line.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// True if every design was evaluated and solved at every station, and some design has a value of each output.
    pub fn is_complete(&self) -> bool {
        let is_empty = |output: &OutputSummary| output.count == 0;
        let lacks = self.solved > 0 && self.outputs.iter().any(is_empty);
        self.done == self.designs && self.solved == self.done && !lacks
    }

    /// Table of the designs that were not solved everywhere, by status and reason. Empty if all were solved.
    pub fn failures_table(&self) -> Table {
        let mut table = Table::with_columns([
            Column::from("not solved"),
            "designs".into(),
            Column::named("nearest failure at", "nearest at"),
            Column::named("examples", "such as"),
            Column::named("reason", "because"),
        ]);
        for f in &self.failures {
            let examples: Vec<String> = f.examples.iter().map(u64::to_string).collect();
            table.push([
                Cell::from(f.status.as_str()),
                f.designs.into(),
                f.nearest.into(),
                examples.join(" ").into(),
                f.reason.as_str().into(),
            ]);
        }
        table
    }

    /// Table of the variables with the largest effects on each output. Empty if the effects are not known.
    pub fn main_effects_table(&self) -> Table {
        let mut table = Table::new(["output", "main effects"]);
        for output in &self.outputs {
            let words = output.what_matters();
            if !words.is_empty() {
                table.push([Cell::from(output.column.as_str()), words.into()]);
            }
        }
        table
    }

    /// Heading of [`SweepSummary::main_effects_table`], which explains its numbers.
    pub fn main_effects_heading(&self) -> &'static str {
        let mut effects = self.outputs.iter().flat_map(|output| &output.effects);
        if effects.any(|effect| effect.share.is_some()) {
            "What matters most: shares of the variables in the variance of each output"
        } else {
            "What matters most: change of each output from the lower to the upper end of a variable's range"
        }
    }

    /// Table with the range of every output.
    pub fn ranges_table(&self) -> Table {
        self.table_of_outputs(false)
    }

    /// Table with the range of every output, and the variables with the largest effect on it.
    pub fn outputs_table(&self) -> Table {
        self.table_of_outputs(true)
    }

    fn table_of_outputs(&self, with_effects: bool) -> Table {
        let columns = ["output", "at design", "min", "max"].map(Column::from);
        let words = with_effects.then(|| Column::for_readers("main effects"));
        let programs = ["unit", "count", "mean", "standard deviation", "r2"];
        let programs = programs.map(Column::for_programs);
        let mut table = Table::with_columns(columns.into_iter().chain(words).chain(programs));
        for output in &self.outputs {
            let values = [output.at_design, output.min, output.max];
            let mut row = vec![Cell::from(output.column.as_str())];
            row.extend(Cell::figures(values, &output.unit));
            row.extend(with_effects.then(|| output.what_matters().into()));
            row.extend([output.unit.as_str().into(), output.count.into()]);
            row.extend([output.mean, output.standard_deviation, output.r2].map(Cell::from));
            table.push_row(row);
        }
        table
    }

    /// Machine-readable table with the effect of each variable on each output.
    pub fn effects_table(&self) -> Table {
        let mut table = Table::new(["output", "variable", "change", "share", "total"]);
        for output in &self.outputs {
            for effect in &output.effects {
                table.push([
                    Cell::from(output.column.as_str()),
                    effect.variable.as_str().into(),
                    effect.change.into(),
                    effect.share.into(),
                    effect.total.into(),
                ]);
            }
        }
        table
    }

    /// Explains which designs the statistics use, for Saltelli's method. `None` for other methods.
    pub fn of_which(&self) -> Option<String> {
        (self.method == "saltelli").then(|| {
            format!(
                "Mean, standard deviation, r2 and change refer to the {} designs of the two independent samples. Min \
                 and max refer to all designs. Shares refer to the groups of Saltelli's method without a failed design.",
                self.statistics_designs
            )
        })
    }

    /// Table of the best designs by misfit, with their variables. Empty without targets.
    pub fn best_table(&self) -> Table {
        let mut header = vec!["design".to_owned(), "misfit".to_owned()];
        header.extend(self.variables.iter().cloned());
        let mut table = Table::with_columns(header);
        for design in &self.best {
            let mut row = vec![Cell::from(design.design), design.misfit.into()];
            row.extend(design.variables.iter().map(|v| Cell::from(*v)));
            table.push_row(row);
        }
        table
    }

    /// Numbers of at most `most` representative designs: the best designs, then some designs of the Pareto front. Without ranked
    /// designs: the designs with the smallest or largest value of an output.
    pub fn representative_designs(&self, most: usize) -> Vec<u64> {
        let mut telling: Vec<u64> = self.best.iter().map(|d| d.design).collect();
        let front = self.pareto.as_deref().unwrap_or_default();
        let step = front
            .len()
            .div_ceil(most.saturating_sub(telling.len()).max(1))
            .max(1);
        telling.extend(front.iter().step_by(step));
        if telling.is_empty() {
            let moved = self.outputs.iter().filter(|o| !o.is_unmoved());
            let ends = moved.flat_map(|o| [o.min_design, o.max_design]);
            telling.extend(ends.flatten());
        }
        let mut seen = std::collections::BTreeSet::new();
        telling.retain(|design| seen.insert(*design));
        telling.truncate(most);
        telling
    }

    /// Number of designs on the Pareto front, if there is one.
    pub fn on_front(&self) -> Option<usize> {
        self.pareto.as_ref().map(Vec::len)
    }
}

/// Content of `pareto.csv`, if there are several targets: the rows of the designs on the Pareto front.
pub fn pareto_csv(record: &SweepRecord, statistics: &SweepStatistics) -> Option<Vec<u8>> {
    if record.deviations().len() < 2 {
        return None;
    }
    let mut csv = rows_header(record);
    for candidate in statistics.front.sorted() {
        append_candidate(candidate, &mut csv);
    }
    Some(csv)
}

/// Summary of the output with index `k`.
fn output(
    record: &SweepRecord,
    statistics: &SweepStatistics,
    effects: Option<&Effects>,
    k: usize,
) -> OutputSummary {
    let (column, range) = (&record.outputs[k], statistics.ranges[k]);
    let of = effects.map_or(&[][..], |e| &e.of);
    let named = record.variables.iter().zip(of);
    // If the range is only rounding error, shares and slopes would be random numbers.
    let is_moved = range.is_some_and(|r| !is_rounding(r.max.0 - r.min.0, &column.unit));
    OutputSummary {
        column: column.column.clone(),
        unit: column.unit.clone(),
        at_design: column.at_design,
        count: range.map_or(0, |r| r.count),
        min: range.map(|r| r.min.0),
        min_design: range.map(|r| r.min.1),
        max: range.map(|r| r.max.0),
        max_design: range.map(|r| r.max.1),
        mean: effects.map(|e| e.mean),
        standard_deviation: effects.map(|e| e.deviation),
        r2: effects.and_then(|e| e.r2).filter(|_| is_moved),
        effects: named
            .map(|(variable, effect)| EffectSummary {
                variable: variable.column.clone(),
                change: effect.linear_change.filter(|_| is_moved),
                share: effect.first_order_index.filter(|_| is_moved),
                total: effect.total.filter(|_| is_moved),
            })
            .collect(),
    }
}

/// True if a range of values is only rounding error in its unit.
fn is_rounding(range: f64, unit: &str) -> bool {
    range < resolution(unit)
}

impl OutputSummary {
    /// True if no design changes the output by more than rounding error.
    pub(in crate::report) fn is_unmoved(&self) -> bool {
        let range = self.min.zip(self.max);
        range.is_none_or(|(min, max)| is_rounding(max - min, &self.unit))
    }

    /// Names of the three variables with the largest effects on the output, with these effects: shares of the output's variance in
    /// percent, or else changes of the output. Shares below 0.5 % are left out. Empty if no design changes the output.
    fn what_matters(&self) -> String {
        if self.is_unmoved() {
            return String::new();
        }
        let mut ranked: Vec<(f64, String)> = self
            .effects
            .iter()
            .filter_map(|e| match (e.share, e.change) {
                (Some(share), _) if share >= 0.005 => {
                    Some((share, format!("{} {:.0}%", e.variable, 100.0 * share)))
                }
                (None, Some(change)) if change != 0.0 => {
                    let sign = if change > 0.0 { "+" } else { "" };
                    let text = format!("{} {sign}{}", e.variable, brief(change));
                    Some((change.abs(), text))
                }
                _ => None,
            })
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let words: Vec<String> = ranked.into_iter().take(3).map(|(_, text)| text).collect();
        words.join(", ")
    }
}

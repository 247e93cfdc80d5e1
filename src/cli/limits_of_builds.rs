//! `hardpoint limits --builds`: smallest limits of the builds of `[tolerance]`.

use super::StudyArguments;
use super::exit::{Exit, Stop};
use super::limits::{Row, ranges, ranges_by_rack, rod_travel, straight, travel_left};
use super::output::{design_fault, pool};
use super::printer::Printer;
use super::progress;
use super::tolerance::{problem, tolerance_of};
use crate::analyse::Range;
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::plan::Plan;
use crate::report::{Cell, Column, Table, brief};
use crate::solve::Solver;
use crate::study::{Drive, Study};
use rayon::prelude::*;
use std::num::NonZeroU64;

pub(super) fn run(
    arguments: &StudyArguments,
    study: &Study,
    count: NonZeroU64,
) -> Result<Exit, Stop> {
    let path = &arguments.study;
    let why = "builds are examined one wheel at a time";
    super::axle::refuse(study, path, "limits --builds", why)?;
    let tolerance = tolerance_of(study, path)?;
    let problem = problem(study, tolerance, path)?;
    let drawn = LimitRanges::of(study, &study.suspension);
    let drawn = drawn.map_err(|fault| design_fault(study, path, &fault))?;
    let line = progress::line(count.get(), "builds");
    let least = pool(None, count.get())?.install(|| {
        let builds = (0..count.get()).into_par_iter().map(|number| {
            let built = problem.built(number).ok();
            let ranges = built.and_then(|built| LimitRanges::of(study, &built).ok());
            line.inc(1);
            Least::of(number, ranges)
        });
        builds.reduce(Least::default, Least::and)
    });
    line.finish_and_clear();

    let mut out = Printer::new(arguments.format);
    out.table("limits", table(&drawn, &least))?;
    out.say("\n")?;
    let mut counts = Table::new(["builds", "number", "first"]);
    // Not available for the paper's drive.
    let short = (study.motion.drive != Drive::PaperTheta).then_some(least.short);
    for (what, found) in [
        ("cannot be assembled", Some(least.rejected)),
        ("do not reach the study's motion", short),
    ] {
        let (number, first) = found.unzip();
        counts.push_row([Cell::from(what), number.into(), first.flatten().into()]);
    }
    counts.push_row([Cell::from("all"), count.get().into(), "".into()]);
    out.table("builds", counts)?;
    if let Some((margin, build)) = least.margin
        && study.motion.drive == Drive::Travel
    {
        let unit = study.suspension.length_unit.symbol();
        let left = match margin >= 0.0 {
            true => format!(
                "Nearest travel limit: at least {} {unit} away",
                brief(margin)
            ),
            false => format!(
                "The motion goes up to {} {unit} beyond the travel limit",
                brief(-margin)
            ),
        };
        out.say(&format!("\n{left} (build {build}).\n"))?;
    }
    out.finish()?;
    Ok(Exit::Done)
}

/// Limits of one mechanism.
struct LimitRanges {
    /// Rows of the table: quantity, held quantities, lower and upper limit.
    rows: Vec<(String, String, [f64; 2])>,
    /// Margin from the study's motion to the nearest limit; negative beyond it. `None` with the paper's drive.
    margin: Option<f64>,
}

impl LimitRanges {
    fn of(study: &Study, suspension: &Suspension) -> Result<Self, DesignFault> {
        let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
        let limits = solver.limits()?;
        let by_rack = ranges_by_rack(study, &mut solver)?;
        let ends = |(row, range): (Row, &Range)| {
            let mut ends = range.ends().map(|end| end * row.factor);
            if row.factor < 0.0 {
                ends.reverse();
            }
            (row.quantity, row.at, ends)
        };
        let rows = ranges(study, &limits, &by_rack).into_iter();
        let mut rows: Vec<_> = rows.map(ends).collect();
        let [lower, upper] = limits.travel.ends();
        for range in &limits.rockers {
            let ends = [
                range.lower.as_ref().map_or(lower, |toggle| toggle.travel),
                range.upper.as_ref().map_or(upper, |toggle| toggle.travel),
            ];
            let name = rod_travel(study, range.rocker);
            rows.push((name, straight(&limits).to_owned(), ends));
        }
        let plan = Plan::of(study);
        let by_rack = by_rack.iter().map(|(_, range)| range);
        let margin = travel_left(by_rack, plan.station_order.values());
        Ok(LimitRanges {
            margin: (study.motion.drive != Drive::PaperTheta).then_some(margin),
            rows,
        })
    }
}

/// Smallest limits of some builds; of equal limits, those of the first build.
#[derive(Default)]
struct Least {
    /// For each row of [`LimitRanges`]: the largest lower and the smallest upper limit, each with its build.
    rows: Vec<[(f64, u64); 2]>,
    margin: Option<(f64, u64)>,
    /// Number of builds that cannot be assembled or cannot move, and the first.
    rejected: (u64, Option<u64>),
    /// Number of builds that do not reach the motion of the study, and the first.
    short: (u64, Option<u64>),
}

impl Least {
    fn of(build: u64, ranges: Option<LimitRanges>) -> Self {
        let Some(ranges) = ranges else {
            return Least {
                rejected: (1, Some(build)),
                ..Least::default()
            };
        };
        let rows = ranges.rows.iter();
        let is_short = ranges.margin.is_some_and(|margin| margin < 0.0);
        Least {
            rows: rows.map(|(.., ends)| ends.map(|e| (e, build))).collect(),
            margin: ranges.margin.map(|margin| (margin, build)),
            rejected: (0, None),
            short: (u64::from(is_short), is_short.then_some(build)),
        }
    }

    /// Combines these limits with those of builds with higher numbers.
    fn and(mut self, later: Least) -> Least {
        if self.rows.is_empty() {
            self.rows = later.rows;
        } else {
            for (mine, theirs) in self.rows.iter_mut().zip(later.rows) {
                let [lower, upper] = theirs;
                if lower.0 > mine[0].0 {
                    mine[0] = lower;
                }
                if upper.0 < mine[1].0 {
                    mine[1] = upper;
                }
            }
        }
        self.margin = match (self.margin, later.margin) {
            (Some(mine), Some(theirs)) if theirs.0 < mine.0 => Some(theirs),
            (mine, theirs) => mine.or(theirs),
        };
        let counted = |mine: (u64, Option<u64>), theirs: (u64, Option<u64>)| {
            (mine.0 + theirs.0, mine.1.or(theirs.1))
        };
        self.rejected = counted(self.rejected, later.rejected);
        self.short = counted(self.short, later.short);
        self
    }
}

/// Table of the limits of the nominal design and the smallest limits of all builds.
fn table(drawn: &LimitRanges, least: &Least) -> Table {
    let mut table = Table::with_columns([
        Column::from("quantity"),
        "at".into(),
        Column::named("lower limit, nominal", "from"),
        Column::named("of all builds", "nearest"),
        Column::named("build", "in build"),
        Column::named("upper limit, nominal", "to"),
        Column::named("of all builds", "nearest there"),
        Column::named("build", "in build there"),
    ]);
    let mut builds = least.rows.iter();
    for (quantity, at, [from, to]) in &drawn.rows {
        let ends = builds.next().map_or([None; 2], |ends| ends.map(Some));
        let mut row = [quantity, at].map(|text| text.as_str().into()).to_vec();
        for (drawn, end) in [from, to].into_iter().zip(ends) {
            let (least, build) = end.unzip();
            row.extend([Cell::from(*drawn), least.into(), build.into()]);
        }
        table.push_row(row);
    }
    table.keyed(2)
}

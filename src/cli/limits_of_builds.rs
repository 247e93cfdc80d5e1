//! `hardpoint limits --builds`: nearest limits among the builds of `[tolerance]`.

use super::StudyArguments;
use super::exit::{Exit, Stop};
use super::output::pool;
use super::printer::Printer;
use super::progress;
use super::tolerance::{problem, tolerance_of};
use crate::analyse::Range;
use crate::axle::{Axle, AxlePlan, axle_curves};
use crate::limits::{
    ElasticRow, Row, ranges, ranges_by_rack, rod_travel, rows_of_axle, rows_of_wheel, straight,
    travel_left, travel_rows,
};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::plan::Plan;
use crate::report::{Cell, Column, Table, brief};
use crate::solve::Solver;
use crate::study::{Drive, Study, Vehicle, WheelStudy};
use crate::tolerance::Problem;
use rayon::prelude::*;
use std::num::NonZeroU64;

pub(super) fn run(
    arguments: &StudyArguments,
    study: &Study,
    count: NonZeroU64,
) -> Result<Exit, Stop> {
    let path = &arguments.study;
    let tolerance = tolerance_of(study, path)?;
    let problem = problem(study, tolerance, path)?;
    let drawn = LimitRanges::of_vehicle(study, &study.vehicle);
    let drawn = drawn.map_err(|reason| Stop::in_file(path, reason))?;
    let line = progress::line(count.get(), "builds");
    let least = pool(None, count.get())?.install(|| {
        let builds = (0..count.get()).into_par_iter().map(|number| {
            let ranges = LimitRanges::of_build(study, &problem, number);
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
    // With the drive of Attia's paper, limits and motion are not compared.
    let short = (study.motion().drive != Drive::PaperTheta).then_some(least.short);
    let rejected = if study.is_elastic() {
        "cannot be assembled, or have no static equilibrium"
    } else {
        "cannot be assembled"
    };
    let mut numbers = vec![
        (rejected, Some(least.rejected)),
        ("do not reach the study's motion", short),
    ];
    if study.axle().is_some() && !study.is_elastic() {
        numbers.push(("have an unknown limit of roll", Some(least.unknown)));
    }
    for (what, found) in numbers {
        let (number, first) = found.unzip();
        counts.push_row([Cell::from(what), number.into(), first.flatten().into()]);
    }
    counts.push_row([Cell::from("all"), count.get().into(), "".into()]);
    out.table("builds", counts)?;
    if let Some((margin, build)) = least.margin
        && study.motion().drive == Drive::Travel
    {
        let unit = study.wheel().length_unit.symbol();
        let left = if margin >= 0.0 {
            format!(
                "Nearest travel limit: at least {} {unit} away",
                brief(margin)
            )
        } else {
            format!(
                "The motion goes up to {} {unit} beyond the travel limit",
                brief(-margin)
            )
        };
        out.say(&format!("\n{left} (build {build}).\n"))?;
    }
    out.finish()?;
    Ok(Exit::Done)
}

/// Limits of one mechanism.
struct LimitRanges {
    /// Rows of the table: quantity, held quantities, lower limit and upper limit.
    rows: Vec<(String, String, [f64; 2])>,
    /// Distance from the study's motion to the nearest limit; negative if the motion goes beyond it. `None` with the drive of
    /// Attia's paper, and for an elastic wheel whose limit is not known. Also `None` for axles, because their motion has several
    /// quantities.
    margin: Option<f64>,
    /// True if the study's motion goes beyond the limits.
    is_short: bool,
}

impl LimitRanges {
    /// Limits of a vehicle: that of the study, or a build. An error says why the vehicle has no limits.
    fn of_vehicle(study: &Study, vehicle: &Vehicle) -> Result<Self, String> {
        match vehicle {
            Vehicle::Wheel(own) => {
                let fault = |fault: DesignFault| fault.describe(&own.suspension.mechanism);
                let Some(elastic) = &own.compliance else {
                    return LimitRanges::of(study, own).map_err(fault);
                };
                let (rows, margin) = rows_of_wheel(own, elastic).map_err(fault)?;
                let is_short = margin.is_some_and(|margin| margin < 0.0);
                LimitRanges::of_equilibria(rows, margin, is_short)
            }
            Vehicle::Axle(both) => {
                let axle = &both.axle;
                let fault = |fault| axle.describe_fault(fault);
                let Some(elastic) = &axle.elastic else {
                    return LimitRanges::of_axle(axle, &both.plan).map_err(fault);
                };
                let rows = rows_of_axle(axle, elastic)?;
                let positions = AxlePlan::of(both.plan.motion.clone(), Vec::new());
                let moved = axle_curves(axle, &positions).map_err(fault)?.curves;
                LimitRanges::of_equilibria(rows, None, !moved.are_complete())
            }
        }
    }

    /// Limits of equilibrium.
    fn of_equilibria(
        rows: Vec<ElasticRow>,
        margin: Option<f64>,
        is_short: bool,
    ) -> Result<Self, String> {
        let limits = rows.into_iter().map(ElasticRow::limits);
        let limits: Option<Vec<(Row, [f64; 2])>> = limits.collect();
        let limits = limits.ok_or("the design position has no equilibrium")?;
        let rows = limits.into_iter().map(|(row, ends)| in_table(row, ends));
        Ok(LimitRanges {
            rows: rows.collect(),
            margin,
            is_short,
        })
    }

    fn of(study: &Study, own: &WheelStudy) -> Result<Self, DesignFault> {
        let suspension = &own.suspension;
        let plan = Plan::of(own);
        let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
        let limits = solver.limits()?;
        let by_rack = ranges_by_rack(&plan, &mut solver)?;
        let rows = ranges(study, &limits, &by_rack).into_iter();
        let ends = |(row, range): (Row, &Range)| in_table(row, range.ends());
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
        let by_rack = by_rack.iter().map(|(_, range)| range);
        let margin = travel_left(by_rack, plan.station_order.values());
        let margin = (study.motion().drive != Drive::PaperTheta).then_some(margin);
        Ok(LimitRanges {
            is_short: margin.is_some_and(|margin| margin < 0.0),
            margin,
            rows,
        })
    }

    /// Limits of an axle. NaN for an unknown roll limit.
    fn of_axle(axle: &Axle, plan: &AxlePlan) -> Result<Self, (Side, DesignFault)> {
        let limits = axle.limits()?;
        let travels = travel_rows(axle, &limits).into_iter();
        let travels = travels.map(|(row, range)| in_table(row, range.ends()));
        let mut rows: Vec<_> = travels.collect();
        if let Some(ends) = &limits.rack {
            let ends = ends.each_ref().map(|end| end.value);
            rows.push(in_table(Row::axle_rack(axle), ends));
        }
        if axle.setup.wheel_radius.is_some() {
            let ends = limits.roll.each_ref();
            let ends = ends.map(|end| end.as_ref().map_or(f64::NAN, |end| end.value));
            rows.push(in_table(Row::roll(), ends));
        }
        let positions = AxlePlan::of(plan.motion.clone(), Vec::new());
        let placed = axle_curves(axle, &positions)?.placed;
        Ok(LimitRanges {
            rows,
            margin: None,
            is_short: placed.iter().any(Result::is_err),
        })
    }

    /// Limits of one build. `None` if it cannot be assembled, cannot move or has no equilibrium.
    fn of_build(study: &Study, problem: &Problem, number: u64) -> Option<Self> {
        let built = problem.built_vehicle(number).ok()?;
        LimitRanges::of_vehicle(study, &built).ok()
    }

    /// True if a limit is unknown.
    fn is_unknown(&self) -> bool {
        let mut ends = self.rows.iter().flat_map(|(.., ends)| ends);
        ends.any(|end| end.is_nan())
    }
}

/// Row with its limits as the table shows them.
fn in_table(row: Row, ends: [f64; 2]) -> (String, String, [f64; 2]) {
    let ends = row.in_table(ends);
    (row.quantity, row.at, ends)
}

/// Nearest limits among some builds. If limits are equal, the first build counts.
#[derive(Default)]
struct Least {
    /// For each row of [`LimitRanges`]: the largest lower limit and the smallest upper limit, each with its build.
    rows: Vec<[(f64, u64); 2]>,
    margin: Option<(f64, u64)>,
    /// Number of builds that cannot be assembled or cannot move, and number of the first one.
    rejected: (u64, Option<u64>),
    /// Number of builds that do not reach the motion of the study, and number of the first one.
    short: (u64, Option<u64>),
    /// Number of builds with an unknown limit, and number of the first one.
    unknown: (u64, Option<u64>),
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
        let counted = |is: bool| (u64::from(is), is.then_some(build));
        Least {
            rows: rows.map(|(.., ends)| ends.map(|e| (e, build))).collect(),
            margin: ranges.margin.map(|margin| (margin, build)),
            rejected: (0, None),
            short: counted(ranges.is_short),
            unknown: counted(ranges.is_unknown()),
        }
    }

    /// Merges these limits with the limits of builds that have higher numbers.
    fn and(mut self, later: Least) -> Least {
        if self.rows.is_empty() {
            self.rows = later.rows;
        } else {
            for (mine, theirs) in self.rows.iter_mut().zip(later.rows) {
                let [lower, upper] = theirs;
                if lower.0 > mine[0].0 || mine[0].0.is_nan() {
                    mine[0] = lower;
                }
                if upper.0 < mine[1].0 || mine[1].0.is_nan() {
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
        self.unknown = counted(self.unknown, later.unknown);
        self
    }
}

/// Table of the limits of the nominal design, and of the nearest limits of all builds.
fn table(drawn: &LimitRanges, least: &Least) -> Table {
    // A nearer limit can be among the unknown ones.
    let (unknown, _) = least.unknown;
    let builds = if unknown == 0 {
        "of all builds"
    } else {
        "of builds with a known limit"
    };
    let mut table = Table::with_columns([
        Column::from("quantity"),
        "at".into(),
        Column::named("lower limit, nominal", "from"),
        Column::named(builds, "nearest"),
        Column::named("build", "in build"),
        Column::named("upper limit, nominal", "to"),
        Column::named(builds, "nearest there"),
        Column::named("build", "in build there"),
    ]);
    let mut builds = least.rows.iter();
    for (quantity, at, [from, to]) in &drawn.rows {
        let known = |end: (f64, u64)| Some(end).filter(|(value, _)| !value.is_nan());
        let ends = builds.next().map_or([None; 2], |ends| ends.map(known));
        let mut row = [quantity, at].map(|text| text.as_str().into()).to_vec();
        for (drawn, end) in [from, to].into_iter().zip(ends) {
            let (least, build) = end.unzip();
            let drawn = Some(*drawn).filter(|drawn| !drawn.is_nan());
            row.extend([Cell::from(drawn), least.into(), build.into()]);
        }
        table.push_row(row);
    }
    table.keyed(2)
}

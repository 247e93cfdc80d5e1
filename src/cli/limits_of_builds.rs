//! `hardpoint limits --builds`: nearest limits among the builds of `[tolerance]` (assembled parts with random deviations).

use super::StudyArguments;
use super::exit::{Exit, Stop};
use super::output::pool;
use super::printer::Printer;
use super::progress;
use super::tolerance::{problem, tolerance_of};
use crate::limits::{NearestLimits, VehicleLimits};
use crate::report::{Cell, Column, Table, brief};
use crate::study::{Drive, Study};
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
    let drawn = VehicleLimits::of_vehicle(study, &study.vehicle);
    let drawn = drawn.map_err(|reason| Stop::in_file(path, reason))?;
    let line = progress::line(count.get(), "builds");
    let nearest = pool(None, count.get())?.install(|| {
        let builds = (0..count.get()).into_par_iter().map(|number| {
            let limits = VehicleLimits::of_build(study, &problem, number);
            line.inc(1);
            NearestLimits::of(number, limits)
        });
        builds.reduce(NearestLimits::default, NearestLimits::and)
    });
    line.finish_and_clear();

    let mut out = Printer::new(arguments.format);
    out.table("limits", table(&drawn, &nearest))?;
    out.say("\n")?;
    let mut counts = Table::new(["builds", "number", "first"]);
    // With the drive of Attia's paper, the limits are not compared with the motion. So it is not known which builds cannot
    // reach the motion.
    let short = (study.motion().drive != Drive::PaperTheta).then_some(nearest.short);
    let rejected = if study.is_elastic() {
        "cannot be assembled, or have no static equilibrium"
    } else {
        "cannot be assembled"
    };
    let mut numbers = vec![
        (rejected, Some(nearest.rejected)),
        ("do not reach the study's motion", short),
    ];
    if study.axle().is_some() && !study.is_elastic() {
        numbers.push(("have an unknown limit of roll", Some(nearest.unknown)));
    }
    for (what, found) in numbers {
        let (number, first) = found.unzip();
        counts.push_row([Cell::from(what), number.into(), first.flatten().into()]);
    }
    counts.push_row([Cell::from("all"), count.get().into(), "".into()]);
    out.table("builds", counts)?;
    if let Some((margin, build)) = nearest.margin
        && study.motion().drive == Drive::Travel
    {
        let unit = study.wheel().length_unit.symbol();
        // A margin of at least 0 means that the travels of the motion are within the travel limits of all builds. A build that
        // still does not reach the motion then does not reach one of the rack displacements.
        let where_reached = match nearest.short {
            (0, _) => "",
            _ => " at the rack positions that can be reached",
        };
        let left = if margin >= 0.0 {
            format!(
                "Nearest travel limit{where_reached}: at least {} {unit} of wheel travel away",
                brief(margin)
            )
        } else {
            format!(
                "The motion goes up to {} {unit} of wheel travel beyond the travel limit",
                brief(-margin)
            )
        };
        out.say(&format!("\n{left} (build {build}).\n"))?;
    }
    out.finish()?;
    Ok(Exit::Done)
}

/// Table of the limits of the nominal design, and of the nearest limits of all builds.
fn table(drawn: &VehicleLimits, nearest: &NearestLimits) -> Table {
    // A build with an unknown limit may have a nearer limit. The column headings then name only the builds with a known limit.
    let (unknown, _) = nearest.unknown;
    let [lower, upper] = if unknown == 0 {
        ["lower limit, all builds", "upper limit, all builds"]
    } else {
        [
            "lower limit, builds with a known limit",
            "upper limit, builds with a known limit",
        ]
    };
    let mut table = Table::with_columns([
        Column::from("quantity"),
        "at".into(),
        Column::named("lower limit, nominal", "from"),
        Column::named(lower, "nearest"),
        Column::named("build", "in build"),
        Column::named("upper limit, nominal", "to"),
        Column::named(upper, "nearest there"),
        Column::named("build", "in build there"),
    ]);
    let mut rows = nearest.rows.iter();
    for drawn in &drawn.rows {
        let of_builds = rows.next();
        let mut row = vec![
            Cell::from(drawn.quantity.as_str()),
            drawn.at.as_str().into(),
        ];
        for (k, drawn) in drawn.ends.iter().enumerate() {
            let nearest = of_builds.map(|ends| &ends[k]);
            let found = nearest.and_then(|nearest| Some((nearest.end.value?, nearest.build)));
            let (value, build) = found.unzip();
            row.extend([Cell::from(drawn.value), value.into(), build.into()]);
        }
        table.push_row(row);
    }
    table.keyed(2)
}

//! Limits of a study with elastic parts: the values beyond which there is no equilibrium.
//!
//! A range of travel or rack displacement ends where the stiffness against a motion of a part falls to zero. The range of a
//! load ends at the largest load that the suspension can carry. The table also shows the limits of the mechanism with rigid
//! parts.

use super::margin::travel_left_in_words;
use super::row::{LOST, LimitRow, Row};
use super::{Found, travel_rows};
use crate::axle::Axle;
use crate::compliance::{
    AxleKcRun, AxleWay, DrivingForce, EndCause, EquilibriumEnd, Event, HeldQuantity, KcRun, KcTest,
    LARGEST_FORCE, NoEquilibrium, TestLoad, TestMode,
};
use crate::mechanism::DesignFault;
use crate::model::{Axis, Body, LengthUnit, Side, Suspension};
use crate::report::{as_written, brief, no_equilibrium, weakest_motion};
use crate::solve::Solver;
use crate::study::{AxleComplianceStudy, AxleStudy, ComplianceStudy, Study, WheelStudy};

/// Words for the limits of the mechanism whose parts are all rigid.
const RIGID: &str = "all parts rigid";

/// Lower and upper limit of a quantity at which equilibrium ends. An error is the reason why the state at which the search starts
/// has no equilibrium.
type Ends = Result<[EquilibriumEnd; 2], NoEquilibrium>;

/// Limits of equilibrium of one quantity, such as a travel or a load.
pub(super) struct ElasticRow {
    row: Row,
    /// Unit of the values in the descriptions of the limits' causes.
    unit: &'static str,
    ends: Ends,
}

impl ElasticRow {
    /// True if the state at which the search starts has an equilibrium.
    fn has_equilibrium(&self) -> bool {
        self.ends.is_ok()
    }

    /// Row with both limits and their causes.
    fn found(self) -> LimitRow {
        let ends = match self.ends {
            Ok(ends) => ends.map(|end| {
                let value = (end.cause != EndCause::SearchEnds).then_some(end.value);
                (value, cause(&end, self.row.factor, self.unit))
            }),
            Err(why) => [(); 2].map(|()| (None, no_equilibrium(&why))),
        };
        self.row.with(ends)
    }
}

/// Converts all rows for the table of limits. Returns an error if the state at which a search starts has no equilibrium: the
/// design position, or travel 0 with a displaced rack.
pub(super) fn in_equilibrium(rows: Vec<ElasticRow>) -> Result<Vec<LimitRow>, String> {
    if !rows.iter().all(ElasticRow::has_equilibrium) {
        return Err("the design position has no equilibrium".to_owned());
    }
    Ok(rows.into_iter().map(ElasticRow::found).collect())
}

/// Cause of a limit of equilibrium in words, with earlier events such as a lifted wheel. `factor` converts values to `unit`.
fn cause(end: &EquilibriumEnd, factor: f64, unit: &str) -> String {
    let mut text = match &end.cause {
        EndCause::GivesWay { part, motion } => {
            format!("gives way: {}", weakest_motion(part, *motion))
        }
        EndCause::Unstable { part, motion } => {
            format!(
                "unstable beyond this; softest motion: {}",
                weakest_motion(part, *motion)
            )
        }
        EndCause::Force(of) => {
            let force = match of {
                DrivingForce::ContactPoint => "the vertical force at a contact point",
                DrivingForce::Rack => "the force at the rack",
            };
            format!("{force} is {} kN", brief(LARGEST_FORCE / 1000.0))
        }
        EndCause::SearchEnds => format!("no limit up to {} {unit}", brief(end.value * factor)),
        EndCause::Unresolved => LOST.to_owned(),
    };
    for (event, first) in &end.events {
        let event = match event {
            Event::WheelLifts => "wheel lifts",
            Event::StopMet(stop) => stop.name(),
            Event::SpringSlack => "spring slack",
            Event::Extrapolated => "extrapolated",
        };
        text += &format!("; {event} beyond {} {unit}", brief(first * factor));
    }
    text
}

/// Row for the load of a rig test. `at` describes the quantities that stay constant.
fn load_row(test: &KcTest, unit: LengthUnit, at: &str) -> Row {
    let trail = test.trail_suffix();
    let (factor, symbol) = match test.load {
        TestLoad::Aligning => (1.0 / unit.per_metre(), "N_m"),
        _ => (1.0, "N"),
    };
    let held = match test.held {
        HeldQuantity::WheelHeight => "height held",
        HeldQuantity::WheelLoad => "wheel load held",
    };
    let mut at = format!("{at}, {held}");
    match test.mode {
        TestMode::OneWheel => {}
        TestMode::Single(side) => at += &format!(", {} wheel loaded", side.name()),
        mode => at += &format!(", {}", mode.name()),
    }
    if test.mode != TestMode::OneWheel && !test.has_bar {
        at += ", without bar";
    }
    if test.locks_rack {
        at += ", locked rack";
    }
    Row {
        quantity: format!("{}{trail}_{symbol}", test.load.name()),
        at,
        factor,
    }
}

/// Appends a row for the load of each rig test. Tests that differ only in the window or in the load levels share one row. `unit`
/// is the study's length unit. `ends` finds the limits of a test's load.
fn append_loads(
    rows: &mut Vec<ElasticRow>,
    unit: LengthUnit,
    tests: &[KcTest],
    at: &str,
    mut ends: impl FnMut(&KcTest) -> Ends,
) {
    let mut known: Vec<[String; 2]> = Vec::new();
    for test in tests.iter().filter(|test| !test.load.is_motion()) {
        let row = load_row(test, unit, at);
        let key = [row.quantity.clone(), row.at.clone()];
        if known.contains(&key) {
            continue;
        }
        known.push(key);
        let unit = match test.load {
            TestLoad::Aligning => "N m",
            _ => "N",
        };
        let ends = ends(test);
        rows.push(ElasticRow { row, unit, ends });
    }
}

/// Limits of a wheel with elastic parts: of equilibrium, then with all parts rigid. A note states the distance of the study's
/// motion from the nearest travel limit.
pub(super) fn of_wheel(
    study: &Study,
    own: &WheelStudy,
    elastic: &ComplianceStudy,
) -> Result<Found, DesignFault> {
    let suspension = &own.suspension;
    let (rows, left) = rows_of_wheel(own, elastic)?;
    let mut rows: Vec<LimitRow> = rows.into_iter().map(ElasticRow::found).collect();
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
    let rigid = solver.limits()?;
    rows.push(travel_row(suspension, RIGID.to_owned()).of(study, &rigid.travel));
    if let Some(range) = &rigid.rack {
        rows.push(rack_row(suspension, RIGID).of(study, range));
    }
    let unit = suspension.length_unit.symbol();
    let note = left.map(|left| travel_left_in_words(left, unit, ""));
    Ok((rows, note.into_iter().collect()))
}

/// Row for the travel of a wheel. `at` describes the quantities that stay constant.
fn travel_row(suspension: &Suspension, at: String) -> Row {
    Row {
        quantity: format!("travel_{}", suspension.length_unit.symbol()),
        at,
        factor: 1.0,
    }
}

/// Row for the rack of a wheel, in the study's axes.
fn rack_row(suspension: &Suspension, at: &str) -> Row {
    Row {
        quantity: format!("rack_{}", suspension.length_unit.symbol()),
        at: at.to_owned(),
        factor: suspension.frame.sign(Axis::Y),
    }
}

/// Limits of equilibrium of a wheel, and the distance of the study's wheel travels from the nearest travel limit. The distance is
/// negative if the travels go beyond the limit, and `None` if it is not known.
pub(super) fn rows_of_wheel(
    own: &WheelStudy,
    elastic: &ComplianceStudy,
) -> Result<(Vec<ElasticRow>, Option<f64>), DesignFault> {
    let suspension = &own.suspension;
    let run =
        KcRun::new(suspension, &elastic.parts, elastic.tyre_rate).map_err(|why| why.of_design())?;
    let wheel = run.wheel();
    let unit = suspension.length_unit.symbol();
    let sign = suspension.frame.sign(Axis::Y);
    let mut rows = Vec::new();
    let travel = |at: String, ends: &Ends| ElasticRow {
        row: travel_row(suspension, at),
        unit,
        ends: ends.clone(),
    };
    let points = &suspension.mechanism.points;
    let steers = points.iter().any(|point| point.body == Body::Rack);
    let straight = if steers { "rack 0" } else { "" };
    let straight_ends = wheel.travel_ends(0.0);
    rows.push(travel(straight.to_owned(), &straight_ends));
    if steers {
        rows.push(ElasticRow {
            row: rack_row(suspension, "travel 0"),
            unit,
            ends: wheel.rack_ends(),
        });
    }
    let mut by_rack = Vec::new();
    for &rack in &own.motion.rack {
        let ends = if rack == 0.0 {
            straight_ends.clone()
        } else {
            let ends = wheel.travel_ends(sign * rack);
            let at = format!("rack {}", as_written(rack));
            rows.push(travel(at, &ends));
            ends
        };
        by_rack.push(ends);
    }
    let at = if steers {
        "travel 0, rack 0"
    } else {
        "travel 0"
    };
    let length = suspension.length_unit;
    append_loads(&mut rows, length, &elastic.tests, at, |test| {
        run.load_ends(test)
    });
    Ok((rows, margin(&own.motion.values, &by_rack)))
}

/// Distance of the wheel travels from the nearest travel limit, in the study's length unit. `by_rack` has the travel limits at
/// each rack displacement. The distance is negative if the travels go beyond the limit. The end of the search range is no limit.
/// `None` if no limit was found, or if a rack displacement has no equilibrium.
fn margin(travels: &[f64], by_rack: &[Ends]) -> Option<f64> {
    let mut least = f64::INFINITY;
    for ends in by_rack {
        let signed = ends.as_ref().ok()?.iter().zip([-1.0, 1.0]);
        for (end, sign) in signed.filter(|(end, _)| end.cause != EndCause::SearchEnds) {
            for travel in travels {
                least = least.min(sign * (end.value - travel));
            }
        }
    }
    least.is_finite().then_some(least)
}

/// Limits of an axle with elastic parts: of equilibrium, then with all parts rigid. An axle with five links has only the limits of
/// equilibrium, and a note states the reason.
pub(super) fn of_axle(
    study: &Study,
    both: &AxleStudy,
    elastic: &AxleComplianceStudy,
) -> Result<Found, String> {
    let axle = &both.axle;
    let rows = rows_of_axle(axle, elastic)?;
    let mut rows: Vec<LimitRow> = rows.into_iter().map(ElasticRow::found).collect();
    let mut notes = Vec::new();
    if axle.left.mechanism.has_extra_links() {
        notes.push(
            "Five rigid links allow no roll, so the table has no limits with all parts rigid."
                .to_owned(),
        )
    } else {
        let limits = axle.limits().map_err(|f| axle.describe_fault(f))?;
        for (mut row, range) in travel_rows(axle, &limits) {
            row.at = RIGID.to_owned();
            rows.push(row.between(study, &range.lower, &range.upper));
        }
    }
    Ok((rows, notes))
}

/// Limits of equilibrium of an axle: of heave, travels, rack and the loads of rig tests.
pub(super) fn rows_of_axle(
    axle: &Axle,
    elastic: &AxleComplianceStudy,
) -> Result<Vec<ElasticRow>, String> {
    let vehicle = axle.on_rig(elastic.tyre_rate);
    let run = AxleKcRun::new(vehicle, &elastic.parts).map_err(|why| why.describe())?;
    let unit = axle.left.length_unit.symbol();
    let row = |quantity: &str, at: &str| Row::length_of_axle(axle, quantity, at, 1.0);
    let points = &axle.left.mechanism.points;
    let steers = points.iter().any(|point| point.body == Body::Rack);
    let with_rack = |at: &str| {
        if steers {
            format!("{at}, rack 0")
        } else {
            at.to_owned()
        }
    };
    let straight = if steers { "rack 0" } else { "" };
    let mut rows = vec![(AxleWay::Heave, row("heave", straight))];
    for side in Side::ALL {
        let [left, right] = Side::ALL;
        let other = if side == left { right } else { left };
        let other = with_rack(&format!("{} travel 0", other.name()));
        let name = format!("{}_travel", side.name());
        rows.push((AxleWay::Travel(side), row(&name, &other)));
    }
    let opposed = row("travel_difference", &with_rack("heave 0"));
    rows.push((AxleWay::TravelDifference, opposed));
    if steers {
        rows.push((AxleWay::Rack, Row::axle_rack(axle)));
    }
    let found = rows.into_iter().map(|(way, row)| ElasticRow {
        row,
        unit,
        ends: run.motion_ends(way),
    });
    let mut found: Vec<ElasticRow> = found.collect();
    let at = with_rack("travels 0");
    append_loads(
        &mut found,
        axle.left.length_unit,
        &elastic.tests,
        &at,
        |test| run.load_ends(test),
    );
    Ok(found)
}

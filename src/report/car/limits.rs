//! Lift limits of a car, as a table and as `lift_limits.csv`.

use crate::car::{Car, CarSolver, Case, Longitudinal, RayLimits};
use crate::report::table::{Cell, Column, Table};
use crate::report::{brief, figure};
use crate::study::CarStudy;

/// Decimal places to which the acceleration (in g) at wheel lift is known.
const LIFT_PLACES: i32 = 9;
/// Decimal places to which the largest acceleration (in g) with an equilibrium is known.
const END_PLACES: i32 = 5;

/// Lift limits of a car along a direction, or for a load case.
pub struct CarLimits {
    /// Name of the load case. Empty for a direction.
    pub case: String,
    /// Direction of the acceleration, in degrees from forward to the left.
    pub degrees: f64,
    /// Acceleration of 1 g in this direction: forward and left components.
    way: [f64; 2],
    /// Lift limits in this direction, or the name of a key that is missing in `[car]`.
    pub found: Result<RayLimits, &'static str>,
}

impl CarLimits {
    /// False if the car has no equilibrium without acceleration, so that limits cannot be searched.
    pub fn has_start(&self) -> bool {
        self.found
            .as_ref()
            .map_or(true, |found| found.end > 0.0 || found.why.is_none())
    }

    /// Status of the limits in one word, for programs: `ok` if the limits are known.
    fn status(&self) -> &'static str {
        match &self.found {
            Err(_) => "unsupported",
            Ok(found) if found.lift.is_some() || found.why.is_none() => "ok",
            Ok(found) => found.why.as_ref().map_or("ok", |why| why.status()),
        }
    }

    /// Reason why the limits are unknown, or why equilibria end. Empty if equilibria exist up to the end of the search.
    fn reason(&self, car: &Car) -> String {
        match &self.found {
            Err(key) => format!("needs {key} in [car]"),
            Ok(found) => found
                .why
                .as_ref()
                .map_or_else(String::new, |why| why.describe(car)),
        }
    }
}

/// Limits in eight directions, and in the direction of each case with a horizontal acceleration. Each limit needs the share of the
/// front axle in the braking or drive force, also if there is no longitudinal acceleration.
pub fn car_limits(study: &CarStudy, solver: &mut CarSolver<'_>) -> Vec<CarLimits> {
    let rest = &study.cases[0];
    let directions = (0..8).map(|eighth| {
        let degrees = 45.0 * f64::from(eighth);
        (
            String::new(),
            degrees,
            Case::along("direction", degrees, rest),
        )
    });
    let cases = study
        .cases
        .iter()
        .filter(|case| case.ax != 0.0 || case.ay != 0.0);
    let cases = cases.map(|case| {
        let degrees = case.ay.atan2(case.ax).to_degrees();
        (case.name.clone(), degrees, case.clone())
    });
    let mut limits = Vec::new();
    for (name, degrees, case) in directions.chain(cases) {
        let share = match case.setting.longitudinal {
            Longitudinal::Brake => (study.car.brake_share_front, "brake_share_front"),
            Longitudinal::Drive => (study.car.drive_share_front, "drive_share_front"),
        };
        let length = case.ax.hypot(case.ay);
        let found = match share {
            (None, key) => Some(Err(key)),
            _ => solver.limits(&case).map(Ok),
        };
        limits.extend(found.map(|found| CarLimits {
            case: name,
            degrees: degrees.rem_euclid(360.0),
            way: [case.ax / length, case.ay / length],
            found,
        }));
    }
    limits
}

/// Rounds a number to this many decimal places.
fn rounded(value: f64, places: i32) -> f64 {
    let power = 10_f64.powi(places);
    (value * power).round() / power
}

/// Table of the limits, one row for each direction and case.
pub fn lift_limits_table(limits: &[CarLimits], car: &Car) -> Table {
    let columns = [
        Column::from("case"),
        Column::named("direction deg", "direction_deg"),
        Column::named("lift g", "g"),
        Column::named("ax g", "ax_g"),
        Column::named("ay g", "ay_g"),
        "wheel".into(),
        Column::named("others loaded", "others_loaded"),
        Column::named("end g", "end_g"),
        "reason".into(),
        "status".into(),
    ];
    let mut table = Table::with_columns(columns).keyed(2);
    for limit in limits {
        let found = limit.found.as_ref().ok();
        let lift = found.and_then(|found| found.lift);
        let acceleration = |value: Option<f64>| Cell::by(value, |value| figure(value, "g"));
        let at = lift.map(|lift| lift.acceleration);
        let end = found
            .filter(|found| found.why.is_some())
            .map(|found| rounded(found.end, END_PLACES));
        let along = |way: f64| at.map(|g| rounded(g * way, LIFT_PLACES) + 0.0);
        table.push_row([
            Cell::from(limit.case.as_str()),
            Cell::shown(limit.degrees, brief(limit.degrees)),
            acceleration(along(1.0)),
            acceleration(along(limit.way[0])),
            acceleration(along(limit.way[1])),
            lift.map_or("", |lift| lift.wheel.name()).into(),
            lift.map_or_else(|| "".into(), |lift| lift.others_loaded.into()),
            acceleration(end),
            limit.reason(car).as_str().into(),
            limit.status().into(),
        ]);
    }
    table
}

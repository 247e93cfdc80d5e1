//! Rows of the table of limits, with the causes of the limits.

use crate::analyse::{Limit, Range, RangeEnd};
use crate::axle::Axle;
use crate::mechanism::LimitCause;
use crate::model::{Axis, PointId, Rod, Side};
use crate::report::{Cell, Column, Table};
use crate::study::Study;

/// Cause of a limit for which no singularity was found.
pub(crate) const LOST: &str = "the path could not be followed further";

/// Cause of a limit at which a rod is at toggle (at a dead centre, so that it can no longer turn its part).
pub(super) fn at_toggle(rod: Rod) -> String {
    format!(
        "the {rod} is at toggle: it cannot turn {} any further",
        rod.turns()
    )
}

/// Lower or upper limit of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitEnd {
    /// Value in the unit of the row. `None` if it is not known, or if there is no limit.
    pub value: Option<f64>,
    /// Cause of the limit, in words.
    pub cause: String,
}

impl LimitEnd {
    pub(super) fn new(value: Option<f64>, cause: impl Into<String>) -> Self {
        LimitEnd {
            value,
            cause: cause.into(),
        }
    }
}

/// Limits of a quantity while the other quantities stay constant.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitRow {
    /// Quantity with its unit, such as `travel_mm`.
    pub quantity: String,
    /// Constant values of the other quantities, in words, such as `rack 0`.
    pub at: String,
    /// Lower limit and upper limit of the quantity.
    pub ends: [LimitEnd; 2],
}

/// Table of limits with their causes.
pub(super) fn table(rows: &[LimitRow]) -> Table {
    let columns = [
        "quantity".into(),
        "at".into(),
        Column::named("lower limit", "from"),
        Column::named("cause", "because"),
        Column::named("upper limit", "to"),
        Column::named("its cause", "because there"),
    ];
    let mut table = Table::with_columns(columns).keyed(2);
    for row in rows {
        let [lower, upper] = &row.ends;
        table.push([
            Cell::from(row.quantity.as_str()),
            row.at.as_str().into(),
            lower.value.into(),
            lower.cause.as_str().into(),
            upper.value.into(),
            upper.cause.as_str().into(),
        ]);
    }
    table
}

/// Row of the table of limits before its limits are known: quantity, and constant values of the other quantities.
pub(crate) struct Row {
    pub(crate) quantity: String,
    pub(crate) at: String,
    /// Factor from internal to printed values. A negative factor swaps the lower and the upper limit.
    pub(crate) factor: f64,
}

impl Row {
    /// Row with the lower and upper limit of a range in internal units. If the range is empty, the row has no values.
    pub(super) fn of(self, study: &Study, range: &Range) -> LimitRow {
        if range.is_empty() {
            return self.of_no_rack();
        }
        self.between(study, &range.lower, &range.upper)
    }

    /// Row with the lower and the upper limit at these ends of a range.
    pub(super) fn between(self, study: &Study, lower: &RangeEnd, upper: &RangeEnd) -> LimitRow {
        let beyond = match (lower, upper) {
            (RangeEnd::FullTurn, RangeEnd::FullTurn) => {
                "no limit: it can turn through a full circle"
            }
            _ => "no limit within half a turn",
        };
        let end = |end: &RangeEnd, turn: f64| match end {
            RangeEnd::Fold(limit) => (Some(limit.value), because(limit, study)),
            RangeEnd::FullTurn => (Some(turn), beyond.to_owned()),
            RangeEnd::Toggle { value, rod } => (Some(*value), at_toggle(*rod)),
            RangeEnd::Unresolved(value) => (Some(*value), LOST.to_owned()),
        };
        let turn = std::f64::consts::PI;
        self.with([end(lower, -turn), end(upper, turn)])
    }

    /// Row with these limits (values in internal units) and their causes. A value is `None` if it is unknown, or if there is no
    /// limit.
    pub(super) fn with(self, ends: [(Option<f64>, String); 2]) -> LimitRow {
        let factor = self.factor;
        let mut ends =
            ends.map(|(value, cause)| LimitEnd::new(value.map(|value| value * factor), cause));
        if factor < 0.0 {
            ends.reverse();
        }
        LimitRow {
            quantity: self.quantity,
            at: self.at,
            ends,
        }
    }

    /// Row for a length of an axle, such as heave, in the length unit of the axle.
    pub(super) fn length_of_axle(axle: &Axle, quantity: &str, at: &str, factor: f64) -> Self {
        Row {
            quantity: format!("{quantity}_{}", axle.left.length_unit.symbol()),
            at: at.to_owned(),
            factor,
        }
    }

    /// Row for the travel of one wheel of an axle.
    pub(crate) fn wheel_travel(axle: &Axle, side: Side) -> Self {
        Row::length_of_axle(axle, &format!("{}_travel", side.name()), "rack 0", 1.0)
    }

    /// Row of the table of limits for the rack of an axle, in the study's axes.
    pub(crate) fn axle_rack(axle: &Axle) -> Self {
        Row::length_of_axle(axle, "rack", "travels 0", axle.left.frame.sign(Axis::Y))
    }

    /// Row of the table of limits for the roll angle of an axle.
    pub(crate) fn roll() -> Self {
        Row {
            quantity: "roll_deg".to_owned(),
            at: "heave 0, rack 0".to_owned(),
            factor: 1.0_f64.to_degrees(),
        }
    }

    /// Row without values of limits, for a rack position that the mechanism cannot reach.
    pub(super) fn of_no_rack(self) -> LimitRow {
        self.with([(); 2].map(|()| (None, "the rack cannot reach this position".to_owned())))
    }
}

/// Cause of a limit: the part that is singular, or the part nearest to a singularity.
pub(super) fn because(limit: &Limit, study: &Study) -> String {
    let name = |id: &PointId| {
        let name = study.wheel().mechanism.name(*id);
        let ends = ["_outer", "_axle", "_rocker"];
        let link = ends.iter().find_map(|end| name.strip_suffix(end));
        link.unwrap_or(name).to_owned()
    };
    let links: Vec<String> = limit.dependent.iter().map(name).collect();
    match (limit.cause, &limit.nearest) {
        (LimitCause::DependentLinks, _) => {
            format!(
                "{} are at toggle: their lines are linearly dependent",
                links.join(", ")
            )
        }
        (cause @ LimitCause::AxleFolds, _) => {
            format!("{cause}; the largest force is in {}", links.join(", "))
        }
        (cause, Some(nearest)) if !cause.is_part() => {
            let part = match nearest.cause {
                LimitCause::StrutSquare => "strut",
                LimitCause::UpperArmStraight => "upper arm",
                _ => "tie rod",
            };
            let angle = nearest.sine.min(1.0).asin().to_degrees();
            if angle < 0.1 {
                let event = cause.words();
                format!("{event}: the {part} is at its dead centre, to 0.1 deg")
            } else {
                format!("{cause}; nearest to its singularity: the {part}, {angle:.1} deg away")
            }
        }
        (cause, _) => cause.to_string(),
    }
}

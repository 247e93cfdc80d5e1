//! Rows of the table of limits, with the causes of the limits.

use crate::analyse::{Limit, RangeEnd};
use crate::axle::Axle;
use crate::mechanism::LimitCause;
use crate::model::{Axis, PointId, Rod, Side};
use crate::report::{Cell, Column};
use crate::study::Study;

/// Cause of a limit for which no singularity was found.
pub(crate) const LOST: &str = "the path could not be followed further";

/// Cause of a limit at which a rod is in toggle position.
pub(super) fn at_toggle(rod: Rod) -> String {
    format!(
        "the {rod} is at toggle: it turns {} no further",
        rod.turns()
    )
}

/// Row of a quantity with its limits and causes. `factor` multiplies the values; a negative factor swaps the limits. A limit
/// without a value has an empty cell.
pub(super) fn row(what: [&str; 2], factor: f64, ends: [(Option<f64>, String); 2]) -> [Cell; 6] {
    let [quantity, at] = what.map(Cell::from);
    let [mut from, mut to] = ends.map(|(value, why)| (value.map(|value| value * factor), why));
    if factor < 0.0 {
        (from, to) = (to, from);
    }
    [
        quantity,
        at,
        from.0.into(),
        from.1.into(),
        to.0.into(),
        to.1.into(),
    ]
}

/// Row of the table: a quantity, and the positions at which the other quantities are held.
pub(crate) struct Row {
    pub(crate) quantity: String,
    pub(crate) at: String,
    /// Factor of printed values; a negative factor swaps the limits.
    pub(crate) factor: f64,
}

impl Row {
    pub(crate) fn of(&self, study: &Study, lower: &RangeEnd, upper: &RangeEnd) -> [Cell; 6] {
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
        self.cells([end(lower, -turn), end(upper, turn)])
    }

    /// Cells of limits with their causes.
    pub(super) fn cells(&self, ends: [(Option<f64>, String); 2]) -> [Cell; 6] {
        row([&self.quantity, &self.at], self.factor, ends)
    }

    /// Limits as the table shows them, the lower one first.
    pub(crate) fn in_table(&self, ends: [f64; 2]) -> [f64; 2] {
        let mut ends = ends.map(|end| end * self.factor);
        if self.factor < 0.0 {
            ends.reverse();
        }
        ends
    }

    /// Row for a length of an axle, in its unit.
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

    /// Row for the rack of an axle, in the study's axes.
    pub(crate) fn axle_rack(axle: &Axle) -> Self {
        Row::length_of_axle(axle, "rack", "travels 0", axle.left.frame.sign(Axis::Y))
    }

    /// Row for the roll angle of an axle.
    pub(crate) fn roll() -> Self {
        Row {
            quantity: "roll_deg".to_owned(),
            at: "heave 0, rack 0".to_owned(),
            factor: 1.0_f64.to_degrees(),
        }
    }

    /// Makes the row without a range, for a rack position that the mechanism cannot reach.
    pub(super) fn of_no_rack(&self) -> [Cell; 6] {
        self.cells([(); 2].map(|()| (None, "the rack cannot reach this position".to_owned())))
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
            format!("{} are at a dead centre with each other", links.join(", "))
        }
        (LimitCause::AxleFolds, _) if study.wheel().mechanism.topology.is_twist_beam() => {
            "the wheel centres rise no further: the arms are vertical, or the halves block each \
             other"
                .to_owned()
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
                format!("{cause} (nearest to one: the {part}, {angle:.1} deg away)")
            }
        }
        (cause, _) => cause.to_string(),
    }
}

/// Columns of the table of limits.
pub(crate) fn columns() -> [Column; 6] {
    [
        "quantity".into(),
        "at".into(),
        Column::named("lower limit", "from"),
        Column::named("cause", "because"),
        Column::named("upper limit", "to"),
        Column::named("its cause", "because there"),
    ]
}

//! Tables of a car for the terminal: load cases and static position.

use super::{CarResults, CarState};
use crate::car::{CarQuantity, WheelPlace, WheelResult, WholeResult};
use crate::report::figure;
use crate::report::table::{Cell, Table};

impl CarResults<'_> {
    /// Table of the key results of every load case.
    pub fn summary_table(&self) -> Table {
        let unit = self.unit();
        let force = self.study.car.length_unit.force_symbol();
        let heave = format!("heave {unit}");
        let loads = ["load FL", "FR", "RL", "RR"].map(|load| format!("{load} {force}"));
        let [front_left, front_right, rear_left, rear_right] = &loads;
        let mut table = Table::new([
            "case",
            "ax g",
            "ay g",
            "status",
            "roll deg",
            "pitch deg",
            &heave,
            front_left,
            front_right,
            rear_left,
            rear_right,
            "load transfer front %",
        ]);
        for (case, state) in self.study.cases.iter().zip(&self.states) {
            let mut row: Vec<Cell> = vec![
                case.name.as_str().into(),
                Cell::shown(case.ax, figure(case.ax, "g")),
                Cell::shown(case.ay, figure(case.ay, "g")),
                self.end(state)[1].as_str().into(),
            ];
            let mut shown = vec![
                (CarQuantity::Whole(WholeResult::Roll), "deg"),
                (CarQuantity::Whole(WholeResult::Pitch), "deg"),
                (CarQuantity::Whole(WholeResult::Heave), unit),
            ];
            shown
                .extend(WheelPlace::ALL.map(|p| (CarQuantity::Wheel(p, WheelResult::Load), force)));
            shown.push((CarQuantity::Whole(WholeResult::Distribution), "percent"));
            row.extend(shown.into_iter().map(|(quantity, unit)| {
                let value = match state {
                    CarState::Solved { solved, .. } => quantity.printed(solved, case),
                    CarState::Failed(_) => None,
                };
                Cell::by(value, |value| figure(value, unit))
            }));
            table.push_row(row);
        }
        table
    }

    /// Table of the static position. Empty if it has no equilibrium.
    pub fn static_table(&self) -> Table {
        let mut table = Table::new(["quantity", "value", "unit"]);
        let (Some(CarState::Solved { solved, .. }), Some(case)) =
            (self.states.first(), self.study.cases.first())
        else {
            return table;
        };
        let mut shown = vec![
            CarQuantity::Whole(WholeResult::Roll),
            CarQuantity::Whole(WholeResult::Pitch),
            CarQuantity::Whole(WholeResult::Heave),
            CarQuantity::Whole(WholeResult::WeightFront),
            CarQuantity::Whole(WholeResult::CrossWeight),
            CarQuantity::Whole(WholeResult::RollGradient),
            CarQuantity::Whole(WholeResult::LocalDistribution),
        ];
        for place in WheelPlace::ALL {
            shown.push(CarQuantity::Wheel(place, WheelResult::Load));
            shown.push(CarQuantity::Wheel(place, WheelResult::Travel));
        }
        for quantity in shown {
            let unit = quantity.info().unit.suffix(self.study.car.length_unit);
            let value = quantity.printed(solved, case);
            let cells: [Cell; 3] = [
                quantity.name().as_str().into(),
                Cell::by(value, |value| figure(value, &unit)),
                unit.as_str().into(),
            ];
            table.push(cells);
        }
        table
    }
}

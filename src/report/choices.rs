//! Alternatives to the tuned design, as files and tables: the Pareto front, and the list of misfit against size of change ("price
//! list").

use super::figure::{brief, with_decimals, without_zeros};
use super::files::csv_of;
use super::table::{Cell, Table};
use super::{CurveTable, shortest};
use crate::optimise::{Choice, Front};
use crate::study::{Optimise, Study, Variable};
use serde::{Deserialize, Serialize};

/// Largest number of printed points of a Pareto front.
const PRINTED: usize = 9;

/// Column name of a variable: `tie_rod_inner_dz_mm`, `upper_ball_joint+wheel_centre_turn_x_deg`.
fn column(variable: &Variable, unit: &str) -> String {
    let unit = if variable.turn.is_some() { "deg" } else { unit };
    format!("{}_{unit}", variable.label())
}

/// Content of `front.csv`: one row per point of the Pareto front. It has the misfit of each goal as a multiple of its
/// tolerance, the weights, and the offsets of the variables. The weights are empty at a point without a trade-off. The last column
/// is "yes" if the Pareto front has a gap after this point.
pub fn front_csv(study: &Study, optimise: &Optimise, front: &Front) -> Vec<u8> {
    let unit = study.wheel().length_unit.symbol();
    csv_of(|writer| {
        let mut header = vec!["point".to_owned()];
        let names = || optimise.front.iter().map(|goal| &goal.name);
        header.extend(names().map(|name| format!("misfit_{name}")));
        header.extend(names().map(|name| format!("weight_{name}")));
        header.extend(optimise.variables.iter().map(|v| column(v, unit)));
        header.push("broken_behind".to_owned());
        writer.write_record(&header)?;
        for (number, choice) in front.choices.iter().enumerate() {
            let mut record = vec![(number + 1).to_string()];
            record.extend(choice.amounts.iter().map(|v| shortest(*v)));
            let traded = choice.weights.iter().any(|w| *w > 0.0);
            let weight = |w: &f64| if traded { shortest(*w) } else { String::new() };
            record.extend(choice.weights.iter().map(weight));
            record.extend(choice.offsets.iter().map(|v| shortest(*v)));
            let broken = front.breaks.contains(&number);
            record.push(if broken { "yes" } else { "no" }.to_owned());
            writer.write_record(&record)?;
        }
        Ok(())
    })
}

/// Table of a Pareto front: misfits of some of its points, including the first and the last. With two goals, the last column is the
/// change of the second misfit per change of the first.
pub fn front_table(optimise: &Optimise, front: &Front) -> Table {
    let names: Vec<&str> = optimise
        .front
        .iter()
        .map(|goal| goal.name.as_str())
        .collect();
    let mut header = vec!["point".to_owned()];
    header.extend(names.iter().map(|name| (*name).to_owned()));
    let trade = (names.len() == 2).then(|| format!("{} per {}", names[1], names[0]));
    header.extend(trade.clone());
    let mut table = Table::with_columns(header);
    for number in some_of(front.choices.len()) {
        let choice = &front.choices[number];
        let mut row = vec![Cell::from(number + 1)];
        row.extend(choice.amounts.iter().map(|v| Cell::by(*v, brief3)));
        if trade.is_some() {
            let [first, second] = choice.weights[..] else {
                continue;
            };
            let rate = (first > 0.0 && second > 0.0).then(|| -first / second);
            row.push(Cell::by(rate, brief3));
        }
        table.push_row(row);
    }
    table
}

/// Remarks on a Pareto front.
pub fn front_remarks(optimise: &Optimise, front: &Front) -> Vec<String> {
    let names: Vec<&str> = optimise
        .front
        .iter()
        .map(|goal| goal.name.as_str())
        .collect();
    let mut remarks = Vec::new();
    match front.choices.len() {
        0 => remarks.push(format!(
            "no trade-off between {}: no design satisfies the constraints and the other targets",
            names.join(", ")
        )),
        1 => remarks.push(format!(
            "no trade-off between {}: one design is best in all of them",
            names.join(" and ")
        )),
        _ => {}
    }
    for place in &front.breaks {
        let amounts = |choice: &Choice| {
            let amounts = choice.amounts.iter().zip(&names);
            let amounts: Vec<String> = amounts
                .map(|(v, name)| format!("{name} {}", brief3(*v)))
                .collect();
            amounts.join(", ")
        };
        remarks.push(format!(
            "the Pareto front has a gap between points {} ({}) and {} ({}): no design was found between \
             them",
            place + 1,
            amounts(&front.choices[*place]),
            place + 2,
            amounts(&front.choices[place + 1]),
        ));
    }
    remarks
}

/// Formats a number with three digits, and at most nine decimals.
fn brief3(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0);
    without_zeros(&with_decimals(value, decimals as usize)).to_owned()
}

/// Selects at most [`PRINTED`] indices below `count`, evenly spaced, including the first and the last.
fn some_of(count: usize) -> Vec<usize> {
    match count {
        few if few <= PRINTED => (0..few).collect(),
        many => (0..PRINTED)
            .map(|k| k * (many - 1) / (PRINTED - 1))
            .collect(),
    }
}

/// A Pareto front in the form for the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrontRecord {
    /// Goals of the Pareto front.
    #[serde(rename = "targets", alias = "wishes")]
    pub goals: Vec<String>,
    /// Variables, with the names of their columns.
    pub variables: Vec<String>,
    /// Points of the Pareto front.
    pub points: Vec<FrontPoint>,
    /// Indices of the points after which the Pareto front has a gap.
    pub breaks: Vec<usize>,
    /// Lines of the first point's study.
    pub study: Vec<String>,
}

/// A point of a Pareto front.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrontPoint {
    /// Misfit of each goal, as a multiple of its tolerance.
    pub misfits: Vec<f64>,
    /// Weight of each goal. All weights are 0 if there is no trade-off.
    pub weights: Vec<f64>,
    /// Offset of each variable, in the study's axes and length unit. Degrees for a rotation.
    pub offsets: Vec<f64>,
    /// Lines of this point's study that differ from the study of the first point: index of the line, from 0, and the line.
    pub lines: Vec<(usize, String)>,
    /// Curves with six digits for the charts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curves: Option<CurveTable>,
}

impl FrontRecord {
    /// Makes the record of a Pareto front that a tuning has found. `curves` computes the curves of a study.
    pub fn of(
        study: &Study,
        optimise: &Optimise,
        front: &Front,
        curves: impl Fn(&Study) -> Option<CurveTable>,
    ) -> Self {
        let unit = study.wheel().length_unit.symbol();
        let text = |choice: &Choice| -> Vec<String> {
            let text = study.with_points_of(&study.moved(&choice.offsets));
            text.lines().map(str::to_owned).collect()
        };
        let first = front.choices.first().map(text).unwrap_or_default();
        let point = |choice: &Choice| {
            let lines = text(choice).into_iter().enumerate();
            FrontPoint {
                misfits: choice.amounts.clone(),
                weights: choice.weights.clone(),
                offsets: choice.offsets.clone(),
                lines: lines
                    .filter(|(k, line)| first.get(*k) != Some(line))
                    .collect(),
                curves: curves(&study.moved(&choice.offsets)).map(CurveTable::with_six_digits),
            }
        };
        FrontRecord {
            goals: optimise
                .front
                .iter()
                .map(|goal| goal.name.clone())
                .collect(),
            variables: optimise.variables.iter().map(|v| column(v, unit)).collect(),
            points: front.choices.iter().map(point).collect(),
            breaks: front.breaks.clone(),
            study: first,
        }
    }
}

/// One design of the price list (smallest misfit for each size of the change).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PriceRecord {
    /// Size of the change: root of a sum over the variables. Each term is the cost (weight) of the variable, times the square of
    /// (offset / range).
    pub moved: f64,
    /// Smallest misfit with a change of this size, as a multiple of the tolerances.
    pub misfit: f64,
    /// Decrease of the misfit if the change grows by a tenth of a range. `None` at the ends of the price list.
    pub gain: Option<f64>,
    /// Variable that moves most, relative to its range.
    pub most: Option<String>,
    /// Offset of that variable, in the study's axes and length unit. Degrees for a rotation.
    pub most_by: Option<f64>,
    /// Offset of each variable. The units are the same as for `most_by`.
    pub offsets: Vec<f64>,
    /// True if the tuning keeps this design.
    pub kept: bool,
}

impl PriceRecord {
    /// Records of a price list. `kept` contains the offsets of the design that the tuning keeps.
    pub fn all(optimise: &Optimise, list: &[Choice], kept: Option<&[f64]>) -> Vec<Self> {
        let record = |choice: &Choice| {
            let [misfit, moved] = choice.amounts[..] else {
                return None;
            };
            let [price, weight] = choice.weights[..] else {
                return None;
            };
            let shares = optimise.variables.iter().zip(&choice.offsets);
            let shares = shares.map(|(v, by)| ((by / (v.range[1] - v.range[0])).abs(), v, *by));
            let most = shares
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|most| most.0 > 1e-9);
            Some(PriceRecord {
                moved,
                misfit,
                gain: (price > 0.0 && weight > 0.0).then(|| 0.1 * weight / price),
                most: most.map(|(_, v, _)| format!("{}.{}", v.name, v.way())),
                most_by: most.map(|(_, _, by)| by),
                offsets: choice.offsets.clone(),
                kept: kept.is_some_and(|kept| kept == choice.offsets),
            })
        };
        list.iter().filter_map(record).collect()
    }

    /// Table of a price list (smallest misfit for each size of the change).
    pub fn table(list: &[PriceRecord]) -> Table {
        let mut table = Table::new(["moved", "misfit", "gain", "most moved", "by", "kept"]);
        for step in list {
            table.push([
                Cell::by(step.moved, brief3),
                Cell::by(step.misfit, brief3),
                Cell::by(step.gain, brief3),
                step.most.clone().map(Cell::from).into(),
                Cell::by(step.most_by, brief),
                step.kept.then_some("kept").into(),
            ]);
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_enough() {
        for (value, text) in [
            (0.0, "0"),
            (0.123_456, "0.123"),
            (12.345, "12.3"),
            (-1234.5, "-1234"),
            (0.1, "0.1"),
            (-1e-12, "0"),
        ] {
            assert_eq!(brief3(value), text);
        }
    }

    #[test]
    fn some_are_the_first_the_last_and_evenly_between() {
        assert_eq!(some_of(3), [0, 1, 2]);
        assert_eq!(some_of(50), [0, 6, 12, 18, 24, 30, 36, 42, 49]);
    }
}

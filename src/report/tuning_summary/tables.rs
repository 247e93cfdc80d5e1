//! Tables of a tuning.

use super::*;

/// Table of the misfits before and after a tuning, as multiples of the tolerances.
pub fn misfit_table(before: Option<f64>, after: Option<f64>) -> Table {
    let mut table = Table::new(["before", "after"]);
    table.push([before, after]);
    table
}

impl TuningSummary {
    /// Table of the price list: smallest misfit for each size of the change. `None` if it was not requested.
    pub fn prices_table(&self) -> Option<Table> {
        (!self.prices.is_empty()).then(|| PriceRecord::table(&self.prices))
    }

    /// Machine-readable table of the misfits before and after the tuning, as multiples of the tolerances.
    pub fn misfit_table(&self) -> Table {
        misfit_table(self.misfit_before, self.misfit_after)
    }

    /// Table of the variables of the tuning and their offsets.
    pub fn variables_table(&self) -> Table {
        let columns = ["axis", "design", "tuned", "moved"].map(Column::from);
        let has_parts = self.variables.iter().any(|v| v.hardpoint.contains(':'));
        let name = if has_parts {
            Column::named("part", "hardpoint")
        } else {
            "hardpoint".into()
        };
        let columns = [name].into_iter().chain(columns);
        let range = Column::for_readers("range");
        let ends = ["range min", "range max"].map(Column::for_programs);
        let columns = columns.into_iter().chain([range]).chain(ends);
        let is_fit = self.variables.iter().any(|v| v.fitted.is_some());
        let interval = is_fit.then(FittedOffset::columns).into_iter().flatten();
        // The interval of a factor is also shown for the rate itself.
        let has_factors = is_fit && self.variables.iter().any(VariableSummary::is_factor);
        let of_rates = has_factors.then(|| Column::for_readers("tuned, 95 %"));
        let columns = columns.chain(["bound".into()]);
        let columns = columns.chain(of_rates).chain(interval);
        let mut table = Table::with_columns(columns).keyed(2);
        for v in &self.variables {
            // For a fit, values have so many decimals that two digits of the standard error are visible.
            let decimals = v.fitted.and_then(|fitted| fitted.decimals(v.offset));
            let known = decimals.filter(|_| v.at_bound.is_none());
            let brief = |value: f64| {
                known.map_or_else(|| brief(value), |decimals| with_decimals(value, decimals))
            };
            let moved = Cell::by(v.offset, |offset| with_plus(offset, brief(offset)));
            let [low, high] = v.range;
            // Limits of a factor are logarithms with many digits, so they are shortened.
            let limit = |value: f64| match v.unit.as_str() {
                "factor" => brief(value),
                _ => as_written(value),
            };
            let range = format!("{} .. {}", limit(low), limit(high));
            let bound = v.at_bound.as_ref().map(|side| format!("at {side} bound"));
            let mut row = vec![
                Cell::from(v.hardpoint.as_str()),
                v.axis.as_str().into(),
                v.design.into(),
                Cell::by(v.tuned, brief),
                moved,
                range.into(),
                low.into(),
                high.into(),
                bound.into(),
            ];
            if has_factors {
                row.push(v.tuned_interval().into());
            }
            if is_fit {
                let cells = v.fitted.map(|fitted| fitted.cells(decimals));
                row.extend(cells.unwrap_or_else(|| [""; 4].map(Cell::from)));
            }
            table.push_row(row);
        }
        table
    }

    /// Table of the moves of the hardpoints along x, y and z, the largest first. `unit` is the symbol of the length unit. Points
    /// that only turn or move along another direction are left out, and so are rates. Points that move together have one row with
    /// the move of the first point. The table then has no distances.
    pub fn moved_points(&self, unit: &str) -> Table {
        let mut moves: Vec<(&str, [f64; 3])> = Vec::new();
        for variable in &self.variables {
            let (Some(offset), Some(axis)) = (
                variable.offset,
                ["x", "y", "z"].iter().position(|a| *a == variable.axis),
            ) else {
                continue;
            };
            let known = moves
                .iter()
                .position(|(name, _)| *name == variable.hardpoint);
            let at = known.unwrap_or_else(|| {
                moves.push((&variable.hardpoint, [0.0; 3]));
                moves.len() - 1
            });
            // The offset is the move of the first point only if its factor is 1.
            let coordinates = variable.design.zip(variable.tuned);
            moves[at].1[axis] = match coordinates.filter(|_| offset != 0.0) {
                Some((design, tuned)) => tuned - design,
                None => offset,
            };
        }
        let length = |by: &[f64; 3]| by.iter().map(|c| c * c).sum::<f64>().sqrt();
        moves.retain(|(_, by)| length(by) > 0.0);
        moves.sort_by(|a, b| length(&b.1).total_cmp(&length(&a.1)));
        // A row of several points does not contain the moves of the other points.
        let has_distance = !moves.iter().any(|(name, _)| name.contains('+'));
        let distance = has_distance.then(|| Column::from(format!("distance [{unit}]")));
        let names = ["point", "x", "y", "z"].map(Column::from);
        let mut table = Table::with_columns(names.into_iter().chain(distance));
        let decimals = match unit {
            "m" => 5,
            "in" => 4,
            _ => 2,
        };
        let shown = |by: f64| with_decimals(by, decimals);
        let signed = |by: f64| with_plus(by, shown(by));
        for (name, by) in moves {
            let mut row = vec![Cell::from(name)];
            row.extend(by.map(|c| Cell::by(Some(c).filter(|c| *c != 0.0), signed)));
            if has_distance {
                row.push(Cell::by(Some(length(&by)), shown));
            }
            table.push_row(row);
        }
        table
    }

    /// Table of the targets before and after. The text shows the range of the values and the largest deviation in the unit of the
    /// target. CSV and JSON have all deviations as multiples of the tolerance.
    pub fn targets_table(&self) -> Table {
        let columns = [
            Column::from("target"),
            Column::for_readers("wanted"),
            Column::for_readers("before"),
            Column::for_readers("after"),
            "tolerance".into(),
            Column::for_readers("off before"),
            Column::for_readers("off after"),
            Column::for_programs("rms before"),
            Column::for_programs("rms after"),
            Column::for_programs("worst after"),
            "at".into(),
        ];
        let programs = [
            "worst before",
            "worst before at",
            "weight",
            "at unit",
            "wanted from",
            "wanted to",
            "before min",
            "before max",
            "after min",
            "after max",
        ];
        let programs = programs.map(Column::for_programs);
        let mut table = Table::with_columns(columns.into_iter().chain(programs));
        for t in &self.targets {
            let (before, after) = (t.before.as_ref(), t.after.as_ref());
            let unit = after.or(before).map_or("", |d| d.worst_at_unit.as_str());
            let off = |d: Option<&DeviationSummary>| {
                let worst = d.map(|d| d.worst_in_unit.unwrap_or(d.worst * t.tolerance));
                Cell::by(worst, |worst| to_hundredth_of(worst, t.tolerance))
            };
            // The column of the deviations has more digits.
            let decimals = match decimals_beside(t.tolerance) {
                0 => 0,
                fine => (fine - 1).max(1),
            };
            let range = |values: Option<[f64; 2]>| {
                Cell::from(values.map(|ends| range_in_words(ends, decimals)))
            };
            let end =
                |values: Option<[f64; 2]>, end: usize| Cell::from(values.map(|ends| ends[end]));
            table.push([
                Cell::from(t.output.as_str()),
                t.wanted_in_words().into(),
                range(t.values_before),
                range(t.values_after),
                t.tolerance.into(),
                off(before),
                off(after),
                before.map(|d| d.rms).into(),
                after.map(|d| d.rms).into(),
                after.map(|d| d.worst).into(),
                Cell::by(after.map(|d| d.worst_at), |at| with_unit(at, unit)),
                before.map(|d| d.worst).into(),
                before.map(|d| d.worst_at).into(),
                t.weight.into(),
                unit.into(),
                t.wanted[0].into(),
                t.wanted[1].into(),
                end(t.values_before, 0),
                end(t.values_before, 1),
                end(t.values_after, 0),
                end(t.values_after, 1),
            ]);
        }
        table
    }

    /// Table of the constraints. `None` without constraints.
    pub fn constraints_table(&self) -> Option<Table> {
        if self.constraints.is_empty() {
            return None;
        }
        let columns = ["margin", "unit", "at", "kept", "price"].map(Column::from);
        let mut head = vec![Column::from("constraint")];
        if self.constraints.iter().any(|c| c.limit.is_some()) {
            head.extend(["value", "limit"].map(Column::for_readers));
        }
        let has_limits = head.len() > 1;
        let columns = head.into_iter().chain(columns);
        let programs = ["at unit", "value", "nearest limit"].map(Column::for_programs);
        let mut table = Table::with_columns(columns.into_iter().chain(programs));
        for c in &self.constraints {
            let status = c.status();
            let kept = status.in_words().map(str::to_owned);
            let brief = |margin: f64| match status {
                ConstraintStatus::Binds => "0".to_owned(),
                _ => brief(margin),
            };
            let mut row = vec![Cell::from(c.name.as_str())];
            if has_limits {
                row.push(Cell::by(c.value, super::brief));
                row.push(c.limit_in_words().into());
            }
            row.extend([
                Cell::by(c.margin, brief),
                c.unit.as_str().into(),
                c.place(),
                kept.into(),
                if c.price_not_determined {
                    Cell::from("not determined")
                } else {
                    c.price.into()
                },
                c.at_unit.as_str().into(),
                c.value.into(),
                c.limit.into(),
            ]);
            table.push_row(row);
        }
        Some(table)
    }

    /// Table of the starts of the tuning (points at which the search begins) and their results.
    pub fn starts_table(&self) -> Table {
        starts_table(&self.starts, self.best_start)
    }
}

impl TargetSummary {
    /// Target value or limits of the target in words, without unit. Empty in summaries of older versions.
    pub(super) fn wanted_in_words(&self) -> String {
        let values = self.wanted_values();
        if self.between_curves {
            format!("curves, {values}")
        } else {
            values
        }
    }

    fn wanted_values(&self) -> String {
        match self.wanted {
            [None, None] => String::new(),
            [Some(lower), None] => format!("from {}", brief(lower)),
            [None, Some(upper)] => format!("up to {}", brief(upper)),
            [Some(one), Some(other)] if one == other => brief(one),
            [Some(lower), Some(upper)] => format!("{} .. {}", brief(lower), brief(upper)),
        }
    }
}

/// Deviation in the unit of its target, rounded to a hundredth of the tolerance or finer.
fn to_hundredth_of(deviation: f64, tolerance: f64) -> String {
    let decimals = (2.0 - tolerance.log10().floor()).clamp(0.0, 12.0) as usize;
    with_decimals(deviation, decimals)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{from_value, json};

    /// Summary of a tuning with one variable, whose point moves twice the offset. A constraint is violated.
    fn summary() -> TuningSummary {
        let variable = json!({
            "hardpoint": "strut_top", "axis": "z", "design": 0.2, "tuned": 0.21, "offset": 0.005, "unit": "m",
            "range": [-0.01, 0.01]
        });
        from_value(json!({
            "command": "optimise", "version": "", "study": "", "topology": "macpherson", "misfit_after": 0.5,
            "variables": [variable], "targets": [], "starts": [], "singular_values": [], "unseen": [[0.000_45]],
            "constraints": [{ "name": "distance", "margin": -1.0, "unit": "mm" }]
        }))
        .unwrap()
    }

    #[test]
    fn a_point_moves_by_the_change_of_its_coordinate() {
        let table = summary().moved_points("m").text(80);
        assert!(table.contains(" +0.01000 "), "{table}");
        assert!(table.trim_end().ends_with(" 0.01000"), "{table}");
    }

    #[test]
    fn moves_in_metres_keep_their_digits() {
        assert_eq!(summary().unseen(), ["strut_top.z +0.000450 m"]);
    }

    /// The headline names violated constraints, also if the given design has no misfit.
    #[test]
    fn the_headline_names_violated_constraints() {
        let headline = summary().headline();
        assert!(headline.contains("a constraint is violated"), "{headline}");
    }
}

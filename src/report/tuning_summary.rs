//! Summary of a tuning.

use super::accuracy::{CertificateSummary, ConditionSummary};
use super::choices::{FrontPoint, FrontRecord, PriceRecord};
use super::figure::{as_written, brief, with_decimals};
use super::fitted::FittedOffset;
use super::side_effects::side_effects_in_words;
use super::table::{Cell, Column, Table};
use super::text::counted;
use super::yields::YieldRecord;
use crate::SideEffect;
use crate::curves::Curves;
use crate::model::Axis;
use crate::optimise::{
    ActiveBound, ConstraintOutcome, Fit, Fulfilment, Infeasible, Price, Termination, Tuning,
};
use crate::study::{Limit, Optimise, Study, Target, Wanted};
use serde::{Deserialize, Serialize};

/// `summary.json` of an optimisation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TuningSummary {
    command: String,
    version: String,
    study: String,
    topology: String,
    /// In tolerances; absent where the design itself cannot be evaluated.
    misfit_before: Option<f64>,
    /// Why the design itself cannot be evaluated.
    design_failure: Option<String>,
    misfit_after: Option<f64>,
    best_start: Option<usize>,
    /// Residual of the optimality conditions at the tuned design, relative to the sizes of their terms; below 1e-6 the
    /// tuning has converged.
    #[serde(default)]
    kkt_residual: Option<f64>,
    variables: Vec<VariableSummary>,
    targets: Vec<TargetSummary>,
    starts: Vec<StartSummary>,
    /// Directions of the variables that the targets see, and all there are.
    rank: Option<usize>,
    singular_values: Vec<f64>,
    /// Combinations of variables that the targets cannot tell apart: offsets by variable.
    unseen: Vec<Vec<f64>>,
    /// For a fit: the scatter of the measurements about it, in tolerances.
    #[serde(default)]
    scatter: Option<f64>,
    /// For a fit: pairs of variables that the measurements hardly tell apart, with their correlation.
    #[serde(default)]
    correlations: Vec<(String, String, f64)>,
    /// The misfit below which no design was preferred to a nearer one.
    #[serde(default)]
    good_enough: f64,
    /// State of each constraint.
    #[serde(default)]
    constraints: Vec<ConstraintSummary>,
    /// Missed targets that no variable changes.
    #[serde(default)]
    unmoved: Vec<String>,
    /// Constraints that are violated and that no variable moves.
    #[serde(default)]
    unmoved_constraints: Vec<String>,
    /// Constraints that exclude one another.
    #[serde(default)]
    contradiction: Vec<String>,
    /// Stations added to those of the motion, where targets needed them.
    #[serde(default)]
    added_stations: Vec<AddedStations>,
    /// The least misfit by how far the design is moved, where that was asked for.
    #[serde(default)]
    pub prices: Vec<PriceRecord>,
    /// Changes that no target asks for; empty where they were not asked for.
    #[serde(default)]
    pub side_effects: Vec<SideEffect>,
    /// For a robust tuning: the shares of builds that keep to the bands before and after.
    #[serde(default)]
    pub yields: Option<YieldRecord>,
    /// For a robust tuning: the number of builds whose mean squared misfit was lowered; all misfits then are theirs.
    #[serde(default)]
    scatter_builds: Option<usize>,
    /// Conditioning of the tuned design along the motion.
    #[serde(default)]
    condition: Option<ConditionSummary>,
    /// Proofs of the tuned design, if the study asks for them.
    #[serde(default)]
    certificate: Option<CertificateSummary>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct VariableSummary {
    /// Joined by `+` where several move together.
    hardpoint: String,
    axis: String,
    /// The coordinate, of the first where several move together; none of a turn.
    design: Option<f64>,
    tuned: Option<f64>,
    offset: Option<f64>,
    range: [f64; 2],
    /// `lower` or `upper` where the variable ended at that bound.
    at_bound: Option<String>,
    /// For a fit: the standard error.
    #[serde(default)]
    standard_error: Option<f64>,
    /// For a fit: half the interval that holds the truth in 95 of 100 fits, where it has two sides.
    #[serde(default)]
    interval: Option<f64>,
    /// For a fit: that interval of the offset.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    fitted: Option<FittedOffset>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct TargetSummary {
    output: String,
    tolerance: f64,
    /// Least and largest wanted value, in the unit of the tolerance; open where a band has no limit.
    #[serde(default)]
    wanted: [Option<f64>; 2],
    weight: f64,
    before: Option<DeviationSummary>,
    after: Option<DeviationSummary>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct ConstraintSummary {
    name: String,
    /// Margin to the nearest limit in `unit`; negative if it is violated.
    room: f64,
    unit: String,
    /// Drive value with the least margin.
    at: Option<f64>,
    /// Unit of `at`.
    #[serde(default)]
    at_unit: String,
    /// Tolerances of misfit that a limit one unit further would save.
    price: Option<f64>,
    /// Absent in summaries of older versions, whose units are millimetres and degrees.
    #[serde(default)]
    status: Option<ConstraintStatus>,
    /// True if the price is open, because binding limits depend on one another.
    #[serde(default)]
    price_not_determined: bool,
}

/// Status of a constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ConstraintStatus {
    /// With margin to every limit.
    Kept,
    /// At a limit.
    Binds,
    Violated,
}

impl ConstraintStatus {
    /// The status of a margin, in units that are visible: a millimetre, a degree.
    fn of(margin: f64) -> Self {
        match margin {
            margin if margin < -VISIBLE => ConstraintStatus::Violated,
            margin if margin < BINDING => ConstraintStatus::Binds,
            _ => ConstraintStatus::Kept,
        }
    }
}

impl ConstraintSummary {
    fn status(&self) -> ConstraintStatus {
        self.status
            .unwrap_or_else(|| ConstraintStatus::of(self.room))
    }

    /// The drive value with the least margin, with its unit.
    fn place(&self) -> Cell {
        Cell::by(self.at, |at| with_unit(at, &self.at_unit))
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct AddedStations {
    target: String,
    at: Vec<f64>,
    /// Unit of `at`.
    #[serde(default)]
    unit: String,
}

/// In tolerances.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct DeviationSummary {
    rms: f64,
    worst: f64,
    /// The same in the unit of the target, with the sign of its values.
    #[serde(default)]
    worst_in_unit: Option<f64>,
    /// Travel in the study's unit, or arm angle in degrees; for an axle the number that the target is over.
    worst_at: f64,
    /// Unit of `worst_at`.
    #[serde(default)]
    worst_at_unit: String,
    /// Rack displacement there, in the study's axes.
    #[serde(default)]
    worst_rack: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct StartSummary {
    start: usize,
    offsets: Vec<f64>,
    /// Reason for its end, or for the failure of its start.
    ended: String,
    iterations: Option<u64>,
    evaluations: Option<u64>,
    misfit: Option<f64>,
    /// As `kkt_residual` of the summary, at the end of this start.
    #[serde(default)]
    kkt_residual: Option<f64>,
}

impl TuningSummary {
    /// The summary of a tuning; `after` are the curves of the tuned design.
    pub fn of(study: &Study, optimise: &Optimise, tuning: &Tuning, after: Option<&Curves>) -> Self {
        let suspension = study.wheel();
        let best = tuning.best.as_ref();
        let fit = tuning.starts.best_fit();
        let errors = best.and_then(|b| b.errors.as_ref());
        let variables = optimise.variables.iter().enumerate().map(|(k, v)| {
            let coordinate = |design: &[crate::number::Vector3<f64>]| {
                let (axis, first) = (v.axis()?, v.moves.first()?);
                let point = suspension.frame.vector(design[first.point.0]).to_array();
                Some(point[axis as usize])
            };
            let fitted = errors.map(|e| FittedOffset::from(e.intervals[k]));
            let unit = match (&v.turn, &v.rate) {
                (Some(_), _) => ", deg",
                (None, Some(rate)) if rate.is_relative => ", ln of a factor",
                (None, _) => "",
            };
            let rate = |x: f64| v.rate.map(|rate| rate.at(x)[0]);
            let axis = format!("{}{unit}", v.way());
            VariableSummary {
                hardpoint: v.name.clone(),
                axis,
                design: coordinate(&suspension.design).or(rate(0.0)),
                tuned: best.and_then(|b| coordinate(&b.design).or(rate(b.offsets[k]))),
                offset: best.map(|b| b.offsets[k] + 0.0),
                range: v.range,
                at_bound: fit.and_then(|fit| match fit.active_bounds[k] {
                    ActiveBound::Free => None,
                    ActiveBound::Lower => Some("lower".to_owned()),
                    ActiveBound::Upper => Some("upper".to_owned()),
                }),
                standard_error: errors.and_then(|e| e.sigmas[k]),
                interval: fitted.and_then(|fitted| fitted.half()),
                fitted,
            }
        });
        let drive = study.motion().drive;
        let name = |target: &crate::study::Target| {
            let motion = target.site.motion.as_ref();
            let motion = motion.map_or(String::new(), |(name, _)| format!(", {name}"));
            let racks: Vec<String> = target.site.racks.iter().map(|r| as_written(*r)).collect();
            let racks = match racks.as_slice() {
                [] => String::new(),
                racks => format!(", rack {}", racks.join(" ")),
            };
            let held = target.site.axle.as_ref();
            let held = held.map_or(String::new(), |site| {
                format!(" over {}{}", site.over.key(), site.words)
            });
            format!("{}{motion}{racks}{held}", target.of.column)
        };
        let constraints = best.map_or(Vec::new(), |best| {
            let outcomes = optimise.constraints.iter().zip(&best.constraints);
            let summary = |(constraint, found): (&crate::study::Constraint, &ConstraintOutcome)| {
                let motion = constraint
                    .site
                    .as_ref()
                    .and_then(|site| site.motion.as_ref());
                let drive = motion.map_or(study.motion().drive, |(_, motion)| motion.drive);
                let part = &constraint.parts[0];
                ConstraintSummary {
                    name: constraint.name.clone(),
                    room: found.room + 0.0,
                    unit: part.unit.clone(),
                    at: found.at.map(|at| drive.printed(at)),
                    at_unit: drive.unit(suspension.length_unit).to_owned(),
                    price: found.price.per_unit(),
                    price_not_determined: found.price == Price::NotDetermined,
                    status: Some(ConstraintStatus::of(found.room / part.visible)),
                }
            };
            outcomes.map(summary).collect()
        });
        let added = optimise.targets.iter().filter(|t| !t.stations.is_empty());
        let added = added.map(|t| AddedStations {
            target: name(t),
            at: t
                .stations
                .iter()
                .map(|at| t.printed_at(drive, *at))
                .collect(),
            unit: t.unit_at(drive, suspension.length_unit).to_owned(),
        });
        let targets = optimise.targets.iter().enumerate().map(|(k, target)| {
            let deviation = |fulfilment: &Fulfilment| {
                let d = fulfilment.targets[k];
                DeviationSummary {
                    rms: d.rms,
                    worst: d.worst,
                    worst_in_unit: Some(d.worst * target.tolerance * target.of.factor() + 0.0),
                    worst_at: target.printed_at(drive, d.worst_at),
                    worst_at_unit: target.unit_at(drive, suspension.length_unit).to_owned(),
                    worst_rack: suspension.frame.sign(Axis::Y) * d.worst_rack + 0.0,
                }
            };
            TargetSummary {
                output: name(target),
                tolerance: target.tolerance * target.of.factor().abs(),
                wanted: wanted(target),
                weight: target.weight,
                before: tuning.before.as_ref().ok().map(deviation),
                after: best.map(|b| deviation(&b.after)),
            }
        });
        let starts = tuning
            .starts
            .starts
            .iter()
            .enumerate()
            .map(|(number, start)| {
                let offsets = start.x.iter().map(|v| v + 0.0).collect();
                let fit = start.outcome.as_ref();
                let ended = match fit {
                    Ok(fit) => fit.ended(),
                    Err(Infeasible::Interrupted) => Termination::Interrupted.to_string(),
                    Err(infeasible) => format!("not begun: {infeasible}"),
                };
                let fit = fit.ok();
                StartSummary {
                    start: number,
                    offsets,
                    ended,
                    iterations: fit.map(|fit| fit.history.last().map_or(0, |i| i.iteration)),
                    evaluations: fit.map(Fit::evaluations),
                    misfit: fit.map(Fit::misfit),
                    kkt_residual: fit.map(|fit| fit.residual),
                }
            });
        let unmoved = tuning.unmoved.iter();
        let named = |c: &usize| optimise.constraints[*c].name.clone();
        let unmoved_constraints = tuning.unmoved_constraints.iter().map(named).collect();
        let contradiction = tuning.contradiction.iter();
        let contradiction = contradiction.map(|c| optimise.constraints[*c].name.clone());
        TuningSummary {
            command: "optimise".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: study.name.clone(),
            topology: suspension.mechanism.topology.name.to_owned(),
            misfit_before: tuning.before.as_ref().ok().map(|f| f.misfit),
            design_failure: tuning.before.as_ref().err().map(ToString::to_string),
            misfit_after: best.map(|b| b.after.misfit),
            best_start: tuning.starts.best,
            kkt_residual: fit.map(|fit| fit.residual),
            variables: variables.collect(),
            targets: targets.collect(),
            starts: starts.collect(),
            rank: best.map(|b| b.identifiability.rank),
            singular_values: best
                .map(|b| b.identifiability.singular_values.clone())
                .unwrap_or_default(),
            unseen: best.map_or(Vec::new(), |b| {
                let directions = b.identifiability.unseen.iter().filter_map(|d| {
                    let [up, down] = d.free;
                    let share = if up >= down { up } else { -down };
                    // A hundredth of the range is no freedom.
                    (share.abs() > 0.01).then(|| d.change.iter().map(|c| c * share).collect())
                });
                directions.collect()
            }),
            scatter: best.and_then(|b| Some(b.errors.as_ref()?.scatter)),
            correlations: best.map_or(Vec::new(), |b| {
                let errors = b.errors.iter().flat_map(|e| &e.correlations);
                let name = |j: usize| {
                    let v = &optimise.variables[j];
                    format!("{}.{}", v.name, v.way())
                };
                errors.map(|(i, j, c)| (name(*i), name(*j), *c)).collect()
            }),
            good_enough: optimise.good_enough,
            constraints,
            unmoved: unmoved.map(|t| name(&optimise.targets[*t])).collect(),
            unmoved_constraints,
            contradiction: contradiction.collect(),
            added_stations: added.collect(),
            prices: Vec::new(),
            side_effects: Vec::new(),
            yields: None,
            scatter_builds: optimise
                .scatter
                .as_ref()
                .filter(|s| s.lowers_misfit())
                .map(|s| s.builds),
            condition: after.and_then(ConditionSummary::of),
            certificate: after.and_then(CertificateSummary::of),
        }
    }

    /// The least misfit by how far the design is moved; none where that was not asked for.
    pub fn prices_table(&self) -> Option<Table> {
        (!self.prices.is_empty()).then(|| PriceRecord::table(&self.prices))
    }

    /// Misfit before and after, in tolerances, for reading.
    pub fn misfits(&self) -> [Option<String>; 2] {
        [self.misfit_before, self.misfit_after].map(|m| m.map(hundredths))
    }

    /// Returns true if some start reached a design.
    pub fn has_design(&self) -> bool {
        self.misfit_after.is_some()
    }

    /// Number of the point of a front that is the tuned design, to a thousandth of each range; `None` if no point is.
    pub(super) fn kept_point(&self, front: &FrontRecord) -> Option<usize> {
        let is_same = |point: &FrontPoint| {
            let pairs = self.variables.iter().zip(&point.offsets);
            let mut pairs = pairs.map(|(variable, at)| (variable.offset, variable.range, *at));
            point.offsets.len() == self.variables.len()
                && pairs.all(|(own, [low, high], at)| {
                    own.is_some_and(|own| (own - at).abs() <= 1e-3 * (high - low))
                })
        };
        front.points.iter().position(is_same)
    }

    /// The start whose end was kept.
    pub fn kept_start(&self) -> Option<usize> {
        self.best_start
    }

    /// Number of variables that ended at a bound, and number of all variables.
    pub fn at_bounds(&self) -> [usize; 2] {
        let active = self.variables.iter().filter(|v| v.at_bound.is_some());
        [active.count(), self.variables.len()]
    }

    /// For programs: the misfit in tolerances.
    pub fn misfit_table(&self) -> Table {
        let mut table = Table::new(["before", "after"]);
        table.push([self.misfit_before, self.misfit_after]);
        table
    }

    /// Returns the table of the variables and their moves.
    pub fn variables_table(&self) -> Table {
        let columns = ["hardpoint", "axis", "design", "tuned", "moved"].map(Column::from);
        let range = Column::for_readers("range");
        let ends = ["range min", "range max"].map(Column::for_programs);
        let columns = columns.into_iter().chain([range]).chain(ends);
        let is_fit = self.variables.iter().any(|v| v.fitted.is_some());
        let interval = is_fit.then(FittedOffset::columns).into_iter().flatten();
        let columns = columns.chain(["bound".into()]).chain(interval);
        let mut table = Table::with_columns(columns).keyed(2);
        for v in &self.variables {
            // A fit shows no more digits than it knows: two of the standard error.
            let decimals = v.fitted.and_then(|fitted| fitted.decimals(v.offset));
            let known = decimals.filter(|_| v.at_bound.is_none());
            let brief = |value: f64| {
                known.map_or_else(|| brief(value), |decimals| with_decimals(value, decimals))
            };
            let moved = Cell::by(v.offset, |offset| match brief(offset) {
                text if offset > 0.0 => format!("+{text}"),
                text => text,
            });
            let [low, high] = v.range;
            let range = format!("{} .. {}", as_written(low), as_written(high));
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
            row.extend(v.fitted.iter().flat_map(|fitted| fitted.cells(decimals)));
            table.push_row(row);
        }
        table
    }

    /// Moves of the hardpoints by axis, the largest first. Of points that move together it has those of the first, and
    /// then no distances.
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
            moves[at].1[axis] += offset;
        }
        let length = |by: &[f64; 3]| by.iter().map(|c| c * c).sum::<f64>().sqrt();
        moves.retain(|(_, by)| length(by) > 0.0);
        moves.sort_by(|a, b| length(&b.1).total_cmp(&length(&a.1)));
        // A point that also moves with others goes farther than its own row says.
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
        let signed = |by: f64| match shown(by) {
            text if by > 0.0 => format!("+{text}"),
            text => text,
        };
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

    /// Returns the table of the targets before and after. For readers it has the largest deviation in the unit of the
    /// target, beside its tolerance. For programs it has all deviations in tolerances.
    pub fn targets_table(&self) -> Table {
        let columns = [
            Column::from("target"),
            Column::for_readers("wanted"),
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
        ];
        let programs = programs.map(Column::for_programs);
        let mut table = Table::with_columns(columns.into_iter().chain(programs));
        for t in &self.targets {
            let (before, after) = (t.before.as_ref(), t.after.as_ref());
            let unit = after.map_or("", |d| d.worst_at_unit.as_str());
            let off = |d: Option<&DeviationSummary>| {
                let worst = d.map(|d| d.worst_in_unit.unwrap_or(d.worst * t.tolerance));
                Cell::by(worst, |worst| to_hundredth_of(worst, t.tolerance))
            };
            table.push([
                Cell::from(t.output.as_str()),
                t.wanted_in_words().into(),
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
            ]);
        }
        table
    }

    /// Number of targets.
    pub fn targets(&self) -> usize {
        self.targets.len()
    }

    /// Returns the targets that are missed by more than their tolerance somewhere: their numbers and columns, and
    /// size and place of the deviation.
    pub fn missed(&self) -> Vec<(usize, &str, String)> {
        let targets = self.targets.iter().enumerate();
        let missed = targets.filter_map(|(number, t)| {
            let after = t.after.as_ref().filter(|d| d.worst.abs() > 1.0)?;
            let by = hundredths(after.worst.abs());
            let at = with_unit(after.worst_at, &after.worst_at_unit);
            Some((number, &*t.output, format!("{by} tolerances at {at}")))
        });
        missed.collect()
    }

    /// Returns the table of the constraints; `None` without constraints.
    pub fn constraints_table(&self) -> Option<Table> {
        if self.constraints.is_empty() {
            return None;
        }
        let columns = ["constraint", "room", "unit", "at", "kept", "price"].map(Column::from);
        let programs = [Column::for_programs("at unit")];
        let mut table = Table::with_columns(columns.into_iter().chain(programs));
        for c in &self.constraints {
            let status = c.status();
            let kept = match status {
                ConstraintStatus::Violated => Some("VIOLATED".to_owned()),
                ConstraintStatus::Binds => Some("binds".to_owned()),
                ConstraintStatus::Kept => None,
            };
            let brief = |margin: f64| match status {
                ConstraintStatus::Binds => "0".to_owned(),
                _ => brief(margin),
            };
            table.push([
                Cell::from(c.name.as_str()),
                Cell::by(c.room, brief),
                c.unit.as_str().into(),
                c.place(),
                kept.into(),
                match c.price_not_determined {
                    true => Cell::from("not determined"),
                    false => c.price.into(),
                },
                c.at_unit.as_str().into(),
            ]);
        }
        Some(table)
    }

    /// The constraints that are violated, by their rows in [`TuningSummary::constraints_table`].
    pub fn violated(&self) -> Vec<usize> {
        let rows = self.constraints.iter().enumerate();
        let violated = rows.filter(|(_, c)| c.status() == ConstraintStatus::Violated);
        violated.map(|(row, _)| row).collect()
    }

    /// Returns remarks on targets and constraints, in sentences.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        for added in &self.added_stations {
            let at: Vec<String> = added.at.iter().map(|at| as_written(*at)).collect();
            remarks.push(format!(
                "{} has fewer stations of the motion than its curve has points: compared at {}{} as well",
                added.target,
                at.join(", "),
                if added.unit.is_empty() { String::new() } else { format!(" {}", added.unit) }
            ));
        }
        for target in &self.unmoved {
            remarks.push(format!(
                "no variable moves {target}: it stays as far from its target as it is"
            ));
        }
        for constraint in &self.unmoved_constraints {
            remarks.push(format!(
                "no variable moves this constraint, which stays violated: {constraint}. Add a variable that moves it, or \
                 change its limit"
            ));
        }
        remarks.extend(self.fit_remarks());
        for (first, second, correlation) in self.correlations.iter().take(3) {
            remarks.push(format!(
                "the measurements hardly tell {first} from {second}: correlation {correlation:.3}"
            ));
        }
        for c in &self.constraints {
            if let Some(price) = c.price {
                remarks.push(format!(
                    "{} costs {} tolerances per {}",
                    c.name,
                    brief(price),
                    c.unit
                ));
            }
        }
        match self.contradiction.as_slice() {
            [] => {}
            [alone] => remarks.push(format!("nothing within the ranges keeps this: {alone}")),
            several => remarks.push(format!(
                "these cannot be kept together: {}",
                several.join("; ")
            )),
        }
        remarks
    }

    /// Sentences on the intervals of a fit.
    fn fit_remarks(&self) -> Vec<String> {
        let Some(scatter) = self.scatter else {
            return Vec::new();
        };
        let mut remarks = vec![format!(
            "measurements scatter by {} of their tolerances about the fit; the true move is within the interval \
             \"moved, 95 %\" with 95 % confidence, if the truth lies within all ranges; \"not determined\": anywhere \
             in its range",
            brief(scatter)
        )];
        if self.variables.iter().any(|v| v.at_bound.is_some()) {
            remarks.push(
                "a variable at its bound is not known: its interval is one-sided, and the intervals of the others \
                 allow for every value that it may have"
                    .to_owned(),
            );
        }
        let reaches = |v: &&VariableSummary| {
            let ends = v.fitted.map_or([None; 2], |fitted| fitted.ends());
            v.at_bound.is_none() && (ends[0] == Some(v.range[0]) || ends[1] == Some(v.range[1]))
        };
        let reaching = self.variables.iter().filter(reaches);
        let reaching: Vec<String> = reaching
            .map(|v| format!("{}.{}", v.hardpoint, v.axis))
            .collect();
        if !reaching.is_empty() {
            remarks.push(format!(
                "only the range, not the measurements, limits one side of {}",
                reaching.join(", ")
            ));
        }
        remarks
    }

    /// Returns true if a request cannot be met. A constraint is violated, or a target that no variable changes is
    /// missed by more than its tolerance.
    pub fn falls_short(&self) -> bool {
        let missed = |target: &TargetSummary| {
            let rms = target.after.as_ref().map_or(0.0, |after| after.rms);
            rms > 1.0 && self.unmoved.contains(&target.output)
        };
        !self.violated().is_empty() || self.targets.iter().any(missed)
    }

    /// Returns the table of the starts.
    pub fn starts_table(&self) -> Table {
        let columns = [
            Column::for_readers("start"),
            Column::for_programs("start"),
            Column::for_programs("kept"),
        ];
        let more = ["misfit", "iterations", "ended"].map(Column::from);
        let mut table = Table::with_columns(columns.into_iter().chain(more));
        for s in &self.starts {
            let kept = self.best_start == Some(s.start);
            let name = match kept {
                true => format!("{} (kept)", s.start),
                false => s.start.to_string(),
            };
            table.push([
                Cell::from(name),
                s.start.into(),
                kept.into(),
                Cell::by(s.misfit, hundredths),
                s.iterations.into(),
                s.ended.as_str().into(),
            ]);
        }
        table
    }

    /// Number of starts that were interrupted before their end, and number of all starts.
    pub fn interrupted(&self) -> [usize; 2] {
        let word = Termination::Interrupted.to_string();
        let interrupted = self.starts.iter().filter(|s| s.ended == word);
        [interrupted.count(), self.starts.len()]
    }

    /// Returns the completed share of an interrupted tuning, in words.
    pub fn interrupted_in_words(&self) -> String {
        let [interrupted, all] = self.interrupted();
        match interrupted {
            0 => format!(
                "interrupted: {} done, not all that was to be made of what they came to",
                counted(all, "start")
            ),
            some => format!(
                "interrupted: {} of {} done",
                all - some,
                counted(all, "start")
            ),
        }
    }

    /// The starts in a line or two, where there are more than a few.
    pub fn starts_in_words(&self) -> Option<String> {
        let all = self.starts.len();
        if all <= FEW_STARTS {
            return None;
        }
        let best = self.misfit_after?;
        let begun: Vec<f64> = self.starts.iter().filter_map(|s| s.misfit).collect();
        let [interrupted, _] = self.interrupted();
        let word = Termination::Interrupted.to_string();
        let ended = self.starts.iter().filter(|s| s.ended != word);
        let ended: Vec<f64> = ended.filter_map(|s| s.misfit).collect();
        let near = ended.iter().filter(|m| **m <= 1.01 * best + 1e-6).count();
        let worst = ended.iter().copied().fold(best, f64::max);
        let kept = self
            .best_start
            .map_or_else(String::new, |k| format!(" (start {k} is kept)"));
        let mut text = format!(
            "{all} starts: {near} ended within 1 % of the least misfit{kept}, the worst at {}",
            hundredths(worst)
        );
        match all - begun.len() {
            0 => {}
            failed => text += &format!("; {failed} could not be begun"),
        }
        match interrupted {
            0 => {}
            some => text += &format!("; {some} were interrupted"),
        }
        Some(text + "; history.csv and summary.json have all")
    }

    /// The outcome in a sentence or two.
    pub fn headline(&self) -> String {
        match (self.misfit_before, self.misfit_after) {
            (Some(before), Some(after)) => {
                let kept = match self.violated().len() {
                    0 => String::new(),
                    1 => "; a constraint is violated".to_owned(),
                    several => format!("; {several} constraints are violated"),
                };
                let of_builds = self.scatter_builds.map_or(String::new(), |builds| {
                    format!(", root mean square of {builds} builds")
                });
                let effects = side_effects_in_words(&self.side_effects);
                let effects = effects.map_or(String::new(), |words| format!("; {words}"));
                format!(
                    "misfit {} -> {} tolerances{of_builds}{kept}{effects}",
                    hundredths(before),
                    hundredths(after)
                )
            }
            (None, Some(after)) => format!(
                "misfit {} tolerances; the design itself cannot be compared: {}",
                hundredths(after),
                self.design_failure.as_deref().unwrap_or_default()
            ),
            _ => format!(
                "no start could be evaluated: {}",
                self.design_failure
                    .as_deref()
                    .or(self.starts.first().map(|s| s.ended.as_str()))
                    .unwrap_or_default()
            ),
        }
    }

    /// Combinations of variables that the targets cannot tell apart, in words.
    pub fn unseen(&self) -> Vec<String> {
        let describe = |change: &Vec<f64>| {
            let parts = change
                .iter()
                .zip(&self.variables)
                .filter(|(c, v)| c.abs() > 1e-3 * (v.range[1] - v.range[0]));
            let parts: Vec<String> = parts
                .map(|(c, v)| format!("{}.{} {c:+.3}", v.hardpoint, v.axis))
                .collect();
            parts.join(", ")
        };
        self.unseen.iter().map(describe).collect()
    }
}

/// As many starts are listed one by one.
const FEW_STARTS: usize = 8;

/// Constraints violated by less than this (a millimetre, a degree are 1) are kept.
const VISIBLE: f64 = 1e-6;
/// Constraints with less margin than this bind.
const BINDING: f64 = 1e-6;

/// A number with its unit; without one in summaries of older versions, which do not name it.
fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "" => as_written(value),
        unit => format!("{} {unit}", as_written(value)),
    }
}

/// Least and largest wanted value, as printed.
fn wanted(target: &Target) -> [Option<f64>; 2] {
    let factor = target.of.factor();
    let range = |points: &[[f64; 2]]| {
        let values = || points.iter().map(|[_, value]| value * factor);
        [values().reduce(f64::min), values().reduce(f64::max)]
    };
    let limit = |limit: &Option<Limit>| match limit {
        Some(Limit::Value(value)) => range(&[[0.0, *value]]),
        Some(Limit::Curve { points, .. }) => range(points),
        None => [None, None],
    };
    match &target.wanted {
        Wanted::Curve { points, .. } | Wanted::Points(points) => range(points),
        Wanted::At { value, .. } => range(&[[0.0, *value]]),
        Wanted::Band { lower, upper, .. } => {
            let (lower, upper) = match factor < 0.0 {
                true => (upper, lower),
                false => (lower, upper),
            };
            [limit(lower)[0], limit(upper)[1]]
        }
    }
}

impl TargetSummary {
    fn wanted_in_words(&self) -> String {
        match self.wanted {
            [None, None] => String::new(),
            [Some(lower), None] => format!("from {}", brief(lower)),
            [None, Some(upper)] => format!("up to {}", brief(upper)),
            [Some(one), Some(other)] if one == other => brief(one),
            [Some(lower), Some(upper)] => format!("{} .. {}", brief(lower), brief(upper)),
        }
    }
}

/// A deviation in the unit of its target, to a hundredth of the tolerance.
fn to_hundredth_of(deviation: f64, tolerance: f64) -> String {
    let decimals = (2.0 - tolerance.log10().floor()).clamp(0.0, 12.0) as usize;
    with_decimals(deviation, decimals)
}

/// A misfit for reading: two decimals, or its order of magnitude.
fn hundredths(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else if value.abs() < 0.005 {
        format!("{value:.0e}")
    } else {
        format!("{value:.2}")
    }
}

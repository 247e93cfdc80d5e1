//! Makes the summary of a tuning.

use super::*;
use crate::axle::Quantity as OfAxle;
use crate::characteristics::{Characteristic, Measure, Quantity};
use crate::model::SpinAxis;
use crate::number::Vector3;
use crate::optimise::StandardErrors;
use crate::report::record::readable_unit;
use crate::study::{Constraint, Drive, Rate, TargetKind, Variable};

impl TuningSummary {
    /// Summarises a tuning. `after` has the curves of the tuned design. Prices, side effects and yields are added later.
    pub fn of(study: &Study, optimise: &Optimise, tuning: &Tuning, after: Option<&Curves>) -> Self {
        let source = TunedStudy {
            study,
            optimise,
            tuning,
        };
        let best = tuning.best.as_ref();
        let fit = tuning.starts.best_fit();
        let errors = best.and_then(|b| b.errors.as_ref());
        let constraint = |c: &usize| optimise.constraints[*c].name.clone();
        let target = |t: &usize| source.name(&optimise.targets[*t]);
        TuningSummary {
            command: "optimise".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: study.name.clone(),
            topology: study.wheel().mechanism.topology.name.to_owned(),
            misfit_before: tuning.before.as_ref().ok().map(|f| f.misfit),
            design_failure: tuning.before.as_ref().err().map(ToString::to_string),
            misfit_after: best.map(|b| b.after.misfit),
            best_start: tuning.starts.best,
            kkt_residual: fit.and_then(|fit| fit.residual),
            variables: source.variables(),
            targets: source.targets(),
            starts: source.starts(),
            rank: best.map(|b| b.identifiability.rank),
            singular_values: best
                .map(|b| b.identifiability.singular_values.clone())
                .unwrap_or_default(),
            unseen: source.unseen(),
            scatter: errors.map(|errors| errors.scatter),
            correlations: errors.map_or(Vec::new(), |errors| source.correlations(errors)),
            good_enough: optimise.good_enough,
            constraints: source.constraints(),
            unmoved: tuning.unmoved.targets.iter().map(target).collect(),
            unmoved_keys: source.unmoved_keys(),
            hardly_moved: SlightEffectRecord::all(&tuning.unmoved.slightly, |number| {
                target(&number)
            }),
            holding: source.holding(),
            unmoved_constraints: tuning.unmoved_constraints.iter().map(constraint).collect(),
            contradiction: tuning.contradiction.iter().map(constraint).collect(),
            added_stations: source.added_stations(),
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
}

/// A study with its tuning.
struct TunedStudy<'a> {
    study: &'a Study,
    optimise: &'a Optimise,
    tuning: &'a Tuning,
}

impl TunedStudy<'_> {
    /// Name of a target: column, motion, rack displacements in the study's axes, and coordinates that stay constant.
    fn name(&self, target: &Target) -> String {
        let motion = target.site.motion.as_ref();
        let motion = motion.map_or(String::new(), |(name, _)| format!(", {name}"));
        let racks: Vec<String> = target.site.racks.iter().map(|r| as_written(*r)).collect();
        let racks = match racks.as_slice() {
            [] => String::new(),
            racks => format!(", rack {}", racks.join(" ")),
        };
        let held = target.site.axle.as_ref();
        let held = held.map_or(String::new(), |site| {
            format!(" over {}{}", site.over.key(), site.in_words())
        });
        format!("{}{motion}{racks}{held}", target.of.column)
    }

    /// Keys of `[wheel]` that give the values of missed targets on which no variable has an effect, by the name of the target.
    fn unmoved_keys(&self) -> BTreeMap<String, String> {
        let unmoved = self.tuning.unmoved.targets.iter();
        let unmoved = unmoved.map(|number| &self.optimise.targets[*number]);
        unmoved
            .filter_map(|target| Some((self.name(target), self.wheel_key(target)?.to_owned())))
            .collect()
    }

    /// Key of `[wheel]` that gives the value of a target: camber or toe in the design position, if no hardpoint gives the spin
    /// axis. `None` for other targets.
    fn wheel_key(&self, target: &Target) -> Option<&'static str> {
        if matches!(self.study.wheel().mechanism.spin_axis, SpinAxis::From(_)) {
            return None;
        }
        let of_wheel = |quantity: &OfAxle| match quantity {
            OfAxle::Corner(_, characteristic) => Some(*characteristic),
            _ => None,
        };
        let characteristic = match &target.of.kind {
            TargetKind::Axle(quantities) => quantities.iter().find_map(of_wheel),
            _ => target.of.as_characteristic(),
        };
        let key = match characteristic? {
            Characteristic::Camber => "static_camber",
            Characteristic::Toe => "static_toe",
            _ => return None,
        };
        let motion = match &target.site.motion {
            Some((_, motion)) => motion,
            None => self.study.motion(),
        };
        let is_at_zero = match &target.wanted {
            Wanted::At { drive, .. } => *drive == 0.0,
            Wanted::Band { at, .. } => *at == Some(0.0),
            Wanted::Curve { .. } | Wanted::Points(_) => false,
        };
        // A target without its own racks is straight ahead if the motion moves the rack.
        let racks = match &target.site.racks[..] {
            [] if motion.rack.len() > 1 => &[],
            [] => &motion.rack[..],
            own => own,
        };
        let others_are_zero = match &target.site.axle {
            Some(site) => site.words.is_empty(),
            None => motion.drive != Drive::PaperTheta && racks.iter().all(|rack| *rack == 0.0),
        };
        (is_at_zero && others_are_zero).then_some(key)
    }

    fn variables(&self) -> Vec<VariableSummary> {
        let variables = self.optimise.variables.iter().enumerate();
        variables.map(|(k, v)| self.variable(k, v)).collect()
    }

    /// Summary of the variable with index `k`.
    fn variable(&self, k: usize, variable: &Variable) -> VariableSummary {
        let suspension = self.study.wheel();
        let best = self.tuning.best.as_ref();
        let errors = best.and_then(|b| b.errors.as_ref());
        let fit = self.tuning.starts.best_fit();
        let coordinate = |design: &[Vector3<f64>]| {
            let (axis, first) = (variable.axis()?, variable.moves.first()?);
            let point = suspension.frame.vector(design[first.point.0]).to_array();
            Some(point[axis as usize])
        };
        let fitted = errors.map(|e| FittedOffset::from(e.intervals[k]));
        let length = suspension.length_unit;
        let (unit, of_axis) = match (&variable.turn, &variable.rate) {
            (Some(_), _) => ("deg".to_owned(), ", deg".to_owned()),
            (None, Some(rate)) => {
                let readable = |rate: &Rate| readable_unit(&rate.value_unit(length));
                let own = readable(&Rate {
                    is_relative: false,
                    ..*rate
                });
                let of_axis = if rate.is_relative {
                    format!(", {own} (moved and range: natural logarithm of a factor)")
                } else {
                    format!(", {own}")
                };
                (readable(rate), of_axis)
            }
            (None, None) => (length.symbol().to_owned(), String::new()),
        };
        let rate = |x: f64| variable.rate.map(|rate| rate.at(x)[0]);
        VariableSummary {
            hardpoint: variable.name.clone(),
            axis: format!("{}{of_axis}", variable.way()),
            design: coordinate(&suspension.design).or(rate(0.0)),
            tuned: best.and_then(|b| coordinate(&b.design).or(rate(b.offsets[k]))),
            offset: best.map(|b| b.offsets[k] + 0.0),
            unit,
            range: variable.range,
            at_bound: fit.and_then(|fit| bound_in_words(fit.active_bounds[k])),
            standard_error: errors.and_then(|e| e.sigmas[k]),
            interval: fitted.and_then(|fitted| fitted.half()),
            fitted,
        }
    }

    fn constraints(&self) -> Vec<ConstraintSummary> {
        let Some(best) = &self.tuning.best else {
            return Vec::new();
        };
        let outcomes = self.optimise.constraints.iter().zip(&best.constraints);
        outcomes
            .map(|(constraint, found)| self.constraint(constraint, found))
            .collect()
    }

    fn constraint(&self, constraint: &Constraint, found: &ConstraintOutcome) -> ConstraintSummary {
        let site = constraint.site.as_ref();
        let motion = site.and_then(|site| site.motion.as_ref());
        let drive = motion.map_or(self.study.motion().drive, |(_, motion)| motion.drive);
        let part = &constraint.parts[0];
        let limit = single_limit(constraint, found.is_upper);
        let towards = if found.is_upper { -1.0 } else { 1.0 };
        let margin = (!found.margin.is_nan()).then_some(found.margin + 0.0);
        ConstraintSummary {
            name: constraint.name.clone(),
            value: limit
                .zip(margin)
                .map(|(limit, margin)| limit + towards * margin + 0.0),
            limit,
            is_upper: found.is_upper,
            margin,
            unit: part.unit.clone(),
            at: found.at.map(|at| drive.printed(at)),
            at_unit: drive.unit(self.study.wheel().length_unit).to_owned(),
            price: found.price.per_unit(),
            price_not_determined: found.price == Price::NotDetermined,
            status: Some(ConstraintStatus::of(found.margin / part.visible)),
        }
    }

    fn added_stations(&self) -> Vec<AddedStations> {
        let drive = self.study.motion().drive;
        let unit = self.study.wheel().length_unit;
        let added = self
            .optimise
            .targets
            .iter()
            .filter(|t| !t.stations.is_empty());
        let summary = |target: &Target| AddedStations {
            target: self.name(target),
            at: target
                .stations
                .iter()
                .map(|at| target.printed_at(drive, *at))
                .collect(),
            unit: target.unit_at(drive, unit).to_owned(),
        };
        added.map(summary).collect()
    }

    fn targets(&self) -> Vec<TargetSummary> {
        let suspension = self.study.wheel();
        let drive = self.study.motion().drive;
        let summary = |(k, target): (usize, &Target)| {
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
            let values = |all: Option<&[[f64; 2]]>| {
                let [one, other] = all?[k].map(|value| value * target.of.factor() + 0.0);
                Some([one.min(other), one.max(other)])
            };
            TargetSummary {
                output: self.name(target),
                tolerance: target.tolerance * target.of.factor().abs(),
                wanted: wanted(target),
                between_curves: is_between_curves(target),
                weight: target.weight,
                values_before: values(self.tuning.values.as_deref()),
                values_after: values(self.tuning.best.as_ref().and_then(|b| b.values.as_deref())),
                before: self.tuning.before.as_ref().ok().map(deviation),
                after: self.tuning.best.as_ref().map(|b| deviation(&b.after)),
            }
        };
        let targets = self.optimise.targets.iter().enumerate();
        targets.map(summary).collect()
    }

    /// Bounds of variables that keep targets from being met. `None` if they are not known.
    fn holding(&self) -> Option<Vec<HoldingRecord>> {
        let best = self.tuning.best.as_ref()?;
        let length = self.study.wheel().length_unit;
        let missed = |number: usize| {
            let (target, found) = (&self.optimise.targets[number], best.after.targets[number]);
            (found.worst.abs() > 1.0).then(|| Missed {
                name: self.name(target),
                rms: found.rms * target.tolerance * target.of.factor().abs(),
                unit: target.of.unit.suffix(length).replace("_per_", "/"),
            })
        };
        let moved = |number: usize| {
            let own = self.variable(number, &self.optimise.variables[number]);
            Moved {
                name: format!("{}.{}", own.hardpoint, own.way()),
                unit: own.unit,
                range: own.range,
            }
        };
        let (targets, found) = (self.optimise.targets.len(), best.holding.as_ref()?);
        Some(HoldingRecord::all(targets, found, missed, moved))
    }

    fn starts(&self) -> Vec<StartSummary> {
        StartSummary::all(&self.tuning.starts)
    }

    /// Moves of the variables that hardly change the targets. For each direction of such moves, it is the largest move that raises
    /// the misfit by at most [`Direction::RISE`] and keeps the constraints. Moves below a hundredth of a range are left out.
    fn unseen(&self) -> Vec<Vec<f64>> {
        let Some(best) = &self.tuning.best else {
            return Vec::new();
        };
        let directions = best.identifiability.unseen.iter().filter_map(|d| {
            let [up, down] = d.free;
            let share = if up >= down { up } else { -down };
            (share.abs() > 0.01).then(|| d.change.iter().map(|c| c * share).collect())
        });
        directions.collect()
    }

    fn correlations(&self, errors: &StandardErrors) -> Vec<(String, String, f64)> {
        let name = |j: usize| {
            let v = &self.optimise.variables[j];
            format!("{}.{}", v.name, v.way())
        };
        let pairs = errors.correlations.iter();
        pairs.map(|(i, j, c)| (name(*i), name(*j), *c)).collect()
    }
}

/// Upper or lower limit of a constraint on a single length or characteristic, in its unit. `None` for constraints on other measures
/// (such as regions, clearances and forces), and for a constraint that fixes a value.
fn single_limit(constraint: &Constraint, is_upper: bool) -> Option<f64> {
    let [part] = &constraint.parts[..] else {
        return None;
    };
    let of = &part.of;
    let is_shown = matches!(
        of,
        Measure::Length(_) | Measure::Quantity(Quantity::Characteristic(_))
    );
    let limit = part.limits()[usize::from(is_upper)];
    limit.filter(|_| is_shown && part.lower != part.upper)
}

/// Returns true for a band if one of its limits is a curve over the motion.
fn is_between_curves(target: &Target) -> bool {
    let is_curve = |limit: &Option<Limit>| matches!(limit, Some(Limit::Curve { .. }));
    match &target.wanted {
        Wanted::Band { lower, upper, .. } => is_curve(lower) || is_curve(upper),
        _ => false,
    }
}

/// Smallest and largest target value, as printed numbers. For a band: smallest value of the lower limit, and largest value of the
/// upper limit. `None` without a limit.
pub(in crate::report) fn wanted(target: &Target) -> [Option<f64>; 2] {
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
            let (lower, upper) = if factor < 0.0 {
                (upper, lower)
            } else {
                (lower, upper)
            };
            [limit(lower)[0], limit(upper)[1]]
        }
    }
}

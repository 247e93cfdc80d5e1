//! Verdict on the tuning of a car: remarks on targets and constraints.

use super::record::{CarConstraintRecord, CarTargetRecord};
use super::tuning::car_constraint_names;
use crate::axle::Law;
use crate::car::{AxleEnd, AxleResult, CarQuantity, CarTuning};
use crate::report::tuning_summary::{
    ConstraintStatus, HoldingRecord, Missed, Moved, SlightEffectRecord, contradiction_in_words,
    least_violation_in_words, not_held, price_in_words, unmoved_constraint_in_words,
    unmoved_in_words, violation_in_words,
};
use crate::study::CarStudy;
use serde_json::{Value, json};

/// Targets and constraints of a tuned car, with the tuning.
#[derive(Clone, Copy)]
pub struct CarVerdict<'a> {
    /// Study before the tuning.
    pub study: &'a CarStudy,
    /// Targets with their values before and after the tuning.
    pub targets: &'a [CarTargetRecord],
    /// Constraints with their margins before and after the tuning.
    pub constraints: &'a [CarConstraintRecord],
    /// The tuning whose result is judged.
    pub tuning: &'a CarTuning,
}

impl CarVerdict<'_> {
    /// Names of constraints that exclude one another, with their limits.
    pub fn contradiction(&self) -> Vec<String> {
        car_constraint_names(self.constraints, &self.tuning.contradiction)
    }

    /// Names of missed targets on which no variable has an effect.
    fn unmoved(&self) -> Vec<String> {
        let targets = self.tuning.unmoved.targets.iter();
        targets
            .map(|target| self.targets[*target].full_name())
            .collect()
    }

    fn hardly_moved(&self) -> Vec<SlightEffectRecord> {
        let name = |target: usize| self.targets[target].full_name();
        SlightEffectRecord::all(&self.tuning.unmoved.slightly, name)
    }

    /// Names of violated constraints on which no variable has an effect, with their limits.
    fn unmoved_constraints(&self) -> Vec<String> {
        car_constraint_names(self.constraints, &self.tuning.unmoved_constraints)
    }

    /// Bounds of variables that keep targets from being met. `None` if they are not known.
    pub fn holding(&self) -> Option<Vec<HoldingRecord>> {
        let found = self.tuning.holding.as_ref()?;
        let variables = &self.study.optimise.as_ref()?.variables;
        let in_words = |unit: &str| unit.replace("_per_", "/");
        let missed = |number: usize| {
            let target = &self.targets[number];
            target.missed_by()?;
            // For a target of an axle alone, `values` already contains the root mean square deviation.
            let of_case = || Some(target.deviation?.abs() * target.tolerance);
            Some(Missed {
                name: target.full_name(),
                rms: target.curve.map_or_else(of_case, |_| target.values[1])?,
                unit: in_words(target.unit()),
            })
        };
        let moved = |number: usize| {
            let own = &variables[number];
            Moved {
                name: own.moves.label(&self.study.car),
                unit: in_words(&own.moves.unit(&self.study.car)),
                range: own.range,
            }
        };
        Some(HoldingRecord::all(self.targets.len(), found, missed, moved))
    }

    /// Sentences about missed targets that no bound of a variable keeps from being met.
    fn not_held(&self) -> Vec<String> {
        let Some(records) = self.holding() else {
            return Vec::new();
        };
        let unmoved = &self.tuning.unmoved;
        let is_movable = |number: &usize| {
            let is_slight = unmoved.slightly.iter().any(|own| own.target == *number);
            !is_slight && !unmoved.targets.contains(number)
        };
        let missed = (0..self.targets.len()).filter(|k| self.targets[*k].missed_by().is_some());
        let names = missed.filter(is_movable);
        let names: Vec<String> = names.map(|k| self.targets[k].full_name()).collect();
        not_held(
            &names.iter().map(String::as_str).collect::<Vec<_>>(),
            &records,
        )
    }

    /// Lines about targets that are missed by more than their tolerance.
    pub fn missed(&self) -> Vec<String> {
        let missed = self.targets.iter().filter_map(|target| {
            let by = target.missed_by()?;
            Some(format!("missed: {}, by {by}", target.full_name()))
        });
        missed.collect()
    }

    /// Remarks on targets and constraints, in sentences.
    pub fn remarks(&self) -> Vec<String> {
        let unmoved = self.unmoved().into_iter();
        let mut remarks: Vec<String> = unmoved.map(|name| unmoved_in_words(&name, None)).collect();
        remarks.extend(self.hardly_moved().iter().map(SlightEffectRecord::in_words));
        remarks.extend(self.not_held());
        let ends = AxleEnd::ALL.into_iter();
        remarks.extend(ends.filter_map(|end| self.fixed_spring_force(end)));
        let unmoved = self.unmoved_constraints().into_iter();
        remarks.extend(unmoved.map(|name| unmoved_constraint_in_words(&name)));
        let priced = self.constraints.iter();
        remarks.extend(
            priced.filter_map(|own| Some(price_in_words(&own.name, own.price?, &own.unit))),
        );
        remarks.extend(contradiction_in_words(&self.contradiction()));
        remarks.extend(self.least_violation());
        remarks
    }

    /// Explains a missed ride height of an axle in a load case. The variables move points of this axle, but its spring has the
    /// same force in the design position of every design. `None` in other cases, and for springs with a force curve.
    fn fixed_spring_force(&self, end: AxleEnd) -> Option<String> {
        let wanted = self.study.optimise.as_ref()?;
        let axle = AxleEnd::ALL.iter().position(|own| *own == end)?;
        let [spring, _] = self.study.car.axles[axle].setup.springs.as_ref()?;
        let ride_height = CarQuantity::Axle(end, AxleResult::RideHeight);
        let mut targets = wanted.targets.iter().zip(self.targets);
        let (_, missed) = targets
            .find(|(target, own)| target.quantity == ride_height && own.missed_by().is_some())?;
        let mut moves = wanted.variables.iter().flat_map(|own| own.moves.points());
        let is_moved = moves.any(|point| point.axle == axle);
        (is_moved && matches!(spring.spring, Law::Linear { .. })).then(|| {
            format!(
                "{}: every design has the force of [spring] in its design position, so a moved spring mount changes the \
                 ride height only a little. Change this force, or replace rate and force by force_curve, which keeps the \
                 same spring in every design",
                missed.full_name()
            )
        })
    }

    /// Reason why the tuning keeps a result that violates constraints, although a variable affects these constraints. `None`
    /// without such violations.
    fn least_violation(&self) -> Option<String> {
        let violated = self.constraints.iter().enumerate().filter(|(number, own)| {
            own.status.is_some_and(ConstraintStatus::is_violated)
                && !self.tuning.unmoved_constraints.contains(number)
        });
        let violated =
            violated.map(|(_, own)| violation_in_words(&own.name, own.margins[1], &own.unit));
        least_violation_in_words(self.tuning.starts.best, &violated.collect::<Vec<_>>())
    }

    /// Verdict for `summary.json`.
    pub fn json(&self) -> Value {
        json!({
            "unmoved": self.unmoved(),
            "hardly_moved": self.hardly_moved(),
            "holding": self.holding(),
            "unmoved_constraints": self.unmoved_constraints(),
        })
    }
}

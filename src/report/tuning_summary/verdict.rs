//! Verdict on targets and constraints, for the tuning of a study or a car.

use super::misfit_in_words;
use crate::optimise::SlightEffect;
use crate::optimise::VIOLATED;
use crate::report::brief;
use serde::{Deserialize, Serialize};

/// Margin below which a constraint counts as binding, as a multiple of a visible change (1 mm or 1 degree).
const BINDING: f64 = 1e-6;

/// Status of a constraint in the tuned design.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ConstraintStatus {
    /// The margin to every limit is positive.
    Kept,
    /// The value is at a limit, to a millionth of a visible change.
    Binds,
    /// A limit is violated.
    Violated,
    /// The margin is not known, because a value is missing. Such a constraint counts as violated.
    Unknown,
}

impl ConstraintStatus {
    /// Status for a margin, as a multiple of a visible change ([`crate::study::Limited::visible`]). NaN for an unknown margin.
    pub(in crate::report) fn of(margin: f64) -> Self {
        match margin {
            margin if margin.is_nan() => ConstraintStatus::Unknown,
            margin if margin < -VIOLATED => ConstraintStatus::Violated,
            margin if margin < BINDING => ConstraintStatus::Binds,
            _ => ConstraintStatus::Kept,
        }
    }

    /// Words for the status in a table cell; `None` for a constraint whose margin is positive.
    pub(in crate::report) fn in_words(self) -> Option<&'static str> {
        match self {
            ConstraintStatus::Violated => Some("VIOLATED"),
            ConstraintStatus::Unknown => Some("not computed"),
            ConstraintStatus::Binds => Some("binds"),
            ConstraintStatus::Kept => None,
        }
    }

    /// True if the constraint counts as violated.
    pub(in crate::report) fn is_violated(self) -> bool {
        matches!(self, ConstraintStatus::Violated | ConstraintStatus::Unknown)
    }
}

/// A missed target that the variables hardly change: its RMS deviation and the possible change, as multiples of its tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlightEffectRecord {
    target: String,
    deviation: f64,
    change: f64,
}

impl SlightEffectRecord {
    /// Makes the records of missed targets that the variables hardly change. `name` returns the name of the target with an index.
    pub fn all(effects: &[SlightEffect], name: impl Fn(usize) -> String) -> Vec<Self> {
        let record = |effect: &SlightEffect| SlightEffectRecord {
            target: name(effect.target),
            deviation: effect.deviation,
            change: effect.change,
        };
        effects.iter().map(record).collect()
    }

    /// True if the record is about this target.
    pub(in crate::report) fn is_about(&self, target: &str) -> bool {
        self.target == target
    }

    /// Sentences that explain why the target is missed.
    pub fn in_words(&self) -> String {
        format!(
            "the variables hardly affect {}: it is missed by {} tolerances, and moves of all variables across their ranges \
             change it by about {} tolerances. Such a target can drive variables to the ends of their ranges: remove it, or \
             add a variable that affects it",
            self.target,
            misfit_in_words(self.deviation),
            misfit_in_words(self.change)
        )
    }
}

/// Sentences about a missed target that no variable changes. `key` is the key of `[wheel]` that gives its value, if there is one.
pub(in crate::report) fn unmoved_in_words(target: &str, key: Option<&str>) -> String {
    let words =
        format!("no variable affects {target}: its deviation from the target stays the same");
    match key {
        Some(key) => format!(
            "{words}. The key {key} in [wheel] gives this angle in the design position: change this key instead"
        ),
        None => words,
    }
}

/// Sentences about a violated constraint that no variable changes.
pub(in crate::report) fn unmoved_constraint_in_words(constraint: &str) -> String {
    format!(
        "no variable affects this constraint, which stays violated: {constraint}. Add a variable that affects it, or change \
         its limit"
    )
}

/// Sentence about the price of a limit: the decrease of the misfit if the limit moves outward by one unit.
pub(in crate::report) fn price_in_words(constraint: &str, price: f64, unit: &str) -> String {
    format!(
        "relaxing the constraint {constraint} lowers the misfit by {} tolerances per {unit}",
        brief(price)
    )
}

/// Violation of a constraint in words. `margin` is its negative margin, or `None` if the margin is not known.
pub(in crate::report) fn violation_in_words(name: &str, margin: Option<f64>, unit: &str) -> String {
    margin.map_or_else(
        || format!("{name}, which has no value"),
        |margin| format!("{name} by {} {unit}", brief(-margin)),
    )
}

/// Reason why the tuning keeps the start `kept` although its design violates constraints. `violated` lists the constraints with
/// their violations. `None` without violations.
pub(in crate::report) fn least_violation_in_words(
    kept: Option<usize>,
    violated: &[String],
) -> Option<String> {
    let kept = kept.filter(|_| !violated.is_empty())?;
    Some(format!(
        "no start satisfied all constraints; start {kept} is kept because its largest violation is the smallest of all \
         starts. Missed: {}",
        violated.join("; ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A constraint without a value is not satisfied, as in a sweep.
    #[test]
    fn a_margin_without_a_value_counts_as_violated() {
        let status = ConstraintStatus::of(f64::NAN);
        assert!(status.is_violated());
        assert_eq!(status.in_words(), Some("not computed"));
        assert!(!ConstraintStatus::of(0.0).is_violated());
        let words =
            ["1", "2"].map(|name| violation_in_words(name, (name == "1").then_some(-0.5), "mm"));
        assert_eq!(words, ["1 by 0.5 mm", "2, which has no value"]);
    }
}

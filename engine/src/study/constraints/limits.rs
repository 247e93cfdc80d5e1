//! Limits of a constraint, and its permitted keys.

use super::super::error::Problems;
use super::super::value::Number;
use super::Reader;
use toml::Spanned;

/// Keys of limits.
pub(super) const LIMITS: [&str; 3] = ["between", "at_least", "at_most"];

/// Lower and upper limit, in the units of the file.
pub(super) type Limits = [Option<f64>; 2];

impl Reader<'_> {
    /// Reads `between`, `at_least` and `at_most`.
    fn limits(&self, problems: &mut Problems) -> Option<Limits> {
        let written = self.written;
        let value = |number: &Option<Number>| number.as_ref().map(|n| n.value);
        let limits = match &written.between {
            None => [value(&written.at_least), value(&written.at_most)],
            Some(between) => {
                let [low, high] = between.get_ref().as_slice() else {
                    let message = format!(
                        "expected two limits [lower, upper], found {}",
                        between.get_ref().len()
                    );
                    return problems.refuse_count(between, 2, message);
                };
                if written.at_least.is_some() || written.at_most.is_some() {
                    let message = "\"between\" gives both limits; expected \"between\" alone, or \"at_least\" and \"at_most\"";
                    return problems.refuse(between.span(), message);
                }
                [Some(low.value), Some(high.value)]
            }
        };
        if let [Some(low), Some(high)] = limits
            && low > high
        {
            let message = format!("the limits are reversed: {low} is above {high}");
            return problems.refuse(self.place.clone(), message);
        }
        Some(limits)
    }

    /// Reads limits, and requires at least one limit.
    pub(super) fn needed_limits(&self, problems: &mut Problems) -> Option<Limits> {
        let limits = self.limits(problems)?;
        if limits == [None, None] {
            let message = "expected a limit: between = [lower, upper], at_least or at_most";
            return problems.refuse(self.place.clone(), message);
        }
        Some(limits)
    }

    /// Refuses the keys of limits and regions that are not in `keys`. Other keys of the constraint are not checked.
    pub(super) fn takes(&self, keys: &[&str], problems: &mut Problems) {
        self.refuse(|key| !keys.contains(&key), problems);
    }

    pub(super) fn refuse(&self, is_refused: impl Fn(&str) -> bool, problems: &mut Problems) {
        let w = self.written;
        let number = |n: &Option<Number>| n.as_ref().map(|n| n.span.clone());
        let given = [
            ("kept", w.kept.as_ref().map(Spanned::span)),
            ("inside", w.inside.as_ref().map(Spanned::span)),
            ("outside", w.outside.as_ref().map(Spanned::span)),
            ("clearance", number(&w.clearance)),
            ("radii", w.radii.as_ref().map(Spanned::span)),
            ("between", w.between.as_ref().map(Spanned::span)),
            ("at_least", number(&w.at_least)),
            ("at_most", number(&w.at_most)),
        ];
        for (key, place) in given {
            if let Some(place) = place.filter(|_| is_refused(key)) {
                let message = format!("{key} has no meaning for this kind of constraint");
                problems.add(place, message);
            }
        }
    }
}

/// Describes limits in words.
pub(super) fn words(limits: Limits) -> String {
    match limits {
        [Some(low), Some(high)] if low == high => format!("equal to {low}"),
        [Some(low), Some(high)] => format!("between {low} and {high}"),
        [Some(low), None] => format!("at least {low}"),
        [None, Some(high)] => format!("at most {high}"),
        [None, None] => String::new(),
    }
}

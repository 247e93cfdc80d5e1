//! Describes a tuning in sentences: headline, remarks and starts.

use super::*;

/// Sentence about constraints that exclude one another, by their names. `None` without such constraints.
pub fn contradiction_in_words(names: &[String]) -> Option<String> {
    match names {
        [] => None,
        [alone] => Some(format!(
            "no design within the ranges satisfies this constraint: {alone}"
        )),
        several => Some(format!(
            "these constraints cannot all be satisfied: {}",
            several.join("; ")
        )),
    }
}

impl TuningSummary {
    /// Remarks on targets and constraints, in sentences.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        for added in &self.added_stations {
            let at: Vec<String> = added.at.iter().map(|at| as_written(*at)).collect();
            remarks.push(format!(
                "{}: the motion has fewer stations than the target curve has points. The curve is also compared at \
                 {}{}",
                added.target,
                at.join(", "),
                if added.unit.is_empty() {
                    String::new()
                } else {
                    format!(" {}", added.unit)
                }
            ));
        }
        for target in &self.unmoved {
            let key = self.unmoved_keys.get(target).map(String::as_str);
            remarks.push(unmoved_in_words(target, key));
        }
        remarks.extend(self.hardly_moved.iter().map(SlightEffectRecord::in_words));
        if let Some(records) = &self.holding {
            let missed = self.missed();
            let hardly = |target: &str| self.hardly_moved.iter().any(|own| own.is_about(target));
            let missed = missed.iter().map(|(_, target, _)| *target);
            let missed = missed
                .filter(|target| !self.unmoved.iter().any(|own| own == target) && !hardly(target));
            remarks.extend(not_held(&missed.collect::<Vec<_>>(), records));
        }
        for constraint in &self.unmoved_constraints {
            remarks.push(unmoved_constraint_in_words(constraint));
        }
        remarks.extend(self.fit_remarks());
        for (first, second, correlation) in self.correlations.iter().take(3) {
            remarks.push(format!(
                "the measurements can hardly distinguish {first} from {second}: correlation \
                 {correlation:.3}"
            ));
        }
        for c in &self.constraints {
            if let Some(price) = c.price {
                remarks.push(price_in_words(&c.name, price, &c.unit));
            }
        }
        remarks.extend(self.without_price_in_words());
        remarks.extend(contradiction_in_words(&self.contradiction));
        remarks.extend(self.least_violation_in_words());
        remarks
    }

    /// Reason why the tuning keeps a start although its design violates constraints, with the violations. Constraints that no
    /// variable affects do not count. `None` without violations.
    fn least_violation_in_words(&self) -> Option<String> {
        let violated = self
            .violated()
            .into_iter()
            .map(|row| &self.constraints[row]);
        let violated: Vec<String> = violated
            .filter(|c| !self.unmoved_constraints.contains(&c.name))
            .map(|c| violation_in_words(&c.name, c.margin, &c.unit))
            .collect();
        least_violation_in_words(self.best_start, &violated)
    }

    /// Explains that binding constraints have no price (decrease of the misfit per unit of the limit). The reason is that the
    /// tuning ended at `good_enough` instead of the smallest misfit. `None` in all other cases.
    fn without_price_in_words(&self) -> Option<String> {
        let is_good_enough = self.misfit_after? <= self.good_enough * (1.0 + 1e-6);
        let has_none = |c: &ConstraintSummary| {
            c.status() == ConstraintStatus::Binds && c.price.is_none() && !c.price_not_determined
        };
        let binds = self.constraints.iter().any(has_none);
        (is_good_enough && binds).then(|| {
            format!(
                "no prices of binding constraints: prices are valid at the smallest misfit only, but this \
                 tuning ended at good_enough = {}. Set good_enough = 0 to get them",
                brief(self.good_enough)
            )
        })
    }

    /// Sentences about the confidence intervals of a fit. Empty for other tunings.
    fn fit_remarks(&self) -> Vec<String> {
        let Some(scatter) = self.scatter else {
            return Vec::new();
        };
        let mut remarks = vec![format!(
            "measurements deviate from the fit by {} of their tolerances (standard deviation). The true move is within the \
             interval \"moved, 95 %\" with 95 % confidence, if the true values are within all ranges. \"not \
             determined\": the true move may be anywhere in its range",
            brief(scatter)
        )];
        if self.variables.iter().any(|v| v.at_bound.is_some()) {
            remarks.push(
                "a variable at its bound has a one-sided interval. The intervals of the other variables allow for all possible \
                 values of this variable"
                    .to_owned(),
            );
        }
        let reaches = |v: &&VariableSummary| {
            let ends = v.fitted.map_or([None; 2], |fitted| fitted.ends());
            v.at_bound.is_none() && (ends[0] == Some(v.range[0]) || ends[1] == Some(v.range[1]))
        };
        let reaching = self.variables.iter().filter(reaches);
        let reaching: Vec<String> = reaching
            .map(|v| format!("{}.{}", v.hardpoint, v.way()))
            .collect();
        if !reaching.is_empty() {
            remarks.push(format!(
                "only the range, not the measurements, limits one end of the interval of {}",
                reaching.join(", ")
            ));
        }
        remarks
    }

    /// Completed fraction of an interrupted tuning, in words.
    pub fn interrupted_in_words(&self) -> String {
        interrupted_in_words(self.interrupted())
    }

    /// Sentences for a page that has no tables of targets and starts: why the search ended, which targets are missed, and which
    /// variables are at the end of their range.
    pub fn outcome_in_words(&self) -> Vec<String> {
        let start = self
            .best_start
            .and_then(|kept| self.starts.iter().find(|s| s.start == kept));
        let ended = start.map(|start| {
            if self.good_enough > 0.0 {
                format!(
                    "{} (good_enough = {} tolerances; 0 requests the smallest misfit)",
                    start.ended,
                    brief(self.good_enough)
                )
            } else {
                start.ended.clone()
            }
        });
        let missed = self.missed().into_iter();
        let missed = missed.map(|(_, output, by)| format!("missed: {output}, by up to {by}"));
        let at_bounds = self.variables.iter().filter_map(|variable| {
            let side = variable.at_bound.as_ref()?;
            let name = format!("{} {}", variable.hardpoint, variable.way());
            Some(format!(
                "{} is at the {side} end of its range",
                name.trim_end()
            ))
        });
        ended.into_iter().chain(missed).chain(at_bounds).collect()
    }

    /// Short summary of the starts, if there are many. `None` if no start could be evaluated.
    pub fn starts_in_words(&self) -> Option<String> {
        let words = starts_in_words(&self.starts, self.best_start, self.misfit_after?)?;
        Some(words + "; history.csv and summary.json have all starts")
    }

    /// Meaning of the columns in the table of the targets.
    pub fn deviations_in_words(&self) -> String {
        let builds = self.over_builds(" over");
        let values = if builds.is_empty() {
            "values at the stations of the target"
        } else {
            "values of the nominal design"
        };
        format!(
            "before, after: {values}; off: largest deviation from the target{builds}; all in the unit of the target"
        )
    }

    /// Result of the tuning in one or two sentences.
    pub fn headline(&self) -> String {
        let kept = match self.violated().len() {
            0 => String::new(),
            1 => "; a constraint is violated".to_owned(),
            several => format!("; {several} constraints are violated"),
        };
        let of_builds = self.over_builds(", root mean square of");
        match (self.misfit_before, self.misfit_after) {
            (Some(before), Some(after)) => {
                let effects = side_effects_in_words(&self.side_effects);
                let effects = effects.map_or(String::new(), |words| format!("; {words}"));
                format!(
                    "misfit {} -> {} tolerances{of_builds}{kept}{effects}",
                    misfit_in_words(before),
                    misfit_in_words(after)
                )
            }
            (None, Some(after)) => format!(
                "misfit {} tolerances{of_builds}{kept}; the misfit of the given design is not known: {}",
                misfit_in_words(after),
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

    /// Guaranteed property of the moves in [`TuningSummary::unseen`], as the end of a sentence.
    pub fn unseen_guarantee(&self) -> String {
        let constraints = if self.constraints.is_empty() {
            ""
        } else {
            " and keep the constraints"
        };
        format!(
            "raise the misfit by at most {}{constraints}",
            Direction::RISE
        )
    }

    /// Moves that hardly change the misfit and keep the constraints, in words. Variables that move by less than a thousandth of
    /// their range are left out.
    pub fn unseen(&self) -> Vec<String> {
        let describe = |change: &Vec<f64>| {
            let parts = change
                .iter()
                .zip(&self.variables)
                .filter(|(c, v)| c.abs() > 1e-3 * (v.range[1] - v.range[0]));
            let parts: Vec<String> = parts
                .map(|(c, v)| {
                    let name = format!("{}.{}", v.hardpoint, v.way());
                    match v.unit.as_str() {
                        "factor" => format!("{name} x {}", brief(c.exp())),
                        "" => format!("{name} {c:+.3}"),
                        "m" => format!("{name} {c:+.6} m"),
                        unit if c.abs() < 1000.0 => format!("{name} {c:+.3} {unit}"),
                        unit => format!("{name} {c:+.0} {unit}"),
                    }
                })
                .collect();
            parts.join(", ")
        };
        self.unseen.iter().map(describe).collect()
    }
}

/// Completed fraction of an interrupted tuning, in words. The arguments are the number of interrupted starts and the number of all
/// starts.
pub fn interrupted_in_words([interrupted, all]: [usize; 2]) -> String {
    let starts = counted(all, "start");
    match interrupted {
        0 => format!("interrupted: {starts} done, later computations may be missing"),
        some => format!("interrupted: {} of {starts} done", all - some),
    }
}

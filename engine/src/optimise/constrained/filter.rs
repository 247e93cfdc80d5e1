//! Filter for steps: earlier pairs of goal (half the squared norm of the goal's residuals) and violation (largest violation
//! of the constraints). A step must improve on each of them.

/// Pairs of goal and violation of earlier points.
#[derive(Clone, Debug)]
pub(super) struct Filter {
    passed: Vec<[f64; 2]>,
    /// Largest violation that is accepted, whatever the goal.
    most: f64,
}

/// Share of the stored violation by which a pair must be better than each stored pair.
const MARGIN: f64 = 1e-5;

impl Filter {
    /// Makes an empty filter. The largest accepted violation is 100 max(`violation`, 1) or `violation` + `most`, whichever is
    /// smaller. `violation` is the violation at the start.
    pub(super) fn new(violation: f64, most: f64) -> Self {
        Filter {
            passed: Vec::new(),
            most: (100.0 * violation.max(1.0)).min(violation + most),
        }
    }

    /// Returns true if a pair is better than every stored pair, either in its goal or in its violation. A pair with zero
    /// violation is always accepted.
    pub(super) fn accepts(&self, goal: f64, violation: f64) -> bool {
        let better = |[passed_goal, passed_violation]: &[f64; 2]| {
            violation <= (1.0 - MARGIN) * passed_violation
                || goal <= passed_goal - MARGIN * violation
        };
        violation <= self.most && self.passed.iter().all(better)
    }

    /// Stores a pair. Removes the stored pairs that are not better in goal or violation than this pair.
    pub(super) fn pass(&mut self, goal: f64, violation: f64) {
        self.passed.retain(|[g, v]| *g < goal || *v < violation);
        self.passed.push([goal, violation]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_must_be_better_than_each_passed_in_one_of_the_two() {
        let mut filter = Filter::new(1.0, f64::INFINITY);
        filter.pass(10.0, 1.0);
        filter.pass(20.0, 0.1);
        assert!(filter.accepts(15.0, 0.5));
        assert!(filter.accepts(9.0, 50.0));
        assert!(filter.accepts(1e9, 0.01));
        assert!(!filter.accepts(15.0, 2.0));
        assert!(!filter.accepts(20.0, 0.1));
        assert!(!filter.accepts(0.0, 101.0));
        assert!(!Filter::new(0.0, 0.1).accepts(0.0, 0.2));
    }
}

//! Constraints that cannot be satisfied together.

use super::constrained::constrained_fit;
use super::multistart::fits;
use super::starts::STARTS_BEFORE_REFUSAL;
use super::{Bounds, Constrained, Control, Held, Multistart, Options, Termination};

/// Finds constraints that cannot be satisfied together, and of which none can be left out. The function starts with all
/// constraints that the runs of the tuning report as contradictory. If these can be satisfied, it starts with all constraints,
/// but with at most 12. It removes a constraint if the other constraints still cannot be satisfied.
///
/// `of_rows` gives the constraint of each row, `count` is the number of constraints. `can_be_kept` returns true if a run with
/// only these constraints satisfies them. The result is empty if no such set is found.
pub(crate) fn smallest_conflict(
    starts: &Multistart,
    of_rows: &[usize],
    count: usize,
    can_be_kept: impl Fn(&[usize]) -> bool,
) -> Vec<usize> {
    let mut blamed: Vec<usize> = Vec::new();
    for state in fits(&starts.starts).filter_map(|(_, fit)| fit.constraints.as_ref()) {
        for culprit in &state.culprits {
            if let Held::Row(row) = culprit {
                blamed.push(of_rows[*row]);
            }
        }
    }
    blamed.sort_unstable();
    blamed.dedup();
    if blamed.is_empty() || can_be_kept(&blamed) {
        // No constraint is reported, or the reported constraints alone can be satisfied. So others take part in the conflict.
        blamed = (0..count).collect();
        if blamed.len() > 12 || can_be_kept(&blamed) {
            return Vec::new();
        }
    }
    for candidate in blamed.clone() {
        let rest: Vec<usize> = blamed.iter().copied().filter(|c| *c != candidate).collect();
        if !rest.is_empty() && !can_be_kept(&rest) {
            blamed = rest;
        }
    }
    blamed
}

/// Returns true if one of the first [`STARTS_BEFORE_REFUSAL`] starts leads to a point that satisfies all constraints of
/// this problem. Also returns true if a run is interrupted.
pub(crate) fn is_satisfied_from<P: Constrained>(
    starts: &Multistart,
    bounds: &Bounds,
    control: Control<'_>,
    problem: impl Fn() -> P,
) -> bool {
    let control = Control {
        watch: None,
        ..control
    };
    starts
        .starts
        .iter()
        .take(STARTS_BEFORE_REFUSAL)
        .any(|start| {
            let options = Options::default();
            let fit = constrained_fit(0, problem(), bounds, &start.x, &options, control);
            // An interrupted run does not show that the constraints conflict, so it counts as satisfied.
            fit.is_ok_and(|fit| fit.is_feasible() || fit.termination == Termination::Interrupted)
        })
}

//! Tests of minima under degenerate constraints against the crate `slsqp`.

use super::{Kind, Mix};
use crate::tuning::minima::{Random, slsqp};
use nalgebra::DVector;

/// Compares misfits of this program with misfits of the crate `slsqp` from the same design. Each case has constraints
/// that no variable affects, or dependent constraints. This program may end with a higher misfit only if `slsqp` ends
/// in another minimum. Then this program, started from that minimum, stays there.
fn against_slsqp(seed: u64, numbers: std::ops::Range<u64>) {
    let (mut compared, mut others) = (0, 0);
    for number in numbers {
        let mix = Mix::new(seed, number, Kind::Degenerate);
        let tuning = mix.tuned(0.0);
        let ours = tuning.starts.best_fit().unwrap();
        let random = Random::of(mix.study);
        let theirs = slsqp(&random, &DVector::zeros(random.bounds.variables()));
        if !theirs.is_feasible() {
            continue;
        }
        compared += 1;
        assert!(ours.is_feasible(), "{number}: {}", ours.ended());
        let misfit = ours.misfit();
        if misfit > theirs.misfit * (1.0 + 1e-6) + 1e-9 {
            others += 1;
            let again = random.ours(&theirs.x);
            println!(
                "{number}: {misfit} above {}, {}",
                theirs.misfit,
                ours.ended()
            );
            assert!(
                ours.residual.is_some_and(|r| r < 1e-6),
                "{number}: {:?}",
                ours.residual
            );
            assert!(
                again.at.goal.misfit() <= theirs.misfit * (1.0 + 1e-6),
                "{number}"
            );
        }
    }
    println!("{compared} compared, {others} other minima");
    assert!(compared > 0);
}

/// In forty cases of seed 5, no misfit of this program is above the misfit of `slsqp`, unless `slsqp` ends in another minimum.
#[test]
fn no_misfit_is_above_that_of_slsqp() {
    against_slsqp(5, 0..40);
}

//! Tests that random tunings end, and that tunings with feasible constraints converge.

use super::{Kind, Mix};
use hardpoint::optimise::Fit;

/// Outcomes of many mixes.
#[derive(Default)]
struct Tally {
    evaluations: Vec<u64>,
    feasible: usize,
    converged: usize,
    failed: Vec<String>,
}

/// Tunes mixes, and counts how the tunings end.
fn tally(seed: u64, numbers: std::ops::Range<u64>) -> Tally {
    let mut tally = Tally::default();
    let out = std::env::var("HARDPOINT_MIXES").ok();
    let mut lines = String::new();
    for number in numbers {
        let mix = Mix::new(seed, number, Kind::Any);
        let good_enough = [0.0, 0.0, 0.1, 0.0, 1.0][number as usize % 5];
        let tuning = mix.tuned(good_enough);
        let Some(fit) = tuning.starts.best_fit() else {
            panic!("{number}: {:?}", tuning.starts.starts[0].outcome);
        };
        let most = tuning.starts.starts.iter();
        let most = most.filter_map(|s| s.outcome.as_ref().ok().map(Fit::evaluations));
        tally.evaluations.push(most.max().unwrap());
        let is_feasible = fit.is_feasible();
        let converged = fit.termination.at_minimum() && fit.residual.is_some_and(|r| r < 1e-6);
        let is_met = fit.termination.at_minimum() && fit.misfit() < 1e-11;
        if is_feasible {
            tally.feasible += 1;
            if converged || is_met {
                tally.converged += 1;
            } else {
                tally.failed.push(format!(
                    "{number} {} {:?}: {} evaluations, {}",
                    mix.file,
                    mix.kinds,
                    fit.evaluations(),
                    fit.ended()
                ));
            }
        }
        lines += &format!(
            "{number}\t{}\t{good_enough}\t{}\t{:e}\t{}\t{:?}\t{}\t{}\n",
            mix.file,
            is_feasible,
            fit.misfit(),
            fit.evaluations(),
            fit.residual,
            fit.ended(),
            mix.overrides.join("\u{1}")
        );
    }
    if let Some(path) = out {
        std::fs::write(path, lines).unwrap();
    }
    tally.evaluations.sort_unstable();
    tally
}

fn check(tally: &Tally, least_share: f64) {
    let median = tally.evaluations[tally.evaluations.len() / 2].max(1);
    let most = *tally.evaluations.last().unwrap();
    println!(
        "{} mixes: median {median} evaluations, most {most}; {} feasible, {} converged",
        tally.evaluations.len(),
        tally.feasible,
        tally.converged
    );
    for line in &tally.failed {
        println!("  {line}");
    }
    // Ninety-nine of a hundred runs need at most twenty times the median number of evaluations. In the other runs the
    // smallest change is hard to find: the search repeats with other misfit levels until it uses up its budget. The
    // budget is 0.1 of `max_evaluations`, and 8 of a thousand runs were so long. With a budget of 0.04 only 5 were so
    // long, but 3 more runs ended without a known smallest change.
    let many = tally
        .evaluations
        .iter()
        .filter(|e| **e > 20 * median)
        .count();
    println!("{many} took more than 20 times the median");
    assert!(many * 100 <= tally.evaluations.len(), "{many}");
    assert!(most <= 50 * median, "{most} evaluations, median {median}");
    // 642 of a thousand mixes could be satisfied.
    assert!(4 * tally.feasible >= tally.evaluations.len());
    assert!(tally.converged as f64 >= least_share * tally.feasible as f64);
}

/// Forty mixes of seed 1 all end. Mixes that can be satisfied converge.
#[test]
fn mixes_end_and_converge() {
    if !crate::support::has_lanes() {
        return;
    }
    check(&tally(1, 0..40), 0.97);
}

/// A thousand mixes of seed 2 all end. Mixes that can be satisfied converge.
#[test]
#[ignore = "takes minutes; .ci/long"]
fn a_thousand_mixes_end_and_converge() {
    check(&tally(2, 0..1000), 0.97);
}

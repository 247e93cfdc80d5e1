//! Tests of the optimality conditions at constrained minima, and of limits between stations.

use super::*;

/// Numbers of evaluations of a problem. `ours` counts all evaluations of this program. `other` has two counts of the
/// other method: until it reaches six digits of the ranges, and in total.
struct Evaluations {
    ours: u64,
    other: Option<[u64; 2]>,
}

/// Results of the solved problems.
#[derive(Default)]
struct Course {
    kept: usize,
    balanced: usize,
    refused: usize,
    /// Numbers of evaluations, one entry for each problem.
    evaluations: Vec<Evaluations>,
}

impl Course {
    /// Solves the problems with these numbers. If `others` is true, also solves them with the crate `slsqp`.
    fn of(numbers: std::ops::Range<u64>, problem: fn(u64) -> Random, others: bool) -> Self {
        let mut course = Course::default();
        for number in numbers {
            let random = problem(number);
            let start = random
                .bounds
                .nearest(&DVector::zeros(random.bounds.variables()));
            let ours = random.ours(&start);
            if ours.violation > KEPT {
                course.refused += 1;
                println!(
                    "{number}: cannot be kept: {:.1e} {}",
                    ours.violation, ours.termination
                );
                continue;
            }
            course.kept += 1;
            let is_balanced = ours.imbalance < 1e-6;
            course.balanced += usize::from(is_balanced);
            if !is_balanced {
                println!(
                    "{number}: {:.1e} {} {}",
                    ours.imbalance,
                    ours.evaluations(),
                    ours.termination
                );
            }
            let other = others.then(|| slsqp(&random, &start));
            let other = other.filter(End::is_feasible);
            course.evaluations.push(Evaluations {
                ours: ours.evaluations(),
                other: other.map(|end| [end.evaluations_to(1e-6), end.away.len() as u64]),
            });
        }
        course
    }

    /// Median numbers of evaluations: of this program, of the other method to six digits, and of the other method in
    /// total. Counts only problems that both methods solved within the constraints.
    fn medians(&self) -> [u64; 3] {
        let both = self.evaluations.iter();
        let both: Vec<[u64; 3]> = both
            .filter_map(|e| e.other.map(|[near, all]| [e.ours, near, all]))
            .collect();
        std::array::from_fn(|k| {
            let mut counts: Vec<u64> = both.iter().map(|counts| counts[k]).collect();
            counts.sort_unstable();
            counts[counts.len() / 2]
        })
    }

    /// Prints the results.
    fn say(&self) {
        let mut ours: Vec<u64> = self.evaluations.iter().map(|e| e.ours).collect();
        ours.sort_unstable();
        println!(
            "{} kept, {} balanced, {} cannot be kept; evaluations median {}, 95 % {}, most {}",
            self.kept,
            self.balanced,
            self.refused,
            ours[ours.len() / 2],
            ours[ours.len() * 95 / 100],
            ours[ours.len() - 1]
        );
    }
}

/// A design that satisfies the constraints at nine stations, and at the extremes between them, satisfies them
/// everywhere. Some limits are active at two positions at once. Others are active within the first or last interval.
#[test]
fn nothing_is_violated_between_stations() {
    let mut between = 0;
    for number in [13, 25, 40, 42, 50, 65, 71, 77] {
        let with = |stations: i32| {
            let mut study = Random::new(number).study;
            let step = 120.0 / f64::from(stations - 1);
            let values = (0..stations).map(|k| -60.0 + step * f64::from(k));
            study.one_wheel_mut().unwrap().motion.values = values.collect();
            Random::of(study)
        };
        let (coarse, fine) = (with(9), with(961));
        let ours = coarse.ours(&DVector::zeros(coarse.bounds.variables()));
        assert!(ours.violation <= KEPT, "{number}: {}", ours.termination);
        let at = fine.assessed(&ours.x);
        let violation = at.violation(0, &[]);
        assert!(violation < 1e-6, "{number}: {violation:e}");
        // Counts limits that are active only between the nine stations.
        let rows = fine.layout.labels().iter().zip(at.rows.residuals.iter());
        let reached = |row: usize| ours.multipliers[row] > 0.0;
        let labels = coarse.layout.labels();
        let held: Vec<_> = (0..labels.len())
            .filter(|row| reached(*row))
            .map(|r| labels[r])
            .collect();
        let same = |l: &hardpoint::optimise::RowLabel| {
            held.iter()
                .any(|h| h.part == l.part && h.is_upper == l.is_upper)
        };
        let mut most = std::collections::BTreeMap::<(usize, bool), f64>::new();
        for (label, value) in rows.filter(|(label, _)| same(label)) {
            if label.station.is_multiple_of(120) {
                let most = most
                    .entry((label.part, label.is_upper))
                    .or_insert(f64::NEG_INFINITY);
                *most = larger(*most, *value);
            }
        }
        between += most.values().filter(|most| **most < -1e-4).count();
    }
    assert!(between >= 6, "{between}");
}

/// If the constraints can be satisfied, the optimality conditions hold to a millionth: the multipliers balance the
/// gradient.
#[test]
fn multipliers_balance() {
    for problem in [Random::new, Random::of_design] {
        let course = Course::of(0..8, problem, false);
        let Course { kept, balanced, .. } = course;
        assert!(kept >= 7 && balanced == kept, "{kept} {balanced}");
    }
}

/// Prints the time of tuning six hundred random designs, in milliseconds. Prints separately: one start to the smallest
/// misfit, and the search back towards the nominal design.
#[test]
#[ignore = "six hundred designs, to be timed"]
fn times_of_six_hundred_designs() {
    let mut times = [Vec::new(), Vec::new()];
    for number in 0..600 {
        let Random { mut study, .. } = Random::of_design(number);
        let optimise = study.optimise.as_mut().unwrap();
        optimise.starts = 1;
        optimise.good_enough = 0.0;
        let least = std::time::Instant::now();
        let tuning = study.tune(Control::default()).unwrap();
        let least = least.elapsed().as_secs_f64();
        if !tuning
            .starts
            .best_fit()
            .is_some_and(|fit| fit.is_feasible())
        {
            continue;
        }
        study.optimise.as_mut().unwrap().good_enough = 0.1;
        let nearest = std::time::Instant::now();
        study.tune(Control::default()).unwrap();
        let nearest = nearest.elapsed().as_secs_f64();
        times[0].push(1e3 * least);
        times[1].push(1e3 * (nearest - least).max(0.0));
    }
    for (what, mut times) in ["a start", "the way back"].into_iter().zip(times) {
        times.sort_by(f64::total_cmp);
        let [median, most] = [2, 20].map(|part| times[times.len() - 1 - times.len() / part]);
        println!(
            "{} designs, {what}: median {median:.2} ms, 95 % {most:.2} ms",
            times.len()
        );
    }
}

/// For at least 99 % of six hundred random designs, the multipliers balance the gradient to a millionth. The median
/// number of evaluations is at most a fifth of the median number of `slsqp`.
#[test]
#[ignore = "six hundred problems by two methods"]
fn multipliers_of_six_hundred_designs_balance() {
    let course = Course::of(0..600, Random::of_design, true);
    course.say();
    let ended = course.evaluations.iter().filter(|e| e.other.is_some());
    let ended = ended.count();
    let [ours, near, all] = course.medians();
    println!("slsqp kept {ended}: {near} evaluations to six digits, {all} in all; ours {ours}");
    assert!(course.kept >= 590 && course.balanced * 100 >= course.kept * 99);
    assert!(ended >= 500 && 5 * ours <= all, "{ours} {near} {all}");
}

/// For at least 99 % of six hundred problems of two to twelve variables, the multipliers balance the gradient to a
/// millionth.
#[test]
#[ignore = "six hundred problems"]
fn multipliers_of_six_hundred_problems_balance() {
    let course = Course::of(0..600, Random::new, false);
    course.say();
    assert!(course.kept >= 590 && course.balanced * 100 >= course.kept * 99);
}

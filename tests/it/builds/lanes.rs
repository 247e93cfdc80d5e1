//! Tests of builds in SIMD lanes (several builds at once) against builds one by one.

use super::study;
use hardpoint::assembly::Member;
use hardpoint::evaluate::BLOCK;
use hardpoint::number::Width;
use hardpoint::study::Study;
use hardpoint::tolerance::{MonteCarlo, Problem, Spread, monte_carlo_in};
use std::ops::ControlFlow;

/// Studies of several topologies, with the parts that adjust toe and camber. Some have a rocker and an anti-roll bar.
const STUDIES: [(&str, &str); 5] = [
    (
        "macpherson_solve",
        "{length=\"tie_rod\"},{shim=\"strut_top\",axis=\"y\"}",
    ),
    (
        "double_wishbone_solve",
        "{length=\"tie_rod\"},{shim=\"upper_ball_joint\",axis=\"y\"}",
    ),
    (
        "double_wishbone_rocker",
        "{length=\"tie_rod\"},{shim=\"upper_arm_front\",axis=\"y\"},{shim=\"upper_arm_rear\",axis=\"y\"}",
    ),
    (
        "five_link_solve",
        "{length=\"toe_link\"},{length=\"upper_rear_link\"}",
    ),
    (
        "semi_trailing_arm_solve",
        "{shim=\"arm_pivot_outer\",axis=\"x\"},{shim=\"arm_pivot_outer\",axis=\"z\"}",
    ),
];

/// Every coordinate of every hardpoint scatters by up to 2 mm, and so does the length of every member.
fn everything_scattered(name: &str, adjust: &str, aligned: bool, builds: usize) -> Study {
    let plain = study(name, &[]);
    let mechanism = &plain.wheel().mechanism;
    let points = mechanism.points.iter().map(|p| format!("{:?}", p.name));
    let points = points.collect::<Vec<_>>().join(",");
    let mut scatter = format!("{{hardpoints=[{points}],limits=[-2.0,2.0]}}");
    for (length, _) in Member::all(mechanism) {
        scatter += &format!(",{{length={length:?},sigma=0.7}}");
    }
    study(
        name,
        &[
            "motion.travel=[-20.0,0.0,15.0]",
            "outputs.characteristics=[\"camber\",\"toe\",\"camber_gain\"]",
            &format!("setup.adjust=[{adjust}]"),
            &format!("tolerance.builds={builds}"),
            "tolerance.seed=5",
            &format!("tolerance.aligned={aligned}"),
            &format!("tolerance.scatter=[{scatter}]"),
            "tolerance.bands=[]",
        ],
    )
}

/// Results of all builds, in SIMD lanes of this width or one by one.
fn results(problem: &Problem<'_>, width: Option<Width>) -> MonteCarlo {
    let drawn = problem.drawn().unwrap();
    monte_carlo_in(width, problem, &drawn, |_| ControlFlow::Continue(())).unwrap()
}

/// Smallest value, percentiles and largest value of a result. With few builds these are values of single builds.
fn values(spread: &Spread) -> impl Iterator<Item = f64> {
    spread.range.into_iter().chain(spread.percentiles)
}

/// Builds that are sampled, assembled and solved in SIMD lanes have the same values as builds that are evaluated one
/// by one. The test covers several topologies, with and without alignment. The results have the same bits at any lane
/// width.
#[test]
fn builds_in_lanes_are_those_one_by_one() {
    if !crate::support::has_lanes() {
        return;
    }
    for (name, adjust) in STUDIES {
        for aligned in [false, true] {
            let study = everything_scattered(name, adjust, aligned, BLOCK);
            let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
            assert_eq!(problem.not_in_lanes(), None, "{name}");
            let size = study.wheel().size();
            let single = results(&problem, None);
            let mut first: Option<MonteCarlo> = None;
            for width in Width::available() {
                let lanes = results(&problem, Some(width));
                assert_eq!(lanes.rejects, single.rejects);
                assert_eq!(lanes.incomplete, single.incomplete);
                for (a, b) in lanes.spreads.iter().zip(&single.spreads) {
                    assert_eq!(a.count, b.count);
                    for (a, b) in values(a).zip(values(b)) {
                        assert!((a - b).abs() < 1e-12 * size, "{name} {aligned}: {a} {b}");
                    }
                }
                let before = first.get_or_insert(lanes.clone());
                assert_eq!(before.spreads, lanes.spreads, "{name} {aligned} {width:?}");
            }
        }
    }
}

/// A build does not depend on its neighbours in the SIMD lanes. So the results of a run with two builds also occur in
/// a run with a third build.
#[test]
fn builds_in_lanes_do_not_depend_on_their_neighbours() {
    for (name, adjust) in STUDIES {
        let of_builds = |builds: usize| {
            let study = everything_scattered(name, adjust, false, builds);
            let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
            results(&problem, Width::widest())
        };
        let (two, three) = (of_builds(2), of_builds(3));
        for (two, three) in two.spreads.iter().zip(&three.spreads) {
            let is_there = |value: &f64| values(three).any(|other| other == *value);
            assert!(two.range.iter().all(is_there), "{name}: {two:?} {three:?}");
        }
    }
}

/// Builds far from the nominal design, of which many cannot be assembled. The evaluations in SIMD lanes and one by one
/// reject the same builds.
#[test]
fn builds_that_lanes_refuse_go_one_by_one() {
    for aligned in [false, true] {
        let study = study(
            "macpherson_tolerance",
            &[
                "motion.travel=[0.0,20.0]",
                "tolerance.builds=128",
                &format!("tolerance.aligned={aligned}"),
                "tolerance.scatter=[{length=\"tie_rod\",sigma=60.0},{length=\"lower_arm_front\",sigma=40.0}]",
                "tolerance.bands=[]",
            ],
        );
        let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
        let expected = results(&problem, None);
        let found = results(&problem, Width::widest());
        assert!(found.rejected() > 0 && found.rejected() < 120);
        let count = |results: &MonteCarlo| {
            let each = results.rejects.iter();
            let each = each.map(|(word, rejected)| (*word, rejected.builds, rejected.first));
            each.collect::<Vec<_>>()
        };
        assert_eq!(count(&found), count(&expected));
        assert_eq!(found.incomplete, expected.incomplete);
        for (a, b) in found.spreads.iter().zip(&expected.spreads) {
            assert_eq!(a.count, b.count);
            for (a, b) in values(a).zip(values(b)) {
                assert!((a - b).abs() <= 1e-9 * (1.0 + b.abs()), "{a} {b}");
            }
        }
    }
}

//! Tests of tolerance analyses: first-order standard deviations, builds, yields.

use super::{assembler, parameter, plan, study};
use hardpoint::assembly::{Rest, built_curves};
use hardpoint::report::BandCurve;
use hardpoint::solved::Solved;
use hardpoint::study::Study;
use hardpoint::tolerance::{Estimate, Expansion, MonteCarlo, Problem, monte_carlo, rank};

fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.unwrap().install(run)
}

fn problem(study: &Study) -> Problem<'_> {
    Problem::of(study, study.tolerance.as_ref().unwrap()).unwrap()
}

fn built(problem: &Problem) -> (Vec<f64>, Expansion, MonteCarlo) {
    let drawn = problem.drawn().unwrap();
    let expansion = Expansion::of(problem).unwrap();
    let builds = monte_carlo(problem, &drawn, on).unwrap();
    (drawn, expansion, builds)
}

/// If a first-order result is marked as valid, its standard deviation equals the standard deviation of the builds. The
/// difference is at most 2 % plus four standard errors.
#[test]
fn first_order_is_the_monte_carlo_where_it_says_so() {
    for (name, travel) in [
        (
            "double_wishbone_tolerance",
            "motion.travel=[-30.0,0.0,30.0]",
        ),
        ("macpherson_tolerance", "motion.travel=[-60.0,0.0,60.0]"),
    ] {
        let study = study(
            name,
            &["tolerance.builds=3000", travel, "tolerance.aligned=false"],
        );
        let problem = problem(&study);
        let (drawn, expansion, builds) = built(&problem);
        let mut looked_at = 0;
        for (cell, spread) in builds.spreads.iter().enumerate() {
            let linear = expansion.variance[cell].sqrt();
            assert!(spread.count == 3000 && spread.mean != drawn[cell]);
            if expansion.holds(cell) == Some(true) {
                let off = (spread.sigma - linear).abs();
                assert!(
                    off < 0.02 * linear + 4.0 * spread.sigma_error,
                    "{name} {cell}: {spread:?} {linear}"
                );
                let [shift, _] = expansion.second[cell];
                let mean = spread.mean - drawn[cell] - shift - expansion.shift[cell];
                let error = spread.sigma / (spread.count as f64).sqrt();
                assert!(mean.abs() < 4.5 * error, "{name} {cell}: {mean} {error}");
                looked_at += 1;
            }
            let shares: f64 = (0..problem.tolerance.scatter.len())
                .map(|c| expansion.part(&problem, cell, c))
                .sum();
            assert!((shares / expansion.variance[cell] - 1.0).abs() < 1e-12);
            // Percentiles of a nearly normal distribution.
            let [_, _, low, middle, high, ..] = spread.percentiles;
            assert!(low < middle && middle < high);
            let width = (high - low) / (2.0 * 1.6449 * spread.sigma);
            assert!((width - 1.0).abs() < 0.06, "{name} {cell}: {width}");
        }
        assert!(looked_at >= 6);
    }
}

/// The second-order contribution is half the second derivative times the variance, from finite differences of fourth
/// order. This contribution shows where the first-order result is not valid.
#[test]
fn second_order_tells_where_the_linear_answer_does_not_hold() {
    let study = study(
        "macpherson_tolerance",
        &[
            "tolerance.aligned=false",
            "motion.travel=[0.0, 20.0]",
            "tolerance.bands=[]",
            "tolerance.scatter=[{length=\"tie_rod\",sigma=12.0}]",
            "outputs.characteristics=[\"camber\",\"toe\"]",
        ],
    );
    let problem = problem(&study);
    let expansion = Expansion::of(&problem).unwrap();
    let assembler = assembler(&study);
    let length = parameter(&assembler, "tie_rod", None);
    let h = 2.0;
    let curves = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|step| {
        let mut parts = assembler.drawn().clone();
        parts.change(&assembler.suspension().mechanism, length, step * h);
        let built = assembler.build(&parts, Rest::Height(0.0)).unwrap();
        built_curves(&assembler, &built, &plan(&study), &[])
            .unwrap()
            .curves
    });
    for output in 0..2 {
        for station in 0..2 {
            let value = |k: usize| {
                curves[k].stations[station].values[output]
                    .unwrap()
                    .to_radians()
            };
            let bend = (16.0 * (value(1) + value(3)) - value(0) - value(4) - 30.0 * value(2))
                / (12.0 * h * h);
            let [shift, growth] = expansion.second[problem.cell(output, station)];
            let expected = 0.5 * bend * 144.0;
            assert!(
                (shift - expected).abs() < 1e-3 * expected.abs(),
                "{shift} {expected}"
            );
            // For a single, normally distributed tolerance, the variance grows by twice the square of the shift of the
            // mean.
            assert!((growth - 2.0 * shift * shift).abs() < 1e-12 * growth);
        }
    }
    assert_eq!(expansion.holds(problem.cell(0, 0)), Some(false));
}

/// With wide tolerances, curvature and interaction matter. Then the first-order shares of the builds' variance and the
/// second-order remainder sum to 1 within the standard error. The shares alone do not sum to 1.
#[test]
fn shares_and_their_remainder_make_one() {
    let study = study(
        "macpherson_tolerance",
        &[
            "tolerance.builds=40000",
            "tolerance.aligned=false",
            "motion.travel=[0.0]",
            "tolerance.bands=[]",
            "tolerance.scatter=[{length=\"tie_rod\",sigma=15.0},{length=\"lower_arm_front\",sigma=8.0},\
             {length=\"lower_arm_rear\",sigma=8.0}]",
            "outputs.characteristics=[\"camber\",\"toe\",\"caster\"]",
        ],
    );
    let problem = problem(&study);
    let (_, expansion, builds) = built(&problem);
    let mut needed = 0;
    for (cell, spread) in builds.spreads.iter().enumerate() {
        let variance = spread.sigma * spread.sigma;
        let shares = (0..problem.tolerance.scatter.len())
            .map(|c| expansion.part(&problem, cell, c) / variance);
        let shares: f64 = shares.sum();
        let left = expansion.remainder(cell, spread);
        assert!((shares + left.part - 1.0).abs() < 1e-12);
        // The third-order remainder is about the square of the second-order remainder.
        let most = 4.0 * left.error + 2.0 * left.second * left.second;
        assert!(
            (shares + left.second - 1.0).abs() < most,
            "{cell}: {shares} {left:?}"
        );
        needed += usize::from((shares - 1.0).abs() > most);
    }
    assert!(needed > 0);
}

/// Aligned builds have the nominal toe and camber at rest, up to rounding errors. In other positions, the first-order
/// scatter equals that of the builds.
#[test]
fn aligned_builds_have_the_drawn_toe_and_camber() {
    let study = study(
        "macpherson_tolerance",
        &["tolerance.builds=2000", "motion.travel=[-60.0,0.0,60.0]"],
    );
    let problem = problem(&study);
    let (_, expansion, builds) = built(&problem);
    for output in 0..2 {
        let at_rest = problem.cell(output, problem.stations().design());
        assert!(builds.spreads[at_rest].sigma < 1e-13);
        assert!(expansion.variance[at_rest].sqrt() < 1e-13);
        for station in 0..problem.stations().count() {
            let cell = problem.cell(output, station);
            let (linear, spread) = (expansion.variance[cell].sqrt(), &builds.spreads[cell]);
            if station != problem.stations().design() {
                let off = (spread.sigma - linear).abs();
                assert!(off < 0.02 * linear + 4.0 * spread.sigma_error);
            }
        }
    }
    assert_eq!(builds.rejected(), 0);
}

/// Two of the given tolerances dominate the yield. The ranking puts them first. Halving either one raises the yield as
/// predicted.
#[test]
fn the_tolerances_that_cost_the_yield_are_named_first() {
    let scatter = |tie_rod: f64, leg: f64| {
        format!(
            "tolerance.scatter=[{{hardpoints=[\"lower_arm_front\",\"lower_arm_rear\",\"upper_arm_rear\"],sigma=0.01}},\
             {{length=\"tie_rod\",sigma={tie_rod}}},{{length=\"upper_arm_rear\",sigma=0.01}},\
             {{length=\"upper_arm_front\",sigma={leg}}}]"
        )
    };
    let run = |tie_rod: f64, leg: f64| {
        let study = study(
            "double_wishbone_tolerance",
            &[
                "tolerance.builds=4000",
                "motion.travel=[0.0]",
                &scatter(tie_rod, leg),
                "tolerance.bands=[{characteristic=\"toe\",at=0.0,between=[-0.25,0.25]},\
                 {characteristic=\"camber\",at=0.0,between=[-2.1,-1.9]}]",
            ],
        );
        let problem = problem(&study);
        let (drawn, expansion, builds) = built(&problem);
        rank(&problem, &expansion, &builds, &drawn).unwrap()
    };
    let yields = run(0.3, 0.8);
    let before = yields.all.monte_carlo;
    let first: Vec<usize> = yields.ranking[..2].iter().map(|r| r.contributor).collect();
    // Contributor 3 is the tie rod and contributor 5 the front leg. Contributors 0 to 2 are the three hardpoints.
    assert!(
        first.contains(&3) && first.contains(&5),
        "{:?}",
        yields.ranking
    );
    for ranking in &yields.ranking[..2] {
        let after = match ranking.contributor {
            3 => run(0.15, 0.8),
            _ => run(0.3, 0.4),
        };
        let lifted = after.all.monte_carlo;
        assert!(lifted > before + 0.02);
        assert!(
            (lifted - ranking.halved).abs() < 0.015,
            "{lifted} {ranking:?} {before}"
        );
    }
    // The ranking marks the tolerance of a point with a negligible contribution as one that can be relaxed.
    let loose = yields.ranking.iter().filter(|r| r.may_be_looser).count();
    assert!(loose >= 1, "{:?}", yields.ranking);
}

/// Results have the same bits with any number of CPU threads, also if some builds cannot be assembled.
#[test]
fn results_are_the_same_on_any_number_of_threads() {
    let study = study(
        "macpherson_tolerance",
        &[
            "tolerance.builds=1500",
            "tolerance.aligned=false",
            "motion.travel=[0.0,20.0]",
            "tolerance.scatter=[{length=\"tie_rod\",sigma=60.0}]",
            "tolerance.bands=[]",
        ],
    );
    let problem = problem(&study);
    let drawn = problem.drawn().unwrap();
    let one = on_threads(1, || monte_carlo(&problem, &drawn, on).unwrap());
    let three = on_threads(3, || monte_carlo(&problem, &drawn, on).unwrap());
    assert_eq!(one.spreads, three.spreads);
    assert!(one.rejected() > 0, "{:?}", one.rejects);
    assert_eq!(one.rejected(), three.rejected());
    assert_eq!(one.spreads[0].count + one.rejected(), 1500);
    let rejected = &one.rejects["out_of_reach"];
    assert!(rejected.first < 1500 && rejected.why.to_string().contains("cannot reach"));
}

/// Progress callback that never stops the run.
fn on(_: u64) -> std::ops::ControlFlow<()> {
    std::ops::ControlFlow::Continue(())
}

/// An interrupted run keeps the finished builds, and reports their number.
#[test]
fn builds_can_be_ended_early() {
    let study = study("macpherson_tolerance", &["tolerance.builds=100000"]);
    let tolerance = study.tolerance.as_ref().unwrap();
    let problem = Problem::of(&study, tolerance).unwrap();
    let drawn = problem.drawn().unwrap();
    let found = monte_carlo(&problem, &drawn, |done| {
        if done >= 2000 {
            std::ops::ControlFlow::Break(())
        } else {
            on(done)
        }
    });
    let found = found.unwrap();
    assert!((2000..20_000).contains(&found.builds), "{}", found.builds);
    let spread = &found.spreads[0];
    assert!(spread.count + found.rejected() <= found.builds && spread.sigma.is_finite());
}

/// Alignment sets camber and toe in the design position, so camber and toe do not scatter in this position. Wide bands
/// on these values leave the ranking unchanged: rounding errors have no share and cost no yield.
#[test]
fn bands_on_values_that_do_not_scatter_leave_the_ranking() {
    let run = |more: &str| {
        let bands = format!(
            "tolerance.bands=[{more} {{ characteristic = \"bump_steer\", at = 0.0, between = [-0.015, -0.009] }}]"
        );
        let short = ["motion.travel=[-30.0,0.0,30.0]", "tolerance.builds=2000"];
        let study = study(
            "double_wishbone_tolerance",
            &[&bands, "tolerance.aligned=true", short[0], short[1]],
        );
        let problem = problem(&study);
        let (drawn, expansion, builds) = built(&problem);
        rank(&problem, &expansion, &builds, &drawn).unwrap()
    };
    let alone = run("");
    let both = run(
        "{ characteristic = \"camber\", at = 0.0, between = [-2.1, -1.9] }, \
         { characteristic = \"toe\", at = 0.0, between = [-0.1, 0.1] },",
    );
    assert_eq!(both.all, alone.all);
    assert_eq!(both.ranking, alone.ranking);
    assert!(alone.all.monte_carlo > 0.05 && alone.all.monte_carlo < 0.999);
}

/// The page states that an aligned camber does not scatter, and computes no Cp from rounding errors.
#[test]
fn the_page_has_no_capability_of_rounding_errors() {
    let directory = tempfile::tempdir().unwrap();
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = path.join("studies/double_wishbone_tolerance.toml");
    let out = directory.path().join("run");
    let set = [
        "tolerance.aligned=true",
        "tolerance.builds=500",
        "motion.travel=[0.0, 30.0]",
        "tolerance.bands=[{ characteristic = \"camber\", at = 0.0, between = [-2.1, -1.9] }, \
         { characteristic = \"camber\", at = 30.0, between = [-4.0, -2.0] }]",
    ];
    let mut command = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
    command.arg("tolerance").arg(&path).arg("--report");
    command.arg("--out").arg(&out);
    command
        .args(set.iter().flat_map(|set| ["--set", set]))
        .assert()
        .success();
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert_eq!(page.matches(">does not scatter</text>").count(), 1);
    assert_eq!(page.matches(">Cp ").count(), 1);
}

/// Alignment sets toe and camber. If the aligned value equals a limit of a band, all builds are within the band, and
/// the linear yield agrees.
#[test]
fn a_value_held_at_a_limit_keeps_its_band() {
    let study = study(
        "double_wishbone_robust",
        &[
            "tolerance.builds=500",
            "tolerance.bands=[{characteristic=\"toe\",at=0.0,between=[0.0,0.2]},\
             {characteristic=\"toe\",at=0.0,at_most=0.0},{characteristic=\"toe\",at=0.0,at_least=0.0},\
             {characteristic=\"camber\",at=0.0,between=[-2.0,-1.8]},\
             {characteristic=\"camber\",at=0.0,between=[-2.2,-2.0]},\
             {characteristic=\"toe\",at=0.0,between=[1e-9,0.2]}]",
        ],
    );
    let problem = problem(&study);
    let (drawn, expansion, builds) = built(&problem);
    let yields = rank(&problem, &expansion, &builds, &drawn).unwrap();
    let (outside, inside) = yields.bands.split_last().unwrap();
    for (number, band) in inside.iter().enumerate() {
        assert_eq!([band.monte_carlo, band.linear], [1.0; 2], "band {number}");
    }
    // A limit that excludes the value by more than a rounding error excludes every build.
    assert_eq!([outside.monte_carlo, outside.linear], [0.0; 2]);
}

/// If doubling a tolerance costs no yield, the tolerance can be relaxed, whatever its share of the variance.
#[test]
fn tolerances_within_a_wide_band_can_be_relaxed() {
    let run = |band: &str| {
        let band = format!("tolerance.bands=[{{characteristic=\"caster\",at=0.0,between={band}}}]");
        let study = study("macpherson_tolerance", &["tolerance.builds=2000", &band]);
        let problem = problem(&study);
        let (drawn, expansion, builds) = built(&problem);
        rank(&problem, &expansion, &builds, &drawn).unwrap().ranking
    };
    let wide = run("[-30.0,30.0]");
    assert!(wide.iter().any(|r| r.share > 0.3));
    assert!(
        wide.iter().all(|r| r.may_be_looser && r.doubled == 1.0),
        "{wide:?}"
    );
    // In a narrow band, the tolerances of the largest contributors cannot be relaxed.
    let narrow = run("[3.35,3.6]");
    let largest = narrow
        .iter()
        .max_by(|a, b| a.share.total_cmp(&b.share))
        .unwrap();
    assert!(!largest.may_be_looser, "{narrow:?}");
}

/// The nominal design does not reach the last station, but some builds do. Their mean and standard deviation follow from
/// their own values. They neither confirm nor refute the linear result, which does not exist.
#[test]
fn builds_have_a_spread_where_the_nominal_value_is_missing() {
    let study = study(
        "double_wishbone_tolerance",
        &[
            "motion.travel=[0.0,322.0]",
            "tolerance.builds=300",
            "tolerance.scatter=[{ hardpoints = [\"lower_ball_joint\", \"upper_ball_joint\"], sigma = 3.0 }]",
            "tolerance.bands=[]",
        ],
    );
    let problem = problem(&study);
    let drawn = problem.drawn().unwrap();
    let builds = monte_carlo(&problem, &drawn, on).unwrap();
    let missing: Vec<usize> = (0..drawn.len())
        .filter(|cell| drawn[*cell].is_nan())
        .collect();
    assert!(!missing.is_empty());
    for cell in missing {
        let spread = &builds.spreads[cell];
        assert!(spread.count > 20 && spread.count < 300, "{spread:?}");
        assert!(
            (spread.range[0]..=spread.range[1]).contains(&spread.mean),
            "{spread:?}"
        );
        let width = spread.range[1] - spread.range[0];
        assert!(
            spread.sigma > 0.02 * width && spread.sigma < width,
            "{spread:?}"
        );
        let estimate = Estimate {
            variance: f64::NAN,
            second: [0.0; 2],
        };
        assert_eq!(estimate.holds(spread), None);
    }
}

/// A percentile that does not exist is a column without values, for a wheel and for an axle.
#[test]
fn percentiles_that_do_not_exist_are_empty_cells() {
    for name in ["macpherson_tolerance", "double_wishbone_axle"] {
        let study = study(name, &["outputs.characteristics=[\"camber\", \"toe\"]"]);
        let drawn = Solved::of(&study).unwrap();
        assert!(drawn.is_complete(), "{name}");
        let without = drawn.with_values(|column, _| if column == 0 { f64::NAN } else { 0.1 });
        assert!(!without.is_complete(), "{name}");
        let curves = without.curves();
        assert!(!curves.has_value(0) && curves.has_value(1), "{name}");
    }
}

/// A band without a drive value extends over the whole motion in charts, also if the drive values are not in order.
#[test]
fn a_band_extends_over_the_whole_motion() {
    let bands = "tolerance.bands=[{ characteristic = \"toe\", between = [0.1, 0.4] }]";
    let study = study("macpherson_tolerance", &[bands]);
    let band = &study.tolerance.as_ref().unwrap().bands[0];
    let curve = BandCurve::of_tolerance(band, &[0.0, 60.0, -60.0, 30.0]);
    let places: Vec<f64> = curve.limits.iter().map(|limit| limit.0).collect();
    assert_eq!(places, [-60.0, 60.0]);
}

//! Tests of robust tuning of axles: each wheel of a build scatters independently.

use crate::compliance::support::fourth_order;
use hardpoint::optimise::{Control, LeastSquares, Linearisation, Objective, TargetLayout, tune};
use hardpoint::study::{Optimise, Study};
use hardpoint::tolerance::{Problem, monte_carlo};
use nalgebra::DVector;
use std::ops::ControlFlow;
use std::path::Path;

/// Half the width of the scatter range. The range is so narrow that the deviation of a part is known.
const NARROW: f64 = 1e-12;

/// Entry with uniform scatter in a very narrow range about a known deviation.
pub fn known(part: &str, deviation: f64) -> String {
    let [low, high] = [deviation - NARROW, deviation + NARROW];
    format!("{{ {part}, limits = [{low:?}, {high:?}] }}")
}

fn read(text: &str) -> Study {
    Study::from_text("case.toml", text, Path::new("")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Residuals of a study's builds, with derivatives, at `x`.
pub fn builds_at(study: &Study, x: &DVector<f64>) -> Linearisation {
    let optimise = study.optimise.as_ref().unwrap();
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let (variables, scatter) = (&optimise.variables, optimise.scatter.as_ref().unwrap());
    let assembled = study.vehicle.assembled().unwrap();
    let problem = Objective::of_builds(&assembled, variables, &layout, scatter, None);
    let mut found = Linearisation::new(layout.residuals(), x.len());
    problem.unwrap().evaluate(x, &mut found).unwrap();
    found
}

/// Residuals of a study's design without scatter.
fn nominal(study: &Study, optimise: &Optimise) -> DVector<f64> {
    let plain = Optimise {
        scatter: None,
        ..optimise.clone()
    };
    let layout = TargetLayout::of(&plain, &study.vehicle);
    let mut found = Linearisation::new(layout.residuals(), 0);
    let mut problem = Objective::new(study.wheel(), &[], &layout).unwrap();
    problem.evaluate(&DVector::zeros(0), &mut found).unwrap();
    found.residuals
}

/// Asserts that the derivatives of the builds equal difference quotients. Richardson's extrapolation combines two
/// quotients of fourth order, with `steps` and with half of `steps`, into one of sixth order.
pub fn assert_derivatives_are_slopes(study: &Study, x: &[f64], steps: &[f64], bound: f64) {
    let x = DVector::from_column_slice(x);
    let here = builds_at(study, &x);
    let largest = here.jacobian.amax();
    assert!(largest > 0.0);
    for (column, step) in steps.iter().enumerate() {
        let at = |factor: f64| {
            let mut moved = x.clone();
            moved[column] += factor * step;
            builds_at(study, &moved).residuals
        };
        let moved = [-2.0, -1.0, -0.5, 0.5, 1.0, 2.0].map(at);
        // The scale of a derivative is the largest derivative in its column.
        let size = here.jacobian.column(column).amax();
        for (row, gradient) in here.jacobian.row_iter().enumerate() {
            let value = |k: usize| moved[k][row];
            let wide = fourth_order([0, 1, 4, 5].map(value), *step);
            let near = fourth_order([1, 2, 3, 4].map(value), 0.5 * step);
            let slope = near + (near - wide) / 15.0;
            let found = gradient[column];
            let off = (found - slope).abs();
            assert!(off < bound * size, "{row} by {column}: {found} {slope}");
        }
    }
}

/// Asserts that more builds meet the bands after a robust tuning than after a plain tuning. Counts builds of `tolerance` that
/// the tuning did not use. Their share agrees with the expected share within five standard errors of the difference. The
/// standard error counts as at least `least`.
pub fn assert_larger_yield(study: &Study, least: f64) {
    let optimise = study.optimise.as_ref().unwrap();
    let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
    let expected = tuning.expected_yield.as_ref().unwrap().as_ref().unwrap();
    let share = |offsets: &[f64]| {
        let moved = study.moved(offsets);
        let problem = Problem::of(&moved, moved.tolerance.as_ref().unwrap()).unwrap();
        let nominal = problem.drawn().unwrap();
        let found = monte_carlo(&problem, &nominal, |_| ControlFlow::Continue(())).unwrap();
        let builds = found.builds as f64;
        (found.in_all_bands as f64 / builds, builds)
    };
    let (plain, builds) = share(&expected.plain);
    let (robust, _) = share(&tuning.best.as_ref().unwrap().offsets);
    println!("{plain} -> {robust}, judged {:?}", expected.judged);
    assert!(robust > plain + 0.05, "{plain} {robust}");
    for (found, judged) in [plain, robust].into_iter().zip(expected.judged) {
        let error = (2.0 * judged * (1.0 - judged) / builds).sqrt();
        assert!(
            (found - judged).abs() < 5.0 * error.max(least),
            "{found} {judged}"
        );
    }
}

/// `tolerance` writes a build with known deviations as a study. The nominal residuals of that study equal the residuals of the
/// build in the tuning.
pub fn assert_builds_are_written_builds(study: &Study, x: &[f64], read: impl Fn(&str) -> Study) {
    let optimise = study.optimise.as_ref().unwrap();
    let found = builds_at(study, &DVector::from_column_slice(x)).residuals;
    let moved = read(&study.with_points_of(&study.moved(x)));
    let problem = Problem::of(&moved, moved.tolerance.as_ref().unwrap()).unwrap();
    let written = read(&problem.built_text(0).unwrap());
    let expected = nominal(&written, optimise);
    let drawn = nominal(&moved, optimise);
    let scatter = optimise.scatter.as_ref().unwrap();
    assert_eq!(found.len(), scatter.builds * expected.len());
    for (row, found) in found.iter().enumerate() {
        let expected = expected[row % expected.len()];
        assert!((found - expected).abs() < 1e-7, "{row}: {found} {expected}");
    }
    let apart = (&expected - &drawn).amax();
    assert!(apart > 0.1, "the scatter has no effect: {apart}");
}

/// Left wheel of a strut axle.
fn wheel() -> String {
    let text = crate::support::sample("macpherson_axle_front.toml");
    text.split("[axle]").next().unwrap().to_owned()
}

const VARIABLES: &str = r#"
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-20.0, 20.0] },
  { hardpoint = "tie_rod_outer", axis = "y", range = [-20.0, 20.0] },
  { rigid = ["lower_arm_front", "lower_arm_rear"], shift = 10.0, turn = 3.0 },
]
"#;

const SCATTER: &str = r#"scatter = [
  { hardpoints = ["lower_arm_front", "tie_rod_outer"], sigma = 0.4 },
  { hardpoint = "strut_top", axis = "y", limits = [-0.5, 0.3], side = "right" },
  { length = "tie_rod", sigma = 0.2 },
  { jig = ["lower_arm_front", "lower_arm_rear"], turn = 0.1 },
]
"#;

/// Study of an axle with this right wheel, this motion, these targets and this scatter.
fn axle(right: &str, motion: &str, targets: &str, tolerance: &str) -> Study {
    read(&format!(
        "{}{right}[steering]\nc_factor = -52.0\n[spring]\nrate = 30.0\nforce = 4000.0\n[wheel]\nradius = 300.0\n[vehicle]\nwheelbase = 2650.0\nposition = \"front\"\n[motion]\n{motion}\n\
         [setup]\nadjust = [{{ length = \"tie_rod\", per_turn = 2.0 }}]\n\
         [tolerance]\nseed = 3\nbuilds = 2000\n{tolerance}\n[optimise]\nscatter = 3\n{VARIABLES}targets = [{targets}]\n",
        wheel()
    ))
}

const MIRRORED: &str = "[axle]\nright = \"mirrored\"\n";
const OWN: &str = "[axle.right.hardpoints]\ntie_rod_inner = [-110.0, -330.0, 245.5]\nstrut_top = [-33.0, -575.0, 849.0]\n";

const ON_PLANE: &str = r#"
  { characteristic = "ackermann_error", over = "steering_wheel_angle", at = 300.0, value = 0.0, tolerance = 0.1 },
  { characteristic = "roll_centre_height", over = "roll", heave = 20.0, at = 2.0, value = 0.0, tolerance = 2.0 },
  { characteristic = "roll_steer", over = "heave", roll = [-1.0, 1.0], at = 10.0, value = 0.1, tolerance = 0.01, weight = 2.0 },
  { characteristic = "camber_to_road", side = "right", over = "roll", steering_wheel_angle = 200.0, at = 1.0, value = 0.0, tolerance = 0.1 },
  { characteristic = "toe", over = "heave", at = 20.0, value = 0.0, tolerance = 0.1 },
"#;
const ROLLED: &str =
    "roll = [-2.0, 0.0, 2.0]\nheave = [0.0, 20.0]\nsteering_wheel_angle = [0.0, 300.0]";
const ON_PADS: &str = "travel_left = [-30.0, 0.0, 30.0]\ntravel_right = 0.0";

/// The derivatives are exact for mirrored and for different wheels, and for aligned and unaligned builds.
#[test]
fn derivatives_of_builds_of_axles_are_exact() {
    let x = [1.5, -2.0, 0.5, -1.0, 0.7, 0.3, -0.4, 0.2];
    let aligned = format!("aligned = true\n{SCATTER}");
    for (right, tolerance) in [
        (MIRRORED, SCATTER),
        (MIRRORED, aligned.as_str()),
        (OWN, aligned.as_str()),
    ] {
        let study = axle(right, ROLLED, ON_PLANE, tolerance);
        assert_derivatives_are_slopes(&study, &x, &[0.05; 8], 1e-7);
    }
}

/// A build of the tuning equals the build that `tolerance` assembles from the same deviations.
#[test]
fn builds_of_an_axle_are_those_of_tolerance() {
    let parts = [
        known(
            "hardpoint = \"lower_arm_front\", axis = \"z\", side = \"left\"",
            0.8,
        ),
        known(
            "hardpoint = \"tie_rod_outer\", axis = \"x\", side = \"right\"",
            -1.1,
        ),
        known("length = \"tie_rod\", side = \"right\"", 0.4),
        known("hardpoint = \"strut_top\", axis = \"y\"", 0.6),
    ];
    let scatter = format!("scatter = [{}]\n", parts.join(", "));
    let x = [1.5, -2.0, 0.5, -1.0, 0.7, 0.3, -0.4, 0.2];
    for right in [MIRRORED, OWN] {
        for aligned in ["", "aligned = true\n"] {
            let study = axle(right, ROLLED, ON_PLANE, &format!("{aligned}{scatter}"));
            assert_builds_are_written_builds(&study, &x, read);
        }
    }
}

/// If only the left wheel scatters and has targets, the builds equal those of the study without `[axle]`. If both
/// wheels scatter in mirror image, each wheel has the residuals of the single wheel.
#[test]
fn wheels_of_an_axle_scatter_like_a_single_wheel() {
    let x = DVector::from_column_slice(&[1.5, -2.0, 0.5, -1.0, 0.7, 0.3, -0.4, 0.2]);
    let targets = |of_axle: &str| {
        let curve = "points = [[-30.0, -1.0], [0.0, 0.0], [30.0, 0.5]], tolerance = 0.05";
        format!(
            "{{ characteristic = \"camber\"{of_axle}, {curve} }}, {{ characteristic = \"toe\"{of_axle}, {curve}, weight = 2.0 }}"
        )
    };
    let of_wheel = |scatter: &str| {
        let text = format!(
            "{}[motion]\ntravel = [-30.0, 0.0, 30.0]\n[tolerance]\nseed = 3\nscatter = [{scatter}]\n\
             [optimise]\nscatter = 3\n{VARIABLES}targets = [{}]\n",
            wheel(),
            targets("")
        );
        builds_at(&read(&text), &x)
    };
    let same = |found: &Linearisation, row: usize, expected: &Linearisation, of: usize| {
        let off = (found.residuals[row] - expected.residuals[of]).abs();
        assert!(off < 1e-9, "{row}: {off:e}");
        let off = (found.jacobian.row(row) - expected.jacobian.row(of)).amax();
        assert!(off < 1e-9 * expected.jacobian.amax(), "{row}: {off:e}");
    };

    let own = "{ hardpoints = [\"lower_arm_front\", \"tie_rod_outer\"], sigma = 0.4SIDE }, { length = \"tie_rod\", sigma = 0.2SIDE }";
    let wheel = of_wheel(&own.replace("SIDE", ""));
    let of_left = own.replace("SIDE", ", side = \"left\"");
    let left = axle(
        MIRRORED,
        ON_PADS,
        &targets(", side = \"left\", over = \"travel_left\""),
        &format!("scatter = [{of_left}]"),
    );
    let found = builds_at(&left, &x);
    assert_eq!(found.residuals.len(), 3 * 6);
    for row in 0..18 {
        same(&found, row, &wheel, row);
    }
    assert!((found.residuals[0] - found.residuals[6]).abs() > 0.1);

    let parts = [
        known("hardpoint = \"lower_arm_front\", axis = \"y\"", 0.7),
        known("length = \"tie_rod\"", -0.5),
    ];
    let wheel = of_wheel(&parts.join(", "));
    let both = axle(
        MIRRORED,
        "heave = [-30.0, 0.0, 30.0]",
        &targets(", over = \"heave\""),
        &format!("scatter = [{}]", parts.join(", ")),
    );
    let found = builds_at(&both, &x);
    assert_eq!(found.residuals.len(), 3 * 12);
    for row in 0..36 {
        // Camber and toe have one residual for each wheel at each station.
        same(&found, row, &wheel, row / 2);
    }
}

const TUNED: &str = r#"
  { characteristic = "toe", over = "heave", points = [[-30.0, 0.1], [30.0, 0.1]], tolerance = 0.02 },
  { characteristic = "mean_steer", over = "roll", at = 2.0, value = 0.0, tolerance = 0.02 },
"#;

/// A tuning has the same result, bit for bit, on one CPU thread and on two. The misfit over the builds is at most that of the
/// optimum without scatter. It is also below that of the given axle.
#[test]
fn a_tuned_axle_is_the_same_on_any_number_of_threads() {
    let motion = "roll = [-2.0, 0.0, 2.0]\nheave = [-30.0, 0.0, 30.0]";
    let study = axle(MIRRORED, motion, TUNED, SCATTER);
    let sets = ["optimise.starts=3", "optimise.good_enough=0.0"].map(str::to_owned);
    let study = study.with_overrides("case.toml", &sets).unwrap();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let run = || {
            tune(
                &study.vehicle,
                study.optimise.as_ref().unwrap(),
                Control::default(),
            )
        };
        pool.unwrap().install(run).unwrap()
    };
    let [one, two] = [1, 2].map(on);
    let bits = |offsets: &[f64]| -> Vec<u64> { offsets.iter().map(|x| x.to_bits()).collect() };
    let (before, best) = (one.before.unwrap(), one.best.unwrap());
    let other = two.best.unwrap();
    assert_eq!(bits(&best.offsets), bits(&other.offsets));
    assert_eq!(best.after, other.after);
    let plain = Optimise {
        scatter: None,
        ..study.optimise.clone().unwrap()
    };
    let plain = tune(&study.vehicle, &plain, Control::default()).unwrap();
    let plain = DVector::from_vec(plain.best.unwrap().offsets);
    let [given, plain] = [&DVector::zeros(8), &plain].map(|x| builds_at(&study, x).misfit());
    let found = best.after.misfit;
    assert!((given - before.misfit).abs() < 1e-12 * given);
    assert!(found <= plain * (1.0 + 1e-6), "{found} {plain}");
    assert!(found < given, "{found} {given}");
}

/// The target is near an end of the band, so the optimum without scatter has a low yield. Builds of `tolerance`, which
/// the tuning did not use, meet the bands more often after the robust tuning. This yield agrees with the expected yield
/// within five standard errors of both samples. One band applies at a heave, the other over the whole motion.
#[test]
fn the_robust_axle_has_the_larger_yield() {
    let targets =
        r#"{ characteristic = "toe", over = "heave", at = 30.0, value = 0.0, tolerance = 0.02 }"#;
    let tolerance = r#"
scatter = [{ hardpoint = "tie_rod_inner", axis = "z", sigma = 0.4 }]
bands = [
  { characteristic = "toe", over = "heave", at = 30.0, between = [-0.02, 0.2] },
  { characteristic = "camber", between = [-5.0, 5.0] },
]
"#;
    let study = axle(MIRRORED, "heave = [0.0, 30.0]", targets, tolerance);
    let sets = [
        "optimise.scatter=32",
        "optimise.robust=\"yield\"",
        "optimise.good_enough=0.0",
        "optimise.variables=[{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-15.0, 15.0] }]",
    ];
    let study = study
        .with_overrides("case.toml", &sets.map(str::to_owned))
        .unwrap();
    assert_larger_yield(&study, 1e-3);
}

//! Tests of builds of axles: two wheels that scatter independently, on one rack and one ground.

use crate::support::one_line;
use hardpoint::axle::axle_curves;
use hardpoint::model::Side;
use hardpoint::number::Width;
use hardpoint::study::Study;
use hardpoint::tolerance::{Expansion, MonteCarlo, Problem, monte_carlo, monte_carlo_in, rank};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::Command;

const SCATTER: &str = "scatter=[\
    {hardpoints=[\"lower_arm_front\",\"tie_rod_outer\"],sigma=0.4},\
    {hardpoint=\"strut_top\",axis=\"y\",limits=[-0.5,0.3],side=\"right\"},\
    {length=\"tie_rod\",sigma=0.2},\
    {jig=[\"lower_arm_front\",\"lower_arm_rear\"],turn=0.1}]";

/// Left wheel of a sample study of an axle, without the entries that define the axle.
fn wheel() -> String {
    let text = crate::support::sample("macpherson_axle_front.toml");
    text.split("[axle]").next().unwrap().to_owned()
}

/// Axle with this scatter and these further keys of `[tolerance]`, at a few positions.
pub(super) fn axle(tolerance: &str, more: &[&str]) -> Study {
    let head = wheel();
    let text = format!(
        "{head}[axle]\nright = \"mirrored\"\n[steering]\nc_factor = -52.0\n[wheel]\nradius = 300.0\n\
         [motion]\nroll = [-2.0, 0.0, 1.5]\nheave = [-20.0, 0.0]\nsteering_wheel_angle = [0.0, 200.0]\n\
         [outputs]\ncharacteristics = [\"toe\", \"mean_steer\", \"roll_steer\", \"force_roll_centre_height\", \"track\"]\n\
         [tolerance]\nseed = 3\n{}\n{SCATTER}\n",
        tolerance.replace(',', "\n")
    );
    let study = Study::from_text("axle.toml", &text, Path::new("."));
    let study = study.unwrap_or_else(|e| panic!("{e}"));
    let more: Vec<String> = more.iter().map(|set| (*set).to_owned()).collect();
    let changed = study.with_overrides("axle.toml", &more);
    changed.unwrap_or_else(|e| panic!("{e}"))
}

pub(super) fn problem(study: &Study) -> Problem<'_> {
    Problem::of(study, study.tolerance.as_ref().unwrap()).unwrap()
}

fn on(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn solved(problem: &Problem) -> (Vec<f64>, MonteCarlo) {
    let drawn = problem.drawn().unwrap();
    let found = monte_carlo(problem, &drawn, on).unwrap();
    (drawn, found)
}

/// Index of a column among the outputs.
fn output(problem: &Problem, column: &str) -> usize {
    let found = problem.outputs().iter().position(|o| o.name == column);
    found.unwrap_or_else(|| panic!("no {column}"))
}

/// The two wheels of build n of an axle equal builds 2 n and 2 n + 1 of a single wheel. A wheel depends only on the
/// seed, the number of the build and the side. It does not depend on the scatter of the other side.
#[test]
fn each_wheel_is_a_build_of_its_own() {
    let both = axle("builds=2", &[]);
    let own_scatter = SCATTER.replace(",side=\"right\"", "");
    let sides = [
        // Removes the entries that apply to the right wheel only.
        SCATTER.replace(
            "{hardpoint=\"strut_top\",axis=\"y\",limits=[-0.5,0.3],side=\"right\"},",
            "",
        ),
        own_scatter,
    ];
    let of_one = |scatter: &str| {
        let head = wheel();
        let text =
            format!("{head}[motion]\ntravel = 0.0\n[tolerance]\nbuilds = 2\nseed = 3\n{scatter}\n");
        Study::from_text("wheel.toml", &text, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
    };
    for number in [0, 1, 17] {
        let wheels = problem(&both).built_wheels(number).unwrap();
        for side in Side::ALL {
            let one = of_one(&sides[side as usize]);
            let alone = problem(&one).built(2 * number + side as u64).unwrap();
            assert_eq!(wheels[side as usize].design, alone.design);
        }
        assert_ne!(wheels[0].design, wheels[1].design);
    }
}

/// When a printed build is solved, it has the values of the Monte Carlo analysis. With two builds, one has the smallest and the
/// other the largest value of the analysis.
#[test]
fn a_printed_build_is_the_build() {
    let study = axle("builds=2", &[]);
    let problem = problem(&study);
    let (_, found) = solved(&problem);
    let curves = [0, 1].map(|number| {
        let wheels = problem.built_wheels(number).unwrap();
        let text = study.with_built_axle([&wheels[0], &wheels[1]]);
        let printed = Study::from_text("built.toml", &text, Path::new("."));
        let printed = printed.unwrap_or_else(|e| panic!("{e}"));
        let both = printed.axle().unwrap().clone();
        assert_eq!(both.axle.left.design, wheels[0].design);
        assert_eq!(both.axle.right.as_ref().unwrap().design, wheels[1].design);
        axle_curves(&both.axle, &both.plan).unwrap().curves
    });
    let stations = curves[0].stations.len();
    assert_eq!(
        problem.placements()[..stations],
        study.axle().unwrap().plan.motion.placements()
    );
    for (k, column) in curves[0].columns.iter().enumerate() {
        for station in 0..stations {
            let mut values = [0, 1].map(|build| curves[build].stations[station].value(k).unwrap());
            values.sort_by(f64::total_cmp);
            let range = found.spreads[problem.cell(k, station)].range;
            for (value, limit) in values.into_iter().zip(range) {
                let off = (value - limit * problem.outputs()[k].factor()).abs();
                assert!(off < 1e-9, "{} {station}: {off:e}", column.name);
            }
        }
    }
}

/// A printed build includes the extra points of each wheel at their built positions. Every command accepts the printed
/// build as a study. The test covers mirrored and separate right hardpoints, and spin axes given by angles or points.
#[test]
fn a_printed_build_has_its_extra_points() {
    let five_link = crate::support::sample("five_link_axle_tolerance.toml");
    let extra = "[suspension.extra_points]\n\
        drive_shaft_outer = { body = \"knuckle\", position = [0.0, 700.0, 310.0] }\n\
        drive_shaft_inner = { body = \"chassis\", position = [0.0, 150.0, 320.0] }\n";
    let own = "[axle]\n[axle.right.hardpoints]\ntoe_link_outer = [-165.0, -700.0, 251.5]\n";
    let given = "drive_shaft_outer = [1.0, -699.0, 311.0]\n";
    let axle_of = |right: &str| {
        five_link.replace("[axle]\nright = \"mirrored\"\n", &format!("{extra}{right}"))
    };
    let strut = axle("builds=2", &[]).text;
    let texts = [
        axle_of("[axle]\nright = \"mirrored\"\n"),
        axle_of(own),
        axle_of(&format!("{own}{given}")),
        strut.replacen("[axle]", &format!("{extra}[axle]"), 1),
    ];
    for text in texts {
        assert!(text.contains("drive_shaft_inner"));
        let study = Study::from_text("axle.toml", &text, Path::new("."));
        let study = study.unwrap_or_else(|e| panic!("{e}"));
        let problem = problem(&study);
        for number in [0, 3] {
            let wheels = problem.built_wheels(number).unwrap();
            let printed = study.with_built_axle([&wheels[0], &wheels[1]]);
            let printed = Study::from_text("built.toml", &printed, Path::new("."));
            let printed = printed.unwrap_or_else(|e| panic!("{e}"));
            let both = printed.axle().unwrap();
            assert_eq!(both.axle.left.design, wheels[0].design);
            assert_eq!(both.axle.right.as_ref().unwrap().design, wheels[1].design);
            assert!(
                axle_curves(&both.axle, &both.plan)
                    .unwrap()
                    .curves
                    .are_complete()
            );
            // A printed build can be the nominal design of further builds.
            let again = Problem::of(&printed, printed.tolerance.as_ref().unwrap()).unwrap();
            again.built_wheels(number).unwrap();
        }
    }
}

/// For small scatter, the standard deviations of the first order agree with those of the Monte Carlo analysis. Both
/// wheels of a mirrored axle scatter equally and independently.
#[test]
fn first_order_is_the_monte_carlo_where_scatter_is_small() {
    if !crate::support::has_lanes() {
        return;
    }
    let same_sides = "tolerance.scatter=[{hardpoints=[\"lower_arm_front\",\"tie_rod_inner\"],sigma=0.1},{length=\"tie_rod\",sigma=0.05}]";
    let study = axle("builds=1500", &[same_sides]);
    let problem = problem(&study);
    let expansion = Expansion::of(&problem).unwrap();
    let (_, found) = solved(&problem);
    assert_eq!(problem.not_in_lanes(), None);
    for (cell, spread) in found.spreads.iter().enumerate() {
        let linear = expansion.variance[cell].sqrt();
        let off = (spread.sigma - linear).abs();
        assert!(
            off < 0.01 * linear + 4.5 * spread.sigma_error,
            "{cell}: {spread:?} {linear}"
        );
        let of_velocities = problem.outputs()[cell / problem.stations().count()]
            .name
            .contains("roll");
        assert_eq!(expansion.holds(cell), (!of_velocities).then_some(true));
    }
    let rest = problem.stations().design();
    let variance = |column: &str| expansion.variance[problem.cell(output(&problem, column), rest)];
    let [left, right] = ["left_toe_deg", "right_toe_deg"].map(variance);
    assert!((left / right - 1.0).abs() < 1e-9, "{left} {right}");
    // The mean of independent wheels has half the variance of each wheel, except for the common effect of the ground.
    assert!((variance("mean_steer_deg") / left - 0.5).abs() < 1e-3);
}

/// On pads, a contributor of one side does not move the other wheel.
#[test]
fn a_side_scatters_by_itself() {
    let motion = "motion={heave=[-20.0,0.0,20.0]}";
    let one = "tolerance.scatter=[{hardpoint=\"tie_rod_inner\",sigma=0.3,side=\"right\"}]";
    let study = axle("builds=40", &[motion, one]);
    let problem = problem(&study);
    let expansion = Expansion::of(&problem).unwrap();
    let (_, found) = solved(&problem);
    for station in 0..problem.stations().count() {
        let cell = |column: &str| problem.cell(output(&problem, column), station);
        let sigma = |column: &str| found.spreads[cell(column)].sigma;
        assert!(sigma("left_toe_deg") < 1e-12 && sigma("right_toe_deg") > 1e-4);
        assert!(expansion.variance[cell("left_toe_deg")] == 0.0);
        // The mean steer of both wheels changes half as much as the steer of the moved wheel.
        let ratio =
            expansion.variance[cell("mean_steer_deg")] / expansion.variance[cell("right_toe_deg")];
        assert!((ratio - 0.25).abs() < 1e-12, "{ratio}");
    }
}

/// After alignment, each wheel has its nominal toe and camber at rest on its pad. In other positions, the first-order
/// scatter equals that of the builds.
#[test]
fn each_wheel_is_aligned() {
    let setup = "setup={adjust=[{shim=\"strut_top\",axis=\"y\"},{length=\"tie_rod\"}]}";
    let motion = "motion={heave=[-20.0,0.0,20.0]}";
    let small =
        "tolerance.scatter=[{hardpoints=[\"lower_arm_front\",\"tie_rod_inner\"],sigma=0.1}]";
    let study = axle(
        "builds=1500",
        &[setup, "tolerance.aligned=true", motion, small],
    );
    let problem = problem(&study);
    let expansion = Expansion::of(&problem).unwrap();
    let (drawn, found) = solved(&problem);
    for column in ["left_toe_deg", "right_toe_deg"] {
        for station in 0..problem.stations().count() {
            let cell = problem.cell(output(&problem, column), station);
            let (spread, linear) = (&found.spreads[cell], expansion.variance[cell].sqrt());
            if station == problem.stations().design() {
                assert!(spread.sigma < 1e-13 && linear < 1e-13);
                assert!((spread.mean - drawn[cell]).abs() < 1e-13);
            } else {
                let off = (spread.sigma - linear).abs();
                assert!(linear > 1e-7 && off < 0.01 * linear + 4.5 * spread.sigma_error);
            }
        }
    }
}

/// Builds have the same values in SIMD lanes and one by one. Their results have the same bits with any number of CPU threads.
/// Each band applies to the expected number of values.
#[test]
fn results_are_the_same_however_they_are_found() {
    if !crate::support::has_lanes() {
        return;
    }
    let bands = "tolerance.bands=[\
        {characteristic=\"toe\",over=\"heave\",at=0.0,between=[-0.3,0.4]},\
        {characteristic=\"roll_steer\",over=\"roll\",heave=[10.0,-20.0],at_least=-0.06},\
        {characteristic=\"track\",at_most=1500.0}]";
    let study = axle("builds=300", &[bands]);
    let problem = problem(&study);
    let drawn = problem.drawn().unwrap();
    let on_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap()
            .install(|| monte_carlo(&problem, &drawn, on).unwrap())
    };
    let (one, three) = (on_threads(1), on_threads(3));
    assert_eq!(one.spreads, three.spreads);
    assert_eq!(one.in_bands, three.in_bands);
    let single = monte_carlo_in(None, &problem, &drawn, on).unwrap();
    assert!(Width::available().next().is_some());
    for (a, b) in one.spreads.iter().zip(&single.spreads) {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + b.abs());
        assert!(
            near(a.mean, b.mean) && near(a.sigma, b.sigma),
            "{a:?} {b:?}"
        );
    }
    assert_eq!(one.in_bands, single.in_bands);
    // Numbers of values: toe of both wheels at one station, roll steer at three roll angles and two heaves, and track
    // at all 12 stations.
    let looked: Vec<usize> = problem.cells_of_bands().map(|cells| cells.len()).collect();
    assert_eq!(looked, [2, 3 * 2, 12]);
    assert!(
        one.in_bands[0] > 0 && one.in_bands[0] < 300,
        "{:?}",
        one.in_bands
    );
    let expansion = Expansion::of(&problem).unwrap();
    let yields = rank(&problem, &expansion, &one, &drawn).unwrap();
    assert!(
        (yields.bands[0].linear - yields.bands[0].monte_carlo).abs() < 0.1,
        "{yields:?}"
    );
    assert_eq!(
        yields.ranking.len(),
        study.tolerance.as_ref().unwrap().scatter.len()
    );
}

/// The program names the wheel and the build that cannot be assembled. It does not count that build.
#[test]
fn a_wheel_that_cannot_be_put_together_is_named() {
    let wide = "tolerance.scatter=[{length=\"lower_arm_front\",sigma=150.0,side=\"right\"}]";
    let study = axle("builds=200", &[wide]);
    let problem = problem(&study);
    let (_, found) = solved(&problem);
    let rejected = &found.rejects["out_of_reach"];
    assert_eq!(rejected.side, Some(Side::Right));
    assert!(rejected.builds > 0 && found.rejected() < 200);
    let at_rest = &found.spreads[problem.cell(0, problem.stations().design())];
    assert_eq!(at_rest.count + found.rejected(), 200);
    let (side, _) = problem.built_wheels(rejected.first).unwrap_err();
    assert_eq!(side, Some(Side::Right));
}

/// Test of the tolerance command as a user runs it. The files state the positions of an axle, a printed build can be
/// solved, and invalid entries are refused.
#[test]
fn tolerance_of_an_axle_as_a_command() {
    let directory = tempfile::tempdir().unwrap();
    let study = axle(
        "builds=150",
        &[
            "tolerance.bands=[{characteristic=\"toe\",side=\"left\",over=\"roll\",at=0.0,between=[-0.4,0.5]}]",
        ],
    );
    std::fs::write(directory.path().join("axle.toml"), &study.text).unwrap();
    let run = |arguments: &[&str], code: i32| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hardpoint"));
        let output = command
            .current_dir(directory.path())
            .args(arguments)
            .output()
            .unwrap();
        let text = [&output.stdout, &output.stderr]
            .map(|bytes| String::from_utf8_lossy(bytes).into_owned());
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text:?}");
        text
    };
    run(&["tolerance", "axle.toml", "--out", "out", "--report"], 0);
    let file =
        |name: &str| std::fs::read_to_string(directory.path().join("out").join(name)).unwrap();
    let table = file("tolerance.csv");
    assert!(
        table.starts_with("output,roll_deg,heave_mm,steering_wheel_angle_deg,builds,"),
        "{table}"
    );
    assert!(
        table.contains("\nleft_toe_deg,-2.0,-20.0,0.0,150,"),
        "{table}"
    );
    assert!(file("contributors.csv").contains(",right strut_top y,"));
    assert!(file("summary.json").contains("left_toe_deg at roll 0"));
    assert!(file("curves_p99.csv").starts_with("roll_deg,heave_mm,"));
    let [said, _] = run(&["check", "axle.toml"], 0);
    assert!(
        said.contains("150 builds") && !said.contains("one by one"),
        "{said}"
    );
    let [built, _] = run(&["tolerance", "axle.toml", "--build", "7"], 0);
    std::fs::write(directory.path().join("build7.toml"), built).unwrap();
    run(&["solve", "build7.toml", "--out", "solved"], 0);

    let refused = |set: &[&str], words: &str| {
        let mut arguments = vec!["tolerance", "axle.toml"];
        arguments.extend(set.iter().flat_map(|set| ["--set", set]));
        let [_, said] = run(&arguments, 2);
        let said = one_line(&said);
        assert!(said.contains(words), "{said}");
    };
    refused(
        &["tolerance.scatter=[{length=\"tie_rod\",sigma=0.1,side=\"middle\"}]"],
        "expected \"left\" or \"right\"",
    );
    refused(
        &["tolerance.bands=[{characteristic=\"toe\",at=0.0,at_most=0.1}]"],
        "expected over = one of",
    );
    refused(
        &["tolerance.bands=[{characteristic=\"toe\",over=\"roll\",at=9.0,at_most=0.1}]"],
        "outside of the motion",
    );
    refused(
        &["tolerance.bands=[{characteristic=\"rack_trail\",at_most=0.1}]"],
        "quantity of an axle",
    );
    refused(&["tolerance.aligned=true"], "needs [setup]");
    let wheel = study_of_one_wheel();
    std::fs::write(directory.path().join("wheel.toml"), wheel).unwrap();
    let [_, said] = run(&["tolerance", "wheel.toml"], 2);
    let said = one_line(&said);
    assert!(
        said.contains("side needs [axle]") && said.contains("over needs [axle]"),
        "{said}"
    );
}

/// Study of one wheel with the entries of an axle.
fn study_of_one_wheel() -> String {
    wheel()
        + "[motion]\ntravel = 0.0\n[outputs]\ncharacteristics = [\"toe\"]\n[tolerance]\n\
        scatter = [{ length = \"tie_rod\", sigma = 0.1, side = \"left\" }]\n\
        bands = [{ characteristic = \"toe\", over = \"roll\", at_most = 0.1 }]\n"
}

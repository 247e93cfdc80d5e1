//! Tests of the results of `hardpoint bench`, but not of its times: the errors are the same on every machine.

use crate::support::study;
use assert_cmd::Command;
use hardpoint::bench::accuracy::{Accuracy, Family, Measurement};
use hardpoint::bench::effects::Effects;
use hardpoint::bench::throughput::Throughput;
use hardpoint::bench::{Clock, Unmeasurable};
use hardpoint::number::Width;
use hardpoint::report::accuracy_picture;
use std::time::Duration;

/// Clock that runs each measured task as few times as possible.
const NO_TIME: Clock = Clock {
    samples: 1,
    shortest: Duration::ZERO,
};

fn of<'a>(accuracy: &'a Accuracy, family: Family, method: &str) -> Vec<&'a Measurement> {
    let all = accuracy.measurements.iter();
    let found: Vec<_> = all
        .filter(|m| m.family == family && m.method == method)
        .collect();
    assert!(!found.is_empty(), "{method}");
    found
}

/// Returns the error that the benchmark reports for this setting.
fn error(measurements: &[&Measurement], setting: &str) -> f64 {
    let found = measurements.iter().find(|m| m.setting == setting);
    found.unwrap_or_else(|| panic!("{setting}")).error
}

/// The closed form runs in single, double and twice double precision, with 7, 16 and 31 digits. Errors are relative to a few
/// hundred millimetres.
fn assert_rounding(accuracy: &Accuracy) {
    let rounding = |name: &str| error(&of(accuracy, Family::Pose, name), "rounding");
    let [single, double, twice] =
        ["f32", "f64", "double-double"].map(|name| rounding(&format!("closed form, {name}")));
    assert!((1e-7..1e-3).contains(&single), "{single:e}");
    assert!((1e-17..1e-12).contains(&double), "{double:e}");
    assert!(twice < 1e-27, "{twice:e}");
    // Two other formulations give the same poses up to rounding errors: six equations, and point coordinates.
    assert!(rounding("six equations, f64") < 1e-12);
    assert!(rounding("point coordinates (paper)") < 1e-11);
}

/// With a tolerance that is ten times finer, the error does not increase.
fn assert_finer_tolerances(accuracy: &Accuracy) {
    for name in ["closed form, f64", "six equations, f64"] {
        let errors: Vec<f64> = of(accuracy, Family::Pose, name)
            .iter()
            .map(|m| m.error)
            .collect();
        assert!(errors[0] > 1e-4, "{errors:?}");
        let mut falls = errors
            .windows(2)
            .map(|pair| pair[1] <= 1.5 * pair[0] + 1e-13);
        assert!(falls.all(|falls| falls), "{errors:?}");
    }
}

/// With a better starting point, the solver needs fewer iterations for the same error.
fn assert_better_starts(accuracy: &Accuracy) {
    let evaluations = |name: &str| {
        let found = of(accuracy, Family::Start, name);
        let m = found.iter().find(|m| m.setting == "1e-9 m").unwrap();
        m.evaluations.unwrap()
    };
    let starts = [
        "cold",
        "warm",
        "predictor of order 1",
        "predictor of order 3",
    ];
    let counts = starts.map(evaluations);
    assert!(counts.is_sorted_by(|a, b| a >= b), "{counts:?}");
    assert!(counts[3] + 1.0 < counts[0], "{counts:?}");
}

/// The error of straight lines falls with the square of the distance between stations, the error of cubics with its
/// fourth power. The error of polynomials through Chebyshev points falls faster than any power.
fn assert_interpolation(accuracy: &Accuracy) {
    let curve = |method: &str, count: usize| {
        let setting = format!("{count} stations");
        error(&of(accuracy, Family::Curve, method), &setting)
    };
    let gain = |method: &str| curve(method, 33) / curve(method, 65);
    assert!((3.5..4.5).contains(&gain("linear")), "{}", gain("linear"));
    assert!((12.0..20.0).contains(&gain("cubic")), "{}", gain("cubic"));
    assert!(curve("Chebyshev", 17) < 1e-12);
}

/// The error of difference quotients has a minimum: with longer or shorter steps the error is larger.
fn assert_quotients(accuracy: &Accuracy) {
    let analytic = of(accuracy, Family::Derivative, "analytic")[0].error;
    assert!(analytic < 1e-14, "{analytic:e}");
    let central = of(accuracy, Family::Derivative, "central difference");
    let best = central
        .iter()
        .map(|m| m.error)
        .fold(f64::INFINITY, f64::min);
    let [short, long] = ["step 1e-10", "step 1e-2"].map(|s| error(&central, s));
    assert!(short > 1e3 * best && long > 1e6 * best);
    // With the best step, difference quotients lose five digits; with the usual step they lose six.
    assert!(best > 1e5 * analytic, "{best:e} {analytic:e}");
    assert!(error(&central, "usual step") > 1e6 * analytic);
}

#[test]
fn errors_are_what_arithmetic_and_method_promise() {
    let accuracy = Accuracy::measure(
        study("macpherson_front.toml", &[]).one_wheel().unwrap(),
        &NO_TIME,
    )
    .unwrap();
    for m in &accuracy.measurements {
        assert!(m.error.is_finite(), "{m:?}");
    }
    assert_rounding(&accuracy);
    assert_finer_tolerances(&accuracy);
    assert_better_starts(&accuracy);
    assert_interpolation(&accuracy);
    assert_quotients(&accuracy);

    // Forward and adjoint methods give the same derivative.
    for method in ["forward", "adjoint"] {
        for m in of(&accuracy, Family::Sensitivity, method) {
            assert!(m.error < 1e-12, "{m:?}");
        }
    }

    let svg = accuracy_picture(&accuracy, "a strut");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for word in [
        "double-double",
        "Chebyshev",
        "sixth-order difference",
        "a strut",
    ] {
        assert!(svg.contains(word), "{word}");
    }
}

/// The benchmarks of accuracy and of effects run for every topology.
#[test]
fn every_topology_can_be_measured() {
    const FEW: &[&str] = &["motion.travel={from=-40.0, to=40.0, steps=5}"];
    for name in [
        "double_wishbone_solve.toml",
        "five_link_solve.toml",
        "semi_trailing_arm_solve.toml",
    ] {
        let study = study(name, FEW);
        let accuracy = Accuracy::measure(study.one_wheel().unwrap(), &NO_TIME)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let six = of(&accuracy, Family::Pose, "six equations, f64");
        assert!(error(&six, "rounding") < 1e-11, "{name}");
        let analytic = of(&accuracy, Family::Derivative, "analytic")[0].error;
        assert!(analytic < 1e-11, "{name}: {analytic:e}");
        let effects = Effects::measure(study.one_wheel().unwrap(), &NO_TIME)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let work = |name: &str| {
            let mut found = effects.measurements.iter();
            found.find(|m| m.effect.starts_with(name)).unwrap().work
        };
        assert_eq!(
            work("position"),
            work("inputs of all outputs given"),
            "{name}"
        );
        assert!(work("rates").right_hand_sides > work("position").right_hand_sides);
    }
}

#[test]
fn a_motion_of_two_stations_is_no_curve() {
    let study = study("macpherson_solve.toml", &["motion.travel=[0.0, 1.0]"]);
    let refused = Accuracy::measure(study.one_wheel().unwrap(), &NO_TIME).unwrap_err();
    let expected = Unmeasurable::FewStations {
        solved: 2,
        needed: 5,
    };
    assert_eq!(refused, expected);
}

/// The benchmark measures computing times of every topology in SIMD lanes of every available width. It also measures the times
/// of gradients, except for topologies with an instantaneous steering axis. The method of the paper applies only to struts.
#[test]
fn throughput_is_measured_by_every_way_there_is() {
    if !crate::support::has_lanes() {
        return;
    }
    let widths = Width::available().count();
    for (name, gradients, limit, paper) in [
        ("macpherson_solve.toml", 2, 1, 1),
        ("double_wishbone_solve.toml", 2, 1, 0),
        ("five_link_solve.toml", 0, 0, 0),
        ("semi_trailing_arm_solve.toml", 2, 0, 0),
    ] {
        let study = study(name, &["motion.travel=[-30.0, 0.0, 30.0]"]);
        let found = Throughput::measure(&study, 2, &NO_TIME).unwrap();
        let of = |method: &str| {
            let all = found.measurements.iter();
            all.filter(|m| m.method.starts_with(method)).count()
        };
        // One run for the motion ratio if the wheel has a spring.
        let springs = study.wheel().mechanism.spring.iter().count();
        // In lanes of each width, the benchmark measures times of angles, gains and two kinds of gradients. In the widest
        // lanes, it also measures times of angles on two CPU threads, and extra points. `limit` is 1 if the benchmark measures
        // times of poses at given arm angles, which is the fastest case.
        let expected = (2 + gradients) * widths + 2 + springs + limit;
        assert_eq!(of("lanes"), expected, "{name}");
        assert_eq!(of("point coordinates"), paper, "{name}");
        let rows = found.measurements.len();
        assert_eq!(rows, expected + paper + of("one by one"), "{name}");
        assert!(found.measurements.iter().all(|m| m.timing.median > 0.0));
    }
}

fn hardpoint(arguments: &[&str]) -> assert_cmd::assert::Assert {
    let mut program = Command::cargo_bin("hardpoint").unwrap();
    program.env("COLUMNS", "400").args(arguments).assert()
}

#[test]
fn the_command_writes_table_picture_and_circumstances() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("bench");
    let to = ["--out", out.to_str().unwrap(), "--samples", "1"];
    let said = hardpoint(&[&["bench", "effects"], &to[..]].concat()).success();
    let said = String::from_utf8(said.get_output().stdout.clone()).unwrap();
    assert!(said.contains("sensitivities to every point"), "{said}");
    let csv = std::fs::read_to_string(out.join("effects.csv")).unwrap();
    assert!(csv.starts_with("effect,alone_ns,"), "{csv}");
    let machine = std::fs::read_to_string(out.join("effects_machine.json")).unwrap();
    let machine: serde_json::Value = serde_json::from_str(&machine).unwrap();
    assert_eq!(machine["topology"], "macpherson");
    assert_eq!(machine["samples"], 1);

    let said = hardpoint(&["bench", "effects", "--out", "-", "--samples", "1"]).success();
    let csv = String::from_utf8(said.get_output().stdout.clone()).unwrap();
    assert!(csv.starts_with("effect,alone_ns,"), "{csv}");
}

/// The benchmark measures computing times for cars, and for equilibria of wheels and axles. It writes one row for each job. In
/// each row, the rate per second agrees with the time.
#[test]
fn cars_and_equilibria_are_timed() {
    for (kind, study, jobs) in [
        (
            "cars",
            "car.toml",
            &[
                "state started from its neighbour",
                "state with all results started from its neighbour",
                "state without a neighbour",
                "all results of a state",
                "member loads of a state",
                "all derivatives of the wheel loads of a state",
                "all derivatives of all results of a state",
                "tuning of the study",
                "map of 41 x 41 states with member loads on two threads",
            ][..],
        ),
        (
            "equilibria",
            "double_wishbone_compliance.toml",
            &[
                "equilibrium, started at the design position",
                "equilibrium, started at the previous load",
                "rig tests of one wheel with all derivatives",
            ],
        ),
        (
            "equilibria",
            "subframe_axle_compliance.toml",
            &[
                "equilibrium of both wheels, started at the design position",
                "equilibrium of both wheels, started at the previous load",
                "rig tests of both wheels with all derivatives",
            ],
        ),
    ] {
        let study = crate::support::studies().join(study);
        let study = study.to_str().unwrap();
        let said = hardpoint(&["bench", kind, study, "--out", "-", "--samples", "1"]).success();
        let csv = String::from_utf8(said.get_output().stdout.clone()).unwrap();
        let mut reader = csv::Reader::from_reader(csv.as_bytes());
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let names: Vec<&str> = rows.iter().map(|row| &row[0]).collect();
        let (of_lanes, own): (Vec<&str>, Vec<&str>) =
            names.into_iter().partition(|name| name.contains(" lanes"));
        assert_eq!(own, jobs, "{csv}");
        // The benchmark measures the times of an elastic wheel in SIMD lanes of every width except AVX-512. It measures the
        // times of the map of a car in one lane width.
        let widths = Width::available().filter(|width| *width != Width::Avx512);
        let is_wheel = jobs.contains(&"rig tests of one wheel with all derivatives");
        let expected = match kind {
            "cars" => 1,
            _ if is_wheel => 2 * widths.count(),
            _ => 0,
        };
        assert_eq!(of_lanes.len(), expected, "{csv}");
        for row in &rows {
            let [us, per_second] = [1, 3].map(|k| row[k].parse::<f64>().unwrap());
            assert!(us > 0.0, "{row:?}");
            assert!(
                (per_second - 1e6 / us).abs() <= 0.02 * per_second + 1.0,
                "{row:?}"
            );
        }
    }
}

#[test]
fn a_wrong_call_is_refused() {
    for (arguments, phrase) in [
        (
            &["bench", "throughput", "--samples", "99999999999"][..],
            "from 1 to 100000",
        ),
        (
            &["bench", "throughput", "--threads", "1000000"],
            "from 1 to 128",
        ),
        (&["bench", "cars", "nowhere.toml"], "does not exist"),
        (&["bench", "effects", "studies/car.toml"], "bench cars"),
        (&["bench", "equilibria"], "--with bushings"),
        (
            &["bench", "accuracy", "studies/macpherson_axle.toml"],
            "remove [axle]",
        ),
        (
            &["bench", "effects", "studies/twist_beam_solve.toml"],
            "one mechanism carries both wheels",
        ),
    ] {
        let refused = hardpoint(arguments).code(2);
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(said.contains(phrase), "{arguments:?}: {said}");
    }
    for arguments in [
        &["bench", "speed"][..],
        &["bench", "accuracy", "nowhere.toml"],
        &["bench", "accuracy", "--samples", "0"],
        &["bench", "accuracy", "--set", "motion.rack=1.0"],
        &["bench", "cars"],
        &["bench", "cars", "studies/macpherson_front.toml"],
        &["bench", "throughput", "studies/car.toml"],
        &["bench", "equilibria", "studies/macpherson_front.toml"],
        &["bench", "equilibria", "studies/macpherson_axle.toml"],
    ] {
        hardpoint(arguments).code(2);
    }
}

//! Tests of the scatter of car results against difference quotients of complete solutions, and against statistical
//! laws.

use super::commands::{hardpoint, text};
use super::{problem, usual_size};
use crate::support::studies;
use hardpoint::car::moved;
use hardpoint::study::{CarContributor, CarStudy};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

/// Sample road car with this `[tolerance]` section.
fn car(directory: &Path, tolerance: &str) -> CarStudy {
    hardpoint(directory, &["new", "car"]);
    let path = directory.join("car.toml");
    let good = fs::read_to_string(studies().join("car.toml")).unwrap();
    let (head, _) = good.split_once("[gg_map]").unwrap();
    let outputs = "[outputs]\ncharacteristics = [\"roll\", \"wheel_load\", \"camber_to_road\", \"toe\", \"roll_gradient\", \"lateral_load_transfer_distribution\"]\n";
    fs::write(&path, format!("{head}{outputs}{tolerance}")).unwrap();
    CarStudy::read(&path, &[]).unwrap_or_else(|e| panic!("{}", e.render(false)))
}

/// Rates and values of the car scatter. The first-order standard deviations equal those from difference quotients of
/// complete solutions. The shares of the variance add up to one.
#[test]
fn first_order_of_figures_is_that_of_differences() {
    let directory = tempfile::tempdir().unwrap();
    let study = car(
        directory.path(),
        r#"[tolerance]
scatter = [
  { axle = "front", rate = "spring", percent = 3.0 },
  { axle = "rear", rate = "anti_roll_bar", sigma = 2000.0 },
  { car = "mass", sigma = 15.0 },
  { car = "cg_y", limits = [-5.0, 5.0] },
]"#,
    );
    let problem = problem(&study);
    let expansion = problem.expansion().unwrap_or_else(|_| panic!("expands"));
    let mut compared = 0;
    for (number, contributor) in problem.tolerance.contributors.iter().enumerate() {
        let CarContributor::Figure { moves, law, .. } = contributor else {
            panic!("a figure");
        };
        let variable = hardpoint::car::CarVariable {
            moves: moves.clone(),
            range: [0.0, 1.0],
        };
        let now = moves.value(&study.car).unwrap();
        let step = 1e-4 * now.abs();
        let values = [-step, step].map(|step| {
            let car = moved(&study.car, std::slice::from_ref(&variable), &[now + step]);
            let mut values = vec![0.0; problem.request.results.len()];
            assert_eq!(problem.request.values(&car, &mut values).unwrap(), None);
            values
        });
        for (place, expansion) in expansion.iter().enumerate() {
            let slope = (values[1][place] - values[0][place]) / (2.0 * step);
            let sigma = expansion.variances[number].sqrt();
            let expected = slope.abs() * law.variance().sqrt();
            // Error of central differences, plus rounding errors.
            let rounding = 1e-8 * usual_size(problem.request.results[place].quantity);
            assert!(
                (sigma - expected).abs() < 1e-5 * expected + rounding,
                "{number} {place}: {sigma} {expected}"
            );
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
    let scattered = expansion.iter().filter(|own| own.sigma() != 0.0);
    assert!(scattered.clone().count() > 20);
    for expansion in scattered {
        let shares = (0..4).map(|k| expansion.share(k)).sum::<f64>();
        assert!((shares - 1.0).abs() < 1e-12);
    }
}

/// Builds with small scatter, each assembled and solved, have the first-order standard deviations. The relative
/// standard error of 400 builds is 1/sqrt(800). The bound is four standard errors. At most one value in 40 may exceed
/// this bound. The scattered parts are hardpoints, a length and a rate, on both axles.
#[test]
fn builds_confirm_the_first_order_of_parts() {
    let directory = tempfile::tempdir().unwrap();
    let study = car(
        directory.path(),
        r#"[tolerance]
builds = 400
seed = 7
scatter = [
  { axle = "front", hardpoints = ["tie_rod_inner", "lower_arm_front"], sigma = 0.05 },
  { axle = "rear", length = "toe_link", sigma = 0.05 },
  { axle = "rear", hardpoint = "toe_link_inner", axis = "z", side = "left", limits = [-0.1, 0.1] },
  { axle = "front", rate = "spring", percent = 0.1 },
]"#,
    );
    let problem = problem(&study);
    let names: Vec<&str> = problem
        .tolerance
        .contributors
        .iter()
        .map(CarContributor::name)
        .collect();
    assert_eq!(names[0], "front tie_rod_inner");
    let nominal = problem.nominal().unwrap();
    let expansion = problem.expansion().unwrap_or_else(|_| panic!("expands"));
    let builds = problem.monte_carlo(&nominal, |_| ControlFlow::Continue(()));
    assert_eq!(
        (builds.builds, builds.failed),
        (400, 0),
        "{:?}",
        builds.first_failed
    );
    let (mut far, mut count) = (0, 0);
    for (place, (expansion, spread)) in expansion.iter().zip(&builds.spreads).enumerate() {
        let sigma = expansion.sigma();
        assert!(sigma.is_finite(), "{:?}", problem.request.results[place]);
        if sigma < 1e-9 * nominal[place].abs() {
            continue;
        }
        count += 1;
        far += usize::from((spread.sigma - sigma).abs() > 4.0 / 800.0_f64.sqrt() * sigma);
        // The standard error of the mean of 400 builds is sigma/20.
        let mean = (spread.mean - nominal[place]).abs();
        assert!(mean < 5.0 / 20.0 * sigma, "{place}: {mean} {sigma}");
    }
    assert!(count > 40 && far <= count / 40, "{far} of {count}");
}

/// Scatter of the front tie rod length changes the toe of the front axle only. Both front toe angles scatter alike.
#[test]
fn both_wheels_scatter_independently_and_alike() {
    let directory = tempfile::tempdir().unwrap();
    let study = car(
        directory.path(),
        "[tolerance]\nscatter = [{ axle = \"front\", length = \"tie_rod\", sigma = 0.1 }]",
    );
    let problem = problem(&study);
    let expansion = problem.expansion().unwrap_or_else(|_| panic!("expands"));
    let sigma = |name: &str| {
        let quantity = hardpoint::car::CarQuantity::named(name)[0];
        expansion[problem.request.place(0, quantity).unwrap()].sigma()
    };
    let [left, right] = [sigma("front_left_toe"), sigma("front_right_toe")];
    // The sample's centre of gravity is 5 mm off the middle, so the wheels differ slightly.
    assert!((left - right).abs() < 0.01 * left, "{left} {right}");
    // A rod 0.1 mm longer at a lever of about 130 mm turns the wheel by 0.044 deg.
    assert!((0.02..0.1).contains(&left), "{left}");
    assert!(sigma("rear_left_toe") < 1e-3 * left);
}

/// Files and numbers of builds do not depend on the number of CPU threads. About half of the builds are within a band
/// that ends at the nominal value.
#[test]
fn the_command_is_deterministic() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let band = "[tolerance]\nbuilds = 200\nscatter = [{ car = \"cg_z\", sigma = 3.0 }]\nbands = [{ characteristic = \"roll_gradient\", case = \"static\", at_least = 0.0 }]";
    let study = car(directory, band);
    let nominal = problem(&study).nominal().unwrap();
    let place = problem(&study)
        .request
        .place(0, hardpoint::car::CarQuantity::named("roll_gradient")[0]);
    let band = band.replace(
        "at_least = 0.0",
        &format!("at_least = {}", nominal[place.unwrap()]),
    );
    car(directory, &band);
    for threads in ["1", "2"] {
        hardpoint(
            directory,
            &[
                "tolerance",
                "car.toml",
                "--out",
                threads,
                "--threads",
                threads,
            ],
        )
        .success();
    }
    for file in ["tolerance.csv", "contributors.csv", "summary.json"] {
        let [one, two] = ["1", "2"].map(|out| fs::read(directory.join(out).join(file)).unwrap());
        assert!(one == two, "{file}: {}", text(&one));
    }
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(directory.join("1/summary.json")).unwrap()).unwrap();
    let kept = summary["yield_of_all"].as_f64().unwrap();
    // Four standard deviations of a binomial share with 200 builds.
    assert!(
        (kept - 0.5).abs() < 4.0 * (0.25_f64 / 200.0).sqrt(),
        "{kept}"
    );
}

/// A symmetric car does not roll under braking, whatever its mass. So the variance of this roll angle is zero, and the
/// ranking of tolerances does not list the mass.
#[test]
fn a_result_that_does_not_scatter_ranks_nothing() {
    let directory = tempfile::tempdir().unwrap();
    car(
        directory.path(),
        r#"[tolerance]
builds = 8
scatter = [ { car = "mass", sigma = 15.0 } ]
bands = [ { case = "braking", characteristic = "roll", between = [-0.1, 0.1] } ]"#,
    );
    // Moves the sample's centre of gravity to the middle.
    let middle = "car.sprung_cg=[-1290.0, 0.0, 560.0]";
    let call = ["tolerance", "car.toml", "--format", "json", "--set", middle];
    let ended = hardpoint(directory.path(), &call);
    let said = text(&ended.success().get_output().stdout);
    let tables: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(
        tables["ranking"].as_array().map(Vec::len),
        Some(0),
        "{said}"
    );
    assert!(tables["values"][0]["linear_holds"].is_null(), "{said}");
}

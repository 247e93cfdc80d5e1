//! Tests of second-order scatter of a car against finite differences of complete solutions, and against statistical
//! laws.

use super::problem;
use hardpoint::assembly::Assembler;
use hardpoint::axle::Axle;
use hardpoint::car::{Car, CarQuantity};
use hardpoint::model::{Side, Suspension};
use hardpoint::study::{CarContributor, CarStudy};
use hardpoint::tolerance::{CarExpansion, CarProblem};
use std::ops::ControlFlow;
use std::path::Path;

/// Sample car with these results, load cases and scatter.
fn car(file: &str, results: &[&str], scatter: &str) -> CarStudy {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let results = format!("outputs.characteristics={results:?}");
    let set = [
        &results,
        scatter,
        "tolerance.builds=600",
        "tolerance.bands=[]",
    ]
    .map(str::to_owned);
    CarStudy::read(&path, &set).unwrap_or_else(|e| panic!("{}", e.render(false)))
}

fn expansion(problem: &CarProblem<'_>) -> Vec<CarExpansion> {
    problem.expansion().unwrap_or_else(|_| panic!("expands"))
}

/// Car with the given tolerance sources displaced by the given numbers of standard deviations. In these tests, each
/// contributor has one random number.
fn moved(problem: &CarProblem<'_>, steps: &[(usize, f64)]) -> Car {
    let mut car = problem.study.car.clone();
    for axle in [0, 1] {
        let scatter = &problem.tolerance.axles[axle].scatter;
        if scatter.is_empty() {
            continue;
        }
        let wheel = |side: Side| -> Suspension {
            let assembler = Assembler::new(problem.study.car.axles[axle].suspension(side)).unwrap();
            let mut parts = assembler.drawn().clone();
            for (contributor, step) in steps {
                let CarContributor::Part {
                    axle: own, number, ..
                } = problem.tolerance.contributors[*contributor]
                else {
                    continue;
                };
                if own != axle {
                    continue;
                }
                let [source] = &scatter[number].sources[..] else {
                    panic!("one random number");
                };
                let changes = match source.side {
                    Some(of) if of != side => &source.seen_from_other,
                    None if side == Side::Right => &source.seen_from_other,
                    _ => &source.changes,
                };
                let size = step * source.law.variance().sqrt();
                for (parameter, share) in changes {
                    parts.change(&assembler.suspension().mechanism, *parameter, share * size);
                }
            }
            let mut built = assembler.suspension().clone();
            assembler.assemble(&parts, 0.0, &mut built.design).unwrap();
            built
        };
        car.axles[axle] = Axle {
            left: wheel(Side::Left),
            right: Some(wheel(Side::Right)),
            setup: car.axles[axle].setup.clone(),
            elastic: None,
        };
    }
    for (contributor, step) in steps {
        if let CarContributor::Figure { moves, law, .. } =
            &problem.tolerance.contributors[*contributor]
        {
            let now = moves.value(&car).unwrap();
            moves.apply(now + step * law.variance().sqrt(), &mut car);
        }
    }
    car
}

fn values(problem: &CarProblem<'_>, steps: &[(usize, f64)]) -> Vec<f64> {
    let mut values = vec![f64::NAN; problem.request.results.len()];
    let car = moved(problem, steps);
    assert_eq!(problem.request.values(&car, &mut values).unwrap(), None);
    values
}

/// Second derivatives along one tolerance source, or along the sum of two, times the squared standard deviation. The
/// function computes finite differences of sixth order with two steps: half and a quarter of a standard deviation. The
/// two results give a finite difference of eighth order and an estimate of its error.
fn bends(problem: &CarProblem<'_>, sources: &[usize]) -> Vec<[f64; 2]> {
    let by = |h: f64| -> Vec<f64> {
        let at = |step: i32| {
            let steps: Vec<_> = sources.iter().map(|k| (*k, f64::from(step) * h)).collect();
            values(problem, &steps)
        };
        let weights = [2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0];
        let mut sums = vec![0.0; problem.request.results.len()];
        for (step, weight) in (-3..).zip(weights) {
            for (sum, value) in sums.iter_mut().zip(at(step)) {
                *sum += weight / (180.0 * h * h) * value;
            }
        }
        sums
    };
    let (coarse, fine) = (by(0.5), by(0.25));
    let pairs = coarse.iter().zip(&fine);
    pairs
        .map(|(coarse, fine)| {
            let change = (fine - coarse) / 63.0;
            [fine + change, change.abs()]
        })
        .collect()
}

/// Compares the second-order terms with finite differences, for two single tolerance sources and for the pair. Returns
/// two counts: results with a second derivative far above the rounding errors, and results without second-order terms.
fn compare(study: &CarStudy) -> [usize; 2] {
    let problem = problem(study);
    let nominal = problem.nominal().unwrap();
    let expansion = expansion(&problem);
    let [first, other, together] = [&[0][..], &[1], &[0, 1]].map(|along| bends(&problem, along));
    let mut counts = [0; 2];
    for (place, found) in expansion.iter().enumerate() {
        let of = problem.request.results[place];
        let name = format!("{} {}", of.quantity.name(), study.cases[of.case].name);
        let [mean, growth] = found.estimate.second;
        if mean.is_nan() {
            assert!(of.quantity.info().is_rate, "{name}");
            counts[1] += 1;
            continue;
        }
        let ([one, a], [two, b], [both, c]) = (first[place], other[place], together[place]);
        let mixed = 0.5 * (both - one - two);
        let expected = [
            0.5 * (one + two),
            0.5 * (one * one + two * two) + mixed * mixed,
        ];
        // Solutions have rounding errors of about 1e-13 times the largest number in a result. The absolute weights of
        // the difference formula add up to 8/h^2, where h is the step.
        let unit = if name.contains("load") { 4000.0 } else { 1.0 };
        let size = nominal[place].abs().max(unit);
        let error = 4.0 * (a + b + c) + 2e-13 * size * 8.0 / (0.25 * 0.25);
        let largest = one.abs() + two.abs() + mixed.abs() + error;
        assert!(
            (mean - expected[0]).abs() < error,
            "{name}: {mean} {expected:?} {error:e}"
        );
        assert!(
            (growth - expected[1]).abs() < 4.0 * largest * error,
            "{name}: {growth} {expected:?} {error:e}"
        );
        counts[0] += usize::from(one.abs().min(two.abs()).max(mixed.abs()) > 100.0 * error);
    }
    counts
}

/// The second derivatives of states, of their acceleration derivatives and of the heave since rest equal finite
/// differences. The tolerance sources are parts of both axles, rates and car values, including pairs of different
/// kinds.
#[test]
fn second_order_is_that_of_complete_solutions() {
    let results = [
        "roll",
        "wheel_load",
        "toe",
        "camber_to_road",
        "roll_gradient",
        "pitch_gradient",
        "roll_centre_height",
        "jacking_heave",
        "lateral_load_transfer_distribution_local",
        "body_roll_stiffness",
        "ride_frequency",
        "camber_gradient",
    ];
    let pairs = [
        "{axle=\"front\",length=\"tie_rod\",sigma=0.4,side=\"left\"},\
         {axle=\"front\",hardpoint=\"lower_arm_rear\",axis=\"z\",sigma=0.6,side=\"left\"}",
        "{axle=\"front\",length=\"tie_rod\",sigma=0.4,side=\"right\"},\
         {axle=\"rear\",hardpoint=\"toe_link_inner\",axis=\"z\",sigma=0.6,side=\"left\"}",
        "{axle=\"rear\",length=\"toe_link\",sigma=0.4,side=\"left\"},\
         {axle=\"front\",rate=\"spring\",percent=2.0}",
        "{car=\"mass\",sigma=20.0},{car=\"wheelbase\",sigma=10.0}",
    ];
    for pair in pairs {
        let study = car(
            "studies/car.toml",
            &results,
            &format!("tolerance.scatter=[{pair}]"),
        );
        let [curved, unknown] = compare(&study);
        assert!(curved > 20 && unknown == 0, "{pair}: {curved} {unknown}");
    }
}

/// The second-order terms of cars with solid axles equal finite differences of complete solutions. One of the axles is
/// steered by a drag link. Derivatives of a state, here the roll gradient, have no second-order terms for these axles.
#[test]
fn second_order_of_solid_axles_is_that_of_complete_solutions() {
    let results = [
        "roll",
        "steer",
        "wheel_load",
        "roll_centre_height",
        "roll_gradient",
    ];
    let pairs = [
        "{axle=\"front\",length=\"tie_rod\",sigma=0.5},\
         {axle=\"front\",hardpoint=\"drag_link_body\",axis=\"z\",sigma=2.0}",
        "{axle=\"rear\",hardpoint=\"lower_link_chassis\",axis=\"z\",side=\"left\",sigma=1.0},\
         {axle=\"front\",rate=\"spring\",percent=2.0}",
    ];
    for pair in pairs {
        let study = car(
            "studies/off_road_car.toml",
            &results,
            &format!("tolerance.scatter=[{pair}]"),
        );
        let [curved, unknown] = compare(&study);
        let cases = study.cases.len();
        assert!(
            curved > 10 && unknown == cases,
            "{pair}: {curved} {unknown}"
        );
    }
}

/// If the centre of gravity moves sideways, the car sinks by the square of this displacement. So the first order is
/// zero in the middle. The second order then equals the whole shift of the mean and the whole variance of many builds,
/// within four standard errors.
#[test]
fn builds_confirm_the_second_order() {
    let path = crate::support::studies().join("car.toml");
    let set = [
        "outputs.characteristics=[\"heave\",\"pitch\",\"roll\",\"body_roll_stiffness\"]",
        "car.sprung_cg=[-1290.0,0.0,560.0]",
        "tolerance={builds=1200,scatter=[{car=\"cg_y\",sigma=20.0}]}",
    ];
    let study = CarStudy::read(&path, &set.map(str::to_owned))
        .unwrap_or_else(|e| panic!("{}", e.render(false)));
    let problem = problem(&study);
    let nominal = problem.nominal().unwrap();
    let builds = problem.monte_carlo(&nominal, |_| ControlFlow::Continue(()));
    assert_eq!(builds.failed, 0, "{:?}", builds.first_failed);
    let expansion = expansion(&problem);
    for name in ["heave", "pitch", "body_roll_stiffness"] {
        let place = problem
            .request
            .place(0, CarQuantity::named(name)[0])
            .unwrap();
        let (spread, estimate) = (&builds.spreads[place], expansion[place].estimate);
        let [mean, growth] = estimate.second;
        // A slope that is exactly zero is computed as about 1e-12, because of rounding errors of the state.
        assert!(
            estimate.sigma() < 1e-6 * growth.sqrt(),
            "{name}: {estimate:?}"
        );
        let shift = spread.mean - nominal[place];
        let error = spread.sigma / (spread.count as f64).sqrt();
        assert!((shift - mean).abs() < 4.0 * error, "{name}: {shift} {mean}");
        assert!(mean.abs() > 10.0 * error, "{name}: {mean} {error}");
        let apart = (spread.sigma - growth.sqrt()).abs();
        assert!(
            apart < 4.0 * spread.sigma_error,
            "{name}: {spread:?} {growth}"
        );
    }
    let roll = problem
        .request
        .place(0, CarQuantity::named("roll")[0])
        .unwrap();
    assert!(expansion[roll].scatters && expansion[roll].estimate.is_straight() == Some(true));
}

/// A single tolerance source with second derivative H and variance s^2 adds H s^2/2 to the mean and H^2 s^4 (k - 1)/4
/// to the variance. The kurtosis k is 3 for a normal and 9/5 for a uniform distribution. On a symmetric car, a left
/// part shifts the results of the whole car as much as the equal right part.
#[test]
fn laws_and_sides_enter_as_in_statistics() {
    let middle = "car.cg=[-1290.0,0.0,560.0]";
    let second = |scatter: &str| -> Vec<[f64; 2]> {
        let path = crate::support::studies().join("car.toml");
        let results = "outputs.characteristics=[\"pitch\",\"heave\",\"roll_gradient\"]".to_owned();
        let scatter = format!("tolerance={{scatter=[{scatter}]}}");
        let middle = middle.replace("car.cg", "car.sprung_cg");
        let study = CarStudy::read(&path, &[results, scatter, middle])
            .unwrap_or_else(|e| panic!("{}", e.render(false)));
        let found = expansion(&problem(&study));
        let results = problem(&study).request.results;
        let of = |quantity: CarQuantity| {
            let at = |r: &&hardpoint::car::CaseResult| r.case == 0 && r.quantity == quantity;
            let place = results.iter().position(|r| at(&r)).unwrap();
            found[place].estimate.second
        };
        let names = ["pitch", "heave", "roll_gradient"];
        names.map(|name| of(CarQuantity::named(name)[0])).to_vec()
    };
    let half = 3.0_f64.sqrt() * 2.0;
    let tie_rod = |side: &str, law: &str| {
        second(&format!(
            "{{axle=\"front\",length=\"tie_rod\",side=\"{side}\",{law}}}"
        ))
    };
    let normal = tie_rod("left", "sigma=2.0");
    let uniform = tie_rod("left", &format!("limits=[{},{half}]", -half));
    let right = tie_rod("right", "sigma=2.0");
    for k in 0..normal.len() {
        let [mean, growth] = normal[k];
        assert!(mean.abs() > 1e-12 && growth > 0.0, "{normal:?}");
        let close = |a: f64, b: f64, to: f64| (a - b).abs() < to * b.abs();
        assert!(
            close(uniform[k][0], mean, 1e-12),
            "{k}: {uniform:?} {normal:?}"
        );
        assert!(
            close(uniform[k][1], 0.4 * growth, 1e-12),
            "{k}: {uniform:?} {normal:?}"
        );
        // The bound covers the rounding errors of a state with a few kilonewtons, and of the second derivatives of this
        // state.
        assert!(close(right[k][0], mean, 1e-6), "{k}: {right:?} {normal:?}");
    }
}

/// A symmetric car in straight driving has no roll and no lateral load transfer, whatever its mass, springs and
/// longitudinal centre of gravity. The computed first-order scatter of both is only rounding error, and the program
/// reports that they do not scatter. Loads and pitch scatter.
#[test]
fn what_vanishes_by_symmetry_does_not_scatter() {
    let path = crate::support::studies().join("car.toml");
    let set = [
        "outputs.characteristics=[\"roll\",\"lateral_load_transfer\",\"lateral_load_transfer_front_elastic\",\
         \"axle_side_force\",\"mean_steer\",\"roll_centre_lateral\",\"wheel_load\",\"pitch\"]",
        "car.sprung_cg=[-1290.0,0.0,560.0]",
        "tolerance={builds=4,scatter=[{car=\"mass\",sigma=15.0},{axle=\"front\",rate=\"spring\",percent=3.0},\
         {car=\"cg_x\",sigma=10.0}]}",
    ];
    let study = CarStudy::read(&path, &set.map(str::to_owned))
        .unwrap_or_else(|e| panic!("{}", e.render(false)));
    let problem = problem(&study);
    let expansion = expansion(&problem);
    let mut counts = [0; 2];
    for (result, found) in problem.request.results.iter().zip(&expansion) {
        let case = &study.cases[result.case];
        if case.ay != 0.0 || case.racks != [0.0; 2] {
            continue;
        }
        let name = result.quantity.name();
        let scatters = name.contains("wheel_load") || name == "pitch";
        assert_eq!(found.scatters, scatters, "{} {name}: {found:?}", case.name);
        counts[usize::from(scatters)] += 1;
    }
    assert!(counts[0] > 8 && counts[1] > 8, "{counts:?}");
}

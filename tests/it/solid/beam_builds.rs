//! Tests of builds of twist beams against an independent formulation (`built_beam.rs`).

use super::built_beam::{HEAVE, Parts, ROLL, study, study_of};
use super::differences::{assert_gradients, assert_second_order, scatter_at, values_of};
use super::own::{Point, mirror};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::{Axle, AxleQuantity as A, AxleSolver, Placement, Quantity, WheelParts as _};
use hardpoint::number::Width;
use hardpoint::study::{Study, Vehicle};
use hardpoint::tolerance::{Expansion, Problem, monte_carlo, monte_carlo_in};
use std::ops::ControlFlow;
use std::path::Path;

fn axle_of(vehicle: Vehicle) -> Axle {
    match vehicle {
        Vehicle::Axle(both) => both.axle,
        Vehicle::Wheel(_) => panic!("an axle"),
    }
}

/// Returns the largest differences of wheel centres and of spin axes between the program and the independent formulation.
fn apart(axle: &Axle, parts: &Parts, travels: [f64; 2]) -> [f64; 2] {
    let wanted = [Quantity::Axle(A::BeamTwist), Quantity::Axle(A::MeanSteer)];
    let mut solver = AxleSolver::<2>::new(axle, &wanted, false).unwrap();
    let placement = Placement::Travels {
        travels,
        rack: 0.0,
        on_plane: false,
    };
    let placed = solver.place(&placement).unwrap();
    let read = solver.read(&placed).unwrap();
    let x = parts.solved(travels);
    let mut worst = [0.0_f64; 2];
    for (side, wheel) in read.state.wheels().into_iter().enumerate() {
        let own = |v: Point| if side == 0 { v } else { mirror(v) };
        let found = [
            own(wheel.reading.centre().to_array()),
            own(wheel.reading.spin_axis().to_array()),
        ];
        for (k, (found, expected)) in found.iter().zip(parts.wheel(&x, side)).enumerate() {
            for (found, expected) in found.iter().zip(expected) {
                worst[k] = larger(worst[k], (found - expected).abs());
            }
        }
    }
    worst
}

fn problem(study: &Study) -> Problem<'_> {
    Problem::of(study, study.tolerance.as_ref().unwrap()).unwrap()
}

const ALL: &str = "[tolerance]\nscatter = [{ hardpoints = [\"mount\", \"wheel_centre\", \"spindle_inner\"], sigma = 1.5 }, \
                   { hardpoint = \"shear_centre\", sigma = 1.5 }]\n";

/// In forty builds with deviations of millimetres, the wheels have the same positions as in the independent formulation.
/// The test compares them at rest and at two other positions.
#[test]
fn builds_are_two_rigid_bodies_on_their_mounts() {
    let study = study(HEAVE, ALL);
    assert_eq!(study.tolerance.as_ref().unwrap().sources(), 2 * 9 + 3);
    let problem = problem(&study);
    let mut generator = Random(171);
    let mut worst = [0.0_f64; 2];
    for build in 0..40 {
        let axle = axle_of(problem.built_vehicle(build).unwrap());
        let parts = Parts::of_build(&study, build);
        let moved = [(); 2].map(|()| 60.0 * generator.signed());
        for travels in [[0.0; 2], moved] {
            let own = apart(&axle, &parts, travels);
            worst = [0, 1].map(|k: usize| larger(worst[k], own[k]));
        }
    }
    println!("{worst:?}");
    // Residuals are a few rounding errors of coordinates of 700 mm, with a condition number below 1e3. Axes are computed
    // from points 100 mm apart.
    assert!(worst[0] < 1e-9, "{:e} mm", worst[0]);
    assert!(worst[1] < 1e-10, "{:e}", worst[1]);
}

/// The mechanisms of the left and the right wheel describe the same build.
#[test]
fn both_wheels_see_the_same_build() {
    let study = study(HEAVE, ALL);
    let problem = problem(&study);
    for build in 0..5 {
        let [left, right] = &problem.built_wheels(build).unwrap()[..] else {
            panic!("two wheels");
        };
        for near in ["mount", "shear_centre", "wheel_centre", "spindle_inner"] {
            let far = match near {
                "shear_centre" => near.to_owned(),
                _ => format!("right_{near}"),
            };
            for [name, other] in [[near, &far], [&far, near]] {
                let place = |own: &hardpoint::model::Suspension, name: &str| {
                    own.design[own.mechanism.point(name).unwrap().0].to_array()
                };
                let (own, seen) = (place(left, name), mirror(place(right, other)));
                for (a, b) in own.iter().zip(seen) {
                    assert!((a - b).abs() < 1e-9, "{name}: {own:?} {seen:?}");
                }
            }
        }
    }
}

/// A build that is printed as a study equals the build. The study has both points of the hinge, and its curves are those
/// of the build.
#[test]
fn printed_builds_are_the_builds() {
    let study = study(ROLL, ALL);
    let problem = problem(&study);
    for build in [0, 3] {
        let text = problem.built_text(build).unwrap();
        let printed = Study::from_text("built.toml", &text, Path::new(""));
        let printed = printed.unwrap_or_else(|e| panic!("{e}\n{text}"));
        let suspension = printed.wheel();
        let place = |name| suspension.design[suspension.mechanism.point(name).unwrap().0];
        let along = place("hinge_end") - place("shear_centre");
        assert!(along.x.abs() > 0.05 && along.y > 300.0, "{along:?}");
        let curves = |vehicle: &Vehicle| {
            let both = match vehicle {
                Vehicle::Axle(both) => both,
                Vehicle::Wheel(_) => panic!("an axle"),
            };
            hardpoint::axle::axle_curves(&both.axle, &both.plan)
                .unwrap()
                .curves
        };
        let (own, other) = (
            curves(&problem.built_vehicle(build).unwrap()),
            curves(&printed.vehicle),
        );
        assert_eq!(own.stations.len(), other.stations.len());
        for (k, column) in own.columns.iter().enumerate() {
            assert_eq!(column.name, other.columns[k].name);
            for (a, b) in own.stations.iter().zip(&other.stations) {
                let (a, b) = (a.value(k).unwrap(), b.value(k).unwrap());
                assert!((a - b).abs() < 1e-8, "{}: {a} {b}", column.name);
            }
        }
    }
}

/// Values of a beam whose parts deviate by these amounts, by output and station.
fn built(motion: &str, steps: &[(&str, f64)]) -> Vec<Vec<f64>> {
    let scatter = scatter_at(steps);
    let scatter = format!("[tolerance]\nbuilds = 2\nscatter = [{scatter}]\n");
    let study = study(motion, &scatter);
    let problem = problem(&study);
    let Vehicle::Axle(both) = problem.built_vehicle(0).unwrap() else {
        panic!("an axle");
    };
    let curves = hardpoint::axle::axle_curves(&both.axle, &both.plan)
        .unwrap()
        .curves;
    values_of(&problem, &curves)
}

const ENTRIES: [&str; 8] = [
    r#"hardpoint = "mount", axis = "x", side = "left""#,
    r#"hardpoint = "mount", axis = "y", side = "right""#,
    r#"hardpoint = "mount", axis = "z", side = "right""#,
    r#"hardpoint = "shear_centre", axis = "x""#,
    r#"hardpoint = "shear_centre", axis = "z""#,
    r#"hardpoint = "wheel_centre", axis = "x", side = "right""#,
    r#"hardpoint = "wheel_centre", axis = "z", side = "left""#,
    r#"hardpoint = "spindle_inner", axis = "x", side = "right""#,
];

/// Gradients with respect to every part equal difference quotients (fourth order) of builds that are solved one by one.
#[test]
fn gradients_are_slopes_of_builds() {
    let scatter: Vec<String> = ENTRIES
        .iter()
        .map(|part| format!("{{ {part}, sigma = 0.1 }}"))
        .collect();
    let study = study(
        ROLL,
        &format!("[tolerance]\nscatter = [{}]\n", scatter.join(", ")),
    );
    let problem = problem(&study);
    let looked_at = assert_gradients(&problem, &ENTRIES, &|steps| built(ROLL, steps));
    assert!(looked_at > 15 * ENTRIES.len(), "{looked_at}");
}

/// The second-order contribution equals the one from finite differences between builds. The test covers three motions: a
/// roll angle of the ground, given travels on a plane ground, and heave on pads. The contribution is unknown for
/// quantities made of velocities.
#[test]
fn second_order_is_that_of_builds() {
    let motions = [
        "roll = [2.0]\nheave = [-20.0]\n",
        "travel_left = [-20.0]\ntravel_right = [30.0]\nground = \"plane\"\n",
        "heave = [30.0]\n",
    ];
    let sigma = 3.0;
    let mut all = 0;
    for pair in [[0, 4], [2, 7]] {
        let parts = pair.map(|k: usize| ENTRIES[k]);
        let scatter = parts.map(|part| format!("{{ {part}, sigma = {sigma:?} }}"));
        for motion in motions {
            let study = study(
                motion,
                &format!("[tolerance]\nscatter = [{}]\n", scatter.join(", ")),
            );
            let problem = problem(&study);
            let built = |steps: &[(&str, f64)]| built(motion, steps);
            all +=
                assert_second_order(&problem, parts, sigma, &["roll_steer", "anti_lift"], &built);
        }
    }
    assert!(all >= 16, "{all}");
}

/// SIMD lanes and single builds give the same values. The bits do not depend on the number of CPU threads. For small
/// scatter, the standard deviation of the builds is the first-order result.
#[test]
fn builds_are_the_same_in_lanes_and_one_by_one() {
    if !crate::support::has_lanes() {
        return;
    }
    assert!(Width::available().next().is_some());
    let on = |_: u64| ControlFlow::Continue(());
    let narrow = ALL
        .replace("1.5", "0.1")
        .replace("[tolerance]\n", "[tolerance]\nbuilds = 200\n");
    // SIMD lanes support these outputs.
    let outputs = r#""camber", "toe", "mean_steer", "track""#;
    let study = study_of(ROLL, outputs, &narrow);
    let problem = problem(&study);
    assert_eq!(problem.not_in_lanes(), None);
    let drawn = problem.drawn().unwrap();
    let on_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap()
            .install(|| monte_carlo(&problem, &drawn, on).unwrap())
    };
    let (one, three) = (on_threads(1), on_threads(3));
    assert_eq!(one.rejected(), 0);
    assert_eq!(one.spreads, three.spreads);
    let single = monte_carlo_in(None, &problem, &drawn, on).unwrap();
    let expansion = Expansion::of(&problem).unwrap();
    let mut looked_at = 0;
    for (cell, (a, b)) in one.spreads.iter().zip(&single.spreads).enumerate() {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + b.abs());
        assert!(
            near(a.mean, b.mean) && near(a.sigma, b.sigma),
            "{a:?} {b:?}"
        );
        let linear = expansion.variance[cell].sqrt();
        assert!(linear.is_finite());
        if linear > 1e-9 {
            let off = (a.sigma - linear).abs();
            let column = &problem.outputs()[cell / problem.stations().count()].name;
            assert!(
                off < 0.01 * linear + 4.5 * a.sigma_error,
                "{column}: {a:?} {linear}"
            );
            looked_at += 1;
        }
    }
    // There are six outputs at three stations.
    assert!(looked_at >= 16, "{looked_at}");
}

/// Scatter of the hinge point along the hinge line has no effect, because the line stays the same.
#[test]
fn a_shear_centre_has_no_place_along_its_line() {
    let study = study(
        ROLL,
        "[tolerance]\nscatter = [{ hardpoint = \"shear_centre\", axis = \"y\", sigma = 1.0 }]\n",
    );
    let problem = problem(&study);
    let expansion = Expansion::of(&problem).unwrap();
    assert!(expansion.variance.len() > 20);
    for (cell, variance) in expansion.variance.iter().enumerate() {
        let column = &problem.outputs()[cell / problem.stations().count()].name;
        assert!(variance.sqrt() < 1e-9, "{column}: {variance:e}");
    }
}

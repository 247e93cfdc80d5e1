//! Tests of tolerances of solid axles. First-order and second-order results are compared with builds that are solved one
//! by one and with Monte Carlo analyses.

use super::differences::{assert_gradients, assert_second_order, scatter_at, values_of};
use super::kinds::{KINDS, Kind};
use hardpoint::axle::axle_curves;
use hardpoint::study::Study;
use hardpoint::tolerance::{Expansion, Problem, monte_carlo};
use std::ops::ControlFlow;
use std::path::Path;

const OUTPUTS: &str = r#""camber", "toe", "mean_steer", "track", "axle_steer", "pinion_angle", "axle_lateral", "roll_steer", "force_roll_centre_height", "anti_squat""#;
const ROLL: &str = "roll = [-2.0, 0.0, 1.5]\nheave = [-20.0]\n";

fn problem(study: &Study) -> Problem<'_> {
    Problem::of(study, study.tolerance.as_ref().unwrap()).unwrap()
}

/// Scattered parts, with one random number each.
fn entries(kind: &Kind) -> Vec<&'static str> {
    let mut entries = vec![
        r#"hardpoint = "lower_link_axle", axis = "z", side = "left""#,
        r#"hardpoint = "lower_link_chassis", axis = "y", side = "right""#,
        r#"hardpoint = "wheel_centre", axis = "x", side = "right""#,
        r#"hardpoint = "wheel_centre", axis = "z", side = "left""#,
        r#"length = "lower_link", side = "right""#,
    ];
    entries.extend(match kind.name {
        "four links and an anti-roll bar" => &[
            r#"hardpoint = "upper_link_axle", axis = "y", side = "left""#,
            r#"length = "upper_link", side = "left""#,
        ][..],
        "Panhard rod, drag link and tie rod" => &[
            r#"hardpoint = "panhard_axle", axis = "y""#,
            r#"hardpoint = "kingpin_upper", axis = "y", side = "right""#,
            r#"hardpoint = "tie_rod_end", axis = "x", side = "left""#,
            r#"hardpoint = "drag_link_body", axis = "z""#,
            r#"length = "upper_link""#,
            r#"length = "drag_link""#,
            r#"length = "tie_rod""#,
        ],
        _ => &[
            r#"hardpoint = "watt_pivot", axis = "z""#,
            r#"hardpoint = "watt_upper_rocker", axis = "y""#,
            r#"length = "watt_upper""#,
            r#"length = "watt_lower""#,
        ],
    });
    entries
}

/// Returns the values of an axle whose parts deviate by these amounts, in the order of outputs and stations. The axle is
/// a build that is printed as a study.
fn built(kind: &Kind, motion: &str, steps: &[(&str, f64)]) -> Vec<Vec<f64>> {
    let study = kind.study_of((&scatter_at(steps), "builds = 2\n"), motion, OUTPUTS);
    let problem = problem(&study);
    let text = problem.built_text(0).unwrap();
    let printed = Study::from_text("built.toml", &text, Path::new("."));
    let both = printed
        .unwrap_or_else(|e| panic!("{e}"))
        .axle()
        .unwrap()
        .clone();
    let curves = axle_curves(&both.axle, &both.plan).unwrap().curves;
    values_of(&problem, &curves)
}

/// Gradients with respect to every part equal difference quotients (fourth order) of builds that are solved one by one.
#[test]
fn gradients_are_slopes_of_builds() {
    for kind in KINDS {
        let entries = entries(kind);
        let scatter: Vec<String> = entries
            .iter()
            .map(|part| format!("{{ {part}, sigma = 0.1 }}"))
            .collect();
        let study = kind.study_of((&scatter.join(", "), ""), ROLL, OUTPUTS);
        let problem = problem(&study);
        let looked_at = assert_gradients(&problem, &entries, &|steps| built(kind, ROLL, steps));
        assert!(looked_at > 20 * entries.len(), "{}: {looked_at}", kind.name);
    }
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
    for kind in KINDS {
        let all = entries(kind);
        let parts = [all[0], all[all.len() - 1]];
        let scatter: Vec<String> = parts
            .iter()
            .map(|part| format!("{{ {part}, sigma = {sigma:?} }}"))
            .collect();
        for motion in motions {
            let study = kind.study_of((&scatter.join(", "), ""), motion, OUTPUTS);
            let problem = problem(&study);
            // The last station of the motion has a steer angle if the axle is steered.
            let of_velocities = ["roll_steer", "force_roll", "anti_squat"];
            let built = |steps: &[(&str, f64)]| built(kind, motion, steps);
            let looked_at = assert_second_order(&problem, parts, sigma, &of_velocities, &built);
            assert!(looked_at >= 4, "{}, {motion}: {looked_at}", kind.name);
        }
    }
}

/// For small scatter, the first-order standard deviations agree with those of the Monte Carlo analysis.
#[test]
fn first_order_is_the_monte_carlo_where_scatter_is_small() {
    for kind in KINDS {
        let study = kind.study_of((&kind.scatter(0.05), "builds = 200\n"), ROLL, OUTPUTS);
        let problem = problem(&study);
        let expansion = Expansion::of(&problem).unwrap();
        let drawn = problem.drawn().unwrap();
        let on = |_| ControlFlow::Continue(());
        let found = monte_carlo(&problem, &drawn, on).unwrap();
        let mut looked_at = 0;
        for (cell, spread) in found.spreads.iter().enumerate() {
            let column = &problem.outputs()[cell / problem.stations().count()].name;
            let linear = expansion.variance[cell].sqrt();
            // In the rest position, an output that is measured from this position varies only by a second-order effect
            // of the ground.
            if linear < 1e-9 {
                assert!(spread.sigma < 1e-6, "{}, {column}: {spread:?}", kind.name);
                continue;
            }
            let off = (spread.sigma - linear).abs();
            assert!(
                off < 0.01 * linear + 4.5 * spread.sigma_error,
                "{}, {column}: {spread:?} {linear}",
                kind.name
            );
            // Five standard errors of the mean of 200 builds.
            assert!((spread.mean - drawn[cell]).abs() < 0.36 * linear);
            looked_at += 1;
        }
        // There are twelve outputs at three stations or more.
        assert!(looked_at > 24, "{}: {looked_at}", kind.name);
    }
}

/// Left and right parts scatter independently: scatter of one half gives half the variance of scatter in both halves. A
/// part that exists once has one random number, and the program refuses a side for it.
#[test]
fn halves_scatter_by_themselves_and_single_parts_once() {
    let steered = KINDS.iter().find(|kind| kind.is_steered()).unwrap();
    let variances = |scatter: &str| {
        let study = steered.study(scatter, "");
        let problem = problem(&study);
        let expansion = Expansion::of(&problem).unwrap();
        (
            study.tolerance.as_ref().unwrap().sources(),
            expansion.variance,
        )
    };
    let part = |more: &str| {
        variances(&format!(
            "{{ hardpoint = \"lower_link_axle\", axis = \"z\", sigma = 0.2{more} }}"
        ))
    };
    let (both, left, right) = (
        part(""),
        part(", side = \"left\""),
        part(", side = \"right\""),
    );
    assert_eq!([both.0, left.0, right.0], [2, 1, 1]);
    for (cell, both) in both.1.iter().enumerate() {
        let sum = left.1[cell] + right.1[cell];
        assert!((both - sum).abs() < 1e-12 * sum, "{both} {sum}");
    }
    let once = "{ hardpoint = \"panhard_axle\", sigma = 0.2 }, { length = \"tie_rod\", sigma = 0.1 }, \
        { jig = [\"drag_link_body\", \"panhard_chassis\"], shift = 0.1 }";
    assert_eq!(variances(once).0, 3 + 1 + 3);
    let study = steered.study(once, "");
    let refused = |entry: &str| {
        let text = study.text.replace(once, entry);
        Study::from_text("solid.toml", &text, Path::new("."))
            .unwrap_err()
            .to_string()
    };
    let sided = refused("{ length = \"tie_rod\", sigma = 0.1, side = \"left\" }");
    assert!(
        sided.contains("the axle has only one tie_rod length: remove the key \"side\""),
        "{sided}"
    );
    let mixed = refused("{ jig = [\"panhard_axle\", \"lower_link_axle\"], shift = 0.1 }");
    assert!(mixed.contains("a jig holds points of one half"), "{mixed}");
    let far = refused("{ length = \"right_lower_link\", sigma = 0.1 }");
    assert!(far.contains("unknown member"), "{far}");
}

//! Tests of targets and bands of an axle in `[motions.NAME]`.

use super::tuning::{evaluate, layout, study};
use super::with;
use crate::support::{larger, one_line};
use hardpoint::optimise::Control;
use hardpoint::study::Study;
use hardpoint::tolerance::{Expansion, Problem};
use nalgebra::DVector;

/// Motions of each kind, with the keys of a target in them.
const MOTIONS: [(&str, &str); 5] = [
    (
        "{ heave = [-30.0, 0.0, 30.0] }",
        "characteristic = \"bump_steer\"",
    ),
    (
        "{ roll = [-2.0, 0.0, 2.0], heave = [0.0, 10.0] }",
        "characteristic = \"camber_to_road\", over = \"roll\", heave = [0.0, 10.0]",
    ),
    (
        "{ travel_left = [-20.0, 0.0, 20.0], travel_right = 5.0 }",
        "characteristic = \"toe\", side = \"left\"",
    ),
    (
        "{ travel_left = [-10.0, 10.0], travel_right = -10.0, ground = \"plane\" }",
        "characteristic = \"roll_centre_height\"",
    ),
    (
        "{ heave = 10.0, steering_wheel_angle = [-90.0, 0.0, 90.0] }",
        "characteristic = \"ackermann_error\"",
    ),
];

/// A target in a named motion has the same residuals and derivatives as the same target in `[motion]`, bit for bit.
#[test]
fn a_target_in_a_named_motion_has_the_rows_of_the_same_motion() {
    let given = study("macpherson_axle_front", &[]);
    for (motion, target) in MOTIONS {
        let wanted = |more: &str| {
            format!(
                "optimise.targets=[{{ {target}, between = [-0.001, 0.001], tolerance = 0.1{more} }}]"
            )
        };
        let own = with(&given, &[&format!("motion={motion}"), &wanted("")]).unwrap();
        let named = format!("motions.other={motion}");
        let named = with(&given, &[&named, &wanted(", motion = \"other\"")]).unwrap();
        let x = DVector::from_element(own.optimise.as_ref().unwrap().variables.len(), 2.0);
        let [own, named] = [own, named].map(|study| evaluate(&study, &layout(&study), &x));
        assert!(
            own.residuals.len() > 1 && own.residuals.amax() > 0.0,
            "{motion}"
        );
        assert!(own.jacobian.amax() > 0.0, "{motion}");
        assert_eq!(own.residuals, named.residuals, "{motion}");
        assert_eq!(own.jacobian, named.jacobian, "{motion}");
    }
}

/// Largest absolute value of a column over the curves of a study.
fn most(study: &Study, column: &str) -> f64 {
    let curves = study.curves().unwrap();
    let place = curves.columns.iter().position(|own| own.name == column);
    let place = place.unwrap_or_else(|| panic!("no {column}"));
    let values = curves
        .stations
        .iter()
        .map(|s| s.values[place].unwrap().abs());
    values.fold(0.0, larger)
}

/// One tuning meets two targets: a camber in roll and a bump steer in heave. The curves of both motions show the target
/// values.
#[test]
fn one_tuning_meets_targets_in_two_motions() {
    let given = study("macpherson_axle_front", &[]);
    let study = with(
        &given,
        &[
            "motion={ heave = 0.0, steering_wheel_angle = [-60.0, 0.0, 60.0] }",
            "motions.bump={ heave = [-30.0, -15.0, 0.0, 15.0, 30.0] }",
            "motions.turn={ roll = [-2.0, -1.0, 0.0, 1.0, 2.0] }",
            "outputs.characteristics=[\"bump_steer\", \"roll_steer\", \"camber_to_road\"]",
            "optimise.starts=1",
            "optimise.targets=[\
             { characteristic = \"bump_steer\", motion = \"bump\", between = [-0.001, 0.001], tolerance = 0.0002 },\
             { characteristic = \"camber_to_road\", motion = \"turn\", over = \"roll\", between = [-2.1, 2.1], tolerance = 0.02 }]",
        ],
    )
    .unwrap();
    let value =
        |study: &Study, motion: &str, column: &str| most(&study.in_motion(motion).unwrap(), column);
    assert!(value(&study, "bump", "left_bump_steer_deg_per_mm") > 0.002);
    assert!(value(&study, "turn", "right_camber_to_road_deg") > 2.15);
    let best = study.tune(Control::default()).unwrap().best.unwrap();
    assert!(best.after.misfit < 0.11, "{}", best.after.misfit);
    let tuned = study.moved(&best.offsets);
    for side in ["left", "right"] {
        let bump = value(&tuned, "bump", &format!("{side}_bump_steer_deg_per_mm"));
        assert!(bump < 0.001 + 0.0002, "{bump}");
        let camber = value(&tuned, "turn", &format!("{side}_camber_to_road_deg"));
        assert!(camber < 2.1 + 0.02, "{camber}");
    }
}

/// A band limits the same values in `[motion]` as in an equal named motion. The derivatives with respect to the scatter
/// are also equal.
#[test]
fn a_band_in_a_named_motion_limits_the_values_of_the_same_motion() {
    let given = study("macpherson_axle", &[]);
    let scatter = "{ hardpoint = \"tie_rod_outer\", sigma = 0.4 }";
    for (motion, target) in MOTIONS {
        let (characteristic, rest) = target.split_once(',').unwrap_or((target, ""));
        let rest = if rest.is_empty() {
            String::new()
        } else {
            format!(",{rest}")
        };
        let tolerance = |more: &str| {
            format!(
                "tolerance={{ builds = 2, scatter = [{scatter}], bands = [{{ {characteristic}{rest}, at_most = 1.0{more} }}] }}"
            )
        };
        let own = with(&given, &[&format!("motion={motion}"), &tolerance("")]).unwrap();
        let named = format!("motions.other={motion}");
        let named = with(&given, &[&named, &tolerance(", motion = \"other\"")]).unwrap();
        let slopes = |study: &Study| {
            let problem = Problem::of(study, study.tolerance.as_ref().unwrap()).unwrap();
            let nominal = problem.drawn().unwrap();
            let expansion = Expansion::of(&problem).unwrap();
            let cells = problem.cells_of_bands().next().unwrap();
            let cells = cells.into_iter();
            cells
                .map(|cell| (nominal[cell], expansion.gradient(cell).to_vec()))
                .collect::<Vec<_>>()
        };
        let (own, named) = (slopes(&own), slopes(&named));
        assert!(own.len() > 1, "{motion}");
        assert_eq!(own.len(), named.len());
        for ((value, slopes), (other, others)) in own.iter().zip(&named) {
            assert!((value - other).abs() < 1e-13, "{motion}: {value} {other}");
            let size = slopes
                .iter()
                .fold(0.0_f64, |most, slope| larger(most, slope.abs()));
            for (slope, other) in slopes.iter().zip(others) {
                assert!(
                    (slope - other).abs() <= 1e-12 * size,
                    "{motion}: {slope} {other}"
                );
            }
        }
    }
}

/// A band with a motion and without a position applies to all stations of the motion.
#[test]
fn a_band_may_apply_to_a_whole_named_motion() {
    let given = study("macpherson_axle", &[]);
    let tolerance = |more: &str| {
        format!(
            "tolerance={{ builds = 2, scatter = [{{ hardpoint = \"tie_rod_outer\", sigma = 0.4 }}], bands = [{{ characteristic = \"mean_steer\", at_most = 1.0{more} }}] }}"
        )
    };
    let motion =
        "{ roll = [-2.0, 0.5, 2.0], heave = [-10.0, 10.0], steering_wheel_angle = [-45.0, 45.0] }";
    let values = |study: &Study| {
        let problem = Problem::of(study, study.tolerance.as_ref().unwrap()).unwrap();
        let nominal = problem.drawn().unwrap();
        let cells = problem.cells_of_bands().next().unwrap().into_iter();
        let mut values: Vec<f64> = cells.map(|cell| nominal[cell]).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let own = with(&given, &[&format!("motion={motion}"), &tolerance("")]).unwrap();
    let named = format!("motions.other={motion}");
    let named = with(&given, &[&named, &tolerance(", motion = \"other\"")]).unwrap();
    let (own, named) = (values(&own), values(&named));
    assert_eq!((own.len(), named.len()), (12, 12));
    for (own, named) in own.iter().zip(named) {
        assert!((own - named).abs() < 1e-12, "{own} {named}");
    }
}

#[test]
fn motions_that_a_target_cannot_have_are_refused() {
    let given = study("macpherson_axle_front", &[]);
    let target = |more: &str| {
        format!(
            "optimise.targets=[{{ characteristic = \"toe\", between = [-1.0, 1.0], tolerance = 0.1, {more} }}]"
        )
    };
    let refused = |edits: &[&str], said: &str| {
        let error = with(&given, edits).unwrap_err();
        let error = one_line(&error);
        assert!(error.contains(said), "{error}");
    };
    let turn = "motions.turn={ roll = [-1.0, 1.0] }";
    refused(
        &[&target("motion = \"turn\"")],
        "no named motions of the axle",
    );
    refused(&[turn, &target("motion = \"turm\"")], "turn");
    refused(
        &[
            "motions.wheel={ travel = [-1.0, 1.0] }",
            &target("motion = \"wheel\""),
        ],
        "the motion wheel moves the left wheel alone",
    );
    // The rack alone is an error of the motion. It is the only error, also if a target names the motion.
    let steered = ["motions.steered={ rack = [0.0, 5.0] }"];
    let of_target = target("motion = \"steered\"");
    for edits in [&steered[..], &[steered[0], &of_target]] {
        refused(edits, "add heave = 0.0 to steer both wheels");
        let error = with(&given, edits).unwrap_err();
        assert_eq!(error.matches("error: ").count(), 1, "{error}");
    }
    refused(
        &[turn, &target("motion = \"turn\", travel_left = 3.0")],
        "the motion turn has roll, heave, rack, but no travel_left",
    );
    refused(
        &[turn, &target("motion = \"turn\", at = 4.0")],
        "4 is outside of the motion",
    );
    let wheel = study("macpherson_axle_front", &[]).text;
    let head = wheel.split("[axle]").next().unwrap();
    let text = format!(
        "{head}[motion]\ntravel = [-10.0, 10.0]\n[motions.m]\ntravel = [0.0, 5.0]\n\
         [tolerance]\nscatter = [{{ hardpoint = \"tie_rod_outer\", sigma = 0.4 }}]\n\
         bands = [{{ characteristic = \"toe\", at_most = 1.0, motion = \"m\" }}]\n"
    );
    let error = Study::from_text("wheel.toml", &text, std::path::Path::new(".")).unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("a band of one wheel applies to [motion]"),
        "{error}"
    );
}

//! Tests of side effects of tunings of axles.

use super::*;

/// On an axle in heave, a target for the bump steer of both wheels requests the slope of each wheel's toe, and of the sum.
#[test]
fn a_gain_of_an_axle_asks_for_the_slope_of_both_wheels() {
    let overrides = [
        "motion={ heave = { from = -20.0, to = 20.0, steps = 9 }, steering_wheel_angle = [0.0] }",
        "outputs.characteristics=[\"toe\", \"total_toe\"]",
        "optimise.targets=[{ characteristic = \"bump_steer\", over = \"heave\", at = 0.0, value = 0.01, tolerance = 0.0001 }]",
        "optimise.variables=[{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }]",
        "optimise.side_effects=true",
    ];
    let (before, after, effects) = tuned("macpherson_axle_front", &overrides);
    for output in ["left_toe_deg", "total_toe_deg"] {
        let [was, is] = [&before, &after].map(|study| axle_values(study, output));
        let changes = was
            .iter()
            .zip(&is)
            .map(|(a, b)| (b.unwrap() - a.unwrap()).abs());
        let whole = changes.fold(0.0, larger);
        let name = output.trim_end_matches("_deg").trim_start_matches("left_");
        let effect = named(&effects, name);
        assert!(
            effect.asked_change.abs() > 0.8 * whole && whole > 0.02,
            "{effect:?}"
        );
        assert!(
            effect.largest_change.unwrap().abs() < 0.2 * whole,
            "{effect:?}"
        );
    }
}

/// If both wheels of an axle have a quantity, it has one row, for the worse wheel. Toe is compared at zero steer.
#[test]
fn an_axle_has_one_row_for_both_wheels() {
    let few = [
        "optimise.starts=1",
        "motion.roll=[-2.0, 0.0, 2.0]",
        "motion.heave=[-40.0, 0.0, 40.0]",
        "motion.steering_wheel_angle=[-360.0, 0.0, 360.0]",
        "outputs.characteristics=[\"camber\", \"roll_steer\"]",
        "optimise.targets=[{ characteristic = \"ackermann_error\", over = \"steering_wheel_angle\", between = [-0.5, 0.5], tolerance = 0.1 }]",
    ];
    let (before, after, effects) = tuned("macpherson_axle_front", &few);
    let curves = |study: &Study| {
        let both = study.axle().unwrap();
        hardpoint::axle::axle_curves(&both.axle, &both.plan)
            .unwrap()
            .curves
    };
    let (was, is) = (curves(&before), curves(&after));
    let mut worst = 0.0_f64;
    for (from, to) in was.stations.iter().zip(&is.stations) {
        for column in [0, 1] {
            assert!(was.columns[column].name.ends_with("camber_deg"));
            worst = larger(
                worst,
                (to.value(column).unwrap() - from.value(column).unwrap()).abs(),
            );
        }
    }
    let camber = named(&effects, "camber");
    assert!((camber.largest_change.unwrap().abs() - worst).abs() < 1e-9);
    assert!(
        camber
            .wheel
            .as_deref()
            .is_some_and(|w| w == "left" || w == "right")
    );
    let toe = named(&effects, "toe");
    let steered = toe.at.iter().find(|c| c.name == "steering_wheel_angle");
    assert!(steered.is_none_or(|c| c.value == 0.0), "{toe:?}");
    assert!(toe.before_max.unwrap() < 2.0, "{toe:?}");
    for output in [
        "roll_steer",
        "wheel_roll_steer",
        "scrub_radius",
        "half_track_change",
    ] {
        named(&effects, output);
    }
    // The target applies at 9 of 27 stations. The change at the nearest of these 9 stations is allowed at another
    // station. Only a larger change is a side effect.
    named(&effects, "ackermann_error");
    // In roll the kinematic roll centre can move without bounds; the force-based roll centre cannot.
    let kinematic = named(&effects, "roll_centre_height");
    assert!(kinematic.tolerance.is_none() && !kinematic.flagged);
    let by_forces = named(&effects, "force_roll_centre_height");
    assert_eq!(by_forces.tolerance, Some(1.0));
}

/// Values of a quantity of an axle at all stations.
fn axle_values(study: &Study, column: &str) -> Vec<Option<f64>> {
    let curves = study.curves().unwrap();
    let number = curves
        .columns
        .iter()
        .position(|c| c.name == column)
        .unwrap();
    curves.stations.iter().map(|s| s.value(number)).collect()
}

/// The tolerance of a turning circle is 1 % of its value, at the station with the largest relative change. If an
/// Ackermann quantity has a target, the steer angles must change, so the turning circle is not flagged. The lateral roll
/// centre is not flagged, because it moves without bounds in roll.
#[test]
fn turning_circles_are_judged_relative_to_their_size() {
    let with = |target: &str| {
        let optimise = format!(
            "optimise={{ variables = [{{ hardpoint = \"tie_rod_outer\", axis = \"x\", range = [-10.0, 10.0] }}], \
             targets = [{target}] }}"
        );
        let before = study(
            "double_wishbone_axle",
            &[
                &optimise,
                "motion={ roll = [-2.0, 0.0, 2.0], steering_wheel_angle = [20.0, 60.0, 120.0] }",
                "outputs.characteristics=[\"turning_circle\", \"roll_centre_lateral\"]",
            ],
        );
        let after = before.moved(&[4.0]);
        let effects = side_effects(&before, &after).unwrap();
        (before, after, effects)
    };
    let toe =
        "{ characteristic = \"toe\", over = \"roll\", at = 0.0, value = 0.0, tolerance = 0.1 }";
    let (before, after, effects) = with(toe);
    let column = "turning_circle_mm";
    let pairs = axle_values(&before, column)
        .into_iter()
        .zip(axle_values(&after, column));
    let shares = pairs.filter_map(|(from, to)| Some((to? - from?, from?)));
    let (change, from) = shares
        .max_by(|a, b| (a.0 / a.1).abs().total_cmp(&(b.0 / b.1).abs()))
        .unwrap();
    let circle = named(&effects, "turning_circle");
    assert!((circle.largest_change.unwrap() - change).abs() < 1e-6 * change.abs());
    assert!((circle.tolerance.unwrap() - 0.01 * from).abs() < 1e-9 * from);
    assert!(circle.flagged && change.abs() > 0.01 * from, "{circle:?}");
    let lateral = named(&effects, "roll_centre_lateral");
    assert!(
        lateral.tolerance.is_none() && !lateral.flagged,
        "{lateral:?}"
    );
    let asked = "{ characteristic = \"ackermann\", over = \"steering_wheel_angle\", at = 120.0, value = 50.0, tolerance = 5.0 }";
    let (.., effects) = with(asked);
    let circle = named(&effects, "turning_circle");
    assert!(circle.tolerance.is_none() && !circle.flagged, "{circle:?}");
}

/// Study of an axle with a second motion of the same kind, `other`, and a target for toe in `[motion]`. Returns the side effects
/// of a moved tie rod, and the change of the left toe at each station of `other`.
fn of_second_motion(other: &str, target: &str) -> (Vec<SideEffect>, Vec<f64>) {
    let overrides = [
        "motion={ heave = [-40.0, 0.0, 40.0] }",
        &format!("motions.other={other}"),
        "outputs.characteristics=[\"toe\"]",
        &format!(
            "optimise.targets=[{{ characteristic = \"toe\", over = \"heave\", {target}, value = 0.0, tolerance = 0.1 }}]"
        ),
        "optimise.variables=[{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }]",
    ];
    let before = study("macpherson_axle_front", &overrides);
    let after = before.moved(&[5.0]);
    let [was, is] = [&before, &after]
        .map(|study| axle_values(&study.in_motion("other").unwrap(), "left_toe_deg"));
    let changes = was.iter().zip(&is).map(|(a, b)| b.unwrap() - a.unwrap());
    (side_effects(&before, &after).unwrap(), changes.collect())
}

/// A target for one wheel requests a change of this wheel alone, also over a named motion. There, the same change of the other
/// wheel is a side effect.
#[test]
fn a_target_of_one_wheel_asks_for_nothing_at_the_other() {
    for (side, other) in [("left", "right"), ("right", "left")] {
        let target = format!("side = \"{side}\", at = 40.0");
        let (effects, changes) = of_second_motion("{ heave = [20.0, 30.0] }", &target);
        let toe = named(&effects, "toe, other");
        assert_eq!(toe.wheel.as_deref(), Some(other), "{toe:?}");
        let whole = changes
            .iter()
            .fold(0.0, |most, change| larger(most, change.abs()));
        assert!(
            whole > 0.05 && (toe.largest_change.unwrap().abs() - whole).abs() < 1e-9,
            "{toe:?} {whole}"
        );
        assert!(
            (toe.asked_change.abs() - whole).abs() < 1e-9,
            "{toe:?} {whole}"
        );
    }
}

/// A target in `[motion]` does not apply to the nearest station of a named motion. This station is compared, too.
#[test]
fn a_target_of_the_motion_is_not_moved_to_a_named_motion() {
    let (effects, changes) = of_second_motion("{ heave = [-20.0, -10.0, 10.0] }", "at = 40.0");
    let toe = named(&effects, "toe, other");
    // In jounce the change has the direction of the requested change, and is smaller. In rebound it has the other direction.
    assert!(
        changes[0] * changes[2] < 0.0 && changes[2].abs() > 0.01,
        "{changes:?}"
    );
    assert!(
        (toe.asked_change - changes[2]).abs() < 1e-9,
        "{toe:?} {changes:?}"
    );
    assert!(
        (toe.largest_change.unwrap() - changes[0]).abs() < 1e-9,
        "{toe:?} {changes:?}"
    );
}

/// A constraint of an axle in the design position allows a change there. The same change at other heights is no side effect.
#[test]
fn a_constraint_of_an_axle_counts_as_a_target() {
    let overrides = |constraints: &'static str| {
        [
            "motion={ heave = [-40.0, 0.0, 40.0] }",
            "outputs.characteristics=[\"camber\"]",
            "optimise.targets=[{ characteristic = \"toe\", over = \"heave\", at = 0.0, value = 0.0, tolerance = 0.1 }]",
            "optimise.variables=[{ hardpoint = \"spindle_inner\", axis = \"z\", range = [-20.0, 20.0] }]",
            constraints,
        ]
    };
    let effect = |constraints| {
        let before = study("macpherson_axle_front", &overrides(constraints));
        let after = before.moved(&[1.0]);
        let [was, is] = [&before, &after].map(|study| axle_values(study, "left_camber_deg"));
        let whole = (is[1].unwrap() - was[1].unwrap()).abs();
        assert!(whole > 0.5, "{whole}");
        (
            whole,
            named(&side_effects(&before, &after).unwrap(), "camber").clone(),
        )
    };
    let (whole, free) = effect("optimise.constraints=[]");
    assert!(
        free.largest_change.unwrap().abs() > whole - 1e-9,
        "{free:?}"
    );
    let (whole, limited) = effect(
        "optimise.constraints=[{ characteristic = \"camber\", at = \"design\", at_most = 1.0 }]",
    );
    assert!(
        limited.largest_change.unwrap().abs() < 0.1 * whole,
        "{limited:?}"
    );
    assert!(
        (limited.asked_change.abs() - whole).abs() < 0.1 * whole,
        "{limited:?}"
    );
}

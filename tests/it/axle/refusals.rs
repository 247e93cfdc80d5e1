//! Tests of refusals and warnings of the commands with studies of axles.

use super::commands::{folder, run, study};
use crate::support::one_line;

#[test]
fn what_is_not_there_for_an_axle_is_refused_by_name() {
    let path = study("macpherson_axle.toml");
    let path = path.to_str().unwrap();
    for (command, why) in [
        ("tolerance", "the section [tolerance] is missing"),
        ("setup", "the section [setup] is missing"),
        ("kc", "of an axle needs stations on level pads"),
    ] {
        let (_, said) = run(&[command, path], 2);
        assert!(said.contains(why), "{command}: {said}");
    }
    let (said, _) = run(&["limits", path], 0);
    assert!(
        said.contains("roll_deg") && said.contains("left wheel:"),
        "{said}"
    );
    for (set, words) in [
        ("motion.travel=1.0", "travel drives one wheel only"),
        (
            "motion.travel_left=1.0",
            "roll keeps the mean travel constant",
        ),
        ("motion.ground=\"pads\"", "expected ground = \"plane\""),
        ("motion.rack=1.0", "both give the rack"),
        ("outputs.points=[\"wheel_center\"]", "unknown point"),
        ("outputs.knuckle=true", "but order is \"position\""),
        (
            "outputs.order=\"acceleration\"",
            "contains second derivatives",
        ),
        ("steering.c_factor=0.0", "never moves the rack"),
        ("vehicle.position=\"middle\"", "unknown position"),
        (
            "spring.force_curve=[[0.0, 1.0], [0.0, 2.0]]",
            "force_curve already gives the spring",
        ),
        (
            "bump_stop.force_curve=[[0.0, 1.0]]",
            "expected two or more pairs",
        ),
        ("axle.right=\"copied\"", "expected \"mirrored\" or a table"),
        (
            "outputs.characteristics=[\"rol_steer\"]",
            "did you mean \"roll_steer\"?",
        ),
    ] {
        let (_, said) = run(&["check", path, "--set", set], 2);
        assert!(said.contains(words), "{set}: {said}");
    }
    let corner = study("macpherson_solve.toml");
    let corner = corner.to_str().unwrap();
    let (_, said) = run(&["check", corner, "--set", "motion.roll=1.0"], 2);
    assert!(said.contains("roll needs [axle]"), "{said}");
}

/// Messages of a run, joined into one line.
fn said(arguments: &[&str], sets: &[&str], code: i32) -> String {
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let arguments: Vec<&str> = arguments.iter().copied().chain(sets).collect();
    let (out, err) = run(&arguments, code);
    one_line(&format!("{out} {err}"))
}

/// Every incomplete station comes with a message that names the wheel. The message names the wheel whose drop link is
/// at toggle, or the wheel that reaches the end of the rack first. `limits` names the same wheel.
#[test]
fn what_an_axle_lacks_is_said_with_the_wheel() {
    let (path, out) = (study("macpherson_axle.toml"), folder("lacking"));
    let [path, out] = [&path, &out].map(|p| p.to_str().unwrap());
    let solved = |sets: &[&str]| said(&["solve", path, "--out", out, "--force"], sets, 1);
    let few = "outputs.characteristics=[\"camber\", \"roll_stiffness\"]";
    let stuck = solved(&[few, "motion={ roll = [0.0, -20.0, 20.0, 25.0] }"]);
    for side in ["left", "right"] {
        let warning =
            format!("warning: the {side} wheel's drop link is at toggle or beyond it at ");
        assert!(stuck.contains(&warning), "{stuck}");
    }
    assert!(
        stuck.contains("it cannot turn the anti-roll bar any further there"),
        "{stuck}"
    );
    // Both tie rods reach their limit at mirrored rack displacements, so the nearer limit may belong to either wheel.
    let few = "outputs.characteristics=[\"camber\"]";
    for motion in ["heave = 0.0", "roll = 1.0"] {
        for (rack, side, sign) in [("-300", "left", "-"), ("300", "right", "")] {
            let motion = format!("motion={{ {motion}, rack = [0.0, {rack}] }}");
            let end = format!(
                "rack {rack} mm: {side} wheel: the rack moves no further than {sign}113.32"
            );

            let found = solved(&[few, &motion]);
            assert!(found.contains(&end) && found.contains(" mm: "), "{found}");
        }
    }
    let found = solved(&[few, "motion={ travel_left = 500.0, travel_right = 0.0 }"]);
    let end = "left wheel at travel 500.000000 mm: the wheel travel ends at 349.667807 mm: ";
    assert!(found.contains(end), "{found}");

    // A sweep reports the reasons without numbers. It also explains why it omits the effects of the variables.
    let swept = |sets: &[&str]| {
        let variable =
            "{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-1.0, 1.0], steps = 2 }";
        let sweep = format!("sweep={{ method = \"grid\", variables = [{variable}] }}");
        said(
            &["sweep", path, "--out", out, "--force"],
            &[sets, &[&sweep]].concat(),
            1,
        )
    };
    let found = swept(&[few, "motion={ heave = 0.0, rack = [0.0, 300.0] }"]);
    assert!(
        found.contains("right wheel: the rack cannot move further:"),
        "{found}"
    );
    let found = swept(&[few, "motion={ roll = [0.0, 60.0] }"]);
    assert!(
        found.contains(
            "there is no difference of the travels at which both wheels touch the ground"
        ),
        "{found}"
    );
    let few = "outputs.characteristics=[\"camber\", \"ackermann\"]";
    let found = swept(&[few, "motion={ heave = [0.0, 10.0] }"]);
    let why = "Main effects are not known: they need designs that have a value for every output, \
               and no design has all values; leave out ackermann to get them.";
    assert!(found.contains(why), "{found}");
}

/// Commands that handle one wheel either refuse an axle or report that they show only one wheel.
#[test]
fn what_knows_one_wheel_does_not_pass_for_the_axle() {
    let path = study("five_link_axle.toml");
    let path = path.to_str().unwrap();
    // An export contains both wheels if they differ. Rounding is available only for a wheel and its mirror image.
    let table = said(&["export", path, "--to", "csv"], &[], 0);
    for row in ["toe_link_inner,-180.0,345.0", "toe_link_inner,-180.0,-"] {
        assert!(table.contains(row), "{table}");
    }
    let adams = said(&["export", path, "--to", "adams"], &[], 0);
    for row in [
        "'toe_link_inner ' 'left ' 180.0 -345.0 262.0",
        "'toe_link_inner ' 'right ' 180.0 347.0 262.0",
    ] {
        assert!(adams.contains(row), "{adams}");
    }
    let round = said(&["export", path, "--to", "csv", "--round", "1"], &[], 2);
    assert!(round.contains("axle.right: --round needs"), "{round}");
    let path = study("macpherson_axle.toml");
    let (mirrored, _) = run(&["export", path.to_str().unwrap(), "--to", "adams"], 0);
    assert!(!mirrored.contains("'right     '"), "{mirrored}");
}

/// The program warns of a hardpoint of the right wheel whose y is on the left wheel's side.
#[test]
fn a_right_hardpoint_at_the_left_is_doubted() {
    let path = study("five_link_axle.toml");
    let path = path.to_str().unwrap();
    let doubt = "please check: right wheel: toe_link_inner is at the left wheel's side";
    let own = said(&["check", path], &[], 0);
    assert!(!own.contains("please check"), "{own}");
    let set = "axle.right.hardpoints.toe_link_inner=[-180.0, 347.0, 262.0]";
    let own = said(&["check", path], &[set], 0);
    assert!(own.contains(doubt), "{own}");
}

#[test]
fn mistakes_in_targets_of_an_axle_are_named() {
    let path = study("macpherson_axle_front.toml");
    let path = path.to_str().unwrap();
    let target = |text: &str| {
        format!("optimise.targets=[{{ {text}, at = 0.0, value = 0.0, tolerance = 1.0 }}]")
    };
    for (text, words) in [
        (
            "characteristic = \"mean_steer\"",
            "expected over = one of roll, heave, steering_wheel_angle",
        ),
        (
            "characteristic = \"mean_steer\", over = \"roll\", roll = 1.0",
            "so roll cannot have a fixed value",
        ),
        (
            "characteristic = \"mean_steer\", over = \"rack\"",
            "unknown over \"rack\"",
        ),
        (
            "characteristic = \"mean_steer\", over = \"roll\", travel_left = 1.0",
            "but no travel_left",
        ),
        (
            "characteristic = \"track\", side = \"left\", over = \"roll\"",
            "belongs to the axle",
        ),
        (
            "characteristic = \"wheel_load\", over = \"roll\"",
            "wheel_load needs [spring]",
        ),
        (
            "point = \"wheel_centre\", axis = \"z\", over = \"roll\"",
            "point is available for one wheel only",
        ),
        (
            "characteristic = \"roll_ster\", over = \"roll\"",
            "did you mean \"roll_steer\"?",
        ),
    ] {
        let (_, said) = run(&["check", path, "--set", &target(text)], 2);
        assert!(said.contains(words), "{text}: {said}");
    }
    let constraint = "optimise.constraints=[{ characteristic = \"camber\", at_most = 1.0 }]";
    let (_, said) = run(&["check", path, "--set", constraint], 2);
    assert!(said.contains("expected motion = \"NAME\""), "{said}");
    let motion = "motions.wheel={ travel = [0.0], heave = 3.0 }";
    let (_, said) = run(&["check", path, "--set", motion], 2);
    assert!(said.contains("travel drives one wheel only"), "{said}");
    let corner = study("macpherson_front.toml");
    let over = "optimise.targets=[{ characteristic = \"camber\", over = \"roll\", at = 0.0, value = 0.0, tolerance = 1.0 }]";
    let (_, said) = run(&["check", corner.to_str().unwrap(), "--set", over], 2);
    assert!(said.contains("over needs [axle]"), "{said}");
}

#[test]
fn a_c_factor_of_the_wrong_sign_is_doubted() {
    let path = study("macpherson_axle.toml");
    let path = path.to_str().unwrap();
    let doubt = "turn against the steering wheel";
    let (said, _) = run(&["check", path], 0);
    assert!(!said.contains(doubt), "{said}");
    let (said, _) = run(&["check", path, "--set", "steering.c_factor=52.0"], 0);
    assert!(said.contains(doubt), "{said}");
}

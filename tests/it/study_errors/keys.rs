//! Tests of keys without effect and of old keys.

use super::*;

/// A key that would have no effect is refused.
#[test]
fn keys_without_effect_are_refused() {
    let sample = |name: &str, from: &str, to: &str| {
        let text = crate::support::sample(name);
        assert_eq!(text.matches(from).count(), 1, "{name}: {from}");
        text.replace(from, to)
    };
    let single = "single = [\"upper_link\"]";
    let named = |topology: &str| format!("topology = \"{topology}\"\n{single}");
    let strut = "topology = \"macpherson\"";
    let beam = "topology = \"twist_beam\"";
    let swept = |key: &str| format!("{GOOD}[sweep]\ndesigns = \"designs.csv\"\n{key} = 7\n");
    let of_file = &["the designs come from a file", "the file"][..];
    for (text, on, key, phrases) in [
        (
            edited(strut, &named("macpherson")),
            "single",
            "suspension.single",
            &["topology = \"solid_axle\""][..],
        ),
        (
            sample("twist_beam_solve.toml", beam, &named("twist_beam")),
            "single",
            "suspension.single",
            &["topology = \"solid_axle\""],
        ),
        (
            format!("{GOOD}[twist_beam]\ntorsional_rate = 5.0e5\n"),
            "[twist_beam]",
            "twist_beam",
            &["needs topology = \"twist_beam\""],
        ),
        (
            sample(
                "double_wishbone_axle.toml",
                "[motion]",
                "[motion]\nangle_unit = \"rad\"\n#",
            ),
            "angle_unit",
            "motion.angle_unit",
            &["angles of an axle are in degrees"],
        ),
        (swept("samples"), "samples", "sweep.samples", of_file),
        (swept("seed"), "seed", "sweep.seed", of_file),
        (
            edited("at = 0.0", "axis = \"z\", at = 0.0"),
            "bump_steer",
            "optimise.targets[1].axis",
            &["the key \"axis\" needs \"point\""],
        ),
    ] {
        assert_mistake(&text, on, key, phrases);
    }
}

/// An error in `[setup]` is the only message, although `aligned = true` needs `[setup]`.
#[test]
fn a_mistake_in_the_setup_has_no_consequences() {
    let text = format!(
        "{GOOD}[setup]\nadjust = [{{ length = \"tie_rodd\" }}]\n\
         [tolerance]\naligned = true\nscatter = [{{ hardpoint = \"tie_rod_inner\", sigma = 0.1 }}]\n"
    );
    let errors = read(&text).unwrap_err();
    let rendered = errors.render(false);
    assert_eq!(errors.all().len(), 1, "{rendered}");
    assert!(rendered.contains("did you mean \"tie_rod\"?"), "{rendered}");
}

/// Until version 0.1, this key meant wheel travel. The program refuses it now. The message proposes the key `travel`
/// with the same value, or `ride_height_change` with the opposite sign.
#[test]
fn the_old_ride_height_is_explained_with_its_own_value() {
    for (written, said) in [
        ("5.0", "write travel = 5.0 or ride_height_change = -5.0"),
        ("-0.2", "write travel = -0.2 or ride_height_change = 0.2"),
        ("7", "write travel = 7.0 or ride_height_change = -7.0"),
        ("0", "write travel = 0.0 or ride_height_change = 0.0"),
    ] {
        let setup =
            format!("[setup]\nadjust = [{{ length = \"tie_rod\" }}]\nride_height = {written}\n");
        let errors = read(&format!("{GOOD}{setup}")).unwrap_err();
        let error = &errors.all()[0];
        let lines = GOOD.matches('\n').count() + 3;
        assert_eq!(
            error.position().map(|(line, _)| line),
            Some(lines),
            "{errors}"
        );
        assert_eq!(error.path(), Some("setup.ride_height"));
        assert_eq!(
            error.message(),
            format!("until version 0.1, ride_height was the wheel travel: {said}")
        );
    }
    let setup =
        "[setup]\nadjust = [{ length = \"tie_rod\" }]\ntravel = 5.0\nride_height_change = -5.0\n";
    let errors = read(&format!("{GOOD}{setup}")).unwrap_err();
    let message = errors.all()[0].message();
    assert!(
        message.contains("expected ride_height_change or travel, found both"),
        "{errors}"
    );
    assert_eq!(errors.all()[0].path(), Some("setup.travel"));
}

/// A target in a named motion that has an error adds no second error.
#[test]
fn an_error_in_a_named_motion_is_the_only_one() {
    let at = "at = 0.0, value = 0.0, tolerance = 0.01";
    let text = edited(at, &format!("motion = \"bump\", {at}"));
    let text = format!("{text}\n[motions.bump]\nrack = 5.0\n");
    let on = "[motions.bump]";
    assert_mistake(&text, on, "motions.bump", &["expected travel"]);
}

/// `[tolerance]` refuses a motion over the arm angle. The stations of a band then give no second error.
#[test]
fn a_tolerance_over_the_arm_angle_is_the_only_error() {
    let path = crate::support::studies().join("macpherson_tolerance.toml");
    let motion = "motion={ drive = \"arm_angle\", arm_angle = [-8.0, 0.0, 8.0] }";
    let band = "tolerance.bands=[{ characteristic = \"toe\", at = 8.0, between = [0.1, 0.4] }]";
    let errors = Study::read(&path, &[motion.to_owned(), band.to_owned()]).unwrap_err();
    let said = errors.render(false);
    assert_eq!(errors.all().len(), 1, "{said}");
    assert!(said.contains("needs a motion with drive"), "{said}");
}

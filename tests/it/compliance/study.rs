//! Tests of studies with elastic parts. A message names the line and key of a mistake. A command that does not support
//! elastic parts refuses the study.

use super::support::with;
use crate::support::mutants::mutilated;
use crate::support::random::Random;
use hardpoint::compliance::KcRun;
use hardpoint::study::Study;
use std::path::Path;

const STUDIES: [&str; 2] = [
    "double_wishbone_compliance.toml",
    "five_link_compliance.toml",
];

fn text(name: &str) -> String {
    with(name, "")
}

/// Replaces `from`, which the good study contains once, by `to`. Asserts that the study then has exactly one mistake,
/// on the line that contains `on`.
fn assert_mistake(from: &str, to: &str, on: &str, phrase: &str) {
    let good = text(STUDIES[0]);
    assert_eq!(good.matches(from).count(), 1, "{from:?}");
    let text = good.replace(from, to);
    let errors = Study::elastic_from_text("study.toml", &text, Path::new(".")).unwrap_err();
    let rendered = errors.render(false);
    assert_eq!(errors.all().len(), 1, "{rendered}");
    let (line, _) = errors.all()[0].position().unwrap();
    let found = text.lines().nth(line - 1).unwrap();
    assert!(found.contains(on), "{found:?}: {rendered}");
    assert!(rendered.contains(phrase), "{rendered}");
}

const REAR: &str = "stiffness = [700.0, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]";
const RELAXED: &str = "relaxed = \"at_design_load\"   # the hardpoints describe the loaded car";
const SPRING: &str = "[spring]\nrate = 90.0       # N/mm along the spring\nforce = 7000.0    # N in the design position\n";

#[test]
fn mistakes_in_bushings_are_named_by_line() {
    let with = |more: &str| format!("{REAR}\n{more}");
    for (from, to, on, phrase) in [
        (
            "[bushings.lower_arm_rear]",
            "[bushings.lower_arm_raer]",
            "raer",
            "did you mean \"lower_arm_rear\"",
        ),
        (
            REAR,
            "stiffness = [700.0, 2500.0]",
            "[700.0, 2500.0]",
            "expected six numbers",
        ),
        (
            REAR,
            "stiffness = [-700.0, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]",
            "-700",
            "expected a number of 0 or more",
        ),
        (
            REAR,
            "cubic = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]",
            "[bushings.lower_arm_rear]",
            "or the six curves",
        ),
        (
            REAR,
            &with("fy = [[-1.0, -2000.0], [1.0, 2000.0]]"),
            "fy",
            "expected 0.0 as entry 2",
        ),
        (
            REAR,
            &with("file = \"rear.bus\""),
            "stiffness = [700.0",
            "remove the key stiffness",
        ),
        (
            REAR,
            &with("x_axis = [0.0, 0.0, 1.0]"),
            "[bushings.lower_arm_rear]",
            "expected z_axis",
        ),
        (
            REAR,
            "stiffness = [-2e12, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]",
            "-2e12",
            "expected a number with a magnitude of at most 1e12",
        ),
    ] {
        assert_mistake(from, to, on, phrase);
    }
}

#[test]
fn mistakes_in_parts_are_named_by_line() {
    for (from, to, on, phrase) in [
        (RELAXED, "", "[compliance]", "expected the key \"relaxed\""),
        (
            RELAXED,
            "relaxed = \"slack\"",
            "slack",
            "expected \"free\" or \"at_design_load\"",
        ),
        (SPRING, "", "[compliance]", "needs [spring]"),
        (
            "[tyre]",
            "[subframe]\ncarries = []\nmounts = { front = [0.0, 300.0, 200.0] }\n[tyre]",
            "[subframe]",
            "needs [axle]",
        ),
        (
            "[tyre]",
            "[links.lower_arm_front]\naxial_stiffness = 1e5\n[tyre]",
            "[links.lower_arm_front]",
            "expected one of them",
        ),
        (
            "[tyre]",
            "[links.tie_rod]\nmodulus = 70000.0\n[tyre]",
            "[links.tie_rod]",
            "modulus and area",
        ),
        (
            "[tyre]",
            "[links.tie_rod]\nmodulus = 70000.0\narea = 100.0\naxial_stiffness = 1.0e5\n[tyre]",
            "[links.tie_rod]",
            "found both",
        ),
    ] {
        assert_mistake(from, to, on, phrase);
    }
}

#[test]
fn mistakes_in_tests_are_named_by_line() {
    for (added, on, phrase) in [
        (
            "tests = [{ load = \"laterl\" }]",
            "laterl",
            "did you mean \"lateral\"",
        ),
        (
            "tests = [{ load = \"heave\", window = 3.0 }]",
            "window",
            "is a motion",
        ),
        (
            "tests = [{ load = \"braking\", levels = 4 }]",
            "levels",
            "an odd number",
        ),
        (
            "tests = [{ load = \"braking\", mode = \"parallel\" }]",
            "parallel",
            "it needs [axle]",
        ),
        ("tests = [{ load = \"roll\" }]", "roll", "it needs [axle]"),
        ("anti_roll_bar = \"connected\"", "connected", "needs [axle]"),
        (
            "tests = [{ load = \"vertical\", hold = \"wheel_height\" }]",
            "hold",
            "moves the wheel",
        ),
    ] {
        assert_mistake(RELAXED, &format!("{RELAXED}\n{added}"), on, phrase);
    }
}

/// If no test of the study gives a requested result, the message names the test to add. It does not call the result's
/// name unknown, and does not suggest another spelling.
#[test]
fn figures_without_their_test_are_named_with_it() {
    let refusal = |study: &str, tests: &str, outputs: &str| {
        let text = text(study);
        let kept = text.lines().scan(false, |is_list, line| {
            // The list of tests ends with the first line that ends with a bracket.
            let begins = line.starts_with("tests = [");
            let skips = begins || *is_list;
            *is_list = skips && !line.trim_end().ends_with(']');
            Some((!skips && !line.starts_with("characteristics = ")).then_some(line))
        });
        let kept: Vec<&str> = kept.flatten().collect();
        let text = kept.join("\n").replacen(
            "[compliance]",
            &format!("[compliance]\ntests = [{tests}]"),
            1,
        );
        let characteristics = format!("[outputs]\ncharacteristics = [\"{outputs}\"]");
        let text = if text.contains("[outputs]") {
            text.replacen("[outputs]", &characteristics, 1)
        } else {
            format!("{text}\n{characteristics}\n")
        };
        let read = Study::elastic_from_text("study.toml", &text, Path::new("."));
        read.map(|_| ()).unwrap_err().render(false)
    };
    let braking = "{ load = \"braking\" }";
    let (wheel, axle) = (STUDIES[0], "solid_axle_five_links.toml");
    for (study, tests, figure, phrases) in [
        (
            wheel,
            braking,
            "toe_by_lateral_force_trail_30",
            [
                "no test of the study gives a result",
                "add { load = \"lateral\", trail = 30 } to tests",
            ],
        ),
        (
            wheel,
            braking,
            "toe_by_latteral_force",
            [
                "did you mean \"toe_by_lateral_force\"",
                "load = \"lateral\"",
            ],
        ),
        (
            wheel,
            braking,
            "steer_by_roll",
            ["no test of the study", "it needs [axle]"],
        ),
        (
            axle,
            braking,
            "panhard_tension",
            ["no test of the study", "add { load = \"roll\" } to tests"],
        ),
        (
            axle,
            braking,
            "toe_by_braking_opposed",
            ["no test of the study", "mode = \"opposed\""],
        ),
    ] {
        let said = refusal(study, tests, figure);
        assert!(phrases.iter().all(|p| said.contains(p)), "{figure}: {said}");
    }
}

/// A strut turns freely about its line. So the program refuses stiffness, constant torque and a property file's torque
/// about this line.
#[test]
fn nothing_acts_about_the_line_of_a_strut() {
    let good = text("macpherson_compliance.toml");
    let directory = tempfile::tempdir().unwrap();
    let curve = |name: &str| format!("[{name}_CURVE]\n-1.0 -900.0\n1.0 900.0\n");
    let curves = ["FX", "FY", "FZ", "TX", "TY", "TZ"].map(curve).concat();
    let units = "[UNITS]\nLENGTH = 'mm'\nANGLE = 'degrees'\nFORCE = 'newton'\n";
    std::fs::write(directory.path().join("top.bus"), format!("{units}{curves}")).unwrap();
    let (before, after) = good.split_once("[bushings.strut_top]\n").unwrap();
    let (own, rest) = after.split_once('\n').unwrap();
    for more in [
        &format!("{own}\npreload = [0.0, 0.0, 0.0, 0.0, 0.0, 5.0e6]"),
        "file = \"top.bus\"",
    ] {
        let text = format!("{before}[bushings.strut_top]\n{more}\n{rest}");
        let read = Study::elastic_from_text("study.toml", &text, directory.path());
        let said = read.map(|_| ()).unwrap_err().render(false);
        assert!(said.contains("turns freely about its line"), "{said}");
    }
}

/// The z axis of a strut's mount is along the strut, not along the vertical. So an x axis along the strut is a mistake,
/// and a vertical x axis of an inclined strut is correct.
#[test]
fn the_x_axis_of_a_strut_differs_from_its_line() {
    let read = |own: &str| {
        let section = format!("[bushings.strut_top]\n{own}\n");
        let text = text("macpherson_compliance.toml").replace("[bushings.strut_top]\n", &section);
        let study = Study::elastic_from_text("study.toml", &text, Path::new("."));
        study.map(|_| ()).map_err(|errors| errors.render(false))
    };
    let along = "x_axis = [-24.0, -48.0, 480.0]";
    for (own, phrase) in [
        (along, "within 1 degree of the line of the strut"),
        (
            &format!("{along}\nz_axis = [-24.0, -46.0, 480.0]"),
            "are within 1 degree of each other",
        ),
    ] {
        let said = read(own).unwrap_err();
        assert!(
            said.contains("strut_top") && said.contains(phrase),
            "{said}"
        );
    }
    read("x_axis = [0.0, 0.0, 1.0]").unwrap();
    read(&format!("{along}\nz_axis = [0.0, 0.0, 1.0]")).unwrap();
}

#[test]
fn readers_of_rigid_parts_refuse_elastic_ones() {
    let refused = Study::from_text("study.toml", &text(STUDIES[0]), Path::new(".")).unwrap_err();
    let rendered = refused.render(false);
    assert!(rendered.contains("compliance"), "{rendered}");
    assert!(rendered.contains("would ignore them"), "{rendered}");
}

#[test]
fn mutilated_studies_are_tested_or_refused_with_a_reason() {
    let (mut ran, mut refused) = (0, 0);
    for (sample, name) in STUDIES.into_iter().enumerate() {
        let text = text(name);
        for case in 0..200 {
            let mut random = Random(case + 77_000_000 * (sample as u64 + 1));
            let text = mutilated(&text, &mut random);
            match Study::elastic_from_text("study.toml", &text, Path::new(".")) {
                Err(errors) => {
                    refused += 1;
                    assert!(!errors.all().is_empty());
                }
                Ok(study) => {
                    let Some(elastic) = study.compliance() else {
                        continue;
                    };
                    ran += 1;
                    let run = KcRun::new(study.wheel(), &elastic.parts, elastic.tyre_rate);
                    let first = |values: &[f64]| values.iter().copied().take(2).collect::<Vec<_>>();
                    let (travels, racks) =
                        (first(&study.motion().values), first(&study.motion().rack));
                    for station in run.unwrap().run(&travels, &racks, &elastic.tests) {
                        let outcomes = station.outcomes.iter().flatten();
                        for figure in outcomes.flat_map(|outcome| &outcome.figures) {
                            let numbers = [figure.value, figure.secant];
                            assert!(numbers.into_iter().flatten().all(f64::is_finite));
                        }
                    }
                }
            }
        }
    }
    assert!(ran > 30 && refused > 50, "{ran} {refused}");
}

/// Messages about mistakes in elastic axles name the location and the expected input.
#[test]
fn mistakes_of_elastic_axles_are_named() {
    let text = text("subframe_axle_compliance.toml");
    let bar = "\"anti_roll_bar_inner\", \"anti_roll_bar_outer\",";
    for (from, to, phrase) in [
        (
            "\"lower_arm_rear\", ",
            "",
            "list both in `carries`, or neither",
        ),
        (bar, "", "both on the subframe, or both on the body"),
        (
            "\"tie_rod_inner\", ",
            "\"tie_rod_outer\", ",
            "expected a hardpoint of the body or the rack",
        ),
        (
            "[bushings.subframe_front]",
            "[bushings.subframe_fron]",
            "has no [bushings.subframe_front]",
        ),
        (
            "carries = [\n  \"lower_arm_front\", \"lower_arm_rear\", \"tie_rod_inner\", \"anti_roll_bar_inner\", \"anti_roll_bar_outer\",\n",
            "carries = [\n",
            "carries no hardpoint",
        ),
        ("c_factor = -60.0 ", "# ", "column_stiffness needs c_factor"),
        (
            "heave = {",
            "roll = {",
            "use the test load = \"roll\" of kc",
        ),
        (
            "{ load = \"roll\" },",
            "{ load = \"roll\" }, { load = \"roll\" },",
            "this test already exists",
        ),
        (
            "mode = \"single\"",
            "mode = \"singel\"",
            "did you mean \"single\"",
        ),
    ] {
        let wrong = text.replacen(from, to, 1);
        assert_ne!(wrong, text, "{from}");
        let read = Study::elastic_from_text("study.toml", &wrong, Path::new("."));
        let rendered = read.map(|_| ()).unwrap_err().render(false);
        assert!(rendered.contains(phrase), "{from}: {rendered}");
    }
}

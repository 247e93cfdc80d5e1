//! Tests of mistakes of users: wrong studies, wrong calls and doubtful designs.

use super::*;

/// For each mistake, the exit code is 2, and one message gives the location and the mistake. The program writes no files.
#[test]
fn mistakes_are_named_and_nothing_is_written() {
    let good = fs::read_to_string(studies().join("macpherson_front.toml")).unwrap();
    let changed = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replacen(from, to, 1)
    };
    let cases = [
        (
            changed("[motion]\ntravel", "[motion]\ntravle"),
            vec!["travle", "travel"],
        ),
        (
            changed("strut_top        = [ -35.0, 575.0, 850.0]\n", ""),
            vec!["strut_top"],
        ),
        (changed("575.0", "\"high\""), vec!["number", "high"]),
        (changed("575.0", "nan"), vec!["nan"]),
        (
            changed("[ 120.0, 360.0, 195.0]", "[-260.0, 350.0, 205.0]"),
            vec!["lower_arm_front", "lower_arm_rear", "axis of the lower arm"],
        ),
        (
            changed("from = -80.0, to = 80.0", "from = 80.0, to = -80.0"),
            vec!["from", "80"],
        ),
        (
            changed("\"camber\", \"toe\"", "\"cambr\", \"toe\""),
            vec!["cambr", "camber"],
        ),
        (
            changed("\"macpherson\"", "\"mcpherson\""),
            vec!["mcpherson", "macpherson"],
        ),
        (String::new(), vec!["empty"]),
        ("[suspension".to_owned(), vec!["not valid TOML"]),
    ];
    for (number, (study, phrases)) in cases.into_iter().enumerate() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("bad.toml");
        fs::write(&path, study).unwrap();
        let assert = Command::cargo_bin("hardpoint")
            .unwrap()
            .args(["optimise", "bad.toml"])
            .current_dir(directory.path())
            .assert()
            .code(2);
        let said = text(&assert.get_output().stderr);
        assert!(said.contains("bad.toml"), "case {number}: {said}");
        for phrase in phrases {
            assert!(
                said.contains(phrase),
                "case {number} lacks {phrase:?}: {said}"
            );
        }
        assert_eq!(
            fs::read_dir(directory.path()).unwrap().count(),
            1,
            "case {number}"
        );
    }
}

#[test]
fn wrong_calls_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path().to_str().unwrap();
    for (arguments, phrase) in [
        (vec!["solve", "absent.toml"], "does not exist"),
        (vec!["solve", here], "directory"),
        (vec!["new", "unicycle"], "macpherson"),
        (vec!["sovle"], "solve"),
        (vec!["solve"], "STUDY"),
    ] {
        let assert = hardpoint(&arguments).code(2);
        let said = text(&assert.get_output().stderr);
        assert!(said.contains(phrase), "{arguments:?}: {said}");
    }
    let study = studies().join("macpherson_solve.toml");
    let assert = hardpoint(&["optimise", study.to_str().unwrap()]).code(2);
    assert!(text(&assert.get_output().stderr).contains("[optimise]"));
}

/// The user cannot define an axle by its right wheel. The message tells the user to mirror the points.
#[test]
fn an_axle_of_a_right_wheel_is_told_to_mirror_it() {
    let study = studies().join("macpherson_axle.toml");
    let right = [
        "check",
        study.to_str().unwrap(),
        "--set",
        "suspension.side=\"right\"",
        "--set",
        "suspension.frame=\"x_rear\"",
    ];
    let said = text(&hardpoint(&right).code(2).get_output().stderr);
    assert!(said.contains("--side left"), "{said}");
}

/// If the program cannot write to the output location, it reports this before it computes anything.
#[test]
fn a_place_that_cannot_be_written_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("taken");
    fs::write(&file, "a file, not a directory").unwrap();
    let out = file.join("run");
    let study = studies().join("macpherson_solve.toml");
    let assert = hardpoint(&[
        "solve",
        study.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    let assert = assert.code(2);
    let said = text(&assert.get_output().stderr);
    assert!(
        said.contains("cannot write") && said.contains("taken"),
        "{said}"
    );
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
}

/// If a target applies at a travel that the wheel cannot reach, the tuning ends and reports the limit of the wheel
/// travel.
#[test]
fn an_unreachable_target_travel_is_a_reason_not_a_crash() {
    let directory = tempfile::tempdir().unwrap();
    let study = fs::read_to_string(studies().join("macpherson_front.toml")).unwrap();
    let study = study
        .replace(
            "from = -80.0, to = 80.0, steps = 41",
            "from = -80.0, to = 400.0, steps = 25",
        )
        .replace("[80.0, -0.94]]", "[80.0, -0.94], [400.0, -2.0]]");
    let path = directory.path().join("far.toml");
    fs::write(&path, study).unwrap();
    let assert = Command::cargo_bin("hardpoint")
        .unwrap()
        .args(["optimise", "far.toml", "--set", "optimise.starts=3"])
        .current_dir(directory.path())
        .assert()
        .code(1);
    let said = text(&assert.get_output().stdout);
    assert!(said.contains("the wheel travel ends"), "{said}");
    let summary = directory.path().join("out/far/summary.json");
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(summary).unwrap()).unwrap();
    assert!(summary["misfit_after"].is_null());
}

/// If a user gives a key of the study as an option, the message shows how to set this key.
#[test]
fn a_key_as_an_option_is_told_how_to_set_it() {
    let path = studies().join("macpherson_front.toml");
    let path = path.to_str().unwrap();
    for (call, tip) in [
        (
            ["optimise", path, "--starts", "8"],
            "'--set optimise.starts=VALUE'",
        ),
        (
            ["tolerance", path, "--builds", "8"],
            "'--set tolerance.builds=VALUE'",
        ),
    ] {
        let refused = hardpoint(&call).code(2);
        let said = text(&refused.get_output().stderr);
        assert!(said.contains(tip) && !said.contains("-- --"), "{said}");
    }
}

#[test]
fn samples_are_not_doubtful() {
    for entry in fs::read_dir(studies()).unwrap() {
        let path = entry.unwrap().path();
        // In the paper, the wheel is defined by points that are not on its spin axis.
        let is_paper = path.ends_with("attia.toml");
        if path.extension().is_some_and(|e| e == "toml") && !is_paper {
            let assert = hardpoint(&["check", path.to_str().unwrap()]).success();
            let said = text(&assert.get_output().stdout);
            assert!(!said.contains("please check"), "{said}");
        }
    }
}

/// The program warns of probable mistakes even if the suspension is valid.
#[test]
fn doubtful_studies_are_called_so() {
    let good = crate::support::sample("double_wishbone_pushrod.toml");
    let swapped = |a: &str, b: &str| {
        let rename = |line: &str| match line.split_whitespace().next() {
            Some(name) if name == a => line.replacen(a, b, 1),
            Some(name) if name == b => line.replacen(b, a, 1),
            _ => line.to_owned(),
        };
        good.lines().map(rename).collect::<Vec<_>>().join("\n")
    };
    let moved = |name: &str, place: &str| {
        let is_own = |line: &&str| line.split_whitespace().next() == Some(name);
        let line = good.lines().find(is_own).unwrap();
        good.replace(line, &format!("{name} = {place}"))
    };
    let rear_pivot = |place: &str| moved("lower_arm_rear", place);
    let wheel_centre = |place: &str| moved("wheel_centre", place);
    let cases = [
        (
            // The point is given in centimetres by mistake.
            wheel_centre("[0.0, 620.0, 25.5]"),
            "mm below every joint of its carrier",
        ),
        (
            wheel_centre("[0.0, 620.0, 510.0]"),
            "mm above every joint of its carrier",
        ),
        (
            wheel_centre("[-1560.0, 620.0, 255.0]"),
            "mm behind every joint of its carrier",
        ),
        (
            swapped("upper_ball_joint", "lower_ball_joint"),
            "upper_ball_joint is not above lower_ball_joint",
        ),
        (
            swapped("tie_rod_inner", "tie_rod_outer"),
            "tie_rod_inner is outboard of tie_rod_outer",
        ),
        (
            swapped("pushrod_inner", "pushrod_outer"),
            "pushrod_inner is outboard of pushrod_outer",
        ),
        (
            swapped("spring_lower", "spring_upper"),
            "lengthens in jounce",
        ),
        (
            good.replace("[motion]", "[vehicle]\nwheelbase = 1.55\n\n[motion]"),
            "wheelbase is 1.55 mm",
        ),
        (
            good.replace("[motion]", "[vehicle]\nwheelbase = 270.0\n\n[motion]"),
            "wheelbase is 270 mm at a wheel radius of",
        ),
        (
            good.replace("[motion]", "[vehicle]\ncg_height = 29.0\n\n[motion]"),
            "cg_height is 29 mm at a wheel radius of",
        ),
        (
            good.replace("[motion]", "[vehicle]\ntrack = 1000.0\n\n[motion]"),
            "track is 1000 mm",
        ),
        (
            rear_pivot("[-180.0, 220.0, -138.0]"),
            "lower_arm_rear is 138 mm below the ground",
        ),
        (
            rear_pivot("[-4572.0, 220.0, 138.0]"),
            "mm away from wheel_centre. Is one of them in another unit?",
        ),
    ];
    let directory = tempfile::tempdir().unwrap();
    for (case, (text_of_study, phrase)) in cases.into_iter().enumerate() {
        let path = directory.path().join("study.toml");
        fs::write(&path, &text_of_study).unwrap();
        let path = path.to_str().unwrap();
        let out = directory.path().join(format!("run-{case}"));
        let checked = hardpoint(&["check", path]).success();
        let solved = hardpoint(&["solve", path, "--out", out.to_str().unwrap()]);
        for said in [&checked.get_output().stdout, &solved.get_output().stdout] {
            let said = text(said);
            assert!(
                said.contains("please check: ") && said.contains(phrase),
                "{phrase}\n{said}"
            );
        }
    }
}

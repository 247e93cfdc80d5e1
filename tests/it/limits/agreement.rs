//! Tests that `check`, `solve`, `limits` and `optimise` report the same for one motion, with the same exit codes.

use crate::support::one_line;
use hardpoint::study::Study;
use std::process::{Command, Output};

fn run(command: &str, study: &str, set: &[&str]) -> Output {
    let path = crate::support::studies().join(study);
    let mut arguments = vec![command.to_owned(), path.to_str().unwrap().to_owned()];
    for value in set {
        arguments.extend(["--set".to_owned(), (*value).to_owned()]);
    }
    if ["solve", "optimise"].contains(&command) {
        arguments.extend(["--out".to_owned(), "-".to_owned()]);
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_hardpoint"));
    command
        .args(&arguments)
        .env("COLUMNS", "400")
        .output()
        .unwrap()
}

/// Output of a command on both streams, as one line.
fn said(output: &Output) -> String {
    let both = [&output.stdout, &output.stderr].map(|s| String::from_utf8_lossy(s).into_owned());
    one_line(&both.concat())
}

#[test]
fn travel_that_is_not_reached_is_said_by_all_three() {
    for (set, code) in [
        ("motion.travel=[0.0, 300.0]", 0),
        ("motion.travel=[0.0, 400.0]", 1),
    ] {
        for command in ["check", "solve", "limits"] {
            let output = run(command, "macpherson_solve.toml", &[set]);
            assert_eq!(
                output.status.code(),
                Some(code),
                "{command}: {}",
                said(&output)
            );
            let told = said(&output).contains(
                "the wheel travel ends at 349.667807 mm: the wheel centre is at its highest",
            );
            assert_eq!(told, code == 1, "{command}: {}", said(&output));
        }
    }
}

#[test]
fn a_named_motion_that_is_not_reached_is_said_by_all_three() {
    for (set, code) in [
        ("motions.left_lock.rack=60.0", 0),
        ("motions.left_lock.rack=360.0", 1),
    ] {
        for command in ["check", "solve", "limits"] {
            let output = run(command, "macpherson_steering.toml", &[set]);
            let said = said(&output);
            assert_eq!(output.status.code(), Some(code), "{command}: {said}");
            let told = said.contains(
                "motion left_lock: not solved: travel -40 to 40 mm, rack 360 mm (9 stations): the rack moves no further than 1",
            );
            assert_eq!(told, code == 1, "{command}: {said}");
        }
    }
}

/// A tuning states the stations of named motions that the tuned axle does not reach, like the other commands.
#[test]
fn a_named_motion_of_an_axle_that_is_not_reached_is_said_by_all() {
    let sets = |rack: &str| {
        [
            "motion={ heave = [-10.0, 0.0, 10.0] }".to_owned(),
            format!("motions.lock={{ heave = 0.0, rack = {rack} }}"),
            "optimise.starts=1".to_owned(),
            "outputs.characteristics=[\"camber_to_road\"]".to_owned(),
            "optimise.targets=[{ characteristic = \"camber_to_road\", over = \"heave\", \
             points = [[-10.0, -1.0], [10.0, -1.0]], tolerance = 100.0, side = \"left\" }]"
                .to_owned(),
        ]
    };
    for (rack, code) in [("20.0", 0), ("360.0", 1)] {
        let sets = sets(rack);
        let sets = sets.each_ref().map(String::as_str);
        for command in ["check", "solve", "limits", "optimise"] {
            let output = run(command, "macpherson_axle_front.toml", &sets);
            let said = said(&output);
            assert_eq!(output.status.code(), Some(code), "{command}: {said}");
            let told = said.contains("motion lock: not solved: ");
            assert_eq!(told, code == 1, "{command}: {said}");
        }
    }
}

#[test]
fn a_column_without_a_value_is_not_done() {
    // Two points that define the camber in the paper's formulation coincide, so this camber has no value.
    let set = "suspension.hardpoints.wheel_centre=[1.47979023854085, 0.3715370715633186, 0.2223007791913243]";
    let spindle = "suspension.hardpoints.spindle_inner=[1.60607, 0.39391, 0.04829]";
    let same = "suspension.hardpoints.strut_upper=[1.47979023854085, 0.3715370715633186, 0.2223007791913243]";
    for command in ["check", "solve"] {
        let output = run(command, "attia.toml", &[set, same, spindle]);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(1), "{command}: {said}");
        let reason = "no value at any station: wheel_centre and strut_upper coincide";
        assert!(
            said.contains("attia_camber_deg") && said.contains(reason),
            "{said}"
        );
    }
}

#[test]
fn stations_at_toggle_are_counted_as_such() {
    let output = run(
        "solve",
        "double_wishbone_pushrod.toml",
        &["motion.travel=[0.0, 100.0, 150.0, 160.0]"],
    );
    let said = said(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("2 of 4 stations solved, 2 toggle"), "{said}");
}

#[test]
fn limits_are_given_at_every_rack_of_the_study() {
    let output = run(
        "limits",
        "macpherson_solve.toml",
        &["motion.rack=[-60.0, 0.0, 60.0]"],
    );
    let said = said(&output);
    for row in ["rack -60", "rack 60", "every rack"] {
        assert!(said.contains(row), "{said}");
    }
    assert_eq!(output.status.code(), Some(0), "{said}");
}

/// A single rack displacement has a row of its own, with the same limits as in a list of displacements.
#[test]
fn limits_are_given_at_a_single_rack() {
    let row = |rack: &str| {
        let set = format!("motion.rack={rack}");
        let output = run("limits", "macpherson_solve.toml", &[&set]);
        let text = String::from_utf8(output.stdout).unwrap();
        let row = text.lines().find(|line| line.contains(" rack 20 "));
        let row = row.unwrap_or_else(|| panic!("{text}"));
        one_line(row)
    };
    assert_eq!(row("20.0"), row("[0.0, 20.0]"));
}

#[test]
fn exchanged_pivots_and_offsets_for_coordinates_are_doubted() {
    let front = "suspension.hardpoints.lower_arm_front=[-260.0, 350.0, 205.0]";
    let rear = "suspension.hardpoints.lower_arm_rear=[120.0, 360.0, 195.0]";
    let text = said(&run("check", "macpherson_solve.toml", &[front, rear]));
    assert!(
        text.contains("lower_arm_front is behind lower_arm_rear"),
        "{text}"
    );
    let variable = |range: &str, absolute: bool| {
        format!(
            "sweep={{method=\"sobol\", samples=8, variables=[{{hardpoint=\"tie_rod_inner\", axis=\"z\", range={range}, \
             absolute={absolute}}}]}}"
        )
    };
    for (range, absolute, doubted) in [
        ("[-10.0, 10.0]", true, Some("Are these offsets?")),
        ("[233.0, 253.0]", false, Some("coordinates?")),
        ("[233.0, 253.0]", true, None),
        ("[-10.0, 10.0]", false, None),
    ] {
        let text = said(&run(
            "check",
            "macpherson_solve.toml",
            &[&variable(range, absolute)],
        ));
        match doubted {
            Some(phrase) => assert!(text.contains(phrase), "{text}"),
            None => assert!(!text.contains("please check"), "{text}"),
        }
    }
}

/// The limit of the rack displacement has the sign of the study's axis, like the rack displacements themselves.
#[test]
fn the_end_of_the_rack_has_its_sign() {
    for (set, end) in [
        (vec!["motion.rack=-200.0"], "no further than -113.322620 mm"),
        (vec!["motion.rack=200.0"], "no further than 164.471197 mm"),
    ] {
        for command in ["check", "solve", "limits"] {
            let said = said(&run(command, "macpherson_solve.toml", &set));
            assert!(said.contains(end), "{command}: {said}");
        }
    }
    // The mirror image is in axes with the opposite y direction.
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("study.toml");
    let text = crate::support::sample("macpherson_solve.toml");
    let flipped = |line: &str| {
        let parts = line.split_once("= [").and_then(|(name, rest)| {
            let (numbers, rest) = rest.split_once(']')?;
            let numbers: Vec<f64> = numbers
                .split(',')
                .map(|n| n.trim().parse())
                .collect::<Result<_, _>>()
                .ok()?;
            let [x, y, z] = numbers[..] else { return None };
            Some(format!("{name}= [{:?}, {:?}, {z:?}]{rest}", -x, -y))
        });
        parts.unwrap_or_else(|| line.to_owned())
    };
    let text: Vec<String> = text.lines().map(flipped).collect();
    let text = text.join("\n").replace("\"iso8855\"", "\"x_rear\"");
    std::fs::write(&path, text).unwrap();
    let said = said(&run(
        "solve",
        path.to_str().unwrap(),
        &["motion.rack=200.0"],
    ));
    assert!(said.contains("no further than 113.322620 mm"), "{said}");
}

/// `check` states the rack displacement of the study as it is written, in every frame.
#[test]
fn the_rack_of_a_study_has_its_sign() {
    let directory = tempfile::tempdir().unwrap();
    let own = crate::support::studies().join("macpherson_solve.toml");
    for frame in ["iso8855", "sae_j670", "x_rear"] {
        let study = directory.path().join(format!("{frame}.toml"));
        let [own, study] = [&own, &study].map(|path| path.to_str().unwrap());
        let mut convert = Command::new(env!("CARGO_BIN_EXE_hardpoint"));
        convert.args(["convert", own, "--frame", frame, "--out", study]);
        assert!(convert.output().unwrap().status.success());
        let said = said(&run("check", study, &["motion.rack=5.0"]));
        assert!(said.contains("rack at 5 mm"), "{frame}: {said}");
    }
}

/// At a rack displacement that the rack cannot reach, `limits` states no range. It also states no common range of all
/// rack displacements.
#[test]
fn a_rack_out_of_reach_has_no_range() {
    let output = run(
        "limits",
        "macpherson_solve.toml",
        &["motion.rack=[0.0, 200.0]"],
    );
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for place in ["rack 200", "every rack"] {
        let row = text.lines().find(|line| line.contains(place)).unwrap();
        assert_eq!(
            row.matches("the rack cannot reach this position").count(),
            2,
            "{text}"
        );
        assert!(!row.contains(" 0 "), "{text}");
    }
    assert!(!text.contains("followed further"), "{text}");
    assert!(
        said(&output).contains("Nearest travel limit at the rack positions that can be reached:"),
        "{text}"
    );
}

/// The program warns if the motion displaces the rack but no part is attached to the rack.
#[test]
fn a_rack_that_nothing_is_on_is_doubted() {
    let moved = "motion.rack=[-10.0, 0.0, 10.0]";
    let doubt = "please check: the motion displaces the rack, but no part of a semi_trailing_arm is attached to the rack";
    for command in ["check", "solve"] {
        let with = said(&run(command, "semi_trailing_arm_solve.toml", &[moved]));
        assert!(with.contains(doubt), "{command}: {with}");
        for (study, set) in [
            ("semi_trailing_arm_solve.toml", &["motion.rack=0.0"][..]),
            ("macpherson_solve.toml", &[moved]),
        ] {
            let without = said(&run(command, study, set));
            assert!(
                !without.contains("please check"),
                "{command} {study}: {without}"
            );
        }
    }
}

/// `limits` names the toggle of a pushrod just beyond the motion. The travel at the toggle minus the stated distance is
/// the end of the motion.
#[test]
fn a_toggle_beside_the_motion_is_named() {
    let set = "motion.travel=[0.0, 140.0]";
    let output = run("limits", "double_wishbone_pushrod.toml", &[set]);
    let said = said(&output);
    let (_, rest) = said
        .rsplit_once("The pushrod reaches its toggle at travel ")
        .unwrap();
    let (travel, rest) = rest.split_once(" mm, ").unwrap();
    let (beyond, _) = rest.split_once(" mm beyond the motion").unwrap();
    let [travel, beyond] = [travel, beyond].map(|number| number.parse::<f64>().unwrap());
    assert!(
        beyond > 0.0 && (travel - beyond - 140.0).abs() < 1e-3,
        "{said}"
    );
    assert!(said.matches("reaches its toggle").count() == 2, "{said}");
}

/// The length of a spring has a minimum in jounce. `check` and `solve` warn of a motion beyond that travel, and do not
/// warn of a motion that ends before it.
#[test]
fn a_spring_that_turns_round_is_doubted_at_its_shortest_length() {
    let path = crate::support::studies().join("double_wishbone_pushrod.toml");
    let sets = [
        "outputs.characteristics=[\"spring_length\"]",
        "outputs.order=\"position\"",
        "motion.travel={ from = 100.0, to = 130.0, steps = 3001 }",
    ];
    let study = Study::read(&path, &sets.map(str::to_owned)).unwrap();
    let curves = study.curves().unwrap();
    let lengths = curves.stations.iter().enumerate();
    let lengths = lengths.filter_map(|(k, station)| Some((k, station.value(0)?)));
    let (shortest, _) = lengths.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let shortest = 100.0 + 0.01 * shortest as f64;
    assert!(shortest > 101.0 && shortest < 129.0, "{shortest}");
    for command in ["check", "solve"] {
        let with = |to: f64| {
            let motion = format!("motion.travel=[0.0, {to:?}]");
            said(&run(command, "double_wishbone_pushrod.toml", &[&motion]))
        };
        let doubted = with(shortest + 5.0);
        let (_, rest) = doubted.split_once("please check: above travel ").unwrap();
        let (travel, rest) = rest.split_once(" mm ").unwrap();
        let travel: f64 = travel.parse().unwrap();
        assert!((travel - shortest).abs() < 0.1, "{travel} {shortest}");
        assert!(rest.starts_with("the spring from spring_lower to spring_upper lengthens"));
        assert!(!with(shortest - 1.0).contains("please check"), "{command}");
    }
}

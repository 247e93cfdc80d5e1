//! Tests of the commands with studies of axles, as a user runs them.

use assert_cmd::Command;
use hardpoint::Study;
use hardpoint::ask::{Info, Need};
use hardpoint::axle::{AxleQuantity, WheelQuantity};
use hardpoint::exchange::{Outgoing, Page, curves_in, page_of_csv, point_rows, workbook};
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

pub(super) fn study(name: &str) -> PathBuf {
    Path::new(ROOT).join("studies").join(name)
}

pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("axle")
        .join(name);
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn hardpoint(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("hardpoint")
        .unwrap()
        .args(arguments)
        .assert()
}

/// Runs a command, checks its exit code, and returns its standard output and standard error.
pub(super) fn run(arguments: &[&str], code: i32) -> (String, String) {
    let output = hardpoint(arguments).code(code).get_output().clone();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr))
}

#[test]
fn sample_axles_are_solved_and_written() {
    for (name, columns) in [
        (
            "macpherson_axle",
            vec![
                "roll_deg",
                "heave_mm",
                "travel_left_mm",
                "travel_right_mm",
                "rack_mm",
                "steering_wheel_angle_deg",
                "left_camber_deg",
                "right_camber_deg",
                "track_mm",
                "roll_centre_height_mm",
                "left_jacking_coefficient",
                "ackermann_percent",
                "left_roll_steer_deg_per_deg",
                "roll_steer_deg_per_deg",
                "left_wheel_load_N",
                "roll_stiffness_N_m_per_deg",
                "ride_rate_N_per_mm",
                "ride_frequency_Hz",
                "status",
            ],
        ),
        (
            "five_link_axle",
            vec!["left_toe_deg", "right_toe_deg", "roll_centre_lateral_mm"],
        ),
    ] {
        let path = study(&format!("{name}.toml"));
        let out = folder(name);
        let [path, directory] = [&path, &out].map(|p| p.to_str().unwrap());
        run(&["check", path], 0);
        run(&["solve", path, "--out", directory], 0);
        let csv = fs::read_to_string(out.join("curves.csv")).unwrap();
        let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
        for column in columns {
            assert!(header.contains(&column), "{name}: {column} in {header:?}");
        }
        assert!(
            csv.lines().skip(1).all(|line| line.ends_with(",ok")),
            "{csv}"
        );
        let (again, _) = run(&["solve", path, "--out", "-"], 0);
        assert_eq!(again, csv);
    }
    let sensitivities = folder("five_link_axle_again");
    let path = study("five_link_axle.toml");
    let [path, directory] = [&path, &sensitivities].map(|p| p.to_str().unwrap());
    run(&["solve", path, "--out", directory], 0);
    let csv = fs::read_to_string(sensitivities.join("sensitivities.csv")).unwrap();
    assert!(csv.contains(",roll_steer,left,toe_link_inner,z,"), "{csv}");
    // Outputs and units have the same names in this file as in the sensitivity file of one wheel.
    let path = study("double_wishbone_solve.toml");
    let (corner, axle) = (folder("corner"), csv);
    let outputs = "outputs={ characteristics = [\"camber\", \"motion_ratio\"], sensitivities = [\"wheel_centre\"] }";
    let arguments = [
        "solve",
        path.to_str().unwrap(),
        "--set",
        outputs,
        "--out",
        corner.to_str().unwrap(),
    ];
    run(&arguments, 0);
    let corner = fs::read_to_string(corner.join("sensitivities.csv")).unwrap();
    let written = |csv: &str| {
        let rows: Vec<Vec<String>> = csv
            .lines()
            .map(|l| l.split(',').map(str::to_owned).collect())
            .collect();
        let column = |name: &str| rows[0].iter().position(|n| n == name).unwrap();
        let (output, unit) = (column("output"), column("unit"));
        let of = rows
            .iter()
            .skip(1)
            .map(|row| (row[output].clone(), row[unit].clone()));
        of.collect::<std::collections::BTreeSet<_>>()
    };
    let pair = |output: &str, unit: &str| (output.to_owned(), unit.to_owned());
    assert!(written(&corner).contains(&pair("camber", "deg_per_mm")));
    assert!(written(&corner).contains(&pair("motion_ratio", "per_mm")));
    let axle = written(&axle);
    for (output, unit) in [
        ("left_camber_to_road", "deg_per_mm"),
        ("roll_steer", "deg_per_deg_per_mm"),
        ("track_change", "mm_per_mm"),
        ("roll_centre_height", "mm_per_mm"),
        ("left_wheel_load", "N_per_mm"),
    ] {
        assert!(
            axle.contains(&pair(output, unit)),
            "{output} {unit}: {axle:?}"
        );
    }
}

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

/// The given track may be the distance of the wheel centres or the distance of the contact points. Any other track gives a
/// warning with both distances. This holds for an axle and for one wheel.
#[test]
fn a_track_agrees_with_wheel_centres_or_contact_points() {
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    for (name, outputs) in [
        (
            "macpherson_axle_front.toml",
            "outputs.characteristics=[\"track\"]",
        ),
        (
            "double_wishbone_solve.toml",
            "outputs.points=[\"wheel_centre\"]",
        ),
    ] {
        let path = study(name);
        let checked = |track: f64| {
            let set = format!("vehicle.track={track:?}");
            let arguments = [
                "check",
                path.to_str().unwrap(),
                "--set",
                &set,
                "--set",
                outputs,
            ];
            words(&run(&arguments, 0).0)
        };
        let wrong = checked(1400.0);
        let (_, apart) = wrong
            .split_once("please check: [vehicle] track is 1400 mm, but the wheel centres are ")
            .unwrap_or_else(|| panic!("{wrong}"));
        let (centres, rest) = apart
            .split_once(" mm apart, and the contact points ")
            .unwrap();
        let (contacts, _) = rest.split_once(" mm. ").unwrap();
        for track in [centres, contacts].map(|text| text.parse::<f64>().unwrap()) {
            for track in [track, track + 0.5] {
                let said = checked(track);
                assert!(!said.contains("track is"), "{name} {track}: {said}");
            }
        }
    }
}

/// A motion that only steers keeps both wheels at the design height.
#[test]
fn a_motion_may_only_steer() {
    let path = study("macpherson_axle.toml");
    let solved = |name: &str, motion: &str| {
        let out = folder(name);
        let set = format!("motion={motion}");
        let arguments = [
            "solve",
            path.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
            "--set",
            &set,
        ];
        run(&arguments, 0);
        fs::read_to_string(out.join("curves.csv")).unwrap()
    };
    for steering in ["steering_wheel_angle = [0.0, 90.0]", "rack = [0.0, 10.0]"] {
        let alone = solved("steers", &format!("{{ {steering} }}"));
        let level = solved("steers_level", &format!("{{ heave = 0.0, {steering} }}"));
        assert_eq!(alone, level);
    }
    let arguments = [
        "check",
        path.to_str().unwrap(),
        "--set",
        "motion={ combine = \"all\" }",
    ];
    let (_, said) = run(&arguments, 2);
    assert!(said.contains("rack or steering_wheel_angle"), "{said}");
}

/// If the springs do not carry the sprung mass in the design position, `check` reports both loads.
#[test]
fn springs_that_do_not_carry_the_sprung_mass_are_reported() {
    let path = study("macpherson_axle.toml");
    let path = path.to_str().unwrap();
    let out = folder("balance");
    let design = [
        "solve",
        path,
        "--out",
        out.to_str().unwrap(),
        "--set",
        "motion={ heave = 0.0 }",
        "--set",
        "outputs={ characteristics = [\"wheel_load\"] }",
    ];
    run(&design, 0);
    let curves = fs::read_to_string(out.join("curves.csv")).unwrap();
    let [header, row] = [0, 1].map(|k| {
        curves
            .lines()
            .nth(k)
            .unwrap()
            .split(',')
            .collect::<Vec<_>>()
    });
    let loads = header
        .iter()
        .zip(row)
        .filter(|(name, _)| name.ends_with("wheel_load_N"));
    let load: f64 = loads.map(|(_, value)| value.parse::<f64>().unwrap()).sum();
    for (factor, is_off) in [(1.0, false), (1.03, false), (0.9, true), (1.1, true)] {
        let mass = factor * load / 9.80665;
        let set = format!("vehicle={{ wheelbase = 2650.0, sprung_mass = {mass:?} }}");
        let (said, _) = run(&["check", path, "--set", &set], 0);
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        let weight = format!("but sprung_mass weighs {:.0} N", factor * load);
        assert_eq!(said.contains(&weight), is_off, "{factor}: {said}");
        assert_eq!(
            said.contains("design position is not the static position"),
            is_off
        );
    }
}

/// A certificate of an axle has its own columns, grouped by cause, and a summary. A sweep omits the certificate and
/// reports this.
#[test]
fn an_axle_is_certified() {
    let path = study("macpherson_axle.toml");
    let out = folder("certified");
    let [path, directory] = [&path, &out].map(|p| p.to_str().unwrap());
    let few = [
        "outputs.certify=true",
        "outputs.characteristics=[\"steer\"]",
        "motion.heave=0.0",
    ];
    let set = |more: &[&'static str]| -> Vec<&'static str> {
        let all = few.iter().chain(more);
        all.flat_map(|set| ["--set", *set]).collect()
    };
    let mut arguments = vec!["solve", path, "--out", directory];
    arguments.extend(set(&[]));
    let (said, _) = run(&arguments, 0);
    assert!(
        said.contains("26 of 26 stations certified; the whole curve is on one branch"),
        "{said}"
    );
    let csv = fs::read_to_string(out.join("curves.csv")).unwrap();
    let columns =
        "left_position_error_mm,right_position_error_mm,travel_error_mm,uniqueness_mm,status";
    assert!(csv.lines().next().unwrap().ends_with(columns), "{csv}");
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["certificate"]["proved"], 26);
    assert_eq!(summary["certificate"]["one_branch"], true);
    // Beyond the end of the rack the program certifies nothing; all reachable poses are on one branch.
    let plane =
        "motion={travel_left=10.0, travel_right=-10.0, ground=\"plane\", rack=[0.0, 130.0]}";
    let mut arguments = vec!["solve", path, "--out", "-"];
    arguments.extend(set(&[]).into_iter().take(4));
    arguments.extend(["--set", plane]);
    let (csv, said) = run(&arguments, 1);
    assert!(csv.contains("roll_error_deg,uniqueness_mm,status"), "{csv}");
    assert!(csv.trim_end().ends_with(",,,,unreachable"), "{csv}");
    assert!(
        said.contains("1 of 2 stations certified; all poses that can be reached are on one branch"),
        "{said}"
    );
}

/// The page draws the rolled body on level ground. It shows both contact points on the ground, and the roll centre at
/// the height of the curves. The turn centre agrees with the turning circle.
#[test]
fn the_page_shows_both_wheels_on_the_ground() {
    let path = study("macpherson_axle.toml");
    let out = folder("page");
    let plots = folder("plots");
    let [path, directory, plots] = [&path, &out, &plots].map(|p| p.to_str().unwrap());
    let fewer = [
        "motion.heave=0.0",
        "motion.steering_wheel_angle=[0.0, 200.0]",
        "outputs.characteristics=[\"roll_centre_height\", \"turning_circle\", \"steer\"]",
    ];
    let fewer = fewer.iter().flat_map(|set| ["--set", set]);
    let arguments = [
        "solve", path, "--out", directory, "--report", "--plots", plots,
    ];
    run(&arguments.into_iter().chain(fewer).collect::<Vec<_>>(), 0);
    assert!(out.join("report.html").is_file());
    assert!(Path::new(plots).join("overview.svg").is_file());
    let (said, _) = run(&["report", directory, "--force"], 0);
    assert!(said.contains("report.html"), "{said}");

    let record = fs::read_to_string(out.join("report.json")).unwrap();
    let record: serde_json::Value = serde_json::from_str(&record).unwrap();
    let csv = fs::read_to_string(out.join("curves.csv")).unwrap();
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<Option<f64>>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().ok()).collect())
        .collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let frames = record["designs"][0]["frames"].as_array().unwrap();
    assert_eq!(frames.len(), rows.len());
    let design = &frames[6]["pose"]["Ok"];
    let ground = number(&design["contact"][2]);
    for (frame, row) in frames.iter().zip(&rows) {
        assert!((number(&frame["drive"]) - row[column("roll_deg")].unwrap()).abs() < 1e-12);
        let pose = &frame["pose"]["Ok"];
        for contact in [&pose["contact"], &pose["right"]["contact"]] {
            assert!((number(&contact[2]) - ground).abs() < 1e-9, "{contact}");
        }
        let height = number(&pose["roll_centre"][2]) - ground;
        let expected = row[column("roll_centre_height_mm")].unwrap();
        assert!((height - expected).abs() < 1e-9 * expected.abs().max(1.0));
        // Distances between points stay constant: the drawing turns the body without bending it.
        let place = |name: &str| {
            let names = record["scene"]["points"].as_array().unwrap();
            let index = names.iter().position(|n| n == name).unwrap();
            [0, 1, 2].map(|k| number(&pose["points"][index][k]))
        };
        let (a, b) = (
            place("left_lower_arm_front"),
            place("right_lower_arm_front"),
        );
        let apart = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        assert!((apart - 720.0).abs() < 1e-9, "{apart}");
        let Some(circle) = row[column("turning_circle_mm")] else {
            assert!(pose["turn"]["centre"].is_null());
            continue;
        };
        // Radius from the turn centre to the outer wheel (here the right one), seen from above in body axes. It agrees
        // within the offset of the contact point from the wheel centre plane.
        let centre = [0, 1].map(|k| number(&pose["turn"]["centre"][k]));
        let ends = &pose["turn"]["wheels"][1];
        let middle = [0, 1].map(|k| 0.5 * (number(&ends[0][k]) + number(&ends[1][k])));
        let radius = (middle[0] - centre[0]).hypot(middle[1] - centre[1]);
        assert!(
            (2.0 * radius - circle).abs() < 0.1 * 300.0,
            "{radius} {circle}"
        );
    }
}

/// The workbook of a study has the curves that `hardpoint solve` writes.
#[test]
fn the_workbook_of_an_axle_has_its_curves() {
    let path = study("five_link_axle.toml");
    let out = folder("workbook");
    fs::create_dir_all(&out).unwrap();
    let book = out.join("axle.xlsx");
    let [path, book] = [&path, &book].map(|p| p.to_str().unwrap());
    run(&["export", path, "--to", "xlsx", "--out", book], 0);
    let (csv, _) = run(&["solve", path, "--out", "-", "-q"], 0);
    let read = Study::read(Path::new(path), &[]).unwrap();
    let outgoing = Outgoing::of(&read, None, None);
    let points = Page {
        name: "hardpoints".to_owned(),
        rows: point_rows(&outgoing),
    };
    let curves = page_of_csv("curves", csv.as_bytes()).unwrap();
    let curves = curves_in(&outgoing, curves);
    assert!(curves.rows.len() == 1 + 39 && curves.rows[0].len() > 20);
    assert!(fs::read(book).unwrap() == workbook(&[points, curves]));
}

/// Tuning an axle writes its curves before and after, and a study that other commands accept.
#[test]
fn an_axle_is_tuned() {
    let path = study("macpherson_axle_front.toml");
    let out = folder("tuned");
    let [path, directory] = [&path, &out].map(|p| p.to_str().unwrap());
    let fewer = [
        "optimise.starts=1",
        "motion.roll=[-2.0, 0.0, 2.0]",
        "motion.heave=[-40.0, 40.0]",
        "motion.steering_wheel_angle=[-360.0, 0.0, 360.0]",
    ];
    let fewer = fewer.iter().flat_map(|set| ["--set", set]);
    let front = "optimise.front=[\"roll_steer\", \"force_roll_centre_height\"]";
    let fewer = fewer.chain(["--set", front, "--report"]);
    let arguments = ["optimise", path, "--out", directory].into_iter();
    let (said, _) = run(&arguments.chain(fewer).collect::<Vec<_>>(), 0);
    assert!(said.contains("roll_steer_deg_per_deg over roll"), "{said}");
    assert!(
        said.contains("Smallest misfit by the size of the change"),
        "{said}"
    );
    // The page contains the Pareto front too, so that the user can pick a design.
    let record = fs::read_to_string(out.join("report.json")).unwrap();
    assert!(record.contains("\"targets\":[\"roll_steer\",\"force_roll_centre_height\"]"));
    for file in [
        "curves.csv",
        "front.csv",
        "report.html",
        "curves_before.csv",
        "history.csv",
        "summary.json",
    ] {
        assert!(out.join(file).is_file(), "{file}");
    }
    // Both pictures at the top of the page show the rims of both wheels.
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let (_, answer) = page.split_once("<section id=\"answer\"").unwrap();
    let (answer, _) = answer.split_once("</section>").unwrap();
    assert_eq!(answer.matches("class=\"rim\"").count(), 4);
    let again = out.join("optimised.toml");
    let (said, _) = run(&["check", again.to_str().unwrap()], 0);
    assert!(said.contains("18 of 18 stations solved"), "{said}");
}

/// The Pareto front of two goals has a design that is at least as good as the tuned design in both goals. The tolerance is the
/// spacing of the front's points.
#[test]
fn no_tuned_design_is_better_than_its_front() {
    let path = study("macpherson_axle_front.toml");
    let out = folder("front_of_two");
    let [path, directory] = [&path, &out].map(|p| p.to_str().unwrap());
    let sets = [
        "optimise.starts=1",
        "motion.roll=[-3.0, 0.0, 3.0]",
        "motion.heave=[-40.0, 0.0, 40.0]",
        "motion.steering_wheel_angle=[-360.0, 0.0, 360.0]",
        "optimise.front=[\"ackermann_error\", \"force_roll_centre_height\"]",
    ];
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let arguments = ["optimise", path, "--out", directory].into_iter();
    run(&arguments.chain(sets).collect::<Vec<_>>(), 0);
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let mean_square = |name: &str| {
        let all = summary["targets"].as_array().unwrap().iter();
        let own = all.filter(|target| target["output"].as_str().unwrap().starts_with(name));
        let squares: Vec<f64> = own
            .map(|target| target["after"]["rms"].as_f64().unwrap().powi(2))
            .collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let kept = ["ackermann_error", "force_roll_centre_height"].map(mean_square);
    let file = fs::read(out.join("front.csv")).unwrap();
    let points: Vec<[f64; 2]> = crate::support::rows_by_column(&file)
        .iter()
        .map(|row| {
            ["misfit_ackermann_error", "misfit_force_roll_centre_height"]
                .map(|column| row[column].parse().unwrap())
        })
        .collect();
    let (first, last) = (points[0], points[points.len() - 1]);
    let apart = [last[0] - first[0], first[1] - last[1]].map(|extent| extent / 25.0);
    // Each end of a Pareto front is a minimum of one goal, accurate to 0.01 %.
    let is_as_good = |point: &[f64; 2]| (0..2).all(|k| point[k] <= 1.0001 * kept[k] + apart[k]);
    assert!(points.iter().any(is_as_good), "{kept:?} {points:?}");
}

/// A sweep of axles writes identical files with one CPU thread and with two CPU threads. It also writes a page.
#[test]
fn axles_are_swept() {
    if !crate::support::has_lanes() {
        return;
    }
    let text = fs::read_to_string(study("macpherson_axle_front.toml")).unwrap();
    let head = text.split("[optimise]").next().unwrap();
    let place = folder("swept");
    fs::create_dir_all(&place).unwrap();
    let file = place.join("study.toml");
    let sweep = "[sweep]\nmethod = \"grid\"\nvariables = [{ hardpoint = \"tie_rod_outer\", axis = \"x\", range = [-20.0, 20.0], steps = 150 }]\n";
    fs::write(&file, format!("{head}{sweep}")).unwrap();
    let few = [
        "motion.roll=[-2.0, 2.0]",
        "motion.heave=0.0",
        "motion.steering_wheel_angle=[-180.0, 180.0]",
        "outputs.characteristics=[\"roll_steer\", \"ackermann_error\", \"mean_steer\"]",
    ];
    let file = file.to_str().unwrap();
    let swept = |more: &[&str]| {
        let mut arguments = vec!["sweep", file];
        arguments.extend(few.iter().flat_map(|set| ["--set", set]));
        arguments.extend(more);
        run(&arguments, 0)
    };
    let (one, _) = swept(&["--out", "-", "--threads", "1"]);
    let (two, _) = swept(&["--out", "-", "--threads", "2"]);
    assert_eq!(one, two);
    assert_eq!(one.lines().count(), 151);
    let out = place.join("out");
    swept(&["--out", out.to_str().unwrap(), "--report"]);
    assert_eq!(fs::read_to_string(out.join("designs.csv")).unwrap(), one);
    assert!(out.join("report.html").is_file());
    let (text, _) = swept(&["--design", "149"]);
    assert!(text.contains("-110.0"), "{text}");
    let (said, _) = run(&["check", file, "--set", few[0]], 0);
    assert!(
        said.contains("150 designs") && !said.contains("one by one"),
        "{said}"
    );
    let further = "outputs.characteristics=[\"roll_centre_migration_lateral\", \"steer\"]";
    let (said, _) = run(&["check", file, "--set", further], 0);
    let words = "one by one instead of several at once in SIMD lanes: lanes do not support a requested output: roll_centre_migration_lateral.";
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains(words), "{said}");
    swept(&[
        "--out",
        out.to_str().unwrap(),
        "--force",
        "--set",
        "sweep.curves=true",
    ]);
    let curves = fs::read_to_string(out.join("curves.csv")).unwrap();
    let mut lines = curves.lines();
    assert_eq!(
        lines.next(),
        Some(
            "design,roll_deg,heave_mm,steering_wheel_angle_deg,left_roll_steer_deg_per_deg,right_roll_steer_deg_per_deg,\
             roll_steer_deg_per_deg,ackermann_error_deg,mean_steer_deg,status"
        )
    );
    // The file has 4 stations per design: two roll angles times two steering wheel angles. Each station has the values that
    // `solve` finds for the study of this design.
    assert_eq!(curves.lines().count(), 1 + 150 * 4);
    let design = place.join("149.toml");
    fs::write(&design, text).unwrap();
    let (solved, _) = run(&["solve", design.to_str().unwrap(), "--out", "-"], 0);
    let numbers = |line: &str, from: usize| -> Vec<f64> {
        let cells = line.split(',').skip(from);
        cells.filter_map(|cell| cell.parse().ok()).collect()
    };
    for (ours, theirs) in curves.lines().skip(1 + 149 * 4).zip(solved.lines().skip(1)) {
        let (ours, mut theirs) = (numbers(ours, 1), numbers(theirs, 0));
        // Removes the columns of the travels and of the rack displacement. The solver finds the travels, and the rack
        // displacement follows from the steering wheel angle.
        theirs.drain(2..5);
        assert_eq!((ours.len(), &ours[..3]), (8, &theirs[..3]));
        for (a, b) in ours.iter().zip(&theirs) {
            assert!((a - b).abs() < 1e-9, "{ours:?} {theirs:?}");
        }
    }
}

/// Messages of a run, joined into one line.
fn said(arguments: &[&str], sets: &[&str], code: i32) -> String {
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let arguments: Vec<&str> = arguments.iter().copied().chain(sets).collect();
    let (out, err) = run(&arguments, code);
    let words = format!("{out} {err}");
    words.split_whitespace().collect::<Vec<_>>().join(" ")
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

/// Equal tolerances scatter both wheels alike, in mirror image. Additional scatter of one side affects only that side.
#[test]
fn the_wheels_of_the_sample_scatter_alike_but_for_the_slotted_hole() {
    let out = folder("tolerance");
    fs::create_dir_all(&out).unwrap();
    let text = fs::read_to_string(study("five_link_axle_tolerance.toml")).unwrap();
    let is_common = |line: &&str| !line.contains("side = \"right\"");
    let alike: Vec<&str> = text.lines().filter(is_common).collect();
    // Mirrored first-order standard deviations of the left and right wheel.
    let sigmas = |text: &str, quantity: &str, roll: f64| -> [f64; 2] {
        let path = out.join("study.toml");
        fs::write(&path, text).unwrap();
        let path = path.to_str().unwrap();
        let (csv, _) = run(
            &[
                "tolerance",
                path,
                "--out",
                "-",
                "--set",
                "tolerance.builds=100",
            ],
            0,
        );
        let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        let column = rows[0].iter().position(|c| *c == "sigma_linear").unwrap();
        [("left", roll), ("right", -roll)].map(|(side, roll)| {
            let is_it = |row: &&Vec<&str>| {
                row[0] == format!("{side}_{quantity}_deg") && row[1].parse() == Ok(roll)
            };
            rows.iter().find(is_it).unwrap()[column].parse().unwrap()
        })
    };
    for roll in [-3.0, 0.0, 2.0] {
        let [left, right] = sigmas(&text, "toe", roll);
        assert!(right > 1.1 * left, "{left} {right}");
        for quantity in ["toe", "camber"] {
            let [left, right] = sigmas(&alike.join("\n"), quantity, roll);
            assert!((left - right).abs() < 1e-12, "{quantity}: {left} {right}");
        }
    }
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

/// The same axle in another coordinate frame has the same results. Only the rack displacement, which is along the
/// frame's y axis, changes its sign.
#[test]
fn frames_change_the_rack_alone() {
    let solved = |set: &[&str]| {
        let path = study("macpherson_axle.toml");
        let mut arguments = vec!["solve", path.to_str().unwrap(), "--out", "-"];
        for set in set {
            arguments.extend(["--set", set]);
        }
        let (csv, _) = run(&arguments, 0);
        csv
    };
    let plain = solved(&["steering.c_factor=-60.0"]);
    let text = fs::read_to_string(study("macpherson_axle.toml")).unwrap();
    let mut mirrored = String::new();
    for line in text.lines() {
        let point = line.split_once('[').and_then(|(name, rest)| {
            let (numbers, _) = rest.split_once(']')?;
            let numbers: Vec<f64> = numbers
                .split(',')
                .map_while(|n| n.trim().parse().ok())
                .collect();
            match (name.contains('='), numbers.as_slice()) {
                (true, [x, y, z]) if !name.contains("heave") => {
                    Some(format!("{name}[{x:?}, {:?}, {:?}]", -y, -z))
                }
                _ => None,
            }
        });
        mirrored += &point.unwrap_or_else(|| line.to_owned());
        mirrored += "\n";
    }
    let mirrored = mirrored
        .replace("topology =", "frame = \"sae_j670\"\ntopology =")
        .replace("c_factor = -52.0", "c_factor = 60.0");
    let folder = folder("sae");
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("sae.toml");
    fs::write(&file, mirrored).unwrap();
    let (sae, _) = run(&["solve", file.to_str().unwrap(), "--out", "-"], 0);
    let rack = plain
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|c| c == "rack_mm")
        .unwrap();
    for (one, two) in plain.lines().zip(sae.lines()).skip(1) {
        let [one, two] = [one, two].map(|line| line.split(',').collect::<Vec<_>>());
        for (column, (one, two)) in one.iter().zip(&two).enumerate() {
            if column == rack {
                assert_eq!(one.parse::<f64>().unwrap(), -two.parse::<f64>().unwrap())
            } else {
                assert_eq!(one, two)
            }
        }
    }
}

/// The table in `docs/axle.md` equals the catalogue. To renew it, run `UPDATE_README=1 cargo test --test it
/// axle::commands::the_table`.
#[test]
fn the_table_of_quantities_is_the_catalogue() {
    let need = |need: &Need| match need {
        Need::WheelRadius => "radius",
        Need::RimDiameter => "rim_diameter",
        Need::Wheelbase => "wheelbase",
        Need::CFactor => "c_factor",
        Need::SpringForce => "[spring]",
        Need::BarRate => "[anti_roll_bar]",
        Need::TorsionalRate => "[twist_beam]",
        Need::TyreRate => "[tyre]",
        Need::SprungMass => "sprung_mass",
        Need::UnsprungMass => "unsprung_mass",
        need => need.words(),
    };
    let row = |info: &Info, of: &str| {
        let needs: Vec<_> = info.needs.iter().map(need).collect();
        format!(
            "| `{}` | {of} | {} | {} | {} |\n",
            info.name,
            info.formula,
            info.positive,
            needs.join(", ")
        )
    };
    let mut table =
        String::from("| name | of | formula | positive | needs |\n|---|---|---|---|---|\n");
    table.extend(WheelQuantity::ALL.iter().map(|q| row(q.info(), "wheel")));
    table.extend(AxleQuantity::ALL.iter().map(|q| row(q.info(), "axle")));
    let path = Path::new(ROOT).join("docs/axle.md");
    let text = fs::read_to_string(&path).unwrap();
    let (start, end) = ("<!-- quantities -->\n", "<!-- /quantities -->");
    let (from, to) = (
        text.find(start).unwrap() + start.len(),
        text.find(end).unwrap(),
    );
    if std::env::var_os("UPDATE_README").is_some() {
        fs::write(&path, format!("{}{table}{}", &text[..from], &text[to..])).unwrap();
    } else {
        assert_eq!(&text[from..to], table);
    }
}

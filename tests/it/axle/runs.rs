//! Tests of tunings, sweeps and tolerance analyses of axles, as a user runs them.

use super::commands::{folder, run, study};
use crate::support::one_line;
use std::fs;

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
    let words = "one by one, not several at once in SIMD lanes: lanes do not support a requested output: roll_centre_migration_lateral.";
    let said = one_line(&said);
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
    assert_eq!(solved.lines().count(), 1 + 4);
    for (ours, theirs) in curves.lines().skip(1 + 149 * 4).zip(solved.lines().skip(1)) {
        let (ours, mut theirs) = (numbers(ours, 1), numbers(theirs, 0));
        // Removes the columns of the travels and of the rack displacement. The solver finds the travels, and the rack
        // displacement follows from the steering wheel angle.
        theirs.drain(2..5);
        assert_eq!((ours.len(), theirs.len()), (8, 8));
        assert_eq!(ours[..3], theirs[..3]);
        for (a, b) in ours.iter().zip(&theirs) {
            assert!((a - b).abs() < 1e-9, "{ours:?} {theirs:?}");
        }
    }
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

//! Tests of `hardpoint export` as a user runs it: protected files, curves and their points.

use super::{Said, imported};
use crate::support::studies;
use assert_cmd::Command;
use hardpoint::exchange::{Outgoing, Page, curves_in, page_of_csv, point_rows, workbook};
use hardpoint::model::LengthUnit;
use hardpoint::number::Vector3;
use hardpoint::solved::Solved;
use hardpoint::study::Study;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub(super) fn run(arguments: &[&str], code: i32) -> (String, String) {
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    let assert = command.args(arguments).assert().code(code);
    let output = assert.get_output();
    [&output.stdout, &output.stderr]
        .map(|bytes| String::from_utf8_lossy(bytes).into_owned())
        .into()
}

/// Points of a table by name.
pub(super) fn points(path: &Path) -> BTreeMap<String, [f64; 3]> {
    let text = std::fs::read_to_string(path).unwrap();
    let rows = text.lines().skip(1).filter_map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |n: usize| cells[n].parse::<f64>().ok();
        Some((cells[0].to_owned(), [number(1)?, number(2)?, number(3)?]))
    });
    rows.collect()
}

/// An export with rounding writes rounded points to the workbook, in every unit. The curves in the workbook are the
/// curves of the rounded points.
#[test]
fn a_rounded_workbook_has_the_curves_of_its_points() {
    let directory = tempfile::tempdir().unwrap();
    let path = studies().join("double_wishbone_solve.toml");
    let run_directory = directory.path().join("run");
    let of_run = run_directory.to_str().unwrap();
    run(&["-q", "solve", path.to_str().unwrap(), "--out", of_run], 0);
    for source in [path.to_str().unwrap(), of_run] {
        for unit in LengthUnit::ALL {
            let step = match unit {
                LengthUnit::Millimetre => "5",
                LengthUnit::Metre => "0.005",
                LengthUnit::Inch | LengthUnit::InchPound => "0.25",
            };
            let book = directory.path().join("book.xlsx");
            let rounding = ["--round", step, "--round-all", "--unit", unit.symbol()];
            let call = ["export", source, "--to", "xlsx", "--force", "--out"];
            let call = [&call[..], &[book.to_str().unwrap()], &rounding].concat();
            let (_, said) = run(&call, 0);
            assert!(
                said.contains(&format!("rounded to {step} {}", unit.symbol())),
                "{said}"
            );

            // Every coordinate is a multiple of the rounding step, and the curves in the workbook are those of these
            // points.
            let study = Study::read(&path, &[]).unwrap();
            let suspension = study.wheel();
            let table = exported_points(&call, directory.path());
            let found = points(&table);
            let said_there = Said {
                sheet: Some("hardpoints"),
                ..Said::default()
            };
            let read = imported(&book, "double_wishbone", &said_there).unwrap();
            assert_eq!(read.unit, unit);
            for hardpoint in &read.hardpoints {
                assert_eq!(hardpoint.position, found[hardpoint.name]);
            }
            let step: f64 = step.parse().unwrap();
            let mut moved = 0;
            let design = suspension
                .mechanism
                .points
                .iter()
                .enumerate()
                .map(|(n, point)| {
                    let written = found[&point.name];
                    for x in written {
                        assert!((x / step - (x / step).round()).abs() < 1e-9, "{x}");
                    }
                    let place = Vector3::from(written);
                    let place = place.map(|x| suspension.length_unit.convert_decimal(x, unit));
                    let place = suspension.frame.vector(place);
                    moved += usize::from(place != suspension.design[n]);
                    // A coordinate that does not change keeps its bits.
                    let keep = |a: f64, b: f64| if (a - b).abs() < 1e-9 { b } else { a };
                    let own = suspension.design[n];
                    Vector3::new(
                        keep(place.x, own.x),
                        keep(place.y, own.y),
                        keep(place.z, own.z),
                    )
                });
            let design: Vec<_> = design.collect();
            assert!(moved > 3);
            let study = study.at_design(design);
            let outgoing = Outgoing::of(&study, Some(unit), None);
            let csv = Solved::of(&study).unwrap().csv();
            let curves = curves_in(&outgoing, page_of_csv("curves", &csv).unwrap());
            let hardpoints = page_of_csv("hardpoints", &std::fs::read(&table).unwrap());
            let mut pages = vec![hardpoints.unwrap(), curves];
            if source == of_run {
                let of_run = std::fs::read(run_directory.join("curves.csv")).unwrap();
                let of_run = page_of_csv("curves_of_solve", &of_run).unwrap();
                pages.push(curves_in(&outgoing, of_run));
                assert!(
                    said.contains("The sheet curves is solved for the exported points."),
                    "{said}"
                );
            }
            assert!(
                std::fs::read(&book).unwrap() == workbook(&pages),
                "{unit:?} {source}"
            );
        }
    }
}

/// Exports the same points as a table.
fn exported_points(call: &[&str], directory: &Path) -> PathBuf {
    let table = directory.join("points.csv");
    let mut call = call.to_vec();
    call[3] = "csv";
    call[6] = table.to_str().unwrap();
    run(&call, 0);
    table
}

/// An exported run has the curves of the run, if the points are unchanged.
#[test]
fn a_run_has_its_own_curves() {
    let directory = tempfile::tempdir().unwrap();
    let path = studies().join("macpherson_solve.toml");
    let out = directory.path().join("run");
    let [path, out] = [&path, &out].map(|p| p.to_str().unwrap());
    run(&["-q", "solve", path, "--out", out], 0);
    let book = directory.path().join("book.xlsx");
    let to_book = ["--to", "xlsx", "--force", "--out", book.to_str().unwrap()];
    let (_, said) = run(&[&["export", out][..], &to_book].concat(), 0);
    assert!(!said.contains("curves_of"), "{said}");
    let study = Study::read(Path::new(path), &[]).unwrap();
    let outgoing = Outgoing::of(&study, None, None);
    let csv = std::fs::read(Path::new(out).join("curves.csv")).unwrap();
    let curves = curves_in(&outgoing, page_of_csv("curves", &csv).unwrap());
    let name = "hardpoints".to_owned();
    let rows = point_rows(&outgoing);
    let expected = workbook(&[Page { name, rows }, curves]);
    assert!(std::fs::read(&book).unwrap() == expected);
    // If --set has moved points, the curves are different.
    let moved = "suspension.hardpoints.tie_rod_inner=[-110.0, 335.0, 240.0]";
    let (_, said) = run(
        &[&["export", out, "--set", moved][..], &to_book].concat(),
        0,
    );
    assert!(
        said.contains("The sheet curves_of_solve has the curves of the run"),
        "{said}"
    );
    // A CSV table has no sheets.
    let to_table = ["--to", "csv", "--force", "--out"];
    let table = directory.path().join("points.csv");
    let call = ["export", out, "--set", moved];
    let (_, said) = run(
        &[&call[..], &to_table, &[table.to_str().unwrap()]].concat(),
        0,
    );
    assert!(!said.contains("sheet"), "{said}");
}

/// A command never overwrites its inputs, under any name.
#[test]
fn inputs_are_never_written_over() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let study = at("study.toml");
    std::fs::copy(studies().join("macpherson_solve.toml"), &study).unwrap();
    let kept = std::fs::read(&study).unwrap();
    run(
        &["export", &study, "--to", "adams", "--out", &at("front.sub")],
        0,
    );
    let sub = std::fs::read(at("front.sub")).unwrap();
    let mut names = vec![study.clone()];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&study, at("link.csv")).unwrap();
        std::fs::hard_link(&study, at("same.csv")).unwrap();
        names.extend([at("link.csv"), at("same.csv")]);
    }
    for out in &names {
        let (_, said) = run(
            &["export", &study, "--to", "csv", "--force", "--out", out],
            2,
        );
        assert!(said.contains("an input of this command"), "{said}");
        assert_eq!(std::fs::read(out).unwrap(), kept);
    }
    let into = [
        "export",
        &study,
        "--to",
        "adams",
        "--into",
        &at("front.sub"),
        "--force",
        "--out",
    ];
    run(&[&into[..], &[&at("front.sub")]].concat(), 2);
    assert_eq!(std::fs::read(at("front.sub")).unwrap(), sub);
    let import = [
        "import",
        &at("front.sub"),
        "--topology",
        "macpherson",
        "--force",
        "--out",
    ];
    run(&[&import[..], &[&at("front.sub")]].concat(), 2);
    assert_eq!(std::fs::read(at("front.sub")).unwrap(), sub);
    // The files of a run count as its inputs.
    run(&["-q", "solve", &study, "--out", &at("run")], 0);
    let curves = directory.path().join("run/curves.csv");
    let before = std::fs::read(&curves).unwrap();
    let to_curves = [
        "--to",
        "csv",
        "--curves",
        "--force",
        "--out",
        curves.to_str().unwrap(),
    ];
    run(&[&["export", &at("run")][..], &to_curves].concat(), 2);
    assert_eq!(std::fs::read(&curves).unwrap(), before);
}

/// The program names and refuses options that cannot be combined, and writes nothing.
#[test]
fn calls_that_make_no_sense_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = studies().join("double_wishbone_solve.toml");
    let path = path.to_str().unwrap();
    let out = directory.path().join("x.stl");
    let out = out.to_str().unwrap();
    for (more, words) in [
        (
            vec!["--to", "csv", "--travel", "-3..3"],
            "--travel needs --to stl",
        ),
        (vec!["--to", "dxf", "--curves"], "--curves needs --to csv"),
        (
            vec!["--to", "csv", "--round-all"],
            "--round-all needs --round",
        ),
        (
            vec!["--to", "csv", "--names", "spmm"],
            "no public source defines",
        ),
        (
            vec!["--to", "adams", "--frame", "iso8855"],
            "an Adams/Car subsystem always has the axes x_rear",
        ),
        (
            vec!["--to", "optimumk", "--frame", "sae_j670"],
            "OptimumKinematics always has the axes iso8855",
        ),
        (vec!["--to", "assetto", "--unit", "mm"], "is in metres"),
        (
            vec!["--to", "stl", "--travel", "-3..3"],
            "give a file with --out",
        ),
        (
            vec!["--to", "stl", "--travel", "3", "--out", out],
            "expected two lengths",
        ),
        (
            vec!["--to", "stl", "--travel", "-3..3/1", "--out", out],
            "expected 2 to 200 values",
        ),
        (
            vec!["--to", "stl", "--travel", "-3..3", "--out", out],
            "[wheel] tyre_width is missing",
        ),
        (
            vec![
                "--to",
                "stl",
                "--set",
                "wheel.tyre_width=200.0",
                "--out",
                out,
            ],
            "--to stl needs --travel",
        ),
    ] {
        let (_, said) = run(&[&["export", path][..], &more].concat(), 2);
        assert!(said.contains(words), "{words}: {said}");
    }
    let narrow = ["--to", "dxf", "--set", "wheel.tyre_width=-1.0"];
    let (_, said) = run(&[&["export", path][..], &narrow].concat(), 2);
    assert!(said.contains("expected a number above 0"), "{said}");
    assert!(!Path::new(out).exists());
    let far = [
        "--to",
        "stl",
        "--travel",
        "-3..3000",
        "--out",
        out,
        "--set",
        "wheel.tyre_width=200.0",
    ];
    let (_, said) = run(&[&["export", path][..], &far].concat(), 1);
    assert!(said.contains("left wheel at travel"), "{said}");
    assert!(!Path::new(out).exists());
}

/// Export writes the curves of a study as a table, in other units and with other names.
#[test]
fn curves_go_out_as_a_table() {
    let path = studies().join("macpherson_front.toml");
    let path = path.to_str().unwrap();
    let (ours, _) = run(
        &["export", path, "--to", "csv", "--curves", "--unit", "in"],
        0,
    );
    assert!(ours.starts_with("travel_in,"), "{ours}");
    assert!(
        ours.lines().next().unwrap().ends_with(",status,side,frame"),
        "{ours}"
    );
    assert!(
        ours.lines().nth(1).unwrap().ends_with(",left,iso8855"),
        "{ours}"
    );
    let (named, said) = run(&["export", path, "--to", "csv", "--names", "adams"], 0);
    assert!(named.contains("camber_angle.left [deg]"), "{named}");
    assert!(!said.contains("camber_deg"), "{said}");
    let solved = run(&["-q", "solve", path, "--out", "-"], 0).0;
    let column = |text: &str, name: &str| {
        let place = text
            .lines()
            .next()
            .unwrap()
            .split(',')
            .position(|n| n == name)
            .unwrap();
        let cells = text
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(place).unwrap().parse::<f64>().unwrap());
        cells.collect::<Vec<_>>()
    };
    assert_eq!(
        column(&named, "camber_angle.left [deg]"),
        column(&solved, "camber_deg")
    );
    let inches = column(&ours, "travel_in");
    for (inch, mm) in inches.iter().zip(column(&solved, "travel_mm")) {
        assert!((inch * 25.4 - mm).abs() < 1e-12);
    }
}

/// `-` means standard output, as for commands that write directories. The program writes no file with this name.
#[test]
fn a_dash_is_standard_output() {
    let directory = tempfile::tempdir().unwrap();
    let study = studies().join("macpherson_solve.toml");
    let run = |arguments: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
        command
            .current_dir(directory.path())
            .arg("export")
            .arg(&study);
        command
            .args(arguments)
            .assert()
            .success()
            .get_output()
            .stdout
            .clone()
    };
    let plain = run(&["--to", "csv"]);
    assert!(plain.len() > 200);
    assert_eq!(run(&["--to", "csv", "--out", "-"]), plain);
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
}

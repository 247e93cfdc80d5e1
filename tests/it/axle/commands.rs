//! Tests of the commands with studies of axles, as a user runs them.

use crate::support::one_line;
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
        let mut stations = csv.lines().skip(1);
        assert!(csv.lines().count() > 30, "{csv}");
        assert!(stations.all(|line| line.ends_with(",ok")), "{csv}");
        let (again, _) = run(&["solve", path, "--out", "-"], 0);
        assert_eq!(again, csv);
    }
}

/// Sensitivities name the side and the hardpoint. Outputs and units have the same names as in the sensitivity file of one wheel.
#[test]
fn sensitivities_of_an_axle_have_the_names_of_one_wheel() {
    let sensitivities = folder("five_link_axle_again");
    let path = study("five_link_axle.toml");
    let [path, directory] = [&path, &sensitivities].map(|p| p.to_str().unwrap());
    run(&["solve", path, "--out", directory], 0);
    let csv = fs::read_to_string(sensitivities.join("sensitivities.csv")).unwrap();
    assert!(csv.contains(",roll_steer,left,toe_link_inner,z,"), "{csv}");
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

/// The given track may be the distance of the wheel centres or the distance of the contact points. Any other track gives a
/// warning with both distances. This holds for an axle and for one wheel.
#[test]
fn a_track_agrees_with_wheel_centres_or_contact_points() {
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
            one_line(&run(&arguments, 0).0)
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
        let said = one_line(&said);
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
    let mut circles = 0;
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
        circles += 1;
    }
    // Half of the stations are steered.
    assert_eq!(2 * circles, rows.len());
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

//! Tests of commands for studies with elastic parts, as a user runs them.

use crate::support::rows_by_column;
use std::path::Path;
use std::process::{Command, Output};

pub fn hardpoint(arguments: &[&str], directory: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hardpoint"))
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap()
}

pub fn study(name: &str) -> String {
    let path = crate::support::studies().join(name);
    path.display().to_string()
}

fn rows(path: &Path) -> Vec<csv::StringRecord> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.records().map(Result::unwrap).collect()
}

#[test]
fn kc_writes_figures_levels_and_the_matrix() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("double_wishbone_compliance.toml");
    let ran = hardpoint(&["kc", &path, "--out", "kc"], directory.path());
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert_eq!(
        ran.status.code(),
        Some(0),
        "{said}{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    assert!(said.contains("toe_by_lateral_force") && said.contains("design load: 4682 N"));
    let figures = rows(&directory.path().join("kc/kc.csv"));
    // Values of the reference suspension at its design height: tests/data/reference/elasto.
    let value = |load: &str, trail: &str, quantity: &str| -> f64 {
        let row = figures
            .iter()
            .find(|row| &row[2] == load && &row[4] == trail && &row[9] == quantity);
        row.unwrap_or_else(|| panic!("{quantity}"))[10]
            .parse()
            .unwrap()
    };
    let per_kilonewton = 1000.0_f64.to_degrees();
    for (found, expected) in [
        (
            value("lateral", "0.0", "toe_by_lateral_force"),
            8.01723593199302e-7 * per_kilonewton,
        ),
        (
            value("lateral", "0.0", "camber_by_lateral_force"),
            4.56633741523367e-7 * per_kilonewton,
        ),
        (
            value("lateral", "0.0", "contact_by_lateral_force"),
            2.17364662478179e-4 * 1000.0,
        ),
        (
            value("lateral", "30.0", "toe_by_lateral_force"),
            6.88275823562774e-7 * per_kilonewton,
        ),
        (
            value("aligning", "", "toe_by_aligning_moment"),
            -3.78159988439469e-9 * 1e5_f64.to_degrees(),
        ),
        (
            value("braking", "", "toe_by_braking"),
            6.57802096512894e-7 * per_kilonewton,
        ),
        (
            value("braking", "", "recession_by_braking"),
            5.90204424586487e-4 * 1000.0,
        ),
        (
            value("lateral", "0.0", "jacking_by_lateral_force"),
            0.110384332605338,
        ),
        (
            value("vertical", "", "compliant_wheel_rate"),
            44.5411779348996,
        ),
    ] {
        assert!(
            (found - expected).abs() < 1e-10 * expected.abs(),
            "{found} {expected}"
        );
    }
    let levels = rows(&directory.path().join("kc/levels.csv"));
    assert_eq!(levels.len(), 6 * 11);
    assert!(levels.iter().all(|row| &row[row.len() - 1] == "ok"));
    assert_eq!(
        rows(&directory.path().join("kc/compliance_matrix.csv")).len(),
        6
    );
}

/// For a study without elastic parts, `kc` gives kinematics and jacking, and no results of test loads that only elastic parts
/// have.
#[test]
fn a_rigid_study_has_its_kinematics_and_jacking() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("macpherson_solve.toml");
    let ran = hardpoint(&["kc", &path, "--out", "-"], directory.path());
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert_eq!(
        ran.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    assert!(said.contains("toe_by_heave") && said.contains("jacking_by_lateral_force"));
    assert!(!said.contains("toe_by_lateral_force"));
}

/// All commands that support elastic parts run on a study with elastic parts. The test includes pages, pictures, and the
/// list of misfits against the size of the change.
#[test]
fn commands_take_elastic_parts() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let more = r#"
[outputs]
characteristics = ["toe", "camber", "toe_by_lateral_force"]

[optimise]
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.3, 3.0], relative = true },
]
targets = [
  { characteristic = "toe", points = [[-40.0, 0.0], [40.0, 0.05]], tolerance = 0.1 },
  { characteristic = "toe_by_lateral_force", value = 0.04, tolerance = 0.005 },
]

[sweep]
method = "sobol"
samples = 8
variables = [{ bushing = "lower_arm_rear", stiffness = "y", range = [0.5, 2.0], relative = true }]

[tolerance]
builds = 40
scatter = [{ bushing = "lower_arm_rear", stiffness = "y", sigma = 0.1, relative = true }]
bands = [{ characteristic = "toe_by_lateral_force", at_most = 0.2 }]
"#;
    let path = extended(at, more);
    let done = |arguments: &[&str]| {
        let ran = hardpoint(arguments, at);
        let said = String::from_utf8_lossy(&ran.stdout).into_owned();
        let complained = String::from_utf8_lossy(&ran.stderr).into_owned();
        assert_eq!(
            ran.status.code(),
            Some(0),
            "{arguments:?}: {said}{complained}"
        );
        said + &complained
    };
    done(&[
        "solve", &path, "--out", "solve", "--report", "--plots", "plots",
    ]);
    let curves = rows(&at.join("solve/curves.csv"));
    assert_eq!(curves.len(), 5);
    assert!(curves.iter().all(|row| &row[row.len() - 1] == "ok"));
    let page = std::fs::read_to_string(at.join("solve/report.html")).unwrap();
    assert!(page.contains("toe_by_lateral_force") && at.join("plots").is_dir());
    let said = done(&["optimise", &path, "--out", "tuned", "--report", "--prices"]);
    assert!(said.contains("bushing:lower_arm_rear"), "{said}");
    let found = figure(&at.join("tuned/kc.csv"), "toe_by_lateral_force");
    let tuned = rows(&at.join("tuned/curves.csv"));
    let own: f64 = tuned[2][3].parse().unwrap();
    assert!((found - own).abs() < 1e-12, "{found} {own}");
    done(&["sweep", &path, "--out", "sweep", "--report"]);
    done(&["tolerance", &path, "--out", "builds", "--report"]);
    let build = done(&["tolerance", &path, "--build", "3"]);
    assert!(build.contains("[bushings.lower_arm_rear]") && !build.contains("2500.0"));
    done(&["sweep", &path, "--design", "3"]);
    done(&["compare", &path, "tuned/optimised.toml"]);
    let said = done(&["export", "tuned", "--to", "dxf", "--out", "tuned.dxf"]);
    assert!(said.contains("Elastic parts are not exported"), "{said}");
    done(&[
        "export",
        &path,
        "--to",
        "csv",
        "--curves",
        "--out",
        "curves.csv",
    ]);
    let found = rows(&at.join("curves.csv"));
    assert_eq!(found.len(), curves.len());
}

/// If a load is too large for the wheel, `kc` still writes all other results. It states the largest fraction of the load
/// that has an equilibrium, and exits with code 1.
#[test]
fn a_load_that_is_not_held_is_said() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("double_wishbone_compliance.toml");
    let tests =
        "compliance.tests=[{ load = \"lateral\", hold = \"wheel_load\", window = 90000.0 }]";
    let ran = hardpoint(
        &["kc", &path, "--out", "kc", "--set", tests],
        directory.path(),
    );
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert_eq!(
        ran.status.code(),
        Some(1),
        "{said}{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    assert!(
        crate::support::one_line(&said).contains("equilibria exist only for the first 7")
            && said.contains("not solved"),
        "{said}"
    );
    let levels = rows(&directory.path().join("kc/levels.csv"));
    assert!(
        levels
            .iter()
            .any(|row| &row[row.len() - 1] == "no_equilibrium")
    );
}

/// Appends text to the sample study and writes the result to a file in the directory. Returns the path of the file.
fn extended(directory: &Path, more: &str) -> String {
    let text = std::fs::read_to_string(study("double_wishbone_compliance.toml")).unwrap();
    let path = directory.join("study.toml");
    std::fs::write(&path, text + more).unwrap();
    path.display().to_string()
}

/// Value of a test result in `kc.csv`. If the table also has this result with a trail of 30 mm, skips that row.
fn figure(path: &Path, quantity: &str) -> f64 {
    let figures = rows(path);
    let is_wanted = |row: &&csv::StringRecord| &row[9] == quantity && &row[4] != "30.0";
    figures.iter().find(is_wanted).unwrap()[10].parse().unwrap()
}

/// For a hardpoint and a rate, `sensitivities.csv` contains derivatives of test results. They equal the differences
/// between two runs of `kc`, divided by the change of the input.
#[test]
fn sensitivities_are_changes_of_figures() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let path = extended(at, "[outputs]\nsensitivities = [\"tie_rod_inner\"]\n");
    let ran = hardpoint(&["kc", &path, "--out", "kc"], at);
    assert_eq!(
        ran.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    let slopes = rows(&at.join("kc/sensitivities.csv"));
    let quantity = "toe_by_lateral_force";
    let inputs = [
        (
            "tie_rod_inner",
            "z",
            "suspension.hardpoints.tie_rod_inner",
            "[-130.0, 385.0, N]",
            235.0,
            0.05,
        ),
        (
            "bushing:lower_arm_rear",
            "y",
            "bushings.lower_arm_rear.stiffness",
            "[700.0, N, 1800.0, 8.0e4, 2.5e5, 2.5e5]",
            2500.0,
            5.0,
        ),
    ];
    for (parameter, axis, key, list, value, step) in inputs {
        let row = slopes.iter().find(|row| {
            &row[5] == quantity && &row[6] == parameter && &row[7] == axis && &row[3] == "0.0"
        });
        let slope: f64 = row.unwrap()[8].parse().unwrap();
        let at_value = |value: f64, out: &str| {
            let set = format!("{key}={}", list.replace('N', &format!("{value:?}")));
            let ran = hardpoint(&["kc", &path, "--set", &set, "--out", out], at);
            assert_eq!(
                ran.status.code(),
                Some(0),
                "{}",
                String::from_utf8_lossy(&ran.stderr)
            );
            figure(&at.join(out).join("kc.csv"), quantity)
        };
        let name = parameter.replace(':', "_");
        let (low, high) = (
            at_value(value - step, &format!("{name}_low")),
            at_value(value + step, &format!("{name}_high")),
        );
        let expected = (high - low) / (2.0 * step);
        assert!(slope != 0.0);
        assert!(
            (slope - expected).abs() < 1e-5 * slope.abs(),
            "{parameter}: {slope} {expected}"
        );
    }
}

/// The tuned study has the target value of the test result.
#[test]
fn a_rate_is_tuned_to_a_figure() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let more = r#"
[optimise]
good_enough = 0.0
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.3, 3.0], relative = true },
]
targets = [
  { characteristic = "toe", at = 20.0, value = 0.05, tolerance = 0.02 },
  { figure = "toe_by_lateral_force", value = 0.04, tolerance = 0.005 },
]
"#;
    let path = extended(at, more);
    let ran = hardpoint(&["optimise", &path, "--out", "tuned"], at);
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    let complained = String::from_utf8_lossy(&ran.stderr).into_owned();
    assert_eq!(ran.status.code(), Some(0), "{said}{complained}");
    assert!(said.contains("bushing:lower_arm_rear"), "{said}");
    let found = figure(&at.join("tuned/kc.csv"), "toe_by_lateral_force");
    assert!((found - 0.04).abs() < 1e-9, "{found}");
    let ran = hardpoint(&["kc", "tuned/optimised.toml", "--out", "kc"], at);
    assert_eq!(
        ran.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    let found = figure(&at.join("kc/kc.csv"), "toe_by_lateral_force");
    assert!((found - 0.04).abs() < 1e-9, "{found}");
}

/// The page of the tests shows toe against lateral force, with the slope of the test result. It has charts for each load.
#[test]
fn the_page_draws_the_figures() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("double_wishbone_compliance.toml");
    let ran = hardpoint(&["kc", &path, "--report", "--out", "kc"], directory.path());
    assert_eq!(ran.status.code(), Some(0));
    let page = std::fs::read_to_string(directory.path().join("kc/report.html")).unwrap();
    // Value of the reference corner.
    let toe = 8.01723593199302e-7 * 1000.0_f64.to_degrees();
    assert!(page.contains(&format!("Toe by lateral force {toe:.5} deg/kN")));
    for load in [
        "lateral force",
        "braking force",
        "traction force",
        "aligning moment",
    ] {
        assert!(
            page.contains(&format!("toe by {load} [\u{b0}] over")),
            "{load}"
        );
    }
    let start = page.find("aria-label=\"toe by lateral force").unwrap();
    let chart = &page[start..start + page[start..].find("</svg>").unwrap()];
    // Ticks of the vertical axis with position and value, then the ends of the line at -1000 N and 1000 N.
    let ticks: Vec<[f64; 2]> = chart
        .split("<text class=\"axis-text\" ")
        .filter(|text| text.contains("text-anchor=\"end\""))
        .map(|text| {
            let y = text.split('"').nth(3).unwrap().parse::<f64>().unwrap();
            let value = text[text.find('>').unwrap() + 1..].split('<').next();
            [y, value.unwrap().replace('\u{2212}', "-").parse().unwrap()]
        })
        .collect();
    let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
    let per_place = (last[1] - first[1]) / (last[0] - first[0]);
    let line = chart.find("line main hue0").unwrap();
    let line = chart[line..].split("d=\"M").nth(1).unwrap();
    let places: Vec<f64> = line[..line.find('"').unwrap()]
        .split('L')
        .map(|point| point.split(' ').nth(1).unwrap().parse().unwrap())
        .collect();
    let drawn = (places[places.len() - 1] - places[0]) * per_place / 2.0;
    // The allowed error is a tenth of a drawing unit at both ends.
    assert!((drawn - toe).abs() < 0.1 * per_place.abs(), "{drawn} {toe}");
}

/// `compare` of two runs of `kc` shows the results that differ, with their differences. It refuses to compare a run
/// with a study.
#[test]
fn two_runs_of_kc_are_compared() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let study = study("double_wishbone_compliance.toml");
    let softer = [
        "--set",
        "bushings.lower_arm_rear.stiffness=[350.0, 1250.0, 900.0, 4.0e4, 1.25e5, 1.25e5]",
    ];
    for (out, more) in [("stiff", &[][..]), ("soft", &softer[..])] {
        let arguments = [&["kc", &study, "--out", out], more].concat();
        assert_eq!(hardpoint(&arguments, at).status.code(), Some(0));
    }
    let compared = hardpoint(&["compare", "stiff", "soft", "--out", "both"], at);
    let said = String::from_utf8_lossy(&compared.stdout).into_owned();
    assert_eq!(compared.status.code(), Some(0), "{said}");
    assert!(said.contains("recession_by_braking"), "{said}");
    let read = |path: &str| rows_by_column(&std::fs::read(at.join(path)).unwrap());
    let [stiff, soft, both] = ["stiff/kc.csv", "soft/kc.csv", "both/comparison.csv"].map(read);
    assert_eq!(both.len(), stiff.len());
    let number = |text: &str| text.parse::<f64>().ok();
    let mut compared = 0;
    for ((row, first), other) in both.iter().zip(&stiff).zip(&soft) {
        for key in ["load", "trail_mm", "hold", "quantity", "unit"] {
            assert_eq!(row[key], first[key]);
        }
        assert_eq!(row["stiff"], first["value"]);
        assert_eq!(row["soft_secant"], other["secant"]);
        let difference = number(&other["value"]).zip(number(&first["value"]));
        assert_eq!(
            number(&row["soft_difference"]),
            difference.map(|(b, a)| b - a)
        );
        compared += usize::from(difference.is_some());
    }
    assert!(compared > 20, "{compared}");
    // The soft arm has more recession than the stiff one.
    let recession = both
        .iter()
        .find(|row| row["quantity"] == "recession_by_braking");
    assert!(number(&recession.unwrap()["soft_difference"]).unwrap() > 0.0);

    let mixed = hardpoint(&["compare", "stiff", &study], at);
    let said = String::from_utf8_lossy(&mixed.stderr).into_owned();
    assert_eq!(mixed.status.code(), Some(2));
    assert!(said.contains("runs of `hardpoint kc` only"), "{said}");
}

/// Curves of a swept design contain its test results at every station, like the curves of `solve`.
#[test]
fn curves_of_a_sweep_have_figures_at_every_station() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("own.csv"), "tie_rod_inner_dz\n0.0\n").unwrap();
    let outputs = "\n[outputs]\ncharacteristics = [\"toe\", \"toe_by_lateral_force\"]\n\
                   [sweep]\ndesigns = \"own.csv\"\ncurves = true\n";
    for (name, trail) in [
        ("double_wishbone_compliance.toml", ""),
        ("subframe_axle_compliance.toml", "_trail_30"),
    ] {
        let text = std::fs::read_to_string(study(name)).unwrap();
        let outputs = outputs.replace("_force\"", &format!("_force{trail}\""));
        std::fs::write(here.join("study.toml"), text + &outputs).unwrap();
        for command in ["sweep", "solve"] {
            let ran = hardpoint(&[command, "study.toml", "--out", command, "--force"], here);
            let errors = String::from_utf8_lossy(&ran.stderr);
            assert_eq!(ran.status.code(), Some(0), "{name} {command}: {errors}");
        }
        let read = |command: &str| {
            let path = here.join(command).join("curves.csv");
            rows_by_column(&std::fs::read(path).unwrap())
        };
        let (swept, alone) = (read("sweep"), read("solve"));
        assert_eq!(swept.len(), alone.len(), "{name}");
        assert!(swept.len() > 1, "{name}");
        let (mut toes, mut figures) = (0, 0);
        for (swept, alone) in swept.iter().zip(&alone) {
            for (column, text) in alone {
                if column == "status" || column == "reason" {
                    continue;
                }
                // The sweep writes the coordinates that the motion prescribes. So it omits the travels of the axle's wheels.
                let Some(found) = swept.get(column) else {
                    assert!(column.starts_with("travel_"), "{name} {column}");
                    continue;
                };
                let [found, expected] = [found, text].map(|text| text.parse::<f64>());
                let (found, expected) = (found.unwrap(), expected.unwrap());
                let most = 1e-10 * expected.abs().max(1.0);
                assert!((found - expected).abs() <= most, "{name} {column}");
                toes += usize::from(column.ends_with("toe_deg"));
                figures += usize::from(column.contains("toe_by_lateral_force"));
            }
        }
        assert!(
            toes >= alone.len() && figures == toes,
            "{name}: {toes} {figures}"
        );
    }
}

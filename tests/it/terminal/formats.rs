//! Tests of `--format json` and `--format csv`: they contain every table of a command with exact numbers.

use super::{Called, study};
use crate::support::larger;
use serde_json::Value;

/// Calls whose tables the tests compare, each with the names of its tables.
const CALLS: [(&str, &str, &[&str], &[&str]); 14] = [
    (
        "solve",
        "macpherson_solve",
        &[],
        &["not_solved", "outputs", "stations"],
    ),
    (
        "solve",
        "macpherson_solve",
        &["--set", "motion.travel=[-400.0, 0.0, 400.0]"],
        &["not_solved", "outputs", "stations"],
    ),
    (
        "optimise",
        "macpherson_front",
        &[],
        &["misfit", "side_effects", "starts", "targets", "variables"],
    ),
    (
        "sweep",
        "macpherson_sweep",
        &["--set", "sweep.samples=64"],
        &["best", "effects", "not_solved", "outputs"],
    ),
    (
        "check",
        "double_wishbone_pushrod",
        &[],
        &["design", "effects"],
    ),
    ("limits", "double_wishbone_pushrod", &[], &["limits"]),
    ("assemblies", "macpherson_solve", &[], &["assemblies"]),
    ("limits", "semi_trailing_arm_solve", &[], &["limits"]),
    (
        "limits",
        "macpherson_tolerance",
        &["--builds", "3"],
        &["builds", "limits"],
    ),
    (
        "setup",
        "double_wishbone_tolerance",
        &[],
        &["effects", "steps"],
    ),
    (
        "tolerance",
        "double_wishbone_tolerance",
        &["--set", "tolerance.builds=200"],
        &["bands", "ranking", "values"],
    ),
    (
        "optimise",
        "macpherson_steering",
        &["--set", "optimise.max_iterations=2"],
        &[
            "constraints",
            "misfit",
            "side_effects",
            "starts",
            "targets",
            "variables",
        ],
    ),
    (
        "optimise",
        "double_wishbone_robust",
        &[
            "--set",
            "optimise.max_iterations=1",
            "--set",
            "optimise.scatter=4",
            "--set",
            "tolerance.builds=100",
        ],
        &[
            "misfit",
            "side_effects",
            "starts",
            "targets",
            "variables",
            "yields",
        ],
    ),
    (
        "optimise",
        "formula_student_car",
        &["--set", "optimise.max_iterations=1"],
        &["misfit", "side_effects", "starts", "targets", "variables"],
    ),
];

/// Blocks of a CSV with several tables: name, header, rows.
fn blocks(text: &str) -> Vec<(String, Vec<String>, Vec<Vec<String>>)> {
    let block = |block: &str| {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(block.as_bytes());
        let mut lines = reader.records().map(|line| {
            let line = line.unwrap();
            line.iter().map(str::to_owned).collect::<Vec<String>>()
        });
        let header = lines.next().unwrap();
        assert_eq!(header[0], "table");
        let rows: Vec<Vec<String>> = lines.collect();
        let name = rows.first().map_or_else(String::new, |row| row[0].clone());
        assert!(rows.iter().all(|row| row[0] == name));
        (name, header, rows)
    };
    text.split("\n\n").map(block).collect()
}

/// Both formats contain the same tables, with equal cells. Numbers have the same bits.
#[test]
fn json_and_csv_say_the_same() {
    for (command, study, more, names) in CALLS {
        let formats = ["json", "csv"].map(|format| {
            let more = [more, &["--format", format]].concat();
            let called = Called::on(command, study, &more);
            assert!(
                matches!(called.code(), Some(0 | 1)),
                "{}",
                called.complained()
            );
            // Other messages are separate lines on standard error. There is no heading without its table.
            for line in called.complained().lines() {
                let is_remark = !line.trim().is_empty() && !line.ends_with(':');
                assert!(is_remark, "{command}: {}", called.complained());
            }
            called.said()
        });
        let json: Value = serde_json::from_str(&formats[0]).unwrap();
        let tables = json.as_object().unwrap();
        assert_eq!(tables.keys().map(String::as_str).collect::<Vec<_>>(), names);
        let blocks = blocks(&formats[1]);
        // In CSV, a table without rows is absent, because there would be no line under its name.
        let has_rows = |name: &&&str| !tables[**name].as_array().unwrap().is_empty();
        let filled: Vec<&str> = names.iter().filter(has_rows).copied().collect();
        let mut found: Vec<&str> = blocks.iter().map(|block| block.0.as_str()).collect();
        // JSON sorts tables by name.
        found.sort_unstable();
        assert_eq!(found, filled, "{command}");
        for (name, header, rows) in &blocks {
            let list = tables[name].as_array().unwrap();
            assert_eq!(list.len(), rows.len(), "{command}, {name}");
            for (object, row) in list.iter().zip(rows) {
                let object = object.as_object().unwrap();
                assert_eq!(
                    object.len(),
                    header.len() - 1,
                    "{name}: keys are names of columns"
                );
                for (key, cell) in header.iter().zip(row).skip(1) {
                    let key_is_stable = key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
                    assert!(key_is_stable, "{key}");
                    match &object[key] {
                        Value::Null => assert_eq!(cell, "", "{name}.{key}"),
                        Value::Number(number) => {
                            let (a, b) = (number.as_f64().unwrap(), cell.parse::<f64>().unwrap());
                            assert_eq!(a.to_bits(), b.to_bits(), "{name}.{key}");
                        }
                        Value::String(text) => assert_eq!(text, cell),
                        other => assert_eq!(&other.to_string(), cell),
                    }
                }
            }
        }
    }
}

/// The numbers in these formats are identical to those in the files, bit for bit.
#[test]
fn the_tables_have_the_numbers_of_the_files() {
    let solved = Called::on("solve", "macpherson_solve", &["--format", "json"]);
    let tables: Value = serde_json::from_str(&solved.said()).unwrap();
    let curves = solved.file("curves.csv");
    let mut reader = csv::Reader::from_reader(curves.as_bytes());
    let header = reader.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let outputs = tables["outputs"].as_array().unwrap();
    assert!(outputs.len() >= 5);
    for output in outputs {
        let column = header
            .iter()
            .position(|name| output["output"] == name)
            .unwrap();
        let values = rows.iter().map(|row| row[column].parse::<f64>().unwrap());
        let least = values.clone().fold(f64::INFINITY, f64::min);
        let most = values.fold(f64::NEG_INFINITY, larger);
        assert_eq!(output["min"].as_f64(), Some(least), "{output}");
        assert_eq!(output["max"].as_f64(), Some(most), "{output}");
    }
    let counts = serde_json::json!([{"status": "ok", "stations": 41}]);
    assert_eq!(tables["stations"], counts);

    let tuned = Called::on("optimise", "macpherson_front", &["--format", "json"]);
    let tables: Value = serde_json::from_str(&tuned.said()).unwrap();
    let study: toml::Table = toml::from_str(&tuned.file("optimised.toml")).unwrap();
    let points = &study["suspension"]["hardpoints"];
    for variable in tables["variables"].as_array().unwrap() {
        let axis = ["x", "y", "z"].iter().position(|a| variable["axis"] == *a);
        let point = &points[variable["hardpoint"].as_str().unwrap()];
        let tuned = point[axis.unwrap()].as_float().unwrap();
        assert_eq!(variable["tuned"].as_f64(), Some(tuned), "{variable}");
        // A range consists of two numbers.
        let ends = ["range_min", "range_max"].map(|end| variable[end].as_f64().unwrap());
        assert!(ends[0] < ends[1]);
    }
    let summary: Value = serde_json::from_str(&tuned.file("summary.json")).unwrap();
    assert_eq!(tables["misfit"][0]["after"], summary["misfit_after"]);

    let more = ["--set", "sweep.samples=64", "--format", "json"];
    let swept = Called::on("sweep", "macpherson_sweep", &more);
    let tables: Value = serde_json::from_str(&swept.said()).unwrap();
    let summary: Value = serde_json::from_str(&swept.file("summary.json")).unwrap();
    for (row, output) in tables["outputs"].as_array().unwrap().iter().enumerate() {
        let same = &summary["outputs"][row];
        assert_eq!(output["output"], same["column"]);
        for key in ["at_design", "min", "max", "mean", "standard_deviation"] {
            assert_eq!(output[key], same[key], "{key} of {output}");
        }
    }
}

/// The headings for people have the unit of the travel and the rack displacement. The keys for programs stay without it.
#[test]
fn positions_of_scatter_have_a_unit() {
    let path = study("macpherson_tolerance");
    let builds = ["--set", "tolerance.builds=20"];
    let racks = ["--set", "motion.rack=[-5.0, 0.0, 5.0]"];
    let arguments = [&["tolerance", path.to_str().unwrap()], &builds[..], &racks].concat();
    let said = Called::with(&arguments, &[("COLUMNS", "200")]).said();
    let header = said.lines().find(|line| line.contains("nominal"));
    let header = header.unwrap_or_else(|| panic!("{said}"));
    assert!(header.contains("travel mm  rack mm"), "{said}");
    let said = Called::with(&[&arguments[..], &["--format", "json"]].concat(), &[]).said();
    let tables: Value = serde_json::from_str(&said).unwrap();
    for key in ["travel", "rack"] {
        assert!(tables["values"][0][key].is_number(), "{said}");
    }
}

/// At most as many builds are within all bands as within each single band.
#[test]
fn yields_end_with_those_of_all_bands() {
    let mut more = vec!["--format", "json"];
    for set in [
        "optimise.max_iterations=1",
        "optimise.scatter=4",
        "tolerance.builds=100",
    ] {
        more.extend(["--set", set]);
    }
    let called = Called::on("optimise", "double_wishbone_robust", &more);
    let tables: Value = serde_json::from_str(&called.said()).unwrap();
    let (all, bands) = tables["yields"].as_array().unwrap().split_last().unwrap();
    assert_eq!(all["band"], "all");
    assert_eq!(bands.len(), 3);
    for design in ["before", "without_scatter", "after"] {
        let share = |row: &Value| row[design].as_f64().unwrap();
        assert!(
            bands.iter().all(|band| share(band) >= share(all)),
            "{design}"
        );
    }
}

/// A table shows the misfits of the given car and of the tuned car.
#[test]
fn the_misfit_of_a_car_is_a_table() {
    let more = ["--set", "optimise.max_iterations=1", "--format", "json"];
    let called = Called::on("optimise", "formula_student_car", &more);
    let tables: Value = serde_json::from_str(&called.said()).unwrap();
    let summary: Value = serde_json::from_str(&called.file("summary.json")).unwrap();
    let misfit = |key: &str| tables["misfit"][0][key].as_f64().unwrap();
    assert_eq!(Some(misfit("after")), summary["misfit"].as_f64());
    assert!(misfit("before") > misfit("after"));
    // The tuned car is the input of the next run.
    let more = ["--set", "optimise.max_iterations=1", "--format", "json"];
    let tuned = called.directory.path().join("run/optimised.toml");
    let arguments = ["optimise", tuned.to_str().unwrap(), "--out", "again"];
    let again = Called::with(&[&arguments[..], &more[..]].concat(), &[]);
    let tables: Value = serde_json::from_str(&again.said()).unwrap();
    let before = tables["misfit"][0]["before"].as_f64().unwrap();
    assert!((before / misfit("after") - 1.0).abs() < 1e-6, "{before}");
}

/// Unsolved stations are also a table, with their reasons.
#[test]
fn what_is_not_solved_is_in_a_table() {
    let more = [
        "--set",
        "motion.travel=[-400.0, 0.0, 400.0]",
        "--format",
        "json",
    ];
    let called = Called::on("solve", "macpherson_solve", &more);
    assert_eq!(called.code(), Some(1));
    let tables: Value = serde_json::from_str(&called.said()).unwrap();
    let failed = tables["not_solved"].as_array().unwrap();
    let travels: Vec<f64> = failed
        .iter()
        .map(|f| f["travel"].as_f64().unwrap())
        .collect();
    assert_eq!(travels, [-400.0, 400.0]);
    assert_eq!(failed[0]["status"], "unreachable");
    assert!(!failed[0]["reason"].as_str().unwrap().is_empty());
}

/// In a comparison of two designs every row has the name of its output, and no line is broken for readability.
#[test]
fn a_comparison_is_complete_for_programs() {
    let [one, other] = ["macpherson_solve", "macpherson_front"].map(super::study);
    let more = [other.to_str().unwrap(), "--format", "json"];
    let called = Called::on("compare", "macpherson_solve", &more);
    let tables: Value = serde_json::from_str(&called.said()).unwrap();
    let figures = tables["figures"].as_array().unwrap();
    assert!(figures.len() >= 4 && figures.len().is_multiple_of(2));
    for pair in figures.chunks(2) {
        assert_eq!(pair[0]["output"], pair[1]["output"]);
        assert_eq!(
            [&pair[0]["of"], &pair[1]["of"]],
            ["macpherson_solve", "macpherson_front"]
        );
        assert!(pair[0]["largest_difference"].is_null());
        assert!(pair[1]["largest_difference"].is_f64());
    }
    assert!(tables["moved"].is_array());
    let long = one.parent().unwrap().join("double_wishbone_solve.toml");
    let arguments = [
        one.to_str().unwrap(),
        long.to_str().unwrap(),
        "--format",
        "csv",
    ];
    let called = Called::with(
        &[&["compare"], &arguments[..]].concat(),
        &[("COLUMNS", "40")],
    );
    for line in called.said().lines().filter(|line| !line.is_empty()) {
        assert!(
            ["table,", "figures,", "moved,"]
                .iter()
                .any(|first| line.starts_with(first)),
            "{line}"
        );
    }
}

/// If no design changes an output, the output has no effects. Here every design keeps the given toe up to rounding
/// errors, and shares of rounding errors would be random.
#[test]
fn rounding_has_no_effects() {
    if !crate::support::has_lanes() {
        return;
    }
    let sweep = "sweep={method=\"random\",samples=256,seed=1,variables=[\
                 {hardpoint=\"tie_rod_inner\",axis=\"z\",range=[-5.0,5.0]},\
                 {hardpoint=\"lower_arm_front\",axis=\"z\",range=[-5.0,5.0]}]}";
    let outputs = "outputs.characteristics=[\"toe\"]";
    let more = ["--set", sweep, "--set", outputs, "--format", "json"];
    let called = Called::on("sweep", "double_wishbone_pushrod", &more);
    assert_eq!(called.code(), Some(0), "{}", called.complained());
    let tables: Value = serde_json::from_str(&called.said()).unwrap();
    let outputs = tables["outputs"].as_array().unwrap();
    let find = |name: &str| outputs.iter().find(|o| o["output"] == name).unwrap();
    let [met, moved] = ["toe_design_deg", "toe_max_deg"].map(find);
    let spread = met["max"].as_f64().unwrap() - met["min"].as_f64().unwrap();
    assert!(0.0 < spread && spread < 1e-10, "{met}");
    assert!(met["r2"].is_null() && moved["r2"].is_f64());
    let effects = tables["effects"].as_array().unwrap();
    for (name, is_known) in [("toe_design_deg", false), ("toe_max_deg", true)] {
        let of_it = effects.iter().filter(|e| e["output"] == name);
        for effect in of_it.clone() {
            for key in ["change", "share"] {
                assert_eq!(effect[key].is_f64(), is_known, "{effect}");
            }
        }
        assert_eq!(of_it.count(), 2);
    }
}

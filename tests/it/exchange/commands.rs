//! Tests of the commands for file exchange, as a user runs them.

use assert_cmd::Command;
use hardpoint::model::Topology;
use std::path::{Path, PathBuf};

pub(super) fn hardpoint(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    command.args(arguments);
    command
}

pub(super) fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

pub(super) fn sample(name: &str) -> String {
    let path = crate::support::studies().join(name);
    path.to_str().unwrap().to_owned()
}

pub(super) fn path(directory: &tempfile::TempDir, name: &str) -> (PathBuf, String) {
    let path = directory.path().join(name);
    let text = path.to_str().unwrap().to_owned();
    (path, text)
}

#[test]
fn a_table_goes_out_and_comes_back_on_the_command_line() {
    let directory = tempfile::tempdir().unwrap();
    let (table_path, table) = path(&directory, "points.csv");
    let (_, study) = path(&directory, "back.toml");
    let exported = hardpoint(&["export", &sample("macpherson_front.toml"), "--to", "csv"])
        .assert()
        .success();
    std::fs::write(&table_path, &exported.get_output().stdout).unwrap();
    let import = [
        "import",
        &table,
        "--topology",
        "macpherson",
        "--out",
        &study,
    ];
    let said = hardpoint(&import).assert().success();
    assert!(text(&said.get_output().stderr).contains("9 hardpoints of macpherson"));
    hardpoint(&["check", &study]).assert().success();
    // The import does not overwrite an existing file. It refuses a wrong topology, and the message lists the missing
    // points.
    hardpoint(&import).assert().code(2);
    let refused = hardpoint(&["import", &table, "--topology", "five_link"])
        .assert()
        .code(2);
    assert!(text(&refused.get_output().stderr).contains("missing for five_link"));
    assert!(refused.get_output().stdout.is_empty());
}

#[test]
fn rounding_says_what_it_costs() {
    let study = sample("macpherson_front.toml");
    let rounded = ["export", &study, "--to", "csv", "--round", "10"];
    let rounded = hardpoint(&[&rounded[..], &["--round-all"]].concat())
        .assert()
        .success();
    let said = text(&rounded.get_output().stderr);
    assert!(
        said.contains("27 of 27 coordinates rounded to 10 mm: misfit"),
        "{said}"
    );
    // The table of changed outputs omits the travel, because it is the given motion.
    assert!(!said.contains("\n  travel_mm"), "{said}");
    // The table prints numbers in the same style as other tables.
    let of_camber = said.lines().find(|line| line.starts_with("  camber_deg"));
    let change = of_camber.unwrap().split_whitespace().last().unwrap();
    assert!(
        change.parse::<f64>().unwrap() > 0.0 && !change.contains('e'),
        "{said}"
    );
    for line in text(&rounded.get_output().stdout).lines().skip(1) {
        for cell in line
            .split(',')
            .skip(1)
            .take(3)
            .filter(|cell| !cell.is_empty())
        {
            assert_eq!(cell.parse::<f64>().unwrap() % 10.0, 0.0, "{line}");
        }
    }
    hardpoint(&["export", &study, "--to", "xlsx"])
        .assert()
        .code(2);
    hardpoint(&["export", &study, "--to", "csv", "--round", "0"])
        .assert()
        .code(2);
}

#[test]
fn designs_stand_side_by_side() {
    let directory = tempfile::tempdir().unwrap();
    let (out_path, out) = path(&directory, "compare");
    let [a, b] = ["macpherson_solve.toml", "double_wishbone_solve.toml"].map(sample);
    let said = hardpoint(&["compare", &a, &b, "--out", &out, "--format", "csv"])
        .assert()
        .success();
    let tables = text(&said.get_output().stdout);
    assert!(
        tables.starts_with("table,output,of,at_design,min,max,largest_difference,at\n"),
        "{tables}"
    );
    assert!(
        tables.contains("figures,camber_deg,macpherson_solve,"),
        "{tables}"
    );
    let csv = std::fs::read_to_string(out_path.join("comparison.csv")).unwrap();
    assert_eq!(csv.lines().count(), 42);
    let page = std::fs::read_to_string(out_path.join("report.html")).unwrap();
    assert!(page.contains("Content-Security-Policy") && page.contains("double_wishbone_solve"));
    // A study compared with itself has no differences.
    let same = hardpoint(&["compare", &a, &a, "--out", "-"])
        .assert()
        .success();
    let csv = text(&same.get_output().stdout);
    let difference = csv
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|name| name.contains(" - "));
    for line in csv.lines().skip(1) {
        assert_eq!(
            line.split(',').nth(difference.unwrap()),
            Some("0.0"),
            "{line}"
        );
    }
    hardpoint(&["compare", &a]).assert().code(2);
}

#[test]
fn studies_come_from_standard_input() {
    let template = Topology::named("macpherson").unwrap().template;
    let solved = hardpoint(&["solve", "-", "--out", "-"])
        .write_stdin(template)
        .assert()
        .success();
    assert!(text(&solved.get_output().stdout).starts_with("travel_mm,"));
    let refused = hardpoint(&["check", "-"])
        .write_stdin("[suspension]\n")
        .assert()
        .code(2);
    assert!(text(&refused.get_output().stderr).contains("stdin"));
}

#[test]
fn shells_editors_and_man_get_theirs() {
    for shell in ["bash", "zsh", "fish"] {
        let printed = hardpoint(&["completions", shell]).assert().success();
        assert!(
            text(&printed.get_output().stdout).contains("assemblies"),
            "{shell}"
        );
    }
    let page = hardpoint(&["man"]).assert().success();
    assert!(text(&page.get_output().stdout).contains("HARDPOINT IMPORT"));
    let schema = hardpoint(&["schema"]).assert().success();
    let schema: serde_json::Value = serde_json::from_slice(&schema.get_output().stdout).unwrap();
    // A study describes either a suspension or a car.
    let kinds = schema["anyOf"].as_array().or(schema["oneOf"].as_array());
    assert!(kinds.is_some_and(|kinds| kinds.len() == 2), "{schema}");
    let new = hardpoint(&["new", "macpherson", "--with", "pushrod"])
        .assert()
        .code(2);
    assert!(text(&new.get_output().stderr).contains("its strut is the spring"));
}

/// A run can be exported and compared without its study, because the run keeps the points, including overrides.
#[test]
fn a_run_keeps_its_study() {
    let directory = tempfile::tempdir().unwrap();
    let (_, run) = path(&directory, "run");
    let study = sample("double_wishbone_solve.toml");
    let moved = "suspension.hardpoints.tie_rod_inner=[-110.0, 391.0, 240.0]";
    let solve = ["--quiet", "solve", &study, "--set", moved, "--out", &run];
    hardpoint(&solve).assert().success();
    let exported = hardpoint(&["export", &run, "--to", "csv"])
        .assert()
        .success();
    let points = text(&exported.get_output().stdout);
    assert!(
        points.contains("tie_rod_inner,-110.0,391.0,240.0"),
        "with what was overridden: {points}"
    );
    let compared = hardpoint(&["compare", &study, &run, "--out", "-"])
        .assert()
        .success();
    assert!(!compared.get_output().stdout.is_empty());
    let (_, compared) = path(&directory, "compared");
    let compare = hardpoint(&["compare", &study, &run, "--out", &compared])
        .assert()
        .success();
    let said = text(&compare.get_output().stdout);
    assert!(said.contains("tie_rod_inner"), "moved: {said}");

    // The user's study is in the output directory, and has the name that the run uses for its copy. The run does not
    // change this file.
    let own = directory.path().join("study.toml");
    std::fs::copy(&study, &own).unwrap();
    let own = own.to_str().unwrap();
    let here = directory.path().to_str().unwrap();
    let before = std::fs::read(own).unwrap();
    for _ in 0..2 {
        hardpoint(&["--quiet", "solve", own, "--out", here])
            .assert()
            .success();
        assert_eq!(std::fs::read(own).unwrap(), before);
    }
}

/// An import prints the role of each point and the next command. Without a terminal the import asks no questions. It
/// never replaces its input file.
#[test]
fn an_import_says_what_it_did_and_keeps_its_input() {
    let directory = tempfile::tempdir().unwrap();
    let (table_path, table) = path(&directory, "points.csv");
    let (map_path, map) = path(&directory, "names.toml");
    let (_, study) = path(&directory, "study.toml");
    let exported = hardpoint(&[
        "export",
        &sample("double_wishbone_solve.toml"),
        "--to",
        "csv",
    ])
    .assert()
    .success();
    let points = text(&exported.get_output().stdout).replace("upper_ball_joint", "Joint 7");
    std::fs::write(&table_path, &points).unwrap();
    std::fs::write(&map_path, "upper_ball_joint = \"Joint 7\"\n").unwrap();
    let import = |rest: &[&str]| {
        let first = [
            "import",
            &table,
            "--topology",
            "double_wishbone",
            "--map",
            &map,
        ];
        hardpoint(&[&first, rest].concat())
    };
    let said = import(&["--out", &study]).assert().success();
    let said = text(&said.get_output().stderr);
    for expected in [
        "upper_ball_joint",
        "\"Joint 7\", line",
        "To view it: hardpoint studio",
    ] {
        assert!(said.contains(expected), "{expected}: {said}");
    }
    for own in [&table, &map] {
        let refused = import(&["--out", own, "--force"]).assert().code(2);
        assert!(text(&refused.get_output().stderr).contains("an input of this command"));
    }
    assert_eq!(std::fs::read_to_string(&table_path).unwrap(), points);
    import(&["--out", &study, "--force"]).assert().success();
    import(&["--axes", "left,right,up"]).assert().code(2);
    import(&["--axes", "forward,left,up", "--frame", "iso8855"])
        .assert()
        .code(2);
    import(&["--corner", "FL", "--axle", "front"])
        .assert()
        .code(2);
    // The import refuses a device file, which may be endless.
    if cfg!(unix) {
        let endless = [
            "import",
            &table,
            "--topology",
            "double_wishbone",
            "--map",
            "/dev/zero",
        ];
        let refused = hardpoint(&endless).assert().code(2);
        assert!(text(&refused.get_output().stderr).contains("it is a device"));
    }
}

/// If a cell contains 5 MB where a name, number, unit or word is expected, the message is as short as usual, in any
/// format.
#[test]
fn huge_cells_get_short_answers() {
    let directory = tempfile::tempdir().unwrap();
    let long = "7x".repeat(2_500_000);
    let files = [
        ("number.csv", format!("name,x,y,z\nLBJ,{long},1,2\n")),
        ("side.csv", format!("name,x,y,z,side\nLBJ,1,2,3,{long}\n")),
        (
            "frame.json",
            format!("{{\"frame\": \"{long}\", \"LBJ\": [1, 2, 3]}}"),
        ),
        (
            "template.json",
            format!("{{\"Type\": \"Suspension\", \"Template\": \"{long}\"}}"),
        ),
        ("alias.yaml", format!("a: *{long}\n")),
        ("type.ini", format!("[FRONT]\nTRACK=1.5\nTYPE={long}\n")),
        (
            "number.sub",
            format!("[HARDPOINT]\n 'lca_front' 'left' {long} 2 3\n"),
        ),
        (
            "unit.sub",
            format!("[UNITS]\n LENGTH = '{long}'\n[HARDPOINT]\n"),
        ),
    ];
    for (name, content) in files {
        let (at, file) = path(&directory, name);
        std::fs::write(&at, content).unwrap();
        let refused = hardpoint(&["import", &file, "--topology", "double_wishbone"])
            .assert()
            .code(2);
        let said = &refused.get_output().stderr;
        assert!(said.len() < 1_500, "{name}: {} bytes", said.len());
    }
}

/// Printed commands can be pasted into a shell, even if a path contains a space. The output names the written files.
#[test]
fn printed_commands_quote_their_paths() {
    let directory = tempfile::tempdir().unwrap();
    let (table_path, table) = path(&directory, "points.csv");
    let (_, study) = path(&directory, "my front.toml");
    let mut exported = hardpoint(&[
        "export",
        &sample("macpherson_front.toml"),
        "--to",
        "csv",
        "--out",
        &table,
    ]);
    let exported = exported.assert().success();
    let said = text(&exported.get_output().stderr);
    assert!(
        table_path.exists() && said.contains(&format!("Written: {table}")),
        "{said}"
    );
    let import = [
        "import",
        &table,
        "--topology",
        "macpherson",
        "--out",
        &study,
    ];
    let said = hardpoint(&import).assert().success();
    let said = text(&said.get_output().stderr);
    assert!(
        said.contains(&format!("hardpoint studio '{study}'")),
        "{said}"
    );
    let quiet = ["--quiet", "export", &study, "--to", "dxf", "--out"];
    let (_, drawing) = path(&directory, "points.dxf");
    let said = hardpoint(&[&quiet[..], &[&drawing]].concat())
        .assert()
        .success();
    assert_eq!(text(&said.get_output().stderr), "");
}

/// A solid axle with one upper link has the same coordinates after export to a table and import. The import refuses two
/// upper links together with a lateral link.
#[test]
fn solid_axles_with_one_upper_link_go_out_and_come_back() {
    let directory = tempfile::tempdir().unwrap();
    let (study_path, study) = path(&directory, "axle.toml");
    let (table_path, table) = path(&directory, "axle.csv");
    let (back_path, back) = path(&directory, "back.toml");
    for linkage in ["panhard", "watt"] {
        let new = hardpoint(&["new", "--quiet", "solid_axle", "--with", linkage]).output();
        std::fs::write(&study_path, new.unwrap().stdout).unwrap();
        let exported = hardpoint(&["export", &study, "--to", "csv"]).output();
        let rows = text(&exported.unwrap().stdout);
        let import = ["import", &table, "--radius", "335", "--out", &back];
        let import =
            || hardpoint(&[&import[..], &["--topology", "solid_axle", "--force"]].concat());
        std::fs::write(&table_path, &rows).unwrap();
        import().assert().success();
        let points = |path: &Path| {
            let text = std::fs::read_to_string(path).unwrap();
            let read: toml::Table = text.parse().unwrap();
            (
                read["suspension"]["single"].clone(),
                read["suspension"]["hardpoints"].clone(),
            )
        };
        assert_eq!(points(&back_path), points(&study_path), "{linkage}");
        let upper = rows.lines().filter(|row| row.starts_with("upper_link"));
        let right = upper.map(|row| {
            let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
            cells[2] = format!("-{}", cells[2]);
            cells.join(",").replace("left", "right") + "\n"
        });
        let both = rows.clone() + &right.collect::<String>();
        std::fs::write(&table_path, both).unwrap();
        let refused = import().assert().failure();
        let said = text(&refused.get_output().stderr);
        let name = ["Panhard rod", "Watt linkage"][usize::from(linkage == "watt")];
        assert!(
            said.contains("upper_link_chassis") && said.contains(name),
            "{said}"
        );
    }
}

//! Tests of refused reports: directories that are not runs, and calls with invalid combinations of options.

use super::*;

fn refused(command: &mut Command, part: &str) {
    let ended = command.output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(2), "{said}");
    assert!(said.starts_with("error: ") && said.contains(part), "{said}");
}

#[test]
fn a_directory_that_is_not_a_run_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let missing = directory.path().join("missing");
    refused(
        hardpoint(&["report"]).arg(&missing),
        "there is no such directory",
    );
    refused(
        hardpoint(&["report"]).arg(directory.path()),
        "there is no report.json",
    );
    let file = directory.path().join("report.json");
    fs::write(&file, "{\"form\": 1}").unwrap();
    refused(
        hardpoint(&["report"]).arg(directory.path()),
        "not in the format of `hardpoint`",
    );
    fs::write(&file, "{\"form\": 99, \"version\": \"9.9\"}").unwrap();
    refused(
        hardpoint(&["report"]).arg(directory.path()),
        "run the study again",
    );
    let left: Vec<_> = fs::read_dir(directory.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "nothing is written");
}

#[test]
fn files_that_do_not_belong_together_are_refused() {
    let run = Run::of("solve", "plain", &study("macpherson_solve.toml"), &[]);
    let curves = run.path().join("curves.csv");
    let text = fs::read_to_string(&curves).unwrap();
    let shorter: Vec<&str> = text.lines().take(10).collect();
    for (contents, part) in [
        (shorter.join("\n"), "41 stations"),
        (text.replace("camber_deg", "camber"), "no column camber_deg"),
        (
            text.replacen("-80.0", "far", 1),
            "expected a number, found \"far\"",
        ),
    ] {
        fs::write(&curves, contents).unwrap();
        refused(hardpoint(&["report"]).arg(run.path()), part);
    }
    fs::remove_file(&curves).unwrap();
    refused(hardpoint(&["report"]).arg(run.path()), "curves.csv");
    let record = run.path().join("report.json");
    let text = fs::read_to_string(&record).unwrap();
    fs::write(&record, text.replace("\"curves.csv\"", "\"../curves.csv\"")).unwrap();
    refused(
        hardpoint(&["report"]).arg(run.path()),
        "is not the name of a file",
    );
}

#[test]
fn a_sweep_whose_files_do_not_belong_together_is_refused() {
    let run = sweep("plain", &["--set", "sweep.samples=200"]);
    let page = run.path().join("report.html");
    fs::remove_file(&page).unwrap();
    refused(
        hardpoint(&["report", "--plots", "plots"]).arg(run.path()),
        "is a sweep",
    );
    let [designs, summary] = ["designs.csv", "summary.json"].map(|name| run.path().join(name));
    let text = fs::read_to_string(&designs).unwrap();
    let (shorter, _) = text.trim_end().rsplit_once('\n').unwrap();
    let best = run.csv("designs.csv").1;
    let misfit = &best[best.len() - 5];
    let least = misfit.iter().map(|m| m.parse::<f64>().unwrap());
    let least = least.fold(f64::INFINITY, f64::min).to_string();
    // The changed value has as many digits as the old one. Otherwise the program would refuse the file because of its
    // length.
    let last = if least.ends_with('1') { "2" } else { "1" };
    let other = format!("{}{last}", &least[..least.len() - 1]);
    for (contents, part) in [
        (shorter.to_owned(), "it has another length"),
        (
            text.replace(&format!(",{least},"), &format!(",{other},")),
            "has a different misfit",
        ),
        (
            text.replacen("camber", "camper", 1),
            "the columns differ from those",
        ),
        (text.replacen("\n0,", "\n7,", 1), "the row of design 0"),
    ] {
        assert_ne!(contents, text, "{part}");
        fs::write(&designs, contents).unwrap();
        refused(hardpoint(&["report"]).arg(run.path()), part);
    }
    fs::remove_file(&designs).unwrap();
    let none = "no part of the sweep is complete";
    refused(hardpoint(&["report"]).arg(run.path()), none);
    assert!(!page.exists(), "nothing is written");
    // The page can be made without the run's summary: the program computes the result from the statistics of the
    // shards.
    fs::write(&designs, text).unwrap();
    fs::remove_file(&summary).unwrap();
    hardpoint(&["report"]).arg(run.path()).assert().success();
}

#[test]
fn a_report_needs_a_directory() {
    let sweep = studies().join("macpherson_sweep.toml");
    refused(
        hardpoint(&["sweep", "--out", "-", "--report"]).arg(&sweep),
        "not work with --out -",
    );
    let study = studies().join("macpherson_solve.toml");
    for option in [&["--report"][..], &["--plots", "plots"]] {
        let mut command = hardpoint(&["solve", "--out", "-"]);
        refused(command.args(option).arg(&study), "not work with --out -");
    }
}

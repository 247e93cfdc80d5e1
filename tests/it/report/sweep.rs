//! Tests of the content of the page of a sweep.

use super::page::{MOST_BYTES, own_text};
use super::*;

/// Columns of `designs.csv` whose numbers are in the page: all except the first and the last four.
fn numbers(header: &[String]) -> std::ops::Range<usize> {
    1..header.len() - 4
}

fn designs(data: &Value) -> Vec<u64> {
    let shown = data["shown"]["design"].as_array().unwrap();
    shown.iter().map(|d| d.as_u64().unwrap()).collect()
}

/// Asserts that every value in the page equals the value in the file. A cell that is empty in the file has no value in
/// the page.
fn assert_values_of_the_file(run: &Run) {
    let data = run.data();
    let (header, cells) = run.csv("designs.csv");
    for (k, column) in numbers(&header).enumerate() {
        assert_eq!(data["columns"][k]["column"], *header[column]);
        for (row, design) in designs(&data).into_iter().enumerate() {
            let cell = &cells[column][design as usize];
            let shown = &data["shown"]["columns"][k][row];
            match cell.as_str() {
                "" => assert!(shown.is_null(), "{} of {design}", header[column]),
                cell => assert_eq!(shown.as_f64(), cell.parse().ok(), "{}", header[column]),
            }
        }
    }
}

#[test]
fn a_small_sweep_is_shown_whole() {
    let run = sweep("plain", &["--set", "sweep.samples=700"]);
    let page = run.page();
    assert!(page.contains("All 700 designs are shown"));
    assert!(page.len() < MOST_BYTES, "{} bytes", page.len());
    assert_values_of_the_file(&run);
    let own = own_text(&page);
    for address in ["http:", "https:", "//cdn", "src=", "@import", "url("] {
        assert!(!own.contains(address), "{address}");
    }
    assert!(!own.contains("unsafe-eval"));
}

/// The unit of a rate is not the length at its end. A factor has no unit.
#[test]
fn variables_have_their_own_units() {
    let text = study("double_wishbone_compliance.toml");
    let variables = "sweep={ method = \"sobol\", samples = 8, variables = [\
        { rate = \"spring\", range = [60.0, 130.0] }, \
        { bushing = \"lower_arm_rear\", stiffness = \"y\", range = [0.5, 2.0], relative = true }, \
        { hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-5.0, 5.0] }] }";
    let outputs = "outputs.characteristics=[\"toe\"]";
    let run = Run::of(
        "sweep",
        "rates",
        &text,
        &["--set", variables, "--set", outputs],
    );
    let data = run.data();
    for (k, words) in [
        ["spring_rate", "N/mm"],
        ["lower_arm_rear_stiffness_y_factor", ""],
        ["tie_rod_inner_dz", "mm"],
    ]
    .into_iter()
    .enumerate()
    {
        let column = &data["columns"][k];
        assert_eq!([&column["title"], &column["unit"]], words, "{column}");
    }
}

#[test]
fn a_large_sweep_is_thinned_and_the_page_says_so() {
    let few = [
        "--set",
        "sweep.samples=30000",
        "--set",
        "motion.travel=[-40.0, 0.0, 40.0]",
    ];
    let run = sweep("large", &few);
    let page = run.page();
    assert!(page.len() < MOST_BYTES, "{} bytes", page.len());
    let data = run.data();
    let shown = designs(&data);
    assert!(page.contains(&format!("{} of 30000 designs are shown", shown.len())));
    assert!((1000..3000).contains(&shown.len()), "{}", shown.len());
    let numbers_of = |name: &str| -> Vec<u64> {
        let (_, cells) = run.csv(name);
        cells[0].iter().map(|c| c.parse().unwrap()).collect()
    };
    let front = numbers_of("pareto.csv");
    assert!(!front.is_empty() && front.iter().all(|d| shown.contains(d)));
    let best: Vec<u64> = serde_json::from_value(data["best"].clone()).unwrap();
    assert!(best.len() == 10 && best.iter().all(|d| shown.contains(d)));
    let rest: Vec<u64> = shown
        .iter()
        .copied()
        .filter(|d| !front.contains(d) && !best.contains(d))
        .collect();
    let every = rest[2] - rest[1];
    assert!(every > 1 && every % 2 == 1 && rest.iter().all(|d| d % every == 0));
    assert_values_of_the_file(&run);
}

#[test]
fn failures_have_their_reasons_and_gaps() {
    let run = sweep(
        "far",
        &[
            "--set",
            "sweep.samples=300",
            "--set",
            "motion.travel=[-360.0, 0.0, 300.0]",
        ],
    );
    let (header, cells) = run.csv("designs.csv");
    let [status, reason] = [1, 2].map(|back| &cells[header.len() - back]);
    let failed: Vec<usize> = (0..status.len()).filter(|i| status[*i] != "ok").collect();
    assert!(!failed.is_empty());
    let data = run.data();
    let page = run.page();
    assert!(page.contains("Not solved everywhere"));
    for design in failed {
        let number = data["shown"]["failing"][design].as_u64().unwrap() as usize;
        let said = &data["shown"]["reasons"][number];
        assert_eq!(
            (&said[0], &said[1]),
            (
                &Value::from(&*status[design]),
                &Value::from(&*reason[design])
            )
        );
        assert!(page.contains(said[1].as_str().unwrap()));
    }
    assert_values_of_the_file(&run);
}

#[test]
fn report_makes_the_same_page_for_any_number_of_threads() {
    let page = |threads: &str| {
        let run = sweep(
            "plain",
            &["--set", "sweep.samples=500", "--threads", threads],
        );
        let written = run.page();
        fs::remove_file(run.path().join("report.html")).unwrap();
        let again = hardpoint(&["report"]).arg(run.path()).output().unwrap();
        assert!(again.status.success());
        assert!(written == run.page());
        written
    };
    assert!(page("1") == page("2"));
}

/// The page shows the last run in a directory: a sweep with `--force` replaces a solve.
#[test]
fn a_sweep_in_the_same_directory_takes_its_place() {
    let run = sweep("plain", &["--set", "sweep.samples=200"]);
    let study = run.directory.path().join("plain.toml");
    let out = run.directory.path().join("solved");
    let page = || fs::read_to_string(out.join("report.html")).unwrap();
    let mut solve = hardpoint(&["solve", "--report", "--out"]);
    solve.arg(&out).arg(&study).assert().success();
    assert!(page().contains("id=\"mechanism\""));
    let mut sweep = hardpoint(&["sweep", "--set", "sweep.samples=200", "--out"]);
    sweep.arg(&out).arg(&study).assert().code(2);
    sweep.arg("--force").assert().success();
    assert!(!out.join("report.html").exists(), "of another run");
    hardpoint(&["report"]).arg(&out).assert().success();
    assert!(page().contains("id=\"designs\""));
    solve.assert().code(2);
    assert!(page().contains("id=\"designs\""));
}

#[test]
fn a_hostile_name_of_a_sweep_is_text() {
    let page = sweep(HOSTILE_NAME, &["--set", "sweep.samples=200"]).page();
    let own = own_text(&page);
    assert!(own.contains("<bdi>&lt;img src=x onerror=alert(1)&gt;"));
    assert!(!own.contains("<img") && !own.contains("<script>alert"));
}

/// The page shows curves for a chosen design. These curves equal those of the design's study.
#[test]
fn a_chosen_design_has_its_curves_and_its_mechanism() {
    let run = sweep("plain", &["--set", "sweep.samples=64"]);
    let data = run.data();
    let drawn = data["drawn"].as_array().unwrap();
    assert!(drawn[0].is_null() && drawn.len() > 5, "{drawn:?}");
    let best = &data["best"][0];
    let place = drawn.iter().position(|design| design == best).unwrap();
    let path = run.directory.path().join("plain.toml");
    let mut print = hardpoint(&["sweep", "--set", "sweep.samples=64", "--design"]);
    let printed = print.arg(best.to_string()).arg(&path).output().unwrap();
    let text = String::from_utf8(printed.stdout).unwrap();
    let solved = Run::of("solve", "one", &text, &[]);
    let (header, columns) = solved.csv("curves.csv");
    let table = &data["curves"][place];
    let names = table["header"].as_array().unwrap();
    assert!(names.len() > 2);
    for (k, name) in names.iter().enumerate() {
        let Some(column) = header.iter().position(|n| name == n) else {
            continue;
        };
        let shown = table["columns"][k].as_array().unwrap();
        assert_eq!(shown.len(), columns[column].len());
        for (shown, cell) in shown.iter().zip(&columns[column]) {
            let (a, b): (f64, f64) = (shown.as_f64().unwrap(), cell.parse().unwrap());
            assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{name}: {a} {b}");
        }
    }
    let frames = &data["record"]["designs"][place]["frames"];
    assert_eq!(frames.as_array().unwrap().len(), columns[0].len());
    assert_eq!(
        data["record"]["designs"][place]["label"],
        format!("design {best}")
    );
    let page = run.page();
    assert!(
        page.contains("id=\"mechanism\"") && page.len() < MOST_BYTES,
        "{}",
        page.len()
    );
}

/// The page lists no effects for outputs that no variable changes, because these effects would only be rounding errors.
#[test]
fn what_nothing_moves_has_no_effects() {
    let run = sweep("plain", &["--set", "sweep.samples=64"]);
    let data = run.data();
    let outputs = data["effects"].as_array().unwrap();
    let unmoved: Vec<&str> = data["unmoved"]
        .as_array()
        .unwrap()
        .iter()
        .map(|k| {
            outputs[k.as_u64().unwrap() as usize]["column"]
                .as_str()
                .unwrap()
        })
        .collect();
    assert!(unmoved.contains(&"camber_design_deg"), "{unmoved:?}");
    assert!(!unmoved.contains(&"camber_gain_deg_per_mm"), "{unmoved:?}");
}

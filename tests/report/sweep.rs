//! What is in the page of a sweep.

use super::page::own_text;
use super::*;

/// Which columns of `designs.csv` are numbers that the page has: all but the last three and the first.
fn numbers(header: &[String]) -> std::ops::Range<usize> {
    1..header.len() - 4
}

fn designs(data: &Value) -> Vec<u64> {
    let shown = data["shown"]["design"].as_array().unwrap();
    shown.iter().map(|d| d.as_u64().unwrap()).collect()
}

/// Every value in the page is the one in the file, and what is empty there is missing here.
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
    assert!(page.contains("All 700 designs are drawn"));
    assert!(page.len() < 6_000_000, "{} bytes", page.len());
    assert_values_of_the_file(&run);
    let own = own_text(&page);
    for address in ["http:", "https:", "//cdn", "src=", "@import", "url("] {
        assert!(!own.contains(address), "{address}");
    }
    assert!(!own.contains("unsafe-eval"));
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
    assert!(page.len() < 6_000_000, "{} bytes", page.len());
    let data = run.data();
    let shown = designs(&data);
    assert!(page.contains(&format!("Drawn are {} of 30000 designs", shown.len())));
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

/// The page is of what ran last in a directory: a sweep takes the place of a solve where it is told to.
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

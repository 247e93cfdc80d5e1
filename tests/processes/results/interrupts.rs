//! Tests of signals: the first signal ends a run, and the written files record the interruption.

use super::*;
use serde_json::Value;
use std::time::{Duration, Instant};

fn json(bench: &Bench, name: &str) -> Value {
    serde_json::from_str(&bench.read(name)).unwrap()
}

/// Waits until a file exists.
fn wait_for(bench: &Bench, name: &str) {
    let begun = Instant::now();
    while !bench.path(name).exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no {name}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn signal(process: &Child, name: &str) {
    let number = process.id().to_string();
    let sent = Command::new("kill").args([name, &number]).status();
    assert!(sent.unwrap().success());
}

fn sample(bench: &Bench, name: &str) {
    let path = crate::support::studies().join(name);
    fs::copy(path, bench.path(name)).unwrap();
}

/// An interrupted run keeps its finished builds. The numbers equal those of a complete run with this number of builds.
/// No file states that the run has finished.
#[test]
fn an_interrupted_tolerance_is_a_shorter_one_and_says_so() {
    let bench = Bench::new();
    let study = "double_wishbone_tolerance.toml";
    sample(&bench, study);
    let all = ["tolerance", study, "--set", "tolerance.builds=2000000000"];
    let call = [&all[..], &["--out", "run", "--report"]].concat();
    for (name, code) in [("-INT", 130), ("-TERM", 143)] {
        let process = bench.start(&call);
        wait_for(&bench, "run/run.json");
        std::thread::sleep(Duration::from_millis(900));
        signal(&process, name);
        assert_eq!(
            process.wait_with_output().unwrap().status.code(),
            Some(code)
        );
        let [summary, run] = ["run/summary.json", "run/run.json"].map(|name| json(&bench, name));
        for state in [&summary, &run["runs"][0]] {
            assert_eq!([&state["finished"], &state["interrupted"]], [false, true]);
        }
        let Some(builds) = summary["builds"].as_u64() else {
            // On a very busy machine, possibly no block of builds is finished.
            bench.run(&["report", "run"]).code(2);
            continue;
        };
        assert!((1..2_000_000_000).contains(&builds));
        let fewer = format!("tolerance.builds={builds}");
        bench
            .run(&[
                "tolerance",
                study,
                "--set",
                &fewer,
                "--out",
                "fewer",
                "--force",
            ])
            .success();
        for name in ["tolerance.csv", "curves_p5.csv", "curves.csv"] {
            let read = |run: &str| bench.read(&format!("{run}/{name}"));
            assert!(read("run") == read("fewer"), "{name} of {builds} builds");
        }
        bench.run(&["report", "run"]).success();
        assert!(bench.read("run/report.html").contains("Interrupted: "));
        let finished = json(&bench, "fewer/summary.json");
        assert_eq!(
            [&finished["finished"], &finished["interrupted"]],
            [true, false]
        );
    }
}

/// An interrupted run without partial results ends immediately. The next run computes everything.
#[test]
fn an_interrupted_solve_has_no_results_and_is_run_again() {
    let bench = Bench::new();
    let travel = "motion.travel={from=-40.0,to=40.0,steps=60001}";
    let call = [
        "solve",
        "study.toml",
        "--set",
        travel,
        "--out",
        "run",
        "--report",
    ];
    let process = bench.start(&call);
    wait_for(&bench, "run/run.json");
    signal(&process, "-TERM");
    let ended = process.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(143));
    let run = json(&bench, "run/run.json");
    let state = &run["runs"][0];
    assert_eq!([&state["finished"], &state["interrupted"]], [false, true]);
    let summary = json(&bench, "run/summary.json");
    assert_eq!(
        [&summary["finished"], &summary["interrupted"]],
        [false, true]
    );
    let names = contents(&bench.path("run"))
        .into_iter()
        .map(|(name, _)| name);
    assert!(!names.into_iter().any(|name| name.starts_with('.')));
    bench.run(&call).success();
    let run = json(&bench, "run/run.json");
    let state = &run["runs"][0];
    assert_eq!([&state["finished"], &state["interrupted"]], [true, false]);
    assert_eq!(json(&bench, "run/summary.json")["finished"], true);
}

/// If a report of a finished run is interrupted, the run still counts as finished. A second signal also takes effect.
#[test]
fn signals_do_not_unmake_a_finished_run() {
    let bench = Bench::new();
    bench
        .run(&["solve", "study.toml", "--out", "run"])
        .success();
    for _ in 0..5 {
        let process = bench.start(&["report", "run"]);
        signal(&process, "-INT");
        signal(&process, "-INT");
        let ended = process.wait_with_output().unwrap().status;
        // Before the program has installed its handler, the operating system ends the program at the signal.
        assert!(matches!(ended.code(), Some(0 | 130) | None), "{ended}");
        let run = json(&bench, "run/run.json");
        assert_eq!(run["runs"][0]["finished"], true);
        assert_eq!(json(&bench, "run/summary.json")["finished"], true);
    }
    bench.run(&["report", "run"]).success();
}

/// State of the only run in a directory: `finished` and `interrupted`.
fn state(bench: &Bench) -> [Value; 2] {
    let run = json(bench, "run/run.json");
    ["finished", "interrupted"].map(|key| run["runs"][0][key].clone())
}

/// Runs a command on the road car. Sends a signal some time after a file has appeared. Returns the exit code and the
/// output.
fn interrupted_car(bench: &Bench, call: &[&str], begun: &str, seconds: f64) -> (i32, String) {
    for name in ["car.toml", "car_front.toml", "car_rear.toml"] {
        sample(bench, name);
    }
    let mut command = bench.command(call);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let process = command.spawn().unwrap();
    wait_for(bench, begun);
    std::thread::sleep(Duration::from_secs_f64(seconds));
    signal(&process, "-INT");
    let ended = process.wait_with_output().unwrap();
    assert_eq!(state(bench), [Value::Bool(false), Value::Bool(true)]);
    let said = [ended.stdout, ended.stderr].map(|text| String::from_utf8(text).unwrap());
    (ended.status.code().unwrap(), said.concat())
}

/// An interrupted tuning of a car keeps the best design so far. This design consists of three studies that can be
/// solved, with tuned rates.
#[test]
fn an_interrupted_tuning_of_a_car_keeps_its_best_design() {
    let bench = Bench::new();
    let starts = "optimise.starts=1000";
    let call = ["optimise", "car.toml", "--set", starts, "--out", "run"];
    let (code, said) = interrupted_car(&bench, &call, "run/run.json", 1.5);
    assert_eq!(code, 130, "{said}");
    for name in [
        "optimised.toml",
        "optimised_front.toml",
        "optimised_rear.toml",
    ] {
        bench.run(&["check", &format!("run/{name}")]).success();
    }
    let tuned = bench.read("run/optimised_front.toml");
    assert!(tuned != bench.read("car_front.toml"));
    assert!(said.contains("interrupted"), "{said}");
    let summary = json(&bench, "run/summary.json");
    // On a slow machine, the run may have written only the studies before the signal.
    if let Some(interrupted) = summary["interrupted_starts"].as_u64() {
        assert!((1..1000).contains(&interrupted) && said.contains(" of 1000 starts done"));
        assert!(summary["misfit"].as_f64().unwrap() < 1.0);
    }
}

/// An interrupted map keeps its finished rows. These rows equal those of a complete map.
#[test]
fn an_interrupted_map_keeps_its_finished_rows() {
    let bench = Bench::new();
    let map = "gg_map.ax={from=-0.5,to=0.5,steps=4001}";
    let call = ["solve", "car.toml", "--set", map, "--out", "run"];
    let (code, said) = interrupted_car(&bench, &call, "run/cases.csv", 1.0);
    assert_eq!(code, 130, "{said}");
    let kept = bench.read("run/gg.csv");
    let (header, rows) = kept.split_once('\n').unwrap();
    let rows: Vec<&str> = rows.lines().collect();
    // A row of the map has five values of ay.
    assert!(rows.len().is_multiple_of(5) && (5..20_005).contains(&rows.len()));
    let words = format!("gg.csv has {} of 4001 rows", rows.len() / 5);
    assert!(said.contains(&words), "{said}");
    for row in rows.chunks(5).take(2) {
        let ax = row[0].split(',').next().unwrap();
        let alone = format!("gg_map.ax={{from={ax},to={ax},steps=1}}");
        let call = [
            "solve", "car.toml", "--set", &alone, "--out", "alone", "--force",
        ];
        bench.run(&call);
        assert_eq!(
            bench.read("alone/gg.csv"),
            format!("{header}\n{}\n", row.join("\n"))
        );
    }
}

/// An interrupted sweep of a car keeps its finished parts, which take a few seconds each.
#[test]
fn an_interrupted_sweep_of_a_car_keeps_its_parts() {
    let bench = Bench::new();
    let text = crate::support::sample("car.toml");
    let part = |from: &str, to: &str| &text[text.find(from).unwrap()..text.find(to).unwrap()];
    // Omits the load cases, so that the car has only its static position.
    let few = "[outputs]\ncharacteristics = [\"roll\"]\n";
    let text = [
        part("[car]", "[[cases]]"),
        few,
        part("[sweep]", "[tolerance]"),
    ]
    .concat();
    fs::write(bench.path("still.toml"), text).unwrap();
    let samples = "sweep.samples=100000";
    let call = ["sweep", "still.toml", "--set", samples, "--out", "run"];
    let (code, said) = interrupted_car(&bench, &call, "run/part-000000000.csv", 0.1);
    assert_eq!(code, 130, "{said}");
    assert!(bench.read("run/part-000000000.csv").lines().count() == 1 + 1024);
    let summary = json(&bench, "run/summary.json");
    if let Some(designs) = summary["evaluated"].as_u64() {
        assert!(designs >= 1024 && designs.is_multiple_of(1024), "{summary}");
    }
}

/// If a comparison reports an interruption, its exit code is that of a signal. If the comparison finishes before the
/// signal, it reports no interruption.
#[test]
fn a_comparison_is_interrupted_or_finished() {
    let bench = Bench::new();
    bench
        .run(&["solve", "study.toml", "--out", "run"])
        .success();
    for milliseconds in (0..40).step_by(4) {
        let process = bench.start(&["compare", "run", "run", "--out", "both", "--force"]);
        std::thread::sleep(Duration::from_millis(milliseconds));
        let number = process.id().to_string();
        let _ = Command::new("kill").args(["-INT", &number]).output();
        let ended = process.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        if said.contains("interrupted") {
            assert_eq!(ended.status.code(), Some(130), "{milliseconds} ms: {said}");
        } else {
            // Before the program has installed its handler, the operating system ends the program at the signal.
            let code = ended.status.code();
            assert!(matches!(code, Some(0) | None), "{milliseconds} ms: {said}");
        }
    }
}

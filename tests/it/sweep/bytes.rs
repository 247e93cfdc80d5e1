//! Tests that a sweep writes the same bytes, however it is run.

use super::*;
use hardpoint::report::{SweepDirectory, SweepText, write_part};
use hardpoint::results::{Claim, RunDirectory};
use hardpoint::study::Study;
use hardpoint::sweep::{SweepPlan, Swept};
use std::sync::Arc;

/// Study of the design position alone. It has enough designs for two parts of results.
fn two_parts() -> String {
    let from = STUDY.find("[optimise]").unwrap();
    STUDY[..from]
        .replace("[-60.0, -20.0, 20.0, 60.0]", "[0.0]")
        .replace("[\"camber\", \"toe\"]", "[\"camber\"]")
        .replace("curves = true", "curves = false")
        .replace("latin_hypercube", "sobol")
        .replace("samples = 700", "samples = 131200")
}

#[test]
fn threads_and_shards_give_the_same_bytes() {
    let bench = Bench::new(STUDY);
    bench.sweep("one", &["--threads", "1"]).success();
    bench.sweep("two", &["--threads", "2"]).success();
    bench.assert_same("one", "two");
    // The results have only one part, so all shards except one are empty.
    for i in ["1/7", "7/7", "2/7"] {
        bench.sweep("shards", &["--shard", i]).success();
    }
    bench.assert_same("one", "shards");
    bench.run(&["merge", "--out", "merged", "shards"]).success();
    bench.assert_same("one", "merged");
    assert!(bench.path("merged/shown_designs.json").exists());
    // The results refer to the original study, not to the copy in the run.
    fs::copy(bench.path("study.toml"), bench.path("strut.toml")).unwrap();
    let few = ["--set", "sweep.samples=20", "--out", "few"];
    bench
        .run(&[&["sweep", "strut.toml"], &few[..]].concat())
        .success();
    bench.run(&["merge", "--out", "joined", "few"]).success();
    bench.assert_same("few", "joined");
    let designs = bench.designs("one");
    assert_eq!(designs.rows.len(), 700);
    assert!(designs.text("status").iter().all(|s| *s == "ok"));
    let curves = Table::read(&bench.path("one/curves.csv"));
    assert_eq!(curves.rows.len(), 700 * 4);
}

/// A sweep writes the same parts in three cases. Case 1: one run. Case 2: shards by two simultaneous processes in one
/// directory. Case 3: a part is lost, and the sweep is resumed. The joined parts equal the result of a merge.
#[test]
fn parts_are_the_same_whoever_does_them() {
    let bench = Bench::new(&two_parts());
    bench.sweep("whole", &[]).success();
    let shard = |i: &str| {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("hardpoint"));
        let arguments = ["sweep", "study.toml", "--out", "shards", "--shard", i];
        command.current_dir(bench.0.path()).args(arguments);
        command.stdout(std::process::Stdio::null()).spawn().unwrap()
    };
    // The shard "2/2" runs twice, as when a job is queued again while its first process still runs.
    let running = ["2/2", "1/2", "2/2"].map(shard);
    for mut process in running {
        assert_eq!(process.wait().unwrap().code(), Some(0));
    }
    bench.assert_same("whole", "shards");
    let lost = bench.path("shards/part-000000001.csv");
    fs::remove_file(&lost).unwrap();
    let leftover = bench.path("shards/.hardpoint-part-000000001-abc");
    fs::write(&leftover, "half a row").unwrap();
    let (_, error) = said(&bench.run(&["merge", "--out", "none", "shards"]).code(2));
    assert!(error.contains("1 of 2 parts are missing (1)"), "{error}");
    bench.sweep("shards", &["--resume"]).success();
    assert!(!leftover.exists());
    bench.assert_same("whole", "shards");

    bench.run(&["merge", "--out", "merged", "whole"]).success();
    let read = |name: &str| fs::read(bench.path(name)).unwrap();
    let mut joined = read("whole/part-000000000.csv");
    let rows = read("whole/part-000000001.csv");
    let header = rows.iter().position(|byte| *byte == b'\n').unwrap();
    joined.extend(&rows[header + 1..]);
    assert!(read("merged/designs.csv") == joined);
    assert!(read("merged/summary.json") == read("whole/summary.json"));
    // The program makes a page for both result directories. It also makes a page for an incomplete sweep.
    fs::remove_file(bench.path("whole/part-000000000.csv")).unwrap();
    for run in ["shards", "merged", "whole"] {
        bench.run(&["report", run]).success();
    }
    let page = |run: &str| fs::read_to_string(bench.path(run).join("report.html")).unwrap();
    assert!(page("shards").contains("131200 designs"));
    assert!(page("whole").contains("128 of 131200 designs"));
}

#[test]
fn the_designs_alone_go_to_standard_output() {
    let bench = Bench::new(STUDY);
    bench.sweep("run", &[]).success();
    let (out, error) = said(&bench.sweep("-", &[]).success());
    assert_eq!(
        out,
        fs::read_to_string(bench.path("run/designs.csv")).unwrap()
    );
    assert!(error.contains("700 designs, all solved"), "{error}");
}

/// If a sequence gets more samples, the existing parts stay. The bytes equal those of a sweep with all samples from the
/// start.
#[test]
fn a_finished_sweep_grows() {
    let bench = Bench::new(&two_parts());
    let of = |samples: &str| ["--set".to_owned(), format!("sweep.samples={samples}")];
    let sweep = |out: &str, samples: &str, more: &[&str]| {
        let set = of(samples);
        let set: Vec<&str> = set.iter().map(String::as_str).collect();
        bench.sweep(out, &[&set[..], more].concat())
    };
    sweep("whole", "131300", &[]).success();
    sweep("grown", "100", &[]).success();
    // Without `--resume` the program refuses to extend the sweep.
    sweep("grown", "131200", &[]).code(2);
    sweep("grown", "131200", &["--resume"]).success();
    assert!(!bench.path("grown/designs.csv").exists());
    let modified = || {
        fs::metadata(bench.path("grown/part-000000000.csv"))
            .unwrap()
            .modified()
    };
    let before = modified().unwrap();
    sweep("grown", "131300", &["--resume"]).success();
    assert_eq!(modified().unwrap(), before);
    bench.assert_same("whole", "grown");
    sweep("grown", "131200", &["--resume"]).code(2);
}

/// The number of levels of main effects grows with the number of designs: 6 for 300 designs, 8 for 600 designs. The kept parts of
/// an extended sweep have the same bytes as those of a sweep that runs at once.
#[test]
fn kept_parts_have_the_levels_of_the_longer_sweep() {
    let bench = Bench::new(&two_parts());
    let sweep = |out: &str, samples: u64| {
        let set = [format!("sweep.samples={samples}")];
        let study = Study::read(&bench.path("study.toml"), &set).unwrap();
        let mut plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
        // A part has only one block of 128 designs, so that the sweep is short.
        plan.record.blocks_of_part = 1;
        let claim = Claim {
            command: "sweep",
            study: "study",
            digest: "same".to_owned(),
            resume: true,
            ..Claim::default()
        };
        let claimed = RunDirectory::claim(&bench.path(out), &claim).unwrap();
        let directory = SweepDirectory::prepare(&claimed, &plan.record, false).unwrap();
        directory.renew_statistics().unwrap();
        let kept = directory.done().unwrap().statistics.designs;
        let (text, flag) = (SweepText::of(&plan, &study, true), Arc::default());
        for part in 0..plan.record.parts() {
            let swept = Swept::Suspension(&plan);
            write_part(swept, &text, &directory, part, &flag, |_| ()).unwrap();
        }
        assert_eq!(directory.done().unwrap().statistics.designs, samples);
        kept
    };
    assert_eq!(sweep("grown", 300), 0);
    assert_eq!(sweep("grown", 600), 256);
    sweep("whole", 600);
    bench.assert_same("whole", "grown");
}

/// Ctrl-C leaves complete parts and no others. The program prints how to continue.
#[cfg(unix)]
#[test]
fn an_interrupted_sweep_leaves_whole_parts() {
    let bench = Bench::new(&two_parts());
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("hardpoint"));
    // The sweep uses a sequence of samples, so its parts equal those of the shorter sweep.
    let many = ["--set", "sweep.samples=100000000"];
    command
        .args(["sweep", "study.toml", "--out", "run"])
        .args(many);
    command.current_dir(bench.0.path());
    command.stdout(std::process::Stdio::piped());
    let process = command.spawn().unwrap();
    let first = bench.path("run/part-000000000.csv");
    let begun = std::time::Instant::now();
    while !first.exists() {
        assert!(begun.elapsed().as_secs() < 120, "no first part");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let number = process.id().to_string();
    let killed = std::process::Command::new("kill")
        .args(["-INT", &number])
        .status();
    assert!(killed.unwrap().success());
    let output = process.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        printed.contains("of 100000000 designs") && printed.contains("--resume"),
        "{printed}"
    );
    let names = fs::read_dir(bench.path("run")).unwrap();
    let names = names.map(|e| e.unwrap().file_name().into_string().unwrap());
    assert_eq!(names.filter(|name| name.starts_with('.')).count(), 0);
    bench.sweep("whole", &[]).success();
    for name in ["part-000000000.csv", "part-000000000.json"] {
        let read = |run: &str| fs::read(bench.path(run).join(name)).unwrap();
        assert!(read("run") == read("whole"), "{name}");
    }
    let (_, error) = said(&bench.sweep("run", &many).code(2));
    assert!(error.contains("unfinished sweep"), "{error}");
}

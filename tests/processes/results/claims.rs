//! Tests of the rules for replacing files.

use super::*;

/// A command with the same study replaces its own files. The program refuses any other replacement. No file is lost.
#[test]
fn only_the_same_study_and_command_replace_results() {
    let bench = Bench::new();
    let few = ["--set", "sweep.samples=10"];
    for (command, file) in [
        ("solve", "curves.csv"),
        ("optimise", "optimised.toml"),
        ("sweep", "designs.csv"),
    ] {
        fn call<'a>(command: &'a str, more: &[&'a str]) -> Vec<&'a str> {
            [&[command, "study.toml", "--out", command], more].concat()
        }
        let run = |more| call(command, more);
        bench.run(&run(&[])).success();
        let before = contents(&bench.path(command));
        assert!(before.iter().any(|(name, _)| name == file));
        bench.run(&run(&[])).success();
        assert_eq!(contents(&bench.path(command)), before);
        let others: [&[&str]; 2] = [&few, &["--set", "motion.travel=[-30.0, 0.0, 30.0]"]];
        for other in others {
            let phrases = ["another study", "--out", "--force", command];
            bench.refused(&run(other), &phrases);
        }
        for other in ["solve", "optimise", "sweep"] {
            if other != command {
                let phrase = format!("holds the results of `hardpoint {command}`");
                bench.refused(&[other, "study.toml", "--out", command], &[&phrase]);
            }
        }
        assert_eq!(contents(&bench.path(command)), before);
    }
    // With `--force`, another command replaces the results. No file of the earlier run stays.
    let forced = ["solve", "study.toml", "--out", "sweep", "--force"];
    bench.run(&forced).success();
    let names = |run: &str| -> Vec<String> {
        let files = contents(&bench.path(run)).into_iter();
        files.map(|(name, _)| name).collect()
    };
    assert_eq!(names("sweep"), names("solve"));
}

/// In the default directory, the program moves older results to another directory and keeps them.
#[test]
fn in_the_default_directory_older_results_are_moved_aside() {
    let bench = Bench::new();
    bench.run(&["solve", "study.toml"]).success();
    let solved = contents(&bench.path("out/study"));
    let assert = bench.run(&["optimise", "study.toml"]).success();
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("out/study.1"), "{said}");
    assert_eq!(contents(&bench.path("out/study.1")), solved);
    let tuned = contents(&bench.path("out/study"));
    bench.run(&["solve", "study.toml"]).success();
    assert_eq!(contents(&bench.path("out/study")), solved);
    assert_eq!(contents(&bench.path("out/study.2")), tuned);
    // The program refuses to move results if their directory contains a file of another program, or an input.
    fs::write(bench.path("out/study/notes.txt"), "mine").unwrap();
    let other = ["--set", "motion.travel=[-30.0, 0.0, 30.0]"];
    bench.refused(
        &[&["solve", "study.toml"], &other[..]].concat(),
        &["curves.csv", "--force"],
    );
    fs::remove_file(bench.path("out/study/notes.txt")).unwrap();
    let target = "optimise.targets=[{characteristic=\"camber\", file=\"out/study/mine.csv\", tolerance=1.0}]";
    fs::write(
        bench.path("out/study/mine.csv"),
        "travel_mm,camber_deg\n-40,0\n40,0\n",
    )
    .unwrap();
    bench.refused(
        &["optimise", "study.toml", "--set", target],
        &["curves.csv"],
    );
    assert!(bench.path("out/study/mine.csv").exists());
}

/// The program neither overwrites nor deletes files that it did not write.
#[test]
fn foreign_files_are_never_touched() {
    let files = [
        ("solve", "curves.csv"),
        ("solve", "summary.json"),
        ("solve", "report.json"),
        ("optimise", "optimised.toml"),
        ("optimise", "history.csv"),
        ("sweep", "designs.csv"),
        ("sweep", "summary.json"),
        ("sweep", "sweep.json"),
        ("sweep", "run.json"),
    ];
    for (command, file) in files {
        let bench = Bench::new();
        fs::create_dir(bench.path("out")).unwrap();
        let path = bench.path("out").join(file);
        fs::write(&path, "mine").unwrap();
        let call = [command, "study.toml", "--out", "out"];
        bench.refused(&call, &[file, "--out", "--force"]);
        let alone = contents(&bench.path("out"));
        assert_eq!(alone, [(file.to_owned(), b"mine".to_vec())]);
        bench.run(&[&call[..], &["--force"]].concat()).success();
        assert_ne!(fs::read(&path).unwrap(), b"mine");
    }
    // A tuning also writes sensitivities, so it refuses a foreign file of that name before it starts.
    let bench = Bench::new();
    fs::create_dir(bench.path("out")).unwrap();
    fs::write(bench.path("out/sensitivities.csv"), "mine").unwrap();
    let tune = ["optimise", "study.toml", "--out", "out"];
    bench.refused(&tune, &["sensitivities.csv", "--out", "--force"]);
    assert_eq!(bench.read("out/sensitivities.csv"), "mine");
    // If no page is requested, the program keeps a page that it did not write. If a page is requested, the program
    // refuses to replace that page.
    let bench = Bench::new();
    fs::create_dir(bench.path("out")).unwrap();
    fs::write(bench.path("out/report.html"), "mine").unwrap();
    for command in ["solve", "sweep"] {
        let call = [command, "study.toml", "--out", "out"];
        bench.refused(&[&call[..], &["--report"]].concat(), &["report.html"]);
    }
    bench
        .run(&["solve", "study.toml", "--out", "out"])
        .success();
    bench.refused(&["report", "out"], &["report.html", "--force"]);
    assert_eq!(bench.read("out/report.html"), "mine");
    bench.run(&["report", "out", "--force"]).success();
    bench.run(&["report", "out"]).success();
    // The program also keeps pictures that it did not write, and refuses to replace them.
    fs::create_dir(bench.path("drawn")).unwrap();
    fs::write(bench.path("drawn/overview.svg"), "mine").unwrap();
    bench.refused(&["report", "out", "--plots", "drawn"], &["overview.svg"]);
    assert_eq!(bench.read("drawn/overview.svg"), "mine");
    bench
        .run(&["report", "out", "--plots", "pictures"])
        .success();
    bench
        .run(&["report", "out", "--plots", "pictures"])
        .success();
}

/// The program never overwrites its inputs, here a study and a file of designs.
#[test]
fn inputs_are_never_overwritten() {
    let bench = Bench::new();
    fs::rename(bench.path("study.toml"), bench.path("optimised.toml")).unwrap();
    let call = ["optimise", "optimised.toml", "--out", "."];
    bench.refused(&call, &["optimised.toml is an input"]);
    bench.refused(
        &[&call[..], &["--force"]].concat(),
        &["optimised.toml is an input"],
    );
    assert_eq!(bench.read("optimised.toml"), STUDY);
    let rows = "tie_rod_inner_dz\n1\n2\n";
    fs::write(bench.path("designs.csv"), rows).unwrap();
    let from = STUDY.find("method = ").unwrap();
    let to = STUDY.find("[optimise]").unwrap();
    let study = [&STUDY[..from], "designs = \"designs.csv\"\n", &STUDY[to..]].concat();
    fs::write(bench.path("rows.toml"), study).unwrap();
    bench.refused(
        &["sweep", "rows.toml", "--out", "."],
        &["designs.csv is an input"],
    );
    assert_eq!(bench.read("designs.csv"), rows);
    // A tuned study can run in the directory in which it is.
    bench
        .run(&["optimise", "optimised.toml", "--out", "a"])
        .success();
    let tuned = bench.read("a/optimised.toml");
    bench.refused(
        &["optimise", "a/optimised.toml", "--out", "a"],
        &["optimised.toml is an input"],
    );
    bench.refused(
        &["solve", "a/optimised.toml", "--out", "a"],
        &["holds the results"],
    );
    assert_eq!(bench.read("a/optimised.toml"), tuned);
}

/// If the study's name consists of dots, the program does not use it as the name of a directory.
#[test]
fn a_study_called_by_dots_writes_nowhere_else() {
    let bench = Bench::new();
    for name in ["...toml", "..toml"] {
        fs::write(bench.path(name), STUDY).unwrap();
        for command in ["solve", "optimise", "sweep"] {
            bench.refused(&[command, name], &["--out"]);
        }
        assert!(!bench.path("out").exists());
        bench.run(&["solve", name, "--out", "given"]).success();
        fs::remove_dir_all(bench.path("given")).unwrap();
    }
}

/// Two runs need the same directory at the same time. The message of the second run names the run that uses the
/// directory.
#[test]
fn one_run_at_a_time_writes_to_a_directory() {
    let bench = Bench::new();
    fs::create_dir(bench.path("out")).unwrap();
    let path = bench.path("out/.hardpoint-lock");
    let owner = r#"{"process": 4711, "host": "elsewhere", "command": "hardpoint sweep other"}"#;
    fs::write(&path, owner).unwrap();
    let lock = fs::OpenOptions::new().write(true).open(&path).unwrap();
    lock.lock().unwrap();
    for command in ["solve", "sweep", "optimise"] {
        let call = [command, "study.toml", "--out", "out"];
        bench.refused(
            &call,
            &[
                "out is being written by",
                "4711",
                "elsewhere",
                "sweep other",
            ],
        );
    }
    // Releases the lock, as the system does when the process that holds the lock ends.
    drop(lock);
    bench
        .run(&["solve", "study.toml", "--out", "out"])
        .success();
    assert!(!path.exists());
}

/// A sweep keeps a copy of its study, so that the sweep can run again. If the results are written into the directory of
/// the study, the program does not change the study.
#[test]
fn a_sweep_keeps_its_study() {
    let bench = Bench::new();
    let many = ["--set", "sweep.samples=50"];
    bench
        .run(&[&["sweep", "study.toml", "--out", "run"], &many[..]].concat())
        .success();
    let rows = bench.read("run/designs.csv");
    let kept = bench.read("run/study.toml");
    assert!(kept.contains("samples=50") || kept.contains("samples = 50"));
    bench
        .run(&["sweep", "run/study.toml", "--out", "again"])
        .success();
    assert_eq!(bench.read("again/designs.csv"), rows);
    bench.run(&["merge", "run", "--out", "merged"]).success();
    assert_eq!(bench.read("merged/study.toml"), kept);
    for more in [&[][..], &["--force"]] {
        let call = [&["sweep", "run/study.toml", "--out", "run"], more].concat();
        bench.run(&call).success();
        assert_eq!(bench.read("run/study.toml"), kept);
        assert_eq!(bench.read("run/designs.csv"), rows);
    }
    // A solve also keeps a copy of its study, even if it replaces results of an earlier version of the study.
    bench
        .run(&["solve", "study.toml", "--out", "solved"])
        .success();
    let call = ["solve", "solved/study.toml", "--set", "motion.travel=[0.0]"];
    bench
        .run(&[&call[..], &["--out", "solved", "--force"]].concat())
        .success();
    assert_eq!(bench.read("solved/study.toml"), STUDY);
}

/// The study names a file of designs. The kept copy of the study finds this file, wherever the copy is.
#[test]
fn a_kept_study_finds_its_designs() {
    let bench = Bench::new();
    let from = STUDY.find("[sweep]").unwrap();
    let study = STUDY[..from].to_owned() + "[sweep]\ndesigns = \"designs/mine.csv\"\n";
    fs::create_dir(bench.path("designs")).unwrap();
    fs::write(
        bench.path("designs/mine.csv"),
        "tie_rod_inner_dz\n1.0\n-2.5\n",
    )
    .unwrap();
    fs::write(bench.path("study.toml"), study).unwrap();
    bench
        .run(&["sweep", "study.toml", "--out", "deep/run"])
        .success();
    let kept = bench.read("deep/run/study.toml");
    assert!(kept.contains("\"../../designs/mine.csv\""), "{kept}");
    bench
        .run(&["sweep", "deep/run/study.toml", "--out", "again"])
        .success();
    assert_eq!(
        bench.read("again/designs.csv"),
        bench.read("deep/run/designs.csv")
    );
}

/// A program that reads the printed text from a pipe may stop early. The results are still complete, and their record
/// says "finished".
#[test]
fn a_closed_pipe_leaves_a_finished_run() {
    let bench = Bench::new();
    let setup = "setup={ adjust = [ { length = \"tie_rod\" } ], want = { toe = 0.2 } }";
    let tolerance =
        "tolerance={ builds = 200, scatter = [ { length = \"tie_rod\", sigma = 0.1 } ] }";
    for (command, set) in [
        ("solve", None),
        ("optimise", None),
        ("sweep", None),
        ("setup", Some(setup)),
        ("tolerance", Some(tolerance)),
    ] {
        let mut call = vec![command, "study.toml", "--out", command];
        call.extend(set.iter().flat_map(|set| ["--set", *set]));
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut started = bench.command(&call);
        started.stdout(writer).stderr(Stdio::piped());
        let ended = started.spawn().unwrap().wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(0), "{command}: {said}");
        let record = bench.read(&format!("{command}/run.json"));
        assert!(record.contains("\"finished\": true"), "{command}: {record}");
        // No file is missing.
        let files = contents(&bench.path(command));
        bench.run(&call).success();
        assert_eq!(contents(&bench.path(command)), files, "{command}");
    }
}

/// If the program cannot write the pictures, it refuses the run before it writes anything. The message names the option
/// that sets the directory of the pictures.
#[test]
fn pictures_in_the_way_are_refused_before_a_run() {
    let bench = Bench::new();
    let tolerance =
        "tolerance={ builds = 200, scatter = [ { length = \"tie_rod\", sigma = 0.1 } ] }";
    fs::write(bench.path("a_file"), "mine").unwrap();
    fs::create_dir(bench.path("pictures")).unwrap();
    fs::write(bench.path("pictures/camber_deg.svg"), "mine").unwrap();
    for command in ["solve", "optimise", "tolerance"] {
        let call = |plots, more: &[&'static str]| {
            let call = [command, "study.toml", "--out", "run", "--plots", plots];
            [&call[..], &["--set", tolerance], more].concat()
        };
        bench.refused(&call("a_file", &[]), &["cannot write a_file"]);
        bench.refused(&call("a_file/below", &[]), &["cannot write a_file/below"]);
        let advice = [
            "camber_deg.svg",
            "another directory with --plots",
            "--force",
        ];
        bench.refused(&call("pictures", &[]), &advice);
        assert!(!bench.path("run").exists(), "{command}");
        // If the program refuses the results, it writes no pictures either.
        fs::create_dir(bench.path("run")).unwrap();
        fs::write(bench.path("run/summary.json"), "mine").unwrap();
        bench.refused(&call("new/pictures", &[]), &["summary.json", "with --out"]);
        assert!(!bench.path("new").exists(), "{command}");
        fs::remove_dir_all(bench.path("run")).unwrap();
        // Pictures in the results directory belong to the results, so later runs replace them.
        for _ in 0..2 {
            bench.run(&call("run", &[])).success();
        }
        assert!(bench.path("run/camber_deg.svg").exists());
        fs::remove_dir_all(bench.path("run")).unwrap();
    }
    let contents = contents(&bench.path("pictures"));
    assert_eq!(contents, [("camber_deg.svg".to_owned(), b"mine".to_vec())]);
    bench
        .run(&["solve", "study.toml", "--out", "run"])
        .success();
    let call = ["report", "run", "--plots", "pictures"];
    bench.refused(&call, &["camber_deg.svg", "another directory with --plots"]);
    assert!(!bench.path("run/report.html").exists());
    let call = [
        "solve",
        "study.toml",
        "--out",
        "run",
        "--plots",
        "pictures",
        "--force",
    ];
    bench.run(&call).success();
    assert_ne!(
        fs::read(bench.path("pictures/camber_deg.svg")).unwrap(),
        b"mine"
    );
}

/// The program does not replace pictures of another study. It removes outdated pictures of the same study. With
/// `--force` it also removes the pictures of the other study.
#[test]
fn pictures_of_two_studies_are_not_mixed() {
    let bench = Bench::new();
    let call = |out, more: &[&'static str]| {
        let call = ["solve", "study.toml", "--out", out, "--plots", "pictures"];
        [&call[..], more].concat()
    };
    let other = ["--set", "outputs.characteristics=[\"toe\"]"];
    bench.run(&call("one", &[])).success();
    let before = contents(&bench.path("pictures"));
    bench.refused(&call("two", &other), &["pictures holds", "with --plots"]);
    assert_eq!(contents(&bench.path("pictures")), before);
    assert!(!bench.path("two").exists());
    // Another command can make the page and pictures of the same run again.
    bench
        .run(&["report", "one", "--plots", "pictures"])
        .success();
    bench.run(&call("one", &[])).success();
    let force = [&other[..], &["--force"]].concat();
    bench.run(&call("two", &force)).success();
    assert!(bench.path("pictures/toe_deg.svg").exists());
    assert!(!bench.path("pictures/camber_deg.svg").exists());
}

/// A run without a page or pictures removes those of an earlier run, because they would not match the new results. The
/// message names the removed files, and the option that writes them again.
#[test]
fn removed_pages_and_pictures_are_named() {
    let bench = Bench::new();
    let said = |more: &[&str]| {
        let call = [&["solve", "study.toml", "--out", "run"][..], more].concat();
        let ended = bench.run(&call).success();
        let said = String::from_utf8(ended.get_output().stdout.clone()).unwrap();
        crate::support::one_line(&said)
    };
    let first = said(&["--report", "--plots", "run"]);
    assert!(
        first.contains("report.html") && first.contains("run: camber_deg.svg"),
        "{first}"
    );
    assert!(!first.contains("Removed"), "{first}");
    let second = said(&[]);
    let (_, removed) = second
        .split_once("Removed files of an earlier run: ")
        .unwrap();
    for name in ["camber_deg.svg", "report.html"] {
        assert!(removed.contains(name), "{second}");
    }
    assert!(
        second.contains("--report writes the page again"),
        "{second}"
    );
    assert!(second.contains("--plots writes pictures again"), "{second}");
    assert!(!bench.path("run/report.html").exists());
    assert!(!bench.path("run/camber_deg.svg").exists());
    assert!(!said(&[]).contains("Removed"));
    // The message also names removed pictures in another directory.
    assert!(said(&["--plots", "pictures"]).contains("pictures: camber_deg.svg"));
}

/// If the directory contains a sweep, another command cannot tell whether the sweep used the same study. The message
/// states the command and the study of the existing results. It does not compare the studies.
#[test]
fn results_in_the_way_are_called_what_is_known_of_them() {
    let bench = Bench::new();
    bench
        .run(&["sweep", "study.toml", "--out", "run"])
        .success();
    let call = ["optimise", "study.toml", "--out", "run"];
    let of = "holds the results of `hardpoint sweep` of the study study (";
    bench.refused(&call, &[of]);
    let record = bench.read("run/run.json");
    let begun = record.replace("\"finished\": true", "\"finished\": false");
    assert_ne!(begun, record);
    fs::write(bench.path("run/run.json"), begun).unwrap();
    let of = "holds the unfinished results of `hardpoint sweep` of the study study (";
    bench.refused(&call, &[of]);
}

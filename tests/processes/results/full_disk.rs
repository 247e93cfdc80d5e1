//! Tests of a full disk. A limit on the size of files simulates the full disk.

use super::*;

/// The disk gets full. Complete files stay complete, and partial files do not count as results. When the disk has space
/// again, the sweep continues.
#[cfg(unix)]
#[test]
fn a_full_disk_loses_nothing_that_was_whole() {
    let bench = Bench::new();
    bench
        .run(&["sweep", "study.toml", "--out", "whole"])
        .success();
    let limited = |blocks: u32, call: &str| {
        let program = assert_cmd::cargo::cargo_bin("hardpoint");
        // SIGXFSZ would kill the process, which a full disk would not do. So the test ignores this signal.
        let script = format!(
            "trap '' XFSZ; ulimit -f {blocks}; exec '{}' {call}",
            program.display()
        );
        let mut shell = Command::new("sh");
        shell.current_dir(bench.0.path()).args(["-c", &script]);
        let output = shell.output().unwrap();
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    // Blocks have 512 or 1024 bytes. This is enough space for the record of the run, but not for the rows.
    let (code, said) = limited(6, "sweep study.toml --out full");
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains("cannot write") && said.contains("designs.csv"),
        "{said}"
    );
    let left: Vec<String> = contents(&bench.path("full"))
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    assert_eq!(left, ["run.json", "study.toml", "sweep.json"]);
    bench.refused(&["sweep", "study.toml", "--out", "full"], &["--resume"]);
    bench
        .run(&["sweep", "study.toml", "--out", "full", "--resume"])
        .success();
    assert_eq!(
        contents(&bench.path("full")),
        contents(&bench.path("whole"))
    );

    // A tuning and a solve replace their own earlier results while the disk gets full. Each file is then either
    // complete and old, or complete and new.
    for command in ["solve", "optimise"] {
        let call = [command, "study.toml", "--out", command];
        bench.run(&call).success();
        let before = contents(&bench.path(command));
        let (code, said) = limited(1, &call.join(" "));
        assert!(matches!(code, Some(1 | 2)), "{said}");
        assert!(said.contains("cannot write"), "{said}");
        for (name, text) in contents(&bench.path(command)) {
            let former = before.iter().find(|(known, _)| *known == name);
            let is_same = former.is_some_and(|(_, former)| *former == text);
            assert!(is_same || name == "run.json", "{command}: {name}");
        }
        bench.run(&call).success();
        assert_eq!(contents(&bench.path(command)), before);
    }
}

/// If the program cannot print help or version, it reports an error.
#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_printed_is_an_error() {
    let bench = Bench::new();
    for option in ["--help", "--version"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full");
        let mut command = bench.command(&[option]);
        let ended = command.stdout(full.unwrap()).output().unwrap();
        assert_eq!(ended.status.code(), Some(1), "{option}");
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(said.contains("cannot write to standard output"), "{said}");
    }
}

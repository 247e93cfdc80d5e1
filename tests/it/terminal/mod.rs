//! Tests of output to a terminal and to other programs: widths, quiet mode, colours, escapes and machine formats.

mod escapes;
mod formats;
mod quiet;
mod results;
mod width;
mod words;

use assert_cmd::Command;
use std::path::PathBuf;
use std::process::Output;

fn study(name: &str) -> PathBuf {
    crate::support::studies().join(format!("{name}.toml"))
}

/// Call in a temporary directory.
struct Called {
    directory: tempfile::TempDir,
    output: Output,
}

impl Called {
    fn with(arguments: &[&str], variables: &[(&str, &str)]) -> Called {
        let directory = tempfile::tempdir().unwrap();
        let mut command = Command::cargo_bin("hardpoint").unwrap();
        command.current_dir(directory.path()).args(arguments);
        command.env_remove("COLUMNS");
        command.envs(variables.iter().copied());
        let output = command.output().unwrap();
        Called { directory, output }
    }

    /// Runs a command on a sample study, and writes the results to the directory `run`.
    fn on(command: &str, name: &str, more: &[&str]) -> Called {
        let path = study(name);
        let mut arguments = vec![command, path.to_str().unwrap()];
        if ["solve", "optimise", "sweep"].contains(&command) {
            arguments.extend(["--out", "run"]);
        }
        arguments.extend(more);
        Called::with(&arguments, &[])
    }

    fn code(&self) -> Option<i32> {
        self.output.status.code()
    }

    fn said(&self) -> String {
        String::from_utf8(self.output.stdout.clone()).unwrap()
    }

    fn complained(&self) -> String {
        String::from_utf8(self.output.stderr.clone()).unwrap()
    }

    fn file(&self, name: &str) -> String {
        std::fs::read_to_string(self.directory.path().join("run").join(name)).unwrap()
    }
}

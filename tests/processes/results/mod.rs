//! Tests of the files of a results directory. They state which files a run may lose, whatever program writes there and
//! however the run ends.

mod claims;
mod full_disk;
#[cfg(unix)]
mod interrupts;
mod kills;
mod refused;

use assert_cmd::assert::Assert;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Study of a strut with three travels (to save time), with a sweep and a tuning.
const STUDY: &str = r#"[suspension]
topology = "macpherson"

[suspension.hardpoints]
lower_arm_front  = [ 120.0, 360.0, 195.0]
lower_arm_rear   = [-260.0, 350.0, 205.0]
lower_ball_joint = [   5.0, 705.0, 190.0]
strut_top        = [ -35.0, 575.0, 850.0]
strut_lower      = [ -11.0, 623.0, 370.0]
tie_rod_inner    = [-110.0, 330.0, 243.0]
tie_rod_outer    = [-130.0, 690.0, 240.0]
wheel_centre     = [   0.0, 760.0, 300.0]
spindle_inner    = [  -0.2, 660.0, 299.1]

[motion]
travel = [-40.0, 0.0, 40.0]

[outputs]
characteristics = ["camber"]

[sweep]
method = "sobol"
samples = 100
variables = [ { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] } ]

[optimise]
variables = [ { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] } ]
targets = [ { characteristic = "toe", points = [[-40.0, 0.1], [40.0, 0.1]], tolerance = 0.01 } ]
"#;

/// Directory with a study, in which commands run.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("study.toml"), STUDY).unwrap();
        Bench(directory)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("hardpoint"));
        command.current_dir(self.0.path()).args(arguments);
        command
    }

    fn run(&self, arguments: &[&str]) -> Assert {
        assert_cmd::Command::from_std(self.command(arguments)).assert()
    }

    fn start(&self, arguments: &[&str]) -> Child {
        let mut command = self.command(arguments);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().unwrap()
    }

    /// Starts a command. Each file that it writes may have at most this many blocks of 512 or 1024 bytes.
    fn start_with_room(&self, arguments: &[&str], blocks: u64) -> Child {
        // SIGXFSZ would kill the process, which a full disk would not do. So the test ignores this signal.
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
        let mut shell = Command::new("sh");
        shell.current_dir(self.0.path()).args(["-c", &script]);
        let program = assert_cmd::cargo::cargo_bin("hardpoint");
        shell.arg(program).args(arguments);
        shell.stdout(Stdio::null()).stderr(Stdio::piped());
        shell.spawn().unwrap()
    }

    /// Runs a call that must be refused. The message must contain all the phrases.
    fn refused(&self, arguments: &[&str], phrases: &[&str]) {
        let assert = self.run(arguments).code(2);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        for phrase in phrases {
            assert!(
                said.contains(phrase),
                "{arguments:?} lacks {phrase:?}: {said}"
            );
        }
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }
}

/// Names of all files of a directory without folders, with their content.
fn contents(directory: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        all.push((name, fs::read(&path).unwrap()));
    }
    all.sort();
    all
}

//! Tests of the live page: requests of other programs, saved files, and the page in a real browser.

mod answers;
mod attacks;
mod axle;
mod browser;
mod car;
mod client;
mod conflicts;
mod directions;
mod exports;
mod fields;
mod keyboard;
mod moves;
mod panels;
mod proposals;
mod reference;
mod saving;
mod start;
mod tuning;
pub(super) mod webdriver;

use crate::support::sample;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Server of a study in a temporary folder.
struct Served {
    folder: tempfile::TempDir,
    study: PathBuf,
    address: String,
    process: Child,
}

impl Served {
    fn of(text: &str) -> Served {
        Served::named("study.toml", text)
    }

    fn named(name: &str, text: &str) -> Served {
        Served::of_files([(name.to_owned(), text.to_owned())])
    }

    /// Writes files with these texts, and starts a server for the last one.
    fn of_files<const N: usize>(files: [(String, String); N]) -> Served {
        let folder = tempfile::tempdir().unwrap();
        let mut study = PathBuf::new();
        for (name, text) in files {
            study = folder.path().join(name);
            fs::write(&study, text).unwrap();
        }
        let (process, address) = serve(&study, free_port());
        Served {
            folder,
            study,
            address,
            process,
        }
    }

    fn text(&self) -> String {
        fs::read_to_string(&self.study).unwrap()
    }

    /// Names of the files in the folder of the study.
    fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn port(&self) -> u16 {
        self.address
            .split(['/', ':'])
            .nth(4)
            .unwrap()
            .parse()
            .unwrap()
    }

    fn token(&self) -> &str {
        self.address.split('/').nth(3).unwrap()
    }

    fn kill(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }

    /// Kills the server and starts another one on the same port.
    fn restart(&mut self) {
        let port = self.port();
        self.kill();
        (self.process, self.address) = serve(&self.study, port);
    }
}

/// Starts a server for a study on a port of its own, because parallel tests must not use each other's server.
fn serve(study: &Path, port: u16) -> (Child, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hardpoint"));
    command.arg("studio").arg(study);
    started(command, port)
}

/// Starts a server without a study in a folder.
fn serve_in(folder: &Path, port: u16) -> (Child, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hardpoint"));
    command.arg("studio").current_dir(folder);
    started(command, port)
}

fn started(mut command: Command, port: u16) -> (Child, String) {
    let mut process = command
        .arg("--no-open")
        .args(["--port", &port.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let out = process.stdout.take().unwrap();
    BufReader::new(out).read_line(&mut line).unwrap();
    (process, line.trim().to_owned())
}

fn free_port() -> u16 {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    listener.local_addr().unwrap().port()
}

impl Drop for Served {
    fn drop(&mut self) {
        self.kill();
    }
}

/// CSV that `hardpoint solve` writes.
fn solved(study: &Path) -> Vec<u8> {
    let output = Command::new(env!("CARGO_BIN_EXE_hardpoint"))
        .args(["solve", "--quiet", "--out", "-"])
        .arg(study)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    output.stdout
}

/// Columns of a CSV by name: numbers, or `None` for empty cells.
fn columns(csv: &[u8]) -> Vec<(String, Vec<Option<f64>>)> {
    let text = std::str::from_utf8(csv).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = lines.next().unwrap();
    let rows: Vec<Vec<&str>> = lines.collect();
    let column = |k: usize| rows.iter().map(|row| row[k].parse().ok()).collect();
    names
        .iter()
        .enumerate()
        .map(|(k, name)| ((*name).to_owned(), column(k)))
        .collect()
}

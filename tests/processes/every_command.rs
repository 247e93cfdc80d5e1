//! Runs of every command over randomly damaged studies, as processes. No run may panic, hang or take much memory, and
//! every refusal has a reason. No written number is infinite or NaN. If a row with the status `ok` has an empty cell,
//! the summary counts its reason.

use crate::support::bounded::wait_within_bounds;
use crate::support::mutants::mutilated;
use crate::support::random::Random;
#[cfg(target_os = "linux")]
use crate::support::signals;
use hardpoint::study::{Designs, Study};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of stations beyond which a study may take long. `MANY_POSES` is this limit for the stations of all designs
/// together.
const MANY_STATIONS: usize = 5_000;
const MANY_POSES: u64 = 2_000_000;

struct Mutant<'a> {
    text: String,
    directory: &'a Path,
    /// Numbers that determine the run time of the mutant. `None` if the program cannot read the mutant as a study.
    size: Option<Size>,
}

/// Numbers in a study that determine its run time.
#[derive(Clone, Copy)]
struct Size {
    stations: usize,
    sweep: Option<u64>,
    tuning: Option<u64>,
}

impl Size {
    /// Returns these numbers for a study. `None` if the program cannot read the study.
    fn of(text: &str, samples: &Path) -> Option<Size> {
        let study = Study::from_text("study.toml", text, samples).ok()?;
        let stations = match study.axle() {
            Some(both) => both.plan.motion.stations(),
            None => {
                let further = study.motions.iter().map(|(_, motion)| motion);
                let all = further.chain([study.motion()]);
                all.map(|motion| motion.values.len() * motion.rack.len())
                    .sum()
            }
        };
        Some(Size {
            stations,
            sweep: study.sweep.map(|sweep| match sweep.designs {
                Designs::Sampled(sampled) => sampled.samples * (sampled.variables.len() as u64 + 2),
                Designs::File(_) | Designs::Given(_) => 0,
            }),
            tuning: study
                .optimise
                .map(|optimise| optimise.starts as u64 * optimise.max_iterations * 10),
        })
    }
}

impl Mutant<'_> {
    /// Runs a command. Returns its output, or the reason why the result is not allowed.
    fn run(&self, arguments: &[&str]) -> Result<Output, String> {
        let path = |name: &str| self.directory.join(name);
        let [out, err] = ["stdout", "stderr"].map(path);
        let mut child = Command::new(env!("CARGO_BIN_EXE_hardpoint"))
            .args(arguments)
            .current_dir(self.directory)
            .stdin(std::process::Stdio::null())
            .stdout(fs::File::create(&out).unwrap())
            .stderr(fs::File::create(&err).unwrap())
            .spawn()
            .unwrap();
        let stations = self.size.map_or(0, |size| size.stations as u64);
        let status = wait_within_bounds(&mut child, stations)
            .map_err(|fault| format!("{arguments:?} {fault}"))?;
        let output = Output {
            status,
            stdout: fs::read(out).unwrap(),
            stderr: fs::read(err).unwrap(),
        };
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        match status.code() {
            Some(0..=2) if !said.contains("panicked") => Ok(output),
            _ => Err(format!("{arguments:?}: {status}\n{said}")),
        }
    }
}

/// Asserts that all numbers of a table are finite. Returns the number of empty cells in rows with the status `ok`, by
/// column.
fn empty_cells(csv: &[u8]) -> Result<BTreeMap<String, usize>, String> {
    let mut reader = csv::Reader::from_reader(csv);
    let header = reader.headers().map_err(|e| e.to_string())?.clone();
    let status = header.iter().position(|name| name == "status");
    let mut empty = BTreeMap::new();
    for row in reader.records() {
        let row = row.map_err(|e| e.to_string())?;
        let word = status.map(|k| &row[k]);
        for (name, cell) in header.iter().zip(&row) {
            if cell.parse::<f64>().is_ok_and(|number| !number.is_finite()) {
                return Err(format!("{name}: {cell}"));
            }
            let is_figure = !["status", "reason", "failed_at"].contains(&name);
            if cell.is_empty() && is_figure && matches!(word, Some("ok" | "ill_conditioned")) {
                *empty.entry(name.to_owned()).or_insert(0) += 1;
            }
        }
    }
    Ok(empty)
}

/// Empty cells that `summary.json` of a solve counts, by column.
fn counted_cells(summary: &serde_json::Value) -> BTreeMap<String, usize> {
    let mut counted = BTreeMap::new();
    for cells in summary["completeness"]["empty"]
        .as_array()
        .into_iter()
        .flatten()
    {
        for column in cells["columns"].as_array().into_iter().flatten() {
            let stations = cells["stations"].as_u64().unwrap() as usize;
            counted.insert(column.as_str().unwrap().to_owned(), stations);
        }
    }
    counted
}

/// Runs every command on one mutant (damaged study). Returns the first violation as an error.
fn examine(
    number: u64,
    samples: &Path,
    bases: &[String],
    ran: &AtomicU64,
    long: bool,
) -> Result<(), String> {
    let random = &mut Random(number.wrapping_mul(0x2545_F491_4F6C_DD1D) ^ 77);
    let base = &bases[(number % bases.len() as u64) as usize];
    let directory = tempfile::tempdir().unwrap();
    let text = mutilated(base, random);
    let mutant = Mutant {
        size: Size::of(&text, samples),
        text,
        directory: directory.path(),
    };
    fs::write(directory.path().join("study.toml"), &mutant.text).unwrap();
    let run = |arguments: &[&str]| {
        ran.fetch_add(1, Ordering::Relaxed);
        mutant.run(arguments)
    };
    let checked = run(&["check", "study.toml"])?;
    let Some(size) = mutant.size.filter(|_| checked.status.code() != Some(2)) else {
        let said = String::from_utf8_lossy(&checked.stderr);
        let refused = checked.status.code() == Some(2) && said.starts_with("error: ");
        return if refused {
            Ok(())
        } else {
            Err(format!("refused by the reader, and check says {said}"))
        };
    };
    if size.stations > MANY_STATIONS {
        return Ok(());
    }
    let read =
        |name: &str| fs::read(directory.path().join(name)).map_err(|e| format!("{name}: {e}"));
    let json = |name: &str| -> Result<serde_json::Value, String> {
        serde_json::from_slice(&read(name)?).map_err(|e| format!("{name}: {e}"))
    };

    let solved = run(&["solve", "study.toml", "--out", "solved"])?;
    if solved.status.code() == Some(2) {
        let said = String::from_utf8_lossy(&solved.stderr).into_owned();
        return Err(format!("check takes what solve refuses: {said}"));
    }
    let found = empty_cells(&read("solved/curves.csv")?)?;
    let summary = json("solved/summary.json")?;
    if found != counted_cells(&summary) {
        return Err(format!("empty cells {found:?}, counted {summary}"));
    }
    if checked.status.code() != solved.status.code() && !mutant.text.contains("certify") {
        return Err("check and solve do not agree".to_owned());
    }
    let reported = run(&["report", "solved"])?;
    if reported.status.code() != Some(0) {
        let said = String::from_utf8_lossy(&reported.stderr).into_owned();
        return Err(format!("report of what solve wrote: {said}"));
    }
    run(&["limits", "study.toml"])?;
    // For five links, the interval search over all rotations of the wheel carrier takes long.
    if long || !mutant.text.contains("five_link") {
        run(&["assemblies", "study.toml"])?;
    }
    let poses = |designs: u64| designs.saturating_mul(size.stations as u64);
    if size.sweep.is_none_or(|designs| poses(designs) < MANY_POSES) {
        let swept = run(&["sweep", "study.toml", "--out", "swept"])?;
        if swept.status.code() != Some(2) && directory.path().join("swept/designs.csv").exists() {
            empty_cells(&read("swept/designs.csv")?)?;
            json("swept/summary.json")?;
            run(&["report", "swept"])?;
            for shard in ["1/2", "2/2"] {
                run(&["sweep", "study.toml", "--shard", shard, "--out", "shards"])?;
            }
            run(&["merge", "shards", "--out", "merged"])?;
        }
    }
    if size
        .tuning
        .is_none_or(|iterations| poses(iterations) < MANY_POSES)
    {
        let tuned = run(&["optimise", "study.toml", "--out", "tuned"])?;
        if tuned.status.code() != Some(2) && directory.path().join("tuned/curves.csv").exists() {
            empty_cells(&read("tuned/curves.csv")?)?;
        }
    }
    Ok(())
}

fn every_command(mutants: std::ops::Range<u64>, long: bool) {
    let samples = crate::support::studies();
    let mut paths: Vec<_> = fs::read_dir(samples)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    paths.sort();
    // Omits studies with elastic parts, because `tests/it/compliance` damages them. Also omits cars.
    let texts = paths.iter().map(|path| fs::read_to_string(path).unwrap());
    let texts = texts.filter(|text| !text.contains("[compliance]") && !text.contains("\n[car]\n"));
    // Uses fewer samples and starts, because there are many mutants.
    let bases: Vec<String> = texts
        .map(|text| {
            text.replace("samples = 4096", "samples = 32")
                .replace("starts = 8", "starts = 2")
                .replace("steps = 41", "steps = 9")
                .replace("steps = 201", "steps = 21")
                .replace("steps = 31", "steps = 7")
                .replace("certify = true", "certify = false")
                .replace("scatter = 64", "scatter = 4")
        })
        .collect();
    let ran = AtomicU64::new(0);
    let next = AtomicU64::new(mutants.start);
    let failures = std::sync::Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= mutants.end {
                        break;
                    }
                    if let Err(reason) = examine(number, samples, &bases, &ran, long) {
                        let failure = format!("mutant {number}: {reason}");
                        // Also prints immediately, so that a failure is visible before a long run ends.
                        eprintln!("{failure}");
                        failures.lock().unwrap().push(failure);
                    }
                }
            });
        }
    });
    let failures = failures.into_inner().unwrap();
    let ran = ran.into_inner();
    println!("{ran} commands over mutants {mutants:?}");
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
    // `check` runs on every mutant. Other commands run only on those that are still studies.
    let count = mutants.end - mutants.start;
    assert!(count < 100 || ran > count + count / 4, "{ran}");
}

/// Numbers of the mutants from the environment variable, such as `MUTANTS=1000-1100`. Without the variable, the given
/// numbers.
fn chosen(otherwise: &str) -> std::ops::Range<u64> {
    let range = std::env::var("MUTANTS").unwrap_or_else(|_| otherwise.to_owned());
    let (from, to) = range.split_once('-').expect("two numbers");
    from.parse().unwrap()..to.parse().unwrap()
}

#[test]
fn every_command_over_mutants() {
    every_command(chosen("0-160"), false);
}

#[test]
#[ignore = "25,000 mutants through every command: with .ci/long"]
fn every_command_over_many_mutants() {
    every_command(chosen("1000-26000"), true);
}

/// Interrupts one command for each number of the range, and prints the worst result of each command.
#[cfg(target_os = "linux")]
fn interrupted(tries: std::ops::Range<u64>) {
    let signals = signals::Signals::of(crate::support::studies());
    let worst = std::sync::Mutex::new(signals::Worst::new());
    let failures: Vec<String> = tries
        .clone()
        .filter_map(|number| {
            let failed = signals.interrupt(number, &worst).err()?;
            let failure = format!("try {number}: {failed}");
            eprintln!("{failure}");
            Some(failure)
        })
        .collect();
    println!("signals {tries:?}: command, tries, interrupted, most seconds to the end");
    for (command, (tries, interrupted, seconds)) in worst.into_inner().unwrap() {
        println!("  {command:12} {tries:4} {interrupted:4} {seconds:.2}");
    }
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "a thousand commands interrupted: with .ci/long"]
fn a_signal_ends_every_command_often() {
    interrupted(10_000..11_000);
}

/// One signal is enough to end any command, whenever the signal arrives. The written files record the interruption.
/// `SIGNALS=3` runs the forty tries of seed 3.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_ends_every_command() {
    match std::env::var("SIGNALS").map(|seed| seed.parse::<u64>().expect("a seed")) {
        Ok(seed) => interrupted(40 * seed..40 * seed + 40),
        Err(_) => interrupted(0..8),
    }
}

//! Tests of commands that are interrupted at random moments. A number identifies each try.

use super::random::Random;
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Largest processor time from a signal to the end of the process, summed over all CPU threads.
const MOST_SECONDS: f64 = 0.3;
/// Error of a difference of two readings of processor time. A tick of the clock in `/proc/PID/stat` is 0.01 s, and each
/// reading has an error of up to one tick.
const READING: f64 = 0.02;
/// Longest wait for a process that should have ended. Long enough for a loaded machine.
const HANGS: Duration = Duration::from_secs(120);
/// Longest wait for a complete run. Long enough for a loaded machine.
const WHOLE_RUN: Duration = Duration::from_secs(900);

/// Files of an interrupted run that may differ from those of a complete run.
const PARTIAL: [(&str, &[&str]); 3] = [
    (
        "tolerance",
        &[
            "tolerance.csv",
            "contributors.csv",
            "curves_p1.csv",
            "curves_p5.csv",
            "curves_p95.csv",
            "curves_p99.csv",
            "report.json",
        ],
    ),
    (
        "optimise",
        &[
            "curves.csv",
            "sensitivities.csv",
            "optimised.toml",
            "front.csv",
            "history.csv",
            "report.json",
        ],
    ),
    ("sweep", &["pareto.csv"]),
];

/// A command with its arguments, which runs in a separate directory.
#[derive(Clone)]
struct Case {
    command: &'static str,
    arguments: Vec<String>,
    /// Directory of the results, if there is one.
    out: Option<&'static str>,
    /// True if every run writes the same results.
    is_exact: bool,
}

/// Result of a complete run.
#[derive(Clone)]
struct Reference {
    code: Option<i32>,
    seconds: f64,
    files: BTreeMap<String, Vec<u8>>,
}

/// Commands that run on the sample studies.
pub struct Signals {
    studies: PathBuf,
    cases: Vec<Case>,
    references: Mutex<HashMap<usize, Reference>>,
}

/// Results for each command: number of tries, number of interrupted tries, and largest time from the signal to the end
/// in seconds.
pub type Worst = BTreeMap<&'static str, (usize, usize, f64)>;

fn case(command: &'static str, arguments: &str, study: &str) -> Case {
    let arguments = arguments.replace("STUDY", study);
    Case {
        command,
        out: arguments.contains("--out out").then_some("out"),
        is_exact: command != "bench",
        arguments: arguments.split_whitespace().map(str::to_owned).collect(),
    }
}

/// Commands that can run on a study. Their settings are chosen so that each command takes about a second.
fn cases_of(study: &str, text: &str) -> Vec<Case> {
    let has = |section: &str| text.contains(&format!("\n[{section}"));
    let is_axle = has("axle");
    let mut cases = vec![
        case("check", "check STUDY", study),
        case(
            "solve",
            "solve STUDY --out out --report --plots plots",
            study,
        ),
        case("limits", "limits STUDY", study),
        case(
            "export",
            "export STUDY --to xlsx --out points.xlsx --force",
            study,
        ),
    ];
    let long = ["travel = {", "steps"]
        .iter()
        .all(|word| text.contains(word));
    if long && !is_axle && !has("motion.time") {
        let travel = "--set motion.travel={from=-5.0,to=5.0,steps=20001}";
        let solve = format!("solve STUDY --out out --report {travel}");
        cases.push(case("solve", &solve, study));
        cases.push(case("check", &format!("check STUDY {travel}"), study));
    }
    if !is_axle {
        cases.push(case("assemblies", "assemblies STUDY", study));
        cases.push(case("compare", "compare STUDY STUDY --out out", study));
    }
    if has("sweep") {
        let sweep = "sweep STUDY --out out --report --set sweep.samples=150000";
        cases.extend(vec![case("sweep", sweep, study); 3]);
    }
    if has("optimise") {
        cases.push(case(
            "optimise",
            "optimise STUDY --out out --report --plots plots",
            study,
        ));
        cases.push(case("optimise", "optimise STUDY --out out --prices", study));
        cases.push(case(
            "export",
            "export STUDY --to csv --round 0.5 --out p.csv --force",
            study,
        ));
    }
    if has("tolerance") {
        let builds = "--set tolerance.builds=30000";
        let tolerance = format!("tolerance STUDY --out out --report {builds}");
        cases.extend(vec![case("tolerance", &tolerance, study); 3]);
        if !is_axle {
            cases.push(case("limits", "limits STUDY --builds 300", study));
        }
    }
    if has("setup") && !is_axle {
        cases.push(case("setup", "setup STUDY --out out", study));
    }
    cases
}

impl Signals {
    pub fn of(studies: &Path) -> Self {
        let mut paths: Vec<_> = fs::read_dir(studies)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_some_and(|e| e == "toml"))
            .collect();
        paths.sort();
        let mut cases = Vec::new();
        for path in paths {
            let text = fs::read_to_string(&path).unwrap();
            // Only a few commands support elastic wheels and cars.
            if text.contains("[compliance]") || text.contains("\n[car]\n") {
                continue;
            }
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            cases.extend(cases_of(&name, &text));
        }
        for kind in ["effects", "accuracy", "throughput"] {
            let bench = format!("bench {kind} STUDY --samples 1 --out out");
            cases.push(case("bench", &bench, "macpherson_solve.toml"));
        }
        cases.push(case("report", "report solved", ""));
        cases.push(case("merge", "merge shards --out out", ""));
        cases.push(case(
            "import",
            "import points.xlsx --topology macpherson --out i.toml --force",
            "",
        ));
        Signals {
            studies: studies.to_owned(),
            cases,
            references: Mutex::default(),
        }
    }

    /// Directory with the studies, and with the inputs that some commands need.
    fn prepared(&self, case: &Case) -> tempfile::TempDir {
        let directory = tempfile::tempdir().unwrap();
        for entry in fs::read_dir(&self.studies).unwrap() {
            let path = entry.unwrap().path();
            fs::copy(&path, directory.path().join(path.file_name().unwrap())).unwrap();
        }
        let before = match case.command {
            "report" => "solve macpherson_front.toml --out solved",
            "merge" => "sweep macpherson_sweep.toml --out shards --set sweep.samples=140000",
            "import" => "export macpherson_front.toml --to xlsx --out points.xlsx",
            _ => return directory,
        };
        let arguments: Vec<String> = before.split_whitespace().map(str::to_owned).collect();
        let ended = start(directory.path(), &arguments).wait().unwrap();
        assert!(ended.code().is_some_and(|code| code < 2), "{before}");
        directory
    }

    /// Complete run of a case.
    fn reference(&self, number: usize) -> Reference {
        let known = self.references.lock().unwrap().get(&number).cloned();
        known.unwrap_or_else(|| {
            let case = &self.cases[number];
            let directory = self.prepared(case);
            let mut child = start(directory.path(), &case.arguments);
            let seconds = wait(&mut child, WHOLE_RUN).expect("a whole run ends");
            let reference = Reference {
                code: child.wait().unwrap().code(),
                seconds,
                files: files(directory.path()),
            };
            let mut references = self.references.lock().unwrap();
            references.insert(number, reference.clone());
            reference
        })
    }

    /// Interrupts a command chosen by a number. Returns the first violation as an error.
    pub fn interrupt(&self, number: u64, worst: &Mutex<Worst>) -> Result<(), String> {
        let random = &mut Random(number.wrapping_mul(0x9E6C_63D0_876A_3F35) ^ 1871);
        let mut share = || 0.5 + 0.5 * random.signed();
        let chosen = (share() * self.cases.len() as f64) as usize;
        let (terminates, when) = (share() < 0.5, share());
        let case = &self.cases[chosen];
        let reference = self.reference(chosen);
        let directory = self.prepared(case);
        let told = |what: String| format!("{} at {when:.3}: {what}", case.arguments.join(" "));

        let (signal, expected) = if terminates {
            ("-TERM", 143)
        } else {
            ("-INT", 130)
        };
        let mut child = start(directory.path(), &case.arguments);
        let moment = when * reference.seconds;
        while !is_over(&child) && seconds(&child) < moment {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_micros((share() * 1e4) as u64));
        let before = seconds(&child);
        let id = child.id().to_string();
        let was_over = is_over(&child);
        let sent = Command::new("kill")
            .args([signal, &id])
            .stderr(Stdio::null())
            .status();
        sent.unwrap();
        let after = wait(&mut child, HANGS).map_err(&told)?;
        let status = child.wait().unwrap();
        let code = status.code();
        let taken = after - before;
        let interrupted = code == Some(expected);
        println!(
            "try {number}: {} at {when:.2}: {taken:.2} s, {status}",
            case.arguments.join(" ")
        );
        {
            let mut worst = worst.lock().unwrap();
            let entry = worst.entry(case.command).or_insert((0, 0, 0.0));
            *entry = (
                entry.0 + 1,
                entry.1 + usize::from(interrupted),
                entry.2.max(taken),
            );
        }
        if !was_over && taken > MOST_SECONDS + READING {
            return Err(told(format!("{taken:.2} s of the processor to the end")));
        }
        let left = files(directory.path());
        self.check(case, &reference, code, interrupted, &left)
            .map_err(&told)?;
        self.again(case, &reference, directory.path())
            .map_err(&told)
    }

    /// Checks the files that a signal has left.
    fn check(
        &self,
        case: &Case,
        reference: &Reference,
        code: Option<i32>,
        interrupted: bool,
        left: &BTreeMap<String, Vec<u8>>,
    ) -> Result<(), String> {
        // Before the program has installed its handler, the operating system ends the program at the signal.
        let at_once = code.is_none()
            && case
                .out
                .is_none_or(|out| !left.contains_key(&format!("{out}/run.json")));
        if !interrupted && !at_once && code != reference.code {
            return Err(format!(
                "exit code {code:?}, of a whole run {:?}",
                reference.code
            ));
        }
        if let Some(hidden) = left.keys().find(|name| name.contains(".hardpoint-")) {
            return Err(format!("left {hidden}"));
        }
        let Some(out) = case.out else {
            return Ok(());
        };
        let read = |name: &str| -> Option<Value> {
            let bytes = left.get(&format!("{out}/{name}"))?;
            Some(serde_json::from_slice(bytes).unwrap_or(Value::Null))
        };
        let Some(run) = read("run.json") else {
            return if interrupted || at_once {
                Ok(())
            } else {
                Err("no run.json".to_owned())
            };
        };
        for (file, state) in [
            ("run.json", Some(&run["runs"][0])),
            ("summary.json", read("summary.json").as_ref()),
        ] {
            let found =
                state.map(|state| [state["finished"].as_bool(), state["interrupted"].as_bool()]);
            let expected = [Some(!interrupted), Some(interrupted)];
            let is_due =
                file == "run.json" || (reference.files.contains_key(&format!("{out}/{file}")));
            if found != Some(expected) && is_due {
                return Err(format!("{file} says {found:?}, exit code {code:?}"));
            }
        }
        let partial = PARTIAL.iter().find(|(command, _)| *command == case.command);
        let partial = partial.map_or(&[][..], |(_, names)| *names);
        for (name, bytes) in left.iter().filter(|_| case.is_exact) {
            let own = name.strip_prefix(&format!("{out}/")).unwrap_or("");
            let states = ["run.json", "summary.json"].contains(&own);
            // The directory of pictures has its own record. This record says that a signal ended the run early.
            let is_early = own.is_empty()
                && name.ends_with("/run.json")
                && serde_json::from_slice(bytes).is_ok_and(|record: Value| {
                    let run = &record["runs"][0];
                    run["finished"] == false && run["interrupted"] == true
                });
            let may_differ = interrupted && (states || is_early || partial.contains(&own));
            if !may_differ && reference.files.get(name) != Some(bytes) {
                return Err(format!("{name} is not that of a whole run"));
            }
        }
        Ok(())
    }

    /// Runs the command once more, or resumes the run. The bytes must equal those of a run without interruption.
    fn again(&self, case: &Case, reference: &Reference, directory: &Path) -> Result<(), String> {
        let mut arguments = case.arguments.clone();
        if case.command == "sweep" && directory.join("out/run.json").exists() {
            arguments.push("--resume".to_owned());
        }
        let mut child = start(directory, &arguments);
        wait(&mut child, WHOLE_RUN)?;
        let status = child.wait().unwrap();
        if status.code() != reference.code {
            return Err(format!("again: {status}"));
        }
        let found = files(directory);
        let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
        if names(&found) != names(&reference.files) {
            let lacks: Vec<_> = reference
                .files
                .keys()
                .filter(|name| !found.contains_key(*name))
                .collect();
            let extra: Vec<_> = found
                .keys()
                .filter(|name| !reference.files.contains_key(*name))
                .collect();
            return Err(format!("again: lacks {lacks:?}, has besides {extra:?}"));
        }
        let differs = |(name, bytes): &(&String, &Vec<u8>)| reference.files[*name] != **bytes;
        match found.iter().filter(|_| case.is_exact).find(differs) {
            Some((name, _)) => Err(format!("again: other bytes in {name}")),
            None => Ok(()),
        }
    }
}

fn start(directory: &Path, arguments: &[String]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hardpoint"));
    command.args(arguments).current_dir(directory);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command.spawn().unwrap()
}

/// Every file below a directory, by its path. Omits workbooks, because their archives contain a time.
fn files(directory: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut left = vec![directory.to_owned()];
    while let Some(at) = left.pop() {
        for entry in fs::read_dir(&at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                left.push(path);
                continue;
            }
            let name = path.strip_prefix(directory).unwrap();
            let name = name.to_string_lossy().into_owned();
            found.insert(name, fs::read(&path).unwrap());
        }
    }
    found
}

/// Fields of `/proc/PID/stat`, starting with the state of the process. After the end of a process, these fields remain
/// until its parent waits for it.
fn stat(child: &Child) -> Vec<String> {
    let stat = fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap_or_default();
    let after_name = stat.rsplit_once(')').map_or("", |(_, after)| after);
    after_name.split_whitespace().map(str::to_owned).collect()
}

fn is_over(child: &Child) -> bool {
    stat(child)
        .first()
        .is_none_or(|state| state == "Z" || state == "X")
}

/// Processor seconds of a process, in user and system mode.
fn seconds(child: &Child) -> f64 {
    let stat = stat(child);
    let ticks = |k: usize| stat.get(k).and_then(|t| t.parse::<f64>().ok());
    (ticks(11).unwrap_or(0.0) + ticks(12).unwrap_or(0.0)) / 100.0
}

/// Waits for the end of a process, but leaves its entry in `/proc`. Returns the processor seconds of the process.
fn wait(child: &mut Child, most: Duration) -> Result<f64, String> {
    let begun = Instant::now();
    while !is_over(child) {
        if begun.elapsed() > most {
            child.kill().unwrap();
            child.wait().unwrap();
            return Err("hangs".to_owned());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    Ok(seconds(child))
}

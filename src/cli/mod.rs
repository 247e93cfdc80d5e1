//! The command line: arguments, exit codes and progress. Only this module uses clap.

mod assemblies;
mod bench;
mod car;
mod check;
mod choices;
mod compare;
mod completions;
mod convert;
mod elastic;
mod embedded;
mod exit;
mod export;
mod export_source;
mod import;
mod import_car;
mod import_summary;
mod instead;
mod interrupt;
mod kc;
mod limits;
mod limits_of_builds;
mod man;
mod merge;
mod new;
mod optimise;
mod output;
mod printer;
mod progress;
mod report;
mod save;
mod schema;
mod setup;
mod solve;
mod studio;
mod sweep;
mod terminal;
mod tolerance;
mod unknown_option;

use crate::threads::stoppable;
use clap::{Args, Parser, Subcommand, ValueEnum};
pub use embedded::{NotDone, export_study, import_study, sweep_study};
use exit::{Exit, Stop};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::process::ExitCode;

/// Exact suspension kinematics, and the tuning of hardpoints towards target curves.
#[derive(Parser)]
#[command(name = "hardpoint", version, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 success; 1 a part of the request could not be solved (the other \
                  results are written); 2 the input or the command line is invalid (nothing is \
                  written); 130 or 143 stopped by SIGINT or SIGTERM (finished work is kept)."
)]
struct Arguments {
    /// Print errors and requested data only
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Print a commented study that runs
    New(new::NewArguments),
    /// Validate a study, list the computations with their reasons, and solve the design position
    Check(StudyArguments),
    /// Compute curves over the motion
    Solve(CurveArguments),
    /// Simulate the tests of a kinematics and compliance rig: toe, camber and displacements by travel, rack and loads
    Kc(KcArguments),
    /// Solve a batch of designs
    Sweep(SweepArguments),
    /// Join the parts of a sweep into one file
    Merge(MergeArguments),
    /// Tune the hardpoints until they meet the targets
    #[command(alias = "optimize")]
    Optimise(OptimiseArguments),
    /// Compute adjustments that give the target static values, and the effect of one turn of each adjustment
    Setup(RunArguments),
    /// Compute the effect of manufacturing scatter: sigma, percentiles, yield, contributors
    Tolerance(ToleranceArguments),
    /// Find the limits of travel, rack and arm, with the cause of each limit
    Limits(LimitsArguments),
    /// Find all positions in which the parts of the design can be assembled at a given travel
    Assemblies(AssembliesArguments),
    /// Measure this program on this machine
    Bench(BenchArguments),
    /// Make one HTML page of a finished run; --plots also makes pictures of its curves
    Report(ReportArguments),
    /// Print a study of points from a table (.csv, .xlsx), JSON, YAML or an Adams/Car subsystem
    Import(import::ImportArguments),
    /// Write a study in other units and axes, or for the wheel on the other side, with its comments
    Convert(convert::ConvertArguments),
    /// Export points and curves to other tools: CSV, XLSX, Adams/Car, OptimumKinematics, Assetto Corsa, CAD
    Export(export::ExportArguments),
    /// Compare curves, points and key values of two or more designs
    Compare(compare::CompareArguments),
    /// Open a live page on this machine: drag points, watch curves, tune, save
    Studio(studio::StudioArguments),
    /// Print the JSON schema of studies, for editors
    Schema,
    /// Print the completions of commands and options for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page for man
    Man,
}

/// Arguments that name a study.
#[derive(Args)]
struct StudyArguments {
    /// The study file (TOML), or - for standard input
    study: PathBuf,
    /// Override a field of the study, as in --set motion.rack=5.0; may be given more than once
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Format of printed tables
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

/// Arguments of a run.
#[derive(Args)]
struct RunArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Directory for the results, or - for the main CSV on standard output [default: out/STUDY]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite existing files, also files of other runs
    #[arg(long)]
    force: bool,
    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
    /// Also write report.html, one self-contained page
    #[arg(long)]
    report: bool,
}

/// Arguments of a run that writes curves.
#[derive(Args)]
struct CurveArguments {
    #[command(flatten)]
    run: RunArguments,
    /// Write the curves as pictures (SVG and PNG) into a directory; not for cars
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
}

/// Arguments of `hardpoint kc`.
#[derive(Args)]
struct KcArguments {
    #[command(flatten)]
    run: RunArguments,
    /// Add results with the names and definitions of another program to kc.csv
    #[arg(long, value_enum, value_name = "PROGRAM")]
    names: Option<Names>,
}

/// Programs whose names and definitions `hardpoint kc` can use in its results.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Names {
    /// Adams Car
    Adams,
    /// Altair MotionView
    Altair,
    /// Rigs of the SPMM kind: refused, because no published definition gives all signs
    Spmm,
}

/// Arguments of `hardpoint tolerance`.
#[derive(Args)]
struct ToleranceArguments {
    #[command(flatten)]
    curves: CurveArguments,
    /// Only print one build (parts with random deviations) as a study, by its number from 0
    #[arg(long, value_name = "N", conflicts_with_all = ["out", "force", "threads", "report", "plots"])]
    build: Option<u64>,
}

/// Arguments of `hardpoint limits`.
#[derive(Args)]
struct LimitsArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Print the nearest limits of the first N builds of [tolerance] (parts with random deviations), with the build of each limit
    #[arg(long, value_name = "N")]
    builds: Option<std::num::NonZeroU64>,
    /// Also write the limits as one self-contained page; not with --builds, not for cars
    #[arg(long, value_name = "PAGE.html", conflicts_with = "builds")]
    report: Option<PathBuf>,
    /// Replace an existing page
    #[arg(long, requires = "report")]
    force: bool,
}

/// Arguments of a tuning.
#[derive(Args)]
struct OptimiseArguments {
    #[command(flatten)]
    curves: CurveArguments,
    /// Print the smallest misfit for each of about ten sizes of the design change (--report includes it); not for fits and cars
    #[arg(long)]
    prices: bool,
}

/// Arguments of a sweep.
#[derive(Args)]
struct SweepArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Directory for the results, or - for the designs on standard output [default: out/STUDY]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite existing files, also files of other runs
    #[arg(long)]
    force: bool,
    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
    /// Continue an interrupted sweep, or add samples to its sequence
    #[arg(long)]
    resume: bool,
    /// Also write report.html, one self-contained page
    #[arg(long)]
    report: bool,
    /// Compute only shard I of N, as in --shard 3/8; all shards of the sweep use the same directory
    #[arg(long, value_name = "I/N", value_parser = sweep::shard)]
    shard: Option<[u64; 2]>,
    /// Only print the study of one design, by its number
    #[arg(long, value_name = "NUMBER", conflicts_with_all = ["out", "resume", "shard", "report"])]
    design: Option<u64>,
}

/// Arguments of `hardpoint merge`.
#[derive(Args)]
struct MergeArguments {
    /// The directories with the parts of the sweep, in any order
    #[arg(required = true, value_name = "RUN_DIR")]
    parts: Vec<PathBuf>,
    /// Directory for the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Overwrite existing files, also files of other runs
    #[arg(long)]
    force: bool,
    /// Format of printed tables
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

/// Arguments of `hardpoint assemblies`.
#[derive(Args)]
struct AssembliesArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Wheel travel, in the study's length unit
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    travel: f64,
    /// Rack displacement, in the study's axes and length unit
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    rack: f64,
}

/// Arguments of `hardpoint bench`.
#[derive(Args)]
struct BenchArguments {
    /// Kind of measurement
    #[arg(value_enum)]
    kind: BenchKind,
    /// Study with the suspension and travels to measure [default: the macpherson template; `cars` and `equilibria` need a study]
    study: Option<PathBuf>,
    /// Override a field of the study, as in --set motion.rack=5.0; may be given more than once
    #[arg(long, value_name = "PATH=VALUE", requires = "study")]
    set: Vec<String>,
    /// Format of the printed table
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
    /// Directory for the results, or - for the CSV on standard output [default: out/bench_STUDY]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite existing files, also files of other runs
    #[arg(long)]
    force: bool,
    /// Number of threads for throughput, in addition to one thread [default: every core]
    #[arg(long, value_parser = up_to::<MOST_THREADS>, value_name = "N")]
    threads: Option<usize>,
    /// Number of samples of each computing time; more samples reduce the noise of the result
    #[arg(long, value_parser = up_to::<MOST_SAMPLES>, value_name = "N", default_value_t = crate::bench::Clock::default().samples)]
    samples: usize,
}

/// Largest number of threads of a measurement. The measurement is repeated with every number of threads up to the requested
/// number.
const MOST_THREADS: usize = 128;

/// Largest number of samples of each computing time. A measurement keeps all samples in memory.
const MOST_SAMPLES: usize = 100_000;

fn up_to<const MOST: usize>(text: &str) -> Result<usize, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (1..=MOST).contains(number));
    number.ok_or_else(|| format!("expected a whole number from 1 to {MOST}"))
}

/// Benchmarks.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BenchKind {
    /// Poses per second by number of SIMD lanes, threads and outputs, compared with the formulation of Attia's paper
    Throughput,
    /// Computing time against true error of poses, curves and derivatives
    Accuracy,
    /// Computing time of each requested result, alone and accumulated, relative to positions alone
    Effects,
    /// Equilibria per second of a study with elastic parts, and time of its tests with derivatives
    Equilibria,
    /// Solved states of a car per second, with results, member loads and derivatives, and time of the study's tuning
    Cars,
}

/// Arguments of `hardpoint report`.
#[derive(Args)]
struct ReportArguments {
    /// The directory with the results of a run
    run: PathBuf,
    /// Write the curves as pictures (SVG and PNG) into a directory
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Overwrite existing files, also files of other runs
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TableFormat {
    Text,
    Csv,
    Json,
}

impl From<TableFormat> for crate::report::Format {
    fn from(format: TableFormat) -> Self {
        match format {
            TableFormat::Text => Self::Text,
            TableFormat::Csv => Self::Csv,
            TableFormat::Json => Self::Json,
        }
    }
}

/// Runs the program with the arguments of the process. Returns the exit code.
pub fn run() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os()))
}

/// Runs like [`run`], but inside a process that handles its own signals. The first argument is the program's name. Returns the
/// exit code.
pub fn run_embedded<A: Into<std::ffi::OsString> + Clone>(
    arguments: impl IntoIterator<Item = A>,
) -> u8 {
    crate::attia::register();
    let arguments: Vec<std::ffi::OsString> = arguments.into_iter().map(Into::into).collect();
    match Arguments::try_parse_from(&arguments) {
        Ok(arguments) => {
            let run = || stoppable(interrupt::stop(), || carried_out(arguments));
            let ended = catch_unwind(AssertUnwindSafe(run));
            ended
                .unwrap_or_else(|payload| {
                    if payload.is::<interrupt::Ended>() {
                        None
                    } else {
                        resume_unwind(payload)
                    }
                })
                .unwrap_or(Exit::Interrupted)
        }
        Err(error) => {
            let words = arguments.iter().skip(1).filter_map(|word| word.to_str());
            let command = words.into_iter().find(|word| !word.starts_with('-'));
            let error = unknown_option::with_tip(error, command);
            // clap also reports requests for help and version as errors.
            let printed = terminal::print_usage(&error);
            if error.use_stderr() {
                Exit::WrongInput
            } else {
                ended(printed.map(|()| Exit::Done).map_err(Stop::from))
            }
        }
    }
    .code()
}

/// Returns the commented study of a topology that `hardpoint new` prints. `parts` names the parts to add. The study runs
/// without changes.
///
/// # Errors
/// The reason in words: an unknown name, or a part that the topology does not have.
pub fn template(topology: &str, parts: &[String]) -> Result<String, String> {
    new::template(topology, parts)
}

/// Runs like [`run_embedded`], but also returns the text for standard error instead of printing it.
pub fn run_captured<A: Into<std::ffi::OsString> + Clone>(
    arguments: impl IntoIterator<Item = A>,
) -> (u8, String) {
    terminal::capture(|| run_embedded(arguments))
}

/// Stops the commands that run inside this process by [`run_embedded`], as Ctrl-C stops the program.
pub fn interrupt_embedded() {
    interrupt::raise();
}

/// Clears the request of [`interrupt_embedded`] before the next command.
pub fn forget_interrupt() {
    interrupt::reset();
}

/// Runs like [`run`] with these arguments. The first one is the program's name. Returns the exit code. A second signal ends the
/// process. The first signal also ends the process if there are no results to keep.
pub fn run_with<A: Into<std::ffi::OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> u8 {
    interrupt::listen();
    let code = run_embedded(arguments);
    interrupt::stops_by_itself();
    code
}

fn carried_out(arguments: Arguments) -> Exit {
    terminal::be_quiet(arguments.quiet);
    let found = match arguments.command {
        Command::New(arguments) => new::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Solve(arguments) => solve::run(&arguments),
        Command::Kc(arguments) => kc::run(&arguments),
        Command::Sweep(arguments) => sweep::run(&arguments),
        Command::Merge(arguments) => merge::run(&arguments),
        Command::Optimise(arguments) => optimise::run(&arguments),
        Command::Setup(arguments) => setup::run(&arguments),
        Command::Tolerance(arguments) => tolerance::run(&arguments),
        Command::Limits(arguments) => limits::run(&arguments),
        Command::Assemblies(arguments) => assemblies::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Report(arguments) => report::run(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Studio(arguments) => studio::run(&arguments),
        Command::Schema => schema::run(),
        Command::Completions { shell } => completions::run(shell),
        Command::Man => man::run(),
    };
    ended(found)
}

/// Prints the reason why a command stopped early, and returns its exit.
fn ended(found: Result<Exit, Stop>) -> Exit {
    match found {
        Ok(exit) => exit,
        Err(Stop::ClosedPipe) => Exit::Done,
        Err(Stop::WrongStudy(errors)) => {
            terminal::eprint_study_errors(&errors);
            Exit::WrongInput
        }
        Err(Stop::Failed { message, exit }) => {
            terminal::eprint(&format!("{}\n", message.trim_end()));
            exit
        }
    }
}

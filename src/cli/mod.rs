//! The command line: arguments, exit codes, progress. The only place that knows clap.

mod assemblies;
mod bench;
mod check;
mod choices;
mod compare;
mod completions;
mod exit;
mod export;
mod export_source;
mod import;
mod interrupt;
mod limits;
mod limits_of_builds;
mod man;
mod merge;
mod motions;
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

use clap::{Args, Parser, Subcommand, ValueEnum};
use exit::{Exit, Stop};
use std::path::PathBuf;
use std::process::ExitCode;

/// Exact suspension kinematics, and the tuning of hardpoints towards target curves.
#[derive(Parser)]
#[command(name = "hardpoint", version, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 done; 1 it ran, but something asked for could not be solved \
                        (the rest is written); 2 the input or the call is wrong (nothing is written); \
                        130 or 143 SIGINT or SIGTERM stopped it (finished work is kept)."
)]
struct Arguments {
    /// Print nothing but errors and asked-for data
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Print a commented study that runs as it is
    New(new::NewArguments),
    /// Read and validate a study, print what it will compute and why, solve the design position
    Check(StudyArguments),
    /// Curves over the motion
    Solve(RunArguments),
    /// A batch of designs
    Sweep(SweepArguments),
    /// Join the parts of a sweep to one file, for those who want one
    Merge(MergeArguments),
    /// Tune the hardpoints towards the targets
    #[command(alias = "optimize")]
    Optimise(OptimiseArguments),
    /// Adjustments that give the static values wanted, and what a turn of each does
    Setup(RunArguments),
    /// What manufacturing scatter does: sigma, percentiles, yield, who contributes
    Tolerance(ToleranceArguments),
    /// How far travel, rack and arm go from the design position, and what stops them
    Limits(LimitsArguments),
    /// Every way to assemble the design's lengths at a given travel
    Assemblies(AssembliesArguments),
    /// Measure this program on this machine
    Bench(BenchArguments),
    /// Make one HTML page of a finished run, or pictures of its curves
    Report(ReportArguments),
    /// Print a study of points from a table (.csv, .xlsx), JSON, YAML or an Adams/Car subsystem
    Import(import::ImportArguments),
    /// Points and curves for other tools: CSV, XLSX, Adams/Car
    Export(export::ExportArguments),
    /// Curves, points and figures of two or more designs side by side
    Compare(compare::CompareArguments),
    /// A live page on this machine: drag points, watch curves, tune, save
    Studio(studio::StudioArguments),
    /// Print the JSON schema of studies, for editors
    Schema,
    /// Print what makes a shell complete commands and options
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page, for man
    Man,
}

/// What names a study.
#[derive(Args)]
struct StudyArguments {
    /// The study file (TOML), or - for standard input
    study: PathBuf,
    /// Override a field of the study, as in --set motion.rack=5.0; may be given more than once
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// How tables are printed
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

/// What a run needs besides.
#[derive(Args)]
struct RunArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Directory for the results, or - for the main CSV on standard output [default: out/STUDY]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite what is there, whoever wrote it
    #[arg(long)]
    force: bool,
    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
    /// Write report.html as well: one page that needs nothing else
    #[arg(long)]
    report: bool,
    /// Write the curves as pictures (SVG and PNG) into a directory
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
}

/// What builds need besides.
#[derive(Args)]
struct ToleranceArguments {
    #[command(flatten)]
    run: RunArguments,
    /// Print one build, by its number from 0, as a study of its own, and nothing else
    #[arg(long, value_name = "N", conflicts_with_all = ["out", "force", "threads", "report", "plots"])]
    build: Option<u64>,
}

/// What limits need besides.
#[derive(Args)]
struct LimitsArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// How far the first N builds of [tolerance] go at least, each part of the table with the build that ends it
    #[arg(long, value_name = "N")]
    builds: Option<std::num::NonZeroU64>,
}

/// What a tuning needs besides.
#[derive(Args)]
struct OptimiseArguments {
    #[command(flatten)]
    run: RunArguments,
    /// Print what moving further buys: the least misfit for some ten moves (made for --report, too)
    #[arg(long)]
    prices: bool,
}

/// What a sweep needs besides.
#[derive(Args)]
struct SweepArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Directory for the results, or - for the designs on standard output [default: out/STUDY]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite what is there, whoever wrote it
    #[arg(long)]
    force: bool,
    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
    /// Go on with a sweep that was interrupted, or with more samples of its sequence
    #[arg(long)]
    resume: bool,
    /// Write report.html as well: one page that needs nothing else
    #[arg(long)]
    report: bool,
    /// Do the I-th of N shares of the sweep's parts, as in --shard 3/8, all into one directory
    #[arg(long, value_name = "I/N", value_parser = sweep::shard)]
    shard: Option<[u64; 2]>,
    /// Print the study of one design, by its number, and do nothing else
    #[arg(long, value_name = "NUMBER", conflicts_with_all = ["out", "resume", "shard", "report"])]
    design: Option<u64>,
}

/// Which parts are joined.
#[derive(Args)]
struct MergeArguments {
    /// The directories with the parts, in any order
    #[arg(required = true, value_name = "RUN_DIR")]
    parts: Vec<PathBuf>,
    /// Directory for the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Overwrite what is there, whoever wrote it
    #[arg(long)]
    force: bool,
    /// How tables are printed
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

/// Where assemblies are looked for.
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

/// What is measured, and on what.
#[derive(Args)]
struct BenchArguments {
    /// What to measure
    #[arg(value_enum)]
    kind: BenchKind,
    /// The study whose suspension and travels are measured [default: the template of a strut]
    study: Option<PathBuf>,
    /// Override a field of the study, as in --set motion.rack=5.0; may be given more than once
    #[arg(long, value_name = "PATH=VALUE", requires = "study")]
    set: Vec<String>,
    /// How the table is printed
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
    /// Directory for the results, or - for the CSV on standard output [default: out/bench_STUDY]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite what is there, whoever wrote it
    #[arg(long)]
    force: bool,
    /// Threads that throughput is measured on, beside one [default: every core]
    #[arg(long, value_parser = at_least_one, value_name = "N")]
    threads: Option<usize>,
    /// Samples of each time: more of them for less noise
    #[arg(long, value_parser = at_least_one, value_name = "N", default_value_t = crate::bench::Clock::default().samples)]
    samples: usize,
}

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) | Err(_) => Err("expected a whole number of 1 or more".to_owned()),
        Ok(number) => Ok(number),
    }
}

/// Benchmarks.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BenchKind {
    /// Poses per second: by lanes, by threads, by what is asked for, against the formulation of Attia's paper
    Throughput,
    /// What a digit costs: time against true error of every way to a pose, a curve, a derivative
    Accuracy,
    /// What each effect costs, alone and added up, relative to positions alone
    Effects,
}

/// What a report is made of.
#[derive(Args)]
struct ReportArguments {
    /// The directory a run has written its results to
    run: PathBuf,
    /// Write the curves as pictures (SVG and PNG) into a directory
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Overwrite what is there, whoever wrote it
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

/// Runs the command line and says how it ended.
pub fn run() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os()))
}

/// As [`run`] with these arguments, the first of them the program's name, inside a process that handles its own
/// signals; the exit code.
pub fn run_embedded<A: Into<std::ffi::OsString> + Clone>(
    arguments: impl IntoIterator<Item = A>,
) -> u8 {
    crate::attia::register();
    match Arguments::try_parse_from(arguments) {
        Ok(arguments) => carried_out(arguments),
        Err(error) => {
            // Help and version are errors to clap, too.
            terminal::print_usage(&error);
            match error.use_stderr() {
                true => Exit::WrongInput,
                false => Exit::Done,
            }
        }
    }
    .code()
}

/// As [`run`] with these arguments, the first of them the program's name; the exit code. A second signal ends the
/// process, and so does the first where nothing is to be kept.
pub fn run_with<A: Into<std::ffi::OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> u8 {
    interrupt::listen();
    run_embedded(arguments)
}

fn carried_out(arguments: Arguments) -> Exit {
    terminal::be_quiet(arguments.quiet);
    let ended = match arguments.command {
        Command::New(arguments) => new::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Solve(arguments) => solve::run(&arguments),
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
        Command::Export(arguments) => export::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Studio(arguments) => studio::run(&arguments),
        Command::Schema => schema::run(),
        Command::Completions { shell } => completions::run(shell),
        Command::Man => man::run(),
    };
    match ended {
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

//! Output to the terminal. Control sequences in texts are escaped; only errors of a study may have colours. Results and remarks
//! are wrapped to the width of the terminal. With `--quiet`, only errors and requested data are printed.

use crate::report::{is_printable, printable, wrapped};
use crate::study::StudyErrors;
use std::cell::RefCell;
use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Width of lines in characters if standard output is not a terminal and `COLUMNS` has no number.
const PAPER: usize = 100;
/// Smallest width to which lines are wrapped, in characters.
const LEAST: usize = 40;

static QUIET: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// Captured text for standard error of commands on this thread. `None` if nothing is captured.
    static CAPTURED: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Runs a function on this thread. Returns its text for standard error instead of printing it.
pub(super) fn capture<T>(run: impl FnOnce() -> T) -> (T, String) {
    CAPTURED.set(Some(String::new()));
    let found = run();
    (found, CAPTURED.take().unwrap_or_default())
}

/// Adds text to the captured text. Returns false if nothing is captured.
fn is_captured(text: &str) -> bool {
    CAPTURED.with_borrow_mut(|captured| {
        captured
            .as_mut()
            .map(|captured| captured.push_str(text))
            .is_some()
    })
}

/// Switches `--quiet` on or off. With `--quiet`, only errors and requested data are printed.
pub(super) fn be_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

pub(super) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Number of characters in a line of standard output: from the terminal, else from `COLUMNS`, else 100. At least 40.
pub(super) fn width() -> usize {
    let terminal = terminal_size::terminal_size_of(io::stdout());
    let terminal = terminal.map(|(width, _)| usize::from(width.0));
    let variable = || std::env::var("COLUMNS").ok()?.trim().parse().ok();
    terminal.or_else(variable).unwrap_or(PAPER).max(LEAST)
}

/// True if standard error accepts colours: it is a terminal, not a dumb one, and `NO_COLOR` is not set or empty.
pub(super) fn has_colours() -> bool {
    let asked_for_none = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    io::stderr().is_terminal() && !asked_for_none && !is_dumb()
}

/// True if the terminal can only print text and cannot move the cursor.
pub(super) fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|term| term == "dumb")
}

/// Writes text or tables to standard output.
pub(super) fn print(text: &str) -> io::Result<()> {
    io::stdout().write_all(wrapped(&printable(text), width()).as_bytes())
}

/// Writes to standard error. A closed or full standard error is ignored, because the results do not depend on it.
pub(super) fn eprint(text: &str) {
    if is_captured(text) {
        return;
    }
    let _ = io::stderr().write_all(printable(text).as_bytes());
}

/// Prints a remark on standard error, except with `--quiet`. Captured text contains the remark in any case.
pub(super) fn note(text: &str) {
    if !is_captured(text) && !is_quiet() {
        match terminal_size::terminal_size_of(io::stderr()) {
            Some((width, _)) => eprint(&wrapped(text, usize::from(width.0).max(LEAST))),
            // Lines of a log are not wrapped, because programs read them line by line.
            None => eprint(text),
        }
    }
}

/// Prints the errors of a study on standard error. The text has colours only if it contains no control characters for the
/// terminal.
pub(super) fn eprint_study_errors(errors: &StudyErrors) {
    let plain = errors.render(false);
    let captures = CAPTURED.with_borrow(Option::is_some);
    if !captures && has_colours() && is_printable(&plain) {
        let _ = writeln!(io::stderr(), "{}", errors.render(true).trim_end());
    } else {
        eprint(&format!("{}\n", plain.trim_end()));
    }
}

/// Prints errors of the arguments, or the requested help.
pub(super) fn print_usage(error: &clap::Error) -> io::Result<()> {
    let plain = error.render().to_string();
    let captures = CAPTURED.with_borrow(Option::is_some);
    if !captures && is_printable(&plain) {
        error.print()?;
        io::stdout().flush()
    } else {
        eprint(&plain);
        Ok(())
    }
}

//! End of a command.

use super::interrupt;
use crate::results::WriteError;
use crate::study::StudyErrors;
use std::io::{self, ErrorKind};
use std::path::Path;

/// Longest word of a reason, in characters. Only a cell of a hostile file has a longer one.
const LONGEST_WORD: usize = 300;
/// Longest reason.
const LONGEST_REASON: usize = 20_000;

/// A reason with its longest words cut: a file may have millions of characters where a number is expected.
fn shortened(reason: &str) -> String {
    let mut short = String::new();
    for word in reason.split_inclusive(char::is_whitespace) {
        if short.len() > LONGEST_REASON {
            return short + "...";
        }
        match word.char_indices().nth(LONGEST_WORD) {
            None => short += word,
            Some((end, _)) => {
                let word = word.trim_end();
                let count = word.chars().count();
                let head: String = word[..end.min(word.len())].chars().take(40).collect();
                short += &format!("{head}... ({count} characters) ");
            }
        }
    }
    short
}

/// Documented exits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Exit {
    /// The whole request is done.
    Done,
    /// A part could not be solved or written; the rest exists.
    Incomplete,
    /// The input or the call is wrong; nothing was written.
    WrongInput,
    /// A signal stopped it; finished work is kept.
    Interrupted,
}

impl Exit {
    /// Exit of a command that ran: done or incomplete.
    pub(super) fn of(is_complete: bool) -> Self {
        match is_complete {
            true => Exit::Done,
            false => Exit::Incomplete,
        }
    }

    /// Exit code.
    pub(super) fn code(self) -> u8 {
        match self {
            Exit::Done => 0,
            Exit::Incomplete => 1,
            Exit::WrongInput => 2,
            Exit::Interrupted => interrupt::exit_code(),
        }
    }
}

/// Reason that stops a command early.
#[derive(Debug)]
pub(super) enum Stop {
    /// Whoever read our output has seen enough.
    ClosedPipe,
    /// The study is wrong.
    WrongStudy(StudyErrors),
    /// Something else is wrong.
    Failed {
        /// For the user.
        message: String,
        /// The exit code it leads to.
        exit: Exit,
    },
}

impl Stop {
    /// The input or the call is wrong.
    pub(super) fn wrong_input(message: impl std::fmt::Display) -> Self {
        Stop::Failed {
            message: format!("error: {message}"),
            exit: Exit::WrongInput,
        }
    }

    /// A file, or its use, is wrong.
    pub(super) fn in_file(path: &Path, reason: impl std::fmt::Display) -> Self {
        let reason = shortened(&reason.to_string());
        Stop::wrong_input(format!("{}: {reason}", path.display()))
    }

    /// A study lacks a section that the command needs; `what` names its content.
    pub(super) fn no_section(path: &Path, section: &str, what: &str) -> Self {
        let reason = format!("the section [{section}] is missing: it gives {what}");
        Stop::in_file(path, reason)
    }

    /// A request that cannot be met.
    pub(super) fn not_met(message: impl std::fmt::Display) -> Self {
        Stop::Failed {
            message: format!("error: {message}"),
            exit: Exit::Incomplete,
        }
    }

    /// A request of an accepted file could not be solved.
    pub(super) fn unsolved(path: &Path, reason: impl std::fmt::Display) -> Self {
        Stop::not_met(format!("{}: {reason}", path.display()))
    }

    /// Marks a message as raised after the input was accepted and some results exist.
    pub(super) fn after_its_input(self) -> Self {
        match self {
            Stop::Failed { message, .. } => Stop::Failed {
                message,
                exit: Exit::Incomplete,
            },
            other => other,
        }
    }

    /// Results that were computed could not be written.
    pub(super) fn unwritten(error: WriteError) -> Self {
        Stop::Failed {
            message: format!("error: {error}"),
            exit: Exit::Incomplete,
        }
    }
}

impl From<StudyErrors> for Stop {
    fn from(errors: StudyErrors) -> Self {
        Stop::WrongStudy(errors)
    }
}

/// Errors of standard output and standard error.
impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            ErrorKind::BrokenPipe => Stop::ClosedPipe,
            _ => Stop::Failed {
                message: format!("error: cannot write to standard output: {error}"),
                exit: Exit::Incomplete,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reasons of usual length stay; a cell of millions of characters does not fill the terminal.
    #[test]
    fn reasons_have_a_bounded_length() {
        let usual = "line 4: expected a number,\n  found \"1.5 mm\"";
        assert_eq!(shortened(usual), usual);
        let word = format!(
            "expected a number, found {:?} in line 3",
            "7".repeat(5_000_000)
        );
        let short = shortened(&word);
        assert!(short.len() < 200 && short.ends_with("in line 3"), "{short}");
        assert!(short.contains("(5000002 characters)"), "{short}");
        assert!(shortened(&"1, ".repeat(2_000_000)).len() < 21_000);
        assert!(shortened(&"ä".repeat(1_000)).starts_with('ä'));
    }
}

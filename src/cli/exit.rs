//! Ends of a command: exit codes and errors.

use super::interrupt;
use crate::results::WriteError;
use crate::study::StudyErrors;
use std::io::{self, ErrorKind};
use std::path::Path;

/// Longest word in an error message, in characters. Only a table cell of a malicious or broken input file is longer.
const LONGEST_WORD: usize = 300;
/// Length in bytes beyond which no further word is added to an error message.
const LONGEST_REASON: usize = 20_000;

/// Shortens the longest words of a message, and cuts a very long message. A faulty file may have millions of characters instead
/// of a number.
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

/// Documented exits of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Exit {
    /// The command did everything that was requested.
    Done,
    /// Some results could not be computed or written. The other results exist.
    Incomplete,
    /// The input or the call is wrong. Nothing was written.
    WrongInput,
    /// A signal stopped the command. Finished work is kept.
    Interrupted,
}

impl Exit {
    /// Exit of a command that ran to its end: done or incomplete.
    pub(super) fn of(is_complete: bool) -> Self {
        if is_complete {
            Exit::Done
        } else {
            Exit::Incomplete
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

/// Reason why a command stops early.
#[derive(Debug)]
pub(super) enum Stop {
    /// The program that reads our output has closed the pipe.
    ClosedPipe,
    /// The study contains errors.
    WrongStudy(StudyErrors),
    /// Any other failure.
    Failed {
        /// Message for the user.
        message: String,
        /// Exit that this failure causes.
        exit: Exit,
    },
}

impl Stop {
    /// Failure because the input or the call is wrong.
    pub(super) fn wrong_input(message: impl std::fmt::Display) -> Self {
        Stop::Failed {
            message: format!("error: {message}"),
            exit: Exit::WrongInput,
        }
    }

    /// Failure because a file is wrong or cannot be used for this purpose.
    pub(super) fn in_file(path: &Path, reason: impl std::fmt::Display) -> Self {
        let reason = shortened(&reason.to_string());
        Stop::wrong_input(format!("{}: {reason}", path.display()))
    }

    /// Failure because the study lacks a section that the command needs. `what` names the content of the section.
    pub(super) fn no_section(path: &Path, section: &str, what: &str) -> Self {
        let reason = format!("the section [{section}] is missing: add it, with {what}");
        Stop::in_file(path, reason)
    }

    /// Failure because a request cannot be met.
    pub(super) fn not_met(message: impl std::fmt::Display) -> Self {
        Stop::Failed {
            message: format!("error: {message}"),
            exit: Exit::Incomplete,
        }
    }

    /// Failure because a request of an accepted file could not be solved.
    pub(super) fn unsolved(path: &Path, reason: impl std::fmt::Display) -> Self {
        Stop::not_met(format!("{}: {reason}", path.display()))
    }

    /// Marks a failure as incomplete instead of wrong input, because the input was accepted and some results may exist.
    pub(super) fn after_its_input(self) -> Self {
        match self {
            Stop::Failed { message, .. } => Stop::Failed {
                message,
                exit: Exit::Incomplete,
            },
            other => other,
        }
    }

    /// Failure because computed results could not be written.
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

/// Converts errors of standard output and standard error.
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

    /// Messages of usual length stay unchanged. If a table cell has millions of characters, the message is shortened.
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

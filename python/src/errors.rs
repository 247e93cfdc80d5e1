//! Exceptions.

use hardpoint::cli::NotDone;
use hardpoint::study::StudyErrors;
use pyo3::exceptions::{PyException, PyMemoryError};
use pyo3::prelude::*;

pyo3::create_exception!(
    hardpoint,
    HardpointError,
    PyException,
    "Base class of all errors of this module: a request cannot be computed. The text gives the \
     reason."
);
pyo3::create_exception!(
    hardpoint,
    StudyError,
    HardpointError,
    "A study is invalid. The text gives the position and what was expected; `line`, `column`, \
     `key` and `help` describe the first error."
);

/// Converts the errors of a study to an exception with file, line, column and key of the first one.
pub(crate) fn study_error(errors: &StudyErrors) -> PyErr {
    Python::attach(|python| {
        let error = StudyError::new_err(errors.render(false));
        let value = error.value(python);
        if let Some(first) = errors.all().first() {
            let (line, column) = first.position().unzip();
            // If an attribute cannot be set, the message still contains the same facts.
            let _ = value.setattr("line", line);
            let _ = value.setattr("column", column);
            let _ = value.setattr("key", first.path());
            let _ = value.setattr("help", first.suggestion());
        }
        error
    })
}

/// Exception for a request that cannot be computed.
pub(crate) fn failure(message: impl Into<String>) -> PyErr {
    HardpointError::new_err(message.into())
}

/// Exception for a result that does not fit into memory.
pub(crate) fn too_large(shape: &[usize]) -> PyErr {
    PyMemoryError::new_err(format!(
        "a result of shape {shape:?} does not fit into memory"
    ))
}

/// Exception for a command that returned no result. The text names parameters of Python instead of command-line options.
pub(crate) fn not_done(reason: NotDone) -> PyErr {
    match reason {
        NotDone::WrongStudy(errors) => study_error(&errors),
        NotDone::WrongInput(text) | NotDone::Incomplete(text) => failure(text),
        NotDone::Interrupted => failure("interrupted"),
    }
}

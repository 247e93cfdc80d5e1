//! Exceptions.

use hardpoint::cli::NotDone;
use hardpoint::study::StudyErrors;
use pyo3::exceptions::{PyException, PyMemoryError};
use pyo3::prelude::*;

pyo3::create_exception!(
    hardpoint,
    HardpointError,
    PyException,
    "Base of all errors of this module: a request cannot be computed, and the text says why."
);
pyo3::create_exception!(
    hardpoint,
    StudyError,
    HardpointError,
    "A study is wrong. The text says where and what was expected; `line`, `column`, `key` and `help` describe \
     the first mistake."
);

/// The mistakes of a study as an exception with their place.
pub(crate) fn study_error(errors: &StudyErrors) -> PyErr {
    Python::attach(|python| {
        let error = StudyError::new_err(errors.render(false));
        let value = error.value(python);
        if let Some(first) = errors.all().first() {
            let (line, column) = first.position().unzip();
            // An attribute that cannot be set leaves the message, which says the same.
            let _ = value.setattr("line", line);
            let _ = value.setattr("column", column);
            let _ = value.setattr("key", first.path());
            let _ = value.setattr("help", first.suggestion());
        }
        error
    })
}

/// An exception for a request that cannot be computed.
pub(crate) fn failure(message: impl Into<String>) -> PyErr {
    HardpointError::new_err(message.into())
}

/// An exception for a result that is larger than the memory.
pub(crate) fn too_large(shape: &[usize]) -> PyErr {
    PyMemoryError::new_err(format!(
        "a result of shape {shape:?} does not fit into memory"
    ))
}

/// An exception for a command of the program that has no result. Options of the command line are parameters here.
pub(crate) fn not_done(reason: NotDone) -> PyErr {
    match reason {
        NotDone::WrongStudy(errors) => study_error(&errors),
        NotDone::WrongInput(text) | NotDone::Incomplete(text) => failure(text),
        NotDone::Interrupted => failure("interrupted"),
    }
}

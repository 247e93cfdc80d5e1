//! Exceptions.

use hardpoint::study::StudyErrors;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

pyo3::create_exception!(
    hardpoint,
    HardpointError,
    PyException,
    "Something asked for cannot be computed."
);
pyo3::create_exception!(
    hardpoint,
    StudyError,
    HardpointError,
    "A study is wrong. The text says where and what was expected; `line`, `column`, `key` and `help` say so of \
     the first mistake."
);

/// What is wrong with a study, as an exception with its place.
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

/// What cannot be computed.
pub(crate) fn failure(message: impl Into<String>) -> PyErr {
    HardpointError::new_err(message.into())
}

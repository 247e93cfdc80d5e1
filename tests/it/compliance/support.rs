//! Studies of the repository with elastic parts, with text at their end.

use hardpoint::study::Study;
use std::path::Path;

/// The text of a study of the repository, with more at its end.
pub fn with(name: &str, more: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("studies")
        .join(name);
    std::fs::read_to_string(path).unwrap() + more
}

/// A study with elastic parts from its text.
pub fn elastic(text: &str) -> Study {
    Study::elastic_from_text("case.toml", text, Path::new("")).unwrap_or_else(|e| panic!("{e}"))
}

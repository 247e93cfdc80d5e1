//! `hardpoint schema`: prints the JSON schema of studies, for editors.

use super::exit::{Exit, Stop};
use std::io::Write;

pub(super) fn run() -> Result<Exit, Stop> {
    let schema = crate::study::schema();
    let text = serde_json::to_string_pretty(&schema).expect("JSON can store a schema");
    writeln!(std::io::stdout(), "{text}")?;
    Ok(Exit::Done)
}

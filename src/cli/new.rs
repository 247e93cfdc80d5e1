//! `hardpoint new`

use super::exit::{Exit, Stop};
use crate::model::Topology;
use std::io::Write;

pub(super) fn run(name: &str) -> Result<Exit, Stop> {
    let Some(topology) = Topology::named(name) else {
        let known = Topology::ALL.iter();
        let known: Vec<String> = known
            .map(|t| format!("  {:22} {}", t.name, t.summary))
            .collect();
        return Err(Stop::wrong_input(format!(
            "there is no topology \"{name}\"; expected one of\n{}",
            known.join("\n")
        )));
    };
    std::io::stdout().write_all(topology.template.as_bytes())?;
    Ok(Exit::Done)
}

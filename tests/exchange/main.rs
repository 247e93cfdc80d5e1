//! Points out to other tools and back: the same doubles; and files as they should not be.

mod cad;
mod commands;
mod export_commands;
mod exports;
mod hostile;
mod other_tools;
mod parsers;
mod round_trips;
mod schema;

use hardpoint::exchange::{ImportOptions, Imported, import, read_points};
use hardpoint::model::{FrameConvention, LengthUnit, Side, Topology};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What is said of a file on the command line.
#[derive(Clone, Default)]
struct Said {
    unit: Option<LengthUnit>,
    frame: Option<FrameConvention>,
    side: Option<Side>,
    sheet: Option<&'static str>,
    names: BTreeMap<String, String>,
}

fn imported(path: &Path, topology: &str, said: &Said) -> Result<Imported, String> {
    let table = read_points(path, said.sheet)?;
    let options = ImportOptions {
        topology: Topology::named(topology).unwrap(),
        unit: said.unit,
        frame: said.frame,
        side: said.side,
        names: &said.names,
    };
    import(&table, &options)
}

/// A file in a directory of its own.
fn file(directory: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = directory.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

//! Tests of exporting points to other tools and importing them again: every number stays the same, bit for bit. Other
//! tests cover faulty files.

mod axes;
mod cad;
mod car_sheets;
mod cars;
mod commands;
mod export_commands;
mod exports;
mod formats;
mod hostile;
mod live_axles;
mod other_tools;
mod parsers;
mod property_files;
mod right_or_refused;
mod round_trips;
mod samples;
mod schema;
mod sheets;
mod side_by_side;
mod silent;
mod studies;
mod units;

use hardpoint::exchange::Axes;
use hardpoint::exchange::{FileUnit, ImportOptions, Imported, import, read_points};
use hardpoint::model::{AxlePosition, FrameConvention, Side, Topology};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Options for a file on the command line.
#[derive(Clone, Default)]
struct Said {
    unit: Option<FileUnit>,
    frame: Option<FrameConvention>,
    axes: Option<&'static str>,
    side: Option<Side>,
    axle: Option<AxlePosition>,
    half_track: Option<f64>,
    sheet: Option<&'static str>,
    names: BTreeMap<String, String>,
    bodies: BTreeMap<String, String>,
}

fn imported(path: &Path, topology: &str, said: &Said) -> Result<Imported, String> {
    let table = read_points(path, said.sheet, said.axle).map_err(|refusal| refusal.to_string())?;
    let options = ImportOptions {
        topology: Topology::named(topology).unwrap(),
        unit: said.unit,
        frame: said.frame,
        axes: said.axes.map(|axes| Axes::parse(axes).unwrap()),
        side: said.side,
        axle: said.axle,
        half_track: said.half_track,
        radius: None,
        bushings: false,
        names: &said.names,
        bodies: &said.bodies,
    };
    import(&table, &options).map_err(|refusal| refusal.to_string())
}

/// Writes a file in a temporary directory.
fn file(directory: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = directory.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

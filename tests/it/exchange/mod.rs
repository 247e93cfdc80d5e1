//! Tests of exporting points to other tools and importing them again: every number stays the same, bit for bit. Other
//! tests cover faulty files.

mod adams;
mod assetto;
mod axes;
mod cad;
mod car_sheets;
mod cars;
mod chrono;
mod commands;
mod comparison;
mod doubts;
mod export_commands;
mod exports;
mod geometry;
mod hostile;
mod live_axles;
mod optimum;
mod other_tools;
mod parsers;
mod property_files;
mod round_trips;
mod rounding;
mod samples;
mod schema;
mod sheets;
mod silent;
mod studies;
mod tables;
mod units;
mod vehicles;

use hardpoint::exchange::{
    Axes, FileUnit, ImportOptions, Imported, ImportedCar, import, import_car, read_points,
};
use hardpoint::model::{AxlePosition, FrameConvention, Side, Topology};
use hardpoint::study::Study;
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
    radius: Option<f64>,
    bushings: bool,
    names: BTreeMap<String, String>,
    bodies: BTreeMap<String, String>,
}

impl Said {
    fn options(&self, topology: &'static Topology) -> ImportOptions<'_> {
        ImportOptions {
            topology,
            unit: self.unit,
            frame: self.frame,
            axes: self.axes.map(|axes| Axes::parse(axes).unwrap()),
            side: self.side,
            axle: self.axle,
            half_track: self.half_track,
            radius: self.radius,
            bushings: self.bushings,
            names: &self.names,
            bodies: &self.bodies,
        }
    }
}

fn imported(path: &Path, topology: &str, said: &Said) -> Result<Imported, String> {
    let table = read_points(path, said.sheet, said.axle).map_err(|refusal| refusal.to_string())?;
    let options = said.options(Topology::named(topology).unwrap());
    import(&table, &options).map_err(|refusal| refusal.to_string())
}

/// Writes a file in a temporary directory.
fn file(directory: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = directory.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Imports the car of a file.
fn car_of(path: &Path, radius: Option<f64>) -> Result<ImportedCar, String> {
    let table = read_points(path, None, None).map_err(|refusal| refusal.to_string())?;
    let ends = [AxlePosition::Front, AxlePosition::Rear].map(|axle| Said {
        axle: Some(axle),
        radius,
        ..Said::default()
    });
    let topology = |said: &Said| {
        let found = table.topology(said.axle);
        found.map_err(|refusal| refusal.to_string())
    };
    let front = ends[0].options(topology(&ends[0])?);
    let rear = ends[1].options(topology(&ends[1])?);
    import_car(&table, [&front, &rear], "there").map_err(|refusal| refusal.to_string())
}

/// Study, read from its text.
fn study(text: &str) -> Study {
    Study::elastic_from_text("s.toml", text, Path::new("."))
        .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Position of a hardpoint of an imported suspension.
fn at(read: &Imported, name: &str) -> [f64; 3] {
    let found = read.hardpoints.iter().find(|h| h.name == name);
    found
        .unwrap_or_else(|| panic!("{name}: {:?}", read.left_out))
        .position
}

/// Asserts that two points differ by less than 1e-9 in each coordinate.
fn close(found: [f64; 3], wanted: [f64; 3], name: &str) {
    for (found, wanted) in found.into_iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-9, "{name}: {found} {wanted}");
    }
}

/// Study of an imported suspension.
fn runs(read: &Imported) -> Study {
    let text = read.study("made up", "there").unwrap();
    Study::from_text("s.toml", &text, Path::new(".")).unwrap()
}

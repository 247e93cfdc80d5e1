//! Writes a new study that the user chooses on the page: a topology, and optionally points from a spreadsheet.

use super::message::{Coordinates, StartRequest};
use super::overview::coordinates;
use super::study_file::check_name;
use crate::exchange::{Axes, FileUnit, ImportOptions, Imported, import, read_points};
use crate::model::{Side, Topology};
use crate::report::Scene;
use crate::results::{temporary_of, undivided};
use crate::study::Study;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A topology to start from, with its picture.
#[derive(Serialize)]
pub(super) struct Choice {
    name: &'static str,
    summary: &'static str,
    /// Names of the topology's hardpoints. The flag is true for hardpoints that a study must give.
    hardpoints: Vec<(&'static str, bool)>,
    scene: Scene,
    design: Coordinates,
}

/// All topologies that the page offers for a new study: every topology whose template can be read.
pub(super) fn choices() -> Vec<Choice> {
    let choice = |topology: &&'static Topology| {
        let topology: &'static Topology = topology;
        let study = Study::from_text(topology.name, topology.template, Path::new("")).ok()?;
        let suspension = study.wheel();
        Some(Choice {
            name: topology.name,
            summary: topology.summary,
            hardpoints: topology
                .hardpoints
                .iter()
                .map(|h| (h.name, h.required))
                .collect(),
            scene: Scene::of(suspension),
            design: coordinates(suspension, &suspension.design),
        })
    };
    Topology::ALL.iter().filter_map(choice).collect()
}

/// Writes a new study into a directory. It does not change an existing file.
///
/// # Errors
/// The reason in words: the name or the points are invalid, or the file cannot be written.
pub(super) fn start(directory: &Path, request: &StartRequest) -> Result<PathBuf, String> {
    check_name(&request.name)?;
    let known = Topology::named(&request.topology);
    let topology = known.ok_or_else(|| format!("there is no topology {:?}", request.topology))?;
    let text = match request.points.trim() {
        "" => {
            let own = format!("{}_solve.toml", topology.name);
            topology.template.replace(&own, &request.name)
        }
        points => imported(topology, points, request)?
            .study(&request.name, "points pasted into the studio")
            .map_err(|why| format!("the points do not form a valid suspension\n{why}"))?,
    };
    // A text that no command could read is not written.
    Study::elastic_from_text(&request.name, &text, directory)
        .map_err(|errors| errors.render(false))?;
    let path = directory.join(&request.name);
    let failed = |e: std::io::Error| format!("{}: {e}", path.display());
    let mut file = temporary_of(directory, "studio").map_err(failed)?;
    file.write_all(text.as_bytes()).map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    let written = undivided(|| file.persist_noclobber(&path).map(drop).map_err(|e| e.error));
    written.map_err(|e| match e.kind() {
        std::io::ErrorKind::AlreadyExists => {
            format!("there is a file {}: choose another name", request.name)
        }
        _ => failed(e),
    })?;
    Ok(path)
}

/// Imports points from a pasted spreadsheet, as `hardpoint import` does from a file.
fn imported(
    topology: &'static Topology,
    points: &str,
    request: &StartRequest,
) -> Result<Imported, String> {
    let given = |text: &Option<String>| text.clone().filter(|text| !text.is_empty());
    let unit = given(&request.unit).map(|unit| {
        FileUnit::named(&unit)
            .ok_or_else(|| format!("expected mm, cm, m, in or ft, found {unit:?}"))
    });
    let axes = given(&request.axes).map(|axes| Axes::parse(&axes).map_err(|why| in_form(&why)));
    let side = given(&request.side).map(|side| {
        let mut all = Side::ALL.into_iter();
        let found = all.find(|one| one.name() == side);
        found.ok_or_else(|| format!("expected left or right, found {side:?}"))
    });
    let options = ImportOptions {
        topology,
        unit: unit.transpose()?,
        frame: None,
        axes: axes.transpose()?,
        side: side.transpose()?,
        axle: None,
        half_track: request.half_track,
        radius: request.wheel_radius,
        bushings: false,
        names: &BTreeMap::new(),
        bodies: &BTreeMap::new(),
    };
    let named = |e: std::io::Error| format!("cannot write the points to a temporary file: {e}");
    let mut file = tempfile::Builder::new()
        .suffix(".csv")
        .tempfile()
        .map_err(named)?;
    file.write_all(points.as_bytes()).map_err(named)?;
    let table =
        read_points(file.path(), None, None).map_err(|refusal| in_form(&refusal.to_string()))?;
    import(&table, &options).map_err(|refusal| in_form(&refusal.to_string()))
}

/// Text of an import refusal in which the names of the form's fields replace the flags of `hardpoint import`.
fn in_form(refusal: &str) -> String {
    let fields = [
        ("--half-track", "half track"),
        ("--radius", "wheel radius"),
        ("--unit", "unit"),
        ("as in --axes ", "as in "),
        ("--axes", "axes"),
        ("--side", "wheel"),
    ];
    let words = fields
        .iter()
        .fold(refusal.to_owned(), |words, (flag, field)| {
            words.replace(flag, field)
        });
    // In this message, "it" means the file. The form has no file, so the message names the pasted text instead.
    let words = match words.strip_prefix("it ") {
        Some(rest) => format!("the pasted text {rest}"),
        None => words,
    };
    // The form has no file of names. The user can rename points in the pasted text.
    match words.split_once("name them in a file for --map, as in") {
        Some((before, example)) => {
            let hardpoint = example.split('=').next().unwrap_or_default().trim();
            format!("{before}rename them in the points, for example to {hardpoint}")
        }
        None => words.replace("--map", "the names of the points"),
    }
}

//! Reads the study file of a wheel or an axle, and writes it back with its comments.

#[cfg(test)]
mod tests;

use super::message::{Coordinates, TextChange};
use crate::mechanism::GeometryFault;
use crate::model::{Axis, Frame, Suspension};
use crate::number::Vector3;
use crate::optimise::TargetLayout;
use crate::report::is_printable;
use crate::results::{temporary_of, undivided};
use crate::study::{
    LONGEST_TEXT, Study, StudyErrors, ValueEdit, Variable, checked_number, edited_text,
    read_regular_text,
};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::NamedTempFile;

/// A study text that was read, with the resolved study.
pub(super) struct Opened {
    /// Path of the study file.
    pub file: StudyFile,
    /// SHA-256 of `text`.
    pub digest: String,
    /// SHA-256 of `base_text`.
    pub base: String,
    /// Text of the file as it was read, without `edits`.
    pub base_text: Arc<str>,
    /// Changes of values that are not yet saved in the file.
    pub edits: Vec<ValueEdit>,
    /// Text of the file with `edits` applied.
    pub text: String,
    pub study: Study,
    /// Variables for gradients: one for every hardpoint coordinate, in the order of the points.
    pub every: Vec<Variable>,
    /// Stations at which targets of the nominal design are evaluated, if there are targets.
    pub layout: Option<TargetLayout>,
}

/// Condition under which a save may replace the study files.
pub(super) struct Over<'r> {
    /// SHA-256 of the files' texts that the page last read or wrote. `None` if these are the texts to which the design's
    /// changes refer.
    pub known: Option<&'r str>,
    /// True to write the changes into files that another program has changed.
    pub anyway: bool,
}

/// Reason why a file was not saved.
pub(super) enum NotSaved {
    /// The file has changed since it was opened, or another file of that name exists.
    Changed(String),
    /// The name or the design is not valid, or the file cannot be written.
    Refused(String),
}

impl Opened {
    fn of(path: &Path, text: String) -> Result<Self, StudyErrors> {
        let directory = path.parent().unwrap_or(Path::new(""));
        let study = Study::elastic_from_text(&path.display().to_string(), &text, directory)?;
        let layout = study.optimise.as_ref();
        let layout = layout.map(|o| TargetLayout::nominal(o, &study.vehicle));
        let digest = digest(&text);
        Ok(Opened {
            file: StudyFile {
                path: path.to_owned(),
            },
            base: digest.clone(),
            base_text: text.as_str().into(),
            digest,
            edits: Vec::new(),
            every: Variable::every_coordinate(study.wheel(), [-1.0, 1.0]),
            layout,
            text,
            study,
        })
    }

    /// Study with the hardpoint coordinates of the page. Returns an error if the points do not form a suspension.
    pub(super) fn moved(&self, coordinates: &Coordinates) -> Result<Study, String> {
        let study = self.study.at_design(self.design(coordinates)?);
        check_geometry(&study)?;
        Ok(study)
    }

    /// Converts coordinates of the page to a design in the internal frame (x forward, y left, z up).
    pub(super) fn design(&self, coordinates: &[[f64; 3]]) -> Result<Vec<Vector3<f64>>, String> {
        let suspension = self.study.wheel();
        in_kernel(coordinates, suspension, suspension.frame)
    }
}

/// Refuses points that do not form a suspension, because the solver does not accept them. Reading a study refuses the same
/// points.
pub(super) fn check_geometry(study: &Study) -> Result<(), String> {
    let right = study.axle().and_then(|both| both.axle.right.as_ref());
    for (wheel, side) in [(Some(study.wheel()), ""), (right, "right wheel: ")] {
        if let Some(fault) = wheel.and_then(GeometryFault::first_of) {
            return Err(format!("{side}{fault}"));
        }
    }
    Ok(())
}

/// Converts coordinates from the page, in the axes `frame`, to a design in the internal frame (x forward, y left, z up).
pub(super) fn in_kernel(
    coordinates: &[[f64; 3]],
    suspension: &Suspension,
    frame: Frame,
) -> Result<Vec<Vector3<f64>>, String> {
    let wanted = suspension.design.len();
    if coordinates.len() != wanted {
        let found = coordinates.len();
        return Err(format!(
            "expected the coordinates of {wanted} points, found {found}"
        ));
    }
    for (point, place) in suspension.mechanism.points.iter().zip(coordinates) {
        for (axis, coordinate) in Axis::ALL.into_iter().zip(place) {
            // Coordinates must be within the bounds for numbers in study files.
            checked_number(*coordinate).map_err(|expected| {
                let (name, axis) = (&point.name, axis.name());
                format!("{name} {axis}: expected {expected}, found {coordinate:e}")
            })?;
        }
    }
    let inside = |c: &[f64; 3]| frame.vector(Vector3::from(*c));
    Ok(coordinates.iter().map(inside).collect())
}

/// Path of the study file with which the studio was opened. New studies are written to the same folder.
#[derive(Clone)]
pub(super) struct StudyFile {
    path: PathBuf,
}

impl StudyFile {
    /// Resolves a symbolic link now, so that later writes go to the same file.
    pub(super) fn at(path: &Path) -> io::Result<Self> {
        Ok(StudyFile {
            path: fs::canonicalize(path)?,
        })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// File name without folders.
    pub(super) fn name(&self) -> String {
        name_of(&self.path)
    }

    /// Reads the study file as it is now, or returns the reason in words why it cannot be read.
    pub(super) fn read(&self) -> Result<Opened, String> {
        // The file is read only once, so that the digest belongs to the text that was parsed.
        let text = self.text()?;
        Opened::of(&self.path, text).map_err(|errors| errors.render(false))
    }

    /// SHA-256 of the study file's text as it is now.
    pub(super) fn digest(&self) -> Result<String, String> {
        Ok(digest(&self.text()?))
    }

    fn text(&self) -> Result<String, String> {
        text_of(&self.path)
    }

    /// Returns the text that was read, with further changes of its values.
    pub(super) fn edited(&self, opened: &Opened, edits: &[ValueEdit]) -> Result<Opened, String> {
        let text = edited_text(&opened.text, edits)?;
        let edited = Opened::of(&self.path, text).map_err(|errors| errors.render(false))?;
        // If the edits cancel each other, no edit must go into a file that another program changes later.
        if edited.digest == opened.base {
            return Ok(edited);
        }
        Ok(Opened {
            base: opened.base.clone(),
            base_text: opened.base_text.clone(),
            edits: [&opened.edits, edits].concat(),
            ..edited
        })
    }

    /// Changes of the user: the text of the file as it was opened, and this text with a design and the edits. Changes that
    /// other programs have made in the file are not included.
    pub(super) fn texts(&self, opened: &Opened, design: &[Vector3<f64>]) -> Vec<TextChange> {
        vec![TextChange {
            file: self.name(),
            before: opened.base_text.to_string(),
            after: edited(&opened.study, &opened.text, design),
        }]
    }

    /// Writes a design into the study. If another program has changed the file since the page read it, the file stays
    /// unchanged. With `anyway`, only the values and coordinates that the user has changed are written into the changed file.
    /// Returns the study, and true if the text of the file has changed.
    pub(super) fn save(
        &self,
        opened: &Opened,
        design: &[Vector3<f64>],
        over: &Over,
    ) -> Result<(Opened, bool), NotSaved> {
        let text = self.text().map_err(NotSaved::Refused)?;
        let edited = if digest(&text) == over.known.unwrap_or(&opened.base) {
            edited(&opened.study, &opened.text, design)
        } else if over.anyway {
            let own = edited_text(&text, &opened.edits).map_err(NotSaved::Refused)?;
            let now = self.understood(&self.path, own)?;
            let wheels = [opened, &now].map(|text| text.study.wheel());
            let merged = moved_in(wheels, design).map_err(NotSaved::Refused)?;
            edited(&now.study, &now.text, &merged)
        } else {
            let message = format!("{} has changed since it was opened", self.name());
            return Err(NotSaved::Changed(message));
        };
        let edited = self.understood(&self.path, edited)?;
        let prepared = Prepared::replacing(&self.path, &text, &edited.text)?;
        prepared.check_unchanged()?;
        prepared.put()?;
        let is_changed = text != edited.text;
        Ok((edited, is_changed))
    }

    /// Writes the opened text with a design to another file in the same folder. An existing file of that name is only replaced
    /// with `anyway`.
    pub(super) fn save_as(
        &self,
        opened: &Opened,
        design: &[Vector3<f64>],
        name: &str,
        anyway: bool,
    ) -> Result<String, NotSaved> {
        let path = new_path(&self.path, name)?;
        // On some file systems, several spellings of a name denote the same file.
        if fs::canonicalize(&path).is_ok_and(|other| other == self.path) {
            return Err(NotSaved::Refused(
                "this is the name of the study itself".to_owned(),
            ));
        }
        let edited = edited(&opened.study, &opened.text, design);
        let edited = self.understood(&path, edited)?;
        write_new(&path, &edited.text, anyway)?;
        Ok(name.to_owned())
    }

    /// Parses a text before it is saved. A text that no command could read is not written.
    fn understood(&self, path: &Path, text: String) -> Result<Opened, NotSaved> {
        Opened::of(path, text).map_err(|errors| not_understood(&errors))
    }
}

/// Message that refuses to save a text which no command could read.
pub(super) fn not_understood(errors: &StudyErrors) -> NotSaved {
    NotSaved::Refused(format!(
        "a study with these points is invalid, and nothing is written:\n{}",
        errors.render(false)
    ))
}

/// Text of a file as it is now. The error is the reason in words, with the path.
pub(super) fn text_of(path: &Path) -> Result<String, String> {
    let text = read_regular_text(path, LONGEST_TEXT);
    text.map_err(|e| format!("{}: {e}", path.display()))
}

/// Name of a file, without its folder.
pub(super) fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// New text of a file, written to a temporary file in the same folder.
pub(super) struct Prepared<'a> {
    path: &'a Path,
    before: &'a str,
    text: &'a str,
    temporary: NamedTempFile,
}

impl<'a> Prepared<'a> {
    /// Writes the text `text` to a temporary file. `before` is the text that it will replace.
    pub(super) fn replacing(
        path: &'a Path,
        before: &'a str,
        text: &'a str,
    ) -> Result<Self, NotSaved> {
        let refused = |e: io::Error| refused(path, &e);
        let temporary = temporary_beside(path, text).map_err(refused)?;
        if let Ok(metadata) = fs::metadata(path) {
            let kept = temporary.as_file().set_permissions(metadata.permissions());
            kept.map_err(refused)?;
        }
        Ok(Prepared {
            path,
            before,
            text,
            temporary,
        })
    }

    /// Reads the file once more, right before it is replaced. Returns an error if its text is not `before`.
    pub(super) fn check_unchanged(&self) -> Result<(), NotSaved> {
        if text_of(self.path).map_err(NotSaved::Refused)? == self.before {
            return Ok(());
        }
        let name = name_of(self.path);
        let message = format!("{name} is being changed by another program");
        Err(NotSaved::Changed(message))
    }

    /// Replaces the file by the new text.
    pub(super) fn put(self) -> Result<(), NotSaved> {
        let written = undivided(|| replace(self.temporary, self.path, self.text));
        written.map_err(|e| refused(self.path, &e))
    }
}

fn refused(path: &Path, error: &io::Error) -> NotSaved {
    NotSaved::Refused(format!("{}: {error}", path.display()))
}

/// Path of a new file in the folder of a study.
pub(super) fn new_path(study: &Path, name: &str) -> Result<PathBuf, NotSaved> {
    check_name(name).map_err(NotSaved::Refused)?;
    Ok(study.with_file_name(name))
}

/// Writes a new file. An existing file of that name is only replaced with `anyway`.
pub(super) fn write_new(path: &Path, text: &str, anyway: bool) -> Result<(), NotSaved> {
    let name = name_of(path);
    let refused = |e: io::Error| refused(path, &e);
    let temporary = temporary_beside(path, text).map_err(refused)?;
    if anyway && path.is_dir() {
        return Err(NotSaved::Refused(format!("{name} is a directory")));
    }
    let written = undivided(|| {
        if anyway {
            replace(temporary, path, text)
        } else {
            let written = temporary.persist_noclobber(path);
            written.map(drop).map_err(|e| e.error)
        }
    });
    match written {
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
            Err(NotSaved::Changed(format!("there is a file {name}")))
        }
        written => written.map_err(refused),
    }
}

fn temporary_beside(path: &Path, text: &str) -> io::Result<NamedTempFile> {
    use io::Write;
    let directory = path.parent().unwrap_or(Path::new(""));
    let mut file = temporary_of(directory, "studio")?;
    file.write_all(text.as_bytes())?;
    file.as_file().sync_all()?;
    Ok(file)
}

/// Moves a complete file to its final path. If the target has several names (hard links), its content is replaced instead, so
/// that all names have the new text. If that fails halfway, the new text stays in the temporary file.
fn replace(temporary: NamedTempFile, path: &Path, text: &str) -> io::Result<()> {
    if !has_other_names(path) {
        return temporary.persist(path).map(drop).map_err(|e| e.error);
    }
    let written = || {
        let mut file = fs::OpenOptions::new()
            .write(true)
            .truncate(true)
            .open(path)?;
        io::Write::write_all(&mut file, text.as_bytes())?;
        file.sync_all()
    };
    written().map_err(|error| match temporary.keep() {
        Ok((_, kept)) => {
            let kept = kept.display();
            io::Error::new(error.kind(), format!("{error}; the new text is in {kept}"))
        }
        Err(_) => error,
    })
}

/// True if a file has further names (hard links) besides its path.
#[cfg(unix)]
fn has_other_names(path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    fs::symlink_metadata(path).is_ok_and(|there| there.is_file() && there.nlink() > 1)
}

/// Always false: on systems other than Unix, the standard library does not give the number of names of a file.
#[cfg(not(unix))]
fn has_other_names(_: &Path) -> bool {
    false
}

/// Returns the text of a study with the coordinates of another design. For an axle, the text contains both wheels.
pub(super) fn edited(study: &Study, text: &str, design: &[Vector3<f64>]) -> String {
    study.text_with_points_of(text, &study.at_design(design.to_vec()))
}

/// Returns the design of a changed text, with the user's changes: the coordinates of `design` that differ from the opened text.
/// `from` is the suspension in the opened text, and `to` the suspension in the changed text.
pub(super) fn moved_in(
    [from, to]: [&Suspension; 2],
    design: &[Vector3<f64>],
) -> Result<Vec<Vector3<f64>>, String> {
    if from.frame != to.frame || from.length_unit != to.length_unit {
        return Err("the file now has different axes or another unit: reload it".to_owned());
    }
    let mut merged = to.design.clone();
    for (number, point) in from.mechanism.points.iter().enumerate() {
        let (old, new) = (from.design[number], design[number]);
        if old == new {
            continue;
        }
        let Some(id) = to.mechanism.point(&point.name) else {
            return Err(format!("the file no longer has {}: reload it", point.name));
        };
        let (old, new) = (old.to_array(), new.to_array());
        let mut coordinates = merged[id.0].to_array();
        for axis in 0..3 {
            if old[axis] != new[axis] {
                coordinates[axis] = new[axis];
            }
        }
        merged[id.0] = coordinates.into();
    }
    Ok(merged)
}

/// Largest length of a name in bytes. A temporary file has a longer name.
const LONGEST_NAME: usize = 200;

/// Checks that a file name is valid on every operating system and contains no folder.
pub(super) fn check_name(name: &str) -> Result<(), String> {
    if name.contains(['/', '\\', ':']) {
        return Err(format!(
            "{name} names a folder or a drive; expected a name alone, as in mine.toml"
        ));
    }
    let length = name.len();
    if length > LONGEST_NAME {
        return Err(format!(
            "the name has {length} bytes; expected at most {LONGEST_NAME}"
        ));
    }
    let stem = name.strip_suffix(".toml").unwrap_or("");
    if stem.trim().is_empty() || stem.starts_with('.') || stem.ends_with([' ', '.']) {
        return Err("expected a name that ends in .toml, as in mine.toml".to_owned());
    }
    if name.contains(|c: char| c.is_control() || "*?\"<>|".contains(c)) {
        return Err("expected a name without the characters * ? \" < > |".to_owned());
    }
    if !is_printable(name) {
        return Err(
            "expected a name without characters that change the direction of writing".to_owned(),
        );
    }
    if is_reserved(name) {
        return Err(format!(
            "{name} names a device on Windows; expected another name"
        ));
    }
    Ok(())
}

/// True if Windows interprets a name as a device, whatever follows the first dot.
fn is_reserved(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or("").trim_end();
    let stem = stem.to_ascii_uppercase();
    let is_port = |prefix: &str| {
        let number = stem.strip_prefix(prefix);
        number.is_some_and(|n| {
            n.chars().count() == 1
                && n.contains(|c: char| "0123456789\u{b9}\u{b2}\u{b3}".contains(c))
        })
    };
    let devices = ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"];
    devices.contains(&stem.as_str()) || is_port("COM") || is_port("LPT")
}

/// SHA-256 of a text.
fn digest(text: &str) -> String {
    let bytes = hmac_sha256::Hash::hash(text.as_bytes());
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

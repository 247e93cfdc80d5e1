//! Reads the three files of a car, and writes them back with their comments.

use super::OpenedCar;
use crate::car::AXLE_NAMES;
use crate::number::Vector3;
use crate::report::car_with_axles;
use crate::results::digest_of_texts;
use crate::studio::message::TextChange;
use crate::studio::study_file::{
    NotSaved, Over, Prepared, edited, moved_in, name_of, new_path, not_understood, text_of,
    write_new,
};
use crate::study::{CarStudy, PathStep, ValueEdit, edited_text};
use std::fs;
use std::path::{Path, PathBuf};

/// Designs (hardpoint positions in the internal frame) of the front and of the rear axle.
type Designs = [Vec<Vector3<f64>>; 2];

/// Paths of the study of a car, and of the studies of its front and rear axle.
#[derive(Clone)]
pub(in crate::studio) struct CarFiles([PathBuf; 3]);

impl CarFiles {
    /// Files of a car. The files of the axles become known when the car's file is read.
    pub(in crate::studio) fn at(path: &Path) -> Self {
        CarFiles([path.to_owned(), PathBuf::new(), PathBuf::new()])
    }

    pub(in crate::studio) fn path(&self) -> &Path {
        &self.0[0]
    }

    pub(super) fn paths(&self) -> &[PathBuf; 3] {
        &self.0
    }

    /// Names of the three files (car, front axle, rear axle), without their folders.
    pub(super) fn names(&self) -> [String; 3] {
        self.0.each_ref().map(|path| name_of(path))
    }

    /// Name of the car's file, without the extension.
    pub(super) fn stem(&self) -> String {
        let stem = self.path().file_stem().unwrap_or_default();
        stem.to_string_lossy().into_owned()
    }

    /// Reads the three files as they are now, or returns the reason in words why they cannot be read.
    pub(in crate::studio) fn read(&self) -> Result<OpenedCar, String> {
        let study = CarStudy::read(self.path(), &[]).map_err(|errors| errors.render(false))?;
        let files = CarFiles::at(self.path()).with_axles(&study.inputs[1..])?;
        Ok(OpenedCar::of(files, study))
    }

    /// Adds the paths of the axle studies, with symbolic links resolved. Returns an error if a path does not exist.
    fn with_axles(mut self, axles: &[PathBuf]) -> Result<Self, String> {
        for (own, path) in self.0[1..].iter_mut().zip(axles) {
            let found = fs::canonicalize(path);
            *own = found.map_err(|e| format!("{}: {e}", path.display()))?;
        }
        Ok(self)
    }

    /// SHA-256 of the three files' texts as they are now.
    pub(in crate::studio) fn digest(&self) -> Result<String, String> {
        let text = text_of(self.path())?;
        let [front, rear] = self.axles_in(&text)?;
        let (front, rear) = (text_of(&front)?, text_of(&rear)?);
        Ok(digest_of_texts(&[&text, &front, &rear]))
    }

    /// Files of the axles that a text of the car names.
    fn axles_in(&self, text: &str) -> Result<[PathBuf; 2], String> {
        let document: toml::Table = text.parse().map_err(|e| format!("not TOML: {e}"))?;
        let directory = self.path().parent().unwrap_or(Path::new(""));
        Ok(AXLE_NAMES.map(|end| {
            let named = document.get("car").and_then(|car| car.get(end));
            directory.join(named.and_then(|name| name.as_str()).unwrap_or_default())
        }))
    }

    /// Texts of the three files as they are now: car, front axle, rear axle.
    fn texts(&self) -> Result<[String; 3], String> {
        let [car, front, rear] = &self.0;
        Ok([text_of(car)?, text_of(front)?, text_of(rear)?])
    }

    /// Changes of the user, file by file: the texts as they were opened, and these texts with the designs and edits. Changes
    /// that other programs have made in the files are not included.
    pub(super) fn changes(&self, opened: &OpenedCar, designs: &Designs) -> Vec<TextChange> {
        let after = with_designs(opened, designs);
        let before = opened.base_texts.as_ref().clone();
        let pairs = before.into_iter().zip(after);
        let change = |(file, (before, after))| TextChange {
            file,
            before,
            after,
        };
        self.names().into_iter().zip(pairs).map(change).collect()
    }

    /// Writes designs into the files. If another program has changed a file since the page read it, no file is written. With
    /// `anyway`, only the user's changes of values and coordinates are written into the present files. Returns the car, and the
    /// names of the files whose texts have changed.
    pub(super) fn save(
        &self,
        opened: &OpenedCar,
        designs: &Designs,
        over: &Over,
    ) -> Result<(OpenedCar, Vec<String>), NotSaved> {
        let missing = |why| NotSaved::Refused(format!("nothing is saved: {why}"));
        let before = self.texts().map_err(missing)?;
        let known = over.known.unwrap_or(&opened.base);
        let is_same = digest_of_texts(&before.each_ref().map(String::as_str)) == known;
        let after = match (is_same, over.anyway) {
            (true, _) => with_designs(opened, designs),
            (false, true) => self.merged(opened, designs, &before)?,
            (false, false) => {
                let changed = changed_files(self, &opened.base_texts, &before);
                let message = format!("{}: changed since it was opened", changed.join(", "));
                return Err(NotSaved::Changed(message));
            }
        };
        if self.0[1] == self.0[2] && after[1] != after[2] {
            let name = name_of(&self.0[1]);
            return Err(NotSaved::Refused(format!(
                "both axles of the car use the file {name}, but their changes differ: copy the \
                 file and give the copy in [car]"
            )));
        }
        let understood = self.understood(&after)?;
        let written = self.0.iter().zip(before.iter().zip(&after));
        let written = written.filter(|(_, (before, after))| before != after);
        let mut prepared = Vec::new();
        for (path, (before, after)) in written {
            prepared.push((path, Prepared::replacing(path, before, after)?));
        }
        for (_, own) in &prepared {
            own.check_unchanged()?;
        }
        let mut done: Vec<String> = Vec::new();
        for (path, own) in prepared {
            own.put().map_err(|why| half_written(why, &done))?;
            done.push(name_of(path));
        }
        Ok((understood, done))
    }

    /// Merges the user's edits and moved points into `now`, the present texts of files that another program has changed. Refuses
    /// a car that now names other files of its axles.
    fn merged(
        &self,
        opened: &OpenedCar,
        designs: &Designs,
        now: &[String; 3],
    ) -> Result<[String; 3], NotSaved> {
        let named = self.axles_in(&now[0]).map_err(NotSaved::Refused)?;
        let mut pairs = self.0[1..].iter().zip(&named);
        if pairs.any(|(own, path)| fs::canonicalize(path).ok().as_ref() != Some(own)) {
            return Err(NotSaved::Refused(format!(
                "nothing is saved: {} now names other files of its axles; reload the page",
                name_of(self.path())
            )));
        }
        let own = edited_texts(now, &opened.edits).map_err(NotSaved::Refused)?;
        let now = self.understood(&own)?;
        let axle = |end: usize| {
            let wheels = [&opened.study, &now.study].map(|study| study.axles[end].wheel());
            moved_in(wheels, &designs[end]).map_err(NotSaved::Refused)
        };
        Ok(with_designs(&now, &[axle(0)?, axle(1)?]))
    }

    /// Writes the opened texts with designs as three new files: `NAME.toml`, `NAME_front.toml` and `NAME_rear.toml`. Existing
    /// files are only replaced with `anyway`.
    pub(super) fn save_as(
        &self,
        opened: &OpenedCar,
        designs: &Designs,
        name: &str,
        anyway: bool,
    ) -> Result<String, NotSaved> {
        let stem = name.strip_suffix(".toml").unwrap_or(name);
        let names = [
            name.to_owned(),
            format!("{stem}_front.toml"),
            format!("{stem}_rear.toml"),
        ];
        let mut paths = Vec::new();
        for name in &names {
            let path = new_path(self.path(), name)?;
            if fs::canonicalize(&path).is_ok_and(|other| self.0.contains(&other)) {
                let message = format!("{name} is a file of the car itself");
                return Err(NotSaved::Refused(message));
            }
            paths.push(path);
        }
        let mut texts = with_designs(opened, designs);
        texts[0] = car_with_axles(&texts[0], &names[1], &names[2]);
        let folder = self.path().parent().unwrap_or(Path::new(""));
        for (text, axle) in texts[1..].iter_mut().zip(&opened.study.axles) {
            *text = axle.with_paths_in(std::mem::take(text), folder);
        }
        let files = CarFiles([0, 1, 2].map(|number| paths[number].clone()));
        files.understood(&texts)?;
        let there = paths.iter().filter(|path| path.exists());
        let there: Vec<String> = there.map(|path| name_of(path)).collect();
        if !anyway && !there.is_empty() {
            let message = format!("there is a file {}", there.join(", "));
            return Err(NotSaved::Changed(message));
        }
        let mut done: Vec<String> = Vec::new();
        // The car's file is written last, because it names the other files.
        for number in [1, 2, 0] {
            let written = write_new(&paths[number], &texts[number], anyway);
            written.map_err(|why| half_written(why, &done))?;
            done.push(names[number].clone());
        }
        Ok(names.join(", "))
    }

    /// Resolves texts before they are saved. Returns an error for texts that no command could read.
    fn understood(&self, texts: &[String; 3]) -> Result<OpenedCar, NotSaved> {
        OpenedCar::of_texts(self, texts).map_err(|errors| not_understood(&errors))
    }
}

/// Names of the files whose texts differ in `before` and `now`.
fn changed_files(files: &CarFiles, before: &[String; 3], now: &[String; 3]) -> Vec<String> {
    let pairs = files.names().into_iter().zip(before.iter().zip(now));
    let changed = pairs.filter(|(_, (before, now))| before != now);
    changed.map(|(name, _)| name).collect()
}

/// Adds to the error `why` the names of the files that were written before it occurred.
fn half_written(why: NotSaved, done: &[String]) -> NotSaved {
    match why {
        NotSaved::Refused(why) | NotSaved::Changed(why) if !done.is_empty() => {
            NotSaved::Refused(format!("{why}; already written: {}", done.join(", ")))
        }
        why => why,
    }
}

/// Texts of a car, its front axle and its rear axle, with the coordinates of `designs` in place of the old coordinates.
fn with_designs(opened: &OpenedCar, designs: &Designs) -> [String; 3] {
    let axle = |end: usize| {
        let study = &opened.study.axles[end];
        edited(study, &study.text, &designs[end])
    };
    [opened.study.text.clone(), axle(0), axle(1)]
}

/// Texts with changes of their values. A path that begins with `front` or `rear` refers to the study of that axle. Refuses
/// changes of the files that the car names, because the texts of other axles are not known.
pub(super) fn edited_texts(
    texts: &[String; 3],
    edits: &[ValueEdit],
) -> Result<[String; 3], String> {
    let mut texts = texts.clone();
    for edit in edits {
        let keys = edit.path.iter().take(2).map(|step| match step {
            PathStep::Key(key) => key.as_str(),
            PathStep::Place(_) => "",
        });
        let keys: Vec<&str> = keys.collect();
        if keys == ["car"] || AXLE_NAMES.iter().any(|end| keys == ["car", *end]) {
            let names = AXLE_NAMES.join(" and ");
            return Err(format!(
                "the page cannot change the files of the axles ({names} in [car]): edit the study file"
            ));
        }
        let end = match edit.path.first() {
            Some(PathStep::Key(key)) => AXLE_NAMES.iter().position(|end| end == key),
            _ => None,
        };
        let (number, path) = match end {
            Some(end) => (1 + end, edit.path[1..].to_vec()),
            None => (0, edit.path.clone()),
        };
        let value = edit.value.clone();
        texts[number] = edited_text(&texts[number], &[ValueEdit { path, value }])?;
    }
    Ok(texts)
}

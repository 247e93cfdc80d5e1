//! Resolves the file as written to a study.

use super::compliance::{BushingText, NamedBushing, NamedParts};
use super::constraints::check_studs;
use super::error::{Problems, Source, StudyError, StudyErrors};
use super::targets::FromFile;
use super::{
    AxleComplianceStudy, AxleStudy, ComplianceStudy, Formulation, Load, Motion, Optimise, Outputs,
    Setup, Study, Sweep, Tolerance, Vehicle, WheelStudy, axle, compliance, edit, file, motion,
    named_motions, optimise, outputs, overrides, parse, setup, solver, source, suspension, sweep,
    tolerance,
};
use crate::model::{Suspension, Topology};
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;

/// Parts of the study to which later sections of the file refer.
pub(super) struct Context<'a> {
    /// Suspension of the wheel, or of the left wheel.
    pub suspension: &'a Suspension,
    /// Motion, if it has no error.
    pub motion: Option<&'a Motion>,
    /// Further motions, by name.
    pub motions: &'a [(String, Motion)],
    /// Loads on the wheel. Empty for an axle.
    pub loads: &'a [Load],
    /// Both wheels, if the study describes an axle.
    pub axle: Option<&'a AxleStudy>,
    /// Elastic parts, if the study has them.
    pub elastic: Option<&'a ComplianceStudy>,
    /// File as written.
    pub file: &'a super::file::File,
    /// Directory of the study file.
    pub directory: &'a Path,
}

impl Context<'_> {
    /// Elastic parts of the axle, if the study describes an axle with elastic parts.
    pub(super) fn elastic_axle(&self) -> Option<&AxleComplianceStudy> {
        self.axle?.axle.elastic.as_deref()
    }

    /// Returns true if the study has elastic parts.
    pub(super) fn is_elastic(&self) -> bool {
        self.elastic.is_some() || self.elastic_axle().is_some()
    }
}

/// Reads each element with `read`. Reads all elements even if one has an error, so that every error is reported. `None` if any
/// element has an error.
pub(super) fn each<W, T>(
    written: impl IntoIterator<Item = W>,
    read: impl FnMut(W) -> Option<T>,
) -> Option<Vec<T>> {
    let read: Vec<_> = written.into_iter().map(read).collect();
    read.into_iter().collect()
}

/// Elements of a list that must not be empty. `what` names an element in messages.
pub(super) fn some<'w, T>(
    list: &'w Spanned<Vec<T>>,
    what: &str,
    problems: &mut Problems,
) -> Option<&'w [T]> {
    if list.get_ref().is_empty() {
        let message = format!("expected at least one {what}, found an empty list");
        return problems.refuse(list.span(), message);
    }
    Some(list.get_ref())
}

impl Study {
    /// Reads a study file, or standard input for `-`. `overrides` are edits `path=value` (as in `optimise.starts=4`), applied to
    /// the text before it is read.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Study, StudyErrors> {
        Study::read_parts(path, overrides, Parts::Rigid)
    }

    /// Reads a study file like [`Study::read`], but accepts elastic parts. Then [`WheelStudy::compliance`] or
    /// [`crate::axle::Axle::elastic`] holds these parts.
    pub fn read_elastic(path: &Path, overrides: &[String]) -> Result<Study, StudyErrors> {
        Study::read_parts(path, overrides, Parts::Elastic)
    }

    fn read_parts(path: &Path, overrides: &[String], parts: Parts) -> Result<Study, StudyErrors> {
        let is_input = path == Path::new("-");
        let path = if is_input { Path::new("stdin") } else { path };
        let name = path.display().to_string();
        let text = if is_input {
            source::read_input(source::LONGEST_TEXT)
        } else {
            source::read_text(path, source::LONGEST_TEXT)
        };
        let text = text.map_err(|reason| StudyError::unread(path, &reason))?;
        let directory = path.parent().unwrap_or(Path::new(""));
        if overrides.is_empty() {
            return resolve(Path::new(&name), name.clone(), text, directory, parts);
        }
        let text = overrides::apply(&name, &text, overrides)?;
        resolve(path, format!("{name} (with --set)"), text, directory, parts)
    }

    /// Returns the study with edits `path=value`, as `--set` makes them. `name` is the file name in messages. Files that the
    /// study names are in the same directory as before.
    pub fn with_overrides(&self, name: &str, overrides: &[String]) -> Result<Study, StudyErrors> {
        let text = overrides::apply(name, &self.text, overrides)?;
        let parts = if self.is_elastic() {
            Parts::Elastic
        } else {
            Parts::Rigid
        };
        resolve(
            Path::new(name),
            name.to_owned(),
            text,
            &self.directory,
            parts,
        )
    }

    /// Reads another text of this study, which may have elastic parts. `name` is the file name in messages. Files that the
    /// text names are in the directory of this study.
    pub fn read_again(&self, name: &str, text: &str) -> Result<Study, StudyErrors> {
        Study::elastic_from_text(name, text, &self.directory)
    }

    /// Reads a study from its text. `name` is the file name in messages. `directory` is the directory of the files that the
    /// study names.
    pub fn from_text(name: &str, text: &str, directory: &Path) -> Result<Study, StudyErrors> {
        let (path, shown) = (Path::new(name), name.to_owned());
        resolve(path, shown, text.to_owned(), directory, Parts::Rigid)
    }

    /// Reads a study from its text like [`Study::from_text`], but accepts elastic parts.
    pub fn elastic_from_text(
        name: &str,
        text: &str,
        directory: &Path,
    ) -> Result<Study, StudyErrors> {
        let (path, shown) = (Path::new(name), name.to_owned());
        resolve(path, shown, text.to_owned(), directory, Parts::Elastic)
    }
}

/// Refuses sensitivities of one wheel if they do not fit in memory.
fn check_sensitivities(
    file: &file::File,
    motion: Option<&Motion>,
    motions: &[(String, Motion)],
    outputs: Option<&Outputs>,
    problems: &mut Problems,
) {
    let points = outputs.map_or(0, |outputs| outputs.sensitivities.len());
    let mut check = |place, motion: &Motion| {
        let stations = motion.values.len() * motion.rack.len();
        motion::check_sensitivities(place, stations, points, problems);
    };
    if let Some(motion) = motion {
        check(file.motion.span(), motion);
    }
    for (name, section) in &file.motions {
        let same = motions.iter().find(|(named, _)| named == name.get_ref());
        if let Some((_, motion)) = same {
            check(section.span(), motion);
        }
    }
}

/// Kinds of parts that the caller supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Parts {
    /// Rigid parts only. Elastic parts are refused, so that no result silently ignores them.
    Rigid,
    /// Rigid and elastic parts.
    Elastic,
}

/// Resolves a file. `shown` is the name of the file in messages.
fn resolve(
    path: &Path,
    shown: String,
    text: String,
    directory: &Path,
    parts: Parts,
) -> Result<Study, StudyErrors> {
    let source = Arc::new(Source { name: shown, text });
    refuse_car(&source)?;
    let file = parse::parse(&source)?;
    let mut problems = Problems::new(source.clone());
    let suspension = suspension::suspension(&file, &mut problems);
    // Without a suspension, names of points and members cannot be checked. So only the motions are read, for their errors.
    let Some(suspension) = suspension else {
        let of_axle = is_of_axle(&file);
        if !of_axle {
            motion::motion(&file.motion, false, &mut problems);
        }
        named_motions::of_wheel(&file, of_axle, &mut problems);
        return problems.finish(None);
    };
    check_studs(&file, &suspension, &mut problems);
    let main = MainSections::read(&file, &suspension, (parts, directory), &mut problems);
    let context = main.context(&file, &suspension, directory);
    let tasks = Tasks::read(&context, main.is_known(), main.formulation, &mut problems);
    let bushings = bushings_of_files(
        &file,
        NamedParts::of(&suspension, context.elastic, context.elastic_axle()),
    );
    let study = || {
        let tasks = tasks?;
        let text = edit::with_curves_inside(&source.text, &tasks.curves);
        let name = path.file_stem().unwrap_or_default();
        let inputs = named_files(&file).map(|name| directory.join(name));
        let motions = main.motions.clone();
        Some(Study {
            name: name.to_string_lossy().into_owned(),
            directory: directory.to_owned(),
            text: edit::with_bushings_inside(text, &bushings),
            inputs: inputs.collect(),
            vehicle: main.vehicle(suspension)?,
            motions,
            optimise: tasks.optimise,
            sweep: tasks.sweep,
            setup: tasks.setup,
            tolerance: tasks.tolerance,
        })
    };
    problems.finish(study())
}

/// Returns true for the study of an axle. The study of a solid axle describes an axle even without `[axle]`.
fn is_of_axle(file: &file::File) -> bool {
    let topology = Topology::named(file.suspension.topology.get_ref());
    file.axle.is_some() || topology.is_some_and(Topology::carries_both_wheels)
}

/// Sections that describe the vehicle and its curves. A section with an error is `None`.
struct MainSections {
    motion: Option<Motion>,
    motions: Vec<(String, Motion)>,
    /// Axle. `Some(None)` for a study of one wheel.
    axle: Option<Option<AxleStudy>>,
    /// Elastic parts of one wheel. `Some(None)` if the study has no such parts. Elastic parts of an axle are in `axle`.
    elastic: Option<Option<ComplianceStudy>>,
    formulation: Option<Formulation>,
    outputs: Option<Outputs>,
}

impl MainSections {
    fn read(
        file: &file::File,
        suspension: &Suspension,
        (parts, directory): (Parts, &Path),
        problems: &mut Problems,
    ) -> Self {
        let of_axle = is_of_axle(file);
        let motion = if of_axle {
            Some(Motion::still())
        } else {
            motion::motion(&file.motion, false, problems)
        };
        let motions = named_motions::of_wheel(file, of_axle, problems);
        let axle = if of_axle {
            axle::axle(file, suspension, (parts, directory), problems).map(Some)
        } else {
            axle::refuse_without_axle(file, problems);
            Some(None)
        };
        let elastic = match &axle {
            Some(None) => compliance::compliance(file, suspension, parts, directory, problems),
            Some(Some(_)) | None => Some(None),
        };
        if let Some(motion) = &motion {
            motion::check_drive(&file.motion, motion, suspension, problems);
        }
        named_motions::check(file, &motions, suspension, problems);
        let formulation = solver::formulation(file, suspension, problems);
        solver::refuse_accuracy(file, problems);
        let outputs = match (of_axle, &elastic) {
            (true, _) => Some(Outputs::of(Vec::new())),
            // Errors in the elastic parts are already reported.
            (false, None) => None,
            (false, Some(elastic)) => {
                outputs::outputs(file, suspension, elastic.as_ref(), problems)
            }
        };
        let read = MainSections {
            motion,
            motions,
            axle,
            elastic,
            formulation,
            outputs,
        };
        read.check(file, problems);
        read
    }

    /// Checks that the sections are consistent with each other.
    fn check(&self, file: &file::File, problems: &mut Problems) {
        let (motion, outputs) = (self.motion.as_ref(), self.outputs.as_ref());
        if let (Some(formulation), Some(outputs)) = (self.formulation, outputs) {
            solver::check_outputs(file, formulation, motion, outputs, problems);
        }
        check_sensitivities(file, motion, &self.motions, outputs, problems);
        match &self.axle {
            Some(Some(both)) => {
                let plan = &both.plan;
                let (stations, points) = (plan.motion.stations(), plan.sensitivities.len());
                motion::check_sensitivities(file.motion.span(), stations, points, problems);
            }
            Some(None) => {
                if let Some(outputs) = outputs {
                    check_sweep_keeps_something(file, outputs, problems);
                }
            }
            None => {}
        }
    }

    /// Parts of the study to which later sections refer.
    fn context<'a>(
        &'a self,
        file: &'a file::File,
        suspension: &'a Suspension,
        directory: &'a Path,
    ) -> Context<'a> {
        Context {
            elastic: self.elastic.as_ref().and_then(Option::as_ref),
            suspension,
            motion: self.motion.as_ref(),
            motions: &self.motions,
            loads: self.outputs.as_ref().map_or(&[], |outputs| &outputs.loads),
            axle: self.axle.as_ref().and_then(Option::as_ref),
            file,
            directory,
        }
    }

    /// Returns false for an axle with an error. Then errors in sections about the axle would only be consequences of this
    /// error.
    fn is_known(&self) -> bool {
        self.axle.is_some()
    }

    /// Vehicle of the study. `None` if it has an error.
    fn vehicle(self, suspension: Suspension) -> Option<Vehicle> {
        Some(match self.axle? {
            Some(both) => Vehicle::Axle(Box::new(both)),
            None => Vehicle::Wheel(Box::new(WheelStudy {
                suspension,
                motion: self.motion?,
                formulation: self.formulation?,
                outputs: self.outputs?,
                compliance: self.elastic?,
            })),
        })
    }
}

/// Refuses the study of a car, because a separate function reads it.
fn refuse_car(source: &Arc<Source>) -> Result<(), StudyErrors> {
    let Some(place) = parse::car_section(&source.text) else {
        return Ok(());
    };
    let message = "[car] makes this the study of a car, which this command does not accept";
    let mut error = StudyError::new(source.clone(), Some(place), message);
    error.help(
        "hardpoint check, solve, sweep, optimise, tolerance, limits, compare, convert, export, report, \
         studio and bench cars accept cars; every command accepts the study of a single axle",
    );
    Err(error.into())
}

/// Refuses a sweep that would store no values of any design.
fn check_sweep_keeps_something(file: &file::File, outputs: &Outputs, problems: &mut Problems) {
    let Some(section) = &file.sweep else {
        return;
    };
    let has_targets = file.optimise.is_some();
    let has_figures = !outputs.figures.is_empty();
    let has_curves = !outputs.characteristics.is_empty() || !outputs.points.is_empty();
    if !has_curves && !has_figures && !has_targets {
        let message = "there is nothing to write for each design: expected characteristics or \
                       points in [outputs], or targets in [optimise]";
        problems.add(section.span(), message);
    }
}

/// Sections of a study for tasks other than curves.
struct Tasks {
    optimise: Option<Optimise>,
    /// Contents of target files, which become part of the study's text.
    curves: Vec<(usize, FromFile)>,
    sweep: Option<Sweep>,
    setup: Option<Setup>,
    tolerance: Option<Tolerance>,
}

impl Tasks {
    /// Reads the sections, each after the sections to which it refers. `is_known` is false if the axle could not be read.
    /// `None` if a section has an error.
    fn read(
        context: &Context<'_>,
        is_known: bool,
        formulation: Option<Formulation>,
        problems: &mut Problems,
    ) -> Option<Tasks> {
        let file = context.file;
        let optimise = match &file.optimise {
            None => Some((None, Vec::new())),
            Some(_) if !is_known => None,
            Some(section) => optimise::optimise(section, context, problems)
                .map(|(optimise, curves)| (Some(optimise), curves)),
        };
        let sweep = match &file.sweep {
            None => Some(None),
            Some(_) if !is_known => None,
            Some(section) => sweep::sweep(file, section, formulation, context, problems).map(Some),
        };
        let setup = match &file.setup {
            None => Some(None),
            Some(_) if !is_known => None,
            Some(section) => setup::setup(section, context, problems).map(Some),
        };
        let adjusted = setup.as_ref().and_then(Option::as_ref);
        let tolerance = match &file.tolerance {
            None => Some(None),
            Some(_) if !is_known => None,
            Some(section) => tolerance::tolerance(section, context, problems).map(Some),
        };
        let scatter = match &file.optimise {
            None => Some(None),
            Some(section) => {
                let tolerance = tolerance.as_ref().and_then(Option::as_ref);
                optimise::scatter(section, tolerance, adjusted, context, problems)
            }
        };
        let (optimise, curves) = optimise?;
        let scatter = scatter?;
        Some(Tasks {
            optimise: optimise.map(|optimise| Optimise {
                scatter,
                ..optimise
            }),
            curves,
            sweep: sweep?,
            setup: setup?,
            tolerance: tolerance?,
        })
    }
}

/// Force laws of bushings that come from separate files. These laws become part of the study's text.
fn bushings_of_files(file: &file::File, parts: Option<NamedParts<'_>>) -> Vec<BushingText> {
    let bushings = parts.into_iter().flat_map(|own| own.bushings);
    let is_of_file = |part: &NamedBushing<'_>| {
        let mut written = file.bushings.iter();
        let own = written.find(|(known, _)| known.get_ref() == part.name);
        own.is_some_and(|(_, own)| own.get_ref().file.is_some())
    };
    let bushings = bushings.filter(is_of_file);
    bushings
        .map(|part| BushingText::of(part.name, part.shapes))
        .collect()
}

/// Files that a study names.
fn named_files(file: &file::File) -> impl Iterator<Item = &str> {
    let targets = file.optimise.iter().flat_map(|o| o.targets.get_ref());
    let curves = targets.filter_map(|target| target.get_ref().file.as_ref());
    let designs = file
        .sweep
        .iter()
        .filter_map(|s| s.get_ref().designs.as_ref());
    let bushings = file.bushings.values();
    let bushings = bushings.filter_map(|bushing| bushing.get_ref().file.as_ref());
    curves
        .chain(designs)
        .chain(bushings)
        .map(|name| name.get_ref().as_str())
}

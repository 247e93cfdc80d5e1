//! Studies of a car: `[car]` with two studies of axles, load cases, and outputs.

mod asked;
mod body;
mod cases;
mod rig;
mod tuned;
mod tuning;
mod variables;

pub use tuned::TunedCar;

use super::error::Problems;
use super::names::{choose, choose_or};
use super::suspension::{above_zero, mass_unit, positive, three};
use super::{
    FileFormat, Law, Sampled, Study, StudyError, StudyErrors, Tolerance, overrides, parse, source,
};
use crate::ask::Need;
use crate::axle::Axle;
use crate::car::{
    AXLE_NAMES, Air, AirForce, Car, CarConstraint, CarGoals, CarQuantity, CarRun, CarTarget,
    CarVariable, Case, LateralShares, Longitudinal, LongitudinalShares, Masses, Moves, RigGoals,
    Tyre, TyreAxes,
};
use crate::model::{Axis, AxlePosition, Frame, LengthUnit, MassUnit};
use crate::number::Vector3;
use hardpoint_study_file::car_file::{self, CarFile};
use hardpoint_study_file::error::Source;
use hardpoint_study_file::file::Coordinates;
use hardpoint_study_file::value::{Number, Text};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A resolved and validated study of a car.
#[derive(Clone, Debug)]
pub struct CarStudy {
    /// Name of the study, derived from the name of its file.
    pub name: String,
    /// Text of the study, with the changes of `--set`.
    pub text: String,
    /// Studies of the axles, [front, rear].
    pub axles: [Study; 2],
    /// Files of the car and of both axles. Files that the axles' studies name are not included. Empty for a study from texts.
    pub inputs: Vec<PathBuf>,
    /// Masses, tyres, aerodynamics and both axles of the car.
    pub car: Car,
    /// Wheelbase, if the study gives it instead of the rear axle's offset.
    pub wheelbase: Option<f64>,
    /// Load cases. The first one is the car at rest.
    pub cases: Vec<Case>,
    /// Results of the load cases that the study requests.
    pub quantities: Vec<CarQuantity>,
    /// True if the study requests derivatives with respect to parameters and hardpoints.
    pub sensitivities: bool,
    /// True if the study requests forces in members.
    pub member_loads: bool,
    /// Map of steady states over the longitudinal acceleration ax and the lateral acceleration ay.
    pub gg_map: Option<GgMap>,
    /// Sweep over designs of the car, if the study has one.
    pub sweep: Option<CarSweep>,
    /// Tuning of the car, if the study has one.
    pub optimise: Option<CarOptimise>,
    /// Tolerances of parts, rates and masses, if the study has them.
    pub tolerance: Option<CarTolerance>,
}

/// Map of steady states over the longitudinal acceleration ax and the lateral acceleration ay.
#[derive(Clone, Debug)]
pub struct GgMap {
    /// Longitudinal accelerations, positive forward.
    pub ax: Vec<f64>,
    /// Lateral accelerations, positive to the left.
    pub ay: Vec<f64>,
    /// Load case that gives all inputs except ax and ay.
    pub case: Case,
}

impl GgMap {
    /// Load case with the longitudinal acceleration `ax` (forward) and the lateral acceleration `ay` (to the left). The
    /// brakes cause a deceleration.
    pub fn at(&self, ax: f64, ay: f64) -> Case {
        let mut case = self.case.clone();
        (case.ax, case.ay) = (ax, ay);
        if ax < 0.0 {
            case.setting.longitudinal = Longitudinal::Brake;
        }
        case
    }
}

/// Tuning of a car.
#[derive(Clone, Debug)]
pub struct CarOptimise {
    /// Largest number of iterations, number of starts and seed.
    pub run: CarRun,
    /// Design variables.
    pub variables: Vec<CarVariable>,
    /// Targets for results in load cases.
    pub targets: Vec<CarTarget>,
    /// Constraints on results in load cases.
    pub constraints: Vec<CarConstraint>,
    /// Targets and constraints of each axle alone, [front, rear].
    pub rigs: [Option<RigGoals>; 2],
    /// True if the results report changes in quantities without a target.
    pub side_effects: bool,
}

/// Sweep of a car.
#[derive(Clone, Debug, PartialEq)]
pub struct CarSweep {
    /// Sampling of the variables' values.
    pub sampled: Sampled,
    /// Part of the car that each variable moves.
    pub variables: Vec<CarVariable>,
    /// File format of the results.
    pub format: FileFormat,
    /// True if results contain the margins of the constraints of `[optimise]`.
    pub constraints: bool,
}

/// Tolerances of a car's parts, rates and masses, and the limits that the results of built cars must satisfy.
#[derive(Clone, Debug, PartialEq)]
pub struct CarTolerance {
    /// Number of builds (cars with random deviations within the tolerances).
    pub builds: u64,
    /// Seed, as the study gives it.
    pub seed: u32,
    /// Seed for the random numbers of the values of the car, such as masses.
    pub figure_seed: u32,
    /// Tolerances of the axles' parts, [front, rear].
    pub axles: [Tolerance; 2],
    /// All tolerance sources, in the order of the study.
    pub contributors: Vec<CarContributor>,
    /// Limits that the results of built cars must satisfy.
    pub bands: Vec<CarBand>,
}

/// Tolerance source of a car.
#[derive(Clone, Debug, PartialEq)]
pub enum CarContributor {
    /// Scattering part of an axle.
    Part {
        /// Name of the tolerance source.
        name: String,
        /// Axle: 0 front, 1 rear.
        axle: usize,
        /// Index of the part in the list `scatter` of the axle's tolerances.
        number: usize,
    },
    /// A rate of an axle, or a value of the car such as a mass.
    Figure {
        /// Name of the tolerance source.
        name: String,
        /// Rate of an axle, or value of the car, that scatters.
        moves: Moves,
        /// Distribution of the deviation of the rate or value.
        law: Law,
    },
}

impl CarContributor {
    /// Name of the tolerance source.
    pub fn name(&self) -> &str {
        match self {
            CarContributor::Part { name, .. } | CarContributor::Figure { name, .. } => name,
        }
    }
}

/// Limits of a result in a case, in the unit of printed results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarBand {
    /// Result with limits.
    pub quantity: CarQuantity,
    /// Index of the load case in which the limits apply.
    pub case: usize,
    /// Lower and upper limit of the result.
    pub between: [f64; 2],
}

/// Names and indices of the axles.
const ENDS: [(&str, usize); 2] = [("front", 0), ("rear", 1)];

/// Names that a case may not have.
const RESERVED: [&str; 5] = ["front", "rear", "left", "right", "static"];

/// Largest number of steady states in a map over ax and ay.
const MOST_STATES: usize = 100_000;

impl CarStudy {
    /// Study texts of the car, of its front axle and of its rear axle.
    pub fn texts(&self) -> [&str; 3] {
        let [front, rear] = &self.axles;
        [&self.text, &front.text, &rear.text]
    }

    /// Returns true if the file is a study of a car.
    pub fn is_at(path: &Path) -> bool {
        path != Path::new("-")
            && source::read_text(path, source::LONGEST_TEXT)
                .is_ok_and(|text| parse::car_section(&text).is_some())
    }

    /// Reads the study of a car, with the changes of `--set`. Changes that begin with `front.` or `rear.` apply to the
    /// studies of the axles.
    pub fn read(path: &Path, changes: &[String]) -> Result<CarStudy, StudyErrors> {
        let shown = path.display().to_string();
        let text = source::read_text(path, source::LONGEST_TEXT)
            .map_err(|reason| StudyError::unread(path, &reason))?;
        let of_axle = |end: &str| -> Vec<String> {
            let own = changes.iter().filter_map(|change| change.strip_prefix(end));
            own.map(str::to_owned).collect()
        };
        let of_axles = [of_axle("front."), of_axle("rear.")];
        let own: Vec<String> = changes
            .iter()
            .filter(|change| !change.starts_with("front.") && !change.starts_with("rear."))
            .cloned()
            .collect();
        let text = if own.is_empty() {
            text
        } else {
            overrides::apply(&shown, &text, &own)?
        };
        let source = Arc::new(Source { name: shown, text });
        let file = parse::parse_car(&source)?;
        let directory = path.parent().unwrap_or(Path::new(""));
        let written = [&file.car.get_ref().front, &file.car.get_ref().rear];
        let paths = written.map(|written| directory.join(written.get_ref()));
        for ((written, path), end) in written.into_iter().zip(&paths).zip(AXLE_NAMES) {
            let message = match source::read_text(path, source::LONGEST_TEXT) {
                Err(reason) => Some(format!("{} cannot be read: {reason}", path.display())),
                Ok(text) if parse::car_section(&text).is_some() => {
                    Some("expected the study of an axle, found the study of a car".to_owned())
                }
                Ok(_) => None,
            };
            if let Some(message) = message {
                let mut error = StudyError::new(source, Some(written.span()), message);
                error.key_named(Some(format!("car.{end}")));
                if let Some(help) = source::absent_study(path) {
                    error.help(help);
                }
                return Err(error.into());
            }
        }
        let [front, rear] = [0, 1].map(|end| Study::read(&paths[end], &of_axles[end]));
        let axles = [front?, rear?];
        let stem = path
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned());
        let [front, rear] = paths;
        let inputs = vec![path.to_owned(), front, rear];
        CarStudy::of_file(&source, &file, axles, stem.unwrap_or_default(), inputs)
    }

    /// Makes the study of a car from its text and the studies of both axles. It does not open the files that the text names.
    pub fn of_axles(name: &str, text: &str, axles: [Study; 2]) -> Result<CarStudy, StudyErrors> {
        let source = Arc::new(Source {
            name: format!("{name}.toml"),
            text: text.to_owned(),
        });
        let file = parse::parse_car(&source)?;
        CarStudy::of_file(&source, &file, axles, name.to_owned(), Vec::new())
    }

    fn of_file(
        source: &Arc<Source>,
        file: &CarFile,
        axles: [Study; 2],
        name: String,
        inputs: Vec<PathBuf>,
    ) -> Result<CarStudy, StudyErrors> {
        let mut problems = Problems::new(source.clone());
        let found = Resolver {
            file,
            axles: &axles,
            problems: &mut problems,
        }
        .resolve();
        let study = found.map(|found| CarStudy {
            name,
            text: source.text.clone(),
            inputs,
            axles: axles.clone(),
            car: found.car,
            wheelbase: file.car.get_ref().wheelbase.as_ref().map(|own| own.value),
            cases: found.cases,
            quantities: found.quantities,
            member_loads: file
                .outputs
                .member_loads
                .as_ref()
                .is_some_and(|loads| *loads.get_ref()),
            sensitivities: file
                .outputs
                .sensitivities
                .as_ref()
                .is_some_and(|s| *s.get_ref()),
            gg_map: found.gg_map,
            sweep: found.sweep,
            optimise: found.optimise,
            tolerance: found.tolerance,
        });
        problems.finish(study)
    }

    /// Results that sweeps and tolerance runs store for each design: the results that the study names, or a short default list
    /// ([`CarQuantity::key_columns`]).
    pub fn kept_quantities(&self) -> Vec<CarQuantity> {
        if self.quantities == CarQuantity::default_columns(&self.car) {
            CarQuantity::key_columns(&self.car)
        } else {
            self.quantities.clone()
        }
    }

    /// Load cases, variables, targets and constraints of a tuning, with the goals of each single axle.
    pub fn goals<'s>(&'s self, optimise: &'s CarOptimise) -> CarGoals<'s> {
        let rig = |end: usize| {
            let goals = optimise.rigs[end].as_ref()?;
            Some((&self.axles[end].vehicle, goals))
        };
        CarGoals {
            cases: &self.cases,
            variables: &optimise.variables,
            targets: &optimise.targets,
            constraints: &optimise.constraints,
            rigs: [rig(0), rig(1)],
        }
    }

    /// Axes of the front study. The study of the car gives points in these axes.
    pub fn frame(&self) -> Frame {
        self.axles[0].wheel().frame
    }
}

/// Resolved sections of a study.
struct Resolved {
    car: Car,
    cases: Vec<Case>,
    quantities: Vec<CarQuantity>,
    gg_map: Option<GgMap>,
    sweep: Option<CarSweep>,
    optimise: Option<CarOptimise>,
    tolerance: Option<CarTolerance>,
}

struct Resolver<'a> {
    file: &'a CarFile,
    axles: &'a [Study; 2],
    problems: &'a mut Problems,
}

impl Resolver<'_> {
    fn resolve(mut self) -> Option<Resolved> {
        let car = self.car()?;
        let cases = self.cases(&car);
        let quantities = self.quantities(&car);
        let gg_map = self.gg_map(&car);
        let cases = cases?;
        let sweep = self.sweep(&car);
        let optimise = self.optimise(&car, &cases);
        let tolerance = self.tolerance(&car, &cases);
        Some(Resolved {
            cases,
            quantities: quantities?,
            gg_map: gg_map?,
            sweep: sweep?,
            optimise: optimise?,
            tolerance: tolerance?,
            car,
        })
    }

    fn frame(&self) -> Frame {
        self.axles[0].wheel().frame
    }

    fn point(&mut self, written: &Coordinates) -> Option<Vector3<f64>> {
        let point = three(written, "coordinates [x, y, z]", self.problems)?;
        Some(self.frame().vector(point))
    }

    fn maybe_point(&mut self, written: &Option<Coordinates>) -> Option<Option<Vector3<f64>>> {
        match written {
            Some(written) => self.point(written).map(Some),
            None => Some(None),
        }
    }
}

/// Applies edits `path=value` to a text, like `--set`. Returns the unchanged text if an edit cannot be applied.
pub fn edited(text: &str, edits: &[String]) -> String {
    overrides::apply("study", text, edits).unwrap_or_else(|_| text.to_owned())
}

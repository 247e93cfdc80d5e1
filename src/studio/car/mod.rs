//! A car: its two axles in a load case, a table of all cases, and the results of the whole car.
//!
//! For the page, a car is like any other study. The stations are the load cases. The points are the hardpoints of the left
//! wheels of both axles, in the axes of the front study.

mod answer;
mod directions;
mod files;
mod misfit;
mod overview;
mod tuning;

pub(super) use files::CarFiles;

use super::job::Tuning;
use super::message::{
    Coordinates, Designed, DirectionsAnswer, InfluenceAnswer, InfluenceRequest, LimitsAnswer,
    Overview, SidePlacement, SolveRequest, SolvedAnswer, TextChange, TuneRequest,
};
use super::page_design::page_design;
use super::reading::{Reading, Written};
use super::study_file::{NotSaved, Over, check_geometry, in_kernel};
use super::turns::Stop;
use crate::car::{AXLE_NAMES, CarSolver};
use crate::exchange::{car_point_pages, car_points_csv};
use crate::number::Vector3;
use crate::report::{CarResults, car_limits, car_page_of_design, lift_limits_table};
use crate::results::digest_of_texts;
use crate::study::{CarStudy, Study, StudyErrors, ValueEdit, Variable};
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Columns that the page shows in the table of lift limits (accelerations at which a wheel lifts off).
const LIFT_COLUMNS: [&str; 6] = [
    "case",
    "direction deg",
    "lift g",
    "wheel",
    "end g",
    "reason",
];

/// Texts of a car and of its axles that were read, with the resolved study.
pub(in crate::studio) struct OpenedCar {
    files: CarFiles,
    digest: String,
    /// SHA-256 of `base_texts`.
    base: String,
    /// Texts of the files as they were read, without `edits`.
    base_texts: Arc<[String; 3]>,
    /// Changes of values that are not yet saved in the files.
    edits: Vec<ValueEdit>,
    study: CarStudy,
    /// Variables for gradients: one for every hardpoint coordinate of the front axle, then of the rear axle.
    every: [Vec<Variable>; 2],
    /// Drawing of the left side with the design of the texts in each load case, computed when the page first needs it. `None`
    /// without an equilibrium.
    drawn: Vec<OnceLock<Option<SidePlacement>>>,
}

impl OpenedCar {
    fn of(files: CarFiles, study: CarStudy) -> Self {
        let digest = digest_of_texts(&study.texts());
        OpenedCar {
            files,
            base: digest.clone(),
            base_texts: study.texts().map(str::to_owned).into(),
            digest,
            edits: Vec::new(),
            every: [0, 1]
                .map(|end| Variable::every_coordinate(study.axles[end].wheel(), [-1.0, 1.0])),
            drawn: study.cases.iter().map(|_| OnceLock::new()).collect(),
            study,
        }
    }

    /// Resolves the texts of the car, of its front and of its rear axle.
    fn of_texts(files: &CarFiles, texts: &[String; 3]) -> Result<Self, StudyErrors> {
        let paths = files.paths();
        let axle = |end: usize| {
            let path = &paths[1 + end];
            let directory = path.parent().unwrap_or(Path::new(""));
            Study::from_text(&path.display().to_string(), &texts[1 + end], directory)
        };
        let axles = [axle(0)?, axle(1)?];
        let study = CarStudy::of_axles(&files.stem(), &texts[0], axles)?;
        Ok(OpenedCar::of(files.clone(), study))
    }

    /// Texts of the car, of its front and of its rear axle.
    fn texts(&self) -> [String; 3] {
        self.study.texts().map(str::to_owned)
    }

    /// Coordinates of the points of the front axle, and of the rear axle.
    fn of_axles<'c>(&self, coordinates: &'c [[f64; 3]]) -> [&'c [[f64; 3]]; 2] {
        let front = self.study.axles[0].wheel().design.len();
        let (front, rear) = coordinates.split_at(front.min(coordinates.len()));
        [front, rear]
    }

    /// Designs of both axles from the page, in the internal frame (x forward, y left, z up).
    fn designs(&self, coordinates: &Coordinates) -> Result<[Vec<Vector3<f64>>; 2], String> {
        let frame = self.study.frame();
        let own = self.of_axles(coordinates);
        let design = |end: usize| in_kernel(own[end], self.study.axles[end].wheel(), frame);
        Ok([design(0)?, design(1)?])
    }

    /// Study of the car with the hardpoint coordinates of the page. Returns an error if the points do not form a suspension.
    fn moved(&self, coordinates: &Coordinates) -> Result<CarStudy, String> {
        let study = self.study.at_design(self.designs(coordinates)?);
        for (end, axle) in AXLE_NAMES.iter().zip(&study.axles) {
            check_geometry(axle).map_err(|fault| format!("{end} axle: {fault}"))?;
        }
        Ok(study)
    }
}

/// Solver of a car, or the reason in words why its design cannot be solved.
fn solver(study: &CarStudy) -> Result<CarSolver<'_>, String> {
    CarSolver::new(&study.car).map_err(|fault| study.car.describe_fault(&fault))
}

/// Designs of both axles, as coordinates of the page.
fn coordinates(study: &CarStudy) -> Coordinates {
    let frame = study.frame();
    let axles = study.car.axles.iter();
    let points = axles.flat_map(|axle| axle.left.design.iter());
    points
        .map(|point| frame.vector(*point).to_array().map(|c| c + 0.0))
        .collect()
}

impl Reading for OpenedCar {
    fn digest(&self) -> &str {
        &self.digest
    }

    fn overview(&self) -> Overview {
        overview::overview(self)
    }

    fn solved(&self, request: &SolveRequest, stop: &Stop) -> Result<SolvedAnswer, String> {
        answer::solved(self, request, stop)
    }

    fn influence(&self, request: &InfluenceRequest) -> Result<InfluenceAnswer, String> {
        answer::influence(self, request)
    }

    fn directions(&self, of: &Designed) -> Result<DirectionsAnswer, String> {
        directions::directions(self, of)
    }

    fn limits(&self, of: &Designed) -> Result<LimitsAnswer, String> {
        let study = self.moved(&of.design)?;
        let limits = car_limits(&study, &mut solver(&study)?);
        let table = lift_limits_table(&limits, &study.car);
        let is_shown = |column: &str| LIFT_COLUMNS.contains(&column);
        let note = "Accelerations up to 5 g, from forward (0 degrees) to the left (90 degrees).";
        let notes = vec![note.to_owned()];
        Ok(LimitsAnswer::of("Wheel lift", &table, is_shown, notes))
    }

    fn csv(&self, design: &Coordinates, _: Option<&str>) -> Result<Vec<u8>, String> {
        let study = self.moved(design)?;
        let mut solver = solver(&study)?;
        Ok(CarResults::solve(&study, &mut solver, study.cases.len()).cases_csv())
    }

    fn points(&self, of: &Designed) -> Result<Vec<u8>, String> {
        let pages = car_point_pages(&self.moved(&of.design)?, None, None);
        Ok(car_points_csv(pages))
    }

    fn drawing(&self, _: &Designed) -> Result<Vec<u8>, String> {
        Err("drawings for CAD are available for one axle: open its study".to_owned())
    }

    fn report(&self, of: &Designed) -> Result<String, String> {
        let study = self.moved(&of.design)?;
        let mut solver = solver(&study)?;
        let results = CarResults::solve(&study, &mut solver, study.cases.len());
        let rigs = misfit::assessed_rigs(self, &study);
        let found = misfit::misfit(&study, &mut solver, &results, rigs);
        let points = overview::points(&study);
        let points = points.iter().zip(&of.design);
        let points = points.filter(|(point, _)| !point.follows);
        let points = points.map(|(point, place)| (point.name.as_str(), *place));
        let design = page_design(points, study.car.length_unit.symbol(), found.as_ref());
        let remarks = results.remarks();
        let record = results.record("solve", &mut solver, None, &remarks);
        Ok(car_page_of_design(&record, &design))
    }

    fn tuning(self: Arc<Self>, request: &TuneRequest) -> Result<Tuning, String> {
        tuning::tuning(&self, request)
    }

    fn edited(&self, edits: &[ValueEdit]) -> Result<Arc<dyn Reading>, String> {
        let texts = files::edited_texts(&self.texts(), edits)?;
        let edited = OpenedCar::of_texts(&self.files, &texts);
        let edited = edited.map_err(|errors| errors.render(false))?;
        // If the edits cancel each other, no edit must go into a file that another program changes later.
        if edited.digest == self.base {
            return Ok(Arc::new(edited));
        }
        Ok(Arc::new(OpenedCar {
            base: self.base.clone(),
            base_texts: self.base_texts.clone(),
            edits: [&self.edits, edits].concat(),
            ..edited
        }))
    }

    fn texts(&self, design: &Coordinates) -> Result<Vec<TextChange>, String> {
        Ok(self.files.changes(self, &self.designs(design)?))
    }

    fn save(&self, design: &Coordinates, over: &Over) -> Result<Written, NotSaved> {
        let designs = self.designs(design).map_err(NotSaved::Refused)?;
        let (now, files) = self.files.save(self, &designs, over)?;
        let now = Arc::new(now);
        Ok(Written { now, files })
    }

    fn save_as(&self, design: &Coordinates, name: &str, anyway: bool) -> Result<String, NotSaved> {
        let designs = self.designs(design).map_err(NotSaved::Refused)?;
        self.files.save_as(self, &designs, name, anyway)
    }
}

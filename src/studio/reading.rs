//! Answers about a study that was read. The study may describe a wheel, an axle or a car.

use super::job::{Job, Tuning};
use super::message::{
    Coordinates, Designed, DirectionsAnswer, InfluenceAnswer, InfluenceRequest, LimitsAnswer,
    Overview, SolveRequest, SolvedAnswer, TextChange, TuneRequest,
};
use super::page_design::page_design;
use super::study_file::{NotSaved, Opened, Over, StudyFile};
use super::turns::Stop;
use super::{answer, car, directions, influence, misfit, overview};
use crate::in_motions::InMotion;
use crate::model::PointId;
use crate::report::{CurveTable, PageDesign, Record, Run, curves_csv};
use crate::solved::Solved;
use crate::study::{CarStudy, Study, ValueEdit};
use std::io;
use std::path::Path;
use std::sync::Arc;

/// Texts of a study that were read, with the resolved study.
pub(super) trait Reading: Send + Sync {
    /// SHA-256 of the texts of the study.
    fn digest(&self) -> &str;
    /// Data of the study that do not change while points move.
    fn overview(&self) -> Overview;
    /// Solves the design after a point was dragged, for the answer to the page. The flag `stop` stops the work.
    fn solved(&self, request: &SolveRequest, stop: &Stop) -> Result<SolvedAnswer, String>;
    /// Derivatives of the requested columns of the curves with respect to one hardpoint coordinate, at each station.
    fn influence(&self, request: &InfluenceRequest) -> Result<InfluenceAnswer, String>;
    /// Moves of the points that leave the targets unchanged, to first order.
    fn directions(&self, of: &Designed) -> Result<DirectionsAnswer, String>;
    /// Limits of the mechanism, or lift limits of a car.
    fn limits(&self, of: &Designed) -> Result<LimitsAnswer, String>;
    /// Results of a design over a named motion or over the study's own motion, as `hardpoint solve` writes them. For a car: the
    /// results of its load cases.
    fn csv(&self, design: &Coordinates, motion: Option<&str>) -> Result<Vec<u8>, String>;
    /// Hardpoints of a design as a CSV table.
    fn points(&self, of: &Designed) -> Result<Vec<u8>, String>;
    /// DXF drawing of the hardpoints and centre lines of a design, for CAD. Returns an error for a car.
    fn drawing(&self, of: &Designed) -> Result<Vec<u8>, String>;
    /// HTML report page of a design.
    fn report(&self, of: &Designed) -> Result<String, String>;
    /// Tuning of a design, ready to run.
    fn tuning(self: Arc<Self>, request: &TuneRequest) -> Result<Tuning, String>;
    /// Returns the texts with further changes of their values.
    fn edited(&self, edits: &[ValueEdit]) -> Result<Arc<dyn Reading>, String>;
    /// Changes of the user, file by file: the texts as they were opened, and these texts with a design and the edits.
    fn texts(&self, design: &Coordinates) -> Result<Vec<TextChange>, String>;
    /// Writes a design into the files of the study. `over` states whether files that have changed since may be replaced.
    fn save(&self, design: &Coordinates, over: &Over) -> Result<Written, NotSaved>;
    /// Writes the texts with a design to new files in the folder of the study. With `anyway`, existing files are replaced. Returns
    /// the names of the files.
    fn save_as(&self, design: &Coordinates, name: &str, anyway: bool) -> Result<String, NotSaved>;
}

/// Result of a save.
pub(super) struct Written {
    /// Texts and resolved study after the save.
    pub now: Arc<dyn Reading>,
    /// Names of the files whose texts have changed.
    pub files: Vec<String>,
}

/// Files with which the studio was opened.
pub(super) enum Files {
    Study(StudyFile),
    Car(car::CarFiles),
}

impl Files {
    /// Resolves a symbolic link now, so that later writes go to the same file.
    pub(super) fn at(path: &Path) -> io::Result<Self> {
        let file = StudyFile::at(path)?;
        Ok(if CarStudy::is_at(file.path()) {
            Files::Car(car::CarFiles::at(file.path()))
        } else {
            Files::Study(file)
        })
    }

    pub(super) fn path(&self) -> &Path {
        match self {
            Files::Study(file) => file.path(),
            Files::Car(files) => files.path(),
        }
    }

    /// Reads the files of the study as they are now, or returns the reason in words why they cannot be read.
    pub(super) fn read(&self) -> Result<Arc<dyn Reading>, String> {
        Ok(match self {
            Files::Study(file) => Arc::new(file.read()?),
            Files::Car(files) => Arc::new(files.read()?),
        })
    }

    /// SHA-256 of the files' texts as they are now.
    pub(super) fn digest(&self) -> Result<String, String> {
        match self {
            Files::Study(file) => file.digest(),
            Files::Car(files) => files.digest(),
        }
    }
}

impl Opened {
    /// Misfit and hardpoints of a design, for its report page.
    fn page_design(&self, study: &Study, design: &Coordinates) -> Result<PageDesign, String> {
        let suspension = study.wheel();
        let points = suspension.mechanism.points.iter().zip(design).enumerate();
        // The right half of a solid axle follows the left half, so its points are not listed.
        let points = points.filter(|(id, _)| !suspension.mechanism.is_far(PointId(*id)));
        let points = points.map(|(_, (point, place))| (point.name.as_str(), *place));
        let found = misfit::misfit(self, study).map_err(|fault| fault.to_string())?;
        let unit = suspension.length_unit.symbol();
        Ok(page_design(points, unit, found.as_ref()))
    }
}

impl Reading for Opened {
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
        influence::influence(self, request)
    }

    fn directions(&self, of: &Designed) -> Result<DirectionsAnswer, String> {
        directions::directions(self, of)
    }

    fn limits(&self, of: &Designed) -> Result<LimitsAnswer, String> {
        directions::limits(self, of)
    }

    fn csv(&self, design: &Coordinates, motion: Option<&str>) -> Result<Vec<u8>, String> {
        answer::csv(self, design, motion)
    }

    fn points(&self, of: &Designed) -> Result<Vec<u8>, String> {
        answer::points(self, of)
    }

    fn drawing(&self, of: &Designed) -> Result<Vec<u8>, String> {
        answer::drawing(self, of)
    }

    fn report(&self, of: &Designed) -> Result<String, String> {
        let study = self.moved(&of.design)?;
        let solved = Solved::of(&study)?;
        let in_motions = InMotion::all(&[("design", &study)], false)?;
        let named = in_motions.iter().flat_map(|own| &own.curves);
        let named = named.map(|curves| CurveTable::read(&curves_csv(curves)));
        let own = std::iter::once(CurveTable::read(&solved.csv()));
        let curves = own.chain(named).collect::<Result<_, _>>()?;
        let record = Solved::record("solve", &[("design", "curves.csv", &solved)])?;
        let run = Run {
            record: Record {
                motions: in_motions.into_iter().map(|own| own.record).collect(),
                ..record
            },
            curves,
            summary: solved.summary()?,
            interrupted: false,
            history: None,
            files: Vec::new(),
        };
        let design = self.page_design(&study, &of.design)?;
        Ok(crate::report::page_of_design(&run, &design))
    }

    fn tuning(self: Arc<Self>, request: &TuneRequest) -> Result<Tuning, String> {
        Job::of_study(self, request)
    }

    fn edited(&self, edits: &[ValueEdit]) -> Result<Arc<dyn Reading>, String> {
        Ok(Arc::new(self.file.edited(self, edits)?))
    }

    fn texts(&self, design: &Coordinates) -> Result<Vec<TextChange>, String> {
        Ok(self.file.texts(self, &self.design(design)?))
    }

    fn save(&self, design: &Coordinates, over: &Over) -> Result<Written, NotSaved> {
        let design = self.design(design).map_err(NotSaved::Refused)?;
        let (now, is_changed) = self.file.save(self, &design, over)?;
        Ok(Written {
            now: Arc::new(now),
            files: is_changed.then(|| self.file.name()).into_iter().collect(),
        })
    }

    fn save_as(&self, design: &Coordinates, name: &str, anyway: bool) -> Result<String, NotSaved> {
        let design = self.design(design).map_err(NotSaved::Refused)?;
        self.file.save_as(self, &design, name, anyway)
    }
}

//! Requests of the page.

use super::Coordinates;
use crate::study::ValueEdit;
use serde::Deserialize;

/// A design (coordinates of all points) that belongs to a study text of the server.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::studio) struct Designed {
    /// SHA-256 of the study text.
    pub digest: String,
    pub design: Coordinates,
}

/// A design whose curves are exported.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::studio) struct CurvesRequest {
    /// SHA-256 of the study text.
    pub digest: String,
    pub design: Coordinates,
    /// Name of the motion. `None` for the study's own motion.
    #[serde(default)]
    pub motion: Option<String>,
}

/// Changes of a study text that the server has read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::studio) struct EditRequest {
    /// SHA-256 of the study text.
    pub digest: String,
    pub edits: Vec<ValueEdit>,
}

/// Request for a new study.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::studio) struct StartRequest {
    pub topology: String,
    /// File name, without folders, in the folder in which the studio was started.
    pub name: String,
    /// Points as text copied from a spreadsheet. Empty for the points of the template.
    pub points: String,
    pub unit: Option<String>,
    pub axes: Option<String>,
    pub side: Option<String>,
    /// Half of the track, in the unit of the points.
    pub half_track: Option<f64>,
    /// Loaded radius of the wheel, in the unit of the points.
    #[serde(default)]
    pub wheel_radius: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::studio) struct SolveRequest {
    pub of: Designed,
    /// Names of the requested characteristics.
    pub characteristics: Vec<String>,
    /// Position of the mechanism in the drawing: one value per slider, in the unit of the slider.
    pub at: Vec<f64>,
    /// Rack displacement of the curves, in the study's unit and axes. `None` for the displacements of the study.
    pub curves_rack: Option<f64>,
    /// Index of the slider whose coordinate is on the horizontal axis of the curves.
    pub over: usize,
    /// Name of the motion. `None` for the study's own motion.
    #[serde(default)]
    pub motion: Option<String>,
    /// True if the page needs only the stations of the shown group, because a point still moves.
    #[serde(default)]
    pub shown_only: bool,
    /// Number of the page, and number of its request. A later request of the same page stops this one. `None` if later requests
    /// must not stop it.
    #[serde(default)]
    pub turn: Option<[u64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::studio) struct InfluenceRequest {
    pub of: Designed,
    pub characteristics: Vec<String>,
    pub point: usize,
    /// Axis of the study: 0 for x, 1 for y, 2 for z.
    pub axis: usize,
    /// Name of the motion. `None` for the study's own motion.
    #[serde(default)]
    pub motion: Option<String>,
    /// Rack displacement of the curves, in the study's unit and axes. `None` for the displacements of the study.
    #[serde(default)]
    pub curves_rack: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::studio) struct TuneRequest {
    pub of: Designed,
    /// `[point][axis]`: true if the coordinate must not move.
    pub locked: Vec<[bool; 3]>,
}

impl TuneRequest {
    /// Returns true if a coordinate must stay as it is.
    pub(in crate::studio) fn is_locked(&self, point: usize, axis: usize) -> bool {
        self.locked.get(point).is_some_and(|axes| axes[axis])
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::studio) struct JobRequest {
    pub job: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::studio) struct SaveRequest {
    pub of: Designed,
    /// File name, without folders, in the folder of the study. `None` for the study itself.
    pub name: Option<String>,
    /// True to write the moved coordinates although the file has changed, or to replace an existing file of that name.
    pub anyway: bool,
    /// SHA-256 of the file's text that the page last read or wrote. `None` if this is the text to which the edits of the study
    /// text apply. The two texts differ after a save and an undo.
    #[serde(default)]
    pub base: Option<String>,
}

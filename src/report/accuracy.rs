//! Remarks on curves: conditioning of the poses, certificates of the poses, and missing values.

use super::completeness::Completeness;
use super::counted;
use super::figure::brief;
use super::station_label::{StationLabel, place_in_words};
use crate::curves::{Curves, Station, Status};
use crate::model::{LengthUnit, Rod, Side};
use crate::study::Drive;
use serde::{Deserialize, Serialize};

/// Remarks on curves, one per line: their accuracy, and missing values.
pub fn remarks(curves: &Curves, length: LengthUnit) -> Vec<String> {
    remarks_on_motion(curves, length, |_| false)
}

/// Remarks on the curves of one of several motions. `elsewhere` returns true if another motion has values of a column.
pub fn remarks_on_motion(
    curves: &Curves,
    length: LengthUnit,
    elsewhere: impl Fn(&str) -> bool,
) -> Vec<String> {
    let certificate = CertificateSummary::of(curves);
    let certificate = certificate.map(|c| c.remark(curves.stations.len(), length.symbol()));
    let warning = ConditionSummary::of(curves).and_then(|c| c.warning());
    certificate
        .into_iter()
        .chain(warning)
        .chain(unsupported(curves))
        .chain(toggled(curves))
        .chain(Completeness::of(curves).remarks(elsewhere))
        .collect()
}

/// Remark on stations at which a value is missing because no part can carry the loads, if there are any.
fn unsupported(curves: &Curves) -> Option<String> {
    let stations = curves.stations.iter().enumerate();
    let lacks = |station: &Station| {
        let missing = station.values.iter().filter_map(|value| value.err());
        missing.into_iter().find(|reason| reason.is_about_loads())
    };
    let mut lacking = stations.filter_map(|(number, station)| Some((number, lacks(station)?)));
    let (first, reason) = lacking.next()?;
    Some(format!(
        "warning: loads cannot be carried at {}, the first at {}: {}",
        counted(1 + lacking.count(), "station"),
        place_in_words(curves, first),
        reason.reason(),
    ))
}

/// Remarks on stations at which a rocker has reached a toggle. There is one remark for each affected rod of each wheel.
fn toggled(curves: &Curves) -> Vec<String> {
    let is_axle = curves.motion_index(Drive::Travel.key()).is_none();
    let mut warnings = Vec::new();
    for side in Side::ALL {
        // Coordinates that measure the distance from the design position: the angle that drives the wheel, or else its travel.
        let (of, keys) = match (is_axle, side) {
            (false, _) => ("", ["arm_angle", "theta", "travel"]),
            (true, Side::Left) => ("left wheel's ", ["travel_left"; 3]),
            (true, Side::Right) => ("right wheel's ", ["travel_right"; 3]),
        };
        let distance = |s: &Station| {
            let mut known = keys
                .iter()
                .filter_map(|key| s.at[curves.motion_index(key)?]);
            known.next().map_or(f64::INFINITY, f64::abs)
        };
        for rod in [
            Rod::Pushrod,
            Rod::Pullrod,
            Rod::DropLink,
            Rod::WattLink,
            Rod::DragLink,
            Rod::TieRod,
        ] {
            let is_stuck = |(_, s): &(usize, &Station)| matches!(s.status, Status::Toggle(rods) if rods[side as usize] == Some(rod));
            let stuck = || curves.stations.iter().enumerate().filter(is_stuck);
            let nearest = stuck().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
            warnings.extend(nearest.map(|(nearest, _)| {
                format!(
                    "warning: the {of}{rod} is at toggle or beyond it at {} (nearest to the design \
                     position: {}). Since it cannot turn {} any further there, quantities of the \
                     rocker or bar have no values",
                    counted(stuck().count(), "station"),
                    place_in_words(curves, nearest),
                    rod.turns()
                )
            }));
        }
    }
    warnings
}

/// Conditioning of the poses along the motion.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ConditionSummary {
    /// Largest condition number of a station. A value below 1000 may be known only to within a factor of ten.
    worst: f64,
    /// Station of the largest condition number.
    at: StationLabel,
    /// Station of the largest condition number, in words.
    #[serde(skip)]
    at_words: String,
    /// Stations whose derivatives and sensitivities have fewer than six correct digits.
    ill_conditioned: Vec<StationLabel>,
}

impl ConditionSummary {
    /// Summarises the conditioning of curves. `None` if no station has a pose.
    pub(super) fn of(curves: &Curves) -> Option<Self> {
        let stations = || curves.stations.iter().enumerate();
        let all = stations().filter_map(|(number, s)| Some((s.condition?, number)));
        let (worst, at) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let poor = stations().filter(|(_, s)| s.status == Status::IllConditioned);
        Some(ConditionSummary {
            worst,
            at: StationLabel::of(curves, at),
            at_words: place_in_words(curves, at),
            ill_conditioned: poor
                .map(|(number, _)| StationLabel::of(curves, number))
                .collect(),
        })
    }

    /// Warning if some stations are ill-conditioned (fewer than six correct digits in derivatives). `None` otherwise.
    fn warning(&self) -> Option<String> {
        let stations = match self.ill_conditioned.len() {
            0 => return None,
            1 => "1 station has".to_owned(),
            n => format!("{n} stations have"),
        };
        Some(format!(
            "warning: {stations} fewer than six correct digits in derivatives and sensitivities; the worst at {} \
             (condition number {})",
            self.at_words,
            brief(self.worst)
        ))
    }
}

/// Summary of the certificates of poses.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CertificateSummary {
    /// Number of stations with a certificate. A certificate states that the pose exists and lies on the solution branch of
    /// the design position.
    proved: usize,
    /// Number of stations whose pose could not be certified.
    unproved: usize,
    /// True if every station is certified. Then the whole curve lies on one solution branch.
    one_branch: bool,
    /// Largest certified bound on the position error of points of a wheel carrier, in the study's length unit. `None` if no
    /// station is certified.
    largest_position_error: Option<f64>,
    /// Station with the bound `largest_position_error`.
    at: Option<StationLabel>,
    /// Station with the bound `largest_position_error`, in words.
    #[serde(skip)]
    at_words: String,
    /// Smallest distance from a certified pose within which its certificate excludes any other pose, in the study's length unit.
    smallest_uniqueness: Option<f64>,
}

impl CertificateSummary {
    /// Summarises the certificates of curves. `None` if the study does not request them.
    pub(super) fn of(curves: &Curves) -> Option<Self> {
        if curves.bounds.is_empty() {
            return None;
        }
        let is_unproved = |s: &&Station| match s.status {
            Status::Failed(reason) => reason.is_unproven(),
            _ => false,
        };
        let mut summary = CertificateSummary {
            proved: 0,
            unproved: curves.stations.iter().filter(is_unproved).count(),
            one_branch: false,
            largest_position_error: None,
            at: None,
            at_words: String::new(),
            smallest_uniqueness: None,
        };
        for (number, station) in curves.stations.iter().enumerate() {
            let Some(proof) = &station.proof else {
                continue;
            };
            summary.proved += 1;
            // If several stations have the largest error, the last one is reported.
            if summary.largest_position_error <= Some(proof.position_error) {
                summary.largest_position_error = Some(proof.position_error);
                summary.at = Some(StationLabel::of(curves, number));
                summary.at_words = place_in_words(curves, number);
            }
            let nearest = summary.smallest_uniqueness.unwrap_or(f64::INFINITY);
            summary.smallest_uniqueness = Some(nearest.min(proof.uniqueness));
        }
        summary.one_branch = summary.proved == curves.stations.len();
        Some(summary)
    }

    /// Summary in words, for curves with this number of stations.
    pub(super) fn remark(&self, stations: usize, length_unit: &str) -> String {
        let mut text = format!(
            "certificate: {} of {stations} stations certified",
            self.proved
        );
        text += &match (self.one_branch, self.unproved) {
            (true, _) => "; the whole curve is on one branch".to_owned(),
            (false, 0) => "; all poses that can be reached are on one branch".to_owned(),
            (false, n) => format!("; {n} with a pose that could not be certified"),
        };
        if let Some(error) = self.largest_position_error {
            // The value is rounded up, so that the printed number is also a bound.
            let error = brief(error * 1.00001);
            text += &format!(
                "; largest error of a point of the wheel carrier {error} {length_unit} (at {})",
                self.at_words
            );
        }
        text
    }
}

//! Remarks on curves: their conditioning, their certificate, and values that they lack.

use super::completeness::Completeness;
use super::figure::brief;
use super::station_label::StationLabel;
use crate::curves::{Curves, Proof, Station, Status};
use crate::mechanism::Failure;
use crate::model::Rod;
use crate::study::{Drive, Study};
use serde::{Deserialize, Serialize};
use std::fmt::Display;

/// Remarks on curves, a line each: on their accuracy, and on values that they lack.
pub fn remarks(study: &Study, curves: &Curves) -> Vec<String> {
    let unit = study.suspension.length_unit.symbol();
    let certificate = CertificateSummary::of(study, curves);
    let certificate = certificate.map(|c| c.remark(curves.stations.len(), unit));
    let condition = ConditionSummary::of(curves, study.motion.drive);
    let warning = condition.and_then(|c| c.warning());
    let unsupported = unsupported(study, curves);
    certificate
        .into_iter()
        .chain(warning)
        .chain(unsupported)
        .chain(toggled(study, curves))
        .chain(Completeness::of(curves).remarks())
        .collect()
}

/// A remark on stations where nothing can carry the loads, if there are any.
fn unsupported(study: &Study, curves: &Curves) -> Option<String> {
    let lacks = |s: &&Station| s.status == Status::Unsupported;
    let count = curves.stations.iter().filter(lacks).count();
    let first = curves.stations.iter().find(lacks)?;
    let support = match study.suspension.mechanism.spring {
        Some(_) => "the spring",
        None => "a vertical force at the wheel centre",
    };
    let stations = stations_in_words(count);
    Some(format!(
        "warning: loads cannot be carried at {stations}, the first at {}: {support} has almost no leverage there",
        StationLabel::of(first, study.motion.drive)
    ))
}

/// Remark on stations at which a rocker is at its toggle.
fn toggled(study: &Study, curves: &Curves) -> Option<String> {
    let is_toggled = |s: &&Station| matches!(s.status, Status::Toggle(_));
    let count = curves.stations.iter().filter(is_toggled).count();
    // Nearest to the design position.
    let distance = |s: &&Station| s.angle.or(s.travel).map_or(f64::INFINITY, f64::abs);
    let stations = curves.stations.iter().filter(is_toggled);
    let first = stations.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    let Status::Toggle(rod) = first.status else {
        return None;
    };
    let nearest = StationLabel::of(first, study.motion.drive);
    Some(at_toggle("", rod, count, nearest))
}

/// Warning that a rod is at toggle at some stations. `of` names the wheel of an axle.
pub(super) fn at_toggle(of: &str, rod: Rod, count: usize, nearest: impl Display) -> String {
    format!(
        "warning: the {of}{rod} is at toggle or beyond it at {}, the nearest at {nearest}: it turns {} \
         no further there, so quantities that move with it have no values",
        stations_in_words(count),
        rod.turns()
    )
}

pub(super) fn stations_in_words(count: usize) -> String {
    match count {
        1 => "1 station".to_owned(),
        n => format!("{n} stations"),
    }
}

/// The conditioning along the motion.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ConditionSummary {
    /// The largest condition number; to within a factor of ten where it is below 1000.
    worst: f64,
    /// Station with this number.
    at: StationLabel,
    /// Stations whose derivatives and sensitivities have fewer than six digits.
    ill_conditioned: Vec<StationLabel>,
}

impl ConditionSummary {
    /// Conditioning of curves. `None` if no station has a pose.
    pub(super) fn of(curves: &Curves, drive: Drive) -> Option<Self> {
        let known = |s: &Station| {
            s.condition
                .map(|condition| (condition, StationLabel::of(s, drive)))
        };
        let all = curves.stations.iter().filter_map(known);
        let (worst, at) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let poor = |s: &&Station| s.status == Status::IllConditioned;
        let poor = curves.stations.iter().filter(poor);
        Some(ConditionSummary {
            worst,
            at,
            ill_conditioned: poor.map(|s| StationLabel::of(s, drive)).collect(),
        })
    }

    /// A warning, if stations are ill-conditioned.
    fn warning(&self) -> Option<String> {
        let stations = match self.ill_conditioned.len() {
            0 => return None,
            1 => "1 station has".to_owned(),
            n => format!("{n} stations have"),
        };
        Some(format!(
            "warning: {stations} fewer than six correct digits in derivatives and sensitivities; the worst at {} \
             (condition number {})",
            self.at,
            brief(self.worst)
        ))
    }
}

/// Summary of proofs. `L` is the type of labels that say where a station is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CertificateSummary<L = StationLabel> {
    /// Number of stations whose pose is proved, and that it is on the branch of the design position.
    proved: usize,
    /// Number of stations with a pose that could not be proved.
    unproved: usize,
    /// Whether every station is proved, so that the whole curve is one branch.
    one_branch: bool,
    /// The largest of the proved bounds on the position of points of the wheel carrier.
    largest_position_error: Option<f64>,
    /// Station with this bound.
    at: Option<L>,
    /// The smallest distance within which there is proved to be no other pose.
    smallest_uniqueness: Option<f64>,
}

impl CertificateSummary {
    /// Summary of the proofs of curves. `None` if the study does not ask for them.
    pub(super) fn of(study: &Study, curves: &Curves) -> Option<Self> {
        if !study.outputs.certify {
            return None;
        }
        let proofs = curves.stations.iter().filter_map(|s| Some((s, s.proof?)));
        let refused = |s: &&Station| matches!(s.status, Status::Failed(Failure::Uncertified(_)));
        let summary = CertificateSummary::of_proofs(
            proofs,
            curves.stations.iter().filter(refused).count(),
            curves.stations.len(),
        );
        Some(summary.at(|station| StationLabel::of(station, study.motion.drive)))
    }
}

impl<L> CertificateSummary<L> {
    /// Summary of the proofs of a motion with this number of `stations`, of which `unproved` could not be proved.
    pub(super) fn of_proofs(
        proofs: impl Iterator<Item = (L, Proof)>,
        unproved: usize,
        stations: usize,
    ) -> Self {
        let mut summary = CertificateSummary {
            proved: 0,
            unproved,
            one_branch: false,
            largest_position_error: None,
            at: None,
            smallest_uniqueness: None,
        };
        for (at, proof) in proofs {
            summary.proved += 1;
            // The last of the worst.
            if summary.largest_position_error <= Some(proof.position_error) {
                summary.largest_position_error = Some(proof.position_error);
                summary.at = Some(at);
            }
            let nearest = summary.smallest_uniqueness.unwrap_or(f64::INFINITY);
            summary.smallest_uniqueness = Some(nearest.min(proof.uniqueness));
        }
        summary.one_branch = summary.proved == stations;
        summary
    }

    /// The summary with another kind of label.
    pub(super) fn at<M>(self, words: impl FnOnce(L) -> M) -> CertificateSummary<M> {
        CertificateSummary {
            proved: self.proved,
            unproved: self.unproved,
            one_branch: self.one_branch,
            largest_position_error: self.largest_position_error,
            at: self.at.map(words),
            smallest_uniqueness: self.smallest_uniqueness,
        }
    }
}

impl<L: Display> CertificateSummary<L> {
    /// The summary in words.
    pub(super) fn remark(&self, stations: usize, length_unit: &str) -> String {
        let mut text = format!("certificate: {} of {stations} stations proved", self.proved);
        text += &match (self.one_branch, self.unproved) {
            (true, _) => "; the whole curve is one branch".to_owned(),
            (false, 0) => "; what can be reached is one branch".to_owned(),
            (false, n) => format!("; {n} with a pose that could not be proved"),
        };
        if let (Some(error), Some(at)) = (self.largest_position_error, &self.at) {
            // Rounded up, so that the printed value is a bound, too.
            let error = brief(error * 1.00001);
            text += &format!(
                "; largest error of a point of the wheel carrier {error} {length_unit} (at {at})"
            );
        }
        text
    }
}

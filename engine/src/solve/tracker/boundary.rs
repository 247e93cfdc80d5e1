//! Search for designs at the boundary between designs that the tracker accepts and designs that it rejects.
//!
//! On a line between an accepted and a rejected design, bisection ends at two neighbouring designs. Between these two, the inputs
//! of a check differ only by rounding errors. A check that accepts the first design with some slack also accepts the second one. So
//! the check that rejects the second design is the one without slack.

use super::{Acceptance, AdjointPose, CornerTracker, Rejection, Visit};
use crate::model::{Drive, Suspension, Topology};
use crate::number::Vector3;
use crate::solve::StationOrder;
use crate::study::Study;
use std::collections::BTreeMap;
use std::path::Path;

struct Nothing;

impl Visit<f64> for Nothing {
    fn pose(&mut self, _: usize, _: &impl AdjointPose<f64>, _: Acceptance<f64>) {}
}

/// Tracks a design. Returns the reason if a leg of the route ends early, `None` otherwise. `history` receives the unknowns.
pub(super) fn rejection(
    tracker: &CornerTracker<'_>,
    rack: usize,
    design: &[Vector3<f64>],
    history: &mut [f64],
) -> Option<Rejection> {
    let lanes = tracker.design(design);
    let tracked = tracker.solve(&lanes, rack, history, &mut Nothing);
    tracked.legs.iter().find_map(|leg| leg.reason(0))
}

/// Pseudorandom numbers in [-1, 1).
pub(super) struct Noise(pub u64);

impl Noise {
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

pub(super) fn template(topology: &str) -> Suspension {
    let topology = Topology::named(topology).unwrap();
    let study = Study::from_text("template.toml", topology.template, Path::new("."));
    study.expect("a template is valid").into_wheel()
}

/// Decision of a check at a waypoint: its name, its reason for a rejection, and its slack (distance from the threshold). A
/// check with negative slack rejects.
pub(super) struct Judgement {
    pub guard: &'static str,
    pub reason: Rejection,
    /// Distance from the threshold, relative to the threshold.
    pub slack: f64,
}

/// Slack that counts as zero. It exceeds the rounding errors of a design and is far below the slack of other checks.
const NONE: f64 = 1e-6;

/// Searches for boundaries on lines from the design of the study. The rack is alternately in the middle and displaced.
/// `judge` returns the decisions of all checks at all waypoints of an accepted design. At least one of these decisions must
/// have zero slack, unless Newton's method did not converge for the neighbouring rejected design. If exactly one decision
/// has zero slack, its reason must be the reason why the neighbouring design was rejected. Boundaries at which several
/// checks have zero slack are skipped. Returns the number of the other boundaries, for each check.
pub(super) fn boundaries(
    suspension: &Suspension,
    drive: Drive,
    lines: usize,
    judge: impl Fn(&CornerTracker<'_>, usize, &[Vector3<f64>], &[f64]) -> Vec<Judgement>,
) -> BTreeMap<&'static str, usize> {
    let base = &suspension.design;
    let size = suspension.size();
    let (reach, rack) = match drive {
        Drive::Travel => (0.25 * size, 0.15 * size),
        Drive::ArmAngle => (1.0, 0.15 * size),
    };
    let stations: Vec<f64> = (-8..=8).map(|k| reach * f64::from(k) / 8.0).collect();
    let order = StationOrder::through(&stations);
    let tracker =
        CornerTracker::new(&suspension.mechanism, base, drive, &order, &[0.0, rack]).unwrap();
    let mut noise = Noise(7);
    let mut counts = BTreeMap::new();
    for line in 0..lines {
        let number = line % 2;
        let direction: Vec<Vector3<f64>> = base
            .iter()
            .map(|_| Vector3::new(noise.next(), noise.next(), noise.next()) * (0.5 * size))
            .collect();
        let at = |t: f64| -> Vec<Vector3<f64>> {
            let points = base.iter().zip(&direction);
            points.map(|(point, along)| *point + *along * t).collect()
        };
        let mut history = tracker.history(0.0_f64);
        let mut reject = |t: f64| rejection(&tracker, number, &at(t), &mut history);
        // Uses the nearest of a few rejected designs, so that the boundary lies between ordinary designs.
        let Some(mut high) = (1..=24)
            .map(|k| f64::from(k) / 24.0)
            .find(|t| reject(*t).is_some())
        else {
            continue;
        };
        let mut low = high - 1.0 / 24.0;
        if reject(low).is_some() {
            continue;
        }
        while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
            let middle = 0.5 * (low + high);
            match reject(middle) {
                Some(_) => high = middle,
                None => low = middle,
            }
        }
        let reason = reject(high).expect("rejected");
        assert_eq!(reject(low), None);
        let judged = judge(&tracker, number, &at(low), &history);
        for place in &judged {
            assert!(place.slack > -NONE, "{}: {}", place.guard, place.slack);
        }
        let mut without: Vec<_> = judged.iter().filter(|j| j.slack < NONE).collect();
        without.dedup_by_key(|j| j.guard);
        let guard = match without[..] {
            // The check of convergence counts corrections, so it has no slack.
            _ if reason == Rejection::NotSettled => "settles",
            [only] => {
                assert_eq!(only.reason, reason, "{}", only.guard);
                only.guard
            }
            [] => panic!("line {line}: no guard is at its threshold, but {reason:?}"),
            // Two checks reach their thresholds together, so either may reject.
            _ => continue,
        };
        *counts.entry(guard).or_insert(0) += 1;
    }
    println!(
        "{} {drive:?}: {counts:?}",
        suspension.mechanism.topology.name
    );
    counts
}

/// Slack of a value below a threshold, as a share of the threshold. Negative if the value exceeds the threshold.
pub(super) fn below(value: f64, threshold: f64) -> f64 {
    1.0 - value / threshold
}

/// Slack of a value above a threshold, as a share of the threshold. Negative if the value is smaller than the threshold.
pub(super) fn above(value: f64, threshold: f64) -> f64 {
    value / threshold - 1.0
}

/// Slacks of a number that may neither fall below half of its value nor more than double.
pub(super) fn steady(now: f64, before: f64) -> [f64; 2] {
    [above(now / before, 0.5), below(now / before, 2.0)]
}

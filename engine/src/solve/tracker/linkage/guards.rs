//! Tests every check of designs in six unknowns at its threshold.

use super::super::boundary::{Judgement, above, below, boundaries, steady, template};
use super::super::route::Leg;
use super::super::track::PlaceEquations;
use super::super::{Acceptance, AdjointPose, Rejection, Visit};
use super::super::{CornerTracker, Form, Method};
use super::corner::at_place;
use super::newton::BranchGuard;
use super::newton::NewtonSteps;
use super::{ByLinkage, LinkageDesign, UNKNOWNS};
use crate::mechanism::Twist;
use crate::model::Drive;
use crate::number::Vector3;
use std::collections::BTreeMap;

fn reason(check: impl FnOnce(&mut Acceptance<f64>)) -> Option<Rejection> {
    let mut accepted = Acceptance::everywhere(0.0);
    check(&mut accepted);
    accepted.reason(0)
}

fn largest(vector: Vector3<f64>) -> f64 {
    vector
        .to_array()
        .into_iter()
        .fold(0.0, |most, x| most.max(x.abs()))
}

struct Nothing;

impl Visit<f64> for Nothing {
    fn pose(&mut self, _: usize, _: &impl AdjointPose<f64>, _: Acceptance<f64>) {}
}

/// Returns the decisions of the checks at all waypoints of an accepted design, computed from their formulas and published
/// thresholds. Each waypoint is corrected again from its prediction, since the determinants belong to the last step of
/// Newton's method.
fn judge(
    tracker: &CornerTracker<'_>,
    rack: usize,
    points: &[Vector3<f64>],
    history: &[f64],
) -> Vec<Judgement> {
    let lanes = tracker.design(points);
    let (Method::Linkage(method), Form::Linkage(linkage)) = (&tracker.method, &lanes.form) else {
        unreachable!("the design has six unknowns")
    };
    let mut visitor = Nothing;
    let mut corner = method.corner(linkage, tracker.tolerance, &mut visitor);
    let mut judged = Vec::new();
    let mut last: [Option<(Vector3<f64>, [f64; 2])>; 2] = [None; 2];
    for (number, place) in tracker.routes[rack].places.iter().enumerate() {
        let mut add = |guard, reason, slack| {
            judged.push(Judgement {
                guard,
                reason,
                slack,
            });
        };
        let mut unknowns = corner.predict(place, history);
        let first = at_place(place, unknowns[0]);
        let (_, step) = corner.steps.linearise(&unknowns, first, false);
        let moved = largest(step.shift) / method.size;
        let correction = moved.max(largest(step.turn));
        add(
            "correction",
            Rejection::ChangedTooMuch,
            below(correction, 0.02),
        );
        for round in 1..=5 {
            if corner.correct(place, &mut unknowns, false, round) {
                break;
            }
        }
        let found = &history[UNKNOWNS * number..][..UNKNOWNS];
        assert_eq!(&unknowns[..], found, "the same place again");
        let determinants = corner.steps.determinants;
        for (k, guard) in ["first block", "second block"].into_iter().enumerate() {
            let share = (determinants[k] / method.determinants[k]).abs();
            add(guard, Rejection::IllConditioned, above(share, 0.25));
        }
        let turned = Vector3::new(unknowns[3], unknowns[4], unknowns[5]);
        if let Some((known_turn, known)) = last[place.leg.side()] {
            for k in 0..2 {
                let [low, high] = steady(determinants[k], known[k]);
                let names = [
                    ["first block halves", "first block doubles"],
                    ["second block halves", "second block doubles"],
                ][k];
                add(names[0], Rejection::ChangedTooMuch, low);
                add(names[1], Rejection::ChangedTooMuch, high);
            }
            let turn = largest(turned - known_turn);
            add(
                "turned far in a step",
                Rejection::TurnedFar,
                below(turn, 0.1),
            );
        }
        let now = Some((turned, determinants));
        match place.leg {
            Leg::Rack => last = [now; 2],
            leg => last[leg.side()] = now,
        }
    }
    judged
}

/// For each check of a single waypoint there is a design that only this check rejects, at its published threshold.
/// For some checks between two waypoints the search lines contain no such design;
/// `a_step_is_guarded_at_its_thresholds` tests these checks.
#[test]
fn every_guard_rejects_a_design_alone() {
    let mut all: BTreeMap<&str, usize> = BTreeMap::new();
    for topology in ["five_link", "semi_trailing_arm"] {
        for (guard, count) in boundaries(&template(topology), Drive::Travel, 300, judge) {
            *all.entry(guard).or_insert(0) += count;
        }
    }
    for guard in ["first block", "second block", "correction"] {
        assert!(
            all.contains_key(guard),
            "{guard} rejects no design alone: {all:?}"
        );
    }
}

/// Tests the checks of a single waypoint and between two waypoints, each at its threshold while all other checks
/// accept.
#[test]
fn a_step_is_guarded_at_its_thresholds() {
    let before = BranchGuard {
        turned: Vector3::new(0.1, -0.2, 0.05),
        determinants: [0.6, -2.0],
    };
    let changed = Some(Rejection::ChangedTooMuch);
    for k in 0..2 {
        let scaled = |by: f64| {
            let mut guard = before;
            guard.determinants[k] *= by;
            guard
        };
        let step = |by: f64| reason(|accepted| scaled(by).check_step(&before, accepted));
        for by in [0.500_001, 1.0, 1.999_999] {
            assert_eq!(step(by), None, "{k} {by}");
        }
        for by in [-1.0, 0.0, 0.499_999, 2.000_001, f64::INFINITY, f64::NAN] {
            assert_eq!(step(by), changed, "{k} {by}");
        }
        // The threshold is relative to the base design's determinants, whatever their sign.
        let place = |by: f64| reason(|accepted| scaled(by).check(&[0.6, 2.0], accepted));
        for by in [0.250_001, -0.250_001, 4.0] {
            assert_eq!(place(by), None, "{k} {by}");
        }
        for by in [0.249_999, -0.249_999, 0.0, f64::NAN] {
            assert_eq!(place(by), Some(Rejection::IllConditioned), "{k} {by}");
        }
    }
    for axis in 0..3 {
        let turned = |by: f64| {
            let mut turned = before.turned.to_array();
            turned[axis] += by;
            let guard = BranchGuard {
                turned: turned.into(),
                ..before
            };
            reason(|accepted| guard.check_step(&before, accepted))
        };
        for by in [0.099_999, -0.099_999] {
            assert_eq!(turned(by), None, "{axis} {by}");
        }
        for by in [0.100_001, -0.100_001, f64::NAN] {
            assert_eq!(turned(by), Some(Rejection::TurnedFar), "{axis} {by}");
        }
    }
}

/// A prediction may have an error of 0.02 sizes and of 0.02 in rotation, in each direction.
#[test]
fn a_prediction_is_near_up_to_a_fiftieth() {
    let suspension = template("five_link");
    let size = suspension.size();
    let method = ByLinkage::of(
        &suspension.mechanism,
        &suspension.design,
        Drive::Travel,
        size,
    )
    .unwrap();
    let linkage = LinkageDesign::new(&suspension.mechanism, &suspension.design);
    let steps = NewtonSteps::<f64>::of(&method, &linkage, 1e-12);
    for k in 0..6 {
        let near = |by: f64| {
            let mut twist = [0.0; 6];
            twist[k] = if k < 3 { by * size } else { by };
            steps.is_near(&Twist::from_array(twist))
        };
        assert!(near(0.019_999) && near(-0.019_999), "{k}");
        assert!(
            !near(0.020_001) && !near(-0.020_001) && !near(f64::NAN),
            "{k}"
        );
    }
}

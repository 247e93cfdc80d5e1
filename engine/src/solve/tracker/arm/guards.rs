//! Tests every check of designs with a closed form at its threshold.

use super::super::boundary::{Judgement, above, below, boundaries, rejection, steady, template};
use super::super::route::Leg;
use super::super::{Acceptance, Rejection};
use super::super::{CornerTracker, Form, Method};
use super::{BranchGuard, ByArm};
use crate::model::Drive;
use crate::number::Vector3;
use crate::solve::StationOrder;
use crate::solve::closed_form::{ClosedForm, Roles};
use std::collections::BTreeMap;

fn reason(check: impl FnOnce(&mut Acceptance<f64>)) -> Option<Rejection> {
    let mut accepted = Acceptance::everywhere(0.0);
    check(&mut accepted);
    accepted.reason(0)
}

/// Derivative of the half tangent, tan(angle/2) of the arm, with respect to the travel. Computed from finite differences of the
/// travel in the closed form.
fn slope_by_travel(form: &ClosedForm<f64>, tangent: f64, rack: f64) -> f64 {
    let travel = |t: f64| form.travel(&form.at_half_tangent(t, rack));
    let h = 1e-3;
    let rise = (45.0 * (travel(tangent + h) - travel(tangent - h))
        - 9.0 * (travel(tangent + 2.0 * h) - travel(tangent - 2.0 * h))
        + (travel(tangent + 3.0 * h) - travel(tangent - 3.0 * h)))
        / (60.0 * h);
    1.0 / rise
}

fn judgement(guard: &'static str, reason: Rejection, slack: f64) -> Judgement {
    Judgement {
        guard,
        reason,
        slack,
    }
}

/// Returns the decisions of the checks at all waypoints of an accepted design, computed from their formulas and published
/// thresholds.
fn judge(
    tracker: &CornerTracker<'_>,
    rack: usize,
    points: &[Vector3<f64>],
    history: &[f64],
) -> Vec<Judgement> {
    let lanes = tracker.design(points);
    let (Method::Arm(_), Form::Arm(design)) = (&tracker.method, &lanes.form) else {
        unreachable!("the design has a closed form")
    };
    // The slope is relative to the size of the base design, as in `STEEPEST`.
    let base = template(tracker.mechanism.topology.name);
    let steepest = match tracker.drive {
        Drive::Travel => 3.0 / base.size(),
        Drive::ArmAngle => f64::INFINITY,
    };
    let mut judged = Vec::new();
    let mut last: [Option<(f64, f64, f64)>; 2] = [None; 2];
    for (place, tangent) in tracker.routes[rack].places.iter().zip(history) {
        let tangent = *tangent;
        let state = design.form.at_half_tangent(tangent, place.rack);
        let mut add = |guard, reason, slack| judged.push(judgement(guard, reason, slack));
        let squares = state.squares();
        for (guard, (square, whole)) in ["first sine", "second sine", "third sine"]
            .into_iter()
            .zip(squares)
        {
            // The threshold is a sine of 1/4.
            add(
                guard,
                Rejection::IllConditioned,
                above(square / whole, 0.0625),
            );
        }
        add(
            "upper end",
            Rejection::IllConditioned,
            above(state.upper_margin(), 0.25),
        );
        add(
            "turned far",
            Rejection::TurnedFar,
            below(tangent.abs(), 0.7),
        );
        let margin = squares.iter().map(|s| s.0).product::<f64>() * state.upper_margin();
        let before = last[place.leg.side()];
        let is_on_leg = place.leg != Leg::Rack;
        let rate = match before {
            Some((known, ..)) if is_on_leg => (tangent - known) / place.step,
            _ if tracker.drive == Drive::ArmAngle => 0.5,
            _ => slope_by_travel(&design.form, tangent, place.rack),
        };
        let ahead = match before {
            Some((_, known, _)) if is_on_leg => 2.0 * rate - known,
            _ => rate,
        };
        add("steep", Rejection::FoldNear, below(ahead.abs(), steepest));
        if let Some((known_tangent, known_rate, known_margin)) = before {
            let [low, high] = steady(rate, known_rate);
            add("slope halves", Rejection::ChangedTooMuch, low);
            add("slope doubles", Rejection::ChangedTooMuch, high);
            let [low, high] = steady(margin, known_margin);
            add("margin halves", Rejection::ChangedTooMuch, low);
            add("margin doubles", Rejection::ChangedTooMuch, high);
            let turned = (tangent - known_tangent).abs();
            add(
                "turned far in a step",
                Rejection::TurnedFar,
                below(turned, 0.1),
            );
        }
        let now = Some((tangent, rate, margin));
        match place.leg {
            Leg::Rack => last = [now; 2],
            leg => last[leg.side()] = now,
        }
    }
    judged
}

/// For each of these checks there is a strut that only this check rejects, at its published threshold. For some checks between
/// two waypoints the search lines contain no such design; `a_step_is_guarded_at_its_thresholds` tests these checks. No design
/// is rejected for a far rotation in one step of a leg:
///
/// - Travel: a step is at most 0.02 sizes, and the extrapolated slope is below 3 per size. Let r be the slope before the step
///   and r' the slope of the step. Then 2 r' - r < 3 and r < 3 give r' < 3. So the tangent changes by less than 0.06 < 0.1.
/// - Arm's angle: a step of 0.02 rad with a tangent below 0.7 changes it by less than 0.01 (1 + 0.49) < 0.1.
/// - Rack: a step of the rack alone could rotate the arm that far if the wheel rose 1.7 times as fast as the rack moves.
#[test]
fn every_guard_rejects_a_design_alone() {
    let suspension = template("macpherson");
    let mut all: BTreeMap<&str, usize> = BTreeMap::new();
    for (drive, lines) in [(Drive::Travel, 400), (Drive::ArmAngle, 150)] {
        for (guard, count) in boundaries(&suspension, drive, lines, judge) {
            *all.entry(guard).or_insert(0) += count;
        }
    }
    for guard in [
        "first sine",
        "second sine",
        "upper end",
        "steep",
        "margin halves",
        "margin doubles",
    ] {
        assert!(
            all.contains_key(guard),
            "{guard} rejects no design alone: {all:?}"
        );
    }
}

/// In at least one direction, an arm rotates from its design position until the tangent of half its angle is 0.7, and no
/// farther.
#[test]
fn an_arm_is_followed_to_seventy_degrees() {
    let mut suspension = template("macpherson");
    // The strut and the tie rod beside the arm are long, so that they do not limit the motion.
    let at = |name: &str| suspension.mechanism.point(name).unwrap().0;
    let (top, inner, outer) = (at("strut_top"), at("tie_rod_inner"), at("tie_rod_outer"));
    let (front, joint) = (at("lower_arm_front"), at("lower_ball_joint"));
    suspension.design[top].z += suspension.design[top].z;
    let beside = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
    let (a, b) = (suspension.design[front], suspension.design[joint]);
    suspension.design[inner] = a + beside(-260.0, 0.0, 0.0);
    suspension.design[outer] = b + beside(-160.0, 0.0, 5.0);
    let far = 2.0 * 0.7_f64.atan();
    let mut ends = 0;
    for sign in [1.0, -1.0] {
        let mut last = None;
        for share in [0.5, 0.9, 1.0 - 1e-9, 1.0 + 1e-9] {
            let order = StationOrder::through(&[sign * share * far]);
            let (mechanism, design) = (&suspension.mechanism, &suspension.design);
            let tracker =
                CornerTracker::new(mechanism, design, Drive::ArmAngle, &order, &[0.0]).unwrap();
            let mut history = tracker.history(0.0_f64);
            let found = rejection(&tracker, 0, design, &mut history);
            match (share < 1.0, found) {
                (true, found) => last = found,
                (false, found) if last.is_none() => {
                    assert_eq!(found, Some(Rejection::TurnedFar));
                    ends += 1;
                }
                _ => {}
            }
        }
    }
    assert!(ends > 0, "only the check limits one direction");
}

/// The limit of the slope is relative to the size: the half tangent, tan(angle/2), may change by 3 per travel of one size. If the
/// arm's angle is the drive, there is no limit.
#[test]
fn steepness_is_measured_in_sizes() {
    for topology in ["macpherson", "double_wishbone"] {
        let suspension = template(topology);
        let size = suspension.size();
        let of = |drive| {
            let roles = Roles::of(&suspension.mechanism).unwrap();
            ByArm::of(roles, &suspension.design, drive, size).unwrap()
        };
        assert_eq!(of(Drive::Travel).steepest, 3.0 / size);
        assert_eq!(of(Drive::ArmAngle).steepest, f64::INFINITY);
    }
}

/// Tests the checks between two waypoints, each at its threshold while all other checks accept.
#[test]
fn a_step_is_guarded_at_its_thresholds() {
    let before = BranchGuard {
        tangent: 0.3,
        rate: 1.5,
        margin: 0.8,
    };
    let step = |change: fn(&mut BranchGuard<f64>, f64), by: f64| {
        let mut guard = before;
        change(&mut guard, by);
        reason(|accepted| guard.check_step(&before, accepted))
    };
    let changed = Some(Rejection::ChangedTooMuch);
    let scale_rate = |guard: &mut BranchGuard<f64>, by: f64| guard.rate *= by;
    let scale_margin = |guard: &mut BranchGuard<f64>, by: f64| guard.margin *= by;
    for scale in [scale_rate, scale_margin] {
        for by in [0.500_001, 1.0, 1.999_999] {
            assert_eq!(step(scale, by), None, "{by}");
        }
        for by in [-1.0, 0.0, 0.499_999, 2.000_001, f64::INFINITY, f64::NAN] {
            assert_eq!(step(scale, by), changed, "{by}");
        }
    }
    let turn = |guard: &mut BranchGuard<f64>, by: f64| guard.tangent += by;
    for by in [0.099_999, -0.099_999, 0.0] {
        assert_eq!(step(turn, by), None, "{by}");
    }
    for by in [0.100_001, -0.100_001, f64::NAN] {
        assert_eq!(step(turn, by), Some(Rejection::TurnedFar), "{by}");
    }
    // The slope is extrapolated by its change since the previous waypoint: 2 r' - r.
    let slope = |rate: f64| {
        let guard = BranchGuard { rate, ..before };
        reason(|accepted| guard.check_slope(&before, 2.5, accepted))
    };
    for rate in [1.999_999, 0.0, -0.499_999] {
        assert_eq!(slope(rate), None, "{rate}");
    }
    for rate in [2.000_001, -0.500_001, f64::NAN] {
        assert_eq!(slope(rate), Some(Rejection::FoldNear), "{rate}");
    }
}

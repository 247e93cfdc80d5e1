//! Tests of the search for the smallest change: the misfit of the design that it keeps, and the messages about this
//! design.

use super::edited;
use super::still::{best, stored, tuned};
use hardpoint::optimise::{Assessment, Constrained, Control, Direction, Objective, TargetLayout};
use hardpoint::optimise::{Termination, tune};
use hardpoint::report::TuningSummary;
use hardpoint::study::{Optimise, Study};
use nalgebra::DVector;

const STRUT: &str = "macpherson_front.toml";
const TIE_ROD: &str = "optimise.variables=[\
    { hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-10.0, 10.0] }, \
    { hardpoint = \"tie_rod_outer\", axis = \"z\", range = [-10.0, 10.0] }]";
const TOE: &str = "optimise.targets=[\
    { characteristic = \"toe\", at = 30.0, value = 0.2, tolerance = 0.01 }]";

/// A converged tuning keeps its design, however small `good_enough` is. The misfit exceeds `good_enough` by at most
/// 1e-7.
#[test]
fn a_tiny_good_enough_keeps_the_design_found() {
    for good_enough in [1e-13, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-4] {
        let number = format!("optimise.good_enough={good_enough:e}");
        let tuning = tuned(&edited(STRUT, &[TIE_ROD, TOE, &number]));
        let kept = tuning.best.as_ref();
        let misfit = kept.map(|best| best.after.misfit);
        assert!(
            misfit.is_some_and(|misfit| misfit <= good_enough + 1.01e-7),
            "{good_enough:e}: {misfit:?}"
        );
    }
}

/// A target that no variable affects prevents a good enough design. Then the misfit of the kept design is at most 1 %
/// above the smallest misfit of all targets together. The summary names the target that no variable affects.
#[test]
fn the_allowance_counts_targets_that_nothing_affects() {
    for (name, target) in [
        ("unaffected_camber.toml", "camber_deg"),
        ("unaffected_toe.toml", "toe_deg"),
    ] {
        let study = stored(name, &[]);
        let tuning = tuned(&study);
        let (kept, least) = (
            best(&tuning).misfit(),
            best(&tuned(&stored(name, &["optimise.good_enough=0"]))).misfit(),
        );
        assert_eq!(best(&tuning).termination, Termination::NearestOfTheBest);
        assert!(
            kept <= 1.01 * least * (1.0 + 1e-6),
            "{name}: {kept} {least}"
        );
        let optimise = study.optimise.as_ref().unwrap();
        let remarks = TuningSummary::of(&study, optimise, &tuning, None).remarks();
        let named = format!("no variable affects {target}");
        assert!(remarks.iter().any(|r| r.contains(&named)), "{remarks:?}");
    }
}

/// Misfit after a further descent from the design that a tuning kept, within the same ranges.
fn below(study: &Study, optimise: &Optimise, offsets: &[f64]) -> f64 {
    let mut lowered = Optimise {
        good_enough: 0.0,
        starts: 1,
        ..optimise.clone()
    };
    for (variable, offset) in lowered.variables.iter_mut().zip(offsets) {
        variable.range = variable.range.map(|end| end - offset);
    }
    let design = study.moved(offsets);
    let tuning = tune(&design.vehicle, &lowered, Control::default()).unwrap();
    best(&tuning).misfit()
}

/// If no design is good enough, a further descent from the kept design lowers the misfit by at most 1 %. So the search
/// for the smallest change did not leave the minimum with the smallest misfit, or it found a deeper minimum.
#[test]
fn a_descent_from_the_design_kept_gains_no_more_than_the_allowance() {
    for name in ["two_valleys.toml", "unaffected_camber.toml"] {
        let study = stored(name, &[]);
        let optimise = study.optimise.as_ref().unwrap();
        let tuning = tuned(&study);
        let kept = tuning.best.as_ref().unwrap();
        let least = below(&study, optimise, &kept.offsets);
        let misfit = kept.after.misfit;
        assert!(misfit <= 1.0102 * least, "{name}: {misfit} {least}");
    }
}

/// Searches for the smallest change converge along the limit of a constraint: the residual of the optimality conditions
/// is below 1e-6.
#[test]
fn smallest_changes_on_limits_are_known() {
    for name in [
        "kept_toe.toml",
        "kept_length.toml",
        "kept_wheelbase.toml",
        "corner.toml",
    ] {
        let tuning = tuned(&stored(name, &[]));
        let fit = best(&tuning);
        let known = [
            Termination::NearestGoodEnough,
            Termination::NearestOfTheBest,
        ];
        assert!(known.contains(&fit.termination), "{name}: {}", fit.ended());
        assert!(fit.residual.is_some_and(|r| r < 1e-6), "{:?}", fit.residual);
    }
}

/// The smallest misfit is at a bound. The design with the smallest change lies between this bound and the nominal
/// design, where the misfit is 1 % larger.
#[test]
fn the_way_back_from_a_bound_uses_the_whole_allowance() {
    let least = best(&tuned(&stored("corner.toml", &["optimise.good_enough=0"]))).clone();
    let kept = best(&tuned(&stored("corner.toml", &[]))).clone();
    assert_eq!(least.x[0], -10.0);
    assert!(kept.x[0] > -10.0 && kept.x[0] < 0.0, "{}", kept.x[0]);
    let allowed = 1.01 * least.misfit();
    assert!(
        (kept.misfit() / allowed - 1.0).abs() < 1e-6,
        "{}",
        kept.misfit()
    );
}

/// If a search is cut short, the tuning does not report its result as the smallest change. It also reports no residual
/// of optimality conditions.
#[test]
fn a_search_cut_short_has_no_residual() {
    let tuning = tuned(&stored(
        "kept_length.toml",
        &["optimise.max_iterations=100"],
    ));
    let fit = best(&tuning);
    assert_eq!(fit.termination, Termination::BestNotKnownNearest);
    assert_eq!(fit.residual, None);
    let words = "as good as the best; a slightly smaller change may exist";
    assert_eq!(fit.ended(), words);
}

/// The printed moves raise the misfit by at most 0.1 and violate no constraint, also if a constraint is active.
#[test]
fn printed_moves_keep_constraints() {
    let mut moves = 0;
    for name in ["kept_wheelbase.toml", "kept_toe.toml", "kept_length.toml"] {
        let study = stored(name, &[]);
        let optimise = study.optimise.as_ref().unwrap();
        let tuning = tuned(&study);
        let kept = tuning.best.as_ref().unwrap();
        let layout = TargetLayout::of(optimise, &study.vehicle);
        let mut problem = Objective::new(study.wheel(), &optimise.variables, &layout).unwrap();
        let shape = problem.shape();
        let mut at = Assessment::new(&shape);
        for direction in &kept.identifiability.unseen {
            for (free, sign) in direction.free.iter().zip([1.0, -1.0]) {
                let x =
                    DVector::from_column_slice(&kept.offsets) + &direction.change * (sign * free);
                problem.assess(&x, &mut at).unwrap();
                let misfit = at.goal.misfit();
                assert!(
                    misfit <= kept.after.misfit + Direction::RISE + 1e-9,
                    "{name}: {misfit}"
                );
                let violation = at.violation(shape.equalities, &[]);
                assert!(violation <= 0.01, "{name}: {violation}");
                moves += usize::from(*free > 0.01);
            }
        }
    }
    assert!(moves > 0, "no move to check");
}

/// A direction opposite to an axis is named as a direction, because the coordinate falls when the offset rises.
#[test]
fn a_direction_against_an_axis_is_no_axis() {
    let study = edited(
        STRUT,
        &["optimise.variables=[\
            { hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-10.0, 10.0] }, \
            { hardpoint = \"tie_rod_inner\", direction = [0.0, 0.0, -2.0], range = [-10.0, 10.0] }]"],
    );
    let variables = &study.optimise.as_ref().unwrap().variables;
    let ways: Vec<String> = variables.iter().map(|v| v.way()).collect();
    assert_eq!(ways, ["z", "along"]);
    let labels: Vec<String> = variables.iter().map(|v| v.label()).collect();
    assert_eq!(labels, ["tie_rod_inner_dz", "tie_rod_inner_along"]);
}

/// If a tuning ends at `good_enough`, it says why an active constraint has no price (change of the misfit per unit of
/// its limit). If a tuning ends at the smallest misfit, it states the price.
#[test]
fn a_binding_constraint_without_a_price_is_explained() {
    let of = |good_enough: &str| {
        let study = stored(
            "kept_toe.toml",
            &[good_enough, "optimise.side_effects=false"],
        );
        let optimise = study.optimise.as_ref().unwrap();
        TuningSummary::of(&study, optimise, &tuned(&study), None).remarks()
    };
    let explained = |remarks: &[String]| remarks.iter().any(|r| r.starts_with("no prices of"));
    let priced = |remarks: &[String]| {
        remarks
            .iter()
            .any(|r| r.starts_with("relaxing the constraint "))
    };
    let (at_level, at_minimum) = (of("optimise.good_enough=1"), of("optimise.good_enough=0"));
    assert!(explained(&at_level) && !priced(&at_level), "{at_level:?}");
    assert!(
        !explained(&at_minimum) && priced(&at_minimum),
        "{at_minimum:?}"
    );
}

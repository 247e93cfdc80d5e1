//! Tests of set-ups with whole shims, of weights of targets, and of the largest accepted adjustment.

use super::{assembler, parameter, plan, study};
use hardpoint::ask::Unit;
use hardpoint::assembly::{Rest, SetUp, SetUpError, Static, built_curves};
use hardpoint::characteristics::Characteristic;

const STUDY: &str = "double_wishbone_tolerance";

fn solved(overrides: &[&str]) -> Result<SetUp, SetUpError> {
    let study = study(STUDY, overrides);
    SetUp::solve(&study, study.setup.as_ref().unwrap(), &assembler(&study))
}

/// The allowed error for half a shim step is half the effect of a step, plus 1 %. A threaded adjuster increases this
/// error by the effect of half a sixteenth of a turn.
#[test]
fn half_steps_allow_half_effects() {
    let shim =
        "setup={adjust=[{shim=\"upper_ball_joint\",axis=\"y\",step=0.5}],want={camber=-1.5}}";
    let both = "setup={adjust=[{shim=\"upper_ball_joint\",axis=\"y\",step=0.5},\
                {length=\"tie_rod\",per_turn=2.0}],want={camber=-1.5,toe=-0.1}}";
    for (setup, has_thread) in [(shim, false), (both, true)] {
        let found = solved(&[setup]).unwrap();
        let by = &found.last().by;
        // The threaded adjuster corrects toe and changes camber slightly.
        let effect = if has_thread {
            by[0][0] - by[1][0] * by[0][1] / by[1][1]
        } else {
            by[0][0]
        };
        let allowed = 1.01 * 0.25 * effect.abs();
        assert!((found.allowed[0] / allowed - 1.0).abs() < 1e-9);
        let thread = if has_thread {
            1.01 * 0.5 * 2.0 / 16.0 * by[1][0].abs()
        } else {
            0.0
        };
        let turned = found.allowed_rounded[0] - found.allowed[0];
        assert!((turned - thread).abs() < 1e-12, "{turned} {thread}");
    }
}

/// A set-up counts as successful if each error is within half a shim step. If the adjustments cannot reach a target at
/// all, the set-up is not successful, however coarse the shims are.
#[test]
fn half_steps_of_shims_do_not_fail_a_set_up() {
    let adjust = "setup.adjust=[{length=\"pushrod\",per_turn=2.5},{shim=\"upper_ball_joint\",axis=\"y\",step=1.0}]";
    for camber in (0..40).map(|k| -1.3 - 0.011 * f64::from(k)) {
        let want = format!("setup.want={{camber={camber:?}}}");
        let found = solved(&[adjust, &want]).unwrap();
        assert!(
            found.is_met(),
            "{camber}: {:?} {:?}",
            found.misses(),
            found.allowed
        );
        // Half a shim of 1 mm changes camber by 0.115 deg at 0.23 deg/mm.
        for (allowed, most) in found.allowed.iter().zip([0.13, 0.0, 0.0, 0.0, 0.0]) {
            assert!(*allowed <= most, "{:?}", found.allowed);
        }
    }
    let want = "setup.want={camber=-1.3,toe=3.0}";
    let found = solved(&[adjust, want]).unwrap();
    assert!(!found.is_met());
    let toe = Static::Characteristic(Characteristic::Toe);
    let place = found.statics.iter().position(|s| *s == toe).unwrap();
    assert!(
        !found.met()[place]
            && !found.met_rounded()[place]
            && found.misses()[place].unwrap().abs() > 1.0
    );
}

/// The program accepts an adjustment up to a tenth of the suspension size. It refuses a larger one and states its
/// amount.
#[test]
fn adjustments_beyond_a_tenth_of_the_size_are_refused() {
    let adjust = "setup.adjust=[{shim=\"upper_ball_joint\",axis=\"y\"}]";
    let plain = study(
        STUDY,
        &[
            "outputs.characteristics=[\"camber\"]",
            "motion.travel=[0.0]",
        ],
    );
    let assembler = assembler(&plain);
    let size = plain.wheel().size();
    let at = |share: f64| {
        let mut parts = assembler.drawn().clone();
        let ball_joint = parameter(&assembler, "upper_ball_joint", Some("y"));
        parts.change(&assembler.suspension().mechanism, ball_joint, share * size);
        let built = assembler.build(&parts, Rest::Height(0.0)).unwrap();
        let found = built_curves(&assembler, &built, &plan(&plain), &[]).unwrap();
        let camber = found.curves.stations[0].values[0].unwrap();
        let want = format!("setup.want={{camber={camber:?}}}");
        let found = solved(&[adjust, &want, "setup.ride_height_change=0.0"]);
        found.map(|found| found.last().amounts[0] / size)
    };
    assert!((at(-0.09).unwrap() + 0.09).abs() < 1e-9);
    match at(-0.11) {
        Err(SetUpError::Absurd {
            adjustment: 0,
            amount,
        }) => assert!((amount / size + 0.11).abs() < 1e-9),
        other => panic!("{other:?}"),
    }
}

/// One shim cannot meet targets for camber, scrub radius and bump steer together. The set-up minimises a sum of
/// squares. In this sum, 0.1 deg counts as much as 1 mm and as 0.001 deg/mm.
#[test]
fn a_tenth_of_a_degree_counts_as_a_millimetre() {
    let found = solved(&[
        "setup.adjust=[{shim=\"upper_ball_joint\",axis=\"y\",step=1e-4}]",
        "setup.want={camber=-2.5,scrub_radius=20.0,bump_steer=0.01}",
        "setup.ride_height_change=0.0",
    ]);
    let found = found.unwrap();
    let (errors, by) = (found.misses(), &found.last().by[0]);
    let (mut slope, mut curvature, mut targets) = (0.0, 0.0, 0);
    for ((of, error), by) in found.statics.iter().zip(errors).zip(by) {
        let weight = match of.unit() {
            Unit::Angle => 1.0 / 0.1,
            Unit::Length => 1.0,
            Unit::AnglePerLength => 1.0 / 1e-3,
            other => panic!("{other:?}"),
        };
        if let Some(error) = error {
            slope += weight * weight * error * by;
            curvature += (weight * by).powi(2);
            targets += 1;
        }
    }
    assert_eq!(targets, 3);
    // The continuous optimum is within one shim step.
    assert!((slope / curvature).abs() < 1e-4, "{}", slope / curvature);
}

/// Smallest visible error in degrees.
const VISIBLE: f64 = 0.005;

const SHIMS: [(&str, &str, f64); 5] = [
    ("upper_ball_joint", "y", 0.5),
    ("upper_arm_front", "y", 0.7),
    ("upper_arm_rear", "y", 0.3),
    ("tie_rod_inner", "y", 0.4),
    ("tie_rod_inner", "z", 1.0),
];

/// The set-up first finds the smallest adjustment that meets the targets. It then rounds each amount up or down to
/// whole shims. No other rounding has a visibly smaller error than that of the set-up.
#[test]
fn whole_shims_are_the_best_roundings() {
    let adjust = |with_steps: bool| {
        let all = SHIMS.map(|(point, axis, step)| {
            let step = if with_steps {
                format!(",step={step:?}")
            } else {
                String::new()
            };
            format!("{{shim={point:?},axis={axis:?}{step}}}")
        });
        format!("setup.adjust=[{}]", all.join(","))
    };
    let at_rest = study(
        STUDY,
        &[
            "outputs.characteristics=[\"camber\",\"toe\",\"caster\"]",
            "motion.travel=[0.0]",
        ],
    );
    let assembler = assembler(&at_rest);
    let mechanism = &assembler.suspension().mechanism;
    let plan = plan(&at_rest);
    for wanted in [[-2.3, 0.1, 4.0], [-1.7, -0.2, 4.4], [-2.05, 0.33, 3.7]] {
        let [camber, toe, caster] = wanted;
        let want = format!("setup.want={{camber={camber:?},toe={toe:?},caster={caster:?}}}");
        let set_up = |with_steps: bool| {
            let adjust = adjust(with_steps);
            solved(&[&adjust, &want, "setup.ride_height_change=0.0"]).unwrap()
        };
        let (real, found) = (set_up(false), set_up(true));
        // Sum of squared errors for given whole shims.
        let error = |amounts: [f64; 5]| {
            let mut parts = assembler.drawn().clone();
            for ((point, axis, _), amount) in SHIMS.into_iter().zip(amounts) {
                parts.change(mechanism, parameter(&assembler, point, Some(axis)), amount);
            }
            let built = assembler.build(&parts, Rest::Height(0.0)).unwrap();
            let found = built_curves(&assembler, &built, &plan, &[]).unwrap();
            let values = &found.curves.stations[0].values;
            let errors = values.iter().zip(wanted).map(|(v, w)| v.unwrap() - w);
            errors.map(|error| error * error).sum::<f64>()
        };
        let own: [f64; 5] = found.last().amounts[..].try_into().unwrap();
        let reported = found.misses().iter().flatten().map(|e| e * e).sum::<f64>();
        assert!((error(own) / reported - 1.0).abs() < 1e-9, "{reported}");
        for choice in 0..32_u32 {
            let rounded = std::array::from_fn(|k| {
                let step = SHIMS[k].2;
                ((real.last().amounts[k] / step).floor() + f64::from(choice >> k & 1)) * step
            });
            let other = error(rounded);
            assert!(
                other.sqrt() >= reported.sqrt() - VISIBLE,
                "{wanted:?} {rounded:?} {own:?}: {other} {reported}"
            );
        }
    }
}

/// The set-up omits a shim whose step improves no target visibly. Along x, the lower ball joint hardly affects camber:
/// one shim would improve camber by 0.0006 degrees.
#[test]
fn a_shim_without_visible_effect_is_left_out() {
    let shims = [
        ("upper_ball_joint", "y", 0.5),
        ("lower_ball_joint", "x", 0.4),
    ];
    let adjust = |count: usize| {
        let all = shims[..count].iter();
        let all = all
            .map(|(point, axis, step)| format!("{{shim={point:?},axis={axis:?},step={step:?}}}"));
        format!("setup.adjust=[{}]", all.collect::<Vec<_>>().join(","))
    };
    let mut left_out = 0;
    for camber in [-1.9, -1.62, -2.33, -2.07] {
        let want = format!("setup.want={{camber={camber:?}}}");
        let with = |count: usize| {
            solved(&[&adjust(count), &want, "setup.ride_height_change=0.0"]).unwrap()
        };
        let (alone, both) = (with(1), with(2));
        let error = |found: &SetUp| found.misses()[0].unwrap().abs();
        assert!(error(&both) <= error(&alone) + VISIBLE);
        // The second shim is used only if it improves camber visibly.
        if both.last().amounts[1] == 0.0 {
            left_out += 1;
        } else {
            assert!(error(&both) < error(&alone) - VISIBLE, "{camber}");
        }
    }
    assert!(left_out > 0);
}

/// If whole shims can meet the targets exactly, the set-up finds these shims. It then meets the targets up to rounding
/// errors.
#[test]
fn planted_whole_shims_are_found() {
    let adjust = "setup.adjust=[{shim=\"upper_ball_joint\",axis=\"y\",step=0.5}]";
    let level = "setup.ride_height_change=0.0";
    for steps in [-3.0, 1.0, 4.0] {
        let camber = {
            let plain = study(
                STUDY,
                &[
                    "outputs.characteristics=[\"camber\"]",
                    "motion.travel=[0.0]",
                ],
            );
            let assembler = assembler(&plain);
            let mut parts = assembler.drawn().clone();
            let ball_joint = parameter(&assembler, "upper_ball_joint", Some("y"));
            parts.change(&assembler.suspension().mechanism, ball_joint, 0.5 * steps);
            let built = assembler.build(&parts, Rest::Height(0.0)).unwrap();
            let found = built_curves(&assembler, &built, &plan(&plain), &[]).unwrap();
            found.curves.stations[0].values[0].unwrap()
        };
        let want = format!("setup.want={{camber={camber:?}}}");
        let found = solved(&[adjust, &want, level]).unwrap();
        assert_eq!(found.last().amounts[0] / 0.5, steps);
        assert!(found.misses()[0].unwrap().abs() < 1e-12);
    }
}

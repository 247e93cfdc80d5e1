//! Tests that the program computes only the effects that a study requests. The test reads the counts of the work done.

use crate::support::study;
use hardpoint::characteristics::{Characteristic, Constants, Slots, WheelReading};
use hardpoint::curves::{Curves, curves};
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::mechanism::Work;
use hardpoint::model::Drive;
use hardpoint::plan::Plan;
use hardpoint::solve::Solver;
use hardpoint::study::Study;

fn run(study: &Study) -> Curves {
    let found = curves(study.wheel(), &Plan::of(study.one_wheel().unwrap())).unwrap();
    assert_eq!(found.failed(), 0);
    found
}

/// Returns the work counts of a sample study with only these characteristics, at 41 travels.
fn work(name: &str, characteristics: &str, more: &[&str]) -> Work {
    let characteristics = format!("outputs.characteristics={characteristics}");
    let mut overrides = vec![
        "motion.rack=0.0",
        "motion.travel={from=-60.0,to=60.0,steps=41}",
        "outputs.points=[]",
        "outputs.order=\"position\"",
        "outputs.sensitivities=false",
        &characteristics,
    ];
    overrides.extend(more);
    run(&study(name, &overrides)).work
}

const STRUT: &str = "macpherson_solve.toml";
const WISHBONE: &str = "double_wishbone_solve.toml";
const FIVE_LINK: &str = "five_link_solve.toml";
const STATIONS: u64 = 41;

/// The closed form needs no linear algebra for a position. The single factorisation belongs to the design position,
/// which the program evaluates once.
#[test]
fn camber_alone_takes_no_velocity_analysis() {
    for name in [STRUT, WISHBONE] {
        let work = work(name, "[\"camber\"]", &[]);
        assert_eq!(work.factorisations, 1, "{name}");
        assert_eq!(work.right_hand_sides, 0, "{name}");
        assert_eq!(work.newton_iterations, 0, "{name}");
        assert_eq!(work.gradient_rows, 0, "{name}");
        assert_eq!(work.characteristic_gradients, 0, "{name}");
        assert_eq!(work.characteristic_evaluations, STATIONS, "{name}");
        assert_eq!(work.closed_form_solves, STATIONS, "{name}");
    }
}

#[test]
fn camber_gain_takes_one_right_hand_side_more_for_each_pose() {
    for name in [STRUT, WISHBONE, FIVE_LINK] {
        let without = work(name, "[\"camber\"]", &[]);
        let with = work(name, "[\"camber_gain\"]", &[]);
        assert_eq!(
            with.right_hand_sides - without.right_hand_sides,
            STATIONS,
            "{name}"
        );
        // The condition number uses the matrix factors of Newton's method. The closed form needs no factors.
        assert_eq!(with.factorisations, without.factorisations, "{name}");
        assert_eq!(with.newton_iterations, without.newton_iterations, "{name}");
        // The evaluation for the condition number also computes the derivatives.
        assert_eq!(
            with.closed_form_evaluations, without.closed_form_evaluations,
            "{name}"
        );
    }
}

/// For each order of derivatives, the program solves the same Jacobian with one more right-hand side.
#[test]
fn orders_are_right_hand_sides_of_one_jacobian() {
    let at = |order: &str| {
        work(
            STRUT,
            "[\"camber\"]",
            &[&format!("outputs.order=\"{order}\"")],
        )
    };
    let [position, velocity, acceleration] = ["position", "velocity", "acceleration"].map(at);
    assert_eq!(
        velocity.right_hand_sides,
        position.right_hand_sides + STATIONS
    );
    assert_eq!(
        acceleration.right_hand_sides,
        position.right_hand_sides + 2 * STATIONS
    );
    assert_eq!(acceleration.factorisations, position.factorisations);
    assert_eq!(
        acceleration.closed_form_evaluations,
        velocity.closed_form_evaluations
    );
    // One evaluation gives a value and its derivatives.
    assert_eq!(
        acceleration.characteristic_evaluations,
        position.characteristic_evaluations
    );
}

/// The cost of the adjoint method does not depend on the number of variables. Only the work after it is proportional to
/// that number.
#[test]
fn sensitivities_to_one_point_do_not_cost_those_of_nine() {
    let by = |points: &str| {
        let sensitivities = format!("outputs.sensitivities={points}");
        work(STRUT, "[\"camber\", \"toe\"]", &[&sensitivities])
    };
    let all = by("true");
    let one = by("[\"tie_rod_inner\"]");
    let none = by("false");
    assert_eq!(all.gradient_rows, 2 * 6 * STATIONS);
    // Only the equation of the tie rod depends on the position of the tie rod's inner end.
    assert_eq!(one.gradient_rows, 2 * STATIONS);
    assert_eq!(none.gradient_rows, 0);
    // Each output needs one right-hand side, for any number of coordinates.
    for work in [all, one] {
        assert_eq!(work.right_hand_sides, 2 * STATIONS);
        // The design position, which the program solves first, needs one more factorisation.
        assert_eq!(work.factorisations, STATIONS + 1);
    }
}

/// Sensitivities to some requested points have the same bits as if all points are requested.
#[test]
fn sensitivities_to_some_points_are_those_among_all() {
    for name in [STRUT, WISHBONE, FIVE_LINK, "semi_trailing_arm_solve.toml"] {
        let of = |what: &str| {
            study(
                name,
                &[
                    "outputs.characteristics=[\"camber\", \"toe\", \"bump_steer\"]",
                    "outputs.order=\"velocity\"",
                    &format!("outputs.sensitivities={what}"),
                ],
            )
        };
        let all = run(&of("true")).sensitivities;
        let mechanism = of("true").into_wheel().mechanism;
        let mut compared = 0;
        for (id, point) in mechanism.points.iter().enumerate() {
            if !mechanism
                .topology
                .hardpoints
                .iter()
                .any(|h| h.name == point.name)
            {
                continue;
            }
            let some = run(&of(&format!("[\"{}\"]", point.name))).sensitivities;
            let same: Vec<_> = all.iter().filter(|s| s.point.0 == id).collect();
            assert!(!some.is_empty());
            assert_eq!(some.iter().collect::<Vec<_>>(), same, "{}", point.name);
            compared += 1;
        }
        assert!(compared >= 4, "{name}: {compared}");
    }
}

/// If no requested output uses the rack, the spring or the steering axis, the program does not compute them.
#[test]
fn what_nothing_reads_is_not_computed() {
    for name in [STRUT, FIVE_LINK] {
        let study = study(name, &["outputs.characteristics=[\"camber\"]"]);
        let suspension = study.wheel();
        let plan = Plan::of(study.one_wheel().unwrap());
        assert_eq!(
            plan.reads,
            Slots::default().with(Characteristic::Camber.info().reads)
        );
        let solver = Solver::new(&suspension.mechanism, &suspension.design).unwrap();
        let design_series = DesignSeries::<1>::new(&suspension.mechanism, &suspension.design)
            .with_steering_axis(plan.reads_steering_axis());
        let point = MotionPoint {
            drive: Drive::Travel,
            value: 0.0,
            rack: 0.0,
        };
        let pose = solver.design_pose();
        let motion = point.along_drive();
        let at = solver
            .configuration_series(&design_series, &pose, &motion)
            .unwrap();
        assert!(at.steering.is_none());
        let view = WheelReading::reading(&at, Constants::default(), plan.reads);
        for c in Characteristic::ALL {
            let value = view.characteristic(*c)[0];
            let is_known = c.info().reads.iter().all(|slot| plan.reads.contains(*slot));
            assert_eq!(value.is_finite(), is_known, "{}", c.info().name);
        }
    }
}

/// An option that is present in the study but off costs as little as an absent option.
#[test]
fn what_is_declared_but_off_costs_nothing() {
    let declared = study(
        STRUT,
        &[
            "outputs={characteristics=[\"camber\"], order=\"position\", sensitivities=false, certify=false, points=[], knuckle=false}",
            "motion.rack=0.0",
            "vehicle={wheelbase=2600.0, track=1520.0, cg_height=500.0, brake_share_front=0.65}",
        ],
    );
    let plain = study(
        STRUT,
        &["outputs={characteristics=[\"camber\"]}", "motion.rack=0.0"],
    );
    assert_eq!(run(&declared).work, run(&plain).work);
    let (a, b) = (
        Plan::of(declared.one_wheel().unwrap()),
        Plan::of(plain.one_wheel().unwrap()),
    );
    assert_eq!((a.coefficients, a.reads), (b.coefficients, b.reads));
    let on = |s: &Study| {
        let effects = Plan::of(s.one_wheel().unwrap()).effects(s).into_iter();
        effects.filter(|e| e.on).map(|e| e.name).collect::<Vec<_>>()
    };
    assert_eq!(on(&declared), ["position"]);
    assert_eq!(on(&plain), ["position"]);
}

/// All loads of a pose use one factorisation of the Jacobian. Each load adds one right-hand side.
#[test]
fn loads_share_the_factors_of_a_pose() {
    let with = |loads: usize| {
        let load = |i| format!("{{name=\"l{i}\", at=\"contact_point\", force=[0, 0, 1000]}}");
        let loads: Vec<String> = (0..loads).map(load).collect();
        let loads = format!("outputs.loads=[{}]", loads.join(", "));
        work(WISHBONE, "[\"camber\"]", &[&loads])
    };
    let [none, one, three] = [0, 1, 3].map(with);
    assert_eq!(none, work(WISHBONE, "[\"camber\"]", &[]));
    assert_eq!(one.factorisations - none.factorisations, STATIONS);
    assert_eq!(three.factorisations, one.factorisations);
    assert_eq!(one.right_hand_sides - none.right_hand_sides, STATIONS);
    assert_eq!(three.right_hand_sides - none.right_hand_sides, 3 * STATIONS);
    assert_eq!(one.closed_form_evaluations, none.closed_form_evaluations);
}

/// The plan names the line of the study that requests an effect.
#[test]
fn effects_are_on_for_a_reason() {
    let study = study(
        STRUT,
        &[
            "outputs={characteristics=[\"camber\", \"camber_gain\", \"caster\", \"motion_ratio\"], sensitivities=[\"strut_top\"]}",
            "motion.rack={from=-5.0, to=5.0, steps=3}",
        ],
    );
    let effects = Plan::of(study.one_wheel().unwrap()).effects(&study);
    let effect = |name: &str| effects.iter().find(|e| e.name == name).unwrap();
    for (name, reason) in [
        ("rack", "motion.rack"),
        ("rates", "camber_gain, motion_ratio"),
        ("sensitivities", "outputs.sensitivities"),
        ("steering axis", "caster"),
        ("spring", "motion_ratio"),
    ] {
        let effect = effect(name);
        assert!(effect.on, "{name}");
        assert!(effect.because.starts_with(reason), "{}", effect.because);
        let line = effect.because.split("(line ").nth(1).unwrap();
        let line: usize = line.trim_end_matches(')').parse().unwrap();
        let key = reason.split('.').next_back().unwrap();
        let written = study.text.lines().nth(line - 1).unwrap();
        assert!(
            written.contains(key.split(',').next().unwrap()),
            "{written}"
        );
    }
    for name in ["time", "curvature", "loads", "certificate"] {
        assert!(!effect(name).on, "{name}");
        assert_eq!(effect(name).cost, 0.0);
    }
}

//! Tests of set-ups: the assembled parts with their adjustments have the target static values.

use super::{assembler, parameter, study};
use crate::support::random::Random;
use hardpoint::assembly::{Built, Rest, SetUp, SetUpError, Static, built_curves};
use hardpoint::characteristics::Characteristic;
use hardpoint::model::{Axis, FrameConvention, LengthUnit, Side};
use hardpoint::plan::Plan;
use hardpoint::study::Study;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

fn solved(name: &str, overrides: &[&str]) -> SetUp {
    let study = study(name, overrides);
    SetUp::solve(&study, study.setup.as_ref().unwrap(), &assembler(&study)).unwrap()
}

fn value(found: &SetUp, of: Static) -> f64 {
    let place = found.statics.iter().position(|s| *s == of).unwrap();
    found.last().values[place]
}

/// With as many adjustments as targets, the set-up meets all targets up to rounding errors, and the spring keeps its nominal
/// length.
#[test]
fn wishes_are_met_exactly_where_there_are_as_many_adjustments() {
    let found = solved(
        "double_wishbone_tolerance",
        &[
            "setup.adjust=[{length=\"pushrod\"},{shim=\"upper_ball_joint\",axis=\"y\"},{length=\"tie_rod\"}]",
        ],
    );
    assert!(found.is_met());
    let met = [
        (Static::Characteristic(Characteristic::Camber), -1.5),
        (Static::Characteristic(Characteristic::Toe), -0.1),
        (Static::RideHeightChange, -5.0),
    ];
    for (of, wanted) in met {
        assert!((value(&found, of) - wanted).abs() < 1e-10, "{of:?}");
    }
    let study = study("double_wishbone_tolerance", &[]);
    let [upper, lower] =
        ["spring_upper", "spring_lower"].map(|n| study.wheel().mechanism.point(n).unwrap().0);
    let length =
        |design: &[hardpoint::number::Vector3<f64>]| (design[upper] - design[lower]).norm();
    let off = length(&study.wheel().design) - length(&found.last().built.suspension.design);
    assert!(off.abs() < 1e-10, "{off}");
}

/// The effect of an adjustment per length unit equals the slope of the static values. The slope of the ride height is
/// the negative of the slope of the wheel height.
#[test]
fn effects_are_slopes_of_the_static_values() {
    let name = "double_wishbone_tolerance";
    let study = study(name, &[]);
    let (assembler, setup) = (assembler(&study), study.setup.as_ref().unwrap());
    let found = SetUp::solve(&study, setup, &assembler).unwrap();
    for (k, adjustment) in setup.adjust.iter().enumerate() {
        // Finite differences of fourth order.
        let h = 0.05;
        let heights = [-2.0, -1.0, 1.0, 2.0].map(|step| {
            let mut parts = assembler.drawn().clone();
            let (parameter, share) = adjustment.change;
            parts.change(
                &assembler.suspension().mechanism,
                parameter,
                share * step * h,
            );
            -assembler.build(&parts, Rest::Spring(0.0)).unwrap().height
        });
        let [a, b, c, d] = heights;
        let slope = (a - 8.0 * b + 8.0 * c - d) / (12.0 * h);
        let exact = *found.drawn.by[k].last().unwrap();
        assert!(
            (slope - exact).abs() < 1e-7 * exact.abs().max(0.1),
            "{slope} {exact}"
        );
    }
}

/// A set-up uses whole shims. Its threaded adjusters compensate the rounding of the shims. The set-up names a target that
/// no adjustment changes.
#[test]
fn shims_come_whole_and_what_cannot_be_met_is_named() {
    let stepped = solved("double_wishbone_tolerance", &[]);
    let shims = stepped.last().amounts[1] / 0.5;
    assert!((shims - shims.round()).abs() < 1e-12);
    assert!(stepped.is_met());

    // With the tie rod alone, the set-up meets the toe target and leaves the camber target unmet.
    let alone = solved(
        "macpherson_tolerance",
        &[
            "setup.adjust=[{length=\"tie_rod\"}]",
            "setup.want={camber=-2.0,toe=0.1}",
        ],
    );
    assert!(!alone.is_met());
    let misses = alone.misses();
    assert!(misses[0].unwrap().abs() > 1.0 && misses[1].unwrap().abs() < 1e-9);

    // With more adjustments than targets, the smallest adjustments meet the targets.
    let more = solved("macpherson_tolerance", &["setup.want={toe=0.3}"]);
    assert!(more.is_met());
    let by = &more.drawn.by;
    let ratio = more.last().amounts[0] / more.last().amounts[1];
    assert!((ratio - by[0][1] / by[1][1]).abs() < 0.01, "{ratio}");
}

/// Whole shims may leave a camber error of at most half a shim step. The threaded adjusters still meet toe and ride height up to
/// rounding errors. The set-up adjusts toe last.
#[test]
fn shims_never_spoil_what_threads_can_meet() {
    let adjust = "setup.adjust=[{length=\"tie_rod\",per_turn=2.0},{length=\"pushrod\",per_turn=2.5},\
                  {shim=\"upper_ball_joint\",axis=\"y\",step=1.0}]";
    for camber in (0..20).map(|k| -1.3 - 0.022 * f64::from(k)) {
        let want = format!("setup.want={{camber={camber:?},toe=-0.1}}");
        let found = solved("double_wishbone_tolerance", &[adjust, &want]);
        assert_eq!(found.order, [2, 1, 0]);
        let misses = found.misses();
        assert!(misses[1].unwrap().abs() < 1e-9, "{misses:?}");
        assert!(misses[4].unwrap().abs() < 1e-9, "{misses:?}");
        // The shim changes camber by about 0.23 deg/mm.
        assert!(found.allowed[0] < 0.13 && found.allowed[1] == 0.0 && found.allowed[4] == 0.0);
        assert!(misses[0].unwrap().abs() <= found.allowed[0], "{misses:?}");
        assert!(found.is_met());
        // The error is at most about half a shim step, so no other number of shims is better.
        let step = found.last().by[2][0]
            - found.last().by[0][0] * found.last().by[2][1] / found.last().by[0][1];
        assert!(misses[0].unwrap().abs() < 0.55 * step.abs(), "{step}");
    }
}

/// Toe without a target stays constant if a tie rod can hold it. The ride height stays constant if a pushrod can hold
/// it.
#[test]
fn what_is_not_wanted_is_kept_by_its_own_thread() {
    let found = solved(
        "double_wishbone_tolerance",
        &[
            "setup={adjust=[{shim=\"upper_ball_joint\",axis=\"y\",step=0.5},{length=\"pushrod\"},{length=\"tie_rod\"}],\
           want={camber=-1.5}}",
        ],
    );
    let toe = Static::Characteristic(Characteristic::Toe);
    assert!((value(&found, toe) - found.drawn.values[1]).abs() < 1e-9);
    assert!(value(&found, Static::RideHeightChange).abs() < 1e-9);
    assert!(found.is_met());
}

/// A set-up counts as successful if each error is within half a shim step. If the adjustments cannot reach a target at
/// all, the set-up is not successful, however coarse the shims are.
#[test]
fn half_steps_of_shims_do_not_fail_a_set_up() {
    let adjust = "setup.adjust=[{length=\"pushrod\",per_turn=2.5},{shim=\"upper_ball_joint\",axis=\"y\",step=1.0}]";
    for camber in (0..40).map(|k| -1.3 - 0.011 * f64::from(k)) {
        let want = format!("setup.want={{camber={camber:?}}}");
        let found = solved("double_wishbone_tolerance", &[adjust, &want]);
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
    let found = solved("double_wishbone_tolerance", &[adjust, want]);
    assert!(!found.is_met());
    let toe = Static::Characteristic(Characteristic::Toe);
    let place = found.statics.iter().position(|s| *s == toe).unwrap();
    assert!(
        !found.met()[place]
            && !found.met_rounded()[place]
            && found.misses()[place].unwrap().abs() > 1.0
    );
}

/// The set-up names a target out of reach and the limit of the values that it can reach. It does not name targets
/// within reach.
#[test]
fn aims_out_of_reach_are_named_alone() {
    let case = |want: &str| {
        let study = study("double_wishbone_tolerance", &[want]);
        let setup = study.setup.as_ref().unwrap();
        match SetUp::solve(&study, setup, &assembler(&study)) {
            Err(SetUpError::OutOfReach(missed)) => missed,
            other => panic!("{other:?}"),
        }
    };
    for (want, name, sought) in [
        (
            "setup.want={camber=-90.3,toe=-5.0}",
            Characteristic::Camber,
            -90.3,
        ),
        (
            "setup.want={camber=-1.8,toe=85.0}",
            Characteristic::Toe,
            85.0,
        ),
    ] {
        let missed = case(want);
        assert_eq!(missed.len(), 1, "{missed:?}");
        assert_eq!(missed[0].of, Static::Characteristic(name));
        assert!((missed[0].wanted - sought).abs() < 1e-9);
        // Camber cannot exceed 90 degrees, at which the wheel lies on its side.
        assert!((missed[0].value - sought).abs() > 0.29, "{missed:?}");
    }
}

/// Points of a left wheel in millimetres, x forward, y left, z up, with their names.
type Points = [(&'static str, [f64; 3])];

/// The points of `studies/double_wishbone_tolerance.toml`.
const WISHBONE: &Points = &[
    ("upper_arm_front", [135.0, 265.0, 330.0]),
    ("upper_arm_rear", [-165.0, 270.0, 318.0]),
    ("upper_ball_joint", [-8.0, 545.0, 365.0]),
    ("lower_arm_front", [150.0, 215.0, 142.0]),
    ("lower_arm_rear", [-180.0, 220.0, 138.0]),
    ("lower_ball_joint", [6.0, 575.0, 130.0]),
    ("tie_rod_inner", [68.0, 230.0, 170.0]),
    ("tie_rod_outer", [75.0, 560.0, 165.0]),
    ("wheel_centre", [0.0, 620.0, 255.0]),
    ("pushrod_outer", [0.0, 530.0, 155.0]),
    ("pushrod_inner", [0.0, 265.0, 455.0]),
    ("rocker_pivot_front", [20.0, 205.0, 420.0]),
    ("rocker_pivot_rear", [-20.0, 205.0, 420.0]),
    ("spring_lower", [0.0, 210.0, 485.0]),
    ("spring_upper", [0.0, 30.0, 470.0]),
];

/// Wheel with parallelograms in the plane x = 0. Arms and tie rod are parallel and equally long, so the carrier
/// translates without rotation.
const PLANAR: &Points = &[
    ("upper_arm_front", [135.0, 195.0, 342.0]),
    ("upper_arm_rear", [-165.0, 195.0, 342.0]),
    ("upper_ball_joint", [0.0, 555.0, 330.0]),
    ("lower_arm_front", [150.0, 215.0, 142.0]),
    ("lower_arm_rear", [-180.0, 215.0, 142.0]),
    ("lower_ball_joint", [0.0, 575.0, 130.0]),
    ("tie_rod_inner", [70.0, 205.0, 170.0]),
    ("tie_rod_outer", [70.0, 565.0, 158.0]),
    ("wheel_centre", [0.0, 620.0, 255.0]),
    ("pushrod_outer", [0.0, 530.0, 155.0]),
    ("pushrod_inner", [0.0, 265.0, 455.0]),
    ("rocker_pivot_front", [20.0, 205.0, 420.0]),
    ("rocker_pivot_rear", [-20.0, 205.0, 420.0]),
    ("spring_lower", [0.0, 210.0, 485.0]),
    ("spring_upper", [0.0, 30.0, 470.0]),
];

/// Frame convention with a side and a unit: signs of the axes as in the manual, and length units per millimetre.
#[derive(Clone, Copy, Debug)]
struct Door {
    frame: FrameConvention,
    side: Side,
    unit: LengthUnit,
}

impl Door {
    fn all() -> impl Iterator<Item = Door> {
        FrameConvention::ALL.into_iter().flat_map(|frame| {
            Side::ALL.into_iter().flat_map(move |side| {
                let units = LengthUnit::ALL.into_iter();
                units.map(move |unit| Door { frame, side, unit })
            })
        })
    }

    fn signs(self) -> [f64; 3] {
        let [x, y, z] = match self.frame {
            FrameConvention::Iso8855 => [1.0, 1.0, 1.0],
            FrameConvention::SaeJ670 => [1.0, -1.0, -1.0],
            FrameConvention::XRear => [-1.0, -1.0, 1.0],
        };
        match self.side {
            Side::Left => [x, y, z],
            Side::Right => [x, -y, z],
        }
    }

    /// One millimetre in the unit.
    fn millimetre(self) -> f64 {
        match self.unit {
            LengthUnit::Millimetre => 1.0,
            LengthUnit::Metre => 1e-3,
            LengthUnit::Inch | LengthUnit::InchPound => 1.0 / 25.4,
        }
    }

    fn study(self, points: &Points, set_up: &str) -> Study {
        let side = match self.side {
            Side::Left => "left",
            Side::Right => "right",
        };
        let (mm, unit, frame) = (self.millimetre(), self.unit.symbol(), self.frame.name());
        let mut text = format!(
            "[suspension]\ntopology = \"double_wishbone\"\nside = \"{side}\"\nlength_unit = \"{unit}\"\n\
             frame = \"{frame}\"\n[suspension.hardpoints]\n"
        );
        for (name, point) in points {
            let signs = self.signs();
            let [x, y, z]: [f64; 3] = std::array::from_fn(|k| signs[k] * point[k] * mm);
            writeln!(text, "{name} = [{x:?}, {y:?}, {z:?}]").unwrap();
        }
        write!(
            text,
            "[wheel]\nradius = {:?}\nstatic_camber = -1.0\nstatic_toe = 0.1\n[motion]\ntravel = [0.0]\n[outputs]\n\
             characteristics = [\"camber\", \"toe\", \"caster\"]\n[setup]\n{set_up}",
            255.0 * mm
        )
        .unwrap();
        Study::from_text("planted.toml", &text, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
    }
}

/// A longer pushrod raises the car by the amount from plane trigonometry. The spring keeps its length, so the rocker
/// does not turn, and the pushrod's inner end P is a point of the body. The pushrod's outer end Q turns about the arm's
/// axis A. The length |PQ| gives the angle at A by the law of cosines.
#[test]
fn the_ride_height_that_a_pushrod_gives_is_that_of_the_triangle() {
    let between = |a: [f64; 2], b: [f64; 2]| [b[0] - a[0], b[1] - a[1]];
    let norm = |v: [f64; 2]| v[0].hypot(v[1]);
    let (axis, joint) = ([215.0, 142.0], [575.0, 130.0]);
    let (outer, inner) = ([530.0, 155.0], [265.0, 455.0]);
    let (to_outer, to_inner) = (between(axis, outer), between(axis, inner));
    let length = norm(between(outer, inner));
    let angle = |length: f64| {
        let (r, d) = (norm(to_outer), norm(to_inner));
        ((r * r + d * d - length * length) / (2.0 * r * d)).acos()
    };
    let arm = between(axis, joint);
    let start = arm[1].atan2(arm[0]);
    for longer in [-6.0, -0.5, 0.4, 5.0] {
        // A longer rod turns the arm and the wheel downward.
        let down = angle(length + longer) - angle(length);
        let car_rises = norm(arm) * (start.sin() - (start - down).sin());
        assert!(car_rises * longer > 0.0 && down.abs() < PI / 8.0);
        for door in Door::all() {
            let (mm, rise) = (door.millimetre(), car_rises * door.millimetre());
            for wanted in [
                format!("ride_height_change = {rise:?}"),
                format!("travel = {:?}", -rise),
            ] {
                let set_up = format!("adjust = [{{ length = \"pushrod\" }}]\n{wanted}\n");
                let study = door.study(PLANAR, &set_up);
                let found = SetUp::solve(&study, study.setup.as_ref().unwrap(), &assembler(&study))
                    .unwrap();
                assert!(found.is_met());
                let amount = found.last().amounts[0] / mm;
                assert!((amount - longer).abs() < 1e-8, "{door:?} {amount} {longer}");
                // The effect per millimetre is positive: a longer rod raises the car.
                assert!(*found.drawn.by[0].last().unwrap() > 0.5);
                let centre = study.wheel().mechanism.point("wheel_centre").unwrap().0;
                let built = found.last().built.suspension.design[centre].z;
                let off = built - study.wheel().design[centre].z + rise;
                assert!(off.abs() < 1e-9 * mm, "{door:?} {off}");
            }
        }
    }
}

/// Static values of manually adjusted parts: camber, toe and caster in degrees.
fn values(study: &Study, built: &Built) -> [f64; 3] {
    let found = built_curves(
        &assembler(study),
        built,
        &Plan::of(study.one_wheel().unwrap()),
        &[],
    )
    .unwrap();
    let values = &found.curves.stations[0].values;
    [0, 1, 2].map(|k| values[k].unwrap())
}

/// The set-up finds rod and shim amounts that the test applied before, at both wheels, in every frame and unit. It finds shims
/// exactly, and rods up to rounding errors.
#[test]
fn planted_set_ups_are_recovered() {
    let mut random = Random(20);
    for door in Door::all() {
        let mm = door.millimetre();
        let adjust = format!(
            "adjust = [{{ length = \"tie_rod\", per_turn = {:?} }}, {{ shim = \"upper_ball_joint\", axis = \"y\", \
             step = {:?} }}, {{ length = \"pushrod\", per_turn = {:?} }}, {{ shim = \"upper_ball_joint\", axis = \
             \"x\", step = {:?} }}]\n",
            2.0 * mm,
            0.5 * mm,
            2.5 * mm,
            0.75 * mm
        );
        let planted_study = door.study(WISHBONE, &adjust);
        let assembler = assembler(&planted_study);
        let [x, y, _] = door.signs();
        for _ in 0..3 {
            let mut between = |most: f64| most * random.signed();
            let rods = [between(3.0) * mm, between(4.0) * mm];
            let shims = [between(7.0).round(), between(5.0).round()];
            let amounts = [rods[0], shims[0] * 0.5 * mm, rods[1], shims[1] * 0.75 * mm];
            let dimensions = [
                (parameter(&assembler, "tie_rod", None), 1.0),
                (parameter(&assembler, "upper_ball_joint", Some("y")), y),
                (parameter(&assembler, "pushrod", None), 1.0),
                (parameter(&assembler, "upper_ball_joint", Some("x")), x),
            ];
            let mut parts = assembler.drawn().clone();
            for ((dimension, sign), amount) in dimensions.into_iter().zip(amounts) {
                parts.change(&assembler.suspension().mechanism, dimension, sign * amount);
            }
            let built = assembler.build(&parts, Rest::Spring(0.0)).unwrap();
            let [camber, toe, caster] = values(&planted_study, &built);
            let rise = -built.height;
            let want = format!(
                "{adjust}want = {{ camber = {camber:?}, toe = {toe:?}, caster = {caster:?} }}\n\
                 ride_height_change = {rise:?}\n"
            );
            let study = door.study(WISHBONE, &want);
            let found = SetUp::solve(&study, study.setup.as_ref().unwrap(), &assembler).unwrap();
            assert!(found.is_met(), "{door:?} {:?}", found.misses());
            assert_eq!(found.order, [1, 3, 2, 0]);
            for (amount, planted) in found.last().amounts.iter().zip(amounts) {
                let off = (amount - planted).abs() / mm;
                assert!(off < 1e-7, "{door:?} {amount} {planted}");
            }
        }
    }
}

/// The reported values of a rounded set-up are correct: parts assembled with sixteenths of turns and whole shims have
/// these values. The rounded amounts are within half a step of the exact amounts.
#[test]
fn rounded_amounts_are_reported_as_they_assemble() {
    let mut random = Random(21);
    for _ in 0..10 {
        let mut between =
            |least: f64, most: f64| least + (most - least) * (0.5 + 0.5 * random.signed());
        let want = format!(
            "setup.want={{camber={:?},toe={:?}}}",
            between(-3.0, -1.0),
            between(-0.4, 0.4)
        );
        let height = format!("setup.ride_height_change={:?}", between(-12.0, 12.0));
        let overrides = [want.as_str(), height.as_str()];
        let study = study("double_wishbone_tolerance", &overrides);
        let assembler = assembler(&study);
        let found = SetUp::solve(&study, study.setup.as_ref().unwrap(), &assembler).unwrap();
        let [pushrod, shim, tie_rod] = found.rounded.amounts[..] else {
            panic!("three adjustments")
        };
        for (amount, increment) in [(pushrod, 2.5 / 16.0), (shim, 0.5), (tie_rod, 2.0 / 16.0)] {
            let steps: f64 = amount / increment;
            assert!((steps - steps.round()).abs() < 1e-12);
        }
        for (k, half) in [(0, 2.5 / 32.0), (1, 1e-12), (2, 2.0 / 32.0)] {
            let off = found.rounded.amounts[k] - found.last().amounts[k];
            assert!(off.abs() <= half + 1e-12, "{k} {off}");
        }
        // The steps apply these amounts one after another.
        for (place, step) in found.rounded_steps.iter().enumerate() {
            let done = &found.order[..=place];
            for (k, amount) in found.rounded.amounts.iter().enumerate() {
                let expected = if done.contains(&k) { *amount } else { 0.0 };
                assert_eq!(step.amounts[k], expected, "{place} {k}");
            }
        }
        let mut parts = assembler.drawn().clone();
        let mechanism = &assembler.suspension().mechanism;
        parts.change(mechanism, parameter(&assembler, "pushrod", None), pushrod);
        parts.change(
            mechanism,
            parameter(&assembler, "upper_ball_joint", Some(Axis::Y.name())),
            shim,
        );
        parts.change(mechanism, parameter(&assembler, "tie_rod", None), tie_rod);
        let built = assembler.build(&parts, Rest::Spring(0.0)).unwrap();
        assert!((found.rounded.values[4] + built.height).abs() < 1e-10);
        assert!(
            found.is_met(),
            "{:?} {:?}",
            found.misses_rounded(),
            found.allowed_rounded
        );
        let at_rest = super::study(
            "double_wishbone_tolerance",
            &[
                "motion.travel=[0.0]",
                "outputs.characteristics=[\"camber\",\"toe\",\"caster\"]",
            ],
        );
        let reported = &found.rounded.values;
        for (value, reported) in values(&at_rest, &built).into_iter().zip(reported) {
            assert!((value - reported).abs() < 1e-10, "{value} {reported}");
        }
    }
}

/// The effects of the steps add up to the change from the nominal design to the rounded set-up, and the instructions
/// state these effects.
#[test]
fn effects_of_the_steps_add_up_to_the_rounded_set_up() {
    let study = study("double_wishbone_tolerance", &[]);
    let found = hardpoint::set_up::set_up(&study, study.setup.as_ref().unwrap());
    let found = found.unwrap_or_else(|refusal| panic!("{}", refusal.reason()));
    let [summary] = &found.wheels[..] else {
        panic!("one wheel")
    };
    for (k, value) in summary.statics.iter().enumerate() {
        let effects = summary
            .adjustments
            .iter()
            .map(|step| step.effect[k].unwrap());
        let change = value.set_rounded.unwrap() - value.nominal.unwrap();
        let sum: f64 = effects.sum();
        assert!(
            (sum - change).abs() < 1e-12,
            "{}: {sum} {change}",
            value.column
        );
    }
    let camber = summary
        .statics
        .iter()
        .position(|value| value.column == "camber_deg");
    let shim = summary
        .adjustments
        .iter()
        .find(|step| step.shims.is_some())
        .unwrap();
    let change = shim.effect[camber.unwrap()].unwrap();
    let words = format!("camber {change:+.2} deg");
    assert!(
        shim.effect_in_words.contains(&words),
        "{words}: {}",
        shim.effect_in_words
    );
    // The joint moves relative to the wheel carrier, so a joint that moves inboard tilts the top of the wheel outboard.
    let is_inboard = shim.instruction.starts_with("move inboard");
    assert_eq!(is_inboard, change > 0.0, "{}", shim.instruction);
}

/// Instructions name the part relative to which a point moves. A ball joint and a bracket that move in the same direction
/// change camber in opposite directions, because the ball joint moves relative to the wheel carrier.
#[test]
fn shims_name_the_part_that_carries_the_point() {
    for (point, part, outboard_lowers_camber) in [
        ("upper_ball_joint", "wheel carrier", true),
        ("upper_arm_front", "chassis", false),
        ("tie_rod_inner", "rack", false),
    ] {
        let setup = format!(
            "setup={{ adjust = [{{ shim = \"{point}\", axis = \"y\", step = 0.1 }}], want = {{ toe = 0.2 }} }}"
        );
        let study = study("double_wishbone_tolerance", &[&setup]);
        let found = hardpoint::set_up::set_up(&study, study.setup.as_ref().unwrap());
        let found = found.unwrap_or_else(|refusal| panic!("{}", refusal.reason()));
        let summary = &found.wheels[0];
        let words = &summary.adjustments[0].instruction;
        assert!(
            words.ends_with(&format!(" mm, relative to the {part}")),
            "{words}"
        );
        assert!(summary.effects_note().unwrap().contains("relative to"));
        if part != "rack" {
            let camber = summary
                .statics
                .iter()
                .position(|s| s.column == "camber_deg");
            let effect = summary.adjustments[0].by_length[camber.unwrap()].unwrap();
            assert_eq!(effect < 0.0, outboard_lowers_camber, "{point} {effect}");
        }
    }
}

/// Text of an axle whose right wheel has its own tie rod. `signs` convert points of a left wheel to the axes of the frame.
fn differing_axle(frame: FrameConvention, signs: [f64; 3]) -> String {
    let points = [
        ("lower_arm_front", [120.0, 360.0, 195.0]),
        ("lower_arm_rear", [-260.0, 350.0, 205.0]),
        ("lower_ball_joint", [5.0, 705.0, 190.0]),
        ("strut_top", [-35.0, 575.0, 850.0]),
        ("strut_lower", [-11.0, 623.0, 370.0]),
        ("tie_rod_inner", [-110.0, 330.0, 243.0]),
        ("tie_rod_outer", [-130.0, 690.0, 240.0]),
        ("wheel_centre", [0.0, 760.0, 300.0]),
        ("spindle_inner", [-0.2, 660.0, 299.1]),
    ];
    let [x, y, z] = signs;
    let mut text = format!(
        "[suspension]\ntopology = \"macpherson\"\nframe = \"{}\"\n[suspension.hardpoints]\n",
        frame.name()
    );
    for (name, point) in points {
        let [px, py, pz] = point;
        writeln!(text, "{name} = [{:?}, {:?}, {:?}]", x * px, y * py, z * pz).unwrap();
    }
    write!(
        text,
        "[wheel]\nradius = 300.0\n[axle.right.hardpoints]\n\
         tie_rod_inner = [{:?}, {:?}, {:?}]\n[motion]\nroll = [0.0]\n[outputs]\n\
         characteristics = [\"toe\"]\n[setup]\nadjust = [\n  {{ length = \"tie_rod\" }},\n",
        x * -110.0,
        -y * 330.5,
        z * 243.0
    )
    .unwrap();
    text += "  { shim = \"strut_top\", axis = \"y\" },\n  { shim = \"tie_rod_inner\", axis = \"x\" } ]\n\
             want = { camber = -1.5, toe = 0.1 }\n";
    text
}

/// If the wheels of an axle differ, each wheel has its own instructions. Their directions are the directions in which
/// the points move on the car, in every frame.
#[test]
fn directions_of_each_wheel_are_those_of_its_points() {
    for (frame, signs) in [
        (FrameConvention::Iso8855, [1.0, 1.0, 1.0]),
        (FrameConvention::SaeJ670, [1.0, -1.0, -1.0]),
        (FrameConvention::XRear, [-1.0, -1.0, 1.0]),
    ] {
        let text = differing_axle(frame, signs);
        let study = Study::from_text("axle.toml", &text, Path::new("."));
        let study = study.unwrap_or_else(|e| panic!("{e}"));
        let found = hardpoint::set_up::set_up(&study, study.setup.as_ref().unwrap());
        let found = found.unwrap_or_else(|refusal| panic!("{}", refusal.reason()));
        assert_eq!(found.wheels.len(), 2);
        let [before, after] = [&study, &found.adjusted].map(|study| &study.axle().unwrap().axle);
        for (side, summary) in Side::ALL.into_iter().zip(&found.wheels) {
            let note = summary.effects_note().unwrap();
            assert_eq!(note.contains("right wheel"), side == Side::Right, "{note}");
            // The points describe a left wheel: y is positive outboard.
            let move_of = |point: &str| {
                let [before, after] = [before, after].map(|axle| {
                    let wheel = axle.suspension(side);
                    wheel.design[wheel.mechanism.point(point).unwrap().0]
                });
                after - before
            };
            let instruction = |name: &str| {
                let mut steps = summary.adjustments.iter();
                &steps
                    .find(|step| step.adjustment == name)
                    .unwrap()
                    .instruction
            };
            let (words, y) = (instruction("strut_top y"), move_of("strut_top").y);
            assert!(y.abs() > 1.0, "{side:?} {y}");
            let way = if y > 0.0 { "outboard" } else { "inboard" };
            assert!(
                words.starts_with(&format!("move {way}")),
                "{frame:?} {side:?}: {words} {y}"
            );
            let (words, x) = (instruction("tie_rod_inner x"), move_of("tie_rod_inner").x);
            let way = if x > 0.0 { "forward" } else { "rearward" };
            let is_moved = x.abs() > 1e-3;
            assert!(
                !is_moved || words.starts_with(&format!("move {way}")),
                "{frame:?} {side:?}: {words} {x}"
            );
        }
    }
}

//! Tests of the instructions of a set-up: effects of the steps, directions, and the part that carries a point.

use super::study;
use hardpoint::model::{FrameConvention, Side};
use hardpoint::study::Study;
use std::fmt::Write;
use std::path::Path;

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

/// Instructions name the part relative to which a point moves. A ball joint moves relative to the wheel carrier, a
/// bracket relative to the chassis. So the same direction has opposite effects on camber.
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
            assert!(x.abs() > 1e-3, "{side:?} {x}");
            assert!(
                words.starts_with(&format!("move {way}")),
                "{frame:?} {side:?}: {words} {x}"
            );
        }
    }
}

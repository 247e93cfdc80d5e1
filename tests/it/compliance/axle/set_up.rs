//! Tests of set-ups of axles with elastic parts: both wheels are in equilibrium together.

use crate::compliance::set_up::{
    LINKS, RUBBER, amount, at_rest, found, free, one, read_again, set,
};
use crate::compliance::support::{elastic, with};
use crate::support::larger;
use hardpoint::study::Study;
use hardpoint::tolerance::Problem;

const SUBFRAME: &str = "subframe_axle_compliance.toml";
/// Section of the study that the test replaces by the data of a different right wheel.
const MIRRORED: &str = "[axle]\nright = \"mirrored\"\n";

/// Without subframe and elastic rack, bushings do not couple the wheels of an axle, so the set-up equals that of one
/// wheel. With a subframe and an elastic rack, the set-up differs from that of one wheel. The left and the right wheel of
/// the adjusted axle still have the target values.
#[test]
fn both_wheels_of_an_axle_are_set_up_in_equilibrium() {
    let setup = "adjust = [{ length = \"tie_rod\" }, { shim = \"upper_ball_joint\", axis = \"y\" }]\nwant = { camber = -1.2, toe = 0.15 }";
    let wheel = found(&free(RUBBER, setup));
    let expected = ["tie_rod", "upper_ball_joint y"].map(|name| amount(one(&wheel), name));
    let axle = |is_coupled: bool| {
        let mut text = with(
            SUBFRAME,
            &format!("\n[outputs]\ncharacteristics = [\"camber\", \"toe\", \"spring_length\"]\n[setup]\n{setup}\n"),
        )
        .replace("\"at_design_load\"", "\"free\"");
        if !is_coupled {
            let (head, tail) = text.split_once("[subframe]").unwrap();
            let tail = tail.split_once("[bushings.lower_arm_front]").unwrap().1;
            text = format!("{head}[bushings.lower_arm_front]{tail}")
                .replace("rack_stiffness = 20000.0", "")
                .replace("column_stiffness = 2.0e6", "");
        }
        elastic(&text)
    };
    let alone = found(&axle(false));
    for (name, expected) in ["tie_rod", "upper_ball_joint y"].iter().zip(expected) {
        assert!(
            (amount(one(&alone), name) - expected).abs() < 1e-8,
            "{name}"
        );
    }
    assert_eq!(one(&alone).side.map(|side| side.name()), Some("both"));
    let study = axle(true);
    let coupled = found(&study);
    assert!((amount(one(&coupled), "tie_rod") - expected[0]).abs() > 1e-4);
    let again = read_again(&study, &coupled);
    let names = [
        "left_camber_deg",
        "right_camber_deg",
        "left_toe_deg",
        "right_toe_deg",
    ];
    let values = at_rest(&again, &names);
    for (value, want) in values.iter().zip([-1.2, -1.2, 0.15, 0.15]) {
        assert!((value - want).abs() < 1e-8, "{values:?}");
    }
    let own = at_rest(&coupled.adjusted, &names);
    assert!(
        own.iter().zip(&values).all(|(a, b)| (a - b).abs() < 1e-8),
        "{own:?}"
    );
}

/// If the wheels are different, the set-up adjusts both wheels together, each with its own adjustments. If left and right
/// are exchanged, the amounts are exchanged too.
#[test]
fn wheels_that_differ_are_set_up_as_a_whole() {
    let setup = "adjust = [{ length = \"tie_rod\", per_turn = 2.0 }, { shim = \"upper_ball_joint\", axis = \"y\" }]\nwant = { camber = -1.2, toe = 0.15 }";
    let study = |further: &str| {
        let outputs = "[\"camber\", \"toe\", \"spring_length\"]";
        let text = with(
            SUBFRAME,
            &format!("\n[outputs]\ncharacteristics = {outputs}\n{further}\n[setup]\n{setup}\n"),
        );
        let text = text.replace(MIRRORED, "");
        elastic(&text.replace("\"at_design_load\"", "\"free\""))
    };
    let soft = "[axle.right.bushings.lower_arm_rear]\nscale = [0.5, 0.5, 0.5, 0.5, 0.5, 0.5]\n";
    let right = study(soft);
    let whole = found(&right);
    let summary = one(&whole);
    assert!(summary.met && summary.side.is_none());
    for name in ["left_camber_deg", "right_camber_deg"] {
        assert!((set(summary, name) + 1.2).abs() < 1e-9, "{name}");
    }
    let [left, other] = ["left tie_rod", "right tie_rod"].map(|name| amount(summary, name));
    assert!((left - other).abs() > 1e-3, "{left} {other}");
    let again = read_again(&right, &whole);
    let names = [
        "left_camber_deg",
        "right_camber_deg",
        "left_toe_deg",
        "right_toe_deg",
    ];
    let values = at_rest(&again, &names);
    for (value, want) in values.iter().zip([-1.2, -1.2, 0.15, 0.15]) {
        assert!((value - want).abs() < 1e-8, "{values:?}");
    }
    // Gives the soft bushing to the left wheel instead.
    let text = right.text.replace(
        soft,
        "[axle.right.bushings.lower_arm_rear]\nscale = [2.0, 2.0, 2.0, 2.0, 2.0, 2.0]\n",
    );
    let text = text.replace(
        "[bushings.lower_arm_rear]\nstiffness = [700.0, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]",
        "[bushings.lower_arm_rear]\nstiffness = [350.0, 1250.0, 900.0, 4.0e4, 1.25e5, 1.25e5]",
    );
    let exchanged = found(&elastic(&text));
    let exchanged = one(&exchanged);
    for part in ["tie_rod", "upper_ball_joint y"] {
        for [a, b] in [["left", "right"], ["right", "left"]] {
            let [a, b] = [
                amount(summary, &format!("{a} {part}")),
                amount(exchanged, &format!("{b} {part}")),
            ];
            assert!((a - b).abs() < 1e-8, "{part}: {a} {b}");
        }
    }
}

/// If the set-up has adjustments for the left wheel only, the builds align the left wheel. The right wheel stays as built.
#[test]
fn a_wheel_without_adjustments_stays_as_built() {
    let build = |aligned: bool| {
        let soft = "[axle.right.bushings.lower_arm_rear]\nscale = [0.5, 0.5, 0.5, 0.5, 0.5, 0.5]\n";
        let setup = "[setup]\nadjust = [{ length = \"tie_rod\", side = \"left\" }]\n";
        let tolerance = format!(
            "[tolerance]\nbuilds = 4\nseed = 3\naligned = {aligned}\n\
             scatter = [{{ hardpoints = [\"lower_arm_rear\", \"upper_ball_joint\"], sigma = 0.4 }}]\n"
        );
        let text = with(SUBFRAME, &format!("\n{soft}{setup}{tolerance}")).replace(MIRRORED, "");
        let study = elastic(&text);
        let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
        let built = elastic(&problem.built_text(1).unwrap());
        let axle = &built.axle().unwrap().axle;
        axle.on_rig(None)
            .suspensions
            .map(|wheel| wheel.design.clone())
    };
    let (aligned, plain) = (build(true), build(false));
    let [left, right] = [0, 1].map(|side: usize| {
        let both = aligned[side].iter().zip(&plain[side]);
        both.fold(0.0, |most, (a, b)| larger(most, (*a - *b).norm()))
    });
    assert!(left > 1e-3, "{left}");
    assert!(right < 1e-9, "{right}");
}

/// The program refuses three kinds of input: targets without a value in an elastic equilibrium, test results as
/// targets, and adjustments that lift one side. The message names an alternative.
#[test]
fn what_cannot_be_set_up_is_refused() {
    let refusal = |name: &str, setup: &str, further: &str| {
        let text = with(name, &format!("\n[setup]\n{setup}\n{further}"));
        let text = match further {
            "" => text,
            _ => text.replace(MIRRORED, ""),
        };
        let read = Study::elastic_from_text("case.toml", &text, std::path::Path::new(""));
        read.map(|_| ()).unwrap_err().to_string()
    };
    let adjust = "adjust = [{ length = \"tie_rod\" }]";
    let said = refusal(
        RUBBER,
        &format!("{adjust}\nwant = {{ roll_centre_height = 30.0 }}"),
        "",
    );
    assert!(
        said.contains("roll_centre_height") && said.contains("rigid mechanism"),
        "{said}"
    );
    let links = "adjust = [{ length = \"toe_link\" }]\nwant = { caster = 3.0 }";
    let said = refusal(LINKS, links, "");
    assert!(said.contains("joints of a steering axis"), "{said}");
    let soft = "[axle.right.bushings.lower_arm_rear]\nscale = [0.5, 0.5, 0.5, 0.5, 0.5, 0.5]\n";
    let seat = "adjust = [{ shim = \"spring_upper\", axis = \"z\" }]\nwant = { toe = 0.1 }";
    let said = refusal(SUBFRAME, seat, soft);
    assert!(said.contains("lifts one side"), "{said}");
    let figure = format!("{adjust}\nwant = {{ toe_by_aligning_moment = 0.1 }}");
    let said = refusal(SUBFRAME, &figure, soft);
    assert!(said.contains("result of a test"), "{said}");
}

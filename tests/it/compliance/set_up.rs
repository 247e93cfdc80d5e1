//! Tests of set-ups of wheels and axles with elastic parts: against equilibria of the adjusted hardpoints, against the
//! rigid mechanism, and against finite differences between builds.

use super::support::{elastic, fourth_order, with};
use hardpoint::assembly::{Assembler, Rest};
use hardpoint::axle::Law;
use hardpoint::characteristics::Characteristic;
use hardpoint::compliance::{KcRun, KcValue};
use hardpoint::model::Suspension;
use hardpoint::report::SetUpSummary;
use hardpoint::set_up::{FoundSetUp, Refusal, set_up};
use hardpoint::solved::Solved;
use hardpoint::study::{Study, Vehicle};

pub const RUBBER: &str = "double_wishbone_compliance.toml";
const TUBES: &str = "formula_student_compliance.toml";
pub const LINKS: &str = "five_link_compliance.toml";

/// Study of the repository with this set-up. Its elastic parts are free of force in the design position.
pub fn free(name: &str, setup: &str) -> Study {
    let text = with(
        name,
        &format!("\n[outputs]\ncharacteristics = {OUTPUTS}\n[setup]\n{setup}\n"),
    );
    elastic(&text.replace("\"at_design_load\"", "\"free\""))
}

const OUTPUTS: &str = "[\"camber\", \"toe\", \"spring_length\"]";

pub fn found(study: &Study) -> FoundSetUp {
    let found = set_up(study, study.setup.as_ref().unwrap());
    found.unwrap_or_else(|why| panic!("{}", why.reason()))
}

pub fn one(found: &FoundSetUp) -> &SetUpSummary {
    let [summary] = &found.wheels[..] else {
        panic!("one set-up");
    };
    summary
}

/// Returns the value of a column after the set-up.
pub fn set(summary: &SetUpSummary, column: &str) -> f64 {
    let own = summary.statics.iter().find(|s| s.column == column);
    own.unwrap_or_else(|| panic!("no {column}")).set.unwrap()
}

fn effect(summary: &SetUpSummary, adjustment: &str, column: &str) -> f64 {
    let place = summary.statics.iter().position(|s| s.column == column);
    let own = summary
        .adjustments
        .iter()
        .find(|a| a.adjustment == adjustment);
    own.unwrap().by_length[place.unwrap()].unwrap()
}

pub fn amount(summary: &SetUpSummary, adjustment: &str) -> f64 {
    let own = summary
        .adjustments
        .iter()
        .find(|a| a.adjustment == adjustment);
    own.unwrap_or_else(|| panic!("no {adjustment}")).amount
}

fn spring(suspension: &Suspension) -> f64 {
    suspension.spring_length(&suspension.design).unwrap()
}

/// Returns the spring force of a study when the spring has this length between its hardpoints.
fn force_at(study: &Study, length: f64) -> f64 {
    let law = match &study.vehicle {
        Vehicle::Wheel(own) => own
            .compliance
            .as_ref()
            .unwrap()
            .parts
            .spring
            .clone()
            .unwrap(),
        Vehicle::Axle(both) => both.axle.setup.springs.clone().unwrap()[0].clone(),
    };
    let Law::Linear { force, rate } = law.spring else {
        panic!("a linear spring");
    };
    force + rate * (spring(study.wheel()) - length)
}

/// Study of the adjusted hardpoints, written as text and read again. The springs have the same laws as before.
pub fn read_again(study: &Study, found: &FoundSetUp) -> Study {
    let adjusted = &found.adjusted;
    let text = match &adjusted.vehicle {
        Vehicle::Wheel(own) => study.with_built(&own.suspension),
        Vehicle::Axle(both) => {
            let wheels = hardpoint::model::Side::ALL.map(|side| both.axle.suspension(side));
            study.with_built_axle(wheels)
        }
    };
    let force = force_at(study, spring(adjusted.wheel()));
    let section = text.find("[spring]").unwrap();
    let start = section + text[section..].find("force = ").unwrap();
    let end = start + text[start..].find(['\n', '#']).unwrap();
    let text = format!("{}force = {force:?} {}", &text[..start], &text[end..]);
    let mut again = elastic(text.split("[setup]").next().unwrap());
    // A study text has one force for both springs of an axle.
    if let Vehicle::Axle(both) = &mut again.vehicle {
        let forces = hardpoint::model::Side::ALL
            .map(|side| force_at(study, spring(both.axle.suspension(side))));
        let elastic = both.axle.elastic.as_mut().unwrap();
        for (wheel, own) in elastic.parts.wheels.iter_mut().zip(forces) {
            if let Some(Law::Linear { force, .. }) = wheel.spring.as_mut().map(|s| &mut s.spring) {
                *force = own;
            }
        }
    }
    again
}

/// Printed values at rest, in the order of the columns.
pub fn at_rest(study: &Study, columns: &[&str]) -> Vec<f64> {
    let solved = Solved::of(study).unwrap();
    let curves = solved.curves();
    let rest = curves
        .stations
        .iter()
        .position(|station| station.at.iter().all(|c| c.unwrap_or(0.0) == 0.0));
    let rest = &curves.stations[rest.unwrap()];
    let value = |name: &&str| {
        let place = curves
            .columns
            .iter()
            .position(|column| column.name == *name);
        rest.value(place.unwrap_or_else(|| panic!("no {name}")))
            .unwrap()
    };
    columns.iter().map(value).collect()
}

/// Rigid mechanism of a study's text, with more text at its end. It has no spring and no tyre.
fn rigid(text: &str, more: &str) -> Study {
    let (head, _) = text.split_once("[compliance]").unwrap();
    let (mechanism, further) = head.split_once("[spring]").unwrap();
    let motion = &further[further.find("[motion]").unwrap()..];
    let text = format!("{mechanism}{motion}\n{more}\n");
    let read = Study::from_text("rigid.toml", &text, std::path::Path::new(""));
    read.unwrap_or_else(|e| panic!("{e}"))
}

/// The equilibrium of the adjusted hardpoints has the target values. The rigid mechanism with these hardpoints has other
/// values.
#[test]
fn wanted_values_are_those_of_the_adjusted_equilibrium() {
    let arms = "adjust = [{ length = \"tie_rod\" }, { shim = \"upper_ball_joint\", axis = \"y\" }]\nwant = { camber = -1.2, toe = 0.15 }";
    let links = "adjust = [{ length = \"toe_link\" }, { length = \"upper_rear_link\" }]\nwant = { camber = -1.6, toe = 0.05 }";
    let lowered = format!("{arms}\nride_height_change = -6.0");
    for (name, setup, want) in [
        (RUBBER, arms, [-1.2, 0.15]),
        (RUBBER, &lowered, [-1.2, 0.15]),
        (TUBES, arms, [-1.2, 0.15]),
        (LINKS, links, [-1.6, 0.05]),
    ] {
        let study = free(name, setup);
        let found = found(&study);
        let summary = one(&found);
        assert!(summary.met, "{name}");
        assert!((set(summary, "camber_deg") - want[0]).abs() < 1e-9);
        let again = read_again(&study, &found);
        let values = at_rest(&again, &["camber_deg", "toe_deg", "spring_length_mm"]);
        for (value, want) in values.iter().zip(want) {
            assert!((value - want).abs() < 1e-9, "{name}: {value} {want}");
        }
        // The curves of the command equal those of this study.
        let own = at_rest(
            &found.adjusted,
            &["camber_deg", "toe_deg", "spring_length_mm"],
        );
        for (own, value) in own.iter().zip(&values) {
            assert!((own - value).abs() < 1e-9, "{name}: {own} {value}");
        }
        // The rigid mechanism of the adjusted hardpoints has other angles, because the elastic parts deflect.
        let rigid = rigid(
            &again.text,
            &format!("[outputs]\ncharacteristics = {OUTPUTS}"),
        );
        let apart = at_rest(&rigid, &["toe_deg"])[0] - values[1];
        assert!(apart.abs() > 1e-4, "{name}: {apart}");
    }
}

/// With `at_design_load` and without preload, the design position is the equilibrium. So adjustments, values and ride
/// height equal those of the rigid mechanism. The effects on camber, toe and height are equal, too.
#[test]
fn at_the_design_load_the_set_up_is_that_of_the_rigid_mechanism() {
    for (name, setup) in [
        (
            RUBBER,
            "adjust = [{ length = \"tie_rod\", per_turn = 2.0 }, { shim = \"upper_arm_front\", axis = \"z\", step = 0.5 }]\n\
             want = { camber = -0.9, caster = 4.5, toe = 0.1 }",
        ),
        (
            TUBES,
            "adjust = [{ length = \"pushrod\" }, { length = \"tie_rod\" }, { shim = \"upper_ball_joint\", axis = \"y\" }]\n\
             want = { camber = -1.9, toe = 0.1 }\nride_height_change = -4.0",
        ),
    ] {
        let text = with(name, &format!("\n[setup]\n{setup}\n"));
        let study = elastic(&text);
        let rigid = rigid(&text, &format!("[setup]\n{setup}"));
        let (own, other) = (found(&study), found(&rigid));
        let (own, other) = (one(&own), one(&other));
        for (a, b) in own.adjustments.iter().zip(&other.adjustments) {
            assert_eq!(a.adjustment, b.adjustment);
            assert_eq!(a.instruction, b.instruction, "{name}");
            assert!(
                (a.amount - b.amount).abs() < 1e-9,
                "{name}: {} {}",
                a.amount,
                b.amount
            );
            let height = own.statics.len() - 1;
            for place in [0, 1, height] {
                let [a, b] = [a, b].map(|own| own.by_length[place].unwrap());
                assert!((a - b).abs() < 1e-9, "{name} {place}: {a} {b}");
            }
        }
        for (a, b) in own.statics.iter().zip(&other.statics) {
            if a.column.starts_with("bump_steer") {
                // Bump steer of the elastic wheel includes the deflection of the bushings, so it differs from that of
                // the rigid mechanism.
                assert!((a.set.unwrap() - b.set.unwrap()).abs() > 1e-7);
                continue;
            }
            assert!(
                (a.set.unwrap() - b.set.unwrap()).abs() < 1e-9,
                "{name} {}",
                a.column
            );
        }
    }
}

/// A pushrod sets the ride height. The spring then keeps the length that it has in the nominal equilibrium. So it also keeps the
/// force that carries the car.
#[test]
fn the_spring_keeps_the_length_of_the_nominal_equilibrium() {
    let setup = "adjust = [{ length = \"pushrod\", per_turn = 2.0 }, { length = \"tie_rod\" }]\nwant = { toe = 0.2 }\nride_height_change = -7.0";
    let study = free(TUBES, setup);
    let found = found(&study);
    let summary = one(&found);
    assert!((set(summary, "ride_height_change_mm") + 7.0).abs() < 1e-9);
    let [nominal] = at_rest(&study, &["spring_length_mm"])[..] else {
        panic!("one value");
    };
    let again = read_again(&study, &found);
    let values = at_rest(&again, &["toe_deg", "spring_length_mm"]);
    assert!(
        (values[0] - 0.2).abs() < 1e-9 && (values[1] - nominal).abs() < 1e-9,
        "{values:?}"
    );
    // The elastic tubes deflect under the spring force, so the length of the spring in equilibrium differs from
    // its length between the nominal hardpoints.
    assert!((spring(study.wheel()) - nominal).abs() > 1e-3);
    let wheel = study.wheel();
    let [before, after] =
        [wheel, again.wheel()].map(|own| own.design[own.mechanism.wheel_centre.0].z);
    assert!((after - before - 7.0).abs() < 1e-9, "{after} {before}");
}

/// Values of a build in equilibrium at a given height of the wheel centre: camber, toe, bump steer and spring length.
fn built(study: &Study, name: &str, by: f64, height: f64) -> [f64; 4] {
    let assembler = Assembler::new(study.wheel()).unwrap();
    let setup = study.setup.as_ref().unwrap();
    let adjustment = setup.adjust.iter().find(|a| a.name == name).unwrap();
    let (parameter, share) = adjustment.change;
    let mut parts = assembler.drawn().clone();
    parts.change(&assembler.suspension().mechanism, parameter, share * by);
    let built = assembler.build(&parts, Rest::Height(height)).unwrap();
    let elastic = study.compliance().unwrap();
    let mut parts = elastic.parts.clone();
    // The spring is unchanged: at the new length, its force is the nominal force of the build.
    let Some(Law::Linear { force, .. }) = parts.spring.as_mut().map(|law| &mut law.spring) else {
        panic!("a linear spring");
    };
    *force = force_at(study, spring(&built.suspension));
    let run = KcRun::new(&built.suspension, &parts, elastic.tyre_rate).unwrap();
    let wanted = [
        Characteristic::Camber,
        Characteristic::Toe,
        Characteristic::BumpSteer,
        Characteristic::SpringLength,
    ]
    .map(KcValue::Wheel);
    let values = run.values([0.0; 2], &wanted).unwrap();
    [0, 1, 2, 3].map(|k: usize| {
        let factor = if k < 3 { 1f64.to_degrees() } else { 1.0 };
        values[k].unwrap() * factor
    })
}

/// The effects of adjustments equal the slopes of builds at the same height, also with a preloaded bushing and at
/// another height.
#[test]
fn effects_are_slopes_of_elastic_builds() {
    let setup = "adjust = [{ length = \"tie_rod\" }, { shim = \"upper_ball_joint\", axis = \"y\" }, { shim = \"lower_arm_front\", axis = \"z\" }]\n\
                 want = { camber = -0.6 }\nride_height_change = -5.0";
    let preloaded = with(RUBBER, &format!("\n[setup]\n{setup}\n")).replace(
        "[bushings.upper_arm_rear]\n",
        "[bushings.upper_arm_rear]\npreload = [0.0, 300.0, -200.0, 0.0, 0.0, 0.0]\n",
    );
    for study in [free(RUBBER, setup), elastic(&preloaded)] {
        let found = found(&study);
        let summary = one(&found);
        for adjustment in ["tie_rod", "upper_ball_joint y", "lower_arm_front z"] {
            let h = 0.2;
            let at = [-2.0, -1.0, 1.0, 2.0].map(|step| built(&study, adjustment, step * h, 5.0));
            for (k, column) in ["camber_deg", "toe_deg", "bump_steer_deg_per_mm"]
                .iter()
                .enumerate()
            {
                let slope = fourth_order(at.map(|values| values[k]), h);
                let own = effect(summary, adjustment, column);
                let size = own.abs().max(1e-3);
                assert!(
                    (own - slope).abs() < 1e-6 * size,
                    "{adjustment} {column}: {own} {slope}"
                );
            }
        }
    }
}

/// The effects of a pushrod adjustment equal the slopes of builds at the height that the spring determines.
#[test]
fn effects_of_a_pushrod_are_slopes_of_settled_builds() {
    let setup =
        "adjust = [{ length = \"pushrod\" }, { length = \"tie_rod\" }]\nwant = { toe = 0.1 }";
    let study = free(TUBES, setup);
    let found = found(&study);
    let summary = one(&found);
    let length = built(&study, "pushrod", 0.0, 0.0)[3];
    for adjustment in ["pushrod", "tie_rod"] {
        // The secant method finds the height at which the spring has its nominal length.
        let settled = |by: f64| {
            let (mut a, mut b) = (0.0, 0.5);
            let miss = |height: f64| built(&study, adjustment, by, height)[3] - length;
            let (mut f, mut g) = (miss(a), miss(b));
            for _ in 0..12 {
                if f == g {
                    break;
                }
                let next = b - g * (b - a) / (g - f);
                (a, f, b) = (b, g, next);
                g = miss(b);
            }
            assert!(g.abs() < 1e-8, "the secant method does not converge: {g:e}");
            let [camber, toe, ..] = built(&study, adjustment, by, b);
            [camber, toe, -b]
        };
        let h = 0.1;
        let at = [-2.0, -1.0, 1.0, 2.0].map(|step| settled(step * h));
        for (k, column) in ["camber_deg", "toe_deg", "ride_height_change_mm"]
            .iter()
            .enumerate()
        {
            let slope = fourth_order(at.map(|values| values[k]), h);
            let own = effect(summary, adjustment, column);
            let size = own.abs().max(1e-2);
            assert!(
                (own - slope).abs() < 1e-6 * size,
                "{adjustment} {column}: {own} {slope}"
            );
        }
    }
}

/// If the stiffness rises, the adjustments approach those of the rigid mechanism. The difference is proportional to one
/// over the stiffness.
#[test]
fn stiff_parts_have_the_amounts_of_the_rigid_mechanism() {
    let setup = "adjust = [{ length = \"tie_rod\" }, { shim = \"upper_ball_joint\", axis = \"y\" }]\nwant = { camber = -1.2, toe = 0.15 }";
    let amounts = |scale: f64| -> [f64; 2] {
        let text = free(TUBES, setup).text;
        let text = text.replace("90000.0", &format!("{:?}", 90000.0 * scale));
        let found = found(&elastic(&text));
        ["tie_rod", "upper_ball_joint y"].map(|name| amount(one(&found), name))
    };
    let rigid = rigid(&with(TUBES, ""), &format!("[setup]\n{setup}"));
    let rigid = found(&rigid);
    let rigid = ["tie_rod", "upper_ball_joint y"].map(|name| amount(one(&rigid), name));
    let [near, nearer] = [10.0, 100.0].map(amounts);
    for k in 0..2 {
        let (a, b) = (near[k] - rigid[k], nearer[k] - rigid[k]);
        assert!(b.abs() > 1e-7, "{b:e}");
        assert!((a / b - 10.0).abs() < 0.3, "{a:e} {b:e}");
    }
}

/// Multiplies the numbers of each list in a text by factors. `factors` returns the factors of a line, or `None` if the
/// line stays unchanged.
fn rescaled(text: &str, factors: impl Fn(&str) -> Option<Vec<f64>>) -> String {
    let line = |line: &str| -> String {
        let Some((name, list)) = line.split_once(" = ") else {
            return format!("{line}\n");
        };
        let Some(factors) = factors(line) else {
            return format!("{line}\n");
        };
        let list = list.split('#').next().unwrap();
        let list = list.trim().trim_start_matches('[').trim_end_matches(']');
        let numbers = list.split(',').map(|number| number.trim().parse::<f64>());
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().unwrap();
        assert_eq!(numbers.len(), factors.len(), "{line}");
        let scaled: Vec<f64> = numbers.iter().zip(factors).map(|(n, f)| n * f).collect();
        match &scaled[..] {
            [one] => format!("{name} = {one:?}\n"),
            all => format!("{name} = {all:?}\n"),
        }
    };
    text.lines().map(line).collect()
}

/// The same wheel on the right side, or in inches with other units of force, needs the same adjustments.
#[test]
fn set_ups_do_not_depend_on_side_and_units() {
    let setup = "adjust = [{ length = \"tie_rod\" }, { shim = \"upper_ball_joint\", axis = \"y\" }]\nwant = { camber = -1.2, toe = 0.15 }";
    let study = free(RUBBER, setup);
    let own = found(&study);
    let expected = ["tie_rod", "upper_ball_joint y"].map(|name| amount(one(&own), name));
    let is_point = |line: &str| {
        let name = line.split(' ').next().unwrap_or_default();
        study.wheel().mechanism.point(name).is_some()
    };
    // Every y changes its sign, and so does a shim along y.
    let text = rescaled(&study.text, |line| {
        is_point(line).then(|| vec![1.0, -1.0, 1.0])
    });
    let text = text.replace("[suspension]\n", "[suspension]\nside = \"right\"\n");
    let right = found(&elastic(&text));
    assert!((amount(one(&right), "tie_rod") - expected[0]).abs() < 1e-9);
    assert!((amount(one(&right), "upper_ball_joint y") + expected[1]).abs() < 1e-9);

    let (inch, force) = (1.0 / 25.4, 3.0);
    let text = rescaled(&study.text, |line| match line.split(' ').next() {
        _ if is_point(line) => Some(vec![inch; 3]),
        Some("stiffness") => {
            let (shift, turn) = (force / inch, force * inch);
            Some(vec![shift, shift, shift, turn, turn, turn])
        }
        Some("rate") => Some(vec![force / inch]),
        Some("force") => Some(vec![force]),
        Some("radius") => Some(vec![inch]),
        _ => None,
    });
    let text = text.replace("[suspension]\n", "[suspension]\nlength_unit = \"in\"\n");
    let inches = found(&elastic(&text));
    for (name, expected) in ["tie_rod", "upper_ball_joint y"].iter().zip(expected) {
        let own = amount(one(&inches), name);
        assert!(
            (own - inch * expected).abs() < 1e-10,
            "{name}: {own} {expected}"
        );
    }
}

/// If the wheel has no equilibrium at the requested height, the set-up states the reason and gives no numbers.
#[test]
fn a_rest_without_equilibrium_is_named() {
    let setup =
        "adjust = [{ length = \"tie_rod\" }]\nwant = { toe = 0.1 }\nride_height_change = -400.0";
    let study = free(RUBBER, setup);
    let reason = match set_up(&study, study.setup.as_ref().unwrap()) {
        Ok(_) => panic!("found"),
        Err(Refusal::Design(reason) | Refusal::NotMet(reason, _)) => reason,
    };
    let phrase = "too short or too long for the target height";
    assert!(
        reason.contains(phrase) && !reason.contains("NaN"),
        "{reason}"
    );
}

//! Tests of curves of equilibria over travel: the outputs of `solve` for a wheel with elastic parts.

use super::support::{elastic, fourth_order, with};
use crate::support::larger;
use hardpoint::compliance::ElasticWheel;
use hardpoint::curves::{Curves, Influence, Status, influences};
use hardpoint::plan::Plan;
use hardpoint::study::Study;
use std::path::Path;

const OUTPUTS: &str = r#"
[outputs]
characteristics = ["toe", "camber", "caster", "scrub_radius", "half_track_change", "spring_length", "toe_by_lateral_force"]
order = "velocity"
"#;

const RATES: &str = r#"
[outputs]
characteristics = ["bump_steer", "camber_gain", "caster_gain", "motion_ratio"]
"#;

fn column(curves: &Curves, name: &str) -> Vec<f64> {
    let index = curves.columns.iter().position(|column| column.name == name);
    let index = index.unwrap_or_else(|| panic!("{name}"));
    let stations = curves.stations.iter();
    stations
        .map(|station| station.value(index).unwrap())
        .collect()
}

/// Returns curves at five closely spaced travels around one travel.
fn near(study: &Study, travel: f64, step: f64) -> Curves {
    let mut moved = study.clone();
    let own = moved.one_wheel_mut().unwrap();
    own.motion.values = [-2.0, -1.0, 0.0, 1.0, 2.0]
        .map(|k| travel + k * step)
        .to_vec();
    moved.curves().unwrap()
}

/// Derivative from five values, of fourth order.
fn slope(values: &[f64], step: f64) -> f64 {
    fourth_order([values[0], values[1], values[3], values[4]], step)
}

/// Curves equal the values of the equilibria, in printed units.
#[test]
fn curves_are_read_off_equilibria() {
    let study = elastic(&with("double_wishbone_compliance.toml", OUTPUTS));
    let curves = study.curves().unwrap();
    let parts = &study.compliance().unwrap().parts;
    let wheel = ElasticWheel::new(study.wheel(), parts).unwrap();
    let design = wheel.figures(&wheel.at(0.0, 0.0).unwrap());
    let (toe, camber) = (column(&curves, "toe_deg"), column(&curves, "camber_deg"));
    let track = column(&curves, "half_track_change_mm");
    let spring = column(&curves, "spring_length_mm");
    for (k, travel) in study.motion().values.iter().enumerate() {
        let at = wheel.at(*travel, 0.0).unwrap();
        let found = wheel.figures(&at);
        assert_eq!(curves.stations[k].status, Status::Ok);
        assert!((toe[k] - found.toe.to_degrees()).abs() < 1e-13);
        assert!((camber[k] - found.camber.to_degrees()).abs() < 1e-13);
        // At the design load the design position is an equilibrium, and the track change is measured from this position.
        assert!((track[k] - (found.contact.y - design.contact.y)).abs() < 1e-9);
        assert!((spring[k] - wheel.spring(&at).unwrap().length).abs() < 1e-10);
    }
}

/// Derivatives with respect to travel, gains and the motion ratio equal the slopes of the curves.
#[test]
fn derivatives_by_travel_are_slopes_of_the_curves() {
    let study = elastic(&with("double_wishbone_compliance.toml", OUTPUTS));
    let gains = elastic(&with("double_wishbone_compliance.toml", RATES));
    let step = 0.5;
    for travel in [-30.0, 0.0, 17.0] {
        let (values, rates) = (near(&study, travel, step), near(&gains, travel, step));
        for (value, unit) in [
            ("toe", "deg"),
            ("camber", "deg"),
            ("caster", "deg"),
            ("scrub_radius", "mm"),
            ("half_track_change", "mm"),
            ("spring_length", "mm"),
        ] {
            let found = column(&values, &format!("{value}_{unit}"));
            let exact = column(&values, &format!("{value}_d1_{unit}_per_mm"))[2];
            let expected = slope(&found, step);
            let size = exact.abs().max(1e-3);
            assert!(
                (exact - expected).abs() < 1e-7 * size,
                "{value} at {travel}: {exact} {expected}"
            );
        }
        for (gain, of) in [
            ("bump_steer_deg_per_mm", "toe_deg"),
            ("camber_gain_deg_per_mm", "camber_deg"),
            ("caster_gain_deg_per_mm", "caster_deg"),
        ] {
            let (exact, expected) = (column(&rates, gain)[2], slope(&column(&values, of), step));
            assert!(
                (exact - expected).abs() < 1e-7 * exact.abs().max(1e-3),
                "{gain}: {exact} {expected}"
            );
        }
        let (ratio, length) = (
            column(&rates, "motion_ratio")[2],
            column(&values, "spring_length_mm"),
        );
        assert!((ratio + slope(&length, step)).abs() < 1e-7, "{ratio}");
    }
}

/// If all rates are multiplied by 10^k, the curves approach those of the rigid mechanism. The difference is proportional
/// to 10^-k.
#[test]
fn stiff_parts_give_the_curves_of_the_rigid_mechanism() {
    for (name, asked) in [
        (
            "double_wishbone_compliance.toml",
            r#"["toe", "camber", "scrub_radius", "bump_steer", "motion_ratio"]"#,
        ),
        (
            "five_link_compliance.toml",
            r#"["toe", "camber", "half_track_change", "bump_steer", "motion_ratio"]"#,
        ),
    ] {
        let text = with(name, &format!("\n[outputs]\ncharacteristics = {asked}\n"));
        let mut study = elastic(&text);
        let mut rigid = study.clone();
        rigid.one_wheel_mut().unwrap().compliance = None;
        let exact = rigid.curves().unwrap();
        assert!(exact.are_complete() && exact.stations.len() > 2, "{name}");
        let mut errors = Vec::new();
        for factor in [1e2, 1e4] {
            let own = elastic(&text);
            let parts = own.compliance().unwrap().parts.clone();
            let stiff = study.one_wheel_mut().unwrap().compliance.as_mut().unwrap();
            stiff.parts = stiffened(&parts, factor);
            let found = study.curves().unwrap();
            assert_eq!(found.stations.len(), exact.stations.len());
            let mut worst: f64 = 0.0;
            for (a, b) in found.stations.iter().zip(&exact.stations) {
                for (column, (x, y)) in a.values.iter().zip(&b.values).enumerate() {
                    let (x, y) = (x.as_ref().unwrap(), y.as_ref().unwrap());
                    let size = y.abs().max(0.1);
                    worst = larger(worst, (x - y).abs() / size);
                    assert!(
                        (x - y).abs() < 1e2 / factor * size,
                        "{name} {}: {x} {y}",
                        found.columns[column].name
                    );
                }
            }
            errors.push(worst);
        }
        let ratio = errors[0] / errors[1];
        assert!((80.0..125.0).contains(&ratio), "{name}: {errors:?}");
    }
}

/// Returns the parts with higher translational stiffnesses. The torsion of bushings keeps its stiffness, because it is
/// part of the wheel rate.
fn stiffened(
    parts: &hardpoint::compliance::Compliance,
    factor: f64,
) -> hardpoint::compliance::Compliance {
    use hardpoint::compliance::{AxialStiffness, Shape};
    let mut stiff = parts.clone();
    for bushing in &mut stiff.bushings {
        for shape in &mut bushing.shapes[..3] {
            match shape {
                Shape::Cubic { rate, cubic } => (*rate, *cubic) = (*rate * factor, *cubic * factor),
                Shape::Curve { scale, .. } => *scale *= factor,
            }
        }
    }
    for link in &mut stiff.links {
        match &mut link.stiffness {
            AxialStiffness::Rate(rate) => *rate *= factor,
            AxialStiffness::PerStrain(force) => *force *= factor,
        }
    }
    stiff
}

/// The `sensitivities` of `solve` equal the changes of the curves when a hardpoint moves.
#[test]
fn sensitivities_are_changes_of_the_curves() {
    let more = "\n[outputs]\ncharacteristics = [\"toe\", \"bump_steer\", \"toe_by_lateral_force\"]\nsensitivities = [\"tie_rod_inner\", \"lower_arm_rear\"]\n";
    let study = elastic(&with("double_wishbone_compliance.toml", more));
    let curves = study.curves().unwrap();
    let step = 0.01;
    for found in &curves.sensitivities {
        let at = |change: f64| {
            let mut design = study.wheel().design.clone();
            design[found.point.0][found.axis] += change;
            let mut moved = study.at_design(design);
            moved.one_wheel_mut().unwrap().outputs.sensitivities.clear();
            moved.curves().unwrap().stations[found.station]
                .value(found.column)
                .unwrap()
        };
        let values = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| at(k * step));
        let expected = slope(&values, step);
        // At the design load the wheel height determines toe in the design position, so all slopes of toe are 0 there.
        // The scale is therefore the largest slope of the column.
        let size = curves
            .sensitivities
            .iter()
            .filter(|other| other.column == found.column)
            .fold(0.0, |m: f64, other| larger(m, other.value.abs()));
        assert!(
            (found.value - expected).abs() < 1e-6 * size,
            "{} {:?}: {} {expected}",
            curves.columns[found.column].name,
            (found.point, found.axis),
            found.value
        );
    }
    assert_eq!(curves.sensitivities.len(), 5 * 3 * 6);
}

/// A station without equilibrium has a status and no values. The other stations keep their values.
#[test]
fn a_station_without_equilibrium_is_said() {
    let mut study = elastic(&with(
        "double_wishbone_compliance.toml",
        "\n[outputs]\ncharacteristics = [\"toe\"]\n",
    ));
    study.one_wheel_mut().unwrap().motion.values = vec![0.0, 900.0];
    let curves = study.curves().unwrap();
    assert_eq!(curves.stations[0].status, Status::Ok);
    let word = curves.stations[1].status.word();
    assert!(["no_equilibrium", "unstable"].contains(&word), "{word}");
    assert_eq!(curves.stations[1].value(0), None);
}

/// For a wheel with elastic parts, the program refuses quantities of the rigid mechanism, names them, and lists the
/// alternatives.
#[test]
fn quantities_of_the_rigid_mechanism_are_refused_by_name() {
    let dw = "double_wishbone_compliance.toml";
    for (name, more, phrase) in [
        (
            dw,
            "characteristics = [\"roll_centre_height\"]",
            "jacking_by_lateral_force",
        ),
        (
            dw,
            "characteristics = [\"toe_by_laterl_force\"]",
            "did you mean \"toe_by_lateral_force\"",
        ),
        (
            dw,
            "characteristics = [\"toe\"]\npoints = [\"wheel_centre\"]",
            "levels.csv",
        ),
        (
            dw,
            "characteristics = [\"toe\"]\norder = \"acceleration\"",
            "\"velocity\"",
        ),
        (
            dw,
            "characteristics = [\"bump_steer\"]\norder = \"velocity\"",
            "derivative with respect to travel",
        ),
        (
            dw,
            "characteristics = [\"toe\"]\ncertify = true",
            "rigid mechanism",
        ),
        (
            "five_link_compliance.toml",
            "characteristics = [\"caster\"]",
            "spin_by_lateral_force",
        ),
    ] {
        let text = with(name, &format!("\n[outputs]\n{more}\n"));
        let errors = Study::elastic_from_text("case.toml", &text, Path::new("")).unwrap_err();
        let said = errors.render(false);
        assert!(said.contains(phrase), "{more}: {said}");
    }
}

/// Influence of coordinates on outputs, with a test that has no value at the last station. The reason: no equilibrium exists at
/// the largest load of the test. The influences on other outputs are the same as without this test. The influences on the test
/// come from the other stations.
#[test]
fn a_missing_value_does_not_mix_influences() {
    let influences_on = |outputs: &str, travels: &str| {
        let text = with("double_wishbone_compliance.toml", outputs);
        let test = "relaxed = \"at_design_load\"\ntests = [{ load = \"lateral\", hold = \"wheel_load\", window = 40000.0 }]";
        let text = text.replacen("relaxed = \"at_design_load\"", test, 1);
        let steps = "travel = { from = -40.0, to = 40.0, steps = 5 }";
        assert!(text.contains(steps));
        let study = elastic(&text.replacen(steps, travels, 1));
        let own = study.one_wheel().unwrap();
        influences(own, &Plan::of(own)).unwrap()
    };
    let both = "[outputs]\ncharacteristics = [\"toe\", \"toe_by_lateral_force_secant\"]\n";
    let toe = "[outputs]\ncharacteristics = [\"toe\"]\n";
    let secant = "[outputs]\ncharacteristics = [\"toe_by_lateral_force_secant\"]\n";
    let found = influences_on(both, "travel = [-40.0, 0.0, 40.0]");
    let mut wanted = influences_on(toe, "travel = [-40.0, 0.0, 40.0]");
    wanted.extend(influences_on(secant, "travel = [-40.0, 0.0]"));
    assert!(wanted.len() > 40, "{}", wanted.len());
    let named = |all: &[Influence]| -> Vec<(String, String)> {
        all.iter()
            .map(|i| (i.output.clone(), i.coordinate.clone()))
            .collect()
    };
    assert_eq!(named(&found), named(&wanted));
    let numbers = |i: &Influence| [i.largest, i.rms, i.bend];
    let mut worst = 0.0;
    for (found, wanted) in found.iter().zip(&wanted) {
        for (a, b) in numbers(found).into_iter().zip(numbers(wanted)) {
            worst = larger(worst, (a - b).abs() / wanted.rms.max(1e-6));
        }
    }
    assert!(worst < 1e-9, "{worst:e}");
}

//! Tests of bushings as property files, which `export --to bus` writes and a study reads by `file`.

use hardpoint::compliance::Shape;
use hardpoint::exchange::{Outgoing, property_file};
use hardpoint::model::LengthUnit;
use hardpoint::study::Study;
use std::path::Path;

const NAME: &str = "double_wishbone_compliance.toml";

fn sample() -> String {
    crate::support::sample(NAME)
}

fn elastic(text: &str, directory: &Path) -> Study {
    let path = directory.join("study.toml");
    std::fs::write(&path, text).unwrap();
    Study::read_elastic(&path, &[]).unwrap_or_else(|errors| panic!("{}", errors.render(false)))
}

/// Force at a deflection within the range of the file, computed from the law's points alone.
fn force(shape: &Shape, at: f64) -> f64 {
    match shape {
        Shape::Cubic { rate, cubic } => at * (rate + cubic * at * at),
        Shape::Curve { curve, scale } => curve.at(at) * scale,
    }
}

/// Export and import of property files give the same laws. The test covers linear, cubic and tabulated laws, an axis
/// without stiffness, and every unit.
#[test]
fn laws_come_back_from_property_files() {
    let directory = tempfile::tempdir().unwrap();
    let own = "[bushings.lower_arm_rear]
stiffness = [700.0, 0.0, 1800.0, 8.0e4, 2.5e5, 0.0]
cubic = [0.0, 0.0, 30.0, 0.0, 4.0e6, 0.0]
fy = [[-3.0, -9000.0], [-1.0, -2500.0], [0.5, 1250.0], [2.0, 8000.0]]
scale = [1.0, 1.5, 1.0, 1.0, 1.0, 1.0]
";
    let text = sample();
    let start = text.find("[bushings.lower_arm_rear]").unwrap();
    let end = start + text[start..].find("\n\n").unwrap();
    let before = elastic(
        &format!("{}{own}{}", &text[..start], &text[end..]),
        directory.path(),
    );
    let law = |study: &Study| {
        let id = study.wheel().mechanism.point("lower_arm_rear").unwrap();
        let parts = &study.compliance().unwrap().parts;
        let part = parts.bushings.iter().find(|part| part.point == id).unwrap();
        part.shapes.clone()
    };
    for unit in LengthUnit::ALL {
        let outgoing = Outgoing::of(&before, Some(unit), None);
        let written = property_file(&outgoing, Some("lower_arm_rear")).unwrap();
        std::fs::write(directory.path().join("rear.bus"), &written.bytes).unwrap();
        let by_file = "[bushings.lower_arm_rear]\nfile = \"rear.bus\"\n";
        let after = format!("{}{by_file}{}", &text[..start], &text[end..]);
        let after = elastic(&after, directory.path());
        // The command states these errors for the two cubic laws: 3 c D h^2/4 with 50 steps to 10 mm or to 0.2 rad.
        let stated = |c: f64, end: f64| 0.75 * c * end * (end / 50.0).powi(2);
        let bounds = [0.0, 0.0, stated(30.0, 10.0), 0.0, stated(4.0e6, 0.2), 0.0];
        for (axis, (before, after)) in law(&before).iter().zip(&law(&after)).enumerate() {
            let end = [10.0, 2.0, 10.0, 0.2, 0.2, 0.2][axis];
            for step in -40..=40 {
                let at = end * f64::from(step) / 40.0;
                let (wanted, found) = (force(before, at), force(after, at));
                let rounding = 1e-12 * wanted.abs().max(1.0);
                assert!(
                    (found - wanted).abs() <= bounds[axis] + rounding,
                    "axis {axis} at {at}: {found} {wanted}"
                );
            }
        }
        let notes = written.notes.join("\n");
        assert!(
            notes.contains(&format!("{:.2e} N", bounds[2])) && notes.contains("damping"),
            "{notes}"
        );
    }
}

/// The export refuses a call that selects no bushing or an unknown bushing. The message lists the available names.
#[test]
fn a_property_file_holds_one_bushing() {
    let directory = tempfile::tempdir().unwrap();
    let study = elastic(&sample(), directory.path());
    let outgoing = Outgoing::of(&study, None, None);
    for (name, expected) in [
        (None, "select it with --bushing, one of lower_arm_front,"),
        (Some("tie_rod_inner"), "no bushing \"tie_rod_inner\""),
    ] {
        let refused = property_file(&outgoing, name).unwrap_err();
        assert!(refused.contains(expected), "{refused}");
    }
    let rigid = crate::support::sample("double_wishbone_solve.toml");
    let rigid = elastic(&rigid, directory.path());
    let refused = property_file(&Outgoing::of(&rigid, None, None), None).unwrap_err();
    assert!(refused.contains("[bushings.NAME]"), "{refused}");
}

//! Tests of warnings of `check`: other axes, a wheel at the centre plane, and joints in impossible positions.

use super::commands::{hardpoint, path, text};
use hardpoint::model::Topology;

/// `check` warns of mistakes that an import would refuse: columns in another order, and a wheel at the centre plane.
#[test]
fn check_doubts_axes_and_a_wheel_at_the_centre_plane() {
    let directory = tempfile::tempdir().unwrap();
    let (path, study) = path(&directory, "study.toml");
    let template = Topology::named("double_wishbone").unwrap().template;
    let doubts = |change: fn([f64; 3]) -> [f64; 3]| {
        let mut document: toml::Table = template.parse().unwrap();
        let suspension = document["suspension"].as_table_mut().unwrap();
        for (_, point) in suspension["hardpoints"].as_table_mut().unwrap() {
            let numbers = point.as_array().unwrap().iter();
            let numbers: Vec<f64> = numbers.map(|n| n.as_float().unwrap()).collect();
            let changed = change([numbers[0], numbers[1], numbers[2]]);
            *point = toml::Value::Array(changed.map(toml::Value::Float).to_vec());
        }
        std::fs::write(&path, document.to_string()).unwrap();
        let said = hardpoint(&["check", &study]).output().unwrap();
        text(&said.stdout) + &text(&said.stderr)
    };
    let plain = doubts(|at| at);
    assert!(
        !plain.contains("the axes seem") && !plain.contains("centre plane"),
        "{plain}"
    );
    let swapped = doubts(|[x, y, z]| [y, x, z]);
    assert!(
        swapped.contains("the axes seem to be different"),
        "{swapped}"
    );
    let at_origin = doubts(|[x, y, z]| [x, y - 760.0, z]);
    assert!(at_origin.contains("from the centre plane"), "{at_origin}");
    // If one coordinate has a wrong decimal point, `check` names this coordinate first, before the warnings that follow
    // from it.
    let slip = doubts(|at| {
        if at == [10.0, 700.0, 180.0] {
            [10.0, 700.0, 1800.0]
        } else {
            at
        }
    });
    assert!(
        slip.split("please check: ")
            .nth(1)
            .unwrap()
            .starts_with("lower_ball_joint seems to have z = 180 "),
        "{slip}"
    );
}

/// `check` names each outer joint with a shifted decimal point in z, and each pivot with a wrong sign in y. It warns of
/// no joint in the templates and the sample studies.
#[test]
fn joints_in_impossible_positions_are_named() {
    use hardpoint::study::Study;
    let doubts = |text: &str| -> Vec<String> {
        let directory = crate::support::studies();
        let study = Study::from_text("study", text, directory).unwrap();
        hardpoint::report::study_doubts(&study).unwrap_or_default()
    };
    for name in ["double_wishbone", "five_link", "macpherson"] {
        let template = Topology::named(name).unwrap().template;
        assert_eq!(doubts(template), Vec::<String>::new(), "{name}");
        for line in template.lines().filter(|line| line.contains(" = [")) {
            let (point, rest) = line.split_once('=').unwrap();
            let numbers = rest.split(['[', ']']).nth(1).unwrap().split(',');
            let numbers: Result<Vec<f64>, _> = numbers.map(|n| n.trim().parse()).collect();
            let Ok([x, y, z]) = numbers.map(|n| <[f64; 3]>::try_from(n).unwrap_or_default()) else {
                continue;
            };
            let point = point.trim();
            let wrong = match () {
                () if point.ends_with("ball_joint") || point.ends_with("_outer") => {
                    [x, y, 10.0 * z]
                }
                () if point.ends_with("arm_front") || point.ends_with("arm_rear") => [x, -y, z],
                () => continue,
            };
            if point.starts_with("pushrod") || point.starts_with("drop_link") {
                continue;
            }
            let found = doubts(&template.replace(line, &format!("{point} = {wrong:?}")));
            assert!(
                found
                    .iter()
                    .any(|doubt| doubt.contains(&format!("{point} seems to have"))),
                "{name} {point}: {found:?}"
            );
        }
    }
}

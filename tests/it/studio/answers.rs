//! Tests of answers of the server, against the results of the other commands and against slopes.

use super::{Served, columns, sample, solved};
use serde_json::{Value, json};

/// Columns of an answer, by name.
pub(super) fn answered(answer: &Value) -> Vec<(String, Vec<Option<f64>>)> {
    let columns = answer["columns"].as_array().unwrap().iter();
    let values = |c: &Value| {
        c["values"]
            .as_array()
            .unwrap()
            .iter()
            .map(Value::as_f64)
            .collect()
    };
    columns
        .map(|c| (c["column"].as_str().unwrap().to_owned(), values(c)))
        .collect()
}

fn solve(served: &Served, of: &Value) -> Value {
    let overview = served.overview();
    let list = |name: &str| overview[name].as_array().unwrap();
    let asked = list("characteristics")
        .iter()
        .filter(|c| c["asked"] == true);
    let asked: Vec<&Value> = asked.map(|c| &c["name"]).collect();
    let at: Vec<&Value> = list("sliders")
        .iter()
        .map(|slider| &slider["home"])
        .collect();
    let message =
        json!({"of": of, "characteristics": asked, "at": at, "curves_rack": null, "over": 0});
    served.post("solve", &message).json()
}

/// Study of an axle with fewer stations.
fn of_few_stations(text: &str) -> String {
    let mut text = text.to_owned();
    for (many, few) in [
        ("to = 3.0, steps = 7", "to = 3.0, steps = 3"),
        ("to = 3.0, steps = 13", "to = 3.0, steps = 3"),
        ("to = 40.0, steps = 5", "to = 40.0, steps = 2"),
        ("to = 360.0, steps = 9", "to = 360.0, steps = 3"),
    ] {
        text = text.replace(many, few);
    }
    text
}

/// File that `hardpoint export` writes for a study.
fn exported(study: &std::path::Path, format: &str) -> Vec<u8> {
    let mut command = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
    command.arg("export").arg(study).args(["--to", format]);
    command.assert().success().get_output().stdout.clone()
}

/// The curves of a moved design equal those that `hardpoint solve` prints for the saved study, bit for bit. The CSV on
/// the page also equals them. The test covers several topologies and frames, for one wheel and for both wheels.
#[test]
fn answers_are_those_of_solve() {
    for (name, point, axis) in [
        ("macpherson_front.toml", "strut_top", 1),
        ("formula_student_front.toml", "upper_ball_joint", 2),
        ("five_link_rear.toml", "wheel_centre", 2),
        ("semi_trailing_arm_rear.toml", "wheel_centre", 1),
        ("macpherson_axle_front.toml", "tie_rod_inner", 2),
        ("five_link_axle.toml", "wheel_centre", 2),
    ] {
        let served = Served::of(&of_few_stations(&sample(name)));
        let of = served.moved(point, axis, 1.37);
        let answer = solve(&served, &of);
        let csv = served.post("csv", &of);
        let files = [("points", "csv"), ("dxf", "dxf")]
            .map(|(file, format)| (format, served.post(file, &of)));
        assert_eq!(
            served
                .post("save", &json!({"of": of, "name": null, "anyway": false}))
                .status,
            200,
            "{name}"
        );
        let expected = solved(&served.study);
        assert_eq!(csv.body, expected, "{name}");
        for (format, file) in files {
            let made = exported(&served.study, format);
            assert_eq!(file.body, made, "{name}: {format}");
            assert!(made.len() > 200, "{name}: {format}");
        }
        let expected = columns(&expected);
        let mut compared = 0;
        for (column, values) in answered(&answer) {
            let Some((_, printed)) = expected.iter().find(|(name, _)| *name == column) else {
                continue;
            };
            assert_eq!(&values, printed, "{name}: {column}");
            compared += 1;
        }
        assert!(compared >= 3, "{name}");
    }
}

/// The gradient of the misfit with respect to coordinates equals finite differences of the misfit (fourth order). The
/// test covers one wheel, both wheels, and an axle whose right wheel has its own points.
#[test]
fn gradients_of_the_misfit_are_its_slopes() {
    let own = "[axle.right.hardpoints]\ntie_rod_inner = [-110.0, -331.0, 243.5]\n";
    let axle = of_few_stations(&sample("macpherson_axle_front.toml"));
    let (before, after) = axle.split_once("[axle]").unwrap();
    let (_, after) = after.split_once("\n\n").unwrap();
    let unlike = format!("{before}{own}\n{after}");
    for text in [sample("macpherson_front.toml"), axle.clone(), unlike] {
        let served = Served::of(&text);
        let misfit = |answer: &Value| answer["misfit"]["value"].as_f64().unwrap();
        let of = served.moved("strut_top", 0, 0.4);
        let here = solve(&served, &of);
        let gradient = &here["misfit"]["gradient"];
        for (point, axis) in [(3, 1), (5, 2)] {
            let at = |by: f64| {
                let mut of = of.clone();
                of["design"][point][axis] = json!(of["design"][point][axis].as_f64().unwrap() + by);
                misfit(&solve(&served, &of))
            };
            let h = 0.05;
            let slope = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            let said = gradient[point][axis].as_f64().unwrap();
            let near = 1e-5 * slope.abs().max(1.0);
            assert!(
                (slope - said).abs() < near,
                "{point} {axis}: {slope} {said}"
            );
        }
    }
}

/// Margins have the unit in which the study writes the limits. The test changes the study's unit from millimetres to
/// inches, but not its numbers. Then the numbers of the margins stay the same, and their unit is the inch. Only angles
/// stay in degrees.
#[test]
fn margins_have_the_unit_of_the_study() {
    // Near limits, the program searches for extremes between stations. With two stations far from the limits, it does
    // not search.
    let sample = sample("formula_student_front.toml");
    let lines = sample.lines().map(|line| match line.split_once(" = ") {
        Some(("travel", _)) => "travel = [-30.0, 30.0]",
        _ => line,
    });
    let text = lines.collect::<Vec<_>>().join("\n");
    let inches = text.replace("length_unit = \"mm\"", "length_unit = \"in\"");
    assert_ne!(text, inches);
    let [mm, inches] = [text, inches].map(|text| {
        let served = Served::of(&text);
        let answer = solve(&served, &served.moved("tie_rod_inner", 2, 0.0));
        answer["misfit"].clone()
    });
    let of = |misfit: &Value, list: &str| misfit[list].as_array().unwrap().clone();
    let pairs = || {
        let inches = of(&inches, "constraints");
        of(&mm, "constraints").into_iter().zip(inches)
    };
    assert_eq!(
        of(&mm, "constraints").len(),
        of(&inches, "constraints").len()
    );
    assert!(pairs().count() >= 5);
    for (mm, inches) in pairs() {
        let margins = [&mm, &inches].map(|c| c["margin"].as_f64().unwrap());
        assert!((margins[0] - margins[1]).abs() < 1e-9, "{mm} {inches}");
        let is_angle = mm["name"].as_str().unwrap().contains("articulation");
        let units = if is_angle { ["deg"; 2] } else { ["mm", "in"] };
        assert_eq!([&mm["unit"], &inches["unit"]], units, "{mm}");
        assert_eq!(mm["is_violated"], json!(margins[0] < 0.0));
    }
    for (misfit, unit) in [(&mm, "mm"), (&inches, "in")] {
        assert!(!of(misfit, "targets").is_empty());
        for target in of(misfit, "targets") {
            assert_eq!(target["worst_at_unit"], unit, "{target}");
        }
    }
}

/// The effect of a coordinate on a curve equals the slope of the curves, also if the user holds the curves at a rack
/// displacement.
#[test]
fn influences_are_slopes_of_the_curves() {
    let served = Served::of(&sample("double_wishbone_front.toml"));
    let of = served.moved("tie_rod_inner", 2, 0.0);
    let overview = served.overview();
    let points = overview["points"].as_array().unwrap();
    let point = points
        .iter()
        .position(|p| p["name"] == "tie_rod_inner")
        .unwrap();
    for rack in [Value::Null, json!(20.0)] {
        let asked = json!({"of": of, "characteristics": ["toe"], "point": point, "axis": 2, "curves_rack": rack});
        let found = served.post("influence", &asked).json();
        let toe = |by: f64| {
            let of = served.moved("tie_rod_inner", 2, by);
            let message = json!({"of": of, "characteristics": ["toe"], "at": [0.0, 0.0], "curves_rack": rack, "over": 0});
            answered(&served.post("solve", &message).json())
                .into_iter()
                .find(|(name, _)| name == "toe_deg")
                .unwrap()
                .1
        };
        let (up, down) = (toe(0.01), toe(-0.01));
        let columns = found["columns"].as_array().unwrap();
        let slopes = &columns.iter().find(|c| c["column"] == "toe_deg").unwrap()["slopes"];
        assert!(up.len() > 5, "{}", up.len());
        for station in 0..up.len() {
            let slope = (up[station].unwrap() - down[station].unwrap()) / 0.02;
            let said = slopes[station].as_f64().unwrap();
            assert!(
                (slope - said).abs() < 1e-5,
                "{rack} {station}: {slope} {said}"
            );
        }
    }
}

#[test]
fn the_report_of_a_design_is_served() {
    for name in [
        "macpherson_solve.toml",
        "macpherson_front.toml",
        "five_link_axle.toml",
    ] {
        let served = Served::of(&of_few_stations(&sample(name)));
        let of = served.moved("wheel_centre", 2, 2.5);
        let place = served.post("report", &of).json();
        let page = served.get(place.as_str().unwrap());
        assert_eq!(page.status, 200, "{name}");
        let text = page.text();
        assert!(text.contains("Content-Security-Policy"), "{name}");
        // The report page contains the moved coordinate. If the study has targets, the report page also states how many
        // targets are met.
        let points = served.overview()["points"].clone();
        let points = points.as_array().unwrap();
        let centre = points.iter().position(|p| p["name"] == "wheel_centre");
        let height = of["design"][centre.unwrap()][2].as_f64().unwrap();
        let row = text.split("wheel_<wbr>centre</td>").nth(1).unwrap();
        assert!(
            row.split("</tr>")
                .next()
                .unwrap()
                .contains(&format!(">{height:?}<")),
            "{name}"
        );
        let has_targets = name == "macpherson_front.toml";
        assert_eq!(
            text.contains("of 3 targets are within their tolerance"),
            has_targets
        );
        assert_eq!(text.contains("<dt>Misfit</dt>"), has_targets, "{name}");
        assert_eq!(served.files(), ["study.toml"], "{name}");
    }
}

//! Tests of free directions: moves of points that leave all targets unchanged to first order.

use super::{Served, car, sample};
use crate::support::larger;
use serde_json::{Value, json};

/// Car with more hardpoint variables than residuals. In each of two load cases, a target has one residual. A target for
/// toe on the front axle has two residuals.
fn car_with_freedom() -> Served {
    let variable = |axle: &str, point: &str, axis: &str| {
        format!(
            "  {{ axle = \"{axle}\", hardpoint = \"{point}\", axis = \"{axis}\", range = [-15.0, 15.0] }},\n"
        )
    };
    car::served("formula_student_car", |end, text| {
        if !end.is_empty() {
            return text;
        }
        let more = [
            variable("front", "tie_rod_outer", "z"),
            variable("front", "tie_rod_inner", "y"),
            variable("rear", "tie_rod_inner", "z"),
            variable("rear", "tie_rod_outer", "y"),
        ];
        let at = text.find("]\ntargets = [").unwrap();
        format!("{}{}{}", &text[..at], more.concat(), &text[at..])
    })
}

/// Root mean square deviation of each target, after a move along a direction.
fn deviations(served: &Served, direction: &Value, share: f64) -> Vec<f64> {
    let overview = served.overview();
    let mut design = overview["design"].clone();
    for (point, change) in direction.as_array().unwrap().iter().enumerate() {
        for axis in 0..3 {
            let by = share * change[axis].as_f64().unwrap();
            design[point][axis] = json!(design[point][axis].as_f64().unwrap() + by);
        }
    }
    let at: Vec<Value> = overview["sliders"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s["home"].clone())
        .collect();
    let message = json!({
        "of": {"digest": overview["digest"], "design": design}, "characteristics": car::asked(&overview), "at": at,
        "curves_rack": null, "over": overview["main"],
    });
    let answer = served.post("solve", &message).json();
    let targets = answer["misfit"]["targets"].as_array().unwrap().iter();
    targets
        .map(|target| target["rms"].as_f64().unwrap())
        .collect()
}

/// Largest derivative of a target's deviation along a direction, from a central difference.
fn slope(served: &Served, direction: &Value) -> f64 {
    let step = 0.02;
    let [high, low] = [step, -step].map(|share| deviations(served, direction, share));
    let slopes = high
        .iter()
        .zip(&low)
        .map(|(high, low)| (high - low) / (2.0 * step));
    slopes.fold(0.0, |most, slope| larger(most, slope.abs()))
}

/// Along a free direction, no target changes to first order. Over the range of the direction, the deviation of three
/// equal targets changes by at most sqrt(3) times 0.01 of the tolerance. Along a single variable, some target changes
/// far more.
#[test]
fn targets_do_not_change_along_free_directions() {
    for served in [
        car_with_freedom(),
        Served::of(&sample("macpherson_front.toml")),
    ] {
        let overview = served.overview();
        let of = json!({"digest": overview["digest"], "design": overview["design"]});
        let found = served.post("directions", &of).json();
        let found = found["directions"].as_array().unwrap();
        assert!(!found.is_empty());
        for direction in found {
            let largest = slope(&served, &direction["change"]);
            assert!(largest < 0.02, "{} {largest}", direction["name"]);
        }
        let variables = overview["variables"].as_array().unwrap().iter();
        let straight = variables.filter(|v| !v["moves"].as_array().unwrap().is_empty());
        let alone = straight.map(|variable| {
            let points = overview["points"].as_array().unwrap().len();
            let mut change = vec![[0.0; 3]; points];
            let width =
                variable["range"][1].as_f64().unwrap() - variable["range"][0].as_f64().unwrap();
            for own in variable["moves"].as_array().unwrap() {
                let [point, axis] = [0, 1].map(|k| own[k].as_u64().unwrap() as usize);
                change[point][axis] = width * own[2].as_f64().unwrap();
            }
            slope(&served, &json!(change))
        });
        assert!(alone.fold(0.0, larger) > 1.0);
    }
}

/// The points of a right wheel that the study gives separately move with the design. So the directions of a moved design
/// equal the directions of a study file with this design.
#[test]
fn directions_of_a_moved_axle_are_those_of_its_file() {
    let variables = [
        "lower_rear_link_inner",
        "upper_rear_link_inner",
        "toe_link_outer",
    ]
    .map(|point| {
        format!("  {{ hardpoint = \"{point}\", axis = \"y\", range = [-15.0, 15.0] }},\n")
    });
    let text = sample("five_link_axle_rear.toml")
        .replace(
            "right = \"mirrored\"",
            "right = { hardpoints = { toe_link_inner = [-180.0, -348.0, 262.0] } }",
        )
        .replace(
            "variables = [\n",
            &format!("variables = [\n{}", variables.concat()),
        );
    let served = Served::of(&text);
    let moved = served.moved("toe_link_inner", 2, 12.0);
    let found = served.post("directions", &moved).json();
    let copy = json!({"of": moved, "name": "copy.toml", "anyway": false});
    assert_eq!(served.post("save", &copy).status, 200);
    let file = std::fs::read_to_string(served.folder.path().join("copy.toml")).unwrap();
    let again = Served::of(&file);
    let of = again.moved("toe_link_inner", 2, 0.0);
    let expected = again.post("directions", &of).json();
    let names = |answer: &Value| -> Vec<Value> {
        let all = answer["directions"].as_array().unwrap().iter();
        all.map(|direction| direction["name"].clone()).collect()
    };
    assert!(!names(&expected).is_empty());
    assert_eq!(names(&found), names(&expected));
}

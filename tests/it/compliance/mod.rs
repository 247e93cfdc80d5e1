//! Tests of elasto-kinematics against independent reference values with 120 digits, and against mechanics.

mod axle;
pub mod command;
mod curves;
mod derivatives;
mod ends;
mod joint_forces;
mod lanes;
mod mechanics;
mod member_forces;
mod messages;
mod other_programs;
mod random;
mod reference;
mod refused;
mod reports;
mod robust;
mod samples;
mod schema;
pub mod set_up;
mod sheets;
mod study;
pub mod support;
mod tuning;

use hardpoint::axle::{BumpStop, ForceCurve, Law, SpringLaw};
use hardpoint::compliance::{
    AxialStiffness, BushingPart, Compliance, LinkPart, Relaxed, Shape, WheelLoads, link_members,
};
use hardpoint::model::Suspension;
use hardpoint::number::Vector3;
use hardpoint::study::Study;
use serde_json::Value;
use std::path::Path;

/// Case of the reference values in `tests/data/reference/elasto`.
pub fn case(name: &str) -> Value {
    let path = format!(
        "{}/tests/data/reference/elasto/{name}.json",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    serde_json::from_str(&text).expect("valid JSON")
}

/// Number that the reference stores as text.
pub fn number(value: &Value) -> f64 {
    match value {
        Value::String(text) => text.parse().unwrap(),
        _ => value.as_f64().unwrap_or_else(|| panic!("{value}")),
    }
}

/// Vector of the reference. A missing vector is zero.
pub fn vector(value: &Value) -> Vector3<f64> {
    match value {
        Value::Null => Vector3::new(0.0, 0.0, 0.0),
        _ => Vector3::new(number(&value[0]), number(&value[1]), number(&value[2])),
    }
}

/// Design load of a reference case. 0 for a case whose parts are free of force in the design position.
pub fn design_load(case: &Value) -> f64 {
    match &case["design_load"]["wheel"] {
        Value::Null => 0.0,
        load => number(load),
    }
}

/// Suspension of a reference case, as a study would define it.
pub fn suspension(case: &Value) -> Suspension {
    let topology = case["topology"].as_str().unwrap();
    let topology = topology.strip_suffix("_links").unwrap_or(topology);
    let mut text = format!("[suspension]\ntopology = {topology:?}\n");
    text += "[suspension.hardpoints]\n";
    for (name, point) in case["hardpoints"].as_object().unwrap() {
        text += &format!("{name} = {point}\n");
    }
    text += &format!("[wheel]\nradius = {}\n", case["radius"]);
    for key in ["static_camber", "static_toe"] {
        if !case[key].is_null() {
            text += &format!("{key} = {:?}\n", number(&case[key]));
        }
    }
    text += "[motion]\ntravel = 0.0\n";
    let study = Study::from_text("case.toml", &text, Path::new("."));
    study.unwrap_or_else(|e| panic!("{e:?}")).into_wheel()
}

fn points(value: &Value) -> Vec<[f64; 2]> {
    let pairs = value.as_array().unwrap().iter();
    pairs.map(|p| [number(&p[0]), number(&p[1])]).collect()
}

/// Spring of a reference case.
pub fn spring(case: &Value) -> SpringLaw {
    let spring = &case["spring"];
    let stop = &spring["bump_stop"];
    SpringLaw {
        spring: Law::Linear {
            force: number(&spring["force"]),
            rate: number(&spring["rate"]),
        },
        bump_stop: stop.is_object().then(|| BumpStop {
            gap: number(&stop["gap"]),
            curve: ForceCurve::through(&points(&stop["force_curve"])).unwrap(),
        }),
        rebound_stop: None,
        own_length: None,
    }
}

/// Elastic parts of a reference case. The case has no preloads of links and no axes of bushings.
pub fn compliance(case: &Value, suspension: &Suspension) -> Compliance {
    let mechanism = &suspension.mechanism;
    let empty = serde_json::Map::new();
    let given = case["bushings"].as_object().unwrap_or(&empty);
    let mounts = case["mount"].as_object().unwrap_or(&empty);
    let bushings = given.iter().chain(mounts).map(|(name, stiffness)| {
        let of = |key: &str, k: usize| match &case[key][name] {
            Value::Null => 0.0,
            values => number(&values[k]),
        };
        let shape = |k: usize| match &case["tables"][format!("{name}.{k}")] {
            Value::Null => Shape::Cubic {
                rate: stiffness.get(k).map_or(0.0, number),
                cubic: of("cubic", k),
            },
            table => Shape::Curve {
                curve: ForceCurve::through(&points(table)).unwrap(),
                scale: 1.0,
            },
        };
        BushingPart {
            point: mechanism.point(name).unwrap(),
            shapes: [0, 1, 2, 3, 4, 5].map(shape),
            preload: [0, 1, 2, 3, 4, 5].map(|k| of("preload", k)),
            x_axis: None,
            z_axis: None,
        }
    });
    let members = link_members(mechanism);
    let links = case["links"].as_object().unwrap_or(&empty);
    let links = links.iter().map(|(name, stiffness)| LinkPart {
        member: members.iter().find(|(known, _)| known == name).unwrap().1,
        stiffness: AxialStiffness::Rate(number(stiffness)),
        preload: 0.0,
    });
    Compliance {
        relaxed: match case["relaxed"].as_str().unwrap() {
            "free" => Relaxed::Free,
            _ => Relaxed::AtDesignLoad,
        },
        bushings: bushings.collect(),
        links: links.collect(),
        spring: Some(spring(case)),
    }
}

/// Loads of a state of the reference. The vertical force can include a multiple of the design load.
pub fn loads(load: &Value, design_load: f64) -> WheelLoads {
    let mut contact = vector(&load["contact"]);
    contact.z += load["on_design_load"].as_f64().unwrap_or(0.0) * design_load;
    WheelLoads {
        contact,
        side: load["side"].as_f64().unwrap_or(0.0),
        trail: load["trail"].as_f64().unwrap_or(0.0),
        centre: vector(&load["centre"]),
        moment: vector(&load["moment"]),
    }
}

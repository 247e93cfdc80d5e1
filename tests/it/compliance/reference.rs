//! Tests of states and test results against independent reference values with 120 digits
//! (`tests/data/reference/elasto`).

use super::{case, compliance, design_load, loads, number, suspension};
use crate::support::larger;
use hardpoint::compliance::{
    Change, ElasticWheel, Equilibrium, HeldQuantity, WheelFigures, WheelLoads, link_members,
};
use hardpoint::number::Vector3;
use serde_json::Value;
use std::collections::BTreeMap;

pub const CASES: [&str; 6] = [
    "double_wishbone",
    "double_wishbone_free",
    "macpherson",
    "semi_trailing_arm",
    "double_wishbone_nonlinear_free",
    "formula_student_links",
];

/// Returns the equilibrium of a state of the reference, with the quantity that is held there.
pub fn solved(wheel: &ElasticWheel, state: &Value, design_load: f64) -> Equilibrium {
    let load = &state["load"];
    let rack = load["rack"].as_f64().unwrap_or(0.0);
    let travel = load["travel"].as_f64();
    let start = wheel.at(travel.unwrap_or(0.0), rack).unwrap();
    let mut loads = loads(load, design_load);
    let held = match travel {
        Some(_) => HeldQuantity::WheelHeight,
        None => HeldQuantity::WheelLoad,
    };
    if travel.is_none() {
        loads.contact.z -= wheel.wheel_load(&start);
    }
    wheel.loaded(&start, &loads, held).unwrap()
}

fn put(into: &mut BTreeMap<String, f64>, name: &str, v: Vector3<f64>) {
    for (axis, value) in ["x", "y", "z"].into_iter().zip(v.to_array()) {
        into.insert(format!("{name}_{axis}"), value);
    }
}

/// Test results with their names in the reference.
fn figures(f: &WheelFigures, vertical: f64) -> BTreeMap<String, f64> {
    let mut values = BTreeMap::new();
    put(&mut values, "wheel_centre", f.centre);
    put(&mut values, "contact_point", f.contact);
    let mut add = |name: &str, value: f64| {
        values.insert(name.to_owned(), value);
    };
    add("camber", f.camber);
    add("toe", f.toe);
    add("spin", f.spin);
    if let Some([caster, inclination]) = f.steering {
        add("caster", caster);
        add("kingpin_inclination", inclination);
    }
    add("vertical_contact_force", vertical);
    values
}

/// All values of a state with their names.
fn values(case: &Value, wheel: &ElasticWheel, at: &Equilibrium) -> BTreeMap<String, f64> {
    let suspension = suspension(case);
    let compliance = compliance(case, &suspension);
    let mut values = figures(&wheel.figures(at), wheel.wheel_load(at));
    values.insert("travel".to_owned(), wheel.travel(at));
    put(&mut values, "knuckle_rotation_vector", wheel.rotation(at));
    for (part, found) in compliance.bushings.iter().zip(wheel.bushings(at)) {
        let name = suspension.mechanism.name(part.point);
        put(&mut values, &format!("{name}_deflection"), found.deflection);
        put(&mut values, &format!("{name}_force"), found.force);
        put(&mut values, &format!("{name}_rotation"), found.rotation);
        put(&mut values, &format!("{name}_torque"), found.torque);
        if name == "strut_top" {
            values.insert("strut_top_tilt_x".to_owned(), found.rotation.x);
            values.insert("strut_top_tilt_y".to_owned(), found.rotation.y);
        }
    }
    let members = link_members(&suspension.mechanism);
    for (part, tension) in compliance.links.iter().zip(wheel.tensions(at)) {
        let name = &members.iter().find(|(_, m)| *m == part.member).unwrap().0;
        values.insert(format!("{name}_tension"), tension.unwrap());
    }
    let spring = wheel.spring(at).unwrap();
    values.insert("spring_length".to_owned(), spring.length);
    values.insert("spring_force".to_owned(), spring.force);
    values
}

/// Bound of the error of a value. For lengths it is 1e-11 mm, because positions are sums of several hundred
/// millimetres. For angles it is 1e-13 rad. For a force or a torque, the bound is a deflection or a rotation error
/// times a stiffness.
fn bound(name: &str) -> f64 {
    const LENGTHS: [&str; 5] = [
        "wheel_centre",
        "contact_point",
        "length",
        "deflection",
        "travel",
    ];
    let is = |part: &str| name.contains(part);
    if is("torque") {
        4e5 * 1e-13 * 10.0
    } else if is("force") || is("tension") {
        3e4 * 1e-11
    } else if LENGTHS.iter().any(|part| is(part)) {
        1e-11
    } else {
        1e-13
    }
}

#[test]
fn states_are_those_of_the_reference() {
    let mut worst: BTreeMap<String, (f64, String)> = BTreeMap::new();
    let mut compared = 0;
    for name in CASES {
        let case = case(name);
        let suspension = suspension(&case);
        let wheel = ElasticWheel::new(&suspension, &compliance(&case, &suspension)).unwrap();
        let design_load = design_load(&case);
        assert_eq!(wheel.design_load().is_some(), design_load > 0.0, "{name}");
        if let Some(found) = wheel.design_load() {
            assert!((found - design_load).abs() < 1e-10 * design_load, "{name}");
        }
        let names = case["names"]["values"].as_array().unwrap();
        for (k, state) in case["states"].as_array().unwrap().iter().enumerate() {
            let at = solved(&wheel, state, design_load);
            let found = values(&case, &wheel, &at);
            for (value, expected) in names.iter().zip(state["values"].as_array().unwrap()) {
                let value = value.as_str().unwrap();
                let Some(found) = found.get(value) else {
                    continue;
                };
                compared += 1;
                let error = (found - number(expected)).abs() / bound(value);
                let label = format!("{name} {k} {value}: {found} {expected}");
                let entry = worst.entry(name.to_owned()).or_default();
                if error > entry.0 || error.is_nan() {
                    *entry = (error, label);
                }
            }
        }
    }
    for (error, label) in worst.values() {
        println!("{error:.2e} {label}");
    }
    // States times values: three double wishbones, the strut, the arm, and the tubes.
    assert_eq!(compared, 3 * 13 * 66 + 13 * 51 + 13 * 40 + 12 * 24);
    assert!(worst.values().all(|(error, _)| *error < 1.0));
}

/// Unit load of the reference.
pub fn unit(name: &str) -> WheelLoads {
    let mut load = WheelLoads::none(0.0);
    match name {
        "lateral" => load.side = 1.0,
        "lateral_trail_30" => (load.side, load.trail) = (1.0, 30.0),
        "braking" => load.contact.x = -1.0,
        "traction" => load.centre.x = 1.0,
        "aligning" => load.moment.z = 1.0,
        "vertical" => load.contact.z = 1.0,
        _ => panic!("{name}"),
    }
    load
}

#[test]
fn metrics_are_those_of_the_reference() {
    let (mut worst, mut compared) = ((0.0, String::new()), 0);
    for name in CASES {
        let case = case(name);
        let suspension = suspension(&case);
        let wheel = ElasticWheel::new(&suspension, &compliance(&case, &suspension)).unwrap();
        let design_load = design_load(&case);
        let names = case["names"]["metrics"].as_array().unwrap();
        for (k, state) in case["states"].as_array().unwrap().iter().enumerate() {
            let at = solved(&wheel, state, design_load);
            for (key, held) in [
                ("metrics_height_held", HeldQuantity::WheelHeight),
                ("metrics_load_held", HeldQuantity::WheelLoad),
            ] {
                for (load, expected) in state[key].as_object().into_iter().flatten() {
                    let change = Change::Load(unit(load));
                    let by = wheel.figures_by(&at, &change, held).unwrap();
                    let found = figures(&by, by.vertical);
                    // Scale of the error: the largest result of the same kind (angles, lengths or forces) in the same
                    // test.
                    let scale = |value: &str| {
                        let is_angle = |n: &str| {
                            !n.contains("wheel_centre")
                                && !n.contains("contact_point")
                                && n != "vertical_contact_force"
                        };
                        let of_kind = names.iter().zip(expected.as_array().unwrap());
                        let of_kind = of_kind.filter(|(n, _)| {
                            let n = n.as_str().unwrap();
                            is_angle(n) == is_angle(value)
                                && (n == "vertical_contact_force")
                                    == (value == "vertical_contact_force")
                        });
                        of_kind.fold(0.0_f64, |m, (_, v)| larger(m, number(v).abs()))
                    };
                    for (value, expected) in names.iter().zip(expected.as_array().unwrap()) {
                        let value = value.as_str().unwrap();
                        if value == "vertical_contact_force" && held == HeldQuantity::WheelLoad {
                            continue;
                        }
                        let found = found[value];
                        compared += 1;
                        let error = (found - number(expected)).abs() / scale(value);
                        if error > worst.0 || error.is_nan() {
                            worst = (
                                error,
                                format!("{name} {k} {key} {load} {value}: {found} {expected}"),
                            );
                        }
                    }
                }
            }
        }
    }
    println!("{worst:?}");
    // In each of eight states, five loads act at a held height and six at a held wheel load. There are eleven results, or
    // ten for the arm without a steering axis. The vertical force is compared only if the height is held.
    assert_eq!(compared, 8 * (5 * (5 * 11 + 6 * 10) + 5 * 10 + 6 * 9));
    assert!(worst.0 < 1e-10, "{worst:?}");
}

/// Secants over +-1000 N and +-100 N m with the wheel height held equal those of the reference.
#[test]
fn secants_are_those_of_the_reference() {
    let mut compared = 0;
    for name in CASES {
        let case = case(name);
        let suspension = suspension(&case);
        let wheel = ElasticWheel::new(&suspension, &compliance(&case, &suspension)).unwrap();
        let names = case["names"]["metrics"].as_array().unwrap();
        let state = &case["states"][0];
        let design_load = wheel.design_load().unwrap_or(0.0);
        let at = solved(&wheel, state, design_load);
        for (load, expected) in state["secants_height_held"].as_object().unwrap() {
            let window = if load == "aligning" { 1e5 } else { 1e3 };
            let end = |sign: f64| {
                let mut loads = WheelLoads::none(0.0).plus(&unit(load), sign * window);
                loads.trail = unit(load).trail;
                let held = HeldQuantity::WheelHeight;
                let at = wheel.loaded_about(&at, &at, &loads, held).unwrap();
                figures(&wheel.figures(&at), wheel.wheel_load(&at))
            };
            let (low, high) = (end(-1.0), end(1.0));
            let mut found = BTreeMap::new();
            for (name, value) in &high {
                found.insert(name.clone(), (value - low[name]) / (2.0 * window));
            }
            for (value, expected) in names.iter().zip(expected.as_array().unwrap()) {
                let value = value.as_str().unwrap();
                let error = (found[value] - number(expected)).abs();
                // The value is a difference of states that are accurate to 1e-11 mm, 1e-13 rad and 1e-7 N.
                let bound = if value == "vertical_contact_force" {
                    1e-7
                } else if value.contains("wheel_centre") || value.contains("contact") {
                    1e-11
                } else {
                    1e-13
                };
                assert!(error < bound / window, "{name} {load} {value}: {error:e}");
                compared += 1;
            }
        }
    }
    // Five loads, with eleven results, or ten for the arm without a steering axis.
    assert_eq!(compared, 5 * (5 * 11 + 10));
}

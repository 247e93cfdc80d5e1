//! Tests of derivatives of equilibria and test results with respect to hardpoints, rates and the spring, against an
//! independent reference with 120 digits.

use super::reference::{CASES, solved, unit};
use super::{case, compliance, design_load, number, suspension};
use crate::support::larger;
use hardpoint::compliance::{
    Change, Compliance, ElasticWheel, Equilibrium, HeldQuantity, OnTape, Parameter, Shape,
    link_members,
};
use hardpoint::model::{Axis, Suspension};
use hardpoint::number::{Tape, Tracked};
use std::collections::BTreeMap;

/// Input with this name in the reference.
fn parameter(name: &str, suspension: &Suspension, parts: &Compliance) -> Parameter {
    let mechanism = &suspension.mechanism;
    match name {
        "spring rate" => return Parameter::SpringRate,
        "spring force" => return Parameter::SpringForce,
        _ => {}
    }
    if let Some((kind, rest)) = name.split_once(' ') {
        let Some((part, axis)) = rest.split_once('.') else {
            let members = link_members(mechanism);
            let (_, member) = members.iter().find(|(known, _)| known == rest).unwrap();
            let links = &mut parts.links.iter();
            return Parameter::Link(links.position(|link| link.member == *member).unwrap());
        };
        let bushing = parts.bushing_at(mechanism.point(part).unwrap()).unwrap();
        let axis = axis.parse().unwrap();
        return match kind {
            "stiffness" => Parameter::Stiffness(bushing, axis),
            "preload" => Parameter::Preload(bushing, axis),
            _ => panic!("{name}"),
        };
    }
    let (point, axis) = name.rsplit_once('.').unwrap();
    let axis = match axis {
        "x" => Axis::X,
        "y" => Axis::Y,
        _ => Axis::Z,
    };
    Parameter::Point(mechanism.point(point).unwrap(), axis)
}

/// Returns the kind of an input. Derivatives with respect to inputs of one kind have the same unit. The test divides
/// each error by the largest derivative of the same kind.
fn kind(name: &str) -> &str {
    match name.split_once(' ') {
        None => "hardpoint",
        Some((_, "rate")) => "stiffness",
        Some((_, rest)) if rest.ends_with(['3', '4', '5']) => "torsion",
        Some((kind, _)) => kind,
    }
}

/// Returns true for the rate of an axis with a force curve. The reference gives the derivative with respect to the rate,
/// which is 0 for a curve. The input of the program is a factor on the curve instead.
fn is_of_curve(parameter: Parameter, parts: &Compliance) -> bool {
    match parameter {
        Parameter::Stiffness(bushing, axis) => {
            matches!(parts.bushings[bushing].shapes[axis], Shape::Curve { .. })
        }
        _ => false,
    }
}

/// Values of an equilibrium with their names in the reference.
fn values<'t>(
    suspension: &Suspension,
    parts: &Compliance,
    wheel: &ElasticWheel<Tracked<'t>>,
    at: &Equilibrium<Tracked<'t>>,
) -> BTreeMap<String, Tracked<'t>> {
    let f = wheel.figures(at);
    let mut found = BTreeMap::new();
    let mut add = |name: &str, value| {
        found.insert(name.to_owned(), value);
    };
    add("toe", f.toe);
    add("camber", f.camber);
    add("spin", f.spin);
    add("wheel_centre_x", f.centre.x);
    add("wheel_centre_y", f.centre.y);
    add("contact_point_y", f.contact.y);
    add("travel", wheel.travel(at));
    add("vertical_contact_force", wheel.wheel_load(at));
    add("spring_force", wheel.spring(at).unwrap().force);
    for (part, reading) in parts.bushings.iter().zip(wheel.bushings(at)) {
        let name = suspension.mechanism.name(part.point);
        add(&format!("{name}_force_y"), reading.force.y);
        add(&format!("{name}_deflection_z"), reading.deflection.z);
    }
    let members = link_members(&suspension.mechanism);
    for (part, tension) in parts.links.iter().zip(wheel.tensions(at)) {
        let (name, _) = members.iter().find(|(_, m)| *m == part.member).unwrap();
        add(&format!("{name}_tension"), tension.unwrap());
    }
    found
}

/// Test results with their names in the reference.
fn figures<'t>(
    wheel: &ElasticWheel<Tracked<'t>>,
    at: &Equilibrium<Tracked<'t>>,
) -> Vec<(&'static str, Tracked<'t>)> {
    let held = wheel.tangent(at, HeldQuantity::WheelHeight).unwrap();
    let free = wheel.tangent(at, HeldQuantity::WheelLoad).unwrap();
    let load = |name| Change::Load(unit(name).map(Tracked::constant));
    let by = |name| wheel.figures_along(&held, &load(name)).unwrap();
    let (lateral, braking, aligning) = (by("lateral"), by("braking"), by("aligning"));
    let vertical = wheel.figures_along(&free, &load("vertical")).unwrap();
    vec![
        ("toe_by_lateral", lateral.toe),
        ("camber_by_lateral", lateral.camber),
        ("contact_by_lateral", -lateral.contact.y),
        ("toe_by_lateral_trail_30", by("lateral_trail_30").toe),
        ("toe_by_aligning", aligning.toe),
        ("toe_by_braking", braking.toe),
        ("recession_by_braking", -braking.centre.x),
        ("jacking_by_lateral", lateral.vertical),
        ("wheel_rate", Tracked::constant(1.0) / vertical.contact.z),
    ]
}

#[test]
fn derivatives_are_those_of_the_reference() {
    let mut worst: BTreeMap<String, (f64, String)> = BTreeMap::new();
    let (mut compared, mut missing) = (0, BTreeMap::new());
    for name in CASES {
        let case = case(name);
        let suspension = suspension(&case);
        let parts = compliance(&case, &suspension);
        let wheel = ElasticWheel::new(&suspension, &parts).unwrap();
        let design_load = design_load(&case);
        let list = |key: &str| case["names"][key].as_array().cloned().unwrap_or_default();
        for (k, state) in case["states"].as_array().unwrap().iter().enumerate() {
            let Some(inputs) = state["sens"].as_object() else {
                continue;
            };
            let parameters: Vec<Parameter> = inputs
                .keys()
                .map(|input| parameter(input, &suspension, &parts))
                .collect();
            let at = solved(&wheel, state, design_load);
            let tape = Tape::new();
            let design = &suspension.design;
            let varied = OnTape::new(&suspension, design, &parts, &parameters, &tape).unwrap();
            let moving = varied.carried(&at).unwrap();
            let found = values(&suspension, &parts, &varied.wheel, &moving);
            let mut outputs: Vec<(String, Option<Tracked<'_>>)> = Vec::new();
            for name in list("sens") {
                let name = name.as_str().unwrap().to_owned();
                let value = found.get(&name).copied();
                outputs.push((name, value));
            }
            if !state["named"].is_null() {
                let figures = figures(&varied.wheel, &moving);
                for (name, named) in list("named").iter().zip(state["named"].as_array().unwrap()) {
                    let name = name.as_str().unwrap();
                    let value = figures.iter().find(|(known, _)| *known == name);
                    let value = value.unwrap().1;
                    let error = (value.plain() - number(named)).abs();
                    assert!(error < 1e-10 * number(named).abs().max(1e-9), "{name}");
                    outputs.push((name.to_owned(), Some(value)));
                }
            }
            let mut gradient = Vec::new();
            for (column, (output, value)) in outputs.iter().enumerate() {
                let Some(value) = value else {
                    *missing.entry(output.clone()).or_insert(0) += 1;
                    continue;
                };
                tape.gradients(&[*value], inputs.len(), |_, by| gradient = by.to_vec());
                let largest_of = |of: &dyn Fn(&str) -> bool| {
                    let own = inputs.iter().filter(|(input, _)| of(input));
                    own.fold(0.0_f64, |m, (_, v)| larger(m, number(&v[column]).abs()))
                };
                for (number_of, (input, expected)) in inputs.iter().enumerate() {
                    let expected = number(&expected[column]);
                    let slope = gradient.get(number_of).copied().unwrap_or(0.0);
                    if is_of_curve(parameters[number_of], &parts) {
                        continue;
                    }
                    // The scale is the largest derivative for inputs of this kind. If no input of this kind has an
                    // effect, the other inputs set the scale. Angles in a held design position depend on no input. For
                    // them the scale is 1e-3 (1 mm at a distance of 1 m).
                    let largest = match largest_of(&|other| kind(other) == kind(input)) {
                        0.0 => largest_of(&|_| true).max(1e-3),
                        largest => largest,
                    };
                    compared += 1;
                    // The strict bound is relative to the largest derivative of the output. If terms cancel, the error
                    // can be large relative to derivatives of the same kind. So the bound for one kind is wider.
                    let whole = largest_of(&|_| true).max(largest);
                    let error = (slope - expected).abs() / whole;
                    let of_kind = (slope - expected).abs() / largest;
                    assert!(
                        of_kind < 1e-6,
                        "{k} {output} by {input}: {slope} {expected}"
                    );
                    let entry = worst.entry(name.to_owned()).or_default();
                    if error > entry.0 || error.is_nan() {
                        let label = format!("{k} {output} by {input}: {slope} {expected}");
                        *entry = (error, label);
                    }
                }
            }
            println!("{name} {k}: {} notes", tape.len());
        }
    }
    println!("{compared} compared, missing: {missing:?}");
    for (name, (error, label)) in &worst {
        println!("{name} {error:.2e} {label}");
    }
    assert!(compared > 13_000, "{compared}");
    // Outputs of the reference that the equilibrium does not have: the tension of a rigid tie rod (three cases), and a force
    // that `values` does not read (one case). Each case has two states with derivatives.
    let without = [("arm_pivot_outer_force_x", 2), ("tie_rod_tension", 6)];
    let without = without.map(|(name, count)| (name.to_owned(), count));
    assert_eq!(missing, BTreeMap::from(without));
    assert_eq!(worst.len(), CASES.len());
    assert!(worst.values().all(|(error, _)| *error < 1e-10));
}

//! Tests of derivatives with respect to travels, hardpoints and rates, against the exact linearisation of the second
//! formulation.

use super::second::{Axle, Input};
use super::{Kind, STILL, Scatter, elastic, is_angle, made, number_of, study};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::axle_curves;
use hardpoint::compliance::{AxleOnTape, AxleParameter, ElasticAxle, Parameter};
use hardpoint::model::{Axis, Side};
use hardpoint::number::{Real, Tape, Tracked};

/// Returns the link ends that move with a hardpoint of the left half, each with a weight, in the axes of the study.
fn ends_of(axle: &Axle, name: &str, is_axle: bool, axis: usize) -> Input {
    let own = axle
        .links
        .iter()
        .enumerate()
        .filter(|(_, link)| link.name == name);
    let ends = own.enumerate().map(|(place, (number, _))| {
        // If two links have one name, the second link is the mirror image.
        let weight = if place == 1 && axis == 1 { -1.0 } else { 1.0 };
        (number, is_axle, axis, weight)
    });
    Input::Ends(ends.collect())
}

/// Returns the results of an axle in tracked numbers (numbers with derivatives), in the order of the second formulation.
fn tracked<'t>(
    axle: &ElasticAxle<Tracked<'t>>,
    at: &hardpoint::compliance::AxleEquilibrium<Tracked<'t>>,
) -> Vec<Tracked<'t>> {
    let mut found = Vec::new();
    for side in Side::ALL {
        let own = axle.figures(at, side);
        let out = if side == Side::Left { 1.0 } else { -1.0 };
        found.extend([own.toe, own.camber]);
        for point in [own.centre, own.contact] {
            found.extend([point.x, point.y * Tracked::constant(out), point.z]);
        }
    }
    let place = axle.place(at).expect("a solid axle");
    found.push((-place.line.x).atan2(place.line.y));
    found.push(place.forward.z.atan2(place.forward.x));
    found.extend(place.middle.to_array());
    found
}

/// Derivatives with respect to link points and rates of both halves together equal those of the second formulation. The
/// test compares derivatives per 100 mm, and per hundredth of a rate.
#[test]
fn derivatives_by_hardpoints_and_rates_are_those_of_the_second_formulation() {
    let mut random = Random(77);
    let mut worst = 0.0_f64;
    for number in 0..12 {
        let kind = [Kind::FiveLink, Kind::FourLink, Kind::ThreeLinkPanhard][number % 3];
        let scatter = Scatter {
            points: 25.0,
            differs: number % 2 == 1,
            rates: [4.0, 5.0],
            springs: number % 4 != 3,
        };
        let made = made(kind, scatter, &mut random, STILL);
        let travels = [40.0 * random.signed(), 40.0 * random.signed()];
        let study = study(&made.text);
        let plain = elastic(&study);
        let at = plain.at(travels, 0.0).unwrap();
        let parts = &study.axle.elastic.as_ref().unwrap().parts;
        let mechanism = &study.axle.left.mechanism;
        let mut inputs = Vec::new();
        let mut parameters: Vec<AxleParameter> = Vec::new();
        let mut scales = Vec::new();
        let names = ["lower_link", "upper_link", "panhard"];
        for name in names {
            if kind == Kind::FourLink && name == "panhard" {
                continue;
            }
            for (is_axle, end) in [(false, "chassis"), (true, "axle")] {
                let id = mechanism.point(&format!("{name}_{end}")).unwrap();
                for (k, axis) in Axis::ALL.into_iter().enumerate() {
                    inputs.push(ends_of(&made.axle, name, is_axle, k));
                    parameters.push(Parameter::Point(id, axis).into());
                    scales.push(100.0);
                }
            }
            // A rate parameter changes the links of both halves, even if the study gives the right half a separate
            // rate.
            let own = made.axle.links.iter().enumerate();
            let own: Vec<usize> = own
                .filter(|(_, l)| l.name == name)
                .map(|(k, _)| k)
                .collect();
            scales.push(0.01 * made.axle.links[own[0]].rate);
            inputs.push(Input::Rate(own));
            parameters.push(Parameter::Link(number_of(&study, name)).into());
        }
        let sides = Side::ALL.map(|side| study.axle.suspension(side));
        let designs = sides.map(|side| &side.design[..]);
        let tape = Tape::new();
        let varied = AxleOnTape::new(sides, designs, parts, &parameters, &tape).unwrap();
        let there = varied.carried(&at).unwrap();
        let found = tracked(&varied.axle, &there);
        let mut ours = vec![Vec::new(); found.len()];
        tape.gradients(&found, parameters.len(), |k, by| ours[k] = by.to_vec());
        let pose = made.axle.solve(travels);
        let theirs = made.axle.slopes(&pose, travels, &inputs);
        for (k, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            let scale = if is_angle(k) { 300.0 } else { 1.0 };
            assert_eq!((ours.len(), theirs.len()), (inputs.len(), inputs.len()));
            for (i, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
                let error = (ours - theirs).abs() * scales[i] * scale;
                worst = larger(worst, error);
                assert!(
                    error < 1e-9,
                    "{number}, result {k}, input {i}: {ours} {theirs}"
                );
            }
        }
    }
    println!("worst: {worst:e} mm");
}

/// The velocity columns of `solve` with respect to heave and to each travel equal those of the second formulation.
#[test]
fn derivatives_by_travels_are_those_of_the_second_formulation() {
    const NAMES: [&str; 4] = [
        "pinion_angle",
        "axle_steer",
        "axle_lateral",
        "axle_longitudinal",
    ];
    let mut random = Random(5);
    for kind in [Kind::FiveLink, Kind::FourLink, Kind::ThreeLinkPanhard] {
        let scatter = Scatter {
            points: 25.0,
            differs: true,
            rates: [4.0, 5.0],
            springs: true,
        };
        let further = "[motion]\ntravel_left = [-30.0, 20.0]\ntravel_right = [10.0, 25.0]\n[outputs]\norder = \"velocity\"\n\
                       characteristics = [\"axle_steer\", \"pinion_angle\", \"axle_lateral\", \"axle_longitudinal\", \"mean_steer\"]\n";
        let made = made(kind, scatter, &mut random, further);
        let study = study(&made.text);
        let curves = axle_curves(&study.axle, &study.plan).unwrap().curves;
        let inputs = [Input::Travel(0), Input::Travel(1)];
        let mut compared = 0;
        for (station, travels) in
            curves
                .stations
                .iter()
                .zip([[-30.0, 10.0], [-30.0, 25.0], [20.0, 10.0], [20.0, 25.0]])
        {
            let pose = made.axle.solve(travels);
            let slopes = made.axle.slopes(&pose, travels, &inputs);
            let values = made.axle.results(&pose);
            for (column, value) in curves.columns.iter().zip(&station.values) {
                let value = *value.as_ref().unwrap();
                let Some(name) = NAMES.iter().find(|name| column.name.starts_with(**name)) else {
                    continue;
                };
                let row = match *name {
                    "axle_steer" => 16,
                    "pinion_angle" => 17,
                    "axle_longitudinal" => 18,
                    _ => 19,
                };
                let factor = if is_angle(row) {
                    180.0 / std::f64::consts::PI
                } else {
                    1.0
                };
                let expected = match () {
                    () if column.name.contains("by_travel_left") => slopes[row][0],
                    () if column.name.contains("by_travel_right") => slopes[row][1],
                    () => values[row],
                };
                compared += 1;
                let error = (value - expected * factor).abs();
                assert!(
                    error < 1e-8,
                    "{}: {value} {}",
                    column.name,
                    expected * factor
                );
            }
        }
        assert_eq!(
            compared,
            4 * 4 * 3,
            "columns: {:?}",
            curves.columns.iter().map(|c| &c.name).collect::<Vec<_>>()
        );
    }
}

/// Sensitivities of `solve` are derivatives with respect to points of the left half. The right half moves as the mirror
/// image.
#[test]
fn sensitivities_of_solve_are_those_of_the_second_formulation() {
    let mut random = Random(8);
    let scatter = Scatter {
        points: 25.0,
        differs: true,
        rates: [4.0, 5.0],
        springs: true,
    };
    let further = "[motion]\ntravel_left = [30.0]\ntravel_right = [-20.0]\n[outputs]\ncharacteristics = [\"pinion_angle\"]\n\
                   sensitivities = [\"upper_link_axle\", \"panhard_axle\"]\n";
    let made = made(Kind::FiveLink, scatter, &mut random, further);
    let study = study(&made.text);
    let found = axle_curves(&study.axle, &study.plan)
        .unwrap()
        .curves
        .sensitivities;
    assert_eq!(found.len(), 6);
    let travels = [30.0, -20.0];
    let pose = made.axle.solve(travels);
    for own in &found {
        assert_eq!(own.side, None);
        let name = study.axle.left.mechanism.name(own.point);
        let name = name.strip_suffix("_axle").unwrap();
        let input = ends_of(&made.axle, name, true, own.axis as usize);
        let expected = made.axle.slopes(&pose, travels, &[input])[17][0].to_degrees();
        assert!(
            (own.value - expected).abs() < 1e-10,
            "{name}: {} {expected}",
            own.value
        );
        assert!(expected.abs() > 1e-8, "{name}: {expected}");
    }
}

/// Gradients of the link results in the roll test equal difference quotients (fourth order) of complete studies.
#[test]
fn gradients_of_link_figures_are_those_of_whole_studies() {
    use hardpoint::compliance::{AxleKcRun, AxleVehicle, TestLoad};
    let mut random = Random(11);
    let scatter = Scatter {
        points: 20.0,
        differs: true,
        rates: [4.0, 4.5],
        springs: true,
    };
    let made = made(Kind::FiveLink, scatter, &mut random, STILL);
    let study = study(&made.text);
    let vehicle = AxleVehicle {
        suspensions: Side::ALL.map(|side| study.axle.suspension(side)),
        tyre_rate: None,
    };
    let elastic = study.axle.elastic.as_ref().unwrap();
    let test = *elastic
        .tests
        .iter()
        .find(|test| test.load == TestLoad::Roll)
        .unwrap();
    let travels = [25.0, -10.0];
    let mechanism = &study.axle.left.mechanism;
    let id = mechanism.point("upper_link_axle").unwrap();
    let upper = number_of(&study, "upper_link");
    let parameters = [Parameter::Link(upper), Parameter::Point(id, Axis::Z)];
    let values = |change: [f64; 2]| -> Vec<(String, f64)> {
        let mut parts = elastic.parts.clone();
        for wheel in &mut parts.wheels {
            let hardpoint::compliance::AxialStiffness::Rate(rate) =
                &mut wheel.links[upper].stiffness
            else {
                panic!("a rate");
            };
            *rate += change[0];
        }
        let designs = Side::ALL.map(|side| {
            let mut design = study.axle.suspension(side).design.clone();
            design[id.0].z += change[1];
            design
        });
        let run = AxleKcRun::of(vehicle, [&designs[0], &designs[1]], &parts).unwrap();
        let stations = run.run(&[(travels, 0.0)], &[test]);
        let figures = &stations[0].outcomes.as_ref().unwrap()[0].figures;
        let of = |f: &hardpoint::compliance::KcFigure| {
            (format!("{:?} {}", f.of, f.quantity), f.value.unwrap())
        };
        figures.iter().map(of).collect()
    };
    let run = AxleKcRun::new(vehicle, &elastic.parts).unwrap();
    let gradients = run
        .gradients(travels, 0.0, &[test], &parameters)
        .unwrap()
        .remove(0);
    let base = values([0.0; 2]);
    let mut seen = 0;
    for (k, (name, value)) in base.iter().enumerate() {
        if !(name.contains("tension") || name.contains("roll_stiffness")) {
            continue;
        }
        seen += 1;
        for (i, step) in [200.0, 0.5].into_iter().enumerate() {
            let at = |factor: f64| {
                let mut change = [0.0; 2];
                change[i] = factor * step;
                values(change)[k].1
            };
            let (near, far) = (at(0.5) - at(-0.5), at(1.0) - at(-1.0));
            let slope = (8.0 * near - far) / (6.0 * step);
            let own = gradients[k][0].as_ref().unwrap()[i];
            let scale = value.abs().max(1.0) / [1e4, 100.0][i];
            assert!(
                (own - slope).abs() < 1e-6 * scale.max(slope.abs()),
                "{name}, {i}: {own} {slope}"
            );
        }
    }
    // There are seven results: those of two links of each half, of the rod, and of the roll stiffness of the links alone
    // and with springs.
    assert_eq!(seen, 7, "{base:?}");
}

//! Tests of the general closure (six unknowns), solved in small steps, against the solutions in closed form.

use super::{at, template, travel};
use crate::support::Worst;
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::mechanism::Pose;
use hardpoint::model::{Drive, Mechanism};
use hardpoint::number::{Jet, Vector3};

/// Results at a station: the pose; values of characteristics with two derivatives; and the sensitivities of values and
/// derivatives.
struct Reading {
    pose: Pose<f64>,
    values: Vec<[f64; 3]>,
    sensitivities: Vec<[Vector3<f64>; 3]>,
}

const READ: [Characteristic; 4] = [
    Characteristic::Camber,
    Characteristic::Toe,
    Characteristic::Caster,
    Characteristic::KingpinInclination,
];

fn read(
    mechanism: &Mechanism,
    design: &[Vector3<f64>],
    point: MotionPoint<f64>,
) -> Option<(Reading, f64)> {
    let design_series = DesignSeries::<3>::new(mechanism, design);
    at(mechanism, design, point, |solver, pose| {
        let linearised = solver
            .linearised(&design_series, pose, &point.along_drive())
            .unwrap();
        let view = WheelReading::of(&linearised.at, Constants::default());
        let mut values = Vec::new();
        let mut sensitivities = vec![[Vector3::default(); 3]; READ.len() * design.len()];
        let mut buffer = vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); design.len()];
        for (i, c) in READ.into_iter().enumerate() {
            let quantity = Quantity::Characteristic(c);
            let series = view.value(&linearised.at, quantity);
            values.push([0, 1, 2].map(|order| series.derivative(order)));
            view.gradients(
                &linearised,
                quantity,
                2,
                &mut buffer,
                &mut |order, id, gradient| {
                    sensitivities[i * design.len() + id.0][order] = gradient;
                },
            );
        }
        let reading = Reading {
            pose: *pose,
            values,
            sensitivities,
        };
        (reading, solver.size())
    })
    .ok()?
    .ok()
}

fn compare(topology: &str, seed: u64) {
    let suspension = template(topology);
    let closed = &suspension.mechanism;
    let general = Mechanism {
        closed_form: None,
        ..closed.clone()
    };
    let mut random = Random(seed);
    let mut position = Worst::default();
    let (mut derivatives, mut gradients) = ([Worst::default(); 3], [Worst::default(); 3]);
    let (mut solved, mut neither) = (0, 0);
    for i in 0..10_000 {
        let design = random.scattered(&suspension.design, 30.0);
        let rack = 40.0 * random.signed();
        let point = match i % 4 {
            0 => MotionPoint {
                drive: Drive::ArmAngle,
                value: 0.2 * random.signed(),
                rack,
            },
            _ => travel(80.0 * random.signed(), rack),
        };
        let (a, b) = (read(closed, &design, point), read(&general, &design, point));
        let (Some((a, size)), Some((b, _))) = (&a, &b) else {
            assert!(
                a.is_none() && b.is_none(),
                "{i}: one finds a pose, the other none"
            );
            neither += 1;
            continue;
        };
        solved += 1;
        position.note((a.pose.origin - b.pose.origin).norm() / size);
        for (p, q) in a.pose.rotation.columns.iter().zip(b.pose.rotation.columns) {
            position.note((*p - q).norm());
        }
        for order in 0..3 {
            let largest = a.values.iter().map(|v| v[order].abs()).fold(0.0, larger);
            for (p, q) in a.values.iter().zip(&b.values) {
                derivatives[order].note((p[order] - q[order]) / largest);
            }
            let sizes = a.sensitivities.iter().map(|g| g[order].norm());
            let largest = sizes.fold(0.0, larger);
            for (p, q) in a.sensitivities.iter().zip(&b.sensitivities) {
                gradients[order].note((p[order] - q[order]).norm() / largest);
            }
        }
    }
    println!(
        "{topology}: {solved} solved, {neither} by neither, position {:.1e}, derivatives {:?}, gradients {:?}",
        position.0,
        derivatives.map(|w| w.0),
        gradients.map(|w| w.0)
    );
    assert!(solved > 9_000);
    assert!(position.0 < 1e-12, "{:e}", position.0);
    for worst in derivatives.into_iter().chain(gradients) {
        assert!(worst.0 < 1e-9, "{:e}", worst.0);
    }
}

#[test]
fn strut() {
    compare("macpherson", 3);
}

#[test]
fn double_wishbone() {
    compare("double_wishbone", 4);
}

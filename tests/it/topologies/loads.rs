//! Tests of link forces against equilibrium calculated by hand. Tests of virtual work with the motion ratio.

use super::{at, template, travel};
use crate::support::Worst;
use crate::support::random::Random;
use hardpoint::analyse::{Carried, Load, Reaction, Reactions, Support};
use hardpoint::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint::derive::DesignSeries;
use hardpoint::mechanism::Configuration;
use hardpoint::model::{Axis, Body, Mechanism, PointId};
use hardpoint::number::{Jet, Vector3};

/// Returns the resultant force and moment of the load and of all forces on the wheel carrier, relative to the sum of the forces
/// and to the size of the suspension. Moments are about the wheel centre.
fn resultants(
    mechanism: &Mechanism,
    place: &dyn Fn(PointId) -> Vector3<f64>,
    load: &Load,
    found: &Reactions<f64>,
    size: f64,
) -> [f64; 2] {
    let seat = mechanism.spring_seat().unwrap();
    let support_at = match mechanism.body(seat) {
        Body::Arm(arm) => mechanism.arms[arm.0].outer,
        _ => seat,
    };
    let forces = found
        .constraints
        .iter()
        .flat_map(|reaction| match *reaction {
            Reaction::Rod {
                inner,
                outer,
                tension,
            } => {
                let pull = (place(inner) - place(outer)).normalised() * tension;
                vec![(place(outer), pull)]
            }
            Reaction::ArmEnd {
                outer,
                force,
                joint,
                passed,
                ..
            } => vec![(place(outer), force), (place(joint), passed)],
            Reaction::Force { point, force } => vec![(place(point), force)],
        });
    let all = forces.chain([
        (place(support_at), found.support_force),
        (load.point, load.force),
    ]);
    let about = place(mechanism.wheel_centre);
    let mut force = Vector3::default();
    let (mut moment, mut sum) = (load.moment, 0.0);
    for (p, f) in all {
        force = force + f;
        moment = moment + (p - about).cross(f);
        sum += f.norm();
    }
    [force.norm() / sum, moment.norm() / (sum * size)]
}

/// Power of the load, per unit of the speed of the travel.
fn power(
    mechanism: &Mechanism,
    view: &WheelReading<2>,
    at: &Configuration<'_, Jet<f64, 2>>,
    load: &Load,
) -> f64 {
    let rate = |quantity, order: usize| view.value(at, quantity).derivative(order);
    let centre = Vector3::from(
        Axis::ALL.map(|axis| rate(Quantity::Coordinate(mechanism.wheel_centre, axis), 1)),
    );
    let turn = Vector3::from(Axis::ALL.map(|axis| rate(Quantity::AngularVelocity(axis), 0)));
    let about = at.point(mechanism.wheel_centre).map(|c| c[0]);
    let velocity = centre + turn.cross(load.point - about);
    load.force.dot(velocity) + load.moment.dot(turn)
}

#[test]
fn loads_are_balanced_and_the_spring_takes_its_share() {
    let mut random = Random(12);
    for name in [
        "macpherson",
        "double_wishbone",
        "five_link",
        "semi_trailing_arm",
        "double_wishbone_pushrod",
        "integral_link",
        "h_arm",
    ] {
        let suspension = template(name);
        let mechanism = &suspension.mechanism;
        let spring = mechanism.spring.unwrap();
        let design_series = DesignSeries::<2>::new(mechanism, &suspension.design);
        let (mut balance, mut work) = (Worst::default(), Worst::default());
        for _ in 0..200 {
            // The rocker of a racing car allows less travel.
            let most = if name == "double_wishbone_pushrod" {
                35.0
            } else {
                70.0
            };
            let point = travel(most * random.signed(), 10.0 * random.signed());
            at(mechanism, &suspension.design, point, |solver, pose| {
                let configuration = solver
                    .configuration_series(&design_series, pose, &point.along_drive())
                    .unwrap();
                let place = |id| configuration.point(id).map(|c| c[0]);
                let load = Load {
                    point: place(mechanism.wheel_centre) - Vector3::new(0.0, 0.0, 310.0),
                    force: random.vector(3000.0),
                    moment: random.vector(3e5),
                };
                let found = solver
                    .balance(pose, point.rack, Support::Spring(spring))
                    .unwrap()
                    .under(&load);

                for error in resultants(mechanism, &place, &load, &found, solver.size()) {
                    balance.note(error);
                }

                let view = WheelReading::of(&configuration, Constants::of(&suspension));
                let power = power(mechanism, &view, &configuration, &load);
                let ratio = Quantity::Characteristic(Characteristic::MotionRatio);
                let ratio = view.value(&configuration, ratio).derivative(0);
                work.note((found.support * ratio - power) / load.force.norm());

                // A support at the wheel centre can replace the spring. Its work balances the work of the load, too.
                let held = solver
                    .balance(pose, point.rack, Support::WheelCentre)
                    .unwrap()
                    .under(&load);
                work.note((held.support + power) / load.force.norm());
            })
            .unwrap()
            .unwrap();
        }
        println!("{name}: balance {:.1e}, work {:.1e}", balance.0, work.0);
        assert!(balance.0 < 1e-12, "{name}: {:e}", balance.0);
        assert!(work.0 < 1e-12, "{name}: {:e}", work.0);
    }
}

/// If a support at the wheel centre replaces the spring, the outer joint of the arm with the spring carries only the forces of
/// the arm's legs.
#[test]
fn a_support_at_the_wheel_centre_does_not_load_the_arm_of_the_spring() {
    let suspension = template("double_wishbone");
    let mechanism = &suspension.mechanism;
    let Body::Arm(arm) = mechanism.body(mechanism.spring_seat().unwrap()) else {
        panic!("the spring is not on an arm");
    };
    let joint = mechanism.arms[arm.0].outer;
    let point = travel(20.0, 0.0);
    at(mechanism, &suspension.design, point, |solver, pose| {
        let configuration = Configuration::new(mechanism, &suspension.design, *pose, point.rack);
        let place = |id| configuration.point(id);
        let load = Load {
            point: place(mechanism.wheel_centre) - Vector3::new(0.0, 0.0, 310.0),
            force: Vector3::new(-1000.0, 500.0, 4000.0),
            moment: Vector3::default(),
        };
        let balance = solver
            .balance(pose, point.rack, Support::WheelCentre)
            .unwrap();
        let held = balance.under(&load);
        assert!(held.support.abs() > 1000.0);
        let legs = held.constraints.iter().map(|reaction| match *reaction {
            Reaction::Rod {
                inner,
                outer,
                tension,
            } if outer == joint => (place(inner) - place(outer)).normalised() * tension,
            _ => Vector3::default(),
        });
        let legs = legs.fold(Vector3::default(), |sum, pull| sum + pull);
        let found =
            Axis::ALL.map(|axis| balance.force(&held, Carried::Force(joint, axis)).unwrap());
        let off = (Vector3::from(found) - legs).norm();
        assert!(off < 1e-9 * load.force.norm(), "{found:?} {legs:?}");
    })
    .unwrap()
    .unwrap();
}

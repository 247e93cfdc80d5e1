//! Tests of roll centres and anti-dive against velocities of the independent formulation. Values that are based on
//! forces use the velocities of the knuckle points at the contact points. The kinematic roll centre uses the velocity
//! of the axle point midway between the contact points.

use super::hyper::{Hyper, Point, cross, dot, minus, plus};
use super::world::{At, Solved, Travels, World};
use super::{Place, at, axle, random, study};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::axle_curves;

/// Returns a vector that is fixed to a body with three given directions: its components along these directions stay
/// constant.
fn carried(basis: [Point; 3], vector: Point) -> Point {
    let [a, b, c] = basis.map(|v| v.map(|c| c.value));
    let v = vector.map(|c| c.value);
    let determinant = |p: [f64; 3], q: [f64; 3], r: [f64; 3]| {
        p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0])
            + p[2] * (q[0] * r[1] - q[1] * r[0])
    };
    let whole = determinant(a, b, c);
    let parts = [
        determinant(v, b, c),
        determinant(a, v, c),
        determinant(a, b, v),
    ];
    let along = |k: usize| basis[k].map(|x| x.scaled(parts[k] / whole));
    plus(along(0), plus(along(1), along(2)))
}

/// Returns the knuckle point that is at the contact point of a wheel. It moves with the knuckle.
fn contact(solved: &Solved, side: usize) -> Point {
    let wheel = solved.wheels[side];
    let [_, kingpin] = wheel.kingpin;
    let basis = [wheel.spin, kingpin, cross(wheel.spin, kingpin)];
    plus(
        wheel.centre,
        carried(basis, minus(wheel.contact, wheel.centre)),
    )
}

fn first(p: Point) -> Point {
    p.map(|c| Hyper::constant(c.first))
}

fn second(p: Point) -> Point {
    p.map(|c| Hyper::constant(c.second))
}

/// Returns quantities at a position by column name. They are computed from velocities with respect to the difference of
/// the travels (first) and to the mean of the travels (second).
fn expected(world: &World, place: Place) -> Option<[(&'static str, f64); 4]> {
    let on_plane = world.solve(&at(place, None, None))?;
    let half = on_plane.half_difference();
    let mean = Hyper {
        second: 1.0,
        ..Hyper::constant(place[0])
    };
    let difference = Hyper {
        first: 1.0,
        ..Hyper::constant(half)
    };
    let solved = world.solve(&At {
        travels: Travels::Given(mean + difference, mean - difference),
        ..at(place, None, None)
    })?;
    let (sine, cosine) = place[1].sin_cos();
    let constant = |p: [f64; 3]| p.map(Hyper::constant);
    let normal = constant([0.0, sine, cosine]);
    let to_left = constant([0.0, cosine, -sine]);
    let forward = constant([1.0, 0.0, 0.0]);
    let contacts = [0, 1].map(|side| contact(&solved, side));
    // Loads at the wheels that balance half a unit force at each contact point.
    let balancing = |along: Point| {
        let rise = |c: Point| dot(normal, c).value;
        let work = |by: fn(Point) -> Point| {
            let [left, right] = contacts.map(|c| dot(along, by(c)).value);
            0.5 * (left + right)
        };
        let [[a, b], [c, d]] = [first, second].map(|by| contacts.map(|c| rise(by(c))));
        let (p, q) = (-work(first), -work(second));
        let determinant = a * d - b * c;
        [(p * d - b * q) / determinant, (a * q - p * c) / determinant]
    };
    let [left, right] = balancing(to_left);
    let track = dot(to_left, minus(contacts[0], contacts[1])).value;
    let braking: f64 = balancing(forward).into_iter().sum();

    let middle = plus(contacts[0], contacts[1]).map(|c| Hyper::constant(0.5 * c.value));
    let [x, y] = solved.axle;
    let basis = [x, y, cross(x, y)];
    let [on_it, _] = solved.wheels[0].kingpin;
    let velocity = first(plus(on_it, carried(basis, minus(middle, on_it))));
    let turn = basis
        .map(|c| cross(c, first(c)))
        .into_iter()
        .fold(0.0, |sum, c| sum + 0.5 * c[0].value);
    Some([
        ("force_roll_centre_height_mm", 0.5 * track * (right - left)),
        ("anti_dive_percent", -100.0 * 0.6 * 2700.0 / 640.0 * braking),
        ("roll_centre_height_mm", dot(to_left, velocity).value / turn),
        (
            "roll_centre_lateral_mm",
            -dot(normal, velocity).value / turn,
        ),
    ])
}

#[test]
fn roll_centres_and_anti_dive_are_those_of_velocities() {
    let mut generator = Random(468);
    let (mut worst, mut apart, mut solved) = (0.0_f64, 0.0_f64, 0);
    for number in 0..60 {
        let world = random(&mut generator, number % 2 == 0, 30.0);
        let place = [
            40.0 * generator.signed(),
            0.05 * generator.signed(),
            60.0 * generator.signed(),
        ];
        let Some(expected) = expected(&world, place) else {
            continue;
        };
        let further = format!(
            "[motion]\nheave = [{:?}]\nroll = [{:?}]\nrack = [{:?}]\n[outputs]\ncharacteristics = \
             [\"force_roll_centre_height\", \"anti_dive\", \"roll_centre_height\", \"roll_centre_lateral\"]\n",
            place[0],
            place[1].to_degrees(),
            place[2]
        );
        let own = axle(&study(&world, &further));
        let curves = axle_curves(&own.axle, &own.plan).unwrap().curves;
        let mut values = [0.0; 4];
        for (k, (name, expected)) in expected.into_iter().enumerate() {
            let column = curves.columns.iter().position(|c| c.name == name).unwrap();
            values[k] = curves.stations[0].value(column).unwrap();
            let error = (values[k] - expected).abs() / expected.abs().max(100.0);
            assert!(error < 1e-9, "{number} {name}: {} {expected}", values[k]);
            worst = larger(worst, error);
        }
        apart = larger(apart, (values[0] - values[2]).abs());
        solved += 1;
    }
    println!("{worst:e}; both roll centres up to {apart} mm apart");
    // The knuckles steer in roll. This affects only the force-based roll centre, so the two roll centres differ.
    assert!(apart > 1.0);
    assert!(solved > 45, "{solved} of 60");
}

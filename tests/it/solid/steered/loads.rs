//! Tests of forces in links, drag link and tie rod. The whole axle is in balance (three forces, three moments), and each
//! knuckle is in balance about its kingpin. Positions come from the independent formulation.

use super::{Place, World, at, axle, random, study};
use crate::solid::own::{Point, cross, dot, minus};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::axle_curves;
use std::fmt::Write as _;

/// Force with its point of application.
type Force = (Point, Point);

fn pull(from: Point, to: Point, tension: f64) -> Force {
    let way = minus(to, from);
    let length = dot(way, way).sqrt();
    (from, way.map(|c| tension * c / length))
}

/// Forces on the axle together with its knuckles, and forces on each knuckle except the forces at its kingpin.
struct Forces {
    outside: Vec<Force>,
    on_knuckles: [Vec<Force>; 2],
}

/// Member forces on the axle and its knuckles in one position. `tension` returns the force in a column of the program's results.
fn forces(world: &World, place: Place, has_spring: bool, tension: &dyn Fn(&str) -> f64) -> Forces {
    let solved = world.solve(&at(place, None, None)).unwrap();
    let on_axle = |side: usize, name: &str| world.place_on_axle(&solved, side, name);
    let on_knuckle = |side: usize, name: &str| world.place_on_knuckle(&solved, side, name);
    let on_body = |side: usize, name: &str| {
        let [x, y, z] = world.at(name).map(|c| c.value);
        [x, if side == 0 { y } else { -y }, z]
    };
    let sides = ["left", "right"];
    let mut outside = Vec::new();
    let mut link = |name: &str, side: usize, column: &str| {
        let (own, body) = (format!("{name}_axle"), format!("{name}_chassis"));
        outside.push(pull(
            on_axle(side, &own),
            on_body(side, &body),
            tension(column),
        ));
    };
    link("lower_link", 0, "left_lower_link");
    link("lower_link", 1, "right_lower_link");
    if world.single {
        link("upper_link", 0, "upper_link");
        link("panhard", 0, "panhard");
    } else {
        link("upper_link", 0, "left_upper_link");
        link("upper_link", 1, "right_upper_link");
    }
    let mut on_knuckles = [Vec::new(), Vec::new()];
    for side in [0, 1] {
        if has_spring {
            let force = tension(&format!("{}_spring", sides[side]));
            let (lower, upper) = (on_axle(side, "spring_lower"), on_body(side, "spring_upper"));
            outside.push(pull(lower, upper, -force));
        } else {
            let up = tension(&format!("{}_support", sides[side]));
            on_knuckles[side].push((on_knuckle(side, "wheel_centre"), [0.0, 0.0, up]));
        }
    }
    let end = on_body(0, "drag_link_body");
    let moved = [0, 1, 2].map(|k| end[k] + place[2] * world.direction[k]);
    on_knuckles[0].push(pull(
        on_knuckle(0, "drag_link_knuckle"),
        moved,
        tension("drag_link"),
    ));
    outside.extend(on_knuckles.iter().flatten());
    let ties = [0, 1].map(|side| on_knuckle(side, "tie_rod_end"));
    for side in [0, 1] {
        on_knuckles[side].push(pull(ties[side], ties[1 - side], tension("tie_rod")));
    }
    Forces {
        outside,
        on_knuckles,
    }
}

/// Member forces balance loads on either wheel, with springs or with supports at the wheel centres.
#[test]
fn members_balance_loads_on_steered_wheels() {
    let mut generator = Random(465);
    let mut worst = 0.0_f64;
    for number in 0..24 {
        let mut world = random(&mut generator, number % 2 == 0, 30.0);
        let has_spring = number % 4 < 2;
        if has_spring {
            let hyper = |p: Point| p.map(super::Hyper::constant);
            world
                .points
                .push(("spring_upper", hyper([20.0, 460.0, 850.0])));
            world
                .points
                .push(("spring_lower", hyper([20.0, 470.0, 450.0])));
        }
        let place = [
            40.0 * generator.signed(),
            0.05 * generator.signed(),
            50.0 * generator.signed(),
        ];
        let force = generator.vector(3000.0).to_array();
        let moment = generator.vector(3e5).to_array();
        let mut further = format!(
            "[motion]\nheave = [{:?}]\nroll = [{:?}]\nrack = [{:?}]\n",
            place[0],
            place[1].to_degrees(),
            place[2]
        );
        let _ = write!(
            further,
            "[outputs]\ncharacteristics = [\"toe\"]\nloads = [{{ name = \"kerb\", at = \"wheel_centre\", force = {force:?}, \
             moment = {moment:?} }}]\n"
        );
        let own = axle(&study(&world, &further));
        let curves = axle_curves(&own.axle, &own.plan).unwrap().curves;
        for (side, word) in ["left", "right"].into_iter().enumerate() {
            let tension = |column: &str| {
                let name = format!("{word}_kerb_{column}_N");
                let known = curves.columns.iter().position(|c| c.name == name);
                let known = known.unwrap_or_else(|| panic!("{name} of {:?}", curves.columns));
                curves.stations[0].value(known).expect("a force")
            };
            let solved = world.solve(&at(place, None, None)).unwrap();
            let centre = world.place_on_knuckle(&solved, side, "wheel_centre");
            let mut all = forces(&world, place, has_spring, &tension);
            all.outside.push((centre, force));
            all.on_knuckles[side].push((centre, force));
            let (mut sum, mut about, mut size) = ([0.0; 3], moment, 0.0);
            for (point, force) in &all.outside {
                let turning = cross(*point, *force);
                for i in 0..3 {
                    sum[i] += force[i];
                    about[i] += turning[i];
                    size += force[i].abs();
                }
            }
            // Errors are relative: for forces to the total force, for moments to the total force times one metre.
            for i in 0..3 {
                worst = larger(worst, sum[i].abs() / size);
                worst = larger(worst, about[i].abs() / (1e3 * size));
            }
            for (knuckle, on_it) in all.on_knuckles.iter().enumerate() {
                let [lower, upper] = ["kingpin_lower", "kingpin_upper"]
                    .map(|name| world.place_on_axle(&solved, knuckle, name));
                let axis = minus(upper, lower);
                let mut turning = if knuckle == side {
                    dot(axis, moment)
                } else {
                    0.0
                };
                for (point, force) in on_it {
                    turning += dot(axis, cross(minus(*point, lower), *force));
                }
                worst = larger(worst, turning.abs() / (dot(axis, axis).sqrt() * 1e3 * size));
            }
        }
    }
    println!("{worst:e}");
    // Positions of both programs agree to 1e-9 mm.
    assert!(worst < 1e-11, "{worst:e}");
}

/// In roll with the wheel load held, the sum of both wheel loads equals the sum at zero roll and zero rack
/// displacement. This holds at every station, including the first. A station does not depend on the stations before it.
#[test]
fn the_level_axle_gives_the_load_of_every_station() {
    let mut generator = Random(466);
    for number in 0..12 {
        let mut world = random(&mut generator, number % 2 == 0, 30.0);
        let hyper = |p: Point| p.map(super::Hyper::constant);
        world
            .points
            .push(("spring_upper", hyper([20.0, 460.0, 850.0])));
        world
            .points
            .push(("spring_lower", hyper([20.0, 470.0, 450.0])));
        // Sum of both wheel loads at each rack displacement of the motion.
        let sums = |motion: &str| -> Vec<f64> {
            let further = format!(
                "[motion]\n{motion}\n[spring]\nrate = 32.0\nforce = 4200.0\n\
                 [outputs]\ncharacteristics = [\"wheel_load\"]\n"
            );
            let own = axle(&study(&world, &further));
            let curves = axle_curves(&own.axle, &own.plan).unwrap().curves;
            let loads = ["left", "right"].map(|side| {
                let name = format!("{side}_wheel_load_N");
                curves.columns.iter().position(|c| c.name == name).unwrap()
            });
            let stations = curves.stations.iter();
            let sums = stations.map(|at| loads.map(|load| at.value(load).unwrap()).iter().sum());
            sums.collect()
        };
        let (heave, roll) = (20.0 * generator.signed(), 3.0 * generator.signed());
        let level = sums(&format!("heave = [{heave:?}]\nroll = [0.0]"))[0];
        for (racks, count) in [
            ("[40.0]", 1),
            ("[-40.0, 40.0]", 2),
            ("[0.0, 40.0]", 2),
            ("[40.0, 0.0]", 2),
        ] {
            let rolled = format!(
                "heave = [{heave:?}]\nroll = [{roll:?}]\nrack = {racks}\nhold = \"wheel_load\""
            );
            let sums = sums(&rolled);
            assert_eq!(sums.len(), count, "{racks}");
            for sum in sums {
                assert!((sum - level).abs() < 1e-9 * level, "{racks}: {sum} {level}");
            }
        }
    }
}

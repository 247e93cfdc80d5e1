//! Tests of elastic axles against a second formulation (`world.rs`) and against mechanics.

mod algebra;
mod builds;
mod command;
mod curves;
mod frames;
mod mechanics;
mod names;
mod robust;
mod second;
mod set_up;
mod sheets;
mod studies;
mod support;
mod tunings;
mod world;

use super::support::elastic_axle;
use crate::support::random::Random;
use hardpoint::compliance::{
    AxialStiffness, AxleCompliance, ElasticAxle, HeldQuantity, Relaxed, Shape, SteeringColumn,
    Subframe, SubframeMount, WheelLoads,
};
use hardpoint::model::{Body, PointId, Suspension};
use hardpoint::number::Vector3;
use second::{build, difference, loads};
use world::{Constraint, On};

const HELD: HeldQuantity = HeldQuantity::WheelHeight;

/// Axle with its elastic parts, for the program and for the second formulation.
struct Case {
    suspension: Suspension,
    parts: AxleCompliance,
}

impl Case {
    fn axle(&self) -> ElasticAxle {
        let design = &self.suspension.design[..];
        ElasticAxle::of([&self.suspension; 2], [design; 2], &self.parts)
            .unwrap_or_else(|e| panic!("{e:?}"))
    }
}

fn cubic(rate: f64, cubic: f64) -> Shape {
    Shape::Cubic { rate, cubic }
}

fn mount(name: &str, at: [f64; 3], rates: [f64; 6], bent: f64) -> SubframeMount {
    SubframeMount {
        name: name.to_owned(),
        at: Vector3::from(at),
        shapes: std::array::from_fn(|k| cubic(rates[k], if k < 3 { bent } else { 0.0 })),
        preload: [0.0; 6],
        x_axis: None,
        z_axis: None,
    }
}

/// Sample axle with an elastic rack, an anti-roll bar, and a subframe. `carries` names the points on the subframe.
fn sample(topology: &str, carries: &[&str], relaxed: Relaxed, random: &mut Random) -> Case {
    let (suspension, mut wheel) = elastic_axle(topology);
    let mut suspension = suspension;
    suspension.design = random.scattered(&suspension.design, 8.0);
    wheel.relaxed = relaxed;
    let mut factor = || random.signed().exp2();
    for part in &mut wheel.bushings {
        for (k, shape) in part.shapes.iter_mut().enumerate() {
            let Shape::Cubic { rate, cubic } = shape else {
                continue;
            };
            *rate *= factor();
            *cubic = if k < 3 && relaxed == Relaxed::Free {
                0.05 * *rate
            } else {
                0.0
            };
        }
    }
    for link in &mut wheel.links {
        if let AxialStiffness::PerStrain(force) = link.stiffness {
            link.stiffness = AxialStiffness::Rate(force / 300.0 * factor());
        }
    }
    let mechanism = &suspension.mechanism;
    let carries: Vec<PointId> = carries
        .iter()
        .map(|name| mechanism.point(name).unwrap())
        .collect();
    let bent = if relaxed == Relaxed::Free { 40.0 } else { 0.0 };
    let rates = [3000.0, 4000.0, 2500.0, 2e5, 3e5, 2e5];
    let mounts = vec![
        mount(
            "subframe_front",
            [220.0, 350.0, 160.0],
            rates.map(|r| r * factor()),
            bent,
        ),
        mount(
            "subframe_rear",
            [-280.0, 340.0, 170.0],
            rates.map(|r| r * factor()),
            bent,
        ),
    ];
    let subframe = (!carries.is_empty()).then_some(Subframe { carries, mounts });
    let steers = (0..mechanism.points.len()).any(|k| mechanism.body(PointId(k)) == Body::Rack);
    Case {
        parts: AxleCompliance {
            wheels: [wheel.clone(), wheel],
            subframe,
            rack_rate: steers.then(|| 15_000.0 * factor()),
            bar_rate: Some(4.0e5 * factor()),
            column: steers.then(|| SteeringColumn {
                rate: 3.0e6 * factor(),
                rack_per_angle: 8.0,
            }),
        },
        suspension,
    }
}

fn mirrored(v: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(v.x, -v.y, v.z)
}

fn random_loads(random: &mut Random, size: f64) -> [WheelLoads; 2] {
    [0, 1].map(|_| {
        let mut load = WheelLoads::none(0.0);
        load.contact = random.vector(size);
        load.contact.z = 0.0;
        load.centre = random.vector(0.5 * size);
        (load.side, load.trail) = (size * random.signed(), 30.0);
        load.moment = random.vector(30.0 * size);
        load
    })
}

/// Compares states under random loads on random designs with the second formulation. At least three of four designs must have
/// a state.
fn compare(topology: &str, carries: &[&str], seed: u64, designs: usize) {
    let mut random = Random(seed);
    let mut compared = 0;
    for _ in 0..designs {
        let case = sample(topology, carries, Relaxed::Free, &mut random);
        let axle = case.axle();
        let travels = [0, 1].map(|_| 20.0 * random.signed());
        let command = if case.parts.rack_rate.is_some() {
            15.0 * random.signed()
        } else {
            0.0
        };
        let given = random_loads(&mut random, 1500.0);
        let Ok(station) = axle.at(travels, command) else {
            continue;
        };
        let Ok(at) = axle.loaded_about(&station, &station, &given, HELD) else {
            continue;
        };
        assert!(axle.out_of_balance(&at) < 1e-6);
        let mut built = build(&case, command);
        let centre = case.suspension.mechanism.wheel_centre;
        for (side, travel) in travels.iter().enumerate() {
            let point = case.suspension.design[centre.0];
            let point = if side == 0 { point } else { mirrored(point) };
            let on = On(built.carriers[side], point);
            built
                .world
                .constraints
                .push(Constraint::Height(on, *travel));
        }
        let numbers = built.numbers();
        built
            .world
            .solve(|world| loads(&case, &numbers, world, &given));
        let off = difference(&case, &built, &axle, &at);
        assert!(off < 1e-11, "{topology}: {off:e}");
        compared += 1;
    }
    assert!(compared * 4 >= designs * 3, "{compared} of {designs}");
}

const WISHBONES: &str = "double_wishbone";
const LOWER: [&str; 5] = [
    "lower_arm_front",
    "lower_arm_rear",
    "tie_rod_inner",
    "anti_roll_bar_inner",
    "anti_roll_bar_outer",
];
const LINKS: [&str; 7] = [
    "upper_front_link_inner",
    "upper_rear_link_inner",
    "lower_front_link_inner",
    "lower_rear_link_inner",
    "toe_link_inner",
    "anti_roll_bar_inner",
    "anti_roll_bar_outer",
];

#[test]
fn axles_agree_with_bodies_of_six_coordinates() {
    compare(WISHBONES, &[], 3, 1);
    compare(WISHBONES, &LOWER, 5, 2);
    compare("five_link", &LINKS, 7, 1);
}

#[test]
#[ignore = "600 designs: minutes"]
fn six_hundred_axles_agree_with_bodies_of_six_coordinates() {
    compare(WISHBONES, &[], 13, 200);
    compare(WISHBONES, &LOWER, 15, 200);
    compare("five_link", &LINKS, 17, 200);
}

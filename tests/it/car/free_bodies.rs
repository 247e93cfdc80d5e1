//! Tests of the balance of free bodies in states of random cars. The bodies are carriers, arms, rockers, bars and the
//! body of the car, each separately. The forces come from published positions and member forces.

use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::Preloaded;
use hardpoint::car::{
    Balance, Car, CarMember, CarSolver, Case, Equilibrium, GRAVITY, Longitudinal, WheelPlace,
};
use hardpoint::mechanism::Configuration;
use hardpoint::model::{Axis, Mechanism, RockerId, Rod, Side};
use hardpoint::number::Vector3;
use hardpoint::study::CarStudy;
use std::collections::HashMap;
use std::path::Path;

type V = Vector3<f64>;

/// Sample car with random changes. Both axles have double wishbones with pushrods, springs, heave springs, T-bars,
/// heave bars and anti-roll bars.
fn random_car(random: &mut Random) -> Car {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/own/free_bodies.toml");
    let mut car = CarStudy::read(&path, &[]).unwrap().car;
    for axle in &mut car.axles {
        for point in &mut axle.left.design {
            *point = *point + V::new(random.signed(), random.signed(), random.signed()) * 3.0;
        }
        axle.setup.rocker_springs.heave_bar = Some(Preloaded {
            load: 1.0e4 * random.signed(),
            rate: 1.0e5,
        });
        // About half of the axles are not symmetric.
        if random.signed() > 0.0 {
            let mut right = axle.left.clone();
            right.frame = axle.left.frame.of_other_side();
            for point in &mut right.design {
                *point = *point + V::new(random.signed(), random.signed(), random.signed());
            }
            axle.right = Some(right);
        }
    }
    car.mass *= 1.0 + 0.1 * random.signed();
    car.cg = car.cg
        + V::new(
            60.0 * random.signed(),
            20.0 * random.signed(),
            30.0 * random.signed(),
        );
    car
}

fn random_case(random: &mut Random) -> Case {
    let mut case = Case::at_rest("random");
    (case.ax, case.ay) = (0.5 * random.signed(), 0.7 * random.signed());
    case.az = 0.2 * random.signed();
    case.speed = 12.0 + 10.0 * random.signed();
    case.racks[0] = 10.0 * random.signed();
    case.setting.elastic_tyres = random.signed() > 0.0;
    if case.ax < 0.0 {
        case.setting.longitudinal = Longitudinal::Brake;
    }
    case
}

/// Force with its point of application: position and vector.
#[derive(Clone, Copy)]
struct Force(V, V);

/// Sum of the forces, and of their moments about the origin.
fn sum(forces: &[Force]) -> [V; 2] {
    forces
        .iter()
        .fold([V::default(); 2], |[f, m], Force(at, by)| {
            [f + *by, m + at.cross(*by)]
        })
}

/// Moment of forces about an axis.
fn about(first: V, second: V, forces: &[Force]) -> f64 {
    let axis = (second - first).normalised();
    let moment = |Force(at, by): &Force| axis.dot((*at - first).cross(*by));
    forces.iter().map(moment).sum()
}

/// Returns 1 if compression of a rocker's rod turns the rocker in the positive sense about its axis in the design
/// position. Otherwise returns -1.
fn sense(mechanism: &Mechanism, design: &[V], id: RockerId) -> f64 {
    let rocker = mechanism.rocker(id);
    let [first, second, inner, outer] =
        [rocker.first, rocker.second, rocker.inner, rocker.outer].map(|id| design[id.0]);
    let press = Force(inner, inner - outer);
    let sign = about(first, second, &[press]).signum();
    match rocker.rod {
        Rod::Pullrod => -sign,
        Rod::Pushrod
        | Rod::DropLink
        | Rod::WattLink
        | Rod::DragLink
        | Rod::TieRod
        | Rod::TwistBeam => sign,
    }
}

/// Wheel in the frame of its side.
struct Wheel<'a> {
    mechanism: &'a Mechanism,
    at: Configuration<'a, f64>,
    /// Published member forces, by name.
    members: HashMap<String, f64>,
    /// Forces of tyre and inertia on the carrier.
    outside: Vec<Force>,
    /// Torque that a drive shaft takes instead of the carrier.
    shaft: V,
    sign: f64,
    state: &'a Balance<f64>,
    axle: usize,
}

impl Wheel<'_> {
    fn point(&self, name: &str) -> V {
        self.at.point(self.mechanism.point(name).unwrap())
    }

    /// Force of a rod on the part at its end `at`, directed towards `to`.
    fn pull(&self, at: &str, to: &str, tension: f64) -> Force {
        let (at, to) = (self.point(at), self.point(to));
        Force(at, (to - at).normalised() * tension)
    }

    fn member(&self, name: &str) -> f64 {
        self.members[name]
    }

    /// Published force on the carrier at a joint, in the study's axes with the true sign of y.
    fn joint(&self, name: &str) -> Force {
        let [x, y, z] = ["x", "y", "z"].map(|axis| self.member(&format!("{name}_{axis}")));
        Force(self.point(name), V::new(x, self.sign * y, z))
    }

    fn back(&self, Force(at, by): Force) -> Force {
        Force(at, -by)
    }

    /// Residuals of forces and of moments for carrier, arms, rocker and bar. Also returns the forces on the body.
    fn residuals(&self, other_end: V) -> (Vec<f64>, Vec<f64>, Vec<Force>) {
        let (lower, upper) = (
            self.joint("lower_ball_joint"),
            self.joint("upper_ball_joint"),
        );
        let tie_rod = self.pull("tie_rod_outer", "tie_rod_inner", self.member("tie_rod"));
        let mut carrier = self.outside.clone();
        carrier.extend([lower, upper, tie_rod]);
        let [force, moment] = sum(&carrier);
        let moment = moment + self.shaft;
        let forces = force.to_array().to_vec();
        let mut moments = moment.to_array().to_vec();
        let pushrod = self.member("pushrod");
        let drop_link = self.member("drop_link");
        let on_lower = [
            self.back(lower),
            self.pull("pushrod_outer", "pushrod_inner", pushrod),
        ];
        let on_upper = [self.back(upper)];
        let axis = |arm: &str| ["front", "rear"].map(|end| self.point(&format!("{arm}_{end}")));
        let [front, rear] = axis("lower_arm");
        moments.push(about(front, rear, &on_lower));
        let [front, rear] = axis("upper_arm");
        moments.push(about(front, rear, &on_upper));
        let (low, high) = (self.point("spring_lower"), self.point("spring_upper"));
        let along = (low - high).normalised();
        let end = self.point("heave_spring");
        let heave = self.state.rockers[self.axle].heave_spring;
        let on_rocker = [
            self.pull("pushrod_inner", "pushrod_outer", pushrod),
            self.pull("drop_link_outer", "drop_link_inner", drop_link),
            Force(low, along * self.member("spring")),
            Force(end, (end - other_end).normalised() * heave),
        ];
        let id = self.mechanism.spring_rocker().unwrap();
        let turn = sense(self.mechanism, self.at.design, id);
        let [first, second] =
            ["rocker_pivot_front", "rocker_pivot_rear"].map(|name| self.point(name));
        let rockers = &self.state.rockers[self.axle];
        let torque = -(self.sign * rockers.t_bar + rockers.heave_bar) * turn;
        moments.push(about(first, second, &on_rocker) + torque);
        let bar = self.mechanism.anti_roll_bar().unwrap();
        let on_bar = [self.pull("drop_link_inner", "drop_link_outer", drop_link)];
        let turn = sense(self.mechanism, self.at.design, bar);
        let rocker = self.mechanism.rocker(bar);
        let [first, second] = [rocker.first, rocker.second].map(|id| self.at.point(id));
        let torque = -self.sign * self.state.bars[self.axle] * turn;
        moments.push(about(first, second, &on_bar) + torque);
        // Forces that arms, rocker, bar, rods and spring transmit to the body. The heave spring acts between two
        // rockers, not on the body.
        let mut body = Vec::new();
        body.extend(on_lower);
        body.extend(on_upper);
        body.extend(on_rocker);
        body.extend(on_bar);
        body.push(self.back(Force(self.point("tie_rod_inner"), tie_rod.1)));
        body.push(Force(high, along * -self.member("spring")));
        (forces, moments, body)
    }
}

/// Mirrors a vector at the middle plane, for the right side.
fn mirrored(v: V, sign: f64) -> V {
    V::new(v.x, sign * v.y, v.z)
}

/// Largest residuals of forces and of moments. Residuals of forces are divided by the weight, and residuals of moments
/// by the weight times a metre.
fn worst(car: &Car, solver: &mut CarSolver<'_>, case: &Case, found: &Equilibrium) -> [f64; 2] {
    let state = solver.balance(case, found).unwrap();
    let all = solver.members(case, found).unwrap();
    let labels = CarMember::all(car);
    let unsprung = |number: usize| 0.5 * car.axles[number / 2].setup.unsprung_mass.unwrap();
    let total: f64 = (0..4).map(unsprung).sum();
    let poses = solver.poses(found).unwrap();
    let weight = car.mass * GRAVITY;
    let road = &state.road;
    let inertia =
        (road.forward * case.ax + road.left * case.ay + road.up * (1.0 + case.az)) * -GRAVITY;
    let mut worst = [0.0_f64; 2];
    let mut on_body: Vec<Force> = Vec::new();
    let mut torque = V::default();
    let wheels: Vec<Wheel<'_>> = WheelPlace::ALL
        .into_iter()
        .map(|place| {
            let (number, axle) = (place.0, place.0 / 2);
            let side = Side::ALL[number % 2];
            let sign = side.sign();
            let origin = if axle == 0 {
                V::default()
            } else {
                car.rear_offset
            };
            let suspension = car.axles[axle].suspension(side);
            let pose = poses[axle].poses()[side as usize];
            let rack = sign * case.racks[axle];
            let wheel = &state.wheels[number];
            let tyre = road.up * wheel.load + wheel.across * wheel.side_force;
            let push = wheel.heading * wheel.longitudinal_force;
            let centre = wheel.corner.centre;
            let own = |at: V, by: V| Force(mirrored(at - origin, sign), mirrored(by, sign));
            // Both axles of the file have brakes at the wheels, and drive through shafts.
            let shaft = match case.setting.longitudinal {
                Longitudinal::Brake => V::default(),
                Longitudinal::Drive => {
                    let spin = wheel.corner.spin;
                    let torque = spin.dot((wheel.contact - centre).cross(push));
                    mirrored(spin, sign) * (-torque * sign)
                }
            };
            let own_labels = labels.iter().filter(|member| member.place == place);
            let names = own_labels.map(|member| member.name.clone());
            Wheel {
                mechanism: &suspension.mechanism,
                at: Configuration::new(&suspension.mechanism, &suspension.design, pose, rack),
                members: names.zip(all[number].forces.iter().copied()).collect(),
                outside: vec![
                    own(wheel.contact, tyre + push),
                    own(centre, inertia * unsprung(number)),
                ],
                shaft,
                sign,
                state: &state,
                axle,
            }
        })
        .collect();
    for (number, wheel) in wheels.iter().enumerate() {
        let other = &wheels[number ^ 1];
        let other_end = mirrored(other.point("heave_spring"), -1.0);
        let (forces, moments, body) = wheel.residuals(other_end);
        let lacking = all[number].lacking;
        for force in forces.into_iter().chain([lacking]) {
            worst[0] = larger(worst[0], force.abs() / weight);
        }
        for moment in moments {
            worst[1] = larger(worst[1], moment.abs() / (1000.0 * weight));
        }
        let origin = if wheel.axle == 0 {
            V::default()
        } else {
            car.rear_offset
        };
        let on_car = |Force(at, by): Force| {
            Force(mirrored(at, wheel.sign) + origin, mirrored(by, wheel.sign))
        };
        on_body.extend(body.into_iter().map(on_car));
        // The body carries the opposite torque of the shafts. A torque is an axial vector, so its mirror image has the
        // opposite sign.
        torque = torque - mirrored(wheel.shaft, wheel.sign) * wheel.sign;
    }
    // The study gives the mass of the whole car. In the design position, the centre of gravity in the study is that of
    // sprung and unsprung masses together.
    let sprung = car.mass - total;
    let mut moment = car.cg * car.mass;
    for number in 0..4 {
        moment = moment - state.wheels[number].corner.design_centre * unsprung(number);
    }
    on_body.push(Force(moment * (1.0 / sprung), inertia * sprung));
    let air = car.air.as_ref().unwrap();
    for end in [0, 1] {
        on_body.push(Force(
            air.downforce[end].unwrap().point,
            -(road.up * state.air[end]),
        ));
    }
    on_body.push(Force(
        air.drag.unwrap().point,
        -(road.forward * state.air[2]),
    ));
    let [force, moment] = sum(&on_body);
    worst[0] = larger(worst[0], force.norm() / weight);
    worst[1] = larger(worst[1], (moment + torque).norm() / (1000.0 * weight));
    worst
}

/// Checks the balance of random cars: `cars` cars, with `states` states each.
fn balance(seed: u64, cars: usize, states: usize) {
    let mut random = Random(seed);
    let (mut solved, mut most) = (0, [0.0_f64; 2]);
    for _ in 0..cars {
        let car = random_car(&mut random);
        let mut solver = CarSolver::new(&car).unwrap();
        for _ in 0..states {
            let case = random_case(&mut random);
            let Ok(found) = solver.solve(&case) else {
                continue;
            };
            solved += 1;
            let here = worst(&car, &mut solver, &case, &found);
            most = [larger(most[0], here[0]), larger(most[1], here[1])];
        }
    }
    println!(
        "{solved} of {} states; worst force, moment: {most:?}",
        cars * states
    );
    assert!(10 * solved >= 9 * cars * states, "{solved}");
    assert!(most[0] < 1e-11 && most[1] < 1e-11, "{most:?}");
}

#[test]
fn free_bodies_balance() {
    balance(17, 6, 10);
}

#[test]
#[ignore = "10,000 states: with .ci/long"]
fn free_bodies_of_many_cars_balance() {
    balance(18, 100, 100);
}

/// The studies of the sample car have ISO axes. The other tests of this file assume this.
#[test]
fn the_car_is_in_iso_axes() {
    let mut random = Random(1);
    let car = random_car(&mut random);
    for axle in &car.axles {
        for axis in Axis::ALL {
            assert_eq!(axle.left.frame.sign(axis), 1.0);
        }
    }
}

//! Tests of steered solid axles in cars: free bodies, derivatives, and the roll centre of the axle.

use super::random_case;
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::{AxlePose, AxleSolver, Placement};
use hardpoint::car::{
    AxleEnd, AxleParameter, AxleResult, Balance, Car, CarQuantity, CarSolver, Case, GRAVITY,
    Longitudinal, Parameter, WheelPlace, WheelResult, WholeResult,
};
use hardpoint::model::{Axis, PointId, Side};
use hardpoint::number::Vector3;
use hardpoint::study::CarStudy;
use nalgebra::{DMatrix, DVector};

type V = Vector3<f64>;

fn car() -> Car {
    let path = crate::support::studies().join("off_road_car.toml");
    CarStudy::read(&path, &[]).unwrap().car
}

/// Car with random changes of the hardpoints of its front axle.
fn random_car(random: &mut Random) -> Car {
    let mut car = car();
    let left = &car.axles[0].left;
    let rigid = left.mechanism.rigid_axle.clone().unwrap();
    for point in 0..left.design.len() {
        let id = PointId(point);
        let is_given = rigid.singles.contains(&id) || rigid.far_of(id).is_some();
        for axis in Axis::ALL.into_iter().filter(|_| is_given) {
            let moves = super::one_point(0, id, axis);
            moves.apply(4.0 * random.signed(), &mut car);
        }
    }
    car.cg.y += 20.0 * random.signed();
    car.cg.z += 30.0 * random.signed();
    car
}

/// Positions of points of the front axle in the car's axes.
fn places(car: &Car, placed: &AxlePose, names: &[&str]) -> Vec<V> {
    let axle = &car.axles[0];
    let ids: Vec<PointId> = names
        .iter()
        .map(|name| axle.left.mechanism.point(name).unwrap())
        .collect();
    let mut solver = AxleSolver::<2>::new(axle, &[], false).unwrap();
    solver.read_points(&ids);
    let read = solver.read(placed).unwrap();
    let points = &read.points[Side::Left as usize];
    let now = points
        .iter()
        .map(|point| point.map(|c| c.coefficient([0, 0])));
    now.collect()
}

/// Forces of the tyre and of the inertia of one wheel, each with its point of application.
fn outside(state: &Balance<f64>, case: &Case, number: usize, unsprung: f64) -> [(V, V); 2] {
    let wheel = &state.wheels[number];
    let road = &state.road;
    let tyre = road.up * wheel.load
        + wheel.across * wheel.side_force
        + wheel.heading * wheel.longitudinal_force;
    let acceleration = road.forward * case.ax + road.left * case.ay + road.up * (1.0 + case.az);
    let inertia = acceleration * (-GRAVITY * unsprung);
    [(wheel.contact, tyre), (wheel.corner.centre, inertia)]
}

fn wrench((at, force): (V, V)) -> [f64; 6] {
    let moment = at.cross(force) * 1e-3;
    [force.x, force.y, force.z, moment.x, moment.y, moment.z]
}

const NAMES: [&str; 20] = [
    "lower_link_chassis",
    "lower_link_axle",
    "right_lower_link_chassis",
    "right_lower_link_axle",
    "upper_link_chassis",
    "upper_link_axle",
    "panhard_chassis",
    "panhard_axle",
    "drag_link_body",
    "drag_link_knuckle",
    "tie_rod_end",
    "right_tie_rod_end",
    "kingpin_lower",
    "kingpin_upper",
    "right_kingpin_lower",
    "right_kingpin_upper",
    "spring_lower",
    "spring_upper",
    "right_spring_lower",
    "right_spring_upper",
];

/// Front axle with its knuckles and wheels as free bodies. There are six equations for the whole axle, and one about
/// the kingpin of each knuckle.
struct FreeBodies {
    points: Vec<V>,
}

impl FreeBodies {
    fn at(&self, name: &str) -> V {
        self.points[NAMES.iter().position(|own| *own == name).unwrap()]
    }

    /// Moment of a force about the kingpin of a side.
    fn about(&self, side: &str, (place, force): (V, V)) -> f64 {
        let lower = self.at(&format!("{side}kingpin_lower"));
        let axis = (self.at(&format!("{side}kingpin_upper")) - lower).normalised();
        axis.dot((place - lower).cross(force)) * 1e-3
    }

    /// Force at the rod's first end for a tension of 1.
    fn pull(&self, from: &str, to: &str) -> (V, V) {
        let from = self.at(from);
        (from, (self.at(to) - from).normalised())
    }

    /// Forces of tyres, inertia and springs.
    fn loads(&self, state: &Balance<f64>, case: &Case) -> DVector<f64> {
        let mut sum = DVector::zeros(8);
        for (number, side) in [(0, ""), (1, "right_")] {
            for force in outside(state, case, number, 85.0) {
                for (row, part) in wrench(force).into_iter().enumerate() {
                    sum[row] += part;
                }
                sum[6 + number] += self.about(side, force);
            }
            let ends = ["lower", "upper"].map(|end| format!("{side}spring_{end}"));
            let (low, along) = self.pull(&ends[0], &ends[1]);
            let spring = (low, along * -state.wheels[number].spring_force);
            for (row, part) in wrench(spring).into_iter().enumerate() {
                sum[row] += part;
            }
        }
        sum
    }

    /// Coefficients of the tensions of links, Panhard rod, drag link and tie rod in the eight equations.
    fn rods(&self) -> DMatrix<f64> {
        let rods = [
            ("lower_link_axle", "lower_link_chassis"),
            ("right_lower_link_axle", "right_lower_link_chassis"),
            ("upper_link_axle", "upper_link_chassis"),
            ("panhard_axle", "panhard_chassis"),
            ("drag_link_knuckle", "drag_link_body"),
        ];
        let mut columns: Vec<DVector<f64>> = Vec::new();
        for (own, body) in rods {
            let force = self.pull(own, body);
            let mut column = DVector::zeros(8);
            column.rows_mut(0, 6).copy_from_slice(&wrench(force));
            if own == "drag_link_knuckle" {
                column[6] = self.about("", force);
            }
            columns.push(column);
        }
        let mut tie_rod = DVector::zeros(8);
        tie_rod[6] = self.about("", self.pull("tie_rod_end", "right_tie_rod_end"));
        tie_rod[7] = self.about("right_", self.pull("right_tie_rod_end", "tie_rod_end"));
        columns.push(tie_rod);
        DMatrix::from_columns(&columns)
    }
}

/// Axle, knuckles and wheels together have six equations, and each knuckle has one equation about its kingpin. The six
/// tensions of links, Panhard rod, drag link and tie rod satisfy all eight equations.
#[test]
fn rods_hold_axle_and_knuckles() {
    let mut random = Random(29);
    let (mut solved, mut worst) = (0, [0.0_f64; 2]);
    for _ in 0..5 {
        let car = random_car(&mut random);
        let mut solver = CarSolver::new(&car).unwrap();
        for _ in 0..8 {
            let case = random_case(&mut random, [0.3, 0.4, 40.0]);
            let Ok(found) = solver.solve(&case) else {
                continue;
            };
            solved += 1;
            let state = solver.balance(&case, &found).unwrap();
            let bodies = FreeBodies {
                points: places(&car, &solver.poses(&found).unwrap()[0], &NAMES),
            };
            let (sum, rods) = (bodies.loads(&state, &case), bodies.rods());
            let tensions = rods.clone().svd(true, true).solve(&-&sum, 1e-12).unwrap();
            let left_over = &rods * tensions + &sum;
            worst[0] = larger(worst[0], left_over.norm() / (1750.0 * GRAVITY));
            for wheel in &state.wheels[..2] {
                let parts: f64 = wheel.parts.iter().sum();
                worst[1] = larger(worst[1], (parts - wheel.load).abs() / 4000.0);
            }
        }
    }
    println!("{solved} states, worst {worst:?}");
    assert!(solved >= 36, "{solved}");
    assert!(worst[0] < 1e-11 && worst[1] < 1e-12, "{worst:?}");
}

fn results() -> Vec<CarQuantity> {
    let front = |result| CarQuantity::Axle(AxleEnd::Front, result);
    let wheel = |number, result| CarQuantity::Wheel(WheelPlace(number), result);
    let mut results = vec![
        CarQuantity::Whole(WholeResult::Roll),
        CarQuantity::Whole(WholeResult::Energy),
        CarQuantity::Whole(WholeResult::RollGradient),
        front(AxleResult::RollCentreHeight),
        front(AxleResult::RollCentreLateral),
        front(AxleResult::ForceRollCentre),
        front(AxleResult::Geometric),
        front(AxleResult::RollSteerGradient),
        wheel(0, WheelResult::Load),
        wheel(1, WheelResult::Longitudinal),
    ];
    results.extend(CarQuantity::named("front_left_steer"));
    results
}

/// Derivatives with respect to the steered axle's hardpoints and steering gear equal finite differences between
/// complete designs.
#[test]
fn derivatives_are_those_of_moved_cars() {
    let car = car();
    let mut case = Case::at_rest("braked_turn");
    (case.ax, case.ay, case.racks[0]) = (-0.2, 0.3, 20.0);
    case.setting.elastic_tyres = false;
    case.setting.longitudinal = Longitudinal::Brake;
    let asked = results();
    assert_eq!(asked.len(), 11);
    let values = |car: &Car, case: &Case| -> Vec<f64> {
        let mut solver = CarSolver::new(car).unwrap();
        let found = solver.solve(case).unwrap();
        let solved = solver.solved(case, &found).unwrap();
        asked.iter().map(|q| q.evaluate(&solved)).collect()
    };
    let mut solver = CarSolver::new(&car).unwrap();
    let found = solver.solve(&case).unwrap();
    let gradients = solver.gradients(&case, &found, &asked).unwrap();
    let now = values(&car, &case);
    let step = 5e-3;
    let check = |name: &str, at: &dyn Fn(f64) -> Vec<f64>, exact: &dyn Fn(usize) -> f64| {
        let (below, above) = (at(-step), at(step));
        for (k, quantity) in asked.iter().enumerate() {
            let expected = (above[k] - below[k]) / (2.0 * step);
            let scale = expected.abs() + 1e-5 * now[k].abs() + 1e-9;
            let error = (exact(k) - expected).abs();
            let name = format!("{} by {name}", quantity.name());
            assert!(error < 2e-4 * scale, "{name}: {} {expected}", exact(k));
        }
    };
    for name in [
        "lower_link_axle",
        "panhard_chassis",
        "kingpin_upper",
        "drag_link_body",
        "drag_link_knuckle",
        "tie_rod_end",
        "wheel_centre",
    ] {
        let point = car.axles[0].left.mechanism.point(name).unwrap();
        for axis in Axis::ALL {
            let at = |by: f64| {
                let mut moved = car.clone();
                super::one_point(0, point, axis).apply(by, &mut moved);
                values(&moved, &case)
            };
            check(name, &at, &|k| gradients[k].hardpoints[0][point.0][axis]);
        }
    }
    let at = |by: f64| {
        let mut moved = case.clone();
        moved.racks[0] += by;
        values(&car, &moved)
    };
    let gear = Parameter::Axle(0, AxleParameter::Rack).place();
    check("steering gear", &at, &|k| gradients[k].parameters[gear]);
}

/// The roll centre follows from the motion of the axle beam itself, at any steer of its wheels. It is the point without
/// lateral velocity in the middle plane of both contact points. The velocity comes from finite differences of poses.
#[test]
fn the_roll_centre_is_that_of_the_axle() {
    let car = car();
    let mut solver = CarSolver::new(&car).unwrap();
    for (ay, gear) in [(0.0, 0.0), (0.3, 30.0), (-0.2, 40.0)] {
        let mut case = Case::at_rest("turn");
        (case.ay, case.racks[0]) = (ay, gear);
        case.setting.elastic_tyres = false;
        let found = solver.solve(&case).unwrap();
        let state = solver.balance(&case, &found).unwrap();
        let poses = solver.poses(&found).unwrap();
        let names = ["kingpin_lower", "right_kingpin_lower", "lower_link_axle"];
        let mut axle = AxleSolver::<2>::new(&car.axles[0], &[], false).unwrap();
        let h = 0.01;
        let mut at = |by: f64| {
            let [left, right] = poses[0].travels;
            let placement = Placement::Travels {
                travels: [left + by, right - by],
                rack: gear,
                on_plane: false,
            };
            let placed = axle.place(&placement).unwrap();
            places(&car, &placed, &names)
        };
        let (below, here, above) = (at(-h), at(0.0), at(h));
        let rate = |k: usize| (above[k] - below[k]) * (0.5 / h);
        let road = &state.road;
        // The differences between the velocities of points determine the angular velocity w: each difference is w x d.
        // The test needs the component about the road's forward axis.
        let columns: Vec<_> = [1, 2]
            .into_iter()
            .flat_map(|k| {
                let (d, v) = (here[k] - here[0], rate(k) - rate(0));
                [
                    ([0.0, d.z, -d.y], v.x),
                    ([-d.z, 0.0, d.x], v.y),
                    ([d.y, -d.x, 0.0], v.z),
                ]
            })
            .collect();
        let matrix = DMatrix::from_fn(6, 3, |row, column| columns[row].0[column]);
        let right = DVector::from_fn(6, |row, _| columns[row].1);
        let turn = matrix.svd(true, true).solve(&right, 1e-12).unwrap();
        let turn = V::new(turn[0], turn[1], turn[2]);
        let [left, right] = [0, 1].map(|number| state.wheels[number].contact);
        let middle = (left + right) * 0.5;
        let velocity = rate(0) + turn.cross(middle - here[0]);
        let height = velocity.dot(road.left) / turn.dot(road.forward);
        let solved = solver.solved(&case, &found).unwrap();
        let own = CarQuantity::Axle(AxleEnd::Front, AxleResult::RollCentreHeight);
        let value = own.evaluate(&solved);
        assert!((value - height).abs() < 1e-3, "{gear}: {value} {height}");
    }
}

/// A gear angle to the left steers both wheels to the left. The inner wheel steers more than the outer wheel.
#[test]
fn the_gear_steers_both_wheels() {
    let path = crate::support::studies().join("off_road_car.toml");
    let study = CarStudy::read(&path, &[]).unwrap();
    let mut solver = CarSolver::new(&study.car).unwrap();
    let mut steer = |name: &str| {
        let case = study.cases.iter().find(|case| case.name == name).unwrap();
        let found = solver.solve(case).unwrap();
        let solved = solver.solved(case, &found).unwrap();
        let of = |name: &str| CarQuantity::named(name)[0].evaluate(&solved);
        [of("front_left_steer"), of("front_right_steer")]
    };
    let ([left, right], [left_back, right_back]) = (steer("turn"), steer("turn_right"));
    assert!(left > right && right > 0.05, "{left} {right}");
    assert!(
        right_back < left_back && left_back < -0.05,
        "{left_back} {right_back}"
    );
}

/// A drawing shows the steered wheels. Each lowest point is below its wheel centre in the plane across the spin axis, as far away
/// as the tyre's radius. The rods between steering gear and knuckles keep their lengths.
#[test]
fn a_drawing_shows_the_steered_wheels() {
    let path = crate::support::studies().join("off_road_car.toml");
    let study = CarStudy::read(&path, &[]).unwrap();
    let mechanism = &study.car.axles[0].left.mechanism;
    let mut solver = CarSolver::new(&study.car).unwrap();
    let mut drawn = |name: &str| {
        let case = study.cases.iter().find(|case| case.name == name).unwrap();
        let found = solver.solve(case).unwrap();
        solver.drawing(case, &found).unwrap()
    };
    let ([turn, braking], mut worst) = ([drawn("turn"), drawn("braking")], 0.0_f64);
    for drawing in [&turn, &braking] {
        for wheel in 0..4 {
            let radius = study.car.axles[wheel / 2].setup.wheel_radius.unwrap();
            let lever = V::from(drawing.contacts[wheel]) - V::from(drawing.centres[wheel]);
            let axis = V::from(drawing.spin_axes[wheel]);
            worst = larger(worst, lever.dot(axis).abs());
            worst = larger(worst, (lever.norm() - radius).abs());
        }
    }
    let length = |of: [&str; 2]| {
        let [a, b] = of.map(|name| V::from(turn.points[0][mechanism.point(name).unwrap().0]));
        let [c, d] = of.map(|name| V::from(braking.points[0][mechanism.point(name).unwrap().0]));
        (a - b).norm() - (c - d).norm()
    };
    worst = larger(worst, length(["drag_link_body", "drag_link_knuckle"]).abs());
    worst = larger(worst, length(["tie_rod_end", "right_tie_rod_end"]).abs());
    assert!(worst < 1e-6, "{worst}");
    // The left wheel steers to the left: the outboard end of its axis moves rearward by more than 0.05 rad.
    assert!(turn.spin_axes[0][0] < braking.spin_axes[0][0] - 0.05);
}

/// Parts of both solid axles cause first-order variances of the car. These variances equal those from finite
/// differences of cars that are assembled and solved.
#[test]
fn first_order_of_parts_is_that_of_built_cars() {
    let path = crate::support::studies().join("off_road_car.toml");
    for part in [
        r#"axle="front",length="tie_rod""#,
        r#"axle="front",hardpoint="kingpin_upper",axis="y",side="right""#,
        r#"axle="front",hardpoint="panhard_axle",axis="z""#,
        r#"axle="rear",hardpoint="lower_link_axle",axis="z",side="left""#,
        r#"axle="rear",length="upper_link",side="right""#,
    ] {
        let study = |law: &str| {
            let scatter = format!("tolerance.scatter=[{{{part},{law}}}]");
            let bands = "tolerance.bands=[]".to_owned();
            let study = CarStudy::read(&path, &[scatter, bands]);
            study.unwrap_or_else(|e| panic!("{}", e.render(false)))
        };
        super::assert_scatter_is_slope(part, study, 20);
    }
}

//! Tests against textbook formulas where the assumptions of these formulas hold: small angles, rigid tyres, a symmetric
//! car without aerodynamics. For roll, the wheels are massless.

use super::{car, reference};
use hardpoint::axle::{AxleQuantity as A, AxleSolver, Placement, Quantity};
use hardpoint::car::{
    AxleEnd, AxleResult, Car, CarQuantity, CarSolver, Case, GRAVITY, WheelPlace, WheelResult,
    WholeResult,
};

/// Symmetric reference car without aerodynamics.
fn symmetric_car() -> Car {
    let mut car = car(&reference());
    (car.cg.y, car.air) = (0.0, None);
    car
}

fn near(what: &str, found: f64, textbook: f64) {
    let error = (found / textbook - 1.0).abs();
    println!("{what}: {found} {textbook}, {:.3} %", 100.0 * error);
    assert!(error < 0.01, "{what}: {found} {textbook}");
}

/// Three results are close to their textbook formulas (W. F. Milliken, D. L. Milliken, Race Car Vehicle Dynamics, ch.
/// 18). Wheel loads at rest follow the lever rule. The roll gradient is W h/(K_f + K_r - W h). W is the weight of the
/// sprung mass, h the height of its centre of gravity above the roll axis. K_f and K_r are the roll stiffnesses of the
/// axles. The load transfer of the front axle follows from its share of the roll stiffness, the roll centre and the
/// wheels.
#[test]
fn textbook_formulas_are_near() {
    let car = symmetric_car();
    let mut rest = Case::at_rest("static");
    rest.setting.elastic_tyres = false;
    let mut solver = CarSolver::new(&car).unwrap();
    let found = solver.solve(&rest).unwrap();
    let poses = solver.poses(&found).unwrap();
    let solved = solver.solved(&rest, &found).unwrap();
    let value = |quantity: CarQuantity| quantity.evaluate(&solved);
    let whole = |result| value(CarQuantity::Whole(result));
    let wheel_centre = |axle: usize| {
        let left = &car.axles[axle].left;
        let offset = [0.0, car.rear_offset.x][axle];
        left.design[left.mechanism.wheel_centre.0].x + offset
    };
    let (front, rear) = (wheel_centre(0), wheel_centre(1));
    let unsprung = [0, 1].map(|axle| car.axles[axle].setup.unsprung_mass.unwrap());
    let share = (car.cg.x - rear) / (front - rear);
    let front_load = GRAVITY * (car.mass * share + unsprung[0]);
    let load = value(CarQuantity::Wheel(WheelPlace(0), WheelResult::Load));
    near("static load", load, 0.5 * front_load);

    let mut stiffness = [0.0; 2];
    let mut centres = [0.0; 2];
    for axle in [0, 1] {
        let [k, h] = of_level_axle(
            &car,
            axle,
            poses[axle].travels,
            [A::RollStiffnessAtLoad, A::RollCentreHeight],
        );
        (stiffness[axle], centres[axle]) = (k, h);
    }
    // The inertia of the wheels acts on the body through the links. Textbooks omit it in the roll formula.
    let mut light = car.clone();
    for axle in &mut light.axles {
        axle.setup.unsprung_mass = Some(1e-6);
    }
    let mut light_solver = CarSolver::new(&light).unwrap();
    let light_found = light_solver.solve(&rest).unwrap();
    let light_solved = light_solver.solved(&rest, &light_found).unwrap();
    let roll_gradient = CarQuantity::Whole(WholeResult::RollGradient);
    let weight = car.mass * GRAVITY;
    let at_cg = centres[1] + (centres[0] - centres[1]) * share;
    let height = whole(WholeResult::SprungCgHeight);
    let arm = height - at_cg;
    let total = stiffness[0] + stiffness[1];
    let gradient = weight * arm / (total - weight * arm);
    near(
        "roll gradient",
        roll_gradient.evaluate(&light_solved),
        gradient,
    );

    let ay = 0.3;
    let mut turn = Case { ay, ..rest.clone() };
    turn.name = "turn".to_owned();
    let found = solver.solve(&turn).unwrap();
    let solved = solver.solved(&turn, &found).unwrap();
    let value = |quantity: CarQuantity| quantity.evaluate(&solved);
    let mut transfers = [0.0; 2];
    for (axle, end) in AxleEnd::ALL.into_iter().enumerate() {
        let of = |result| value(CarQuantity::Axle(end, result));
        let radius = car.axles[axle].setup.wheel_radius.unwrap();
        let carried = weight * [share, 1.0 - share][axle];
        // The rolled body adds the moment of its weight.
        let rolled = weight * arm * (1.0 + gradient);
        let moment = rolled * stiffness[axle] / total
            + carried * centres[axle]
            + unsprung[axle] * GRAVITY * radius;
        transfers[axle] = ay * moment / of(AxleResult::Track);
        near(end.name(), of(AxleResult::Transfer), transfers[axle]);
    }
    let distribution = 100.0 * transfers[0] / (transfers[0] + transfers[1]);
    let exact = value(CarQuantity::Whole(WholeResult::Distribution));
    near("distribution", exact, distribution);
}

/// Values of an axle in a level position at the mean travel of its wheels.
fn of_level_axle(car: &Car, axle: usize, travels: [f64; 2], asked: [A; 2]) -> [f64; 2] {
    let asked = asked.map(Quantity::Axle);
    let mut solver = AxleSolver::<4>::new(&car.axles[axle], &asked, false).unwrap();
    let placement = Placement::Roll {
        heave: 0.5 * (travels[0] + travels[1]),
        roll: 0.0,
        rack: 0.0,
    };
    let placed = solver.place(&placement).unwrap();
    let read = solver.read(&placed).unwrap();
    asked.map(|quantity| read.value(quantity).unwrap())
}

/// A twist of the ground loads the roll stiffnesses of both axles in series. An axle with the roll stiffness K has the
/// rate k = K/(track^2/2) at each wheel. If the body is free and the tracks are equal, each wheel load changes by
/// 2 k_f k_r/(k_f + k_r) per pad displacement.
#[test]
fn warp_is_the_series_of_both_axles() {
    let car = symmetric_car();
    let mut rest = Case::at_rest("static");
    rest.setting.elastic_tyres = false;
    let mut solver = CarSolver::new(&car).unwrap();
    let found = solver.solve(&rest).unwrap();
    let poses = solver.poses(&found).unwrap();
    let solved = solver.solved(&rest, &found).unwrap();
    let mut rates = [0.0; 2];
    let mut tracks = [0.0; 2];
    for axle in [0, 1] {
        let [k, track] = of_level_axle(
            &car,
            axle,
            poses[axle].travels,
            [A::RollStiffnessAtLoad, A::Track],
        );
        tracks[axle] = track;
        rates[axle] = 2.0 * k / (track * track);
    }
    // Each pad moves by w: the ground angle is 2 w/track at the front axle and -2 w/track at the rear axle. The body
    // rolls until both moments are equal.
    let [front, rear] = [0, 1].map(|axle| rates[axle] * tracks[axle] * tracks[axle]);
    let twist = 2.0 / tracks[0] + 2.0 / tracks[1];
    let moment = 0.5 * twist * front * rear / (front + rear);
    let expected = 0.5 * (moment / tracks[0] + moment / tracks[1]);
    let warp = CarQuantity::Whole(WholeResult::WarpStiffness).evaluate(&solved);
    near("warp", warp, expected);
}

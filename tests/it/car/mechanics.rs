//! Tests of statics on random states of random cars.

use super::{car, reference};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::{AxleSolver, Placement, Quantity, WheelQuantity};
use hardpoint::car::{
    AxleParameter, Car, CarGoals, CarQuantity, CarRun, CarSolver, CarTarget, CarVariable, Case,
    Equilibrium, GRAVITY, Longitudinal, Moves, NoEquilibrium, WholeResult, tune,
};
use hardpoint::model::{Axis, Side};
use hardpoint::number::Vector3;

/// Random number with uniform distribution between two limits.
fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + 0.5 * (random.signed() + 1.0) * (high - low)
}

/// Reference car with random changes of hardpoints, masses and rates.
fn random_car(random: &mut Random) -> Car {
    let mut moved = car(&reference());
    for axle in &mut moved.axles {
        for point in &mut axle.left.design {
            let step = Vector3::new(
                between(random, -4.0, 4.0),
                between(random, -4.0, 4.0),
                between(random, -4.0, 4.0),
            );
            *point = *point + step;
        }
        axle.setup.bar_rate = axle
            .setup
            .bar_rate
            .map(|rate| rate * between(random, 0.5, 1.5));
    }
    moved.mass *= between(random, 0.9, 1.1);
    moved.cg.x += between(random, -100.0, 100.0);
    moved.cg.y += between(random, -30.0, 30.0);
    moved.cg.z += between(random, -80.0, 80.0);
    moved
}

fn random_case(random: &mut Random, most: f64) -> Case {
    let mut case = Case::at_rest("random");
    case.ax = between(random, -most, 0.5 * most);
    case.ay = between(random, -most, most);
    case.az = between(random, -0.2, 0.2);
    case.speed = between(random, 0.0, 40.0);
    case.racks[0] = between(random, -15.0, 15.0);
    case.setting.elastic_tyres = between(random, 0.0, 1.0) < 0.5;
    if case.ax < 0.0 {
        case.setting.longitudinal = Longitudinal::Brake;
    }
    case
}

/// Calls `check` with the solved states of random cars. Returns the numbers of solved and unsolved states.
fn for_random_states(
    seed: u64,
    cars: usize,
    states: usize,
    mut check: impl FnMut(&Car, &mut CarSolver<'_>, &Case, &Equilibrium),
) -> [usize; 2] {
    let mut random = Random(seed);
    let mut count = [0; 2];
    for _ in 0..cars {
        let car = random_car(&mut random);
        let mut solver = CarSolver::new(&car).unwrap();
        for _ in 0..states {
            let case = random_case(&mut random, 0.6);
            match solver.solve(&case) {
                Ok(found) => {
                    count[0] += 1;
                    check(&car, &mut solver, &case, &found);
                }
                Err(_) => count[1] += 1,
            }
        }
    }
    count
}

/// The published forces of tyres, aerodynamics and inertia balance each other. The components of each wheel load add up
/// to the load.
#[test]
fn free_body_and_parts_of_loads_balance() {
    let mut worst = [0.0_f64; 3];
    let [solved, failed] = for_random_states(11, 20, 50, |car, solver, case, found| {
        let state = solver.balance(case, found).unwrap();
        let unsprung = |number: usize| 0.5 * car.axles[number / 2].setup.unsprung_mass.unwrap();
        let mass: f64 = car.mass + (0..4).map(unsprung).sum::<f64>();
        let weight = mass * GRAVITY;
        let road = &state.road;
        let acceleration = road.forward * (case.ax * GRAVITY)
            + road.left * (case.ay * GRAVITY)
            + road.up * ((1.0 + case.az) * GRAVITY);
        let mut force = Vector3::new(0.0, 0.0, 0.0);
        let mut moment = force;
        let mut act = |at: Vector3<f64>, by: Vector3<f64>| {
            force = force + by;
            moment = moment + at.cross(by);
        };
        for (number, wheel) in state.wheels.iter().enumerate() {
            let tyre = road.up * wheel.load
                + wheel.across * wheel.side_force
                + wheel.heading * wheel.longitudinal_force;
            act(wheel.contact, tyre);
            act(wheel.corner.centre, -(acceleration * unsprung(number)));
            let sum: f64 = wheel.parts.iter().sum();
            // One solution contains all four loads, so rounding scales with the mean load.
            worst[2] = larger(worst[2], (sum - wheel.load).abs() / (0.25 * weight));
            assert!(found.lifted[number] || wheel.load > 0.0);
        }
        // The centre of gravity of the sprung mass has coordinates in body axes.
        act(car.cg, -(acceleration * car.mass));
        if let Some(air) = &car.air {
            for end in [0, 1] {
                let force = air.downforce[end].unwrap();
                act(force.point, -(road.up * state.air[end]));
            }
            act(air.drag.unwrap().point, -(road.forward * state.air[2]));
        }
        worst[0] = larger(worst[0], force.norm() / weight);
        worst[1] = larger(worst[1], moment.norm() / (weight * 2650.0));
    });
    println!("{solved} solved, {failed} not; worst {worst:?}");
    assert!(solved >= 990, "{solved}");
    assert!(worst[0] < 1e-11 && worst[1] < 1e-11, "{worst:?}");
    assert!(worst[2] < 1e-13, "{worst:?}");
}

/// Gradients along ay equal finite differences between neighbouring states.
#[test]
fn gradients_are_those_of_neighbouring_states() {
    let car = car(&reference());
    let mut solver = CarSolver::new(&car).unwrap();
    let step = 1e-4;
    for ay in [0.0, 0.3, -0.5, 0.7] {
        let mut at = |ay: f64| {
            let case = Case {
                ay,
                ..Case::at_rest("turn")
            };
            let found = solver.solve(&case).unwrap();
            let solved = solver.solved(&case, &found).unwrap();
            let roll = CarQuantity::Whole(WholeResult::Roll).evaluate(&solved);
            let gradient = CarQuantity::Whole(WholeResult::RollGradient).evaluate(&solved);
            [roll, gradient]
        };
        let [below, above] = [at(ay - step)[0], at(ay + step)[0]];
        let [_, gradient] = at(ay);
        let quotient = (above - below) / (2.0 * step);
        // The error of a central difference has the order of the square of the step.
        assert!(
            (gradient - quotient).abs() < 1e-6 * gradient.abs(),
            "{gradient} {quotient}"
        );
    }
}

/// Beyond wheel lift, five different starts lead to the same wheels in contact and the same loads. The function
/// examines `states` states with a lifted wheel.
fn compare_starts(seed: u64, states: usize) {
    let car = car(&reference());
    let mut solver = CarSolver::new(&car).unwrap();
    let mut random = Random(seed);
    let mut lifted = 0;
    for _ in 0..4 * states {
        let mut case = random_case(&mut random, 0.6);
        (case.ay, case.speed, case.az) = (between(&mut random, 1.05, 1.35), 0.0, 0.0);
        let Ok(found) = solver.solve(&case) else {
            continue;
        };
        if found.lifted == [false; 4] {
            continue;
        }
        lifted += 1;
        for _ in 0..5 {
            let mut attitude = [0.0; 7];
            attitude.copy_from_slice(&found.unknowns[..7]);
            for (k, value) in attitude.iter_mut().enumerate() {
                *value += match k {
                    0 | 1 => between(&mut random, -0.02, 0.02),
                    _ => between(&mut random, -10.0, 10.0),
                };
            }
            let again = solver.solve_from_attitude(&case, attitude).unwrap();
            assert_eq!(again.lifted, found.lifted);
            for k in 7..11 {
                let error = (again.unknowns[k] - found.unknowns[k]).abs();
                assert!(error < 1e-7, "{error:e}");
            }
        }
        if lifted == states {
            break;
        }
    }
    assert_eq!(lifted, states);
}

#[test]
fn states_with_lifted_wheels_do_not_depend_on_the_start() {
    compare_starts(5, 15);
}

#[test]
#[ignore = "100 states: with .ci/long"]
fn many_states_with_lifted_wheels_do_not_depend_on_the_start() {
    compare_starts(6, 100);
}

/// Number of solved states and number of all states of random cars, below the first lift along each direction.
fn solved_below_lift(seed: u64, cars: usize, directions: usize) -> [usize; 2] {
    let mut random = Random(seed);
    let mut count = [0; 2];
    for _ in 0..cars {
        let car = random_car(&mut random);
        let mut solver = CarSolver::new(&car).unwrap();
        for _ in 0..directions {
            let mut case = random_case(&mut random, 0.6);
            case.yaw_acceleration = 0.0;
            let Some(limits) = solver.limits(&case) else {
                continue;
            };
            // Without a lift, the end of equilibrium limits the states.
            let end = limits.lift.map_or(limits.end, |lift| lift.acceleration);
            let length = case.ax.hypot(case.ay);
            for _ in 0..4 {
                let g = end * between(&mut random, 0.0, 0.999);
                let state = Case {
                    ax: case.ax * g / length,
                    ay: case.ay * g / length,
                    ..case.clone()
                };
                count[1] += 1;
                count[0] += usize::from(solver.solve(&state).is_ok());
            }
        }
    }
    count
}

#[test]
fn states_below_the_lift_limit_are_solved() {
    let [solved, all] = solved_below_lift(7, 1, 2);
    assert!(all >= 4, "{all}");
    assert_eq!(solved, all);
}

#[test]
#[ignore = "10,000 states: with .ci/long"]
fn nearly_all_states_below_the_lift_limit_are_solved() {
    let [solved, all] = solved_below_lift(8, 100, 25);
    println!("{solved} of {all} states below the lift limit are solved");
    assert!(all > 9000 && 100 * solved >= 99 * all, "{solved} of {all}");
}

/// A weightless car, a car that overturns, and a car without springs have no equilibrium. The error states the reason.
#[test]
fn what_cannot_stand_is_said_so() {
    let mut car = car(&reference());
    let at = |car: &Car, ay: f64, az: f64| {
        let case = Case {
            ay,
            az,
            ..Case::at_rest("no")
        };
        CarSolver::new(car)
            .unwrap()
            .solve(&case)
            .map(|found| found.lifted)
    };
    assert_eq!(at(&car, 0.0, -1.0), Err(NoEquilibrium::AllLifted));
    let thrown = at(&car, 2.5, 0.0).unwrap_err();
    assert!(
        ["no_equilibrium", "unstable", "unreachable", "singular"].contains(&thrown.status()),
        "{thrown:?}"
    );
    car.axles[1].setup.springs = None;
    assert_eq!(at(&car, 0.0, 0.0), Err(NoEquilibrium::Unsupported));
}

/// If the centre of gravity is in the plane of symmetry, a mirrored case has the mirrored state.
#[test]
fn a_right_turn_is_the_mirror_image_of_a_left_turn() {
    let mut car = car(&reference());
    car.cg.y = 0.0;
    let mut solver = CarSolver::new(&car).unwrap();
    let mut at = |sign: f64| {
        let mut case = Case::at_rest("turn");
        (case.ax, case.ay) = (-0.3, 0.6 * sign);
        case.setting.longitudinal = Longitudinal::Brake;
        case.racks[0] = -10.0 * sign;
        solver.solve(&case).unwrap().unknowns
    };
    let (left, right) = (at(1.0), at(-1.0));
    for (a, b) in [(7, 8), (8, 7), (9, 10), (10, 9)] {
        assert!(
            (left[a] - right[b]).abs() < 1e-8,
            "{} {}",
            left[a],
            right[b]
        );
    }
    assert!((left[0] + right[0]).abs() < 1e-13 && (left[1] - right[1]).abs() < 1e-13);
}

/// Without pitch, the elastic components of the wheel loads equal the wheel loads of each axle alone. The single axle
/// is in roll on plane ground at the same mean travel.
#[test]
fn axles_by_themselves_are_a_special_case() {
    let car = car(&reference());
    let mut solver = CarSolver::new(&car).unwrap();
    for (ay, rack) in [(0.0, 0.0), (0.5, -8.0), (-0.4, 5.0), (0.8, 0.0)] {
        let mut case = Case::at_rest("level");
        (case.ay, case.racks[0]) = (ay, rack);
        case.setting.elastic_tyres = false;
        // Searches for the acceleration at which the body does not pitch.
        let mut state = None;
        for _ in 0..8 {
            let found = solver.solve(&case).unwrap();
            let solved = solver.solved(&case, &found).unwrap();
            let gradient = CarQuantity::Whole(WholeResult::PitchGradient).evaluate(&solved);
            case.ax -= found.unknowns[1] / gradient;
            state = Some(solved.now);
        }
        let state = state.unwrap();
        assert!(state.unknowns[1].abs() < 1e-14, "{:e}", state.unknowns[1]);
        for (number, axle) in car.axles.iter().enumerate() {
            let loads = Side::ALL.map(|side| Quantity::Wheel(side, WheelQuantity::WheelLoad));
            let mut alone = AxleSolver::<3>::new(axle, &loads, false).unwrap();
            let travels = [0, 1].map(|side| state.unknowns[3 + 2 * number + side]);
            let placement = Placement::Roll {
                heave: 0.5 * (travels[0] + travels[1]),
                roll: state.unknowns[0],
                rack: case.racks[number],
            };
            let placed = alone.place(&placement).unwrap();
            let read = alone.read(&placed).unwrap();
            for side in [0, 1] {
                let load = read.value(loads[side]).unwrap();
                let elastic = state.wheels[2 * number + side].parts[0];
                assert!((placed.travels[side] - travels[side]).abs() < 1e-10);
                assert!((load - elastic).abs() < 1e-12 * 4000.0, "{load} {elastic}");
            }
        }
    }
}

/// The targets are computed from a known design. A tuning with six variables of both axles meets these targets.
#[test]
fn planted_targets_are_met() {
    plant(3, 4);
}

#[test]
#[ignore = "times of 20 tunings: with .ci/long"]
fn planted_targets_of_twenty_seeds_are_met() {
    let mut times = plant(4, 20);
    times.sort_by(f64::total_cmp);
    println!(
        "{:.1} ms a tuning in the median, {:.1} ms at most",
        1e3 * times[10],
        1e3 * times[19]
    );
}

/// Variable with a range about the value of a car.
fn variable(moves: &Moves, car: &Car) -> CarVariable {
    let now = moves.value(car).unwrap();
    let range = if now == 0.0 {
        [-8.0, 8.0]
    } else {
        [0.6 * now, 1.4 * now]
    };
    CarVariable {
        moves: moves.clone(),
        range,
    }
}

/// Results of a car as targets of a tuning.
fn results_as_targets(car: &Car, cases: &[Case]) -> Vec<CarTarget> {
    let mut solver = CarSolver::new(car).unwrap();
    let mut targets = Vec::new();
    let names = [
        "roll",
        "roll_gradient",
        "lateral_load_transfer_distribution",
        "roll_steer_gradient_front",
        "roll_steer_gradient_rear",
        "front_left_camber_to_road",
        "rear_right_toe",
        "pitch",
    ];
    for (number, case) in cases.iter().enumerate() {
        let found = solver.solve(case).unwrap();
        let solved = solver.solved(case, &found).unwrap();
        for name in names {
            let quantity = CarQuantity::named(name)[0];
            if let Some(value) = quantity.printed(&solved, case) {
                targets.push(CarTarget {
                    quantity,
                    case: number,
                    wanted: [value; 2],
                    tolerance: 0.01,
                    weight: 1.0,
                });
            }
        }
    }
    targets
}

/// Tunes six variables of both axles to at least ten targets that were computed from known designs. Returns the times
/// in seconds.
fn plant(seed: u64, seeds: usize) -> Vec<f64> {
    let mut times = Vec::new();
    let car = car(&reference());
    let hardpoint = |axle: usize, name: &str, axis: Axis| {
        let point = car.axles[axle].left.mechanism.point(name).unwrap();
        super::one_point(axle, point, axis)
    };
    let rate = |axle: usize, parameter| Moves::Rate { axle, parameter };
    let moves = [
        hardpoint(0, "tie_rod_inner", Axis::Z),
        hardpoint(1, "toe_link_inner", Axis::Z),
        hardpoint(0, "lower_ball_joint", Axis::Z),
        rate(0, AxleParameter::BarRate),
        rate(1, AxleParameter::BarRate),
        rate(1, AxleParameter::SpringRate),
    ];
    let mut random = Random(seed);
    for seed in 0..seeds {
        let variables: Vec<CarVariable> = moves.iter().map(|moves| variable(moves, &car)).collect();
        let planted: Vec<f64> = variables
            .iter()
            .map(|variable| {
                let now = variable.moves.value(&car).unwrap();
                if now == 0.0 {
                    between(&mut random, -5.0, 5.0)
                } else {
                    now * between(&mut random, 0.8, 1.2)
                }
            })
            .collect();
        let truth = hardpoint::car::moved(&car, &variables, &planted);
        let mut turn = Case::at_rest("turn");
        (turn.ay, turn.racks[0]) = (0.6, -10.0);
        let mut braking = Case::at_rest("braking");
        braking.ax = -0.5;
        braking.setting.longitudinal = Longitudinal::Brake;
        let cases = [turn, braking];
        let targets = results_as_targets(&truth, &cases);
        assert!(targets.len() >= 10);
        let run = CarRun {
            max_iterations: 100,
            starts: 1,
            seed: 1,
        };
        let goals = CarGoals {
            cases: &cases,
            variables: &variables,
            targets: &targets,
            constraints: &[],
            rigs: [None, None],
        };
        let clock = std::time::Instant::now();
        let tuning = tune(&car, goals, run, Default::default()).unwrap();
        let tuned = tuning.starts.best_fit().unwrap();
        times.push(clock.elapsed().as_secs_f64());
        println!(
            "{seed}: misfit {:e}, {} evaluations",
            tuned.misfit(),
            tuned.evaluations()
        );
        assert!(tuned.misfit() < 1e-6, "{seed}: {:e}", tuned.misfit());
    }
    times
}

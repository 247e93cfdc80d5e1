//! States of a map, each from its neighbour, are those of the cases by themselves; and the time that they take.

use super::commands::hardpoint;
use super::{car, reference};
use hardpoint::car::{
    Car, CarQuantity, CarSolver, Case, Equilibrium, Longitudinal, LongitudinalShares,
};
use hardpoint::study::CarStudy;
use std::time::Instant;

/// Cases over ax and ay, row by row.
fn map(car: &Car, count: usize) -> Vec<Vec<Case>> {
    let at = |k: usize, from: f64, to: f64| from + (to - from) * k as f64 / (count - 1) as f64;
    let case = |i: usize, j: usize| {
        let mut case = Case::at_rest("map");
        case.setting.elastic_tyres = car.tyres.is_some();
        (case.ax, case.ay) = (at(i, -0.75, 0.4), at(j, 0.0, 0.9));
        if case.ax < 0.0 {
            case.setting.longitudinal = Longitudinal::Brake;
        }
        case.setting.longitudinal_shares = LongitudinalShares::ByLoad;
        case
    };
    let row = |i: usize| (0..count).map(|j| case(i, j)).collect();
    (0..count).map(row).collect()
}

fn formula_student_car() -> Car {
    let path = super::commands::studies().join("formula_student_car.toml");
    CarStudy::read(&path, &[]).unwrap().car
}

/// Solves a map, and hands over each state.
fn walk(
    car: &Car,
    count: usize,
    mut visit: impl FnMut(&mut CarSolver<'_>, &Case, &Equilibrium),
) -> usize {
    let mut solver = CarSolver::new(car).unwrap();
    let mut states = 0;
    for row in map(car, count) {
        let mut before: Option<Equilibrium> = None;
        for case in row {
            let found = match &before {
                Some(before) => solver.solve_from(&case, before),
                None => solver.solve(&case),
            };
            let found = found.unwrap();
            visit(&mut solver, &case, &found);
            states += 1;
            before = Some(found);
        }
    }
    states
}

/// Neighbours are read from the wheels' curves and keep a tangent over several steps. Every result is that of the case solved by
/// itself, from poses, to 1e-9 of its size. Points of 300 mm are known to 8 roundings, 5e-13 mm, and a roll centre amplifies
/// that a hundred times: below a twentieth of the unit that is the bound. A quotient such as a roll centre 40 m away amplifies
/// rounding by its size.
#[test]
fn neighbours_are_the_states_of_their_cases() {
    for car in [car(&reference()), formula_student_car()] {
        let mut alone = CarSolver::new(&car).unwrap();
        let quantities = CarQuantity::default_columns(&car);
        let mut most = 0.0_f64;
        walk(&car, 4, |solver, case, found| {
            let itself = alone.solve(case).unwrap();
            assert_eq!(found.lifted, itself.lifted);
            let ours = solver.solved(case, found).unwrap();
            let theirs = alone.solved(case, &itself).unwrap();
            for quantity in &quantities {
                let printed = |of| quantity.printed(of, case);
                let (Some(a), Some(b)) = (printed(&ours), printed(&theirs)) else {
                    continue;
                };
                let size = b.abs().max(0.05);
                most = most.max((a - b).abs() / size);
                assert!(
                    (a - b).abs() <= 1e-9 * size * (1.0 + size / 1000.0),
                    "{}: {a} {b}",
                    quantity.name()
                );
            }
        });
        println!("largest difference {most:e}");
    }
}

/// Each row of a map has its own copy of the solver, so `gg.csv` has the same bytes for any number of threads.
#[test]
fn bytes_do_not_depend_on_the_threads() {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    let maps = ["1", "2"].map(|threads| {
        let arguments = ["solve", "car.toml", "--threads", threads, "--out", threads];
        hardpoint(directory.path(), &arguments).success();
        std::fs::read(directory.path().join(threads).join("gg.csv")).unwrap()
    });
    assert_eq!(maps[0].iter().filter(|byte| **byte == b'\n').count(), 21);
    assert_eq!(maps[0], maps[1]);
}

/// Prints the states of a map that are solved per second: alone, with the parts of the loads, with all results, with member loads.
#[test]
#[ignore = "times: with .ci/long"]
fn states_per_second() {
    for car in [car(&reference()), formula_student_car()] {
        type Visit = fn(&mut CarSolver<'_>, &Case, &Equilibrium);
        let kinds: [(&str, Visit); 4] = [
            ("attitude and loads", |_, _, _| {}),
            ("with parts", |solver, case, found| {
                std::hint::black_box(solver.balance(case, found).unwrap());
            }),
            ("with all results", |solver, case, found| {
                std::hint::black_box(solver.solved(case, found).unwrap());
            }),
            ("with member loads", |solver, case, found| {
                std::hint::black_box(solver.members(case, found).unwrap());
            }),
        ];
        for (kind, visit) in kinds {
            let clock = Instant::now();
            let states = walk(&car, 41, visit);
            let seconds = clock.elapsed().as_secs_f64();
            assert_eq!(states, 41 * 41);
            println!("{:.0} states/s {kind}", states as f64 / seconds);
        }
    }
}

//! Tests of maps. The program solves states of a map from neighbouring states. These states equal those of load cases that are
//! solved separately. One test also measures the time.

use super::commands::hardpoint;
use super::{car, formula_student_car, reference};
use crate::support::larger;
use hardpoint::car::{
    Car, CarQuantity, CarSolver, Case, Equilibrium, GRAVITY, Longitudinal, LongitudinalShares,
};
use hardpoint::number::Width;
use std::time::Instant;

/// Load cases of a grid over ax and ay, row by row.
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

/// Solves a map, and passes each state to `visit`.
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

/// The solver of maps takes its wheel curves from interpolation and uses a tangent for several steps. Every result equals that
/// of the same case, solved alone from poses, to 1e-9 of the result. Values below 0.05 have the same bound as 0.05. The reason:
/// points at 300 mm are accurate to 8 roundings (5e-13 mm), and a roll centre amplifies this error a hundred times. A quotient,
/// such as a roll centre at 40 m, amplifies rounding in proportion to its value.
#[test]
fn neighbours_are_the_states_of_their_cases() {
    for car in [car(&reference()), formula_student_car()] {
        let mut alone = CarSolver::new(&car).unwrap();
        let quantities = CarQuantity::default_columns(&car);
        let (mut most, mut compared) = (0.0_f64, 0);
        walk(&car, 4, |solver, case, found| {
            let itself = alone.solve(case).unwrap();
            assert_eq!(found.lifted, itself.lifted);
            let ours = solver.solved(case, found).unwrap();
            let theirs = alone.solved(case, &itself).unwrap();
            for quantity in &quantities {
                let printed = |of| quantity.printed(of, case);
                let (Some(a), Some(b)) = (printed(&ours), printed(&theirs)) else {
                    let are_known = [&ours, &theirs].map(|of| printed(of).is_some());
                    assert_eq!(are_known, [false; 2], "{}", quantity.name());
                    continue;
                };
                let size = b.abs().max(0.05);
                most = larger(most, (a - b).abs() / size);
                assert!(
                    (a - b).abs() <= 1e-9 * size * (1.0 + size / 1000.0),
                    "{}: {a} {b}",
                    quantity.name()
                );
                compared += 1;
            }
        });
        println!("largest difference {most:e}");
        assert!(compared > 16 * 20, "{compared}");
    }
}

/// Rows of a map that are solved in SIMD lanes have the same states as their cases solved alone. The two results agree to 1e-11
/// of the weight, of the length unit in metres, or of a radian. Both searches end at steps of 2e-15 of these sizes, and the
/// tangent amplifies the rounding of the residuals. Most states come from SIMD lanes. If wheels lift or a case has other
/// settings, the solver for single cases finds the state.
#[test]
fn rows_in_lanes_are_the_states_of_their_cases() {
    for (car, lifting) in [(car(&reference()), 1.4), (formula_student_car(), 2.2)] {
        let mut rows = map(&car, 14);
        for row in &mut rows {
            for case in row {
                case.ay *= lifting / 0.9;
            }
        }
        // One row is short. Another row has cases with alternating settings.
        rows[3].truncate(2);
        for case in rows[9].iter_mut().step_by(2) {
            case.racks[0] += 0.001 * car.per_metre();
        }
        let rows: Vec<&[Case]> = rows.iter().map(Vec::as_slice).collect();
        let mut alone = CarSolver::new(&car).unwrap();
        let mut next = vec![0; rows.len()];
        let (mut from_lanes, mut lifted, mut most) = (0, 0, 0.0_f64);
        CarSolver::new(&car)
            .unwrap()
            .solve_rows(&rows, &mut |solver, [row, number], state| {
                assert_eq!(next[row], number, "cases of row {row} come in their order");
                next[row] += 1;
                let case = &rows[row][number];
                let itself = match (&state, alone.solve(case)) {
                    (Ok(_), Ok(itself)) => itself,
                    (Err(why), Err(because)) => return assert_eq!(why.status(), because.status()),
                    (state, itself) => panic!("{case:?}: {:?} {:?}", state.is_ok(), itself.err()),
                };
                let state = state.unwrap();
                assert_eq!(state.found.lifted, itself.lifted);
                let balance = alone.balance(case, &itself).unwrap();
                let weight = balance.whole.0 * GRAVITY;
                let size = |k: usize| match k {
                    0 | 1 => 1.0,
                    2..7 => car.per_metre(),
                    _ => weight,
                };
                for k in 0..14 {
                    let apart = (state.found.unknowns[k] - itself.unknowns[k]).abs() / size(k);
                    most = larger(most, apart);
                }
                for (own, wheel) in state.parts.iter().zip(&balance.wheels) {
                    let parts = own.iter().zip(&wheel.parts);
                    most = parts.fold(most, |most, (a, b)| larger(most, (a - b).abs() / weight));
                }
                if !state.is_from_lane {
                    lifted += usize::from(itself.lifted != [false; 4]);
                    return;
                }
                from_lanes += 1;
                // A state from lanes can also be solved with derivatives.
                assert!(solver.solved(case, &state.found).is_ok());
            });
        let all: usize = rows.iter().map(|row| row.len()).sum();
        assert_eq!(next.iter().sum::<usize>(), all);
        assert!(most < 1e-11, "{most:e}");
        println!("largest difference {most:e}, {from_lanes} of {all} from lanes, {lifted} lifted");
        if Width::Avx2.is_available() {
            assert!(
                2 * from_lanes > all && lifted > 5,
                "{from_lanes} {lifted} of {all}"
            );
        }
    }
}

/// Each block of rows has its own copy of the solver, so `gg.csv` has the same bytes for any number of CPU threads.
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

/// Prints the number of map states solved per second: alone, with the components of the loads, with all results, and
/// with member loads.
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

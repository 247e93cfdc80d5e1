//! Cost of tuning: one start under constraints, the return towards the nominal design, a Pareto front, and an evaluation of
//! builds.
//!
//! Run with `cargo bench --bench tuning`. The studies are those of `studies/`, with eight variables and two curves at 41
//! stations.

use divan::Bencher;
use hardpoint::optimise::{Control, Tuning, front, price_list, tune};
use hardpoint::study::{Optimise, Study};
use std::path::Path;

fn main() {
    divan::main();
}

const VARIABLES: &str = "optimise.variables=[\
    { hardpoint = \"strut_top\", axis = \"y\", range = [-20.0, 20.0] }, \
    { hardpoint = \"lower_ball_joint\", axis = \"y\", range = [-10.0, 10.0] }, \
    { hardpoint = \"lower_ball_joint\", axis = \"z\", range = [-20.0, 20.0] }, \
    { hardpoint = \"lower_arm_front\", axis = \"y\", range = [-15.0, 15.0] }, \
    { hardpoint = \"lower_arm_front\", axis = \"z\", range = [-20.0, 20.0] }, \
    { hardpoint = \"lower_arm_rear\", axis = \"z\", range = [-20.0, 20.0] }, \
    { hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }, \
    { hardpoint = \"tie_rod_outer\", axis = \"y\", range = [-15.0, 15.0] }]";
const TRAVEL: &str = "motion.travel={ from = -80.0, to = 80.0, steps = 41 }";
const CONSTRAINTS: &str = "optimise.constraints=[\
    { characteristic = \"toe\", between = [-0.6, 0.6] }, \
    { point = \"tie_rod_outer\", inside = { rim = 170.0, from = -150.0, to = 40.0 }, clearance = 20.0 }, \
    { length = \"tie_rod\", between = [359.0, 365.0] }]";
const EXCLUDING: &str = "optimise.constraints=[\
    { length = \"tie_rod\", between = [300.0, 310.0] }, \
    { characteristic = \"toe\", between = [-0.6, 0.6] }]";

fn strut(more: &[&str]) -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/macpherson_front.toml");
    let overrides = [TRAVEL, VARIABLES].iter().chain(more);
    let overrides: Vec<String> = overrides.map(|o| (*o).to_owned()).collect();
    Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

fn tuned(study: &Study) -> Tuning {
    study.tune(Control::default()).unwrap()
}

/// One start to the smallest misfit: without constraints, or with about 120 limits (the constraints at all stations).
#[divan::bench(args = [false, true])]
fn a_start(bencher: Bencher, constrained: bool) {
    let more = ["optimise.good_enough=0.0", CONSTRAINTS];
    let study = strut(&more[..1 + usize::from(constrained)]);
    bencher.bench_local(|| tuned(&study));
}

/// One start under constraints, followed by the return towards the nominal design.
#[divan::bench]
fn a_start_and_the_way_back(bencher: Bencher) {
    let study = strut(&[CONSTRAINTS]);
    bencher.bench_local(|| tuned(&study));
}

/// Constraints that cannot hold together: four starts, then the search for the smallest conflicting set.
#[divan::bench]
fn constraints_that_exclude_one_another(bencher: Bencher) {
    let study = strut(&[EXCLUDING]);
    bencher.bench_local(|| tuned(&study));
}

/// A Pareto front of 50 points between two targets that cannot both be met.
#[divan::bench]
fn a_front(bencher: Bencher) {
    let study = strut(&[
        CONSTRAINTS,
        "optimise.front=[\"camber\", \"kingpin_inclination\"]",
    ]);
    let optimise = contradicting(study.optimise.as_ref().unwrap());
    let (vehicle, control) = (&study.vehicle, Control::default());
    let tuning = tune(vehicle, &optimise, control).unwrap();
    let found = || front(vehicle, &optimise, &tuning, control).unwrap();
    println!("{} points", found().choices.len());
    bencher.bench_local(found);
}

/// Ten designs between the nominal design and the smallest misfit.
#[divan::bench]
fn a_price_list(bencher: Bencher) {
    let study = strut(&[CONSTRAINTS]);
    let optimise = study.optimise.as_ref().unwrap();
    let (vehicle, control) = (&study.vehicle, Control::default());
    let tuning = tuned(&study);
    bencher.bench_local(|| price_list(vehicle, optimise, &tuning, control).unwrap());
}

/// Targets that conflict, with fewer variables: camber must grow with travel, but the inclination must not follow.
fn contradicting(optimise: &Optimise) -> Optimise {
    let mut optimise = optimise.clone();
    for target in &mut optimise.targets {
        if let hardpoint::study::Wanted::Curve { points, .. } = &mut target.wanted {
            for [x, y] in points {
                *y = 1.05 * *y + 2e-4 * *x;
            }
        }
    }
    optimise.variables.truncate(3);
    optimise
}

/// Robust tunings of 64 builds at 41 stations, with one and with four iterations. The difference between the two times is the
/// cost of three iterations, derivatives included.
#[divan::bench(args = [0, 4])]
fn builds(bencher: Bencher, iterations: u64) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/double_wishbone_robust.toml");
    let travel = "motion.travel={ from = -30.0, to = 30.0, steps = 41 }";
    let most = format!("optimise.max_iterations={}", iterations.max(1));
    let overrides = [
        travel,
        "optimise.starts=1",
        "optimise.good_enough=0.0",
        &most,
    ];
    let study = Study::read(&path, &overrides.map(str::to_owned)).unwrap_or_else(|e| panic!("{e}"));
    bencher.bench_local(|| tuned(&study).starts.best_fit().map(|fit| fit.evaluations()));
}

//! Cost of the main tasks: poses, rates, sensitivities and a whole tuning.
//!
//! Run with `cargo bench`. Times vary with the load of the machine. Use the fastest time of each task, and compare times of the
//! same run only.

use divan::{Bencher, black_box, counter::ItemsCount};
use hardpoint::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::model::Drive;
use hardpoint::number::{Jet, Vector3};
use hardpoint::optimise::{Control, tune};
use hardpoint::solve::{Solver, StationOrder};
use hardpoint::study::Study;
use std::ops::ControlFlow;
use std::path::Path;

fn main() {
    divan::main();
}

fn front() -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/macpherson_front.toml");
    Study::read(&path, &[]).unwrap_or_else(|e| panic!("{e}"))
}

const STATIONS: usize = 41;

/// 41 poses of one design, including the preparation of the design.
#[divan::bench]
fn poses(bencher: Bencher) {
    let study = front();
    let suspension = study.wheel();
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design).unwrap();
    let station_order = StationOrder::through(&study.motion().values);
    bencher.counter(ItemsCount::new(STATIONS)).bench_local(|| {
        solver.prepare(black_box(&suspension.design)).unwrap();
        let mut sum = 0.0;
        solver
            .for_each_pose(Drive::Travel, &station_order, 0.0, |_, _, pose| {
                sum += pose.unwrap().origin.z;
                ControlFlow::Continue(())
            })
            .unwrap();
        sum
    });
}

/// Camber and kingpin inclination at 41 poses, with gradients with respect to every hardpoint coordinate (`N` = 1). `N` = 3 adds
/// the gradients of their first and second derivatives with respect to travel.
#[divan::bench(consts = [1, 3])]
fn gradients<const N: usize>(bencher: Bencher) {
    let study = front();
    let suspension = study.wheel();
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design).unwrap();
    let mut design_series = DesignSeries::<N>::new(&suspension.mechanism, &suspension.design);
    let station_order = StationOrder::through(&study.motion().values);
    let mut buffer = vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); suspension.design.len()];
    bencher.counter(ItemsCount::new(STATIONS)).bench_local(|| {
        solver.prepare(black_box(&suspension.design)).unwrap();
        design_series.prepare(&suspension.mechanism, &suspension.design);
        let mut sum = Vector3::default();
        solver
            .for_each_pose(
                Drive::Travel,
                &station_order,
                0.0,
                |solver, station, pose| {
                    let motion = MotionPoint {
                        drive: Drive::Travel,
                        value: station_order.values()[station],
                        rack: 0.0,
                    }
                    .along_drive();
                    let linearised = solver
                        .linearised(&design_series, pose.unwrap(), &motion)
                        .unwrap();
                    let view = WheelReading::of(&linearised.at, Constants::default());
                    for c in [Characteristic::Camber, Characteristic::KingpinInclination] {
                        let quantity = Quantity::Characteristic(c);
                        view.gradients(
                            &linearised,
                            quantity,
                            N - 1,
                            &mut buffer,
                            &mut |_, _, g| sum = sum + g,
                        );
                    }
                    ControlFlow::Continue(())
                },
            )
            .unwrap();
        sum
    });
}

/// The whole tuning of `studies/macpherson_front.toml`: six variables, 41 stations, two curves.
#[divan::bench]
fn tuning(bencher: Bencher) {
    let study = front();
    let optimise = study.optimise.clone().unwrap();
    bencher.bench_local(|| tune(&study.vehicle, black_box(&optimise), Control::default()).unwrap());
}

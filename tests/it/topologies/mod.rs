//! Tests of every topology against independent solutions and against its hardpoints.

mod bell_cranks;
mod double_wishbone;
mod five_link;
mod general_closure;
mod invariances;
mod loads;
mod rockers;
mod semi_trailing_arm;
mod truth;

use crate::support::order_to;
use hardpoint::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::mechanism::{DesignFault, Failure, Pose};
use hardpoint::model::{Drive, Mechanism, Suspension, Topology};
use hardpoint::number::{Jet, Vector3};
use hardpoint::solve::Solver;
use hardpoint::study::Study;
use std::ops::ControlFlow;
use std::path::Path;

/// Suspension of a topology's template, or of the sample study with this name.
fn template(name: &str) -> Suspension {
    let study = match Topology::named(name) {
        Some(topology) => Study::from_text(topology.name, topology.template, Path::new(".")),
        None => {
            let path = crate::support::studies().join(format!("{name}.toml"));
            Study::read(&path, &[])
        }
    };
    study.unwrap_or_else(|e| panic!("{e:?}")).into_wheel()
}

/// Solves one station and reads it.
fn at<R>(
    mechanism: &Mechanism,
    design: &[Vector3<f64>],
    point: MotionPoint<f64>,
    read: impl FnOnce(&Solver, &Pose<f64>) -> R,
) -> Result<Result<R, Failure>, DesignFault> {
    let mut solver = Solver::new(mechanism, design)?;
    let mut found = None;
    let mut read = Some(read);
    solver.for_each_pose(
        point.drive,
        &order_to(point.value),
        point.rack,
        |solver, _, pose| {
            found = Some(pose.map(|pose| (read.take().unwrap())(solver, pose)));
            ControlFlow::Continue(())
        },
    )?;
    Ok(found.unwrap())
}

fn travel(value: f64, rack: f64) -> MotionPoint<f64> {
    MotionPoint {
        drive: Drive::Travel,
        value,
        rack,
    }
}

/// Values of characteristics, each with its first derivative with respect to travel.
fn characteristics(
    suspension: &Suspension,
    design: &[Vector3<f64>],
    point: MotionPoint<f64>,
    wanted: &[Characteristic],
) -> Result<Vec<Jet<f64, 3>>, Failure> {
    let mechanism = &suspension.mechanism;
    let design_series = DesignSeries::<3>::new(mechanism, design);
    at(mechanism, design, point, |solver, pose| {
        let configuration = solver
            .configuration_series(&design_series, pose, &point.along_drive())
            .unwrap();
        let view = WheelReading::of(&configuration, Constants::of(suspension));
        let value = |c: &Characteristic| view.value(&configuration, Quantity::Characteristic(*c));
        wanted.iter().map(value).collect()
    })
    .unwrap()
}

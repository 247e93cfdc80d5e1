//! Runs a sweep whose rows go to a callback: finds the designs with the least bump steer among ten thousand, in constant memory.
//!
//! `cargo run --example sweep`

use hardpoint::{
    Axis, Characteristic, Motion, Order, Sampling, Study, SweepControl, Topology, Variable,
};
use std::ops::ControlFlow;

/// Number of designs that the program keeps.
const KEPT: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let template = Topology::named("double_wishbone").ok_or("no such topology")?;
    let study = Study::from_text("sweep", template.template, ".".as_ref())?;
    let suspension = study.into_wheel();
    let offset = |name, axis| Variable::offset(&suspension, name, axis, -10.0..=10.0);
    let variables = [
        offset("tie_rod_inner", Axis::Y)?,
        offset("tie_rod_inner", Axis::Z)?,
    ];
    let study = Study::of(suspension.clone())
        .over(Motion::travel(-40.0..=40.0, 17)?)
        .asking(&[Characteristic::Toe], Order::Position)?
        .sampling(Sampling::Sobol, 10_000, 1, &variables);
    // Range of toe over the travel, and number of the design.
    let mut best: Vec<(f64, usize)> = Vec::new();
    let mut first = 0;
    study.sweep(SweepControl::default(), |rows| {
        for design in 0..rows.designs() {
            let toe = rows.outputs(design);
            let range = toe[1] - toe[0];
            if range.is_finite() {
                best.push((range, first + design));
            }
        }
        first += rows.designs();
        best.sort_by(|a, b| a.0.total_cmp(&b.0));
        best.truncate(KEPT);
        ControlFlow::Continue(())
    })?;
    for (range, design) in best {
        println!("design {design}: toe changes by {range:.4} deg");
    }
    Ok(())
}

//! A block of designs in, their values out.
//!
//! This is the seam between a sweep and the solver: what is above it knows of samples, threads and
//! files, what is below it of poses. A design's values depend on that design alone, never on its
//! neighbours in the block, and nothing is allocated from block to block but for failures.

use super::Stations;
use crate::characteristics::{Constants, Quantity, View};
use crate::kinematics::{DesignFault, Failure, Lifted, MotionPoint, Pose, Solver};
use crate::model::Suspension;
use crate::number::Vector3;
use std::ops::ControlFlow;

/// The most designs in a block. Blocks are also the unit of sums, of shards and of resumption: designs
/// number `k * BLOCK` and on always go together, whatever the threads do.
pub const BLOCK: usize = 128;

/// A station of a design without a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FailedStation {
    /// Number of the design in the block.
    pub design: usize,
    /// Number of the station.
    pub station: usize,
    /// Why it has no pose.
    pub failure: Failure,
}

/// The values of up to [`BLOCK`] designs, in the kernel's frame, in radians and length units; NaN where
/// there is none.
#[derive(Clone, Debug)]
pub struct Block {
    outputs: usize,
    stations: usize,
    designs: usize,
    /// `[design][output][station]`
    values: Vec<f64>,
    /// `[design][output]`: derivatives by the drive in the design position.
    slopes: Vec<f64>,
    /// By rising number of the design.
    failures: Vec<FailedStation>,
    /// Designs that cannot be solved at all, by rising number.
    faults: Vec<(usize, DesignFault)>,
}

impl Block {
    /// Room for so many outputs at so many stations.
    pub fn new(outputs: usize, stations: usize) -> Self {
        Block {
            outputs,
            stations,
            designs: 0,
            values: vec![f64::NAN; BLOCK * outputs * stations],
            slopes: vec![f64::NAN; BLOCK * outputs],
            failures: Vec::new(),
            faults: Vec::new(),
        }
    }

    /// Makes ready for so many designs, without values so far.
    fn clear(&mut self, designs: usize) {
        assert!(designs <= BLOCK);
        self.designs = designs;
        self.values[..designs * self.outputs * self.stations].fill(f64::NAN);
        self.slopes[..designs * self.outputs].fill(f64::NAN);
        self.failures.clear();
        self.faults.clear();
    }

    /// Number of designs.
    pub fn designs(&self) -> usize {
        self.designs
    }

    /// The values of an output of a design, by station.
    #[inline]
    pub fn values(&self, design: usize, output: usize) -> &[f64] {
        let start = (design * self.outputs + output) * self.stations;
        &self.values[start..start + self.stations]
    }

    /// The derivative by the drive in the design position.
    #[inline]
    pub fn slope(&self, design: usize, output: usize) -> f64 {
        self.slopes[design * self.outputs + output]
    }

    /// The stations without a pose, by rising number of the design.
    pub fn failures(&self) -> &[FailedStation] {
        &self.failures
    }

    /// The designs that cannot be solved at all, by rising number.
    pub fn faults(&self) -> &[(usize, DesignFault)] {
        &self.faults
    }
}

/// Evaluates blocks of designs. One for each thread.
pub struct Evaluator<'a>(ByDepth<'a>);

/// The pose's derivatives that values take, and one more for the slope in the design position.
enum ByDepth<'a> {
    Positions(Scalar<'a, 1, 2>),
    Rates(Scalar<'a, 2, 3>),
}

impl<'a> Evaluator<'a> {
    /// An evaluator of these quantities. An error says why the suspension's own design cannot be solved.
    pub fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
    ) -> Result<Self, DesignFault> {
        let depth = quantities.iter().map(|q| q.depth()).max().unwrap_or(0);
        Ok(Evaluator(match depth {
            0 => ByDepth::Positions(Scalar::new(suspension, stations, quantities)?),
            _ => ByDepth::Rates(Scalar::new(suspension, stations, quantities)?),
        }))
    }

    /// Evaluates designs given as the points of one after the other, in the kernel's frame.
    pub fn evaluate(&mut self, designs: &[Vector3<f64>], block: &mut Block) {
        match &mut self.0 {
            ByDepth::Positions(scalar) => scalar.evaluate(designs, block),
            ByDepth::Rates(scalar) => scalar.evaluate(designs, block),
        }
    }
}

/// One design at a time. `N` coefficients of a pose's series at every station, `M` in the design
/// position.
struct Scalar<'a, const N: usize, const M: usize> {
    stations: &'a Stations,
    quantities: &'a [Quantity],
    constants: Constants,
    solver: Solver<'a>,
    lifted: Lifted<N>,
    with_slope: Lifted<M>,
}

impl<'a, const N: usize, const M: usize> Scalar<'a, N, M> {
    fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
    ) -> Result<Self, DesignFault> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let steering_axis = quantities.iter().any(|q| q.reads_steering_axis());
        Ok(Scalar {
            stations,
            quantities,
            constants: Constants::of(suspension),
            solver: Solver::new(mechanism, design)?,
            lifted: Lifted::new(mechanism, design).with_steering_axis(steering_axis),
            with_slope: Lifted::new(mechanism, design).with_steering_axis(steering_axis),
        })
    }

    fn evaluate(&mut self, designs: &[Vector3<f64>], block: &mut Block) {
        let points = self.solver.design().len();
        block.clear(designs.len() / points);
        for (number, design) in designs.chunks_exact(points).enumerate() {
            if let Err(fault) = self.evaluate_design(number, design, block) {
                // What was found before the fault showed is not to be used.
                let (outputs, stations) = (block.outputs, block.stations);
                let size = outputs * stations;
                block.values[number * size..(number + 1) * size].fill(f64::NAN);
                block.slopes[number * outputs..(number + 1) * outputs].fill(f64::NAN);
                block.failures.retain(|f| f.design != number);
                block.faults.push((number, fault));
            }
        }
    }

    fn evaluate_design(
        &mut self,
        number: usize,
        design: &[Vector3<f64>],
        block: &mut Block,
    ) -> Result<(), DesignFault> {
        let Scalar {
            stations,
            quantities,
            constants,
            solver,
            lifted,
            with_slope,
        } = self;
        solver.prepare(design)?;
        lifted.prepare(solver.mechanism(), design);
        with_slope.prepare(solver.mechanism(), design);
        let (count, drive) = (stations.count(), stations.drive);
        let first = number * quantities.len();
        for (r, rack) in stations.racks.iter().enumerate() {
            let rack = *rack;
            solver.march(drive, &stations.march, rack, |solver, v, pose| {
                let station = stations.number(r, v);
                let motion = MotionPoint {
                    drive,
                    value: stations.values()[v],
                    rack,
                };
                let read = |pose: &Pose<f64>| {
                    let at = solver.posture_series(lifted, pose, &motion.along_drive())?;
                    let view = View::of(&at, *constants);
                    for (k, quantity) in quantities.iter().enumerate() {
                        let value = view.value(&at, *quantity)[0];
                        block.values[(first + k) * count + station] = finite(value);
                    }
                    if station == stations.design() {
                        let at = solver.posture_series(with_slope, pose, &motion.along_drive())?;
                        let view = View::of(&at, *constants);
                        for (k, quantity) in quantities.iter().enumerate() {
                            let slope = view.value(&at, *quantity).derivative(1);
                            block.slopes[first + k] = finite(slope);
                        }
                    }
                    Ok(())
                };
                if let Err(failure) = pose.and_then(read) {
                    block.failures.push(FailedStation {
                        design: number,
                        station,
                        failure,
                    });
                }
                ControlFlow::Continue(())
            })?;
        }
        Ok(())
    }
}

/// A value, or NaN for one that has none (a swing arm of a wheel that does not turn).
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::characteristics::Characteristic;
    use crate::curves::curves;
    use crate::plan::Plan;
    use crate::study::Study;
    use std::path::Path;

    const QUANTITIES: [Quantity; 3] = [
        Quantity::Characteristic(Characteristic::Camber),
        Quantity::Characteristic(Characteristic::Toe),
        Quantity::Characteristic(Characteristic::BumpSteer),
    ];

    fn study() -> Study {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/macpherson_bump_steer.toml");
        Study::read(
            &path,
            &["motion.travel=[-400.0, -60.0, 0.0, 60.0]".to_owned()],
        )
        .unwrap()
    }

    /// The values are those of `hardpoint solve`, to the bit, and a design's do not depend on its
    /// neighbours, nor on what the evaluator did before.
    #[test]
    fn values_are_those_of_the_curves_whatever_the_neighbours() {
        let study = study();
        let suspension = &study.suspension;
        let stations = Stations::of(&study.motion, &suspension.frame, &[]);
        let mut evaluator = Evaluator::new(suspension, &stations, &QUANTITIES).unwrap();
        let mut block = Block::new(QUANTITIES.len(), stations.count());
        let mut flat = suspension.design.clone();
        // No arm at all: the outer joint is put on the axis of the inner ones.
        let mechanism = &suspension.mechanism;
        let [front, outer] =
            ["lower_arm_front", "lower_ball_joint"].map(|name| mechanism.point(name).unwrap().0);
        flat[outer] = flat[front];
        let designs = [flat.clone(), suspension.design.clone(), flat].concat();
        evaluator.evaluate(&designs, &mut block);
        assert_eq!(block.designs(), 3);
        assert_eq!(
            block.faults().iter().map(|f| f.0).collect::<Vec<_>>(),
            [0, 2]
        );
        assert!(block.values(0, 0).iter().all(|v| v.is_nan()));

        let curves = curves(suspension, &Plan::of(&study)).unwrap();
        let camber = Quantity::Characteristic(Characteristic::Camber);
        let factor = 180.0 / std::f64::consts::PI;
        assert_eq!(QUANTITIES[0], camber);
        for (station, solved) in curves.stations.iter().enumerate() {
            let value = block.values(1, 0)[station];
            assert_eq!(
                solved.values[2],
                (!value.is_nan()).then_some(value * factor)
            );
        }
        let failed: Vec<_> = block
            .failures()
            .iter()
            .map(|f| (f.design, f.station))
            .collect();
        assert_eq!(failed, [(1, 0)]);
        // The slope of toe is the bump steer.
        let bump_steer = block.values(1, 2)[stations.design()];
        assert!((block.slope(1, 1) - bump_steer).abs() < 1e-15);
        assert!(block.slope(1, 0) != 0.0);

        let before = block.clone();
        evaluator.evaluate(&designs[suspension.design.len()..], &mut block);
        assert_eq!(block.values(0, 1)[1..], before.values(1, 1)[1..]);
        assert_eq!(block.slope(0, 2), before.slope(1, 2));
    }
}

//! The targets of a study as a least-squares problem over its variables.
//!
//! A residual is the deviation of a characteristic from its target at one station, in tolerances,
//! times a share s of the weight such that the misfit (the root mean square of all residuals) is
//!
//! ```text
//! misfit^2 = sum_targets weight rms^2 / sum_targets weight,   rms over the target's own stations
//! ```
//!
//! however many stations each target has. Residuals and Jacobian come from one march: the pose, one
//! factorisation, and one adjoint for each target.

use super::{Evaluation, Infeasible, LeastSquares};
use crate::characteristics::{Characteristic, Constants, Quantity, Slots, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::{DesignFault, Failure, Toggles};
use crate::model::{Axis, Drive, Frame, PointId, Suspension};
use crate::number::{Jet, Vector3};
use crate::solve::{Solver, StationOrder};
use crate::study::{Motion, Optimise, Variable};
use nalgebra::DVector;
use std::ops::ControlFlow;

/// What is wanted at one station.
#[derive(Clone, Debug)]
struct TargetSample {
    row: usize,
    target: usize,
    station: usize,
    characteristic: Characteristic,
    value: f64,
    /// Residual per deviation.
    scale: f64,
}

/// The targets laid out over the stations: which row of the problem wants what, where.
#[derive(Clone, Debug)]
pub struct TargetLayout {
    drive: Drive,
    rack: f64,
    station_order: StationOrder,
    by_station: Vec<Vec<TargetSample>>,
    rows: usize,
    /// Residual per deviation in tolerances, by target.
    shares: Vec<f64>,
    rate_order: usize,
    /// What of wheel and steering axis the targets are made of.
    reads: Slots,
}

impl TargetLayout {
    /// Lays out the targets. Curves are compared at the stations of the motion between their ends;
    /// single values at their own. The rack is where the study puts it, or straight ahead where the
    /// study moves it.
    pub fn of(optimise: &Optimise, motion: &Motion, frame: &Frame) -> Self {
        let mut values = motion.values.clone();
        let mut wanted: Vec<(usize, usize, f64)> = Vec::new();
        for (number, target) in optimise.targets.iter().enumerate() {
            for (drive, value) in target.wanted.at_stations(&motion.values) {
                let station = values.iter().position(|v| *v == drive).unwrap_or_else(|| {
                    values.push(drive);
                    values.len() - 1
                });
                wanted.push((number, station, value));
            }
        }
        let rows = wanted.len();
        let total: f64 = optimise.targets.iter().map(|t| t.weight).sum();
        let shares: Vec<f64> = optimise
            .targets
            .iter()
            .enumerate()
            .map(|(number, target)| {
                let own = wanted.iter().filter(|w| w.0 == number).count();
                (target.weight / total * rows as f64 / own as f64).sqrt()
            })
            .collect();
        let mut by_station = vec![Vec::new(); values.len()];
        for (row, (target, station, value)) in wanted.into_iter().enumerate() {
            by_station[station].push(TargetSample {
                row,
                target,
                station,
                characteristic: optimise.targets[target].characteristic,
                value,
                scale: shares[target] / optimise.targets[target].tolerance,
            });
        }
        // Stations nobody wants anything of are not visited.
        let used: Vec<usize> = (0..values.len())
            .filter(|s| !by_station[*s].is_empty())
            .collect();
        let values: Vec<f64> = used.iter().map(|s| values[*s]).collect();
        let by_station: Vec<Vec<TargetSample>> = used
            .iter()
            .enumerate()
            .map(|(station, old)| {
                let layout = by_station[*old].iter().cloned();
                layout.map(|w| TargetSample { station, ..w }).collect()
            })
            .collect();
        TargetLayout {
            drive: motion.drive.in_kernel(),
            rack: frame.sign(Axis::Y)
                * if motion.rack_moves {
                    0.0
                } else {
                    motion.rack[0]
                },
            station_order: StationOrder::through(&values),
            rate_order: optimise
                .targets
                .iter()
                .map(|t| Quantity::Characteristic(t.characteristic).rate_order())
                .max()
                .unwrap_or(0),
            reads: optimise.targets.iter().fold(Slots::default(), |slots, t| {
                slots.with(t.characteristic.info().reads)
            }),
            by_station,
            rows,
            shares,
        }
    }

    /// Derivatives by the drive that some target takes.
    pub fn rate_order(&self) -> usize {
        self.rate_order
    }

    /// The deviations of each target in tolerances, from the residuals.
    pub fn deviations(&self, residuals: &DVector<f64>) -> Vec<Deviation> {
        self.shares
            .iter()
            .enumerate()
            .map(|(target, share)| {
                let (mut sum, mut count, mut worst, mut worst_at) = (0.0, 0, 0.0_f64, 0.0);
                for wish in self
                    .by_station
                    .iter()
                    .flatten()
                    .filter(|w| w.target == target)
                {
                    let deviation = residuals[wish.row] / share;
                    sum += deviation * deviation;
                    count += 1;
                    if deviation.abs() >= worst.abs() {
                        worst = deviation;
                        worst_at = self.station_order.values()[wish.station];
                    }
                }
                Deviation {
                    rms: (sum / count as f64).sqrt(),
                    worst,
                    worst_at,
                }
            })
            .collect()
    }
}

/// How far a target is missed, in its tolerances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Root mean square over the target's stations.
    pub rms: f64,
    /// The largest deviation, with its sign.
    pub worst: f64,
    /// The drive value where it is.
    pub worst_at: f64,
}

/// The problem, with its workspace. `N` is one more than [`TargetLayout::rate_order`].
pub struct Objective<'a, const N: usize> {
    frame: Frame,
    variables: &'a [Variable],
    layout: &'a TargetLayout,
    constants: Constants,
    design: &'a [Vector3<f64>],
    moved: Vec<Vector3<f64>>,
    solver: Solver<'a>,
    design_series: DesignSeries<N>,
    toggles: Toggles,
    buffer: Vec<Vector3<Jet<f64, N>>>,
}

impl<'a, const N: usize> Objective<'a, N> {
    /// The problem of a suspension.
    pub fn new(
        suspension: &'a Suspension,
        variables: &'a [Variable],
        layout: &'a TargetLayout,
    ) -> Result<Self, DesignFault> {
        let design = &suspension.design;
        let moves = variables.iter().flat_map(|v| &v.moves);
        let points: Vec<PointId> = moves.map(|m| m.point).collect();
        let mechanism = &suspension.mechanism;
        let wanted = layout.by_station.iter().flatten();
        let rockers =
            wanted.flat_map(|w| Quantity::Characteristic(w.characteristic).rockers(mechanism));
        Ok(Objective {
            frame: suspension.frame,
            variables,
            layout,
            constants: Constants::of(suspension),
            design,
            moved: design.clone(),
            solver: Solver::new(&suspension.mechanism, design)?,
            design_series: DesignSeries::new(&suspension.mechanism, design)
                .with_steering_axis(layout.reads.contain_steering_axis())
                .with_sensitivities_to(&suspension.mechanism, &points),
            toggles: Toggles::of(mechanism, rockers),
            buffer: vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); design.len()],
        })
    }
}

/// The design with its variables moved by `x`.
pub fn moved_design(
    design: &[Vector3<f64>],
    frame: &Frame,
    variables: &[Variable],
    x: &DVector<f64>,
    moved: &mut [Vector3<f64>],
) {
    moved.copy_from_slice(design);
    for (variable, offset) in variables.iter().zip(x) {
        for m in &variable.moves {
            let point = &mut moved[m.point.0];
            let coordinate = match m.axis {
                Axis::X => &mut point.x,
                Axis::Y => &mut point.y,
                Axis::Z => &mut point.z,
            };
            *coordinate += frame.sign(m.axis) * m.factor * offset;
        }
    }
}

impl<const N: usize> LeastSquares for Objective<'_, N> {
    fn variables(&self) -> usize {
        self.variables.len()
    }

    fn residuals(&self) -> usize {
        self.layout.rows
    }

    fn evaluate(&mut self, x: &DVector<f64>, into: &mut Evaluation) -> Result<(), Infeasible> {
        let Objective {
            frame,
            variables,
            layout,
            constants,
            design,
            moved,
            solver,
            design_series,
            toggles,
            buffer,
        } = self;
        moved_design(design, frame, variables, x, moved);
        let mechanism = solver.mechanism();
        let refused = |fault: DesignFault| Infeasible::Refused(fault.describe(mechanism));
        solver.prepare(moved).map_err(refused)?;
        design_series.prepare(mechanism, moved);
        let begun = toggles.begin(solver, layout.drive, layout.rack);
        begun.map_err(refused)?;
        let mut failed: Option<(f64, Failure)> = None;
        let visited = solver.for_each_pose(
            layout.drive,
            &layout.station_order,
            layout.rack,
            |solver, station, pose| {
                let value = layout.station_order.values()[station];
                let motion = MotionPoint {
                    drive: layout.drive,
                    value,
                    rack: layout.rack,
                }
                .along_drive::<N>();
                let linearised = pose
                    .and_then(|pose| solver.linearised(design_series, pose, &motion))
                    .and_then(|linearised| match toggles.note(&linearised.at, value) {
                        None => Ok(linearised),
                        Some(rod) => Err(Failure::Toggle(rod)),
                    });
                let linearised = match linearised {
                    Ok(linearised) => linearised,
                    Err(failure) => {
                        failed = Some((value, failure));
                        return ControlFlow::Break(());
                    }
                };
                let view = WheelReading::reading(&linearised.at, *constants, layout.reads);
                for wish in &layout.by_station[station] {
                    let quantity = Quantity::Characteristic(wish.characteristic);
                    let found = view.value(&linearised.at, quantity)[0];
                    into.residuals[wish.row] = (found - wish.value) * wish.scale;
                    into.jacobian.row_mut(wish.row).fill(0.0);
                    view.gradients(
                        &linearised,
                        quantity,
                        0,
                        buffer,
                        |_, PointId(p), gradient| {
                            for (column, variable) in variables.iter().enumerate() {
                                for m in variable.moves.iter().filter(|m| m.point.0 == p) {
                                    let by_axis = gradient.to_array()[m.axis as usize];
                                    into.jacobian[(wish.row, column)] +=
                                        by_axis * frame.sign(m.axis) * m.factor * wish.scale;
                                }
                            }
                        },
                    );
                }
                ControlFlow::Continue(())
            },
        );
        visited.map_err(refused)?;
        match failed {
            None => Ok(()),
            Some((value, failure)) => Err(Infeasible::Refused(match layout.drive {
                Drive::Travel => format!("travel {value} is not reached: {failure}"),
                Drive::ArmAngle => {
                    format!(
                        "arm angle {} deg is not reached: {failure}",
                        value.to_degrees()
                    )
                }
            })),
        }
    }
}

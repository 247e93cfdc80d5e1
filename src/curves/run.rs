//! Running a plan: march, read, differentiate.

use super::{Column, Curves, Sensitivity, Station, Status};
use crate::characteristics::View;
use crate::kinematics::{DesignFault, Failure, Lifted, MotionPoint, Pose, Solver};
use crate::model::{Axis, Drive, Suspension};
use crate::number::{Jet, Vector3};
use crate::plan::Plan;
use std::ops::ControlFlow;

/// The curves of a suspension under a plan.
pub fn curves(suspension: &Suspension, plan: &Plan) -> Result<Curves, DesignFault> {
    match plan.coefficients {
        1 => Run::<1>::new(suspension, plan).run(),
        2 => Run::<2>::new(suspension, plan).run(),
        3 => Run::<3>::new(suspension, plan).run(),
        _ => Run::<4>::new(suspension, plan).run(),
    }
}

/// A run with `N` coefficients for every power series.
struct Run<'a, const N: usize> {
    suspension: &'a Suspension,
    plan: &'a Plan,
    columns: Vec<Column>,
    lifted: Lifted<N>,
    /// Gradients of one output.
    buffer: Vec<Vector3<Jet<f64, N>>>,
}

/// What is found at one station.
type Findings = (Vec<Option<f64>>, Vec<Sensitivity>);

impl<'a, const N: usize> Run<'a, N> {
    fn new(suspension: &'a Suspension, plan: &'a Plan) -> Self {
        let zero = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
        Run {
            suspension,
            plan,
            columns: Column::all(plan, suspension.length_unit),
            lifted: Lifted::new(&suspension.mechanism, &suspension.design)
                .with_steering_axis(plan.reads_steering_axis()),
            buffer: vec![zero; suspension.design.len()],
        }
    }

    fn run(mut self) -> Result<Curves, DesignFault> {
        let plan = self.plan;
        let mut solver = Solver::new(&self.suspension.mechanism, &self.suspension.design)?;
        let per_rack = plan.march.values().len();
        let mut stations: Vec<Option<Station>> = vec![None; plan.stations()];
        let mut sensitivities = Vec::new();
        for (i, rack) in plan.racks.iter().enumerate() {
            solver.march(
                plan.drive,
                &plan.march,
                rack * plan.rack_sign,
                |solver, number, pose| {
                    let index = i * per_rack + number;
                    let mut station = self.blank(number, *rack);
                    let found =
                        pose.and_then(|pose| self.read(solver, pose, number, *rack, &mut station));
                    match found {
                        Ok((values, gradients)) => {
                            station.values = values;
                            sensitivities.extend(gradients.into_iter().map(|g| Sensitivity {
                                station: index,
                                ..g
                            }));
                        }
                        Err(failure) => station.status = Status::Failed(failure),
                    }
                    stations[index] = Some(station);
                    ControlFlow::Continue(())
                },
            )?;
        }
        // The march goes outward; results are in the order of the motion.
        sensitivities.sort_by_key(|s| s.station);
        Ok(Curves {
            columns: self.columns,
            stations: stations
                .into_iter()
                .map(|s| s.expect("the march visits every station"))
                .collect(),
            sensitivities,
        })
    }

    /// A station of which only the motion is known.
    fn blank(&self, number: usize, rack: f64) -> Station {
        let value = self.plan.march.values()[number];
        Station {
            travel: (self.plan.drive == Drive::Travel).then_some(value),
            arm_angle: (self.plan.drive == Drive::ArmAngle).then(|| value.to_degrees()),
            rack,
            time: self.plan.time.as_ref().map(|law| law.times[number]),
            status: Status::Ok,
            values: vec![None; self.columns.len()],
        }
    }

    /// Reads everything asked for off a pose.
    fn read(
        &mut self,
        solver: &Solver,
        pose: &Pose<f64>,
        number: usize,
        rack: f64,
        station: &mut Station,
    ) -> Result<Findings, Failure> {
        let plan = self.plan;
        let point = MotionPoint {
            drive: plan.drive,
            value: plan.march.values()[number],
            rack: rack * plan.rack_sign,
        };
        let motion = point.along_drive::<N>();
        let in_time = ByTime::at(plan, number);
        let mut gradients = Vec::new();
        let linearised;
        let posture;
        let at = if plan.sensitivities.is_empty() {
            posture = solver.posture_series(&self.lifted, pose, &motion)?;
            &posture
        } else {
            linearised = solver.linearised(&self.lifted, pose, &motion)?;
            let view = View::of(&linearised.at, plan.constants);
            for (of, output) in plan.outputs.iter().enumerate() {
                // By order, point and axis, before the change to derivatives by time.
                let mut found: Vec<[Vector3<f64>; 3]> =
                    vec![[Vector3::default(); 3]; self.buffer.len()];
                view.gradients(
                    &linearised,
                    output.quantity,
                    output.highest,
                    &mut self.buffer,
                    |order, id, gradient| found[id.0][order] = gradient,
                );
                for (index, column) in self.columns.iter().enumerate().filter(|(_, c)| c.of == of) {
                    for id in &plan.sensitivities {
                        for axis in Axis::ALL {
                            let orders = found[id.0].map(|g| g.to_array()[axis as usize]);
                            let value =
                                in_time.apply(output.quantity.is_rate(), orders, column.order);
                            gradients.push(Sensitivity {
                                station: 0,
                                column: index,
                                point: *id,
                                axis,
                                value: value * column.factor * self.suspension.frame.sign(axis),
                            });
                        }
                    }
                }
            }
            &linearised.at
        };
        if plan.drive == Drive::ArmAngle {
            let centre = solver.mechanism().wheel_centre;
            station.travel = Some((at.point(centre).z - at.designed(centre).z)[0]);
        }
        let view = View::of(at, plan.constants);
        let values = self.columns.iter().map(|column| {
            let output = &plan.outputs[column.of];
            let series = view.value(at, output.quantity);
            let mut orders = [0.0; 3];
            for (order, value) in orders.iter_mut().enumerate().take(output.highest + 1) {
                *value = series.derivative(order);
            }
            let value = in_time.apply(output.quantity.is_rate(), orders, column.order);
            let printed = value * column.factor;
            printed.is_finite().then_some(printed)
        });
        Ok((values.collect(), gradients))
    }
}

/// First and second derivative of the drive by time, where results are by time.
struct ByTime(Option<[f64; 2]>);

impl ByTime {
    fn at(plan: &Plan, number: usize) -> Self {
        ByTime(plan.time.as_ref().map(|law| {
            let series = law
                .polynomial
                .iter()
                .rev()
                .fold(Jet::<f64, 3>::constant(0.0), |sum, c| {
                    sum * Jet::variable(law.times[number]) + Jet::constant(*c)
                });
            [series.derivative(1), series.derivative(2)]
        }))
    }

    /// The derivative of this order by the drive, or by time: with y', y'' by the drive q(t),
    /// dy/dt = y' q' and d2y/dt2 = y'' q'^2 + y' q''. A quantity that is a rate itself (an angular
    /// velocity) is by the drive too: w q' and w' q'^2 + w q''.
    fn apply(&self, is_rate: bool, by_drive: [f64; 3], order: usize) -> f64 {
        let Some([velocity, acceleration]) = self.0 else {
            return by_drive[order];
        };
        let [y, first, second] = match is_rate {
            true => [f64::NAN, by_drive[0], by_drive[1]],
            false => by_drive,
        };
        match order + is_rate as usize {
            0 => y,
            1 => first * velocity,
            _ => second * velocity * velocity + first * acceleration,
        }
    }
}

//! Derivatives of characteristics with respect to hardpoint coordinates: analytic derivatives against difference
//! quotients, and forward against adjoint differentiation.

use super::subject::{Measured, Subject};
use super::{Clock, Family, Measurement, Unmeasurable, worse};
use crate::DoubleDouble;
use crate::trial::Forward;
use hardpoint_engine::characteristics::{Characteristic, Inputs, Quantity, Slots, WheelReading};
use hardpoint_engine::derive::{DesignSeries, MotionPoint};
use hardpoint_engine::mechanism::{Configuration, Pose};
use hardpoint_engine::model::{Drive, PointId};
use hardpoint_engine::number::{Dual, Jet, Scalar, Vector3};
use hardpoint_engine::solve::{Solver, StationOrder};

/// Gradients ordered by station, then output, then point.
struct Gradients {
    outputs: usize,
    points: usize,
    values: Vec<Vector3<f64>>,
}

impl Gradients {
    fn new(stations: usize, outputs: usize, points: usize) -> Self {
        Gradients {
            outputs,
            points,
            values: vec![Vector3::default(); stations * outputs * points],
        }
    }

    #[inline]
    fn put(&mut self, station: usize, output: usize, point: usize, gradient: Vector3<f64>) {
        self.values[(station * self.outputs + output) * self.points + point] = gradient;
    }

    /// Largest error of a gradient, relative to the largest gradient of the same output. NaN if a gradient is NaN.
    fn error(&self, exact: &Gradients) -> f64 {
        let mut largest = vec![0.0_f64; self.outputs];
        let mut errors = vec![0.0_f64; self.outputs];
        for (i, (found, exact)) in self.values.iter().zip(&exact.values).enumerate() {
            let output = i / self.points % self.outputs;
            largest[output] = largest[output].max(exact.norm());
            errors[output] = worse(errors[output], (*found - *exact).norm());
        }
        // An output that depends on no point has gradients of 0. If they are found exactly, its error is 0.
        let relative = |(error, largest): (&f64, &f64)| match *error {
            0.0 => 0.0,
            _ => error / largest,
        };
        errors.iter().zip(&largest).map(relative).fold(0.0, worse)
    }
}

/// Outputs, and the points whose coordinates are the variables of the derivatives.
struct Task<'t> {
    subject: &'t Subject<'t>,
    outputs: Vec<Characteristic>,
    points: Vec<PointId>,
    reads: Slots,
}

impl<'t> Task<'t> {
    fn new(subject: &'t Subject<'t>, outputs: &[Characteristic], points: &[PointId]) -> Self {
        Task {
            subject,
            outputs: outputs.to_vec(),
            points: points.to_vec(),
            reads: Slots::of(outputs.iter().map(|c| c.info().reads)),
        }
    }

    fn name(&self) -> String {
        let (outputs, coordinates) = (self.outputs.len(), 3 * self.points.len());
        format!("{outputs} outputs by {coordinates} coordinates")
    }

    fn room(&self) -> Gradients {
        let stations = self.subject.travels.len();
        Gradients::new(stations, self.outputs.len(), self.points.len())
    }

    /// Differentiates forward at solved poses, one hardpoint after another.
    #[inline]
    fn forward<T: Measured>(
        &self,
        forward: &Forward<'_, T>,
        poses: &[Pose<T>],
        gradients: &mut Gradients,
    ) {
        let constants = self.subject.constants();
        for (station, (pose, travel)) in poses.iter().zip(&self.subject.travels).enumerate() {
            let mut point = 0;
            forward.each(
                pose,
                T::of(*travel),
                |_, at: &Configuration<'_, Dual<T, 3>>| {
                    let inputs = Inputs::without_rates(at, constants, self.reads);
                    for (output, c) in self.outputs.iter().enumerate() {
                        let by = c.evaluate(&inputs).partials;
                        let gradient = Vector3::from(by).map(|v: T| v.value());
                        gradients.put(station, output, point, gradient);
                    }
                    point += 1;
                },
            );
        }
    }

    /// Differentiates backward (adjoint) at solved poses, one output after another.
    #[inline]
    fn adjoint(
        &self,
        adjoint: &mut Adjoint,
        solver: &Solver<'_>,
        (station, pose): (usize, &Pose<f64>),
        gradients: &mut Gradients,
    ) {
        let motion = MotionPoint {
            drive: Drive::Travel,
            value: self.subject.travels[station],
            rack: self.subject.rack,
        };
        let Ok(linearised) = solver.linearised(&adjoint.design_series, pose, &motion.along_drive())
        else {
            return;
        };
        let view = WheelReading::reading(&linearised.at, self.subject.constants(), self.reads);
        for (output, c) in self.outputs.iter().enumerate() {
            let quantity = Quantity::Characteristic(*c);
            let buffer = &mut adjoint.buffer;
            view.gradients(&linearised, quantity, 0, buffer, &mut |_, id, gradient| {
                if let Some(point) = adjoint.place[id.0] {
                    gradients.put(station, output, point, gradient);
                }
            });
        }
    }

    fn adjoint_room(&self) -> Adjoint {
        let suspension = self.subject.suspension;
        let count = suspension.design.len();
        let place = |i: usize| self.points.iter().position(|p| p.0 == i);
        Adjoint {
            design_series: DesignSeries::new(&suspension.mechanism, &suspension.design)
                .with_steering_axis(false)
                .with_sensitivities_to(&suspension.mechanism, &self.points),
            buffer: vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); count],
            place: (0..count).map(place).collect(),
        }
    }

    /// Exact gradients: forward differentiation in double-double arithmetic.
    fn exact(&self) -> Gradients {
        let mut exact = self.room();
        let mechanism = &self.subject.suspension.mechanism;
        let rack = DoubleDouble::of(self.subject.rack);
        let forward = Forward::new(mechanism, &self.subject.design(), rack, &self.points);
        self.forward(&forward, &self.subject.poses, &mut exact);
        exact
    }

    /// Solves the poses of a design again, and writes the outputs at every station to `values`.
    fn values(&self, solver: &mut Solver<'_>, station_order: &StationOrder, values: &mut [f64]) {
        let subject = self.subject;
        let constants = subject.constants();
        let visited = subject.for_each_pose(solver, station_order, |solver, station, pose| {
            let at = &mut values[station * self.outputs.len()..][..self.outputs.len()];
            match pose {
                Err(_) => at.fill(f64::NAN),
                Ok(pose) => {
                    let configuration = subject.configuration(solver.design(), *pose);
                    let inputs = Inputs::without_rates(&configuration, constants, self.reads);
                    for (value, c) in at.iter_mut().zip(&self.outputs) {
                        *value = c.evaluate(&inputs);
                    }
                }
            }
        });
        if visited.is_err() {
            values.fill(f64::NAN);
        }
    }
}

/// The workspace of adjoint sensitivities.
struct Adjoint {
    design_series: DesignSeries<1>,
    buffer: Vec<Vector3<Jet<f64, 1>>>,
    /// Index of each point among the requested points. `None` if the point is not requested.
    place: Vec<Option<usize>>,
}

/// A difference quotient with the step h: the sum of weight times f(x + offset h), divided by h. `terms` holds the pairs (offset,
/// weight).
struct Quotient {
    name: &'static str,
    terms: &'static [(f64, f64)],
}

const QUOTIENTS: [Quotient; 4] = [
    Quotient {
        name: "forward difference",
        terms: &[(0.0, -1.0), (1.0, 1.0)],
    },
    Quotient {
        name: CENTRAL,
        terms: &[(-1.0, -0.5), (1.0, 0.5)],
    },
    Quotient {
        name: "fourth-order difference",
        terms: &[
            (-2.0, 1.0 / 12.0),
            (-1.0, -8.0 / 12.0),
            (1.0, 8.0 / 12.0),
            (2.0, -1.0 / 12.0),
        ],
    },
    Quotient {
        name: "sixth-order difference",
        terms: &[
            (-3.0, -1.0 / 60.0),
            (-2.0, 9.0 / 60.0),
            (-1.0, -45.0 / 60.0),
            (1.0, 45.0 / 60.0),
            (2.0, -9.0 / 60.0),
            (3.0, 1.0 / 60.0),
        ],
    },
];

/// Name of the most common difference quotient.
const CENTRAL: &str = "central difference";

/// Step size of a coordinate in a difference quotient.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    /// The step is this fraction of the mechanism's size.
    OfSize(f64),
    /// Usual step of libraries for central differences: the cube root of the rounding unit, times the coordinate or times one,
    /// whichever is larger.
    Usual,
}

impl Step {
    fn length(self, coordinate: f64, size: f64) -> f64 {
        match self {
            Step::OfSize(part) => part * size,
            Step::Usual => f64::EPSILON.cbrt() * coordinate.abs().max(1.0),
        }
    }

    fn name(self) -> String {
        match self {
            Step::OfSize(part) => format!("step {part:.0e}"),
            Step::Usual => "usual step".to_owned(),
        }
    }
}

/// Component along `axis` of the gradient with index `at`.
fn component(gradients: &mut Gradients, at: usize, axis: usize) -> &mut f64 {
    let gradient = &mut gradients.values[at];
    match axis {
        0 => &mut gradient.x,
        1 => &mut gradient.y,
        _ => &mut gradient.z,
    }
}

/// Steps of difference quotients, as fractions of the mechanism's size.
const STEPS: [f64; 17] = [
    1e-10, 3e-10, 1e-9, 3e-9, 1e-8, 3e-8, 1e-7, 3e-7, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3,
    3e-3, 1e-2,
];

/// Measures analytic derivatives, difference quotients, and forward and adjoint differentiation.
pub(super) fn measure(
    subject: &Subject<'_>,
    clock: &Clock,
) -> Result<Vec<Measurement>, Unmeasurable> {
    let mechanism = &subject.suspension.mechanism;
    let is_hardpoint = |name: &str| mechanism.topology.hardpoint(name).is_some();
    let points: Vec<PointId> = (mechanism.points.iter().enumerate())
        .filter(|(_, p)| is_hardpoint(&p.name))
        .map(|(i, _)| PointId(i))
        .collect();
    let outputs = subject.characteristics();
    let four = Task::new(subject, &outputs[..4.min(outputs.len())], &points);
    let mut found = analytic_and_differences(&four, clock)?;
    for outputs in [1, 4, 8].map(|n| &outputs[..n.min(outputs.len())]) {
        for points in [1, 3, points.len()].map(|n| &points[..n.min(points.len())]) {
            found.extend(both_ways(&Task::new(subject, outputs, points), clock)?);
        }
    }
    Ok(found)
}

/// Difference quotients of whole curves with respect to the coordinates of a task.
struct Differences<'t, 's, 'm> {
    task: &'t Task<'s>,
    station_order: &'t StationOrder,
    solver: Solver<'m>,
    /// Size of the mechanism.
    size: f64,
    moved: Vec<Vector3<f64>>,
    /// Outputs of the design with one moved coordinate.
    values: Vec<f64>,
    /// Outputs of the original design.
    base: Vec<f64>,
}

impl Differences<'_, '_, '_> {
    /// Computes all gradients. The curves are solved again for each coordinate.
    fn differentiate(&mut self, quotient: &Quotient, rule: Step, gradients: &mut Gradients) {
        let Differences {
            task,
            station_order,
            solver,
            size,
            moved,
            values,
            base,
        } = self;
        gradients.values.fill(Vector3::default());
        let solve =
            |solver: &mut Solver<'_>, moved: &[Vector3<f64>], values: &mut [f64]| match solver
                .prepare(moved)
            {
                Ok(()) => task.values(solver, station_order, values),
                Err(_) => values.fill(f64::NAN),
            };
        // The original design is solved once for all coordinates.
        if quotient.terms[0].0 == 0.0 {
            solve(solver, moved, base);
        }
        for (point, id) in task.points.iter().enumerate() {
            let home = moved[id.0];
            for axis in 0..3 {
                let step = rule.length(home.to_array()[axis], *size);
                for (offset, weight) in quotient.terms {
                    let values = match *offset {
                        0.0 => &*base,
                        offset => {
                            let mut to = home.to_array();
                            to[axis] += offset * step;
                            moved[id.0] = Vector3::from(to);
                            solve(solver, moved, values);
                            &*values
                        }
                    };
                    for (i, value) in values.iter().enumerate() {
                        *component(gradients, i * task.points.len() + point, axis) +=
                            weight * value;
                    }
                }
                for i in 0..values.len() {
                    *component(gradients, i * task.points.len() + point, axis) /= step;
                }
            }
            moved[id.0] = home;
        }
    }
}

/// Measures the computing times of whole curves with their gradients. The analytic method solves the poses and differentiates
/// them. The difference quotients solve them again for each coordinate.
fn analytic_and_differences(
    task: &Task<'_>,
    clock: &Clock,
) -> Result<Vec<Measurement>, Unmeasurable> {
    let subject = task.subject;
    let suspension = subject.suspension;
    let stations = subject.travels.len();
    let exact = task.exact();
    let station_order = StationOrder::through(&subject.travels);
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
    let mut adjoint = task.adjoint_room();
    let mut gradients = task.room();
    let mut analytic = |gradients: &mut Gradients| {
        solver
            .prepare(&suspension.design)
            .expect("the design was solved before");
        adjoint
            .design_series
            .prepare(&suspension.mechanism, &suspension.design);
        let visited =
            subject.for_each_pose(&mut solver, &station_order, |solver, station, pose| {
                if let Ok(pose) = pose {
                    task.adjoint(&mut adjoint, solver, (station, pose), gradients);
                }
            });
        visited.expect("the design was solved before");
    };
    analytic(&mut gradients);
    let mut found = vec![Measurement {
        family: Family::Derivative,
        method: "analytic".to_owned(),
        setting: task.name(),
        error: gradients.error(&exact),
        time: clock.time(stations, || analytic(&mut gradients)),
        evaluations: None,
    }];

    let count = stations * task.outputs.len();
    let mut differences = Differences {
        task,
        station_order: &station_order,
        size: solver.size(),
        solver,
        moved: suspension.design.clone(),
        values: vec![0.0; count],
        base: vec![0.0; count],
    };
    for quotient in &QUOTIENTS {
        let steps = STEPS.map(Step::OfSize).into_iter();
        for rule in steps.chain((quotient.name == CENTRAL).then_some(Step::Usual)) {
            let mut differentiate =
                |gradients: &mut Gradients| differences.differentiate(quotient, rule, gradients);
            differentiate(&mut gradients);
            found.push(Measurement {
                family: Family::Derivative,
                method: quotient.name.to_owned(),
                setting: rule.name(),
                error: gradients.error(&exact),
                time: clock.time(stations, || differentiate(&mut gradients)),
                evaluations: None,
            });
        }
    }
    Ok(found)
}

/// Measures the computing times of gradients alone, at poses that are already solved: by forward and by adjoint
/// differentiation.
fn both_ways(task: &Task<'_>, clock: &Clock) -> Result<[Measurement; 2], Unmeasurable> {
    let subject = task.subject;
    let suspension = subject.suspension;
    let exact = task.exact();
    let poses: Vec<Pose<f64>> = (subject.poses.iter())
        .map(|pose| pose.map(|c| c.value()))
        .collect();
    let solver = Solver::new(&suspension.mechanism, &suspension.design)?;
    let forward = Forward::new(
        &suspension.mechanism,
        &suspension.design,
        subject.rack,
        &task.points,
    );
    let mut adjoint = task.adjoint_room();
    let measured = |method: &str, work: &mut dyn FnMut(&mut Gradients)| {
        let mut gradients = task.room();
        work(&mut gradients);
        Measurement {
            family: Family::Sensitivity,
            method: method.to_owned(),
            setting: task.name(),
            error: gradients.error(&exact),
            time: clock.time(poses.len(), || work(&mut gradients)),
            evaluations: None,
        }
    };
    Ok([
        measured("forward", &mut |gradients| {
            task.forward(&forward, &poses, gradients);
        }),
        measured("adjoint", &mut |gradients| {
            for at in poses.iter().enumerate() {
                task.adjoint(&mut adjoint, &solver, at, gradients);
            }
        }),
    ])
}

//! Poses: effect of tolerance, arithmetic, formulation and start.

use super::subject::{Measured, Subject, camber};
use super::{Clock, Family, Measurement, Unmeasurable, worse};
use crate::DoubleDouble;
use crate::Job;
use crate::single::Single;
use crate::trial::{Equations, OneEquation, SixEquations, solve};
use hardpoint_attia::{PointCoordinates, Strut, StrutPoints};
use hardpoint_engine::mechanism::{Pose, Work};
use hardpoint_engine::number::Vector3;
use hardpoint_engine::solve::{Solver, StationOrder};
use std::cell::{Cell, RefCell};
use std::hint::black_box;

/// Starting point of Newton's method at a station.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    /// Every station starts from the design position.
    Cold,
    /// Extrapolation with a polynomial of this order through the poses of previous stations. Order 0 starts from the last pose.
    Predicted(usize),
}

impl Start {
    const ALL: [Start; 5] = [
        Start::Cold,
        Start::Predicted(0),
        Start::Predicted(1),
        Start::Predicted(2),
        Start::Predicted(3),
    ];

    fn name(self) -> String {
        match self {
            Start::Cold => "cold".to_owned(),
            Start::Predicted(0) => "warm".to_owned(),
            Start::Predicted(order) => format!("predictor of order {order}"),
        }
    }
}

/// A station, and the weights with which the poses of previous stations predict its pose.
struct Step {
    station: usize,
    earlier: usize,
    weights: [f64; 4],
}

/// Stations outward from the design position: first upward, then downward.
struct Walk {
    sides: [Vec<Step>; 2],
    cold: bool,
}

impl Walk {
    fn new(travels: &[f64], start: Start) -> Self {
        let station_order = StationOrder::through(travels);
        let order = match start {
            Start::Cold => 0,
            Start::Predicted(order) => order,
        };
        let side = |stations: &[usize]| {
            let mut known = vec![0.0];
            let mut steps = Vec::new();
            for &station in stations {
                let earlier = known.len().min(order + 1);
                let near = &known[known.len() - earlier..];
                let mut weights = [0.0; 4];
                for (i, weight) in weights.iter_mut().enumerate().take(earlier) {
                    *weight = lagrange(near, i, travels[station]);
                }
                steps.push(Step {
                    station,
                    earlier,
                    weights,
                });
                // The list of earlier poses already contains the pose of the design position. The interpolation polynomial must not
                // use the same travel twice.
                if travels[station] != 0.0 {
                    known.push(travels[station]);
                }
            }
            steps
        };
        let [up, down] = station_order.sides();
        Walk {
            sides: [side(up), side(down)],
            cold: start == Start::Cold,
        }
    }
}

/// The i-th Lagrange polynomial of these nodes, at x.
pub(super) fn lagrange(nodes: &[f64], i: usize, x: f64) -> f64 {
    let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
    others.fold(1.0, |product, (_, node)| {
        product * (x - node) / (nodes[i] - node)
    })
}

/// One pass over all poses that reads camber at each pose.
struct Traversal<'s, T, E: Equations<T>> {
    subject: &'s Subject<'s>,
    equations: E,
    walk: Walk,
    tolerance: f64,
    travels: Vec<T>,
    design: Vec<Vector3<T>>,
    known: RefCell<Vec<E::Unknown>>,
    evaluations: Cell<usize>,
}

impl<'s, T: Measured, E: Equations<T>> Traversal<'s, T, E> {
    fn new(subject: &'s Subject<'s>, equations: E, start: Start, tolerance: f64) -> Self {
        Traversal {
            subject,
            equations,
            walk: Walk::new(&subject.travels, start),
            tolerance,
            travels: subject.travels.iter().map(|t| T::of(*t)).collect(),
            design: subject.design(),
            known: RefCell::new(Vec::with_capacity(subject.travels.len() + 1)),
            evaluations: Cell::new(0),
        }
    }

    /// Solves every pose, and calls `visit` with each station and its camber (rad).
    #[inline]
    fn run(&self, mut visit: impl FnMut(usize, T)) {
        let mut known = self.known.borrow_mut();
        let mut evaluations = 0;
        for side in &self.walk.sides {
            known.clear();
            known.push(self.equations.design());
            for step in side {
                let start = if self.walk.cold {
                    known[0]
                } else {
                    let earlier = &known[known.len() - step.earlier..];
                    match step.earlier {
                        1 => earlier[0],
                        _ => self.equations.predicted(earlier, &step.weights),
                    }
                };
                let travel = self.travels[step.station];
                let (found, count) = solve(&self.equations, start, travel, self.tolerance);
                evaluations += count;
                if travel.value() != 0.0 {
                    known.push(found);
                }
                let pose = self.equations.pose(&found);
                let at = self.subject.configuration(&self.design, pose);
                visit(step.station, camber(&at));
            }
        }
        self.evaluations.set(evaluations);
    }

    fn measure(
        &self,
        clock: &Clock,
        family: Family,
        method: String,
        setting: String,
    ) -> Measurement {
        let mut error = 0.0_f64;
        self.run(|station, camber| error = worse(error, self.subject.error(station, camber)));
        let stations = self.travels.len();
        let time = clock.time(stations, || {
            let mut sum = 0.0;
            self.run(|_, camber| sum += camber.value());
            sum
        });
        Measurement {
            family,
            method,
            setting,
            time,
            error,
            evaluations: Some(self.evaluations.get() as f64 / stations as f64),
        }
    }
}

/// Tolerances in metres. Zero means the best accuracy that the arithmetic reaches.
const TOLERANCES: [f64; 8] = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13, 1e-15, 0.0];

fn tolerance_name(metres: f64) -> String {
    match metres {
        0.0 => "rounding".to_owned(),
        _ => format!("{metres:.0e} m"),
    }
}

/// Measures poses by tolerance, arithmetic, formulation and start.
pub(super) fn measure(
    subject: &Subject<'_>,
    clock: &Clock,
) -> Result<Vec<Measurement>, Unmeasurable> {
    let mechanism = &subject.suspension.mechanism;
    let mut found = Vec::new();
    let usual = Start::Predicted(3);
    for metres in TOLERANCES {
        let tolerance = in_length_units(metres, subject);
        let setting = tolerance_name(metres);
        let mut one = |name: &str, m: Option<Measurement>| {
            found.extend(m.map(|m| Measurement {
                method: name.to_owned(),
                ..m
            }));
        };
        // Single precision is measured only with tolerances that it can reach.
        if metres == 0.0 || metres > 1e-8 {
            one(
                "closed form, f32",
                by_closed_form::<Single>(subject, clock, usual, tolerance, &setting),
            );
        }
        one(
            "closed form, f64",
            by_closed_form::<f64>(subject, clock, usual, tolerance, &setting),
        );
        if metres == 0.0 || metres > 1e-8 {
            one(
                "closed form, double-double",
                by_closed_form::<DoubleDouble>(subject, clock, usual, tolerance, &setting),
            );
        }
        let rack = subject.rack;
        let six = SixEquations::new(mechanism, &subject.suspension.design, rack);
        let six = Traversal::new(subject, six, usual, tolerance);
        let name = "six equations, f64".to_owned();
        found.push(six.measure(clock, Family::Pose, name, setting));
    }
    found.extend(production(subject, clock)?);
    found.extend(point_coordinates(subject, clock));
    for start in Start::ALL {
        for metres in [1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 0.0] {
            let tolerance = in_length_units(metres, subject);
            let setting = tolerance_name(metres);
            let closed = by_closed_form::<f64>(subject, clock, start, tolerance, &setting);
            let measured = closed.unwrap_or_else(|| {
                let design = &subject.suspension.design;
                let six = SixEquations::new(mechanism, design, subject.rack);
                let six = Traversal::new(subject, six, start, tolerance);
                six.measure(clock, Family::Start, String::new(), setting.clone())
            });
            found.push(Measurement {
                family: Family::Start,
                method: start.name(),
                ..measured
            });
        }
    }
    Ok(found)
}

/// Converts metres to the length unit of the measured suspension.
fn in_length_units(metres: f64, subject: &Subject<'_>) -> f64 {
    subject.suspension.length_unit.per_metre() * metres
}

/// Measures the closed form without checks. `None` if the mechanism has no closed form.
fn by_closed_form<T: Measured>(
    subject: &Subject<'_>,
    clock: &Clock,
    start: Start,
    tolerance: f64,
    setting: &str,
) -> Option<Measurement> {
    let mechanism = &subject.suspension.mechanism;
    let rack = T::of(subject.rack);
    let equations = OneEquation::<T>::new(mechanism, &subject.design(), rack)?;
    let traversal = Traversal::new(subject, equations, start, tolerance);
    let setting = setting.to_owned();
    Some(traversal.measure(clock, Family::Pose, String::new(), setting))
}

/// Two jobs whose difference in time is the cost of the program's checks. The first job solves the closed form to
/// rounding from predictions of third order, without checks. The second job finds the poses as the program does.
pub(crate) fn unchecked_and_checked<'s>(
    subject: &'s Subject<'s>,
) -> Result<Option<[Job<'s>; 2]>, Unmeasurable> {
    let suspension = subject.suspension;
    let items = subject.travels.len();
    let mechanism = &suspension.mechanism;
    let Some(equation) = OneEquation::new(mechanism, &suspension.design, subject.rack) else {
        return Ok(None);
    };
    let tolerance = in_length_units(UNCHECKED, subject);
    let traversal = Traversal::<f64, _>::new(subject, equation, Start::Predicted(3), tolerance);
    let unchecked = move || {
        let mut sum = 0.0;
        traversal.run(|_, camber| sum += camber);
        black_box(sum);
    };
    let station_order = StationOrder::through(&subject.travels);
    let solver = RefCell::new(Solver::new(mechanism, &suspension.design)?);
    let checked = move || {
        let mut sum = 0.0;
        let mut solver = solver.borrow_mut();
        let visited = subject.for_each_pose(&mut solver, &station_order, |_, _, pose| {
            sum += pose.map_or(f64::NAN, |pose| subject.camber_at(pose));
        });
        visited.expect("the design was solved before");
        black_box(sum);
    };
    Ok(Some([
        Job {
            items,
            work: Box::new(unchecked),
        },
        Job {
            items,
            work: Box::new(checked),
        },
    ]))
}

/// Tolerance in metres at which the job without checks ends its iteration. The program iterates further, to 1e-15 of the
/// largest coordinate.
const UNCHECKED: f64 = 1e-13;

/// Measures the solver of the program, including all its checks.
fn production(subject: &Subject<'_>, clock: &Clock) -> Result<Vec<Measurement>, Unmeasurable> {
    let suspension = subject.suspension;
    let station_order = StationOrder::through(&subject.travels);
    let read = |pose: &Pose<f64>| subject.camber_at(pose);
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
    let mut run = |visit: &mut dyn FnMut(usize, &Pose<f64>)| {
        let visited = subject.for_each_pose(&mut solver, &station_order, |_, station, pose| {
            if let Ok(pose) = pose {
                visit(station, pose);
            }
        });
        visited.expect("the design was solved before");
        solver.work()
    };
    let mut error = 0.0_f64;
    let before = run(&mut |station, pose| {
        error = worse(error, subject.error(station, read(pose)));
    });
    let after = run(&mut |_, _| ());
    let evaluations = |work: Work| work.closed_form_evaluations + work.newton_iterations;
    let count = evaluations(after) - evaluations(before);
    let time = clock.time(subject.travels.len(), || {
        let mut sum = 0.0;
        run(&mut |_, pose| sum += read(pose));
        sum
    });
    Ok(vec![Measurement {
        family: Family::Pose,
        method: "hardpoint solve".to_owned(),
        setting: "default".to_owned(),
        time,
        error,
        evaluations: Some(count as f64 / subject.travels.len() as f64),
    }])
}

/// Measures the fifteen equations of Attia's paper. `None` if the suspension is not a strut, or if the equations have no pose at
/// the subject's rack displacement.
fn point_coordinates(subject: &Subject<'_>, clock: &Clock) -> Option<Measurement> {
    let suspension = subject.suspension;
    let strut = Strut::of(&suspension.mechanism, &suspension.design)?;
    let drive = hardpoint_attia::Drive::Travel;
    let equations = PointCoordinates::new(&strut, StrutPoints::Spread, drive).ok()?;
    let start = equations.placed(subject.rack).ok()?;
    let read = |pose: &hardpoint_attia::Pose| {
        let rates = hardpoint_attia::Rates::default();
        let pose = equations.knuckle_pose::<1>(pose, rates).ok()?;
        Some(subject.camber_at(&pose.map(|c| c[0])))
    };
    let run = |visit: &mut dyn FnMut(usize, f64)| {
        equations.for_each_pose(&start, &subject.travels, &mut |station, pose| {
            if let Some(camber) = pose.ok().and_then(read) {
                visit(station, camber);
            }
        });
    };
    let mut error = 0.0_f64;
    run(&mut |station, camber| error = worse(error, subject.error(station, camber)));
    let before = equations.work().factorisations;
    run(&mut |_, _| {});
    let evaluations = equations.work().factorisations - before;
    let stations = subject.travels.len();
    let time = clock.time(stations, || {
        let mut sum = 0.0;
        run(&mut |_, camber| sum += camber);
        sum
    });
    Some(Measurement {
        family: Family::Pose,
        method: "point coordinates (paper)".to_owned(),
        setting: "rounding".to_owned(),
        time,
        error,
        evaluations: Some(evaluations as f64 / stations as f64),
    })
}

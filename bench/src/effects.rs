//! Cost of each effect, alone and added to the previous effects, relative to the cost of positions alone.

use super::accuracy::{Subject, unchecked_and_checked};
use super::{Clock, Job, Timing, Unmeasurable, wheel_travel};
use hardpoint_engine::analyse::Certifier;
use hardpoint_engine::characteristics::Characteristic;
use hardpoint_engine::curves::curves;
use hardpoint_engine::derive::MotionPoint;
use hardpoint_engine::mechanism::{Pose, Work};
use hardpoint_engine::model::{Drive, PointId, Suspension, VehicleFigures};
use hardpoint_engine::number::Vector3;
use hardpoint_engine::plan::Plan;
use hardpoint_engine::solve::Solver;
use hardpoint_engine::study::{
    Formulation, Load, LoadPoint, Motion, Order, Outputs, TimeLaw, WheelStudy,
};
use std::hint::black_box;

/// Measured cost of one effect (an additional result, such as rates or sensitivities).
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Name of the effect.
    pub effect: String,
    /// Time per pose with this effect alone.
    pub alone: Timing,
    /// Time per pose with this effect and all previous ones.
    pub added: Timing,
    /// Work done in one run with this effect alone.
    pub work: Work,
    /// Number of poses in one run with this effect alone.
    pub poses: usize,
}

/// Measurements of all effects. The first one is the cost of positions without further effects.
#[derive(Clone, Debug, PartialEq)]
pub struct Effects {
    /// Measurements in the order in which the effects (additional results, such as rates or sensitivities) are added.
    pub measurements: Vec<Measurement>,
}

/// Change of a study that adds one effect.
struct Change {
    name: &'static str,
    apply: fn(&mut WheelStudy),
}

const CHANGES: [Change; 12] = [
    Change {
        name: "position",
        apply: |_| (),
    },
    Change {
        name: "inputs of all outputs given, no output requested",
        apply: |study| {
            study.suspension.vehicle = VehicleFigures {
                wheelbase: Some(2600.0),
                track: Some(1500.0),
                cg_height: Some(500.0),
                brake_share_front: Some(0.6),
                ..VehicleFigures::default()
            };
            study.suspension.wheel_radius.get_or_insert(300.0);
        },
    },
    Change {
        name: "steering axis",
        apply: |study| {
            if study.suspension.mechanism.steering_axis.is_some() {
                let axis = [Characteristic::KingpinInclination, Characteristic::Caster];
                study.outputs.characteristics.extend(axis);
            }
        },
    },
    Change {
        name: "rates",
        apply: |study| study.outputs.order = study.outputs.order.max(Order::Velocity),
    },
    Change {
        name: "curvature",
        apply: |study| study.outputs.order = Order::Acceleration,
    },
    Change {
        name: "sensitivities to one point",
        apply: |study| study.outputs.sensitivities = hardpoints(&study.suspension)[..1].to_vec(),
    },
    Change {
        name: "sensitivities to every point",
        apply: |study| study.outputs.sensitivities = hardpoints(&study.suspension),
    },
    Change {
        name: "spring (motion ratio: needs velocities)",
        apply: |study| {
            if study.suspension.mechanism.spring.is_some() {
                let ratio = Characteristic::MotionRatio;
                study.outputs.characteristics.push(ratio);
            }
        },
    },
    Change {
        name: "angles of rocker and anti-roll bar",
        apply: |study| {
            let mechanism = &study.suspension.mechanism;
            let rocker = mechanism.spring_rocker();
            let rocker = rocker.map(|_| Characteristic::RockerAngle);
            let bar = mechanism.anti_roll_bar();
            let bar = bar.map(|_| Characteristic::AntiRollBarAngle);
            study.outputs.characteristics.extend(rocker);
            study.outputs.characteristics.extend(bar);
        },
    },
    Change {
        name: "rack at five positions",
        apply: |study| {
            let size = study.suspension.size();
            let rack = &mut study.motion.rack;
            let first = rack[0];
            *rack = [-2.0, -1.0, 0.0, 1.0, 2.0]
                .map(|k| first + 0.002 * k * size)
                .to_vec();
            study.motion.rack_moves = true;
        },
    },
    Change {
        name: "time",
        apply: |study| {
            let values = &mut study.motion.values;
            let (first, last) = (values[0], values[values.len() - 1]);
            let steps = (values.len() - 1) as f64;
            let times: Vec<f64> = (0..values.len()).map(|i| i as f64 / steps).collect();
            let polynomial = vec![first, last - first];
            *values = times.iter().map(|t| first + (last - first) * t).collect();
            study.motion.time = Some(TimeLaw { polynomial, times });
        },
    },
    Change {
        name: "a load",
        apply: |study| {
            study.outputs.loads.push(Load {
                name: "load".to_owned(),
                at: LoadPoint::WheelCentre,
                held: None,
                force: Vector3::new(100.0, 200.0, 3000.0),
                moment: Vector3::default(),
            });
        },
    },
];

impl Effects {
    /// Measures each effect on the suspension of a study, over its travels.
    pub fn measure(study: &WheelStudy, clock: &Clock) -> Result<Self, Unmeasurable> {
        let subject = Subject::of(study)?;
        let mut base = study.clone();
        base.formulation = Formulation::KnucklePose;
        base.motion = Motion {
            rack: study.motion.rack[..1].to_vec(),
            ..wheel_travel(&subject.travels)
        };
        base.outputs = Outputs::of(vec![Characteristic::Camber]);
        base.suspension.vehicle = VehicleFigures::default();
        let mut added = base.clone();
        let mut runs = Vec::new();
        for change in &CHANGES {
            let mut alone = base.clone();
            (change.apply)(&mut alone);
            (change.apply)(&mut added);
            runs.push((change.name, Planned::of(&alone)?, Planned::of(&added)?));
        }
        let all = runs.len() - 1;
        let mut jobs = Vec::new();
        for (_, alone, added) in &runs {
            jobs.extend([alone.job(), added.job()]);
        }
        let times = clock.in_rounds(&mut jobs);
        // A plan contains no certificates. They are computed separately for every pose.
        let proofs = Proofs::of(&base, &subject)?;
        let jobs = [(&runs[0].1, 1), (&runs[all].2, runs[all].2.racks())];
        let rest = clock.in_rounds(&mut jobs.map(|(planned, many)| proofs.job(planned, many)));
        let measured = |effect: &str, run: &Planned, alone, added| Measurement {
            effect: effect.to_owned(),
            alone,
            added,
            work: run.work,
            poses: run.poses,
        };
        let plain = runs.iter().zip(times.chunks(2));
        let mut measurements: Vec<Measurement> = plain
            .map(|((name, alone, _), times)| measured(name, alone, times[0], times[1]))
            .collect();
        let position = &runs[0].1;
        measurements.push(measured("certificate", position, rest[0], rest[1]));
        if let Some(mut jobs) = unchecked_and_checked(&subject)? {
            let names = ["poses alone, unchecked", "poses alone"].into_iter();
            let times = names.zip(clock.in_rounds(&mut jobs));
            measurements.extend(times.map(|(name, time)| measured(name, position, time, time)));
        }
        Ok(Effects { measurements })
    }
}

/// A plan with its suspension.
struct Planned {
    suspension: Suspension,
    plan: Plan,
    work: Work,
    poses: usize,
}

impl Planned {
    fn of(study: &WheelStudy) -> Result<Self, Unmeasurable> {
        let plan = Plan::of(study);
        let found = curves(&study.suspension, &plan)?;
        Ok(Planned {
            suspension: study.suspension.clone(),
            work: found.work,
            poses: found.stations.len(),
            plan,
        })
    }

    fn racks(&self) -> usize {
        self.plan.racks.len()
    }

    fn run(&self) {
        let found = curves(&self.suspension, &self.plan);
        black_box(found.expect("the design was solved before"));
    }

    fn job(&self) -> Job<'_> {
        Job {
            items: self.poses,
            work: Box::new(|| self.run()),
        }
    }
}

/// Certificates of the poses of a plan.
struct Proofs<'m> {
    certifier: Certifier<'m>,
    poses: Vec<(Pose<f64>, MotionPoint<f64>)>,
}

impl<'m> Proofs<'m> {
    fn of(base: &WheelStudy, subject: &'m Subject<'_>) -> Result<Self, Unmeasurable> {
        let suspension = subject.suspension;
        let mechanism = &suspension.mechanism;
        let mut solver = Solver::new(mechanism, &suspension.design)?;
        let plan = Plan::of(base);
        let mut poses = Vec::new();
        subject.for_each_pose(&mut solver, &plan.station_order, |_, station, pose| {
            let point = MotionPoint {
                drive: Drive::Travel,
                value: plan.station_order.values()[station],
                rack: subject.rack,
            };
            poses.extend(pose.ok().map(|pose| (*pose, point)));
        })?;
        Ok(Proofs {
            certifier: Certifier::new(mechanism, &suspension.design),
            poses,
        })
    }

    /// Makes a job that runs the plan and certifies every pose `many` times.
    fn job<'a>(&'a self, planned: &'a Planned, many: usize) -> Job<'a> {
        Job {
            items: planned.poses,
            work: Box::new(move || {
                planned.run();
                for _ in 0..many {
                    for (pose, point) in &self.poses {
                        let proof = self.certifier.pose(pose, point);
                        let _ = black_box(proof);
                    }
                }
            }),
        }
    }
}

/// Hardpoints of a suspension.
fn hardpoints(suspension: &Suspension) -> Vec<PointId> {
    let mechanism = &suspension.mechanism;
    let known = |name: &str| mechanism.topology.hardpoint(name).is_some();
    let points = mechanism.points.iter().enumerate();
    points
        .filter(|(_, p)| known(&p.name))
        .map(|(i, _)| PointId(i))
        .collect()
}

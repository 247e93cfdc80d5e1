//! Tests in which the program must find toggles that the test has constructed.
//!
//! The test constructs a design in a singular position of one part. Then it moves the carrier away from this position
//! while the drive stays constant, by Newton's method on lengths alone. The motion of the moved design must end at the
//! singular position, and the program must name that part.

use super::sample;
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::analyse::{Range, RangeEnd};
use hardpoint::mechanism::{Configuration, LimitCause};
use hardpoint::model::{Body, Constraint, Mechanism, PointId, Suspension};
use hardpoint::number::Vector3;
use hardpoint::solve::Solver;
use nalgebra::{DMatrix, DVector};

type Points = Vec<Vector3<f64>>;

/// Quantity that drives the motion up to its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    Travel,
    ArmAngle,
    Rack,
}

/// Design in a singular position that the test constructed, with the name of the limit.
struct Planted {
    mechanism: Mechanism,
    folded: Points,
    size: f64,
    quantity: Quantity,
    cause: LimitCause,
    dependent: Vec<PointId>,
}

/// Vector rotated by a rotation vector.
fn turned(v: Vector3<f64>, by: Vector3<f64>) -> Vector3<f64> {
    let angle = by.norm();
    if angle == 0.0 {
        return v;
    }
    let k = by * (1.0 / angle);
    v * angle.cos() + k.cross(v) * angle.sin() + k * (k.dot(v) * (1.0 - angle.cos()))
}

impl Planted {
    /// Points with the carrier translated by x_0..3 (divided by the suspension size) and rotated by x_3..6, and the
    /// rack displaced by x_6.
    fn moved(&self, x: &DVector<f64>) -> Points {
        let origin = self.folded[self.mechanism.origin.0];
        let shift = Vector3::new(x[0], x[1], x[2]) * self.size;
        let turn = Vector3::new(x[3], x[4], x[5]);
        let points = self.folded.iter().zip(&self.mechanism.points);
        let moved = points.map(|(p, of)| match of.body {
            Body::Knuckle => origin + shift + turned(*p - origin, turn),
            Body::Rack => *p + Vector3::new(0.0, x[6] * self.size, 0.0),
            _ => *p,
        });
        moved.collect()
    }

    /// Residuals of the five constraints, and the change of the drive from the singular position. All are divided by
    /// the suspension size.
    fn residuals(&self, x: &DVector<f64>) -> DVector<f64> {
        let (was, now) = (&self.folded, self.moved(x));
        let mut rows = Vec::new();
        for constraint in &self.mechanism.constraints {
            match *constraint {
                Constraint::Link { inner, outer } => {
                    let length = |p: &Points| (p[outer.0] - p[inner.0]).norm();
                    rows.push(length(&now) - length(was));
                }
                Constraint::StrutLine { top, lower, .. } => {
                    let line = was[top.0] - was[lower.0];
                    let axis = line * (1.0 / line.norm());
                    let turn = Vector3::new(x[3], x[4], x[5]);
                    let off = turned(axis, turn).cross(now[top.0] - now[lower.0]);
                    let first = turned(axis.cross(Vector3::new(0.3, 0.5, 0.7)), turn);
                    let second = turned(axis, turn).cross(first);
                    rows.extend([first.dot(off), second.dot(off)].map(|r| r / first.norm()));
                }
                Constraint::BallJoint { at } => {
                    rows.extend((now[at.0] - was[at.0]).to_array());
                }
                _ => unreachable!("a hinge is never singular, and others are planted elsewhere"),
            }
        }
        rows.push(match self.quantity {
            Quantity::ArmAngle => {
                let arm = self.mechanism.arms[0];
                let way =
                    (was[arm.front.0] - was[arm.rear.0]).cross(was[arm.outer.0] - was[arm.rear.0]);
                (now[arm.outer.0] - was[arm.outer.0]).dot(way) / way.norm()
            }
            _ => {
                let wheel = self.mechanism.wheel_centre.0;
                now[wheel].z - was[wheel].z
            }
        });
        DVector::from_vec(rows) / self.size
    }

    /// Derivatives of the residuals, from finite differences.
    fn jacobian(&self, x: &DVector<f64>) -> DMatrix<f64> {
        let step = 1e-5;
        DMatrix::from_columns(&Vec::from_iter((0..7).map(|k| {
            let mut there = x.clone();
            there[k] += step;
            let ahead = self.residuals(&there);
            there[k] -= 2.0 * step;
            (ahead - self.residuals(&there)) / (2.0 * step)
        })))
    }

    /// Motion of the carrier while the drive stays constant.
    fn free(&self) -> DVector<f64> {
        let jacobian = self.jacobian(&DVector::zeros(7));
        let by_pose = jacobian.columns(0, 6).into_owned();
        let values = by_pose.svd(false, true);
        let rows = values.v_t.unwrap();
        let least = values.singular_values.imin();
        rows.row(least).transpose()
    }

    /// Design at the distance `far` from the singular position, along the motion of the carrier with a constant drive.
    /// `None` if there is no such design.
    fn led_away(&self, far: f64) -> Option<Points> {
        let free = self.free();
        let mut x = DVector::zeros(7);
        for k in 0..6 {
            x[k] = far * free[k];
        }
        for _ in 0..60 {
            let all = self.residuals(&x);
            let jacobian = self.jacobian(&x);
            let mut rows = DMatrix::zeros(7, 7);
            let mut miss = DVector::zeros(7);
            for i in 0..5 {
                rows.set_row(i, &jacobian.row(i));
                miss[i] = all[i];
            }
            for k in 0..6 {
                rows[(5, k)] = free[k];
                miss[5] += free[k] * x[k];
            }
            miss[5] -= far;
            match self.quantity {
                // The last equation keeps either the wheel height or the rack constant.
                Quantity::Rack => {
                    rows.set_row(6, &jacobian.row(5));
                    miss[6] = all[5];
                }
                _ => {
                    rows[(6, 6)] = 1.0;
                    miss[6] = x[6];
                }
            }
            let by = rows.lu().solve(&miss)?;
            x -= &by;
            if by.norm() < 1e-15 {
                return Some(self.moved(&x));
            }
            if by.norm().is_nan() || x.norm() > 1.0 {
                return None;
            }
        }
        Some(self.moved(&x)).filter(|_| self.residuals(&x).rows(0, 5).norm() < 1e-13)
    }

    /// Returns true if the program finds and names the singular position from the distance `far`. `None` if there is no
    /// such design.
    fn is_found(&self, far: f64) -> Option<bool> {
        let design = self.led_away(far)?;
        let mut solver = Solver::new(&self.mechanism, &design).ok()?;
        let limits = solver.limits().ok()?;
        let range: &Range = match self.quantity {
            Quantity::Travel => &limits.travel,
            Quantity::ArmAngle => limits.arm_angle.as_ref()?,
            Quantity::Rack => limits.rack.as_ref()?,
        };
        let is_here = |end: &&RangeEnd| match end {
            RangeEnd::Fold(limit) => {
                let at = Configuration::new(&self.mechanism, &design, limit.pose, 0.0);
                let carried = |id: &usize| self.mechanism.points[*id].body == Body::Knuckle;
                let points = (0..design.len()).filter(carried);
                let off = points.map(|id| (at.point(PointId(id)) - self.folded[id]).norm());
                off.fold(0.0, larger) < 1e-5 * self.size
            }
            _ => false,
        };
        let end = [&range.lower, &range.upper].into_iter().find(is_here);
        let Some(RangeEnd::Fold(limit)) = end else {
            let ends = [&range.lower, &range.upper].map(|end| end.value());
            println!(
                "{:?} {:?} from {far}: {ends:?} {:?}",
                self.quantity,
                self.cause,
                causes(range)
            );
            return Some(false);
        };
        let named = limit.cause == self.cause && limit.dependent == self.dependent;
        if !named {
            println!("{:?} {:?}: {limit:?}", self.quantity, self.cause);
        }
        Some(named)
    }
}

fn causes(range: &Range) -> [Option<LimitCause>; 2] {
    [&range.lower, &range.upper].map(|end| match end {
        RangeEnd::Fold(limit) => Some(limit.cause),
        _ => None,
    })
}

/// Strut or double wishbone design with a part in its singular position.
fn plant(sample: &Suspension, cause: LimitCause, quantity: Quantity, number: u64) -> Planted {
    let random = &mut Random(100 + number);
    let size = sample.size();
    let mechanism = sample.mechanism.clone();
    let mut points = random.scattered(&sample.design, 0.06 * size);
    let id = |name: &str| mechanism.point(name).unwrap().0;
    let strut = mechanism.point("strut_top").is_some();
    let upper = if strut {
        id("strut_top")
    } else {
        id("upper_ball_joint")
    };
    let (ball_joint, wheel) = (id("lower_ball_joint"), id("wheel_centre"));
    let base = points[ball_joint];
    let axis = points[upper] - base;
    let along = axis * (1.0 / axis.norm());
    let (inner, outer) = (id("tie_rod_inner"), id("tie_rod_outer"));
    // Motion of the carrier about the lower ball joint.
    let turn = match cause {
        LimitCause::TieRodToggle => {
            let across = |p: usize| {
                let lever = points[p] - base;
                lever - along * along.dot(lever)
            };
            let (from, to) = (across(inner), across(outer));
            let side = from.norm() / to.norm() * random.signed().signum();
            points[inner] = points[inner] - from + to * side;
            along
        }
        _ => {
            let way = if strut {
                // Direction perpendicular to the steering axis.
                let away = random.vector(1.0);
                let square = (away - along * along.dot(away)).normalised();
                points[id("strut_lower")] = points[upper] + square * (0.3 * size);
                square
            } else {
                let [front, rear] = ["front", "rear"].map(|end| id(&format!("upper_arm_{end}")));
                let radius = 0.4 * size * random.signed().signum();
                let across = random.vector(1.0) + Vector3::new(3.0, 0.0, 0.0);
                let pivot = points[upper] - along * radius;
                points[front] = pivot + across * (0.1 * size);
                points[rear] = pivot - across * (0.1 * size);
                across.cross(points[upper] - pivot)
            };
            let swing = axis.cross(way);
            let rod = points[outer] - points[inner];
            let work = |turn: Vector3<f64>| rod.dot(turn.cross(points[outer] - base));
            swing - along * (work(swing) / work(along))
        }
    };
    if quantity != Quantity::ArmAngle {
        // Axis along which this rotation does not lift the wheel centre.
        let level = Vector3::new(turn.x, turn.y, 0.0).normalised();
        let height = points[wheel].z - base.z;
        points[wheel] = base + level * (0.25 * size) + Vector3::new(0.0, 0.0, height);
    }
    Planted {
        folded: points,
        mechanism,
        size,
        quantity,
        cause,
        dependent: Vec::new(),
    }
}

/// Five-link design in a singular position: two links and the toe link meet in one point and lie in one plane.
fn plant_links(sample: &Suspension, number: u64) -> Planted {
    let random = &mut Random(900 + number);
    let size = sample.size();
    let mechanism = sample.mechanism.clone();
    let mut points = random.scattered(&sample.design, 0.06 * size);
    let id = |name: &str, end: &str| mechanism.point(&format!("{name}_{end}")).unwrap();
    let names = [
        "upper_front_link",
        "upper_rear_link",
        "lower_front_link",
        "lower_rear_link",
    ];
    let pairs = [[0, 1], [2, 3], [0, 2], [1, 3], [0, 3], [1, 2]];
    let [first, second] = pairs[number as usize % pairs.len()].map(|k| names[k]);
    let meet = points[id(first, "outer").0];
    points[id(second, "outer").0] = meet;
    let to = [first, second].map(|name| (points[id(name, "inner").0] - meet).normalised());
    let along = to[0] * 0.4 + to[1] * 0.6 + (to[0] - to[1]) * (0.3 * random.signed());
    let along = along.normalised();
    points[id("toe_link", "outer").0] = meet + along * (0.12 * size);
    points[id("toe_link", "inner").0] = meet + along * (0.7 * size);
    let mut dependent = [first, second, "toe_link"].map(|name| id(name, "outer"));
    dependent.sort_by_key(|id| id.0);
    Planted {
        folded: points,
        mechanism,
        size,
        quantity: Quantity::Rack,
        cause: LimitCause::DependentLinks,
        dependent: dependent.to_vec(),
    }
}

/// Constructs a limit for every part of three suspensions, `each` times for every quantity, and compares it with the limit
/// that the program finds.
fn examine(each: u64) {
    let [strut, wishbone, links] = [
        "macpherson_solve",
        "double_wishbone_solve",
        "five_link_solve",
    ]
    .map(sample);
    let parts = [
        (&strut, LimitCause::TieRodToggle),
        (&strut, LimitCause::StrutSquare),
        (&wishbone, LimitCause::TieRodToggle),
        (&wishbone, LimitCause::UpperArmStraight),
    ];
    let quantities = [Quantity::Travel, Quantity::ArmAngle, Quantity::Rack];
    let (mut planted, mut found) = (0, 0);
    for number in 0..each {
        let far = [0.05, -0.05, 0.1, -0.1][number as usize % 4];
        let toggles = parts.iter().flat_map(|(sample, cause)| {
            quantities.map(|quantity| plant(sample, *cause, quantity, number))
        });
        for toggle in toggles.chain([plant_links(&links, number)]) {
            // Another limit may lie between the design at this distance and the constructed singular position. The test
            // then tries designs that are nearer to the singular position.
            let nearer = |named| {
                named
                    || [0.3, 0.1, 0.03]
                        .iter()
                        .any(|nearer| toggle.is_found(nearer * far) == Some(true))
            };
            if let Some(named) = toggle.is_found(far).map(nearer) {
                planted += 1;
                found += usize::from(named);
            }
        }
    }
    println!("{found} of {planted} planted toggles found and named");
    assert_eq!(found, planted);
    assert!(planted as u64 >= 11 * each, "{planted}");
}

#[test]
fn planted_toggles_are_found_and_named() {
    examine(2);
}

#[test]
#[ignore = "300 planted toggles: with .ci/long"]
fn three_hundred_planted_toggles_are_found_and_named() {
    examine(26);
}

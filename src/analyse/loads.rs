//! What the constraints carry under a load on the wheel.
//!
//! By virtual work: a wrench w on the knuckle is balanced by multipliers l of the closure equations,
//!
//! ```text
//! J^T l + w = 0
//! ```
//!
//! The row of a rod is the unit force along it, so its multiplier is the force with which the rod
//! pushes the knuckle; the row of a strut line is a unit force on the knuckle across the strut; those of
//! a hinge are unit forces at its points. The sixth row is what keeps the suspension from moving: the
//! spring, or, where a study has none, a vertical force at the wheel centre. A spring on a rocker holds it
//! through the rod, whose tension follows from the moments about the rocker's axis.

use crate::linear::lu::Lu6;
use crate::mechanism::Closure;
use crate::mechanism::WorkCounter;
use crate::mechanism::constraint::Row;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Wrench};
use crate::mechanism::{Failure, Pose};
use crate::model::{Body, PointId, Spring};
use crate::number::Vector3;
use crate::solve::Conditioning;
use crate::solve::Solver;

/// A load on the knuckle, in the kernel's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Where the force acts.
    pub point: Vector3<f64>,
    /// Force.
    pub force: Vector3<f64>,
    /// Moment, in units of force times length.
    pub moment: Vector3<f64>,
}

/// What keeps the suspension from moving under a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// A spring between two points.
    Spring(Spring),
    /// A vertical force at the wheel centre.
    WheelCentre,
}

/// The part of the load that one equation carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reaction {
    /// A rod, or a leg of an arm.
    Rod {
        /// Its inner joint.
        inner: PointId,
        /// Its outer joint.
        outer: PointId,
        /// Force in it; negative in compression.
        tension: f64,
    },
    /// A force on the knuckle at a point of the body: the side force of a strut at its mount, one of two
    /// components, or the force in a hinge at one of its points, one of three or two.
    Force {
        /// Where.
        point: PointId,
        /// The component.
        force: Vector3<f64>,
    },
}

/// How a load is carried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reactions {
    /// By the constraints, in the order of the mechanism's.
    pub constraints: [Reaction; 5],
    /// By the support: the force of the spring, positive in compression, or the upward force at the
    /// wheel centre.
    pub support: f64,
    /// Tension in the pushrod or pullrod, where the spring stands on a rocker.
    pub rod: Option<f64>,
    /// The force of the support on the knuckle. Where the spring, or the rod of its rocker, stands on an arm it is what the arm
    /// passes on at its outer joint: with the legs of that arm, which then are loaded in bending as
    /// well, it adds up to the force in the joint.
    pub support_force: Vector3<f64>,
}

/// A pose with its support, ready to be loaded: its equations are factorised once for any number of
/// loads.
pub struct Balance<'a> {
    closure: &'a Closure<f64>,
    at: Configuration<'a, f64>,
    /// The equation of the support.
    support: Wrench<f64>,
    /// Tension in the rod of the spring's rocker for a spring force of one.
    rod_per_spring: Option<f64>,
    lu: Lu6<f64>,
    work: &'a WorkCounter,
}

impl<'a> Balance<'a> {
    /// The pose of a mechanism of this size; `None` where the support has no leverage, or so little that
    /// fewer than six digits of the forces could be trusted.
    pub(crate) fn new(
        closure: &'a Closure<f64>,
        at: Configuration<'a, f64>,
        support: Support,
        size: f64,
        work: &'a WorkCounter,
    ) -> Option<Self> {
        let mut rows = [Wrench::zero(0.0); 6];
        for (wrench, row) in rows.iter_mut().zip(closure.rows()) {
            row.differential(&at, 1.0, wrench);
        }
        let mut rod_per_spring = None;
        match support {
            Support::Spring(spring) => {
                let lower = at.point(spring.lower);
                let along = (lower - at.point(spring.upper)).normalised();
                if let Body::Rocker(rocker) = at.mechanism.body(spring.lower) {
                    rod_per_spring = Some(at.rod_tension(rocker, lower, along));
                }
                at.push_point(spring.lower, along, &mut rows[5]);
                at.push_point(spring.upper, -along, &mut rows[5]);
            }
            Support::WheelCentre => {
                let up = Vector3::new(0.0, 0.0, 1.0);
                at.push_point(at.mechanism.wheel_centre, up, &mut rows[5]);
            }
        }
        let support = rows[5];
        work.note(|w| w.factorisations += 1);
        let lu = Lu6::new(rows.map(Wrench::to_row), size)?;
        (!Conditioning::of(&lu, size).is_poor()).then_some(Balance {
            closure,
            at,
            support,
            rod_per_spring,
            lu,
            work,
        })
    }

    /// What carries a load.
    pub fn under(&self, load: &Load) -> Reactions {
        let mut wrench = Wrench::zero(0.0);
        let lever = load.point - self.at.pose.origin;
        wrench.wrench(load.force, lever.cross(load.force) + load.moment);
        self.work.note(|w| w.right_hand_sides += 1);
        let multipliers = self.lu.solve_transposed(wrench.to_row().map(|c| -c));
        let mut constraints = [Reaction::Force {
            point: self.at.mechanism.origin,
            force: Vector3::default(),
        }; 5];
        for ((reaction, row), multiplier) in constraints
            .iter_mut()
            .zip(self.closure.rows())
            .zip(multipliers)
        {
            *reaction = row.reaction(&self.at, multiplier);
        }
        Reactions {
            constraints,
            support: multipliers[5],
            rod: self.rod_per_spring.map(|ratio| ratio * multipliers[5]),
            support_force: self.support.force * multipliers[5],
        }
    }
}

impl Row<f64> {
    /// What the multiplier of this equation means.
    fn reaction(&self, at: &Configuration<f64>, multiplier: f64) -> Reaction {
        match self {
            Row::Link(row) => Reaction::Rod {
                inner: row.inner,
                outer: row.outer,
                tension: -multiplier,
            },
            Row::StrutLine(row) => Reaction::Force {
                point: row.top,
                force: at.pose.rotation.apply(row.normal) * -multiplier,
            },
            Row::Pinned(row) => Reaction::Force {
                point: row.point,
                force: row.direction * multiplier,
            },
        }
    }
}

impl Solver<'_> {
    /// A pose found by this solver, the rack at `rack`, ready to be loaded; [`Failure::Singular`] where the
    /// support cannot carry a load.
    pub fn balance(
        &self,
        pose: &Pose<f64>,
        rack: f64,
        support: Support,
    ) -> Result<Balance<'_>, Failure> {
        let at = self.configuration(pose, rack);
        Balance::new(&self.closure, at, support, self.size(), &self.work).ok_or(Failure::Singular)
    }
}

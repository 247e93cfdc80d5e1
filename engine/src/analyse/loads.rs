//! Forces that constraints carry under a load on the wheel.
//!
//! By virtual work, multipliers l of the closure equations balance a wrench w on the knuckle:
//!
//! ```text
//! J^T l + w = 0                                                                   (1)
//! ```
//!
//! Each constraint equation has a row in the Jacobian J. The row of a rod is the unit force along it, so its multiplier
//! is the force with which the rod pushes the knuckle. The row of a strut line is a unit force on the knuckle across
//! the strut. The rows of a hinge are unit forces at its points. The sixth row is the support, which prevents the
//! suspension from moving. The support is the spring or, without a spring, a vertical force at the wheel centre. A
//! spring on a rocker acts through the rod. The tension of this rod is computed from the moments about the rocker's
//! axis.
//!
//! A rigid axle has two supports, one at each wheel. The mechanism belongs to the near wheel; the far wheel is the
//! opposite one. One of the axle's two travels is not the drive but held constant. Its row is no constraint of the
//! mechanism, so the support of the far wheel takes this row.
//!
//! The balance is generic over the number type. With series along a design variable, each force includes its derivative
//! with respect to this variable. The matrix is factorised by its constant part.

mod members;

pub(crate) use members::members_of_constraints;
pub use members::{Carried, Member, members};

use super::beam_loads::BeamForces;
use crate::linear::lu::{Lu6, Matrix6, Vector6};
use crate::mechanism::constraint::Row;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Closure, Configuration, Failure, Pose, WorkCounter, Wrench};
use crate::model::{Axis, Body, Mechanism, PointId, RigidAxle, RockerId, Spring};
use crate::number::{Each, Jet, Scalar, Vector3};
use crate::solve::{Conditioning, Solver};
use members::sprung_joint;

/// Prefix of the names of members in the far half of a rigid axle, which carries the opposite wheel.
pub const FAR: &str = "right_";
/// Index of the row for the travel of a rigid axle that is held constant. It is the last of the five rows of
/// constraints.
const FAR_ROW: usize = 4;

/// Point at which a load acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadPoint {
    /// Contact point of wheel and ground.
    ContactPoint,
    /// Centre of the wheel.
    WheelCentre,
}

/// A load on the knuckle, in the kernel's frame (x forward, y left, z up, for a left wheel).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load<T = f64> {
    /// Point at which the force acts.
    pub point: Vector3<T>,
    /// Force of the load on the knuckle.
    pub force: Vector3<f64>,
    /// Moment of the load on the knuckle, in units of force times length.
    pub moment: Vector3<f64>,
}

/// Support that holds the suspension under a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// A spring between two points.
    Spring(Spring),
    /// A vertical force at the wheel centre.
    WheelCentre,
}

impl Support {
    /// Returns the spring as support. If the mechanism has no spring, returns a vertical force at the wheel centre.
    pub fn of(mechanism: &Mechanism) -> Self {
        mechanism
            .spring
            .map_or(Support::WheelCentre, Support::Spring)
    }

    /// Rocker through which the spring holds the suspension.
    pub fn rocker(self, mechanism: &Mechanism) -> Option<RockerId> {
        match self {
            Support::Spring(spring) => mechanism.rockers_moving(spring.lower).next(),
            Support::WheelCentre => None,
        }
    }
}

/// LU factors of a matrix. If the matrix contains series, its constant part is factorised.
#[derive(Clone, Copy)]
pub struct Factors<'f>(pub(super) &'f Lu6<f64>);

/// A number type for which forces can be balanced.
pub trait Balanced: Scalar {
    /// Solves A^T x = b for x, with the factors of the constant part of A.
    fn multipliers(factors: Factors<'_>, a: &Matrix6<Self>, b: Vector6<Self>) -> Vector6<Self>;
}

impl Balanced for f64 {
    fn multipliers(factors: Factors<'_>, _: &Matrix6<f64>, b: Vector6<f64>) -> Vector6<f64> {
        factors.0.solve_transposed(b)
    }
}

impl<const N: usize> Balanced for Jet<f64, N> {
    fn multipliers(factors: Factors<'_>, a: &Matrix6<Self>, b: Vector6<Self>) -> Vector6<Self> {
        factors.0.solve_transposed_series(a, &b)
    }
}

/// Part of the load that one constraint equation carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reaction<T = f64> {
    /// A rod, or a leg of an arm.
    Rod {
        /// Inner joint of the rod.
        inner: PointId,
        /// Outer joint of the rod.
        outer: PointId,
        /// Force in the rod, positive in tension.
        tension: T,
    },
    /// A link between an arm and the knuckle, or a second joint between them. The outer joint of the arm carries the
    /// reaction.
    ArmEnd {
        /// End of the link on the arm.
        inner: PointId,
        /// End of the link on the knuckle, or the joint.
        outer: PointId,
        /// Tension of the link. It has no meaning for a joint.
        tension: T,
        /// Force on the knuckle at the outer end.
        force: Vector3<T>,
        /// Outer joint of the arm.
        joint: PointId,
        /// Force of the arm on the knuckle at the arm's outer joint.
        passed: Vector3<T>,
    },
    /// A force that the body exerts on the knuckle at a point: one of two components of a strut's side force at its
    /// mount, or one component of the force at a hinge, ball joint or mount. 0 for the constant travel of a rigid axle.
    Force {
        /// Point at which the force acts.
        point: PointId,
        /// This component of the force on the knuckle, as a vector.
        force: Vector3<T>,
    },
}

/// Reactions to a load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reactions<T = f64> {
    /// Force of each constraint equation, in the order of the mechanism's constraints.
    pub constraints: [Reaction<T>; 5],
    /// Force of the support: spring force, positive in compression, or upward force at the wheel centre.
    pub support: T,
    /// Force of the support at the opposite wheel of a rigid axle. `None` for other suspensions.
    pub far_support: Option<T>,
    /// Tensions of drag link and tie rod of a steered axle. `None` for other suspensions.
    pub steering: Option<[T; 2]>,
    /// Forces in a twist beam. `None` for other suspensions.
    pub beam: Option<BeamForces<T>>,
    /// Tension in the pushrod or pullrod, if the support is a spring on a rocker.
    pub rod: Option<T>,
    /// Force of the support on the knuckle. If the spring, or the rod of its rocker, is mounted on an arm, this is the
    /// force that the arm transmits at its outer joint. The legs of this arm are then also loaded in bending. The force
    /// in the joint is the sum of this force and the forces of the legs.
    pub support_force: Vector3<T>,
}

/// Balance of forces in a pose, prepared for loads. The support (the spring, or a vertical force at the wheel centre) holds the
/// suspension in the pose. The equations are factorised once for any number of loads.
pub struct Balance<'a, T = f64> {
    pub(super) closure: &'a Closure<T>,
    pub(super) at: Configuration<'a, T>,
    /// Row of the support (spring, or vertical force at the wheel centre) in the equations.
    support: Wrench<T>,
    /// Tension in the rod of the spring's rocker per unit of spring force.
    rod_per_spring: Option<T>,
    /// True if the supports are forces at the wheel centres.
    pub(super) is_at_wheel: bool,
    pub(super) rows: Matrix6<T>,
    pub(super) factors: Lu6<f64>,
    work: &'a WorkCounter,
}

impl<'a, T: Balanced> Balance<'a, T> {
    /// Prepares the balance in a pose of a mechanism of this size. `None` if the support has no leverage. Also `None`
    /// if its leverage is so small that fewer than six digits of the forces would be correct.
    pub(crate) fn new(
        closure: &'a Closure<T>,
        at: Configuration<'a, T>,
        support: Support,
        size: f64,
        work: &'a WorkCounter,
    ) -> Option<Self> {
        let like = at.rack;
        let mut rows = [Wrench::zero(like); 6];
        for (wrench, row) in rows.iter_mut().zip(closure.rows()) {
            row.differential(&at, like.one(), wrench);
        }
        let mut rod_per_spring = None;
        let is_at_wheel = support == Support::WheelCentre;
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
                let up = Vector3::new(like.zero(), like.zero(), like.one());
                at.push_point(at.mechanism.wheel_centre, up, &mut rows[5]);
            }
        }
        let support_row = rows[5];
        if let Some(rigid) = &at.mechanism.rigid_axle {
            rows[FAR_ROW] = far_support(rigid, support, &at);
        }
        let support = support_row;
        work.note(|w| w.factorisations += 1);
        let rows = rows.each(Wrench::to_row);
        let factors = Lu6::new(rows.each(|row| row.each(T::value)), size)?;
        (!Conditioning::of(&factors, size).is_poor()).then_some(Balance {
            closure,
            at,
            support,
            rod_per_spring,
            is_at_wheel,
            rows,
            factors,
            work,
        })
    }

    /// Returns the position at which a load acts, given the contact point.
    pub fn place(&self, of: LoadPoint, contact: Vector3<T>) -> Vector3<T> {
        match of {
            LoadPoint::ContactPoint => contact,
            LoadPoint::WheelCentre => self.at.point(self.at.mechanism.wheel_centre),
        }
    }

    /// Forces of the five constraints, from the multipliers of their equations.
    pub(super) fn reactions(&self, multipliers: &Vector6<T>) -> [Reaction<T>; 5] {
        let zero = self.at.rack.zero();
        let mut reactions = [Reaction::Force {
            point: self.at.mechanism.origin,
            force: Vector3::new(zero, zero, zero),
        }; 5];
        let rows = self.closure.rows().iter().zip(multipliers);
        for (reaction, (row, multiplier)) in reactions.iter_mut().zip(rows) {
            *reaction = row.reaction(&self.at, *multiplier);
        }
        reactions
    }

    /// Computes the forces that balance a load.
    pub fn under(&self, load: &Load<T>) -> Reactions<T> {
        let like = self.at.rack;
        let (force, moment) = (
            load.point.constant(load.force),
            load.point.constant(load.moment),
        );
        let mut wrench = Wrench::zero(like);
        match self.at.steered_knuckle() {
            None => {
                let lever = load.point - self.at.pose.origin;
                wrench.wrench(force, lever.cross(force) + moment);
            }
            Some(knuckle) => {
                let centre = self.at.mechanism.wheel_centre;
                let lever = load.point - self.at.point(centre);
                self.at.push_point(centre, force, &mut wrench);
                let couple = lever.cross(force) + moment;
                self.at.push_rocker_turn(knuckle, couple, &mut wrench);
            }
        }
        self.work.note(|w| w.right_hand_sides += 1);
        let against = wrench.to_row().each(|c| -c);
        let multipliers = T::multipliers(Factors(&self.factors), &self.rows, against);
        let is_rigid = self.at.mechanism.rigid_axle.is_some();
        let far_support = is_rigid.then(|| multipliers[FAR_ROW]);
        let constraints = self.reactions(&multipliers);
        Reactions {
            beam: self.beam(&constraints, multipliers[FAR_ROW]),
            constraints,
            support: multipliers[5],
            far_support,
            steering: self.steering(load, multipliers[5], multipliers[FAR_ROW]),
            rod: self.rod_per_spring.map(|ratio| ratio * multipliers[5]),
            support_force: self.support.force * multipliers[5],
        }
    }

    /// Returns the value of one reaction. `None` if the mechanism has no such member, or for the rod of a spring that
    /// is not the support.
    pub fn force(&self, carried: &Reactions<T>, what: Carried) -> Option<T> {
        match what {
            Carried::Tension(inner, outer) => tension(&carried.constraints, inner, outer),
            Carried::Support(_) => Some(carried.support),
            Carried::FarSupport(_) => carried.far_support,
            Carried::Rod => carried.rod,
            Carried::WattRod(rocker) => self.watt_rod(rocker, carried),
            Carried::DragLink => carried.steering.map(|[drag_link, _]| drag_link),
            Carried::TieRod => carried.steering.map(|[_, tie_rod]| tie_rod),
            Carried::Beam(force) => carried.beam.as_ref().map(|forces| force.of(forces)),
            Carried::Force(point, axis) => {
                let [x, y, z] = self.force_at(point, carried).to_array();
                Some(match axis {
                    Axis::X => x,
                    Axis::Y => y,
                    Axis::Z => z,
                })
            }
        }
    }

    /// Returns the tension of the rod of a Watt rocker. The moment of this rod about the rocker's axis balances the moment of the
    /// axle's link on the same rocker.
    fn watt_rod(&self, rocker: RockerId, carried: &Reactions<T>) -> Option<T> {
        let is_on_it = |id: PointId| self.at.mechanism.body(id) == Body::Rocker(rocker);
        carried.constraints.iter().find_map(|reaction| {
            let Reaction::Rod {
                inner,
                outer,
                tension,
            } = *reaction
            else {
                return None;
            };
            let (on_it, off_it) = match (is_on_it(inner), is_on_it(outer)) {
                (true, _) => (inner, outer),
                (false, true) => (outer, inner),
                (false, false) => return None,
            };
            let place = self.at.point(on_it);
            let pull = (self.at.point(off_it) - place).normalised() * tension;
            Some(self.at.rod_tension(rocker, place, pull))
        })
    }

    /// Total force on the wheel carrier at a point.
    fn force_at(&self, point: PointId, carried: &Reactions<T>) -> Vector3<T> {
        let constraints = self.constraint_force(point, &carried.constraints);
        let joint = sprung_joint(self.at.mechanism).filter(|_| !self.is_at_wheel);
        if joint == Some(point) {
            constraints + carried.support_force
        } else {
            constraints
        }
    }
}

/// Returns the tension of the rod between two points. `None` if none of the equations describes the length of this rod.
pub(super) fn tension<T: Copy>(
    constraints: &[Reaction<T>; 5],
    from: PointId,
    to: PointId,
) -> Option<T> {
    constraints.iter().find_map(|reaction| match *reaction {
        Reaction::Rod {
            inner,
            outer,
            tension,
        }
        | Reaction::ArmEnd {
            inner,
            outer,
            tension,
            ..
        } => ((inner, outer) == (from, to)).then_some(tension),
        Reaction::Force { .. } => None,
    })
}

impl<T: Scalar> Row<T> {
    /// Returns the force that belongs to the multiplier of this equation.
    pub(super) fn reaction(&self, at: &Configuration<T>, multiplier: T) -> Reaction<T> {
        match self {
            Row::Link(row) => Reaction::Rod {
                inner: row.inner,
                outer: row.outer,
                tension: -multiplier,
            },
            Row::RockerEnd(row) => Reaction::Rod {
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
            Row::ArmEnd(row) => {
                let [force, passed] = row.forces(at).each(|force| force * multiplier);
                Reaction::ArmEnd {
                    inner: row.inner,
                    outer: row.outer,
                    tension: -multiplier,
                    force,
                    joint: row.joint_of_arm(at),
                    passed,
                }
            }
            // The support of the opposite wheel takes the row of the constant travel. No part of the mechanism carries
            // its force.
            Row::AxleTravel(row) => Reaction::Force {
                point: row.far(),
                force: at.spin_axis().zero(),
            },
        }
    }
}

impl Solver<'_> {
    /// Prepares a pose of this solver, with the rack at `rack`, for loads. Returns [`Failure::Singular`] if the support
    /// cannot carry a load.
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

/// Wrench of the support of the opposite wheel of a rigid axle.
fn far_support<T: Scalar>(rigid: &RigidAxle, support: Support, at: &Configuration<T>) -> Wrench<T> {
    let like = at.rack;
    let mut row = Wrench::zero(like);
    let far = |id: PointId| rigid.far_of(id).unwrap_or(id);
    match support {
        Support::Spring(spring) => {
            let [lower, upper] = [spring.lower, spring.upper].each(far);
            let along = (at.point(lower) - at.point(upper)).normalised();
            at.push_point(lower, along, &mut row);
            at.push_point(upper, -along, &mut row);
        }
        Support::WheelCentre => {
            let up = Vector3::new(like.zero(), like.zero(), like.one());
            at.push_point(rigid.far_centre, up, &mut row);
        }
    }
    row
}

//! Forces in constraints, rods and joints, if all external forces on a wheel are known.
//!
//! In addition to the load at the wheel, springs and bars act on arms, rockers or the carrier. By virtual work, each of
//! these forces is equivalent to a wrench on the carrier. The constraints balance the sum of all wrenches. In addition, a vertical
//! force at the wheel centre keeps the suspension from moving. If this force is zero, the known forces alone are in equilibrium
//! along the suspension's motion. So the `Balance` that computes these forces must have the support
//! [`Support::WheelCentre`](super::Support::WheelCentre).

use super::loads::{Balance, Balanced, Factors, Reaction, tension};
use crate::mechanism::Wrench;
use crate::mechanism::pose::Sink;
use crate::model::{ArmId, Body, Mechanism, PointId, RockerId, Rod};
use crate::number::{Each, Vector3};

/// A known force on a part of the suspension, in the kernel's frame (x forward, y left, z up, for a left wheel).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Applied<T = f64> {
    /// A force at a point of a part that moves.
    Point(PointId, Vector3<T>),
    /// A moment on a rocker, positive in the direction of the rocker's angle.
    Rocker(RockerId, T),
    /// A force at a point of the wheel carrier, with a moment.
    Carrier {
        /// Position of the point at which the force acts.
        point: Vector3<T>,
        /// Force on the carrier at this point.
        force: Vector3<T>,
        /// Moment on the carrier, in units of force times length.
        moment: Vector3<T>,
    },
}

/// Forces in the suspension that balance the known forces.
#[derive(Clone, Debug, PartialEq)]
pub struct Carrying<T = f64> {
    /// Reaction of each of the five constraint equations. Some constraints have two equations.
    pub constraints: [Reaction<T>; 5],
    /// Tension of the rod of each rocker.
    pub rods: Vec<T>,
    /// Force that each arm transmits at its outer joint because of known forces on the arm, such as the force of a
    /// spring or a rod.
    pub passed: Vec<Vector3<T>>,
    /// Vertical force at the wheel centre that is missing for equilibrium.
    pub lacking: T,
}

impl<T: Copy> Carrying<T> {
    /// Returns the tension of the rod or link from its inner to its outer end. `None` if none of the equations
    /// describes the length of this rod.
    pub fn tension(&self, from: PointId, to: PointId) -> Option<T> {
        tension(&self.constraints, from, to)
    }
}

/// Returns the body to which a force at a point is transmitted. If the point is not on a rocker, this is the body of
/// the point. A rocker transmits the force through its rod to the body at the rod's outer end. If several rockers and
/// rods form a chain, it is the body at the outer end of the last rod.
fn seat(mechanism: &Mechanism, id: PointId) -> Body {
    let last = mechanism.rockers_moving(id).last();
    mechanism.body(last.map_or(id, |rocker| mechanism.rocker(rocker).outer))
}

/// Returns true if an arm carries a spring, a rod, a link or a second joint to the knuckle.
pub fn bears(mechanism: &Mechanism, arm: ArmId) -> bool {
    let rods = mechanism.rockers.iter().map(|rocker| rocker.outer);
    let spring = mechanism.spring.map(|spring| spring.lower);
    let mut points = rods.chain(spring);
    let mut constraints = mechanism.constraints.iter();
    points.any(|id| mechanism.body(id) == Body::Arm(arm))
        || constraints.any(|constraint| mechanism.arm_under(constraint) == Some(arm))
}

impl<T: Balanced> Balance<'_, T> {
    /// Computes the forces that balance these known forces.
    pub fn under_all(&self, applied: &[Applied<T>]) -> Carrying<T> {
        let at = &self.at;
        let mechanism = at.mechanism;
        let zero = at.rack.zero();
        let nothing = Vector3::new(zero, zero, zero);
        let mut passed = vec![nothing; mechanism.arms.len()];
        let mut sum = Wrench::zero(zero);
        for force in applied {
            let mut wrench = Wrench::zero(zero);
            let body = match *force {
                Applied::Point(id, force) => {
                    at.push_point(id, force, &mut wrench);
                    seat(mechanism, id)
                }
                Applied::Rocker(id, moment) => {
                    at.push_rocker_angle(id, moment, &mut wrench);
                    seat(mechanism, mechanism.rocker(id).outer)
                }
                Applied::Carrier {
                    point,
                    force,
                    moment,
                } => {
                    let lever = point - at.pose.origin;
                    wrench.wrench(force, lever.cross(force) + moment);
                    Body::Knuckle
                }
            };
            if let Body::Arm(arm) = body {
                passed[arm.0] = passed[arm.0] + wrench.force;
            }
            sum.wrench(wrench.force, wrench.moment);
        }
        let against = sum.to_row().each(|c| -c);
        let multipliers = T::multipliers(Factors(&self.factors), &self.rows, against);
        Carrying {
            constraints: self.reactions(&multipliers),
            rods: self.rods(applied),
            passed,
            lacking: multipliers[5],
        }
    }

    /// Computes the tensions of the rods, from the moments about the axes of the rockers. The outer end of a rod may be
    /// on a rocker that comes earlier in the list.
    fn rods(&self, applied: &[Applied<T>]) -> Vec<T> {
        let at = &self.at;
        let mechanism = at.mechanism;
        let mut tensions = vec![at.rack.zero(); mechanism.rockers.len()];
        for number in (0..mechanism.rockers.len()).rev() {
            let id = RockerId(number);
            let mut tension = at.rack.zero();
            for force in applied {
                match *force {
                    Applied::Point(point, force) if mechanism.body(point) == Body::Rocker(id) => {
                        tension = tension + at.rod_tension(id, at.point(point), force);
                    }
                    Applied::Rocker(of, moment) if of == id => {
                        tension = tension + at.rod_tension_by_moment(id, moment);
                    }
                    _ => {}
                }
            }
            for (later, rocker) in mechanism.rockers.iter().enumerate().skip(number + 1) {
                if mechanism.body(rocker.outer) == Body::Rocker(id) {
                    let [inner, outer] = [rocker.inner, rocker.outer].each(|id| at.point(id));
                    let pull = (inner - outer).normalised() * tensions[later];
                    tension = tension + at.rod_tension(id, outer, pull);
                }
            }
            tensions[number] = tension;
        }
        tensions
    }

    /// Total force on the wheel carrier at the outer joint of an arm.
    pub fn joint_force(&self, arm: ArmId, carried: &Carrying<T>) -> Vector3<T> {
        let outer = self.at.mechanism.arms[arm.0].outer;
        let joint = carried.passed[arm.0];
        joint + self.constraint_force(outer, &carried.constraints)
    }

    /// Force of the constraints on the wheel carrier at a point.
    pub fn constraint_force(&self, point: PointId, constraints: &[Reaction<T>; 5]) -> Vector3<T> {
        let place = |id: PointId| self.at.point(id);
        let zero = self.at.rack.zero();
        let mut sum = Vector3::new(zero, zero, zero);
        for reaction in constraints {
            match *reaction {
                Reaction::Rod {
                    inner,
                    outer,
                    tension,
                } if outer == point => {
                    sum = sum + (place(inner) - place(outer)).normalised() * tension;
                }
                Reaction::ArmEnd { joint, passed, .. } if joint == point => sum = sum + passed,
                Reaction::ArmEnd { outer, force, .. } if outer == point => sum = sum + force,
                Reaction::Force { point: at, force } if at == point => sum = sum + force,
                _ => {}
            }
        }
        sum
    }

    /// Position of a point in the pose for which this balance was prepared.
    pub fn position(&self, id: PointId) -> Vector3<T> {
        self.at.point(id)
    }

    /// Unit vector from the upper to the lower end of the spring. `None` without a spring.
    pub fn spring_direction(&self) -> Option<Vector3<T>> {
        let spring = self.at.mechanism.spring?;
        Some((self.at.point(spring.lower) - self.at.point(spring.upper)).normalised())
    }
}

/// Returns the name under which the rod of a rocker is listed as a member.
pub fn rod_name(rod: Rod) -> String {
    rod.key().to_owned()
}

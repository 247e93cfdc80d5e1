//! Forces in the members of a car's suspensions in a load case.
//!
//! In a solved state, every force on a wheel is known. These are the tyre force at the contact point, the inertia force of
//! the wheel's mass, and the forces of springs and bars. The forces of links, rods and joints follow from the equilibrium of
//! each wheel ([`Applied`](crate::analyse::Applied)).

use super::equations::Balance;
use super::solver::{CarSolver, Equilibrium};
use super::{Car, Case, GRAVITY, NoEquilibrium, WheelPlace};
use crate::analyse::{Applied, Carried, Support, bears, members_of_constraints, rod_name};
use crate::axle::AxlePose;
use crate::mechanism::NoPose;
use crate::model::{ArmId, Axis, Mechanism, PointId, RockerId, Side};
use crate::number::{Each, Vector3};

/// Type of a force in the results, with the member of one wheel's suspension that transmits it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    /// Tension of the link between two points.
    Link(PointId, PointId),
    /// Force of the constraints at a point, which acts on the wheel carrier.
    Point(PointId, Axis),
    /// Force on the wheel carrier at the outer joint of an arm.
    Joint(ArmId, Axis),
    /// Tension of the rod of a rocker.
    Rod(RockerId),
    /// Force of the spring, positive in compression.
    Spring,
}

/// A force in the results.
#[derive(Clone, Debug, PartialEq)]
pub struct CarMember {
    /// Wheel of the member.
    pub place: WheelPlace,
    /// Name of the member, without the wheel.
    pub name: String,
    what: What,
}

/// Forces in the members of one wheel.
#[derive(Clone, Debug, PartialEq)]
pub struct WheelMembers {
    /// Forces of one wheel's members, in the order of [`CarMember::all`].
    pub forces: Vec<f64>,
    /// Unbalanced vertical force at the wheel centre. In a solved state, it is only rounding error.
    pub lacking: f64,
}

impl CarMember {
    /// Lists the members of all independently suspended wheels: front left, front right, rear left, rear right.
    pub fn all(car: &Car) -> Vec<CarMember> {
        let of_wheel = |place: WheelPlace| {
            let axle = &car.axles[place.0 / 2];
            let wheel = axle.suspension(Side::ALL[place.0 % 2]);
            let members = if axle.is_rigid() {
                Vec::new()
            } else {
                members(&wheel.mechanism)
            };
            let member = move |(name, what)| CarMember { place, name, what };
            members.into_iter().map(member)
        };
        WheelPlace::ALL.into_iter().flat_map(of_wheel).collect()
    }

    /// Returns the name with the wheel, such as `front_left_tie_rod`.
    pub fn label(&self) -> String {
        format!("{}_{}", self.place.name(), self.name)
    }

    /// Meaning of a positive value of the force.
    pub fn positive(&self) -> &'static str {
        match self.what {
            What::Link(..) | What::Rod(_) => "tension",
            What::Spring => "compression",
            What::Point(_, axis) | What::Joint(_, axis) => axis.force_on_carrier(),
        }
    }
}

/// Lists the members of one wheel: links, forces at points, the outer joint of every arm, rods, and the spring.
fn members(mechanism: &Mechanism) -> Vec<(String, What)> {
    let arms = || mechanism.arms.iter().enumerate();
    // If an arm carries a spring, a rod, a link or a second joint, its legs are in bending. A leg is the line from
    // the outer joint to a pivot. The list omits these legs, because the force along a leg is not the whole force on it.
    let is_bent = |outer: PointId| {
        let mut own = arms().filter(|(_, arm)| arm.outer == outer);
        own.any(|(k, _)| bears(mechanism, ArmId(k)))
    };
    let of_constraints = members_of_constraints(mechanism, is_bent);
    let of_constraints = of_constraints.into_iter().filter_map(|member| {
        let what = match member.what {
            Carried::Tension(inner, outer) => What::Link(inner, outer),
            Carried::Force(point, axis) => What::Point(point, axis),
            _ => return None,
        };
        Some((member.name, what))
    });
    let mut found: Vec<(String, What)> = of_constraints.collect();
    for (number, arm) in arms() {
        let name = mechanism.name(arm.outer);
        found.extend(Axis::ALL.map(|axis| {
            let what = What::Joint(ArmId(number), axis);
            (format!("{name}_{}", axis.name()), what)
        }));
    }
    for (number, rocker) in mechanism.rockers.iter().enumerate() {
        found.push((rod_name(rocker.rod), What::Rod(RockerId(number))));
    }
    if mechanism.spring.is_some() {
        found.push(("spring".to_owned(), What::Spring));
    }
    found
}

impl CarSolver<'_> {
    /// Computes the forces in the members of each wheel in a state: front left, front right, rear left, rear right. The
    /// list for a solid axle or twist beam is empty.
    pub fn members(
        &mut self,
        case: &Case,
        found: &Equilibrium,
    ) -> Result<[WheelMembers; 4], NoEquilibrium> {
        let state = self.balance(case, found)?;
        let placed = self.poses(found)?;
        let mut all = Vec::with_capacity(4);
        for place in WheelPlace::ALL {
            all.push(self.of_wheel(case, &placed[place.0 / 2], &state, place)?);
        }
        let all: Result<[WheelMembers; 4], _> = all.try_into();
        all.map_err(|_| NoEquilibrium::NotFound)
    }

    fn of_wheel(
        &self,
        case: &Case,
        placed: &AxlePose,
        state: &Balance<f64>,
        place: WheelPlace,
    ) -> Result<WheelMembers, NoEquilibrium> {
        let (number, axle) = (place.0, place.0 / 2);
        let side = Side::ALL[number % 2];
        let of_axle = &self.car.axles[axle];
        if of_axle.is_rigid() {
            return Ok(WheelMembers {
                forces: Vec::new(),
                lacking: 0.0,
            });
        }
        let mechanism = &of_axle.suspension(side).mechanism;
        let balance = self.axles[axle].balance(side, placed, Support::WheelCentre);
        let balance = balance.map_err(|failure| NoEquilibrium::NoPose {
            axle,
            failure: NoPose::Wheel {
                side,
                travel: placed.travels[side as usize],
                failure,
            },
        })?;
        let mut applied = self.on_carrier(case, state, place).to_vec();
        let spring_force = state.wheels[number].spring_force;
        if let (Some(spring), Some(along)) = (mechanism.spring, balance.spring_direction()) {
            applied.push(Applied::Point(spring.lower, along * spring_force));
            applied.push(Applied::Point(spring.upper, along * -spring_force));
        }
        let setup = &of_axle.setup;
        let sign = side.sign();
        if let (Some(bar), Some(_)) = (mechanism.anti_roll_bar(), setup.bar_rate) {
            applied.push(Applied::Rocker(bar, -sign * state.bars[axle]));
        }
        let forces = &state.rockers[axle];
        if let Some(rocker) = mechanism.spring_rocker() {
            if setup.rocker_springs.t_bar.is_some() {
                applied.push(Applied::Rocker(rocker, -sign * forces.t_bar));
            }
            if setup.rocker_springs.heave_bar.is_some() {
                applied.push(Applied::Rocker(rocker, -forces.heave_bar));
            }
        }
        if let (Some(end), Some(_)) = (mechanism.heave_spring(), setup.rocker_springs.heave_spring)
        {
            let [left, right] = [0, 1].each(|k| state.wheels[2 * axle + k].corner.rocker.end[0]);
            // Vector from the other end of the heave spring to this wheel's end, in the frame of this wheel.
            let apart = match side {
                Side::Left => Vector3::new(left.x - right.x, left.y + right.y, left.z - right.z),
                Side::Right => Vector3::new(right.x - left.x, left.y + right.y, right.z - left.z),
            };
            applied.push(Applied::Point(
                end,
                apart.normalised() * forces.heave_spring,
            ));
        }
        let carried = balance.under_all(&applied);
        let frame = of_axle.frame(side);
        let along = |force: Vector3<f64>, axis: Axis| frame.sign(axis) * force[axis];
        let value = |(_, what): (String, What)| match what {
            What::Link(inner, outer) => carried.tension(inner, outer).unwrap_or(f64::NAN),
            What::Point(point, axis) => {
                along(balance.constraint_force(point, &carried.constraints), axis)
            }
            What::Joint(arm, axis) => along(balance.joint_force(arm, &carried), axis),
            What::Rod(rocker) => carried.rods[rocker.0],
            What::Spring => spring_force,
        };
        Ok(WheelMembers {
            forces: members(mechanism).into_iter().map(value).collect(),
            lacking: carried.lacking,
        })
    }

    /// Returns the forces of the tyre and the inertia force of the wheel's mass, in the frame of the wheel.
    fn on_carrier(&self, case: &Case, state: &Balance<f64>, place: WheelPlace) -> [Applied; 3] {
        let number = place.0;
        let wheel = &state.wheels[number];
        let road = &state.road;
        let axle = number / 2;
        let sign = Side::ALL[number % 2].sign();
        let origin = match axle {
            0 => Vector3::default(),
            _ => self.car.rear_offset,
        };
        let own = |v: Vector3<f64>| Vector3::new(v.x, sign * v.y, v.z);
        let nothing = Vector3::default();
        let across = road.up * wheel.load + wheel.across * wheel.side_force;
        let push = wheel.heading * wheel.longitudinal_force;
        let setting = &case.setting;
        let moment = if self.car.carrier_takes_torque(axle, setting.longitudinal) {
            nothing
        } else {
            // Shafts transmit the torque about the spin axis to the body. So this moment removes the torque from the
            // carrier.
            let spin = wheel.corner.spin;
            let lever = wheel.contact - wheel.corner.centre;
            spin * -spin.dot(lever.cross(push))
        };
        let acceleration = road.forward * case.ax + road.left * case.ay + road.up * (1.0 + case.az);
        let unsprung = self.car.axles[axle].setup.unsprung_mass.unwrap_or(0.0);
        let at =
            |point: Vector3<f64>, force: Vector3<f64>, moment: Vector3<f64>| Applied::Carrier {
                point: own(point - origin),
                force: own(force),
                // A moment is an axial vector, so a reflection also changes its sign.
                moment: own(moment) * sign,
            };
        [
            at(wheel.contact, across, nothing),
            at(wheel.contact, push, moment),
            at(
                wheel.corner.centre,
                acceleration * (-0.5 * GRAVITY * unsprung),
                nothing,
            ),
        ]
    }
}

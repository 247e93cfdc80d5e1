//! Forces that links, joints, bushings and springs transmit in an equilibrium.
//!
//! `gather.rs` sums the forces of all parts on the carrier, with the opposite sign. This module keeps the force of each
//! part separately. These forces are in balance with the loads on the carrier. A link with bushings is a rigid body,
//! and no load acts between its ends. Its tension is the component of its force on the carrier along its line.

use super::build::{Built, JointPlace, LimbPlace};
use super::ground::{Holder, Surroundings};
use super::limb::{Beside, Sum};
use super::system::{Limb, State};
use super::wheel::{BushingReading, ElasticWheel, Equilibrium};
use crate::ask::Unit;
use crate::model::{Axis, Mechanism, PointId};
use crate::number::Vector3;

/// Part or joint whose force is in the results.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum MemberPart {
    /// Tension of a rigid rod, with the index of its joint.
    Rod(usize),
    /// Tension of a rod with axial stiffness, with its index.
    ElasticRod(usize),
    /// Tension of a link with bushings, with the index of the link among the parts with their own degrees of freedom.
    Link(usize),
    /// Component of the force on the wheel carrier at a joint.
    Joint(PointId, Axis),
    /// Component of a bushing's force along an axis of the bushing.
    Force(usize, Axis),
    /// Component of a bushing's torque about an axis of the bushing.
    Torque(usize, Axis),
    /// Tension of the rod between suspension and rocker.
    RockerRod,
    /// Force of the spring.
    Spring,
}

/// Force of one part of the suspension, as it appears in the results.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ElasticMember {
    /// Name of the force, which follows the name of the load in a column name.
    pub(crate) name: String,
    pub(crate) part: MemberPart,
    /// True for the tension of a link that the axle has only once.
    pub(crate) is_single: bool,
}

impl ElasticMember {
    pub(crate) fn unit(&self) -> Unit {
        match self.part {
            MemberPart::Torque(..) => Unit::Torque,
            _ => Unit::Force,
        }
    }

    /// Meaning of a positive value of the force or torque.
    pub(crate) fn positive(&self) -> &'static str {
        match self.part {
            MemberPart::Rod(_)
            | MemberPart::ElasticRod(_)
            | MemberPart::Link(_)
            | MemberPart::RockerRod => "tension",
            MemberPart::Joint(_, axis) => axis.force_on_carrier(),
            MemberPart::Force(..) => "on the arm, link or mount along the bushing's axis",
            MemberPart::Torque(..) => "on the arm, link or mount about the bushing's axis",
            MemberPart::Spring => "compression",
        }
    }

    /// Axis of the vehicle for a force component; `None` for other forces.
    pub(crate) fn axis(&self) -> Option<Axis> {
        match self.part {
            MemberPart::Joint(_, axis) => Some(axis),
            _ => None,
        }
    }
}

/// Forces of all parts of a wheel, in the kernel's frame of the wheel's side.
#[derive(Clone, Debug)]
pub(crate) struct CarriedForces {
    joints: Vec<f64>,
    elastic_rods: Vec<f64>,
    links: Vec<f64>,
    /// Forces on the carrier with the points where they act.
    at_points: Vec<(PointId, Vector3<f64>)>,
    bushings: Vec<BushingReading>,
    rocker_rod: Option<f64>,
    spring: Option<f64>,
}

impl CarriedForces {
    /// Returns the force of a part. `None` if the state has no such part; 0 for a joint at which no part acts.
    pub(crate) fn of(&self, part: &MemberPart) -> Option<f64> {
        match *part {
            MemberPart::Rod(number) => self.joints.get(number).copied(),
            MemberPart::ElasticRod(number) => self.elastic_rods.get(number).copied(),
            MemberPart::Link(number) => self.links.get(number).copied(),
            MemberPart::Joint(point, axis) => {
                let here = self.at_points.iter().filter(|(at, _)| *at == point);
                Some(here.map(|(_, force)| force[axis]).sum())
            }
            MemberPart::Force(number, axis) => {
                self.bushings.get(number).map(|found| found.force[axis])
            }
            MemberPart::Torque(number, axis) => {
                self.bushings.get(number).map(|found| found.torque[axis])
            }
            MemberPart::RockerRod => self.rocker_rod,
            MemberPart::Spring => self.spring,
        }
    }
}

impl Built<f64> {
    /// Returns all parts whose forces are in the results: rods and links, then joints, bushings, the rod of the spring's
    /// rocker, and the spring.
    /// `bushings` contains the names of the bushings, in the order of their readings.
    pub(crate) fn members(&self, mechanism: &Mechanism, bushings: &[String]) -> Vec<ElasticMember> {
        let places = &self.places;
        let mut members = Vec::new();
        let member = |name: String, part, is_single| ElasticMember {
            name,
            part,
            is_single,
        };
        let tension = |inner: PointId, part| {
            let is_single = mechanism.is_single(inner);
            member(mechanism.link_name(inner).to_owned(), part, is_single)
        };
        let mut joints: Vec<(PointId, &str)> = Vec::new();
        for (number, place) in places.joints.iter().enumerate() {
            match *place {
                JointPlace::Rod { inner, outer } => {
                    if !self.is_bent(outer) {
                        members.push(tension(inner, MemberPart::Rod(number)));
                    }
                }
                JointPlace::Line(top) => joints.push((top, "strut_side")),
                JointPlace::Pin(point) => joints.push((point, mechanism.name(point))),
                JointPlace::Pivot { .. } => {}
            }
        }
        for (number, [inner, outer]) in places.rods.iter().enumerate() {
            if !self.is_bent(*outer) {
                members.push(tension(*inner, MemberPart::ElasticRod(number)));
            }
        }
        for (number, place) in places.limbs.iter().enumerate() {
            if let LimbPlace::Link { inner, .. } = place {
                members.push(tension(*inner, MemberPart::Link(number)));
            }
        }
        joints.dedup();
        let of_links = places.limbs.iter().filter_map(|place| match *place {
            LimbPlace::Link { outer, .. } => Some(outer),
            _ => None,
        });
        joints.extend(of_links.map(|id| (id, mechanism.name(id))));
        let of_arms = mechanism.arms.iter().map(|arm| arm.outer);
        let holds = |point: &PointId| self.outer_points().any(|outer| outer == *point);
        joints.extend(of_arms.filter(holds).map(|id| (id, mechanism.name(id))));
        for (point, name) in joints {
            members.extend(Axis::ALL.map(|axis| {
                let name = format!("{name}_{}", axis.name());
                member(name, MemberPart::Joint(point, axis), false)
            }));
        }
        for (number, name) in bushings.iter().enumerate().take(self.bushings.len()) {
            let of = |word: &str, part: &dyn Fn(usize, Axis) -> MemberPart| {
                Axis::ALL.map(|axis| {
                    let name = format!("{name}_{word}_{}", axis.name());
                    member(name, part(number, axis), false)
                })
            };
            members.extend(of("force", &MemberPart::Force));
            members.extend(of("torque", &MemberPart::Torque));
        }
        if let Some(rod) = places.rocker_rod {
            members.push(member(rod.key().to_owned(), MemberPart::RockerRod, false));
        }
        if places.has_spring {
            members.push(member("spring".to_owned(), MemberPart::Spring, false));
        }
        members
    }

    /// Hardpoints at which parts hold the carrier.
    fn outer_points(&self) -> impl Iterator<Item = PointId> + '_ {
        let places = &self.places;
        let joints = places.joints.iter().map(|place| place.point());
        let rods = places.rods.iter().map(|[_, outer]| *outer);
        let limbs = places.limbs.iter().filter_map(|place| place.point());
        joints.chain(rods).chain(limbs)
    }

    /// Returns true for the outer joint of an arm without bushings that a spring or a drop link bends.
    fn is_bent(&self, joint: PointId) -> bool {
        let is_seat = |place: &LimbPlace| *place == LimbPlace::Seat(Some(joint));
        self.places.bar == Some(joint) || self.places.limbs.iter().any(is_seat)
    }

    /// Forces of all parts in a state.
    pub(super) fn member_forces(
        &self,
        state: &State<f64>,
        around: &Surroundings<f64>,
    ) -> Option<CarriedForces> {
        let (system, places) = (&self.system, &self.places);
        let frames = system.frames(&state.carrier, around, false);
        let turned = |holder: Holder, force: Vector3<f64>| match holder {
            Holder::Body => force,
            Holder::Subframe => around.subframe.rotation().apply(force),
        };
        let on_carrier = |sum: &Sum<f64>| {
            let [x, y, z, ..] = sum.force;
            Vector3::new(-x, -y, -z)
        };
        let mut at_points = Vec::new();
        let mut links = vec![f64::NAN; system.limbs.len()];
        for (k, limb) in system.limbs.iter().enumerate() {
            let holder = system.holders.limbs[k];
            let at = frames.of(holder);
            let mut sum = Sum::zero(0.0);
            let mut beside = limb.has_beside().then(|| Beside::zero(0.0));
            let own = &state.limbs[k];
            limb.evaluate(at, own, &[0.0; 7], &mut sum, beside.as_mut())?;
            let force = on_carrier(&sum);
            if let LimbPlace::Link { .. } = places.limbs[k] {
                let inward = match limb {
                    Limb::Swinging(link) => link.ends.first().map(|e| own.placed.lever(e.lever)),
                    Limb::Floating(link) => Some(-own.placed.lever(link.along)),
                    _ => None,
                };
                links[k] = force.dot(inward?.normalised());
            }
            at_points.extend(
                places.limbs[k]
                    .point()
                    .map(|point| (point, turned(holder, force))),
            );
        }
        let mut elastic_rods = Vec::new();
        for (k, rod) in system.rods.iter().enumerate() {
            let holder = system.holders.rods[k];
            let (at, [rate, tension]) = (frames.of(holder), rod.elastic?);
            let line = rod.line(at);
            let pull = tension + rate * line.stretch;
            elastic_rods.push(pull);
            let [_, outer] = places.rods[k];
            at_points.push((outer, turned(holder, -(line.direction * pull))));
        }
        for (k, joint) in system.joints.iter().enumerate() {
            let holder = system.holders.joints[k];
            let mut sum = Sum::zero(0.0);
            joint.evaluate(frames.of(holder), state.joints[k], &mut sum);
            at_points.push((places.joints[k].point(), turned(holder, on_carrier(&sum))));
        }
        if let Some(bar) = &system.bar {
            let (mut sum, mut beside) = (Sum::zero(0.0), Beside::zero(0.0));
            bar.evaluate(frames.of(system.bar_on), &mut sum, &mut beside);
            let force = turned(system.bar_on, on_carrier(&sum));
            at_points.extend(places.bar.map(|point| (point, force)));
        }
        Some(CarriedForces {
            joints: state.joints[..system.joints.len()].to_vec(),
            elastic_rods,
            links,
            at_points,
            bushings: self.bushing_readings(state, around),
            rocker_rod: system.rocker_rod(&frames, state),
            spring: self.spring_reading(state, around).map(|found| found.force),
        })
    }
}

impl ElasticWheel {
    /// Returns the parts whose forces are in the results.
    pub(crate) fn members(&self, mechanism: &Mechanism, bushings: &[String]) -> Vec<ElasticMember> {
        self.built.members(mechanism, bushings)
    }

    /// Returns the forces of all parts in an equilibrium.
    pub(crate) fn member_forces(&self, at: &Equilibrium) -> Option<CarriedForces> {
        self.built.member_forces(&at.solution.state, &at.around())
    }
}

//! The system of one design: elastic parts at their hardpoints.

use super::bushing::Bushing;
use super::definition::{AxialStiffness, Compliance, LinkMember};
use super::floating::Floating;
use super::law::Law;
use super::loads::WheelPart;
use super::parts::{CarrierSeat, Joint, LegSeat, Mount, RodPart};
use super::point::{RockerSeat, Seat};
use super::swinging::{End, Swinging};
use super::system::{CarrierBushing, Limb, System};
use crate::derive::DesignedSpinAxis;
use crate::model::{Arm, Body, Constraint, Mechanism, PointId};
use crate::number::{Matrix3, Scalar, Vector3};

/// Place of one of the definition's bushings in the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BushingPlace {
    /// An end of a part with inner unknowns.
    Limb {
        /// Number of the part.
        limb: usize,
        /// Number of the end.
        end: usize,
    },
    /// The top mount of the strut.
    Mount(usize),
    /// Between body and carrier.
    Carrier(usize),
}

/// Place of one of the definition's links in the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LinkPlace {
    /// A rod of the carrier's.
    Rod(usize),
    /// The rod of the rocker at the spring's seat.
    RockerRod,
}

/// A system with the places of the study's parts in it.
#[derive(Clone, Debug)]
pub(super) struct Built<T> {
    pub(super) system: System<T>,
    pub(super) bushings: Vec<BushingPlace>,
    pub(super) links: Vec<LinkPlace>,
    /// Names of the limbs, for messages.
    pub(super) names: Vec<String>,
}

/// Builds a system step by step.
struct Builder<'a, T> {
    mechanism: &'a Mechanism,
    design: &'a [Vector3<T>],
    compliance: &'a Compliance<T>,
    system: System<T>,
    bushings: Vec<Option<BushingPlace>>,
    links: Vec<Option<LinkPlace>>,
    names: Vec<String>,
    /// Constraints that elastic parts take the place of.
    replaced: Vec<bool>,
}

/// An arm with a bushing, or the joints of an arm: (front, rear), in that order.
fn ends(arm: &Arm) -> [PointId; 2] {
    [arm.front, arm.rear]
}

impl<T: Scalar> Built<T> {
    /// The elastic suspension of a design. The mechanism has the joints that the definition expects of it
    /// (`study::compliance` sees to that).
    pub(super) fn of(
        mechanism: &Mechanism,
        design: &[Vector3<T>],
        radius: f64,
        compliance: &Compliance<T>,
    ) -> Self {
        let origin = design[mechanism.origin.0];
        let wheel = WheelPart {
            centre: design[mechanism.wheel_centre.0] - origin,
            spin_axis: DesignedSpinAxis::of(mechanism, design).direction,
            radius,
        };
        let mut builder = Builder {
            mechanism,
            design,
            compliance,
            system: System {
                limbs: Vec::new(),
                bushings: Vec::new(),
                rods: Vec::new(),
                joints: Vec::new(),
                wheel,
            },
            bushings: vec![None; compliance.bushings.len()],
            links: vec![None; compliance.links.len()],
            names: Vec::new(),
            replaced: vec![false; mechanism.constraints.len()],
        };
        let arms = builder.arms();
        builder.constraints();
        builder.spring(&arms);
        Built {
            system: builder.system,
            bushings: builder.bushings.into_iter().flatten().collect(),
            links: builder.links.into_iter().flatten().collect(),
            names: builder.names,
        }
    }
}

impl<T: Scalar> Builder<'_, T> {
    fn at(&self, id: PointId) -> Vector3<T> {
        self.design[id.0]
    }

    /// A point, from the carrier's reference point.
    fn on_carrier(&self, id: PointId) -> Vector3<T> {
        self.at(id) - self.at(self.mechanism.origin)
    }

    fn is_on_rack(&self, id: PointId) -> bool {
        self.mechanism.body(id) == Body::Rack
    }

    fn up(&self) -> Vector3<T> {
        let zero = self.at(self.mechanism.origin).x.zero();
        Vector3::new(zero, zero, zero.one())
    }

    /// Axes as columns: x as given or along the default, z the part of the vertical or of the given direction that is
    /// normal to it.
    fn axes(&self, number: usize, default: Vector3<T>) -> Matrix3<T> {
        let part = &self.compliance.bushings[number];
        let x = part.x_axis.unwrap_or(default).normalised();
        let z = part.z_axis.unwrap_or(self.up()).across(x).normalised();
        Matrix3 {
            columns: [x, z.cross(x), z],
        }
    }

    fn bushing(&self, number: usize, axes: Matrix3<T>) -> Bushing<T> {
        let part = &self.compliance.bushings[number];
        Bushing {
            axes,
            laws: std::array::from_fn(|k| Law::new(part.shapes[k].clone(), part.preload[k])),
        }
    }

    /// Arms with a bushing. Returns the limb of each arm.
    fn arms(&mut self) -> Vec<Option<usize>> {
        let arms = self.mechanism.arms.clone();
        let hinged = self
            .mechanism
            .constraints
            .iter()
            .any(|c| matches!(c, Constraint::Revolute { .. }));
        let mut limbs = vec![None; arms.len()];
        if hinged {
            return limbs;
        }
        for (k, arm) in arms.iter().enumerate() {
            let numbers = ends(arm).map(|id| self.compliance.bushing_at(id));
            if numbers == [None, None] {
                continue;
            }
            for (c, constraint) in self.mechanism.constraints.iter().enumerate() {
                let of_arm =
                    matches!(constraint, Constraint::Link { outer, .. } if *outer == arm.outer);
                self.replaced[c] |= of_arm;
            }
            let limb = self.system.limbs.len();
            let along = self.at(arm.front) - self.at(arm.rear);
            let mut parts = Vec::new();
            for (end, (id, number)) in ends(arm).into_iter().zip(numbers).enumerate() {
                let bushing = number.map(|number| {
                    self.bushings[number] = Some(BushingPlace::Limb { limb, end });
                    self.bushing(number, self.axes(number, along))
                });
                parts.push(self.end(id, arm.outer, bushing));
            }
            self.system.limbs.push(Limb::Swinging(Swinging {
                joint: self.on_carrier(arm.outer),
                ends: parts,
                seat: None,
                spin: None,
            }));
            let is_arm = |body: &Body| matches!(body, Body::Arm(id) if id.0 == k);
            let mut bodies = self.mechanism.bodies.iter();
            let name = bodies.find(|(_, body)| is_arm(body));
            self.names
                .push(name.map_or("arm", |(name, _)| name).to_owned());
            limbs[k] = Some(limb);
        }
        limbs
    }

    /// An end of a part whose reference point is the joint `outer`. A ball joint becomes a rigid rod besides.
    fn end(&mut self, id: PointId, outer: PointId, bushing: Option<Bushing<T>>) -> End<T> {
        let lever = self.at(id) - self.at(outer);
        if bushing.is_none() {
            self.system.joints.push(Joint::Rod(RodPart {
                joint: self.on_carrier(outer),
                along: -lever,
                on_rack: self.is_on_rack(id),
                elastic: None,
            }));
        }
        End {
            lever,
            on_rack: self.is_on_rack(id),
            bushing,
            normals: normals(lever),
        }
    }

    fn constraints(&mut self) {
        for (c, constraint) in self.mechanism.constraints.clone().into_iter().enumerate() {
            if self.replaced[c] {
                continue;
            }
            match constraint {
                Constraint::Link { inner, outer } => self.link(inner, outer),
                Constraint::StrutLine { top, lower, upper } => self.strut(top, lower, upper),
                Constraint::Revolute { first, second } => self.hinge(first, second),
                Constraint::BallJoint { at } => self.ball_joint(at),
                // Studies refuse elastic parts of these.
                Constraint::AxleTravel { .. }
                | Constraint::Mount { .. }
                | Constraint::ArmJoint { .. } => {}
            }
        }
    }

    fn link(&mut self, inner: PointId, outer: PointId) {
        let along = self.at(outer) - self.at(inner);
        let at_inner = self.compliance.bushing_at(inner);
        let at_outer = self.compliance.bushing_at(outer);
        let limb = self.system.limbs.len();
        let name = self.mechanism.link_name(inner).to_owned();
        let rates = [at_inner, at_outer].into_iter().flatten();
        let slope = rates
            .flat_map(|number| self.compliance.bushings[number].shapes.iter().take(3))
            .fold(along.x.zero(), |sum, shape| sum + shape.slope(along.x));
        // Any stiffness about the link's line does: nothing turns it.
        let spin = along * slope.lit(slope.value().sqrt().max(1.0));
        match (at_inner, at_outer) {
            (None, None) => self.rod(inner, outer, along),
            (Some(number), None) => {
                self.bushings[number] = Some(BushingPlace::Limb { limb, end: 0 });
                let bushing = self.bushing(number, self.axes(number, along));
                let end = self.end(inner, outer, Some(bushing));
                self.system.limbs.push(Limb::Swinging(Swinging {
                    joint: self.on_carrier(outer),
                    ends: vec![end],
                    seat: None,
                    spin: Some(spin),
                }));
                self.names.push(name);
            }
            (at_inner, Some(number)) => {
                self.bushings[number] = Some(BushingPlace::Limb { limb, end: 1 });
                let outer_bushing = self.bushing(number, self.axes(number, along));
                let inner_bushing = at_inner.map(|number| {
                    self.bushings[number] = Some(BushingPlace::Limb { limb, end: 0 });
                    self.bushing(number, self.axes(number, along))
                });
                self.system.limbs.push(Limb::Floating(Floating {
                    along,
                    on_rack: self.is_on_rack(inner),
                    inner: inner_bushing,
                    outer: outer_bushing,
                    joint: self.on_carrier(outer),
                    spin,
                }));
                self.names.push(name);
            }
        }
    }

    fn rod(&mut self, inner: PointId, outer: PointId, along: Vector3<T>) {
        let member = LinkMember::Rod { inner, outer };
        let mut rod = RodPart {
            joint: self.on_carrier(outer),
            along,
            on_rack: self.is_on_rack(inner),
            elastic: None,
        };
        match self.compliance.link(member) {
            None => self.system.joints.push(Joint::Rod(rod)),
            Some(stiffness) => {
                rod.elastic = Some([rate(stiffness, along), along.x.zero()]);
                self.place_link(member, LinkPlace::Rod(self.system.rods.len()));
                self.system.rods.push(rod);
            }
        }
    }

    fn place_link(&mut self, member: LinkMember, place: LinkPlace) {
        let links = self.compliance.links.iter();
        for (part, known) in links.zip(&mut self.links) {
            if part.member == member {
                *known = Some(place);
            }
        }
    }

    fn strut(&mut self, top: PointId, lower: PointId, upper: Option<PointId>) {
        let from = upper.unwrap_or(top);
        let along = (self.at(from) - self.at(lower)).normalised();
        match self.compliance.bushing_at(top) {
            None => {
                for normal in normals(along) {
                    let top = self.on_carrier(top);
                    self.system.joints.push(Joint::Line { normal, top });
                }
            }
            Some(number) => {
                self.bushings[number] = Some(BushingPlace::Mount(self.system.limbs.len()));
                // z up the strut, x forward.
                let part = &self.compliance.bushings[number];
                let one = along.x.one();
                let forward = Vector3::new(one, one.zero(), one.zero());
                let z = part.z_axis.unwrap_or(along).normalised();
                let x = part.x_axis.unwrap_or(forward).across(z);
                let x = x.normalised();
                let axes = Matrix3 {
                    columns: [x, z.cross(x), z],
                };
                let law = self.compliance.spring.as_ref();
                self.system.limbs.push(Limb::Mount(Mount {
                    top: self.on_carrier(top),
                    along,
                    spring_line: self.at(top) - self.at(lower),
                    bushing: self.bushing(number, axes),
                    spring: law.cloned(),
                }));
                self.names.push("strut".to_owned());
            }
        }
    }

    /// A ball joint of the carrier at the body. It is rigid: it has no place for a bushing.
    fn ball_joint(&mut self, at: PointId) {
        let lever = self.on_carrier(at);
        let (one, zero) = (lever.x.one(), lever.x.zero());
        for direction in [
            Vector3::new(one, zero, zero),
            Vector3::new(zero, one, zero),
            Vector3::new(zero, zero, one),
        ] {
            self.system.joints.push(Joint::Pin { lever, direction });
        }
    }

    fn hinge(&mut self, first: PointId, second: PointId) {
        let along = self.at(second) - self.at(first);
        let numbers = [first, second].map(|id| self.compliance.bushing_at(id));
        let one = along.x.one();
        let zero = one.zero();
        let axes = [
            Vector3::new(one, zero, zero),
            Vector3::new(zero, one, zero),
            Vector3::new(zero, zero, one),
        ];
        for (k, (id, number)) in [first, second].into_iter().zip(numbers).enumerate() {
            let lever = self.on_carrier(id);
            match number {
                Some(number) => {
                    self.bushings[number] = Some(BushingPlace::Carrier(self.system.bushings.len()));
                    let bushing = self.bushing(number, self.axes(number, along));
                    self.system.bushings.push(CarrierBushing { lever, bushing });
                }
                // Two rigid joints on one line: the second one may not hold along it again.
                None if numbers == [None, None] && k == 1 => {
                    for direction in normals(along) {
                        self.system.joints.push(Joint::Pin { lever, direction });
                    }
                }
                None => {
                    for direction in axes {
                        self.system.joints.push(Joint::Pin { lever, direction });
                    }
                }
            }
        }
    }

    /// The spring, where it has a law: on the part that carries its seat.
    fn spring(&mut self, arms: &[Option<usize>]) {
        let (Some(spring), Some(law)) = (self.mechanism.spring, &self.compliance.spring) else {
            return;
        };
        let in_strut = self
            .system
            .limbs
            .iter()
            .any(|l| matches!(l, Limb::Mount(_)));
        if in_strut && self.mechanism.body(spring.upper) == Body::Chassis {
            return;
        }
        let law = law.clone();
        let mut point = spring.lower;
        let rocker = match self.mechanism.body(spring.lower) {
            Body::Rocker(id) => {
                let rocker = self.mechanism.rocker(id);
                point = rocker.outer;
                let member = LinkMember::RockerRod(id);
                let along = self.at(rocker.inner) - self.at(rocker.outer);
                let stiffness = self.compliance.link(member);
                let rod = stiffness.map(|stiffness| [rate(stiffness, along), along.x.zero()]);
                if rod.is_some() {
                    self.place_link(member, LinkPlace::RockerRod);
                }
                Some(RockerSeat {
                    axis: [self.at(rocker.first), self.at(rocker.second)],
                    inner: self.at(rocker.inner),
                    spring: self.at(spring.lower),
                    rod,
                })
            }
            _ => None,
        };
        let seat = Seat {
            point: self.at(point),
            upper: self.at(spring.upper),
            law,
            rocker,
        };
        match self.mechanism.body(point) {
            Body::Arm(id) => {
                let arm = self.mechanism.arms[id.0];
                match arms[id.0] {
                    Some(limb) => {
                        let lever = self.at(point) - self.at(arm.outer);
                        if let Limb::Swinging(swinging) = &mut self.system.limbs[limb] {
                            swinging.seat = Some((lever, seat));
                        }
                    }
                    None => self.leg_seat(&arm, point, seat),
                }
            }
            _ => {
                let lever = self.on_carrier(point);
                self.system
                    .limbs
                    .push(Limb::CarrierSeat(CarrierSeat { lever, seat }));
                self.names.push("spring".to_owned());
            }
        }
    }

    fn leg_seat(&mut self, arm: &Arm, point: PointId, seat: Seat<T>) {
        let front = self.at(arm.front);
        let axis = (self.at(arm.rear) - front).normalised();
        let radius = (self.at(arm.outer) - front).across(axis);
        let radial = radius.normalised();
        let from_axis = self.at(point) - front;
        self.system.limbs.push(Limb::LegSeat(LegSeat {
            joint: self.on_carrier(arm.outer),
            axis,
            radius,
            place: [radial.dot(from_axis), axis.cross(radial).dot(from_axis)],
            seat,
        }));
        self.names.push("spring".to_owned());
    }
}

/// The axial stiffness of a link of this length.
fn rate<T: Scalar>(stiffness: &AxialStiffness<T>, along: Vector3<T>) -> T {
    match stiffness {
        AxialStiffness::Rate(rate) => *rate,
        AxialStiffness::PerStrain(force) => *force / along.norm(),
    }
}

/// Two unit vectors normal to a vector and to each other.
fn normals<T: Scalar>(v: Vector3<T>) -> [Vector3<T>; 2] {
    let [x, y, z] = v.to_array().map(|c| c.value().abs());
    let (zero, one) = (v.x.zero(), v.x.one());
    let least = if x <= y && x <= z {
        Vector3::new(one, zero, zero)
    } else if y <= z {
        Vector3::new(zero, one, zero)
    } else {
        Vector3::new(zero, zero, one)
    };
    let first = v.cross(least).normalised();
    [first, v.cross(first).normalised()]
}

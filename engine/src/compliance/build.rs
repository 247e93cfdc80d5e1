//! Builds the system of one design: the elastic parts at their hardpoints.

mod places;
mod seats;

use super::bushing::Bushing;
use super::definition::{AxialStiffness, Compliance, LinkMember, Subframe, strut_line};
use super::floating::Floating;
use super::ground::{Holder, Holders};
use super::law::{Law, Shape};
use super::loads::WheelPart;
use super::parts::{Joint, Mount, RodPart};
use super::swinging::{End, Swinging};
use super::system::{CarrierBushing, Limb, System};
use crate::derive::DesignedSpinAxis;
use crate::model::{Arm, Body, Constraint, Mechanism, PointId};
use crate::number::{Each, Matrix3, Scalar, Vector3};
pub(super) use places::{BushingPlace, JointPlace, LimbPlace, LinkPlace, Places};

/// System of equations, with the location of each part of the study in this system.
#[derive(Clone, Debug)]
pub(super) struct Built<T> {
    pub(super) system: System<T>,
    /// Reference point of the carrier in the design position.
    pub(super) reference: Vector3<T>,
    pub(super) bushings: Vec<BushingPlace>,
    /// Place of each link in the system, in the order of the definition. `None` for the rod of a rocker whose spring has
    /// no law.
    pub(super) links: Vec<Option<LinkPlace>>,
    /// Names of the parts with their own degrees of freedom, for messages.
    pub(super) names: Vec<String>,
    pub(super) places: Places,
}

/// Parts of an axle that are connected to the parts of the wheel.
#[derive(Clone, Copy, Debug)]
pub(super) struct OfAxle<'a, T> {
    pub(super) subframe: Option<&'a Subframe<T>>,
    /// Rate of the anti-roll bar: torque per difference of the angles of its levers.
    pub(super) bar_rate: Option<T>,
    /// Half of a solid axle on the side of this wheel; `None` for an independently suspended wheel.
    pub(super) half: Option<HalfOfAxle>,
}

/// Half of a body that carries both wheels (solid axle).
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfOfAxle {
    /// Reference point of the body, in the axes of this side.
    pub(super) reference: Vector3<f64>,
    /// True for the half that contains the links in the middle of the axle.
    pub(super) has_singles: bool,
}

/// Builder that assembles a system step by step.
struct Builder<'a, T> {
    mechanism: &'a Mechanism,
    design: &'a [Vector3<T>],
    compliance: &'a Compliance<T>,
    of_axle: OfAxle<'a, T>,
    reference: Vector3<T>,
    system: System<T>,
    bushings: Vec<Option<BushingPlace>>,
    links: Vec<Option<LinkPlace>>,
    names: Vec<String>,
    places: Places,
    /// True for each constraint of the mechanism that elastic parts replace.
    replaced: Vec<bool>,
}

/// Front and rear point of an arm, in this order.
fn ends(arm: &Arm) -> [PointId; 2] {
    [arm.front, arm.rear]
}

impl<T: Scalar> Built<T> {
    /// Builds the elastic suspension of a design. `study::compliance` ensures that the mechanism has the joints that the
    /// definition expects.
    pub(super) fn of(
        mechanism: &Mechanism,
        design: &[Vector3<T>],
        radius: f64,
        compliance: &Compliance<T>,
        of_axle: OfAxle<'_, T>,
    ) -> Self {
        let own = design[mechanism.origin.0];
        let origin = match of_axle.half {
            Some(half) => half.reference.map(|c| own.x.constant(c)),
            None => own,
        };
        let wheel = WheelPart {
            centre: design[mechanism.wheel_centre.0] - origin,
            spin_axis: DesignedSpinAxis::of(mechanism, design).direction,
            radius,
        };
        let mut builder = Builder {
            mechanism,
            design,
            compliance,
            of_axle,
            reference: origin,
            system: System {
                limbs: Vec::new(),
                bushings: Vec::new(),
                rods: Vec::new(),
                joints: Vec::new(),
                wheel,
                holders: Holders::none(),
                subframe: None,
                bar: None,
                bar_on: Holder::Body,
            },
            bushings: vec![None; compliance.bushings.len()],
            links: vec![None; compliance.links.len()],
            names: Vec::new(),
            places: Places::default(),
            replaced: vec![false; mechanism.constraints.len()],
        };
        let arms = builder.arms();
        builder.constraints();
        builder.spring(&arms);
        builder.bar(&arms);
        let mounts = builder.subframe();
        let bushings = builder.bushings.into_iter().flatten();
        Built {
            reference: builder.reference,
            system: builder.system,
            bushings: bushings.chain(mounts).collect(),
            links: builder.links,
            names: builder.names,
            places: builder.places,
        }
    }
}

impl<T: Scalar> Builder<'_, T> {
    fn at(&self, id: PointId) -> Vector3<T> {
        self.design[id.0]
    }

    /// Vector from the carrier's reference point to a point.
    fn on_carrier(&self, id: PointId) -> Vector3<T> {
        self.at(id) - self.reference
    }

    /// Returns true if the link belongs to the other half of a solid axle.
    fn is_elsewhere(&self, inner: PointId) -> bool {
        self.of_axle.half.is_some_and(|half| {
            self.mechanism.is_far(inner) || (!half.has_singles && self.mechanism.is_single(inner))
        })
    }

    /// Returns the body that holds a point: the subframe, or else the body of the vehicle.
    fn holder(&self, id: PointId) -> Holder {
        match self.of_axle.subframe {
            Some(subframe) if subframe.carries.contains(&id) => Holder::Subframe,
            _ => Holder::Body,
        }
    }

    fn push_limb(&mut self, limb: Limb<T>, name: &str, holder: Holder, place: LimbPlace) {
        self.system.limbs.push(limb);
        self.places.limbs.push(place);
        self.system.holders.limbs.push(holder);
        self.names.push(name.to_owned());
    }

    fn push_joint(&mut self, joint: Joint<T>, holder: Holder, place: JointPlace) {
        self.system.joints.push(joint);
        self.places.joints.push(place);
        self.system.holders.joints.push(holder);
    }

    fn is_on_rack(&self, id: PointId) -> bool {
        self.mechanism.body(id) == Body::Rack
    }

    /// Returns the axes of a bushing as columns. The z axis is along the component of the z direction that is normal to x.
    fn axes(&self, number: usize) -> Matrix3<T> {
        axes_of(self.compliance.bushings[number].directions(self.mechanism, self.design))
    }

    fn bushing(&self, number: usize, axes: Matrix3<T>) -> Bushing<T> {
        let part = &self.compliance.bushings[number];
        bushing(&part.shapes, &part.preload, axes)
    }

    /// Builds the arms with a bushing. Returns the index of each arm's part in the system.
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
            let numbers = ends(arm).each(|id| self.compliance.bushing_at(id));
            if numbers == [None, None] {
                continue;
            }
            for (c, constraint) in self.mechanism.constraints.iter().enumerate() {
                let of_arm =
                    matches!(constraint, Constraint::Link { outer, .. } if *outer == arm.outer);
                self.replaced[c] |= of_arm;
            }
            let limb = self.system.limbs.len();
            let mut parts = Vec::new();
            for (end, (id, number)) in ends(arm).into_iter().zip(numbers).enumerate() {
                let bushing = number.map(|number| {
                    self.bushings[number] = Some(BushingPlace::Limb { limb, end });
                    self.bushing(number, self.axes(number))
                });
                parts.push(self.end(id, arm.outer, bushing));
            }
            let is_arm = |body: &Body| matches!(body, Body::Arm(id) if id.0 == k);
            let mut bodies = self.mechanism.bodies.iter();
            let name = bodies.find(|(_, body)| is_arm(body));
            let name = name.map_or("arm", |(name, _)| name);
            let swinging = Limb::Swinging(Swinging {
                joint: self.on_carrier(arm.outer),
                ends: parts,
                seat: None,
                bar: None,
                spin: None,
            });
            self.push_limb(
                swinging,
                name,
                self.holder(arm.front),
                LimbPlace::Arm(arm.outer),
            );
            limbs[k] = Some(limb);
        }
        limbs
    }

    /// Makes an end of an arm or link. `outer` is the joint at the part's reference point. Without a bushing, the end is
    /// a ball joint. A rigid rod then keeps the distance between this end and `outer` constant.
    fn end(&mut self, id: PointId, outer: PointId, bushing: Option<Bushing<T>>) -> End<T> {
        let lever = self.at(id) - self.at(outer);
        if bushing.is_none() {
            let rod = RodPart {
                joint: self.on_carrier(outer),
                along: -lever,
                on_rack: self.is_on_rack(id),
                elastic: None,
            };
            self.push_joint(Joint::Rod(rod), self.holder(id), JointPlace::Pivot(outer));
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
                Constraint::Link { inner, .. } if self.is_elsewhere(inner) => {}
                Constraint::Link { inner, outer } => self.link(inner, outer),
                Constraint::StrutLine { top, lower, upper } => self.strut(top, lower, upper),
                Constraint::Revolute { first, second } => self.hinge(first, second),
                Constraint::BallJoint { at } => self.ball_joint(at),
                // A study cannot contain elastic parts for the constraints below.
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
        let place = LimbPlace::Link { inner, outer };
        let name = self.mechanism.link_name(inner).to_owned();
        let rates = [at_inner, at_outer].into_iter().flatten();
        let slope = rates
            .flat_map(|number| self.compliance.bushings[number].shapes.iter().take(3))
            .fold(along.x.zero(), |sum, shape| sum + shape.slope(along.x));
        // No force rotates the link about its own line, so the result does not depend on the stiffness against this
        // rotation.
        let spin = along * slope.constant(slope.value().sqrt().max(1.0));
        match (at_inner, at_outer) {
            (None, None) => self.rod(inner, outer, along),
            (Some(number), None) => {
                self.bushings[number] = Some(BushingPlace::Limb { limb, end: 0 });
                let bushing = self.bushing(number, self.axes(number));
                let end = self.end(inner, outer, Some(bushing));
                let swinging = Limb::Swinging(Swinging {
                    joint: self.on_carrier(outer),
                    ends: vec![end],
                    seat: None,
                    bar: None,
                    spin: Some(spin),
                });
                self.push_limb(swinging, &name, self.holder(inner), place);
            }
            (at_inner, Some(number)) => {
                self.bushings[number] = Some(BushingPlace::Limb { limb, end: 1 });
                let outer_bushing = self.bushing(number, self.axes(number));
                let inner_bushing = at_inner.map(|number| {
                    self.bushings[number] = Some(BushingPlace::Limb { limb, end: 0 });
                    self.bushing(number, self.axes(number))
                });
                let floating = Limb::Floating(Floating {
                    along,
                    on_rack: self.is_on_rack(inner),
                    inner: inner_bushing,
                    outer: outer_bushing,
                    joint: self.on_carrier(outer),
                    spin,
                });
                self.push_limb(floating, &name, self.holder(inner), place);
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
            None => {
                let place = JointPlace::Rod { inner, outer };
                self.push_joint(Joint::Rod(rod), self.holder(inner), place);
            }
            Some(part) => {
                rod.elastic = Some([rate(&part.stiffness, along), part.preload]);
                self.place_link(member, LinkPlace::Rod(self.system.rods.len()));
                self.system.rods.push(rod);
                self.places.rods.push([inner, outer]);
                self.system.holders.rods.push(self.holder(inner));
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
        let along = strut_line(self.design, top, lower, upper);
        match self.compliance.bushing_at(top) {
            None => {
                for normal in normals(along) {
                    let place = JointPlace::Line(top);
                    let top = self.on_carrier(top);
                    self.push_joint(Joint::Line { normal, top }, Holder::Body, place);
                }
            }
            Some(number) => {
                self.bushings[number] = Some(BushingPlace::Mount(self.system.limbs.len()));
                // The z axis is exactly along the direction for it, and the x axis is normal to the z axis.
                let part = &self.compliance.bushings[number];
                let [x, z] = part.directions(self.mechanism, self.design);
                let z = z.normalised();
                let x = x.across(z).normalised();
                let axes = Matrix3 {
                    columns: [x, z.cross(x), z],
                };
                let law = self.compliance.spring.as_ref();
                let mount = Limb::Mount(Mount {
                    top: self.on_carrier(top),
                    along,
                    spring_line: self.at(top) - self.at(lower),
                    bushing: self.bushing(number, axes),
                    spring: law.cloned(),
                });
                self.push_limb(mount, "strut", Holder::Body, LimbPlace::Mount);
                self.places.has_spring = law.is_some();
            }
        }
    }

    /// Builds a rigid ball joint between carrier and body. A study cannot put a bushing there.
    fn ball_joint(&mut self, at: PointId) {
        let lever = self.on_carrier(at);
        for direction in Matrix3::identity(lever.x).columns {
            self.push_joint(
                Joint::Pin { lever, direction },
                self.holder(at),
                JointPlace::Pin(at),
            );
        }
    }

    fn hinge(&mut self, first: PointId, second: PointId) {
        let along = self.at(second) - self.at(first);
        let numbers = [first, second].each(|id| self.compliance.bushing_at(id));
        let axes = Matrix3::identity(along.x).columns;
        for (k, (id, number)) in [first, second].into_iter().zip(numbers).enumerate() {
            let lever = self.on_carrier(id);
            match number {
                Some(number) => {
                    self.bushings[number] = Some(BushingPlace::Carrier(self.system.bushings.len()));
                    let bushing = self.bushing(number, self.axes(number));
                    self.system.bushings.push(CarrierBushing { lever, bushing });
                    self.system.holders.bushings.push(self.holder(id));
                }
                // If both joints on the arm's axis are rigid, only the first joint fixes the position along this axis.
                None if numbers == [None, None] && k == 1 => {
                    for direction in normals(along) {
                        let pin = Joint::Pin { lever, direction };
                        self.push_joint(pin, self.holder(id), JointPlace::Pin(id));
                    }
                }
                None => {
                    for direction in axes {
                        let pin = Joint::Pin { lever, direction };
                        self.push_joint(pin, self.holder(id), JointPlace::Pin(id));
                    }
                }
            }
        }
    }
}

/// Returns the axes of a bushing as columns. The x axis is along the first vector. The z axis is along the component of
/// the second vector that is normal to x.
fn axes_of<T: Scalar>([x, z]: [Vector3<T>; 2]) -> Matrix3<T> {
    let x = x.normalised();
    let z = z.across(x).normalised();
    Matrix3 {
        columns: [x, z.cross(x), z],
    }
}

fn bushing<T: Scalar>(shapes: &[Shape<T>; 6], preload: &[T; 6], axes: Matrix3<T>) -> Bushing<T> {
    Bushing {
        axes,
        laws: std::array::from_fn(|k| Law::new(shapes[k].clone(), preload[k])),
    }
}

/// Axial rate of a link; `along` is the vector between its ends.
fn rate<T: Scalar>(stiffness: &AxialStiffness<T>, along: Vector3<T>) -> T {
    match stiffness {
        AxialStiffness::Rate(rate) => *rate,
        AxialStiffness::PerStrain(force) => *force / along.norm(),
    }
}

/// Two unit vectors normal to a vector and to each other.
fn normals<T: Scalar>(v: Vector3<T>) -> [Vector3<T>; 2] {
    let [x, y, z] = v.to_array().each(|c| c.value().abs());
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

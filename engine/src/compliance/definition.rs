//! Elastic parts of a study: bushings at hardpoints, links with axial stiffness, and the position in which they are
//! relaxed.

use super::law::Shape;
use crate::axle::SpringLaw;
use crate::model::{Body, Constraint, Mechanism, PointId, RockerId};
use crate::number::{Each, Scalar, Vector3};

/// Position in which elastic parts are relaxed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relaxed {
    /// All parts have zero force in the design position. Under the spring's force, the design position is no equilibrium.
    Free,
    /// Without constant preloads, the design position is the equilibrium under the wheel load that matches the spring's
    /// force there.
    AtDesignLoad,
}

/// Bushing at a hardpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct BushingPart<T = f64> {
    /// Hardpoint at which the bushing is.
    pub point: PointId,
    /// Force laws along the bushing's axes, and torque laws about them.
    pub shapes: [Shape<T>; 6],
    /// Constant forces and torques that are added to the forces and torques of the laws.
    pub preload: [T; 6],
    /// Direction of the bushing's x axis in the design position, in the kernel's frame; `None` for the default. The x axis
    /// of a strut's mount is the component normal to its z axis.
    pub x_axis: Option<Vector3<T>>,
    /// Direction from which the z axis is computed: its component normal to the x axis. `None` for the vertical. The mount
    /// of a strut has its z axis along this direction; `None` for the line of the strut.
    pub z_axis: Option<Vector3<T>>,
}

/// Mount between the subframe and the body, on the left side. The right mount is its mirror image.
#[derive(Clone, Debug, PartialEq)]
pub struct SubframeMount<T = f64> {
    /// Name of the mount.
    pub name: String,
    /// Position of the mount in the design position, in the kernel's frame.
    pub at: Vector3<T>,
    /// Laws along and about the mount's axes.
    pub shapes: [Shape<T>; 6],
    /// Constant forces and torques that are added to the forces and torques of the laws.
    pub preload: [T; 6],
    /// Direction of the mount's x axis; `None` for forward.
    pub x_axis: Option<Vector3<T>>,
    /// Direction from which the z axis is computed: its component normal to the x axis. `None` for the vertical.
    pub z_axis: Option<Vector3<T>>,
}

/// Subframe that holds inner ends of the parts of both wheels. Mounts connect it to the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Subframe<T = f64> {
    /// Hardpoints on the subframe.
    pub carries: Vec<PointId>,
    /// Mounts of the left side.
    pub mounts: Vec<SubframeMount<T>>,
}

impl<T: Scalar> BushingPart<T> {
    /// Directions of the bushing's x axis and z axis in the design position. One of them may still have a component along
    /// the other. [`bushing_points`] has the hardpoint of the bushing.
    pub(crate) fn directions(
        &self,
        mechanism: &Mechanism,
        design: &[Vector3<T>],
    ) -> [Vector3<T>; 2] {
        let at = |id: PointId| design[id.0];
        let [forward, up] = forward_and_up(at(self.point).x);
        let of = |constraint: &Constraint| match *constraint {
            Constraint::Link { inner, outer } if [inner, outer].contains(&self.point) => {
                let arm = mechanism.arms.iter().find(|arm| arm.outer == outer);
                let along = match arm {
                    Some(arm) => at(arm.front) - at(arm.rear),
                    None => at(outer) - at(inner),
                };
                Some([along, up])
            }
            Constraint::Revolute { first, second } => Some([at(second) - at(first), up]),
            Constraint::StrutLine { top, lower, upper } if top == self.point => {
                Some([forward, strut_line(design, top, lower, upper)])
            }
            _ => None,
        };
        let [x, z] = mechanism
            .constraints
            .iter()
            .find_map(of)
            .unwrap_or([forward, up]);
        [self.x_axis.unwrap_or(x), self.z_axis.unwrap_or(z)]
    }
}

impl<T: Scalar> SubframeMount<T> {
    /// Directions of the mount's x axis and z axis. The z axis may still have a component along the x axis.
    pub(crate) fn directions(&self) -> [Vector3<T>; 2] {
        let [forward, up] = forward_and_up(self.at.x);
        [self.x_axis.unwrap_or(forward), self.z_axis.unwrap_or(up)]
    }
}

/// Unit vectors forward and up.
fn forward_and_up<T: Scalar>(like: T) -> [Vector3<T>; 2] {
    let (one, zero) = (like.one(), like.zero());
    [Vector3::new(one, zero, zero), Vector3::new(zero, zero, one)]
}

/// Unit vector up along the line of a strut.
pub(super) fn strut_line<T: Scalar>(
    design: &[Vector3<T>],
    top: PointId,
    lower: PointId,
    upper: Option<PointId>,
) -> Vector3<T> {
    (design[upper.unwrap_or(top).0] - design[lower.0]).normalised()
}

impl<T: Scalar> Subframe<T> {
    /// Mean position of the mounts of both sides, the reference point of the subframe's motion. It carries no derivatives.
    pub(super) fn reference(&self, like: T) -> Vector3<T> {
        let share = 1.0 / self.mounts.len().max(1) as f64;
        let places = self.mounts.iter().map(|mount| mount.at.map(|c| c.value()));
        let middle = places.fold(Vector3::default(), |sum, at| sum + at) * share;
        Vector3::new(
            like.constant(middle.x),
            like.zero(),
            like.constant(middle.z),
        )
    }
}

impl Subframe {
    /// Converts the subframe to another number type.
    pub fn map<U: Copy>(&self, f: impl Fn(f64) -> U + Copy) -> Subframe<U> {
        let mount = |mount: &SubframeMount| SubframeMount {
            name: mount.name.clone(),
            at: mount.at.map(f),
            shapes: mount.shapes.each_ref().map(|shape| shape.map(f)),
            preload: mount.preload.each(f),
            x_axis: mount.x_axis.map(|axis| axis.map(f)),
            z_axis: mount.z_axis.map(|axis| axis.map(f)),
        };
        Subframe {
            carries: self.carries.clone(),
            mounts: self.mounts.iter().map(mount).collect(),
        }
    }
}

/// Link with axial stiffness.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkPart<T = f64> {
    /// Member to which the stiffness belongs.
    pub member: LinkMember,
    /// Axial stiffness of the member.
    pub stiffness: AxialStiffness<T>,
    /// Constant tension, added to the tension from the stiffness.
    pub preload: T,
}

/// Member that can have axial stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkMember {
    /// Rod, or leg of an arm, between body, subframe or rack and the carrier.
    Rod {
        /// End at the body, the subframe or the rack.
        inner: PointId,
        /// End at the carrier.
        outer: PointId,
    },
    /// Rod of the spring's rocker.
    RockerRod(RockerId),
}

/// Axial stiffness of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxialStiffness<T = f64> {
    /// Force per change of length. This rate does not change if hardpoints move.
    Rate(T),
    /// Force per strain. The rate of the link is this number divided by the link's length.
    PerStrain(T),
}

/// Elastic parts of a wheel's suspension.
#[derive(Clone, Debug, PartialEq)]
pub struct Compliance<T = f64> {
    /// Position in which the elastic parts are relaxed.
    pub relaxed: Relaxed,
    /// Bushings of the wheel's suspension.
    pub bushings: Vec<BushingPart<T>>,
    /// Links with axial stiffness.
    pub links: Vec<LinkPart<T>>,
    /// Law of the spring.
    pub spring: Option<SpringLaw<T>>,
}

impl Compliance {
    /// Makes the definition of a rigid suspension with this spring.
    pub fn rigid(spring: Option<SpringLaw>) -> Self {
        Compliance {
            relaxed: Relaxed::Free,
            bushings: Vec::new(),
            links: Vec::new(),
            spring,
        }
    }

    /// Rate of the spring, force per length. `None` without a spring, or if its force is a curve.
    pub fn spring_rate(&self) -> Option<f64> {
        self.spring.as_ref()?.rate()
    }

    /// Returns true if the parts are relaxed at the design load and have no constant forces. The design position is then an
    /// equilibrium, unless a torque curve is not zero at angle 0.
    pub fn rests_in_design(&self) -> bool {
        let of_bushings = self.bushings.iter().flat_map(|part| part.preload);
        let of_links = self.links.iter().map(|part| part.preload);
        let mut offsets = of_bushings.chain(of_links);
        self.relaxed == Relaxed::AtDesignLoad && offsets.all(|offset| offset == 0.0)
    }

    /// Returns true if no bushing and no link is elastic. A spring does not count.
    pub fn is_rigid(&self) -> bool {
        self.bushings.is_empty() && self.links.is_empty()
    }

    /// Converts the parts to another number type.
    pub fn map<U: Copy>(&self, f: impl Fn(f64) -> U + Copy) -> Compliance<U> {
        let bushing = |part: &BushingPart| BushingPart {
            point: part.point,
            shapes: part.shapes.each_ref().map(|shape| shape.map(f)),
            preload: part.preload.each(f),
            x_axis: part.x_axis.map(|axis| axis.map(f)),
            z_axis: part.z_axis.map(|axis| axis.map(f)),
        };
        let link = |part: &LinkPart| LinkPart {
            member: part.member,
            stiffness: match part.stiffness {
                AxialStiffness::Rate(rate) => AxialStiffness::Rate(f(rate)),
                AxialStiffness::PerStrain(force) => AxialStiffness::PerStrain(f(force)),
            },
            preload: f(part.preload),
        };
        Compliance {
            relaxed: self.relaxed,
            bushings: self.bushings.iter().map(bushing).collect(),
            links: self.links.iter().map(link).collect(),
            spring: self.spring.as_ref().map(|law| law.map(f)),
        }
    }
}

impl<T> Compliance<T> {
    /// Index of the bushing at a hardpoint.
    pub fn bushing_at(&self, point: PointId) -> Option<usize> {
        self.bushings.iter().position(|part| part.point == point)
    }

    /// Elastic part of a member; `None` for a rigid member.
    pub(super) fn link(&self, member: LinkMember) -> Option<&LinkPart<T>> {
        self.links.iter().find(|part| part.member == member)
    }
}

/// Returns the hardpoints that may have a bushing, in the order of the mechanism's points. For a solid axle, the list
/// contains the hardpoints of the left half, and the hardpoints that exist only once.
pub fn bushing_points(mechanism: &Mechanism) -> Vec<PointId> {
    let mut points = Vec::new();
    for constraint in &mechanism.constraints {
        match *constraint {
            Constraint::Link { inner, .. } if mechanism.is_far(inner) => {}
            Constraint::Link { inner, outer } => {
                let of_arm = mechanism.arms.iter().any(|arm| arm.outer == outer);
                points.push(inner);
                points.extend((!of_arm).then_some(outer));
            }
            Constraint::StrutLine { top, .. } => points.push(top),
            Constraint::Revolute { first, second } => points.extend([first, second]),
            Constraint::BallJoint { .. }
            | Constraint::AxleTravel { .. }
            | Constraint::Mount { .. }
            | Constraint::ArmJoint { .. } => {}
        }
    }
    points.sort();
    points
}

/// Returns the members that may have axial stiffness, with their names. For a solid axle, the list contains the members
/// of the left half, and the members that exist only once.
pub fn link_members(mechanism: &Mechanism) -> Vec<(String, LinkMember)> {
    let mut members = Vec::new();
    for constraint in &mechanism.constraints {
        if let Constraint::Link { inner, outer } = *constraint
            && !mechanism.is_far(inner)
        {
            let name = mechanism.link_name(inner).to_owned();
            members.push((name, LinkMember::Rod { inner, outer }));
        }
    }
    if let Some(rocker) = mechanism
        .spring
        .and_then(|s| match mechanism.body(s.lower) {
            Body::Rocker(rocker) => Some(rocker),
            _ => None,
        })
    {
        let name = mechanism.rocker(rocker).rod.key().to_owned();
        members.push((name, LinkMember::RockerRod(rocker)));
    }
    members
}

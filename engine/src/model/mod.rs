//! Suspension model: hardpoints, the bodies they belong to, and the constraints between the bodies.
//!
//! A topology is data: a list of named hardpoints, and a list of [`Constraint`]s that hold the knuckle. The module
//! `model` contains no solver. A new topology is one new file here and one line in [`Topology::ALL`].

mod double_wishbone;
mod five_link;
mod five_link_axle;
mod frame;
mod h_arm;
mod integral_link;
mod macpherson;
mod rigid_axle;
mod rocker;
mod seats;
mod semi_trailing_arm;
mod solid_axle;
mod steered_axle;
mod suspension;
mod topology;
mod trailing_arm_two_links;
mod twist_beam;

pub use frame::{Axis, Frame, FrameConvention, LengthUnit, MassUnit, Side};
pub use rigid_axle::{AxleTravel, RigidAxle, mirrored};
pub use rocker::{Rocker, RockerId, Rod};
pub use seats::Seat;
pub use steered_axle::AxleSteering;
pub use suspension::{AxlePosition, Suspension, TorquePath, VehicleFigures};
pub use topology::{Group, Hardpoint, Topology};
pub(crate) use twist_beam::HINGE;
pub use twist_beam::TwistBeam;

use crate::number::Vector3;

/// Index of a hardpoint in [`Mechanism::points`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PointId(pub usize);

/// Index of an arm in [`Mechanism::arms`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArmId(pub usize);

/// Rigid body that carries a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// Fixed in the vehicle.
    Chassis,
    /// Moved sideways by the steering rack.
    Rack,
    /// Fixed in the vehicle in x and z. Sideways it moves opposite to a knuckle point by the same distance. For the
    /// far mount of a twist beam.
    Opposite(PointId),
    /// Moved by the steering gear. The design position of the given point stores the present position of this point.
    SteeringGear(PointId),
    /// The wheel carrier. For a solid axle, the axle itself; for a twist beam, its near half.
    Knuckle,
    /// A control arm, which rotates about its axis.
    Arm(ArmId),
    /// Upper part of a strut. It rotates with the knuckle, about the given chassis point.
    StrutRod(PointId),
    /// A rocker, which rotates about its axis as its rod moves it.
    Rocker(RockerId),
}

/// A point of the mechanism: a hardpoint of the topology, or a point that the study adds.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Name as written in the study.
    pub name: String,
    /// Body that carries the point.
    pub body: Body,
}

/// A control arm: two chassis points on its axis and its outer joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arm {
    /// Front point of the axis.
    pub front: PointId,
    /// Rear point of the axis.
    pub rear: PointId,
    /// The joint to the knuckle. For a semi-trailing arm, the wheel centre.
    pub outer: PointId,
}

impl Arm {
    /// Makes two rods with the same outer point. Together they hold the knuckle as the arm does.
    fn links(self) -> [Constraint; 2] {
        let Arm { front, rear, outer } = self;
        [front, rear].map(|inner| Constraint::Link { inner, outer })
    }
}

/// A constraint on the knuckle. Together, the constraints of a mechanism remove five of its six degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constraint {
    /// A rod of fixed length between a point of the chassis, the rack or an arm, and a knuckle point. Removes one degree of
    /// freedom. A two-legged arm is two such rods with the same outer point. One end of a Watt link is on a rocker.
    Link {
        /// End on the chassis, the rack, an arm or a Watt rocker. For a twist beam, the far mount.
        inner: PointId,
        /// End on the knuckle, or on a Watt rocker that the axle carries.
        outer: PointId,
    },
    /// A telescopic strut, fixed to the knuckle and held by a ball joint at `top`. `top` stays on a line fixed in the
    /// knuckle. Removes two degrees of freedom. In the design position the line passes through `top`. Its direction is from
    /// `lower` to `upper`, or from `lower` to `top` if there is no `upper`.
    StrutLine {
        /// The chassis mount.
        top: PointId,
        /// A knuckle point.
        lower: PointId,
        /// A second knuckle point, if `lower` and `top` do not give the line.
        upper: Option<PointId>,
    },
    /// A hinge: the knuckle rotates about the line through two chassis points. Removes five degrees of freedom. The knuckle
    /// is then the arm itself.
    Revolute {
        /// First chassis point on the axis of the hinge.
        first: PointId,
        /// Second chassis point on the axis of the hinge.
        second: PointId,
    },
    /// A ball joint at the body: the knuckle rotates about a chassis point. Removes three degrees of freedom.
    BallJoint {
        /// The chassis point.
        at: PointId,
    },
    /// A mount that fixes a knuckle point in x and z and lets it move sideways. Removes two degrees of freedom.
    Mount {
        /// The knuckle point.
        at: PointId,
    },
    /// A second joint between an arm and the knuckle. The knuckle then rotates about the line through both joints. Removes
    /// two degrees of freedom in addition to the two legs of the arm.
    ArmJoint {
        /// The arm.
        arm: ArmId,
        /// Point of the joint, common to arm and knuckle.
        at: PointId,
    },
    /// Holds one of the two travels of a rigid axle at a given value. In other mechanisms, the rack displacement has a
    /// given value instead. Removes one degree of freedom.
    AxleTravel {
        /// Centre of the near wheel, to which the mechanism belongs.
        near: PointId,
        /// Centre of the far wheel, on the other side of the axle.
        far: PointId,
        /// Travel with the given value.
        held: AxleTravel,
    },
}

impl Constraint {
    /// Number of degrees of freedom that the constraint removes.
    pub fn freedoms(&self) -> usize {
        match self {
            Constraint::Link { .. } | Constraint::AxleTravel { .. } => 1,
            Constraint::StrutLine { .. }
            | Constraint::ArmJoint { .. }
            | Constraint::Mount { .. } => 2,
            Constraint::BallJoint { .. } => 3,
            Constraint::Revolute { .. } => 5,
        }
    }

    /// Inner and outer end of a link; `None` for other constraints.
    pub fn link(&self) -> Option<(PointId, PointId)> {
        match *self {
            Constraint::Link { inner, outer } => Some((inner, outer)),
            _ => None,
        }
    }
}

/// Axis about which the knuckle rotates in steering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SteeringAxis {
    /// The axis passes through two joints of the knuckle.
    Through {
        /// The lower joint.
        lower: PointId,
        /// The upper joint or mount.
        upper: PointId,
    },
    /// Instantaneous screw axis of the knuckle's motion when the rack moves and the drive is fixed. With wheel travel
    /// as the drive, the height of the wheel centre is constant. This variant is for linkages without an upper and a
    /// lower joint.
    Instantaneous,
}

/// Axis about which the wheel spins, through the wheel centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpinAxis {
    /// Direction from this knuckle point, inboard of the wheel, to the wheel centre.
    From(PointId),
    /// The spin axis is fixed in the knuckle. The vector is the axis' outboard direction in the design position (from
    /// static camber and toe).
    Along(Vector3<f64>),
}

impl SpinAxis {
    /// Spin axis of a wheel with this static camber and toe (radians).
    pub fn standing(camber: f64, toe: f64) -> SpinAxis {
        SpinAxis::Along(Vector3::new(
            camber.cos() * toe.sin(),
            camber.cos() * toe.cos(),
            -camber.sin(),
        ))
    }
}

/// A spring or damper between two points, the first on the sprung side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spring {
    /// The chassis end.
    pub upper: PointId,
    /// End that moves with the wheel.
    pub lower: PointId,
}

/// A mechanism whose pose has a closed form for a given angle of the drive arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClosedForm {
    /// Lower arm, strut and tie rod.
    Strut,
    /// Lower arm, upper arm and tie rod.
    DoubleWishbone,
}

/// Coordinate that drives the mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Height of the wheel centre above its design position. For a rigid axle, the travel that is not held.
    Travel,
    /// Angle of the first control arm from its design position. A positive angle raises its outer joint.
    ArmAngle,
}

/// The structure of a suspension without its dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanism {
    /// Topology from which the mechanism was made.
    pub topology: &'static Topology,
    /// All points. Hardpoints of the topology come first.
    pub points: Vec<Point>,
    /// Bodies that a study may assign to points, with their names.
    pub bodies: Vec<(&'static str, Body)>,
    /// Points that could be on several bodies, and for which the study names no body. The program assumes a body for each
    /// point.
    pub unsaid_seats: Vec<PointId>,
    /// Constraints, five scalar equations in total.
    pub constraints: Vec<Constraint>,
    /// Control arms. An arm-angle drive rotates the first one.
    pub arms: Vec<Arm>,
    /// Rockers. The rod of a rocker may be mounted on an earlier rocker.
    pub rockers: Vec<Rocker>,
    /// Knuckle point whose position, with the knuckle's rotation, describes the pose.
    pub origin: PointId,
    /// Centre of the wheel, on the knuckle. For a steered solid axle, on a rocker.
    pub wheel_centre: PointId,
    /// Spin axis of the wheel.
    pub spin_axis: SpinAxis,
    /// Pairs of points of an assembled suspension: a deviation of the first point moves both points, so the axis through
    /// them stays parallel to itself. One pair is a wheel centre and the point that the program adds on its spin axis, if
    /// the study gives the axis as angles. Another pair is the shear centre and the second hinge point of a twist beam.
    /// Empty for other mechanisms.
    pub parallel_axes: Vec<[PointId; 2]>,
    /// The steering axis; `None` for a wheel that cannot be steered.
    pub steering_axis: Option<SteeringAxis>,
    /// Spring. `None` if the hardpoints do not give its ends.
    pub spring: Option<Spring>,
    /// Closed form of this mechanism, if there is one.
    pub closed_form: Option<ClosedForm>,
    /// Far half of the axle (the half of the other wheel), if the knuckle is an axle that carries both wheels.
    pub rigid_axle: Option<RigidAxle>,
}

/// Name of the point that gives the spin axis of an assembled wheel.
pub(crate) const SPINDLE_INNER: &str = "spindle_inner";

impl Mechanism {
    /// Point with this name.
    pub fn point(&self, name: &str) -> Option<PointId> {
        self.points.iter().position(|p| p.name == name).map(PointId)
    }

    /// Returns true if the topology has a point on a rack. This is also true for wheels that the study does not steer.
    pub fn has_rack(&self) -> bool {
        self.points.iter().any(|point| point.body == Body::Rack)
    }

    /// Returns true if the mechanism has a point on a rack ([`Mechanism::has_rack`]), or if a drag link steers the wheel.
    pub fn is_steered(&self) -> bool {
        self.has_rack() || self.axle_steering().is_some()
    }

    /// Returns the second point that a deviation of the point `leader` also moves ([`Mechanism::parallel_axes`]). `None` if
    /// no other point moves.
    #[inline(always)]
    pub(crate) fn moves_with(&self, leader: PointId) -> Option<PointId> {
        let mut pairs = self.parallel_axes.iter();
        pairs
            .find(|[centre, _]| *centre == leader)
            .map(|[_, beside]| *beside)
    }

    /// Name of a point. If the study gives camber and toe as angles, an assembled wheel has an additional point. Error
    /// messages may refer to this additional point, so the function names it too.
    pub fn name(&self, id: PointId) -> &str {
        self.points
            .get(id.0)
            .map_or(SPINDLE_INNER, |point| &point.name)
    }

    /// Adds the far half of a rigid axle (the half of the other wheel) to a design, as the mirror image of the near half.
    pub fn add_far_half(&self, design: &mut Vec<Vector3<f64>>) {
        if let Some(rigid) = &self.rigid_axle {
            for [near, _] in &rigid.pairs {
                design.push(mirrored(design[near.0]));
            }
            if let Some(beam) = &rigid.twist_beam {
                design.extend(beam.further_points(design).map(|(_, place)| place));
            }
            if let Some(steering) = &rigid.steering {
                design.push(design[steering.end.0]);
            }
        }
    }

    /// Returns the mechanism with this travel of the rigid axle fixed by a constraint. The other travel is then the drive.
    pub fn holding(&self, travel: AxleTravel) -> Mechanism {
        let mut mechanism = self.clone();
        if let Some(rigid) = &mut mechanism.rigid_axle {
            rigid.held = travel;
        }
        for constraint in &mut mechanism.constraints {
            if let Constraint::AxleTravel { held, .. } = constraint {
                *held = travel;
            }
        }
        mechanism
    }

    /// Returns true if a Watt linkage holds this axle sideways.
    pub fn has_watt_linkage(&self) -> bool {
        self.point("watt_pivot").is_some()
    }

    /// Reason why parts of this mechanism cannot be elastic. `None` if they can be elastic.
    pub fn why_not_elastic(&self) -> Option<&'static str> {
        if self.topology.is_twist_beam() {
            Some("elastic parts are not available for twist beams yet")
        } else if self.axle_steering().is_some() {
            Some("elastic parts are not available for a steered solid axle yet")
        } else if self.has_watt_linkage() {
            Some("elastic parts are not available with a Watt linkage yet")
        } else {
            None
        }
    }

    /// Returns true for a point of the far half of a rigid axle (the half of the other wheel). Also true for a point that the
    /// study does not give. The program computes these points from the near half.
    pub fn is_far(&self, id: PointId) -> bool {
        self.rigid_axle
            .as_ref()
            .is_some_and(|rigid| rigid.is_far(id))
    }

    /// Returns true for a point that exists only once on a rigid axle, such as an end of a Panhard rod.
    pub fn is_single(&self, id: PointId) -> bool {
        let rigid = self.rigid_axle.as_ref();
        rigid.is_some_and(|rigid| rigid.singles.contains(&id))
    }

    /// Name of a link, derived from the name of its end at the body.
    pub fn link_name(&self, inner: PointId) -> &str {
        let name = self.name(inner);
        let of_body = ["_inner", "_chassis", "_rocker"];
        let stripped = of_body.iter().find_map(|end| name.strip_suffix(end));
        stripped.unwrap_or(name)
    }

    /// Second point of a strut's axis on the knuckle, if there is one.
    #[inline]
    pub fn strut_upper(&self) -> Option<PointId> {
        self.constraints.iter().find_map(|c| match c {
            Constraint::StrutLine { upper, .. } => *upper,
            _ => None,
        })
    }

    /// Size of a design: the largest distance of a point from the knuckle's origin.
    pub fn size(&self, design: &[Vector3<f64>]) -> f64 {
        let origin = design[self.origin.0];
        let farthest = |far: f64, p: &Vector3<f64>| far.max((*p - origin).norm_squared());
        design.iter().fold(0.0, farthest).sqrt()
    }

    /// Largest distance of a point from the origin of the coordinates, or the size of the mechanism if it is larger. Rounding
    /// errors of positions are proportional to this length.
    pub fn coordinate_scale(&self, design: &[Vector3<f64>]) -> f64 {
        let largest = |far: f64, p: &Vector3<f64>| far.max(p.norm_squared());
        design
            .iter()
            .fold(0.0, largest)
            .sqrt()
            .max(self.size(design))
    }

    /// Pairs of points that define a length or a direction: arm axes, links, strut, hinges and spin axis. Rockers and their
    /// rods are not included.
    pub fn lengths(&self) -> impl Iterator<Item = (PointId, PointId)> {
        let arms = self.arms.iter().map(|arm| (arm.front, arm.rear));
        let constraints = self
            .constraints
            .iter()
            .filter_map(|constraint| match *constraint {
                Constraint::Link { inner, outer } => Some((inner, outer)),
                Constraint::StrutLine { top, lower, upper } => Some((lower, upper.unwrap_or(top))),
                Constraint::Revolute { first, second } => Some((first, second)),
                Constraint::ArmJoint { arm, at } => Some((self.arms[arm.0].outer, at)),
                Constraint::BallJoint { .. }
                | Constraint::Mount { .. }
                | Constraint::AxleTravel { .. } => None,
            });
        let spin_axis = match self.spin_axis {
            SpinAxis::From(inner) => Some((inner, self.wheel_centre)),
            SpinAxis::Along(_) => None,
        };
        arms.chain(constraints).chain(spin_axis)
    }

    /// Returns true if two points are known to keep their distance in every pose. This is true for points of one body and for
    /// the two ends of a rod. It is also true for the outer joint of an arm and a point of the arm's axis. The result is false
    /// for other points of an arm or rocker together with its axis or joint, although their distance is constant.
    pub fn are_rigidly_joined(&self, a: PointId, b: PointId) -> bool {
        let are = |p: PointId, q: PointId| (a, b) == (p, q) || (b, a) == (p, q);
        let on_ground = |id| matches!(self.body(id), Body::Chassis);
        let links = self.constraints.iter().any(|constraint| match *constraint {
            Constraint::Link { inner, outer } => are(inner, outer),
            Constraint::Revolute { first, second } => {
                // The points of the hinge are fixed, and the wheel carrier rotates about them.
                let of_axis = |id| id == first || id == second;
                let carried = |id| self.body(id) == Body::Knuckle;
                of_axis(a) && carried(b) || of_axis(b) && carried(a)
            }
            Constraint::BallJoint { at } => {
                let carried = |id| self.body(id) == Body::Knuckle;
                a == at && carried(b) || b == at && carried(a)
            }
            Constraint::ArmJoint { arm, at } => {
                let Arm { front, rear, .. } = self.arms[arm.0];
                are(front, at) || are(rear, at)
            }
            Constraint::StrutLine { .. }
            | Constraint::Mount { .. }
            | Constraint::AxleTravel { .. } => false,
        });
        let rods = self
            .rockers
            .iter()
            .any(|rocker| are(rocker.outer, rocker.inner));
        links || rods || self.body(a) == self.body(b) || on_ground(a) && on_ground(b)
    }

    /// Arm to which a constraint is attached, for links on an arm and for second joints between arm and knuckle. The arm's
    /// own legs do not count.
    pub fn arm_under(&self, constraint: &Constraint) -> Option<ArmId> {
        match *constraint {
            Constraint::ArmJoint { arm, .. } => Some(arm),
            Constraint::Link { inner, .. } => match self.body(inner) {
                Body::Arm(arm) => Some(arm),
                _ => None,
            },
            _ => None,
        }
    }

    /// Body that carries a point.
    #[inline(always)]
    pub fn body(&self, id: PointId) -> Body {
        self.points[id.0].body
    }
}

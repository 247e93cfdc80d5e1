//! Gradients with respect to the hardpoints in a pose of the closed form.
//!
//! Let y be an output, x the pose and p the hardpoints. F are the closure equations with the Jacobian J. Indices x and p
//! denote derivatives. As in module `sensitivity`, dy/dp = y_p - mu . F_p with J^T mu = y_x. The mu are constraint forces
//! that balance the wrench y_x: a force f at the lower ball joint and a moment m about it. Here each mu has an explicit
//! formula. v is the velocity of the ball joint and w the angular velocity, both per unit of travel. Levers start at the
//! ball joint: d to the upper end, t to the tie rod's outer end, q to the wheel centre. The vector l = t - g is along the
//! tie rod, and z points up. The module `closed_form` defines g, n and ga.
//!
//! ```text
//! travel      mu6 = f.v + m.w                                   virtual work
//! tie rod     mu3 = d.(m - mu6 q x z)/(d.(t x l))               moments about the steering axis
//! upper end   nu  = (M x e)/(d.e),  M = m - mu3 t x l - mu6 q x z
//! lower arm   b   = f - nu - mu3 l - mu6 z
//! ```
//!
//! d.(t x l) = ga |n|^2. nu is the force at the upper end. Its moment is M, so d x nu = M. It does no work along e, the
//! free direction of the upper end (along the strut, or the tangent of its circle). The two legs of an arm carry a force
//! together: b = mu1 (r - p1) + mu2 (r - p2). Here a is the axis of the arm, s1 the joint's position along this axis and
//! rho the radius:
//!
//! ```text
//! mu1 + mu2 = b.rho/rho^2      mu2 = ((mu1 + mu2) s1 - b.a)/|p2 - p1|
//! ```

use super::circle::Circle;
use super::roles::UpperRoles;
use super::upper::Upper;
use super::{ArmState, ClosedForm, Roles};
use crate::derive::Gradient;
use crate::derive::sensitivity::HardpointGradient;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Wrench};
use crate::model::{Arm, PointId};
use crate::number::Real;
use crate::number::Vector3;

/// Members that carry the forces, with the values that are the same in all poses of a design.
pub(crate) struct Members<T> {
    lower_arm: Legs<T>,
    upper: UpperEnd<T>,
    /// Vector l along the tie rod, in the design position.
    tie_rod: Vector3<T>,
}

/// Terms shared by the gradients of all outputs in a pose.
pub(crate) struct Adjoint<'a, T> {
    roles: &'a Roles,
    members: &'a Members<T>,
    at: &'a Configuration<'a, T>,
    ball_joint_velocity: Vector3<T>,
    turn: Vector3<T>,
    d: Vector3<T>,
    /// Vector l = t - g along the tie rod in the pose.
    tie_rod: Vector3<T>,
    /// Vector l, rotated back to the design position with the knuckle.
    tie_rod_in_knuckle: Vector3<T>,
    /// Cross product t x l: moment of a force l along the tie rod about the ball joint.
    tie_rod_moment: Vector3<T>,
    inverse_tie_rod_lever: T,
    /// Cross product q x z: moment of a vertical force at the wheel centre about the ball joint.
    travel_moment: Vector3<T>,
    up_in_knuckle: Vector3<T>,
    /// Vector e/(d.e), with the free direction e of the upper end.
    free: Vector3<T>,
    lower_arm: Joint<T>,
    upper: UpperJoint<T>,
}

/// Member that carries the force at the upper end.
enum UpperEnd<T> {
    Strut {
        top: PointId,
        /// The two points that give the direction of the strut line.
        lower: PointId,
        upper: PointId,
        /// `inverse_base`: inverse of the distance between the two points. `designed`: position of the mount along the line.
        /// Both values belong to the design position.
        inverse_base: T,
        designed: T,
    },
    Arm(Legs<T>),
}

/// Legs of an arm, from its axis to its outer joint, in the design position.
struct Legs<T> {
    arm: Arm,
    front: Vector3<T>,
    rear: Vector3<T>,
    outer: Vector3<T>,
    /// Centre of the circle on which the outer joint moves.
    centre: Vector3<T>,
    /// Inverse squared radius of this circle, 1/rho^2.
    inverse_square: T,
    /// Unit vector along the axis, front to rear, divided by the length of the axis.
    axis: Vector3<T>,
    /// Position s1 of the outer joint along the axis, divided by the length of the axis.
    along: T,
}

/// Outer joint of an arm in a pose.
struct Joint<T> {
    /// Displacement of the joint from the design position.
    moved: Vector3<T>,
    /// Vector rho/rho^2, with rho from the centre of the joint's circle to the joint.
    radius: Vector3<T>,
}

/// Upper end in a pose.
enum UpperJoint<T> {
    /// Distance that the knuckle has slid along the strut line, divided by the distance of the points that give the line's
    /// direction.
    Strut(T),
    Arm(Joint<T>),
}

impl<T: Real> Legs<T> {
    /// Legs of an arm whose outer joint moves on this circle.
    #[inline(always)]
    fn of(arm: Arm, design: &[Vector3<T>], circle: &Circle<T>) -> Self {
        let [outer, front, rear] = [design[arm.outer.0], design[arm.front.0], design[arm.rear.0]];
        let base = rear - front;
        let axis = base * (base.x.one() / base.norm_squared());
        let along = (outer - front).dot(axis);
        Legs {
            arm,
            front: outer - front,
            rear: outer - rear,
            outer,
            centre: circle.centre,
            inverse_square: along.one() / circle.radius.norm_squared(),
            axis,
            along,
        }
    }

    /// Outer joint at this position.
    #[inline(always)]
    fn at(&self, joint: Vector3<T>) -> Joint<T> {
        Joint {
            moved: joint - self.outer,
            radius: (joint - self.centre) * self.inverse_square,
        }
    }

    /// Adds the derivatives with respect to the hardpoints of an arm, whose two legs together carry `force`, to a gradient.
    /// `rest` is the further derivative with respect to the outer joint, from other members.
    #[inline(always)]
    fn add(&self, at: &Joint<T>, force: Vector3<T>, rest: Vector3<T>, sink: &mut impl Sink<T>) {
        // `front` and `rear` are the forces in the two legs, each divided by the length of its leg. The vector sum of both forces
        // is `force`.
        let both = force.dot(at.radius);
        let rear = (both * self.along) - force.dot(self.axis);
        let front = both - rear;
        sink.hardpoint(self.arm.front, at.moved * front);
        sink.hardpoint(self.arm.rear, at.moved * rear);
        let outer = rest
            .plus_scaled(self.front, front)
            .plus_scaled(self.rear, rear);
        sink.hardpoint(self.arm.outer, outer);
    }
}

impl<T: Real> Members<T> {
    #[inline(always)]
    pub(crate) fn of(roles: &Roles, form: &ClosedForm<T>, design: &[Vector3<T>]) -> Self {
        let designed = |id: PointId| design[id.0];
        Members {
            lower_arm: Legs::of(roles.lower_arm, design, &form.ball_joint),
            upper: match (&form.upper, &roles.upper) {
                (Upper::Strut { line, .. }, UpperRoles::Strut { top, lower, upper }) => {
                    let upper = upper.unwrap_or(*top);
                    let base = line.dot(designed(upper) - designed(*lower));
                    let to_top = designed(*top) - designed(roles.lower_arm.outer);
                    UpperEnd::Strut {
                        top: *top,
                        lower: *lower,
                        upper,
                        inverse_base: base.one() / base,
                        designed: line.dot(to_top),
                    }
                }
                (Upper::Arm { circle, .. }, UpperRoles::Arm(arm)) => {
                    UpperEnd::Arm(Legs::of(*arm, design, circle))
                }
                _ => unreachable!("the closed form has these roles"),
            },
            tie_rod: designed(roles.tie_rod_outer) - designed(roles.tie_rod_inner),
        }
    }
}

impl<'a, T: Real> Adjoint<'a, T> {
    /// Prepares gradients in a state, which is the same pose as the configuration `at`. `ball_joint_velocity` and
    /// `turn` are the velocity of the lower ball joint and the angular velocity of the knuckle, both per unit of
    /// travel.
    #[inline(always)]
    pub(crate) fn of(
        roles: &'a Roles,
        members: &'a Members<T>,
        form: &ClosedForm<T>,
        state: &ArmState<T>,
        at: &'a Configuration<'a, T>,
        ball_joint_velocity: Vector3<T>,
        turn: Vector3<T>,
    ) -> Self {
        let (d, g) = (state.d, state.g);
        let one = state.dd.one();
        let (free, lever) = form.upper.free(state, &form.line);
        let tie_rod_lever = state.ga * state.gram;
        let inverse = one / (lever * tie_rod_lever);
        let outer = state.tie_rod_outer();
        let tie_rod = outer - g;
        let [x, y, z] = at.pose.rotation.columns;
        let centre = state.carry(&form.wheel_centre);
        Adjoint {
            roles,
            members,
            at,
            ball_joint_velocity,
            turn,
            d,
            tie_rod,
            tie_rod_in_knuckle: at.pose.rotation.apply_transposed(tie_rod),
            tie_rod_moment: outer.cross(tie_rod),
            inverse_tie_rod_lever: inverse * lever,
            travel_moment: Vector3::new(centre.y, -centre.x, one.zero()),
            up_in_knuckle: Vector3::new(x.z, y.z, z.z),
            free: free * (inverse * tie_rod_lever),
            lower_arm: members.lower_arm.at(state.ball_joint),
            upper: match &members.upper {
                UpperEnd::Strut {
                    inverse_base,
                    designed,
                    ..
                } => UpperJoint::Strut((state.slide - *designed) * *inverse_base),
                UpperEnd::Arm(legs) => UpperJoint::Arm(legs.at(state.ball_joint + d)),
            },
        }
    }

    /// Subtracts mu . F_p (constraint forces times derivatives of the closure equations, as in this module) from the
    /// gradient of an output. `wrench` is y_x, the derivative of the output with respect to the pose.
    #[inline(always)]
    pub(crate) fn subtract(&self, wrench: &Wrench<T>, gradient: &mut (impl Gradient<T> + ?Sized)) {
        let sink = &mut HardpointGradient(gradient);
        let Wrench { force, moment, .. } = *wrench;
        let travel = force.dot(self.ball_joint_velocity) + moment.dot(self.turn);
        let moment = moment.plus_scaled(self.travel_moment, -travel);
        let tie_rod = self.d.dot(moment) * self.inverse_tie_rod_lever;
        let moment = moment.plus_scaled(self.tie_rod_moment, -tie_rod);
        let at_upper = moment.cross(self.free);
        let mut at_arm = (force - at_upper).plus_scaled(self.tie_rod, -tie_rod);
        at_arm.z = at_arm.z - travel;

        let (roles, members) = (self.roles, self.members);
        let in_knuckle = self.tie_rod_in_knuckle;
        let Vector3 { x, y, z } = self.up_in_knuckle;
        let up = Vector3::new(-x, -y, z.one() - z);
        sink.hardpoint(
            roles.tie_rod_inner,
            (self.tie_rod - members.tie_rod) * tie_rod,
        );
        sink.hardpoint(
            roles.tie_rod_outer,
            (members.tie_rod - in_knuckle) * tie_rod,
        );
        sink.hardpoint(roles.wheel_centre, up * travel);
        let upper = self.at.pose.rotation.apply_transposed(at_upper);
        let origin = upper
            .plus_scaled(in_knuckle, tie_rod)
            .plus_scaled(self.up_in_knuckle, travel);
        members.lower_arm.add(&self.lower_arm, at_arm, origin, sink);
        match (&members.upper, &self.upper) {
            (
                UpperEnd::Strut {
                    top,
                    lower,
                    upper: second,
                    ..
                },
                UpperJoint::Strut(slid),
            ) => {
                let by_direction = upper * *slid;
                sink.hardpoint(*top, at_upper - upper);
                sink.hardpoint(*lower, by_direction);
                sink.hardpoint(*second, -by_direction);
            }
            (UpperEnd::Arm(legs), UpperJoint::Arm(joint)) => {
                legs.add(joint, at_upper, -upper, sink);
            }
            _ => unreachable!("the joint belongs to one of the members"),
        }
    }
}

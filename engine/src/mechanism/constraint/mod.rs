//! Closure equations, one file for each kind of constraint.
//!
//! A constraint has a residual F in equation (1) and a differential in equation (2):
//!
//! ```text
//! F(pose, rack, hardpoints) = 0                                                    (1)
//! dF = f . d(origin) + m . d(rotation) + q d(rack) + sum over hardpoints g . dh    (2)
//! ```
//!
//! The force f and the moment m are a row of the 6x6 Jacobian. For most constraints, they are the Pluecker coordinates of the
//! line along which the constraint acts. q is the force on the rack. With the gradients g, the implicit function theorem gives
//! derivatives with respect to hardpoints. Each row is scaled to a length, so forces are about one and moments about one
//! length.
//!
//! Consider a motion of the knuckle with velocity v of its origin and angular velocity w. Equation (3) gives the rate of a
//! vector r that is fixed in the knuckle. The rates of a wrench, equation (4), follow from equation (3) by the product
//! rule, with the rack fixed. The file of each constraint derives its rates.
//!
//! ```text
//! r' = w x r                                                                       (3)
//! (f, m, q)' = d/dt (f, m, q) along (v, w)                                         (4)
//! ```

mod arm_angle;
mod arm_end;
mod axle_travel;
mod link;
mod revolute;
mod rocker_end;
mod strut_line;

pub use arm_angle::raises_its_joint;
pub(crate) use arm_angle::{ArmAngle, axis_ends};
pub(crate) use arm_end::{ArmEnd, PartDimensions};
use arm_end::{built, designed};
pub(crate) use axle_travel::{TravelRow, heights_at_rest};
use link::{Link, RodLength};
use revolute::Pinned;
use rocker_end::RockerEnd;
use strut_line::StrutLine;

use super::pose::{Configuration, Sink, Twist, Wrench};
use crate::model::{Body, Constraint, Mechanism, PointId};
use crate::number::Vector3;
use crate::number::{Each, Real};

/// One scalar constraint, with all its terms that depend only on the design.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Row<T> {
    Link(Link<T>),
    StrutLine(StrutLine<T>),
    Pinned(Pinned<T>),
    AxleTravel(TravelRow<T>),
    ArmEnd(ArmEnd<T>),
    RockerEnd(RockerEnd<T>),
}

/// Calls a method of the equation that a [`Row`] contains.
macro_rules! row {
    ($row:expr, $equation:ident => $call:expr) => {
        match $row {
            Row::Link($equation) => $call,
            Row::StrutLine($equation) => $call,
            Row::Pinned($equation) => $call,
            Row::AxleTravel($equation) => $call,
            Row::ArmEnd($equation) => $call,
            Row::RockerEnd($equation) => $call,
        }
    };
}

impl<T: Real> Row<T> {
    /// Makes equation `number` of a constraint, with the dimensions of a design.
    #[inline(always)]
    pub(crate) fn of(
        mechanism: &Mechanism,
        constraint: Constraint,
        number: usize,
        design: &[Vector3<T>],
    ) -> Row<T> {
        let origin = mechanism.origin;
        match constraint {
            Constraint::Link { inner, outer } => {
                let length = RodLength::of_design(inner, outer, design);
                let ends = [inner, outer];
                match mechanism.body(inner) {
                    Body::Arm(arm) => {
                        let place = designed(mechanism, arm, inner, design);
                        Row::ArmEnd(ArmEnd::link(arm, ends, place, length))
                    }
                    _ => Row::rod(mechanism, ends, length),
                }
            }
            Constraint::StrutLine { top, lower, upper } => {
                Row::StrutLine(StrutLine::both(top, lower, upper, design, origin)[number])
            }
            Constraint::Revolute { first, second } => {
                Row::Pinned(Pinned::all(first, second, design, design, origin)[number])
            }
            // A mount has two of the three equations of a ball joint: the equations along x and z.
            Constraint::Mount { at } => Row::Pinned(Pinned::point(at, design, origin)[2 * number]),
            Constraint::BallJoint { at } => Row::Pinned(Pinned::point(at, design, origin)[number]),
            Constraint::ArmJoint { arm, at } => {
                let place = designed(mechanism, arm, at, design);
                Row::ArmEnd(ArmEnd::joint(mechanism, arm, at, number, place, design))
            }
            Constraint::AxleTravel { near, far, held } => {
                let centres = [near, far];
                let zeros = heights_at_rest(mechanism, centres, design);
                Row::AxleTravel(TravelRow::new(centres, held, zeros))
            }
        }
    }

    /// Makes equation `number` of the constraint with this index in the mechanism, with the dimensions of built parts.
    #[inline(always)]
    pub(crate) fn of_parts(
        mechanism: &Mechanism,
        constraint: usize,
        number: usize,
        parts: PartDimensions<T>,
    ) -> Row<T> {
        let length = parts.lengths[constraint];
        match mechanism.constraints[constraint] {
            Constraint::Link { inner, outer } => {
                let length = RodLength::of_squared(length.squared());
                let ends = [inner, outer];
                match mechanism.body(inner) {
                    Body::Arm(arm) => {
                        let place = built(mechanism, arm, parts.body[inner.0], parts);
                        Row::ArmEnd(ArmEnd::link(arm, ends, place, length))
                    }
                    _ => Row::rod(mechanism, ends, length),
                }
            }
            Constraint::Revolute { first, second } => {
                let all = Pinned::all(first, second, parts.body, parts.knuckle, mechanism.origin);
                Row::Pinned(all[number])
            }
            Constraint::ArmJoint { arm, at } => {
                let place = built(mechanism, arm, parts.drawn[at.0], parts);
                Row::ArmEnd(ArmEnd::joint(
                    mechanism,
                    arm,
                    at,
                    number,
                    place,
                    parts.drawn,
                ))
            }
            // The travels of an assembled axle count from the nominal heights of the wheel centres.
            Constraint::AxleTravel { near, far, held } => {
                let centres = [near, far];
                let zeros = centres.each(|id| parts.drawn[id.0].z);
                Row::AxleTravel(TravelRow::new(centres, held, zeros))
            }
            constraint => Row::of(mechanism, constraint, number, parts.knuckle),
        }
    }

    /// Makes the equation of a rod that has no end on an arm. Its ends may be on a rocker.
    #[inline(always)]
    fn rod(mechanism: &Mechanism, [inner, outer]: [PointId; 2], length: RodLength<T>) -> Row<T> {
        match [inner, outer].each(|id| mechanism.body(id)) {
            [Body::Rocker(_), _] | [_, Body::Rocker(_)] => {
                let link = RockerEnd {
                    inner,
                    outer,
                    length,
                };
                Row::RockerEnd(link)
            }
            _ => Row::Link(Link {
                inner,
                outer,
                length,
            }),
        }
    }

    /// Residual of the constraint, as a length: F in equation (1) of this module.
    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        row!(self, row => row.residual(at))
    }

    /// Adds `weight` times the derivatives of the residual, equation (2) of this module, to the sink.
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        row!(self, row => row.differential(at, weight, sink));
    }

    /// Rates of the force f, the moment m and the rack force q of equation (2), along a motion of the knuckle. The rack is fixed.
    /// See equation (4) of this module.
    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        row!(self, row => row.wrench_rate(at, along))
    }
}

/// Two unit vectors that form a right-handed frame with the given one, without a branch (T. Duff et al., "Building an
/// Orthonormal Basis, Revisited", Journal of Computer Graphics Techniques 6(1), 2017). `sign` is the sign of z of this
/// vector or of a nearby one. The result depends smoothly on the vector while `sign` does not change.
#[inline(always)]
fn normals<T: Real>(along: Vector3<T>, sign: T) -> [Vector3<T>; 2] {
    let Vector3 { x, y, z } = along;
    let one = z.one();
    let a = -(one / (sign + z));
    let first = Vector3::new(one + sign * x * x * a, sign * x * y * a, -(sign * x));
    [first, along.cross(first)]
}

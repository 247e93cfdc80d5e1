//! The closure equations, one file for each kind.
//!
//! An equation is a residual F and, beside it, its differential
//!
//! ```text
//! dF = force . d(origin) + moment . d(rotation) + sum over hardpoints gradient . d(hardpoint)
//! ```
//!
//! Force and moment are a row of the 6x6 Jacobian: the Pluecker coordinates of the line along which the
//! constraint acts. The gradients are the rest of the implicit function theorem. Rows are scaled to
//! lengths, so that forces are about one and moments about one length.

mod arm_angle;
mod link;
mod revolute;
mod strut_line;

pub use arm_angle::raises_its_joint;
pub(crate) use arm_angle::{ArmAngle, axis_ends};
use link::Link;
use revolute::Pinned;
use strut_line::StrutLine;

use super::pose::{Configuration, Sink, Twist, Wrench};
use crate::model::{Constraint, PointId};
use crate::number::Real;
use crate::number::Vector3;

/// One scalar constraint, with all its terms that depend only on the design.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Row<T> {
    Link(Link<T>),
    StrutLine(StrutLine<T>),
    Pinned(Pinned<T>),
}

impl<T: Real> Row<T> {
    /// Row `number` of a constraint, for a design.
    #[inline(always)]
    pub(crate) fn of(
        constraint: Constraint,
        number: usize,
        design: &[Vector3<T>],
        origin: PointId,
    ) -> Row<T> {
        match constraint {
            Constraint::Link { inner, outer } => Row::Link(Link::new(inner, outer, design)),
            Constraint::StrutLine { top, lower, upper } => {
                Row::StrutLine(StrutLine::both(top, lower, upper, design, origin)[number])
            }
            Constraint::Revolute { first, second } => {
                Row::Pinned(Pinned::all(first, second, design, design, origin)[number])
            }
        }
    }

    /// Row `number` of a constraint, for parts with dimensions of their own: the points of the body, every point where
    /// the undisplaced knuckle carries it, and the length of a rod.
    #[inline(always)]
    pub(crate) fn of_parts(
        constraint: Constraint,
        number: usize,
        [body, knuckle]: [&[Vector3<T>]; 2],
        length: T,
        origin: PointId,
    ) -> Row<T> {
        match constraint {
            Constraint::Link { inner, outer } => {
                Row::Link(Link::of_squared_length(inner, outer, length.squared()))
            }
            Constraint::StrutLine { .. } => Row::of(constraint, number, knuckle, origin),
            Constraint::Revolute { first, second } => {
                Row::Pinned(Pinned::all(first, second, body, knuckle, origin)[number])
            }
        }
    }

    /// F, as a length.
    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        match self {
            Row::Link(row) => row.residual(at),
            Row::StrutLine(row) => row.residual(at),
            Row::Pinned(row) => row.residual(at),
        }
    }

    /// Adds `weight` times the differential to the sink.
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        match self {
            Row::Link(row) => row.differential(at, weight, sink),
            Row::StrutLine(row) => row.differential(at, weight, sink),
            Row::Pinned(row) => row.differential(at, weight, sink),
        }
    }

    /// Rates of change of the differential's force, moment and rack force along a motion of the knuckle, with the rack held.
    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        match self {
            Row::Link(row) => row.wrench_rate(at, along),
            Row::StrutLine(row) => row.wrench_rate(at, along),
            Row::Pinned(row) => row.wrench_rate(at, along),
        }
    }
}

/// Two unit vectors that form a right-handed frame with the given one, without a branch (T. Duff et al.,
/// "Building an Orthonormal Basis, Revisited", Journal of Computer Graphics Techniques 6(1), 2017). They depend smoothly on
/// the vector as long as `sign` stays, which is the sign of its z or of that of a vector nearby.
#[inline(always)]
fn normals<T: Real>(along: Vector3<T>, sign: T) -> [Vector3<T>; 2] {
    let Vector3 { x, y, z } = along;
    let one = z.one();
    let a = -(one / (sign + z));
    let first = Vector3::new(one + sign * x * x * a, sign * x * y * a, -(sign * x));
    [first, along.cross(first)]
}

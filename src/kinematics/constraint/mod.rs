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

pub(super) use arm_angle::{ArmAngle, axis_ends};
use link::Link;
use revolute::Pinned;
use strut_line::StrutLine;

use super::pose::{Posture, Sink};
use crate::model::Constraint;
use crate::number::{Scalar, Vector3};

/// One scalar constraint, with what of it depends on the design alone.
#[derive(Clone, Copy, Debug)]
pub(super) enum Row<T> {
    Link(Link<T>),
    StrutLine(StrutLine<T>),
    Pinned(Pinned<T>),
}

impl<T: Scalar> Row<T> {
    /// Appends the rows of a constraint.
    pub(super) fn prepare(constraint: Constraint, design: &[Vector3<T>], rows: &mut Vec<Row<T>>) {
        match constraint {
            Constraint::Link { inner, outer } => {
                rows.push(Row::Link(Link::new(inner, outer, design)));
            }
            Constraint::StrutLine { top, lower, upper } => {
                rows.extend(StrutLine::both(top, lower, upper, design).map(Row::StrutLine));
            }
            Constraint::Revolute { first, second } => {
                rows.extend(Pinned::all(first, second, design).map(Row::Pinned));
            }
        }
    }

    /// F, as a length.
    #[inline]
    pub(super) fn residual(&self, at: &Posture<T>) -> T {
        match self {
            Row::Link(row) => row.residual(at),
            Row::StrutLine(row) => row.residual(at),
            Row::Pinned(row) => row.residual(at),
        }
    }

    /// Adds `weight` times the differential to the sink.
    #[inline]
    pub(super) fn differential(&self, at: &Posture<T>, weight: T, sink: &mut impl Sink<T>) {
        match self {
            Row::Link(row) => row.differential(at, weight, sink),
            Row::StrutLine(row) => row.differential(at, weight, sink),
            Row::Pinned(row) => row.differential(at, weight, sink),
        }
    }
}

/// Two unit vectors that form a right-handed frame with the given one.
fn normals<T: Scalar>(along: Vector3<T>) -> [Vector3<T>; 2] {
    let size = along.map(|c| c.value().abs());
    let helper = if size.x <= size.y && size.x <= size.z {
        Vector3::new(1.0, 0.0, 0.0)
    } else if size.y <= size.z {
        Vector3::new(0.0, 1.0, 0.0)
    } else {
        Vector3::new(0.0, 0.0, 1.0)
    };
    let first = along.cross(along.lit(helper)).normalised();
    [first, along.cross(first)]
}

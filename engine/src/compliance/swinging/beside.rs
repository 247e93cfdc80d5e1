//! Forces of an arm that depend on coordinates in addition to the carrier's motion: the displacement of the spring's
//! upper end and the twist of the anti-roll bar. The rotations of the arm are eliminated.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

use super::super::algebra::cross_matrix;
use super::super::limb::{BESIDE, Beside, eliminated, tangent_of};
use super::super::point::PointForce;
use super::{InnerEquations, OwnSum, Pivot, entries};
use crate::number::{Matrix3, Real, Valued, Vector3, array_of, outlined};

/// Forces of an arm on the coordinates in [`Beside`], before the rotations of the arm are eliminated. The tangents of
/// the arm's forces with respect to these coordinates are the transposed matrices.
pub(super) struct OwnBeside<T> {
    pub(super) force: [T; BESIDE],
    pub(super) own: [[T; BESIDE]; BESIDE],
    pub(super) by_joint: [Vector3<T>; BESIDE],
    pub(super) by_turn: [Vector3<T>; BESIDE],
}

impl<T: Valued> OwnBeside<T> {
    pub(super) fn zero(like: T) -> Self {
        let zero = like.zero();
        let nothing = Vector3::new(zero, zero, zero);
        OwnBeside {
            force: [zero; BESIDE],
            own: [[zero; BESIDE]; BESIDE],
            by_joint: [nothing; BESIDE],
            by_turn: [nothing; BESIDE],
        }
    }

    /// Adds a force at a point of the arm. The force depends on the displacement of this point relative to the spring's
    /// upper end.
    pub(super) fn add_upper(&mut self, lever: Vector3<T>, point: &PointForce<T>) {
        let turning = point.stiffness.times(&cross_matrix(lever));
        for k in 0..3 {
            self.force[k] = -point.force.to_array()[k];
            for j in 0..3 {
                self.own[k][j] = point.stiffness.entry(k, j);
            }
            let row = |m: &Matrix3<T>| Vector3::new(m.entry(k, 0), m.entry(k, 1), m.entry(k, 2));
            self.by_joint[k] = -row(&point.stiffness);
            self.by_turn[k] = row(&turning);
        }
    }

    /// Eliminates the rotations of the arm, and the forces in its ball joint.
    #[inline(always)]
    pub(super) fn condense(
        &self,
        arm: &OwnSum<T>,
        pivot: Option<&Pivot<T>>,
        lever: Vector3<T>,
        into: &mut Beside<T>,
    ) -> Option<()> {
        outlined!(
            [T: Valued] lever.x;
            own: &'p OwnBeside<T> = self, arm: &'p OwnSum<T> = arm, pivot: Option<&'p Pivot<T>> = pivot,
            lever: Vector3<T> = lever, into: &'p mut Beside<T> = into => Option<()> {
                match pivot {
                    None => {
                        let rows: [[T; 3]; 3] = entries(&arm.by_turn);
                        let by_joint: [[T; 3]; 3] = entries(&arm.moment_by_joint);
                        let joint_by: [[T; 3]; 3] = entries(&arm.joint_by_turn);
                        let inner = (rows, arm.moment.to_array(), by_joint, joint_by);
                        own.condense_on(inner, arm.is_correction, lever, into)
                    }
                    Some(pivot) => own.condense_on(arm.with_pivot(pivot), arm.is_correction, lever, into),
                }
            }
        )
    }

    #[inline(always)]
    fn condense_on<const N: usize>(
        &self,
        (rows, force, by_joint, joint_by): InnerEquations<T, N>,
        is_correction: bool,
        lever: Vector3<T>,
        into: &mut Beside<T>,
    ) -> Option<()> {
        let zero = force[0].zero();
        let turning: [[T; 3]; BESIDE] = array_of(|k| self.by_turn[k].to_array());
        let by: [[T; BESIDE]; N] =
            array_of(|i| array_of(|k| if i < 3 { turning[k][i] } else { zero }));
        let units = [zero.plain_value().one(); N];
        let own = eliminated(rows, force, &by, units, is_correction)?;
        let outer = eliminated(rows, force, &by_joint, units, is_correction)?;
        for k in 0..BESIDE {
            let mut row = self.by_joint[k].to_array();
            let mut column = row;
            into.force[k] = self.force[k];
            for i in 0..3 {
                let turning_by = tangent_of(turning[k][i], is_correction);
                into.force[k] = into.force[k] - turning_by * own.rest[i];
                for (row, by) in row.iter_mut().zip(outer.by[i]) {
                    *row = *row - turning[k][i] * by;
                }
            }
            for (column, by) in column.iter_mut().zip(joint_by) {
                for i in 0..N {
                    *column = *column - by[i] * own.by[i][k];
                }
            }
            for j in 0..BESIDE {
                into.own[k][j] = self.own[k][j];
                for i in 0..3 {
                    into.own[k][j] = into.own[k][j] - turning[k][i] * own.by[i][j];
                }
            }
            into.couple(k, lever, Vector3::from(row), Vector3::from(column));
        }
        for (inner, by) in into.inner_by.iter_mut().zip(own.by) {
            *inner = by;
        }
        Some(())
    }
}

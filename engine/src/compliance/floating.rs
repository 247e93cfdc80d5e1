//! Links with a bushing at the carrier. Such a link has six inner unknowns, or three if its joint at the body is a ball
//! joint.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

use super::algebra::{Placed, cross_matrix};
use super::bushing::{Bushing, BushingState};
use super::limb::{
    Conditions, Eliminated, Evaluated, Followers, LimbState, Sum, eliminated, is_positive,
    tangent_of,
};
use crate::number::{Matrix3, Real, Valued, Vector3, outlined};

/// Link with a bushing at the carrier. Its reference point is its inner end.
#[derive(Clone, Debug)]
pub(super) struct Floating<T> {
    /// Vector from the inner to the outer end of the link, in the design position.
    pub(super) along: Vector3<T>,
    pub(super) on_rack: bool,
    /// Bushing at the inner end; `None` for a ball joint.
    pub(super) inner: Option<Bushing<T>>,
    /// Bushing at the carrier.
    pub(super) outer: Bushing<T>,
    /// Vector from the carrier's reference point to the outer end of the link.
    pub(super) joint: Vector3<T>,
    /// Vector along the link's line. The square of its length is a stiffness against rotation about this line, as in
    /// `Swinging::spin`.
    pub(super) spin: Vector3<T>,
}

impl<T: Valued> Floating<T> {
    /// Returns the position of the link. It includes the shift of the link's inner end.
    #[inline(always)]
    fn placed(&self, at: &Conditions<T>, state: &LimbState<T>) -> Placed<T> {
        let shift = match self.inner {
            Some(_) => state.placed.shift,
            None => at.ground(self.on_rack),
        };
        Placed {
            shift,
            turn: state.placed.turn,
        }
    }

    /// Returns two deflections of the outer bushing by equation (1) of `bushing.rs`: the vector e, and the rotation
    /// R_i' R_j - I between carrier and link.
    #[inline(always)]
    fn at_carrier(&self, at: &Conditions<T>, own: &Placed<T>) -> (Vector3<T>, Matrix3<T>) {
        let e = own.displacement(self.along) - at.carrier.displacement(self.joint);
        let back = at.carrier.turn.transposed();
        let turn = back.plus(&own.turn).plus(&back.times(&own.turn));
        (e, turn)
    }

    /// Returns the states of the link's bushings: first the inner bushing, then the outer bushing.
    pub(super) fn bushing_states(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
    ) -> [Option<BushingState<T>>; 2] {
        let own = self.placed(at, state);
        let inner = self
            .inner
            .as_ref()
            .map(|bushing| bushing.state(own.shift - at.ground(self.on_rack), &own.turn));
        let (e, turn) = self.at_carrier(at, &own);
        let in_carrier = at.carrier.rotation().apply_transposed(e);
        [inner, Some(self.outer.state(in_carrier, &turn))]
    }

    #[inline(always)]
    pub(super) fn evaluate(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
    ) -> Option<Evaluated<T>> {
        outlined!(
            [T: Valued] at.rack;
            own: &'p Floating<T> = self, at: &'p Conditions<T> = at, state: &'p LimbState<T> = state,
            held: &'p [T; 7] = held, sum: &'p mut Sum<T> = sum => Option<Evaluated<T>> {
                own.evaluate_inline(at, state, held, sum)
            }
        )
    }

    #[inline(always)]
    fn evaluate_inline(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
    ) -> Option<Evaluated<T>> {
        let like = at.rack;
        let own = self.placed(at, state);
        let (e, turn) = self.at_carrier(at, &own);
        let rotation = at.carrier.rotation();
        let outer = at.force(&self.outer, e, &turn, Some(&rotation));
        // Tangents with respect to four motions: the displacement of the outer point p, the carrier's shift u and
        // rotation q, and the link's rotation w.
        let arm = own.lever(self.along);
        let lever = at.carrier.lever(self.joint) + e;
        let (f, k, n) = (outer.force, outer.by_shift, outer.by_turn);
        let f_q = cross_matrix(f).negated().plus(&k.times_cross(lever));
        let m_q = cross_matrix(outer.moment).negated().plus(&n.negated());
        // The derivatives of the outer bushing's energy with respect to the link are the force f at p and a torque. The
        // link's unknowns are its shift v and rotation w.
        let k_arm = k.times_cross(arm).negated();
        let mut own_rows = [[Matrix3::null(like); 2]; 2];
        own_rows[0] = [k, k_arm];
        let ww = k_arm
            .crossed_by(arm)
            .plus(&cross_matrix(arm).crossed_by(f))
            .plus(&n);
        own_rows[1] = [k.crossed_by(arm), ww];
        let mut forces = [f, arm.cross(f) + outer.moment];
        let by_carrier = [
            [k.negated(), f_q],
            [k.crossed_by(arm).negated(), f_q.crossed_by(arm).plus(&m_q)],
        ];
        if let Some(bushing) = &self.inner {
            let e = own.shift - at.ground(self.on_rack);
            let inner = at.force(bushing, e, &own.turn, None);
            forces[0] = forces[0] + inner.force;
            forces[1] = forces[1] + inner.moment;
            own_rows[0][0] = own_rows[0][0].plus(&inner.by_shift);
            own_rows[1][1] = own_rows[1][1].plus(&inner.by_turn);
        }
        if at.balance_only {
            own_rows[1][1].add_product(self.spin, self.spin, like.one());
        }
        // Derivatives of the link's equations with respect to motions of the carrier. On the carrier act the force -f at the
        // link's end p, and the negative of the torque on the link.
        let carrier_by_link = [
            [k.negated(), k_arm.negated()],
            [
                cross_matrix(f).plus(&k.crossed_by(lever).negated()),
                cross_matrix(f)
                    .times_cross(arm)
                    .negated()
                    .plus(&k_arm.crossed_by(lever).negated())
                    .plus(&n.negated()),
            ],
        ];
        let carrier_own = [
            [k, f_q.negated()],
            [
                cross_matrix(f).negated().plus(&k.crossed_by(lever)),
                f_q.crossed_by(lever).negated().plus(&m_q.negated()),
            ],
        ];
        sum.add_force(-f, -(lever.cross(f) + outer.moment));
        let [[a, b], [c, d]] = &carrier_own;
        sum.add_blocks([[a, b], [c, d]]);
        let blocks = LinkBlocks {
            own: own_rows,
            forces,
            by_carrier,
            carrier_by_link,
            length: self.along.norm().plain_value(),
            is_correction: at.is_correction,
        };
        match self.inner {
            Some(_) => blocks.eliminate::<6>(0, held, sum),
            None => blocks.eliminate::<3>(3, held, sum),
        }
    }
}

/// 3 x 3 blocks of a link's equations: derivatives with respect to the shift and the rotation of the link and of the
/// carrier.
struct LinkBlocks<T: Valued> {
    own: [[Matrix3<T>; 2]; 2],
    forces: [Vector3<T>; 2],
    by_carrier: [[Matrix3<T>; 2]; 2],
    carrier_by_link: [[Matrix3<T>; 2]; 2],
    /// Length of the link.
    length: T::Plain,
    /// True if the tangents can be constants, because the step only adds derivatives (see
    /// [`Conditions::is_correction`]).
    is_correction: bool,
}

impl<T: Valued> LinkBlocks<T> {
    /// Eliminates `N` unknowns of the link from its equations, starting with the unknown of index `first`.
    #[inline(always)]
    fn eliminate<const N: usize>(
        &self,
        first: usize,
        held: &[T; 7],
        sum: &mut Sum<T>,
    ) -> Option<Evaluated<T>> {
        let like = self.forces[0].x;
        let (all_own, all_by) = (by_rows(&self.own), by_rows(&self.by_carrier));
        let [f, m] = self.forces;
        let forces = [f.x, f.y, f.z, m.x, m.y, m.z];
        let mut own = [[like; N]; N];
        let mut by = [[like; 6]; N];
        let mut force = [like; N];
        let mut inner = [like.zero(); 7];
        let mut units = [self.length; N];
        for i in 0..N {
            for j in 0..N {
                own[i][j] = all_own[first + i][first + j];
            }
            by[i] = all_by[first + i];
            force[i] = forces[first + i] - held[i];
            inner[i] = force[i];
            if first + i < 3 {
                units[i] = self.length.one();
            }
        }
        let found = eliminated(own, force, &by, units, self.is_correction)?;
        let Eliminated { rest, by, .. } = found;
        let carrier_by = by_rows(&self.carrier_by_link);
        for i in 0..6 {
            for k in 0..N {
                let factor = tangent_of(carrier_by[i][first + k], self.is_correction);
                sum.force[i] = sum.force[i].minus_product(factor, rest[k]);
                for j in 0..6 {
                    sum.tangent[i][j] = sum.tangent[i][j].minus_product(factor, by[k][j]);
                }
            }
        }
        let mut followers = Followers::none(like);
        followers.count = N;
        followers.by[..N].copy_from_slice(&by);
        followers.rest[..N].copy_from_slice(&rest);
        Some(Evaluated {
            followers,
            inner,
            is_stable: is_positive(&own, 0.0),
            least_pivot: found.least_pivot,
        })
    }
}

/// Entries of four 3 x 3 blocks as a 6 x 6 matrix, row by row.
#[inline(always)]
fn by_rows<T: Valued>(blocks: &[[Matrix3<T>; 2]; 2]) -> [[T; 6]; 6] {
    let mut rows = [[blocks[0][0].columns[0].x; 6]; 6];
    for i in 0..2 {
        for j in 0..2 {
            for k in 0..3 {
                let Vector3 { x, y, z } = blocks[i][j].columns[k];
                rows[3 * i][3 * j + k] = x;
                rows[3 * i + 1][3 * j + k] = y;
                rows[3 * i + 2][3 * j + k] = z;
            }
        }
    }
    rows
}

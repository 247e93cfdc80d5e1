//! Arms on bushings, and links with a ball joint at the carrier: parts that rotate about their outer joint.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

mod beside;

use super::bushing::{Bushing, BushingState};
use super::limb::{
    Beside, Conditions, Eliminated, Evaluated, Followers, LimbState, Sum, TWIST_BESIDE, eliminated,
    is_positive, tangent_of,
};
use super::point::{BarSeat, PointForce, Seat};
use crate::number::{MaskOf, Matrix3, Real, SimdReal, Valued, Vector3, outlined};
use beside::OwnBeside;

/// End of an arm or a link at the body or the rack.
#[derive(Clone, Debug)]
pub(super) struct End<T> {
    /// Vector from the part's reference point to this end, in the design position.
    pub(super) lever: Vector3<T>,
    pub(super) on_rack: bool,
    /// Bushing at this end; `None` for a ball joint.
    pub(super) bushing: Option<Bushing<T>>,
    /// Two unit vectors normal to the lever in the design position. They are fixed in the holder. The force in a ball joint
    /// acts along these vectors.
    pub(super) normals: [Vector3<T>; 2],
}

/// Arm, or link with a ball joint at the carrier. This outer joint is the reference point of the part. The inner
/// unknowns are three rotations. If an inner end of an arm is a ball joint, its distance to the outer joint is constant.
/// A rigid rod keeps this distance. Two forces in the ball joint are then further inner unknowns.
#[derive(Clone, Debug)]
pub(super) struct Swinging<T> {
    /// Vector from the carrier's reference point to the outer joint.
    pub(super) joint: Vector3<T>,
    pub(super) ends: Vec<End<T>>,
    /// Spring on the arm, with the vector from the outer joint to the point on which it acts.
    pub(super) seat: Option<(Vector3<T>, Seat<T>)>,
    /// Drop link of an anti-roll bar on the arm, with the vector from the outer joint to its outer end.
    pub(super) bar: Option<(Vector3<T>, BarSeat<T>)>,
    /// Vector along the line of a link; `None` for an arm. Only torsional stiffness prevents a rotation of the link
    /// about its line. The calculation of the forces at the design load ignores torsion. Instead, it uses the square of
    /// this vector's length as the stiffness against the rotation.
    pub(super) spin: Option<Vector3<T>>,
}

impl<T: Valued> Swinging<T> {
    /// Displacement of an end relative to its holder.
    #[inline(always)]
    pub(super) fn deflection(
        &self,
        end: &End<T>,
        at: &Conditions<T>,
        state: &LimbState<T>,
    ) -> Vector3<T> {
        let joint = at.carrier.displacement(self.joint);
        joint + state.placed.turn.apply(end.lever) - at.ground(end.on_rack)
    }

    /// State of a bushing at an end.
    pub(super) fn bushing_state(
        &self,
        end: &End<T>,
        bushing: &Bushing<T>,
        at: &Conditions<T>,
        state: &LimbState<T>,
    ) -> BushingState<T> {
        bushing.state(self.deflection(end, at, state), &state.placed.turn)
    }

    /// Returns the displacement of a point of the arm. `lever` is the vector from the outer joint to this point, in the
    /// design position.
    #[inline(always)]
    pub(super) fn displacement(
        &self,
        lever: Vector3<T>,
        at: &Conditions<T>,
        state: &LimbState<T>,
    ) -> Vector3<T> {
        at.carrier.displacement(self.joint) + state.placed.turn.apply(lever)
    }

    /// Returns the displacement of the point on which the spring acts. If the spring's upper end is on another body,
    /// the displacement is relative to this end.
    #[inline(always)]
    pub(super) fn seat_displacement(
        &self,
        (lever, seat): &(Vector3<T>, Seat<T>),
        at: &Conditions<T>,
        state: &LimbState<T>,
    ) -> Vector3<T> {
        let moved = self.displacement(*lever, at, state);
        if seat.is_across {
            moved - at.upper
        } else {
            moved
        }
    }

    /// Returns true if the arm depends on the coordinates in [`Beside`].
    pub(super) fn has_beside(&self) -> bool {
        self.bar.is_some() || self.seat.as_ref().is_some_and(|(_, seat)| seat.is_across)
    }

    /// Adds the forces of bushings and ball joints at the inner ends of the part.
    #[inline(always)]
    fn add_ends(&self, at: &Conditions<T>, state: &LimbState<T>, own: &mut OwnSum<T>) {
        for end in &self.ends {
            let lever = state.placed.lever(end.lever);
            match &end.bushing {
                Some(bushing) => {
                    let e = self.deflection(end, at, state);
                    let force = at.force(bushing, e, &state.placed.turn, None);
                    own.add(lever, &PointForce::of(force.force, force.by_shift));
                    own.moment = own.moment + force.moment;
                    own.by_turn = own.by_turn.plus(&force.by_turn);
                }
                None => {
                    let [a, b] = end.normals;
                    let force = a * state.pivot[0] + b * state.pivot[1];
                    own.add(lever, &PointForce::of(force, Matrix3::null(at.rack)));
                }
            }
        }
    }

    #[inline(always)]
    pub(super) fn evaluate(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
        beside: Option<&mut Beside<T>>,
    ) -> Option<Evaluated<T>> {
        outlined!(
            [T: Valued] at.rack;
            own: &'p Swinging<T> = self, at: &'p Conditions<T> = at, state: &'p LimbState<T> = state,
            held: &'p [T; 7] = held, sum: &'p mut Sum<T> = sum,
            beside: Option<&'p mut Beside<T>> = beside => Option<Evaluated<T>> {
                own.evaluate_inline(at, state, held, sum, beside)
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
        beside: Option<&mut Beside<T>>,
    ) -> Option<Evaluated<T>> {
        let like = at.rack;
        let mut own = OwnSum::zero(at);
        let mut own_beside = beside.is_some().then(|| OwnBeside::zero(like));
        self.add_ends(at, state, &mut own);
        let mut followers = Followers::none(like);
        let lever = at.carrier.lever(self.joint);
        followers.joint = Some(lever);
        let mut inner = [like.zero(); 7];
        let mut is_stable = like.plain_value().everywhere();
        if let Some(place) = &self.seat {
            let (seat_lever, seat) = place;
            let moved = self.seat_displacement(place, at, state);
            let force = seat.force(moved, state.slide, held[6], at.balance_only);
            let now = state.placed.lever(*seat_lever);
            if let Some(beside) = own_beside.as_mut().filter(|_| seat.is_across) {
                beside.add_upper(now, &force.point);
            }
            own.add(now, &force.point.leverless_if(at.balance_only));
            followers.slide = force.slide.map(|slide| (now, slide.by, slide.rest));
            inner[6] = force.moment;
            is_stable = force.is_stable;
        }
        if let (Some((bar_lever, bar)), Some(beside), false) =
            (&self.bar, &mut own_beside, at.balance_only)
        {
            let moved = self.displacement(*bar_lever, at, state);
            let force = bar.force(moved, at.twist);
            let now = state.placed.lever(*bar_lever);
            own.add(now, &force.point);
            beside.force[TWIST_BESIDE] = force.torque;
            beside.own[TWIST_BESIDE][TWIST_BESIDE] = bar.rate;
            beside.by_joint[TWIST_BESIDE] = force.by_twist;
            beside.by_turn[TWIST_BESIDE] = now.cross(force.by_twist);
        }
        if at.balance_only
            && let Some(spin) = self.spin
        {
            own.by_turn.add_product(spin, spin, like.one());
        }
        own.moment = own.moment - Vector3::new(held[0], held[1], held[2]);
        (inner[0], inner[1], inner[2]) = (own.moment.x, own.moment.y, own.moment.z);
        let pivot = self.ends.iter().find(|end| end.bushing.is_none());
        let found = match pivot {
            None => {
                if let (Some(beside), Some(own_beside)) = (beside, &own_beside) {
                    own_beside.condense(&own, None, lever, beside)?;
                }
                own.eliminate_turns(&mut followers)?
            }
            Some(end) => {
                let miss = self.deflection(end, at, state);
                let open = [end.normals[0].dot(miss), end.normals[1].dot(miss)];
                (inner[3], inner[4]) = (open[0], open[1]);
                let pivot = Pivot {
                    lever: state.placed.lever(end.lever),
                    normals: end.normals,
                    open: [open[0] - held[3], open[1] - held[4]],
                };
                if let (Some(beside), Some(own_beside)) = (beside, &own_beside) {
                    own_beside.condense(&own, Some(&pivot), lever, beside)?;
                }
                own.eliminate_with_pivot(&pivot, &mut followers)?
            }
        };
        sum.add_point(lever, &own.at_joint);
        Some(Evaluated {
            followers,
            inner,
            is_stable: is_stable & found.is_stable,
            least_pivot: found.least_pivot,
        })
    }
}

/// Sum of the forces on a part and of the moments about its outer joint. The tangents are with respect to the joint's
/// displacement and the part's rotation.
struct OwnSum<T> {
    /// Force at the joint, with its tangent with respect to the joint's displacement.
    at_joint: PointForce<T>,
    joint_by_turn: Matrix3<T>,
    moment: Vector3<T>,
    moment_by_joint: Matrix3<T>,
    by_turn: Matrix3<T>,
    /// True if the tangents can be constants, because the step only adds derivatives (see
    /// [`Conditions::is_correction`]).
    is_correction: bool,
}

/// Ball joint of a part at the body.
struct Pivot<T> {
    lever: Vector3<T>,
    normals: [Vector3<T>; 2],
    /// Gap of the joint along each of its two normals ([`End::normals`]).
    open: [T; 2],
}

/// Inner equations of a part. The first two fields are the matrix and the residuals. The third field contains the
/// derivatives of the residuals with respect to the joint's displacement. The fourth field contains the derivatives of
/// the joint's force with respect to the inner unknowns.
type InnerEquations<T, const N: usize> = ([[T; N]; N], [T; N], [[T; 3]; N], [[T; N]; 3]);

/// Results of the stability check of the inner equations.
struct Firmness<T: Valued> {
    is_stable: MaskOf<T>,
    least_pivot: T::Plain,
}

impl<T: Valued> OwnSum<T> {
    #[inline(always)]
    fn zero(at: &Conditions<T>) -> Self {
        let at_joint = PointForce::none(at.rack.zero());
        let nothing = at_joint.stiffness;
        OwnSum {
            at_joint,
            joint_by_turn: nothing,
            moment: nothing.columns[0],
            moment_by_joint: nothing,
            by_turn: nothing,
            is_correction: at.is_correction,
        }
    }

    /// Adds a force at a point of the part, by equation (3) of `limb.rs`. The shift in this equation is the joint's
    /// displacement.
    #[inline(always)]
    fn add(&mut self, lever: Vector3<T>, point: &PointForce<T>) {
        outlined!(
            [T: Valued] lever.x;
            own: &'p mut OwnSum<T> = self, lever: Vector3<T> = lever, point: &'p PointForce<T> = point => () {
                own.add_inline(lever, point);
            }
        );
    }

    #[inline(always)]
    fn add_inline(&mut self, lever: Vector3<T>, point: &PointForce<T>) {
        let all = &mut self.at_joint;
        all.force = all.force + point.force;
        all.condensed = all.condensed + point.condensed;
        let [[shift, by_turn], [moment, twist]] = point.tangents(lever);
        all.stiffness = all.stiffness.plus(&shift);
        self.joint_by_turn = self.joint_by_turn.plus(&by_turn);
        self.moment = self.moment + lever.cross(point.condensed);
        self.moment_by_joint = self.moment_by_joint.plus(&moment);
        self.by_turn = self.by_turn.plus(&twist);
    }

    /// Eliminates the three rotations of the part from its equations.
    #[inline(always)]
    fn eliminate_turns(&mut self, followers: &mut Followers<T>) -> Option<Firmness<T>> {
        let rows: [[T; 3]; 3] = entries(&self.by_turn);
        let by_joint: [[T; 3]; 3] = entries(&self.moment_by_joint);
        let found = eliminated(
            rows,
            self.moment.to_array(),
            &by_joint,
            [self.moment.x.plain_value().one(); 3],
            self.is_correction,
        )?;
        let mut turn = self.by_turn;
        for k in 0..3 {
            turn.columns[k] = Vector3::new(found.by[0][k], found.by[1][k], found.by[2][k]);
            for j in 0..3 {
                followers.by[k][j] = found.by[k][j];
            }
            followers.rest[k] = found.rest[k];
        }
        followers.count = 3;
        let rest = Vector3::from(found.rest);
        let all = &mut self.at_joint;
        all.stiffness = all
            .stiffness
            .plus(&self.joint_by_turn.times(&turn).negated());
        let joint_by_turn = self
            .joint_by_turn
            .map(|c| tangent_of(c, self.is_correction));
        all.condensed = all.condensed - joint_by_turn.apply(rest);
        Some(Firmness {
            is_stable: is_positive(&rows, 0.0),
            least_pivot: found.least_pivot,
        })
    }

    /// Forms the equations for the three rotations of the part and for the two forces in a ball joint.
    #[inline(always)]
    fn with_pivot(&self, pivot: &Pivot<T>) -> InnerEquations<T, 5> {
        let zero = self.moment.x.zero();
        let own: [[T; 3]; 3] = entries(&self.by_turn);
        let moment_by: [[T; 3]; 3] = entries(&self.moment_by_joint);
        let force_by: [[T; 3]; 3] = entries(&self.joint_by_turn);
        let mut rows = [[zero; 5]; 5];
        let mut by_joint = [[zero; 3]; 5];
        let mut joint_by = [[zero; 5]; 3];
        let [x, y, z] = self.moment.to_array();
        let force = [x, y, z, pivot.open[0], pivot.open[1]];
        for i in 0..3 {
            for j in 0..3 {
                rows[i][j] = own[i][j];
                by_joint[i][j] = moment_by[i][j];
                joint_by[i][j] = force_by[i][j];
            }
        }
        for k in 0..2 {
            let normal = pivot.normals[k];
            let turning = pivot.lever.cross(normal).to_array();
            let along = normal.to_array();
            for i in 0..3 {
                rows[3 + k][i] = turning[i];
                rows[i][3 + k] = turning[i];
                by_joint[3 + k][i] = along[i];
                joint_by[i][3 + k] = along[i];
            }
        }
        (rows, force, by_joint, joint_by)
    }

    /// Eliminates the three rotations of the part and the two forces in a ball joint. These forces are normal to the
    /// vector from the outer joint to the ball joint in the design position. With both joints held, the part can only
    /// rotate about this vector.
    #[inline(always)]
    fn eliminate_with_pivot(
        &mut self,
        pivot: &Pivot<T>,
        followers: &mut Followers<T>,
    ) -> Option<Firmness<T>> {
        let zero = self.moment.x.zero();
        let (rows, force, by_joint, joint_by) = self.with_pivot(pivot);
        let unit = zero.plain_value().one();
        let Eliminated { rest, by, .. } =
            eliminated(rows, force, &by_joint, [unit; 5], self.is_correction)?;
        let mut less = [zero; 3];
        let mut change = [[zero; 3]; 3];
        for i in 0..3 {
            for k in 0..5 {
                let factor = joint_by[i][k];
                less[i] = less[i] + tangent_of(factor, self.is_correction) * rest[k];
                for j in 0..3 {
                    change[j][i] = change[j][i] - factor * by[k][j];
                }
            }
        }
        for k in 0..5 {
            for j in 0..3 {
                followers.by[k][j] = by[k][j];
            }
            followers.rest[k] = rest[k];
        }
        followers.count = 5;
        let all = &mut self.at_joint;
        let [a, b, c] = change;
        let columns = [Vector3::from(a), Vector3::from(b), Vector3::from(c)];
        all.stiffness = all.stiffness.plus(&Matrix3 { columns });
        all.condensed = all.condensed - Vector3::from(less);
        let along = pivot.lever.normalised();
        let about = along.dot(self.by_turn.apply(along)).plain_value();
        let [x, y, z] = self.by_turn.columns;
        let mut largest = about.zero();
        for entry in [x.x, y.y, z.z] {
            let size = entry.plain_value().abs();
            largest = <T::Plain as SimdReal>::select(largest.less(size), size, largest);
        }
        Some(Firmness {
            is_stable: about.is_above(0.0),
            least_pivot: about.abs() / largest,
        })
    }
}

/// Entries of a matrix, row by row.
#[inline(always)]
fn entries<T: Valued>(matrix: &Matrix3<T>) -> [[T; 3]; 3] {
    let [a, b, c] = matrix.columns;
    [[a.x, b.x, c.x], [a.y, b.y, c.y], [a.z, b.z, c.z]]
}

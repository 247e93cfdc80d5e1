//! Parts between body and wheel carrier that have their own degrees of freedom (inner unknowns).
//!
//! The inner unknowns y of a part are additional to the displacement x of the part's outer support. The support is the
//! joint of an arm, or the whole carrier. The inner unknowns are eliminated from the equations. Let f and m be the
//! derivatives of the energy with respect to x and y, and let the indices x and y mark derivatives. The full Newton step,
//! which needs no iteration for y, is
//!
//! ```text
//! dy = -(m_y^-1 m + m_y^-1 m_x dx)                                                                (1)
//! f_x - f_y m_y^-1 m_x,   f - f_y m_y^-1 m                                                        (2)
//! ```
//!
//! A force F acts on a body with the reference point O and the rotation R. It acts at the point P, at the lever
//! r = R (P - O). K is the derivative of F with respect to the position of P.
//! The effect of F on the body is
//!
//! ```text
//! force F, moment r x F;   tangents K, -K r^, r^ K, -r^ K r^ + F^ r^                              (3)
//! ```
//!
//! The term F^ r^ uses the force before inner unknowns are eliminated.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

use super::algebra::Placed;
use super::bushing::{Bushing, BushingForce};
use super::point::PointForce;
use crate::linear::elimination::eliminate;
use crate::number::{Each, MaskOf, Matrix3, Outlined, Real, SimdReal, Valued, Vector3, outlined};

/// Sum of the derivatives of the parts' energy with respect to the carrier's shift and rotation, with its tangent. It is
/// opposite to the force and moment of the parts on the carrier, about the carrier's reference point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sum<T> {
    pub(super) force: [T; 6],
    pub(super) tangent: [[T; 6]; 6],
}

impl<T: Valued> Sum<T> {
    #[inline(always)]
    pub(super) fn zero(like: T) -> Self {
        Sum {
            force: [like.zero(); 6],
            tangent: [[like.zero(); 6]; 6],
        }
    }

    #[inline(always)]
    fn add_block(&mut self, row: usize, column: usize, block: &Matrix3<T>) {
        for j in 0..3 {
            let Vector3 { x, y, z } = block.columns[j];
            self.tangent[row][column + j] = self.tangent[row][column + j] + x;
            self.tangent[row + 1][column + j] = self.tangent[row + 1][column + j] + y;
            self.tangent[row + 2][column + j] = self.tangent[row + 2][column + j] + z;
        }
    }

    #[inline(always)]
    pub(super) fn add_force(&mut self, force: Vector3<T>, moment: Vector3<T>) {
        let sum = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
        for i in 0..6 {
            self.force[i] = self.force[i] + sum[i];
        }
    }

    /// Adds a torque and its tangent with respect to small rotations.
    #[inline(always)]
    pub(super) fn add_moment(&mut self, moment: Vector3<T>, by_turn: &Matrix3<T>) {
        self.add_force(moment.zero(), moment);
        self.add_block(3, 3, by_turn);
    }

    /// Adds a force at a point, by equation (3) of this module. `lever` is the vector from the reference point to this
    /// point.
    #[inline(always)]
    pub(super) fn add_point(&mut self, lever: Vector3<T>, point: &PointForce<T>) {
        outlined!(
            [T: Valued] lever.x;
            sum: &'p mut Sum<T> = self, lever: Vector3<T> = lever, point: &'p PointForce<T> = point => () {
                sum.add_force(point.condensed, lever.cross(point.condensed));
                let [[shift, by_turn], [moment, twist]] = &point.tangents(lever);
                sum.add_blocks([[shift, by_turn], [moment, twist]]);
            }
        );
    }

    /// Adds tangents of force and moment with respect to the carrier's shift and rotation.
    #[inline(always)]
    pub(super) fn add_blocks(&mut self, blocks: [[&Matrix3<T>; 2]; 2]) {
        let [[a, b], [c, d]] = blocks;
        self.add_block(0, 0, a);
        self.add_block(0, 3, b);
        self.add_block(3, 0, c);
        self.add_block(3, 3, d);
    }
}

/// Displacements and options for computing the forces of parts. Displacements are relative to the body that holds these
/// parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conditions<T> {
    pub(super) carrier: Placed<T>,
    pub(super) rack: T,
    /// Displacement of the upper end of a spring, if this end is on another body.
    pub(super) upper: Vector3<T>,
    /// Twist of the anti-roll bar at its middle.
    pub(super) twist: T,
    /// True while the program computes the forces at the design load. Then elastic parts contribute stiffness but no
    /// force, and springs contribute force but no stiffness. Torsion is ignored.
    pub(super) balance_only: bool,
    /// True for the Newton step that adds derivatives to an equilibrium. In an equilibrium the unbalanced forces are
    /// zero. So derivatives of the tangents have no effect, and the tangents can be constants.
    pub(super) is_correction: bool,
}

impl<T: Valued> Conditions<T> {
    /// Displacement of a point on the body or the rack.
    #[inline(always)]
    pub(super) fn ground(&self, on_rack: bool) -> Vector3<T> {
        let zero = self.rack.zero();
        let along = if on_rack { self.rack } else { zero };
        Vector3::new(zero, along, zero)
    }

    /// Force and torque of a bushing, with their tangents.
    #[inline(always)]
    pub(super) fn force(
        &self,
        bushing: &Bushing<T>,
        e: Vector3<T>,
        turn: &Matrix3<T>,
        body: Option<&Matrix3<T>>,
    ) -> BushingForce<T> {
        if self.balance_only {
            bushing.slack()
        } else {
            bushing.force(e, turn, body)
        }
    }
}

/// Number of coordinates in [`Beside`].
pub(super) const BESIDE: usize = 4;
/// Index of the bar's twist among the coordinates in [`Beside`].
pub(super) const TWIST_BESIDE: usize = 3;

/// Forces of a part on two kinds of additional coordinates. These are the displacement of a spring's upper end on
/// another body, and the twist of the anti-roll bar's middle. The inner unknowns of the part are already eliminated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beside<T> {
    /// Derivatives of the energy with respect to the additional coordinates.
    pub(super) force: [T; BESIDE],
    pub(super) own: [[T; BESIDE]; BESIDE],
    /// Tangent with respect to the carrier's shift and rotation.
    pub(super) by_carrier: [[T; 6]; BESIDE],
    /// Tangent of the carrier's force and moment with respect to the additional coordinates.
    pub(super) carrier_by: [[T; BESIDE]; 6],
    /// Response of the inner unknowns: dy = -(rest + by dx + inner_by de), with the step de of the additional
    /// coordinates. The terms `rest` and `by` are in [`Followers`].
    pub(super) inner_by: [[T; BESIDE]; 6],
}

impl<T: Valued> Beside<T> {
    pub(super) fn zero(like: T) -> Self {
        let zero = like.zero();
        Beside {
            force: [zero; BESIDE],
            own: [[zero; BESIDE]; BESIDE],
            by_carrier: [[zero; 6]; BESIDE],
            carrier_by: [[zero; BESIDE]; 6],
            inner_by: [[zero; BESIDE]; 6],
        }
    }

    /// Sets the tangents between one coordinate and a point of the carrier. `lever` is the vector to this point. `by`
    /// is the derivative of the coordinate's force with respect to the point's displacement. `at` is the derivative of
    /// the force at the point with respect to the coordinate.
    pub(super) fn couple(&mut self, k: usize, lever: Vector3<T>, by: Vector3<T>, at: Vector3<T>) {
        self.by_carrier[k] = joined(by, lever.cross(by));
        for (row, entry) in self.carrier_by.iter_mut().zip(joined(at, lever.cross(at))) {
            row[k] = entry;
        }
    }
}

/// Joins two vectors to one array of six numbers.
#[inline(always)]
pub(super) fn joined<T: Copy>(first: Vector3<T>, second: Vector3<T>) -> [T; 6] {
    let (f, s) = (first, second);
    [f.x, f.y, f.z, s.x, s.y, s.z]
}

/// Values of the inner unknowns of a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct LimbState<T> {
    /// Rotation and displacement of the part. The displacement is an unknown only for links with a bushing at each end.
    pub(super) placed: Placed<T>,
    /// Components of the force in an arm's ball joint at the body.
    pub(super) pivot: [T; 2],
    /// Sliding displacement of a strut, or tan(theta/2) of a rocker on a rod with axial stiffness.
    pub(super) slide: T,
}

impl<T: Valued> LimbState<T> {
    pub(super) fn design(like: T) -> Self {
        LimbState {
            placed: Placed::design(like),
            pivot: [like.zero(); 2],
            slide: like.zero(),
        }
    }

    #[inline(always)]
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> LimbState<U> {
        LimbState {
            placed: self.placed.map(f),
            pivot: self.pivot.each(f),
            slide: f(self.slide),
        }
    }
}

/// Response dy = -(rest + by dx) of the inner unknowns to the displacement dx, by equation (1) of this module.
#[derive(Clone, Copy, Debug)]
pub(super) struct Followers<T> {
    pub(super) count: usize,
    pub(super) by: [[T; 6]; 6],
    pub(super) rest: [T; 6],
    /// Vector from the carrier's reference point to the point whose displacement is x; `None` if x is the carrier's
    /// shift and rotation.
    pub(super) joint: Option<Vector3<T>>,
    /// Response of the rocker's rotation to the displacement of a point. The rocker's rod acts at this point. The fields
    /// are the vector from the joint (without a joint: from the carrier's reference point) to this point, the derivative,
    /// and the constant term.
    pub(super) slide: Option<(Vector3<T>, Vector3<T>, T)>,
}

/// Change of the inner unknowns of a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct LimbStep<T> {
    pub(super) inner: [T; 6],
    pub(super) slide: T,
}

impl<T: Valued> Followers<T> {
    #[inline(always)]
    pub(super) fn none(like: T) -> Self {
        Followers {
            count: 0,
            by: [[like.zero(); 6]; 6],
            rest: [like.zero(); 6],
            joint: None,
            slide: None,
        }
    }

    /// Makes the response of a part with a single inner unknown, such as the sliding displacement of a strut.
    pub(super) fn of_one(like: T) -> Self {
        Followers {
            count: 1,
            ..Followers::none(like)
        }
    }

    /// Makes the response of a rocker whose rod acts on an arm. The arm moves with the joint at the vector `joint`.
    /// `slide` contains the derivative of the rocker's rotation with respect to the rod's end, and its constant term.
    pub(super) fn of_joint(joint: Vector3<T>, slide: Option<(Vector3<T>, T)>) -> Self {
        let slide = slide.map(|(by, rest)| (joint.zero(), by, rest));
        Followers {
            joint: Some(joint),
            slide,
            ..Followers::none(joint.x)
        }
    }

    /// Makes the response of a rocker whose rod acts on the carrier. `slide` is as in [`Followers::slide`].
    pub(super) fn of_carrier(like: T, slide: Option<(Vector3<T>, Vector3<T>, T)>) -> Self {
        Followers {
            slide,
            ..Followers::none(like)
        }
    }

    /// Computes the step of the inner unknowns from a step of the carrier. If `is_rate` is true, the result omits the
    /// constant term: it is the rate of the inner unknowns while all forces stay in balance. `beside` contains the
    /// responses to the coordinates in [`Beside`], and the step of these coordinates.
    #[inline(always)]
    pub(super) fn step(
        &self,
        carrier: &[T; 6],
        beside: Option<&([[T; BESIDE]; 6], [T; BESIDE])>,
        is_rate: bool,
    ) -> LimbStep<T> {
        let [x, y, z, a, b, c] = *carrier;
        let mut outer = [x, y, z, a, b, c];
        let mut dimensions = 6;
        let mut joint = Vector3::new(x, y, z);
        if let Some(lever) = self.joint {
            joint = joint + Vector3::new(a, b, c).cross(lever);
            outer = [joint.x, joint.y, joint.z, a, b, c];
            dimensions = 3;
        }
        let zero = x.zero();
        let mut inner = [zero; 6];
        for k in 0..self.count {
            let mut sum = if is_rate { zero } else { self.rest[k] };
            for i in 0..dimensions {
                sum = sum + self.by[k][i] * outer[i];
            }
            if let Some((by, moved)) = beside {
                for i in 0..BESIDE {
                    sum = sum + by[k][i] * moved[i];
                }
            }
            inner[k] = -sum;
        }
        let slide = match self.slide {
            None => zero,
            Some((lever, by, rest)) => {
                let turn = match self.count {
                    0 => Vector3::new(a, b, c),
                    _ => Vector3::new(inner[0], inner[1], inner[2]),
                };
                let at = joint + turn.cross(lever);
                let rest = if is_rate { zero } else { rest };
                -(rest + by.dot(at))
            }
        };
        LimbStep { inner, slide }
    }
}

/// Result of the calculation of a part: response, residuals and stability of its inner unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evaluated<T: Valued> {
    pub(super) followers: Followers<T>,
    /// Residuals of the equations for the inner unknowns (forces, moments, gaps of a ball joint), and the residual moment
    /// about a rocker's axis.
    pub(super) inner: [T; 7],
    /// SIMD lanes in which the inner unknowns are stable by themselves.
    pub(super) is_stable: MaskOf<T>,
    /// Smallest pivot of the inner equations, divided by the largest. It is 0 if a motion has no stiffness. For this
    /// comparison, the length of the part converts rotations to shifts.
    pub(super) least_pivot: T::Plain,
}

/// Solved inner equations: m_y^-1 m and m_y^-1 m_x of equation (1) of this module, and the smallest pivot divided by the
/// largest.
pub(super) struct Eliminated<T: Valued, const N: usize, const C: usize> {
    pub(super) rest: [T; N],
    pub(super) by: [[T; C]; N],
    pub(super) least_pivot: T::Plain,
}

/// Returns an entry of a tangent. In a correction, the result is a constant (see [`Conditions::is_correction`]).
#[inline(always)]
pub(super) fn tangent_of<T: Valued>(entry: T, is_correction: bool) -> T {
    if is_correction {
        entry.of_plain(entry.plain_value())
    } else {
        entry
    }
}

/// Solves the inner equations of a part. The function divides the pivots by the squares of the lengths `units`. `None` if
/// a direction has no stiffness in every SIMD lane.
#[inline(always)]
pub(super) fn eliminated<T: Valued, const N: usize, const C: usize>(
    own: [[T; N]; N],
    force: [T; N],
    by: &[[T; C]; N],
    units: [T::Plain; N],
    is_correction: bool,
) -> Option<Eliminated<T, N, C>> {
    force[0].outlined(Elimination {
        own,
        force,
        by: *by,
        units,
        is_correction,
    })
}

/// Solution of the inner equations, compiled as a separate function.
struct Elimination<T: Valued, const N: usize, const C: usize> {
    own: [[T; N]; N],
    force: [T; N],
    by: [[T; C]; N],
    units: [T::Plain; N],
    is_correction: bool,
}

impl<T: Valued, const N: usize, const C: usize> Outlined for Elimination<T, N, C> {
    type Output = Option<Eliminated<T, N, C>>;

    #[inline(always)]
    fn work(self) -> Self::Output {
        let Elimination {
            mut own,
            force: mut rest,
            mut by,
            units,
            is_correction,
        } = self;
        if is_correction {
            for k in 0..N {
                own[k] = own[k].each(|c| tangent_of(c, true));
                by[k] = by[k].each(|c| tangent_of(c, true));
            }
        }
        let is_regular = eliminate(&mut own, &mut by, &mut rest, N);
        if !T::Plain::any(is_regular) {
            return None;
        }
        let mut least = units[0].constant(f64::INFINITY);
        let mut largest = units[0].zero();
        for k in 0..N {
            let size = own[k][k].plain_value().abs() / (units[k] * units[k]);
            least = <T::Plain as SimdReal>::select(size.less(least), size, least);
            largest = <T::Plain as SimdReal>::select(largest.less(size), size, largest);
        }
        Some(Eliminated {
            rest,
            by,
            least_pivot: least / largest,
        })
    }
}

/// Returns the SIMD lanes in which the symmetric part of a matrix is positive definite. Each pivot of LDL' must exceed
/// the fraction `least_share` of the largest earlier pivot. The first pivot must exceed 0.
#[inline(always)]
pub(super) fn is_positive<T: Valued, const N: usize>(
    matrix: &[[T; N]; N],
    least_share: f64,
) -> MaskOf<T> {
    matrix[0][0].outlined(Definiteness {
        matrix,
        least_share,
    })
}

/// Test of a matrix for positive definiteness, compiled as a separate function.
struct Definiteness<'m, T, const N: usize> {
    matrix: &'m [[T; N]; N],
    least_share: f64,
}

impl<T: Valued, const N: usize> Outlined for Definiteness<'_, T, N> {
    type Output = MaskOf<T>;

    #[inline(always)]
    fn work(self) -> MaskOf<T> {
        let first = self.matrix[0][0].plain_value();
        let half = first.constant(0.5);
        let mut a = [[first; N]; N];
        for i in 0..N {
            for j in 0..N {
                let sum = self.matrix[i][j].plain_value() + self.matrix[j][i].plain_value();
                a[i][j] = half * sum;
            }
        }
        let mut is_positive = first.everywhere();
        let mut largest = first.zero();
        for k in 0..N {
            // A pivot that is NaN fails this comparison.
            let least = first.constant(self.least_share) * largest;
            is_positive = is_positive & least.less(a[k][k]);
            if !T::Plain::any(is_positive) {
                return is_positive;
            }
            largest = <T::Plain as SimdReal>::select(largest.less(a[k][k]), a[k][k], largest);
            for i in k + 1..N {
                let factor = a[i][k] / a[k][k];
                for j in k + 1..N {
                    a[i][j] = a[i][j] - factor * a[k][j];
                }
            }
        }
        is_positive
    }
}

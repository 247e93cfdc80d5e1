//! Forces of a wheel's parts on the bodies that hold these parts, with their tangents, by equations (1) to (5) of
//! `ground.rs`.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

use super::ground::{Coupling, Pose, RACK, SHARED, TWIST};
use super::limb::{BESIDE, Beside, Sum, TWIST_BESIDE, joined};
use super::system::Equations;
use crate::number::{Each, Matrix3, Scalar, Vector3};

/// Number of coordinates, in addition to the carrier's six coordinates, on which the forces of parts depend. These are
/// the shift of the rack, the twist of the bar, and three displacements of a spring's upper end.
const EXTRA: usize = 5;

impl<T: Scalar> Coupling<T> {
    /// Adds forces on the subframe and 3 x 3 blocks of derivatives. `own` and `by_corner` are the derivatives of these
    /// forces with respect to motions of the subframe and of the carrier. `corner_by` are the derivatives of the forces on
    /// the carrier with respect to motions of the subframe.
    #[inline]
    fn add_subframe(
        &mut self,
        force: &[T; 6],
        [own, by_corner, corner_by]: [&[[Matrix3<T>; 2]; 2]; 3],
    ) {
        let entry = |blocks: &[[Matrix3<T>; 2]; 2], i: usize, j: usize| {
            blocks[i / 3][j / 3].entry(i % 3, j % 3)
        };
        for i in 0..6 {
            self.force[i] = self.force[i] + force[i];
            for j in 0..6 {
                self.own[i][j] = self.own[i][j] + entry(own, i, j);
                self.by_corner[i][j] = self.by_corner[i][j] + entry(by_corner, i, j);
                self.corner_by[i][j] = self.corner_by[i][j] + entry(corner_by, i, j);
            }
        }
    }
}

/// Forces of the parts that one holder (body or subframe) carries, in the axes of this holder. The forces depend on the
/// carrier's pose relative to the holder, and on [`EXTRA`] further coordinates (rack, anti-roll bar, spring's upper end).
pub(super) struct InFrame<T> {
    sum: Sum<T>,
    force: [T; EXTRA],
    own: [[T; EXTRA]; EXTRA],
    by_carrier: [[T; 6]; EXTRA],
    carrier_by: [[T; 6]; EXTRA],
}

/// Splits six numbers into two vectors of three numbers.
fn halves<T: Copy>(v: &[T; 6]) -> [Vector3<T>; 2] {
    let [x, y, z, a, b, c] = *v;
    [Vector3::new(x, y, z), Vector3::new(a, b, c)]
}

impl<T: Scalar> InFrame<T> {
    pub(super) fn of(sum: &Sum<T>) -> Self {
        let zero = sum.force[0].zero();
        InFrame {
            sum: *sum,
            force: [zero; EXTRA],
            own: [[zero; EXTRA]; EXTRA],
            by_carrier: [[zero; 6]; EXTRA],
            carrier_by: [[zero; 6]; EXTRA],
        }
    }

    /// Adds the forces of the parts on the rack, by equation (5) of `ground.rs`.
    pub(super) fn add_rack(&mut self, rack: &Sum<T>) {
        for i in 0..6 {
            self.sum.force[i] = self.sum.force[i] + rack.force[i];
            for j in 0..6 {
                self.sum.tangent[i][j] = self.sum.tangent[i][j] + rack.tangent[i][j];
            }
            self.by_carrier[0][i] = -rack.tangent[1][i];
            self.carrier_by[0][i] = -rack.tangent[i][1];
        }
        self.force[0] = -rack.force[1];
        self.own[0][0] = rack.tangent[1][1];
    }

    pub(super) fn add_beside(&mut self, of: &Beside<T>) {
        // The twist is the last coordinate in [`Beside`], but has index 1 here.
        let number = |k: usize| if k == TWIST_BESIDE { 1 } else { 2 + k };
        for k in 0..BESIDE {
            let i = number(k);
            self.force[i] = self.force[i] + of.force[k];
            for l in 0..BESIDE {
                let j = number(l);
                self.own[i][j] = self.own[i][j] + of.own[k][l];
            }
            for l in 0..6 {
                self.by_carrier[i][l] = self.by_carrier[i][l] + of.by_carrier[k][l];
                self.carrier_by[i][l] = self.carrier_by[i][l] + of.carrier_by[l][k];
            }
        }
    }

    pub(super) fn add_to(
        &self,
        pose: Option<&Pose<T>>,
        equations: &mut Equations<T>,
        coupling: &mut Coupling<T>,
    ) {
        match pose {
            None => self.add_scalars(equations, coupling),
            Some(pose) => self.turned(pose).add_on_subframe(pose, equations, coupling),
        }
    }

    fn add_carrier(&self, equations: &mut Equations<T>) {
        for i in 0..6 {
            equations.residual[i] = equations.residual[i] + self.sum.force[i];
            for j in 0..6 {
                equations.matrix[i][j] = equations.matrix[i][j] + self.sum.tangent[i][j];
            }
        }
    }

    /// Adds the forces of the parts on the carrier, on the rack and on the twist of the anti-roll bar.
    fn add_scalars(&self, equations: &mut Equations<T>, coupling: &mut Coupling<T>) {
        self.add_carrier(equations);
        for (k, shared) in [RACK, TWIST].into_iter().enumerate() {
            coupling.force[shared] = coupling.force[shared] + self.force[k];
            let own = &mut coupling.own[shared][shared];
            *own = *own + self.own[k][k];
            for i in 0..6 {
                let by = &mut coupling.by_corner[shared][i];
                *by = *by + self.by_carrier[k][i];
                let by = &mut coupling.corner_by[i][shared];
                *by = *by + self.carrier_by[k][i];
            }
        }
    }

    /// Converts the forces and tangents to the axes of the vehicle. The rack's shift and the bar's twist are scalars
    /// and stay unchanged.
    fn turned(&self, pose: &Pose<T>) -> Self {
        let rotation = &pose.rotation;
        let turned = |v: &[T; 6]| {
            let [f, m] = halves(v);
            joined(rotation.apply(f), rotation.apply(m))
        };
        let zero = self.force[0].zero();
        let mut found = InFrame::of(&Sum::zero(zero));
        found.sum.force = turned(&self.sum.force);
        let blocks = blocks(&self.sum.tangent);
        let back = rotation.transposed();
        let blocks = blocks.each(|row| row.each(|block| rotation.times(&block).times(&back)));
        let [[a, b], [c, d]] = &blocks;
        found.sum.add_blocks([[a, b], [c, d]]);
        found.force = self.force;
        found.own = self.own;
        found.by_carrier = self.by_carrier.each_ref().each(turned);
        found.carrier_by = self.carrier_by.each_ref().each(turned);
        // The displacement of the spring's upper end is a vector, so it must be rotated too.
        let of = |v: [T; 3]| rotation.apply(Vector3::from(v)).to_array();
        let across = |list: &mut [[T; 6]; EXTRA]| {
            for i in 0..6 {
                let turned = of([list[2][i], list[3][i], list[4][i]]);
                (list[2][i], list[3][i], list[4][i]) = (turned[0], turned[1], turned[2]);
            }
        };
        across(&mut found.by_carrier);
        across(&mut found.carrier_by);
        let turned = of([self.force[2], self.force[3], self.force[4]]);
        found.force[2..].copy_from_slice(&turned);
        let own: [Vector3<T>; 3] =
            [0, 1, 2].each(|j| Vector3::from([0, 1, 2].each(|i| self.own[2 + i][2 + j])));
        let own = Matrix3 { columns: own };
        let own = rotation.times(&own).times(&back);
        let by_twist = of([self.own[2][1], self.own[3][1], self.own[4][1]]);
        let twist_by = of([self.own[1][2], self.own[1][3], self.own[1][4]]);
        for i in 0..3 {
            found.own[2 + i][1] = by_twist[i];
            found.own[1][2 + i] = twist_by[i];
            for j in 0..3 {
                found.own[2 + i][2 + j] = own.entry(i, j);
            }
        }
        found
    }

    /// Adds the forces of the parts that the subframe holds, with their tangents, by equations (1) to (4) of
    /// `ground.rs`. All vectors are in the axes of the vehicle.
    fn add_on_subframe(
        &self,
        pose: &Pose<T>,
        equations: &mut Equations<T>,
        coupling: &mut Coupling<T>,
    ) {
        self.add_scalars(equations, coupling);
        let r = pose.lever;
        let [f, m] = halves(&self.sum.force);
        let [[uu, uw], [wu, ww]] = blocks(&self.sum.tangent);
        let (across_f, across_m) = (pose.turning(f), pose.turning(m));
        // Derivatives of the forces on the carrier with respect to the subframe's motion.
        let mut by = [
            [
                uu.negated(),
                uu.times_cross(r)
                    .plus(&uw.negated())
                    .plus(&across_f.negated()),
            ],
            [
                wu.negated(),
                wu.times_cross(r)
                    .plus(&ww.negated())
                    .plus(&across_m.negated()),
            ],
        ];
        // Derivatives of the forces on the subframe with respect to the carrier's motion.
        let mut of = [
            [uu.negated(), uw.negated()],
            [
                wu.plus(&uu.crossed_by(r)).negated().plus(&across_f),
                ww.plus(&uw.crossed_by(r)).negated(),
            ],
        ];
        let mut force = [-f, -(m + r.cross(f))];
        let mut own = None;
        if let Some(p) = pose.upper {
            let upper = self.upper_blocks();
            for (row, c) in by.iter_mut().zip(&upper.carrier_by) {
                row[0] = row[0].plus(&c.negated());
                row[1] = row[1].plus(&c.times_cross(p));
            }
            let [gu, gw] = &upper.by_carrier;
            let g = upper.force;
            force = [force[0] - g, force[1] - p.cross(g)];
            of[0] = [of[0][0].plus(&gu.negated()), of[0][1].plus(&gw.negated())];
            of[1] = [
                of[1][0].plus(&gu.crossed_by(p).negated()),
                of[1][1].plus(&gw.crossed_by(p).negated()),
            ];
            let turn = gu.times_cross(r).plus(&gw.negated());
            let turn = turn
                .plus(&upper.own.times_cross(p))
                .plus(&pose.turning(g).negated());
            let shift = gu.plus(&upper.own).negated();
            own = Some([shift, turn, pose.turning(g)]);
        }
        let mut ss = [
            [by[0][0].negated(), by[0][1].negated()],
            [
                by[1][0]
                    .plus(&by[0][0].crossed_by(r))
                    .plus(&across_f)
                    .negated(),
                by[1][1].plus(&by[0][1].crossed_by(r)).negated(),
            ],
        ];
        if let (Some(p), Some([shift, turn, across])) = (pose.upper, own) {
            ss[0] = [
                ss[0][0].plus(&shift.negated()),
                ss[0][1].plus(&turn.negated()),
            ];
            ss[1] = [
                ss[1][0].plus(&shift.crossed_by(p).plus(&across).negated()),
                ss[1][1].plus(&turn.crossed_by(p).negated()),
            ];
        }
        coupling.add_subframe(&joined(force[0], force[1]), [&ss, &of, &by]);
        self.add_scalars_on_subframe(pose, coupling);
    }

    /// Adds the coupling of the rack's shift and the bar's twist with the subframe.
    fn add_scalars_on_subframe(&self, pose: &Pose<T>, coupling: &mut Coupling<T>) {
        let r = pose.lever;
        for (k, shared) in [RACK, TWIST].into_iter().enumerate() {
            let [a, b] = halves(&self.by_carrier[k]);
            let mut row = [-a, a.cross(r) - b];
            let [c, d] = halves(&self.carrier_by[k]);
            let mut column = [-c, -(d + r.cross(c))];
            if let (Some(p), 1) = (pose.upper, k) {
                let t = Vector3::from([self.own[1][2], self.own[1][3], self.own[1][4]]);
                row = [row[0] - t, row[1] + t.cross(p)];
                let t = Vector3::from([self.own[2][1], self.own[3][1], self.own[4][1]]);
                column = [column[0] - t, column[1] - p.cross(t)];
            }
            let (row, column) = (joined(row[0], row[1]), joined(column[0], column[1]));
            for i in 0..6 {
                coupling.own[shared][i] = coupling.own[shared][i] + row[i];
                coupling.own[i][shared] = coupling.own[i][shared] + column[i];
            }
        }
    }

    fn upper_blocks(&self) -> UpperBlocks<T> {
        let column = |j: usize, first: usize| {
            Vector3::from([0, 1, 2].each(|i| self.by_carrier[2 + i][first + j]))
        };
        let of = |first: usize| Matrix3 {
            columns: [column(0, first), column(1, first), column(2, first)],
        };
        let by = |first: usize| Matrix3 {
            columns: [2, 3, 4]
                .each(|k| Vector3::from([0, 1, 2].each(|i| self.carrier_by[k][first + i]))),
        };
        UpperBlocks {
            force: Vector3::from([self.force[2], self.force[3], self.force[4]]),
            by_carrier: [of(0), of(3)],
            carrier_by: [by(0), by(3)],
            own: Matrix3 {
                columns: [0, 1, 2]
                    .each(|j| Vector3::from([0, 1, 2].each(|i| self.own[2 + i][2 + j]))),
            },
        }
    }
}

/// Force on the upper end of a spring, with its tangents.
struct UpperBlocks<T> {
    force: Vector3<T>,
    by_carrier: [Matrix3<T>; 2],
    carrier_by: [Matrix3<T>; 2],
    own: Matrix3<T>,
}

/// Splits a 6 x 6 matrix into 3 x 3 blocks.
fn blocks<T: Scalar>(matrix: &[[T; 6]; 6]) -> [[Matrix3<T>; 2]; 2] {
    let block = |i: usize, j: usize| Matrix3 {
        columns: [0, 1, 2]
            .each(|c| Vector3::from([0, 1, 2].each(|r| matrix[3 * i + r][3 * j + c]))),
    };
    [[block(0, 0), block(0, 1)], [block(1, 0), block(1, 1)]]
}

/// Equation of a rigid joint, in the axes of the body that holds the joint.
pub(super) struct JointRow<T> {
    pub(super) number: usize,
    pub(super) miss: T,
    pub(super) row: [T; 6],
    pub(super) on_rack: bool,
}

impl<T: Scalar> JointRow<T> {
    pub(super) fn add_to(
        &self,
        pose: Option<&Pose<T>>,
        equations: &mut Equations<T>,
        coupling: &mut Coupling<T>,
    ) {
        let mut row = self.row;
        let mut shared = [self.miss.zero(); SHARED];
        if self.on_rack {
            shared[RACK] = -row[1];
        }
        if let Some(pose) = pose {
            let [a, b] = halves(&row).each(|v| pose.rotation.apply(v));
            row = joined(a, b);
            let by = joined(-a, a.cross(pose.lever) - b);
            shared[..6].copy_from_slice(&by);
        }
        equations.set_joint(self.number, self.miss, row);
        for (k, entry) in shared.into_iter().enumerate() {
            coupling.corner_by[6 + self.number][k] = entry;
            coupling.by_corner[k][6 + self.number] = entry;
        }
    }
}

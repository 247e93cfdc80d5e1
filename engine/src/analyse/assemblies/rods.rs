//! All assemblies of a knuckle on rods: a search over every rotation that divides and discards boxes (branch and
//! prune).
//!
//! Let p be the position of the knuckle's origin, and R the knuckle's rotation. A rod has the length L, the inner end
//! a, and the lever b of its outer end. The wheel centre has the lever e and the required height h.
//!
//! ```text
//! F = (|p + R b - a|^2 - L^2)/(2 L)   for each rod,      F = p_z + (R e)_z - h
//! R = C(v) D,   C(v) c = c + 2 (v x c + v x (v x c))/(1 + v.v),   D one of 1 and the half turns about x, y, z
//! ```
//!
//! Every rotation has a quaternion, which can be scaled so that its largest component is 1. So v in [-1, 1]^3 with the
//! four D covers all rotations. The distance from p to a rod's inner end is at most the sum of the lengths of rod and
//! lever. With g = (p + R b - a)/L the differential is dF = g.dp + (m + m x v).dv 2/(1 + v.v), m = R b x g.
//!
//! The search applies these steps to a box of (p, v):
//!
//! 1. The equation of the height is solved for p_z. The equation of each length is solved for each coordinate of p in turn. This
//!    makes the box smaller or empty.
//! 2. The mean-value form of each equation must contain 0. Otherwise the box is dropped.
//! 3. Krawczyk's operator is K = x - A F(x) + (1 - A J(X)) (X - x), with A an inverse of J in the middle x. All
//!    solutions in X are in K. If K lies inside X, there is exactly one solution (R. Krawczyk, *Computing* 4, 1969; R.
//!    E. Moore, *SIAM J. Numer. Anal.* 14, 1977). This step is repeated while it makes the box much smaller.
//!
//! Then the search halves the remaining box along the variable that changes the equations most. Steps and halving are
//! repeated until every box is decided or too narrow. All results are rounded outward, so the search misses no
//! assembly. After [`MOST_CELLS`] boxes it stops, and reports the rest as undecided.

use super::{Search, Undecided, pose_distance};
use crate::linear::lu::Lu6;
use crate::mechanism::Pose;
use crate::model::{Body, Constraint, Mechanism};
use crate::number::Interval;
use crate::number::{Each, Matrix3, Vector3, array_of};
use crate::number::{Real, Scalar};
use crate::threads::checkpoint;

/// Box of values of p and v of this module: the position of the knuckle's origin and the parameters of the knuckle's rotation.
type Cell = [Interval; 6];

/// Largest number of boxes that a search examines. A search of this many boxes takes six or seven seconds. An ordinary design needs
/// 50,000 to 200,000 boxes.
const MOST_CELLS: usize = 500_000;
/// Smallest change of the equations within a box, relative to the mechanism's size, for which the search still halves this box.
const NARROWEST: f64 = 1e-9;
/// Change of the equations within a box, relative to the mechanism's size, below which the search tries Newton's
/// method. `MOST_TRIES` is the largest number of tries. A try takes ten times as long as the other steps for a box.
/// Only singular assemblies need it.
const FIRST_TRY: f64 = 1e-3;
const MOST_TRIES: usize = 4000;
/// Largest remaining fraction of a box's volume after which Krawczyk's operator is applied again.
const WORTHWHILE: f64 = 0.5;
/// Distance, relative to the mechanism's size, up to which an assembly belongs to its box.
const NEAR: f64 = 1e-6;

/// Constants of a rod for one of the four base rotations D. The function [`rods()`] makes them for D = 1.
#[derive(Clone, Copy)]
struct Rod {
    /// Inner end a of the rod.
    inner: Vector3<Interval>,
    /// Lever D b: the lever of the rod's outer end, turned by D.
    lever: Vector3<Interval>,
    /// Squared length L^2.
    squared: Interval,
    /// Inverse length 1/L. It only scales the equation, so it may be rounded.
    scale: f64,
}

/// Constants of the equations for one of the four base rotations D.
struct Chart {
    rods: [Rod; 5],
    /// Lever D e: the lever of the wheel centre, turned by D.
    wheel_lever: Vector3<Interval>,
    /// Required height h of the wheel centre.
    height: Interval,
    /// Diagonal entries of D, each 1 or -1.
    flip: [f64; 3],
}

/// Result of the search in a box of poses: the number of assemblies, or undecided.
enum Verdict {
    /// No assembly.
    None,
    /// Exactly one assembly, in this box.
    One(Cell),
    /// Undecided. Holds the remaining part of the box. For each variable, also holds the largest change of the
    /// equations that this variable causes within this part.
    Open(Cell, [f64; 6]),
}

impl Search<'_> {
    /// Finds the assemblies of a mechanism whose constraints are five rods. `None` for other mechanisms.
    pub(crate) fn by_rods(&mut self) -> Option<()> {
        let mechanism = self.solver.mechanism();
        let (rods, origin) = (
            rods(mechanism, &self.exact, self.point.rack)?,
            mechanism.origin,
        );
        let design = |id: usize| self.exact[id];
        let wheel = design(mechanism.wheel_centre.0);
        let wheel_lever = wheel - design(origin.0);
        let height = wheel.z + Interval::point(self.point.value);
        let within = place(&rods);
        let (mut looked_at, mut tries, mut unsearched) = (0, 0, 0.0);
        for flip in [[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]] {
            let chart = Chart::of(&rods, wheel_lever, height, flip);
            let turn = Interval::bounds(-1.0, 1.0);
            let [x, y, z] = within.to_array();
            let mut cells = vec![[x, y, z, turn, turn, turn]];
            while let Some(cell) = cells.pop() {
                checkpoint();
                looked_at += 1;
                if looked_at > MOST_CELLS {
                    let part = |cell: &Cell| (3..6).map(|k| 0.5 * cell[k].width()).product::<f64>();
                    unsearched += (part(&cell) + cells.iter().map(part).sum::<f64>()) / 4.0;
                    break;
                }
                let (cell, moves) = match chart.verdict(cell) {
                    Verdict::None => continue,
                    Verdict::One(cell) => {
                        self.take(&chart.pose(&cell));
                        continue;
                    }
                    Verdict::Open(cell, moves) => (cell, moves),
                };
                let (widest, most) = (0..6)
                    .map(|k| (k, moves[k]))
                    .fold((0, -1.0), |a, b| if b.1 > a.1 { b } else { a });
                if most < FIRST_TRY * self.solver.size() {
                    let poses = chart.pose(&cell);
                    if self.is_settled(&poses) {
                        continue;
                    }
                    if tries < MOST_TRIES {
                        tries += 1;
                        if let Some(assembly) = self.assembly(&middle(&poses)) {
                            self.add(assembly);
                        }
                        if self.is_settled(&poses) {
                            continue;
                        }
                    }
                }
                if most < NARROWEST * self.solver.size() {
                    self.leave_open(middle(&chart.pose(&cell)));
                    continue;
                }
                cells.extend(halves(&cell, widest));
            }
        }
        self.all.looked_at += looked_at;
        if unsearched > 0.0 {
            self.all
                .undecided
                .push(Undecided::Rotations(unsearched.min(1.0)));
        }
        Some(())
    }

    /// Adds the only assembly among these poses.
    fn take(&mut self, poses: &Pose<Interval>) {
        let (near, size) = (middle(poses), self.solver.size());
        let found = self.assembly(&near);
        match found.filter(|a| pose_distance(&a.pose, &near, size) < NEAR * size) {
            Some(assembly) => self.add(assembly),
            None => self.leave_open(near),
        }
    }

    /// Records a pose near which the search could not decide. Each such region is recorded once.
    fn leave_open(&mut self, pose: Pose<f64>) {
        let size = self.solver.size();
        let known = |u: &Undecided| match u {
            Undecided::Pose(other) => pose_distance(other, &pose, size) < NEAR * size,
            _ => false,
        };
        if self.all.undecided.len() < crate::analyse::assemblies::MOST_UNDECIDED
            && !self.all.undecided.iter().any(known)
        {
            self.all.undecided.push(Undecided::Pose(pose));
        }
    }
}

/// Returns the rods of a mechanism with five rods and no other constraint.
fn rods(mechanism: &Mechanism, design: &[Vector3<Interval>], rack: f64) -> Option<[Rod; 5]> {
    let origin = design[mechanism.origin.0];
    let rod = |constraint: &Constraint| {
        let Constraint::Link { inner, outer } = *constraint else {
            return None;
        };
        let [from, to] = [inner, outer].each(|id| design[id.0]);
        let mut there = from;
        match (
            mechanism.points[inner.0].body,
            mechanism.points[outer.0].body,
        ) {
            (Body::Rack, Body::Knuckle) => there.y = there.y + Interval::point(rack),
            (Body::Chassis, Body::Knuckle) => (),
            _ => return None,
        }
        let squared = (to - from).norm_squared();
        Some(Rod {
            inner: there,
            lever: to - origin,
            squared,
            scale: 1.0 / squared.middle().sqrt(),
        })
    };
    let rods: Option<Vec<Rod>> = mechanism.constraints.iter().map(rod).collect();
    rods?.try_into().ok()
}

/// Returns a box that contains all possible positions of the knuckle's origin: the positions within reach of the rod with the
/// shortest reach.
fn place(rods: &[Rod; 5]) -> Vector3<Interval> {
    let within = |rod: &Rod| {
        let reach = rod.squared.sqrt() + rod.lever.norm_squared().sqrt();
        let around = Interval::bounds(-reach.high, reach.high);
        rod.inner.map(|c| c + around)
    };
    let narrowest = rods.iter().map(within);
    narrowest.fold(Vector3::default().map(|_: f64| Interval::WHOLE), |a, b| {
        if b.x.width() < a.x.width() { b } else { a }
    })
}

/// Enclosures of the values F and of the Jacobian J of the equations over a box.
struct Linearised {
    f: [Interval; 6],
    jacobian: [[Interval; 6]; 6],
}

impl Chart {
    /// Makes the constants of the equations for the base rotation D with this diagonal.
    fn of(
        rods: &[Rod; 5],
        wheel_lever: Vector3<Interval>,
        height: Interval,
        flip: [f64; 3],
    ) -> Chart {
        let flipped = |v: Vector3<Interval>| {
            let [x, y, z] = flip;
            Vector3::new(v.x.scaled(x), v.y.scaled(y), v.z.scaled(z))
        };
        Chart {
            rods: rods.each(|rod| Rod {
                lever: flipped(rod.lever),
                ..rod
            }),
            wheel_lever: flipped(wheel_lever),
            height,
            flip,
        }
    }

    fn verdict(&self, mut cell: Cell) -> Verdict {
        if self.narrowed(&mut cell).is_none() {
            return Verdict::None;
        }
        let mut one = false;
        let moves = loop {
            let middle = cell.each(Interval::middle);
            let over = self.linearised(&cell);
            let there = self.linearised(&middle.each(Interval::point)).f;
            let around: Cell = array_of(|k| cell[k] - Interval::point(middle[k]));
            let moves: [f64; 6] = array_of(|k| {
                let steepest = over.jacobian.iter().map(|row| row[k].magnitude());
                steepest.fold(0.0, f64::max) * cell[k].width()
            });
            for (f, row) in there.iter().zip(&over.jacobian) {
                let form = row
                    .iter()
                    .zip(&around)
                    .fold(*f, |sum, (j, d)| sum + *j * *d);
                if form.excludes_zero() {
                    return Verdict::None;
                }
            }
            let Some(inverse) = inverse(&over.jacobian) else {
                break moves;
            };
            let mut inside = true;
            let mut left = 1.0;
            let mut next = cell;
            for (k, row) in inverse.iter().enumerate() {
                let mut image = Interval::point(middle[k]);
                for (factor, f) in row.iter().zip(&there) {
                    image = image - Interval::point(*factor) * *f;
                }
                for (j, by) in around.iter().enumerate() {
                    let mut defect = Interval::point(if j == k { 1.0 } else { 0.0 });
                    for (factor, gradient) in row.iter().zip(&over.jacobian) {
                        defect = defect - Interval::point(*factor) * gradient[j];
                    }
                    image = image + defect * *by;
                }
                inside &= image.low > cell[k].low && image.high < cell[k].high;
                let Some(common) = cell[k].common(image) else {
                    return Verdict::None;
                };
                left *= common.width() / cell[k].width();
                next[k] = common;
            }
            cell = next;
            one |= inside;
            // `left`, the remaining fraction of the box's volume, is NaN if the box is a point.
            if left.is_nan() || left > WORTHWHILE {
                break moves;
            }
        };
        if one {
            Verdict::One(cell)
        } else {
            Verdict::Open(cell, moves)
        }
    }

    /// Reduces the range of the position p with the equation of the height and with the length of each rod. `None` if nothing
    /// remains.
    fn narrowed(&self, cell: &mut Cell) -> Option<()> {
        let rotation = rotation(cell);
        let rise = apply(&rotation, self.wheel_lever).z;
        cell[2] = cell[2].common(self.height - rise)?;
        for rod in &self.rods {
            let from = (apply(&rotation, rod.lever) - rod.inner).to_array();
            let mut along: [Interval; 3] = array_of(|k| cell[k] + from[k]);
            for k in 0..3 {
                let others = along[(k + 1) % 3].squared() + along[(k + 2) % 3].squared();
                let rest = rod.squared - others;
                if rest.high < 0.0 {
                    return None;
                }
                let Interval { low, high } = rest.sqrt();
                let sides = [Interval::bounds(low, high), Interval::bounds(-high, -low)];
                along[k] = match sides.each(|side| along[k].common(side)) {
                    [Some(a), Some(b)] => a.hull(b),
                    [a, b] => a.or(b)?,
                };
                cell[k] = cell[k].common(along[k] - from[k])?;
            }
        }
        Some(())
    }

    fn linearised(&self, cell: &Cell) -> Linearised {
        let [x, y, z, a, b, c] = *cell;
        let (position, turn) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
        let rotation = rotation(cell);
        let one = Interval::point(1.0);
        let twice = one.constant(2.0) / (one + a.squared() + b.squared() + c.squared());
        let row = |lever: Vector3<Interval>, gradient: Vector3<Interval>| {
            let moment = lever.cross(gradient);
            let by_turn = (moment + moment.cross(turn)) * twice;
            let [[x, y, z], [a, b, c]] = [gradient.to_array(), by_turn.to_array()];
            [x, y, z, a, b, c]
        };
        let mut f = [one; 6];
        let mut jacobian = [[one; 6]; 6];
        for (k, rod) in self.rods.iter().enumerate() {
            let lever = apply(&rotation, rod.lever);
            let along = position + lever - rod.inner;
            let squared = along.x.squared() + along.y.squared() + along.z.squared();
            f[k] = (squared - rod.squared).scaled(0.5 * rod.scale);
            jacobian[k] = row(lever, along * one.constant(rod.scale));
        }
        let lever = apply(&rotation, self.wheel_lever);
        f[5] = position.z + lever.z - self.height;
        jacobian[5] = row(lever, Vector3::new(one.zero(), one.zero(), one));
        Linearised { f, jacobian }
    }

    /// Returns intervals that contain every pose (p, R) of a box in the unknowns (p, v). See the formulas of this module.
    fn pose(&self, cell: &Cell) -> Pose<Interval> {
        let rows = rotation(cell);
        let [x, y, z] = rows.each(Vector3::to_array);
        Pose {
            origin: Vector3::new(cell[0], cell[1], cell[2]),
            rotation: Matrix3 {
                columns: array_of(|k| {
                    let column = Vector3::new(x[k], y[k], z[k]);
                    column.scaled(self.flip[k])
                }),
            },
        }
    }
}

/// Rows of the rotation matrix C(v) of this module, over a box.
fn rotation(cell: &Cell) -> [Vector3<Interval>; 3] {
    let v = [cell[3], cell[4], cell[5]];
    let squares = v.each(Real::squared);
    let one = Interval::point(1.0);
    let twice = one.constant(2.0) / (one + squares[0] + squares[1] + squares[2]);
    let unit = Interval::bounds(-1.0, 1.0);
    let within = |entry: Interval| entry.common(unit).unwrap_or(unit);
    // A diagonal entry of C(v) is 1 - 2 t/(1 + x^2 + t). Here x is the component of v for this row, and t the sum of the
    // squares of the other two. With s = 1 + x^2, t/(s + t) grows with t and falls with s.
    let diagonal = |i: usize| {
        let (t, s) = (
            squares[(i + 1) % 3] + squares[(i + 2) % 3],
            one + squares[i],
        );
        let ratio = |t: f64, s: f64| {
            let t = Interval::point(t);
            t / (Interval::point(s) + t)
        };
        let ratio = ratio(t.low, s.high).hull(ratio(t.high, s.low));
        within(one - (ratio + ratio))
    };
    let aside = |i: usize, j: usize, k: Interval| within((v[i] * v[j] + k) * twice);
    [
        Vector3::new(diagonal(0), aside(0, 1, -v[2]), aside(0, 2, v[1])),
        Vector3::new(aside(0, 1, v[2]), diagonal(1), aside(1, 2, -v[0])),
        Vector3::new(aside(0, 2, -v[1]), aside(1, 2, v[0]), diagonal(2)),
    ]
}

fn apply(rows: &[Vector3<Interval>; 3], v: Vector3<Interval>) -> Vector3<Interval> {
    Vector3::new(rows[0].dot(v), rows[1].dot(v), rows[2].dot(v))
}

/// Inverse of the matrix in the middle of a matrix of intervals, with rounding errors.
fn inverse(matrix: &[[Interval; 6]; 6]) -> Option<[[f64; 6]; 6]> {
    let rows = Lu6::new(matrix.each(|row| row.each(Scalar::value)), 1.0)?.inverse();
    let finite = rows.as_flattened().iter().all(|entry| entry.is_finite());
    finite.then_some(rows)
}

/// Divides a box along a variable. The border is not exactly in the middle of the box, because the design position may
/// be there.
fn halves(cell: &Cell, across: usize) -> [Cell; 2] {
    let Interval { low, high } = cell[across];
    let cut = low + 0.4871 * (high - low);
    let (mut below, mut above) = (*cell, *cell);
    below[across] = Interval::bounds(low, cut);
    above[across] = Interval::bounds(cut, high);
    [below, above]
}

/// Pose in the middle of an interval of poses. Its matrix is a rotation, except for an error of about the square of the
/// interval's width.
fn middle(poses: &Pose<Interval>) -> Pose<f64> {
    let middle = poses.map(Interval::middle);
    Pose {
        rotation: middle.rotation.orthonormalised(),
        ..middle
    }
}

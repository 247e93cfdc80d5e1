//! All assemblies of a strut or a double wishbone: one full rotation of the lower arm.
//!
//! At an arm angle th there are at most four assemblies (module `closed_form`). They are the combinations of two
//! choices. The first choice places the upper end of the steering axis: an upright or inverted strut, or the side of
//! the upper arm. The second choice is the side of a plane on which the tie rod's outer end is. For each of the four
//! assemblies, the travel is an explicit function f(th). The assemblies at a given travel are the roots of f(th) =
//! travel over one rotation of the arm. (The four functions of a strut together are one trigonometric polynomial of
//! degree ten, so it has at most twenty roots.)
//!
//! Interval arithmetic isolates the roots. The rotation is divided into pieces. On a piece X with the middle m,
//! mean-value forms enclose f and f': f(X) in f(m) + f'(X) (X - m). The excess width of these enclosures shrinks with
//! the square of the piece's width. Each piece has one of these outcomes:
//!
//! - The piece is dropped if the enclosure of f excludes a root. It is also dropped if the upper end or the tie rod has
//!   no real position on the piece.
//! - If f' does not vanish on the piece, there is at most one root. The signs of f - travel at the ends show whether
//!   there is a root.
//! - If all poses of the piece are closer to a known assembly than any other assembly can be, this assembly is the only
//!   one on the piece.
//! - Otherwise the piece is halved.
//!
//! So no root is missed, even if two roots are very close. A piece can be narrower than [`NARROWEST`] and still
//! undecided (a double root), or a search can need too many pieces. Then Newton's method on the closure equations
//! decides, or the piece remains undecided.

use super::{Assembly, Search, Undecided};
use crate::mechanism::Pose;
use crate::number::Interval;
use crate::number::Jet;
use crate::number::{Real, Scalar};
use crate::solve::closed_form::Roles;
use crate::solve::closed_form::{ArmState, ClosedForm};
use crate::threads::checkpoint;
use std::f64::consts::PI;

/// Width (rad) of a piece of the arm's rotation below which the search does not halve this piece.
const NARROWEST: f64 = 1e-10;
/// Largest number of pieces of the arm's rotation in the search with one of the four functions f of this module. A search of this
/// many pieces takes a quarter of a second. An ordinary design needs 400 pieces. A design with parallel arms needs 1,500. If the
/// tie rod's lever about the steering axis is a hundredth of the arm's length, a design needs as many.
const MOST_PIECES: usize = 20_000;
/// Width of an undecided piece (rad) below which the search tries Newton's method. After a failed try, the next one follows
/// when the piece is narrower by the factor `NEXT_TRY`.
const FIRST_TRY: f64 = 0.02;
const NEXT_TRY: f64 = 0.1;
/// Offsets (rad) from an arm angle. The search tries poses at the angle plus each offset, because the angle itself may have no pose
/// at a toggle.
const BESIDE: [f64; 7] = [0.0, 1e-9, -1e-9, 1e-7, -1e-7, 1e-5, -1e-5];
/// Largest distance (rad) between an assembly and the piece whose search found this assembly.
const NEAR: f64 = 1e-4;

type Value = Jet<Interval, 3>;

/// A range of arm angles to search.
#[derive(Clone, Copy)]
struct Piece {
    low: f64,
    high: f64,
    /// Width (rad) below which the search tries Newton's method next.
    next_try: f64,
}

/// One of the four assemblies, as a function of the arm angle over the whole rotation.
struct Branch {
    form: ClosedForm<Interval>,
    plain: ClosedForm<f64>,
    travel: Interval,
    rack: f64,
}

/// Result of the search on a piece of the rotation: the number of roots, or undecided.
enum Verdict {
    /// No root.
    None,
    /// Exactly one root.
    One,
    Open,
}

impl Search<'_> {
    /// Finds the assemblies of a strut or a double wishbone, with the closed form for their poses.
    pub(crate) fn by_arm(&mut self, roles: &Roles) {
        let form = ClosedForm::new(roles, &self.exact);
        let plain = ClosedForm::new(roles, self.solver.design());
        for (upper_across, tie_rod_across) in
            [(false, false), (false, true), (true, false), (true, true)]
        {
            self.on_branch(&Branch {
                form: form.assembled(upper_across, tie_rod_across),
                plain: plain.assembled(upper_across, tie_rod_across),
                travel: Interval::point(self.point.value),
                rack: self.point.rack,
            });
        }
    }

    fn on_branch(&mut self, branch: &Branch) {
        let mut undecided: Vec<(f64, f64)> = Vec::new();
        // The design position is at angle zero, so the rotation is not divided there.
        let cut = -PI + 0.1234;
        let half = |low: f64| Piece {
            low,
            high: low + PI,
            next_try: FIRST_TRY,
        };
        let mut pieces = vec![half(cut), half(cut + PI)];
        let mut looked_at = 0;
        while let Some(piece) = pieces.pop() {
            checkpoint();
            looked_at += 1;
            let Piece { low, high, .. } = piece;
            match branch.verdict(low, high) {
                Verdict::None => continue,
                Verdict::One => {
                    let angle = branch.refined(low, high);
                    match self.beside(branch, angle) {
                        Some(assembly) => self.add(assembly),
                        None => join(&mut undecided, (low, high)),
                    }
                    continue;
                }
                Verdict::Open => (),
            }
            let mut next_try = piece.next_try;
            if high - low < next_try {
                next_try = NEXT_TRY * (high - low);
                if self.settles(branch, low, high) {
                    continue;
                }
            }
            if high - low < NARROWEST || looked_at > MOST_PIECES {
                join(&mut undecided, (low, high));
                continue;
            }
            let middle = low + 0.4871 * (high - low);
            let part = |low, high| Piece {
                low,
                high,
                next_try,
            };
            pieces.push(part(low, middle));
            pieces.push(part(middle, high));
        }
        self.all.looked_at += looked_at;
        for (low, high) in undecided {
            // The piece has a root of even order or a root at a toggle, or it has no root, or the search was cut short.
            match self.beside(branch, 0.5 * (low + high)) {
                Some(assembly) => self.add(assembly),
                None => self.all.undecided.push(Undecided::ArmAngle(low, high)),
            }
        }
    }

    /// Returns true if all poses of a piece are close to one assembly. This assembly is already known, or Newton's
    /// method finds it from the middle of the piece.
    fn settles(&mut self, branch: &Branch, low: f64, high: f64) -> bool {
        let poses = branch.poses(Interval::bounds(low, high));
        if self.is_settled(&poses) {
            return true;
        }
        let start = branch.pose(0.5 * (low + high));
        let found = start.and_then(|start| self.assembly(&start));
        let Some(assembly) = found else {
            return false;
        };
        self.add(assembly);
        self.is_settled(&poses)
    }

    /// Returns the assembly at an arm angle. `None` if Newton's method finds no assembly, or finds one at a different angle.
    fn beside(&self, branch: &Branch, angle: f64) -> Option<Assembly> {
        let found = self.assembly(&branch.pose(angle)?)?;
        let apart = (0.5 * (found.arm_angle? - angle)).sin().abs();
        (apart < 0.5 * NEAR).then_some(found)
    }
}

impl Branch {
    /// Decides whether f(th) = travel has a root on the piece from `low` to `high` (rad). This module explains the function f.
    fn verdict(&self, low: f64, high: f64) -> Verdict {
        let piece = Interval::bounds(low, high);
        let (squares, miss) = self.miss(piece);
        if squares.iter().any(|s| s.high < 0.0) || miss[0].excludes_zero() {
            return Verdict::None;
        }
        if !squares.iter().all(|s| s.low > 0.0) {
            return Verdict::Open;
        }
        let centre = piece.middle();
        let (_, there) = self.miss(Interval::point(centre));
        let around = piece - Interval::point(centre);
        let slope = miss[1].meet(there[1] + (miss[2] + miss[2]) * around);
        if (there[0] + slope * around).excludes_zero() {
            return Verdict::None;
        }
        if !slope.excludes_zero() {
            return Verdict::Open;
        }
        let at = |angle: f64| self.miss(Interval::point(angle)).1[0];
        let ends = if slope.low > 0.0 {
            [at(low), at(high)]
        } else {
            [at(high), at(low)]
        };
        match ends {
            [first, last] if first.low > 0.0 || last.high < 0.0 => Verdict::None,
            [first, last] if first.high < 0.0 && last.low > 0.0 => Verdict::One,
            _ => Verdict::Open,
        }
    }

    /// Returns two radicands and the difference f - travel as series in the angle. The square roots of
    /// the radicands give the positions of the steering axis's upper end and of the tie rod's outer end. A negative
    /// radicand means that there is no assembly.
    #[inline(never)]
    fn miss(&self, angle: Interval) -> ([Interval; 2], Value) {
        let form = self.form.map(Jet::constant);
        let (state, upper_square) = self.state(&form, angle);
        let miss = form.travel(&state) - Jet::constant(self.travel);
        ([upper_square, state.toggle_square()[0]], miss)
    }

    /// Returns the state of the mechanism on a piece, and the radicand for the position of the steering axis's upper
    /// end. The state contains the radicand for the tie rod. It gives the distance of the rod's outer end from the
    /// plane through steering axis and rack joint. Near their zeros, both radicands are small differences of large
    /// terms. The zeros are double if parallel arms are in line with each other and with the steering axis. So both
    /// radicands use mean-value forms, which give far narrower intervals than direct evaluation.
    fn state(&self, form: &ClosedForm<Value>, angle: Interval) -> (ArmState<Value>, Interval) {
        let middle = Interval::point(angle.middle());
        let around = angle - middle;
        let turn = |angle: Interval| {
            let (sine, cosine) = angle.sin_cos();
            let cosines = Jet([cosine, -sine, cosine.scaled(-0.5)]);
            [cosines, Jet([sine, cosine, sine.scaled(-0.5)])]
        };
        let by_mean = |over: Value, there: Value| {
            let slope = over[1].meet(there[1] + (over[2] + over[2]) * around);
            let value = over[0].meet(there[0] + slope * around);
            Jet([value, slope, over[2]])
        };
        let (turned, there) = (turn(angle), turn(middle));
        let upper = |[cosine, sine]: [Value; 2]| form.upper_square(cosine, sine);
        let upper_square = by_mean(upper(turned), upper(there));
        let rack = Jet::constant(Interval::point(self.rack));
        let at = |[cosine, sine]: [Value; 2], upper_square| {
            form.at_knowing(cosine, sine, rack, upper_square)
        };
        let over = at(turned, Some(upper_square));
        let toggle_square = by_mean(over.toggle_square(), at(there, None).toggle_square());
        (
            form.with_toggle_square(over, toggle_square),
            upper_square[0],
        )
    }

    /// Returns an enclosure of all poses of a piece.
    fn poses(&self, angle: Interval) -> Pose<Interval> {
        let form = self.form.map(Jet::constant);
        form.pose(&self.state(&form, angle).0)
            .map(|series| series[0])
    }

    /// Returns the pose at an arm angle, or at the nearest angle at which a pose can be computed. `None` if there is no
    /// such angle nearby.
    fn pose(&self, angle: f64) -> Option<Pose<f64>> {
        BESIDE.iter().find_map(|by| {
            let (sine, cosine) = (angle + by).sin_cos();
            let mut state = self.plain.at(cosine, sine, self.rack);
            state.at_toggle_if_beyond();
            let pose = self.plain.pose(&state);
            let [x, y, z] = pose.rotation.columns;
            let sum = pose.origin.norm() + x.norm() + y.norm() + z.norm();
            sum.is_finite().then_some(pose)
        })
    }

    /// Computes the root on a piece that has exactly one root, by bisection to a width of 1e-12 rad.
    fn refined(&self, mut low: f64, mut high: f64) -> f64 {
        let at = |angle: f64| self.miss(Interval::point(angle)).1[0].value();
        let rising = at(high) > at(low);
        while high - low > 1e-12 {
            let middle = 0.5 * (low + high);
            if (at(middle) > 0.0) == rising {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// Adds a range of arm angles to the list. If the new range touches the last range of the list, both are joined.
fn join(ranges: &mut Vec<(f64, f64)>, (low, high): (f64, f64)) {
    match ranges.last_mut() {
        // The search takes the upper half of a piece first. So each new range usually lies below the last one, as in the second
        // case.
        Some(last) if low <= last.1 && high >= last.1 => last.1 = high,
        Some(last) if high >= last.0 && low <= last.0 => last.0 = low,
        _ => ranges.push((low, high)),
    }
}

//! Corrections of a pose with a constant inverse Jacobian, for one build or for several builds at once (one per SIMD
//! lane).
//!
//! With A the inverse of the Jacobian in a known position, q the pose and F the closure equations of the parts, the iteration
//!
//! ```text
//! q <- q - A F(q, parts)                                                                       (1)
//! ```
//!
//! converges faster, the closer the parts are to the parts in that position. If toe and camber are set again, adjustments a of the
//! parts are further unknowns ([`Alignment`]). Then each correction (1) is followed by the correction (2). Here w are toe and
//! camber, and wanted are their nominal values. The matrices M and T are taken at the nominal design:
//!
//! ```text
//! da = -M (w(q, parts) - wanted),   parts <- parts + da,   q <- q + T da                       (2)
//! ```
//!
//! M is the pseudo-inverse of dw/da. T is the derivative of the pose with respect to an adjustment. So (1) and (2) together are
//! Newton's method in all unknowns, with one inverse. The method continues as long as each correction is less than half of the
//! previous one. With adjustments, it also continues if a correction is less than a quarter of the one before the previous one. A
//! lane that has converged no longer changes, so its result depends on its own build alone.

use super::alignment::{Alignment, ROUNDING};
use super::assembler::{Assembler, Linearised};
use super::parts::Parts;
use super::settle_series::SettlingSeries;
use crate::mechanism::constraint::PartDimensions;
use crate::mechanism::{Closure, Pose, Turn};
use crate::number::{Each, Jet, Matrix3, Outlined, Real, SimdReal, Vector3, larger};

/// Maximum number of corrections of a pose. Builds near the nominal parts converge much earlier.
const MOST_ROUNDS: usize = 40;
/// Twice the largest move of the carrier in the first correction, relative to the mechanism's size. Also twice the
/// largest rotation, in rad.
const FARTHEST: f64 = 0.2;
/// Smallest squared leverage of a rocker's rod for a build in SIMD lanes. The leverage is 1 if the rod is square to its lever and
/// to the rocker's axis, and 0 at a toggle.
const LEAST_LEVERAGE: f64 = 0.0625;

/// Corrects a pose until the corrections are rounding errors.
pub(super) struct Settling<'s, B> {
    pub(super) assembler: &'s Assembler,
    /// The parts. If there is an alignment, its adjustments are added to the parts.
    pub(super) parts: &'s mut Parts<B>,
    pub(super) alignment: Option<&'s Alignment>,
    /// Height of the wheel centre above its nominal height.
    pub(super) height: f64,
    pub(super) from: &'s Linearised,
    /// Buffer for the points of the undisplaced carrier.
    pub(super) carrier: &'s mut Vec<Vector3<B>>,
}

impl<B: SimdReal> Outlined for Settling<'_, B> {
    /// The pose, and the lanes in which it has converged. In other lanes, the pose and the adjustments are undefined.
    type Output = (Pose<B>, B::Mask);

    #[inline(always)]
    fn work(self) -> Self::Output {
        let Settling {
            assembler,
            parts,
            alignment,
            height,
            from,
            carrier,
        } = self;
        let like = parts.points[0].x;
        let (one, height) = (like.one(), like.constant(height));
        let size = like.constant(assembler.size());
        // The rounding error of an adjustment comes from the angles that the adjustment sets.
        let rounding = like.constant(match alignment {
            None => assembler.rounding(),
            Some(_) => assembler.rounding().max(ROUNDING * assembler.size()),
        });
        let mechanism = &assembler.suspension().mechanism;
        let wanted = alignment.map(|alignment| alignment.wanted(mechanism, &parts.drawn));
        let mut closure = assembler.closure_in(parts, carrier);
        let mut pose = constant(like, &from.pose);
        let mut before = like.constant(FARTHEST * assembler.size());
        // Size of the correction before the previous correction.
        let mut earlier = before + before;
        let mut settled = one.less(like.zero());
        let mut rejected = settled;
        let mut round = 0;
        loop {
            let (mut next, correction) =
                assembler.corrected(&closure, parts, height, &pose, &from.inverse);
            let [x, y, z, a, b, c] = correction;
            let turned = Vector3::new(a, b, c).norm() * size;
            let mut moved = larger(Vector3::new(x, y, z).norm(), turned);
            let open = !(settled | rejected);
            if let (Some(alignment), Some(wanted)) = (alignment, &wanted) {
                alignment.correct(
                    mechanism,
                    wanted,
                    parts,
                    &mut next,
                    #[inline(always)]
                    |by| {
                        moved = larger(moved, by.abs());
                        B::select(open, by, by.zero())
                    },
                );
            }
            pose = selected(open, &next, &pose);
            // Expected size of the next correction, if the corrections shrink again by the same ratio.
            let ratio = moved / before;
            let ahead = moved * B::select(ratio.less(one), ratio, one);
            let ends = open & ahead.less(rounding) & !before.less(moved);
            let twice = moved + moved;
            let mut contracts = twice.less(before);
            if alignment.is_some() {
                contracts = contracts | (twice + twice).less(earlier);
            }
            // The test is written so that it also rejects NaN.
            rejected = rejected | (open & !ends & !contracts);
            settled = settled | ends;
            round += 1;
            if round == MOST_ROUNDS || B::all(settled | rejected) {
                return (pose, settled);
            }
            (before, earlier) = (moved, before);
            if alignment.is_some() {
                closure = assembler.closure_in(parts, carrier);
            }
        }
    }
}

/// Task that writes the built designs of parts whose poses have converged.
struct Placing<'s, B> {
    assembler: &'s Assembler,
    parts: &'s Parts<B>,
    pose: &'s Pose<B>,
    into: &'s mut [Vector3<B>],
}

impl<B: SimdReal> Outlined for Placing<'_, B> {
    /// Lanes whose members have positive lengths and whose rockers are far from their toggles.
    type Output = B::Mask;

    #[inline(always)]
    fn work(self) -> B::Mask {
        let (assembler, into) = (self.assembler, self.into);
        assembler.place(self.parts, self.pose, into);
        let like = into[0].x;
        let least = like.constant(LEAST_LEVERAGE);
        let mut accepted = like.everywhere();
        for (length, drawn) in self.parts.lengths.iter().zip(&assembler.drawn().lengths) {
            // Only rods have a length; other constraints store 0.
            if *drawn > 0.0 {
                accepted = accepted & like.zero().less(*length);
            }
        }
        for rocker in &assembler.suspension().mechanism.rockers {
            let [first, second, inner, outer] =
                [rocker.first, rocker.second, rocker.inner, rocker.outer].each(|id| into[id.0]);
            let turn = Turn::of([first, second, inner, outer, outer]);
            accepted = accepted & least.less(turn.leverage_squared);
        }
        accepted
    }
}

/// Assembled builds, one in each lane.
#[derive(Clone, Copy)]
pub(crate) struct InLanes<B: SimdReal> {
    pose: Pose<B>,
    /// Lanes that have converged, whose members have positive lengths, and whose rockers are far from their toggles. The caller
    /// assembles each build of the other lanes singly, without lanes.
    pub(crate) accepted: B::Mask,
}

impl Assembler {
    /// Assembles parts, one build per lane, with the wheel centre at its nominal height. Aligns them if there is an
    /// `alignment`. Writes the built designs. `carrier` is a buffer with any content.
    #[inline(always)]
    pub(crate) fn assemble_in_lanes<B: SimdReal>(
        &self,
        alignment: Option<&Alignment>,
        parts: &mut Parts<B>,
        carrier: &mut Vec<Vector3<B>>,
        into: &mut [Vector3<B>],
    ) -> InLanes<B> {
        let like = parts.points[0].x;
        self.turn_rockers(parts);
        let (pose, settled) = like.outlined(Settling {
            assembler: self,
            parts,
            alignment,
            height: 0.0,
            from: self.home(),
            carrier,
        });
        let accepted = like.outlined(Placing {
            assembler: self,
            parts,
            pose: &pose,
            into,
        });
        InLanes {
            pose,
            accepted: settled & accepted,
        }
    }

    /// Writes the built designs of assembled builds as Taylor series. The values of `parts` must be those after assembly. Returns
    /// the lanes in which the derivatives have converged. Lanes that are not in `built.accepted` may have any result. Not for solid
    /// axles.
    #[inline(always)]
    pub(crate) fn series_in_lanes<B: SimdReal>(
        &self,
        alignment: Option<&Alignment>,
        built: &InLanes<B>,
        parts: &mut Parts<Jet<B, 2>>,
        carrier: &mut Vec<Vector3<Jet<B, 2>>>,
        into: &mut [Vector3<Jet<B, 2>>],
    ) -> B::Mask {
        built.pose.origin.x.outlined(SettlingSeries {
            assembler: self,
            alignment,
            parts,
            pose: &built.pose,
            carrier,
            into,
        })
    }

    /// Returns the closure equations of parts. `carrier` is a buffer.
    #[inline(always)]
    pub(super) fn closure_in<T: Real>(
        &self,
        parts: &Parts<T>,
        carrier: &mut Vec<Vector3<T>>,
    ) -> Closure<T> {
        carrier.clear();
        for number in 0..parts.points.len() {
            carrier.push(self.in_carrier(parts, number));
        }
        let mechanism = &self.suspension().mechanism;
        let parts = PartDimensions {
            body: &parts.points,
            knuckle: carrier,
            drawn: &parts.drawn,
            lengths: &parts.lengths,
        };
        Closure::of_parts(mechanism, parts)
    }
}

/// Copies this pose to every SIMD lane.
#[inline(always)]
fn constant<B: SimdReal>(like: B, pose: &Pose<f64>) -> Pose<B> {
    let shape = Vector3::new(like, like, like);
    let [x, y, z] = pose.rotation.columns;
    Pose {
        origin: shape.constant(pose.origin),
        rotation: Matrix3 {
            columns: [shape.constant(x), shape.constant(y), shape.constant(z)],
        },
    }
}

#[inline(always)]
fn selected<B: SimdReal>(mask: B::Mask, yes: &Pose<B>, no: &Pose<B>) -> Pose<B> {
    let number = |yes, no| B::select(mask, yes, no);
    Pose {
        origin: yes.origin.zip(no.origin, number),
        rotation: yes.rotation.zip(no.rotation, number),
    }
}

//! Derivatives of built designs with respect to the nominal design, one build per SIMD lane.
//!
//! The parts are first-order Taylor series p + p' e in one variable e of the nominal design. Their poses are corrected like the
//! poses of plain parts (module `settle`), but here the values have already converged. Each correction uses the inverse Jacobian of
//! the nominal design. The closer the parts are to nominal, the more a correction reduces the error of the pose's derivative.

use super::alignment::Alignment;
use super::assembler::Assembler;
use super::parts::Parts;
use crate::mechanism::Pose;
use crate::number::{Jet, Matrix3, Outlined, SimdReal, Vector3, larger};

/// Maximum number of corrections of a pose's derivative.
const MOST_ROUNDS: usize = 40;
/// Limit on the estimated next correction of a built design's derivative. Below this limit, the derivative has converged. The limit
/// is relative to the largest derivative of a nominal point, or to the largest correction if that is larger.
const FINE: f64 = 1e-15;
/// Limit on the last correction of a derivative, relative like [`FINE`]. If corrections no longer halve and are below
/// this limit, the derivative has converged.
const COARSE: f64 = 1e-12;

/// A first-order Taylor series.
type Series<B> = Jet<B, 2>;

/// Corrects the derivative of a converged pose and writes the built design as a Taylor series.
pub(super) struct SettlingSeries<'s, B> {
    pub(super) assembler: &'s Assembler,
    pub(super) alignment: Option<&'s Alignment>,
    /// The parts as Taylor series. If there is an alignment, the derivatives of its adjustments are added to the parts.
    pub(super) parts: &'s mut Parts<Series<B>>,
    pub(super) pose: &'s Pose<B>,
    /// Buffer for the points of the undisplaced carrier.
    pub(super) carrier: &'s mut Vec<Vector3<Series<B>>>,
    pub(super) into: &'s mut [Vector3<Series<B>>],
}

impl<B: SimdReal> Outlined for SettlingSeries<'_, B> {
    /// Lanes in which the derivative has converged.
    type Output = B::Mask;

    #[inline(always)]
    fn work(self) -> B::Mask {
        let SettlingSeries {
            assembler,
            alignment,
            parts,
            pose: settled_pose,
            carrier,
            into,
        } = self;
        let like = settled_pose.origin.x;
        let size = like.constant(assembler.size());
        let height = Jet([like.zero(); 2]);
        let mechanism = &assembler.suspension().mechanism;
        let inverse = &assembler.home().inverse;
        let wanted = alignment.map(|alignment| alignment.wanted(mechanism, &parts.drawn));
        let mut closure = assembler.closure_in(parts, carrier);
        let mut pose = constant(settled_pose);
        let mut settled = like.one().less(like.zero());
        let mut rejected = settled;
        let (mut before, mut earlier) = (like.zero(), like.zero());
        // If the pose hardly moves, the derivatives of the nominal points determine the rounding error.
        let mut largest = like.zero();
        for point in &parts.drawn {
            let rate = Vector3::new(point.x.0[1], point.y.0[1], point.z.0[1]).norm();
            largest = larger(largest, rate);
        }
        let mut round = 0;
        loop {
            let (mut next, [x, y, z, a, b, c]) =
                assembler.corrected(&closure, parts, height, &pose, inverse);
            let turned = Vector3::new(a.0[1], b.0[1], c.0[1]).norm() * size;
            let mut moved = larger(Vector3::new(x.0[1], y.0[1], z.0[1]).norm(), turned);
            let open = !(settled | rejected);
            if let (Some(alignment), Some(wanted)) = (alignment, &wanted) {
                alignment.correct(
                    mechanism,
                    wanted,
                    parts,
                    &mut next,
                    #[inline(always)]
                    |by: Series<B>| {
                        moved = larger(moved, by.0[1].abs());
                        let none = by.0[0].zero();
                        // The values of the adjustments have already converged.
                        Jet([none, B::select(open, by.0[1], none)])
                    },
                );
            }
            pose = selected(open, &next, &pose);
            largest = larger(largest, moved);
            let ahead = match round {
                0 => moved,
                _ => {
                    let ratio = moved / before;
                    moved * B::select(ratio.less(like.one()), ratio, like.one())
                }
            };
            let twice = moved + moved;
            let contracts = match round {
                0 | 1 => like.everywhere(),
                _ => twice.less(before) | (twice + twice).less(earlier),
            };
            let is_fine = !(largest * like.constant(FINE)).less(ahead);
            let is_coarse = !(largest * like.constant(COARSE)).less(moved);
            // `larger` keeps NaN, and NaN fails this comparison.
            let is_finite = largest.less(like.constant(f64::INFINITY));
            let ends = open & is_finite & (is_fine | (is_coarse & !contracts));
            rejected = rejected | (open & !ends & !(contracts & is_finite));
            settled = settled | ends;
            round += 1;
            if round == MOST_ROUNDS || B::all(settled | rejected) {
                break;
            }
            (before, earlier) = (moved, before);
            if alignment.is_some() {
                closure = assembler.closure_in(parts, carrier);
            }
        }
        assembler.place(parts, &pose, into);
        settled
    }
}

#[inline(always)]
fn constant<B: SimdReal>(pose: &Pose<B>) -> Pose<Series<B>> {
    let zero = pose.origin.zero();
    let [x, y, z] = pose.rotation.columns;
    Pose {
        origin: pose.origin.with_rate(zero),
        rotation: Matrix3 {
            columns: [x.with_rate(zero), y.with_rate(zero), z.with_rate(zero)],
        },
    }
}

/// Returns a pose with the values of `no`. The derivatives come from `yes` in lanes where the mask is set, and from `no` in other
/// lanes.
#[inline(always)]
fn selected<B: SimdReal>(
    mask: B::Mask,
    yes: &Pose<Series<B>>,
    no: &Pose<Series<B>>,
) -> Pose<Series<B>> {
    let number = |yes: Series<B>, no: Series<B>| Jet([no.0[0], B::select(mask, yes.0[1], no.0[1])]);
    Pose {
        origin: yes.origin.zip(no.origin, number),
        rotation: yes.rotation.zip(no.rotation, number),
    }
}

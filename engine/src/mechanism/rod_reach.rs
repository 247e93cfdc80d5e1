//! Certifies that a rod keeps its leverage while its outer end moves from one position to another.
//!
//! In the notation of [`rocker`](super::rocker), with s the squared distance of the rod's outer end from the axis,
//!
//! ```text
//! w^2 = r.r s - C^2,   C = (l.l - q.q - r.r)/2.                                                 (1)
//! ```
//!
//! Along the chord c between two positions, s and q.q are linear functions minus at most c^2/4. If s and C were linear,
//! w^2 would be concave, with its minimum at an end. An arc of at most 60 degrees differs from its chord by less than
//! d = c/7. This distance changes the square root of s by at most d, and C by at most |q| d + d^2/2. So along the whole
//! arc, with the largest s, |q| and |C| of the two ends,
//!
//! ```text
//! w^2 >= least w^2 - r.r (c^2/4 + 2 d sqrt s) - k (2 |C| + k),   k = c^2/8 + |q| d + d^2/2.     (2)
//! ```

use super::rocker::Ends;
use crate::number::{SimdReal, Vector3};

/// Largest distance of a 60-degree arc from its chord, as a share of the chord: half the tangent of 15 degrees, rounded up.
const STRAYING: f64 = 1.0 / 7.0;

/// Position of a rod's outer end relative to the rocker, with the terms of (1) and (2).
#[derive(Clone, Copy, Debug)]
pub struct RodReach<T> {
    outer: Vector3<T>,
    /// Product r.r.
    lever: T,
    /// Squared distance s.
    from_axis: T,
    /// Product q.q.
    from_foot: T,
    c: T,
    w_squared: T,
}

impl<B: SimdReal> RodReach<B> {
    /// Makes a position in which every number is `number`.
    #[inline(always)]
    pub fn filled(number: B) -> Self {
        RodReach {
            outer: Vector3::new(number, number, number),
            lever: number,
            from_axis: number,
            from_foot: number,
            c: number,
            w_squared: number,
        }
    }

    #[inline(always)]
    pub(crate) fn of([first, second, inner, outer, now]: Ends<B>) -> Self {
        let axis = (second - first).normalised();
        let lever = (inner - first).across(axis);
        let q = inner - lever - now;
        let (along, from_foot) = (axis.dot(q), q.norm_squared());
        let (lever, rod) = (lever.norm_squared(), (inner - outer).norm_squared());
        let from_axis = from_foot - along * along;
        let c = (rod - from_foot - lever).scaled(0.5);
        RodReach {
            outer: now,
            lever,
            from_axis,
            from_foot,
            c: c.abs(),
            w_squared: lever * from_axis - c * c,
        }
    }

    /// Returns the nearer of two positions of the rod's outer end: the one with the shorter distance to `self`. The choice is made
    /// separately in each SIMD lane.
    #[inline(always)]
    pub fn nearer(&self, first: &Self, second: &Self) -> Self {
        let first_away = (first.outer - self.outer).norm_squared();
        let is_first = first_away.less((second.outer - self.outer).norm_squared());
        RodReach {
            outer: Vector3::new(
                B::select(is_first, first.outer.x, second.outer.x),
                B::select(is_first, first.outer.y, second.outer.y),
                B::select(is_first, first.outer.z, second.outer.z),
            ),
            lever: B::select(is_first, first.lever, second.lever),
            from_axis: B::select(is_first, first.from_axis, second.from_axis),
            from_foot: B::select(is_first, first.from_foot, second.from_foot),
            c: B::select(is_first, first.c, second.c),
            w_squared: B::select(is_first, first.w_squared, second.w_squared),
        }
    }

    /// Lanes in which the rod certainly keeps its leverage on the whole path to another position. The path of the rod's outer
    /// end must be an arc of at most 60 degrees. False for NaN.
    #[inline(always)]
    pub fn keeps_leverage_to(&self, other: &Self) -> B::Mask {
        let largest = |a: B, b: B| B::select(a.less(b), b, a);
        let c_squared = (other.outer - self.outer).norm_squared();
        let stray = c_squared.sqrt().scaled(STRAYING);
        let from_axis = largest(self.from_axis, other.from_axis).sqrt();
        let from_foot = largest(self.from_foot, other.from_foot).sqrt();
        let c = largest(self.c, other.c);
        let k = c_squared.scaled(0.125) + stray * (from_foot + stray.scaled(0.5));
        let lost = self.lever * (c_squared.scaled(0.25) + (stray * from_axis).scaled(2.0))
            + k * (c.scaled(2.0) + k);
        lost.less(self.w_squared) & lost.less(other.w_squared)
    }
}

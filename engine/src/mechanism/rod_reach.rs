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
//!
//! The angle of the arc is the angle by which the body of the rod's outer end turns, as seen from the rocker's base. With f_1,
//! f_2, f_3 a frame of unit vectors on this body, f' the same frame in the other position,
//!
//! ```text
//! f_1.f_1' + f_2.f_2' + f_3.f_3' = 1 + 2 cos(angle) >= 2   up to 60 degrees.                    (3)
//! ```

use super::rocker::Ends;
use crate::number::{SimdReal, Vector3};

/// Largest distance of a 60-degree arc from its chord, as a share of the chord: half the tangent of 15 degrees, rounded up.
const STRAYING: f64 = 1.0 / 7.0;

/// Smallest sum of products in equation (3) for which the certificate holds. This is an angle of at most 60 degrees.
const LEAST_ALIGNED: f64 = 2.0;

/// Position of a rod's outer end relative to the rocker, with the terms of equations (1) to (3) of this file.
#[derive(Clone, Copy, Debug)]
pub struct RodReach<T> {
    outer: Vector3<T>,
    /// Frame of unit vectors on the body of the rod's outer end, in the axes of the rocker's base.
    frame: [Vector3<T>; 3],
    /// Product r.r: squared distance of the rod's inner end from the rocker's axis.
    lever: T,
    /// Squared distance s of the rod's outer end from the rocker's axis.
    from_axis: T,
    /// Product q.q: squared distance of the rod's outer end from the foot c of the lever on the axis.
    from_foot: T,
    c: T,
    w_squared: T,
}

impl<B: SimdReal> RodReach<B> {
    /// Makes a position in which every number is `number`.
    #[inline(always)]
    pub fn filled(number: B) -> Self {
        let outer = Vector3::new(number, number, number);
        RodReach {
            outer,
            frame: [outer; 3],
            lever: number,
            from_axis: number,
            from_foot: number,
            c: number,
            w_squared: number,
        }
    }

    /// Makes the position of a rod with these points, and with this frame on the body of its outer end.
    #[inline(always)]
    pub(crate) fn of([first, second, inner, outer, now]: Ends<B>, frame: [Vector3<B>; 3]) -> Self {
        let axis = (second - first).normalised();
        let lever = (inner - first).across(axis);
        let q = inner - lever - now;
        let (along, from_foot) = (axis.dot(q), q.norm_squared());
        let (lever, rod) = (lever.norm_squared(), (inner - outer).norm_squared());
        let from_axis = from_foot - along * along;
        let c = (rod - from_foot - lever).scaled(0.5);
        RodReach {
            outer: now,
            frame,
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
        let either = |a: Vector3<B>, b: Vector3<B>| {
            let [x, y, z] = [(a.x, b.x), (a.y, b.y), (a.z, b.z)];
            Vector3::new(
                B::select(is_first, x.0, x.1),
                B::select(is_first, y.0, y.1),
                B::select(is_first, z.0, z.1),
            )
        };
        let [[a, b, c], [d, e, f]] = [first.frame, second.frame];
        RodReach {
            outer: either(first.outer, second.outer),
            frame: [either(a, d), either(b, e), either(c, f)],
            lever: B::select(is_first, first.lever, second.lever),
            from_axis: B::select(is_first, first.from_axis, second.from_axis),
            from_foot: B::select(is_first, first.from_foot, second.from_foot),
            c: B::select(is_first, first.c, second.c),
            w_squared: B::select(is_first, first.w_squared, second.w_squared),
        }
    }

    /// Lanes in which the rod certainly keeps its leverage on the whole path to another position. The path of the rod's outer
    /// end is an arc. False for arcs of more than 60 degrees, and for NaN.
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
        let [first, second, third] = self.frame;
        let [a, b, c] = other.frame;
        let aligned = first.dot(a) + second.dot(b) + third.dot(c);
        let is_short = aligned.constant(LEAST_ALIGNED).less(aligned);
        is_short & lost.less(self.w_squared) & lost.less(other.w_squared)
    }
}

#[cfg(test)]
mod tests {
    use super::RodReach;
    use crate::number::{Each, Matrix3, Vector3};

    /// A rod's outer end moves along random arcs of up to 170 degrees. If the certificate of an arc holds, the rod has
    /// leverage at every sampled point of this arc.
    #[test]
    fn rods_with_a_certificate_keep_their_leverage() {
        let mut seed = 1_u64;
        let mut off = |by: f64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            by * (2.0 * (seed >> 11) as f64 / (1_u64 << 53) as f64 - 1.0)
        };
        let mut certified = 0;
        for _ in 0..60_000 {
            let mut point = |by: f64| Vector3::new(off(by), off(by), off(by));
            let [first, second, inner] = [1.0; 3].each(&mut point);
            let (centre, axis) = (point(2.0), point(1.0).normalised());
            let radius = point(1.0).across(axis);
            let whole = 0.5 * (1.0 + off(1.0)) * 170.0_f64.to_radians();
            let at = |part: f64| {
                let (sine, cosine) = (part * whole).sin_cos();
                let turned = |v: Vector3<f64>| {
                    v * cosine + axis.cross(v) * sine + axis * (axis.dot(v) * (1.0 - cosine))
                };
                let frame = Matrix3::identity(1.0).columns.each(turned);
                let start = centre + radius;
                RodReach::of(
                    [first, second, inner, start, centre + turned(radius)],
                    frame,
                )
            };
            let (start, end) = (at(0.0), at(1.0));
            if start.keeps_leverage_to(&end) {
                certified += 1;
                for k in 1..40 {
                    let between = at(f64::from(k) / 40.0);
                    assert!(between.w_squared > 0.0, "{} {start:?}", whole.to_degrees());
                }
            }
        }
        assert!(certified > 1000, "{certified}");
    }
}

//! Ground under a wheel, in the frame of that wheel.
//!
//! The body stays fixed in its own axes; when the body rolls, the ground tilts. Let phi be the roll of the body about +x
//! (right wheel in jounce). The normal of the ground and its direction to the left are
//!
//! ```text
//! n = (0, sin phi, cos phi),   e = (0, cos phi, -sin phi)           (1)
//! ```
//!
//! The kernel's frame of the right wheel is the mirror image: phi becomes -phi, and e points outboard again. So the code
//! contains every formula of a wheel once, with n and the outboard direction of the ground.

use crate::number::{Real, Vector3, outlined};

/// Tilt of the ground at one wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground<T> {
    /// Sine of the angle by which the ground falls in the outboard direction.
    pub sine: T,
    /// Cosine of the same angle.
    pub cosine: T,
}

impl Ground<f64> {
    /// Ground under a left wheel when the body rolls by this angle.
    pub fn rolled(roll: f64) -> Self {
        let (sine, cosine) = roll.sin_cos();
        Ground { sine, cosine }
    }
}

impl<T> Ground<T> {
    /// Converts the ground to another number type.
    #[inline(always)]
    pub fn map<U: Copy>(self, f: impl Fn(T) -> U) -> Ground<U> {
        Ground {
            sine: f(self.sine),
            cosine: f(self.cosine),
        }
    }
}

impl<T: Real> Ground<T> {
    /// Level ground, with the number type of `like`.
    #[inline(always)]
    pub fn level(like: T) -> Self {
        Ground {
            sine: like.zero(),
            cosine: like.one(),
        }
    }

    /// Returns the ground in the other wheel's frame.
    #[inline(always)]
    pub fn mirrored(self) -> Self {
        Ground {
            sine: -self.sine,
            ..self
        }
    }

    /// Unit normal, upward.
    #[inline(always)]
    pub fn normal(self) -> Vector3<T> {
        Vector3::new(self.sine.zero(), self.sine, self.cosine)
    }

    /// Unit vector in the plane of the ground, across the vehicle, positive outboard.
    #[inline(always)]
    pub fn outboard(self) -> Vector3<T> {
        Vector3::new(self.sine.zero(), self.cosine, -self.sine)
    }

    /// Vector from the wheel centre to the contact point. The contact point is the lowest point, relative to the ground, of
    /// the disc with this radius about the spin axis a: -R (n - (n.a) a)/|n - (n.a) a|.
    #[inline(always)]
    pub fn contact_lever(self, a: Vector3<T>, radius: f64) -> Vector3<T> {
        outlined!(
            [T: Real] a.x; ground: Ground<T> = self, a: Vector3<T> = a, radius: f64 = radius => Vector3<T> {
                ground.contact_lever_inline(a, radius)
            }
        )
    }

    #[inline(always)]
    fn contact_lever_inline(self, a: Vector3<T>, radius: f64) -> Vector3<T> {
        let n = self.normal();
        let along = n.dot(a);
        let down = Vector3::new(along * a.x - n.x, along * a.y - n.y, along * a.z - n.z);
        down.normalised() * a.x.constant(radius)
    }
}

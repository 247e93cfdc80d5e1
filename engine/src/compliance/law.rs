//! Laws of bushings and links: force against deflection along an axis, or torque against angle.
//!
//! ```text
//! f = shape(d + d0) + offset                                                                      (1)
//! ```
//!
//! d is the deflection from the design position. At the design load, the law has the force f0 and the deflection d0, with
//! shape(d0) = f0. d0 is 0 for torques. It is also 0 if the parts are not relaxed at the design load. The offset is a
//! constant preload, as in Adams. The shape is
//!
//! ```text
//! k d + c d^3,   or a curve through points                                                        (2)
//! ```

use crate::axle::ForceCurve;
use crate::number::{Jet, Scalar, Valued};

/// Largest number of Newton steps when a law is inverted. A monotone cubic polynomial needs only a few steps. Bisection
/// is used if Newton's method fails.
const MOST_STEPS: usize = 200;

/// Force as a function of deflection.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape<T = f64> {
    /// Cubic polynomial, the left form of equation (2) of this module.
    Cubic {
        /// Linear coefficient k: force per deflection.
        rate: T,
        /// Cubic coefficient c: force per cubed deflection.
        cubic: T,
    },
    /// Curve through points, the right form of equation (2) of this module. Beyond the first and last point, the curve is
    /// straight.
    Curve {
        /// Points of the curve: deflections and forces.
        curve: ForceCurve,
        /// Factor on the forces of the curve.
        scale: T,
    },
}

impl Shape {
    /// Slope at zero deflection: force per deflection, for a law without preload.
    pub fn initial_rate(&self) -> f64 {
        self.slope(0.0)
    }
}

impl<T: Copy> Shape<T> {
    /// Converts the shape to another number type.
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U) -> Shape<U> {
        match self {
            Shape::Cubic { rate, cubic } => Shape::Cubic {
                rate: f(*rate),
                cubic: f(*cubic),
            },
            Shape::Curve { curve, scale } => Shape::Curve {
                curve: curve.clone(),
                scale: f(*scale),
            },
        }
    }
}

impl<T: Valued> Shape<T> {
    /// Returns the force and the slope of the shape at a deflection.
    #[inline(always)]
    pub(super) fn at(&self, deflection: T) -> (T, T) {
        match self {
            Shape::Cubic { rate, cubic } => {
                let square = deflection * deflection;
                let bent = *cubic * square;
                (deflection * (*rate + bent), *rate + bent + bent + bent)
            }
            Shape::Curve { curve, scale } => {
                let found = curve.at(Jet([deflection, deflection.one()]));
                (found[0] * *scale, found[1] * *scale)
            }
        }
    }

    /// Returns the slope of the shape at zero deflection.
    pub(super) fn slope(&self, like: T) -> T {
        self.at(like.zero()).1
    }
}

impl<T: Scalar> Shape<T> {
    /// Returns the deflection at which a rising law has this force; `None` if the law does not reach the force.
    fn deflection(&self, force: T) -> Option<T> {
        let mut low = -1.0;
        let mut high = 1.0;
        let value = |d: f64| self.at(force.constant(d)).0.value() - force.value();
        for (end, sign) in [(&mut low, -1.0), (&mut high, 1.0)] {
            while value(*end) * sign < 0.0 {
                *end *= 2.0;
                if end.abs() > 1e9 {
                    return None;
                }
            }
        }
        let mut at = 0.0;
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let (found, slope) = self.at(force.constant(at));
            let miss = found.value() - force.value();
            if miss > 0.0 {
                high = at;
            } else {
                low = at;
            }
            let step = miss / slope.value();
            let next = at - step;
            let newton = next > low && next < high && step.abs() < 0.5 * last;
            last = step.abs();
            let next = if newton { next } else { 0.5 * (low + high) };
            if (next - at).abs() <= f64::EPSILON * next.abs() {
                break;
            }
            at = next;
        }
        // One more Newton step, in the number type of the force, adds the derivatives.
        let (found, slope) = self.at(force.constant(at));
        Some(force.constant(at) - (found - force) / slope)
    }
}

/// Law of a link, or of a bushing along or about one axis, with its preload.
#[derive(Clone, Debug)]
pub(super) struct Law<T> {
    pub(super) shape: Shape<T>,
    /// Force f0 at the design load.
    pub(super) preload: T,
    /// Deflection d0 at the design load.
    deflection: T,
    /// Constant preload, added to the force of the shape.
    pub(super) offset: T,
}

impl<T: Valued> Law<T> {
    pub(super) fn new(shape: Shape<T>, offset: T) -> Self {
        Law {
            shape,
            preload: offset.zero(),
            deflection: offset.zero(),
            offset,
        }
    }

    /// Converts the law to another number type. `shape` is the already converted shape, and `f` converts the other
    /// numbers.
    pub(super) fn with<U>(&self, shape: Shape<U>, f: impl Fn(T) -> U) -> Law<U> {
        Law {
            shape,
            preload: f(self.preload),
            deflection: f(self.deflection),
            offset: f(self.offset),
        }
    }

    /// Returns force and slope of the law at a deflection from the design position, by equation (1) of this module.
    #[inline(always)]
    pub(super) fn at(&self, deflection: T) -> (T, T) {
        match &self.shape {
            // With this formula, the force at the design load is exact.
            Shape::Cubic { rate, cubic } => {
                let (d, d0) = (deflection, self.deflection);
                let total = d + d0;
                let three = d.constant(3.0) * *cubic;
                let bent = *cubic * d * d + three * d0 * total;
                (
                    self.preload + self.offset + d * (*rate + bent),
                    *rate + three * total * total,
                )
            }
            shape => {
                let (force, slope) = shape.at(deflection + self.deflection);
                (force + self.offset, slope)
            }
        }
    }
}

impl<T: Scalar> Law<T> {
    /// Sets the force at the design load. Returns false if the law does not reach that force.
    #[must_use]
    pub(super) fn preloaded(&mut self, force: T) -> bool {
        self.preload = force;
        let deflection = match &self.shape {
            Shape::Cubic { rate, cubic } if cubic.value() == 0.0 && rate.value() != 0.0 => {
                Some(force / *rate)
            }
            shape => shape.deflection(force),
        };
        self.deflection = deflection.unwrap_or(force.zero());
        deflection.is_some()
    }

    /// Returns true if this deflection lies beyond the points of a curve.
    pub(super) fn is_beyond(&self, deflection: f64) -> bool {
        match &self.shape {
            Shape::Cubic { .. } => false,
            Shape::Curve { curve, .. } => {
                let at = deflection + self.deflection.value();
                let points = curve.points();
                at < points[0][0] || at > points[points.len() - 1][0]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the design position, the law has the given force f0 plus the offset. At another deflection, it equals the law
    /// without preload, shifted by d0.
    #[test]
    fn a_preloaded_law_is_the_unloaded_one_moved() {
        let cubic = Shape::Cubic {
            rate: 700.0,
            cubic: 60.0,
        };
        let curve = Shape::Curve {
            curve: ForceCurve::through(&[[-3.0, -6000.0], [0.0, 0.0], [2.0, 1500.0]]).unwrap(),
            scale: 1.5,
        };
        for shape in [cubic, curve] {
            for force in [-2000.0, 0.0, 1300.0] {
                let mut law = Law::new(shape.clone(), 12.0);
                assert!(law.preloaded(force));
                let bound = 64.0 * f64::EPSILON * 2000.0;
                assert!((law.at(0.0).0 - force - 12.0).abs() < bound);
                let d = 0.7;
                let expected = shape.at(law.deflection + d);
                let found = law.at(d);
                assert!((found.0 - 12.0 - expected.0).abs() < bound);
                assert!((found.1 - expected.1).abs() < bound);
            }
        }
    }
}

//! Conversion of single numbers.

use super::Units;
use crate::ask::Unit;
use crate::model::{Axis, Frame, LengthUnit, MassUnit};
use crate::number::short_decimal;
use hardpoint_study_file::dimension::Powers;

/// Change from one set of units and axes to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conversion {
    lengths: [LengthUnit; 2],
    masses: [MassUnit; 2],
    frames: [Frame; 2],
}

impl Conversion {
    pub(super) fn new(from: Units, to: Units) -> Self {
        Conversion {
            lengths: [from.length, to.length],
            masses: [from.mass, to.mass],
            frames: [from, to].map(|units| Frame::new(units.frame, units.side)),
        }
    }

    pub(super) fn with_masses(self, from: MassUnit, to: MassUnit) -> Self {
        Conversion {
            masses: [from, to],
            ..self
        }
    }

    /// Axes of the old text and of the new text.
    pub(super) fn frames(&self) -> [Frame; 2] {
        self.frames
    }

    /// True if the coordinates of a point change: the unit of lengths, the axes or the side.
    pub(super) fn moves_points(&self) -> bool {
        let [from, to] = self.frames;
        from != to || self.powers(1.0, Powers::LENGTH) != 1.0
    }

    /// Sign of a component along an axis in the new text, relative to the old text.
    pub(super) fn sign(&self, axis: Axis) -> f64 {
        let [from, to] = self.frames;
        from.sign(axis) * to.sign(axis)
    }

    /// True if the new text describes the mirror image: the wheel on the other side of the car.
    pub(super) fn mirrors(&self) -> bool {
        let [from, to] = self.frames.each_ref().map(|frame| frame.meaning().1);
        from != to
    }

    /// Sign of a rotation or torque about an axis in the new text, relative to the old text.
    pub(super) fn turn_sign(&self, axis: Axis) -> f64 {
        let [from, to] = self.frames;
        from.turn_sign(axis) * to.turn_sign(axis)
    }

    fn powers(&self, value: f64, of: Powers) -> f64 {
        let [from, to] = self.lengths;
        if of == Powers::LENGTH {
            return to.convert(value, from);
        }
        let force = from.newtons() / to.newtons();
        let mass = self.masses[0].kilograms() / self.masses[1].kilograms();
        let length = to.convert(1.0, from).powi(of.length);
        value * (length * force.powi(of.force) * mass.powi(of.mass))
    }

    /// The conversion from the new units to the old units.
    fn reversed(&self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.lengths, self.masses, self.frames);
        Conversion {
            lengths: [b, a],
            masses: [d, c],
            frames: [f, e],
        }
    }

    /// Converts a value without its sign, and rounds the result so that a conversion back gives exactly the old value. So a
    /// length of 240 mm is 240 mm again after a conversion to inches and back.
    ///
    /// - If possible, the result has no rounding error: 9.5 in are 241.3 mm, not 241.29999999999998 mm.
    /// - Otherwise, the result is the shortest decimal number whose conversion back gives exactly the old value.
    /// - If no number gives exactly the old value, the result has all digits.
    pub(super) fn rounded(&self, value: f64, scale: Scale) -> f64 {
        let (new, back) = (self.scaled(value, scale), self.reversed());
        let there = |value| self.scaled(value, scale);
        if let Some(short) = short_decimal(value, there, |value| back.scaled(value, scale)) {
            return short;
        }
        let decimals = (0..17).map(|digits| format!("{new:.digits$e}").parse());
        let mut decimals = decimals.filter_map(Result::ok);
        let shortest = decimals.find(|short| back.scaled(*short, scale) == value);
        shortest.unwrap_or(new)
    }

    /// Converts a value without its sign.
    pub(super) fn scaled(&self, value: f64, scale: Scale) -> f64 {
        let [from, to] = self.lengths;
        match scale {
            Scale::Powers(of) => self.powers(value, of),
            Scale::Printed(unit) => unit.reprinted(value, from, to),
        }
    }
}

/// Unit of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    /// Powers of the units in the file.
    Powers(Powers),
    /// Unit in which results are printed.
    Printed(Unit),
}

/// Unit and direction of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    pub(super) scale: Scale,
    /// Sign of the number in the new axes, relative to the old axes.
    pub(super) sign: f64,
}

impl Measured {
    /// A number without direction.
    pub(super) fn plain(powers: Powers) -> Self {
        Measured {
            scale: Scale::Powers(powers),
            sign: 1.0,
        }
    }

    pub(super) fn printed(unit: Unit) -> Self {
        Measured {
            scale: Scale::Printed(unit),
            sign: 1.0,
        }
    }

    pub(super) fn signed(self, sign: f64) -> Self {
        Measured { sign, ..self }
    }

    /// Returns true if the order of two values changes.
    pub(super) fn reverses(&self) -> bool {
        self.sign < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{FrameConvention, Side};

    fn conversion(from: LengthUnit, to: LengthUnit) -> Conversion {
        let units = |length| Units {
            length,
            mass: MassUnit::default(),
            frame: FrameConvention::Iso8855,
            side: Side::Left,
        };
        Conversion::new(units(from), units(to))
    }

    /// Inches with up to 6 decimals are exactly representable as decimal millimetres and metres. The conversion writes these
    /// decimals, and the conversion back gives the inches. A decimal differs from the computed product by at most 2 units in
    /// the last place.
    #[test]
    fn decimal_inches_become_decimal_millimetres() {
        let scale = Scale::Powers(Powers::LENGTH);
        let mut state = 1_u64;
        let mut noisy = 0;
        for k in 0..200_000_u32 {
            // Linear congruential generator of Knuth (MMIX).
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let decimals = (k % 7) as usize;
            let parts = 1 + (state >> 33) % (80 * 10_u64.pow(decimals as u32));
            let shifted = |number: u64, decimals: usize| -> f64 {
                format!("{number}e-{decimals}").parse().unwrap()
            };
            let inches = shifted(parts, decimals);
            let units = [(LengthUnit::Millimetre, 1), (LengthUnit::Metre, 4)];
            for (unit, more) in units {
                let there = conversion(LengthUnit::Inch, unit);
                let back = conversion(unit, LengthUnit::Inch);
                let new = there.rounded(inches, scale);
                assert_eq!(new, shifted(254 * parts, decimals + more), "{inches} in");
                assert_eq!(back.rounded(new, scale), inches, "{new} {}", unit.symbol());
                let product = there.scaled(inches, scale);
                assert!(new.to_bits().abs_diff(product.to_bits()) <= 2, "{inches}");
                noisy += usize::from(new != product);
            }
        }
        assert!(noisy > 10_000, "{noisy}");
    }

    /// Every written length equals the length before the conversion, without a difference in the last digits.
    #[test]
    fn a_converted_length_is_the_same_length() {
        let scale = Scale::Powers(Powers::LENGTH);
        for unit in [LengthUnit::Inch, LengthUnit::Metre] {
            let there = conversion(LengthUnit::Millimetre, unit);
            let back = conversion(unit, LengthUnit::Millimetre);
            for tenths in 1..20_000 {
                let old = f64::from(tenths) / 10.0;
                let new = there.rounded(old, scale);
                let again = back.rounded(new, scale);
                assert_eq!(again, old, "{old} mm, {new} {}", unit.symbol());
                let exact = there.scaled(old, scale);
                let error = (new - exact).abs() / exact;
                assert!(
                    error <= 2.0 * f64::EPSILON,
                    "{old} mm, {new} {}",
                    unit.symbol()
                );
            }
        }
    }
}

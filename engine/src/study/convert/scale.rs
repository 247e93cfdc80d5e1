//! Conversion of single numbers.

use super::Units;
use crate::ask::Unit;
use crate::model::{Axis, Frame, LengthUnit, MassUnit, Side};
use hardpoint_study_file::dimension::Powers;

/// Change from one set of units and axes to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conversion {
    lengths: [LengthUnit; 2],
    masses: [MassUnit; 2],
    frames: [Frame; 2],
}

impl Conversion {
    pub(super) fn new(from: Units, to: Units, side: Side) -> Self {
        Conversion {
            lengths: [from.length, to.length],
            masses: [from.mass, to.mass],
            frames: [from, to].map(|units| Frame::new(units.frame, side)),
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

    /// Sign of a component along an axis in the new text, relative to the old text.
    pub(super) fn sign(&self, axis: Axis) -> f64 {
        let [from, to] = self.frames;
        from.sign(axis) * to.sign(axis)
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

    /// Converts a value without its sign, and returns the shortest decimal number whose conversion back gives exactly the
    /// old value. So a length of 240 mm is 240 mm again after a conversion to inches and back. If no number gives exactly
    /// the old value, the function returns the converted value with all digits.
    pub(super) fn rounded(&self, value: f64, scale: Scale) -> f64 {
        let (new, back) = (self.scaled(value, scale), self.reversed());
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
    use crate::model::FrameConvention;

    fn conversion(from: LengthUnit, to: LengthUnit) -> Conversion {
        let units = |length| Units {
            length,
            mass: MassUnit::default(),
            frame: FrameConvention::Iso8855,
        };
        Conversion::new(units(from), units(to), Side::Left)
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

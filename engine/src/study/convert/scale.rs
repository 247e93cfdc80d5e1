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

    /// Sign of a component about an axis in the new text, relative to the old text.
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

/// Relative error below which a shorter number replaces a converted one. It is a few units in the last place.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Number with fewer digits that differs only by rounding. So a length of 240 mm is 240 mm again after a conversion to inches
/// and back. Zero has no sign.
pub(super) fn without_rounding(value: f64) -> f64 {
    let short: f64 = format!("{value:.13e}").parse().unwrap_or(value);
    if (short - value).abs() <= ROUNDING * value.abs() {
        short + 0.0
    } else {
        value + 0.0
    }
}

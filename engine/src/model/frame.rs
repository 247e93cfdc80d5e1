//! Axes of the study and axes of the kernel.
//!
//! The kernel computes only with a left wheel in ISO 8855 axes (x forward, y left, z up). Other conventions and right-hand
//! wheels differ only in the signs of coordinates. So the change of frame is exact, and a mirrored car gives mirrored results
//! bit for bit.

use crate::number::{Each, Vector3, short_decimal};
use std::ops::{Index, IndexMut};

/// A coordinate axis of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// The first coordinate.
    X,
    /// The second coordinate.
    Y,
    /// The third coordinate.
    Z,
}

impl Axis {
    /// The three axes in order.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// Lower-case letter of the axis, as in studies and column names.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self as usize]
    }

    /// Meaning of a positive force component along this axis on the wheel carrier, for columns of loads.
    pub(crate) fn force_on_carrier(self) -> &'static str {
        match self {
            Axis::X => "force on the wheel carrier along +x",
            Axis::Y => "force on the wheel carrier along +y",
            Axis::Z => "force on the wheel carrier along +z",
        }
    }
}

impl<T> Index<Axis> for Vector3<T> {
    type Output = T;
    #[inline(always)]
    fn index(&self, axis: Axis) -> &T {
        match axis {
            Axis::X => &self.x,
            Axis::Y => &self.y,
            Axis::Z => &self.z,
        }
    }
}

impl<T> IndexMut<Axis> for Vector3<T> {
    #[inline(always)]
    fn index_mut(&mut self, axis: Axis) -> &mut T {
        match axis {
            Axis::X => &mut self.x,
            Axis::Y => &mut self.y,
            Axis::Z => &mut self.z,
        }
    }
}

/// Side of the car that the wheel is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// Left wheel.
    Left,
    /// Right wheel.
    Right,
}

impl Side {
    /// Both sides, left first.
    pub const ALL: [Side; 2] = [Side::Left, Side::Right];

    /// Name of the side in studies.
    pub fn name(self) -> &'static str {
        ["left", "right"][self as usize]
    }

    /// The other side.
    pub fn other(self) -> Side {
        match self {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        }
    }

    /// Prefixes a sentence with the wheel of this side: "left wheel: ...".
    pub fn about(self, sentence: &impl std::fmt::Display) -> String {
        format!("{} wheel: {sentence}", self.name())
    }

    /// Sign of the side: 1 for left, -1 for right. The sign converts two values to the frame of the side: a rack displacement
    /// to the left, and half the difference of the travels of both wheels.
    pub fn sign(self) -> f64 {
        [1.0, -1.0][self as usize]
    }
}

/// The axis convention of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameConvention {
    /// ISO 8855: x forward, y left, z up.
    Iso8855,
    /// SAE J670: x forward, y right, z down.
    SaeJ670,
    /// x rearward, y right, z up.
    XRear,
}

impl FrameConvention {
    /// All conventions.
    pub const ALL: [FrameConvention; 3] = [
        FrameConvention::Iso8855,
        FrameConvention::SaeJ670,
        FrameConvention::XRear,
    ];

    /// Name of the convention in studies.
    pub fn name(self) -> &'static str {
        ["iso8855", "sae_j670", "x_rear"][self as usize]
    }

    /// Convention with this name. `None` for other names.
    pub fn named(name: &str) -> Option<Self> {
        let mut all = FrameConvention::ALL.into_iter();
        all.find(|convention| convention.name() == name)
    }

    /// Directions of the axes in words, as in the comments of templates.
    pub fn directions(self) -> &'static str {
        [
            "x forward, y left, z up",
            "x forward, y right, z down",
            "x rearward, y right, z up",
        ][self as usize]
    }
}

/// The unit of masses in a study. Inside the program masses are in kilograms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MassUnit {
    /// Kilograms.
    #[default]
    Kilogram,
    /// Pounds (avoirdupois).
    Pound,
}

impl MassUnit {
    /// All units.
    pub const ALL: [MassUnit; 2] = [MassUnit::Kilogram, MassUnit::Pound];

    /// The unit's symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            MassUnit::Kilogram => "kg",
            MassUnit::Pound => "lb",
        }
    }

    /// Value of the unit in kg; a pound by definition (International Yard and Pound Agreement, 1959).
    pub fn kilograms(self) -> f64 {
        match self {
            MassUnit::Kilogram => 1.0,
            MassUnit::Pound => 0.453_592_37,
        }
    }
}

/// The unit of every length in a study and in its results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    Millimetre,
    /// Metres.
    Metre,
    /// Inches of 25.4 mm.
    Inch,
    /// Inches with forces in pounds-force. Inside the program forces are in newtons.
    InchPound,
}

impl LengthUnit {
    /// All units that a study can name as its unit of length.
    pub const ALL: [LengthUnit; 3] = [LengthUnit::Millimetre, LengthUnit::Metre, LengthUnit::Inch];

    /// The unit's symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            LengthUnit::Millimetre => "mm",
            LengthUnit::Metre => "m",
            LengthUnit::Inch | LengthUnit::InchPound => "in",
        }
    }

    /// Returns the unit with the same lengths, but with forces in newtons.
    fn with_newtons(self) -> LengthUnit {
        match self {
            LengthUnit::InchPound => LengthUnit::Inch,
            other => other,
        }
    }

    /// Symbol of the unit of force.
    pub fn force_symbol(self) -> &'static str {
        match self {
            LengthUnit::InchPound => "lbf",
            _ => "N",
        }
    }

    /// Value of the unit of force in newtons. A pound-force is 0.45359237 kg times 9.80665 m/s2.
    pub fn newtons(self) -> f64 {
        match self {
            LengthUnit::InchPound => 4.448_221_615_260_5,
            _ => 1.0,
        }
    }

    /// Length in the unit of torque: a metre, or a foot if forces are in pounds-force. Returns the value of this length in the
    /// present unit, and its symbol.
    pub fn lever(self) -> (f64, &'static str) {
        match self {
            LengthUnit::InchPound => (12.0, "ft"),
            _ => (self.per_metre(), "m"),
        }
    }

    /// Number of these units in one metre.
    pub fn per_metre(self) -> f64 {
        match self {
            LengthUnit::Millimetre => 1000.0,
            LengthUnit::Metre => 1.0,
            LengthUnit::Inch | LengthUnit::InchPound => 1.0 / 0.0254,
        }
    }

    /// Converts a length from another unit to this one by one multiplication or division. A length in the same unit does not
    /// change at all.
    pub fn convert(self, length: f64, from: LengthUnit) -> f64 {
        match (from.with_newtons(), self.with_newtons()) {
            (LengthUnit::Millimetre, LengthUnit::Metre) => length / 1000.0,
            (LengthUnit::Metre, LengthUnit::Millimetre) => length * 1000.0,
            (LengthUnit::Millimetre, LengthUnit::Inch) => length / 25.4,
            (LengthUnit::Inch, LengthUnit::Millimetre) => length * 25.4,
            (LengthUnit::Metre, LengthUnit::Inch) => length / 0.0254,
            (LengthUnit::Inch, LengthUnit::Metre) => length * 0.0254,
            _ => length,
        }
    }

    /// Converts a length for a file. If the length and the result are decimal numbers with at most 15 digits, the result has
    /// no rounding error: 9.5 in are 241.3 mm, not 241.29999999999998 mm. Otherwise the result is that of
    /// [`LengthUnit::convert`].
    pub fn convert_decimal(self, length: f64, from: LengthUnit) -> f64 {
        if from.with_newtons() == self.with_newtons() {
            return length;
        }
        let there = |length| self.convert(length, from);
        let back = |length| from.convert(length, self);
        short_decimal(length, there, back).unwrap_or_else(|| there(length))
    }
}

/// Map between the study's axes and the kernel's: a sign for each coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    signs: [f64; 3],
}

impl Frame {
    /// Makes the frame of a study with this axis convention, for a wheel on this side.
    pub fn new(convention: FrameConvention, side: Side) -> Self {
        let mut signs = match convention {
            FrameConvention::Iso8855 => [1.0, 1.0, 1.0],
            FrameConvention::SaeJ670 => [1.0, -1.0, -1.0],
            FrameConvention::XRear => [-1.0, -1.0, 1.0],
        };
        if side == Side::Right {
            signs[1] = -signs[1];
        }
        Frame { signs }
    }

    /// Convention and side of this frame. Convention and side are unique, because no two frames have the same signs.
    pub fn meaning(&self) -> (FrameConvention, Side) {
        let both = |convention| Side::ALL.each(|side| (convention, side));
        let mut all = FrameConvention::ALL.into_iter().flat_map(both);
        all.find(|(convention, side)| Frame::new(*convention, *side) == *self)
            .expect("a frame is made of a convention and a side")
    }

    /// Frame of the other wheel in the same axes: the mirror image.
    pub fn of_other_side(self) -> Self {
        let [x, y, z] = self.signs;
        Frame { signs: [x, -y, z] }
    }

    /// Sign of one coordinate: kernel = sign x study, and study = sign x kernel.
    pub fn sign(&self, axis: Axis) -> f64 {
        self.signs[axis as usize]
    }

    /// Converts a position or displacement between study and kernel. The map is its own inverse.
    pub fn vector(&self, v: Vector3<f64>) -> Vector3<f64> {
        let [x, y, z] = self.signs;
        Vector3::new(x * v.x, y * v.y, z * v.z)
    }

    /// Sign of the component about `axis` of an angular velocity or acceleration. A mirrored axis keeps its own component and
    /// reverses the components about the two other axes.
    pub fn turn_sign(&self, axis: Axis) -> f64 {
        self.signs.iter().product::<f64>() * self.sign(axis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The international inch is exactly 25.4 mm. The test covers all nine pairs of units.
    #[test]
    fn lengths_are_converted_between_all_units() {
        let [mm, m, inch] = LengthUnit::ALL;
        let same = [(mm, 508.0), (m, 0.508), (inch, 20.0)];
        for (from, length) in same {
            for (to, expected) in same {
                let found = to.convert(length, from);
                assert!(
                    (found - expected).abs() <= 2e-16 * expected,
                    "{from:?} {to:?} {found}"
                );
                // Ratios of two units agree with `per_metre`, in both directions.
                let ratio = to.per_metre() / from.per_metre();
                assert!((found - length * ratio).abs() <= 4e-16 * expected);
                assert!((from.convert(found, to) - length).abs() <= 4e-16 * length);
            }
        }
    }

    #[test]
    fn signs_tell_convention_and_side() {
        for convention in FrameConvention::ALL {
            for side in Side::ALL {
                assert_eq!(Frame::new(convention, side).meaning(), (convention, side));
            }
        }
    }

    /// omega x r transforms like a vector if omega transforms like a rotation, in every convention.
    #[test]
    fn turns_map_so_that_velocities_map_as_vectors() {
        let (omega, r) = (Vector3::new(0.1, 0.2, -0.4), Vector3::new(3.0, -1.0, 2.0));
        for convention in FrameConvention::ALL {
            for side in Side::ALL {
                let frame = Frame::new(convention, side);
                let turned = Axis::ALL.map(|axis| frame.turn_sign(axis) * omega[axis]);
                let turned = Vector3::from(turned);
                assert_eq!(
                    frame.vector(omega.cross(r)),
                    turned.cross(frame.vector(r)),
                    "{convention:?} {side:?}"
                );
            }
        }
    }
}

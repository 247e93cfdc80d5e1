//! Axes: those of the study and those of the kernel.
//!
//! The kernel only ever sees a left wheel in ISO 8855 axes (x forward, y left, z up). Other
//! conventions and right-hand wheels differ by the signs of coordinates alone, so the change of frame
//! is exact and a mirrored car gives mirrored results to the last bit.

use crate::number::Vector3;

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

    /// Lower-case letter, as in studies and column names.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self as usize]
    }
}

/// Which side of the car the wheel is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Left wheel.
    Left,
    /// Right wheel.
    Right,
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

/// The unit of every length in a study and in its results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    Millimetre,
    /// Metres.
    Metre,
}

impl LengthUnit {
    /// The unit's symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            LengthUnit::Millimetre => "mm",
            LengthUnit::Metre => "m",
        }
    }

    /// How many of it a metre has.
    pub fn per_metre(self) -> f64 {
        match self {
            LengthUnit::Millimetre => 1000.0,
            LengthUnit::Metre => 1.0,
        }
    }
}

/// The map between the study's axes and the kernel's: a sign for each coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    signs: [f64; 3],
}

impl Frame {
    /// The frame of a study.
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

    /// The sign of one coordinate: kernel = sign x study, and the other way round.
    pub fn sign(&self, axis: Axis) -> f64 {
        self.signs[axis as usize]
    }

    /// A position or displacement, study to kernel or kernel to study (the map is its own inverse).
    pub fn vector(&self, v: Vector3<f64>) -> Vector3<f64> {
        let [x, y, z] = self.signs;
        Vector3::new(x * v.x, y * v.y, z * v.z)
    }

    /// The sign of one component of an angular velocity or acceleration, which turns the other way
    /// in a mirror.
    pub fn turn_sign(&self, axis: Axis) -> f64 {
        self.signs.iter().product::<f64>() * self.sign(axis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// omega x r maps like a vector when omega maps like a turn, in every convention.
    #[test]
    fn turns_map_so_that_velocities_map_as_vectors() {
        let (omega, r) = (Vector3::new(0.1, 0.2, -0.4), Vector3::new(3.0, -1.0, 2.0));
        for convention in [
            FrameConvention::Iso8855,
            FrameConvention::SaeJ670,
            FrameConvention::XRear,
        ] {
            for side in [Side::Left, Side::Right] {
                let frame = Frame::new(convention, side);
                let turned = Vector3::new(
                    frame.turn_sign(Axis::X) * omega.x,
                    frame.turn_sign(Axis::Y) * omega.y,
                    frame.turn_sign(Axis::Z) * omega.z,
                );
                assert_eq!(
                    frame.vector(omega.cross(r)),
                    turned.cross(frame.vector(r)),
                    "{convention:?} {side:?}"
                );
            }
        }
    }
}

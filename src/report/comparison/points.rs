//! Hardpoints of a compared design.

/// Points of a wheel by name.
#[derive(Clone, Debug)]
pub struct NamedPoints {
    /// Names of the points, and their positions in the kernel's frame of the wheel.
    pub points: Vec<(String, [f64; 3])>,
    /// Signs that convert coordinates from the kernel's frame (x forward, y outboard, z up) to the study's axes.
    pub signs: [f64; 3],
}

/// Hardpoints of a design.
#[derive(Clone, Debug)]
pub enum ComparedPoints {
    /// Points of one wheel, or of the left wheel if the right wheel of the axle is its mirror image.
    OneWheel(NamedPoints),
    /// Points of the left and the right wheel.
    BothWheels([NamedPoints; 2]),
}

impl ComparedPoints {
    /// Points of a wheel by its index. 0 is the left wheel.
    pub(super) fn wheel(&self, number: usize) -> &NamedPoints {
        match self {
            ComparedPoints::OneWheel(points) => points,
            ComparedPoints::BothWheels(wheels) => &wheels[number],
        }
    }
}

//! The elastic parts of both wheels of an axle.

use crate::compliance::definition::{Compliance, Relaxed, Subframe};
use crate::compliance::inputs::Parameter;
use crate::compliance::law::Shape;

/// The elastic parts of an axle.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleCompliance<T = f64> {
    /// The parts of left and right wheel, each as a left wheel's.
    pub wheels: [Compliance<T>; 2],
    /// The subframe; `None` if the body holds all inner ends.
    pub subframe: Option<Subframe<T>>,
    /// Stiffness between commanded rack and rack: force per length. `None` for a rigid one.
    pub rack_rate: Option<T>,
    /// Rate of the anti-roll bar: torque per angle between its levers. `None` without it.
    pub bar_rate: Option<T>,
}

impl AxleCompliance {
    /// The parts over another kind of number.
    pub fn map<U>(&self, f: impl Fn(f64) -> U + Copy) -> AxleCompliance<U> {
        AxleCompliance {
            wheels: self.wheels.each_ref().map(|wheel| wheel.map(f)),
            subframe: self.subframe.as_ref().map(|subframe| subframe.map(f)),
            rack_rate: self.rack_rate.map(f),
            bar_rate: self.bar_rate.map(f),
        }
    }

    /// Returns true if no part is elastic.
    pub fn is_rigid(&self) -> bool {
        let is_rigid = self.wheels.iter().all(Compliance::is_rigid);
        is_rigid && self.subframe.is_none() && self.rack_rate.is_none()
    }

    /// Position in which elastic parts are relaxed.
    pub fn relaxed(&self) -> Relaxed {
        self.wheels[0].relaxed
    }
}

impl<T> AxleCompliance<T> {
    /// The number of a parameter in the parts that both wheels share. Bushings beyond those of a wheel are the mounts of
    /// the subframe.
    pub(super) fn shared_number(&mut self, parameter: Parameter) -> Option<&mut T> {
        let (number, axis) = match parameter {
            Parameter::RackRate => return self.rack_rate.as_mut(),
            Parameter::BarRate => return self.bar_rate.as_mut(),
            Parameter::Stiffness(number, axis)
            | Parameter::Cubic(number, axis)
            | Parameter::Preload(number, axis) => (number, axis),
            _ => return None,
        };
        let number = number.checked_sub(self.wheels[0].bushings.len())?;
        let mount = self.subframe.as_mut()?.mounts.get_mut(number)?;
        match (parameter, &mut mount.shapes[axis]) {
            (Parameter::Stiffness(..), Shape::Cubic { rate, .. }) => Some(rate),
            (Parameter::Stiffness(..), Shape::Curve { scale, .. }) => Some(scale),
            (Parameter::Cubic(..), Shape::Cubic { cubic, .. }) => Some(cubic),
            (Parameter::Preload(..), _) => Some(&mut mount.preload[axis]),
            _ => None,
        }
    }
}

//! The elastic parts of both wheels of an axle.

use crate::compliance::definition::{Compliance, Relaxed, Subframe};
use crate::compliance::inputs::{AxleParameter, Parameter};
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
    pub fn map<U: Copy>(&self, f: impl Fn(f64) -> U + Copy) -> AxleCompliance<U> {
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

    /// Sets the rate of a bushing, link, rack or anti-roll bar; of a curve, the factor of its forces.
    pub fn set_rate(&mut self, of: AxleParameter, value: f64) {
        match self.shared_number(of.parameter) {
            Some(number) => *number = value,
            None => of
                .of_sides(&mut self.wheels)
                .for_each(|wheel| wheel.set_rate(of.parameter, value)),
        }
    }

    /// Returns true if both wheels share the part of a parameter.
    pub fn is_shared(&self, parameter: Parameter) -> bool {
        self.map(|value| value).shared_number(parameter).is_some()
    }

    /// Returns true if the parameter's part has another law at the right wheel than at the left one.
    pub fn differs(&self, parameter: Parameter) -> bool {
        let [left, right] = &self.wheels;
        match parameter {
            Parameter::Stiffness(number, axis) => {
                let law =
                    |wheel: &Compliance| Some(wheel.bushings.get(number)?.shapes[axis].clone());
                law(right).is_some_and(|own| law(left) != Some(own))
            }
            Parameter::Link(number) => {
                let stiffness = |wheel: &Compliance| Some(wheel.links.get(number)?.stiffness);
                stiffness(right).is_some_and(|own| stiffness(left) != Some(own))
            }
            _ => false,
        }
    }

    /// Position in which elastic parts are relaxed.
    pub fn relaxed(&self) -> Relaxed {
        self.wheels[0].relaxed
    }
}

impl<T> AxleCompliance<T> {
    /// Value of a parameter of the parts that both wheels share. The mounts of the subframe are numbered after the
    /// bushings of one wheel.
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

//! Elastic parts of both wheels of an axle.

use crate::compliance::definition::{Compliance, Relaxed, Subframe};
use crate::compliance::inputs::{AxleParameter, Parameter, scatter_rate};
use crate::compliance::law::Shape;
use crate::number::Scalar;

/// A steering column that twists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteeringColumn<T = f64> {
    /// Torque per angle: force x length per radian.
    pub rate: T,
    /// Displacement of the rack per radian of the pinion.
    pub rack_per_angle: f64,
}

/// Elastic parts of an axle.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleCompliance<T = f64> {
    /// Elastic parts of the left and the right wheel. Each wheel is described in the axes of a left wheel.
    pub wheels: [Compliance<T>; 2],
    /// Subframe; `None` if all inner ends are on the body.
    pub subframe: Option<Subframe<T>>,
    /// Stiffness between the commanded and the actual rack displacement, without the steering column: force per length.
    /// `None` if it is rigid.
    pub rack_rate: Option<T>,
    /// Steering column, in series with the rack. `None` for a rigid column.
    pub column: Option<SteeringColumn<T>>,
    /// Rate of the anti-roll bar: torque per difference of the angles of its levers. `None` without a bar.
    pub bar_rate: Option<T>,
}

impl AxleCompliance {
    /// Converts the parts to another number type.
    pub fn map<U: Copy>(&self, f: impl Fn(f64) -> U + Copy) -> AxleCompliance<U> {
        AxleCompliance {
            wheels: self.wheels.each_ref().map(|wheel| wheel.map(f)),
            subframe: self.subframe.as_ref().map(|subframe| subframe.map(f)),
            rack_rate: self.rack_rate.map(f),
            column: self.column.map(|column| SteeringColumn {
                rate: f(column.rate),
                rack_per_angle: column.rack_per_angle,
            }),
            bar_rate: self.bar_rate.map(f),
        }
    }

    /// Returns true if no bushing, link or steering part is elastic and there is no subframe. Springs and anti-roll bar do not
    /// count.
    pub fn is_rigid(&self) -> bool {
        let is_rigid = self.wheels.iter().all(Compliance::is_rigid);
        is_rigid && self.subframe.is_none() && !self.steering_yields()
    }

    /// Returns true if the rack moves under load while the steering wheel is held.
    pub fn steering_yields(&self) -> bool {
        self.rack_rate.is_some() || self.column.is_some()
    }

    /// Sets the value of a parameter, for example the rate of a bushing, link, spring, rack, column or anti-roll bar. If the
    /// law of a bushing is a force curve, the function sets the factor on the forces of the curve. If these parts do not have
    /// the parameter, nothing changes.
    pub fn set_rate(&mut self, of: AxleParameter, value: f64) {
        match self.shared_number(of.parameter) {
            Some(number) => *number = value,
            None => of
                .of_sides(&mut self.wheels)
                .for_each(|wheel| wheel.set_rate(of.parameter, value)),
        }
    }

    /// Changes the value of a parameter by `change`, or by the fraction `change` if `is_relative` is true. Returns false if a
    /// new value is not above 0.
    pub(crate) fn change_rate(
        &mut self,
        of: AxleParameter,
        change: f64,
        is_relative: bool,
    ) -> bool {
        match self.shared_number(of.parameter) {
            Some(number) => scatter_rate(number, change, is_relative),
            None => of
                .of_sides(&mut self.wheels)
                .all(|wheel| wheel.change_rate(of.parameter, change, is_relative)),
        }
    }

    /// Returns true if the axle has only one part with this parameter. Both wheels share this part, or it is a link or
    /// bushing in the middle of a solid axle. The data of the left wheel contain the parts in the middle, after the others.
    pub fn is_shared(&self, parameter: Parameter) -> bool {
        let [left, right] = &self.wheels;
        let is_in_the_middle = match parameter {
            Parameter::Link(number) | Parameter::LinkPreload(number) => {
                (right.links.len()..left.links.len()).contains(&number)
            }
            Parameter::Stiffness(number, _)
            | Parameter::Cubic(number, _)
            | Parameter::Preload(number, _) => {
                (right.bushings.len()..left.bushings.len()).contains(&number)
            }
            _ => false,
        };
        is_in_the_middle || self.map(|value| value).shared_number(parameter).is_some()
    }

    /// Returns true if the part of this parameter has different laws at the two wheels. The parameter is the rate of a
    /// bushing, link or spring; for other parameters, the result is false.
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
            Parameter::SpringRate => left.spring_rate() != right.spring_rate(),
            _ => false,
        }
    }

    /// Position in which the elastic parts are relaxed.
    pub fn relaxed(&self) -> Relaxed {
        self.wheels[0].relaxed
    }
}

impl<T> AxleCompliance<T> {
    /// Returns the value of a parameter of the parts that both wheels share. For bushings, the indices of the wheel's
    /// bushings come first, and then the indices of the subframe's mounts.
    pub(super) fn shared_number(&mut self, parameter: Parameter) -> Option<&mut T> {
        let (number, axis) = match parameter {
            Parameter::RackRate => return self.rack_rate.as_mut(),
            Parameter::ColumnRate => return self.column.as_mut().map(|column| &mut column.rate),
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

impl<T: Scalar> AxleCompliance<T> {
    /// Returns the stiffness between the commanded and the actual rack displacement, with rack and column in series:
    /// force per length. `None` if both are rigid. With the rack's displacement per radian c, the column's rate k_c and
    /// the rack's rate k_r, 1/k = 1/k_r + c^2/k_c.
    pub fn steering_rate(&self) -> Option<T> {
        let of_column = self.column.map(|column| {
            let c = column.rack_per_angle;
            column.rate * column.rate.constant(1.0 / (c * c))
        });
        match (self.rack_rate, of_column) {
            (Some(rack), Some(column)) => Some(rack * column / (rack + column)),
            (rack, column) => rack.or(column),
        }
    }
}

//! `sensitivities.csv` of a car.

use super::files::csv;
use super::{CarResults, CarState};
use crate::car::{
    AXLE_NAMES, AxleParameter, BodyParameter, CarGradient, CarSolver, Parameter, body_key, rate_key,
};
use crate::model::{Axis, PointId};
use crate::report::optional;

impl<'s> CarResults<'s> {
    /// Content of `sensitivities.csv`, if the study requests it: derivatives of the results with respect to hardpoints and
    /// parameters. Cases without an equilibrium or without derivatives have no rows.
    pub fn sensitivities_csv(&self, solver: &mut CarSolver<'s>) -> Option<Vec<u8>> {
        if !self.study.sensitivities {
            return None;
        }
        let header = [
            "case",
            "output",
            "axle",
            "parameter",
            "axis",
            "value",
            "unit",
        ];
        let mut rows = Vec::new();
        for (case, state) in self.study.cases.iter().zip(&self.states) {
            let CarState::Solved { found, .. } = state else {
                continue;
            };
            let mut quantities = self.study.quantities.clone();
            quantities.retain(|quantity| quantity.undefined_in(case).is_none());
            let Ok(gradients) = solver.gradients(case, found, &quantities) else {
                continue;
            };
            for (quantity, gradient) in quantities.iter().zip(&gradients) {
                let unit = quantity.info().unit;
                let (length, factor) = (
                    self.study.car.length_unit,
                    unit.printed_factor(self.study.car.length_unit),
                );
                let mut push = |axle: &str, parameter: &str, axis: &str, value: f64, by: &str| {
                    let suffix = match unit.suffix(length) {
                        suffix if suffix.is_empty() => "1".to_owned(),
                        suffix => suffix,
                    };
                    rows.push(vec![
                        case.name.clone(),
                        quantity.name(),
                        axle.to_owned(),
                        parameter.to_owned(),
                        axis.to_owned(),
                        optional(factor * value),
                        format!("{suffix}_per_{by}"),
                    ]);
                };
                self.push_gradient(gradient, &mut push);
            }
        }
        Some(csv(&header.map(str::to_owned), rows))
    }

    /// Derivatives of a result with respect to the parameters of both axles and of the body. `push` receives axle, parameter, axis,
    /// derivative, and unit of the parameter.
    fn push_gradient(
        &self,
        gradient: &CarGradient,
        push: &mut impl FnMut(&str, &str, &str, f64, &str),
    ) {
        for number in 0..AXLE_NAMES.len() {
            self.push_axle(number, gradient, push);
        }
        self.push_body(gradient, push);
    }

    /// Derivatives with respect to the hardpoints and the parameters of an axle.
    fn push_axle(
        &self,
        number: usize,
        gradient: &CarGradient,
        push: &mut impl FnMut(&str, &str, &str, f64, &str),
    ) {
        let (car, end) = (&self.study.car, AXLE_NAMES[number]);
        let axle = &car.axles[number].left;
        for (k, by) in gradient.hardpoints[number].iter().enumerate() {
            // Points that follow other points have no rows, such as the points in the right half of a solid axle. The derivatives
            // for the left half include the motion of the right half.
            if axle.mechanism.is_far(PointId(k)) {
                continue;
            }
            let name = axle.mechanism.name(PointId(k));
            for axis in Axis::ALL {
                push(
                    end,
                    name,
                    axis.name(),
                    axle.frame.sign(axis) * by[axis],
                    self.unit(),
                );
            }
        }
        for parameter in [
            AxleParameter::SpringRate,
            AxleParameter::SpringForce,
            AxleParameter::BarRate,
            AxleParameter::HeaveSpringRate,
            AxleParameter::HeaveSpringForce,
            AxleParameter::TBarRate,
            AxleParameter::HeaveBarRate,
            AxleParameter::HeaveBarTorque,
            AxleParameter::Rack,
            AxleParameter::TyreRate,
            AxleParameter::Radius,
            AxleParameter::UnsprungMass,
        ] {
            if !parameter.is_of(&car.axles[number]) {
                continue;
            }
            let (unit, factor) = parameter.unit(car);
            let sign = match parameter {
                AxleParameter::Rack => axle.frame.sign(Axis::Y),
                _ => 1.0,
            };
            let by = gradient.parameters[Parameter::Axle(number, parameter).place()];
            push(end, rate_key(parameter), "", sign * factor * by, &unit);
        }
    }

    /// Derivatives with respect to the parameters of the body and the case, and to the wheelbase.
    fn push_body(
        &self,
        gradient: &CarGradient,
        push: &mut impl FnMut(&str, &str, &str, f64, &str),
    ) {
        let (length, mass) = (self.unit(), self.study.car.mass_unit);
        let frame = self.study.frame();
        let by = |own: BodyParameter| gradient.parameters[Parameter::Body(own).place()];
        push(
            "",
            "mass",
            "",
            mass.kilograms() * by(BodyParameter::Mass),
            mass.symbol(),
        );
        for (axis, own) in [
            (Axis::X, BodyParameter::CgX),
            (Axis::Y, BodyParameter::CgY),
            (Axis::Z, BodyParameter::CgZ),
        ] {
            push("", "cg", axis.name(), frame.sign(axis) * by(own), length);
        }
        for (own, unit) in [
            (BodyParameter::BrakeShareFront, "1"),
            (BodyParameter::DriveShareFront, "1"),
            (BodyParameter::Ax, "g"),
            (BodyParameter::Ay, "g"),
            (BodyParameter::Az, "g"),
            (BodyParameter::Speed, "m_per_s"),
        ] {
            push("", body_key(own), "", by(own), unit);
        }
        let offset = Parameter::Axle(1, AxleParameter::OffsetX).place();
        push("", "wheelbase", "", -gradient.parameters[offset], length);
    }
}

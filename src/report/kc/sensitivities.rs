//! `sensitivities.csv` of rig tests: derivatives of every figure by hardpoints, rates, preloads and the spring.

use super::super::shortest;
use super::{KcResults, csv, held};
use crate::axle::Law;
use crate::compliance::{AxialStiffness, Compliance, KcRun, KcValue, Parameter, Shape, TestLoad};
use crate::model::{Axis, PointId};
use crate::number::Tape;
use crate::study::RATE_AXES;

/// An input with how it is written: name, axis, unit of the input, and what its printed unit holds of the program's.
struct Input {
    parameter: Parameter,
    name: String,
    axis: String,
    unit: String,
    /// Derivative by the printed input per derivative by the program's.
    factor: f64,
}

impl KcResults<'_> {
    /// The inputs of a suspension: the coordinates of these points, and the inputs of its elastic parts.
    fn inputs(&self, parts: &Compliance, points: &[PointId]) -> Vec<Input> {
        let suspension = self.suspension;
        let u = suspension.length_unit.symbol();
        let mut inputs = Vec::new();
        for point in points {
            inputs.extend(Axis::ALL.map(|axis| Input {
                parameter: Parameter::Point(*point, axis),
                name: suspension.mechanism.name(*point).to_owned(),
                axis: axis.name().to_owned(),
                unit: u.to_owned(),
                factor: suspension.frame.sign(axis),
            }));
        }
        for (number, (part, name)) in parts.bushings.iter().zip(&self.bushings).enumerate() {
            for (k, shape) in part.shapes.iter().enumerate() {
                let unit = match (shape, k) {
                    // An axis without stiffness has none that could change.
                    (Shape::Cubic { rate: 0.0, .. }, _) => continue,
                    (Shape::Cubic { .. }, 0..3) => format!("N_per_{u}"),
                    (Shape::Cubic { .. }, _) => format!("N_{u}_per_rad"),
                    (Shape::Curve { .. }, _) => String::new(),
                };
                inputs.push(Input {
                    parameter: Parameter::Stiffness(number, k),
                    name: format!("bushing:{name}"),
                    axis: RATE_AXES[k].to_owned(),
                    unit,
                    factor: 1.0,
                });
            }
            for (k, axis) in RATE_AXES.into_iter().enumerate() {
                inputs.push(Input {
                    parameter: Parameter::Preload(number, k),
                    name: format!("preload:{name}"),
                    axis: axis.to_owned(),
                    unit: if k < 3 {
                        "N".to_owned()
                    } else {
                        format!("N_{u}")
                    },
                    factor: 1.0,
                });
            }
        }
        for (number, (part, name)) in parts.links.iter().zip(&self.links).enumerate() {
            inputs.push(Input {
                parameter: Parameter::Link(number),
                name: format!("link:{name}"),
                axis: String::new(),
                unit: match part.stiffness {
                    AxialStiffness::Rate(_) => format!("N_per_{u}"),
                    AxialStiffness::PerStrain(_) => "N".to_owned(),
                },
                factor: 1.0,
            });
        }
        let spring = parts.spring.as_ref().map(|law| &law.spring);
        if let Some(Law::Linear { .. }) = spring {
            let of = [
                (Parameter::SpringRate, "spring_rate", format!("N_per_{u}")),
                (Parameter::SpringForce, "spring_force", "N".to_owned()),
            ];
            inputs.extend(of.map(|(parameter, name, unit)| Input {
                parameter,
                name: name.to_owned(),
                axis: String::new(),
                unit,
                factor: 1.0,
            }));
        }
        inputs
    }

    /// `sensitivities.csv`: a row for each station, test, figure and input; `None` if no points are requested.
    pub fn sensitivities_csv(
        &self,
        run: &KcRun<'_>,
        parts: &Compliance,
        points: &[PointId],
    ) -> Option<Vec<u8>> {
        if points.is_empty() {
            return None;
        }
        let length = self.suspension.length_unit;
        let inputs = self.inputs(parts, points);
        let parameters: Vec<Parameter> = inputs.iter().map(|input| input.parameter).collect();
        let header = self.columns(&[
            "travel_U",
            "rack_U",
            "load",
            "trail_U",
            "hold",
            "quantity",
            "parameter",
            "axis",
            "value",
            "secant",
            "unit",
        ]);
        let mut rows = Vec::new();
        let mut tape = Tape::default();
        for station in &self.stations {
            for outcome in station.outcomes.iter().flatten() {
                let test = outcome.test;
                let value = |quantity, is_secant| KcValue::Figure {
                    test,
                    quantity,
                    is_secant,
                };
                let has_levels = !outcome.levels.is_empty();
                let kinds: &[bool] = if has_levels { &[false, true] } else { &[false] };
                let mut wanted = Vec::new();
                for figure in &outcome.figures {
                    wanted.extend(
                        kinds
                            .iter()
                            .map(|is_secant| value(figure.quantity, *is_secant)),
                    );
                }
                let mut found: Vec<Option<Vec<f64>>> = vec![None; wanted.len()];
                let at = [station.travel, station.rack];
                // The station has an equilibrium: its figures are there.
                let read = run.gradients(at, &wanted, &parameters, &mut tape, &mut |gradient| {
                    found[gradient.number] = gradient.value.map(|_| gradient.by.to_vec());
                });
                if read.is_err() {
                    continue;
                }
                let trail = (test.load == TestLoad::Lateral).then_some(test.trail);
                for (figure, found) in outcome.figures.iter().zip(found.chunks(kinds.len())) {
                    let printed = figure.unit.printed_factor(length);
                    let of = figure.unit.suffix(length);
                    for (k, input) in inputs.iter().enumerate() {
                        let slope = |kind: usize| {
                            let by = found.get(kind)?.as_ref()?;
                            Some(by[k] * printed * input.factor + 0.0)
                        };
                        let number = |value: Option<f64>| value.map_or_else(String::new, shortest);
                        let unit = match (of.is_empty(), input.unit.is_empty()) {
                            (true, true) => String::new(),
                            (false, true) => of.clone(),
                            (true, false) => format!("1_per_{}", input.unit),
                            (false, false) => format!("{of}_per_{}", input.unit),
                        };
                        rows.push(vec![
                            shortest(station.travel),
                            shortest(station.rack),
                            test.load.name().to_owned(),
                            number(trail),
                            held(&test).to_owned(),
                            figure.quantity.to_owned(),
                            input.name.clone(),
                            input.axis.clone(),
                            number(slope(0)),
                            number(slope(1)),
                            unit,
                        ]);
                    }
                }
            }
        }
        Some(csv(&header, rows))
    }
}

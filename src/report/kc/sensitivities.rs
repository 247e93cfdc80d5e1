//! `sensitivities.csv` of `kc` tests: derivatives of every result with respect to hardpoints, rates, preloads and the spring.

use super::{KcResults, bar, csv, held, mode, optional, steering, subject};
use crate::axle::Law;
use crate::compliance::{
    AxialStiffness, AxleCompliance, AxleKcRun, Compliance, FigureGradients, KcOutcome, KcRun,
    KcStation, KcTest, KcValue, Parameter, Shape, SubframeMount, TestLoad,
};
use crate::model::{Axis, PointId};
use crate::study::RATE_AXES;

/// An input of the derivatives (coordinate, rate or other parameter), with its printed name, axis and unit.
struct Input {
    parameter: Parameter,
    name: String,
    axis: String,
    unit: String,
    /// Factor that converts a derivative from the program's unit of the input to the printed unit.
    factor: f64,
}

impl KcResults<'_> {
    /// Inputs of the derivatives: coordinates of `points`, values of the elastic parts, and values of the subframe's `mounts`.
    fn inputs(
        &self,
        parts: &Compliance,
        mounts: &[SubframeMount],
        points: &[PointId],
    ) -> Vec<Input> {
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
        let shapes = parts.bushings.iter().map(|part| &part.shapes);
        let shapes = shapes.chain(mounts.iter().map(|mount| &mount.shapes));
        for (number, (shapes, name)) in shapes.zip(&self.bushings).enumerate() {
            for (k, shape) in shapes.iter().enumerate() {
                let unit = match (shape, k) {
                    // An axis without stiffness has no rate that could change.
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

    /// `sensitivities.csv` of one wheel. `None` if no points are requested.
    pub fn sensitivities_csv(
        &self,
        run: &KcRun<'_>,
        parts: &Compliance,
        points: &[PointId],
    ) -> Option<Vec<u8>> {
        let inputs = self.inputs(parts, &[], points);
        let parameters: Vec<Parameter> = inputs.iter().map(|input| input.parameter).collect();
        let gradients = |station: &KcStation, outcomes: &[KcOutcome]| {
            // Lists one result after the other. If the test has load levels, each result is followed by its secant.
            let mut wanted = Vec::new();
            let mut places: Vec<Vec<FigureGradients>> = Vec::new();
            let mut of_wanted = Vec::new();
            for (number, outcome) in outcomes.iter().enumerate() {
                let kinds = if outcome.levels.is_empty() { 1 } else { 2 };
                for (figure, found) in outcome.figures.iter().enumerate() {
                    for kind in 0..kinds {
                        of_wanted.push([number, figure, kind]);
                        wanted.push(KcValue::Figure {
                            test: outcome.test,
                            quantity: found.quantity,
                            is_secant: kind == 1,
                        });
                    }
                }
                places.push(vec![[None, None]; outcome.figures.len()]);
            }
            let at = [station.travel, station.rack];
            let read = run.gradients(at, &wanted, &parameters, &mut |gradient| {
                let [number, figure, kind] = of_wanted[gradient.number];
                places[number][figure][kind] = gradient.value.map(|_| gradient.by.to_vec());
            });
            read.ok()?;
            Some(places)
        };
        (!points.is_empty()).then(|| self.sensitivity_rows(&inputs, gradients))
    }

    /// `sensitivities.csv` of an axle. `None` if no points are requested.
    pub fn axle_sensitivities_csv(
        &self,
        run: &AxleKcRun<'_>,
        parts: &AxleCompliance,
        points: &[PointId],
    ) -> Option<Vec<u8>> {
        let mounts = parts.subframe.as_ref().map_or(&[][..], |own| &own.mounts);
        let mut inputs = self.inputs(&parts.wheels[0], mounts, points);
        let u = self.suspension.length_unit.symbol();
        let shared = [
            (
                Parameter::RackRate,
                "rack_stiffness",
                parts.rack_rate,
                format!("N_per_{u}"),
            ),
            (
                Parameter::ColumnRate,
                "column_stiffness",
                parts.column.map(|column| column.rate),
                format!("N_{u}_per_rad"),
            ),
            (
                Parameter::BarRate,
                "anti_roll_bar",
                parts.bar_rate,
                format!("N_{u}_per_rad"),
            ),
        ];
        for (parameter, name, rate, unit) in shared {
            inputs.extend(rate.map(|_| Input {
                parameter,
                name: name.to_owned(),
                axis: String::new(),
                unit,
                factor: 1.0,
            }));
        }
        let parameters: Vec<Parameter> = inputs.iter().map(|input| input.parameter).collect();
        let gradients = |station: &KcStation, outcomes: &[KcOutcome]| {
            let tests: Vec<KcTest> = outcomes.iter().map(|outcome| outcome.test).collect();
            let travels = [
                station.travel,
                station.right_travel.unwrap_or(station.travel),
            ];
            run.gradients(travels, station.rack, &tests, &parameters)
        };
        (!points.is_empty()).then(|| self.sensitivity_rows(&inputs, gradients))
    }

    /// CSV file with a row for each station, test, result and input. `gradients` computes the derivatives of all results of the
    /// tests at a station.
    fn sensitivity_rows(
        &self,
        inputs: &[Input],
        mut gradients: impl FnMut(&KcStation, &[KcOutcome]) -> Option<Vec<Vec<FigureGradients>>>,
    ) -> Vec<u8> {
        let length = self.suspension.length_unit;
        let mut header = self.station_columns();
        header.extend(self.columns(&["load", "trail_U"]));
        header.extend(self.is_axle.then(|| "mode".to_owned()));
        header.push("hold".to_owned());
        if self.is_axle {
            header.extend(["anti_roll_bar", "steering", "wheel"].map(str::to_owned));
        }
        let last = ["quantity", "parameter", "axis", "value", "secant", "unit"];
        header.extend(last.map(str::to_owned));
        let mut rows = Vec::new();
        for station in &self.stations {
            let Ok(outcomes) = &station.outcomes else {
                continue;
            };
            // Only a station with an equilibrium has derivatives.
            let Some(found) = gradients(station, outcomes) else {
                continue;
            };
            for (outcome, found) in outcomes.iter().zip(found) {
                let test = outcome.test;
                let trail = (test.load == TestLoad::Lateral).then_some(test.trail);
                for (figure, found) in outcome.figures.iter().zip(found) {
                    let printed = figure.unit.printed_factor(length);
                    let of = figure.unit.suffix(length);
                    for (k, input) in inputs.iter().enumerate() {
                        let slope = |by: &Option<Vec<f64>>| {
                            Some(by.as_ref()?[k] * printed * input.factor + 0.0)
                        };
                        let unit = match (of.is_empty(), input.unit.is_empty()) {
                            (true, true) => String::new(),
                            (false, true) => of.clone(),
                            (true, false) => format!("1_per_{}", input.unit),
                            (false, false) => format!("{of}_per_{}", input.unit),
                        };
                        let mut row = self.station(station);
                        row.extend([test.load.name().to_owned(), optional(trail)]);
                        row.extend(self.is_axle.then(|| mode(&test).to_owned()));
                        row.push(held(&test).to_owned());
                        if self.is_axle {
                            let words = [bar(&test), steering(&test), subject(figure.of)];
                            row.extend(words.map(str::to_owned));
                        }
                        row.extend([
                            figure.quantity.to_owned(),
                            input.name.clone(),
                            input.axis.clone(),
                            optional(slope(&found[0])),
                            optional(slope(&found[1])),
                            unit,
                        ]);
                        rows.push(row);
                    }
                }
            }
        }
        csv(header, rows)
    }
}

//! Results of a car: `cases.csv`, `gg.csv`, `sensitivities.csv`, tables, and the studies of a tuned car.

use super::table::{Cell, Table};
use super::{figure, optional, shortest};
use crate::car::{
    AxleParameter, BodyParameter, Car, CarQuantity, CarSolver, Case, Equilibrium, Longitudinal,
    Moves, NoEquilibrium, Parameter, Solved, WheelPlace, WheelResult, WholeResult, body_key,
    rate_key,
};
use crate::model::{Axis, PointId};
use crate::number::Vector3;
use crate::study::{CarOptimise, CarStudy, edited};
use serde_json::{Value, json};

/// The state of a case, or the reason why there is none.
pub enum CarState<'s> {
    /// Solved.
    Solved {
        /// The state.
        found: Box<Equilibrium>,
        /// The state with its derivatives.
        solved: Box<Solved<'s, f64>>,
    },
    /// Not solved.
    Failed(NoEquilibrium),
}

/// States of all cases of a study.
pub struct CarResults<'s> {
    study: &'s CarStudy,
    /// The states, in the order of the cases.
    pub states: Vec<CarState<'s>>,
}

/// Solves a case with its derivatives, from a neighbouring state if there is one.
fn state<'s>(
    solver: &mut CarSolver<'s>,
    case: &Case,
    neighbour: Option<&Equilibrium>,
) -> CarState<'s> {
    let found = match neighbour {
        Some(neighbour) => solver.solve_from(case, neighbour),
        None => solver.solve(case),
    };
    let solved = found.and_then(|found| {
        let solved = Box::new(solver.solved(case, &found)?);
        let found = Box::new(found);
        Ok(CarState::Solved { found, solved })
    });
    solved.unwrap_or_else(CarState::Failed)
}

/// Names of lifted wheels, parted by blanks.
fn lifted(found: &Equilibrium) -> String {
    let names = WheelPlace::ALL
        .into_iter()
        .filter(|place| found.lifted[place.0]);
    names.map(WheelPlace::name).collect::<Vec<_>>().join(" ")
}

/// A CSV file of rows of text.
fn csv(header: &[String], rows: impl IntoIterator<Item = Vec<String>>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = "written to memory";
    writer.write_record(header).expect(written);
    for row in rows {
        writer.write_record(&row).expect(written);
    }
    writer.into_inner().expect(written)
}

impl<'s> CarResults<'s> {
    /// Solves the first `count` cases.
    pub fn solve(study: &'s CarStudy, solver: &mut CarSolver<'s>, count: usize) -> Self {
        let cases = study.cases.iter().take(count);
        CarResults {
            study,
            states: cases.map(|case| state(solver, case, None)).collect(),
        }
    }

    fn unit(&self) -> &'static str {
        self.study.car.length_unit.symbol()
    }

    fn columns(&self) -> Vec<String> {
        let unit = self.study.car.length_unit;
        self.study
            .quantities
            .iter()
            .map(|q| q.column(unit))
            .collect()
    }

    fn values(&self, state: &CarState<'_>, case: &Case) -> Vec<String> {
        let quantities = self.study.quantities.iter();
        match state {
            CarState::Solved { solved, .. } => quantities
                .map(|q| optional(q.printed(solved, case)))
                .collect(),
            CarState::Failed(_) => quantities.map(|_| String::new()).collect(),
        }
    }

    fn end(state: &CarState<'_>) -> [String; 2] {
        match state {
            CarState::Solved { .. } => [String::new(), "ok".to_owned()],
            CarState::Failed(why) => [why.to_string(), why.status().to_owned()],
        }
    }

    fn rack(&self, case: &Case) -> f64 {
        self.study.frame().sign(Axis::Y) * case.racks[0]
    }

    /// `cases.csv`.
    pub fn cases_csv(&self) -> Vec<u8> {
        let rack = format!("rack_{}", self.unit());
        let fixed = [
            "case",
            "ax_g",
            "ay_g",
            "az_g",
            "speed_m_per_s",
            "yaw_acceleration_rad_per_s2",
            &rack,
            "steering_wheel_angle_deg",
            "longitudinal",
            "tyres",
            "wheels_lifted",
        ];
        let mut header: Vec<String> = fixed.map(str::to_owned).to_vec();
        header.extend(self.columns());
        header.extend(["reason".to_owned(), "status".to_owned()]);
        let per_turn = self.study.car.axles[0].setup.c_factor;
        let rows = self
            .study
            .cases
            .iter()
            .zip(&self.states)
            .map(|(case, state)| {
                let angle = per_turn.map(|per_turn| 360.0 * case.racks[0] / per_turn);
                let mut row = vec![
                    case.name.clone(),
                    shortest(case.ax),
                    shortest(case.ay),
                    shortest(case.az),
                    shortest(case.speed),
                    shortest(case.yaw_acceleration),
                    shortest(self.rack(case)),
                    optional(angle),
                    longitudinal(case).to_owned(),
                    match case.setting.elastic_tyres {
                        true => "elastic".to_owned(),
                        false => "rigid".to_owned(),
                    },
                    match state {
                        CarState::Solved { found, .. } => lifted(found),
                        CarState::Failed(_) => String::new(),
                    },
                ];
                row.extend(self.values(state, case));
                row.extend(Self::end(state));
                row
            });
        csv(&header, rows)
    }

    /// `gg.csv`, if the study asks for it, and how many of its states have no equilibrium. Each state starts from its
    /// neighbour.
    pub fn gg_csv(&self, solver: &mut CarSolver<'s>) -> (Option<Vec<u8>>, usize) {
        let Some(map) = &self.study.gg_map else {
            return (None, 0);
        };
        let rack = format!("rack_{}", self.unit());
        let fixed = [
            "ax_g",
            "ay_g",
            "az_g",
            "speed_m_per_s",
            &rack,
            "wheels_lifted",
        ];
        let mut header: Vec<String> = fixed.map(str::to_owned).to_vec();
        header.extend(self.columns());
        header.extend(["reason".to_owned(), "status".to_owned()]);
        let mut rows = Vec::new();
        let mut failures = 0;
        for ax in &map.ax {
            let mut before: Option<Equilibrium> = None;
            for ay in &map.ay {
                let mut case = map.case.clone();
                (case.ax, case.ay) = (*ax, *ay);
                if *ax < 0.0 {
                    case.setting.longitudinal = Longitudinal::Brake;
                }
                let state = state(solver, &case, before.as_ref());
                let mut row = vec![
                    shortest(*ax),
                    shortest(*ay),
                    shortest(case.az),
                    shortest(case.speed),
                    shortest(self.rack(&case)),
                ];
                match &state {
                    CarState::Solved { found, .. } => {
                        row.push(lifted(found));
                        before = Some(Equilibrium::clone(found));
                    }
                    CarState::Failed(_) => {
                        row.push(String::new());
                        failures += 1;
                    }
                }
                row.extend(self.values(&state, &case));
                row.extend(Self::end(&state));
                rows.push(row);
            }
        }
        (Some(csv(&header, rows)), failures)
    }

    /// `sensitivities.csv`, if the study asks for it: derivatives of the results by hardpoints and parameters.
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

    fn push_gradient(
        &self,
        gradient: &crate::car::CarGradient,
        push: &mut impl FnMut(&str, &str, &str, f64, &str),
    ) {
        let car = &self.study.car;
        let length = self.unit();
        for (number, end) in ["front", "rear"].into_iter().enumerate() {
            let axle = &car.axles[number].left;
            for (k, by) in gradient.hardpoints[number].iter().enumerate() {
                let name = axle.mechanism.name(PointId(k));
                for axis in Axis::ALL {
                    push(
                        end,
                        name,
                        axis.name(),
                        axle.frame.sign(axis) * by[axis],
                        length,
                    );
                }
            }
            let rate = format!("N_per_{length}");
            let torque = format!("N_{length}_per_rad");
            for (parameter, unit) in [
                (AxleParameter::SpringRate, rate.as_str()),
                (AxleParameter::SpringForce, "N"),
                (AxleParameter::BarRate, torque.as_str()),
                (AxleParameter::TyreRate, rate.as_str()),
                (AxleParameter::Radius, length),
                (AxleParameter::UnsprungMass, "kg"),
            ] {
                let by = gradient.parameters[Parameter::Axle(number, parameter).place()];
                push(end, rate_key(parameter), "", by, unit);
            }
        }
        let frame = self.study.frame();
        let by = |own: BodyParameter| gradient.parameters[Parameter::Body(own).place()];
        push("", "mass", "", by(BodyParameter::Mass), "kg");
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

    /// The cases that were not solved, with reasons.
    pub fn failures(&self) -> Vec<String> {
        let cases = self.study.cases.iter().zip(&self.states);
        cases
            .filter_map(|(case, state)| match state {
                CarState::Failed(why) => {
                    Some(format!("case {}: {}: {why}", case.name, why.status()))
                }
                CarState::Solved { .. } => None,
            })
            .collect()
    }

    /// Whether every case is solved.
    pub fn is_complete(&self) -> bool {
        self.failures().is_empty()
    }

    /// Warnings on solved cases.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for (case, state) in self.study.cases.iter().zip(&self.states) {
            let CarState::Solved { found, solved } = state else {
                continue;
            };
            for place in WheelPlace::ALL {
                if found.lifted[place.0] {
                    warnings.push(format!(
                        "warning: case {}: {} lifts",
                        case.name,
                        place.words()
                    ));
                    continue;
                }
                let demand = CarQuantity::Wheel(place, WheelResult::FrictionDemand);
                let demand = demand.evaluate(solved);
                if demand > 2.0 {
                    warnings.push(format!(
                        "warning: case {}: {} needs a friction coefficient of {demand:.1}; no tyre has it",
                        case.name,
                        place.words()
                    ));
                }
            }
        }
        warnings
    }

    /// Key results of every case for the terminal.
    pub fn summary_table(&self) -> Table {
        let unit = self.unit();
        let heave = format!("heave {unit}");
        let mut table = Table::new([
            "case",
            "ax g",
            "ay g",
            "status",
            "roll deg",
            "pitch deg",
            &heave,
            "load FL N",
            "FR N",
            "RL N",
            "RR N",
            "front share %",
        ]);
        for (case, state) in self.study.cases.iter().zip(&self.states) {
            let mut row: Vec<Cell> = vec![
                case.name.as_str().into(),
                Cell::shown(case.ax, figure(case.ax, "g")),
                Cell::shown(case.ay, figure(case.ay, "g")),
                Self::end(state)[1].as_str().into(),
            ];
            let mut shown = vec![
                (CarQuantity::Whole(WholeResult::Roll), "deg"),
                (CarQuantity::Whole(WholeResult::Pitch), "deg"),
                (CarQuantity::Whole(WholeResult::Heave), unit),
            ];
            shown.extend(WheelPlace::ALL.map(|p| (CarQuantity::Wheel(p, WheelResult::Load), "N")));
            shown.push((CarQuantity::Whole(WholeResult::Distribution), "percent"));
            row.extend(shown.into_iter().map(|(quantity, unit)| {
                let value = match state {
                    CarState::Solved { solved, .. } => quantity.printed(solved, case),
                    CarState::Failed(_) => None,
                };
                Cell::by(value, |value| figure(value, unit))
            }));
            table.push_row(row);
        }
        table
    }

    /// The static position for the terminal.
    pub fn static_table(&self) -> Table {
        let mut table = Table::new(["quantity", "value", "unit"]);
        let (Some(CarState::Solved { solved, .. }), Some(case)) =
            (self.states.first(), self.study.cases.first())
        else {
            return table;
        };
        let mut shown = vec![
            CarQuantity::Whole(WholeResult::Roll),
            CarQuantity::Whole(WholeResult::Pitch),
            CarQuantity::Whole(WholeResult::Heave),
            CarQuantity::Whole(WholeResult::WeightFront),
            CarQuantity::Whole(WholeResult::CrossWeight),
            CarQuantity::Whole(WholeResult::RollGradient),
            CarQuantity::Whole(WholeResult::LocalDistribution),
        ];
        for place in WheelPlace::ALL {
            shown.push(CarQuantity::Wheel(place, WheelResult::Load));
            shown.push(CarQuantity::Wheel(place, WheelResult::Travel));
        }
        for quantity in shown {
            let unit = quantity.info().unit.suffix(self.study.car.length_unit);
            let value = quantity.printed(solved, case);
            let cells: [Cell; 3] = [
                quantity.name().as_str().into(),
                Cell::by(value, |value| figure(value, &unit)),
                unit.as_str().into(),
            ];
            table.push(cells);
        }
        table
    }

    fn target_value(&self, case: usize, quantity: CarQuantity) -> Option<f64> {
        match &self.states[case] {
            CarState::Solved { solved, .. } => quantity.printed(solved, &self.study.cases[case]),
            CarState::Failed(_) => None,
        }
    }

    /// Targets with their values for the terminal.
    pub fn targets_table(&self, wanted: &CarOptimise, before: &CarResults<'_>) -> Table {
        let mut table = Table::new(["target", "case", "wanted", "before", "after", "tolerance"]);
        for target in &wanted.targets {
            let unit = target
                .quantity
                .info()
                .unit
                .suffix(self.study.car.length_unit);
            let cell = |value: Option<f64>| Cell::by(value, |value| figure(value, &unit));
            let cells: [Cell; 6] = [
                target
                    .quantity
                    .column(self.study.car.length_unit)
                    .as_str()
                    .into(),
                self.study.cases[target.case].name.as_str().into(),
                cell(Some(target.value)),
                cell(before.target_value(target.case, target.quantity)),
                cell(self.target_value(target.case, target.quantity)),
                cell(Some(target.tolerance)),
            ];
            table.push(cells);
        }
        table
    }

    /// Targets with their values for programs.
    pub fn targets_json(&self, wanted: &CarOptimise) -> Value {
        let targets = wanted.targets.iter().map(|target| {
            json!({
                "name": target.quantity.column(self.study.car.length_unit),
                "case": self.study.cases[target.case].name,
                "wanted": target.value,
                "tolerance": target.tolerance,
                "value": self.target_value(target.case, target.quantity),
            })
        });
        targets.collect()
    }

    /// Variables for the terminal; offsets of hardpoints, values of the rest.
    pub fn variables_table(&self, before: &CarStudy, x: &[f64]) -> Table {
        let mut table = Table::new(["variable", "lowest", "highest", "before", "after"]);
        for (variable, value) in before.optimise.iter().flat_map(|o| &o.variables).zip(x) {
            let cell = |value: f64| Cell::shown(value, figure(value, ""));
            let cells: [Cell; 5] = [
                variable.moves.label(&before.car).as_str().into(),
                cell(variable.range[0]),
                cell(variable.range[1]),
                cell(variable.moves.value(&before.car).unwrap_or(f64::NAN)),
                cell(*value),
            ];
            table.push(cells);
        }
        table
    }

    /// Variables for programs.
    pub fn variables_json(&self, before: &CarStudy, x: &[f64]) -> Value {
        let variables = before.optimise.iter().flat_map(|o| &o.variables).zip(x);
        variables
            .map(|(variable, value)| {
                json!({
                    "name": variable.moves.label(&before.car),
                    "before": variable.moves.value(&before.car),
                    "after": value,
                    "range": variable.range,
                })
            })
            .collect()
    }
}

fn longitudinal(case: &Case) -> &'static str {
    match case.setting.longitudinal {
        Longitudinal::Brake => "brake",
        Longitudinal::Drive => "drive",
    }
}

/// The text of a car's study that names other files of axles.
pub fn car_with_axles(text: &str, front: &str, rear: &str) -> String {
    edited(
        text,
        &[format!("car.front={front:?}"), format!("car.rear={rear:?}")],
    )
}

/// The studies of a tuned car: of the car, of its front and of its rear axle.
pub fn optimised_car(study: &CarStudy, car: &Car, x: &[f64]) -> [String; 3] {
    let mut of_car = vec![
        "car.front=\"optimised_front.toml\"".to_owned(),
        "car.rear=\"optimised_rear.toml\"".to_owned(),
    ];
    let mut of_axles = [Vec::new(), Vec::new()];
    let variables = study.optimise.iter().flat_map(|wanted| &wanted.variables);
    for (variable, value) in variables.zip(x) {
        match variable.moves {
            Moves::Hardpoint { .. } => {}
            Moves::Rate { axle, parameter } => {
                of_axles[axle].push(format!("{}={}", rate_key(parameter), shortest(*value)));
            }
            Moves::Body(BodyParameter::CgX | BodyParameter::CgY | BodyParameter::CgZ) => {
                let cg = study.frame().vector(car.cg).to_array().map(shortest);
                let key = match car.masses {
                    crate::car::Masses::Whole => "car.cg",
                    crate::car::Masses::Sprung => "car.sprung_cg",
                };
                of_car.push(format!("{key}=[{}]", cg.join(", ")));
            }
            Moves::Body(BodyParameter::Mass) => {
                let key = match car.masses {
                    crate::car::Masses::Whole => "car.mass",
                    crate::car::Masses::Sprung => "car.sprung_mass",
                };
                of_car.push(format!("{key}={}", shortest(*value)));
            }
            Moves::Body(own) => of_car.push(format!("car.{}={}", body_key(own), shortest(*value))),
            Moves::Wheelbase => {
                let offset = study.frame().vector(car.rear_offset);
                of_car.push(wheelbase_edit(&study.text, *value, offset));
            }
        }
    }
    let axle = |number: usize| {
        let moved = study.axles[number].with_design(&car.axles[number].left.design);
        edited(&moved, &of_axles[number])
    };
    [edited(&study.text, &of_car), axle(0), axle(1)]
}

/// The edit that writes a wheelbase where the study gives it: as such, or as the rear study's offset.
fn wheelbase_edit(text: &str, wheelbase: f64, offset: Vector3<f64>) -> String {
    let gives_offset = |line: &str| line.trim_start().starts_with("rear_offset");
    match text.lines().any(gives_offset) {
        true => format!(
            "car.rear_offset=[{}]",
            offset.to_array().map(shortest).join(", ")
        ),
        false => format!("car.wheelbase={}", shortest(wheelbase)),
    }
}

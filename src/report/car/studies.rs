//! Studies of a tuned car.

use crate::car::{BodyParameter, Car, CarVariable, Masses, Moves, body_key, rate_key};
use crate::number::Vector3;
use crate::report::shortest;
use crate::study::{CarStudy, edited};

/// Text of a car's study with other file names for its axles.
pub fn car_with_axles(text: &str, front: &str, rear: &str) -> String {
    edited(
        text,
        &[format!("car.front={front:?}"), format!("car.rear={rear:?}")],
    )
}

/// Edits of three studies: the car, its front axle and its rear axle. They set rates and other values of the car to the values of
/// the variables, but do not move hardpoints.
struct Edits {
    of_car: Vec<String>,
    of_axles: [Vec<String>; 2],
}

impl Edits {
    fn of(study: &CarStudy, car: &Car, variables: &[CarVariable], x: &[f64]) -> Self {
        let mut of_car = Vec::new();
        let mut of_axles = [Vec::new(), Vec::new()];
        let key = |whole: &str| match car.masses {
            Masses::Whole => format!("car.{whole}"),
            Masses::Sprung => format!("car.sprung_{whole}"),
        };
        for (variable, value) in variables.iter().zip(x) {
            match variable.moves {
                Moves::Hardpoints(_) => {}
                Moves::Rate { axle, parameter } => {
                    of_axles[axle].push(format!("{}={}", rate_key(parameter), shortest(*value)));
                }
                Moves::Body(BodyParameter::CgX | BodyParameter::CgY | BodyParameter::CgZ) => {
                    let cg = study.frame().vector(car.cg).to_array().map(shortest);
                    of_car.push(format!("{}=[{}]", key("cg"), cg.join(", ")));
                }
                Moves::Body(BodyParameter::Mass) => {
                    of_car.push(format!("{}={}", key("mass"), shortest(*value)));
                }
                Moves::Body(own) => {
                    of_car.push(format!("car.{}={}", body_key(own), shortest(*value)));
                }
                Moves::Wheelbase => {
                    let offset = study.frame().vector(car.rear_offset);
                    of_car.push(wheelbase_edit(&study.text, *value, offset));
                }
            }
        }
        Edits { of_car, of_axles }
    }
}

/// Texts of a tuned car's studies: the car, its front axle and its rear axle.
pub fn optimised_car(study: &CarStudy, car: &Car, x: &[f64]) -> [String; 3] {
    let variables = study.optimise.iter().flat_map(|wanted| &wanted.variables);
    let variables: Vec<CarVariable> = variables.cloned().collect();
    let edits = Edits::of(study, car, &variables, x);
    let axle = |number: usize| {
        let moved = study.axles[number].with_design(&car.axles[number].left.design);
        edited(&moved, &edits.of_axles[number])
    };
    let text = car_with_axles(&study.text, "optimised_front.toml", "optimised_rear.toml");
    [edited(&text, &edits.of_car), axle(0), axle(1)]
}

/// Values of `--set` that change a study to the car with these values of the variables.
pub fn settings_of_car(
    study: &CarStudy,
    car: &Car,
    variables: &[CarVariable],
    x: &[f64],
) -> Vec<String> {
    let ends = crate::car::AXLE_NAMES;
    let mut points = Vec::new();
    for at in variables
        .iter()
        .flat_map(|variable| variable.moves.points())
    {
        let wheel = &car.axles[at.axle].left;
        let place = wheel.frame.vector(wheel.design[at.point.0]);
        let setting = format!(
            "{}.suspension.hardpoints.{}=[{}]",
            ends[at.axle],
            wheel.mechanism.name(at.point),
            place.to_array().map(shortest).join(", ")
        );
        if !points.contains(&setting) {
            points.push(setting);
        }
    }
    let Edits { of_car, of_axles } = Edits::of(study, car, variables, x);
    let mut settings = of_car;
    for (end, edits) in ends.iter().zip(of_axles) {
        settings.extend(edits.into_iter().map(|edit| format!("{end}.{edit}")));
    }
    settings.extend(points);
    settings.dedup();
    settings
}

/// Edit that writes the wheelbase to the key that the study uses: `wheelbase`, or the offset of the rear study.
fn wheelbase_edit(text: &str, wheelbase: f64, offset: Vector3<f64>) -> String {
    let gives_offset = |line: &str| line.trim_start().starts_with("rear_offset");
    if text.lines().any(gives_offset) {
        format!(
            "car.rear_offset=[{}]",
            offset.to_array().map(shortest).join(", ")
        )
    } else {
        format!("car.wheelbase={}", shortest(wheelbase))
    }
}

//! Studies of a tuned car.

use crate::axle::Law;
use crate::car::{
    AxleParameter, BodyParameter, Car, CarVariable, Masses, Moves, body_key, rate_key,
};
use crate::model::Suspension;
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

/// Edits of the texts of three studies: the car, its front axle and its rear axle. They set rates and other values to the values of
/// the variables, but do not move hardpoints.
struct Edits {
    of_car: Vec<String>,
    of_axles: [Vec<String>; 2],
}

impl Edits {
    /// Edits for the values `x` of the variables. `car` is the car with these values.
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
                    if parameter == AxleParameter::SpringRate {
                        of_axles[axle].extend(right_spring_edit(study, car, axle));
                    }
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
                    of_car.push(wheelbase_edit(study, *value, offset));
                }
            }
        }
        Edits { of_car, of_axles }
    }
}

/// Texts of a tuned car's studies: the car, its front axle and its rear axle. `car` is the tuned car, and `x` has the values of the
/// variables of `[optimise]`.
pub fn optimised_car(study: &CarStudy, car: &Car, x: &[f64]) -> [String; 3] {
    let variables = study.optimise.iter().flat_map(|wanted| &wanted.variables);
    let variables: Vec<CarVariable> = variables.cloned().collect();
    let edits = Edits::of(study, car, &variables, x);
    let axle = |number: usize| {
        let own = &study.axles[number];
        // Points of the right wheel move, too.
        let moved = own.at_design(car.axles[number].left.design.clone());
        edited(&own.with_points_of(&moved), &edits.of_axles[number])
    };
    let text = car_with_axles(&study.text, "optimised_front.toml", "optimised_rear.toml");
    [edited(&text, &edits.of_car), axle(0), axle(1)]
}

/// Values of `--set` that change a study to the car with the values `x` of these variables. `car` is the changed car.
pub fn settings_of_car(
    study: &CarStudy,
    car: &Car,
    variables: &[CarVariable],
    x: &[f64],
) -> Vec<String> {
    let ends = crate::car::AXLE_NAMES;
    let rights = [0, 1].map(|axle| right_table(study, axle));
    let mut points = Vec::new();
    for at in variables
        .iter()
        .flat_map(|variable| variable.moves.points())
    {
        let (end, axle) = (ends[at.axle], &car.axles[at.axle]);
        let of = |section: &str, wheel: &Suspension| {
            let place = wheel.frame.vector(wheel.design[at.point.0]);
            let (name, place) = (wheel.mechanism.name(at.point), place.to_array());
            format!(
                "{end}.{section}.{name}=[{}]",
                place.map(shortest).join(", ")
            )
        };
        let left = of("suspension.hardpoints", &axle.left);
        let name = axle.left.mechanism.name(at.point);
        let right = axle.own_right();
        let right = right.filter(|_| gives(rights[at.axle].as_ref(), "hardpoints", name));
        let right = right.map(|wheel| of("axle.right.hardpoints", wheel));
        for setting in [left].into_iter().chain(right) {
            if !points.contains(&setting) {
                points.push(setting);
            }
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

/// Edit that writes the wheelbase to the key that the study uses: `wheelbase`, or `rear_offset` with the offset of the rear study.
fn wheelbase_edit(study: &CarStudy, wheelbase: f64, offset: Vector3<f64>) -> String {
    if study.wheelbase.is_none() {
        format!(
            "car.rear_offset=[{}]",
            offset.to_array().map(shortest).join(", ")
        )
    } else {
        format!("car.wheelbase={}", shortest(wheelbase))
    }
}

/// Edit of the right spring's rate, if the study of the axle gives it. A variable changes the rates of both springs by the same
/// amount.
fn right_spring_edit(study: &CarStudy, car: &Car, axle: usize) -> Option<String> {
    if !gives(right_table(study, axle).as_ref(), "spring", "rate") {
        return None;
    }
    let [_, right] = car.axles[axle].setup.springs.as_ref()?;
    let Law::Linear { rate, .. } = right.spring else {
        return None;
    };
    let (_, newtons) = AxleParameter::SpringRate.unit(car);
    Some(format!(
        "axle.right.spring.rate={}",
        shortest(rate / newtons)
    ))
}

/// Table `[axle.right]` in the study of an axle. `None` if the study has no such table.
fn right_table(study: &CarStudy, axle: usize) -> Option<toml::Value> {
    let written: toml::Table = study.axles[axle].text.parse().ok()?;
    written.get("axle")?.get("right").cloned()
}

/// True if the table `[axle.right]` gives this key in `[axle.right.SECTION]`.
fn gives(right: Option<&toml::Value>, section: &str, key: &str) -> bool {
    right.is_some_and(|right| right.get(section).is_some_and(|own| own.get(key).is_some()))
}

//! Values of the whole car in the study of an axle that differ from those in the study of the car.

use super::{CarResults, CarState};
use crate::car::{AXLE_NAMES, CarQuantity, GRAVITY, Moves, WheelPlace, WheelResult, WholeResult};
use crate::report::{as_written, to_digits};

/// Relative difference above which a share (such as the brake share) counts as different.
const SHARE: f64 = 1e-3;
/// Relative difference above which a length or a mass counts as different. Studies often give rounded values.
const ROUNDED: f64 = 0.01;

/// A value in the study of an axle, and the same value in the study of the car.
struct Compared {
    /// Key in the study of the axle.
    key: &'static str,
    own: Option<f64>,
    of_car: Option<f64>,
    unit: &'static str,
    /// Relative difference above which the two values count as different.
    noticeable: f64,
}

impl Compared {
    /// The value of the axle's study and the value of the car in words. `None` if they do not differ noticeably.
    fn in_words(&self) -> Option<String> {
        let (own, of_car) = (self.own?, self.of_car?);
        let shown = |value: f64| {
            let text = as_written(to_digits(value, 4));
            if self.unit.is_empty() {
                text
            } else {
                format!("{text} {}", self.unit)
            }
        };
        let differs = (own - of_car).abs() > self.noticeable * of_car.abs();
        differs.then(|| format!("{} {} (car: {})", self.key, shown(own), shown(of_car)))
    }
}

impl CarResults<'_> {
    /// A remark for each axle whose study contradicts the study of the car.
    pub(super) fn differing_values(&self) -> Vec<String> {
        let axles = AXLE_NAMES.iter().enumerate();
        let remark = |(end, name): (usize, &&str)| {
            let compared = self.compared_values(end);
            let words: Vec<String> = compared.iter().filter_map(Compared::in_words).collect();
            (!words.is_empty()).then(|| {
                format!(
                    "note: the {name} study has other values than the car: {}. The car uses its own values",
                    words.join(", ")
                )
            })
        };
        axles.filter_map(remark).collect()
    }

    /// Values of `[vehicle]` of an axle (0 front, 1 rear), and the same values of the car at rest.
    fn compared_values(&self, end: usize) -> [Compared; 5] {
        let car = &self.study.car;
        let vehicle = &self.study.axles[end].wheel().vehicle;
        let setup = &car.axles[end].setup;
        let length = car.length_unit.symbol();
        let at_rest = match self.states.first() {
            Some(CarState::Solved { solved, .. }) => Some(solved),
            _ => None,
        };
        let value = |quantity: CarQuantity| at_rest.map(|solved| quantity.evaluate(solved));
        let load = |side: usize| {
            let place = WheelPlace(2 * end + side);
            value(CarQuantity::Wheel(place, WheelResult::Load))
        };
        let carried = || Some((load(0)? + load(1)?) / GRAVITY - setup.unsprung_mass?);
        let in_unit = |kilograms: f64| kilograms / car.mass_unit.kilograms();
        let share = |key, own, of_car| Compared {
            key,
            own,
            of_car,
            unit: "",
            noticeable: SHARE,
        };
        let rounded = |key, own, of_car, unit| Compared {
            key,
            own,
            of_car,
            unit,
            noticeable: ROUNDED,
        };
        let (brakes, drive) = (car.brake_share_front, car.drive_share_front);
        let height = value(CarQuantity::Whole(WholeResult::CgHeight));
        [
            share("brake_share_front", vehicle.brake_share_front, brakes),
            share("drive_share_front", vehicle.drive_share_front, drive),
            rounded(
                "wheelbase",
                vehicle.wheelbase,
                Moves::Wheelbase.value(car),
                length,
            ),
            rounded("cg_height", vehicle.cg_height, height, length),
            rounded(
                "sprung_mass",
                setup.sprung_mass.map(in_unit),
                carried().map(in_unit),
                car.mass_unit.symbol(),
            ),
        ]
    }
}

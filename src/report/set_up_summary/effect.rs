//! Effect of a step of a set-up: numbers, and words for a mechanic.

use crate::ask::Unit;
use crate::assembly::{SetUp, Static};
use crate::model::LengthUnit;
use crate::report::{brief, has_digits, to_digits, with_decimals, with_plus};

/// Change of each static value in the step with index `place`, with the rounded amounts, in printed units. All changes are 0 if no
/// set-up was found.
pub(super) fn effect_of_step(found: &SetUp, place: usize) -> Vec<Option<f64>> {
    let Some(after) = found.rounded_steps.get(place) else {
        return vec![Some(0.0); found.statics.len()];
    };
    let before = match place.checked_sub(1) {
        Some(previous) => &found.rounded_steps[previous],
        None => &found.drawn,
    };
    let values = after.values.iter().zip(&before.values);
    values
        .map(|(after, before)| super::finite(after - before))
        .collect()
}

/// Smallest change of a length that a mechanic can measure, in mm.
const VISIBLE_LENGTH: f64 = 0.05;

/// Changes of static values in words, with the decimals that a mechanic can measure. Unknown and invisible changes are left out.
pub(super) fn effect_in_words(
    statics: &[Static],
    effect: &[Option<f64>],
    length: LengthUnit,
) -> String {
    let change = |(value, change): (&Static, &Option<f64>)| {
        let change = (*change)?;
        let unit = value.unit();
        let text = match unit {
            Unit::Angle => with_decimals(change, 2),
            Unit::Length if is_invisible(change, length) => return None,
            Unit::Length => with_decimals(change, length_decimals(length)),
            _ if change.abs() < 1e-9 => return None,
            // A rate has three significant digits.
            _ => brief(to_digits(change, 3)),
        };
        let is_visible = has_digits(&text);
        let name = super::static_name(*value);
        let text = with_plus(change, text);
        let unit = unit.suffix(length).replace("_per_", "/").replace('_', " ");
        is_visible.then(|| {
            format!("{} {text} {unit}", name.replace('_', " "))
                .trim_end()
                .to_owned()
        })
    };
    let changes: Vec<String> = statics.iter().zip(effect).filter_map(change).collect();
    if changes.is_empty() {
        "no visible change".to_owned()
    } else {
        changes.join(", ")
    }
}

/// Returns true if a change of a length is below [`VISIBLE_LENGTH`].
fn is_invisible(change: f64, length: LengthUnit) -> bool {
    LengthUnit::Millimetre.convert(change.abs(), length) < VISIBLE_LENGTH
}

/// Number of decimals that shows a length to a tenth of a millimetre or finer.
fn length_decimals(length: LengthUnit) -> usize {
    match length {
        LengthUnit::Millimetre => 1,
        LengthUnit::Metre => 4,
        LengthUnit::Inch | LengthUnit::InchPound => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::effect_in_words;
    use crate::assembly::Static;
    use crate::characteristics::Characteristic;
    use crate::model::LengthUnit;

    /// A mechanic reads signs, units and as many decimals as a gauge shows.
    #[test]
    fn effects_are_words_for_a_mechanic() {
        let statics = [
            Static::Characteristic(Characteristic::Camber),
            Static::Characteristic(Characteristic::Toe),
            Static::Characteristic(Characteristic::BumpSteer),
            Static::RideHeightChange,
        ];
        let words = |effect: [f64; 4], unit| effect_in_words(&statics, &effect.map(Some), unit);
        let mm = LengthUnit::Millimetre;
        assert_eq!(
            words([-0.4171, 0.0334, 0.000_123_4, 1.26], mm),
            "camber -0.42 deg, toe +0.03 deg, bump steer +0.000123 deg/mm, ride height change +1.3 mm"
        );
        assert_eq!(
            words([0.004, -0.0051, 1e-12, 0.05], LengthUnit::Inch),
            "toe -0.01 deg, ride height change +0.050 in"
        );
        assert_eq!(words([0.0; 4], mm), "no visible change");
        // The smallest visible change of a length is 0.05 mm in every unit.
        for (unit, per_mm) in [
            (mm, 1.0),
            (LengthUnit::Metre, 1e-3),
            (LengthUnit::Inch, 1.0 / 25.4),
        ] {
            let height = |mm: f64| words([0.0, 0.0, 0.0, mm * per_mm], unit);
            assert_eq!(height(0.049), "no visible change");
            assert_eq!(height(-0.049), "no visible change");
            assert!(height(-0.051).starts_with("ride height change -0."));
        }
        let unknown = effect_in_words(&statics, &[None, Some(0.5), None, None], mm);
        assert_eq!(unknown, "toe +0.50 deg");
    }
}

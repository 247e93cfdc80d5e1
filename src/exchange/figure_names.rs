//! Names of values that a file gives in addition to hardpoints: static angles, radius, tracks and offsets.

use super::angle_remark::without_remarks;
use super::angle_unit::AngleUnit;
use super::names::{Words, cut, end_of, marks_of};
use super::table::Marks;
use super::unit::FileUnit;
use crate::model::AxlePosition;

/// Values that a file may give in addition to hardpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FigureKind {
    /// Camber in the design position.
    StaticCamber,
    /// Toe in the design position.
    StaticToe,
    /// Loaded radius of the wheel.
    WheelRadius,
    /// Diameter of the unloaded tyre.
    TyreDiameter,
    /// Width of the tyre.
    TyreWidth,
    /// Diameter of the rim.
    RimDiameter,
    /// Height of the centre of gravity above the ground.
    CgHeight,
    /// Distance of the wheel from the centre plane.
    HalfTrack,
    /// Distance between the wheels of the axle.
    Track,
    /// Distance between the axles.
    Wheelbase,
    /// Contact point. Its distance from the wheel centre is the loaded radius.
    ContactPoint,
    /// Offset of the contact point: 0 forward, 1 outboard, 2 up.
    Offset(usize),
}

impl FigureKind {
    /// True for angles, false for lengths.
    pub(super) fn is_angle(self) -> bool {
        matches!(self, FigureKind::StaticCamber | FigureKind::StaticToe)
    }
}

/// Kinds of values with the words of their names. Words after `?` are optional. The table of abbreviations replaces "track" by
/// "tie", so `half tie` is the half track.
const FIGURES: &[(FigureKind, &str)] = &[
    (FigureKind::StaticCamber, "camber ?static ?angle ?wheel"),
    (FigureKind::StaticToe, "toe ?static ?angle ?wheel"),
    (
        FigureKind::WheelRadius,
        "wheel radius ?loaded ?tyre | tyre radius ?loaded | loaded radius",
    ),
    (FigureKind::TyreDiameter, "tyre diameter"),
    (FigureKind::TyreWidth, "tyre width"),
    (FigureKind::RimDiameter, "rim diameter ?wheel"),
    (FigureKind::CgHeight, "gravity height ?centre"),
    (FigureKind::HalfTrack, "half tie"),
    (
        FigureKind::ContactPoint,
        "contact ?patch ?tyre ?wheel ?centre",
    ),
    (FigureKind::Offset(0), "longitudinal offset"),
    (FigureKind::Offset(1), "lateral offset"),
    (FigureKind::Offset(2), "vertical offset"),
];

/// Finds a value by its name: its kind, its wheel and axle, and the unit of length at the end of the name. `None` for an unknown
/// name.
pub(super) fn figure(name: &str) -> Option<(FigureKind, Marks, Option<FileUnit>)> {
    let mut cut = cut(name);
    without_remarks(&mut cut);
    let mut unit = None;
    // The end of "toe in" is not a unit, but the ends of "toe [in]" and "wheel_radius_in" are.
    let is_toe = cut.iter().any(|word| word == "toe");
    // "camber min" may be the smallest camber, but "camber [min]" is in minutes.
    let in_brackets = |word: &str| {
        let mut brackets = [("[", "]"), ("(", ")")].into_iter();
        brackets.any(|(open, close)| name.contains(&format!("{open}{word}{close}")))
    };
    let is_angle_unit = |word: &str| match AngleUnit::named(word) {
        Some(AngleUnit::Other) => !["min", "sec"].contains(&word) || in_brackets(word),
        found => found.is_some(),
    };
    let mut marks = Marks::default();
    let mut has_mark = false;
    while let Some(last) = cut.last() {
        let found =
            FileUnit::named(last).filter(|_| !(is_toe && last == "in" && !in_brackets("in")));
        let word = marks_of(last);
        if found.is_some() || is_angle_unit(last) {
            unit = unit.or(found);
        } else if !word.is_empty() && cut.len() > 1 && !has_mark {
            marks = marks.or(word);
            has_mark = true;
        } else {
            break;
        }
        cut.pop();
    }
    let first = cut.first().map(|word| marks_of(word)).unwrap_or_default();
    if !first.is_empty() && cut.len() > 1 {
        marks = first.or(marks);
        cut.remove(0);
    }
    let (axle, plain) = without_axle_word(&cut);
    let of_car = match plain.join(" ").as_str() {
        "track" | "track width" => Some(FigureKind::Track),
        "wheelbase" | "wheel base" => Some(FigureKind::Wheelbase),
        _ => None,
    };
    if let Some(kind) = of_car {
        marks.axle = marks.axle.or(axle);
        return Some((kind, marks, unit));
    }
    let words = Words::spelt(&cut);
    let kind_of = |words: &Words| {
        let found = FIGURES.iter().find(|(_, patterns)| words.fit(patterns));
        found.map(|(kind, _)| *kind)
    };
    if let Some(kind) = kind_of(&words) {
        return Some((kind, marks, unit));
    }
    let (axle, rest) = words.without_axle()?;
    marks.axle = marks.axle.or(Some(axle));
    kind_of(&rest).map(|kind| (kind, marks, unit))
}

/// Splits off "front" or "rear" if it is the first or the last word.
fn without_axle_word(words: &[String]) -> (Option<AxlePosition>, &[String]) {
    match words {
        [first, rest @ ..] if end_of(first).is_some() => (end_of(first), rest),
        [rest @ .., last] if end_of(last).is_some() => (end_of(last), rest),
        _ => (None, words),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_told_from_words() {
        for (name, kind) in [
            ("Tyre contact patch", FigureKind::ContactPoint),
            ("CP_LH", FigureKind::ContactPoint),
            ("TCP FL", FigureKind::ContactPoint),
            ("static_camber [deg]", FigureKind::StaticCamber),
            ("wheel_radius_in", FigureKind::WheelRadius),
            ("Loaded radius", FigureKind::WheelRadius),
            ("wheel tire loaded_radius", FigureKind::WheelRadius),
            ("Half Track", FigureKind::HalfTrack),
            ("track width", FigureKind::Track),
            ("toe out", FigureKind::StaticToe),
            ("static toe out per side", FigureKind::StaticToe),
            ("Toe-in", FigureKind::StaticToe),
            ("Tire Diameter", FigureKind::TyreDiameter),
            ("static_camber_rad", FigureKind::StaticCamber),
            ("camber rad left", FigureKind::StaticCamber),
            ("FL camber [radians]", FigureKind::StaticCamber),
            ("toe [min]", FigureKind::StaticToe),
            ("Static toe (toe out positive)", FigureKind::StaticToe),
            ("Static toe (deg, toe out positive)", FigureKind::StaticToe),
            ("Static toe (toe-in positive)", FigureKind::StaticToe),
            ("toe (toe out negative)", FigureKind::StaticToe),
            ("Static toe (per side, toe in)", FigureKind::StaticToe),
            ("Toe per side", FigureKind::StaticToe),
            ("Total toe", FigureKind::StaticToe),
            ("Static camber (top in positive)", FigureKind::StaticCamber),
            ("Tyre width", FigureKind::TyreWidth),
            ("tyre_width", FigureKind::TyreWidth),
            ("Rim diameter [in]", FigureKind::RimDiameter),
            ("CG height", FigureKind::CgHeight),
            ("Height of centre of gravity (mm)", FigureKind::CgHeight),
        ] {
            let found = figure(name).map(|(kind, ..)| kind);
            assert_eq!(found, Some(kind), "{name}");
        }
        assert_eq!(figure("camber min"), None);
        assert_eq!(figure("Static toe (per side, at full bump)"), None);
        let (_, _, unit) = figure("wheel_radius_in").unwrap();
        assert_eq!(unit, FileUnit::named("in"));
    }
}

//! Columns of results in another unit and in other axes.
//!
//! The name of a column ends with its unit (`bump_steer_deg_per_mm`). The part before the unit shows whether the axes of the
//! study determine the sign:
//!
//! | name | value |
//! |---|---|
//! | `POINT_x`, `POINT_vx`, `POINT_ax`, `LOAD_JOINT_x`, `LOAD_beam_force_x` | component along x |
//! | `knuckle_omega_x`, `knuckle_alpha_x`, `LOAD_beam_moment_x` | component about x |
//! | `rack`, `rack_force`, `LOAD_rack_force` | component along y |
//! | `*_by_rack` | derivative with respect to a displacement along y |
//!
//! The name of a test result may also contain a length: the trail of the test (`toe_by_lateral_force_trail_30_deg_per_kN`).
//!
//! All other columns have signs that refer to the car and do not change ([`Characteristic::info`]). This includes
//! `LOAD_POINT_force_x` and `LOAD_POINT_torque_x` of bushings, whose axes belong to the bushing.
//!
//! [`Characteristic::info`]: crate::characteristics::Characteristic::info

use super::figure::to_digits;
use crate::model::{Axis, Frame, FrameConvention, LengthUnit, Side};

/// Conversion of columns from the unit and axes of a study to another unit and other axes.
#[derive(Clone, Copy, Debug)]
pub struct ColumnConversion {
    /// Length unit of the study.
    pub from: LengthUnit,
    /// Requested length unit.
    pub to: LengthUnit,
    /// Axes of the study, and requested axes.
    pub axes: [FrameConvention; 2],
}

/// A column after the conversion.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvertedColumn {
    /// Name with the new unit. A trail (distance of the side force behind the contact point) in the name has the new unit, too.
    pub name: String,
    powers: Powers,
    units: [LengthUnit; 2],
    sign: f64,
}

/// Powers of length, force and torque in the unit of a column, such as -1 for a length below the fraction line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Powers {
    length: i32,
    force: i32,
    torque: i32,
}

impl ColumnConversion {
    /// Finds the conversion of the column with this name.
    pub fn column(&self, name: &str) -> ConvertedColumn {
        let (stem, _) = split_unit(name);
        let (renamed, powers) = in_unit(name, self.from, self.to);
        ConvertedColumn {
            name: with_trail_in(&renamed, self.from, self.to),
            powers,
            units: [self.from, self.to],
            sign: ColumnAxes::of(stem).sign(self.axes),
        }
    }
}

impl ConvertedColumn {
    /// Name of the same result in a list of columns. It may differ from this column's name in the last digits of the trail (a
    /// length in the name). Without the same result in the list, the function returns this column's name.
    pub(super) fn name_in(&self, columns: &[String]) -> String {
        let mut columns = columns.iter();
        let same = columns.find(|column| is_same_result(column, &self.name));
        same.unwrap_or(&self.name).clone()
    }

    /// Converts a value of the column to the new unit and axes.
    pub fn value(&self, value: f64) -> f64 {
        let [from, to] = self.units;
        let length = match self.powers.length {
            0 => value,
            1 => to.convert(value, from),
            -1 => from.convert(value, to),
            power => value * to.convert(1.0, from).powi(power),
        };
        let Powers { force, torque, .. } = self.powers;
        let newtons = from.newtons() / to.newtons();
        let levers = [from, to].map(|unit| unit.lever().0 / unit.per_metre());
        let newton_metres = newtons * levers[0] / levers[1];
        // Adding 0 turns -0 into 0.
        self.sign * length * newtons.powi(force) * newton_metres.powi(torque) + 0.0
    }
}

/// Motions by which columns are differentiated, as in `*_by_rack`.
const MOTIONS: [&str; 4] = ["rack", "roll", "heave", "travel"];

/// Relation of a column's values to the axes of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ColumnAxes {
    component: Component,
    /// True for a first derivative with respect to the displacement of the rack.
    is_by_rack: bool,
}

/// Component of a vector that a column shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    /// The column shows no component along an axis, so the axes do not determine its sign.
    None,
    /// Component along an axis.
    Along(Axis),
    /// Component of a rotation or a moment about an axis.
    About(Axis),
}

impl ColumnAxes {
    /// Finds how the axes of the study determine the values of a column. `stem` is the name of the column without its
    /// unit.
    pub(super) fn of(stem: &str) -> Self {
        let is_motion = |by: &str| MOTIONS.iter().any(|motion| by.starts_with(motion));
        let (stem, by) = match stem.rsplit_once("_by_") {
            Some((stem, by)) if is_motion(by) => (stem, by),
            _ => (stem, ""),
        };
        let mut orders = ["_d1", "_d2"].iter();
        let value = orders.find_map(|order| stem.strip_suffix(order));
        ColumnAxes {
            component: Component::of(value.unwrap_or(stem)),
            // A second derivative with respect to the rack keeps its sign.
            is_by_rack: by.starts_with("rack") && !by.ends_with("_d2"),
        }
    }

    /// True if the axes of the study determine the sign of the values.
    pub(super) fn matter(self) -> bool {
        self.is_by_rack || self.component != Component::None
    }

    /// Sign factor that converts values of the column from the first axes to the second axes.
    pub(super) fn sign(self, axes: [FrameConvention; 2]) -> f64 {
        // The old and the new frame belong to the same wheel, so the side of the wheel has no effect.
        let [from, to] = axes.map(|convention| Frame::new(convention, Side::Left));
        let along = |axis: Axis| from.sign(axis) * to.sign(axis);
        let by_rack = if self.is_by_rack { along(Axis::Y) } else { 1.0 };
        by_rack
            * match self.component {
                Component::None => 1.0,
                Component::Along(axis) => along(axis),
                Component::About(axis) => from.turn_sign(axis) * to.turn_sign(axis),
            }
    }
}

impl Component {
    fn of(stem: &str) -> Self {
        // The name of a test result may have a suffix: `rack_force_secant`.
        if stem == "rack" || stem.starts_with("rack_force") || stem.ends_with("_rack_force") {
            return Component::Along(Axis::Y);
        }
        let mut axes = Axis::ALL.into_iter();
        let Some(axis) = axes.find(|axis| stem.ends_with(axis.name())) else {
            return Component::None;
        };
        let rest = &stem[..stem.len() - 1];
        let ends_with = |ends: &[&str]| ends.iter().any(|end| rest.ends_with(end));
        if ends_with(&["knuckle_omega_", "knuckle_alpha_", "beam_moment_"]) {
            Component::About(axis)
        } else if ends_with(&["_force_", "_torque_"]) && !rest.ends_with("_beam_force_") {
            // The forces of a bushing are along the axes of the bushing, so the axes of the study do not matter.
            Component::None
        } else if ends_with(&["_", "_v", "_a"]) {
            Component::Along(axis)
        } else {
            Component::None
        }
    }
}

/// Words in the names of units that are not units of length.
const UNIT_WORDS: [&str; 13] = [
    "deg", "percent", "N", "kN", "lbf", "ft", "per", "rad", "s", "Hz", "g", "kg", "lb",
];

/// Parts of the names of test results whose unit is N/mm in every study.
const STIFFNESSES: [&str; 4] = [
    "compliant_wheel_rate",
    "compliant_ride_rate",
    "lateral_stiffness_",
    "longitudinal_stiffness_",
];

/// True for a column whose unit is the same in every study.
fn has_fixed_unit(stem: &str, unit: &str) -> bool {
    let is_stiffness = || STIFFNESSES.iter().any(|part| stem.contains(part));
    unit == "deg_per_100_N_m" || (unit == "N_per_mm" && is_stiffness())
}

/// Splits the name of a column into the part before its unit, and the unit. The unit of a dimensionless number is empty.
pub fn split_unit(name: &str) -> (&str, &str) {
    let start = unit_start(name);
    (&name[..start], name[start..].trim_start_matches('_'))
}

/// Position in a column name at which the unit starts, including the separator before it.
fn unit_start(name: &str) -> usize {
    let is_unit = |before: &str, word: &str, after: &str| {
        // `deg_per_100_N_m` is the only unit with a number. Any other 100 is the trail of a test.
        if word == "100" {
            return before.ends_with("_per") && after.starts_with("_N_m");
        }
        let word = word.trim_end_matches(|c: char| c.is_ascii_digit());
        UNIT_WORDS.contains(&word) || LengthUnit::ALL.iter().any(|unit| unit.symbol() == word)
    };
    let mut start = name.len();
    while let Some(at) = name[..start].rfind('_') {
        if !is_unit(&name[..at], &name[at + 1..start], &name[start..]) {
            break;
        }
        start = at;
    }
    start
}

/// Name of a column in another unit, and the powers in its unit. The length unit in a torque depends only on the unit of force:
/// newton metres stay in metres for every unit of length. A unit that is the same in every study does not change.
fn in_unit(name: &str, from: LengthUnit, to: LengthUnit) -> (String, Powers) {
    let (stem, unit) = split_unit(name);
    if has_fixed_unit(stem, unit) {
        return (name.to_owned(), Powers::default());
    }
    let (mut renamed, mut powers) = (stem.to_owned(), Powers::default());
    let (mut sign, mut before) = (1, "");
    let forces = [from, to].map(LengthUnit::force_symbol);
    let levers = [from, to].map(|unit| unit.lever().1);
    let mut words = unit.split('_').filter(|word| !word.is_empty()).peekable();
    while let Some(word) = words.next() {
        let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
        let digits = &word[letters.len()..];
        let power = sign * digits.parse().unwrap_or(1);
        let new = if word == forces[0] {
            match words.peek() {
                Some(next) if *next == levers[0] => powers.torque += power,
                _ => powers.force += power,
            }
            forces[1]
        } else if before == forces[0] && word == levers[0] {
            levers[1]
        } else if letters == from.symbol() {
            powers.length += power;
            to.symbol()
        } else {
            letters
        };
        renamed += &format!("_{new}{digits}");
        if word == "per" {
            sign = -1;
        }
        before = word;
    }
    (renamed, powers)
}

/// Word before the trail (distance of the side force behind the contact point) in the name of a test result.
const TRAIL: &str = "_trail_";
/// Number of significant digits of a trail in the name of a test result.
const TRAIL_DIGITS: usize = 6;
/// Largest relative difference of two trails of the same test. The conversion and both names round the trail to six digits.
const TRAIL_ROUNDING: f64 = 2e-5;

/// Splits the name of a test result into the part before the trail, the trail, and the part after it. `None` for other names.
fn split_trail(name: &str) -> Option<(&str, f64, &str)> {
    let (stem, rest) = name.split_once(TRAIL)?;
    let end = rest.find('_').unwrap_or(rest.len());
    Some((stem, rest[..end].parse().ok()?, &rest[end..]))
}

/// Name with the trail in another unit.
fn with_trail_in(name: &str, from: LengthUnit, to: LengthUnit) -> String {
    split_trail(name).map_or_else(
        || name.to_owned(),
        |(stem, trail, tail)| {
            let trail = to_digits(to.convert(trail, from), TRAIL_DIGITS);
            format!("{stem}{TRAIL}{trail}{tail}")
        },
    )
}

/// True for equal names, and for names that differ only in rounding errors of the trail.
fn is_same_result(one: &str, other: &str) -> bool {
    one == other
        || split_trail(one)
            .zip(split_trail(other))
            .is_some_and(|(one, other)| {
                let is_near = (one.1 - other.1).abs() <= TRAIL_ROUNDING * one.1.abs();
                is_near && (one.0, one.2) == (other.0, other.2)
            })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::characteristics::Characteristic;

    fn converted(name: &str, from: LengthUnit, to: LengthUnit) -> (String, f64) {
        let axes = [FrameConvention::Iso8855; 2];
        let column = ColumnConversion { from, to, axes }.column(name);
        let value = column.value(1.0);
        (column.name, value)
    }

    fn signs(stem: &str) -> [f64; 2] {
        use FrameConvention::{Iso8855, SaeJ670, XRear};
        let axes = ColumnAxes::of(stem);
        [SaeJ670, XRear].map(|other| axes.sign([Iso8855, other]))
    }

    #[test]
    fn units_are_read_from_names() {
        for (name, stem, unit) in [
            ("camber_deg", "camber", "deg"),
            ("motion_ratio", "motion_ratio", ""),
            ("camber_d1_deg_per_mm", "camber_d1", "deg_per_mm"),
            ("braking_tie_rod_N", "braking_tie_rod", "N"),
            ("wheel_centre_vx_mm_per_s", "wheel_centre_vx", "mm_per_s"),
            (
                "toe_by_aligning_moment_deg_per_100_N_m",
                "toe_by_aligning_moment",
                "deg_per_100_N_m",
            ),
            (
                "a_by_lateral_force_trail_100_N_m",
                "a_by_lateral_force_trail_100",
                "N_m",
            ),
            (
                "front_spring_rate_lbf_per_in",
                "front_spring_rate",
                "lbf_per_in",
            ),
            (
                "rear_bar_rate_N_mm_per_rad",
                "rear_bar_rate",
                "N_mm_per_rad",
            ),
            ("front_spring_force_lbf", "front_spring_force", "lbf"),
            ("mass_lb", "mass", "lb"),
            ("brake_share_front", "brake_share_front", ""),
        ] {
            assert_eq!(split_unit(name), (stem, unit));
        }
    }

    /// Inch 25.4 mm, pound-force 4.4482216152605 N, foot 0.3048 m.
    #[test]
    fn every_part_of_a_unit_is_converted() {
        use LengthUnit::{Inch, InchPound, Metre, Millimetre};
        let pound = 4.448_221_615_260_5;
        for (name, from, to, renamed, factor) in [
            ("track_mm", Millimetre, Inch, "track_in", 1.0 / 25.4),
            (
                "a_d2_deg_per_mm2",
                Millimetre,
                Inch,
                "a_d2_deg_per_in2",
                25.4 * 25.4,
            ),
            ("bar_N_m", Millimetre, Metre, "bar_N_m", 1.0),
            ("bar_N_m", Metre, Millimetre, "bar_N_m", 1.0),
            ("load_N", Millimetre, InchPound, "load_lbf", 1.0 / pound),
            ("load_N", Millimetre, Inch, "load_N", 1.0),
            ("bar_lbf_ft", InchPound, Metre, "bar_N_m", pound * 0.3048),
            (
                "rate_lbf_per_in",
                InchPound,
                Millimetre,
                "rate_N_per_mm",
                pound / 25.4,
            ),
            ("a_mm_per_kN", Millimetre, Inch, "a_in_per_kN", 1.0 / 25.4),
            (
                "left_wheel_rate_N_per_mm",
                Millimetre,
                Inch,
                "left_wheel_rate_N_per_in",
                25.4,
            ),
            // A study in inches has this column, too.
            (
                "left_compliant_wheel_rate_N_per_mm",
                Millimetre,
                Inch,
                "left_compliant_wheel_rate_N_per_mm",
                1.0,
            ),
            (
                "a_deg_per_100_N_m",
                Metre,
                Millimetre,
                "a_deg_per_100_N_m",
                1.0,
            ),
        ] {
            let (found, value) = converted(name, from, to);
            assert_eq!(found, renamed);
            assert!(
                (value - factor).abs() <= 4e-16 * factor,
                "{name}: {value} {factor}"
            );
        }
    }

    /// A study in inches has the trail of its test in inches. The unit of the stiffness is the same in every study.
    #[test]
    fn trails_in_names_are_converted() {
        use LengthUnit::{Inch, Millimetre};
        let name = "lateral_stiffness_by_lateral_force_trail_30_N_per_mm";
        let of_inches = "lateral_stiffness_by_lateral_force_trail_1.1811_N_per_mm";
        assert_eq!(
            converted(name, Millimetre, Inch),
            (of_inches.to_owned(), 1.0)
        );
        let (converted, _) = converted("toe_trail_-30_secant_deg_per_kN", Millimetre, Inch);
        assert_eq!(converted, "toe_trail_-1.1811_secant_deg_per_kN");
        // 1.1811 in are 29.99994 mm.
        let axes = [FrameConvention::Iso8855; 2];
        let (from, to) = (Inch, Millimetre);
        let column = ColumnConversion { from, to, axes }.column(of_inches);
        let others = [
            "mechanical_trail_mm",
            "lateral_stiffness_by_lateral_force_trail_29_N_per_mm",
            name,
        ];
        assert_eq!(column.name_in(&others.map(str::to_owned)), name);
        assert_eq!(column.name_in(&[others[0].to_owned()]), column.name);
    }

    /// SAE J670 reverses y and z. The axes with x rearward reverse x and y. Both sets of axes differ from ISO 8855 by half a
    /// turn. So the components of rotations change their signs like the components of vectors.
    #[test]
    fn components_follow_their_axes() {
        for stem in [
            "wheel_centre_x",
            "left_wheel_centre_vx",
            "wheel_centre_ax",
            "left_wheel_centre_x_by_roll",
            "left_wheel_centre_x_by_rack_d2",
            "braking_lower_ball_joint_x",
            "kick_by_curb_lower_ball_joint_x",
            "left_braking_beam_force_x",
            "left_braking_beam_moment_x",
            "knuckle_omega_x",
            "left_knuckle_alpha_x_by_heave",
        ] {
            assert_eq!(signs(stem), [1.0, -1.0], "{stem}");
        }
        for stem in [
            "wheel_centre_y",
            "rack",
            "rack_d1",
            "rack_by_roll",
            "rack_force",
            "cornering_rack_force",
            "camber_by_rack",
            "left_steer_by_rack_left_loaded",
            "caster_by_rack",
        ] {
            assert_eq!(signs(stem), [-1.0, -1.0], "{stem}");
        }
        assert_eq!(signs("wheel_centre_z"), [-1.0, 1.0]);
        assert_eq!(signs("left_wheel_centre_x_by_rack"), [-1.0, 1.0]);
        assert_eq!(signs("left_wheel_centre_y_by_rack"), [1.0, 1.0]);
    }

    #[test]
    fn other_columns_keep_their_signs() {
        let names = Characteristic::ALL.iter().map(|c| c.info().name);
        let others = [
            "camber_by_rack_d2",
            "toe_by_lateral_force",
            "braking_tie_rod",
            "braking_lower_arm_front_force_x",
            "braking_lower_arm_front_torque_z",
            "steering_wheel_angle",
            "ax",
            "ay",
        ];
        for name in names.chain(others) {
            assert!(!ColumnAxes::of(name).matter(), "{name}");
        }
    }
}

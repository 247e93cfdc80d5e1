//! `[motion]`: the stations at which the mechanism is solved.

use super::error::Problems;
use super::file;
use super::names::choose_or;
use super::value::{Number, Values, Whole};
use super::{Drive, MOST_STATIONS, Motion, TimeLaw};
use crate::ask::degrees;
use crate::mechanism::raises_its_joint;
use crate::model::{self, LengthUnit, Suspension};
use crate::number::Each;
use crate::sorting::sort_by;
use std::ops::{Range as Span, RangeInclusive};
use toml::Spanned;

impl Drive {
    const ALL: [(&str, Drive); 3] = [
        ("travel", Drive::Travel),
        ("arm_angle", Drive::ArmAngle),
        ("paper_theta", Drive::PaperTheta),
    ];

    /// Name of the drive in studies.
    pub fn name(self) -> &'static str {
        Drive::ALL[self as usize].0
    }

    /// Key of the drive's values in `[motion]`. With the unit appended, it is the name of the column in results.
    pub fn key(self) -> &'static str {
        match self {
            Drive::PaperTheta => "theta",
            _ => self.name(),
        }
    }

    /// Returns true if the drive's values are angles.
    pub fn is_angle(self) -> bool {
        self != Drive::Travel
    }

    /// Unit of the drive's values in results. A study may write angles in radians (`angle_unit`).
    pub fn unit(self, length: LengthUnit) -> &'static str {
        if self.is_angle() {
            "deg"
        } else {
            length.symbol()
        }
    }

    /// Name of the drive's column, with the unit.
    pub fn column(self, length: LengthUnit) -> String {
        format!("{}_{}", self.key(), self.unit(length))
    }

    /// Converts this drive of a study to the drive of the solver.
    pub fn in_kernel(self) -> model::Drive {
        match self {
            Drive::Travel => model::Drive::Travel,
            Drive::ArmAngle | Drive::PaperTheta => model::Drive::ArmAngle,
        }
    }

    /// Converts a value of the drive to the unit of results: an arm angle from radians to degrees. A travel stays in the length
    /// unit.
    pub fn printed(self, value: f64) -> f64 {
        if self.is_angle() {
            degrees(value)
        } else {
            value
        }
    }
}

impl Motion {
    /// Rack displacement of the design position. It is zero if the study moves the rack, else the study's single
    /// displacement.
    pub fn design_rack(&self) -> f64 {
        if self.rack_moves { 0.0 } else { self.rack[0] }
    }

    /// Motion that consists only of the design position.
    pub(crate) fn still() -> Self {
        Motion {
            drive: Drive::Travel,
            values: vec![0.0],
            rack: vec![0.0],
            rack_moves: false,
            time: None,
        }
    }
}

/// Reads the motion. `None` if it has an error. `named_motions::check` refuses the time law of a named motion.
pub(super) fn motion(
    section: &Spanned<file::Motion>,
    is_named: bool,
    problems: &mut Problems,
) -> Option<Motion> {
    let place = section.span();
    let section = section.get_ref();
    let drive = choose_or(
        &section.drive,
        Drive::Travel,
        "drive",
        &Drive::ALL,
        problems,
    );
    let rack = match &section.rack {
        None => Some(vec![0.0]),
        Some(rack) => values(rack, problems),
    };
    let (drive_values, time) = drive_values(drive?, section, place.clone(), is_named, problems)?;
    let rack = rack?;
    let stations = drive_values.len().saturating_mul(rack.len());
    if stations > MOST_STATIONS {
        let message = format!(
            "the motion has {stations} stations (drive values times rack displacements); \
                     expected at most {MOST_STATIONS}"
        );
        return problems.refuse(place, message);
    }
    let written_rack = section.rack.as_ref().map(Spanned::get_ref);
    let is_list = written_rack.is_some_and(|rack| !matches!(rack, Values::One(_)));
    Some(Motion {
        drive: drive?,
        values: drive_values,
        // In a named motion, a list with one displacement counts as a single displacement. Targets and constraints apply at
        // this displacement.
        rack_moves: is_list && !(is_named && rack.len() == 1),
        rack,
        time,
    })
}

/// Drive values in length units or radians, and their time law if there is one.
fn drive_values(
    drive: Drive,
    section: &file::Motion,
    place: Span<usize>,
    is_named: bool,
    problems: &mut Problems,
) -> Option<(Vec<f64>, Option<TimeLaw>)> {
    let values_of = |drive: Drive| match drive {
        Drive::Travel => &section.travel,
        Drive::ArmAngle => &section.arm_angle,
        Drive::PaperTheta => &section.theta,
    };
    let others = Drive::ALL.each(|(_, other)| other).into_iter();
    for other in others.filter(|other| *other != drive) {
        if let Some(values) = values_of(other) {
            let (key, name) = (other.key(), drive.name());
            let message = format!("{key} is given, but the drive is \"{name}\"");
            let error = problems.add(values.span(), message);
            error.help(format!("use it with drive = \"{}\"", other.name()));
            return None;
        }
    }
    let (name, given) = (drive.key(), values_of(drive));
    let units = [("deg", true), ("rad", false)];
    let degrees = choose_or(&section.angle_unit, true, "angle unit", &units, problems)?;
    let resolved = |written: f64| match drive {
        Drive::ArmAngle | Drive::PaperTheta if degrees => written.to_radians(),
        _ => written,
    };
    match (given, &section.time) {
        (Some(given), None) => {
            let written = values(given, problems)?;
            Some((written.into_iter().map(resolved).collect(), None))
        }
        (None, Some(time)) => {
            let time = time.get_ref();
            let law = time_law(time, resolved, problems)?;
            let at_times: Vec<f64> = law.times.iter().map(|t| law.value(*t)).collect();
            if at_times.iter().any(|v| v.abs() > Number::MOST) {
                let message = "the polynomial grows beyond 1e12 between these times";
                return problems.refuse(time.polynomial.span(), message);
            }
            Some((at_times, Some(law)))
        }
        (Some(given), Some(time)) => {
            let message = format!(
                "the key \"time\" already gives the drive values; expected either {name} or \"time\""
            );
            let error = problems.add(given.span(), message);
            error.related(time.span(), "given here");
            None
        }
        (None, None) => {
            let or_time = if is_named { "" } else { " or time" };
            let message = format!("expected {name}{or_time}: the values to solve");
            problems.refuse(place, message)
        }
    }
}

/// Checks that the topology has the parts that the motion needs.
pub(super) fn check_drive(
    section: &Spanned<file::Motion>,
    motion: &Motion,
    suspension: &Suspension,
    problems: &mut Problems,
) {
    if !motion.drive.is_angle() {
        return;
    }
    let mechanism = &suspension.mechanism;
    let written = section.get_ref().drive.as_ref();
    let place = written.map_or(section.span(), Spanned::span);
    let Some(arm) = mechanism.arms.first() else {
        let message = format!(
            "{} has no arm whose angle could drive the motion; expected drive = \"travel\"",
            mechanism.topology.name
        );
        problems.add(place, message);
        return;
    };
    if motion.drive == Drive::ArmAngle && !raises_its_joint(*arm, &suspension.design) {
        let outer = &mechanism.points[arm.outer.0].name;
        let message = format!(
            "the arm is at dead centre in the design position: a small turn moves {outer} \
             horizontally, so neither direction of the turn raises it"
        );
        problems.add(place, message).help("use drive = \"travel\"");
    }
}

impl TimeLaw {
    /// Value of the drive at a time.
    pub fn value(&self, time: f64) -> f64 {
        self.polynomial
            .iter()
            .rev()
            .fold(0.0, |sum, c| sum * time + c)
    }
}

pub(super) fn time_law(
    time: &file::Time,
    resolved: impl Fn(f64) -> f64,
    problems: &mut Problems,
) -> Option<TimeLaw> {
    let polynomial = time.polynomial.get_ref();
    if polynomial.is_empty() {
        let message = "expected coefficients, lowest power first, found an empty list";
        return problems.refuse(time.polynomial.span(), message);
    }
    Some(TimeLaw {
        polynomial: polynomial.iter().map(|c| resolved(c.value)).collect(),
        times: range(&time.from, &time.to, &time.steps, MOST_STATIONS, problems)?,
    })
}

/// Reads values in their written unit. Equal values are allowed.
pub(super) fn list(written: &Spanned<Values>, problems: &mut Problems) -> Option<Vec<f64>> {
    match written.get_ref() {
        Values::One(value) => Some(vec![*value]),
        Values::Range(r) => range(&r.from, &r.to, &r.steps, MOST_STATIONS, problems),
        Values::List(list) if list.is_empty() => problems.refuse(
            written.span(),
            "expected at least one value, found an empty list",
        ),
        Values::List(list) => Some(list.iter().map(|number| number.value).collect()),
    }
}

/// Reads values in their written unit. Equal values are refused.
pub(super) fn values(written: &Spanned<Values>, problems: &mut Problems) -> Option<Vec<f64>> {
    match written.get_ref() {
        Values::One(_) | Values::Range(_) => list(written, problems),
        Values::List(numbers) => {
            let mut sorted: Vec<&Number> = numbers.iter().collect();
            sort_by(&mut sorted, |a, b| a.value.total_cmp(&b.value));
            if let Some(pair) = sorted
                .windows(2)
                .find(|pair| pair[0].value == pair[1].value)
            {
                let message = format!("{} is listed twice", pair[1].value);
                let error = problems.add(pair[1].span.clone(), message);
                error.related(pair[0].span.clone(), "first here");
                return None;
            }
            list(written, problems)
        }
    }
}

/// Refuses sensitivities that do not fit in memory. A station counts once for each requested hardpoint.
pub(super) fn check_sensitivities(
    place: Span<usize>,
    stations: usize,
    hardpoints: usize,
    problems: &mut Problems,
) {
    let asked = stations.saturating_mul(hardpoints);
    if asked > MOST_STATIONS {
        let message = format!(
            "{stations} stations times {hardpoints} hardpoints for sensitivities make {asked}; \
             expected at most {MOST_STATIONS}"
        );
        let error = problems.add(place, message);
        error.help("request fewer stations, or name fewer hardpoints in outputs.sensitivities");
    }
}

/// Reads a range with up to `most` evenly spaced values.
pub(super) fn range(
    from: &Number,
    to: &Number,
    steps: &Whole,
    most: usize,
    problems: &mut Problems,
) -> Option<Vec<f64>> {
    let count = within(steps, 1..=most as i64, problems)?;
    if from.value > to.value {
        let message = format!(
            "the range is reversed: from = {} is above to = {}",
            from.value, to.value
        );
        let help = format!("from = {}, to = {}", to.value, from.value);
        problems.add(from.span.clone(), message).help(help);
        return None;
    }
    if from.value == to.value && count != 1 {
        let message = format!("the range is empty: from and to are both {}", from.value);
        let error = problems.add(to.span.clone(), message);
        error.help("steps = 1 solves this one value");
        return None;
    }
    if from.value < to.value && count == 1 {
        let message = format!("one step cannot reach from {} to {}", from.value, to.value);
        let error = problems.add(steps.span(), message);
        error.help("steps is the number of values, both ends included");
        return None;
    }
    Some(evenly_spaced(from.value, to.value, count as usize))
}

/// Reads a whole number within bounds.
pub(super) fn within(
    number: &Whole,
    bounds: RangeInclusive<i64>,
    problems: &mut Problems,
) -> Option<i64> {
    let found = *number.get_ref();
    if bounds.contains(&found) {
        return Some(found);
    }
    let (least, most) = (bounds.start(), bounds.end());
    let message = match *most {
        i64::MAX => format!("expected at least {least}, found {found}"),
        _ => format!("expected from {least} to {most}, found {found}"),
    };
    problems.refuse(number.span(), message)
}

/// Makes `count` evenly spaced values from `from` to `to`. Both ends are exact, and symmetric ends give symmetric values. If
/// the ends are short decimals, each value is the number nearest to its exact decimal. An example is 0.1 in the range from 0
/// to 0.6.
fn evenly_spaced(from: f64, to: f64, count: usize) -> Vec<f64> {
    let decimals = Decimals::of(from, to);
    let value = |i: usize| {
        let between = decimals.and_then(|ends| ends.between(i as i64, count as i64 - 1));
        between.unwrap_or_else(|| evenly_spaced_at(from, to, count as u64, i as u64))
    };
    (0..count).map(value).collect()
}

/// Two decimal numbers as whole numbers of a common unit.
#[derive(Clone, Copy)]
struct Decimals {
    from: i64,
    to: i64,
    /// Number of common units in 1. It is a power of ten.
    per_one: i64,
}

impl Decimals {
    /// Shortest decimals that represent these numbers. `None` if they have too many digits.
    fn of(from: f64, to: f64) -> Option<Self> {
        let [(from, places), (to, other)] = [shortest_decimal(from)?, shortest_decimal(to)?];
        let common = places.max(other);
        let raised = |digits: i64, places: u32| {
            let power = 10_i64.checked_pow(common - places)?;
            digits.checked_mul(power)
        };
        Some(Decimals {
            from: raised(from, places)?,
            to: raised(to, other)?,
            per_one: 10_i64.checked_pow(common)?,
        })
    }

    /// Number nearest to `from + (to - from) i/last`. `None` if its numerator or denominator is not exact as a float.
    fn between(self, i: i64, last: i64) -> Option<f64> {
        const EXACT: i64 = 1 << f64::MANTISSA_DIGITS;
        let is_exact = |whole: i64| whole.abs() <= EXACT;
        let low = self.from.checked_mul(last - i)?;
        let above = low.checked_add(self.to.checked_mul(i)?)?;
        let below = self.per_one.checked_mul(last).filter(|below| *below > 0)?;
        // With exact operands, the quotient is correctly rounded.
        (is_exact(above) && is_exact(below)).then(|| above as f64 / below as f64)
    }
}

/// Digits of the shortest decimal that represents the number, and the count of its digits after the decimal point.
fn shortest_decimal(value: f64) -> Option<(i64, u32)> {
    let text = format!("{value}");
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    let digits = format!("{whole}{fraction}").parse().ok()?;
    Some((digits, fraction.len() as u32))
}

/// Value number `i` of `count` values from `from` to `to`. Both ends are exact. The values between are correctly rounded if
/// products and sum are exact. If the ends are symmetric, the values are symmetric, too, with an exact zero.
pub(super) fn evenly_spaced_at(from: f64, to: f64, count: u64, i: u64) -> f64 {
    let last = count - 1;
    match i {
        0 => from,
        _ if i == last => to,
        _ => (from * (last - i) as f64 + to * i as f64) / last as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each value equals the number that results from reading its decimal text.
    #[test]
    fn values_between_decimals_are_nearest_to_decimals() {
        let read = |text: &str| text.parse::<f64>().unwrap();
        for tenths in 1..100_i32 {
            let values = evenly_spaced(0.0, read(&format!("{tenths}e-1")), tenths as usize + 1);
            for (k, value) in values.iter().enumerate() {
                assert_eq!(*value, read(&format!("{k}e-1")), "{k} of {tenths}");
            }
        }
        assert_eq!(
            evenly_spaced(-0.8, 0.8, 6),
            [-0.8, -0.48, -0.16, 0.16, 0.48, 0.8]
        );
        assert_eq!(evenly_spaced(1e-3, 4e-3, 4), [1e-3, 2e-3, 3e-3, 4e-3]);
    }

    #[test]
    fn ranges_hit_their_ends_and_are_symmetric() {
        for (end, count) in [
            (80.0, 41),
            (0.1, 7),
            (1.0 / 3.0, 1001),
            (std::f64::consts::PI, 33),
        ] {
            let values = evenly_spaced(-end, end, count);
            assert_eq!(values.len(), count);
            assert_eq!((values[0], values[count - 1]), (-end, end));
            assert_eq!(values[count / 2].to_bits(), 0.0f64.to_bits());
            for (low, high) in values.iter().zip(values.iter().rev()) {
                assert_eq!(*low, -high);
            }
            assert!(values.windows(2).all(|pair| pair[0] < pair[1]));
        }
        assert_eq!(evenly_spaced(-80.0, 80.0, 41)[3], -68.0);
        assert_eq!(evenly_spaced(0.0, 1.0, 11)[3], 0.3);
        assert_eq!(evenly_spaced(5.0, 5.0, 1), [5.0]);
    }
}

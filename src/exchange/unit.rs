//! Finds the unit of a file's coordinates: the stated unit, or else the unit with which the points have the size of a
//! car's suspension.
//!
//! Studies have mm, m and inches. Coordinates in other units are converted: centimetres and decimetres to mm, feet to inches.

use super::ImportOptions;
use super::corner::Picked;
use super::figure_names::figure;
use super::notes::Notes;
use super::refusal::{Question, Refusal};
use super::table::PointTable;
use crate::model::LengthUnit;
use crate::report::unit_in_words;

/// Unit of length in a file: a unit of studies, or a multiple of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FileUnit {
    /// Unit of studies to which the file's lengths are converted.
    pub(super) unit: LengthUnit,
    /// Number of units of studies in one unit of the file.
    pub(super) factor: f64,
    /// Symbol of the unit in the file.
    pub(super) symbol: &'static str,
}

impl From<LengthUnit> for FileUnit {
    fn from(unit: LengthUnit) -> Self {
        FileUnit::of(unit)
    }
}

/// Units of length that a file may state: unit of studies, factor, symbol, and the words that name the unit.
const FILE_UNITS: [(LengthUnit, f64, &str, &str); 6] = [
    (
        LengthUnit::Millimetre,
        1.0,
        "mm",
        "mm mms millimetre millimetres millimeter millimeters",
    ),
    (LengthUnit::Metre, 1.0, "m", "m metre metres meter meters"),
    (LengthUnit::Inch, 1.0, "in", "in inch inches"),
    (
        LengthUnit::Millimetre,
        10.0,
        "cm",
        "cm cms centimetre centimetres centimeter centimeters",
    ),
    (
        LengthUnit::Millimetre,
        100.0,
        "dm",
        "dm decimetre decimetres decimeter decimeters",
    ),
    (LengthUnit::Inch, 12.0, "ft", "ft foot feet"),
];

/// Units of length that a file may state, for messages.
pub(super) const KNOWN_UNITS: &str = "mm, cm, m, in or ft";

impl FileUnit {
    /// A unit of studies.
    pub(super) fn of(unit: LengthUnit) -> Self {
        FileUnit {
            unit,
            factor: 1.0,
            symbol: unit.symbol(),
        }
    }

    /// Unit of length that a word names.
    pub fn named(word: &str) -> Option<Self> {
        let word = word.to_lowercase();
        let found = FILE_UNITS
            .iter()
            .find(|(_, _, _, words)| words.split(' ').any(|known| known == word));
        found.map(|(unit, factor, symbol, _)| FileUnit {
            unit: *unit,
            factor: *factor,
            symbol,
        })
    }

    /// A length of the file in the unit of studies. The product is rounded to 15 digits, so that 26.53 cm is 265.3 mm.
    pub(super) fn to_study(self, length: f64) -> f64 {
        if self.factor == 1.0 {
            return length;
        }
        let product = length * self.factor;
        format!("{product:.14e}").parse().unwrap_or(product)
    }
}

/// Unit of length of studies that a word names.
pub fn unit_of(word: &str) -> Option<LengthUnit> {
    let found = FileUnit::named(word).filter(|found| found.factor == 1.0);
    found.map(|found| found.unit)
}

/// Copy of a table whose coordinates and lengths are in a unit of studies. `None` if the file already has such a unit.
///
/// # Errors
/// `--unit` contradicts the unit that the format prescribes. Rates, masses and offsets of such a file depend on its unit.
pub(super) fn converted<'o>(
    table: &PointTable,
    options: &ImportOptions<'o>,
) -> Result<Option<(PointTable, ImportOptions<'o>)>, String> {
    if let (Some(given), Some(fixed)) = (options.unit, table.unit)
        && table.has_fixed_unit
        && given != fixed
    {
        return Err(format!(
            "--unit {}: files of this format are always in {}; leave out --unit (`hardpoint convert` changes the unit of the study)",
            given.symbol, fixed.symbol
        ));
    }
    let given = options.unit.or(table.unit);
    let Some(stated) = given.filter(|unit| unit.factor != 1.0) else {
        return Ok(None);
    };
    let mut converted = table.clone();
    for point in &mut converted.points {
        if let Ok(position) = &mut point.position {
            *position = position.map(|number| stated.to_study(number));
        }
    }
    for row in &mut converted.figures {
        if figure(&row.read_as).is_some_and(|(kind, _, own)| !kind.is_angle() && own.is_none()) {
            row.value = stated.to_study(row.value);
        }
    }
    converted.unit = Some(FileUnit::of(stated.unit));
    converted
        .notes
        .extend(replaced(options.unit, table.unit, stated.symbol));
    let whose = match options.unit {
        Some(_) => "--unit gives",
        None => "the file states",
    };
    converted.notes.push(format!(
        "unit: {whose} {}; all lengths are converted to {}",
        stated.symbol,
        stated.unit.symbol()
    ));
    let options = ImportOptions {
        unit: options.unit.map(|_| FileUnit::of(stated.unit)),
        half_track: options.half_track.map(|length| stated.to_study(length)),
        radius: options.radius.map(|length| stated.to_study(length)),
        ..*options
    };
    Ok(Some((converted, options)))
}

/// Note that `--unit` replaces another unit that the file states. `symbol` is the symbol of the given unit. `None` if the units are
/// equal or one is missing.
fn replaced(given: Option<FileUnit>, written: Option<FileUnit>, symbol: &str) -> Option<String> {
    let differs = given.is_some() && written.is_some() && given != written;
    differs.then(|| format!("--unit {symbol} replaces the unit stated in the file"))
}

/// Smallest and largest plausible size of a wheel's suspension, in metres. If the file states no unit, the importer looks for a
/// unit that gives a size in this range.
const USUAL_SIZE: [f64; 2] = [0.15, 3.0];

/// Smallest size of a suspension (in metres, if its coordinates are in centimetres) for which the importer asks whether the unit
/// is inches or centimetres. The sample suspensions have sizes of 0.45 to 1.3 m. The limit is two thirds of the smallest sample.
const LEAST_IN_CENTIMETRES: f64 = 0.3;

/// Finds the unit of the coordinates: the stated unit, or else a unit with which the suspension has a usual size.
pub(super) fn unit(
    table: &PointTable,
    options: &ImportOptions<'_>,
    picked: &[Picked],
    notes: &mut Notes,
) -> Result<LengthUnit, Refusal> {
    // If the file has no wheel centre, any joint at the wheel is sufficient.
    let at_wheel = ["wheel_centre", "lower_ball_joint", "lower_front_link_outer"];
    let centre = at_wheel
        .iter()
        .find_map(|name| picked.iter().find(|p| p.hardpoint.name == *name));
    let (centre, from) = match centre {
        Some(p) => (p.hardpoint.position, "the wheel"),
        None => ([0.0; 3], "the origin"),
    };
    let distance = |p: &Picked| {
        let squares = p
            .hardpoint
            .position
            .iter()
            .zip(centre)
            .map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    };
    let size = picked.iter().map(distance).fold(0.0, f64::max);
    let [least, most] = USUAL_SIZE;
    let fits = |unit: &LengthUnit| (least..=most).contains(&(size / unit.per_metre()));
    let fitting = LengthUnit::ALL.into_iter().find(fits);
    if let (None, None, Some(unknown)) = (options.unit, table.unit, &table.unknown_unit) {
        return Err(Refusal::Wrong(format!(
            "{unknown}: expected {KNOWN_UNITS}; correct the file or state the unit with --unit"
        )));
    }
    if let Some(given) = options.unit {
        notes.extend(replaced(options.unit, table.unit, given.symbol));
    }
    let stated = options.unit.or(table.unit).map(|stated| stated.unit);
    match (stated, fitting) {
        (Some(unit), _) if fits(&unit) => Ok(unit),
        (Some(unit), fitting) => {
            let better = fitting.map_or(String::new(), |unit| {
                format!("; in {} they would be", unit_in_words(unit.symbol()))
            });
            notes.doubt(format!(
                "please check: the points are up to {size:.4} {} from {from}, which is not the size of \
                 a car's suspension{better}",
                unit.symbol()
            ));
            Ok(unit)
        }
        (None, Some(unit)) if unit == LengthUnit::Inch && size / 100.0 >= LEAST_IN_CENTIMETRES => {
            Err(Question::of(
                format!(
                    "the file states no unit, and the points are up to {size:.4} from {from}: this may be inches ({:.2} m) or \
                     centimetres ({:.2} m)",
                    size / unit.per_metre(),
                    size / 100.0
                ),
                "--unit",
                &["in", "cm"],
            ))
        }
        (None, Some(unit)) => {
            notes.push(format!(
                "unit: {} (assumed: the file states none). The points are then up to {:.2} m from {from}, the size of a \
                 car's suspension. --unit changes this",
                unit_in_words(unit.symbol()),
                size / unit.per_metre()
            ));
            Ok(unit)
        }
        (None, None) => Err(Refusal::Wrong(format!(
            "the points are up to {size:.4} from {from}: no car's suspension has this size in mm, m or in. State the \
             unit with --unit"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_in_centimetres_keep_their_digits() {
        let centimetre = FileUnit::named("cm").unwrap();
        for hundredths in 1..10_000_i32 {
            let written = format!("{}.{:02}", hundredths / 100, hundredths % 100);
            let wanted = format!("{}.{}", hundredths / 10, hundredths % 10);
            let found = centimetre.to_study(written.parse().unwrap());
            assert_eq!(found, wanted.parse::<f64>().unwrap(), "{written} cm");
        }
        assert_eq!(unit_of("cm"), None);
        assert_eq!(unit_of("inch"), Some(LengthUnit::Inch));
    }
}

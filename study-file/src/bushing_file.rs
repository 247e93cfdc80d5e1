//! Bushing property files (`.bus`): six curves of force against deflection and torque against angle, in blocks of text.
//!
//! ```text
//! [UNITS]
//! LENGTH = 'mm'
//! ANGLE = 'degrees'
//! FORCE = 'newton'
//! [FX_CURVE]
//! { x  fx }
//! -1.0  -1500.0
//!  1.0   1500.0
//! ```
//!
//! [`read`] skips damping and the header, because they do not affect equilibria.

use crate::error::{Source, StudyError, StudyErrors};
use std::ops::Range;
use std::sync::Arc;

/// Names of the blocks with curves: along x, y and z, then about them.
const CURVES: [&str; 6] = [
    "FX_CURVE", "FY_CURVE", "FZ_CURVE", "TX_CURVE", "TY_CURVE", "TZ_CURVE",
];

/// A point of a curve, with its position in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePoint {
    /// Deflection in metres, or angle in radians.
    pub deflection: f64,
    /// Force in newtons, or torque in newton metres.
    pub force: f64,
    /// Byte range of the line with this point.
    pub place: Range<usize>,
}

/// Curves of a file, in metres, radians, newtons and newton metres.
#[derive(Clone, Debug, PartialEq)]
pub struct BushingFile {
    /// Points of each curve: along x, y and z, then about them.
    pub curves: [Vec<CurvePoint>; 6],
}

/// Units of a file, as multiples of metre, radian and newton.
struct Units {
    length: f64,
    angle: f64,
    force: f64,
}

fn length(word: &str) -> Option<f64> {
    Some(match word {
        "mm" | "millimeter" | "millimeters" | "millimetre" => 1e-3,
        "cm" | "centimeter" | "centimeters" | "centimetre" => 1e-2,
        "m" | "meter" | "meters" | "metre" => 1.0,
        "in" | "inch" | "inches" => 0.0254,
        "ft" | "foot" | "feet" => 0.3048,
        _ => return None,
    })
}

fn angle(word: &str) -> Option<f64> {
    match word {
        "deg" | "degree" | "degrees" => Some(1.0_f64.to_radians()),
        "rad" | "radian" | "radians" => Some(1.0),
        _ => None,
    }
}

fn force(word: &str) -> Option<f64> {
    Some(match word {
        "n" | "newton" | "newtons" => 1.0,
        "kn" | "knewton" | "kilonewton" => 1e3,
        "kgf" | "kg_force" | "kilogram_force" => 9.80665,
        "lbf" | "pound_force" => 4.4482216152605,
        _ => return None,
    })
}

/// Lines of a file without comments (after `$` or `!`), each with the byte range of the whole line.
fn lines(text: &str) -> impl Iterator<Item = (&str, Range<usize>)> {
    let mut start = 0;
    text.split_inclusive('\n').map(move |whole| {
        let place = start..start + whole.trim_end().len();
        start += whole.len();
        let line = whole.split(['$', '!']).next().unwrap_or_default();
        (line.trim(), place)
    })
}

/// Reads a bushing property file. Each of the six curves needs at least two points. Their order is not checked.
///
/// # Errors
/// Returns an error for an unknown or missing unit, and for a missing or repeated block. Also returns an error for a line of a
/// curve that is not two finite numbers.
pub fn read(source: &Arc<Source>) -> Result<BushingFile, StudyErrors> {
    let wrong = |place: Range<usize>, message: String| {
        Err(StudyError::new(source.clone(), Some(place), message).into())
    };
    let units = units(source)?;
    let mut curves: [Vec<CurvePoint>; 6] = Default::default();
    let mut seen = [false; 6];
    let mut block = None;
    for (line, place) in lines(&source.text) {
        if let Some(name) = block_name(line) {
            block = CURVES.iter().position(|curve| *curve == name);
            if let Some(k) = block {
                if seen[k] {
                    return wrong(place, format!("the file has a second block [{name}]"));
                }
                seen[k] = true;
            }
            continue;
        }
        let Some(k) = block.filter(|_| !line.is_empty() && !line.starts_with('{')) else {
            continue;
        };
        let numbers: Option<Vec<f64>> = line
            .split_whitespace()
            .map(|word| word.parse().ok().filter(|n: &f64| n.is_finite()))
            .collect();
        let Some([deflection, force]) = numbers.as_deref() else {
            let message = format!("expected two numbers in [{}], found {line:?}", CURVES[k]);
            return wrong(place, message);
        };
        let (of_deflection, of_force) = match k {
            0..3 => (units.length, units.force),
            _ => (units.angle, units.force * units.length),
        };
        curves[k].push(CurvePoint {
            deflection: deflection * of_deflection,
            force: force * of_force,
            place,
        });
    }
    let end = source.text.len()..source.text.len();
    for ((name, curve), is_given) in CURVES.iter().zip(&curves).zip(seen) {
        if !is_given {
            let message = format!(
                "the file has no block [{name}]: expected {}",
                CURVES.join(", ")
            );
            return Err(StudyError::new(source.clone(), None, message).into());
        }
        if curve.len() < 2 {
            let message = format!(
                "expected two points or more in the block [{name}], found {}",
                curve.len()
            );
            return wrong(end, message);
        }
    }
    Ok(BushingFile { curves })
}

/// Name of a block, in capitals. `None` if the line does not begin a block.
fn block_name(line: &str) -> Option<String> {
    let name = line.strip_prefix('[')?.strip_suffix(']')?;
    Some(name.trim().to_ascii_uppercase())
}

/// Units in the block `[UNITS]`.
fn units(source: &Arc<Source>) -> Result<Units, StudyErrors> {
    let mut found: [Option<f64>; 3] = [None; 3];
    let keys = ["LENGTH", "ANGLE", "FORCE"];
    let mut is_units = false;
    for (line, place) in lines(&source.text) {
        if let Some(name) = block_name(line) {
            is_units = name == "UNITS";
            continue;
        }
        let Some((key, word)) = line.split_once('=').filter(|_| is_units) else {
            continue;
        };
        let key = key.trim().to_ascii_uppercase();
        let Some(k) = keys.iter().position(|known| *known == key) else {
            continue;
        };
        let word = word
            .trim()
            .trim_matches(['\'', '"'])
            .trim()
            .to_ascii_lowercase();
        found[k] = match k {
            0 => length(&word),
            1 => angle(&word),
            _ => force(&word),
        };
        if found[k].is_none() {
            let message = format!("{word:?} is not a known unit of {}", key.to_lowercase());
            return Err(StudyError::new(source.clone(), Some(place), message).into());
        }
    }
    let missing = keys.iter().zip(&found).find(|(_, unit)| unit.is_none());
    if let Some((key, _)) = missing {
        let message = format!("expected {key} in the block [UNITS]");
        return Err(StudyError::new(source.clone(), Some(0..0), message).into());
    }
    let [length, angle, force] = found.map(|unit| unit.unwrap_or(1.0));
    Ok(Units {
        length,
        angle,
        force,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(units: [&str; 3], tx: &str) -> String {
        let [length, angle, force] = units;
        let mut text = format!(
            "$--- a comment\n[MDI_HEADER]\nFILE_TYPE = 'bus'\n[UNITS]\n LENGTH = '{length}'\n ANGLE = '{angle}'\n FORCE = '{force}'\n MASS = 'kg'\n[DAMPING]\n FX_DAMPING = 0.5\n"
        );
        for name in ["FX", "FY", "FZ", "TY", "TZ"] {
            text += &format!("[{name}_CURVE]\n{{ x f }}\n-1.0 -2.0 $ low\n\n1.0 2.0\n");
        }
        text + &format!("[TX_CURVE]\n{tx}\n")
    }

    fn of(text: String) -> Result<BushingFile, StudyErrors> {
        read(&Arc::new(Source {
            name: "rear.bus".to_owned(),
            text,
        }))
    }

    #[test]
    fn units_become_metres_radians_newtons() {
        let found = of(text(["mm", "degrees", "newton"], "-10 -500\n10 500")).unwrap();
        let fx = &found.curves[0];
        assert_eq!((fx[1].deflection, fx[1].force), (1e-3, 2.0));
        let tx = &found.curves[3];
        assert_eq!(
            (tx[1].deflection, tx[1].force),
            (10.0_f64.to_radians(), 0.5)
        );
        let found = of(text(["inch", "radians", "pound_force"], "-1 -1\n1 1")).unwrap();
        assert_eq!(found.curves[2][0].deflection, -0.0254);
        assert!((found.curves[3][1].force - 4.4482216152605 * 0.0254).abs() < 1e-15);
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        for (text, line, phrase) in [
            (
                text(["furlong", "degrees", "newton"], "0 0\n1 1"),
                5,
                "not a known unit of length",
            ),
            (
                text(["mm", "degrees", "newton"], "0 zero\n1 1"),
                37,
                "two numbers in [TX_CURVE]",
            ),
            (
                text(["mm", "degrees", "newton"], "0 0"),
                38,
                "two points or more",
            ),
            ("[FX_CURVE]\n0 0\n1 1\n".to_owned(), 1, "expected LENGTH"),
        ] {
            let error = of(text).unwrap_err();
            let message = error.to_string();
            assert!(message.contains(phrase), "{message}");
            assert_eq!(error.all()[0].position().unwrap().0, line, "{message}");
        }
    }
}

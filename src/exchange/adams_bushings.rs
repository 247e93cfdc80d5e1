//! Bushings of an Adams/Car subsystem: blocks `[BUSHING_ASSEMBLY]`, each with a property file (`.bus`).
//!
//! ```text
//! [BUSHING_ASSEMBLY]
//!  USAGE          =  'lca_front'
//!  SYMMETRY       =  'left/right'
//!  PROPERTY_FILE  =  'mdids://database/bushings.tbl/soft.bus'
//! ```
//!
//! A property file has its own units. It has a curve of force against deflection for each axis, `[FX_CURVE]` to `[FZ_CURVE]`, and
//! of torque against angle, `[TX_CURVE]` to `[TZ_CURVE]`. The database of a path (`mdids://database/`, `<database>/`) is the
//! folder above the folder of the subsystem.
//!
//! The subsystem's template contains the orientation of a bushing; these files do not. In a study, x of a bushing is along the
//! pivot axis of the arm. The importer assumes that z of the bushing in Adams is along this axis, as is usual. It accepts only
//! bushings for which the remaining orientation does not matter. For such a bushing, the curves along and about x equal the
//! curves along and about y. All its curves are odd functions (equal in both directions).

use super::adams::text_of;
use super::adams_blocks::{assignment, block};
use super::source::bytes_of;
use crate::model::LengthUnit;
use crate::study::bushing_file::{self, CurvePoint};
use crate::study::{FileText, StudyErrors};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Points of a curve: deflection and force, or angle and torque. The units are the same as in [`Laws`].
type Points = Vec<[f64; 2]>;

/// Law of a bushing along or about one axis, in the units of [`Laws`].
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Law {
    /// Constant rate.
    Rate(f64),
    /// Curve through points.
    Curve(Points),
}

/// Laws of a bushing in the axes of a study. The laws for z equal the laws for y.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Laws {
    /// Unit of length of the deflections and torques.
    pub unit: LengthUnit,
    /// Laws along x and along y: force in N by deflection in `unit`.
    pub along: [Law; 2],
    /// Laws about x and about y: torque in N `unit` by angle in rad.
    pub about: [Law; 2],
}

impl Laws {
    /// The same laws in another unit of length. Laws in the same unit do not change at all.
    pub(super) fn in_unit(&self, unit: LengthUnit) -> Laws {
        let length = |length: f64| unit.convert(length, self.unit);
        let along = |law: &Law| match law {
            Law::Rate(rate) => Law::Rate(rate / length(1.0)),
            Law::Curve(points) => {
                Law::Curve(points.iter().map(|[x, f]| [length(*x), *f]).collect())
            }
        };
        let about = |law: &Law| match law {
            Law::Rate(rate) => Law::Rate(length(*rate)),
            Law::Curve(points) => {
                Law::Curve(points.iter().map(|[x, f]| [*x, length(*f)]).collect())
            }
        };
        Laws {
            unit,
            along: self.along.each_ref().map(along),
            about: self.about.each_ref().map(about),
        }
    }
}

/// A bushing of a subsystem.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AdamsBushing {
    /// Name of the bushing.
    pub usage: String,
    /// Number of the line in the subsystem file at which the bushing's block begins.
    pub line: usize,
    /// True if the bushing is on the right wheel only.
    pub is_right: bool,
    /// Laws of the bushing, or the reason why a study cannot use them.
    pub laws: Result<Laws, String>,
}

/// Names of the curve blocks in a property file, without `_CURVE`: forces along x, y and z, then torques about them.
const AXES: [&str; 6] = ["FX", "FY", "FZ", "TX", "TY", "TZ"];

/// Largest difference between equal deflections or equal forces of two curves, relative to the largest value of the curve.
const SAME: f64 = 1e-6;

/// Line number of one block `[BUSHING_ASSEMBLY]`, and its keys with their values.
#[derive(Default)]
struct Block {
    line: usize,
    entries: Vec<(String, String)>,
}

impl Block {
    fn get(&self, key: &str) -> Option<&str> {
        let found = self.entries.iter().find(|(known, _)| known == key);
        found.map(|(_, value)| value.as_str())
    }
}

/// Reads the bushings of a subsystem. `path` is the subsystem's path, and `unit` the unit of length of the laws.
pub(super) fn of_subsystem(path: &Path, text: &str, unit: LengthUnit) -> Vec<AdamsBushing> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut is_within = false;
    for (line, number) in text.lines().zip(1..) {
        if let Some(name) = block(line) {
            is_within = name == "BUSHING_ASSEMBLY";
            if is_within {
                blocks.push(Block {
                    line: number,
                    entries: Vec::new(),
                });
            }
        } else if is_within
            && let (Some(entry), Some(block)) = (assignment(line), blocks.last_mut())
        {
            block.entries.push(entry);
        }
    }
    let bushing = |block: Block| AdamsBushing {
        usage: block.get("USAGE").unwrap_or("").to_owned(),
        line: block.line,
        is_right: block
            .get("SYMMETRY")
            .is_some_and(|side| side.eq_ignore_ascii_case("right")),
        laws: laws(path, &block, unit),
    };
    blocks.into_iter().map(bushing).collect()
}

fn laws(path: &Path, block: &Block, unit: LengthUnit) -> Result<Laws, String> {
    let named = block.get("PROPERTY_FILE").unwrap_or("");
    let found = property_file(path, named)?;
    let source = FileText {
        name: found.display().to_string(),
        text: text_of(&bytes_of(&found)?),
    };
    // A preload that is not a number is refused in the same way as a preload other than 0.
    let preload = block.entries.iter().find(|(key, value)| {
        let is_preload = key.starts_with("T_PRELOAD") || key.starts_with("R_PRELOAD");
        is_preload && value.parse::<f64>() != Ok(0.0)
    });
    if let Some((key, value)) = preload {
        return Err(format!(
            "{key} is {value}, but the subsystem does not state the axes of the bushing, in which a preload acts"
        ));
    }
    let mut curves = curves_of(source, unit)?;
    for (axis, curve) in AXES.iter().zip(&mut curves) {
        let factor = match block.get(&format!("{axis}_SCALING_FACTOR")) {
            Some(text) => {
                let factor = text
                    .parse::<f64>()
                    .ok()
                    .filter(|f| f.is_finite() && *f > 0.0);
                factor.ok_or_else(|| {
                    format!("{axis}_SCALING_FACTOR is {text:?}; expected a number above 0")
                })?
            }
            None => 1.0,
        };
        for point in curve.iter_mut() {
            point[1] *= factor;
        }
        is_odd(axis, curve)?;
    }
    let [fx, fy, fz, tx, ty, tz] = curves;
    for (one, other, axes) in [(&fx, &fy, "FX and FY"), (&tx, &ty, "TX and TY")] {
        if !are_equal(one, other) {
            return Err(format!(
                "{axes} differ, and the subsystem does not state the directions of the bushing's axes; write the bushing into the study, with x_axis and z_axis"
            ));
        }
    }
    Ok(Laws {
        unit,
        along: [law(fz), law(fx)],
        about: [law(tz), law(tx)],
    })
}

/// Path of the property file that a subsystem names. `path` is the path of the subsystem.
///
/// # Errors
/// The name leads out of the folders, or no such file exists in the folder of the subsystem and in the folder above.
fn property_file(path: &Path, named: &str) -> Result<PathBuf, String> {
    let plain = named.replace('\\', "/");
    let below = match plain.strip_prefix("mdids://") {
        Some(rest) => rest.split_once('/').map_or(rest, |(_, rest)| rest),
        None => match plain
            .strip_prefix('<')
            .and_then(|rest| rest.split_once(">/"))
        {
            Some((_, rest)) => rest,
            None => plain.as_str(),
        },
    };
    let relative = Path::new(below);
    let is_plain = |part: Component<'_>| matches!(part, Component::Normal(_));
    if below.is_empty() || !relative.components().all(is_plain) {
        return Err(format!(
            "PROPERTY_FILE is {named:?}; expected a file of the database of the subsystem"
        ));
    }
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let own = path.parent().unwrap_or(Path::new(""));
    let above = own.parent().unwrap_or(own);
    let name = relative.file_name().unwrap_or_default();
    let places = [above.join(relative), own.join(relative), own.join(name)];
    places
        .into_iter()
        .find(|place| place.is_file())
        .ok_or_else(|| {
            format!(
                "its property file {below} is neither in the folder of the subsystem nor in the \
                 folder above"
            )
        })
}

/// Reads the six curves of a property file in N, rad and this unit of length, sorted by deflection.
fn curves_of(source: FileText, unit: LengthUnit) -> Result<[Points; 6], String> {
    let shown = |error: StudyErrors| error.to_string().trim_end().to_owned();
    let file = bushing_file::read(&Arc::new(source)).map_err(shown)?;
    let lengths = |metres: f64| unit.convert(metres, LengthUnit::Metre);
    let mut curves: [Points; 6] = Default::default();
    for (axis, (curve, points)) in curves.iter_mut().zip(&file.curves).enumerate() {
        let in_unit = |point: &CurvePoint| match axis {
            0..3 => [lengths(point.deflection), point.force],
            _ => [point.deflection, lengths(point.force)],
        };
        *curve = points.iter().map(in_unit).collect();
        curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let rises = |pair: &[[f64; 2]]| pair[1][0] > pair[0][0] && pair[1][1] > pair[0][1];
        let is_zero = curve.iter().all(|point| point[1] == 0.0);
        if !is_zero && !curve.windows(2).all(rises) {
            return Err(format!(
                "the curve of {} must rise in both columns",
                AXES[axis]
            ));
        }
    }
    Ok(curves)
}

fn size(curve: &Points, k: usize) -> f64 {
    curve.iter().map(|point| point[k].abs()).fold(0.0, f64::max)
}

fn are_equal(one: &Points, other: &Points) -> bool {
    let near = |k: usize, a: f64, b: f64| (a - b).abs() <= SAME * size(one, k);
    one.len() == other.len()
        && one
            .iter()
            .zip(other)
            .all(|(a, b)| near(0, a[0], b[0]) && near(1, a[1], b[1]))
}

/// Refuses a curve that is not an odd function, because the direction of the axis would matter then.
fn is_odd(axis: &str, curve: &Points) -> Result<(), String> {
    let turned: Points = curve.iter().rev().map(|[d, f]| [-d, -f]).collect();
    if are_equal(curve, &turned) {
        Ok(())
    } else {
        Err(format!(
            "{axis} is not the same in both directions, and the subsystem does not state the directions of the bushing's axes"
        ))
    }
}

/// Returns a constant rate if all points of the curve are on one line through zero, else the curve. The curve has at least two
/// points.
fn law(curve: Points) -> Law {
    let [deflection, force] = curve[curve.len() - 1];
    let rate = force / deflection;
    let is_line = |point: &[f64; 2]| (point[1] - rate * point[0]).abs() <= SAME * force.abs();
    if deflection > 0.0 && curve.iter().all(is_line) {
        Law::Rate(rate)
    } else {
        Law::Curve(curve)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(fx: &str) -> FileText {
        let mut text = "[UNITS]\nLENGTH = 'mm'\nANGLE = 'degrees'\nFORCE = 'newton'\n".to_owned();
        for axis in AXES {
            let points = if axis == "FX" { fx } else { "1 7\n0 0\n-1 -7" };
            text += &format!("[{axis}_CURVE]\n{points}\n");
        }
        FileText {
            name: "soft.bus".to_owned(),
            text,
        }
    }

    /// The property file has a force of 7 N at 1 mm, and a torque of 7 N mm at 1 deg. The result is in the unit of the
    /// subsystem, and its angles are in rad.
    #[test]
    fn curves_are_in_newtons_rad_and_the_unit_of_the_subsystem() {
        let made = curves_of(source("1 7\n0 0\n-1 -7"), LengthUnit::Metre).unwrap();
        let [fx, _, _, _, _, tz] = made;
        assert_eq!(fx[2], [0.001, 7.0]);
        assert_eq!(tz[2], [1.0_f64.to_radians(), 0.007]);
        assert_eq!(law(fx), Law::Rate(7000.0));
        let none = curves_of(source("-1 0\n1 0"), LengthUnit::Millimetre).unwrap();
        assert_eq!(law(none[0].clone()), Law::Rate(0.0));
        let falls = curves_of(source("-1 2\n1 -2"), LengthUnit::Millimetre).unwrap_err();
        assert!(falls.contains("FX must rise"), "{falls}");
    }

    /// 7 N/mm are 7000 N/m, and 7 N mm/rad are 0.007 N m/rad.
    #[test]
    fn laws_are_converted_to_other_units() {
        let laws = Laws {
            unit: LengthUnit::Millimetre,
            along: [Law::Rate(7.0), Law::Curve(vec![[-2.0, -8.0], [2.0, 8.0]])],
            about: [Law::Rate(7.0), Law::Curve(vec![[-2.0, -8.0], [2.0, 8.0]])],
        };
        assert_eq!(laws.in_unit(LengthUnit::Millimetre), laws);
        let metres = laws.in_unit(LengthUnit::Metre);
        assert_eq!(
            metres.along,
            [
                Law::Rate(7000.0),
                Law::Curve(vec![[-0.002, -8.0], [0.002, 8.0]])
            ]
        );
        assert_eq!(
            metres.about,
            [
                Law::Rate(0.007),
                Law::Curve(vec![[-2.0, -0.008], [2.0, 0.008]])
            ]
        );
    }

    #[test]
    fn curves_that_need_directions_are_refused() {
        let one_sided: Points = vec![[-1.0, -7.0], [0.0, 0.0], [1.0, 9.0]];
        assert!(
            is_odd("FX", &one_sided)
                .unwrap_err()
                .starts_with("FX is not the same")
        );
        let stiffening: Points = vec![[-2.0, -20.0], [-1.0, -7.0], [1.0, 7.0], [2.0, 20.0]];
        assert!(is_odd("FX", &stiffening).is_ok());
        assert_eq!(law(stiffening.clone()), Law::Curve(stiffening));
    }
}

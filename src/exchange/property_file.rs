//! A bushing of a study as a property file (`.bus`) of Adams Car.
//!
//! The file has a curve for each axis: force against deflection, or torque against angle in rad. A curve of the study keeps its
//! points. A law f = k d + c d^3 becomes points at equal steps h over a range -D to D. If c = 0, the points lie on the straight
//! line of the law. Otherwise the straight line between two points differs from the law by at most
//!
//! ```text
//! max |f''| h^2/8 = 3 c D h^2/4                                                                   (1)
//! ```

use super::adams_blocks::{heading, name_of_unit};
use super::outgoing::Outgoing;
use super::subsystem::Written;
use crate::compliance::{Relaxed, Shape};
use crate::model::LengthUnit;
use crate::report::shortest;
use crate::study::NamedBushing;
use std::fmt::Write;

/// Half of the range of deflections in mm, and of angles in rad, for a law without points.
const RANGE: [f64; 2] = [10.0, 0.2];
/// Number of steps from the middle of the range to an end: for a straight line, and for a nonlinear law.
const STEPS: [usize; 2] = [2, 50];

/// Names of the blocks: along x, y and z, then about them.
const AXES: [&str; 6] = ["FX", "FY", "FZ", "TX", "TY", "TZ"];

/// Makes the property file of the bushing at `hardpoint`. If `hardpoint` is `None`, the study must have only one bushing.
///
/// # Errors
/// The study has no such bushing, or it has several bushings and `hardpoint` is `None`.
pub fn property_file(outgoing: &Outgoing<'_>, hardpoint: Option<&str>) -> Result<Written, String> {
    let study = outgoing.study;
    let none = || "it has no section [bushings.NAME]".to_owned();
    let parts = study.elastic_parts().ok_or_else(none)?;
    let names = || {
        let names = parts.bushings.iter().map(|part| part.name);
        names.collect::<Vec<_>>().join(", ")
    };
    let part = match (hardpoint, &parts.bushings[..]) {
        (_, []) => return Err(none()),
        (None, [part]) => part,
        (None, _) => {
            return Err(format!(
                "it has several bushings, but a property file contains one: select it with \
                 --bushing, one of {}",
                names()
            ));
        }
        (Some(name), _) => {
            let found = parts.bushings.iter().find(|part| part.name == name);
            found.ok_or_else(|| format!("no bushing {name:?}; it has {}", names()))?
        }
    };
    let mut file = File {
        outgoing,
        text: head(outgoing.unit),
        notes: Vec::new(),
    };
    for (axis, shape) in part.shapes.iter().enumerate() {
        file.curve(axis, shape);
    }
    let mut notes = file.notes;
    notes.extend(remarks(part, parts.relaxed));
    Ok(Written {
        bytes: file.text.replace('\n', "\r\n").into_bytes(),
        notes,
    })
}

fn head(unit: LengthUnit) -> String {
    let length = name_of_unit(unit);
    let mut text = format!(
        "{} FILE_TYPE     =  'bus'\n FILE_VERSION  =  4.0\n FILE_FORMAT   =  'ASCII'\n{} \
         LENGTH  =  '{length}'\n ANGLE   =  'radians'\n FORCE   =  'newton'\n MASS    =  'kg'\n TIME    =  'second'\n{}",
        heading("MDI_HEADER"),
        heading("UNITS"),
        heading("DAMPING"),
    );
    for axis in AXES {
        let _ = writeln!(text, " {axis}_DAMPING  =  0.0");
    }
    text
}

/// Remarks about properties of a bushing that the file cannot hold.
fn remarks(part: &NamedBushing<'_>, relaxed: Relaxed) -> Vec<String> {
    let name = part.name;
    let mut remarks = vec![
        format!(
            "{name}: x, y and z of the file are the axes of the study's bushing \
             (docs/compliance.md, Axes); orient the bushing of the template in the same way"
        ),
        "damping is written as 0: the study has no damping".to_owned(),
    ];
    if part.preload.iter().any(|preload| *preload != 0.0) {
        remarks.push(format!(
            "preload is omitted, because it belongs in the subsystem: {}",
            part.preload.map(shortest).join(", ")
        ));
    }
    if relaxed == Relaxed::AtDesignLoad {
        remarks.push(
            "relaxed = \"at_design_load\": the curves start from the relaxed bushing; the forces \
             at the design load are preloads in the subsystem, from `hardpoint kc`"
                .to_owned(),
        );
    }
    remarks
}

/// File to which blocks are added.
struct File<'a> {
    outgoing: &'a Outgoing<'a>,
    text: String,
    notes: Vec<String>,
}

impl File<'_> {
    fn curve(&mut self, axis: usize, shape: &Shape) {
        let is_force = axis < 3;
        let points = match shape {
            Shape::Curve { curve, scale } => {
                let points = curve.points().iter();
                points.map(|[d, f]| [*d, f * scale]).collect()
            }
            Shape::Cubic { rate, cubic } => self.sampled(axis, *rate, *cubic),
        };
        let columns = if is_force { "x  fx" } else { "a  tx" };
        let columns = columns.replace('x', &AXES[axis][1..].to_lowercase());
        let _ = writeln!(
            self.text,
            "{}{{ {columns} }}",
            heading(&format!("{}_CURVE", AXES[axis]))
        );
        for [d, f] in points {
            // A torque is a force times a length.
            let [d, f] = if is_force {
                [self.outgoing.length(d), f]
            } else {
                [d, self.outgoing.length(f)]
            };
            let [d, f] = [d, f].map(|number| shortest(number + 0.0));
            let _ = writeln!(self.text, " {d:>24}  {f:>24}");
        }
    }

    /// Points of the law f = k d + c d^3 (deflection and force, or angle and torque), in the study's units. `rate` is k, and
    /// `cubic` is c.
    fn sampled(&mut self, axis: usize, rate: f64, cubic: f64) -> Vec<[f64; 2]> {
        let is_force = axis < 3;
        let own = self.outgoing.study.wheel().length_unit;
        let end = if is_force {
            own.convert(RANGE[0], LengthUnit::Millimetre)
        } else {
            RANGE[1]
        };
        let steps = STEPS[usize::from(cubic != 0.0)];
        let count = i32::try_from(steps).expect("few steps");
        let points = (-count..=count)
            .map(|step| {
                let d = end * (f64::from(step) / f64::from(count));
                [d, d * (rate + cubic * d * d)]
            })
            .collect();
        if cubic != 0.0 {
            let step = end / f64::from(count);
            let [reach, unit] = if is_force {
                [
                    format!("{} {}", shortest(end), own.symbol()),
                    "N".to_owned(),
                ]
            } else {
                [
                    format!("{} rad", shortest(end)),
                    format!("N {}", own.symbol()),
                ]
            };
            self.notes.push(format!(
                "{}: the cubic law is written as {} points to {reach} on both sides. A straight \
                 line between them deviates by up to {:.2e} {unit}; the file does not contain the \
                 law beyond",
                AXES[axis],
                2 * steps + 1,
                0.75 * cubic * end * step * step
            ));
        }
        points
    }
}

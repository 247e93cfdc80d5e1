//! Points and centre lines as a CAD drawing: text DXF of release 12, which every CAD program reads.
//!
//! The file is a list of pairs. Each pair has a number for the kind of value, and the value, each on its own line
//! (Autodesk, DXF Reference). The centre lines (`LINE`) of each body have a separate layer. The points (`POINT`) are on
//! the layer `POINTS`, and their names (`TEXT`) on the layer `NAMES`. A text on the layer `UNIT_AND_FRAME` states unit and axes.

use super::outgoing::Outgoing;
use crate::model::{LengthUnit, PointId, RigidAxle, Side};
use crate::number::Vector3;
use crate::report::Scene;
use std::fmt::Write;

/// Bytes of a drawing of all wheels of a study, in the design position.
pub fn drawing(outgoing: &Outgoing<'_>) -> Vec<u8> {
    let mut drawing = Drawing::default();
    let wheels = outgoing.wheels();
    for side in &wheels {
        let prefix = match wheels.len() {
            1 => String::new(),
            _ => format!("{}_", side.name()),
        };
        drawing.wheel(outgoing, *side, &prefix);
    }
    drawing.file(outgoing).into_bytes()
}

/// Height of the letters: 6 mm in the file's unit.
fn text_height(outgoing: &Outgoing<'_>) -> f64 {
    outgoing.unit.convert(6.0, LengthUnit::Millimetre)
}

/// Returns the prefix for the layer of `points` (a point of a solid axle, or both ends of a line). `None` if these points are drawn
/// with the other wheel. The mechanism of each wheel contains both halves, so each half is drawn with the wheel of this half. Parts
/// that exist only once are drawn with the left wheel.
fn prefix_on_solid_axle<'p>(
    rigid: &RigidAxle,
    side: Side,
    points: &[PointId],
    prefix: &'p str,
) -> Option<&'p str> {
    let is_pair = |a, b| rigid.far_of(a) == Some(b) || rigid.far_of(b) == Some(a);
    let joins_halves = matches!(*points, [a, b] if is_pair(a, b));
    if joins_halves || points.iter().all(|id| rigid.singles.contains(id)) {
        (side == Side::Left).then_some("")
    } else {
        let is_far = points.iter().any(|id| rigid.is_far(*id));
        (!is_far).then_some(prefix)
    }
}

/// Entities of the drawing, with their layers.
#[derive(Default)]
struct Drawing {
    entities: String,
    layers: Vec<String>,
}

impl Drawing {
    /// Draws a wheel: its bodies, its spin axis and its points.
    fn wheel(&mut self, outgoing: &Outgoing<'_>, side: Side, prefix: &str) {
        let height = text_height(outgoing);
        let suspension = outgoing.suspension(side);
        let rigid = suspension.mechanism.rigid_axle.as_ref();
        let prefix_of = |points: &[PointId]| match rigid {
            None => Some(prefix),
            Some(rigid) => prefix_on_solid_axle(rigid, side, points, prefix),
        };
        let own_side = format!("{} ", side.name());
        for body in Scene::of(suspension).bodies {
            let name = body.name.strip_prefix(&own_side).unwrap_or(&body.name);
            for line in &body.lines {
                for ends in line.windows(2) {
                    let ends = [PointId(ends[0]), PointId(ends[1])];
                    if let Some(prefix) = prefix_of(&ends) {
                        let [from, to] = ends.map(|id| outgoing.position(side, id));
                        self.line(&format!("{prefix}{name}"), from, to);
                    }
                }
            }
        }
        let centre = outgoing.place(side, suspension.mechanism.wheel_centre);
        let inboard = match suspension.wheel_radius {
            Some(radius) => outgoing.length(radius),
            None => 0.25 * outgoing.length(suspension.size()),
        };
        let inner: Vector3<f64> = centre - outgoing.spin_axis(side) * inboard;
        let ends = [inner, centre].map(|place| outgoing.in_axes(side, place));
        self.line(&format!("{prefix}spin axis"), ends[0], ends[1]);
        for (name, id, position) in outgoing.points(side) {
            if let Some(prefix) = prefix_of(&[id]) {
                self.entity("POINT", "POINTS", &[(10, position)]);
                self.text("NAMES", &format!("{prefix}{name}"), position, height);
            }
        }
    }

    fn line(&mut self, layer: &str, from: [f64; 3], to: [f64; 3]) {
        // Two parts may share a point. The line from this point to itself has no length, so it is not drawn.
        if from != to {
            self.entity("LINE", layer, &[(10, from), (11, to)]);
        }
    }

    /// Adds a text. Characters that are not ASCII become `?`.
    fn text(&mut self, layer: &str, text: &str, at: [f64; 3], height: f64) {
        self.entity("TEXT", layer, &[(10, at)]);
        let plain: String = text
            .chars()
            .map(|c| {
                if c.is_ascii_graphic() || c == ' ' {
                    c
                } else {
                    '?'
                }
            })
            .collect();
        let _ = write!(self.entities, "40\n{height}\n1\n{plain}\n");
    }

    /// Adds an entity to a layer. Each of `places` has the DXF group code of its x coordinate, and a position. The codes of y and z
    /// are greater by 10 and 20.
    fn entity(&mut self, kind: &str, layer: &str, places: &[(usize, [f64; 3])]) {
        let layer = layer.to_uppercase().replace(' ', "_");
        let _ = write!(self.entities, "0\n{kind}\n8\n{layer}\n");
        for (code, place) in places {
            for (axis, number) in place.iter().enumerate() {
                let _ = write!(self.entities, "{}\n{number}\n", code + 10 * axis);
            }
        }
        if !self.layers.contains(&layer) {
            self.layers.push(layer);
        }
    }

    /// Text of the whole file.
    fn file(mut self, outgoing: &Outgoing<'_>) -> String {
        let (unit, convention) = (outgoing.unit.symbol(), outgoing.convention);
        let (name, axes) = (convention.name(), convention.directions());
        let unit_and_frame = format!("unit {unit}; frame {name}: {axes}");
        let height = text_height(outgoing);
        self.text("UNIT_AND_FRAME", &unit_and_frame, [0.0; 3], height);
        // The header follows release 12, except for the field `$INSUNITS`. Programs that do not support this field skip
        // it.
        let code = match outgoing.unit {
            LengthUnit::Inch | LengthUnit::InchPound => 1,
            LengthUnit::Millimetre => 4,
            LengthUnit::Metre => 6,
        };
        let mut file = format!(
            "999\npoints and centre lines by hardpoint; {unit_and_frame}\n0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n\
             9\n$INSUNITS\n70\n{code}\n0\nENDSEC\n0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLTYPE\n70\n1\n\
             0\nLTYPE\n2\nCONTINUOUS\n70\n0\n3\nSolid line\n72\n65\n73\n0\n40\n0.0\n0\nENDTAB\n\
             0\nTABLE\n2\nLAYER\n70\n{}\n",
            self.layers.len()
        );
        for (layer, colour) in self.layers.iter().zip((1..=7).cycle()) {
            let _ = write!(
                file,
                "0\nLAYER\n2\n{layer}\n70\n0\n62\n{colour}\n6\nCONTINUOUS\n"
            );
        }
        file += "0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
        file += &self.entities;
        file += "0\nENDSEC\n0\nEOF\n";
        file
    }
}

//! Views of a car's page: each axle from the front, and the roll axis from the side.

use super::shown;
use crate::report::car::{CarRecord, CarStateRecord};
use std::fmt::Write;

/// Width of a view. On a phone, one unit is one pixel.
const WIDTH: f64 = 350.0;

/// Scale of a view: picture units per length unit, position of the origin, and height of the picture.
struct Scale {
    factor: f64,
    origin: [f64; 2],
    height: f64,
}

impl Scale {
    /// Makes the scale of a view that shows these positions (horizontal, vertical) and the ground at height 0.
    fn fit(places: impl Iterator<Item = [f64; 2]>, margins: [f64; 2]) -> Self {
        let mut low = [f64::INFINITY, 0.0];
        let mut high = [f64::NEG_INFINITY, 0.0];
        for place in places {
            for k in 0..2 {
                low[k] = low[k].min(place[k]);
                high[k] = high[k].max(place[k]);
            }
        }
        let factor = (WIDTH - 2.0 * margins[0]) / (high[0] - low[0]).max(1e-9);
        let up = factor * high[1] + 14.0;
        Scale {
            factor,
            origin: [margins[0] - factor * low[0], up],
            height: up - factor * low[1] + margins[1],
        }
    }

    fn at(&self, [across, up]: [f64; 2]) -> [f64; 2] {
        [
            self.origin[0] + self.factor * across,
            self.origin[1] - self.factor * up,
        ]
    }
}

/// Draws a line through positions of the picture.
fn line(svg: &mut String, class: &str, places: impl Iterator<Item = [f64; 2]>) {
    let mut letter = 'M';
    let mut path = String::new();
    for [x, y] in places {
        let _ = write!(path, "{letter}{x:.1} {y:.1}");
        letter = 'L';
    }
    let _ = write!(svg, "<path class=\"{class}\" d=\"{path}\"/>");
}

fn begin(height: f64, label: &str) -> String {
    format!("<svg viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\" aria-label=\"{label}\">")
}

/// View of an axle from the front: the left wheel is on the right.
pub(super) fn front(record: &CarRecord, state: &CarStateRecord, axle: usize) -> String {
    let flat = |place: &[f64; 3]| [place[1], place[2]];
    let wheels = [0, 1].map(|side| {
        let number = 2 * axle + side;
        wheel_from_the_front(state.centres[number], state.contacts[number])
    });
    let points = &state.points[axle];
    let all = points
        .iter()
        .map(flat)
        .chain(wheels.iter().flatten().copied());
    let scale = Scale::fit(all, [24.0, 38.0]);
    let mut svg = begin(scale.height, "axle from the front");
    let ground = scale.at([0.0, 0.0])[1];
    line(
        &mut svg,
        "ground",
        [[0.0, ground], [WIDTH, ground]].into_iter(),
    );
    for body in &record.scenes[axle].bodies {
        for run in &body.lines {
            let places = run.iter().filter_map(|point| points.get(*point));
            let class = format!("line {}", body.kind.class());
            line(&mut svg, &class, places.map(|place| scale.at(flat(place))));
        }
    }
    for (side, outline) in wheels.iter().enumerate() {
        let number = 2 * axle + side;
        let class = if state.lifted[number] {
            "wheel lifted"
        } else {
            "wheel"
        };
        let closed = outline.iter().chain(outline.first());
        line(&mut svg, class, closed.map(|place| scale.at(*place)));
        let across = scale.at(flat(&state.contacts[number]))[0];
        let anchor = ["end", ""][side];
        let x = [WIDTH, 0.0][side];
        let _ = write!(
            svg,
            "<text class=\"{anchor}\" x=\"{x}\" y=\"{:.1}\">{} {}</text><text class=\"small {anchor}\" x=\"{x}\" y=\"{:.1}\">camber {} deg</text>",
            ground + 17.0,
            shown(state.loads[number], &record.force_unit),
            record.force_unit,
            ground + 32.0,
            shown(state.camber[number], "deg")
        );
        let _ = write!(
            svg,
            "<path class=\"zero\" d=\"M{across:.1} {ground:.1}v5\"/>"
        );
    }
    svg + "</svg>"
}

/// Outline of a wheel from the front, from its centre and its lowest point. The width is only an illustration, because no study
/// gives it.
fn wheel_from_the_front(centre: [f64; 3], contact: [f64; 3]) -> [[f64; 2]; 4] {
    let along = [centre[1] - contact[1], centre[2] - contact[2]];
    let across = [0.3 * along[1], -0.3 * along[0]];
    let corner = |up: f64, side: f64| {
        [0, 1].map(|k| [centre[1], centre[2]][k] + up * along[k] + side * across[k])
    };
    [
        corner(-1.0, -1.0),
        corner(-1.0, 1.0),
        corner(1.0, 1.0),
        corner(1.0, -1.0),
    ]
}

/// View of the car from the left, with the roll axis and the centre of gravity: forward is to the left.
pub(super) fn side(record: &CarRecord, state: &CarStateRecord) -> String {
    let mean = |places: &[[f64; 3]; 4], axle: usize, k: usize| {
        0.5 * (places[2 * axle][k] + places[2 * axle + 1][k])
    };
    let axles = [0, 1].map(|axle| -mean(&state.contacts, axle, 0));
    let wheels = [0, 1].map(|axle| {
        let (centre, contact) = (state.centres[2 * axle], state.contacts[2 * axle]);
        let radius = (centre[2] - contact[2]).hypot(centre[1] - contact[1]);
        ([-centre[0], centre[2]], radius)
    });
    let cg = [-state.sprung_cg[0], state.sprung_cg[2]];
    let corners = wheels
        .iter()
        .flat_map(|([x, z], radius)| [[x - radius, z - radius], [x + radius, z + radius]]);
    let scale = Scale::fit(corners.chain([cg]), [10.0, 40.0]);
    let mut svg = begin(scale.height, "roll axis from the left side");
    let ground = scale.at([0.0, 0.0])[1];
    line(
        &mut svg,
        "ground",
        [[0.0, ground], [WIDTH, ground]].into_iter(),
    );
    for (axle, (centre, radius)) in wheels.iter().enumerate() {
        let [x, y] = scale.at(*centre);
        let lifted = if state.lifted[2 * axle] {
            " lifted"
        } else {
            ""
        };
        let _ = write!(
            svg,
            "<circle class=\"wheel{lifted}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"/>",
            radius * scale.factor
        );
    }
    if let [Some(front), Some(rear)] = state.roll_centre {
        let ends = [[axles[0], front], [axles[1], rear]];
        line(
            &mut svg,
            "kinematic",
            ends.into_iter().map(|end| scale.at(end)),
        );
    }
    if let [Some(front), Some(rear)] = state.roll_axis {
        roll_axis(
            &mut svg,
            &scale,
            (axles, [front, rear]),
            cg,
            &record.length_unit,
        );
    }
    let [x, y] = scale.at(cg);
    let _ = write!(
        svg,
        "<circle class=\"cg\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>"
    );
    svg + "</svg>"
}

/// Draws the roll axis between the axles, and the arm (vertical distance) from this axis to the centre of gravity `cg`. The two
/// pairs are the positions of the axles along the car, and the heights of the roll axis at the axles.
fn roll_axis(
    svg: &mut String,
    scale: &Scale,
    (axles, [front, rear]): ([f64; 2], [f64; 2]),
    cg: [f64; 2],
    unit: &str,
) {
    let ground = scale.at([0.0, 0.0])[1];
    let [x, y] = scale.at(cg);
    let ends = [[axles[0], front], [axles[1], rear]];
    line(svg, "axis", ends.into_iter().map(|end| scale.at(end)));
    let share = (cg[0] - axles[0]) / (axles[1] - axles[0]);
    let height = front + share * (rear - front);
    let foot = scale.at([cg[0], height]);
    line(svg, "arm-of-cg", [[x, y], foot].into_iter());
    for (axle, height) in [front, rear].into_iter().enumerate() {
        let [at, _] = scale.at([axles[axle], 0.0]);
        let _ = write!(
            svg,
            "<text class=\"middle\" x=\"{at:.1}\" y=\"{:.1}\">{} {unit}</text>",
            ground + 17.0,
            shown(height, unit),
        );
    }
    let _ = write!(
        svg,
        "<text class=\"middle\" x=\"{x:.1}\" y=\"{:.1}\">arm {} {unit}</text>",
        ground + 17.0,
        shown(cg[1] - height, unit),
    );
    let _ = write!(
        svg,
        "<text class=\"small middle\" x=\"{:.1}\" y=\"{:.1}\">height of the roll axis at each axle, arm of the sprung mass</text>",
        0.5 * WIDTH,
        ground + 34.0
    );
}

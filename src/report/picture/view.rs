//! Drawing of the mechanism: front, side and top view, with the names of its points.
//!
//! The drawing shows the last design in the frame nearest to the design position. Other designs of the run are grey. An arrow leads
//! from each moved point of such a design to the same point of the last design. For a tolerance analysis, only the last design is
//! drawn.

use super::labels::{Label, place_labels};
use crate::curves::Placement;
use crate::report::chart::lettering::{Anchor, Lettering, Words};
use crate::report::chart::mark::{number, path};
use crate::report::record::{DesignRecord, Record};
use crate::report::scene::{Scene, Sight};
use crate::report::unit_in_words;
use std::fmt::Write;

/// Styles of the drawing.
pub(super) const STYLE: &str = ".arm{stroke:#0b63c5;stroke-width:3}.link{stroke:#0b8a8a;stroke-width:2.4}\
.strut{stroke:#7a4fc9;stroke-width:3}.spring{stroke:#b3267a;stroke-width:2.4;stroke-dasharray:7 3}\
.rocker{stroke:#8a5a2b;stroke-width:2.4}.knuckle{stroke:#6b737b;stroke-width:1.4}\
.wheel{stroke:#3d454d;stroke-width:1.6}.steering{stroke:#c2570c;stroke-width:1.2;stroke-dasharray:8 3 2 3}\
.ground{stroke:#8a929b;stroke-width:1}.was{stroke:#8a929b;stroke-width:1.6;stroke-dasharray:6 4}\
.point{fill:#ffffff;stroke:#1b1f24;stroke-width:1.3}.moved{stroke:#b3261e;stroke-width:2}\
.leader{stroke:#66707a;stroke-width:0.9}.axis{stroke:#1b1f24;stroke-width:1.4}";

/// Smallest move that is drawn as an arrow, relative to the width of the drawing.
const LEAST_ARROW: f64 = 0.004;

/// Drawing of the suspension in the designs of a run, as a front, side or top view.
#[derive(Clone, Debug)]
pub(super) struct View<'r> {
    record: &'r Record,
    sight: Sight,
    named: bool,
    size: [f64; 2],
}

/// Scale of a view. It converts positions in the study's axes to positions on the picture. The axes of the view point right and up.
struct Projection {
    axes: [(usize, f64); 2],
    middle: [f64; 2],
    factor: f64,
    size: [f64; 2],
}

impl Projection {
    fn flat(axes: [(usize, f64); 2], point: &[f64; 3]) -> [f64; 2] {
        axes.map(|(axis, sign)| sign * point[axis])
    }

    fn place(&self, point: &[f64; 3]) -> [f64; 2] {
        let [right, up] = Self::flat(self.axes, point);
        [
            self.size[0] / 2.0 + self.factor * (right - self.middle[0]),
            self.size[1] / 2.0 + 8.0 - self.factor * (up - self.middle[1]),
        ]
    }
}

impl<'r> View<'r> {
    /// Makes a view. `None` if no design of the run has a drawing.
    pub(super) fn of(
        record: &'r Record,
        sight: Sight,
        named: bool,
        size: [f64; 2],
    ) -> Option<Self> {
        let is_drawn = record
            .motion
            .designs
            .iter()
            .any(|design| design.nearest_pose().is_some());
        let view = View {
            record,
            sight,
            named,
            size,
        };
        is_drawn.then_some(view)
    }

    /// View as an SVG group, moved by `shift` to the right and down.
    pub(super) fn svg(&self, shift: [f64; 2], lettering: &Lettering) -> String {
        let designs = self.record.motion.designs.iter();
        let poses: Vec<&Placement> = designs.filter_map(DesignRecord::nearest_pose).collect();
        let Some((last, earlier)) = poses.split_last() else {
            return String::new();
        };
        // A tolerance analysis has percentile curves, which are not designs. So only its last pose is drawn.
        let earlier = match self.record.command.as_str() {
            "tolerance" => &[],
            _ => earlier,
        };
        let scene = &self.record.scene;
        let projection = self.projection(scene, &poses);
        let [across, down] = shift.map(number);
        let mut svg = format!("<g transform=\"translate({across} {down})\">\n");
        if self.sight != Sight::Top {
            ground(&mut svg, &projection, last);
        }
        for pose in earlier {
            draw(&mut svg, scene, pose, &projection, Some("was"));
        }
        draw(&mut svg, scene, last, &projection, None);
        for pose in earlier {
            arrows(&mut svg, pose, last, &projection);
        }
        for point in shown_points(scene, last) {
            let [x, y] = projection.place(&last.points[point]).map(number);
            let _ = writeln!(
                svg,
                "<circle class=\"point\" cx=\"{x}\" cy=\"{y}\" r=\"3\"/>"
            );
        }
        if self.named {
            self.names(&mut svg, lettering, last, &projection);
        }
        let title = Words::new(self.sight.title(), [16.0, 22.0], Anchor::Start).label();
        lettering.write(&mut svg, &title);
        svg.push('\n');
        self.triad(&mut svg, lettering, scene);
        svg + "</g>\n"
    }

    fn projection(&self, scene: &Scene, poses: &[&Placement]) -> Projection {
        let axes = scene.axes(self.sight);
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for pose in poses {
            let rims = wheels(scene, pose).into_iter().flatten();
            for place in pose.points.iter().copied().chain(rims) {
                let flat = Projection::flat(axes, &place);
                for k in 0..2 {
                    low[k] = low[k].min(flat[k]);
                    high[k] = high[k].max(flat[k]);
                }
            }
        }
        let margin = if self.named {
            [130.0, 100.0]
        } else {
            [50.0, 90.0]
        };
        let factors = [0, 1].map(|k| (self.size[k] - margin[k]) / (high[k] - low[k]).max(1e-9));
        Projection {
            axes,
            middle: [0, 1].map(|k| (low[k] + high[k]) / 2.0),
            factor: factors[0].min(factors[1]),
            size: self.size,
        }
    }

    /// Names of the points. For an axle, only the names of the left wheel's points.
    fn names(
        &self,
        svg: &mut String,
        lettering: &Lettering,
        pose: &Placement,
        projection: &Projection,
    ) {
        let scene = &self.record.scene;
        let points = shown_points(scene, pose);
        let dots: Vec<[f64; 2]> = points
            .iter()
            .map(|point| projection.place(&pose.points[*point]))
            .collect();
        let name = |point: &usize| scene.points[*point].trim_start_matches("left_");
        let is_named = |point: &usize| !scene.points[*point].starts_with("right_");
        let is_axle = scene.right_wheel_centre.is_some();
        let chosen = points.iter().zip(&dots);
        let chosen = chosen.filter(|(point, _)| !is_axle || is_named(point));
        let labels: Vec<(&str, [f64; 2])> = chosen.map(|(p, dot)| (name(p), *dot)).collect();
        let segments = segments(scene, pose, projection);
        for label in place_labels(&labels, &dots, &segments, self.size) {
            let Label { text, at, leader } = label;
            if let Some(ends) = leader {
                path(svg, "leader", ends.into_iter(), false);
            }
            lettering.write(svg, &Words::new(text, at, Anchor::Start));
            svg.push('\n');
        }
    }

    /// Draws arrows along the study's axes in the lower left corner.
    fn triad(&self, svg: &mut String, lettering: &Lettering, scene: &Scene) {
        let origin = [46.0, self.size[1] - 30.0];
        for (k, (axis, sign)) in scene.axes(self.sight).into_iter().enumerate() {
            let along = if k == 0 { [sign, 0.0] } else { [0.0, -sign] };
            let tip = [0, 1].map(|i| origin[i] + 22.0 * along[i]);
            arrow(svg, "axis", origin, tip);
            let at = [tip[0] + 9.0 * along[0], tip[1] + 9.0 * along[1] + 4.0];
            let letter = ["x", "y", "z"][axis];
            lettering.write(svg, &Words::new(letter, at, Anchor::Middle));
            svg.push('\n');
        }
    }
}

/// Indices of the points in the drawing: all points that have a position.
fn shown_points(scene: &Scene, pose: &Placement) -> Vec<usize> {
    (0..scene.points.len().min(pose.points.len())).collect()
}

/// Circle of each wheel in the wheel's plane, as points. Empty without a wheel radius.
fn wheels(scene: &Scene, pose: &Placement) -> Vec<Vec<[f64; 3]>> {
    let Some(radius) = scene.wheel_radius else {
        return Vec::new();
    };
    let right = scene.right_wheel_centre.zip(pose.right.as_ref());
    let right = right.map(|(centre, wheel)| (centre, wheel.spin_axis));
    let both = [Some((scene.wheel_centre, pose.spin_axis)), right];
    let circle = |(centre, spin): (usize, [f64; 3])| {
        let centre = *pose.points.get(centre)?;
        // The spin axis is never vertical, so the next two directions span the wheel's plane.
        let first = unit([spin[1], -spin[0], 0.0]);
        let second = cross(spin, first);
        let place = |step: usize| {
            let angle = std::f64::consts::TAU * step as f64 / 60.0;
            [0, 1, 2]
                .map(|k| centre[k] + radius * (angle.cos() * first[k] + angle.sin() * second[k]))
        };
        Some((0..60).map(place).collect())
    };
    both.into_iter().flatten().filter_map(circle).collect()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    v.map(|c| c / length.max(1e-300))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Draws one pose of the mechanism. If `style` is given, it is the CSS class of every part.
fn draw(
    svg: &mut String,
    scene: &Scene,
    pose: &Placement,
    projection: &Projection,
    style: Option<&str>,
) {
    for rim in wheels(scene, pose) {
        let places = rim.iter().map(|place| projection.place(place));
        path(svg, style.unwrap_or("wheel"), places, true);
    }
    if let (Some([low, high]), None) = (pose.steering_axis, style) {
        path(
            svg,
            "steering",
            to_the_ground(low, high, pose)
                .into_iter()
                .map(|p| projection.place(&p)),
            false,
        );
    }
    for body in &scene.bodies {
        let class = style.unwrap_or(body.kind.class());
        for line in &body.lines {
            let places = line.iter().filter_map(|point| pose.points.get(*point));
            path(svg, class, places.map(|p| projection.place(p)), false);
        }
    }
}

/// Segment of the steering axis, from its upper point to the height of the contact point. Without a contact point, the segment
/// between both points of the axis.
fn to_the_ground(low: [f64; 3], high: [f64; 3], pose: &Placement) -> [[f64; 3]; 2] {
    let Some(contact) = pose.contact else {
        return [low, high];
    };
    let rise = high[2] - low[2];
    if rise.abs() < 1e-9 {
        return [low, high];
    }
    let share = (contact[2] - low[2]) / rise;
    [[0, 1, 2].map(|k| low[k] + share * (high[k] - low[k])), high]
}

fn ground(svg: &mut String, projection: &Projection, pose: &Placement) {
    if let Some(contact) = pose.contact {
        let y = number(projection.place(&contact)[1]);
        let right = number(projection.size[0] - 16.0);
        let _ = writeln!(svg, "<path class=\"ground\" d=\"M16 {y}H{right}\"/>");
    }
}

/// Draws arrows from the points of one design to the points of another design.
fn arrows(svg: &mut String, from: &Placement, to: &Placement, projection: &Projection) {
    for (before, after) in from.points.iter().zip(&to.points) {
        let [from, to] = [before, after].map(|place| projection.place(place));
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        if length > LEAST_ARROW * projection.size[0] {
            arrow(svg, "moved", from, to);
        }
    }
}

/// Draws an arrow with a head of at most six picture units.
fn arrow(svg: &mut String, class: &str, from: [f64; 2], to: [f64; 2]) {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]).max(1e-9);
    let head = (0.6 * length).min(6.0) / length;
    let end = |turn: f64| {
        [
            to[0] - head * (along[0] + turn * along[1]),
            to[1] - head * (along[1] - turn * along[0]),
        ]
    };
    path(svg, class, [from, to].into_iter(), false);
    path(svg, class, [end(0.5), to, end(-0.5)].into_iter(), false);
}

/// All lines of bodies and wheels. Labels avoid them.
fn segments(scene: &Scene, pose: &Placement, projection: &Projection) -> Vec<[[f64; 2]; 2]> {
    let lines = scene.bodies.iter().flat_map(|body| &body.lines);
    let ends = lines.flat_map(|line| line.windows(2));
    let place = |point: usize| Some(projection.place(pose.points.get(point)?));
    let lines = ends.filter_map(|pair| Some([place(pair[0])?, place(pair[1])?]));
    let rims = wheels(scene, pose);
    let rims = rims.iter().flat_map(|rim| rim.windows(2));
    let rims = rims.map(|pair| [0, 1].map(|k| projection.place(&pair[k])));
    lines.chain(rims).collect()
}

/// Legend of the lines in a drawing, as an SVG group moved by `shift` to the right and down.
pub(super) fn key(record: &Record, shift: [f64; 2], lettering: &Lettering) -> String {
    let [across, down] = shift.map(number);
    let mut svg = format!("<g transform=\"translate({across} {down})\">\n");
    let mut kinds: Vec<(&str, String)> = Vec::new();
    for body in &record.scene.bodies {
        let class = body.kind.class();
        match kinds.iter_mut().find(|(known, _)| *known == class) {
            Some((_, names)) if !names.contains(&body.name) => {
                *names += &format!(", {}", body.name);
            }
            Some(_) => {}
            None => kinds.push((class, body.name.clone())),
        }
    }
    let last = record.motion.designs.last();
    let pose = last.and_then(DesignRecord::nearest_pose);
    if pose.is_some_and(|pose| pose.steering_axis.is_some()) {
        kinds.push(("steering", "steering axis, down to the ground".to_owned()));
    }
    if record.scene.wheel_radius.is_some() {
        kinds.push(("wheel", "wheel, with its loaded radius".to_owned()));
    }
    if record.motion.designs.len() == 2 {
        kinds.push(("was", record.motion.designs[0].label.clone()));
    }
    let title = format!("{}: {}", record.study, record.topology.replace('_', " "));
    lettering.write(
        &mut svg,
        &Words::new(&title, [16.0, 40.0], Anchor::Start).label(),
    );
    svg.push('\n');
    for (row, (class, names)) in kinds.iter().enumerate() {
        let y = 66.0 + 22.0 * row as f64;
        let _ = writeln!(svg, "<path class=\"{class}\" d=\"M16 {}h34\"/>", y - 4.0);
        lettering.write(&mut svg, &Words::new(names, [60.0, y], Anchor::Start));
        svg.push('\n');
    }
    let y = 66.0 + 22.0 * kinds.len() as f64;
    let unit = unit_in_words(&record.length_unit);
    let unit = format!("axes of the study, lengths in {unit}");
    lettering.write(&mut svg, &Words::new(&unit, [16.0, y + 6.0], Anchor::Start));
    svg + "\n</g>\n"
}

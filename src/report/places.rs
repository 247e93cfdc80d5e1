//! Regions of constraints for the drawing: regions in which a point must stay, regions that a point must avoid, and members that
//! must stay apart.

use crate::characteristics::{Measure, Quantity};
use crate::model::{Axis, Frame, PointId};
use crate::number::Vector3;
use crate::study::{Constraint, Limited, Study};
use serde::{Deserialize, Serialize};

/// Number of corners of a circle.
const ROUND: usize = 36;

/// Regions of constraints of one wheel, in the study's axes and length unit. They include the clearance of their constraint. A
/// box or cylinder that a point must avoid has sharp edges, although the clearance around an edge is round.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Places {
    /// Boxes, spheres, cylinders and planes.
    pub shapes: Vec<Shape>,
    /// Inner spaces of rims.
    pub rims: Vec<Rim>,
    /// Pairs of members that must stay apart.
    pub clearances: Vec<Clearance>,
}

/// A shape of a region that does not move with the suspension.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Name of the constraint.
    pub name: String,
    /// Index of the point that the constraint limits.
    pub point: usize,
    /// Lines of the outline, in the study's axes.
    pub lines: Vec<Vec<[f64; 3]>>,
}

/// Inner space of a rim, about the spin axis. If a constraint limits several points, the space belongs to the first one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rim {
    /// Name of the constraint.
    pub name: String,
    /// Index of the point that the constraint limits.
    pub point: usize,
    /// Radius of the space for this point: radius of the rim minus clearance.
    pub radius: f64,
    /// Start and end of the space, as distances outboard of the wheel centre. Without limits of the constraint, values suited to
    /// the size of the wheel.
    pub ends: [f64; 2],
}

/// Two members that must stay apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clearance {
    /// Name of the constraint.
    pub name: String,
    /// Indices of the two end points of each member.
    pub members: [[usize; 2]; 2],
    /// Smallest allowed distance between the centre lines of the two members.
    pub least: f64,
}

impl Places {
    /// Regions of the study's constraints, for the drawing.
    pub fn of(study: &Study) -> Self {
        let mut places = Places::default();
        let suspension = study.wheel();
        let size = suspension.wheel_radius.unwrap_or(0.5 * suspension.size());
        for constraint in study.optimise.iter().flat_map(|o| &o.constraints) {
            places.add(constraint, &suspension.frame, &suspension.design, size);
        }
        places
    }

    /// Adds the region of a constraint to the drawing. Constraints without a region add nothing. `size` is the wheel radius, or
    /// half the size of the suspension if the radius is unknown.
    fn add(&mut self, constraint: &Constraint, frame: &Frame, design: &[Vector3<f64>], size: f64) {
        let name = || constraint.name.clone();
        let Some(first) = constraint.parts.first() else {
            return;
        };
        let (point, outline) = match &first.of {
            Measure::Clearance(members) => {
                self.clearances.push(Clearance {
                    name: name(),
                    members: members.map(|member| member.map(|end| end.0)),
                    least: first.lower.unwrap_or(0.0),
                });
                return;
            }
            Measure::FromSpinAxis(point) | Measure::FromSpinAxisAt([point, _], _) => {
                self.rims.push(rim(constraint, *point, size));
                return;
            }
            Measure::Quantity(Quantity::Coordinate(point, _)) => {
                let Some((middle, half)) = inner_box(&constraint.parts) else {
                    return;
                };
                (*point, box_lines(middle, half))
            }
            Measure::FromBox {
                point,
                middle,
                half,
            } => {
                let gap = first.lower.unwrap_or(0.0);
                (*point, box_lines(*middle, half.map(|half| half + gap)))
            }
            Measure::DistanceFrom(point, centre) => {
                let radius = first.upper.or(first.lower).unwrap_or(0.0);
                (*point, sphere_lines(*centre, radius))
            }
            Measure::FromLine {
                point,
                through,
                along,
            } => {
                let axial = part_of(constraint, |of| matches!(of, Measure::Height { .. }));
                let half = axial.and_then(|part| part.upper).unwrap_or(0.5 * size);
                let radius = first.upper.unwrap_or(0.0);
                (*point, tube_lines(*through, *along, half, radius))
            }
            Measure::FromTube {
                point,
                middle,
                along,
                half,
                radius,
            } => {
                let gap = first.lower.unwrap_or(0.0);
                let lines = tube_lines(*middle, *along, half + gap, radius + gap);
                (*point, lines)
            }
            Measure::Height {
                point,
                over,
                normal,
            } => {
                // Shows only a square part of the plane, near the point.
                let place = design[point.0];
                let off = first.lower.or(first.upper).unwrap_or(0.0);
                let foot = place - *normal * ((place - *over).dot(*normal) - off);
                (*point, plane_lines(foot, *normal, 0.4 * size))
            }
            _ => return,
        };
        let seen = |p: &Vector3<f64>| frame.vector(*p).to_array();
        let lines = outline.iter().map(|line| line.iter().map(seen).collect());
        self.shapes.push(Shape {
            name: name(),
            point: point.0,
            lines: lines.collect(),
        });
    }
}

/// First part of a constraint whose measured quantity satisfies `is_wanted`.
fn part_of(constraint: &Constraint, is_wanted: fn(&Measure) -> bool) -> Option<&Limited> {
    let mut parts = constraint.parts.iter();
    parts.find(|part| is_wanted(&part.of))
}

/// Rim that a point must stay inside. `size` is the wheel radius, or half the size of the suspension if the radius is unknown.
fn rim(constraint: &Constraint, point: PointId, size: f64) -> Rim {
    let along = part_of(constraint, |of| matches!(of, Measure::AlongSpinAxis(_)));
    let edge = constraint.parts.iter().find_map(|part| match part.of {
        Measure::FromSpinAxisAt(_, from) => Some(from),
        _ => None,
    });
    let limit =
        |limit: fn(&Limited) -> Option<f64>, none: f64| along.and_then(limit).unwrap_or(none);
    let radius = constraint.parts.first().and_then(|part| part.upper);
    Rim {
        name: constraint.name.clone(),
        point: point.0,
        radius: radius.unwrap_or(0.0),
        ends: [
            edge.unwrap_or_else(|| limit(|p| p.lower, -0.3 * size)),
            limit(|p| p.upper, 0.1 * size),
        ],
    }
}

/// Centre and half edge lengths of the box whose sides limit the three coordinates of a point. `None` unless all three have two
/// limits.
fn inner_box(parts: &[Limited]) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let mut limits = [None; 3];
    for part in parts {
        if let Measure::Quantity(Quantity::Coordinate(_, axis)) = part.of {
            limits[axis as usize] = part.lower.zip(part.upper);
        }
    }
    let [Some(x), Some(y), Some(z)] = limits else {
        return None;
    };
    let of = |f: fn((f64, f64)) -> f64| Vector3::new(f(x), f(y), f(z));
    Some((of(|(l, u)| 0.5 * (l + u)), of(|(l, u)| 0.5 * (u - l))))
}

type Lines = Vec<Vec<Vector3<f64>>>;

/// Corners of a square in order. The last one repeats the first, so that the path is closed.
const AROUND: [[f64; 2]; 5] = [
    [-1.0, -1.0],
    [1.0, -1.0],
    [1.0, 1.0],
    [-1.0, 1.0],
    [-1.0, -1.0],
];

fn box_lines(middle: Vector3<f64>, half: Vector3<f64>) -> Lines {
    let at = |x: f64, y: f64, z: f64| middle + Vector3::new(x * half.x, y * half.y, z * half.z);
    let ring = |z: f64| AROUND.map(|[x, y]| at(x, y, z)).to_vec();
    let posts = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let posts = posts.map(|[x, y]| vec![at(x, y, -1.0), at(x, y, 1.0)]);
    [ring(-1.0), ring(1.0)].into_iter().chain(posts).collect()
}

/// Two unit vectors that are perpendicular to a direction and to each other.
fn across(along: Vector3<f64>) -> [Vector3<f64>; 2] {
    let entries = along.to_array().map(f64::abs);
    let least = Axis::ALL.into_iter().min_by(|a, b| {
        let entry = |axis: &Axis| entries[*axis as usize];
        entry(a).total_cmp(&entry(b))
    });
    let mut unit = [0.0; 3];
    unit[least.map_or(0, |axis| axis as usize)] = 1.0;
    let first = along.cross(Vector3::from(unit)).normalised();
    [first, along.cross(first)]
}

fn circle(centre: Vector3<f64>, [u, v]: [Vector3<f64>; 2], radius: f64) -> Vec<Vector3<f64>> {
    (0..=ROUND)
        .map(|k| {
            let (sine, cosine) = (std::f64::consts::TAU * k as f64 / ROUND as f64).sin_cos();
            centre + u * (radius * cosine) + v * (radius * sine)
        })
        .collect()
}

fn sphere_lines(centre: Vector3<f64>, radius: f64) -> Lines {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::from);
    let [x, y, z] = axes;
    [[x, y], [y, z], [z, x]]
        .map(|plane| circle(centre, plane, radius))
        .to_vec()
}

fn tube_lines(middle: Vector3<f64>, along: Vector3<f64>, half: f64, radius: f64) -> Lines {
    let plane = across(along);
    let ends = [middle - along * half, middle + along * half];
    let rings = ends.map(|end| circle(end, plane, radius));
    let sides = [0, ROUND / 4, ROUND / 2, 3 * ROUND / 4].map(|k| vec![rings[0][k], rings[1][k]]);
    rings.into_iter().chain(sides).collect()
}

fn plane_lines(foot: Vector3<f64>, normal: Vector3<f64>, half: f64) -> Lines {
    let [u, v] = across(normal.normalised());
    let ring = AROUND.map(|[a, b]| foot + u * (a * half) + v * (b * half));
    vec![
        ring.to_vec(),
        vec![ring[0], ring[2]],
        vec![ring[1], ring[3]],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tube_is_drawn_about_its_axis() {
        let (middle, along) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.6, 0.0, 0.8));
        for line in &tube_lines(middle, along, 5.0, 2.0)[..2] {
            for p in line {
                let off = *p - middle;
                let axial = off.dot(along);
                assert!((axial.abs() - 5.0).abs() < 1e-12);
                assert!(((off - along * axial).norm() - 2.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_box_has_its_corners() {
        let lines = box_lines(Vector3::new(1.0, 0.0, 0.0), Vector3::new(1.0, 2.0, 3.0));
        let all = lines.iter().flatten();
        assert!(
            all.clone()
                .all(|p| (p.x == 0.0 || p.x == 2.0) && p.y.abs() == 2.0 && p.z.abs() == 3.0)
        );
        assert_eq!(lines.len(), 6);
    }
}

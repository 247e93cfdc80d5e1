//! Directions fixed in the wheel carrier, from three of its points.
//!
//! The solver in SIMD lanes computes positions of points, but no rotation. Let P_0, P_1, P_2 be points of the carrier in the
//! design position and p_0, p_1, p_2 in the present pose, E_i = P_i - P_0 and e_i = p_i - p_0. The rotation R takes E_i to
//! e_i. So R also takes the orthonormal triad made from E_1 and E_2 to the triad made from e_1 and e_2. A direction V of the
//! design position becomes
//!
//! ```text
//! v = R V                                                                  (1)
//! dv = t x v + R dV,      de_i = t x e_i + R dE_i                          (2)
//! ```
//!
//! for a small rotation t. A derivative b with respect to v is therefore a moment m = v x b about the carrier. Forces f_i at
//! the three points with this moment are the derivatives with respect to the points:
//!
//! ```text
//! b.dv = m.t + b.R dV = sum f_i.(de_i - R dE_i) + (R^T b).dV,     sum e_i x f_i = m      (3)
//! f_2 = n (m.e_1)/|n|^2,   f_1 = (m - e_2 x f_2) x e_1/|e_1|^2,   n = e_1 x e_2         (4)
//! ```

use crate::model::{Body, PointId, Suspension};
use crate::number::Vector3;

/// Three points of the wheel carrier, in the design position and in the present pose.
pub(super) struct CarriedTriangle {
    /// Edges e_1 and e_2 in the present pose.
    edges: [Vector3<f64>; 2],
    normal: Vector3<f64>,
    /// Triads in the design position and in the present pose.
    triads: [[Vector3<f64>; 3]; 2],
}

/// Edges of a triangle from its first corner, and their cross product.
fn edges([a, b, c]: [Vector3<f64>; 3]) -> ([Vector3<f64>; 2], Vector3<f64>) {
    let [first, second] = [b - a, c - a];
    ([first, second], first.cross(second))
}

fn triad(corners: [Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
    let ([first, _], normal) = edges(corners);
    let (x, z) = (first.normalised(), normal.normalised());
    [x, z.cross(x), z]
}

/// Transforms a vector: the result has the same coordinates in the second triad as the vector in the first triad.
fn carried(from: &[Vector3<f64>; 3], to: &[Vector3<f64>; 3], v: Vector3<f64>) -> Vector3<f64> {
    let [x, y, z] = from.map(|axis| axis.dot(v));
    to[0] * x + to[1] * y + to[2] * z
}

impl CarriedTriangle {
    /// The points of the wheel carrier that span the largest triangle in the design position. `None` if they all lie on
    /// one line.
    pub(super) fn corners(suspension: &Suspension) -> Option<[PointId; 3]> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let points = (0..design.len()).map(PointId);
        let points: Vec<PointId> = points
            .filter(|id| mechanism.body(*id) == Body::Knuckle)
            .collect();
        let mut largest = (1e-6 * suspension.size().powi(2), None);
        for (i, a) in points.iter().enumerate() {
            for (j, b) in points.iter().enumerate().skip(i + 1) {
                for c in &points[j + 1..] {
                    let (_, normal) = edges([a, b, c].map(|id| design[id.0]));
                    if normal.norm() > largest.0 {
                        largest = (normal.norm(), Some([*a, *b, *c]));
                    }
                }
            }
        }
        largest.1
    }

    /// Makes the triangle from its corners in the design position and in the present pose.
    pub(super) fn new(designed: [Vector3<f64>; 3], now: [Vector3<f64>; 3]) -> Self {
        let (edges, normal) = edges(now);
        CarriedTriangle {
            edges,
            normal,
            triads: [triad(designed), triad(now)],
        }
    }

    /// Rotates a direction from the design position to the present pose, by equation (1) of this module.
    pub(super) fn turned(&self, direction: Vector3<f64>) -> Vector3<f64> {
        carried(&self.triads[0], &self.triads[1], direction)
    }

    /// Rotates a direction from the present pose back to the design position.
    pub(super) fn turned_back(&self, direction: Vector3<f64>) -> Vector3<f64> {
        carried(&self.triads[1], &self.triads[0], direction)
    }

    /// Derivatives with respect to the corners in the present pose, by equation (4) of this module. `by` is the derivative
    /// with respect to the rotated direction `v`. The derivatives with respect to the corners in the design position are
    /// the same with the opposite sign, rotated back.
    pub(super) fn by_corners(&self, v: Vector3<f64>, by: Vector3<f64>) -> [Vector3<f64>; 3] {
        let [first, second] = self.edges;
        let moment = v.cross(by);
        let at_second = self.normal * (moment.dot(first) / self.normal.norm_squared());
        let rest = moment - second.cross(at_second);
        let at_first = rest.cross(first) * (1.0 / first.norm_squared());
        [-(at_first + at_second), at_first, at_second]
    }
}

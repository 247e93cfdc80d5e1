//! Independent formulation with position and quaternion. Seven equations hold the lengths of the rods, the unit length
//! of the quaternion and both heights. Newton's method uses a Jacobian that is derived by hand.
//!
//! In both programs, the residuals of the solution are a few rounding errors of coordinates of 1,000 mm: 1e-12 mm. The
//! condition number of the random axles is below 1e3, so positions have an error of up to 1e-9 mm.

use super::{STILL, axle, text};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::{AxleQuantity as A, AxleSolver, Placement, Quantity};

pub(super) type Point = [f64; 3];

pub(super) fn plus(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(super) fn mirror([x, y, z]: Point) -> Point {
    [x, -y, z]
}

/// Rotates a vector by a quaternion (scalar first), without division by the quaternion's squared norm.
pub(super) fn turned(q: [f64; 4], v: Point) -> Point {
    let [w, x, y, z] = q;
    [
        (w * w + x * x - y * y - z * z) * v[0]
            + 2.0 * (x * y - w * z) * v[1]
            + 2.0 * (x * z + w * y) * v[2],
        2.0 * (x * y + w * z) * v[0]
            + (w * w - x * x + y * y - z * z) * v[1]
            + 2.0 * (y * z - w * x) * v[2],
        2.0 * (x * z - w * y) * v[0]
            + 2.0 * (y * z + w * x) * v[1]
            + (w * w - x * x - y * y + z * z) * v[2],
    ]
}

/// Derivatives of [`turned`] with respect to the four components of the quaternion.
fn turned_by(q: [f64; 4], v: Point) -> [Point; 4] {
    let [w, x, y, z] = q;
    let [a, b, c] = v;
    let two = |p: Point| p.map(|c| 2.0 * c);
    [
        two([
            w * a - z * b + y * c,
            z * a + w * b - x * c,
            -y * a + x * b + w * c,
        ]),
        two([
            x * a + y * b + z * c,
            y * a - x * b - w * c,
            z * a + w * b - x * c,
        ]),
        two([
            -y * a + x * b + w * c,
            x * a + y * b + z * c,
            -w * a + z * b - y * c,
        ]),
        two([
            -z * a - w * b + x * c,
            w * a - z * b + y * c,
            x * a + y * b + z * c,
        ]),
    ]
}

/// Solves a square system by elimination with pivoting. Each row contains the coefficients and then the right-hand side.
pub(super) fn solve(mut m: Vec<Vec<f64>>) -> Vec<f64> {
    let n = m.len();
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|a, b| m[*a][k].abs().total_cmp(&m[*b][k].abs()))
            .unwrap();
        m.swap(k, pivot);
        let (done, open) = m.split_at_mut(k + 1);
        let pivot = &done[k];
        for row in open {
            let factor = row[k] / pivot[k];
            for (entry, by) in row[k..].iter_mut().zip(&pivot[k..]) {
                *entry -= factor * by;
            }
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| m[k][j] * x[j]).sum();
        x[k] = (m[k][n] - sum) / m[k][k];
    }
    x
}

/// Axle in the design position: rods from the body to the axle, and both wheel centres.
pub(super) struct Axle {
    rods: Vec<[Point; 2]>,
    centres: [Point; 2],
}

impl Axle {
    /// Returns both wheel centres at these travels. They are reached from the design position in small steps.
    pub(super) fn at(&self, travels: [f64; 2]) -> [Point; 2] {
        let (mut at, mut q) = ([0.0; 3], [1.0, 0.0, 0.0, 0.0]);
        const STEPS: u32 = 20;
        for step in 1..=STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            for _ in 0..12 {
                let mut rows = Vec::new();
                for [body, own] in &self.rods {
                    let now = minus(minus(turned(q, *own), *body), at.map(|c| -c));
                    let was = minus(*own, *body);
                    let square = |p: Point| p.iter().map(|c| c * c).sum::<f64>();
                    let mut row: Vec<f64> = now.iter().map(|c| 2.0 * c).collect();
                    row.extend(
                        turned_by(q, *own)
                            .map(|by| 2.0 * (0..3).map(|i| by[i] * now[i]).sum::<f64>()),
                    );
                    row.push(square(was) - square(now));
                    rows.push(row);
                }
                for (centre, travel) in self.centres.iter().zip(travels) {
                    let now = turned(q, *centre)[2] + at[2];
                    let mut row = vec![0.0, 0.0, 1.0];
                    row.extend(turned_by(q, *centre).map(|by| by[2]));
                    row.push(centre[2] + share * travel - now);
                    rows.push(row);
                }
                let mut row = vec![0.0; 3];
                row.extend(q.map(|c| 2.0 * c));
                row.push(1.0 - q.iter().map(|c| c * c).sum::<f64>());
                rows.push(row);
                let step = solve(rows);
                for i in 0..3 {
                    at[i] += step[i];
                }
                for i in 0..4 {
                    q[i] += step[3 + i];
                }
            }
        }
        self.centres.map(|c| {
            let p = turned(q, c);
            [p[0] + at[0], p[1] + at[1], p[2] + at[2]]
        })
    }
}

/// Points of a random axle: those of the left half, and single points with their actual y.
pub(super) fn random(random: &mut Random, single: bool) -> Vec<(&'static str, Point)> {
    let mut near = |p: Point, by: f64| p.map(|c| c + by * random.signed());
    let mut points = vec![
        ("lower_link_chassis", near([540.0, 430.0, 305.0], 40.0)),
        ("lower_link_axle", near([0.0, 525.0, 255.0], 30.0)),
        ("wheel_centre", near([-10.0, 755.0, 333.0], 20.0)),
    ];
    if single {
        points.extend([
            ("upper_link_chassis", near([420.0, 40.0, 470.0], 40.0)),
            ("upper_link_axle", near([10.0, 60.0, 480.0], 30.0)),
            ("panhard_chassis", near([-140.0, 480.0, 360.0], 30.0)),
            ("panhard_axle", near([-140.0, -470.0, 335.0], 30.0)),
        ]);
    } else {
        points.extend([
            ("upper_link_chassis", near([335.0, 470.0, 445.0], 30.0)),
            ("upper_link_axle", near([20.0, 155.0, 472.0], 30.0)),
        ]);
    }
    points
}

pub(super) fn own(points: &[(&str, Point)], single: bool) -> Axle {
    let at = |name: &str| points.iter().find(|(n, _)| *n == name).unwrap().1;
    let rod = |name: &str| [at(&format!("{name}_chassis")), at(&format!("{name}_axle"))];
    let last = if single {
        rod("panhard")
    } else {
        rod("upper_link").map(mirror)
    };
    let lower = rod("lower_link");
    let centre = at("wheel_centre");
    Axle {
        rods: vec![lower, lower.map(mirror), rod("upper_link"), last],
        centres: [centre, mirror(centre)],
    }
}

#[test]
fn positions_are_those_of_another_formulation() {
    compare_positions(300);
}

#[test]
#[ignore = "ten thousand axles of each kind"]
fn positions_of_ten_thousand_axles_are_those_of_another_formulation() {
    compare_positions(10_000);
}

/// Compares the positions of axles of each kind at random travels. `axles` is the number of axles of each kind.
fn compare_positions(axles: usize) {
    use hardpoint::axle::WheelParts as _;
    let mut generator = Random(46);
    for single in [false, true] {
        let mut worst = 0.0_f64;
        for _ in 0..axles {
            let points = random(&mut generator, single);
            let study = axle(&text(&points, single, STILL));
            let wanted = [Quantity::Axle(A::AxleLateral)];
            let mut solver = AxleSolver::<1>::new(&study.axle, &wanted, false).unwrap();
            let travels = [(); 2].map(|()| 60.0 * generator.signed());
            let placement = Placement::Travels {
                travels,
                rack: 0.0,
                on_plane: false,
            };
            let placed = solver.place(&placement).unwrap();
            let read = solver.read(&placed).unwrap();
            let expected = own(&points, single).at(travels);
            let lateral = Quantity::Axle(A::AxleLateral).evaluate(&read.state);
            let middle = 0.5 * (expected[0][1] + expected[1][1]);
            worst = larger(worst, (lateral - middle).abs());
            for (side, wheel) in read.state.wheels().into_iter().enumerate() {
                let found = wheel.reading.centre().to_array();
                let found = if side == 0 { found } else { mirror(found) };
                for (found, expected) in found.iter().zip(expected[side]) {
                    worst = larger(worst, (found - expected).abs());
                }
            }
        }
        println!("single {single}: {worst:e} mm");
        assert!(worst < 1e-9, "single {single}: {worst:e} mm");
    }
}

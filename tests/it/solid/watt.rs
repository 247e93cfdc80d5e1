//! Tests of Watt linkages against an independent formulation. It has eight unknowns: position, quaternion and the
//! rocker's angle. The equations are the lengths of five rods, the unit length of the quaternion and both heights.
//! Newton's method continues until the residuals are rounding errors. So its Jacobian, from central differences, need not
//! be accurate.

use super::own::{self, Point, cross, dot, minus, mirror, plus, solve, turned};
use super::{STILL, axle, slopes_of_designs, text};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::analyse::RangeEnd;
use hardpoint::axle::{
    AxleQuantity as A, AxleSolver, Motion, Placement, Quantity, TravelRanges, WheelParts as _,
};
use hardpoint::model::Rod;

/// Part to which the pivot of the rocker is fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Base {
    Axle,
    Body,
}

const BASES: [Base; 2] = [Base::Axle, Base::Body];

/// Rotates a point about the line from `first` to `second`, by Rodrigues' formula.
fn about([first, second]: [Point; 2], angle: f64, point: Point) -> Point {
    let way = minus(second, first);
    let length = dot(way, way).sqrt();
    let axis = way.map(|c| c / length);
    let lever = minus(point, first);
    let (sine, cosine) = angle.sin_cos();
    let along = dot(axis, lever) * (1.0 - cosine);
    let across = cross(axis, lever);
    let turned = [0, 1, 2].map(|i| cosine * lever[i] + sine * across[i] + along * axis[i]);
    plus(first, turned)
}

struct Linkage {
    points: Vec<(&'static str, Point)>,
    base: Base,
}

impl Linkage {
    fn at(&self, name: &str) -> Point {
        self.points.iter().find(|(n, _)| *n == name).unwrap().1
    }

    /// Eight residuals at position, quaternion and rocker's angle.
    fn residuals(&self, x: &[f64; 8], travels: [f64; 2]) -> [f64; 8] {
        let (shift, q, angle) = ([x[0], x[1], x[2]], [x[3], x[4], x[5], x[6]], x[7]);
        let on_axle = |p: Point| plus(turned(q, p), shift);
        let axis = ["watt_pivot", "watt_axis"].map(|name| self.at(name));
        let off = |now: [Point; 2], was: [Point; 2]| {
            let (now, was) = (minus(now[1], now[0]), minus(was[1], was[0]));
            0.5 * (dot(now, now) - dot(was, was)) / dot(was, was).sqrt()
        };
        let link = |body: Point, own: Point| off([body, on_axle(own)], [body, own]);
        let pair = |name: &str| ["chassis", "axle"].map(|end| self.at(&format!("{name}_{end}")));
        let [body, own] = pair("lower_link");
        let [upper_body, upper] = pair("upper_link");
        let watt = |name: &str| {
            let rocker = self.at(&format!("{name}_rocker"));
            let turned = about(axis, angle, rocker);
            match self.base {
                Base::Axle => {
                    let body = self.at(&format!("{name}_chassis"));
                    off([body, on_axle(turned)], [body, rocker])
                }
                Base::Body => {
                    let own = self.at(&format!("{name}_axle"));
                    off([turned, on_axle(own)], [rocker, own])
                }
            }
        };
        let centre = self.at("wheel_centre");
        let height = |centre: Point, travel: f64| on_axle(centre)[2] - centre[2] - travel;
        [
            link(body, own),
            link(mirror(body), mirror(own)),
            link(upper_body, upper),
            watt("watt_upper"),
            watt("watt_lower"),
            height(centre, travels[0]),
            height(mirror(centre), travels[1]),
            300.0 * (q.iter().map(|c| c * c).sum::<f64>() - 1.0),
        ]
    }

    /// Returns the sine of the angle between the upper link and the plane of its lever and the rocker's axis.
    fn leverage(&self, x: &[f64; 8]) -> f64 {
        let (shift, q, angle) = ([x[0], x[1], x[2]], [x[3], x[4], x[5], x[6]], x[7]);
        let on_axle = |p: Point| plus(turned(q, p), shift);
        let axis = ["watt_pivot", "watt_axis"].map(|name| self.at(name));
        let own = about(axis, angle, self.at("watt_upper_rocker"));
        let [first, second, own, other] = match self.base {
            Base::Axle => {
                let [first, second] = axis.map(on_axle);
                [first, second, on_axle(own), self.at("watt_upper_chassis")]
            }
            Base::Body => {
                let [first, second] = axis;
                [first, second, own, on_axle(self.at("watt_upper_axle"))]
            }
        };
        let plane = cross(minus(second, first), minus(own, first));
        let rod = minus(own, other);
        let length = |v: Point| dot(v, v).sqrt();
        dot(plane, rod).abs() / (length(plane) * length(rod))
    }

    /// Returns both wheel centres at these travels, and the unknowns. `None` if a step of the path is not small.
    fn solved(&self, travels: [f64; 2]) -> Option<([Point; 2], [f64; 8])> {
        let mut x = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        const STEPS: u32 = 20;
        for step in 1..=STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            let travels = travels.map(|travel| share * travel);
            for _ in 0..12 {
                let residuals = self.residuals(&x, travels);
                let mut rows: Vec<Vec<f64>> = residuals.iter().map(|_| Vec::new()).collect();
                for k in 0..8 {
                    let by = if k < 3 { 1e-3 } else { 1e-6 };
                    let moved = |sign: f64| {
                        let mut moved = x;
                        moved[k] += sign * by;
                        self.residuals(&moved, travels)
                    };
                    let (above, below) = (moved(1.0), moved(-1.0));
                    for (row, entry) in rows.iter_mut().enumerate() {
                        entry.push((above[row] - below[row]) / (2.0 * by));
                    }
                }
                for (row, residual) in rows.iter_mut().zip(residuals) {
                    row.push(-residual);
                }
                let step = solve(rows);
                if step[7].abs() > 0.4 {
                    return None;
                }
                for (x, step) in x.iter_mut().zip(step) {
                    *x += step;
                }
            }
        }
        let centre = self.at("wheel_centre");
        let q = [x[3], x[4], x[5], x[6]];
        let place = |p: Point| plus(turned(q, p), [x[0], x[1], x[2]]);
        Some(([place(centre), place(mirror(centre))], x))
    }
}

/// Random axle on three links and a Watt linkage, whose rocker has levers of about this length.
fn random(random: &mut Random, base: Base, lever: f64) -> Linkage {
    let mut points = own::random(random, true);
    points.retain(|(name, _)| !name.starts_with("panhard_"));
    let mut near = |p: Point, by: f64| p.map(|c| c + by * random.signed());
    points.extend([
        ("watt_pivot", near([-150.0, 0.0, 340.0], 20.0)),
        ("watt_axis", near([-90.0, 0.0, 345.0], 15.0)),
        (
            "watt_upper_rocker",
            near([-150.0, 0.0, 340.0 + lever], 10.0),
        ),
        (
            "watt_lower_rocker",
            near([-150.0, 0.0, 340.0 - lever], 10.0),
        ),
    ]);
    let ends = match base {
        Base::Axle => ["watt_upper_chassis", "watt_lower_chassis"],
        Base::Body => ["watt_upper_axle", "watt_lower_axle"],
    };
    points.extend([
        (ends[0], near([-150.0, 480.0, 345.0 + lever], 25.0)),
        (ends[1], near([-150.0, -480.0, 335.0 - lever], 25.0)),
    ]);
    Linkage { points, base }
}

#[test]
fn positions_and_rates_are_those_of_another_formulation() {
    compare(150);
}

#[test]
#[ignore = "1,000 axles"]
fn positions_and_rates_of_a_thousand_axles_are_those_of_another_formulation() {
    compare(500);
}

/// Compares positions of `each` axles of each kind at random travels. Also compares derivatives of two quantities with
/// respect to heave and roll with difference quotients of the independent formulation.
fn compare(each: usize) {
    let mut generator = Random(64);
    for base in BASES {
        let (mut worst, mut worst_rate, mut solved) = (0.0_f64, 0.0_f64, 0);
        for _ in 0..each {
            let linkage = random(&mut generator, base, 70.0);
            let study = axle(&text(&linkage.points, true, STILL));
            let wanted = [A::AxleLateral, A::AxleLongitudinal].map(Quantity::Axle);
            let mut solver = AxleSolver::<2>::new(&study.axle, &wanted, false).unwrap();
            let travels = [(); 2].map(|()| 50.0 * generator.signed());
            let placement = Placement::Travels {
                travels,
                rack: 0.0,
                on_plane: false,
            };
            let Some((expected, _)) = linkage.solved(travels) else {
                continue;
            };
            solved += 1;
            let placed = solver.place(&placement).unwrap();
            let read = solver.read(&placed).unwrap();
            for (side, wheel) in read.state.wheels().into_iter().enumerate() {
                let found = wheel.reading.centre().to_array();
                let found = if side == 0 { found } else { mirror(found) };
                for (found, expected) in found.iter().zip(expected[side]) {
                    worst = larger(worst, (found - expected).abs());
                }
            }
            // Derivatives are compared for a tenth of the axles only, because each comparison needs eight more
            // solutions.
            if solved % 10 == 0 {
                let middle = |travels: [f64; 2]| {
                    let ([left, right], _) = linkage.solved(travels).unwrap();
                    [0.5 * (left[1] + right[1]), 0.5 * (left[0] + right[0])]
                };
                for (motion, way) in [
                    (Motion::Heave, [1.0, 1.0]),
                    (Motion::TravelLeft, [1.0, 0.0]),
                ] {
                    let along = |by: f64| middle([0, 1].map(|i| travels[i] + by * way[i]));
                    let moving = read.state.moving(motion);
                    for (k, quantity) in wanted.into_iter().enumerate() {
                        let slope = |h: f64| (along(h)[k] - along(-h)[k]) / (2.0 * h);
                        let expected = (4.0 * slope(0.5) - slope(1.0)) / 3.0;
                        worst_rate =
                            larger(worst_rate, (quantity.evaluate(&moving)[1] - expected).abs());
                    }
                }
            }
        }
        println!("{base:?}: {solved} solved, {worst:e} mm, rates {worst_rate:e}");
        assert!(25 * solved > 24 * each, "{base:?}: {solved}");
        // The bound covers rounding errors of 1e-12 mm at a condition number below 1e3. Difference quotients with step 1
        // have an error proportional to the fifth derivative.
        assert!(worst < 1e-9, "{base:?}: {worst:e} mm");
        assert!(worst_rate < 1e-8, "{base:?}: {worst_rate:e}");
    }
}

/// Gradients with respect to the points of the linkage equal difference quotients of complete designs.
#[test]
fn gradients_are_those_of_whole_designs() {
    let mut generator = Random(65);
    for base in BASES {
        let linkage = random(&mut generator, base, 70.0);
        let study = axle(&text(&linkage.points, true, STILL));
        let wanted = [
            A::AxleLateral,
            A::AxleSteer,
            A::RollSteer,
            A::RollCentreHeight,
            A::RigidAntiSquat,
        ]
        .map(Quantity::Axle);
        let mut solver = AxleSolver::<3>::new(&study.axle, &wanted, false).unwrap();
        let base_design = study.axle.left.design.clone();
        let placement = Placement::Roll {
            heave: 15.0,
            roll: 0.04,
            rack: 0.0,
        };
        let placed = solver.place(&placement).unwrap();
        let mut found = vec![Vec::new(); wanted.len()];
        solver
            .gradients(&placed, &wanted, |number, [left, _]| {
                found[number] = left.to_vec();
            })
            .unwrap();
        let names = linkage.points.iter().map(|(name, _)| *name);
        for name in names {
            let id = study.axle.left.mechanism.point(name).unwrap();
            for axis in 0..3 {
                let at = (&base_design[..], &placement, &wanted[..]);
                let slopes = slopes_of_designs(&mut solver, at, (id, axis));
                for (k, quantity) in wanted.iter().enumerate() {
                    let expected = slopes[k];
                    let found = found[k][id.0].to_array()[axis];
                    let largest = match quantity {
                        Quantity::Axle(A::RigidAntiSquat | A::RollCentreHeight) => 1.0,
                        _ => 1e-2,
                    };
                    let off = (found - expected).abs();
                    assert!(
                        off < 1e-7 * (largest + expected.abs()),
                        "{base:?} {name} {axis} {quantity:?}: {found} {expected}"
                    );
                }
            }
        }
    }
}

/// With short levers, the Watt linkage reaches its toggle before the axle's links end the motion. The limit names the
/// upper link. In the independent formulation, the link, its lever and the rocker's axis lie in one plane there.
#[test]
fn toggles_of_the_upper_link_are_named() {
    let mut generator = Random(66);
    let mut named = 0;
    for number in 0..20 {
        let base = BASES[number % 2];
        let linkage = random(&mut generator, base, 25.0);
        let study = axle(&text(&linkage.points, true, STILL));
        let limits = study.axle.limits().unwrap();
        let TravelRanges::OfAxle { heave, .. } = &limits.travels else {
            panic!("a solid axle");
        };
        for end in [&heave.lower, &heave.upper] {
            let RangeEnd::Toggle { value, rod } = *end else {
                continue;
            };
            assert_eq!(rod, Rod::WattLink);
            // The leverage falls with the square root of the remaining distance.
            let leverage = |share: f64| {
                let (_, x) = linkage.solved([share * value; 2])?;
                Some(linkage.leverage(&x))
            };
            let (Some(halfway), Some(near)) = (leverage(0.5), leverage(0.9999)) else {
                continue;
            };
            named += 1;
            assert!(
                near < 0.05 * halfway,
                "{number} {base:?}: {value} {halfway} {near}"
            );
        }
    }
    println!("{named} toggles");
    assert!(named > 0);
}

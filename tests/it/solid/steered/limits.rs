//! Tests of the ends of a steering gear's range, and of the parts that are at their toggles there.

use super::{axle, random, study};
use crate::compliance::support::fourth_order;
use crate::solid::own::{Point, cross, dot, minus};
use crate::support::random::Random;
use hardpoint::analyse::RangeEnd;
use hardpoint::axle::{Axle, AxleEnd, AxleSolver, Placement};
use hardpoint::mechanism::LimitCause;
use hardpoint::model::{Rod, Side};
use hardpoint::number::Vector3;

fn level(rack: f64) -> Placement {
    Placement::Travels {
        travels: [0.0; 2],
        rack,
        on_plane: false,
    }
}

/// Returns true if the axle at rest has a position with the steering gear displaced by `rack`.
pub fn follows(axle: &Axle, rack: f64) -> bool {
    let mut solver = AxleSolver::<1>::new(axle, &[], false).unwrap();
    let placed = solver.place(&level(rack));
    placed
        .and_then(|placed| solver.read(&placed).map(drop))
        .is_ok()
}

/// Two points of a knuckle's axis, then both ends of the knuckle's rod. The end on the knuckle comes before the other
/// end.
type Linkage = [Point; 4];

const DRAG_LINK: [&str; 4] = [
    "kingpin_lower",
    "kingpin_upper",
    "drag_link_knuckle",
    "drag_link_body",
];
const TIE_ROD: [&str; 4] = [
    "right_kingpin_lower",
    "right_kingpin_upper",
    "right_tie_rod_end",
    "tie_rod_end",
];

fn axis_of([lower, upper, ..]: Linkage) -> Point {
    let way = minus(upper, lower);
    way.map(|c| c / dot(way, way).sqrt())
}

/// Returns the sine of the angle between a rod and the plane of the knuckle's axis and the rod's arm.
fn leverage(linkage: Linkage) -> f64 {
    let [lower, _, inner, outer] = linkage;
    let axis = axis_of(linkage);
    let from_lower = minus(inner, lower);
    let along = dot(from_lower, axis);
    let arm = [0, 1, 2].map(|i| from_lower[i] - along * axis[i]);
    let rod = minus(outer, inner);
    let moment = dot(cross(arm, rod), axis);
    moment.abs() / (dot(arm, arm) * dot(rod, rod)).sqrt()
}

/// Returns the rod in a position of the axle with the steering gear displaced by `rack`.
fn in_position(axle: &Axle, names: [&str; 4], rack: f64) -> Linkage {
    let ids = names.map(|name| axle.left.mechanism.point(name).unwrap());
    let mut solver = AxleSolver::<1>::new(axle, &[], false).unwrap();
    solver.read_points(&ids);
    let placed = solver.place(&level(rack)).unwrap();
    let read = solver.read(&placed).unwrap();
    let points = &read.points[Side::Left as usize];
    [0, 1, 2, 3].map(|k| points[k].map(|c| c.coefficient([0, 0])).to_array())
}

/// Rotates a point about the axis of a knuckle.
fn turned(linkage: Linkage, angle: f64, point: Point) -> Point {
    let axis = axis_of(linkage);
    let lever = minus(point, linkage[0]);
    let (sine, cosine) = angle.sin_cos();
    let along = dot(lever, axis) * (1.0 - cosine);
    let across = cross(axis, lever);
    [0, 1, 2].map(|i| linkage[0][i] + cosine * lever[i] + sine * across[i] + along * axis[i])
}

/// Returns the rotation of a knuckle, near a known rotation, at which the rod keeps its length. The other end of the rod
/// has moved to `outer`.
fn turn(linkage: Linkage, outer: Point, near: f64) -> f64 {
    let square = |a: Point, b: Point| dot(minus(a, b), minus(a, b));
    let length = square(linkage[2], linkage[3]);
    let mut angle = near;
    for _ in 0..60 {
        let now = turned(linkage, angle, linkage[2]);
        let arm = cross(axis_of(linkage), minus(now, linkage[0]));
        angle -= 0.5 * (square(now, outer) - length) / dot(arm, minus(now, outer));
    }
    angle
}

/// Returns drag link and tie rod of an axle at rest with the steering gear displaced by `rack`. Both knuckles rotate.
fn at_rest(axle: &Axle, rack: f64) -> [Linkage; 2] {
    let at = |name: &str| axle.left.design[axle.left.mechanism.point(name).unwrap().0].to_array();
    let (drag_link, tie_rod) = (DRAG_LINK.map(at), TIE_ROD.map(at));
    let (mut left, mut right) = (0.0, 0.0);
    let (mut body, mut end) = (drag_link[3], tie_rod[3]);
    for step in 1..=400 {
        // Steps become shorter towards a toggle.
        let share = 1.0 - (1.0 - f64::from(step) / 400.0).powi(2);
        body[1] = drag_link[3][1] + share * rack;
        left = turn(drag_link, body, left);
        end = turned(drag_link, left, tie_rod[3]);
        right = turn(tie_rod, end, right);
    }
    let arms = [
        turned(drag_link, left, drag_link[2]),
        turned(tie_rod, right, tie_rod[2]),
    ];
    [
        [drag_link[0], drag_link[1], arms[0], body],
        [tie_rod[0], tie_rod[1], arms[1], end],
    ]
}

/// For almost every end of the drag link's range, the program names the part that limits it. Positions exist up to the
/// end, and none beyond it. The named rod is in line with its arm, in that position or on the path to it with the axle at
/// rest. Near a toggle the solver loses a position up to 1e-4 of the range before the end.
#[test]
fn every_end_names_the_part_that_binds() {
    name_ends(4);
}

#[test]
#[ignore = "takes minutes"]
fn every_end_of_forty_axles_names_the_part_that_binds() {
    name_ends(40);
}

fn name_ends(axles: usize) {
    let mut generator = Random(519);
    let (mut kinds, mut lost) = ([0; 3], 0);
    for number in 0..axles {
        let by = [10.0, 20.0][number % 2];
        let world = random(&mut generator, number % 2 == 0, by);
        let own = axle(&study(&world, "[motion]\nheave = [0.0]\n")).axle;
        let ends: [AxleEnd; 2] = own.limits().unwrap().rack.unwrap();
        for end in ends {
            assert!(follows(&own, 0.9999 * end.value), "{number}: {end:?}");
            assert!(!follows(&own, 1.0001 * end.value), "{number}: {end:?}");
            match &end.end {
                RangeEnd::Toggle { rod, value } => {
                    assert_eq!(*value, end.value);
                    let is_tie_rod = *rod == Rod::TieRod;
                    let names = if is_tie_rod { TIE_ROD } else { DRAG_LINK };
                    let near = (1.0 - 1e-6) * value;
                    let leverages = [
                        in_position(&own, names, near),
                        at_rest(&own, near)[usize::from(is_tie_rod)],
                    ]
                    .map(leverage);
                    let least = leverages[0].min(leverages[1]);
                    // Leverage falls with the square root of the distance to the toggle. For some axles it is small only
                    // very close to the toggle.
                    assert!(least < 0.05, "{number}: {rod} {leverages:?}");
                    kinds[usize::from(is_tie_rod)] += 1;
                }
                RangeEnd::Fold(limit) => {
                    assert_eq!(limit.cause, LimitCause::AxleFolds);
                    assert_eq!(limit.value, end.value);
                    kinds[2] += 1;
                }
                // The solver lost the path, and the program reports this instead of a part.
                _ => lost += 1,
            }
        }
    }
    assert!(
        kinds.iter().all(|kind| 3 * *kind >= axles) && 5 * lost <= axles,
        "{kinds:?} {lost}"
    );
}

/// Some ends of the range are folds: turning points where the motion of the drag link reverses. Derivatives of such ends
/// with respect to every point of the axle equal finite differences of fourth order between other designs. The points of
/// the other designs move along random directions.
#[test]
fn a_fold_along_the_drag_link_has_exact_derivatives() {
    let mut generator = Random(23);
    let (mut folds, mut with_lift) = (0, 0);
    for number in 0..40 {
        if folds == 1 {
            break;
        }
        let world = random(&mut generator, number % 2 == 0, 20.0);
        let own = axle(&study(&world, "[motion]\nheave = [0.0]\n")).axle;
        for (end, place) in own.limits().unwrap().rack.unwrap().into_iter().zip([0, 1]) {
            let RangeEnd::Fold(limit) = end.end else {
                continue;
            };
            folds += 1;
            with_lift += usize::from(limit.by_drive.abs() > 0.01);
            let rigid = own.left.mechanism.rigid_axle.as_ref().unwrap();
            let id = |name: &str| own.left.mechanism.point(name).unwrap().0;
            let mut ways: Vec<_> = own
                .left
                .design
                .iter()
                .map(|_| generator.vector(1.0))
                .collect();
            // The end of the drag link on the steering gear has a hardpoint and a displaced position. Both move together.
            let mut free = ways.clone();
            let end = id("drag_link_place");
            ways[end] = ways[id("drag_link_body")];
            free[end] = Vector3::default();
            let at = |step: f64| {
                let mut axle = own.clone();
                for (place, way) in axle.left.design.iter_mut().zip(&ways) {
                    *place = *place + *way * step;
                }
                let right = &mut axle.right.as_mut().unwrap().design;
                rigid.turn_over(&axle.left.design, right);
                let ends = axle.limits().unwrap().rack.unwrap();
                assert!(matches!(ends[place].end, RangeEnd::Fold(_)));
                ends[place].value
            };
            let h = 0.02;
            let slope = fourth_order([-2.0, -1.0, 1.0, 2.0].map(|step| at(step * h)), h);
            let pairs = limit.gradient.iter().zip(&free);
            let exact: f64 = pairs.map(|(by, way)| by.dot(*way)).sum();
            assert!(
                (slope - exact).abs() < 1e-6 * exact.abs().max(1.0),
                "{number}: {slope} {exact} {}",
                limit.by_drive
            );
        }
    }
    assert!(folds >= 1 && with_lift > 0, "{folds} {with_lift}");
}

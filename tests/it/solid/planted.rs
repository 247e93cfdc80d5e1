//! Tests of the end of travel of axles for which the test constructs this end.
//!
//! In heave, a symmetric axle moves in the side view. Its travel reverses (a fold) where the lines of the lower and the
//! upper link meet straight above or below the wheel centre: there the wheel centre moves horizontally. The test
//! constructs a random axle in such a position and rotates it away: the change of height is the limit of heave. At the
//! fold the forces of both kinds of links and a vertical force at the wheel are in balance. So the horizontal components
//! of the link forces are equal and opposite.

use super::{STILL, axle, text};
use crate::support::random::Random;
use hardpoint::analyse::RangeEnd;
use hardpoint::axle::TravelRanges;
use hardpoint::mechanism::LimitCause;

/// Coordinates x and z.
type Flat = [f64; 2];

fn minus(a: Flat, b: Flat) -> Flat {
    [a[0] - b[0], a[1] - b[1]]
}

fn turned(p: Flat, angle: f64) -> Flat {
    let (sine, cosine) = angle.sin_cos();
    [cosine * p[0] + sine * p[1], cosine * p[1] - sine * p[0]]
}

/// Finds the translation at which the axle, rotated by an angle, fits both links again. Newton's method solves for both
/// lengths.
fn fitting(links: [[Flat; 2]; 2], angle: f64, near: Flat) -> Option<Flat> {
    let mut shift = near;
    for _ in 0..30 {
        let rows = links.map(|[body, own]| {
            let turned = turned(own, angle);
            let now = minus([turned[0] + shift[0], turned[1] + shift[1]], body);
            let was = minus(own, body);
            let square = |p: Flat| p[0] * p[0] + p[1] * p[1];
            [2.0 * now[0], 2.0 * now[1], square(was) - square(now)]
        });
        let [[a, b, e], [c, d, f]] = rows;
        let determinant = a * d - b * c;
        let step = [(e * d - b * f) / determinant, (a * f - e * c) / determinant];
        shift = [shift[0] + step[0], shift[1] + step[1]];
        if step[0].hypot(step[1]) < 1e-12 {
            return Some(shift);
        }
    }
    None
}

#[test]
fn planted_folds_of_heave_are_found_and_named() {
    find_planted(60);
}

#[test]
#[ignore = "takes minutes"]
fn two_thousand_planted_folds_of_heave_are_found_and_named() {
    find_planted(2000);
}

fn find_planted(folds: usize) {
    let mut random = Random(200);
    let mut planted = 0;
    while planted < folds {
        let mut near = |centre: f64, by: f64| centre + by * random.signed();
        // At the fold, the lines of both links meet at a point straight above or below the wheel centre.
        let centre = [near(0.0, 20.0), near(335.0, 20.0)];
        let (lower, upper) = (
            [near(-60.0, 30.0), near(230.0, 30.0)],
            [near(60.0, 30.0), near(480.0, 30.0)],
        );
        let meeting = [centre[0], near(360.0, 90.0)];
        let lengths = [near(480.0, 120.0), near(320.0, 80.0)];
        let turn = near(0.0, 0.12);
        let splay = [
            near(430.0, 30.0),
            near(530.0, 30.0),
            near(470.0, 30.0),
            near(150.0, 30.0),
        ];
        let body = |own: Flat, length: f64| {
            let along = minus(meeting, own);
            let norm = along[0].hypot(along[1]);
            let sign = along[0].signum();
            [
                own[0] + sign * length * along[0] / norm,
                own[1] + sign * length * along[1] / norm,
            ]
        };
        let links = [
            [body(lower, lengths[0]), lower],
            [body(upper, lengths[1]), upper],
        ];
        let steep = links.iter().any(|[a, b]| {
            let d = minus(*a, *b);
            d[0].abs() < 0.3 * d[0].hypot(d[1])
        });
        if turn.abs() < 0.02 || steep {
            continue;
        }
        // Rotates the axle away from the fold in ten steps. In every step, the wheel centre must move away from its
        // extreme height.
        let (mut shift, mut heights) = ([0.0; 2], vec![centre[1]]);
        for step in 1..=10 {
            let angle = turn * f64::from(step) / 10.0;
            let Some(found) = fitting(links, angle, shift) else {
                break;
            };
            shift = found;
            heights.push(turned(centre, angle)[1] + shift[1]);
        }
        let falls = heights.windows(2).all(|w| w[1] < w[0]);
        let rises = heights.windows(2).all(|w| w[1] > w[0]);
        if heights.len() < 11 || !(falls || rises) {
            continue;
        }
        let limit = centre[1] - heights[10];
        let moved = |p: Flat| {
            let p = turned(p, turn);
            [p[0] + shift[0], p[1] + shift[1]]
        };
        let at = |p: Flat, y: f64| [p[0], y, p[1]];
        let points = [
            ("lower_link_chassis", at(links[0][0], splay[0])),
            ("lower_link_axle", at(moved(lower), splay[1])),
            ("upper_link_chassis", at(links[1][0], splay[2])),
            ("upper_link_axle", at(moved(upper), splay[3])),
            ("wheel_centre", at(moved(centre), 755.0)),
        ];
        let study = axle(&text(&points, false, STILL));
        let limits = study.axle.limits().unwrap();
        let TravelRanges::OfAxle { heave, .. } = &limits.travels else {
            panic!("a solid axle");
        };
        let end = if limit > 0.0 {
            &heave.upper
        } else {
            &heave.lower
        };
        let RangeEnd::Fold(found) = end else {
            panic!("{points:?}: {end:?}");
        };
        let error = (found.value - limit).abs() / limit.abs().max(1.0);
        assert!(error < 1e-8, "{points:?}: {} {limit}", found.value);
        assert_eq!(found.cause, LimitCause::AxleFolds);
        // The horizontal components of both link forces are equal, so the steeper link has the larger force.
        let level = |[body, own]: [Flat; 2], apart: f64| {
            let d = minus(body, own);
            (d[0] / (d[0] * d[0] + d[1] * d[1] + apart * apart).sqrt()).abs()
        };
        let (of_lower, of_upper) = (
            level(links[0], splay[0] - splay[1]),
            level(links[1], splay[2] - splay[3]),
        );
        let name = study.axle.left.mechanism.name(found.dependent[0]);
        if (of_lower / of_upper - 1.0).abs() > 1e-6 {
            let wanted = if of_lower < of_upper {
                "lower_link"
            } else {
                "upper_link"
            };
            assert!(name.contains(wanted), "{name}, not {wanted}");
        }
        planted += 1;
    }
}

/// An axle has positions inside its limits of roll and none beyond. The message for a position beyond names the end of
/// roll.
#[test]
fn roll_ends_where_the_links_fold() {
    use hardpoint::axle::{AxleSolver, Placement};
    let study = axle(&super::study_of(&super::case("solid_four_link"), STILL));
    let limits = study.axle.limits().unwrap();
    let TravelRanges::OfAxle {
        half_difference, ..
    } = &limits.travels
    else {
        panic!("a solid axle");
    };
    let mut solver = AxleSolver::<1>::new(&study.axle, &[], false).unwrap();
    for (end, sign) in [
        (&half_difference.lower, -1.0),
        (&half_difference.upper, 1.0),
    ] {
        let value = end.value();
        assert!(value * sign > 0.0, "{value}");
        let mut at = |share: f64| {
            let placement = Placement::Travels {
                travels: [share * value, -share * value],
                rack: 0.0,
                on_plane: false,
            };
            solver.place(&placement)
        };
        assert!(at(1.0 - 1e-6).is_ok());
        let failure = at(1.0 + 1e-6).unwrap_err().to_string();
        assert!(failure.contains("axle at a travel difference"), "{failure}");
    }
}

/// A wide axle on long links rolls until it is nearly upright. The program finds both limits, and the axle has
/// positions just before them.
#[test]
fn wide_axles_have_limits_of_roll() {
    use hardpoint::axle::{AxleSolver, Placement};
    let points = [
        ("lower_link_chassis", [900.0, 350.0, 380.0]),
        ("lower_link_axle", [0.0, 420.0, 360.0]),
        ("upper_link_chassis", [800.0, 420.0, 560.0]),
        ("upper_link_axle", [20.0, 90.0, 620.0]),
        ("wheel_centre", [0.0, 850.0, 450.0]),
    ];
    let study = axle(&text(&points, false, STILL));
    let limits = study.axle.limits().unwrap();
    let mut solver = AxleSolver::<1>::new(&study.axle, &[], false).unwrap();
    let TravelRanges::OfAxle {
        half_difference, ..
    } = &limits.travels
    else {
        panic!("an axle of one body");
    };
    let most = half_difference.upper.value();
    for sign in [-1.0, 1.0] {
        let mut before = 0.0;
        for degrees in [20.0_f64, 50.0, 70.0, 85.0] {
            let placed = solver.place(&Placement::Roll {
                heave: 0.0,
                roll: sign * degrees.to_radians(),
                rack: 0.0,
            });
            // Half the difference of travels grows up to the limit.
            let [left, right] = placed.unwrap().travels;
            assert!((left + right).abs() < 1e-9, "{left} {right}");
            let half = 0.5 * sign * (right - left);
            assert!((before..most).contains(&half), "{degrees}: {half} {most}");
            before = half;
        }
        // At 85 degrees, half a per cent of the range remains.
        assert!(before > 0.99 * most, "{before} {most}");
    }
    // The axle is almost upright at that limit.
    for end in limits.roll {
        let roll = end.expect("the limit is known").value;
        assert!((1.4..1.7).contains(&roll.abs()), "{roll}");
    }
}

//! Tests of limits of roll: an axle can roll up to its limit and not beyond. The part that limits the roll angle also
//! limits the difference of the travels.

use crate::support::random::Random;
use hardpoint::analyse::RangeEnd;
use hardpoint::axle::{Axle, AxleLimits, AxleSolver, Placement, TravelRanges};
use hardpoint::mechanism::LimitCause;
use hardpoint::study::Study;
use std::path::Path;

/// Topologies of the command `new` with their options: solid axles, and the twist beam.
const AXLES: [(&str, &str); 6] = [
    ("solid_axle", ""),
    ("solid_axle", "panhard"),
    ("solid_axle", "watt"),
    ("solid_axle", "drag_link"),
    ("solid_axle", "watt,drag_link"),
    ("twist_beam", ""),
];

fn templates() -> impl Iterator<Item = (String, Axle)> {
    AXLES.into_iter().map(|(topology, with)| {
        let parts: Vec<String> = with.split(',').map(str::to_owned).collect();
        let parts = if with.is_empty() { Vec::new() } else { parts };
        let text = hardpoint::cli::template(topology, &parts).unwrap();
        let study = Study::from_text("axle.toml", &text, Path::new(""));
        let study = study.unwrap_or_else(|errors| panic!("{topology} with {with}: {errors}"));
        let name = format!("{topology} with {with}");
        (name, study.axle().unwrap().axle.clone())
    })
}

/// Moves all points of the left half by up to this distance along each axis. The right half follows.
fn scattered(axle: &Axle, most: f64, random: &mut Random) -> Axle {
    let mut moved = axle.clone();
    let rigid = axle.left.mechanism.rigid_axle.as_ref().unwrap();
    // Points of the right half follow those of the left half.
    let mut design = random.scattered(&axle.left.design, most);
    rigid.complete(&axle.left.design, &mut design);
    if let Some(right) = &mut moved.right {
        rigid.turn_over(&design, &mut right.design);
    }
    moved.left.design = design;
    moved
}

fn rolled(axle: &Axle, roll: f64) -> bool {
    let placement = Placement::Roll {
        heave: 0.0,
        roll,
        rack: 0.0,
    };
    let mut solver = AxleSolver::<1>::new(axle, &[], false).unwrap();
    solver.place(&placement).is_ok()
}

/// Returns the limits of the roll angle, and of the travel difference in the same direction.
fn ends(limits: &AxleLimits) -> [Option<(f64, &RangeEnd, &RangeEnd)>; 2] {
    let TravelRanges::OfAxle {
        half_difference, ..
    } = &limits.travels
    else {
        panic!("an axle of one body");
    };
    // In positive roll (as in a left turn), the left wheel is in droop.
    let of_travel = [&half_difference.upper, &half_difference.lower];
    let mut of_roll = limits.roll.iter();
    of_travel.map(|travel| {
        let end = of_roll.next().unwrap().as_ref()?;
        Some((end.value, &end.end, travel))
    })
}

/// Each axle rolls to 0.97 of its limit, and not to 1.001 of it. The program finds this limit for the template and for eleven
/// axles with points moved by up to 20 mm.
#[test]
fn axles_of_each_kind_roll_up_to_their_limits() {
    let mut random = Random(46);
    for (name, template) in templates() {
        for number in 0..12 {
            let axle = if number == 0 {
                template.clone()
            } else {
                scattered(&template, 20.0, &mut random)
            };
            let limits = axle.limits().unwrap();
            for end in ends(&limits) {
                let (roll, of_roll, of_travel) =
                    end.unwrap_or_else(|| panic!("{name} {number}: an unknown limit"));
                assert!(rolled(&axle, roll * 0.97), "{name} {number}: {roll}");
                assert!(!rolled(&axle, roll * 1.001), "{name} {number}: {roll}");
                match (of_roll, of_travel) {
                    (RangeEnd::Fold(of_roll), RangeEnd::Fold(of_travel)) => {
                        assert_eq!(of_roll.dependent, of_travel.dependent, "{name} {number}");
                    }
                    _ => assert_eq!(of_roll, of_travel, "{name} {number}"),
                }
            }
        }
    }
}

/// The halves of a twist beam differ, so its paths in heave turn back before the arms are vertical. The limits have the
/// reason that curves have beyond them.
#[test]
fn heave_limits_of_a_skewed_beam_have_the_reason_of_its_curves() {
    let text = include_str!("../../../studies/twist_beam_solve.toml");
    let start = text.find("roll = {").unwrap();
    let end = text[start..].find("\n[outputs]").unwrap() + start;
    let heaves = "heave = [-400.0, 0.0, 460.0]\n";
    let text = format!("{}{heaves}{}", &text[..start], &text[end..]);
    let right = "[axle.right.hardpoints]\nmount = [412.0, -530.0, 340.0]\n\n[wheel]";
    let text = text.replacen("\n[wheel]", &format!("\n{right}"), 1);
    let study = Study::from_text("beam.toml", &text, Path::new("")).unwrap();
    let limits = study.axle().unwrap().axle.limits().unwrap();
    let TravelRanges::OfAxle { heave, .. } = &limits.travels else {
        panic!("an axle of one body");
    };
    let failures = hardpoint::solved::Solved::of(&study).unwrap().failures();
    assert_eq!(failures.len(), 2);
    for (end, failure) in [&heave.lower, &heave.upper].into_iter().zip(&failures) {
        let RangeEnd::Fold(limit) = end else {
            panic!("{end:?}");
        };
        let failure = failure.to_string();
        assert!(failure.contains(limit.cause.words()), "{failure} {limit:?}");
        assert_eq!(limit.cause, LimitCause::Unresolved);
    }
}

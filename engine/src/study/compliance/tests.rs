//! `tests` of `[compliance]`.

use super::super::error::Problems;
use super::super::file;
use super::super::names::{choose, choose_or};
use super::super::resolve::each;
use super::super::suspension::above_zero;
use super::super::value::Text;
use crate::compliance::{HeldQuantity, KcTest, TestLoad};
use crate::model::Suspension;
use toml::Spanned;

/// The most levels of a test.
const MOST_LEVELS: i64 = 1001;

/// The tests of `[compliance]`, or the default ones.
pub(super) fn tests(
    section: &Spanned<file::Compliance>,
    suspension: &Suspension,
    has_spring: bool,
    problems: &mut Problems,
) -> Option<Vec<KcTest>> {
    let Some(list) = &section.get_ref().tests else {
        return Some(KcTest::defaults(false, has_spring, suspension.length_unit));
    };
    let tests = each(list.get_ref(), |written| {
        test(written, suspension, has_spring, problems)
    })?;
    for (k, test) in tests.iter().enumerate() {
        let same = |other: &KcTest| {
            (other.load, other.trail, other.held) == (test.load, test.trail, test.held)
        };
        if let Some(first) = tests[..k].iter().position(same) {
            let error = problems.add(list.get_ref()[k].span(), "this test is there already");
            error.related(list.get_ref()[first].span(), "first here");
            return None;
        }
    }
    Some(tests)
}

fn test(
    written: &Spanned<file::ComplianceTest>,
    suspension: &Suspension,
    has_spring: bool,
    problems: &mut Problems,
) -> Option<KcTest> {
    let part = written.get_ref();
    let load = choose(&part.load, "test load", &TestLoad::ALL, problems)?;
    let not_yet = [
        (
            &part.mode,
            "mode is of both wheels of an axle, which is not available yet",
        ),
        (&part.steering, "steering is not available yet"),
    ];
    for (key, message) in not_yet {
        if let Some(key) = key {
            return problems.refuse(key.span(), message);
        }
    }
    let mut test = KcTest::new(load, suspension.length_unit);
    let of_loads = [
        ("hold", part.hold.as_ref().map(Text::span)),
        ("window", part.window.as_ref().map(|n| n.span.clone())),
        ("levels", part.levels.as_ref().map(Spanned::span)),
    ];
    for (key, span) in of_loads {
        if let (Some(span), true) = (span, load.is_motion()) {
            let message = format!("{key} is of loads; {} is a motion", load.name());
            return problems.refuse(span, &message);
        }
    }
    if let Some(trail) = &part.trail {
        if load != TestLoad::Lateral {
            return problems.refuse(trail.span.clone(), "trail is of load = \"lateral\"");
        }
        if trail.value < 0.0 {
            let message = format!("expected 0 or more, found {}", trail.value);
            return problems.refuse(trail.span.clone(), &message);
        }
        test.trail = trail.value;
    }
    let holds = [
        ("wheel_height", HeldQuantity::WheelHeight),
        ("wheel_load", HeldQuantity::WheelLoad),
    ];
    test.held = choose_or(&part.hold, test.held, "value of hold", &holds, problems)?;
    let place = part.hold.as_ref().map_or(written.span(), Text::span);
    if load == TestLoad::Vertical && test.held == HeldQuantity::WheelHeight {
        let message = "a vertical load moves the wheel: expected hold = \"wheel_load\", or no hold";
        return problems.refuse(place, message);
    }
    if test.held == HeldQuantity::WheelLoad && !has_spring {
        let message = "the wheel load needs [spring]: nothing else carries it";
        return problems.refuse(place, message);
    }
    if let Some(window) = &part.window {
        test.window = above_zero(window, problems)?;
    }
    if let Some(levels) = &part.levels {
        let count = *levels.get_ref();
        if !(3..=MOST_LEVELS).contains(&count) || count % 2 == 0 {
            let message = format!("expected an odd number from 3 to {MOST_LEVELS}, found {count}");
            return problems.refuse(levels.span(), &message);
        }
        test.levels = (count / 2) as usize;
    }
    let stations = [("nearest", false), ("all", true)];
    test.at_all_stations = choose_or(
        &part.stations,
        false,
        "value of stations",
        &stations,
        problems,
    )?;
    Some(test)
}

//! `tests` of `[compliance]`.

use super::super::error::Problems;
use super::super::file;
use super::super::names::{choose, choose_or};
use super::super::resolve::each;
use super::super::suspension::above_zero;
use super::super::value::Text;
use crate::compliance::{HeldQuantity, KcTest, TestLoad, TestMode};
use crate::model::{Side, Suspension};
use crate::number::Each;
use toml::Spanned;

/// Largest number of load values in a test.
const MOST_LEVELS: i64 = 1001;

/// Tests of `[compliance]` for one wheel, or the default tests.
pub(super) fn tests(
    section: &Spanned<file::Compliance>,
    suspension: &Suspension,
    has_spring: bool,
    problems: &mut Problems,
) -> Option<Vec<KcTest>> {
    let Some(list) = &section.get_ref().tests else {
        return Some(KcTest::defaults(false, has_spring, suspension.length_unit));
    };
    refuse_none(list, problems)?;
    let tests = each(list.get_ref(), |written| {
        refuse_of_axles(written.get_ref(), problems)?;
        test(written, suspension, has_spring, problems)
    })?;
    refuse_twins(list.get_ref(), &tests, problems)?;
    Some(tests)
}

/// Refuses a list without tests.
fn refuse_none(
    list: &Spanned<Vec<Spanned<file::ComplianceTest>>>,
    problems: &mut Problems,
) -> Option<()> {
    if list.get_ref().is_empty() {
        let message = "expected at least one test, found an empty list; a study without the key \
                       has the usual tests";
        return problems.refuse(list.span(), message);
    }
    Some(())
}

/// Refuses loads and keys that concern both wheels in a study of one wheel.
fn refuse_of_axles(written: &file::ComplianceTest, problems: &mut Problems) -> Option<()> {
    let is_roll = written.load.get_ref() == TestLoad::Roll.name();
    let keys = [
        ("load = \"roll\"", Some(&written.load).filter(|_| is_roll)),
        ("mode", written.mode.as_ref()),
        ("steering", written.steering.as_ref()),
        ("anti_roll_bar", written.anti_roll_bar.as_ref()),
    ];
    for (key, text) in keys {
        if let Some(text) = text {
            let message = format!("{key} describes both wheels: it needs [axle]");
            return problems.refuse(text.span(), &message);
        }
    }
    Some(())
}

/// Names for the state of the anti-roll bar in a test.
const BAR: [(&str, bool); 2] = [("connected", true), ("disconnected", false)];

/// Tests of `[compliance]` for an axle, or the default tests.
pub(super) fn tests_of_axle(
    section: &Spanned<file::Compliance>,
    suspension: &Suspension,
    has_spring: bool,
    steers: bool,
    problems: &mut Problems,
) -> Option<Vec<KcTest>> {
    let bar = &section.get_ref().anti_roll_bar;
    let has_bar = choose_or(bar, true, "state of the bar", &BAR, problems)?;
    let Some(list) = &section.get_ref().tests else {
        let length = suspension.length_unit;
        let mut tests = KcTest::defaults_of_axle(false, has_spring, steers, length);
        tests.iter_mut().for_each(|test| test.has_bar = has_bar);
        return Some(tests);
    };
    refuse_none(list, problems)?;
    let mut tests = Vec::new();
    for written in list.get_ref() {
        let found = test(written, suspension, has_spring, problems)?;
        let before = tests.len();
        tests.extend(in_modes(
            written.get_ref(),
            found,
            has_bar,
            steers,
            problems,
        )?);
        let (old, new) = tests.split_at(before);
        if new
            .iter()
            .any(|test| old.iter().any(|other| is_twin(test, other)))
        {
            return problems.refuse(written.span(), "this test already exists");
        }
    }
    Some(tests)
}

/// Expands a test by its mode: a test of single wheels becomes one test for each wheel.
fn in_modes(
    written: &file::ComplianceTest,
    test: KcTest,
    has_bar: bool,
    steers: bool,
    problems: &mut Problems,
) -> Option<Vec<KcTest>> {
    if test.load == TestLoad::Steering && !steers {
        let message = "this test needs steered wheels, but no hardpoint of this axle is on a rack";
        return problems.refuse(written.load.span(), message);
    }
    let both: &[TestMode] = &[TestMode::Parallel];
    let modes = [
        ("parallel", both),
        ("opposed", &[TestMode::Opposed]),
        ("single", &Side::ALL.each(TestMode::Single)),
    ];
    if let (Some(mode), true) = (&written.mode, test.load.is_motion()) {
        let message = format!(
            "the key \"mode\" works with loads; {} is a motion",
            test.load.name()
        );
        return problems.refuse(mode.span(), &message);
    }
    let modes = choose_or(&written.mode, both, "mode", &modes, problems)?;
    let has_bar = choose_or(
        &written.anti_roll_bar,
        has_bar,
        "state of the bar",
        &BAR,
        problems,
    )?;
    let locks = [("locked_wheel", false), ("locked_rack", true)];
    let locks_rack = choose_or(
        &written.steering,
        false,
        "value of steering",
        &locks,
        problems,
    )?;
    let of = |mode: &TestMode| KcTest {
        mode: *mode,
        has_bar,
        locks_rack,
        ..test
    };
    Some(modes.iter().map(of).collect())
}

/// Returns true if the results of two tests have the same names.
fn is_twin(a: &KcTest, b: &KcTest) -> bool {
    let key = |t: &KcTest| {
        (
            t.load,
            t.trail_suffix(),
            t.held,
            t.mode,
            t.has_bar,
            t.locks_rack,
        )
    };
    key(a) == key(b)
}

fn refuse_twins(
    list: &[Spanned<file::ComplianceTest>],
    tests: &[KcTest],
    problems: &mut Problems,
) -> Option<()> {
    for (k, test) in tests.iter().enumerate() {
        if let Some(first) = tests[..k].iter().position(|other| is_twin(test, other)) {
            let error = problems.add(list[k].span(), "this test already exists");
            error.related(list[first].span(), "first here");
            return None;
        }
    }
    Some(())
}

fn test(
    written: &Spanned<file::ComplianceTest>,
    suspension: &Suspension,
    has_spring: bool,
    problems: &mut Problems,
) -> Option<KcTest> {
    let part = written.get_ref();
    let load = choose(&part.load, "test load", &TestLoad::ALL, problems)?;
    let mut test = KcTest::new(load, suspension.length_unit);
    let of_loads = [
        ("hold", part.hold.as_ref().map(Text::span)),
        ("window", part.window.as_ref().map(|n| n.span.clone())),
        ("levels", part.levels.as_ref().map(Spanned::span)),
    ];
    for (key, span) in of_loads {
        if let (Some(span), true) = (span, load.is_motion()) {
            let message = format!(
                "the key {key} works with loads; {} is a motion",
                load.name()
            );
            return problems.refuse(span, &message);
        }
    }
    if let Some(trail) = &part.trail {
        if load != TestLoad::Lateral {
            return problems.refuse(
                trail.span.clone(),
                "the key \"trail\" works with load = \"lateral\" only",
            );
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

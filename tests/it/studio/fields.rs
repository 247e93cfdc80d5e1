//! Tests of fields and handles of points: typed text, touch, and the right half of a solid axle.

use super::browser::{READY, SETTLED, assert_drawn_as_solved, handle};
use super::webdriver::Browser;
use super::{Served, sample};
use serde_json::{Value, json};

/// Opens the live page of a sample study.
fn opened(name: &str) -> Option<(Browser, Served)> {
    let browser = Browser::start()?;
    let served = Served::of(&sample(name));
    browser.open(&served.address);
    browser.wait(READY);
    browser.wait(SETTLED);
    Some((browser, served))
}

/// Coordinates of a point in the present design.
fn design(browser: &Browser, point: &str) -> [f64; 3] {
    let found = browser.run(&format!(
        "const p = studio.state.overview.points.findIndex(({{ name }}) => name === {point:?}); return studio.state.design[p]"
    ));
    [0, 1, 2].map(|k| found[k].as_f64().unwrap())
}

/// If the table is renewed while the user types a coordinate, the typed text stays.
#[test]
fn typed_text_stays_while_the_table_is_renewed() {
    let Some((browser, _served)) = opened("macpherson_front.toml") else {
        return;
    };
    browser.click("#tab-points");
    let field = "document.querySelector('input[aria-label=\"strut_lower y\"]')";
    browser.run(&format!("{field}.focus(); {field}.select()"));
    for key in ["6", "2", "3", ".", "3", "7"] {
        browser.keys(&[key]);
        browser.run("dispatchEvent(new Event('beforeprint'))");
    }
    assert_eq!(
        browser.run(&format!("return {field}.value")),
        json!("623.37")
    );
    browser.keys(&["\u{e007}"]);
    browser.wait(SETTLED);
    assert_eq!(design(&browser, "strut_lower")[1], 623.37);
    // The field follows the design again after an arrow key, and after the user cancels the text.
    browser.keys(&["\u{e013}"]);
    browser.wait(SETTLED);
    let value = design(&browser, "strut_lower")[1];
    assert!(value > 623.37);
    let shown = browser.run(&format!("return Number({field}.value)"));
    assert_eq!(shown, json!(value));
    browser.keys(&["9", "\u{e00c}"]);
    browser.run(&format!("{field}.focus()"));
    assert_eq!(
        browser.run(&format!("return Number({field}.value)")),
        json!(value)
    );
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// A finger moves a point as the mouse does, and the saved study has the drawn curves.
#[test]
fn a_finger_moves_a_point() {
    let Some((browser, served)) = opened("macpherson_front.toml") else {
        return;
    };
    let before = design(&browser, "lower_ball_joint");
    browser.touch(&handle("front", "lower_ball_joint"), [14, -9], 4);
    browser.wait(SETTLED);
    let after = design(&browser, "lower_ball_joint");
    assert_eq!(before[0], after[0]);
    assert!(before[1] != after[1] && after[2] > before[2], "{after:?}");
    browser.click("#save");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    browser.wait(SETTLED);
    assert!(assert_drawn_as_solved(&browser, &served.study) >= 2);
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// The right half of a solid axle follows the left half. It has no input fields, and its handles move the left half.
#[test]
fn the_right_half_of_a_solid_axle_follows() {
    let Some((browser, served)) = opened("solid_axle_rear.toml") else {
        return;
    };
    let shown = |selector: &str| {
        browser.run(&format!(
            "return [...document.querySelectorAll({selector:?})].filter((e) => e.checkVisibility()).length"
        ))
    };
    browser.click("#tab-points");
    let rows = "#coordinates tbody tr";
    assert!(shown(rows).as_u64().unwrap() >= 6);
    let of_right = browser.run(&format!(
        "return [...document.querySelectorAll({rows:?})].filter((e) => e.checkVisibility() && e.textContent.includes('right_')).length"
    ));
    assert_eq!(of_right, json!(0));
    let of_right = browser.run(
        "return [...document.querySelectorAll('.handle[data-name^=right_]')].filter((e) => getComputedStyle(e).display !== 'none').map((e) => e.dataset.name)",
    );
    assert_eq!(of_right, json!([]));
    let before = design(&browser, "lower_link_axle");
    browser.drag(
        "[data-view=front] .handle[data-name=lower_link_axle][data-other]",
        [0, -12],
        4,
    );
    browser.wait(SETTLED);
    let after = design(&browser, "lower_link_axle");
    assert!(after[2] > before[2] + 1.0, "{before:?} {after:?}");
    let moved = browser.run("return studio.state.answer.status");
    assert_ne!(moved, Value::from("failed"));
    browser.click("#save");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    browser.wait(SETTLED);
    assert!(assert_drawn_as_solved(&browser, &served.study) >= 2);
    let text = std::fs::read_to_string(&served.study).unwrap();
    let written = text
        .lines()
        .find(|line| line.trim_start().starts_with("lower_link_axle"));
    assert!(
        written.is_some_and(|line| line.contains(&after[2].to_string())),
        "{written:?} {after:?}"
    );
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// No field truncates its number and no chip its text, in a normal and a wide window and on a phone. On a phone the
/// table of points has its headings.
#[test]
fn fields_are_as_wide_as_their_numbers() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let long = sample("macpherson_front.toml").replace("-260.0, 350.0", "-260.2362, 350.2362");
    let many = sample("double_wishbone_axle.toml").replace("steps = 9", "steps = 2049");
    for served in [
        super::car::served("car", super::car::as_it_is),
        Served::of(&long),
        Served::of(&many),
    ] {
        for width in [1400, 1920, 390] {
            browser.size(width, 900);
            browser.open(&served.address);
            browser.wait(READY);
            browser.wait(SETTLED);
            for tab in ["points", "targets", "constraints", "parts"] {
                browser.click(&format!("#tab-{tab}"));
                let cut = browser.run(
                    "return [...document.querySelectorAll('input[type=text], .chip .value, .chip b')] \
                     .filter((e) => e.checkVisibility() && e.scrollWidth > e.clientWidth + 1).map((e) => e.value ?? e.textContent)",
                );
                assert_eq!(cut, json!([]), "{width} {tab}");
            }
            browser.click("#tab-points");
            let headings = browser.run(
                "return [...document.querySelectorAll('#coordinates thead th')].filter((e) => e.checkVisibility() && e.offsetWidth > 20).map((e) => e.textContent).join()",
            );
            assert!(headings.as_str().unwrap().contains("x ["), "{headings}");
        }
        browser.size(1440, 900);
        browser.open("about:blank");
    }
}

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

/// Coordinates of a point in the current design.
fn design(browser: &Browser, point: &str) -> [f64; 3] {
    let found = browser.run(&format!(
        "const p = studio.state.overview.points.findIndex(({{ name }}) => name === {point:?}); return studio.state.design[p]"
    ));
    [0, 1, 2].map(|k| found[k].as_f64().unwrap())
}

/// The user types a coordinate, and the page updates the table. The typed text stays.
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
    // The field shows the design's current value again after an arrow key, or after the user cancels the typing.
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

/// The points of the right half of a solid axle move with those of the left half. The right half has no input fields,
/// and its handles move the left half.
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

/// No field truncates its number, and no label truncates its text. This holds in a normal window, in a wide window and
/// on a phone. On a phone, the table of points has its headings.
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

/// Every field for a number refuses a text that is no decimal number, with the reason in words.
#[test]
fn a_text_that_is_no_number_is_refused_in_words() {
    let Some((browser, served)) = opened("macpherson_front.toml") else {
        return;
    };
    let before = design(&browser, "strut_lower");
    let banner = "document.getElementById('banner')";
    browser.click("#tab-points");
    let field = "document.querySelector('input[aria-label=\"strut_lower y\"]')";
    for text in ["0x64", "0b11", "1e999", "Infinity", "12 mm", ""] {
        browser.run(&format!("{field}.focus(); {field}.select()"));
        browser.keys(&["\u{e017}"]);
        let letters: Vec<String> = text.chars().map(String::from).collect();
        browser.keys(&letters.iter().map(String::as_str).collect::<Vec<_>>());
        browser.keys(&["\u{e007}"]);
        assert_eq!(design(&browser, "strut_lower"), before, "{text}");
        let said = browser.run(&format!(
            "return [{field}.getAttribute('aria-invalid'), {field}.title, {banner}.textContent, {banner}.hidden]"
        ));
        assert_eq!(said[0], json!("true"), "{text}");
        let reason = if text.is_empty() { "is empty" } else { text };
        for place in [1, 2] {
            let words = said[place].as_str().unwrap();
            assert!(
                words.contains("strut_lower y") && words.contains(reason),
                "{words}"
            );
        }
        assert_eq!(said[3], json!(false));
        // When the user goes to the next field, the refused field shows the earlier coordinate again. The message
        // stays.
        browser.keys(&["\u{e004}"]);
        let shown = browser.run(&format!(
            "return [{field}.value, {field}.classList.contains('wrong'), {banner}.hidden]"
        ));
        assert_eq!(
            shown,
            json!([before[1].to_string(), false, false]),
            "{text}"
        );
    }
    // A comma and a minus sign are parts of a number.
    browser.run(
        "const f = document.querySelector('input[aria-label=\"strut_lower x\"]'); f.focus(); f.value = '\u{2212}3,5e0'; \
         f.dispatchEvent(new Event('input')); f.dispatchEvent(new Event('change'))",
    );
    assert_eq!(design(&browser, "strut_lower")[0], -3.5);
    assert_eq!(
        browser.run(&format!("return {banner}.hidden")),
        json!(false)
    );
    browser.wait(SETTLED);
    browser.click("#tab-targets");
    let said = browser.run(
        "const f = document.querySelector('[data-target] input[aria-label$=tolerance]'); f.value = '0x2'; f.dispatchEvent(new Event('change')); \
         return [f.getAttribute('aria-invalid'), f.title]",
    );
    assert_eq!(said[0], json!("true"));
    assert!(said[1].as_str().unwrap().contains("0x2"), "{said}");
    let text = std::fs::read_to_string(&served.study).unwrap();
    assert_eq!(text, sample("macpherson_front.toml"));
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// The page compares the design with a saved state, and the legend names this state: "as opened", or "saved" after a
/// save. If a name is refused, the dialog stays open with the typed text.
#[test]
fn words_follow_a_save() {
    let Some((browser, served)) = opened("macpherson_front.toml") else {
        return;
    };
    let legend = || browser.run("return document.getElementById('key-ghost').textContent");
    assert_eq!(legend(), json!("as opened"));
    browser.drag(&handle("front", "lower_ball_joint"), [10, -9], 4);
    browser.wait(SETTLED);
    browser.click("#save");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    assert_eq!(legend(), json!("saved"));
    browser.click("#save-as");
    let field = "document.querySelector('#dialog input')";
    browser.run(&format!("{field}.value = 'a/b.toml'"));
    browser.click("#dialog button[value=ok]");
    browser.wait("!document.querySelector('#dialog .bad').hidden");
    assert_eq!(
        browser.run(&format!("return {field}.value")),
        json!("a/b.toml")
    );
    browser.run(&format!("{field}.value = 'other.toml'"));
    browser.click("#dialog button[value=ok]");
    browser.wait("document.getElementById('banner').textContent.includes('other.toml written')");
    assert!(served.files().contains(&"other.toml".to_owned()));
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// While the user drags an edge of a band, the page shows the value of the edge beside it. If the user drags a locked
/// point, the page says that the point is locked, and does not move the point. The axis of a chart shows the bands of
/// its targets.
#[test]
fn a_drag_says_what_it_does() {
    let Some((browser, _served)) = opened("macpherson_sweep.toml") else {
        return;
    };
    // The band of a target reaches beyond its curve, and lies within the picture.
    let outside = browser.run(
        "return [...document.querySelectorAll('.chart .bands path')].flatMap((path) => { const [a, b] = [path, path.closest('svg').querySelector('clipPath rect')].map((e) => e.getBBox()); \
         return a.height && (a.y < b.y - 0.5 || a.y + a.height > b.y + b.height + 0.5) ? [[a.y, a.height, b.y, b.height]] : [] })",
    );
    assert_eq!(outside, json!([]));
    browser.run("studio.state.locked[studio.state.overview.points.findIndex(({ name }) => name === 'tie_rod_outer')] = [true, true, true]");
    let before = design(&browser, "tie_rod_outer");
    let word = |browser: &Browser| {
        browser.run("return [...document.querySelectorAll('[data-view=front] .words text')].map((t) => t.textContent).find((t) => t.startsWith('tie_rod_outer'))")
    };
    browser.press(&handle("front", "tie_rod_outer"), [12, 5]);
    let said = word(&browser);
    assert!(said.as_str().unwrap().contains("locked"), "{said}");
    browser.release();
    assert_eq!(design(&browser, "tie_rod_outer"), before);
    let edge = ".chart .edge";
    browser.run(&format!(
        "document.querySelector({edge:?}).scrollIntoView()"
    ));
    browser.press(edge, [0, -8]);
    let shown = browser.run("const g = document.querySelector('.edge.held'); const t = g.querySelector('text'); return [getComputedStyle(t).display, t.textContent]");
    assert_ne!(shown[0], json!("none"));
    assert!(
        shown[1].as_str().unwrap().contains(['0', '1', '2', '5']),
        "{shown}"
    );
    browser.release();
    assert_eq!(browser.console(), Vec::<String>::new());
}

//! Tests of the live page with the keyboard alone, and of its announcements to a screen reader.

use super::browser::{READY, SETTLED};
use super::webdriver::Browser;
use super::{Served, sample};
use serde_json::json;

const ENTER: &str = "\u{e007}";
const ESCAPE: &str = "\u{e00c}";
const UP: &str = "\u{e013}";
const RIGHT: &str = "\u{e014}";
const F6: &str = "\u{e036}";

fn focus(browser: &Browser, selector: &str) {
    let found = browser.run(&format!(
        "const e = document.querySelector({selector:?}); e?.focus(); return document.activeElement === e"
    ));
    assert_eq!(found, true, "{selector} has no focus");
}

/// Name of the control that has the focus.
fn focused(browser: &Browser) -> String {
    let name = browser.run(
        "const e = document.activeElement; return e === document.body ? '' : e.id || e.getAttribute('aria-label') || e.textContent",
    );
    name.as_str().unwrap().to_owned()
}

fn opened(browser: &Browser) -> Served {
    let served = Served::of(&sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.wait(SETTLED);
    served
}

#[test]
fn points_targets_and_proposals_need_no_mouse() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let _served = opened(&browser);
    let design = "JSON.stringify(studio.state.design)";
    let before = browser.run(&format!("return {design}"));

    // Several keys in a row are one step. The page announces this step once, with its result.
    focus(
        &browser,
        "[data-view=front] .handle[data-name=strut_top]:not([data-other])",
    );
    browser.keys(&[UP, UP, UP]);
    browser.wait("document.getElementById('said').textContent.includes('z +0.3')");
    let said = browser.run("return document.getElementById('said').textContent");
    assert!(said.as_str().unwrap().contains("Misfit"), "{said}");
    // Moves the focus to the fields of the point, and back.
    browser.keys(&[ENTER]);
    assert_eq!(focused(&browser), "strut_top x");
    browser.keys(&[ESCAPE]);
    assert!(focused(&browser).starts_with("strut_top: x"));
    browser.run("document.getElementById('undo').click()");
    assert_eq!(browser.run(&format!("return {design}")), before);

    // Keys on a chart move the mechanism; keys on a picture move and zoom it.
    focus(&browser, ".chart");
    browser.keys(&[RIGHT]);
    browser.wait("studio.state.at[0] > 0");
    focus(&browser, "[data-view=space] .view");
    let drawn = "return document.querySelector('[data-view=space] .bodies').innerHTML";
    let picture = browser.run(drawn);
    browser.keys(&[RIGHT, "+"]);
    browser.wait(&format!(
        "document.querySelector('[data-view=space] .bodies').innerHTML !== {picture}"
    ));

    // When a dialog closes, the focus returns to the control that opened it.
    focus(&browser, "[data-column=camber_deg] .adder");
    browser.keys(&[ENTER]);
    browser.wait("document.getElementById('dialog').open");
    browser.keys(&[ESCAPE]);
    browser.wait("!document.getElementById('dialog').open");
    assert_eq!(focused(&browser), "+ target for camber");

    // A list keeps the focus when the page rebuilds it.
    browser.click("#tab-targets");
    focus(&browser, "#pane-targets .name");
    let name = focused(&browser);
    browser.keys(&[ENTER]);
    browser.wait("studio.state.arrows === 0");
    assert_eq!(focused(&browser), name);

    focus(&browser, "#tune");
    browser.keys(&[ENTER]);
    browser.wait("document.getElementById('accept')");
    assert_eq!(focused(&browser), "tab-proposal");
    browser.wait("document.getElementById('said').textContent.startsWith('Proposal: misfit')");
    focus(&browser, "#accept");
    browser.keys(&[ENTER]);
    browser.wait("document.getElementById('proposal').hidden");
    assert_eq!(focused(&browser), "tab-proposal");

    focus(&browser, "#save");
    browser.keys(&[ENTER]);
    browser.wait("!document.getElementById('banner').hidden");
    browser.keys(&[ESCAPE]);
    browser.wait("document.getElementById('banner').hidden");
    assert_eq!(focused(&browser), "save");
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// F6 cycles through the regions of the page. Every control has a name and is at least 24 pixels large. Exceptions are
/// fields within a label, and bars that react on a larger area than they show.
#[test]
fn controls_are_named_large_and_reachable() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let _served = opened(&browser);
    let mut regions = Vec::new();
    for _ in 0..5 {
        browser.keys(&[F6]);
        regions.push(focused(&browser));
    }
    assert_eq!(regions[0], regions[4], "{regions:?}");
    assert!(regions.iter().all(|name| !name.is_empty()));

    for tab in [
        "points",
        "targets",
        "constraints",
        "parts",
        "history",
        "warnings",
    ] {
        browser.click(&format!("#tab-{tab}"));
        browser.wait(SETTLED);
        let bad = browser.run(
            "const all = [...document.querySelectorAll('button, select, input, summary, a, [tabindex=\"0\"]')].filter((e) => e.checkVisibility()); \
             const name = (e) => e.getAttribute('aria-label') || e.labels?.[0]?.textContent || e.textContent || e.title; \
             const isSmall = (e) => { if (e.closest('label') || e.closest('.bar-v, .bar-h, .skip')) return false; const b = e.getBoundingClientRect(); return b.width < 23.9 || b.height < 23.9; }; \
             return all.filter((e) => !name(e).trim() || isSmall(e)).map((e) => `${e.outerHTML.slice(0, 90)} ${e.getBoundingClientRect().width} x ${e.getBoundingClientRect().height}`)",
        );
        assert_eq!(bad, json!([]), "in tab {tab}");
    }
}

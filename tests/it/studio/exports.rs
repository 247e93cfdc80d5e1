//! Tests of exported curves and of printed pages.

use super::browser::{READY, SETTLED};
use super::webdriver::Browser;
use super::{Served, sample};
use serde_json::json;
use std::process::Command;

/// Script that records the names and texts of downloads, and does not save them.
const RECORD: &str = "window.names = []; window.texts = []; \
     URL.createObjectURL = (blob) => { blob.text().then((text) => texts.push(text)); return 'about:blank'; }; \
     URL.revokeObjectURL = () => {}; HTMLAnchorElement.prototype.click = function () { names.push(this.download); };";

/// The CSV export contains the curves of the shown motion, as `hardpoint solve` writes them. The printed page names the
/// motion.
#[test]
fn the_shown_motion_is_exported_and_printed() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_steering.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.run(RECORD);
    let out = served.folder.path().join("out");
    let solved = Command::new(env!("CARGO_BIN_EXE_hardpoint"))
        .args(["solve", "--quiet", "--out"])
        .args([&out, &served.study])
        .status()
        .unwrap();
    assert!(solved.success());
    browser.run("const motion = document.getElementById('motion'); motion.value = 'left_lock'; motion.dispatchEvent(new Event('change'))");
    browser.wait(SETTLED);
    browser.click("[data-export=csv]");
    browser.wait("window.texts.length");
    let printed = std::fs::read_to_string(out.join("curves_left_lock.csv")).unwrap();
    assert_eq!(browser.run("return window.texts[0]"), json!(printed));
    assert_eq!(
        browser.run("return window.names"),
        json!(["study_left_lock.csv"])
    );
    browser.print();
    let motion = "const shown = document.getElementById('motion'); return shown.checkVisibility() && shown.value";
    assert_eq!(browser.run(motion), json!("left_lock"));
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// In exported curves, the outline of each label is drawn behind the letters. Labels are beside the lines and do not
/// overlap.
#[test]
fn labels_of_lines_can_be_read() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("twist_beam_solve.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.wait(SETTLED);
    let overlaps = browser.run(
        "return [...document.querySelectorAll('.chart')].flatMap((chart) => { \
         const box = (e) => e.getBoundingClientRect(); \
         const labels = [...chart.querySelectorAll('.labels text')].map((e) => ({ text: e.textContent, ...box(e).toJSON() })); \
         const end = Math.max(...[...chart.querySelectorAll('.now path')].map((e) => box(e).right)); \
         const isBad = (a, k) => a.left < end || a.right > box(chart).right || labels.some((b, i) => i < k && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 3); \
         return labels.filter(isBad).map(({ text }) => text); })",
    );
    assert_eq!(overlaps, json!([]));
    browser.run(RECORD);
    browser.click("[data-export=curves-svg]");
    browser.wait("window.texts.length");
    let plain = browser.run(
        "const picture = new DOMParser().parseFromString(window.texts[0], 'image/svg+xml'); \
         const words = [...picture.querySelectorAll('svg > text')].map((e) => e.textContent); \
         if (!['now', 'as opened'].every((name) => words.includes(name)) || !words[0].startsWith(studio.state.overview.name)) return words; \
         const labels = [...new DOMParser().parseFromString(window.texts[0], 'image/svg+xml').querySelectorAll('svg svg text')].filter((e) => / mm$/.test(e.textContent)); \
         return labels.length ? labels.filter((e) => !e.getAttribute('paint-order').startsWith('stroke')).length : 'none'",
    );
    assert_eq!(plain, json!(0));
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// A printed page shows the initial misfit beside the current misfit. The printed range of a chart does not touch the
/// value of the next chart.
#[test]
fn paper_has_the_first_misfit_and_separate_numbers() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.click("#tab-points");
    browser.run(
        "const field = document.querySelector('input[aria-label=\"strut_top y\"]'); field.value = '585'; field.dispatchEvent(new Event('change'))",
    );
    browser.wait(SETTLED);
    // The shown value has as many digits as before the move.
    let inclination = browser.run(
        "return document.querySelector('[data-column=kingpin_inclination_deg] output').textContent",
    );
    let inclination = inclination.as_str().unwrap();
    assert_eq!(
        inclination.split(' ').next().unwrap().len(),
        "11.14".len(),
        "{inclination}"
    );
    browser.print();
    browser.run("document.body.style.width = '718px'");
    let note = browser.run(
        "const note = document.querySelector('[data-chip=misfit] small'); return [note.checkVisibility(), note.textContent, note.parentElement.scrollWidth <= note.parentElement.clientWidth + 1]",
    );
    assert_eq!(note[0], json!(true));
    assert!(note[1].as_str().unwrap().contains("from"), "{note}");
    assert_eq!(note[2], json!(true));
    let close = browser.run(
        "const box = (e) => e.getBoundingClientRect(); const charts = [...document.querySelectorAll('.chartbox')]; \
         return charts.slice(1).filter((chart, k) => box(chart).top === box(charts[k]).top \
         && box(chart.querySelector('output')).left - box(charts[k].querySelector('small')).right < 6).length",
    );
    assert_eq!(close, json!(0));
}

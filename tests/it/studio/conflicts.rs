//! Tests of two tabs, or of a tab and another program, that change one study.

use super::browser::{DRAFTED, READY, RECORDED, SETTLED, handle};
use super::webdriver::Browser;
use super::{Served, sample};
use serde_json::{Value, json};
use std::fs;

/// Opens a study and changes a tolerance in it. Returns the text of its file, and the server.
fn edited(browser: &Browser) -> (String, Served) {
    let text = sample("double_wishbone_front.toml");
    let served = Served::of(&text);
    browser.open(&served.address);
    browser.wait(READY);
    type_tolerance(browser, "0.0125");
    (text, served)
}

/// Types a tolerance of the first target, and waits until the study has it.
fn type_tolerance(browser: &Browser, text: &str) {
    browser.click("#tab-targets");
    browser.wait("document.querySelector('[data-target=\"0\"]')");
    browser.run(&format!(
        "const field = document.querySelector('[data-target=\"0\"] td:nth-child(3) input'); \
         field.value = '{text}'; field.dispatchEvent(new Event('change'))"
    ));
    browser.wait(&format!(
        "studio.state.overview.written.optimise.targets[0].tolerance === {text}"
    ));
    browser.wait(SETTLED);
}

fn place(browser: &Browser, point: &str) -> Value {
    browser.run(&format!(
        "return studio.state.design[studio.state.overview.points.findIndex((p) => p.name === '{point}')]"
    ))
}

fn deeds(browser: &Browser) -> Value {
    browser.click("#tab-history");
    browser.run("return [...document.querySelectorAll('.deeds button')].map((b) => b.textContent)")
}

/// Another tab saves a move. The first tab then reads the file again. It keeps its own move and edit as one step of the
/// history, also after a reload. A save writes the changes of both tabs.
#[test]
fn a_file_is_read_again_under_the_changes_of_the_page() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("double_wishbone_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    let first = browser.tab();
    browser.drag(&handle("front", "upper_ball_joint"), [3, -8], 4);
    browser.wait(SETTLED);
    type_tolerance(&browser, "0.0125");
    let upper = place(&browser, "upper_ball_joint");
    browser.wait(DRAFTED);

    browser.open_tab(&served.address);
    browser.wait(READY);
    // The other tab offers the draft of the first tab without applying it.
    browser.wait("document.getElementById('banner').textContent.includes('Unsaved changes')");
    browser.drag(&handle("front", "lower_ball_joint"), [4, 6], 4);
    browser.wait(SETTLED);
    let lower = place(&browser, "lower_ball_joint");
    browser.click("#save");
    browser.wait("document.getElementById('banner').textContent.includes('study.toml saved')");

    browser.go_to(&first);
    assert_ne!(place(&browser, "lower_ball_joint"), lower);
    browser.run("window.dispatchEvent(new Event('focus'))");
    browser.wait("document.getElementById('banner').textContent.includes('another program')");
    browser.run(
        "[...document.querySelectorAll('#banner button')].find((b) => b.textContent === 'Read it again, keep my changes').click()",
    );
    browser.wait("document.getElementById('banner').textContent.includes('changes are kept')");
    browser.wait(SETTLED);
    let is_kept = |browser: &Browser| {
        assert_eq!(place(browser, "upper_ball_joint"), upper);
        assert_eq!(place(browser, "lower_ball_joint"), lower);
        let tolerance = "return studio.state.overview.written.optimise.targets[0].tolerance";
        assert_eq!(browser.run(tolerance), json!(0.0125));
        assert_eq!(deeds(browser), json!(["Kept changes", "As opened"]));
    };
    is_kept(&browser);
    browser.wait(DRAFTED);
    browser.wait(RECORDED);
    browser.open(&served.address);
    browser.wait(READY);
    is_kept(&browser);

    // The dialog shows only the lines that this page changes.
    let before = served.text();
    browser.click("#save");
    browser.wait("document.querySelector('#dialog[open] button[value=yes]')");
    let lines = browser.run("return [...document.querySelectorAll('.diff .gone, .diff .come')].map((line) => line.textContent)");
    let lines = lines.to_string();
    assert!(lines.contains("tolerance = 0.0125"), "{lines}");
    assert!(
        lines.contains("upper_ball_joint") && !lines.contains("lower_ball_joint"),
        "{lines}"
    );
    browser.click("#dialog button[value=yes]");
    browser.wait("document.getElementById('banner').textContent.includes('study.toml saved')");
    let after = served.text();
    let changed = before.lines().zip(after.lines()).filter(|(a, b)| a != b);
    assert_eq!(changed.count(), 2);
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// If the page's changes do not fit the changed file, the page does not read the file again and keeps its changes.
#[test]
fn changes_that_a_file_cannot_take_stay_on_the_page() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let (text, served) = edited(&browser);
    let (without, _) = text.split_once("[optimise]").unwrap();
    fs::write(&served.study, without).unwrap();
    browser.run("window.dispatchEvent(new Event('focus'))");
    browser.wait("document.getElementById('banner').textContent.includes('another program')");
    browser.click("#banner button");
    browser.wait("document.getElementById('banner').textContent.includes('was not reloaded')");
    let tolerance = "return studio.state.overview.written.optimise.targets[0].tolerance";
    assert_eq!(browser.run(tolerance), json!(0.0125));
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// After another program's change, a save asks what to do before it shows any lines. The page lists changed lines in
/// the history and before a save. This list never contains changes of the other program. The user can undo changes that
/// were merged into the file.
#[test]
fn lines_of_another_program_are_no_changes_of_the_page() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let (text, served) = edited(&browser);
    fs::write(&served.study, format!("# by hand\n{text}")).unwrap();
    browser.click("#save");
    browser.wait("document.getElementById('dialog').open");
    let shown = browser.run("return document.getElementById('dialog').textContent");
    assert!(
        shown.as_str().unwrap().contains("The file has changed"),
        "{shown}"
    );
    assert_eq!(
        browser.run("return document.querySelectorAll('#dialog .diff').length"),
        json!(0)
    );
    browser.run("document.getElementById('dialog').close('')");
    browser.click("#tab-history");
    browser.click("#changes");
    browser.wait("document.querySelector('#dialog .diff')");
    let lines = browser.run("return document.querySelector('#dialog .diff').textContent");
    let lines = lines.as_str().unwrap();
    assert!(
        lines.contains("0.0125") && !lines.contains("by hand"),
        "{lines}"
    );
    browser.run("document.getElementById('dialog').close('')");
    browser.click("#save");
    browser.wait("document.querySelector('#dialog button[value=merge]')");
    browser.click("#dialog button[value=merge]");
    browser.wait("document.getElementById('banner').textContent.includes('study.toml saved')");
    let saved = served.text();
    assert!(
        saved.starts_with("# by hand\n") && saved.contains("tolerance = 0.0125"),
        "{saved}"
    );
    assert_eq!(deeds(&browser), json!(["Kept changes", "As opened"]));
    browser.click("#undo");
    browser.wait(SETTLED);
    browser.run("document.getElementById('banner').textContent = ''");
    browser.click("#save");
    browser.wait("document.querySelector('#dialog[open] button[value=yes]')");
    browser.click("#dialog button[value=yes]");
    browser.wait("document.getElementById('banner').textContent.includes('study.toml saved')");
    assert_eq!(served.text(), format!("# by hand\n{text}"));
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// The server stores a limited number of texts. If it no longer has the page's text, the page sends its edits again.
#[test]
fn a_text_that_the_server_has_dropped_is_sent_again() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let (_, served) = edited(&browser);
    let digest = served.overview()["digest"].clone();
    for number in 0..45 {
        let path = json!(["optimise", "targets", 0, "tolerance"]);
        let edits = json!([{"path": path, "value": 0.5 + f64::from(number)}]);
        let other = served.post("edit", &json!({"digest": digest, "edits": edits}));
        assert_eq!(other.status, 200, "{}", other.text());
    }
    type_tolerance(&browser, "0.025");
}

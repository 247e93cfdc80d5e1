//! Tests of the reference state, with which the page compares the current design. The reference is the file as opened
//! or last saved, with its rates and targets.

use super::browser::{READY, RECORDED, SETTLED, save_edits};
use super::webdriver::Browser;
use super::{Served, sample};
use serde_json::json;

const WHEEL_RATE: &str = r#"
[optimise]
variables = [{ hardpoint = "spring_upper", axis = "z", range = [-10.0, 10.0] }]
targets = [{ characteristic = "wheel_rate", over = "heave", at = 0.0, value = 25.0, tolerance = 1.0 }]
"#;

fn misfit(browser: &Browser) -> String {
    browser.wait(SETTLED);
    let shown =
        browser.run("return document.querySelector('[data-chip=misfit] .value').textContent");
    shown.as_str().unwrap().to_owned()
}

fn type_in(browser: &Browser, label: &str, text: &str) {
    browser.run(&format!(
        "const field = document.querySelector('input[aria-label=\"{label}\"]'); \
         field.value = '{text}'; field.dispatchEvent(new Event('change'))"
    ));
}

/// The page compares a changed rate and a moved point with the file. The curve of the file is dashed. A save makes the
/// saved state the reference. An undo after the save restores the earlier values, and a second save writes these
/// values.
#[test]
fn a_changed_rate_is_compared_with_the_file() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let text = sample("double_wishbone_axle.toml") + WHEEL_RATE;
    let served = Served::of(&text);
    browser.open(&served.address);
    browser.wait(READY);
    let opened = misfit(&browser);
    let opened = opened.strip_suffix(" tol.").unwrap();

    browser.click("#tab-parts");
    type_in(&browser, "spring rate", "70");
    let from_opened = format!("from {opened}");
    browser.wait(&format!(
        "document.querySelector('[data-chip=misfit]').textContent.endsWith('{from_opened}')"
    ));
    let dashed = "return ['ghosts', 'now'].map((layer) => document.querySelector(`[data-column='both wheel_rate_N_per_mm'] .${layer} path`).getAttribute('d'))";
    let lines = browser.run(dashed);
    assert!(lines[0] != "" && lines[0] != lines[1], "{lines}");

    browser.click("#tab-points");
    type_in(&browser, "lower_ball_joint z", "131");
    let moved = misfit(&browser);
    assert!(moved.ends_with(&from_opened), "{moved}");

    let save = || {
        browser.run("document.getElementById('banner').textContent = ''");
        save_edits(&browser);
    };
    save();
    let saved = moved.split(' ').next().unwrap();
    browser.wait("document.querySelector('[data-chip=misfit]').textContent.endsWith('tol.')");
    browser.click("#undo");
    browser.wait(SETTLED);
    browser.click("#undo");
    assert_eq!(misfit(&browser), format!("{opened} from {saved}"));
    save();
    assert_eq!(served.text(), text);
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// The command Tune changes points and bushings. The page then compares the misfit with that of the file. The proposal
/// shows the same two numbers.
#[test]
fn tuned_bushings_are_compared_with_the_file() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let tuned = r#"
[optimise]
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
]
targets = [{ characteristic = "toe", points = [[-40.0, 0.0], [0.0, 0.0], [40.0, 0.0]], tolerance = 0.02 }]
"#;
    let served = Served::of(&(sample("double_wishbone_compliance.toml") + tuned));
    browser.open(&served.address);
    browser.wait(READY);
    let opened = browser.run("return studio.state.answer.misfit.value");
    browser.click("#tune");
    browser.wait("document.getElementById('accept')");
    browser.wait("studio.state.proposed");
    browser.click("#accept");
    browser.wait("studio.state.overview.digest !== studio.state.overview.base");
    let after = misfit(&browser);
    assert!(after.contains("from"), "{after}");
    assert_eq!(
        browser.run("return studio.state.ghost.misfit.value"),
        opened
    );
    // The drawing of the file's mechanism also uses the bushings of the file.
    let drawn = browser
        .run("return document.querySelector('[data-view=front] .ghost path').getAttribute('d')");
    assert_ne!(drawn, json!(""));
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// The user undoes a change that was saved. The page keeps this state when it is loaded again. A further change can be
/// saved, because no other program has changed the file.
#[test]
fn an_undo_past_a_save_survives_a_reload() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let text = sample("macpherson_front.toml");
    let served = Served::of(&text);
    let wait_for = |weight: f64| {
        browser.wait(&format!(
            "(studio.state.overview.written.optimise.targets[0].weight ?? 1) === {weight}"
        ));
        browser.wait(SETTLED);
    };
    let weight = |value: f64| {
        browser.click("#tab-targets");
        type_in(&browser, "camber [°]: weight", &value.to_string());
        wait_for(value);
    };
    let save = || {
        browser.run("document.getElementById('banner').textContent = ''");
        save_edits(&browser);
    };
    browser.open(&served.address);
    browser.wait(READY);
    weight(3.0);
    save();
    browser.click("#undo");
    wait_for(1.0);
    browser.wait(RECORDED);
    browser.open(&served.address);
    browser.wait(READY);
    browser.wait(SETTLED);
    let written = "return studio.state.overview.written.optimise.targets[0].weight ?? 1";
    assert_eq!(browser.run(written), json!(1));
    browser.click("#redo");
    wait_for(3.0);
    browser.click("#undo");
    wait_for(1.0);
    weight(2.0);
    save();
    assert!(served.text().contains("weight = 2"));
    assert!(!served.text().contains("weight = 3"));
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// Three saves by the keyboard, one immediately after the other, are one save. They are no conflict.
#[test]
fn a_held_save_key_saves_once() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    type_in(&browser, "strut_top x", "-34");
    browser.wait(SETTLED);
    let press = "document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 's', ctrlKey: true, bubbles: true }));";
    browser.run(
        "const own = window.fetch; window.saves = { begun: 0, ended: 0 }; \
         window.fetch = async (what, ...rest) => { \
           if (!String(what).endsWith('save')) return own(what, ...rest); \
           window.saves.begun += 1; \
           try { return await own(what, ...rest); } finally { window.saves.ended += 1; } }",
    );
    browser.run(&press.repeat(3));
    browser.wait("document.getElementById('banner').textContent.includes('study.toml saved')");
    browser.wait("window.saves.ended === window.saves.begun");
    assert_eq!(browser.run("return window.saves.begun"), json!(1));
    assert_eq!(
        browser.run("return document.getElementById('dialog').open"),
        json!(false)
    );
    assert!(served.text().contains("-34.0"));
    assert_eq!(browser.console(), Vec::<String>::new());
}

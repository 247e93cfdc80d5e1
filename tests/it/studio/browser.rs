//! Tests of the page in a real browser, if one is installed: points, tabs, pinned designs and unsaved work.

use super::webdriver::Browser;
use super::{Served, columns, sample, solved};
use serde_json::{Value, json};
use std::fs;

pub(super) const READY: &str = "document.documentElement.dataset.ready === 'true' && window.studio.state.answer && window.studio.state.ghost";
/// Condition: the shown answer belongs to the current design.
pub(super) const SETTLED: &str = "studio.isSettled()";
/// Condition: the browser stores the unsaved moves and edits of this tab as they are now. The page stores them after a short
/// delay.
pub(super) const DRAFTED: &str = "(() => { \
    const { overview: { place, points, edits }, design, opened } = studio.state; \
    const draft = JSON.parse(localStorage.getItem(`hardpoint studio ${place} ${sessionStorage.getItem('hardpoint tab')}`)); \
    const moves = points.flatMap(({ name }, p) => design[p].map((c, axis) => [name, axis, c, opened[p][axis]])).filter(([, , c, was]) => c !== was); \
    return draft !== null && JSON.stringify([draft.moves, draft.edits]) === JSON.stringify([moves, edits]); })()";
/// Condition: the browser stores the history of this tab, with the current design and edits as the present step.
pub(super) const RECORDED: &str = "(() => { \
    const { overview: { place, points, edits }, design } = studio.state; \
    const history = JSON.parse(sessionStorage.getItem(`hardpoint history ${place}`)); \
    const step = history?.deeds[history.present]; \
    const places = points.map(({ name }, p) => [name, design[p]]); \
    return step && JSON.stringify([step.places, step.edits]) === JSON.stringify([places, edits]); })()";

/// Saves the page's edits, and confirms the question whether to save them.
pub(super) fn save_edits(browser: &Browser) {
    browser.click("#save");
    browser.wait("document.querySelector('#dialog[open] button[value=yes]')");
    browser.click("#dialog button[value=yes]");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
}

pub(super) fn handle(view: &str, point: &str) -> String {
    format!("[data-view={view}] .handle[data-name={point}]:not([data-other])")
}

/// Asserts that every drawn curve has the values that `hardpoint solve` prints for the study in a file. Returns the
/// number of curves.
pub(super) fn assert_drawn_as_solved(browser: &Browser, study: &std::path::Path) -> usize {
    let drawn = browser.run("return studio.drawnValues()");
    let printed = columns(&solved(study));
    let mut compared = 0;
    for (column, values) in drawn.as_object().unwrap() {
        let Some((_, printed)) = printed.iter().find(|(name, _)| name == column) else {
            continue;
        };
        let values: Vec<Option<f64>> = values
            .as_array()
            .unwrap()
            .iter()
            .map(Value::as_f64)
            .collect();
        assert_eq!(&values, printed, "{column}");
        compared += 1;
    }
    compared
}

/// Asserts that the line on the screen passes through the values, to a hundredth of a pixel.
fn assert_line_is_at_values(browser: &Browser, column: &str) {
    let places = browser.run(&format!("return studio.drawnPlaces({column:?})"));
    let d = places["d"].as_str().unwrap();
    let drawn: Vec<f64> = d
        .split(['M', 'L', ' '])
        .filter(|n| !n.is_empty())
        .map(|n| n.parse().unwrap())
        .collect();
    let list = |name: &str| -> Vec<f64> {
        places[name]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect()
    };
    let (x, y) = (list("drive"), list("value"));
    assert_eq!(drawn.len(), 2 * x.len());
    for (station, pair) in drawn.chunks(2).enumerate() {
        assert!((pair[0] - x[station]).abs() < 0.01 && (pair[1] - y[station]).abs() < 0.01);
    }
}

#[test]
fn points_are_dragged_and_curves_follow() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    assert!(assert_drawn_as_solved(&browser, &served.study) >= 6);
    let opened = browser.run("return studio.state.design");

    browser.drag(&handle("front", "strut_top"), [14, -9], 7);
    browser.wait(SETTLED);
    let moved = browser.run("return studio.state.design");
    assert_ne!(moved, opened);
    browser.click("#save");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    assert_ne!(served.text(), sample("macpherson_front.toml"));
    assert!(assert_drawn_as_solved(&browser, &served.study) >= 6);
    assert_line_is_at_values(&browser, "camber_deg");

    // The user makes two steps: a drag in another view, and an arrow key. The user then undoes both steps one by one
    // and redoes them.
    browser.drag(&handle("top", "tie_rod_outer"), [6, 5], 5);
    let dragged = browser.run("return studio.state.design");
    assert_ne!(dragged, moved);
    browser.keys(&["\u{e013}"]);
    let nudged = browser.run("return studio.state.design");
    assert_ne!(nudged, dragged);
    for (button, expected) in [
        ("#undo", &dragged),
        ("#undo", &moved),
        ("#redo", &dragged),
        ("#redo", &nudged),
        ("#undo", &dragged),
        ("#undo", &moved),
    ] {
        browser.click(button);
        assert_eq!(
            &browser.run("return studio.state.design"),
            expected,
            "{button}"
        );
    }
    browser.wait(SETTLED);
    assert!(assert_drawn_as_solved(&browser, &served.study) >= 6);
    assert_eq!(browser.console(), Vec::<String>::new());
}

#[test]
fn a_tuning_is_proposed_accepted_and_saved() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_bump_steer.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    let before = browser
        .run("return studio.state.answer.misfit.value")
        .as_f64()
        .unwrap();
    let opened = browser.run("return studio.state.design");
    browser.click("#tune");
    browser.wait("document.getElementById('reject')");
    browser.click("#reject");
    assert_eq!(browser.run("return studio.state.design"), opened);
    browser.click("#tune");
    browser.wait("document.getElementById('accept')");
    browser.wait("studio.state.proposed");
    browser.click("#accept");
    browser.wait(SETTLED);
    let after = browser
        .run("return studio.state.answer.misfit.value")
        .as_f64()
        .unwrap();
    assert!(after < 0.5 * before, "{before} {after}");
    browser.click("#save");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    assert!(assert_drawn_as_solved(&browser, &served.study) >= 1);
    let saved = browser.run("return studio.state.design");
    browser.open(&served.address);
    browser.wait(READY);
    assert_eq!(browser.run("return studio.state.design"), saved);
    assert_eq!(browser.console(), Vec::<String>::new());
}

#[test]
fn tabs_servers_and_files_come_and_go() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let mut served = Served::of(&sample("double_wishbone_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    let first = browser.tab();
    browser.drag(&handle("front", "upper_ball_joint"), [3, -8], 4);
    browser.wait(SETTLED);
    let moved = browser.run("return studio.state.design");

    // A second tab shows the design of the file, and does not disturb the first tab.
    let second = browser.open_tab(&served.address);
    browser.wait(READY);
    assert_ne!(browser.run("return studio.state.design"), moved);
    browser.go_to(&first);
    assert_eq!(browser.run("return studio.state.design"), moved);

    // If the file changes, the page asks what to do. It then applies the moves to the changed file.
    let edited = format!("# by hand\n{}", served.text());
    fs::write(&served.study, &edited).unwrap();
    browser.click("#save");
    browser.wait("document.getElementById('dialog').open");
    assert_eq!(served.text(), edited);
    browser.click("#dialog button[value=merge]");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    assert!(served.text().starts_with("# by hand\n") && served.text() != edited);
    browser.wait(SETTLED);
    assert!(assert_drawn_as_solved(&browser, &served.study) >= 2);

    // If the server stops, later moves reappear when another server opens the study.
    browser.drag(&handle("front", "upper_ball_joint"), [-5, 4], 4);
    browser.wait(SETTLED);
    let unsaved = browser.run("return studio.state.design");
    browser.wait(DRAFTED);
    assert_eq!(browser.console(), Vec::<String>::new());
    served.kill();
    browser.drag(&handle("front", "upper_ball_joint"), [2, 2], 2);
    browser.wait("document.documentElement.dataset.server === 'no'");
    browser.click("#undo");
    browser.wait(DRAFTED);
    served.restart();
    browser.wait("document.documentElement.dataset.server === 'other'");
    // Chromium itself writes refused connections and error responses to the console, so the test ignores these lines.
    let own = |line: &String| !line.contains("ERR_CONNECTION") && !line.contains("403 (Forbidden)");
    assert_eq!(
        browser
            .console()
            .into_iter()
            .filter(own)
            .collect::<Vec<_>>(),
        Vec::<String>::new()
    );
    browser.open(&served.address);
    browser.wait(READY);
    assert_eq!(browser.run("return studio.state.design"), unsaved);
    browser
        .wait("document.getElementById('banner').textContent.includes('unsaved changes are back')");
    // The button in the message discards the unsaved changes and shows the design of the file.
    browser.click("#banner button");
    assert_ne!(browser.run("return studio.state.design"), unsaved);
    browser.go_to(&second);
    assert_eq!(
        browser
            .console()
            .into_iter()
            .filter(own)
            .collect::<Vec<_>>(),
        Vec::<String>::new()
    );
}

/// The page shows hostile names as plain text. Names inside a study consist of letters and digits. The file name of a
/// study can contain anything.
#[cfg(unix)]
#[test]
fn hostile_names_are_shown_as_text() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let name = "<img src=x onerror=window.hit=1>";
    let served = Served::named(&format!("{name}.toml"), &sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    assert_eq!(browser.run("return window.hit ?? null"), Value::Null);
    assert_eq!(
        browser.run("return document.querySelectorAll('img').length"),
        0
    );
    let shown = browser.run("return document.getElementById('study-name').textContent");
    assert_eq!(shown, name);
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// The page compares a pinned design with the current one. If a slot is occupied, the page warns that the design in
/// this slot would be replaced.
#[test]
fn pinned_designs_are_compared() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.click("#tab-history");
    browser.click("[data-pin=A] button[aria-label='Pin A']");
    browser.wait("document.querySelector('#comparison') !== null");
    browser.drag(&handle("front", "strut_top"), [14, -9], 7);
    browser.wait(SETTLED);
    browser.click("#tab-history");
    let cells = "[...document.querySelectorAll('#comparison tbody tr')].map((row) => [...row.querySelectorAll('td')].map((cell) => cell.textContent))";
    browser.wait(&format!("{cells}.some(([pinned, now]) => pinned !== now)"));
    let buttons = browser.run(
        "return [...document.querySelectorAll('[data-pin=A] button')].map((b) => b.textContent)",
    );
    assert_eq!(buttons, json!(["Go to", "Replace", "Remove"]));

    // The tab keeps the pinned design after a reload.
    let pinned = browser.run("return studio.state.pins.A.design");
    browser.open(&served.address);
    browser.wait(READY);
    browser.wait("studio.state.pins.A?.answer");
    assert_eq!(browser.run("return studio.state.pins.A.design"), pinned);
    browser.click("#tab-history");
    browser.run("document.querySelector('[data-pin=A] button[aria-label=\"Remove A\"]').click()");
    browser.open(&served.address);
    browser.wait(READY);
    assert_eq!(
        browser.run("return Object.keys(studio.state.pins).length"),
        0
    );
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// A reload keeps unsaved moves and edits with their history, and another tab offers them.
#[test]
fn a_reload_keeps_unsaved_work() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("double_wishbone_compliance.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.drag(&handle("front", "tie_rod_inner"), [0, -6], 5);
    browser.wait(SETTLED);
    browser.click("#tab-parts");
    browser.run(
        "const field = document.querySelector('[data-bushing=lower_arm_rear] td:nth-child(3) input'); \
         field.value = '5000'; field.dispatchEvent(new Event('change'))",
    );
    let is_typed = "studio.state.overview.written.bushings.lower_arm_rear.stiffness[1] === 5000";
    browser.wait(is_typed);
    browser.wait(SETTLED);
    browser.drag(&handle("front", "tie_rod_outer"), [0, -5], 5);
    browser.wait(SETTLED);
    browser.click("#undo");
    browser.wait(SETTLED);
    let deeds = "document.getElementById('tab-history').click(); return [...document.querySelectorAll('.deeds button')].map((b) => [b.textContent, b.getAttribute('aria-current')])";
    let work = "return [studio.state.design, studio.state.overview.digest]";
    let (told, done) = (browser.run(deeds), browser.run(work));
    assert_eq!(told.as_array().unwrap().len(), 4, "{told}");
    browser.wait(DRAFTED);
    browser.wait(RECORDED);

    browser.open(&served.address);
    browser.wait(READY);
    assert_eq!(browser.run(work), done);
    assert_eq!(browser.run(deeds), told);
    for _ in 0..2 {
        browser.click("#undo");
        browser.wait(SETTLED);
    }
    assert_eq!(browser.run(&format!("return {is_typed}")), json!(false));
    browser.click("#undo");
    browser.wait(SETTLED);
    assert_eq!(
        browser.run("return studio.state.overview.digest === studio.state.overview.base"),
        json!(true)
    );
    for _ in 0..2 {
        browser.click("#redo");
        browser.wait(SETTLED);
    }
    assert_eq!(browser.run(work), done);
    browser.wait(DRAFTED);

    // Another tab has no history, but offers the unsaved work.
    browser.run("sessionStorage.clear()");
    browser.open(&served.address);
    browser.wait(READY);
    assert_ne!(browser.run(work), done);
    browser.run(
        "[...document.querySelectorAll('#banner button')].find((b) => b.textContent === 'Restore').click()",
    );
    browser.wait(is_typed);
    browser.wait(SETTLED);
    assert_eq!(browser.run(work), done);
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// Nothing on the page shifts while a point is dragged, and every move is drawn.
#[test]
fn a_drag_shifts_no_layout() {
    let Some(browser) = Browser::start() else {
        return;
    };
    for name in ["macpherson_front.toml", "macpherson_axle_front.toml"] {
        let served = Served::of(&sample(name));
        browser.open(&served.address);
        browser.wait(READY);
        browser.run(
            "window.shifted = []; new PerformanceObserver((list) => { \
             for (const { sources } of list.getEntries()) for (const { node, previousRect, currentRect } of sources) { \
             const own = node?.nodeType === 3 ? node.parentElement : node; \
             window.shifted.push([own?.outerHTML.slice(0, 120), previousRect.x, currentRect.x, previousRect.y, currentRect.y]); } \
             }).observe({ type: 'layout-shift' })",
        );
        let before = browser.run("return Number(document.documentElement.dataset.answers)");
        browser.drag(&handle("front", "lower_ball_joint"), [24, -18], 30);
        browser.wait(SETTLED);
        let after = browser.run("return Number(document.documentElement.dataset.answers)");
        assert!(after.as_f64().unwrap() >= before.as_f64().unwrap() + 3.0);
        assert_eq!(browser.run("return window.shifted"), json!([]), "{name}");
        assert_eq!(browser.console(), Vec::<String>::new());
        // A page sends requests until the browser leaves the page, and the server ends here.
        browser.open("about:blank");
    }
}

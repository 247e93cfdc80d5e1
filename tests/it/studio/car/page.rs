//! Tests of the page of a car in a real browser.

use super::{as_it_is, read, served};
use crate::studio::browser::{READY, SETTLED, save_edits};
use crate::studio::webdriver::Browser;
use crate::studio::{Served, columns, sample, solved};
use serde_json::Value;

/// Script that returns the values in the table of load cases.
const SHOWN: &str = "return Object.fromEntries([...document.querySelectorAll('#cases tbody tr')].map((row) => [row.dataset.column, [...row.querySelectorAll('b')].map((cell) => cell.textContent)]))";

/// Asserts that every value in the table equals the one that `hardpoint solve` prints, to four digits.
fn assert_shown_as_solved(browser: &Browser, served: &Served) {
    // The page updates hidden rows after a short delay.
    browser.wait("[...document.querySelectorAll('#cases tbody tr')].every((row) => !row.isLate)");
    let shown = browser.run(SHOWN);
    let printed = columns(&solved(&served.study));
    let mut compared = 0;
    for (column, cells) in shown.as_object().unwrap() {
        let Some((_, values)) = printed.iter().find(|(name, _)| name == column) else {
            continue;
        };
        for (cell, value) in cells.as_array().unwrap().iter().zip(values) {
            let cell = cell.as_str().unwrap().replace('\u{2212}', "-");
            match value {
                None => assert_eq!(cell, "\u{2013}", "{column}"),
                Some(value) => {
                    let cell: f64 = cell.parse().unwrap();
                    let near = 5.1e-4 * value.abs() + 1e-6;
                    assert!((cell - value).abs() < near, "{column}: {cell} {value}");
                }
            }
            compared += 1;
        }
    }
    assert!(compared >= 60, "{compared}");
}

#[test]
fn a_car_is_dragged_edited_tuned_and_saved() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = served("car", as_it_is);
    browser.open(&served.address);
    browser.wait(READY);
    assert_shown_as_solved(&browser, &served);
    let choose = |id: &str, value: &str| {
        browser.run(&format!(
            "const own = document.getElementById('{id}'); own.value = '{value}'; own.dispatchEvent(new Event('change'))"
        ));
    };
    choose("part", "front");
    choose("case", "1");
    browser.wait(SETTLED);

    // In the front view, dragging a point does not change its x. The point stays under the pointer although the body
    // rolls.
    let point = "[data-view=front] .handle[data-name=front_tie_rod_inner]:not([data-other])";
    let place = format!(
        "const box = document.querySelector(\"{point}\").getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]"
    );
    let number = |value: &Value| value.as_f64().unwrap();
    let from = browser.run(&place);
    let opened = browser.run("return studio.state.design[studio.state.overview.points.findIndex((p) => p.name === 'front_tie_rod_inner')]");
    browser.drag(point, [15, -12], 5);
    browser.wait(SETTLED);
    let now = browser.run("return studio.state.design[studio.state.overview.points.findIndex((p) => p.name === 'front_tie_rod_inner')]");
    assert_eq!(now[0], opened[0]);
    assert_ne!(now[1], opened[1]);
    let to = browser.run(&place);
    for (axis, by) in [(0, 15.0), (1, -12.0)] {
        let moved = number(&to[axis]) - number(&from[axis]);
        // The travel of the case changes slightly with the design.
        assert!((moved - by).abs() < 2.5, "{moved} {by}");
    }
    let changes = "[...document.querySelectorAll('#cases td small')].filter((note) => note.textContent).length";
    browser.wait(&format!("{changes} > 20"));
    browser.click("#undo");
    browser.wait(SETTLED);
    browser.wait(&format!("{changes} === 0"));

    browser.click("#tab-parts");
    browser.run("document.querySelector('[aria-label=\"rear anti roll bar rate\"]').select()");
    browser.keys(&["4", "5", "0", "0", "0", "0", "\u{e007}"]);
    browser.wait("studio.state.overview.written.rear.anti_roll_bar.rate === 450000");
    browser.wait(SETTLED);
    // Changes are relative to the file, not to the design before the edit.
    browser.wait(&format!("{changes} > 20"));

    browser.click("#tune");
    browser.wait("document.getElementById('accept')");
    browser.wait("studio.state.proposed");
    browser.click("#accept");
    browser.wait("document.getElementById('accept') === null");
    browser.wait(SETTLED);
    browser.wait("studio.state.answer.misfit.value < 0.1");
    save_edits(&browser);
    browser.wait(SETTLED);
    for name in ["car_front.toml", "car_rear.toml"] {
        assert_ne!(read(&served, name), sample(name));
    }
    assert_shown_as_solved(&browser, &served);
    let saved = browser.run("return studio.state.design");
    browser.open(&served.address);
    browser.wait(READY);
    assert_eq!(browser.run("return studio.state.design"), saved);
    assert_shown_as_solved(&browser, &served);

    // If a case has no equilibrium, the page gives the reason and shows no value of an earlier design.
    browser.click("#tab-parts");
    browser.wait(SETTLED);
    browser.run("document.querySelector('[aria-label=\"turn ay\"]').select()");
    browser.keys(&["2", ".", "5", "\u{e007}"]);
    browser.wait("studio.state.answer.failures.length === 1");
    browser.wait("document.querySelector('[data-chip=solved]').textContent.includes('4 of 5')");
    browser.wait("document.querySelector('[data-chip=misfit]').textContent.includes('none')");
    browser.click("#tab-warnings");
    browser.wait("document.getElementById('pane-warnings').textContent.includes('case turn')");
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// In the table of load cases, the user adds a target for the result of a case. The page marks the cell of this result,
/// and the saved study contains the target.
#[test]
fn a_result_of_a_case_gets_a_target() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = served("car", as_it_is);
    browser.open(&served.address);
    browser.wait(READY);
    let count = "studio.state.overview.targets.length";
    let before = browser.run(&format!("return {count}")).as_u64().unwrap();
    browser.click("#cases [data-column=roll_deg] .adder");
    browser.run(
        "const [kind, own] = document.querySelectorAll('#dialog select'); \
         kind.value = 'value'; kind.dispatchEvent(new Event('change')); \
         own.value = '1'; own.dispatchEvent(new Event('change')); \
         const rows = [...document.querySelectorAll('#dialog label')]; \
         rows.find((row) => row.textContent.startsWith('Value')).querySelector('input').value = '2.5'",
    );
    browser.click("#dialog button[value=add]");
    browser.wait(&format!("{count} === {}", before + 1));
    let is_marked = "document.querySelectorAll('#cases [data-column=roll_deg] td')[1].classList.contains('target')";
    browser.wait(is_marked);
    save_edits(&browser);
    let text = served.text();
    let target = text
        .lines()
        .find(|line| line.contains("case = \"turn\"") && line.contains("2.5"));
    let target = target.unwrap_or_else(|| panic!("{text}"));
    assert!(target.contains("\"roll\""), "{target}");
    assert_eq!(browser.console(), Vec::<String>::new());
}

//! Tests of proposals, targets and curves of the page in a real browser, if one is installed.

use super::browser::{READY, SETTLED, handle};
use super::car::{as_it_is, served as car};
use super::webdriver::Browser;
use super::{Served, sample};
use serde_json::json;

/// The user applies half of a car's proposal. This applies half of each move and of each tuned value. The user accepts
/// this change, and undoes it, in one step.
#[test]
fn half_of_a_proposal_has_half_of_its_tuned_values() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = car("car", as_it_is);
    browser.open(&served.address);
    browser.wait(READY);
    let rates = "return ['front', 'rear'].map((end) => studio.state.overview.written[end].anti_roll_bar.rate)";
    let numbers = |script: &str| -> Vec<f64> {
        let found = browser.run(script);
        let found = found.as_array().unwrap().iter();
        found.map(|v| v.as_f64().unwrap()).collect()
    };
    let (before, opened) = (numbers(rates), browser.run("return studio.state.design"));
    browser.click("#tune");
    browser.wait("document.getElementById('accept')");
    browser.wait("studio.state.proposed");
    let shown = "return [...document.querySelectorAll('#rates tbody tr')].map((row) => Number(row.lastChild.textContent))";
    let full = numbers(shown);
    browser.run("const share = document.getElementById('share'); share.value = 50; share.dispatchEvent(new Event('input'))");
    // The test accepts the half proposal immediately, while the page still waits for the values of this half proposal.
    browser.click("#accept");
    browser.wait("document.getElementById('accept') === null");
    browser.wait(SETTLED);
    let half = numbers(rates);
    for k in 0..2 {
        let middle = 0.5 * (before[k] + full[k]);
        // The proposal shows six digits.
        assert!(
            (half[k] - middle).abs() <= 1e-5 * middle,
            "{half:?} {full:?}"
        );
        assert!((full[k] - before[k]).abs() > 1e-2 * before[k]);
    }
    assert_ne!(browser.run("return studio.state.design"), opened);
    browser.click("#undo");
    browser.wait(SETTLED);
    assert_eq!(numbers(rates), before);
    assert_eq!(browser.run("return studio.state.design"), opened);
    assert_eq!(
        browser.run("return document.getElementById('undo').disabled"),
        json!(true)
    );
    browser.click("#redo");
    browser.wait(SETTLED);
    assert_eq!(numbers(rates), half);
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// If the user undoes a move while a proposal is open, the proposal states that points have moved. If the user undoes
/// a change of a value, the page closes the proposal with a message.
#[test]
fn an_undo_tells_of_an_open_proposal() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_bump_steer.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.click("#tab-targets");
    browser.run(
        "const field = document.querySelector('[data-target=\"0\"] td:nth-child(3) input'); \
         field.value = '0.03'; field.dispatchEvent(new Event('change'))",
    );
    browser.wait("studio.state.overview.written.optimise.targets[0].tolerance === 0.03");
    browser.drag(&handle("front", "tie_rod_inner"), [0, -6], 5);
    browser.wait(SETTLED);
    browser.click("#tune");
    browser.wait("document.getElementById('accept')");
    let note = "return document.getElementById('proposal-note').textContent";
    assert_eq!(browser.run(note), json!(""));
    let told = "document.getElementById('pane-proposal').textContent";
    browser.wait(&format!("{told}.includes('Results of the full proposal')"));
    browser.click("#undo");
    browser.wait(SETTLED);
    let said = browser.run(note);
    assert!(
        said.as_str().unwrap().contains("Points have moved"),
        "{said}"
    );
    browser.click("#undo");
    browser
        .wait("document.getElementById('banner').textContent.includes('The proposal is closed')");
    assert_eq!(
        browser.run("return document.getElementById('proposal').hidden"),
        json!(true)
    );
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// A refused value does not stay in its field. A refused target stays in its dialog, with the reason. The next accepted
/// change removes the message.
#[test]
fn refusals_are_told_where_they_are_corrected() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("double_wishbone_robust.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.click("#tab-targets");
    let field = "document.querySelector('[data-target=\"0\"] td:nth-child(3) input')";
    let type_in = |text: &str| {
        browser.run(&format!(
            "const field = {field}; field.value = '{text}'; field.dispatchEvent(new Event('change'))"
        ));
    };
    let old = browser.run(&format!("return {field}.value"));
    type_in("-1");
    browser.wait("document.getElementById('banner').textContent.includes('Not changed')");
    browser.wait(&format!("{field}.value === {old}"));
    type_in("0.003");
    browser.wait("studio.state.overview.written.optimise.targets[0].tolerance === 0.003");
    assert_eq!(
        browser.run("return document.getElementById('banner').hidden"),
        json!(true)
    );

    browser.wait(SETTLED);
    browser.click("[data-column=toe_deg] .adder");
    browser.wait("document.getElementById('dialog').open");
    let limit = |name: &str, text: &str| {
        browser.run(&format!(
            "[...document.querySelectorAll('#dialog label')].find((l) => l.textContent.startsWith('{name}')).querySelector('input').value = '{text}'"
        ));
    };
    limit("Lower limit", "25");
    limit("Upper limit", "20");
    browser.click("#dialog button[value=add]");
    browser.wait("document.querySelector('#dialog [role=alert]').textContent.length > 10");
    assert_eq!(
        browser.run("return document.getElementById('dialog').open"),
        json!(true)
    );
    assert_eq!(
        browser.run("return document.getElementById('banner').hidden"),
        json!(true)
    );
    limit("Upper limit", "30");
    browser.click("#dialog button[value=add]");
    browser.wait("!document.getElementById('dialog').open");
    let target = "return studio.state.overview.written.optimise.targets.at(-1).between";
    assert_eq!(browser.run(target), json!([25, 30]));
    assert_eq!(
        browser.run("return studio.state.overview.targets.length"),
        json!(3)
    );
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// No number beside a curve is truncated. Each horizontal axis has at least two labels that do not touch.
#[test]
fn numbers_beside_curves_are_whole() {
    let Some(browser) = Browser::start() else {
        return;
    };
    for name in [
        "macpherson_steering.toml",
        "double_wishbone_compliance.toml",
        "double_wishbone_robust.toml",
        "solid_axle_rear.toml",
    ] {
        let served = Served::of(&sample(name));
        browser.open(&served.address);
        browser.wait(READY);
        browser.wait(SETTLED);
        let cut = browser.run(
            "return [...document.querySelectorAll('.chartbox .values small, .chartbox output')].filter((own) => own.offsetWidth > 0).map((small) => { \
             const range = document.createRange(); range.selectNodeContents(small); \
             const [text, box] = [range, small].map((own) => own.getBoundingClientRect()); \
             return text.left < box.left - 0.5 || text.right > box.right + 0.5 ? small.textContent : null; }).filter(Boolean)",
        );
        assert_eq!(cut, json!([]), "{name}");
        // Both ends of a range show different numbers, unless the curve is constant.
        let alike = browser.run(
            "return [...document.querySelectorAll('.chartbox .values small')].map((small) => small.textContent) \
             .filter((text) => { const [low, high] = text.split('…'); return low === high && low !== '0'; })",
        );
        assert_eq!(alike, json!([]), "{name}");
        let bare = browser.run(
            "return [...document.querySelectorAll('.chart')].map((chart) => { \
             const words = [...chart.querySelectorAll('.axes text[text-anchor=middle]:not(.axis-title)')]; \
             const boxes = words.map((word) => word.getBoundingClientRect()).sort((a, b) => a.left - b.left); \
             const touch = boxes.some((box, k) => k > 0 && box.left < boxes[k - 1].right); \
             return words.length < 2 || touch ? words.map((word) => word.textContent) : null; }).filter(Boolean)",
        );
        assert_eq!(bare, json!([]), "{name}");
        assert_eq!(browser.console(), Vec::<String>::new());
        // A page sends requests until the browser leaves the page, and the server ends here.
        browser.open("about:blank");
    }
}

/// A printed tuning report contains the tables that its text refers to.
#[test]
fn a_printed_tuning_report_has_its_tables() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("study.toml");
    std::fs::write(&study, sample("double_wishbone_robust.toml")).unwrap();
    let status = std::process::Command::new(env!("CARGO_BIN_EXE_hardpoint"))
        .args(["optimise", "--quiet", "--report", "--out"])
        .arg(folder.path().join("out"))
        .arg(&study)
        .stdout(std::process::Stdio::null())
        .status()
        .unwrap();
    assert!(status.success());
    browser.open(&format!(
        "file://{}",
        folder.path().join("out/report.html").display()
    ));
    browser.print();
    let text = browser.run("return document.body.innerText");
    let text = text.as_str().unwrap();
    let (above, below) = text
        .split_once("1 further output is listed below.")
        .unwrap();
    assert!(above.contains("kingpin_inclination"), "{above}");
    for words in [
        "unchanged: scrub_radius_mm",
        "yield 0 % -> 100 % of 20000 builds",
        "at upper bound",
        "bump_steer_deg_per_mm: −0.006 to 0.006",
    ] {
        assert!(below.contains(words), "{words}: {below}");
    }
}

/// A proposal shows the margin of each constraint for the selected part. A save during the tuning does not discard the
/// proposal.
#[test]
fn a_proposal_shows_margins_and_survives_a_save() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_steering.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.run(
        "const field = document.querySelector('input[aria-label=\"strut_top x\"]'); \
         field.value = '-34'; field.dispatchEvent(new Event('change'))",
    );
    browser.wait(SETTLED);
    browser.run("document.getElementById('tune').click(); document.getElementById('save').click()");
    browser.wait("document.getElementById('accept')");
    browser.wait("document.querySelectorAll('#margins tbody tr').length === 3");
    let margins = "return [...document.querySelectorAll('#margins tbody tr')].map((row) => row.lastChild.textContent)";
    let shown = browser.run(margins);
    let exact = browser.run(
        "return studio.state.proposed.misfit.constraints.map((own) => Number(own.margin.toPrecision(3)))",
    );
    assert_eq!(exact.as_array().map(Vec::len), Some(3), "{exact}");
    for (text, number) in shown
        .as_array()
        .unwrap()
        .iter()
        .zip(exact.as_array().unwrap())
    {
        let number = number.as_f64().unwrap();
        assert!(
            text.as_str().unwrap().starts_with(&number.to_string()),
            "{text} {number}"
        );
    }
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    assert!(served.text().contains("-34.0"));
    assert_eq!(browser.console(), Vec::<String>::new());
}

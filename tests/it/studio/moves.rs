//! Tests of requests for moved points: the page sends one request for each move, and draws only the latest answer.

use super::browser::{READY, SETTLED, assert_drawn_as_solved, handle};
use super::webdriver::Browser;
use super::{Served, car, sample};
use serde_json::{Value, json};

/// A later request of a page stops the search of an earlier one. Requests of other pages continue.
#[test]
fn a_later_request_stops_an_earlier_one() {
    let served = car::served("car", car::as_it_is);
    let names = car::asked(&served.overview());
    let request = |of: &Value, turn: [u64; 2]| {
        let at = [1.0];
        json!({"of": of, "characteristics": names, "at": at, "curves_rack": null, "over": 0, "turn": turn})
    };
    // The search for the equilibria of this design takes long.
    let hard = car::moved(&served, &[("rear_upper_front_link_outer", 2, -150.0)]);
    let easy = car::moved(&served, &[("rear_upper_front_link_outer", 2, 1.0)]);
    std::thread::scope(|scope| {
        let first = scope.spawn(|| served.post("solve", &request(&hard, [7, 1])));
        let other = scope.spawn(|| served.post("solve", &request(&hard, [8, 9])));
        std::thread::sleep(std::time::Duration::from_millis(60));
        let second = served.post("solve", &request(&easy, [7, 2]));
        assert_eq!(
            second.json()["columns"],
            car::solve(&served, &easy)["columns"]
        );
        let first = first.join().unwrap();
        assert!(
            first.text().contains("later request") && first.status == 422,
            "{}",
            first.text()
        );
        let other = other.join().unwrap().json();
        assert_eq!(other["status"], car::solve(&served, &hard)["status"]);
    });
}

/// The page sends one request for each move. A hidden table shows the current design as soon as it opens.
#[test]
fn a_move_is_asked_for_once() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.wait(SETTLED);
    browser.run(
        "window.asked = 0; const send = window.fetch; \
         window.fetch = (what, ...rest) => { if (what === 'solve') window.asked += 1; return send(what, ...rest); }",
    );
    browser.drag(&handle("front", "strut_top"), [9, -7], 1);
    browser.wait(SETTLED);
    assert_eq!(browser.run("return window.asked"), json!(1));
    browser.keys(&["\u{e013}"]);
    browser.wait(SETTLED);
    assert_eq!(browser.run("return window.asked"), json!(2));

    browser.click("#tab-targets");
    let shown = browser.run(
        "return [...document.querySelectorAll('#pane-targets .panel:first-child tbody td:nth-child(2)')].map((cell) => Number(cell.textContent))",
    );
    let known =
        browser.run("return studio.state.answer.misfit.targets.map((target) => target.rms)");
    let list = |value: &Value| -> Vec<f64> {
        let all = value.as_array().unwrap().iter();
        all.map(|v| v.as_f64().unwrap()).collect()
    };
    let (shown, known) = (list(&shown), list(&known));
    assert!(!known.is_empty() && shown.len() == known.len());
    for (shown, known) in shown.iter().zip(&known) {
        assert!(
            (shown - known).abs() < 5.1e-3 * known.abs(),
            "{shown} {known}"
        );
    }
    browser.click("#tab-history");
    let deeds = "document.querySelectorAll('.deeds li').length";
    assert_eq!(browser.run(&format!("return {deeds}")), json!(3));
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// While an answer is late, the point stays under the pointer, and the page marks the old curves. A later design does
/// not wait for the late answer. The page never draws the late answer.
#[test]
fn a_late_answer_gives_way() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.wait(SETTLED);
    let point = handle("front", "lower_ball_joint");
    let place = format!(
        "const box = document.querySelector(\"{point}\").getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]"
    );
    let number = |value: &Value| value.as_f64().unwrap();
    let from = browser.run(&place);
    // The answer to the first move arrives after five seconds.
    browser.run(
        "window.came = 0; let asked = 0; const send = window.fetch; \
         window.fetch = async (what, ...rest) => { \
           const is_first = what === 'solve' && (asked += 1) === 1; \
           if (is_first) await new Promise((done) => setTimeout(done, 5000)); \
           const answer = await send(what, ...rest); \
           if (is_first) window.came = 1; \
           return answer; }",
    );
    browser.drag(&point, [16, 0], 1);
    browser.wait("document.documentElement.dataset.late === 'true'");
    let to = browser.run(&place);
    assert!((number(&to[0]) - number(&from[0]) - 16.0).abs() < 1.5);
    browser.keys(&["\u{e013}"]);
    browser.wait(SETTLED);
    assert_eq!(
        browser.run("return document.documentElement.dataset.late ?? null"),
        Value::Null
    );
    assert_eq!(browser.run("return window.came"), json!(0));
    let shown = browser.run("return studio.drawnValues()");
    browser.wait("window.came === 1");
    assert_eq!(browser.run("return studio.drawnValues()"), shown);
    browser.click("#save");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    browser.wait(SETTLED);
    assert!(assert_drawn_as_solved(&browser, &served.study) >= 6);
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// After a move, the page first draws the shown curves. The other curves of a chart, for other values of the sliders,
/// are marked as stale. When their values arrive, all curves are those of the moved design.
#[test]
fn curves_of_other_racks_are_stale_until_they_follow() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_axle.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.wait(SETTLED);
    // The test delays the request for all curves until it releases this request.
    browser.run(
        "const send = window.fetch; const gate = new Promise((open) => { window.release = open; }); \
         window.fetch = async (what, own) => { if (what === 'solve' && !JSON.parse(own.body).shown_only) await gate; return send(what, own); }",
    );
    let stale = "[...document.querySelectorAll('.chart .others')].map((g) => g.classList.contains('stale'))";
    let drawn = "[...document.querySelectorAll('.chart .others path')].map((p) => p.getAttribute('d')).join()";
    assert_eq!(browser.run(&format!("return {stale}.some(Boolean)")), false);
    let before = browser.run(&format!("return {drawn}"));
    browser.run(&format!(
        "document.querySelector({:?}).focus()",
        handle("front", "tie_rod_outer")
    ));
    browser.keys(&["\u{e013}"]);
    browser.wait(&format!("{stale}.every(Boolean)"));
    assert_eq!(browser.run("return studio.isSettled()"), false);
    browser.run("window.release()");
    browser.wait(SETTLED);
    // Hidden charts are updated after a short delay.
    browser.wait(&format!("!{stale}.some(Boolean)"));
    assert_ne!(browser.run(&format!("return {drawn}")), before);
    browser.click("#save");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    browser.wait(SETTLED);
    assert!(assert_drawn_as_solved(&browser, &served.study) >= 2);
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// The parts that change while a point moves have boxes of fixed size, so the browser lays out each part alone. Views
/// and charts have few layers: no element in them is transformed, and each chart clips its curves once.
#[test]
fn moving_parts_are_laid_out_alone() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_axle.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.wait(SETTLED);
    let loose = |selector: &str| {
        browser.run(&format!(
            "const all = [...document.querySelectorAll({selector:?})]; if (!all.length) return 'none'; \
             const alone = (e) => {{ const {{ contain }} = getComputedStyle(e); \
             return contain === 'strict' || (contain.includes('size') && contain.includes('layout')); }}; \
             return all.filter((e) => !alone(e)).length"
        ))
    };
    for selector in [
        ".plot",
        ".chartbox .values",
        ".chip .value",
        "#coordinates .cell input",
        "#coordinates .slope",
        "#coordinates .moved span",
    ] {
        assert_eq!(loose(selector), json!(0), "{selector}");
    }
    let counted = |selector: &str| {
        let found = browser.run(&format!(
            "return document.querySelectorAll({selector:?}).length"
        ));
        found.as_u64().unwrap()
    };
    assert_eq!(counted(".view [transform], .chart [transform]"), 0);
    assert!(counted(".chart") > 3);
    assert_eq!(counted(".chart [clip-path]"), counted(".chart"));
}

/// No value in the header or above a chart is truncated at the usual window size.
#[test]
fn values_fit_their_boxes() {
    let Some(browser) = Browser::start() else {
        return;
    };
    for name in ["double_wishbone_axle.toml", "macpherson_front.toml"] {
        let served = Served::of(&sample(name));
        browser.open(&served.address);
        browser.wait(READY);
        browser.wait(SETTLED);
        let cut = browser.run(
            "return [...document.querySelectorAll('.chip .value, .chip span, .chartbox output, .chartbox small')] \
             .filter((e) => e.scrollWidth > e.clientWidth + 1).map((e) => e.textContent)",
        );
        assert_eq!(cut, json!([]), "{name}");
        browser.open("about:blank");
    }
}

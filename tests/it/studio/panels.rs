//! Tests of the page's panels in a real browser, if one is installed: elastic parts, limits, vehicle data and targets.

use super::browser::{READY, SETTLED, assert_drawn_as_solved, handle, save_edits};
use super::webdriver::Browser;
use super::{Served, columns, sample, solved};
use serde_json::json;

const TUNED_RATES: &str = r#"
[outputs]
characteristics = ["toe", "toe_by_lateral_force_trail_30"]

[optimise]
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
  { bushing = "subframe_rear", stiffness = "y", range = [2000.0, 8000.0] },
]
targets = [
  { characteristic = "toe", over = "heave", at = 30.0, value = 0.15, tolerance = 0.01 },
  { figure = "toe_by_lateral_force_trail_30", value = -0.01, tolerance = 0.001 },
]
"#;

/// For an axle with elastic parts, the page draws its test results. The user can type rates, tune, accept, undo and
/// save them.
#[test]
fn rates_of_an_elastic_axle_are_typed_tuned_and_saved() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let text = sample("subframe_axle_compliance.toml") + TUNED_RATES;
    let served = Served::of(&text);
    browser.open(&served.address);
    browser.wait(READY);
    assert_eq!(assert_drawn_as_solved(&browser, &served.study), 4);
    browser.drag(&handle("front", "tie_rod_inner"), [0, -6], 5);
    browser.wait(SETTLED);
    browser.click("#undo");
    browser.wait(SETTLED);

    // A typed rate changes the curves. The user can undo this step.
    browser.click("#tab-parts");
    let figure = "return studio.drawnValues()['left_toe_by_lateral_force_trail_30_deg_per_kN'][1]";
    let before = browser.run(figure).as_f64().unwrap();
    browser.run(
        "const field = document.querySelector('[data-bushing=lower_arm_rear] td:nth-child(3) input'); \
         field.value = '5000'; field.dispatchEvent(new Event('change'))",
    );
    browser.wait("studio.state.overview.written.bushings.lower_arm_rear.stiffness[1] === 5000");
    browser.wait(SETTLED);
    let typed = browser.run(figure).as_f64().unwrap();
    assert!((typed - before).abs() > 1e-3, "{before} {typed}");
    browser.click("#undo");
    browser.wait(SETTLED);
    assert_eq!(browser.run(figure).as_f64().unwrap(), before);

    browser.click("#tune");
    browser.wait("document.getElementById('accept')");
    browser.wait("studio.state.proposed");
    let rows = browser.run("return document.querySelectorAll('#rates tbody tr').length");
    assert_eq!(rows, 2);
    let proposed = browser.run("return studio.state.proposed.misfit.value");
    assert!(proposed.as_f64().unwrap() < 1.0, "{proposed}");
    browser.click("#accept");
    browser.wait(SETTLED);
    browser.click("#save");
    // The page shows changed values before it writes them.
    browser.wait("document.getElementById('dialog').open");
    let shown = browser.run("return document.getElementById('dialog').textContent");
    assert!(shown.as_str().unwrap().contains("stiffness"), "{shown}");
    browser.click("#dialog button[value=yes]");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    let saved = served.text();
    assert!(!saved.contains("[700.0, 2500.0, 1800.0"), "{saved}");
    assert!(!saved.contains("[3000.0, 4000.0, 2500.0"), "{saved}");
    assert_eq!(assert_drawn_as_solved(&browser, &served.study), 4);
    let after = browser.run(figure).as_f64().unwrap();
    // Accepted coordinates are rounded to 0.01 mm. This can change the result by half a tolerance.
    assert!((after + 0.01).abs() < 5e-4, "{after}");
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// For one wheel with elastic parts, the page draws characteristics in equilibrium and test results. Both equal the
/// output of `hardpoint solve`.
#[test]
fn one_elastic_wheel_is_drawn_as_solved() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let asked = "\n[outputs]\ncharacteristics = [\"toe\", \"camber\", \"bump_steer\", \"toe_by_lateral_force\"]\n";
    let served = Served::of(&(sample("double_wishbone_compliance.toml") + asked));
    browser.open(&served.address);
    browser.wait(READY);
    assert_eq!(assert_drawn_as_solved(&browser, &served.study), 4);
    let offered = "return studio.state.overview.characteristics.filter((c) => c.available).map((c) => c.name)";
    let offered = browser.run(offered);
    let offered: Vec<&str> = offered
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n.as_str().unwrap())
        .collect();
    assert!(
        offered.contains(&"recession_by_braking_secant"),
        "{offered:?}"
    );
    assert!(!offered.contains(&"roll_centre_height"), "{offered:?}");
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// The page shows the limits that `hardpoint limits` prints, for a wheel and for a solid axle.
#[test]
fn limits_are_those_of_the_command() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let shown = |panel: &str| {
        format!(
            "[...document.querySelectorAll('#panel-{panel} tbody tr')].map((row) => [...row.children].map((cell) => cell.textContent))"
        )
    };
    for name in ["macpherson_front.toml", "solid_axle_solve.toml"] {
        let served = Served::of(&sample(name));
        browser.open(&served.address);
        browser.wait(READY);
        browser.click("#tab-constraints");
        let rows = shown("limits-of-the-mechanism");
        browser.wait(&format!("{rows}.length > 0"));
        let rows = browser.run(&format!("return {rows}"));
        let study = served.study.to_str().unwrap();
        let mut command = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
        let printed = command
            .args(["limits", study, "--format", "csv"])
            .output()
            .unwrap();
        let printed = String::from_utf8(printed.stdout).unwrap();
        let mut table = csv::Reader::from_reader(printed.as_bytes());
        let records: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
        assert!(records.len() >= 2, "{name}");
        for (row, record) in rows.as_array().unwrap().iter().zip(&records) {
            for limit in [2, 4] {
                let cell = row[limit].as_str().unwrap().replace('\u{2212}', "-");
                let cell: f64 = cell.parse().unwrap();
                // The first column contains the name of the table.
                let written: f64 = record[limit + 1].parse().unwrap();
                assert!(
                    (cell - written).abs() < 1e-4 * written.abs(),
                    "{name}: {row} {record:?}"
                );
                assert_eq!(
                    row[limit + 1],
                    record[limit + 2].replace('_', " "),
                    "{name}"
                );
            }
        }
        assert_eq!(rows.as_array().unwrap().len(), records.len(), "{name}");
        assert_eq!(browser.console(), Vec::<String>::new());
        browser.open("about:blank");
    }
}

/// The user types vehicle data on the page. Then the anti-dive and anti-squat outputs are available. The user can
/// remove the data again.
#[test]
fn vehicle_data_are_typed_on_the_page() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.click("#tab-parts");
    let is_offered =
        "studio.state.overview.characteristics.find((c) => c.name === 'anti_dive').available";
    assert_eq!(browser.run(&format!("return {is_offered}")), json!(false));
    for (key, value) in [
        ("wheelbase", "2700"),
        ("cg_height", "520"),
        ("position", "front"),
        ("brakes", "outboard"),
        ("brake_share_front", "0,65"),
    ] {
        browser.run(&format!(
            "const entry = document.querySelector('[data-vehicle-key={key}]').querySelector('input, select'); \
             entry.value = '{value}'; entry.dispatchEvent(new Event('change'))"
        ));
        browser.wait(&format!(
            "studio.state.overview.written.vehicle?.{key} !== undefined"
        ));
        browser.wait(SETTLED);
    }
    assert_eq!(browser.run(&format!("return {is_offered}")), json!(true));
    browser.run(
        "const entry = document.querySelector('[data-vehicle-key=cg_height] input'); \
         entry.value = ''; entry.dispatchEvent(new Event('change'))",
    );
    browser.wait("studio.state.overview.written.vehicle.cg_height === undefined");
    assert_eq!(browser.run(&format!("return {is_offered}")), json!(false));
    browser.click("#undo");
    browser.wait(SETTLED);
    save_edits(&browser);
    let saved = served.text();
    for line in [
        "wheelbase = 2700",
        "cg_height = 520",
        "position = \"front\"",
        "brake_share_front = 0.65",
    ] {
        assert!(saved.contains(line), "{line}: {saved}");
    }
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// A band over a part of the motion is a target only in that part.
#[test]
fn a_target_limits_a_part_of_the_motion() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("macpherson_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    let count = "studio.state.overview.targets.length";
    let before = browser.run(&format!("return {count}")).as_u64().unwrap();
    browser.click("[data-column=caster_deg] .adder");
    browser.run(
        "const put = (label, value) => { \
           const rows = [...document.querySelectorAll('#dialog label')]; \
           const row = rows.find((row) => row.textContent.startsWith(label)); \
           row.querySelector('input').value = value; }; \
         put('Lower', '3.1'); put('Upper', '3.9'); put('From', '-20'); put('To', '30')",
    );
    browser.click("#dialog button[value=add]");
    browser.wait(&format!("{count} === {}", before + 1));
    let points = browser.run("return studio.state.overview.targets.at(-1).points");
    let points = points.as_array().unwrap();
    assert!(points.len() > 2);
    for point in points {
        let travel = point[0].as_f64().unwrap();
        assert!((-20.0..=30.0).contains(&travel), "{travel}");
        assert_eq!((&point[1], &point[2]), (&json!(3.1), &json!(3.9)));
    }
    browser.wait(SETTLED);
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// A script that clicks the middle of a member in a view.
fn click_member(view: &str, name: &str) -> String {
    format!(
        "const line = document.querySelector('[data-view={view}] [data-member={name}] .hit'); \
         line.dispatchEvent(new PointerEvent('pointerdown', {{ bubbles: true }}))"
    )
}

/// A script that clicks the button with this text in an element.
fn click_button(within: &str, text: &str) -> String {
    format!(
        "[...document.querySelectorAll('{within} button')].find((b) => b.textContent.startsWith('{text}')).click()"
    )
}

/// The Escape key cancels the choice of members. Closing the message cancels it, too.
#[test]
fn a_choice_of_members_is_cancelled() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("double_wishbone_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.click("#tab-constraints");
    for cancel in ["key", "message"] {
        browser.run(&click_button("#pane-constraints", "Clearance"));
        browser.wait("document.documentElement.dataset.picking");
        match cancel {
            "key" => browser.keys(&["\u{E00C}"]),
            _ => browser.click("#banner .close"),
        }
        browser.wait("!document.documentElement.dataset.picking");
    }
    assert_eq!(browser.console(), Vec::<String>::new());
}

/// Smallest clearance of tie rod and lower arm that `hardpoint solve` prints for the saved study.
fn least_clearance(served: &Served) -> f64 {
    let asked = "\n[outputs]\ncharacteristics = [\"camber\"]\nclearances = [[\"tie_rod\", \"lower_arm_front\"]]\n";
    let saved = served.text();
    let outputs = saved.find("\n[outputs]").unwrap();
    let rest = outputs + 1 + saved[outputs + 1..].find("\n[").unwrap();
    let study = [&saved[..outputs], &saved[rest..], asked].concat();
    std::fs::write(&served.study, study).unwrap();
    let curves = columns(&solved(&served.study));
    let (_, gaps) = curves
        .iter()
        .find(|(name, _)| name.contains("clearance"))
        .unwrap();
    gaps.iter().flatten().copied().fold(f64::INFINITY, f64::min)
}

/// The user adds a clearance by clicking two members, a kept length from the list, a joint angle, and limits of a quantity.
/// The page shows the margins that `hardpoint optimise` checks, and saves the constraints.
#[test]
fn constraints_are_added_by_clicking_members() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let served = Served::of(&sample("double_wishbone_front.toml"));
    browser.open(&served.address);
    browser.wait(READY);
    browser.click("#tab-constraints");
    let begin = |text: &str| browser.run(&click_button("#pane-constraints", text));
    let add = || {
        browser.run(&click_button("#dialog", "Add constraint"));
    };
    let count = "studio.state.overview.written.optimise.constraints?.length";

    begin("Clearance");
    browser.run(&click_member("front", "tie_rod"));
    browser.run(&click_member("space", "lower_arm_front"));
    browser.wait("document.getElementById('dialog').open");
    add();
    browser.wait(&format!("{count} === 1"));
    browser.wait(SETTLED);
    let margin =
        browser.run("return studio.state.answer.misfit.constraints.map((c) => [c.name, c.margin])");
    assert_eq!(
        margin[0][0],
        json!("clearance of tie_rod and lower_arm_front")
    );

    // Two members that share a joint have no clearance: the dialog stays open with the reason.
    begin("Clearance");
    browser.run(&click_member("top", "lower_arm_rear"));
    browser.run(&click_member("top", "lower_arm_front"));
    browser.wait("document.getElementById('dialog').open");
    add();
    browser.wait("document.querySelector('#dialog .bad').textContent.includes('share a joint')");
    browser.run(&click_button("#dialog", "Cancel"));
    browser.wait("!document.getElementById('dialog').open");

    begin("Length");
    browser.run(&click_button("#banner", "Choose from a list"));
    browser.wait("document.getElementById('dialog').open");
    add();
    browser.wait(&format!("{count} === 2"));
    begin("Angle");
    browser.wait("document.getElementById('dialog').open");
    add();
    browser.wait(&format!("{count} === 3"));

    // Adds a limit of a quantity from its chart.
    browser.run(&click_button(
        ".chartbox[data-column^=camber_deg]",
        "+ target",
    ));
    browser.wait("document.getElementById('dialog').open");
    browser.run(
        "const kind = document.querySelector('#dialog select'); kind.value = 'limit'; kind.dispatchEvent(new Event('change'))",
    );
    browser.run(&click_button("#dialog", "Add"));
    browser.wait(&format!("{count} === 4"));
    browser.wait(SETTLED);

    // The offered limits contain the present curve.
    let violated =
        "return studio.state.answer.misfit.constraints.filter((c) => c.is_violated).length";
    assert_eq!(browser.run(violated), json!(0));

    // A click on the name of a constraint marks its members.
    browser.run(&click_button("#pane-constraints .panel", "clearance of"));
    let marked = "return [...document.querySelectorAll('[data-view=front] .member.marked')].map((m) => m.dataset.member)";
    let marked = browser.run(marked);
    assert_eq!(marked, json!(["lower_arm_front", "tie_rod"]));

    save_edits(&browser);

    // The margin of the clearance is the smallest one of `hardpoint solve` minus the limit of 5 mm. Between stations it may be
    // slightly smaller.
    let least = least_clearance(&served);
    let margin = margin[0][1].as_f64().unwrap();
    let excess = least - 5.0 - margin;
    assert!((-1e-9..0.1).contains(&excess), "{least} {margin}");
    assert_eq!(browser.console(), Vec::<String>::new());
}

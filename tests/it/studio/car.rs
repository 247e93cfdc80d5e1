//! Tests of a car in the live page: answers equal those of `hardpoint solve`, gradients equal slopes, and the server
//! saves three files.

use super::answers::answered;
use super::browser::{READY, SETTLED};
use super::tuning::tuned;
use super::webdriver::Browser;
use super::{Served, columns, sample, solved};
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

/// Starts the server for a sample car and its axles.
pub(super) fn served(name: &str, changed: impl Fn(&str, String) -> String) -> Served {
    let ends = ["_front", "_rear", ""];
    Served::of_files(ends.map(|end| {
        let file = format!("{name}{end}.toml");
        let text = changed(end, sample(&file));
        (file, text)
    }))
}

pub(super) fn as_it_is(_: &str, text: String) -> String {
    text
}

fn file(served: &Served, name: &str) -> PathBuf {
    served.folder.path().join(name)
}

fn read(served: &Served, name: &str) -> String {
    fs::read_to_string(file(served, name)).unwrap()
}

/// Characteristics that the page requests when it opens.
pub(super) fn asked(overview: &Value) -> Vec<Value> {
    let all = overview["characteristics"].as_array().unwrap().iter();
    let asked = all.filter(|c| c["asked"] == true && c["available"] == true);
    asked.map(|c| c["name"].clone()).collect()
}

pub(super) fn solve(served: &Served, of: &Value) -> Value {
    let names = asked(&served.overview());
    let message =
        json!({"of": of, "characteristics": names, "at": [1.0], "curves_rack": null, "over": 0});
    served.post("solve", &message).json()
}

/// Returns the design of the served study with coordinates changed, one for each entry of `moves`.
pub(super) fn moved(served: &Served, moves: &[(&str, usize, f64)]) -> Value {
    let overview = served.overview();
    let points = overview["points"].as_array().unwrap();
    let mut design = overview["design"].clone();
    for (name, axis, by) in moves {
        let place = points.iter().position(|p| p["name"] == *name).unwrap();
        let old = design[place][axis].as_f64().unwrap();
        design[place][axis] = json!(old + by);
    }
    json!({"digest": overview["digest"], "design": design})
}

fn save(served: &Served, of: &Value, anyway: bool) -> super::client::Answer {
    let message = json!({"of": of, "name": null, "anyway": anyway});
    served.post("save", &message)
}

/// The test moves points of both axles, including wheel centres. Each number of the page then equals that of the saved
/// files, bit for bit. The table of load cases also equals them.
#[test]
fn answers_are_those_of_solve() {
    for name in ["car", "formula_student_car"] {
        let served = served(name, as_it_is);
        let moves = [
            ("front_tie_rod_inner", 2, 1.37),
            ("front_wheel_centre", 0, 2.5),
            ("rear_wheel_centre", 0, -1.25),
            ("rear_wheel_centre", 2, 0.5),
        ];
        let of = moved(&served, &moves);
        let answer = solve(&served, &of);
        let csv = served.post("csv", &of);
        let points = served.post("points", &of);
        assert_eq!(save(&served, &of, false).status, 200, "{name}");
        let expected = solved(&served.study);
        assert_eq!(csv.body, expected, "{name}");
        let mut export = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
        export
            .arg("export")
            .arg(&served.study)
            .args(["--to", "csv"]);
        let exported = export.assert().success().get_output().stdout.clone();
        assert_eq!(points.body, exported, "{name}");
        let expected = columns(&expected);
        let mut compared = 0;
        for (column, values) in answered(&answer) {
            let Some((_, printed)) = expected.iter().find(|(name, _)| *name == column) else {
                continue;
            };
            assert_eq!(&values, printed, "{name}: {column}");
            compared += 1;
        }
        assert!(compared >= 10, "{name}");
    }
}

/// Difference quotient of fourth order.
fn slope(at: impl Fn(f64) -> f64, h: f64) -> f64 {
    (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
}

/// The misfit has targets of load cases, and in one car a target of a single axle. The gradients of the misfit and of
/// each target equal slopes. The test includes the wheel centres, because the wheelbase couples them to the other axle.
#[test]
fn gradients_of_the_misfit_are_its_slopes() {
    for name in ["car", "formula_student_car"] {
        let served = served(name, as_it_is);
        let of = moved(&served, &[("front_tie_rod_inner", 2, 0.4)]);
        let misfit = |by: f64, point: &str, axis: usize| {
            let of = moved(
                &served,
                &[("front_tie_rod_inner", 2, 0.4), (point, axis, by)],
            );
            solve(&served, &of)["misfit"].clone()
        };
        let here = solve(&served, &of)["misfit"].clone();
        let overview = served.overview();
        let points = overview["points"].as_array().unwrap();
        let place = |name: &str| points.iter().position(|p| p["name"] == name).unwrap();
        for (point, axis) in [
            ("front_wheel_centre", 0),
            ("front_tie_rod_outer", 2),
            ("rear_wheel_centre", 0),
            ("rear_wheel_centre", 1),
        ] {
            let near = |said: &Value, at: &dyn Fn(f64) -> f64| {
                let said = said[place(point)][axis].as_f64().unwrap();
                let slope = slope(at, 0.05);
                let close = 1e-6 * slope.abs().max(1.0);
                assert!(
                    (slope - said).abs() < close,
                    "{name} {point} {axis}: {slope} {said}"
                );
            };
            near(&here["gradient"], &|by| {
                misfit(by, point, axis)["value"].as_f64().unwrap()
            });
            for k in 0..here["targets"].as_array().unwrap().len() {
                near(&here["targets"][k]["gradient"], &|by| {
                    misfit(by, point, axis)["targets"][k]["rms"]
                        .as_f64()
                        .unwrap()
                });
            }
        }
    }
}

/// The effect of a coordinate on the results of every case equals the slope of the results.
#[test]
fn influences_are_slopes_of_the_results() {
    let served = served("car", as_it_is);
    let names = ["wheel_load", "camber_to_road", "roll", "roll_centre_height"];
    let values = |by: f64| {
        let of = moved(&served, &[("rear_toe_link_inner", 2, by)]);
        let message = json!({"of": of, "characteristics": names, "at": [0.0], "curves_rack": null, "over": 0});
        answered(&served.post("solve", &message).json())
    };
    let overview = served.overview();
    let points = overview["points"].as_array().unwrap();
    let point = points
        .iter()
        .position(|p| p["name"] == "rear_toe_link_inner")
        .unwrap();
    let of = moved(&served, &[]);
    let message = json!({"of": of, "characteristics": names, "point": point, "axis": 2});
    let found = served.post("influence", &message).json();
    let h = 0.1;
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| values(k * h));
    let mut compared = 0;
    for (k, column) in found["columns"].as_array().unwrap().iter().enumerate() {
        assert_eq!(column["column"], a[k].0.as_str());
        for (case, said) in column["slopes"].as_array().unwrap().iter().enumerate() {
            let [a, b, c, d] = [&a, &b, &c, &d].map(|at| at[k].1[case].unwrap());
            let slope = (8.0 * (c - b) - (d - a)) / (12.0 * h);
            let said = said.as_f64().unwrap();
            let near = 1e-6 * slope.abs().max(1.0);
            assert!((slope - said).abs() < near, "{column} {case}: {slope}");
            compared += 1;
        }
    }
    assert_eq!(compared, 5 * (4 + 4 + 1 + 2));
}

/// If another program changed an axle's file, the server does not overwrite this file. The user can merge the page's
/// changes into it. The file keeps the changes of the other program.
#[test]
fn changed_files_are_kept_and_merged() {
    let served = served("car", as_it_is);
    let edits = json!([
        {"path": ["rear", "anti_roll_bar", "rate"], "value": 450000.0},
        {"path": ["car", "brake_share_front"], "value": 0.7},
    ]);
    let digest = served.overview()["digest"].clone();
    let edited = served.post("edit", &json!({"digest": digest, "edits": edits}));
    let edited = edited.json();
    assert_ne!(edited["digest"], digest);
    assert_eq!(edited["base"], digest);
    let mut of = moved(&served, &[("front_tie_rod_inner", 2, 1.5)]);
    of["digest"] = edited["digest"].clone();
    let before = read(&served, "car.toml");
    let foreign = format!("# mine\n{}", read(&served, "car_rear.toml"));
    let foreign = foreign.replace("force = 3650.0", "force = 3660.0");
    fs::write(file(&served, "car_rear.toml"), &foreign).unwrap();
    let refused = save(&served, &of, false);
    assert_eq!(refused.status, 409, "{}", refused.text());
    assert_eq!(read(&served, "car.toml"), before);
    assert_eq!(read(&served, "car_rear.toml"), foreign);
    assert_eq!(read(&served, "car_front.toml"), sample("car_front.toml"));

    assert_eq!(save(&served, &of, true).status, 200);
    let rear = foreign.replace("rate = 400000.0", "rate = 450000.0");
    assert_eq!(read(&served, "car_rear.toml"), rear);
    let car = before.replace("brake_share_front = 0.68", "brake_share_front = 0.7");
    assert_eq!(read(&served, "car.toml"), car);
    let front = sample("car_front.toml").replace("330.0, 243.0]", "330.0, 244.5]");
    assert_eq!(read(&served, "car_front.toml"), front);
}

/// The page cannot change the names of the axles' files. If another program changes these names, a save writes nothing.
#[test]
fn files_of_the_axles_are_not_exchanged() {
    let served = served("car", as_it_is);
    let digest = served.overview()["digest"].clone();
    for path in [json!(["car", "front"]), json!(["car"])] {
        let edits = json!([{"path": path, "value": "car_rear.toml"}]);
        let refused = served.post("edit", &json!({"digest": digest, "edits": edits}));
        assert_eq!(refused.status, 422);
        let why = refused.text();
        assert!(why.contains("the files of the axles"), "{why}");
    }
    let of = moved(&served, &[("front_tie_rod_inner", 2, 1.5)]);
    let car = read(&served, "car.toml").replace("car_front.toml", "other.toml");
    fs::write(file(&served, "other.toml"), sample("car_front.toml")).unwrap();
    fs::write(file(&served, "car.toml"), &car).unwrap();
    let refused = save(&served, &of, true);
    assert_eq!(refused.status, 422, "{}", refused.text());
    let why = refused.text();
    assert!(why.contains("names other files of its axles"), "{why}");
    for name in ["other.toml", "car_front.toml"] {
        assert_eq!(read(&served, name), sample("car_front.toml"));
    }
    assert_eq!(read(&served, "car.toml"), car);
}

/// If an axle is missing, a design is invalid, or one axle is used for both ends, the server writes nothing.
#[test]
fn nothing_is_written_halfway() {
    let served = served("car", as_it_is);
    let of = moved(&served, &[("front_tie_rod_inner", 2, 1.5)]);
    fs::rename(file(&served, "car_rear.toml"), file(&served, "away.toml")).unwrap();
    let refused = save(&served, &of, false);
    assert_eq!(refused.status, 422);
    assert!(
        refused.text().contains("car_rear.toml"),
        "{}",
        refused.text()
    );
    assert_eq!(read(&served, "car_front.toml"), sample("car_front.toml"));
    fs::rename(file(&served, "away.toml"), file(&served, "car_rear.toml")).unwrap();
    let digest = served.overview()["digest"].clone();
    let edit = json!([{"path": ["car", "sprung_mass"], "value": -1.0}]);
    let refused = served.post("edit", &json!({"digest": digest, "edits": edit}));
    assert_eq!(refused.status, 422);
    assert!(refused.text().contains("above 0"), "{}", refused.text());

    let name = json!({"of": of, "name": "car_front.toml", "anyway": true});
    assert_eq!(served.post("save", &name).status, 422);
    let name = json!({"of": of, "name": "new.toml", "anyway": false});
    assert_eq!(served.post("save", &name).status, 200);
    assert_eq!(served.post("save", &name).status, 409);
    assert_eq!(served.files().len(), 6);
    assert_eq!(read(&served, "car_front.toml"), sample("car_front.toml"));
    let new = read(&served, "new_front.toml");
    assert!(new.contains("330.0, 244.5]"), "{new}");
    assert!(read(&served, "new.toml").contains("front = \"new_front.toml\""));
}

/// The server immediately refuses points that form no suspension. It gives the same reason as for a file.
#[test]
fn implausible_points_are_refused() {
    let served = served("car", as_it_is);
    let of = moved(&served, &[("rear_lower_front_link_inner", 2, 225_000.0)]);
    let message =
        json!({"of": of, "characteristics": ["roll"], "at": [0.0], "curves_rack": null, "over": 0});
    let refused = served.post("solve", &message);
    assert_eq!(refused.status, 422);
    let why = refused.text();
    assert!(
        why.contains("rear axle") && why.contains("impossible for a suspension"),
        "{why}"
    );
}

/// If one file describes both axles, the server refuses a change of only one axle, because the other axle would change
/// too.
#[test]
fn one_file_for_both_axles_is_not_torn() {
    let served = served("car", |end, text| match end {
        "" => {
            let (text, _) = text.split_once("[sweep]").unwrap();
            text.replace("car_front.toml", "car_rear.toml")
        }
        _ => text.replace("position = \"rear\"\n", ""),
    });
    let of = moved(&served, &[("front_wheel_centre", 2, 1.0)]);
    let refused = save(&served, &of, false);
    assert_eq!(refused.status, 422, "{}", refused.text());
    assert!(refused.text().contains("both axles"), "{}", refused.text());
    let both = [
        ("front_wheel_centre", 2, 1.0),
        ("rear_wheel_centre", 2, 1.0),
    ];
    assert_eq!(save(&served, &moved(&served, &both), false).status, 200);
}

/// A tuning starts from the moved design, but its ranges are relative to the design in the file. If the moved design is
/// outside a range, the proposal reports this. A locked coordinate keeps its value.
#[test]
fn tunings_keep_locks_and_tell_wide_ranges() {
    let served = served("car", as_it_is);
    let of = moved(&served, &[("front_tie_rod_inner", 2, 17.0)]);
    let tune = |locked: &[[bool; 3]]| {
        let state = tuned(&served, &of, locked);
        assert!(state["error"].is_null(), "{state}");
        state["proposal"].clone()
    };
    let said = |proposal: &Value| proposal["remarks"].to_string();
    let overview = served.overview();
    let points = overview["points"].as_array().unwrap();
    let place = |name: &str| points.iter().position(|p| p["name"] == name).unwrap();
    let [front, rear] = ["front_tie_rod_inner", "rear_toe_link_inner"].map(place);
    let free = vec![[false; 3]; points.len()];
    let proposal = tune(&free);
    assert!(
        said(&proposal).contains("2 outside of its range"),
        "{proposal}"
    );
    assert_ne!(proposal["design"][front][2], of["design"][front][2]);

    let mut locked = free;
    locked[front][2] = true;
    let proposal = tune(&locked);
    assert!(
        !said(&proposal).contains("outside of its range"),
        "{proposal}"
    );
    assert_eq!(proposal["design"][front], of["design"][front]);
    assert_ne!(proposal["design"][rear], of["design"][rear]);
    assert!(!proposal["edits"].as_array().unwrap().is_empty());
}

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
    browser.click("#save");
    browser.wait("document.querySelector('dialog button[value=yes]') !== null");
    browser.click("dialog button[value=yes]");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
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
    browser.click("#save");
    browser.wait("document.querySelector('dialog button[value=yes]') !== null");
    browser.click("dialog button[value=yes]");
    browser.wait("document.getElementById('banner').textContent.includes('saved')");
    let text = served.text();
    let target = text
        .lines()
        .find(|line| line.contains("case = \"turn\"") && line.contains("2.5"));
    let target = target.unwrap_or_else(|| panic!("{text}"));
    assert!(target.contains("\"roll\""), "{target}");
    assert_eq!(browser.console(), Vec::<String>::new());
}

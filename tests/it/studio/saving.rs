//! Saved files and their places. Answers are those of the other commands.

use super::{Served, columns, sample, solved};
use serde_json::{Value, json};
use std::fs;

/// The columns of an answer, by name.
pub(super) fn answered(answer: &Value) -> Vec<(String, Vec<Option<f64>>)> {
    let columns = answer["columns"].as_array().unwrap().iter();
    let values = |c: &Value| {
        c["values"]
            .as_array()
            .unwrap()
            .iter()
            .map(Value::as_f64)
            .collect()
    };
    columns
        .map(|c| (c["column"].as_str().unwrap().to_owned(), values(c)))
        .collect()
}

fn solve(served: &Served, of: &Value) -> Value {
    let overview = served.overview();
    let list = |name: &str| overview[name].as_array().unwrap();
    let asked = list("characteristics")
        .iter()
        .filter(|c| c["asked"] == true);
    let asked: Vec<&Value> = asked.map(|c| &c["name"]).collect();
    let at: Vec<&Value> = list("sliders")
        .iter()
        .map(|slider| &slider["home"])
        .collect();
    let message =
        json!({"of": of, "characteristics": asked, "at": at, "curves_rack": null, "over": 0});
    served.post("solve", &message).json()
}

/// The study of an axle with less of a grid.
fn of_few_stations(text: &str) -> String {
    let mut text = text.to_owned();
    for (many, few) in [
        ("to = 3.0, steps = 7", "to = 3.0, steps = 3"),
        ("to = 3.0, steps = 13", "to = 3.0, steps = 3"),
        ("to = 40.0, steps = 5", "to = 40.0, steps = 2"),
        ("to = 360.0, steps = 9", "to = 360.0, steps = 3"),
    ] {
        text = text.replace(many, few);
    }
    text
}

/// The file that `hardpoint export` makes of a study.
fn exported(study: &std::path::Path, format: &str) -> Vec<u8> {
    let mut command = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
    command.arg("export").arg(study).args(["--to", format]);
    command.assert().success().get_output().stdout.clone()
}

/// The curves of a moved design equal those that `hardpoint solve` prints for the saved study, to the last bit, and
/// so does the CSV. The test covers several topologies and frames, for one wheel and for both.
#[test]
fn answers_are_those_of_solve() {
    for (name, point, axis) in [
        ("macpherson_front.toml", "strut_top", 1),
        ("formula_student_front.toml", "upper_ball_joint", 2),
        ("five_link_rear.toml", "wheel_centre", 2),
        ("semi_trailing_arm_rear.toml", "wheel_centre", 1),
        ("macpherson_axle_front.toml", "tie_rod_inner", 2),
        ("five_link_axle.toml", "wheel_centre", 2),
    ] {
        let served = Served::of(&of_few_stations(&sample(name)));
        let of = served.moved(point, axis, 1.37);
        let answer = solve(&served, &of);
        let csv = served.post("csv", &of);
        let files = [("points", "csv"), ("dxf", "dxf")]
            .map(|(file, format)| (format, served.post(file, &of)));
        assert_eq!(
            served
                .post("save", &json!({"of": of, "name": null, "anyway": false}))
                .status,
            200,
            "{name}"
        );
        let expected = solved(&served.study);
        assert_eq!(csv.body, expected, "{name}");
        for (format, file) in files {
            let made = exported(&served.study, format);
            assert_eq!(file.body, made, "{name}: {format}");
            assert!(made.len() > 200, "{name}: {format}");
        }
        let expected = columns(&expected);
        let mut compared = 0;
        for (column, values) in answered(&answer) {
            let Some((_, printed)) = expected.iter().find(|(name, _)| *name == column) else {
                continue;
            };
            assert_eq!(&values, printed, "{name}: {column}");
            compared += 1;
        }
        assert!(compared >= 3, "{name}");
    }
}

/// The slope of the misfit by coordinates, against differences of fourth order of the misfit itself: of one wheel,
/// of both, and of both where the right one has a point of its own.
#[test]
fn gradients_of_the_misfit_are_its_slopes() {
    let own = "[axle.right.hardpoints]\ntie_rod_inner = [-110.0, -331.0, 243.5]\n";
    let axle = of_few_stations(&sample("macpherson_axle_front.toml"));
    let (before, after) = axle.split_once("[axle]").unwrap();
    let (_, after) = after.split_once("\n\n").unwrap();
    let unlike = format!("{before}{own}\n{after}");
    for text in [sample("macpherson_front.toml"), axle.clone(), unlike] {
        let served = Served::of(&text);
        let misfit = |answer: &Value| answer["misfit"]["value"].as_f64().unwrap();
        let of = served.moved("strut_top", 0, 0.4);
        let here = solve(&served, &of);
        let gradient = &here["misfit"]["gradient"];
        for (point, axis) in [(3, 1), (5, 2)] {
            let at = |by: f64| {
                let mut of = of.clone();
                of["design"][point][axis] = json!(of["design"][point][axis].as_f64().unwrap() + by);
                misfit(&solve(&served, &of))
            };
            let h = 0.05;
            let slope = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            let said = gradient[point][axis].as_f64().unwrap();
            let near = 1e-5 * slope.abs().max(1.0);
            assert!(
                (slope - said).abs() < near,
                "{point} {axis}: {slope} {said}"
            );
        }
    }
}

/// Margins are in the unit in which the study writes the limits: the same numbers read as inches have the same margins, in
/// inches, and only angles stay in degrees.
#[test]
fn margins_have_the_unit_of_the_study() {
    // At two stations no extremes are sought between stations, which are sought near limits only.
    let sample = sample("formula_student_front.toml");
    let lines = sample.lines().map(|line| match line.split_once(" = ") {
        Some(("travel", _)) => "travel = [-30.0, 30.0]",
        _ => line,
    });
    let text = lines.collect::<Vec<_>>().join("\n");
    let inches = text.replace("length_unit = \"mm\"", "length_unit = \"in\"");
    assert_ne!(text, inches);
    let [mm, inches] = [text, inches].map(|text| {
        let served = Served::of(&text);
        let answer = solve(&served, &served.moved("tie_rod_inner", 2, 0.0));
        answer["misfit"].clone()
    });
    let of = |misfit: &Value, list: &str| misfit[list].as_array().unwrap().clone();
    let pairs = || {
        let inches = of(&inches, "constraints");
        of(&mm, "constraints").into_iter().zip(inches)
    };
    assert!(pairs().count() >= 5);
    for (mm, inches) in pairs() {
        let margins = [&mm, &inches].map(|c| c["room"].as_f64().unwrap());
        assert!((margins[0] - margins[1]).abs() < 1e-9, "{mm} {inches}");
        let is_angle = mm["name"].as_str().unwrap().contains("articulation");
        let units = if is_angle { ["deg"; 2] } else { ["mm", "in"] };
        assert_eq!([&mm["unit"], &inches["unit"]], units, "{mm}");
        assert_eq!(mm["is_violated"], json!(margins[0] < 0.0));
    }
    for (misfit, unit) in [(&mm, "mm"), (&inches, "in")] {
        for target in of(misfit, "targets") {
            assert_eq!(target["worst_at_unit"], unit, "{target}");
        }
    }
}

/// Effect of a coordinate on a curve, compared with the curves themselves.
#[test]
fn influences_are_slopes_of_the_curves() {
    let served = Served::of(&sample("double_wishbone_front.toml"));
    let of = served.moved("tie_rod_inner", 2, 0.0);
    let overview = served.overview();
    let points = overview["points"].as_array().unwrap();
    let point = points
        .iter()
        .position(|p| p["name"] == "tie_rod_inner")
        .unwrap();
    let asked = json!({"of": of, "characteristics": ["toe"], "point": point, "axis": 2});
    let found = served.post("influence", &asked).json();
    let toe = |by: f64| {
        let of = served.moved("tie_rod_inner", 2, by);
        let message = json!({"of": of, "characteristics": ["toe"], "at": [0.0, 0.0], "curves_rack": null, "over": 0});
        answered(&served.post("solve", &message).json())
            .into_iter()
            .find(|(name, _)| name == "toe_deg")
            .unwrap()
            .1
    };
    let (up, down) = (toe(0.01), toe(-0.01));
    let columns = found["columns"].as_array().unwrap();
    let slopes = &columns.iter().find(|c| c["column"] == "toe_deg").unwrap()["slopes"];
    for station in 0..up.len() {
        let slope = (up[station].unwrap() - down[station].unwrap()) / 0.02;
        let said = slopes[station].as_f64().unwrap();
        assert!((slope - said).abs() < 1e-5, "{station}: {slope} {said}");
    }
}

#[test]
fn a_save_keeps_comments_and_the_rest() {
    let text = sample("macpherson_front.toml");
    let served = Served::of(&text);
    let of = served.moved("strut_top", 2, 2.5);
    let saved = served
        .post("save", &json!({"of": of, "name": null, "anyway": false}))
        .json();
    let after = served.text();
    let differ = text
        .lines()
        .zip(after.lines())
        .filter(|(a, b)| a != b)
        .count();
    assert_eq!((text.lines().count(), differ), (after.lines().count(), 1));
    // Another move on top of it, with the digest of what was written.
    assert_eq!(saved["digest"], served.overview()["digest"]);
    // A tab that still has the text from before is told.
    let late = served.post("save", &json!({"of": of, "name": null, "anyway": false}));
    assert_eq!(late.status, 409, "{}", late.text());
    assert_eq!(served.text(), after);
}

#[test]
fn a_file_that_was_changed_is_not_overwritten() {
    let text = sample("macpherson_front.toml");
    let served = Served::of(&text);
    let of = served.moved("strut_top", 2, 2.5);
    let edited = text.replacen("tie_rod_outer", "# by hand\ntie_rod_outer", 1);
    assert_ne!(edited, text);
    fs::write(&served.study, &edited).unwrap();
    let message = |anyway: bool| json!({"of": of, "name": null, "anyway": anyway});
    assert_eq!(served.post("save", &message(false)).status, 409);
    assert_eq!(served.text(), edited);
    // Asked for, the moved coordinate alone goes into the file as it is now.
    assert_eq!(served.post("save", &message(true)).status, 200);
    let merged = served.text();
    assert!(merged.contains("# by hand"));
    let differ = edited
        .lines()
        .zip(merged.lines())
        .filter(|(a, b)| a != b)
        .count();
    assert_eq!(differ, 1);
    // A file that is no study any more gets nothing.
    fs::write(&served.study, "[suspension]\n").unwrap();
    assert_eq!(served.post("save", &message(true)).status, 422);
    assert_eq!(served.text(), "[suspension]\n");
    assert_eq!(served.files(), ["study.toml"]);
}

#[test]
fn other_names_stay_beside_the_study() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let before = served.text();
    let of = served.moved("strut_top", 2, 2.5);
    let save = |name: &str, anyway: bool| {
        served
            .post("save", &json!({"of": of, "name": name, "anyway": anyway}))
            .status
    };
    let outside = served.folder.path().parent().unwrap().join("escaped.toml");
    for name in [
        "../escaped.toml",
        "/tmp/escaped.toml",
        "a/b.toml",
        "..",
        "",
        ".toml",
        ".hidden.toml",
        "x.txt",
        "a\\b.toml",
        "nul\u{0}.toml",
        "study.toml",
        "./study.toml",
        "c:x.toml",
        "con.toml",
        "LPT1.backup.toml",
        "a\u{202e}b.toml",
    ] {
        assert_eq!(save(name, true), 422, "{name:?}");
    }
    assert!(!outside.exists());
    assert_eq!(served.files(), ["study.toml"]);
    assert_eq!(save("other.toml", false), 200);
    assert_eq!(save("other.toml", false), 409);
    assert_eq!(save("other.toml", true), 200);
    assert_eq!(served.files(), ["other.toml", "study.toml"]);
    assert_eq!(served.text(), before);
    assert_ne!(
        fs::read_to_string(served.folder.path().join("other.toml")).unwrap(),
        before
    );
}

/// A link beside the study that leads elsewhere is replaced, not followed.
#[cfg(unix)]
#[test]
fn links_do_not_lead_out_of_the_folder() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let elsewhere = tempfile::tempdir().unwrap();
    let precious = elsewhere.path().join("precious.toml");
    fs::write(&precious, "precious").unwrap();
    std::os::unix::fs::symlink(&precious, served.folder.path().join("link.toml")).unwrap();
    let of = served.moved("strut_top", 2, 2.5);
    let save = json!({"of": of, "name": "link.toml", "anyway": true});
    assert_eq!(served.post("save", &save).status, 200);
    assert_eq!(fs::read_to_string(&precious).unwrap(), "precious");
}

/// A study with several names is written in place, so that each name has the saved text.
#[cfg(unix)]
#[test]
fn every_name_of_a_study_has_what_was_saved() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let before = served.text();
    let [other, third] = ["other.toml", "third.toml"].map(|name| served.folder.path().join(name));
    fs::hard_link(&served.study, &other).unwrap();
    let of = served.moved("strut_top", 2, 2.5);
    let save = json!({"of": of, "name": null, "anyway": false});
    assert_eq!(served.post("save", &save).status, 200);
    assert_ne!(served.text(), before);
    assert_eq!(fs::read_to_string(&other).unwrap(), served.text());
    // The same under another name.
    fs::write(&third, "third").unwrap();
    let fourth = served.folder.path().join("fourth.toml");
    fs::hard_link(&third, &fourth).unwrap();
    let of = served.moved("strut_top", 2, 1.5);
    let save = json!({"of": of, "name": "third.toml", "anyway": true});
    assert_eq!(served.post("save", &save).status, 200);
    let [third, fourth] = [third, fourth].map(|path| fs::read_to_string(path).unwrap());
    assert!(third == fourth && third.contains("[suspension]"));
    assert_eq!(
        served.files(),
        ["fourth.toml", "other.toml", "study.toml", "third.toml"]
    );
}

/// Coordinates have the bounds of a study's numbers in every request; after one that is refused the next tuning begins.
#[test]
fn coordinates_beyond_those_of_a_study_are_refused_everywhere() {
    let served = Served::of(&sample("double_wishbone_robust.toml"));
    let good = served.moved("tie_rod_outer", 2, 0.0);
    let points = good["design"].as_array().unwrap().len();
    let locked = vec![[false; 3]; points];
    for value in [1e155, -1e308, 1.1e12] {
        let mut of = good.clone();
        of["design"][0][0] = json!(value);
        for (name, message) in [
            ("tune", json!({"of": of, "locked": locked})),
            (
                "solve",
                json!({"of": of, "characteristics": ["toe"], "at": [0.0, 0.0], "curves_rack": null, "over": 0}),
            ),
            ("save", json!({"of": of, "name": "x.toml", "anyway": false})),
        ] {
            let answer = served.post(name, &message);
            let said = answer.text();
            assert!(
                [400, 422].contains(&answer.status),
                "{name} {value:e}: {said}"
            );
            assert!(
                said.contains("upper_arm_front x: expected a number between"),
                "{said}"
            );
        }
    }
    let mut state = served
        .post("tune", &json!({"of": good, "locked": locked}))
        .json();
    while state["done"] == false {
        std::thread::sleep(std::time::Duration::from_millis(50));
        state = served.post("cancel", &json!({"job": state["job"]})).json();
    }
    assert_eq!(state["done"], true, "{state}");
}

/// The state of a tuning that has ended.
fn tuned(served: &Served, of: &Value, locked: &[[bool; 3]]) -> Value {
    let begun = served.post("tune", &json!({"of": of, "locked": locked}));
    let mut state = begun.json();
    while state["done"] == false {
        std::thread::sleep(std::time::Duration::from_millis(50));
        let asked = served.post("progress", &json!({"job": state["job"]}));
        state = asked.json();
    }
    state
}

/// Tune proposes the design that `hardpoint optimise` writes for the same study.
#[test]
fn a_tuning_is_that_of_optimise() {
    let served = Served::of(&sample("macpherson_bump_steer.toml"));
    let of = served.moved("tie_rod_outer", 2, 0.0);
    let points = of["design"].as_array().unwrap().len();
    let locked = vec![[false; 3]; points];
    let state = tuned(&served, &of, &locked);
    let proposal = &state["proposal"];
    assert!(proposal.is_object(), "{state}");
    let tuned = json!({"digest": of["digest"], "design": proposal["design"]});
    let save = json!({"of": tuned, "name": "tuned.toml", "anyway": false});
    assert_eq!(served.post("save", &save).status, 200);
    let out = served.folder.path().join("out");
    let status = std::process::Command::new(env!("CARGO_BIN_EXE_hardpoint"))
        .args(["optimise", "--quiet", "--out"])
        .arg(&out)
        .arg(&served.study)
        .stdout(std::process::Stdio::null())
        .status()
        .unwrap();
    assert!(status.success());
    let read = |path: &std::path::Path| fs::read_to_string(path).unwrap();
    assert_eq!(
        read(&served.folder.path().join("tuned.toml")),
        read(&out.join("optimised.toml"))
    );
    // With everything locked there is nothing to tune; no such tuning is known.
    let locked = vec![[true; 3]; points];
    assert_eq!(
        served
            .post("tune", &json!({"of": of, "locked": locked}))
            .status,
        422
    );
    assert_eq!(served.post("progress", &json!({"job": 99})).status, 404);
}

/// Ranges count from the design in the file, wherever the page has moved its points, and a proposal names ranges that bind.
#[test]
fn ranges_count_from_the_file() {
    let text = sample("macpherson_bump_steer.toml");
    let served = Served::of(&text.replace("range = [-25.0, 25.0]", "range = [-2.0, 2.0]"));
    let of = served.moved("tie_rod_inner", 2, -1.5);
    let points = served.overview()["points"].clone();
    let points = points.as_array().unwrap();
    let inner = points
        .iter()
        .position(|point| point["name"] == "tie_rod_inner");
    let locked = vec![[false; 3]; points.len()];
    let state = tuned(&served, &of, &locked);
    let proposal = &state["proposal"];
    // The rack is too low by more than the range: the file has z = 228.
    let z = proposal["design"][inner.unwrap()][2].as_f64().unwrap();
    // From the moved point, the range would end at 228.5. Of nearly equal designs the tuning keeps the nearest.
    assert!(z > 229.9 && z <= 230.0, "{z}");
    let remarks = proposal["remarks"].to_string();
    assert!(
        remarks.contains("tie_rod_outer z is at the lower end of its range"),
        "{remarks}"
    );
    assert!(remarks.contains("missed: toe_deg, by up to"), "{remarks}");
}

#[test]
fn the_report_of_a_design_is_served() {
    for name in ["macpherson_solve.toml", "five_link_axle.toml"] {
        let served = Served::of(&of_few_stations(&sample(name)));
        let of = served.moved("wheel_centre", 2, 2.5);
        let place = served.post("report", &of).json();
        let page = served.get(place.as_str().unwrap());
        assert_eq!(page.status, 200, "{name}");
        assert!(page.text().contains("Content-Security-Policy"), "{name}");
        assert_eq!(served.files(), ["study.toml"], "{name}");
    }
}

fn edited(served: &Served, digest: &Value, edits: Value) -> Value {
    let answer = served.post("edit", &json!({"digest": digest, "edits": edits}));
    answer.json()
}

/// Values changed in the page reach the file only with a save, and only in their own lines.
#[test]
fn changed_values_are_saved_with_their_comments() {
    let served = Served::of(&sample("double_wishbone_front.toml"));
    let before = served.text();
    let overview = served.overview();
    let band = json!({"characteristic": "camber", "between": [-2.0, 1.5], "tolerance": 0.1});
    let new = edited(
        &served,
        &overview["digest"],
        json!([
            {"path": ["optimise", "targets", 0, "tolerance"], "value": 0.02},
            {"path": ["optimise", "variables", 3, "range", 1], "value": 12.5},
            {"path": ["optimise", "targets", 4], "value": band},
        ]),
    );
    assert_eq!(new["base"], overview["digest"]);
    assert_ne!(new["digest"], overview["digest"]);
    assert_eq!(new["targets"].as_array().unwrap().len(), 5);
    assert_eq!(new["variables"][3]["range"], json!([-30.0, 12.5]));
    assert_eq!(served.text(), before, "nothing is written before a save");

    // The same design has another misfit, because the tolerance of its first target is another.
    let of = json!({"digest": new["digest"], "design": new["design"]});
    let texts = served.post("texts", &of).json();
    assert_eq!(texts[0]["before"], json!(before));
    let saved = served.post("save", &json!({"of": of, "name": null, "anyway": false}));
    assert_eq!(saved.status, 200, "{}", saved.text());
    assert_eq!(texts[0]["after"], json!(served.text()));
    let after = served.text();
    let kept = |line: &&str| after.lines().any(|other| other == *line);
    let gone: Vec<&str> = before.lines().filter(|line| !kept(line)).collect();
    assert_eq!(gone.len(), 2, "{gone:#?}");
    assert!(after.contains("# degrees per mm") && after.contains("# Offsets from the design."));
    assert_eq!(served.overview()["digest"], saved.json()["digest"]);
}

/// A refused edit changes nothing. A file that another program has changed gets the edits on top of its new text.
#[test]
fn edits_are_refused_or_merged() {
    let served = Served::of(&sample("double_wishbone_front.toml"));
    let overview = served.overview();
    for edits in [
        json!([{"path": ["optimise", "targets", 0, "tolerance"], "value": -1.0}]),
        json!([{"path": ["optimise", "targets", 9, "tolerance"], "value": 1.0}]),
        json!([{"path": ["motion", "travel", "from"], "value": "low"}]),
        json!([{"path": [], "value": 1.0}]),
    ] {
        let message = json!({"digest": overview["digest"], "edits": edits});
        assert_eq!(served.post("edit", &message).status, 422, "{edits}");
    }
    let new = edited(
        &served,
        &overview["digest"],
        json!([{"path": ["optimise", "targets", 3, "weight"], "value": 0.75}]),
    );
    let by_hand = format!("# by hand\n{}", served.text());
    fs::write(&served.study, &by_hand).unwrap();
    let of = json!({"digest": new["digest"], "design": new["design"]});
    let message = |anyway: bool| json!({"of": of, "name": null, "anyway": anyway});
    assert_eq!(served.post("save", &message(false)).status, 409);
    assert_eq!(served.text(), by_hand);
    assert_eq!(served.post("save", &message(true)).status, 200);
    assert_eq!(
        served.text(),
        by_hand.replace("weight = 0.5 }", "weight = 0.75 }")
    );
}

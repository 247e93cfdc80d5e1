//! Tests of saved files, their locations, and edits of values.

use super::{Served, sample};
use serde_json::{Value, json};
use std::fs;

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
    // The answer contains the digest of the written text. The page needs this digest to save further moves.
    assert_eq!(saved["digest"], served.overview()["digest"]);
    // The server warns a tab that still has the earlier text.
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
    // If the user agrees, the server writes only the moved coordinate into the changed file.
    assert_eq!(served.post("save", &message(true)).status, 200);
    let merged = served.text();
    assert!(merged.contains("# by hand"));
    let differ = edited
        .lines()
        .zip(merged.lines())
        .filter(|(a, b)| a != b)
        .count();
    assert_eq!(differ, 1);
    // The server writes nothing to a file that is no longer a study.
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

/// A file in the study's folder can be a link to another folder. Then the server replaces the link, and does not write
/// to the target of the link.
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

/// If a study file has several names (hard links), the server writes the file in place. So every name has the saved
/// text.
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
    // The server also writes a file with several names in place if the user saves it under another name.
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

fn edited(served: &Served, digest: &Value, edits: Value) -> Value {
    let answer = served.post("edit", &json!({"digest": digest, "edits": edits}));
    answer.json()
}

/// Values that are changed in the page are written to the file only by a save. The save changes only the lines of these
/// values.
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

    // The same design has another misfit, because the tolerance of its first target has changed.
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

/// A refused edit changes nothing. If another program has changed the file, the server applies the edits to the changed
/// text.
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

/// Removing a target also removes its comment. A comment above the first target may describe all targets, so this
/// comment stays.
#[test]
fn a_comment_above_all_targets_stays() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let overview = served.overview();
    let without = |numbers: &[usize]| {
        let removed = numbers.iter();
        let removed = removed.map(|k| json!({"path": ["optimise", "targets", k], "value": null}));
        let new = edited(
            &served,
            &overview["digest"],
            removed.collect::<Vec<_>>().into(),
        );
        let of = json!({"digest": new["digest"], "design": new["design"]});
        let texts = served.post("texts", &of).json();
        texts[0]["after"].as_str().unwrap().to_owned()
    };
    let all = "# Pairs of wheel travel and angle in degrees.\n";
    let own = "# At most 0.1 degrees from the toe of the design.\n";
    let text = without(&[0]);
    assert!(
        text.contains(&format!(
            "\n\n{all}[[optimise.targets]]\ncharacteristic = \"kingpin_inclination\""
        )) && text.contains(own),
        "{text}"
    );
    let text = without(&[0, 0]);
    assert!(
        text.contains(&format!("{all}{own}[[optimise.targets]]\n")),
        "{text}"
    );
    let text = without(&[2]);
    assert!(text.contains(all) && !text.contains(own), "{text}");
    // The program also keeps a comment above the first variable of a list.
    let commented =
        sample("macpherson_front.toml").replace("variables = [\n", "variables = [\n  # All\n");
    let served = Served::of(&commented);
    let removed = json!([{"path": ["optimise", "variables", 0], "value": null}]);
    let new = edited(&served, &served.overview()["digest"], removed);
    let of = json!({"digest": new["digest"], "design": new["design"]});
    let texts = served.post("texts", &of).json();
    let text = texts[0]["after"].as_str().unwrap();
    assert!(
        text.contains("[\n  # All\n  { hardpoint = \"strut_lower\""),
        "{text}"
    );
}

/// If a name is refused, the message states what is wrong with the name. After saving a car, the message names the
/// files whose texts have changed.
#[test]
fn messages_name_the_fault_and_the_files() {
    let served = super::car::served("car", super::car::as_it_is);
    let of = super::car::moved(&served, &[("rear_toe_link_inner", 2, 1.5)]);
    let long = format!("{}.toml", "a".repeat(253));
    for (name, fault) in [
        ("../x.toml", "../x.toml names a folder or a drive"),
        (&long, "the name has 258 bytes; expected at most 200"),
        ("x?.toml", "without the characters"),
        ("x.txt", "a name that ends in .toml"),
    ] {
        let answer = served.post("save", &json!({"of": of, "name": name, "anyway": false}));
        assert!(answer.text().contains(fault), "{}", answer.text());
    }
    let save = json!({"of": of, "name": null, "anyway": false});
    let saved = served.post("save", &save).json();
    assert_eq!(saved["file"], json!("car_rear.toml"));
}

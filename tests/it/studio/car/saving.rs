//! Tests of the three files of a car: the server saves all of them or none.

use super::{as_it_is, file, moved, read, save, served};
use crate::studio::sample;
use serde_json::json;
use std::fs;

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

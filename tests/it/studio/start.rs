//! Tests of a server without a study. On the page, the user chooses a topology and pastes points. The server then
//! writes a new study.

use super::{Served, columns, free_port, sample, serve_in, solved};
use serde_json::{Value, json};
use std::fs;

fn empty() -> Served {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("new.toml");
    let (process, address) = serve_in(folder.path(), free_port());
    Served {
        folder,
        study,
        address,
        process,
    }
}

fn request(topology: &str, name: &str, points: &str) -> Value {
    json!({"topology": topology, "name": name, "points": points, "unit": "", "axes": "", "side": "", "half_track": null})
}

#[test]
fn every_topology_starts_from_its_picture() {
    let served = empty();
    assert!(served.get("").text().contains("New study"));
    let choices = served.post("choices", &Value::Null).json();
    let names: Vec<&str> = choices
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c["name"].as_str().unwrap())
        .collect();
    assert!(
        names.contains(&"double_wishbone") && names.len() >= 4,
        "{names:?}"
    );
    for name in names {
        let served = empty();
        let started = served.post("start", &request(name, "new.toml", ""));
        assert_eq!(started.status, 200, "{}", started.text());
        assert!(!solved(&served.study).is_empty(), "{name}");
        assert_eq!(served.overview()["file"], "new.toml");
        assert!(!served.get("").text().contains("New study"));
        // A server that has a study refuses to start another.
        assert_eq!(
            served
                .post("start", &request(name, "other.toml", ""))
                .status,
            409
        );
        assert_eq!(served.files(), ["new.toml"]);
    }
}

/// The user pastes cells of a sheet, in the form that a browser inserts. The coordinates in the new study are identical
/// to the pasted ones, bit for bit, and the study can be solved.
#[test]
fn pasted_points_become_a_study() {
    let text = sample("double_wishbone_solve.toml");
    let study: toml::Table = text.parse().unwrap();
    let points = study["suspension"]["hardpoints"].as_table().unwrap();
    let line = |(name, place): (&String, &toml::Value)| {
        let place = place.as_array().unwrap().iter();
        let numbers: Vec<String> = place.map(ToString::to_string).collect();
        format!("{name}\t{}\n", numbers.join("\t"))
    };
    let pasted: String = points.iter().map(line).collect();
    let served = empty();
    let started = served.post("start", &request("double_wishbone", "new.toml", &pasted));
    assert_eq!(started.status, 200, "{}", started.text());
    let written: toml::Table = fs::read_to_string(&served.study).unwrap().parse().unwrap();
    let own = written["suspension"]["hardpoints"].as_table().unwrap();
    for (name, place) in points {
        let numbers = |place: &toml::Value| {
            let place = place.as_array().unwrap().iter();
            place
                .map(|c| c.as_float().unwrap().to_bits())
                .collect::<Vec<_>>()
        };
        assert_eq!(numbers(&own[name]), numbers(place), "{name}");
    }
    assert!(columns(&solved(&served.study)).len() > 3);
    // Without a radius, the study has no quantities at the ground. The form requests the radius.
    let wheel = written.get("wheel");
    assert!(wheel.is_none_or(|wheel| wheel.get("radius").is_none()));
    let served = empty();
    let mut with_radius = request("double_wishbone", "new.toml", &pasted);
    with_radius["wheel_radius"] = json!(305.0);
    let started = served.post("start", &with_radius);
    assert_eq!(started.status, 200, "{}", started.text());
    let written: toml::Table = fs::read_to_string(&served.study).unwrap().parse().unwrap();
    assert_eq!(written["wheel"]["radius"].as_float(), Some(305.0));
    let offered = served.overview()["characteristics"].to_string();
    assert!(offered.contains("roll_centre_height"), "{offered}");
    // The pasted rows may have row numbers in front of the names.
    let served = empty();
    let rows = pasted.lines().enumerate();
    let numbered: String = rows.map(|(k, row)| format!("{}\t{row}\n", k + 1)).collect();
    let started = served.post("start", &request("double_wishbone", "new.toml", &numbered));
    assert_eq!(started.status, 200, "{}", started.text());
    let again: toml::Table = fs::read_to_string(&served.study).unwrap().parse().unwrap();
    assert_eq!(
        again["suspension"]["hardpoints"],
        written["suspension"]["hardpoints"]
    );
    // If a name is unknown, the message says which points to rename, because the form accepts no file of names.
    let served = empty();
    let renamed = pasted.replace("wheel_centre", "hub point");
    let refused = served.post("start", &request("double_wishbone", "new.toml", &renamed));
    assert_eq!(refused.status, 422);
    let said = refused.text();
    assert!(
        said.contains("rename them in the points") && said.contains("wheel_centre"),
        "{said}"
    );
    assert!(!said.contains("--"), "{said}");
}

#[test]
fn a_start_that_is_refused_writes_nothing() {
    let served = empty();
    fs::write(served.folder.path().join("mine.toml"), "mine").unwrap();
    for (topology, name, points) in [
        ("double_wishbone", "../new.toml", ""),
        ("double_wishbone", "new.txt", ""),
        ("double_wishbone", "mine.toml", ""),
        ("leaf_spring", "new.toml", ""),
        ("double_wishbone", "new.toml", "lower_arm_front\t1\t2\t3"),
        ("double_wishbone", "new.toml", "no points"),
    ] {
        let started = served.post("start", &request(topology, name, points));
        assert_eq!(started.status, 422, "{name} {}", started.text());
    }
    let refused = served.post(
        "start",
        &request("double_wishbone", "new.toml", "no points"),
    );
    let said = refused.text();
    assert!(
        said.contains("the pasted text has no table of points"),
        "{said}"
    );
    // The form has no flags.
    let mut wrong = request("double_wishbone", "new.toml", "a\t1\t2\t3");
    wrong["axes"] = json!("up,up,up");
    let said = served.post("start", &wrong).text();
    assert!(
        said.contains("three different axes") && !said.contains("--"),
        "{said}"
    );
    assert_eq!(served.files(), ["mine.toml"]);
    let mine = fs::read_to_string(served.folder.path().join("mine.toml"));
    assert_eq!(mine.unwrap(), "mine");
    // Without a study, the server refuses requests that need one.
    assert_eq!(served.post("study", &Value::Null).status, 409);
}

/// A table of OptimumKinematics has no wheel centre. The refusal names the fields of the form from which the program
/// computes the wheel centre. When these fields contain values, the server makes a study.
#[test]
fn half_track_and_radius_give_the_wheel_centre() {
    let points = "CHAS_LowFor\t150\t205\t118\nCHAS_LowAft\t-150\t205\t130\nCHAS_UppFor\t140\t250\t300\n\
                  CHAS_UppAft\t-140\t250\t290\nUPRI_LowPnt\t5\t560\t125\nUPRI_UppPnt\t-10\t535\t325\n\
                  CHAS_TiePnt\t60\t220\t150\nUPRI_TiePnt\t70\t560\t160\n";
    let served = empty();
    let mut request = request("double_wishbone", "new.toml", points);
    request["unit"] = json!("mm");
    let refused = served.post("start", &request);
    assert_eq!(refused.status, 422);
    let said = refused.text();
    assert!(
        said.contains("give half track and wheel radius, from which the wheel centre"),
        "{said}"
    );
    request["half_track"] = json!(600.0);
    request["wheel_radius"] = json!(230.0);
    let started = served.post("start", &request);
    assert_eq!(started.status, 200, "{}", started.text());
    let written: toml::Table = fs::read_to_string(&served.study).unwrap().parse().unwrap();
    let centre = &written["suspension"]["hardpoints"]["wheel_centre"];
    let numbers: Vec<f64> = centre
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c.as_float().unwrap())
        .collect();
    assert_eq!(numbers, [0.0, 600.0, 230.0]);
}

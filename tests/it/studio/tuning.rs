//! Tests of tunings that the page starts: their limits, proposals and messages.

use super::{Served, sample};
use crate::support::one_line;
use serde_json::{Value, json};
use std::fs;

/// Every request has the same bounds for coordinates as a study. After a refused request, the next tuning starts
/// normally.
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
                said.contains("upper_arm_front x: expected a number with a magnitude"),
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

/// State of a tuning that has ended.
pub(super) fn tuned(served: &Served, of: &Value, locked: &[[bool; 3]]) -> Value {
    let begun = served.post("tune", &json!({"of": of, "locked": locked}));
    let mut state = begun.json();
    while state["done"] == false {
        std::thread::sleep(std::time::Duration::from_millis(50));
        let asked = served.post("progress", &json!({"job": state["job"]}));
        state = asked.json();
    }
    state
}

/// *Tune* proposes the design that `hardpoint optimise` writes for the same study.
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
    // If all coordinates are locked, no variable is left for the tuning, and the server refuses.
    let locked = vec![[true; 3]; points];
    assert_eq!(
        served
            .post("tune", &json!({"of": of, "locked": locked}))
            .status,
        422
    );
    assert_eq!(served.post("progress", &json!({"job": 99})).status, 404);
}

/// Ranges are relative to the design in the file, wherever the user has moved the points on the page. A proposal names
/// active limits of ranges.
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
    // The file has z = 228, so the range ends at 230.
    let z = proposal["design"][inner.unwrap()][2].as_f64().unwrap();
    // A range relative to the moved point would end at 228.5. Among nearly equal designs, the tuning keeps the nearest
    // one.
    assert!(z > 229.9 && z <= 230.0, "{z}");
    let remarks = proposal["remarks"].to_string();
    assert!(
        remarks.contains("tie_rod_outer z is at the lower end of its range"),
        "{remarks}"
    );
    assert!(remarks.contains("missed: toe_deg, by up to"), "{remarks}");
}

/// The page shows the nominal design: misfit, deviations and slopes of a robust study equal those of the same study
/// without builds. When the page rounds a design, it uses the same misfit.
#[test]
fn the_misfit_of_a_robust_study_is_that_of_its_nominal_design() {
    let robust = sample("double_wishbone_robust.toml");
    let plain = robust.replace("scatter = 64\n", "");
    assert_ne!(plain, robust);
    let of_page = |text: &str| {
        let served = Served::of(text);
        let of = served.moved("tie_rod_outer", 2, 0.5);
        let request = json!({"of": of, "characteristics": ["toe"], "at": [0.0, 0.0], "curves_rack": null, "over": 0});
        let misfit = served.post("solve", &request).json()["misfit"].take();
        (misfit, served.overview()["builds"].take())
    };
    let (of_robust, builds) = of_page(&robust);
    let (of_plain, none) = of_page(&plain);
    assert!(of_plain["value"].as_f64().unwrap() > 1.0, "{of_plain}");
    assert_eq!(of_robust, of_plain);
    assert_eq!((builds, none), (json!(64), Value::Null));

    let of_rounding = |text: &str| {
        let study = hardpoint::Study::from_text("study", text, std::path::Path::new("")).unwrap();
        let free = vec![true; 3 * study.wheel().design.len()];
        let unit = hardpoint::model::LengthUnit::Millimetre;
        let grid = hardpoint::exchange::Grid { step: 1.0, unit };
        let ranges = hardpoint::exchange::ranges_of_coordinates(&study, &study.wheel().design);
        hardpoint::exchange::rounded(&study, grid, &free, &ranges)
            .unwrap()
            .loss
    };
    assert_eq!(of_rounding(&robust), of_rounding(&plain));
}

/// The proposal of a robust tuning states that its deviations come from builds. It shows the yields that `hardpoint
/// optimise` computes.
#[test]
fn a_robust_proposal_has_the_yields_of_optimise() {
    let text = sample("double_wishbone_robust.toml").replace("builds = 20000", "builds = 2000");
    let served = Served::of(&text);
    let of = served.moved("tie_rod_outer", 2, 0.0);
    let points = of["design"].as_array().unwrap().len();
    let state = tuned(&served, &of, &vec![[false; 3]; points]);
    let proposal = &state["proposal"];
    let headline = proposal["headline"].as_str().unwrap();
    assert!(
        headline.contains("root mean square of 64 builds"),
        "{headline}"
    );
    let remarks = proposal["remarks"].to_string();
    assert!(remarks.contains(" in one of 64 builds"), "{remarks}");

    let out = served.folder.path().join("out");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_hardpoint"))
        .args(["optimise", "--report", "--out"])
        .arg(&out)
        .arg(&served.study)
        .output()
        .unwrap();
    let printed = String::from_utf8(output.stdout).unwrap();
    let yields = proposal["yields"]["headline"].as_str().unwrap();
    assert!(yields.contains("of 2000 builds"), "{yields}");
    assert!(printed.contains(yields), "{yields}\n{printed}");
    assert_eq!(proposal["yields"]["rows"].as_array().unwrap().len(), 4);
    let over = "largest deviation from the target over 64 builds";
    assert!(one_line(&printed).contains(over), "{printed}");

    let page = fs::read_to_string(out.join("report.html")).unwrap();
    for words in [
        "2 of 2 targets are outside their tolerance in at least one of 64 builds.",
        "off: largest deviation from the target over 64 builds",
        "<small>tolerances, root mean square of 64 builds</small>",
        "<small>targets in all 64 builds</small>",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert_eq!(page.matches("target missed by up to").count(), 2);
    assert!(page.matches(" in one of 64 builds").count() >= 2);
    // A change that rounds to 0 is not listed as a side effect.
    let (_, tables) = page.split_once("<h3>Side effects</h3>").unwrap();
    let (tables, _) = tables.split_once("id=\"convergence\"").unwrap();
    let is_row = |row: &&str| row.contains("scrub_<wbr>radius");
    assert_eq!(tables.split("<tr").filter(is_row).count(), 0);
    assert!(tables.contains("unchanged: "), "{tables}");
}

/// A proposal contains the tuned rate of a spring. The study with this rate has the misfit of the proposal.
#[test]
fn a_proposal_has_the_tuned_rate_of_a_spring() {
    let optimise = r#"
[optimise]
variables = [{ rate = "spring", range = [0.5, 2.0], relative = true }]
targets = [{ characteristic = "compliant_wheel_rate", at = 0.0, value = 35.0, tolerance = 1.0 }]
"#;
    let served = Served::of(&(sample("double_wishbone_compliance.toml") + optimise));
    let of = served.moved("tie_rod_outer", 2, 0.0);
    let state = tuned(&served, &of, &[]);
    let edits = &state["proposal"]["edits"];
    assert_eq!(edits[0]["path"], json!(["spring", "rate"]), "{state}");
    assert_eq!(state["proposal"]["origins"], json!([90.0]));
    assert_eq!(state["proposal"]["rates"][0][0], "spring rate");
    let edited = json!({"digest": of["digest"], "edits": edits});
    let edited = served.post("edit", &edited).json();
    let message = json!({
        "of": {"digest": edited["digest"], "design": edited["design"]}, "characteristics": ["toe"], "at": [0.0, 0.0],
        "curves_rack": null, "over": 0,
    });
    let misfit = served.post("solve", &message).json()["misfit"]["value"].clone();
    assert!(misfit.as_f64().unwrap() < 0.2, "{misfit}");
}

/// Edits that cancel each other leave the study as it is in the file. If another program then changes the file, a save
/// does not put them into it.
#[test]
fn cancelled_edits_do_not_enter_a_changed_file() {
    let text = sample("macpherson_front.toml");
    let served = Served::of(&text);
    let of = served.moved("strut_top", 2, 0.0);
    let edit = |digest: &Value, starts: u32| {
        let edits = json!([{"path": ["optimise", "starts"], "value": starts}]);
        let edited = served.post("edit", &json!({"digest": digest, "edits": edits}));
        edited.json()["digest"].clone()
    };
    let back = edit(&edit(&of["digest"], 4), 1);
    assert_eq!(back, of["digest"]);
    let by_hand = text.replace("starts = 1", "starts = 7");
    fs::write(&served.study, &by_hand).unwrap();
    let save = json!({"of": of, "name": null, "anyway": true});
    assert_eq!(served.post("save", &save).status, 200);
    assert_eq!(fs::read_to_string(&served.study).unwrap(), by_hand);
}

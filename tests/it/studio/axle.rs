//! Tests of an axle in the live page: sliders, and positions of both wheels.

use super::{Served, car, sample};
use crate::support::larger;
use serde_json::{Value, json};
use std::process::Command;

/// Study that `hardpoint new` prints.
fn new(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_hardpoint"))
        .args(["new", "--quiet"])
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn solve(served: &Served, characteristics: &[&str], at: &[f64]) -> Value {
    let overview = served.overview();
    let of = json!({"digest": overview["digest"], "design": overview["design"]});
    let message = json!({
        "of": of, "characteristics": characteristics, "at": at, "curves_rack": null, "over": 0,
    });
    served.post("solve", &message).json()
}

/// Keys and names of the sliders that the page shows.
fn shown(served: &Served) -> Vec<(String, String)> {
    let overview = served.overview();
    let all = overview["sliders"].as_array().unwrap().iter();
    let moving = all.filter(|slider| slider["low"] != slider["high"]);
    let text = |slider: &Value, key: &str| slider[key].as_str().unwrap().to_owned();
    moving
        .map(|slider| (text(slider, "key"), text(slider, "name")))
        .collect()
}

/// The page has a slider for the steering only if the suspension has a rack or a drag link.
#[test]
fn steered_axles_alone_have_a_rack_slider() {
    let rack = |name: &str| vec![("rack".to_owned(), name.to_owned())];
    for (text, expected) in [
        (new(&["solid_axle"]), Vec::new()),
        (new(&["solid_axle", "--with", "panhard"]), Vec::new()),
        (sample("solid_axle_five_links.toml"), Vec::new()),
        (sample("twist_beam_solve.toml"), Vec::new()),
        (sample("semi_trailing_arm_solve.toml"), Vec::new()),
        (
            new(&["solid_axle", "--with", "drag_link"]),
            rack("drag link"),
        ),
        (sample("macpherson_axle.toml"), rack("rack")),
        (sample("macpherson_solve.toml"), rack("rack")),
        (sample("five_link_axle.toml"), rack("rack")),
    ] {
        let mut sliders = shown(&Served::of(&text));
        sliders.retain(|(key, _)| key == "rack");
        assert_eq!(sliders, expected, "{text}");
    }
}

type Place = [f64; 3];

fn distance(a: Place, b: Place) -> f64 {
    let squares = (0..3).map(|k| (a[k] - b[k]).powi(2));
    squares.sum::<f64>().sqrt()
}

/// Positions of the points of a drawn side, by name.
struct Drawn {
    points: Vec<(String, Place)>,
    spin_axis: Place,
}

impl Drawn {
    fn of(served: &Served, frame: &Value) -> Self {
        let pose = &frame["pose"]["Ok"];
        let place = |v: &Value| -> Place { serde_json::from_value(v.clone()).unwrap() };
        let overview = served.overview();
        let names = overview["points"].as_array().unwrap().iter();
        let names = names.map(|point| point["name"].as_str().unwrap().to_owned());
        let places = pose["points"].as_array().expect("a pose").iter().map(place);
        Drawn {
            points: names.zip(places).collect(),
            spin_axis: place(&pose["spin_axis"]),
        }
    }

    fn at(&self, name: &str) -> Place {
        let found = self.points.iter().find(|(own, _)| own == name);
        found.unwrap_or_else(|| panic!("{name}")).1
    }
}

/// Both drawn sides at the positions of the sliders.
fn sides(served: &Served, at: &[f64]) -> [Drawn; 2] {
    let answer = solve(served, &[], at);
    ["frame", "right"].map(|side| Drawn::of(served, &answer[side]))
}

/// Points of the axle's body in a drawn side.
const OF_BODY: [&str; 8] = [
    "lower_link_axle",
    "upper_link_axle",
    "spring_lower",
    "panhard_axle",
    "watt_pivot",
    "right_lower_link_axle",
    "right_upper_link_axle",
    "right_spring_lower",
];

/// A solid axle is drawn as one rigid body on its links. The test covers heave with roll, a Panhard rod, a Watt
/// linkage, and an equilibrium of five elastic links. Both sides agree on every point, and the wheel centres have the
/// travels of the sliders.
#[test]
fn a_solid_axle_is_drawn_as_one_body() {
    let travels = "travel_left = [-40.0, 0.0, 40.0]\ntravel_right = [-40.0, 0.0, 40.0]\n";
    let on_travels = |text: String| {
        let start = text.find("[motion]").unwrap() + "[motion]".len();
        let end = start + text[start..].find("\n[").unwrap();
        format!("{}\n{travels}{}", &text[..start], &text[end..])
    };
    for (text, is_elastic) in [
        (on_travels(new(&["solid_axle"])), false),
        (on_travels(new(&["solid_axle", "--with", "panhard"])), false),
        (on_travels(new(&["solid_axle", "--with", "watt"])), false),
        (sample("solid_axle_five_links.toml"), true),
    ] {
        let served = Served::of(&text);
        let design = &sides(&served, &[0.0; 3])[0];
        for at in [[30.0, 30.0, 0.0], [30.0, -20.0, 0.0], [-10.0, 35.0, 0.0]] {
            let [left, right] = sides(&served, &at);
            let names = design.points.iter().map(|(name, _)| name.as_str());
            let names: Vec<&str> = names.collect();
            for (drawn, travel) in [(&left, at[0]), (&right, at[1])] {
                let risen = drawn.at("wheel_centre")[2] - design.at("wheel_centre")[2];
                assert!((risen - travel).abs() < 1e-9, "{at:?}: {risen}");
            }
            let far = left.at("right_wheel_centre");
            assert!(distance(far, right.at("wheel_centre")) < 1e-9, "{at:?}");
            for name in OF_BODY.iter().filter(|name| names.contains(*name)) {
                let [was, is] = [design, &left].map(|side| {
                    let to = |centre: &str| distance(side.at(name), side.at(centre));
                    [to("wheel_centre"), to("right_wheel_centre")]
                });
                for (was, is) in was.iter().zip(is) {
                    assert!((was - is).abs() < 1e-9, "{at:?}, {name}: {was} {is}");
                }
                // The right half has the same point under the name of the left half.
                if let Some(near) = name.strip_prefix("right_") {
                    assert!(distance(left.at(name), right.at(near)) < 1e-9, "{name}");
                }
            }
            for link in ["lower_link", "upper_link", "panhard"] {
                let ends = [format!("{link}_chassis"), format!("{link}_axle")];
                if is_elastic || !names.contains(&ends[0].as_str()) {
                    continue;
                }
                let length = |side: &Drawn| distance(side.at(&ends[0]), side.at(&ends[1]));
                assert!((length(&left) - length(design)).abs() < 1e-9, "{link}");
            }
        }
    }
}

/// Elastic links are drawn with their deformed length: the change of a link's tension is its stiffness times the
/// elongation in the drawing.
#[test]
fn drawn_links_have_the_stretch_of_their_tension() {
    let served = Served::of(&sample("solid_axle_five_links.toml"));
    let links = ["lower_link", "upper_link", "panhard"];
    let asked = links.map(|link| format!("{link}_tension"));
    let asked: Vec<&str> = asked.iter().map(String::as_str).collect();
    let answer = solve(&served, &asked, &[0.0; 3]);
    // The study gives 8000 N/mm for every link.
    let stiffness = 8000.0;
    let design = Drawn::of(&served, &answer["frame"]);
    let groups = answer["groups"].as_array().unwrap();
    let place = |station: usize| {
        let group = groups[station].as_u64().unwrap() as usize;
        let left = answer["drive"][station].as_f64().unwrap();
        [left, answer["group_places"][group][1].as_f64().unwrap()]
    };
    let stations = 0..groups.len();
    let home = stations.clone().find(|s| place(*s) == [0.0; 2]).unwrap();
    let mut largest: f64 = 0.0;
    for station in stations.step_by(3) {
        let [left, right] = place(station);
        let drawn = &sides(&served, &[left, right, 0.0])[0];
        for link in links {
            let column = answer["columns"].as_array().unwrap().iter().find(|c| {
                let name = c["column"].as_str().unwrap();
                name == format!("left_{link}_tension_N") || name == format!("{link}_tension_N")
            });
            let values = &column.unwrap_or_else(|| panic!("{link}"))["values"];
            let tension = |station: usize| values[station].as_f64().unwrap();
            let length = |side: &Drawn| {
                let ends = ["chassis", "axle"].map(|end| side.at(&format!("{link}_{end}")));
                distance(ends[0], ends[1])
            };
            let expected = tension(station) - tension(home);
            let found = stiffness * (length(drawn) - length(&design));
            largest = larger(largest, expected.abs());
            // The bound is the rounding error of coordinates of 1 m, times the stiffness.
            assert!(
                (found - expected).abs() < 1e-7,
                "{link}: {found} {expected}"
            );
        }
    }
    assert!(largest > 10.0, "{largest}");
}

/// Wheels with elastic parts are drawn with the camber of their curves.
#[test]
fn elastic_wheels_are_drawn_in_equilibrium() {
    for (name, at, column) in [
        (
            "double_wishbone_compliance.toml",
            vec![0.0, 0.0],
            "camber_deg",
        ),
        ("macpherson_compliance.toml", vec![0.0, 0.0], "camber_deg"),
        (
            "subframe_axle_compliance.toml",
            vec![0.0, 0.0],
            "left_camber_deg",
        ),
    ] {
        let served = Served::of(&sample(name));
        let motion = solve(&served, &["camber"], &at);
        let drives = motion["drive"].as_array().unwrap();
        let columns = motion["columns"].as_array().unwrap();
        let values = &columns.iter().find(|c| c["column"] == column).unwrap()["values"];
        for station in [0, drives.len() - 1] {
            let mut at = at.clone();
            at[0] = drives[station].as_f64().unwrap();
            let group = motion["groups"][station].as_u64().unwrap() as usize;
            at[1] = motion["group_places"][group][1].as_f64().unwrap();
            let answer = solve(&served, &["camber"], &at);
            let axis = Drawn::of(&served, &answer["frame"]).spin_axis;
            let camber = values[station].as_f64().unwrap();
            // If the top of the wheel leans outboard, the spin axis points outboard and down.
            let drawn = -axis[2].asin().to_degrees();
            assert!((drawn - camber).abs() < 1e-9, "{name}: {drawn} {camber}");
        }
    }
}

/// While a point moves, the page requests only the shown stations. The values agree with those of the full answer to
/// rounding. The solver reaches these stations by another path.
#[test]
fn shown_stations_alone_have_the_values_of_the_whole_answer() {
    let wheel = sample("double_wishbone_solve.toml");
    assert!(wheel.contains("rack = 0.0 "));
    for (name, text, overs) in [
        ("macpherson_axle.toml", sample("macpherson_axle.toml"), 0..2),
        ("five_link_axle.toml", sample("five_link_axle.toml"), 0..2),
        (
            "wheel",
            wheel.replace("rack = 0.0 ", "rack = [-20.0, 0.0, 20.0] "),
            0..1,
        ),
    ] {
        let served = Served::of(&text);
        let overview = served.overview();
        let sliders = overview["sliders"].as_array().unwrap();
        let at: Vec<Value> = sliders.iter().map(|s| s["high"].clone()).collect();
        for over in overs {
            let answer = |shown_only: bool| {
                let message = json!({
                    "of": {"digest": overview["digest"], "design": overview["design"]}, "characteristics": car::asked(&overview),
                    "at": at, "curves_rack": null, "over": over, "shown_only": shown_only,
                });
                served.post("solve", &message).json()
            };
            let (whole, shown) = (answer(false), answer(true));
            assert_eq!(whole["is_partial"], false, "{name}");
            assert_eq!(shown["is_partial"], true, "{name}");
            for key in ["shown", "group_places", "rack", "misfit"] {
                assert_eq!(shown[key], whole[key], "{name}: {key}");
            }
            let groups = whole["groups"].as_array().unwrap().iter();
            let of_shown = groups
                .enumerate()
                .filter(|(_, group)| **group == whole["shown"]);
            let of_shown: Vec<usize> = of_shown.map(|(station, _)| station).collect();
            assert_eq!(
                shown["groups"],
                json!(vec![&whole["shown"]; of_shown.len()]),
                "{name}"
            );
            let places: Vec<&Value> = of_shown.iter().map(|k| &whole["drive"][*k]).collect();
            assert_eq!(shown["drive"], json!(places), "{name}");
            let columns = whole["columns"].as_array().unwrap().iter().enumerate();
            let mut compared = 0;
            for (number, column) in columns {
                let own = shown["columns"][number]["values"].as_array().unwrap();
                assert_eq!(own.len(), of_shown.len());
                for (own, k) in own.iter().zip(&of_shown) {
                    let is = [own, &column["values"][*k]].map(|v| v.as_f64().unwrap_or(f64::NAN));
                    let far = (is[0] - is[1]).abs() / is[1].abs().max(1.0);
                    assert!(
                        far < 1e-8 || is.iter().all(|v| v.is_nan()),
                        "{name}: {} {is:?}",
                        column["column"]
                    );
                    compared += usize::from(far < 1e-8);
                }
            }
            assert!(compared > 2 * of_shown.len(), "{name}: {compared}");
        }
    }
}

/// The page gets at most 2000 stations of an axle, evenly chosen, and a remark. The influence of a point has the same stations.
#[test]
fn many_stations_of_an_axle_are_thinned() {
    let text = sample("macpherson_axle.toml").replace("steps = 13", "steps = 1001");
    let served = Served::of(&text);
    let answer = solve(&served, &["camber"], &[0.0; 3]);
    let stations = answer["drive"].as_array().unwrap().len();
    assert!((1000..=2000).contains(&stations), "{stations}");
    let remark = format!("{stations} of 6006 stations are shown");
    assert!(answer["remarks"].to_string().contains(&remark));
    let overview = served.overview();
    let of = json!({"digest": overview["digest"], "design": overview["design"]});
    let message = json!({"of": of, "characteristics": ["camber"], "point": 0, "axis": 2});
    let found = served.post("influence", &message).json();
    let slopes = found["columns"][0]["slopes"].as_array().unwrap();
    assert_eq!(slopes.len(), stations);
}

/// The page shows the curves of a named motion over the coordinates of this motion. The values are those of
/// `curves_NAME.csv`. The targets state the name of the motion.
#[test]
fn named_motions_have_curves_and_sliders() {
    let text = sample("macpherson_axle_front.toml");
    let (head, rest) = text.split_once("[motion]").unwrap();
    let (_, rest) = rest.split_once("[outputs]").unwrap();
    let (outputs, _) = rest.split_once("targets = [").unwrap();
    let text = format!(
        "{head}[motion]\nheave = [-10.0, 0.0, 10.0]\n[motions.turn]\nroll = [-2.0, 0.0, 2.0]\nheave = 5.0\n\
         [outputs]{outputs}targets = [\n{{ characteristic = \"camber_to_road\", motion = \"turn\", over = \"roll\", between = [-1.0, 1.0], tolerance = 0.1 }},\n\
         {{ characteristic = \"bump_steer\", between = [-1.0, 1.0], tolerance = 0.1 }},\n]\n"
    );
    let served = Served::of(&text);
    let overview = served.overview();
    let turn = &overview["motions"][0];
    assert_eq!(turn["name"], "turn");
    let keys = |sliders: &Value| -> Vec<String> {
        let sliders = sliders.as_array().unwrap().iter();
        sliders
            .map(|s| s["key"].as_str().unwrap().to_owned())
            .collect()
    };
    assert_eq!(keys(&turn["sliders"]), ["roll", "heave", "rack"]);
    assert_eq!(keys(&overview["sliders"]), ["heave", "rack"]);
    let targets = &overview["targets"];
    assert_eq!(targets[0]["motion"], "turn");
    assert_eq!(targets[0]["over"], 0);
    assert_eq!(targets[1]["motion"], Value::Null);
    let of = json!({"digest": overview["digest"], "design": overview["design"]});
    let asked = |motion: Value, at: &[f64]| {
        let message = json!({
            "of": of, "characteristics": ["camber_to_road"], "at": at, "curves_rack": null, "over": 0, "motion": motion,
        });
        served.post("solve", &message)
    };
    let answer = asked(json!("turn"), &[0.0, 5.0, 0.0]).json();
    let study =
        hardpoint::study::Study::from_text("m.toml", &text, std::path::Path::new(".")).unwrap();
    let curves = study.in_motion("turn").unwrap().curves().unwrap();
    let place = curves
        .columns
        .iter()
        .position(|c| c.name == "left_camber_to_road_deg");
    let expected: Vec<f64> = curves
        .stations
        .iter()
        .map(|s| s.values[place.unwrap()].unwrap())
        .collect();
    assert_eq!(answer["columns"][0]["values"], json!(expected));
    assert_eq!(answer["drive"], json!([-2.0, 0.0, 2.0]));
    // The misfit does not depend on the shown motion.
    let own = asked(Value::Null, &[0.0, 0.0]).json();
    assert!(own["misfit"]["value"].as_f64().unwrap() > 0.0);
    assert_eq!(answer["misfit"]["value"], own["misfit"]["value"]);
    let refused = asked(json!("other"), &[0.0, 5.0, 0.0]).text();
    assert!(
        refused.contains("this study has no motion other"),
        "{refused}"
    );
}

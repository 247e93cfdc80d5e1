//! Reads a nominal suspension from the text of a study.

use super::{Drawing, On, V};
use toml::{Table, Value};

/// Returns a nested table, and creates it if it is absent.
fn section<'t>(table: &'t mut Table, keys: &[&str]) -> &'t mut Table {
    keys.iter().fold(table, |table, key| {
        let entry = table.entry(*key).or_insert(Value::Table(Table::new()));
        entry.as_table_mut().unwrap()
    })
}

fn vector(value: &Value) -> V<f64> {
    let mut entries = value.as_array().unwrap().iter();
    let mut next = || entries.next().unwrap().as_float().unwrap();
    V::new(next(), next(), next())
}

impl Drawing {
    /// Reads a study's text, with further `path=value` entries.
    pub fn read(text: &str, further: &[&str]) -> Drawing {
        let mut study: Table = text.parse().unwrap();
        for entry in further {
            let (path, value) = entry.split_once('=').unwrap();
            let value: Table = format!("value={value}").parse().unwrap();
            let keys: Vec<&str> = path.split('.').collect();
            let (last, before) = keys.split_last().unwrap();
            section(&mut study, before).insert((*last).to_owned(), value["value"].clone());
        }
        let angles = section(&mut study, &["wheel"]).clone();
        let suspension = section(&mut study, &["suspension"]);
        let topology = suspension["topology"].as_str().unwrap().to_owned();
        let hardpoints = section(suspension, &["hardpoints"]).clone();
        let extra = section(suspension, &["extra_points"]).clone();
        let bodies = section(suspension, &["bodies"]).clone();
        let mut names: Vec<String> = hardpoints.keys().cloned().collect();
        let mut points: Vec<V<f64>> = hardpoints.values().map(vector).collect();
        for (name, point) in &extra {
            names.push(name.clone());
            points.push(vector(&point["position"]));
        }
        let find = |name: &str| names.iter().position(|n| n == name);
        let id = |name: &str| find(name).unwrap_or_else(|| panic!("no {name}"));

        let arms: &[&str] = match &*topology {
            "macpherson" => &["lower"],
            "double_wishbone" => &["lower", "upper"],
            _ => &[],
        };
        let mut members = Vec::new();
        for arm in arms {
            for leg in ["front", "rear"] {
                let inner = format!("{arm}_arm_{leg}");
                let ends = [id(&inner), id(&format!("{arm}_ball_joint"))];
                members.push((inner, ends));
            }
        }
        for name in &names {
            if let Some(link) = name.strip_suffix("_inner")
                && (link == "tie_rod" || (link.ends_with("_link") && link != "drop_link"))
            {
                members.push((link.to_owned(), [id(name), id(&format!("{link}_outer"))]));
            }
        }
        let mut rockers = Vec::new();
        for (rod, pivots) in [
            ("pushrod", ["rocker_pivot_front", "rocker_pivot_rear"]),
            ("pullrod", ["rocker_pivot_front", "rocker_pivot_rear"]),
            ("drop_link", ["anti_roll_bar_inner", "anti_roll_bar_outer"]),
        ] {
            if let Some(inner) = find(&format!("{rod}_inner")) {
                members.push((rod.to_owned(), [inner, id(&format!("{rod}_outer"))]));
                rockers.push(pivots.map(id));
            }
        }
        let has_rocker = find("rocker_pivot_front").is_some();
        let bar = On::Rocker(usize::from(has_rocker));
        let is_wishbone = topology == "double_wishbone";
        let lower = if is_wishbone { On::Arm(0) } else { On::Carrier };
        let upper = if is_wishbone { On::Arm(1) } else { On::Carrier };
        let body = |name: &str| match name {
            "chassis" => On::Body,
            "strut_rod" => On::StrutRod,
            "lower_arm" => On::Arm(0),
            "upper_arm" => On::Arm(1),
            "rocker" => On::Rocker(0),
            "anti_roll_bar" => bar,
            "knuckle" | "arm" => On::Carrier,
            other => panic!("no body {other}"),
        };
        let on = names.iter().map(|name| match &**name {
            name if bodies.contains_key(name) => body(bodies[name].as_str().unwrap()),
            name if extra.contains_key(name) => body(extra[name]["body"].as_str().unwrap()),
            "tie_rod_inner" | "toe_link_inner" => On::Rack,
            "pushrod_inner" | "pullrod_inner" => On::Rocker(0),
            "drop_link_inner" => bar,
            "spring_lower" if has_rocker => On::Rocker(0),
            "spring_lower" | "pushrod_outer" | "drop_link_outer" => lower,
            "pullrod_outer" => upper,
            "spindle_inner" => On::Carrier,
            "strut_top" | "spring_upper" => On::Body,
            "anti_roll_bar_inner" | "anti_roll_bar_outer" => On::Body,
            name if name.ends_with("_inner") || name.contains("_pivot_") => On::Body,
            name if name.ends_with("_arm_front") || name.ends_with("_arm_rear") => On::Body,
            _ => On::Carrier,
        });
        let angle = |key: &str| {
            let degrees = angles.get(key).and_then(Value::as_float).unwrap_or(0.0);
            degrees.to_radians().sin_cos()
        };
        let spin = find("spindle_inner").ok_or_else(|| {
            let ((camber, level), (toe, ahead)) = (angle("static_camber"), angle("static_toe"));
            V::new(level * toe, level * ahead, -camber)
        });
        let pivots = ["arm_pivot_inner", "arm_pivot_outer"];
        Drawing {
            on: on.collect(),
            arms: arms
                .iter()
                .map(|arm| {
                    ["arm_front", "arm_rear", "ball_joint"].map(|p| id(&format!("{arm}_{p}")))
                })
                .collect(),
            rockers,
            strut: find("strut_top").map(|top| (top, id("strut_lower"), find("strut_upper"))),
            hinge: find(pivots[0]).map(|_| pivots.map(id)),
            centre: id("wheel_centre"),
            spin,
            members,
            points,
            names,
        }
    }
}

//! Tests of forces in the members of solid axles: the axle is in balance (three forces, three moments). The test uses
//! only the points of the study.

use super::own::{Point, cross, minus, mirror};
use super::{axle, case, points_of, study_of};
use crate::support::random::Random;
use hardpoint::axle::axle_curves;
use hardpoint::curves::Curves;
use hardpoint::model::Side;
use serde_json::Value;

fn value(curves: &Curves, name: &str) -> f64 {
    let place = curves.columns.iter().position(|c| c.name == name);
    let place = place.unwrap_or_else(|| {
        let names: Vec<_> = curves.columns.iter().map(|c| &c.name).collect();
        panic!("{name} is none of {names:?}")
    });
    curves.stations[0].value(place).expect("a force")
}

/// Forces on the axle in the design position, each with its point of application. `supports` are the names of the
/// springs. Without springs they name the vertical forces at both wheel centres.
fn forces(curves: &Curves, case: &Value, load: &str, has_spring: bool) -> Vec<(Point, Point)> {
    let named = points_of(case);
    let at = |name: &str| -> Option<Point> {
        let (_, theirs) = named.iter().find(|(ours, _)| *ours == name)?;
        Some([0, 1, 2].map(|i| case["points"][theirs][i].as_f64().unwrap()))
    };
    let pull = |from: Point, to: Point, tension: f64| {
        let way = minus(to, from);
        let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
        (from, way.map(|c| tension * c / length))
    };
    let mut all = Vec::new();
    let mut rod = |name: &str, column: &str, turn: fn(Point) -> Point| {
        let ends = ["axle", "chassis"].map(|end| at(&format!("{name}_{end}")).map(turn));
        if let [Some(own), Some(body)] = ends {
            let tension = value(curves, &format!("{load}_{column}_N"));
            all.push(pull(own, body, tension));
        }
    };
    let same = |p: Point| p;
    let is_single = at("panhard_axle").is_some();
    rod("lower_link", "left_lower_link", same);
    rod("lower_link", "right_lower_link", mirror);
    if is_single {
        rod("upper_link", "upper_link", same);
        rod("panhard", "panhard", same);
    } else {
        rod("upper_link", "left_upper_link", same);
        rod("upper_link", "right_upper_link", mirror);
    }
    for (side, turn) in [("left", same as fn(Point) -> Point), ("right", mirror)] {
        if has_spring {
            let compression = value(curves, &format!("{load}_{side}_spring_N"));
            let [lower, upper] = ["spring_lower", "spring_upper"].map(|n| turn(at(n).unwrap()));
            all.push(pull(lower, upper, -compression));
        } else {
            let up = value(curves, &format!("{load}_{side}_support_N"));
            all.push((turn(at("wheel_centre").unwrap()), [0.0, 0.0, up]));
        }
    }
    all
}

/// Forces and moments about the origin are in balance. The test covers loads on either wheel, springs and supports at
/// the wheel centres, and a different right half.
#[test]
fn members_balance_loads_on_either_wheel() {
    let mut random = Random(47);
    for name in ["solid_four_link", "solid_three_link_panhard"] {
        for has_spring in [true, false] {
            let case = case(name);
            let force = random.vector(3000.0).to_array();
            let moment = random.vector(3e5).to_array();
            let loads = format!(
                "[motion]\nheave = [0.0]\n[outputs]\ncharacteristics = [\"toe\"]\nloads = [{{ name = \"kerb\", at = \
                 \"wheel_centre\", force = {force:?}, moment = {moment:?} }}]\n"
            );
            let mut text = study_of(&case, &loads);
            let springs = text.lines().any(|line| line.starts_with("spring_lower"));
            assert!(springs, "{name}");
            if !has_spring {
                let lines = text.lines().filter(|line| !line.starts_with("spring_"));
                text = lines.map(|line| format!("{line}\n")).collect();
            }
            let study = axle(&text);
            let curves = axle_curves(&study.axle, &study.plan).unwrap().curves;
            let centre = {
                let id = study.axle.left.mechanism.wheel_centre;
                study.axle.left.design[id.0].to_array()
            };
            for side in Side::ALL {
                let load = format!("{}_kerb", side.name());
                let mut all = forces(&curves, &case, &load, has_spring);
                let loaded = match side {
                    Side::Left => centre,
                    Side::Right => mirror(centre),
                };
                all.push((loaded, force));
                let (mut sum, mut about, mut size) = ([0.0; 3], moment, 0.0);
                for (point, force) in &all {
                    let turning = cross(*point, *force);
                    for i in 0..3 {
                        sum[i] += force[i];
                        about[i] += turning[i];
                        size += force[i].abs();
                    }
                }
                for i in 0..3 {
                    assert!(sum[i].abs() < 1e-12 * size, "{name} {side:?}: {sum:?}");
                    assert!(about[i].abs() < 1e-9 * size, "{name} {side:?}: {about:?}");
                }
            }
        }
    }
}

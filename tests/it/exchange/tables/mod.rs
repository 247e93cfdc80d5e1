//! Tests of tables whose import can go wrong: two axles, wheels at the origin, rod ends and static angles. The import
//! reads the correct number. Otherwise it refuses the file and names the option that helps.

mod cells;
mod contradictions;
mod corners;
mod rods;
mod wheel;

use super::{Said, at, file, imported};
use hardpoint::exchange::Imported;

/// Left front wheel and left rear wheel of one car, ISO 8855, mm.
const FRONT: [(&str, [f64; 3]); 9] = [
    ("LCA front", [150.0, 210.0, 120.0]),
    ("LCA rear", [-140.0, 215.0, 126.0]),
    ("LBJ", [3.0, 575.0, 124.0]),
    ("UCA front", [118.0, 250.0, 266.0]),
    ("UCA rear", [-121.0, 252.0, 257.0]),
    ("UBJ", [-11.0, 551.0, 284.0]),
    ("tie rod inner", [52.0, 145.0, 146.0]),
    ("tie rod outer", [71.0, 563.0, 151.0]),
    ("wheel centre", [0.0, 612.0, 203.0]),
];

const REAR: [(&str, [f64; 3]); 9] = [
    ("LCA front", [-1385.0, 240.0, 126.0]),
    ("LCA rear", [-1685.0, 241.0, 121.0]),
    ("LBJ", [-1535.0, 577.0, 113.0]),
    ("UCA front", [-1386.0, 242.0, 282.0]),
    ("UCA rear", [-1684.0, 243.0, 251.0]),
    ("UBJ", [-1534.0, 521.0, 280.0]),
    ("tie rod inner", [-1630.0, 239.0, 163.0]),
    ("tie rod outer", [-1615.0, 590.0, 166.0]),
    ("wheel centre", [-1536.0, 613.0, 204.0]),
];

const WANTED: [&str; 9] = [
    "lower_arm_front",
    "lower_arm_rear",
    "lower_ball_joint",
    "upper_arm_front",
    "upper_arm_rear",
    "upper_ball_joint",
    "tie_rod_inner",
    "tie_rod_outer",
    "wheel_centre",
];

fn of(name: &str, text: &str, said: &Said) -> Result<Imported, String> {
    let directory = tempfile::tempdir().unwrap();
    imported(
        &file(&directory, name, text.as_bytes()),
        "double_wishbone",
        said,
    )
}

fn rows(points: &[(&str, [f64; 3])], name: impl Fn(&str) -> String) -> String {
    let row = |(known, [x, y, z]): &(&str, [f64; 3])| format!("{},{x},{y},{z}\n", name(known));
    points.iter().map(row).collect()
}

fn has_points(read: &Imported, points: &[(&str, [f64; 3])]) {
    for ((_, position), name) in points.iter().zip(WANTED) {
        assert_eq!(at(read, name), *position, "{name}");
    }
}

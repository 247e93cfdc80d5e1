//! Tests of the bushings of Adams/Car.

use super::silent::SUBSYSTEM;
use super::{Said, imported, study};

/// Units of a subsystem file.
const UNITS: &str = "\
[UNITS]
 LENGTH = 'mm'
 ANGLE = 'degrees'
";

/// Four bushings of a subsystem file. The files determine the directions of the first one only.
const BUSHINGS: &str = "\
[BUSHING_ASSEMBLY]
 USAGE = 'bkl_lca_front'
 SYMMETRY = 'left/right'
 PROPERTY_FILE = 'mdids://made_up/bushings.tbl/soft.bus'
 FZ_SCALING_FACTOR = 2.0
[BUSHING_ASSEMBLY]
 USAGE = 'uca_front'
 PROPERTY_FILE = '<made_up>/bushings.tbl/other.bus'
[BUSHING_ASSEMBLY]
 USAGE = 'tierod_inner'
 PROPERTY_FILE = '<made_up>/bushings.tbl/soft.bus'
[BUSHING_ASSEMBLY]
 USAGE = 'subframe_mount'
 PROPERTY_FILE = '<made_up>/bushings.tbl/soft.bus'
";

fn bus(fy: f64) -> String {
    let mut text = "[UNITS]\nLENGTH = 'mm'\nANGLE = 'degrees'\nFORCE = 'newton'\n".to_owned();
    for (axis, at_end) in [("FX", 9000.0), ("FY", fy), ("FZ", 1500.0)] {
        text += &format!("[{axis}_CURVE]\n-1.0 {}\n0 0\n1.0 {at_end}\n", -at_end);
    }
    for axis in ["TX", "TY"] {
        text += &format!("[{axis}_CURVE]\n-2.0 -500.0\n-1.0 -100.0\n0 0\n1.0 100.0\n2.0 500.0\n");
    }
    text + "[TZ_CURVE]\n-1.0 -50.0\n1.0 50.0\n"
}

/// The import reads a bushing if the files determine its directions. It names the other bushings.
#[test]
fn bushings_of_adams_are_taken_where_their_directions_are_known() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    for folder in ["subsystems.tbl", "bushings.tbl"] {
        std::fs::create_dir(at(folder)).unwrap();
    }
    let subsystem = [UNITS, SUBSYSTEM, BUSHINGS].concat();
    std::fs::write(at("subsystems.tbl/front.sub"), subsystem).unwrap();
    std::fs::write(at("bushings.tbl/soft.bus"), bus(9000.0)).unwrap();
    std::fs::write(at("bushings.tbl/other.bus"), bus(8000.0)).unwrap();
    let path = at("subsystems.tbl/front.sub");
    let plain = imported(&path, "double_wishbone", &Said::default()).unwrap();
    assert!(
        plain
            .left_out
            .iter()
            .any(|line| line.contains("--bushings")),
        "{:?}",
        plain.left_out
    );
    assert!(!plain.study("s", "there").unwrap().contains("[bushings"));

    let said = Said {
        radius: Some(310.0),
        bushings: true,
        ..Said::default()
    };
    let read = imported(&path, "double_wishbone", &said).unwrap();
    let reasons = read.left_out.join("\n");
    for expected in [
        "FX and FY differ",
        "it is at tie_rod_inner",
        "is not a hardpoint of this wheel",
    ] {
        assert!(reasons.contains(expected), "{expected}: {reasons}");
    }
    let text = read.study("s", "there").unwrap();
    let study = study(&text);
    assert!(study.wheel().mechanism.point("lower_arm_front").is_some());
    // The z axis in the Adams file is the bushing's x axis in the study. The file has a separate scale factor for this
    // axis. 50 N mm at 1 deg are 50 x 180/pi N mm/rad.
    let about = 50.0 * 180.0 / std::f64::consts::PI;
    let line = text
        .lines()
        .find(|line| line.starts_with("stiffness"))
        .unwrap();
    let numbers: Vec<f64> = line
        .split(['[', ',', ']'])
        .filter_map(|word| word.trim().parse().ok())
        .collect();
    assert_eq!(numbers[..3], [3000.0, 9000.0, 9000.0]);
    assert!((numbers[3] - about).abs() < 1e-9 * about, "{line}");
    assert_eq!(numbers[4..], [0.0, 0.0]);
    let degree = std::f64::consts::PI / 180.0;
    assert!(
        text.contains(&format!("ty = [[{:?}, -500.0]", -2.0 * degree)),
        "{text}"
    );
}

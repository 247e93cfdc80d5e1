//! Tests of the orders and signs of coordinates: an import gives the same suspension or a refusal, never another
//! suspension.

use super::geometry::{Chance, Points, geometry};
use super::{Said, file, imported};
use hardpoint::exchange::Imported;
use hardpoint::model::{Frame, Side};
use hardpoint::number::Vector3;
use std::collections::BTreeMap;

/// The 48 combinations of column order and signs. Each has the directions of its columns in words, and true if it is
/// right-handed.
fn orders() -> Vec<([usize; 3], [f64; 3], String, bool)> {
    let names = [["forward", "rearward"], ["left", "right"], ["up", "down"]];
    let mut all = Vec::new();
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        for bits in 0..8 {
            let signs = [0, 1, 2].map(|k| if bits >> k & 1 == 0 { 1.0 } else { -1.0 });
            let ways: Vec<&str> = (0..3)
                .map(|k| names[order[k]][usize::from(signs[k] < 0.0)])
                .collect();
            // Determinant, written out.
            let mut matrix = [[0.0; 3]; 3];
            for k in 0..3 {
                matrix[k][order[k]] = signs[k];
            }
            let [a, b, c] = matrix;
            let determinant = a[0] * (b[1] * c[2] - b[2] * c[1])
                - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
            all.push((order, signs, ways.join(","), determinant > 0.0));
        }
    }
    all
}

fn table(
    points: &Points,
    order: [usize; 3],
    signs: [f64; 3],
    header: [&str; 3],
    end: &str,
) -> String {
    let mut text = format!("name,{},{},{}\n", header[0], header[1], header[2]);
    for (name, position) in points {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|k| signs[k] * position[order[k]]);
        text += &format!("{name}{end},{x:?},{y:?},{z:?}\n");
    }
    text
}

/// Returns true if the imported suspension has these points, in the frame of its wheel.
fn is_the_same(imported: &Imported, points: &Points) -> bool {
    let frame = Frame::new(imported.frame, imported.side);
    points.iter().all(|(name, position)| {
        let found = imported.hardpoints.iter().find(|h| h.name == *name);
        found.is_some_and(|h| {
            let [x, y, z] = h.position;
            let kernel = frame.vector(Vector3::new(x, y, z)).to_array();
            kernel.map(|x| x + 0.0) == position.map(|x| x + 0.0)
        })
    })
}

#[test]
fn no_order_of_coordinates_makes_another_suspension() {
    import_in_all_orders(1);
}

#[test]
#[ignore = "230 geometries"]
fn no_order_of_coordinates_makes_another_of_many_suspensions() {
    import_in_all_orders(5);
}

/// The test reads 38 geometries (times `scale`) of all topologies, in all 48 orders and signs. If the order is
/// right-handed, the import gives the same doubles or a refusal. If the order is left-handed, the import refuses the
/// file, unless `--axes` names the order.
fn import_in_all_orders(scale: usize) {
    const SEED: u64 = 20_261_125;
    let directory = tempfile::tempdir().unwrap();
    let mut chance = Chance(SEED);
    // The last four topologies have fewer geometries, because reading them takes longer.
    let topologies: [(&str, usize); 8] = [
        ("double_wishbone", 6 * scale),
        ("macpherson", 6 * scale),
        ("five_link", 6 * scale),
        ("semi_trailing_arm", 12 * scale),
        ("h_arm", 2 * scale),
        ("integral_link", 2 * scale),
        ("trailing_arm_two_links", 2 * scale),
        ("solid_axle", 2 * scale),
    ];
    let mut counts = BTreeMap::new();
    for (topology, rounds) in topologies {
        let (mut right, mut refused) = (0, 0);
        for round in 0..rounds {
            let is_trailing = topology == "semi_trailing_arm";
            let has_spring = is_trailing && round % 4 != 3;
            let points = geometry(topology, &mut chance, has_spring);
            for (order, signs, ways, is_right_handed) in orders() {
                let text = table(&points, order, signs, ["x", "y", "z"], "");
                let path = file(&directory, "points.csv", text.as_bytes());
                let case = format!("{topology} {round}: {ways}");
                match imported(&path, topology, &Said::default()) {
                    Ok(read) => {
                        assert!(is_right_handed, "{case}: {:?}", read.notes);
                        assert!(is_the_same(&read, &points), "{case}: {:?}", read.notes);
                        right += 1;
                    }
                    Err(reason) => {
                        assert!(reason.contains("--axes"), "{case}: {reason}");
                        refused += usize::from(is_right_handed);
                    }
                }
                let said = Said {
                    axes: Some(Box::leak(ways.clone().into_boxed_str())),
                    ..Said::default()
                };
                let read = imported(&path, topology, &said);
                let read = read.unwrap_or_else(|reason| panic!("{case}: {reason}"));
                assert!(is_the_same(&read, &points), "--axes {case}");
            }
        }
        counts.insert(topology, (right, refused));
    }
    println!("imported and refused of the right-handed orders: {counts:?}");
    // The points of a trailing arm without spring do not show which direction is up. A quarter of the arms have no
    // spring. Some arms with a spring are ambiguous, too, so the program imports 39 of 60 trailing arms. The links of a
    // solid axle do not show which direction is forward. All other topologies are unambiguous.
    for (topology, (right, refused)) in &counts {
        let least = match *topology {
            "semi_trailing_arm" => 0.5,
            "solid_axle" => 0.0,
            _ => 0.9,
        };
        let share = f64::from(*right) / (f64::from(*right) + *refused as f64);
        assert!(share >= least, "{topology}: {share} of {counts:?}");
    }
}

/// If the names of the points contain the side, the program imports all right-handed axis orders of a left or right
/// wheel.
#[test]
fn orders_of_either_wheel_are_told_by_its_side() {
    let directory = tempfile::tempdir().unwrap();
    let mut chance = Chance(7);
    for (side, end, sign) in [(Side::Left, " LH", 1.0), (Side::Right, " RH", -1.0)] {
        for topology in [
            "double_wishbone",
            "macpherson",
            "five_link",
            "h_arm",
            "integral_link",
            "trailing_arm_two_links",
        ] {
            let left = geometry(topology, &mut chance, false);
            let there: Points = left
                .iter()
                .map(|(name, [x, y, z])| (*name, [*x, sign * y, *z]))
                .collect();
            for (order, signs, ways, is_right_handed) in orders() {
                let text = table(&there, order, signs, ["x", "y", "z"], end);
                let path = file(&directory, "points.csv", text.as_bytes());
                match imported(&path, topology, &Said::default()) {
                    Ok(read) => {
                        assert!(is_right_handed, "{topology}: {ways}");
                        assert_eq!(read.side, side, "{topology}: {ways}");
                        assert!(is_the_same(&read, &left), "{topology}: {ways}");
                    }
                    Err(reason) => assert!(reason.contains("--axes"), "{ways}: {reason}"),
                }
            }
        }
    }
}

/// Headers may state the directions in words. The program then reads all 24 right-handed orders, even if the points do
/// not show which direction is up. It refuses headers that contradict the points.
#[test]
fn headers_are_read_by_letter_and_words() {
    let directory = tempfile::tempdir().unwrap();
    let mut chance = Chance(11);
    let points = geometry("semi_trailing_arm", &mut chance, false);
    let names = ["x", "Y", "z"];
    for (order, signs, ways, is_right_handed) in orders() {
        let ways: Vec<&str> = ways.split(',').collect();
        let headers = [
            format!("{} ({} +)", names[0], ways[0]),
            format!("{}: {} [mm]", names[1], ways[1]),
            format!("\" {}, + {}\"", names[2], ways[2]),
        ];
        let header = headers.each_ref().map(String::as_str);
        let text = table(&points, order, signs, header, "");
        let path = file(&directory, "points.csv", text.as_bytes());
        match imported(&path, "semi_trailing_arm", &Said::default()) {
            Ok(read) => {
                assert!(is_right_handed && is_the_same(&read, &points), "{ways:?}");
            }
            Err(reason) => {
                assert!(
                    !is_right_handed && reason.contains("--axes"),
                    "{ways:?}: {reason}"
                );
            }
        }
    }
    // Headers with columns in another order than x, y, z, and a header with words instead of letters.
    let wheel = geometry("double_wishbone", &mut chance, false);
    for (header, order) in [
        (["Y (left)", "X (fwd)", "Z (up)"], [1, 0, 2]),
        (["y", "x", "z"], [1, 0, 2]),
        (["z [mm]", "x [mm]", "y [mm]"], [2, 0, 1]),
        (["Lateral", "Longitudinal", "Vertical"], [1, 0, 2]),
    ] {
        let text = table(&wheel, order, [1.0; 3], header, " L");
        let path = file(&directory, "points.csv", text.as_bytes());
        let read = imported(&path, "double_wishbone", &Said::default());
        // The last header does not state the positive direction of its columns. The columns are y, x, z. With left,
        // forward and up as positive directions they are left-handed, so the import refuses them.
        if header[0] == "Lateral" {
            assert!(read.unwrap_err().contains("--axes left,forward,up"));
        } else {
            assert!(is_the_same(&read.unwrap(), &wheel), "{header:?}");
        }
    }
    let header = ["X (up)", "Y (left)", "Z (rearward)"];
    let text = table(&wheel, [0, 1, 2], [1.0; 3], header, " L");
    let path = file(&directory, "points.csv", text.as_bytes());
    let refused = imported(&path, "double_wishbone", &Said::default()).unwrap_err();
    assert!(refused.contains("--axes forward,left,up"), "{refused}");
}

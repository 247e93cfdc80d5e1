//! Tests of the orders and signs of coordinates: an import gives the same suspension or a refusal, never another
//! suspension.

use super::{Said, file, imported};
use hardpoint::exchange::Imported;
use hardpoint::model::{Frame, Side};
use hardpoint::number::Vector3;
use std::collections::BTreeMap;

/// Random numbers between bounds.
struct Chance(u64);

impl Chance {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let share = (self.0 >> 11) as f64 / (1u64 << 53) as f64;
        ((low + share * (high - low)) * 1000.0).round() / 1000.0
    }

    fn point(&mut self, x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> [f64; 3] {
        [x, y, z].map(|[low, high]| self.between(low, high))
    }
}

type Points = Vec<(&'static str, [f64; 3])>;

fn lower_arm(c: &mut Chance) -> Points {
    vec![
        (
            "lower_arm_front",
            c.point([80.0, 250.0], [150.0, 400.0], [90.0, 220.0]),
        ),
        (
            "lower_arm_rear",
            c.point([-300.0, -80.0], [150.0, 400.0], [90.0, 220.0]),
        ),
        (
            "lower_ball_joint",
            c.point([-40.0, 40.0], [560.0, 740.0], [100.0, 210.0]),
        ),
        (
            "tie_rod_inner",
            c.point([-160.0, 120.0], [140.0, 360.0], [120.0, 260.0]),
        ),
        (
            "tie_rod_outer",
            c.point([-150.0, 120.0], [540.0, 720.0], [130.0, 260.0]),
        ),
        (
            "wheel_centre",
            c.point([-30.0, 30.0], [610.0, 800.0], [200.0, 330.0]),
        ),
    ]
}

/// Random left wheel in ISO 8855 (mm), anywhere along the car. If `has_spring` is true, a trailing arm gets its spring.
fn geometry(topology: &str, c: &mut Chance, has_spring: bool) -> Points {
    let mut points = match topology {
        "double_wishbone" => {
            let mut points = lower_arm(c);
            points.extend([
                (
                    "upper_arm_front",
                    c.point([60.0, 220.0], [200.0, 420.0], [260.0, 430.0]),
                ),
                (
                    "upper_arm_rear",
                    c.point([-250.0, -60.0], [200.0, 420.0], [260.0, 430.0]),
                ),
                (
                    "upper_ball_joint",
                    c.point([-60.0, 20.0], [520.0, 700.0], [300.0, 500.0]),
                ),
            ]);
            points
        }
        "macpherson" => {
            let mut points = lower_arm(c);
            points.extend([
                (
                    "strut_top",
                    c.point([-70.0, 20.0], [480.0, 600.0], [720.0, 900.0]),
                ),
                (
                    "strut_lower",
                    c.point([-20.0, 20.0], [600.0, 660.0], [330.0, 420.0]),
                ),
            ]);
            points
        }
        "five_link" => {
            let mut points = Vec::new();
            for (front, rear, z) in [
                (
                    ["upper_front_link_inner", "upper_front_link_outer"],
                    ["upper_rear_link_inner", "upper_rear_link_outer"],
                    [400.0, 500.0],
                ),
                (
                    ["lower_front_link_inner", "lower_front_link_outer"],
                    ["lower_rear_link_inner", "lower_rear_link_outer"],
                    [150.0, 240.0],
                ),
            ] {
                points.push((front[0], c.point([80.0, 300.0], [250.0, 420.0], z)));
                points.push((front[1], c.point([20.0, 60.0], [620.0, 720.0], z)));
                points.push((rear[0], c.point([-260.0, -80.0], [250.0, 420.0], z)));
                points.push((rear[1], c.point([-60.0, -20.0], [620.0, 720.0], z)));
            }
            points.extend([
                (
                    "toe_link_inner",
                    c.point([-200.0, -100.0], [250.0, 400.0], [250.0, 330.0]),
                ),
                (
                    "toe_link_outer",
                    c.point([-180.0, -100.0], [620.0, 720.0], [250.0, 330.0]),
                ),
                (
                    "wheel_centre",
                    c.point([-20.0, 20.0], [690.0, 800.0], [280.0, 330.0]),
                ),
            ]);
            points
        }
        "h_arm" => vec![
            (
                "lower_arm_front",
                c.point([120.0, 260.0], [200.0, 350.0], [220.0, 280.0]),
            ),
            (
                "lower_arm_rear",
                c.point([-220.0, -100.0], [200.0, 350.0], [210.0, 270.0]),
            ),
            (
                "lower_joint_front",
                c.point([70.0, 140.0], [640.0, 700.0], [190.0, 240.0]),
            ),
            (
                "lower_joint_rear",
                c.point([-150.0, -80.0], [640.0, 700.0], [190.0, 240.0]),
            ),
            (
                "upper_link_inner",
                c.point([-30.0, 30.0], [360.0, 430.0], [430.0, 490.0]),
            ),
            (
                "upper_link_outer",
                c.point([-30.0, 30.0], [640.0, 690.0], [440.0, 500.0]),
            ),
            (
                "wheel_centre",
                c.point([-20.0, 20.0], [720.0, 800.0], [290.0, 340.0]),
            ),
        ],
        "integral_link" => {
            let mut points = lower_arm(c);
            points.retain(|(name, _)| !name.starts_with("tie_rod"));
            points.extend([
                (
                    "integral_link_inner",
                    c.point([70.0, 120.0], [600.0, 650.0], [180.0, 230.0]),
                ),
                (
                    "integral_link_outer",
                    c.point([70.0, 120.0], [620.0, 670.0], [310.0, 370.0]),
                ),
                (
                    "upper_link_inner",
                    c.point([-30.0, 30.0], [360.0, 430.0], [430.0, 490.0]),
                ),
                (
                    "upper_link_outer",
                    c.point([-30.0, 30.0], [640.0, 690.0], [440.0, 500.0]),
                ),
                (
                    "toe_link_inner",
                    c.point([-220.0, -150.0], [300.0, 380.0], [230.0, 280.0]),
                ),
                (
                    "toe_link_outer",
                    c.point([-220.0, -150.0], [660.0, 720.0], [230.0, 280.0]),
                ),
            ]);
            points
        }
        "trailing_arm_two_links" => vec![
            (
                "arm_pivot",
                c.point([430.0, 560.0], [500.0, 620.0], [260.0, 330.0]),
            ),
            (
                "upper_link_inner",
                c.point([-40.0, 60.0], [320.0, 420.0], [390.0, 440.0]),
            ),
            (
                "upper_link_outer",
                c.point([-40.0, 60.0], [600.0, 660.0], [400.0, 450.0]),
            ),
            (
                "lower_link_inner",
                c.point([-90.0, 40.0], [220.0, 320.0], [200.0, 250.0]),
            ),
            (
                "lower_link_outer",
                c.point([-90.0, 40.0], [620.0, 680.0], [200.0, 250.0]),
            ),
            (
                "wheel_centre",
                c.point([-20.0, 20.0], [690.0, 800.0], [280.0, 330.0]),
            ),
        ],
        "solid_axle" => vec![
            (
                "lower_link_chassis",
                c.point([430.0, 560.0], [380.0, 480.0], [280.0, 330.0]),
            ),
            (
                "lower_link_axle",
                c.point([-20.0, 20.0], [480.0, 560.0], [230.0, 280.0]),
            ),
            (
                "upper_link_chassis",
                c.point([300.0, 380.0], [420.0, 500.0], [420.0, 470.0]),
            ),
            (
                "upper_link_axle",
                c.point([-20.0, 30.0], [120.0, 180.0], [450.0, 500.0]),
            ),
            (
                "wheel_centre",
                c.point([-20.0, 20.0], [720.0, 800.0], [310.0, 350.0]),
            ),
        ],
        _ => vec![
            (
                "arm_pivot_inner",
                c.point([300.0, 420.0], [150.0, 300.0], [200.0, 330.0]),
            ),
            (
                "arm_pivot_outer",
                c.point([380.0, 520.0], [480.0, 640.0], [200.0, 330.0]),
            ),
            (
                "wheel_centre",
                c.point([-20.0, 20.0], [650.0, 800.0], [260.0, 330.0]),
            ),
        ],
    };
    if has_spring {
        points.push((
            "spring_upper",
            c.point([-50.0, 80.0], [440.0, 520.0], [500.0, 640.0]),
        ));
        points.push((
            "spring_lower",
            c.point([-50.0, 80.0], [480.0, 560.0], [180.0, 300.0]),
        ));
    }
    // Random offset along the car, because a file can contain a rear axle or have another origin.
    let along = c.between(-2800.0, 1200.0);
    for (_, [x, ..]) in &mut points {
        *x += along;
    }
    points
}

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

//! Tests of imports that can go wrong: files with two axles, wheels at the origin, rod ends and static angles. The
//! import reads the correct number. Otherwise it refuses the file and names the option that helps.

use super::{Said, file, imported};
use hardpoint::exchange::Imported;
use hardpoint::model::{AxlePosition, LengthUnit, Side};

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

fn at(read: &Imported, name: &str) -> [f64; 3] {
    let found = read.hardpoints.iter().find(|h| h.name == name);
    found
        .unwrap_or_else(|| panic!("{name}: {:?}", read.left_out))
        .position
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

/// Files with both axles, each in another layout.
fn files_of_two_axles() -> Vec<(&'static str, &'static str, String)> {
    let head = "name,x,y,z\n";
    let by_name = format!(
        "{head}{}{}",
        rows(&FRONT, |name| format!("Front {name}")),
        rows(&REAR, |name| format!("Rear {name}"))
    );
    let by_corner = format!(
        "corner,{head}{}{}",
        rows(&FRONT, |name| format!("FL,{name}")),
        rows(&REAR, |name| format!("RL,{name}"))
    );
    let by_title = format!(
        "{head}Front axle\n{}Rear axle\n{}",
        rows(&FRONT, str::to_owned),
        rows(&REAR, str::to_owned)
    );
    let by_letter = format!(
        "{head}{}{}",
        rows(&FRONT, |name| format!("F_{name}")),
        rows(&REAR, |name| format!("R_{name}"))
    );
    let node = |points: &[(&str, [f64; 3])]| {
        let entries = points.iter().map(|(name, p)| format!("{name:?}: {p:?}"));
        entries.collect::<Vec<_>>().join(", ")
    };
    let by_parent = format!(
        "{{\"MyCar\": {{\"front_axle\": {{{}}}, \"rear_axle\": {{{}}}}}}}",
        node(&FRONT),
        node(&REAR)
    );
    let by_key = format!(
        "{{\"unit\": \"mm\", \"front\": {{\"left\": {{{}}}}}, \"rear\": {{\"left\": {{{}}}}}}}",
        node(&FRONT),
        node(&REAR)
    );
    let yaml = |points: &[(&str, [f64; 3])]| {
        let entries = points
            .iter()
            .map(|(name, p)| format!("    {name}: {p:?}\n"));
        entries.collect::<String>()
    };
    let by_wheel = format!("baja_2021:\n  FL:\n{}  RL:\n{}", yaml(&FRONT), yaml(&REAR));
    vec![
        ("names", "points.csv", by_name),
        ("a column", "points.csv", by_corner),
        ("titles", "points.csv", by_title),
        ("letters", "points.csv", by_letter),
        ("parents", "points.json", by_parent),
        ("keys", "points.json", by_key),
        ("wheels", "points.yaml", by_wheel),
    ]
}

#[test]
fn axles_are_never_mixed() {
    for (way, name, text) in files_of_two_axles() {
        let refused = of(name, &text, &Said::default()).unwrap_err();
        assert!(
            refused.contains("--axle front or --axle rear"),
            "{way}: {refused}"
        );
        for (axle, points) in [(AxlePosition::Front, &FRONT), (AxlePosition::Rear, &REAR)] {
            let said = Said {
                axle: Some(axle),
                ..Said::default()
            };
            let read = of(name, &text, &said).unwrap_or_else(|reason| panic!("{way}: {reason}"));
            has_points(&read, points);
        }
    }
    // A file with only one axle is imported, with a note that names the axle.
    let text = format!(
        "name,x,y,z\n{}",
        rows(&FRONT, |name| format!("Front {name}"))
    );
    let read = of("points.csv", &text, &Said::default()).unwrap();
    assert!(read.notes.texts().any(|note| note.contains("axle: front")));
    let rear = Said {
        axle: Some(AxlePosition::Rear),
        ..Said::default()
    };
    let refused = of("points.csv", &text, &rear).unwrap_err();
    assert!(
        refused.contains("points of the front axle only"),
        "{refused}"
    );
}

/// In a file with four wheels whose sides differ, each wheel keeps its own points.
#[test]
fn each_of_four_wheels_is_its_own() {
    let right = |points: &[(&'static str, [f64; 3])]| -> Vec<(&'static str, [f64; 3])> {
        let mirrored = points
            .iter()
            .map(|(name, [x, y, z])| (*name, [x + 1.0, -y - 2.0, z + 3.0]));
        mirrored.collect()
    };
    let (fr, rr) = (right(&FRONT), right(&REAR));
    let mut text = "corner,name,x,y,z\n".to_owned();
    for (corner, points) in [("FL", &FRONT[..]), ("FR", &fr), ("RL", &REAR), ("RR", &rr)] {
        text += &rows(points, |name| format!("{corner},{name}"));
    }
    for (axle, side, points) in [
        (AxlePosition::Front, Side::Left, &FRONT[..]),
        (AxlePosition::Front, Side::Right, &fr),
        (AxlePosition::Rear, Side::Left, &REAR),
        (AxlePosition::Rear, Side::Right, &rr),
    ] {
        let said = Said {
            axle: Some(axle),
            side: Some(side),
            ..Said::default()
        };
        let read = of("points.csv", &text, &said).unwrap();
        assert_eq!(read.side, side);
        has_points(&read, points);
    }
}

#[test]
fn a_wheel_at_the_origin_needs_its_half_track() {
    let moved: Vec<(&str, [f64; 3])> = FRONT
        .iter()
        .map(|(name, [x, y, z])| (*name, [*x, y - 612.0, *z]))
        .collect();
    let text = format!("name,x,y,z\n{}", rows(&moved, str::to_owned));
    let refused = of("points.csv", &text, &Said::default()).unwrap_err();
    assert!(refused.contains("--half-track"), "{refused}");
    let flag = Said {
        half_track: Some(612.0),
        ..Said::default()
    };
    has_points(&of("points.csv", &text, &flag).unwrap(), &FRONT);
    for line in [
        "half track,612,,\n",
        "front track,1224,,\n",
        "track width,1224,,\n",
    ] {
        let read = of("points.csv", &format!("{text}{line}"), &Said::default()).unwrap();
        has_points(&read, &FRONT);
    }
    // The origin of a right wheel is at its wheel centre, so y has the opposite sign.
    let right: Vec<(&str, [f64; 3])> = moved
        .iter()
        .map(|(n, [x, y, z])| (*n, [*x, -y, *z]))
        .collect();
    let text = format!("name,x,y,z\n{}", rows(&right, |name| format!("{name} RH")));
    let read = of("points.csv", &text, &flag).unwrap();
    assert_eq!(at(&read, "wheel_centre"), [0.0, -612.0, 203.0]);
    // The given half track contradicts the points.
    let text = format!("name,x,y,z\n{}", rows(&FRONT, str::to_owned));
    let wrong = Said {
        half_track: Some(700.0),
        ..Said::default()
    };
    assert!(
        of("points.csv", &text, &wrong)
            .unwrap_err()
            .contains("--half-track 700")
    );
}

/// Rows of a pushrod, its rocker, its spring, and an anti-roll bar whose drop link is on the rocker.
const ROCKER: &str = "\
Push rod lower (on LCA),0,530,136
Push rod upper (rocker),0,262,480
Rocker pivot fwd,20,205,445
Rocker pivot aft,-20,205,445
Damper o/b (rocker),0,212,508
Damper i/b (chassis),0,35,495
ARB link @ rocker,-28,180,400
ARB link @ blade,-28,180,330
ARB axis inner,-110,20,330
ARB axis outer,-110,180,330
";

#[test]
fn ends_of_rods_sit_where_rows_put_them() {
    let wheel = format!("name,x,y,z\n{}", rows(&FRONT, str::to_owned));
    let whole = of("points.csv", &format!("{wheel}{ROCKER}"), &Said::default()).unwrap();
    assert_eq!(whole.hardpoints.len(), 19, "{:?}", whole.left_out);
    let study = whole.study("s", "there").unwrap();
    assert!(study.contains("drop_link_outer = \"rocker\""), "{study}");
    // If the rocker is incomplete, the import also leaves out the spring and the drop link, and reports this.
    let without = ROCKER.replace("Rocker pivot fwd,20,205,445\n", "");
    let read = of("points.csv", &format!("{wheel}{without}"), &Said::default()).unwrap();
    let names: Vec<&str> = read.hardpoints.iter().map(|h| h.name).collect();
    assert_eq!(names.len(), 9, "{names:?}");
    let said = read.left_out.join("\n");
    for expected in [
        "the rocker",
        "pushrod_inner",
        "rocker_pivot_front is missing",
        "the spring",
        "the anti-roll bar",
    ] {
        assert!(said.contains(expected), "{expected}: {said}");
    }
    assert!(!said.contains("pullrod"), "{said}");
    // This row does not state its end of the spring. The import leaves out this spring with the rocker.
    let nameless = without.replace("Damper o/b (rocker)", "Damper lower");
    let read = of(
        "points.csv",
        &format!("{wheel}{nameless}"),
        &Said::default(),
    )
    .unwrap();
    assert!(
        read.hardpoints
            .iter()
            .all(|h| !h.name.starts_with("spring"))
    );
    // If the user has assigned a name to a point, the import never leaves out this point. It refuses the file instead.
    let mut said = Said::default();
    said.names.insert(
        "pushrod_inner".to_owned(),
        "Push rod upper (rocker)".to_owned(),
    );
    let refused = of("points.csv", &format!("{wheel}{without}"), &said).unwrap_err();
    assert!(refused.contains("--map names pushrod_inner"), "{refused}");
}

#[test]
fn a_drop_link_between_two_bodies_is_asked_for() {
    let wheel = format!("name,x,y,z\n{}", rows(&FRONT, str::to_owned));
    let link = |place: &str| {
        let rocker = ROCKER.replace(
            "ARB link @ rocker,-28,180,400",
            &format!("Drop link outer,{place}"),
        );
        format!(
            "{wheel}{}",
            rocker.replace("ARB link @ blade", "Drop link inner")
        )
    };
    let body = |text: &str, said: &Said| {
        let read = of("points.csv", text, said)?;
        let study = read.study("s", "there")?;
        Ok::<bool, String>(study.contains("drop_link_outer = \"rocker\""))
    };
    // The end of the drop link may be near the rocker, near the arm, or between them.
    assert!(body(&link("-28,200,420"), &Said::default()).unwrap());
    assert!(!body(&link("-10,480,130"), &Said::default()).unwrap());
    let between = link("-20,250,370");
    let refused = body(&between, &Said::default()).unwrap_err();
    assert!(
        refused.contains("--body drop_link_outer=rocker"),
        "{refused}"
    );
    for (wanted, on_rocker) in [("rocker", true), ("lower_arm", false)] {
        let mut said = Said::default();
        said.bodies
            .insert("drop_link_outer".to_owned(), wanted.to_owned());
        assert_eq!(body(&between, &said), Ok(on_rocker), "{wanted}");
    }
    let mut said = Said::default();
    said.bodies
        .insert("drop_link_outer".to_owned(), "chassis".to_owned());
    assert!(
        body(&between, &said)
            .unwrap_err()
            .contains("expected one of")
    );
    said.bodies.clear();
    said.bodies
        .insert("wheel_centre".to_owned(), "rocker".to_owned());
    assert!(
        body(&between, &said)
            .unwrap_err()
            .contains("--body wheel_centre")
    );
}

#[test]
fn one_point_is_one_hardpoint() {
    let text = format!("name,x,y,z\n{}", rows(&FRONT, str::to_owned));
    let mut said = Said::default();
    said.names
        .insert("upper_ball_joint".to_owned(), "UBJ".to_owned());
    said.names
        .insert("lower_ball_joint".to_owned(), "ubj".to_owned());
    let refused = of("points.csv", &text, &said).unwrap_err();
    assert!(
        refused.contains("lower_ball_joint and upper_ball_joint are both"),
        "{refused}"
    );
    // A name map cannot distinguish two rows with the same name, so the message does not recommend one.
    let twice = format!("{text}LBJ,3,580,124\n");
    let refused = of("points.csv", &twice, &Said::default()).unwrap_err();
    assert!(
        refused.contains("rename or remove one") && !refused.contains("--map"),
        "{refused}"
    );
}

#[test]
fn static_angles_have_the_sign_of_their_tool() {
    let with = |line: &str| {
        let text = format!(
            "name,x,y,z,remarks\n{}{line}\n",
            rows(&FRONT, str::to_owned)
        );
        of("points.csv", &text, &Said::default())
    };
    for (line, toe) in [
        ("static toe,0.2,,,", 0.2),
        ("static toe,0.2,,,deg per wheel", 0.2),
        ("static toe,0.2,,,toe out per side", -0.2),
        ("Static toe,0.2,,,toe-in", 0.2),
        ("toe out,0.2,,,", -0.2),
        ("Static toe,0,,,toe in / out", 0.0),
        ("static toe,-0.2,,,toe in negative", 0.2),
        ("static toe,-0.2,,,positive = toe out", 0.2),
        ("\"Static toe (per side, toe in)\",0.2,,,", 0.2),
        ("Toe per side,0.2,,,", 0.2),
        ("Toe-in,-0.2,,,", -0.2),
        ("static toe,0.2,,,total", 0.1),
        ("static toe,0.2,,,\"total toe, both wheels\"", 0.1),
        (
            "static toe,0.2,deg,,\"toe out positive, both wheels together\"",
            -0.1,
        ),
        ("Total toe,0.2,deg,,", 0.1),
    ] {
        assert_eq!(with(line).unwrap().static_toe, Some(toe), "{line}");
    }
    for (line, camber) in [
        ("static camber,1,,,positive = top in", -1.0),
        ("static camber,1,,,top in positive", -1.0),
        ("static camber,1,,,top inboard positive", -1.0),
        ("Static camber (top in positive),1,,,", -1.0),
        ("static camber,1,deg,,top in", -1.0),
        ("static camber,-1,,,negative = top in", -1.0),
        ("static camber,-1,,,negative camber", -1.0),
        ("static camber,1,,,positive = top out", 1.0),
        ("static camber,1,,,in degrees", 1.0),
    ] {
        let read = with(line).unwrap();
        assert_eq!(read.static_camber, Some(camber), "{line}");
        let is_reported = read
            .notes
            .texts()
            .any(|n| n.starts_with("static_camber: -1.0 deg"));
        assert_eq!(is_reported, camber < 0.0 && line.contains(",1,"), "{line}");
    }
    let radians = with("static toe,0.01,,,rad").unwrap().static_toe.unwrap();
    assert_eq!(radians, 0.01_f64.to_degrees());
    for line in [
        "static toe,2,,,mm at the rim",
        "static toe,0.2,,,toe in or toe out",
        "static toe,-0.2,,,toe out",
        "static toe,0.2,,,both wheels",
    ] {
        assert!(with(line).unwrap_err().contains("static toe"), "{line}");
    }
    for line in ["static camber,-1,,,top in", "static camber,1,,,negative"] {
        let refused = with(line).unwrap_err();
        assert!(refused.contains("\"top out positive\""), "{refused}");
    }
}

#[test]
fn cells_that_mean_nothing_are_refused_with_their_place() {
    let table = |header: &str, cell: &str| {
        format!(
            "{header},name,x,y,z\n{}",
            rows(&FRONT, |name| format!("{cell},{name}"))
        )
    };
    for (header, cell, expected) in [
        ("frame", "iso", "line 2, column 1: the frame is \"iso\""),
        (
            "side",
            "port",
            "line 2, column 1: the wheel or axle is \"port\"",
        ),
        (
            "corner",
            "F1",
            "line 2, column 1: the wheel or axle is \"F1\"",
        ),
        ("frame", "8855", "line 2, column 1: the frame is"),
    ] {
        let refused = of("points.csv", &table(header, cell), &Said::default()).unwrap_err();
        assert!(refused.contains(expected), "{refused}");
    }
    let node = "{\"frame\": \"nautical\", \"LBJ\": [1, 2, 3]}";
    assert!(
        of("points.json", node, &Said::default())
            .unwrap_err()
            .contains("the frame is \"nautical\"")
    );
}

#[test]
fn inch_marks_and_decimal_commas_are_read() {
    let inches = FRONT.map(|(name, p)| (name, p.map(|x| (x / 25.4 * 1000.0).round() / 1000.0)));
    let marked: String = inches
        .iter()
        .map(|(name, [x, y, z])| format!("{name},{x}\",{y}\",{z}\"\n"))
        .collect();
    let read = of(
        "points.csv",
        &format!("name,x,y,z\n{marked}"),
        &Said::default(),
    )
    .unwrap();
    assert_eq!(read.unit, LengthUnit::Inch);
    has_points(&read, &inches);
    let mixed = format!("name,x,y,z\n{marked}").replacen("\",", ",", 1);
    assert!(
        of("points.csv", &mixed, &Said::default())
            .unwrap_err()
            .contains("marked as inches")
    );
    let commas: String = inches
        .iter()
        .map(|(name, p)| {
            let [x, y, z] = p.map(|x| x.to_string().replace('.', ","));
            format!("{name};{x};{y};{z}\n")
        })
        .collect();
    has_points(
        &of(
            "points.csv",
            &format!("name;x;y;z\n{commas}"),
            &Said::default(),
        )
        .unwrap(),
        &inches,
    );
}

/// A cell of several megabytes is neither a name nor a number. The import skips this cell and reads the rest.
#[test]
fn a_huge_cell_is_passed_over() {
    let huge = "lower arm ".repeat(500_000);
    let text = format!("name,x,y,z,remarks\n{}", rows(&FRONT, str::to_owned));
    let remark = text.replacen("124\n", &format!("124,{huge}\n"), 1);
    has_points(
        &of("points.csv", &remark, &Said::default()).unwrap(),
        &FRONT,
    );
    let row = format!("{text}{huge},1,2,3,\n");
    has_points(&of("points.csv", &row, &Said::default()).unwrap(), &FRONT);
    let number = text.replacen("124\n", &format!("{}\n", "1".repeat(5_000_000)), 1);
    let refused = of("points.csv", &number, &Said::default()).unwrap_err();
    assert!(
        refused.contains("a text of 5000000 bytes") && refused.len() < 300,
        "{}",
        refused.len()
    );
}

/// If the points contradict the axes of the file, the message proposes the axes that the points show.
#[test]
fn the_proposed_axes_follow_the_points() {
    let turned: Vec<(&str, [f64; 3])> = FRONT
        .iter()
        .map(|(name, [x, y, z])| (*name, [-x, *y, -z]))
        .collect();
    let text = format!(
        "Coordinates in SAE axes\nname,x,y,z\n{}",
        rows(&turned, str::to_owned)
    );
    let refused = of("points.csv", &text, &Said::default()).unwrap_err();
    assert!(
        refused.contains("give --axes rearward,left,down"),
        "{refused}"
    );
    assert!(!refused.contains("forward,left,up"), "{refused}");
    let said = Said {
        axes: Some("rearward,left,down"),
        ..Said::default()
    };
    has_points(&of("points.csv", &text, &said).unwrap(), &FRONT);
}

/// A side may follow the R of a rear pivot. Then R means rear in files of one wheel and of both wheels.
#[test]
fn a_side_may_follow_the_letter_of_a_rear_pivot() {
    let letters = |name: &str| name.replace(" front", "_F").replace(" rear", "_R");
    let left = rows(&FRONT, |name| format!("{}_LH", letters(name)));
    let mirrored = FRONT.map(|(name, [x, y, z])| (name, [x, -y, z]));
    let right = rows(&mirrored, |name| format!("{}_RH", letters(name)));
    let both = format!("name,x,y,z\n{left}{right}");
    has_points(&of("points.csv", &both, &Said::default()).unwrap(), &FRONT);
    let said = Said {
        side: Some(Side::Right),
        ..Said::default()
    };
    has_points(&of("points.csv", &both, &said).unwrap(), &mirrored);
    // The message about a missing point proposes a point of the imported wheel.
    let unknown = both.replace("UBJ", "Point 7");
    let refused = of("points.csv", &unknown, &said).unwrap_err();
    assert!(refused.contains("= \"Point 7_RH\""), "{refused}");
}

/// The import refuses a file whose points contradict its stated axes.
#[test]
fn axes_that_the_points_contradict_are_refused() {
    let swapped: Vec<(&str, [f64; 3])> = FRONT
        .iter()
        .map(|(n, [x, y, z])| (*n, [*y, *x, *z]))
        .collect();
    let plain = rows(&FRONT, |name| format!("iso8855,{name}"));
    assert!(
        of(
            "points.csv",
            &format!("frame,name,x,y,z\n{plain}"),
            &Said::default()
        )
        .is_ok()
    );
    for frame in ["iso8855", "sae_j670", "x_rear"] {
        let text = format!(
            "frame,name,x,y,z\n{}",
            rows(&swapped, |name| format!("{frame},{name}"))
        );
        let refused = of("points.csv", &text, &Said::default()).unwrap_err();
        assert!(refused.contains("--axes"), "{frame}: {refused}");
    }
    let title = format!(
        "All points in mm, SAE axes\nname,x,y,z\n{}",
        rows(&FRONT, str::to_owned)
    );
    assert!(of("points.csv", &title, &Said::default()).is_err());
    let rows = swapped
        .iter()
        .map(|(name, [x, y, z])| format!(" '{name}'  'left'  {x}  {y}  {z}\n"));
    let subsystem = format!(
        "[UNITS]\n LENGTH = 'mm'\n[HARDPOINT]\n{}",
        rows.collect::<String>()
    );
    let refused = of("front.sub", &subsystem, &Said::default()).unwrap_err();
    assert!(refused.contains("--axes"), "{refused}");
}

/// If one coordinate has a wrong sign or decimal point, the import names this coordinate and its likely value. It does
/// not say that the whole file is wrong.
#[test]
fn a_slip_in_one_coordinate_is_named() {
    for (axis, wrong, likely) in [(1, 575.0, -575.0), (2, -1240.0, -124.0)] {
        let sae = |(n, [x, y, z]): &(&'static str, [f64; 3])| (*n, [*x, -y, -z]);
        let mut points: Vec<(&str, [f64; 3])> = FRONT.iter().map(sae).collect();
        let text = |points: &[(&str, [f64; 3])]| {
            let rows = rows(points, str::to_owned);
            format!("SAE axes mm\nname,x,y,z\n{rows}")
        };
        assert!(of("points.csv", &text(&points), &Said::default()).is_ok());
        assert_eq!((points[2].0, points[2].1[axis]), ("LBJ", likely));
        points[2].1[axis] = wrong;
        let refused = of("points.csv", &text(&points), &Said::default()).unwrap_err();
        let axis = ["x", "y", "z"][axis];
        assert!(
            refused.contains("\"LBJ\"")
                && refused.contains(&format!("{axis} = {likely} instead of {wrong}")),
            "{refused}"
        );
    }
}

/// One wrong coordinate leaves the suspension without travel. The import refuses the file and names this coordinate.
#[test]
fn a_slip_that_stops_the_suspension_is_named() {
    let mut points = FRONT;
    let (name, point) = &mut points[0];
    let (name, right) = (*name, point[2]);
    point[2] *= 10.0;
    let sheet = format!(
        "iso 8855 axes mm\nname,x,y,z\n{}",
        rows(&points, str::to_owned)
    );
    let imported = of("points.csv", &sheet, &Said::default());
    let refused = match imported {
        Err(refused) => refused,
        Ok(imported) => imported.study("points", "points.csv").unwrap_err(),
    };
    assert!(
        refused.contains(&format!("{name:?}"))
            && refused.contains(&format!("z = {right} instead of")),
        "{refused}"
    );
}

/// The import of one wheel compares it with the points of the other wheel. It names those that are not mirror images.
#[test]
fn another_right_wheel_is_named() {
    let sheet = |shift: f64| {
        let mut text = String::from("name,side,x,y,z\n");
        for (name, [x, y, z]) in FRONT {
            text += &format!("{name},left,{x},{y},{z}\n");
            let x = if name == "UBJ" { x + shift } else { x };
            text += &format!("{name},right,{x},{},{z}\n", -y);
        }
        text
    };
    let left_out = |shift: f64| {
        of("points.csv", &sheet(shift), &Said::default())
            .unwrap()
            .left_out
    };
    assert!(left_out(0.0).iter().all(|line| !line.contains("mirror")));
    let named = left_out(2.5);
    let named = named
        .iter()
        .find(|line| line.contains("right wheel"))
        .unwrap();
    assert!(
        named.contains("up to 2.5 mm away") && named.contains(": upper_ball_joint."),
        "{named}"
    );
}

/// A sheet contains the right wheel and states no side. If the user requests the left wheel, the import gives the
/// mirror image.
#[test]
fn the_other_wheel_is_the_mirror_image() {
    let down = FRONT.map(|(name, [x, y, z])| (name, [x, y, -z]));
    let sheet = format!("SAE axes mm\nname,x,y,z\n{}", rows(&down, str::to_owned));
    let right = of("points.csv", &sheet, &Said::default()).unwrap();
    assert_eq!(right.side, Side::Right);
    let said = Said {
        side: Some(Side::Left),
        ..Said::default()
    };
    let left = of("points.csv", &sheet, &said).unwrap();
    assert_eq!(left.side, Side::Left);
    let note = "points taken from the right wheel and mirrored: all points";
    assert!(left.notes.texts().any(|n| n == note), "{:?}", left.notes);
    for (own, mirrored) in right.hardpoints.iter().zip(&left.hardpoints) {
        let [x, y, z] = own.position;
        assert_eq!(mirrored.position, [x, -y, z]);
    }
}

/// The import computes the radius from the contact point, in the wheel plane, also if the wheel centre is at the
/// origin.
#[test]
fn the_contact_point_gives_the_radius() {
    let (x, y, z) = (3.0, 7.0, 203.0);
    let radius = f64::hypot(x, y).hypot(z);
    let with = |points: &[(&str, [f64; 3])], contact: [f64; 3], said: &Said| {
        let [cx, cy, cz] = contact;
        let text = format!(
            "name,x,y,z\n{}contact patch,{cx},{cy},{cz}\n",
            rows(points, str::to_owned)
        );
        of("points.csv", &text, said).unwrap().wheel_radius.unwrap()
    };
    let there = with(&FRONT, [x, 612.0 + y, 0.0], &Said::default());
    assert!((there - radius).abs() < 1e-12 * radius);
    let moved: Vec<(&str, [f64; 3])> = FRONT
        .iter()
        .map(|(n, [x, y, z])| (*n, [*x, y - 612.0, *z]))
        .collect();
    let said = Said {
        half_track: Some(612.0),
        ..Said::default()
    };
    let at_origin = with(&moved, [x, y, 0.0], &said);
    assert!((at_origin - radius).abs() < 1e-12 * radius);
}

/// The import reports a half track in the file that differs from the distance between wheel centre and centre plane.
#[test]
fn a_half_track_beside_the_points_is_compared() {
    let with = |line: &str| {
        let text = format!("name,x,y,z\n{}{line}\n", rows(&FRONT, str::to_owned));
        let read = of("points.csv", &text, &Said::default()).unwrap();
        let differs = |note: &str| note.contains("half track of the file");
        read.notes.texts().any(differs)
    };
    for (line, differs) in [
        ("half track,500,,", true),
        ("half track,612,,", false),
        ("half track,612.5,,", false),
        ("front track,1000,,", true),
        ("front track,1224,,", false),
    ] {
        assert_eq!(with(line), differs, "{line}");
    }
}

/// Points of the other axle do not make the import suggest another topology.
#[test]
fn the_other_axle_suggests_no_topology() {
    let links = [
        "upper front link",
        "upper rear link",
        "lower front link",
        "lower rear link",
        "toe link",
    ];
    let mut text = format!(
        "axle,name,x,y,z\n{}",
        rows(&FRONT, |name| format!("front,{name}"))
    );
    for (number, link) in links.iter().enumerate() {
        let x = -1500.0 - 10.0 * number as f64;
        text += &format!("rear,{link} inner,{x},300,150\nrear,{link} outer,{x},600,160\n");
    }
    text += "rear,wheel centre,-1520,620,200\n";
    let front = Said {
        axle: Some(AxlePosition::Front),
        ..Said::default()
    };
    let read = of("points.csv", &text, &front).unwrap();
    let said = format!("{:?} {:?}", read.notes, read.left_out);
    assert!(
        !said.contains("five_link") && !said.contains("toe link"),
        "{said}"
    );
    // If all these points belong to one axle, the import suggests the topology `five_link`.
    let one: String = text
        .lines()
        .filter(|line| !line.contains("tie rod") && *line != "rear,wheel centre,-1520,620,200")
        .map(|line| line.split_once(',').unwrap().1.to_owned() + "\n")
        .collect();
    let read = of("points.csv", &one, &Said::default());
    let read = read.unwrap();
    let said = read.notes.texts().collect::<Vec<_>>().join(" ");
    assert!(said.contains("--topology five_link"), "{said}");
}

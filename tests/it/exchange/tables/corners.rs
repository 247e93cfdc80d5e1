//! Tests of tables with several wheels: each wheel keeps its own points.

use super::{FRONT, REAR, has_points, of, rows};
use crate::exchange::Said;
use hardpoint::model::{AxlePosition, Side};

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

//! Tests of the half track, the wheel radius and the static angles of a table.

use super::{FRONT, has_points, of, rows};
use crate::exchange::{Said, at};

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

//! Tests of rockers and drop links in tables: rod ends on the correct bodies, and one point for each hardpoint.

use super::{FRONT, of, rows};
use crate::exchange::Said;

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

//! Tests of tables whose points contradict their axes, and of single wrong coordinates.

use super::{FRONT, has_points, of, rows};
use crate::exchange::Said;

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

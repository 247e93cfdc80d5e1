//! Tests of tables of axles and cars: solid axles, twist beams, and cars with four wheels.

use super::{Said, file, imported, study};
use crate::support;
use hardpoint::exchange::{Outgoing, csv, import_car, point_rows, read_points};
use hardpoint::model::{Frame, FrameConvention, LengthUnit, Side, Topology};
use hardpoint::study::Study;
use std::path::Path;

/// The import refuses two upper links together with a Panhard rod: these five links overconstrain a rigid axle. A
/// single upper link keeps its actual y, because it has no mirror image.
#[test]
fn five_links_of_a_solid_axle_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let text = crate::support::sample("solid_axle_five_links.toml");
    let five = Study::elastic_from_text("five", &text, Path::new(""));
    let five = five.unwrap_or_else(|errors| panic!("{}", errors.render(false)));
    let rows = point_rows(&Outgoing::of(&five, None, None));
    let table = String::from_utf8(csv(&rows)).unwrap();
    let read = |table: &str| {
        let path = file(&directory, "axle.csv", table.as_bytes());
        imported(&path, "solid_axle", &Said::default())
    };
    let refused = read(&table).unwrap_err();
    assert!(
        refused.contains("upper_link_chassis") && refused.contains("--with five_links"),
        "{refused}"
    );
    let without = |part: &str, side: &str| -> String {
        let is_dropped = |line: &&str| line.starts_with(part) && line.contains(side);
        let lines = table.lines().filter(|line| !is_dropped(line));
        lines.map(|line| format!("{line}\n")).collect()
    };
    for (table, is_single) in [
        (without("upper_link", "right"), true),
        (without("panhard", "iso8855"), false),
    ] {
        let study = read(&table).unwrap().study("s", "there").unwrap();
        assert_eq!(study.contains("single = [\"upper_link\"]"), is_single);
    }
}

/// Solid axles and a twist beam are exported to a table and imported again. The left half keeps its coordinates, in
/// every unit and in all axes. The import names points of a right half that differs.
#[test]
fn axles_of_one_body_come_back_from_tables() {
    let directory = tempfile::tempdir().unwrap();
    for (name, topology) in [
        ("solid_axle_solve.toml", "solid_axle"),
        ("solid_axle_rear.toml", "solid_axle"),
        ("twist_beam_solve.toml", "twist_beam"),
    ] {
        let own = Study::read(&support::studies().join(name), &[]).unwrap();
        let mechanism = &own.wheel().mechanism;
        for unit in LengthUnit::ALL {
            for convention in FrameConvention::ALL {
                let rows = point_rows(&Outgoing::of(&own, Some(unit), Some(convention)));
                let path = file(&directory, "points.csv", &csv(&rows));
                let back = imported(&path, topology, &Said::default()).unwrap();
                assert_eq!(back.left_out, Vec::<String>::new(), "{name}");
                assert_eq!((back.unit, back.frame), (unit, convention));
                let frame = Frame::new(convention, Side::Left);
                for hardpoint in &back.hardpoints {
                    let id = mechanism.point(hardpoint.name).unwrap();
                    let length = |x: f64| unit.convert_decimal(x, own.wheel().length_unit);
                    let wanted = frame
                        .vector(own.wheel().design[id.0].map(length))
                        .to_array();
                    assert_eq!(
                        hardpoint.position.map(|x| x + 0.0),
                        wanted.map(|x| x + 0.0),
                        "{name} {}",
                        hardpoint.name
                    );
                }
            }
        }
        let rows = point_rows(&Outgoing::of(&own, None, None));
        let path = file(&directory, "points.csv", &csv(&rows));
        let back = imported(&path, topology, &Said::default()).unwrap();
        let again = study(&back.study("back", "there").unwrap());
        assert_eq!(
            again.wheel().mechanism.points.len(),
            mechanism.points.len(),
            "{name}"
        );
        for (number, point) in mechanism.points.iter().enumerate() {
            let id = again.wheel().mechanism.point(&point.name).unwrap();
            let (found, wanted) = (again.wheel().design[id.0], own.wheel().design[number]);
            assert_eq!(found, wanted, "{name} {}", point.name);
        }
        let mut moved = String::from_utf8(csv(&rows)).unwrap();
        moved += "wheel_centre,0.0,-750.0,330.0,right,iso8855,\n";
        let path = file(&directory, "points.csv", moved.as_bytes());
        let back = imported(&path, topology, &Said::default()).unwrap();
        let right: Vec<_> = back
            .right_half
            .iter()
            .map(|h| (h.name, h.position))
            .collect();
        assert_eq!(right, [("wheel_centre", [0.0, -750.0, 330.0])]);
    }
}

/// If the halves differ, the table has one row for each side of each point. The import of this table gives the same
/// axle.
#[test]
fn axles_with_different_halves_come_back_from_tables() {
    let directory = tempfile::tempdir().unwrap();
    for (topology, name, place) in [
        ("twist_beam", "mount", [405.0, -520.0, 345.0]),
        ("solid_axle", "lower_link_chassis", [535.0, -425.0, 310.0]),
    ] {
        let text = hardpoint::cli::template(topology, &[]).unwrap();
        let own = study(&format!(
            "{text}\n[axle.right.hardpoints]\n{name} = {place:?}\n"
        ));
        let table = String::from_utf8(csv(&point_rows(&Outgoing::of(&own, None, None)))).unwrap();
        let right: Vec<&str> = table.lines().filter(|row| row.contains("right")).collect();
        let [x, y, z] = place;
        assert_eq!(right, [format!("{name},{x:?},{y:?},{z:?},right,iso8855,")]);
        let path = file(&directory, "points.csv", table.as_bytes());
        let back = imported(&path, topology, &Said::default()).unwrap();
        let again = study(&back.study("back", "there").unwrap());
        assert_eq!(again.wheel().design, own.wheel().design, "{topology}");
    }
    // A drag link has no mirror image, so such an axle always has two different halves.
    let steered = Study::read(&support::studies().join("off_road_car_front.toml"), &[]).unwrap();
    let rows = csv(&point_rows(&Outgoing::of(&steered, None, None)));
    let table = String::from_utf8(rows).unwrap();
    assert_eq!(table.matches("\nwheel_centre,").count(), 1, "{table}");
}

/// A table with both axles and a right wheel that is not the mirror image is imported as a car.
#[test]
fn a_table_with_four_corners_is_a_car() {
    let template = Topology::named("double_wishbone").unwrap().template;
    let own = study(template);
    let suspension = own.wheel();
    let mut table = "corner,name,x [mm],y [mm],z [mm]\n".to_owned();
    for (corner, sign, behind) in [
        ("FL", 1.0, 0.0),
        ("FR", -1.0, 0.0),
        ("RL", 1.0, 2500.0),
        ("RR", -1.0, 2500.0),
    ] {
        for (point, place) in suspension.mechanism.points.iter().zip(&suspension.design) {
            // The inner point of the tie rod at the right rear is 2 mm higher.
            let up = if corner == "RR" && point.name == "tie_rod_inner" {
                2.0
            } else {
                0.0
            };
            table += &format!(
                "{corner},{},{:?},{:?},{:?}\n",
                point.name,
                place.x - behind,
                sign * place.y,
                place.z + up
            );
        }
    }
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "points.csv", table.as_bytes());
    let read = read_points(&path, None, None).unwrap();
    assert!(read.has_two_axles());
    assert!(
        read.topology(None)
            .unwrap_err()
            .to_string()
            .contains("--topology")
    );
    let said = Said {
        radius: Some(300.0),
        ..Said::default()
    };
    let options = said.options(Topology::named("double_wishbone").unwrap());
    let car = import_car(&read, [&options, &options], "points.csv").unwrap();
    assert!(
        car.files[1].contains("right = \"mirrored\""),
        "{}",
        car.files[1]
    );
    assert!(
        !car.files[2].contains("right = \"mirrored\""),
        "{}",
        car.files[2]
    );
    let rear = study(&car.files[2]);
    let right = rear.axle().unwrap().axle.right.as_ref().unwrap();
    let id = right.mechanism.point("tie_rod_inner").unwrap();
    let left = rear.wheel().design[id.0];
    assert_eq!(right.design[id.0].z - left.z, 2.0);
    assert!(
        car.files[0].contains("rear_offset = [0.0, 0.0, 0.0]"),
        "{}",
        car.files[0]
    );
}

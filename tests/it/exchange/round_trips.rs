//! Tests of round trips: study to CSV, XLSX or Adams, and back to a study.

use super::{Said, file, imported};
use hardpoint::exchange::{Outgoing, Page, csv, into_subsystem, point_rows, subsystem, workbook};
use hardpoint::model::{Axis, Frame, FrameConvention, LengthUnit, Side, Topology};
use hardpoint::study::Study;
use std::path::Path;

/// Templates, and samples with rockers and bars. Each study is present in every axis convention, on both sides and in
/// every unit, with all digits of the coordinates.
pub(super) fn studies() -> Vec<Study> {
    let mut texts: Vec<String> = Topology::ALL
        .iter()
        // Files of other programs describe one wheel, so these tests skip solid axles and twist beams.
        .filter(|t| !t.carries_both_wheels())
        .map(|t| t.template.to_owned())
        .collect();
    let samples = crate::support::studies();
    let read = |name: &str| std::fs::read_to_string(samples.join(name)).unwrap();
    texts.push(read("double_wishbone_pushrod.toml"));
    texts.push(by_angles(&texts[0]));
    let mut studies = Vec::new();
    for text in &texts {
        let study = Study::from_text("s.toml", text, Path::new(".")).unwrap();
        for unit in LengthUnit::ALL {
            for convention in FrameConvention::ALL {
                for side in Side::ALL {
                    studies.push(changed(&study, unit, convention, side));
                }
            }
        }
    }
    studies
}

/// Template whose spin axis is given by angles instead of a point.
fn by_angles(template: &str) -> String {
    template
        .replace("spindle_inner    =", "# spindle_inner =")
        .replace("# static_camber =", "static_camber =")
        .replace("# static_toe =", "static_toe =")
}

/// Same wheel as in a study with another unit and other axes.
pub(super) fn changed(
    study: &Study,
    unit: LengthUnit,
    convention: FrameConvention,
    side: Side,
) -> Study {
    let scale = unit.per_metre() / study.wheel().length_unit.per_metre();
    let mut changed = study.clone();
    let number = |(n, point): (usize, &hardpoint::number::Vector3<f64>)| {
        *point * (scale * (1.0 + 1e-3 * (n as f64).sin()))
    };
    changed.wheel_mut().design = study
        .wheel()
        .design
        .iter()
        .enumerate()
        .map(number)
        .collect();
    let length = |length: f64| unit.convert(length, study.wheel().length_unit);
    changed.wheel_mut().wheel_radius = study.wheel().wheel_radius.map(length);
    changed.wheel_mut().length_unit = unit;
    changed.wheel_mut().frame = Frame::new(convention, side);
    changed
}

/// Every hardpoint with its coordinates in the axes of the study, which `frame` gives.
fn written(study: &Study, frame: Frame) -> Vec<(String, [f64; 3])> {
    let points = study.wheel().mechanism.points.iter();
    let points = points.zip(&study.wheel().design);
    points
        .map(|(point, design)| {
            (
                point.name.clone(),
                frame.vector(*design).to_array().map(|x| x + 0.0),
            )
        })
        .collect()
}

fn check(study: &Study, path: &Path, said: &Said, frame: Frame) {
    let suspension = study.wheel();
    let back = imported(path, suspension.mechanism.topology.name, said).unwrap();
    let expected = written(study, frame);
    assert_eq!(back.hardpoints.len(), expected.len(), "{:?}", back.notes);
    for (name, position) in expected {
        let found = back.hardpoints.iter().find(|h| h.name == name).unwrap();
        assert_eq!(found.position.map(|x| x + 0.0), position, "{name}");
    }
    assert_eq!(back.unit, suspension.length_unit);
    assert_eq!((back.frame, back.side), frame.meaning());
    // The study that the import writes describes the same wheel. To save time, the test checks this only for studies in
    // metres with a left wheel.
    if suspension.length_unit != LengthUnit::Metre || back.side != Side::Left {
        return;
    }
    let text = back.study("back", "there").unwrap();
    let again = Study::from_text("back.toml", &text, Path::new(".")).unwrap();
    assert_eq!(again.wheel().design, suspension.design);
    assert_eq!(
        again.wheel().mechanism.spin_axis,
        suspension.mechanism.spin_axis
    );
}

#[test]
fn tables_and_workbooks_give_the_same_study() {
    let directory = tempfile::tempdir().unwrap();
    for study in studies() {
        let rows = point_rows(&Outgoing::of(&study, None, None));
        let table = file(&directory, "points.csv", &csv(&rows));
        check(&study, &table, &Said::default(), study.wheel().frame);
        let name = "hardpoints".to_owned();
        let book = file(&directory, "points.xlsx", &workbook(&[Page { name, rows }]));
        check(&study, &book, &Said::default(), study.wheel().frame);
        // The import uses every row of the program's own export.
        let radius = study.wheel().wheel_radius.is_some();
        let back = imported(
            &book,
            study.wheel().mechanism.topology.name,
            &Said::default(),
        );
        let back = back.unwrap();
        assert_eq!(back.left_out, Vec::<String>::new());
        assert_eq!(back.wheel_radius.is_some(), radius);
        // The import also reads which bodies carry the rods.
        if study.wheel().length_unit != LengthUnit::Metre {
            continue;
        }
        let back = imported(
            &book,
            study.wheel().mechanism.topology.name,
            &Said::default(),
        );
        let text = back.unwrap().study("back", "there").unwrap();
        let again = Study::from_text("back.toml", &text, Path::new(".")).unwrap();
        let bodies = |study: &Study| {
            let points = study.wheel().mechanism.points.iter();
            points.map(|point| point.body).collect::<Vec<_>>()
        };
        assert_eq!(bodies(&again), bodies(&study));
    }
}

/// Any study can be exported in any other unit and axes. The file has the converted lengths. The import reads back
/// exactly these lengths, with no rounding error. This holds for tables, workbooks and subsystems.
#[test]
fn every_unit_and_frame_goes_out_and_comes_back() {
    let directory = tempfile::tempdir().unwrap();
    let spread = studies().into_iter().step_by(5);
    for study in spread {
        let suspension = study.wheel();
        let (_, side) = suspension.frame.meaning();
        for unit in LengthUnit::ALL {
            for convention in FrameConvention::ALL {
                let outgoing = Outgoing::of(&study, Some(unit), Some(convention));
                let rows = point_rows(&outgoing);
                let name = "hardpoints".to_owned();
                let files = [
                    ("points.csv", csv(&rows), convention),
                    ("points.xlsx", workbook(&[Page { name, rows }]), convention),
                    (
                        "new.sub",
                        subsystem(&outgoing).bytes,
                        FrameConvention::XRear,
                    ),
                ];
                for (name, bytes, convention) in files {
                    let path = file(&directory, name, &bytes);
                    let said = Said {
                        side: Some(side),
                        ..Said::default()
                    };
                    let topology = suspension.mechanism.topology.name;
                    let back = imported(&path, topology, &said).unwrap();
                    let left_over = back
                        .notes
                        .texts()
                        .find(|note| note.contains("unused points"));
                    assert_eq!(left_over, None, "{name}");
                    assert_eq!((back.unit, back.frame, back.side), (unit, convention, side));
                    let frame = Frame::new(convention, side);
                    for (name, position) in written(&study, frame) {
                        let found = back.hardpoints.iter().find(|h| h.name == name).unwrap();
                        let converted =
                            position.map(|x| unit.convert_decimal(x, suspension.length_unit));
                        assert_eq!(found.position.map(|x| x + 0.0), converted, "{name}");
                    }
                    if name != "new.sub" {
                        let radius = suspension.wheel_radius;
                        let radius =
                            radius.map(|r| unit.convert_decimal(r, suspension.length_unit));
                        assert_eq!(back.wheel_radius, radius);
                    }
                }
                // Inserts the points into a file with another unit.
                for of_file in LengthUnit::ALL {
                    let other = subsystem(&Outgoing::of(&study, Some(of_file), None)).bytes;
                    let into = into_subsystem(&outgoing, &other).unwrap().bytes;
                    let files = [("into.sub", into), ("other.sub", other)];
                    let [table, other] = files.map(|(name, bytes)| {
                        let path = file(&directory, name, &bytes);
                        let said = Said {
                            side: Some(side),
                            ..Said::default()
                        };
                        imported(&path, suspension.mechanism.topology.name, &said).unwrap()
                    });
                    assert_eq!(table.unit, of_file);
                    for (found, expected) in table.hardpoints.iter().zip(&other.hardpoints) {
                        let (found, expected) = (found.position, expected.position);
                        for (a, b) in found.iter().zip(expected) {
                            assert!((a - b).abs() <= 4e-16 * b.abs(), "{a} {b}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn subsystems_give_the_same_study() {
    let directory = tempfile::tempdir().unwrap();
    for study in studies() {
        let suspension = study.wheel();
        let (_, side) = suspension.frame.meaning();
        let said = Said {
            side: Some(side),
            ..Said::default()
        };
        let new = subsystem(&Outgoing::of(&study, None, None)).bytes;
        let frame = Frame::new(FrameConvention::XRear, side);
        check(&study, &file(&directory, "new.sub", &new), &said, frame);
        // Inserts the points into the subsystem file of another design. This replaces all coordinates of that file.
        let moved = study.at_design(suspension.design.iter().map(|p| *p * 1.25).collect());
        let other = subsystem(&Outgoing::of(&moved, None, None)).bytes;
        let into = into_subsystem(&Outgoing::of(&study, None, None), &other).unwrap();
        check(
            &study,
            &file(&directory, "into.sub", &into.bytes),
            &said,
            frame,
        );
    }
}

/// The notes of `--into` list rows without a hardpoint, and static angles that differ from those of the study.
#[test]
fn unchanged_parts_of_a_subsystem_are_listed() {
    let template = by_angles(Topology::named("double_wishbone").unwrap().template);
    let study = Study::from_text("s.toml", &template, Path::new(".")).unwrap();
    let outgoing = Outgoing::of(&study, None, None);
    let own = String::from_utf8(subsystem(&outgoing).bytes).unwrap();
    let notes = |file: &str| into_subsystem(&outgoing, file.as_bytes()).unwrap().notes;
    assert_eq!(notes(&own).len(), 1, "{:?}", notes(&own));
    let row = " 'subframe_front'  'left/right'  1.0  2.0  3.0\n";
    let other = own.replacen(" 'lca_front", &format!("{row} 'lca_front"), 1);
    let [camber, _] = outgoing.static_angles(Side::Left);
    let (head, parameters) = other.split_once("[PARAMETER]").unwrap();
    let parameters = parameters.replacen(&format!(" {camber:?}\n"), " 0.75\n", 1);
    let found = notes(&format!("{head}[PARAMETER]{parameters}")).join("\n");
    assert!(
        found.contains("without a hardpoint in the study, unchanged: subframe_front"),
        "{found}"
    );
    let differs = format!(
        "the export does not change camber_angle: 0.75 deg in the file, {camber:?} deg in the study"
    );
    assert!(
        found.contains(&differs) && !found.contains("toe_angle"),
        "{found}"
    );
}

/// The import reads a subsystem file that has only the points of the right wheel, in inches. It can also return the
/// left wheel, as the mirror image.
#[test]
fn the_wheels_of_a_subsystem_are_told_apart() {
    let directory = tempfile::tempdir().unwrap();
    let template = Topology::named("macpherson").unwrap().template;
    let study = Study::from_text("s.toml", template, Path::new(".")).unwrap();
    let study = changed(
        &study,
        LengthUnit::Inch,
        FrameConvention::XRear,
        Side::Right,
    );
    let both = String::from_utf8(subsystem(&Outgoing::of(&study, None, None)).bytes).unwrap();
    let right = |line: &str| {
        let right = line.replace("'left/right'", "'right     '");
        // In the axes of this file, y is negative on the left side and positive on the right side.
        let mut fields: Vec<String> = right.split_whitespace().map(str::to_owned).collect();
        let y = fields.len() - 2;
        fields[y] = fields[y].trim_start_matches('-').to_owned();
        fields.join(" ")
    };
    let mut rows = false;
    let only_right: String = both
        .lines()
        .map(|line| {
            rows = (rows || line == "[HARDPOINT]") && !line.starts_with("$");
            if rows && line.starts_with(" '") {
                right(line) + "\n"
            } else {
                line.to_owned() + "\n"
            }
        })
        .collect();
    let path = file(&directory, "right.sub", only_right.as_bytes());
    let frame = Frame::new(FrameConvention::XRear, Side::Right);
    check(&study, &path, &Said::default(), frame);
    assert_eq!(frame.sign(Axis::Y), 1.0);
    // If the user asks for the left wheel, the import mirrors the points of the right wheel and reports this.
    let said = Said {
        side: Some(Side::Left),
        ..Said::default()
    };
    let left = imported(&path, "macpherson", &said).unwrap();
    assert_eq!(left.side, Side::Left);
    assert!(
        left.notes
            .texts()
            .any(|note| note.contains("wheel and mirrored: "))
    );
}

/// Each wheel of an axle keeps its angles through export and import.
#[test]
fn wheels_with_different_angles_come_back_with_their_own() {
    let directory = tempfile::tempdir().unwrap();
    let template = Topology::named("double_wishbone").unwrap().template;
    let text = by_angles(template).replace("static_camber = -0.5", "static_camber = -1.0");
    let text = format!("{text}\n[axle.right.wheel]\nstatic_camber = -1.7\nstatic_toe = -0.1\n")
        .replace("\ntravel = {", "\nheave = {");
    let study = Study::from_text("s.toml", &text, Path::new(".")).unwrap();
    let outgoing = Outgoing::of(&study, None, None);
    let rows = point_rows(&outgoing);
    let page = Page {
        name: "hardpoints".to_owned(),
        rows: rows.clone(),
    };
    let files = [
        file(&directory, "axle.sub", &subsystem(&outgoing).bytes),
        file(&directory, "axle.csv", &csv(&rows)),
        file(&directory, "axle.xlsx", &workbook(&[page])),
    ];
    for path in files {
        for (side, angles) in [(Side::Left, [-1.0, 0.1]), (Side::Right, [-1.7, -0.1])] {
            let said = Said {
                side: Some(side),
                ..Said::default()
            };
            let back = imported(&path, "double_wishbone", &said).unwrap();
            let found = [back.static_camber, back.static_toe].map(Option::unwrap);
            let off = [0, 1].map(|k| (found[k] - angles[k]).abs());
            assert!(
                off.iter().all(|off| *off < 1e-13),
                "{path:?} {side:?} {found:?}"
            );
        }
    }
}

//! Test of round trips with every sample study: to tables and Adams, and back.

use super::{Said, file, imported};
use hardpoint::exchange::{Outgoing, Page, csv, point_rows, subsystem, workbook};
use hardpoint::model::FrameConvention;
use hardpoint::study::{CarStudy, Study};

/// The points of every sample come back from a table, a workbook and a subsystem with the same digits. Other tests check the
/// formats that contain derived numbers: OptimumKinematics and Assetto Corsa.
#[test]
fn every_sample_comes_back_with_the_same_digits() {
    let directory = tempfile::tempdir().unwrap();
    let samples = crate::support::studies();
    let mut count = 0;
    for entry in std::fs::read_dir(samples).unwrap() {
        let path = entry.unwrap().path();
        let is_study = path
            .extension()
            .is_some_and(|extension| extension == "toml");
        // The study of a car has no points. The import refuses five links of a solid axle; another test checks this.
        if !is_study || CarStudy::is_at(&path) || path.ends_with("solid_axle_five_links.toml") {
            continue;
        }
        let study = Study::read_elastic(&path, &[]);
        let study = study.unwrap_or_else(|errors| panic!("{}", errors.render(false)));
        let topology = study.wheel().mechanism.topology;
        let outgoing = Outgoing::of(&study, None, None);
        let rows = point_rows(&outgoing);
        let own = outgoing.convention;
        let page = Page {
            name: "hardpoints".to_owned(),
            rows: rows.clone(),
        };
        let mut files = vec![
            ("points.csv", csv(&rows), own),
            ("points.xlsx", workbook(&[page]), own),
        ];
        // The export refuses subsystems of solid axles and twist beams.
        if !topology.carries_both_wheels() {
            let bytes = subsystem(&outgoing).bytes;
            files.push(("points.sub", bytes, FrameConvention::XRear));
        }
        for (name, bytes, convention) in files {
            let place = format!("{} as {name}", path.display());
            let written = outgoing.in_convention(convention);
            let table = file(&directory, name, &bytes);
            for side in outgoing.different_wheels() {
                let said = Said {
                    side: Some(side),
                    ..Said::default()
                };
                let back = imported(&table, topology.name, &said);
                let back = back.unwrap_or_else(|reason| panic!("{place}: {reason}"));
                assert_eq!(
                    (back.unit, back.frame),
                    (outgoing.unit, convention),
                    "{place}"
                );
                for hardpoint in &back.hardpoints {
                    let mut points = written.points(side);
                    let (_, _, wanted) = points.find(|(name, ..)| *name == hardpoint.name).unwrap();
                    let found = hardpoint.position.map(|x| x + 0.0);
                    assert_eq!(
                        found,
                        wanted.map(|x| x + 0.0),
                        "{place}: {}",
                        hardpoint.name
                    );
                    count += 1;
                }
                if !topology.carries_both_wheels() {
                    let named = written.points(side);
                    let named = named.filter(|(name, ..)| topology.hardpoint(name).is_some());
                    assert_eq!(back.hardpoints.len(), named.count(), "{place}");
                }
            }
        }
    }
    assert!(count > 800, "{count}");
}

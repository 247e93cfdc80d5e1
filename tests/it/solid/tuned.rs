//! Tests that a tuned axle equals the axle that its written study describes.

use assert_cmd::Command;
use hardpoint::axle::{AxleSolver, Placement};
use hardpoint::characteristics::Measure;
use hardpoint::optimise::{TargetLayout, assessed_at};
use hardpoint::study::Study;
use std::path::Path;

/// Solid axles and a twist beam, each with a tuning. The axles have mirrored halves only, a part that exists once, or
/// steering.
const AXLES: [(&str, &str); 5] = [
    ("solid_axle", "optimise"),
    ("solid_axle", "panhard,optimise"),
    ("solid_axle", "watt,optimise"),
    ("solid_axle", "panhard,drag_link,optimise"),
    ("twist_beam", "optimise"),
];

fn new(topology: &str, with: &str) -> String {
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    command.args(["new", topology, "--with", with]);
    let output = command.assert().success().get_output().stdout.clone();
    String::from_utf8(output).unwrap()
}

/// The tuning moves points of the left half. Afterwards all points of both halves, in the frames of both wheels, equal
/// those of the written study.
#[test]
fn both_halves_of_a_moved_axle_are_those_of_its_text() {
    for (topology, with) in AXLES {
        let read = |text: &str| {
            let study = Study::from_text("tuned.toml", text, Path::new(""));
            study.unwrap_or_else(|errors| panic!("{topology} with {with}: {errors}\n{text}"))
        };
        let study = read(&new(topology, with));
        let optimise = study.optimise.as_ref().unwrap();
        let offsets: Vec<f64> = (1..=optimise.variables.len())
            .map(|k| 1.5 + k as f64)
            .collect();
        let moved = study.moved(&offsets);
        let written = read(&study.with_points_of(&moved));
        let designs = |study: &Study| {
            let axle = &study.axle().unwrap().axle;
            let right = axle.right.as_ref().map(|wheel| wheel.design.clone());
            (axle.left.design.clone(), right)
        };
        assert_ne!(
            designs(&moved).0,
            designs(&study).0,
            "{topology} with {with}"
        );
        assert_eq!(designs(&moved), designs(&written), "{topology} with {with}");
    }
}

/// A Panhard rod does not count as a difference between the halves. The summary mentions hardpoints of the right half
/// only if the study gives some of them.
#[test]
fn only_own_points_are_called_own() {
    let text = new("solid_axle", "panhard");
    let own = text.replace(
        "# [axle.right.hardpoints]",
        "[axle.right.hardpoints]\nlower_link_axle = [5.0, -531.0, 255.0] #",
    );
    for (text, words) in [(text, "mirrored"), (own, "own hardpoints on the right")] {
        let study = Study::from_text("new.toml", &text, Path::new("")).unwrap();
        let summary = hardpoint::solved::Solved::of(&study)
            .unwrap()
            .summary()
            .unwrap();
        assert!(summary.headline().contains(words), "{}", summary.headline());
    }
}

/// Limits of quantities apply to the axle, not to one wheel: in the moved design, the margins follow from the values that
/// an axle solver finds for the written study. The slopes are those of the margins.
#[test]
fn limits_of_quantities_are_those_of_the_axle() {
    let limits = |topology: &str| {
        let first = if topology == "twist_beam" {
            "roll_steer"
        } else {
            "roll_centre_height"
        };
        format!(
            "optimise.constraints=[{{ characteristic = \"{first}\", at_most = 480.0, at = \"design\" }}, \
             {{ characteristic = \"anti_lift\", between = [-500.0, 500.0] }}]"
        )
    };
    let directory = tempfile::tempdir().unwrap();
    for (topology, with) in AXLES {
        let read = |text: &str| {
            let path = directory.path().join("axle.toml");
            std::fs::write(&path, text).unwrap();
            Study::read(&path, &[limits(topology)]).unwrap_or_else(|e| panic!("{e}"))
        };
        let study = read(&new(topology, with));
        let optimise = study.optimise.as_ref().unwrap();
        let layout = TargetLayout::of(optimise, &study.vehicle);
        let offsets: Vec<f64> = (1..=optimise.variables.len())
            .map(|k| 1.5 + k as f64)
            .collect();
        let at = |offsets: &[f64]| {
            let variables = &optimise.variables;
            let found = assessed_at(study.wheel(), variables, &layout, offsets);
            found.unwrap().unwrap().rows
        };
        let moved = study.moved(&offsets);
        let written = read(&study.with_points_of(&moved));
        let axle = &written.axle().unwrap().axle;
        let rows = at(&offsets);
        for (row, label) in layout.labels().iter().enumerate() {
            let constraint = &optimise.constraints[label.constraint];
            let name = constraint.name.split(' ').next().unwrap();
            let Measure::OfAxle(quantity) = constraint.parts[0].of else {
                panic!("{name} of one wheel");
            };
            assert_eq!(quantity.name(), name);
            let mut solver = AxleSolver::<4>::new(axle, &[quantity], false).unwrap();
            let placed = solver.place(&Placement::Roll {
                heave: 0.0,
                roll: 0.0,
                rack: 0.0,
            });
            let found = solver
                .read(&placed.unwrap())
                .unwrap()
                .value(quantity)
                .unwrap();
            let part = &constraint.parts[0];
            let wanted = if label.is_upper {
                found - part.upper.unwrap()
            } else {
                part.lower.unwrap() - found
            };
            let wanted = wanted / part.scale;
            let off = (rows.residuals[row] - wanted).abs();
            assert!(
                off < 1e-9 * (1.0 + wanted.abs()),
                "{topology} with {with}, {name}: {off}"
            );
            for variable in 0..offsets.len() {
                let beside = |step: f64| {
                    let mut offsets = offsets.clone();
                    offsets[variable] += step;
                    at(&offsets).residuals[row]
                };
                let difference = |h: f64| (beside(h) - beside(-h)) / (2.0 * h);
                let slope = (4.0 * difference(0.05) - difference(0.1)) / 3.0;
                let exact = rows.jacobian[(row, variable)];
                assert!(
                    (exact - slope).abs() < 1e-6 * (1.0 + exact.abs()),
                    "{topology} with {with}, {name}, variable {variable}: {exact} {slope}"
                );
            }
        }
        assert_eq!(layout.labels().len(), 3);
    }
}

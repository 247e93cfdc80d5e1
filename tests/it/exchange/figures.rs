//! Lengths beside the hardpoints: each figure in each unit, of a file in each unit.

use super::parsers::{of_text, template};
use super::round_trips::changed;
use super::{Said, file, imported};
use hardpoint::exchange::{Outgoing, csv, point_rows};
use hardpoint::model::{FrameConvention, LengthUnit, Side};
use hardpoint::study::Study;
use std::path::Path;

/// Twelve inches and multiples of it, in each unit by definition: an inch is 25.4 mm.
fn feet(feet: f64, unit: LengthUnit) -> f64 {
    feet * match unit {
        LengthUnit::Millimetre => 304.8,
        LengthUnit::Metre => 0.3048,
        LengthUnit::Inch => 12.0,
    }
}

/// A radius of one foot, a track of five and a wheelbase of nine are these in the study, whichever unit the hardpoints have and
/// whichever the figure's own name says. A figure without a unit has that of the hardpoints.
#[test]
fn figures_are_converted_between_all_units() {
    let directory = tempfile::tempdir().unwrap();
    let study = of_text(template("double_wishbone"));
    for own in LengthUnit::ALL {
        let study = changed(&study, own, FrameConvention::Iso8855, Side::Left);
        let mut rows = csv(&point_rows(&Outgoing::of(&study, None, None)));
        let text = String::from_utf8(std::mem::take(&mut rows)).unwrap();
        let points: Vec<&str> = text
            .lines()
            .filter(|line| !line.starts_with("wheel_radius"))
            .collect();
        let points = points.join("\n");
        for of_figure in LengthUnit::ALL.into_iter().map(Some).chain([None]) {
            let unit = of_figure.unwrap_or(own);
            let suffix = of_figure.map_or(String::new(), |unit| format!("_{}", unit.symbol()));
            let figures = [("wheel_radius", 1.0), ("track", 5.0), ("wheelbase", 9.0)];
            let figures =
                figures.map(|(name, length)| format!("{name}{suffix},{:?}\n", feet(length, unit)));
            let text = format!("{points}\n{}", figures.concat());
            let path = file(&directory, "points.csv", text.as_bytes());
            let back = imported(&path, "double_wishbone", &Said::default()).unwrap();
            assert_eq!(back.unit, own);
            let found = [back.wheel_radius, back.track, back.wheelbase];
            for (found, length) in found.into_iter().zip([1.0, 5.0, 9.0]) {
                let (found, expected) = (found.expect("given"), feet(length, own));
                assert!(
                    (found - expected).abs() <= 1e-15 * 4.0 * expected,
                    "{own:?} {of_figure:?}: {found}, not {expected}"
                );
            }
            // A tyre's diameter is two radii.
            let diameter = format!("{points}\ntyre_diameter{suffix},{:?}\n", feet(2.0, unit));
            let path = file(&directory, "diameter.csv", diameter.as_bytes());
            let back = imported(&path, "double_wishbone", &Said::default()).unwrap();
            let expected = feet(1.0, own);
            assert!((back.wheel_radius.expect("given") - expected).abs() <= 4e-15 * expected);
        }
    }
}

/// An imported wheel moves as far in each unit: the travels of its study are one length, in inches to a tenth.
#[test]
fn imported_studies_travel_as_far_in_each_unit() {
    let directory = tempfile::tempdir().unwrap();
    let study = of_text(template("macpherson"));
    let travel = LengthUnit::ALL.map(|unit| {
        let study = changed(&study, unit, FrameConvention::Iso8855, Side::Left);
        let rows = csv(&point_rows(&Outgoing::of(&study, None, None)));
        let path = file(&directory, "points.csv", &rows);
        let back = imported(&path, "macpherson", &Said::default()).unwrap();
        let text = back.study("back", "there").unwrap();
        let again = Study::from_text("back.toml", &text, Path::new(".")).unwrap();
        assert_eq!(again.suspension.length_unit, unit);
        let values = &again.motion.values;
        let [first, last] = [values[0], values[values.len() - 1]];
        assert!((first + last).abs() <= 1e-12 * last);
        last / feet(1.0, unit) * 304.8
    });
    let [millimetres, metres, inches] = travel;
    assert!((10.0..=80.0).contains(&millimetres), "{millimetres}");
    assert!((metres - millimetres).abs() < 1e-9, "{metres}");
    assert!((0.0..2.54).contains(&(millimetres - inches)), "{inches}");
}

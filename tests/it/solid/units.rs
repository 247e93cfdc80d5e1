//! Tests of units: an axle in inches, pounds-force and pounds has the same results as the same axle in millimetres and
//! newtons.

use super::{case, points_of, study_of, text};
use crate::units::{INCH, POUND, POUND_FORCE, in_inches_and_pounds};
use hardpoint::axle::axle_curves;
use hardpoint::study::Study;
use std::path::Path;

const OUTPUTS: &str = "[outputs]\ncharacteristics = [\"wheel_load\", \"wheel_rate\", \"roll_stiffness\", \"ride_frequency\", \"roll_moment\", \
     \"spring_force\", \"anti_squat\"]\nloads = [{ name = \"side\", at = \"contact_point\", force = [0.0, LOAD, 0.0] }]\n\
     [motion]\nheave = [-10.0, 0.0, 10.0]\n";

/// Springs, masses, loads and motion, with these numbers.
fn further([rate, force, mass, load]: [f64; 4], heave: &str) -> String {
    let outputs = OUTPUTS
        .replace("LOAD", &format!("{load:?}"))
        .replace("-10.0, 0.0, 10.0", heave);
    format!("[spring]\nrate = {rate:?}\nforce = {force:?}\n{outputs}") + &format!("#MASS {mass:?}")
}

fn with_mass(text: String) -> String {
    let (text, mass) = text.split_once("#MASS ").unwrap();
    text.replace("[vehicle]\n", &format!("[vehicle]\nsprung_mass = {mass}\n"))
}

fn curves(text: &str) -> Vec<(String, Vec<Option<f64>>)> {
    let study = Study::from_text("units.toml", text, Path::new(""));
    let study = study.unwrap_or_else(|errors| panic!("{errors}\n{text}"));
    let both = study.axle().unwrap();
    let found = axle_curves(&both.axle, &both.plan).unwrap().curves;
    assert!(found.are_complete());
    let columns = found.columns.iter().enumerate();
    columns
        .map(|(k, column)| {
            let values = found.stations.iter().map(|station| station.values[k].ok());
            (column.name.clone(), values.collect())
        })
        .collect()
}

/// A file in inches and pounds gives the same axle as a file in millimetres and newtons: after conversion of units, all
/// columns are equal.
#[test]
fn inches_and_pounds_give_the_same_axle() {
    let case = case("solid_four_link");
    let metric = study_of(
        &case,
        &further([32.0, 4200.0, 600.0, 1000.0], "-10.0, 0.0, 10.0"),
    );
    let at = |name: &str| [0, 1, 2].map(|i| case["points"][name][i].as_f64().unwrap() / INCH);
    let points: Vec<_> = points_of(&case)
        .into_iter()
        .map(|(ours, theirs)| (ours, at(theirs)))
        .collect();
    let spring = [
        32.0 * INCH / POUND_FORCE,
        4200.0 / POUND_FORCE,
        600.0 / POUND,
        1000.0 / POUND_FORCE,
    ];
    let heave = format!("{:?}, 0.0, {:?}", -10.0 / INCH, 10.0 / INCH);
    let imperial = text(&points, false, &further(spring, &heave))
        .replace(
            "[suspension]\n",
            "[suspension]\nlength_unit = \"in\"\nforce_unit = \"lbf\"\nmass_unit = \"lb\"\n",
        )
        .replace("radius = 330.0", &format!("radius = {:?}", 330.0 / INCH))
        .replace(
            "wheelbase = 2700.0",
            &format!("wheelbase = {:?}", 2700.0 / INCH),
        )
        .replace(
            "cg_height = 620.0",
            &format!("cg_height = {:?}", 620.0 / INCH),
        );
    let (metric, imperial) = (curves(&with_mass(metric)), curves(&with_mass(imperial)));
    assert_eq!(metric.len(), imperial.len());
    let (mut forces, mut rates) = (0, 0);
    for ((name, values), (other, found)) in metric.iter().zip(&imperial) {
        let (expected_name, factor) = in_inches_and_pounds(name);
        assert_eq!(*other, expected_name);
        forces += usize::from(other.ends_with("_lbf"));
        rates += usize::from(other.ends_with("_lbf_per_in"));
        for (value, found) in values.iter().zip(found) {
            let (expected, found) = (value.unwrap() * factor, found.unwrap());
            assert!(
                (found - expected).abs() < 1e-9 * (1.0 + expected.abs()),
                "{other}: {found} {expected}"
            );
        }
    }
    assert!(forces > 8 && rates >= 2, "{forces} {rates}");
}

/// The program refuses pounds-force without inches, and unknown units of force and mass.
#[test]
fn pounds_need_inches_and_known_units() {
    let metric = study_of(&case("solid_four_link"), super::STILL);
    let with = |keys: &str| metric.replace("[suspension]\n", &format!("[suspension]\n{keys}\n"));
    for (keys, reason) in [
        ("force_unit = \"lbf\"", "length_unit = \"in\""),
        ("force_unit = \"kp\"", "force unit"),
        ("mass_unit = \"stone\"", "mass unit"),
    ] {
        let errors = Study::from_text("units.toml", &with(keys), Path::new("")).unwrap_err();
        assert!(errors.to_string().contains(reason), "{keys}: {errors}");
    }
}

//! Tests of units: a car in inches, pounds-force and pounds has the same results as the same car in millimetres,
//! newtons and kilograms.

use super::commands::{hardpoint, text};
use crate::support::{one_line, studies};
use crate::units::{INCH, POUND, POUND_FORCE, in_inches_and_pounds};
use hardpoint::car::{CarQuantity, CarSolver};
use hardpoint::study::{CarStudy, Study};
use std::fs;
use std::path::Path;
use toml::{Table, Value};

fn scaled(value: &mut Value, factor: f64) {
    match value {
        Value::Float(number) => *number *= factor,
        Value::Integer(number) => *value = Value::Float(*number as f64 * factor),
        Value::Array(list) => list.iter_mut().for_each(|entry| scaled(entry, factor)),
        _ => panic!("{value}"),
    }
}

/// Converts every number of a section that has a unit. `of` is the name of the section.
fn convert(section: &mut Table, of: &str) {
    for (key, value) in section.iter_mut() {
        match (of, key.as_str()) {
            ("hardpoints", _)
            | (
                _,
                "c_factor"
                | "radius"
                | "gap"
                | "wheelbase"
                | "sprung_cg"
                | "rack"
                | "ride_height_point_front"
                | "ride_height_point_rear",
            ) => scaled(value, 1.0 / INCH),
            (_, "force" | "load") => scaled(value, 1.0 / POUND_FORCE),
            ("anti_roll_bar", "rate") => scaled(value, 1.0 / (INCH * POUND_FORCE)),
            ("spring" | "tyre", "rate") => scaled(value, INCH / POUND_FORCE),
            (_, "sprung_mass" | "unsprung_mass") => scaled(value, 1.0 / POUND),
            (_, "force_curve") => {
                for row in value.as_array_mut().unwrap() {
                    let row = row.as_array_mut().unwrap();
                    scaled(&mut row[0], 1.0 / INCH);
                    scaled(&mut row[1], 1.0 / POUND_FORCE);
                }
            }
            (_, name) => match value {
                Value::Table(inner) => convert(inner, name),
                Value::Array(list) => {
                    let tables = list.iter_mut().filter_map(Value::as_table_mut);
                    tables.for_each(|inner| convert(inner, name));
                }
                _ => {}
            },
        }
    }
}

fn sample(name: &str) -> Table {
    fs::read_to_string(studies().join(name))
        .unwrap()
        .parse()
        .unwrap()
}

/// Texts of three studies: `studies/car.toml` without aerodynamics, and its two axles. Rates of both axles are the
/// tuning variables.
fn texts(is_imperial: bool) -> [String; 3] {
    let mut car = sample("car.toml");
    for section in ["gg_map", "sweep", "tolerance"] {
        car.remove(section);
    }
    car["car"].as_table_mut().unwrap().remove("aero");
    let mut axles = ["car_front.toml", "car_rear.toml"].map(sample);
    let tuning = |bar: f64, spring: f64| {
        format!(
            "[optimise]\nvariables = [\n  {{ axle = \"front\", rate = \"anti_roll_bar\", range = [{:?}, {:?}] }},\n  \
             {{ axle = \"rear\", rate = \"spring\", range = [{:?}, {:?}] }},\n]\ntargets = [\n  \
             {{ characteristic = \"lateral_load_transfer_distribution\", case = \"turn\", value = 48.0, tolerance = 0.5 }},\n  \
             {{ characteristic = \"roll_gradient\", case = \"turn\", value = 3.2, tolerance = 0.05 }},\n]\n",
            3e5 * bar,
            1.5e6 * bar,
            20.0 * spring,
            60.0 * spring
        )
    };
    let (bar, spring) = if is_imperial {
        (1.0 / (INCH * POUND_FORCE), INCH / POUND_FORCE)
    } else {
        (1.0, 1.0)
    };
    let tuning: Table = tuning(bar, spring).parse().unwrap();
    if is_imperial {
        convert(&mut car, "");
        let own = car["car"].as_table_mut().unwrap();
        own.insert("mass_unit".to_owned(), "lb".into());
        for axle in &mut axles {
            convert(axle, "");
            let own = axle["suspension"].as_table_mut().unwrap();
            for (key, unit) in [
                ("length_unit", "in"),
                ("force_unit", "lbf"),
                ("mass_unit", "lb"),
            ] {
                own.insert(key.to_owned(), unit.into());
            }
        }
    }
    car.extend(tuning);
    let [front, rear] = axles;
    [car, front, rear].map(|table| table.to_string())
}

fn study(texts: &[String; 3]) -> CarStudy {
    let axle = |text: &str| {
        let study = Study::from_text("axle.toml", text, Path::new(""));
        study.unwrap_or_else(|errors| panic!("{errors}"))
    };
    let [car, front, rear] = texts;
    let made = CarStudy::of_axles("car", car, [axle(front), axle(rear)]);
    made.unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn inches_and_pounds_give_the_same_car() {
    let studies = [false, true].map(|is_imperial| study(&texts(is_imperial)));
    let mut solvers = studies
        .each_ref()
        .map(|study| CarSolver::new(&study.car).unwrap());
    let (mut compared, mut forces) = (0, 0);
    for (case, own) in studies[0].cases.iter().zip(&studies[1].cases) {
        let mut solved = [case, own]
            .into_iter()
            .zip(&mut solvers)
            .map(|(case, solver)| {
                let found = solver.solve(case).unwrap();
                solver.solved(case, &found).unwrap()
            });
        let solved = [solved.next().unwrap(), solved.next().unwrap()];
        for quantity in CarQuantity::all() {
            if !studies.iter().all(|study| quantity.is_met_by(&study.car)) {
                continue;
            }
            let names = studies
                .each_ref()
                .map(|study| quantity.column(study.car.length_unit));
            // Natural frequencies and shares have the same units in the metric and in the imperial study.
            let (name, factor) = in_inches_and_pounds(&names[0]);
            assert_eq!(names[1], name);
            let values = [0, 1].map(|k| quantity.printed(&solved[k], [case, own][k]));
            let [Some(metric), Some(imperial)] = values else {
                assert_eq!(values[0].is_some(), values[1].is_some(), "{}", names[0]);
                continue;
            };
            let expected = metric * factor;
            // Both equilibria are exact up to rounding errors of the largest wheel load.
            let scale = 1.0 + expected.abs();
            assert!(
                (imperial - expected).abs() < 1e-8 * scale,
                "{} in {}: {imperial} {expected}",
                names[1],
                case.name
            );
            compared += 1;
            forces += usize::from(name.ends_with("_lbf"));
        }
    }
    assert!(compared > 500 && forces > 100, "{compared} {forces}");
}

/// A tuned rate is written in the unit of the study, so the tuned study reproduces the tuned car.
#[test]
fn tuned_rates_are_in_the_units_of_the_study() {
    let directory = tempfile::tempdir().unwrap();
    for is_imperial in [false, true] {
        for (name, text) in ["car.toml", "car_front.toml", "car_rear.toml"]
            .iter()
            .zip(texts(is_imperial))
        {
            fs::write(directory.path().join(name), text).unwrap();
        }
        let out = ["metric", "imperial"][usize::from(is_imperial)];
        let ended = hardpoint(directory.path(), &["optimise", "car.toml", "--out", out]).success();
        let said = text(&ended.get_output().stdout);
        assert!(said.contains("side effect"), "{said}");
        let place = directory.path().join(out);
        hardpoint(&place, &["solve", "optimised.toml", "--out", "again"]).success();
        let rows = ["cases.csv", "again/cases.csv"].map(|name| {
            let mut table = csv::Reader::from_path(place.join(name)).unwrap();
            let rows = table.records().map(|row| {
                let row = row.unwrap();
                row.iter().map(str::to_owned).collect::<Vec<_>>()
            });
            rows.collect::<Vec<_>>()
        });
        assert!(rows[0].len() == rows[1].len() && rows[0].len() >= 5);
        for (own, again) in rows[0].iter().flatten().zip(rows[1].iter().flatten()) {
            match (own.parse::<f64>(), again.parse::<f64>()) {
                (Ok(own), Ok(again)) => {
                    assert!(
                        (own - again).abs() <= 1e-9 * (1.0 + own.abs()),
                        "{own} {again}"
                    );
                }
                _ => assert_eq!(own, again),
            }
        }
    }
    let rate = |out: &str| {
        let path = directory.path().join(out).join("optimised_rear.toml");
        let tuned: Table = fs::read_to_string(path).unwrap().parse().unwrap();
        tuned["spring"]["rate"].as_float().unwrap()
    };
    let (metric, imperial) = (rate("metric"), rate("imperial"));
    let expected = metric * INCH / POUND_FORCE;
    assert!(
        (imperial - expected).abs() < 1e-4 * expected,
        "{imperial} {expected}"
    );
}

#[test]
fn both_axles_need_the_same_units() {
    let metric = texts(false);
    let [_, front, _] = texts(true);
    let axle = |text: &str| Study::from_text("axle.toml", text, Path::new("")).unwrap();
    let made = CarStudy::of_axles("car", &metric[0], [axle(&front), axle(&metric[2])]);
    let said = made.unwrap_err().to_string();
    assert!(
        said.contains("\"mm\" and force_unit = \"N\"")
            && said.contains("\"in\" and force_unit = \"lbf\""),
        "{said}"
    );
}

/// The program warns of a car's masses in kilograms beside an axle in pounds, unless the car names their unit.
#[test]
fn masses_without_a_unit_are_doubted_beside_pounds() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    hardpoint(directory, &["new", "car"]).success();
    let said = |more: &[&str]| {
        let call = [&["check", "car.toml"][..], more].concat();
        let ended = hardpoint(directory, &call).get_output().clone();
        one_line(&text(&ended.stdout))
    };
    let doubt = "its masses are in kg, but the rear study has mass_unit = \"lb\"";
    let pounds = ["--set", "rear.suspension.mass_unit=\"lb\""];
    assert!(!said(&[]).contains("mass_unit"));
    assert!(said(&pounds).contains(doubt), "{}", said(&pounds));
    let named = [&pounds[..], &["--set", "car.mass_unit=\"kg\""]].concat();
    assert!(!said(&named).contains("mass_unit"));
}

/// If the axles have different units, the error message names the unit keys of both axle studies. A message names each
/// missing input of a result once.
#[test]
fn refusals_name_keys_once() {
    let refused = |name: &str, set: &str| {
        let study = studies().join(name);
        let call = ["check", study.to_str().unwrap(), "--set", set];
        let ended = hardpoint(Path::new("."), &call)
            .code(2)
            .get_output()
            .clone();
        text(&ended.stderr)
    };
    let said = refused("car.toml", "rear.suspension.length_unit=\"in\"");
    let words = one_line(&said);
    assert!(
        words.contains("the rear study has length_unit = \"in\" and force_unit = \"N\""),
        "{said}"
    );
    let said = refused(
        "off_road_car.toml",
        "outputs.characteristics=[\"ride_height\"]",
    );
    assert_eq!(said.matches("ride_height_point_front").count(), 1, "{said}");
}

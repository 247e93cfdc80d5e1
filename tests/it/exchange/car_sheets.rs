//! Tests of cars in tables: one sheet for each axle, and axles whose points have their own origin.

use super::file;
use hardpoint::exchange::{CAR_FILES, Page, Value, workbook};
use hardpoint::model::{AxlePosition, Topology};
use hardpoint::study::{CarStudy, Study};
use std::path::Path;

/// Rows of the template's points, moved rearward by `behind`.
fn rows(behind: f64, unit: &str) -> Vec<Vec<Value>> {
    let template = Topology::named("double_wishbone").unwrap().template;
    let study = Study::from_text("s.toml", template, Path::new(".")).unwrap();
    let text = |text: &str| Value::Text(text.to_owned());
    let head = ["name", "x", "y", "z"].map(|name| match name {
        "name" => text(name),
        axis => text(&format!("{axis} [{unit}]")),
    });
    let points = study.wheel().mechanism.points.iter();
    let rows = points.zip(&study.wheel().design).map(|(point, place)| {
        let [x, y, z] = [place.x - behind, place.y, place.z].map(Value::Number);
        vec![text(&point.name), x, y, z]
    });
    std::iter::once(head.to_vec()).chain(rows).collect()
}

fn value(name: &str, number: f64) -> Vec<Value> {
    vec![Value::Text(name.to_owned()), Value::Number(number)]
}

/// Imports the car of a workbook with the sheets Front and Rear. Returns the exit code, the messages and the study of the car.
fn import(sheets: [Vec<Vec<Value>>; 2]) -> (u8, String, String) {
    let directory = tempfile::tempdir().unwrap();
    let [front, rear] = sheets;
    let pages = [("Front", front), ("Rear", rear)].map(|(name, rows)| Page {
        name: name.to_owned(),
        rows,
    });
    let book = file(&directory, "car.xlsx", &workbook(&pages));
    let out = directory.path().join("car");
    let arguments = [
        "hardpoint",
        "import",
        book.to_str().unwrap(),
        "--car",
        "--topology",
        "double_wishbone",
        "--radius",
        "300",
        "--out",
        out.to_str().unwrap(),
    ];
    let (code, said) = hardpoint::cli::run_captured(arguments.map(str::to_owned));
    let car = std::fs::read_to_string(out.join(CAR_FILES[0])).unwrap_or_default();
    if code == 0 {
        let axles = CAR_FILES[1..].iter().map(|name| out.join(name));
        for axle in axles {
            Study::read(&axle, &[]).unwrap_or_else(|errors| panic!("{}", errors.render(false)));
        }
        assert!(CarStudy::is_at(&out.join(CAR_FILES[0])));
    }
    (code, said, car)
}

/// Each axle of a car may have its own sheet. The sheets may not state different units. They state neither axes nor sides, so the
/// points show the axes, and the right wheel is the mirror image.
#[test]
fn each_axle_may_have_its_own_sheet() {
    let (code, said, car) = import([rows(0.0, "mm"), rows(2500.0, "mm")]);
    assert_eq!(code, 0, "{said}");
    assert!(
        said.contains("sheets \"Front\", \"Rear\": one for each axle"),
        "{said}"
    );
    assert!(car.contains("rear_offset = [0.0, 0.0, 0.0]"), "{car}");
    assert!(said.contains("iso8855"), "{said}");
    let (code, said, _) = import([rows(0.0, "mm"), rows(2500.0, "in")]);
    assert_eq!(code, 2, "{said}");
    assert!(said.contains("sheet \"Rear\": its units differ"), "{said}");
}

/// If each axle has its own origin, the wheelbase of the table is the wheelbase of the car.
#[test]
fn a_wheelbase_places_axles_with_their_own_origins() {
    for behind in [0.0, 3.0, -3.0] {
        let (code, said, car) = import([rows(0.0, "mm"), rows(behind, "mm")]);
        assert_eq!(code, 0, "{said}");
        assert!(car.contains("# wheelbase = ..."), "{behind}: {car}");
        let mut front = rows(0.0, "mm");
        front.push(value("Wheelbase", 2450.0));
        let (code, said, car) = import([front, rows(behind, "mm")]);
        assert_eq!(code, 0, "{said}");
        assert!(car.contains("\nwheelbase = 2450.0"), "{behind}: {car}");
        assert!(
            said.contains("Assumed: both origins are at the same height"),
            "{said}"
        );
        assert!(!said.contains("wheelbase or rear_offset"), "{said}");
    }
    // The points of both axles have one origin. The stated wheelbase is a rounded number.
    let mut front = rows(0.0, "mm");
    front.push(value("Wheelbase", 2500.0));
    let (_, _, car) = import([front, rows(2498.0, "mm")]);
    assert!(car.contains("rear_offset = [0.0, 0.0, 0.0]"), "{car}");
}

/// The name of a sheet is the axle of its points, so each sheet can also be imported alone.
#[test]
fn a_sheet_is_chosen_by_its_axle() {
    let directory = tempfile::tempdir().unwrap();
    let pages = [("Front", 0.0), ("Rear", 2500.0)].map(|(name, behind)| Page {
        name: name.to_owned(),
        rows: rows(behind, "mm"),
    });
    let book = file(&directory, "car.xlsx", &workbook(&pages));
    let table = hardpoint::exchange::read_car_points(&book, None).unwrap();
    assert!(table.has_two_axles());
    for (sheet, axle) in [("Front", AxlePosition::Front), ("Rear", AxlePosition::Rear)] {
        // A named sheet has one axle only.
        let refused = hardpoint::exchange::read_car_points(&book, Some(sheet)).unwrap_err();
        assert!(refused.to_string().starts_with("--car: "), "{refused}");
        assert!(hardpoint::exchange::read_points(&book, None, Some(axle)).is_ok());
    }
}

//! Tests of the units of lengths and angles that a file states: the import reads the right number or refuses.

use super::{Said, file, imported};
use hardpoint::exchange::Imported;
use hardpoint::model::LengthUnit;

/// A double wishbone, left wheel, ISO 8855, mm.
const WHEEL: [(&str, [f64; 3]); 9] = [
    ("UCA front", [135.0, 265.0, 330.0]),
    ("UCA rear", [-165.0, 270.0, 318.0]),
    ("UBJ", [-8.0, 545.0, 365.0]),
    ("LCA front", [150.0, 215.0, 142.0]),
    ("LCA rear", [-180.0, 220.0, 138.0]),
    ("LBJ", [6.0, 575.0, 130.0]),
    ("tie rod inner", [68.0, 230.0, 170.0]),
    ("tie rod outer", [75.0, 560.0, 165.0]),
    ("wheel centre", [0.0, 620.0, 255.0]),
];

fn rows(per: f64) -> String {
    let row = |(name, [x, y, z]): &(&str, [f64; 3])| {
        format!("{name},{},{},{}\n", x / per, y / per, z / per)
    };
    WHEEL.iter().map(row).collect()
}

fn map(per: f64) -> String {
    let entry = |(name, p): &(&str, [f64; 3])| format!("{name:?}: {:?}", p.map(|x| x / per));
    WHEEL.iter().map(entry).collect::<Vec<_>>().join(", ")
}

fn read(name: &str, text: &str, said: &Said) -> Result<Imported, String> {
    let directory = tempfile::tempdir().unwrap();
    imported(
        &file(&directory, name, text.as_bytes()),
        "double_wishbone",
        said,
    )
}

fn table(text: &str) -> Result<Imported, String> {
    read("points.csv", text, &Said::default())
}

/// Asserts that the study has the points of the wheel. `mm` is the number of millimetres in the unit of the study.
fn is_the_wheel(read: &Imported, mm: f64, case: &str) {
    let names = [
        "upper_arm_front",
        "upper_arm_rear",
        "upper_ball_joint",
        "lower_arm_front",
        "lower_arm_rear",
        "lower_ball_joint",
        "tie_rod_inner",
        "tie_rod_outer",
        "wheel_centre",
    ];
    for ((_, wanted), name) in WHEEL.iter().zip(names) {
        let found = read.hardpoints.iter().find(|h| h.name == name).unwrap();
        for (found, wanted) in found.position.iter().zip(wanted) {
            assert!((found * mm - wanted).abs() < 1e-9, "{case}: {name}");
        }
    }
}

#[test]
fn stated_centimetres_and_feet_are_converted() {
    let unit = |head: &str, per: f64| format!("{head}\n{}", rows(per));
    for head in [
        "name,x [cm],y [cm],z [cm]",
        "name,x_cm,y_cm,z_cm",
        "name,X (cm),Y (cm),Z (cm)",
        "# all dimensions in cm\nname,x,y,z",
        "All dimensions in centimetres\nname,x,y,z",
        "unit,cm\nname,x,y,z",
        "Units: cm\nname,x,y,z",
        "User Options,Length,centimeter,cm\nname,x,y,z",
        "name,x,y,z\n,cm,cm,cm",
        "name,x,y,z\nunit,[cm],[cm],[cm]",
    ] {
        let found = table(&unit(head, 10.0)).unwrap();
        assert_eq!(found.unit, LengthUnit::Millimetre, "{head}");
        is_the_wheel(&found, 1.0, head);
        assert!(
            found.notes.texts().any(|note| note.contains("states cm")),
            "{head}: {:?}",
            found.notes
        );
    }
    for head in [
        "name,x [ft],y [ft],z [ft]",
        "# dimensions in feet\nname,x,y,z",
    ] {
        let found = table(&unit(head, 304.8)).unwrap();
        assert_eq!(found.unit, LengthUnit::Inch, "{head}");
        is_the_wheel(&found, 25.4, head);
    }
    let column = rows(10.0).replace('\n', ",cm\n");
    let found = table(&format!("name,x,y,z,unit\n{column}")).unwrap();
    is_the_wheel(&found, 1.0, "a column of units");
    let mixed = column.replacen(",cm\n", ",mm\n", 1);
    assert!(table(&format!("name,x,y,z,unit\n{mixed}")).is_err());
    for keys in ["\"unit\": \"cm\"", "\"units\": {\"length\": \"cm\"}"] {
        let text = format!("{{{keys}, {}}}", map(10.0));
        let found = read("points.json", &text, &Said::default()).unwrap();
        is_the_wheel(&found, 1.0, keys);
    }
}

/// The unit of the file also applies to lengths outside the table of points, and to lengths that the user gives as
/// options.
#[test]
fn lengths_beside_points_are_converted_too() {
    let head = format!("name,x [cm],y [cm],z [cm]\n{}", rows(10.0));
    for (row, radius) in [
        ("wheel radius,25,,\n", 250.0),
        ("wheel radius [cm],25,,\n", 250.0),
        ("wheel radius [mm],250,,\n", 250.0),
        ("wheel radius,25,cm,\n", 250.0),
        ("wheel radius_in,10,,\n", 254.0),
    ] {
        let found = table(&format!("{head}{row}")).unwrap();
        assert_eq!(found.wheel_radius, Some(radius), "{row}");
    }
    // The user's unit has priority over the file's.
    let said = Said {
        unit: Some(LengthUnit::Metre.into()),
        ..Said::default()
    };
    let found = read("points.csv", &head, &said).unwrap();
    assert_eq!(found.unit, LengthUnit::Metre);
    assert!(found.notes.texts().any(|note| note.contains("replaces")));
}

#[test]
fn units_that_are_not_known_are_never_guessed() {
    for head in [
        "name,x [furlong],y [furlong],z [furlong]",
        "name,x_um,y_um,z_um",
        "unit,parsec\nname,x,y,z",
        "User Options,Length,parsec,pc\nname,x,y,z",
    ] {
        let refused = table(&format!("{head}\n{}", rows(10.0))).unwrap_err();
        assert!(refused.contains("--unit"), "{head}: {refused}");
        let said = Said {
            unit: Some(LengthUnit::Inch.into()),
            ..Said::default()
        };
        let text = format!("{head}\n{}", rows(25.4));
        is_the_wheel(&read("points.csv", &text, &said).unwrap(), 25.4, head);
    }
}

fn angle_rows(head: &str, row: &str) -> Result<Imported, String> {
    table(&format!("{head}{}{row}\n", rows(1.0)))
}

#[test]
fn angles_in_radians_are_converted_in_every_format() {
    let plain = "name,x,y,z\n";
    let camber = (-0.02_f64).to_degrees();
    for row in [
        "camber [rad],-0.02,,",
        "static_camber_rad,-0.02,,",
        "camber (rad),-0.02,,",
        "camber rad,-0.02,,",
        "camber rad left,-0.02,,",
        "camber [radians],-0.02,,",
        "camber,-0.02,rad,",
        "camber,-0.02,[rad],",
        "camber,rad,-0.02,",
    ] {
        let found = angle_rows(plain, row).unwrap();
        assert_eq!(found.static_camber, Some(camber), "{row}");
    }
    let milli = angle_rows(plain, "camber [mrad],-20,,").unwrap();
    assert!((milli.static_camber.unwrap() - camber).abs() < 1e-12);
    let toe = 0.005_f64.to_degrees();
    for row in ["toe_angle [rad],0.005,,", "toe in rad,0.005,,"] {
        assert_eq!(
            angle_rows(plain, row).unwrap().static_toe,
            Some(toe),
            "{row}"
        );
    }
    for head in [
        "# angles in radians\nname,x,y,z\n",
        "User Options,Length,millimeter,mm\n,Angle,radian,rad\nname,x,y,z\n",
        "Units: mm, rad\nname,x,y,z\n",
    ] {
        let found = angle_rows(head, "camber,-0.02,,").unwrap();
        assert_eq!(found.static_camber, Some(camber), "{head}");
        let own = angle_rows(head, "camber [deg],-1.5,,").unwrap();
        assert_eq!(own.static_camber, Some(-1.5), "{head}");
    }
    for keys in [
        "\"static_camber_rad\": -0.02",
        "\"angle_unit\": \"rad\", \"static_camber\": -0.02",
        "\"units\": {\"length\": \"mm\", \"angle\": \"rad\"}, \"camber\": -0.02",
    ] {
        let text = format!("{{{keys}, {}}}", map(1.0));
        let found = read("points.json", &text, &Said::default()).unwrap();
        assert_eq!(found.static_camber, Some(camber), "{keys}");
    }
    let yaml = format!("{{angle_unit: rad, camber: -0.02, {}}}", map(1.0));
    let found = read("points.yaml", &yaml, &Said::default()).unwrap();
    assert_eq!(found.static_camber, Some(camber));
}

#[test]
fn angles_in_minutes_and_as_lengths_are_rejected() {
    for row in [
        "toe [mm],2,,",
        "static_toe_mm,2,,",
        "toe ('),12,,",
        "toe [in],0.1,,",
        "toe,12,min,",
        "toe,12,',",
        "toe,2,mm,",
        "toe [min],12,,",
        "camber arcmin,12,,",
        "toe [%],0.2,,",
    ] {
        let refused = angle_rows("name,x,y,z\n", row).unwrap_err();
        assert!(refused.contains("expected an angle"), "{row}: {refused}");
    }
    let minutes = "# dimensions in mm, angles in minutes\nname,x,y,z\n";
    assert!(angle_rows(minutes, "toe,12,,").is_err());
    let text = format!("{{\"toe_mm\": 2, {}}}", map(1.0));
    assert!(read("points.json", &text, &Said::default()).is_err());
    let text = format!("{{\"angle_unit\": \"gon\", \"toe\": 2, {}}}", map(1.0));
    assert!(read("points.json", &text, &Said::default()).is_err());
}

/// The import lists values that it cannot read.
#[test]
fn values_that_are_not_one_number_are_listed() {
    let listed = |found: Imported, name: &str| {
        let line = found.left_out.iter().find(|line| line.contains(name));
        assert!(line.is_some(), "{name}: {:?}", found.left_out);
    };
    let plain = "name,x,y,z\n";
    listed(angle_rows(plain, "toe,0.1,0.2,").unwrap(), "toe");
    listed(angle_rows(plain, "camber min,-3,,").unwrap(), "camber min");
    for value in ["[-1.5, -1.2]", "\"-1.5 deg\""] {
        let text = format!("{{\"static_camber\": {value}, {}}}", map(1.0));
        let found = read("points.json", &text, &Said::default()).unwrap();
        listed(found, "static_camber");
    }
}

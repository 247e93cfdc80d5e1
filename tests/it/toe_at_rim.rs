//! Tests of toe as a length: the distance by which the rear edge of the rim is farther outboard than its front edge.

use hardpoint::optimise::Control;
use hardpoint::study::Study;

const DIAMETER: f64 = 430.0;

fn study(name: &str, edits: &[&str]) -> Result<Study, String> {
    let path = crate::support::studies().join(format!("{name}.toml"));
    let edits: Vec<String> = edits.iter().map(|edit| (*edit).to_owned()).collect();
    Study::read(&path, &edits).map_err(|error| error.to_string())
}

/// Column of a study's curves.
fn column(study: &Study, name: &str) -> Vec<f64> {
    let curves = study.curves().unwrap();
    let place = curves.columns.iter().position(|own| own.name == name);
    let place = place.unwrap_or_else(|| panic!("no {name}"));
    let values = curves.stations.iter().map(|s| s.values[place].unwrap());
    values.collect()
}

fn close(found: f64, expected: f64, size: f64) {
    assert!(
        (found - expected).abs() <= 1e-12 * size,
        "{found} {expected}"
    );
}

/// The test computes the edges of the rim at the height of the wheel centre from two points of the spin axis. At either
/// wheel, the toe at the rim is the distance by which the rear edge is farther outboard than the front edge.
#[test]
fn it_is_the_difference_of_two_rim_edges() {
    for side in ["left", "right"] {
        let across = if side == "left" { 1.0 } else { -1.0 };
        let mut edits = vec![
            format!("suspension.side=\"{side}\""),
            format!("wheel.rim_diameter={DIAMETER}"),
            "motion.rack=[-15.0, 0.0, 15.0]".to_owned(),
            "outputs.characteristics=[\"toe_at_rim\"]".to_owned(),
            "outputs.points=[\"wheel_centre\", \"spindle_inner\"]".to_owned(),
        ];
        if side == "right" {
            let plain = study("double_wishbone_solve", &[]).unwrap();
            let wheel = plain.wheel();
            let points = wheel.mechanism.points.iter().zip(&wheel.design);
            edits.extend(points.map(|(point, at)| {
                let [x, y, z] = at.to_array();
                let name = &point.name;
                format!("suspension.hardpoints.{name}=[{x:?}, {:?}, {z:?}]", -y)
            }));
        }
        let edits: Vec<&str> = edits.iter().map(String::as_str).collect();
        let study = study("double_wishbone_solve", &edits).unwrap();
        let toe = column(&study, "toe_at_rim_mm");
        let coordinate = |point: &str, axis: &str| column(&study, &format!("{point}_{axis}_mm"));
        let along = |axis: &str| {
            let (outer, inner) = (
                coordinate("wheel_centre", axis),
                coordinate("spindle_inner", axis),
            );
            let pairs = outer.into_iter().zip(inner);
            pairs
                .map(|(outer, inner)| outer - inner)
                .collect::<Vec<f64>>()
        };
        let (x, y) = (along("x"), along("y"));
        assert!(toe.iter().any(|t| *t > 1.0) && toe.iter().any(|t| *t < -1.0));
        for ((toe, x), y) in toe.iter().zip(x).zip(y) {
            // The horizontal diameter of the rim is perpendicular to the spin axis.
            let half = 0.5 * DIAMETER / x.hypot(y);
            let level = [-y * across * half, x * across * half];
            let forward = if level[0] > 0.0 {
                level
            } else {
                level.map(|c| -c)
            };
            let (front, rear) = (forward[1] * across, -forward[1] * across);
            close(*toe, rear - front, DIAMETER);
        }
    }
}

/// In the design position the toe at the rim is D sin(static_toe), in the length unit of the study, for any camber. D
/// is the rim diameter.
#[test]
fn static_toe_gives_its_sine() {
    let given = |more: &[&str]| {
        let all = [
            &[
                "wheel.rim_diameter=16.0",
                "outputs.characteristics=[\"toe_at_rim\"]",
            ],
            more,
        ]
        .concat();
        study("macpherson_bump_steer", &all).unwrap()
    };
    for (toe, camber) in [(0.3_f64, -1.0), (-2.0, 5.0)] {
        let study = given(&[
            "suspension.length_unit=\"in\"",
            &format!("wheel.static_toe={toe:?}"),
            &format!("wheel.static_camber={camber:?}"),
            "motion.travel=0.0",
        ]);
        let found = column(&study, "toe_at_rim_in");
        close(found[0], 16.0 * toe.to_radians().sin(), 16.0);
    }
}

/// The derivative of the toe at the rim with respect to travel is D cos(toe) times the derivative of toe. D is the rim
/// diameter.
#[test]
fn its_slope_is_that_of_the_angle() {
    let study = study(
        "macpherson_solve",
        &[
            "wheel.rim_diameter=430.0",
            "outputs.characteristics=[\"toe_at_rim\", \"toe\"]",
            "outputs.order=\"velocity\"",
        ],
    )
    .unwrap();
    let angles = column(&study, "toe_deg");
    let slopes = column(&study, "toe_d1_deg_per_mm");
    let lengths = column(&study, "toe_at_rim_d1_mm_per_mm");
    assert!(slopes.iter().any(|slope| slope.abs() > 1e-3));
    for ((angle, slope), length) in angles.iter().zip(slopes).zip(lengths) {
        let expected = DIAMETER * angle.to_radians().cos() * slope.to_radians();
        close(length, expected, 1.0);
    }
}

/// The toe at the rim of an axle is the sum over both wheels. If both wheels are parallel, steering does not change this
/// sum to first order.
#[test]
fn an_axle_has_the_sum() {
    let study = study(
        "macpherson_axle",
        &[
            "wheel.rim_diameter=430.0",
            "motion={ roll = [-2.0, 0.0, 1.0], steering_wheel_angle = [0.0, 90.0] }",
            "outputs.characteristics=[\"toe\", \"toe_at_rim\", \"total_toe\", \"total_toe_at_rim\"]",
        ],
    )
    .unwrap();
    for (name, unit) in [("toe", "deg"), ("toe_at_rim", "mm")] {
        let total = column(&study, &format!("total_{name}_{unit}"));
        let left = column(&study, &format!("left_{name}_{unit}"));
        let right = column(&study, &format!("right_{name}_{unit}"));
        assert!(left.iter().zip(&right).any(|(l, r)| (l - r).abs() > 1.0));
        for ((total, left), right) in total.iter().zip(left).zip(right) {
            close(*total, left + right, DIAMETER);
        }
    }
}

/// A tuning meets a target of toe at the rim.
#[test]
fn a_tuning_meets_it() {
    let study = study(
        "macpherson_bump_steer",
        &[
            "wheel.rim_diameter=430.0",
            "optimise.targets=[{ characteristic = \"toe_at_rim\", at = 40.0, value = 0.5, tolerance = 0.05 }]",
            "optimise.good_enough=0.0",
            "outputs.characteristics=[\"toe_at_rim\"]",
            "motion.travel=40.0",
        ],
    )
    .unwrap();
    let before = column(&study, "toe_at_rim_mm")[0];
    assert!((before - 0.5).abs() > 0.1, "{before}");
    let best = study.tune(Control::default()).unwrap().best.unwrap();
    let after = column(&study.moved(&best.offsets), "toe_at_rim_mm")[0];
    assert!((after - 0.5).abs() < 1e-6, "{after}");
}

#[test]
fn it_needs_the_diameter() {
    let asked = |name: &str| format!("outputs.characteristics=[\"{name}\"]");
    for (of, name) in [
        ("macpherson_solve", "toe_at_rim"),
        ("macpherson_axle", "toe_at_rim"),
        ("macpherson_axle", "total_toe_at_rim"),
    ] {
        let error = study(of, &[&asked(name)]).unwrap_err();
        assert!(error.contains("rim_diameter in [wheel]"), "{error}");
    }
    let edits = ["wheel.rim_diameter=0.0"];
    let error = study("macpherson_solve", &edits).unwrap_err();
    assert!(error.contains("rim_diameter"), "{error}");
}

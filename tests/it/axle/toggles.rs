//! Tests of axles beyond a toggle: only values that depend on the rocker at its toggle do not exist.

use super::solved;
use hardpoint::ask::NoValue;
use hardpoint::curves::{Curves, Status};
use hardpoint::model::Rod;

fn values(curves: &Curves, name: &str) -> Vec<Result<f64, NoValue>> {
    let place = curves.columns.iter().position(|column| column.name == name);
    let place = place.unwrap_or_else(|| panic!("no column {name}"));
    curves.stations.iter().map(|s| s.values[place]).collect()
}

/// The drop link of a MacPherson axle reaches its toggle. The bar then has no torque, and neither wheel has a load. The struts
/// have no rocker, so their springs have the same forces and points as without the bar's torque.
#[test]
fn a_toggle_of_the_bar_leaves_the_springs_alone() {
    let motion = "motion={ travel_left = [0.0, 100.0, 180.0], travel_right = 0.0 }";
    let solved = |outputs: &str| solved("macpherson_axle", &[motion, outputs]);
    let with = "outputs={ characteristics = [\"spring_force\", \"wheel_load\", \"anti_roll_bar_torque\"], \
                points = [\"strut_lower\"], order = \"velocity\" }";
    let without = "outputs={ characteristics = [\"spring_force\"], points = [\"strut_lower\"], order = \"velocity\" }";
    let (with, without) = (solved(with), solved(without));
    for column in &without.columns {
        let found = values(&with, &column.name);
        assert_eq!(found, values(&without, &column.name), "{}", column.name);
        assert!(found.iter().all(Result::is_ok), "{}", column.name);
    }
    for name in [
        "anti_roll_bar_torque_N_m",
        "left_wheel_load_N",
        "right_wheel_load_N",
    ] {
        let found = values(&with, name);
        assert!(found[0].is_ok() && found[1].is_ok(), "{found:?}");
        assert_eq!(found[2], Err(NoValue::Toggle), "{name}");
    }
    assert_eq!(
        with.stations[2].status,
        Status::Toggle([Some(Rod::DropLink), None])
    );
}

/// Beyond a toggle, a point of the bar of a steered solid axle has no coordinates, and no derivatives along any motion.
#[test]
fn a_point_beyond_a_toggle_has_no_derivatives_by_the_drag_link() {
    let found = solved(
        "off_road_car_front",
        &[
            "anti_roll_bar={ rate = 6.0e5 }",
            "suspension.hardpoints.drop_link_outer=[-52.0, 500.0, 330.0]",
            "suspension.hardpoints.drop_link_inner=[-80.0, 500.0, 480.0]",
            "suspension.hardpoints.anti_roll_bar_inner=[-140.0, 300.0, 480.0]",
            "suspension.hardpoints.anti_roll_bar_outer=[-140.0, 500.0, 480.0]",
            "suspension.bodies.drop_link_outer=\"axle\"",
            "motion={ heave = [0.0, 200.0], rack = [0.0, 5.0] }",
            "outputs={ characteristics = [\"steer\"], points = [\"drop_link_inner\"], order = \"acceleration\" }",
        ],
    );
    let of_bar = found
        .columns
        .iter()
        .filter(|c| c.name.starts_with("left_drop_link_inner"));
    let names: Vec<&str> = of_bar.map(|column| &*column.name).collect();
    assert!(
        names.iter().any(|name| name.contains("_by_rack")),
        "{names:?}"
    );
    for name in names {
        for (station, value) in found.stations.iter().zip(values(&found, name)) {
            let is_beyond = matches!(station.status, Status::Toggle(_));
            assert_eq!(value.is_err(), is_beyond, "{name}: {value:?}");
        }
    }
    let beyond = found
        .stations
        .iter()
        .filter(|s| matches!(s.status, Status::Toggle(_)));
    assert_eq!(beyond.count(), 2);
    assert!(values(&found, "left_steer_deg").iter().all(Result::is_ok));
}

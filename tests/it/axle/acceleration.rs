//! Tests of second derivatives of an axle, against those of one wheel and against slopes of the first derivatives.

use hardpoint::curves::Curves;
use hardpoint::study::Study;
use std::path::Path;

fn solved(overrides: &[&str]) -> Curves {
    super::solved("macpherson_axle", overrides)
}

fn value(curves: &Curves, station: usize, column: usize) -> f64 {
    let value = curves.stations[station].values[column];
    value.unwrap_or_else(|void| panic!("{}: {void:?}", curves.columns[column].name))
}

const ASKED: &str = "outputs={characteristics=[\"camber\", \"toe\", \"track\", \"roll_steer\", \"jacking_coefficient\", \
    \"force_roll_centre_height\", \"wheel_load\", \"roll_angle\", \"spring_force\"], points=[\"wheel_centre\", \"tie_rod_outer\", \
    \"drop_link_inner\"], knuckle=true, order=\"acceleration\"}";

/// The second derivatives with respect to roll, heave, rack and travel equal the slopes of the first derivatives. The
/// slopes come from finite differences of eighth order.
#[test]
fn second_derivatives_are_the_slopes_of_the_first() {
    let step = 0.125;
    let range = |middle: f64| {
        let values: Vec<_> = (-4..=4).map(|k| middle + step * f64::from(k)).collect();
        format!("{values:?}")
    };
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    for (motion, by) in [
        (format!("roll={}, heave=10.0, rack=8.0", range(1.5)), "roll"),
        (
            format!("roll=1.5, heave={}, rack=8.0", range(10.0)),
            "heave",
        ),
        (format!("roll=1.5, heave=10.0, rack={}", range(8.0)), "rack"),
        (format!("heave={}, rack=0.0", range(10.0)), "heave"),
        (
            format!(
                "ground=\"plane\", travel_left=10.0, travel_right={}, rack=8.0",
                range(-12.0)
            ),
            "travel_right",
        ),
        (
            format!(
                "ground=\"plane\", travel_left=10.0, travel_right=-12.0, rack={}",
                range(8.0)
            ),
            "rack",
        ),
    ] {
        let found = solved(&[ASKED, &format!("motion={{{motion}}}")]);
        assert_eq!(found.stations.len(), 9);
        let mut seen = 0;
        for (number, second) in found.columns.iter().enumerate() {
            let is_of = |order: usize, of: &hardpoint::curves::Column| {
                of.order == order && of.name.contains(&format!("_by_{by}_"))
            };
            if !is_of(2, second) {
                continue;
            }
            let mut first = found.columns.iter();
            let first = first
                .position(|c| is_of(1, c) && c.output == second.output)
                .unwrap();
            let at = |k: usize| value(&found, k, first);
            let pairs = weights.iter().enumerate();
            let slope = pairs.map(|(k, w)| w * (at(5 + k) - at(3 - k))).sum::<f64>() / step;
            let own = value(&found, 4, number);
            let size = own.abs().max(at(4).abs()).max(1e-3);
            // Rounding errors of the first derivatives, divided by the step. Measured: at most 4e-12.
            assert!(
                (own - slope).abs() < 1e-9 * size,
                "{}: {own} {slope}",
                second.name
            );
            seen += 1;
        }
        assert!(seen > 30, "{motion}: {seen}");
    }
}

/// In heave on level pads the left wheel has the second derivatives of the same study without an axle.
#[test]
fn on_pads_they_are_a_corner_s() {
    let motion = "motion={heave=[-30.0, 10.0, 40.0], rack=8.0}";
    let axle = solved(&[ASKED, motion]);
    let text = crate::support::sample("macpherson_axle.toml");
    let (head, _) = text.split_once("[axle]").unwrap();
    let corner = format!(
        "{head}[wheel]\nradius = 300.0\n[motion]\ntravel = [-30.0, 10.0, 40.0]\nrack = 8.0\n[outputs]\n\
         characteristics = [\"camber\", \"toe\"]\npoints = [\"wheel_centre\", \"tie_rod_outer\"]\nknuckle = true\norder = \"acceleration\"\n"
    );
    let study = Study::from_text("corner.toml", &corner, Path::new(".")).unwrap();
    let corner = study.curves().unwrap();
    for (theirs, ours) in [
        (
            "camber_d2_deg_per_mm2",
            "left_camber_by_heave_d2_deg_per_mm2",
        ),
        ("toe_d2_deg_per_mm2", "left_toe_by_heave_d2_deg_per_mm2"),
        (
            "wheel_centre_y_d2_mm_per_mm2",
            "left_wheel_centre_y_by_heave_d2_mm_per_mm2",
        ),
        (
            "tie_rod_outer_z_d2_mm_per_mm2",
            "left_tie_rod_outer_z_by_heave_d2_mm_per_mm2",
        ),
        (
            "knuckle_omega_z_rad_per_mm",
            "left_knuckle_omega_z_by_heave_rad_per_mm",
        ),
        (
            "knuckle_alpha_z_rad_per_mm2",
            "left_knuckle_alpha_z_by_heave_rad_per_mm2",
        ),
    ] {
        let names: Vec<_> = corner.columns.iter().map(|c| &c.name).collect();
        let column = names.iter().position(|n| *n == theirs);
        let column = column.unwrap_or_else(|| panic!("{theirs} in {names:?}"));
        let own = axle
            .columns
            .iter()
            .position(|c| c.name == ours)
            .expect(ours);
        for station in 0..3 {
            let wanted = corner.stations[station].values[column].unwrap();
            let found = value(&axle, station, own);
            assert!(
                (found - wanted).abs() <= 1e-12 * wanted.abs(),
                "{ours}: {found} {wanted}"
            );
        }
    }
}

//! Tests of geometric measures among the outputs: they equal the distances and angles between the reported points. Their
//! derivatives are correct.

use hardpoint::curves::{Curves, curves};
use hardpoint::plan::Plan;
use hardpoint::study::Study;
use std::path::Path;

/// Points of a drive shaft, and of a damper separate from the spring.
const EXTRA: &str = "
[suspension.extra_points]
drive_shaft_inner = { body = \"chassis\", position = [12.0, 110.0, 262.0] }
drive_shaft_outer = { body = \"knuckle\", position = [1.0, 540.0, 254.0] }
damper_upper = { body = \"chassis\", position = [35.0, 40.0, 470.0] }
damper_lower = { body = \"rocker\", position = [30.0, 200.0, 492.0] }
";
const MEASURES: &str = "characteristics = [\"motion_ratio\", \"camber\", \"toe\"]
points = [\"drive_shaft_inner\", \"drive_shaft_outer\", \"damper_upper\", \"damper_lower\", \"tie_rod_inner\", \"tie_rod_outer\", \"upper_arm_front\", \"upper_ball_joint\"]
lengths = [\"spring\", \"tie_rod\", [\"damper_lower\", \"damper_upper\"]]
plunges = [\"drive_shaft\"]
articulations = [\"drive_shaft_outer\", \"drive_shaft_inner\", \"upper_ball_joint\", \"tie_rod_outer\"]
clearances = [[\"tie_rod\", \"upper_arm_front\"]]
";

/// Sample with these lines in `[outputs]` and this motion.
fn study(outputs: &str, travel: &str) -> Study {
    let text = text(outputs, travel);
    Study::from_text("study.toml", &text, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

fn text(outputs: &str, travel: &str) -> String {
    let sample = crate::support::sample("double_wishbone_pushrod.toml");
    let (design, _) = sample.split_once("[motion]").unwrap();
    format!("{design}{EXTRA}\n[motion]\ntravel = {travel}\n\n[outputs]\n{outputs}")
}

fn solve(study: &Study) -> Curves {
    curves(study.wheel(), &Plan::of(study.one_wheel().unwrap())).unwrap()
}

/// Values of a column at every station.
fn column(curves: &Curves, name: &str) -> Vec<f64> {
    let place = curves.columns.iter().position(|c| c.name == name);
    let place = place.unwrap_or_else(|| panic!("no column {name}"));
    let values = curves.stations.iter().map(|s| s.values[place]);
    values.map(|value| value.unwrap()).collect()
}

/// Positions of a point at every station.
fn point(curves: &Curves, name: &str) -> Vec<[f64; 3]> {
    let [x, y, z] = ["x", "y", "z"].map(|axis| column(curves, &format!("{name}_{axis}_mm")));
    (0..x.len()).map(|i| [x[i], y[i], z[i]]).collect()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

const TRAVEL: &str = "{ from = -30.0, to = 30.0, steps = 13 }";

#[test]
fn they_are_the_distances_and_angles_of_the_points() {
    let found = solve(&study(MEASURES, TRAVEL));
    let between = |a: &str, b: &str| -> Vec<[f64; 3]> {
        let ends = point(&found, a).into_iter().zip(point(&found, b));
        ends.map(|(a, b)| minus(b, a)).collect()
    };
    let shaft = between("drive_shaft_inner", "drive_shaft_outer");
    let damper = between("damper_lower", "damper_upper");
    let (camber, toe) = (column(&found, "camber_deg"), column(&found, "toe_deg"));
    let middle = shaft.len() / 2;
    for station in 0..shaft.len() {
        let of = |name: &str| column(&found, name)[station];
        let is = |name: &str, wanted: f64, bound: f64| {
            let value = of(name);
            assert!((value - wanted).abs() < bound, "{name}: {value}, {wanted}");
        };
        is(
            "damper_lower_to_damper_upper_length_mm",
            norm(damper[station]),
            1e-11,
        );
        is(
            "drive_shaft_plunge_mm",
            norm(shaft[station]) - norm(shaft[middle]),
            1e-11,
        );
        let rod = minus(
            point(&found, "tie_rod_inner")[station],
            point(&found, "tie_rod_outer")[station],
        );
        is("tie_rod_length_mm", norm(rod), 1e-11);
        let inner = (shaft[station][1] / norm(shaft[station]))
            .acos()
            .to_degrees();
        is("drive_shaft_inner_articulation_deg", inner, 1e-9);
        // Computes the spin axis from camber and toe: outboard is +y, toe-in turns the axis forward, and camber tilts its
        // outer end down.
        let (camber, toe) = (camber[station].to_radians(), toe[station].to_radians());
        let axis = [
            toe.sin() * camber.cos(),
            toe.cos() * camber.cos(),
            -camber.sin(),
        ];
        let outer = (dot(axis, shaft[station]) / norm(shaft[station]))
            .acos()
            .to_degrees();
        is("drive_shaft_outer_articulation_deg", outer, 1e-9);
    }
    for joint in ["upper_ball_joint", "tie_rod_outer"] {
        let angles = column(&found, &format!("{joint}_articulation_deg"));
        assert!(angles[middle].abs() < 1e-6, "{angles:?}");
        assert!(angles[0].abs() > 1.0, "{angles:?}");
    }
}

/// The clearance is the smallest distance between the points of two centre lines.
#[test]
fn clearances_are_the_smallest_distances() {
    let found = solve(&study(MEASURES, TRAVEL));
    let ends = [
        "tie_rod_inner",
        "tie_rod_outer",
        "upper_arm_front",
        "upper_ball_joint",
    ];
    let ends = ends.map(|name| point(&found, name));
    let clearance = column(&found, "tie_rod_to_upper_arm_front_clearance_mm");
    for (station, clearance) in clearance.iter().enumerate() {
        let on =
            |a: [f64; 3], b: [f64; 3], share: f64| [0, 1, 2].map(|i| a[i] + share * (b[i] - a[i]));
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| ends[i][station]);
        let mut least = f64::INFINITY;
        let steps = 400;
        for i in 0..=steps {
            for j in 0..=steps {
                let (s, t) = (i as f64 / steps as f64, j as f64 / steps as f64);
                least = least.min(norm(minus(on(a, b, s), on(c, d, t))));
            }
        }
        assert!(*clearance <= least + 1e-9, "{clearance}, {least}");
        assert!(least - clearance < 0.1, "{clearance}, {least}");
    }
}

/// Derivatives with respect to travel equal difference quotients of the values (extrapolated to sixth order). The
/// derivative of the spring length is minus the motion ratio.
#[test]
fn derivatives_are_slopes() {
    let outputs = format!("order = \"acceleration\"\n{MEASURES}");
    let (from, step) = (11.0, 0.5);
    let travel = format!(
        "[{}, {}, {}, {from}, {}, {}, {}]",
        from - 3.0 * step,
        from - 2.0 * step,
        from - step,
        from + step,
        from + 2.0 * step,
        from + 3.0 * step
    );
    let found = solve(&study(&outputs, &travel));
    let ratio = column(&found, "motion_ratio")[3];
    let slope = column(&found, "spring_length_d1_mm_per_mm")[3];
    assert!((ratio + slope).abs() < 1e-12, "{ratio}, {slope}");
    for (name, unit) in [
        ("damper_lower_to_damper_upper_length", "mm"),
        ("drive_shaft_plunge", "mm"),
        ("drive_shaft_outer_articulation", "deg"),
        ("drive_shaft_inner_articulation", "deg"),
        ("upper_ball_joint_articulation", "deg"),
        ("tie_rod_outer_articulation", "deg"),
        ("tie_rod_to_upper_arm_front_clearance", "mm"),
    ] {
        for order in [0, 1] {
            let of = |order: usize| match order {
                0 => column(&found, &format!("{name}_{unit}")),
                1 => column(&found, &format!("{name}_d1_{unit}_per_mm")),
                _ => column(&found, &format!("{name}_d2_{unit}_per_mm2")),
            };
            let y = of(order);
            let slope =
                (45.0 * (y[4] - y[2]) - 9.0 * (y[5] - y[1]) + (y[6] - y[0])) / (60.0 * step);
            let exact = of(order + 1)[3];
            assert!(
                (slope - exact).abs() < 1e-8 * exact.abs().max(1.0),
                "{name}: {slope}, {exact}"
            );
        }
    }
}

/// The angle of a ball joint has a kink at 0, in the design position. There it has no derivatives, although rounding gives the
/// angle a value of about 1e-15. Near this position, the slopes on both sides are opposite.
#[test]
fn an_angle_of_zero_has_no_derivatives() {
    let joints = ["upper_ball_joint", "lower_ball_joint"];
    let outputs = format!("order = \"acceleration\"\narticulations = {joints:?}");
    let sample = study(&outputs, "[-0.001, 0.0, 0.001]");
    let design = &sample.wheel().design;
    for shift in 0..20 {
        // Every design has other rounding errors.
        let moved =
            |point: &hardpoint::number::Vector3<f64>| *point * (1.0 + 1e-3 * f64::from(shift));
        let found = solve(&sample.at_design(design.iter().map(moved).collect()));
        let value = |name: String, station: usize| {
            let place = found.columns.iter().position(|c| c.name == name).unwrap();
            found.stations[station].values[place]
        };
        for joint in joints {
            let slope = |station| value(format!("{joint}_articulation_d1_deg_per_mm"), station);
            let curvature = format!("{joint}_articulation_d2_deg_per_mm2");
            assert!(slope(1).is_err() && value(curvature, 1).is_err(), "{joint}");
            let sides = [slope(0), slope(2)].map(Result::unwrap);
            assert!((sides[0] + sides[1]).abs() < 1e-5, "{joint}: {sides:?}");
        }
    }
}

/// Sensitivities equal difference quotients of values and rates with respect to a coordinate of the nominal design.
#[test]
fn sensitivities_are_slopes_by_the_hardpoints() {
    let outputs = format!(
        "order = \"velocity\"\nsensitivities = [\"upper_ball_joint\", \"tie_rod_outer\"]\n{MEASURES}"
    );
    let base = text(&outputs, "[-17.0, 14.0]");
    let line = base
        .lines()
        .find(|line| line.starts_with("upper_ball_joint"))
        .unwrap()
        .to_owned();
    let numbers = line.split_once('[').unwrap().1.split_once(']').unwrap().0;
    let at: Vec<f64> = numbers
        .split(',')
        .map(|n| n.trim().parse().unwrap())
        .collect();
    let moved = |dz: f64| {
        let to = format!("upper_ball_joint = [{}, {}, {}]", at[0], at[1], at[2] + dz);
        let text = base.replacen(&line, &to, 1);
        solve(&Study::from_text("study.toml", &text, Path::new(".")).unwrap())
    };
    let h = 0.25;
    let near: Vec<Curves> = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0]
        .map(|k| moved(k * h))
        .into();
    let found = moved(0.0);
    let mut checked = 0;
    for own in &found.sensitivities {
        let column = &found.columns[own.column];
        let is_measure = ["length", "plunge", "articulation", "clearance"]
            .iter()
            .any(|kind| column.output.ends_with(kind));
        let name = found_name(&base, own.point);
        if !is_measure || name != "upper_ball_joint" || own.axis.name() != "z" {
            continue;
        }
        let y: Vec<f64> = near
            .iter()
            .map(|c| c.stations[own.station].values[own.column].unwrap())
            .collect();
        let slope = (45.0 * (y[3] - y[2]) - 9.0 * (y[4] - y[1]) + (y[5] - y[0])) / (60.0 * h);
        assert!(
            (slope - own.value).abs() < 1e-7 * own.value.abs().max(1.0),
            "{}: {slope}, {}",
            column.name,
            own.value
        );
        checked += 1;
    }
    // Nine measures, each with its derivative, at two stations.
    assert_eq!(checked, 9 * 2 * 2);
}

fn found_name(text: &str, id: hardpoint::model::PointId) -> String {
    let study = Study::from_text("study.toml", text, Path::new(".")).unwrap();
    study.wheel().mechanism.name(id).to_owned()
}

#[test]
fn mistakes_are_named() {
    for (outputs, said) in [
        (
            "lengths = [\"tie_rod\", \"tie_rod\"]",
            "tie_rod_length is requested twice",
        ),
        (
            "characteristics = [\"spring_length\"]\nlengths = [\"spring\"]",
            "spring_length is requested twice",
        ),
        ("lengths = [\"tie_rods\"]", "did you mean \"tie_rod\"?"),
        (
            "clearances = [[\"tie_rod\"]]",
            "expected two members; found 1",
        ),
        (
            "clearances = [[\"upper_arm_front\", \"upper_arm_rear\"]]",
            "share a joint",
        ),
        (
            "articulations = [\"upper_arm_front\"]",
            "not a joint of the wheel carrier",
        ),
        (
            "plunges = [[\"tie_rod_inner\", \"tie_rod_inner\"]]",
            "two different points",
        ),
    ] {
        let error =
            Study::from_text("study.toml", &text(outputs, "[0.0]"), Path::new(".")).unwrap_err();
        assert!(error.to_string().contains(said), "{outputs}: {error}");
    }
    let axle = text("lengths = [\"tie_rod\"]", "[0.0]").replacen(
        "[motion]\ntravel",
        "[axle]\nright = \"mirrored\"\n\n[motion]\nheave",
        1,
    );
    let error = Study::from_text("study.toml", &axle, Path::new(".")).unwrap_err();
    assert!(
        error.to_string().contains("available for one wheel only"),
        "{error}"
    );
}

//! Tests of rockers at and beyond their toggles.

use super::{NEAR_TOGGLE, OUTPUTS, POINTS, read, run, sample, with_lines};
use assert_cmd::Command;
use hardpoint::curves::{Status, curves};
use hardpoint::model::Rod;
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::report::{remarks, sensitivities_csv};
use hardpoint::solve::Solver;
use std::fs;

const FAR: (&str, &str) = ("travel", "travel = { from = -60.0, to = 60.0, steps = 61 }");

/// The inner end of the rod moves on a circle. The rod fits if its length is between the smallest and the largest
/// distance of its outer end from this circle. Beyond this range the wheel still has a pose, but the outputs of the
/// rocker have no values.
#[test]
fn beyond_a_toggle_there_are_no_values_of_the_rocker() {
    let (study, found, table) = run(&with_lines(&[NEAR_TOGGLE, FAR, OUTPUTS, POINTS]));
    let design = |name: &str| {
        let id = study.wheel().mechanism.point(name).unwrap();
        study.wheel().design[id.0]
    };
    let [first, second, inner] =
        ["rocker_pivot_front", "rocker_pivot_rear", "pushrod_inner"].map(design);
    let axis = (second - first).normalised();
    let split = |p: Vector3<f64>| {
        let along = axis.dot(p - first);
        (along, (p - first - axis * along).norm())
    };
    let ((at, radius), rod) = (split(inner), (inner - design("pushrod_outer")).norm());
    let outer =
        ["x", "y", "z"].map(|axis| table.column(&format!("pushrod_outer_{axis}_mm")).unwrap());
    let fits: Vec<bool> = (0..table.rows())
        .map(|row| {
            // The wheel carrier and the arms have a pose at every station.
            let [x, y, z] = [0, 1, 2].map(|k| outer[k][row].unwrap());
            let (along, across) = split(Vector3::new(x, y, z));
            let reach = |radius: f64| (across + radius).hypot(along - at);
            reach(radius) > rod && reach(-radius) < rod
        })
        .collect();
    let stuck = fits.iter().filter(|fits| !**fits).count();
    assert!((5..30).contains(&stuck), "{stuck} of {}", fits.len());
    assert!(fits[30] && !fits[60] && fits[0]);
    for (row, fits) in fits.iter().enumerate() {
        let status = &found.stations[row].status;
        match fits {
            true => assert_eq!(*status, Status::Ok),
            false => assert_eq!(*status, Status::Toggle([Some(Rod::Pushrod), None])),
        }
        for (name, values) in table.header.iter().zip(&table.columns) {
            let is_moved = ["motion_ratio", "rocker_angle", "spring_lower", "wheel_load"]
                .iter()
                .any(|stem| name.starts_with(stem));
            assert_eq!(values[row].is_some(), *fits || !is_moved, "{name} at {row}");
        }
    }
    assert_eq!((found.failed(), found.are_complete()), (0, false));

    let said = remarks(&found, study.wheel().length_unit).join("\n");
    for phrase in [
        "pushrod is at toggle",
        &format!("{stuck} stations"),
        "cannot turn the rocker any further",
    ] {
        assert!(said.contains(phrase), "{said}");
    }
    // Beyond the toggle, sensitivities are empty cells and not NaN.
    let csv = sensitivities_csv(&study, &found);
    let csv = String::from_utf8(csv).unwrap();
    assert!(!csv.contains("NaN") && !csv.contains("inf"));
    let last: Vec<&str> = csv.lines().filter(|l| l.starts_with("60.0,")).collect();
    for line in &last {
        let value = line.split(',').nth(5).unwrap();
        let is_moved = !line.contains(",camber,") && !line.contains(",pushrod_outer");
        assert_eq!(value.is_empty(), is_moved, "{line}");
    }
    assert!(last.len() > 10);

    // If no output uses the rocker, the rocker does not limit the motion.
    let blind = ("characteristics", "characteristics = [\"camber\"]");
    let none = ("loads", "");
    let (_, found, _) = run(&with_lines(&[
        NEAR_TOGGLE,
        FAR,
        blind,
        ("points", ""),
        none,
    ]));
    assert!(found.are_complete());
}

/// Beyond a toggle the rocker has no values, even where the rod fits again. In this planar example, the distance from the
/// rod's outer end to the rocker's pivot first exceeds rod plus lever and then falls again. The rocker could reach the
/// positions beyond only through the toggle.
#[test]
fn beyond_a_toggle_the_rocker_stays_where_it_is() {
    let (hinge, pivot, outer) = ([0.0, 0.0], [253.7, 124.9], [-300.0, 20.0]);
    let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let (rod, lever, distance) = (502.2, 72.8, apart(outer, pivot));
    // The inner end is computed from the three sides of the triangle.
    let along = (distance * distance + rod * rod - lever * lever) / (2.0 * distance);
    let height = (rod * rod - along * along).sqrt();
    let unit = [0, 1].map(|k| (pivot[k] - outer[k]) / distance);
    let inner = [
        outer[0] + along * unit[0] - height * unit[1],
        outer[1] + along * unit[1] + height * unit[0],
    ];
    let text = format!(
        r#"[suspension]
topology = "semi_trailing_arm"

[suspension.hardpoints]
arm_pivot_inner = [{0:?}, 0.0, {1:?}]
arm_pivot_outer = [{0:?}, 300.0, {1:?}]
wheel_centre = [-450.0, 400.0, -20.0]
spindle_inner = [-450.0, 300.0, -20.0]
pushrod_outer = [{2:?}, 50.0, {3:?}]
pushrod_inner = [{4:?}, 50.0, {5:?}]
rocker_pivot_front = [{6:?}, 0.0, {7:?}]
rocker_pivot_rear = [{6:?}, 100.0, {7:?}]

[motion]
drive = "arm_angle"
arm_angle = [-70.0, 5.0, -5.0, -12.0, -9.0, -55.0, -30.0, -45.0, 0.0]

[outputs]
characteristics = ["rocker_angle", "camber"]
"#,
        hinge[0], hinge[1], outer[0], outer[1], inner[0], inner[1], pivot[0], pivot[1]
    );
    let (_, found, _) = run(&text);
    let mut passed = false;
    let mut order: Vec<usize> = (0..found.stations.len()).collect();
    let angle = |i: &usize| found.stations[*i].at[1].unwrap();
    order.sort_by(|a, b| angle(b).total_cmp(&angle(a)));
    let mut fits_again = 0;
    for i in order {
        // In bump the arm turns from -x towards +z. It points rearward from its hinge.
        let (sine, cosine) = angle(&i).to_radians().sin_cos();
        let moved = [
            cosine * outer[0] + sine * outer[1],
            -sine * outer[0] + cosine * outer[1],
        ];
        let fits = apart(moved, pivot) < rod + lever;
        passed |= !fits;
        fits_again += usize::from(passed && fits);
        let expected = if passed {
            Status::Toggle([Some(Rod::Pushrod), None])
        } else {
            Status::Ok
        };
        assert_eq!(found.stations[i].status, expected, "{} deg", angle(&i));
        assert_eq!(found.stations[i].values[0].is_ok(), !passed);
        assert!(found.stations[i].values[1].is_ok());
    }
    assert!(fits_again >= 2);
}

/// `limits` names the travels at which rods reach their toggles. Just inside these travels the rocker has an angle; just
/// beyond them it has none.
#[test]
fn limits_name_the_toggles() {
    let study = read(&with_lines(&[NEAR_TOGGLE])).unwrap();
    let suspension = study.wheel();
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design).unwrap();
    let limits = solver.limits().unwrap();
    let [rocker, bar] = limits.rockers[..] else {
        panic!("{limits:?}")
    };
    let toggle = rocker.upper.unwrap();
    assert_eq!(toggle.rod, Rod::Pushrod);
    assert!((0.0..limits.travel.upper.value()).contains(&toggle.travel));
    // The bar's drop link is on the rocker, so the bar's range ends at the latest where the rocker's range ends.
    assert!(bar.upper.unwrap().travel <= toggle.travel);
    for (travel, status) in [
        (toggle.travel - 1e-5, Status::Ok),
        (
            toggle.travel + 1e-5,
            Status::Toggle([Some(Rod::Pushrod), None]),
        ),
    ] {
        let motion = format!("travel = [{travel:?}]");
        let outputs = ("characteristics", "characteristics = [\"rocker_angle\"]");
        let plain = [("order", ""), ("points", ""), ("loads", "")];
        let mut lines = vec![NEAR_TOGGLE, ("travel", &motion), outputs];
        lines.extend(plain);
        let (_, found, _) = run(&with_lines(&lines));
        assert_eq!(found.stations[0].status, status, "{travel}");
    }

    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("study.toml");
    fs::write(&path, with_lines(&[NEAR_TOGGLE])).unwrap();
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    let shown = command.env("COLUMNS", "400").arg("limits").arg(path);
    let shown = shown.assert().success();
    let shown = String::from_utf8(shown.get_output().stdout.clone()).unwrap();
    let line = shown.lines().find(|l| l.contains("pushrod_travel_mm"));
    assert!(
        line.unwrap().contains("the pushrod is at toggle"),
        "{shown}"
    );
}

/// Hardpoints of a design in which the arm passes its lowest point and the pushrod passes a toggle.
const BEYOND_ITS_TOP: &[(&str, [f64; 3])] = &[
    ("upper_arm_front", [115.6, 227.6, 316.0]),
    ("upper_arm_rear", [-185.8, 263.8, 314.0]),
    ("upper_ball_joint", [-25.6, 518.1, 399.4]),
    ("lower_arm_front", [185.9, 233.0, 176.3]),
    ("lower_arm_rear", [-174.6, 239.3, 133.3]),
    ("lower_ball_joint", [19.0, 602.8, 146.5]),
    ("tie_rod_inner", [91.7, 239.0, 157.6]),
    ("tie_rod_outer", [99.2, 591.7, 143.8]),
    ("wheel_centre", [-26.7, 580.6, 234.6]),
    ("pushrod_outer", [-25.5, 506.1, 128.3]),
    ("pushrod_inner", [-14.6, 238.5, 491.9]),
    ("rocker_pivot_front", [-14.4, 166.0, 453.7]),
    ("rocker_pivot_rear", [-29.4, 224.9, 405.5]),
    ("spring_lower", [-38.9, 173.0, 518.8]),
    ("spring_upper", [-36.0, 25.6, 451.0]),
];

/// Hardpoints of a design in which the pushrod reaches a toggle when the rack moves.
const TOGGLE_BY_RACK: &[(&str, [f64; 3])] = &[
    ("upper_arm_front", [106.7, 245.1, 330.3]),
    ("upper_arm_rear", [-149.6, 271.0, 283.7]),
    ("upper_ball_joint", [27.8, 572.1, 354.3]),
    ("lower_arm_front", [113.0, 207.7, 179.0]),
    ("lower_arm_rear", [-143.7, 193.5, 113.8]),
    ("lower_ball_joint", [44.1, 562.1, 145.7]),
    ("tie_rod_inner", [102.3, 256.1, 194.3]),
    ("tie_rod_outer", [84.0, 584.6, 143.8]),
    ("wheel_centre", [32.3, 597.0, 224.9]),
    ("spindle_inner", [21.6, 559.3, 271.3]),
    ("pushrod_outer", [9.9, 497.1, 157.3]),
    ("pushrod_inner", [-25.7, 268.3, 447.8]),
    ("rocker_pivot_front", [-8.8, 208.5, 443.3]),
    ("rocker_pivot_rear", [-2.8, 176.2, 454.9]),
    ("spring_lower", [34.6, 198.7, 523.2]),
    ("spring_upper", [-24.8, 22.0, 497.3]),
];

/// Sample with these hardpoints.
fn with_points(points: &[(&str, [f64; 3])]) -> String {
    let lines: Vec<(String, String)> = points
        .iter()
        .map(|(name, p)| (format!("{name} "), format!("{name} = {p:?}")))
        .collect();
    let lines: Vec<(&str, &str)> = lines.iter().map(|(a, b)| (&a[..], &b[..])).collect();
    with_lines(&lines)
}

/// Returns the statuses of the stations of a motion, in the order of the stations. The output is the rocker angle.
fn statuses(points: &[(&str, [f64; 3])], motion: &str) -> Vec<Status> {
    let text = with_points(points);
    let (before, after) = (
        text.find("[motion]").unwrap(),
        text.find("[outputs]").unwrap(),
    );
    assert!(before < after);
    let text = format!(
        "{}[motion]\n{motion}\n[outputs]\ncharacteristics = [\"rocker_angle\"]\n",
        &text[..before]
    );
    let (_, found, _) = run(&text);
    let stations = found.stations.iter();
    stations
        .map(|s| {
            assert_eq!(s.values[0].is_ok(), s.status == Status::Ok);
            s.status
        })
        .collect()
}

/// If an arm passes its lowest point, the wheel returns to earlier heights. If the rack moves the rocker, the rocker may
/// reach its toggle before the wheel travels. In both cases, the rocker has no values beyond the toggle, whatever the
/// stations are.
#[test]
fn nothing_comes_back_from_beyond_a_toggle() {
    let toggle = Status::Toggle([Some(Rod::Pushrod), None]);
    let angles = "drive = \"arm_angle\"\narm_angle = { from = -170.0, to = 0.0, steps = 171 }";
    let found = statuses(BEYOND_ITS_TOP, angles);
    let first = found.iter().rposition(|status| *status == toggle).unwrap();
    assert_eq!(first, 170 - 9);
    assert!(found[..=first].iter().all(|status| *status == toggle));
    assert!(
        found[first + 1..]
            .iter()
            .all(|status| *status == Status::Ok)
    );

    let racks = "rack = { from = -20.0, to = 20.0, steps = 81 }";
    let found = statuses(
        TOGGLE_BY_RACK,
        &format!("travel = [-10.0, 0.0, 10.0]\n{racks}"),
    );
    let alone = statuses(TOGGLE_BY_RACK, &format!("travel = [-10.0]\n{racks}"));
    let mut by_rack = 0;
    for (of_rack, alone) in found.chunks_exact(3).zip(alone) {
        if of_rack[1] == toggle {
            by_rack += 1;
            assert_eq!(of_rack, [toggle; 3]);
        }
        assert_eq!(of_rack[0], alone);
    }
    assert!(by_rack > 10 && by_rack < 81);
}

/// Sample with a short rocker whose rod is too short in a part of the travel. The rod's outer end moves along an arc. The
/// rocker's pivot is beyond the centre of this arc, so the distance between pivot and outer end is largest at the travel
/// `at`. There the distance exceeds rod plus lever by `by`. In the design position and at twice that travel the rod fits.
fn rod_short_at(at: f64, by: f64) -> String {
    let sample = read(&sample()).unwrap().into_wheel();
    let outer = |travel: f64| {
        let [_, y, z] = sample
            .pose_at(travel, 0.0)
            .unwrap()
            .point("pushrod_outer")
            .unwrap();
        nalgebra::Vector2::new(y, z)
    };
    let [before, there, after] = [at - 10.0, at, at + 10.0].map(outer);
    // The centre of the arc has equal distances from three positions of the outer end.
    let chords =
        nalgebra::Matrix2::from_rows(&[(there - before).transpose(), (after - there).transpose()]);
    let halves = nalgebra::Vector2::new(
        0.5 * (there.norm_squared() - before.norm_squared()),
        0.5 * (after.norm_squared() - there.norm_squared()),
    );
    let centre = chords.lu().solve(&halves).unwrap();
    let pivot = there + (centre - there) * 2.0;
    let farthest = (there - pivot).norm();
    let lever = 12.0;
    let rod = farthest - lever - by;
    // In the design position, the inner end is at the intersection of two circles, with the lengths of rod and lever as
    // radii.
    let to = outer(0.0) - pivot;
    let (d, along) = (to.norm(), to.normalize());
    assert!(d < lever + rod, "{d}");
    let x = (d * d + lever * lever - rod * rod) / (2.0 * d);
    let across = nalgebra::Vector2::new(-along.y, along.x);
    let inner = pivot + along * x + across * (lever * lever - x * x).sqrt();
    let line = |name: &str, x: f64, p: nalgebra::Vector2<f64>| {
        format!("{name} = [{x:?}, {:?}, {:?}]", p.x, p.y)
    };
    let x = sample
        .pose_at(0.0, 0.0)
        .unwrap()
        .point("pushrod_outer")
        .unwrap()[0];
    let lower = pivot + nalgebra::Vector2::new(-40.0, 30.0);
    let lines = [
        (
            "rocker_pivot_front ",
            line("rocker_pivot_front", x + 20.0, pivot),
        ),
        (
            "rocker_pivot_rear ",
            line("rocker_pivot_rear", x - 20.0, pivot),
        ),
        ("pushrod_inner ", line("pushrod_inner", x, inner)),
        ("spring_lower ", line("spring_lower", x, lower)),
    ];
    let lines: Vec<(&str, &str)> = lines.iter().map(|(a, b)| (*a, b.as_str())).collect();
    with_lines(&[&lines[..], &[OUTPUTS]].concat())
}

/// Curves and sweeps detect a toggle that begins and ends between two stations. Stations beyond the toggle have no
/// values, even with few stations.
#[test]
fn a_toggle_between_two_stations_is_seen() {
    for (at, by) in [(28.0, 0.02), (28.0, 0.1), (-25.0, 0.1)] {
        let text = rod_short_at(at, by);
        let statuses = |travel: &str| {
            let set = [format!("motion.travel={travel}")];
            let study = read(&text)
                .unwrap()
                .with_overrides("study.toml", &set)
                .unwrap();
            let found = curves(study.wheel(), &Plan::of(study.one_wheel().unwrap())).unwrap();
            let stations = found.stations.iter();
            stations
                .map(|s| (s.at[0].unwrap(), s.status))
                .collect::<Vec<_>>()
        };
        let far = 2.0 * at;
        let range = |from: f64, to: f64| format!("{{ from = {from:?}, to = {to:?}, steps = 401 }}");
        let mut fine = statuses(&range(far.min(0.0), far.max(0.0)));
        if far < 0.0 {
            fine.reverse();
        }
        let toggle = Status::Toggle([Some(Rod::Pushrod), None]);
        assert_eq!((fine[0].1, fine[400].1), (Status::Ok, toggle), "{at} {by}");
        let coarse = statuses(&format!("[0.0, {far:?}]"));
        assert_eq!(coarse, [fine[0], fine[400]], "{at} {by}");
        let sweep = "sweep={ method = \"grid\", variables = [{ hardpoint = \"tie_rod_inner\", axis = \"z\", \
                     range = [-0.001, 0.001], steps = 3 }] }";
        let set = [format!("motion.travel=[0.0, {far:?}]"), sweep.to_owned()];
        let study = read(&text)
            .unwrap()
            .with_overrides("study.toml", &set)
            .unwrap();
        let mut failing = 0;
        study
            .sweep(Default::default(), |rows| {
                failing += rows
                    .failing
                    .iter()
                    .flatten()
                    .filter(|f| f.at == Some(far))
                    .count();
                std::ops::ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(failing, 3, "{at} {by}");
        // If the rod is long enough, the same stations have values.
        let text = rod_short_at(at, -0.2);
        let set = [format!("motion.travel=[0.0, {far:?}]")];
        let study = read(&text)
            .unwrap()
            .with_overrides("study.toml", &set)
            .unwrap();
        let found = curves(study.wheel(), &Plan::of(study.one_wheel().unwrap())).unwrap();
        assert!(found.are_complete(), "{at} {by}");
    }
}

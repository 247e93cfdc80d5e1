//! Tests of force curves of springs and bump stops, between and beyond their points.

use super::commands::{run, study};
use crate::support::one_line;
use hardpoint::axle::ForceCurve;

/// The manual's example, calculated by hand: the slopes are 176/3 and 3850/23 at the neighbours of 15 mm. So the cubic
/// is below the straight line by 1.25 times the difference of these slopes.
#[test]
fn a_force_curve_is_the_cubic_that_the_manual_describes() {
    let points = [[0.0, 0.0], [10.0, 400.0], [20.0, 1500.0], [30.0, 5000.0]];
    let curve = ForceCurve::through(&points).unwrap();
    let at = |x: f64| -> f64 { curve.at(x) };
    let wanted: f64 = 950.0 + 1.25 * (176.0 / 3.0 - 3850.0 / 23.0);
    assert!((at(15.0) - wanted).abs() < 1e-10, "{}", at(15.0));
    assert!((wanted - 814.0).abs() < 0.1);
    // Beyond the ends the curve continues with the slope of the first or last pair of points.
    assert!((at(34.0) - (5000.0 + 4.0 * 350.0)).abs() < 1e-9);
    assert!((at(-3.0) + 3.0 * 40.0).abs() < 1e-9);
}

/// The program warns of a motion that leaves the range of a force curve, and states the travel and both lengths. A
/// motion within the range causes no warning.
#[test]
fn travels_beyond_a_force_curve_are_named() {
    let path = study("macpherson_axle.toml");
    let path = path.to_str().unwrap();
    let outputs = "outputs.characteristics=[\"wheel_load\"]";
    let check = |more: &[&str]| {
        let mut arguments = vec!["check", path, "--set", outputs];
        arguments.extend(more.iter().flat_map(|set| ["--set", set]));
        let (said, doubts) = run(&arguments, 0);
        one_line(&(said + &doubts))
    };
    let motion = "motion={ travel_left = [0.0, 60.0], travel_right = [-10.0, 20.0] }";
    let short =
        "bump_stop={ gap = 20.0, force_curve = [[0.0, 0.0], [10.0, 400.0], [20.0, 1500.0]] }";
    let said = check(&[motion, short]);
    assert!(
        said.contains("left wheel at travel 60 mm: the bump stop is compressed by"),
        "{said}"
    );
    assert!(
        said.contains("beyond the end of its force_curve at 20 mm"),
        "{said}"
    );
    assert!(!said.contains("right wheel at travel"), "{said}");
    let long =
        "bump_stop={ gap = 20.0, force_curve = [[0.0, 0.0], [10.0, 400.0], [60.0, 9000.0]] }";
    let said = check(&[motion, long]);
    assert!(!said.contains("force_curve at"), "{said}");
    // The strut is 483 mm long in the design position, and longer in droop.
    let spring = "spring={ force_curve = [[420.0, 6000.0], [485.0, 3800.0]] }";
    let said = check(&[motion, long, spring]);
    assert!(
        said.contains("right wheel at travel -10 mm: the spring is"),
        "{said}"
    );
    assert!(
        said.contains("beyond the end of its force_curve at 485 mm"),
        "{said}"
    );
}

/// Columns of the curves that the command writes to standard output.
fn columns(path: &str, sets: &[&str], names: &[&str]) -> Vec<Vec<f64>> {
    let mut arguments = vec!["--quiet", "solve", path, "--out", "-"];
    arguments.extend(sets.iter().flat_map(|set| ["--set", set]));
    let (csv, _) = run(&arguments, 0);
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let rows: Vec<Vec<&str>> = lines.collect();
    let column = |name: &&str| {
        let place = header.iter().position(|h| h == name).unwrap();
        rows.iter().map(|row| row[place].parse().unwrap()).collect()
    };
    names.iter().map(column).collect()
}

/// The test moves the pads of a rig by the travels plus the tyre deflections. The roll stiffness with tyres is the
/// slope of the moment over the angle of the line through both pads. The slope comes from finite differences of eighth
/// order over opposite travels. Without tyres, this slope is `roll_stiffness`.
#[test]
fn tyres_are_in_series_with_the_roll_stiffness() {
    const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    const STEP: f64 = 2.0;
    for (name, radius, rate) in [
        ("macpherson_axle.toml", 310.0, 220.0),
        ("double_wishbone_axle.toml", 228.0, 110.0),
    ] {
        let path = study(name);
        let path = path.to_str().unwrap();
        let pads = "motion={ travel_left = [-8.0, -6.0, -4.0, -2.0, 2.0, 4.0, 6.0, 8.0], \
                    travel_right = [8.0, 6.0, 4.0, 2.0, -2.0, -4.0, -6.0, -8.0] }";
        let asked = "outputs={ characteristics = [\"camber\", \"track\", \"wheel_load\", \"roll_moment\"] }";
        let wheel = format!("wheel.radius={radius:?}");
        let tyre = format!("tyre={{ rate = {rate:?} }}");
        let names = [
            "left_camber_deg",
            "right_camber_deg",
            "track_mm",
            "left_wheel_load_N",
            "right_wheel_load_N",
            "roll_moment_N_m",
            "travel_left_mm",
            "travel_right_mm",
        ];
        // Selects the stations with opposite travels from all combinations of travels.
        let all = columns(path, &[pads, asked, &wheel, &tyre], &names);
        let is_opposite = |station: &usize| all[6][*station] == -all[7][*station];
        let opposite: Vec<usize> = (0..all[0].len()).filter(is_opposite).collect();
        let found: Vec<Vec<f64>> = all
            .iter()
            .map(|column| opposite.iter().map(|station| column[*station]).collect())
            .collect();
        let stations = found[0].len();
        assert_eq!(stations, 8, "{name}");
        let angle = |station: usize, yields: f64| {
            let side = |camber: usize, load: usize, travel: f64| {
                let below = radius * found[camber][station].to_radians().cos();
                travel - below + yields * found[load][station] / rate
            };
            let travel = found[6][station];
            let rise = side(0, 3, travel) - side(1, 4, -travel);
            rise.atan2(found[2][station])
        };
        // Stations go from -4 to 4 steps of the left travel, without 0.
        let slope = |value: &dyn Fn(usize) -> f64| -> f64 {
            let pairs = WEIGHTS.iter().enumerate();
            let sum =
                pairs.map(|(k, w)| w * (value(stations / 2 + k) - value(stations / 2 - 1 - k)));
            sum.sum::<f64>() / STEP
        };
        let moment = slope(&|s| found[5][s]);
        let stiffness = |yields| -(moment / slope(&|s| angle(s, yields).to_degrees()));
        let at_design = "motion={ travel_left = [0.0], travel_right = [0.0] }";
        let asked = "outputs={ characteristics = [\"roll_stiffness\", \"roll_stiffness_with_tyres\", \"ride_rate\", \"ride_rate_without_tyres\"] }";
        let names = [
            "roll_stiffness_N_m_per_deg",
            "roll_stiffness_with_tyres_N_m_per_deg",
            "ride_rate_N_per_mm",
            "ride_rate_without_tyres_N_per_mm",
        ];
        let exact = columns(path, &[at_design, asked, &wheel, &tyre], &names);
        for (yields, exact) in [(0.0, exact[0][0]), (1.0, exact[1][0])] {
            let error = (stiffness(yields) / exact - 1.0).abs();
            assert!(error < 1e-7, "{name}: {} and {exact}", stiffness(yields));
        }
        assert!(exact[1][0] < 0.95 * exact[0][0]);
        let series = 1.0 / exact[2][0] - 1.0 / exact[3][0] - 1.0 / rate;
        assert!(series.abs() * rate < 1e-12, "{name}: {series}");
    }
}

/// The program warns if a spring would pull somewhere in the motion, and the warning states the force. A preloaded
/// spring causes no warning.
#[test]
fn a_spring_that_pulls_is_warned_of() {
    let path = study("double_wishbone_axle.toml");
    let path = path.to_str().unwrap();
    let solved = |force: &str| {
        let force = format!("spring.force={force}");
        let outputs = "outputs.characteristics=[\"spring_force\"]";
        let motion = "motion={ heave = [-40.0, 0.0, 40.0], roll = 1.0 }";
        let sets = ["--set", &force, "--set", outputs, "--set", motion];
        let (csv, said) = run(&[&["solve", path, "--out", "-"][..], &sets].concat(), 0);
        let mut rows = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let header = rows.next().unwrap();
        let rows: Vec<Vec<&str>> = rows.collect();
        let of = |side: &str| {
            let name = format!("{side}_spring_force_N");
            let column = header.iter().position(|column| **column == name).unwrap();
            rows.iter()
                .map(move |row| row[column].parse::<f64>().unwrap())
        };
        let least = ["left", "right"]
            .into_iter()
            .flat_map(of)
            .fold(f64::INFINITY, f64::min);
        (least, one_line(&said))
    };
    let (least, said) = solved("100.0");
    assert!(least < 0.0, "{least}");
    let (_, rest) = said.split_once("spring falls to ").unwrap();
    let (force, rest) = rest
        .split_once(" N at roll 1 deg, heave -40 mm: there the spring would pull")
        .unwrap();
    assert!(
        (force.parse::<f64>().unwrap() - least).abs() < 1e-3 * least.abs(),
        "{said}"
    );
    assert!(!rest.contains("would pull"), "{said}");
    let (least, said) = solved("3000.0");
    assert!(least > 0.0 && !said.contains("would pull"), "{said}");
}

/// The warning about `c_factor` states, in the axes of the study, the sign that turns the wheels in the direction of
/// the steering wheel.
#[test]
fn a_c_factor_of_the_wrong_sign_is_doubted_with_the_right_one() {
    for (name, wrong, words) in [
        (
            "double_wishbone_axle",
            "-80.0",
            "move to the left: give a c_factor above 0",
        ),
        (
            "macpherson_axle",
            "52.0",
            "move to the right: give a c_factor below 0",
        ),
    ] {
        let path = study(&format!("{name}.toml"));
        let set = format!("steering.c_factor={wrong}");
        let (said, _) = run(&["check", path.to_str().unwrap(), "--set", &set], 0);
        let said = one_line(&said);
        assert!(said.contains(words), "{said}");
    }
}

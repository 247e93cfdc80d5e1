//! Tests of motions of an axle over time: against those of one wheel, and against slopes of the curves with respect to
//! time.

use super::tuning::{evaluate, layout};
use super::{commands, sample as study, value};
use hardpoint::curves::{Curves, curves};
use hardpoint::plan::Plan;
use hardpoint::study::Study;
use nalgebra::DVector;
use std::path::Path;

fn solved(overrides: &[&str]) -> Curves {
    super::solved("macpherson_axle", overrides)
}

const ASKED: &str = "outputs={characteristics=[\"camber\", \"toe\", \"track\", \"wheel_load\"], \
    points=[\"wheel_centre\", \"tie_rod_outer\"], knuckle=true, order=\"acceleration\"}";

/// Velocities equal the slopes of the values, and accelerations equal the slopes of the velocities, by finite
/// differences of eighth order.
#[test]
fn derivatives_by_time_are_slopes() {
    let step = 1.0 / 64.0;
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let slope = |at: &dyn Fn(usize) -> f64| {
        let pairs = weights.iter().enumerate();
        pairs.map(|(k, w)| w * (at(5 + k) - at(3 - k))).sum::<f64>() / step
    };
    for (drive, held) in [
        ("heave", ""),
        ("heave", "roll=[-1.0, 2.0], rack=4.0, "),
        ("roll", "heave=[0.0, 10.0], rack=[0.0, 4.0], "),
        ("rack", "roll=1.0, heave=5.0, "),
        ("steering_wheel_angle", "heave=5.0, "),
        (
            "travel_left",
            "travel_right=[0.0, 12.0], ground=\"plane\", ",
        ),
        ("travel_right", "travel_left=[0.0, 12.0], rack=[0.0, 4.0], "),
    ] {
        let half = 4.0 * step;
        let motion = format!(
            "motion={{{held}drive=\"{drive}\", time={{polynomial=[1.0, 2.0, -3.0, 0.5], from={}, to={}, steps=9}}}}",
            0.5 - half,
            0.5 + half
        );
        let found = solved(&[ASKED, &motion]);
        let time = found.motion.iter().position(|m| m.key == "time").unwrap();
        let places: Vec<Vec<u64>> = (found.stations.iter())
            .map(|s| s.at.iter().map(|at| at.unwrap().to_bits()).collect())
            .collect();
        // Stations of each combination of the other coordinates, in order of time.
        let driven = found.motion.iter().position(|m| m.key == drive).unwrap();
        let given: Vec<usize> = (0..found.motion.len())
            .filter(|k| found.motion[*k].is_given && ![time, driven].contains(k))
            .collect();
        let key = |station: usize| {
            given
                .iter()
                .map(|k| places[station][*k])
                .collect::<Vec<_>>()
        };
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for station in 0..places.len() {
            match groups.iter_mut().find(|g| key(g[0]) == key(station)) {
                Some(group) => group.push(station),
                None => groups.push(vec![station]),
            }
        }
        let (mut seen, count) = (0, groups.len());
        for group in groups {
            let times: Vec<f64> = group
                .iter()
                .map(|s| found.stations[*s].at[time].unwrap())
                .collect();
            assert_eq!(times.len(), 9, "{drive} {held}");
            assert!(times.is_sorted(), "{drive} {held}: {times:?}");
            for column in &found.columns {
                let Some(lower) = [
                    ("_d1_", "_per_s"),
                    ("_d2_", "_per_s2"),
                    ("_vx_", "_per_s"),
                    ("_az_", "_per_s2"),
                ]
                .iter()
                .find_map(|(mark, per)| {
                    let stem = column.name.strip_suffix(per)?;
                    Some(match *mark {
                        "_d1_" => stem.replacen("_d1_", "_", 1),
                        "_d2_" => format!("{}_per_s", stem.replacen("_d2_", "_d1_", 1)),
                        "_vx_" => stem.replacen("_vx_", "_x_", 1),
                        _ => format!("{}_per_s", stem.replacen("_az_", "_vz_", 1)),
                    })
                    .filter(|_| stem.contains(mark))
                }) else {
                    continue;
                };
                let own = value(&found, group[4], &column.name);
                let expected = slope(&|k| value(&found, group[k], &lower));
                let size = own
                    .abs()
                    .max(value(&found, group[4], &lower).abs())
                    .max(1e-3);
                // Rounding errors of the values, divided by the step. Measured: at most 8e-11.
                assert!(
                    (own - expected).abs() < 2e-9 * size,
                    "{drive} {held} {}: {own} {expected}",
                    column.name
                );
                seen += 1;
            }
        }
        // The four characteristics have seven columns with two derivatives each. For two points of both wheels, the test takes
        // the velocity along x and the acceleration along z.
        assert_eq!(seen, count * (7 * 2 + 2 * 2 * 2), "{drive}");
    }
}

/// Both wheels of an axle in heave over time have the curves of one wheel in travel over time.
#[test]
fn heave_over_time_is_the_travel_of_one_wheel_over_time() {
    let time = "time={polynomial=[-20.0, 30.0, 4.0], from=0.0, to=1.5, steps=7}";
    let asked = "outputs={characteristics=[\"camber\", \"toe\"], points=[\"wheel_centre\"], knuckle=true, order=\"acceleration\"}";
    let both = solved(&[asked, &format!("motion={{{time}}}")]);
    let text = crate::support::sample("macpherson_axle.toml");
    let kept = |name: &str| {
        ![
            "[axle",
            "[steering",
            "[spring",
            "[bump",
            "[rebound",
            "[anti",
            "[tyre",
            "[outputs",
            "[motion",
        ]
        .iter()
        .any(|prefix| name.starts_with(prefix))
    };
    let mut keeps = true;
    let mut one = String::new();
    for line in text.lines() {
        if line.starts_with('[') {
            keeps = kept(line);
        }
        if keeps {
            one += line;
            one.push('\n');
        }
    }
    one += &format!("[motion]\n{}\n", time.replacen("time=", "time = ", 1));
    one += &asked
        .replacen("outputs={", "[outputs]\n", 1)
        .replace("], ", "]\n")
        .replace(", order", "\norder")
        .replace('}', "");
    let own = Study::from_text("one", &one, Path::new("")).unwrap_or_else(|e| panic!("{e}\n{one}"));
    let wheel = own.one_wheel().unwrap();
    let own = curves(&wheel.suspension, &Plan::of(wheel)).unwrap();
    let mut seen = 0;
    for column in own.columns.iter().filter(|c| c.name.contains("_per_s")) {
        for station in 0..7 {
            let expected = value(&own, station, &column.name);
            let found = value(&both, station, &format!("left_{}", column.name));
            let size = expected.abs().max(1e-3);
            assert!(
                (found - expected).abs() < 1e-12 * size,
                "{} at {station}: {found} {expected}",
                column.name
            );
            seen += 1;
        }
    }
    assert_eq!(seen, 7 * (2 * 2 + 3 * 2 + 3 * 2));
}

#[test]
fn what_time_does_not_go_with_is_refused() {
    let time = "time={polynomial=[0.0, 1.0], from=0.0, to=1.0, steps=3}";
    for (motion, said) in [
        (
            format!("heave=1.0, {time}"),
            "already gives the drive values; expected either heave or",
        ),
        (
            "heave=1.0, drive=\"heave\"".to_owned(),
            "the drive of an axle selects the coordinate that moves over time",
        ),
        (
            format!("drive=\"travel\", {time}"),
            "unknown drive \"travel\"",
        ),
        (
            format!("drive=\"roll\", {time}, ground=\"pads\""),
            "roll needs a plane ground",
        ),
        (
            "time={polynomial=[0.0, 1e9], from=0.0, to=1e6, steps=3}".to_owned(),
            "grows beyond 1e12",
        ),
    ] {
        let refused = study("macpherson_axle", &[&format!("motion={{{motion}}}")]);
        let message = refused.expect_err(&motion);
        assert!(message.contains(said), "{motion}: {message}");
    }
    let named = study(
        "macpherson_axle",
        &[&format!(
            "motions.bump={{heave=1.0, drive=\"rack\", {time}}}"
        )],
    );
    let message = named.expect_err("a named motion");
    assert!(
        message.contains("not available in a named motion"),
        "{message}"
    );
}

/// A motion over time has values but no velocities in the design position.
#[test]
fn the_summary_has_no_velocity_in_the_design_position() {
    let (path, out) = (
        commands::study("macpherson_axle.toml"),
        commands::folder("over_time"),
    );
    let motion = "motion={drive=\"roll\",time={polynomial=[0.0,6.0],from=-0.5,to=0.5,steps=3}}";
    let asked = "outputs={characteristics=[\"camber\"],order=\"velocity\"}";
    let [path, out] = [&path, &out].map(|p| p.to_str().unwrap());
    commands::run(
        &["solve", path, "--set", motion, "--set", asked, "--out", out],
        0,
    );
    let summary = std::fs::read(format!("{out}/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
    let at_design = |name: &str| {
        let outputs = summary["outputs"].as_array().unwrap();
        let found = outputs.iter().find(|o| o["output"] == name);
        found.unwrap_or_else(|| panic!("{summary}"))["at_design"].clone()
    };
    let of_both =
        ["left", "right"].map(|side| at_design(&format!("{side}_camber_deg")).as_f64().unwrap());
    assert_eq!(of_both[0], of_both[1], "the design is symmetric");
    assert!(at_design("left_camber_d1_deg_per_s").is_null());
}

/// A target over a coordinate that moves over time applies at the values of its law at the given times. It has the same
/// residuals and derivatives as with a list of these values, bit for bit.
#[test]
fn targets_apply_at_the_values_of_the_law() {
    for (drive, polynomial, steps, list, characteristic) in [
        (
            "roll",
            "[-2.0, 4.0]",
            5,
            "[-2.0, -1.0, 0.0, 1.0, 2.0]",
            "camber_to_road",
        ),
        (
            "heave",
            "[-20.0, 40.0]",
            3,
            "[-20.0, 0.0, 20.0]",
            "bump_steer",
        ),
        (
            "steering_wheel_angle",
            "[-90.0, 180.0]",
            3,
            "[-90.0, 0.0, 90.0]",
            "ackermann_error",
        ),
    ] {
        for over in [String::new(), format!(", over = \"{drive}\"")] {
            let residuals = |motion: &str| {
                let target = format!(
                    "optimise.targets=[{{ characteristic = \"{characteristic}\"{over}, between = [-0.001, 0.001], tolerance = 0.1 }}]"
                );
                let motion = format!("motion={{ {motion} }}");
                let read = study("macpherson_axle_front", &[&motion, &target]);
                let study = read.unwrap_or_else(|e| panic!("{drive}: {e}"));
                let variables = study.optimise.as_ref().unwrap().variables.len();
                evaluate(
                    &study,
                    &layout(&study),
                    &DVector::from_element(variables, 2.0),
                )
            };
            let over_time = residuals(&format!(
                "drive = \"{drive}\", time = {{ polynomial = {polynomial}, from = 0.0, to = 1.0, steps = {steps} }}"
            ));
            let listed = residuals(&format!("{drive} = {list}"));
            assert!(listed.residuals.len() >= steps, "{drive}");
            assert!(listed.jacobian.amax() > 0.0, "{drive}");
            assert_eq!(over_time.residuals, listed.residuals, "{drive}");
            assert_eq!(over_time.jacobian, listed.jacobian, "{drive}");
        }
    }
}

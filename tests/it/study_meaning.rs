//! Tests of the meaning of a study: units, frames, defaults, overrides, and studies written back.

use hardpoint::characteristics::Characteristic;
use hardpoint::curves::wheel_curves;
use hardpoint::model::{Body, PointId, SpinAxis, Topology};
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::study::{Designs, Drive, Interpolation, Order, Study, Wanted};
use proptest::prelude::*;
use std::fs;
use std::path::Path;

const SOLVE: &str = include_str!("../../studies/macpherson_solve.toml");
const FRONT: &str = include_str!("../../studies/macpherson_front.toml");
const BUMP_STEER: &str = include_str!("../../studies/macpherson_bump_steer.toml");

fn read(text: &str) -> Study {
    Study::from_text("study.toml", text, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

fn with_overrides(overrides: &[&str]) -> Study {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.toml");
    fs::write(&path, SOLVE).unwrap();
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
    Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn the_sample_studies_mean_what_they_say() {
    for topology in Topology::ALL {
        read(topology.template);
    }
    let solve = read(SOLVE);
    assert_eq!(solve.motion().values.len(), 41);
    assert_eq!(solve.motion().values[20].to_bits(), 0);
    assert_eq!(
        (solve.motion().drive, solve.motion().rack_moves),
        (Drive::Travel, false)
    );
    assert_eq!(solve.one_wheel().unwrap().outputs.order, Order::Position);
    let id = solve.wheel().mechanism.point("wheel_centre").unwrap();
    assert_eq!(solve.wheel().design[id.0], Vector3::new(0.0, 760.0, 300.0));

    let front = read(FRONT).optimise.unwrap();
    assert_eq!(front.variables.len(), 7);
    let wanted: Vec<_> = front
        .targets
        .iter()
        .map(|t| t.of.as_characteristic())
        .collect();
    assert_eq!(
        wanted,
        [
            Some(Characteristic::Camber),
            Some(Characteristic::KingpinInclination),
            Some(Characteristic::Toe)
        ]
    );
    read(BUMP_STEER);
}

/// The optional keys that the template shows in comments are valid if the comment signs are removed.
#[test]
fn the_templates_optional_keys_are_good() {
    let optional = |line: &str| {
        let body = line.strip_prefix("# ").unwrap_or(line);
        let commented = body.starts_with('[')
            || body.split_once(" = ").is_some_and(|(key, _)| {
                key.trim()
                    .chars()
                    .all(|c| c.is_ascii_lowercase() || c == '_')
            })
            || body.starts_with("  {")
            || body.starts_with(']');
        let exclusive = [
            "drive",
            "arm_angle",
            "theta",
            "angle_unit",
            "time",
            "static_",
        ];
        if line.starts_with("# ") && commented && !exclusive.iter().any(|key| body.starts_with(key))
        {
            body.to_owned()
        } else {
            line.to_owned()
        }
    };
    let text: Vec<String> = SOLVE.lines().map(optional).collect();
    let study = read(&text.join("\n"));
    assert_eq!(study.optimise.as_ref().unwrap().targets.len(), 2);
    assert_eq!(study.wheel().vehicle.cg_height, Some(540.0));
    assert!(study.one_wheel().unwrap().outputs.knuckle);
    let mechanism = &study.wheel().mechanism;
    assert!(mechanism.point("strut_upper").is_some());
    let seat = mechanism.point("spring_seat").unwrap();
    assert_eq!(seat, PointId(mechanism.points.len() - 1));
    assert!(matches!(mechanism.body(seat), Body::Arm(_)));
}

#[test]
fn other_frames_and_sides_are_the_same_suspension() {
    let left = read(SOLVE);
    for (side, frame, signs) in [
        ("right", "iso8855", [1.0, -1.0, 1.0]),
        ("left", "sae_j670", [1.0, -1.0, -1.0]),
        ("right", "x_rear", [-1.0, 1.0, 1.0]),
    ] {
        let mut text = SOLVE
            .replace("side = \"left\"", &format!("side = \"{side}\""))
            .replace("frame = \"iso8855\"", &format!("frame = \"{frame}\""));
        for (point, p) in left
            .wheel()
            .mechanism
            .points
            .iter()
            .zip(&left.wheel().design)
        {
            let [x, y, z] = [p.x * signs[0], p.y * signs[1], p.z * signs[2]];
            let at = text.find(&format!("\n{}", point.name)).unwrap() + 1;
            let end = at + text[at..].find('\n').unwrap();
            text.replace_range(at..end, &format!("{} = [{x:?}, {y:?}, {z:?}]", point.name));
        }
        assert_eq!(
            read(&text).wheel().design,
            left.wheel().design,
            "{side} {frame}"
        );
    }
}

#[test]
fn degrees_become_radians_once() {
    let study = with_overrides(&[
        "motion={ drive = \"arm_angle\", arm_angle = [-10, 0, 10], rack = [0.0] }",
        "optimise.variables=[{ hardpoint = \"strut_top\", axis = \"x\", range = [-1, 1] }]",
        "optimise.targets=[{ characteristic = \"camber\", at = 5, value = -1, tolerance = 0.1 }, \
         { characteristic = \"scrub_radius\", points = [[-20, 3], [20, 4]], tolerance = 2, interpolation = \"linear\" }]",
    ]);
    assert_eq!(study.motion().values[2], 10f64.to_radians());
    assert!(study.motion().rack_moves);
    let optimise = study.optimise.unwrap();
    assert_eq!(
        (optimise.starts, optimise.seed, optimise.max_iterations),
        (1, 1, 200)
    );
    let camber = &optimise.targets[0];
    assert_eq!(
        (camber.tolerance, camber.weight),
        (0.1f64.to_radians(), 1.0)
    );
    let wanted = Wanted::At {
        drive: 5f64.to_radians(),
        value: (-1f64).to_radians(),
    };
    assert_eq!(camber.wanted, wanted);
    let wanted = Wanted::Curve {
        points: vec![[(-20f64).to_radians(), 3.0], [20f64.to_radians(), 4.0]],
        interpolation: Interpolation::Linear,
    };
    assert_eq!(optimise.targets[1].wanted, wanted);

    let radians = with_overrides(&[
        "motion={ drive = \"arm_angle\", angle_unit = \"rad\", time = { polynomial = [0.0, 0.1, 0.05], from = 0, to = 2, steps = 3 } }",
    ]);
    assert_eq!(
        radians.motion().time.as_ref().unwrap().times,
        [0.0, 1.0, 2.0]
    );
    assert_eq!(
        radians.motion().values,
        [0.0, 0.1 + 0.05, (0.05 * 2.0 + 0.1) * 2.0]
    );
}

#[test]
fn static_angles_are_those_of_the_catalogue() {
    let text = SOLVE
        .replace("spindle_inner    =", "# spindle_inner =")
        .replace("# static_camber =", "static_camber =")
        .replace("# static_toe =", "static_toe =");
    let SpinAxis::Along(a) = read(&text).wheel().mechanism.spin_axis else {
        panic!("the spin axis is given by angles");
    };
    assert!((a.norm() - 1.0).abs() < 1e-15);
    assert!((-a.z.asin().to_degrees() - -0.5).abs() < 1e-14);
    assert!((a.x.atan2(a.y).to_degrees() - 0.1).abs() < 1e-14);
}

/// The program accepts the geometry of the 2003 paper. Its wheel has an unusual position, but is on the correct side.
#[test]
fn the_papers_example_is_accepted() {
    let study = read(
        r#"
[suspension]
topology = "macpherson"
length_unit = "m"
[suspension.hardpoints]
lower_arm_front = [1.495, 0.05, -0.08]
lower_arm_rear = [1.175, 0.05, -0.08]
tie_rod_inner = [1.11, -0.02, 0.06]
strut_top = [1.38, 0.28, 0.49]
lower_ball_joint = [1.495, 0.3565647, 0.1168429]
strut_lower = [1.529685357811275, 0.4173056073449779, 0.08845116878698639]
strut_upper = [1.47979023854085, 0.3715370715633186, 0.2223007791913243]
tie_rod_outer = [1.29423, 0.39064, 0.20407]
wheel_centre = [1.60607, 0.39391, 0.04829]
spindle_inner = [1.47979023854085, 0.3715370715633186, 0.2223007791913243]
[motion]
drive = "arm_angle"
angle_unit = "rad"
time = { polynomial = [0.0, 1.0, 1.0], from = 0.0, to = 0.5, steps = 11 }
"#,
    );
    assert_eq!(study.one_wheel().unwrap().outputs.characteristics.len(), 4);
}

/// Drive values of targets have the unit of the motion, so the same targets in degrees and in radians are equal. A file
/// of target points has degrees, as its column name states.
#[test]
fn drive_values_of_targets_are_in_the_unit_of_the_motion() {
    let directory = tempfile::tempdir().unwrap();
    let rows = "arm_angle_deg,camber_deg\n-4,0.2\n0,-0.5\n4,-1.0\n";
    fs::write(directory.path().join("curve.csv"), rows).unwrap();
    let motions = |unit: &str, angle: f64| {
        format!(
            "drive = \"arm_angle\"\nangle_unit = \"{unit}\"\narm_angle = [{:?}, 0.0, {angle:?}]\n",
            -angle
        )
    };
    let study = |unit: &str, per_degree: f64| {
        let (head, _) = SOLVE.split_once("[motion]").unwrap();
        let angle = |degrees: f64| format!("{:?}", degrees * per_degree);
        let own = motions(unit, 4.0 * per_degree);
        let text = format!(
            "{head}[motion]\n{own}[motions.other]\n{own}[optimise]\n\
             variables = [{{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-5.0, 5.0] }}]\n\
             targets = [\n\
             {{ characteristic = \"camber\", at = {two}, value = -0.5, tolerance = 0.1 }},\n\
             {{ characteristic = \"camber\", at = {two}, value = -0.5, tolerance = 0.1, motion = \"other\" }},\n\
             {{ characteristic = \"toe\", points = [[0.0, 0.1], [{two}, 0.2]], tolerance = 0.1 }},\n\
             {{ characteristic = \"toe\", at_least = [[0.0, -0.1], [{two}, -0.2]], tolerance = 0.1 }},\n\
             {{ characteristic = \"camber\", file = \"curve.csv\", tolerance = 0.1 }},\n\
             ]\n",
            two = angle(2.0)
        );
        Study::from_text("study.toml", &text, directory.path()).unwrap_or_else(|e| panic!("{e}"))
    };
    let [degrees, radians] =
        [("deg", 1.0), ("rad", 1.0_f64.to_radians())].map(|(u, f)| study(u, f));
    let targets = |study: &Study| study.optimise.as_ref().unwrap().targets.clone();
    assert_eq!(targets(&degrees), targets(&radians));
    assert!(
        matches!(targets(&radians)[0].wanted, Wanted::At { drive, .. } if drive == 2.0_f64.to_radians())
    );
    // The study that contains the curve in its text has the same targets.
    let inside = Study::from_text("inside.toml", &radians.text, Path::new(".")).unwrap();
    assert_eq!(targets(&inside), targets(&radians));
}

/// The program refuses a drive value beyond a motion in radians. The message gives the range in radians.
#[test]
fn the_range_of_a_motion_in_radians_is_told_in_radians() {
    let (head, _) = SOLVE.split_once("[motion]").unwrap();
    let text = format!(
        "{head}[motion]\ndrive = \"arm_angle\"\nangle_unit = \"rad\"\narm_angle = [-0.1, 0.0, 0.1]\n[optimise]\n\
         variables = [{{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-5.0, 5.0] }}]\n\
         targets = [{{ characteristic = \"camber\", at = 2.0, value = -0.5, tolerance = 0.1 }}]\n"
    );
    let error = Study::from_text("study.toml", &text, Path::new(".")).unwrap_err();
    let said = "2 is outside of the motion, which runs from -0.1 to 0.1 radians";
    assert!(error.to_string().contains(said), "{error}");
}

#[test]
fn overrides_edit_the_text_and_keep_its_comments() {
    let study = with_overrides(&[
        "motion.travel.steps=5",
        "motion.rack={ from = -10, to = 10, steps = 3 }",
        "suspension.hardpoints.strut_top.2=860",
        "vehicle.wheelbase=2700",
        "outputs.order=velocity",
    ]);
    assert_eq!(study.name, "mine");
    assert_eq!(study.motion().values, [-80.0, -40.0, 0.0, 40.0, 80.0]);
    assert_eq!(study.motion().rack, [-10.0, 0.0, 10.0]);
    assert_eq!(study.wheel().vehicle.wheelbase, Some(2700.0));
    assert_eq!(study.one_wheel().unwrap().outputs.order, Order::Velocity);
    assert!(
        study
            .text
            .contains("[ -35.0, 575.0, 860]   # upper strut mount on the body")
    );
    assert!(
        study
            .text
            .contains("# displacement of tie_rod_inner along +y")
    );
}

#[test]
fn a_sweep_says_what_moves() {
    let study = read(&format!(
        r#"{SOLVE}
[sweep]
samples = 100
method = "saltelli"
variables = [
  {{ hardpoint = "tie_rod_inner", axis = "z", range = [-10, 10] }},
  {{ hardpoint = "strut_top", axis = "y", range = [560, 590], absolute = true }},
  {{ hardpoints = ["lower_arm_front", "lower_arm_rear"], factors = [1, -1], axis = "z", range = [-3, 3] }},
]
"#
    ));
    let sweep = study.sweep.as_ref().unwrap();
    let Designs::Sampled(sampled) = &sweep.designs else {
        panic!("{sweep:?}");
    };
    assert_eq!((sampled.designs(), sampled.seed), (500, 1));
    let names: Vec<&str> = sampled.variables.iter().map(|v| v.name.as_str()).collect();
    let pair = "lower_arm_front+lower_arm_rear_dz";
    assert_eq!(names, ["tie_rod_inner_dz", "strut_top_y", pair]);
    let at_design: Vec<Option<f64>> = sampled
        .variables
        .iter()
        .map(|v| v.at_design(study.wheel()))
        .collect();
    assert_eq!(at_design, [Some(0.0), Some(575.0), Some(0.0)]);
    let factors: Vec<f64> = sampled.variables[2]
        .moves
        .iter()
        .map(|m| m.factor)
        .collect();
    assert_eq!(factors, [1.0, -1.0]);
}

/// The files of a study stay in its directory if its text is changed.
#[test]
fn a_changed_study_finds_its_files() {
    let text = format!("{SOLVE}\n[sweep]\ndesigns = \"designs.csv\"\n");
    let study = Study::from_text("study.toml", &text, Path::new("elsewhere")).unwrap();
    let changed = study.with_overrides("study.toml", &["motion.rack=1.0".to_owned()]);
    let again = study.read_again("study.toml", &study.text);
    for other in [changed, again] {
        let other = other.unwrap();
        let designs = other.sweep.unwrap().designs;
        assert_eq!(designs, Designs::File("elsewhere/designs.csv".into()));
        assert_eq!(other.inputs, study.inputs);
    }
    // Values that replace the name of a file are names in the same directory.
    let file = ["sweep.designs=\"other.csv\"".to_owned()];
    let changed = study.with_overrides("study.toml", &file).unwrap();
    let designs = changed.sweep.unwrap().designs;
    assert_eq!(designs, Designs::File("elsewhere/other.csv".into()));
}

/// Only a sweep reads the file of designs. So a study whose file of designs is missing can still be solved.
#[test]
fn designs_from_a_file_do_not_stand_in_the_way() {
    let study = read(&format!("{SOLVE}\n[sweep]\ndesigns = \"absent.csv\"\n"));
    let designs = study.sweep.unwrap().designs;
    assert!(matches!(designs, Designs::File(path) if path.ends_with("absent.csv")));
}

#[test]
fn only_moved_coordinates_are_rewritten() {
    let study = read(FRONT);
    assert_eq!(study.with_points_of(&study), FRONT);
    let mut design = study.wheel().design.clone();
    let moved = study.wheel().mechanism.point("tie_rod_inner").unwrap();
    design[moved.0].z = 0.1 + 0.2;
    let text = study.with_points_of(&study.at_design(design));
    let changed: Vec<_> = FRONT
        .lines()
        .zip(text.lines())
        .filter(|(a, b)| a != b)
        .collect();
    assert_eq!(changed.len(), 1);
    assert!(
        changed[0].1.contains("330.0, 0.30000000000000004]"),
        "{}",
        changed[0].1
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A written design is bit-identical after reading it again, in every frame.
    #[test]
    fn designs_survive_being_written(
        offsets in prop::collection::vec(-10.0..10.0f64, 30),
        right_in_x_rear: bool,
    ) {
        let mut text = SOLVE.to_owned();
        if right_in_x_rear {
            // For a right wheel with y to the right, the y values are the same and x is reversed.
            text = text.replace("\"left\"", "\"right\"").replace("\"iso8855\"", "\"x_rear\"");
        }
        let study = read(&text);
        let design: Vec<_> = study.wheel().design.iter().zip(offsets.chunks_exact(3))
            .map(|(p, o)| Vector3::new(p.x + o[0], p.y + o[1], p.z * (1.0 + o[2] / 100.0)))
            .collect();
        let again = read(&study.with_points_of(&study.at_design(design.clone())));
        for (read, written) in again.wheel().design.iter().zip(&design) {
            let bits = |v: &Vector3<f64>| v.to_array().map(f64::to_bits);
            prop_assert_eq!(bits(read), bits(written));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// A randomly damaged study is read as a study or refused with a printable error.
    #[test]
    fn mutilated_studies_are_refused_without_panic(
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0..12usize, any::<prop::sample::Index>()), 1..4),
        which in 0..3usize,
    ) {
        const SNIPPETS: &[&str] = &[
            "", "\"", "[", "]", "{", "}", "=", "-", "nan", "1e999", "é", "\u{feff}", "\r\n", "\0", "#",
            "[[optimise.targets]]", "0", ".", ",", "2026-01-01", "true", "'''", "[motion]", "9223372036854775807",
        ];
        let mut text = [SOLVE, FRONT, BUMP_STEER][which].to_owned();
        for (at, length, snippet) in cuts {
            let boundaries: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
            let place = at.index(boundaries.len());
            let end = boundaries[(place + length).min(boundaries.len() - 1)];
            text.replace_range(boundaries[place]..end, snippet.get::<&str>(SNIPPETS));
        }
        if let Err(errors) = Study::from_text("study.toml", &text, Path::new(".")) {
            prop_assert!(!errors.render(true).is_empty());
            prop_assert!(errors.all().iter().all(|e| !e.message().is_empty()));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Overrides (`--set`) of any key path are accepted or refused with a printable error.
    #[test]
    fn overrides_are_taken_or_refused_without_panic(
        path in prop::collection::vec(any::<prop::sample::Index>(), 1..5),
        value in any::<prop::sample::Index>(),
    ) {
        const KEYS: &[&str] = &[
            "suspension", "hardpoints", "strut_top", "optimise", "variables", "targets", "points", "0", "7",
            "motion", "travel", "from", "time", "outputs", "order", "\"a b\"", "", "wheel", "[x]",
        ];
        const VALUES: &[&str] = &["0", "[1, 2]", "{ a = 1 }", "nan", "text", "", "[", "\"", "true", "1=2"];
        let keys: Vec<&str> = path.iter().map(|index| *index.get::<&str>(KEYS)).collect();
        let set = format!("{}={}", keys.join("."), value.get::<&str>(VALUES));
        let front = crate::support::studies().join("macpherson_front.toml");
        if let Err(errors) = Study::read(&front, &[set]) {
            prop_assert!(errors.to_string().contains("--set"));
        }
    }
}

/// If a drawing leaves out stations of a motion over time, each of the others keeps its time and its time derivatives.
#[test]
fn stations_of_a_drawing_keep_their_times() {
    let motion =
        "motion={ time = { polynomial = [-30.0, 50.0, 20.0], from = 0.0, to = 0.9, steps = 91 } }";
    let outputs = "outputs={ characteristics = [\"camber\", \"toe\"], order = \"velocity\" }";
    let study = with_overrides(&[motion, outputs]);
    let own = study.one_wheel().unwrap();
    let plan = Plan::of(own);
    let all = wheel_curves(own, &plan).unwrap();
    let few = wheel_curves(own, &plan.thinned(46, 3)).unwrap();
    assert_eq!((all.stations.len(), few.stations.len()), (91, 46));
    assert_eq!(few.motion.len(), 3);
    for (number, few) in few.stations.iter().enumerate() {
        let all = &all.stations[2 * number];
        assert_eq!(few.at, all.at);
        for (a, b) in few.values.iter().zip(&all.values) {
            let (a, b) = (a.unwrap(), b.unwrap());
            assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} {b}");
        }
    }
}

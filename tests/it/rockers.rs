//! Tests of studies with rockers as a user runs them: limits, outputs and refusals.

use crate::support::{larger, one_line};
use assert_cmd::Command;
use hardpoint::curves::{Curves, Status, curves};
use hardpoint::model::Rod;
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::report::{CurveTable, curves_csv, remarks, sensitivities_csv};
use hardpoint::solve::Solver;
use hardpoint::study::{Study, StudyErrors};
use std::fs;
use std::path::Path;

fn sample() -> String {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    fs::read_to_string(studies.join("double_wishbone_pushrod.toml")).unwrap()
}

fn read(text: &str) -> Result<Study, StudyErrors> {
    Study::from_text("study.toml", text, Path::new("."))
}

/// Sample with some lines replaced. The start of a line identifies the line.
fn with_lines(lines: &[(&str, &str)]) -> String {
    let sample = sample();
    for (start, _) in lines {
        let count = sample.lines().filter(|l| l.starts_with(start)).count();
        assert_eq!(count, 1, "{start}");
    }
    let replaced = sample.lines().map(|line| {
        let found = lines.iter().find(|(start, _)| line.starts_with(start));
        found.map_or(line, |(_, line)| *line)
    });
    replaced.collect::<Vec<_>>().join("\n")
}

fn run(text: &str) -> (Study, Curves, CurveTable) {
    let study = read(text).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::of(study.one_wheel().unwrap());
    let found = curves(study.wheel(), &plan).unwrap();
    let csv = curves_csv(&found);
    (study, found, CurveTable::read(&csv).unwrap())
}

/// Pushrod whose rocker is 22.5 degrees (a quarter of a right angle) from its toggle in the design position.
const NEAR_TOGGLE: (&str, &str) = ("pushrod_inner ", "pushrod_inner = [0.0, 185.0, 486.0]");
const FAR: (&str, &str) = ("travel", "travel = { from = -60.0, to = 60.0, steps = 61 }");
const OUTPUTS: (&str, &str) = (
    "characteristics",
    "characteristics = [\"motion_ratio\", \"rocker_angle\", \"camber\"]",
);
const POINTS: (&str, &str) = (
    "points",
    "points = [\"pushrod_outer\", \"spring_lower\"]\nsensitivities = [\"pushrod_inner\"]",
);

/// If the study does not name the body of a drop link, the program uses the nearest body, if this is clear. It reports
/// this choice. If the study names the body, the program uses it without a message. With the drop link on the lower arm,
/// the bar of this study would turn less than half as far.
#[test]
fn a_drop_link_beside_a_rocker_is_never_assumed_silently() {
    let said = "drop_link_outer = \"rocker\"";
    let ratio = |text: &str| {
        let (study, found, _) = run(text);
        let columns = &found.columns;
        let ratio = columns
            .iter()
            .position(|c| c.output == "anti_roll_bar_motion_ratio");
        let middle = &found.stations[found.stations.len() / 2];
        let doubts = hardpoint::report::plausibility(study.wheel()).unwrap();
        (middle.values[ratio.unwrap()].unwrap(), doubts)
    };
    let outputs = (
        "characteristics",
        "characteristics = [\"anti_roll_bar_motion_ratio\"]",
    );
    let named = with_lines(&[outputs]);
    assert!(named.contains(said));
    let (wanted, doubts) = ratio(&named);
    assert!(
        !doubts.iter().any(|d| d.contains("drop_link_outer")),
        "{doubts:?}"
    );
    let (unnamed, doubts) = ratio(&named.replace(said, ""));
    assert_eq!(unnamed, wanted);
    let doubt = doubts
        .iter()
        .find(|d| d.contains("drop_link_outer"))
        .unwrap();
    for words in [
        "Assumed: rocker",
        "lower arm",
        "[suspension.bodies]",
        " mm away",
    ] {
        assert!(doubt.contains(words), "{doubt}");
    }
    // A point on the body itself has the distance 0.
    let at_rod = named
        .replace(said, "")
        .replace("[ -30.0,  160.0,  420.0]", "[   0.0,  265.0,  455.0]");
    let (_, doubts) = ratio(&at_rod);
    assert!(
        doubts.iter().any(|d| d.contains("rocker (0 mm away)")),
        "{doubts:?}"
    );
    let on_arm = named.replace(said, "drop_link_outer = \"lower_arm\"");
    let (arm, doubts) = ratio(&on_arm);
    assert!(
        !doubts.iter().any(|d| d.contains("drop_link_outer")),
        "{doubts:?}"
    );
    assert!(wanted.abs() > 2.0 * arm.abs(), "{wanted} {arm}");
    // A drop link near the lower arm is attached to that arm, and the program reports this too.
    let low = named
        .replace(said, "")
        .replace("[ -30.0,  160.0,  420.0]", "[ -30.0,  430.0,  150.0]")
        .replace("[ -30.0,  155.0,  330.0]", "[ -30.0,  425.0,  330.0]");
    let study = read(&low).unwrap();
    let mechanism = &study.wheel().mechanism;
    let link = mechanism.point("drop_link_outer").unwrap();
    assert!(matches!(
        mechanism.body(link),
        hardpoint::model::Body::Arm(_)
    ));
    let doubts = hardpoint::report::plausibility(study.wheel()).unwrap();
    assert!(
        doubts.iter().any(|d| d.contains("Assumed: lower arm")),
        "{doubts:?}"
    );
    // If points move far enough, the program attaches the drop link to another body. If the points do not move, the body
    // stays the same.
    let high = read(&named.replace(said, "")).unwrap();
    let (high, low) = (high.wheel(), study.wheel());
    assert!(high.mechanism.keeps_drop_link(&high.design));
    assert!(low.mechanism.keeps_drop_link(&low.design));
    assert!(!high.mechanism.keeps_drop_link(&low.design));
    assert!(!low.mechanism.keeps_drop_link(&high.design));
    assert!(
        read(&named)
            .unwrap()
            .wheel()
            .mechanism
            .keeps_drop_link(&low.design)
    );
}

/// The program warns of a pushrod without a stated body if its end is far from the usual body and near another one.
#[test]
fn a_rod_far_from_its_assumed_body_is_doubted() {
    let doubts = |text: &str| {
        let study = read(text).unwrap_or_else(|e| panic!("{e}"));
        let doubts = hardpoint::report::plausibility(study.wheel()).unwrap();
        doubts
            .into_iter()
            .filter(|d| d.contains("pushrod_outer"))
            .collect::<Vec<_>>()
    };
    assert_eq!(doubts(&sample()), Vec::<String>::new());
    let high = ("pushrod_outer ", "pushrod_outer = [-5.0, 500.0, 359.0]");
    let text = with_lines(&[high]);
    let said = doubts(&text);
    assert!(
        said[0].contains("nearer") && said[0].contains("upper arm"),
        "{said:?}"
    );
    let named = text.replace(
        "\n[suspension.bodies]\n",
        "\n[suspension.bodies]\npushrod_outer = \"upper_arm\"\n",
    );
    assert_eq!(doubts(&named), Vec::<String>::new());
}

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

/// The plan computes a rocker if a requested output uses this rocker, and names the output and the line. Otherwise the
/// rocker is off.
#[test]
fn rockers_are_computed_where_they_are_asked_for() {
    let states = |characteristics: &str, more: &str| {
        let outputs = format!("characteristics = {characteristics}\n{more}");
        let text = with_lines(&[
            ("characteristics", &outputs),
            ("points", ""),
            ("loads", ""),
            ("order", ""),
        ]);
        let study = read(&text).unwrap_or_else(|e| panic!("{e}"));
        let effects = Plan::of(study.one_wheel().unwrap()).effects(&study);
        ["rocker", "anti-roll bar", "rates"].map(|name| {
            let effect = effects.iter().find(|e| e.name == name).unwrap();
            assert_eq!(effect.on, effect.because.contains("(line"), "{effect:?}");
            // The line is that of the key, not of the section.
            let line = effect.because.rsplit_once("(line ");
            let line = line.map(|(_, line)| line.trim_end_matches(')').parse::<usize>().unwrap());
            let line = line.map(|line| text.lines().nth(line - 1).unwrap());
            let keys = ["characteristics = ", "points = ", "loads = "];
            assert!(
                line.is_none_or(|line| keys.iter().any(|key| line.starts_with(key))),
                "{line:?}"
            );
            effect.on
        })
    };
    assert_eq!(states("[\"camber\"]", ""), [false, false, false]);
    assert_eq!(states("[\"spring_length\"]", ""), [true, false, false]);
    assert_eq!(states("[\"motion_ratio\"]", ""), [true, false, true]);
    assert_eq!(states("[\"rocker_angle\"]", ""), [true, false, false]);
    // The drop link is on the rocker.
    assert_eq!(states("[\"anti_roll_bar_angle\"]", ""), [true, true, false]);
    let points = "points = [\"pushrod_outer\"]";
    assert_eq!(states("[\"camber\"]", points), [false, false, false]);
    let points = "points = [\"drop_link_inner\"]";
    assert_eq!(states("[\"camber\"]", points), [true, true, false]);
    let load = "loads = [{ name = \"kerb\", at = \"wheel_centre\", force = [0, 0, 1] }]";
    assert_eq!(states("[\"camber\"]", load), [true, false, false]);
}

/// A sweep finds the same values as `solve`. If designs fail at a toggle, the sweep names the toggle.
#[test]
fn sweeps_and_solves_agree() {
    let directory = tempfile::tempdir().unwrap();
    let sweep = "\n[sweep]\nmethod = \"grid\"\nvariables = [\n  { hardpoint = \"pushrod_inner\", axis = \"y\", \
                 range = [185.0, 265.0], absolute = true, steps = 2 },\n]\n";
    let text = with_lines(&[
        ("travel", "travel = [-50.0, 0.0, 50.0]"),
        ("loads", ""),
        ("order", ""),
        ("points", ""),
    ]) + sweep;
    // The first design is near its toggle. The second design is that of the sample.
    let text = text.replace("265.0,  455.0]", "265.0,  486.0]");
    fs::write(directory.path().join("study.toml"), &text).unwrap();
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    command.current_dir(directory.path());
    command
        .args(["sweep", "study.toml", "--out", "run"])
        .assert()
        .code(1);
    let mut reader = csv::Reader::from_path(directory.path().join("run/designs.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    let cell = |row: usize, name: &str| {
        let k = header.iter().position(|n| n == name).unwrap();
        rows[row][k].to_owned()
    };
    assert_eq!(rows.len(), 2);
    assert_eq!(cell(0, "status"), "toggle");
    assert!(cell(0, "reason").contains("the pushrod is at toggle"));
    assert_eq!(
        (
            cell(0, "failed_stations").as_str(),
            cell(0, "failed_at_mm").as_str()
        ),
        ("1", "50.0")
    );
    assert!(cell(0, "motion_ratio_max").is_empty() && !cell(0, "camber_max_deg").is_empty());
    assert!(!cell(0, "motion_ratio_design").is_empty());
    assert_eq!(cell(1, "status"), "ok");

    let (_, found, table) = run(&text);
    assert!(found.are_complete());
    for name in [
        "motion_ratio",
        "spring_length_mm",
        "anti_roll_bar_angle_deg",
        "camber_deg",
    ] {
        let values = table.column(name).unwrap().iter().flatten();
        let largest = values.copied().fold(f64::NEG_INFINITY, larger);
        let (stem, unit) = match name.rsplit_once('_').unwrap() {
            (stem, unit @ ("mm" | "deg")) => (stem, format!("_{unit}")),
            _ => (name, String::new()),
        };
        // The sweep uses SIMD lanes. `solve` uses the solver for single designs.
        let swept: f64 = cell(1, &format!("{stem}_max{unit}")).parse().unwrap();
        assert!((swept - largest).abs() <= 1e-12 * largest.abs(), "{name}");
    }
}

/// The tuning of the sample meets its target curves.
#[test]
fn a_rocker_is_tuned_to_a_rising_rate() {
    let study = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/double_wishbone_rocker.toml");
    let directory = tempfile::tempdir().unwrap();
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    command
        .current_dir(directory.path())
        .arg("optimise")
        .arg(study);
    command.args(["--out", "run"]).assert().success();
    let table =
        CurveTable::read(&fs::read(directory.path().join("run/curves.csv")).unwrap()).unwrap();
    let travel = table.column("travel_mm").unwrap();
    let ratio = table.column("motion_ratio").unwrap();
    assert_eq!((travel.len(), ratio.len()), (31, 31));
    for (travel, ratio) in travel.iter().zip(ratio) {
        let wanted = 0.65 + 0.05 * travel.unwrap() / 30.0;
        assert!((ratio.unwrap() - wanted).abs() < 0.005, "{travel:?}");
    }
}

/// Each case has an edit of the sample, the line that the message names, and the text of the message.
#[test]
fn mistakes_are_named() {
    let line = |start: &str| {
        let sample = sample();
        sample
            .lines()
            .find(|l| l.starts_with(start))
            .unwrap()
            .to_owned()
    };
    let pushrod_outer = line("pushrod_outer");
    let pullrod =
        pushrod_outer.replace("pushrod_outer     ", "pullrod_outer") + "\n" + &pushrod_outer;
    for (start, becomes, on, phrases) in [
        (
            "rocker_pivot_rear",
            "",
            "pushrod_outer",
            &[
                "missing for the rocker: rocker_pivot_rear (rear point of the rocker's axis on the body)",
                "or none",
            ][..],
        ),
        (
            "pushrod_inner",
            "",
            "pushrod_outer",
            &["missing for the rocker: pushrod_inner (pushrod at the rocker)"],
        ),
        (
            "pushrod_outer",
            &pullrod,
            "pullrod_outer",
            &[
                "pullrod_outer and pushrod_outer are both given: expected only one of them for the rocker",
            ],
        ),
        (
            "drop_link_inner",
            "",
            "drop_link_outer",
            &["missing for the anti-roll bar: drop_link_inner"],
        ),
        (
            "spring_upper",
            "",
            "spring_lower",
            &["missing for the spring: spring_upper"],
        ),
        (
            "rocker_pivot_rear",
            "rocker_pivot_rear = [20.0, 205.0, 420.0]",
            "rocker_pivot_rear",
            &[
                "rocker_pivot_rear coincides with rocker_pivot_front: they define the axis of the rocker",
            ],
        ),
        (
            "pushrod_inner",
            "pushrod_inner = [0.0, 530.0, 155.0]",
            "pushrod_inner",
            &["the pushrod would have no length"],
        ),
        (
            "pushrod_inner",
            "pushrod_inner = [0.0, 205.0, 420.0]",
            "pushrod_inner",
            &[
                "pushrod_inner lies on the line through rocker_pivot_front and rocker_pivot_rear, so it has no lever arm to turn the rocker",
            ],
        ),
        // The lever points from the rocker's pivot straight towards the outer end of the rod.
        (
            "pushrod_inner",
            "pushrod_inner = [0.0, 270.0, 367.0]",
            "pushrod_inner",
            &[
                "the pushrod is at toggle in the design position: pushrod_outer, pushrod_inner and the axis from \
               rocker_pivot_front to rocker_pivot_rear lie in one plane, so it cannot turn the rocker",
            ],
        ),
        (
            "drop_link_outer =",
            "drop_link_outer = \"roker\"",
            "drop_link_outer =",
            &["unknown body \"roker\"", "rocker"],
        ),
        (
            "drop_link_outer =",
            "drop_link_outer = \"anti_roll_bar\"",
            "drop_link_outer =",
            &["unknown body \"anti_roll_bar\""],
        ),
        (
            "drop_link_outer =",
            "pushrod_outer = \"rocker\"",
            "pushrod_outer =",
            &["unknown body \"rocker\""],
        ),
        (
            "drop_link_outer =",
            "wheel_centre = \"rocker\"",
            "wheel_centre =",
            &[
                "wheel_centre has a fixed body in every double_wishbone",
                "outer ends",
            ],
        ),
        (
            "drop_link_outer =",
            "pullrod_outer = \"knuckle\"",
            "pullrod_outer =",
            &["this study does not give pullrod_outer"],
        ),
        (
            "drop_link_outer =",
            "damper = \"knuckle\"",
            "damper =",
            &["double_wishbone has no hardpoint \"damper\""],
        ),
    ] {
        let text = with_lines(&[(start, becomes)]);
        let errors = read(&text).expect_err(becomes);
        let said = errors.render(false);
        assert_eq!(errors.all().len(), 1, "{said}");
        let (number, _) = errors.all()[0].position().unwrap();
        let found = text.lines().nth(number - 1).unwrap();
        assert!(
            found.starts_with(on),
            "expected the line with {on}:\n{said}"
        );
        for phrase in phrases {
            let phrase = one_line(phrase);
            assert!(said.contains(&phrase), "expected {phrase:?}:\n{said}");
        }
    }
    // Outputs that need a rocker are refused without one.
    let plain = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/double_wishbone_solve.toml");
    for (name, needs) in [
        ("rocker_angle", "a rocker with its pushrod or pullrod"),
        (
            "anti_roll_bar_motion_ratio",
            "an anti-roll bar with its drop link",
        ),
    ] {
        let asked = format!("outputs.characteristics=[\"{name}\"]");
        let said = Study::read(&plain, &[asked]).unwrap_err().render(false);
        assert!(
            said.contains(&format!(
                "{name} needs {needs}, which this study does not give"
            )),
            "{said}"
        );
    }
}

/// For every topology, an anti-roll bar can have its drop link on the wheel carrier or an arm. The lever turns, and
/// `check` names the body to which the drop link is attached.
#[test]
fn every_topology_takes_an_anti_roll_bar() {
    let bar = [
        "suspension.hardpoints.drop_link_inner=[-110.0, 470.0, 330.0]",
        "suspension.hardpoints.anti_roll_bar_inner=[-210.0, 200.0, 330.0]",
        "suspension.hardpoints.anti_roll_bar_outer=[-210.0, 470.0, 330.0]",
        "suspension.hardpoints.drop_link_outer=[-110.0, 480.0, 220.0]",
        "outputs={characteristics=[\"anti_roll_bar_angle\", \"anti_roll_bar_motion_ratio\"]}",
        "motion.travel=[-20.0, 0.0, 20.0]",
    ]
    .map(str::to_owned);
    for (name, body) in [
        ("macpherson", "lower_arm"),
        ("macpherson", "knuckle"),
        ("double_wishbone", "lower_arm"),
        ("double_wishbone", "knuckle"),
        ("five_link", "knuckle"),
        ("semi_trailing_arm", "arm"),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("studies/{name}_solve.toml"));
        let mut overrides = bar.to_vec();
        overrides.push(format!("suspension.bodies.drop_link_outer=\"{body}\""));
        let study = Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{name}: {e}"));
        let plan = Plan::of(study.one_wheel().unwrap());
        let found = curves(study.wheel(), &plan).unwrap();
        assert!(found.are_complete(), "{name}");
        let [below, design, above] = [0, 1, 2].map(|i| found.stations[i].values[0].unwrap());
        // The drop link is below the lever and pushes it up in jounce.
        let angles = [below, design, above];
        assert!(below < -1.0 && above > 1.0, "{name}: {angles:?}");
        // In the design position the bar angle is 0 degrees, except for rounding errors of the points of an arm.
        assert!(design.abs() < 1e-12, "{name}: {angles:?}");
        let effects = plan.effects(&study);
        let effect = effects.iter().find(|e| e.name == "anti-roll bar").unwrap();
        let from = format!("turned by the drop link on the {}", body.replace('_', " "));
        assert_eq!(effect.what, from, "{name}");
    }
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

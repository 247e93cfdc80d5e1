//! Tests of the ends of equilibrium (the largest load or travel with an equilibrium), and of the command `limits`. The
//! references are closed forms, the rigid limit, the square-root law near a fold, and continuations in small steps.

use super::command::{hardpoint, study};
use super::random::varied;
use super::support::{elastic, with};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::compliance::{
    AxialStiffness, AxleCompliance, AxleKcRun, AxleVehicle, AxleWay, Change, Compliance,
    ElasticWheel, EndCause, EquilibriumEnd, Event, HeldQuantity, KcRun, KcTest, Shape, TestLoad,
    TestMode, WheelLoads,
};
use hardpoint::model::{LengthUnit, Suspension};
use hardpoint::solve::Solver;
use serde_json::Value;

const HEIGHT: HeldQuantity = HeldQuantity::WheelHeight;
const SAMPLE: &str = "double_wishbone_compliance.toml";

/// Wheel that turns about a vertical axis on rigid horizontal arms. The wheel centre is 30 mm behind the axis. A tie rod
/// with this stiffness, 100 mm behind the axis, holds the wheel.
fn castor(stiffness: f64) -> String {
    format!(
        "[suspension]\ntopology = \"double_wishbone\"\n[suspension.hardpoints]\n\
         lower_arm_front = [150.0, 350.0, 150.0]\nlower_arm_rear = [-150.0, 350.0, 150.0]\n\
         lower_ball_joint = [0.0, 700.0, 150.0]\n\
         upper_arm_front = [120.0, 350.0, 450.0]\nupper_arm_rear = [-120.0, 350.0, 450.0]\n\
         upper_ball_joint = [0.0, 700.0, 450.0]\n\
         tie_rod_inner = [-100.0, 350.0, 200.0]\ntie_rod_outer = [-100.0, 700.0, 200.0]\n\
         wheel_centre = [-30.0, 700.0, 300.0]\n[wheel]\nradius = 300.0\nstatic_camber = 0.0\nstatic_toe = 0.0\n\
         [motion]\ntravel = {{ from = -10.0, to = 10.0, steps = 3 }}\n\
         [compliance]\nrelaxed = \"free\"\ntests = [{{ load = \"traction\" }}, {{ load = \"braking\" }}]\n\
         [links.tie_rod]\naxial_stiffness = {stiffness:?}\n"
    )
}

fn test_of(load: TestLoad) -> KcTest {
    KcTest::new(load, LengthUnit::Millimetre)
}

/// A castored wheel has the trail n, the steering arm a, and a tie rod with stiffness k. A forward force F at the wheel
/// centre makes the wheel unstable at F n = k a^2. A rearward force stabilises the wheel.
#[test]
fn a_castored_wheel_turns_over_at_its_closed_form() {
    for stiffness in [40.0, 280.0, 2000.0] {
        let study = elastic(&castor(stiffness));
        let parts = &study.compliance().unwrap().parts;
        let run = KcRun::new(study.wheel(), parts, None).unwrap();
        let [rearward, forward] = run.load_ends(&test_of(TestLoad::Traction)).unwrap();
        let critical = stiffness * 100.0 * 100.0 / 30.0;
        assert!(
            (forward.value - critical).abs() < 1e-8 * critical,
            "{forward:?} {critical}"
        );
        assert!(
            matches!(&forward.cause, EndCause::GivesWay { part, .. } if part == "the wheel carrier"),
            "{forward:?}"
        );
        assert_eq!(rearward.cause, EndCause::SearchEnds);
        // Braking is the same force with the opposite sign.
        let [lower, _] = run.load_ends(&test_of(TestLoad::Braking)).unwrap();
        assert!(
            (lower.value + critical).abs() < 1e-8 * critical,
            "{lower:?}"
        );
    }
}

/// With stiffer bushings, the limits of travel and rack come closer to those of the rigid mechanism. At such a limit,
/// parts are in line.
#[test]
fn travel_ends_come_to_those_of_the_rigid_mechanism() {
    let study = elastic(&with(SAMPLE, ""));
    let suspension = study.wheel();
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design).unwrap();
    let limits = solver.limits().unwrap();
    let (travel, rack) = (limits.travel.ends(), limits.rack.unwrap().ends());
    let errors = [1e3, 1e5, 1e7].map(|factor| {
        let mut parts = study.compliance().unwrap().parts.clone();
        for shape in parts.bushings.iter_mut().flat_map(|b| &mut b.shapes[..3]) {
            let Shape::Cubic { rate, .. } = shape else {
                panic!("{shape:?}");
            };
            *rate *= factor;
        }
        let wheel = ElasticWheel::new(suspension, &parts).unwrap();
        let ends = [wheel.travel_ends(0.0).unwrap(), wheel.rack_ends().unwrap()];
        let found = ends.as_flattened().iter().map(|end| end.value);
        let rigid = travel.into_iter().chain(rack);
        let errors = found.zip(rigid).map(|(found, rigid)| (found - rigid).abs());
        errors.fold(0.0, larger)
    });
    assert!(
        errors[2] < 1e-3 && errors[1] < 0.1 * errors[0] && errors[2] < 0.1 * errors[1],
        "{errors:?}"
    );
}

/// At a fold, an increasing load reaches its maximum. Near a fold the slope of camber grows with the inverse square root
/// of the distance to the end load. Under forces that follow the wheel, stability ends just before the fold, so this law
/// fails at the very end.
#[test]
fn rates_at_the_end_follow_the_law_of_a_fold() {
    let study = elastic(&with(SAMPLE, ""));
    let parts = &study.compliance().unwrap().parts;
    let run = KcRun::new(study.wheel(), parts, None).unwrap();
    let wheel = run.wheel();
    let station = wheel.at(0.0, 0.0).unwrap();
    let test = test_of(TestLoad::Vertical);
    let loads = |force: f64| {
        let mut loads = WheelLoads::none(0.0);
        loads.contact.z = force;
        loads
    };
    for end in run.load_ends(&test).unwrap() {
        assert!(matches!(end.cause, EndCause::GivesWay { .. }), "{end:?}");
        let mut at = station;
        let mut rates = Vec::new();
        for left in [0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
            let now = loads(end.value * (1.0 - left));
            at = wheel.loaded_about(&station, &at, &now, test.held).unwrap();
            let tangent = wheel.tangent(&at, test.held).unwrap();
            let by = wheel.figures_along(&tangent, &Change::Load(loads(1.0)));
            rates.push(by.unwrap().camber);
        }
        // The next term of the law has an additional factor: the square root of the remaining load. So the error falls
        // with the remaining load.
        let off = |k: usize| (rates[k + 1] / rates[k] - 10.0_f64.sqrt()).abs();
        assert!(off(6) < 0.03 && off(6) < 0.4 * off(5), "{rates:?} {end:?}");
        let beyond = loads(end.value * (1.0 + 1e-8));
        wheel
            .loaded_about(&station, &at, &beyond, test.held)
            .unwrap_err();
    }
}

/// Returns the end load of a continuation with steps of `step`. Bisection refines it.
fn fine(wheel: &ElasticWheel, unit: &WheelLoads, held: HeldQuantity, step: f64, most: f64) -> f64 {
    let station = wheel.at(0.0, 0.0).unwrap();
    let (mut at, mut reached, mut size) = (station, 0.0_f64, step);
    while size.abs() > 1e-7 * step.abs() && reached.abs() < most {
        let mut loads = WheelLoads::none(0.0).plus(unit, reached + size);
        loads.trail = unit.trail;
        match wheel.loaded_about(&station, &at, &loads, held) {
            Ok(next) => (at, reached) = (next, reached + size),
            Err(_) => size *= 0.5,
        }
    }
    reached
}

/// For random designs, equilibria end where continuations in steps of 100 N end. A continuation stops within 1e-5 N
/// of the end; the bound is 1e-4 N plus rounding.
#[test]
fn ends_are_those_of_fine_continuations() {
    let studies = [
        SAMPLE,
        "five_link_compliance.toml",
        "macpherson_compliance.toml",
    ];
    let mut random = Random(44);
    let (mut compared, mut unresolved) = (0, 0);
    for number in 0..12 {
        let study = elastic(&with(studies[number % 3], ""));
        let (suspension, parts) = varied(&study, &mut random);
        let Ok(run) = KcRun::new(&suspension, &parts, None) else {
            continue;
        };
        for load in [TestLoad::Lateral, TestLoad::Braking, TestLoad::Traction] {
            let test = test_of(load);
            let Ok(ends) = run.load_ends(&test) else {
                continue;
            };
            let mut unit = WheelLoads::none(0.0);
            match load {
                TestLoad::Lateral => unit.side = 1.0,
                TestLoad::Braking => unit.contact.x = -1.0,
                _ => unit.centre.x = 1.0,
            }
            for end in &ends {
                unresolved += usize::from(end.cause == EndCause::Unresolved);
                if end.cause == EndCause::SearchEnds || end.value.abs() > 2e5 {
                    continue;
                }
                let step = 100.0_f64.copysign(end.value);
                let found = fine(run.wheel(), &unit, HEIGHT, step, 3e5);
                assert!(
                    (found - end.value).abs() < 1e-4 + 1e-8 * found.abs(),
                    "{number} {load:?}: {found} {end:?}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared >= 20, "{compared} {unresolved}");
}

fn axle_of(parts: &Compliance) -> AxleCompliance {
    AxleCompliance {
        wheels: [parts.clone(), parts.clone()],
        subframe: None,
        rack_rate: None,
        column: None,
        bar_rate: None,
    }
}

fn close(a: &[EquilibriumEnd; 2], b: &[EquilibriumEnd; 2]) {
    for (a, b) in a.iter().zip(b) {
        assert!(
            (a.value - b.value).abs() < 1e-8 * b.value.abs(),
            "{a:?} {b:?}"
        );
        assert_eq!(
            std::mem::discriminant(&a.cause),
            std::mem::discriminant(&b.cause)
        );
    }
}

/// A symmetric axle in heave, or under mirrored loads, has the same end of equilibrium as one wheel.
#[test]
fn a_symmetric_axle_ends_where_its_wheel_does() {
    let study = elastic(&with(SAMPLE, ""));
    let parts = &study.compliance().unwrap().parts;
    let suspension: &Suspension = study.wheel();
    let one = KcRun::new(suspension, parts, None).unwrap();
    let vehicle = AxleVehicle {
        suspensions: [suspension; 2],
        tyre_rate: None,
    };
    let both = AxleKcRun::new(vehicle, &axle_of(parts)).unwrap();
    close(
        &both.motion_ends(AxleWay::Heave).unwrap(),
        &one.wheel().travel_ends(0.0).unwrap(),
    );
    for (load, mode) in [
        (TestLoad::Lateral, TestMode::Opposed),
        (TestLoad::Braking, TestMode::Parallel),
        (TestLoad::Aligning, TestMode::Opposed),
    ] {
        let test = test_of(load);
        let expected = one.load_ends(&test).unwrap();
        let found = both.load_ends(&KcTest { mode, ..test }).unwrap();
        close(&found, &expected);
    }
}

/// With the wheel load held, the wheel lifts when the vertical test load is minus the design load. The program counts a load
/// below -1e-6 N as negative. The bound is three times as large.
#[test]
fn a_wheel_lifts_where_its_load_is_gone() {
    for name in [SAMPLE, "five_link_compliance.toml"] {
        let study = elastic(&with(name, ""));
        let parts = &study.compliance().unwrap().parts;
        let run = KcRun::new(study.wheel(), parts, None).unwrap();
        let design_load = run.wheel().design_load().unwrap();
        let [lower, upper] = run.load_ends(&test_of(TestLoad::Vertical)).unwrap();
        let lifts = |end: &EquilibriumEnd| {
            let mut lifted = end
                .events
                .iter()
                .filter(|(event, _)| *event == Event::WheelLifts);
            lifted.next().map(|(_, value)| *value)
        };
        let found = lifts(&lower).unwrap();
        assert!((found + design_load).abs() < 3e-6, "{found} {design_load}");
        assert_eq!(lifts(&upper), None);
    }
}

/// `limits` prints each end of equilibrium with the part that gives way. If the tie rod of the castored wheel is softer,
/// the end load falls in proportion.
#[test]
fn limits_prints_ends_with_the_part_that_gives_way() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("castor.toml"), castor(280.0)).unwrap();
    let ran = hardpoint(
        &[
            "limits",
            "castor.toml",
            "--format",
            "json",
            "--report",
            "page.html",
        ],
        directory.path(),
    );
    let errors = String::from_utf8_lossy(&ran.stderr).into_owned();
    assert_eq!(ran.status.code(), Some(0), "{errors}");
    let all: Value = serde_json::from_slice(&ran.stdout).unwrap();
    let text = all.to_string();
    let rows = find_rows(&all).unwrap_or_else(|| panic!("{text}"));
    let row = |quantity: &str| {
        let found = rows.iter().find(|row| row["quantity"] == quantity);
        found.unwrap_or_else(|| panic!("{quantity}: {text}"))
    };
    let traction = row("traction_N");
    let critical = 280.0 * 1e4 / 30.0;
    assert!(
        (traction["to"].as_f64().unwrap() - critical).abs() < 1e-2,
        "{text}"
    );
    assert!(
        traction["because_there"]
            .as_str()
            .unwrap()
            .contains("turns about z")
    );
    assert!(traction["from"].is_null(), "{text}");
    // The command reports no wheel lift, because no spring defines a wheel load.
    assert!(!text.contains("wheel lifts"), "{text}");
    assert!(
        traction["because"]
            .as_str()
            .unwrap()
            .contains("no limit up to")
    );
    assert_eq!(row("travel_mm")["at"], "rack 0");
    assert_eq!(row("rack_mm")["at"], "travel 0");
    let page = std::fs::read_to_string(directory.path().join("page.html")).unwrap();
    assert!(page.contains("traction_<wbr>N") && page.contains("gives way"));
}

/// Rows of the only table in a JSON output.
fn find_rows(value: &Value) -> Option<&Vec<Value>> {
    match value {
        Value::Array(rows) if rows.iter().any(|row| row.get("quantity").is_some()) => Some(rows),
        Value::Array(all) => all.iter().find_map(find_rows),
        Value::Object(all) => all.values().find_map(find_rows),
        _ => None,
    }
}

/// `limits` runs on the sample studies. It names motions for which it cannot find limits.
#[test]
fn samples_have_limits() {
    let directory = tempfile::tempdir().unwrap();
    for name in [SAMPLE, "subframe_axle_compliance.toml"] {
        let ran = hardpoint(&["limits", &study(name)], directory.path());
        let said = String::from_utf8_lossy(&ran.stdout).into_owned();
        assert_eq!(ran.status.code(), Some(0), "{name}: {said}");
        for word in ["lateral", "braking", "all parts rigid"] {
            assert!(said.contains(word), "{name} {word}: {said}");
        }
    }
    let far = "motion.travel=[0.0, 900.0]";
    let ran = hardpoint(&["limits", &study(SAMPLE), "--set", far], directory.path());
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert_eq!(ran.status.code(), Some(1), "{said}");
    assert!(
        said.contains("beyond the travel limit") && said.contains("not solved"),
        "{said}"
    );
}

/// For builds with scatter, `limits` gives the limit that all builds reach. It equals the nearest limit of the single
/// builds that `tolerance` prints. The test uses a wheel and an axle. Hardpoints and a bushing stiffness scatter.
#[test]
fn limits_of_elastic_builds_are_the_nearest_of_each() {
    let directory = tempfile::tempdir().unwrap();
    let scatter = "\n[tolerance]\nseed = 3\nscatter = [\n\
        { hardpoints = [\"lower_arm_rear\", \"tie_rod_outer\"], sigma = 0.8 },\n\
        { bushing = \"lower_arm_rear\", stiffness = \"y\", sigma = 0.1, relative = true },\n]\n";
    for name in [SAMPLE, "subframe_axle_compliance.toml"] {
        let path = directory.path().join(name);
        std::fs::write(&path, with(name, scatter)).unwrap();
        let path = path.to_str().unwrap();
        let json = |arguments: &[&str]| -> Value {
            let ran = hardpoint(
                &[arguments, &["--format", "json"]].concat(),
                directory.path(),
            );
            serde_json::from_slice(&ran.stdout)
                .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&ran.stderr)))
        };
        let found = json(&["limits", path, "--builds", "2"]);
        let single = ["0", "1"].map(|build| {
            let printed = hardpoint(&["tolerance", path, "--build", build], directory.path());
            let own = directory.path().join("build.toml");
            std::fs::write(&own, printed.stdout).unwrap();
            json(&["limits", own.to_str().unwrap()])["limits"].clone()
        });
        let counts = &found["builds"];
        assert_eq!(counts[0]["number"], 0, "{counts}");
        assert_eq!(counts[1]["number"], 0, "{counts}");
        let rows = found["limits"].as_array().unwrap();
        let mut compared = 0;
        for (k, row) in rows.iter().enumerate() {
            for (nearest, end, sign) in [("nearest", "from", 1.0), ("nearest_there", "to", -1.0)] {
                // A limit beyond the range of the search has no value.
                let values = single.iter().filter_map(|limits| limits[k][end].as_f64());
                let expected = values.map(|value| sign * value).reduce(f64::max);
                let found = row[nearest].as_f64().map(|value| sign * value);
                assert_eq!(row["quantity"], single[0][k]["quantity"]);
                let (Some(found), Some(expected)) = (found, expected) else {
                    assert_eq!(found, expected, "{name} {row}");
                    continue;
                };
                let off = (found - expected).abs();
                assert!(off < 1e-6 * expected.abs(), "{name} {row}: {expected}");
                compared += 1;
            }
        }
        assert!(compared > 10, "{name}: {compared}");
    }
}

/// Studies with removed parts or extreme rates are refused, or their ends enclose 0 and come after all events.
#[test]
fn mutilated_studies_have_ends_or_are_refused() {
    let mut random = Random(45);
    let mut found = 0;
    for number in 0..30 {
        let study = elastic(&with(SAMPLE, ""));
        let (mut suspension, mut parts) = varied(&study, &mut random);
        suspension.design = random.scattered(&suspension.design, 60.0);
        let taken = number % parts.bushings.len();
        parts.bushings.remove(taken);
        for shape in parts.bushings.iter_mut().flat_map(|b| &mut b.shapes) {
            if let Shape::Cubic { rate, .. } = shape {
                *rate *= 1e3_f64.powf(random.signed());
            }
        }
        for link in &mut parts.links {
            link.stiffness = AxialStiffness::Rate(1e4);
        }
        let Ok(run) = KcRun::new(&suspension, &parts, None) else {
            continue;
        };
        let mut all = Vec::new();
        all.extend(run.wheel().travel_ends(0.0).into_iter().flatten());
        all.extend(run.wheel().rack_ends().into_iter().flatten());
        for load in [TestLoad::Lateral, TestLoad::Aligning, TestLoad::Vertical] {
            all.extend(run.load_ends(&test_of(load)).into_iter().flatten());
        }
        found += all.len();
        for pair in all.chunks(2) {
            let [lower, upper] = pair else {
                panic!("{pair:?}");
            };
            assert!(
                lower.value <= 0.0 && upper.value >= 0.0,
                "{number}: {pair:?}"
            );
            for end in pair {
                let mut firsts = end.events.iter().map(|(_, value)| value.abs());
                assert!(
                    firsts.all(|first| first <= end.value.abs()),
                    "{number}: {end:?}"
                );
            }
        }
    }
    // Five pairs of ends for each study that is not refused.
    assert!(found >= 10, "{found}");
}

//! Tests of `[axle.right]`: a right wheel whose points, angles, bodies or spring differ from the mirror image.

use super::commands::{folder, run as hardpoint_run};
use hardpoint::axle::{Axle, AxlePlan, axle_curves};
use hardpoint::curves::Curves;
use hardpoint::study::Study;
use std::path::Path;

/// Double wishbone with angles in `[wheel]`, an anti-roll bar and springs.
const HEAD: &str = r#"
[suspension]
topology = "double_wishbone"
[suspension.hardpoints]
upper_arm_front  = [ 100.0, 460.0, 520.0]
upper_arm_rear   = [-140.0, 470.0, 510.0]
upper_ball_joint = [ -15.0, 690.0, 530.0]
lower_arm_front  = [ 130.0, 380.0, 190.0]
lower_arm_rear   = [-180.0, 370.0, 195.0]
lower_ball_joint = [   5.0, 715.0, 185.0]
tie_rod_inner    = [-120.0, 390.0, 255.0]
tie_rod_outer    = [-135.0, 690.0, 250.0]
wheel_centre     = [   0.0, 760.0, 310.0]
spring_upper     = [  20.0, 560.0, 690.0]
spring_lower     = [  10.0, 640.0, 220.0]
[vehicle]
wheelbase = 2700.0
"#;

fn text(wheel: &str, axle: &str, rest: &str) -> String {
    format!(
        "{HEAD}[wheel]\nradius = 310.0\n{wheel}\n{axle}\n[motion]\nheave = [-30.0, 0.0, 30.0]\n[outputs]\n\
         characteristics = [\"camber\", \"toe\", \"spring_force\", \"wheel_load\", \"wheel_rate\"]\n{rest}"
    )
}

fn study(text: &str) -> Result<Study, String> {
    Study::from_text("right.toml", text, Path::new(".")).map_err(|e| e.to_string())
}

fn solved(text: &str) -> (Axle, AxlePlan, Curves) {
    let study = study(text).unwrap_or_else(|e| panic!("{e}"));
    let both = study.axle().unwrap().clone();
    let curves = axle_curves(&both.axle, &both.plan).unwrap().curves;
    (both.axle, both.plan, curves)
}

/// Values of all columns of one side.
fn side(curves: &Curves, side: &str) -> Vec<(String, Vec<f64>)> {
    let columns = curves.columns.iter().enumerate();
    let of_side = columns.filter_map(|(k, c)| Some((k, c.name.strip_prefix(side)?.to_owned())));
    of_side
        .map(|(k, name)| {
            let values = curves.stations.iter().map(|s| s.value(k).unwrap());
            (name, values.collect())
        })
        .collect()
}

const STEEP: &str = "static_camber = -1.5\nstatic_toe = 0.2";
const FLAT: &str = "static_camber = -0.5\nstatic_toe = 0.2";
const SOFT: &str = "[spring]\nrate = 28.0\nforce = 3500.0\n";
const HARD: &str = "[spring]\nrate = 35.0\nforce = 3500.0\n";

/// On pads, the wheels do not influence each other. Two axles have the same right wheel: an axle with different sides,
/// and a mirrored axle with the right-hand values on both sides. Their right wheels have bit-identical results.
#[test]
fn each_side_is_that_of_the_mirrored_axle_with_its_figures() {
    let points = "wheel_centre = [0.0, -770.0, 305.0]\n";
    let mirrored = HEAD.replace("[   0.0, 760.0, 310.0]", "[0.0, 770.0, 305.0]");
    for (own, of_right) in [
        // If the section omits a value, the right wheel has the left wheel's value.
        (
            "[axle.right.wheel]\nstatic_camber = -0.5\n".to_owned(),
            text(FLAT, "[axle]\n", SOFT),
        ),
        (
            "[axle.right.spring]\nrate = 35.0\n".to_owned(),
            text(STEEP, "[axle]\n", HARD),
        ),
        (
            format!(
                "[axle.right.hardpoints]\n{points}[axle.right.wheel]\nstatic_camber = -0.5\nstatic_toe = 0.2\n"
            ),
            text(FLAT, "[axle]\n", SOFT).replace(HEAD, &mirrored),
        ),
        (
            "[axle.right.bodies]\nspring_lower = \"knuckle\"\n".to_owned(),
            text(STEEP, "[axle]\n", SOFT).replace(
                "[vehicle]",
                "[suspension.bodies]\nspring_lower = \"knuckle\"\n[vehicle]",
            ),
        ),
    ] {
        let (axle, _, found) = solved(&text(STEEP, &own, SOFT));
        let (_, _, left) = solved(&text(STEEP, "[axle]\nright = \"mirrored\"\n", SOFT));
        let (_, _, right) = solved(&of_right);
        assert_eq!(side(&found, "left_"), side(&left, "left_"), "{own}");
        assert_eq!(side(&found, "right_"), side(&right, "right_"), "{own}");
        assert_ne!(side(&found, "left_"), side(&found, "right_"), "{own}");
        // Different springs leave the linkage mirrored.
        assert_eq!(axle.right.is_none(), own.contains("spring]"), "{own}");
    }
}

/// Without entries for the right wheel, the right wheel is the mirror image of the left one.
#[test]
fn without_right_the_axle_is_mirrored() {
    let (axle, _, found) = solved(&text(STEEP, "[axle]\n", SOFT));
    assert!(axle.right.is_none());
    assert_eq!(side(&found, "left_"), side(&found, "right_"));
    let (named, _, _) = solved(&text(STEEP, "[axle]\nright = \"mirrored\"\n", SOFT));
    assert_eq!(axle, named);
}

/// Every command accepts an axle whose right wheel differs from the left one: it can be rolled, certified, swept and
/// tuned. Results name the entries of the right wheel.
#[test]
fn an_axle_with_a_right_wheel_of_its_own_goes_through_every_command() {
    let own = "[axle.right.wheel]\nstatic_toe = -0.3\n[axle.right.spring]\nforce = 3700.0\n";
    let more = "[sweep]\nmethod = \"grid\"\nvariables = [{ hardpoint = \"tie_rod_outer\", axis = \"z\", range = [-4.0, 4.0], steps = 3 }]\n\
        [optimise]\nstarts = 1\nvariables = [{ hardpoint = \"tie_rod_outer\", axis = \"z\", range = [-20.0, 20.0] }]\n\
        targets = [{ characteristic = \"mean_steer\", over = \"roll\", points = [[-2.0, 0.05], [2.0, -0.05]], tolerance = 0.05 }]\n";
    let study = text(STEEP, own, &format!("certify = true\n{SOFT}{more}"))
        .replace("heave = [-30.0, 0.0, 30.0]", "roll = [-2.0, 0.0, 2.0]")
        .replace("\"wheel_rate\"", "\"wheel_rate\", \"mean_steer\"");
    let scatter =
        "[tolerance]\nbuilds = 50\nscatter = [{ hardpoint = \"tie_rod_outer\", sigma = 0.3 }]\n";
    let study = format!("{study}{scatter}");
    let place = folder("own_right");
    std::fs::create_dir_all(&place).unwrap();
    let file = place.join("study.toml");
    std::fs::write(&file, study).unwrap();
    let file = file.to_str().unwrap();
    let (said, _) = hardpoint_run(&["check", file], 0);
    assert!(said.contains("own wheel and spring on the right"), "{said}");
    let (solved, said) = hardpoint_run(&["solve", file, "--out", "-"], 0);
    assert!(said.contains("3 of 3 stations certified"), "{said}");
    let cell = |csv: &str, row: usize, name: &str| -> f64 {
        let mut lines = csv.lines();
        let header: Vec<_> = lines.next().unwrap().split(',').collect();
        let column = header.iter().position(|c| *c == name).expect(name);
        lines
            .nth(row)
            .unwrap()
            .split(',')
            .nth(column)
            .unwrap()
            .parse()
            .unwrap()
    };
    assert!(
        (cell(&solved, 1, "right_toe_deg") + 0.3).abs() < 1e-9,
        "{solved}"
    );
    assert!(
        (cell(&solved, 1, "left_toe_deg") - 0.2).abs() < 1e-9,
        "{solved}"
    );
    assert!(
        (cell(&solved, 1, "right_spring_force_N") - 3700.0).abs() < 1e-9,
        "{solved}"
    );
    let lanes = [
        "--set",
        "outputs.characteristics=[\"toe\", \"camber\", \"mean_steer\"]",
        "--out",
        "-",
    ];
    let (swept, _) = hardpoint_run(&[&["sweep", file], &lanes[..]].concat(), 0);
    assert!(
        (cell(&swept, 1, "right_toe_design_deg") + 0.3).abs() < 1e-9,
        "{swept}"
    );
    let moved = "suspension.hardpoints.tie_rod_outer=[-135.0, 690.0, 254.0]";
    let (alone, _) = hardpoint_run(&[&["solve", file, "--set", moved], &lanes[..]].concat(), 0);
    for side in ["left", "right"] {
        let toe = |row| cell(&alone, row, &format!("{side}_toe_deg"));
        let most = toe(0).max(toe(1)).max(toe(2));
        let found = cell(&swept, 2, &format!("{side}_toe_max_deg"));
        assert!((found - most).abs() < 1e-12, "{side}: {found} {most}");
    }
    // Builds scatter about the nominal design, whose sides differ. A printed build is a valid study.
    let few = "outputs.characteristics=[\"toe\"]";
    let (built, _) = hardpoint_run(&["tolerance", file, "--set", few, "--build", "7"], 0);
    let built_file = place.join("built.toml");
    std::fs::write(&built_file, built).unwrap();
    let built_file = built_file.to_str().unwrap();
    let (built, _) = hardpoint_run(&["solve", built_file, "--set", few, "--out", "-"], 0);
    let toe = cell(&built, 1, "right_toe_deg");
    assert!((toe + 0.3).abs() < 1.0 && toe != -0.3, "{built}");
    let out = place.join("tuned");
    hardpoint_run(&["optimise", file, "--out", out.to_str().unwrap()], 0);
    let tuned = std::fs::read_to_string(out.join("optimised.toml")).unwrap();
    assert!(
        tuned.contains("static_toe = -0.3") && tuned.contains("force = 3700.0"),
        "{tuned}"
    );
}

#[test]
fn mistakes_in_a_right_wheel_are_named() {
    for (wheel, axle, springs, words) in [
        (
            STEEP,
            "[axle.right.wheel]\nstatic_camber = 95.0\n",
            SOFT,
            "expected between -90 and 90 degrees",
        ),
        (
            STEEP,
            "[axle.right.wheel]\nradius = 300.0\n",
            SOFT,
            "known here: static_camber, static_toe",
        ),
        (
            STEEP,
            "[axle.right.spring]\nrate = -2.0\n",
            SOFT,
            "expected a number above 0",
        ),
        (
            STEEP,
            "[axle.right.spring]\nrate = 2.0\n",
            "",
            "expected [spring] too",
        ),
        (
            STEEP,
            "[axle.right.spring]\nrate = 2.0\nforce_curve = [[400.0, 1000.0], [500.0, 500.0]]\n",
            SOFT,
            "force_curve already gives the spring",
        ),
        (
            STEEP,
            "[axle.right.bodies]\nspring_lower = \"wheel\"\n",
            SOFT,
            "unknown body",
        ),
        (
            STEEP,
            "[axle.right.bodies]\ntie_rod_outer = \"knuckle\"\n",
            SOFT,
            "has a fixed body",
        ),
        (
            STEEP,
            "[axle.right]\nwheels = 1\n",
            SOFT,
            "known here: hardpoints, bodies, wheel, spring",
        ),
        (
            STEEP,
            "[axle.right.hardpoints]\ntie_rod_inner = [-130.0, -225000.0, 235.0]\n",
            SOFT,
            "right wheel: the hardpoints are 224285",
        ),
        (
            STEEP,
            "[axle.right.hardpoints]\nlower_arm_rear = [130.0, -380.0, 190.0]\n",
            SOFT,
            "right wheel: lower_arm_rear coincides with lower_arm_front",
        ),
    ] {
        let said = study(&text(wheel, axle, springs)).unwrap_err();
        assert!(said.contains(words), "{axle}: {said}");
    }
    let spindle = "wheel_centre     = [   0.0, 760.0, 310.0]\nspindle_inner = [0.0, 660.0, 311.0]";
    let said = text("", "[axle.right.wheel]\nstatic_toe = 0.1\n", SOFT)
        .replace("wheel_centre     = [   0.0, 760.0, 310.0]", spindle);
    let said = study(&said).unwrap_err();
    assert!(
        said.contains("spindle_inner already gives camber and toe"),
        "{said}"
    );
    assert!(said.contains("[axle.right.hardpoints]"), "{said}");
}

/// A constraint on dimensions checks only the left wheel. If the right wheel's dimensions differ, the study must name
/// the left side. This applies in the design position and to constraints over a motion.
#[test]
fn constraints_of_different_wheels_name_the_left_one() {
    let own = "[axle.right.hardpoints]\ntie_rod_inner = [-120.0, -350.0, 255.0]\n";
    let constrained = |axle: &str, constraint: &str| {
        let more = format!(
            "[motions.one]\ntravel = [-10.0, 0.0, 10.0]\n[optimise]\n\
             variables = [{{ hardpoint = \"tie_rod_outer\", axis = \"z\", range = [-20.0, 20.0] }}]\n\
             targets = [{{ characteristic = \"camber\", at = 0.0, value = -1.0, tolerance = 0.1 }}]\n\
             constraints = [{{ {constraint} }}]\n"
        );
        let study = study(&text(STEEP, axle, &format!("{SOFT}{more}")))?;
        let constraints = &study.optimise.as_ref().unwrap().constraints;
        Ok::<_, String>(
            constraints
                .iter()
                .map(|c| c.name.clone())
                .collect::<Vec<_>>(),
        )
    };
    let length = "length = \"tie_rod\", between = [300.0, 303.0]";
    for place in ["", ", at = \"design\"", ", motion = \"one\""] {
        let constraint = format!("{length}{place}");
        for side in ["", ", side = \"right\""] {
            let error = constrained(own, &format!("{constraint}{side}")).unwrap_err();
            assert!(
                error.contains("the right wheel has different dimensions"),
                "{error}"
            );
            assert!(error.contains("expected side = \"left\""), "{error}");
        }
        let of_left = constrained(own, &format!("{constraint}, side = \"left\"")).unwrap();
        assert_eq!(of_left, ["length tie_rod between 300 and 303, left wheel"]);
        // If the wheels are mirror images, the constraint applies once, without a side.
        assert_eq!(constrained("[axle]\n", &constraint).unwrap().len(), 1);
    }
}

//! Tests that the program reports every mistake in a study with file, line, key, the found value and the expected value.
//! The mistakes are in a table. Each mistake is one edit of a good study.

mod keys;
mod texts;

use hardpoint::study::{Study, StudyErrors};
use std::fs;
use std::path::Path;

const GOOD: &str = r#"[suspension]
topology = "macpherson"
side = "left"
length_unit = "mm"
frame = "iso8855"

[suspension.hardpoints]
lower_arm_front  = [ 120.0, 360.0, 195.0]
lower_arm_rear   = [-260.0, 350.0, 205.0]
lower_ball_joint = [   5.0, 705.0, 190.0]
strut_top        = [ -35.0, 575.0, 850.0]
strut_lower      = [ -11.0, 623.0, 370.0]
tie_rod_inner    = [-110.0, 330.0, 243.0]
tie_rod_outer    = [-130.0, 690.0, 240.0]
wheel_centre     = [   0.0, 760.0, 300.0]
spindle_inner    = [  -0.2, 660.0, 299.1]

[suspension.extra_points]
spring_seat = { body = "lower_arm", position = [-20.0, 560.0, 200.0] }

[wheel]
radius = 300.0

[vehicle]
wheelbase = 2650.0
cg_height = 540.0
brake_share_front = 0.68
position = "front"
brakes = "outboard"

[motion]
travel = { from = -80.0, to = 80.0, steps = 41 }
rack = 0.0

[outputs]
characteristics = ["camber", "anti_dive"]
points = ["wheel_centre", "spring_seat"]
order = "velocity"
knuckle = true
sensitivities = ["tie_rod_inner"]
certify = false

[optimise]
method = "levenberg_marquardt"
starts = 8
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-20.0, 20.0] },
  { hardpoint = "strut_top", axis = "y", range = [0.0, 20.0] },
]
targets = [
  { characteristic = "camber", points = [[-80.0, 0.2], [0.0, -0.5], [80.0, -1.9]], tolerance = 0.05 },
  { characteristic = "bump_steer", at = 0.0, value = 0.0, tolerance = 0.01 },
]
"#;

fn read(text: &str) -> Result<Study, StudyErrors> {
    Study::from_text("study.toml", text, Path::new("."))
}

/// Good study in which `to` replaces `from`. The study contains `from` once.
fn edited(from: &str, to: &str) -> String {
    assert_eq!(GOOD.matches(from).count(), 1, "{from:?}");
    GOOD.replace(from, to)
}

/// Asserts that the study has exactly this mistake: on the line that contains `on`, and with these phrases in the
/// message.
fn assert_mistake(text: &str, on: &str, key: &str, phrases: &[&str]) {
    let errors = match read(text) {
        Ok(_) => panic!("accepted: {on}"),
        Err(errors) => errors,
    };
    let rendered = errors.render(false);
    assert_eq!(
        errors.all().len(),
        1,
        "one mistake, one message:\n{rendered}"
    );
    let error = &errors.all()[0];
    let (line, column) = error
        .position()
        .unwrap_or_else(|| panic!("no place:\n{rendered}"));
    let found = text.lines().nth(line - 1).unwrap_or_default();
    assert!(
        found.contains(on),
        "expected the line with {on:?}:\n{rendered}"
    );
    assert!(
        rendered.contains(&format!("study.toml:{line}:{column}")),
        "{rendered}"
    );
    assert_eq!(error.path(), Some(key), "{rendered}");
    for phrase in phrases {
        assert!(
            rendered.contains(phrase),
            "expected {phrase:?}:\n{rendered}"
        );
    }
    for jargon in [
        "f64",
        "i64",
        "invalid type",
        "struct",
        "sequence",
        "map",
        "field",
        "TOML parse",
    ] {
        let words = format!("{} {}", error.message(), error.suggestion().unwrap_or(""));
        let jargon_word = words
            .split_whitespace()
            .any(|word| word.trim_matches(',') == jargon);
        assert!(!jargon_word, "{jargon} in:\n{rendered}");
    }
}

/// Columns: `from`, `to`, a part of the faulty line, the key of the message, phrases of the message.
type Case = (
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static [&'static str],
);

fn assert_all(cases: &[Case]) {
    for (from, to, on, key, phrases) in cases {
        assert_mistake(&edited(from, to), on, key, phrases);
    }
}

#[test]
fn the_good_study_is_good() {
    read(GOOD).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn values_of_the_wrong_kind() {
    // rustfmt is off here, so each mistake of the table stays on one line.
    #[rustfmt::skip]
    assert_all(&[
        ("[   5.0, 705.0", "[   5.0, \"x\"", "\"x\"", "suspension.hardpoints.lower_ball_joint", &["expected a number, found the text \"x\""]),
        ("[   5.0, 705.0", "[   nan, 705.0", "nan", "suspension.hardpoints.lower_ball_joint", &["expected a finite number, found nan"]),
        ("[   5.0, 705.0", "[   inf, 705.0", "inf", "suspension.hardpoints.lower_ball_joint", &["expected a finite number, found inf"]),
        ("[   5.0, 705.0", "[  1e13, 705.0", "1e13", "suspension.hardpoints.lower_ball_joint", &["magnitude of at most 1e12"]),
        ("= [   5.0, 705.0, 190.0]", "= 5.0", "= 5.0", "suspension.hardpoints.lower_ball_joint", &["expected a list, found 5"]),
        ("[   5.0, 705.0, 190.0]", "[5.0, 705.0]", "[5.0, 705.0]", "suspension.hardpoints.lower_ball_joint", &["expected three coordinates [x, y, z], found 2"]),
        ("[   5.0, 705.0, 190.0]", "[5.0, 705.0, 1, 2]", "[5.0, 705.0, 1", "suspension.hardpoints.lower_ball_joint", &["found 4"]),
        ("radius = 300.0", "radius = \"300 mm\"", "radius", "wheel.radius", &["expected a number, found the text \"300 mm\""]),
        ("radius = 300.0", "radius = 2026-01-01", "radius", "wheel.radius", &["date"]),
        ("travel = { from = -80.0, to = 80.0, steps = 41 }", "travel = 2026-01-01", "2026", "motion.travel", &["date"]),
        ("steps = 41", "steps = 41.5", "steps", "motion.travel.steps", &["expected a whole number, found 41.5"]),
        ("rack = 0.0", "rack = true", "rack", "motion.rack", &["expected a number, a list of numbers or { from, to, steps }, found true"]),
        ("knuckle = true", "knuckle = 1", "knuckle", "outputs.knuckle", &["expected true or false, found 1"]),
        ("sensitivities = [\"tie_rod_inner\"]", "sensitivities = \"all\"", "sensitivities", "outputs.sensitivities", &["true, false or a list of hardpoint names"]),
        ("side = \"left\"", "side = 1", "side", "suspension.side", &["expected a text in quotes, found 1"]),
        ("spring_seat = { body = \"lower_arm\", position = [-20.0, 560.0, 200.0] }", "spring_seat = 5", "spring_seat", "suspension.extra_points.spring_seat", &["expected a table, found 5"]),
    ]);
}

#[test]
fn unknown_and_missing_keys() {
    // rustfmt is off here, so each mistake of the table stays on one line.
    #[rustfmt::skip]
    assert_all(&[
        ("radius = 300.0", "raduis = 300.0", "raduis", "wheel.raduis", &["unknown key \"raduis\"", "did you mean \"radius\"?"]),
        ("[vehicle]", "[vehicel]", "[vehicel]", "vehicel", &["unknown section [vehicel]", "did you mean [vehicle]?"]),
        ("[optimise]", "[optimize]", "[optimize]", "optimize", &["did you mean [optimise]?"]),
        // The misspelt section has priority over the error that it causes.
        ("targets = [", "[optimize]\ntargets = [", "[optimize]", "optimize", &["did you mean [optimise]?"]),
        ("[suspension.hardpoints]", "[points]", "[points]", "points", &["did you mean [suspension.hardpoints]?"]),
        ("[optimise]", "[targets]", "[targets]", "targets", &["\"targets\" is a key of [optimise]"]),
        ("[optimise]", "[optimisation]", "[optimisation]", "optimisation", &["did you mean [optimise]?"]),
        ("[outputs]", "[tolerances]", "[tolerances]", "tolerances", &["did you mean [tolerance]?"]),
        ("radius = 300.0", "wheelbase = 2500.0", "wheelbase", "wheel.wheelbase", &["\"wheelbase\" is a key of [vehicle]"]),
        ("wheel_centre     =", "wheel_center =", "wheel_center", "suspension.hardpoints.wheel_center", &["did you mean \"wheel_centre\"?"]),
        // A decimal comma doubles the number of values.
        ("[ 120.0, 360.0, 195.0]", "[ 120,0, 360,0, 195,0]", "lower_arm_front", "suspension.hardpoints.lower_arm_front", &["found 6", "Write 120.0 instead of 120,0"]),
        ("range = [-20.0, 20.0]", "range = [-20,5, 20,0]", "tie_rod_inner", "optimise.variables[0].range", &["found 4", "Write -20.5 instead of -20,5"]),
        ("steps = 41", "step = 41", "step = 41", "motion.travel.step", &["unknown key \"step\"; known here: from, to, steps"]),
        (", steps = 41", "", "travel", "motion.travel", &["the key \"steps\" is missing"]),
        (", tolerance = 0.01", "", "bump_steer", "optimise.targets[1]", &["the key \"tolerance\" is missing"]),
        ("topology = \"macpherson\"", "", "[suspension]", "suspension", &["the key \"topology\" is missing"]),
        ("starts = 8", "solver = 8", "solver", "optimise.solver", &["unknown key \"solver\""]),
    ]);
    let missing = GOOD[..GOOD.find("[motion]").unwrap()].to_owned();
    let errors = read(&missing).unwrap_err().render(false);
    assert!(
        errors.contains("study.toml: the section [motion] is missing"),
        "{errors}"
    );
    let errors = read("[motion]\ntravel = 0.0\n").unwrap_err().render(false);
    assert!(
        errors.contains("the section [suspension] is missing"),
        "{errors}"
    );
}

#[test]
fn text_that_is_not_toml() {
    for (from, to, on, phrase) in [
        ("side = \"left\"", "side = \"left", "side", "not valid TOML"),
        (
            "rack = 0.0",
            "rack = 0.0\nrack = 1.0",
            "rack = 1.0",
            "duplicate key",
        ),
        ("rack = 0.0", "rack = ", "rack", "not valid TOML"),
        ("rack = 0.0", "rack = 0,0", "rack", "not valid TOML"),
        ("[wheel]", "[wheel", "[wheel", "not valid TOML"),
    ] {
        let text = edited(from, to);
        let errors = read(&text).unwrap_err();
        let rendered = errors.render(false);
        assert!(rendered.contains(phrase), "{rendered}");
        let line = errors.all()[0].position().unwrap().0;
        assert!(
            text.lines().nth(line - 1).unwrap().contains(on),
            "{rendered}"
        );
    }
    for empty in ["", " \n", "\u{feff}"] {
        let errors = read(empty).unwrap_err().render(false);
        assert!(errors.contains("study.toml: the file is empty"), "{errors}");
    }
}

#[test]
fn unknown_names() {
    // rustfmt is off here, so each mistake of the table stays on one line.
    #[rustfmt::skip]
    assert_all(&[
        ("topology = \"macpherson\"", "topology = \"mcpherson\"", "topology", "suspension.topology", &["unknown topology \"mcpherson\"", "did you mean \"macpherson\"?"]),
        ("side = \"left\"", "side = \"lef\"", "side", "suspension.side", &["unknown side \"lef\"; expected \"left\" or \"right\"", "did you mean \"left\"?"]),
        ("length_unit = \"mm\"", "length_unit = \"inch\"", "length_unit", "suspension.length_unit", &["unknown length unit \"inch\"; expected \"mm\", \"m\" or \"in\""]),
        ("frame = \"iso8855\"", "frame = \"iso\"", "frame", "suspension.frame", &["did you mean \"iso8855\"?"]),
        ("wheel_centre     =", "wheel_center     = [0.0, 1.0, 2.0]\nwheel_centre =", "wheel_center ", "suspension.hardpoints.wheel_center", &["macpherson has no hardpoint \"wheel_center\"", "\"wheel_centre\" is already given"]),
        ("strut_top        =", "strut_tpo =", "strut_tpo", "suspension.hardpoints.strut_tpo", &["did you mean \"strut_top\"?"]),
        ("strut_top        =", "damper_eye = [0, 0, 0]\nstrut_top =", "damper_eye", "suspension.hardpoints.damper_eye", &["[suspension.extra_points]"]),
        ("body = \"lower_arm\"", "body = \"lowerarm\"", "body", "suspension.extra_points.spring_seat.body", &["did you mean \"lower_arm\"?"]),
        ("[\"camber\", \"anti_dive\"]", "[\"chamber\", \"anti_dive\"]", "chamber", "outputs.characteristics", &["unknown characteristic \"chamber\"", "did you mean \"camber\"?"]),
        ("[\"camber\", \"anti_dive\"]", "[\"qqqq\"]", "qqqq", "outputs.characteristics", &["there are camber, toe, "]),
        ("\"spring_seat\"]", "\"spring_set\"]", "spring_set\"", "outputs.points", &["unknown point \"spring_set\"", "did you mean \"spring_seat\"?"]),
        ("order = \"velocity\"", "order = \"speed\"", "order", "outputs.order", &["expected \"position\", \"velocity\" or \"acceleration\""]),
        ("sensitivities = [\"tie_rod_inner\"]", "sensitivities = [\"tie_rod\"]", "sensitivities", "outputs.sensitivities", &["did you mean \"tie_rod_inner\"?"]),
        ("sensitivities = [\"tie_rod_inner\"]", "sensitivities = [\"spring_seat\"]", "sensitivities", "outputs.sensitivities", &["spring_seat is an extra point; expected a hardpoint"]),
        ("method = \"levenberg_marquardt\"", "method = \"lm\"", "method", "optimise.method", &["unknown method \"lm\"; expected \"levenberg_marquardt\""]),
        ("hardpoint = \"strut_top\"", "hardpoint = \"strut_upper\"", "strut_upper", "optimise.variables[1].hardpoint", &["this study does not give strut_upper"]),
        ("axis = \"y\"", "axis = \"w\"", "axis = \"w\"", "optimise.variables[1].axis", &["expected \"x\", \"y\" or \"z\""]),
        ("characteristic = \"bump_steer\"", "characteristic = \"bumpsteer\"", "bumpsteer", "optimise.targets[1].characteristic", &["did you mean \"bump_steer\"?"]),
    ]);
}

#[test]
fn loads_that_cannot_be() {
    let certify = "certify = false";
    #[rustfmt::skip]
    let cases: &[(&str, &str, &[&str])] = &[
        ("loads = [{ name = \"b\", at = \"contact\", force = [0, 0, 1] }]", "outputs.loads[0].at", &["unknown place \"contact\"", "did you mean \"contact_point\"?"]),
        ("loads = [{ name = \"b\", at = \"hub\", force = [0, 0, 1] }]", "outputs.loads[0].at", &["expected \"contact_point\" or \"wheel_centre\""]),
        ("loads = [{ name = \"b\", at = \"wheel_centre\", force = [0, 1] }]", "outputs.loads[0].force", &["expected three components [x, y, z] in N, found 2"]),
        ("loads = [{ name = \"b\", at = \"wheel_centre\", moment = [0, 0, 0, 1] }]", "outputs.loads[0].moment", &["in N mm, found 4"]),
        ("loads = [{ name = \"b\", at = \"wheel_centre\", force = [0, nan, 1] }]", "outputs.loads[0].force", &["expected a finite number"]),
        ("loads = [{ name = \"b\", at = \"wheel_centre\", torque = [0, 0, 1] }]", "outputs.loads[0].torque", &["unknown key \"torque\"; known here: name, at, side, hold, force, moment"]),
        ("loads = [{ name = \"b\", at = \"wheel_centre\" }]", "outputs.loads[0].name", &["expected a force, a moment or both"]),
        ("loads = [{ name = \"hard braking\", at = \"wheel_centre\", force = [0, 0, 1] }]", "outputs.loads[0].name", &["letters, digits and _", "hard braking"]),
        ("loads = [{ name = \"b\", at = \"wheel_centre\", force = [0, 0, 1] }, { name = \"b\", at = \"wheel_centre\", force = [0, 1, 1] }]", "outputs.loads[1].name", &["\"b\" is the name of another load", "first here"]),
        ("loads = { name = \"b\" }", "outputs.loads", &["expected a list"]),
    ];
    for (line, key, phrases) in cases {
        assert_mistake(&edited(certify, line), "loads = ", key, phrases);
    }
    let on_ground = "loads = [{ name = \"b\", at = \"contact_point\", force = [0, 0, 1] }]";
    let text = edited(certify, on_ground).replace("radius = 300.0", "");
    let text = text.replace("\"anti_dive\"", "\"toe\"");
    let key = "outputs.loads[0].at";
    assert_mistake(&text, "loads = ", key, &["needs radius in [wheel]"]);
    let text = edited(certify, &on_ground.replace("contact_point", "wheel_centre"));
    let text = text.replace("sensitivities = [\"tie_rod_inner\"]\n", "");
    let text = text.replace("[\"camber\", \"anti_dive\"]", "[\"camber\"]");
    let (text, _) = text.split_once("[optimise]").unwrap();
    let text = format!("{text}[solver]\nformulation = \"point_coordinates\"\n");
    let phrase = "loads are not available for the formulation in point coordinates";
    assert_mistake(&text, "loads = ", "outputs.loads", &[phrase]);
}

#[test]
fn geometry_that_cannot_be() {
    // rustfmt is off here, so each mistake of the table stays on one line.
    #[rustfmt::skip]
    assert_all(&[
        ("strut_top        = [ -35.0, 575.0, 850.0]\n", "", "[suspension.hardpoints]", "suspension.hardpoints", &["missing for macpherson: strut_top (upper strut mount on the body)"]),
        ("lower_arm_rear   = [-260.0, 350.0, 205.0]", "lower_arm_rear = [120.0, 360.0, 195.0]", "lower_arm_rear", "suspension.hardpoints.lower_arm_rear", &["lower_arm_rear coincides with lower_arm_front: they define the axis of the lower arm", "the same place"]),
        ("strut_lower      = [ -11.0, 623.0, 370.0]", "strut_lower = [-35.0, 575.0, 850]", "strut_top", "suspension.hardpoints.strut_top", &["the strut would have no length"]),
        ("lower_ball_joint = [   5.0, 705.0, 190.0]", "lower_ball_joint = [-70.0, 355.0, 200.0]", "lower_ball_joint", "suspension.hardpoints.lower_ball_joint", &["on the line through lower_arm_front and lower_arm_rear"]),
        ("side = \"left\"", "side = \"right\"", "wheel_centre", "suspension.hardpoints.wheel_centre", &["inboard", "side and frame must fit"]),
        ("frame = \"iso8855\"", "frame = \"sae_j670\"", "wheel_centre", "suspension.hardpoints.wheel_centre", &["inboard"]),
        ("length_unit = \"mm\"", "length_unit = \"m\"", "length_unit", "suspension.length_unit", &["impossible for a suspension", "length_unit is the unit"]),
        ("spindle_inner    = [  -0.2, 660.0, 299.1]\n", "", "[suspension.hardpoints]", "suspension.hardpoints", &["spindle_inner", "static_camber"]),
        ("radius = 300.0", "radius = 300.0\nstatic_camber = -0.5", "static_camber", "wheel.static_camber", &["spindle_inner already gives", "given here"]),
        ("radius = 300.0", "radius = -300.0", "radius", "wheel.radius", &["expected a number above 0, found -300"]),
        ("brake_share_front = 0.68", "brake_share_front = 68", "brake_share", "vehicle.brake_share_front", &["expected a share from 0 to 1, found 68"]),
    ]);
    for (name, phrase) in [
        ("strut_upper", "name of a hardpoint"),
        ("\"spring seat\"", "letters, digits and _"),
    ] {
        let text = edited("spring_seat = {", &format!("{name} = {{"));
        let text = text.replace(", \"spring_seat\"", "");
        let key = format!("suspension.extra_points.{}", name.trim_matches('"'));
        assert_mistake(&text, name, &key, &[phrase]);
    }
}

#[test]
fn motions_that_go_nowhere() {
    let travel = "travel = { from = -80.0, to = 80.0, steps = 41 }";
    let key = "motion.travel";
    #[rustfmt::skip]
    let cases: &[(&str, &str, &[&str])] = &[
        ("travel = { from = 80.0, to = -80.0, steps = 41 }", "motion.travel.from", &["the range is reversed: from = 80 is above to = -80", "from = -80, to = 80"]),
        ("travel = { from = 80.0, to = 80.0, steps = 41 }", "motion.travel.to", &["the range is empty"]),
        ("travel = { from = -80.0, to = 80.0, steps = 1 }", "motion.travel.steps", &["one step cannot reach"]),
        ("travel = { from = -80.0, to = 80.0, steps = 0 }", "motion.travel.steps", &["expected from 1 to 100000, found 0"]),
        ("travel = { from = -80.0, to = 80.0, steps = 99999999999 }", "motion.travel.steps", &["expected from 1 to 100000"]),
        ("travel = []", key, &["at least one value"]),
        ("travel = [0.0, 80.0, -80.0, 80]", key, &["80 is listed twice", "first here"]),
        ("travel = [0.0, 80.0, \"a\"]", key, &["expected a number, found the text \"a\""]),
        ("arm_angle = [-60.0, 60.0]", "motion.arm_angle", &["arm_angle is given, but the drive is \"travel\"", "drive = \"arm_angle\""]),
        ("travel = [0.0]\ntime = { polynomial = [0.0, 1.0], from = 0.0, to = 1.0, steps = 3 }", key, &["already gives the drive values"]),
        ("time = { polynomial = [], from = 0.0, to = 1.0, steps = 3 }", "motion.time.polynomial", &["empty list"]),
        ("time = { polynomial = [0.0, 1e12, 1e12], from = 0.0, to = 9.0, steps = 3 }", "motion.time.polynomial", &["grows beyond"]),
        ("drive = \"arm_angle\"\nangle_unit = \"grad\"\narm_angle = 1", "motion.angle_unit", &["expected \"deg\" or \"rad\""]),
        ("travel = { from = 0.0, to = 80.0, steps = 100000 }\n rack = [0, 1]", "motion", &["200000 stations", "at most 100000"]),
        ("drive = \"arm\"\ntravel = [0.0]", "motion.drive", &["did you mean \"arm_angle\"?"]),
    ];
    for (line, key, phrases) in cases {
        let text = edited(travel, line);
        let text = if line.contains(" rack") {
            text.replace("\nrack = 0.0", "")
        } else {
            text
        };
        // The mistake does not concern the targets, so the test removes the targets.
        let text = &text[..text.find("[optimise]").unwrap()];
        let on = key.rsplit('.').next().unwrap();
        assert_mistake(text, on, key, phrases);
    }
    let text = edited(travel, "");
    assert_mistake(&text, "[motion]", "motion", &["expected travel or time"]);
    // With sensitivities, each station has a derivative with respect to each hardpoint.
    let text = edited(travel, "travel = { from = 0.0, to = 80.0, steps = 50001 }");
    let text = &text[..text.find("[optimise]").unwrap()];
    let text = text.replace("\nsensitivities", "\n# sensitivities");
    let some = "[outputs]\nsensitivities = [\"strut_top\", \"tie_rod_inner\"]";
    let phrases = ["50001 stations times 2 hardpoints", "at most 100000"];
    let text = text.replace("[outputs]", some);
    assert_mistake(&text, "[motion]", "motion", &phrases);
    // The ball joint is straight above the axis of the arm.
    let text = edited(travel, "drive = \"arm_angle\"\narm_angle = [1.0]");
    let text = text.replace("[   5.0, 705.0, 190.0]", "[ -70.0, 355.0, 500.0]");
    let text = &text[..text.find("[optimise]").unwrap()];
    let phrases = ["dead centre", "moves lower_ball_joint horizontally"];
    assert_mistake(text, "drive =", "motion.drive", &phrases);
}

#[test]
fn outputs_that_cannot_be_computed() {
    // rustfmt is off here, so each mistake of the table stays on one line.
    #[rustfmt::skip]
    assert_all(&[
        ("radius = 300.0", "", "anti_dive", "outputs.characteristics", &["anti_dive needs radius in [wheel], which this study does not give"]),
        ("cg_height = 540.0", "", "anti_dive", "outputs.characteristics", &["cg_height in [vehicle]"]),
        ("position = \"front\"", "", "anti_dive", "outputs.characteristics", &["anti_dive needs position in [vehicle], \"front\" or \"rear\", which"]),
        ("brakes = \"outboard\"", "", "anti_dive", "outputs.characteristics", &["brakes in [vehicle], \"outboard\" or \"inboard\""]),
        ("position = \"front\"", "position = \"rear\"", "anti_dive", "outputs.characteristics", &["anti_dive applies to a front axle in braking, but position is \"rear\"", "anti_lift"]),
        ("brake_share_front = 0.68", "brake_share_front = 0.0", "anti_dive", "outputs.characteristics", &["has no brakes"]),
        ("position = \"front\"", "position = \"middle\"", "middle", "vehicle.position", &["\"front\" or \"rear\""]),
        ("[\"camber\", \"anti_dive\"]", "[\"camber\", \"camber\"]", "camber", "outputs.characteristics", &["\"camber\" is listed twice"]),
        ("order = \"velocity\"", "", "knuckle", "outputs.knuckle", &["order is \"position\""]),
    ]);
}

#[test]
fn optimisations_that_make_no_sense() {
    // rustfmt is off here, so each mistake of the table stays on one line.
    #[rustfmt::skip]
    assert_all(&[
        ("starts = 8", "starts = 0", "starts", "optimise.starts", &["expected from 1 to 1000000, found 0"]),
        ("starts = 8", "seed = -1", "seed", "optimise.seed", &["expected from 0 to 4294967295, found -1"]),
        ("starts = 8", "max_iterations = 0", "max_iterations", "optimise.max_iterations", &["expected at least 1, found 0"]),
        ("range = [0.0, 20.0]", "range = [20.0, -20.0]", "strut_top", "optimise.variables[1].range", &["reversed", "range = [-20, 20]"]),
        ("range = [0.0, 20.0]", "range = [20.0, 20.0]", "strut_top", "optimise.variables[1].range", &["the range is empty"]),
        ("range = [0.0, 20.0]", "range = [1.0, 20.0]", "strut_top", "optimise.variables[1].range", &["do not include the design"]),
        ("range = [0.0, 20.0]", "range = [20.0]", "strut_top", "optimise.variables[1].range", &["expected two offsets [lowest, highest], found 1"]),
        ("\"strut_top\", axis = \"y\"", "\"tie_rod_inner\", axis = \"z\"", "[0.0, 20.0]", "optimise.variables[1].hardpoint", &["z of tie_rod_inner is already a variable"]),
        ("[0.0, -0.5], [80.0, -1.9]", "[-80.0, -0.5]", "[-80.0, -0.5]", "optimise.targets[0].points", &["-80 is not above -80"]),
        (", [0.0, -0.5], [80.0, -1.9]", "", "camber", "optimise.targets[0].points", &["at least two points, found one", "at = -80.0, value = 0.2"]),
        ("[0.0, -0.5]", "[0.0, -0.5, 1.0]", "camber", "optimise.targets[0].points", &["expected a pair"]),
        ("[[-80.0, 0.2], [0.0, -0.5], [80.0, -1.9]]", "[[90.0, 0.0], [100.0, 1.0]]", "camber", "optimise.targets[0].points", &["runs from -80 to 80", "runs from 90 to 100"]),
        ("at = 0.0", "at = 81.0", "at = 81", "optimise.targets[1].at", &["81 is outside of the motion, which runs from -80 to 80"]),
        ("targets = [\n  { characteristic = \"camber\", points = [[-80.0", "fit = true\ntargets = [\n  { characteristic = \"camber\", points = [[-200.0", "-200.0", "optimise.targets[0].points", &["-200 is outside of the motion, which runs from -80 to 80", "extend the motion"]),
        ("value = 0.0, ", "", "at = 0.0", "optimise.targets[1].at", &["at\" needs \"value"]),
        ("at = 0.0, ", "", "value = 0.0", "optimise.targets[1].value", &["value\" needs \"at"]),
        ("at = 0.0, value = 0.0, ", "", "bump_steer", "optimise.targets[1]", &["expected points = [[drive, value], ...]"]),
        ("at = 0.0", "file = \"x.csv\", at = 0.0", "x.csv", "optimise.targets[1]", &["found more than one"]),
        ("tolerance = 0.01", "tolerance = 0.0", "bump_steer", "optimise.targets[1].tolerance", &["above 0, found 0"]),
        ("tolerance = 0.01", "tolerance = 0.01, weight = -1", "bump_steer", "optimise.targets[1].weight", &["above 0, found -1"]),
        ("tolerance = 0.01", "tolerance = 0.01, interpolation = \"linear\"", "bump_steer", "optimise.targets[1].interpolation", &["does not apply to a single value"]),
        ("tolerance = 0.05", "tolerance = 0.05, interpolation = \"cubic\"", "camber", "optimise.targets[0].interpolation", &["did you mean \"monotone_cubic\"?"]),
        ("at = 0.0, value = 0.0", "file = \"no_such.csv\"", "no_such", "optimise.targets[1].file", &["no_such.csv: the file does not exist", "relative to the study file"]),
    ]);
}

/// Two variables with the same move are refused, also beside rigid bodies. Variables with other moves of the same points are
/// accepted.
#[test]
fn two_variables_with_the_same_move_are_refused() {
    let body = |way: &str| format!("{{ rigid = [\"strut_top\", \"strut_lower\"], {way} }}");
    let pair = |factors: &str| {
        format!(
            "{{ hardpoints = [\"strut_top\", \"strut_lower\"], factors = {factors}, axis = \"z\", range = [-5.0, 5.0] }}"
        )
    };
    let of_point =
        "{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-5.0, 5.0] }".to_owned();
    let with = |variables: [String; 2]| {
        edited(
            "{ hardpoint = \"strut_top\", axis = \"y\", range = [0.0, 20.0] }",
            &variables.join(", "),
        )
    };
    for (variables, key, phrase) in [
        (
            [body("shift = 5.0"), body("shift = 3.0")],
            "optimise.variables[2]",
            "x of strut_top+strut_lower is already a variable",
        ),
        (
            [body("turn = 2.0"), body("turn = 1.0")],
            "optimise.variables[2]",
            "turn about x of strut_top+strut_lower is already a variable",
        ),
        (
            [body("shift = 5.0"), pair("[1.0, 1.0]")],
            "optimise.variables[2]",
            "z of strut_top+strut_lower is already a variable",
        ),
        (
            [body("shift = 5.0"), of_point.clone()],
            "optimise.variables[2].hardpoint",
            "z of tie_rod_inner is already a variable",
        ),
    ] {
        assert_mistake(&with(variables), "strut_top", key, &[phrase]);
    }
    for second in [body("turn = 2.0"), pair("[1.0, -1.0]")] {
        read(&with([body("shift = 5.0"), second])).unwrap_or_else(|e| panic!("{e}"));
    }
}

use crate::error::Source;
use crate::parse::parse;
use std::sync::Arc;

const GOOD: &str = r#"[suspension]
topology = "macpherson"
side = "left"
length_unit = "mm"
frame = "iso8855"                # x forward, y left, z up

[suspension.hardpoints]
lower_arm_front  = [ 120.0, 360.0, 195.0]
lower_arm_rear   = [-260.0, 350.0, 205.0]
lower_ball_joint = [   5.0, 705.0, 190.0]
strut_top        = [ -35.0, 575.0, 850.0]
strut_lower      = [ -11.0, 623.0, 370.0]
tie_rod_inner    = [-110.0, 336.0, 228.0]
tie_rod_outer    = [-130.0, 690.0, 240.0]
wheel_centre     = [   0.0, 760.0, 300.0]

[wheel]
static_camber = -0.5             # degrees, in the design position
static_toe = 0.1

[motion]
travel = { from = -80.0, to = 80.0, steps = 41 }

[outputs]
characteristics = ["toe", "bump_steer", "camber"]

[optimise]
method = "levenberg_marquardt"
starts = 1
seed = 1
# Offsets from the design.
variables = [
  { hardpoint = "tie_rod_inner", axis = "y", range = [-20.0, 20.0] },
  { hardpoint = "tie_rod_inner", axis = "z", range = [-25.0, 25.0] },
  { hardpoint = "tie_rod_outer", axis = "z", range = [-5.0, 5.0] },
]
targets = [
  { characteristic = "toe", points = [[-80.0, 0.1], [80.0, 0.1]], tolerance = 0.01 },
  { characteristic = "bump_steer", at = 0.0, value = 0.0, tolerance = 0.0005 },   # degrees per mm
]
"#;

fn message(text: &str) -> Option<String> {
    let source = Source {
        name: "study.toml".to_owned(),
        text: text.to_owned(),
    };
    parse(&Arc::new(source))
        .err()
        .map(|error| error.to_string())
}

/// The help for a frequent mistake names the mistake, and not only the token that the parser expected.
#[test]
fn the_help_names_the_probable_mistake() {
    let point = "[ 120.0, 360.0, 195.0]";
    let camber = "static_camber = -0.5";
    let travel = "{ from = -80.0, to = 80.0, steps = 41 }";
    let names = "[\"toe\", \"bump_steer\", \"camber\"]";
    let entry = "axis = \"y\", range = [-20.0, 20.0] },";
    // rustfmt is off here, so each mistake of the table stays on one line.
    #[rustfmt::skip]
    let cases = [
        (point, "[ 120.0 360.0, 195.0]", "a comma is missing between two numbers: 120.0, 360.0"),
        (point, "[ 120.0; 360.0; 195.0]", "commas instead of semicolons"),
        (point, "[ 120.0, 360.0, 195.0", "the bracket ] is missing at the end of the list that begins in line 8"),
        (point, "120.0, 360.0, 195.0]", "the bracket [ is missing"),
        (point, "120.0, 360.0, 195.0", "a list is in square brackets: [120.0, 360.0, 195.0]"),
        (point, "{120.0, 360.0, 195.0}", "in square brackets, not in braces"),
        (point, "[ 120,05, 360.0, 195.0]", "decimal point instead of a decimal comma: 120.05"),
        (point, "[ .5, 360.0, 195.0]", "a digit before the decimal point: 0.5"),
        (point, "[ 5., 360.0, 195.0]", "a digit after the decimal point: 5.0"),
        (point, "[ 120.0, 360.0, 195.0 mm]", "the number without a unit: 195.0"),
        (point, "[ 120.0, 360.0, 195.0mm]", "the number without a unit: 195.0"),
        (point, "[ 120.0, 360.0, \u{2212}195.0]", "write the minus sign -"),
        (point, "[ 120.0, 360.0,, 195.0]", "one of the two commas"),
        ("lower_arm_front  =", "lower_arm_front", "an equals sign is missing: lower_arm_front = ["),
        ("lower_arm_front  =", "lower_arm_front:", "an equals sign instead of the colon: lower_arm_front ="),
        ("lower_arm_front  =", "lower arm front =", "a name has no spaces: lower_arm_front"),
        (camber, "static_camber = -0,5", "decimal point instead of a decimal comma: -0.5"),
        (camber, "static_camber = -0.5,", "remove the comma at the end of the line"),
        (camber, "static_camber = -0.5;", "remove the semicolon"),
        (camber, "static_camber = -0.5 // degrees", "a comment begins with #"),
        (camber, "static_camber =", "a value is missing after ="),
        (camber, "static_camber = -0.5\nstatic_camber = 1", "\"static_camber\" is given twice"),
        ("\"macpherson\"", "\"macpherson", "a quotation mark is missing at the end"),
        ("\"macpherson\"", "macpherson\"", "a quotation mark is missing at the beginning"),
        ("\"macpherson\"", "macpherson", "write a text in quotes: \"macpherson\""),
        ("\"iso8855\"", "iso8855", "write a text in quotes: \"iso8855\""),
        ("\"macpherson\"", "\u{201c}macpherson\u{201d}", "write the quotation mark \""),
        ("[wheel]", "[wheel", "the bracket ] is missing at the end: [wheel]"),
        ("[wheel]", "wheel]", "a bracket on each side: [wheel]"),
        ("[suspension.hardpoints]", "[suspension hardpoints]", "no spaces"),
        (travel, "{ from = -80.0, to = 80.0, steps = 41", "the brace } is missing at the end of the table that begins in line 22"),
        (travel, "{ from = -80.0 to = 80.0, steps = 41 }", "a comma is missing between two keys"),
        (travel, "{ from = -80,5, to = 80.0, steps = 41 }", "decimal point instead of a decimal comma: -80.5"),
        (travel, "{ from: -80.0, to: 80.0, steps: 41 }", "an equals sign instead of the colon"),
        (names, "[\"toe\" \"bump_steer\", \"camber\"]", "a comma is missing between two entries"),
        (names, "[\"toe, \"bump_steer\", \"camber\"]", "a quotation mark is missing in this line"),
        (names, "[\"toe\", \"bump_steer\", \"camber]", "a quotation mark is missing in line 25"),
        (names, "[toe, bump_steer, camber]", "write a text in quotes: \"toe\""),
        (entry, "axis = \"y\", range = [-20.0, 20.0] }", "a comma is missing after the brace }"),
        (entry, "axis = \"y\", range = [-20.0, 20.0 },", "the bracket ] is missing in front of the brace }"),
        (entry, "axis = \"y\", range = -20.0, 20.0 },", "a list is in square brackets: [-20.0, 20.0]"),
        (entry, "axis = \"y, range = [-20.0, 20.0] },", "a quotation mark is missing in line 33"),
        ("tolerance = 0.01 }", "tolerance = 0,01 }", "decimal point instead of a decimal comma: 0.01"),
    ];
    for (right, wrong, phrase) in cases {
        let text = GOOD.replacen(right, wrong, 1);
        assert_ne!(text, GOOD, "{right}");
        let message = message(&text).unwrap_or_else(|| panic!("accepted: {wrong}"));
        assert!(
            message.contains("= help: ") && message.contains(phrase),
            "{wrong}: {message}"
        );
    }
}

/// A file that another program has written keeps its own help.
#[test]
fn a_table_of_points_has_the_help_for_tables() {
    let source = Source {
        name: "points.csv".to_owned(),
        text: "name,x,y,z\n".to_owned(),
    };
    let message = parse(&Arc::new(source)).unwrap_err().to_string();
    assert!(message.contains("hardpoint import"), "{message}");
}

/// Every mistake of one character gives a message.
#[test]
fn no_mistake_of_one_character_stops_the_reader() {
    for (at, c) in GOOD.char_indices().step_by(3) {
        let (before, after) = (&GOOD[..at], &GOOD[at + c.len_utf8()..]);
        message(&format!("{before}{after}"));
        let put = ["\"", "]", "}", ",", "=", "\u{a0}", "\u{201c}", "\n"][at % 8];
        message(&format!("{before}{put}{c}{after}"));
    }
}

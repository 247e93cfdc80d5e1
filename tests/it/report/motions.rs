//! Tests of named motions in the page of a run and in its files.

use super::*;

const TURN: &str = "motions.turn={ roll = [-2.0, -1.0, 0.0, 1.0, 2.0] }";

/// `solve` and `optimise` write the curves of each design over each named motion. For each named motion, the page has a
/// chart of every output, and the targets of this motion.
#[test]
fn the_page_has_the_curves_of_named_motions() {
    let text = study("macpherson_axle_front.toml");
    let sets = [
        "--set",
        "motion={ heave = [-20.0, 0.0, 20.0] }",
        "--set",
        TURN,
        "--set",
        "outputs.characteristics=[\"camber_to_road\", \"bump_steer\"]",
        "--set",
        "optimise.starts=1",
        "--set",
        "optimise.targets=[{ characteristic = \"camber_to_road\", motion = \"turn\", over = \"roll\", points = [[-2.0, 1.9], [2.0, 1.9]], tolerance = 1.0, side = \"left\" }]",
    ];
    for (command, designs) in [
        ("solve", &[("design", "curves_turn.csv")][..]),
        (
            "optimise",
            &[
                ("before", "curves_before_turn.csv"),
                ("after", "curves_turn.csv"),
            ],
        ),
    ] {
        let run = Run::of(command, "motions", &text, &sets);
        let page = run.page();
        assert!(page.contains("<h3>Motion turn</h3>"), "{command}");
        let data = run.data();
        let motion = &data["record"]["motions"][0];
        assert_eq!(motion["name"], "turn");
        assert_eq!(motion["drive"], "roll_deg");
        let own = data["record"]["designs"].as_array().unwrap().len();
        assert_eq!(own, designs.len());
        for (k, (label, file)) in designs.iter().enumerate() {
            assert_eq!(motion["designs"][k]["label"], *label);
            assert_eq!(motion["designs"][k]["curves"], *file);
            let (header, columns) = run.csv(file);
            let place = header
                .iter()
                .position(|name| name == "left_camber_to_road_deg");
            let cells = &columns[place.unwrap()];
            let cells: Vec<f64> = cells.iter().map(|c| c.parse().unwrap()).collect();
            assert_eq!(cells.len(), 5);
            // The tables of the named motion follow those of the main motion.
            let table = &data["curves"][own + k];
            let names = table["header"].as_array().unwrap();
            let place = names
                .iter()
                .position(|name| name == "left_camber_to_road_deg");
            assert_eq!(table["columns"][place.unwrap()], Value::from(cells));
        }
        let target = &motion["targets"][0];
        assert_eq!(target["column"], "left_camber_to_road_deg");
        assert_eq!(target["points"].as_array().unwrap().len(), 5);
        assert_eq!(data["record"]["targets"].as_array().unwrap().len(), 0);
        // Charts over roll belong to the named motion: the main motion has only heave.
        let charts = data["charts"].as_array().unwrap().iter();
        let over_roll = charts.filter(|chart| chart["x"]["column"] == "roll_deg");
        for chart in over_roll.clone() {
            let lines = chart["lines"].as_array().unwrap().iter();
            assert!(lines.clone().count() > 0);
            for line in lines {
                assert!(line["table"].as_u64().unwrap() as usize >= own, "{line}");
            }
        }
        assert_eq!(over_roll.count(), 2, "camber and bump steer");
    }
}

/// A target without a value for a moving coordinate applies where this coordinate is 0. The chart states this.
#[test]
fn a_chart_states_where_a_target_applies() {
    let text = study("macpherson_axle_front.toml");
    let target = "characteristic = \"camber_to_road\", over = \"roll\", points = [[-2.0, 1.9], [2.0, 1.9]], tolerance = 1.0, side = \"left\"";
    for (motion, held) in [
        ("roll = [-2.0, 0.0, 2.0], heave = [-20.0, 0.0, 20.0]", true),
        ("roll = [-2.0, 0.0, 2.0], heave = 20.0", false),
    ] {
        let sets = [
            "--set",
            &format!("motion={{ {motion} }}"),
            "--set",
            "outputs.characteristics=[\"camber_to_road\"]",
            "--set",
            &format!("optimise.targets=[{{ {target} }}]"),
        ];
        let run = Run::of("solve", "held", &text, &sets);
        let data = run.data();
        let record = &data["record"]["targets"][0];
        let expected = if held {
            serde_json::json!([["heave_mm", 0.0]])
        } else {
            Value::Null
        };
        assert_eq!(record["held"], expected, "{motion}: {record}");
        assert_eq!(
            run.page().contains("target at heave 0 mm"),
            held,
            "{motion}"
        );
    }
}

/// The strip of a chart of both wheels compares each wheel with its own targets. If the motion does not contain the pose of a
/// target, the strip does not compare the target.
#[test]
fn a_strip_compares_each_wheel_with_its_own_target() {
    let text = study("macpherson_axle_front.toml");
    let target = |side: &str, camber: f64, tolerance: f64| {
        format!(
            "{{ characteristic = \"camber_to_road\", side = \"{side}\", over = \"roll\", points = [[-2.0, {camber}], \
             [2.0, {camber}]], tolerance = {tolerance} }}"
        )
    };
    let targets = format!(
        "optimise.targets=[{}, {}]",
        target("left", 1.0, 0.5),
        target("right", -1.0, 0.25)
    );
    for (motion, lines) in [
        ("roll = [-2.0, 0.0, 2.0], heave = [0.0, 20.0]", 2),
        ("roll = [-2.0, 0.0, 2.0], heave = [10.0, 20.0]", 0),
    ] {
        let sets = [
            "--set",
            &format!("motion={{ {motion} }}"),
            "--set",
            "outputs.characteristics=[\"camber_to_road\"]",
            "--set",
            &targets,
        ];
        let run = Run::of("solve", "sides", &text, &sets);
        let picture = fs::read_to_string(run.plots().join("camber_to_road_deg.svg")).unwrap();
        let strip = picture.split_once("class=\"strip\"");
        let strip = strip.map_or("", |(_, rest)| rest.split_once("</g>").unwrap().0);
        assert_eq!(strip.matches("class=\"line ").count(), lines, "{motion}");
        for tolerance in ["0.5", "0.25"] {
            let legend = format!("target ± {tolerance} °");
            assert_eq!(picture.matches(&legend).count(), 1, "{legend}");
        }
    }
}

/// The curves before a tuning are in `curves_before.csv`. So the program refuses names of motions that begin with
/// "before".
#[test]
fn a_motion_cannot_have_the_name_of_another_file() {
    let text = study("macpherson_solve.toml");
    for name in ["before", "before_turn"] {
        let motion = format!("{text}\n[motions.{name}]\ntravel = 0.0\n");
        let error =
            hardpoint::study::Study::from_text("m.toml", &motion, std::path::Path::new("."));
        let error = error.unwrap_err().to_string();
        assert!(error.contains("cannot begin with \"before\""), "{error}");
    }
}

//! Tests of excerpts in messages, and of mistakes in files and overrides.

use super::*;

#[test]
fn all_mistakes_are_told_at_once_in_the_order_of_the_file() {
    let text = GOOD
        .replace("steps = 41", "steps = 0")
        .replace("order = \"velocity\"", "order = \"speed\"")
        .replace("starts = 8", "starts = 0");
    let errors = read(&text).unwrap_err();
    let keys: Vec<_> = errors.all().iter().filter_map(|e| e.path()).collect();
    assert_eq!(
        keys,
        ["motion.travel.steps", "outputs.order", "optimise.starts"]
    );
}

#[test]
fn the_excerpt_shows_and_underlines_the_mistake() {
    let errors = read(&edited("side = \"left\"", "side = \"lef\"")).unwrap_err();
    let expected = "\
error: suspension.side: unknown side \"lef\"; expected \"left\" or \"right\"
 --> study.toml:3:8
  |
3 | side = \"lef\"
  |        ^^^^^
  |
  = help: did you mean \"left\"?";
    assert_eq!(errors.render(false), expected);
    assert_eq!(errors.to_string(), expected);
    assert!(errors.render(true).contains("\u{1b}["));
}

#[test]
fn files_that_cannot_be_read() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let message = |name: &str| Study::read(&at(name), &[]).unwrap_err().to_string();
    assert!(
        message("absent.toml").contains("absent.toml: cannot be read: the file does not exist")
    );
    // The help names a study with a similar name, or the directory and the command that writes a study.
    let help = message("absent.toml");
    let here = directory.path().display().to_string();
    assert!(
        help.contains(&here) && help.contains("hardpoint new"),
        "{help}"
    );
    fs::write(at("front.toml"), GOOD).unwrap();
    let meant = format!("did you mean {}?", at("front.toml").display());
    for similar in ["frnt.toml", "front", "front.tml"] {
        let help = message(similar);
        assert!(help.contains(&meant), "{help}");
    }
    let help = message("nowhere/front.toml");
    assert!(help.contains("there is no directory"), "{help}");
    assert!(message(".").contains("it is a directory"));
    // If the path is a directory of results, the message names the studies in it. If the path is a table of points, the
    // message names the command for tables.
    fs::create_dir(at("run")).unwrap();
    fs::write(at("run/optimised.toml"), "").unwrap();
    assert!(message("run").contains("run/optimised.toml"));
    fs::write(at("points.csv"), "name,x,y,z\n").unwrap();
    assert!(message("points.csv").contains("hardpoint import"));
    fs::write(at("points.toml"), "name,x,y,z\n").unwrap();
    assert!(!message("points.toml").contains("hardpoint import"));
    fs::write(at("latin.toml"), b"a = 1\n# caf\xe9\n").unwrap();
    assert!(message("latin.toml").contains("line 2 is not UTF-8 text"));
    fs::write(at("empty.toml"), "").unwrap();
    assert!(message("empty.toml").contains("the file is empty"));
}

#[test]
fn curve_files() {
    let directory = tempfile::tempdir().unwrap();
    let text = edited("at = 0.0, value = 0.0", "file = \"curve.csv\"");
    let read = |csv: &str| {
        fs::write(directory.path().join("curve.csv"), csv).unwrap();
        Study::from_text("study.toml", &text, directory.path())
    };
    let header = "travel_mm,bump_steer_deg_per_mm\n";
    #[rustfmt::skip]
    let cases = [
        ("", None, "the file is empty; expected the columns travel_mm,bump_steer_deg_per_mm"),
        ("-80,0\n80,0\n", Some((1, 1)), "expected the columns travel_mm,bump_steer_deg_per_mm, found -80,0"),
        ("travel_m,bump_steer_deg_per_mm\n", Some((1, 1)), "found travel_m,"),
        ("\n\ntravel_mm,toe_deg\n", Some((3, 1)), "found travel_mm,toe_deg"),
        (&format!("{header}0,1\n"), None, "at least two points, found 1"),
        (&format!("{header}-80,0\n0,nan\n80,0\n"), Some((3, 1)), "expected a finite number as bump_steer_deg_per_mm, found \"nan\""),
        (&format!("{header}-80,0\n\n0\n80,0\n"), Some((4, 1)), "expected two values, found 1"),
        (&format!("\u{feff}{header}\"é\",é\n"), Some((2, 1)), "found \"é\""),
    ];
    for (csv, place, phrase) in cases {
        let errors = read(csv).unwrap_err();
        let rendered = errors.render(false);
        assert!(errors.all()[0].file().ends_with("curve.csv"), "{rendered}");
        assert_eq!(errors.all()[0].position(), place, "{rendered}");
        assert!(rendered.contains(phrase), "{rendered}");
    }

    let study = read(&format!("{header}-80, 0.25\n80,-0.1\n")).unwrap_or_else(|e| panic!("{e}"));
    // The text of the study is complete without the file.
    let again = Study::from_text("study.toml", &study.text, Path::new("elsewhere"));
    let again = again.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(study.inputs, [directory.path().join("curve.csv")]);
    let (inputs, place) = (Vec::new(), Path::new("elsewhere").to_owned());
    let expected = Study {
        inputs,
        directory: place,
        ..study
    };
    assert_eq!(again, expected);
}

#[test]
fn overrides_that_do_not_fit() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("study.toml");
    fs::write(&path, GOOD).unwrap();
    for (set, phrase) in [
        ("motion.rack", "expected path=value"),
        ("motion..rack=1", "is not a path"),
        ("motion.rack.x=1", "is not a table"),
        (
            "optimise.variables.5.axis=\"x\"",
            "the list has 2 elements and none at 5",
        ),
        (
            "optimise.variables.first.axis=\"x\"",
            "\"first\" is not a position in a list of 2",
        ),
        ("motion.rack=fast", "study.toml (with --set)"),
        ("motion.rack=fast", "found the text \"fast\""),
        ("motion.rack=nan", "expected a finite number"),
        ("motion.travel.more.depth=1", "unknown key \"more\""),
        ("optimise.targets.1.more.depth=1", "unknown key \"more\""),
        ("motion.more.depth=1", "unknown key \"more\""),
        (
            "motions.x={}",
            "motions.x: expected travel: the values to solve",
        ),
        (
            "sweep={ designs = \"\" }",
            "sweep.designs: expected the name of a file, found none",
        ),
        ("motoin.rack=1", "did you mean [motion]?"),
    ] {
        let errors = Study::read(&path, &[set.to_owned()])
            .unwrap_err()
            .to_string();
        assert!(errors.contains(phrase), "{set}: {errors}");
    }
}

#[test]
fn other_line_ends_and_a_byte_order_mark_change_nothing() {
    let text = format!("\u{feff}{}", GOOD.replace('\n', "\r\n"));
    read(&text).unwrap_or_else(|e| panic!("{e}"));
    let text = text.replace("side = \"left\"", "side = \"lef\"");
    let errors = read(&text).unwrap_err();
    assert_eq!(errors.all()[0].position(), Some((3, 8)), "{errors}");
}

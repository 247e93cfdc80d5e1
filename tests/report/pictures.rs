//! The pictures.

use super::*;

#[test]
fn there_is_one_for_each_output_and_an_overview() {
    let run = Run::of("optimise", "plain", &study("macpherson_front.toml"), &[]);
    let mut names: Vec<String> = fs::read_dir(run.plots())
        .unwrap()
        .map(|f| f.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "camber_deg.svg",
            "caster_deg.svg",
            "half_track_change_mm.svg",
            "kingpin_inclination_deg.svg",
            "overview.svg",
            "scrub_radius_mm.svg",
            "toe_deg.svg"
        ]
    );
    let overview = fs::read_to_string(run.plots().join("overview.svg")).unwrap();
    for part in [
        "camber [°]",
        "kingpin inclination [°]",
        "wheel travel [mm]",
        "target ± tolerance",
    ] {
        assert!(overview.contains(part), "{part}");
    }
    assert_eq!(overview.matches("class=\"band\"").count(), 2);
}

#[test]
fn a_failed_station_breaks_the_line() {
    let run = Run::of("solve", "far", &study("macpherson_solve.toml"), &TOO_FAR);
    let picture = fs::read_to_string(run.plots().join("camber_deg.svg")).unwrap();
    assert!(picture.contains("not solved"));
    let (_, columns) = run.csv("curves.csv");
    let solved = columns
        .last()
        .unwrap()
        .iter()
        .filter(|s| *s == "ok")
        .count();
    let drawn: usize = picture
        .lines()
        .filter_map(|l| l.strip_prefix("<path class=\"main\" d=\""))
        .filter_map(|l| l.split('"').next())
        // The legend's stroke is a horizontal one.
        .filter(|path| !path.contains('h'))
        .map(|path| path.matches(['M', 'L']).count())
        .sum();
    assert_eq!(drawn, solved);
}

#[test]
fn names_are_text_and_stay_in_the_directory() {
    let run = hostile();
    for file in fs::read_dir(run.plots()).unwrap() {
        let picture = fs::read_to_string(file.unwrap().path()).unwrap();
        assert!(!picture.contains("<script") && !picture.contains("<img"));
    }
}

/// The picture in the README is the program's own, made with
/// `hardpoint optimise studies/macpherson_front.toml --plots out/plots`.
#[test]
fn the_picture_of_the_sample_study_is_current() {
    let run = Run::of("optimise", "plain", &study("macpherson_front.toml"), &[]);
    let kept = fs::read_to_string(studies().join("macpherson_front.svg")).unwrap();
    let made = fs::read_to_string(run.plots().join("overview.svg")).unwrap();
    let pieces = |svg: &str| -> Vec<String> {
        let parts = svg.split_inclusive(|c: char| !(c.is_ascii_digit() || ".-".contains(c)));
        parts.map(str::to_owned).collect()
    };
    let (kept, made) = (pieces(&kept), pieces(&made));
    assert_eq!(
        kept.len(),
        made.len(),
        "out/plots/overview.svg is another picture"
    );
    for (a, b) in kept.iter().zip(&made) {
        let number =
            |s: &str| s[..s.len() - s.chars().last().map_or(0, char::len_utf8)].parse::<f64>();
        match (number(a), number(b)) {
            // A pixel: what the last digits of a platform or a better optimum may do.
            (Ok(x), Ok(y)) => assert!((x - y).abs() <= 1.0, "{a} and {b}"),
            _ => assert_eq!(a, b),
        }
    }
}

//! Tests of the pictures that `--plots` writes.

use super::*;
use hardpoint::report::Places;
use hardpoint::study::Study;
use resvg::tiny_skia::Pixmap;

#[test]
fn there_is_one_for_each_output_and_an_overview() {
    let run = Run::of("optimise", "plain", &study("macpherson_front.toml"), &[]);
    let mut names: Vec<String> = fs::read_dir(run.plots())
        .unwrap()
        .map(|f| f.unwrap().file_name().into_string().unwrap())
        .collect();
    // `run.json` names the run that made the pictures, and `charts.json` contains their layouts.
    names.retain(|name| name != "run.json" && name != "charts.json");
    names.sort();
    assert_eq!(
        names,
        [
            "camber_deg",
            "caster_deg",
            "half_track_change_mm",
            "kingpin_inclination_deg",
            "mechanism",
            "overview",
            "scrub_radius_mm",
            "toe_deg",
            "tuning"
        ]
        .map(|name| [format!("{name}.png"), format!("{name}.svg")])
        .concat()
    );
    let overview = fs::read_to_string(run.plots().join("overview.svg")).unwrap();
    for part in [
        "camber [°]",
        "kingpin inclination [°]",
        "wheel travel [mm]",
        "target ± 0.02 °",
    ] {
        assert!(overview.contains(part), "{part}");
    }
    // Five bands: in the charts of three targets, and in the deviation strips of two targets. The targets of the strips
    // are values, not ranges.
    assert_eq!(overview.matches("class=\"band\"").count(), 3 + 2);
}

/// Each named motion has a picture of every output, and an overview with the outputs that have targets in this motion. The names of
/// the pictures begin with the name of the motion. `charts.json` names the table with the curves of each chart.
#[test]
fn named_motions_have_pictures() {
    let sets = ["--set", "optimise.max_iterations=2"];
    let text = study("macpherson_steering.toml");
    for command in ["solve", "optimise"] {
        let run = Run::of(command, "steering", &text, &sets);
        let picture = |name: &str| fs::read_to_string(run.plots().join(name)).unwrap();
        for name in ["camber_deg", "left_lock_camber_deg", "left_lock_overview"] {
            assert!(run.plots().join(format!("{name}.png")).is_file(), "{name}");
            let title = picture(&format!("{name}.svg"));
            assert_eq!(
                title.contains("left_lock: "),
                name.contains("left_lock"),
                "{name}"
            );
        }
        assert_ne!(
            picture("camber_deg.svg"),
            picture("left_lock_camber_deg.svg")
        );
        let layouts: Value = serde_json::from_str(&picture("charts.json")).unwrap();
        let tables = layouts["tables"].as_array().unwrap();
        assert_eq!(tables.last().unwrap(), "curves_left_lock.csv");
        let (_, columns) = run.csv("curves_left_lock.csv");
        assert_eq!(columns[0].len(), 9);
    }
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
    let curves = picture.lines();
    let curves = curves.filter(|line| line.starts_with("<path class=\"line "));
    let places = |line: &str| {
        line.split_once(" d=\"")
            .unwrap()
            .1
            .matches(['M', 'L'])
            .count()
    };
    let drawn: usize = curves.map(places).sum();
    assert_eq!(drawn, solved);
}

#[test]
fn names_are_text_and_stay_in_the_directory() {
    let run = hostile();
    let files: Vec<PathBuf> = fs::read_dir(run.plots())
        .unwrap()
        .map(|file| file.unwrap().path())
        .collect();
    let is = |kind: &'static str| files.iter().filter(move |f| f.extension().unwrap() == kind);
    assert_eq!(is("svg").count(), is("png").count());
    for file in is("svg") {
        let picture = fs::read_to_string(file).unwrap();
        assert!(!picture.contains("<script") && !picture.contains("<img"));
    }
    for file in is("png") {
        Pixmap::load_png(file).unwrap();
    }
}

/// Red, green and blue of a pixel of a PNG, at a position of the SVG.
fn colour(png: &Pixmap, [x, y]: [f64; 2]) -> [u8; 3] {
    let pixel = png.pixel((2.0 * x) as u32, (2.0 * y) as u32).unwrap();
    [pixel.red(), pixel.green(), pixel.blue()]
}

/// Width in pixels from the first to the last dark pixel column in a part of a PNG.
fn width_of_ink(png: &Pixmap, across: [u32; 2], down: [u32; 2]) -> u32 {
    let dark = |x: u32, y: u32| png.pixel(x, y).unwrap().red() < 0x80;
    let inked = |x: &u32| (down[0]..down[1]).any(|y| dark(*x, y));
    let columns: Vec<u32> = (across[0]..across[1]).filter(inked).collect();
    match (columns.first(), columns.last()) {
        (Some(first), Some(last)) => last + 1 - first,
        _ => 0,
    }
}

/// The PNG shows the SVG at twice the size: white background, the curve at the correct position and in the correct
/// colour. The widths of the labels fit their numbers of letters.
#[test]
fn the_png_shows_what_the_svg_does() {
    let run = Run::of("optimise", "plain", &study("macpherson_front.toml"), &[]);
    let png = |name: &str| Pixmap::load_png(run.plots().join(format!("{name}.png"))).unwrap();
    let overview = png("overview");
    assert_eq!((overview.width(), overview.height()), (2520, 700));
    let camber = png("camber_deg");
    assert_eq!((camber.width(), camber.height()), (840, 700));
    assert_eq!(colour(&camber, [200.0, 10.0]), [255, 255, 255]);
    let corner = camber.pixel(0, 0).unwrap();
    assert_eq!(corner.alpha(), 0, "the corners are round");
    let svg = fs::read_to_string(run.plots().join("camber_deg.svg")).unwrap();
    let curve = svg.lines().find_map(|line| {
        let path = line.strip_prefix("<path class=\"line main strong\" d=\"M")?;
        path.strip_suffix("\"/>").filter(|path| path.contains('L'))
    });
    let mut places = 0;
    for place in curve.unwrap().split('L') {
        let place: Vec<f64> = place.split(' ').map(|n| n.parse().unwrap()).collect();
        assert_eq!(colour(&camber, [place[0], place[1]]), [0x0b, 0x63, 0xc5]);
        places += 1;
    }
    assert_eq!(places, 41);
    // The title of the horizontal axis has the width of 17 letters, and a height of 24 pixels.
    let below = |png: &Pixmap| width_of_ink(png, [128, 800], [664, 700]);
    let kingpin = png("kingpin_inclination_deg");
    let widths = [below(&camber), below(&kingpin)];
    assert!(widths.iter().all(|w| (170..240).contains(w)), "{widths:?}");
    // The names of the charts have 6 and 19 letters. The title of the vertical axis is rotated.
    let name = |png: &Pixmap| width_of_ink(png, [4, 600], [14, 48]);
    let widths = [name(&camber), name(&kingpin)];
    assert!((70..110).contains(&widths[0]), "{widths:?}");
    assert!((210..280).contains(&widths[1]), "{widths:?}");
    let beside = width_of_ink(&camber, [4, 40], [100, 640]);
    assert!((10..32).contains(&beside), "{beside}");
}

/// Two runs with equal numbers write equal bytes of the pictures.
#[test]
fn pictures_are_made_alike() {
    let solve = || Run::of("solve", "plain", &study("macpherson_solve.toml"), &[]);
    let (a, b) = (solve(), solve());
    for file in fs::read_dir(a.plots()).unwrap() {
        let name = file.unwrap().file_name();
        let read = |run: &Run| fs::read(run.plots().join(&name)).unwrap();
        assert!(read(&a) == read(&b), "{name:?}");
    }
}

/// The picture of a tuning shows the mechanism, every target, and the side effects beyond their tolerances. The drawing
/// of the mechanism has the name of every point.
#[test]
fn a_tuning_is_shown_with_its_mechanism_and_side_effects() {
    let run = Run::of("optimise", "plain", &study("macpherson_front.toml"), &[]);
    let tuning = fs::read_to_string(run.plots().join("tuning.svg")).unwrap();
    for part in [
        "front view",
        "camber [°]",
        "toe [°]",
        "kingpin inclination [°]",
        ">Side effect: scrub radius<",
        ">Side effect: half track change<",
        ">scrub radius [mm]<",
        "class=\"was\"",
        "class=\"moved\"",
    ] {
        assert!(tuning.contains(part), "{part}");
    }
    assert!(
        !tuning.contains("caster"),
        "its change is within its tolerance"
    );
    let mechanism = fs::read_to_string(run.plots().join("mechanism.svg")).unwrap();
    for name in [
        "strut_top",
        "lower_arm_rear",
        "tie_rod_outer",
        "wheel_centre",
    ] {
        // The name appears in the front view, the side view and the top view.
        assert_eq!(mechanism.matches(&format!(">{name}<")).count(), 3, "{name}");
    }
}

/// In the front view, the left wheel is on the right. In the side view of a left wheel, forward is to the left. In the
/// top view, forward is up. A right wheel is on the left in the front view, and in its side view forward is to the
/// right.
#[test]
fn views_are_as_their_titles_say() {
    let left = study("double_wishbone_solve.toml");
    let mirrored = |line: &str| match line.split(',').collect::<Vec<_>>()[..] {
        [x, y, z, ..] if line.contains("= [ ") => format!("{x}, -{},{z}", y.trim()),
        _ => line.to_owned(),
    };
    let lines: Vec<String> = left.lines().map(mirrored).collect();
    let right = lines
        .join("\n")
        .replace("side = \"left\" ", "side = \"right\"");
    for (text, side) in [(left, 1.0), (right, -1.0)] {
        let run = Run::of("solve", "plain", &text, &[]);
        let mechanism = fs::read_to_string(run.plots().join("mechanism.svg")).unwrap();
        let at = |view: usize, name: &str| -> [f64; 2] {
            let label = mechanism.split(&format!(">{name}<")).nth(view).unwrap();
            let number = |key: &str| -> f64 {
                let text = label.rsplit_once(&format!("{key}=\"")).unwrap().1;
                text.split('"').next().unwrap().parse().unwrap()
            };
            [number("x"), number("y")]
        };
        let across = |view, a, b| side * (at(view, b)[0] - at(view, a)[0]);
        assert!(across(0, "lower_arm_front", "lower_ball_joint") > 0.0);
        assert!(at(0, "upper_ball_joint")[1] < at(0, "lower_ball_joint")[1]);
        assert!(across(1, "lower_arm_front", "lower_arm_rear") > 0.0);
        assert!(at(2, "lower_arm_front")[1] < at(2, "lower_arm_rear")[1]);
        assert!(across(2, "lower_ball_joint", "lower_arm_front") > 0.0);
    }
}

/// The picture in the README is the one that `hardpoint optimise studies/macpherson_front.toml --plots out/plots`
/// makes.
#[test]
fn the_picture_of_the_sample_study_is_current() {
    let run = Run::of("optimise", "plain", &study("macpherson_front.toml"), &[]);
    let kept = fs::read_to_string(studies().join("macpherson_front.svg")).unwrap();
    let made = fs::read_to_string(run.plots().join("tuning.svg")).unwrap();
    crate::support::assert_same_picture(&kept, &made, "out/plots/tuning.svg");
}

/// Each rack displacement has its own shade and label, and the line at zero is the strongest.
#[test]
fn racks_are_told_apart() {
    let more = ["--set", "motion.rack={from=-30.0,to=30.0,steps=3}"];
    let run = Run::of("solve", "plain", &study("macpherson_solve.toml"), &more);
    let picture = fs::read_to_string(run.plots().join("camber_deg.svg")).unwrap();
    for (shade, name) in [
        (0, "rack \u{2212}30 mm"),
        (4, "rack 0 mm"),
        (8, "rack 30 mm"),
    ] {
        assert!(picture.contains(&format!(">{name}</text>")), "{name}");
        assert!(picture.contains(&format!("<path class=\"line shade{shade}")));
    }
    assert_eq!(picture.matches("strong\"").count(), 1, "the rack at zero");
    assert!(!picture.contains(">design</text>"));
    let many = ["--set", "motion.rack={from=-30.0,to=30.0,steps=21}"];
    let run = Run::of("solve", "plain", &study("macpherson_solve.toml"), &many);
    let picture = fs::read_to_string(run.plots().join("camber_deg.svg")).unwrap();
    assert!((2..=9).contains(&picture.matches(">rack ").count()));
    assert!(picture.contains("9 of 21 values of rack"));
}

/// A picture draws limits where they apply, and shades the area between two limits. It marks values that exceed a limit
/// by more than the tolerance.
#[test]
fn bands_are_drawn_and_what_is_outside_is_marked() {
    let out_of_reach = "between = [[[-60.0, 0.2], [60.0, 0.2]], [[-60.0, 1.5], [60.0, 1.5]]]";
    let text = study("macpherson_steering.toml").replace(
        "between = [[[-60.0, -0.15], [60.0, -0.15]], [[-60.0, 0.15], [60.0, 0.15]]]",
        out_of_reach,
    );
    assert!(text.contains(out_of_reach));
    let once = [
        "--set",
        "optimise.starts=1",
        "--set",
        "optimise.max_iterations=1",
    ];
    let run = Run::of("optimise", "bands", &text, &once);
    let picture = |name: &str| fs::read_to_string(run.plots().join(name)).unwrap();
    let count =
        |name: &str, class: &str| picture(name).matches(&format!("class=\"{class}\"")).count();

    let (header, columns) = run.csv("curves.csv");
    let toe = &columns[header.iter().position(|name| name == "toe_deg").unwrap()];
    let outside = toe
        .iter()
        .filter(|toe| !(0.15..=1.55).contains(&toe.parse::<f64>().unwrap()));
    let outside = outside.count();
    assert!(
        (1..toe.len()).contains(&outside),
        "{outside} of {}",
        toe.len()
    );
    assert_eq!(count("toe_deg.svg", "missed"), outside);
    assert_eq!(count("toe_deg.svg", "limit"), 2);
    assert_eq!(count("toe_deg.svg", "band"), 1);
    // A limit at a single travel is a short horizontal line.
    assert_eq!(count("kingpin_inclination_deg.svg", "limit"), 2);
    assert_eq!(count("kingpin_inclination_deg.svg", "band"), 0);
    assert_eq!(count("caster_deg.svg", "limit"), 0);
    let overview = picture("overview.svg");
    assert!(overview.contains("toe [°]") && overview.contains("kingpin inclination [°]"));
    assert!(!overview.contains("camber [°]"));
}

/// Place of a text: its left end, its width and its baseline.
struct Word {
    text: String,
    at: [f64; 2],
}

impl Word {
    /// Distance from a point to the text.
    fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let [left, base] = self.at;
        let right = left + 6.6 * self.text.chars().count() as f64;
        let across = x - x.clamp(left, right);
        across.hypot(y - y.clamp(base - 10.0, base + 3.0))
    }
}

fn attribute(line: &str, name: &str) -> f64 {
    let value = line.split_once(&format!(" {name}=\"")).unwrap().1;
    value.split('"').next().unwrap().parse().unwrap()
}

/// Every sample study has a picture for each of its charts, and each chart has its own file. In the drawings of the
/// mechanism, each name is nearest to its own point, or a line connects the name and the point.
#[test]
fn every_sample_has_all_pictures_and_its_names_are_at_their_points() {
    let mut studies: Vec<String> = fs::read_dir(studies())
        .unwrap()
        .map(|file| file.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".toml"))
        .collect();
    studies.sort();
    let mut names = 0;
    for name in studies {
        let text = study(&name);
        // A car has no curves.
        if text.contains("[car]") {
            continue;
        }
        let directory = tempfile::tempdir().unwrap();
        let path = super::studies().join(&name);
        let mut solve = hardpoint(&["solve"]);
        solve.arg(&path).arg("--plots").arg(directory.path());
        let ended = solve.output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(matches!(ended.status.code(), Some(0 | 1)), "{name}: {said}");
        let data = fs::read(directory.path().join("charts.json")).unwrap();
        let data: Value = serde_json::from_slice(&data).unwrap();
        let charts = data["charts"].as_array().unwrap();
        let keys: std::collections::BTreeSet<&str> =
            charts.iter().map(|c| c["key"].as_str().unwrap()).collect();
        assert_eq!(keys.len(), charts.len(), "{name}: {keys:?}");
        for kind in ["svg", "png"] {
            let files = fs::read_dir(directory.path()).unwrap();
            let files = files.filter(|f| f.as_ref().unwrap().path().extension().unwrap() == kind);
            // The other pictures are the mechanism, and an overview for each motion.
            let motions = 1 + text.matches("\n[motions.").count();
            let others = 1 + if charts.is_empty() { 0 } else { motions };
            assert_eq!(files.count(), charts.len() + others, "{name}, {kind}");
        }
        let mechanism = fs::read_to_string(directory.path().join("mechanism.svg")).unwrap();
        // The last part is the legend.
        let views: Vec<&str> = mechanism.split("<g transform").skip(1).collect();
        for view in &views[..views.len() - 1] {
            names += names_at_their_points(view, &name);
        }
    }
    assert!(names > 500, "{names}");
}

/// Checks the names of a view. Returns their number.
fn names_at_their_points(view: &str, study: &str) -> usize {
    let lines: Vec<&str> = view.lines().collect();
    let dots: Vec<[f64; 2]> = lines
        .iter()
        .filter(|line| line.starts_with("<circle class=\"point\""))
        .map(|line| ["cx", "cy"].map(|name| attribute(line, name)))
        .collect();
    // A line to a name is written before the name.
    let mut leader: Option<[f64; 2]> = None;
    let mut count = 0;
    for line in lines {
        if let Some(path) = line.strip_prefix("<path class=\"leader\" d=\"M") {
            let start = path.split('L').next().unwrap().split(' ');
            let start: Vec<f64> = start.map(|n| n.parse().unwrap()).collect();
            leader = Some([start[0], start[1]]);
            continue;
        }
        let is_name = line.starts_with("<text") && line.contains('_');
        if is_name {
            let word = Word {
                text: line.split(['>', '<']).nth(2).unwrap().to_owned(),
                at: ["x", "y"].map(|name| attribute(line, name)),
            };
            let nearest = dots.iter().map(|dot| word.distance(*dot));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            match leader {
                // The line to a name begins at a hardpoint.
                Some(start) => assert!(
                    dots.iter()
                        .any(|d| (d[0] - start[0]).hypot(d[1] - start[1]) < 0.2),
                    "{study}: {}",
                    word.text
                ),
                None => {
                    assert!(nearest <= 12.5, "{study}: {} is alone", word.text);
                    let near = dots
                        .iter()
                        .filter(|dot| word.distance(**dot) < nearest + 2.0);
                    let near: Vec<_> = near.collect();
                    let is_one = near
                        .iter()
                        .all(|d| (d[0] - near[0][0]).hypot(d[1] - near[0][1]) <= 1.1);
                    assert!(is_one, "{study}: {} is near {near:?}", word.text);
                }
            }
            count += 1;
        }
        leader = None;
    }
    count
}

/// The outlines of regions that a point must avoid are larger than the regions by the clearance.
#[test]
fn regions_to_avoid_include_the_clearance() {
    let constraints = "optimise.constraints=[\
        { point = \"tie_rod_inner\", outside = { box = [[0, 10, 20], [100, 200, 300]] }, clearance = 3 }, \
        { point = \"tie_rod_inner\", outside = { cylinder = { from = [0, 100, 100], to = [50, 100, 100], radius = 30 } }, clearance = 3 }]";
    let path = crate::support::studies().join("macpherson_steering.toml");
    let study = Study::read(&path, &[constraints.to_owned()]).unwrap();
    let places = Places::of(&study);
    let ends = |number: usize| {
        let points = places.shapes[number].lines.iter().flatten();
        [0, 1, 2].map(|axis| {
            let values = points.clone().map(|p| p[axis]);
            [
                values.clone().fold(f64::INFINITY, f64::min),
                values.fold(f64::NEG_INFINITY, f64::max),
            ]
        })
    };
    assert_eq!(ends(0), [[-3.0, 103.0], [7.0, 203.0], [17.0, 303.0]]);
    let expected = [[-3.0, 53.0], [67.0, 133.0], [67.0, 133.0]];
    for (found, expected) in ends(1)
        .into_iter()
        .flatten()
        .zip(expected.into_iter().flatten())
    {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

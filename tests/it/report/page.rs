//! Tests of the content of the page.

use super::*;

/// Text of a page without references within the page. The SVG namespace is removed too, because it looks like a web
/// address.
pub fn own_text(page: &str) -> String {
    page.replace("http://www.w3.org/2000/svg", "")
        .replace("url(#", "")
}

/// Largest accepted size of a page, in bytes.
pub const MOST_BYTES: usize = 1_500_000;

#[test]
fn it_is_small_and_needs_nothing_else() {
    for run in [
        Run::of("solve", "plain", &study("macpherson_solve.toml"), &[]),
        Run::of("optimise", "plain", &study("macpherson_front.toml"), &[]),
    ] {
        let page = run.page();
        assert!(page.len() < MOST_BYTES, "{} bytes", page.len());
        let own = own_text(&page);
        for address in ["http:", "https:", "//cdn", "src=", "@import", "url("] {
            assert!(!own.contains(address), "{address}");
        }
        assert!(own.contains("default-src &#39;none&#39;"));
        assert!(!own.contains("unsafe-eval"));
        assert!(!own.contains("unsafe-inline"));
        assert!(!own.contains("style=\""), "the policy forbids it");
        // The page has two script elements: the data and the code.
        assert_eq!(page.matches("<script").count(), 2);
    }
}

#[test]
fn a_large_run_still_makes_a_small_page() {
    let run = Run::of(
        "solve",
        "large",
        &study("macpherson_solve.toml"),
        &["--set", "motion.travel={from=-80.0,to=80.0,steps=20001}"],
    );
    let page = run.page();
    assert!(page.len() < MOST_BYTES, "{} bytes", page.len());
    assert!(page.contains("of 20001 stations are shown"));
    let travel = &run.data()["curves"][0]["columns"][0];
    let travel = travel.as_array().unwrap();
    assert_eq!(travel[0], -80.0);
    assert_eq!(travel[travel.len() - 1], 80.0);
}

#[test]
fn its_values_are_those_of_the_files() {
    let text = study("macpherson_front.toml");
    // This range of the variable is too small to meet the targets.
    let top = "{ hardpoint = \"strut_top\",        axis = \"y\", range = [-20.0";
    assert!(text.contains(top));
    let text = text.replace(top, &top.replace("-20.0", "-10.0"));
    let run = Run::of("optimise", "plain", &text, &[]);
    let data = run.data();
    for (design, file) in ["curves_before.csv", "curves.csv"].into_iter().enumerate() {
        let (header, columns) = run.csv(file);
        let table = &data["curves"][design];
        for (k, name) in header.iter().enumerate().filter(|(_, n)| *n != "status") {
            assert_eq!(table["header"][k], **name);
            let cells: Vec<f64> = columns[k].iter().map(|c| c.parse().unwrap()).collect();
            assert_eq!(table["columns"][k], Value::from(cells), "{name}");
        }
    }
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(run.path().join("summary.json")).unwrap())
            .unwrap();
    let misfit = summary["misfit_after"].as_f64().unwrap();
    assert!(
        run.page()
            .contains(&format!("<strong>{misfit:.2}</strong>"))
    );
    assert!(run.page().contains("at lower bound"));
}

/// Every chart of the page names rows and columns of the page's tables. The scales of the chart show all of these
/// values. The page contains each chart as SVG.
#[test]
fn charts_show_all_values_of_their_tables() {
    let run = Run::of("optimise", "plain", &study("macpherson_front.toml"), &[]);
    let (data, page) = (run.data(), run.page());
    let charts = data["charts"].as_array().unwrap();
    let outputs = data["record"]["outputs"].as_array().unwrap().len();
    // Charts of the outputs, of the progress of the tuning, and of misfit against the size of the design change.
    assert_eq!(charts.len(), outputs + 2);
    assert_eq!(
        page.matches("<figure class=\"chart\"").count(),
        charts.len()
    );
    for chart in charts {
        let lines = chart["lines"].as_array().unwrap();
        assert!(!lines.is_empty());
        for line in lines {
            let table = &data["curves"][line["table"].as_u64().unwrap() as usize];
            let names = table["header"].as_array().unwrap();
            for axis in ["x", "y"] {
                let column = names.iter().position(|name| *name == line[axis]).unwrap();
                let [low, high] = ["low", "high"].map(|end| chart[axis][end].as_f64().unwrap());
                for row in line["rows"].as_array().unwrap() {
                    let value = &table["columns"][column][row.as_u64().unwrap() as usize];
                    let room = 1e-9 * (high - low);
                    assert!(
                        value
                            .as_f64()
                            .is_none_or(|v| v >= low - room && v <= high + room),
                        "{} {axis}: {value} is not in {low} to {high}",
                        chart["key"]
                    );
                }
            }
        }
    }
}

#[test]
fn the_drawing_is_the_solvers() {
    let text = study("macpherson_front.toml").replace(
        "[outputs]",
        "[outputs]\npoints = [\"wheel_centre\", \"tie_rod_outer\"]",
    );
    let run = Run::of("optimise", "plain", &text, &[]);
    let data = run.data();
    let (header, columns) = run.csv("curves.csv");
    let names = data["record"]["scene"]["points"].as_array().unwrap();
    for point in ["wheel_centre", "tie_rod_outer"] {
        let place = names.iter().position(|n| n == point).unwrap();
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let name = format!("{point}_{axis}_mm");
            let column = header.iter().position(|n| *n == name).unwrap();
            for (station, cell) in columns[column].iter().enumerate() {
                let frame = &data["record"]["designs"][1]["frames"][station];
                let drawn = frame["pose"]["Ok"]["points"][place][k].as_f64().unwrap();
                let solved: f64 = cell.parse().unwrap();
                assert_eq!(drawn, solved, "{name} at station {station}");
            }
        }
    }
}

#[test]
fn every_topology_is_drawn() {
    for file in fs::read_dir(studies()).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        let Some(stem) = name.strip_suffix("_solve.toml") else {
            continue;
        };
        let run = Run::of("solve", stem, &study(&name), &[]);
        let record = &run.data()["record"];
        let bodies = record["scene"]["bodies"].as_array().unwrap();
        assert!(!bodies.is_empty(), "{name}");
        let names: Vec<&str> = bodies.iter().map(|b| b["name"].as_str().unwrap()).collect();
        let mut different = names.clone();
        different.sort();
        different.dedup();
        // For a solid axle and a twist beam, the page contains the points of both sides.
        let is_axle = ["solid_axle", "twist_beam"].contains(&stem);
        let sides = if is_axle { 2 } else { 1 };
        assert_eq!(names.len(), sides * different.len(), "{names:?}");
        let count = record["scene"]["points"].as_array().unwrap().len();
        let lines = bodies.iter().flat_map(|b| b["lines"].as_array().unwrap());
        let joined = lines.flat_map(|line| line.as_array().unwrap());
        assert!(
            joined
                .clone()
                .all(|p| (p.as_u64().unwrap() as usize) < count)
        );
        assert!(joined.count() >= 4, "{name}");
        // The page of an axle has no section on influences of coordinates.
        let has_influences = !record["influences"].as_array().unwrap().is_empty();
        assert_eq!(has_influences, !is_axle, "{name}");
    }
}

#[test]
fn a_failed_station_is_a_gap_with_a_reason() {
    let run = Run::of("solve", "far", &study("macpherson_solve.toml"), &TOO_FAR);
    let data = run.data();
    let table = &data["curves"][0];
    let status = table["status"].as_array().unwrap();
    let failed: Vec<usize> = (0..status.len()).filter(|i| status[*i] != "ok").collect();
    assert!(!failed.is_empty() && failed.len() < status.len());
    let header = table["header"].as_array().unwrap();
    let camber = header.iter().position(|n| n == "camber_deg").unwrap();
    let stretches = data["record"]["designs"][0]["failures"].as_array().unwrap();
    let page = run.page();
    for station in failed {
        assert!(table["columns"][camber][station].is_null());
        let frame = &data["record"]["designs"][0]["frames"][station];
        let within = |s: &&Value| {
            let [first, last] = ["first", "last"].map(|k| s[k].as_u64().unwrap() as usize);
            (first..=last).contains(&station)
        };
        let stretch = stretches.iter().find(within).expect("a reason");
        assert_eq!(frame["pose"]["Err"], stretch["reason"]);
        assert!(page.contains(stretch["reason"].as_str().unwrap()));
    }
}

/// If a drop link of an axle no longer reaches its lever, the page omits the drawing of that station and gives the
/// reason. At all other stations, the page draws every point.
#[test]
fn an_axle_is_drawn_as_far_as_its_rockers_go() {
    let text = study("macpherson_axle.toml").replace(
        "anti_roll_bar_outer = [ 200.0, 600.0, 200.0]",
        "anti_roll_bar_outer = [   3.0, 600.0, 200.0]",
    );
    let run = Run::of("solve", "short", &text, &[]);
    let data = run.data();
    let frames = data["record"]["designs"][0]["frames"].as_array().unwrap();
    let (mut drawn, mut stuck) = (0, 0);
    for frame in frames {
        let Some(placed) = frame["pose"].get("Ok") else {
            let reason = frame["pose"]["Err"].as_str().unwrap();
            assert!(
                reason.contains("drop link") && reason.contains("toggle"),
                "{reason}"
            );
            stuck += 1;
            continue;
        };
        let points = placed["points"].as_array().unwrap();
        assert!(points.iter().all(|point| numbers(point).len() == 3));
        drawn += 1;
    }
    assert!(drawn > 0 && stuck > 0, "{drawn} drawn, {stuck} not");
}

#[test]
fn a_hostile_name_is_text() {
    let page = hostile().page();
    let own = own_text(&page);
    assert!(own.contains(
        "<bdi>&lt;img src=x onerror=alert(1)&gt;&quot;&#39;&amp;amp;{data} \u{202e}abc 🏎</bdi>"
    ));
    assert!(!own.contains("<img"));
    assert!(!own.contains("<script>alert"));
    assert!(!own.contains("</script><script>alert"));
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let text = study("macpherson_front.toml").replace("starts = 1", "starts = 4");
    let files = |threads: &str| {
        let run = Run::of("optimise", "plain", &text, &["--threads", threads]);
        let again = hardpoint(&["report"]).arg(run.path()).output().unwrap();
        assert!(again.status.success());
        (
            run.page(),
            fs::read(run.plots().join("overview.svg")).unwrap(),
        )
    };
    assert!(files("1") == files("2"));
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|v| v.as_f64().unwrap()).collect()
}

/// The page draws the roll centre and the instant centres at the positions given by the characteristics. In front view,
/// the roll centre is on the line from the contact point to the instant centre.
#[test]
fn centres_are_where_the_characteristics_say() {
    let outputs = "outputs.characteristics=[\"roll_centre_height\",\"front_view_swing_arm\",\"side_view_swing_arm\",\
        \"front_view_centre_lateral\",\"front_view_centre_height\",\"side_view_centre_longitudinal\",\
        \"side_view_centre_height\"]";
    for name in ["macpherson", "double_wishbone", "five_link"] {
        let text = study(&format!("{name}_solve.toml"));
        let run = Run::of("solve", name, &text, &["--set", outputs]);
        let data = run.data();
        let (header, columns) = run.csv("curves.csv");
        let value = |name: &str, station: usize| -> f64 {
            let column = header.iter().position(|n| n == name).unwrap();
            columns[column][station].parse().unwrap()
        };
        let frames = data["record"]["designs"][0]["frames"].as_array().unwrap();
        assert!(frames.len() > 10);
        for (station, frame) in frames.iter().enumerate() {
            let pose = &frame["pose"]["Ok"];
            let place = |key: &str| numbers(&pose[key]);
            let [contact, roll] = ["contact", "roll_centre"].map(place);
            let [front, side] = ["front_view_centre", "side_view_centre"].map(place);
            let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-8 * (1.0 + b.abs()), "{a} {b}");
            close(
                roll[2] - contact[2],
                value("roll_centre_height_mm", station),
            );
            close(
                contact[1] - front[1],
                value("front_view_swing_arm_mm", station),
            );
            close(
                contact[0] - side[0],
                value("side_view_swing_arm_mm", station),
            );
            for (found, name) in [
                (front[1], "front_view_centre_lateral_mm"),
                (front[2] - contact[2], "front_view_centre_height_mm"),
                (side[0], "side_view_centre_longitudinal_mm"),
                (side[2] - contact[2], "side_view_centre_height_mm"),
            ] {
                close(found, value(name, station));
            }
            assert_eq!(
                (roll[0], roll[1], front[0], side[1]),
                (contact[0], 0.0, contact[0], contact[1])
            );
            let slope = |to: &[f64]| (to[2] - contact[2]) / (to[1] - contact[1]);
            close(slope(&roll), slope(&front));
        }
    }
}

/// The page marks a target out of reach wherever it appears.
#[test]
fn missed_targets_are_marked() {
    let far = "optimise.targets=[{characteristic=\"camber\", at=0.0, value=-9.0, tolerance=0.01},\
               {characteristic=\"toe\", at=0.0, value=0.1, tolerance=5.0}]";
    let run = Run::of(
        "optimise",
        "far",
        &study("macpherson_front.toml"),
        &["--set", far],
    );
    let data = run.data();
    let missed = data["missed"].as_array().unwrap();
    assert_eq!(missed.len(), 1, "{missed:?}");
    assert_eq!(missed[0][0], "camber_deg");
    let own = own_text(&run.page());
    // The target is marked on the opening screen and in the table.
    assert_eq!(own.matches("<tr class=\"unmet\">").count(), 2);
    assert!(own.contains("<span class=\"bad\">1</span> of 2 <small>targets</small>"));
    let picture = fs::read_to_string(run.plots().join("camber_deg.svg")).unwrap();
    assert!(picture.contains("class=\"missed\"") && picture.contains(">missed</text>"));
    // The picture shows the tolerance of a target at a single travel as a bar with two ends.
    assert_eq!(picture.matches("class=\"bar\"").count(), 3);
    let good = fs::read_to_string(run.plots().join("toe_deg.svg")).unwrap();
    assert!(!good.contains("class=\"missed\""));
}

/// A printed page names the sections that it omits. It contains the table of side effects once.
#[test]
fn paper_names_the_sections_that_it_omits() {
    let tuned = Run::of("optimise", "plain", &study("macpherson_front.toml"), &[]).page();
    let note = "<p class=\"printed\">Not printed: ";
    let omitted = |page: &str| {
        let (_, rest) = page.split_once(note).expect("a note");
        rest.split('.').next().unwrap().to_owned()
    };
    assert_eq!(
        omitted(&tuned),
        "Convergence, Smallest misfit, Sensitivities"
    );
    assert!(tuned.contains("<div class=\"again\"><p class=\"note\">Side effects"));
    let solved = Run::of("solve", "plain", &study("macpherson_solve.toml"), &[]).page();
    assert_eq!(omitted(&solved), "Sensitivities");
}

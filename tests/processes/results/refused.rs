//! Tests that the program writes nothing and does not hang if it refuses a study.

use super::*;
use std::time::{Duration, Instant};

/// Strut whose constraint equations are singular in the design position. The formulation in point coordinates can solve
/// this strut.
const SINGULAR: &str = r#"[suspension]
topology = "macpherson"
length_unit = "m"
[suspension.hardpoints]
lower_arm_front = [1.495, 0.05, -0.08]
lower_arm_rear = [1.175, 0.05, -0.08]
tie_rod_inner = [1.11, -0.02, 0.06]
strut_top = [1.38, 0.28, 0.49]
lower_ball_joint = [1.495, 0.3565647, 0.1168429]
strut_lower = [1.529685357811275, 0.4173056073449779, 0.08845116878698639]
strut_upper = [1.47979023854085, 0.3715370715633186, 0.2223007791913243]
tie_rod_outer = [1.29423, 0.39064, 0.20407]
wheel_centre = [1.60607, 0.39391, 0.04829]
spindle_inner = [1.47979023854085, 0.3715370715633186, 0.2223007791913243]
[suspension.extra_points]
drive_shaft_inner = {body = "lower_arm", position = [30.52969268792353, 500.0, 300.0]}
[motion]
drive = "paper_theta"
angle_unit = "rad"
time = {polynomial = [1.0, 1.0, 0.5], from = 0.0, to = 2.0, steps = 5}
[solver]
formulation = "point_coordinates"
[outputs]
characteristics = ["attia_kingpin", "attia_camber"]
"#;

/// `check`, `solve` and `export` refuse the same studies, and write nothing.
#[test]
fn commands_agree_on_what_they_refuse() {
    let bench = Bench::new();
    fs::write(bench.path("singular.toml"), SINGULAR).unwrap();
    let before = contents(bench.0.path());
    for call in [
        &["check", "singular.toml"][..],
        &["solve", "singular.toml", "--out", "run"],
        &[
            "export",
            "singular.toml",
            "--to",
            "csv",
            "--out",
            "points.csv",
        ],
        &["export", "singular.toml", "--to", "adams"],
    ] {
        bench.refused(call, &["singular.toml: ", "singular"]);
        assert_eq!(contents(bench.0.path()), before, "{call:?}");
    }
    bench
        .run(&["export", "study.toml", "--to", "csv"])
        .success();
}

/// Motions have a limited number of stations, so that all results fit in memory. The refusal states the key, the
/// largest number of stations (100000), and the requested number.
#[test]
fn ten_million_stations_are_refused() {
    let bench = Bench::new();
    let steps = "motion.travel={from=-40.0,to=40.0,steps=10000000}";
    for command in ["check", "solve", "sweep", "optimise", "limits"] {
        let call = [command, "study.toml", "--set", steps];
        bench.refused(&call, &["motion.travel.steps", "100000", "10000000"]);
    }
    assert!(!bench.path("out").exists());
}

/// Devices without end, and pipes to which nobody writes, are refused wherever the program expects a file.
#[cfg(unix)]
#[test]
fn devices_and_named_pipes_are_no_files() {
    let bench = Bench::new();
    let pipe = Command::new("mkfifo").arg(bench.path("pipe")).status();
    assert!(pipe.unwrap().success());
    bench
        .run(&["export", "study.toml", "--to", "csv", "--out", "points.csv"])
        .success();
    for (file, kind) in [("/dev/zero", "device"), ("pipe", "named pipe")] {
        let curve =
            format!("optimise.targets=[{{characteristic=\"toe\",file=\"{file}\",tolerance=1.0}}]");
        let designs = format!("sweep={{designs=\"{file}\"}}");
        for call in [
            &["check", file][..],
            &["solve", file],
            &["import", file, "--topology", "macpherson"],
            &[
                "import",
                "points.csv",
                "--topology",
                "macpherson",
                "--map",
                file,
            ],
            &["export", "study.toml", "--to", "adams", "--into", file],
            &["check", "study.toml", "--set", &curve],
            &["sweep", "study.toml", "--set", &designs],
            &["compare", "study.toml", file],
        ] {
            let begun = Instant::now();
            bench.refused(call, &[kind]);
            assert!(begun.elapsed() < Duration::from_secs(20), "{call:?}");
        }
        bench.refused(
            &["studio", file, "--no-open"],
            &["it is not a regular file"],
        );
    }
}

/// If a file is longer than any useful file, the program does not read the file to its end.
#[test]
fn long_files_are_not_read_to_their_end() {
    let bench = Bench::new();
    let file = fs::File::create(bench.path("long")).unwrap();
    // The file is sparse, so it takes no space on the disk.
    file.set_len(3 << 30).unwrap();
    for call in [
        &["check", "long"][..],
        &["studio", "long", "--no-open"],
        &[
            "import",
            "study.toml",
            "--topology",
            "macpherson",
            "--map",
            "long",
        ],
        &["export", "study.toml", "--to", "adams", "--into", "long"],
    ] {
        bench.refused(call, &["longer than 64 MB"]);
    }
}

/// If someone has replaced a lock file by a link, the message names this link. The program does not wait.
#[cfg(unix)]
#[test]
fn a_link_in_place_of_a_lock_is_named() {
    let bench = Bench::new();
    fs::create_dir(bench.path("run")).unwrap();
    for target in ["nowhere", "../study.toml"] {
        let link = bench.path("run/.hardpoint-lock");
        let _ = fs::remove_file(&link);
        std::os::unix::fs::symlink(target, &link).unwrap();
        let call = ["solve", "study.toml", "--out", "run"];
        bench.refused(&call, &[".hardpoint-lock", "symbolic link", "remove it"]);
        assert_eq!(bench.read("study.toml"), STUDY);
    }
    fs::remove_file(bench.path("run/.hardpoint-lock")).unwrap();
    bench
        .run(&["solve", "study.toml", "--out", "run"])
        .success();
}

//! Tests of runs that are killed at random moments.

use super::*;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Pseudo-random sequence that is the same every time.
fn fraction(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) as f64 / (1_u64 << 31) as f64
}

/// Asserts that the directory of a killed run contains no other files than these: files of a complete run (equal to the
/// byte), the record of the progress, and leftovers.
fn assert_nothing_is_torn(directory: &Path, whole: &[(String, Vec<u8>)]) {
    for (name, text) in contents(directory) {
        if name.starts_with(".hardpoint-") || name == "run.json" {
            continue;
        }
        // A summary must be complete before it says that the run has finished.
        let text = if name == "summary.json" {
            let text = String::from_utf8(text).unwrap();
            let begun = "{\n  \"finished\": false,";
            text.replacen(begun, "{\n  \"finished\": true,", 1)
                .into_bytes()
        } else {
            text
        };
        let expected = whole.iter().find(|(known, _)| *known == name);
        assert!(
            expected.is_some_and(|(_, expected)| *expected == text),
            "{name} is torn"
        );
    }
}

/// Disk space for the files of the second run in a directory.
#[derive(Clone, Copy, PartialEq)]
enum Disk {
    Empty,
    /// The disk gets full at a random moment: some runs find no space before the first write, others during the last
    /// file.
    Fills,
}

/// Kills sweeps and tunings at random moments, each with a second run in the same directory. The files of both runs are
/// complete, and files of other programs are unchanged. The next run ends with the same bytes as an undisturbed run.
fn kill(rounds: u64, samples: &str, disk: Disk) {
    let bench = Bench::new();
    let many = format!("sweep.samples={samples}");
    let sweep = ["sweep", "study.toml", "--set", &many, "--out"];
    let tuning = [
        "optimise",
        "study.toml",
        "--set",
        "optimise.starts=60",
        "--out",
    ];
    let (mut seed, mut full_disks) = (17, 0);
    for (call, resume) in [(&sweep, true), (&tuning, false)] {
        let begun = Instant::now();
        bench.run(&[&call[..], &["whole"]].concat()).success();
        let time = begun.elapsed();
        let whole = contents(&bench.path("whole"));
        for round in 0..rounds {
            let run = format!("{}-{round}", call[0]);
            let directory = bench.path(&run);
            fs::create_dir(&directory).unwrap();
            fs::write(directory.join("notes.txt"), "mine").unwrap();
            fs::write(directory.join("curves_of_mine.csv"), "mine").unwrap();
            let with_foreign = |mut files: Vec<(String, Vec<u8>)>| {
                files.retain(|(name, _)| name != "notes.txt" && name != "curves_of_mine.csv");
                files
            };
            for attempt in 0..2 {
                let more: &[&str] = if resume && attempt > 0 {
                    &["--resume"]
                } else {
                    &[]
                };
                let call = [&call[..], &[&run], more].concat();
                let mut first = bench.start(&call);
                sleep(time.mul_f64(1.1 * fraction(&mut seed)));
                let second = match disk {
                    Disk::Empty => bench.start(&call),
                    Disk::Fills => {
                        let blocks = 2.0 * 1024.0_f64.powf(1.3 * fraction(&mut seed));
                        bench.start_with_room(&call, blocks as u64)
                    }
                };
                sleep(Duration::from_millis((30.0 * fraction(&mut seed)) as u64));
                first.kill().unwrap();
                first.wait().unwrap();
                // The second run found the directory either in use, or as the killed run left it.
                let second = second.wait_with_output().unwrap();
                let said = String::from_utf8_lossy(&second.stderr);
                let is_full = said.contains("cannot write");
                full_disks += usize::from(is_full);
                if is_full && disk == Disk::Fills {
                    assert!(matches!(second.status.code(), Some(1 | 2)), "{said}")
                } else {
                    assert!(matches!(second.status.code(), Some(0 | 2)), "{said}")
                }
                for name in ["notes.txt", "curves_of_mine.csv"] {
                    assert_eq!(fs::read(directory.join(name)).unwrap(), b"mine");
                }
                let there = bench.path("seen");
                fs::create_dir(&there).unwrap();
                for (name, text) in with_foreign(contents(&directory)) {
                    fs::write(there.join(name), text).unwrap();
                }
                assert_nothing_is_torn(&there, &whole);
                fs::remove_dir_all(&there).unwrap();
            }
            let more: &[&str] = if resume { &["--resume"] } else { &[] };
            bench.run(&[&call[..], &[&run], more].concat()).success();
            assert_eq!(with_foreign(contents(&directory)), whole);
            fs::remove_dir_all(&directory).unwrap();
        }
        fs::remove_dir_all(bench.path("whole")).unwrap();
    }
    assert!(disk == Disk::Empty || full_disks > 0);
}

#[test]
fn a_dozen_kills_lose_nothing() {
    kill(3, "20000", Disk::Empty);
}

/// The disk is full for the second run (simulated by a limit on the size of files). Kills lose nothing.
#[cfg(unix)]
#[test]
fn kills_on_a_full_disk_lose_nothing() {
    kill(2, "20000", Disk::Fills);
}

/// Long test of `.ci/long`: each round kills two sweeps or tunings, some of them in the middle of a second part.
#[test]
#[ignore = "takes minutes"]
fn a_hundred_kills_lose_nothing() {
    kill(25, "150000", Disk::Empty);
}

#[cfg(unix)]
#[test]
#[ignore = "takes minutes"]
fn a_hundred_kills_on_a_full_disk_lose_nothing() {
    kill(25, "150000", Disk::Fills);
}

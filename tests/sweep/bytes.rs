//! The same bytes however a sweep is run.

use super::*;

#[test]
fn threads_and_shards_give_the_same_bytes() {
    let bench = Bench::new(STUDY);
    bench.sweep("one", &["--threads", "1"]).success();
    bench.sweep("three", &["--threads", "3"]).success();
    bench.assert_same("one", "three");
    // Six blocks of designs; more shards than blocks, so that some are empty.
    for shards in [2, 7] {
        let mut parts = Vec::new();
        for i in (1..=shards).rev() {
            let (part, shard) = (format!("part{i}of{shards}"), format!("{i}/{shards}"));
            bench.sweep(&part, &["--shard", &shard]).success();
            parts.push(part);
        }
        let mut arguments = vec!["merge", "--out", "merged"];
        arguments.extend(parts.iter().map(String::as_str));
        bench.run(&arguments).success();
        bench.assert_same("one", "merged");
    }
    let designs = bench.designs("one");
    assert_eq!(designs.rows.len(), 700);
    assert!(designs.text("status").iter().all(|s| *s == "ok"));
    let curves = Table::read(&bench.path("one/curves.csv"));
    assert_eq!(curves.rows.len(), 700 * 4);
}

/// Wherever it was torn, in rows or curves, at a row's end or within, a sweep goes on to the same bytes.
#[test]
fn a_torn_sweep_is_taken_up_again_to_the_same_bytes() {
    let bench = Bench::new(STUDY);
    bench.sweep("whole", &[]).success();
    let sizes = ["designs.csv", "curves.csv"].map(|name| {
        let contents = fs::read(bench.path("whole").join(name)).unwrap();
        (name, contents)
    });
    for (designs, curves) in [(0.5, 0.7), (0.9, 0.3), (1.0, 0.999), (0.02, 1.0)] {
        let torn = bench.path("torn");
        fs::create_dir_all(&torn).unwrap();
        fs::copy(bench.path("whole/sweep.json"), torn.join("sweep.json")).unwrap();
        for ((name, contents), share) in sizes.iter().zip([designs, curves]) {
            let length = (contents.len() as f64 * share) as usize;
            fs::write(torn.join(name), &contents[..length]).unwrap();
        }
        bench
            .sweep("torn", &["--resume", "--threads", "2"])
            .success();
        bench.assert_same("whole", "torn");
    }
    // A finished one is left as it is; one that was never begun is begun.
    bench.sweep("whole", &["--resume"]).success();
    bench.assert_same("whole", "torn");
    bench.sweep("begun", &["--resume"]).success();
    bench.assert_same("whole", "begun");
}

#[test]
fn the_designs_alone_go_to_standard_output() {
    let bench = Bench::new(STUDY);
    bench.sweep("run", &[]).success();
    let (out, error) = said(&bench.sweep("-", &[]).success());
    assert_eq!(
        out,
        fs::read_to_string(bench.path("run/designs.csv")).unwrap()
    );
    assert!(error.contains("700 designs, all solved"), "{error}");
}

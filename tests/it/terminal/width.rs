//! Tests that lines fit the width and that numbers have meaningful digits.

use super::{Called, study};

fn longest(text: &str) -> usize {
    text.lines()
        .map(|line| line.chars().count())
        .max()
        .unwrap_or(0)
}

/// Design with many free directions and many starts. The printed text must stay short.
const FREE: [&str; 6] = [
    "--set",
    "optimise.starts=30",
    "--set",
    "optimise.targets=[{characteristic=\"camber\", at=0.0, value=-0.7, tolerance=0.02}]",
    "--set",
    "motion.travel=[-20.0, 0.0, 20.0]",
];

#[test]
fn lines_fit_the_width() {
    let calls: [(&str, &str, &[&str]); 9] = [
        ("check", "double_wishbone_pushrod", &[]),
        ("solve", "double_wishbone_pushrod", &[]),
        (
            "solve",
            "macpherson_solve",
            &["--set", "motion.travel={from=-400.0,to=400.0,steps=9}"],
        ),
        ("optimise", "five_link_rear", &[]),
        ("optimise", "macpherson_front", &FREE),
        ("sweep", "macpherson_sweep", &["--set", "sweep.samples=64"]),
        ("limits", "double_wishbone_pushrod", &[]),
        ("assemblies", "double_wishbone_solve", &[]),
        ("assemblies", "macpherson_solve", &[]),
    ];
    for (command, name, more) in calls {
        let path = study(name);
        for (columns, width) in [(None, 100), (Some("80"), 80), (Some("60"), 60)] {
            let variables: Vec<(&str, &str)> = columns.iter().map(|c| ("COLUMNS", *c)).collect();
            let mut arguments = vec![command, path.to_str().unwrap()];
            arguments.extend(more);
            let said = Called::with(&arguments, &variables).said();
            assert!(!said.is_empty());
            assert!(
                longest(&said) <= width,
                "{command} {name} in {width}:\n{said}"
            );
        }
    }
}

/// No printed number has more than seven digits, and none is a rounding error.
#[test]
fn figures_have_digits_that_mean_something() {
    for (command, name) in [
        ("check", "double_wishbone_pushrod"),
        ("solve", "double_wishbone_pushrod"),
        ("solve", "semi_trailing_arm_solve"),
        ("limits", "double_wishbone_pushrod"),
        ("limits", "five_link_solve"),
        ("assemblies", "double_wishbone_solve"),
        ("optimise", "double_wishbone_rocker"),
    ] {
        let said = Called::on(command, name, &[]).said();
        for word in said.split_whitespace() {
            let Ok(value) = word.parse::<f64>() else {
                continue;
            };
            let digits = word.split('e').next().unwrap();
            let digits = digits.trim_start_matches(['-', '+', '0', '.']);
            let digits = digits.chars().filter(char::is_ascii_digit).count();
            assert!(digits <= 7, "{command} {name}: {word}");
            let is_misfit = command == "optimise";
            assert!(
                value == 0.0 || is_misfit || value.abs() > 1e-11,
                "{command} {name}: {word}"
            );
        }
    }
}

#[test]
fn many_starts_and_free_directions_are_said_in_a_few_lines() {
    let called = Called::on("optimise", "macpherson_front", &FREE);
    let said = called.said();
    assert!(said.lines().count() < 50, "{said}");
    assert!(said.contains("30 starts: "), "{said}");
    assert!(said.contains("more such moves, in summary.json"), "{said}");
    let summary: serde_json::Value = serde_json::from_str(&called.file("summary.json")).unwrap();
    assert_eq!(summary["starts"].as_array().unwrap().len(), 30);
    assert!(summary["unseen"].as_array().unwrap().len() > 2);
}

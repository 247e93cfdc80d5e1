//! Support for tests: studies of the repository with elastic parts, with more text at their end.

use crate::support::larger;
use crate::support::random::Random;
use hardpoint::compliance::Compliance;
use hardpoint::curves::Curves;
use hardpoint::model::Suspension;
use hardpoint::study::Study;
use hardpoint::tolerance::{MonteCarlo, Problem};
use std::path::Path;

/// Text of a study of the repository, with more text at its end.
pub fn with(name: &str, more: &str) -> String {
    crate::support::sample(name) + more
}

/// Study with elastic parts, read from its text.
pub fn elastic(text: &str) -> Study {
    Study::elastic_from_text("case.toml", text, Path::new("")).unwrap_or_else(|e| panic!("{e}"))
}

/// Asserts that smallest and largest value of an analysis with two builds are the values of these builds, and that the builds
/// differ. `curves` are the curves of both builds as printed. Returns the number of compared values.
pub fn assert_printed_builds(
    problem: &Problem<'_>,
    found: &MonteCarlo,
    curves: &[Curves; 2],
    is_same: impl Fn(f64, f64) -> bool,
) -> usize {
    let mut compared = 0;
    for (output, column) in problem.outputs().iter().enumerate() {
        for own in curves {
            assert_eq!(own.columns[output].name, column.name);
        }
        for station in 0..problem.stations().count() {
            let spread = &found.spreads[problem.cell(output, station)];
            // Test results have values in the design position only.
            if spread.count == 0 {
                continue;
            }
            let value = |own: &Curves| own.stations[station].value(output).unwrap();
            let [a, b] = curves.each_ref().map(value);
            assert!(!is_same(a, b), "{} {station}: {a} {b}", column.name);
            for (end, limit) in [a.min(b), larger(a, b)].into_iter().zip(spread.range) {
                let limit = limit * column.factor();
                assert!(
                    is_same(end, limit),
                    "{} {station}: {end} {limit}",
                    column.name
                );
                compared += 1;
            }
        }
    }
    compared
}

/// Sample suspension of a topology with a drop link and an anti-roll bar, and its elastic parts.
pub fn elastic_axle(topology: &str) -> (Suspension, Compliance) {
    let (bar, bodies) = match topology {
        "double_wishbone" => (
            "drop_link_outer = [10.0, 560.0, 200.0]\ndrop_link_inner = [20.0, 565.0, 320.0]\n\
             anti_roll_bar_inner = [170.0, 300.0, 320.0]\nanti_roll_bar_outer = [170.0, 540.0, 325.0]\n",
            "[suspension.bodies]\ndrop_link_outer = \"lower_arm\"\n",
        ),
        _ => (
            "drop_link_outer = [30.0, 690.0, 260.0]\ndrop_link_inner = [30.0, 680.0, 400.0]\n\
             anti_roll_bar_inner = [190.0, 300.0, 400.0]\nanti_roll_bar_outer = [190.0, 600.0, 405.0]\n",
            "[suspension.bodies]\ndrop_link_outer = \"knuckle\"\n",
        ),
    };
    let text = with(&format!("{topology}_compliance.toml"), "");
    let text = text.replacen("\n[wheel]", &format!("{bar}{bodies}\n[wheel]"), 1);
    let study = elastic(&text);
    let parts = study.compliance().unwrap().parts.clone();
    (study.into_wheel(), parts)
}

/// Derivative of fourth order, from the values two steps and one step below, and one step and two steps above.
pub fn fourth_order([a, b, c, d]: [f64; 4], step: f64) -> f64 {
    (8.0 * (c - b) - (d - a)) / (12.0 * step)
}

/// Standard deviation of a measurement, divided by its value.
const NOISE: f64 = 0.01;

/// Measured sheet: `kc.csv` without secants, with a column of tolerances and random noise times `share`. Rows without a value are
/// left out.
pub fn sheet(csv: &[u8], share: f64, seed: u64) -> String {
    let mut reader = csv::Reader::from_reader(csv);
    let header = reader.headers().unwrap().clone();
    let place = |name: &str| header.iter().position(|column| column == name).unwrap();
    let mut random = Random(seed);
    let mut text = header.iter().collect::<Vec<_>>().join(",") + ",tolerance\n";
    for record in reader.records() {
        let record = record.unwrap();
        let mut cells: Vec<String> = record.iter().map(str::to_owned).collect();
        let Ok(value) = cells[place("value")].parse::<f64>() else {
            continue;
        };
        // A measured sheet contains no secants.
        cells[place("secant")].clear();
        // The sum of twelve uniform numbers with this range approximates a standard normal distribution.
        let normal: f64 = (0..12).map(|_| 0.5 * random.signed()).sum();
        let sigma = NOISE * value.abs().max(1e-3);
        cells[place("value")] = format!("{:?}", value + share * sigma * normal);
        text += &format!("{},{sigma:?}\n", cells.join(","));
    }
    text
}

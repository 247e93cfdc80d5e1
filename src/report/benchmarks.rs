//! Measurements of a benchmark, as tables and as a picture.

use super::accuracy_plot;
use super::table::{Cell, Table};
use crate::bench::JobTime;
use crate::bench::accuracy::{Accuracy, Family};
use crate::bench::effects::Effects;
use crate::bench::throughput::Throughput;

/// Table of computing times: equilibria, complete tests (`kc`), states of a car.
pub fn jobs_table(measurements: &[JobTime]) -> Table {
    let mut table = Table::new(["job", "us_each", "spread_percent", "per_s"]);
    for m in measurements {
        table.push([
            Cell::from(m.job),
            Cell::rounded(m.timing.median / 1e3, 3),
            Cell::rounded(100.0 * m.timing.spread(), 0),
            Cell::rounded(1e9 / m.timing.median, 0),
        ]);
    }
    table
}

/// Table of poses per second, one row for each output, method and number of threads.
pub fn throughput_table(throughput: &Throughput) -> Table {
    let mut table = Table::new([
        "asked",
        "method",
        "threads",
        "ns_per_pose",
        "spread_percent",
        "million_poses_per_s",
        "million_poses_per_s_and_thread",
        "times_the_paper",
        "times_the_limit",
    ]);
    let (paper, limit) = (throughput.by_the_paper(), throughput.limit());
    for m in &throughput.measurements {
        let times = paper.map(|p| p.timing.median / m.timing.median);
        table.push([
            Cell::from(m.asked),
            m.method.as_str().into(),
            m.threads.into(),
            Cell::rounded(m.timing.median, 1),
            Cell::rounded(100.0 * m.timing.spread(), 0),
            Cell::rounded(m.millions(), 3),
            Cell::rounded(m.millions() / m.threads as f64, 3),
            times.map(|t| Cell::rounded(t, 1)).into(),
            limit
                .map(|l| Cell::rounded(m.timing.median / l.timing.median, 2))
                .into(),
        ]);
    }
    table.keyed(3)
}

/// Table of the computing time per pose for each effect: alone, and together with all previous effects.
pub fn effects_table(effects: &Effects) -> Table {
    let mut table = Table::new([
        "effect",
        "alone_ns",
        "spread_percent",
        "alone_ratio",
        "added_ns",
        "added_ratio",
        "factorisations",
        "right_hand_sides",
    ]);
    let position = effects.measurements[0].alone.median;
    for m in &effects.measurements {
        let per_pose = |count: u64| Cell::rounded(count as f64 / m.poses as f64, 2);
        table.push([
            Cell::from(m.effect.as_str()),
            Cell::rounded(m.alone.median, 0),
            Cell::rounded(100.0 * m.alone.spread(), 1),
            Cell::rounded(m.alone.median / position, 2),
            Cell::rounded(m.added.median, 0),
            Cell::rounded(m.added.median / position, 2),
            per_pose(m.work.factorisations),
            per_pose(m.work.right_hand_sides),
        ]);
    }
    table
}

/// Short table of computing time against accuracy, with about ten rows: the fastest method for each number of digits and each
/// kind of derivative.
pub fn accuracy_summary(accuracy: &Accuracy) -> Table {
    let mut table = Table::new([
        "measured",
        "error up to",
        "fastest",
        "setting",
        "ns per pose",
        "error",
    ]);
    let asked = [
        ("pose", Family::Pose, 1e-3),
        ("pose", Family::Pose, 1e-6),
        ("pose", Family::Pose, 1e-9),
        ("pose", Family::Pose, 1e-12),
        ("pose, by starting point", Family::Start, 1e-9),
        ("curve", Family::Curve, 1e-3),
        ("curve", Family::Curve, 1e-6),
        (
            "derivatives with respect to hardpoints",
            Family::Derivative,
            1e-5,
        ),
        (
            "derivatives with respect to hardpoints",
            Family::Derivative,
            1e-10,
        ),
        ("derivatives, by direction", Family::Sensitivity, 1e-10),
    ];
    for (measured, family, bound) in asked {
        let within = accuracy
            .measurements
            .iter()
            .filter(|m| m.family == family && m.error <= bound);
        let fastest = within.min_by(|a, b| a.time.median.total_cmp(&b.time.median));
        let bound = format!("{bound:.0e} {}", family.unit());
        let Some(m) = fastest else {
            table.push([measured, bound.as_str(), "none", "", "", ""]);
            continue;
        };
        table.push([
            Cell::from(measured),
            bound.into(),
            m.method.as_str().into(),
            m.setting.as_str().into(),
            Cell::rounded(m.time.median, 1),
            Cell::by(m.error, |error| format!("{error:.0e}")),
        ]);
    }
    table
}

/// Table of computing time against accuracy, one row for each method and setting.
pub fn accuracy_table(accuracy: &Accuracy) -> Table {
    let mut table = Table::new([
        "family",
        "method",
        "setting",
        "ns_per_pose",
        "spread_percent",
        "evaluations",
        "error",
        "unit",
    ]);
    for m in &accuracy.measurements {
        table.push([
            Cell::from(m.family.name()),
            m.method.as_str().into(),
            m.setting.as_str().into(),
            Cell::rounded(m.time.median, 1),
            Cell::rounded(100.0 * m.time.spread(), 1),
            m.evaluations.map(|e| Cell::rounded(e, 2)).into(),
            Cell::by(m.error, |error| format!("{error:.2e}")),
            m.family.unit().into(),
        ]);
    }
    table
}

/// SVG picture of computing time against accuracy.
pub fn accuracy_picture(accuracy: &Accuracy, caption: &str) -> String {
    accuracy_plot::svg(accuracy, caption)
}

//! Charts of a tuning: convergence history, Pareto front, and misfit against size of change.

use super::charts::Charts;
use crate::report::chart::{Chart, Line, Quantity, Source};
use crate::report::curve_table::CurveTable;
use crate::report::{FrontRecord, PriceRecord};

/// Line through some rows of the table with index `table`. `columns` are the columns of the horizontal and the vertical axis.
fn line(table: usize, columns: [&str; 2], rows: Vec<usize>, class: &str) -> Line {
    Line {
        label: None,
        told: String::new(),
        class: class.to_owned(),
        is_main: false,
        in_strip: false,
        has_dots: false,
        source: Source {
            table,
            x: columns[0].to_owned(),
            y: columns[1].to_owned(),
            rows,
        },
    }
}

/// Chart of the misfit over the iterations, with one line for each start of the tuning. `kept` is the index of the start whose
/// result the tuning keeps.
pub(super) fn history_chart(
    history: CurveTable,
    kept: Option<usize>,
    charts: &mut Charts,
) -> String {
    let table = charts.tables.len();
    let starts: Vec<Option<f64>> = history.column("start").unwrap_or_default().to_vec();
    let mut numbers: Vec<f64> = starts.iter().flatten().copied().collect();
    numbers.dedup();
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    let of_start = |number: &f64| {
        let rows = (0..starts.len()).filter(|row| starts[*row] == Some(*number));
        let is_kept = kept.is_some_and(|kept| kept as f64 == *number);
        let class = if is_kept {
            "main strong"
        } else {
            "former fine"
        };
        let told = format!("start {number}{}", if is_kept { ", kept" } else { "" });
        Line {
            label: (is_kept && numbers.len() > 1).then(|| "kept".to_owned()),
            told,
            is_main: is_kept,
            has_dots: is_kept,
            ..line(table, ["iteration", "misfit"], rows.collect(), class)
        }
    };
    let mut lines: Vec<Line> = numbers.iter().map(of_start).collect();
    lines.sort_by_key(|line| line.is_main);
    charts.tables.push(history);
    let chart = Chart {
        key: "history".to_owned(),
        x: Quantity::new("iteration", "iteration", ""),
        y: Quantity {
            is_log: true,
            ..Quantity::new("misfit", "misfit", "tolerances")
        },
        lines,
        ..Chart::default()
    };
    charts.figure(chart, "", "")
}

/// Chart of the smallest misfit against the size of the change, with a dot at the tuned design.
pub(super) fn prices_chart(prices: &[PriceRecord], charts: &mut Charts) -> String {
    let table = charts.tables.len();
    let column = |of: fn(&PriceRecord) -> f64| prices.iter().map(|p| Some(of(p))).collect();
    charts.tables.push(CurveTable {
        header: vec!["moved".to_owned(), "misfit".to_owned()],
        columns: vec![column(|p| p.moved), column(|p| p.misfit)],
        status: Vec::new(),
    });
    let columns = ["moved", "misfit"];
    let all = Line {
        told: "smallest misfit".to_owned(),
        is_main: true,
        has_dots: true,
        ..line(table, columns, (0..prices.len()).collect(), "main strong")
    };
    let kept = prices.iter().position(|price| price.kept).map(|row| Line {
        label: Some("kept".to_owned()),
        told: "kept".to_owned(),
        has_dots: true,
        ..line(table, columns, vec![row], "target")
    });
    let chart = Chart {
        key: "prices".to_owned(),
        x: Quantity::new("moved", "size of the change", "ranges"),
        y: Quantity::new("misfit", "misfit", "tolerances"),
        lines: [all].into_iter().chain(kept).collect(),
        from_zero: true,
        ..Chart::default()
    };
    charts.figure(chart, "", "")
}

/// Charts of the Pareto front: one chart for two targets, or one for each pair of the first three targets. `kept` is the index of
/// the point that is the tuned design.
pub(super) fn front_charts(
    front: &FrontRecord,
    kept: Option<usize>,
    charts: &mut Charts,
) -> String {
    if front.points.is_empty() {
        return String::new();
    }
    let table = charts.tables.len();
    let names: Vec<String> = (0..front.goals.len())
        .map(|k| format!("misfit{k}"))
        .collect();
    let column = |k: usize| {
        front
            .points
            .iter()
            .map(move |point| point.misfits.get(k).copied())
    };
    charts.tables.push(CurveTable {
        header: names.clone(),
        columns: (0..names.len()).map(|k| column(k).collect()).collect(),
        status: Vec::new(),
    });
    let pairs: &[[usize; 2]] = match front.goals.len() {
        0 | 1 => &[],
        2 => &[[0, 1]],
        _ => &[[0, 1], [0, 2], [1, 2]],
    };
    let mut figures = String::new();
    for [a, b] in pairs {
        let columns = [names[*a].as_str(), names[*b].as_str()];
        // The line through the points is interrupted where the Pareto front has a gap. With more than two targets, the points have
        // no line.
        let mut pieces: Vec<Vec<usize>> = vec![Vec::new()];
        for row in 0..front.points.len() {
            pieces
                .last_mut()
                .expect("the list has an element")
                .push(row);
            if front.goals.len() > 2 || front.breaks.contains(&row) {
                pieces.push(Vec::new());
            }
        }
        let pieces = pieces.into_iter().filter(|piece| !piece.is_empty());
        let lines = pieces.map(|rows| Line {
            has_dots: true,
            ..line(table, columns, rows, "main")
        });
        let kept = kept.map(|row| Line {
            label: Some("kept".to_owned()),
            has_dots: true,
            ..line(table, columns, vec![row], "target")
        });
        let of_goal = |k: usize, column: &str| {
            Quantity::new(
                column,
                &format!("misfit of {}", front.goals[k]),
                "tolerances",
            )
        };
        let chart = Chart {
            key: format!("front{a}{b}"),
            x: of_goal(*a, columns[0]),
            y: of_goal(*b, columns[1]),
            lines: lines.chain(kept).collect(),
            from_zero: true,
            ..Chart::default()
        };
        figures += &charts.figure(chart, " data-front", "");
    }
    figures
}

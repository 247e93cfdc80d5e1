//! Charts of all outputs over the motions of a run.

use super::charts::{Charts, attribute};
use super::escape::{html, prose};
use crate::report::chart::{Charted, Line, Quantity, chart_groups, charts_over};
use crate::report::curve_table::CurveTable;
use crate::report::record::{MotionRecord, OutputRecord};
use crate::report::run::Run;

/// Control that selects the horizontal axis of the charts in the element `plots`. Empty if there is only one possible axis.
pub(super) fn controls(motion: &MotionRecord, plots: &str) -> String {
    let all = motion.all_abscissae();
    if all.len() < 2 {
        return String::new();
    }
    let option = |column: &&str| {
        let title = Quantity::of_column(column).title();
        format!(
            "<option value=\"{}\">{}</option>",
            html(column),
            html(&title)
        )
    };
    let options: String = all.iter().map(option).collect();
    format!(
        include_str!("controls.html"),
        plots = plots,
        options = options
    )
}

/// Figures of all outputs over all possible horizontal axes of a motion. At first, only the usual horizontal axis is visible.
/// `missed` has the column and the deviation of each missed target. `further` returns additional lines, which are drawn behind the
/// curves of a chart.
pub(super) fn figures(
    of: Charted<'_>,
    missed: &[(&str, String)],
    charts: &mut Charts,
    further: impl Fn(&[CurveTable], &[&OutputRecord], &str) -> Vec<Line>,
) -> String {
    let mut figures = String::new();
    for group in chart_groups(&of.motion.outputs) {
        let usual = of.motion.usual_abscissa(group.column());
        let remarks: String = missed
            .iter()
            .filter(|(column, _)| group.outputs.iter().any(|o| o.column == *column))
            .map(|(_, by)| {
                format!(
                    "<small class=\"unmet\">target missed by up to {}</small>",
                    prose(by)
                )
            })
            .collect();
        for over in of.motion.all_abscissae() {
            let mut chart = charts_over(of, &charts.tables, &group, over);
            chart
                .lines
                .splice(0..0, further(&charts.tables, &group.outputs, over));
            let mut attributes = attribute("data-over", over);
            attributes += if over == usual {
                " data-usual"
            } else {
                " hidden"
            };
            figures += &charts.figure(chart, &attributes, &remarks);
        }
    }
    figures
}

/// Charts of every named motion, each below a heading with its name.
pub(super) fn of_motions(run: &Run, missed: &[(&str, String)], charts: &mut Charts) -> String {
    let mut sections = String::new();
    let motions = Charted::of_named(&run.record, &run.curves);
    for (number, (name, of)) in motions.into_iter().enumerate() {
        // The name of a target ends with the name of its motion.
        let own = missed.iter().filter_map(|(target, by)| {
            let (column, motion) = target.split_once(", ")?;
            (motion == name).then(|| (column, by.clone()))
        });
        let own: Vec<_> = own.collect();
        let plots = format!("motion-plots-{number}");
        sections += &format!(
            include_str!("motion.html"),
            name = html(name),
            controls = controls(of.motion, &plots),
            plots = plots,
            figures = figures(of, &own, charts, |_, _, _| Vec::new()),
        );
    }
    sections
}

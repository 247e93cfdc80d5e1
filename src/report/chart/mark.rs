//! Lines and dots of a chart, as SVG.

use std::fmt::Write;

/// Draws a line through points, and closes it if `closed` is true. A single point becomes a dot. For the class `line`, the dot is
/// wider than the line. Draws nothing without points.
pub(in crate::report) fn path(
    svg: &mut String,
    class: &str,
    points: impl Iterator<Item = [f64; 2]>,
    closed: bool,
) {
    let places: Vec<String> = points
        .map(|[x, y]| format!("{} {}", number(x), number(y)))
        .collect();
    let end = match (places.len(), closed) {
        (0, _) => return,
        (1, _) => "h0.1",
        (_, true) => "Z",
        (_, false) => "",
    };
    let dot = match (places.len(), class.starts_with("line")) {
        (1, true) => " dot",
        _ => "",
    };
    let _ = writeln!(
        svg,
        "<path class=\"{class}{dot}\" d=\"M{}{end}\"/>",
        places.join("L")
    );
}

/// Formats a length on the picture with at most one decimal. This is precise enough, and hides platform differences in the last
/// digits.
pub(in crate::report) fn number(length: f64) -> String {
    let text = format!("{:.1}", (length * 10.0).round() / 10.0 + 0.0);
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

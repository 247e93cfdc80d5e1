//! Progress line on the terminal: bar, finished and total number, rate, and remaining time.

use super::terminal;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use std::fmt::Write;

/// Progress line on standard error, shown only on a terminal that can move its cursor, and not with `--quiet`.
pub(super) fn line(total: u64, unit: &str) -> ProgressBar {
    if terminal::is_quiet() || terminal::is_dumb() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(&format!(
        "{{bar:30}} {{pos}}/{{len}} {unit}  {{rate}}  {{eta}} left  {{msg}}"
    ))
    .expect("a valid template");
    let rate = |state: &ProgressState, text: &mut dyn Write| {
        let _ = write!(text, "{}", rate(state.per_sec()));
    };
    ProgressBar::new(total).with_style(style.with_key("rate", rate))
}

/// Formats a rate as `0.52/s`, `170/s` or `170 thousand/s`, with only a few digits.
fn rate(per_second: f64) -> String {
    let (value, word) = match per_second {
        v if v >= 9.995e5 => (v / 1e6, " million"),
        v if v >= 999.5 => (v / 1e3, " thousand"),
        v => (v, ""),
    };
    let decimals = match value {
        v if v >= 99.5 => 0,
        v if v >= 9.95 => 1,
        _ => 2,
    };
    format!("{value:.decimals$}{word}/s")
}

#[cfg(test)]
mod tests {
    use super::rate;

    #[test]
    fn rates_have_three_digits() {
        for (value, text) in [
            (170_103.917_1, "170 thousand/s"),
            (0.523, "0.52/s"),
            (99.7, "100/s"),
            (1234.5, "1.23 thousand/s"),
            (2.5e6, "2.50 million/s"),
        ] {
            assert_eq!(rate(value), text);
        }
    }
}

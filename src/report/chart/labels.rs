//! Labels at the ends of curves: short, distinct, and without overlaps.

use super::layout::EndLabel;
use super::{Line, Scale};

/// Longest label, in letters.
const LONGEST: usize = 14;
/// Smallest distance between two labels, downward.
pub(super) const LABEL: f64 = 13.0;

/// Shortens a text to at most `longest` letters.
pub(in crate::report) fn shortened(label: &str, longest: usize) -> String {
    if label.chars().count() > longest {
        label.chars().take(longest - 1).chain(['…']).collect()
    } else {
        label.to_owned()
    }
}

/// Shortens a text to at most [`LONGEST`] letters. Keeps its beginning and its end.
fn without_middle(label: &str) -> String {
    let letters: Vec<char> = label.chars().collect();
    if letters.len() <= LONGEST {
        return label.to_owned();
    }
    let (first, last) = (LONGEST / 2 - 1, LONGEST / 2);
    let [first, last] = [&letters[..first], &letters[letters.len() - last..]];
    first.iter().chain(&['…']).chain(last).collect()
}

/// Shortened labels of lines. `None` for a line without a label.
pub(super) fn short_labels(lines: &[Line]) -> Vec<Option<String>> {
    let own = lines.iter().filter_map(|line| line.label.as_deref());
    let own: Vec<&str> = own.collect();
    let mut short = told_apart(&own).into_iter();
    let of_line = |line: &Line| line.label.as_ref().and_then(|_| short.next());
    lines.iter().map(of_line).collect()
}

/// Shortens names to at most [`LONGEST`] letters. If two names would become equal, all names lose the words with which all of them
/// begin. If this is not enough, long names lose letters in their middle.
pub(in crate::report) fn told_apart(names: &[&str]) -> Vec<String> {
    let clash = |names: &[String]| {
        names.iter().enumerate().any(|(k, a)| {
            let mut before = names[..k].iter();
            before.any(|b| a != b && shortened(a, LONGEST) == shortened(b, LONGEST))
        })
    };
    let mut names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    if clash(&names) {
        without_shared_words(&mut names);
    }
    let shorten = if clash(&names) {
        without_middle
    } else {
        |name: &str| shortened(name, LONGEST)
    };
    names.iter().map(|name| shorten(name)).collect()
}

/// Removes the words with which all names begin.
fn without_shared_words(names: &mut [String]) {
    let common = |a: &str, b: &str| {
        let same = a.char_indices().zip(b.chars());
        let same = same.take_while(|((_, x), y)| x == y);
        let ends = same.map(|((at, x), _)| at + x.len_utf8());
        ends.last().unwrap_or(0)
    };
    let first = &names[0];
    let shared = names.iter().map(|name| common(first, name)).min();
    let shared = &first[..shared.unwrap_or(0)];
    let start = shared.rfind([' ', '_', '-', ',']).map_or(0, |at| at + 1);
    if start > 0 {
        for name in names {
            *name = format!("…{}", &name[start..]);
        }
    }
}

/// Labels beside the ends of curves, without overlaps. The end of a curve is its point farthest to the right. If there is not
/// enough space, only the first, the last and the emphasised curves have labels.
pub(super) fn end_labels(
    lines: &[Line],
    texts: Vec<Option<String>>,
    points: &[Vec<Option<[f64; 2]>>],
    x: &Scale,
    y: &Scale,
    plot: [f64; 4],
) -> Vec<EndLabel> {
    let mut labels: Vec<EndLabel> = Vec::new();
    for ((line, text), points) in lines.iter().zip(texts).zip(points) {
        let last = points.iter().flatten().max_by(|a, b| a[0].total_cmp(&b[0]));
        let (Some(text), Some([place, value])) = (text, last) else {
            continue;
        };
        let end = [x.place(*place), y.place(*value)];
        labels.push(EndLabel {
            text,
            class: line.class.clone(),
            at: [plot[2] + 8.0, end[1]],
            end,
        });
    }
    let most = (((plot[3] - plot[1]) / LABEL) as usize).max(1);
    if labels.len() > most {
        let last = labels.len() - 1;
        let mut number = 0;
        labels.retain(|label| {
            let kept = number == 0 || number == last || label.class.contains("strong");
            number += 1;
            kept
        });
        labels.truncate(most);
    }
    labels.sort_by(|a, b| a.end[1].total_cmp(&b.end[1]));
    let mut free = plot[1] + 4.0;
    for label in &mut labels {
        label.at[1] = label.at[1].max(free);
        free = label.at[1] + LABEL;
    }
    let mut most = plot[3];
    for label in labels.iter_mut().rev() {
        label.at[1] = label.at[1].min(most);
        most = label.at[1] - LABEL;
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names that differ only at their ends still differ after shortening to 14 letters. Names that differ at their beginning
    /// keep their beginning.
    #[test]
    fn short_labels_differ_where_names_do() {
        let alike = ["double_wishbone_solve", "double_wishbone_rocker"];
        assert_eq!(told_apart(&alike), ["…solve", "…rocker"]);
        let apart = ["double_wishbone_solve", "macpherson_solve"];
        assert_eq!(told_apart(&apart), ["double_wishbo…", "macpherson_so…"]);
        assert_eq!(told_apart(&["left", "right"]), ["left", "right"]);
        let third = ["base", "my_long_study_front", "my_long_study_rear"];
        assert_eq!(
            told_apart(&third),
            ["base", "my_lon…y_front", "my_lon…dy_rear"]
        );
        // Two equal names belong to pieces of one curve.
        assert_eq!(
            told_apart(&["a name of many letters"; 2]),
            ["a name of man…"; 2]
        );
    }
}

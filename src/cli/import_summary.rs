//! Summary of `hardpoint import`: warnings, roles of the points, values that were read or assumed, and parts that are left out.

use crate::exchange::{Hardpoint, Imported, Notes, for_shell};
use std::fmt::Display;
use std::path::Path;

/// Summary of an import: roles of the points, units and axes that were read or assumed, parts left out, and the command that
/// shows the result.
pub(super) fn summary(imported: &Imported, out: Option<Option<&Path>>) -> String {
    let mut text = roles(imported);
    text += &listed("Values read and assumed", imported.notes.facts());
    text += &listed("Left out", &imported.left_out);
    match out {
        Some(Some(out)) => {
            let out = for_shell(&out.display().to_string());
            text += &format!("To view it: hardpoint studio {out}\n");
        }
        Some(None) => {
            text += "To view it: write it with --out STUDY.toml, then hardpoint studio STUDY.toml\n"
        }
        None => (),
    }
    text
}

/// Warnings among the notes, one per line. The summary begins with them, because the study may be wrong.
pub(super) fn warnings(notes: &Notes) -> String {
    let doubts = notes.doubts();
    doubts.map(|doubt| format!("warning: {doubt}\n")).collect()
}

/// A title with lines below it. Empty if there are no lines.
pub(super) fn listed(title: &str, lines: impl IntoIterator<Item = impl Display>) -> String {
    let lines = lines.into_iter().map(|line| format!("  {line}\n"));
    let lines: String = lines.collect();
    if lines.is_empty() {
        return lines;
    }
    format!("{title}:\n{lines}")
}

/// Table of the hardpoints with their names and locations in the file.
pub(super) fn roles(imported: &Imported) -> String {
    let own = imported.hardpoints.iter().map(|h| (h.name.to_owned(), h));
    let right = imported.right_half.iter();
    let right = right.map(|h| (format!("right {}", h.name), h));
    let all: Vec<(String, &Hardpoint)> = own.chain(right).collect();
    let longest = all.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for (name, hardpoint) in all {
        text += &format!(
            "  {name:longest$}  {:?}, {}\n",
            hardpoint.called, hardpoint.place
        );
    }
    text
}

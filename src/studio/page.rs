//! Files of the live page: HTML, style and scripts, which are part of the program.

use super::http::Response;

/// Returns a file of the page by its name in the address.
pub(super) fn file(name: &str) -> Option<Response> {
    const SCRIPT: &str = "text/javascript; charset=utf-8";
    let (content_type, text) = match name {
        "" => ("text/html; charset=utf-8", include_str!("page/index.html")),
        "start.html" => ("text/html; charset=utf-8", include_str!("page/start.html")),
        "start.js" => (SCRIPT, include_str!("page/start.js")),
        "style.css" => ("text/css; charset=utf-8", include_str!("page/style.css")),
        "icon.svg" => ("image/svg+xml", include_str!("page/icon.svg")),
        "main.js" => (SCRIPT, include_str!("page/main.js")),
        "server.js" => (SCRIPT, include_str!("page/server.js")),
        "design.js" => (SCRIPT, include_str!("page/design.js")),
        "cases.js" => (SCRIPT, include_str!("page/cases.js")),
        "constraints.js" => (SCRIPT, include_str!("page/constraints.js")),
        "picking.js" => (SCRIPT, include_str!("page/picking.js")),
        "draw.js" => (SCRIPT, include_str!("page/draw.js")),
        "runs.js" => (SCRIPT, include_str!("page/runs.js")),
        "speech.js" => (SCRIPT, include_str!("page/speech.js")),
        "views.js" => (SCRIPT, include_str!("page/views.js")),
        "curves.js" => (SCRIPT, include_str!("page/curves.js")),
        "frame.js" => (SCRIPT, include_str!("page/frame.js")),
        "table.js" => (SCRIPT, include_str!("page/table.js")),
        "notes.js" => (SCRIPT, include_str!("page/notes.js")),
        "tuning.js" => (SCRIPT, include_str!("page/tuning.js")),
        "files.js" => (SCRIPT, include_str!("page/files.js")),
        "changes.js" => (SCRIPT, include_str!("page/changes.js")),
        "deviation.js" => (SCRIPT, include_str!("page/deviation.js")),
        "dialog.js" => (SCRIPT, include_str!("page/dialog.js")),
        "handles.js" => (SCRIPT, include_str!("page/handles.js")),
        "history.js" => (SCRIPT, include_str!("page/history.js")),
        "labels.js" => (SCRIPT, include_str!("page/labels.js")),
        "layout.js" => (SCRIPT, include_str!("page/layout.js")),
        "targets.js" => (SCRIPT, include_str!("page/targets.js")),
        "mechanism_view.js" => (SCRIPT, include_str!("page/mechanism_view.js")),
        "space.js" => (SCRIPT, include_str!("page/space.js")),
        _ => return None,
    };
    Some(Response::new(200, content_type, text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::contrast::{contrast, mixed, palettes};
    use std::collections::BTreeSet;

    const STYLE: &str = include_str!("page/style.css");
    const INDEX: &str = include_str!("page/index.html");
    const START: &str = include_str!("page/start.html");

    /// Values of an HTML attribute in a text, in the order of the text.
    fn values<'a>(text: &'a str, attribute: &str) -> Vec<&'a str> {
        let opening = format!(" {attribute}=\"");
        let found = text.split(opening.as_str()).skip(1);
        found.filter_map(|rest| rest.split('"').next()).collect()
    }

    /// Words have a contrast of at least 4.5 on the backgrounds `paper` and `panel`. Lines and edges of fields have a contrast of
    /// at least 3 on `paper`. The palettes of the style sheet are: light, dark by choice, dark by the system, and light for
    /// printing.
    #[test]
    fn colours_can_be_read() {
        const WORDS: [&str; 15] = [
            "ink",
            "muted",
            "accent",
            "want",
            "bad",
            "good",
            "arrow",
            "proposal",
            "influence",
            "right",
            "hue1",
            "hue2",
            "hue5",
            "rocker",
            "carrier",
        ];
        let all = palettes(STYLE);
        let [light, dark, system, print] = all.as_slice() else {
            panic!("{} palettes", all.len());
        };
        assert_eq!(dark, system);
        assert_eq!(light, print);
        for palette in [light, dark] {
            let paper = palette["paper"];
            for (name, colour) in palette {
                let least = match *name {
                    "paper" | "panel" | "rule" | "grid" | "on-accent" => continue,
                    name if WORDS.contains(&name) => 4.5,
                    _ => 3.0,
                };
                let grounds = if least > 4.0 {
                    &["paper", "panel"][..]
                } else {
                    &["paper"]
                };
                for ground in grounds {
                    let is = contrast(colour, palette[ground]);
                    assert!(is >= least, "{name} {colour} on {ground}: {is:.2}");
                }
            }
            assert!(contrast(palette["on-accent"], palette["accent"]) >= 4.5);
            // The lines for the other values of a slider are partly transparent.
            for side in ["accent", "right"] {
                let is = contrast(&mixed(palette[side], paper, 0.75), paper);
                assert!(is >= 3.0, "{side}: {is:.2}");
            }
        }
        assert!(STYLE.contains(
            ".chart .others path { stroke: var(--accent); stroke-width: 1; stroke-opacity: .75; }"
        ));
    }

    /// Identifiers are unique, and every reference leads to an identifier. Scripts make the tabs and the heading of the dialog,
    /// so their identifiers are not in the HTML.
    #[test]
    fn references_lead_somewhere() {
        let tabs = INDEX.matches("role=\"tabpanel\"").count();
        for page in [INDEX, START] {
            let ids = values(page, "id");
            let unique: BTreeSet<&str> = ids.iter().copied().collect();
            assert_eq!(ids.len(), unique.len(), "{ids:?}");
            let made = |id: &str| id.starts_with("tab-") || id == "dialog-title";
            for attribute in ["aria-labelledby", "aria-controls", "for"] {
                for id in values(page, attribute) {
                    assert!(unique.contains(id) || made(id), "{attribute} {id}");
                }
            }
            for link in values(page, "href")
                .iter()
                .filter_map(|link| link.strip_prefix('#'))
            {
                assert!(unique.contains(link), "{link}");
            }
        }
        assert_eq!(values(INDEX, "aria-labelledby").len(), tabs + 1);
    }

    /// The server has every module that a page imports.
    #[test]
    fn imported_modules_are_served() {
        let mut waiting = vec!["main.js".to_owned(), "start.js".to_owned()];
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/studio/page");
        let mut known = BTreeSet::new();
        while let Some(name) = waiting.pop() {
            if !known.insert(name.clone()) {
                continue;
            }
            assert!(file(&name).is_some(), "{name} is not served");
            let text = std::fs::read_to_string(folder.join(&name)).unwrap();
            let imports = text.lines().filter(|line| line.starts_with("import "));
            for line in imports {
                let from = line.rsplit("'./").next().unwrap();
                waiting.push(from.trim_end_matches("';").to_owned());
            }
        }
        assert!(known.contains("speech.js"));
    }
}

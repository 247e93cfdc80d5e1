//! Finds the line of a study on which a key is written.

use super::Study;
use std::ops::Range;
use toml_edit::{Document, Item};

/// Byte range of the value at a path of keys and list indices. If the text has no such value, returns the range of the
/// longest part of the path that exists.
pub(super) fn place_of(text: &str, path: &[&str]) -> Range<usize> {
    let Ok(document) = Document::parse(text) else {
        return 0..0;
    };
    let mut item = document.as_item();
    let mut place = 0..0;
    for step in path {
        let element = step.parse::<usize>().ok().and_then(|at| item.get(at));
        let Some(inner) = item.get(*step).or(element) else {
            break;
        };
        item = inner;
        place = item.span().unwrap_or(place);
    }
    place
}

impl Study {
    /// Line of the study's text on which the value at a path of keys begins, counted from 1. For a section, it is the line
    /// of its header. `None` for a section without a header, or if the text has no such value.
    pub fn line_of(&self, path: &[&str]) -> Option<usize> {
        let document = Document::parse(self.text.as_str()).ok()?;
        let item = path
            .iter()
            .try_fold(document.as_item(), |item: &Item, key| item.get(key))?;
        let start = item.span()?.start;
        Some(1 + self.text[..start].matches('\n').count())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Topology;
    use std::path::Path;

    #[test]
    fn a_key_is_found_where_it_is_written() {
        let text = Topology::named("macpherson").unwrap().template;
        let study = Study::from_text("s.toml", text, Path::new(".")).unwrap();
        let line = |n: usize| text.lines().nth(n - 1).unwrap();
        let of = |path: &[&str]| study.line_of(path).map(line);
        assert!(of(&["motion", "travel"]).unwrap().starts_with("travel"));
        assert_eq!(of(&["motion"]).unwrap(), "[motion]");
        assert_eq!(of(&["motion", "nowhere"]), None);
    }
}

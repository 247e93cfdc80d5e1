//! Script of a page. The studio serves modules as files. A page has no files, so the modules are joined into one script.

/// Small helper functions, shared with the studio.
const HELPERS: &str = include_str!("../../studio/page/draw.js");
/// View of a mechanism, shared with the studio.
const SPACE: &str = include_str!("../../studio/page/space.js");
const MECHANISM_VIEW: &str = include_str!("../../studio/page/mechanism_view.js");

/// Joins these parts of a page's script, with the helper functions before them.
pub(super) fn script(parts: &[&str]) -> String {
    let own = [HELPERS, SPACE, MECHANISM_VIEW];
    let mut script = "'use strict';\n(() => {\n".to_owned();
    for line in own.iter().chain(parts).flat_map(|part| part.lines()) {
        if !line.starts_with("import ") {
            script += line.strip_prefix("export ").unwrap_or(line);
            script.push('\n');
        }
    }
    script + "})();\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The joined script contains no keywords that are only valid in modules.
    #[test]
    fn modules_are_joined() {
        let joined = script(&["import { a } from './a.js';\nexport const b = 1;\nconst c = 2;\n"]);
        assert!(joined.contains("\nconst b = 1;\nconst c = 2;\n"));
        assert!(
            joined
                .lines()
                .all(|l| !l.starts_with("import ") && !l.starts_with("export "))
        );
    }
}

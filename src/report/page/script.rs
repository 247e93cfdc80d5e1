//! The script of a page: modules that the studio serves as files are joined into one, since a page has no files.

/// Small helpers, shared with the studio.
const HELPERS: &str = include_str!("../../studio/page/draw.js");
/// The view of a mechanism, shared with the studio.
const SPACE: &str = include_str!("../../studio/page/space.js");
const MECHANISM_VIEW: &str = include_str!("../../studio/page/mechanism_view.js");

/// The script of these parts, with the helpers before them.
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

    /// Nothing of a module is left that a script may not have.
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

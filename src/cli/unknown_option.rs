//! Tip for an unknown option that is a key of the study. For example, the tip for `--starts` is
//! `--set optimise.starts=VALUE`.

use crate::study::keys;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Sections in which the key is searched after the command's own section, in this order.
const SECTIONS: [&str; 6] = [
    "motion",
    "outputs",
    "optimise",
    "tolerance",
    "sweep",
    "setup",
];

/// Replaces clap's tip for an unknown option, "use `-- --starts`", if the option is a key of the study. `command` is the
/// subcommand, if there is one.
pub(super) fn with_tip(mut error: clap::Error, command: Option<&str>) -> clap::Error {
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    let key = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(option)) => key_of(option, command),
        _ => None,
    };
    if let Some(key) = key {
        let tip = format!("{key} is a key of the study; use '--set {key}=VALUE'");
        let tips = ContextValue::StyledStrs(vec![StyledStr::from(tip)]);
        error.insert(ContextKind::Suggested, tips);
    }
    error
}

/// Path of the key that has the name of an option. A key of the command's own section comes first.
fn key_of(option: &str, command: Option<&str>) -> Option<String> {
    let name = option.strip_prefix("--")?;
    let name = name.split('=').next()?.replace('-', "_");
    let keys = keys();
    let sections = command.into_iter().chain(SECTIONS);
    let mut paths = sections.map(|section| (section, name.as_str()));
    let (section, name) =
        paths.find(|path| keys.iter().any(|(s, n)| (s.as_str(), n.as_str()) == *path))?;
    Some(format!("{section}.{name}"))
}

#[cfg(test)]
mod tests {
    use super::key_of;

    #[test]
    fn options_are_keys_of_sections() {
        for (option, command, expected) in [
            ("--starts", "optimise", Some("optimise.starts")),
            ("--good-enough=0", "optimise", Some("optimise.good_enough")),
            ("--builds", "tolerance", Some("tolerance.builds")),
            ("--travel", "solve", Some("motion.travel")),
            ("--nonsense", "solve", None),
            ("-x", "solve", None),
        ] {
            let found = key_of(option, Some(command));
            assert_eq!(found.as_deref(), expected, "{option}");
        }
    }
}

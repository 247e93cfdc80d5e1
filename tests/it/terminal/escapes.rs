//! Tests that no external text acts on the terminal as a command. Colours appear only on terminals that request them.

use super::{Called, study};
use std::fs;

/// Text with control codes, in C0 and C1: red colour, window title, bell, return to the start of the line, and
/// right-to-left override.
const HOSTILE: &str = "a\u{1b}[31m\u{1b}]0;title\u{7}\r\u{9b}31m\u{202e}b";

fn obeys_nothing(called: &Called) {
    let all = called.said() + &called.complained();
    let bad = all
        .chars()
        .find(|c| (c.is_control() && !"\n\t".contains(*c)) || *c == '\u{202e}');
    assert_eq!(bad, None, "{all:?}");
    let shown = ["\\u{", "\u{241b}"]
        .iter()
        .any(|escape| all.contains(escape));
    assert!(shown, "{all}");
}

#[test]
fn control_characters_of_arguments_are_shown_and_not_obeyed() {
    let sound = study("macpherson_solve");
    let sound = sound.to_str().unwrap();
    let missing = format!("{HOSTILE}.toml");
    let set = format!("motion.{HOSTILE}=1");
    let value = format!("suspension.topology={HOSTILE}");
    for arguments in [
        &["new", HOSTILE][..],
        &["solve", &missing],
        &["solve", sound, "--out", HOSTILE],
        &["solve", sound, "--set", &set],
        &["solve", sound, "--set", &value],
        &["solve", sound, "--threads", HOSTILE],
        &["report", HOSTILE],
        &["sweep", sound, "--shard", HOSTILE],
        &[HOSTILE],
    ] {
        obeys_nothing(&Called::with(arguments, &[]));
    }
}

#[test]
fn control_characters_of_files_are_shown_and_not_obeyed() {
    let directory = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(study("macpherson_solve")).unwrap();
    let path = directory.path().join(format!("{HOSTILE}.toml"));
    fs::write(&path, text.replace("[motion]", "[motion]\nnonsense = 1")).unwrap();
    let path = path.to_str().unwrap();
    for command in ["check", "solve", "limits"] {
        obeys_nothing(&Called::with(&[command, path], &[]));
    }
    fs::write(path, text).unwrap();
    for command in ["check", "solve"] {
        obeys_nothing(&Called::with(&[command, path], &[]));
    }
    // In these files, file names appear in the names of columns and in cells.
    let sound = study("macpherson_solve");
    for format in ["text", "csv", "json"] {
        let arguments = ["compare", path, sound.to_str().unwrap(), "--format", format];
        obeys_nothing(&Called::with(&arguments, &[]));
    }
    let arguments = ["compare", path, sound.to_str().unwrap(), "--out", "-"];
    obeys_nothing(&Called::with(&arguments, &[]));
}

/// Colours appear on a terminal, but not with `NO_COLOR` or a dumb terminal. The program `script`, if installed,
/// provides the terminal.
#[test]
fn colours_are_for_terminals_that_want_them() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("wrong.toml");
    fs::write(&path, "[suspension]\ntopology = \"macpheson\"\n[suspension.hardpoints]\n[motion]\ntravel = [0.0]\n").unwrap();
    let program = assert_cmd::cargo::cargo_bin("hardpoint");
    let on_a_terminal = |variables: &[(&str, &str)]| {
        let call = format!("{} check {}", program.display(), path.display());
        let mut script = std::process::Command::new("script");
        script.args(["-q", "-e", "-c", &call, "/dev/null"]);
        script.env_remove("NO_COLOR").env("TERM", "xterm-256color");
        script.envs(variables.iter().copied());
        script.stdin(std::process::Stdio::null());
        let output = script.output().ok()?;
        (output.status.code() == Some(2))
            .then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let Some(coloured) = on_a_terminal(&[]) else {
        eprintln!("\n*** SKIPPED: no `script` to make a terminal with ***\n");
        return;
    };
    assert!(coloured.contains("\u{1b}["), "{coloured:?}");
    for variable in [("NO_COLOR", "1"), ("TERM", "dumb")] {
        let plain = on_a_terminal(&[variable]).unwrap();
        assert!(
            plain.contains("macpheson") && !plain.contains('\u{1b}'),
            "{plain:?}"
        );
    }
}

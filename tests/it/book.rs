//! Tests of the book: its commands run as printed and make its pictures, and its links lead to existing headings.
//!
//! The test runs a block of `sh` line by line, in a folder that contains `studies`. If the line before another block is
//! ``Save as `FILE`:`` or ``Add to `FILE`:``, the test writes that file. A comment `<!-- made: FILE -->` before a picture
//! names the file that a command made. `UPDATE_README=1 cargo test --test it book::` renews the pictures.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All pages of the book, relative to the root of the repository.
fn pages() -> Vec<String> {
    let mut pages: Vec<String> = [
        "README",
        "ARCHITECTURE",
        "CONTRIBUTING",
        "CHANGELOG",
        "SECURITY",
    ]
    .map(|name| format!("{name}.md"))
    .to_vec();
    for entry in fs::read_dir(root().join("docs")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".md") {
            pages.push(format!("docs/{name}"));
        }
    }
    pages
}

fn text_of(page: &str) -> String {
    fs::read_to_string(root().join(page)).unwrap_or_else(|e| panic!("{page}: {e}"))
}

/// Part of a page.
#[derive(Debug, PartialEq)]
enum Part {
    /// Block: the text of the line before it, the kind of the block, and its lines.
    Block(String, String, String),
    /// Picture, and the file that a command wrote for it.
    Picture(String, String),
}

fn parts(text: &str) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut before = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(kind) = line.strip_prefix("```") {
            let block = lines.by_ref().take_while(|l| !l.starts_with("```"));
            let block: String = block.flat_map(|l| [l, "\n"]).collect();
            parts.push(Part::Block(
                std::mem::take(&mut before),
                kind.to_owned(),
                block,
            ));
        } else if let Some(made) = before.strip_prefix("<!-- made: ") {
            let made = made.strip_suffix(" -->").unwrap().to_owned();
            let shown = line.split_once("](").unwrap().1.strip_suffix(')').unwrap();
            parts.push(Part::Picture(shown.to_owned(), made));
            before.clear();
        } else if !line.is_empty() {
            before = line.to_owned();
        }
    }
    parts
}

/// Runs the commands of a page in a separate folder.
#[cfg(unix)]
fn run(page: &str) {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    fs::create_dir(here.join("studies")).unwrap();
    for entry in fs::read_dir(root().join("studies")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, here.join("studies").join(path.file_name().unwrap())).unwrap();
    }
    let program = assert_cmd::cargo::cargo_bin("hardpoint");
    let found = format!(
        "{}:{}",
        program.parent().unwrap().display(),
        std::env::var("PATH").unwrap()
    );
    let mut commands = 0;
    // The test compares pictures last, because a page may show one before the command that makes it.
    let (blocks, pictures): (Vec<Part>, Vec<Part>) = parts(&text_of(page))
        .into_iter()
        .partition(|part| matches!(part, Part::Block(..)));
    for part in blocks.into_iter().chain(pictures) {
        match part {
            Part::Block(before, kind, block) => {
                let named = |prefix: &str| {
                    let name = before.strip_prefix(prefix)?.strip_suffix("`:")?;
                    Some(here.join(name))
                };
                if let Some(path) = named("Save as `") {
                    fs::write(path, block).unwrap();
                } else if let Some(path) = named("Add to `") {
                    let mut text = fs::read_to_string(&path).unwrap();
                    text += &block;
                    fs::write(path, text).unwrap();
                } else if kind == "sh" {
                    for line in block.lines() {
                        assert!(line.starts_with("hardpoint "), "{page}: {line}");
                        let output = std::process::Command::new("sh")
                            .args(["-c", line])
                            .env("PATH", &found)
                            .current_dir(here)
                            .output()
                            .unwrap();
                        assert!(
                            output.status.success(),
                            "{page}: {line}\n{}{}",
                            String::from_utf8_lossy(&output.stdout),
                            String::from_utf8_lossy(&output.stderr)
                        );
                        commands += 1;
                    }
                }
            }
            Part::Picture(shown, made) => {
                let shown = root().join("docs").join(shown);
                let made = fs::read_to_string(here.join(made)).unwrap();
                if std::env::var_os("UPDATE_README").is_some() {
                    fs::create_dir_all(shown.parent().unwrap()).unwrap();
                    fs::write(shown, made).unwrap();
                } else {
                    let kept = fs::read_to_string(&shown).unwrap();
                    crate::support::assert_same_picture(&kept, &made, &shown.display().to_string());
                }
            }
        }
    }
    assert!(commands > 0, "{page} has no command");
}

#[cfg(unix)]
#[test]
fn start_here_runs_as_printed() {
    run("docs/start.md");
}

#[cfg(unix)]
#[test]
fn every_how_to_runs_as_printed() {
    run("docs/how-to.md");
}

#[cfg(unix)]
#[test]
fn concepts_run_as_printed() {
    run("docs/concepts.md");
}

#[cfg(unix)]
#[test]
fn the_gallery_runs_as_printed() {
    run("docs/gallery.md");
}

#[cfg(unix)]
#[test]
fn proofs_and_compliance_run_as_printed() {
    run("docs/why.md");
    run("docs/compliance.md");
}

/// A test runs the commands of every page that has commands. `tests/it/readme.rs` runs the command of the README.
#[test]
fn every_page_with_commands_is_run() {
    let run = [
        "start",
        "how-to",
        "concepts",
        "gallery",
        "why",
        "compliance",
    ];
    let run: Vec<String> = run.iter().map(|name| format!("docs/{name}.md")).collect();
    for page in pages().into_iter().filter(|page| page != "README.md") {
        let is_sh = |part: &Part| matches!(part, Part::Block(_, kind, _) if kind == "sh");
        let has_commands = parts(&text_of(&page)).iter().any(is_sh);
        assert_eq!(has_commands, run.contains(&page), "{page}");
    }
}

/// The book has at least forty tasks, and each task has a command.
#[test]
fn each_task_has_a_command() {
    let text = text_of("docs/how-to.md");
    let tasks: Vec<&str> = text.split("\n### ").skip(1).collect();
    assert!(tasks.len() >= 40, "{}", tasks.len());
    for task in tasks {
        assert!(task.contains("```sh\nhardpoint "), "{task}");
    }
}

/// Returns the anchor of a heading, as Git hosting sites and mdBook make it.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().to_lowercase();
    let kept = kept
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn anchors(text: &str) -> BTreeSet<String> {
    let mut is_code = false;
    let mut found = BTreeSet::new();
    for line in text.lines() {
        is_code ^= line.starts_with("```");
        if !is_code && line.starts_with('#') {
            found.insert(anchor(line.trim_start_matches('#')));
        }
    }
    found
}

/// Links of a page, except those within code.
fn links(text: &str) -> Vec<String> {
    let mut is_code = false;
    let mut found = Vec::new();
    for line in text.lines() {
        is_code ^= line.starts_with("```");
        if is_code {
            continue;
        }
        // Text between backticks is code and contains no links.
        let plain: String = line.split('`').step_by(2).collect::<Vec<_>>().join("`");
        let starts = plain.split("](").skip(1);
        found.extend(starts.filter_map(|rest| Some(rest.split_once(')')?.0.to_owned())));
    }
    found
}

/// Every link in the book leads to an existing file of the repository and to an existing heading there. The test does not
/// follow web links.
#[test]
fn every_link_leads_somewhere() {
    let mut missing = Vec::new();
    for page in pages() {
        let text = text_of(&page);
        let folder: PathBuf = root().join(&page).parent().unwrap().to_owned();
        for link in links(&text) {
            if link.contains("://") {
                continue;
            }
            let (file, heading) = link.split_once('#').unwrap_or((&link, ""));
            let path = match file {
                "" => root().join(&page),
                file => folder.join(file),
            };
            let holds = path.exists()
                && (heading.is_empty()
                    || anchors(&fs::read_to_string(&path).unwrap()).contains(heading));
            if !holds {
                missing.push(format!("{page}: {link}"));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

/// Every page of the manual is in the table of contents. `every_link_leads_somewhere` checks that each entry of that table is
/// a page.
#[test]
fn the_contents_name_every_page() {
    let contents: BTreeSet<String> = links(&text_of("docs/SUMMARY.md")).into_iter().collect();
    for page in pages() {
        let entry = match page.strip_prefix("docs/") {
            Some("SUMMARY.md") => continue,
            Some(name) => name.to_owned(),
            None => format!("../{page}"),
        };
        assert!(
            contents.contains(&entry),
            "{entry} is not in docs/SUMMARY.md"
        );
    }
}

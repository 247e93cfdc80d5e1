//! Tests of pages for keyboards and screen readers: names, references and headings, from the text of the page.

use super::*;
use std::collections::BTreeSet;

/// Opening tags of a page, without its data and script.
fn tags(page: &str) -> Vec<String> {
    let start = page.find("<body>").unwrap();
    let end = page[start..]
        .find("<script")
        .map_or(page.len(), |at| start + at);
    let tags = page[start..end].split('<').skip(1);
    tags.filter(|tag| !tag.starts_with('/'))
        .map(|tag| tag.split('>').next().unwrap().to_owned())
        .collect()
}

fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = tag.split_once(&format!(" {name}=\""))?;
    rest.split('"').next()
}

/// Asserts that identifiers are unique, references have a target, pictures have a name, and scrolling regions can have
/// the focus. Headings skip no level. Screen readers do not announce values that follow the pointer.
fn assert_accessible(page: &str) {
    assert!(page.contains("<html lang=\"en\">"));
    assert!(page.contains("name=\"viewport\""));
    let tags = tags(page);
    let ids: Vec<&str> = tags.iter().filter_map(|tag| attribute(tag, "id")).collect();
    let unique: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(ids.len(), unique.len(), "an identifier occurs twice");
    let mut level = 0;
    for tag in &tags {
        for name in ["aria-labelledby", "for"] {
            if let Some(id) = attribute(tag, name) {
                assert!(unique.contains(id), "{tag}");
            }
        }
        if let Some(link) = attribute(tag, "href").and_then(|link| link.strip_prefix('#')) {
            assert!(unique.contains(link), "{tag}");
        }
        let kind = tag.split([' ', '/']).next().unwrap();
        let is_named =
            attribute(tag, "aria-label").is_some() || attribute(tag, "aria-labelledby").is_some();
        match kind {
            "svg" => {
                assert!(attribute(tag, "role").is_some(), "{tag}");
                assert!(is_named || tag.contains("aria-hidden"), "{tag}");
            }
            "output" => assert_eq!(attribute(tag, "aria-live"), Some("off"), "{tag}"),
            "h1" | "h2" | "h3" | "h4" => {
                let own: u32 = kind[1..].parse().unwrap();
                assert!(own <= level + 1, "{tag} after a heading of level {level}");
                level = own;
            }
            _ => {}
        }
        if attribute(tag, "class") == Some("table") {
            assert_eq!(attribute(tag, "tabindex"), Some("0"), "{tag}");
        }
    }
    assert_eq!(tags.iter().filter(|tag| tag.starts_with("h1")).count(), 1);
}

#[test]
fn pages_have_names_and_references() {
    for (command, name) in [
        ("solve", "five_link_solve.toml"),
        ("solve", "double_wishbone_axle.toml"),
        ("optimise", "macpherson_front.toml"),
        ("optimise", "solid_axle_rear.toml"),
        ("sweep", "macpherson_sweep.toml"),
        ("tolerance", "macpherson_tolerance.toml"),
        ("setup", "double_wishbone_tolerance.toml"),
        ("kc", "double_wishbone_compliance.toml"),
    ] {
        let few: &[&str] = match command {
            "sweep" => &["--set", "sweep.samples=64"],
            "tolerance" => &["--set", "tolerance.builds=200"],
            _ => &[],
        };
        let page = Run::of(command, "study", &study(name), few).page();
        println!("{command} {name}");
        assert_accessible(&page);
    }
}

/// Pages of cars, limits and comparisons have names and references.
#[test]
fn other_pages_have_names_and_references() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let sample = |name: &str| studies().join(name);
    let run = |arguments: &[&std::path::Path], page: &str| {
        let ended = hardpoint(&[]).args(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.success(), "{said}");
        assert_accessible(&fs::read_to_string(path(page)).unwrap());
    };
    let word = Path::new;
    run(
        &[
            word("solve"),
            &sample("car.toml"),
            word("--report"),
            word("--out"),
            &path("car"),
        ],
        "car/report.html",
    );
    run(
        &[
            word("limits"),
            &sample("double_wishbone_axle.toml"),
            word("--report"),
            &path("limits.html"),
        ],
        "limits.html",
    );
    run(
        &[
            word("compare"),
            &sample("macpherson_solve.toml"),
            &sample("double_wishbone_solve.toml"),
            word("--out"),
            &path("compare"),
        ],
        "compare/report.html",
    );
}

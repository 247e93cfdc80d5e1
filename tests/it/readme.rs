//! Tests that the README and the manual agree with the program.

use hardpoint::car::{AxleResult, WheelResult, WholeResult};
use hardpoint::characteristics::Characteristic;
use std::fs;
use std::path::Path;

/// The manual's table of characteristics equals the program's list. After a change of this list, `UPDATE_README=1 cargo
/// test --test it readme::` renews the table.
#[test]
fn the_table_of_characteristics_is_the_catalogue() {
    let mut table = String::from("\n| name | formula | positive when |\n|---|---|---|\n");
    for c in Characteristic::ALL {
        let info = c.info();
        table += &format!(
            "| `{}` | {} | {} |\n",
            info.name, info.formula, info.positive
        );
    }
    table.push('\n');
    renew_or_compare("docs/characteristics.md", "characteristics", &table);
}

/// The manual's table of the results of a car equals the program's list. `UPDATE_README=1 cargo test --test it
/// readme::` renews the table.
#[test]
fn the_table_of_car_results_is_the_catalogue() {
    let wheels = WheelResult::ALL.iter().map(|r| ("front_left_", r.info()));
    let axles = AxleResult::ALL.iter().map(|r| ("", r.info()));
    let whole = WholeResult::ALL.iter().map(|r| ("", r.info()));
    let mut table = String::from("\n| name | formula | positive when |\n|---|---|---|\n");
    for (prefix, info) in wheels.chain(axles).chain(whole) {
        let name = info.name.replace("{}", "front");
        table += &format!(
            "| `{prefix}{name}` | {} | {} |\n",
            info.formula, info.positive
        );
    }
    table.push('\n');
    renew_or_compare("docs/car.md", "car results", &table);
}

/// Compares the text between two comments of a file, or renews it on request.
fn renew_or_compare(file: &str, name: &str, wanted: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let text = fs::read_to_string(&path).unwrap();
    let (start, end) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let from = text.find(&start).unwrap() + start.len();
    let to = text.find(&end).unwrap();
    if std::env::var_os("UPDATE_README").is_some() {
        fs::write(&path, format!("{}{wanted}{}", &text[..from], &text[to..])).unwrap();
    } else {
        assert_eq!(&text[from..to], wanted);
    }
}

/// The gallery lists every sample study, and every listed study exists.
#[test]
fn every_sample_study_is_listed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("docs/gallery.md")).unwrap();
    for entry in fs::read_dir(root.join("studies")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".toml") {
            assert!(
                readme.contains(&format!("`{name}`")),
                "{name} is not in docs/gallery.md"
            );
        }
    }
    for word in readme
        .split('`')
        .filter(|w| w.ends_with(".toml") && !w.contains(' '))
    {
        let is_result = ["optimised.toml", "mine.toml"].contains(&word);
        assert!(
            is_result || root.join("studies").join(word).is_file(),
            "{word}"
        );
    }
}

/// The README's first command prints the text that the README shows.
#[test]
fn the_first_command_prints_what_the_readme_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let between = |from: &str, to: &str| {
        let start = readme.find(from).unwrap() + from.len();
        &readme[start..start + readme[start..].find(to).unwrap()]
    };
    let command = between("cargo run --release -- ", "\n");
    let shown = between("```text\n", "```");
    // The test runs in a temporary directory with the study at the same relative path.
    let directory = tempfile::tempdir().unwrap();
    let study = command.split(' ').nth(1).unwrap();
    fs::create_dir(directory.path().join("studies")).unwrap();
    fs::copy(root.join(study), directory.path().join(study)).unwrap();
    let printed = assert_cmd::Command::cargo_bin("hardpoint")
        .unwrap()
        .current_dir(directory.path())
        .args(command.split(' '))
        .assert()
        .success()
        .get_output()
        .stdout
        .clone();
    assert_eq!(String::from_utf8(printed).unwrap(), shown);
}

//! The README and the manual say what the program does.

use hardpoint::characteristics::Characteristic;
use std::fs;
use std::path::Path;

/// The manual's table of characteristics is the catalogue's. To renew it after a change of the catalogue, run
/// `UPDATE_README=1 cargo test --test readme`.
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
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/characteristics.md");
    let readme = fs::read_to_string(&path).unwrap();
    let (start, end) = ("<!-- characteristics -->\n", "<!-- /characteristics -->");
    let from = readme.find(start).unwrap() + start.len();
    let to = readme.find(end).unwrap();
    if std::env::var_os("UPDATE_README").is_some() {
        fs::write(
            &path,
            format!("{}{table}{}", &readme[..from], &readme[to..]),
        )
        .unwrap();
    } else {
        assert_eq!(&readme[from..to], table);
    }
}

/// Every sample study is listed, and everything listed is there.
#[test]
fn every_sample_study_is_listed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    for entry in fs::read_dir(root.join("studies")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".toml") {
            assert!(
                readme.contains(&format!("`{name}`")),
                "{name} is not in the README"
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

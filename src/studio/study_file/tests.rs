//! Tests of edited study files.

use super::check_name;

#[test]
fn names_stay_in_the_folder() {
    for name in [
        "a.toml",
        "front axle 2.toml",
        "ünïcode.toml",
        "a.b.toml",
        "control.toml",
        "com10.toml",
        "common.toml",
        "nulls.toml",
    ] {
        assert_eq!(check_name(name), Ok(()), "{name}");
    }
    for name in [
        "",
        ".toml",
        "a",
        "a.txt",
        "../a.toml",
        "/a.toml",
        "b/a.toml",
        "b\\a.toml",
        "c:a.toml",
        "..",
        ".hidden.toml",
        "a\0.toml",
        "a\n.toml",
        "a?.toml",
        "a .toml",
        " .toml",
        "con.toml",
        "NUL.v2.toml",
        "Com1.toml",
        "lpt\u{b2}.toml",
        "aux .toml",
        "a\u{202e}lmot.toml",
        "\u{2066}a.toml",
    ] {
        assert!(check_name(name).is_err(), "{name:?}");
    }
    assert!(check_name(&format!("{}.toml", "a".repeat(300))).is_err());
}

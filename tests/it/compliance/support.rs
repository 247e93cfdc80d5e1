//! Studies of the repository with elastic parts, with text at their end.

use hardpoint::compliance::Compliance;
use hardpoint::model::Suspension;
use hardpoint::study::Study;
use std::path::Path;

/// The text of a study of the repository, with more at its end.
pub fn with(name: &str, more: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("studies")
        .join(name);
    std::fs::read_to_string(path).unwrap() + more
}

/// A study with elastic parts from its text.
pub fn elastic(text: &str) -> Study {
    Study::elastic_from_text("case.toml", text, Path::new("")).unwrap_or_else(|e| panic!("{e}"))
}

/// A suspension with a drop link and an anti-roll bar, and its elastic parts: the sample of a topology.
pub fn elastic_axle(topology: &str) -> (Suspension, Compliance) {
    let (bar, bodies) = match topology {
        "double_wishbone" => (
            "drop_link_outer = [10.0, 560.0, 200.0]\ndrop_link_inner = [20.0, 565.0, 320.0]\n\
             anti_roll_bar_inner = [170.0, 300.0, 320.0]\nanti_roll_bar_outer = [170.0, 540.0, 325.0]\n",
            "[suspension.bodies]\ndrop_link_outer = \"lower_arm\"\n",
        ),
        _ => (
            "drop_link_outer = [30.0, 690.0, 260.0]\ndrop_link_inner = [30.0, 680.0, 400.0]\n\
             anti_roll_bar_inner = [190.0, 300.0, 400.0]\nanti_roll_bar_outer = [190.0, 600.0, 405.0]\n",
            "[suspension.bodies]\ndrop_link_outer = \"knuckle\"\n",
        ),
    };
    let text = with(&format!("{topology}_compliance.toml"), "");
    let text = text.replacen("\n[wheel]", &format!("{bar}{bodies}\n[wheel]"), 1);
    let study = elastic(&text);
    let parts = study.compliance().unwrap().parts.clone();
    (study.into_wheel(), parts)
}

//! Tests of elastic solid axles that the program refuses. The message states the reason and the fix.

use super::{Kind, STILL, Scatter, builds, made};
use crate::support::random::Random;
use hardpoint::study::Study;
use std::path::Path;

fn text(kind: Kind) -> String {
    let scatter = Scatter {
        points: 0.0,
        differs: false,
        rates: [4.0, 4.0],
        springs: true,
    };
    made(kind, scatter, &mut Random(1), STILL).text
}

fn refusal(text: &str) -> String {
    match Study::elastic_from_text("solid.toml", text, Path::new("")) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(errors) => errors.to_string(),
    }
}

#[test]
fn five_rigid_links_are_refused_with_the_fix() {
    let found = refusal(&super::rigid_limit::rigid(&text(Kind::FiveLink)));
    for part in [
        "five links",
        "axial_stiffness",
        "[links.upper_link]",
        "single = [\"upper_link\"]",
        "panhard_",
    ] {
        assert!(found.contains(part), "{part}: {found}");
    }
    let five = text(Kind::FiveLink);
    let start = five.find("[links.lower_link]").unwrap();
    let end = five.find("[spring]").unwrap();
    let found = refusal(&format!("{}{}", &five[..start], &five[end..]));
    assert!(found.contains("nothing is elastic"), "{found}");
    assert!(found.contains("`hardpoint kc` needs it"), "{found}");
}

/// The program refuses a rate of the right half for a part that exists only once. It also refuses motions and outputs
/// that only rigid axles have.
#[test]
fn parts_and_motions_of_rigid_axles_are_refused() {
    let five = text(Kind::FiveLink);
    let three = text(Kind::ThreeLinkPanhard);
    let right = |name: &str| format!("[axle.right.links.{name}]\naxial_stiffness = 500.0\n");
    for (text, reason) in [
        (
            format!("{five}[links.right_lower_link]\naxial_stiffness = 500.0\n"),
            "is not a link",
        ),
        (format!("{five}{}", right("panhard")), "has only one"),
        (format!("{three}{}", right("upper_link")), "has only one"),
        (format!("{five}{}", right("middle_link")), "middle_link"),
        (
            five.replace("[links.panhard]", "[links.panhrd]"),
            "did you mean \"panhard\"",
        ),
        (
            five.replace("heave = [0.0]", "roll = [0.0]"),
            "roll\" needs",
        ),
        (
            format!("{five}[outputs]\ncharacteristics = [\"anti_squat\"]\n"),
            "rigid mechanism",
        ),
        (
            format!(
                "{five}[outputs]\ncharacteristics = [\"roll_centre_height\"]\norder = \"velocity\"\n"
            ),
            "derivative",
        ),
        (
            format!("{five}[outputs]\ncharacteristics = [\"camber\"]\ncertify = true\n"),
            "certify",
        ),
        (
            format!(
                "{five}[subframe]\ncarries = [\"lower_link_chassis\"]\nmounts = {{ m = [0.0, 300.0, 300.0] }}\n"
            ),
            "subframe",
        ),
        (five.replace("relaxed = \"free\"\n", ""), "relaxed"),
        (
            format!("{five}[steering]\nrack_stiffness = 100.0\n"),
            "steering",
        ),
    ] {
        let found = refusal(&text);
        assert!(found.contains(reason), "{reason}: {found}");
    }
}

/// The program refuses links that give the axle no lateral stiffness.
#[test]
fn links_without_lateral_stiffness_are_refused() {
    let four = text(Kind::FourLink);
    let parallel = [
        (
            "lower_link_chassis = [540.0, 420.0, 305.0]",
            "lower_link_chassis = [540.0, 500.0, 305.0]",
        ),
        (
            "lower_link_axle = [5.0, 530.0, 255.0]",
            "lower_link_axle = [5.0, 500.0, 255.0]",
        ),
        (
            "upper_link_chassis = [340.0, 470.0, 445.0]",
            "upper_link_chassis = [340.0, 300.0, 445.0]",
        ),
        (
            "upper_link_axle = [15.0, 150.0, 475.0]",
            "upper_link_axle = [15.0, 300.0, 475.0]",
        ),
    ];
    let mut text = four;
    for (from, to) in parallel {
        assert!(text.contains(from), "{text}");
        text = text.replace(from, to);
    }
    let found = refusal(&text);
    assert!(found.contains("sideways"), "{found}");
}

#[test]
fn watt_linkages_and_twist_beams_have_no_elastic_parts() {
    let watt = "watt_pivot = [-150.0, 0.0, 340.0]\nwatt_axis = [-100.0, 0.0, 340.0]\n\
        watt_upper_chassis = [-150.0, 480.0, 400.0]\nwatt_upper_rocker = [-150.0, 0.0, 410.0]\n\
        watt_lower_chassis = [-150.0, -480.0, 280.0]\nwatt_lower_rocker = [-150.0, 0.0, 270.0]\nwheel_centre";
    let three = text(Kind::ThreeLinkPanhard);
    let three: String = three
        .lines()
        .filter(|l| !l.starts_with("panhard_"))
        .map(|l| format!("{l}\n"))
        .collect();
    let three = three
        .replace("[links.panhard]\naxial_stiffness = 10000.0\n", "")
        .replace("wheel_centre", watt);
    let found = refusal(&three);
    assert!(
        found.contains("Watt linkage") && found.contains("elastic parts"),
        "{found}"
    );
    let beam = hardpoint::model::Topology::named("twist_beam")
        .unwrap()
        .template;
    let beam = format!(
        "{beam}\n[compliance]\nrelaxed = \"free\"\n[links.lower_link]\naxial_stiffness = 1.0\n"
    );
    let found = refusal(&beam);
    assert!(found.contains("twist beam"), "{found}");
}

/// The program refuses builds of an axle on five links with bushings, and a robust tuning of it. The message names the reason
/// and the fix.
#[test]
fn builds_with_five_links_are_refused_with_reasons() {
    let five = builds::text(Kind::FiveLink, "free", builds::MOTION);
    let scatter = "[tolerance]\nscatter = [{ length = \"panhard\", sigma = 0.1 }]\n";
    let bushing = "[bushings.panhard_chassis]\nstiffness = [3000.0, 900.0, 900.0, 1e4, 1e5, 1e5]\n";
    let start = five.find("[links.panhard]").unwrap();
    let length = five[start..]
        .lines()
        .take(2)
        .map(|line| line.len() + 1)
        .sum::<usize>();
    let bushed = format!("{}{}{bushing}", &five[..start], &five[start + length..]);
    let robust = "[optimise]\nscatter = 4\nvariables = [{ hardpoint = \"lower_link_axle\", axis = \"z\", range = [-5.0, 5.0] }]\n\
                  targets = [{ characteristic = \"axle_steer\", over = \"travel_left\", at = 20.0, value = 0.0, tolerance = 0.1 }]\n";
    for (text, reasons) in [
        (
            format!("{bushed}{scatter}"),
            ["axial_stiffness", "five links"],
        ),
        (
            format!("{five}{scatter}{robust}"),
            ["not available yet", "five links"],
        ),
    ] {
        let found = Study::elastic_from_text("solid.toml", &text, Path::new(""));
        let found = found
            .err()
            .unwrap_or_else(|| panic!("accepted:\n{text}"))
            .to_string();
        for reason in reasons {
            assert!(found.contains(reason), "{reason}: {found}");
        }
    }
    // Without builds, the program accepts bushings on an axle with five links.
    let sound = Study::elastic_from_text("solid.toml", &bushed, Path::new(""));
    assert!(sound.is_ok(), "{}", sound.unwrap_err());
}

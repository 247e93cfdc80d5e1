//! Names of test results.

use super::TestLoad;

/// Names of all test results for each load, without the suffixes that [`crate::axle::TestFigure::stem`] adds. Tests
/// with different loads may have results of the same name.
const FIGURES: &[(TestLoad, &[&str])] = &[
    (
        TestLoad::Heave,
        &[
            "toe_by_heave",
            "camber_by_heave",
            "caster_by_heave",
            "half_track_by_heave",
            "wheelbase_by_heave",
            "compliant_ride_rate",
        ],
    ),
    (
        TestLoad::Roll,
        &[
            "steer_by_roll",
            "camber_by_roll",
            "compliant_roll_stiffness",
            "link_roll_stiffness",
            "lower_link_tension",
            "upper_link_tension",
            "panhard_tension",
        ],
    ),
    (
        TestLoad::Steering,
        &["steer_by_rack", "caster_by_rack", "rack_force"],
    ),
    (
        TestLoad::Lateral,
        &[
            "toe_by_lateral_force",
            "camber_by_lateral_force",
            "caster_by_lateral_force",
            "spin_by_lateral_force",
            "wheel_centre_by_lateral_force",
            "contact_by_lateral_force",
            "lateral_stiffness_wheel_centre",
            "lateral_stiffness_contact",
            "jacking_by_lateral_force",
            "axle_steer_by_lateral_force",
            "understeer_by_lateral_force",
            "force_roll_centre_height_compliant",
        ],
    ),
    (
        TestLoad::Braking,
        &[
            "toe_by_braking",
            "camber_by_braking",
            "caster_by_braking",
            "spin_by_braking",
            "recession_by_braking",
            "jacking_by_braking",
            "longitudinal_stiffness_wheel_centre",
        ],
    ),
    (
        TestLoad::Traction,
        &[
            "toe_by_traction",
            "camber_by_traction",
            "caster_by_traction",
            "spin_by_traction",
            "recession_by_traction",
            "longitudinal_stiffness_wheel_centre",
        ],
    ),
    (
        TestLoad::Aligning,
        &[
            "toe_by_aligning_moment",
            "camber_by_aligning_moment",
            "understeer_by_aligning_moment",
        ],
    ),
    (
        TestLoad::Vertical,
        &["compliant_wheel_rate", "compliant_ride_rate"],
    ),
];

/// Results that describe the whole axle. The results of a roll test also describe the whole axle, but are not in this
/// list.
const OF_AXLES: [&str; 4] = [
    "axle_steer_by_lateral_force",
    "understeer_by_lateral_force",
    "force_roll_centre_height_compliant",
    "understeer_by_aligning_moment",
];

/// Names of all test results, each once.
pub fn figure_names() -> Vec<&'static str> {
    let mut names = Vec::new();
    for name in FIGURES.iter().flat_map(|(_, names)| *names) {
        if !names.contains(name) {
            names.push(*name);
        }
    }
    names
}

/// Names of the results of tests with this load.
pub fn figures_by(load: TestLoad) -> &'static [&'static str] {
    let found = FIGURES.iter().find(|(own, _)| *own == load);
    found.map_or(&[], |(_, names)| names)
}

/// Returns the loads of the tests that have a result of this name.
pub fn loads_of_figure(figure: &str) -> impl Iterator<Item = TestLoad> {
    let with = FIGURES
        .iter()
        .filter(move |(_, names)| names.contains(&figure));
    with.map(|(load, _)| *load)
}

/// Returns true if the result needs both wheels of an axle.
pub fn is_figure_of_axles(figure: &str) -> bool {
    OF_AXLES.contains(&figure) || figures_by(TestLoad::Roll).contains(&figure)
}

/// Suffixes of result names, each with the key and value of the test that cause this suffix.
const ADDITIONS: [(&str, &str); 7] = [
    ("_wheel_height", "hold = \"wheel_height\""),
    ("_wheel_load", "hold = \"wheel_load\""),
    ("_opposed", "mode = \"opposed\""),
    ("_left_loaded", "mode = \"single\""),
    ("_right_loaded", "mode = \"single\""),
    ("_without_bar", "anti_roll_bar = \"disconnected\""),
    ("_locked_rack", "steering = \"locked_rack\""),
];

/// Splits the name of a test result in a study. Returns the name of the result without suffixes, and the keys of its
/// test except the load. `None` if no test has a result with this name.
pub fn figure_and_keys(name: &str) -> Option<(&'static str, Vec<String>)> {
    let loads = FIGURES.iter().map(|(load, _)| format!("_{}", load.name()));
    let mut without_load = loads.filter_map(|end| name.strip_suffix(&end));
    figure_and_additions(name).or_else(|| without_load.find_map(figure_and_additions))
}

/// Splits a name that does not end with the load of the test.
fn figure_and_additions(name: &str) -> Option<(&'static str, Vec<String>)> {
    let name = name.strip_suffix("_secant").unwrap_or(name);
    let names = figure_names().into_iter();
    let figure = names
        .filter(|figure| name.starts_with(figure))
        .max_by_key(|figure| figure.len())?;
    let mut rest = &name[figure.len()..];
    let mut keys = Vec::new();
    if let Some(trail) = rest.strip_prefix("_trail_") {
        let end = trail.find('_').unwrap_or(trail.len());
        trail[..end].parse::<f64>().ok()?;
        keys.push(format!("trail = {}", &trail[..end]));
        rest = &trail[end..];
    }
    while !rest.is_empty() {
        let additions = ADDITIONS.iter();
        let (left, key) = additions
            .filter_map(|(addition, key)| Some((rest.strip_prefix(addition)?, *key)))
            .next()?;
        keys.push(key.to_owned());
        rest = left;
    }
    Some((figure, keys))
}

/// Starts of the names of results whose sign depends on the direction of the study's y axis. These results are
/// derivatives with respect to the rack displacement, and forces along the rack.
const ALONG_Y: [&str; 3] = ["steer_by_rack", "caster_by_rack", "rack_force"];

/// Returns true if the sign of a result changes when the study's y axis points to the other side.
pub fn follows_y_axis(figure: &str) -> bool {
    ALONG_Y.iter().any(|start| figure.starts_with(start))
}

/// Returns true if a positive value of a result means steer to the left, on both sides of the car.
pub fn is_steer_to_left(figure: &str) -> bool {
    figure.starts_with("steer_by")
}

/// Parts of result names, each with the meaning of a positive value. The first of these parts that occurs in a name
/// applies.
const SIGNS: &[(&str, &str)] = &[
    ("toe_by", "toe-in"),
    ("camber_by", "top outboard"),
    ("caster_by", "top of the steering axis rearward"),
    ("spin_by", "front of the carrier upward (caster increases)"),
    ("recession_by", "wheel centre rearward"),
    ("jacking_by", "upward force at the contact point"),
    ("wheel_centre_by", "inboard"),
    ("contact_by", "inboard"),
    ("half_track_by", "contact point outboard"),
    ("wheelbase_by", "contact point forward"),
    ("understeer_by", "understeer"),
    ("steer_by", "steer to the left"),
    ("rack_force", "force along +y"),
    ("roll_centre_height", "above the ground"),
    ("tension", "tension"),
    ("stiffness", "load along the displacement"),
    ("rate", "load grows as the contact point rises"),
];

/// Returns the meaning of a positive value of a test result. The name of the result may start with a side and end with
/// the trail of the test.
pub fn sign_of_figure(name: &str) -> &'static str {
    let mut signs = SIGNS.iter();
    let own = signs.find(|(part, _)| name.contains(part));
    own.map_or("", |(_, sign)| sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_figures_give_the_keys_of_their_tests() {
        let keys =
            |name: &str| figure_and_keys(name).map(|(figure, keys)| (figure, keys.join(", ")));
        let of = |figure, keys: &str| Some((figure, keys.to_owned()));
        assert_eq!(
            keys("toe_by_lateral_force_trail_30_opposed_secant"),
            of("toe_by_lateral_force", "trail = 30, mode = \"opposed\"")
        );
        assert_eq!(keys("rack_force"), of("rack_force", ""));
        assert_eq!(keys("toe_by_braking_secant"), of("toe_by_braking", ""));
        let stiffness = "longitudinal_stiffness_wheel_centre";
        assert_eq!(keys(&format!("{stiffness}_traction")), of(stiffness, ""));
        assert_eq!(keys("toe_by_lateral_forces"), None);
        assert_eq!(keys("camber"), None);
    }

    #[test]
    fn every_figure_has_a_sign() {
        for name in figure_names() {
            assert_ne!(sign_of_figure(name), "", "{name}");
        }
        assert_eq!(
            sign_of_figure("left_toe_by_lateral_force_trail_30"),
            "toe-in"
        );
        assert_eq!(
            sign_of_figure("axle_steer_by_lateral_force"),
            "steer to the left"
        );
        assert_eq!(sign_of_figure("understeer_by_lateral_force"), "understeer");
    }
}

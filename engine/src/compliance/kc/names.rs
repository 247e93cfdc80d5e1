//! Names of the figures of tests.

/// Names of all figures, without the additions of [`crate::axle::TestFigure::stem`].
pub const FIGURE_NAMES: &[&str] = &[
    "toe_by_heave",
    "camber_by_heave",
    "caster_by_heave",
    "half_track_by_heave",
    "wheelbase_by_heave",
    "compliant_ride_rate",
    "steer_by_roll",
    "camber_by_roll",
    "compliant_roll_stiffness",
    "link_roll_stiffness",
    "lower_link_tension",
    "upper_link_tension",
    "panhard_tension",
    "steer_by_rack",
    "caster_by_rack",
    "rack_force",
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
    "toe_by_braking",
    "camber_by_braking",
    "caster_by_braking",
    "spin_by_braking",
    "recession_by_braking",
    "jacking_by_braking",
    "toe_by_traction",
    "camber_by_traction",
    "caster_by_traction",
    "spin_by_traction",
    "recession_by_traction",
    "longitudinal_stiffness_wheel_centre",
    "toe_by_aligning_moment",
    "camber_by_aligning_moment",
    "understeer_by_aligning_moment",
    "compliant_wheel_rate",
];

/// Beginnings of the names of figures whose sign follows the study's y axis: they are by a displacement of the rack, or forces along it.
const ALONG_Y: [&str; 3] = ["steer_by_rack", "caster_by_rack", "rack_force"];

/// Returns true for a figure that changes its sign if the study's y axis points to the other side.
pub fn follows_y_axis(figure: &str) -> bool {
    ALONG_Y.iter().any(|start| figure.starts_with(start))
}

/// Beginnings and parts of the names of figures, each with the meaning of a positive value. The first one that a name contains
/// counts.
const SIGNS: &[(&str, &str)] = &[
    ("toe_by", "toe-in"),
    ("camber_by", "top outboard"),
    ("caster_by", "top of the steering axis rearward"),
    ("spin_by", "carrier nose up, as caster grows"),
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

/// Meaning of a positive value of a figure. The name may have a side before it and the test's trail after it.
pub fn sign_of_figure(name: &str) -> &'static str {
    let mut signs = SIGNS.iter();
    let own = signs.find(|(part, _)| name.contains(part));
    own.map_or("", |(_, sign)| sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_a_sign() {
        for name in FIGURE_NAMES {
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

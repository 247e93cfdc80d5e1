use super::*;

fn named(topology: &str) -> &'static Topology {
    Topology::named(topology).unwrap()
}

#[test]
fn every_hardpoint_is_known_by_its_own_name_and_by_that_of_adams() {
    // The importer never uses topologies that carry both wheels for a single wheel.
    let wheels = Topology::ALL.iter().filter(|t| !t.carries_both_wheels());
    for topology in wheels {
        for known in topology.all_hardpoints() {
            let capitals = known.name.to_uppercase().replace('_', " ");
            for name in [known.name, &capitals, in_adams(known.name)] {
                assert_eq!(hardpoint(name, topology), Some(known.name), "{name}");
            }
        }
    }
}

#[test]
fn usual_names_are_known() {
    for (topology, name, meant) in [
        ("double_wishbone", "hpl_lca_front", "lower_arm_front"),
        ("double_wishbone", "LCA Fore Inner", "lower_arm_front"),
        (
            "double_wishbone",
            "Lower wishbone - rear pivot",
            "lower_arm_rear",
        ),
        ("double_wishbone", "UBJ", "upper_ball_joint"),
        (
            "double_wishbone",
            "Upper A-Arm Outboard",
            "upper_ball_joint",
        ),
        ("double_wishbone", "Track rod inner", "tie_rod_inner"),
        (
            "double_wishbone",
            "Inner track rod ball joint",
            "tie_rod_inner",
        ),
        ("five_link", "Outer track rod ball joint", "toe_link_outer"),
        ("double_wishbone", "toe link outboard", "tie_rod_outer"),
        ("double_wishbone", "TieRodInner", "tie_rod_inner"),
        ("double_wishbone", "WheelCenter", "wheel_centre"),
        ("double_wishbone", "Pushrod (upright)", "pushrod_outer"),
        ("double_wishbone", "Damper to rocker", "spring_lower"),
        (
            "double_wishbone",
            "Bellcrank axis front",
            "rocker_pivot_front",
        ),
        ("double_wishbone", "ARB inner", "anti_roll_bar_inner"),
        ("solid_axle", "lower link frame", "lower_link_chassis"),
        ("solid_axle", "Lower Trailing Arm (axle)", "lower_link_axle"),
        (
            "solid_axle",
            "upper control arm chassis",
            "upper_link_chassis",
        ),
        ("solid_axle", "upper link axle end", "upper_link_axle"),
        ("solid_axle", "Track bar frame", "panhard_chassis"),
        ("solid_axle", "Panhard rod, axle", "panhard_axle"),
        ("solid_axle", "Drag link pitman arm", "drag_link_body"),
        ("solid_axle", "drag link knuckle", "drag_link_knuckle"),
        ("solid_axle", "Upper ball joint", "kingpin_upper"),
        ("solid_axle", "tie rod end", "tie_rod_end"),
        ("macpherson", "Top mount", "strut_top"),
        ("macpherson", "strut_lwr_mount", "strut_lower"),
        (
            "five_link",
            "Upper link front, chassis",
            "upper_front_link_inner",
        ),
        ("five_link", "tierod_outer", "toe_link_outer"),
        (
            "semi_trailing_arm",
            "Trailing arm pivot, inboard",
            "arm_pivot_inner",
        ),
    ] {
        assert_eq!(hardpoint(name, named(topology)), Some(meant), "{name}");
    }
}

#[test]
fn what_is_not_certain_stays_unknown() {
    for name in [
        "lower arm",
        "front",
        "drive_shaft_inr",
        "subframe_front",
        "wheel",
        "tie",
        "lca",
        "front_lower_sway_thing",
        "",
    ] {
        assert_eq!(hardpoint(name, named("double_wishbone")), None, "{name}");
    }
    assert_eq!(hardpoint("uca_front", named("macpherson")), None);
}

#[test]
fn titles_name_wheels_and_axles_and_nothing_else() {
    let marks = |side, axle| Some(Marks { side, axle });
    for (text, found) in [
        ("FL", marks(Some(Side::Left), Some(AxlePosition::Front))),
        ("Front axle", marks(None, Some(AxlePosition::Front))),
        ("front_axle", marks(None, Some(AxlePosition::Front))),
        (
            "Rear right wheel",
            marks(Some(Side::Right), Some(AxlePosition::Rear)),
        ),
        ("left", marks(Some(Side::Left), None)),
        ("lower arm front", None),
        ("MyCar", None),
        ("front rear", None),
        ("wheel", None),
    ] {
        assert_eq!(marks_of_title(text), found, "{text}");
    }
}

//! Names that others give to hardpoints.
//!
//! A name is cut into words, abbreviations are spelt out (`LCA` is `lower arm`), and the words are
//! compared with those of a table, in any order: `lca_front`, `Lower wishbone - front pivot` and
//! `hpl_lca_front` are all `lower_arm_front`. Names that are not in the table stay unknown; nothing is
//! guessed by likeness.

use crate::model::{Side, Topology};

/// A name in words, and the side it speaks of.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Words {
    words: Vec<&'static str>,
    /// Words that no table knows.
    unknown: usize,
    /// The side.
    pub side: Option<Side>,
}

/// Words of names, and what they stand for; nothing where they add nothing.
const SPELT: &[(&str, &str)] = &[
    ("lca lwishbone", "lower arm"),
    ("uca uwishbone", "upper arm"),
    ("lbj", "lower ball"),
    ("ubj", "upper ball"),
    ("lower lwr low lo bottom bot", "lower"),
    ("upper upr up", "upper"),
    ("top", "top"),
    ("arm wishbone aarm", "arm"),
    ("ball bj balljoint kingpin", "ball"),
    ("inner inr in inboard inside chassis body frame", "inner"),
    ("outer otr out outboard outside upright knuckle", "outer"),
    ("front frt fwd fore forward f", "front"),
    ("rear aft rearward back rwd", "rear"),
    ("tierod trackrod", "tie rod"),
    ("tie track steering", "tie"),
    ("toe", "toe"),
    ("toelink toerod", "toe rod"),
    ("rod link", "rod"),
    ("wheel", "wheel"),
    ("centre center ctr cntr", "centre"),
    ("wc wctr", "wheel centre"),
    ("hub", "hub"),
    ("spindle spin", "spindle"),
    ("com", "com"),
    ("axis axle", "axis"),
    ("strut", "strut"),
    ("spring damper shock coilover", "spring"),
    ("mount mounting", "mount"),
    ("pushrod prod", "push rod"),
    ("push", "push"),
    ("pullrod", "pull rod"),
    ("pull", "pull"),
    ("rocker bellcrank", "rocker"),
    ("droplink", "drop rod"),
    ("drop", "drop"),
    ("arb antirollbar stabiliser stabilizer sway", "bar"),
    ("bar", "bar"),
    ("trailing", "trailing"),
    ("rack", "rack"),
    ("contact", "contact"),
    ("patch", "patch"),
    ("tyre tire", "tyre"),
    ("camber", "camber"),
    ("static", "static"),
    ("angle", "angle"),
    ("radius", "radius"),
    ("loaded", "loaded"),
    (
        "point points pt hp hardpoint hardpoints hard pivot pickup joint bush bushing control \
         a anti roll semi end of the at to deg mm susp suspension location",
        "",
    ),
];

/// Words that any name may carry.
const ANYWHERE: &[&str] = &["mount"];

/// Hardpoints by the words of their names: all of them in any order, those behind `?` if present; of several patterns one.
const PATTERNS: &[(&str, &str)] = &[
    ("lower_arm_front", "lower arm front ?inner"),
    ("lower_arm_rear", "lower arm rear ?inner"),
    (
        "lower_ball_joint",
        "lower ball ?arm ?outer | lower arm outer | lower outer",
    ),
    ("upper_arm_front", "upper arm front ?inner"),
    ("upper_arm_rear", "upper arm rear ?inner"),
    (
        "upper_ball_joint",
        "upper ball ?arm ?outer | upper arm outer | upper outer",
    ),
    (
        "tie_rod_inner",
        "tie rod inner ?rack | tie inner | rack inner | toe rod inner",
    ),
    ("tie_rod_outer", "tie rod outer | tie outer | toe rod outer"),
    (
        "wheel_centre",
        "wheel centre | hub centre | wheel hub centre | spindle com",
    ),
    (
        "spindle_inner",
        "spindle inner ?axis ?wheel | hub inner ?axis | axis inner ?wheel",
    ),
    (
        "strut_top",
        "strut top | strut upper mount | strut mount | top mount | spring upper | spring top",
    ),
    ("strut_lower", "strut lower ?outer | spring lower ?outer"),
    (
        "spring_upper",
        "spring upper ?inner | spring top | spring inner | top mount | strut top | strut upper",
    ),
    (
        "spring_lower",
        "spring lower ?outer ?rocker | spring outer | spring rocker | strut lower",
    ),
    ("upper_front_link_inner", "upper front inner ?rod ?arm"),
    ("upper_front_link_outer", "upper front outer ?rod ?arm"),
    ("upper_rear_link_inner", "upper rear inner ?rod ?arm"),
    ("upper_rear_link_outer", "upper rear outer ?rod ?arm"),
    ("lower_front_link_inner", "lower front inner ?rod ?arm"),
    ("lower_front_link_outer", "lower front outer ?rod ?arm"),
    ("lower_rear_link_inner", "lower rear inner ?rod ?arm"),
    ("lower_rear_link_outer", "lower rear outer ?rod ?arm"),
    ("toe_link_inner", "toe inner ?rod | tie inner ?rod"),
    ("toe_link_outer", "toe outer ?rod | tie outer ?rod"),
    ("arm_pivot_inner", "arm inner ?trailing"),
    ("arm_pivot_outer", "arm outer ?trailing"),
    ("pushrod_outer", "push rod outer | push rod lower"),
    (
        "pushrod_inner",
        "push rod inner | push rod upper | push rod rocker",
    ),
    ("pullrod_outer", "pull rod outer | pull rod upper"),
    (
        "pullrod_inner",
        "pull rod inner | pull rod lower | pull rod rocker",
    ),
    ("rocker_pivot_front", "rocker front ?axis"),
    ("rocker_pivot_rear", "rocker rear ?axis"),
    ("drop_link_outer", "drop rod outer | bar rod outer"),
    ("drop_link_inner", "drop rod inner | bar rod inner"),
    ("anti_roll_bar_inner", "bar inner ?axis"),
    ("anti_roll_bar_outer", "bar outer ?axis"),
];

/// Figures that a table may give beside hardpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Figure {
    /// Camber in the design position, degrees.
    StaticCamber,
    /// Toe in the design position, degrees.
    StaticToe,
    /// Loaded radius of the wheel.
    WheelRadius,
    /// The contact point, whose distance from the wheel centre is the loaded radius.
    ContactPoint,
}

const FIGURES: &[(Figure, &str)] = &[
    (Figure::StaticCamber, "camber ?static ?angle ?wheel"),
    (Figure::StaticToe, "toe ?static ?angle ?wheel"),
    (
        Figure::WheelRadius,
        "wheel radius ?loaded | tyre radius ?loaded | loaded radius",
    ),
    (Figure::ContactPoint, "contact ?patch ?tyre ?wheel ?centre"),
];

/// The side a word names.
pub(super) fn side_of(word: &str) -> Option<Side> {
    match word.to_ascii_lowercase().as_str() {
        "l" | "left" | "lh" | "lhs" | "fl" | "rl" | "hpl" => Some(Side::Left),
        "r" | "right" | "rh" | "rhs" | "fr" | "rr" | "hpr" => Some(Side::Right),
        _ => None,
    }
}

/// The words of a text in small letters, cut where signs stand or a capital follows a small letter.
pub(super) fn cut(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for c in text.chars() {
        if !c.is_alphanumeric() || (before.is_lowercase() && c.is_uppercase()) {
            words.push(String::new());
        }
        if c.is_alphanumeric() {
            words
                .last_mut()
                .expect("never empty")
                .extend(c.to_lowercase());
        }
        before = c;
    }
    words.retain(|word| !word.is_empty());
    words
}

impl Words {
    /// A name in words.
    pub(super) fn of(name: &str) -> Self {
        let mut cut = cut(name);
        // The unit behind a length, as our own tables write it: `wheel_radius_in`.
        let is_unit = |word: &String| super::points::unit_of(word).is_some();
        if cut.iter().any(|word| word == "radius") && cut.last().is_some_and(is_unit) {
            cut.pop();
        }
        // A side stands first or last.
        let mut side = None;
        for at_end in [false, true] {
            let word = if at_end { cut.last() } else { cut.first() };
            if side.is_none() && cut.len() > 1 {
                side = word.and_then(|word| side_of(word));
                if side.is_some() {
                    let at = if at_end { cut.len() - 1 } else { 0 };
                    cut.remove(at);
                }
            }
        }
        let mut words = Vec::new();
        let mut unknown = 0;
        for word in &cut {
            let spells = |(short, _): &&(&str, &str)| short.split(' ').any(|s| s == word);
            match SPELT.iter().find(spells) {
                Some((_, spelt)) => words.extend(spelt.split_whitespace()),
                None if word == "hps" => (),
                None => unknown += 1,
            }
        }
        words.sort_unstable();
        words.dedup();
        Words {
            words,
            unknown,
            side,
        }
    }

    /// Whether these are the words of one of some patterns.
    fn fit(&self, patterns: &str) -> bool {
        patterns.split(" | ").any(|pattern| self.fits(pattern))
    }

    fn fits(&self, pattern: &str) -> bool {
        let required = || pattern.split(' ').filter(|word| !word.starts_with('?'));
        let allowed = |word: &str| {
            let mut known = pattern.split(' ').map(|word| word.trim_start_matches('?'));
            known.any(|known| known == word) || ANYWHERE.contains(&word)
        };
        self.unknown == 0
            && required().all(|word| self.words.contains(&word))
            && self.words.iter().all(|word| allowed(word))
    }

    /// The figure of this name.
    pub(super) fn figure(&self) -> Option<Figure> {
        let found = FIGURES.iter().find(|(_, patterns)| self.fit(patterns));
        found.map(|(figure, _)| *figure)
    }
}

/// The hardpoint of a topology that a name means: the one of that name, or the one with its words.
pub(super) fn hardpoint(name: &str, topology: &Topology) -> Option<&'static str> {
    let plain = cut(name).join("_");
    let hardpoints = || topology.all_hardpoints().map(|hardpoint| hardpoint.name);
    if let Some(same) = hardpoints().find(|known| *known == plain) {
        return Some(same);
    }
    let words = Words::of(name);
    let mut fitting = PATTERNS
        .iter()
        .filter(|(known, patterns)| topology.hardpoint(known).is_some() && words.fit(patterns));
    fitting.next().map(|(known, _)| *known)
}

/// Names of hardpoints in Adams/Car's own templates.
const ADAMS: &[(&str, &str)] = &[
    ("lower_arm_front", "lca_front"),
    ("lower_arm_rear", "lca_rear"),
    ("lower_ball_joint", "lca_outer"),
    ("upper_arm_front", "uca_front"),
    ("upper_arm_rear", "uca_rear"),
    ("upper_ball_joint", "uca_outer"),
    ("tie_rod_inner", "tierod_inner"),
    ("tie_rod_outer", "tierod_outer"),
    ("wheel_centre", "wheel_center"),
    ("strut_top", "top_mount"),
    ("strut_lower", "strut_lwr_mount"),
    ("spring_upper", "top_mount"),
    ("spring_lower", "lwr_strut_mount"),
];

/// The name of a hardpoint in a subsystem of Adams/Car: that of its own templates, or ours.
pub(super) fn in_adams(hardpoint: &str) -> &str {
    let found = ADAMS.iter().find(|(known, _)| *known == hardpoint);
    found.map_or(hardpoint, |(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(topology: &str) -> &'static Topology {
        Topology::named(topology).unwrap()
    }

    #[test]
    fn every_hardpoint_is_known_by_its_own_name_and_by_that_of_adams() {
        for topology in Topology::ALL {
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
            "",
        ] {
            assert_eq!(hardpoint(name, named("double_wishbone")), None, "{name}");
        }
        assert_eq!(hardpoint("uca_front", named("macpherson")), None);
    }

    #[test]
    fn sides_are_told_from_words() {
        for (name, side) in [
            ("hpl_lca_front", Some(Side::Left)),
            ("LCA front R", Some(Side::Right)),
            ("FR lower ball joint", Some(Side::Right)),
            ("lower ball joint", None),
            ("left", None),
        ] {
            assert_eq!(Words::of(name).side, side, "{name}");
        }
        assert_eq!(
            Words::of("Tyre contact patch").figure(),
            Some(Figure::ContactPoint)
        );
        assert_eq!(
            Words::of("static_camber [deg]").figure(),
            Some(Figure::StaticCamber)
        );
    }
}

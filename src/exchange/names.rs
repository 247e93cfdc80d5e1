//! Words of names: splits a name, spells out abbreviations, and finds the hardpoint for the words.
//!
//! A name is split into words and abbreviations are spelt out (`LCA` is `lower arm`). The words are compared with those of a
//! table, in any order. So `lca_front`, `Lower wishbone - front pivot` and `hpl_lca_front` are all `lower_arm_front`. Names
//! that are not in the table stay unknown, because the importer never guesses from similarity. [`super::roles`] also recognises
//! the wheel, the axle and the body that a name states.

use super::table::{Marks, StatedMarks};
use crate::model::{AxlePosition, Side, Topology};

/// Longest name, in bytes. A longer text is not a name.
const LONGEST: usize = 300;

/// Words of names with their meanings. The importer ignores a word whose meaning is empty.
const SPELT: &[(&str, &str)] = &[
    ("lca lwishbone lwb", "lower arm"),
    ("uca uwishbone uwb", "upper arm"),
    ("fuca", "front upper arm"),
    ("flca", "front lower arm"),
    ("ruca", "rear upper arm"),
    ("rlca", "rear lower arm"),
    ("lbj", "lower ball"),
    ("ubj", "upper ball"),
    ("fubj", "front upper ball"),
    ("flbj", "front lower ball"),
    ("rubj", "rear upper ball"),
    ("rlbj", "rear lower ball"),
    ("lower lwr low lo bottom bot", "lower"),
    ("upper upr up", "upper"),
    ("top", "top"),
    ("arm wishbone aarm", "arm"),
    ("ball bj balljoint kingpin", "ball"),
    (
        "inner inr in inboard inbd ib i inside chassis body frame",
        "inner",
    ),
    (
        "outer otr out outboard outbd ob o outside upright knuckle",
        "outer",
    ),
    ("if", "inner front"),
    ("ir", "inner rear"),
    ("front frt fwd fore forward f", "front"),
    ("rear aft rearward back rwd", "rear"),
    ("tierod trackrod tr", "tie rod"),
    ("tie track steering steer", "tie"),
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
    ("end rodend", "end"),
    ("pushrod prod", "push rod"),
    ("push", "push"),
    ("pullrod", "pull rod"),
    ("pull", "pull"),
    ("rocker bellcrank", "rocker"),
    ("heave third", "heave"),
    ("droplink", "drop rod"),
    ("drop", "drop"),
    ("arb antirollbar stabiliser stabilizer sway", "bar"),
    ("bar", "bar"),
    ("blade lever", "lever"),
    ("trailing", "trailing"),
    ("panhard trackbar", "panhard"),
    ("draglink", "drag rod"),
    ("drag", "drag"),
    ("pitman", "pitman"),
    ("rack", "rack"),
    ("contact", "contact"),
    ("cp tcp", "contact patch"),
    ("patch", "patch"),
    ("tyre tire", "tyre"),
    ("camber", "camber"),
    ("static", "static"),
    ("angle", "angle"),
    ("radius", "radius"),
    ("diameter", "diameter"),
    ("loaded", "loaded"),
    ("half", "half"),
    ("width", "width"),
    ("height", "height"),
    ("rim", "rim"),
    ("cg cog gravity", "gravity"),
    ("offset", "offset"),
    ("lateral", "lateral"),
    ("longitudinal", "longitudinal"),
    ("vertical", "vertical"),
    (
        "point points pt hp hardpoint hardpoints hard pivot pickup joint jt jnt seat bush bushing control \
         a anti roll semi of the at on to deg mm susp suspension location",
        "",
    ),
];

/// Words that can occur in any name without a change of its meaning.
const ANYWHERE: &[&str] = &["mount", "end"];

/// Hardpoints with the words of their names. A name must have all words of a pattern, in any order, except words with `?`. Other
/// words may not occur, except those in [`ANYWHERE`]. If a hardpoint has several patterns (separated by `|`), one must match.
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
        "tie rod inner ?rack ?ball | tie inner ?rack | rack inner | rack end | tie rod rack | toe rod inner",
    ),
    (
        "tie_rod_outer",
        "tie rod outer ?ball | tie outer | tie arm ?outer | toe rod outer",
    ),
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
        "spring lower ?outer ?rocker ?arm | spring outer ?rocker | spring rocker | spring arm | strut lower",
    ),
    ("upper_front_link_inner", "upper front inner ?rod ?arm"),
    ("upper_front_link_outer", "upper front outer ?rod ?arm"),
    ("upper_rear_link_inner", "upper rear inner ?rod ?arm"),
    ("upper_rear_link_outer", "upper rear outer ?rod ?arm"),
    ("lower_front_link_inner", "lower front inner ?rod ?arm"),
    ("lower_front_link_outer", "lower front outer ?rod ?arm"),
    ("lower_rear_link_inner", "lower rear inner ?rod ?arm"),
    ("lower_rear_link_outer", "lower rear outer ?rod ?arm"),
    (
        "toe_link_inner",
        "toe inner ?rod ?ball | tie inner ?rod ?ball",
    ),
    (
        "toe_link_outer",
        "toe outer ?rod ?ball | tie outer ?rod ?ball",
    ),
    ("integral_link_inner", "integral inner ?rod ?arm ?lower"),
    ("integral_link_outer", "integral outer ?rod ?upper"),
    ("lower_joint_front", "lower arm front outer"),
    ("lower_joint_rear", "lower arm rear outer"),
    ("arm_pivot", "arm ?trailing"),
    ("upper_link_inner", "upper inner rod ?lateral"),
    ("upper_link_outer", "upper outer rod ?lateral"),
    (
        "lower_link_chassis",
        "lower rod inner ?trailing | lower arm inner ?rod ?trailing",
    ),
    (
        "lower_link_axle",
        "lower rod axis ?trailing | lower arm axis ?rod ?trailing | lower rod outer ?trailing | lower arm outer ?rod ?trailing",
    ),
    (
        "upper_link_chassis",
        "upper rod inner ?trailing | upper arm inner ?rod ?trailing",
    ),
    (
        "upper_link_axle",
        "upper rod axis ?trailing | upper arm axis ?rod ?trailing | upper rod outer ?trailing | upper arm outer ?rod ?trailing",
    ),
    ("panhard_chassis", "panhard inner ?rod ?bar | tie bar inner"),
    (
        "panhard_axle",
        "panhard axis ?rod ?bar | panhard outer ?rod ?bar | tie bar axis | tie bar outer",
    ),
    ("drag_link_body", "drag rod inner | drag rod pitman ?arm"),
    ("drag_link_knuckle", "drag rod outer"),
    ("kingpin_upper", "upper ball"),
    ("kingpin_lower", "lower ball"),
    ("tie_rod_end", "tie rod ?outer"),
    ("lower_link_inner", "lower inner rod ?lateral"),
    ("lower_link_outer", "lower outer rod ?lateral"),
    ("arm_pivot_inner", "arm inner ?trailing"),
    ("arm_pivot_outer", "arm outer ?trailing"),
    (
        "pushrod_outer",
        "push rod outer ?lower ?upper ?arm | push rod lower ?arm",
    ),
    (
        "pushrod_inner",
        "push rod inner ?rocker ?upper | push rod upper ?rocker | push rod rocker",
    ),
    (
        "pullrod_outer",
        "pull rod outer ?lower ?upper ?arm | pull rod upper ?arm",
    ),
    (
        "pullrod_inner",
        "pull rod inner ?rocker ?lower | pull rod lower ?rocker | pull rod rocker",
    ),
    ("rocker_pivot_front", "rocker front ?axis"),
    ("rocker_pivot_rear", "rocker rear ?axis"),
    ("heave_spring", "heave spring ?rocker"),
    (
        "drop_link_outer",
        "drop rod outer ?bar ?rocker ?lower ?arm | bar rod outer ?rocker ?lower ?arm | bar rod rocker ?drop | drop rod rocker",
    ),
    (
        "drop_link_inner",
        "drop rod inner ?bar ?lever | bar rod inner ?lever | bar rod lever ?drop | drop rod lever | drop rod bar",
    ),
    ("anti_roll_bar_inner", "bar inner ?axis"),
    ("anti_roll_bar_outer", "bar outer ?axis"),
];

/// Wheel and axle that a word names.
pub(super) fn marks_of(word: &str) -> Marks {
    use AxlePosition::{Front, Rear};
    use Side::{Left, Right};
    let (side, axle) = match word.to_ascii_lowercase().as_str() {
        "l" | "left" | "lh" | "lhs" | "hpl" => (Some(Left), None),
        "r" | "right" | "rh" | "rhs" | "hpr" => (Some(Right), None),
        "fl" | "lf" => (Some(Left), Some(Front)),
        "fr" | "rf" => (Some(Right), Some(Front)),
        "rl" | "lr" => (Some(Left), Some(Rear)),
        "rr" => (Some(Right), Some(Rear)),
        _ => (None, None),
    };
    Marks { side, axle }
}

/// Side of the car that a word names.
pub(super) fn side_of(word: &str) -> Option<Side> {
    marks_of(word).side
}

/// Wheel and axle that a title or a cell names, if it contains nothing else: "Front left", "FL", "rear axle".
pub(super) fn marks_of_title(text: &str) -> Option<Marks> {
    const BESIDE: &str = "axle axles suspension susp corner wheel side geometry hardpoints hardpoint hp points kinematics";
    let mut marks = Marks::default();
    for word in cut(text) {
        let axle = match word.as_str() {
            "front" | "f" => Some(AxlePosition::Front),
            "rear" => Some(AxlePosition::Rear),
            _ => None,
        };
        let found = marks_of(&word).or(Marks { side: None, axle });
        if found.is_empty() && !BESIDE.split(' ').any(|known| known == word) {
            return None;
        }
        let differs = |a: bool, b: bool| a && b;
        if differs(marks.side.is_some(), found.side.is_some())
            || differs(marks.axle.is_some(), found.axle.is_some())
        {
            return None;
        }
        marks = marks.or(found);
    }
    (!marks.is_empty()).then_some(marks)
}

/// Wheel and axle in an entry such as "left", "FL", "both" or "rear". `None` for other texts.
pub(super) fn marks_of_entry(text: &str) -> Option<StatedMarks> {
    let one = |marks: Marks| StatedMarks {
        marks,
        mirrored: false,
    };
    match cut(text).join(" ").as_str() {
        "left right" | "both" | "symmetric" | "l r" => Some(StatedMarks {
            marks: Marks::default(),
            mirrored: true,
        }),
        "single" | "centre" | "center" | "" => Some(StatedMarks::default()),
        _ => marks_of_title(text).map(one),
    }
}

/// Entries that the importer accepts in a cell or under a key for the wheel or the axle, for messages.
pub(super) const KNOWN_MARKS: &str = "left, right, left/right, front, rear, FL, FR, RL or RR";

/// Splits a text into lower-case words. A word ends at a punctuation mark, or where a capital follows a small letter. A text that
/// is too long for a name has no words.
pub(super) fn cut(text: &str) -> Vec<String> {
    if text.len() > LONGEST {
        return Vec::new();
    }
    // The abbreviations "o/b" and "i/b" are single words.
    let text = &text.replace("o/b", "outboard").replace("i/b", "inboard");
    let text = &text.replace("O/B", "OUTBOARD").replace("I/B", "INBOARD");
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

/// Words of a point's name, in their order and without abbreviations.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Words {
    words: Vec<&'static str>,
    /// Number of words of the name that are not in the table of known words. 1 for a text without words.
    pub(super) unknown: usize,
}

impl Words {
    /// Replaces the abbreviations in a list of words: `lca` becomes `lower arm`.
    pub(super) fn spelt(cut: &[String]) -> Self {
        let mut words = Vec::new();
        let mut unknown = usize::from(cut.is_empty());
        for word in cut {
            let spells = |(short, _): &&(&str, &str)| short.split(' ').any(|s| s == word);
            match SPELT.iter().find(spells) {
                Some((_, spelt)) => words.extend(spelt.split_whitespace()),
                None if word == "hps" => (),
                None => unknown += 1,
            }
        }
        Words { words, unknown }
    }

    /// True if the name has neither a known nor an unknown word. Words that the importer ignores do not count.
    pub(super) fn is_empty(&self) -> bool {
        self.words.is_empty() && self.unknown == 0
    }

    /// Number of words that mean front or rear.
    pub(super) fn ends(&self) -> usize {
        self.words.iter().filter(|w| end_of(w).is_some()).count()
    }

    /// Splits off the first "front" or "rear" as the name of the axle. `None` if neither occurs.
    pub(super) fn without_axle(&self) -> Option<(AxlePosition, Words)> {
        let at = self.words.iter().position(|word| end_of(word).is_some())?;
        let axle = end_of(self.words[at])?;
        let mut rest = self.clone();
        rest.words.remove(at);
        Some((axle, rest))
    }

    /// True if the words match one of the patterns, which are written as in [`PATTERNS`].
    pub(super) fn fit(&self, patterns: &str) -> bool {
        patterns.split(" | ").any(|pattern| self.fits(pattern))
    }

    fn fits(&self, pattern: &str) -> bool {
        let mut required = pattern.split(' ').filter(|word| !word.starts_with('?'));
        let allowed = |word: &str| {
            let mut known = pattern.split(' ').map(|word| word.trim_start_matches('?'));
            known.any(|known| known == word) || ANYWHERE.contains(&word)
        };
        self.unknown == 0
            && required.all(|word| self.words.contains(&word))
            && self.words.iter().all(|word| allowed(word))
    }

    /// "lower" or "upper" if the words name this end of a drop link and nothing else. Which of the two is on the bar differs from
    /// car to car.
    pub(super) fn end_of_drop_link(&self) -> Option<&'static str> {
        let ends = ["lower", "upper"].into_iter();
        let mut ends = ends.filter(|end| self.fit(&format!("drop rod {end} ?bar | bar rod {end}")));
        ends.next()
    }

    /// Hardpoint of a topology whose name has these words.
    pub(super) fn hardpoint(&self, topology: &Topology) -> Option<&'static str> {
        let mut fitting = PATTERNS
            .iter()
            .filter(|(known, patterns)| topology.hardpoint(known).is_some() && self.fit(patterns));
        fitting.next().map(|(known, _)| *known)
    }
}

/// Axle or end that a spelt-out word names.
pub(super) fn end_of(word: &str) -> Option<AxlePosition> {
    match word {
        "front" => Some(AxlePosition::Front),
        "rear" => Some(AxlePosition::Rear),
        _ => None,
    }
}

/// Returns the hardpoint of a topology that a name means.
pub(super) fn hardpoint(name: &str, topology: &Topology) -> Option<&'static str> {
    super::roles::read(name, topology, super::roles::Letters::default()).map(|role| role.hardpoint)
}

/// Names of hardpoints in the templates of Adams/Car.
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

/// Name of a hardpoint in a subsystem of Adams/Car: the name in Adams' templates, or our own.
pub(super) fn in_adams(hardpoint: &str) -> &str {
    let found = ADAMS.iter().find(|(known, _)| *known == hardpoint);
    found.map_or(hardpoint, |(_, name)| name)
}

#[cfg(test)]
mod tests;

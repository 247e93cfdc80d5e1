//! Roles of names: the hardpoint that a name means, with the wheel, the axle and the body in the name.
//!
//! Sides are first or last in a name (`hpl_lca_front`, `LCA front R`, `FL lower ball joint`). "Front" and "rear" mean the pivot
//! if the hardpoint needs one (`lca_front`), otherwise the axle (`front lower ball joint`). If a name has two of them, the first
//! one is the axle (`FUCA aft`, `F_LCA_IF`). A single `R` means the right wheel, with two exceptions. It means the rear if the
//! name would otherwise mean no hardpoint (`LCA_R`), or if the file uses `F` but never `L`.

use super::names::{Words, cut, marks_of};
use super::table::{Marks, NamedPoint};
use crate::model::{AxlePosition, Topology};

/// Meaning of a point's name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Role {
    /// Hardpoint that the name means.
    pub hardpoint: &'static str,
    /// Wheel and axle in the name.
    pub marks: Marks,
    /// Body in the name, in the words of studies.
    pub body: Option<&'static str>,
}

/// Meanings of words that depend on the other names of the file: a single letter `R`, and the ends of a drop link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Letters {
    /// True if the word `R` at the start of a name means the rear axle.
    first_is_rear: bool,
    /// True if the word `R` at the end of a name means the rear.
    last_is_rear: bool,
    /// End of the drop link that is mounted on an arm, a rocker or the wheel carrier: "lower" or "upper". `None` if no name states
    /// this body.
    outer_drop_link: Option<&'static str>,
}

impl Letters {
    /// Finds the meanings of these words from the names in a file: `R` means rear if the file uses `F` but not `L`.
    pub(super) fn of<'a>(names: impl Iterator<Item = &'a str> + Clone) -> Self {
        let has = |wanted: &str, last: bool| {
            names.clone().any(|name| {
                let words = cut(name);
                let word = if last { words.last() } else { words.first() };
                words.len() > 1 && word.is_some_and(|word| word == wanted)
            })
        };
        let is_rear = |last| has("f", last) && has("r", last) && !has("l", last);
        let seated = names.clone().find_map(|name| {
            let (plain, _) = Topology::ALL.first().and_then(|any| seat(name, any))?;
            end_of_drop_link(&cut(&plain))
        });
        Letters {
            first_is_rear: is_rear(false),
            last_is_rear: is_rear(true),
            outer_drop_link: seated,
        }
    }

    /// Finds the meanings of these words from the names of the points.
    pub(super) fn of_points(points: &[NamedPoint]) -> Self {
        Letters::of(points.iter().map(|point| point.read_as.as_str()))
    }
}

/// Names of OptimumKinematics, split into words.
const OPTIMUM: &[(&str, &str)] = &[
    ("chas low for", "lower_arm_front"),
    ("chas low aft", "lower_arm_rear"),
    ("chas upp for", "upper_arm_front"),
    ("chas upp aft", "upper_arm_rear"),
    ("upri low pnt", "lower_ball_joint"),
    ("upri upp pnt", "upper_ball_joint"),
    ("chas tie pnt", "tie_rod_inner"),
    ("upri tie pnt", "tie_rod_outer"),
    ("nsma ppatt pnt", "pushrod_outer"),
    ("nsma ppatt", "pushrod_outer"),
    ("rock rod pnt", "pushrod_inner"),
    ("chas roc axi", "rocker_pivot_rear"),
    ("chas roc piv", "rocker_pivot_front"),
    ("chas att pnt", "spring_upper"),
    ("rock coi pnt", "spring_lower"),
    ("nsma ubar att pnt", "drop_link_outer"),
    ("ubar att pnt", "drop_link_inner"),
    ("chas piv pnt", "anti_roll_bar_outer"),
];

/// True if these points have the names of OptimumKinematics.
pub(super) fn is_optimum(points: &[NamedPoint]) -> bool {
    points.iter().any(|point| {
        let words = cut(&point.read_as);
        let has = |wanted: &str| words.iter().any(|word| word == wanted);
        (has("chas") || has("upri")) && optimum(&words).is_some()
    })
}

/// Finds the hardpoint of an OptimumKinematics name. The axle may precede the name, and the wheel may follow it.
fn optimum(words: &[String]) -> Option<(&'static str, Marks)> {
    let (words, marks) = match words {
        [rest @ .., last] if !marks_of(last).is_empty() && rest.len() > 1 => (rest, marks_of(last)),
        _ => (words, Marks::default()),
    };
    let fitting = OPTIMUM.iter().filter_map(|(name, hardpoint)| {
        let own: Vec<&str> = name.split(' ').collect();
        let before = words.len().checked_sub(own.len())?;
        (words[before..] == own).then_some((before, *hardpoint))
    });
    // The longest name has priority, because `nsma ubar att pnt` ends with `ubar att pnt`.
    let (before, hardpoint) = fitting.min_by_key(|(before, _)| *before)?;
    let marks = words[..before].iter().fold(marks, |marks, word| {
        let axle = match word.as_str() {
            "front" => Some(AxlePosition::Front),
            "rear" => Some(AxlePosition::Rear),
            _ => None,
        };
        marks.or(marks_of(word)).or(Marks { side: None, axle })
    });
    Some((hardpoint, marks))
}

/// Wheel and axle in a name that means a hardpoint of some topology. Empty for other names.
pub(super) fn marks(name: &str, letters: Letters) -> Marks {
    let read = Topology::ALL
        .iter()
        .find_map(|topology| read(name, topology, letters));
    read.map_or(Marks::default(), |role| role.marks)
}

/// Reads the role of a name.
pub(super) fn read(name: &str, topology: &Topology, letters: Letters) -> Option<Role> {
    // Words of the body, as in "Pushrod lower (on UCA)", do not belong to the name of the point.
    let seated = seat(name, topology).and_then(|(plain, body)| {
        let role = read_plain(&plain, topology, letters)?;
        let body = Some(body);
        ENDS.contains(&role.hardpoint)
            .then_some(Role { body, ..role })
    });
    seated.or_else(|| read_plain(name, topology, letters))
}

/// Splits the body off a name: "Pushrod lower (on UCA)", "Pushrod lower [upper wishbone]", "Spring on LCA".
fn seat(name: &str, topology: &Topology) -> Option<(String, &'static str)> {
    let in_brackets = || {
        let (before, rest) = name.split_once(['(', '['])?;
        let (body, after) = rest.split_once([')', ']'])?;
        Some((format!("{before} {after}"), body))
    };
    let after_word = || {
        let at = name.to_ascii_lowercase().find(" on ")?;
        Some((name[..at].to_owned(), &name[at..]))
    };
    let (plain, body) = in_brackets().or_else(after_word)?;
    Some((plain, body_of(body, topology)?))
}

/// "lower" or "upper" if the words name this end of a drop link.
pub(super) fn end_of_drop_link(cut: &[String]) -> Option<&'static str> {
    let (words, _) = stripped(cut.to_vec());
    let words = Words::spelt(&words);
    let on_axle = || words.without_axle()?.1.end_of_drop_link();
    words.end_of_drop_link().or_else(on_axle)
}

/// Ends of springs and rods that may be mounted on different bodies.
const ENDS: [&str; 4] = [
    "spring_lower",
    "drop_link_outer",
    "pushrod_outer",
    "pullrod_outer",
];

/// Reads the role of a name. Does not remove a body such as "(on UCA)" from the name first.
fn read_plain(name: &str, topology: &Topology, letters: Letters) -> Option<Role> {
    let words = cut(name);
    let plain = words.join("_");
    let mut own = topology.all_hardpoints().map(|hardpoint| hardpoint.name);
    if let Some(hardpoint) = own.find(|known| *known == plain) {
        let marks = Marks::default();
        return Some(Role {
            hardpoint,
            marks,
            body: None,
        });
    }
    if let Some((hardpoint, marks)) = optimum(&words) {
        topology.hardpoint(hardpoint)?;
        return Some(Role {
            hardpoint,
            marks,
            body: None,
        });
    }
    let readings = readings(&words, letters);
    // The topology's own hardpoint names with a side have priority over the meaning of single words.
    let own = readings.iter().find_map(|(words, marks)| {
        let plain = words.join("_");
        let mut all = topology.all_hardpoints().map(|hardpoint| hardpoint.name);
        all.find(|known| *known == plain).map(|name| (name, *marks))
    });
    let by_words = || {
        let mut all = readings.iter();
        all.find_map(|(words, marks)| hardpoint(words, *marks, topology))
    };
    let drop_link = || {
        let (end, outer) = (end_of_drop_link(&words)?, letters.outer_drop_link?);
        let (words, marks) = readings.first()?;
        let name = if end == outer {
            "drop_link_outer"
        } else {
            "drop_link_inner"
        };
        let axle = Words::spelt(words).without_axle().map(|(axle, _)| axle);
        let known = topology.hardpoint(name)?;
        Some((known.name, marks.or(Marks { side: None, axle })))
    };
    let (hardpoint, marks) = own.or_else(by_words).or_else(drop_link)?;
    let body = body(name, hardpoint, topology);
    Some(Role {
        hardpoint,
        marks,
        body,
    })
}

/// Possible ways to split the words of a name into the wheel with the axle, and the other words. The most likely way is first.
fn readings(words: &[String], letters: Letters) -> Vec<(Vec<String>, Marks)> {
    let is_r = |word: Option<&String>| word.is_some_and(|word| word == "r");
    let rear = |words: &[String], first: bool, last: bool| {
        let mut changed = words.to_vec();
        if first && is_r(words.first()) {
            changed[0] = "rear".to_owned();
        }
        if last && is_r(words.last()) {
            *changed.last_mut().expect("the list has an element") = "rear".to_owned();
        }
        changed
    };
    let usual = stripped(rear(words, letters.first_is_rear, letters.last_is_rear));
    // The side may follow the letter R, as in `LCA_R_LH`.
    let (plain, marks) = usual.clone();
    let mut all = vec![usual];
    if is_r(words.last()) {
        all.push(stripped(rear(words, letters.first_is_rear, true)));
    }
    if marks.side.is_some() && is_r(plain.last()) {
        all.push((rear(&plain, false, true), marks));
    }
    all
}

/// Removes the word for a wheel, such as `L` or `FL`, from the start of a name, or else from its end. Returns the other words and
/// the wheel.
fn stripped(mut words: Vec<String>) -> (Vec<String>, Marks) {
    let mut marks = Marks::default();
    for at_end in [false, true] {
        let word = if at_end { words.last() } else { words.first() };
        let found = word.map(|word| marks_of(word)).unwrap_or_default();
        if words.len() > 1 && !found.is_empty() && marks.side.is_none() {
            marks = marks.or(found);
            let at = if at_end { words.len() - 1 } else { 0 };
            words.remove(at);
        }
    }
    (words, marks)
}

fn hardpoint(cut: &[String], marks: Marks, topology: &Topology) -> Option<(&'static str, Marks)> {
    let words = Words::spelt(cut);
    let on_axle = || {
        let (axle, rest) = words.without_axle()?;
        let hardpoint = rest.hardpoint(topology)?;
        let of_name = Marks {
            side: None,
            axle: Some(axle),
        };
        Some((hardpoint, marks.or(of_name)))
    };
    let as_it_is = || words.hardpoint(topology).map(|name| (name, marks));
    match words.ends() {
        0 => as_it_is(),
        1 => as_it_is().or_else(on_axle),
        _ => on_axle(),
    }
}

/// Body in a name, for an end of a spring or rod.
fn body(name: &str, hardpoint: &str, topology: &Topology) -> Option<&'static str> {
    ENDS.contains(&hardpoint)
        .then(|| body_of(name, topology))
        .flatten()
}

/// Body that some words name, as it is called in studies. `None` for other words.
pub(super) fn body_of(text: &str, topology: &Topology) -> Option<&'static str> {
    let cut = cut(text);
    let has = |wanted: &str| cut.iter().any(|word| wanted.split(' ').any(|w| w == word));
    let arm = has("arm wishbone aarm");
    let carrier = match topology.name {
        "semi_trailing_arm" | "trailing_arm_two_links" => "arm",
        _ => "knuckle",
    };
    if has("rocker bellcrank") {
        Some("rocker")
    } else if has("upright knuckle carrier") || (arm && carrier == "arm") {
        Some(carrier)
    } else if has("lca") || (arm && has("lower low bottom")) {
        Some("lower_arm")
    } else if has("uca") || (arm && has("upper upp top")) {
        Some("upper_arm")
    } else {
        None
    }
}

/// Axles that occur in a list of marks, each once, the front axle first.
pub(super) fn axles(marks: impl Iterator<Item = Marks>) -> Vec<AxlePosition> {
    let mut axles: Vec<AxlePosition> = Vec::new();
    for axle in marks.filter_map(|marks| marks.axle) {
        if !axles.contains(&axle) {
            axles.push(axle);
        }
    }
    axles.sort_by_key(|axle| *axle as usize);
    axles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Side;

    /// A test case: other names of the file, a name, and its hardpoint, wheel, axle and body.
    type Case = (
        &'static [&'static str],
        &'static str,
        &'static str,
        Option<Side>,
        Option<AxlePosition>,
        Option<&'static str>,
    );

    const PAIRED: [&str; 3] = ["F_LCA_IF", "R_LCA_IF", "F_UBJ"];
    const SIDED: [&str; 2] = ["LCA front L", "LCA front R"];
    const DROP_LINK: [&str; 2] = ["Droplink lower (on rocker)", "Droplink upper"];
    const FRONT: Option<AxlePosition> = Some(AxlePosition::Front);
    const REAR: Option<AxlePosition> = Some(AxlePosition::Rear);
    const LEFT: Option<Side> = Some(Side::Left);
    const RIGHT: Option<Side> = Some(Side::Right);

    /// Names of points of a double wishbone.
    const CASES: [Case; 30] = [
        (&[], "hpl_lca_front", "lower_arm_front", LEFT, None, None),
        (&SIDED, "LCA front R", "lower_arm_front", RIGHT, None, None),
        (
            &[],
            "FR lower ball joint",
            "lower_ball_joint",
            RIGHT,
            FRONT,
            None,
        ),
        (&[], "LCA_R", "lower_arm_rear", None, None, None),
        (&[], "LCA_F", "lower_arm_front", None, None, None),
        (&[], "UCA_R_LH", "upper_arm_rear", LEFT, None, None),
        (&[], "LCA_R_L", "lower_arm_rear", LEFT, None, None),
        (&[], "LCA_R_RH", "lower_arm_rear", RIGHT, None, None),
        (&[], "UBJ R", "upper_ball_joint", RIGHT, None, None),
        (&PAIRED, "F_LCA_IF", "lower_arm_front", None, FRONT, None),
        (&PAIRED, "R_LCA_IF", "lower_arm_front", None, REAR, None),
        (&PAIRED, "R_UBJ", "upper_ball_joint", None, REAR, None),
        (&[], "FUCA aft", "upper_arm_rear", None, FRONT, None),
        (
            &[],
            "front lower ball joint",
            "lower_ball_joint",
            None,
            FRONT,
            None,
        ),
        (&[], "Rack end", "tie_rod_inner", None, None, None),
        (&[], "Steering arm", "tie_rod_outer", None, None, None),
        (
            &[],
            "Damper o/b (rocker)",
            "spring_lower",
            None,
            None,
            Some("rocker"),
        ),
        (
            &[],
            "Push rod lower (on LCA)",
            "pushrod_outer",
            None,
            None,
            Some("lower_arm"),
        ),
        (
            &[],
            "Pushrod lower (on UCA)",
            "pushrod_outer",
            None,
            None,
            Some("upper_arm"),
        ),
        (
            &[],
            "Pushrod lower (on upper arm)",
            "pushrod_outer",
            None,
            None,
            Some("upper_arm"),
        ),
        (
            &[],
            "Pushrod lower (upper wishbone) L",
            "pushrod_outer",
            LEFT,
            None,
            Some("upper_arm"),
        ),
        (
            &DROP_LINK,
            "Droplink lower (on rocker)",
            "drop_link_outer",
            None,
            None,
            Some("rocker"),
        ),
        (
            &DROP_LINK,
            "Droplink upper",
            "drop_link_inner",
            None,
            None,
            None,
        ),
        (
            &[],
            "ARB link @ rocker",
            "drop_link_outer",
            None,
            None,
            Some("rocker"),
        ),
        (&[], "NSMA_PPAttPnt_L", "pushrod_outer", LEFT, None, None),
        (&[], "CHAS_RocPiv_L", "rocker_pivot_front", LEFT, None, None),
        (&[], "CHAS_RocAxi_L", "rocker_pivot_rear", LEFT, None, None),
        (
            &[],
            "Front NSMA_UBarAttPnt_L",
            "drop_link_outer",
            LEFT,
            FRONT,
            None,
        ),
        (&[], "LWB_IN_F", "lower_arm_front", None, None, None),
        (&[], "TR_OUT", "tie_rod_outer", None, None, None),
    ];

    #[test]
    fn names_say_wheel_axle_and_body() {
        let topology = Topology::named("double_wishbone").unwrap();
        for (others, name, hardpoint, side, axle, body) in CASES {
            let letters = Letters::of(others.iter().copied());
            let role = read(name, topology, letters).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(
                (role.hardpoint, role.marks, role.body),
                (hardpoint, Marks { side, axle }, body),
                "{name}"
            );
        }
    }
}

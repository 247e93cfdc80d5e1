//! Answers to names of suspensions and parts that are not topologies. Each one names the nearest available topology, or the
//! section of the part.

/// Words in names of unsupported suspensions and parts, each with the sentence that the program answers.
const INSTEAD: [(&str, &str); 8] = [
    (
        "leaf",
        "leaf springs are not available. The most similar topology is solid_axle, with the front \
         half of each leaf as its lower link",
    ),
    (
        "dion",
        "a De Dion axle moves like a solid_axle: give its links and its Panhard rod or Watt \
         linkage",
    ),
    ("torsion_beam", "a torsion beam is a twist_beam"),
    (
        "swing_axle",
        "a swing axle is a semi_trailing_arm whose pivots lie along x",
    ),
    (
        "third",
        "a third spring is [heave_spring] of an axle with rockers; `hardpoint new double_wishbone --with axle,pushrod` prints one to \
         which it can be added",
    ),
    (
        "heave_spring",
        "a heave spring is the section [heave_spring] of an axle with rockers",
    ),
    (
        "t_bar",
        "a T-bar is the section [t_bar] of an axle with rockers",
    ),
    (
        "monoshock",
        "a monoshock is an axle with rockers, [heave_spring] and no [spring], as in studies/double_wishbone_monoshock.toml",
    ),
];

/// Answer to a name that is not a topology.
pub(super) fn instead_of(name: &str) -> Option<&'static str> {
    let plain = name.trim().to_lowercase().replace(['-', ' '], "_");
    let found = INSTEAD.iter().find(|(word, _)| plain.contains(word));
    found.map(|(_, answer)| *answer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Topology;

    /// Every `..._axle` and `..._beam` that an answer mentions is a topology, and no existing topology has an answer.
    #[test]
    fn answers_name_topologies() {
        for (_, answer) in INSTEAD {
            let words = answer.split(|c: char| !c.is_alphanumeric() && c != '_');
            let names = words.filter(|word| word.ends_with("_axle") || word.ends_with("_beam"));
            for name in names {
                assert!(Topology::named(name).is_some(), "{name}");
            }
        }
        for topology in Topology::ALL {
            assert_eq!(instead_of(topology.name), None, "{}", topology.name);
        }
        assert!(instead_of("De-Dion axle").is_some_and(|answer| answer.contains("solid_axle")));
        assert_eq!(instead_of("double wishbones"), None);
    }
}

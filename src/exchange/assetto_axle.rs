//! Live axles of Assetto Corsa: `TYPE=AXLE` with the links of section `[AXLE]`, imported as a `solid_axle`.
//!
//! Each link has an end at the body, `J0_CAR`, and one at the axle, `J0_AXLE`. Coordinates are lateral, up and forward in metres
//! from the middle of both wheel centres; lateral is positive to the left. The importer identifies the links by their positions:
//!
//! | link | identified as |
//! |---|---|
//! | pair | two links that are mirror images; of two pairs the higher one is the upper one |
//! | Panhard rod | a link without a mirror image whose lateral extent exceeds its other extents |
//! | single upper link | another link without a mirror image |
//!
//! With two pairs and a Panhard rod, the axle binds in roll. If the two upper links are parallel in plan view, the importer
//! replaces them by one link in the middle. This link gives the same motion in heave, and the mean motion of both links in roll.

/// One end of a link in the file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct End {
    /// Lateral (positive left), up and forward coordinates, in m.
    pub place: [f64; 3],
    /// Line number in the file.
    pub line: usize,
}

/// A link of the section `[AXLE]`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Link {
    /// Number of the link in the keys of the file.
    pub number: usize,
    /// Ends of the link: at the body, and at the axle.
    pub ends: [End; 2],
}

/// Role of a link: the first part of the names of its hardpoints. The suffixes are `_chassis` and `_axle`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Meaning {
    /// The link in the file. A link that represents a pair is moved to the centre plane.
    pub link: Link,
    /// First part of the names of its hardpoints.
    pub part: &'static str,
}

/// Largest difference between coordinates that count as equal, in m: of mirror images, and of both ends of a parallel link.
const SAME: f64 = 1e-9;

impl Link {
    fn is_mirror_of(&self, other: &Link) -> bool {
        let ends = self.ends.iter().zip(&other.ends);
        let mut apart = ends.flat_map(|(a, b)| {
            let [x, y, z] = b.place;
            a.place.into_iter().zip([-x, y, z])
        });
        apart.all(|(a, b)| (a - b).abs() <= SAME)
    }

    /// Vector from the body to the axle: lateral, up, forward.
    fn along(&self) -> [f64; 3] {
        let [car, axle] = &self.ends;
        std::array::from_fn(|k| axle.place[k] - car.place[k])
    }

    /// True if the lateral extent of the link exceeds its other extents.
    fn is_across(&self) -> bool {
        let [lateral, up, forward] = self.along().map(f64::abs);
        lateral > up && lateral > forward
    }

    /// Sum of the heights of both ends, for comparisons.
    fn height(&self) -> f64 {
        self.ends[0].place[1] + self.ends[1].place[1]
    }

    /// Name of the link in messages.
    fn name(&self) -> String {
        format!("J{}", self.number)
    }
}

/// Identifies the links of a live axle. Also returns a note for the user, if there is one.
///
/// # Errors
/// The links do not match the topology `solid_axle`.
pub(super) fn meanings(links: &[Link]) -> Result<(Vec<Meaning>, Option<String>), String> {
    let mut pairs: Vec<&Link> = Vec::new();
    let mut singles: Vec<&Link> = Vec::new();
    for link in links {
        let mut others = links.iter();
        let twin = others.find(|other| other.number != link.number && link.is_mirror_of(other));
        match twin {
            // The importer uses only the left link of a pair.
            Some(twin) => {
                let lateral = |l: &Link| l.ends[0].place[0] + l.ends[1].place[0];
                if (lateral(link), link.number) > (lateral(twin), twin.number) {
                    pairs.push(link);
                }
            }
            None => singles.push(link),
        }
    }
    pairs.sort_by(|a, b| a.height().total_cmp(&b.height()));
    singles.sort_by_key(|link| link.is_across());
    let meaning = |link: &Link, part| Meaning {
        link: link.clone(),
        part,
    };
    match (&pairs[..], &singles[..]) {
        ([lower, upper], []) => Ok((
            vec![meaning(lower, "lower_link"), meaning(upper, "upper_link")],
            None,
        )),
        ([lower], [upper, rod]) if !upper.is_across() && rod.is_across() => Ok((
            vec![
                meaning(lower, "lower_link"),
                meaning(upper, "upper_link"),
                meaning(rod, "panhard"),
            ],
            None,
        )),
        ([lower, upper], [rod]) if rod.is_across() => {
            if upper.along()[0].abs() > SAME {
                return Err(format!(
                    "two splayed upper links ({} and its mirror image) and a Panhard rod ({}) are \
                     one link too many: with rigid joints the axle cannot move in roll. Use --map \
                     to name the points of a solid_axle without one of these links",
                    upper.name(),
                    rod.name()
                ));
            }
            let mut middle = (*upper).clone();
            for end in &mut middle.ends {
                end.place[0] = 0.0;
            }
            let note = format!(
                "one link in the middle replaces the upper links ({} and its mirror image): with both \
                 links and a Panhard rod the axle could not move in roll. In heave the motion is the \
                 same; in roll the link has the mean motion of both links",
                upper.name()
            );
            Ok((
                vec![
                    meaning(lower, "lower_link"),
                    meaning(&middle, "upper_link"),
                    meaning(rod, "panhard"),
                ],
                Some(note),
            ))
        }
        _ => {
            let found: Vec<String> = links.iter().map(Link::name).collect();
            Err(format!(
                "the links of [AXLE] ({}) are {} mirrored pairs and {} single ones; a solid_axle has two pairs, or a lower \
                 pair, an upper link and a Panhard rod. Name the points with --map, as in lower_link_chassis = \"AXLE J0_CAR\"",
                found.join(", "),
                pairs.len(),
                singles.len()
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(number: usize, car: [f64; 3], axle: [f64; 3]) -> Link {
        let end = |place| End { place, line: 1 };
        Link {
            number,
            ends: [end(car), end(axle)],
        }
    }

    fn pair(number: usize, car: [f64; 3], axle: [f64; 3]) -> [Link; 2] {
        let mirrored = |[x, y, z]: [f64; 3]| [-x, y, z];
        [
            link(number, mirrored(car), mirrored(axle)),
            link(number + 1, car, axle),
        ]
    }

    fn parts(links: &[Link]) -> Vec<(usize, &'static str)> {
        let (found, _) = meanings(links).unwrap();
        found.iter().map(|m| (m.link.number, m.part)).collect()
    }

    /// The order of the links in the file does not matter. The heights of the pairs show which pair is the upper one. The left
    /// link of each pair is used.
    #[test]
    fn links_are_told_apart_by_their_places() {
        let [a, b] = pair(0, [0.5, 0.1, 0.4], [0.2, 0.1, 0.0]);
        let [c, d] = pair(2, [0.4, -0.1, 0.5], [0.5, -0.12, 0.0]);
        assert_eq!(
            parts(&[a.clone(), b, c.clone(), d.clone()]),
            [(3, "lower_link"), (1, "upper_link")]
        );
        let rod = link(7, [0.5, 0.0, -0.1], [-0.5, 0.0, -0.1]);
        let upper = link(8, [0.1, 0.2, 0.4], [0.1, 0.2, 0.0]);
        assert_eq!(
            parts(&[rod.clone(), upper, c.clone(), d.clone()]),
            [(3, "lower_link"), (8, "upper_link"), (7, "panhard")]
        );
        // With a Panhard rod, two splayed upper links would lock the axle. One link in the middle replaces two parallel
        // upper links.
        let [e, f] = pair(4, [0.4, 0.1, 0.4], [0.2, 0.1, 0.0]);
        let refused = meanings(&[c.clone(), d.clone(), e, f, rod.clone()]).unwrap_err();
        assert!(refused.contains("cannot move in roll"), "{refused}");
        let [e, f] = pair(4, [0.4, 0.1, 0.4], [0.4, 0.12, 0.0]);
        let (found, note) = meanings(&[c.clone(), d.clone(), e, f, rod]).unwrap();
        assert_eq!(found[1].link.ends[1].place, [0.0, 0.12, 0.0]);
        assert!(note.unwrap().contains("J5"));
        // Two links that are not exact mirror images are no pair.
        let [g, mut h] = pair(4, [0.4, 0.1, 0.4], [0.2, 0.1, 0.0]);
        h.ends[0].place[1] = -0.1;
        let refused = meanings(&[c, d, g, h]).unwrap_err();
        assert!(
            refused.contains("1 mirrored pairs and 2 single ones"),
            "{refused}"
        );
        assert!(meanings(&[a]).is_err());
    }
}

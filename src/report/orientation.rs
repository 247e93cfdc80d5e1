//! Directions of the axes of points, derived from the points of a suspension.
//!
//! A suspension determines three directions. Each direction is a sum of differences between points, so long differences have the
//! largest weight:
//!
//! | direction | differences |
//! |---|---|
//! | forward | front pivot minus rear pivot of an arm, front minus rear link; pivots of a trailing arm minus wheel centre |
//! | outboard | joint at the wheel carrier minus joint at the body; wheel centre minus spin axis, axle link or shear centre |
//! | up | upper joint minus lower joint; without such a pair, upper end minus lower end of a spring without a rocker |
//!
//! A [`Reading`] assigns a coordinate and a sign to each direction. There are 48 readings. The score of a reading is the sum of
//! the cosines between the known directions and their coordinates. The best reading is accepted under two conditions: its score
//! exceeds the second best by at least [`LEAD`], and each of its cosines is at least [`LEAST_COSINE`]. Otherwise the points do
//! not determine the axes.

/// Smallest lead of the best reading's score over the second best score. An error of 90 degrees in one direction reduces the score
/// by 1.
pub(crate) const LEAD: f64 = 0.5;
/// Smallest cosine of the angle between a direction of the suspension and the coordinate that the reading assigns to it.
pub(crate) const LEAST_COSINE: f64 = 0.6;

/// Pairs of hardpoints: in a suspension, the first point is above the second.
const ABOVE: &[(&str, &str)] = &[
    ("upper_ball_joint", "lower_ball_joint"),
    ("strut_top", "lower_ball_joint"),
    ("strut_top", "strut_lower"),
    ("upper_front_link_outer", "lower_front_link_outer"),
    ("upper_rear_link_outer", "lower_rear_link_outer"),
    ("upper_front_link_inner", "lower_front_link_inner"),
    ("upper_rear_link_inner", "lower_rear_link_inner"),
    ("upper_arm_front", "lower_arm_front"),
    ("upper_arm_rear", "lower_arm_rear"),
    // The upper link is above an arm, another link, or the lower links of a solid axle.
    ("upper_link_outer", "lower_ball_joint"),
    ("upper_link_outer", "lower_joint_front"),
    ("upper_link_outer", "lower_joint_rear"),
    ("upper_link_outer", "lower_link_outer"),
    ("upper_link_inner", "lower_link_inner"),
    ("upper_link_inner", "lower_arm_front"),
    ("upper_link_inner", "lower_arm_rear"),
    ("integral_link_outer", "integral_link_inner"),
    ("upper_link_axle", "lower_link_axle"),
    ("upper_link_chassis", "lower_link_chassis"),
];

/// Pairs of hardpoints: in a suspension, the first point is forward of the second.
const BEFORE: &[(&str, &str)] = &[
    ("lower_arm_front", "lower_arm_rear"),
    ("upper_arm_front", "upper_arm_rear"),
    ("lower_front_link_inner", "lower_rear_link_inner"),
    ("upper_front_link_inner", "upper_rear_link_inner"),
    ("lower_front_link_outer", "lower_rear_link_outer"),
    ("upper_front_link_outer", "upper_rear_link_outer"),
    ("lower_joint_front", "lower_joint_rear"),
    // The wheel of a trailing arm is behind its pivots.
    ("arm_pivot", "wheel_centre"),
    ("mount", "wheel_centre"),
    ("arm_pivot_inner", "wheel_centre"),
    ("arm_pivot_outer", "wheel_centre"),
];

/// Pairs of hardpoints: in a suspension, the first point is outboard of the second.
const OUTBOARD: &[(&str, &str)] = &[
    ("lower_ball_joint", "lower_arm_front"),
    ("lower_ball_joint", "lower_arm_rear"),
    ("upper_ball_joint", "upper_arm_front"),
    ("upper_ball_joint", "upper_arm_rear"),
    ("tie_rod_outer", "tie_rod_inner"),
    ("upper_front_link_outer", "upper_front_link_inner"),
    ("upper_rear_link_outer", "upper_rear_link_inner"),
    ("lower_front_link_outer", "lower_front_link_inner"),
    ("lower_rear_link_outer", "lower_rear_link_inner"),
    ("toe_link_outer", "toe_link_inner"),
    ("arm_pivot_outer", "arm_pivot_inner"),
    ("upper_link_outer", "upper_link_inner"),
    ("lower_link_outer", "lower_link_inner"),
    ("lower_joint_front", "lower_arm_front"),
    ("lower_joint_rear", "lower_arm_rear"),
    ("wheel_centre", "spindle_inner"),
    // The wheel of a solid axle is outboard of its links.
    ("wheel_centre", "lower_link_axle"),
    ("wheel_centre", "upper_link_axle"),
    ("mount", "shear_centre"),
    ("wheel_centre", "shear_centre"),
];

/// Index of the coordinate that a direction follows, and the sign of the direction along it.
pub(crate) type Signed = (usize, f64);

/// Assignment of a coordinate and a sign to each of the directions forward, outboard and up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reading {
    pub(crate) forward: Signed,
    pub(crate) outboard: Signed,
    pub(crate) up: Signed,
}

impl Reading {
    /// All 48 readings (assignments of coordinates and signs to the directions).
    pub(crate) fn all() -> impl Iterator<Item = Reading> {
        const ORDERS: [[usize; 3]; 6] = [
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ];
        let sign = |bits: usize, bit: usize| if bits >> bit & 1 == 0 { 1.0 } else { -1.0 };
        ORDERS.into_iter().flat_map(move |[x, y, z]| {
            (0..8).map(move |bits| Reading {
                forward: (x, sign(bits, 0)),
                outboard: (y, sign(bits, 1)),
                up: (z, sign(bits, 2)),
            })
        })
    }
}

/// Directions that the points of a suspension show, as unit vectors in the coordinates of the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Directions {
    forward: Option<[f64; 3]>,
    outboard: Option<[f64; 3]>,
    up: Option<[f64; 3]>,
}

/// Result of a comparison of several readings with the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Verdict {
    /// The points show this reading.
    Clear(Reading),
    /// The points cannot distinguish this reading from another one.
    Unclear(Reading),
    /// The caller allows no reading.
    None,
}

impl Directions {
    /// Computes the directions from named points. A direction is unknown without a pair of points for it.
    pub(crate) fn of(points: &[(&str, [f64; 3])]) -> Self {
        let at = |name: &str| {
            let found = points.iter().find(|(known, _)| *known == name);
            found.map(|(_, position)| *position)
        };
        let sum = |pairs: &[(&str, &str)]| {
            let known = pairs
                .iter()
                .filter_map(|(first, second)| Some((at(first)?, at(second)?)));
            let total = known.fold([0.0; 3], |sum: [f64; 3], (first, second)| {
                std::array::from_fn(|k| sum[k] + first[k] - second[k])
            });
            unit(total)
        };
        // A rocker can put the spring in either orientation.
        let springs: &[(&str, &str)] = if at("rocker_pivot_front").is_none() {
            &[("spring_upper", "spring_lower")]
        } else {
            &[]
        };
        Directions {
            forward: sum(BEFORE),
            outboard: sum(OUTBOARD),
            up: sum(ABOVE).or_else(|| sum(springs)),
        }
    }

    /// Cosine of each direction with its coordinate in a reading. `None` if the points do not show the direction.
    fn cosines(&self, reading: &Reading) -> [Option<f64>; 3] {
        let along = |direction: Option<[f64; 3]>, (axis, sign): Signed| {
            direction.map(|direction| sign * direction[axis])
        };
        [
            along(self.forward, reading.forward),
            along(self.outboard, reading.outboard),
            along(self.up, reading.up),
        ]
    }

    /// Score of a reading: sum of the cosines between the known directions and their coordinates.
    pub(crate) fn score(&self, reading: &Reading) -> f64 {
        self.cosines(reading).into_iter().flatten().sum()
    }

    /// Compares the readings that satisfy `allowed` with the points.
    pub(crate) fn judge(&self, allowed: impl Fn(&Reading) -> bool) -> Verdict {
        let mut ranked: Vec<(f64, Reading)> = Reading::all()
            .filter(|reading| allowed(reading))
            .map(|reading| (self.score(&reading), reading))
            .collect();
        ranked.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let Some((best, reading)) = ranked.first().copied() else {
            return Verdict::None;
        };
        let leads = ranked
            .get(1)
            .is_none_or(|(second, _)| best - second >= LEAD);
        let cosines = self.cosines(&reading);
        let points_there = cosines
            .into_iter()
            .flatten()
            .all(|cosine| cosine >= LEAST_COSINE);
        if leads && points_there {
            Verdict::Clear(reading)
        } else {
            Verdict::Unclear(reading)
        }
    }

    /// Returns the best reading if the points contradict the given reading. `None` if the given reading may be right.
    pub(crate) fn contradict(&self, reading: &Reading) -> Option<Reading> {
        match self.judge(|_| true) {
            Verdict::Clear(other) if other != *reading => Some(other),
            // If one direction is unknown, the other directions may still contradict the reading.
            _ => Reading::all()
                .max_by(|a, b| self.score(a).total_cmp(&self.score(b)))
                .filter(|best| {
                    let against = self.cosines(reading).into_iter().flatten();
                    let lowest = against.fold(1.0, f64::min);
                    lowest <= -LEAST_COSINE && self.score(best) - self.score(reading) >= LEAD
                }),
        }
    }

    /// Known directions of a reading in words, as in "x points forward, y points outboard, z points up".
    pub(crate) fn describe(&self, reading: &Reading) -> String {
        let known = [self.forward, self.outboard, self.up];
        let mut words: Vec<(usize, &str)> = [
            (reading.forward, known[0], ["forward", "rearward"]),
            (reading.outboard, known[1], ["outboard", "inboard"]),
            (reading.up, known[2], ["up", "down"]),
        ]
        .into_iter()
        .filter(|(_, known, _)| known.is_some())
        .map(|((axis, sign), _, [with, against])| (axis, if sign > 0.0 { with } else { against }))
        .collect();
        words.sort_unstable();
        let words: Vec<String> = words
            .iter()
            .map(|(axis, word)| format!("{} points {word}", ["x", "y", "z"][*axis]))
            .collect();
        words.join(", ")
    }
}

/// Unit vector in the direction of `vector`. `None` if its length is not finite or is 0.
fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = vector[0].hypot(vector[1]).hypot(vector[2]);
    (length > 0.0 && length.is_finite()).then(|| vector.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Topology;
    use crate::study::Study;
    use std::path::Path;

    /// Tests every template in all 48 signed permutations of its coordinates.
    #[test]
    fn the_axes_of_every_template_are_recognised() {
        // Only single wheels are imported.
        let wheels = Topology::ALL.iter().filter(|t| !t.carries_both_wheels());
        for topology in wheels {
            let study = Study::from_text("s.toml", topology.template, Path::new(".")).unwrap();
            let suspension = study.wheel();
            let names = topology.all_hardpoints().map(|h| h.name);
            let points: Vec<_> = names
                .filter_map(|name| {
                    let id = suspension.mechanism.point(name)?;
                    Some((name, suspension.design[id.0].to_array()))
                })
                .collect();
            for reading in Reading::all() {
                let moved: Vec<_> = points
                    .iter()
                    .map(|(name, [x, y, z])| {
                        let mut moved = [0.0; 3];
                        for ((axis, sign), value) in [reading.forward, reading.outboard, reading.up]
                            .iter()
                            .zip([x, y, z])
                        {
                            moved[*axis] = sign * value;
                        }
                        (*name, moved)
                    })
                    .collect();
                let verdict = Directions::of(&moved).judge(|_| true);
                assert_eq!(verdict, Verdict::Clear(reading), "{}", topology.name);
            }
        }
    }
}

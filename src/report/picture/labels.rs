//! Positions of names on a drawing: near their points, and without overlaps.

/// Width of a small letter, and height of a line.
const LETTER: [f64; 2] = [6.6, 13.0];
/// Distances between a point and its name that are tried, nearest first.
const DISTANCES: [f64; 6] = [9.0, 18.0, 30.0, 46.0, 66.0, 90.0];
/// Number of directions from the point that are tried at each distance.
const DIRECTIONS: usize = 16;
/// Distance between point and name beyond which a line connects them.
const FAR: f64 = 12.0;
/// A name without a line is nearer to its own point than to others by at least this distance.
const CLEARLY: f64 = 3.0;

/// A name with its position.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label<'a> {
    /// Text of the name.
    pub text: &'a str,
    /// Position of the left end of the name's baseline.
    pub at: [f64; 2],
    /// Line from the point to the name. `None` if the name is beside the point and clearly belongs to it.
    pub leader: Option<Segment>,
}

/// A rectangle: left, top, right, bottom.
type Area = [f64; 4];
/// Both ends of a line.
type Segment = [[f64; 2]; 2];

/// Places names one after the other. Each name takes the position of lowest cost. A position outside the picture costs most. Then
/// follow overlaps with points and other names, a leader through another point, nearness to another point, and crossed lines. The
/// distance from the name's own point costs least. A leader (line from the point to its name) is drawn if the name is far from its
/// point or close to another point.
pub(super) fn place_labels<'a>(
    names: &[(&'a str, [f64; 2])],
    dots: &[[f64; 2]],
    segments: &[Segment],
    size: [f64; 2],
) -> Vec<Label<'a>> {
    let mut taken: Vec<Area> = Vec::new();
    let mut labels = Vec::new();
    for (text, dot) in names {
        let width = LETTER[0] * text.chars().count() as f64;
        let mut best: Option<(f64, Area, Option<Segment>)> = None;
        for area in candidates(*dot, width) {
            let is_inside = area[0] >= 4.0
                && area[2] <= size[0] - 4.0
                && area[1] >= 30.0
                && area[3] <= size[1] - 4.0;
            let names = taken.iter().map(|other| overlap(&area, other)).sum::<f64>();
            let near = |d: &&[f64; 2]| overlap(&area, &around(**d)) > 0.0;
            let points = dots.iter().filter(near).count() as f64;
            let crossed = |s: &&Segment| crosses(&area, s);
            let lines = segments.iter().filter(crossed).count() as f64;
            let away = distance(&area, *dot);
            let outside = if is_inside { 0.0 } else { 1e6 };
            let leader = leader(&area, *dot, dots);
            // A leader that passes through another point would seem to belong to that point.
            let through = |d: &&[f64; 2]| {
                apart(**d, *dot) && leader.is_some_and(|ends| crosses(&around(**d), &ends))
            };
            let through = dots.iter().filter(through).count() as f64;
            let ambiguous = f64::from(is_nearer_to_another(&area, *dot, dots));
            let cost = outside
                + 40.0 * names
                + 60.0 * points
                + 30.0 * through
                + 15.0 * ambiguous
                + 12.0 * lines
                + 0.5 * away;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, area, leader));
            }
        }
        let Some((_, area, leader)) = best else {
            continue;
        };
        taken.push(area);
        labels.push(Label {
            text,
            at: [area[0], area[3] - 3.0],
            leader,
        });
    }
    labels
}

/// Line from a point to its name. `None` if the name is beside the point and clearly belongs to it.
fn leader(area: &Area, dot: [f64; 2], dots: &[[f64; 2]]) -> Option<Segment> {
    let is_far = distance(area, dot) > FAR;
    let nearest = [
        dot[0].clamp(area[0], area[2]),
        dot[1].clamp(area[1], area[3]),
    ];
    (is_far || is_nearer_to_another(area, dot, dots)).then_some([dot, nearest])
}

/// True if another point is nearer to the name than the name's own point, or farther away by less than [`CLEARLY`].
fn is_nearer_to_another(area: &Area, dot: [f64; 2], dots: &[[f64; 2]]) -> bool {
    let own = distance(area, dot);
    let mut others = dots.iter().filter(|d| apart(**d, dot));
    others.any(|other| distance(area, *other) < own + CLEARLY)
}

/// True if two points are drawn at different positions.
fn apart(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).hypot(a[1] - b[1]) > 1.0
}

fn candidates(dot: [f64; 2], width: f64) -> impl Iterator<Item = Area> {
    let at = move |(away, step): (f64, usize)| {
        let angle = std::f64::consts::TAU * step as f64 / DIRECTIONS as f64;
        let [c, s] = [angle.cos(), angle.sin()];
        // Distance between the point and the nearest part of the name.
        let middle = [
            dot[0] + away * c + width / 2.0 * c.signum() * f64::from(c.abs() > 0.01),
            dot[1] + away * s + LETTER[1] / 2.0 * s,
        ];
        [
            middle[0] - width / 2.0,
            middle[1] - LETTER[1] / 2.0,
            middle[0] + width / 2.0,
            middle[1] + LETTER[1] / 2.0,
        ]
    };
    let steps = DISTANCES
        .into_iter()
        .flat_map(|away| (0..DIRECTIONS).map(move |step| (away, step)));
    steps.map(at)
}

fn around(dot: [f64; 2]) -> Area {
    [dot[0] - 4.0, dot[1] - 4.0, dot[0] + 4.0, dot[1] + 4.0]
}

/// Common area of two rectangles, divided by the area of a letter.
fn overlap(a: &Area, b: &Area) -> f64 {
    let width = a[2].min(b[2]) - a[0].max(b[0]);
    let height = a[3].min(b[3]) - a[1].max(b[1]);
    width.max(0.0) * height.max(0.0) / (LETTER[0] * LETTER[1])
}

fn distance(area: &Area, dot: [f64; 2]) -> f64 {
    let across = dot[0] - dot[0].clamp(area[0], area[2]);
    let along = dot[1] - dot[1].clamp(area[1], area[3]);
    across.hypot(along)
}

/// True if the segment crosses the rectangle.
fn crosses(area: &Area, [from, to]: &Segment) -> bool {
    let mut share = [0.0f64, 1.0f64];
    for k in 0..2 {
        let along = to[k] - from[k];
        if along.abs() < 1e-9 {
            if from[k] < area[k] || from[k] > area[k + 2] {
                return false;
            }
            continue;
        }
        let mut ends = [(area[k] - from[k]) / along, (area[k + 2] - from[k]) / along];
        ends.sort_by(f64::total_cmp);
        share = [share[0].max(ends[0]), share[1].min(ends[1])];
    }
    share[0] <= share[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Labels of points in a ring, like the joints of a wheel carrier.
    #[test]
    fn names_do_not_overlap() {
        let place = |k: usize| {
            let angle = k as f64 * 0.7;
            [280.0 + 60.0 * angle.cos(), 280.0 + 60.0 * angle.sin()]
        };
        let dots: Vec<[f64; 2]> = (0..9).map(place).collect();
        let names: Vec<(&str, [f64; 2])> = dots.iter().map(|d| ("upper_front_link", *d)).collect();
        let labels = place_labels(&names, &dots, &[], [560.0, 560.0]);
        let area = |label: &Label| {
            let [left, base] = label.at;
            let width = LETTER[0] * label.text.len() as f64;
            [left, base + 3.0 - LETTER[1], left + width, base + 3.0]
        };
        for (k, label) in labels.iter().enumerate() {
            let [left, top, right, bottom] = area(label);
            assert!(left >= 0.0 && top >= 0.0 && right <= 560.0 && bottom <= 560.0);
            for other in &labels[..k] {
                assert_eq!(
                    overlap(&area(label), &area(other)),
                    0.0,
                    "{label:?} {other:?}"
                );
            }
        }
    }

    #[test]
    fn a_line_through_a_rectangle_crosses_it() {
        let area = [0.0, 0.0, 10.0, 4.0];
        assert!(crosses(&area, &[[-5.0, 2.0], [15.0, 2.0]]));
        assert!(crosses(&area, &[[5.0, 1.0], [6.0, 3.0]]));
        assert!(!crosses(&area, &[[-5.0, 5.0], [15.0, 5.0]]));
        assert!(!crosses(&area, &[[11.0, -5.0], [20.0, 9.0]]));
    }

    /// Points may be so close together that every free position for a name is near another point. Then a line leads from the
    /// name to its own point.
    #[test]
    fn a_name_near_another_point_has_a_line() {
        let dots = [
            [280.0, 280.0],
            [286.0, 286.0],
            [274.0, 286.0],
            [280.0, 292.0],
        ];
        let names: Vec<(&str, [f64; 2])> = dots.iter().map(|d| ("tie_rod_outer", *d)).collect();
        let labels = place_labels(&names, &dots, &[], [560.0, 560.0]);
        for (label, (_, dot)) in labels.iter().zip(&names) {
            let width = LETTER[0] * label.text.len() as f64;
            let [left, base] = label.at;
            let area = [left, base + 3.0 - LETTER[1], left + width, base + 3.0];
            let nearer = dots.iter().any(|other| {
                apart(*other, *dot) && distance(&area, *other) < distance(&area, *dot)
            });
            assert!(!nearer || label.leader.is_some_and(|[from, _]| from == *dot));
        }
        // The name of a single point is directly beside the point.
        assert_eq!(
            place_labels(&names[..1], &dots[..1], &[], [560.0, 560.0])[0].leader,
            None
        );
    }
}

//! Slips in a table of points: one coordinate with the wrong sign or the decimal point in the wrong position.

/// A coordinate with a probable typing error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slip {
    /// Index of the point in the table.
    pub(crate) point: usize,
    /// Index of the coordinate in the point: 0 to 2.
    pub(crate) axis: usize,
    /// Value of the coordinate that fits the other points.
    pub(crate) likely: f64,
    /// True for a wrong sign, false for a wrong decimal place.
    pub(crate) is_sign: bool,
}

impl Slip {
    /// Finds the coordinate whose correction removes all warnings. `fits` returns true if points cause no warning. A correction
    /// changes the sign or the decimal place of one coordinate. It must bring the point much nearer to the mean of the others.
    /// Corrections of the sign have priority, because they keep all digits. Returns `None` without a correction. Also returns
    /// `None` if corrections of different points remain, because then any of these points may be wrong.
    pub(crate) fn of(points: &[[f64; 3]], fits: impl Fn(&[[f64; 3]]) -> bool) -> Option<Slip> {
        const NEARER: f64 = 0.75;
        let mut found: Vec<(f64, Slip)> = Vec::new();
        for (point, at) in points.iter().enumerate() {
            let before = away(points, point);
            for (axis, now) in at.iter().copied().enumerate() {
                let changes = [
                    (-now, true),
                    (shifted(now, -1), false),
                    (shifted(now, 1), false),
                ];
                for (likely, is_sign) in changes {
                    let mut changed = points.to_vec();
                    changed[point][axis] = likely;
                    let distance = away(&changed, point);
                    if distance < NEARER * before && fits(&changed) {
                        let slip = Slip {
                            point,
                            axis,
                            likely,
                            is_sign,
                        };
                        found.push((distance, slip));
                    }
                }
            }
        }
        let has_sign = found.iter().any(|(_, slip)| slip.is_sign);
        found.retain(|(_, slip)| slip.is_sign || !has_sign);
        let nearest = found.iter().min_by(|(a, _), (b, _)| a.total_cmp(b));
        let (_, slip) = *nearest?;
        let is_only_one = found.iter().all(|(_, other)| other.point == slip.point);
        is_only_one.then_some(slip)
    }

    /// Describes the slip: `y = 22.52 instead of -22.52 (a wrong sign)`. `now` is the coordinate as written, and `likely` its
    /// likely value in the same axes.
    pub(crate) fn describe(&self, now: f64, likely: f64) -> String {
        let kind = if self.is_sign {
            "a wrong sign"
        } else {
            "a wrong decimal place"
        };
        let axis = ["x", "y", "z"][self.axis];
        format!("{axis} = {likely} instead of {now} ({kind})")
    }
}

/// Finite number with its decimal point moved by `places` to the right. The digits stay exactly the same. A multiplication by 10
/// could change them, because it is rounded.
fn shifted(number: f64, places: i32) -> f64 {
    let text = format!("{number:e}");
    let (digits, exponent) = text.split_once('e').expect("scientific notation");
    let exponent: i32 = exponent.parse().expect("an integer");
    format!("{digits}e{}", exponent + places)
        .parse()
        .expect("a number")
}

/// Distance of a point from the mean of the others.
fn away(points: &[[f64; 3]], point: usize) -> f64 {
    let others = points.iter().enumerate().filter(|(k, _)| *k != point);
    let count = (points.len() - 1) as f64;
    let mean = others.fold([0.0; 3], |sum: [f64; 3], (_, other)| {
        std::array::from_fn(|k| sum[k] + other[k] / count)
    });
    let [x, y, z] = std::array::from_fn(|k| points[point][k] - mean[k]);
    f64::hypot(x, y).hypot(z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A moved decimal point keeps the digits.
    #[test]
    fn a_moved_decimal_point_keeps_the_digits() {
        for (number, places, expected) in [
            (-0.4528, 1, -4.528),
            (-0.748, 1, -7.48),
            (-49.21, -1, -4.921),
            (120.0, -1, 12.0),
            (0.0, 1, 0.0),
        ] {
            assert_eq!(shifted(number, places), expected);
        }
    }

    /// For points in a box: one wrong coordinate outside the box is found. Two points outside the box are not one slip, so the
    /// result is `None`.
    #[test]
    fn one_coordinate_far_outside_is_a_slip() {
        let sound = [
            [1.0, 5.0, 2.0],
            [-1.0, 5.0, 2.5],
            [0.5, 8.0, 3.0],
            [-0.5, 8.5, 1.5],
        ];
        let fits = |points: &[[f64; 3]]| {
            let inside = |p: &[f64; 3]| (4.0..9.0).contains(&p[1]) && p[2].abs() < 4.0;
            points.iter().all(inside)
        };
        for (point, axis, wrong, is_sign) in
            [(2, 1, -8.0, true), (0, 2, 20.0, false), (1, 2, 25.0, false)]
        {
            let mut points = sound;
            points[point][axis] = wrong;
            let slip = Slip::of(&points, fits);
            let expected = Slip {
                point,
                axis,
                likely: sound[point][axis],
                is_sign,
            };
            assert_eq!(slip, Some(expected));
        }
        let mut two = sound;
        (two[2][1], two[3][1]) = (-8.0, -8.5);
        assert_eq!(Slip::of(&two, fits), None);
    }
}

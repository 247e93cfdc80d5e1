//! Axes of a file and side of its wheel. They come from the user and the file, or else from the points.
//!
//! | axes given | side given | result |
//! |---|---|---|
//! | yes | yes | the points must not contradict the axes or the side; `--side` mirrors points without a side if they show the other wheel |
//! | yes | no | the side follows from the points, or left is assumed |
//! | no | yes | the axes follow from the points, if they are right-handed |
//! | no | no | the left wheel is assumed, and the axes follow from the points as above |
//!
//! The last row assumes a side because the same points could also be a right wheel in left-handed axes. Left-handed axes are
//! refused unless `--axes` gives them. If the points do not show the axes clearly (see [`crate::report`]'s `orientation`), the
//! importer asks.

use super::ImportOptions;
use super::axes::{Axes, of_reading, reading_of};
use super::corner::Picked;
use super::notes::Notes;
use super::refusal::{Question, Refusal};
use super::table::PointTable;
use crate::model::Side;
use crate::report::{Directions, Reading, Verdict};

/// Axes and side of the points in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub axes: Axes,
    /// Side of the wheel whose points show the axes.
    pub side: Side,
}

/// Returns the side of the wheel whose points show the axes, and these points by name. The side is `None` if the file states no
/// side.
fn evidence(picked: &[Picked], wanted: Option<Side>) -> (Option<Side>, Vec<(&str, [f64; 3])>) {
    let has = |side: Side| picked.iter().any(|p| p.origin == Some(side));
    let origin = match wanted {
        Some(side) if has(side) => Some(side),
        _ => Side::ALL.into_iter().find(|side| has(*side)),
    };
    let of = picked
        .iter()
        .filter(|p| p.origin.is_none() || p.origin == origin);
    let points = of.map(|p| (p.hardpoint.name, p.hardpoint.position));
    (origin, points.collect())
}

/// Finds the axes of the file and the side of the wheel.
pub(super) fn place(
    table: &PointTable,
    options: &ImportOptions<'_>,
    wanted: Option<Side>,
    picked: &[Picked],
    notes: &mut Notes,
) -> Result<Placed, Refusal> {
    let (origin, points) = evidence(picked, wanted);
    let side = origin.or(wanted);
    let directions = Directions::of(&points);
    let flag = options.axes.or(options.frame.map(Axes::of));
    if let Some(axes) = flag.or(table.declared.axes()) {
        let by_user = flag.is_some();
        let is_asked = origin.is_none() && options.side.is_some();
        return stated(axes, by_user, (side, is_asked), &directions, options, notes);
    }
    found(table, side, &directions, notes)
}

/// Uses axes that the user or the file states. `is_asked` is true if the user requests the wheel `side`, and the points in the
/// file have no side. If these points show the other wheel, [`mirror`] makes the requested wheel from them.
fn stated(
    axes: Axes,
    by_user: bool,
    (side, is_asked): (Option<Side>, bool),
    directions: &Directions,
    options: &ImportOptions<'_>,
    notes: &mut Notes,
) -> Result<Placed, Refusal> {
    if !axes.is_right_handed() && options.axes.is_none() {
        return Err(left_handed(
            format!("the axes of the file ({axes}) are left-handed"),
            vec![("--axes", axes.to_string())],
        ));
    }
    let score = |side: Side| directions.score(&reading_of(axes, side));
    let [left, right] = Side::ALL.map(score);
    let shown = if left > right + 0.5 {
        Some(Side::Left)
    } else if right > left + 0.5 {
        Some(Side::Right)
    } else {
        None
    };
    let side = if is_asked { shown.or(side) } else { side };
    if let (Some(stated), Some(shown)) = (side, shown)
        && stated != shown
    {
        let frame = axes
            .convention()
            .map_or(axes.to_string(), |frame| frame.name().to_owned());
        return Err(Refusal::Wrong(format!(
            "in these coordinates {}: in {frame} this is not the {} wheel. With these axes use \
             --side {}",
            directions.describe(&reading_of(axes, shown)),
            stated.name(),
            shown.name()
        )));
    }
    let placed = Placed {
        axes,
        side: side.or(shown).unwrap_or(Side::Left),
    };
    if side.is_none() {
        notes.push(format!(
            "wheel: {}, since {}",
            placed.side.name(),
            match shown {
                Some(_) => "its points are on that side of the body",
                None => "neither the file nor its points show the side",
            }
        ));
    }
    let reading = reading_of(axes, placed.side);
    if let Some(other) = directions.contradict(&reading) {
        let shown = directions.describe(&other);
        if !by_user {
            return Err(open_axes(
                format!("the file states that x, y and z point {axes}, but in its points {shown}"),
                Some(shown_axes(&other, side)),
            ));
        }
        notes.doubt(format!(
            "please check: in the points {shown}, but the stated axes x, y and z point {axes}"
        ));
    }
    Ok(placed)
}

/// Finds the axes from the points, if the file does not state them.
fn found(
    table: &PointTable,
    side: Option<Side>,
    directions: &Directions,
    notes: &mut Notes,
) -> Result<Placed, Refusal> {
    let wheel = side.unwrap_or(Side::Left);
    let declared = table.declared;
    let allowed = |reading: &_| declared.allows(of_reading(reading, wheel));
    let reading = match directions.judge(allowed) {
        Verdict::Clear(reading) => reading,
        Verdict::Unclear(best) => {
            return Err(open_axes(
                "neither the file nor its points show the directions of x, y and z".to_owned(),
                Some(of_reading(&best, wheel)).filter(|axes| axes.is_right_handed()),
            ));
        }
        Verdict::None => {
            let likely = match directions.judge(|_| true) {
                Verdict::Clear(reading) => Some(shown_axes(&reading, side)),
                Verdict::Unclear(_) | Verdict::None => None,
            };
            let reason = "the headers give two coordinates the same axis";
            return Err(open_axes(reason.to_owned(), likely));
        }
    };
    let placed = Placed {
        axes: of_reading(&reading, wheel),
        side: wheel,
    };
    // Without this check, a header that contradicts the points would be ignored.
    if !declared.is_empty()
        && let Some(other) = directions.contradict(&reading)
    {
        return Err(open_axes(
            format!(
                "the headers contradict the points, in which {}",
                directions.describe(&other)
            ),
            Some(shown_axes(&other, side)),
        ));
    }
    let shown = directions.describe(&reading);
    if !placed.axes.is_right_handed() {
        let other = wheel.other();
        let known = match side {
            Some(_) => String::new(),
            None => " (no side is given, so left is assumed)".to_owned(),
        };
        return Err(left_handed(
            format!(
                "in these coordinates {shown}; for a {} wheel{known} these axes are left-handed: {}",
                wheel.name(),
                placed.axes
            ),
            vec![
                ("--side", other.name().to_owned()),
                ("--axes", placed.axes.to_string()),
            ],
        ));
    }
    let assumed = if side.is_none() {
        " (assumed: the file states no side)"
    } else {
        ""
    };
    let name = placed
        .axes
        .convention()
        .map_or(placed.axes.to_string(), |frame| frame.name().to_owned());
    notes.push(format!(
        "axes: {name}, {} wheel{assumed}; {shown} (deduced from the points; change with --axes, --side)",
        placed.side.name()
    ));
    Ok(placed)
}

fn left_handed(reason: String, choices: Vec<(&'static str, String)>) -> Refusal {
    Refusal::Open(Question {
        reason,
        choices,
        free: None,
    })
}

/// Axes that the points show. If the side of the wheel is not known, the function takes the side with right-handed axes.
fn shown_axes(reading: &Reading, side: Option<Side>) -> Axes {
    let axes = of_reading(reading, side.unwrap_or(Side::Left));
    if side.is_none() && !axes.is_right_handed() {
        return of_reading(reading, Side::Right);
    }
    axes
}

/// Question about the axes, with the most likely answer.
fn open_axes(reason: String, likely: Option<Axes>) -> Refusal {
    let choices = likely.map(|axes| ("--axes", axes.to_string()));
    Refusal::Open(Question {
        reason,
        choices: choices.into_iter().collect(),
        free: Some((
            "--axes",
            "X,Y,Z, the directions of x, y and z, each forward, rearward, left, right, up or down",
        )),
    })
}

/// Mirrors points of the other wheel across the centre plane of the car.
pub(super) fn mirror(
    placed: &mut Placed,
    wanted: Option<Side>,
    picked: &mut [Picked],
    notes: &mut Notes,
) {
    let wheel = wanted.unwrap_or(placed.side);
    let (across, _) = placed.axes.across();
    let mut names = Vec::new();
    for point in picked.iter_mut() {
        // A point without a side belongs to the wheel that shows the axes.
        if point.origin.unwrap_or(placed.side) == wheel {
            continue;
        }
        let coordinate = &mut point.hardpoint.position[across];
        *coordinate = 0.0 - *coordinate;
        names.push(point.hardpoint.name);
    }
    placed.side = wheel;
    if !names.is_empty() {
        let all = if names.len() == picked.len() {
            "all points".to_owned()
        } else {
            names.join(", ")
        };
        notes.push(format!(
            "points taken from the {} wheel and mirrored: {all}",
            wheel.other().name()
        ));
    }
}

/// Moves the points outboard by the half track if the file's origin is at the wheel. In such a file the wheel centre or the
/// contact point is at y = 0. The points of the body are then on the other side of the centre plane. `asked` is true if a flag
/// gives the half track. `compare` is true if a half track of the file is compared with the points.
pub(super) fn to_half_track(
    placed: Placed,
    half_track: Option<f64>,
    (asked, compare): (bool, bool),
    picked: &mut [Picked],
    notes: &mut Notes,
) -> Result<(), Refusal> {
    let (across, left) = placed.axes.across();
    let outward = left * placed.side.sign();
    let of = |p: &Picked| outward * p.hardpoint.position[across];
    let Some(wheel) = picked.iter().find(|p| p.hardpoint.name == "wheel_centre") else {
        return Ok(());
    };
    let wheel = of(wheel);
    let is_inner = |p: &&Picked| {
        let name = p.hardpoint.name;
        name.ends_with("_inner") && name != "spindle_inner"
            || name.starts_with("lower_arm_")
            || name.starts_with("upper_arm_")
            || name.starts_with("arm_pivot_")
    };
    let inner: Vec<f64> = picked.iter().filter(is_inner).map(of).collect();
    if inner.is_empty() {
        return Ok(());
    }
    let reach = wheel - inner.iter().sum::<f64>() / inner.len() as f64;
    if wheel >= 0.5 * reach {
        if asked
            && let Some(half_track) = half_track
            && (half_track - wheel).abs() > 1e-3 * wheel
        {
            return Err(Refusal::Wrong(format!(
                "--half-track {half_track}: the wheel centre is {wheel} from the centre plane already; leave the \
                 flag out or move the points"
            )));
        }
        if let Some(half_track) = half_track.filter(|_| compare)
            && (half_track - wheel).abs() > 1e-3 * wheel
        {
            notes.doubt(format!(
                "please check: the half track of the file is {half_track}, but its wheel centre is {wheel} from the centre \
                 plane; the study uses the points"
            ));
        }
        return Ok(());
    }
    let Some(half_track) = half_track else {
        return Err(Refusal::Open(Question {
            reason: format!(
                "the wheel centre is {wheel} from the centre plane, and the points of the body \
                 are beyond the centre plane: the file has its origin at the wheel and gives no \
                 half track"
            ),
            choices: Vec::new(),
            free: Some(("--half-track", "LENGTH in the file's unit")),
        }));
    };
    if half_track <= 0.0 {
        return Err(Refusal::Wrong(format!(
            "the half track is {half_track}; expected a length above 0"
        )));
    }
    let shift = outward * (half_track - wheel);
    for point in picked.iter_mut() {
        point.hardpoint.position[across] += shift;
    }
    notes.push(format!(
        "half track: the file has its origin at the wheel; all points are moved {} outward, so \
         that the wheel centre is {half_track} from the centre plane",
        half_track - wheel
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::Hardpoint;
    use crate::model::{FrameConvention, LengthUnit, Topology};
    use std::collections::BTreeMap;

    fn picked(name: &'static str, y: f64) -> Picked {
        Picked {
            hardpoint: Hardpoint {
                name,
                position: [0.5, y, 0.25],
                called: name.to_owned(),
                place: "row 1".to_owned(),
                body: None,
                named_body: None,
            },
            origin: None,
        }
    }

    /// The points show the side of the wheel if the arms point outward with a cosine above 0.25. Otherwise the left side
    /// is assumed.
    #[test]
    fn a_side_is_shown_by_a_quarter() {
        let none = BTreeMap::new();
        let options = ImportOptions {
            topology: Topology::ALL[0],
            unit: Some(LengthUnit::Metre.into()),
            frame: None,
            axes: None,
            side: None,
            axle: None,
            half_track: None,
            radius: None,
            bushings: false,
            names: &none,
            bodies: &none,
        };
        let axes = Axes::of(FrameConvention::Iso8855);
        for (cosine, side, is_shown) in [
            (0.2501, Side::Left, true),
            (0.2499, Side::Left, false),
            (-0.2499, Side::Left, false),
            (-0.2501, Side::Right, true),
        ] {
            let outer = [-f64::sqrt(1.0 - cosine * cosine), cosine, 0.0];
            let points = [("lower_ball_joint", outer), ("lower_arm_front", [0.0; 3])];
            let mut notes = Notes::default();
            let directions = Directions::of(&points);
            let unknown = (None, false);
            let placed = stated(axes, true, unknown, &directions, &options, &mut notes).unwrap();
            assert_eq!(placed.side, side, "{cosine}");
            let shown = notes
                .texts()
                .any(|note| note.contains("on that side of the body"));
            assert_eq!(shown, is_shown, "{cosine}: {notes:?}");
            // A stated side is refused only if the points show the other side.
            for wheel in Side::ALL {
                let of_file = (Some(wheel), false);
                let placed = stated(axes, true, of_file, &directions, &options, &mut notes);
                assert_eq!(placed.is_ok(), !is_shown || wheel == side, "{cosine}");
                // The importer makes a requested wheel as the mirror image of the wheel that the points show.
                let asked = (Some(wheel), true);
                let placed = stated(axes, true, asked, &directions, &options, &mut notes);
                assert_eq!(placed.unwrap().side, if is_shown { side } else { wheel });
            }
        }
    }

    /// Reach is the lateral distance between the wheel centre and the arms' inner ends. If the wheel centre is nearer to
    /// the centre plane than half of this reach, the origin is at the wheel. The importer then moves the points outward
    /// by the half track. This applies to left and right wheels.
    #[test]
    fn wheels_at_the_origin_are_moved_out() {
        let moved = |side: Side, wheel: f64, inner: f64, half_track: Option<f64>, asked: bool| {
            let axes = Axes::of(FrameConvention::Iso8855);
            let outward = side.sign();
            let mut points = vec![
                picked("wheel_centre", outward * wheel),
                picked("lower_arm_front", outward * inner),
                picked("tie_rod_outer", outward * 7.0),
            ];
            let placed = Placed { axes, side };
            let mut notes = Notes::default();
            to_half_track(placed, half_track, (asked, false), &mut points, &mut notes)?;
            let along = |p: &Picked| outward * p.hardpoint.position[1];
            assert_eq!(
                notes.texts().count(),
                usize::from(along(&points[0]) != wheel)
            );
            Ok::<Vec<f64>, Refusal>(points.iter().map(along).collect())
        };
        for side in Side::ALL {
            assert_eq!(
                moved(side, 1.0, -1.0, None, false).unwrap(),
                [1.0, -1.0, 7.0]
            );
            let open = moved(side, 0.9995, -1.0005, None, false);
            assert!(matches!(open, Err(Refusal::Open(_))));
            let found = moved(side, 0.0, -0.5, Some(0.75), true).unwrap();
            assert_eq!(found, [0.75, 0.25, 7.75]);
            for half_track in [0.0, -1.0] {
                let wrong = moved(side, 0.0, -0.5, Some(half_track), true);
                assert!(matches!(wrong, Err(Refusal::Wrong(_))));
            }
            // A half track is refused if the file contradicts it by more than a thousandth.
            assert!(moved(side, 1000.0, 500.0, Some(1000.999), true).is_ok());
            assert!(moved(side, 1000.0, 500.0, Some(1001.0005), true).is_err());
            assert!(moved(side, 1000.0, 500.0, Some(1001.0005), false).is_ok());
        }
    }
}

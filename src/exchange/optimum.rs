//! OptimumKinematics: data in its tables that are not hardpoints. The layout is known from public readers of its workbooks, not
//! from the program itself.
//!
//! A table gives the wheel by half track, offsets and tyre diameter at the contact point. R is the loaded radius (half the
//! diameter), c the static camber, t the toe-in. The offsets are dx forward, dy outboard and dz up. Then the wheel centre of the
//! left wheel is
//!
//! ```text
//! (dx, half track + dy, dz) + R (sin c sin t, sin c cos t, cos c)
//! ```
//!
//! The axis of the anti-roll bar (U-bar) runs through `CHAS_PivPnt` of both wheels. A rod is a pullrod if its end at the
//! wheel is higher than the other end.

use super::Hardpoint;
use super::axes::Axes;
use super::corner::{Corner, Named, Picked, of_other_wheel};
use super::figures::Figures;
use super::notes::Notes;
use super::place::Placed;
use crate::model::{Side, Topology};

/// Adds the inner point of the axis of the U-bar (anti-roll bar): the pivot of this bar at the other wheel.
pub(super) fn bar_axis(named: &[Named<'_>], corner: Corner, picked: &mut Vec<Picked>) {
    let has = |name: &str| picked.iter().any(|p| p.hardpoint.name == name);
    if !has("anti_roll_bar_outer") || has("anti_roll_bar_inner") {
        return;
    }
    let Some(position) = of_other_wheel("anti_roll_bar_outer", named, corner) else {
        return;
    };
    let outer = picked
        .iter()
        .find(|p| p.hardpoint.name == "anti_roll_bar_outer");
    let outer = outer.expect("anti_roll_bar_outer is present").clone();
    picked.push(Picked {
        hardpoint: Hardpoint {
            name: "anti_roll_bar_inner",
            position,
            called: format!("{} of the other wheel", outer.hardpoint.called),
            ..outer.hardpoint
        },
        origin: outer.origin,
    });
}

/// Assigns the front and the rear point of the rocker's axis according to their positions. Changes a rod to a pullrod if
/// its end at the wheel is above its end at the rocker.
pub(super) fn rod(topology: &Topology, axes: Axes, picked: &mut [Picked], notes: &mut Notes) {
    let along = |picked: &[Picked], name: &str| {
        let found = picked.iter().find(|p| p.hardpoint.name == name)?;
        Some(axes.to_iso(found.hardpoint.position)[0])
    };
    let [front, rear] = ["rocker_pivot_front", "rocker_pivot_rear"].map(|name| along(picked, name));
    if front.zip(rear).is_some_and(|(front, rear)| front < rear) {
        for point in picked.iter_mut() {
            match point.hardpoint.name {
                "rocker_pivot_front" => point.hardpoint.name = "rocker_pivot_rear",
                "rocker_pivot_rear" => point.hardpoint.name = "rocker_pivot_front",
                _ => (),
            }
        }
    }
    let height = |name: &str| {
        let found = picked.iter().find(|p| p.hardpoint.name == name)?;
        Some(axes.to_iso(found.hardpoint.position)[2])
    };
    let (Some(outer), Some(inner)) = (height("pushrod_outer"), height("pushrod_inner")) else {
        return;
    };
    if outer <= inner || topology.hardpoint("pullrod_outer").is_none() {
        return;
    }
    for point in picked {
        match point.hardpoint.name {
            "pushrod_outer" => point.hardpoint.name = "pullrod_outer",
            "pushrod_inner" => point.hardpoint.name = "pullrod_inner",
            _ => (),
        }
    }
    notes.push(
        "rod: a pullrod, because its end at the wheel is above its end at the rocker".to_owned(),
    );
}

/// Computes the wheel centre from the contact point. `None` without a half track or a wheel radius. A missing camber or toe counts
/// as 0.
pub(super) fn wheel_centre(placed: Placed, figures: &Figures, notes: &mut Notes) -> Option<Picked> {
    let half_track = figures.half_track()?.abs();
    let radius = figures.radius()?;
    let camber = figures.camber.unwrap_or(0.0).to_radians();
    let toe = figures.toe.unwrap_or(0.0).to_radians();
    let [forward, outboard, up] = figures.offset;
    let left = [
        forward + radius * (camber.sin() * toe.sin()),
        half_track + outboard + radius * (camber.sin() * toe.cos()),
        up + radius * camber.cos(),
    ];
    let [x, y, z] = left;
    let iso = match placed.side {
        Side::Left => [x, y, z],
        Side::Right => [x, -y, z],
    };
    notes.push(format!(
        "wheel_centre: from half track {half_track} at the contact point, radius {radius}, camber and toe"
    ));
    Some(Picked {
        hardpoint: Hardpoint {
            name: "wheel_centre",
            position: placed.axes.iso_in_file(iso),
            called: "half track and tyre diameter".to_owned(),
            place: "the data of the wheel".to_owned(),
            body: None,
            named_body: None,
        },
        origin: Some(placed.side),
    })
}

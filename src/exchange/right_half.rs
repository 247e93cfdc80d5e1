//! Right half of an imported solid axle or twist beam, and points of the other wheel that an import omits.

use super::Hardpoint;
use super::axes::Axes;
use super::corner::{self, Corner, Named, Picked};
use super::refusal::Refusal;
use crate::model::{LengthUnit, Side, Topology};
use crate::report::brief;

/// Returns the hardpoints that the file gives for the right half, without exact mirror images of the left half. `left` is the left
/// half in the axes of the file.
pub(super) fn own(
    topology: &'static Topology,
    named: &[Named<'_>],
    corner: Corner,
    axes: Axes,
    left: &[Hardpoint],
    left_out: &mut Vec<String>,
) -> Result<Vec<Hardpoint>, Refusal> {
    let names: Vec<&'static str> = left.iter().map(|h| h.name).collect();
    let mechanism = (topology.build)(topology, &names);
    let is_paired = |name: &str| {
        let rigid = mechanism.rigid_axle.as_ref();
        let id = mechanism.point(name);
        rigid
            .zip(id)
            .is_some_and(|(rigid, id)| rigid.far_of(id).is_some())
    };
    let right = Corner {
        side: Some(Side::Right),
        ..corner
    };
    let (across, _) = axes.across();
    let mut found = Vec::new();
    let mut single = Vec::new();
    for near in left {
        let Some(far) = corner::pick(near.name, named, right)? else {
            continue;
        };
        // Skips a point if the file has no row for its right side, or if this row has already given the point of the left half.
        if far.origin != Some(Side::Right) || far.hardpoint.place == near.place {
            continue;
        }
        let mirrored = mirrored(far.hardpoint.position, across);
        if !is_paired(near.name) {
            single.push(near.name);
        } else if mirrored != near.position {
            found.push(far.hardpoint);
        }
    }
    if !single.is_empty() {
        left_out.push(format!(
            "rows of the right half ({}): this axle has only one point of each name, and the study uses the left row",
            single.join(", ")
        ));
    }
    Ok(found)
}

/// Describes the points of the other wheel that differ from the mirror images of the imported wheel's points. `None` if the file
/// has no other wheel, or mirror images within rounding errors. `picked` are the points as written in the file, and `unit` is their
/// unit.
pub(super) fn differs(
    named: &[Named<'_>],
    corner: Corner,
    (axes, unit): (Axes, LengthUnit),
    picked: &[Picked],
) -> Option<String> {
    let (across, _) = axes.across();
    let mut names = Vec::new();
    let mut most = 0.0_f64;
    let mut omitted = None;
    for near in picked {
        let Some(other) = near.origin.map(Side::other) else {
            continue;
        };
        let side = Some(other);
        let far = corner::pick(near.hardpoint.name, named, Corner { side, ..corner });
        let Ok(Some(far)) = far else { continue };
        if far.origin != side {
            continue;
        }
        let mirrored = mirrored(far.hardpoint.position, across);
        let pairs = mirrored.iter().zip(near.hardpoint.position);
        let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = mirrored.iter().map(|c| c.abs()).fold(0.0, f64::max);
        // Deviations up to this fraction of the largest coordinate are rounding errors from conversions of units.
        if apart > 1e-9 * size {
            names.push(near.hardpoint.name);
            most = most.max(apart);
            omitted = side;
        }
    }
    let omitted = omitted?;
    Some(format!(
        "points of the {0} wheel that are up to {2} {3} away from the mirror images of the imported wheel: {1}. --side {0} imports that wheel",
        omitted.name(),
        names.join(", "),
        brief(most),
        unit.symbol()
    ))
}

/// Mirror image of a position. `across` is the index of the lateral coordinate.
fn mirrored(mut position: [f64; 3], across: usize) -> [f64; 3] {
    position[across] = 0.0 - position[across];
    position
}

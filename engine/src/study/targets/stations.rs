//! Stations of targets in a motion.

use super::super::drive_rounding::{DriveRounding, ends, ends_of_curve};
use super::super::{Limit, Motion, Site, Wanted};
use crate::sorting::sort_numbers;

/// Rack displacements at which a target applies.
pub(super) fn rack_displacements(site: &Site, motion: &Motion) -> Vec<f64> {
    match site.racks.as_slice() {
        [] => vec![motion.design_rack()],
        racks => racks.to_vec(),
    }
}

/// Stations to add to the stations of the motion, so that they represent a target or limit curve. They are needed if the motion has
/// fewer stations within the curve than the curve has points within the motion. The added stations are these points of the
/// curve.
pub(super) fn added_stations(wanted: &Wanted, motion: &Motion) -> Vec<f64> {
    let values = &motion.values;
    let rounding = DriveRounding::of(values);
    let curves: Vec<&[[f64; 2]]> = match wanted {
        Wanted::Curve { points, .. } => vec![points],
        Wanted::Band {
            at: None,
            lower,
            upper,
        } => {
            let limits = [lower, upper].into_iter().flatten();
            let curves = limits.filter_map(|limit| match limit {
                Limit::Value(_) => None,
                Limit::Curve { points, .. } => Some(points.as_slice()),
            });
            curves.collect()
        }
        _ => Vec::new(),
    };
    let mut added = Vec::new();
    for points in curves {
        let on_curve = ends_of_curve(points);
        let own = values.iter();
        let own = own.filter(|v| rounding.is_within(**v, on_curve)).count();
        let knots = points.iter().map(|p| p[0]);
        let knots = knots.filter(|k| rounding.is_within(*k, ends(values)));
        let knots: Vec<f64> = knots.collect();
        if own < knots.len() {
            let knots = knots.into_iter();
            added.extend(knots.filter(|k| !rounding.is_among(*k, values)));
        }
    }
    sort_numbers(&mut added);
    added.dedup();
    added
}

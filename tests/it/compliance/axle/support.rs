//! Support for tests of studies of axles with elastic parts.

use crate::compliance::support::{elastic, fourth_order, with};
use hardpoint::axle::{AxleCurves, axle_curves};
use hardpoint::curves::Curves;
use hardpoint::study::Study;

pub const SUBFRAME: &str = "subframe_axle_compliance.toml";

/// Text of the subframe study with the motion `motion`. Hardpoints and rates of the right wheel differ from the
/// left wheel.
pub fn asymmetric(motion: &str, more: &str) -> String {
    let text = with(SUBFRAME, more);
    let own = "[axle.right.hardpoints]\ntie_rod_outer = [-143.0, -683.0, 231.0]\nlower_arm_rear = [-196.0, -372.0, 201.0]\n\
               [axle.right.bushings.lower_arm_rear]\nstiffness = [900.0, 2100.0, 1700.0, 8.0e4, 2.5e5, 2.5e5]\n\
               [axle.right.bushings.upper_arm_rear]\nscale = [1.2, 1.1, 1.0, 1.0, 1.0, 1.0]\n";
    replaced(
        &replaced(
            &text,
            "heave = { from = -30.0, to = 30.0, steps = 3 }",
            motion,
        ),
        "[axle]\nright = \"mirrored\"\n",
        &format!("[axle]\n{own}"),
    )
}

pub fn replaced(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

pub fn curves(study: &Study) -> Curves {
    let both = study.axle().unwrap();
    let AxleCurves { curves, .. } = axle_curves(&both.axle, &both.plan).unwrap();
    assert!(curves.are_complete());
    curves
}

/// Values of a station as printed, by column name.
pub fn values(text: &str, station: usize) -> Vec<(String, f64)> {
    let curves = curves(&elastic(text));
    let columns = curves.columns.iter().enumerate();
    let value = |k: usize| curves.stations[station].value(k).unwrap();
    columns
        .map(|(k, column)| (column.name.clone(), value(k)))
        .collect()
}

pub fn value_of(values: &[(String, f64)], name: &str) -> f64 {
    let found = values.iter().find(|(known, _)| known == name);
    found.unwrap_or_else(|| panic!("{name} in {values:?}")).1
}

/// Derivative from finite differences of fourth order.
pub fn difference(step: f64, at: impl Fn(f64) -> f64) -> f64 {
    fourth_order([-2.0, -1.0, 1.0, 2.0].map(|steps| at(steps * step)), step)
}

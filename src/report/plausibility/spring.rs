//! Warning about a spring that reverses its direction within the motion of its wheel.

use crate::characteristics::Characteristic;
use crate::curves::{Curves, curves};
use crate::model::Suspension;
use crate::plan::Plan;
use crate::report::figure::brief;
use crate::solve::StationOrder;
use crate::study::{AxleStudy, Outputs, Study, WheelStudy};

/// Number of travels, in bump and in rebound, at which the motion ratio is computed.
const PLACES: u32 = 64;

/// Warnings about springs whose motion ratio changes its sign within the travel of these curves, one per line. Beyond the
/// travel at which the sign changes, a spring lengthens as the wheel rises, or shortens as the wheel falls. Rigid axles and
/// elastic wheels are left out.
pub fn spring_doubts(study: &Study, found: &Curves) -> Vec<String> {
    let ends = |keys: &[&str]| {
        let travels = || keys.iter().flat_map(|key| found.along(key)).flatten();
        [travels().fold(0.0, f64::min), travels().fold(0.0, f64::max)]
    };
    let Some(AxleStudy { axle, .. }) = study.axle() else {
        return match study.compliance() {
            Some(_) => Vec::new(),
            None => turns(study.wheel(), ends(&["travel"]), ""),
        };
    };
    if axle.elastic.is_some() || axle.is_rigid() {
        return Vec::new();
    }
    let keys = ["travel_left", "travel_right"];
    match &axle.right {
        None => turns(&axle.left, ends(&keys), ""),
        Some(right) => [
            turns(&axle.left, ends(&keys[..1]), "left wheel: "),
            turns(right, ends(&keys[1..]), "right wheel: "),
        ]
        .concat(),
    }
}

/// Warnings about the spring of a wheel if its motion ratio changes its sign between the design position and the travels `ends`.
fn turns(suspension: &Suspension, ends: [f64; 2], wheel: &str) -> Vec<String> {
    let Some(spring) = suspension.mechanism.spring else {
        return Vec::new();
    };
    let unit = suspension.length_unit.symbol();
    let [upper, lower] = [spring.upper, spring.lower].map(|id| suspension.mechanism.name(id));
    let doubt = |end: f64| {
        let travel = turn(suspension, end)?;
        let (beyond, does) = if end > 0.0 {
            ("above", "lengthens as the wheel rises")
        } else {
            ("below", "shortens as the wheel falls")
        };
        Some(format!(
            "please check: {wheel}{beyond} travel {} {unit} the spring from {lower} to {upper} {does}: its motion ratio changes \
             sign there. The motion goes to {} {unit}",
            brief(travel),
            brief(end)
        ))
    };
    let away = ends.into_iter().filter(|end| *end != 0.0);
    away.filter_map(doubt).collect()
}

/// Travel between 0 and `end` at which the motion ratio falls to 0, interpolated linearly. `None` if the motion ratio stays above
/// 0. Also `None` if the motion ratio is not above 0 in the design position, because another warning reports this case.
fn turn(suspension: &Suspension, end: f64) -> Option<f64> {
    let mut own = WheelStudy::of(suspension.clone());
    own.outputs = Outputs::of(vec![Characteristic::MotionRatio]);
    let places: Vec<f64> = (0..=PLACES)
        .map(|k| end * f64::from(k) / f64::from(PLACES))
        .collect();
    let plan = Plan {
        station_order: StationOrder::through(&places),
        racks: vec![0.0],
        ..Plan::of(&own)
    };
    let found = curves(suspension, &plan).ok()?;
    let ratios: Vec<f64> = found.stations.iter().map_while(|s| s.value(0)).collect();
    if *ratios.first()? <= 0.0 {
        return None;
    }
    let after = ratios.iter().position(|ratio| *ratio < 0.0)?;
    let [before, behind] = [ratios[after - 1], ratios[after]];
    let share = before / (before - behind);
    Some(places[after - 1] + share * (places[after] - places[after - 1]))
}

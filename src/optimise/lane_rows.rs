//! Residuals of targets in SIMD lanes: the stations of one design side by side, or the builds of a robust tuning.

use super::Evaluation;
use super::lane_builds::LaneBuilds;
use super::layout::{TargetLayout, TargetSample};
use super::moves::Way;
use crate::characteristics::Quantity;
use crate::model::Suspension;
use crate::number::{Vector3, Width};
use crate::sweep::{Gradients, Stations};

/// Evaluates the targets of one wheel.
#[derive(Clone)]
pub(super) struct LaneRows<'a> {
    /// By leg; none where a leg has no targets.
    legs: Vec<Option<Leg<'a>>>,
    /// How every coordinate of a design moves with each variable, `[variable][point][axis]`.
    along: Vec<f64>,
}

/// A motion with the rack in one place.
#[derive(Clone)]
struct Leg<'a> {
    gradients: Gradients<'a>,
    /// Stations side by side, group by group.
    groups: Vec<Vec<usize>>,
}

impl<'a> LaneRows<'a> {
    /// For the targets of a layout; `None` where they cannot be differentiated in lanes.
    pub(super) fn new(
        suspension: &'a Suspension,
        layout: &TargetLayout,
        width: Width,
    ) -> Option<Self> {
        let measures = layout.measures.iter().map(|measure| measure.quantity());
        let quantities: Vec<Quantity> = measures.collect::<Option<_>>()?;
        let legs = layout.legs.iter().map(|leg| {
            if leg.targets.iter().all(Vec::is_empty) {
                return Some(None);
            }
            let stations = Stations::at_rack(leg.drive, &leg.order, leg.rack);
            let gradients = Gradients::new(suspension, &stations, &quantities, width)?;
            Some(Some(Leg {
                groups: gradients.side_by_side(),
                gradients,
            }))
        });
        let legs: Vec<Option<Leg>> = legs.collect::<Option<_>>()?;
        let has_targets = legs.iter().any(Option::is_some);
        has_targets.then_some(LaneRows {
            legs,
            along: Vec::new(),
        })
    }

    /// Writes the residuals of a design that moves in these ways, and their derivatives. Returns whether all of it was plain
    /// sailing; if not, what is written is not to be used.
    pub(super) fn of_design(
        &mut self,
        layout: &TargetLayout,
        design: &[Vector3<f64>],
        ways: &[Way],
        into: &mut Evaluation,
    ) -> bool {
        let one = 3 * design.len();
        self.along.clear();
        self.along.resize(into.jacobian.ncols() * one, 0.0);
        for way in ways {
            let first = way.column * one + 3 * way.point;
            for (sum, by) in self.along[first..first + 3]
                .iter_mut()
                .zip(way.by.to_array())
            {
                *sum += by;
            }
        }
        let along = &self.along;
        let legs = layout.legs.iter().zip(&mut self.legs);
        legs.filter_map(|(leg, lanes)| Some((leg, lanes.as_mut()?)))
            .all(|(leg, lanes)| {
                let groups = &lanes.groups;
                lanes.gradients.slopes_of_one(design, along, |found| {
                    for (lane, station) in groups[found.station()].iter().enumerate() {
                        for wish in &leg.targets[*station] {
                            let value = found.value(lane, wish.measure);
                            let slope = |column| found.slope(lane, wish.measure, column);
                            write(wish, wish.row, value, slope, into);
                        }
                    }
                })
            })
    }

    /// Writes the residuals of builds and their derivatives, as far as they are plain sailing.
    pub(super) fn of_builds(
        &mut self,
        layout: &TargetLayout,
        builds: &mut LaneBuilds,
        into: &mut Evaluation,
    ) {
        for group in builds.groups() {
            for (leg, lanes) in layout.legs.iter().zip(&mut self.legs) {
                let Some(Leg { gradients, .. }) = lanes else {
                    continue;
                };
                gradients.slopes(builds.designs(&group), builds.ways(&group), |found| {
                    for wish in &leg.targets[found.station()] {
                        for (lane, build) in group.clone().enumerate() {
                            let row = build * layout.rows + wish.row;
                            let value = found.value(lane, wish.measure);
                            let slope = |column| found.slope(lane, wish.measure, column);
                            write(wish, row, value, slope, into);
                        }
                    }
                });
                for (lane, build) in group.clone().enumerate() {
                    if !gradients.is_right(lane) {
                        builds.refuse(build);
                    }
                }
            }
        }
    }
}

/// Writes a row.
fn write(
    wish: &TargetSample,
    row: usize,
    value: f64,
    slope: impl Fn(usize) -> f64,
    into: &mut Evaluation,
) {
    let nearest = value.clamp(wish.low, wish.high);
    into.residuals[row] = (value - nearest) * wish.scale;
    // Within its band nothing changes.
    let is_in = wish.low < wish.high && nearest == value;
    for column in 0..into.jacobian.ncols() {
        into.jacobian[(row, column)] = match is_in {
            true => 0.0,
            false => slope(column) * wish.scale,
        };
    }
}

//! Layout of a tuning: assigns each residual of a target, and each row of a constraint, to a station of a motion.
//!
//! The drive value of a station is its travel, or its arm angle.

mod draft;
mod goals;
mod margins;
mod rows;

pub(super) use goals::{LimitedValue, StationGoals};
pub(super) use margins::whole;
pub use margins::{Margin, VIOLATED};
pub(super) use rows::Check;
use rows::parts;

use super::Linearisation;
use super::axle::AxleLayout;
use super::elastic::ElasticLayout;
use super::trade::Criterion;
use crate::characteristics::{Measure, Slots};
use crate::model::{Drive, Suspension};
use crate::solve::StationOrder;
use crate::study::{Limited, Optimise, Sample, Site, Target, Vehicle};
use draft::{Draft, TargetPlace, draft_of, legs_of};
use nalgebra::DVector;
use rows::RowNumbers;

/// A target at one station: of a leg (a motion at one rack displacement), of an axle, or of a wheel with elastic parts.
#[derive(Clone, Debug)]
pub(super) struct TargetSample {
    pub row: usize,
    pub target: usize,
    /// Index of the target's measure in [`TargetLayout::measures`]. For an axle, the index of its quantity in the axle's
    /// layout; for elastic parts, the index of its value at the station.
    pub of: usize,
    /// Target value. For an axle, the `drive` of the sample is the abscissa of the target's curve, as written in the study.
    pub wanted: Sample,
    /// Residual per deviation of one unit of the measure.
    pub scale: f64,
}

impl TargetSample {
    /// Writes the residual in a row. Returns true if the residual has slopes. Within a band, writes a zero residual with zero
    /// slopes, and returns false.
    #[inline]
    pub(super) fn write_residual(&self, row: usize, found: f64, into: &mut Linearisation) -> bool {
        let deviation = self.wanted.deviation(found);
        into.residuals[row] = deviation * self.scale;
        let pulls = !self.wanted.is_band() || deviation != 0.0;
        if !pulls {
            into.jacobian.row_mut(row).fill(0.0);
        }
        pulls
    }
}

/// A limit of a constraint part along a motion. The limit also applies to extremes between the stations.
#[derive(Clone, Debug)]
pub(super) struct Extremes {
    pub part: usize,
    /// 1 for an upper limit (largest values), -1 for a lower limit (smallest values).
    pub sign: f64,
    /// Stations at which the part is evaluated, each with the row of this limit, in the order of the drive value.
    pub rows: Vec<(usize, usize)>,
}

/// Stations of one motion at one rack displacement, with their targets and constraints.
#[derive(Clone, Debug)]
pub(super) struct Leg {
    pub drive: Drive,
    /// Displacement of the rack along +y of the kernel's frame (+y is to the left).
    pub rack: f64,
    pub order: StationOrder,
    /// Three orders in which the solver visits stations: of the stations with constraints, of the stations with targets,
    /// and of all stations.
    visits: [StationOrder; 3],
    pub targets: Vec<Vec<TargetSample>>,
    pub checks: Vec<Vec<Check>>,
    pub extremes: Vec<Extremes>,
}

impl Leg {
    /// Order of the stations that an evaluation needs: of the targets, of the constraints, or of both. `None` if it needs no
    /// station.
    pub(super) fn order_of(
        &self,
        with_targets: bool,
        with_constraints: bool,
    ) -> Option<&StationOrder> {
        let visit = 2 * usize::from(with_targets) + usize::from(with_constraints);
        let order = &self.visits[visit.checked_sub(1)?];
        (!order.is_empty()).then_some(order)
    }
}

/// A part of a constraint: one measure with its limits.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub constraint: usize,
    /// True if the part is evaluated only in the design position. This includes values that are the same in every pose.
    is_at_design: bool,
    pub limited: Limited,
}

/// Identifies a row of the constraints: its part, station and limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowLabel {
    /// Index of the constraint in the study.
    pub constraint: usize,
    /// Index of the part of the constraint.
    pub part: usize,
    /// True for the upper limit and for an equality.
    pub is_upper: bool,
    /// Index of the leg: a motion at one rack displacement. The index after the last leg denotes the stations of an axle or
    /// of elastic parts.
    pub leg: usize,
    /// Index of the station. If the part has a worse extreme between this station and its neighbours, the row applies to
    /// that extreme instead.
    pub station: usize,
}

/// Layout of the residuals and constraints that belong to an axle or to elastic parts, beside the layout of a rigid wheel.
#[derive(Clone, Debug)]
pub(super) enum Beside {
    /// Residuals and constraints of an axle.
    Axle(Box<AxleLayout>),
    /// Residuals and constraints of a wheel with elastic parts.
    Elastic(Box<ElasticLayout>),
}

impl Beside {
    /// Targets and limits of each station, with the station's rack displacement along +y of the kernel's frame (+y is to
    /// the left).
    fn goals(&self) -> Vec<(&StationGoals, f64)> {
        match self {
            Beside::Axle(axle) => axle.goals().collect(),
            Beside::Elastic(elastic) => elastic.goals().collect(),
        }
    }

    /// Targets and limits of each station. They are mutable, so that the caller can weigh the targets and number the rows
    /// of the limits.
    fn goals_mut(&mut self) -> Vec<&mut StationGoals> {
        match self {
            Beside::Axle(axle) => axle.goals_mut().collect(),
            Beside::Elastic(elastic) => elastic.goals_mut().collect(),
        }
    }
}

/// Layout of a tuning: quantity and station of each residual, and of each row of the constraints.
#[derive(Clone, Debug)]
pub struct TargetLayout {
    pub(super) legs: Vec<Leg>,
    pub(super) rows: usize,
    /// Measures of the targets of one wheel.
    pub(super) measures: Vec<Measure>,
    /// Targets and limits of an axle or of elastic parts. `None` for a rigid wheel.
    pub(super) beside: Option<Beside>,
    pub(super) parts: Vec<Part>,
    pub(super) labels: Vec<RowLabel>,
    /// For each constraint row: the other row, if both rows are the two components of one distance. `None` for all other
    /// rows.
    others: Vec<Option<usize>>,
    pub(super) equalities: usize,
    /// Number of constraints of the study.
    constraints: usize,
    /// Number of builds, or 1 if the tuning is not robust. Each build has all residuals.
    pub(super) builds: usize,
    /// Residual per deviation of one tolerance, for each target.
    shares: Vec<f64>,
    rate_order: usize,
    /// Quantities of wheel and steering axis that the targets and constraints need.
    pub(super) reads: Slots,
}

impl TargetLayout {
    /// Makes the layout for the nominal design alone. The layout of a robust study has the residuals of all its builds. An
    /// evaluation of the nominal design must not use that layout. It would compute the residuals of only one build, but
    /// divide the misfit by the number of all residuals.
    pub fn nominal(optimise: &Optimise, vehicle: &Vehicle) -> Self {
        TargetLayout::of(&optimise.nominal(), vehicle)
    }

    /// Makes the layout of a study's targets and constraints. A curve is compared at all stations of the motion between the
    /// ends of the curve, and at stations added for the curve. A target at a single drive value adds a station. The rack has
    /// the displacement that the study gives, or is straight ahead if the study sweeps the rack.
    pub fn of(optimise: &Optimise, vehicle: &Vehicle) -> Self {
        let (
            own_motion,
            Suspension {
                frame, mechanism, ..
            },
        ) = (vehicle.motion(), vehicle.wheel());
        let mut drafts: Vec<Draft> = Vec::new();
        let mut rows = 0;
        let mut own = vec![0; optimise.targets.len()];
        let of_one_wheel = |t: &(usize, &Target)| t.1.of.of_wheel().is_some();
        let targets = optimise.targets.iter().enumerate();
        for (number, target) in targets.filter(of_one_wheel) {
            let (motion, legs) = legs_of(&target.site, own_motion, frame, &mut drafts);
            let stations = target.stations_in(motion);
            for leg in legs {
                for sample in target.wanted.samples(&stations) {
                    let station = drafts[leg].station(sample.drive);
                    drafts[leg].targets.push((rows, number, station, sample));
                    own[number] += 1;
                    rows += 1;
                }
            }
        }
        let mut beside = match vehicle {
            Vehicle::Axle(both) => Some(Beside::Axle(Box::new(AxleLayout::of(
                &both.axle, optimise, &mut rows, &mut own,
            )))),
            Vehicle::Wheel(wheel) => wheel.compliance.as_ref().map(|compliance| {
                let layout = ElasticLayout::of(wheel, compliance, optimise, &mut rows, &mut own);
                Beside::Elastic(Box::new(layout))
            }),
        };
        let parts = parts(optimise, mechanism);
        for (place, part) in parts.iter().enumerate() {
            let default = Site::default();
            let site = optimise.constraints[part.constraint].site.as_ref();
            if let (Some(Beside::Elastic(elastic)), Measure::Elastic(value)) =
                (&mut beside, &part.limited.of)
            {
                elastic.limit(place, *value, &part.limited, site, own_motion);
                continue;
            }
            if let (Some(Beside::Axle(axle)), Measure::OfAxle(quantity), Vehicle::Axle(both)) =
                (&mut beside, &part.limited.of, vehicle)
            {
                let at_design = both.plan.motion.at_design().placements()[0];
                axle.limit(place, *quantity, &part.limited, at_design);
                continue;
            }
            let (motion, legs) = legs_of(site.unwrap_or(&default), own_motion, frame, &mut drafts);
            if part.is_at_design {
                // In the design position the rack is straight ahead.
                let home = draft_of(&mut drafts, motion.drive.in_kernel(), 0.0, &[]);
                let station = drafts[home].station(0.0);
                drafts[home].checks.push((place, station));
                continue;
            }
            for leg in legs {
                for station in 0..motion.values.len() {
                    drafts[leg].checks.push((place, station));
                }
                drafts[leg].extremes.push(place);
            }
        }
        for draft in &mut drafts {
            draft.leave_out_unused();
        }
        drafts.retain(|draft| !draft.values.is_empty());
        Self::finished(optimise, drafts, beside, parts, rows, &own)
    }

    fn finished(
        optimise: &Optimise,
        drafts: Vec<Draft>,
        mut beside: Option<Beside>,
        parts: Vec<Part>,
        rows: usize,
        own: &[usize],
    ) -> Self {
        let shares = shares(optimise, rows, own);
        for goals in beside.iter_mut().flat_map(Beside::goals_mut) {
            for sample in &mut goals.samples {
                sample.scale *= shares[sample.target];
            }
        }
        // Collects the measures of the targets of one wheel, in the order of the targets.
        let mut measures = Vec::new();
        let targets = optimise.targets.iter().zip(&shares);
        let targets: Vec<TargetPlace> = targets
            .map(|(target, share)| {
                measures.extend(target.of.of_wheel().cloned());
                TargetPlace {
                    of: measures.len().saturating_sub(1),
                    scale: share / target.tolerance,
                }
            })
            .collect();
        let of_elastic = drafts.len();
        let goals = beside.iter().flat_map(Beside::goals).enumerate();
        let limits = goals.flat_map(|(station, (goals, _))| {
            let limits = goals.limits.iter();
            limits.map(move |own| (own.part, of_elastic, station))
        });
        let checks = drafts.iter().enumerate().flat_map(|(leg, draft)| {
            let checks = draft.checks.iter();
            checks.map(move |&(part, station)| (part, leg, station))
        });
        let mut numbers = RowNumbers::of(&parts, checks.chain(limits));
        let legs = drafts.into_iter().enumerate();
        let legs = legs.map(|(leg, draft)| draft.into_leg(leg, &targets, &mut numbers));
        let legs: Vec<Leg> = legs.collect();
        let goals = beside.iter_mut().flat_map(Beside::goals_mut);
        for (station, goals) in goals.enumerate() {
            for own in &mut goals.limits {
                own.check = numbers.check(own.part, of_elastic, station);
            }
        }
        let (labels, equalities) = numbers.into_labels();
        let all = || measures.iter().chain(parts.iter().map(|p| &p.limited.of));
        TargetLayout {
            rate_order: all().map(Measure::rate_order).max().unwrap_or(0),
            reads: Slots::of(all().map(|m| m.reads())),
            legs,
            rows,
            others: margins::other_components(&labels, &parts),
            measures,
            beside,
            parts,
            labels,
            equalities,
            constraints: optimise.constraints.len(),
            builds: optimise.scatter.as_ref().map_or(1, |s| s.builds),
            shares,
        }
    }

    /// Returns the layout whose residuals are the values of the targets' measures themselves.
    pub(super) fn of_values(mut self) -> Self {
        let legs = self.legs.iter_mut().flat_map(|leg| &mut leg.targets);
        let beside = self.beside.iter_mut().flat_map(Beside::goals_mut);
        let beside = beside.map(|goals| &mut goals.samples);
        for sample in legs.chain(beside).flatten() {
            (sample.wanted.low, sample.wanted.high) = (0.0, 0.0);
            sample.scale = 1.0;
        }
        self
    }

    /// Highest order of the derivatives with respect to the drive that a target or a constraint reads.
    pub fn rate_order(&self) -> usize {
        self.rate_order
    }

    /// Number of residuals, over all builds.
    pub fn residuals(&self) -> usize {
        self.rows * self.builds
    }

    /// Returns the constraint, station and limit of each row of the constraints, equalities first.
    pub fn labels(&self) -> &[RowLabel] {
        &self.labels
    }

    /// Number of equality rows of the constraints, which come first.
    pub fn equalities(&self) -> usize {
        self.equalities
    }

    /// Index of the target that each residual belongs to.
    pub fn targets_of_rows(&self) -> Vec<usize> {
        let mut of = vec![0; self.rows];
        for row in self.target_rows() {
            of[row.row] = row.target;
        }
        of.repeat(self.builds)
    }

    /// Rows of all targets, with their drive values and rack displacements.
    fn target_rows(&self) -> impl Iterator<Item = TargetRow> {
        let legs = self.legs.iter().flat_map(|leg| {
            let stations = leg.targets.iter().enumerate();
            stations.flat_map(move |(station, samples)| {
                samples.iter().map(move |sample| TargetRow {
                    row: sample.row,
                    target: sample.target,
                    at: leg.order.values()[station],
                    rack: leg.rack,
                })
            })
        });
        let beside = self.beside.iter().flat_map(Beside::goals);
        let beside = beside.flat_map(|(goals, rack)| {
            goals.samples.iter().map(move |sample| TargetRow {
                row: sample.row,
                target: sample.target,
                at: sample.wanted.drive,
                rack,
            })
        });
        legs.chain(beside)
    }

    /// Residual of a target per deviation of one tolerance.
    pub fn share(&self, target: usize) -> f64 {
        self.shares[target]
    }

    /// Makes the criterion for the misfit of some of the targets.
    pub(super) fn aim(&self, targets: &[usize]) -> Criterion {
        let of = self.targets_of_rows();
        let rows: Vec<usize> = (0..of.len())
            .filter(|row| targets.contains(&of[*row]))
            .collect();
        let squares = rows.iter().map(|row| self.shares[of[*row]].powi(2));
        let unit = squares.sum::<f64>().sqrt();
        Criterion::misfit(rows, unit)
    }

    /// Deviations of each target from the residuals, in multiples of the tolerance.
    pub fn deviations(&self, residuals: &DVector<f64>) -> Vec<Deviation> {
        self.shares
            .iter()
            .enumerate()
            .map(|(target, share)| {
                let (mut sum, mut count, mut worst, mut at) = (0.0, 0, 0.0_f64, None);
                for row in self.target_rows().filter(|p| p.target == target) {
                    for build in 0..self.builds {
                        let deviation = residuals[build * self.rows + row.row] / share;
                        sum += deviation * deviation;
                        count += 1;
                        let place = (row.at, row.rack);
                        if deviation.abs() > worst.abs() {
                            (worst, at) = (deviation, Some(place));
                        }
                        at.get_or_insert(place);
                    }
                }
                let (worst_at, worst_rack) = at.unwrap_or_default();
                Deviation {
                    rms: (sum / count as f64).sqrt(),
                    worst,
                    worst_at,
                    worst_rack,
                    stations: count / self.builds,
                }
            })
            .collect()
    }
}

/// Residual per deviation of one tolerance, for each target. It depends on the weight of the target. Unless the targets are
/// measurements, it also depends on the number of all residuals and on the number of the target's residuals.
fn shares(optimise: &Optimise, rows: usize, own: &[usize]) -> Vec<f64> {
    let total: f64 = optimise.targets.iter().map(|t| t.weight).sum();
    let targets = optimise.targets.iter().zip(own);
    targets
        .map(|(target, own)| {
            if optimise.fit {
                // The weight of a measured point depends only on the weight of its target, not on the number of points.
                (target.weight / total * optimise.targets.len() as f64).sqrt()
            } else {
                (target.weight / total * rows as f64 / *own as f64).sqrt()
            }
        })
        .collect()
}

/// A row of a target, with its drive value and rack displacement.
struct TargetRow {
    row: usize,
    target: usize,
    at: f64,
    rack: f64,
}

/// Deviation from a target, in multiples of the target's tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Root mean square of the deviation over the target's stations and over all builds.
    pub rms: f64,
    /// Largest deviation of all builds, with its sign.
    pub worst: f64,
    /// Drive value at which the deviation is largest. For an axle, the abscissa of the target's curve, as written in the
    /// study. Without any deviation, the first station.
    pub worst_at: f64,
    /// Rack displacement at which the deviation is largest, along +y of the kernel's frame (+y is to the left).
    pub worst_rack: f64,
    /// Number of residuals of the target in one build.
    pub stations: usize,
}

//! Comparison of two designs, station by station.

use super::SideEffect;
use super::observed::{Gain, Observed, Series, Station};
use crate::sorting::sort_by;
use std::collections::HashMap;

/// Largest change that counts as a rounding error, as a share of the values or of the tolerance.
const ROUNDING: f64 = 1e-9;
/// Smallest change that does not count as a rounding error, for an output without a tolerance. In the unit of the
/// output.
const LEAST_CHANGE: f64 = 1e-12;

/// Changes that targets request over `[motion]`: for each output of each wheel, its changes in the order of the drive value.
#[derive(Default)]
pub(super) struct RequestedChanges(HashMap<OfWheel, Vec<RequestedChange>>);

/// Name of an output, and of its wheel. `None` for an output that belongs to no single wheel.
type OfWheel = (String, Option<&'static str>);

/// Change that a target requests at a station of `[motion]`.
struct RequestedChange {
    /// Drive value of the station.
    drive: f64,
    /// Name of the drive, if it is the travel over which a requested slope applies.
    along: Option<String>,
    /// Change of the output at this station.
    change: f64,
    /// Change of the output's slope that a target for a gain requests. 0 without such a target.
    slope: f64,
}

impl RequestedChanges {
    /// Finds the changes that targets request over this motion.
    pub(super) fn of(before: &Observed, after: &Observed) -> Self {
        let pairs = before.series.iter().zip(&after.series);
        let asked = pairs.map(|(from, to)| {
            let shifts = Wanted::of(from, to, &before.stations).shifts.into_iter();
            let requested = |(_, number, change): (f64, usize, f64)| {
                let station = &before.stations[number];
                let is_drive = |gain: &Gain| gain.travels[number] == Some(station.drive());
                let place = station.place.first();
                RequestedChange {
                    drive: station.drive(),
                    along: place
                        .filter(|_| from.gains.iter().all(is_drive))
                        .map(|drive| drive.name.clone()),
                    change,
                    slope: slope_changes(from, to, number)
                        .map(|(_, slope)| slope)
                        .sum(),
                }
            };
            let mut by_drive: Vec<_> = shifts.map(requested).collect();
            sort_by(&mut by_drive, |a, b| a.drive.total_cmp(&b.drive));
            ((from.output.clone(), from.wheel), by_drive)
        });
        RequestedChanges(asked.collect())
    }

    /// Change of a series that targets request at a station. It is the change requested at the nearest drive value, plus a
    /// term for a requested change of the slope. This term is the change of the slope times the distance between the two
    /// drive values. 0 if no target requests a change.
    fn shift_at(&self, series: &Series, station: &Station) -> f64 {
        let Some(shifts) = self.0.get(&(series.output.clone(), series.wheel)) else {
            return 0.0;
        };
        let drive = station.drive();
        let start = shifts.partition_point(|shift| shift.drive < drive);
        let near = &shifts[start.saturating_sub(1)..shifts.len().min(start + 1)];
        let away = |shift: &RequestedChange| (shift.drive - drive).abs();
        let nearest = near.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.map_or(0.0, |shift| {
            let place = station.place.first();
            let is_same = place.is_some_and(|own| shift.along.as_ref() == Some(&own.name));
            let slope = if is_same { shift.slope } else { 0.0 };
            shift.change + slope * (drive - shift.drive)
        })
    }
}

/// Changes of an output's slope that targets for gains request at a station, each with its gain.
fn slope_changes<'s>(
    before: &'s Series,
    after: &'s Series,
    station: usize,
) -> impl Iterator<Item = (&'s Gain, f64)> {
    let pairs = before.gains.iter().zip(&after.gains);
    let pairs = pairs.filter(move |(gain, _)| gain.wanted.contains(&station));
    pairs.filter_map(move |(from, to)| Some((from, to.slopes[station]? - from.slopes[station]?)))
}

/// Returns the side effects over one motion, in the order of the outputs. `asked` contains the changes that targets in
/// `[motion]` request.
pub(super) fn compare(
    before: &Observed,
    after: &Observed,
    asked: &RequestedChanges,
) -> Vec<SideEffect> {
    let mut outputs: Vec<Vec<usize>> = Vec::new();
    for (number, series) in before.series.iter().enumerate() {
        let same = |of: &&mut Vec<usize>| before.series[of[0]].output == series.output;
        match outputs.iter_mut().find(same) {
            Some(output) => output.push(number),
            None => outputs.push(vec![number]),
        }
    }
    let effects = outputs.iter().filter_map(|wheels| {
        let pairs = wheels
            .iter()
            .map(|k| (&before.series[*k], &after.series[*k]));
        effect(&pairs.collect::<Vec<_>>(), before, asked)
    });
    effects.collect()
}

/// Change of one series at one station, beyond the change that targets request.
struct Change {
    amount: f64,
    /// Tolerance of the value at this station.
    tolerance: Option<f64>,
    station: usize,
    series: usize,
}

impl Change {
    /// Absolute change. It is a multiple of the tolerance if there is a tolerance, otherwise it is in the unit of the
    /// output.
    fn size(&self) -> f64 {
        self.amount.abs() / self.tolerance.unwrap_or(1.0)
    }
}

/// Computes the side effect of an output from its series before and after the tuning. `None` if the output has no value at
/// the compared stations.
fn effect(
    pairs: &[(&Series, &Series)],
    observed: &Observed,
    asked: &RequestedChanges,
) -> Option<SideEffect> {
    let stations = &observed.stations;
    let (mut was, mut is) = (Range::default(), Range::default());
    let (mut lost, mut largest, mut asked_change) = (0, None::<Change>, 0.0_f64);
    for (series, (before, after)) in pairs.iter().enumerate() {
        let wanted = Wanted::of(before, after, stations);
        for station in compared(before, stations) {
            let values = [before.values[station], after.values[station]];
            was.take(values[0]);
            is.take(values[1]);
            let [Some(from), Some(to)] = values else {
                lost += usize::from(values[0].is_some());
                continue;
            };
            let shift = if wanted.shifts.is_empty() {
                asked.shift_at(before, &stations[station])
            } else {
                wanted.shift_at((before, after), stations, station)
            };
            // A change between zero and the change that a target requests is not a side effect.
            let as_asked = (to - from).clamp(shift.min(0.0), shift.max(0.0));
            let here = Change {
                amount: to - from - as_asked,
                tolerance: before.tolerance.map(|tolerance| tolerance.of(from)),
                station,
                series,
            };
            if as_asked.abs() > asked_change.abs() {
                asked_change = as_asked;
            }
            if largest.as_ref().is_none_or(|l| here.size() > l.size()) {
                largest = Some(here);
            }
        }
    }
    let first = pairs[0].0;
    let magnitude = was.magnitude().max(is.magnitude());
    let tolerance = largest.as_ref().and_then(|l| l.tolerance);
    let tolerance = tolerance.or(first.tolerance.map(|of| of.of(magnitude)));
    let rounding = ROUNDING * magnitude.max(tolerance.unwrap_or(LEAST_CHANGE / ROUNDING));
    let change = largest.as_ref().filter(|l| l.amount.abs() > rounding);
    let exceeds = |tolerance: f64| change.is_some_and(|l| l.amount.abs() > tolerance);
    (was.ends.is_some() || is.ends.is_some()).then(|| SideEffect {
        output: match &observed.motion {
            None => first.output.clone(),
            Some(motion) => format!("{}, {motion}", first.output),
        },
        unit: first.unit.clone(),
        before_min: was.ends.map(|ends| ends[0]),
        before_max: was.ends.map(|ends| ends[1]),
        after_min: is.ends.map(|ends| ends[0]),
        after_max: is.ends.map(|ends| ends[1]),
        largest_change: largest.as_ref().map(|_| change.map_or(0.0, |l| l.amount)),
        at: change.map_or(Vec::new(), |l| stations[l.station].place.clone()),
        case: change.and_then(|l| stations[l.station].case.clone()),
        wheel: change.and_then(|l| Some(pairs[l.series].0.wheel?.to_owned())),
        asked_change: if asked_change.abs() > rounding {
            asked_change
        } else {
            0.0
        },
        tolerance,
        flagged: lost > 0 || tolerance.is_some_and(exceeds),
        lost,
    })
}

/// Stations at which a series is compared. Stations at which a target or constraint applies are excluded. Some series
/// are also compared only with the rack at 0.
fn compared(series: &Series, stations: &[Station]) -> Vec<usize> {
    let mut counts: Vec<bool> = stations
        .iter()
        .map(|station| station.is_straight || !series.straight_only)
        .collect();
    for station in &series.wanted {
        counts[*station] = false;
    }
    (0..stations.len()).filter(|k| counts[*k]).collect()
}

/// Changes of one series that targets request.
struct Wanted {
    /// Requested changes, sorted by the first coordinate of their station. Each entry has this coordinate, the index of
    /// the station, and the change.
    shifts: Vec<(f64, usize, f64)>,
}

impl Wanted {
    fn of(before: &Series, after: &Series, stations: &[Station]) -> Self {
        let counts = |station: &&usize| stations[**station].is_straight || !before.straight_only;
        let shift = |number: &usize| {
            let change = after.values[*number]? - before.values[*number]?;
            Some((stations[*number].position[0], *number, change))
        };
        let wanted = before.wanted.iter().filter(counts);
        let mut shifts: Vec<_> = wanted.filter_map(shift).collect();
        sort_by(&mut shifts, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        shifts.dedup_by_key(|shift| shift.1);
        Wanted { shifts }
    }

    /// Change that targets request at a station. It is the change at the nearest station with a target. If a target for a
    /// gain applies to that station, the change of the slope times the distance is added. 0 without a target.
    fn shift_at(
        &self,
        (before, after): (&Series, &Series),
        stations: &[Station],
        number: usize,
    ) -> f64 {
        let here = &stations[number].position;
        let start = self.shifts.partition_point(|shift| shift.0 < here[0]);
        let (mut nearest, mut found) = (f64::INFINITY, None);
        // Searches in both directions along the first coordinate. A direction ends when the difference in this coordinate
        // alone exceeds the distance to the nearest station found so far.
        let (below, above) = self.shifts.split_at(start);
        let ways: [&mut dyn Iterator<Item = &(f64, usize, f64)>; 2] =
            [&mut below.iter().rev(), &mut above.iter()];
        for way in ways {
            for (first, other, shift) in way {
                if (first - here[0]).powi(2) >= nearest {
                    break;
                }
                let there = &stations[*other].position;
                let squares = here.iter().zip(there).map(|(a, b)| (a - b) * (a - b));
                let away = squares.sum::<f64>();
                if away < nearest {
                    (nearest, found) = (away, Some((*other, *shift)));
                }
            }
        }
        let Some((other, shift)) = found else {
            return 0.0;
        };
        let by_slopes = slope_changes(before, after, other).filter_map(|(gain, slope)| {
            Some(slope * (gain.travels[number]? - gain.travels[other]?))
        });
        shift + by_slopes.sum::<f64>()
    }
}

/// Smallest and largest value of an output so far.
#[derive(Default)]
struct Range {
    ends: Option<[f64; 2]>,
}

impl Range {
    fn take(&mut self, value: Option<f64>) {
        if let Some(value) = value {
            let [low, high] = self.ends.unwrap_or([value; 2]);
            self.ends = Some([low.min(value), high.max(value)]);
        }
    }

    fn magnitude(&self) -> f64 {
        self.ends
            .map_or(0.0, |[low, high]| low.abs().max(high.abs()))
    }
}

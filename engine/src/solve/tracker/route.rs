//! Route through the stations, and the weights that predict each waypoint from earlier ones.
//!
//! A waypoint is a station, or a point that divides a long step. The route goes outward from the design position,
//! alternately up and down, so that a prediction has neighbours on both sides of the origin. The prediction is the
//! value at the new waypoint of the polynomial through the nearest visited waypoints (Lagrange's form). The slope is
//! predicted in the same way, through fewer waypoints. The weights depend only on the travels and are the same for
//! every design.

use crate::number::Jet;
use crate::solve::StationOrder;
use crate::sorting::sort_by;

/// Number of waypoints from which values are predicted.
const NEIGHBOURS: usize = 8;
/// Number of waypoints from which slopes are predicted. A slope only corrects the error of a prediction, so fewer waypoints
/// suffice.
const NEIGHBOURS_OF_SLOPE: usize = 4;
/// Largest number of steps from one value to the next. The route leaves out values that need more steps, and the values beyond
/// them. The continuation solves these values.
const MOST_STEPS: f64 = 1e3;
/// Indices of visited waypoints, each with its weight. If there are fewer than `PLACES` waypoints, the unused elements have weight
/// 0.
pub(crate) type Stencil<const PLACES: usize> = [(usize, f64); PLACES];

/// Part of the route to which a waypoint belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Leg {
    /// Lead: the part of the route at zero drive. The rack moves to its displacement. For wheels in roll, the heave also moves to
    /// its value.
    Rack,
    /// Above the design position.
    Up,
    /// Below the design position.
    Down,
}

impl Leg {
    /// Side of the design position: 0 up, 1 down.
    #[inline(always)]
    pub(crate) fn side(self) -> usize {
        usize::from(self == Leg::Down)
    }
}

/// A waypoint of the route.
#[derive(Clone, Debug)]
pub(crate) struct RouteStep {
    /// Value of the drive.
    pub value: f64,
    /// Displacement of the rack. For a rigid axle, the mean travel in roll and 0 in heave.
    pub rack: f64,
    /// Mean travel of both wheels in roll, else 0.
    pub heave: f64,
    /// Station at this waypoint. `None` for a waypoint that divides a long step.
    pub station: Option<usize>,
    pub leg: Leg,
    /// Completed fraction of the lead (the part of the route at zero drive): 0 in the design position, 1 at all stations.
    /// If the route has no lead, 1 everywhere.
    pub lead: f64,
    /// Change of the drive since the previous waypoint on this leg.
    pub step: f64,
    /// Stencil (earlier waypoints with weights) that predicts the unknowns here. The prediction also adds the steps in the fields
    /// `along_...`, multiplied by slopes of the unknowns.
    pub prediction: Stencil<NEIGHBOURS>,
    /// Step of the drive. The prediction adds it, multiplied by the slope with respect to the drive. Only the first
    /// step uses it.
    pub along_slope: f64,
    /// Step of the rack. The prediction adds it, multiplied by the slope with respect to the rack.
    pub along_rack: f64,
    /// Step of the heave. The prediction adds it, multiplied by the slope with respect to the travel.
    pub along_heave: f64,
    /// Step of the lead, as a fraction of the lead. Only the first step uses it.
    pub along_lead: f64,
    /// Stencil that predicts the slope with respect to the drive here. `None` in the lead and at the first waypoint
    /// after it.
    pub slope: Option<Stencil<NEIGHBOURS_OF_SLOPE>>,
}

/// Waypoints in the order of the visit: the design position, the waypoints of the lead, then the stations and the points that
/// divide long steps.
#[derive(Clone, Debug)]
pub(crate) struct Route {
    pub places: Vec<RouteStep>,
    /// True if the route visits every station. A route leaves out stations that coincide or are too far away.
    pub is_complete: bool,
}

impl Route {
    /// Makes the route through the stations in steps of the drive of at most `longest`. Before these stations, in the lead,
    /// rack and heave move to their values in steps of at most `longest_of_lead`. The lead includes the lift of wheel centres
    /// by a steering gear.
    pub(crate) fn through(
        station_order: &StationOrder,
        [rack, heave, lift]: [f64; 3],
        longest: f64,
        longest_of_lead: f64,
    ) -> Route {
        let Legs {
            stations,
            design_station,
            is_complete,
        } = Legs::of(station_order, longest);

        let at_zero = |part: f64, number: usize| RouteStep {
            value: 0.0,
            rack: rack * part,
            heave: heave * part,
            station: None,
            leg: Leg::Rack,
            lead: part,
            step: 0.0,
            prediction: straight_on(number),
            along_slope: 0.0,
            slope: None,
            along_rack: if number == 1 { rack * part } else { 0.0 },
            along_heave: if number == 1 { heave * part } else { 0.0 },
            along_lead: if number == 1 { part } else { 0.0 },
        };
        let mut places = vec![at_zero(0.0, 0)];
        // The longest distance determines the number of steps.
        let length = rack.abs().max(heave.abs()).max(lift.abs());
        if length == 0.0 {
            places[0].lead = 1.0;
        } else {
            let Some(steps) = steps(0.0, length, longest_of_lead) else {
                return Route {
                    places,
                    is_complete: false,
                };
            };
            let last = steps.len();
            for k in 1..last {
                places.push(at_zero(k as f64 / last as f64, k));
            }
            places.push(at_zero(1.0, last));
        }
        let first = places.len() - 1;
        places[first].station = design_station;
        let mut visited = Visited {
            values: vec![0.0],
            sides: Default::default(),
        };
        for (value, station, leg, step) in stations {
            let prediction = visited.stencil(value, first, |weight| weight[0]);
            let slope = visited.stencil(value, first, |weight| weight[1]);
            let is_first = visited.values.len() == 1;
            places.push(RouteStep {
                value,
                rack,
                heave,
                station,
                leg,
                lead: 1.0,
                step,
                prediction,
                along_slope: if is_first { value } else { 0.0 },
                slope: (!is_first).then_some(slope),
                along_rack: 0.0,
                along_heave: 0.0,
                along_lead: 0.0,
            });
            visited.add(value);
        }
        Route {
            places,
            is_complete,
        }
    }
}

/// Waypoints on both legs of a route, from the design position outwards.
struct Legs {
    /// Value of the drive, station at this waypoint, leg, and step to this waypoint.
    stations: Vec<(f64, Option<usize>, Leg, f64)>,
    /// Index of the station in the design position. `None` if there is no such station.
    design_station: Option<usize>,
    /// True if the legs visit every station.
    is_complete: bool,
}

impl Legs {
    /// Waypoints in steps of at most `longest`.
    fn of(station_order: &StationOrder, longest: f64) -> Legs {
        let mut is_complete = true;
        let mut design_station = None;
        let mut stations = Vec::new();
        for (leg, side) in [Leg::Up, Leg::Down].into_iter().zip(station_order.sides()) {
            let mut before = 0.0;
            for &station in side {
                let value = station_order.values()[station];
                if value == before {
                    if value != 0.0 || design_station.is_some() {
                        is_complete = false;
                    } else {
                        design_station = Some(station);
                    }
                    continue;
                }
                let Some(steps) = steps(before, value, longest) else {
                    is_complete = false;
                    break;
                };
                let step = (value - before) / steps.len() as f64;
                let last = steps.len() - 1;
                for (k, place) in steps.into_iter().enumerate() {
                    stations.push((place, (k == last).then_some(station), leg, step));
                }
                before = value;
            }
        }
        sort_by(&mut stations, |a, b| {
            a.0.abs().total_cmp(&b.0.abs()).then(b.0.total_cmp(&a.0))
        });
        Legs {
            stations,
            design_station,
            is_complete,
        }
    }
}

/// End points of equal steps from one value to another. `None` for more than [`MOST_STEPS`] steps.
fn steps(from: f64, to: f64, longest: f64) -> Option<Vec<f64>> {
    let count = ((to - from).abs() / longest).ceil().max(1.0);
    (count <= MOST_STEPS).then_some(())?;
    let mut steps = Vec::new();
    let mut step = 1.0;
    while step < count {
        steps.push(from + (to - from) * (step / count));
        step += 1.0;
    }
    steps.push(to);
    Some(steps)
}

/// Extrapolates linearly from the two previous waypoints. All three waypoints are equally spaced.
fn straight_on(number: usize) -> Stencil<NEIGHBOURS> {
    let mut stencil = [(0, 0.0); NEIGHBOURS];
    match number {
        0 => {}
        1 => stencil[0] = (0, 1.0),
        _ => (stencil[0], stencil[1]) = ((number - 1, 2.0), (number - 2, -1.0)),
    }
    stencil
}

/// Values of the drive in the order of the visit, outward from zero on both sides.
struct Visited {
    values: Vec<f64>,
    /// Indices of the values above zero, and indices of the values below zero.
    sides: [Vec<usize>; 2],
}

impl Visited {
    fn side(value: f64) -> usize {
        usize::from(value < 0.0)
    }

    fn add(&mut self, value: f64) {
        self.sides[Self::side(value)].push(self.values.len());
        self.values.push(value);
    }

    /// Indices of the waypoints nearest to a value that is farther out than all waypoints on its side.
    fn nearest(&self, value: f64, count: usize) -> Vec<usize> {
        let own = &self.sides[Self::side(value)];
        let across = &self.sides[1 - Self::side(value)];
        let latest = own.iter().rev().take(count);
        let innermost = across.iter().take(count);
        let mut numbers: Vec<usize> = latest.chain(innermost).copied().chain([0]).collect();
        sort_by(&mut numbers, |a, b| {
            let distance = |i: &usize| (self.values[*i] - value).abs();
            distance(a).total_cmp(&distance(b)).then(a.cmp(b))
        });
        numbers.truncate(count);
        numbers
    }

    /// Returns the waypoints nearest to the drive value x = `value`, with their weights. The Lagrange weight of neighbour j
    /// is the product of (x - x_m)/(x_j - x_m) over all other neighbours m. `part` receives this weight and its derivative
    /// with respect to x, and selects one. `first` is the index of the waypoint at zero.
    fn stencil<const PLACES: usize>(
        &self,
        value: f64,
        first: usize,
        part: impl Fn(Jet<f64, 2>) -> f64,
    ) -> Stencil<PLACES> {
        let numbers = self.nearest(value, PLACES);
        let mut stencil = [(0, 0.0); PLACES];
        for (entry, j) in stencil.iter_mut().zip(&numbers) {
            let others = numbers.iter().filter(|m| *m != j);
            let product = others.fold(Jet([1.0, 0.0]), |product, m| {
                let from = self.values[*m];
                let width = self.values[*j] - from;
                product * Jet([(value - from) / width, 1.0 / width])
            });
            *entry = (first + *j, part(product));
        }
        stencil
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::array::from_fn;

    /// Stencils (weights) of n waypoints are exact for polynomials of degree n - 1.
    #[test]
    fn stencils_reproduce_polynomials() {
        let station_order = StationOrder::through(&from_fn::<f64, 9, _>(|k| 0.5 * k as f64 - 2.0));
        let route = Route::through(&station_order, [0.0; 3], 0.3, 1.0);
        let visited: Vec<f64> = route.places.iter().map(|p| p.value).collect();
        for (number, place) in route.places.iter().enumerate() {
            for degree in 0..number.min(NEIGHBOURS) as i32 {
                let sum = |stencil: &[(usize, f64)]| -> f64 {
                    let terms = stencil.iter();
                    terms.map(|(j, w)| w * visited[*j].powi(degree)).sum()
                };
                let value = place.value.powi(degree);
                assert!((sum(&place.prediction) - value).abs() < 1e-9);
                if let (Some(slope), true) = (&place.slope, degree < NEIGHBOURS_OF_SLOPE as i32) {
                    let wanted = f64::from(degree) * place.value.powi(degree - 1);
                    assert!((sum(slope) - wanted).abs() < 1e-9, "{number} {degree}");
                }
            }
        }
    }

    #[test]
    fn steps_are_equal_and_as_few_as_can_be() {
        assert_eq!(steps(0.0, 0.5, 1.0), Some(vec![0.5]));
        assert_eq!(steps(0.0, 1.0, 1.0), Some(vec![1.0]));
        assert_eq!(steps(1.0, 3.0, 0.6), Some(vec![1.5, 2.0, 2.5, 3.0]));
        assert_eq!(steps(-1.0, -2.0, 0.5), Some(vec![-1.5, -2.0]));
        assert_eq!(steps(0.0, 1e3, 1.0).map(|steps| steps.len()), Some(1000));
        assert_eq!(steps(0.0, 1e3, 0.999), None);
    }

    #[test]
    fn every_station_is_visited_once_and_long_steps_are_broken_up() {
        let station_order = StationOrder::through(&[-2.0, 0.0, 1.0, 0.1]);
        let route = Route::through(&station_order, [0.25, 0.0, 0.0], 0.5, 0.1);
        let mut stations: Vec<usize> = route.places.iter().filter_map(|p| p.station).collect();
        stations.sort_unstable();
        assert_eq!(stations, [0, 1, 2, 3]);
        let racks: Vec<f64> = route.places.iter().map(|p| p.rack).take(4).collect();
        assert_eq!(racks[0], 0.0);
        assert_eq!(racks[3], 0.25);
        assert_eq!(route.places[3].station, Some(1));
        assert!(route.places.iter().all(|p| p.step.abs() <= 0.5));
        assert!(route.is_complete);
        let incomplete = |values: &[f64], rack: f64| {
            let order = StationOrder::through(values);
            !Route::through(&order, [rack, 0.0, 0.0], 0.5, 1.0).is_complete
        };
        assert!(incomplete(&[1.0, 1.0], 0.0));
        // The route makes at most a thousand steps from one value to the next. It leaves out values that need more steps.
        assert!(!incomplete(&[499.9, -499.9], 999.0));
        assert!(incomplete(&[500.1], 0.0));
        assert!(incomplete(&[1.0], 1000.1));
        assert!(incomplete(&[1e12], 0.0));
        assert!(incomplete(&[1.0], 1e12));
    }
}

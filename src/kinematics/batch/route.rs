//! The way through the stations, and the weights by which each place is predicted from those before.
//!
//! Places are visited outward from the design position, up and down in turn, so that a prediction has
//! neighbours on both sides of the origin. It is the value at the new place of the polynomial through
//! the nearest places visited (Lagrange's form); the weights depend on the travels alone and are the same
//! for every design.

use crate::kinematics::March;

/// Places a prediction is made from.
const NEIGHBOURS: usize = 8;
/// Weights of places visited before, by their numbers; where there are fewer, the rest have none.
pub(super) type Stencil = [(usize, f64); NEIGHBOURS];

/// A place on the way.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// Value of the drive.
    pub value: f64,
    /// The station that lies here; none where a long step is broken up.
    pub station: Option<usize>,
    /// The side of the design position: 0 up, 1 down.
    pub side: usize,
    /// From the place before on this side.
    pub step: f64,
    /// Predicts the value here.
    pub prediction: Stencil,
}

/// The places in the order of the visit, the design position first.
#[derive(Clone, Debug)]
pub(super) struct Route {
    pub places: Vec<Place>,
}

impl Route {
    /// The way through the stations of a march in steps no longer than `longest`; `None` if two stations
    /// coincide.
    pub(super) fn through(march: &March, longest: f64) -> Option<Route> {
        let mut design_station = None;
        let mut places: Vec<(f64, Option<usize>, usize, f64)> = Vec::new();
        for (side, stations) in march.sides().into_iter().enumerate() {
            let mut before = 0.0;
            for &station in stations {
                let value = march.values()[station];
                if value == before {
                    if value != 0.0 || design_station.is_some() {
                        return None;
                    }
                    design_station = Some(station);
                    continue;
                }
                let pieces = ((value - before).abs() / longest).ceil().max(1.0);
                let step = (value - before) / pieces;
                let mut piece = 1.0;
                while piece < pieces {
                    places.push((before + step * piece, None, side, step));
                    piece += 1.0;
                }
                places.push((value, Some(station), side, step));
                before = value;
            }
        }
        places.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()).then(b.0.total_cmp(&a.0)));
        let mut visited = Vec::new();
        let design = (0.0, design_station, 0, 0.0);
        let places = std::iter::once(design)
            .chain(places)
            .map(|(value, station, side, step)| {
                let place = Place {
                    value,
                    station,
                    side,
                    step,
                    prediction: stencil(&visited, value),
                };
                visited.push(value);
                place
            })
            .collect();
        Some(Route { places })
    }
}

/// The `most` places nearest to a value.
fn nearest(visited: &[f64], value: f64, most: usize) -> Vec<usize> {
    let mut numbers: Vec<usize> = (0..visited.len()).collect();
    numbers.sort_by(|a, b| {
        let distance = |i: &usize| (visited[*i] - value).abs();
        distance(a).total_cmp(&distance(b)).then(a.cmp(b))
    });
    numbers.truncate(most);
    numbers
}

/// prod (x - x_m)/(x_j - x_m)
fn stencil(visited: &[f64], value: f64) -> Stencil {
    let numbers = nearest(visited, value, NEIGHBOURS);
    let mut stencil = [(0, 0.0); NEIGHBOURS];
    for (entry, j) in stencil.iter_mut().zip(&numbers) {
        let others = numbers.iter().filter(|m| *m != j);
        let weight = others.fold(1.0, |product, m| {
            product * (value - visited[*m]) / (visited[*j] - visited[*m])
        });
        *entry = (*j, weight);
    }
    stencil
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::array::from_fn;

    /// A stencil of n places is exact for polynomials of degree n - 1.
    #[test]
    fn stencils_reproduce_polynomials() {
        let march = March::through(&from_fn::<f64, 9, _>(|k| 0.5 * k as f64 - 2.0));
        let route = Route::through(&march, 0.3).unwrap();
        let visited: Vec<f64> = route.places.iter().map(|p| p.value).collect();
        for (number, place) in route.places.iter().enumerate() {
            for degree in 0..number.min(NEIGHBOURS) as i32 {
                let terms = place.prediction.iter();
                let sum: f64 = terms.map(|(j, w)| w * visited[*j].powi(degree)).sum();
                assert!((sum - place.value.powi(degree)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn every_station_is_visited_once_and_long_steps_are_broken_up() {
        let march = March::through(&[-2.0, 0.0, 1.0, 0.1]);
        let route = Route::through(&march, 0.5).unwrap();
        let mut stations: Vec<usize> = route.places.iter().filter_map(|p| p.station).collect();
        stations.sort_unstable();
        assert_eq!(stations, [0, 1, 2, 3]);
        assert!(route.places.iter().all(|p| p.step.abs() <= 0.5));
        assert!(Route::through(&March::through(&[1.0, 1.0]), 0.5).is_none());
    }
}

//! Pareto front of a sweep. A design is on the front if every other design is worse in at least one target.

use super::Failing;
use crate::sorting::sort_by_key;
use serde::{Deserialize, Serialize};

/// A design that the statistics keep, with its row of results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// Number of the design.
    pub design: u64,
    /// Values of the variables of the design.
    #[serde(with = "super::or_null")]
    pub variables: Vec<f64>,
    /// Outputs of the design. NaN if a value does not exist.
    #[serde(with = "super::or_null")]
    pub outputs: Vec<f64>,
    /// Reason why some station was not solved. `None` if all stations were solved.
    pub failing: Option<Failing>,
}

/// Designs of the Pareto front. No design of the Pareto front is at least as good as another design of the front in every
/// target.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<Candidate>", into = "Vec<Candidate>")]
pub struct Front {
    designs: Vec<Candidate>,
}

/// Converts the Pareto front to a list of candidates, in the order of their design numbers.
impl From<Front> for Vec<Candidate> {
    fn from(front: Front) -> Self {
        front.sorted().into_iter().cloned().collect()
    }
}

impl From<Vec<Candidate>> for Front {
    fn from(designs: Vec<Candidate>) -> Self {
        Front { designs }
    }
}

impl Front {
    /// Adds a design with its outputs. Does not add it if a design on the Pareto front is at least as good for every target.
    /// `deviations` are the indices of the outputs to minimise. Removes designs that are then no longer on the Pareto front. If
    /// the caller offers designs in the order of their numbers, the first of several equal designs stays.
    pub fn offer(
        &mut self,
        deviations: &[usize],
        outputs: &[f64],
        candidate: impl FnOnce() -> Candidate,
    ) {
        let at_least_as_good = |a: &[f64], b: &[f64]| deviations.iter().all(|k| a[*k] <= b[*k]);
        let known = |c: &Candidate| at_least_as_good(&c.outputs, outputs);
        if let Some(better) = self.designs.iter().position(known) {
            // A design that is better than one candidate of the front is often also better than the next new design. So
            // the next comparison begins with this candidate.
            self.designs.swap(0, better);
            return;
        }
        self.designs
            .retain(|c| !at_least_as_good(outputs, &c.outputs));
        self.designs.push(candidate());
    }

    /// Designs in the order of their numbers.
    pub fn sorted(&self) -> Vec<&Candidate> {
        let mut designs: Vec<&Candidate> = self.designs.iter().collect();
        sort_by_key(&mut designs, |c| c.design);
        designs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::uniform;

    /// For three ways to divide the designs into parts, the result satisfies the definition of a Pareto front.
    #[test]
    fn the_front_is_what_no_other_design_betters() {
        // Points near a plane on which every improvement in one target worsens another target. Some points are repeated.
        let point = |i: u64| {
            let whole = |k: usize, most: f64| (uniform(i, k, 9) * most).floor();
            let (a, b) = (whole(0, 12.0), whole(1, 12.0));
            vec![a, b, 24.0 - a - b + whole(2, 3.0)]
        };
        let points: Vec<Vec<f64>> = (0..500).map(point).collect();
        let worse = |i: usize| {
            points.iter().enumerate().any(|(j, other)| {
                let as_good = other.iter().zip(&points[i]).all(|(a, b)| a <= b);
                as_good && (other != &points[i] || j < i)
            })
        };
        let expected: Vec<u64> = (0..500).filter(|i| !worse(*i)).map(|i| i as u64).collect();
        assert!((20..200).contains(&expected.len()));
        for part in [1, 64, 500] {
            let mut front = Front::default();
            for start in (0..500).step_by(part) {
                let mut own = Front::default();
                for (i, point) in points.iter().enumerate().skip(start).take(part) {
                    own.offer(&[0, 1, 2], point, || Candidate {
                        design: i as u64,
                        variables: Vec::new(),
                        outputs: point.clone(),
                        failing: None,
                    });
                }
                for c in own.sorted() {
                    front.offer(&[0, 1, 2], &c.outputs, || c.clone());
                }
            }
            let found: Vec<u64> = front.sorted().iter().map(|c| c.design).collect();
            assert_eq!(found, expected);
        }
    }
}

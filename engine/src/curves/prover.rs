//! Certified bounds of poses, converted to lengths for users.

use super::Proof;
use crate::analyse::{Certificate, Certifier};
use crate::model::{Body, Suspension};

/// Certifies the poses of one suspension.
pub(crate) struct Prover<'a> {
    pub(crate) certifier: Certifier<'a>,
    /// Largest distance of a point of the wheel carrier from the carrier's origin.
    lever: f64,
    /// Largest rounding error of a point that is computed from a pose.
    rounding: f64,
}

impl<'a> Prover<'a> {
    pub(crate) fn new(suspension: &'a Suspension) -> Self {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let origin = design[mechanism.origin.0];
        let points = mechanism.points.iter().zip(design);
        let levers = points
            .filter(|(point, _)| point.body == Body::Knuckle)
            .map(|(_, at)| (*at - origin).norm());
        let farthest = design.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let lever = levers.fold(0.0, f64::max);
        Prover {
            certifier: Certifier::new(mechanism, design),
            lever,
            // A point with the lever b has the position p = o + R b, with the carrier's origin o and rotation R. The rounding of b,
            // and of three products and three sums in each component, gives an error below eps (4.2 |b| + 0.9 |p|). |p| is below
            // |o| + |b|.
            rounding: 8.0 * f64::EPSILON * (farthest + lever),
        }
    }

    pub(crate) fn proof(&self, certificate: &Certificate) -> Proof {
        let position_error = self.position_error(certificate);
        let uniqueness = certificate.uniqueness;
        Proof {
            position_error,
            uniqueness,
            bounds: vec![position_error, uniqueness],
        }
    }

    /// Bound on the distance of any point of the wheel carrier from its exact position.
    pub(crate) fn position_error(&self, certificate: &Certificate) -> f64 {
        certificate.point_error(self.lever) + self.rounding
    }
}

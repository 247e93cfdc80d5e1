//! Closure equations as Taylor series along the travel, for gradients of quantities that contain velocities.

use super::LaneRates;
use super::linkage::{ByLinkage, SeriesAdjoint};
use crate::mechanism::{Closure, Configuration, Pose, Twist};
use crate::model::{Drive, Mechanism};
use crate::number::{Jet, Matrix3, SimdReal, Vector3};

/// Computes gradients of quantities that contain velocities, with the closure equations as Taylor series along the travel.
#[derive(Clone, Debug)]
pub(crate) struct AlongTravel(pub(super) ByLinkage);

/// Designs, one in each SIMD lane, as Taylor series along the travel. Only the constant terms are not zero.
pub(crate) struct SeriesDesign<B> {
    design: Vec<Vector3<Jet<B, 2>>>,
    closure: Closure<Jet<B, 2>>,
}

impl AlongTravel {
    /// Prepares for designs of this mechanism near the design `base`, driven by the travel. `None` if they cannot be
    /// tracked.
    pub(crate) fn of(mechanism: &Mechanism, base: &[Vector3<f64>]) -> Option<Self> {
        ByLinkage::of(mechanism, base, Drive::Travel, mechanism.size(base)).map(AlongTravel)
    }

    /// Makes the designs as Taylor series.
    #[inline(always)]
    pub(crate) fn design<B: SimdReal>(
        &self,
        mechanism: &Mechanism,
        design: &[Vector3<B>],
    ) -> SeriesDesign<B> {
        let mut series = Vec::with_capacity(design.len());
        for point in design {
            series.push(point.with_rate(point.zero()));
        }
        SeriesDesign {
            closure: Closure::new(mechanism, &series),
            design: series,
        }
    }

    /// Prepares gradients at a configuration from [`SeriesDesign::along`].
    #[inline(always)]
    pub(crate) fn adjoint<'p, B: SimdReal>(
        &self,
        design: &'p SeriesDesign<B>,
        at: &'p Configuration<'p, Jet<B, 2>>,
    ) -> SeriesAdjoint<'p, B> {
        self.0.series_adjoint(&design.closure, at)
    }
}

impl<B: SimdReal> SeriesDesign<B> {
    /// The configuration as a first-order Taylor series along the travel, from the rates of the knuckle.
    #[inline(always)]
    pub(crate) fn along<'p>(
        &'p self,
        at: &Configuration<'p, B>,
        rates: &LaneRates<B>,
    ) -> Configuration<'p, Jet<B, 2>> {
        let Twist { shift, turn } = rates.twist();
        let [x, y, z] = at.pose.rotation.columns;
        let zero = at.rack.zero();
        Configuration {
            mechanism: at.mechanism,
            design: &self.design,
            pose: Pose {
                origin: at.pose.origin.with_rate(shift),
                rotation: Matrix3 {
                    columns: [
                        x.with_rate(turn.cross(x)),
                        y.with_rate(turn.cross(y)),
                        z.with_rate(turn.cross(z)),
                    ],
                },
            },
            rack: Jet([at.rack, zero]),
            steering: None,
        }
    }
}

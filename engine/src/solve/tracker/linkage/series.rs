//! Gradients as Taylor series along the travel. They are computed from the closure equations as Taylor series.

use super::ByLinkage;
use super::blocks::Blocks;
use crate::derive::sensitivity::HardpointGradient;
use crate::mechanism::{Closure, Configuration, Driver, RowSet, Wrench};
use crate::number::Real;
use crate::number::{Jet, Outlined, SimdReal, Vector3};

/// Computes gradients as Taylor series along the travel, from the closure equations as Taylor series.
pub(crate) struct SeriesAdjoint<'p, B> {
    closure: &'p Closure<Jet<B, 2>>,
    at: &'p Configuration<'p, Jet<B, 2>>,
    blocks: Blocks<Jet<B, 2>>,
}

impl<B: SimdReal> SeriesAdjoint<'_, B> {
    /// Subtracts the effect of the closure equations like [`LaneAdjoint::subtract`], for series along the travel.
    #[inline(always)]
    pub(crate) fn subtract(&self, wrench: &Wrench<Jet<B, 2>>, gradient: &mut [Vector3<Jet<B, 2>>]) {
        self.at.rack.0[0].outlined(SubtractingSeries {
            adjoint: self,
            wrench,
            gradient,
        });
    }
}

/// Computes the Jacobian of the closure equations as a Taylor series in the travel, and prepares its inverse. A separate function
/// (see `Outlined`) keeps this code out of its callers.
struct FormingSeries<'p, B> {
    closure: &'p Closure<Jet<B, 2>>,
    at: &'p Configuration<'p, Jet<B, 2>>,
    blocks: &'p mut Blocks<Jet<B, 2>>,
}

impl<B: SimdReal> Outlined for FormingSeries<'_, B> {
    type Output = ();

    #[inline(always)]
    fn work(self) {
        // The rows of the Jacobian do not depend on the value of the travel.
        let driver = Driver::Travel(self.at.rack.zero());
        for number in 0..6 {
            let (_, wrench) = self.closure.row(number, self.at, driver);
            self.blocks.put(number, &wrench);
        }
        self.blocks.eliminate();
    }
}

/// Subtracts from a gradient the effect of the closure equations. The work is in a separate function (see `Outlined`).
struct SubtractingSeries<'p, B> {
    adjoint: &'p SeriesAdjoint<'p, B>,
    wrench: &'p Wrench<Jet<B, 2>>,
    gradient: &'p mut [Vector3<Jet<B, 2>>],
}

impl<B: SimdReal> Outlined for SubtractingSeries<'_, B> {
    type Output = ();

    #[inline(always)]
    fn work(self) {
        let SeriesAdjoint {
            closure,
            at,
            blocks,
        } = self.adjoint;
        let mut multipliers = blocks.solve_transposed(self.wrench);
        for multiplier in &mut multipliers {
            *multiplier = -*multiplier;
        }
        let driver = Driver::Travel(at.rack.zero());
        let mut sink = HardpointGradient(self.gradient);
        closure.differential_inlined(RowSet::ALL, at, driver, &multipliers, &mut sink);
    }
}

impl ByLinkage {
    /// Makes the [`SeriesAdjoint`] for a configuration that is a series along the travel.
    #[inline(always)]
    pub(crate) fn series_adjoint<'p, B: SimdReal>(
        &self,
        closure: &'p Closure<Jet<B, 2>>,
        at: &'p Configuration<'p, Jet<B, 2>>,
    ) -> SeriesAdjoint<'p, B> {
        let like = at.rack.0[0];
        let mut blocks = Blocks::unformed(self.order, at.rack.constant(1.0 / self.size));
        like.outlined(FormingSeries {
            closure,
            at,
            blocks: &mut blocks,
        });
        SeriesAdjoint {
            closure,
            at,
            blocks,
        }
    }
}

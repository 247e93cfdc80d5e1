//! Closure equations linearised about a configuration.

use super::blocks::Blocks;
use super::{ByLinkage, LinkageDesign};
use crate::mechanism::{Configuration, Driver, Twist};
use crate::number::{Outlined, SimdReal};

/// Closure equations linearised about a configuration.
pub(super) struct Linear<B> {
    pub(super) residuals: [B; 6],
    /// Derivatives of the closure equations with respect to the displacement of the rack.
    by_rack: [B; 6],
    pub(super) blocks: Blocks<B>,
}

/// Computes [`Linear`] in a separate function (see `Outlined`).
pub(super) struct Linearising<'p, 'd, B> {
    pub(super) linkage: &'p LinkageDesign<'d, B>,
    pub(super) at: &'p Configuration<'d, B>,
    pub(super) travel: B,
    pub(super) linear: &'p mut Linear<B>,
}

impl<B: SimdReal> Outlined for Linearising<'_, '_, B> {
    type Output = ();

    #[inline(always)]
    fn work(self) {
        let driver = Driver::Travel(self.travel);
        let linear = self.linear;
        for number in 0..6 {
            let (residual, wrench) = self.linkage.closure.row(number, self.at, driver);
            linear.residuals[number] = residual;
            linear.by_rack[number] = wrench.rack;
            linear.blocks.put(number, &wrench);
        }
        linear.blocks.eliminate();
    }
}

impl<B: SimdReal> Linear<B> {
    /// Makes equations whose numbers are all zero. [`Linearising`] must compute the numbers before use.
    #[inline(always)]
    pub(super) fn unformed(method: &ByLinkage, like: B) -> Self {
        let zero = like.zero();
        Linear {
            residuals: [zero; 6],
            by_rack: [zero; 6],
            blocks: Blocks::unformed(method.order, like.constant(1.0 / method.size)),
        }
    }

    /// The twist of the knuckle per unit of travel.
    #[inline(always)]
    pub(super) fn by_travel(&self) -> Twist<B> {
        let mut driven = [self.residuals[0].zero(); 6];
        driven[5] = driven[5].one();
        self.blocks.solve(driven)
    }

    /// The twist of the knuckle per unit of rack displacement.
    #[inline(always)]
    pub(super) fn steering(&self) -> Twist<B> {
        -self.blocks.solve(self.by_rack)
    }
}

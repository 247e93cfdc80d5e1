//! A wheel along a motion. The values of the wheel are series in the parameter of the motion.

use super::reading::WheelParts;
use crate::characteristics::{DesignWheel, NumberPart, VectorPart};
use crate::number::{Jet, Real, Vector3};

/// A wheel that moves. Each value is computed when it is needed.
#[derive(Debug)]
pub struct Moving<'w, W, T> {
    pub(super) of: &'w W,
    pub(super) travel: T,
    pub(super) rack: Option<T>,
}

impl<W, T: Copy> Clone for Moving<'_, W, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<W, T: Copy> Copy for Moving<'_, W, T> {}

impl<T: Real, W: WheelParts<T>> Moving<'_, W, T> {
    /// Makes the series of a vector along the motion, from the coefficients of the vector in travel and rack. `of` returns
    /// the coefficient with the given powers of travel and rack.
    #[inline(always)]
    fn vector_series(
        &self,
        [i, j]: [usize; 2],
        of: impl Fn([usize; 2]) -> Vector3<T>,
    ) -> Vector3<Jet<T, 2>> {
        let mut rate = of([i + 1, j]).map(|c| c.scaled((i + 1) as f64) * self.travel);
        if let Some(rack) = self.rack {
            rate = rate + of([i, j + 1]).map(|c| c.scaled((j + 1) as f64) * rack);
        }
        of([i, j]).with_rate(rate)
    }
}

impl<T: Real, W: WheelParts<T>> WheelParts<Jet<T, 2>> for Moving<'_, W, T> {
    #[inline(always)]
    fn like(&self) -> Jet<T, 2> {
        Jet::constant(self.travel)
    }

    #[inline(always)]
    fn read_vector(&self, part: VectorPart, powers: [usize; 2]) -> Vector3<Jet<T, 2>> {
        self.vector_series(powers, |powers| self.of.vector(part, powers))
    }

    #[inline(always)]
    fn number(&self, part: NumberPart, [i, j]: [usize; 2]) -> Jet<T, 2> {
        let Moving { of, travel, rack } = self;
        let mut rate = of.number(part, [i + 1, j]).scaled((i + 1) as f64) * *travel;
        if let Some(rack) = rack {
            rate = rate + of.number(part, [i, j + 1]).scaled((j + 1) as f64) * *rack;
        }
        Jet([of.number(part, [i, j]), rate])
    }

    #[inline(always)]
    fn column(&self, i: usize, powers: [usize; 2]) -> Vector3<Jet<T, 2>> {
        self.vector_series(powers, |powers| self.of.column(i, powers))
    }

    #[inline(always)]
    fn axle_column(&self, i: usize, powers: [usize; 2]) -> Vector3<Jet<T, 2>> {
        self.vector_series(powers, |powers| self.of.axle_column(i, powers))
    }

    #[inline(always)]
    fn design(&self) -> DesignWheel<Jet<T, 2>> {
        self.of.design().map(|value| Jet([value, value.zero()]))
    }
}

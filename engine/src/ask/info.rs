//! Entries of the catalogues.

use super::{Need, Unit};
use crate::characteristics::{Slot, Slots};

/// Catalogue entry of a quantity.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Info {
    /// Name in studies and column names.
    pub name: &'static str,
    /// Kind of number.
    pub unit: Unit,
    /// Meaning of a positive value.
    pub positive: &'static str,
    /// The formula in the notation of the manual.
    pub formula: &'static str,
    /// Source of the definition.
    pub source: &'static str,
    /// Inputs of the formula. An axle's formula also reads position and rotation of both carriers.
    pub reads: &'static [Slot],
    /// Figures and parts that the study must give.
    pub needs: &'static [Need],
    /// Highest order of the derivatives by the motion that the value itself is made of.
    pub rate_order: usize,
    /// True if the value is made of derivatives by the rack.
    pub by_rack: bool,
}

impl Info {
    /// An entry without content, from which others take the fields that they do not state.
    pub(crate) const EMPTY: Info = Info {
        name: "",
        unit: Unit::Ratio,
        positive: "",
        formula: "",
        source: "",
        reads: &[],
        needs: &[],
        rate_order: 0,
        by_rack: false,
    };

    /// The entry of a wheel's formula: its order of derivatives is 1 if it reads a velocity, else 0.
    pub(crate) const fn of_wheel(self) -> Info {
        let mut reads_rates = false;
        let mut k = 0;
        while k < self.reads.len() {
            reads_rates = reads_rates || self.reads[k].is_rate();
            k += 1;
        }
        Info {
            rate_order: reads_rates as usize,
            ..self
        }
    }

    /// Returns true if the formula reads velocities. The pose must then be known with its rates.
    #[inline]
    pub fn reads_rates(&self) -> bool {
        self.rate_order > 0
    }

    /// Returns true if the formula reads the steering axis.
    pub fn reads_steering_axis(&self) -> bool {
        Slots::default().with(self.reads).contain_steering_axis()
    }
}

//! Entries of the catalogues.

use super::{Need, Unit};
use crate::characteristics::{Slot, Slots};

/// Catalogue entry of a quantity.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Info {
    /// Name of the quantity in studies and column names.
    pub name: &'static str,
    /// Physical type of the quantity's value. It determines the unit.
    pub unit: Unit,
    /// Meaning of a positive value of the quantity.
    pub positive: &'static str,
    /// Formula of the quantity in the notation of the manual.
    pub formula: &'static str,
    /// Source of the quantity's definition: a standard, book or program, or the definition itself in words.
    pub source: &'static str,
    /// Inputs of the formula. A formula of an axle also has the positions and rotations of both carriers as inputs.
    pub reads: &'static [Slot],
    /// Inputs and parts that the study must give.
    pub needs: &'static [Need],
    /// Highest order of derivatives with respect to the motion that the formula needs.
    pub rate_order: usize,
    /// True if the value is computed from derivatives with respect to the rack.
    pub by_rack: bool,
}

impl Info {
    /// Empty entry with the default values of all fields.
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

    /// Returns the entry of a wheel's formula. The order of derivatives in the entry becomes 1 if the formula reads a velocity,
    /// else 0.
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

    /// Returns true if the formula reads velocities. It then needs the derivatives of the pose with respect to the motion.
    #[inline]
    pub fn reads_rates(&self) -> bool {
        self.rate_order > 0
    }

    /// Returns true if the formula reads the steering axis.
    pub fn reads_steering_axis(&self) -> bool {
        Slots::default().with(self.reads).contain_steering_axis()
    }
}

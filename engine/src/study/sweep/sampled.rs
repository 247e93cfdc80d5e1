//! Designs of a sweep that are samples of its variables.

use super::super::motion::evenly_spaced_at;
use super::super::{Sampled, Sampling, SweepVariable};
use crate::model::{LengthUnit, Suspension};

impl Sampling {
    pub(super) const ALL: [(&str, Sampling); 5] = [
        ("grid", Sampling::Grid),
        ("latin_hypercube", Sampling::LatinHypercube),
        ("sobol", Sampling::Sobol),
        ("random", Sampling::Random),
        ("saltelli", Sampling::Saltelli),
    ];

    /// Name of the method in studies.
    pub fn name(self) -> &'static str {
        Sampling::ALL[self as usize].0
    }
}

impl Sampled {
    /// Number of designs in the sweep.
    pub fn designs(&self) -> u64 {
        match self.method {
            Sampling::Saltelli => self.samples * (self.variables.len() as u64 + 2),
            _ => self.samples,
        }
    }

    /// Returns a copy with only the data that determine the designs. With some methods, the designs do not depend on the number
    /// of samples. The copy then has 0 samples.
    pub(crate) fn meaning(&self) -> Sampled {
        let samples = match self.method {
            Sampling::Sobol | Sampling::Random | Sampling::Saltelli => 0,
            Sampling::Grid | Sampling::LatinHypercube => self.samples,
        };
        Sampled {
            samples,
            ..self.clone()
        }
    }
}

impl SweepVariable {
    /// Name of the variable's column.
    pub fn column(&self, length_unit: LengthUnit) -> String {
        match &self.rate {
            Some(rate) => format!("{}_{}", self.name, rate.value_unit(length_unit)),
            None => format!("{}_{}", self.name, length_unit.symbol()),
        }
    }

    /// Returns true if both variables change the same coordinates by the same factors, or the same rate.
    pub(in crate::study) fn changes_same(&self, other: &SweepVariable) -> bool {
        let rate = |own: &SweepVariable| own.rate.map(|rate| rate.parameter);
        self.moves == other.moves && rate(self) == rate(other)
    }

    /// Value of the variable at the grid index `level`, counted from 0.
    pub fn level(&self, level: u64) -> f64 {
        let [low, high] = self.range;
        evenly_spaced_at(low, high, self.steps.unwrap_or(1), level)
    }

    /// Value of the variable in the study's own design: 0 for an offset, and the study's rate (or the factor 1) for a rate.
    /// `None` for a coordinate that several points share, because such a coordinate has no single value at the design.
    pub fn at_design(&self, suspension: &Suspension) -> Option<f64> {
        if let Some(rate) = &self.rate {
            return Some(rate.own_value());
        }
        if !self.absolute {
            return Some(0.0);
        }
        let [only] = self.moves[..] else {
            return None;
        };
        Some(only.value_at(suspension))
    }
}

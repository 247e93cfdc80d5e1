//! Assembly of builds of one wheel: changes the parts by random numbers, and assembles them.

use crate::assembly::{
    Alignment, Assembler, AssemblyError, BuildParameter, Built, Parts, SetUpError, TensionInput,
    Tensions, tension_inputs,
};
use crate::compliance::{AxleParameter, Parameter};
use crate::model::{Side, Suspension};
use crate::number::{Jet, Vector3};
use crate::study::{Source, Study, Tolerance};

/// Makes the builds of one wheel: changes its nominal parts by random numbers, and assembles them.
pub(super) struct WheelAssembler {
    /// Assembler of builds.
    pub(super) assembler: Assembler,
    pub(super) alignment: Option<Alignment>,
    /// For an axle: the wheel to which the parts belong.
    pub(super) side: Option<Side>,
    /// Tensions in the links of an axle whose parts do not fit without force. Empty for other suspensions.
    pub(super) tensions: Vec<TensionInput>,
}

impl WheelAssembler {
    /// Prepares builds of a wheel from its nominal design.
    pub(super) fn of(
        study: &Study,
        tolerance: &Tolerance,
        suspension: &Suspension,
        side: Option<Side>,
    ) -> Result<Self, SetUpError> {
        let both = study.axle().filter(|_| side.is_some());
        let assembler = match (both, side) {
            (Some(both), Some(side)) => Assembler::of_axle(&both.axle, side)?,
            _ => Assembler::new(suspension)?,
        };
        let alignment = match (tolerance.aligned, &study.setup) {
            (true, Some(setup)) => Some(Alignment::of(&setup.adjust, side, &assembler)?),
            _ => None,
        };
        Ok(WheelAssembler {
            assembler,
            alignment,
            side,
            tensions: both.map_or_else(Vec::new, |both| tension_inputs(&both.axle)),
        })
    }

    /// Wheel that an error message names. `None` for a single wheel, and for a rigid axle (solid axle or twist beam), which is
    /// assembled as a whole.
    pub(super) fn named_side(&self) -> Option<Side> {
        let mechanism = &self.assembler.suspension().mechanism;
        self.side.filter(|_| mechanism.rigid_axle.is_none())
    }

    /// Dimensions that a tolerance source changes in this wheel. Empty if the source belongs only to the other wheel.
    pub(super) fn changes<'s>(&self, source: &'s Source) -> &'s [(BuildParameter, f64)] {
        source.changes_in(self.side)
    }

    /// Dimensions that a tolerance source changes in this wheel, with the changes of the adjustments that keep the wheel
    /// aligned.
    pub(super) fn direction(&self, built: &Built, source: &Source) -> Vec<(BuildParameter, f64)> {
        let changes = self.changes(source);
        match &self.alignment {
            Some(alignment) if !changes.is_empty() => {
                alignment.aligned_direction(&self.assembler, built, changes)
            }
            _ => changes.to_vec(),
        }
    }

    /// Built design as a Taylor series along the sum of the directions of some tolerance sources, each scaled by its standard
    /// deviation.
    pub(super) fn series(&self, built: &Built, along: &[&Source]) -> Vec<Vector3<Jet<f64, 3>>> {
        let assembler = &self.assembler;
        let mechanism = &assembler.suspension().mechanism;
        let mut parts = assembler.drawn().map(Jet::<f64, 3>::constant);
        for source in along {
            let sigma = source.law.variance().sqrt();
            for (parameter, share) in self.changes(source) {
                parts.change(mechanism, *parameter, Jet([0.0, share * sigma, 0.0]));
            }
        }
        match &self.alignment {
            None => assembler.design_of(built, &parts, 2),
            Some(alignment) => alignment.design(assembler, built, &mut parts, 2),
        }
    }

    /// Changes the parts to the parts of a build, from its random numbers.
    pub(super) fn change_parts(
        &self,
        tolerance: &Tolerance,
        draws: &[f64],
        parts: &mut Parts<f64>,
    ) {
        let assembler = &self.assembler;
        parts.points.copy_from_slice(&assembler.drawn().points);
        parts.lengths.copy_from_slice(&assembler.drawn().lengths);
        parts.softness.copy_from_slice(&assembler.drawn().softness);
        for (source, z) in tolerance.each_source().zip(draws) {
            self.soften(source, *z, parts);
            for (parameter, share) in self.changes(source) {
                parts.change(&assembler.suspension().mechanism, *parameter, share * z);
            }
        }
    }

    /// Changes the softness (compliance) of a link whose stiffness scatters. Only an axle with extra links uses
    /// softnesses.
    fn soften(&self, source: &Source, z: f64, parts: &mut Parts<f64>) {
        let (Some(rate), false) = (&source.rate, self.tensions.is_empty()) else {
            return;
        };
        let Parameter::Link(number) = rate.parameter else {
            return;
        };
        // A link in the middle of the axle belongs to the left half.
        let of = AxleParameter {
            parameter: Parameter::LinkPreload(number),
            side: source.side.or(Some(Side::Left)),
        };
        let view = self.side.map_or(0, |side| side as usize);
        let own = self.tensions.iter().find(|own| own.parameter == of);
        if let Some(place) = own.map(|own| own.places[view]) {
            let ([nominal, _], [now, _]) = (rate.scattered(0.0), rate.scattered(z));
            parts.softness[place] = self.assembler.drawn().softness[place] * (nominal / now);
        }
    }

    /// Assembles parts and writes their built design. Returns the tensions that the parts cause in the links of an axle with
    /// extra links.
    pub(super) fn put_together(
        &self,
        parts: &mut Parts<f64>,
        into: &mut [Vector3<f64>],
    ) -> Result<Tensions, AssemblyError> {
        match &self.alignment {
            None => self.assembler.assemble(parts, 0.0, into),
            Some(alignment) => {
                alignment.assemble(&self.assembler, parts, into)?;
                Ok(None)
            }
        }
    }
}

//! Derivatives of the figures of an axle by its design.

use super::super::{KcTest, end_loads, quotient};
use super::{AxleKcRun, Here};
use crate::compliance::{AxleEquilibrium, AxleOnTape, Parameter, WheelFigures};
use crate::model::Side;
use crate::number::{Tape, Tracked};

/// Derivatives of a figure, and those of its secant; `None` where it has no value.
pub type FigureGradients = [Option<Vec<f64>>; 2];

impl AxleKcRun<'_> {
    /// Derivatives of the figures of a test at a station by inputs, in the order of its outcome. Hardpoints and parts of
    /// both wheels change together. `None` if the station has no equilibrium. `tape` is a work buffer.
    pub fn gradients(
        &self,
        travels: [f64; 2],
        rack: f64,
        test: &KcTest,
        parameters: &[Parameter],
        tape: &mut Tape,
    ) -> Option<Vec<FigureGradients>> {
        tape.clear();
        let tape = &*tape;
        let variant = (test.has_bar, test.locks_rack);
        let plain = self.here(variant, travels, rack).ok()?;
        let suspensions = self.vehicle.suspensions;
        let designs = suspensions.map(|wheel| &wheel.design[..]);
        let parts = self.parts_of(variant);
        let varied = AxleOnTape::new(suspensions, designs, &parts, parameters, tape).ok()?;
        let at = varied.carried(&plain.at)?;
        let secants = match test.load.is_motion() || test.levels == 0 {
            true => None,
            false => self.secants_on_tape(&plain, &varied, &at, test),
        };
        let mut here = Here {
            axle: varied.axle,
            at,
            tangents: [None, None],
        };
        let figures = self.figures(&mut here, test, secants);
        let values = figures
            .iter()
            .flat_map(|figure| [figure.value, figure.secant]);
        let values: Vec<_> = values.collect();
        let missing = Tracked::constant(f64::NAN);
        let results: Vec<_> = values
            .iter()
            .map(|value| value.unwrap_or(missing))
            .collect();
        let mut gradients = vec![[None, None]; figures.len()];
        tape.gradients(&results, parameters.len(), |number, by| {
            gradients[number / 2][number % 2] = values[number].map(|_| by.to_vec());
        });
        Some(gradients)
    }

    /// Secants over the window of a test, with the derivatives of its ends.
    fn secants_on_tape<'t>(
        &self,
        plain: &Here,
        varied: &AxleOnTape<'t>,
        at: &AxleEquilibrium<Tracked<'t>>,
        test: &KcTest,
    ) -> Option<[WheelFigures<Tracked<'t>>; 2]> {
        let (load, _) = test.unit_load(&self.vehicle.suspensions[0].vehicle);
        let end = |sign: f64| {
            let force = sign * test.window;
            let loads = test
                .factors()
                .map(|factor| end_loads(&load, force * factor));
            let axle = &plain.axle;
            let end = axle
                .loaded_about(&plain.at, &plain.at, &loads, test.held)
                .ok()?;
            let end = varied.carried_about(at, &end, test.held)?;
            Some(Side::ALL.map(|side| WheelFigures {
                vertical: varied.axle.wheel_load(&end, side),
                ..varied.axle.figures(&end, side)
            }))
        };
        let (low, high) = (end(-1.0)?, end(1.0)?);
        let inverse = Tracked::constant(1.0 / (2.0 * test.window));
        Some([0, 1].map(|k: usize| quotient(&low[k], &high[k], inverse)))
    }
}

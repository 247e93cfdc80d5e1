//! Derivatives of the figures of an axle by its design.

use super::super::{KcTest, quotient};
use super::{AxleKcRun, Conditions, Here};
use crate::compliance::{AxleOnTape, AxleParameter, Parameter, WheelFigures};
use crate::model::Side;
use crate::number::{Tape, Tracked};

/// Derivatives of a figure, and those of its secant; `None` without a value.
pub type FigureGradients = [Option<Vec<f64>>; 2];

impl AxleKcRun<'_> {
    /// Derivatives of the figures of a test at a station by inputs, in the order of the test's outcome. Hardpoints and parts
    /// of both wheels change together. `None` if the station has no equilibrium. `tape` is working memory.
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
        let plain = self.here(test.conditions(), travels, rack, [test]).ok()?;
        let inputs: Vec<AxleParameter> = parameters.iter().map(|p| (*p).into()).collect();
        let mut station = self.on_tape(test.conditions(), &plain, &inputs, tape)?;
        let secants = if test.load.is_motion() || test.levels == 0 {
            None
        } else {
            self.secants_on_tape(&plain, &station, test)
        };
        let figures = self.figures(&mut station, test, secants);
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

    /// Station over numbers on a tape. The inputs are the first numbers on the tape.
    pub(crate) fn on_tape<'t>(
        &self,
        conditions: Conditions,
        plain: &Here,
        parameters: &[AxleParameter],
        tape: &'t Tape,
    ) -> Option<Here<Tracked<'t>>> {
        let parts = self.parts_of(conditions);
        let suspensions = self.vehicle.suspensions;
        let varied = AxleOnTape::new(suspensions, self.designs(), &parts, parameters, tape).ok()?;
        let at = varied.carried(&plain.at)?;
        let links = plain.links.as_ref().and_then(|(_, alone)| {
            let links = varied.axle.on_its_links()?;
            let alone = links.carried_on_links(alone, &at)?;
            Some((links, alone))
        });
        Some(Here {
            links,
            ..Here::of(varied.axle, at)
        })
    }

    /// Secants over the window of a test, with the derivatives of the window's ends.
    pub(crate) fn secants_on_tape<'t>(
        &self,
        plain: &Here,
        station: &Here<Tracked<'t>>,
        test: &KcTest,
    ) -> Option<[WheelFigures<Tracked<'t>>; 2]> {
        let axle = &station.axle;
        let end = |sign: f64| {
            let end = self.end(plain, test, sign)?;
            let end = axle.carried_about(&station.at, &end, test.held)?;
            Some(Side::ALL.map(|side| WheelFigures {
                vertical: axle.wheel_load(&end, side),
                ..axle.figures(&end, side)
            }))
        };
        let (low, high) = (end(-1.0)?, end(1.0)?);
        let inverse = Tracked::constant(1.0 / (2.0 * test.window));
        Some([0, 1].map(|k: usize| quotient(&low[k], &high[k], inverse)))
    }
}

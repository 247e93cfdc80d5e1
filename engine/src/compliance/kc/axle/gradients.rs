//! Derivatives of an axle's test results with respect to its design.

use super::super::{KcTest, window_secant};
use super::{AxleKcRun, Conditions, Here};
use crate::compliance::{AxleOnTape, AxleParameter, Parameter, WheelFigures};
use crate::model::Side;
use crate::number::{Each, Tape, Tracked};

/// Derivatives of a test result and of its secant (mean slope over the test's window), in this order. `None` for a result
/// or a secant without a value.
pub type FigureGradients = [Option<Vec<f64>>; 2];

impl AxleKcRun<'_> {
    /// Returns the derivatives of the test results at a station with respect to inputs. The derivatives are in the same
    /// sequence as the results of each test. Hardpoints and parts of both wheels change together. Tests under the same
    /// conditions share one equilibrium, and one tape (a record of the operations, for adjoint differentiation). The
    /// rack displacement is along the study's +y. `None` if the station has no equilibrium or no tangent.
    pub fn gradients(
        &self,
        travels: [f64; 2],
        rack: f64,
        tests: &[KcTest],
        parameters: &[Parameter],
    ) -> Option<Vec<Vec<FigureGradients>>> {
        let inputs: Vec<AxleParameter> = parameters.iter().map(|p| (*p).into()).collect();
        let mut gradients = vec![Vec::new(); tests.len()];
        let mut rest: Vec<usize> = (0..tests.len()).collect();
        while let Some(first) = rest.first() {
            let conditions = tests[*first].conditions();
            let alike = |test: &usize| tests[*test].conditions() == conditions;
            let (own, others): (Vec<usize>, _) = rest.into_iter().partition(alike);
            rest = others;
            let tape = Tape::new();
            let own_tests = own.iter().map(|test| &tests[*test]);
            let along_kernel = self.along() * rack;
            let plain = self.here(conditions, travels, along_kernel, own_tests);
            let plain = plain.ok()?;
            let mut station = self.on_tape(conditions, &plain, &inputs, &tape)?;
            let mut places = Vec::new();
            let mut results = Vec::new();
            for number in &own {
                let figures = self.figures(&mut station, &tests[*number], None);
                gradients[*number] = vec![[None, None]; figures.len()];
                for (figure, of) in figures.iter().enumerate() {
                    places.extend(of.value.map(|_| [*number, figure]));
                    results.extend(of.value);
                }
            }
            tape.gradients(&results, parameters.len(), |result, by| {
                let [number, figure] = places[result];
                gradients[number][figure][0] = Some(by.to_vec());
            });
            for number in own {
                self.secant_gradients(
                    &plain,
                    &mut station,
                    &tests[number],
                    (&tape, parameters.len()),
                    &mut gradients[number],
                );
            }
        }
        Some(gradients)
    }

    /// Returns the derivatives of a test's secants (mean slopes over the test's window) with respect to the first
    /// `inputs` numbers on the tape. Afterwards the function removes both ends of the window from the tape. A tape with
    /// the ends of all tests would not fit into the processor's cache. The tangents of the station must have been
    /// computed before.
    fn secant_gradients<'t>(
        &self,
        plain: &Here,
        station: &mut Here<Tracked<'t>>,
        test: &KcTest,
        (tape, inputs): (&'t Tape, usize),
        gradients: &mut [FigureGradients],
    ) {
        if !test.has_levels() {
            return;
        }
        let (length, known) = (tape.len(), station.known_tangents());
        let secants = self.secants_on_tape(plain, station, test);
        let figures = self.figures(station, test, secants);
        let (places, results): (Vec<usize>, Vec<_>) = figures
            .iter()
            .enumerate()
            .filter_map(|(figure, of)| Some((figure, of.secant?)))
            .unzip();
        tape.gradients(&results, inputs, |result, by| {
            gradients[places[result]][1] = Some(by.to_vec());
        });
        assert_eq!(station.known_tangents(), known, "tangents stay on the tape");
        tape.truncate(length);
    }

    /// Computes a station with numbers on a tape. The inputs are the first numbers on the tape.
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

    /// Returns the secants (mean slopes) over the window of a test. They include the derivatives of the states at both
    /// ends of the window.
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
            Some(Side::ALL.each(|side| axle.figures_with_load(&end, side)))
        };
        let (low, high) = (end(-1.0)?, end(1.0)?);
        Some([0, 1].each(|k: usize| window_secant(test, &low[k], &high[k])))
    }
}

//! Test results and wheel angles at a station, and their derivatives with respect to the design, for tuning and
//! sensitivities.

use super::figures::{Figure, Read, Sheet};
use super::test::{KcTest, TestLoad};
use super::{KcRun, end_loads};
use crate::characteristics::{Characteristic, Inputs};
use crate::compliance::{
    Change, ElasticWheel, Equilibrium, HeldQuantity, NoEquilibrium, OnTape, Parameter, Tangent,
    WheelFigures, WheelLoads,
};
use crate::model::Axis;
use crate::number::{Each, Jet, Scalar, Tape, Tracked, Valued};

/// Value to compute at a station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KcValue {
    /// Result of a test.
    Figure {
        /// Test that gives the result.
        test: KcTest,
        /// Name of the result.
        quantity: &'static str,
        /// True for the secant (mean slope) over the test's window; false for the derivative at the station.
        is_secant: bool,
    },
    /// Characteristic of the wheel in the equilibrium.
    Wheel(Characteristic),
    /// Derivative of a characteristic with respect to wheel travel, in equilibrium.
    WheelRate(Characteristic),
}

/// Computes the values of one state. Each tangent is computed only once.
pub(super) struct Station<'s, T: Valued> {
    pub(super) wheel: &'s ElasticWheel<T>,
    pub(super) sheet: Sheet<'s>,
    pub(super) at: Equilibrium<T>,
    tangents: [Option<Option<Tangent<T>>>; 2],
    /// Inputs of characteristics with their derivatives with respect to wheel travel. The outer option is `None` until
    /// they are computed, the inner option if they do not exist.
    by_travel: Option<Option<Inputs<Jet<T, 2>>>>,
}

impl<'s, T: Scalar> Station<'s, T> {
    pub(super) fn new(wheel: &'s ElasticWheel<T>, sheet: Sheet<'s>, at: Equilibrium<T>) -> Self {
        Station {
            wheel,
            sheet,
            at,
            tangents: [None, None],
            by_travel: None,
        }
    }

    /// Returns the tangent of the state, with the quantity `held` fixed.
    pub(super) fn tangent(&mut self, held: HeldQuantity) -> Option<&Tangent<T>> {
        let (wheel, at) = (self.wheel, &self.at);
        let tangent = self.tangents[usize::from(held == HeldQuantity::WheelLoad)]
            .get_or_insert_with(|| wheel.tangent(at, held));
        tangent.as_ref()
    }

    /// Value of a characteristic in the state, or its derivative with respect to wheel travel.
    fn characteristic(&mut self, of: Characteristic, is_rate: bool) -> Option<T> {
        if !is_rate && !of.info().reads_rates() {
            let value = self.wheel.characteristic(&self.at, of);
            return value.value().is_finite().then_some(value);
        }
        if self.by_travel.is_none() {
            let wheel = self.wheel;
            let tangent = self.tangent(HeldQuantity::WheelHeight);
            let inputs = tangent.and_then(|tangent| wheel.inputs_by_travel(tangent));
            self.by_travel = Some(inputs);
        }
        let inputs = self.by_travel.as_ref()?.as_ref()?;
        ElasticWheel::of_inputs(inputs, of, is_rate)
    }

    /// Returns the values of the station; `None` for a value that does not exist. `secant` computes the secants (mean
    /// slopes) over the window of a test.
    fn values(
        &mut self,
        wanted: &[KcValue],
        mut secant: impl FnMut(&KcTest) -> Option<WheelFigures<T>>,
    ) -> Vec<Option<T>> {
        let mut known: Vec<(KcTest, bool, Vec<Figure<T>>)> = Vec::new();
        let mut read = |value: &KcValue| match *value {
            KcValue::Wheel(of) => self.characteristic(of, false),
            KcValue::WheelRate(of) => self.characteristic(of, true),
            KcValue::Figure {
                test,
                quantity,
                is_secant,
            } => {
                let same = |k: &(KcTest, bool, Vec<_>)| k.0 == test && k.1 == is_secant;
                if !known.iter().any(same) {
                    let all = if is_secant {
                        self.secants(&test, secant(&test))
                    } else {
                        self.figures(&test)
                    };
                    known.push((test, is_secant, all));
                }
                let (.., all) = known.iter().find(|k| same(k))?;
                all.iter().find(|f| f.quantity == quantity)?.value
            }
        };
        let values = wanted.iter().map(&mut read);
        let finite = |value: Option<T>| value.filter(|value| value.value().is_finite());
        values.map(finite).collect()
    }

    fn by(&mut self, test: &KcTest) -> Option<WheelFigures<T>> {
        let wheel = self.wheel;
        let like = wheel.travel(&self.at);
        let change = match test.change(&self.sheet.suspension.vehicle) {
            Change::Load(loads) => Change::Load(loads.map(|c| like.constant(c))),
            Change::Travel => Change::Travel,
            Change::Rack => Change::Rack,
        };
        wheel.figures_along(self.tangent(test.held)?, &change)
    }

    /// Collects the values from which the results of a test are computed. `by` contains the derivatives or secants.
    fn read(&mut self, test: &KcTest, by: Option<WheelFigures<T>>) -> Read<T> {
        let needs_rate = test.load == TestLoad::Heave && self.sheet.tyre_rate.is_some();
        let has_spring = test.load == TestLoad::Steering && self.wheel.spring(&self.at).is_some();
        Read {
            by,
            wheel_rate: needs_rate.then(|| self.wheel_rate()).flatten(),
            rack_force: has_spring.then(|| self.wheel.rack_force(&self.at)),
        }
    }

    /// Returns the results of a test at the station.
    pub(super) fn figures(&mut self, test: &KcTest) -> Vec<Figure<T>> {
        let by = self.by(test);
        let read = self.read(test, by);
        self.sheet.figures(test, &read)
    }

    /// Returns the results of a test, computed from the secants `by` instead of derivatives.
    pub(super) fn secants(&mut self, test: &KcTest, by: Option<WheelFigures<T>>) -> Vec<Figure<T>> {
        let read = self.read(test, by);
        self.sheet.figures(test, &read)
    }

    /// Returns the wheel rate at the contact point: wheel load per height of the contact point.
    fn wheel_rate(&mut self) -> Option<T> {
        let wheel = self.wheel;
        let like = wheel.travel(&self.at);
        let mut load = WheelLoads::none(like);
        load.contact.z = like.one();
        let tangent = self.tangent(HeldQuantity::WheelLoad)?;
        let by = wheel.figures_along(tangent, &Change::Load(load))?;
        Some(like.one() / by.contact.z)
    }
}

/// Value at a station, with its derivatives with respect to some inputs.
#[derive(Clone, Copy, Debug)]
pub struct KcGradient<'g> {
    /// Index of the value among the requested values.
    pub number: usize,
    /// Value of the test result or characteristic at the station; `None` if it does not exist.
    pub value: Option<f64>,
    /// Derivatives in the order of the inputs.
    pub by: &'g [f64],
}

impl KcRun<'_> {
    /// Computes values at a station with their derivatives with respect to inputs. A station is a travel and a rack
    /// displacement along the study's +y. The input [`Parameter::Rack`] is along the kernel's +y.
    pub fn gradients(
        &self,
        [travel, rack]: [f64; 2],
        wanted: &[KcValue],
        parameters: &[Parameter],
        receive: &mut dyn FnMut(KcGradient<'_>),
    ) -> Result<(), NoEquilibrium> {
        let tape = Tape::new();
        let along = self.suspension.frame.sign(Axis::Y);
        let at = self.wheel.at(travel, along * rack)?;
        let varied = OnTape::new(
            self.suspension,
            &self.design,
            &self.compliance,
            parameters,
            &tape,
        );
        let varied = varied.map_err(|fault| NoEquilibrium::without_model(fault.describe()))?;
        let here = varied.carried(&at);
        let here = here.ok_or_else(NoEquilibrium::without_derivatives)?;
        let mut station = Station::new(&varied.wheel, self.sheet(&at), here);
        let values = station.values(wanted, |test| {
            self.secant_on_tape(&at, &here, &varied, test)
        });
        let missing = Tracked::constant(f64::NAN);
        let results: Vec<_> = values
            .iter()
            .map(|value| value.unwrap_or(missing))
            .collect();
        tape.gradients(&results, parameters.len(), |number, by| {
            let value = values[number].map(Tracked::plain);
            receive(KcGradient { number, value, by });
        });
        Ok(())
    }

    /// Computes values at a station, which is a travel and a rack displacement along the study's +y. `None` for a value
    /// that does not exist.
    pub fn values(
        &self,
        [travel, rack]: [f64; 2],
        wanted: &[KcValue],
    ) -> Result<Vec<Option<f64>>, NoEquilibrium> {
        let along = self.suspension.frame.sign(Axis::Y);
        let at = self.wheel.at(travel, along * rack)?;
        Ok(self.values_at(&at, wanted, |_, _| None))
    }

    /// Computes values in an equilibrium without horizontal loads. `known` returns the equilibrium at the negative end
    /// (0) or at the positive end (1) of a test's window, if this equilibrium is already known.
    pub(crate) fn values_at(
        &self,
        at: &Equilibrium,
        wanted: &[KcValue],
        known: impl Fn(&KcTest, usize) -> Option<Equilibrium>,
    ) -> Vec<Option<f64>> {
        let mut station = Station::new(&self.wheel, self.sheet(at), *at);
        station.values(wanted, |test| self.window_secant(at, test, &known))
    }

    /// Returns the loads at both ends of a test's window. These loads act in addition to the loads of the station.
    pub(crate) fn window_loads(&self, test: &KcTest) -> [WheelLoads; 2] {
        let (unit, _) = test.unit_load(&self.suspension.vehicle);
        [-1.0, 1.0].each(|sign: f64| end_loads(&unit, sign * test.window))
    }

    /// Computes the secant (mean slope) over the window of a test.
    fn window_secant(
        &self,
        at: &Equilibrium,
        test: &KcTest,
        known: &impl Fn(&KcTest, usize) -> Option<Equilibrium>,
    ) -> Option<WheelFigures> {
        let loads = self.window_loads(test);
        let end = |k: usize| {
            let solved = || self.wheel.loaded_about(at, at, &loads[k], test.held).ok();
            let end = known(test, k).or_else(solved)?;
            Some(self.wheel.figures_with_load(&end))
        };
        Some(super::window_secant(test, &end(0)?, &end(1)?))
    }

    /// Computes the secant (mean slope) over the window of a test. It includes the derivatives of the states at both ends
    /// of the window.
    fn secant_on_tape<'t>(
        &self,
        at: &Equilibrium,
        here: &Equilibrium<Tracked<'t>>,
        varied: &OnTape<'t>,
        test: &KcTest,
    ) -> Option<WheelFigures<Tracked<'t>>> {
        let loads = self.window_loads(test);
        let end = |k: usize| {
            let end = self.wheel.loaded_about(at, at, &loads[k], test.held).ok()?;
            let end = varied.carried_about(here, &end, test.held)?;
            Some(varied.wheel.figures_with_load(&end))
        };
        Some(super::window_secant(test, &end(0)?, &end(1)?))
    }
}

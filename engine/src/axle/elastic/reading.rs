//! Quantities of an axle in an equilibrium, and their derivatives along motions and with respect to the design.
//!
//! With toe t, contact points C and vertical forces F at the wheels, each in the frame of its side,
//!
//! ```text
//! steer_l = -t_l,   steer_r = t_r,   mean_steer = (t_r - t_l)/2                                    (1)
//! track = C_l.y + C_r.y                                                                           (2)
//! ```
//!
//! A characteristic that contains velocities is computed along heave: both wheels rise together. A solid axle also has
//! a direction, a pitch and a displacement. Its roll centre is computed from equal and opposite travels.

use super::super::formulas::rigid::{pitch_of, steer_of};
use super::super::{Axle, AxleColumn, AxleKind, AxleQuantity, Motion, Quantity, WheelQuantity};
use super::TestFigure;
use crate::characteristics::{Characteristic, Inputs};
use crate::compliance::{
    AxleChange, AxleCompliance, AxleFigure, AxleKcRun, AxleParameter, AxlePlace, AxleVehicle,
    Conditions, ElasticAxle, HeldQuantity, Here, KcTest, NoEquilibrium, WheelFigures,
    not_of_equilibrium,
};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::number::{Each, Jet, Matrix3, Real, Scalar, Tape, Tracked, Valued, Vector3};
use crate::study::AxleComplianceStudy;

/// Returns the reason why this quantity is not available in an equilibrium of an axle of this kind, and what to use
/// instead. `None` if the quantity is available. If `is_derivative` is true, the function checks derivatives of the
/// quantity along a motion.
pub fn not_in_equilibrium(
    quantity: Quantity,
    kind: AxleKind,
    is_derivative: bool,
) -> Option<[&'static str; 2]> {
    use AxleQuantity as A;
    use WheelQuantity as W;
    const REMOVE: &str = "use a test result, or remove [compliance] to compute the rigid mechanism";
    let rigid = Some(["applies to the rigid mechanism only", REMOVE]);
    let once = if is_derivative {
        Some([
            "has no derivative along a motion with [compliance]",
            "expected order = \"position\"",
        ])
    } else {
        None
    };
    match quantity {
        Quantity::Corner(_, Characteristic::MotionRatio) => rigid,
        Quantity::Corner(_, of) if not_of_equilibrium(of).is_some() => rigid,
        Quantity::Corner(_, of) if of.info().reads_rates() => once,
        Quantity::Corner(_, Characteristic::SpringLength) => once,
        Quantity::Corner(..) => None,
        Quantity::Wheel(_, W::Steer | W::WheelLoad) => None,
        Quantity::Wheel(_, W::SpringForce) => once,
        Quantity::Wheel(..) => rigid,
        Quantity::Axle(
            A::MeanSteer | A::TotalToe | A::TotalToeAtRim | A::Track | A::TrackChange,
        ) => None,
        Quantity::Axle(A::BarTorque) => once,
        Quantity::Axle(A::AxleSteer | A::PinionAngle | A::AxleLateral | A::AxleLongitudinal) => {
            None
        }
        Quantity::Axle(A::RollCentreHeight | A::RollCentreLateral) if kind == AxleKind::Solid => {
            once
        }
        Quantity::Axle(_) => rigid,
        Quantity::Figure(_) => once,
    }
}

/// A quantity in an equilibrium, or its derivative along a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxleRead {
    pub quantity: Quantity,
    pub by: Option<Motion>,
}

impl From<Quantity> for AxleRead {
    fn from(quantity: Quantity) -> Self {
        AxleRead { quantity, by: None }
    }
}

impl AxleColumn {
    /// Returns the quantity in the column, or its first derivative. `None` for points, angular velocities and forces.
    pub(crate) fn read(&self) -> Option<AxleRead> {
        let (quantity, by) = (self.quantity()?, self.by);
        Some(AxleRead { quantity, by })
    }
}

/// Conditions for all quantities except test results: the anti-roll bar is connected, and the steering wheel is held.
const USUAL: Conditions = (true, false);

impl AxleRead {
    fn conditions(&self) -> Conditions {
        match self.quantity {
            Quantity::Figure(figure) => figure.test.conditions(),
            _ => USUAL,
        }
    }
}

/// Angles and positions of both wheels, with their derivatives along a motion.
struct Moving<T> {
    inputs: [Inputs<Jet<T, 2>>; 2],
    figures: [WheelFigures<T>; 2],
}

/// Computes quantities at one station, under the conditions of one kind of test.
struct Reader<'h, T: Valued> {
    here: &'h mut Here<T>,
    /// Rotation of a solid axle from its reference direction to its design position.
    home: Option<Matrix3<f64>>,
    known: Vec<(Motion, Option<Moving<T>>)>,
}

impl<T: Scalar> Reader<'_, T> {
    /// Returns the inputs of both wheels' formulas, with their derivatives along a motion. `None` if the axle cannot move
    /// along it.
    fn moving(&mut self, by: Motion) -> Option<&Moving<T>> {
        if !self.known.iter().any(|(known, _)| *known == by) {
            let found = self.along(by);
            self.known.push((by, found));
        }
        let found = self.known.iter().find(|(known, _)| *known == by);
        found?.1.as_ref()
    }

    /// Returns the changes of the travels or of the rack along a motion. `None` if the motion is not defined in an
    /// equilibrium.
    fn change(&self, by: Motion) -> Option<AxleChange<T>> {
        let zero = self.here.axle.travel(&self.here.at, Side::Left).zero();
        let one = zero.one();
        Some(match by {
            Motion::Heave => AxleChange::Travels([one, one]),
            Motion::TravelLeft => AxleChange::Travels([one, zero]),
            Motion::TravelRight => AxleChange::Travels([zero, one]),
            Motion::OpposedTravels => AxleChange::Travels([-one, one]),
            Motion::Rack | Motion::Steering => AxleChange::Rack,
            Motion::Roll => return None,
        })
    }

    fn along(&mut self, by: Motion) -> Option<Moving<T>> {
        let change = self.change(by)?;
        let (axle, tangent) = self.here.moving(HeldQuantity::WheelHeight)?;
        Some(Moving {
            inputs: axle.inputs_along(tangent, &change),
            figures: axle.figures_along(tangent, &change),
        })
    }

    /// Returns one number for each wheel. If a motion is given, the result also contains the derivatives along this
    /// motion.
    fn pair(
        &mut self,
        by: Option<Motion>,
        of: fn(&WheelFigures<T>) -> T,
    ) -> Option<[Jet<T, 2>; 2]> {
        let here = &self.here;
        let now = Side::ALL.each(|side| of(&here.axle.figures(&here.at, side)));
        let by = match by {
            None => now.each(|value| value.zero()),
            Some(by) => self.moving(by)?.figures.each_ref().each(of),
        };
        Some([Jet([now[0], by[0]]), Jet([now[1], by[1]])])
    }

    fn characteristic(&mut self, side: Side, of: Characteristic, by: Option<Motion>) -> Option<T> {
        if of.info().reads_rates() {
            let inputs = &self.moving(Motion::Heave)?.inputs[side as usize];
            return Some(of.evaluate(&inputs.with_rates()));
        }
        match by {
            None => Some(of.evaluate(&self.here.axle.inputs(&self.here.at, side))),
            Some(by) => Some(of.evaluate(&self.moving(by)?.inputs[side as usize])[1]),
        }
    }

    /// Sum of a characteristic over both wheels.
    fn both(&mut self, of: Characteristic, by: Option<Motion>) -> Option<T> {
        let left = self.characteristic(Side::Left, of, by)?;
        Some(left + self.characteristic(Side::Right, of, by)?)
    }

    /// Height and lateral position of a solid axle's roll centre.
    fn roll_centre(&mut self) -> Option<[T; 2]> {
        let at = self.here.at;
        let (axle, tangent) = self.here.moving(HeldQuantity::WheelHeight)?;
        axle.roll_centre(&at, tangent)
    }

    /// Computes a quantity of the body that carries both wheels, or its derivative along a motion.
    fn of_body(&mut self, of: AxleQuantity, by: Option<Motion>) -> Option<T> {
        match by {
            None => {
                let mut place = self.here.axle.place(&self.here.at)?;
                if let Some(home) = self.home {
                    place = place.counted_from(&home);
                }
                place_quantity(of, &place)
            }
            Some(by) => {
                let change = self.change(by)?;
                let (axle, tangent) = self.here.moving(HeldQuantity::WheelHeight)?;
                let place = axle.place_along(tangent, &change)?;
                Some(place_quantity(of, &place)?[1])
            }
        }
    }

    /// Computes a quantity that is not a test result.
    fn quantity(&mut self, read: &AxleRead) -> Option<T> {
        let AxleRead { quantity, by } = *read;
        let kind = if self.here.axle.is_joined() {
            AxleKind::Solid
        } else {
            AxleKind::Independent
        };
        if by.is_some() && not_in_equilibrium(quantity, kind, true).is_some() {
            return None;
        }
        let order = usize::from(by.is_some());
        let here = &self.here;
        match quantity {
            Quantity::Corner(side, of) => self.characteristic(side, of, by),
            Quantity::Wheel(side, WheelQuantity::Steer) => {
                let [left, right] = self.pair(by, |wheel| wheel.toe)?;
                Some(if side == Side::Left { -left } else { right }[order])
            }
            Quantity::Wheel(side, WheelQuantity::WheelLoad) => match by {
                None => Some(here.axle.wheel_load(&here.at, side)),
                Some(by) => Some(self.moving(by)?.figures[side as usize].vertical),
            },
            Quantity::Wheel(side, WheelQuantity::SpringForce) => {
                Some(here.axle.spring(&here.at, side)?.force)
            }
            Quantity::Axle(AxleQuantity::MeanSteer) => {
                let [left, right] = self.pair(by, |wheel| wheel.toe)?;
                Some((right - left).scaled(0.5)[order])
            }
            Quantity::Axle(AxleQuantity::TotalToe) => self.both(Characteristic::Toe, by),
            Quantity::Axle(AxleQuantity::TotalToeAtRim) => self.both(Characteristic::ToeAtRim, by),
            Quantity::Axle(AxleQuantity::Track) => {
                let [left, right] = self.pair(by, |wheel| wheel.contact.y)?;
                Some((left + right)[order])
            }
            Quantity::Axle(AxleQuantity::TrackChange) => {
                self.both(Characteristic::HalfTrackChange, by)
            }
            Quantity::Axle(AxleQuantity::BarTorque) => here.axle.bar_torque(&here.at),
            Quantity::Axle(AxleQuantity::RollCentreHeight) => Some(self.roll_centre()?[0]),
            Quantity::Axle(AxleQuantity::RollCentreLateral) => Some(self.roll_centre()?[1]),
            Quantity::Axle(of) => self.of_body(of, by),
            _ => None,
        }
    }
}

/// Computes a quantity from the pose of a solid axle.
fn place_quantity<T: Scalar>(of: AxleQuantity, place: &AxlePlace<T>) -> Option<T> {
    match of {
        AxleQuantity::AxleSteer => Some(steer_of(place.line)),
        AxleQuantity::PinionAngle => Some(pitch_of(place.forward)),
        AxleQuantity::AxleLateral => Some(place.middle.y),
        AxleQuantity::AxleLongitudinal => Some(place.middle.x),
        _ => None,
    }
}

/// Computes the wanted quantities of a station under one set of test conditions. `None` for missing values. `secants`
/// returns the secants over the window of a test (the range of its load).
fn read<T: Scalar>(
    run: &AxleKcRun<'_>,
    here: &mut Here<T>,
    wanted: &[AxleRead],
    home: Option<Matrix3<f64>>,
    mut secants: impl FnMut(&Here<T>, &KcTest) -> Option<[WheelFigures<T>; 2]>,
) -> Vec<Option<T>> {
    let mut known: Vec<(KcTest, bool, Vec<AxleFigure<T>>)> = Vec::new();
    let mut found = Vec::with_capacity(wanted.len());
    let mut reader = Reader {
        here,
        home,
        known: Vec::new(),
    };
    for read in wanted {
        let value = match read.quantity {
            Quantity::Figure(figure) => {
                let same =
                    |k: &(KcTest, bool, Vec<_>)| k.0 == figure.test && (k.1 || !figure.is_secant);
                if !known.iter().any(same) {
                    let over = if figure.is_secant {
                        secants(reader.here, &figure.test)
                    } else {
                        None
                    };
                    let all = run.figures(reader.here, &figure.test, over);
                    known.push((figure.test, figure.is_secant, all));
                }
                let all = known.iter().find(|k| same(k));
                all.and_then(|(.., all)| of(&figure, all))
            }
            _ => reader.quantity(read),
        };
        found.push(value.filter(|value| value.value().is_finite()));
    }
    found
}

fn of<T: Copy>(figure: &TestFigure, all: &[AxleFigure<T>]) -> Option<T> {
    let same = |own: &&AxleFigure<T>| own.quantity == figure.quantity && own.of == figure.of;
    let own = all.iter().find(same)?;
    if figure.is_secant {
        own.secant
    } else {
        own.value
    }
}

/// Returns the tests whose results are requested.
fn tests(wanted: &[AxleRead]) -> impl Iterator<Item = &KcTest> {
    wanted.iter().filter_map(|read| match &read.quantity {
        Quantity::Figure(figure) => Some(&figure.test),
        _ => None,
    })
}

/// Groups the indices of the values by test conditions. The usual conditions come first, because they decide whether
/// the station has an equilibrium.
fn by_conditions(wanted: &[AxleRead]) -> Vec<(Conditions, Vec<usize>)> {
    let mut groups = vec![(USUAL, Vec::new())];
    for (number, read) in wanted.iter().enumerate() {
        let conditions = read.conditions();
        match groups.iter_mut().find(|(of, _)| *of == conditions) {
            Some((_, numbers)) => numbers.push(number),
            None => groups.push((conditions, vec![number])),
        }
    }
    groups
}

/// An axle with elastic parts, prepared for the computation of stations.
pub(crate) struct Equilibria<'a> {
    run: AxleKcRun<'a>,
    /// Rotation of a solid axle from its reference direction to its design position. `None` if the design position is the
    /// reference.
    home: Option<Matrix3<f64>>,
}

impl Axle {
    /// Returns the data of both wheels for tests on a rig. The tyres have this rate (force per length).
    pub fn on_rig(&self, tyre_rate: Option<f64>) -> AxleVehicle<'_> {
        AxleVehicle {
            suspensions: Side::ALL.each(|side| self.suspension(side)),
            tyre_rate,
        }
    }

    /// Prepares the equilibria of the axle with its own hardpoints and elastic parts. Returns an error if the axle has
    /// no elastic model.
    pub(crate) fn own_equilibria(
        &self,
        elastic: &AxleComplianceStudy,
    ) -> Result<Equilibria<'_>, (Side, DesignFault)> {
        let designs = Side::ALL.each(|side| &self.suspension(side).design[..]);
        self.equilibria(designs, &elastic.parts)
    }

    /// Prepares the equilibria of the axle with its hardpoints at `designs` and these elastic parts. Returns an error
    /// if the axle has no elastic model.
    pub(crate) fn equilibria(
        &self,
        designs: [&[Vector3<f64>]; 2],
        parts: &AxleCompliance,
    ) -> Result<Equilibria<'_>, (Side, DesignFault)> {
        let vehicle = self.on_rig(self.elastic.as_ref().and_then(|own| own.tyre_rate));
        let run = AxleKcRun::of(vehicle, designs, parts).map_err(|fault| {
            let words = fault.describe();
            let side = fault.side.unwrap_or(Side::Left);
            (side, DesignFault::Elastic(words))
        })?;
        Ok(Equilibria { run, home: None })
    }
}

impl Equilibria<'_> {
    /// Sets the reference direction from which quantities of a solid axle are measured. `home` is the rotation from this direction
    /// to the design position. `None` makes the design position the reference.
    pub(crate) fn counted_from(self, home: Option<Matrix3<f64>>) -> Self {
        Equilibria { home, ..self }
    }

    /// Returns the rotation of a solid axle from its design position to an equilibrium. `None` for independent wheels.
    pub(crate) fn rotation(
        &self,
        at: ([f64; 2], f64),
    ) -> Result<Option<Matrix3<f64>>, NoEquilibrium> {
        let here = self.here(at)?;
        let place = here.axle.place(&here.at);
        Ok(place.map(|place| Matrix3 {
            columns: [place.forward, place.line, place.forward.cross(place.line)],
        }))
    }

    /// Returns the elastic model of the axle, with its anti-roll bar and steering.
    pub(in crate::axle) fn axle(&self) -> &ElasticAxle {
        self.run.axle()
    }

    /// Finds the equilibrium of the axle at given travels and a rack displacement towards the kernel's +y.
    pub(crate) fn here(&self, (travels, rack): ([f64; 2], f64)) -> Result<Here, NoEquilibrium> {
        self.run.here(USUAL, travels, rack, [])
    }

    /// Computes the values at given travels and a rack displacement towards the kernel's +y. `None` for missing values.
    pub(crate) fn values(
        &self,
        (travels, rack): ([f64; 2], f64),
        wanted: &[AxleRead],
    ) -> Result<Vec<Option<f64>>, NoEquilibrium> {
        let mut found = vec![None; wanted.len()];
        for (conditions, numbers) in by_conditions(wanted) {
            let own: Vec<AxleRead> = numbers.iter().map(|k| wanted[*k]).collect();
            let mut here = self.run.here(conditions, travels, rack, tests(&own))?;
            let values = read(&self.run, &mut here, &own, self.home, |here, test| {
                self.run.window_secants(here, test)
            });
            for (number, value) in numbers.into_iter().zip(values) {
                found[number] = value;
            }
        }
        Ok(found)
    }

    /// Computes the values at given travels and a rack displacement towards the kernel's +y, with their derivatives
    /// with respect to inputs. For each existing value, the function calls `receive` with the index, the value and its
    /// derivatives.
    pub(crate) fn gradients(
        &self,
        (travels, rack): ([f64; 2], f64),
        wanted: &[AxleRead],
        parameters: &[AxleParameter],
        receive: &mut dyn FnMut(usize, f64, &[f64]),
    ) -> Result<(), NoEquilibrium> {
        for (conditions, numbers) in by_conditions(wanted) {
            let own: Vec<AxleRead> = numbers.iter().map(|k| wanted[*k]).collect();
            let plain = self.run.here(conditions, travels, rack, tests(&own))?;
            if numbers.is_empty() {
                continue;
            }
            let tape = Tape::new();
            let station = self.run.on_tape(conditions, &plain, parameters, &tape);
            let mut station = station.ok_or_else(NoEquilibrium::without_derivatives)?;
            let values = read(&self.run, &mut station, &own, self.home, |station, test| {
                self.run.secants_on_tape(&plain, station, test)
            });
            let missing = Tracked::constant(f64::NAN);
            let results: Vec<_> = values.iter().map(|v| v.unwrap_or(missing)).collect();
            tape.gradients(&results, parameters.len(), |k, by| {
                if let Some(value) = values[k] {
                    receive(numbers[k], value.plain(), by);
                }
            });
        }
        Ok(())
    }
}

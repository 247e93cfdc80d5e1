//! Results of `kc` tests with the names and definitions of other programs.
//!
//! Adams Car and Altair MotionView define their results by the compliance matrix C of the two wheel centres, with free springs.
//! C(i,j) is displacement i by force or moment j. Both indices count from 1: x, y, z and rotations about them at the left wheel,
//! then the same at the right wheel. Here the axes are x rearward, y to the right, z up. For a single wheel, the terms of the other
//! wheel are 0. `slr` is the loaded radius, used as a vertical lever, which neglects camber. So the values differ from those of
//! hardpoint for the same test. By default, the tests of hardpoint hold the wheel height and apply the force at the lowest point of
//! the tilted disc.
//!
//! Let s = 1 for parallel and s = -1 for converging loads. Let r = i for the left and r = i + 6 for the right wheel. The results
//! contain the sum B(i,j) = C(r,j) + s C(r,j+6), in mm and N:
//!
//! ```text
//! MotionView   Lateral Force Steer             1000 (B(6,2) + B(6,4) slr) 180/pi   deg/kN        (1)
//!              Lateral Force Camber            1000 (B(4,2) + B(4,4) slr) 180/pi   deg/kN        (2)
//!              Lateral Force Deflection        1000 (B(2,2) + B(2,4) slr)          mm/kN         (3)
//!              Aligning Torque Steer           1E5 B(6,6) 180/pi                   deg/100 N m   (4)
//!              WC Longitudinal .. Steer        1000 B(6,1) 180/pi                  deg/kN        (5)
//!              TP Longitudinal .. Steer        1000 (B(6,1) - B(6,5) slr) 180/pi   deg/kN        (6)
//!              WC, TP Longitudinal Caster ..   (5) and (6) with row 5              deg/kN        (7)
//!              Ride Steer                      1000 B(6,3)/B(3,3) 180/pi           deg/m         (8)
//!              Ride Caster                     1000 B(5,3)/B(3,3) 180/pi           deg/m         (9)
//!              Ride Camber                     +-1000 B(4,3)/B(3,3) 180/pi         deg/m         (10)
//!              Wheel Rate                      1/B(3,3)                            N/mm          (11)
//!              Ride Rate                       (11) in series with the tyre's rate N/mm          (12)
//!              Roll Steer                      100 (C(r,3) - C(r,9)) track/dz, r = 6, 12   %     (13)
//!                                              dz = C(3,3) - C(3,9) - C(9,3) + C(9,9) + 2/tyre rate
//!              Suspension Roll Rate            track^2/dz pi/180/1000, no tyre     N m/deg       (14)
//! Adams Car    alt_steer_compliance            B(6,6) 180/pi                       deg/(N mm)    (15)
//!              alt_camber_compliance           B(4,6) 180/pi, of the left wheel    deg/(N mm)    (16)
//!              wheel_rate                      1/B(3,3)                            N/mm          (17)
//!              Camber Change                   +-B(4,3)/B(3,3) 180/pi              deg/mm        (18)
//!              Caster Change                   B(5,3)/B(3,3) 180/pi                deg/mm        (19)
//!              Percentage Roll Steer           mean of (13) of both wheels         %             (20)
//! ```
//!
//! The lower sign applies to the right wheel. `track` is the distance of the wheel centres.
//!
//! Sources: Altair MotionView reference, pages of these names; Adams Car, "Output of Suspension Analyses" and the appendix
//! "Static Vehicle Characteristics", pages of these names. MotionView prints the formulas for two orientations, A and B. In A, x
//! points rearward and y to the right. This follows from four facts in A. Camber is positive with the top outboard. The ride
//! camber of a left wheel is (10). Converging forces point to the inside. The tread widens by C(8,3) - C(2,3). B is turned by
//! half a turn about z, and its signs give the same values.

use crate::compliance::{KcSubject, KcTest, TestLoad, TestMode, TestPlace};
use crate::model::{Axis, Frame, FrameConvention, LengthUnit, Side};

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// A program whose names can be used in addition to the names of hardpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OtherProgram {
    /// Adams Car.
    Adams,
    /// Altair MotionView.
    Altair,
}

/// A result by another program's definition, with its name in that program.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OtherFigure {
    pub(super) name: String,
    pub(super) value: f64,
    pub(super) unit: &'static str,
}

/// Compliance matrix of a wheel or an axle at a station, with the units of its entries.
#[derive(Clone, Copy)]
pub(super) struct StationMatrix<'a> {
    /// Entries of the compliance matrix in the study's axes and length unit: six rows, or twelve for an axle.
    pub(super) matrix: &'a [Vec<f64>],
    pub(super) frame: Frame,
    pub(super) length: LengthUnit,
    /// Loaded radius of the wheel, in the study's length unit.
    pub(super) radius: f64,
    /// Rate of the tyre, in newtons per length unit.
    pub(super) tyre_rate: Option<f64>,
    /// Distance of both wheel centres across the vehicle, in the study's length unit. `None` for a single wheel.
    pub(super) centre_distance: Option<f64>,
}

/// Name, value and unit of a result by another program's definition.
type Defined = (&'static str, f64, &'static str);

impl StationMatrix<'_> {
    /// Millimetres per length unit of the study.
    fn mm(&self) -> f64 {
        1000.0 / self.length.per_metre()
    }

    /// Entry C(row, column) of the matrix of both wheels, with x rearward, y to the right, z up, in mm and N. Entries of a wheel
    /// that the study leaves out are 0.
    fn entry(&self, row: usize, column: usize) -> f64 {
        let (convention, side) = self.frame.meaning();
        let first = match (self.matrix.len(), side) {
            (6, Side::Right) => 6,
            _ => 0,
        };
        let place = |index: usize| (index - 1).checked_sub(first);
        let entry = |row: usize, column: usize| self.matrix.get(row)?.get(column).copied();
        let value = place(row)
            .zip(place(column))
            .and_then(|(row, column)| entry(row, column));
        // The study's frame and the frame of the formulas both belong to the whole vehicle. So they differ by a
        // rotation, not by a mirror image.
        let [own, rearward] =
            [convention, FrameConvention::XRear].map(|of| Frame::new(of, Side::Left));
        let sign = |index: usize| {
            let axis = Axis::ALL[(index - 1) % 3];
            own.sign(axis) * rearward.sign(axis)
        };
        let is_turn = |index: usize| (index - 1) % 6 >= 3;
        let row_unit = if is_turn(row) { 1.0 } else { self.mm() };
        // The matrix has results per moment of 1 N times the study's length unit. The formulas need results per 1 N mm.
        let column_unit = if is_turn(column) { self.mm() } else { 1.0 };
        value.unwrap_or(0.0) * sign(row) * sign(column) * row_unit / column_unit
    }

    /// Result by another program's definition, computed from the matrix. `None` if that program has no such result.
    pub(super) fn other(
        &self,
        program: OtherProgram,
        quantity: &str,
        (test, place): (&KcTest, TestPlace),
        of: KcSubject,
    ) -> Option<OtherFigure> {
        let sign = match (test.load.is_motion(), test.mode) {
            (true, _) | (false, TestMode::OneWheel | TestMode::Parallel) => 1.0,
            (false, TestMode::Opposed) => -1.0,
            (false, TestMode::Single(_)) => return None,
        };
        let side = match of {
            KcSubject::OneWheel => Some(self.frame.meaning().1),
            KcSubject::Wheel(side) => Some(side),
            KcSubject::Axle => None,
        };
        let (name, value, unit) = match side {
            Some(side) => {
                let wheel = LoadedWheel {
                    of: self,
                    side,
                    sign,
                };
                match program {
                    OtherProgram::Altair => wheel.altair(quantity, test, place),
                    OtherProgram::Adams => wheel.adams(quantity, test),
                }
            }
            None => self.of_axle(program, quantity, test),
        }?;
        let name = match (program, of) {
            (OtherProgram::Altair, KcSubject::Wheel(side)) => {
                format!("{} {}{name}", capital(side), wording(test, sign))
            }
            (OtherProgram::Adams, KcSubject::Wheel(side)) => {
                if name.contains('_') {
                    format!("{name}.{}", side.name())
                } else {
                    format!("{name}, {}", side.name())
                }
            }
            _ => name.to_owned(),
        };
        value
            .is_finite()
            .then_some(OtherFigure { name, value, unit })
    }

    /// Result of the axle as a whole by another program's definition. `None` if the program has no such result.
    fn of_axle(&self, program: OtherProgram, quantity: &str, test: &KcTest) -> Option<Defined> {
        let wheels = Side::ALL.map(|side| LoadedWheel {
            of: self,
            side,
            sign: 1.0,
        });
        let mean = |of: &dyn Fn(&LoadedWheel) -> Option<f64>| {
            Some(0.5 * (of(&wheels[0])? + of(&wheels[1])?))
        };
        match (program, quantity) {
            (OtherProgram::Altair, "axle_steer_by_lateral_force") if test.trail == 0.0 => {
                let value = mean(&|wheel| Some(wheel.by_side_force(6)))?;
                Some(("Average Parallel Lateral Force Steer", value, "deg/kN"))
            }
            (OtherProgram::Altair, "compliant_roll_stiffness") => {
                let track = self.centre_distance? * self.mm();
                let rate = track * track / self.roll_height() / DEGREES / 1000.0;
                Some(("Suspension Roll Rate", rate, "N-m/deg"))
            }
            (OtherProgram::Adams, "steer_by_roll") => Some((
                "Percentage Roll Steer",
                mean(&|wheel| wheel.roll_steer())?,
                "%",
            )),
            _ => None,
        }
    }

    /// Difference of the heights of both wheel centres in mm, caused by equal and opposite vertical forces of 1 N. It is dz of
    /// equation (13) of this module, without the tyres.
    fn roll_height(&self) -> f64 {
        self.entry(3, 3) - self.entry(3, 9) - self.entry(9, 3) + self.entry(9, 9)
    }
}

/// A wheel of an axle in a test with loads on both wheels.
struct LoadedWheel<'a> {
    of: &'a StationMatrix<'a>,
    side: Side,
    /// Load on the right wheel divided by the load on the left wheel, both along the same axis.
    sign: f64,
}

impl LoadedWheel<'_> {
    /// The sum B(row, column) = C(r, column) + s C(r, column + 6) that the head of this module defines.
    fn both(&self, row: usize, column: usize) -> f64 {
        let row = match self.side {
            Side::Left => row,
            Side::Right => row + 6,
        };
        self.of.entry(row, column) + self.sign * self.of.entry(row, column + 6)
    }

    /// Loaded radius of the wheel, in mm.
    fn radius(&self) -> f64 {
        self.of.radius * self.of.mm()
    }

    /// Rotation in degrees per kN, caused by a side force at the end of the vertical lever (at the ground): equations (1) and (2)
    /// of this module.
    fn by_side_force(&self, row: usize) -> f64 {
        1000.0 * (self.both(row, 2) + self.both(row, 4) * self.radius()) * DEGREES
    }

    /// Rotation in degrees per kN, caused by a longitudinal force at the wheel centre or at the end of the vertical lever (at the
    /// ground): equations (5) to (7) of this module.
    fn by_longitudinal_force(&self, row: usize, place: TestPlace) -> f64 {
        let lever = match place {
            TestPlace::ContactPoint => self.radius(),
            _ => 0.0,
        };
        1000.0 * (self.both(row, 1) - lever * self.both(row, 5)) * DEGREES
    }

    /// Rotation per height of the wheel centre, in degrees per mm, as in equations (8) to (10), (18) and (19) of this module.
    fn by_height(&self, row: usize) -> f64 {
        let sign = match (row, self.side) {
            (4, Side::Right) => -1.0,
            _ => 1.0,
        };
        sign * self.both(row, 3) / self.both(3, 3) * DEGREES
    }

    /// Roll steer of the wheel in percent: equation (13) of this module. `None` without a tyre's rate, and for one wheel.
    fn roll_steer(&self) -> Option<f64> {
        let (of, row) = (self.of, if self.side == Side::Left { 6 } else { 12 });
        let tyre = of.tyre_rate? / of.mm();
        let height = of.roll_height() + 2.0 / tyre;
        let track = of.centre_distance? * of.mm();
        Some(100.0 * (of.entry(row, 3) - of.entry(row, 9)) * track / height)
    }

    fn altair(&self, quantity: &str, test: &KcTest, place: TestPlace) -> Option<Defined> {
        let side_force = test.load == TestLoad::Lateral && test.trail == 0.0;
        let is_parallel = self.sign > 0.0;
        let at_centre = place == TestPlace::WheelCentre;
        let named = |at_centre_name, at_patch_name| {
            if at_centre {
                at_centre_name
            } else {
                at_patch_name
            }
        };
        let rate = 1.0 / self.both(3, 3);
        Some(match quantity {
            "toe_by_lateral_force" if side_force => {
                ("Lateral Force Steer", self.by_side_force(6), "deg/kN")
            }
            "camber_by_lateral_force" if side_force => {
                ("Lateral Force Camber", self.by_side_force(4), "deg/kN")
            }
            "wheel_centre_by_lateral_force" if side_force => {
                let deflection = 1000.0 * (self.both(2, 2) + self.both(2, 4) * self.radius());
                ("Lateral Force Deflection", deflection, "mm/kN")
            }
            "toe_by_aligning_moment" => {
                let steer = 1e5 * self.both(6, 6) * DEGREES;
                ("Aligning Torque Steer", steer, "deg/100N-m")
            }
            "toe_by_braking" | "toe_by_traction" if is_parallel => {
                let name = named(
                    "WC Longitudinal Compliance Steer",
                    "TP Longitudinal Compliance Steer",
                );
                (name, self.by_longitudinal_force(6, place), "deg/kN")
            }
            "spin_by_braking" | "spin_by_traction" if is_parallel => {
                let name = named(
                    "WC Longitudinal Caster Compliance",
                    "TP Longitudinal Caster Compliance",
                );
                (name, self.by_longitudinal_force(5, place), "deg/kN")
            }
            "toe_by_heave" => ("Wheel Ride Steer", 1000.0 * self.by_height(6), "deg/m"),
            "caster_by_heave" => ("Ride Caster", 1000.0 * self.by_height(5), "deg/m"),
            "camber_by_heave" => ("Wheel Ride Camber", 1000.0 * self.by_height(4), "deg/m"),
            "compliant_wheel_rate" if is_parallel => ("Wheel Rate", rate, "N/mm"),
            "compliant_ride_rate" if is_parallel && test.load == TestLoad::Vertical => {
                let tyre = self.of.tyre_rate? / self.of.mm();
                ("Ride Rate", rate * tyre / (rate + tyre), "N/mm")
            }
            "steer_by_roll" => ("Wheel Roll Steer", self.roll_steer()?, "%"),
            _ => return None,
        })
    }

    fn adams(&self, quantity: &str, test: &KcTest) -> Option<Defined> {
        if self.sign < 0.0 {
            return None;
        }
        let by_moment = |row: usize| self.both(row, 6) * DEGREES;
        Some(match quantity {
            "toe_by_aligning_moment" => ("alt_steer_compliance", by_moment(6), "deg/(N mm)"),
            // The published definition for the right wheel contradicts the definition for the left wheel.
            "camber_by_aligning_moment" if self.side == Side::Left => {
                ("alt_camber_compliance", by_moment(4), "deg/(N mm)")
            }
            "compliant_wheel_rate" if test.load == TestLoad::Vertical => {
                ("wheel_rate", 1.0 / self.both(3, 3), "N/mm")
            }
            "camber_by_heave" => ("Camber Change", self.by_height(4), "deg/mm"),
            "caster_by_heave" => ("Caster Change", self.by_height(5), "deg/mm"),
            _ => return None,
        })
    }
}

fn capital(side: Side) -> &'static str {
    match side {
        Side::Left => "Left",
        Side::Right => "Right",
    }
}

/// Words that MotionView puts between the wheel and the name of a result.
fn wording(test: &KcTest, sign: f64) -> &'static str {
    match (test.load, sign > 0.0) {
        (TestLoad::Lateral | TestLoad::Aligning, true) => "Parallel ",
        (TestLoad::Lateral | TestLoad::Aligning, false) => "Converging ",
        _ => "",
    }
}

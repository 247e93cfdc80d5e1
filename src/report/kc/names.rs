//! Results of `kc` tests with the names and definitions of other programs.
//!
//! Both programs define their compliances by the matrix C, with free springs. C gives displacements (x, y, z) of the wheel centre
//! and rotations about x, y and z, by forces and moments at the wheel centre. The indices of C(i,j) count from 1. A side force
//! acts on a vertical lever, `slr`, the loaded radius; the lever neglects camber. So these values differ from ours for the same
//! test. Our tests hold the height by default, and apply the force at the lowest point of the tilted disc.
//!
//! ```text
//! MotionView   Lateral Force Steer        1000 (C(6,2) + C(6,4) slr) 180/pi   deg/kN
//!              Lateral Force Camber       1000 (C(4,2) + C(4,4) slr) 180/pi   deg/kN
//!              Lateral Force Deflection   1000 (C(2,2) + C(2,4) slr)          mm/kN
//!              Aligning Torque Steer      1E5 C(6,6) 180/pi                   deg/100 N m
//! Adams Car    alt_steer_compliance       C(6,6) 180/pi                       deg/(N mm)
//!              alt_camber_compliance      C(4,6) 180/pi, of the left wheel    deg/(N mm)
//!              wheel_rate                 1/C(3,3)                            N/mm
//! ```
//!
//! Terms of the other wheel vanish for a single wheel. All lengths are in mm. Steer is positive to the left, camber is positive
//! with the top outboard, and a positive aligning torque steers to the left.

use crate::compliance::{KcTest, TestLoad};
use crate::model::{Axis, Frame, LengthUnit, Side};

/// A program whose names are used beside ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OtherProgram {
    /// Adams Car.
    Adams,
    /// Altair MotionView.
    Altair,
}

/// A result by another program's definition.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OtherFigure {
    pub(super) name: &'static str,
    pub(super) value: f64,
    pub(super) unit: &'static str,
}

/// Matrix of a wheel at a station, with the units of its entries.
pub(super) struct StationMatrix<'a> {
    /// Entries in the study's axes and length unit.
    pub(super) matrix: &'a [Vec<f64>],
    pub(super) frame: Frame,
    pub(super) length: LengthUnit,
    /// Loaded radius of the wheel.
    pub(super) radius: f64,
}

impl StationMatrix<'_> {
    /// Entry of the matrix, with indices from 1, in ISO 8855 axes (x forward, y left), mm and N. Rotations about x and
    /// displacements along y by forces along y have the same sign in axes with x rearward and y right.
    fn entry(&self, row: usize, column: usize) -> f64 {
        let sign = |k: usize| {
            let axis = Axis::ALL[k % 3];
            // The axes are those of the vehicle: a right wheel is not mirrored.
            let y = if self.frame.meaning().1 == Side::Right {
                -1.0
            } else {
                1.0
            };
            let mirrored = match (axis, k < 3) {
                (Axis::Y, true) => y,
                (Axis::Y, false) => 1.0,
                (_, true) => 1.0,
                (_, false) => y,
            };
            let own = if k < 3 {
                self.frame.sign(axis)
            } else {
                self.frame.turn_sign(axis)
            };
            own * mirrored
        };
        let mm = 1000.0 / self.length.per_metre();
        let size = |k: usize| if k < 3 { mm } else { 1.0 };
        let (row, column) = (row - 1, column - 1);
        // Displacements scale with mm. A moment of 1 N mm is smaller than 1 N times the length unit, by the number of mm in that
        // unit.
        let by = if column < 3 { 1.0 } else { mm };
        self.matrix[row][column] * sign(row) * sign(column) * size(row) / by
    }

    /// Result by another program's definition, computed from the matrix. `None` if that program has no such result.
    pub(super) fn other(
        &self,
        program: OtherProgram,
        quantity: &str,
        test: &KcTest,
    ) -> Option<OtherFigure> {
        let c = |row, column| self.entry(row, column);
        let slr = self.radius * 1000.0 / self.length.per_metre();
        let degrees = 180.0 / std::f64::consts::PI;
        let is_left = self.frame.meaning().1 == Side::Left;
        let side_force = test.load == TestLoad::Lateral && test.trail == 0.0;
        let (name, value, unit) = match (program, quantity) {
            (OtherProgram::Altair, "toe_by_lateral_force") if side_force => (
                "Lateral Force Steer",
                1000.0 * (c(6, 2) + c(6, 4) * slr) * degrees,
                "deg/kN",
            ),
            (OtherProgram::Altair, "camber_by_lateral_force") if side_force => (
                "Lateral Force Camber",
                1000.0 * (c(4, 2) + c(4, 4) * slr) * degrees,
                "deg/kN",
            ),
            (OtherProgram::Altair, "wheel_centre_by_lateral_force") if side_force => (
                "Lateral Force Deflection",
                1000.0 * (c(2, 2) + c(2, 4) * slr),
                "mm/kN",
            ),
            (OtherProgram::Altair, "toe_by_aligning_moment") => (
                "Aligning Torque Steer",
                1e5 * c(6, 6) * degrees,
                "deg/100N-m",
            ),
            (OtherProgram::Adams, "toe_by_aligning_moment") => {
                ("alt_steer_compliance", c(6, 6) * degrees, "deg/(N mm)")
            }
            // The published definition for the right wheel contradicts the one for the left.
            (OtherProgram::Adams, "camber_by_aligning_moment") if is_left => {
                // This program uses the axis that points to the rear.
                ("alt_camber_compliance", -c(4, 6) * degrees, "deg/(N mm)")
            }
            (OtherProgram::Adams, "compliant_wheel_rate") => ("wheel_rate", 1.0 / c(3, 3), "N/mm"),
            _ => return None,
        };
        value
            .is_finite()
            .then_some(OtherFigure { name, value, unit })
    }
}

//! Test results as quantities of an axle.

use crate::ask::{Info, Unit};
use crate::compliance::{HeldQuantity, KcSubject, KcTest, TestLoad, TestMode, sign_of_figure};
use crate::model::Side;

/// Result of a rig test of an axle: a derivative at a station, or a secant over the test's window (its range of load).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestFigure {
    /// Test that gives the result.
    pub test: KcTest,
    /// Name in the tables of the test rig.
    pub quantity: &'static str,
    /// Type of the result's unit.
    pub unit: Unit,
    /// Part to which the result belongs: the axle, or one of its wheels.
    pub of: KcSubject,
    /// True if the result is the secant over the window of the test (the range of its load).
    pub is_secant: bool,
    /// True if the name of the result ends with the load of the test, because tests with other loads have a result of
    /// the same name.
    pub names_load: bool,
}

impl TestFigure {
    /// Name without the side. The name contains only differences from the default test. It also contains the load, if tests
    /// with other loads have a result of the same name. In the default test, the load acts on both wheels in the same
    /// direction. The trail (distance from the contact point back to the side force) is 0, the anti-roll bar is connected,
    /// and the steering wheel is held.
    pub fn stem(&self) -> String {
        let test = &self.test;
        let mut name = self.quantity.to_owned();
        name += &test.trail_suffix();
        let usual = match test.load {
            TestLoad::Vertical => HeldQuantity::WheelLoad,
            _ => HeldQuantity::WheelHeight,
        };
        if test.held != usual {
            name += match test.held {
                HeldQuantity::WheelHeight => "_wheel_height",
                HeldQuantity::WheelLoad => "_wheel_load",
            };
        }
        name += match test.mode {
            TestMode::OneWheel | TestMode::Parallel => "",
            TestMode::Opposed => "_opposed",
            TestMode::Single(Side::Left) => "_left_loaded",
            TestMode::Single(Side::Right) => "_right_loaded",
        };
        if !test.has_bar {
            name += "_without_bar";
        }
        if test.locks_rack {
            name += "_locked_rack";
        }
        if self.is_secant {
            name += "_secant";
        }
        if self.names_load {
            name += &format!("_{}", test.load.name());
        }
        name
    }

    /// Wheel of the result. `None` for a result of the axle.
    pub fn side(&self) -> Option<Side> {
        match self.of {
            KcSubject::Wheel(side) => Some(side),
            KcSubject::Axle | KcSubject::OneWheel => None,
        }
    }

    /// Name of the result in columns, without the unit.
    pub fn name(&self) -> String {
        match self.side() {
            Some(side) => format!("{}_{}", side.name(), self.stem()),
            None => self.stem(),
        }
    }

    /// Returns the catalogue entry of the test result.
    pub(in crate::axle) fn info(&self) -> Info {
        Info {
            name: self.quantity,
            unit: self.unit,
            positive: sign_of_figure(self.quantity),
            formula: "derivative of an equilibrium quantity with respect to the load or motion of a test",
            source: "a rig test of kinematics and compliance",
            ..Info::EMPTY
        }
    }
}

//! Test results of the wheels and of the whole axle.

use super::super::figures::Read;
use super::super::test::{KcTest, TestLoad, TestMode};
use super::super::{KcSubject, end_loads};
use super::{AxleFigure, AxleKcRun, Here, roll};
use crate::ask::Unit;
use crate::compliance::{AxleChange, HeldQuantity, WheelFigures, WheelLoads};
use crate::model::{AxlePosition, Side};
use crate::number::{Each, Scalar};

impl AxleKcRun<'_> {
    /// Computes the results of a test from derivatives and secants. The results of the wheels come first.
    pub(crate) fn figures<T: Scalar>(
        &self,
        here: &mut Here<T>,
        test: &KcTest,
        secants: Option<[WheelFigures<T>; 2]>,
    ) -> Vec<AxleFigure<T>> {
        let (load, _) = test.unit_load(&self.vehicle.suspensions[0].vehicle);
        let unit = test.factors().each(|factor| end_loads(&load, factor));
        let by = self.derivatives(here, test, &unit);
        let mut figures = self.wheel_figures(here, test, by, secants);
        if test.load == TestLoad::Roll {
            figures.extend(self.wheel_tensions(here));
        }
        figures.extend(self.axle_figures(here, test, by, secants));
        if test.load == TestLoad::Roll {
            figures.extend(self.link_figures(here));
        }
        figures
    }

    /// Returns the derivatives of both wheels with respect to the load or motion of the test, each in the frame of its
    /// side.
    fn derivatives<T: Scalar>(
        &self,
        here: &mut Here<T>,
        test: &KcTest,
        unit: &[WheelLoads; 2],
    ) -> Option<[WheelFigures<T>; 2]> {
        let height = HeldQuantity::WheelHeight;
        let one = here.axle.travel(&here.at, Side::Left).one();
        match test.load {
            TestLoad::Heave => here.by(height, &AxleChange::Travels([one, one])),
            TestLoad::Roll => here.by(height, &AxleChange::Travels([-one, one])),
            TestLoad::Steering => here.by(height, &AxleChange::Rack),
            _ => {
                let loads = here.loads(unit);
                here.by(test.held, &loads)
            }
        }
    }

    fn wheel_figures<T: Scalar>(
        &self,
        here: &mut Here<T>,
        test: &KcTest,
        by: Option<[WheelFigures<T>; 2]>,
        secants: Option<[WheelFigures<T>; 2]>,
    ) -> Vec<AxleFigure<T>> {
        let one = here.axle.travel(&here.at, Side::Left).one();
        // Factors on the derivatives with respect to the test load. Each product is a derivative per unit of the load
        // on the wheel itself, or per roll angle.
        let units = match test.load {
            TestLoad::Heave | TestLoad::Steering => [one; 2],
            TestLoad::Roll => match &by {
                Some(by) => [one / roll((&here.axle, &here.at), by)[0]; 2],
                None => [one; 2],
            },
            _ => test.factors().each(|factor| one.scaled(factor)),
        };
        // Wheel load per height of the contact point, while both wheels rise together.
        let rates = by.filter(|_| test.load == TestLoad::Heave);
        let rates = rates.map(|by| by.each(|by| by.vertical / by.contact.z));
        let mut found = Vec::new();
        for (k, side) in Side::ALL.into_iter().enumerate() {
            if units[k].value() == 0.0 {
                continue;
            }
            let steering = here.axle.figures(&here.at, side).steering;
            let sheet = self.sheet(side, steering.is_some());
            let read = |by: Option<[WheelFigures<T>; 2]>| Read {
                by: by.map(|by| by[k].map(|c| c * units[k])),
                wheel_rate: rates.map(|rates| rates[k]),
                rack_force: None,
            };
            let values = sheet.figures(test, &read(by));
            let at_ends = sheet.figures(test, &read(secants));
            let finite = |value: Option<T>| value.filter(|value| value.value().is_finite());
            found.extend(
                values
                    .into_iter()
                    .zip(at_ends)
                    .map(|(value, secant)| AxleFigure {
                        quantity: value.quantity,
                        unit: value.unit,
                        value: finite(value.value),
                        secant: finite(secant.value.filter(|_| secants.is_some())),
                        of: KcSubject::Wheel(side),
                    }),
            );
        }
        found
    }

    /// Computes the test results of the whole axle.
    fn axle_figures<T: Scalar>(
        &self,
        here: &Here<T>,
        test: &KcTest,
        by: Option<[WheelFigures<T>; 2]>,
        secants: Option<[WheelFigures<T>; 2]>,
    ) -> Vec<AxleFigure<T>> {
        let like = here.axle.travel(&here.at, Side::Left);
        let mut found = Vec::new();
        let mut push = |quantity, unit, of: &dyn Fn(&[WheelFigures<T>; 2]) -> T| {
            let finite = |value: Option<T>| value.filter(|value| value.value().is_finite());
            found.push(AxleFigure {
                quantity,
                unit,
                value: finite(by.as_ref().map(of)),
                secant: finite(secants.as_ref().map(of)),
                of: KcSubject::Axle,
            });
        };
        let steer = |by: &[WheelFigures<T>; 2]| (by[1].toe - by[0].toe).scaled(0.5);
        // The unit force acts on the left wheel to the right, and the unit moment turns it to the left. So the sign changes
        // for a force to the left and for a moment to the right.
        let to_left = |by: &[WheelFigures<T>; 2]| -steer(by);
        let position = self.vehicle.suspensions[0].vehicle.position;
        let understeer = match position {
            Some(AxlePosition::Rear) => 1.0,
            _ => -1.0,
        };
        let is_elastic = !self.parts.is_rigid();
        let has_spring = here.axle.spring(&here.at, Side::Left).is_some();
        match (test.load, test.mode) {
            (TestLoad::Roll, _) => {
                let angle = by.map_or(like.constant(f64::NAN), |by| {
                    roll((&here.axle, &here.at), &by)[0]
                });
                push("steer_by_roll", Unit::AnglePerAngle, &|by| {
                    steer(by) / angle
                });
                if has_spring {
                    push("compliant_roll_stiffness", Unit::TorquePerAngle, &|by| {
                        roll((&here.axle, &here.at), by)[1] / angle
                    });
                }
            }
            (TestLoad::Steering, _) => {
                let along = self.along();
                push("steer_by_rack", Unit::AnglePerLength, &|by| {
                    steer(by).scaled(along)
                });
                if has_spring {
                    let force = here.axle.rack_force(&here.at).scaled(along);
                    push("rack_force", Unit::Force, &|_| force);
                }
            }
            (TestLoad::Lateral, TestMode::Parallel) => {
                if is_elastic {
                    push("axle_steer_by_lateral_force", Unit::AnglePerForce, &to_left);
                    push("understeer_by_lateral_force", Unit::AnglePerForce, &|by| {
                        to_left(by).scaled(understeer)
                    });
                }
                if test.held == HeldQuantity::WheelHeight {
                    let at = Side::ALL.each(|side| here.axle.figures(&here.at, side).contact.y);
                    let track = at[0] + at[1];
                    push("force_roll_centre_height_compliant", Unit::Length, &|by| {
                        (track * (by[0].vertical - by[1].vertical)).scaled(0.25)
                    });
                }
            }
            (TestLoad::Aligning, TestMode::Parallel) if is_elastic => {
                push(
                    "understeer_by_aligning_moment",
                    Unit::AnglePerTorque,
                    &|by| to_left(by).scaled(understeer),
                );
            }
            _ => {}
        }
        found
    }
}

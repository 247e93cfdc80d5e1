//! Plan of a computation: only the values that the outputs of a study need.
//!
//! The plan decides about everything that takes computing time:
//!
//! - number of derivatives of a pose,
//! - factorisation of a Jacobian, if one is needed,
//! - hardpoints and outputs for which gradients are computed.

mod effects;

pub use effects::Effect;

use crate::characteristics::{Characteristic, Constants, Measure, Quantity, Slots};
use crate::model::{Axis, PointId};
use crate::solve::StationOrder;
use crate::study::{Drive, ElasticFigure, Formulation, Load, Optimise, Order, TimeLaw, WheelStudy};

/// One quantity with its requested derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Quantity or geometric measure to compute.
    pub of: Measure,
    /// Name of the value, as in column names: `camber`.
    pub name: String,
    /// Unit of the value, as in column names: `deg`. Empty for a plain number.
    pub unit: String,
    /// Factor that converts a value inside the program (in radians or length units) to the printed value.
    pub factor: f64,
    /// Highest order of the derivative with respect to the drive or time.
    pub highest: usize,
}

impl Output {
    /// Catalogue quantity of the output. `None` for other outputs.
    pub fn quantity(&self) -> Option<Quantity> {
        self.of.quantity()
    }

    /// Returns true if the output is itself a derivative with respect to the drive.
    pub fn is_rate(&self) -> bool {
        self.quantity().is_some_and(Quantity::is_rate)
    }
}

/// Complete description of a computation of curves: motion, outputs, gradients, loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Coordinate of the mechanism that drives the motion.
    pub drive: Drive,
    /// Equations that give the poses.
    pub formulation: Formulation,
    /// Drive values, and the order in which the solver visits them.
    pub station_order: StationOrder,
    /// Rack displacements in the study's length unit and axes.
    pub racks: Vec<f64>,
    /// True if the study sweeps the rack. Results then have a column of rack displacements.
    pub rack_moves: bool,
    /// Factor from a rack displacement in the study's axes to the axes of the computation (left wheel, +y to the left): 1
    /// or -1.
    pub rack_sign: f64,
    /// Drive as a function of time, if derivatives are with respect to time.
    pub time: Option<TimeLaw>,
    /// Quantities and measures to compute, in the order of their columns.
    pub outputs: Vec<Output>,
    /// Values of wheel, steering axis and spring that the outputs read.
    pub reads: Slots,
    /// Number of coefficients of a pose's Taylor series along the drive: 1 for positions alone.
    pub coefficients: usize,
    /// Hardpoints for which gradients are computed. May be empty.
    pub sensitivities: Vec<PointId>,
    /// True if each pose is certified.
    pub certify: bool,
    /// Loads for which the forces in links and joints are computed.
    pub loads: Vec<Load>,
    /// Data of the study that formulas read, for example dimensions of the vehicle.
    pub constants: Constants,
    /// Test results of elastic parts. Their columns follow the columns of the outputs.
    pub figures: Vec<ElasticFigure>,
}

impl Plan {
    /// Plans the curves of a wheel.
    pub fn of(own: &WheelStudy) -> Plan {
        Plan::with(own, &own.outputs.characteristics, &own.outputs.figures)
    }

    /// Plans the curves before and after an optimisation. The characteristics of its targets follow the characteristics of
    /// the study. The elastic test results of its targets follow the test results of the study.
    pub fn with_targets(own: &WheelStudy, optimise: Option<&Optimise>) -> Plan {
        let mut characteristics = own.outputs.characteristics.clone();
        let targets = optimise.iter().flat_map(|o| &o.targets);
        for characteristic in targets.filter_map(|target| target.of.as_characteristic()) {
            if !characteristics.contains(&characteristic) {
                characteristics.push(characteristic);
            }
        }
        let mut figures = own.outputs.figures.clone();
        let targets = optimise.iter().flat_map(|o| &o.targets);
        for figure in targets.filter_map(|target| target.of.as_figure()) {
            if !figures.contains(&figure) {
                figures.push(figure);
            }
        }
        Plan::with(own, &characteristics, &figures)
    }

    fn with(
        own: &WheelStudy,
        characteristics: &[Characteristic],
        figures: &[ElasticFigure],
    ) -> Plan {
        let WheelStudy {
            suspension,
            motion,
            formulation,
            outputs: asked,
            compliance: _,
        } = own;
        let highest = asked.order as usize;
        let length = suspension.length_unit;
        let mut outputs = Vec::new();
        for c in characteristics {
            let unit = c.info().unit;
            outputs.push(Output {
                of: Measure::Quantity(Quantity::Characteristic(*c)),
                name: c.info().name.to_owned(),
                unit: unit.suffix(length),
                factor: unit.printed_factor(length),
                highest,
            });
        }
        for point in &asked.points {
            for axis in Axis::ALL {
                outputs.push(Output {
                    of: Measure::Quantity(Quantity::Coordinate(*point, axis)),
                    name: format!("{}_{}", suspension.mechanism.name(*point), axis.name()),
                    unit: length.symbol().to_owned(),
                    factor: suspension.frame.sign(axis),
                    highest,
                });
            }
        }
        for measure in &asked.measures {
            let unit = measure.of.shown_unit();
            outputs.push(Output {
                of: measure.of.clone(),
                name: measure.name.clone(),
                unit: unit.suffix(length),
                factor: unit.printed_factor(length),
                highest,
            });
        }
        if asked.knuckle && highest > 0 {
            for axis in Axis::ALL {
                outputs.push(Output {
                    of: Measure::Quantity(Quantity::AngularVelocity(axis)),
                    name: format!("knuckle_{}", axis.name()),
                    unit: "rad".to_owned(),
                    factor: suspension.frame.turn_sign(axis),
                    highest: highest - 1,
                });
            }
        }
        let coefficients = outputs
            .iter()
            .map(|o| o.highest + o.of.rate_order() + 1)
            .max()
            .unwrap_or(1);
        Plan {
            drive: motion.drive,
            formulation: *formulation,
            station_order: StationOrder::through(&motion.values),
            racks: motion.rack.clone(),
            rack_moves: motion.rack_moves,
            rack_sign: suspension.frame.sign(Axis::Y),
            time: motion.time.clone(),
            reads: Slots::of(outputs.iter().map(|o| o.of.reads())),
            outputs,
            coefficients,
            sensitivities: asked.sensitivities.clone(),
            certify: asked.certify,
            loads: asked.loads.clone(),
            constants: Constants::of(suspension),
            figures: figures.to_vec(),
        }
    }

    /// Returns true if an output needs the steering axis.
    pub fn reads_steering_axis(&self) -> bool {
        self.reads.contain_steering_axis()
    }

    /// Number of stations: drive values times rack displacements.
    pub fn stations(&self) -> usize {
        self.station_order.values().len() * self.racks.len()
    }
}

impl Order {
    /// Name of the order of derivatives.
    pub fn name(self) -> &'static str {
        ["position", "velocity", "acceleration"][self as usize]
    }
}

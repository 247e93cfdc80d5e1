//! The plan: what a study asks for, turned into what has to be computed. Nothing else is.
//!
//! Every decision on cost is made here: how many derivatives of a pose are taken, whether a Jacobian is
//! factorised at all, to which hardpoints gradients are formed and of which outputs.

mod effects;

pub use effects::Effect;

use crate::characteristics::{Characteristic, Constants, Quantity, Slots};
use crate::model::{Axis, PointId};
use crate::solve::StationOrder;
use crate::study::{Drive, ElasticFigure, Formulation, Load, Optimise, Order, TimeLaw, WheelStudy};

/// One quantity with the derivatives asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// What.
    pub quantity: Quantity,
    /// Name and unit of the value, as column names write them: `camber` and `deg`.
    pub name: String,
    /// Unit; empty for a plain number.
    pub unit: String,
    /// What a value in the kernel's frame, in radians or length units, is multiplied by to be printed.
    pub factor: f64,
    /// Highest derivative by the drive or by time.
    pub highest: usize,
}

/// What is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What drives.
    pub drive: Drive,
    /// How poses are found.
    pub formulation: Formulation,
    /// Drive values and the order in which they are visited.
    pub station_order: StationOrder,
    /// Rack displacements, in the study's axes.
    pub racks: Vec<f64>,
    /// Whether the study moves the rack, so that results carry a column for it.
    pub rack_moves: bool,
    /// What a rack displacement in the study's axes is multiplied by for the kernel's.
    pub rack_sign: f64,
    /// The drive over time, where derivatives are by time.
    pub time: Option<TimeLaw>,
    /// Outputs.
    pub outputs: Vec<Output>,
    /// What of wheel, steering axis and spring the outputs are made of.
    pub reads: Slots,
    /// Coefficients of the power series of a pose: 1 for positions alone.
    pub coefficients: usize,
    /// Points by which gradients are formed; empty for none.
    pub sensitivities: Vec<PointId>,
    /// Whether each pose is proved.
    pub certify: bool,
    /// Loads whose way through links and joints is followed.
    pub loads: Vec<Load>,
    /// Figures that formulas read.
    pub constants: Constants,
    /// Figures of tests on elastic parts, after the outputs.
    pub figures: Vec<ElasticFigure>,
}

impl Plan {
    /// The plan of a wheel's curves.
    pub fn of(own: &WheelStudy) -> Plan {
        Plan::with(own, &own.outputs.characteristics, &own.outputs.figures)
    }

    /// The plan of the curves before and after an optimisation: those of the study, and the targets'.
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
                quantity: Quantity::Characteristic(*c),
                name: c.info().name.to_owned(),
                unit: unit.suffix(length),
                factor: unit.printed_factor(length),
                highest,
            });
        }
        for point in &asked.points {
            for axis in Axis::ALL {
                outputs.push(Output {
                    quantity: Quantity::Coordinate(*point, axis),
                    name: format!("{}_{}", suspension.mechanism.name(*point), axis.name()),
                    unit: length.symbol().to_owned(),
                    factor: suspension.frame.sign(axis),
                    highest,
                });
            }
        }
        if asked.knuckle && highest > 0 {
            for axis in Axis::ALL {
                outputs.push(Output {
                    quantity: Quantity::AngularVelocity(axis),
                    name: format!("knuckle_{}", axis.name()),
                    unit: "rad".to_owned(),
                    factor: suspension.frame.turn_sign(axis),
                    highest: highest - 1,
                });
            }
        }
        let coefficients = outputs
            .iter()
            .map(|o| o.highest + o.quantity.rate_order() + 1)
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
            reads: Slots::of(outputs.iter().map(|o| o.quantity.reads())),
            outputs,
            coefficients,
            sensitivities: asked.sensitivities.clone(),
            certify: asked.certify,
            loads: asked.loads.clone(),
            constants: Constants::of(suspension),
            figures: figures.to_vec(),
        }
    }

    /// Whether an output needs the steering axis.
    pub fn reads_steering_axis(&self) -> bool {
        self.reads.contain_steering_axis()
    }

    /// Number of stations: drive values times rack displacements.
    pub fn stations(&self) -> usize {
        self.station_order.values().len() * self.racks.len()
    }
}

impl Order {
    /// The order in words.
    pub fn name(self) -> &'static str {
        ["position", "velocity", "acceleration"][self as usize]
    }
}

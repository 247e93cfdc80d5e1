//! Requests: the quantities and stations to evaluate for each design.

use super::elastic::ElasticQuantities;
use super::gradient_evaluator::GradientEvaluator;
use super::rate_slopes::RateSlopes;
use super::{AxleStations, Block, Evaluator, Stations};
use crate::characteristics::Quantity;
use crate::curves::Column;
use crate::mechanism::DesignFault;
use crate::model::{PointId, Side, Suspension};
use crate::number::Width;
use std::borrow::Cow;

/// Quantities at stations, of a corner or of an axle.
#[derive(Clone, Debug)]
pub(crate) struct Request<'s> {
    /// The column of each quantity.
    columns: Vec<Column>,
    stations: Stations,
    of: Requested<'s>,
}

#[derive(Clone, Debug)]
enum Requested<'s> {
    Corner(Box<CornerQuantities<'s>>),
    Axle(Box<AxleStations<'s>>),
    Elastic(Box<ElasticQuantities>),
}

/// Quantities of the wheel of a corner.
#[derive(Clone, Debug)]
struct CornerQuantities<'s> {
    suspension: Cow<'s, Suspension>,
    quantities: Vec<Quantity>,
    /// For each quantity, true if its derivative by the drive in the design position is requested too.
    has_slope: Vec<bool>,
}

impl<'s> Request<'s> {
    /// Quantities of the wheel of a corner, each with its column.
    pub(crate) fn of_corner(
        suspension: Cow<'s, Suspension>,
        stations: Stations,
        quantities: Vec<Quantity>,
        columns: Vec<Column>,
    ) -> Self {
        let has_slope = vec![false; quantities.len()];
        Request {
            columns,
            stations,
            of: Requested::Corner(Box::new(CornerQuantities {
                suspension,
                quantities,
                has_slope,
            })),
        }
    }

    /// Quantities of a wheel with elastic parts, each with its column.
    pub(crate) fn of_elastic(
        quantities: ElasticQuantities,
        stations: Stations,
        columns: Vec<Column>,
    ) -> Self {
        Request {
            columns,
            stations,
            of: Requested::Elastic(Box::new(quantities)),
        }
    }

    /// Quantities of an axle.
    pub(crate) fn of_axle(stations: AxleStations<'s>) -> Self {
        Request {
            columns: stations.columns(),
            stations: stations.stations(),
            of: Requested::Axle(Box::new(stations)),
        }
    }

    /// The request with derivatives by the drive in the design position of those quantities of a corner for which
    /// `is_wanted` is true. An axle's request has its own.
    pub(crate) fn with_slopes(mut self, is_wanted: impl Fn(usize) -> bool) -> Self {
        if let Requested::Corner(corner) = &mut self.of {
            for (number, has_slope) in corner.has_slope.iter_mut().enumerate() {
                *has_slope = is_wanted(number);
            }
        }
        self
    }

    /// The column of each quantity.
    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The stations.
    pub(crate) fn stations(&self) -> &Stations {
        &self.stations
    }

    /// The numbers of the values that are read at a station of a wheel with elastic parts; empty for others.
    pub(crate) fn read_at(&self, station: usize) -> &[usize] {
        match &self.of {
            Requested::Elastic(quantities) => quantities.read_at(station),
            Requested::Corner(_) | Requested::Axle(_) => &[],
        }
    }

    /// The quantities of a corner; empty for an axle.
    pub(crate) fn of_wheel(&self) -> &[Quantity] {
        match &self.of {
            Requested::Corner(corner) => &corner.quantities,
            Requested::Axle(_) | Requested::Elastic(_) => &[],
        }
    }

    /// Positions and quantities of an axle; `None` for a corner.
    pub(crate) fn axle(&self) -> Option<&AxleStations<'s>> {
        match &self.of {
            Requested::Corner(_) | Requested::Elastic(_) => None,
            Requested::Axle(stations) => Some(stations),
        }
    }

    /// Room for the values of a block of designs.
    pub(crate) fn block(&self) -> Block {
        let (values, stations) = (self.columns.len(), self.stations.count());
        match &self.of {
            Requested::Corner(_) | Requested::Elastic(_) => Block::new(values, stations),
            Requested::Axle(axle) => Block::with_gains(values, stations, axle.gains.len()),
        }
    }

    /// An evaluator of designs in lanes of this width, or one by one without one. Errors if the vehicle's own design
    /// cannot be solved.
    pub(crate) fn evaluator(&self, width: Option<Width>) -> Result<Evaluator<'_>, DesignFault> {
        match &self.of {
            Requested::Corner(corner) => {
                let CornerQuantities {
                    suspension,
                    quantities,
                    has_slope,
                } = &**corner;
                let stations = &self.stations;
                let slopes = RateSlopes::of(suspension, stations, quantities, |k| has_slope[k])?;
                let mut evaluator = Evaluator::with_width(suspension, stations, quantities, width)?;
                evaluator.slopes = slopes.map(|slopes| Box::new(slopes) as _);
                Ok(evaluator)
            }
            Requested::Axle(stations) => stations.evaluator(width),
            Requested::Elastic(quantities) => quantities.evaluator(&self.stations),
        }
    }

    /// An evaluator of values with gradients by these points, in lanes of this width as far as they go, or one by one
    /// without one; gradients by other points must not be used. An axle has gradients by all points, one by one. Errors
    /// if the vehicle's own design cannot be solved, with the wheel of an axle.
    pub(crate) fn gradients(
        &self,
        points: &[PointId],
        width: Option<Width>,
    ) -> Result<GradientEvaluator<'_>, (Side, DesignFault)> {
        match &self.of {
            Requested::Corner(corner) => {
                let (suspension, quantities) = (&corner.suspension, &corner.quantities);
                GradientEvaluator::new(suspension, &self.stations, quantities, points, width)
                    .map_err(|fault| (Side::Left, fault))
            }
            Requested::Axle(stations) => GradientEvaluator::of_axle(stations),
            // Gradients of equilibria are formed with those by rates, on a tape.
            Requested::Elastic(_) => Err((Side::Left, DesignFault::Singular)),
        }
    }
}

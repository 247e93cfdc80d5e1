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

/// Quantities at stations, for one wheel or for an axle.
#[derive(Clone, Debug)]
pub(crate) struct Request<'s> {
    /// Column of results for each quantity.
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

/// Quantities of one wheel.
#[derive(Clone, Debug)]
struct CornerQuantities<'s> {
    suspension: Cow<'s, Suspension>,
    quantities: Vec<Quantity>,
    /// True for each quantity that also needs its derivative with respect to the drive coordinate in the design
    /// position.
    has_slope: Vec<bool>,
}

impl<'s> Request<'s> {
    /// Request for quantities of one wheel, each with its column.
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

    /// Request for quantities of a wheel with elastic parts, each with its column.
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

    /// Request for quantities of an axle.
    pub(crate) fn of_axle(stations: AxleStations<'s>) -> Self {
        Request {
            columns: stations.columns(),
            stations: stations.stations(),
            of: Requested::Axle(Box::new(stations)),
        }
    }

    /// Adds derivatives with respect to the drive coordinate in the design position, for the quantities of one wheel
    /// for which `is_wanted` is true. Requests for axles and for elastic parts already contain these derivatives.
    pub(crate) fn with_slopes(mut self, is_wanted: impl Fn(usize) -> bool) -> Self {
        if let Requested::Corner(corner) = &mut self.of {
            for (number, has_slope) in corner.has_slope.iter_mut().enumerate() {
                *has_slope = is_wanted(number);
            }
        }
        self
    }

    /// Column of results for each quantity.
    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Stations of the request.
    pub(crate) fn stations(&self) -> &Stations {
        &self.stations
    }

    /// Indices of the values that are read at a station of a wheel with elastic parts. Empty for other requests.
    pub(crate) fn read_at(&self, station: usize) -> &[usize] {
        match &self.of {
            Requested::Elastic(quantities) => quantities.read_at(station),
            Requested::Corner(_) | Requested::Axle(_) => &[],
        }
    }

    /// Quantities of one wheel. Empty for an axle, and for a wheel with elastic parts.
    pub(crate) fn of_wheel(&self) -> &[Quantity] {
        match &self.of {
            Requested::Corner(corner) => &corner.quantities,
            Requested::Axle(_) | Requested::Elastic(_) => &[],
        }
    }

    /// Returns true for every station of one wheel. For an axle, returns true for the stations of the motion and for the design
    /// position.
    pub(crate) fn is_in_motion(&self, station: usize) -> bool {
        self.axle().is_none_or(|own| own.is_in_motion(station))
    }

    /// Required positions and quantities of an axle. `None` for one wheel.
    pub(crate) fn axle(&self) -> Option<&AxleStations<'s>> {
        match &self.of {
            Requested::Corner(_) | Requested::Elastic(_) => None,
            Requested::Axle(stations) => Some(stations),
        }
    }

    /// Allocates a block for the values of designs.
    pub(crate) fn block(&self) -> Block {
        let (values, stations) = (self.columns.len(), self.stations.count());
        match &self.of {
            Requested::Corner(_) | Requested::Elastic(_) => Block::new(values, stations),
            Requested::Axle(axle) => Block::with_gains(values, stations, axle.gains.len()),
        }
    }

    /// Makes an evaluator of designs in lanes of this width, or one by one if `width` is `None`. An error says why the
    /// vehicle's own design cannot be solved.
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
            Requested::Elastic(quantities) => quantities.evaluator(&self.stations, width),
        }
    }

    /// Makes an evaluator of values with gradients with respect to these points. It uses lanes of this width where possible.
    /// If `width` is `None`, it works one by one. Gradients with respect to other points must not be used. Axles are
    /// evaluated one by one, and have gradients with respect to all points; elastic parts of an axle are ignored. An error says
    /// why the vehicle's own design cannot be solved, and names the wheel. A wheel with elastic parts always gives an error.
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
            // This evaluator has no gradients of equilibria. A tape computes them elsewhere, with the derivatives with respect
            // to rates.
            Requested::Elastic(_) => Err((Side::Left, DesignFault::Singular)),
        }
    }
}

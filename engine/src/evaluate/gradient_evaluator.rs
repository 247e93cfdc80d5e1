//! Quantities at stations with their gradients with respect to the hardpoints, for several designs at a time.
//!
//! Designs that the tracker accepts are differentiated in SIMD lanes, if the quantities can be read there. A single design has
//! one station in each lane where possible; the results are identical, bit for bit. Other designs are differentiated one by
//! one, with the adjoint of the closure equations. The choice of method depends only on the design.

use super::evaluator::Designs;
use super::gradients_one_by_one::{DifferentiatesOneByOne, OneByOne};
use super::{AxleStations, Gradients, Jacobians, Pairs, Stations};
use crate::characteristics::Quantity;
use crate::mechanism::DesignFault;
use crate::model::{PointId, Side, Suspension};
use crate::number::{Vector3, Width};

/// Values and gradients of some designs, in the kernel's frame, in radians and length units.
#[derive(Clone, Debug, Default)]
pub struct Evaluated {
    quantities: usize,
    stations: usize,
    points: usize,
    /// Number of wheels with gradients: two for an axle.
    sides: usize,
    /// Values of the quantities, `[design][quantity][station]`.
    values: Vec<f64>,
    /// Gradients of the quantities, `[design][quantity][station][side][point]`.
    gradients: Vec<Vector3<f64>>,
    /// Reason why each design cannot be solved. `None` if the design can be solved.
    faults: Vec<Option<DesignFault>>,
    /// True if a design has a pose with derivatives at a station, and no rocker is at a toggle, `[design][station]`.
    solved: Vec<bool>,
}

impl Evaluated {
    fn clear(&mut self, designs: usize, of: &GradientEvaluator<'_>) {
        let GradientEvaluator {
            quantities,
            stations,
            points,
            sides,
            ..
        } = *of;
        let all = designs * quantities * stations;
        (self.quantities, self.stations) = (quantities, stations);
        (self.points, self.sides) = (points, sides);
        self.values.clear();
        self.values.resize(all, f64::NAN);
        self.gradients.clear();
        let unknown = Vector3::new(f64::NAN, f64::NAN, f64::NAN);
        self.gradients.resize(all * sides * points, unknown);
        self.faults.clear();
        self.faults.resize(designs, None);
        self.solved.clear();
        self.solved.resize(designs * stations, false);
    }

    /// Reason why a design cannot be solved at all. `None` if the design can be solved.
    pub fn fault(&self, design: usize) -> Option<&DesignFault> {
        self.faults[design].as_ref()
    }

    /// Returns true if a design has a pose with derivatives at a station, and no rocker is at a toggle. At a toggle, quantities
    /// that do not depend on this rocker still have values and derivatives.
    pub fn is_solved(&self, design: usize, station: usize) -> bool {
        self.solved[design * self.stations + station]
    }

    /// Value of a quantity of a design at a station. NaN if the value does not exist.
    pub fn value(&self, design: usize, quantity: usize, station: usize) -> f64 {
        self.values[self.place(design, quantity, station)]
    }

    /// Derivatives of a quantity with respect to every hardpoint of a wheel, in the order of the design's points. A single
    /// wheel counts as the left wheel.
    pub fn gradient(
        &self,
        (design, quantity, station): (usize, usize, usize),
        side: Side,
    ) -> &[Vector3<f64>] {
        let first = self.first_point((design, quantity, station), side);
        &self.gradients[first..first + self.points]
    }

    /// Derivative of a quantity along a direction in which every hardpoint of a wheel moves. `rates` holds the velocity
    /// of each hardpoint. `place` holds the indices of design, quantity and station. An empty list of rates means that no
    /// hardpoint moves.
    pub fn along(&self, place: (usize, usize, usize), side: Side, rates: &[Vector3<f64>]) -> f64 {
        along(rates, self.gradient(place, side))
    }

    fn first_point(&self, (design, quantity, station): (usize, usize, usize), side: Side) -> usize {
        let place = self.place(design, quantity, station);
        (place * self.sides + side as usize) * self.points
    }

    fn place(&self, design: usize, quantity: usize, station: usize) -> usize {
        (design * self.quantities + quantity) * self.stations + station
    }

    pub(super) fn put(&mut self, design: usize, quantity: usize, station: usize, value: f64) {
        let place = self.place(design, quantity, station);
        self.values[place] = value;
    }

    pub(super) fn put_gradient(
        &mut self,
        place: (usize, usize, usize),
        side: Side,
        id: PointId,
        by: Vector3<f64>,
    ) {
        let place = self.first_point(place, side) + id.0;
        self.gradients[place] = by;
    }

    pub(super) fn put_gradients(
        &mut self,
        place: (usize, usize, usize),
        side: Side,
        gradient: &[Vector3<f64>],
    ) {
        let first = self.first_point(place, side);
        self.gradients[first..first + self.points].copy_from_slice(gradient);
    }

    /// Replaces all values of a design by NaN.
    fn forget(&mut self, design: usize) {
        let all = self.quantities * self.stations;
        let first = design * all;
        self.values[first..first + all].fill(f64::NAN);
        let unknown = Vector3::new(f64::NAN, f64::NAN, f64::NAN);
        let points = self.sides * self.points;
        self.gradients[first * points..(first + all) * points].fill(unknown);
        self.solved_of(design).fill(false);
    }

    pub(super) fn solved_of(&mut self, design: usize) -> &mut [bool] {
        &mut self.solved[design * self.stations..][..self.stations]
    }
}

/// Derivative of a value along a direction in which every hardpoint of a wheel moves. `rates` holds the velocity of each
/// hardpoint, and `gradient` the derivatives of the value with respect to the hardpoints.
pub(crate) fn along(rates: &[Vector3<f64>], gradient: &[Vector3<f64>]) -> f64 {
    let pairs = rates.iter().zip(gradient);
    // A point that does not move contributes nothing, even if the derivative with respect to it has no value.
    let moving = pairs.filter(|(rate, _)| rate.to_array() != [0.0; 3]);
    moving.map(|(rate, by)| by.dot(*rate)).sum()
}

/// Evaluates quantities at stations with their gradients.
pub struct GradientEvaluator<'a> {
    stations: usize,
    quantities: usize,
    points: usize,
    /// Number of wheels with gradients: two for an axle.
    sides: usize,
    /// Points for which gradients are computed.
    wanted: Vec<PointId>,
    lanes: Option<Gradients<'a>>,
    one_by_one: Box<dyn DifferentiatesOneByOne + 'a>,
}

/// Evaluates at most as many designs as fit into the lanes, from the design with this index on. The lanes hold designs, or
/// the stations of one design.
fn evaluate_in_lanes(
    gradients: &mut Gradients<'_>,
    designs: &[Vector3<f64>],
    number: usize,
    wanted: &[PointId],
    into: &mut Evaluated,
) {
    let count = designs.len() / into.points;
    let mut keep = |found: &Jacobians<'_>, lane: usize, design: usize, station: usize| {
        for quantity in 0..into.quantities {
            into.put(design, quantity, station, found.value(lane, quantity));
            for id in wanted {
                let by = found.gradient(lane, quantity, *id);
                into.put_gradient((design, quantity, station), Side::Left, *id, by);
            }
        }
    };
    if count == 1 && gradients.takes_one() {
        gradients.jacobians_of_one(designs, |found| {
            for (lane, station) in found.side_by_side().iter().enumerate() {
                keep(found, lane, number, *station);
            }
        });
    } else {
        gradients.jacobians(designs, |found| {
            for lane in 0..count {
                keep(found, lane, number + lane, found.station());
            }
        });
    }
}

impl<'a> GradientEvaluator<'a> {
    /// Prepares to evaluate designs of a suspension, with gradients with respect to these points. Gradients with respect to
    /// other points must not be used. `width` is the width of the lanes; if it is `None`, designs are evaluated one by one.
    ///
    /// # Errors
    /// Returns an error if the suspension's own design cannot be solved.
    pub fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
        points: &[PointId],
        width: Option<Width>,
    ) -> Result<Self, DesignFault> {
        let rates = quantities.iter().any(|q| q.rate_order() > 0);
        Ok(GradientEvaluator {
            stations: stations.count(),
            quantities: quantities.len(),
            points: suspension.design.len(),
            sides: 1,
            wanted: points.to_vec(),
            lanes: width.and_then(|w| Gradients::new(suspension, stations, quantities, w)),
            one_by_one: if rates {
                OneByOne::<2>::new(suspension, stations, quantities, points)?
            } else {
                OneByOne::<1>::new(suspension, stations, quantities, points)?
            },
        })
    }

    /// Prepares to evaluate axles one by one, with gradients with respect to all points of both wheels. An error says why the
    /// axle's own design cannot be solved.
    pub(super) fn of_axle(stations: &'a AxleStations<'a>) -> Result<Self, (Side, DesignFault)> {
        Ok(GradientEvaluator {
            stations: stations.placements.len(),
            quantities: stations.quantities.len(),
            points: stations.axle.left.design.len(),
            sides: 2,
            wanted: Vec::new(),
            lanes: None,
            one_by_one: stations.differentiating()?,
        })
    }

    /// Number of designs that are evaluated side by side.
    pub fn at_once(&self) -> usize {
        self.lanes.as_ref().map_or(1, |l| l.at_once())
    }

    /// Evaluates designs, given as their points one design after the other, at every station with a pose. The second slice
    /// has the points of right wheels; it is empty if the right wheels are mirror images. Returns the number of designs that
    /// were evaluated one by one.
    pub fn evaluate(&mut self, wheels: Pairs<'_>, into: &mut Evaluated) -> usize {
        let points = self.points;
        let designs = Designs::new(wheels, points, &[]);
        let count = designs.count();
        into.clear(count, self);
        let at_once = self.at_once();
        let mut left = 0;
        for first in (0..count).step_by(at_once) {
            let together = at_once.min(count - first);
            if let Some(lanes) = &mut self.lanes {
                let group = &wheels[0][first * points..(first + together) * points];
                evaluate_in_lanes(lanes, group, first, &self.wanted, into);
            }
            for number in 0..together {
                let place = first + number;
                if self.lanes.as_ref().is_some_and(|l| l.is_accepted(number)) {
                    into.solved_of(place).fill(true);
                    continue;
                }
                left += 1;
                into.forget(place);
                let solved = self.one_by_one.evaluate(designs.get(place), into);
                into.faults[place] = solved.err();
            }
        }
        left
    }
}

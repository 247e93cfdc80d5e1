//! Positions of an axle as power series in a number e. The designs, or the displacement of the steering gear, change with e.
//!
//! The poses of both wheels are computed from their closure equations, order by order. The travels, or the roll angle, are
//! computed from the condition f = h_l - h_r = 0 on the heights of both contact points. n is the normal of the ground. C_l'
//! and C_r' are the velocities of the carriers' points at the contact points, each with respect to its wheel's travel. If
//! the roll angle is given, the travels are z +- s(e). If both travels are given on a plane, the roll angle phi(e) changes:
//!
//! ```text
//! s_k = -f_k/(n.C_l' + n.C_r'),   phi_k = -f_k/track                                           (1)
//! ```
//!
//! with f_k the coefficient of e^k of f, computed with the known lower orders of s or phi.
//!
//! In a solid axle, C_b' is the velocity while wheel b rises and the other wheel falls at the same unit rate. The mean travel
//! is held. In a steered solid axle, the steering gear displaces the drag link's end. If this displacement increases by e in a
//! constant design, each second coefficient is half a second derivative with respect to this displacement.

use super::carriers::Carriers;
use super::reading::{Parts, Reading, Snapshot};
use super::solver::{AxlePose, AxleSolver, Read, displace};
use super::state::{AxleState, Hold};
use super::{Axle, AxleColumn, Of};
use crate::derive::pose_series;
use crate::linear::lu::Lu6;
use crate::mechanism::{Closure, Configuration, Driver, Ground, Pose};
use crate::model::Side;
use crate::number::{Jet, Vector3};
use std::borrow::Cow;

/// A number as a series along a direction of the design, to second order.
pub(crate) type Series = Jet<f64, 3>;

/// A wheel whose design is a series in e.
pub(crate) struct DesignedWheel<'d> {
    design: Cow<'d, [Vector3<Series>]>,
    closure: Closure<Series>,
    /// Changes of the two travels of a steered axle due to the rotation of its knuckles: first the travel that drives the axle,
    /// then the held travel. 0 for other axles.
    lifts: [Series; 2],
}

impl<'d> DesignedWheel<'d> {
    /// Makes both wheels of these designs, with the steering gear centred.
    pub(crate) fn both(axle: &Axle, designs: &'d [Vec<Vector3<Series>>]) -> [Self; 2] {
        Side::ALL.map(|side| {
            let design = &designs[side as usize][..];
            DesignedWheel {
                design: Cow::Borrowed(design),
                closure: Closure::new(&axle.suspension(side).mechanism, design),
                lifts: [Jet([0.0; 3]); 2],
            }
        })
    }

    /// Makes both wheels. The steering gear of a steered axle is at the displacement `gear`.
    pub(crate) fn steered<'s>(
        axle: &Axle,
        wheels: &'s [Self; 2],
        gear: Series,
    ) -> [DesignedWheel<'s>; 2] {
        Side::ALL.map(|side| {
            let mechanism = &axle.suspension(side).mechanism;
            let DesignedWheel {
                design,
                closure,
                lifts,
            } = &wheels[side as usize];
            if mechanism.axle_steering().is_none() {
                return DesignedWheel {
                    design: Cow::Borrowed(design),
                    closure: closure.clone(),
                    lifts: *lifts,
                };
            }
            let mut design = design.to_vec();
            let lifts = displace(mechanism, &mut design, gear);
            let closure = Closure::new(mechanism, &design);
            DesignedWheel {
                design: Cow::Owned(design),
                closure,
                lifts,
            }
        })
    }
}

/// A position of an axle, with the data from which its series are computed.
pub(crate) struct SeriesPosition {
    /// Driving travel and rack displacement of each wheel, in its own frame. For a rigid axle, the held travel takes the place of
    /// the rack displacement.
    coordinates: [(f64, f64); 2],
    roll: f64,
    /// Displacement of the rack or of the steering gear.
    pub(crate) rack: f64,
    hold: Hold,
    /// Denominators of equation (1): n.C_l' + n.C_r', and the track.
    slopes: [f64; 2],
    wheels: [(Pose<f64>, Lu6<f64>); 2],
}

impl SeriesPosition {
    /// Returns one wheel with its travel changed by +-`apart`: plus for the left wheel, minus for the right wheel.
    fn configuration<'w>(
        &self,
        axle: &'w Axle,
        side: Side,
        wheel: &'w DesignedWheel<'_>,
        apart: Series,
    ) -> Configuration<'w, Series> {
        let mechanism = &axle.suspension(side).mechanism;
        let (pose, factors) = &self.wheels[side as usize];
        let (travel, rack) = self.coordinates[side as usize];
        let DesignedWheel {
            design,
            closure,
            lifts: [drive_lift, rack_lift],
        } = wheel;
        let rack = Jet::constant(rack) - *rack_lift;
        let travel = Jet::constant(travel) + apart * Jet::constant(side.sign());
        let driver = Driver::Travel(travel - *drive_lift);
        let pose = pose_series(mechanism, design, closure, factors, pose, driver, rack);
        Configuration::new(mechanism, design, pose, rack)
    }

    /// Returns the state of the axle. The travels change by +-`apart`, and the roll angle of the ground changes by `turn`.
    fn state<'a>(
        &self,
        axle: &'a Axle,
        parts: &Parts,
        wheels: &[DesignedWheel<'_>; 2],
        [apart, turn]: [Series; 2],
    ) -> AxleState<'a, Series> {
        let reading = |side: Side| {
            let at = self.configuration(axle, side, &wheels[side as usize], apart);
            Reading::without_rates(&Snapshot::of(&at, parts))
        };
        let (sine, cosine) = self.roll.sin_cos();
        let [sine, cosine] = [sine, cosine].map(Series::constant);
        // Cosine of `turn` to second order.
        let upright = Series::constant(1.0) - turn * turn * Series::constant(0.5);
        AxleState {
            readings: [reading(Side::Left), reading(Side::Right)],
            ground: Ground {
                sine: sine * upright + cosine * turn,
                cosine: cosine * upright - sine * turn,
            },
            roll: Series::constant(self.roll) + turn,
            hold: self.hold,
            carriers: Carriers::of(axle),
            setup: &axle.setup,
        }
    }

    /// Returns the state of the axle in which f = 0 holds to every order, and the changes s of the travels, by equation
    /// (1).
    pub(crate) fn on_ground<'a>(
        &self,
        axle: &'a Axle,
        parts: &Parts,
        wheels: &[DesignedWheel<'_>; 2],
    ) -> (AxleState<'a, Series>, Series) {
        let mut changes = [Jet([0.0; 3]); 2];
        let mut state = self.state(axle, parts, wheels, changes);
        let [rise, track] = self.slopes;
        for order in 1..3 {
            let left_over = state.mismatch()[order];
            let [apart, turn] = &mut changes;
            match self.hold {
                Hold::TravelsOnPads => break,
                Hold::MeanTravel => apart.0[order] = -left_over / rise,
                Hold::TravelsOnPlane => turn.0[order] = -left_over / track,
            }
            state = self.state(axle, parts, wheels, changes);
        }
        (state, changes[0])
    }
}

/// First and second derivative of a number with respect to the displacement of a steering gear.
pub(crate) type ByGear = [f64; 2];

/// Computes the first and second derivative of a number from its series.
fn derivatives(series: Series) -> ByGear {
    [series.derivative(1), series.derivative(2)]
}

impl<'a, const N: usize> AxleSolver<'a, N> {
    /// Prepares series about a position whose quantities were just computed. `None` if a wheel is singular.
    pub(crate) fn series_position(&self, placed: &AxlePose, read: &Read) -> Option<SeriesPosition> {
        let [left_factors, right_factors] = self.factorised(placed)?;
        let [left_pose, right_pose] = *placed.poses();
        let [left, right] = read.state.wheels().map(|wheel| wheel.rise());
        Some(SeriesPosition {
            coordinates: self.coordinates(placed.travels, placed.rack),
            roll: placed.roll,
            rack: placed.rack,
            hold: placed.hold,
            slopes: [left + right, read.state.track()],
            wheels: [(left_pose, left_factors), (right_pose, right_factors)],
        })
    }

    /// Computes the derivatives of these columns with respect to the displacement of a steered axle's steering gear, to
    /// second order. The other coordinates of the station stay constant. The result is NaN for a quantity that contains
    /// velocities.
    pub(super) fn second_by_gear<'c>(
        &self,
        axle: &Axle,
        (placed, read): (&AxlePose, &Read),
        columns: impl Iterator<Item = &'c AxleColumn>,
    ) -> Option<Vec<ByGear>> {
        let position = self.series_position(placed, read)?;
        // `designs` has the body end of the drag link at its hardpoint. `gear` is the series of this end's displacement.
        let designs = self.designs().map(|design| {
            let series = design.iter().map(|place| place.map(Jet::constant));
            series.collect::<Vec<_>>()
        });
        let at_rest = DesignedWheel::both(axle, &designs);
        let gear = Jet([position.rack, 1.0, 0.0]);
        let wheels = DesignedWheel::steered(axle, &at_rest, gear);
        let (state, apart) = position.on_ground(axle, self.parts(), &wheels);
        let own =
            Side::ALL.map(|side| position.configuration(axle, side, &wheels[side as usize], apart));
        let by_gear = |column: &AxleColumn| match column.of {
            Of::Quantity(quantity) if quantity.rate_order() == 0 => {
                derivatives(quantity.evaluate(&state))
            }
            Of::Point { side, id, axis, .. } => derivatives(own[side as usize].point(id)[axis]),
            Of::Turn(side, axis) => {
                // The angular velocity is half the sum of (column x rate of column).
                let columns = own[side as usize].carrier_rotation().columns;
                let rate = |c: Series| Jet([c[1], 2.0 * c[2]]);
                let value = |c: Series| Jet([c[0], c[1]]);
                let parts = columns.map(|column| column.map(value).cross(column.map(rate)));
                let [x, y, z] = parts;
                let turn = (x + y + z)[axis];
                [0.5 * turn[0], 0.5 * turn[1]]
            }
            Of::Quantity(_) | Of::Force { .. } => [f64::NAN; 2],
        };
        Some(columns.map(by_gear).collect())
    }
}

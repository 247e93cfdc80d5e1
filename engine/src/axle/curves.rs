//! Curves of an axle: every quantity at every station.

use super::solver::{AxleFailure, AxleSolver, Placed, Placement, Read, Sought, WheelRead, both};
use super::{
    Axle, AxleCertifier, AxleColumn, AxleMotion, AxleProof, AxleQuantity, Of, Quantity, Void,
    WheelMotion,
};
use crate::curves::{Loads, Status};
use crate::mechanism::DesignFault;
use crate::model::{Axis, PointId, Rod, Side};
use crate::solve::{LEAST_DIGITS, rate_digits};
use crate::study::Load;
use crate::threads::on_large_stacks;

/// What is computed for an axle.
#[derive(Clone, Debug, PartialEq)]
pub struct AxlePlan {
    /// The stations.
    pub course: AxleMotion,
    /// Quantities, in the order asked.
    pub quantities: Vec<Quantity>,
    /// Highest derivative along the motions that is reported, 2 at most.
    pub derivatives: usize,
    /// Hardpoints by which gradients are formed; empty for none.
    pub sensitivities: Vec<PointId>,
    /// Whether each position is proved.
    pub certify: bool,
    /// Points whose coordinates are reported.
    pub points: Vec<PointId>,
    /// Whether the angular velocities of the wheel carriers are reported.
    pub knuckle: bool,
    /// Loads on the left and the right wheel, each in the kernel's frame of its side.
    pub loads: [Vec<Load>; 2],
}

impl AxlePlan {
    /// Quantities over a course, and nothing else.
    pub fn of(course: AxleMotion, quantities: Vec<Quantity>) -> AxlePlan {
        AxlePlan {
            course,
            quantities,
            derivatives: 0,
            sensitivities: Vec::new(),
            certify: false,
            points: Vec::new(),
            knuckle: false,
            loads: Default::default(),
        }
    }

    /// The plan without sensitivities and proofs.
    pub fn values_alone(&self) -> AxlePlan {
        AxlePlan {
            sensitivities: Vec::new(),
            certify: false,
            ..self.clone()
        }
    }

    /// A plan of the same quantities over the same course, and nothing else.
    pub fn quantities_alone(&self) -> AxlePlan {
        AxlePlan::of(self.course.clone(), self.quantities.clone())
    }

    /// A plan of the same quantities in the design position.
    pub fn at_design(&self) -> AxlePlan {
        AxlePlan {
            course: self.course.at_design(),
            ..self.values_alone()
        }
    }
}

impl Axle {
    /// Whether the steering wheel, turned to the left, steers the wheels to the right.
    pub fn turns_against(&self, plan: &AxlePlan) -> bool {
        if self.setup.c_factor.is_none() || self.setup.wheel_radius.is_none() {
            return false;
        }
        let plan = AxlePlan {
            quantities: vec![Quantity::Axle(AxleQuantity::SteeringRatio)],
            derivatives: 0,
            ..plan.at_design()
        };
        let ratio = axle_curves(self, &plan).ok();
        let ratio = ratio.and_then(|curves| curves.stations.first()?.value(0));
        ratio.is_some_and(|ratio| ratio < 0.0)
    }
}

/// A station with its values, as they are printed.
#[derive(Clone, Debug)]
pub struct AxleStation {
    /// What was asked for.
    pub placement: Placement,
    /// The position that was found, or why there is none.
    pub placed: Result<Placed, AxleFailure>,
    /// Word of the `status` column.
    pub status: &'static str,
    /// A value for each column, or why there is none.
    pub values: Vec<Result<f64, Void>>,
    /// For each wheel: the rod that is at or beyond a toggle, if any.
    pub toggles: [Option<Rod>; 2],
    /// Condition number of the worse wheel.
    pub condition: Option<f64>,
    /// Proof of the position, if the plan asks for it and it could be proved.
    pub proof: Option<AxleProof>,
}

impl AxleStation {
    /// The value of a column, where there is one.
    pub fn value(&self, column: usize) -> Option<f64> {
        self.values.get(column).copied().and_then(Result::ok)
    }

    /// A station that has no position, or none that could be proved.
    fn failed(placement: Placement, failure: AxleFailure) -> Self {
        AxleStation {
            placement,
            placed: Err(failure),
            status: failure.word(),
            values: Vec::new(),
            toggles: [None; 2],
            condition: None,
            proof: None,
        }
    }
}

/// The derivative of a column by a hardpoint coordinate, as printed per length unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxleSensitivity {
    /// Index of the station.
    pub station: usize,
    /// Index of the column.
    pub column: usize,
    /// The side whose hardpoint moves; `None` if both move, the right wheel being the mirror image.
    pub side: Option<Side>,
    /// The hardpoint.
    pub point: PointId,
    /// The coordinate, in the study's axes.
    pub axis: Axis,
    /// The derivative.
    pub value: f64,
}

/// Curves of an axle.
#[derive(Clone, Debug)]
pub struct AxleCurves {
    /// The columns, in the order of [`AxleStation::values`].
    pub columns: Vec<AxleColumn>,
    /// The stations, in the order of the course.
    pub stations: Vec<AxleStation>,
    /// The sensitivities, station by station.
    pub sensitivities: Vec<AxleSensitivity>,
}

impl AxlePlan {
    /// Highest derivative by travel and rack that is read of a wheel.
    pub fn degree(&self) -> usize {
        self.degree_for(!self.sensitivities.is_empty())
    }

    /// Highest derivative by travel and rack that is read of a wheel, if derivatives by the design are formed or not.
    pub(crate) fn degree_for(&self, by_design: bool) -> usize {
        let orders = self.quantities.iter().map(|q| q.rate_order());
        let along = self.derivatives;
        // On a plane, a derivative by the design moves the travels too.
        let by_design = usize::from(by_design && self.is_on_plane());
        orders.max().unwrap_or(0) + along.max(by_design)
    }

    fn is_on_plane(&self) -> bool {
        self.course.shows_roll()
    }
}

/// Computes the curves of an axle under a plan. Errors if the design position of a wheel cannot be solved.
pub fn axle_curves(axle: &Axle, plan: &AxlePlan) -> Result<AxleCurves, (Side, DesignFault)> {
    match plan.certify {
        true => on_large_stacks(1, || curves_here(axle, plan)),
        false => curves_here(axle, plan),
    }
}

fn curves_here(axle: &Axle, plan: &AxlePlan) -> Result<AxleCurves, (Side, DesignFault)> {
    match plan.degree() {
        0 => run::<1>(axle, plan),
        1 => run::<2>(axle, plan),
        2 => run::<3>(axle, plan),
        _ => run::<4>(axle, plan),
    }
}

fn run<const N: usize>(axle: &Axle, plan: &AxlePlan) -> Result<AxleCurves, (Side, DesignFault)> {
    let columns = plan.columns(axle);
    let by_rack = plan.derivatives > 0 && plan.course.shows_rack;
    let mut solver = AxleSolver::<N>::new(axle, &plan.quantities, by_rack)?;
    solver.read_points(&plan.points);
    let loads = Side::ALL.map(|side| plan.carried(axle, side));
    for (side, loads) in Side::ALL.into_iter().zip(&loads) {
        solver.watch(side, loads.rocker());
    }
    let mut sensitivities = Vec::new();
    let mut stations = Vec::with_capacity(plan.course.stations());
    let mut curves = Curves::default();
    let placements = plan.course.placements();
    // In roll all positions are found together; travels that are given are read off curves.
    let mut rolled = match plan.course.wheels {
        WheelMotion::Roll { .. } => solver.place_all(&placements).into_iter(),
        _ => Vec::new().into_iter(),
    };
    for (station, placement) in placements.into_iter().enumerate() {
        let found = match rolled.next() {
            Some(placed) => placed.and_then(|placed| Ok((placed, solver.read(&placed)?))),
            None => curves.position(&mut solver, &plan.course, &placement),
        };
        let found = found.map(|(placed, read)| {
            let forces = forces(&loads, &solver, &placed, &read);
            values(&columns, &placement, placed, &read, forces)
        });
        let found = found.and_then(|found| {
            let placed = found.placed.as_ref();
            if let (false, Ok(placed)) = (plan.sensitivities.is_empty(), placed) {
                let more = gradients(axle, plan, &mut solver, &columns, placed, station)?;
                // A column without a value has no derivatives.
                let has_value = |s: &AxleSensitivity| found.values[s.column].is_ok();
                sensitivities.extend(more.into_iter().filter(has_value));
            }
            Ok(found)
        });
        stations.push(found.unwrap_or_else(|failure| AxleStation::failed(placement, failure)));
    }
    if plan.certify {
        certify(axle, &mut solver, &mut stations);
        sensitivities.retain(|s: &AxleSensitivity| stations[s.station].placed.is_ok());
    }
    Ok(AxleCurves {
        columns,
        stations,
        sensitivities,
    })
}

/// Proves every position: that it is right, and that the pose of each wheel lies on the branch of its design position.
/// A station that cannot be proved becomes a failed station.
fn certify<const N: usize>(axle: &Axle, solver: &mut AxleSolver<N>, stations: &mut [AxleStation]) {
    let certifier = AxleCertifier::new(axle);
    let rack = |station: &AxleStation| station.placement.rack();
    for stations in stations.chunk_by_mut(|a, b| rack(a) == rack(b)) {
        let mut found: Vec<_> = stations.iter_mut().filter(|s| s.placed.is_ok()).collect();
        let Some(rack) = found.first().map(|s| rack(s)) else {
            continue;
        };
        let placed: Vec<_> = found.iter().filter_map(|s| s.placed.ok()).collect();
        let branches = Side::ALL.map(|side| {
            let wheel = side as usize;
            let travels: Vec<_> = placed.iter().map(|p| p.travels[wheel]).collect();
            let poses: Vec<_> = placed.iter().map(|p| p.poses()[wheel]).collect();
            solver.prove_branch(certifier.wheel(side), side, rack, (&travels, &poses))
        });
        for (number, station) in found.iter_mut().enumerate() {
            let on_branch = branches[0][number].and(branches[1][number]);
            let proof =
                on_branch.and_then(|()| certifier.prove(&station.placement, &placed[number]));
            match proof {
                Ok(proof) => station.proof = Some(proof),
                Err(failure) => **station = AxleStation::failed(station.placement, failure),
            }
        }
    }
}

/// The curves of both wheels at one rack displacement, for placements that give their travels.
#[derive(Default)]
struct Curves {
    rack: Option<f64>,
    travels: [Vec<f64>; 2],
    wheels: [Vec<Result<WheelRead, AxleFailure>>; 2],
}

impl Curves {
    /// Finds and reads a position: from the curves of both wheels if their travels are given, else by itself.
    fn position<'a, const N: usize>(
        &mut self,
        solver: &mut AxleSolver<'a, N>,
        course: &AxleMotion,
        placement: &Placement,
    ) -> Result<(Placed, Read<'a>), AxleFailure> {
        let Placement::Travels {
            travels,
            rack,
            on_plane,
        } = *placement
        else {
            let placed = solver.place(placement)?;
            return Ok((placed, solver.read(&placed)?));
        };
        if self.rack != Some(rack) {
            self.travels = match &course.wheels {
                WheelMotion::Heave(values) => [values.clone(), values.clone()],
                WheelMotion::Travels { left, right, .. } => [left.clone(), right.clone()],
                WheelMotion::Roll { .. } => travels.map(|travel| vec![travel]),
            };
            self.rack = Some(rack);
            self.wheels =
                Side::ALL.map(|side| solver.wheel_curve(side, &self.travels[side as usize], rack));
        }
        let wheel = |side: usize| {
            let mut values = self.travels[side].iter();
            let station = values.position(|travel| *travel == travels[side]);
            let station = station.expect("a station of the course");
            self.wheels[side][station]
                .as_ref()
                .map_err(|failure| *failure)
        };
        solver.pair(both(wheel(0), wheel(1))?, rack, on_plane)
    }
}

fn values(
    columns: &[AxleColumn],
    placement: &Placement,
    placed: Placed,
    read: &Read,
    forces: Vec<Result<f64, Void>>,
) -> AxleStation {
    let value = |value: Result<f64, Void>, column: &AxleColumn| {
        let printed = value? * column.factor;
        printed
            .is_finite()
            .then_some(printed)
            .ok_or(Void::NotFinite)
    };
    let quantities = columns
        .iter()
        .filter_map(|c| Some(value(c.evaluate(read)?, c)));
    let values: Vec<_> = quantities.chain(forces).collect();
    let differentiates = columns
        .iter()
        .any(|c| c.by.is_some() || c.quantity().is_some_and(|q| q.rate_order() > 0));
    let is_poor = differentiates && rate_digits(read.condition) < LEAST_DIGITS;
    AxleStation {
        placement: *placement,
        placed: Ok(placed),
        status: match &values {
            v if v.contains(&Err(Void::Toggle)) => "toggle",
            v if v.contains(&Err(Void::Unsupported)) => Status::Unsupported.word(),
            _ if is_poor => Status::IllConditioned.word(),
            _ => Status::Ok.word(),
        },
        values,
        toggles: read.toggles,
        condition: Some(read.condition),
        proof: None,
    }
}

/// The forces that carry the loads on both wheels.
fn forces<const N: usize>(
    loads: &[Loads<'_>; 2],
    solver: &AxleSolver<N>,
    placed: &Placed,
    read: &Read,
) -> Vec<Result<f64, Void>> {
    let mut forces = Vec::new();
    for (side, loads) in Side::ALL.into_iter().zip(loads) {
        if loads.is_empty() {
            continue;
        }
        let none = |void: Void| loads.columns().map(move |_| Err(void));
        let is_stuck = loads.rocker().is_some() && read.toggles[side as usize].is_some();
        match solver.balance(side, placed, loads.support) {
            _ if is_stuck => forces.extend(none(Void::Toggle)),
            Err(_) => forces.extend(none(Void::Unsupported)),
            Ok(balance) => {
                let contact = read.state.wheel(side).contact_point();
                let found = loads.forces(&balance, contact);
                forces.extend(found.map(|force| force.ok_or(Void::NotFinite)));
            }
        }
    }
    forces
}

fn gradients<const N: usize>(
    axle: &Axle,
    plan: &AxlePlan,
    solver: &mut AxleSolver<N>,
    columns: &[AxleColumn],
    placed: &Placed,
    station: usize,
) -> Result<Vec<AxleSensitivity>, AxleFailure> {
    let mut found = Vec::new();
    let is_own = axle.right.is_some();
    let values = columns.iter().enumerate().filter(|(_, c)| c.by.is_none());
    let sought = values.filter_map(|(column, c)| match c.of {
        Of::Quantity(quantity) => Some((column, Sought::Quantity(quantity))),
        Of::Point { side, id, axis, .. } => Some((column, Sought::Point(side, id, axis))),
        Of::Turn(..) | Of::Force { .. } => None,
    });
    let (of, sought): (Vec<_>, Vec<_>) = sought.unzip();
    solver.gradients_of(placed, &sought, &mut |number, [left, right]| {
        let column = of[number];
        let factor = columns[column].factor;
        for point in &plan.sensitivities {
            for axis in Axis::ALL {
                let frames = Side::ALL.map(|s| axle.suspension(s).frame);
                let by = [left, right].map(|g| g[point.0][axis] * factor);
                let mut add = |side, value| {
                    found.push(AxleSensitivity {
                        station,
                        column,
                        side,
                        point: *point,
                        axis,
                        value,
                    });
                };
                match is_own {
                    // The mirror image moves with it.
                    false => add(None, (by[0] + by[1]) * frames[0].sign(axis)),
                    true => {
                        add(Some(Side::Left), by[0] * frames[0].sign(axis));
                        add(Some(Side::Right), by[1] * frames[1].sign(axis));
                    }
                }
            }
        }
    })?;
    Ok(found)
}

impl AxleCurves {
    /// Whether everything asked for was found: at every station, and in every column at some.
    pub fn are_complete(&self) -> bool {
        let solved = |s: &&AxleStation| s.placed.is_ok();
        let all = self
            .stations
            .iter()
            .all(|s| s.placed.is_ok() && s.status != "toggle" && s.status != "unsupported");
        let has_value = |column: usize| {
            let mut stations = self.stations.iter().filter(solved);
            stations.any(|s| s.values[column].is_ok())
        };
        all && (0..self.columns.len()).all(has_value)
    }

    /// Numbers of empty cells by column and reason, at stations that were solved.
    pub fn empty_cells(&self) -> Vec<(usize, Void, usize)> {
        let mut counts: Vec<(usize, Void, usize)> = Vec::new();
        for column in 0..self.columns.len() {
            let is_whole = |s: &&AxleStation| s.placed.is_ok() && s.status != "toggle";
            let cells = self.stations.iter().filter(is_whole);
            let voids = cells.filter_map(|s| s.values[column].err());
            // Of loads all cells are empty together.
            for void in voids.filter(|void| *void != Void::Unsupported) {
                match counts.iter_mut().find(|c| c.0 == column && c.1 == void) {
                    Some(count) => count.2 += 1,
                    None => counts.push((column, void, 1)),
                }
            }
        }
        counts
    }

    /// The least wheel load of either wheel and its station, if wheel loads are asked for.
    pub fn least_wheel_load(&self) -> Option<(f64, &AxleStation)> {
        let is_load = |c: &AxleColumn| {
            c.by.is_none()
                && matches!(
                    c.quantity(),
                    Some(Quantity::Wheel(_, super::WheelQuantity::WheelLoad))
                )
        };
        let loads = self.columns.iter().enumerate().filter(|(_, c)| is_load(c));
        let all = loads.flat_map(|(k, _)| {
            let stations = self.stations.iter();
            stations.filter_map(move |s| Some((s.values.get(k)?.ok()?, s)))
        });
        all.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

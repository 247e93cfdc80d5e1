//! Curves of an axle: every quantity at every station.

use super::places::{bounds, motion_columns, place, proof};
use super::series::ByGear;
use super::solver::{AxlePose, AxleSolver, Placement, Read, WheelRead, join_results};
use super::{Axle, AxleCertifier, AxleColumn, AxleMotion, AxleQuantity, Quantity, WheelMotion};
use crate::ask::NoValue;
use crate::curves::{ByTime, Column, Curves, Loads, Sensitivity, Station, Status};
use crate::mechanism::{DesignFault, NoPose};
use crate::model::{Axis, PointId, Side};
use crate::number::Each;
use crate::solve::{LEAST_DIGITS, rate_digits};
use crate::study::Load;
use crate::threads::on_large_stacks;

/// Results to compute for an axle, and the stations at which to compute them.
#[derive(Clone, Debug, PartialEq)]
pub struct AxlePlan {
    /// Motion that defines the stations.
    pub motion: AxleMotion,
    /// Quantities, in the order of the study.
    pub quantities: Vec<Quantity>,
    /// Order of the highest derivatives along the motions in the results, at most 2.
    pub derivatives: usize,
    /// Hardpoints for which gradients are computed. May be empty.
    pub sensitivities: Vec<PointId>,
    /// True if each pose must be certified.
    pub certify: bool,
    /// Points whose coordinates are in the results.
    pub points: Vec<PointId>,
    /// True if results contain the angular velocities of the wheel carriers.
    pub knuckle: bool,
    /// Loads on the left and the right wheel, each in the kernel's frame of its side.
    pub loads: [Vec<Load>; 2],
}

impl AxlePlan {
    /// Makes a plan with only these quantities over a motion.
    pub fn of(motion: AxleMotion, quantities: Vec<Quantity>) -> AxlePlan {
        AxlePlan {
            motion,
            quantities,
            derivatives: 0,
            sensitivities: Vec::new(),
            certify: false,
            points: Vec::new(),
            knuckle: false,
            loads: Default::default(),
        }
    }

    /// Returns this plan without sensitivities and certificates.
    pub fn values_alone(&self) -> AxlePlan {
        AxlePlan {
            sensitivities: Vec::new(),
            certify: false,
            ..self.clone()
        }
    }

    /// Returns a plan for the same quantities over the same motion, without any other results.
    pub fn quantities_alone(&self) -> AxlePlan {
        AxlePlan::of(self.motion.clone(), self.quantities.clone())
    }

    /// Returns a plan for the same quantities in the design position.
    pub fn at_design(&self) -> AxlePlan {
        AxlePlan {
            motion: self.motion.at_design(),
            ..self.values_alone()
        }
    }
}

impl Axle {
    /// Returns true if a turn of the steering wheel to the left steers the wheels to the right.
    pub fn turns_against(&self, plan: &AxlePlan) -> bool {
        if self.setup.c_factor.is_none() || self.setup.wheel_radius.is_none() {
            return false;
        }
        let plan = AxlePlan {
            quantities: vec![Quantity::Axle(AxleQuantity::SteeringRatio)],
            derivatives: 0,
            ..plan.at_design()
        };
        // In an equilibrium, the steering ratio does not exist. In the design position, the ratio of the rigid mechanism
        // has the same sign.
        let ratio = curves_here(self, &plan).ok();
        let ratio = ratio.and_then(|found| found.curves.stations.first()?.value(0));
        ratio.is_some_and(|ratio| ratio < 0.0)
    }
}

/// Curves of an axle, and their poses.
#[derive(Clone, Debug)]
pub struct AxleCurves {
    /// Values of all columns at all stations.
    pub curves: Curves,
    /// Pose of both wheels at each station, or the reason why a station has no pose. Empty for an axle with elastic
    /// parts.
    pub placed: Vec<Result<AxlePose, NoPose>>,
}

impl AxlePlan {
    /// Order of the highest derivative of a wheel, with respect to travel and rack, that the plan needs.
    pub fn degree(&self) -> usize {
        self.degree_for(!self.sensitivities.is_empty())
    }

    /// Order of the highest derivative of a wheel, with respect to travel and rack, that the plan needs. `by_design` is
    /// true if derivatives with respect to the design are computed.
    pub(crate) fn degree_for(&self, by_design: bool) -> usize {
        let orders = self.quantities.iter().map(|q| q.rate_order());
        let along = self.derivatives;
        // On a plane, the travels depend on the design. So gradients contain one more derivative with respect to travel.
        let by_design = usize::from(by_design && self.is_on_plane());
        orders.max().unwrap_or(0) + along.max(by_design)
    }

    fn is_on_plane(&self) -> bool {
        self.motion.shows_roll()
    }
}

/// Computes the curves of an axle. The error is the reason why the design position of a wheel cannot be solved.
pub fn axle_curves(axle: &Axle, plan: &AxlePlan) -> Result<AxleCurves, (Side, DesignFault)> {
    if let Some(elastic) = &axle.elastic {
        return super::elastic::curves(axle, elastic, plan);
    }
    if plan.certify {
        on_large_stacks(1, || curves_here(axle, plan))
    } else {
        curves_here(axle, plan)
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
    let by_rack = plan.derivatives > 0 && plan.motion.shows_rack;
    let mut solver = AxleSolver::<N>::new(axle, &plan.quantities, by_rack)?;
    solver.find_conditions();
    solver.read_points(&plan.points);
    let loads = Side::ALL.map(|side| plan.carried(axle, side));
    for (side, loads) in Side::ALL.into_iter().zip(&loads) {
        solver.watch(side, loads.rocker());
    }
    let placements = plan.motion.placements();
    let mut found = AxleCurves {
        curves: Curves {
            motion: motion_columns(&plan.motion, axle),
            columns: columns.iter().map(Column::from).collect(),
            bounds: bounds(plan, axle),
            ..Curves::default()
        },
        placed: Vec::with_capacity(placements.len()),
    };
    let mut of_wheels = WheelCurves::default();
    // Poses in roll are solved together. If travels are given, the poses are taken from the curves of the wheels.
    let mut rolled = match plan.motion.wheels {
        WheelMotion::Roll { .. } => solver.place_all(&placements).into_iter(),
        _ => Vec::new().into_iter(),
    };
    for (number, placement) in placements.iter().enumerate() {
        let read = match rolled.next() {
            Some(placed) => placed.and_then(|placed| Ok((placed, solver.read(&placed)?))),
            None => of_wheels.position(&mut solver, &plan.motion, placement),
        };
        let station = read.and_then(|(placed, read)| {
            let forces = forces(&loads, &solver, &placed, &read);
            let law = plan.motion.time.as_ref().map(|time| &time.law);
            let time = ByTime::at(law, plan.motion.time_at(number));
            let by_drag_link = solver.by_drag_link(&placed, &columns)?;
            let mut station = values((&columns, &by_drag_link), &read, time, forces);
            station.at = place(&plan.motion, axle, (number, placement), Some(&placed));
            if !plan.sensitivities.is_empty() {
                let more = gradients(axle, plan, &mut solver, &columns, &placed, number)?;
                // If the value of a column does not exist, its derivatives do not exist either.
                let has_value = |s: &Sensitivity| station.values[s.column].is_ok();
                let all = &mut found.curves.sensitivities;
                all.extend(more.into_iter().filter(has_value));
            }
            Ok((placed, station))
        });
        let (placed, station) = match station {
            Ok((placed, station)) => (Ok(placed), station),
            Err(reason) => {
                let at = place(&plan.motion, axle, (number, placement), None);
                (Err(reason), failed(at, reason, columns.len()))
            }
        };
        found.placed.push(placed);
        found.curves.stations.push(station);
    }
    if plan.certify {
        certify(axle, plan, &placements, &mut solver, &mut found);
        let AxleCurves { curves, placed } = &mut found;
        curves.sensitivities.retain(|s| placed[s.station].is_ok());
    }
    Ok(found)
}

/// Makes a station without results: the station has no pose, or the pose could not be certified.
fn failed(at: Vec<Option<f64>>, reason: NoPose, columns: usize) -> Station {
    Station {
        at,
        status: Status::Failed(reason),
        values: vec![Err(NoValue::NoPose); columns],
        condition: None,
        proof: None,
    }
}

/// Certifies that each computed pose is within its bounds of an exact pose. Also certifies that the pose of each wheel
/// lies on the solution branch of its design position. If a station cannot be certified, it becomes a station without
/// results.
fn certify<const N: usize>(
    axle: &Axle,
    plan: &AxlePlan,
    placements: &[Placement],
    solver: &mut AxleSolver<N>,
    found: &mut AxleCurves,
) {
    let certifier = AxleCertifier::new(axle);
    let stations: Vec<usize> = (0..placements.len()).collect();
    let is_rigid = solver.is_rigid();
    let rack_of = |station: usize| {
        if is_rigid {
            placements[station].mean()
        } else {
            placements[station].rack()
        }
    };
    for stations in stations.chunk_by(|a, b| rack_of(*a) == rack_of(*b)) {
        let rack = rack_of(stations[0]);
        let known = stations.iter();
        let known = known.filter_map(|number| Some((*number, found.placed[*number].ok()?)));
        let (numbers, placed): (Vec<usize>, Vec<AxlePose>) = known.unzip();
        let branches = Side::ALL.map(|side| {
            let wheel = side as usize;
            let drive = |p: &AxlePose| solver.coordinates(p.travels, p.rack)[wheel].0;
            let travels: Vec<_> = placed.iter().map(drive).collect();
            let poses: Vec<_> = placed.iter().map(|p| p.poses()[wheel]).collect();
            solver.prove_branch(certifier.wheel(side), side, rack, (&travels, &poses))
        });
        for (k, number) in numbers.into_iter().enumerate() {
            let on_branch = branches[0][k].and(branches[1][k]);
            let proved = on_branch.and_then(|()| certifier.prove(&placements[number], &placed[k]));
            let station = &mut found.curves.stations[number];
            match proved {
                Ok(proved) => station.proof = Some(proof(plan, &proved)),
                Err(reason) => {
                    found.placed[number] = Err(reason);
                    let at = place(&plan.motion, axle, (number, &placements[number]), None);
                    *station = failed(at, reason, station.values.len());
                }
            }
        }
    }
}

/// Curves of both wheels at one rack displacement, for placements whose travels are given.
#[derive(Default)]
struct WheelCurves {
    rack: Option<f64>,
    travels: [Vec<f64>; 2],
    wheels: [Vec<Result<WheelRead, NoPose>>; 2],
}

impl WheelCurves {
    /// Finds a pose and computes its quantities. For given travels of independently suspended wheels, the function combines the
    /// poses on the stored curves of both wheels. For a solid axle, and without given travels, it solves the pose.
    fn position<'a, const N: usize>(
        &mut self,
        solver: &mut AxleSolver<'a, N>,
        motion: &AxleMotion,
        placement: &Placement,
    ) -> Result<(AxlePose, Read<'a>), NoPose> {
        let Placement::Travels {
            travels,
            rack,
            on_plane,
        } = *placement
        else {
            let placed = solver.place(placement)?;
            return Ok((placed, solver.read(&placed)?));
        };
        if solver.is_rigid() {
            let placed = solver.place(placement)?;
            return Ok((placed, solver.read(&placed)?));
        }
        if self.rack != Some(rack) || motion.has_rows() {
            self.travels = match &motion.wheels {
                _ if motion.has_rows() => travels.map(|travel| vec![travel]),
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
            let station = station.expect("the travel belongs to a station of the motion");
            self.wheels[side][station]
                .as_ref()
                .map_err(|failure| *failure)
        };
        solver.pair(join_results(wheel(0), wheel(1))?, rack, on_plane)
    }
}

/// Returns the values of a station. The coordinates of the station are not set yet.
fn values(
    (columns, by_drag_link): (&[AxleColumn], &[Option<ByGear>]),
    read: &Read,
    time: ByTime,
    forces: Vec<Result<f64, NoValue>>,
) -> Station {
    let value = |value: Result<f64, NoValue>, column: &AxleColumn| {
        let printed = value? * column.factor;
        printed
            .is_finite()
            .then_some(printed)
            .ok_or(NoValue::NotFinite)
    };
    let quantities = columns.iter().enumerate().filter_map(|(k, c)| {
        let by = by_drag_link.get(k).copied().flatten();
        Some(value(c.evaluate(read, time, by)?, c))
    });
    let values: Vec<_> = quantities.chain(forces).collect();
    let differentiates = columns
        .iter()
        .any(|c| c.by.is_some() || c.quantity().is_some_and(|q| q.rate_order() > 0));
    let is_poor_at = |condition: f64| rate_digits(condition) < LEAST_DIGITS;
    let is_poor = differentiates && read.condition.is_some_and(is_poor_at);
    Station {
        at: Vec::new(),
        status: match &values {
            v if v.contains(&Err(NoValue::Toggle)) => Status::Toggle(read.toggles),
            v if v.contains(&Err(NoValue::Unsupported)) => Status::Unsupported,
            _ if is_poor => Status::IllConditioned,
            _ => Status::Ok,
        },
        values,
        condition: read.condition,
        proof: None,
    }
}

/// Forces in the members that carry the loads on both wheels.
fn forces<const N: usize>(
    loads: &[Loads<'_>; 2],
    solver: &AxleSolver<N>,
    placed: &AxlePose,
    read: &Read,
) -> Vec<Result<f64, NoValue>> {
    let mut forces = Vec::new();
    for (side, loads) in Side::ALL.into_iter().zip(loads) {
        if loads.is_empty() {
            continue;
        }
        let none = |void: NoValue| loads.columns().map(move |_| Err(void));
        let is_stuck = loads
            .rocker()
            .is_some_and(|rocker| read.holds(side, rocker));
        match solver.balance(side, placed, loads.support) {
            _ if is_stuck => forces.extend(none(NoValue::Toggle)),
            Err(_) => forces.extend(none(NoValue::Unsupported)),
            Ok(balance) => {
                let contact = read.state.wheel(side).contact_point();
                let found = loads.forces(&balance, contact);
                forces.extend(found.map(|force| force.ok_or(NoValue::NotFinite)));
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
    placed: &AxlePose,
    station: usize,
) -> Result<Vec<Sensitivity>, NoPose> {
    let mut found = Vec::new();
    // For a rigid axle, derivatives are with respect to the points of the left half. The points of the right half move
    // with them.
    let is_own = axle.own_right().is_some();
    let values = columns.iter().enumerate().filter(|(_, c)| c.by.is_none());
    let sought = values.filter_map(|(column, c)| Some((column, c.sought()?)));
    let (of, sought): (Vec<_>, Vec<_>) = sought.unzip();
    solver.gradients_of(placed, &sought, &mut |number, [left, right]| {
        let column = of[number];
        let factor = columns[column].factor;
        for point in &plan.sensitivities {
            for axis in Axis::ALL {
                let frames = Side::ALL.each(|s| axle.suspension(s).frame);
                let by = [left, right].each(|g| g[point.0][axis] * factor);
                let mut add = |side, value| {
                    found.push(Sensitivity {
                        station,
                        column,
                        side,
                        point: *point,
                        axis,
                        value,
                    });
                };
                if is_own {
                    add(Some(Side::Left), by[0] * frames[0].sign(axis));
                    add(Some(Side::Right), by[1] * frames[1].sign(axis));
                } else {
                    // The points of the right wheel move with the points of the left wheel, so the derivatives of both
                    // are added.
                    add(None, (by[0] + by[1]) * frames[0].sign(axis))
                }
            }
        }
    })?;
    Ok(found)
}

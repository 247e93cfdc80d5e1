//! Quantities of a position, and their gradients.

use super::super::Of;
use super::super::series::ByGear;
use super::linearised::derivative_by_heave;
use super::*;

/// Callback with two arguments: the index of a requested quantity, and the gradients of this quantity with respect to
/// every point of the left and of the right wheel.
pub(in crate::axle) type ReceiveOwnGradients<'r> = dyn FnMut(usize, [&mut [Vector3<f64>]; 2]) + 'r;

/// State of an axle in a position, with all numbers that the requested quantities need.
pub struct Read<'a> {
    /// State of the axle.
    pub state: AxleState<'a, f64>,
    /// Condition number of the closure equations' Jacobian, the larger of the two wheels. `None` unless it is requested
    /// ([`AxleSolver::find_conditions`]).
    pub condition: Option<f64>,
    /// Rod of each wheel at or beyond a toggle. `None` if there is no such rod.
    pub toggles: [Option<Rod>; 2],
    axle: &'a Axle,
    /// Rockers of each wheel at or beyond a toggle.
    stuck: [Vec<RockerId>; 2],
    /// Positions of the points that [`AxleSolver::read_points`] selected, for each wheel. Each position is a power
    /// series in the wheel's own travel and rack, in the kernel's frame of its side.
    pub points: [Vec<Vector3<Taylor<f64>>>; 2],
}

impl Read<'_> {
    /// Value of a quantity, or the reason for a missing value.
    pub fn value(&self, quantity: Quantity) -> Result<f64, NoValue> {
        if self.is_stuck(quantity) {
            Err(NoValue::Toggle)
        } else {
            quantity.value(&self.state)
        }
    }

    /// Returns the failure if a rocker is at or beyond a toggle. Parts on this rocker then have no position. `None` if
    /// there is no such rocker.
    pub fn toggle_failure(&self, placed: &AxlePose) -> Option<NoPose> {
        Side::ALL.into_iter().find_map(|side| {
            Some(NoPose::Wheel {
                side,
                travel: placed.travels[side as usize],
                failure: Failure::Toggle(self.toggles[side as usize]?),
            })
        })
    }

    /// Returns true if a quantity depends on a rocker at or beyond a toggle.
    pub fn is_stuck(&self, quantity: Quantity) -> bool {
        let mut sides = Side::ALL.into_iter();
        sides.any(|side| {
            if self.stuck[side as usize].is_empty() {
                return false;
            }
            let rockers = match quantity.side() {
                Some(own) if own != side => self.axle.rockers_felt_across(side, quantity),
                _ => self.axle.rockers(side, &[quantity]),
            };
            rockers.into_iter().any(|rocker| self.holds(side, rocker))
        })
    }

    /// Returns true if a rocker of one wheel is at or beyond a toggle.
    pub(in crate::axle) fn holds(&self, side: Side, rocker: RockerId) -> bool {
        self.stuck[side as usize].contains(&rocker)
    }
}

impl<'a, const N: usize> AxleSolver<'a, N> {
    /// Computes the state of the axle in a position.
    pub fn read(&mut self, placed: &AxlePose) -> Result<Read<'a>, NoPose> {
        self.steer(placed.rack)?;
        let (lines, parts) = (self.lines, self.parts);
        let coordinates = self.coordinates(placed.travels, placed.rack);
        let mut wheel = |side: Side| {
            let corner = &mut self.corners[side as usize];
            let (travel, rack) = coordinates[side as usize];
            let pose = &placed.poses[side as usize];
            let found = corner.begin(rack).map_err(|_| Failure::Singular);
            let found = found.and_then(|()| corner.read(pose, travel, rack, (lines, &parts)));
            found.map_err(|failure| corner.fails(travel, failure))
        };
        let [left, right] = [wheel(Side::Left)?, wheel(Side::Right)?];
        Ok(self.both([&left, &right], placed))
    }

    /// Computes the numbers of one wheel at many travels and one rack displacement. The travels are solved outward from
    /// the design position. The curves of a single wheel are computed in the same way.
    pub fn wheel_curve(
        &mut self,
        side: Side,
        travels: &[f64],
        rack: f64,
    ) -> Vec<Result<WheelRead, NoPose>> {
        let (lines, parts) = (self.lines, self.parts);
        let corner = &mut self.corners[side as usize];
        let rack = rack * corner.rack_sign;
        let fails = |travel: f64, failure| NoPose::Wheel {
            side,
            travel,
            failure,
        };
        let unvisited = |travel: &f64| Err(fails(*travel, Failure::Singular));
        let mut found: Vec<_> = travels.iter().map(unvisited).collect();
        // The constructor has already checked the design position. Stations that cannot be reached keep their failure.
        if corner.begin(rack).is_err() {
            return found;
        }
        let Corner {
            solver,
            series,
            toggles,
            points,
            has_condition,
            ..
        } = corner;
        let wanted = Wanted {
            lines,
            parts: &parts,
            points,
            has_condition: *has_condition,
        };
        let order = StationOrder::through(travels);
        let _ = solver.for_each_pose(Drive::Travel, &order, rack, |solver, station, pose| {
            let travel = travels[station];
            let at = (travel, rack);
            let wheel = pose.and_then(|pose| read_wheel(solver, series, toggles, pose, at, wanted));
            found[station] = wheel.map_err(|failure| fails(travel, failure));
            ControlFlow::Continue(())
        });
        found
    }

    /// Combines the numbers of two wheels at their travels to a position of the axle.
    pub fn pair(
        &self,
        wheels: [&WheelRead; 2],
        rack: f64,
        on_plane: bool,
    ) -> Result<(AxlePose, Read<'a>), NoPose> {
        checkpoint();
        let poses = wheels.each(|wheel| wheel.pose);
        let (roll, hold) = if on_plane {
            (self.tilted(&poses)?, Hold::TravelsOnPlane)
        } else {
            (0.0, Hold::TravelsOnPads)
        };
        let placed = AxlePose {
            travels: wheels.each(|wheel| wheel.travel),
            roll,
            rack,
            hold,
            at_load: None,
            poses,
        };
        Ok((placed, self.both(wheels, &placed)))
    }

    pub(super) fn both(&self, wheels: [&WheelRead; 2], placed: &AxlePose) -> Read<'a> {
        let [left, right] = wheels;
        Read {
            state: self.state([left.reading, right.reading], placed),
            condition: (left.condition.zip(right.condition)).map(|(l, r)| l.max(r)),
            toggles: [left.toggle, right.toggle],
            axle: self.axle,
            stuck: [left.stuck.clone(), right.stuck.clone()],
            points: [left.points.clone(), right.points.clone()],
        }
    }

    pub(super) fn state<T: crate::number::Real>(
        &self,
        readings: [Reading<T>; 2],
        placed: &AxlePose,
    ) -> AxleState<'a, T> {
        let like = readings[0].like();
        AxleState {
            readings,
            ground: Ground::rolled(placed.roll).map(|c| like.constant(c)),
            roll: like.constant(placed.roll),
            hold: placed.hold,
            carriers: Carriers::of(self.axle),
            setup: self.setup,
        }
    }

    /// Computes gradients of quantities in a position with respect to every hardpoint coordinate of each side, in the
    /// frame of that side. The arguments of `receive` are the index of the quantity and both gradients. Each gradient
    /// has one entry per point. For a rigid axle, the left gradient contains the sum for both halves, and the right is 0.
    ///
    /// A gradient is NaN if its quantity needs more terms than the `N` terms of the series.
    pub fn gradients(
        &mut self,
        placed: &AxlePose,
        quantities: &[Quantity],
        mut receive: impl FnMut(usize, [&[Vector3<f64>]; 2]),
    ) -> Result<(), NoPose> {
        let sought: Vec<_> = quantities.iter().copied().map(Sought::Quantity).collect();
        self.gradients_of(placed, &sought, &mut receive)
    }

    /// Computes gradients of quantities, where every point of both sides can move separately. For a rigid axle, the
    /// first gradient is with respect to all points of the left design. The second gradient is with respect to all
    /// points of the axle as seen from its right wheel.
    pub(crate) fn gradients_by_each_point(
        &mut self,
        placed: &AxlePose,
        quantities: &[Quantity],
        mut receive: impl FnMut(usize, [&[Vector3<f64>]; 2]),
    ) -> Result<(), NoPose> {
        let sought: Vec<_> = quantities.iter().copied().map(Sought::Quantity).collect();
        let by_heave = self.heave_by_points(placed)?;
        self.each_gradient(placed, &sought, by_heave, &mut |number, [left, right]| {
            receive(number, [left, right]);
        })
    }

    /// Returns the derivatives of the mean travel with respect to the points. `None` if the mean travel is not computed
    /// from a load.
    fn heave_by_points(
        &mut self,
        placed: &AxlePose,
    ) -> Result<Option<[Vec<Vector3<f64>>; 2]>, NoPose> {
        let Some(level) = placed.at_load else {
            return Ok(None);
        };
        Ok(Some(self.loads()?.heave_by_design(level, placed)?))
    }

    /// Computes gradients of quantities and of coordinates of points. Gradients of coordinates are in the frame of their
    /// side.
    pub(in crate::axle) fn gradients_of(
        &mut self,
        placed: &AxlePose,
        sought: &[Sought],
        receive: &mut ReceiveGradients<'_>,
    ) -> Result<(), NoPose> {
        let by_heave = self.heave_by_points(placed)?;
        let rigid = self.rigid();
        self.each_gradient(placed, sought, by_heave, &mut |number, [left, right]| {
            if let Some(rigid) = rigid {
                rigid.gather([left, right]);
            }
            receive(number, [left, right]);
        })
    }

    /// Computes first and second derivatives of columns with respect to the displacement of a steered axle's steering
    /// gear. Second derivatives are NaN if no column needs them. `None` for a column that is not differentiated along
    /// the rack. Empty for an axle without a drag link.
    pub(crate) fn by_drag_link(
        &mut self,
        placed: &AxlePose,
        columns: &[AxleColumn],
    ) -> Result<Vec<Option<ByGear>>, NoPose> {
        if !self.is_steered() {
            return Ok(Vec::new());
        }
        let mut found = vec![None; columns.len()];
        let numbers = 0..columns.len();
        let moved: Vec<usize> = numbers
            .filter(|number| columns[*number].by == Some(Motion::Rack))
            .collect();
        let is_second = |number: &usize| {
            let column = &columns[*number];
            column.order > 1 || matches!(column.of, Of::Turn(..))
        };
        if moved.iter().any(is_second) {
            let read = self.read(placed)?;
            let own = moved.iter().map(|number| &columns[*number]);
            let second = self.second_by_gear(self.axle, (placed, &read), own);
            for (number, by) in moved.iter().zip(second.into_iter().flatten()) {
                found[*number] = Some(by);
            }
        }
        let (numbers, sought): (Vec<_>, Vec<_>) = moved
            .into_iter()
            .filter_map(|number| Some((number, columns[number].sought()?)))
            .unzip();
        if numbers.is_empty() {
            return Ok(found);
        }
        // The adjoint method also returns first derivatives of quantities that contain velocities. The series of
        // `second_by_gear` do not.
        for (number, by) in numbers
            .into_iter()
            .zip(self.by_steering_gear(placed, &sought)?)
        {
            let [_, second] = found[number].unwrap_or([f64::NAN; 2]);
            found[number] = Some([by, second]);
        }
        Ok(found)
    }

    /// Computes derivatives of quantities and of point coordinates with respect to the displacement of a steered axle's
    /// steering gear, by equation (2) of `model/steered_axle.rs`. The other coordinates of the station stay constant.
    fn by_steering_gear(
        &mut self,
        placed: &AxlePose,
        sought: &[Sought],
    ) -> Result<Vec<f64>, NoPose> {
        let axle = self.axle;
        let mut found = vec![f64::NAN; sought.len()];
        self.each_gradient(placed, sought, None, &mut |number, gradients| {
            let by_gear = axle.by_steering_gear(gradients.map(|gradient| &*gradient));
            found[number] = by_gear.unwrap_or(f64::NAN);
        })?;
        Ok(found)
    }

    /// Computes gradients with respect to every point of both sides, including points that are computed from other
    /// points. If the mean travel is computed from a load, `by_heave` contains the derivatives of the mean travel with
    /// respect to the points.
    pub(in crate::axle) fn each_gradient(
        &mut self,
        placed: &AxlePose,
        sought: &[Sought],
        by_heave: Option<[Vec<Vector3<f64>>; 2]>,
        receive: &mut ReceiveOwnGradients<'_>,
    ) -> Result<(), NoPose> {
        let (lines, parts) = (self.lines, self.parts);
        let coordinates = self.coordinates(placed.travels, placed.rack);
        let plain = self.read(placed)?.state;
        let slopes = {
            let [left, right] = plain.wheels().each(|wheel| wheel.rise());
            [left + right, plain.track()]
        };
        let linearised = linearise(&self.corners, (lines, parts), placed, coordinates)?;
        let inputs = linearised.inputs();
        // The tape records both wheels once, then every quantity.
        let tape = Tape::new();
        let [(left, of_left), (right, of_right)] = linearised.on_tape(&tape);
        let (readings, first) = ([left, right], [of_left, of_right]);
        let state = self.state(readings, placed).settled(slopes);
        let value = |sought: &Sought| match sought {
            Sought::Quantity(quantity) => quantity.evaluate(&state),
            // A point moves with the travel of its wheel. If the ground determines this travel, it depends on the
            // design.
            Sought::Point(side, ..) => state.readings[*side as usize].travel(),
        };
        let values: Vec<_> = sought.iter().map(value).collect();
        tape.gradients(&values, of_right + inputs, |number, by_numbers| {
            let sought = &sought[number];
            for side in Side::ALL {
                let by = &by_numbers[first[side as usize]..][..inputs];
                let gradient = &mut self.gradients[side as usize];
                gradient.fill(Vector3::new(0.0, 0.0, 0.0));
                linearised.add_gradient(side, by, &mut self.buffer, gradient);
            }
            if let Sought::Point(side, id, axis) = *sought {
                let linearised = &linearised.wheels[side as usize][0];
                let by_travel = linearised.at.point(id)[axis].0.get(1).copied();
                for by in self.gradients.iter_mut().flatten() {
                    // Without a derivative with respect to travel, the wheels are on pads. There, the travels do not depend
                    // on the design, so this term is 0.
                    *by = *by * by_travel.unwrap_or(0.0);
                }
                let zero = Vector3::new(0.0, 0.0, 0.0);
                self.buffer.fill(zero.map(Jet::constant));
                let along = Axis::ALL.each(|other| Jet::constant(f64::from(other == axis)));
                linearised.gradient(&mut self.buffer, |sink| sink.point(id, along.into()));
                let own = self.gradients[side as usize].iter_mut();
                for (total, by) in own.zip(&self.buffer) {
                    *total = *total + by.map(|c| c[0]);
                }
            }
            if let Some(heaves) = &by_heave {
                let along = derivative_by_heave(&plain, &linearised.wheels, sought);
                for (gradient, heaves) in self.gradients.iter_mut().zip(heaves) {
                    for (total, by) in gradient.iter_mut().zip(heaves) {
                        *total = *total + *by * along;
                    }
                }
            }
            let [left, right] = &mut self.gradients;
            receive(number, [left, right]);
        });
        Ok(())
    }
}

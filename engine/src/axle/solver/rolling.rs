//! Finds positions for given roll angles, travels and heights.

use super::corner::{WheelSeries, solve_level};
use super::*;

/// Returns true if the contact points rise with the travels. The arguments are the slopes of both heights. For an
/// independent axle, both slopes must be positive. For a rigid axle, the sum of the slopes must be positive. Returns
/// false for NaN.
fn rise(is_rigid: bool, [left, right]: [f64; 2]) -> bool {
    if is_rigid {
        left + right > 0.0
    } else {
        left > 0.0 && right > 0.0
    }
}

impl<const N: usize> AxleSolver<'_, N> {
    /// Finds positions for all placements. Placements in roll at one rack displacement are solved together. In each
    /// round, both wheels are solved at the travels that the series of the previous round predict.
    pub fn place_all(&mut self, placements: &[Placement]) -> Vec<Result<AxlePose, NoPose>> {
        // Indices of the placements with the same two values. First value: rack displacement, or mean travel of a rigid axle.
        // Second value: displacement of the steering gear.
        let mut by_rack: Vec<([f64; 2], Vec<usize>)> = Vec::new();
        for (number, placement) in placements.iter().enumerate() {
            if let Placement::Roll { heave, rack, .. } = *placement {
                let steered = if self.is_steered() { rack } else { 0.0 };
                let (_, rack) = self.level(heave, rack);
                let racks = [rack, steered];
                match by_rack.iter_mut().find(|(known, _)| *known == racks) {
                    Some((_, numbers)) => numbers.push(number),
                    None => by_rack.push((racks, vec![number])),
                }
            }
        }
        let mut found: Vec<Option<AxlePose>> = vec![None; placements.len()];
        for ([rack, steered], numbers) in by_rack {
            // If the gear cannot move, these placements stay unsolved here. The program then solves each of them alone, and
            // reports the failure.
            if self.steer(steered).is_ok() {
                self.roll_together(rack, &numbers, placements, &mut found);
            }
        }
        let each = placements.iter().zip(found);
        each.map(|(placement, found)| found.map_or_else(|| self.place_alone(placement), Ok))
            .collect()
    }

    /// Finds the position for a placement.
    pub fn place(&mut self, placement: &Placement) -> Result<AxlePose, NoPose> {
        let mut found = self.place_all(std::slice::from_ref(placement));
        found.swap_remove(0)
    }

    /// First estimate of half the difference of the travels at a roll angle. For this estimate, independent wheel centres
    /// move straight up, and wheel centres of a rigid axle move on a circle.
    pub(super) fn straight_half(&self, roll: f64) -> f64 {
        let level = Ground::level(0.0);
        let half = |side: Side| {
            let pose = self.corners[side as usize].solver.design_pose();
            self.contact(side, &pose, level).y
        };
        let slope = if self.is_rigid() {
            roll.sin()
        } else {
            roll.tan()
        };
        -0.5 * slope * (half(Side::Left) + half(Side::Right))
    }

    /// Solves placements in roll at one rack displacement together. `numbers` contains the indices of the placements.
    /// Placements that need more than [`MOST_ROUNDS`] rounds stay unsolved.
    pub(super) fn roll_together(
        &mut self,
        rack: f64,
        numbers: &[usize],
        placements: &[Placement],
        found: &mut [Option<AxlePose>],
    ) {
        struct Open {
            number: usize,
            heave: f64,
            /// Driving travel of both wheels at this heave without roll (0 for a rigid axle).
            level: f64,
            roll: f64,
            half: f64,
        }
        let radius = self.radius();
        let is_rigid = self.is_rigid();
        let size = self.corners[0].solver.size();
        let open = numbers
            .iter()
            .filter_map(|number| match placements[*number] {
                Placement::Roll { heave, roll, rack } => Some(Open {
                    number: *number,
                    heave,
                    level: self.level(heave, rack).0,
                    roll,
                    half: self.straight_half(roll),
                }),
                _ => None,
            });
        let mut open: Vec<Open> = open.collect();
        for _ in 0..MOST_ROUNDS {
            if open.is_empty() {
                return;
            }
            let travels = |sign: f64| -> Vec<f64> {
                let travel = |at: &Open| at.level + sign * at.half;
                open.iter().map(travel).collect()
            };
            let ground = |station: usize| Ground::rolled(open[station].roll);
            let [left, right] = &mut self.corners;
            let lefts = left.heights(&travels(1.0), rack, ground, radius);
            let mirrored = |station: usize| ground(station).mirrored();
            let rights = right.heights(&travels(-1.0), rack, mirrored, radius);
            let mut still = Vec::new();
            for (at, wheels) in open.iter().zip(lefts.into_iter().zip(rights)) {
                let (Some(left), Some(right)) = wheels else {
                    continue;
                };
                // `rise` is also false for NaN. The program then solves this placement alone.
                if !rise(is_rigid, [left.height[1], right.height[1]]) {
                    continue;
                }
                let step = solve_level(&left.height, &right.height);
                let half = at.half + step;
                let poses = [left.moved(step), right.moved(-step)];
                let travels = [at.level + half, at.level - half];
                // Close to a fold (turning point of the travel), four terms of the series are not enough even for a small
                // step.
                if step.abs() <= NEAR * size && self.stands(&poses, travels, rack, at.roll) {
                    found[at.number] = Some(AxlePose {
                        travels: [at.heave + half, at.heave - half],
                        roll: at.roll,
                        rack: placements[at.number].rack(),
                        hold: Hold::MeanTravel,
                        at_load: None,
                        poses,
                    });
                } else if step.is_finite() {
                    still.push(Open { half, ..*at });
                }
            }
            open = still;
        }
    }

    /// Returns true if both poses satisfy the closure equations at these driving travels, and both contact points have the same
    /// height on the rolled ground. Differences within rounding are permitted.
    fn stands(&self, poses: &[Pose<f64>; 2], travels: [f64; 2], rack: f64, roll: f64) -> bool {
        let [left, right] = &self.corners;
        if !left.closes(&poses[0], travels[0], rack) || !right.closes(&poses[1], travels[1], rack) {
            return false;
        }
        let ground = Ground::rolled(roll);
        let height = |side: Side, ground: Ground<f64>| {
            let contact = self.contact(side, &poses[side as usize], ground);
            contact.dot(ground.normal())
        };
        let apart = height(Side::Left, ground) - height(Side::Right, ground.mirrored());
        apart.abs() <= OF_HEIGHTS * left.solver.length_rounding()
    }

    /// Finds the position for one placement alone.
    pub(super) fn place_alone(&mut self, placement: &Placement) -> Result<AxlePose, NoPose> {
        checkpoint();
        let rack = placement.rack();
        self.steer(rack)?;
        let (travels, poses, roll) = match *placement {
            Placement::AtLoad { heave, roll, rack } => return self.at_load(heave, roll, rack),
            Placement::Roll { heave, roll, .. } => {
                let (travels, poses) = self.rolled(heave, roll, rack)?;
                (travels, poses, roll)
            }
            Placement::Travels {
                travels, on_plane, ..
            } => {
                let coordinates = self.coordinates(travels, rack);
                let mut pose = |side: Side| {
                    let corner = &mut self.corners[side as usize];
                    let (drive, rack) = coordinates[side as usize];
                    corner.at(drive, rack, |_, _, pose| Ok(*pose))
                };
                let poses = join_results(pose(Side::Left), pose(Side::Right))?;
                let roll = if on_plane { self.tilted(&poses)? } else { 0.0 };
                (travels, poses, roll)
            }
        };
        Ok(AxlePose {
            travels,
            roll,
            rack,
            hold: placement.hold(),
            at_load: None,
            poses,
        })
    }

    /// Finds travels and poses at a roll angle.
    pub(super) fn rolled(
        &mut self,
        heave: f64,
        roll: f64,
        rack: f64,
    ) -> Result<([f64; 2], [Pose<f64>; 2]), NoPose> {
        let ground = Ground::rolled(roll);
        let radius = self.radius();
        let is_rigid = self.is_rigid();
        let size = self.corners[0].solver.size();
        let mut half = self.straight_half(roll);
        let (level, rack) = self.level(heave, rack);
        // Last travels at which both wheels have poses. After a failed step, the travels go back towards them.
        let mut reached = None;
        let mut smallest = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let [left, right] = &mut self.corners;
            let found = join_results(
                left.height(level + half, rack, ground, radius),
                right.height(level - half, rack, ground.mirrored(), radius),
            );
            // If a contact point falls while the travel of its wheel grows, the travels are beyond the required
            // position. NaN counts as falling.
            let rises =
                |l: &WheelSeries, r: &WheelSeries| rise(is_rigid, [l.height[1], r.height[1]]);
            let found = found.and_then(|[l, r]| {
                if rises(&l, &r) {
                    Ok((l, r))
                } else {
                    Err(NoPose::NoGround)
                }
            });
            let (left_wheel, right_wheel) = match found {
                Ok(found) => found,
                // Go halfway back to the last travels that both wheels could reach.
                Err(failure) => {
                    let back = reached.unwrap_or(0.0);
                    if (half - back).abs() <= 1e-9 * size {
                        return Err(failure);
                    }
                    half = 0.5 * (half + back);
                    continue;
                }
            };
            let (left, right) = (left_wheel.height, right_wheel.height);
            let (mismatch, slope) = (left[0] - right[0], left[1] + right[1]);
            let step = -mismatch / slope;
            let is_rounding = step.abs() <= 4.0 * f64::EPSILON * size;
            if is_rounding || step.abs() >= smallest && smallest <= 1e-9 * size {
                let poses = [left_wheel.moved(0.0), right_wheel.moved(0.0)];
                return Ok(([heave + half, heave - half], poses));
            }
            smallest = smallest.min(step.abs());
            reached = Some(half);
            half += step;
        }
        Err(NoPose::NoGround)
    }

    pub(super) fn contact(
        &self,
        side: Side,
        pose: &Pose<f64>,
        ground: Ground<f64>,
    ) -> Vector3<f64> {
        let corner = &self.corners[side as usize];
        let at = corner.configuration(*pose);
        at.point(corner.mechanism.wheel_centre)
            + ground.contact_lever(at.spin_axis(), self.radius())
    }

    pub(super) fn track_of(&self, [left, right]: [&Pose<f64>; 2], ground: Ground<f64>) -> f64 {
        let mirrored = ground.mirrored();
        let left = self.contact(Side::Left, left, ground);
        let right = self.contact(Side::Right, right, mirrored);
        left.dot(ground.outboard()) + right.dot(mirrored.outboard())
    }

    /// Roll angle at which both wheels stand on a plane.
    pub(super) fn tilted(&self, [left, right]: &[Pose<f64>; 2]) -> Result<f64, NoPose> {
        // A rigid axle can roll far from level ground, even until it is upright. So the iteration for a rigid axle starts with
        // the line through the origins of both poses: the wheel centres, or the kingpins of a steered axle.
        let mut roll = if self.is_rigid() {
            (right.origin.z - left.origin.z).atan2(left.origin.y + right.origin.y)
        } else {
            0.0_f64
        };
        let mut smallest = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let ground = Ground::rolled(roll);
            let mirrored = ground.mirrored();
            let left_height = self.contact(Side::Left, left, ground).dot(ground.normal());
            let right_height = self.contact(Side::Right, right, mirrored);
            let right_height = right_height.dot(mirrored.normal());
            let step = -(left_height - right_height) / self.track_of([left, right], ground);
            if step.abs() <= 2.0 * f64::EPSILON || step.abs() >= smallest && smallest <= 1e-12 {
                return Ok(roll);
            }
            smallest = smallest.min(step.abs());
            roll += step;
        }
        Err(NoPose::NoGround)
    }
}

//! Steering gear of a steered axle, for designs in any number type.

use super::AxleSolver;
use crate::analyse::{Limit, Range, RangeEnd};
use crate::mechanism::constraint::heights_at_rest;
use crate::model::{AxleTravel, Drive, Mechanism};
use crate::number::{Dual, Real, Vector3};

/// Moves the drag link's end in a design, by equation (1) of `model/steered_axle.rs`. Returns the lift of the wheel
/// centres by equations (4) and (5): first the change of the travel that drives the axle, then the change of the held
/// travel. Both are 0 if no drag link steers the axle.
#[inline(always)]
pub(crate) fn displace<T: Real>(
    mechanism: &Mechanism,
    design: &mut [Vector3<T>],
    displacement: T,
) -> [T; 2] {
    let zero = design[0].x.zero();
    let Some(rigid) = mechanism.rigid_axle.as_ref() else {
        return [zero; 2];
    };
    let Some(steering) = &rigid.steering else {
        return [zero; 2];
    };
    steering.displace(displacement, design);
    let (near, far) = (mechanism.wheel_centre, rigid.far_centre);
    let [turned_near, turned_far] = heights_at_rest(mechanism, [near, far], design);
    let near_rise = turned_near - design[near.0].z;
    let far_rise = turned_far - design[far.0].z;
    let mean = (near_rise + far_rise).scaled(0.5);
    let difference = (near_rise - far_rise).scaled(0.5);
    match rigid.held {
        AxleTravel::Mean => [difference, mean],
        AxleTravel::Difference => [mean, difference],
    }
}

impl<const N: usize> AxleSolver<'_, N> {
    /// Finds a fold (turning point) on the way to the level axle with its steering gear displaced. One of mean travel and half
    /// difference is held, the other drives the axle. The held travel changes first, then the driving travel. `None` if there is no
    /// fold.
    fn level_fold(&mut self) -> Option<Limit> {
        let corner = &mut self.corners[0];
        let (drive, held) = corner.inner(0.0, 0.0);
        let before = |range: Range, value: f64| {
            let end = if value < 0.0 {
                range.lower
            } else {
                range.upper
            };
            match end {
                RangeEnd::Fold(limit) if limit.value.abs() <= value.abs() => Some(limit),
                _ => None,
            }
        };
        let of_held = before(corner.solver.rack_range().ok()?, held);
        of_held.or_else(|| before(corner.solver.drive_range(Drive::Travel, held).ok()?, drive))
    }

    /// Finds the fold at which the axle can no longer follow its steering gear. Between the two displacements `value`
    /// and `beyond` of the gear, the level axle at zero travel reaches this turning point. `None` if the axle meets no fold
    /// with the gear at `beyond`, or if a knuckle cannot follow the gear there.
    ///
    /// With T(p, s) the travel at the fold, the design p and the displacement s of the gear, T = 0 at the end. The axle
    /// reaches its held travel first. Meanwhile, the drive d keeps its value of the axle at rest. It equals the lift l(p, s) by
    /// equation (4) or (5) of `model/steered_axle.rs`. Let g be the gradient of T with respect to the hardpoints, g'
    /// the gradient of T with respect to the drag link's end p', and n the direction of the gear. T_d is the derivative
    /// of T with respect to d. l_p and l_s are the derivatives of l with respect to p and s. Then
    ///
    /// ```text
    /// ds/dp = -(g + T_d l_p)/(g'.n + T_d l_s)                                                     (1)
    /// ```
    ///
    /// If the fold is a fold of the drive, T_d is 0.
    pub(in crate::axle) fn gear_fold(&mut self, value: f64, beyond: f64) -> Option<Limit> {
        self.steer(beyond).ok()?;
        let fold = self.level_fold()?;
        let mechanism = &self.axle.left.mechanism;
        let steering = mechanism.axle_steering()?;
        let design = self.corners[0].solver.design();
        // Derivatives of the wheel's lift with respect to the coordinates of a point. If `point` is `None`,
        // the first number is the derivative with respect to the gear's displacement, and the other numbers are 0.
        let lift_by = |point: Option<usize>| -> [f64; 3] {
            let mut moved: Vec<_> = design.iter().map(|p| p.map(Dual::constant)).collect();
            let gear = match point {
                None => Dual::input(value, 0),
                Some(point) => {
                    moved[point] = Dual::inputs(design[point]);
                    Dual::constant(value)
                }
            };
            displace(mechanism, &mut moved, gear)[0].partials
        };
        let by_gear = fold.gradient[steering.place.0].dot(steering.direction)
            + fold.by_drive * lift_by(None)[0];
        let mut gradient = fold.gradient.clone();
        let place = std::mem::take(&mut gradient[steering.place.0]);
        gradient[steering.end.0] = gradient[steering.end.0] + place;
        for (point, by) in gradient.iter_mut().enumerate() {
            let lift = Vector3::from(lift_by(Some(point)));
            *by = (*by + lift * fold.by_drive) * (-1.0 / by_gear);
        }
        Some(Limit {
            value,
            gradient,
            ..fold
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;
    use std::path::Path;

    /// The lift of the knuckles is larger than the range of the travel. So a known end in droop lies at a positive travel of the
    /// wheel centres. Travels inside of it still have poses.
    #[test]
    fn an_end_is_on_the_side_from_which_the_axle_reached_it() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../studies/off_road_car_front.toml");
        let study = Study::read(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        let axle = &study.axle().expect("an axle").axle;
        let mut solver = AxleSolver::<1>::new(axle, &[], false).expect("a design with poses");
        let corner = &mut solver.corners[0];
        let lift = 100.0 * corner.solver.size();
        corner.steered.offsets = [lift, 0.0];
        assert!(corner.at(0.0, 0.0, |_, _, pose| Ok(*pose)).is_err());
        assert_eq!(corner.ends.len(), 1);
        assert!(corner.at(lift, 0.0, |_, _, pose| Ok(*pose)).is_ok());
    }
}

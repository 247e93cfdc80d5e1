//! Stability of equilibria, and the path along the load that leads to them.
//!
//! A small vertical force and small moments on the body, f, move it by q = (gamma, phi, theta). With the tangent G_x of the
//! equations of [`super`] and all other unknowns free,
//!
//! ```text
//! q = C f,      C = the rows (gamma, phi, theta) of G_x^-1 in the columns of the vertical force and both moments  (1)
//! ```
//!
//! The force is positive down, so that f.q is work. Both columns of the moments have the opposite sign in C.
//!
//! At rest all forces are along n. Then C^-1 is the Hessian of the energy, and a positive definite C means a minimum. Forces
//! along the ground do work as the attitude changes (jacking, anti-dive), and make C unsymmetric. A positive symmetric part,
//!
//! ```text
//! f.C f > 0   for every f,                                                                                        (2)
//! ```
//!
//! still means that the body moves in the direction of every force. This condition is sufficient but not necessary. For
//! example, a car that brakes hard with strong anti-features violates (2), while its loads change smoothly and all wheels
//! stay on the ground. Equilibria end where the state cannot follow the load. Let the accelerations of the case be
//! multiplied by s. Along the states x(s) that begin at rest,
//!
//! ```text
//! G_x x' = -G_s.                                                                                                  (3)
//! ```
//!
//! The path turns back where det G_x = 0 (a fold), and there the car tips or its body sinks. At a change of contact, the
//! row of wheel b passes from gap_b = 0 to N_b = 0. The other rows allow one free direction v. On either side of the
//! change, x' contains a multiple of v, and
//!
//! ```text
//! gap_b' (lifted) = -(gap_b.v)/(N_b.v) N_b' (down),      (gap_b.v)/(N_b.v) = det G_x (down)/det G_x (lifted)      (4)
//! ```
//!
//! The wheel load decreases towards the lift. If both determinants have the same sign, the gap grows beyond the lift.
//! Otherwise both branches lie on the same side of s, and the path turns back. With a tyre spring, N_b - k p = 0
//! replaces gap_b = 0, and the penetration p is a positive multiple of -gap_b. The sign in (4) is then the same. So a
//! state is accepted if
//!
//! ```text
//! (2) holds there, or (2) holds at rest and det G_x keeps its sign on the whole path from rest.                   (5)
//! ```
//!
//! The end of the path is classified as follows. Let b be the wheel on the ground with the smallest load, and let v be the
//! solution of G_x v = 1 in the contact row of b. This is the free direction of (4): the motion if the ground under b
//! rises. If N_b is zero and N_b.v is negative, the path turns back at the lift of b by (4), and the car tips over.
//! Otherwise the path turns back at a fold. Towards a fold, v approaches the null vector of G_x. Let h be the changes of
//! the body's heights over the four wheels in this motion, with the axes of the body at rest:
//!
//! ```text
//! h_k = -gamma + y_k phi - x_k theta,      m = (sum of N_k h_k)/(sum of N_k)                                      (6)
//! ```
//!
//! m is the motion of the body over the resultant of the wheel loads, and this resultant balances all loads on the body.
//! If m is small compared with the h of largest magnitude, the body turns about an axis near the resultant: the loads move
//! aside, their moment grows, and the car tips. It also tips if m has the opposite sign: the body then rises most over a
//! wheel with little load. Otherwise the body moves along the load, so the springs no longer carry it: it sinks.
//!
//! At rest, an unstable state may be far from a fold. There the motion is a column of C in other coordinates. Let f and e
//! be the heights of the body over the middle of the front and the rear axle. Let r be half the difference of the body's
//! heights over the left and the right wheels:
//!
//! ```text
//! (f, e, r) = T q,      S = T C T^T.                                                                              (7)
//! ```
//!
//! The column of S with the most negative diagonal element gives h, and (6) classifies it.

use super::equations::{
    CONTACTS, GROUND, LOADS, PITCH, PITCH_MOMENT, ROLL, ROLL_MOMENT, UNKNOWNS, VERTICAL,
};
use super::solver::{CarSolver, Equilibrium, LONGEST_TRAVEL, LONGEST_TURN, Start};
use super::{Car, Case, NoEquilibrium};
use crate::model::Side;
use crate::number::Each;

/// Longest step of the load, as a fraction of the full load.
const LONGEST: f64 = 1.0 / 16.0;
/// Shortest step of the load, as a fraction of the full load. If a shorter step would be needed, the path has turned
/// back.
const SHORTEST: f64 = LONGEST / 1024.0;
/// Loads below this fraction of the sum of the wheel loads count as zero at the end of the path.
const NO_LOAD: f64 = 1e-3;
/// The body sinks if the ratio of m in equation (6) of this module to the h of largest magnitude is above this limit.
const SINKING: f64 = 0.25;
/// Largest number of steps of the load. The count includes steps back.
const MOST_STEPS: usize = 400;

impl Equilibrium {
    /// Returns the flexibility C by equation (1) of this module. It is NaN if the tangent has no LU factors.
    fn flexibility(&self) -> [[f64; 3]; 3] {
        let Some(factors) = &self.factors else {
            return [[f64::NAN; 3]; 3];
        };
        let rows = [(VERTICAL, 1.0), (ROLL_MOMENT, -1.0), (PITCH_MOMENT, -1.0)];
        let answers = rows.each(|(row, sign)| {
            let mut right = [0.0; UNKNOWNS];
            right[row] = sign;
            factors.solve(right)
        });
        [GROUND, ROLL, PITCH].each(|unknown| answers.each(|answer| answer[unknown]))
    }

    /// Returns true if condition (2) of this module holds. The check uses the leading minors of the symmetric part of C.
    pub(super) fn is_stiff(&self) -> bool {
        let flexibility = self.flexibility();
        let c = |i: usize, j: usize| 0.5 * (flexibility[i][j] + flexibility[j][i]);
        let minor = c(0, 0) * c(1, 1) - c(0, 1) * c(0, 1);
        let determinant = c(0, 0) * (c(1, 1) * c(2, 2) - c(1, 2) * c(1, 2))
            - c(0, 1) * (c(0, 1) * c(2, 2) - c(1, 2) * c(0, 2))
            + c(0, 2) * (c(0, 1) * c(1, 2) - c(1, 1) * c(0, 2));
        c(0, 0) > 0.0 && minor > 0.0 && determinant > 0.0
    }

    /// Returns the flexibility S of the body's heights over the axles by equation (7) of this module, column by column.
    fn flexibility_of_heights(&self, car: &Car) -> [[f64; 3]; 3] {
        let [front, rear] = car.axles_ahead();
        let half_track = 0.5 * (half_track(car, 0) + half_track(car, 1));
        // If the ground rises by gamma, the body is lower relative to the ground.
        let rows = [
            [-1.0, 0.0, -front],
            [-1.0, 0.0, -rear],
            [0.0, half_track, 0.0],
        ];
        let flexibility = self.flexibility();
        rows.each(|column| {
            let motion = flexibility.each(|row| dot(row, column));
            rows.each(|row| dot(row, motion))
        })
    }

    /// Describes the end of the path from rest by equation (6) of this module. The path turns back just beyond this
    /// state.
    fn end_of_path(&self, car: &Car) -> NoEquilibrium {
        let Some(factors) = &self.factors else {
            return NoEquilibrium::Singular;
        };
        let loads = self.loads();
        let on_ground = (0..4).filter(|wheel| !self.lifted[*wheel]);
        let least = on_ground.min_by(|a, b| loads[*a].total_cmp(&loads[*b]));
        let least = least.unwrap_or(0);
        let mut raised = [0.0; UNKNOWNS];
        raised[CONTACTS + least] = 1.0;
        let motion = factors.solve(raised);
        if loads[least] < NO_LOAD * loads.iter().sum::<f64>() && motion[LOADS + least] < 0.0 {
            let mut lifted = self.lifted;
            lifted[least] = true;
            return NoEquilibrium::TipsOver { lifted };
        }
        let [height, roll, pitch] = [GROUND, ROLL, PITCH].each(|unknown| motion[unknown]);
        let ahead = car.axles_ahead();
        self.ends_in([0, 1, 2, 3].each(|wheel: usize| {
            let left = Side::ALL[wheel % 2].sign() * half_track(car, wheel / 2);
            -height + left * roll - ahead[wheel / 2] * pitch
        }))
    }

    /// Describes the instability of a state at rest, by equations (6) and (7) of this module.
    fn instability_at_rest(&self, car: &Car) -> NoEquilibrium {
        let columns = self.flexibility_of_heights(car);
        let unstable = (0..3).filter(|k| columns[*k][*k] < 0.0);
        let softest = unstable.min_by(|a, b| columns[*a][*a].total_cmp(&columns[*b][*b]));
        softest.map_or(NoEquilibrium::Tips, |k| {
            let [front, rear, turn] = columns[k];
            self.ends_in([front + turn, front - turn, rear + turn, rear - turn])
        })
    }

    /// Returns the failure (tipping or sinking) that belongs to changes h of the body's heights over the wheels, by
    /// equation (6) of this module.
    fn ends_in(&self, heights: [f64; 4]) -> NoEquilibrium {
        let loads = self.loads();
        let work: f64 = (0..4).map(|wheel| loads[wheel] * heights[wheel]).sum();
        let along_load = work / loads.iter().sum::<f64>();
        let largest = heights.into_iter().fold(0.0, |most: f64, height| {
            if height.abs() > most.abs() {
                height
            } else {
                most
            }
        });
        if along_load / largest > SINKING {
            NoEquilibrium::Sinks
        } else {
            NoEquilibrium::Tips
        }
    }

    /// Returns true if the path from an accepted state leads to this state. Two conditions must hold. The determinant of
    /// the tangent G_x keeps its sign, and the motions of body and wheels do not exceed the limit of a Newton step.
    pub(super) fn follows(&self, from: &Equilibrium, car: &Car) -> bool {
        let near = |k: usize| {
            let longest = match k {
                ROLL | PITCH => LONGEST_TURN,
                _ => LONGEST_TRAVEL * car.per_metre(),
            };
            (self.unknowns[k] - from.unknowns[k]).abs() <= longest
        };
        let (Some(own), Some(other)) = (&self.factors, &from.factors) else {
            return false;
        };
        own.orientation() == other.orientation() && (0..LOADS).all(near)
    }
}

/// Half the distance between the wheel centres of an axle in the design position.
fn half_track(car: &Car, axle: usize) -> f64 {
    car.axles[axle].mean_wheel_centre().y
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl CarSolver<'_> {
    /// Increases the load from zero (the car at rest on its wheels) to a load case, by equations (3) to (5) of this module.
    pub(super) fn along_load(&mut self, case: &Case) -> Result<Equilibrium, NoEquilibrium> {
        let rest = case.scaled(0.0);
        let start = self.start(&rest);
        let mut at = self.with_contact(&rest, Start::of(start))?;
        if !at.is_stiff() {
            return Err(at.instability_at_rest(self.car));
        }
        let (mut part, mut step) = (0.0, LONGEST);
        let mut evaluations = at.evaluations;
        // Smallest fraction of the load at which the search failed.
        let mut failed = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let next = f64::min(part + step, 1.0);
            let found = self.with_contact(&case.scaled(next), Start::at(&at));
            let why = match found {
                Ok(found) if found.follows(&at, self.car) => {
                    evaluations += found.evaluations;
                    (at, part) = (found, next);
                    if part == 1.0 {
                        at.evaluations = evaluations;
                        return Ok(at);
                    }
                    if part >= failed {
                        failed = f64::INFINITY;
                    }
                    let longer = f64::min(2.0 * step, LONGEST);
                    if part + longer < failed {
                        step = longer;
                    }
                    continue;
                }
                // If no set of wheels in contact fits, the path turns back. Both branches of equation (4) of this module
                // are then on the side from which the path came.
                Ok(_)
                | Err(
                    NoEquilibrium::NotFound
                    | NoEquilibrium::Singular
                    | NoEquilibrium::NoContactSet { remedy: None, .. },
                ) => None,
                Err(why) => Some(why),
            };
            failed = next;
            step *= 0.5;
            if step < SHORTEST {
                return Err(why.unwrap_or_else(|| at.end_of_path(self.car)));
            }
        }
        Err(NoEquilibrium::NotFound)
    }
}

impl Case {
    /// Scales the accelerations and the dynamic pressure of the case by `part`. Other inputs stay unchanged.
    fn scaled(&self, part: f64) -> Case {
        Case {
            ax: self.ax * part,
            ay: self.ay * part,
            az: self.az * part,
            speed: self.speed * part.sqrt(),
            yaw_acceleration: self.yaw_acceleration * part,
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_of_the_body_are_tipping_or_sinking() {
        let even = [4000.0, 4000.0, 3500.0, 3500.0];
        for (loads, heights, why) in [
            (even, [-1.0, -1.0, -0.8, -0.8], NoEquilibrium::Sinks),
            (even, [1.0, 1.0, -0.2, -0.2], NoEquilibrium::Sinks),
            (even, [1.0, -1.0, 0.9, -0.9], NoEquilibrium::Tips),
            (even, [1.0, 1.0, -0.9, -0.9], NoEquilibrium::Tips),
            // Turn to the left: the body turns about its right wheels.
            (
                [0.0, 7638.0, 150.0, 7070.0],
                [1.0, -0.1, 1.0, -0.1],
                NoEquilibrium::Tips,
            ),
            // Acceleration in a turn to the left: the body turns about the line from the front right to the rear left
            // wheel, and rises most over the lifted wheel.
            (
                [0.0, 3988.5, 157.9, 10563.5],
                [0.0116, 0.0001, 0.0049, -0.0065],
                NoEquilibrium::Tips,
            ),
        ] {
            let mut unknowns = [0.0; UNKNOWNS];
            unknowns[LOADS..LOADS + 4].copy_from_slice(&loads);
            let state = Equilibrium {
                unknowns,
                lifted: [false; 4],
                evaluations: 0,
                racks: [0.0; 2],
                placed: None,
                factors: None,
            };
            assert_eq!(state.ends_in(heights), why, "{heights:?}");
        }
    }
}

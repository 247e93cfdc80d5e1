//! Equations of both wheels and of the bodies that they share.
//!
//! Each wheel has the equations of `system.rs` (matrix A_c, residual r_c) with the shared unknowns q held. Let s be the
//! forces on the shared bodies. With B_c = dr_c/dq, C_c = ds/dx_c and D = ds/dq, a Newton step solves
//!
//! ```text
//! (D - sum C_c A_c^-1 B_c) dq = -(s - sum C_c A_c^-1 r_c),   dx_c = -A_c^-1 (r_c + B_c dq)        (1)
//! ```
//!
//! The right wheel is described as the mirror image of a left wheel. [`MIRROR`] converts the signs of the shared
//! unknowns for the right wheel.

use super::super::floating::Floating;
use super::super::ground::{Coupling, Frames, MIRROR, RACK, SHARED, Surroundings, TWIST};
use super::super::limb::tangent_of;
use super::super::preload::NoPreload;
use super::super::solve::{Bounds, Obstacle, is_positive_on};
use super::super::system::{Equations, Held, LOOSE, Limb, Singular, State, Step, Task};
use super::super::wheel::ElasticWheel;
use super::corners::Corners;
use crate::linear::square::{MOST, SquareLu};
use crate::number::{Each, Scalar, Valued, Vector3, array_of, larger};

/// Elastic parts between the body and both wheels, except the subframe's mounts.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct SharedParts<T> {
    pub(in super::super) has_subframe: bool,
    /// Stiffness between the commanded and the actual rack displacement, and its force in the design position. `None` if rigid.
    pub(in super::super) rack: Option<[T; 2]>,
    pub(in super::super) has_bar: bool,
    /// True if one body carries both wheels.
    pub(in super::super) is_joined: bool,
}

/// State of both wheels. The shared bodies are in the left wheel's axes.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct AxleState<T> {
    pub(in super::super) wheels: [State<T>; 2],
    pub(in super::super) around: Surroundings<T>,
}

impl<T: Scalar> AxleState<T> {
    pub(in super::super) fn map<U: Scalar>(&self, f: impl Fn(T) -> U + Copy) -> AxleState<U> {
        let around = &self.around;
        AxleState {
            wheels: self.wheels.each_ref().each(|wheel| wheel.map(f)),
            around: Surroundings {
                subframe: around.subframe.map(f),
                rack: f(around.rack),
                twist: f(around.twist),
            },
        }
    }

    /// Positions of the shared bodies in the axes of the wheel of a side.
    pub(in super::super) fn around(&self, side: usize) -> Surroundings<T> {
        match side {
            0 => self.around,
            _ => self.around.mirrored(),
        }
    }
}

/// Inputs of an equilibrium of both wheels: rack displacement, and the loads and held heights of each wheel.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct AxleTask<T> {
    /// Commanded displacement of the rack, along the left wheel's +y.
    pub(in super::super) rack: T,
    pub(in super::super) wheels: [Task<T>; 2],
}

/// Change of all unknowns in a step, or their derivatives.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct AxleStep<T> {
    pub(in super::super) wheels: [Step<T>; 2],
    pub(in super::super) shared: [T; SHARED],
}

/// External forces that hold the design position at the start, if this position is not an equilibrium. The solver
/// reduces these forces step by step.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct AxleHeld<T> {
    pub(in super::super) wheels: [Held<T>; 2],
    pub(in super::super) shared: [T; SHARED],
}

/// Part of an axle that can move without resistance. It makes the equations singular, so there is no Newton step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum AxleSingular {
    Wheel(usize, Singular),
    /// The body that carries both wheels.
    Carrier,
    Shared,
}

/// Equations of one wheel, with its forces on the shared bodies.
#[derive(Clone, Debug)]
pub(in super::super) struct SideEquations<T: Valued> {
    pub(in super::super) equations: Equations<T>,
    coupling: Coupling<T>,
    frames: Frames<T>,
    around: Surroundings<T>,
}

/// Equations of both wheels in a state, with the factors for equation (1) of this module.
#[derive(Clone, Debug)]
pub(in super::super) struct AxleEquations<T: Valued> {
    pub(in super::super) sides: [SideEquations<T>; 2],
    corners: Corners<T>,
    /// A_c^-1 B_c of equation (1) of this module, for both wheels. There is one entry for each shared unknown that moves.
    responses: Vec<[[T; MOST]; 2]>,
    /// Indices of the shared unknowns that move.
    active: Vec<usize>,
    /// Forces on the shared bodies, in the left wheel's axes.
    pub(in super::super) force: [T; SHARED],
    own: [[T; SHARED]; SHARED],
    factors: Option<SquareLu<T>>,
}

/// Purpose for which the equations are formed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Purpose {
    /// An equilibrium under loads.
    Balance,
    /// Search for the forces of elastic parts at the design load. These forces are not known yet, so elastic parts contribute
    /// only their stiffness. Springs contribute only their force.
    Preload,
    /// The step that adds derivatives to an equilibrium. In this step, the tangents are constants.
    Correction,
}

impl<T: Scalar> SideEquations<T> {
    /// Derivatives of the wheel's forces with respect to a shared unknown in the left wheel's axes.
    pub(in super::super) fn by_shared(&self, side: usize, shared: usize) -> [T; MOST] {
        let mirror = sign(side, shared);
        array_of(|i| self.coupling.corner_by[i][shared].scaled(mirror))
    }

    /// Derivative of the force `i` on the shared bodies with respect to the shared unknown `j`, in the left wheel's axes.
    fn own(&self, side: usize, i: usize, j: usize) -> T {
        self.coupling.own[i][j].scaled(sign(side, i) * sign(side, j))
    }

    /// Returns the product C_c x of equation (1) of this module, for one force on the shared bodies.
    fn on_shared(&self, side: usize, shared: usize, x: &[T; MOST]) -> T {
        let by = &self.coupling.by_corner[shared];
        let mut sum = x[0].zero();
        for (by, x) in by.iter().zip(x).take(self.equations.size) {
            sum = sum + *by * *x;
        }
        sum.scaled(sign(side, shared))
    }
}

/// Sign of a shared unknown in the axes of a side.
pub(in super::super) fn sign(side: usize, shared: usize) -> f64 {
    match side {
        0 => 1.0,
        _ => MIRROR[shared],
    }
}

impl<T: Scalar> SharedParts<T> {
    /// Indices of the shared unknowns that move.
    pub(in super::super) fn active(&self, purpose: Purpose) -> Vec<usize> {
        let mut active: Vec<usize> = Vec::new();
        if self.has_subframe {
            active.extend(0..RACK);
        }
        active.extend(self.rack.is_some().then_some(RACK));
        // While the forces at the design load are computed, the bar has no stiffness, so its twist stays fixed.
        active.extend((self.has_bar && purpose != Purpose::Preload).then_some(TWIST));
        active
    }

    /// Computes the equations of both wheels and of the shared bodies in a state.
    pub(in super::super) fn equations(
        &self,
        wheels: &[ElasticWheel<T>; 2],
        state: &AxleState<T>,
        task: &AxleTask<T>,
        held: Option<&AxleHeld<T>>,
        purpose: Purpose,
    ) -> Result<AxleEquations<T>, AxleSingular> {
        let active = self.active(purpose);
        let mut sides = Vec::new();
        for (side, wheel) in wheels.iter().enumerate() {
            let held = held.map(|held| &held.wheels[side]);
            let found = self.side(wheel, side, state, task, held, purpose);
            sides.push(found.map_err(|why| AxleSingular::Wheel(side, why))?);
        }
        let mut sides: [SideEquations<T>; 2] = match sides.try_into() {
            Ok(sides) => sides,
            Err(_) => return Err(AxleSingular::Shared),
        };
        let corners = if self.is_joined {
            let bounds = (purpose == Purpose::Preload).then_some(wheels[0].bounds);
            Corners::joined(&mut sides, bounds)?
        } else {
            Corners::apart(&sides)?
        };
        let by_shared = |shared: &usize| [0, 1].each(|side| sides[side].by_shared(side, *shared));
        let columns = active.iter().map(by_shared);
        let responses: Vec<_> = columns.map(|columns| corners.solve(&columns)).collect();
        let zero = task.rack.zero();
        let mut force = [zero; SHARED];
        let mut own = [[zero; SHARED]; SHARED];
        for (side, of) in sides.iter().enumerate() {
            for i in 0..SHARED {
                force[i] = force[i] + of.coupling.force[i].scaled(sign(side, i));
                for (j, own) in own[i].iter_mut().enumerate() {
                    *own = *own + of.own(side, i, j);
                }
            }
        }
        if let Some([rate, preload]) = self.rack {
            let slope = tangent_of(rate, purpose == Purpose::Correction);
            own[RACK][RACK] = own[RACK][RACK] + slope;
            if purpose != Purpose::Preload {
                let moved = state.around.rack - task.rack;
                force[RACK] = force[RACK] + preload + rate * moved;
            }
        }
        if let Some(held) = held {
            for (force, held) in force.iter_mut().zip(held.shared) {
                *force = *force - held;
            }
        }
        let mut matrix = [[zero; MOST]; MOST];
        for (a, i) in active.iter().enumerate() {
            for (b, j) in active.iter().enumerate() {
                matrix[a][b] = own[*i][*j];
                for (side, of) in sides.iter().enumerate() {
                    let less = of.on_shared(side, *i, &responses[b][side]);
                    matrix[a][b] = matrix[a][b] - less;
                }
            }
        }
        if purpose == Purpose::Preload && !holds(&matrix, &active, wheels[0].bounds) {
            return Err(AxleSingular::Shared);
        }
        let factors = if active.is_empty() {
            None
        } else {
            Some(SquareLu::of(matrix, active.len()).ok_or(AxleSingular::Shared)?)
        };
        Ok(AxleEquations {
            sides,
            corners,
            responses,
            active,
            force,
            own,
            factors,
        })
    }

    /// The equations of one wheel.
    fn side(
        &self,
        wheel: &ElasticWheel<T>,
        side: usize,
        state: &AxleState<T>,
        task: &AxleTask<T>,
        held: Option<&Held<T>>,
        purpose: Purpose,
    ) -> Result<SideEquations<T>, Singular> {
        let system = &wheel.built.system;
        let around = state.around(side);
        let own = &state.wheels[side];
        let mut frames = system.frames(&own.carrier, &around, purpose == Purpose::Preload);
        if purpose == Purpose::Correction {
            frames = frames.for_correction();
        }
        let mut equations = Equations::empty(around.rack, system.joints.len(), held);
        let gathered = system.gather(&frames, own, held, true, &mut equations)?;
        let mut coupling = system.add_coupled(&gathered, &frames, &around, &mut equations);
        match purpose {
            Purpose::Balance => system.add_loads(&mut equations, own, &task.wheels[side]),
            Purpose::Correction => {
                system.add_loads(&mut equations, own, &task.wheels[side]);
                equations.fix_tangents();
                coupling.fix_tangents();
            }
            Purpose::Preload => {
                // The stiffness check of a body that carries both wheels needs the equations of both sides, so it is
                // done later.
                let bounds = (!self.is_joined).then_some(wheel.bounds);
                let bordered = wheel.built.border_for_preload(&mut equations, bounds);
                bordered.map_err(|why| match why {
                    NoPreload::Singular(why) => why,
                    NoPreload::OutOfReach { .. } => Singular::Carrier,
                })?;
            }
        }
        Ok(SideEquations {
            equations,
            coupling,
            frames,
            around,
        })
    }
}

/// Lever that converts a shared unknown to a displacement, if this unknown is a rotation. For displacements, the result
/// is 1.
pub(super) fn lever_of(shared: usize, bounds: Bounds) -> f64 {
    if (3..RACK).contains(&shared) || shared == TWIST {
        bounds.lever()
    } else {
        1.0
    }
}

/// Returns true if the matrix of equation (1) is positive definite for the shared unknowns that move. A lever converts
/// rotations to displacements for this check. The limit [`LOOSE`] excludes stiffness that is only rounding error.
fn holds<T: Scalar>(matrix: &[[T; MOST]; MOST], active: &[usize], bounds: Bounds) -> bool {
    let scale = |shared: usize| 1.0 / lever_of(shared, bounds);
    let mut scaled = [[0.0; SHARED]; SHARED];
    for (a, i) in active.iter().enumerate() {
        for (b, j) in active.iter().enumerate() {
            scaled[a][b] = scale(*i) * matrix[a][b].value() * scale(*j);
        }
    }
    is_positive_on(scaled, active.len(), LOOSE)
}

impl<T: Scalar> AxleEquations<T> {
    /// Solves equation (1) of this module for the displacements caused by these forces.
    pub(in super::super) fn solve(
        &self,
        wheels: &[[T; MOST]; 2],
        shared: &[T; SHARED],
    ) -> ([[T; MOST]; 2], [T; SHARED]) {
        let zero = shared[0].zero();
        let mut found = self.corners.solve(wheels);
        let mut moved = [zero; SHARED];
        if let Some(factors) = &self.factors {
            let mut right = [zero; MOST];
            for (a, i) in self.active.iter().enumerate() {
                right[a] = shared[*i];
                for (side, of) in self.sides.iter().enumerate() {
                    right[a] = right[a] - of.on_shared(side, *i, &found[side]);
                }
            }
            let solution = factors.solve(&right);
            for (a, i) in self.active.iter().enumerate() {
                moved[*i] = solution[a];
                for (found, by) in found.iter_mut().zip(&self.responses[a]) {
                    for (x, by) in found.iter_mut().zip(by) {
                        *x = *x - *by * solution[a];
                    }
                }
            }
        }
        (found, moved)
    }

    /// Derivative of the force `i` on the shared bodies with respect to the shared unknown `j`.
    pub(in super::super) fn own(&self, i: usize, j: usize) -> T {
        self.own[i][j]
    }

    /// Residuals of the equations with opposite sign, for a Newton step.
    pub(in super::super) fn residuals(&self) -> ([[T; MOST]; 2], [T; SHARED]) {
        let wheels = [0, 1].each(|side: usize| self.sides[side].equations.residual.each(|c| -c));
        (wheels, self.force.each(|c| -c))
    }

    /// Computes a Newton step.
    pub(in super::super) fn newton_step(&self, axle: &[ElasticWheel<T>; 2]) -> AxleStep<T> {
        let (wheels, shared) = self.residuals();
        let (wheels, shared) = self.solve(&wheels, &shared);
        self.step(axle, &wheels, &shared, false)
    }

    /// Computes all unknowns of a step from the unknowns of equation (1) of this module.
    pub(in super::super) fn step(
        &self,
        axle: &[ElasticWheel<T>; 2],
        wheels: &[[T; MOST]; 2],
        shared: &[T; SHARED],
        is_rate: bool,
    ) -> AxleStep<T> {
        let of = |side: usize| {
            let part = &self.sides[side];
            let system = &axle[side].built.system;
            let own: [T; SHARED] = array_of(|k| shared[k].scaled(sign(side, k)));
            let solution = &wheels[side];
            let carrier: [T; 6] = array_of(|i| solution[i]);
            part.equations.step_seen(solution, |k, followers| {
                let Some(limb) = system.limbs.get(k) else {
                    return followers.step(&carrier, None, is_rate);
                };
                let (seen, beside) =
                    system.seen_step(k, &carrier, &own, &part.frames, &part.around);
                let by = part.coupling.beside.iter().find(|(number, _)| *number == k);
                let beside = by.map(|(_, by)| (*by, beside));
                let mut step = followers.step(&seen, beside.as_ref(), is_rate);
                // The computed shift of the link is relative to the rack, so the shift of the rack is added.
                if let Limb::Floating(Floating {
                    inner: Some(_),
                    on_rack: true,
                    ..
                }) = limb
                {
                    step.inner[1] = step.inner[1] + own[RACK];
                }
                step
            })
        };
        AxleStep {
            wheels: [of(0), of(1)],
            shared: *shared,
        }
    }
}

impl<T: Scalar> AxleState<T> {
    /// Returns the state after a step of all unknowns.
    pub(in super::super) fn stepped(
        &self,
        axle: &[ElasticWheel<T>; 2],
        step: &AxleStep<T>,
    ) -> Self {
        let wheel = |side: usize| {
            let system = &axle[side].built.system;
            system.stepped(&self.wheels[side], &step.wheels[side])
        };
        let [x, y, z, a, b, c, rack, twist] = step.shared;
        let around = &self.around;
        AxleState {
            wheels: [wheel(0), wheel(1)],
            around: Surroundings {
                subframe: around
                    .subframe
                    .moved(Vector3::new(x, y, z), Vector3::new(a, b, c)),
                rack: around.rack + rack,
                twist: around.twist + twist,
            },
        }
    }
}

impl<T: Scalar> AxleStep<T> {
    /// Largest shift and largest rotation of the step.
    pub(in super::super) fn sizes(&self, axle: &[ElasticWheel<T>; 2]) -> [f64; 2] {
        let shared = self.shared.each_ref().each(|c| c.value().abs());
        let shift = shared[..3].iter().copied().fold(shared[RACK], larger);
        let turn = shared[3..RACK].iter().copied().fold(shared[TWIST], larger);
        let mut sizes = [shift, turn];
        for (side, wheel) in axle.iter().enumerate() {
            let own = wheel.built.system.size_of(&self.wheels[side]);
            sizes = [larger(own[0], sizes[0]), larger(own[1], sizes[1])];
        }
        sizes
    }
}

impl AxleEquations<f64> {
    /// Checks the stability of a state. Each wheel must be stable with the shared bodies held. The shared bodies must be
    /// stable with the wheels free to move.
    pub(in super::super) fn check_stable(
        &self,
        bounds: Bounds,
    ) -> Result<(), (Option<usize>, Obstacle)> {
        self.corners.check_stable(&self.sides, bounds)?;
        if self.is_definite() {
            Ok(())
        } else {
            Err((None, Obstacle::Unstable(None)))
        }
    }

    /// Returns true if the symmetric part of the matrix of equation (1) is positive definite for the shared unknowns.
    /// Each row of a rigid joint or of a held height is also a column.
    fn is_definite(&self) -> bool {
        let mut matrix = [[0.0; SHARED]; SHARED];
        for (k, row) in matrix.iter_mut().enumerate() {
            row[k] = 1.0;
        }
        for (a, i) in self.active.iter().enumerate() {
            for (b, j) in self.active.iter().enumerate() {
                matrix[a][b] = 0.5 * (self.own[*i][*j] + self.own[*j][*i]);
            }
        }
        let column = |side: usize, shared: usize| -> [f64; MOST] {
            let of = &self.sides[side];
            let by = of.by_shared(side, shared);
            let mirror = sign(side, shared);
            array_of(|i| match i {
                0..6 => 0.5 * (by[i] + mirror * of.coupling.by_corner[shared][i]),
                _ => by[i],
            })
        };
        let columns = self.active.iter().map(|i| [column(0, *i), column(1, *i)]);
        let columns: Vec<_> = columns.collect();
        self.corners.keep_definite(&self.sides, matrix, &columns)
    }
}

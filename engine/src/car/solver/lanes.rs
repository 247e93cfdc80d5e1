//! Steps towards the equilibria of several cases at the same time. Each SIMD lane contains one case.
//!
//! J approximates the inverse of the tangent G_x, which contains the derivatives of the residuals with respect to the
//! unknowns x. After a step s from x, let r be the residuals at x + s. Broyden's method (C. G. Broyden, Math. Comp. 19,
//! 1965) computes the next step from r. In the inner products, each unknown is divided by its typical size. With u = J r,
//!
//! ```text
//! J' = J - u (s^T J)/(s.s + s.u)            J' maps the change of the residuals along s onto s                    (1)
//! s' = -J' r = -u (s.s)/(s.s + s.u)                                                                               (2)
//! ```
//!
//! The first step is s = -J r. So each step computes the residuals once, and needs neither a tangent nor its LU
//! factors.

#![allow(
    clippy::needless_range_loop,
    reason = "plain loops are inlined into the code for lanes"
)]

use super::super::corner::{Corner, Steps};
use super::super::equations::{Body, Ground, Held, Loaded, Placed, UNKNOWNS};
use super::super::parameters::{BodyParameter, Parameter, Parameters};
use crate::axle::{CURVE_LANES, Carriers, CurveLanes, LaneCurveWheel};
use crate::model::Side;
use crate::number::{SimdReal, SimdTask, Vector3, array_of};

/// One number for each SIMD lane.
pub(super) type Numbers = [f64; CURVE_LANES];

/// Parameters that differ between lanes: accelerations and speed.
pub(super) const OF_CASE: [BodyParameter; 4] = [
    BodyParameter::Ax,
    BodyParameter::Ay,
    BodyParameter::Az,
    BodyParameter::Speed,
];

/// Cases in SIMD lanes during the iteration.
#[derive(Clone, Debug)]
pub(super) struct Lanes {
    pub(super) x: [Numbers; UNKNOWNS],
    /// Last step of the unknowns.
    pub(super) step: [Numbers; UNKNOWNS],
    /// Approximate inverse J of the tangent.
    pub(super) inverse: [[Numbers; UNKNOWNS]; UNKNOWNS],
    /// Reciprocals of the typical sizes of the unknowns.
    pub(super) scales: [Numbers; UNKNOWNS],
    /// Largest component of the last step, relative to the sizes of the unknowns. It is NaN if the step is not finite.
    pub(super) longest: Numbers,
    /// Components of the wheel loads (elastic, geometric, longitudinal, unsprung) before the last step.
    pub(super) parts: [[Numbers; 4]; 4],
    /// 1 in lanes that take steps, 0 in other lanes.
    pub(super) active: Numbers,
    /// Accelerations and speed of each case, in the order of [`OF_CASE`].
    pub(super) of_case: [Numbers; 4],
    /// Wheels at the travels of `x`.
    pub(super) wheels: [CurveLanes; 4],
}

/// Inputs that all lanes share.
#[derive(Clone, Copy)]
pub(super) struct Shared<'p> {
    pub(super) held: Held<'p>,
    pub(super) parameters: &'p Parameters<f64>,
    /// Sprung mass and its centre of gravity.
    pub(super) sprung: (f64, Vector3<f64>),
    pub(super) static_loads: [f64; 2],
}

/// One step in all active lanes.
pub(super) struct Step<'p> {
    pub(super) shared: Shared<'p>,
    /// True for the first step of each lane.
    pub(super) is_first: bool,
    pub(super) lanes: &'p mut Lanes,
}

/// Computes the position of a wheel relative to the ground.
#[inline(always)]
fn placed<B: SimdReal>(
    shared: &Shared<'_>,
    lanes: &Lanes,
    (parameters, ground): (&Parameters<B>, &Ground<B>),
    number: usize,
) -> Placed<B> {
    let like = ground.height;
    let wheel = LaneCurveWheel {
        of: &lanes.wheels[number],
        like,
    };
    let side = (Side::ALL[number % 2].sign(), Carriers::Independent);
    let steps = Steps {
        own: like.zero(),
        other: like.zero(),
        rack: None,
    };
    let offset = parameters.offset(number / 2);
    let corner = Corner::read(&wheel, side, offset, steps, std::convert::identity::<B>);
    let load = like.constant(shared.static_loads[number / 2]);
    Placed::of(&shared.held, parameters, number, corner, ground, load)
}

/// Computes the residuals of the equations, and the components of the wheel loads.
#[inline(always)]
fn evaluate<B: SimdReal>(
    shared: &Shared<'_>,
    lanes: &Lanes,
    x: &[B; UNKNOWNS],
) -> ([B; UNKNOWNS], [[B; 4]; 4]) {
    let (like, held) = (x[0], &shared.held);
    let mut parameters = Parameters(array_of(|k| like.constant(shared.parameters.0[k])));
    for (own, values) in OF_CASE.into_iter().zip(&lanes.of_case) {
        parameters.0[Parameter::Body(own).place()] = like.load(values);
    }
    let ground = Ground::of(&parameters, [x[0], x[1], x[2]]);
    let on_ground = (&parameters, &ground);
    let placed = [
        placed(shared, lanes, on_ground, 0),
        placed(shared, lanes, on_ground, 1),
        placed(shared, lanes, on_ground, 2),
        placed(shared, lanes, on_ground, 3),
    ];
    let (mass, cg) = shared.sprung;
    let sprung = (
        like.constant(mass),
        Vector3::new(
            like.constant(cg.x),
            like.constant(cg.y),
            like.constant(cg.z),
        ),
    );
    let body = Body::of(held, &parameters, &ground, sprung);
    let [a, b, c, d] = &placed;
    let stances = [&a.stance, &b.stance, &c.stance, &d.stance];
    let of = (stances, &body.resultant);
    let loaded = Loaded::of(held, &parameters, &ground.road, of, x);
    (loaded.residuals, loaded.parts(stances))
}

impl SimdTask for Step<'_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let Step {
            shared,
            is_first,
            lanes,
        } = self;
        let x: [B; UNKNOWNS] = array_of(|k| like.load(&lanes.x[k]));
        let (residuals, parts) = evaluate(&shared, lanes, &x);
        let active = like.zero().less(like.load(&lanes.active));
        for wheel in 0..4 {
            for part in 0..4 {
                let kept = &mut lanes.parts[wheel][part];
                B::select(active, parts[wheel][part], like.load(&kept[..])).store(kept);
            }
        }
        let mut u = [like.zero(); UNKNOWNS];
        for (sum, row) in u.iter_mut().zip(&lanes.inverse) {
            for k in 0..UNKNOWNS {
                *sum = sum.plus_product(like.load(&row[k]), residuals[k]);
            }
        }
        let scales: [B; UNKNOWNS] = array_of(|k| like.load(&lanes.scales[k]));
        let mut factor = like.constant(-1.0);
        if !is_first {
            // The last step. Each component is divided by the square of the size of its unknown.
            let mut along = [like.zero(); UNKNOWNS];
            let (mut square, mut product) = (like.zero(), like.zero());
            for k in 0..UNKNOWNS {
                let step = like.load(&lanes.step[k]);
                along[k] = step * scales[k] * scales[k];
                square = square.plus_product(along[k], step);
                product = product.plus_product(along[k], u[k]);
            }
            let inverse = like.one() / (square + product);
            factor = -(square * inverse);
            let mut row = [like.zero(); UNKNOWNS];
            for i in 0..UNKNOWNS {
                for k in 0..UNKNOWNS {
                    row[k] = row[k].plus_product(along[i], like.load(&lanes.inverse[i][k]));
                }
            }
            for i in 0..UNKNOWNS {
                let by = u[i] * inverse;
                for k in 0..UNKNOWNS {
                    let entry = &mut lanes.inverse[i][k];
                    let known = like.load(&entry[..]);
                    B::select(active, known.minus_product(by, row[k]), known).store(entry);
                }
            }
        }
        let (mut longest, mut sum) = (like.zero(), like.zero());
        for k in 0..UNKNOWNS {
            let step = u[k] * factor;
            let size = (step * scales[k]).abs();
            longest = B::select(longest.less(size), size, longest);
            sum = sum + size;
            step.store(&mut lanes.step[k]);
            B::select(active, x[k] + step, x[k]).store(&mut lanes.x[k]);
        }
        // The term `sum * 0` is NaN if any component of the step is not finite. Otherwise it is 0.
        (longest + sum.scaled(0.0)).store(&mut lanes.longest);
    }
}

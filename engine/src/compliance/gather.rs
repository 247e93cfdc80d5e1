//! Sums of the forces of a wheel's parts and of their tangents (derivatives with respect to displacements).

use super::ground::{Frames, Holder};
use super::limb::{Beside, Sum};
use super::point::PointForce;
use super::system::{Equations, Held, MOST_JOINTS, MOST_LIMBS, Singular, State, System};
use crate::number::Valued;

/// Forces and tangents of a wheel's parts, summed for each body that holds them.
#[derive(Clone, Debug)]
pub(super) struct Gathered<T> {
    /// Sums for body, subframe and rack, each in the axes of the body that holds the parts.
    pub(super) sums: [Sum<T>; 3],
    /// Gap of each rigid joint, and the derivatives of the gap with respect to the carrier's motion, in the axes of the
    /// joint's holder.
    pub(super) joints: [(T, [T; 6]); MOST_JOINTS],
    /// Forces of the parts that also depend on coordinates in [`Beside`]: the displacement of a spring's upper end, or
    /// the twist of the anti-roll bar. Each entry contains the index of the part, the body that holds it, and its forces.
    /// A bar on a rigid part has the index [`MOST_LIMBS`].
    pub(super) beside: Vec<(usize, Holder, Beside<T>)>,
}

impl<T: Valued> System<T> {
    /// Sums the forces and tangents of elastic parts and joints, each relative to the body that holds the part. If
    /// `is_apart` is true, body, subframe and rack have separate sums. Otherwise the first sum contains all parts. The
    /// function writes the responses of parts with their own degrees of freedom to `equations`.
    #[inline(always)]
    pub(super) fn gather(
        &self,
        frames: &Frames<T>,
        state: &State<T>,
        held: Option<&Held<T>>,
        is_apart: bool,
        equations: &mut Equations<T>,
    ) -> Result<Gathered<T>, Singular> {
        let like = frames.body.rack.zero();
        let holders = &self.holders;
        let mut found = Gathered {
            sums: [Sum::zero(like); 3],
            joints: [(like, [like; 6]); MOST_JOINTS],
            beside: Vec::new(),
        };
        let group = |holder: Holder, on_rack: bool| match (is_apart, on_rack) {
            (false, _) => 0,
            (true, true) => Holder::RACK,
            (true, false) => holder as usize,
        };
        let nothing = [like; 7];
        for (k, limb) in self.limbs.iter().enumerate() {
            let held = held.map_or(&nothing, |held| &held.limbs[k]);
            let at = frames.of(holders.limbs[k]);
            let number = group(holders.limbs[k], limb.is_on_rack());
            let sum = &mut found.sums[number];
            let mut beside = limb.has_beside().then(|| Beside::zero(like));
            let of = limb.evaluate(at, &state.limbs[k], held, sum, beside.as_mut());
            let of = of.ok_or(Singular::Limb(k))?;
            equations.note(k, &of);
            found
                .beside
                .extend(beside.map(|beside| (k, holders.limbs[k], beside)));
        }
        if let (Some(bar), false) = (&self.bar, frames.body.balance_only) {
            let mut beside = Beside::zero(like);
            let sum = &mut found.sums[group(self.bar_on, false)];
            bar.evaluate(frames.of(self.bar_on), sum, &mut beside);
            found.beside.push((MOST_LIMBS, self.bar_on, beside));
        }
        for (part, holder) in self.bushings.iter().zip(&holders.bushings) {
            let at = frames.of(*holder);
            let e = at.carrier.displacement(part.lever);
            let force = at.force(&part.bushing, e, &at.carrier.turn, None);
            let point = PointForce::of(force.force, force.by_shift);
            let sum = &mut found.sums[group(*holder, false)];
            sum.add_point(at.carrier.lever(part.lever), &point);
            sum.add_moment(force.moment, &force.by_turn);
        }
        for (rod, holder) in self.rods.iter().zip(&holders.rods) {
            if let Some(elastic) = rod.elastic {
                let sum = &mut found.sums[group(*holder, rod.on_rack)];
                rod.add(frames.of(*holder), elastic, sum);
            }
        }
        for (k, (joint, holder)) in self.joints.iter().zip(&holders.joints).enumerate() {
            let at = frames.of(*holder);
            let force = if at.balance_only {
                like
            } else {
                state.joints[k]
            };
            let number = group(*holder, joint.is_on_rack());
            let (miss, row) = joint.evaluate(at, force, &mut found.sums[number]);
            found.joints[k] = (miss, row);
        }
        Ok(found)
    }

    /// Adds the forces of elastic parts and joints to the equations of a single wheel.
    #[inline(always)]
    pub(super) fn add_alone(&self, found: &Gathered<T>, equations: &mut Equations<T>) {
        let sum = &found.sums[0];
        for i in 0..6 {
            equations.residual[i] = equations.residual[i] + sum.force[i];
            for j in 0..6 {
                equations.matrix[i][j] = sum.tangent[i][j];
            }
        }
        for (k, (miss, row)) in found.joints[..self.joints.len()].iter().enumerate() {
            equations.set_joint(k, *miss, *row);
        }
    }
}

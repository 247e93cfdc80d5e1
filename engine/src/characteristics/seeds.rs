//! Seeds of an adjoint: derivatives of the inputs of formulas with respect to a configuration.

use super::Slot;
use crate::derive::{Gradient, Seeds};
use crate::mechanism::Configuration;
use crate::number::{Outlined, Real, Vector3};

impl Slot {
    /// Adds a seed for the quantity of this slot. If the slot is the rate of a quantity, the seed is added to the
    /// quantity itself.
    #[inline(always)]
    pub(crate) fn push<T: Real, G: Gradient<T> + ?Sized>(
        self,
        seed: Vector3<T>,
        at: &Configuration<T>,
        seeds: &mut Seeds<'_, '_, T, G>,
    ) {
        seed.x.outlined(Pushing {
            slot: self,
            seed,
            at,
            seeds,
        });
    }

    /// Adds the seeds of a quantity y(u, u') that contains velocities. u are the inputs of its formula, and u' their rates. From
    /// these seeds, the adjoint computes the derivatives of y with respect to the hardpoints p, as series. `gradient` holds the
    /// derivatives of y slot by slot, and `turn` is the angular velocity.
    ///
    /// Let h and g be the derivatives of y with respect to u and u'. Let u_p be the derivative of u with respect to p. Then dy/dp =
    /// h.u_p + g.u_p'. For any seed series S, an adjoint pass returns the series of S.u_p. If S has the coefficients
    /// S_i = h_(i-1) + (j+1-i) g_i, coefficient j+1 of S.u_p is coefficient j of dy/dp: sum_n h_(j-n) (u_p)_n + sum_n n g_(j+1-n) (u_p)_n.
    /// `shifted` computes the contribution of h to S, `by_rate` computes the contribution of g.
    #[inline(always)]
    pub(super) fn push_rates<V: Real, T: Real, G: Gradient<T> + ?Sized>(
        slots: &[Slot],
        gradient: &[Vector3<V>],
        turn: Vector3<V>,
        shifted: impl Fn(Vector3<V>) -> Vector3<T>,
        by_rate: impl Fn(Vector3<V>) -> Vector3<T>,
        at: &Configuration<T>,
        seeds: &mut Seeds<'_, '_, T, G>,
    ) {
        for (slot, by) in slots.iter().zip(gradient) {
            if *slot == Slot::Turn {
                // A virtual rotation d(turn) changes the angular velocity w by dw = d(turn)' + d(turn) x w. So g.dw contains
                // d(turn).(w x g).
                seeds.turn(shifted(turn.cross(*by)));
            }
            let seed = if slot.is_rate() {
                by_rate(*by)
            } else {
                shifted(*by)
            };
            slot.push(seed, at, seeds);
        }
    }
}

/// Task that adds a seed. It is a separate function, because it is large and called from many places.
struct Pushing<'i, 'c, 's, 'a, T, G: ?Sized> {
    slot: Slot,
    seed: Vector3<T>,
    at: &'i Configuration<'c, T>,
    seeds: &'i mut Seeds<'s, 'a, T, G>,
}

impl<T: Real, G: Gradient<T> + ?Sized> Outlined for Pushing<'_, '_, '_, '_, T, G> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let Pushing {
            slot,
            seed,
            at,
            seeds,
        } = self;
        let mechanism = at.mechanism;
        match slot {
            Slot::SpinAxis | Slot::SpinAxisRate => seeds.spin_axis(seed),
            Slot::Centre | Slot::CentreRate => seeds.point(mechanism.wheel_centre, seed),
            Slot::SteeringPoint => seeds.steering_axis(seed, seed.zero()),
            Slot::SteeringDirection | Slot::SteeringDirectionRate => {
                seeds.steering_axis(seed.zero(), seed);
            }
            Slot::SpringLength | Slot::SpringLengthRate | Slot::Spring => {
                if let Some(spring) = mechanism.spring {
                    let by = match slot {
                        Slot::Spring => seed,
                        _ => {
                            let along = at.point(spring.upper) - at.point(spring.lower);
                            along.normalised() * seed.x
                        }
                    };
                    seeds.point(spring.upper, by);
                    seeds.point(spring.lower, -by);
                }
            }
            Slot::RockerAngle => {
                if let Some(rocker) = mechanism.spring_rocker() {
                    seeds.rocker_angle(rocker, seed.x);
                }
            }
            Slot::BarAngle | Slot::BarAngleRate => {
                if let Some(bar) = mechanism.anti_roll_bar() {
                    seeds.rocker_angle(bar, seed.x);
                }
            }
            Slot::StrutUpper => {
                if let Some(upper) = mechanism.strut_upper() {
                    seeds.point(upper, seed);
                }
            }
            Slot::HeaveSpring => {
                if let Some(end) = mechanism.heave_spring() {
                    seeds.point(end, seed);
                }
            }
            Slot::Turn => seeds.turn(seed),
            Slot::DesignSpinAxis => seeds.designed_spin_axis(seed),
            Slot::DesignCentre => seeds.hardpoint(mechanism.wheel_centre, seed),
            Slot::DesignSpringLength => {
                if let Some(spring) = mechanism.spring {
                    let along = at.designed(spring.upper) - at.designed(spring.lower);
                    let by = along.normalised() * seed.x;
                    seeds.hardpoint(spring.upper, by);
                    seeds.hardpoint(spring.lower, -by);
                }
            }
            Slot::DesignHeaveSpring => {
                if let Some(end) = mechanism.heave_spring() {
                    seeds.hardpoint(end, seed);
                }
            }
        }
    }
}

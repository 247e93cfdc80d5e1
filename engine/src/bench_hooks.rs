//! Closure equations, their factorisation and the closed form, without the checks of the solver. `hardpoint-bench` runs
//! them with other number types and other starts. `hardpoint-attia` factorises its own equations. No other code may use
//! them.

pub use crate::linear::lu::{Lu, Lu6};
pub use crate::mechanism::{Closure, Driver};
pub use crate::solve::closed_form::{ArmState, ClosedForm, Roles};

use crate::compliance::{
    ElasticWheel, EquilibriaInLanes, Equilibrium, HeldQuantity, LaneMemory, WheelFigures,
    WheelLoads, WheelsInLanes,
};
use crate::number::{MOST_LANES, SimdReal, SimdTask, Width};

/// Angles and positions of a wheel in equilibrium, for the benchmark. The benchmark calls this compiled function and does not
/// compile the code a second time.
pub fn wheel_figures(wheel: &ElasticWheel, at: &Equilibrium) -> WheelFigures {
    wheel.figures(at)
}

/// Function that computes equilibria in SIMD lanes. A benchmark measures its time ([`equilibria_in_lanes`]). The first argument
/// receives the angles and positions of each equilibrium. The second argument selects the first (0) or the second (1) piece of
/// work.
pub type LaneWork<'w> = dyn FnMut(&mut dyn FnMut(WheelFigures), usize) + 'w;

/// Prepares equilibria of one wheel in SIMD lanes of this width, and passes two pieces of work to `measure`. The first one
/// solves the loads that fill whole groups of lanes, from the equilibrium at the design height. The second one solves one load
/// after the other in every lane, each from the equilibrium under the previous load. Both pieces of work compute the angles
/// and positions of the wheels. If the wheel cannot be computed in SIMD lanes, the function returns false and does not call
/// `measure`.
pub fn equilibria_in_lanes(
    width: Width,
    wheel: &ElasticWheel,
    from_design: &[WheelLoads],
    levels: &[WheelLoads],
    measure: &mut dyn FnMut(&mut LaneWork<'_>),
) -> bool {
    if wheel.fits_lanes() {
        width.run_in_avx2_lanes(LaneEquilibria {
            wheel,
            from_design,
            levels,
            measure,
        });
    }
    wheel.fits_lanes()
}

struct LaneEquilibria<'w> {
    wheel: &'w ElasticWheel,
    from_design: &'w [WheelLoads],
    levels: &'w [WheelLoads],
    measure: &'w mut dyn FnMut(&mut LaneWork<'_>),
}

impl SimdTask for LaneEquilibria<'_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let LaneEquilibria {
            wheel,
            from_design,
            levels,
            measure,
        } = self;
        let memory = LaneMemory::default();
        let same = [wheel; MOST_LANES];
        let wheels = same[..B::LANES].iter().copied();
        let Some(wheels) = WheelsInLanes::of(like, &memory, wheels) else {
            return;
        };
        let station = wheels.at(0.0, 0.0);
        let mut found = [const { None }; MOST_LANES];
        let mut read = |at: &EquilibriaInLanes<B>, receive: &mut dyn FnMut(WheelFigures)| {
            at.write(&mut found[..B::LANES]);
            for at in found.iter().flatten() {
                receive(wheel.figures(at));
            }
        };
        measure(&mut |receive, job| {
            let mut at = station;
            if job == 0 {
                for loads in from_design.chunks_exact(B::LANES) {
                    let loads = side_by_side(like, loads);
                    let held = HeldQuantity::WheelHeight;
                    read(
                        &wheels.loaded_about(&station, &station, &loads, held),
                        receive,
                    );
                }
            } else {
                for load in levels {
                    let load = load.map(|c| like.constant(c));
                    at = wheels.loaded_about(&station, &at, &load, HeldQuantity::WheelHeight);
                    read(&at, receive);
                }
            }
        });
    }
}

/// Puts loads into lanes, one load per lane.
#[inline(always)]
fn side_by_side<B: SimdReal>(like: B, loads: &[WheelLoads]) -> WheelLoads<B> {
    let of = |part: fn(&WheelLoads) -> f64| {
        let mut parts = [0.0; MOST_LANES];
        for (part_of, load) in parts.iter_mut().zip(loads) {
            *part_of = part(load);
        }
        like.load(&parts)
    };
    let mut all = WheelLoads::none(like);
    all.contact.x = of(|load| load.contact.x);
    all.contact.y = of(|load| load.contact.y);
    all.contact.z = of(|load| load.contact.z);
    all.side = of(|load| load.side);
    all.trail = of(|load| load.trail);
    all.centre.x = of(|load| load.centre.x);
    all.centre.y = of(|load| load.centre.y);
    all.centre.z = of(|load| load.centre.z);
    all.moment.x = of(|load| load.moment.x);
    all.moment.y = of(|load| load.moment.y);
    all.moment.z = of(|load| load.moment.z);
    all
}

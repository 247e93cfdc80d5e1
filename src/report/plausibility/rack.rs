//! Warning about a rack without effect.

use crate::study::Study;

/// Warning about a rack that moves although no part of the suspension is attached to it. The curves are then equal at every rack
/// displacement. `None` if the rack does not move, or if a part is attached to it.
pub fn rack_doubt(study: &Study) -> Option<String> {
    let mechanism = &study.wheel().mechanism;
    let motions = study.motions.iter().map(|(_, motion)| motion);
    let racks = motions
        .chain([study.motion()])
        .flat_map(|motion| &motion.rack);
    let of_axle = study.axle().into_iter().flat_map(|both| {
        let named = both.motions.iter().map(|(_, motion)| motion);
        let all = named.chain([&both.plan.motion]);
        all.flat_map(|motion| &motion.racks)
    });
    let moves = racks.chain(of_axle).any(|rack| *rack != 0.0);
    (moves && !mechanism.is_steered()).then(|| {
        format!(
            "please check: the motion displaces the rack, but no part of a {} is attached to the rack: the \
             curves are the same at every rack position",
            mechanism.topology.name
        )
    })
}

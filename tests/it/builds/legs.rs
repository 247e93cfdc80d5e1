//! Tests of builds whose legs differ from the nominal lengths, in suspensions with a link or a second joint on an arm.

use super::{assembler, study};
use crate::support::larger;
use hardpoint::assembly::{BuildParameter, Member, Rest};
use hardpoint::number::Vector3;

/// Step of the finite differences (mm).
const STEP: f64 = 0.5;

/// The legs of an arm are longer than the nominal legs. The derivatives of every point of the build with respect to each
/// length equal finite differences of fourth order.
#[test]
fn derivatives_of_builds_with_long_legs_are_those_of_differences() {
    for name in ["integral_link_solve", "h_arm_solve"] {
        let study = study(name, &[]);
        let assembler = assembler(&study);
        let mechanism = &assembler.suspension().mechanism;
        let members = Member::all(mechanism);
        let mut parts = assembler.drawn().clone();
        let legs = members.iter().filter(|(name, _)| name.contains("arm"));
        for (leg, (_, member)) in legs.enumerate() {
            let longer = 5.0 - 2.0 * leg as f64;
            parts.change(mechanism, BuildParameter::Length(*member), longer);
        }
        assert_ne!(parts.lengths, assembler.drawn().lengths, "{name}");
        let built = assembler.build(&parts, Rest::Height(0.0)).unwrap();
        for (member, length) in &members {
            let parameter = BuildParameter::Length(*length);
            let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|steps| {
                let mut parts = parts.clone();
                parts.change(mechanism, parameter, steps * STEP);
                let built = assembler.build(&parts, Rest::Height(0.0)).unwrap();
                built.suspension.design
            });
            let (found, _) = assembler.design_by(&built, &[(parameter, 1.0)]);
            let slope = |k: usize| {
                let near = (c[k] - b[k]) * 8.0;
                (near - (d[k] - a[k])) * (1.0 / (12.0 * STEP))
            };
            let off = (0..found.len()).map(|k| (found[k] - slope(k)).norm());
            let most = off.fold(0.0, larger);
            assert!(most < 1e-9, "{name} {member}: {most:e}");
            assert!(found.iter().copied().map(Vector3::norm).fold(0.0, larger) > 0.1);
        }
    }
}

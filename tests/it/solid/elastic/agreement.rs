//! Tests of random axles against the second formulation (`second.rs`).

use super::second::RESULTS;
use super::{Kind, STILL, Scatter, elastic, is_angle, made, results, study};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::model::Side;

/// The program and the second formulation agree for 200 random axles. The axles include all kinds, with and without
/// springs, with equal and different halves. The program uses small rotations of bodies and eliminates rows of the
/// equations. The second formulation minimises one energy in vehicle coordinates. Rounding errors of lengths of 1 m are
/// 1e-13 mm, and the stiffnesses of links differ by up to a factor of 100.
#[test]
fn random_axles_agree_with_the_least_energy() {
    let mut random = Random(20_261_127);
    let mut worst = [0.0_f64; 4];
    for number in 0..200 {
        let kind = [
            Kind::FiveLink,
            Kind::FourLink,
            Kind::FiveLink,
            Kind::ThreeLinkPanhard,
        ][number % 4];
        let scatter = Scatter {
            points: 30.0,
            differs: number % 3 == 0,
            rates: [3.5, 5.5],
            springs: number % 5 != 0,
        };
        let made = made(kind, scatter, &mut random, STILL);
        let travels = [55.0 * random.signed(), 55.0 * random.signed()];
        let study = study(&made.text);
        let axle = elastic(&study);
        let at = axle
            .at(travels, 0.0)
            .unwrap_or_else(|e| panic!("{number}: {e:?}\n{}", made.text));
        let pose = made.axle.solve(travels);
        let (ours, theirs) = (results(&axle, &at), made.axle.results(&pose));
        assert_eq!((ours.len(), theirs.len()), (RESULTS, RESULTS));
        for (k, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            let error = (ours - theirs).abs();
            let kind = usize::from(is_angle(k));
            worst[kind] = larger(worst[kind], error);
            let bound = if is_angle(k) { 1e-11 } else { 1e-8 };
            assert!(error < bound, "{number}, result {k}: {ours} {theirs}");
        }
        for side in Side::ALL {
            let (ours, theirs) = (axle.wheel_load(&at, side), pose.vertical[side as usize]);
            // Bound in N: 1e-11 times the stiffness of the stiffest link (3e5 N/mm), times 10 mm.
            worst[2] = larger(worst[2], (ours - theirs).abs());
            assert!(
                (ours - theirs).abs() < 1e-11 * 3e5 * 10.0,
                "{number}: {ours} {theirs}"
            );
        }
        let tensions = made.axle.tensions(&pose);
        let ours = super::tensions(&made, &study, &axle, &at);
        assert_eq!(ours.len(), tensions.len());
        // The right half has only links that exist on both sides, not those in the middle.
        let own = axle.tensions(&at, Side::Right).len();
        assert_eq!(own, if kind == Kind::ThreeLinkPanhard { 1 } else { 2 });
        for (ours, theirs) in ours.iter().zip(&tensions) {
            worst[3] = larger(worst[3], (ours - theirs).abs());
            assert!(
                (ours - theirs).abs() < 1e-11 * 3e5 * 10.0,
                "{number}: {ours} {theirs}"
            );
        }
    }
    println!(
        "worst: mm {:e}, rad {:e}, wheel load {:e} N, tension {:e} N",
        worst[0], worst[1], worst[2], worst[3]
    );
}

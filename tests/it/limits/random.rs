//! Tests of random double wishbones and struts. For each part, `measures.rs` computes the distance from a singular
//! position, independently of the program. If a limit names a part, this part is singular. If a limit names no part, no
//! part is singular.

use super::measures::Points;
use super::sample;
use crate::support::random::Random;
use hardpoint::analyse::{Range, RangeEnd};
use hardpoint::mechanism::LimitCause;
use hardpoint::solve::Solver;

/// Threshold: a part is singular if its measure from `measures.rs` is smaller.
const SINGULAR: f64 = 1e-6;

#[derive(Debug, Default)]
struct Count {
    designs: usize,
    named: usize,
    unnamed: usize,
    unresolved: usize,
    turns: usize,
}

fn examine(designs: u64, scatter: f64) -> Count {
    let mut count = Count::default();
    for sample in ["macpherson_solve", "double_wishbone_solve"].map(sample) {
        for number in 0..designs {
            let random = &mut Random(7000 + number);
            let design = random.scattered(&sample.design, scatter * sample.size());
            let Ok(mut solver) = Solver::new(&sample.mechanism, &design) else {
                continue;
            };
            let Ok(limits) = solver.limits() else {
                continue;
            };
            count.designs += 1;
            let mut look = |range: &Range, moves_rack: bool| {
                for end in [&range.lower, &range.upper] {
                    let limit = match end {
                        RangeEnd::Fold(limit) => limit,
                        RangeEnd::FullTurn => {
                            count.turns += 1;
                            continue;
                        }
                        RangeEnd::Toggle { .. } | RangeEnd::Unresolved(_) => {
                            count.unresolved += 1;
                            continue;
                        }
                    };
                    let points = Points {
                        mechanism: &sample.mechanism,
                        design: &design,
                        pose: limit.pose,
                        rack: if moves_rack { limit.value } else { 0.0 },
                    };
                    let measures = points.measures();
                    let said = format!("{number} {:?} {measures:?}", limit.cause);
                    if limit.cause.is_part() {
                        let own = measures.iter().find(|(part, _)| *part == limit.cause);
                        assert!(own.unwrap().1 < SINGULAR, "{said}");
                        count.named += 1;
                    } else {
                        assert!(measures.iter().all(|(_, m)| *m >= SINGULAR), "{said}");
                        count.unnamed += 1;
                    }
                    let nearest = measures.iter().map(|(_, m)| *m).fold(1.0, f64::min);
                    let told = limit.nearest.unwrap();
                    assert!((told.sine - nearest).abs() < 1e-9, "{said} {told:?}");
                }
            };
            look(&limits.travel, false);
            look(limits.rack.as_ref().unwrap(), true);
            let arm = limits.arm_angle.as_ref().unwrap();
            look(arm, false);
            // No limit of the arm angle has the cause `ArmStandsStill`.
            for end in [&arm.lower, &arm.upper] {
                if let RangeEnd::Fold(limit) = end {
                    assert_ne!(limit.cause, LimitCause::ArmStandsStill, "{number}");
                }
            }
        }
    }
    println!("{count:?}");
    count
}

#[test]
fn what_is_named_is_singular_and_what_is_not_named_is_not() {
    let count = examine(12, 0.1);
    assert!(
        count.designs > 20 && count.named > 10 && count.unnamed > 40,
        "{count:?}"
    );
    assert!(count.unresolved * 20 <= count.designs, "{count:?}");
}

#[test]
#[ignore = "200 designs of each topology: with .ci/long"]
fn what_is_named_is_singular_in_two_hundred_designs_of_each() {
    let count = examine(200, 0.1);
    assert!(count.designs > 390, "{count:?}");
}

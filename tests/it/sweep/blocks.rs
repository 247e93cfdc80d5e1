//! Tests of blocks of designs against the curves of one design.

use hardpoint::characteristics::{Characteristic, Quantity};
use hardpoint::curves::curves;
use hardpoint::evaluate::{Block, Evaluator, Stations};
use hardpoint::plan::Plan;
use hardpoint::study::Study;

const QUANTITIES: [Quantity; 3] = [
    Quantity::Characteristic(Characteristic::Camber),
    Quantity::Characteristic(Characteristic::Toe),
    Quantity::Characteristic(Characteristic::BumpSteer),
];

fn study() -> Study {
    let path = crate::support::studies().join("macpherson_bump_steer.toml");
    Study::read(
        &path,
        &["motion.travel=[-400.0, -60.0, 0.0, 60.0]".to_owned()],
    )
    .unwrap()
}

/// Values of designs that are evaluated one by one are identical to those of `hardpoint solve`, bit for bit. The values
/// of a design depend neither on neighbouring designs nor on earlier work of the evaluator.
#[test]
fn values_are_those_of_the_curves_whatever_the_neighbours() {
    let study = study();
    let suspension = study.wheel();
    let stations = Stations::of(study.motion(), &suspension.frame, &[]);
    let mut evaluator = Evaluator::new(suspension, &stations, &QUANTITIES).unwrap();
    let mut block = Block::new(QUANTITIES.len(), stations.count());
    let mut flat = suspension.design.clone();
    // The arm's outer joint is on the axis of its inner joints, so the arm has zero length.
    let mechanism = &suspension.mechanism;
    let [front, outer] =
        ["lower_arm_front", "lower_ball_joint"].map(|name| mechanism.point(name).unwrap().0);
    flat[outer] = flat[front];
    let designs = [flat.clone(), suspension.design.clone(), flat].concat();
    evaluator.evaluate(&designs, &mut block);
    assert_eq!(block.designs(), 3);
    assert_eq!(
        block.faults().iter().map(|f| f.0).collect::<Vec<_>>(),
        [0, 2]
    );
    assert!(block.values(0, 0).all(|v| v.is_nan()));

    let curves = curves(suspension, &Plan::of(study.one_wheel().unwrap())).unwrap();
    let camber = Quantity::Characteristic(Characteristic::Camber);
    let factor = 180.0 / std::f64::consts::PI;
    assert_eq!(QUANTITIES[0], camber);
    for (station, solved) in curves.stations.iter().enumerate() {
        let value = block.value(1, 0, station);
        assert_eq!(solved.value(2), (!value.is_nan()).then_some(value * factor));
    }
    let failed: Vec<_> = block
        .failures()
        .iter()
        .map(|f| (f.design, f.station))
        .collect();
    assert_eq!(failed, [(1, 0)]);
    // The slope of toe equals the bump steer.
    let bump_steer = block.value(1, 2, stations.design());
    assert!((block.slope(1, 1) - bump_steer).abs() < 1e-15);
    assert!(block.slope(1, 0) != 0.0);

    let before = block.clone();
    evaluator.evaluate(&designs[suspension.design.len()..], &mut block);
    let alone = block.values(0, 1).skip(1);
    assert!(alone.eq(before.values(1, 1).skip(1)));
    assert_eq!(block.slope(0, 1), before.slope(1, 1));
    assert!(block.slope(0, 2).is_nan());
}

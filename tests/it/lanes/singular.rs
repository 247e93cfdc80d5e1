//! Tests of designs in lanes that are close to a fold or a toggle, or degenerate.

use super::*;

/// Double wishbones whose wheel centre is at its lowest or highest point within 0.01 mm of the design position. Their
/// other points come from `double_wishbone_solve.toml`. So close to a fold (end of travel), the slopes differ from the
/// slopes of the base design. At the fold, a second solution branch starts. Its curves are smooth too, so smoothness
/// alone does not distinguish the branches.
const BESIDE_A_FOLD: [([[f64; 3]; 12], &str, &str); 2] = [
    (
        [
            [3.559105095727901, 384.73921951851366, 411.48594135533403],
            [-51.52461173110213, 464.8247890509996, 533.2254859447784],
            [-58.93697912275535, 592.1694851838768, 549.0655088616003],
            [108.75854763749612, 281.65183848524794, 174.397313573023],
            [-260.07000819234145, 287.32732934453, 162.96336371605742],
            [-31.837276144536652, 785.5120445864833, 252.20299651978297],
            [-227.20534478087959, 397.05023883492106, 155.95653383769618],
            [-207.7365983125793, 673.5490419647047, 250.41702840689914],
            [96.96707419103292, 798.0735363377229, 319.89282306304256],
            [-21.854573250034303, 727.1811108457567, 220.83223954358502],
            [-39.41660537834919, 549.5116201928588, 665.5804600159514],
            [3.831834776388776, 547.8124068002285, 201.1094784875504],
        ],
        FINE,
        "[0.0]",
    ),
    (
        [
            [119.71718744550859, 430.31471960223394, 604.7024030039963],
            [-51.59065171850085, 420.2818889198776, 392.08122712808483],
            [35.060689272752164, 706.0912708635605, 593.6664299836742],
            [113.90431454103253, 459.20881545392484, 120.37612173948305],
            [-255.51849199637235, 356.9410066333063, 146.7877473426656],
            [77.35515576544282, 604.7939015148788, 264.6199379117188],
            [-48.913321426798646, 348.6552696435039, 169.9389887584661],
            [-78.96314145944935, 632.8434360843457, 281.3555113255795],
            [-50.84694937754761, 849.8596358583354, 401.8277343116298],
            [65.07702168316752, 652.3332221568467, 401.8540142497852],
            [-65.09289986015891, 562.7720384897971, 654.0415717941315],
            [-62.774316527772676, 542.0595684044755, 175.06314776802355],
        ],
        COARSE,
        "[-40.0, 0.0, 35.0]",
    ),
];

#[test]
fn designs_beside_a_fold_stay_on_their_own_side() {
    for (points, travel, rack) in BESIDE_A_FOLD {
        let study = study("double_wishbone_solve.toml", travel, rack);
        let suspension = study.wheel();
        let stations = Stations::of(study.motion(), &suspension.frame, &[]);
        let quantities = ANGLES.map(Quantity::Characteristic);
        let design = points.map(|[x, y, z]| Vector3::new(x, y, z));
        let designs: Vec<_> = (0..BLOCK).flat_map(|_| design).collect();
        let mut wanted = Block::new(quantities.len(), stations.count());
        let mut found = wanted.clone();
        let careful = Evaluator::by_continuation(suspension, &stations, &quantities);
        let lanes = Evaluator::new(suspension, &stations, &quantities);
        for (evaluator, block) in [(careful, &mut wanted), (lanes, &mut found)] {
            let mut evaluator = evaluator.expect("the sample can be solved");
            evaluator.evaluate(&designs, block);
        }
        let mut compared = 0;
        for (k, quantity) in quantities.iter().enumerate() {
            for station in 0..stations.count() {
                let [a, b] = [&found, &wanted].map(|block| block.value(0, k, station));
                let agree = (a - b).abs() < BESIDE_FOLDS || (a.is_nan() && b.is_nan());
                assert!(agree, "{quantity:?} at {station}: {a}, not {b}");
                compared += usize::from(!a.is_nan());
            }
        }
        // The design position has every quantity.
        assert!(compared >= quantities.len(), "{compared}");
    }
}

/// Design 3672 of the pushrods with bars has random changes of up to 40 mm. In the design position it is very near its
/// toggle (leverage 5.9e-5). If poses differ by one rounding error, their motion ratios differ by a relative 1e-7. The
/// expected ratio was computed in 60 digits: from the six linear equations of the knuckle's twist, then from the equations
/// of rocker and bar.
#[test]
fn the_design_position_is_the_design_itself_beside_a_toggle() {
    const NUMBER: usize = 3672;
    const RATIO: f64 = 44.276_002_729_724_26;
    let study = study("double_wishbone_rocker.toml", FINE, "[0.0]");
    let suspension = study.wheel();
    let stations = Stations::of(study.motion(), &suspension.frame, &[]);
    let quantities = [Quantity::Characteristic(
        Characteristic::AntiRollBarMotionRatio,
    )];
    let mut scatter = Scatter {
        random: Random(19),
        base: suspension.design.clone(),
        by: 40.0,
    };
    let mut blocks = std::iter::from_fn(|| Some(scatter.block()));
    let block = blocks.nth(NUMBER / BLOCK).expect("endless");
    let points = suspension.design.len();
    let design = &block[NUMBER % BLOCK * points..][..points];
    for evaluator in [
        Evaluator::new(suspension, &stations, &quantities),
        Evaluator::by_continuation(suspension, &stations, &quantities),
    ] {
        let mut evaluator = evaluator.expect("the sample can be solved");
        let mut found = Block::new(1, stations.count());
        evaluator.evaluate(design, &mut found);
        let ratio = found.value(0, 0, stations.design());
        // The bound is one rounding error of the design, 2e-16, divided by the leverage, times 25 for further rounding
        // errors.
        assert!((ratio - RATIO).abs() < 1e-10 * RATIO, "{ratio}");
    }
}

/// Lanes skip a degenerate design with a rod of zero length. This does not affect later designs in the same lane.
#[test]
fn a_degenerate_design_leaves_its_lane_as_it_was() {
    for (name, [one, other]) in [
        ("macpherson_solve.toml", ["tie_rod_inner", "tie_rod_outer"]),
        ("five_link_solve.toml", ["toe_link_inner", "toe_link_outer"]),
    ] {
        let study = study(name, FINE, "[0.0]");
        let suspension = study.wheel();
        let stations = Stations::of(study.motion(), &suspension.frame, &[]);
        let quantities = quantities(&study);
        let place = |name| suspension.mechanism.point(name).expect("a point").0;
        let mut without = suspension.design.clone();
        without[place(one)] = without[place(other)];
        let sound = suspension.design.repeat(BLOCK - 1);
        for width in Width::available() {
            let mut evaluator =
                Evaluator::with_width(suspension, &stations, &quantities, Some(width))
                    .unwrap_or_else(|_| panic!("the sample cannot be solved"));
            let mut block = Block::new(quantities.len(), stations.count());
            let fallback = evaluator.evaluate(&[&without[..], &sound].concat(), &mut block);
            assert_eq!(fallback, 1, "{name}, {}", width.name());
        }
    }
}

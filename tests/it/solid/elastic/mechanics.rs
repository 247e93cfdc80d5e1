//! Tests of elastic solid axles against mechanics: work and energy, mirror images, links that fit without force, and
//! the forces of links that do not fit.

use super::rigid_limit::{largest, rigid, values};
use super::{Kind, Made, STILL, Scatter, elastic, made, results, study};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::compliance::{
    AxleChange, AxleEquilibrium, AxleKcRun, AxleVehicle, ElasticAxle, HeldQuantity, TestLoad,
};
use hardpoint::model::Side;
use hardpoint::study::AxleStudy;

const HEIGHT: HeldQuantity = HeldQuantity::WheelHeight;

const BAR: &str = "drop_link_outer = [-60.0, 520.0, 300.0]\ndrop_link_inner = [-60.0, 515.0, 420.0]\n\
                   anti_roll_bar_inner = [-260.0, 50.0, 420.0]\nanti_roll_bar_outer = [-260.0, 510.0, 420.0]\n";

fn plain(kind: Kind, springs: bool, further: &str) -> Made {
    let scatter = Scatter {
        points: 0.0,
        differs: false,
        rates: [4.3, 4.3],
        springs,
    };
    made(kind, scatter, &mut Random(1), further)
}

/// Random axle with an anti-roll bar.
fn with_bar(kind: Kind, random: &mut Random) -> Made {
    let scatter = Scatter {
        points: 20.0,
        differs: true,
        rates: [4.0, 5.0],
        springs: true,
    };
    let made = made(kind, scatter, random, STILL);
    let text = made
        .text
        .replace("wheel_centre =", &format!("{BAR}wheel_centre ="));
    Made {
        text: text + "[anti_roll_bar]\nrate = 6.0e5\n",
        ..made
    }
}

/// Nodes and weights of Gauss-Legendre integration on [0, 1].
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

fn energy(made: &Made, study: &AxleStudy, axle: &ElasticAxle, at: &AxleEquilibrium) -> f64 {
    let tensions = super::tensions(made, study, axle, at);
    let links = made.axle.links.iter().zip(tensions);
    let mut sum: f64 = links
        .map(|(link, tension)| tension * tension / (2.0 * link.rate))
        .sum();
    for (side, spring) in Side::ALL.into_iter().zip(&made.axle.springs) {
        let now = axle.spring(at, side).unwrap();
        let shortened = (now.force - spring.force) / spring.rate;
        sum += spring.force * shortened + 0.5 * spring.rate * shortened * shortened;
    }
    match axle.bar_torque(at) {
        Some(torque) => sum + torque * torque / (2.0 * 6.0e5),
        None => sum,
    }
}

/// The work of the rig's pads under the wheels equals the energy stored in links, springs and bar. The work is
/// integrated with five nodes in each of eight intervals. Its error is proportional to the tenth power of the interval.
#[test]
fn the_work_of_the_travels_is_the_energy() {
    let mut random = Random(42);
    for kind in [
        Kind::FiveLink,
        Kind::FourLink,
        Kind::ThreeLinkPanhard,
        Kind::FiveLink,
    ] {
        let made = with_bar(kind, &mut random);
        let study = study(&made.text);
        let axle = elastic(&study);
        let way = [50.0 * random.signed(), 50.0 * random.signed()];
        let at = |share: f64| axle.at(way.map(|c| c * share), 0.0).unwrap();
        const PARTS: usize = 8;
        let mut work = 0.0;
        for part in 0..PARTS {
            for (node, weight) in GAUSS {
                let here = at((part as f64 + node) / PARTS as f64);
                let tangent = axle.tangent(&here, HEIGHT).unwrap();
                let by = axle.figures_along(&tangent, &AxleChange::Travels(way));
                for side in Side::ALL {
                    let power = axle.wheel_load(&here, side) * by[side as usize].contact.z;
                    work += power * weight / PARTS as f64;
                }
            }
        }
        let stored =
            energy(&made, &study, &axle, &at(1.0)) - energy(&made, &study, &axle, &at(0.0));
        println!("{kind:?}: {work} {stored}");
        assert!(stored.abs() > 100.0, "{stored}");
        assert!(
            (work - stored).abs() < 1e-8 * stored.abs().max(1e4),
            "{kind:?}: {work} {stored}"
        );
        assert!(axle.out_of_balance(&at(1.0)) < 1e-6);
    }
}

/// A Panhard rod that runs to the other side mirrors the motion of the axle.
#[test]
fn a_mirrored_rod_mirrors_the_axle() {
    let made = plain(Kind::FiveLink, true, STILL);
    let other = made
        .text
        .replace("480.0, 360.0", "-480.0, 360.0")
        .replace("-470.0, 335.0", "470.0, 335.0");
    assert_ne!(other, made.text);
    let [axle, other] = [&made.text, &other].map(|text| elastic(&study(text)));
    for travels in [[30.0, -20.0], [25.0, 25.0], [-40.0, 10.0]] {
        let [right, left] = travels;
        let (a, b) = (
            axle.at(travels, 0.0).unwrap(),
            other.at([left, right], 0.0).unwrap(),
        );
        let (ours, theirs) = (results(&axle, &a), results(&other, &b));
        for k in 0..8 {
            let sign = if matches!(k, 3 | 6) { -1.0 } else { 1.0 };
            assert!((ours[k] - sign * theirs[8 + k]).abs() < 1e-10, "{k}");
        }
        for (k, sign) in [(16, -1.0), (17, 1.0), (18, 1.0), (19, -1.0), (20, 1.0)] {
            assert!((ours[k] - sign * theirs[k]).abs() < 1e-10, "{k}");
        }
        assert!(ours[19].abs() > 0.1, "{}", ours[19]);
    }
}

/// Four equal parallel links let the axle translate, and the Panhard rod determines its lateral position. So all five
/// links fit without force in heave, but carry forces in roll.
#[test]
fn equal_parallel_links_fit_in_heave() {
    let points = [
        ("[540.0, 420.0, 305.0]", "[500.0, 450.0, 305.0]"),
        ("[5.0, 530.0, 255.0]", "[0.0, 450.0, 285.0]"),
        ("[440.0, 370.0, 445.0]", "[520.0, 350.0, 465.0]"),
        ("[15.0, 350.0, 475.0]", "[20.0, 350.0, 445.0]"),
    ];
    let mut text = plain(Kind::FiveLink, false, STILL).text;
    for (from, to) in points {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let axle = elastic(&study(&text));
    let tension = |travels: [f64; 2]| {
        let at = axle.at(travels, 0.0).unwrap();
        let all = Side::ALL.map(|side| axle.tensions(&at, side)).concat();
        assert_eq!(all.len(), 5);
        (
            all.iter().fold(0.0_f64, |m, t| larger(m, t.unwrap().abs())),
            results(&axle, &at),
        )
    };
    for heave in [-60.0, 45.0] {
        let (most, found) = tension([heave, heave]);
        // The bound is 2e4 N/mm times the rounding error of a length.
        assert!(most < 1e-6, "{most}");
        assert!(
            found[16].abs() < 1e-12 && found[17].abs() < 1e-12,
            "{found:?}"
        );
        // Lengths of the links and of the rod in vehicle coordinates.
        let [dx, dy] = [found[18], found[19]];
        let length = (500.0_f64 * 500.0 + 20.0 * 20.0).sqrt();
        let own = ((500.0 - dx).powi(2) + dy * dy + (20.0 - heave).powi(2)).sqrt();
        assert!((own - length).abs() < 1e-9, "{own} {length}");
        let rod = (950.0_f64 * 950.0 + 25.0 * 25.0).sqrt();
        let own = (dx * dx + (dy - 950.0).powi(2) + (heave - 25.0).powi(2)).sqrt();
        assert!((own - rod).abs() < 1e-9, "{own} {rod}");
    }
    assert!(tension([40.0, -40.0]).0 > 10.0);
}

/// If one of five links is very soft, the axle moves like a rigid axle with one upper link on its left side. Five rigid
/// links do not fit in roll. In the best fit, the link lengths are wrong by about 1 mm at 2 degrees, and by 2 to 4 mm
/// at 4 degrees.
#[test]
fn five_rigid_links_miss_by_millimetres() {
    const MOTION: &str = "[motion]\ntravel_left = [26.54, -26.54, 53.14, -53.14]\ntravel_right = [26.54, -26.54, 53.14, -53.14]\n[outputs]\n\
                          characteristics = [\"axle_steer\", \"pinion_angle\", \"axle_lateral\", \"axle_longitudinal\"]\n";
    let made = plain(Kind::FiveLink, false, MOTION);
    let stiff = super::rigid_limit::stiffer(&made.text, 1e6);
    let soft = format!("{stiff}[axle.right.links.upper_link]\naxial_stiffness = 0.001\n");
    let single = rigid(&made.text).replace(
        "\"solid_axle\"\n",
        "\"solid_axle\"\nsingle = [\"upper_link\"]\n",
    );
    // The soft link carries 0.001 N/mm times its misfit of millimetres. The other links deflect by less than 1e-9 mm.
    // The rates differ by a factor of 2e13, so rounding errors are larger than that.
    let (ours, theirs) = (values(&soft), values(&single));
    let apart = largest(&ours, &theirs);
    assert!(ours.len() > 16 && apart < 1e-6, "{apart:e}");
    // Equal stiffness of all links gives the best fit of the lengths.
    let study = study(&made.text);
    let axle = elastic(&study);
    for (travel, least, most) in [(26.54, 0.8, 1.5), (53.14, 2.0, 4.0)] {
        for sign in [-1.0, 1.0] {
            let at = axle.at([sign * travel, -sign * travel], 0.0).unwrap();
            let links = made
                .axle
                .links
                .iter()
                .zip(super::tensions(&made, &study, &axle, &at));
            let misses = links.map(|(link, tension)| (tension / link.rate).abs());
            let miss = misses.fold(0.0, larger);
            assert!((least..most).contains(&miss), "{travel}: {miss}");
        }
    }
}

fn roll_figure(text: &str, name: &str, travels: [f64; 2]) -> f64 {
    let study = study(text);
    let vehicle = AxleVehicle {
        suspensions: Side::ALL.map(|side| study.axle.suspension(side)),
        tyre_rate: None,
    };
    let elastic = study.axle.elastic.as_ref().unwrap();
    let run = AxleKcRun::new(vehicle, &elastic.parts).unwrap();
    let mut tests = elastic.tests.iter();
    let test = *tests.find(|test| test.load == TestLoad::Roll).unwrap();
    let stations = run.run(&[(travels, 0.0)], &[test]);
    let figures = &stations[0].outcomes.as_ref().unwrap()[0].figures;
    let own = figures.iter().find(|f| f.quantity == name);
    own.unwrap_or_else(|| panic!("{name}: {figures:?}"))
        .value
        .unwrap()
}

/// Four links add no roll stiffness. Five links add a roll stiffness that is proportional to their rates. The axle
/// without springs has no other roll stiffness.
#[test]
fn the_links_add_roll_stiffness_by_their_rates() {
    let name = "link_roll_stiffness";
    for kind in [Kind::FourLink, Kind::ThreeLinkPanhard] {
        let made = plain(kind, true, STILL);
        for travels in [[0.0, 0.0], [30.0, -25.0]] {
            // Roll stiffness of the links in N mm/rad. The springs have a roll stiffness of 2e7 N mm/rad.
            let found = roll_figure(&made.text, name, travels);
            assert!(found.abs() < 1.0, "{kind:?}: {found}");
        }
    }
    let made = plain(Kind::FiveLink, true, STILL);
    for travels in [[0.0, 0.0], [30.0, -25.0], [20.0, 20.0]] {
        let own = roll_figure(&made.text, name, travels);
        let twice = roll_figure(&super::rigid_limit::stiffer(&made.text, 2.0), name, travels);
        assert!(own > 1e4, "{own}");
        assert!((twice / own - 2.0).abs() < 1e-9, "{own} {twice}");
        let without: String = made
            .text
            .lines()
            .take_while(|l| *l != "[spring]")
            .map(|l| format!("{l}\n"))
            .collect();
        let alone = roll_figure(&(without + STILL), name, travels);
        assert!((alone / own - 1.0).abs() < 1e-9, "{own} {alone}");
        let whole = roll_figure(&made.text, "compliant_roll_stiffness", travels);
        assert!(whole > own, "{whole} {own}");
    }
}

/// With `at_design_load`, the nominal design is the equilibrium, and its wheel loads are those of the rigid axle. The
/// matrix of displacements per load is symmetric.
#[test]
fn the_drawing_is_the_equilibrium_at_the_design_load() {
    let mut random = Random(3);
    for kind in [Kind::FiveLink, Kind::FourLink, Kind::ThreeLinkPanhard] {
        let made = with_bar(kind, &mut random);
        let text = made.text.replace("\"free\"", "\"at_design_load\"");
        let study = study(&text);
        let axle = elastic(&study);
        let at = axle.at([0.0; 2], 0.0).unwrap();
        let middle = axle.place(&at).unwrap().middle;
        assert!(middle.norm() < 1e-11, "{middle:?}");
        let load = |side| axle.wheel_load(&at, side);
        let [left, right] = Side::ALL.map(load);
        let designed = axle.design_loads().unwrap();
        assert!((left - designed[0]).abs() + (right - designed[1]).abs() < 1e-6);
        if kind != Kind::FiveLink {
            const LOADS: &str = "[outputs]\ncharacteristics = [\"wheel_load\"]\n";
            let expected = values(&(rigid(&made.text) + LOADS));
            assert!(
                (left - expected[0]).abs() < 1e-6 && (right - expected[1]).abs() < 1e-6,
                "{expected:?} {left} {right}"
            );
        }
        // Without the springs, the forces of the links at the design load are released.
        let links = axle.on_its_links().unwrap();
        let alone = links.at([0.0; 2], 0.0).unwrap();
        if kind != Kind::FiveLink {
            assert!(links.wheel_load(&alone, Side::Left).abs() < 1e-6);
        }
        let vehicle = AxleVehicle {
            suspensions: Side::ALL.map(|side| study.axle.suspension(side)),
            tyre_rate: None,
        };
        let elastic = study.axle.elastic.as_ref().unwrap();
        let run = AxleKcRun::new(vehicle, &elastic.parts).unwrap();
        let stations = run.run(&[([10.0, -15.0], 0.0)], &elastic.tests);
        let matrix = stations[0].matrix.as_ref().unwrap();
        // A wheel load at the contact point makes the stiffness matrix slightly unsymmetric. The unsymmetric part is
        // small compared with the stiffness of the springs.
        let size = (0..12).map(|i| matrix[i][i].abs()).fold(0.0, larger);
        for i in 0..12 {
            for j in 0..12 {
                let apart = (matrix[i][j] - matrix[j][i]).abs();
                let scale = (matrix[i][i] * matrix[j][j]).abs().sqrt();
                assert!(
                    apart < 1e-9 * scale.max(1e-6 * size),
                    "{i} {j}: {apart} {scale}"
                );
            }
        }
        // Both wheels are on one body, so their rotations are equal in the study's axes.
        for i in 3..6 {
            for (j, (left, right)) in matrix[i].iter().zip(&matrix[i + 6]).enumerate() {
                assert!((left - right).abs() < 1e-12, "{i} {j}");
            }
        }
    }
}

//! Tests of the limits of the motion of axles.

use super::{axle, reference::read};
use hardpoint::axle::{AxleSolver, Placement, TravelRanges};
use hardpoint::model::Side;

/// The rack range of an axle ends where one of the two tie rods reaches its limit. One strut allows -113.3 to 164.5 mm,
/// so the axle allows -113.3 to 113.3 mm. A position exists at a roll angle just before the roll limit, but not at one
/// beyond the limit.
#[test]
fn the_first_wheel_to_end_is_the_end() {
    let axle = axle(&read("macpherson_front"));
    let mut solver = AxleSolver::<1>::new(&axle, &[], false).unwrap();
    let limits = solver.limits().unwrap();
    let [lower, upper] = limits.rack.unwrap();
    assert_eq!((lower.side, upper.side), (Side::Left, Side::Right));
    assert!((lower.value + 113.3).abs() < 0.05, "{}", lower.value);
    assert_eq!(lower.value, -upper.value);

    let [lower, upper] = limits.roll.map(Option::unwrap);
    assert_eq!((lower.side, upper.side), (Side::Left, Side::Right));
    assert!((lower.value + upper.value).abs() < 1e-9, "{}", lower.value);
    let mut at = |share: f64| {
        solver.place(&Placement::Roll {
            heave: 0.0,
            roll: share * upper.value,
            rack: 0.0,
        })
    };
    let placed = at(0.9999).unwrap();
    let TravelRanges::OfWheels([_, right]) = &limits.travels else {
        panic!("independently suspended wheels");
    };
    let end = right.upper.value();
    assert!(
        (placed.travels[1] - end).abs() < 1e-3 * end,
        "{placed:?} {end}"
    );
    assert!(at(1.001).is_err());
}

/// Refusals and reasons for positions beyond the limits do not depend on the order in which the solver finds the
/// limits.
#[test]
fn positions_beyond_the_ends_are_refused_the_same_in_any_order() {
    let axle = axle(&read("macpherson_front"));
    let mut solver = AxleSolver::<1>::new(&axle, &[], false).unwrap();
    let [_, upper] = solver.limits().unwrap().roll.map(Option::unwrap);
    let mut placements = Vec::new();
    for rack in [0.0, 30.0] {
        for heave in [0.0, -60.0] {
            for share in [0.5, -1.5, 0.99, 1.001, -0.9] {
                let roll = share * upper.value;
                placements.push(Placement::Roll { heave, roll, rack });
            }
        }
    }
    let mut refused = 0;
    for order in [false, true] {
        if order {
            placements.reverse();
        }
        let mut solver = AxleSolver::<1>::new(&axle, &[], false).unwrap();
        for placement in &placements {
            let alone = AxleSolver::<1>::new(&axle, &[], false)
                .unwrap()
                .place(placement);
            let after_others = solver.place(placement);
            match (&after_others, &alone) {
                (Ok(after_others), Ok(alone)) => assert_eq!(after_others, alone, "{placement}"),
                // If both searches fail, both report the same limit. From any start, the solver finds the limit up to rounding
                // errors.
                (Err(after_others), Err(alone)) => {
                    let [one, other] = [after_others, alone]
                        .map(|f| f.describe(axle.left.length_unit, axle.left.frame));
                    assert_eq!(one, other, "{placement}");
                }
                _ => panic!("{placement}: {after_others:?} {alone:?}"),
            }
            refused += usize::from(alone.is_err());
        }
    }
    assert!((8..32).contains(&refused), "{refused} of 40");
}

/// Rockers of both wheels have the same limits as in the study of one wheel.
#[test]
fn rockers_of_an_axle_have_the_limits_of_their_wheel() {
    let rows = |with: &str| {
        let hardpoint = || assert_cmd::Command::cargo_bin("hardpoint").unwrap();
        let new = hardpoint()
            .args(["new", "double_wishbone", "--with", with])
            .assert()
            .success();
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("study.toml");
        std::fs::write(&path, &new.get_output().stdout).unwrap();
        let call = ["limits", path.to_str().unwrap(), "--format", "csv"];
        let limits = hardpoint()
            .args(call)
            .assert()
            .success()
            .get_output()
            .stdout
            .clone();
        let limits = String::from_utf8(limits).unwrap();
        let rows = limits
            .lines()
            .filter(|line| line.contains("pushrod_travel"));
        rows.map(str::to_owned).collect::<Vec<_>>()
    };
    let [wheel] = &rows("pushrod")[..] else {
        panic!("one rocker of a wheel");
    };
    // The test compares only the numbers of the rows. The study of one wheel has no moving rack, so the text of its row may
    // state another rack position.
    let figures =
        |row: &str| -> Vec<f64> { row.split(',').filter_map(|c| c.parse().ok()).collect() };
    let of_axle = rows("pushrod,axle");
    assert_eq!(of_axle.len(), 2, "{of_axle:?}");
    for (row, side) in of_axle.iter().zip(["left", "right"]) {
        assert!(row.contains(&format!("{side}_pushrod_travel")), "{row}");
        assert_eq!(figures(row), figures(wheel), "{row}");
        assert_eq!(figures(row).len(), 2, "{row}");
    }
}

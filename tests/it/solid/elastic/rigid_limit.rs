//! Tests of stiff links against the rigid program.

use super::{Kind, Made, Scatter, made, study};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::axle_curves;

const MOTION: &str = "[motion]\ntravel_left = [-40.0, 0.0, 45.0]\ntravel_right = [-45.0, 10.0]\n[outputs]\n\
                      characteristics = [\"axle_steer\", \"pinion_angle\", \"axle_lateral\", \"axle_longitudinal\", \"mean_steer\", \
                      \"camber\", \"track_change\", \"roll_centre_height\", \"roll_centre_lateral\"]\n";

/// Values of all stations, in order.
pub fn values(text: &str) -> Vec<f64> {
    let study = study(text);
    let curves = axle_curves(&study.axle, &study.plan).unwrap().curves;
    let stations = curves.stations.iter();
    let of = |station: &hardpoint::curves::Station| {
        let values = station.values.iter();
        let values = values.map(|v| *v.as_ref().unwrap_or_else(|e| panic!("{e:?}")));
        values.collect::<Vec<_>>()
    };
    stations.flat_map(of).collect()
}

/// Text without elastic parts.
pub fn rigid(text: &str) -> String {
    let mut kept = String::new();
    let mut is_elastic = false;
    for line in text.lines() {
        if line.starts_with('[') {
            is_elastic = line.starts_with("[compliance") || line.contains("links.");
        }
        if !is_elastic {
            kept += line;
            kept += "\n";
        }
    }
    kept
}

/// Text with all rates multiplied by a factor.
pub fn stiffer(text: &str, factor: f64) -> String {
    let of = |line: &str| match line.strip_prefix("axial_stiffness = ") {
        Some(rate) => {
            let rate = rate.parse::<f64>().unwrap() * factor;
            format!("axial_stiffness = {rate:?}\n")
        }
        None => format!("{line}\n"),
    };
    text.lines().map(of).collect()
}

fn cases(springs: bool) -> Vec<Made> {
    let mut random = Random(31);
    let kinds = [Kind::FourLink, Kind::ThreeLinkPanhard]
        .into_iter()
        .cycle()
        .take(6)
        .enumerate();
    kinds
        .map(|(number, kind)| {
            let scatter = Scatter {
                points: 25.0,
                differs: number >= 2,
                rates: [4.0, 5.0],
                springs,
            };
            made(kind, scatter, &mut random, MOTION)
        })
        .collect()
}

/// Largest difference between two lists of equal length.
pub fn largest(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, larger)
}

/// The springs displace the axle by their force divided by the link stiffness. So links that are ten times stiffer give a tenth of
/// the difference, up to rounding errors.
#[test]
fn the_error_falls_as_one_over_the_stiffness() {
    for made in cases(true) {
        let expected = values(&rigid(&made.text));
        let errors: Vec<f64> = (0..8)
            .map(|power| largest(&values(&stiffer(&made.text, 10_f64.powi(power))), &expected))
            .collect();
        println!("{errors:?}");
        let mut compared = 0;
        for pair in errors.windows(2).skip(1).filter(|pair| pair[1] > 1e-7) {
            let quotient = pair[1] / pair[0];
            assert!((0.095..0.105).contains(&quotient), "{errors:?}");
            compared += 1;
        }
        assert!(compared >= 2, "{errors:?}");
        assert!(errors[0] > 1e-3 && errors[7] < 1e-7, "{errors:?}");
    }
}

/// Without springs no force acts on four links, so they keep their lengths, whatever their stiffness.
#[test]
fn four_links_without_springs_are_rigid() {
    for made in cases(false) {
        let error = largest(&values(&made.text), &values(&rigid(&made.text)));
        assert!(error < 1e-9, "{error:e}");
    }
}

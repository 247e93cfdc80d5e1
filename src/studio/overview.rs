//! The study, as far as it stays while points move.

use super::message::{
    CharacteristicOverview, Coordinates, Overview, PointOverview, TargetOverview, VariableOverview,
};
use super::study_file::{Opened, StudyFile};
use crate::attia::PaperTheta;
use crate::characteristics::Characteristic;
use crate::model::Suspension;
use crate::number::Vector3;
use crate::plan::Plan;
use crate::report::Scene;
use crate::study::{Drive, Study, Target};

/// The overview of a study that was read.
pub(super) fn overview(file: &StudyFile, opened: &Opened) -> Overview {
    let study = &opened.study;
    let suspension = &study.suspension;
    let mechanism = &suspension.mechanism;
    let unit = suspension.length_unit;
    let optimise = study.optimise.as_ref();
    let wanted = Plan::with_targets(study);
    let asked = |c: &Characteristic| {
        let name = c.info().name;
        wanted.outputs.iter().any(|output| output.name == name)
    };
    let characteristic = |c: &Characteristic| CharacteristicOverview {
        name: c.info().name,
        column: c.column(unit),
        unit: c.info().unit.suffix(unit),
        positive: c.info().positive,
        asked: asked(c),
        available: c.info().needs.iter().all(|need| need.met_by(suspension)),
    };
    let point = |name: &String| PointOverview {
        name: name.clone(),
        about: mechanism
            .topology
            .hardpoint(name)
            .map_or("a point to report", |hardpoint| hardpoint.about)
            .to_owned(),
    };
    let drive = match study.motion.drive {
        Drive::Travel => [
            format!("travel_{}", unit.symbol()),
            "travel".to_owned(),
            unit.symbol().to_owned(),
        ],
        Drive::ArmAngle => ["arm_angle_deg", "arm angle", "°"].map(str::to_owned),
        Drive::PaperTheta => ["theta_deg", "theta", "°"].map(str::to_owned),
    };
    Overview {
        name: study.name.clone(),
        file: file.name(),
        place: file.path().display().to_string(),
        digest: opened.digest.clone(),
        topology: mechanism.topology.name.replace('_', " "),
        unit: unit.symbol().to_owned(),
        points: mechanism.points.iter().map(|p| point(&p.name)).collect(),
        design: coordinates(suspension, &suspension.design),
        scene: Scene::of(suspension),
        characteristics: Characteristic::ALL.iter().map(characteristic).collect(),
        drive,
        drive_values: study
            .motion
            .values
            .iter()
            .map(|value| study.motion.drive.printed(*value))
            .collect(),
        drive_home: home(study),
        racks: study.motion.rack.clone(),
        rack_moves: study.motion.rack_moves,
        is_steered: mechanism.steering_axis.is_some(),
        targets: optimise
            .iter()
            .flat_map(|o| &o.targets)
            .map(|t| target(t, study))
            .collect(),
        variables: optimise
            .iter()
            .flat_map(|o| &o.variables)
            .map(|variable| VariableOverview {
                name: variable.name.clone(),
                moves: variable
                    .moves
                    .iter()
                    .map(|m| (m.point.0, m.axis as usize, m.factor))
                    .collect(),
                is_turn: variable.turn.is_some(),
                range: variable.range,
            })
            .collect(),
        tunes: optimise.is_some(),
        starts: optimise.map_or(0, |o| o.starts),
    }
}

/// A design of the kernel's, in the study's axes.
pub(super) fn coordinates(suspension: &Suspension, design: &[Vector3<f64>]) -> Coordinates {
    let outside = |p: &Vector3<f64>| suspension.frame.vector(*p).to_array().map(|c| c + 0.0);
    design.iter().map(outside).collect()
}

/// The drive value in the design position, as it is printed.
fn home(study: &Study) -> f64 {
    let suspension = &study.suspension;
    let paper = || PaperTheta::of(&suspension.mechanism, &suspension.design).ok();
    match study.motion.drive {
        Drive::Travel | Drive::ArmAngle => 0.0,
        Drive::PaperTheta => paper().map_or(0.0, |theta| {
            study.motion.drive.printed(theta.design_value())
        }),
    }
}

fn target(target: &Target, study: &Study) -> TargetOverview {
    let motion = target.site.motion.as_ref();
    let own = motion.map_or(&study.motion, |(_, motion)| motion);
    let factor = target.of.factor();
    let printed = |limit: f64| limit.is_finite().then_some(limit * factor);
    let mut points: Vec<_> = target
        .wanted
        .samples(&target.stations_in(own))
        .into_iter()
        .map(|sample| {
            let [low, high] = match factor < 0.0 {
                true => [sample.high, sample.low],
                false => [sample.low, sample.high],
            };
            (own.drive.printed(sample.drive), printed(low), printed(high))
        })
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    TargetOverview {
        column: target.of.column.clone(),
        tolerance: target.tolerance * factor.abs(),
        is_band: matches!(target.wanted, crate::study::Wanted::Band { .. }),
        points,
        motion: motion.map(|(name, _)| name.clone()),
        racks: target.site.racks.clone(),
    }
}

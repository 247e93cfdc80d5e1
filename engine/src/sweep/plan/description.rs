//! Description of a sweep without its results, for `sweep.json`.

use super::*;
use crate::study::Motion;
use crate::sweep::digest_of;

/// Describes the sweep of a study. The columns of the outputs follow later.
pub(super) fn describe(
    study: &Study,
    sweep: &Sweep,
    samples: &Samples,
    stations: &Stations,
) -> SweepRecord {
    let (suspension, motion) = (study.wheel(), study.motion());
    let unit = suspension.length_unit;
    let (method, seed) = match samples {
        Samples::Sampled(sampled) => (sampled.method.name(), Some(sampled.seed)),
        Samples::Table(_) => ("file", None),
    };
    let variables = samples.variables().iter().map(|v| VariableRecord {
        column: v.column(unit),
        low: v.range[0],
        high: v.range[1],
        steps: v.steps.filter(|_| method == "grid"),
        at_design: v.at_design(suspension).map(|value| value + 0.0),
        moves: v
            .moves
            .iter()
            .map(|m| MoveRecord {
                hardpoint: suspension.mechanism.name(m.point).to_owned(),
                axis: m.axis.name().to_owned(),
                factor: m.factor,
            })
            .collect(),
    });
    let tuning = study.optimise.as_ref();
    let targets = tuning.map_or(&[][..], |o| o.ranking_targets());
    let targets = targets.iter().map(|t| target_column(t, motion));
    SweepRecord {
        form: FORM,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        digest: digest(study, sweep, samples),
        study: study.name.clone(),
        topology: suspension.mechanism.topology.name.to_owned(),
        length_unit: unit.symbol().to_owned(),
        method: method.to_owned(),
        seed,
        designs: samples.designs(),
        blocks_of_part: BLOCKS_OF_PART,
        drive: match study.axle() {
            Some(both) => both.plan.motion.moving()[0].column(unit),
            None => motion.drive.column(unit),
        },
        stations: stations.count(),
        variables: variables.collect(),
        outputs: Vec::new(),
        targets: targets.collect(),
        is_fit: tuning.is_some_and(|o| o.fit),
        unchecked_constraints: tuning
            .filter(|_| !sweep.constraints)
            .map_or_else(Vec::new, |o| {
                o.constraints.iter().map(|own| own.name.clone()).collect()
            }),
        curves: sweep.curves,
        format: sweep.format.name().to_owned(),
    }
}

/// Describes a target. Its points are the values at the stations of the sweep. Targets with other stations have no points.
fn target_column(t: &Target, motion: &Motion) -> TargetColumn {
    let factor = t.of.factor();
    let stations = match &t.site.axle {
        Some(site) => t.stations_among(&site.values),
        None => t.stations_in(motion),
    };
    // The page with the results shows the curves at the rack displacement of the design position.
    let home = motion.design_rack();
    let is_shown = t.site.racks.is_empty() || t.site.racks.contains(&home);
    let wanted = t.wanted.at_stations(&stations).into_iter();
    let wanted = wanted.filter(|_| is_shown && t.is_in_sweep(motion));
    TargetColumn {
        column: t.of.column.clone(),
        tolerance: (t.tolerance * factor).abs(),
        weight: t.weight,
        points: wanted
            .map(|(drive, value)| [t.printed_at(motion.drive, drive), value * factor])
            .collect(),
    }
}

/// SHA-256 digest of everything that determines the results. The digest covers the meaning of the study, not its text, so
/// that comments may change.
fn digest(study: &Study, sweep: &Sweep, samples: &Samples) -> String {
    let meaning = format!(
        "{} {:?} {:?} {:?} {:?}",
        env!("CARGO_PKG_VERSION"),
        study.vehicle,
        study.optimise.as_ref().map(|o| {
            let constraints = sweep.constraints.then_some(&o.constraints);
            let constraints = constraints.filter(|own| !own.is_empty());
            (&o.targets, o.fit, constraints)
        }),
        (sweep.curves, sweep.format),
        match samples {
            Samples::Sampled(sampled) => format!("{:?}", sampled.meaning()),
            Samples::Table(table) => format!("{:?}", table.digest),
        },
    );
    digest_of(&meaning)
}

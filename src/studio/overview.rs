//! Data of the study that do not change while points move.

use super::message::{
    CharacteristicOverview, Coordinates, JointOverview, MemberOverview, MotionOverview, Overview,
    PointOverview, Slider, TargetOverview, VariableOverview, WheelDrawn, WholeScene,
};
use super::study_file::Opened;
use crate::attia::PaperTheta;
use crate::characteristics::Characteristic;
use crate::compliance::{not_of_equilibrium, sign_of_figure};
use crate::model::{Axis, PointId, Suspension};
use crate::number::Vector3;
use crate::plan::Plan;
use crate::report::{Scene, wanted_between};
use crate::study::{
    Drive, Optimise, Study, Target, TargetKind, Variable, Vehicle, WheelStudy, named_joints,
    named_members,
};

/// Overview of a study that was read.
pub(super) fn overview(opened: &Opened) -> Overview {
    let (file, study) = (&opened.file, &opened.study);
    let suspension = study.wheel();
    let mechanism = &suspension.mechanism;
    let unit = suspension.length_unit;
    let optimise = study.optimise.as_ref();
    let point = |(id, name): (usize, &String)| PointOverview {
        name: name.clone(),
        about: mechanism
            .topology
            .hardpoint(name)
            .map_or("a point to report", |hardpoint| hardpoint.about)
            .to_owned(),
        axle: None,
        shift: [0.0; 3],
        follows: mechanism.is_far(PointId(id)),
    };
    let names = mechanism.points.iter().map(|point| &point.name);
    let named = study.motion_names().into_iter();
    let named = named.filter_map(|name| {
        let (sliders, main) = sliders(&study.in_motion(name)?);
        Some(MotionOverview {
            name: name.to_owned(),
            sliders,
            main,
        })
    });
    let motions = named.collect();
    let (sliders, main) = sliders(study);
    Overview {
        name: study.name.clone(),
        file: file.name(),
        files: vec![file.name()],
        place: file.path().display().to_string(),
        digest: opened.digest.clone(),
        base: opened.base.clone(),
        written: written(&opened.text),
        topology: mechanism.topology.name.replace('_', " "),
        unit: unit.symbol().to_owned(),
        axes: Axis::ALL.map(|axis| suspension.frame.sign(axis)),
        points: names.enumerate().map(point).collect(),
        members: member_overviews(suspension, None, 0),
        joints: joint_overviews(suspension, None, 0),
        design: coordinates(suspension, &suspension.design),
        scene: scene(suspension),
        characteristics: match &study.vehicle {
            Vehicle::Wheel(own) => catalogue(own, optimise),
            Vehicle::Axle(both) => super::axle::catalogue(study, both),
        },
        is_axle: study.axle().is_some(),
        is_car: false,
        sliders,
        main,
        motions,
        targets: optimise
            .iter()
            .flat_map(|o| &o.targets)
            .map(|t| target(t, study))
            .collect(),
        variables: optimise
            .iter()
            .flat_map(|o| &o.variables)
            .map(variable)
            .collect(),
        tunes: optimise.is_some(),
        builds: optimise
            .and_then(|o| o.scatter.as_ref())
            .filter(|scatter| scatter.lowers_misfit())
            .map(|scatter| scatter.builds),
        has_constraints: optimise.is_some_and(|o| !o.constraints.is_empty()),
        starts: optimise.map_or(0, |o| o.starts),
    }
}

pub(super) fn variable(variable: &Variable) -> VariableOverview {
    let moves = variable.moves.iter();
    VariableOverview {
        name: variable.name.clone(),
        moves: moves
            .map(|m| (m.point.0, m.axis as usize, m.factor))
            .collect(),
        is_turn: variable.turn.is_some(),
        range: variable.range,
    }
}

/// Members (rods, legs of arms, struts, springs, drive shafts) of a suspension. Its points start at index `first` of the page's
/// points.
pub(super) fn member_overviews(
    suspension: &Suspension,
    axle: Option<&str>,
    first: usize,
) -> Vec<MemberOverview> {
    let overview = |(name, ends): (String, [PointId; 2])| MemberOverview {
        name,
        axle: axle.map(str::to_owned),
        ends: ends.map(|end| first + end.0),
    };
    named_members(suspension)
        .into_iter()
        .map(overview)
        .collect()
}

/// Joints of a suspension whose angle a constraint can limit. The points of the suspension start at index `first` of the page's
/// points.
pub(super) fn joint_overviews(
    suspension: &Suspension,
    axle: Option<&str>,
    first: usize,
) -> Vec<JointOverview> {
    let overview = |joint: PointId| JointOverview {
        name: suspension.mechanism.name(joint).to_owned(),
        axle: axle.map(str::to_owned),
        point: first + joint.0,
    };
    named_joints(suspension).into_iter().map(overview).collect()
}

fn scene(suspension: &Suspension) -> WholeScene {
    let scene = Scene::of(suspension);
    let wheel = scene.wheel_radius.map(|radius| WheelDrawn {
        centre: scene.wheel_centre,
        radius,
    });
    WholeScene {
        wheels: wheel.into_iter().collect(),
        scene,
    }
}

/// Sections of a study as they are written, for the forms of the page.
fn written(text: &str) -> serde_json::Value {
    let document: toml::Table = text.parse().unwrap_or_default();
    let suspension = document.get("suspension").and_then(toml::Value::as_table);
    let mass = suspension.and_then(|own| own.get("mass_unit")?.as_str());
    let mass = mass.unwrap_or("kg").to_owned();
    let mut shown = chosen(
        document,
        &[
            "vehicle",
            "motion",
            "motions",
            "outputs",
            "optimise",
            "bushings",
            "links",
            "spring",
            "anti_roll_bar",
            "steering",
            "compliance",
        ],
    );
    shown["mass_unit"] = mass.into();
    shown
}

/// Sections of a study text with the names `shown`, as they are written.
pub(super) fn sections(text: &str, shown: &[&str]) -> serde_json::Value {
    chosen(text.parse().unwrap_or_default(), shown)
}

fn chosen(document: toml::Table, shown: &[&str]) -> serde_json::Value {
    let sections = document.into_iter();
    let sections = sections.filter(|(name, _)| shown.contains(&name.as_str()));
    serde_json::to_value(toml::Table::from_iter(sections)).unwrap_or_default()
}

/// Coordinates of a design, converted from the internal frame (x forward, y left, z up) to the study's axes.
pub(super) fn coordinates(suspension: &Suspension, design: &[Vector3<f64>]) -> Coordinates {
    let outside = |p: &Vector3<f64>| suspension.frame.vector(*p).to_array().map(|c| c + 0.0);
    design.iter().map(outside).collect()
}

/// Drive value of the study in the design position, in printed units.
fn home(study: &Study) -> f64 {
    let suspension = study.wheel();
    let paper = || PaperTheta::of(&suspension.mechanism, &suspension.design).ok();
    match study.motion().drive {
        Drive::Travel | Drive::ArmAngle => 0.0,
        Drive::PaperTheta => paper().map_or(0.0, |theta| {
            study.motion().drive.printed(theta.design_value())
        }),
    }
}

/// Characteristics and rig test results of a wheel, each marked if outputs or targets request it and if the study can compute it.
fn catalogue(own: &WheelStudy, optimise: Option<&Optimise>) -> Vec<CharacteristicOverview> {
    let suspension = &own.suspension;
    let wanted = Plan::with_targets(own, optimise);
    let asked = |name: &str| wanted.outputs.iter().any(|output| output.name == name);
    let is_rigid = own.compliance.is_none();
    let characteristic = |c: &Characteristic| CharacteristicOverview {
        name: c.info().name.to_owned(),
        unit: c.info().unit.suffix(suspension.length_unit),
        positive: c.info().positive,
        asked: asked(c.info().name),
        available: c.info().needs.iter().all(|need| need.met_by(suspension))
            && (is_rigid || not_of_equilibrium(*c).is_none()),
    };
    let figures = own.figures();
    let figures = figures.iter().map(|figure| CharacteristicOverview {
        name: figure.name.clone(),
        unit: figure.unit.suffix(suspension.length_unit),
        positive: sign_of_figure(&figure.name),
        asked: wanted.figures.iter().any(|own| own.value == figure.value),
        available: true,
    });
    let all = Characteristic::ALL.iter().map(characteristic);
    all.chain(figures).collect()
}

/// Sliders of a study's own motion, and the index of the slider whose coordinate is initially on the horizontal axis of the curves.
fn sliders(study: &Study) -> (Vec<Slider>, usize) {
    match study.axle() {
        None => of_corner(study),
        Some(both) => super::axle::sliders(both),
    }
}

/// Sliders of one wheel (drive and rack), and the index of the slider whose coordinate is initially on the horizontal axis of the
/// curves.
fn of_corner(study: &Study) -> (Vec<Slider>, usize) {
    let motion = study.motion();
    let (key, name, unit) = match motion.drive {
        Drive::Travel => ("travel", "travel", study.wheel().length_unit.symbol()),
        Drive::ArmAngle => ("arm_angle", "arm angle", "°"),
        Drive::PaperTheta => ("theta", "theta", "°"),
    };
    let printed = motion
        .values
        .iter()
        .map(|value| motion.drive.printed(*value));
    let values: Vec<f64> = printed.collect();
    let home = home(study);
    let drive = Slider::over(key, name, unit, home, &values);
    // If the study keeps the rack constant, this rack position is the home position of the slider.
    let rack_home = if motion.rack_moves {
        0.0
    } else {
        motion.rack[0]
    };
    let rack = rack_slider(study.wheel(), rack_home, &motion.rack);
    (vec![drive, rack], 0)
}

/// Slider of the rack, or of the drag link that steers a solid axle. The range of the slider contains the range of the motion,
/// and at least 60 mm to both sides of 0. If nothing steers the wheels, the range has only the position `home`.
pub(super) fn rack_slider(suspension: &Suspension, home: f64, racks: &[f64]) -> Slider {
    let (unit, mechanism) = (suspension.length_unit, &suspension.mechanism);
    let name = match mechanism.axle_steering() {
        Some(_) => "drag link",
        None => "rack",
    };
    let mut slider = Slider::over("rack", name, unit.symbol(), home, racks);
    if !mechanism.is_steered() {
        (slider.low, slider.high) = (home, home);
        return slider;
    }
    let usual = 0.06 * unit.per_metre();
    slider.low = slider.low.min(-usual);
    slider.high = slider.high.max(usual);
    slider
}

impl Slider {
    /// Makes a slider whose range contains these values and the position `home`.
    pub(super) fn over(
        key: &'static str,
        name: &'static str,
        unit: &'static str,
        home: f64,
        values: &[f64],
    ) -> Self {
        Slider {
            key,
            name,
            unit,
            low: values.iter().copied().fold(home, f64::min),
            high: values.iter().copied().fold(home, f64::max),
            home,
            values: values.to_vec(),
            names: Vec::new(),
        }
    }
}

fn target(target: &Target, study: &Study) -> TargetOverview {
    let motion = target.site.motion.as_ref();
    let own = motion.map_or(study.motion(), |(_, motion)| motion);
    let stations = match &target.site.axle {
        Some(site) => target.stations_among(&site.values),
        None => target.stations_in(own),
    };
    let racks = match (study.axle(), target.site.racks.as_slice()) {
        (Some(_), _) => Vec::new(),
        (None, []) if own.rack_moves => vec![0.0],
        (None, []) => own.rack.clone(),
        (None, racks) => racks.to_vec(),
    };
    let columns = match &target.of.kind {
        TargetKind::Wheel(_) | TargetKind::Elastic(_) => vec![target.of.column.clone()],
        TargetKind::Axle(quantities) => {
            let length = study.wheel().length_unit;
            let columns = quantities.iter();
            columns.map(|q| super::axle::column(*q, length)).collect()
        }
    };
    TargetOverview {
        column: target.of.column.clone(),
        columns,
        tolerance: target.tolerance * target.of.factor().abs(),
        is_band: matches!(target.wanted, crate::study::Wanted::Band { .. }),
        points: wanted_between(target, &stations, own.drive),
        motion: match &target.site.axle {
            Some(site) => site.motion.clone(),
            None => motion.map(|(name, _)| name.clone()),
        },
        over: match (study.axle(), &target.site.axle) {
            (Some(both), Some(site)) => {
                let named = both.motions.iter();
                let mut named = named.filter(|(name, _)| Some(name) == site.motion.as_ref());
                let motion = named.next().map_or(&both.plan.motion, |(_, motion)| motion);
                super::axle::slider_of(motion, site.over)
            }
            _ => Some(0),
        },
        racks,
    }
}

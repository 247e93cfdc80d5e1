//! Data of a car that do not change while points move.

use super::misfit::{name_of, name_on_rig};
use super::{OpenedCar, coordinates};
use crate::car::{AXLE_NAMES, AxleParameter, Car, CarQuantity, CarVariable, rate_key};
use crate::model::{Axis, PointId, Suspension};
use crate::report::{Scene, readable_unit};
use crate::studio::message::{
    CharacteristicOverview, Overview, PointOverview, Slider, TargetOverview, VariableOverview,
    WheelDrawn, WholeScene,
};
use crate::studio::overview::{joint_overviews, member_overviews, sections};
use crate::study::{CarOptimise, CarStudy};

/// Results that are shown at first if the study requests none.
const SHOWN: [&str; 9] = [
    "roll",
    "pitch",
    "heave",
    "wheel_load",
    "lateral_load_transfer_distribution",
    "camber_to_road",
    "roll_centre_height",
    "roll_gradient",
    "body_roll_stiffness",
];

/// Overview of a car that was read.
pub(super) fn overview(opened: &OpenedCar) -> Overview {
    let study = &opened.study;
    let optimise = study.optimise.as_ref();
    let names = opened.files.names();
    let topology = |end: usize| {
        let name = study.axles[end].wheel().mechanism.topology.name;
        format!("{} {}", AXLE_NAMES[end], name.replace('_', " "))
    };
    Overview {
        name: study.name.clone(),
        file: names[0].clone(),
        files: names.to_vec(),
        place: opened.files.path().display().to_string(),
        digest: opened.digest.clone(),
        base: opened.base.clone(),
        written: written(study),
        topology: [0, 1].map(topology).join(", "),
        unit: study.car.length_unit.symbol().to_owned(),
        axes: Axis::ALL.map(|axis| study.frame().sign(axis)),
        points: points(study),
        members: of_axles(study, member_overviews),
        joints: of_axles(study, joint_overviews),
        design: coordinates(study),
        scene: scene(study),
        characteristics: catalogue(study),
        is_axle: true,
        is_car: true,
        sliders: vec![cases(study)],
        main: 0,
        motions: Vec::new(),
        targets: optimise.map_or(Vec::new(), |optimise| targets(study, optimise)),
        variables: optimise
            .iter()
            .flat_map(|optimise| &optimise.variables)
            .map(|own| variable(own, study))
            .collect(),
        tunes: optimise.is_some(),
        builds: None,
        has_constraints: optimise.is_some_and(|optimise| {
            let mut rigs = optimise.rigs.iter().flatten();
            let of_rigs = rigs.any(|rig| !rig.optimise.constraints.is_empty());
            of_rigs || !optimise.constraints.is_empty()
        }),
        starts: optimise.map_or(0, |optimise| optimise.run.starts),
    }
}

/// Sections of the car's study and of both axle studies as written, for the forms of the page.
fn written(study: &CarStudy) -> serde_json::Value {
    let of_axle = [
        "spring",
        "anti_roll_bar",
        "heave_spring",
        "t_bar",
        "heave_bar",
        "tyre",
        "vehicle",
    ];
    let mut all = sections(&study.text, &["car", "cases", "outputs", "optimise"]);
    for (end, axle) in AXLE_NAMES.iter().zip(&study.axles) {
        all[*end] = sections(&axle.text, &of_axle);
    }
    all["units"] = units(&study.car);
    all
}

/// Units of the numbers in the forms of the page, by the keys of the study.
fn units(car: &Car) -> serde_json::Value {
    let rates = [
        AxleParameter::SpringRate,
        AxleParameter::SpringForce,
        AxleParameter::BarRate,
        AxleParameter::HeaveSpringRate,
        AxleParameter::HeaveSpringForce,
        AxleParameter::TBarRate,
        AxleParameter::HeaveBarRate,
        AxleParameter::HeaveBarTorque,
        AxleParameter::TyreRate,
    ];
    let rates = rates.map(|rate| (rate_key(rate), readable_unit(&rate.unit(car).0)));
    let (length, mass) = (car.length_unit.symbol(), car.mass_unit.symbol());
    let others = [
        ("mass", mass),
        ("sprung_mass", mass),
        ("cg", length),
        ("sprung_cg", length),
        ("wheelbase", length),
        ("rear_offset", length),
        ("yaw_inertia", "kg m\u{b2}"),
        ("pitch_inertia", "kg m\u{b2}"),
        ("ax", "g"),
        ("ay", "g"),
        ("az", "g"),
        ("speed", "m/s"),
        ("yaw_acceleration", "rad/s\u{b2}"),
        ("rack", length),
        ("steering_wheel_angle", "\u{b0}"),
    ];
    let others = others.map(|(key, unit)| (key, unit.to_owned()));
    let all = rates.into_iter().chain(others);
    all.map(|(key, unit)| (key.to_owned(), unit.into()))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

/// Points of the left wheels: first of the front axle, then of the rear axle.
pub(super) fn points(study: &CarStudy) -> Vec<PointOverview> {
    let mut found = Vec::new();
    for (end, axle) in study.car.axles.iter().enumerate() {
        let mechanism = &axle.left.mechanism;
        let shift = match end {
            0 => [0.0; 3],
            _ => study.frame().vector(study.car.rear_offset).to_array(),
        };
        for (id, point) in mechanism.points.iter().enumerate() {
            let about = mechanism.topology.hardpoint(&point.name);
            let about = about.map_or("a point to report", |hardpoint| hardpoint.about);
            found.push(PointOverview {
                name: format!("{}_{}", AXLE_NAMES[end], point.name),
                about: format!("{} axle: {about}", AXLE_NAMES[end]),
                axle: Some([AXLE_NAMES[end].to_owned(), point.name.clone()]),
                shift,
                follows: mechanism.is_far(PointId(id)),
            });
        }
    }
    found
}

/// Members or joints of both axles. `of` returns the members or joints of one axle. Its arguments are the suspension, the name of
/// the axle and the index of its first point.
fn of_axles<T>(
    study: &CarStudy,
    of: impl Fn(&Suspension, Option<&str>, usize) -> Vec<T>,
) -> Vec<T> {
    let [front, rear] = study.car.axles.each_ref().map(|axle| &axle.left);
    let first = front.mechanism.points.len();
    let mut found = of(front, Some(AXLE_NAMES[0]), 0);
    found.extend(of(rear, Some(AXLE_NAMES[1]), first));
    found
}

/// Drawing of the left side of both axles.
fn scene(study: &CarStudy) -> WholeScene {
    let [mut whole, rear] = study.car.axles.each_ref().map(|axle| Scene::of(&axle.left));
    let first = whole.points.len();
    let wheels = [(&whole, 0), (&rear, first)].map(|(scene, first)| {
        Some(WheelDrawn {
            centre: first + scene.wheel_centre,
            radius: scene.wheel_radius?,
        })
    });
    let named = |end: &str, name: &str| format!("{end} {name}");
    for body in &mut whole.bodies {
        body.name = named(AXLE_NAMES[0], &body.name);
    }
    for mut body in rear.bodies {
        body.name = named(AXLE_NAMES[1], &body.name);
        for point in body.lines.iter_mut().flatten() {
            *point += first;
        }
        whole.bodies.push(body);
    }
    whole.points.extend(rear.points);
    WholeScene {
        wheels: wheels.into_iter().flatten().collect(),
        scene: whole,
    }
}

/// Slider that selects a load case.
fn cases(study: &CarStudy) -> Slider {
    let values: Vec<f64> = (0..study.cases.len()).map(|case| case as f64).collect();
    Slider {
        names: study.cases.iter().map(|case| case.name.clone()).collect(),
        ..Slider::over("case", "load case", "", 0.0, &values)
    }
}

/// Common name of a result at all wheels or at both axles. If a result of the whole car has the same name, returns the own name
/// of the given result.
fn group(quantity: CarQuantity) -> String {
    let name = match quantity {
        CarQuantity::Wheel(_, result) => result.info().name.to_owned(),
        CarQuantity::Axle(_, result) => result.info().name.replace("_{}", ""),
        CarQuantity::Whole(result) => result.info().name.to_owned(),
    };
    if CarQuantity::named(&name).contains(&quantity) {
        name
    } else {
        quantity.name()
    }
}

/// Results of the car that the page can show, each marked if the study, its targets or its constraints request it.
fn catalogue(study: &CarStudy) -> Vec<CharacteristicOverview> {
    let car = &study.car;
    let mut asked: Vec<String> = if study.quantities == CarQuantity::default_columns(car) {
        SHOWN.map(str::to_owned).to_vec()
    } else {
        study.quantities.iter().copied().map(group).collect()
    };
    if let Some(optimise) = &study.optimise {
        let targets = optimise.targets.iter().map(|target| target.quantity);
        let constraints = optimise.constraints.iter().map(|own| own.quantity);
        asked.extend(targets.chain(constraints).map(group));
    }
    let mut found: Vec<CharacteristicOverview> = Vec::new();
    for quantity in CarQuantity::all() {
        let name = group(quantity);
        if found.iter().any(|own| own.name == name) {
            continue;
        }
        let named = CarQuantity::named(&name);
        found.push(CharacteristicOverview {
            asked: asked.contains(&name),
            available: named.iter().any(|own| own.is_met_by(car)),
            unit: quantity.info().unit.suffix(car.length_unit),
            positive: quantity.info().positive,
            name,
        });
    }
    found
}

fn targets(study: &CarStudy, optimise: &CarOptimise) -> Vec<TargetOverview> {
    let finite = |limit: f64| limit.is_finite().then_some(limit);
    let of_cases = optimise.targets.iter().map(|target| {
        let [low, high] = target.wanted;
        TargetOverview {
            column: name_of(target, study),
            columns: vec![target.quantity.column(study.car.length_unit)],
            tolerance: target.tolerance,
            points: vec![(target.case as f64, finite(low), finite(high))],
            motion: None,
            over: Some(0),
            racks: Vec::new(),
            is_band: low < high,
        }
    });
    let rigs = optimise.rigs.iter().enumerate();
    let of_rigs = rigs.flat_map(|(end, rig)| {
        let targets = rig.iter().flat_map(|rig| &rig.optimise.targets);
        targets.map(move |target| TargetOverview {
            column: name_on_rig(&target.of.column, end),
            columns: Vec::new(),
            tolerance: target.tolerance * target.of.factor().abs(),
            points: Vec::new(),
            motion: None,
            over: None,
            racks: Vec::new(),
            is_band: false,
        })
    });
    of_cases.chain(of_rigs).collect()
}

pub(super) fn variable(variable: &CarVariable, study: &CarStudy) -> VariableOverview {
    let first = [0, study.car.axles[0].left.design.len()];
    let moves = variable.moves.points().iter().map(|at| {
        // The variable refers to the axes of the study of its axle. The page uses the axes of the front study.
        let own = study.car.axles[at.axle].left.frame;
        let sign = own.sign(at.axis) * study.frame().sign(at.axis);
        (
            first[at.axle] + at.point.0,
            at.axis as usize,
            sign * at.factor,
        )
    });
    VariableOverview {
        name: variable.moves.label(&study.car),
        moves: moves.collect(),
        is_turn: false,
        range: variable.range,
    }
}

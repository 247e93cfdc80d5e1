//! Requests to the evaluators: for one wheel, for elastic parts and for an axle.

use super::*;
use crate::sorting::sort_by_key;

/// Three results of planning: the request of a sweep, the derivatives of each column in the design position, and the target
/// values of each target.
type Planned<'s> = (Request<'s>, Vec<Vec<Gain>>, Vec<Vec<SweptWish>>);

/// Plans the sweep of a study. `swept` contains the targets that are compared at stations of the sweep, `samples` the designs
/// of the sweep.
pub(super) fn of_study<'s>(
    study: &'s Study,
    sweep: &Sweep,
    swept: &[Target],
    samples: &Samples,
) -> Planned<'s> {
    let samples_in = |target: &Target| {
        let stations = target.stations_in(study.motion());
        target.wanted.samples(&stations)
    };
    let wanted: Vec<Vec<Sample>> = swept.iter().map(samples_in).collect();
    let further: Vec<f64> = wanted.iter().flatten().map(|s| s.drive).collect();
    match &study.vehicle {
        Vehicle::Axle(both) => {
            let targets: Vec<_> = swept.iter().map(|t| t.axle_samples(&both.axle)).collect();
            let rates = samples.rates().map(|rate| rate.parameter.into()).collect();
            of_axle(both, both.plan_with(swept), &targets, rates, sweep.curves)
        }
        Vehicle::Wheel(own) => {
            let suspension = study.wheel();
            let stations = Stations::of(&own.motion, &suspension.frame, &further);
            let plan = with_gains(own, study.optimise.as_ref());
            match &own.compliance {
                None => of_corner(suspension, &plan, stations, swept, &wanted),
                Some(elastic) => {
                    let rates = samples.rates().map(|rate| rate.parameter).collect();
                    let targets = (swept, &wanted[..]);
                    of_elastic(own, elastic, &plan, stations, targets, rates, sweep.curves)
                }
            }
        }
    }
}

/// Plans the sweep of one rigid wheel. `wanted` contains the target values of each target.
fn of_corner<'s>(
    suspension: &'s Suspension,
    plan: &Plan,
    stations: Stations,
    swept: &[Target],
    wanted: &[Vec<Sample>],
) -> Planned<'s> {
    let quantities: Vec<Quantity> = plan.outputs.iter().filter_map(Output::quantity).collect();
    let columns = Column::all(plan, suspension.length_unit);
    let (values, slopes): (Vec<_>, Vec<_>) = columns.into_iter().partition(|c| c.order == 0);
    let gain = |(slope, gain): (usize, Column)| {
        let own = Gain {
            column: with_unit(format!("{}_gain", gain.output), &gain.unit),
            factor: gain.factor(),
            unit: gain.unit,
            slope,
        };
        if quantities[slope].is_gain() {
            Vec::new()
        } else {
            vec![own]
        }
    };
    let gains: Vec<Vec<Gain>> = slopes.into_iter().enumerate().map(gain).collect();
    let wishes = swept.iter().zip(wanted).map(|(target, wanted)| {
        let measure = target.of.of_wheel().and_then(|of| of.quantity());
        let quantity = quantities.iter().position(|q| measure == Some(*q));
        let quantity = quantity.expect("the plan contains the characteristics of the targets");
        SweptWish::of(target, wanted, quantity, &stations, &suspension.frame)
    });
    let wishes = wishes.collect();
    let request = Request::of_corner(Cow::Borrowed(suspension), stations, quantities, values);
    (request.with_slopes(|k| !gains[k].is_empty()), gains, wishes)
}

/// Plans the sweep of a wheel with elastic parts: characteristics over the motion, test results in the design position. With
/// `curves`, the sweep also reads test results over the motion.
fn of_elastic<'s>(
    own: &WheelStudy,
    elastic: &ComplianceStudy,
    plan: &Plan,
    stations: Stations,
    (swept, wanted): (&[Target], &[Vec<Sample>]),
    rates: Vec<Parameter>,
    curves: bool,
) -> Planned<'s> {
    let length = own.suspension.length_unit;
    let (mut reads, mut columns, mut gains) = (Vec::new(), Vec::new(), Vec::new());
    let (values, slopes): (Vec<_>, Vec<_>) = Column::all(plan, length)
        .into_iter()
        .partition(|column| column.order == 0);
    for (slope, (column, gain)) in values.into_iter().zip(slopes).enumerate() {
        let Some(Quantity::Characteristic(of)) = plan.outputs[slope].quantity() else {
            continue;
        };
        let has_gain = !of.info().reads_rates();
        reads.push(ElasticRead {
            value: KcValue::Wheel(of),
            slope: has_gain.then_some(KcValue::WheelRate(of)),
        });
        let own = has_gain.then(|| Gain {
            column: with_unit(format!("{}_gain", gain.output), &gain.unit),
            factor: gain.factor(),
            unit: gain.unit.clone(),
            slope,
        });
        gains.push(own.into_iter().collect());
        columns.push(column);
    }
    for figure in &plan.figures {
        reads.push(ElasticRead {
            value: figure.value,
            slope: None,
        });
        gains.push(Vec::new());
        columns.push(figure.as_column(length));
    }
    let wishes = swept.iter().zip(wanted).map(|(target, wanted)| {
        let TargetKind::Elastic(value) = target.of.kind else {
            unreachable!("the target belongs to a study with elastic parts");
        };
        let quantity = reads.iter().position(|read| read.value == value);
        let quantity = quantity.expect("the plan contains the quantities of the targets");
        SweptWish::of(target, wanted, quantity, &stations, &own.suspension.frame)
    });
    let wishes: Vec<Vec<SweptWish>> = wishes.collect();
    let further = read_further(&wishes, curves, [reads.len(), stations.count()]);
    let quantities = ElasticQuantities::of(own, elastic, &stations, reads, &further, rates);
    (
        Request::of_elastic(quantities, stations, columns),
        gains,
        wishes,
    )
}

/// Lists the additional values that a sweep must read, as pairs of value and station. Each target needs its value at its
/// stations. With `curves`, the sweep reads every value at every station. The last argument holds the number of values and
/// the number of stations.
fn read_further(
    wishes: &[Vec<SweptWish>],
    curves: bool,
    [values, stations]: [usize; 2],
) -> Vec<[usize; 2]> {
    if curves {
        let of_value = |value| (0..stations).map(move |station| [value, station]);
        return (0..values).flat_map(of_value).collect();
    }
    let wishes = wishes.iter().flatten();
    wishes.map(|w| [w.quantity, w.station]).collect()
}

/// Returns true if a quantity of an axle is the result of a test (kinematics and compliance).
pub(super) fn is_figure(quantity: &crate::axle::Quantity) -> bool {
    matches!(quantity, crate::axle::Quantity::Figure(_))
}

/// Plans the sweep of an axle. `samples` contains the target values of each target. With `curves`, the sweep also reads test
/// results over the motion.
fn of_axle<'s>(
    both: &'s AxleStudy,
    mut plan: AxlePlan,
    samples: &[Vec<AxleSample>],
    rates: Vec<AxleParameter>,
    curves: bool,
) -> Planned<'s> {
    // Test results come last, because they apply only to the design position.
    sort_by_key(&mut plan.quantities, is_figure);
    let further = samples.iter().flatten().map(|sample| sample.placement);
    let mut stations = AxleStations::of(Cow::Borrowed(&both.axle), &plan, further);
    let mut gains = vec![Vec::new(); stations.quantities.len()];
    for (slope, gain) in stations.gains.iter().enumerate() {
        let same = |q: &crate::axle::Quantity| Some(*q) == gain.quantity();
        let of = stations.quantities.iter().position(same);
        gains[of.expect("a gain of an output that is read")].push(Gain {
            column: gain.name.clone(),
            unit: gain.unit.clone(),
            factor: gain.factor,
            slope,
        });
    }
    let wish = |sample: &AxleSample| {
        let [quantity, station] = stations.place(sample.quantity, sample.placement);
        SweptWish {
            quantity,
            station,
            wanted: sample.wanted,
        }
    };
    let wishes = samples.iter().map(|own| own.iter().map(wish).collect());
    let wishes: Vec<Vec<SweptWish>> = wishes.collect();
    if both.axle.elastic.is_some() {
        let all = [stations.quantities.len(), stations.placements.len()];
        let further = read_further(&wishes, curves, all);
        stations.elastic = Some(ElasticAxleParts { rates, further });
    }
    (Request::of_axle(stations), gains, wishes)
}

/// Plans the outputs of a study and the quantities of its targets. Outputs that are no catalogue quantity, and quantities
/// that are velocities, are left out. For each output, the sweep also computes the first derivative with respect to the
/// drive value.
fn with_gains(own: &WheelStudy, optimise: Option<&Optimise>) -> Plan {
    let plan = Plan::with_targets(own, optimise);
    let is_swept = |quantity: Quantity| !quantity.is_rate();
    let outputs = plan
        .outputs
        .iter()
        .filter(|o| o.quantity().is_some_and(is_swept));
    Plan {
        time: None,
        loads: Vec::new(),
        outputs: outputs
            .map(|o| Output {
                highest: 1,
                ..o.clone()
            })
            .collect(),
        ..plan
    }
}

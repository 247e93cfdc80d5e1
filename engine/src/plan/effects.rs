//! Optional computations that a study may request ("effects"), each with a switch, a reason and a cost.

use super::Plan;
use crate::characteristics::{Measure, Quantity, Slot};
use crate::model::{RockerId, Spring, SteeringAxis};
use crate::solve::has_closed_form;
use crate::study::{Order, Study, TimeLaw};

/// A result that can be computed with a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// Name of the effect.
    pub name: &'static str,
    /// True if the effect is computed.
    pub on: bool,
    /// Description of the computation; empty if the effect is off.
    pub what: String,
    /// Setting in the study that turned the effect on; empty if the effect is off.
    pub because: String,
    /// Estimated cost relative to the position alone: 0.5 makes a run 1.5 times as long. Zero if the effect is off. The costs
    /// of sensitivities and rockers grow with the number of derivatives; otherwise effects do not influence each other's cost.
    pub cost: f64,
}

/// Costs of effects (optional results, such as camber gain or forces) per pose. The unit is the cost of a pose from the
/// closed form of a strut. `hardpoint bench effects` measured the costs. They are accurate to a factor of two only, because
/// they depend on the machine and the topology.
mod cost {
    /// Iterative solution of the six closure equations of the wheel in place of the closed form.
    pub(super) const ITERATED_POSE: f64 = 7.0;
    /// Factorisation of the Jacobian of a pose from the closed form.
    pub(super) const FACTORS: f64 = 0.8;
    /// First, second and third coefficient of the power series of a pose, together with the outputs that use this
    /// coefficient.
    pub(super) const DERIVATIVES: [f64; 3] = [0.5, 2.1, 3.0];
    /// Gradient of one output with respect to all hardpoints, for each coefficient of the output's power series.
    pub(super) const GRADIENT: f64 = 2.2;
    /// Gradient of one output with respect to hardpoints that occur in only one of the six closure equations. The cost
    /// rises from this value to `GRADIENT` with the share of requested hardpoints.
    pub(super) const LEAST_GRADIENT: f64 = 1.2;
    /// Computation of the instantaneous steering axis.
    pub(super) const SCREW_AXIS: f64 = 0.6;
    /// Rotation of a rocker, for each coefficient of its power series. Estimated from its number of operations, not
    /// measured.
    pub(super) const ROCKER: f64 = 0.1;
    /// Factorisation of the equations of a pose, including the support of the loads (the spring or a vertical force at the
    /// wheel centre).
    pub(super) const BALANCE: f64 = 0.8;
    /// One load and its forces in the links.
    pub(super) const LOAD: f64 = 0.3;
    /// Certification of the pose, and of the step to the pose, in interval arithmetic.
    pub(super) const CERTIFICATE: f64 = 1000.0;
}

impl Effect {
    /// Makes an effect with its description, reason and cost. The effect is off if `found` is `None`.
    fn of(name: &'static str, found: Option<(String, String, f64)>) -> Effect {
        let on = found.is_some();
        let (what, because, cost) = found.unwrap_or_default();
        Effect {
            name,
            on,
            what,
            because,
            cost,
        }
    }
}

/// Appends a line number to `text`: the line of the study that contains the key at `path`.
fn written(study: &Study, path: &[&str], text: &str) -> String {
    match study.line_of(path) {
        Some(line) => format!("{text} (line {line})"),
        None => text.to_owned(),
    }
}

impl Plan {
    /// All effects that the program offers. Each effect comes after the effects on which it builds. `study` is the study of
    /// the plan.
    pub fn effects(&self, study: &Study) -> Vec<Effect> {
        let written = |path: &[&str], text: &str| written(study, path, text);
        let mechanism = &study.wheel().mechanism;
        let position = (
            format!("{} poses", self.stations()),
            written(&["motion"], "[motion]"),
            1.0,
        );
        let rack = || {
            (
                format!("{} displacements", self.racks.len()),
                written(&["motion", "rack"], "motion.rack"),
                self.racks.len() as f64 - 1.0,
            )
        };
        let time = |law: &TimeLaw| {
            (
                format!("{} times", law.times.len()),
                written(&["motion", "time"], "motion.time"),
                0.0,
            )
        };
        let mut effects = vec![
            Effect::of("position", Some(position)),
            Effect::of("rack", self.rack_moves.then(rack)),
            Effect::of("time", self.time.as_ref().map(time)),
        ];
        effects.extend(self.derivatives(study));
        effects.push(Effect::of("sensitivities", self.gradients(study)));

        let reasons = |reads: &dyn Fn(Slot) -> bool| {
            let names = self.outputs.iter().filter_map(|o| {
                let used = o.of.reads().iter().any(|slot| reads(*slot));
                used.then_some(o.name.as_str())
            });
            let names = names.collect::<Vec<_>>().join(", ");
            let because = written(&["outputs", "characteristics"], &names);
            (!names.is_empty()).then_some(because)
        };
        let steering_axis = reasons(&Slot::is_of_steering_axis).map(|because| {
            let (what, cost) = match mechanism.steering_axis {
                Some(SteeringAxis::Instantaneous) => (
                    "from the velocities under a movement of the rack",
                    cost::SCREW_AXIS,
                ),
                _ => ("through two joints", 0.0),
            };
            (what.to_owned(), because, cost)
        });
        effects.push(Effect::of("steering axis", steering_axis));
        let is_spring = |slot: Slot| {
            matches!(
                slot,
                Slot::Spring | Slot::SpringLength | Slot::SpringLengthRate
            )
        };
        let spring = reasons(&is_spring).map(|because| ("its ends".to_owned(), because, 0.0));
        effects.push(Effect::of("spring", spring));
        let rockers = [
            ("rocker", mechanism.spring_rocker()),
            ("anti-roll bar", mechanism.anti_roll_bar()),
        ];
        let rocker =
            |(name, id): (_, Option<_>)| Effect::of(name, id.and_then(|id| self.rocker(study, id)));
        effects.extend(rockers.map(rocker));
        effects.push(Effect::of("loads", self.load_forces(study)));
        effects.push(Effect::of("certificate", self.certificate(study)));
        // The costs so far are relative to a pose from the closed form of a strut. They are divided by the relative cost of
        // a pose of this topology, which has no closed form.
        if !has_closed_form(mechanism) {
            let per_pose = |e: &&mut Effect| e.name != "position" && e.name != "rack";
            for effect in effects.iter_mut().filter(per_pose) {
                effect.cost /= cost::ITERATED_POSE;
            }
        }
        effects
    }

    /// Description and cost of the forces under the plan's loads, and the setting in the study that requests them. The cost is
    /// relative to the position alone. `None` without loads.
    fn load_forces(&self, study: &Study) -> Option<(String, String, f64)> {
        if self.loads.is_empty() {
            return None;
        }
        let names: Vec<_> = self.loads.iter().map(|load| load.name.as_str()).collect();
        let support = match study.wheel().mechanism.spring {
            Some(_) => "the spring",
            None => "a vertical force at the wheel centre",
        };
        Some((
            format!(
                "{}: forces in links and joints, supported by {support}",
                names.join(", ")
            ),
            written(study, &["outputs", "loads"], "outputs.loads"),
            cost::BALANCE + cost::LOAD * self.loads.len() as f64,
        ))
    }

    /// Description, reason and cost of the certificate (proof of each pose in interval arithmetic). `None` if the study
    /// does not request it.
    fn certificate(&self, study: &Study) -> Option<(String, String, f64)> {
        self.certify.then(|| {
            (
                "certificate for every pose, and proof that all poses are on one branch".to_owned(),
                written(study, &["outputs", "certify"], "outputs.certify"),
                cost::CERTIFICATE,
            )
        })
    }

    /// Description, reason and cost of a rocker (of the spring or the anti-roll bar). `None` unless a requested quantity depends
    /// on it, or its spring carries requested loads.
    fn rocker(&self, study: &Study, id: RockerId) -> Option<(String, String, f64)> {
        let mechanism = &study.wheel().mechanism;
        let moves = |direct: &RockerId| {
            let outer = mechanism.rocker(*direct).outer;
            *direct == id || mechanism.rockers_moving(outer).any(|r| r == id)
        };
        let outputs = self.outputs.iter();
        let moved = outputs.filter(|o| o.of.rockers(mechanism).iter().any(moves));
        let mut names: Vec<_> = moved
            .map(|o| match o.quantity() {
                Some(Quantity::Coordinate(point, _)) => mechanism.name(point),
                _ => &o.name,
            })
            .collect();
        names.dedup();
        let holds = |spring: Spring| mechanism.rockers_moving(spring.lower).any(|r| r == id);
        if !self.loads.is_empty() && mechanism.spring.is_some_and(holds) {
            names.push("loads");
        }
        // The stated reason is the key that requests the first output that depends on the rocker.
        let first = self
            .outputs
            .iter()
            .find(|o| o.of.rockers(mechanism).iter().any(moves));
        let path: &[&str] = match first.map(|o| o.quantity()) {
            Some(Some(Quantity::Coordinate(..))) => &["outputs", "points"],
            Some(Some(Quantity::Characteristic(_))) => &["outputs", "characteristics"],
            Some(_) => &["outputs"],
            None => &["outputs", "loads"],
        };
        if names.is_empty() {
            return None;
        }
        let rocker = mechanism.rocker(id);
        let what = format!(
            "turned by the {} on the {}",
            rocker.rod,
            mechanism.seat(&rocker)
        );
        let because = written(study, path, &names.join(", "));
        Some((what, because, cost::ROCKER * self.coefficients as f64))
    }

    /// Effects for the first, second and third derivative of a pose with respect to the drive. An effect is off if no
    /// output needs the derivative.
    fn derivatives(&self, study: &Study) -> [Effect; 3] {
        let order = study
            .one_wheel()
            .map_or(Order::Position, |own| own.outputs.order);
        let names = ["rates", "curvature", "third derivatives"];
        std::array::from_fn(|k| {
            let derivative = k + 1;
            let found = (self.coefficients > derivative).then(|| {
                let because = if order as usize >= derivative {
                    let key = format!("outputs.order = \"{}\"", order.name());
                    written(study, &["outputs", "order"], &key)
                } else {
                    // A quantity that contains velocities needs derivatives of one order more than the reported order.
                    let of_velocities = self
                        .outputs
                        .iter()
                        .filter(|o| o.of.rate_order() > 0 && o.highest + 1 >= derivative)
                        .map(|o| o.name.as_str());
                    let names = of_velocities.collect::<Vec<_>>().join(", ");
                    let names = match order {
                        Order::Position => names,
                        _ => format!("{names} with order \"{}\"", order.name()),
                    };
                    written(study, &["outputs", "characteristics"], &names)
                };
                let one = format!("derivative {derivative} in each pose");
                (one, because, cost::DERIVATIVES[k])
            });
            Effect::of(names[k], found)
        })
    }

    /// Description, reason and cost of the gradients with respect to hardpoints, if any are requested.
    fn gradients(&self, study: &Study) -> Option<(String, String, f64)> {
        if self.sensitivities.is_empty() {
            return None;
        }
        let mechanism = &study.wheel().mechanism;
        let points: Vec<_> = self
            .sensitivities
            .iter()
            .map(|id| mechanism.name(*id))
            .collect();
        let outputs: Vec<_> = self.outputs.iter().map(|o| o.name.as_str()).collect();
        let passes: usize = self.outputs.iter().map(|o| self.adjoints(&o.of)).sum();
        let share = (points.len() as f64 / mechanism.points.len() as f64).min(1.0);
        let each = cost::LEAST_GRADIENT + (cost::GRADIENT - cost::LEAST_GRADIENT) * share;
        // Without a closed form, Newton's method has already factorised the Jacobian.
        let factors = if has_closed_form(mechanism) {
            cost::FACTORS
        } else {
            0.0
        };
        let what = format!(
            "of {} with respect to {} ({} coordinates)",
            outputs.join(", "),
            points.join(", "),
            3 * points.len()
        );
        let because = written(
            study,
            &["outputs", "sensitivities"],
            "outputs.sensitivities",
        );
        Some((
            what,
            because,
            factors + each * (passes * self.coefficients) as f64,
        ))
    }

    /// Number of adjoint passes (backward solutions) for the gradients of an output. A quantity that contains velocities
    /// needs one for each derivative of the pose.
    fn adjoints(&self, measure: &Measure) -> usize {
        match measure.rate_order() {
            0 => 1,
            _ => self.coefficients - 1,
        }
    }
}

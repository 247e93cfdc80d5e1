//! Second formulation of a sample axle: its bodies, elastic parts, constraints and loads in vehicle coordinates.

use super::world::{Constraint, Energy, Freedom, GROUND, Load, On, World};
use super::{Case, mirrored};
use crate::support::larger;
use hardpoint::axle::Law;
use hardpoint::compliance::{
    AxialStiffness, AxleEquilibrium, BushingPart, ElasticAxle, Shape, WheelFigures, WheelLoads,
};
use hardpoint::derive::DesignedSpinAxis;
use hardpoint::model::{Body, Constraint as Rigid, PointId, Side};
use hardpoint::number::Vector3;
use std::collections::HashMap;

/// Second formulation of an axle, with the indices of its bodies.
pub(super) struct Built {
    pub world: World,
    pub carriers: [usize; 2],
    subframe: usize,
    rack: Option<usize>,
    levers: [usize; 2],
}

impl Built {
    /// Returns the indices of the bodies, with an empty world.
    pub fn numbers(&self) -> Built {
        Built {
            world: World::new(),
            ..*self
        }
    }
}

/// Adds the parts of one side to the second formulation.
struct Builder<'c> {
    case: &'c Case,
    world: World,
    side: usize,
    subframe: usize,
    rack: Option<usize>,
    carrier: usize,
}

impl Builder<'_> {
    fn true_side(&self, v: Vector3<f64>) -> Vector3<f64> {
        if self.side == 0 { v } else { mirrored(v) }
    }

    fn at(&self, id: PointId) -> Vector3<f64> {
        self.true_side(self.case.suspension.design[id.0])
    }

    fn holder(&self, id: PointId) -> usize {
        let subframe = self.case.parts.subframe.as_ref();
        let is_held = subframe.is_some_and(|s| s.carries.contains(&id));
        match self.case.suspension.mechanism.body(id) {
            Body::Rack => self.rack.unwrap(),
            _ if is_held => self.subframe,
            _ => GROUND,
        }
    }

    fn bushing(
        &mut self,
        i: usize,
        j: usize,
        point: Vector3<f64>,
        along: Vector3<f64>,
        part: &[Shape; 6],
    ) {
        let x = along.normalised();
        let up = Vector3::new(0.0, 0.0, 1.0);
        let z = (up - x * x.dot(up)).normalised();
        let mut rates = [0.0; 6];
        let mut bent = [0.0; 3];
        for (k, shape) in part.iter().enumerate() {
            let Shape::Cubic { rate, cubic } = shape else {
                panic!()
            };
            rates[k] = *rate;
            if k < 3 {
                bent[k] = *cubic;
            }
        }
        self.world.energies.push(Energy::Bushing(
            i,
            j,
            point,
            [x, z.cross(x), z],
            rates,
            bent,
        ));
    }

    fn part(&self, id: PointId) -> Option<BushingPart> {
        let parts = &self.case.parts.wheels[self.side].bushings;
        parts.iter().find(|part| part.point == id).cloned()
    }

    /// Adds the parts of the wheel. Returns the indices of the bodies of the wheel carrier and of the lever of the bar.
    fn wheel(&mut self) -> [usize; 2] {
        let mechanism = self.case.suspension.mechanism.clone();
        self.carrier = self.world.body(Freedom::Free, self.at(mechanism.origin));
        let mut bodies = HashMap::new();
        for (k, arm) in mechanism.arms.iter().enumerate() {
            if self.part(arm.front).is_none() {
                continue;
            }
            let body = self.world.body(Freedom::Free, self.at(arm.outer));
            bodies.insert(k, body);
            let joint = self.at(arm.outer);
            let ends = (On(body, joint), On(self.carrier, joint));
            self.world
                .constraints
                .push(Constraint::Ball(ends.0, ends.1));
            let along = self.at(arm.front) - self.at(arm.rear);
            for id in [arm.front, arm.rear] {
                let part = self.part(id).unwrap();
                self.bushing(self.holder(id), body, self.at(id), along, &part.shapes);
            }
        }
        for constraint in &mechanism.constraints {
            let Rigid::Link { inner, outer } = *constraint else {
                panic!()
            };
            let of_arm = |k: &usize| mechanism.arms[*k].outer == outer;
            if !bodies.keys().any(of_arm) {
                self.link(inner, outer);
            }
        }
        self.spring(&bodies);
        [self.carrier, self.lever(&bodies)]
    }

    fn link(&mut self, inner: PointId, outer: PointId) {
        let (a, b) = (self.at(inner), self.at(outer));
        let ends = (On(self.holder(inner), a), On(self.carrier, b));
        match (self.part(inner), self.part(outer)) {
            (Some(first), Some(second)) => {
                let body = self.world.body(Freedom::Free, a);
                self.bushing(ends.0.0, body, a, b - a, &first.shapes);
                self.bushing(self.carrier, body, b, b - a, &second.shapes);
            }
            (None, None) => {
                let links = &self.case.parts.wheels[self.side].links;
                let stiff = links
                    .iter()
                    .find_map(|link| match (link.member, link.stiffness) {
                        (
                            hardpoint::compliance::LinkMember::Rod { inner: i, .. },
                            AxialStiffness::Rate(rate),
                        ) if i == inner => Some(rate),
                        _ => None,
                    });
                match stiff {
                    Some(rate) => self.world.energies.push(Energy::Rod(ends.0, ends.1, rate)),
                    None => self.world.constraints.push(Constraint::Rod(ends.0, ends.1)),
                }
            }
            _ => panic!(),
        }
    }

    fn on(&self, bodies: &HashMap<usize, usize>, id: PointId) -> On {
        let body = match self.case.suspension.mechanism.body(id) {
            Body::Arm(arm) => bodies[&arm.0],
            Body::Knuckle => self.carrier,
            other => panic!("{other:?}"),
        };
        On(body, self.at(id))
    }

    fn spring(&mut self, bodies: &HashMap<usize, usize>) {
        let spring = self.case.suspension.mechanism.spring.unwrap();
        let law = self.case.parts.wheels[self.side].spring.as_ref().unwrap();
        let Law::Linear { force, rate } = law.spring else {
            panic!()
        };
        let upper = On(self.holder(spring.upper), self.at(spring.upper));
        let lower = self.on(bodies, spring.lower);
        self.world
            .energies
            .push(Energy::Spring(upper, lower, force, rate));
    }

    fn lever(&mut self, bodies: &HashMap<usize, usize>) -> usize {
        let mechanism = &self.case.suspension.mechanism;
        let rocker = mechanism.rocker(mechanism.anti_roll_bar().unwrap());
        // Mirroring reverses the sense of a rotation about the mirrored axis.
        let sign = if self.side == 0 { 1.0 } else { -1.0 };
        let axis = (self.at(rocker.second) - self.at(rocker.first)) * sign;
        let holder = self.holder(rocker.first);
        let lever = self.world.body(
            Freedom::About(holder, axis.normalised()),
            self.at(rocker.first),
        );
        let outer = self.on(bodies, rocker.outer);
        let inner = On(lever, self.at(rocker.inner));
        self.world.constraints.push(Constraint::Rod(outer, inner));
        lever
    }
}

/// Makes the second formulation of an axle.
pub(super) fn build(case: &Case, command: f64) -> Built {
    let mut world = World::new();
    let mut subframe = GROUND;
    if let Some(own) = &case.parts.subframe {
        subframe = world.body(Freedom::Free, Vector3::new(-30.0, 0.0, 165.0));
        for mount in &own.mounts {
            for side in [1.0, -1.0] {
                let at = Vector3::new(mount.at.x, side * mount.at.y, mount.at.z);
                let axes = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
                let axes = axes.map(|(x, y, z)| Vector3::new(x, y, z));
                let rates = mount.shapes.each_ref().map(|s| match s {
                    Shape::Cubic { rate, .. } => *rate,
                    Shape::Curve { .. } => panic!(),
                });
                let bent = [0, 1, 2].map(|k: usize| match &mount.shapes[k] {
                    Shape::Cubic { cubic, .. } => *cubic,
                    Shape::Curve { .. } => panic!(),
                });
                world
                    .energies
                    .push(Energy::Bushing(GROUND, subframe, at, axes, rates, bent));
            }
        }
    }
    let mechanism = &case.suspension.mechanism;
    let points = (0..mechanism.points.len()).map(PointId);
    let on_rack: Vec<PointId> = points
        .filter(|id| mechanism.body(*id) == Body::Rack)
        .collect();
    let rack = on_rack.first().map(|id| {
        let held = case
            .parts
            .subframe
            .as_ref()
            .is_some_and(|s| s.carries.contains(id));
        let holder = if held { subframe } else { GROUND };
        let along = Vector3::new(0.0, 1.0, 0.0);
        let reference = world.bodies[holder].reference;
        let rack = world.body(Freedom::Along(holder, along), reference);
        match case.parts.rack_rate {
            Some(rate) => {
                // The deflection of the rack also contains the twist of the steering column, times the rack travel per
                // angle.
                let column = case
                    .parts
                    .column
                    .map_or(0.0, |column| column.rack_per_angle.powi(2) / column.rate);
                let rate = (1.0 / rate + column).recip();
                world.energies.push(Energy::Slide(rack, command, rate));
            }
            None => world.constraints.push(Constraint::Slide(rack, command)),
        }
        rack
    });
    let mut found = Built {
        world,
        carriers: [0; 2],
        subframe,
        rack,
        levers: [0; 2],
    };
    for side in 0..2 {
        let mut builder = Builder {
            case,
            world: found.world,
            side,
            subframe,
            rack,
            carrier: 0,
        };
        [found.carriers[side], found.levers[side]] = builder.wheel();
        found.world = builder.world;
    }
    let [left, right] = found.levers;
    found
        .world
        .energies
        .push(Energy::Bar(left, right, case.parts.bar_rate.unwrap_or(0.0)));
    found
}

/// Axis of the left wheel in the design position, pointing outboard.
fn spin_axis(case: &Case) -> Vector3<f64> {
    let own = &case.suspension;
    DesignedSpinAxis::of(&own.mechanism, &own.design).direction
}

/// Axis of a wheel in vehicle coordinates, pointing outboard.
fn axis(case: &Case, built: &Built, side: usize) -> Vector3<f64> {
    let designed = spin_axis(case);
    let designed = if side == 0 {
        designed
    } else {
        mirrored(designed)
    };
    built.world.direction(built.carriers[side], designed)
}

/// Returns the contact point of a wheel from its centre and its axis.
fn contact(case: &Case, centre: Vector3<f64>, axis: Vector3<f64>) -> Vector3<f64> {
    let up = Vector3::new(0.0, 0.0, 1.0);
    let across = (up - axis * axis.dot(up)).normalised();
    centre - across * case.suspension.wheel_radius.unwrap()
}

/// Returns the loads in a state of the second formulation.
pub(super) fn loads(
    case: &Case,
    built: &Built,
    world: &World,
    given: &[WheelLoads; 2],
) -> Vec<Load> {
    let mut found = Vec::new();
    for (side, given) in given.iter().enumerate() {
        let flip = |v: Vector3<f64>| if side == 0 { v } else { mirrored(v) };
        let carrier = built.carriers[side];
        let designed = spin_axis(case);
        let axis = world.direction(carrier, flip(designed));
        let centre_id = case.suspension.mechanism.wheel_centre;
        let centre = world.position(On(carrier, flip(case.suspension.design[centre_id.0])));
        let contact = contact(case, centre, axis);
        let load = &given;
        let heading = Vector3::new(axis.y, -axis.x, 0.0).normalised();
        let heading = if side == 0 { heading } else { -heading };
        let side_at = contact - heading * load.trail;
        let m = load.moment;
        // Mirroring reverses the sense of a moment.
        let moment = if side == 0 {
            m
        } else {
            Vector3::new(-m.x, m.y, -m.z)
        };
        let mut push = |point, force, moment| {
            found.push(Load {
                body: carrier,
                point,
                force,
                moment,
            });
        };
        let none = Vector3::new(0.0, 0.0, 0.0);
        push(contact, flip(load.contact), none);
        push(centre, flip(load.centre), none);
        push(side_at, flip(Vector3::new(0.0, -load.side, 0.0)), none);
        push(centre, none, moment);
        // The force that holds the height acts at the contact point. The constraint of the second formulation acts at
        // the wheel centre, so a moment is added. The height constraints are the last two.
        let count = world.multipliers.len();
        let held = Vector3::new(0.0, 0.0, -world.multipliers[count - 2 + side]);
        push(centre, none, (contact - centre).cross(held));
    }
    found
}

/// Returns the largest difference between a state and the second formulation: positions divided by 100 mm, and angles in
/// rad. The twist of the anti-roll bar is its torque divided by its rate.
pub(super) fn difference(
    case: &Case,
    built: &Built,
    axle: &ElasticAxle,
    at: &AxleEquilibrium,
) -> f64 {
    let mut worst = 0.0_f64;
    let centre_id = case.suspension.mechanism.wheel_centre;
    for side in Side::ALL {
        let k = side as usize;
        let flip = |v: Vector3<f64>| if k == 0 { v } else { mirrored(v) };
        let figures: WheelFigures = axle.figures(at, side);
        let centre = built.world.position(On(
            built.carriers[k],
            flip(case.suspension.design[centre_id.0]),
        ));
        worst = larger(worst, (centre - flip(figures.centre)).norm() / 100.0);
        let axis = flip(axis(case, built, k));
        worst = larger(worst, (figures.toe - axis.x.atan2(axis.y)).abs());
        worst = larger(worst, (figures.camber + axis.z.asin()).abs());
    }
    if case.parts.subframe.is_some() {
        let reference = axle.subframe(at)[0] + Vector3::new(-30.0, 0.0, 165.0);
        let found = built
            .world
            .position(On(built.subframe, Vector3::new(-30.0, 0.0, 165.0)));
        worst = larger(worst, (found - reference).norm() / 100.0);
    }
    if let Some(rack) = built.rack {
        worst = larger(
            worst,
            (built.world.bodies[rack].slide - axle.rack(at)).abs() / 100.0,
        );
    }
    let twist = axle.bar_torque(at).unwrap() / case.parts.bar_rate.unwrap();
    let [left, right] = built.levers.map(|lever| built.world.bodies[lever].slide);
    worst = larger(worst, (twist.abs() - (left - right).abs()).abs());
    worst
}

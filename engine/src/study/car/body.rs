//! `[car]`: axles, masses, tyres and aerodynamics.

use super::super::suspension::accepted;
use super::*;
use crate::ask::Accepted;
use crate::car::BodyParameter;
use crate::number::Each;

impl Resolver<'_> {
    pub(super) fn axle(&mut self, end: usize) -> Option<Axle> {
        let section = self.file.car.get_ref();
        let place = [&section.front, &section.rear][end].span();
        let name = crate::car::AXLE_NAMES[end];
        let Some(both) = self.axles[end].axle() else {
            let message =
                format!("the {name} study describes one wheel; expected a study with [axle]");
            let error = self.problems.add(place, message);
            error.help("[axle] with right = \"mirrored\" makes it a study of both wheels");
            return None;
        };
        let axle = both.axle.clone();
        let wanted = [AxlePosition::Front, AxlePosition::Rear][end];
        if axle
            .setup
            .position
            .is_some_and(|position| position != wanted)
        {
            let message = format!(
                "the {name} study describes the other axle: its [vehicle] position differs"
            );
            return self.problems.refuse(place, message);
        }
        let rigid = axle.left.mechanism.rigid_axle.as_ref();
        if rigid.is_some_and(|rigid| !rigid.extra_links.is_empty()) {
            let message = format!(
                "the {name} axle has five links. Five rigid links cannot move in roll, and the \
                 links of a car are rigid: expected four links, or three and a Panhard rod"
            );
            return self.problems.refuse(place, message);
        }
        let needed = [
            (Need::WheelRadius, "radius in [wheel]"),
            (Need::Springs, "[spring], [heave_spring] or [heave_bar]"),
            (Need::UnsprungMass, "unsprung_mass in [vehicle]"),
        ];
        for (need, key) in needed {
            if !axle.meets(need) {
                let message = format!("the {name} study does not give {key}, which a car needs");
                return self.problems.refuse(place, message);
            }
        }
        Some(axle)
    }

    pub(super) fn car(&mut self) -> Option<Car> {
        let file = self.file;
        let section = file.car.get_ref();
        let (front, rear) = (self.axle(0), self.axle(1));
        let axles = [front?, rear?];
        let [unit, of_rear] = axles.each_ref().each(|axle| axle.left.length_unit);
        if of_rear != unit {
            let words = |unit: LengthUnit| {
                let (length, force) = (unit.symbol(), unit.force_symbol());
                format!("length_unit = \"{length}\" and force_unit = \"{force}\"")
            };
            let message = format!(
                "the rear study has {}, the front study {}. Both axles of a car need the same units",
                words(of_rear),
                words(unit)
            );
            return self.problems.refuse(section.rear.span(), message);
        }
        let mass_unit = mass_unit(&section.mass_unit, self.problems)?;
        let rear_offset = self.rear_offset(&axles)?;
        let (masses, mass, cg) = self.masses(mass_unit)?;
        let share = |written: &Option<Number>, problems: &mut Problems| match written {
            Some(share) => accepted(share, "share", Accepted::Share, problems).map(Some),
            None => Some(None),
        };
        let brake_share_front = share(&section.brake_share_front, self.problems)?;
        let drive_share_front = share(&section.drive_share_front, self.problems)?;
        let yaw_inertia = positive(&section.yaw_inertia, self.problems)?;
        let pitch_inertia = positive(&section.pitch_inertia, self.problems)?;
        let points = [
            self.maybe_point(&section.ride_height_point_front)?,
            self.maybe_point(&section.ride_height_point_rear)?,
        ];
        let air = self.air(points)?;
        let tyres = self.tyres(&axles)?;
        let car = Car {
            axles,
            rear_offset,
            masses,
            mass,
            mass_unit,
            cg,
            brake_share_front,
            drive_share_front,
            yaw_inertia,
            pitch_inertia,
            ride_height_points: points,
            tyres,
            air,
            length_unit: unit,
        };
        self.check_masses(&car)?;
        Some(car)
    }

    /// Refuses a mass of the whole car that is not above the unsprung mass of its axles. Also refuses a centre of gravity
    /// below the ground. The centre of gravity of the whole car must also be between the axles. Otherwise one axle would
    /// bear a negative load at rest.
    fn check_masses(&mut self, car: &Car) -> Option<()> {
        let section = self.file.car.get_ref();
        let (mass, cg) = match car.masses {
            Masses::Whole => (section.mass.as_ref(), section.cg.as_ref()),
            Masses::Sprung => (section.sprung_mass.as_ref(), section.sprung_cg.as_ref()),
        };
        let (mass, cg) = (mass?.span.clone(), cg?.span());
        let unit = car.length_unit.symbol();
        let outside = |parameter| {
            let moves = Moves::Body(parameter);
            let accepted = moves.accepted(car);
            let value = moves.value(car)?;
            (!accepted.contains(value)).then_some((accepted, value))
        };
        if let Some((least, _)) = outside(BodyParameter::Mass) {
            let message = format!(
                "expected a mass {least} {}: the mass of the whole car includes the unsprung masses of its axles",
                car.mass_unit.symbol()
            );
            return self.problems.refuse(mass, message);
        }
        if outside(BodyParameter::CgZ).is_some() {
            let message = format!(
                "the centre of gravity is {:.1} {unit} below the ground; does z have the wrong sign?",
                car.ground() - car.cg.z
            );
            return self.problems.refuse(cg, message);
        }
        if outside(BodyParameter::CgX).is_some() {
            let [front, rear] = car.axles_ahead();
            let ahead = car.cg.x - front;
            let message = if ahead >= 0.0 {
                format!(
                    "the centre of gravity is {ahead:.1} {unit} ahead of the front axle, so the rear wheels would lift"
                )
            } else {
                format!(
                    "the centre of gravity is {:.1} {unit} behind the rear axle, so the front wheels would lift",
                    rear - car.cg.x
                )
            };
            return self.problems.refuse(cg, message);
        }
        Some(())
    }

    fn rear_offset(&mut self, axles: &[Axle; 2]) -> Option<Vector3<f64>> {
        let file = self.file;
        let section = file.car.get_ref();
        let mid = |axle: &Axle| axle.mean_wheel_centre().x;
        match (&section.wheelbase, &section.rear_offset) {
            (Some(wheelbase), None) => {
                let length = above_zero(wheelbase, self.problems)?;
                let x = mid(&axles[0]) - length - mid(&axles[1]);
                Some(Vector3::new(x, 0.0, 0.0))
            }
            (None, Some(offset)) => {
                let place = offset.span();
                let offset = self.point(offset)?;
                if mid(&axles[0]) <= mid(&axles[1]) + offset.x {
                    let message = "rear_offset puts the rear axle ahead of the front axle";
                    return self.problems.refuse(place, message);
                }
                Some(offset)
            }
            _ => {
                let message = "expected wheelbase or rear_offset, and only one of them";
                self.problems.refuse(file.car.span(), message)
            }
        }
    }

    pub(super) fn masses(&mut self, unit: MassUnit) -> Option<(Masses, f64, Vector3<f64>)> {
        let file = self.file;
        let section = file.car.get_ref();
        let whole = section.mass.as_ref().zip(section.cg.as_ref());
        let sprung = section.sprung_mass.as_ref().zip(section.sprung_cg.as_ref());
        let count = [
            section.mass.is_some(),
            section.cg.is_some(),
            section.sprung_mass.is_some(),
            section.sprung_cg.is_some(),
        ];
        let (masses, (mass, cg)) = match (whole, sprung, count.iter().filter(|c| **c).count()) {
            (Some(whole), None, 2) => (Masses::Whole, whole),
            (None, Some(sprung), 2) => (Masses::Sprung, sprung),
            _ => {
                let message =
                    "expected mass with cg of the whole car, or sprung_mass with sprung_cg";
                return self.problems.refuse(file.car.span(), message);
            }
        };
        let mass = above_zero(mass, self.problems)? * unit.kilograms();
        Some((masses, mass, self.point(cg)?))
    }

    fn tyres(&mut self, axles: &[Axle; 2]) -> Option<Option<[Tyre; 2]>> {
        let file = self.file;
        let section = file.car.get_ref();
        let names = [("elastic", true), ("rigid", false)];
        let wanted = match &section.tyres {
            Some(text) => Some(choose(text, "kind of tyres", &names, self.problems)?),
            None => None,
        };
        let rates = axles.each_ref().each(|axle| axle.setup.tyre_rate);
        match (wanted, rates) {
            (Some(false), _) | (None, [None, None]) => Some(None),
            (_, [Some(front), Some(rear)]) => {
                let tyre = |end: usize, rate: f64| Tyre {
                    rate,
                    load: axles[end].setup.tyre_load,
                };
                Some(Some([tyre(0, front), tyre(1, rear)]))
            }
            (_, [front, _]) => {
                let (place, name) = match front {
                    None => (section.front.span(), "front"),
                    Some(_) => (section.rear.span(), "rear"),
                };
                let message = match (wanted, rates) {
                    (Some(true), [None, None]) => {
                        "elastic tyres need [tyre] in the front and in the rear study, but neither has it"
                            .to_owned()
                    }
                    _ => format!(
                        "the {name} study has no [tyre]: elastic tyres need it in both axle studies"
                    ),
                };
                let error = self.problems.add(place, message);
                error.help("tyres = \"rigid\" in [car] makes the tyres of both axles rigid");
                None
            }
        }
    }

    fn air(&mut self, points: [Option<Vector3<f64>>; 2]) -> Option<Option<Air>> {
        let file = self.file;
        let Some(section) = &file.car.get_ref().aero else {
            return Some(None);
        };
        let written = section.get_ref();
        let density = match &written.density {
            Some(density) => above_zero(density, self.problems)?,
            None => 1.225,
        };
        let mut downforce = [None; 2];
        for (end, force) in [&written.front, &written.rear].into_iter().enumerate() {
            let Some(force) = force else { continue };
            let list = &force.get_ref().downforce;
            let count = list.get_ref().len();
            if !(1..=6).contains(&count) {
                let message = format!(
                    "expected 1 to 6 coefficients, in the order of the terms 1, hf, hr, \
                             hf2, hf hr, hr2; found {count}"
                );
                return self.problems.refuse(list.span(), message);
            }
            if count > 1 && points.iter().any(Option::is_none) {
                let message = "coefficients of ride heights need ride_height_point_front and ride_height_point_rear in [car]";
                return self.problems.refuse(list.span(), message);
            }
            let mut area = [0.0; 6];
            for (factor, number) in area.iter_mut().zip(list.get_ref()) {
                *factor = number.value;
            }
            let point = self.point(&force.get_ref().point)?;
            downforce[end] = Some(AirForce { point, area });
        }
        let drag = match &written.drag {
            Some(drag) => Some(AirForce {
                point: self.point(&drag.get_ref().point)?,
                area: [drag.get_ref().drag_area.value, 0.0, 0.0, 0.0, 0.0, 0.0],
            }),
            None => None,
        };
        Some(Some(Air {
            density,
            downforce,
            drag,
        }))
    }
}

//! `[[cases]]` and `[gg_map]`.

use super::*;
use crate::ask::Accepted;
use crate::car::Setting;
use crate::number::Each;
use crate::study::motion::range;

impl Resolver<'_> {
    pub(super) fn cases(&mut self, car: &Car) -> Option<Vec<Case>> {
        let mut rest = Case::at_rest("static");
        rest.setting.elastic_tyres = car.tyres.is_some();
        let mut cases = vec![rest];
        let mut sound = true;
        for written in &self.file.cases {
            match self.case(car, written.get_ref()) {
                Some(case) if cases.iter().any(|known| known.name == case.name) => {
                    let place = written.get_ref().name.span();
                    let message = format!("{:?} is the name of another case", case.name);
                    self.problems.add(place, message);
                    sound = false;
                }
                Some(case) => cases.push(case),
                None => sound = false,
            }
        }
        sound.then_some(cases)
    }

    fn case(&mut self, car: &Car, written: &car_file::Case) -> Option<Case> {
        let name = written.name.get_ref();
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        if name.is_empty() || !name.chars().all(plain) || RESERVED.contains(&name.as_str()) {
            let message = format!(
                "expected a name of lower-case letters, digits and _, other than front, rear, left, right and static; found {name:?}"
            );
            return self.problems.refuse(written.name.span(), message);
        }
        let figure = |number: &Option<Number>| number.as_ref().map_or(0.0, |n| n.value);
        let mut case = Case::at_rest(name);
        (case.ax, case.ay) = (figure(&written.ax), figure(&written.ay));
        case.az = figure(&written.az);
        case.speed = self.speed(&written.speed)?;
        case.yaw_acceleration = figure(&written.yaw_acceleration);
        if let (Some(number), None) = (&written.yaw_acceleration, car.yaw_inertia) {
            let message = "yaw_acceleration needs yaw_inertia in [car]";
            return self.problems.refuse(number.span.clone(), message);
        }
        case.racks = self.racks(car, [&written.rack, &written.rack_rear])?;
        if let Some(angle) = &written.steering_wheel_angle {
            if let Some(rack) = &written.rack {
                let message = "steering_wheel_angle already gives the rack displacement";
                return self.problems.refuse(rack.span.clone(), message);
            }
            let Some(per_turn) = car.axles[0].setup.c_factor else {
                let message = match car.axles[0].left.mechanism.axle_steering() {
                    Some(_) => {
                        "a drag link steers the front axle, and no ratio relates the drag link to a steering wheel; expected the key \"rack\": the displacement of the drag link's end"
                    }
                    None => "steering_wheel_angle needs c_factor in [steering] of the front study",
                };
                return self.problems.refuse(angle.span.clone(), message);
            };
            case.racks[0] = per_turn * angle.value / 360.0;
        }
        case.setting = self.setting(car, written, case.ax)?;
        let place = written.name.span();
        self.share_is_given(car, case.setting.longitudinal, place)?;
        Some(case)
    }

    /// Reads a speed in m/s. 0 if the study does not give it.
    fn speed(&mut self, written: &Option<Number>) -> Option<f64> {
        let Some(number) = written else {
            return Some(0.0);
        };
        if number.value < 0.0 {
            let message = format!("expected a speed of 0 or more, found {}", number.value);
            return self.problems.refuse(number.span.clone(), message);
        }
        Some(number.value)
    }

    /// Reads the displacements of the racks, [front, rear], and converts them to the kernel's frame (+y to the left). It
    /// refuses a displacement of an axle that is not steered.
    fn racks(&mut self, car: &Car, written: [&Option<Number>; 2]) -> Option<[f64; 2]> {
        for (axle, rack) in written.into_iter().enumerate() {
            let moved = rack.as_ref().filter(|rack| rack.value != 0.0);
            if let Some(rack) = moved
                && !car.axles[axle].left.mechanism.is_steered()
            {
                let message = format!("the {} axle is not steered", crate::car::AXLE_NAMES[axle]);
                return self.problems.refuse(rack.span.clone(), message);
            }
        }
        let side = self.frame().sign(Axis::Y);
        Some(written.each(|rack| side * rack.as_ref().map_or(0.0, |rack| rack.value)))
    }

    /// Settings of a load case with the longitudinal acceleration `ax`, such as kind of longitudinal force and of tyres.
    fn setting(&mut self, car: &Car, written: &car_file::Case, ax: f64) -> Option<Setting> {
        let mut setting = Case::at_rest("").setting;
        let kinds = [
            ("brake", Longitudinal::Brake),
            ("drive", Longitudinal::Drive),
        ];
        let default = if ax < 0.0 {
            Longitudinal::Brake
        } else {
            Longitudinal::Drive
        };
        setting.longitudinal = choose_or(
            &written.longitudinal,
            default,
            "longitudinal force",
            &kinds,
            self.problems,
        )?;
        setting.lateral_shares = lateral_shares(
            &written.lateral_shares,
            LateralShares::ByLoad,
            self.problems,
        )?;
        if let Some(list) = &written.lateral_share_left {
            let numbers = list.get_ref();
            let outside = |n: &&Number| !Accepted::Share.contains(n.value);
            if let Some(share) = numbers.iter().find(outside) {
                let message = format!("expected shares from 0 to 1, found {}", share.value);
                return self.problems.refuse(share.span.clone(), message);
            }
            let shares: Vec<f64> = numbers.iter().map(|n| n.value).collect();
            setting.lateral_shares = match (shares.as_slice(), &written.lateral_shares) {
                ([front, rear], None) => LateralShares::Left([*front, *rear]),
                _ => {
                    let message = "expected two shares [front, rear] of the left wheels, without lateral_shares";
                    return self.problems.refuse(list.span(), message);
                }
            };
        }
        let equal = LongitudinalShares::Equal;
        setting.longitudinal_shares =
            longitudinal_shares(&written.longitudinal_shares, equal, self.problems)?;
        let axes = [("wheel", TyreAxes::Wheel), ("road", TyreAxes::Road)];
        setting.tyre_axes = choose_or(
            &written.tyre_axes,
            TyreAxes::Wheel,
            "tyre axes",
            &axes,
            self.problems,
        )?;
        let tyres = [("elastic", true), ("rigid", false)];
        let default = car.tyres.is_some();
        setting.elastic_tyres = choose_or(
            &written.tyres,
            default,
            "kind of tyres",
            &tyres,
            self.problems,
        )?;
        if let (Some(text), true, None) = (&written.tyres, setting.elastic_tyres, car.tyres) {
            let have_rates = car.axles.iter().all(|axle| axle.setup.tyre_rate.is_some());
            if have_rates {
                let message = "[car] tyres = \"rigid\" makes the tyres of every case rigid";
                let error = self.problems.add(text.span(), message);
                error.help(
                    "remove tyres from [car], and give tyres = \"rigid\" in each case with rigid tyres",
                );
                return None;
            }
            let message = "elastic tyres need [tyre] in both axle studies";
            return self.problems.refuse(text.span(), message);
        }
        Some(setting)
    }

    /// Refuses a case of the study, even without acceleration, if the distribution of longitudinal forces between the axles is
    /// missing. The case `static` needs no distribution.
    fn share_is_given(
        &mut self,
        car: &Car,
        longitudinal: Longitudinal,
        place: std::ops::Range<usize>,
    ) -> Option<()> {
        let (share, key) = match longitudinal {
            Longitudinal::Brake => (car.brake_share_front, "brake_share_front"),
            Longitudinal::Drive => (car.drive_share_front, "drive_share_front"),
        };
        match share {
            Some(_) => Some(()),
            None => {
                let message = format!("this case needs {key} in [car]");
                let error = self.problems.add(place, message);
                error.help(
                    "even at ax = 0 the wheels need a longitudinal force against drag and the drag of steered tyres",
                );
                None
            }
        }
    }

    pub(super) fn gg_map(&mut self, car: &Car) -> Option<Option<GgMap>> {
        let file = self.file;
        let Some(section) = &file.gg_map else {
            return Some(None);
        };
        let written = section.get_ref();
        let (ax, ay) = (&written.ax, &written.ay);
        let mut values = |written: &toml::Spanned<car_file::Steps>| {
            let car_file::Steps { from, to, steps } = written.get_ref();
            range(from, to, steps, MOST_STATES, self.problems)
        };
        let (ax, ay) = values(ax).zip(values(ay))?;
        let states = ax.len() * ay.len();
        if states > MOST_STATES {
            let message = format!("at most {MOST_STATES} states, found {states}");
            return self.problems.refuse(section.span(), message);
        }
        let mut case = Case::at_rest("gg");
        case.az = written.az.as_ref().map_or(0.0, |az| az.value);
        case.speed = self.speed(&written.speed)?;
        case.racks = self.racks(car, [&written.rack, &None])?;
        case.setting.elastic_tyres = car.tyres.is_some();
        case.setting.lateral_shares = lateral_shares(
            &written.lateral_shares,
            LateralShares::ByLoad,
            self.problems,
        )?;
        let by_load = LongitudinalShares::ByLoad;
        case.setting.longitudinal_shares =
            longitudinal_shares(&written.longitudinal_shares, by_load, self.problems)?;
        let place = section.span();
        if ax.iter().any(|ax| *ax < 0.0) {
            self.share_is_given(car, Longitudinal::Brake, place.clone())?;
        }
        if ax.iter().any(|ax| *ax >= 0.0) {
            self.share_is_given(car, Longitudinal::Drive, place)?;
        }
        Some(Some(GgMap { ax, ay, case }))
    }
}

fn lateral_shares(
    text: &Option<Text>,
    default: LateralShares,
    problems: &mut Problems,
) -> Option<LateralShares> {
    let names = [
        ("by_load", LateralShares::ByLoad),
        ("equal", LateralShares::Equal),
    ];
    choose_or(text, default, "shares", &names, problems)
}

fn longitudinal_shares(
    text: &Option<Text>,
    default: LongitudinalShares,
    problems: &mut Problems,
) -> Option<LongitudinalShares> {
    let names = [
        ("by_load", LongitudinalShares::ByLoad),
        ("equal", LongitudinalShares::Equal),
    ];
    choose_or(text, default, "shares", &names, problems)
}

use hardpoint::kinematics::point_coordinates::*;
use hardpoint::number::Vector3;
use serde_json::Value;
fn num(v: &Value) -> f64 {
    v.as_str()
        .map(|s| s.parse().unwrap())
        .unwrap_or_else(|| v.as_f64().unwrap())
}
fn vec(v: &Value) -> Vector3<f64> {
    Vector3::new(num(&v[0]), num(&v[1]), num(&v[2]))
}
fn load(f: &str) -> Value {
    serde_json::from_str(
        &std::fs::read_to_string(format!(
            "{}/tests/data/reference/{f}.json",
            env!("CARGO_MANIFEST_DIR")
        ))
        .unwrap(),
    )
    .unwrap()
}
fn strut(d: &Value) -> Strut {
    let h = &d["hardpoints"];
    let p = |n: usize| vec(&h[format!("p{n}")]);
    Strut {
        lower_arm_front: p(1),
        lower_arm_rear: p(2),
        tie_rod_inner: p(3),
        strut_top: p(4),
        lower_ball_joint: p(5),
        strut_lower: p(6),
        strut_upper: (d["strut_model"] != "axis46").then(|| p(7)),
        tie_rod_outer: p(8),
        rod_point: Some(p(9)),
        wheel_centre: p(10),
    }
}
fn main_(file: &str, pts: StrutPoints) {
    let d = load(file);
    let mut s = strut(&d);
    if pts == StrutPoints::Study {
        s.strut_upper = Some(vec(&d["hardpoints"]["p7"]));
    }
    for st in d["states"].as_array().unwrap() {
        let kind = st["drive"]["kind"].as_str().unwrap();
        let (drive, value) = match kind {
            "travel" => (Drive::Travel, num(&st["drive"]["value"])),
            "paper_theta" => (Drive::PaperTheta, num(&st["drive"]["value"])),
            _ => (Drive::ArmAngle, num(&st["arm_delta"]["d0"])),
        };
        let m = PointCoordinates::new(&s, pts, drive).unwrap();
        let pose = match m.track(
            &m.design(),
            Station {
                value,
                rack: num(&st["drive"]["rack"]),
            },
        ) {
            Ok(p) => p,
            Err(e) => {
                println!("{kind} {value}: {e}");
                continue;
            }
        };
        let mo = m.motion(&pose, Rates::BY_DRIVE).unwrap();
        let kp: Vec<_> = [6, 7, 8, 10, 11]
            .iter()
            .map(|n| {
                (
                    format!("p{n}"),
                    m.knuckle_point(vec(&d["hardpoints"][format!("p{n}")])),
                )
            })
            .collect();
        let mut e = [0.0_f64; 3];
        for (k, (mv, key)) in [
            (pose.moving(), "positions"),
            (&mo.velocity, "d1"),
            (&mo.acceleration, "d2"),
        ]
        .into_iter()
        .enumerate()
        {
            e[k] = e[k].max((mv[0] - vec(&st[key]["p5"])).norm());
            for (n, p) in &kp {
                e[k] = e[k].max((p.of(mv) - vec(&st[key][n])).norm());
            }
            if pts == StrutPoints::Study {
                e[k] = e[k].max((mv[4] - vec(&st[key]["p9"])).norm());
            }
        }
        let am = m.angular_motion(&pose, &mo);
        let ew = (am.velocity - vec(&st["omega_per_drive"])).norm();
        let ea = (am.acceleration - vec(&st["alpha_per_drive"])).norm();
        println!(
            "{file} {kind} {value} cond {:.3e} pos {:.1e} d1 {:.1e} d2 {:.1e} om {ew:.1e} al {ea:.1e}",
            m.condition(),
            e[0],
            e[1],
            e[2]
        );
    }
}
#[test]
fn probe() {
    for f in [
        "attia-example",
        "angular-velocity-in-plane",
        "strut-points-1mm",
    ] {
        for p in [StrutPoints::Spread, StrutPoints::Study] {
            println!("{p:?}");
            main_(f, p);
        }
    }
}
#[test]
fn speed() {
    let d = load("angular-velocity-in-plane");
    let s = strut(&d);
    let m = PointCoordinates::new(&s, StrutPoints::Spread, Drive::Travel).unwrap();
    for _ in 0..5 {
        let t = std::time::Instant::now();
        let n = 2000;
        let mut acc = 0.0;
        for _ in 0..n {
            let mut p = m.design();
            for i in 0..41 {
                let v = -0.08 + 0.004 * i as f64;
                p = m
                    .track(
                        &p,
                        Station {
                            value: v,
                            rack: 0.0,
                        },
                    )
                    .unwrap();
                acc += p.moving()[0].x;
            }
        }
        println!(
            "{} ns/pose {acc}",
            t.elapsed().as_nanos() as f64 / (41 * n) as f64
        );
    }
}

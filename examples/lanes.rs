use hardpoint::characteristics::*;
use hardpoint::kinematics::*;
use hardpoint::model::Drive;
use hardpoint::number::*;
use hardpoint::study::Study;
use std::ops::ControlFlow;
use std::time::Instant;

struct Sum<'a, B: Bundle> { reader: &'a LaneReader<'a>, lanes: &'a LaneDesign<B>, wheels: &'a LaneWheels<B>, out: &'a mut [f64], n: usize, }
impl<B: Bundle> Visit<B> for Sum<'_, B> {
    #[inline(always)]
    fn pose(&mut self, station: usize, at: &LanePose<B>) {
        let inputs = self.reader.inputs(self.lanes, self.wheels, at);
        for (k, c) in self.reader.characteristics().iter().enumerate() {
            c.evaluate(&inputs).store(&mut self.out[(k * self.n + station) * B::LANES..]);
        }
    }
}
struct Job<'a> { batch: &'a Batch, reader: &'a LaneReader<'a>, designs: &'a [Vector3<f64>], points: usize, stations: usize, out: &'a mut [f64], history: &'a mut [f64], lost: &'a mut usize }
impl InLanes for Job<'_> {
    type Output = ();
    #[inline(always)]
    fn run<B: Bundle>(self, like: B) {
        let n = self.reader.characteristics().len();
        let mut points = vec![Vector3::new(like, like, like); self.points];
        let per = self.points * B::LANES;
        for group in self.designs.chunks_exact(per) {
            let mut buf = [[0.0; 16]; 3];
            for (p, point) in points.iter_mut().enumerate() {
                for lane in 0..B::LANES {
                    let v = group[lane * self.points + p];
                    buf[0][lane] = v.x; buf[1][lane] = v.y; buf[2][lane] = v.z;
                }
                *point = Vector3::new(like.load(&buf[0]), like.load(&buf[1]), like.load(&buf[2]));
            }
            let lanes = self.batch.design(&points);
            let wheels = self.reader.wheels(&lanes, &points);
            let mut sum = Sum { reader: self.reader, lanes: &lanes, wheels: &wheels, out: self.out, n: self.stations };
            let ok = self.batch.solve(&lanes, 0.0, self.history, &mut sum);
            let _ = n;
            for lane in 0..B::LANES { if !B::lane(ok, lane) { *self.lost += 1; } }
        }
    }
}

fn main() {
    let name = std::env::args().nth(1).unwrap_or("studies/macpherson_solve.toml".into());
    let study = Study::read(std::path::Path::new(&name), &[]).unwrap();
    let s = &study.suspension;
    let values: Vec<f64> = (0..41).map(|k| -80.0 + 4.0 * k as f64).collect();
    let march = March::through(&values);
    let scatter: f64 = std::env::args().nth(2).map_or(10.0, |a| a.parse().unwrap());
    let cs: Vec<Characteristic> = std::env::args().nth(3).unwrap_or("camber,toe,kingpin_inclination,caster".into()).split(',').map(|c| Characteristic::named(c).unwrap()).collect();
    let count = 1600;
    let mut state = 12345u64;
    let mut random = || { state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); ((state >> 11) as f64) / (1u64 << 53) as f64 * 2.0 - 1.0 };
    let mut designs = Vec::new();
    for _ in 0..count { for p in &s.design { designs.push(Vector3::new(p.x + scatter * random(), p.y + scatter * random(), p.z + scatter * random())); } }
    let batch = Batch::new(&s.mechanism, &s.design, Drive::Travel, &march).unwrap();
    let reader = LaneReader::new(&s.mechanism, &batch, Constants::of(s), &cs).unwrap();
    let mut out = vec![0.0; cs.len() * 41 * 16];
    let mut history = vec![0.0; batch.history(16)];
    for width in Width::ALL {
        let mut best = f64::INFINITY;
        let mut lost = 0;
        for _ in 0..15 {
            lost = 0;
            let t = Instant::now();
            width.run(Job { batch: &batch, reader: &reader, designs: &designs, points: s.design.len(), stations: 41, out: &mut out, history: &mut history, lost: &mut lost });
            best = best.min(t.elapsed().as_secs_f64());
        }
        println!("{:8} {:.2} ns/pose {:.1} M poses/s lost {lost}", width.name(), best / (count * 41) as f64 * 1e9, (count * 41) as f64 / best / 1e6);
    }
    // scalar path
    let mut solver = Solver::new(&s.mechanism, &s.design).unwrap();
    let mut best = f64::INFINITY;
    let mut failed = 0;
    for _ in 0..3 {
        failed = 0;
        let t = Instant::now();
        for d in designs.chunks_exact(s.design.len()) {
            if solver.prepare(d).is_err() { failed += 1; continue }
            let mut bad = false;
            let _ = solver.march(Drive::Travel, &march, 0.0, |_, _, pose| { bad |= pose.is_err(); ControlFlow::Continue(()) });
            failed += bad as usize;
        }
        best = best.min(t.elapsed().as_secs_f64());
    }
    println!("careful  {:.1} ns/pose, designs with failures {failed}", best / (count * 41) as f64 * 1e9);
}

//! Probe rows that span the range of a rig, to evaluate a formula before any table is read.

use pinswitch_friction::{Substrate, published};

use crate::effects::formula::Moment;
use crate::table::{Condition, Point};

/// A probe row.
pub(super) struct Probe {
    point: Point,
    condition: Condition,
    tension_n: f64,
}

impl Probe {
    pub(super) fn moment(&self) -> Moment<'_> {
        Moment {
            point: &self.point,
            condition: &self.condition,
            load_n: self.point.load_n,
            tension_n: self.tension_n,
        }
    }

    /// Describes the row in an error.
    pub(super) fn description(&self) -> String {
        let p = &self.point;
        format!(
            "at load_n = {}, direction = {}, repetition = {}, speed_pct = {}, dwell_s = {}, position_mm = {}, time_s = {}",
            p.load_n, p.sign, p.repetition, p.speed_pct, p.dwell_s, p.position_mm, p.time_s
        )
    }
}

/// Returns rows of the paper's conditions, over its loads and beyond.
pub(super) fn probes() -> Vec<Probe> {
    let silicone = Some(Substrate::Silicone);
    let conditions = [
        (silicone, Vec::new(), None),
        (Some(Substrate::Abs), vec![5, 8, 11], None),
        (silicone, vec![5, 8, 11], Some(0)),
        (silicone, vec![3, 5, 7, 9, 11, 13], Some(1)),
    ];
    let mut all = Vec::new();
    for (i, load_n) in [0.6, 3.1, 10.0, 30.0, 49.0, 65.0].into_iter().enumerate() {
        for (j, (substrate, pins, device)) in conditions.iter().enumerate() {
            for sign in [-1.0, 1.0] {
                let condition = Condition::new(*substrate, pins, published::WRAP_ANGLE_DEG, *device);
                let first = i == 0 && j == 0;
                let share = (i as f64 + 0.25 * j as f64) / 6.0;
                let repetition = 1.0 + (7 * i + 3 * j) as f64;
                let speed_pct = 40.0 + 6.0 * i as f64;
                let dwell_s = [0.3, 3.0, 10.0, 30.0][j];
                let point = Point {
                    load_n,
                    sign,
                    descending: (i % 2) as f64,
                    speed_pct,
                    log_speed: libm::log(speed_pct / 50.0),
                    dwell_s,
                    log_dwell: libm::log(dwell_s / published::DWELL_S),
                    repetition,
                    position: 0.05 + 0.9 * share,
                    position_mm: (0.05 + 0.9 * share) * published::STROKE_MM,
                    time: 0.001 + 0.99 * share,
                    time_s: 4.5 + 9000.0 * share,
                    travel: share,
                    previous_load_n: if first { load_n } else { 49.0 - 0.7 * load_n },
                    begins_session: first,
                    through: repetition - 1.0,
                    session: 1.0 + (i % 2) as f64,
                    mount: 1.0 + j as f64,
                    operator: 1.0 + (i % 3) as f64,
                    ..Point::default()
                };
                let tension_n = load_n * (1.0 + 0.25 * sign);
                all.push(Probe { point, condition, tension_n });
            }
        }
    }
    all
}

/// Returns rows at which all variables vary independently, to separate the constants of a formula.
pub(super) fn spread_probes() -> Vec<Probe> {
    const COUNT: usize = 600;
    let silicone = Some(Substrate::Silicone);
    let abs = Some(Substrate::Abs);
    let layouts: [(Option<Substrate>, &[u8], Option<usize>); 9] = [
        (silicone, &[], None),
        (abs, &[5, 8, 11], None),
        (silicone, &[8], Some(0)),
        (silicone, &[4, 12], Some(1)),
        (silicone, &[5, 8, 11], Some(2)),
        (silicone, &[4, 5, 11], Some(3)),
        (silicone, &[3, 6, 9, 12], Some(4)),
        (silicone, &[2, 5, 8, 11, 13], Some(5)),
        (silicone, &[3, 5, 7, 9, 11, 13], Some(6)),
    ];
    // Fractional parts of multiples of the roots of primes are independent sequences.
    let share = |i: usize, root: f64| libm::modf(i as f64 * root).0;
    (0..COUNT)
        .map(|i| {
            let (substrate, pins, device) = layouts[i % layouts.len()];
            let pins = pins.iter().map(|p| (*p).into()).collect::<Vec<_>>();
            let condition = Condition::new(substrate, &pins, published::WRAP_ANGLE_DEG, device);
            let along = |prime: f64| share(i + 1, libm::sqrt(prime));
            let (speed_pct, dwell_s) = (20.0 + 70.0 * along(2.0), libm::exp(-1.2 + 4.6 * along(3.0)));
            let (load_n, position, time) = (0.6 + 65.0 * along(5.0), along(7.0), along(11.0));
            let repetition = 1.0 + (60.0 * along(13.0)).floor();
            let sign = if along(17.0) < 0.5 { -1.0 } else { 1.0 };
            let point = Point {
                load_n,
                sign,
                descending: f64::from(u8::from(along(19.0) < 0.5)),
                speed_pct,
                log_speed: libm::log(speed_pct / 50.0),
                dwell_s,
                log_dwell: libm::log(dwell_s / published::DWELL_S),
                repetition,
                position,
                position_mm: position * published::STROKE_MM,
                time,
                time_s: 9000.0 * time,
                travel: along(23.0),
                previous_load_n: 65.0 * along(29.0),
                through: (60.0 * along(31.0)).floor(),
                session: 1.0 + (4.0 * along(37.0)).floor(),
                mount: 1.0 + (9.0 * along(41.0)).floor(),
                operator: 1.0 + (3.0 * along(47.0)).floor(),
                ..Point::default()
            };
            let tension_n = load_n * libm::exp(0.3 * sign * along(43.0));
            Probe { point, condition, tension_n }
        })
        .collect()
}

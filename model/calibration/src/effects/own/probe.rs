//! Rows that span what a rig does, to try a formula on before any table is there.

use pinswitch_friction::{Substrate, published};

use super::variable::Moment;
use crate::table::{Condition, Point};

/// One row.
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

    /// Where it lies, for errors.
    pub(super) fn told(&self) -> String {
        let p = &self.point;
        format!(
            "at load_n = {}, direction = {}, repetition = {}, speed_pct = {}, dwell_s = {}, position_mm = {}, time_s = {}",
            p.load_n, p.sign, p.repetition, p.speed_pct, p.dwell_s, p.position_mm, p.time_s
        )
    }
}

/// Rows of the paper's conditions over its loads and beyond.
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
                    ..Point::default()
                };
                let tension_n = load_n * (1.0 + 0.25 * sign);
                all.push(Probe { point, condition, tension_n });
            }
        }
    }
    all
}

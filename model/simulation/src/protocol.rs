//! Rows of a session, with its settings and times, before the forces are known.

use pinswitch_calibration::table::{Labels, PlateauRow, Sweep, Unknown};
use pinswitch_friction::published;
use pinswitch_friction::{Direction, Substrate};
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::plan::{Plan, Protocol};

/// Time of one move in seconds.
const MOVE_S: f64 = 0.5;

/// Settings of a series.
struct Setting<'a> {
    substrate: Option<Substrate>,
    pins: &'a [usize],
    sweep: Sweep,
    mass_g: f64,
    speed_pct: f64,
    dwell_s: f64,
}

/// Returns the rows of a session with zero forces.
pub(super) fn rows(plan: &Plan, random: &mut ChaCha8Rng) -> Vec<PlateauRow> {
    let mut conditions: Vec<(Option<Substrate>, &[usize])> = Vec::new();
    if plan.silicone {
        conditions.push((Some(Substrate::Silicone), &[]));
    }
    if plan.proxy {
        conditions.extend(plan.layouts.iter().map(|l| (Some(Substrate::Abs), l.as_slice())));
    }
    conditions.extend(plan.layouts.iter().map(|l| (Some(Substrate::Silicone), l.as_slice())));
    let mut session = Vec::new();
    let mut time_s = 0.0;
    if plan.protocol == Protocol::Randomised {
        conditions.shuffle(random);
    }
    if plan.shuffled {
        return shuffled(plan, &conditions, random);
    }
    for (substrate, pins) in conditions {
        let sweeps: &[Sweep] =
            if plan.protocol == Protocol::Paper { &[Sweep::Up] } else { &[Sweep::Up, Sweep::Down] };
        for sweep in sweeps {
            time_s += random.random_range(60.0..450.0);
            let count = plan.weights_g.len();
            for step in 0..count {
                let i = if *sweep == Sweep::Up { step } else { count - 1 - step };
                let pick = |values: &[f64], random: &mut ChaCha8Rng| match plan.protocol {
                    Protocol::Paper => values[i * values.len() / count.max(values.len())],
                    Protocol::Randomised => values[random.random_range(0..values.len())],
                };
                let speed_pct = pick(&plan.speeds_pct, random);
                let dwell_s = match plan.protocol {
                    Protocol::Paper => plan.dwells_s[0],
                    Protocol::Randomised => pick(&plan.dwells_s, random),
                };
                let setting =
                    Setting { substrate, pins, sweep: *sweep, mass_g: plan.weights_g[i], speed_pct, dwell_s };
                series(plan, &setting, &mut time_s, &mut session, random);
                time_s += random.random_range(20.0..45.0);
            }
        }
    }
    session
}

/// Returns the rows of a session with all series in random order.
fn shuffled(
    plan: &Plan,
    conditions: &[(Option<Substrate>, &[usize])],
    random: &mut ChaCha8Rng,
) -> Vec<PlateauRow> {
    let mut settings = Vec::new();
    for (substrate, pins) in conditions {
        for sweep in [Sweep::Up, Sweep::Down] {
            for mass_g in &plan.weights_g {
                let speed_pct = plan.speeds_pct[random.random_range(0..plan.speeds_pct.len())];
                let dwell_s = plan.dwells_s[random.random_range(0..plan.dwells_s.len())];
                let (substrate, mass_g) = (*substrate, *mass_g);
                settings.push(Setting { substrate, pins, sweep, mass_g, speed_pct, dwell_s });
            }
        }
    }
    settings.shuffle(random);
    let (mut session, mut time_s) = (Vec::new(), random.random_range(60.0..450.0));
    for setting in settings {
        series(plan, &setting, &mut time_s, &mut session, random);
        time_s += random.random_range(20.0..45.0);
    }
    session
}

/// Appends the rows of a series: all eccentric repetitions, then all concentric ones.
fn series(
    plan: &Plan,
    setting: &Setting<'_>,
    time_s: &mut f64,
    session: &mut Vec<PlateauRow>,
    random: &mut ChaCha8Rng,
) {
    let name = session.last().map_or(0, |row: &PlateauRow| row.series.parse::<usize>().map_or(0, |n| n + 1));
    for (direction, mean) in
        [(Direction::Eccentric, plan.repetitions[0]), (Direction::Concentric, plan.repetitions[1])]
    {
        let count = mean.saturating_sub(plan.repetitions_spread / 2).max(1)
            + if plan.repetitions_spread > 0 { random.random_range(0..=plan.repetitions_spread) } else { 0 };
        for repetition in 1..=count {
            *time_s += MOVE_S + setting.dwell_s;
            let share = (f64::from(repetition) - 0.5) / f64::from(count);
            let position = match direction {
                Direction::Eccentric => share,
                Direction::Concentric => 1.0 - share,
            };
            session.push(PlateauRow {
                series: name.to_string(),
                substrate: setting.substrate,
                pins: setting.pins.to_vec(),
                sweep: setting.sweep,
                load_mass_g: setting.mass_g,
                load_n: published::load_n(setting.mass_g),
                speed_pct: setting.speed_pct,
                dwell_s: setting.dwell_s,
                direction,
                repetition,
                position_mm: published::STROKE_MM * position,
                time_s: *time_s,
                force_n: 0.0,
                wrap_angle_deg: plan.wrap_angle_deg,
                labels: Labels::default(),
                unknown: Unknown::default(),
            });
        }
    }
}

//! A small session for unit tests: readings of the baseline with seeded noise, for two layouts and
//! bare silicone.

use pinswitch_friction::{Direction, Substrate, published};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::model::{Model, Term};
use crate::table::{Frame, Labels, PlateauRow, Sweep, Unknown};

/// Number of repetitions of each series and direction.
pub(crate) const REPETITIONS: u32 = 9;

/// Returns the rows of a session without effects: ascending and descending loads, varying speed,
/// noise of 0.05 N.
pub(crate) fn session(seed: u64) -> Vec<PlateauRow> {
    session_with(seed, &[])
}

/// Returns the rows of a session with additional terms.
pub(crate) fn session_with(seed: u64, terms: &[(Term, &[f64])]) -> Vec<PlateauRow> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let conditions: [(Option<Substrate>, &[usize]); 5] = [
        (Some(Substrate::Silicone), &[]),
        (Some(Substrate::Abs), &[5, 8, 11]),
        (Some(Substrate::Silicone), &[5, 8, 11]),
        (Some(Substrate::Abs), &[3, 5, 7, 9, 11, 13]),
        (Some(Substrate::Silicone), &[3, 5, 7, 9, 11, 13]),
    ];
    let weights_g = [251.2, 1003.2, 2005.0, 3007.2, 4007.8, 5002.5];
    let (mut rows, mut time_s, mut series) = (Vec::new(), 0.0, 0);
    for (substrate, pins) in conditions {
        for sweep in [Sweep::Up, Sweep::Down] {
            for step in 0..weights_g.len() {
                let load_mass_g =
                    weights_g[if sweep == Sweep::Up { step } else { weights_g.len() - 1 - step }];
                let speed_pct = f64::from(random.random_range(4..=7u8)) * 10.0;
                for direction in [Direction::Eccentric, Direction::Concentric] {
                    for repetition in 1..=REPETITIONS {
                        time_s += 3.5;
                        let share = (f64::from(repetition) - 0.5) / f64::from(REPETITIONS);
                        rows.push(PlateauRow {
                            series: series.to_string(),
                            substrate,
                            pins: pins.to_vec(),
                            sweep,
                            load_mass_g,
                            load_n: published::load_n(load_mass_g),
                            speed_pct,
                            dwell_s: 3.0,
                            direction,
                            repetition,
                            position_mm: 152.4
                                * if direction == Direction::Eccentric { share } else { 1.0 - share },
                            time_s,
                            force_n: 0.0,
                            wrap_angle_deg: published::WRAP_ANGLE_DEG,
                            labels: Labels::default(),
                            unknown: Unknown::default(),
                        });
                    }
                }
                series += 1;
            }
        }
    }
    let frame = Frame::new(&rows);
    let model = terms
        .iter()
        .fold(Model::baseline(frame), |model, (term, values)| model.with_term(term.clone(), values));
    let readings = model.predict(&model.frame.points(&rows).unwrap());
    for (row, reading) in rows.iter_mut().zip(readings) {
        // The sum of twelve uniform variates approximates a normal one.
        let normal = (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        row.force_n = reading + 0.05 * normal;
    }
    rows
}

//! Largest gains on rigs without any effect: what the levels of the selection rest on.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use pinswitch_model::inference::{Levels, Model, Observations, select};
use pinswitch_model::rig::Frame;
use pinswitch_model::simulation::{plan_of, simulate, study_cases};

fn main() {
    let count = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(50);
    for case in study_cases().iter().filter(|c| c.name == "none") {
        let mut gains = Vec::new();
        let mut alarms = Vec::new();
        for seed in 1000..1000 + count {
            let rows = simulate(&plan_of(case, seed)).rows;
            let frame = Frame::new(&rows);
            if let Some(mut data) = Observations::new(&frame, &rows) {
                let found = select(&Model::baseline(frame), &mut data, Levels::default());
                gains.extend(found.candidates.first().map(|c| c.1));
                if !found.augmented.model.terms.is_empty() {
                    alarms.push((seed, found.augmented.model.terms[0].id(), found.structure.map(|s| s.1)));
                }
            }
        }
        gains.sort_by(f64::total_cmp);
        let at = |share: usize| gains.get(gains.len() * share / 100).copied().unwrap_or(f64::NAN);
        println!(
            "{:?}: median {:.1}, 90 % {:.1}, 95 % {:.1}, 98 % {:.1}; alarms {alarms:?}",
            case.protocol,
            at(50),
            at(90),
            at(95),
            at(98)
        );
    }
}

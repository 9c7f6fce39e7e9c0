//! `cargo run --release -p pinswitch-model --example study -- FIRST LAST [NAME]`: the confusion matrix of the calibrator.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use pinswitch_model::inference::Levels;
use pinswitch_model::simulation::{Study, run_case, study_cases};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: u64| arguments.get(i).and_then(|a| a.parse().ok()).unwrap_or(default);
    let (first, last) = (number(0, 1), number(1, 20));
    let mut study = Study::default();
    for case in study_cases() {
        if arguments.get(2).is_some_and(|wanted| !case.name.contains(wanted.as_str())) {
            continue;
        }
        for seed in first..=last {
            study.add(&case, run_case(&case, seed, Levels::default()));
        }
    }
    print!("{}", study.table());
}

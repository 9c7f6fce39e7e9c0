//! `cargo run --release -p pinswitch-model --example study -- FIRST LAST [NAME]`: the confusion matrix of the calibrator.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use pinswitch_model::inference::Levels;
use pinswitch_model::simulation::{Study, Truth, run_case, study_cases};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: u64| arguments.get(i).and_then(|a| a.parse().ok()).unwrap_or(default);
    let (first, last) = (number(0, 1), number(1, 20));
    let verbose = std::env::var_os("STUDY_VERBOSE").is_some();
    let mut study = Study::default();
    for case in study_cases() {
        if arguments.get(2).is_some_and(|wanted| !case.name.contains(wanted.as_str())) {
            continue;
        }
        let count = last + 1 - first;
        let count = if case.truth == Truth::Nothing { (10 * count).div_ceil(4) } else { count };
        let mut outcomes = Vec::new();
        for seed in first..first + count {
            let Some(outcome) = run_case(&case, seed, Levels::default()) else { continue };
            if verbose && (!outcome.exact || case.truth == Truth::Nothing) {
                let plan = pinswitch_model::simulation::plan_of(&case, seed);
                eprintln!(
                    "{:?} {} seed {seed}: {:?} gain {:.1} p {:.3} structure {:.1} aside {} truth {:?} {:?}",
                    case.protocol,
                    case.name,
                    outcome.named,
                    outcome.largest_gain,
                    outcome.p_value,
                    outcome.structure_gain,
                    outcome.aside,
                    plan.effects,
                    plan.disturbances
                );
            }
            outcomes.push(outcome);
        }
        study.add(case, outcomes);
    }
    print!("{}\n{}", study.table(), study.summary());
}

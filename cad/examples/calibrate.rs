//! Calibrates a plateau table: which effects does the rig have in addition to the paper's model?
//!
//! The table is simulated in memory, with an effect that the calibrator has to detect. For a
//! measured table, use `PlateauTable::read` with its file.
//!
//! `cargo run --release --example calibrate`

use pinswitch::calibration::calibrate;
use pinswitch::calibration::effects::Vocabulary;
use pinswitch::calibration::table::PlateauTable;
use pinswitch::simulation::{EffectPlan, Plan, simulate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A session with noise, and an offset of the load cell of 0.8 N.
    let mut plan = Plan { seed: 3, ..Plan::randomised() };
    plan.effects.push(EffectPlan { id: "load_cell_offset".to_owned(), values: vec![0.8], form: 0 });
    let csv = PlateauTable::write(&simulate(&plan).rows);

    let table = PlateauTable::read(csv.as_bytes(), "plateaus.csv")?;
    let calibration = calibrate(&table.rows, &Vocabulary::built_in(), 1)?;
    let report = &calibration.report;
    println!("{} rows in {} series", report.data.rows, report.data.series);
    println!("verdict: {:?}", report.verdict);
    println!(
        "held-out error: {:.3} N before, {:.3} N after (noise {:.3} N)",
        report.baseline.heldout_rmse_n, report.augmented.heldout_rmse_n, report.noise_floor_n
    );
    if let Some(error) = report.expected_error_n {
        println!(
            "expected error of a new session: {:.3} N [{:.3}, {:.3}]",
            error.value, error.ci90[0], error.ci90[1]
        );
    }
    for effect in &report.effects {
        println!("{} with probability {:.4}: {}", effect.id, effect.probability, effect.formula);
        for (name, estimate) in &effect.parameters {
            let [low, high] = estimate.ci95;
            println!("  {name} = {:.4} [{low:.4}, {high:.4}] {}", estimate.value, estimate.unit);
        }
        for rival in &effect.rivals {
            println!("  or {} with probability {:.4}: {}", rival.id, rival.probability, rival.experiment);
        }
    }
    for blind in &report.invisible {
        println!("invisible in this session: {} ({})", blind.id, blind.why);
    }
    Ok(())
}

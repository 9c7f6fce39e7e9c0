//! Calibrates a measured plateau table, and predicts a second table of the same rig.
//!
//! `cargo run --release -p pinswitch-calibration --example evidence -- TABLE.csv [NEXT.csv]`

use std::fs::File;
use std::time::Instant;

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::evidence::Session;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{ModelFile, calibrate};

/// Seed of the interval of the expected error.
const SEED: u64 = 1;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let Some(path) = paths.first() else { return Err("usage: evidence TABLE.csv [NEXT.csv]".into()) };
    let table = PlateauTable::read(File::open(path)?, path)?;
    let start = Instant::now();
    let found = calibrate(&table.rows, &Vocabulary::built_in(), SEED)?;
    let seconds = start.elapsed().as_secs_f64();
    let report = &found.report;
    println!("{path}: {}{}", report.verdict.as_str(), if report.adequate { "" } else { ", inadequate" });
    for effect in &report.effects {
        let rivals: Vec<String> =
            effect.rivals.iter().map(|r| format!("{} {:.2}", r.id, r.probability)).collect();
        println!(
            "  {} ({}) P = {:.3}, odds {:.3e}, rivals [{}]",
            effect.id,
            effect.covariate,
            effect.probability,
            effect.odds,
            rivals.join(", ")
        );
        for (name, estimate) in &effect.parameters {
            println!("    {name} = {:.4} {:?}", estimate.value, estimate.ci95);
        }
        if let Some(form) = &effect.form {
            println!(
                "    form: {} on {} explains {:.2} in model {} {:?} heldout {:.4}",
                form.shape,
                form.channel,
                form.explains,
                form.in_model,
                form.parameters.iter().map(|(k, v)| (k, v.value)).collect::<Vec<_>>(),
                form.heldout_rmse_n
            );
        }
    }
    for (name, estimate) in &report.augmented.parameters {
        println!("  {name} = {:.4} {:?}", estimate.value, estimate.ci95);
    }
    report.changes.iter().for_each(|change| println!("  {}", change.words()));
    report.bad_series.iter().for_each(|bad| println!("  bad: {} {:.3} N", bad.place(), bad.offset_n));
    let open: Vec<&str> = report.limits.iter().filter(|l| !l.excluded).map(|l| l.id.as_str()).collect();
    println!("  not excluded: {}", open.join(", "));
    println!(
        "  held out: baseline {:.3}, least squares {:?}, model {:.3} (series {:.3}); expected {:?}; noise {:.3}",
        report.baseline.heldout_rmse_n,
        report.least_squares_n,
        report.augmented.heldout_rmse_n,
        report.augmented.heldout_series_rmse_n,
        report.expected_error_n,
        report.noise_floor_n
    );
    if let Some(path) = paths.get(1) {
        let next = PlateauTable::read(File::open(path)?, path)?;
        for (name, fitted) in [("baseline", &found.baseline), ("model", &found.augmented)] {
            let file = ModelFile::parse(&ModelFile::new(fitted).to_text()?, "model.toml")?;
            let error = |session| -> Result<f64, Box<dyn std::error::Error>> {
                let (predicted, _) = file.predict(&next.rows, session, "model.toml")?;
                let squares = predicted.iter().zip(&next.rows).map(|(p, row)| (p - row.force_n).powi(2));
                Ok((squares.sum::<f64>() / next.rows.len() as f64).sqrt())
            };
            let (new, fitted) = (error(Session::New)?, error(Session::Fitted)?);
            println!(
                "  second table by {name}: {new:.3} N as a new session, {fitted:.3} N as the fitted one"
            );
        }
    }
    println!("  {seconds:.2} s");
    Ok(())
}

//! Infers the effects of a measured plateau table by one evidence, and predicts a second table.
//!
//! `cargo run --release -p pinswitch-calibration --example evidence -- TABLE.csv [NEXT.csv]`

use std::fs::File;
use std::time::Instant;

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::evidence::{Evidence, Session};
use pinswitch_calibration::table::PlateauTable;
use pinswitch_inference::Member;

/// Seed of the interval of the expected error.
const SEED: u64 = 1;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let Some(path) = paths.first() else { return Err("usage: evidence TABLE.csv [NEXT.csv]".into()) };
    let table = PlateauTable::read(File::open(path)?, path)?;
    let start = Instant::now();
    let evidence = Evidence::new(&table, &Vocabulary::built_in(), SEED)?;
    let seconds = start.elapsed().as_secs_f64();
    print_posterior(&evidence);
    println!("seconds: {seconds:.2} ({} fits)", evidence.posterior().fit_count);
    if let Some(path) = paths.get(1) {
        let next = PlateauTable::read(File::open(path)?, path)?;
        let baseline = Evidence::baseline(&table, SEED)?;
        println!("error on {path}: {:.3} N", rmse_n(&evidence, &next)?);
        println!("  of the baseline: {:.3} N", rmse_n(&baseline, &next)?);
    }
    Ok(())
}

fn print_posterior(evidence: &Evidence) {
    let posterior = evidence.posterior();
    println!("verdict: {}", posterior.verdict.as_str());
    for reported in &posterior.reported {
        let (name, covariate) = (evidence.name(reported.member), evidence.covariate(reported.member));
        print!("reported: {name} ({covariate}), P = {:.3}", reported.probability);
        let rivals = reported.rivals.iter();
        let rivals: Vec<String> =
            rivals.map(|(member, p)| format!("{} (P = {p:.3})", evidence.name(*member))).collect();
        println!("{}{}", if rivals.is_empty() { "" } else { "; rivals: " }, rivals.join(", "));
    }
    for (member, probability) in posterior.members() {
        let size = match member {
            Member::Effect(effect) => posterior.size(effect),
            Member::Kernel(_) => None,
        };
        let size = size.map_or_else(String::new, |s| format!("  size {:.4} +- {:.4}", s.mean, s.sd));
        println!("  P = {probability:.3}  {}{size}", evidence.name(member));
    }
    for (fit, probability) in posterior.window.iter().zip(&posterior.probabilities).take(8) {
        let names: Vec<&str> = fit.hypothesis.members().map(|member| evidence.name(member)).collect();
        println!("  {:8.2}  {probability:.3}  {{{}}}", fit.score, names.join(", "));
    }
    if let Some(error) = posterior.expected_error {
        let [low, high] = error.interval;
        println!("expected error of a new session: {:.3} N [{low:.3}, {high:.3}]", error.value);
    }
}

/// Returns the root mean square error in newtons of the predictions of a table.
fn rmse_n(evidence: &Evidence, table: &PlateauTable) -> Result<f64, Box<dyn std::error::Error>> {
    let predictions = evidence.predict(&table.rows, Session::New)?;
    let squares = predictions.iter().zip(&table.rows).map(|(p, row)| (row.force_n - p.mean).powi(2));
    Ok((squares.sum::<f64>() / table.rows.len() as f64).sqrt())
}

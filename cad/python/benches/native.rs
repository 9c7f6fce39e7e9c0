//! The native side of `benches/predict.py`: predicts the rows of a CSV in memory, several times, and prints the
//! seconds of each run.

use std::time::Instant;

use pinswitch::batch::{ConfigurationTable, CurveJob, predict_table};
use pinswitch::diagnostic::Diagnostic;
use pinswitch::store::LockPolicy;
use pinswitch::switch::{config, templates};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("give a CSV and a number of runs")?;
    let runs: usize = arguments.next().ok_or("give a number of runs")?.parse()?;
    let text = templates::text("three-double").ok_or("no such template")?;
    let (base, _) = config::read(&text, "three-double")?;
    for _ in 0..runs {
        let bytes = std::fs::read(&file)?;
        let start = Instant::now();
        let table = ConfigurationTable::read(bytes, &file)?;
        let job = CurveJob {
            table: &table,
            base: &base,
            law: None,
            threads: 0,
            policy: LockPolicy::Refuse,
            progress: &|_| (),
        };
        let rows = predict_table(&job, &|| false).map_err(Diagnostic::from)?;
        println!("{} {}", start.elapsed().as_secs_f64(), rows.map_or(0, |rows| rows.len()));
    }
    Ok(())
}

//! A user-defined effect in Rust: creep of the load cell, whose reading grows with the dwell.
//!
//! The example adds the effect to simulated readings and estimates its size: it fits the paper's model
//! for several sizes, and takes the one with the smallest residuals. For `calibrate` to use such an
//! effect, add a file to the effects of `pinswitch-calibration` (CONTRIBUTING.md).
//!
//! `cargo run --release --example custom_effect`

use std::borrow::Cow;

use pinswitch::calibration::effects::{
    ActsOn, Covariate, Description, Effect, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange,
    Written,
};
use pinswitch::calibration::evidence::Evidence;
use pinswitch::calibration::model::Term;
use pinswitch::calibration::table::{Frame, PlateauRow};
use pinswitch::simulation::{Plan, simulate};

static CREEP: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.02]]);

const DESCRIPTION: Description<'static> = Description {
    id: "cell_creep",
    side: Side::Rig,
    covariate: Covariate::Dwell,
    stage: Stage::CellScale,
    formula: "reading (1 + k ln(dwell / 3 s))",
    written: Written::factor(ActsOn::Reading, "k*ln(dwell_s/3)"),
    parameters: &[Parameter::free("k", "1")],
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("dwell_relaxation")],
    experiment: "dead weights with two pauses",
    invisible_because: "the dwell time never varies",
    study: StudyRange { size: Some((0.01, 0.05)), signed: false, shapes: &[], paper: PaperProtocol::Hidden },
};

/// Returns the root mean square of the differences of readings from predictions, in newtons.
fn rms(rows: &[PlateauRow], predicted_n: &[f64]) -> f64 {
    let squares = rows.iter().zip(predicted_n).map(|(row, predicted)| (row.force_n - predicted).powi(2));
    (squares.sum::<f64>() / rows.len() as f64).sqrt()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    const TRUE_SIZE: f64 = 0.03;
    let mut rows = simulate(&Plan { seed: 5, ..Plan::randomised() }).rows;
    let frame = Frame::new(&rows);
    let points = frame.points(&rows).ok_or("unknown condition")?;
    for (row, point) in rows.iter_mut().zip(&points) {
        row.force_n = CREEP.on_reading(&[TRUE_SIZE], point, &frame.conditions[point.condition], row.force_n);
    }

    let mut best = (f64::INFINITY, 0.0);
    for size in [0.0, 0.01, 0.02, 0.03, 0.04, 0.05] {
        // Readings without an effect of this size, to which the paper's model is fitted.
        let mut without = rows.clone();
        for (row, point) in without.iter_mut().zip(&points) {
            row.force_n /= CREEP.on_reading(&[size], point, &frame.conditions[point.condition], 1.0);
        }
        let evidence = Evidence::baseline(&without, 1)?;
        let fitted = evidence.fitted(&evidence.posterior().baseline).ok_or("not finite")?;
        let model = fitted.model.with_term(Term::named(&CREEP), &[size]);
        let residual_n = rms(&rows, &model.predict(&points));
        println!("{} = {size:.2}: residual RMS {residual_n:.3} N", CREEP.id());
        if residual_n < best.0 {
            best = (residual_n, size);
        }
    }
    println!("best k = {}, true k = {TRUE_SIZE}", best.1);
    Ok(())
}

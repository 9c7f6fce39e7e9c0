//! A user-defined effect in Rust: creep of the load cell, whose reading grows with the dwell.
//!
//! The example adds the effect to simulated readings and estimates its size with a fit. For
//! `calibrate` to use such an effect, add a file to the effects of `pinswitch-calibration`
//! (CONTRIBUTING.md).
//!
//! `cargo run --release --example custom_effect`

use pinswitch::calibration::effects::{
    ActsOn, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};
use pinswitch::calibration::inference::{
    Model, Noise, Observations, Term, Weighed, fit, interval_half_widths,
};
use pinswitch::calibration::table::{Condition, Frame, Point};
use pinswitch::simulation::{Plan, simulate};

#[derive(Debug)]
struct Creep;

static CREEP: Description = Description {
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
    confused_with: &["dwell_relaxation"],
    experiment: "dead weights with two pauses",
    invisible_because: "the dwell time never varies",
    study: StudyRange { size: Some((0.01, 0.05)), signed: false, shapes: &[], paper: PaperProtocol::Hidden },
};

impl Effect for Creep {
    fn description(&self) -> &'static Description {
        &CREEP
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.02]]
    }

    fn on_reading(&self, k: &[f64], point: &Point, _: &Condition, reading_n: f64) -> f64 {
        reading_n * (1.0 + k[0] * point.log_dwell)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    const TRUE_SIZE: f64 = 0.03;
    let rows = simulate(&Plan { seed: 5, ..Plan::randomised() }).rows;
    let frame = Frame::new(&rows);
    let mut data = Observations::new(&frame, &rows).ok_or("unknown condition")?;
    for (force_n, point) in data.force_n.iter_mut().zip(&data.points) {
        *force_n = Creep.on_reading(&[TRUE_SIZE], point, &frame.conditions[point.condition], *force_n);
    }

    let weighed = Weighed::new(&data, Noise::constant(0.05, 0.1));
    let without = fit(&Model::baseline(frame), &weighed);
    let with =
        fit(&without.model.with_term(Term::Named(&Creep), &Creep.starts(&without.model.frame)[0]), &weighed);
    let rms = |r: &[f64]| (r.iter().map(|r| r * r).sum::<f64>() / r.len() as f64).sqrt();
    println!("residual RMS without {}: {:.3} N", Creep.id(), rms(&without.residual_n));
    println!("residual RMS with it: {:.3} N", rms(&with.residual_n));
    let widths = interval_half_widths(&with, &weighed);
    for (((name, unit), value), width) in with.model.names().iter().zip(with.model.values()).zip(widths) {
        println!("  {name} = {value:.4} +- {width:.4} {unit}");
    }
    println!("true k = {TRUE_SIZE}");
    Ok(())
}

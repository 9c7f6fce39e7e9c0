//! Planned runs on a rig that a model file describes.

use std::collections::BTreeMap;

use pinswitch_calibration::ModelFile;
use pinswitch_calibration::evidence::Session;
use pinswitch_calibration::table::{Frame, PlateauRow};
use pinswitch_diagnostic::Diagnostic;
use pinswitch_friction::Direction;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Simulates readings for the rows: the predictions of the model plus noise with its variance
/// components. Offsets are independent from series to series, without the autocorrelation of the
/// model. The same seed gives the same readings.
///
/// `file` is the name of the model in errors.
///
/// # Errors
/// Those of [`ModelFile::model`].
pub fn simulate_from_model(
    model: &ModelFile,
    file: &str,
    mut rows: Vec<PlateauRow>,
    seed: u64,
) -> Result<Vec<PlateauRow>, Diagnostic> {
    let (readings_n, _) = model.predict(&rows, Session::New, file)?;
    let (known, noise) = (model.model(file)?, model.noise());
    let mut frame: Frame = known.frame.clone();
    rows.iter().for_each(|row| frame.extend(row));
    let known = known.in_frame(frame);
    let points = known.frame.points(&rows).unwrap_or_default();
    // Derivative of a reading with respect to a relative change of the friction exponent, in
    // newtons.
    let friction_n = known.friction_n(&points);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
    let mut mounts: BTreeMap<(usize, String), f64> = BTreeMap::new();
    let mut series: BTreeMap<String, [f64; 2]> = BTreeMap::new();
    let mut cells: BTreeMap<(String, bool), [f64; 2]> = BTreeMap::new();
    let rho = noise.correlation;
    for (row, ((reading_n, friction_n), point)) in
        rows.iter_mut().zip(readings_n.iter().zip(&friction_n).zip(&points))
    {
        let mount = *mounts
            .entry((point.condition, row.labels.mount.clone()))
            .or_insert_with(|| noise.mount_scale * draw());
        let [common, scale] =
            *series.entry(row.series.clone()).or_insert_with(|| [draw(), noise.series_scale * draw()]);
        let up = row.direction == Direction::Concentric;
        let cell = cells.entry((row.series.clone(), up)).or_insert_with(|| [draw(), draw()]);
        cell[1] = rho * cell[1] + (1.0 - rho * rho).max(0.0).sqrt() * draw();
        row.force_n = reading_n
            + (mount + scale) * friction_n
            + common * noise.series_common.at(row.load_n)
            + cell[0] * noise.series.at(row.load_n)
            + cell[1] * noise.repetition.at(row.load_n);
    }
    Ok(rows)
}

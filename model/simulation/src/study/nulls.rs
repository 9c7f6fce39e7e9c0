//! Kinds of noise of the rigs without effect.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::plan::NoisePlan;

/// Name of a kind, and its change of the noise that every rig has.
type Kind = (&'static str, fn(&mut NoisePlan, &mut ChaCha8Rng));

/// All kinds.
pub(super) const NULLS: [Kind; 18] = [
    ("no effect", |_, _| ()),
    ("no effect, heavy tails and outliers", |noise, _| {
        (noise.heavy_tails, noise.outlier_share, noise.outlier_n) = (true, 0.01, 3.0);
    }),
    ("no effect, uneven and correlated noise", |noise, _| {
        (noise.autocorrelation, noise.uneven) = (0.4, 0.3);
    }),
    ("no effect, one weight mislabelled", |noise, _| noise.mislabelled_series = 1),
    ("no effect, heavy tails", |noise, _| noise.heavy_tails = true),
    ("no effect, chain of 0.7", |noise, _| noise.autocorrelation = 0.7),
    ("no effect, uneven noise", |noise, _| noise.uneven = 0.5),
    ("no effect, series scale 1 %", |noise, _| noise.series_scale = 0.01),
    ("no effect, series scale 2 %", |noise, _| noise.series_scale = 0.02),
    ("no effect, series scale 3 %", |noise, _| noise.series_scale = 0.03),
    ("no effect, series scale 5 %", |noise, _| noise.series_scale = 0.05),
    ("no effect, mount scale 1 %", |noise, _| noise.mount_scale = 0.01),
    ("no effect, mount scale 2 %", |noise, _| noise.mount_scale = 0.02),
    ("no effect, mount scale 4 %", |noise, _| noise.mount_scale = 0.04),
    ("no effect, common offsets", |noise, _| common_offsets(noise)),
    ("no effect, walking offsets", |noise, _| {
        common_offsets(noise);
        noise.series_walk = 0.8;
    }),
    ("no effect, quantised cell", |noise, _| noise.resolution_n = 0.1),
    ("no effect, everything at once", everything_at_once),
];

/// Number of kinds with two and a half times as many rigs: the rate of rare alarms needs many rigs.
pub(super) const OFTEN: usize = 4;

/// Adds offsets of a series that are common to both directions.
fn common_offsets(noise: &mut NoisePlan) {
    (noise.series_common_n, noise.series_common_per_load) = (0.05, 0.004);
}

/// Adds all kinds of noise of an unknown rig at once: random effects of mounts and series,
/// autocorrelated offsets that grow with load, autocorrelated repetitions, heavy tails, a coarse
/// resolution, and missing rows.
pub(super) fn everything_at_once(noise: &mut NoisePlan, random: &mut ChaCha8Rng) {
    common_offsets(noise);
    noise.series_scale = random.random_range(0.01..0.04);
    noise.mount_scale = random.random_range(0.01..0.03);
    noise.series_walk = 0.4;
    (noise.autocorrelation, noise.heavy_tails) = (0.4, true);
    (noise.resolution_n, noise.lost_share) = (0.05, 0.03);
}

/// Applies the kind with this name to the noise of a plan.
pub(super) fn apply(name: &str, noise: &mut NoisePlan, random: &mut ChaCha8Rng) {
    if let Some((_, change)) = NULLS.iter().find(|kind| kind.0 == name) {
        change(noise, random);
    }
}

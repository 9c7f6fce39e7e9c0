//! Benchmarks of the physics: a curve of 50 loads, and sweeps over pin patterns.
//! `cargo bench --bench physics`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use divan::Bencher;
use pinswitch_friction::layout_search::Search;
use pinswitch_friction::physics::{Bed, Constants, PhysicsSwitch};
use pinswitch_friction::published::{self, LAYOUTS};
use pinswitch_friction::{Contact, Law, PinPattern, Substrate, predict_by};

fn main() {
    divan::main();
}

fn device(layout: usize) -> Contact {
    let pins = PinPattern::even(LAYOUTS[layout].pins, LAYOUTS[layout].pitch_rad());
    Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap()
}

fn loads() -> Vec<f64> {
    (0..50).map(|i| 3.0766 + (49.671 - 3.0766) * f64::from(i) / 49.0).collect()
}

/// Tensions and friction in both directions.
#[divan::bench(args = [0, 1, 2])]
fn states_50_loads(bencher: Bencher, layout: usize) {
    let (switch, loads) = (PhysicsSwitch::new(&device(layout), Constants::published()), loads());
    bencher.bench(|| switch.states(&loads).unwrap());
}

/// A curve with its band.
#[divan::bench(args = [0, 1, 2])]
fn curve_50_loads(bencher: Bencher, layout: usize) {
    let (contact, loads) = (device(layout), loads());
    bencher.bench(|| predict_by(Law::Physics, &contact, &loads).unwrap());
}

/// All patterns of the 11 grooves within the published wrap, and of all 15 grooves.
#[divan::bench(args = [11, 15], sample_count = 1)]
fn sweep(bencher: Bencher, grooves: usize) {
    let pitch = published::GROOVE_PITCH_DEG.to_radians();
    let middle = (grooves as f64 - 1.0) / 2.0;
    let search = Search {
        grooves: (0..grooves).map(|i| (i + 1, (i as f64 - middle) * pitch)).collect(),
        wrap_rad: (grooves as f64 * pitch).max(published::wrap_angle_rad()),
        bed: Bed::published(),
        loads_n: (3.0766, 49.671),
        pins: (1, grooves),
    };
    bencher.bench(|| search.sweep().len());
}

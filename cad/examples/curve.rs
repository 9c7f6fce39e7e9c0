//! Prints the friction curve of any layout of pins, by every law that applies to it.
//!
//! `cargo run --release --example curve [DEGREES …]`; the arguments are the angles of the pins from
//! the middle of the wrap.

use pinswitch::friction::{
    Contact, FrictionCurve, Law, PinPattern, Substrate, Transition, other_laws, predict, published,
};

fn describe(curve: &FrictionCurve) {
    println!("\n{}: {}", curve.law.as_str(), curve.law.summary());
    println!("  {:?}", curve.status);
    curve.reasons.iter().for_each(|reason| println!("    {reason}"));
    println!("  load, N   friction, N   band, N           share of silicone");
    for i in 0..curve.load_n.len() {
        println!(
            "  {:7.2}   {:11.3}   {:6.3} to {:6.3}  {:5.1} %",
            curve.load_n[i],
            curve.friction_n[i],
            curve.band_low_n[i],
            curve.band_high_n[i],
            100.0 * curve.silicone_share[i]
        );
    }
    match Transition::of(curve) {
        Some(at) => println!("  silicone carries half of the friction at {:.1} N", at.threshold_n),
        None => println!("  the threshold is not within these loads"),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given: Vec<f64> = std::env::args().skip(1).map(|a| a.parse()).collect::<Result<_, _>>()?;
    // Uneven and off centre, unlike the layouts that the paper measured.
    let degrees = if given.is_empty() { vec![-20.0, -2.0, 10.0] } else { given };
    let pins = PinPattern::new(degrees.into_iter().map(f64::to_radians).collect());
    let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
    let loads_n = [5.0, 15.0, 25.0, 35.0, published::heaviest_load_n()];

    println!("{} pins under the tendon", contact.pins().count());
    let best = predict(&contact, &loads_n);
    describe(&best);
    other_laws(best.law, &contact, &loads_n).iter().for_each(describe);
    for law in Law::predictive() {
        println!("\nsource of {}: {}", law.as_str(), law.source());
    }
    Ok(())
}

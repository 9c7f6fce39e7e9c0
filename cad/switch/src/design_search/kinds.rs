//! The criterion by which two proposals are different designs, and not variations of one.

use crate::config::Configuration;
use crate::request::Parameter;

/// Least ratio of two values of a parameter that requires another material or another mould.
const DIFFERENT_RATIO: f64 = 1.25;
/// Least displacement of a pin that makes a different layout, degrees: one and a half grooves of
/// the published segment.
const DIFFERENT_ANGLE_DEG: f64 = 9.0;

/// Returns whether two configurations are different designs: another number of pins, a pin
/// displaced by 9 degrees (mirror images are equal), or a parameter or a tendon that differs by a
/// quarter.
pub fn differ_in_kind(a: &Configuration, b: &Configuration) -> bool {
    let (pins_a, pins_b) = (angles_deg(a), angles_deg(b));
    if pins_a.len() != pins_b.len() {
        return true;
    }
    let apart = |a: f64, b: f64| a.max(b) / a.min(b).max(1e-9) >= DIFFERENT_RATIO;
    let tendon = |c: &Configuration| c.tendon.rope_diameter_mm + 2.0 * c.tendon.coating_mm;
    let parameters = Parameter::ALL.iter().filter(|p| **p != Parameter::PitchDeg);
    parameters.into_iter().any(|p| apart(p.value(a), p.value(b)))
        || apart(tendon(a), tendon(b))
        || largest_shift_deg(&pins_a, &pins_b) >= DIFFERENT_ANGLE_DEG
}

/// Returns the largest distance between corresponding pins, degrees, for the layout or its mirror
/// image, whichever is closer.
fn largest_shift_deg(a: &[f64], b: &[f64]) -> f64 {
    let farthest =
        |b: &mut dyn Iterator<Item = f64>| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    farthest(&mut b.iter().copied()).min(farthest(&mut b.iter().rev().map(|angle| -angle)))
}

fn angles_deg(c: &Configuration) -> Vec<f64> {
    let pitch = Parameter::PitchDeg.value(c);
    let middle = (c.segment.grooves as f64 + 1.0) / 2.0;
    let mut pins = c.layout.pins.clone();
    pins.sort_unstable();
    pins.iter().map(|pin| (*pin as f64 - middle) * pitch).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn with(pins: &[usize], set: impl Fn(&mut Configuration)) -> Configuration {
        let mut c = Configuration::default();
        c.layout.pins = pins.to_vec();
        set(&mut c);
        c
    }

    #[test]
    fn mirror_images_are_of_one_kind() {
        let same = |_: &mut Configuration| {};
        let base = with(&[5, 8, 10], same);
        assert!(!differ_in_kind(&base, &with(&[6, 8, 11], same)), "a mirror image");
        assert!(!differ_in_kind(&base, &with(&[5, 8, 10], |c| c.silicone.thickness_mm = 2.2)));
        assert!(differ_in_kind(&base, &with(&[5, 8, 10], |c| c.silicone.thickness_mm = 3.0)));
        assert!(differ_in_kind(&base, &with(&[5, 8, 10, 12], same)));
        assert!(!differ_in_kind(&base, &with(&[5, 8, 11], same)), "one pin moved by one groove");
        assert!(differ_in_kind(&base, &with(&[3, 8, 13], same)));
        assert!(differ_in_kind(&base, &with(&[5, 8, 10], |c| c.tendon.rope_diameter_mm = 0.8)));
    }

    proptest! {
        #[test]
        fn difference_in_kind_is_symmetric(
            a in proptest::collection::btree_set(1usize..16, 1..8), b in proptest::collection::btree_set(1usize..16, 1..8)
        ) {
            let (a, b): (Vec<usize>, Vec<usize>) = (a.into_iter().collect(), b.into_iter().collect());
            let mirrored: Vec<usize> = a.iter().map(|pin| 16 - pin).collect();
            let of = |pins: &[usize]| with(pins, |_| {});
            prop_assert!(!differ_in_kind(&of(&a), &of(&a)) && !differ_in_kind(&of(&a), &of(&mirrored)));
            prop_assert_eq!(differ_in_kind(&of(&a), &of(&b)), differ_in_kind(&of(&b), &of(&a)));
        }
    }
}

//! Which law predicts a contact, and the others beside it.

use crate::curve::{capstan_curve, layout_curve, paper_curve, trust};
use crate::physics::{PhysicsError, physics_curve};
use crate::{Contact, FrictionCurve, Law, Substrate, Trust};

/// Why a law cannot predict a contact.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// The paper has no constants for this layout.
    #[error(
        "the paper gives constants for six-single, three-double and three-single only (pinswitch layouts shows them); use the law layout or physics"
    )]
    NotInPaper,
    /// The layout law describes pins in silicone.
    #[error("the layout law describes pins on silicone only; use the law paper or physics")]
    NoDevice,
    /// A calibrated model is a file.
    #[error("a calibrated law comes from a model file; give it with --model")]
    NeedsModel,
    /// The physics has no solution.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
}

/// The law that is best supported for a contact: the paper's own where it measured; between its layouts the layout law,
/// whose error on devices left out is smaller (6 % against 8 %); physics for pins on the proxy, and wherever the layout law
/// would be a guess, because it alone knows of uneven, off-centre and single pins.
pub fn best_law(contact: &Contact) -> Law {
    match (trust(contact).0, contact.substrate()) {
        (Trust::Published, _) => Law::Paper,
        (Trust::Interpolated, Substrate::Silicone) => Law::Layout,
        _ if contact.substrate() == Substrate::Silicone && contact.pins().count() == 0 => Law::Paper,
        _ => Law::Physics,
    }
}

/// Predicts tension and friction of `contact` at `loads_n` newtons by this law.
///
/// # Errors
/// [`LawError`] if the law does not apply or has no solution.
pub fn predict_by(law: Law, contact: &Contact, loads_n: &[f64]) -> Result<FrictionCurve, LawError> {
    match law {
        Law::Paper => paper_curve(contact, loads_n).ok_or(LawError::NotInPaper),
        Law::Layout => layout_curve(contact, loads_n).ok_or(LawError::NoDevice),
        Law::Physics => Ok(physics_curve(contact, loads_n)?),
        Law::Calibrated => Err(LawError::NeedsModel),
    }
}

/// Predicts by the best supported law ([`best_law`]). Where the physics has no solution, the layout law or the paper's
/// capstan stands in, and the curve says so.
pub fn predict(contact: &Contact, loads_n: &[f64]) -> FrictionCurve {
    match predict_by(best_law(contact), contact, loads_n) {
        Ok(curve) => curve,
        Err(failed) => {
            let mut curve = layout_curve(contact, loads_n).unwrap_or_else(|| capstan_curve(contact, loads_n));
            curve.reasons.push(format!("another law stands in: {failed}"));
            curve
        }
    }
}

/// The curves of all other laws that apply, for comparison; never mixed into the main one.
pub fn other_laws(main: Law, contact: &Contact, loads_n: &[f64]) -> Vec<FrictionCurve> {
    [Law::Paper, Law::Layout, Law::Physics]
        .into_iter()
        .filter(|law| *law != main)
        .filter_map(|law| predict_by(law, contact, loads_n).ok())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PinPattern, published};

    fn contact(substrate: Substrate, pins: PinPattern) -> Contact {
        Contact::new(substrate, pins, published::wrap_angle_rad()).unwrap()
    }

    #[test]
    fn the_best_law_follows_what_was_measured() {
        let silicone = |pins| best_law(&contact(Substrate::Silicone, pins));
        let double = &published::LAYOUTS[1];
        assert_eq!(silicone(PinPattern::even(3, double.pitch_rad())), Law::Paper);
        assert_eq!(silicone(PinPattern::default()), Law::Paper);
        assert_eq!(silicone(PinPattern::even(4, 0.25)), Law::Layout);
        assert_eq!(silicone(PinPattern::new(vec![-0.3, 0.0, 0.2])), Law::Physics);
        assert_eq!(best_law(&contact(Substrate::Abs, PinPattern::even(4, 0.25))), Law::Physics);
    }

    #[test]
    fn laws_that_do_not_apply_say_why() {
        let uneven = contact(Substrate::Silicone, PinPattern::new(vec![-0.3, 0.0, 0.2]));
        assert_eq!(predict_by(Law::Paper, &uneven, &[10.0]), Err(LawError::NotInPaper));
        let proxy = contact(Substrate::Abs, PinPattern::even(3, 0.2));
        assert_eq!(predict_by(Law::Layout, &proxy, &[10.0]), Err(LawError::NoDevice));
        assert_eq!(predict_by(Law::Calibrated, &proxy, &[10.0]), Err(LawError::NeedsModel));
    }

    #[test]
    fn laws_stand_side_by_side() {
        let double = contact(Substrate::Silicone, PinPattern::even(3, published::LAYOUTS[1].pitch_rad()));
        let laws: Vec<_> = other_laws(Law::Paper, &double, &[20.0]).iter().map(|c| c.law).collect();
        assert_eq!(laws, [Law::Layout, Law::Physics]);
    }
}

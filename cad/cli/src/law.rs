//! `--law`: which law makes the curve.

use clap::{Args, ValueEnum};
use pinswitch_model::{FrictionCurve, Law};

use super::Failure;
use pinswitch_switch::design::Design;
use pinswitch_switch::prediction::Prediction;

/// The law behind the curve.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct LawChoice {
    /// Law of the curve [default: the best supported for the layout].
    #[arg(long, value_enum)]
    law: Option<Name>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Name {
    /// Capstan and eq. 4 with the paper's constants: its three layouts only.
    Paper,
    /// The law fitted to the three layouts' thresholds: number and pitch of the pins.
    Layout,
    /// A string over sinking pins on silicone: any layout.
    Physics,
}

impl LawChoice {
    /// The prediction of `design` by the chosen law.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the law does not apply to the layout.
    pub(super) fn prediction(self, design: &Design) -> Result<Prediction, Failure> {
        let law = match self.law {
            None => return Ok(Prediction::of(design)),
            Some(Name::Paper) => Law::Paper,
            Some(Name::Layout) => Law::Layout,
            Some(Name::Physics) => Law::Physics,
        };
        Prediction::by(law, design).map_err(|e| Failure::bad_input(format!("--law {}: {e}", law_name(law))))
    }
}

/// The chosen law and the others at the heaviest load: `paper 10.01 N; others: layout 10.29, physics 8.92`.
pub(super) fn side_by_side(curve: &FrictionCurve, others: &[FrictionCurve]) -> String {
    let last = |c: &FrictionCurve| c.friction_n.last().copied().unwrap_or_default();
    let load = curve.load_n.last().copied().unwrap_or_default();
    let beside: Vec<_> = others.iter().map(|c| format!("{} {:.2} N", law_name(c.law), last(c))).collect();
    let tail = if beside.is_empty() { String::new() } else { format!(" ({})", beside.join(", ")) };
    format!("law {}: {:.2} N of friction at {load:.2} N of load{tail}", law_name(curve.law), last(curve))
}

fn law_name(law: Law) -> &'static str {
    match law {
        Law::Paper => "paper",
        Law::Layout => "layout",
        Law::Physics => "physics",
        Law::Calibrated => "calibrated",
    }
}

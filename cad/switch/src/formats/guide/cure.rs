//! The cure of the silicone.

use super::document::Step;
use crate::design::Design;

/// The step of the cure.
pub(super) fn cure_step(design: &Design) -> Step {
    let c = design.configuration();
    Step::new("Let the silicone cure")
        .text(format!(
            "Cure for 48 h at 25 \u{b0}C, or for 4 h at 60 \u{b0}C. Above 70 \u{b0}C the mould softens. The mould compensates a shrinkage \
             of {} % (0 at 25 \u{b0}C, about 1 at 60 \u{b0}C: `mould.shrinkage_pct`).",
            c.mould.shrinkage_pct
        ))
        .text("Touch the silicone that remained in the cup before you open the mould.")
        .risk(
            "Something inhibits the cure: sulphur, latex, or another silicone.",
            "The surface is sticky after the full time; clean the mould and use fresh silicone.",
        )
}

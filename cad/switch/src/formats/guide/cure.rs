//! The cure of the silicone, in the mould and outside of it.

use super::document::Step;
use crate::design::Design;
use crate::process::{Process, instructions};

/// The step of the cure in the mould.
pub(super) fn cure_step(design: &Design) -> Step {
    let c = design.configuration();
    let step = Step::new("Let the silicone cure").text(instructions::cure(c, &Process::of(c)));
    step.text("Touch the silicone that remained in the cup before you open the mould.").risk(
        "Something inhibits the cure: sulphur, latex, or another silicone.",
        "The surface is sticky after the full time; clean the mould and use fresh silicone.",
    )
}

/// The step of the cure outside the mould; `None` if the hardness needs none.
pub(super) fn post_cure_step(design: &Design) -> Option<Step> {
    let words = instructions::post_cure(&Process::of(design.configuration()))?;
    Some(
        Step::new("Post-cure the layer")
            .text(words)
            .text("Put no printed part into the oven, and use none for food. Take the tray out with gloves, and let the layer cool.")
            .risk("The oven is too cold.", "The layer stays softer, which a durometer for Shore A shows."),
    )
}

//! The cover: what the switch is, and what it will do.

use super::document::{Block, PictureSource};
use super::figure::curve_figure;
use crate::design::Design;
use crate::documents::Manifest;
use crate::prediction::Prediction;
use pinswitch_friction::{PredictionStatus, Substrate, Transition, pluralise};

pub(super) fn cover(design: &Design, prediction: &Prediction, manifest: &Manifest) -> Vec<Block> {
    let figure = curve_figure(&prediction.curve, manifest.friction.threshold_n);
    vec![
        Block::Paragraph(what_it_is(design)),
        Block::Picture {
            file: "assembly.png".to_owned(),
            // The picture of a rig is not exploded.
            alt: match design.rig_layout() {
                Some(_) => "The assembled rig".to_owned(),
                None => "Exploded view of the assembly".to_owned(),
            },
            source: PictureSource::Exploded,
        },
        Block::Heading { number: None, text: "What it will do".to_owned() },
        Block::Paragraph(what_it_does(design, prediction, manifest)),
        Block::Figure {
            file: "friction.svg".to_owned(),
            alt: "Friction over load, with the 95 % band".to_owned(),
            figure,
        },
        Block::Paragraph(support(manifest)),
    ]
}

fn what_it_is(design: &Design) -> String {
    let c = design.configuration();
    let pins = pluralise(c.layout.pins.len(), "steel pin");
    let wrap = format!("A tendon is wrapped over it by {} degrees.", c.layout.wrap_angle_deg);
    match (c.layout.substrate, c.layout.pins.is_empty()) {
        (Substrate::Silicone, false) => format!(
            "This is a friction switch: a fixed segment of a pulley with {pins} in a layer of silicone. {wrap} At low load the \
             tendon slides on the pins, with little friction. As the load grows, the pins sink into the silicone, and the tendon \
             slides on the silicone too, with more friction."
        ),
        (Substrate::Silicone, true) => format!(
            "This is a fixed segment of a pulley with a layer of silicone and without pins. {wrap} The tendon slides on the \
             silicone at every load. It is the reference for friction switches, which have pins in the silicone."
        ),
        (Substrate::Abs, false) => format!(
            "This is a fixed segment of a pulley with {pins} on the proxy, a printed part in place of silicone. {wrap} The pins \
             cannot sink into it, so that the tendon slides on the pins at every load. It is the reference for friction \
             switches, whose pins sink."
        ),
        (Substrate::Abs, true) => format!(
            "This is a fixed segment of a pulley with the proxy, a printed part in place of silicone, and without pins. {wrap} \
             The tendon slides on the proxy at every load."
        ),
    }
}

fn what_it_does(design: &Design, prediction: &Prediction, manifest: &Manifest) -> String {
    let f = &manifest.friction;
    let curve = &prediction.curve;
    let is_switch = design.configuration().layout.substrate == Substrate::Silicone
        && !design.configuration().layout.pins.is_empty();
    let switching = match Transition::of(curve) {
        Some(t) => format!(
            "**It switches at {:.1} N** ({:.1} to {:.1} N): at this load the silicone carries half of the friction. ",
            t.threshold_n, t.low_n, t.high_n
        ),
        None if is_switch => {
            let is_pressed = curve.silicone_share.first().is_some_and(|share| *share >= 0.5);
            format!(
                "**It does not switch** within its range of loads: the silicone carries {} than half of the friction at every \
                 load. ",
                if is_pressed { "more" } else { "less" }
            )
        }
        None => "**It does not switch.** ".to_owned(),
    };
    let first = (curve.load_n.first(), curve.friction_n.first());
    let light = match first {
        (Some(load), Some(friction)) => format!("Friction is {friction:.2} N at a load of {load:.2} N. "),
        _ => String::new(),
    };
    format!(
        "{switching}{light}Friction is {:.2} N ({:.2} to {:.2} N) at a load of {:.2} N ({}).",
        f.friction_n,
        f.band_n[0],
        f.band_n[1],
        f.load_n,
        f.trust.as_str()
    )
}

/// The support of the prediction by measurements.
fn support(manifest: &Manifest) -> String {
    let meaning = match manifest.friction.trust {
        PredictionStatus::Published => "the authors of the friction switch measured this arrangement",
        PredictionStatus::Interpolated => "this arrangement is between arrangements that were measured",
        PredictionStatus::Extrapolated => {
            "this arrangement is outside the measured range, so that the numbers are estimates"
        }
    };
    format!(
        "The line is the prediction, and the shaded band has a probability of 95 %. The prediction is {}: {meaning}. \
         `friction.csv` and `friction.svg` contain the curve.",
        manifest.friction.trust.as_str()
    )
}

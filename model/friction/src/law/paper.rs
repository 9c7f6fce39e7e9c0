//! `paper`: the paper's own capstan and eq. 4, with its constants, for its three layouts and for one material alone.

use super::{Definition, Law, LawError, Support};
use crate::capstan::{Direction, capstan_friction_n, capstan_tension_n};
use crate::curve::Banded;
use crate::published::{self, PublishedLayout};
use crate::trust::{EXTRAPOLATED_SPREAD, trust};
use crate::{Contact, FrictionCurve, PaperSwitch, Substrate, Switch, SwitchState, Trust};

pub(super) static DEFINITION: Definition = Definition {
    word: "paper",
    title: "the paper's model",
    summary: "Capstan and eq. 4 with the paper's constants: its three layouts only",
    source: "capstan and eq. 4 of Dermitzakis & Carbajal, arXiv:1401.5232, with its constants",
    needs_model: false,
    support,
    curve: paper_curve,
};

/// Measured where the paper measured; bare silicone is its capstan at any wrap and load.
fn support(contact: &Contact) -> Support {
    if trust(contact).0 == Trust::Published {
        Support::Measured
    } else if contact.substrate() == Substrate::Silicone && contact.pins().count() == 0 {
        Support::Interpolated
    } else {
        Support::LastResort
    }
}

/// The paper's model; it gives no constants for other pins on silicone than its three layouts.
fn paper_curve(contact: &Contact, loads_n: &[f64]) -> Result<FrictionCurve, LawError> {
    match (contact.substrate(), contact.published_layout()) {
        (Substrate::Silicone, Some(layout)) => {
            Ok(FrictionCurve::of(Law::Paper, trust(contact), &paper_device(contact, layout, loads_n)))
        }
        (Substrate::Silicone, None) if contact.pins().count() > 0 => Err(LawError::DoesNotApply {
            why: "the paper gives constants for six-single, three-double and three-single only (pinswitch layouts shows them); use the law layout or physics",
        }),
        _ => Ok(capstan_curve(contact, loads_n)),
    }
}

/// The paper's capstan on one material: silicone where there are no pins, else the pins alone.
pub(super) fn capstan_curve(contact: &Contact, loads_n: &[f64]) -> FrictionCurve {
    let points = if contact.pins().count() == 0 {
        silicone_alone(contact, loads_n)
    } else {
        pins_alone(contact, contact.published_layout(), loads_n)
    };
    FrictionCurve::of(Law::Paper, trust(contact), &points)
}

/// A plain capstan with a band of `D / (1 + spread) .. D (1 + spread)`.
fn capstan(contact: &Contact, mu: f64, spread: f64, share: f64, loads_n: &[f64]) -> Vec<Banded> {
    let x = mu * contact.wrap_rad();
    loads_n
        .iter()
        .map(|&load_n| {
            let friction_n = capstan_friction_n(load_n, x);
            let state = SwitchState {
                load_n,
                eccentric_n: capstan_tension_n(load_n, x, Direction::Eccentric),
                concentric_n: capstan_tension_n(load_n, x, Direction::Concentric),
                friction_n,
                silicone_share: share,
            };
            Banded::within(state, spread)
        })
        .collect()
}

/// How far `model` and `measured` lie apart, as a ratio above one less one: the smallest spread that covers both.
fn miss(model: f64, measured: f64) -> f64 {
    (model / measured).max(measured / model) - 1.0
}

fn silicone_alone(contact: &Contact, loads_n: &[f64]) -> Vec<Banded> {
    let model = capstan_friction_n(
        published::heaviest_load_n(),
        published::MU_SILICONE * published::wrap_angle_rad(),
    );
    let spread = miss(model, published::SILICONE_ALONE_MAX_N).max(extrapolated_spread(contact));
    capstan(contact, published::MU_SILICONE, spread, 1.0, loads_n)
}

/// Pins alone: the paper's constant coefficient, which misses its own three maxima by 42 to 113 %; the band says so.
fn pins_alone(contact: &Contact, layout: Option<PublishedLayout>, loads_n: &[f64]) -> Vec<Banded> {
    let model =
        capstan_friction_n(published::heaviest_load_n(), published::MU_PINS * published::wrap_angle_rad());
    let spread = match layout {
        Some(layout) => miss(model, layout.pins_max_n),
        None => published::LAYOUTS.iter().map(|l| miss(model, l.pins_max_n)).fold(0.0, f64::max),
    };
    capstan(contact, published::MU_PINS, spread.max(extrapolated_spread(contact)), 0.0, loads_n)
}

/// A published layout: its own miss at the maximum, and no less than the three layouts' root mean square.
fn paper_device(contact: &Contact, layout: PublishedLayout, loads_n: &[f64]) -> Vec<Banded> {
    let own = |l: &PublishedLayout| {
        let state = PaperSwitch::new(*l).state(published::heaviest_load_n(), published::wrap_angle_rad());
        miss(state.friction_n, l.device_max_n)
    };
    let mean_square =
        published::LAYOUTS.iter().map(|l| own(l).powi(2)).sum::<f64>() / published::LAYOUTS.len() as f64;
    let spread = own(&layout).max(mean_square.sqrt()).max(extrapolated_spread(contact));
    let switch = PaperSwitch::new(layout);
    loads_n.iter().map(|&load| Banded::within(switch.state(load, contact.wrap_rad()), spread)).collect()
}

/// A published layout in a part that departs from the measured one is no longer published.
fn extrapolated_spread(contact: &Contact) -> f64 {
    if contact.departures().is_empty() { 0.0 } else { EXTRAPOLATED_SPREAD }
}

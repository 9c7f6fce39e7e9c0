//! `paper`: capstan and eq. 4 of the paper, with its constants, for its three layouts and for one
//! material alone.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::definition::{LawDefinition, UncertainFriction};
use super::error::LawError;
use crate::band_source::BandSource;
use crate::capstan::{Direction, capstan_friction_n, capstan_tension_n};
use crate::contact::Contact;
use crate::published::{self, LAYOUTS};
use crate::substrate::Substrate;
use crate::switch::{PaperSwitch, Switch, SwitchState};

pub(super) static DEFINITION: LawDefinition = LawDefinition {
    word: "paper",
    title: "the paper's model",
    summary: "Capstan and eq. 4 with the constants of the paper: its three layouts only",
    source: "capstan and eq. 4 of Dermitzakis & Carbajal, arXiv:1401.5232, with its constants",
    needs_model: false,
    states: paper_states,
    uncertain: paper_uncertain,
    remark: threshold_remark,
};

/// Predicts by the model of the paper, which has constants for three layouts of pins on silicone
/// only.
fn paper_states(contact: &Contact, loads_n: &[f64]) -> Result<Vec<SwitchState>, LawError> {
    match (contact.substrate(), contact.published_layout()) {
        (Substrate::Silicone, Some(layout)) => {
            let switch = PaperSwitch::new(layout);
            Ok(loads_n.iter().map(|&load| switch.state(load, contact.wrap_rad())).collect())
        }
        (Substrate::Silicone, None) if contact.pins().count() > 0 => Err(LawError::DoesNotApply {
            problem: "the paper gives constants for six-single, three-double and three-single only",
            help: "use the law layout or physics (`pinswitch layouts` shows the three layouts)",
        }),
        (Substrate::Silicone, None) => Ok(capstan(contact, published::MU_SILICONE, 1.0, loads_n)),
        (Substrate::Abs, _) => Ok(capstan(contact, published::MU_PINS, 0.0, loads_n)),
    }
}

/// Returns the states of a capstan with one coefficient `mu`; `share` is the silicone's share of
/// the friction.
pub(crate) fn capstan(contact: &Contact, mu: f64, share: f64, loads_n: &[f64]) -> Vec<SwitchState> {
    let x = mu * contact.wrap_rad();
    loads_n
        .iter()
        .map(|&load_n| SwitchState {
            load_n,
            eccentric_n: capstan_tension_n(load_n, x, Direction::Eccentric),
            concentric_n: capstan_tension_n(load_n, x, Direction::Concentric),
            friction_n: capstan_friction_n(load_n, x),
            silicone_share: share,
        })
        .collect()
}

/// Returns the uncertainty of the law: the root mean square of its logarithmic errors on all maxima
/// of the same kind, times Student's t quantile for their number. The error on a single layout
/// would underestimate it.
fn paper_uncertain(contact: &Contact, loads_n: &[f64]) -> Result<UncertainFriction, LawError> {
    let friction_n = paper_states(contact, loads_n)?.iter().map(|s| s.friction_n).collect();
    let (wrap, heaviest) = (published::wrap_angle_rad(), published::heaviest_load_n());
    let errors: Vec<f64> = match (contact.substrate(), contact.pins().count()) {
        (Substrate::Silicone, 0) => {
            let model = capstan_friction_n(heaviest, published::MU_SILICONE * wrap);
            vec![libm::log(model / published::SILICONE_ALONE_MAX_N)]
        }
        (Substrate::Silicone, _) => LAYOUTS
            .iter()
            .map(|l| libm::log(PaperSwitch::new(*l).state(heaviest, wrap).friction_n / l.device_max_n))
            .collect(),
        (Substrate::Abs, _) => {
            let model = capstan_friction_n(heaviest, published::MU_PINS * wrap);
            LAYOUTS.iter().map(|l| libm::log(model / l.pins_max_n)).collect()
        }
    };
    let count = errors.len() as f64;
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt();
    let quantile = StudentsT::new(0.0, 1.0, count).map_or(12.7, |t| t.inverse_cdf(0.975));
    let source = BandSource::symmetric("errors at the measured maxima", vec![quantile * rms; loads_n.len()]);
    Ok(UncertainFriction { friction_n, sources: vec![source] })
}

/// Returns a remark if `F_thr` of six-single is not the printed one.
fn threshold_remark(contact: &Contact) -> Option<String> {
    let (read, printed) = (contact.published_layout()?, LAYOUTS[0]);
    (read.name == printed.name
        && read.threshold != printed.threshold
        && contact.substrate() == Substrate::Silicone)
        .then(|| {
            format!("F_thr of six-single is {} instead of the printed {}", read.threshold, printed.threshold)
        })
}

//! Effects that the paper's model may lack: one file per effect, with everything known about it.
//!
//! To add an effect, write its file and add its name to the list below; fit, report, simulated
//! rigs, study and power read it from there. `model/doc/effect-catalogue.md` explains each effect.

use std::fmt::Debug;

use crate::table::{Condition, Frame, Point};

mod contact_state;
mod covariate;
mod description;
mod formula;
mod own;
mod shared;
mod structure;
mod vocabulary;

pub use contact_state::{ContactState, REFERENCE_LOAD_N};
pub use covariate::Covariate;
pub use description::{Description, PaperProtocol, Parameter, Side, Stage, StudyRange};
pub use formula::{ActsOn, AppliedFormula, Combine, FormulaEffect, Written};
pub(crate) use own::effects_of_model;
pub use own::effects_schema;
pub use own::{
    DefinitionError, EffectDefinition, OwnEffect, OwnParameter, formula_variables, own_effect_blocks,
    own_effects_text, read_own_effects,
};
pub use shared::SharedEffect;
pub use structure::{Abscissa, Channel, Shape, Structure, UNATTRIBUTED};
pub use vocabulary::Vocabulary;

/// Declares the files of the effects and the catalogue of their entries.
macro_rules! effects {
    ($($file:ident,)*) => {
        $(mod $file;)*

        /// The built-in effects, in the order of the effect catalogue.
        pub static CATALOGUE: &[&dyn Effect] = &[$(&$file::EFFECT),*];
    };
}

effects! {
    coating_stiffening,
    coating_ploughing,
    polygon_bending,
    substrate_saturation,
    adhesion,
    dwell_relaxation,
    run_in,
    wear_drift,
    rate_dependence,
    fixture_compliance,
    stroke_position,
    direction_asymmetry,
    switching_hysteresis,
    guide_drag,
    load_cell_offset,
    load_cell_gain,
    load_cell_nonlinearity,
    load_cell_saturation,
    thermal_drift,
    hook_omitted,
    switch_local_tension,
}

/// Returns the built-in effect of an id; [`Vocabulary::named`] also finds user-defined effects.
///
/// ```
/// use pinswitch_calibration::effects::{Side, effect_named};
///
/// let ploughing = effect_named("coating_ploughing").ok_or("not in the catalogue")?;
/// assert_eq!(ploughing.description().side, Side::Switch);
/// assert_eq!(ploughing.parameters()[0].unit, "N^-0.5");
/// # Ok::<(), &str>(())
/// ```
pub fn effect_named(id: &str) -> Option<&'static dyn Effect> {
    CATALOGUE.iter().copied().find(|effect| effect.id() == id)
}

/// An effect: its description, its typical constants, and its place in the forward model. A [`FormulaEffect`] has a
/// formula, which places it; other effects implement the methods of their stage.
///
/// ```
/// use std::borrow::Cow;
///
/// use pinswitch_calibration::effects::{
///     ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
/// };
/// use pinswitch_calibration::model::{Model, Term};
/// use pinswitch_calibration::table::{Frame, PlateauTable};
///
/// /// The cell reads too much after a long pause.
/// static CREEP: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.02]]);
///
/// const DESCRIPTION: Description<'static> = Description {
///     id: "cell_creep",
///     side: Side::Rig,
///     covariate: Covariate::Dwell,
///     stage: Stage::CellScale,
///     formula: "reading (1 + k ln(dwell / 3 s))",
///     written: Written::factor(ActsOn::Reading, "k*ln(dwell_s/3)"),
///     parameters: &[Parameter::free("k", "1")],
///     one_sided: true,
///     bends: true,
///     scales: true,
///     on_plain: true,
///     confused_with: &[Cow::Borrowed("dwell_relaxation")],
///     experiment: "dead weights with two pauses",
///     invisible_because: "the dwell time never varies",
///     study: StudyRange { size: Some((0.01, 0.05)), signed: false, shapes: &[], paper: PaperProtocol::Hidden },
/// };
///
/// let csv = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N
/// a,silicone,,up,0,20,50,30,concentric,1,12.7,4.5,0
/// ";
/// let rows = PlateauTable::read(csv.as_bytes(), "plateaus.csv")?.rows;
/// let model = Model::baseline(Frame::new(&rows));
/// let points = model.frame.points(&rows).ok_or("a condition is new")?;
/// let with = model.with_term(Term::named(&CREEP), &[0.02]).predict(&points)[0];
/// assert!((with / model.predict(&points)[0] - (1.0 + 0.02 * 10f64.ln())).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Effect: Debug + Send + Sync {
    /// Returns its description.
    fn description(&self) -> Description<'_>;

    /// Returns typical constants of this rig, one entry per discrete shape: plus and minus the size are the quartiles of the
    /// prior, and a fit begins at each shape.
    fn typical(&self, frame: &Frame) -> Vec<Vec<f64>>;

    /// Returns its compiled formula, if it has one. The next three methods apply it.
    fn formula(&self) -> Option<&AppliedFormula> {
        None
    }

    /// Changes the contact; `k` are the constants.
    fn on_contact(&self, k: &[f64], point: &Point, condition: &Condition, state: &mut ContactState) {
        if let Some(formula) = self.formula() {
            formula.on_contact(k, point, condition, state);
        }
    }

    /// Changes the tension in newtons after the contact and before the load cell; `k` are the
    /// constants.
    fn on_tension(&self, k: &[f64], point: &Point, condition: &Condition, tension_n: f64) -> f64 {
        self.formula().map_or(tension_n, |formula| formula.on_tension(k, point, condition, tension_n))
    }

    /// Changes the reading in newtons; `k` are the constants.
    fn on_reading(&self, k: &[f64], point: &Point, condition: &Condition, reading_n: f64) -> f64 {
        self.formula().map_or(reading_n, |formula| formula.on_reading(k, point, condition, reading_n))
    }

    /// Returns whether it may vary within a series: with the repetition, the position or the time.
    fn moves_along_a_series(&self) -> bool {
        let covariate = self.description().covariate;
        matches!(covariate, Covariate::Repetition | Covariate::Position | Covariate::Time)
    }

    /// Returns whether it may change the contact, and not only the tension or the reading.
    fn acts_on_contact(&self) -> bool {
        !matches!(self.description().stage, Stage::CellScale | Stage::CellZero | Stage::CellLimit)
    }

    /// Returns its id.
    fn id(&self) -> &str {
        self.description().id
    }

    /// Returns its constants. Sensitivities to them are finite differences.
    fn parameters(&self) -> &[Parameter] {
        self.description().parameters
    }

    /// Returns its formula with a reference to the document that explains it.
    fn cited_formula(&self) -> String {
        let Description { formula, id, .. } = self.description();
        format!("{formula} (model/doc/effect-catalogue.md#{id})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_friction::Substrate;

    fn device() -> Condition {
        Condition {
            substrate: Some(Substrate::Silicone),
            pins: vec![5, 8, 11],
            device: Some(0),
            wrap_rad: 1.115,
            weight: 0.1,
            turn_rad: 0.37,
            ploughing: 0.7,
        }
    }

    fn point() -> Point {
        Point {
            condition: 0,
            load_n: 49.0,
            sign: 1.0,
            descending: 1.0,
            speed_pct: 60.0,
            log_speed: 0.2,
            dwell_s: 5.0,
            log_dwell: 0.5,
            repetition: 2.0,
            position: 0.8,
            time: 0.7,
            travel: 0.6,
            previous_load_n: 20.0,
            ..Point::default()
        }
    }

    fn state() -> ContactState {
        ContactState {
            load_n: 49.0,
            wrap_rad: 1.115,
            mu_pins: 0.05,
            mu_silicone: 0.24,
            extra_exponent_pins: 0.0,
            exponent_factor: 1.0,
            half_load_n: 40.0,
            steepness: 4.6,
            local_tension: false,
            adhesion_n: 0.0,
            drag_n: 0.0,
        }
    }

    /// A change of the half load scales it; no value of a model file makes it zero.
    #[test]
    fn half_loads_stay_positive() {
        let structure = Structure {
            covariate: Covariate::Condition,
            channel: Channel::HalfLoad,
            only_in: None,
            form: Shape::Constant,
        };
        for (k, expected) in [(-0.15, 34.0), (-3.0, 4.0)] {
            let mut state = state();
            structure.on_contact(k, &point(), &mut state);
            assert!((state.half_load_n - expected).abs() < 1e-12, "{k}: {}", state.half_load_n);
        }
    }

    #[test]
    fn ids_are_unique_and_rivals_exist() {
        for (i, effect) in CATALOGUE.iter().enumerate() {
            assert!(CATALOGUE[i + 1..].iter().all(|other| other.id() != effect.id()));
            let description = effect.description();
            assert!(
                description.confused_with.iter().all(|id| effect_named(id).is_some()),
                "{}",
                description.id
            );
            assert!(!description.experiment.is_empty() && description.formula.len() > 8);
            let constants = usize::from(description.study.size.is_some()) + description.study.shapes.len();
            let is_needed = |parameter: &&Parameter| parameter.otherwise.is_none();
            let needed = description.parameters.iter().filter(is_needed).count();
            assert_eq!(constants, needed, "{}", description.id);
            assert!(description.parameters.iter().take(needed).all(|p| is_needed(&p)), "{}", description.id);
        }
    }

    /// A factor on the whole friction scales ploughing; a factor on the pins' coefficient does not.
    #[test]
    fn ploughing_is_friction_but_no_coefficient() {
        let scaled = |id: &str, k: &[f64]| {
            let mut state = ContactState { mu_pins: 0.05, extra_exponent_pins: 0.02, ..state() };
            effect_named(id).unwrap().on_contact(k, &point(), &device(), &mut state);
            (state.mu_pins / 0.05, state.extra_exponent_pins / 0.02)
        };
        let (mu, ploughing) = scaled("coating_stiffening", &[0.5, 1.5]);
        assert!(mu > 1.4 && ploughing == 1.0, "{mu} {ploughing}");
        let (mu, ploughing) = scaled("rate_dependence", &[0.5]);
        assert!(mu > 1.05 && (mu - ploughing).abs() < 1e-12, "{mu} {ploughing}");
    }

    /// Each effect changes some reading of a rig that varies every covariate, and each start has
    /// all constants.
    #[test]
    fn every_effect_changes_some_reading() {
        let frame = Frame {
            stroke_mm: 150.0,
            session_s: 1e4,
            reference_speed_pct: 50.0,
            travel_time_s: vec![0.0, 1e4],
            travel_share: vec![0.0, 1.0],
            load_range_n: (3.0, 50.0),
            ..Frame::default()
        };
        let (condition, point) = (device(), point());
        for effect in CATALOGUE {
            let read = |k: Option<&[f64]>| {
                let mut state = state();
                if let Some(k) = k {
                    effect.on_contact(k, &point, &condition, &mut state);
                }
                let tension = state.tension_n(&condition, &point);
                k.map_or(tension, |k| {
                    let tension = effect.on_tension(k, &point, &condition, tension);
                    effect.on_reading(k, &point, &condition, tension)
                })
            };
            let changed = effect.typical(&frame).iter().any(|k| {
                assert_eq!(k.len(), effect.parameters().len(), "{}", effect.id());
                (read(Some(k)) - read(None)).abs() > 1e-3
            });
            assert!(changed, "{}", effect.id());
        }
    }
}

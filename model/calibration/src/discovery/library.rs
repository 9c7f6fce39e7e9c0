//! Library of forms: formulas for structure along one covariate, as user-defined effects.

use crate::effects::{ActsOn, Channel, Combine, Covariate, EffectDefinition, OwnParameter, Side};
use crate::table::Frame;

/// A form independent of the quantity that it changes: a formula of order one with its shape
/// constants and their start values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Form {
    /// Word in reports.
    pub(super) shape: &'static str,
    /// Formula, in which `a` is the size.
    formula: String,
    /// Name, unit, start and bounds of each shape constant.
    constants: Vec<(&'static str, &'static str, f64, (f64, f64))>,
}

/// A form that changes a particular quantity, as an effect.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) form: Form,
    pub(super) definition: EffectDefinition,
}

impl Candidate {
    /// Returns whether both are the same shape of the same quantity, with different start values.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        self.form.shape == other.form.shape
            && self.definition.acts_on == other.definition.acts_on
            && self.definition.combine == other.definition.combine
    }
}

/// Returns the word in reports for the quantity that a form changes.
pub(super) fn acts_on_word(of: ActsOn) -> &'static str {
    match of {
        ActsOn::Mu | ActsOn::MuPins | ActsOn::MuSilicone => "friction",
        ActsOn::Wrap => "wrap",
        ActsOn::Threshold => "threshold",
        ActsOn::Load | ActsOn::Tension | ActsOn::Reading => "reading",
    }
}

/// The quantity that a form changes, and how.
pub(super) type Acting = (ActsOn, Combine);

/// Returns the quantities that a form may change in place of structure on a channel.
pub(super) fn actings(channel: Channel) -> &'static [Acting] {
    match channel {
        Channel::Reading => &[(ActsOn::Reading, Combine::Sum)],
        Channel::Gain => &[(ActsOn::Reading, Combine::Factor)],
        Channel::Drag => &[(ActsOn::Tension, Combine::Sum)],
        Channel::Friction | Channel::FrictionByDirection => {
            &[(ActsOn::Mu, Combine::Factor), (ActsOn::Threshold, Combine::Factor)]
        }
        Channel::Pins => &[(ActsOn::MuPins, Combine::Factor)],
        Channel::Silicone => &[(ActsOn::MuSilicone, Combine::Factor), (ActsOn::Threshold, Combine::Factor)],
        Channel::HalfLoad => &[(ActsOn::Threshold, Combine::Factor)],
    }
}

/// Start sizes: 5 % of the friction, 0.1 N.
const START_SHARE: f64 = 0.05;
const START_N: f64 = 0.1;

impl Form {
    fn new(
        shape: &'static str,
        formula: impl Into<String>,
        constants: &[(&'static str, &'static str, f64, (f64, f64))],
    ) -> Self {
        Self { shape, formula: formula.into(), constants: constants.to_vec() }
    }

    /// Returns the form of one quantity; `number` is part of its id.
    pub(super) fn on(&self, (acts_on, combine): Acting, covariate: Covariate, number: usize) -> Candidate {
        let (unit, start) = match combine {
            Combine::Sum => ("N", START_N),
            Combine::Factor => ("1", START_SHARE),
        };
        let side =
            if matches!(acts_on, ActsOn::Reading | ActsOn::Tension) { Side::Rig } else { Side::Switch };
        let formula = match acts_on {
            ActsOn::Tension => self.formula.replacen("a*", "a*direction*", 1),
            _ => self.formula.clone(),
        };
        let size = OwnParameter { name: "a".to_owned(), unit: unit.to_owned(), start, bounds: None };
        let shapes = self.constants.iter().map(|(name, unit, start, bounds)| OwnParameter {
            name: (*name).to_owned(),
            unit: (*unit).to_owned(),
            start: *start,
            bounds: Some(*bounds),
        });
        let definition = EffectDefinition {
            id: format!("form_{number}"),
            side,
            covariate,
            acts_on,
            combine,
            formula,
            one_sided: false,
            confused_with: Vec::new(),
            experiment: String::new(),
            drawn_from: None,
            parameters: std::iter::once(size).chain(shapes).collect(),
        };
        Candidate { form: self.clone(), definition }
    }
}

/// Returns all forms along a covariate, with several start values.
pub(super) fn library(covariate: Covariate, frame: &Frame) -> Vec<Form> {
    match covariate {
        Covariate::Time => along_a_share("time", true),
        Covariate::Position => along_a_share("stroke", false),
        Covariate::Repetition => history(),
        Covariate::Speed => speed(frame),
        Covariate::Dwell => dwell(),
        Covariate::Load => load(frame),
        Covariate::Sweep => vec![Form::new("level", "a*descending", &[])],
        Covariate::Direction => {
            vec![Form::new("ramp", "a*direction*load_n/50", &[]), Form::new("level", "a*direction", &[])]
        }
        Covariate::Condition => conditions(frame),
    }
}

/// Start phases of a wave, in radians.
const PHASES: [f64; 4] = [0.0, 0.8, 1.6, 2.4];

/// A step, narrower than the time between two series, but with a slope that a fit can follow.
fn step(x: &str, c: f64) -> Form {
    Form::new("step", format!("a*0.5*(1 + tanh(({x} - c)/0.004))"), &[("c", "1", c, (0.0, 1.0))])
}

fn bump(x: &str, c: f64, w: f64) -> Form {
    let constants = [("c", "1", c, (-0.2, 1.2)), ("w", "1", w, (0.025, 0.5))];
    Form::new("bump", format!("a*exp(-(({x} - c)/w)^2)"), &constants)
}

/// A different level between two ends.
fn level(x: &str, c: f64, e: f64) -> Form {
    let formula = format!("a*0.25*(1 + tanh(({x} - c)/0.004))*(1 - tanh(({x} - e)/0.004))");
    Form::new("level", formula, &[("c", "1", c, (0.0, 1.0)), ("e", "1", e, (0.0, 1.0))])
}

fn sine(x: &str, cycles: f64, phase: f64) -> Form {
    let constants = [("f", "1", cycles, (0.2, 100.0)), ("p", "1", phase, (-3.3, 6.5))];
    Form::new("sine", format!("a*sin(6.283185307*f*{x} + p)"), &constants)
}

/// Forms along a share of the session or of the stroke, 0 to 1.
fn along_a_share(x: &str, is_time: bool) -> Vec<Form> {
    let mut forms = Vec::new();
    for i in 1..=19 {
        let c = 0.05 * f64::from(i);
        forms.push(step(x, c));
        forms.extend([0.03, 0.1, 0.25].map(|w| bump(x, c, w)));
    }
    for (i, width) in (0..18).flat_map(|i| [0.08, 0.15, 0.3, 0.55].map(|width| (i, width))) {
        let c = 0.05 + 0.05 * f64::from(i);
        if c + width < 0.99 {
            forms.push(level(x, c, c + width));
        }
    }
    forms.push(Form::new("ramp", format!("a*({x} - 0.5)"), &[]));
    forms.push(Form::new("power", format!("a*({x} - 0.5)^2"), &[]));
    // A fit does not move between numbers of waves: higher numbers start from the waves found by
    // the search.
    let cycles = [0.5, 0.75].into_iter().chain((2..=32).map(|i| 0.5 * f64::from(i)));
    let cycles = cycles.chain([17.0, 19.0, 21.0, 23.5, 26.0, 29.0, 32.0, 36.0, 40.0]);
    forms.extend(cycles.flat_map(|cycles| PHASES.map(|phase| sine(x, cycles, phase))));
    if is_time {
        for t in [0.05, 0.2, 0.6] {
            forms.push(Form::new("forgetting", "a*exp(-time/t)", &[("t", "1", t, (0.005, 3.0))]));
        }
    }
    forms
}

fn history() -> Vec<Form> {
    let mut forms = vec![Form::new("ramp", "a*(repetition - 10)/10", &[])];
    for r in [1.0, 3.0, 10.0] {
        forms.push(Form::new("forgetting", "a*exp(-(repetition - 1)/r)", &[("r", "1", r, (0.2, 200.0))]));
    }
    forms.extend(memory());
    forms
}

/// Remaining influence of the previous load.
fn memory() -> Vec<Form> {
    let form = |r| {
        let formula = "a*(previous_load_n - load_n)/50*exp(-repetitions_so_far/r)";
        Form::new("memory", formula, &[("r", "1", r, (0.5, 500.0))])
    };
    [3.0, 10.0, 30.0, 100.0].map(form).into()
}

fn speed(frame: &Frame) -> Vec<Form> {
    let mean = frame.reference_speed_pct;
    let mut forms = vec![
        Form::new("power", "a*ln(speed_pct/mean_speed_pct)", &[]),
        Form::new("ramp", "a*speed_pct/mean_speed_pct", &[]),
    ];
    for i in 0..=10 {
        let c = mean * (0.6 + 0.08 * f64::from(i));
        let (low, high) = (0.4 * mean, 2.0 * mean);
        for w in [0.05 * mean, 0.15 * mean, 0.4 * mean] {
            let constants = [("c", "%", c, (low, high)), ("w", "%", w, (0.01 * mean, mean))];
            forms.push(Form::new("bump", "a*exp(-((speed_pct - c)/w)^2)", &constants));
        }
        let step = format!("a*0.5*(1 + tanh((speed_pct - c)/{:.3}))", 0.01 * mean);
        forms.push(Form::new("step", step, &[("c", "%", c, (low, high))]));
    }
    forms
}

fn dwell() -> Vec<Form> {
    let mut forms = vec![Form::new("power", "a*ln(dwell_s/3)", &[])];
    for t in [0.5, 2.0, 8.0, 30.0] {
        forms.push(Form::new("forgetting", "a*exp(-dwell_s/t)", &[("t", "s", t, (0.05, 200.0))]));
    }
    for c in [0.6, 2.0, 6.0, 15.0] {
        let step = Form::new("step", "a*0.5*(1 + tanh(ln(dwell_s/c)/0.1))", &[("c", "s", c, (0.05, 100.0))]);
        forms.push(step);
    }
    forms
}

fn load(frame: &Frame) -> Vec<Form> {
    let most = frame.load_range_n.1.max(1e-3);
    let mut forms = vec![Form::new("ramp", format!("a*load_n/{most:.3}"), &[])];
    for p in [-0.5, 0.5, 2.0, 3.5] {
        forms.push(Form::new("power", format!("a*(load_n/{most:.3})^p"), &[("p", "1", p, (-2.0, 5.0))]));
    }
    for i in 1..=9 {
        let c = 0.1 * f64::from(i) * most;
        let step = format!("a*0.5*(1 + tanh((load_n - c)/{:.3}))", 0.01 * most);
        forms.push(Form::new("step", step, &[("c", "N", c, (0.0, 1.1 * most))]));
        for w in [0.06 * most, 0.2 * most, 0.5 * most] {
            let constants = [("c", "N", c, (0.0, 1.2 * most)), ("w", "N", w, (0.01 * most, most))];
            forms.push(Form::new("bump", "a*exp(-((load_n - c)/w)^2)", &constants));
        }
    }
    forms.extend(memory());
    forms
}

/// A level on one kind of contact, on one condition, or of one operator.
fn conditions(frame: &Frame) -> Vec<Form> {
    let mut forms = vec![
        Form::new("level", "a*is_silicone", &[]),
        Form::new("level", "a*is_device", &[]),
        Form::new("level", "a*(1 - is_silicone)", &[]),
    ];
    for condition in &frame.conditions {
        let n = condition.pins.len();
        let silicone =
            f64::from(u8::from(condition.substrate == Some(pinswitch_friction::Substrate::Silicone)));
        let uneven = condition.turn_unevenness();
        let of_layout =
            format!("a*(abs(pin_count - {n}) < 0.5)*(abs(turn_unevenness - {uneven:.5}) < 0.0005)");
        forms.push(Form::new("level", format!("{of_layout}*(abs(is_silicone - {silicone}) < 0.5)"), &[]));
        if n > 0 {
            forms.push(Form::new("level", of_layout, &[]));
        }
    }
    let groups = |operator| Form::new("groups", format!("a*(operator == {operator})"), &[]);
    forms.extend(frame.operator_numbers().map(groups));
    forms
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::OwnEffect;
    use crate::test_session::session;

    #[test]
    fn every_form_is_an_effect() {
        let frame = Frame::new(&session(1));
        for covariate in Covariate::ALL {
            let forms = library(covariate, &frame);
            assert!(!forms.is_empty(), "{covariate:?}");
            let channels = [
                Channel::Reading,
                Channel::Gain,
                Channel::Drag,
                Channel::Friction,
                Channel::Pins,
                Channel::Silicone,
                Channel::HalfLoad,
            ];
            let all: Vec<Acting> = channels.iter().flat_map(|channel| actings(*channel)).copied().collect();
            for (form, acting) in forms.iter().flat_map(|form| all.iter().map(move |acting| (form, *acting)))
            {
                let definition = form.on(acting, covariate, 1).definition;
                let checked = OwnEffect::new(definition.clone());
                assert!(checked.is_ok(), "{:?}: {}", definition.formula, checked.unwrap_err());
            }
        }
    }
}

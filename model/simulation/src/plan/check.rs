//! Checks of a plan: every field within its bounds.

use std::ops::RangeInclusive;

use pinswitch_calibration::effects::{Effect, Vocabulary};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::{pluralise, published};

use super::noise::NoisePlan;
use super::raw::RawPlan;
use super::rig_plan::{EffectPlan, Plan, Protocol};
use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget};
use crate::effect_forms::forms_of;

/// Largest weight in grams, speed in percent, dwell in seconds, force in newtons and constant of an
/// effect: far above any real one.
const MAX_VALUE: f64 = 1e6;
/// Largest friction coefficient.
const MAX_FRICTION: f64 = 10.0;
/// Largest half-load factor and steepness.
const MAX_SWITCH_CONSTANT: f64 = 1000.0;
/// Most weights, speeds and dwells, and most repetitions of a series.
const MAX_COUNT: u32 = 1000;
/// Most rows that a plan may make: a thousand times those of the paper.
const MAX_ROWS: usize = 1_000_000;
/// Largest wrap angle in degrees: two turns.
const MAX_WRAP_DEG: f64 = 720.0;
/// Largest share of lost rows, outliers and faults.
const MAX_SHARE: f64 = 0.9;
/// Largest correlation: a process with a correlation of one never changes.
const MAX_CORRELATION: f64 = 0.99;

/// Returns an error at the field unless `is_valid`.
fn require(
    is_valid: bool,
    field: &str,
    value: impl FnOnce() -> String,
    problem: impl Into<String>,
    help: &str,
) -> Result<(), Diagnostic> {
    if is_valid {
        return Ok(());
    }
    Err(Diagnostic::new(codes::OUT_OF_RANGE, problem)
        .with_location(Location::field(field, value()))
        .with_help(help))
}

/// Returns an error at the field unless the value is within the range.
fn require_within(field: &str, value: f64, range: RangeInclusive<f64>, help: &str) -> Result<(), Diagnostic> {
    let problem = format!("must be from {} to {}", range.start(), range.end());
    require(range.contains(&value), field, || value.to_string(), problem, help)
}

/// Returns an error at the first field whose value is outside of the range.
fn require_all_within<'a>(
    fields: impl IntoIterator<Item = (&'a str, f64)>,
    range: &RangeInclusive<f64>,
    help: &str,
) -> Result<(), Diagnostic> {
    fields.into_iter().try_for_each(|(field, value)| require_within(field, value, range.clone(), help))
}

impl Plan {
    /// Checks every field; `file` is the file's name in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] at the first invalid field.
    pub fn check(&self, file: &str) -> Result<(), Diagnostic> {
        self.check_fields().map_err(|error| error.or_in_file(file))
    }

    /// Checks every field; the location of an error has no file.
    pub(super) fn check_fields(&self) -> Result<(), Diagnostic> {
        self.check_settings()?;
        self.check_layouts()?;
        self.check_constants()?;
        check_noise(&self.noise)?;
        check_random_effects(&self.noise)?;
        check_raw(&self.raw)?;
        self.disturbances.iter().enumerate().try_for_each(|(i, d)| check_disturbance(i, d))?;
        let effects = self.effects.iter().enumerate();
        effects.into_iter().try_for_each(|(i, effect)| check_effect(i, effect, &self.vocabulary))
    }

    /// Largest number of rows that the plan can make.
    fn max_rows(&self) -> usize {
        let conditions = self.layouts.len().saturating_mul(2).saturating_add(1);
        let repetitions: u32 = self.repetitions.iter().map(|mean| mean + self.repetitions_spread).sum();
        // Loads ascend and descend.
        [2, self.weights_g.len(), repetitions as usize].into_iter().fold(conditions, usize::saturating_mul)
    }

    fn check_constants(&self) -> Result<(), Diagnostic> {
        let c = &self.constants;
        let help = "leave it out for the published value";
        require_all_within(
            [("constants.mu_p", c.mu_p), ("constants.mu_s", c.mu_s)],
            &(0.0..=MAX_FRICTION),
            help,
        )?;
        for (name, values) in [("half_load_factor", &c.half_load_factor), ("steepness", &c.steepness)] {
            for (i, value) in values.iter().enumerate() {
                require(
                    *value > 0.0 && *value <= MAX_SWITCH_CONSTANT,
                    &format!("constants.{name}[{i}]"),
                    || value.to_string(),
                    format!("must be above 0 and at most {MAX_SWITCH_CONSTANT}"),
                    help,
                )?;
            }
        }
        Ok(())
    }

    fn check_settings(&self) -> Result<(), Diagnostic> {
        for (field, values) in
            [("weights_g", &self.weights_g), ("speeds_pct", &self.speeds_pct), ("dwells_s", &self.dwells_s)]
        {
            let is_positive = !values.is_empty() && values.iter().all(|v| *v > 0.0 && *v <= MAX_VALUE);
            require(
                is_positive && values.len() <= MAX_COUNT as usize,
                field,
                || format!("{values:?}"),
                format!("must be 1 to {MAX_COUNT} numbers above 0 and up to {MAX_VALUE}"),
                "list the values to run",
            )?;
        }
        let help = format!("give the wrap of the tendon; the published one is {}", published::WRAP_ANGLE_DEG);
        require_within("wrap_angle_deg", self.wrap_angle_deg, 1.0..=MAX_WRAP_DEG, &help)?;
        require(
            !self.shuffled || self.protocol == Protocol::Randomised,
            "shuffled",
            || "true".to_owned(),
            "must be false in the paper's protocol",
            "set protocol = \"randomised\"",
        )?;
        require(
            self.repetitions.iter().all(|r| (1..=MAX_COUNT).contains(r)),
            "repetitions",
            || format!("{:?}", self.repetitions),
            format!("must be two counts from 1 to {MAX_COUNT}"),
            "give the repetitions of a series, eccentric and concentric",
        )?;
        require(
            self.repetitions_spread <= MAX_COUNT,
            "repetitions_spread",
            || self.repetitions_spread.to_string(),
            format!("must be at most {MAX_COUNT}"),
            "give 0 for the same repetitions in every series",
        )
    }

    fn check_layouts(&self) -> Result<(), Diagnostic> {
        let grooves = 1..=published::GROOVES;
        for (i, layout) in self.layouts.iter().enumerate() {
            let is_new = |(i, groove)| grooves.contains(groove) && !layout[..i].contains(groove);
            require(
                !layout.is_empty() && layout.iter().enumerate().all(is_new),
                &format!("layouts[{i}]"),
                || format!("{layout:?}"),
                format!("must be a list of different grooves from 1 to {}", published::GROOVES),
                "list each occupied groove once",
            )?;
        }
        require(
            self.max_rows() <= MAX_ROWS,
            "repetitions",
            || format!("{:?}", self.repetitions),
            format!("the plan makes up to {} rows, at most {MAX_ROWS} are possible", self.max_rows()),
            "give fewer repetitions, weights or layouts",
        )?;
        require(
            self.silicone || !self.layouts.is_empty(),
            "layouts",
            || "[]".to_owned(),
            "must not be empty without silicone",
            "add a layout, or set silicone = true",
        )
    }
}

fn check_noise(n: &NoisePlan) -> Result<(), Diagnostic> {
    let standard_deviations = [
        ("noise.repetition_N", n.repetition_n),
        ("noise.repetition_per_load", n.repetition_per_load),
        ("noise.series_N", n.series_n),
        ("noise.series_per_load", n.series_per_load),
        ("noise.outlier_N", n.outlier_n),
    ];
    require_all_within(standard_deviations, &(0.0..=MAX_VALUE), "give a standard deviation")?;
    require_within(
        "noise.autocorrelation",
        n.autocorrelation,
        0.0..=MAX_CORRELATION,
        "give 0 for independent repetitions",
    )?;
    require_within("noise.uneven", n.uneven, 0.0..=2.0, "give 0 for the same noise in every series")?;
    require(
        n.mislabelled_series <= MAX_COUNT,
        "noise.mislabelled_series",
        || n.mislabelled_series.to_string(),
        format!("must be at most {MAX_COUNT}"),
        "give a number of series",
    )?;
    let shares = [("noise.outlier_share", n.outlier_share), ("noise.lost_share", n.lost_share)];
    require_all_within(shares, &(0.0..=MAX_SHARE), "give a share of the rows")
}

/// Checks the differences between series and between mounts, and the resolution of the load cell.
fn check_random_effects(n: &NoisePlan) -> Result<(), Diagnostic> {
    let scales = [("noise.series_scale", n.series_scale), ("noise.mount_scale", n.mount_scale)];
    require_all_within(scales, &(0.0..=0.5), "give the relative scatter of friction, such as 0.02")?;
    let sizes = [
        ("noise.series_common_N", n.series_common_n),
        ("noise.series_common_per_load", n.series_common_per_load),
        ("noise.resolution_N", n.resolution_n),
    ];
    require_all_within(sizes, &(0.0..=10.0), "give 0 to leave it out")?;
    require_within("noise.series_walk", n.series_walk, 0.0..=MAX_CORRELATION, "give 0 for independent series")
}

fn check_disturbance(index: usize, d: &Disturbance) -> Result<(), Diagnostic> {
    let field = |name: &str| format!("disturbances[{index}].{name}");
    require_within(&field("size"), d.size, -1000.0..=1000.0, "give a share of friction, or newtons")?;
    for (name, value) in d.kind.numbers() {
        let help = "give a finite number";
        require_within(&field(&format!("kind.{name}")), value, -MAX_VALUE..=MAX_VALUE, help)?;
    }
    for (name, value) in d.kind.divisors() {
        require(
            value > 0.0,
            &field(&format!("kind.{name}")),
            || value.to_string(),
            "must be above 0",
            "give a width or a speed",
        )?;
    }
    match &d.kind {
        DisturbanceKind::Memory { repetitions } => require_within(
            &field("kind.memory.repetitions"),
            *repetitions,
            0.1..=MAX_VALUE,
            "give the repetitions after which a share of 1/e is left",
        ),
        DisturbanceKind::Swap { at, silicone } => {
            require_within(&field("kind.swap.at"), *at, 0.0..=1.0, "give a share of the session")?;
            let help = "give the share by which friction changes";
            require_within(&field("kind.swap.silicone"), *silicone, -0.9..=10.0, help)
        }
        DisturbanceKind::Operators { .. } => require(
            matches!(d.target, DisturbanceTarget::Reading),
            &field("target"),
            || format!("\"{:?}\"", d.target).to_lowercase(),
            "operators change the reading only",
            "set target = \"reading\"",
        ),
        _ => Ok(()),
    }
}

fn check_raw(r: &RawPlan) -> Result<(), Diagnostic> {
    let help = "give the samples per second, such as 200";
    require_within("raw.sample_rate_hz", r.sample_rate_hz, 20.0..=10_000.0, help)?;
    let shares = [
        ("raw.spike_share", r.spike_share),
        ("raw.lost_share", r.lost_share),
        ("raw.odd_speed_share", r.odd_speed_share),
        ("raw.missing_share", r.missing_share),
    ];
    require_all_within(shares, &(0.0..=MAX_SHARE), "give a share of samples or logs")?;
    let sizes = [("raw.sample_N", r.sample_n), ("raw.jitter_s", r.jitter_s)];
    require_all_within(sizes, &(0.0..=MAX_VALUE), "give a standard deviation")
}

/// Checks that an effect is in the vocabulary, has valid constants, and a form that the twin knows.
fn check_effect(index: usize, planned: &EffectPlan, vocabulary: &Vocabulary) -> Result<(), Diagnostic> {
    let at = |name: &str, value: String| Location::field(format!("effects[{index}].{name}"), value);
    let id = || format!("\"{}\"", planned.id);
    let Some(effect) = vocabulary.named(&planned.id) else {
        return Err(vocabulary.unknown(&planned.id).with_location(at("id", id())));
    };
    let names: Vec<&str> = effect.parameters().iter().map(|p| &*p.name).collect();
    let needed = effect.parameters().iter().filter(|p| p.otherwise.is_none()).count();
    if !(needed..=names.len()).contains(&planned.values.len()) {
        let (names, optional) = names.split_at(needed);
        let needed = pluralise(names.len(), "value");
        let location = match planned.values.as_slice() {
            [] => at("id", id()),
            values => at("values", format!("{values:?}")),
        };
        let problem = format!("{} needs {needed} ({})", effect.id(), names.join(", "));
        return Err(Diagnostic::new(
            codes::PLAN_OF_RIG_INCONSISTENT,
            format!("{problem}, found {}", planned.values.len()),
        )
        .with_location(location)
        .with_help(match optional {
            [] => "give its constants in this order".to_owned(),
            _ => format!("give its constants in this order; {} may follow", optional.join(", ")),
        }));
    }
    for (i, value) in planned.values.iter().enumerate() {
        if let Some(problem) = constant_problem(&*effect, i, *value) {
            return Err(Diagnostic::new(codes::OUT_OF_RANGE, problem)
                .with_location(at(&format!("values[{i}]"), value.to_string()))
                .with_help("see model/doc/effect-catalogue.md for typical values"));
        }
    }
    let forms = forms_of(&planned.id);
    let last = forms.len() - 1;
    require(
        usize::from(planned.form) <= last,
        &format!("effects[{index}].form"),
        || planned.form.to_string(),
        format!("must be from 0 to {last}: {}", forms.join("; ")),
        "give 0 for the form of model/doc/effect-catalogue.md",
    )
}

/// Returns why the effect cannot have this value of its constant number `index`.
fn constant_problem(effect: &dyn Effect, index: usize, value: f64) -> Option<String> {
    let parameter = effect.parameters().get(index)?;
    let name = &parameter.name;
    if let Some((low, high)) = parameter.bounds.filter(|(low, high)| !(*low..=*high).contains(&value)) {
        return Some(format!("{name} must be from {low} to {high}"));
    }
    if index == 0 && effect.description().one_sided && value < 0.0 {
        return Some(format!("{name} must not be negative: the effect has one sign"));
    }
    let is_finite = value.abs() <= MAX_VALUE;
    (!is_finite).then(|| format!("{name} must be from -{MAX_VALUE} to {MAX_VALUE}"))
}

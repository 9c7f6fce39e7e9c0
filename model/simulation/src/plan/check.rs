//! Whether a plan can be run: every field within its bounds.

use pinswitch_calibration::effects::{Effect, Vocabulary};
use pinswitch_friction::published;

use super::error::PlanError;
use super::noise::NoisePlan;
use super::raw::RawPlan;
use super::rig_plan::{EffectPlan, Plan, Protocol};
use crate::disturbance::{Course, Disturbance, DisturbanceTarget};
use crate::effect_forms::forms_of;

/// Largest weight in grams, speed in percent, dwell in seconds, force in newtons and constant of an effect: far above any.
const MAX_VALUE: f64 = 1e6;
/// Largest friction coefficient.
const MAX_FRICTION: f64 = 10.0;
/// Most rows that a plan may make: a thousand times the paper's.
const MAX_ROWS: usize = 1_000_000;

/// A field out of its bounds, before it is known which file it stands in.
struct Fault {
    field: &'static str,
    value: String,
    bound: &'static str,
    remedy: &'static str,
}

/// `Err` with the fault unless `holds`.
fn require(
    holds: bool,
    field: &'static str,
    value: impl FnOnce() -> String,
    bound: &'static str,
    remedy: &'static str,
) -> Result<(), Fault> {
    if holds { Ok(()) } else { Err(Fault { field, value: value(), bound, remedy }) }
}

impl Plan {
    /// Checks every field. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`PlanError`] at the first field that cannot be used.
    pub fn check(&self, file: &str) -> Result<(), PlanError> {
        self.check_series()
            .and_then(|()| self.check_constants())
            .and_then(|()| check_noise(&self.noise))
            .and_then(|()| check_scatter(&self.noise))
            .and_then(|()| check_raw(&self.raw))
            .and_then(|()| self.disturbances.iter().try_for_each(check_disturbance))
            .map_err(|Fault { field, value, bound, remedy }| PlanError::Bound {
                file: file.to_owned(),
                field,
                value,
                bound,
                remedy,
            })?;
        self.effects.iter().try_for_each(|effect| check_effect(effect, &self.vocabulary, file))
    }

    /// Rows that the plan makes at most.
    fn most_rows(&self) -> usize {
        let conditions = self.layouts.len().saturating_mul(2).saturating_add(1);
        let repetitions: u32 = self.repetitions.iter().map(|mean| mean + self.repetitions_spread).sum();
        // Loads go up and down.
        [2, self.weights_g.len(), repetitions as usize].into_iter().fold(conditions, usize::saturating_mul)
    }

    /// Constants, effects and what nobody has named: numbers that a reading survives.
    fn check_constants(&self) -> Result<(), Fault> {
        let c = &self.constants;
        require(
            [c.mu_p, c.mu_s].iter().all(|mu| (0.0..=MAX_FRICTION).contains(mu)),
            "constants",
            || format!("mu_p {}, mu_s {}", c.mu_p, c.mu_s),
            "0..10",
            "leave them out for the paper's",
        )?;
        require(
            c.half_load_factor.iter().chain(&c.steepness).all(|v| *v > 0.0 && *v <= 1000.0),
            "constants",
            || format!("half_load_factor {:?}, steepness {:?}", c.half_load_factor, c.steepness),
            "0 < value <= 1000",
            "leave them out for the paper's",
        )?;
        require(
            self.effects.iter().flat_map(|effect| &effect.values).all(|v| v.abs() <= MAX_VALUE),
            "effects",
            || format!("{:?}", self.effects.iter().map(|effect| &effect.values).collect::<Vec<_>>()),
            "-1000000..1000000",
            "model/doc/effect-catalogue.md gives the usual sizes",
        )?;
        let is_course = |d: &Disturbance| {
            let (numbers, widths) = d.numbers();
            numbers.iter().chain([&d.size]).all(|v| v.abs() <= MAX_VALUE) && widths.iter().all(|v| *v > 0.0)
        };
        require(
            self.disturbances.iter().all(is_course),
            "disturbances",
            || format!("{:?}", self.disturbances),
            "-1000000..1000000, and above 0 for a width",
            "give a size as a share of friction, or newtons",
        )
    }

    fn check_series(&self) -> Result<(), Fault> {
        for (field, values) in
            [("weights_g", &self.weights_g), ("speeds_pct", &self.speeds_pct), ("dwells_s", &self.dwells_s)]
        {
            let positive = !values.is_empty() && values.iter().all(|v| *v > 0.0 && *v <= MAX_VALUE);
            require(
                positive && values.len() <= 1000,
                field,
                || format!("{values:?}"),
                "1 to 1000 numbers above 0, up to 1000000",
                "list the values to run",
            )?;
        }
        require(
            self.wrap_angle_deg >= 1.0 && self.wrap_angle_deg <= 720.0,
            "wrap_angle_deg",
            || self.wrap_angle_deg.to_string(),
            "1..720",
            "the paper's is 63.89 degrees",
        )?;
        require(
            !self.shuffled || self.protocol == Protocol::Randomised,
            "shuffled",
            || "true".to_owned(),
            "false in the paper's protocol",
            "set protocol = \"randomised\"",
        )?;
        require(
            self.repetitions.iter().all(|r| (1..=1000).contains(r)),
            "repetitions",
            || format!("{:?}", self.repetitions),
            "1..1000",
            "give two counts",
        )?;
        require(
            self.repetitions_spread <= 1000,
            "repetitions_spread",
            || self.repetitions_spread.to_string(),
            "0..1000",
            "0 gives every series the same",
        )?;
        let grooves = 1..=published::GROOVES;
        let is_layout = |layout: &Vec<usize>| {
            let once = |(i, groove)| grooves.contains(groove) && !layout[..i].contains(groove);
            !layout.is_empty() && layout.iter().enumerate().all(once)
        };
        require(
            self.layouts.iter().all(is_layout),
            "layouts",
            || format!("{:?}", self.layouts),
            "lists of grooves 1..15",
            "name each occupied groove once",
        )?;
        require(
            self.most_rows() <= MAX_ROWS,
            "layouts, weights_g and repetitions",
            || format!("{} rows", self.most_rows()),
            "1..1000000 rows",
            "give fewer of one of them",
        )?;
        require(
            self.silicone || !self.layouts.is_empty(),
            "layouts",
            || "[]".to_owned(),
            "at least one",
            "measure silicone or a layout",
        )
    }
}

fn check_noise(n: &NoisePlan) -> Result<(), Fault> {
    let sizes = [n.repetition_n, n.repetition_per_load, n.series_n, n.series_per_load, n.outlier_n];
    require(
        sizes.iter().all(|v| (0.0..=MAX_VALUE).contains(v)),
        "noise",
        || format!("{sizes:?}"),
        "0..1000000",
        "give standard deviations",
    )?;
    require(
        (0.0..=0.99).contains(&n.autocorrelation) && (0.0..=2.0).contains(&n.uneven),
        "noise",
        || format!("autocorrelation {}, uneven {}", n.autocorrelation, n.uneven),
        "0..0.99 and 0..2",
        "0 is neither",
    )?;
    require(
        n.mislabelled_series <= 1000,
        "noise.mislabelled_series",
        || n.mislabelled_series.to_string(),
        "0..1000",
        "count series",
    )?;
    require(
        [n.outlier_share, n.lost_share].iter().all(|v| (0.0..=0.9).contains(v)),
        "noise shares",
        || format!("{} and {}", n.outlier_share, n.lost_share),
        "0..0.9",
        "give shares of the rows",
    )
}

/// What differs between series and mounts, and the step of the cell.
fn check_scatter(n: &NoisePlan) -> Result<(), Fault> {
    let scales = [("noise.series_scale", n.series_scale), ("noise.mount_scale", n.mount_scale)];
    for (field, value) in scales {
        let remedy = "give the share by which friction scatters, as 0.02";
        require((0.0..=0.5).contains(&value), field, || value.to_string(), "0..0.5", remedy)?;
    }
    let sizes = [
        ("noise.series_common_N", n.series_common_n),
        ("noise.series_common_per_load", n.series_common_per_load),
        ("noise.resolution_N", n.resolution_n),
    ];
    for (field, value) in sizes {
        let remedy = "0 leaves it out";
        require((0.0..=10.0).contains(&value), field, || value.to_string(), "0..10", remedy)?;
    }
    let walk = n.series_walk;
    let remedy = "0 is no correlation";
    require((0.0..=0.99).contains(&walk), "noise.series_walk", || walk.to_string(), "0..0.99", remedy)
}

fn check_disturbance(d: &Disturbance) -> Result<(), Fault> {
    let size = "give a share of friction, or newtons";
    require(d.size.abs() <= 1e3, "disturbances: size", || d.size.to_string(), "-1000..1000", size)?;
    match &d.kind {
        Course::Memory { repetitions } => require(
            (0.1..=1e6).contains(repetitions),
            "disturbances: memory.repetitions",
            || repetitions.to_string(),
            "0.1..1e6",
            "give the repetitions after which about a third is left",
        ),
        Course::Swap { at, silicone } => require(
            (0.0..=1.0).contains(at) && (-0.9..=10.0).contains(silicone),
            "disturbances: swap",
            || format!("at {at}, silicone {silicone}"),
            "at 0..1 and silicone -0.9..10",
            "give a share of the session and a share of friction",
        ),
        Course::Operators { .. } => require(
            matches!(d.target, DisturbanceTarget::Reading),
            "disturbances: target",
            || format!("{:?}", d.target).to_lowercase(),
            "what an operator does",
            "set target = \"reading\"",
        ),
        _ => Ok(()),
    }
}

fn check_raw(r: &RawPlan) -> Result<(), Fault> {
    require(
        (20.0..=10_000.0).contains(&r.sample_rate_hz),
        "raw.sample_rate_hz",
        || r.sample_rate_hz.to_string(),
        "20..10000",
        "the rig has 200",
    )?;
    let shares = [r.spike_share, r.lost_share, r.odd_speed_share, r.missing_share];
    require(
        shares.iter().all(|v| (0.0..=0.9).contains(v)),
        "raw shares",
        || format!("{shares:?}"),
        "0..0.9",
        "give shares of samples and logs",
    )?;
    require(
        [r.sample_n, r.jitter_s].iter().all(|v| (0.0..=MAX_VALUE).contains(v)),
        "raw",
        || format!("sample_N {}, jitter_s {}", r.sample_n, r.jitter_s),
        "0..1000000",
        "give standard deviations",
    )
}

/// Whether an effect is in the vocabulary, with as many constants as it needs, in a form that the twin has.
fn check_effect(planned: &EffectPlan, vocabulary: &Vocabulary, file: &str) -> Result<(), PlanError> {
    let effect_error = |remedy: String| PlanError::Effect {
        file: file.to_owned(),
        id: planned.id.clone(),
        found: planned.values.len(),
        remedy,
    };
    let remedy = match vocabulary.named(&planned.id) {
        Some(effect) if effect.parameters().len() == planned.values.len() => {
            if let Some(problem) = out_of_bounds(effect, &planned.values) {
                return Err(effect_error(problem));
            }
            let forms = forms_of(&planned.id);
            if usize::from(planned.form) < forms.len() {
                return Ok(());
            }
            let last = forms.len() - 1;
            format!("form {} is unknown, it has 0 to {last}: {}", planned.form, forms.join("; "))
        }
        Some(effect) => {
            let names: Vec<&str> = effect.parameters().iter().map(|p| p.name).collect();
            format!("it needs {} value(s): {}", names.len(), names.join(", "))
        }
        None => vocabulary.unknown(&planned.id),
    };
    Err(effect_error(remedy))
}

/// The first value that the effect cannot have.
fn out_of_bounds(effect: &dyn Effect, values: &[f64]) -> Option<String> {
    let told = effect.parameters().iter().zip(values);
    for (i, (parameter, value)) in told.enumerate() {
        let name = parameter.name;
        if let Some((low, high)) = parameter.bounds.filter(|(low, high)| !(*low..=*high).contains(value)) {
            return Some(format!("{name} = {value} is outside {low} to {high}"));
        }
        if i == 0 && effect.description().one_sided && *value < 0.0 {
            return Some(format!("{name} = {value} is below 0, which this effect cannot be"));
        }
    }
    None
}

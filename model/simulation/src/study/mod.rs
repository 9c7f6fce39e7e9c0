//! The study of the calibrator: rigs of every kind with sizes, forms and noise drawn, and what it says of them.

mod cases;
mod outcome;

use std::collections::BTreeMap;

pub use cases::{Case, Truth, plan_of, study_cases};
pub use outcome::{CaseOutcome, run_case};

use pinswitch_calibration::median;

/// Results by case.
///
/// ```
/// use pinswitch_calibration::inference::Levels;
/// use pinswitch_simulation::{Study, run_case, study_cases};
///
/// let case = study_cases().into_iter().find(|c| c.name == "load_cell_gain").ok_or("not a case")?;
/// let outcome = run_case(&case, 1, Levels::default()).ok_or("the table reads back")?;
/// assert!(outcome.honest, "{:?}", outcome.named);
/// let mut study = Study::default();
/// study.add(case, vec![outcome]);
/// assert!(study.table().contains("load_cell_gain"));
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Study {
    outcomes: Vec<(Case, Vec<CaseOutcome>)>,
}

/// Percentage of the outcomes for which something holds, with their number.
fn share(outcomes: &[&CaseOutcome], holds: impl Fn(&CaseOutcome) -> bool) -> String {
    let count = outcomes.iter().filter(|o| holds(o)).count();
    format!("{count} of {} ({:.1} %)", outcomes.len(), 100.0 * count as f64 / outcomes.len().max(1) as f64)
}

impl Study {
    /// Adds the outcomes of a case.
    pub fn add(&mut self, case: Case, outcomes: Vec<CaseOutcome>) {
        self.outcomes.push((case, outcomes));
    }

    /// The confusion matrix by case, in Markdown.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "| protocol | rig | sets | right | honest | error after/before | intervals that hold | said instead |\n|---|---|---|---|---|---|---|---|\n",
        );
        for (case, outcomes) in &self.outcomes {
            let exact = outcomes.iter().filter(|o| o.exact).count();
            let honest = outcomes.iter().filter(|o| o.exact || o.honest).count();
            let mut other: BTreeMap<String, usize> = BTreeMap::new();
            for o in outcomes.iter().filter(|o| !o.exact) {
                let said = if o.named.is_empty() { "none".to_owned() } else { o.named.join(" + ") };
                *other.entry(said).or_default() += 1;
            }
            let other: Vec<String> = other.into_iter().map(|(said, k)| format!("{said} ({k})")).collect();
            text.push_str(&format!(
                "| {} | {} | {} | {exact} | {honest} | {:.3} | {} | {} |\n",
                format!("{:?}", case.protocol).to_lowercase(),
                case.name,
                outcomes.len(),
                median_ratio(outcomes.iter()),
                held(outcomes),
                other.join("; ").replace('|', " or ")
            ));
        }
        text
    }

    /// The figures that a calibrator is judged by, in words.
    pub fn summary(&self) -> String {
        let of = |wanted: fn(&Truth) -> bool| -> Vec<&CaseOutcome> {
            self.outcomes.iter().filter(|(c, _)| wanted(&c.truth)).flat_map(|(_, o)| o).collect()
        };
        let nulls = of(|t| *t == Truth::Nothing);
        let singles = of(|t| matches!(t, Truth::Effects(ids) if ids.len() == 1));
        let pairs = of(|t| matches!(t, Truth::Effects(ids) if ids.len() > 1));
        let confounded = of(|t| matches!(t, Truth::Confounded(_)));
        let outside = of(|t| matches!(t, Truth::Outside(_)));
        let all: Vec<bool> =
            self.outcomes.iter().flat_map(|(_, o)| o).flat_map(|o| o.covered.clone()).collect();
        let mut lines = vec![
            format!("rigs without effect: an alarm in {}", share(&nulls, |o| !o.exact)),
            format!("their probabilities by chance: {}", calibration_of_p(&nulls)),
            format!("single effects named exactly: {}", share(&singles, |o| o.exact)),
            format!("single effects named or among the rivals: {}", share(&singles, |o| o.honest)),
            format!("confounded designs called ambiguous: {}", share(&confounded, |o| o.exact)),
            format!("pairs named exactly: {}", share(&pairs, |o| o.exact)),
            format!("pairs named or among the rivals: {}", share(&pairs, |o| o.honest)),
            format!(
                "outside the vocabulary, unattributed with the right covariate: {}",
                share(&outside, |o| o.honest)
            ),
            format!("outside the vocabulary, no name beside it: {}", share(&outside, |o| o.exact)),
        ];
        lines.push(format!(
            "error on fresh rows after/before, median over the singles: {:.3}",
            median_ratio(singles.iter().copied())
        ));
        lines.push(format!(
            "95 % intervals that hold the true size: {} of {}",
            all.iter().filter(|c| **c).count(),
            all.len()
        ));
        lines.iter().map(|l| format!("- {l}\n")).collect()
    }
}

/// How many of the intervals hold the truth; empty without any.
fn held(outcomes: &[CaseOutcome]) -> String {
    let all: Vec<bool> = outcomes.iter().flat_map(|o| o.covered.clone()).collect();
    if all.is_empty() {
        return String::new();
    }
    format!("{} of {}", all.iter().filter(|c| **c).count(), all.len())
}

/// How often the probability of the largest gain falls below some levels; it should as often as the level says.
fn calibration_of_p(nulls: &[&CaseOutcome]) -> String {
    let below = |level: f64| {
        let count = nulls.iter().filter(|o| o.p_value < level).count();
        format!("below {level} in {:.1} %", 100.0 * count as f64 / nulls.len().max(1) as f64)
    };
    [0.5, 0.2, 0.1, 0.05, 0.02].map(below).join(", ")
}

/// Median of the error after over the error before on fresh rows.
fn median_ratio<'a>(outcomes: impl Iterator<Item = &'a CaseOutcome>) -> f64 {
    let mut ratios: Vec<f64> = outcomes.map(|o| o.fresh_n[1] / o.fresh_n[0].max(1e-9)).collect();
    if ratios.is_empty() { f64::NAN } else { median(&mut ratios) }
}

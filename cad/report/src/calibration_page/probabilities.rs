//! Probabilities of all effects and structures, as bars.

use std::collections::BTreeSet;
use std::fmt::Write;

use pinswitch_calibration::{EffectReport, Fate, Report, RivalReport};
use pinswitch_friction::sort_by_number;

use super::super::effect_words::structure_name;
use super::super::html::escape;
use super::number::probability;

/// One bar.
struct Bar<'a> {
    name: &'a str,
    probability: f64,
    outcome: &'static str,
    class: &'static str,
}

/// Returns the section: reported effects with their rivals, then the others.
pub(super) fn probabilities(report: &Report) -> String {
    let mut html = "<h2>1. Probabilities</h2><p>Posterior probability that each effect acts on this rig, and that structure \
                    without a name acts. An effect that is not identifiable may have its prior probability. Rivals follow the effect whose place they \
                    may take.</p>\n\
                    <div class=\"wide\"><table class=\"bars\"><tr><th>effect</th><th></th><th>probability</th><th>outcome</th></tr>\n"
        .to_owned();
    let mut shown: BTreeSet<&str> = BTreeSet::new();
    for effect in &report.effects {
        for bar in group(effect) {
            if shown.insert(bar.name) || bar.class == "rival" {
                html.push_str(&row(&bar));
            }
        }
    }
    let mut others: Vec<Bar<'_>> = Vec::new();
    for candidate in report.candidates.iter().filter(|candidate| !shown.contains(candidate.id.as_str())) {
        let (class, outcome) = match candidate.fate {
            Fate::Kept => ("", "in the model, not reported"),
            Fate::Rival => ("rival", "rival"),
            Fate::Excluded => ("soft", "excluded"),
            Fate::Open => ("", "not excluded"),
            Fate::Invisible => ("soft", "not identifiable"),
        };
        others.push(Bar { name: &candidate.id, probability: candidate.probability, outcome, class });
    }
    for structure in report.structures.iter().filter(|s| !shown.contains(s.name.as_str())) {
        others.push(Bar {
            name: &structure.name,
            probability: structure.probability,
            outcome: "structure without a name",
            class: "",
        });
    }
    sort_by_number(&mut others, |bar| -bar.probability);
    others.iter().for_each(|bar| html.push_str(&row(bar)));
    html.push_str("</table></div>\n");
    html
}

/// Returns the bars of a reported effect and of its rivals.
fn group(effect: &EffectReport) -> Vec<Bar<'_>> {
    let name = structure_name(effect).unwrap_or(&effect.id);
    let own = Bar { name, probability: effect.probability, outcome: "reported", class: "selected" };
    fn rival(rival: &RivalReport) -> Bar<'_> {
        Bar { name: &rival.id, probability: rival.probability, outcome: "rival", class: "rival" }
    }
    std::iter::once(own).chain(effect.rivals.iter().map(rival)).collect()
}

fn row(bar: &Bar<'_>) -> String {
    let mut html = String::new();
    let name = if bar.class == "rival" { format!("or {}", escape(bar.name)) } else { escape(bar.name) };
    let width = if bar.probability.is_finite() { 100.0 * bar.probability.clamp(0.0, 1.0) } else { 0.0 };
    let _ = writeln!(
        html,
        "<tr class=\"{}\"><td>{name}</td><td class=\"bar\"><svg viewBox=\"0 0 100 10\" preserveAspectRatio=\"none\" \
         aria-hidden=\"true\"><rect class=\"track\" width=\"100\" height=\"10\"/><rect width=\"{width:.1}\" height=\"10\"/></svg></td>\
         <td class=\"n\">{}</td><td>{}</td></tr>",
        bar.class,
        probability(bar.probability),
        bar.outcome
    );
    html
}

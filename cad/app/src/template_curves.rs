//! The curves of the templates, for their pictures on the page.

use pinswitch_friction::Transition;
use pinswitch_switch::config::{Configuration, read};
use pinswitch_switch::feasibility;
use pinswitch_switch::prediction::predicted_curve;
use pinswitch_switch::templates::{TEMPLATES, TemplateKind};
use serde::Serialize;

/// Points of a curve: enough for a picture of the size of a thumb.
const POINTS: usize = 26;

/// A template with its curve.
#[derive(Debug, Serialize)]
pub(crate) struct TemplateCurve {
    name: &'static str,
    load_n: Vec<f64>,
    friction_n: Vec<f64>,
    /// Load at which it switches; `None` if it does not within the range of the curve.
    threshold_n: Option<f64>,
}

/// Predicts the curve of every template that is a switch.
pub(crate) fn answer() -> Vec<TemplateCurve> {
    let switches = TEMPLATES.iter().filter(|template| template.kind == TemplateKind::Published);
    let curve = |name, mut configuration: Configuration| {
        configuration.friction.points = POINTS;
        let design = feasibility::design(configuration).ok()?;
        let curve = predicted_curve(&design);
        Some(TemplateCurve {
            name,
            threshold_n: Transition::of(&curve).map(|transition| transition.threshold_n),
            load_n: curve.load_n,
            friction_n: curve.friction_n,
        })
    };
    switches.filter_map(|template| curve(template.name, read(template.text, template.name).ok()?.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_switch_has_a_curve() {
        let curves = answer();
        let switches = TEMPLATES.iter().filter(|template| template.kind == TemplateKind::Published);
        assert_eq!(curves.len(), switches.count());
        let of = |name: &str| curves.iter().find(|curve| curve.name == name).unwrap();
        let three_double = of("three-double");
        assert_eq!((three_double.load_n.len(), three_double.friction_n.len()), (POINTS, POINTS));
        assert!(three_double.threshold_n.is_some() && of("silicone-only").threshold_n.is_none());
    }
}

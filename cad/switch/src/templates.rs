//! The configurations that ship with the program.

use crate::config::reference_toml;

pub use pinswitch_templates::{EXAMPLES, RIGS, TEMPLATES, Template, TemplateKind};

/// Returns the text of the template called `name`; `reference` shows every parameter.
pub fn text(name: &str) -> Option<String> {
    if name == "reference" {
        return Some(reference_toml());
    }
    TEMPLATES.iter().find(|t| t.name == name).map(|t| t.text.to_owned())
}

/// Returns all names that [`text`] accepts.
pub fn names() -> Vec<&'static str> {
    TEMPLATES.iter().map(|t| t.name).chain(["reference"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::read;
    use crate::design::Design;
    use pinswitch_friction::{PredictionStatus, predict, published};

    #[test]
    fn every_template_can_be_built() {
        for name in names() {
            let (configuration, _) = read(&text(name).unwrap(), name).unwrap();
            Design::new(configuration).unwrap();
        }
    }

    #[test]
    fn the_seven_conditions_are_published_ones() {
        let conditions: Vec<_> = TEMPLATES.iter().filter(|t| t.kind == TemplateKind::Published).collect();
        assert_eq!(conditions.len(), 7);
        for template in conditions {
            let (configuration, _) = read(template.text, template.name).unwrap();
            assert_eq!(configuration.switch.name.as_str(), template.name);
            let design = Design::new(configuration).unwrap();
            let curve = predict(design.contact(), &[published::heaviest_load_n()]);
            assert_eq!(curve.status, PredictionStatus::Published, "{}: {:?}", template.name, curve.reasons);
        }
    }

    #[test]
    fn reference_file_is_up_to_date() {
        assert_eq!(pinswitch_templates::REFERENCE, reference_toml());
    }
}

//! The configurations that ship with the program, embedded so that they work anywhere.

use crate::config::reference_toml;

/// What a template is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemplateKind {
    /// One of the paper's seven conditions.
    Published,
    /// Settings of a printer, to lie under a layout.
    Printer,
}

/// A shipped configuration.
#[derive(Clone, Copy, Debug)]
pub struct Template {
    /// Its name, without ending.
    pub name: &'static str,
    /// What it is for.
    pub kind: TemplateKind,
    /// Its text; the first line says what it is.
    pub text: &'static str,
}

macro_rules! template {
    ($kind:ident, $name:literal) => {
        Template {
            name: $name,
            kind: TemplateKind::$kind,
            text: include_str!(concat!("../../../templates/", $name, ".toml")),
        }
    };
}

/// All templates but the reference, which is written from the parameters.
pub const TEMPLATES: [Template; 10] = [
    template!(Published, "six-single"),
    template!(Published, "three-double"),
    template!(Published, "three-single"),
    template!(Published, "silicone-only"),
    template!(Published, "proxy-six-single"),
    template!(Published, "proxy-three-double"),
    template!(Published, "proxy-three-single"),
    template!(Printer, "printer-fff-0.4"),
    template!(Printer, "printer-fff-0.25"),
    template!(Printer, "printer-dimension-elite"),
];

impl Template {
    /// The template's one-line description.
    pub fn description(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches("# ")
    }
}

/// Files of other kinds that a user may have to write, by name: each explains itself and is accepted as it stands.
pub const STARTERS: [(&str, &str); 5] = [
    ("sweep", include_str!("../../../templates/batch/sweep.toml")),
    ("effects", include_str!("../../../templates/rig/effects.toml")),
    ("plan", include_str!("../../../templates/rig/plan.toml")),
    ("run", include_str!("../../../templates/rig/run.toml")),
    ("rig", include_str!("../../../templates/rig/rig.toml")),
];

/// The text of the template called `name`; `reference` shows every parameter.
pub fn text(name: &str) -> Option<String> {
    if name == "reference" {
        return Some(reference_toml());
    }
    TEMPLATES.iter().find(|t| t.name == name).map(|t| t.text.to_owned())
}

/// All names that [`text`] knows.
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
    fn the_reference_file_is_up_to_date() {
        assert_eq!(include_str!("../../../templates/reference.toml"), reference_toml());
    }
}

//! What the page needs once: every field with its control, templates, formats.

use pinswitch_switch::config::read;
use pinswitch_switch::formats::page::{Field, Values, changed_values, fields};
use pinswitch_switch::formats::{FORMATS, Inclusion};
use pinswitch_switch::templates::{TEMPLATES, TemplateKind};
use serde::Serialize;

use crate::calibration::MAX_TABLE_MB;

/// The answer to `facts`.
#[derive(Debug, Serialize)]
pub(crate) struct Facts {
    generator: String,
    fields: Vec<Field>,
    templates: Vec<TemplateFact>,
    formats: Vec<FormatFact>,
    /// Largest accepted table of plateaus, in megabytes.
    largest_table_mb: usize,
}

#[derive(Debug, Serialize)]
struct TemplateFact {
    name: &'static str,
    kind: &'static str,
    about: &'static str,
    values: Values,
}

#[derive(Debug, Serialize)]
struct FormatFact {
    name: &'static str,
    about: &'static str,
    /// Whether a set contains it by default.
    default: bool,
}

/// Collects the facts from the tables of parameters, templates and formats.
pub(crate) fn facts() -> Facts {
    Facts {
        generator: concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned(),
        fields: fields(),
        templates: TEMPLATES
            .iter()
            .filter_map(|template| {
                let (configuration, _) = read(template.text, template.name).ok()?;
                Some(TemplateFact {
                    name: template.name,
                    kind: match template.kind {
                        TemplateKind::Published => "published",
                        TemplateKind::Printer => "printer",
                    },
                    about: template.description(),
                    values: changed_values(&configuration),
                })
            })
            .collect(),
        formats: FORMATS
            .iter()
            .filter(|format| format.inclusion != Inclusion::Always)
            .map(|format| FormatFact {
                name: format.name,
                about: format.about,
                default: format.inclusion == Inclusion::Default,
            })
            .collect(),
        largest_table_mb: MAX_TABLE_MB,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_and_formats_are_listed() {
        let facts = facts();
        assert_eq!(facts.templates.len(), TEMPLATES.len());
        assert!(facts.formats.iter().any(|f| f.name == "step" && !f.default));
    }
}

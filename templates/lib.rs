//! The files that ship with pinswitch, embedded so that they work without a checkout: configurations of the paper's
//! conditions, printer presets, and one commented example of every other file that a person writes.
//!
//! ```
//! let template = pinswitch_templates::TEMPLATES.iter().find(|t| t.name == "three-double").ok_or("not found")?;
//! assert!(template.text.contains("[layout]"));
//! # Ok::<(), &str>(())
//! ```

/// Purpose of a template.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemplateKind {
    /// One of the paper's seven conditions.
    Published,
    /// Settings of a printer, used as a preset under a layout.
    Printer,
}

/// A shipped configuration.
#[derive(Clone, Copy, Debug)]
pub struct Template {
    /// Name without ending.
    pub name: &'static str,
    /// Purpose.
    pub kind: TemplateKind,
    /// TOML text; its first line is a comment that describes it.
    pub text: &'static str,
}

impl Template {
    /// Returns the description on the template's first line.
    pub fn description(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches("# ")
    }
}

macro_rules! template {
    ($kind:ident, $name:literal) => {
        Template { name: $name, kind: TemplateKind::$kind, text: include_str!(concat!($name, ".toml")) }
    };
}

/// All configurations but the reference, which is generated from the parameters.
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

/// Example files of other kinds, by the name that `pinswitch init` takes; each explains its keys and is valid unchanged.
pub const EXAMPLES: [(&str, &str); 9] = [
    ("sweep", include_str!("batch/sweep.toml")),
    ("configurations", include_str!("batch/configurations.csv")),
    ("effects", include_str!("rig/effects.toml")),
    ("plan", include_str!("rig/plan.toml")),
    ("run", include_str!("rig/run.toml")),
    ("rig", include_str!("rig/rig.toml")),
    ("import", include_str!("rig/import.toml")),
    ("measured", include_str!("rig/measured.toml")),
    ("request", include_str!("requests/gripper.toml")),
];

/// Rigs without a switch, by the word that `pinswitch init rig --kind` takes, in the format of the example `rig`.
pub const RIGS: [(&str, &str); 4] = [
    ("capstan", include_str!("rig/rig-capstan.toml")),
    ("bowden", include_str!("rig/rig-bowden.toml")),
    ("cable-machine", include_str!("rig/rig-cable-machine.toml")),
    ("geared-drive", include_str!("rig/rig-geared-drive.toml")),
];

/// The reference configuration: every parameter with its unit, range, default and reason. A test in the crate that knows
/// the parameters keeps it up to date.
pub const REFERENCE: &str = include_str!("reference.toml");

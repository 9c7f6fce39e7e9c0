//! `pinswitch layouts`.

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use pinswitch_friction::published::{self, PublishedLayout};
use pinswitch_switch::templates::{TEMPLATES, TemplateKind};

use super::{Failure, print_json, print_text};

/// List the published layouts and the templates that ship with the program.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// A published layout, with friction in N at the heaviest load.
#[derive(Serialize, JsonSchema)]
struct Layout {
    /// Name.
    name: &'static str,
    /// Number of pins.
    pins: usize,
    /// Angle between neighbouring pins, degrees.
    pitch_deg: f64,
    /// Occupied grooves, numbered from 1.
    grooves: &'static [usize],
    /// Friction on silicone, N.
    device_max_n: f64,
    /// Friction on the rigid proxy, N.
    pins_max_n: f64,
}

/// A template and its first line.
#[derive(Serialize, JsonSchema)]
struct Entry {
    /// Name.
    name: &'static str,
    /// First line.
    about: &'static str,
}

/// The published layouts and the templates.
#[derive(Serialize, JsonSchema)]
pub(super) struct Listing {
    /// Published layouts.
    layouts: Vec<Layout>,
    /// Templates of the published conditions.
    conditions: Vec<Entry>,
    /// Presets of printers, for `--preset`.
    printers: Vec<Entry>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let listing = listing();
    if arguments.json {
        return print_json(&listing);
    }
    let mut text = "Published layouts (friction at 49.67 N, measured):\n".to_owned();
    for l in &listing.layouts {
        text += &format!(
            "  {:<14} {} pins, {:.2} deg apart, grooves {:<22} {:.3} N, on the rigid proxy {:.3} N\n",
            l.name,
            l.pins,
            l.pitch_deg,
            format!("{:?}", l.grooves),
            l.device_max_n,
            l.pins_max_n
        );
    }
    for (title, entries) in
        [("Templates", &listing.conditions), ("Printer presets, for --preset", &listing.printers)]
    {
        text += &format!("\n{title}:\n");
        for entry in entries {
            text += &format!("  {:<24} {}\n", entry.name, entry.about);
        }
    }
    text += "\n`pinswitch init reference` lists every parameter\n";
    print_text(&text)
}

fn listing() -> Listing {
    let layout = |l: &PublishedLayout| Layout {
        name: l.name,
        pins: l.pins,
        pitch_deg: l.pitch_rad().to_degrees(),
        grooves: l.grooves,
        device_max_n: l.device_max_n,
        pins_max_n: l.pins_max_n,
    };
    let of = |kind: TemplateKind| {
        TEMPLATES
            .iter()
            .filter(|t| t.kind == kind)
            .map(|t| Entry { name: t.name, about: t.description() })
            .collect()
    };
    Listing {
        layouts: published::LAYOUTS.iter().map(layout).collect(),
        conditions: of(TemplateKind::Published),
        printers: of(TemplateKind::Printer),
    }
}

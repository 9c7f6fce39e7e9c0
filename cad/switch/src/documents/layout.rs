//! The layout as text.

use crate::config::Configuration;

/// Returns the grooves with pins, such as `3 of 15: 5 8 11`; `0 of 15` without pins.
///
/// ```
/// use pinswitch_switch::{config::{Configuration, assign}, documents::layout_text};
///
/// let mut configuration = Configuration::default();
/// assign(&mut configuration, "layout.pins=[11, 5, 8]")?;
/// assert_eq!(layout_text(&configuration), "3 of 15: 5 8 11");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn layout_text(c: &Configuration) -> String {
    let mut pins = c.layout.pins.clone();
    pins.sort_unstable();
    let count = format!("{} of {}", pins.len(), c.segment.grooves);
    if pins.is_empty() {
        return count;
    }
    let grooves: Vec<String> = pins.iter().map(ToString::to_string).collect();
    format!("{count}: {}", grooves.join(" "))
}

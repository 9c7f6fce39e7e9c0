//! `[axes]`: every combination of the values of its fields, the last of which varies fastest.

use toml_edit::Item;

use super::values;
use super::{AxisTable, SweepAxis, fields};
use crate::source::SweepSource;
use pinswitch_switch::config::ConfigError;

/// The table of a grid.
pub(super) const TABLE: AxisTable = AxisTable { name: "axes", keys: &[], level: 1, read };

fn read(source: &SweepSource, table: &Item) -> Result<Vec<SweepAxis>, ConfigError> {
    fields(table.as_table_like())
        .into_iter()
        .map(|(path, item)| axis(&path, item).map_err(|e| e.or_at(&source.place(item.span()))))
        .collect()
}

/// The axis of one field.
///
/// # Errors
/// [`ConfigError`] for values that the field does not accept, an empty or repeating list, or a bad range.
fn axis(path: &str, item: &Item) -> Result<SweepAxis, ConfigError> {
    let field = super::field(path)?;
    let series = (values::kind(field, item)?.every_value)(field, item)?;
    Ok(SweepAxis::new(vec![field], series.count, move |index| vec![(series.at)(index)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(path: &str, text: &str) -> Result<Vec<String>, String> {
        let item = Item::Value(text.parse().unwrap());
        let level = axis(path, &item).map_err(|e| e.to_string())?;
        Ok((0..level.count()).map(|i| level.row(i)[0].to_string()).collect())
    }

    #[test]
    fn lists_and_ranges_give_their_values() {
        assert_eq!(values("shell.width_mm", "[10, 12.5]").unwrap(), ["10.0", "12.5"]);
        assert_eq!(values("layout.pins", "[[5, 8], []]").unwrap(), ["[5, 8]", "[]"]);
        let steps = values("shell.width_mm", "{ from = 10, to = 10.35, step = 0.1 }").unwrap();
        assert_eq!(steps, ["10.0", "10.1", "10.2", "10.3"]);
        assert_eq!(values("segment.grooves", "{ from = 3, to = 9, count = 3 }").unwrap(), ["3", "6", "9"]);
        let ratios = values("shell.width_mm", "{ from = 4, to = 16, count = 3, spacing = \"log\" }").unwrap();
        assert_eq!(ratios, ["4.0", "8.0", "16.0"]);
    }

    #[test]
    fn bad_axes_say_what_to_change() {
        for (path, text, expected) in [
            ("shell.with_mm", "[1]", "shell.with_mm is no known field; did you mean \"shell.width_mm\"?"),
            ("switch.name", "[\"a\"]", "switch.name is set by the batch itself"),
            (
                "support.slots",
                "{ from = 1, to = 2, step = 1 }",
                "support.slots takes no numbers, so no range",
            ),
            (
                "shell.width_mm",
                "{ from = 16, to = 10, step = 1 }",
                "shell.width_mm = 16 to 10 runs backwards",
            ),
            ("shell.width_mm", "[]", "shell.width_mm = [] is an empty axis"),
            ("shell.width_mm", "[12, 12.0]", "shell.width_mm = 12.0 stands twice"),
            ("shell.width_mm", "[-3]", "shell.width_mm = -3 is not accepted"),
            ("shell.width_mm", "12", "shell.width_mm = 12 is no axis"),
            ("shell.width_mm", "{ from = 10, to = 12 }", "shell.width_mm has neither step nor count"),
            ("shell.width_mm", "{ from = 10, to = 12, step = 0 }", "shell.width_mm.step = 0 leads nowhere"),
            ("shell.width_mm", "{ from = 10, to = 12, by = 1 }", "shell.width_mm.by is no key of a range"),
            ("shell.width_mm", "{ from = 10, to = 200, step = 1 }", "shell.width_mm = 200.0 is not accepted"),
            (
                "segment.grooves",
                "{ from = 3, to = 5, count = 9 }",
                "segment.grooves = 9 values from 3 to 5 holds",
            ),
            ("segment.grooves", "{ from = 3, to = 5, step = 0.5 }", "segment.grooves = 3.5 is not accepted"),
        ] {
            let error = values(path, text).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}

//! `[axes]`: every combination of the values of its fields; the last field varies fastest.

use pinswitch_diagnostic::Diagnostic;
use toml_edit::Item;

use super::values;
use super::{AxisTable, ParameterRef, SweepAxis, fields};
use crate::source::SweepSource;

/// The table of a grid.
pub(super) const TABLE: AxisTable = AxisTable { name: "axes", keys: &[], level: 1, read };

fn read(source: &SweepSource, table: &Item) -> Result<Vec<SweepAxis>, Diagnostic> {
    fields(table.as_table_like())
        .into_iter()
        .map(|entry| {
            let field = entry.field(source)?;
            axis(field, entry.item).map_err(|e| source.locate(e, entry.item.span()))
        })
        .collect()
}

/// Reads the axis of one field.
///
/// # Errors
/// Values that the field does not accept, an empty or repeating list, and an invalid range.
fn axis(field: ParameterRef, item: &Item) -> Result<SweepAxis, Diagnostic> {
    let series = (values::notation(field, item)?.series)(field, item)?;
    Ok(SweepAxis::new(vec![field], series.count, move |index| vec![(series.at)(index)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(path: &str, text: &str) -> Result<Vec<String>, Diagnostic> {
        let item = Item::Value(text.parse().unwrap());
        let axis = axis(crate::axis::field(path)?, &item)?;
        Ok((0..axis.count()).map(|i| axis.row(i)[0].to_string()).collect())
    }

    #[test]
    fn lists_and_ranges_have_values() {
        assert_eq!(values("shell.width_mm", "[10, 12.5]").unwrap(), ["10.0", "12.5"]);
        assert_eq!(values("layout.pins", "[[5, 8], []]").unwrap(), ["[5, 8]", "[]"]);
        let steps = values("shell.width_mm", "{ from = 10, to = 10.35, step = 0.1 }").unwrap();
        assert_eq!(steps, ["10.0", "10.1", "10.2", "10.3"]);
        assert_eq!(values("segment.grooves", "{ from = 3, to = 9, count = 3 }").unwrap(), ["3", "6", "9"]);
        let ratios = values("shell.width_mm", "{ from = 4, to = 16, count = 3, spacing = \"log\" }").unwrap();
        assert_eq!(ratios, ["4.0", "8.0", "16.0"]);
    }

    #[test]
    fn invalid_axes_are_refused_with_help() {
        for (path, text, expected) in [
            ("shell.with_mm", "[1]", "shell.with_mm: unknown field; did you mean \"shell.width_mm\"?"),
            ("switch.name", "[\"a\"]", "switch.name: a sweep cannot set the name"),
            (
                "support.slots",
                "{ from = 1, to = 2, step = 1 }",
                "support.slots: range over a field that does not take numbers; give a list of values",
            ),
            (
                "shell.width_mm",
                "{ from = 16, to = 10, step = 1 }",
                "shell.width_mm = 16 to 10: from is above to; write from = 10, to = 16",
            ),
            ("shell.width_mm", "[]", "shell.width_mm = []: empty axis; give at least one value"),
            ("shell.width_mm", "[12, 12.0]", "shell.width_mm = 12.0: duplicate value"),
            ("shell.width_mm", "[-3]", "shell.width_mm = -3: outside 2 to 100; give a number"),
            ("shell.width_mm", "12", "shell.width_mm = 12: neither a list nor a range; write a list"),
            ("shell.width_mm", "{ from = 10, to = 12 }", "shell.width_mm: range without step or count"),
            ("shell.width_mm", "{ from = 10, to = 12, step = 0 }", "shell.width_mm.step = 0: not above 0"),
            ("shell.width_mm", "{ from = 10, to = 12, by = 1 }", "shell.width_mm.by: unknown key of a range"),
            (
                "shell.width_mm",
                "{ from = 10, to = 200, step = 1 }",
                "shell.width_mm = 200.0: outside 2 to 100",
            ),
            (
                "segment.grooves",
                "{ from = 3, to = 5, count = 9 }",
                "segment.grooves.count = 9: only 3 different values from 3 to 5; lower count to 3",
            ),
            (
                "segment.grooves",
                "{ from = 3, to = 5, step = 0.5 }",
                "segment.grooves = 3.5: not a whole number",
            ),
        ] {
            let error = values(path, text).unwrap_err();
            assert!(error.to_string().starts_with(expected), "{error}");
        }
    }
}

//! Rewriting of values in the text of a configuration; comments and order are preserved.

use pinswitch_diagnostic::{Diagnostic, Location};
use toml_edit::{Array, DocumentMut, Item, RawString, Table, TableLike, Value};

use super::error::syntax_error;
use super::parameter::Parameter;
use super::parameters::Configuration;

/// Returns `text` with the values in which the configuration `wanted` differs from `shown`, the one that the text was
/// read as: each is replaced in its place, or added to its table. Everything else is preserved: comments, line ends and
/// a byte order mark. The comment behind an item of a list goes with the item. `file` names the text in errors.
///
/// `shown` may contain more than the text: a preset under it, options over it.
///
/// ```
/// use pinswitch_switch::config::{assign, read, rewritten};
///
/// let text = "# mine\n[shell]\nwidth_mm = 12 # narrow\n";
/// let (shown, _) = read(text, "mine.toml")?;
/// let mut wanted = shown.clone();
/// assign(&mut wanted, "shell.width_mm=13")?;
/// assert_eq!(rewritten(text, "mine.toml", &shown, &wanted)?, "# mine\n[shell]\nwidth_mm = 13.0 # narrow\n");
/// # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
/// ```
///
/// # Errors
/// A [`Diagnostic`] for invalid TOML.
pub fn rewritten(
    text: &str,
    file: &str,
    shown: &Configuration,
    wanted: &Configuration,
) -> Result<String, Diagnostic> {
    rewritten_where(text, file, wanted, |parameter| {
        (parameter.get)(wanted).to_string() != (parameter.get)(shown).to_string()
    })
}

/// Returns `text` with the values of `wanted` for these fields, as [`rewritten`] writes them.
///
/// # Errors
/// A [`Diagnostic`] for invalid TOML.
pub fn rewritten_fields(
    text: &str,
    file: &str,
    fields: &[String],
    wanted: &Configuration,
) -> Result<String, Diagnostic> {
    rewritten_where(text, file, wanted, |parameter| fields.contains(&parameter.path()))
}

fn rewritten_where(
    text: &str,
    file: &str,
    wanted: &Configuration,
    is_written: impl Fn(&Parameter<Configuration>) -> bool,
) -> Result<String, Diagnostic> {
    let mut document: DocumentMut = text.parse().map_err(|e: toml_edit::TomlError| {
        syntax_error(Location::in_text(file, text, e.span().unwrap_or(0..0)), e.message())
    })?;
    for parameter in Configuration::PARAMETERS.iter().filter(|parameter| is_written(parameter)) {
        let value = (parameter.get)(wanted);
        if document.get(parameter.section).is_none() {
            let mut table = Table::new();
            // A comment at the end of the text stays before the new table.
            let end = document.trailing().as_str().unwrap_or_default().to_owned();
            document.set_trailing("");
            let gap = if text.trim().is_empty() { "" } else { "\n" };
            table.decor_mut().set_prefix(format!("{end}{gap}"));
            document.insert(parameter.section, Item::Table(table));
        }
        if let Some(table) = document.get_mut(parameter.section).and_then(Item::as_table_like_mut) {
            put(table, parameter.key, value);
        }
    }
    Ok(written_as(text, &document.to_string()))
}

/// Sets a key to a value, and preserves the whitespace and comments around an old value.
fn put(table: &mut dyn TableLike, key: &str, mut value: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            if let (Value::Array(old), Value::Array(new)) = (&*old, &mut value)
                && old.to_string().contains('\n')
            {
                lay_out_as(old, new);
            }
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        None => {
            table.insert(key, Item::Value(value));
        }
    }
}

/// Gives `new` the line ends and the byte order mark of `text`.
fn written_as(text: &str, new: &str) -> String {
    const MARK: char = '\u{feff}';
    let lines = new.replace("\r\n", "\n");
    let lines = if text.contains("\r\n") { lines.replace('\n', "\r\n") } else { lines };
    if text.starts_with(MARK) && !lines.starts_with(MARK) { format!("{MARK}{lines}") } else { lines }
}

/// An item of a list over several lines.
struct Listed {
    item: String,
    /// Lines between the previous item and this one, and the indentation; no line end if both are on one line.
    before: String,
    /// The comment behind the item on its line.
    behind: String,
}

/// Lays a list out over the lines of an old one: items of the old list keep their lines and comments.
fn lay_out_as(old: &Array, new: &mut Array) {
    let raw = |text: Option<&RawString>| text.and_then(RawString::as_str).unwrap_or_default().to_owned();
    let (mut opening, mut listed, mut suffix) = (String::new(), Vec::<Listed>::new(), String::new());
    for value in old {
        // A comma on a line of its own, after the comment of its item, moves before the comment.
        let (behind_last, before) = split_line(&(suffix + &raw(value.decor().prefix())));
        match listed.last_mut() {
            Some(last) => last.behind = behind_last,
            None => opening = behind_last,
        }
        suffix = raw(value.decor().suffix()).trim_end_matches([' ', '\t']).to_owned();
        let item = value.clone().decorated("", "").to_string();
        listed.push(Listed { item, before, behind: String::new() });
    }
    let (behind_last, closing) = split_line(&(suffix + &raw(Some(old.trailing()))));
    match listed.last_mut() {
        Some(last) => last.behind = behind_last,
        None => opening = behind_last,
    }
    let indent =
        listed.iter().find_map(|l| l.before.rsplit_once('\n')).map_or("  ", |(_, indent)| indent).to_owned();
    let own_line = format!("\n{indent}");
    // Lines of comment before a removed item stay in the list.
    let (mut orphaned, mut ahead) = (String::new(), opening);
    let wanted: Vec<String> = new.iter().map(|v| v.clone().decorated("", "").to_string()).collect();
    let mut known = listed.into_iter().peekable();
    for (value, item) in new.iter_mut().zip(&wanted) {
        while let Some(gone) = known.next_if(|l| l.item != *item && !wanted.contains(&l.item)) {
            orphaned += comment_lines(&gone.before);
        }
        let (before, behind) = match known.next_if(|l| l.item == *item) {
            Some(known) => (known.before, known.behind),
            None => (own_line.clone(), String::new()),
        };
        let mut prefix = ahead + &std::mem::take(&mut orphaned) + &before;
        // On the line of a comment, the item would become a part of the comment.
        if prefix.rsplit('\n').next().is_some_and(|line| line.contains('#')) {
            prefix.truncate(prefix.trim_end().len());
            prefix += &own_line;
        }
        value.decor_mut().set_prefix(prefix);
        value.decor_mut().set_suffix("");
        ahead = behind;
    }
    for gone in known {
        orphaned += comment_lines(&gone.before);
    }
    let closing = if closing.starts_with('\n') { closing } else { format!("\n{closing}") };
    new.set_trailing(format!("{ahead}{orphaned}{closing}"));
    new.set_trailing_comma(true);
}

/// Splits a text after its first line, which is empty unless it has a comment.
fn split_line(text: &str) -> (String, String) {
    let end = text.find('\n').unwrap_or(if text.contains('#') { text.len() } else { 0 });
    (text[..end].trim_end().to_owned(), text[end..].to_owned())
}

/// Returns the lines of comment before an item, without its indentation.
fn comment_lines(before: &str) -> &str {
    before.rsplit_once('\n').map_or("", |(lines, _)| if lines.contains('#') { lines } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{assign, read};
    use crate::templates;
    use proptest::prelude::*;

    #[test]
    fn every_template_is_rewritten_to_every_other() {
        for from in templates::names() {
            let text = templates::text(from).unwrap();
            let (own, _) = read(&text, from).unwrap();
            assert_eq!(
                rewritten(&text, from, &own, &own).unwrap(),
                text,
                "nothing to change changes nothing"
            );
            for to in templates::names() {
                let (wanted, _) = read(&templates::text(to).unwrap(), to).unwrap();
                let changed = rewritten(&text, from, &own, &wanted).unwrap();
                assert_eq!(read(&changed, from).unwrap().0, wanted, "{from} to {to}");
                let comments = |text: &str| text.lines().filter(|l| l.trim_start().starts_with('#')).count();
                assert_eq!(comments(&changed), comments(&text), "{from} to {to}");
            }
        }
    }

    #[test]
    fn inline_tables_and_missing_tables_take_values() {
        let text = "shell = { width_mm = 12 } # inline\n";
        let (shown, _) = read(text, "x.toml").unwrap();
        let mut wanted = shown.clone();
        for assignment in ["shell.wall_mm=9", "shell.width_mm=14", "layout.pins=[5, 8]"] {
            assign(&mut wanted, assignment).unwrap();
        }
        let changed = rewritten(text, "x.toml", &shown, &wanted).unwrap();
        assert_eq!(read(&changed, "x.toml").unwrap().0, wanted, "{changed}");
        assert!(changed.contains("# inline"), "{changed}");
        assert!(rewritten("[shell", "x.toml", &shown, &wanted).is_err());
    }

    #[test]
    fn only_differences_from_the_shown_configuration_are_written() {
        let text = "[layout]\npins = [5]\n";
        let (mut shown, _) = read(text, "x.toml").unwrap();
        let default = shown.clone();
        assign(&mut shown, "shell.width_mm=13").unwrap();
        let mut wanted = shown.clone();
        assign(&mut wanted, "shell.wall_mm=9").unwrap();
        let changed = rewritten(text, "x.toml", &shown, &wanted).unwrap();
        assert_eq!(changed, format!("{text}\n[shell]\nwall_mm = 9.0\n"));
        // Back to the default, against the preset.
        let changed = rewritten(text, "x.toml", &shown, &default).unwrap();
        assert!(changed.contains("width_mm"), "{changed}");
    }

    /// Returns the text with pins in these grooves.
    fn with_pins(text: &str, pins: &str) -> String {
        let (shown, _) = read(text, "x.toml").unwrap();
        let mut wanted = shown.clone();
        assign(&mut wanted, &format!("layout.pins={pins}")).unwrap();
        let changed = rewritten(text, "x.toml", &shown, &wanted).unwrap();
        assert_eq!(read(&changed, "x.toml").unwrap().0, wanted, "{changed}");
        changed
    }

    #[test]
    fn a_list_keeps_lines_and_comments() {
        let text = "[layout]\npins = [ # mine\n  5, # first\n  # the middle\n  8,\n  11, # third\n] # done\n";
        assert_eq!(
            with_pins(text, "[2, 5, 11]"),
            "[layout]\npins = [ # mine\n  2,\n  5, # first\n  # the middle\n  11, # third\n] # done\n"
        );
        assert_eq!(
            with_pins(text, "[5, 8, 11, 14]"),
            "[layout]\npins = [ # mine\n  5, # first\n  # the middle\n  8,\n  11, # third\n  14,\n] # done\n"
        );
        let none_left = with_pins(text, "[1]");
        assert!(none_left.contains("# mine") && none_left.contains("# the middle"), "{none_left}");
        let in_pairs = "[layout]\npins = [\n  5, 8, # two\n  11 # last\n]\n";
        assert_eq!(with_pins(in_pairs, "[5, 11]"), "[layout]\npins = [\n  5,\n  11, # last\n]\n");
        assert_eq!(with_pins("layout = { pins = [5, 8] } # one\n", "[5]"), "layout = { pins = [5] } # one\n");
    }

    #[test]
    fn comments_and_line_ends_are_preserved() {
        assert_eq!(with_pins("# nothing yet\n", "[2]"), "# nothing yet\n\n[layout]\npins = [2]\n");
        assert_eq!(with_pins("", "[2]"), "[layout]\npins = [2]\n");
        assert_eq!(
            with_pins("[shell]\nwidth_mm = 12\n# the end\n", "[2]"),
            "[shell]\nwidth_mm = 12\n# the end\n\n[layout]\npins = [2]\n"
        );
        assert_eq!(
            with_pins("\u{feff}# of Windows\r\n[layout]\r\npins = [5]\r\n", "[2]"),
            "\u{feff}# of Windows\r\n[layout]\r\npins = [2]\r\n"
        );
    }

    proptest! {
        /// A rewritten list of any layout reads as the wanted one, and comments around it are preserved.
        #[test]
        fn lists_of_any_layout_are_rewritten(
            old in prop::collection::btree_set(1..16u32, 0..6),
            new in prop::collection::btree_set(1..16u32, 0..6),
            lines in prop::collection::vec(("[ \n]{0,3}", prop::option::of("[a-z]{1,4}"), any::<bool>()), 7),
        ) {
            let mut text = "# head\n[layout]\npins = [".to_owned();
            for (pin, (space, comment, own)) in old.iter().zip(&lines) {
                let comment = comment.as_ref().map(|c| format!(" # {c}{pin}\n")).unwrap_or_default();
                text += &if *own { format!("{comment}{space}{pin},") } else { format!("{space}{pin},{comment}") };
            }
            text += &format!("{}]\n# tail\n", lines[6].0);
            let wanted = format!("{new:?}").replace('{', "[").replace('}', "]");
            let changed = with_pins(&text, &wanted);
            prop_assert!(changed.starts_with("# head\n") && changed.ends_with("# tail\n"), "{}", changed);
            prop_assert_eq!(with_pins(&changed, &wanted), changed);
        }
    }
}

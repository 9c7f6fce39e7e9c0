//! `pinswitch explain`.

use clap::Args;
use pinswitch_diagnostic::{Area, Code, Diagnostic, Location, codes, excerpt};
use schemars::JsonSchema;
use serde::Serialize;

use super::{Failure, print_json, print_text};

/// Most columns of a page.
const COLUMNS: usize = 80;
/// Most characters of a code in an error.
const MAX_QUOTE: usize = 60;
/// Similarity from which on a known code is proposed for an unknown one, and the most proposals.
const SIMILAR: f64 = 0.75;
const PROPOSALS: usize = 3;

/// Explain the code of an error or a warning, or list all codes.
///
/// The code is the word in brackets at the end of the first line of an error or a warning, such as `[grooves-overlap]`. Its
/// page says why the bound exists, what usually causes the fault, and which document has more about it.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch explain grooves-overlap
  pinswitch explain")]
pub(super) struct Arguments {
    /// Code, such as grooves-overlap; without it, all codes are listed with their titles.
    code: Option<String>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// The page of a code.
#[derive(Serialize, JsonSchema)]
pub(super) struct Page {
    /// Code, as in the brackets of an error.
    code: &'static str,
    /// The fault in one line.
    title: &'static str,
    /// Explanation: paragraphs, separated by an empty line.
    text: &'static str,
    /// Path of the document of the repository with more about it.
    #[serde(skip_serializing_if = "Option::is_none")]
    document: Option<&'static str>,
}

/// The page of a code, or the pages of all codes.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
pub(super) enum Pages {
    /// With a code.
    One(Page),
    /// Without a code.
    All(Vec<Page>),
}

impl Page {
    fn new(code: Code) -> Self {
        Self { code: code.name(), title: code.title(), text: code.text(), document: code.document() }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let code = arguments.code.as_deref().map(known).transpose().map_err(Failure::bad_input)?;
    match (code, arguments.json) {
        (Some(code), true) => print_json(&Pages::One(Page::new(code))),
        (None, true) => print_json(&Pages::All(Code::all().map(Page::new).collect())),
        (Some(code), false) => print_text(&page(code)),
        (None, false) => print_text(&listing()),
    }
}

/// Returns the code of this name, which may be in brackets as in an error.
fn known(name: &str) -> Result<Code, Diagnostic> {
    let bare = name.trim().trim_start_matches('[').trim_end_matches(']').to_lowercase();
    Code::from_name(&bare).ok_or_else(|| {
        let similarity = |code: &Code| strsim::jaro_winkler(&bare, code.name());
        let mut near: Vec<Code> = Code::all().filter(|code| similarity(code) >= SIMILAR).collect();
        near.sort_by(|a, b| similarity(b).total_cmp(&similarity(a)));
        let near: Vec<&str> = near.into_iter().take(PROPOSALS).map(Code::name).collect();
        let all = "`pinswitch explain` lists all codes";
        let help = match near.as_slice() {
            [] => all.to_owned(),
            near => format!("did you mean {}? {all}", near.join(", ")),
        };
        Diagnostic::new(codes::UNKNOWN_WORD, "unknown code")
            .with_location(Location::field("CODE", excerpt(name, MAX_QUOTE)))
            .with_help(help)
    })
}

/// Returns the page of a code, for a person.
fn page(code: Code) -> String {
    let mut text = format!("{code}: {}\n", code.title());
    for paragraph in code.text().split("\n\n") {
        text.push_str(&format!("\n{}\n", wrapped(paragraph)));
    }
    if let Some(document) = code.document() {
        text.push_str(&format!("\nin: {document}\n"));
    }
    text
}

/// Returns all codes with their titles, by area.
fn listing() -> String {
    let longest = Code::all().map(|code| code.name().len()).max().unwrap_or(0);
    let area = |area: &Area| {
        let line = |code: &Code| format!("  {code:<longest$}  {}\n", code.title());
        format!("{}:\n{}", area.title, area.codes.iter().map(line).collect::<String>())
    };
    Area::all().iter().map(area).collect::<Vec<_>>().join("\n")
}

/// Returns a paragraph in lines of at most [`COLUMNS`] characters.
fn wrapped(paragraph: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in paragraph.split_whitespace() {
        match lines.last_mut().filter(|line| line.chars().count() + 1 + word.chars().count() <= COLUMNS) {
            Some(line) => {
                line.push(' ');
                line.push_str(word);
            }
            None => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_wrapped() {
        for code in Code::all() {
            let page = page(code);
            assert!(page.starts_with(code.name()) && page.contains(code.title()), "{page}");
            let paragraphs = code.text().split("\n\n").map(wrapped).collect::<Vec<_>>().join("\n\n");
            assert!(page.contains(&paragraphs), "{page}");
            assert!(paragraphs.lines().all(|line| line.chars().count() <= COLUMNS), "{page}");
        }
    }

    #[test]
    fn similar_codes_are_proposed() {
        assert_eq!(known("[grooves-overlap]").unwrap(), codes::GROOVES_OVERLAP);
        let error = known("groves-overlaps").unwrap_err();
        assert!(error.help().unwrap().starts_with("did you mean grooves-overlap"), "{error}");
        assert_eq!(known("qqqq").unwrap_err().help(), Some("`pinswitch explain` lists all codes"));
    }
}

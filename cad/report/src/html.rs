//! What every page needs that is written: text that stays text, templates filled once, and what a browser may load.

use std::borrow::Cow;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

pub use pinswitch_drafting::escape;

/// JSON that can stand in a script element: it holds no `<`, so that neither an end tag nor `<!--<script>`, after which a
/// browser does not look for the end tag, can occur.
#[must_use]
pub fn json_in_script(json: &str) -> String {
    // Within JSON these characters stand in strings only, where an escape means the same.
    json.replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
        .replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029")
}

/// `template` with every `{{PLACE}}` filled in, in one pass: what is filled in is not searched for places again.
pub fn filled<'a>(template: &'a str, content: impl Fn(&str) -> Option<Cow<'a, str>>) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        page.push_str(before);
        match after.split_once("}}").and_then(|(place, after)| Some((content(place)?, after))) {
            Some((text, after)) => {
                page.push_str(&text);
                rest = after;
            }
            None => {
                page.push_str("{{");
                rest = after;
            }
        }
    }
    page + rest
}

/// The Content-Security-Policy of a page whose script elements hold these texts and no others: nothing is loaded from
/// elsewhere, and no script that came in with data would run.
#[must_use]
pub fn policy(scripts: &[&str]) -> String {
    let hash = |script: &&str| format!(" 'sha256-{}'", STANDARD.encode(Sha256::digest(script.as_bytes())));
    let scripts: String =
        if scripts.is_empty() { " 'none'".to_owned() } else { scripts.iter().map(hash).collect() };
    format!(
        "default-src 'none'; script-src{scripts}; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self'; \
         base-uri 'none'; form-action 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_is_not_filled_again() {
        let content = |place: &str| match place {
            "A" => Some("{{B}}".into()),
            "B" => Some("b".into()),
            _ => None,
        };
        assert_eq!(filled("{{A}} {{B}} {{C}} {{", content), "{{B}} b {{C}} {{");
    }

    #[test]
    fn no_text_is_markup() {
        assert_eq!(escape("<!--<script>'\"&"), "&lt;!--&lt;script&gt;&#39;&quot;&amp;");
        let json = r#"{"a":"<!--<script></script>]]>&"}"#;
        let safe = json_in_script(json);
        assert!(!safe.contains(['<', '>', '&']), "{safe}");
        let same = safe.replace("\\u003c", "<").replace("\\u003e", ">").replace("\\u0026", "&");
        assert_eq!(same, json);
    }

    #[test]
    fn only_the_scripts_that_are_named_may_run() {
        // `printf alert | openssl dgst -sha256 -binary | base64`
        let policy = policy(&["alert"]);
        assert!(policy.contains("script-src 'sha256-"), "{policy}");
        assert!(!policy.contains("script-src 'unsafe"), "{policy}");
        assert!(super::policy(&[]).contains("script-src 'none'"));
    }
}

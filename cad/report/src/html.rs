//! Parts of HTML pages: escapes, templates, and the Content-Security-Policy.

use std::borrow::Cow;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

pub use pinswitch_drafting::escape;

/// Escapes JSON for a script element. Without `<` it contains neither an end tag nor
/// `<!--<script>`, after which a browser ignores the end tag.
#[must_use]
pub fn json_in_script(json: &str) -> String {
    // JSON has these characters in strings only, where an escape is equivalent.
    json.replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
        .replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029")
}

/// Replaces every `{{NAME}}` in `template` by its content, in one pass: the content is not searched
/// again. A name without content is kept.
pub fn filled<'a>(template: &'a str, content: impl Fn(&str) -> Option<Cow<'a, str>>) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        page.push_str(before);
        match after.split_once("}}").and_then(|(name, after)| Some((content(name)?, after))) {
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

/// Returns the Content-Security-Policy of a page with these scripts: nothing is loaded from other
/// hosts, and no other script runs.
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
    fn content_is_not_filled_again() {
        let content = |name: &str| match name {
            "A" => Some("{{B}}".into()),
            "B" => Some("b".into()),
            _ => None,
        };
        assert_eq!(filled("{{A}} {{B}} {{C}} {{", content), "{{B}} b {{C}} {{");
    }

    #[test]
    fn escaped_text_has_no_markup() {
        assert_eq!(escape("<!--<script>'\"&"), "&lt;!--&lt;script&gt;&#39;&quot;&amp;");
        let json = r#"{"a":"<!--<script></script>]]>&"}"#;
        let safe = json_in_script(json);
        assert!(!safe.contains(['<', '>', '&']), "{safe}");
        let same = safe.replace("\\u003c", "<").replace("\\u003e", ">").replace("\\u0026", "&");
        assert_eq!(same, json);
    }

    #[test]
    fn only_named_scripts_are_allowed() {
        // `printf alert | openssl dgst -sha256 -binary | base64`
        let policy = policy(&["alert"]);
        assert!(policy.contains("script-src 'sha256-"), "{policy}");
        assert!(!policy.contains("script-src 'unsafe"), "{policy}");
        assert!(super::policy(&[]).contains("script-src 'none'"));
    }
}

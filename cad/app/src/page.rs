//! The page of the configurator: one file with everything in it, which a file server or a double click opens.

use pinswitch_report::html::{filled, policy};
use pinswitch_switch::formats::page::{ASSEMBLY, THREE, UPLOT, UPLOT_CSS};

const HTML: &str = include_str!("../page/configurator.html");
const CSS: &str = include_str!("../page/configurator.css");
const UNPACK: &str = include_str!("../page/xz-decompress.min.js");
const WORKER: &str = include_str!("../page/worker.js");

/// The page's own scripts, in the order in which they are read.
const SCRIPTS: [&str; 20] = [
    include_str!("../page/words.js"),
    include_str!("../page/dom.js"),
    include_str!("../page/focus.js"),
    include_str!("../page/state.js"),
    include_str!("../page/engine.js"),
    include_str!("../page/controls.js"),
    include_str!("../page/pins.js"),
    include_str!("../page/view.js"),
    include_str!("../page/scales.js"),
    include_str!("../page/curve.js"),
    include_str!("../page/handles.js"),
    include_str!("../page/checks.js"),
    include_str!("../page/bill.js"),
    include_str!("../page/ask.js"),
    include_str!("../page/measured.js"),
    include_str!("../page/drop.js"),
    include_str!("../page/downloads.js"),
    include_str!("../page/embed.js"),
    include_str!("../page/server.js"),
    include_str!("../page/page.js"),
];

/// A module that is packed into the page.
#[derive(Clone, Debug, Default)]
pub struct Packed {
    /// The module, packed with XZ, in base64.
    pub base64: String,
    /// Where the page's libraries go into it, by [`LIBRARIES`]; `None` for one that it does not hold.
    pub holes: Vec<Option<usize>>,
}

/// Libraries of the page that stand in the module, too.
pub const LIBRARIES: [&str; 3] = [THREE, UPLOT, ASSEMBLY];

/// The page, with the WebAssembly module; without one it asks the server that it came from.
#[must_use]
pub fn configurator_html(module: Option<&Packed>) -> String {
    // Places in the module, by the names of the page's elements.
    let holes: Vec<String> = module.map_or_else(Vec::new, |module| {
        let named = ["three", "uplot", "assembly"].iter().zip(&module.holes);
        named.filter_map(|(name, place)| Some(format!("{name}:{}", (*place)?))).collect()
    });
    let holes = holes.join(" ");
    let (script, policy) = (script(), configurator_policy());
    filled(HTML, |place| match place {
        "CSS" => Some(CSS.into()),
        "UPLOT_CSS" => Some(UPLOT_CSS.into()),
        "THREE" => Some(THREE.into()),
        "UPLOT" => Some(UPLOT.into()),
        "ASSEMBLY" => Some(ASSEMBLY.into()),
        "JS" => Some(script.as_str().into()),
        "WORKER" => Some(module.map_or_else(String::new, |_| format!("{UNPACK}\n{}", sent(WORKER))).into()),
        "MODULE" => Some(module.map_or("", |module| module.base64.as_str()).into()),
        "HOLES" => Some(holes.as_str().into()),
        "POLICY" => Some(policy.as_str().into()),
        _ => None,
    })
}

/// The Content-Security-Policy of the page, the same where it is saved and where it is served. Its worker is made from a
/// text in the page, and compiles the module.
#[must_use]
pub fn configurator_policy() -> String {
    policy(&[THREE, UPLOT, ASSEMBLY, &script()])
        .replace("script-src", "worker-src blob:; script-src 'wasm-unsafe-eval'")
}

/// The page's own scripts, in the form in which they are sent.
fn script() -> String {
    SCRIPTS.iter().map(|script| sent(script)).collect()
}

/// A script without comments and indents, which nobody reads in a page that is sent to everyone. A comment stands on lines of
/// its own here, and no text goes on in another line.
fn sent(script: &str) -> String {
    let lines = script.lines().map(str::trim_start);
    lines.filter(|line| !line.is_empty() && !line.starts_with("//")).flat_map(|line| [line, "\n"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_sent_without_comments_and_with_every_text() {
        for script in SCRIPTS.iter().chain([&WORKER]) {
            // A text that went on in another line could lose a part of it.
            assert!(script.lines().all(|line| line.matches('`').count() % 2 == 0 && !line.ends_with('\\')));
        }
        assert_eq!(sent("// Why.\n\nf('//a');\n  // Here, too.\n  g(1); // 2\n"), "f('//a');\ng(1); // 2\n");
    }

    #[test]
    fn every_place_of_the_page_is_filled() {
        let module = Packed { base64: "AGFzbQ==".to_owned(), holes: vec![Some(7), None] };
        let page = configurator_html(Some(&module));
        assert!(page.contains("id=\"module\" data-holes=\"three:7\">AGFzbQ==<"));
        assert!(page.contains(&configurator_policy()) && page.contains("AGFzbQ=="));
        for place in
            ["CSS", "UPLOT_CSS", "THREE", "UPLOT", "ASSEMBLY", "JS", "WORKER", "HOLES", "MODULE", "POLICY"]
        {
            assert!(HTML.contains(&format!("{{{{{place}}}}}")), "{place} stands nowhere");
            assert!(!page.contains(&format!("{{{{{place}}}}}")), "{place} is left");
        }
        assert!(
            !page.contains("src=\"http") && !page.contains("href=\"http"),
            "nothing comes from elsewhere"
        );
    }
}

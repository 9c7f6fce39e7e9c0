//! The page of the configurator: one self-contained HTML file, for a file server or a double click.

use pinswitch_report::html::{filled, policy};
use pinswitch_switch::formats::page::{ASSEMBLY, THREE, UPLOT, UPLOT_CSS};

const HTML: &str = include_str!("../page/configurator.html");
const CSS: &str = include_str!("../page/configurator.css");
const UNPACK: &str = include_str!("../page/xz-decompress.min.js");
const WORKER: &str = include_str!("../page/worker.js");

/// Scripts of the page, in the order in which they are joined.
const SCRIPTS: [&str; 24] = [
    include_str!("../page/text.js"),
    include_str!("../page/dom.js"),
    include_str!("../page/focus.js"),
    include_str!("../page/state.js"),
    include_str!("../page/engine.js"),
    include_str!("../page/quantity.js"),
    include_str!("../page/controls.js"),
    include_str!("../page/pins.js"),
    include_str!("../page/templates.js"),
    include_str!("../page/joint.js"),
    include_str!("../page/view.js"),
    include_str!("../page/scales.js"),
    include_str!("../page/curve.js"),
    include_str!("../page/handles.js"),
    include_str!("../page/strip.js"),
    include_str!("../page/checks.js"),
    include_str!("../page/materials.js"),
    include_str!("../page/targets.js"),
    include_str!("../page/measurements.js"),
    include_str!("../page/drop.js"),
    include_str!("../page/downloads.js"),
    include_str!("../page/embed.js"),
    include_str!("../page/server.js"),
    include_str!("../page/page.js"),
];

/// A module that the page contains.
#[derive(Clone, Debug, Default)]
pub struct PackedModule {
    /// The module, packed with XZ, in base64.
    pub base64: String,
    /// Offsets in bytes at which the worker inserts [`LIBRARIES`] into the unpacked module; `None`
    /// for a library that the module does not contain.
    pub library_offsets: Vec<Option<usize>>,
}

/// Libraries of the page that the module contains, too.
pub const LIBRARIES: [&str; 3] = [THREE, UPLOT, ASSEMBLY];

/// Ids of the elements of [`LIBRARIES`] in the page.
const LIBRARY_IDS: [&str; 3] = ["three", "uplot", "assembly"];

/// Returns the page with the WebAssembly module; without one it sends its requests to the server
/// that it came from.
#[must_use]
pub fn configurator_html(module: Option<&PackedModule>) -> String {
    let offsets: Vec<String> = module.map_or_else(Vec::new, |module| {
        let libraries = LIBRARY_IDS.iter().zip(&module.library_offsets);
        libraries.filter_map(|(id, offset)| Some(format!("{id}:{}", (*offset)?))).collect()
    });
    let offsets = offsets.join(" ");
    let (script, policy) = (script(), configurator_policy());
    filled(HTML, |placeholder| match placeholder {
        "CSS" => Some(CSS.into()),
        "UPLOT_CSS" => Some(UPLOT_CSS.into()),
        "THREE" => Some(THREE.into()),
        "UPLOT" => Some(UPLOT.into()),
        "ASSEMBLY" => Some(ASSEMBLY.into()),
        "JS" => Some(script.as_str().into()),
        "WORKER" => {
            Some(module.map_or_else(String::new, |_| format!("{UNPACK}\n{}", minified(WORKER))).into())
        }
        "MODULE" => Some(module.map_or("", |module| module.base64.as_str()).into()),
        "LIBRARY_OFFSETS" => Some(offsets.as_str().into()),
        "POLICY" => Some(policy.as_str().into()),
        _ => None,
    })
}

/// Returns the Content-Security-Policy of the page, the same in a saved page and in a header. The
/// worker is a `blob:` of text in the page, and compiles the module.
#[must_use]
pub fn configurator_policy() -> String {
    policy(&[THREE, UPLOT, ASSEMBLY, &script()])
        .replace("script-src", "worker-src blob:; script-src 'wasm-unsafe-eval'")
}

/// Joins the scripts of the page.
fn script() -> String {
    SCRIPTS.iter().map(|script| minified(script)).collect()
}

/// Removes comments, indentation and empty lines from a script whose comments are on lines of their
/// own and whose strings end on the line on which they begin.
fn minified(script: &str) -> String {
    let lines = script.lines().map(str::trim_start);
    lines.filter(|line| !line.is_empty() && !line.starts_with("//")).flat_map(|line| [line, "\n"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_lose_comments_only() {
        for script in SCRIPTS.iter().chain([&WORKER]) {
            // A string that continues on another line could lose a part of it.
            assert!(script.lines().all(|line| line.matches('`').count() % 2 == 0 && !line.ends_with('\\')));
        }
        assert_eq!(
            minified("// Why.\n\nf('//a');\n  // Here, too.\n  g(1); // 2\n"),
            "f('//a');\ng(1); // 2\n"
        );
    }

    #[test]
    fn every_placeholder_is_filled() {
        let module = PackedModule { base64: "AGFzbQ==".to_owned(), library_offsets: vec![Some(7), None] };
        let page = configurator_html(Some(&module));
        assert!(page.contains("id=\"module\" data-library-offsets=\"three:7\">AGFzbQ==<"));
        assert!(page.contains(&configurator_policy()) && page.contains("AGFzbQ=="));
        let placeholders = [
            "CSS",
            "UPLOT_CSS",
            "THREE",
            "UPLOT",
            "ASSEMBLY",
            "JS",
            "WORKER",
            "LIBRARY_OFFSETS",
            "MODULE",
            "POLICY",
        ];
        for placeholder in placeholders {
            assert!(HTML.contains(&format!("{{{{{placeholder}}}}}")), "{placeholder} is not in the template");
            assert!(!page.contains(&format!("{{{{{placeholder}}}}}")), "{placeholder} is not filled");
        }
        assert!(!page.contains("src=\"http") && !page.contains("href=\"http"), "the page loads other files");
    }
}

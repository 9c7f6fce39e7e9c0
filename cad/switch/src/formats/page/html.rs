//! The HTML file of the page: one file for its three states.

use pinswitch_report::html::{escape, filled, json_in_script, policy};

const HTML: &str = include_str!("../../../page/page.html");
const UNPACK: &str = include_str!("../../../page/xz-decompress.min.js");
/// The script that answers requests with the module, in a worker of the page.
const WORKER: &str = include_str!(concat!(env!("OUT_DIR"), "/worker.js"));
const UPLOT_CSS: &str = include_str!("../../../page/uplot.min.css");
// Vendored builds, see page/vendor.md.
const THREE: &str = include_str!("../../../page/three.min.js");
const UPLOT: &str = include_str!("../../../page/uplot.min.js");
const ASSEMBLY: &str = include_str!("../../../page/assembly.js");
const CSS: &str = include_str!("../../../page/page.css");
/// The scripts of the page, joined by the build script.
const SCRIPT: &str = include_str!(concat!(env!("OUT_DIR"), "/page.js"));

/// Texts of the page that the module contains, too, since it writes reports.
pub const SHARED_TEXTS: [&str; 5] = [THREE, UPLOT, ASSEMBLY, CSS, SCRIPT];
/// Ids of the elements of [`SHARED_TEXTS`] in the page.
const SHARED_IDS: [&str; 5] = ["three", "uplot", "assembly", "style", "script"];

/// A WebAssembly module that the page contains.
#[derive(Clone, Debug, Default)]
pub struct PackedModule {
    /// The module, packed with XZ, in base64.
    pub base64: String,
    /// [`worker_script`].
    pub worker: String,
    /// Offsets in bytes at which the worker inserts [`SHARED_TEXTS`] into the unpacked module; `None`
    /// for a text that the module does not contain.
    pub offsets: Vec<Option<usize>>,
}

/// Returns the script that answers requests with a module in the page. Apart from [`PageState::html`], so that a module does
/// not contain it.
#[must_use]
pub fn worker_script() -> String {
    format!("{UNPACK}\n{WORKER}")
}

/// A state of the page: where the answers to its requests come from.
#[derive(Clone, Copy, Debug)]
pub enum PageState<'a> {
    /// A published file: from the module in the page.
    File(&'a PackedModule),
    /// Served: from the server that the page came from.
    Served,
    /// A report of a set, read only: recorded in the page.
    Report(&'a RecordedSet),
}

/// What a report contains.
#[derive(Clone, Debug)]
pub struct RecordedSet {
    /// Name of the set.
    pub title: String,
    /// Answers to the requests of the page, as JSON.
    pub answers: String,
    /// Data URL of a picture for browsers without WebGL or JavaScript.
    pub still: String,
}

impl PageState<'_> {
    const fn name(self) -> &'static str {
        match self {
            Self::File(_) => "file",
            Self::Served => "served",
            Self::Report(_) => "report",
        }
    }

    /// Returns the Content-Security-Policy of the page, the same in a saved page and in a header: only its own scripts run.
    /// The worker is a `blob:` of text in the page, and compiles the module; the manifest of the app is a `data:` of text.
    #[must_use]
    pub fn policy(self) -> String {
        let policy = policy(&[THREE, UPLOT, ASSEMBLY, SCRIPT]);
        match self {
            Self::File(_) => policy
                .replace("script-src", "worker-src blob:; manifest-src data:; script-src 'wasm-unsafe-eval'"),
            Self::Served => policy,
            Self::Report(_) => policy.replace("connect-src 'self'", "connect-src 'none'"),
        }
    }

    /// Returns the page.
    #[must_use]
    pub fn html(self) -> String {
        let (module, recorded) = match self {
            Self::File(module) => (Some(module), None),
            Self::Served => (None, None),
            Self::Report(recorded) => (None, Some(recorded)),
        };
        let offsets: Vec<String> = module.map_or_else(Vec::new, |module| {
            let texts = SHARED_IDS.iter().zip(&module.offsets);
            texts.filter_map(|(id, offset)| Some(format!("{id}:{}", (*offset)?))).collect()
        });
        let offsets = offsets.join(" ");
        let title = recorded
            .map_or_else(|| "pinswitch".to_owned(), |of| format!("{}: friction switch", escape(&of.title)));
        let still = recorded
            .map(|of| {
                format!("<img id=\"still\" alt=\"Exploded view of the assembly\" src=\"{}\">", of.still)
            })
            .unwrap_or_default();
        let answers = recorded.map(|of| json_in_script(&of.answers)).unwrap_or_default();
        let policy = self.policy();
        filled(HTML, |placeholder| match placeholder {
            "TITLE" => Some(title.as_str().into()),
            "STATE" => Some(self.name().into()),
            "CSS" => Some(CSS.into()),
            "UPLOT_CSS" => Some(UPLOT_CSS.into()),
            "THREE" => Some(THREE.into()),
            "UPLOT" => Some(UPLOT.into()),
            "ASSEMBLY" => Some(ASSEMBLY.into()),
            "JS" => Some(SCRIPT.into()),
            "WORKER" => Some(module.map_or("", |module| module.worker.as_str()).into()),
            "MODULE" => Some(module.map_or("", |module| module.base64.as_str()).into()),
            "OFFSETS" => Some(offsets.as_str().into()),
            "STILL" => Some(still.as_str().into()),
            "REPORT" => Some(answers.as_str().into()),
            "POLICY" => Some(policy.as_str().into()),
            _ => None,
        })
    }
}

#[cfg(test)]
#[path = "../../../page/minified.rs"]
mod minified;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_lose_comments_only() {
        for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/page")).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if !name.ends_with(".js") || name.contains(".min.") || name == "assembly.js" {
                continue;
            }
            let script = std::fs::read_to_string(&path).unwrap();
            // A string that continues on another line could lose a part of it.
            assert!(
                script.lines().all(|line| line.matches('`').count() % 2 == 0 && !line.ends_with('\\')),
                "{name}"
            );
            let joined = if name == "worker.js" { WORKER } else { SCRIPT };
            assert!(joined.contains(&minified::minified(&script)), "{name} is not joined; see build.rs");
        }
        assert_eq!(
            minified::minified("// Why.\n\nf('//a');\n  // Here, too.\n  g(1); // 2\n"),
            "f('//a');\ng(1); // 2\n"
        );
    }

    #[test]
    fn every_placeholder_is_filled() {
        let module = PackedModule {
            base64: "AGFzbQ==".to_owned(),
            worker: worker_script(),
            offsets: vec![Some(7), None, None, Some(9), None],
        };
        let recorded = RecordedSet {
            title: "a<b".to_owned(),
            answers: "{\"a\": \"</script>\"}".to_owned(),
            still: "data:,".to_owned(),
        };
        for state in [PageState::File(&module), PageState::Served, PageState::Report(&recorded)] {
            let page = state.html();
            assert!(
                page.contains(&state.policy()) && page.contains(&format!("data-state=\"{}\"", state.name()))
            );
            for placeholder in HTML.split("{{").skip(1).filter_map(|rest| rest.split_once("}}")) {
                let name = placeholder.0;
                assert!(!page.contains(&format!("{{{{{name}}}}}")), "{name} is not filled");
            }
            assert!(
                !page.contains("src=\"http") && !page.contains("href=\"http"),
                "the page loads other files"
            );
            assert_eq!(page.contains("AGFzbQ=="), matches!(state, PageState::File(_)));
            assert_eq!(page.contains("a&lt;b: friction switch"), matches!(state, PageState::Report(_)));
        }
        assert!(PageState::File(&module).html().contains("data-offsets=\"three:7 style:9\">AGFzbQ==<"));
        assert!(PageState::Report(&recorded).html().contains("{\"a\": \"\\u003c/script\\u003e\"}"));
    }
}

//! Joins the scripts of the page, without comments and indentation, into one file: the WebAssembly module and the page
//! around it contain the same text, so that it is packed once.

use std::path::Path;

#[path = "page/minified.rs"]
mod minified;

/// Scripts of the page, in the order in which they are joined; see page/README.md.
const SCRIPTS: [&str; 28] = [
    "text",
    "dom",
    "focus",
    "state",
    "session",
    "recorded",
    "engine",
    "quantity",
    "controls",
    "pins",
    "templates",
    "motion",
    "joint",
    "view",
    "scales",
    "curve",
    "handles",
    "strip",
    "checks",
    "materials",
    "targets",
    "measurements",
    "drop",
    "downloads",
    "embed",
    "server",
    "install",
    "page",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=page");
    let read = |name: &str| std::fs::read_to_string(Path::new("page").join(format!("{name}.js")));
    let joined = SCRIPTS.iter().map(|name| Ok(minified::minified(&read(name)?)));
    let joined: String = joined.collect::<std::io::Result<_>>()?;
    let folder = std::env::var("OUT_DIR")?;
    std::fs::write(Path::new(&folder).join("page.js"), joined)?;
    std::fs::write(Path::new(&folder).join("worker.js"), minified::minified(&read("worker")?))?;
    Ok(())
}

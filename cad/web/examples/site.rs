//! Writes the configurator as one file: `cargo run -p pinswitch-web --example site -- MODULE.wasm FOLDER`. The module is
//! packed into the page, so that a double click opens it. `cad/web/build` makes both.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use pinswitch_web::page::{LIBRARIES, Packed, configurator_html};
use pinswitch_web::slim::slim;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [module, folder] = arguments.as_slice() else {
        return Err("give the module and the folder of the site".into());
    };
    let slim = slim(&std::fs::read(module)?, &LIBRARIES)
        .ok_or_else(|| format!("{} is no module", module.display()))?;
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(&slim.bytes)?;
    let module = Packed { base64: STANDARD.encode(packed.finish()?), holes: slim.holes };
    std::fs::create_dir_all(folder)?;
    let page = folder.join("index.html");
    std::fs::write(&page, configurator_html(Some(&module)))?;
    println!("{}", page.display());
    Ok(())
}

//! Writes the configurator as one file: `cargo run -p pinswitch-app --example site -- MODULE.wasm FOLDER`. The module is
//! packed into the page, so that a double click opens it. `cad/app/build` makes both.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use lzma_rust2::{CheckType, LzmaOptions, XzOptions, XzWriter};
use pinswitch_app::page::{LIBRARIES, Packed, configurator_html};
use pinswitch_app::slim::slim;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [module, folder] = arguments.as_slice() else {
        return Err("give the module and the folder of the site".into());
    };
    let slim = slim(&std::fs::read(module)?, &LIBRARIES)
        .ok_or_else(|| format!("{} is no module", module.display()))?;
    let module = Packed { base64: STANDARD.encode(packed(&slim.bytes)?), holes: slim.holes };
    std::fs::create_dir_all(folder)?;
    let page = folder.join("index.html");
    std::fs::write(&page, configurator_html(Some(&module)))?;
    println!("{}", page.display());
    Ok(())
}

/// The module as XZ, with the literals of code in mind: a byte of it says more of the next than where that stands.
fn packed(module: &[u8]) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut options = XzOptions::with_preset(9);
    options.lzma_options = LzmaOptions { lc: 4, lp: 0, pb: 0, nice_len: 273, ..LzmaOptions::with_preset(9) };
    // No larger than what is packed: a browser makes room for all of it.
    options.lzma_options.dict_size = 1 << 23;
    options.set_check_sum_type(CheckType::Crc32);
    let mut writer = XzWriter::new(Vec::new(), options)?;
    writer.write_all(module)?;
    Ok(writer.finish()?)
}
